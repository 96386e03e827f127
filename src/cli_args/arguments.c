/* arguments.c - the command line: useful refusals; the options stand in the commands' files and in
 * shared_rows.c, option_values.c takes their values.
 *
 * An option stands once, takes one value (after it or after "="), and is refused by commands that have no
 * use for it. */
#include "cli_args/args.h"

#include <stdio.h>
#include <string.h>

/* ---- rows ---- */

static int list_table(const cli_argument *table, const cli_argument **row, int rows)
{
    for (const cli_argument *a = table; a->name != NULL || a->also != NULL; a++) {
        if (a->also != NULL) rows = list_table(a->also, row, rows);
        else if (rows < CLI_MAX_OPTIONS) row[rows++] = a;
    }
    return rows;
}

int cli_list_rows(const cli_command *command, const cli_argument *row[CLI_MAX_OPTIONS])
{
    return list_table(command->rows, row, 0);
}

int cli_is_common(const cli_argument *a)
{
    /* cli_general, which all commands have, stands first. */
    return !a->own && a->field < sizeof(cli_general);
}

/* ---- names ---- */

static size_t name_distance(const char *a, const char *b)
{
    enum { MOST = 40 };
    size_t row[MOST + 1];
    size_t const n = strlen(a), m = strlen(b);
    if (n > MOST || m > MOST) return MOST; /* No option and no command is nearly so long. */
    /* One row of the table is enough: a cell needs those to its left, above it, and at the corner. */
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
    /* One letter wrong, and one more for every four: beyond that a guess is a riddle. */
    return nearest != NULL && least <= 1 + strlen(nearest) / 4 ? nearest : NULL;
}

static const char *next_option(const void *user, int i)
{
    const cli_run *const run = user;
    return i < run->rows ? run->row[i]->name : NULL;
}

const char *cli_mistaken_for(const cli_run *run, const char *name)
{
    for (int k = 0; k < run->rows; k++)
        if (name_distance(name, run->row[k]->name) == 1) return run->row[k]->name;
    return NULL;
}

/* The row of an option that the command takes, -1 when it takes none of that name. */
static int find_argument(const cli_argument *const *row, int rows, const char *name, size_t length)
{
    for (int k = 0; k < rows; k++)
        if (strncmp(row[k]->name, name, length) == 0 && row[k]->name[length] == 0) return k;
    return -1;
}

int cli_takes(const cli_run *run, const char *name)
{
    return find_argument(run->row, run->rows, name, strlen(name)) >= 0;
}

const char *cli_given_name(const cli_run *run, const char *name, size_t length)
{
    int const row = find_argument(run->row, run->rows, name, length);
    return row >= 0 && run->given[row] ? run->row[row]->name : NULL;
}

int cli_given(const cli_run *run, const char *name)
{
    return cli_given_name(run, name, strlen(name)) != NULL;
}

bvx_parts cli_parts(const cli_run *run)
{
    const cli_options *const o = run->options;
    return (bvx_parts){.least_part = (uint64_t)o->least_part,
                       .keep_largest = (uint64_t)o->keep_largest,
                       .least_cavity = (uint64_t)o->least_cavity,
                       .keep_crumbs = cli_given(run, "--least-part")};
}

int cli_reduces(const cli_run *run)
{
    return run->options->triangles.count != 0 || run->options->errors.count != 0;
}

/* ---- the command line ---- */

/* Take the option at word[*at]; *at moves after it. */
static int parse_option(cli_run *run, int count, char **word, int *at)
{
    const char *const text = word[*at], *equals = strchr(text, '=');
    size_t const length = equals != NULL ? (size_t)(equals - text) : strlen(text);
    int const row = find_argument(run->row, run->rows, text, length);
    const cli_argument *const a = row >= 0 ? run->row[row] : NULL;
    const char *value = equals != NULL ? equals + 1 : NULL;
    char wanted[256];

    if (a == NULL) {
        char name[64];

        snprintf(name, sizeof name, "%.*s", (int)(length < 60 ? length : 60), text);
        /* A right option at the wrong command is not a misspelling. */
        for (int i = 0; run->commands[i] != NULL; i++) {
            const cli_argument *of[CLI_MAX_OPTIONS];
            if (find_argument(of, cli_list_rows(run->commands[i], of), text, length) >= 0)
                return cli_usage(run, "%s has no use for %s; see 'bitvox %s --help-all'", run->command->name,
                                 name, run->command->name);
        }
        const char *const nearest = strcmp(name, "--output") == 0 ? "-o"
                                                                  : cli_nearest(name, next_option, run);
        if (nearest != NULL)
            return cli_usage(run, "%s is not an option of %s; did you mean %s?", name, run->command->name,
                             nearest);
        return cli_usage(run, "%s is not an option of %s; see 'bitvox %s --help-all'", name,
                         run->command->name, run->command->name);
    }
    /* Which of two would count is a guess; --cut stands once for each axis. */
    if (run->given[row] && a->kind != CLI_CUT) return cli_usage(run, "%s is given twice", a->name);
    run->given[row] = 1;
    ++*at;
    if (a->kind == CLI_FLAG) {
        if (value != NULL) return cli_usage(run, "%s takes no value", a->name);
        cli_take_value(run, a, "");
        return CLI_DONE;
    }
    /* A value may look like an option (-1), so the next word is taken whatever it is. */
    cli_describe_value(a, wanted, sizeof wanted);
    if (value == NULL) {
        if (*at == count) return cli_usage(run, "%s lacks its value, %s", a->name, wanted);
        value = word[(*at)++];
    }
    if (!cli_take_value(run, a, value))
        return cli_usage(run, "%s takes %s, not '%s'", a->name, wanted, value);
    return CLI_DONE;
}

static int take_input(cli_run *run, const char *name)
{
    cli_options *const o = run->options;
    int const most = o->output_dir != NULL ? CLI_MAX_FILES : run->command->most_inputs;

    /* The command may take several after all, said the other way. */
    if (o->inputs == most && o->output_dir == NULL && most == 1 && cli_takes(run, "--output-dir"))
        return cli_usage(run, "'%s' is one input too many; %s takes 1, or several with --output-dir", name,
                         run->command->name);
    if (o->inputs == most)
        return cli_usage(run, "'%s' is one input too many: bitvox %s %s", name, run->command->name,
                         run->command->usage);
    for (int i = 0; i < o->inputs; i++)
        if (strcmp(name, "-") == 0 && strcmp(o->input[i], "-") == 0)
            return cli_usage(run, "standard input can be read only once");
    o->input[o->inputs++] = name;
    return CLI_DONE;
}

int cli_parse(cli_run *run, int count, char **word)
{
    cli_options *const o = run->options;
    int only_inputs = 0, at = 0, status = CLI_DONE;

    run->rows = cli_list_rows(run->command, run->row);

    /* decide how an error is reported and whether there is one */
    for (int i = 0; i < count && strcmp(word[i], "--") != 0; i++) {
        if (strcmp(word[i], "--json") == 0) o->general.json = 1;
        if (cli_takes(run, "--output-dir") && strncmp(word[i], "--output-dir", 12) == 0) o->output_dir = "";
        if (strcmp(word[i], "--help") == 0 || strcmp(word[i], "-h") == 0) o->general.help = 1;
        if (strcmp(word[i], "--help-all") == 0) o->general.help = 2;
    }
    if (o->general.help) return CLI_DONE;
    /* "-" alone is standard input, and after "--" every word is a file. */
    while (at < count && status == CLI_DONE) {
        const char *const text = word[at];
        /* A file may be named like an option. */
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
    return status;
}

/* ---- help ---- */

static int has_word(const char *words, const char *word)
{
    size_t const n = strlen(word);
    for (const char *p = strstr(words, word); p != NULL; p = strstr(p + n, word))
        if ((p == words || p[-1] == ' ') && (p[n] == ' ' || p[n] == 0)) return 1;
    return 0;
}

/* The groups of the long help. NULL: what is in no other, which is mostly a command's own. */
static const char *const groups[][2] = {
    {"files", "-o --output-dir --format --normals --output-origin --quantize --up --input-up"},
    {"the command's own", NULL},
    {"lattice, and what of a mesh is inside",
     "--resolution --spacing --origin --window --padding --fill --close-gaps --sign --add-shell"},
    {"surface of a solid",
     "--sharp --no-sharp --interpolation --shell --outer-hull --least-part --least-cavity --keep-largest "
     "--carry"},
    {"fewer triangles", "--triangles --error --error-kind --count --strict --even --attributes --lock-border "
                        "--keep-vertices --samples"},
    {"the papers' samples of a solid", "--method --levels --threshold --edge-samples --collapse"},
    {"volumes, .raw files and octrees", "--level --range --label --below --shape --sample-type "
                                        "--big-endian --skip --voxel-size --states --expand"},
    {"every command", "--threads --memory-limit --json --progress --quiet --help --help-all"}};

enum { GROUPS = sizeof groups / sizeof groups[0], OWN_GROUP = 1 };

static int group_of(const cli_argument *a)
{
    /* voxelize and render have an --up of another meaning. */
    for (int i = a->own; i < GROUPS; i++)
        if (groups[i][1] != NULL && has_word(groups[i][1], a->name)) return i;
    return OWN_GROUP;
}

void cli_print_options(const cli_command *command, int all)
{
    const cli_argument *row[CLI_MAX_OPTIONS];
    int const rows = cli_list_rows(command, row);

    for (int i = 0; i < (all ? GROUPS : 1); i++) {
        int titled = !all;
        for (int k = 0; k < rows; k++) {
            const char *const name = row[k]->name;
            if (all ? group_of(row[k]) != i
                    : command->most != NULL && !has_word("-o --help --help-all", name) &&
                          !has_word(command->most, name))
                continue;
            if (!titled++) printf("\n%s:\n", groups[i][0]);
            char left[40];
            snprintf(left, sizeof left, "%s %s", row[k]->name, row[k]->value != NULL ? row[k]->value : "");
            printf("  %-24s", left);
            for (const char *p = row[k]->help; *p != 0; p++) {
                putchar(*p);
                if (*p == '\n') printf("%26s", "");
            }
            putchar('\n');
        }
    }
}
