/* arguments.c - the command line: one table of options, strict values, useful refusals.
 *
 * An option stands once, takes one value (behind it or after "="), and is refused by commands that have no use for it. */
#include "cli/cli.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef enum argument_kind {
    ARG_FLAG, ARG_INT, ARG_LONG, ARG_REAL, ARG_TRIPLE, ARG_LIST, ARG_BYTES, ARG_CHOICE, ARG_SIZE, ARG_TEXT
} argument_kind;

typedef struct argument {
    const char *name;       /* with its dashes */
    const char *value;      /* as the help shows it; NULL for a flag */
    argument_kind kind;
    int commands;           /* bits */
    size_t field;           /* in cli_options */
    double low, high;       /* of numbers; REAL: both excluded, unless least is 1 */
    int least, most;        /* numbers in a list */
    const char *choice[4];  /* names of CHOICE; a name's place is its value less base */
    int base;
    const char *help;
} argument;

#define FIELD(name) offsetof(cli_options, name)
#define LARGEST_SIDE 33554432.0 /* 2^25, a lattice's limit */

static const argument arguments[] = {
    {"-o", "FILE", ARG_TEXT, CLI_VOXELIZE | CLI_LOD | CLI_RENDER, FIELD(output), 0, 0, 0, 0, {NULL}, 0,
     "where the result goes; the ending tells the format"},
    {"--resolution", "N", ARG_LIST, CLI_LOD, FIELD(resolution), 1, LARGEST_SIDE, 1, 1, {NULL}, 0,
     "voxels along the longest axis [8 x the finest level, less where memory is short]"},
    {"--resolution", "N|X,Y,Z", ARG_LIST, CLI_VOXELIZE, FIELD(resolution), 1, LARGEST_SIDE, 1, 3, {NULL}, 0,
     "voxels along the longest axis, or along each axis [256]"},
    {"--spacing", "S", ARG_REAL, CLI_VOXELIZE, FIELD(spacing), 0, 1e300, 0, 0, {NULL}, 0,
     "edge of a voxel in the mesh's unit, in place of --resolution"},
    {"--origin", "X,Y,Z", ARG_TRIPLE, CLI_VOXELIZE, FIELD(origin), 0, 0, 0, 0, {NULL}, 0,
     "low corner of voxel 0,0,0, with --spacing [the mesh's low corner]"},
    {"--window", "A,B,C,D,E,F", ARG_LIST, CLI_VOXELIZE, FIELD(window), 0, LARGEST_SIDE, 6, 6, {NULL}, 0,
     "only voxels A..D-1, B..E-1, C..F-1 of the lattice"},
    {"--padding", "N", ARG_INT, CLI_VOXELIZE | CLI_LOD, FIELD(padding), 0, 65536, 0, 0, {NULL}, 0,
     "empty voxels added on every side [0]"},
    {"--levels", "A,B,C", ARG_LIST, CLI_LOD, FIELD(levels), 1, LARGEST_SIDE, 1, CLI_MAX_LEVELS, {NULL}, 0,
     "samples along the longest axis of each level [64,32,16]"},
    {"--triangles", "A,B,C", ARG_LIST, CLI_LOD, FIELD(triangles), 1, 4294967295.0, 1, CLI_MAX_LEVELS, {NULL}, 0,
     "most triangles of each level, in place of --levels"},
    {"--method", "NAME", ARG_CHOICE, CLI_LOD, FIELD(method), 0, 0, 0, 0, {"edge-ratio", "coverage", NULL},
     BVX_LOD_EDGE_RATIO, "edge-ratio or coverage [edge-ratio]"},
    {"--threshold", "T", ARG_REAL, CLI_LOD, FIELD(threshold), 0, 1, 0, 0, {NULL}, 0,
     "a sample above it is inside, 0 < T < 1 [0.5]"},
    {"--edge-samples", "N", ARG_INT, CLI_LOD, FIELD(edge_samples), 1, 65536, 0, 0, {NULL}, 0,
     "steps along an edge, with --method edge-ratio [the ratio, rounded up]"},
    {"--collapse", "F", ARG_REAL, CLI_LOD, FIELD(collapse), 1, 64, 1, 0, {NULL}, 0,
     "with --triangles: make up to F times as many, then collapse the\ncheapest edges; 2 to 4 comes much nearer to the mesh [off]"},
    {"--fill", "RULE", ARG_CHOICE, CLI_VOXELIZE | CLI_LOD | CLI_RENDER, FIELD(fill), 0, 0, 0, 0, {"parity", "nonzero", NULL},
     BVX_FILL_PARITY, "parity: nested shells are cavities; nonzero: overlapping and\ninverted shells are one solid [parity]"},
    {"--samples", "N", ARG_LONG, CLI_LOD, FIELD(samples), 0, 2147483647, 0, 0, {NULL}, 0,
     "points on each mesh for the distances, 0: none [20000]"},
    {"--size", "WxH", ARG_SIZE, CLI_RENDER, FIELD(size), 1, 16384, 2, 2, {NULL}, 0,
     "pixels of a picture [1024x768; 640x480 each for several meshes]"},
    {"--from", "X,Y,Z", ARG_TRIPLE, CLI_RENDER, FIELD(from), 0, 0, 0, 0, {NULL}, 0,
     "direction from the mesh to the eye [3,-4,2]"},
    {"--up", "X,Y,Z", ARG_TRIPLE, CLI_RENDER, FIELD(up), 0, 0, 0, 0, {NULL}, 0, "what is up in the picture [0,0,1]"},
    {"--voxels", "N", ARG_INT, CLI_RENDER, FIELD(voxels), 1, LARGEST_SIDE, 0, 0, {NULL}, 0,
     "draw the voxels of the solid, N along its longest axis"},
    {"--smooth", NULL, ARG_FLAG, CLI_RENDER, FIELD(smooth), 0, 0, 0, 0, {NULL}, 0,
     "smooth shading; sharp edges stay sharp"},
    {"--threads", "N", ARG_INT, CLI_ALL, FIELD(threads), 0, 1024, 0, 0, {NULL}, 0, "workers, 0: all there are [0]"},
    {"--memory-limit", "BYTES", ARG_BYTES, CLI_ALL, FIELD(memory_limit), 1, 1e18, 0, 0, {NULL}, 0,
     "most memory for data; K, M and G are understood [none]"},
    {"--json", NULL, ARG_FLAG, CLI_ALL, FIELD(json), 0, 0, 0, 0, {NULL}, 0,
     "a report for programs on standard output, in place of the text"},
    {"--quiet", NULL, ARG_FLAG, CLI_ALL, FIELD(quiet), 0, 0, 0, 0, {NULL}, 0, "no text, no progress, no warnings"},
    {"--help", NULL, ARG_FLAG, CLI_ALL, FIELD(help), 0, 0, 0, 0, {NULL}, 0, "this text"},
};

enum { ARGUMENTS = sizeof arguments / sizeof arguments[0] };

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

static int take_list(const argument *a, const char *text, const char *stops, cli_list *list)
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

static int take_bytes(const argument *a, const char *text, uint64_t *bytes)
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

static int take_choice(const argument *a, const char *text, int32_t *v)
{
    for (int i = 0; a->choice[i] != NULL; i++)
        if (strcmp(text, a->choice[i]) == 0) {
            *v = a->base + i;
            return 1;
        }
    return 0;
}

/* Store a value; 0 when it is malformed. */
static int take_value(const argument *a, const char *text, cli_options *o)
{
    void *const field = (char *)o + a->field;
    const char *rest;
    int64_t whole;
    int good;
    switch (a->kind) {
    case ARG_FLAG: *(int32_t *)field = 1; return 1;
    case ARG_TEXT: *(const char **)field = text; return text[0] != 0;
    case ARG_INT:
        if (!take_whole(text, "", a->low, a->high, &whole, &rest)) return 0;
        *(int32_t *)field = (int32_t)whole;
        return 1;
    case ARG_LONG: return take_whole(text, "", a->low, a->high, field, &rest);
    case ARG_REAL:
        good = take_real(text, "", field, &rest);
        if (a->least == 1) return good && *(double *)field >= a->low && *(double *)field <= a->high;
        return good && *(double *)field > a->low && *(double *)field < a->high;
    case ARG_TRIPLE: return take_triple(text, field);
    case ARG_LIST: good = take_list(a, text, ",", field); return good && !(a->most == 3 && ((cli_list *)field)->count == 2);
    case ARG_SIZE: return take_list(a, text, "x", field);
    case ARG_BYTES: return take_bytes(a, text, field);
    case ARG_CHOICE: return take_choice(a, text, field);
    }
    return 0;
}

/* "a whole number from 0 to 1024": what a value must be. */
static void describe_value(const argument *a, char *text, size_t room)
{
    switch (a->kind) {
    case ARG_INT:
    case ARG_LONG: snprintf(text, room, "a whole number from %.0f to %.0f", a->low, a->high); break;
    case ARG_REAL:
        if (a->least == 1) snprintf(text, room, "a number from %g to %g", a->low, a->high);
        else if (a->high <= 1.0) snprintf(text, room, "a number above %g and below %g", a->low, a->high);
        else snprintf(text, room, "a number above %g", a->low);
        break;
    case ARG_TRIPLE: snprintf(text, room, "three numbers like 3,-4,2"); break;
    case ARG_LIST:
        if (a->most == 1) snprintf(text, room, "a whole number from %.0f to %.0f", a->low, a->high);
        else if (a->most == 3) snprintf(text, room, "one whole number or three like 64,32,16, from %.0f to %.0f", a->low, a->high);
        else if (a->least == a->most) snprintf(text, room, "%d whole numbers like 0,0,0,64,64,64", a->most);
        else snprintf(text, room, "whole numbers like 64,32,16, at most %d, from %.0f to %.0f", a->most, a->low, a->high);
        break;
    case ARG_SIZE: snprintf(text, room, "a width and a height like 1024x768, each from 1 to %.0f", a->high); break;
    case ARG_BYTES: snprintf(text, room, "a count of bytes like 500M or 2G, above 0"); break;
    case ARG_CHOICE: snprintf(text, room, "one of: %s, %s", a->choice[0], a->choice[1]); break;
    default: snprintf(text, room, "a value"); break;
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
    int const bit = *(const int *)user;
    for (int k = 0; k < ARGUMENTS; k++)
        if ((arguments[k].commands & bit) != 0 && i-- == 0) return arguments[k].name;
    return NULL;
}

static const argument *find_argument(const char *name, size_t length, int bit)
{
    for (int k = 0; k < ARGUMENTS; k++)
        if ((arguments[k].commands & bit) != 0 && strlen(arguments[k].name) == length &&
            strncmp(arguments[k].name, name, length) == 0)
            return &arguments[k];
    return NULL;
}

static int refuse_option(cli_run *run, const char *word, size_t length)
{
    char name[64];
    const char *nearest;
    int const bit = run->command->bit;
    snprintf(name, sizeof name, "%.*s", (int)(length < 60 ? length : 60), word);
    if (find_argument(word, length, CLI_ALL) != NULL)
        return cli_usage(run, "%s has no use for %s; see 'bitvox %s --help'", run->command->name, name, run->command->name);
    nearest = cli_nearest(name, next_option, &bit);
    if (nearest != NULL)
        return cli_usage(run, "%s is no option of %s; is %s meant?", name, run->command->name, nearest);
    return cli_usage(run, "%s is no option of %s; see 'bitvox %s --help'", name, run->command->name, run->command->name);
}

/* ---- the command line ---- */

/* Take the option at word[*at]; *at moves behind it. */
static int parse_option(cli_run *run, int count, char **word, int *at, uint64_t *seen)
{
    const char *const text = word[*at], *equals = strchr(text, '=');
    size_t const length = equals != NULL ? (size_t)(equals - text) : strlen(text);
    const argument *const a = find_argument(text, length, run->command->bit);
    const char *value = equals != NULL ? equals + 1 : NULL;
    char wanted[160];
    if (a == NULL) return refuse_option(run, text, length);
    uint64_t const mark = UINT64_C(1) << (a - arguments);
    if ((*seen & mark) != 0) return cli_usage(run, "%s is given twice", a->name);
    *seen |= mark;
    ++*at;
    if (a->kind == ARG_FLAG) {
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

int cli_parse(cli_run *run, int count, char **word)
{
    cli_options *const o = &run->options;
    uint64_t seen = 0;
    int only_inputs = 0, at = 0;
    for (int i = 0; i < count; i++) { /* these decide how an error is told and whether there is one */
        if (strcmp(word[i], "--json") == 0) o->json = 1;
        if (strcmp(word[i], "--help") == 0 || strcmp(word[i], "-h") == 0) o->help = 1;
    }
    if (o->help) return CLI_DONE;
    while (at < count) {
        const char *const text = word[at];
        if (!only_inputs && strcmp(text, "--") == 0) {
            only_inputs = 1;
            at++;
        } else if (!only_inputs && text[0] == '-' && text[1] != 0) {
            int const status = parse_option(run, count, word, &at, &seen);
            if (status != CLI_DONE) return status;
        } else {
            if (strcmp(text, "-") == 0) return cli_usage(run, "standard input has no name that tells the format; give a file");
            if (o->inputs == run->command->most_inputs)
                return cli_usage(run, "'%s' is one input too many; %s takes %d", text, run->command->name,
                                 run->command->most_inputs);
            o->input[o->inputs++] = text;
            at++;
        }
    }
    if (o->inputs == 0) return cli_usage(run, "%s lacks its input file; see 'bitvox %s --help'", run->command->name, run->command->name);
    if (find_argument("-o", 2, run->command->bit) != NULL && o->output == NULL)
        return cli_usage(run, "%s lacks -o FILE; see 'bitvox %s --help'", run->command->name, run->command->name);
    if (o->output != NULL && strcmp(o->output, "-") == 0)
        return cli_usage(run, "standard output has no name that tells the format; give a file");
    return CLI_DONE;
}

void cli_print_options(int command_bit)
{
    for (int k = 0; k < ARGUMENTS; k++) {
        const argument *const a = &arguments[k];
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
