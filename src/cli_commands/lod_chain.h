/* lod_chain.h - a chain of levels while it is made. */
#ifndef BVX_CLI_LOD_CHAIN_H
#define BVX_CLI_LOD_CHAIN_H

#include "cli_commands/commands.h"

/* What the command takes for itself. */
typedef struct cli_lod_options {
    bvx_lod_options samples;   /* --method edge-ratio, coverage */
    bvx_levels_options levels; /* --method collapse */
    int32_t outer_hull;
    int32_t method;       /* 1 + BVX_LOD_... or CLI_METHOD_COLLAPSE; 0: not given */
    cli_list resolutions; /* --levels */
} cli_lod_options;

typedef struct cli_chain {
    int kind;       /* of the input, CLI_MESH or CLI_GRID */
    bvx_mesh input; /* of a grid: its surface, where distances are measured */
    uint64_t input_triangles;
    bvx_mesh_view view;
    bvx_certificate certificate; /* of the input */
    double diagonal;
    bvx_grid solid;
    bvx_solid_report solid_report;
    double solid_seconds;
    int32_t resolution; /* of the solid */
    const char *chosen; /* how */
    int by_triangles, asked;
    int count; /* of levels made so far, which stand first below; those that keep nothing have no place */
    bvx_mesh mesh[CLI_MAX_LEVELS];
    char *path[CLI_MAX_LEVELS];
    bvx_lod_report lod[CLI_MAX_LEVELS];
    bvx_distance_report distance[CLI_MAX_LEVELS];
} cli_chain;

/* Samples along the longest axis of a level that is not made by a count of triangles. */
int32_t cli_level_resolution(const cli_run *run, const cli_chain *chain, int level);
/* Read the input and make the solid, with all that levels are compared with. */
int cli_open_chain(cli_run *run, cli_chain *chain);

/* lod_collapse.c: --method collapse, for meshes. */
extern const cli_job cli_lod_collapse;

#endif
