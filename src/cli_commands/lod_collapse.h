/* lod_collapse.h - the method of lod that collapses edges. */
#ifndef BVX_CLI_LOD_COLLAPSE_H
#define BVX_CLI_LOD_COLLAPSE_H

#include "cli_commands/commands.h"

/* All of lod by --method collapse; the input is a mesh by its name. */
int cli_lod_by_collapse(cli_run *run);

#endif
