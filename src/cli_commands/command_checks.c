/* command_checks.c - what holds for all commands once the words of the command line are taken. */
#include "cli_commands/commands.h"

#include <string.h>

static const cli_rule line_rules[] = {
    {.given = "--output-origin",
     .lacking = "-o --output-dir",
     .message = "%o needs -o, with the name of a mesh"},
    {.given = "--quantize", .lacking = "-o --output-dir", .message = "%o needs -o, with the name of a .glb"},
    {.unless = CLI_TO_MESH, .given = "--output-origin", .message = "%o is for meshes; %f is not a mesh"},
    {.unless = CLI_TO_GLB, .given = "--quantize", .message = "%f: %o is for .glb"},
    {0}};

/* Of commands that write meshes; others have an --up of their own. */
static const cli_rule up_rules[] = {
    {.given = "--up --input-up",
     .lacking = "-o --output-dir",
     .message = "%o needs -o, with the name of a mesh"},
    {.unless = CLI_TO_MESH, .given = "--up --input-up", .message = "%o is for meshes; %f is not a mesh"},
    {.unless = CLI_HAS_UP,
     .given = "--up",
     .message = "%i: no axis is known to be up in the input; give it with --input-up beside %o"},
    {.unless = CLI_TO_UP,
     .given = "--input-up",
     .message = "%f: no axis is known to be up in this format; give it with --up beside %o"},
    {0}};

int cli_check_line(cli_run *run)
{
    const cli_options *const o = run->options;
    const char *const name = run->command->name;
    int const least = run->command->least_inputs;
    int const writes = o->output != NULL && strcmp(o->output, "-") == 0;
    int standard = 0;

    if (o->inputs == 0) return cli_usage(run, "%s lacks its input file; see 'bitvox %s --help'", name, name);
    if (o->inputs < least)
        return cli_usage(run, "%s lacks an input: bitvox %s %s", name, name, run->command->usage);
    for (int i = 0; i < o->inputs; i++) standard += strcmp(o->input[i], "-") == 0;
    if (standard != 0 && o->format == 0)
        return cli_usage(run, "standard input has no name that gives the format; give it with --format");
    if (standard == 0 && !writes && o->output_dir == NULL && o->format != 0)
        return cli_usage(run, "--format is for standard input and output, '-'; file names give theirs");
    if (o->output_dir != NULL) {
        int const kind = cli_kind_of_format(o->format);

        if (o->output != NULL) return cli_usage(run, "-o and --output-dir exclude each other");
        for (int i = 0; i < o->inputs; i++)
            if (strcmp(o->input[i], "-") == 0)
                return cli_usage(run, "standard input has no name; --output-dir is for files");
        /* One --format serves all files, so the command must be able to write it. */
        if (o->format != 0 &&
            (kind == 0 || ((run->command->bit & (CLI_REPAIR | CLI_SIMPLIFY | CLI_LOD | CLI_HULL)) != 0 &&
                           kind != CLI_MESH)))
            return cli_usage(run, "--format %s is not written by %s", cli_format_name(o->format),
                             run->command->name);
        if (run->command->bit == CLI_CONVERT && o->format == 0)
            return cli_usage(run,
                             "convert lacks the format of the files in --output-dir; give it with --format");
        return CLI_DONE;
    }
    if (o->output == NULL && (run->command->bit & (CLI_COMPONENTS | CLI_CHECK)) == 0 && cli_takes(run, "-o"))
        return cli_usage(run, "%s lacks -o FILE; see 'bitvox %s --help'", name, name);
    CLI_TRY(cli_check_pattern(run));
    if (writes && cli_take_standard_output(run) != CLI_DONE) return CLI_USAGE;
    return cli_check_options(run);
}

int cli_check_options(cli_run *run)
{
    const cli_general *const g = run->general;
    /* The output has its name by now, -o - included; with --output-dir this is done for each input. */
    cli_find_facts(run);
    CLI_TRY(cli_check_rules(run, line_rules, 0, NULL));
    if (cli_takes(run, "--input-up")) CLI_TRY(cli_check_rules(run, up_rules, 0, NULL));
    CLI_TRY(cli_check_volume_options(run));
    CLI_TRY(cli_check_parts(run));
    if (g->quiet && g->progress == CLI_BAR_DRAW)
        return cli_usage(run, "--quiet and --progress=bar exclude each other");
    return CLI_DONE;
}
