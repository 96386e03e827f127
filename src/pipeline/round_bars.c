/* round_bars.c - bars of a few voxels get back what chords cut off them.
 *
 * Marching cubes put vertices on the mesh, so the surface of a round bar is inscribed: it lacks 15 % of its
 * volume at 2 voxels, 8 % at 3, 2 % at 6. Here the vertices of bars move until, triangle by triangle, as much
 * lies beyond the mesh as short of it. That also brings the surface nearer.
 * Guarantee: that of the surface before, as flatten.c checks each step. What is even, hollow or thicker stays
 * to the bit. Numbers and threads do not show. */
#include "mesh/facet.h"
#include "pipeline/thicken.h"

#define BAR_EVEN   0.999 /* of a vertex: its triangles' areas as vectors summed, over the areas' sum */
#define BAR_NEAR   0.5   /* a mesh that is farther off is none: a lid [Units: voxels] */
#define BAR_ON     0.3   /* nor are vertices of the mesh farther off [Units: voxels] */
#define BAR_MOST   0.25  /* a round moves a vertex no farther, */
#define BAR_LEAST  (1.0 / 256.0) /* and all together not less [Units: voxels] */
#define BAR_GRAINS 1048576.0     /* of a voxel */

enum { BAR_THICK = 6 /* voxels */, BAR_ROUNDS = 2, BAR_TASK = 256 };

typedef struct bar_vertex {
    double normal[3]; /* all in voxels of the lattice */
    double moved;     /* along it */
    double off[3];    /* from where it stands to the mesh */
    double rise;      /* of the vertices around, along normal: below 0 where the surface is convex */
    double lack;      /* of its triangles, six times the volume between them and the mesh */
    double gain;      /* what a step of 1 along normal adds to them, at three vertices */
    uint32_t vertex;
    int32_t still; /* 1: of a lid or shell */
} bar_vertex;

typedef struct bar_job {
    const bvx_grid *inside;
    const bvx_mesh *surface;
    double *place; /* of the surface's vertices [Size: vertices * 3] [Units: voxels of the lattice] */
    /* of each: its triangles' areas along their normals, summed, and the sum of their sizes; then the unit
     * normal, and how bent it is around [Size: vertices * 4] */
    double *sums;
    uint32_t *number; /* of each vertex among bar, plus 1 [Size: vertices] */
    bar_vertex *bar;
    uint32_t *triangle; /* with a vertex of bar */
    double *lack;       /* of each of these */
    uint64_t vertices, count, triangles;
    bvx_closest closest;
    int32_t pieces;
} bar_job;

static const uint32_t *bar_corners(const bar_job *b, uint64_t t)
{
    return b->surface->triangles + 3 * t;
}

/* n: twice its area, along its normal. */
static inline void bar_triangle(const bar_job *b, uint64_t t, const double *p[3], double n[3])
{
    for (int k = 0; k < 3; k++) p[k] = b->place + 3 * (uint64_t)bar_corners(b, t)[k];
    bvxi_area_normal(p[0], p[1], p[2], n);
}

/* ---- Which vertices ---- */

/* Does the solid end within BAR_THICK steps of a way? */
static int ends_along(const bar_job *b, const double p[3], const double way[3])
{
    const bvx_grid *const g = b->inside;
    for (int step = 1; step <= BAR_THICK; step++) {
        double at[3];
        for (int a = 0; a < 3; a++) at[a] = p[a] + way[a] * step - g->low[a];
        if (!bvxi_grid_at(g, at)) return 1;
    }
    return 0;
}

/* Straight down and at 45 degrees to four sides: a dent in a thick body ends some of these ways, not all. */
static int is_on_bar(const bar_job *b, const double p[3], const double n[3])
{
    double const x = bvxi_absolute(n[0]), y = bvxi_absolute(n[1]), z = bvxi_absolute(n[2]);
    double axis[3] = {0, 0, 0}, side[2][3], way[3] = {-n[0], -n[1], -n[2]}, length;

    if (!ends_along(b, p, way)) return 0;
    axis[x <= y && x <= z ? 0 : y <= z ? 1 : 2] = 1;
    bvxi_vec_cross(n, axis, side[0]);
    length = bvxi_vec_length(side[0]);
    for (int a = 0; a < 3; a++) side[0][a] /= length;
    bvxi_vec_cross(n, side[0], side[1]);
    for (int k = 0; k < 4; k++) {
        for (int a = 0; a < 3; a++) way[a] = (k & 1 ? side[k >> 1][a] : -side[k >> 1][a]) - n[a];
        if (!ends_along(b, p, way)) return 0;
    }
    return 1;
}

/* Number the bent vertices of bars. What is rough has points like these: of a vertex's triangles a third have
 * such vertices only. */
static void number_bars(bar_job *b)
{
    for (uint64_t v = 0; v < b->vertices; v++) {
        double *const sum = b->sums + 4 * v, length = bvxi_vec_length(sum);
        int const bent = length > 0 && length < BAR_EVEN * sum[3];
        for (int a = 0; bent && a < 3; a++) sum[a] /= length;
        sum[3] = 0;
        b->number[v] = (uint32_t)(bent && is_on_bar(b, b->place + 3 * v, sum));
        b->count += b->number[v];
    }
    for (uint64_t t = 0; b->count != 0 && t < b->surface->triangle_count; t++) {
        const uint32_t *const c = bar_corners(b, t);
        double const bent = (b->number[c[0]] & b->number[c[1]] & b->number[c[2]]) != 0 ? 2 : -1;
        for (int k = 0; k < 3; k++) b->sums[4 * (uint64_t)c[k] + 3] += bent;
    }
    b->count = 0;
    for (uint64_t v = 0; v < b->vertices; v++)
        if (b->number[v] != 0) b->number[v] = b->sums[4 * v + 3] >= 0 ? (uint32_t)++b->count : 0;
}

static void list_bars(bar_job *b)
{
    for (uint64_t v = 0; v < b->vertices; v++) {
        if (b->number[v] == 0) continue;
        b->bar[b->number[v] - 1].vertex = (uint32_t)v;
        memcpy(b->bar[b->number[v] - 1].normal, b->sums + 4 * v, 3 * sizeof *b->sums);
    }
    for (uint64_t t = 0; t < b->surface->triangle_count; t++) {
        const uint32_t *const c = bar_corners(b, t);
        if ((b->number[c[0]] | b->number[c[1]] | b->number[c[2]]) != 0)
            b->triangle[b->triangles++] = (uint32_t)t;
    }
}

static bvx_status find_bars(bvx_context *ctx, bar_job *b)
{
    uint64_t const triangles = b->surface->triangle_count;

    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, b->vertices * 24, "the vertices' places", &b->place));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, b->vertices * 4, "the bars' vertices", &b->number));
    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, b->vertices * 32, "the vertices' normals", &b->sums));

    const bvx_lattice *const l = &b->inside->lattice;
    bvx_mesh_view view;

    bvx_mesh_view_of(b->surface, &view);
    for (uint64_t v = 0; v < b->vertices; v++) {
        double *const p = b->place + 3 * v;
        bvxi_view_position(&view, v, p);
        for (int a = 0; a < 3; a++) p[a] = (p[a] + b->surface->frame[a] - l->origin[a]) / l->spacing[a];
    }

    for (uint64_t t = 0; t < b->surface->triangle_count; t++) {
        const double *p[3];
        double n[3], size;

        bar_triangle(b, t, p, n);
        size = bvxi_vec_length(n);
        for (int k = 0; k < 3; k++) {
            double *const sum = b->sums + 4 * (uint64_t)bar_corners(b, t)[k];
            for (int a = 0; a < 3; a++) sum[a] += n[a];
            sum[3] += size;
        }
    }

    number_bars(b);
    if (b->count == 0) return BVX_OK;
    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, b->count * sizeof *b->bar, "the bars' vertices", &b->bar));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, triangles * 4, "the bars' triangles", &b->triangle));
    list_bars(b);
    bvxi_drop(ctx, b->sums);
    return bvxi_alloc(ctx, BVXI_SCRATCH, b->triangles * 8, "the bars' volumes", &b->lack);
}

/* ---- How far they move ---- */

/* From a place to the mesh, both in voxels. */
static void way_to_mesh(const bar_job *b, const double at[3], uint32_t *hint, double off[3])
{
    const bvx_lattice *const l = &b->inside->lattice;
    bvx_closest_point found;
    double p[3];
    for (int a = 0; a < 3; a++) p[a] = at[a] * l->spacing[a] + l->origin[a];
    bvxi_closest_ask(&b->closest, p, hint, &found);
    for (int a = 0; a < 3; a++) off[a] = (found.position[a] - l->origin[a]) / l->spacing[a] - at[a];
}

static void look_from_vertices(void *user, uint64_t begin, uint64_t end)
{
    const bar_job *const b = user;
    uint32_t hint = 0;
    for (uint64_t n = begin; n < end; n++)
        way_to_mesh(b, b->place + 3 * (uint64_t)b->bar[n].vertex, &hint, b->bar[n].off);
}

/* The mesh over a triangle is taken as a surface of second order: for its volume the middle counts three
 * quarters, each corner a twelfth. */
static void look_from_triangles(void *user, uint64_t begin, uint64_t end)
{
    const bar_job *const b = user;
    uint32_t hint = 0;

    for (uint64_t i = begin; i < end; i++) {
        const uint32_t *const c = bar_corners(b, b->triangle[i]);
        const double *p[3];
        double n[3], middle[3], off[3];

        bar_triangle(b, b->triangle[i], p, n);
        for (int a = 0; a < 3; a++) middle[a] = (p[0][a] + p[1][a] + p[2][a]) / 3;
        way_to_mesh(b, middle, &hint, off);
        b->lack[i] = 0;
        if (!(bvxi_vec_dot(off, off) < BAR_NEAR * BAR_NEAR)) continue;
        b->lack[i] = 0.75 * bvxi_vec_dot(off, n);
        for (int k = 0; k < 3; k++)
            if (b->number[c[k]] != 0) b->lack[i] += bvxi_vec_dot(b->bar[b->number[c[k]] - 1].off, n) / 12;
    }
}

/* Each vertex makes up for a third of what its triangles lack: together, for all of it. */
static void move_bars(bar_job *b)
{
    for (uint64_t n = 0; n < b->count; n++) b->bar[n].lack = b->bar[n].gain = b->bar[n].rise = 0;
    for (uint64_t i = 0; i < b->triangles; i++) {
        const double *p[3];
        double area[3];

        bar_triangle(b, b->triangle[i], p, area);
        for (int k = 0; k < 3; k++) {
            uint32_t const number = b->number[bar_corners(b, b->triangle[i])[k]];
            bar_vertex *const v = number != 0 ? &b->bar[number - 1] : NULL;

            if (v == NULL) continue;
            v->lack += b->lack[i];
            v->gain += bvxi_vec_dot(area, v->normal);
            for (int j = 0; j < 3; j++) v->rise += bvxi_vec_dot(p[j], v->normal);
            v->rise -= 3 * bvxi_vec_dot(p[k], v->normal);
        }
    }
    for (uint64_t n = 0; n < b->count; n++) {
        bar_vertex *const v = &b->bar[n];
        double step = v->gain > 0 && v->rise < 0 && !v->still ? v->lack / v->gain : 0;

        if (step > BAR_MOST) step = BAR_MOST;
        if (step < -BAR_MOST) step = -BAR_MOST;
        /* Whole grains, so that last digits do not show: closest points have others in a flipped triangle. */
        step = floor(step * BAR_GRAINS + 0.5) / BAR_GRAINS;
        v->moved += step;
        for (uint64_t a = 0; a < 3; a++) b->place[3 * (uint64_t)v->vertex + a] += step * v->normal[a];
    }
}

static bvx_status aim_bars(bvx_context *ctx, const char *function, const bvx_mesh_view *body, bar_job *b)
{
    double low[3], high[3];

    BVXI_TRY(bvxi_view_bounds(ctx, function, body, low, high));
    BVXI_TRY(bvxi_closest_build_unnumbered(bvxi_call_of(ctx, function, "thin", 0.0, 0.3), body, low, high,
                                           bvxi_unit_scale(low, high), &b->closest.tree));
    b->pieces = bvxi_piece_count(b->triangles, BAR_TASK);
    for (int round = 0; round < BAR_ROUNDS; round++) {
        double const at = 0.3 + 0.35 * round;

        BVXI_TRY(bvxi_for_ranges(ctx, "thin", at, at + 0.1, b->pieces, b->count, look_from_vertices, b));
        for (uint64_t n = 0; round == 0 && n < b->count; n++)
            b->bar[n].still = !(bvxi_vec_dot(b->bar[n].off, b->bar[n].off) < BAR_ON * BAR_ON);
        BVXI_TRY(bvxi_for_ranges(ctx, "thin", at + 0.1, at + 0.35, b->pieces, b->triangles,
                                 look_from_triangles, b));
        move_bars(b);
    }
    return BVX_OK;
}

bvx_status bvxi_round_bars(bvx_context *ctx, const char *function, const bvx_grid *inside,
                           const bvx_mesh_view *body, bvx_mesh *surface)
{
    bar_job b = {.inside = inside, .surface = surface, .vertices = surface->vertex_count};
    if (body->triangle_count == 0) return BVX_OK;
    BVXI_TRY(find_bars(ctx, &b));
    if (b.count == 0) return BVX_OK;
    bvx_status const status = BVXI_SHARE(ctx, 0.0, 0.5, aim_bars(ctx, function, body, &b));
    bvxi_closest_shut(ctx, &b.closest);
    BVXI_TRY(status);

    /* Those that have moved, numbered anew; place: where to, as the surface has it. */
    const bvx_lattice *const l = &b.inside->lattice;
    uint64_t count = 0;
    for (uint64_t n = 0; n < b.count; n++) {
        const bar_vertex *const v = &b.bar[n];
        double *const p = b.place + 3 * (uint64_t)v->vertex;
        b.number[v->vertex] = bvxi_absolute(v->moved) >= BAR_LEAST ? (uint32_t)++count : 0;
        for (int a = 0; a < 3; a++) p[a] = p[a] * l->spacing[a] + l->origin[a] - b.surface->frame[a];
    }
    b.count = count;
    return BVXI_SHARE(ctx, 0.5, 1.0,
                      bvxi_move_apart(ctx, function, inside, b.number, b.count, b.place, surface));
}
