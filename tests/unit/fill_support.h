/* fill_support.h - what the tests of floods and regions share: bodies, and
 * a scene of all that the oracles look at. */
#ifndef FILL_SUPPORT_H
#define FILL_SUPPORT_H

#include "solid_support.h"
#include "tools/fill_oracle.h"

static inline bvx_status fill_lattice(const bvx_lattice *l, int32_t fill, int32_t gaps, bvx_grid *g,
                                      bvx_solid_report *r)
{
    bvx_mesh_view const view = maker_view(&mesh);
    bvx_voxelize_options o = {.struct_size = sizeof o};

    o.fill = fill;
    o.close_gaps = gaps;
    o.report = r;
    memset(g, 0, sizeof *g);
    return bvx_voxelize_solid(ctx, &view, l, &o, g);
}

static inline bvx_grid surface_of(const bvx_lattice *l)
{
    bvx_mesh_view const view = maker_view(&mesh);
    bvx_grid g = {0};
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_voxelize_surface(ctx, &view, l, NULL, &g));
    return g;
}

/* Bytes by voxel. sure: 1 where the parities agree and balance along all axes or, where the triangles run one
 * way, the solid angle lies within a quarter of a turn of a whole number; known off the surface only. */
typedef struct fill_scene {
    int32_t n[3];
    size_t count;
    bvx_grid surface, vote;
    uint8_t *open, *in, *sure;
    int one_way; /* 0: there may be more sure ones */
} fill_scene;

static inline int is_sure_centre(const bvx_lattice *l, const int64_t *q, const int64_t c[3], int one_way)
{
    double scale[3], turns;
    int b[3], p[3], unused;

    for (int a = 0; a < 3; a++) {
        p[a] = fill_parity_at(q, mesh.t, mesh.triangles, c, a, &b[a]);
        scale[a] = l->spacing[a] / (1 << l->fraction_bits);
    }
    if (b[0] && b[1] && b[2] && p[0] == p[1] && p[1] == p[2]) return 1;
    if (!one_way) return 0;
    turns = fill_turns_at(q, mesh.t, mesh.triangles, c, fill_unmoved, scale, &unused);
    return fabs(turns - floor(turns + 0.5)) < 0.25;
}

static inline fill_scene open_scene(const bvx_lattice *l)
{
    int64_t *const q = snapped(l);
    fill_scene s;

    memcpy(s.n, l->dims, sizeof s.n);
    s.count = (size_t)s.n[0] * (size_t)s.n[1] * (size_t)s.n[2];
    s.surface = surface_of(l);
    s.vote = solid_of(l, BVX_FILL_VOTE);
    s.open = fill_bytes(&s.surface, 1);
    s.in = fill_bytes(&s.vote, 0);
    s.sure = maker_grow(NULL, s.count);
    s.one_way = fill_runs_one_way(q, mesh.t, mesh.triangles);
    for (int32_t z = 0; z < s.n[2]; z++)
        for (int32_t y = 0; y < s.n[1]; y++)
            for (int32_t x = 0; x < s.n[0]; x++) {
                size_t const i = fill_place(s.n, x, y, z);
                int64_t const c[3] = {oracle_centre(x, l->fraction_bits), oracle_centre(y, l->fraction_bits),
                                      oracle_centre(z, l->fraction_bits)};
                s.sure[i] = s.open[i] ? (uint8_t)is_sure_centre(l, q, c, s.one_way) : 0;
            }
    free(q);
    return s;
}

static inline void close_scene(fill_scene *s)
{
    free(s->sure);
    free(s->in);
    free(s->open);
    bvx_grid_free(ctx, &s->vote);
    bvx_grid_free(ctx, &s->surface);
}

/* Up to three bodies that may meet; some lack triangles. */
static inline void make_bodies(int32_t trial, const bvx_lattice *l)
{
    maker_clear(&mesh);
    for (int32_t n = 0; n <= trial % 3; n++) {
        double centre[3], radius[3];
        for (int a = 0; a < 3; a++) {
            centre[a] = maker_between(&seed, 0.3 * l->dims[a], 0.7 * l->dims[a], 16);
            radius[a] = 0.15 * l->dims[a] + maker_below(&seed, l->dims[a] / 4 + 1);
        }
        maker_star(&mesh, &seed, centre, radius, 0.3, 6, 9, 65536);
    }
    for (int32_t i = 0; i < trial % 5; i++)
        maker_remove(&mesh, (size_t)maker_below(&seed, (int32_t)mesh.triangles));
}

static const int32_t shapes[][3] = {{70, 14, 13}, {20, 22, 21}, {13, 66, 12},
                                    {12, 14, 65}, {12, 1, 12},  {64, 10, 10}};
enum { SHAPES = sizeof shapes / sizeof shapes[0] };

#endif
