/* render_scene.h - what a picture shows: one mesh, one grid, or two grids compared. */
#ifndef BVX_CLI_RENDER_SCENE_H
#define BVX_CLI_RENDER_SCENE_H

#include "cli_commands/commands.h"

/* What the command takes for itself; zero stands for "not given". */
typedef struct cli_render_options {
    cli_list size;
    cli_triple from;
    cli_triple up;
    int32_t voxels; /* along the longest axis; 0: draw the mesh */
    bvx_render_options picture;
    cli_sheet slices;
    int32_t difference; /* --compare */
} cli_render_options;

typedef struct cli_scene {
    cli_input input[2]; /* one, or the two that are compared */
    int compared;
    bvx_grid_difference difference; /* of two */
} cli_scene;

/* Read input number first, or with --compare it and the next; meshes are voxelized where that is requested.
 */
int cli_open_scene(cli_run *run, int first, cli_scene *scene);
/* A picture of it, of this size. */
int cli_draw_scene(cli_run *run, const cli_scene *scene, int32_t width, int32_t height, bvx_image *image);
void cli_free_scene(cli_run *run, cli_scene *scene);

#endif
