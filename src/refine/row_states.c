/* row_states.c - what is outside in a tree with a window: by the exact rule of rows.
 *
 * No triangle touches a leaf that is not of the surface, so all of it lies on one side, and any centre in it
 * says which. Leaves up to level `outer` ask the solid of that level's lattice; finer ones, which all lie
 * near the window, ask a part of the solid of their own level, made of the triangles that reach its rows
 * only.
 * (Snapped to a coarser lattice a vertex moves by 2^-16 of a voxel; the centre of a voxel that no triangle
 * touches is half a voxel away.) Guarantee: the same for any threads. */
#include "refine/refine.h"

typedef struct row_states_job {
    bvx_octree *tree;
    int32_t outer;
    bvx_grid solid[BVXI_OCTREE_LEVELS + 1]; /* by level from outer on; that of outer is whole */
} row_states_job;

static void decide_voxel(const row_states_job *job, const bvxi_octets *o, uint64_t bit, const int32_t v[3],
                         int32_t level)
{
    if (!bvxi_octets_is_split(o, bit)) {
        /* Coarse leaves ask the solid of level outer, at the voxel of their low corner: a leaf has one side. */
        int32_t const down = level <= job->outer ? job->outer - level : 0;
        const bvx_grid *const g = &job->solid[level + down];
        if (!bvxi_bit_of(o->touched, bit) &&
            !bvx_grid_get(g, (v[0] << down) - g->low[0], (v[1] << down) - g->low[1],
                          (v[2] << down) - g->low[2]))
            o->outside[bit >> 6] |= UINT64_C(1) << (bit & 63);
        return;
    }
    uint64_t const octet = bvxi_octets_rank(o, bit);
    /* The last octets are the most by far: eight voxels with one look. */
    if (level + 1 == job->tree->levels) {
        /* The octets of the last level but one, all eight children at once; solids begin at even voxels. */
        const bvxi_octets *const last = &job->tree->octets[job->tree->levels - 1];
        const bvx_grid *const g = &job->solid[job->tree->levels];
        uint64_t const row = (uint64_t)g->words_per_row, slice = row * (uint64_t)g->size[1];
        int32_t const x = 2 * v[0] - g->low[0], y = 2 * v[1] - g->low[1], z = 2 * v[2] - g->low[2];
        const uint64_t *const at = g->words + (uint64_t)z * slice + (uint64_t)y * row + (uint64_t)(x >> 6);
        unsigned const shift = (unsigned)x & 63;
        uint32_t const inside = (uint32_t)((at[0] >> shift & 3) | (at[row] >> shift & 3) << 2 |
                                           (at[slice] >> shift & 3) << 4 |
                                           (at[slice + row] >> shift & 3) << 6);
        bvxi_octet_put(last->outside, octet, 255 & ~(inside | bvxi_octet_mask(last->touched, octet)));
        return;
    }
    for (uint32_t p = 0; p < 8; p++) {
        int32_t child[3];
        bvxi_child_voxel(v, p, child);
        decide_voxel(job, &job->tree->octets[level], 8 * octet + p, child, level + 1);
    }
}

/* ---- the triangles near the window ---- */

/* Do a triangle's rows, along x, come near the window? Its ends grow to whole voxels of level `outer`. */
static int rows_meet_window(const bvxi_refine_job *job, const uint32_t corner[3])
{
    int32_t const up = job->tree->levels - job->outer, shift = up + job->tree->lattice.fraction_bits;

    for (uint32_t a = 1; a < 3; a++) {
        int32_t low = INT32_MAX, high = INT32_MIN;
        for (int c = 0; c < 3; c++) {
            int32_t const q = job->snapped.xyz[3 * (size_t)corner[c] + a];
            low = q < low ? q : low;
            high = q > high ? q : high;
        }

        if (bvxi_floor_shift(high, shift) < job->low[a] >> up ||
            bvxi_floor_shift(low - 1, shift) > job->last[a] >> up)
            return 0;
    }
    return 1;
}

/* Three positions a triangle, in doubles; NULL: count. */
static uint64_t gather_near(const bvxi_refine_job *job, double *positions)
{
    uint64_t n = 0;
    for (uint64_t t = 0; t < job->view->triangle_count; t++) {
        uint32_t corner[3];
        bvxi_view_triangle(job->view, t, corner);
        if (!rows_meet_window(job, corner)) continue;
        for (uint64_t c = 0; c < 3 && positions != NULL; c++)
            bvxi_view_position(job->view, corner[c], positions + 3 * (3 * n + c));
        n++;
    }
    return n;
}

/* ---- the solids ---- */

static bvx_status make_solids(bvxi_refine_job *job, const bvx_mesh_view *nearby, row_states_job *rows)
{
    bvx_context *const ctx = job->ctx;
    /* Nearby triangles are an open mesh, and rows are what is requested. */
    bvx_voxelize_options o = {.struct_size = sizeof o, .fill = BVX_FILL_PARITY};

    for (int32_t l = job->outer; l <= job->tree->levels; l++) {
        bvx_lattice lattice;
        BVXI_TRY(bvxi_octree_lattice(ctx, job->tree, l, &lattice));

        /* Without a triangle nearby all rows are empty; a mesh without triangles is refused. */
        if (l > job->outer && nearby->triangle_count == 0)
            BVXI_TRY(bvx_grid_create(ctx, &lattice, &o.window, &rows->solid[l]));
        else
            BVXI_TRY(
                bvx_voxelize_solid(ctx, l == job->outer ? job->view : nearby, &lattice, &o, &rows->solid[l]));

        /* The first solid is of the whole lattice; each finer one of the children of all voxels that meet the
         * tree's window, in whole pairs, so that all children of a split voxel are in it. */
        for (int a = 0; a < 3 && l < job->tree->levels; a++) {
            o.window.low[a] = 2 * (job->low[a] >> (job->tree->levels - l));
            o.window.size[a] = 2 * ((job->last[a] >> (job->tree->levels - l)) + 1) - o.window.low[a];
        }
    }
    return BVX_OK;
}

static bvx_status decide_by_solids(bvxi_refine_job *job, const bvx_mesh_view *nearby)
{
    row_states_job *rows;
    BVXI_TRY(bvxi_alloc_zero(job->ctx, BVXI_SCRATCH, sizeof *rows, "the window's solids", &rows));
    rows->tree = job->tree;
    rows->outer = job->outer;
    bvx_status const status = make_solids(job, nearby, rows);
    for (int32_t z = 0; z < job->tree->base[2] && status == BVX_OK; z++)
        for (int32_t y = 0; y < job->tree->base[1]; y++)
            for (int32_t x = 0; x < job->tree->base[0]; x++)
                decide_voxel(rows, &job->tree->root, bvxi_root_bit(job->tree, x, y, z), (int32_t[3]){x, y, z},
                             0);
    for (int32_t l = job->tree->levels; l >= job->outer; l--) bvx_grid_free(job->ctx, &rows->solid[l]);
    return status;
}

bvx_status bvxi_octree_row_states(bvxi_refine_job *job)
{
    uint64_t const count = gather_near(job, NULL);
    double *positions = NULL;
    /* A copy of most of the mesh would cost more than it saves. */
    if (count > job->view->triangle_count / 2) return decide_by_solids(job, job->view);
    BVXI_TRY(bvxi_alloc(job->ctx, BVXI_SCRATCH, count * 72, "the triangles near the window", &positions));
    gather_near(job, positions);
    bvx_mesh_view nearby = {
        .positions = positions, .position_type = BVX_F64, .triangle_count = count, .vertex_count = 3 * count};
    return decide_by_solids(job, &nearby);
}
