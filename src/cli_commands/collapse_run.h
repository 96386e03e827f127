/* collapse_run.h - a chain of levels that edges collapse to, while it is made: what lod and simplify share.
 */
#ifndef BVX_CLI_COLLAPSE_RUN_H
#define BVX_CLI_COLLAPSE_RUN_H

#include "cli_commands/commands.h"

typedef struct cli_collapse_run {
    int kind;       /* of the input, CLI_MESH or CLI_GRID */
    bvx_mesh input; /* of a grid: its surface */
    bvx_mesh_view view;
    bvx_certificate before;  /* of the input, vertices at equal positions taken as one */
    bvx_certificate surface; /* of what the levels were made from */
    int solid;               /* 1: that is a measured surface */
    double diagonal;         /* of the input */
    int usual_count;         /* levels where none are requested; 0: by the input's triangles */
    int count;               /* levels; 0: not yet known */
    int by_error;
    uint64_t target[CLI_MAX_LEVELS];
    double error[CLI_MAX_LEVELS]; /* [Units: world] */
    bvx_mesh mesh[CLI_MAX_LEVELS];
    char *path[CLI_MAX_LEVELS]; /* one for all where they go into one file */
    bvx_level_report level[CLI_MAX_LEVELS];
    bvx_distance_report distance[CLI_MAX_LEVELS];
    double seconds; /* that making all of them took */
} cli_collapse_run;

/* Refuse contradictions among targets and names of outputs; count is known where options say it. */
int cli_check_collapse(cli_run *run, cli_collapse_run *c);
/* Read the input, choose the targets, open the outputs. */
int cli_open_collapse(cli_run *run, cli_collapse_run *c);
bvx_targets cli_targets(const cli_run *run, const cli_collapse_run *c);
/* With levels, their reports, before, surface, source and seconds there: carry, measure. */
int cli_finish_collapse(cli_run *run, cli_collapse_run *c);
/* Of a job that begins with a cli_collapse_run. */
int cli_write_collapse(cli_run *run, void *job);
/* All that is to be said but for the first lines. */
void cli_tell_collapse(const cli_run *run, const cli_collapse_run *c, cli_made *made);
extern const cli_owned cli_collapse_owns[];

#endif
