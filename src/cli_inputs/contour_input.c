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
    int status = cli_read_file(run, path, &b);

    if (status == CLI_DONE && run->context == NULL) status = cli_make_context(run, b.size);
    if (status == CLI_DONE) {
        bvx_read_sections_options o;
        bvx_status read;
        bvx_read_sections_options_init(&o, sizeof o);
        o.close_gap = run->options->close_gap;
        cli_stage_begin(run, "parse");
        read = bvx_read_sections(run->context, b.bytes, b.size, cli_input_format(run, path), &o, sections);
        cli_stage_end(run);
        if (read != BVX_OK) status = cli_fail_status(run, read, cli_input_name(path));
    }
    /* Contours are copied out of the text. */
    free(b.bytes);
    return status;
}
