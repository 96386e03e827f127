/* thin.c - voxels whose axis cross meets a triangle: the three unit segments through the centre, along x, y
 * and z.
 *
 * Source: Laine. A Topological Approach to Voxelization. 2013 (the target of a 6-separating surface is the
 * cross).
 *
 * A line of centres along an axis meets the triangle in one point at most; the voxel in which that point lies
 * is marked. Ties fall as everywhere (covered_rows.h): the point that decides is the centre moved by (e_x,
 * e_y, e_z), e_x >> e_y >> e_z > 0, so along each axis exactly one voxel's segment holds a crossing. Of two
 * neighbours whose centres lie on different sides of a surface one is marked: the crossing between them lies
 * in one of their segments.
 * Most triangles of a scan hold no line, or one or two; lines are counted for a batch at a time, few lines
 * are tried one by one, rows of many are cut by divisions.
 * With job->solid only crossings are marked that the solid does not show: neither of the two centres beside
 * them is in it.
 * Guarantee: exact; 6-separating. */
#include "touch/touch_cells.h"

enum { THIN_FEW = 4 }; /* lines of a row that are tried one by one */

/* Axes: the line's, then the two across it in order of their displacement. */
static const int thin_axes[3][3] = {{0, 1, 2}, {1, 0, 2}, {2, 0, 1}};

/* A triangle's lines along an axis: coordinates and voxels in the order of thin_axes. */
typedef struct thin_lines {
    bvxi_surface_tile *tile;
    const int *axis;
    uint32_t triangle;
    /* voxels along the line that the tile holds; lines across: centres in the triangle's range */
    int32_t low[3], high[3];
    uint64_t bits[3]; /* of the solid, from centre to centre along each */
    int32_t ready;    /* 1: divider is set up */
    int32_t facing;   /* 1: places are summed, as no other axis is nearer to the triangle's normal */
    bvxi_triangle t;
    bvxi_divider divider;
} thin_lines;

/* Three edge functions: at the first line, from line to line along u and
 * along v. Not negative inside, ties included. */
typedef struct thin_edges {
    int64_t at[3], along_u[3], along_v[3];
} thin_edges;

/* The triangle's extent along coordinate a. */
static double thin_extent(const bvxi_triangle *t, int a)
{
    /* Without a branch for each order: minimum and maximum of pairs, then of both. */
    int32_t const p = t->p[0][a], q = t->p[1][a], r = t->p[2][a];
    int32_t const least = p < q ? (p < r ? p : r) : (q < r ? q : r);
    int32_t const most = p > q ? (p > r ? p : r) : (q > r ? q : r);
    return (double)most - (double)least;
}

/* The last centre of a line before it crosses the triangle; -1: that is before the first of the window. Where
 * cross_along has moved the triangle by half a voxel, it is the voxel that holds the crossing. *place: where
 * it crosses. */
static inline int32_t line_crossing(thin_lines *l, int32_t u, int32_t v, double *place)
{
    int32_t const f = l->tile->job->fraction_bits;
    double const step = (double)(1 << f), half = 0.5 * step;

    /* Set up for the first line that is hit: most triangles have none. */
    if (!l->ready) {
        bvxi_divider_setup(&l->t, f, thin_extent(&l->t, 1), thin_extent(&l->t, 2), &l->divider);
        l->ready = 1;
    }
    *place = bvxi_cross_place(&l->divider, (double)u * step + half, (double)v * step + half);
    return bvxi_cross(&l->t, &l->divider, f, (double)u * step + half, (double)v * step + half, u, v) - 1;
}

static inline int is_solid_on_line(const thin_lines *l, int32_t w, int32_t u, int32_t v)
{
    const bvx_grid *const solid = l->tile->job->solid;
    uint64_t const bit = (uint64_t)w * l->bits[0] + (uint64_t)u * l->bits[1] + (uint64_t)v * l->bits[2];

    return w >= 0 && w < solid->size[l->axis[0]] && (solid->words[bit >> 6] >> (bit & 63) & 1) != 0;
}

/* The solid ends half way between centres w and w + 1 of which it has one; the surface does at place. Counted
 * by the tile of the voxel that holds the place. */
static inline void add_beyond(thin_lines *l, int32_t w, double place, int below)
{
    double const part = place - (double)w;
    int32_t const holder = part < 0.5 ? w : w + 1;
    /* faces through a centre: there, but for rounding */
    if (!(part > -0.25 && part < 1.25) || holder < l->low[0] || holder > l->high[0]) return;
    int32_t const beyond = (int32_t)(part * 65536.0) - 32768;
    l->tile->job->beyond[l->tile->number][l->axis[0]] += below ? beyond : -beyond;
}

/* A line (u, v) that the triangle covers: mark where it crosses. */
static inline void cross_line(thin_lines *l, int32_t u, int32_t v)
{
    bvxi_surface_job *const job = l->tile->job;
    double place;
    int32_t voxel[3], w = line_crossing(l, u, v, &place);

    /* What the solid shows needs no mark: one of the two centres beside the crossing is in it. */
    if (job->solid != NULL) {
        int const below = is_solid_on_line(l, w, u, v), above = is_solid_on_line(l, w + 1, u, v);
        if (below != above && l->facing) add_beyond(l, w, place, below);
        if (below | above) return;

        /* The voxel that holds the crossing between centres w and w + 1: the crossing again, exactly, of
         * the triangle moved by half a voxel, so that both ways of marking choose the same voxel. */
        int32_t const f = l->tile->job->fraction_bits, half = 1 << f >> 1;
        bvxi_triangle moved = l->t;
        /* Moved by half a voxel, the crossing of a centre's line becomes that of a voxel's border. */
        for (int c = 0; c < 3; c++) moved.p[c][0] += half;
        w = bvxi_cross_exact(&moved, f, u, v) - 1 > w ? w + 1 : w;
    }
    if (w < l->low[0] || w > l->high[0]) return;
    voxel[l->axis[0]] = w;
    voxel[l->axis[1]] = u;
    voxel[l->axis[2]] = v;
    bvxi_touch_run(job, voxel[1], voxel[2], voxel[0], voxel[0], l->triangle);
}

static void make_edges(const thin_lines *l, thin_edges *e)
{
    int64_t const step = (int64_t)1 << l->tile->job->fraction_bits, half = step >> 1;

    for (int i = 0; i < 3; i++) {
        const int32_t *const p = l->t.p[i], *const q = l->t.p[i == 2 ? 0 : i + 1];
        int64_t const du = (int64_t)q[1] - p[1], dv = (int64_t)q[2] - p[2];
        /* 0 counts as inside by the rule of ties (covered_rows.h); elsewhere one less, so that not negative
         * always means covered */
        int64_t const bias = dv < 0 || (dv == 0 && du > 0) ? 0 : 1;
        e->at[i] = du * (l->low[2] * step + half - p[2]) - dv * (l->low[1] * step + half - p[1]) - bias;
        e->along_u[i] = -dv * step;
        e->along_v[i] = du * step;
    }
}

static void try_lines(thin_lines *l)
{
    thin_edges e;

    make_edges(l, &e);
    for (int32_t v = l->low[2]; v <= l->high[2]; v++) {
        int64_t a = e.at[0], b = e.at[1], c = e.at[2];
        for (int32_t u = l->low[1]; u <= l->high[1]; u++) {
            if ((a | b | c) >= 0) cross_line(l, u, v);
            a += e.along_u[0];
            b += e.along_u[1];
            c += e.along_u[2];
        }
        for (int i = 0; i < 3; i++) e.at[i] += e.along_v[i];
    }
}

static void cut_lines(thin_lines *l)
{
    int64_t const step = (int64_t)1 << l->tile->job->fraction_bits, half = step >> 1;
    for (int32_t v = l->low[2]; v <= l->high[2]; v++) {
        int64_t first = 0, last = (int64_t)l->high[1] - l->low[1];
        /* One division for each edge gives the range of lines that are inside. */
        bvxi_cover_span(&l->t, l->low[1] * step + half, v * step + half, step, &first, &last);
        for (int64_t n = first; n <= last; n++) cross_line(l, l->low[1] + (int32_t)n, v);
    }
}

/* The axis that a triangle's normal is nearest to; of several the first. */
static int facing_axis(const bvxi_touch_batch *b, uint32_t i)
{
    int64_t u[3], v[3], most = -1;
    int facing = 0;

    for (int a = 0; a < 3; a++) {
        u[a] = (int64_t)b->p[1][a][i] - b->p[0][a][i];
        v[a] = (int64_t)b->p[2][a][i] - b->p[0][a][i];
    }
    for (int a = 0; a < 3; a++) {
        int const y = a == 2 ? 0 : a + 1, z = a == 0 ? 2 : a - 1;
        int64_t const n = u[y] * v[z] - u[z] * v[y], size = n < 0 ? -n : n;
        facing = size > most ? a : facing;
        most = size > most ? size : most;
    }
    return facing;
}

/* By the bits of one line alone: of any two neighbours from first to last + 1 the solid has one, so it shows
 * what crosses between these. Long ways are not worth a look. */
static inline int is_shown(const thin_lines *l, int32_t first, int32_t last)
{
    int32_t const u = l->low[1], v = l->low[2];
    int shown = last - first < THIN_FEW, below = shown && is_solid_on_line(l, first, u, v);

    for (int32_t w = first + 1; shown && w <= last + 1; w++) {
        int const above = is_solid_on_line(l, w, u, v);
        shown = below | above;
        below = above;
    }
    return shown;
}

/* Line (j, k) by three edges: 1 where the triangle covers it, -1 where not, 0 where ties decide. Differences
 * have 31 bits, products 62. */
static inline int covers_line(const bvxi_touch_batch *b, uint32_t i, int u, int v, int32_t f, int32_t j,
                              int32_t k)
{
    int64_t const step = (int64_t)1 << f, at_u = j * step + (step >> 1), at_v = k * step + (step >> 1);
    int64_t const au = b->p[0][u][i] - at_u, av = b->p[0][v][i] - at_v;
    int64_t const bu = b->p[1][u][i] - at_u, bv = b->p[1][v][i] - at_v;
    int64_t const cu = b->p[2][u][i] - at_u, cv = b->p[2][v][i] - at_v;
    int64_t const ab = au * bv - av * bu, bc = bu * cv - bv * cu, ca = cu * av - cv * au;

    if ((ab | bc | ca) < 0 && (-ab | -bc | -ca) < 0) return -1;
    return ab != 0 && bc != 0 && ca != 0;
}

/* By the first coordinate that differs; no two corners of a triangle with area are equal. */
static int least_corner(const int32_t q[3][3])
{
    int least = 0;
    for (int c = 1; c < 3; c++) {
        int a = 0;
        while (a < 2 && q[c][a] == q[least][a]) a++;
        if (q[c][a] < q[least][a]) least = c;
    }
    return least;
}

/* Lines that the triangle may cover; alone: it covers the only one. */
static void mark_thin_lines(thin_lines *l, const bvxi_touch_batch *b, uint32_t i, int axis, int alone)
{
    const bvxi_surface_job *const job = l->tile->job;
    /* Half a voxel along the line turns "the last centre before" into "the voxel that holds it". Not beside a
     * solid: there cross_line asks the two centres first. */
    int32_t const shift = job->solid != NULL ? 0 : 1 << job->fraction_bits >> 1;
    int32_t q[3][3];

    for (int c = 0; c < 3; c++)
        for (int a = 0; a < 3; a++) q[c][a] = b->p[c][l->axis[a]][i] + (a == 0 ? shift : 0);
    /* Places that are summed have the same bits for any order of corners from the least corner on. */
    int const first = l->facing ? least_corner((const int32_t(*)[3])q) : 0;
    if (!bvxi_triangle_setup(q[first], q[(first + 1) % 3], q[(first + 2) % 3], &l->t)) return;
    bvxi_triangle_walk(&l->t, axis);
    l->ready = 0;
    /* A few lines are tried by additions; the ranges of many are divided out. */
    if (alone) cross_line(l, l->low[1], l->low[2]);
    else if (l->high[1] - l->low[1] < THIN_FEW) try_lines(l);
    else cut_lines(l);
}

/* Triangle i of the batch along an axis, which u and v cross; low and high: the voxels of the tile by axis.
 * *facing: the axis along which its places are summed, -1: not known yet. */
static inline void cross_along(bvxi_surface_tile *tile, const bvxi_touch_batch *b, uint32_t i, int axis,
                               int *facing, const int32_t low[3], const int32_t high[3])
{
    const bvxi_surface_job *const job = tile->job;
    uint64_t const row = (uint64_t)job->grid->words_per_row * 64,
                   bits[3] = {1, row, row * (uint64_t)job->size[1]};
    int const u = axis == 0 ? 1 : 0, v = axis == 2 ? 1 : 2;
    /* Along the line the whole tile counts; across it, only centres in the triangle's range. */
    int32_t const low_u = b->low[u][i] < low[u] ? low[u] : b->low[u][i];
    int32_t const low_v = b->low[v][i] < low[v] ? low[v] : b->low[v][i];
    int32_t const high_u = b->high[u][i] > high[u] ? high[u] : b->high[u][i];
    int32_t const high_v = b->high[v][i] > high[v] ? high[v] : b->high[v][i];
    int const single = low_u == high_u && low_v == high_v;
    int covers = 0;

    if (low_u > high_u || low_v > high_v) return;
    /* Of fine meshes most triangles have one line at most, beside them. */
    if (single) covers = covers_line(b, i, u, v, job->fraction_bits, low_u, low_v);
    if (covers < 0) return;

    if (job->summed && *facing < 0) *facing = facing_axis(b, i);
    thin_lines l = {.tile = tile,
                    .axis = thin_axes[axis],
                    .triangle = b->triangle[i],
                    .low = {low[axis], low_u, low_v},
                    .high = {high[axis], high_u, high_v},
                    .bits = {bits[axis], bits[u], bits[v]},
                    .facing = job->summed && *facing == axis};
    /* Before the triangle is made ready: nearly all that face another axis. */
    if (single && job->solid != NULL && !l.facing && is_shown(&l, b->low[axis][i] - 1, b->high[axis][i]))
        return;
    mark_thin_lines(&l, b, i, axis, covers);
}

void bvxi_touch_thin(bvxi_surface_tile *tile, const uint32_t *id, uint64_t count)
{
    const bvxi_surface_job *const job = tile->job;
    int32_t const f = job->fraction_bits, half = 1 << f >> 1;
    int32_t const low[3] = {0, tile->rows.j0, tile->rows.k0};
    int32_t const high[3] = {job->size[0] - 1, tile->rows.j1 - 1, tile->rows.k1 - 1};
    bvxi_touch_batch b;

    for (uint64_t done = 0; done < count; done += BVXI_TOUCH_BATCH) {
        uint32_t const n = (uint32_t)(count - done < BVXI_TOUCH_BATCH ? count - done : BVXI_TOUCH_BATCH);
        bvxi_batch_gather(job, id, done, n, &b);
        /* from the first centre at or after the least coordinate to the last one before the greatest: half
         * open, as the rule of ties moves centres */
        bvxi_batch_boxes(&b, n, f, half - 1, -half - 1);
        for (uint32_t i = 0; i < n; i++) {
            /* A triangle crosses lines along an axis only where its box holds a centre along both others. */
            int const x = b.low[0][i] <= b.high[0][i];
            int const y = b.low[1][i] <= b.high[1][i];
            int const z = b.low[2][i] <= b.high[2][i];
            int facing = -1;
            if (y & z) cross_along(tile, &b, i, 0, &facing, low, high);
            if (x & z) cross_along(tile, &b, i, 1, &facing, low, high);
            if (x & y) cross_along(tile, &b, i, 2, &facing, low, high);
        }
    }
}
