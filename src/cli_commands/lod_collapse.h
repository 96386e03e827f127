/* lod_collapse.h - the method of lod that collapses edges. */
#ifndef BVX_CLI_LOD_COLLAPSE_H
#define BVX_CLI_LOD_COLLAPSE_H

#include "cli_commands/collapse_run.h"

typedef struct cli_lod_collapse {
    cli_collapse_run run; /* the first, as cli_write_collapse needs it */
    bvx_levels_report report;
} cli_lod_collapse;

/* lod by --method collapse; the input is a mesh by its name. */
int cli_lod_by_collapse(cli_run *run, cli_lod_collapse *l, cli_made *made);
void cli_tell_lod_collapse(const cli_run *run, const cli_lod_collapse *l, cli_made *made);

#endif
