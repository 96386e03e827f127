/* arguments.c - the command line: strict values, useful refusals; the options stand in option_table.c.
 *
 * An option stands once, takes one value (behind it or after "="), and is refused by commands that have no use for it. */
#include "cli/cli.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- numbers ---- */

/* A decimal number that ends at one of the stops or at the end of the text; *rest is behind it. */
static int take_real(const char *text, const char *stops, double *v, const char **rest)
{
    size_t const n = strspn(text, "+-.0123456789eE"); /* leaves out what strtod would take too: hex, inf, nan, spaces */
    char *end;
    if (n == 0) return 0;
    *v = strtod(text, &end);
    if (end != text + n || *v - *v != 0.0) return 0;
    if (*end != 0 && strchr(stops, *end) == NULL) return 0;
    *rest = end;
    return 1;
}

static int take_whole(const char *text, const char *stops, double low, double high, int64_t *v, const char **rest)
{
    int64_t n = 0;
    const char *p = text;
    if (*p < '0' || *p > '9') return 0;
    for (; *p >= '0' && *p <= '9'; p++) {
        if (n > INT64_MAX / 100) return 0;
        n = n * 10 + (*p - '0');
    }
    if (*p != 0 && strchr(stops, *p) == NULL) return 0;
    *v = n;
    *rest = p;
    return (double)n >= low && (double)n <= high;
}

static int take_list(const cli_argument *a, const char *text, const char *stops, cli_list *list)
{
    const char *p = text;
    list->count = 0;
    for (;;) {
        if (list->count == a->most) return 0;
        if (!take_whole(p, stops, a->low, a->high, &list->value[list->count], &p)) return 0;
        list->count++;
        if (*p == 0) break;
        p++;
    }
    return list->count >= a->least;
}

static int take_triple(const char *text, cli_triple *t)
{
    const char *p = text;
    for (int k = 0; k < 3; k++) {
        if (!take_real(p, k < 2 ? "," : "", &t->value[k], &p)) return 0;
        if (k < 2 && *p++ != ',') return 0;
    }
    t->given = 1;
    return 1;
}

/* The axis that a text begins with, and the stop behind it; -1 when there is none. */
static int take_axis(const char *text, char stop)
{
    return text[0] >= 'x' && text[0] <= 'z' && text[1] == stop ? text[0] - 'x' : -1;
}

/* x=0.5,z=1: each axis once. */
static int take_planes(const char *text, cli_planes *planes)
{
    const char *p = text;
    for (;;) {
        int const axis = take_axis(p, '=');
        if (axis < 0 || planes->given[axis] || !take_real(p + 2, ",", &planes->value[axis], &p)) return 0;
        planes->given[axis] = 1;
        if (*p == 0) return 1;
        p++;
    }
}

static int take_slices(const cli_argument *a, const char *text, cli_sheet *slices)
{
    const char *rest;
    int64_t count;
    slices->axis = take_axis(text, ':');
    if (slices->axis < 0 || !take_whole(text + 2, "", a->low, a->high, &count, &rest)) return 0;
    slices->count = (int32_t)count;
    return 1;
}

static int take_bytes(const cli_argument *a, const char *text, uint64_t *bytes)
{
    static const char suffix[] = "KMG";
    const char *p;
    int64_t v;
    if (!take_whole(text, "KMGkmg", a->low, a->high, &v, &p)) return 0;
    int shift = 0;
    if (*p != 0) {
        const char *const s = strchr(suffix, *p >= 'a' ? *p - 'a' + 'A' : *p);
        shift = 10 * ((int)(s - suffix) + 1);
        if (p[1] != 0) return 0;
    }
    if ((uint64_t)v > UINT64_MAX >> shift) return 0;
    *bytes = (uint64_t)v << shift;
    return 1;
}

static int take_choice(const cli_argument *a, const char *text, int32_t *v)
{
    for (int i = 0; a->choice[i] != NULL; i++)
        if (text[0] != 0 && strcmp(text, a->choice[i]) == 0) {
            *v = a->base + i;
            return 1;
        }
    return 0;
}

/* surface,inside: each name once. */
static int take_set(const cli_argument *a, const char *text, int32_t *set)
{
    const char *p = text;
    *set = 0;
    for (;;) {
        size_t const n = strcspn(p, ",");
        int i = 0;
        while (a->choice[i] != NULL && (strlen(a->choice[i]) != n || strncmp(a->choice[i], p, n) != 0)) i++;
        if (a->choice[i] == NULL || (*set & a->base << i) != 0) return 0;
        *set |= a->base << i;
        if (p[n] == 0) return 1;
        p += n + 1;
    }
}

/* Store a value; 0 when it is malformed. */
static int take_value(const cli_argument *a, const char *text, cli_options *o)
{
    void *const field = (char *)o + a->field;
    const char *rest;
    int64_t whole;
    int good;
    switch (a->kind) {
    case CLI_FLAG: *(int32_t *)field = 1; return 1;
    case CLI_FILE:
    case CLI_TEXT: *(const char **)field = text; return text[0] != 0;
    case CLI_NUMBER: return take_real(text, "", field, &rest);
    case CLI_SET: return take_set(a, text, field);
    case CLI_INT:
        if (a->choice != NULL && take_choice(a, text, field)) return 1;
        if (!take_whole(text, "", a->low, a->high, &whole, &rest)) return 0;
        *(int32_t *)field = (int32_t)whole;
        return 1;
    case CLI_LONG: return take_whole(text, "", a->low, a->high, field, &rest);
    case CLI_REAL:
        good = take_real(text, "", field, &rest);
        if (a->least == 1) return good && *(double *)field >= a->low && *(double *)field <= a->high;
        return good && *(double *)field > a->low && *(double *)field < a->high;
    case CLI_TRIPLE: return take_triple(text, field);
    case CLI_LIST: good = take_list(a, text, ",", field); return good && !(a->most == 3 && ((cli_list *)field)->count == 2);
    case CLI_SIZE: return take_list(a, text, "x", field);
    case CLI_CUT: return take_planes(text, field);
    case CLI_SLICES: return take_slices(a, text, field);
    case CLI_BYTES: return take_bytes(a, text, field);
    case CLI_CHOICE: return take_choice(a, text, field);
    }
    return 0;
}

/* "a whole number from 0 to 1024": what a value must be. */
static void describe_value(const cli_argument *a, char *text, size_t room)
{
    switch (a->kind) {
    case CLI_INT:
    case CLI_LONG:
        snprintf(text, room, "a whole number from %.0f to %.0f", a->low, a->high);
        for (int i = 0; a->choice != NULL && a->choice[i] != NULL; i++) snprintf(text + strlen(text), room - strlen(text), " or %s", a->choice[i]);
        break;
    case CLI_REAL:
        if (a->least == 1) snprintf(text, room, "a number from %g to %g", a->low, a->high);
        else if (a->high <= 1.0) snprintf(text, room, "a number above %g and below %g", a->low, a->high);
        else snprintf(text, room, "a number above %g and below %g", a->low, a->high);
        break;
    case CLI_TRIPLE: snprintf(text, room, "three numbers like 3,-4,2"); break;
    case CLI_LIST:
        if (a->most == 1) snprintf(text, room, "a whole number from %.0f to %.0f", a->low, a->high);
        else if (a->most == 3) snprintf(text, room, "one whole number or three like 64,32,16, from %.0f to %.0f", a->low, a->high);
        else if (a->least == a->most) snprintf(text, room, "%d whole numbers like 0,0,0,64,64,64", a->most);
        else snprintf(text, room, "whole numbers like 64,32,16, at most %d, from %.0f to %.0f", a->most, a->low, a->high);
        break;
    case CLI_SIZE: snprintf(text, room, "a width and a height like 1024x768, each from 1 to %.0f", a->high); break;
    case CLI_CUT: snprintf(text, room, "planes like x=0.5 or x=0.5,z=1, each axis once"); break;
    case CLI_SLICES: snprintf(text, room, "an axis and a count from %.0f to %.0f, like z:16", a->low, a->high); break;
    case CLI_BYTES: snprintf(text, room, "a count of bytes like 500M or 2G, above 0"); break;
    case CLI_CHOICE:
        snprintf(text, room, "one of:");
        for (int i = 0; a->choice[i] != NULL; i++)
            if (a->choice[i][0] != 0) snprintf(text + strlen(text), room - strlen(text), "%s %s", i == 0 ? "" : ",", a->choice[i]);
        break;
    case CLI_FILE: snprintf(text, room, "the name of a file"); break;
    case CLI_TEXT: snprintf(text, room, "a text that is not empty"); break;
    case CLI_NUMBER: snprintf(text, room, "a number"); break;
    case CLI_SET:
        snprintf(text, room, "one or more of");
        for (int i = 0; a->choice[i] != NULL; i++)
            snprintf(text + strlen(text), room - strlen(text), "%s %s", i == 0 ? "" : ",", a->choice[i]);
        snprintf(text + strlen(text), room - strlen(text), ", with commas between");
        break;
    case CLI_FLAG: snprintf(text, room, "nothing"); break;
    }
}

/* ---- names ---- */

static size_t name_distance(const char *a, const char *b)
{
    enum { MOST = 40 };
    size_t row[MOST + 1];
    size_t const n = strlen(a), m = strlen(b);
    if (n > MOST || m > MOST) return MOST;
    for (size_t j = 0; j <= m; j++) row[j] = j;
    for (size_t i = 1; i <= n; i++) {
        size_t corner = row[0]; /* edit distance of a[0, i - 1) and b[0, j - 1) */
        row[0] = i;
        for (size_t j = 1; j <= m; j++) {
            size_t const swap = corner + (a[i - 1] != b[j - 1]), up = row[j] + 1, left = row[j - 1] + 1;
            corner = row[j];
            row[j] = swap < up ? swap : up;
            row[j] = left < row[j] ? left : row[j];
        }
    }
    return row[m];
}

const char *cli_nearest(const char *word, const char *(*next)(const void *user, int i), const void *user)
{
    const char *nearest = NULL, *name;
    size_t least = 0;
    for (int i = 0; (name = next(user, i)) != NULL; i++) {
        size_t d = name_distance(word, name);
        if (strlen(word) >= 4 && strncmp(word, name, strlen(word)) == 0) d = 1; /* cut short: --res */
        if (nearest == NULL || d < least) {
            nearest = name;
            least = d;
        }
    }
    return nearest != NULL && least <= 1 + strlen(nearest) / 4 ? nearest : NULL;
}

static const char *next_option(const void *user, int i)
{
    int32_t const bit = *(const int32_t *)user;
    const cli_argument *a;
    for (int k = 0; (a = cli_argument_at(k)) != NULL; k++)
        if ((a->commands & bit) != 0 && i-- == 0) return a->name;
    return NULL;
}

/* The row of an option that the command takes, -1 when it takes none of that name. */
static int find_argument(const char *name, size_t length, int32_t bit)
{
    const cli_argument *a;
    for (int k = 0; (a = cli_argument_at(k)) != NULL; k++)
        if ((a->commands & bit) != 0 && strlen(a->name) == length && strncmp(a->name, name, length) == 0) return k;
    return -1;
}

int cli_given(const cli_run *run, const char *name)
{
    int const row = find_argument(name, strlen(name), run->command->bit);
    return row >= 0 && run->given[row];
}

static int refuse_option(cli_run *run, const char *word, size_t length)
{
    char name[64];
    const char *nearest;
    int32_t const bit = run->command->bit;
    snprintf(name, sizeof name, "%.*s", (int)(length < 60 ? length : 60), word);
    if (find_argument(word, length, CLI_ALL) >= 0)
        return cli_usage(run, "%s has no use for %s; see 'bitvox %s --help'", run->command->name, name, run->command->name);
    nearest = cli_nearest(name, next_option, &bit);
    if (nearest != NULL)
        return cli_usage(run, "%s is no option of %s; is %s meant?", name, run->command->name, nearest);
    return cli_usage(run, "%s is no option of %s; see 'bitvox %s --help'", name, run->command->name, run->command->name);
}

/* ---- the command line ---- */

/* Take the option at word[*at]; *at moves behind it. */
static int parse_option(cli_run *run, int count, char **word, int *at)
{
    const char *const text = word[*at], *equals = strchr(text, '=');
    size_t const length = equals != NULL ? (size_t)(equals - text) : strlen(text);
    int const row = find_argument(text, length, run->command->bit);
    const cli_argument *const a = row >= 0 ? cli_argument_at(row) : NULL;
    const char *value = equals != NULL ? equals + 1 : NULL;
    char wanted[256];
    if (a == NULL) return refuse_option(run, text, length);
    if (run->given[row] && a->kind != CLI_CUT) return cli_usage(run, "%s is given twice", a->name);
    run->given[row] = 1;
    ++*at;
    if (a->kind == CLI_FLAG) {
        if (value != NULL) return cli_usage(run, "%s takes no value", a->name);
        take_value(a, "", &run->options);
        return CLI_DONE;
    }
    describe_value(a, wanted, sizeof wanted);
    if (value == NULL) {
        if (*at == count) return cli_usage(run, "%s lacks its value, %s", a->name, wanted);
        value = word[(*at)++];
    }
    if (!take_value(a, value, &run->options)) return cli_usage(run, "%s takes %s, not '%s'", a->name, wanted, value);
    return CLI_DONE;
}

static int take_input(cli_run *run, const char *name)
{
    cli_options *const o = &run->options;
    if (o->inputs == run->command->most_inputs)
        return cli_usage(run, "'%s' is one input too many; %s takes %d", name, run->command->name, run->command->most_inputs);
    for (int i = 0; i < o->inputs; i++)
        if (strcmp(name, "-") == 0 && strcmp(o->input[i], "-") == 0) return cli_usage(run, "standard input can be read only once");
    o->input[o->inputs++] = name;
    return CLI_DONE;
}

/* What holds for all commands once the words are taken. */
static int check_line(cli_run *run)
{
    const cli_options *const o = &run->options;
    const char *const name = run->command->name;
    int const least = run->command->least_inputs;
    int standard = 0;
    if (o->inputs == 0) return cli_usage(run, "%s lacks its input file; see 'bitvox %s --help'", name, name);
    if (o->inputs < least)
        return cli_usage(run, "%s lacks an input file: it takes %d; see 'bitvox %s --help'", name, least, name);
    for (int i = 0; i < o->inputs; i++) standard += strcmp(o->input[i], "-") == 0;
    if (standard != 0 && o->format == 0)
        return cli_usage(run, "standard input has no name that tells the format; say it with --format");
    if (standard == 0 && o->format != 0)
        return cli_usage(run, "--format is for standard input, '-'; names of files tell theirs");
    if (o->output == NULL && run->command->bit != CLI_COMPONENTS && find_argument("-o", 2, run->command->bit) >= 0)
        return cli_usage(run, "%s lacks -o FILE; see 'bitvox %s --help'", name, name);
    if (o->output != NULL && strcmp(o->output, "-") == 0)
        return cli_usage(run, "standard output has no name that tells the format; give a file");
    if (o->quiet && o->progress == CLI_BAR_DRAW) return cli_usage(run, "--quiet and --progress=bar exclude each other");
    return CLI_DONE;
}

int cli_parse(cli_run *run, int count, char **word)
{
    cli_options *const o = &run->options;
    int only_inputs = 0, at = 0, status = CLI_DONE;
    for (int i = 0; i < count && strcmp(word[i], "--") != 0; i++) { /* decide how an error is told and whether there is one */
        if (strcmp(word[i], "--json") == 0) o->json = 1;
        if (strcmp(word[i], "--help") == 0 || strcmp(word[i], "-h") == 0) o->help = 1;
    }
    if (o->help) return CLI_DONE;
    while (at < count && status == CLI_DONE) {
        const char *const text = word[at];
        if (!only_inputs && strcmp(text, "--") == 0) {
            only_inputs = 1;
            at++;
        } else if (!only_inputs && text[0] == '-' && text[1] != 0) {
            status = parse_option(run, count, word, &at);
        } else {
            status = take_input(run, text);
            at++;
        }
    }
    return status == CLI_DONE ? check_line(run) : status;
}

void cli_print_options(int32_t command_bit)
{
    const cli_argument *a;
    for (int k = 0; (a = cli_argument_at(k)) != NULL; k++) {
        char left[40];
        if ((a->commands & command_bit) == 0) continue;
        snprintf(left, sizeof left, "%s %s", a->name, a->value != NULL ? a->value : "");
        printf("  %-24s", left);
        for (const char *p = a->help; *p != 0; p++) {
            putchar(*p);
            if (*p == '\n') printf("%26s", "");
        }
        putchar('\n');
    }
}
