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
    int32_t turntable;  /* pictures; 0: one */
} cli_render_options;

typedef struct cli_scene {
    cli_input input[2]; /* one, or the two that are compared */
    int compared;
    bvx_grid_difference difference; /* of two */
} cli_scene;

/* Read input number first, or with --compare it and the next; meshes are voxelized where that is requested.
 */
int cli_open_scene(cli_run *run, int first, cli_scene *scene);
/* A picture of it, of this size, from this direction; the cut is the one of the options and of --from. The
 * frame shows at least so much on either side of its middle. */
int cli_draw_scene(cli_run *run, const cli_scene *scene, int32_t width, int32_t height,
                   const double direction[3], const double show[2], bvx_image *image);
/* What all frames of a turntable must show, so that the model keeps its size in them. */
void cli_turntable_room(cli_run *run, const cli_scene *scene, double show[2]);
void cli_free_scene(cli_run *run, cli_scene *scene);

/* From the model to the eye, and upwards, as the options say. */
void cli_scene_view(const cli_run *run, double direction[3], double up[3]);

#endif
