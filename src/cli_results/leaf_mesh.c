/* leaf_mesh.c - refine --leaves: the leaves of an octree as boxes of their level's colour, opened by
 * --cut. */
#include "cli_results/results.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

enum { LEAF_VERTICES = 8, LEAF_TRIANGLES = 12, LEAF_COLOURS = 6 };

#define LEAF_BYTES      (LEAF_VERTICES * (3 * sizeof(double) + 4) + LEAF_TRIANGLES * 3 * sizeof(uint32_t))
#define LEAF_MESH_BYTES (UINT64_C(1) << 30) /* most bytes without --memory-limit */

static int is_cut_away(const cli_planes *cut, const double low[3], const double edge[3])
{
    for (int a = 0; a < 3; a++)
        if (cut->given[a] && low[a] + 0.5 * edge[a] > cut->value[a]) return 1;
    return 0;
}

/* Surface leaves are grey; others have a colour for each level, the same counted from the last one. */
static void colour_of_leaf(const bvx_octree_leaf *leaf, int32_t levels, uint8_t colour[4])
{
    static const uint8_t of_level[LEAF_COLOURS][3] = {{214, 92, 70},   {236, 152, 84}, {228, 190, 100},
                                                      {134, 176, 126}, {46, 148, 138}, {52, 92, 124}};
    static const uint8_t of_surface[3] = {200, 196, 188};
    /* Counted from the last level, so that the finest leaves look alike in trees of any depth. */
    const uint8_t *const c = leaf->state == BVX_STATE_SURFACE
                                 ? of_surface
                                 : of_level[(levels - leaf->level) % LEAF_COLOURS];
    for (int a = 0; a < 3; a++) colour[a] = c[a];
    colour[3] = 255;
}

/* Corner i of a box is high along x, y, z where its bits 0, 1, 2 are set. */
static void add_box(bvx_mesh *mesh, const double low[3], const double edge[3], const uint8_t colour[4])
{
    static const uint8_t sides[LEAF_TRIANGLES][3] = {{0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5},
                                                     {0, 1, 5}, {0, 5, 4}, {2, 6, 7}, {2, 7, 3},
                                                     {0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}};
    uint32_t const first = (uint32_t)mesh->vertex_count;
    double *const positions = (double *)mesh->positions + mesh->vertex_count * 3;
    uint32_t *const triangles = mesh->triangles + mesh->triangle_count * 3;

    for (int i = 0; i < LEAF_VERTICES; i++) {
        for (int a = 0; a < 3; a++) positions[3 * i + a] = low[a] + ((i >> a & 1) != 0 ? edge[a] : 0.0);
        memcpy(mesh->colours + (mesh->vertex_count + (uint64_t)i) * 4, colour, 4);
    }
    for (int i = 0; i < LEAF_TRIANGLES; i++)
        for (int k = 0; k < 3; k++) triangles[3 * i + k] = first + sides[i][k];
    mesh->vertex_count += LEAF_VERTICES;
    mesh->triangle_count += LEAF_TRIANGLES;
}

static int make_room(cli_run *run, uint64_t count, bvx_octree_leaf **leaves, bvx_mesh *mesh)
{
    uint64_t const bytes = count * (LEAF_BYTES + sizeof **leaves);
    uint64_t const limit = run->general->memory_limit != 0 ? run->general->memory_limit : LEAF_MESH_BYTES;

    if (count == 0) return cli_fail(run, "%s: no leaf has these states", run->options->output);
    if (bytes > limit || bytes > SIZE_MAX)
        return cli_fail(run,
                        "%s: %" PRIu64 " leaves as boxes would take %" PRIu64
                        " MiB: take .vtu, fewer --halvings or --states, or a larger "
                        "--memory-limit",
                        run->options->output, count, bytes >> 20);
    *leaves = malloc((size_t)count * sizeof **leaves);
    mesh->positions = malloc((size_t)count * LEAF_VERTICES * 3 * sizeof(double));
    mesh->triangles = malloc((size_t)count * LEAF_TRIANGLES * 3 * sizeof(uint32_t));
    mesh->colours = malloc((size_t)count * LEAF_VERTICES * 4);
    if (*leaves == NULL || mesh->positions == NULL || mesh->triangles == NULL || mesh->colours == NULL)
        return cli_fail(run, "no memory for %" PRIu64 " leaves", count);
    mesh->position_type = BVX_F64;
    mesh->vertex_capacity = count * LEAF_VERTICES;
    mesh->triangle_capacity = count * LEAF_TRIANGLES;
    cli_note_peak(run, bytes);
    return CLI_DONE;
}

int cli_make_leaf_mesh(cli_run *run, const bvx_octree *tree, bvx_mesh *mesh)
{
    const cli_options *const o = run->options;
    int32_t const levels = bvx_octree_levels(tree);
    bvx_octree_leaf *leaves = NULL;
    uint64_t count = 0;
    bvx_status status = bvx_octree_leaves(run->context, tree, o->states, NULL, 0, &count);
    /* Counted first, since a tree may have more leaves than memory has boxes. */
    int result = status == BVX_OK ? make_room(run, count, &leaves, mesh)
                                  : cli_fail_status(run, status, o->output);

    if (result == CLI_DONE) {
        status = bvx_octree_leaves(run->context, tree, o->states, leaves, count, &count);
        if (status != BVX_OK) result = cli_fail_status(run, status, o->output);
    }
    if (result == CLI_DONE) {
        for (uint64_t i = 0; i < count; i++) {
            /* Leaves count in voxels of their own level, the lattice in those of the last one. */
            double const voxels = (double)(UINT32_C(1) << (levels - leaves[i].level));
            double low[3], edge[3];
            uint8_t colour[4];
            for (int a = 0; a < 3; a++) {
                edge[a] = run->report.lattice.spacing[a] * voxels;
                low[a] = run->report.lattice.origin[a] + (double)leaves[i].ijk[a] * edge[a];
            }
            if (is_cut_away(&o->cut, low, edge)) continue;
            colour_of_leaf(&leaves[i], levels, colour);
            add_box(mesh, low, edge, colour);
        }
    }
    if (result == CLI_DONE && mesh->triangle_count == 0)
        result = cli_fail(run, "%s: --cut leaves nothing", o->output);
    free(leaves);
    return result;
}

void cli_free_leaf_mesh(bvx_mesh *mesh)
{
    free(mesh->positions);
    free(mesh->triangles);
    free(mesh->colours);
    memset(mesh, 0, sizeof *mesh);
}
