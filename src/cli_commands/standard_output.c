/* standard_output.c - "-o -": one output to standard output, its format by --format or by what the command
 * makes.
 *
 * From here on it has a name with an ending, as any output; what the program says goes to standard error. */
#if defined(__unix__) || defined(__APPLE__)
#define _POSIX_C_SOURCE 200809L
#define STANDARD_POSIX  1
#else
#define STANDARD_POSIX 0
#endif

#include "cli_commands/commands.h"

#include <stdio.h>
#include <string.h>
#if STANDARD_POSIX
#include <unistd.h>
#elif defined(_WIN32)
#include <io.h>
#endif

/* A command that writes what it reads: .bvx where all inputs are voxels. */
static int32_t format_of_inputs(const cli_run *run, int first)
{
    for (int i = first; i < run->options->inputs; i++)
        if (cli_kind_of_input(cli_input_format(run, run->options->input[i])) == CLI_MESH)
            return BVX_FORMAT_PLY;
    return BVX_FORMAT_BVX;
}

static int32_t usual_format(const cli_run *run)
{
    const cli_voxelize_options *const own = run->own;
    const cli_options *const o = run->options;

    switch (run->command->bit) {
    case CLI_RENDER: return BVX_FORMAT_PNG;
    case CLI_SLICE: return BVX_FORMAT_CSV;
    case CLI_VOXELIZE: return own->mode == CLI_MODE_FIELD ? BVX_FORMAT_NRRD : BVX_FORMAT_BVX;
    case CLI_MORPH:
        return o->inputs > 0 && strcmp(o->input[0], "distance") == 0 ? BVX_FORMAT_NRRD : BVX_FORMAT_BVX;
    case CLI_FILL:
    case CLI_COMPONENTS:
    case CLI_REFINE: return BVX_FORMAT_BVX;
    case CLI_CONVERT: return format_of_inputs(run, 0);
    case CLI_BOOLEAN: return format_of_inputs(run, 1);
    default: return BVX_FORMAT_PLY;
    }
}

int cli_take_standard_output(cli_run *run)
{
    const cli_options *const o = run->options;
    int32_t const usual = usual_format(run);
    int32_t format = usual;
    int reads = 0;

    /* --format may be meant for standard input: then it counts only for an output of the same kind. */
    for (int i = 0; i < o->inputs; i++) reads += strcmp(o->input[i], "-") == 0;
    if (o->format != 0 && run->command->bit != CLI_SECTIONS &&
        (reads == 0 || cli_kind_of_format(o->format) == cli_kind_of_format(usual)))
        format = o->format;
    const char *const known = format == BVX_FORMAT_CSV ? "csv" : cli_format_name(format);
    /* Bytes on a terminal may change its state; nobody wants them. */
#if STANDARD_POSIX
    int const terminal = isatty(STDOUT_FILENO);
#elif defined(_WIN32)
    int const terminal = _isatty(_fileno(stdout));
#else
    int const terminal = 0;
#endif
    if (terminal)
        return cli_usage(
            run, "standard output is a terminal, which cannot show a .%s file; send it to a file or a pipe",
            known);
    snprintf(run->standard_name, sizeof run->standard_name, "standard output.%s", known);
    run->options->output = run->standard_name;
    run->standard_taken = 1;
    return CLI_DONE;
}
