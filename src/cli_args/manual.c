/* manual.c - the manual page (troff) and the completion script for bash,
 * made from the tables of commands and options. */
#include "cli_args/args.h"

#include <stdio.h>
#include <string.h>

/* ---- the manual page ---- */

/* Text as troff prints it, its lines joined. */
static void put_roff(const char *text)
{
    for (const char *p = text; *p != 0; p++) {
        /* A line that begins with a dot or an apostrophe would be a request to troff. */
        if ((*p == '.' || *p == '\'') && (p == text || p[-1] == '\n')) printf("\\&");
        if (*p == '\\') printf("\\e");
        else if (*p == '-') printf("\\-");
        else if (*p == '"') printf("\\(dq");
        else putchar(*p == '\n' ? ' ' : *p);
    }
}

static void put_section(const char *title)
{
    printf(".SH %s\n", title);
}

static void put_paragraph(const char *text)
{
    printf(".PP\n");
    put_roff(text);
    putchar('\n');
}

static void put_item(const char *term, const char *text)
{
    printf(".TP\n\\fB");
    put_roff(term);
    printf("\\fR\n");
    put_roff(text);
    putchar('\n');
}

static void put_options(const cli_command *command, int common)
{
    const cli_argument *row[CLI_MAX_OPTIONS];
    int const rows = cli_list_rows(command, row);

    for (int i = 0; i < rows; i++) {
        const cli_argument *const a = row[i];

        if (cli_is_common(a) != common) continue;
        printf(".TP\n\\fB");
        put_roff(a->name);
        printf("\\fR");
        if (a->value != NULL) {
            printf(" \\fI");
            put_roff(a->value);
            printf("\\fR");
        }
        putchar('\n');
        put_roff(a->help);
        putchar('\n');
    }
}

static void put_commands(const cli_command *const *commands)
{
    const cli_command *c;
    put_section("COMMANDS");
    for (int i = 0; (c = commands[i]) != NULL; i++) {
        printf(".SS \"bitvox %s ", c->name);
        put_roff(c->usage);
        printf("\"\n");
        put_roff(c->details);
        putchar('\n');
        put_options(c, 0);
    }
    printf(".SS \"bitvox help [COMMAND | \\-\\-man | \\-\\-bash\\-completion]\"\n");
    put_roff("Prints the commands, the options of one, this page, or a script for bash to be read by its "
             "\"source\".\n");
    putchar('\n');
    printf(".SS \"bitvox \\-\\-version\"\nPrints the version.\n");
}

static void put_examples(const cli_command *const *commands)
{
    const cli_command *c;

    put_section("EXAMPLES");
    for (int i = 0; (c = commands[i]) != NULL; i++) {
        printf(".PP\n");
        put_roff(c->does);
        printf(":\n.PP\n.nf\n.RS\n");
        for (const char *p = c->example; *p != 0;) {
            size_t const n = strcspn(p, "\n");
            for (size_t k = 0; k < n; k++) printf(p[k] == '-' ? "\\-" : p[k] == '\\' ? "\\e" : "%c", p[k]);
            putchar('\n');
            p += n + (p[n] != 0);
        }
        printf(".RE\n.fi\n");
    }
}

void cli_print_manual(const cli_command *const *commands)
{
    int32_t const v = bvx_version();

    printf(".\\\" Printed by 'bitvox help --man'.\n.TH BITVOX 1 \"\" \"bitvox %d.%d.%d\" \"User Commands\"\n",
           (int)(v / 10000), (int)(v / 100 % 100), (int)(v % 100));
    /* mandb reads this section; its line has the form that whatis wants. */
    put_section("NAME");
    printf("bitvox \\- shapes to bit\\-packed voxels and back\n");
    put_section("SYNOPSIS");
    printf("\\fBbitvox\\fR \\fICOMMAND\\fR \\fIIN\\fR... [\\fB\\-o\\fR \\fIOUT\\fR] [\\fIoptions\\fR]\n");
    put_section("DESCRIPTION");
    put_roff("bitvox turns triangle meshes into bit-packed solids, and solids into closed manifold meshes of "
             "several sizes; it converts, "
             "compares and draws both. "
             "The endings of file names give their formats. Results do not depend on the machine or on the "
             "number of threads.");
    putchar('\n');
    put_paragraph(
        "Options stand anywhere, once each, with their value after a space or an equals sign; after -- "
        "every word "
        "is an input. As an input, - is standard input, whose format --format gives.");
    put_commands(commands);
    put_section("COMMON OPTIONS");
    put_options(commands[0], 1);
    put_section("PROGRESS AND REPORT");
    put_roff(
        "On a terminal a bar shows the percentage of the whole run, the stage and about how much time is "
        "left, once half a second "
        "has passed. With --progress=json lines of JSON go to standard error instead, at most ten a second "
        "and the last of "
        "each stage: stage, fraction (of the whole run, never falling; the last line of a run that succeeds "
        "has 1), elapsed "
        "(seconds of the run).");
    putchar('\n');
    put_paragraph(
        "With --json one JSON object goes to standard output, also after a failure: status (done, failed, "
        "interrupted), command, lattice, set, stages, meshes, warnings, peak_bytes, and error with code and "
        "message; info adds "
        "grid, voxelize solid or surface, refine and octrees add octree, "
        "fill adds fill, compare adds difference or "
        "distance, render adds pictures, and difference with --compare.");
    put_section("FILES");
    put_item(
        "FILE.npy.json, FILE.vox.json",
        "The side-car of a grid whose format keeps no lattice: origin (low corner), spacing, dims, "
        "window and the centre of the first voxel. It is written with the grid and looked for beside it; "
        "without one the "
        "grid starts at 0 and its voxels have sides of 1.");
    put_item(
        "bitvox-PID-N.part",
        "Outputs are written under such a name in their own folder and get their own names when "
        "all is done, one after the other. A failure or an interrupt removes them, and what stood there "
        "before stays as it "
        "was; only a program that is killed (SIGKILL, a crash, no more power) leaves them, to be deleted. "
        "Where an "
        "output is a pipe or a device it is written in place.");
    /* Scripts depend on these, so they never change. */
    put_section("EXIT STATUS");
    put_item("0", "Done.");
    put_item("1",
             "Bad input or another failure; standard error says why in one line. Where it is standard output "
             "that cannot be "
             "written, files that were requested are complete.");
    put_item("2", "Wrong usage.");
    put_item("130", "Interrupted by SIGINT, SIGTERM or SIGHUP.");
    put_examples(commands);
}

/* ---- bash ---- */

/* Case lines "command/--option)" for values: names to choose from, files, or nothing. */
static void put_values(const cli_command *c)
{
    const cli_argument *row[CLI_MAX_OPTIONS];
    int const rows = cli_list_rows(c, row);

    for (int i = 0; i < rows; i++) {
        const cli_argument *const a = row[i];

        if (a->kind == CLI_FLAG) continue;
        printf("    %s/%s) ", c->name, a->name);
        if (a->choice != NULL && a->kind != CLI_SET) {
            printf("_bitvox_words '");
            for (int k = 0; a->choice[k] != NULL; k++)
                if (a->choice[k][0] != 0) printf("%s%s", k == 0 ? "" : " ", a->choice[k]);
            printf("'");
        } else {
            printf(a->kind == CLI_FILE ? "_bitvox_files" : ":");
        }
        printf("; return ;;\n");
    }
}

void cli_print_completion(const cli_command *const *commands)
{
    const cli_command *c;

    printf("# Completion of bitvox for bash, printed by 'bitvox help --bash-completion'; read it with "
           "\"source\", or store it in\n"
           "# ~/.local/share/bash-completion/completions/bitvox.\n\n"
           "_bitvox_words() { # WORDS: those that begin like the word at the cursor\n"
           "    local one\n"
           "    while IFS= read -r one; do COMPREPLY+=(\"$one\"); done < <(compgen -W \"$1\" -- \"$word\")\n"
           "}\n\n"
           "_bitvox_files() { # what bash does by itself, with names quoted as they need\n"
           "    compopt -o default 2>/dev/null || :\n"
           "}\n\n"
           "_bitvox() {\n"
           "    local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]} "
           "command=${COMP_WORDS[1]} i\n"
           "    COMPREPLY=()\n"
           "    compopt +o default 2>/dev/null\n"
           "    if [[ $COMP_CWORD -ge 3 && $before == '=' ]]; then before=${COMP_WORDS[COMP_CWORD - 2]}\n"
           "    elif [[ $COMP_CWORD -ge 2 && $word == '=' ]]; then word=\n"
           "    fi\n"
           "    if [[ $COMP_CWORD -eq 1 ]]; then\n"
           "        _bitvox_words '");
    for (int i = 0; (c = commands[i]) != NULL; i++) printf("%s ", c->name);
    printf("help --help --version'\n"
           "        return\n"
           "    fi\n"
           "    for ((i = 2; i < COMP_CWORD; i++)); do\n"
           "        if [[ ${COMP_WORDS[i]} == -- ]]; then _bitvox_files; return; fi\n"
           "    done\n"
           "    case $command/$before in\n");
    for (int i = 0; (c = commands[i]) != NULL; i++) put_values(c);
    printf("    help/help) _bitvox_words '");
    for (int i = 0; (c = commands[i]) != NULL; i++) printf("%s ", c->name);
    printf("--man --bash-completion'; return ;;\n"
           "    help/*) return ;;\n"
           "    esac\n"
           "    case $word in\n"
           "    -*) ;;\n"
           "    *) _bitvox_files; return ;;\n"
           "    esac\n"
           "    case $command in\n");
    for (int i = 0; (c = commands[i]) != NULL; i++) {
        printf("    %s) _bitvox_words '", c->name);
        const cli_argument *row[CLI_MAX_OPTIONS];
        int const rows = cli_list_rows(c, row);
        for (int k = 0; k < rows; k++) printf(" %s", row[k]->name);
        printf("' ;;\n");
    }
    printf("    esac\n"
           "}\n\n"
           "complete -o default -F _bitvox bitvox\n");
}
