/* contour_input.c - contours of sections by their file. */
#include "cli_inputs/inputs.h"

#include <stdlib.h>

int cli_is_contours(const cli_run *run, const char *path)
{
    int32_t const format = cli_input_format(run, path);

    return format == BVX_FORMAT_CSL || format == BVX_FORMAT_CSV;
}

int cli_read_sections(cli_run *run, const char *path, bvx_sections *sections)
{
    cli_bytes b = {NULL, 0, 0, 0};
    int status = cli_open_input(run, path, &b);

    if (status == CLI_DONE) {
        bvx_read_sections_options o;
        bvx_status read;
        bvx_read_sections_options_init(&o, sizeof o);
        o.close_gap = run->options->close_gap;
        cli_stage_begin(run, "parse");
        read = bvx_read_sections(run->context, b.bytes, b.size, cli_input_format(run, path), &o, sections);
        cli_end_parse(run, b.size);
        status = cli_check_call(run, read, cli_input_name(path));
    }
    /* Contours are copied out of the text. */
    free(b.bytes);
    return status;
}
