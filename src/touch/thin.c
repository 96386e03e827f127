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
 * Most triangles of a scan hold no line, or one or two: blocks of two by two are judged some hundred at once, in
 * doubles that hold every number exactly. What is left, and what lies near to a centre, goes row by row: divisions
 * give the lines that the triangle covers.
 * With job->solid only crossings are marked that the solid does not show: neither of the two centres beside
 * them is in it.
 * Guarantee: exact; 6-separating. */
#include "touch/touch_cells.h"

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

/* The triangle's extent along coordinate a. */
static double thin_extent(const bvxi_triangle *t, int a)
{
    return (double)bvxi_most_of_three(t->p[0][a], t->p[1][a], t->p[2][a]) -
           (double)bvxi_least_of_three(t->p[0][a], t->p[1][a], t->p[2][a]);
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

/* The solid ends half way between two centres of which it has one, that below or the other; the surface does a part
 * of the way after the first. */
static inline int32_t beyond_at(double part, int below)
{
    int32_t const beyond = (int32_t)(part * 65536.0) - 32768;
    return below ? beyond : -beyond;
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
        /* A place after centre w, counted by the tile of the voxel that holds it. */
        if (below != above && l->facing) {
            double const part = place - (double)w;
            int32_t const holder = part < 0.5 ? w : w + 1;
            /* faces through a centre: there, but for rounding */
            if (part > -0.25 && part < 1.25 && holder >= l->low[0] && holder <= l->high[0])
                job->beyond[l->tile->number][l->axis[0]] += beyond_at(part, below);
        }
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
    int first = 0;
    for (int c = 1; c < 3 && l->facing; c++) {
        int a = 0;
        /* By the first coordinate that differs; no two corners of a triangle with area are equal. */
        while (a < 2 && q[c][a] == q[first][a]) a++;
        if (q[c][a] < q[first][a]) first = c;
    }
    if (!bvxi_triangle_setup(q[first], q[(first + 1) % 3], q[(first + 2) % 3], &l->t)) return;
    bvxi_triangle_walk(&l->t, axis);
    l->ready = 0;
    if (alone) {
        cross_line(l, l->low[1], l->low[2]);
        return;
    }
    int64_t const step = (int64_t)1 << job->fraction_bits, half = step >> 1;
    for (int32_t v = l->low[2]; v <= l->high[2]; v++) {
        int64_t begin = 0, last = (int64_t)l->high[1] - l->low[1];
        /* One division for each edge gives the range of lines that are inside. */
        bvxi_cover_span(&l->t, l->low[1] * step + half, v * step + half, step, &begin, &last);
        for (int64_t n = begin; n <= last; n++) cross_line(l, l->low[1] + (int32_t)n, v);
    }
}

/* Triangle i of the batch along an axis, which u and v cross; low and high: the voxels of the tile by axis. */
static inline void cross_along(bvxi_surface_tile *tile, const bvxi_touch_batch *b, uint32_t i, int axis,
                               const int32_t low[3], const int32_t high[3])
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

    if (low_u > high_u || low_v > high_v) return;
    thin_lines l = {.tile = tile,
                    .axis = thin_axes[axis],
                    .triangle = b->triangle[i],
                    .low = {low[axis], low_u, low_v},
                    .high = {high[axis], high_u, high_v},
                    .bits = {bits[axis], bits[u], bits[v]},
                    .facing = job->summed && facing_axis(b, i) == axis};
    mark_thin_lines(&l, b, i, axis, 0);
}

/* ---- Lines of small triangles, some hundred at once ---- */

/* A triangle's lines are taken here when they are few, in blocks of two by two. Corners relative to a line's centre
 * are then below (THIN_MANY + 1) 2^16 < 2^21 across the axis and 2^31 along it, edge functions below 2^44, parts of
 * the normal below 2^53: integers, exact in doubles.
 * Arrays are a cache line longer than a power of two, so that they do not stand in each other's way. */
enum {
    THIN_MANY = 16,
    THIN_BLOCKS = BVXI_TOUCH_BATCH * THIN_MANY / 2 + 16,
    THIN_HITS = 256 + 16,
    THIN_MORE = 16
};

/* Blocks of lines along one axis. The batch's triangles have one each, in their order, then come further ones. */
typedef struct line_blocks {
    uint32_t count;
    uint16_t triangle[THIN_BLOCKS], hit[THIN_BLOCKS];
    int32_t u[THIN_BLOCKS], v[THIN_BLOCKS]; /* the first line */
    int32_t lines[THIN_BLOCKS];   /* bits: the first, the next along u, along v, along both; THIN_MORE */
    int64_t inside[THIN_BLOCKS];  /* of these, those that the triangle covers */
    int32_t p[3][2][THIN_BLOCKS]; /* corner, across the axis: to the first line's centre */
} line_blocks;

/* Lines that triangles cover. */
typedef struct line_hits {
    uint32_t count;
    uint16_t pair[THIN_HITS];   /* block << 2 | line of it */
    int32_t q[3][3][THIN_HITS]; /* corner, along the axis: to the window; across it: to the line's centre */
    double least[3][THIN_HITS]; /* of its least corner */
    double before[THIN_HITS];   /* the last centre before it */
    int32_t beyond[THIN_HITS];  /* what the way from there is more than a half [Units: 2^-16 voxels] */
    int64_t sure[THIN_HITS], facing[THIN_HITS]; /* 1: that is certain; the axis is nearest to the normal */
} line_hits;

/* What is asked of a batch's lines along one axis. */
typedef struct line_axis {
    bvxi_surface_tile *tile;
    const bvxi_touch_batch *b;
    line_blocks *blocks;
    line_hits *hits;
    const int32_t *low, *high; /* voxels of the tile by axis */
    int axis, u, v;
    double order[2]; /* of u and v: 1 where axis comes after it */
} line_axis;

/* The first block of each triangle: centres in its range and the tile. */
BVXI_VECTOR_INLINE void place_first_blocks(const line_axis *s, uint32_t n)
{
    line_blocks *BVXI_RESTRICT const l = s->blocks;
    int32_t const f = s->tile->job->fraction_bits, half = 1 << f >> 1;
    const int32_t *BVXI_RESTRICT const least_u = s->b->low[s->u],
                                       *BVXI_RESTRICT const least_v = s->b->low[s->v];
    const int32_t *BVXI_RESTRICT const most_u = s->b->high[s->u],
                                       *BVXI_RESTRICT const most_v = s->b->high[s->v];
    int32_t const low_u = s->low[s->u], low_v = s->low[s->v], high_u = s->high[s->u], high_v = s->high[s->v];

    for (uint32_t i = 0; i < n; i++) {
        int32_t const u = least_u[i] < low_u ? low_u : least_u[i],
                      v = least_v[i] < low_v ? low_v : least_v[i];
        int32_t const last_u = most_u[i] > high_u ? high_u : most_u[i];
        int32_t const last_v = most_v[i] > high_v ? high_v : most_v[i];
        /* Sums and products: of choices a compiler makes branches and stores by mask. */
        int32_t const some_u = u <= last_u, some_v = v <= last_v;
        int32_t const more = (most_u[i] - least_u[i] > 1) | (most_v[i] - least_v[i] > 1);
        l->u[i] = u;
        l->v[i] = v;
        l->lines[i] = (some_u + 2 * (u < last_u)) * (some_v + 4 * (v < last_v)) +
                      some_u * some_v * more * THIN_MORE;
    }
    for (int c = 0; c < 3; c++) {
        const int32_t *BVXI_RESTRICT const pu = s->b->p[c][s->u], *BVXI_RESTRICT const pv = s->b->p[c][s->v];
        for (uint32_t i = 0; i < n; i++) {
            l->p[c][0][i] = pu[i] - (l->u[i] * (1 << f) + half);
            l->p[c][1][i] = pv[i] - (l->v[i] * (1 << f) + half);
        }
    }
    l->count = n;
}

/* The other blocks of triangles that have some; those of many lines are crossed row by row. */
BVXI_VECTOR_INLINE void place_more_blocks(const line_axis *s, uint32_t n)
{
    line_blocks *const l = s->blocks;
    const bvxi_touch_batch *const b = s->b;
    int const u = s->u, v = s->v;
    int32_t const f = s->tile->job->fraction_bits;
    uint32_t large = 0;

    for (uint32_t i = 0; i < n; i++) {
        l->hit[large] = (uint16_t)i;
        large += (uint32_t)l->lines[i] / THIN_MORE;
    }
    for (uint32_t m = 0; m < large; m++) {
        uint32_t const i = l->hit[m];
        int32_t const wide = b->high[u][i] - b->low[u][i], tall = b->high[v][i] - b->low[v][i];
        if ((int64_t)(wide + 1) * (tall + 1) > THIN_MANY) {
            cross_along(s->tile, b, i, s->axis, s->low, s->high);
            l->lines[i] = 0;
            continue;
        }
        int32_t const last_u = b->high[u][i] > s->high[u] ? s->high[u] : b->high[u][i];
        int32_t const last_v = b->high[v][i] > s->high[v] ? s->high[v] : b->high[v][i];
        for (int32_t k = l->v[i]; k <= last_v; k += 2)
            for (int32_t j = l->u[i]; j <= last_u; j += 2) {
                uint32_t const to = l->count;
                if (j == l->u[i] && k == l->v[i]) continue;
                l->triangle[to] = (uint16_t)i;
                l->u[to] = j;
                l->v[to] = k;
                l->lines[to] = (j < last_u ? 3 : 1) * (k < last_v ? 5 : 1);
                for (int c = 0; c < 3; c++) {
                    l->p[c][0][to] = l->p[c][0][i] - (j - l->u[i]) * (1 << f);
                    l->p[c][1][to] = l->p[c][1][i] - (k - l->v[i]) * (1 << f);
                }
                l->count++;
            }
    }
}

BVXI_VECTOR_INLINE void judge_line_blocks(line_blocks *l, double step)
{
    /* Whole vectors; what is past the end is computed and never read. */
    uint32_t const n = (l->count + 7u) & ~7u;

    double area;

    for (uint32_t i = 0; i < n; i++)
        l->inside[i] = bvxi_judge_block((double)l->p[0][0][i], (double)l->p[0][1][i], (double)l->p[1][0][i],
                                        (double)l->p[1][1][i], (double)l->p[2][0][i], (double)l->p[2][1][i],
                                        step, &area);
}

/* The least corner by the coordinates' order: of the first two, then of all. One number has the first two. */
BVXI_VECTOR_INLINE void find_least_corners(line_hits *h)
{
    uint32_t const n = (h->count + 7u) & ~7u;

    for (uint32_t i = 0; i < n; i++) {
        double const aw = (double)h->q[0][0][i], bw = (double)h->q[1][0][i], cw = (double)h->q[2][0][i];
        double const au = (double)h->q[0][1][i], bu = (double)h->q[1][1][i], cu = (double)h->q[2][1][i];
        double const av = (double)h->q[0][2][i], bv = (double)h->q[1][2][i], cv = (double)h->q[2][2][i];
        double const ak = aw * 4194304.0 + au, bk = bw * 4194304.0 + bu, ck = cw * 4194304.0 + cu;
        double const ab = 2.0 * (bk - ak), tie = bv < av ? -1.0 : 0.0, first = ab + tie;
        double const mk = first < 0 ? bk : ak, mw = first < 0 ? bw : aw;
        double const mu = first < 0 ? bu : au, mv = first < 0 ? bv : av;
        double const mc = 2.0 * (ck - mk), other_tie = cv < mv ? -1.0 : 0.0, second = mc + other_tie;
        h->least[0][i] = second < 0 ? cw : mw;
        h->least[1][i] = second < 0 ? cu : mu;
        h->least[2][i] = second < 0 ? cv : mv;
    }
}

/* Where the triangles cross: what line_crossing computes, from the least corner on. */
BVXI_VECTOR_INLINE void place_crossings(line_hits *h, const double order[2], double step, double shift)
{
    uint32_t const n = (h->count + 7u) & ~7u;
    double const scale = 1.0 / step, half = 0.5 * step - shift, order_u = order[0], order_v = order[1];

    for (uint32_t i = 0; i < n; i++) {
        double const aw = (double)h->q[0][0][i], bw = (double)h->q[1][0][i], cw = (double)h->q[2][0][i];
        double const au = (double)h->q[0][1][i], bu = (double)h->q[1][1][i], cu = (double)h->q[2][1][i];
        double const av = (double)h->q[0][2][i], bv = (double)h->q[1][2][i], cv = (double)h->q[2][2][i];
        double const n0 = (bu - au) * (cv - av) - (bv - av) * (cu - au), turn = n0 < 0 ? -1.0 : 1.0;
        double const n1 = turn * ((bv - av) * (cw - aw) - (bw - aw) * (cv - av));
        double const n2 = turn * ((bw - aw) * (cu - au) - (bu - au) * (cw - aw));
        double const s0 = n0 < 0 ? -n0 : n0, s1 = n1 < 0 ? -n1 : n1, s2 = n2 < 0 ? -n2 : n2;
        double const t1 = s1 + order_u, t2 = s2 + order_v, most = t1 > t2 ? t1 : t2;

        double const least_u = au < bu ? au : bu, most_u = au < bu ? bu : au;
        double const least_v = av < bv ? av : bv, most_v = av < bv ? bv : av;
        double const wide = (most_u > cu ? most_u : cu) - (least_u < cu ? least_u : cu);
        double const tall = (most_v > cv ? most_v : cv) - (least_v < cv ? least_v : cv);
        /* Of a triangle seen from its edge nothing is certain. */
        double const edge_on = s0 > 0 ? 0.0 : 1.0, inverse = 1.0 / (s0 + edge_on);
        double const parts = (s1 * wide + s2 * tall) * inverse;
        double const error = (parts * (1.0 / 1125899906842624.0) + 1.0 / 1048576.0) * scale + edge_on;
        double const s = n1 * (0.0 - h->least[1][i]) + n2 * (0.0 - h->least[2][i]);
        double const place = (h->least[0][i] - half - s * inverse) * scale;
        /* Beyond that error the place may be anything, and what becomes of it, 0, is certain nowhere. A product, as
         * a choice would become a branch around all that goes before. */
        double const near = error < 0.25 ? 1.0 : 0.0, known = place * near, whole = (double)(int32_t)known;
        double const before = known < whole ? whole - 1.0 : whole, part = known - before;

        h->before[i] = before;
        h->beyond[i] = beyond_at(part, 1);
        h->sure[i] = (part < 1.0 - part ? part : 1.0 - part) > error ? 1 : 0;
        /* Of axes that are equally near to the normal the first. */
        h->facing[i] = most <= s0 ? 1 : 0;
    }
}

/* Corners of the triangles that cross lines. */
BVXI_VECTOR_INLINE void take_hit_corners(const line_axis *s)
{
    const line_blocks *const l = s->blocks;
    line_hits *const h = s->hits;
    int32_t const step = 1 << s->tile->job->fraction_bits;

    for (uint32_t n = 0; n < h->count; n++) {
        uint32_t const i = h->pair[n] >> 2, t = l->triangle[i];
        int32_t const u = (h->pair[n] & 1) * step, v = (h->pair[n] >> 1 & 1) * step;
        for (int c = 0; c < 3; c++) {
            h->q[c][0][n] = s->b->p[c][s->axis][t];
            h->q[c][1][n] = l->p[c][0][i] - u;
            h->q[c][2][n] = l->p[c][1][i] - v;
        }
    }
}

/* Mark the voxels of crossings; beside a solid sum what lies beyond voxels along lines that it shows, and mark the
 * others. No hit is left. */
BVXI_VECTOR_INLINE void take_hits(const line_axis *s)
{
    const bvxi_surface_job *const job = s->tile->job;
    const line_blocks *const l = s->blocks;
    line_hits *const h = s->hits;
    int const axis = s->axis;
    int32_t const last = job->size[axis] - 1, low = s->low[axis], high = s->high[axis];
    size_t const row = (size_t)job->grid->words_per_row * 64;
    size_t const bits[3] = {1, row, row * (size_t)job->size[1]};
    /* Half a voxel on, the last centre before is the voxel that holds the crossing: as in mark_thin_lines. */
    double const step = (double)(1 << job->fraction_bits), shift = job->solid != NULL ? 0.0 : 0.5 * step;
    const uint64_t *const solid = job->solid != NULL ? job->solid->words : NULL;
    uint32_t left = 0;
    int64_t sum = 0;

    take_hit_corners(s);
    find_least_corners(h);
    place_crossings(h, s->order, step, shift);
    for (uint32_t n = 0; n < h->count; n++) {
        uint32_t const pair = h->pair[n], i = pair >> 2;
        int32_t const u = l->u[i] + (int32_t)(pair & 1), v = l->v[i] + (int32_t)(pair >> 1 & 1);
        int32_t const w = (int32_t)h->before[n];
        int settled = (int)h->sure[n];

        if (solid == NULL) {
            int32_t voxel[3];
            voxel[axis] = w;
            voxel[s->u] = u;
            voxel[s->v] = v;
            if (BVXI_LIKELY(settled) && w >= low && w <= high)
                bvxi_touch_voxel(s->tile->job, voxel[0], voxel[1], voxel[2], s->b->triangle[l->triangle[i]]);
        } else {
            /* Products: half of all count, as chance will have it. */
            settled &= (w >= 0) & (w < last);
            size_t const is = (size_t)settled,
                         at = is * ((size_t)w * bits[axis] + (size_t)u * bits[s->u] + (size_t)v * bits[s->v]);
            size_t const next = at + is * bits[axis];
            int const below = (int)(solid[at >> 6] >> (at & 63) & 1);
            int const above = (int)(solid[next >> 6] >> (next & 63) & 1);
            int32_t const holder = w + (h->beyond[n] >= 0);
            int const counts = settled & (below ^ above) & (int)h->facing[n] & (holder >= low) &
                               (holder <= high);
            sum += (int64_t)counts * (2 * below - 1) * h->beyond[n];
            settled &= below | above;
        }
        h->pair[left] = (uint16_t)pair;
        h->facing[left] = h->facing[n];
        left += !settled;
    }
    for (uint32_t n = 0; n < left; n++) {
        uint32_t const i = h->pair[n] >> 2, t = l->triangle[i];
        int32_t const u = l->u[i] + (h->pair[n] & 1), v = l->v[i] + (h->pair[n] >> 1 & 1);
        thin_lines one = {.tile = s->tile,
                          .axis = thin_axes[axis],
                          .triangle = s->b->triangle[t],
                          .low = {s->low[axis], u, v},
                          .high = {s->high[axis], u, v},
                          .bits = {bits[axis], bits[s->u], bits[s->v]},
                          .facing = job->summed && h->facing[n]};
        mark_thin_lines(&one, s->b, t, axis, 1);
    }
    if (job->summed) s->tile->job->beyond[s->tile->number][axis] += sum;
    h->count = 0;
}

/* The lines of a batch along one axis. */
BVXI_VECTOR_INLINE void cross_line_blocks(const line_axis *s, uint32_t n)
{
    line_blocks *const l = s->blocks;
    line_hits *const h = s->hits;
    uint32_t count = 0;

    place_first_blocks(s, n);
    place_more_blocks(s, n);
    judge_line_blocks(l, (double)(1 << s->tile->job->fraction_bits));
    for (uint32_t i = 0; i < l->count; i++) {
        l->hit[count] = (uint16_t)i;
        count += (l->inside[i] & l->lines[i]) != 0;
    }
    for (uint32_t m = 0; m < count; m++) {
        uint32_t const i = l->hit[m], inside = (uint32_t)(l->inside[i] & l->lines[i]);
        if (h->count > THIN_HITS - 4) take_hits(s);
        for (uint32_t c = 0; c < 4; c++)
            h->pair[h->count + c] = (uint16_t)(4 * i + bvxi_inside_centres[inside][c]);
        h->count += bvxi_inside_count[inside];
    }
    take_hits(s);
}

/* The next batch of triangles. From the first centre at or after the least coordinate to the last one before the
 * greatest: half open, as the rule of ties moves centres. */
BVXI_VECTOR_INLINE uint32_t take_batch(const bvxi_surface_job *job, const uint32_t *id, uint64_t done,
                                       uint64_t count, bvxi_touch_batch *b)
{
    int32_t const half = 1 << job->fraction_bits >> 1;
    uint32_t const n = (uint32_t)(count - done < BVXI_TOUCH_BATCH ? count - done : BVXI_TOUCH_BATCH);
    bvxi_batch_gather(job, id, done, n, b);
    bvxi_batch_boxes(b, n, job->fraction_bits, half - 1, -half - 1);
    return n;
}

BVXI_VECTOR_INLINE void touch_line_blocks(bvxi_surface_tile *tile, const uint32_t *id, uint64_t count,
                                          const int32_t low[3], const int32_t high[3])
{
    bvxi_touch_batch b;
    line_blocks blocks;
    line_hits hits;

    hits.count = 0;
    for (uint16_t i = 0; i < BVXI_TOUCH_BATCH; i++) blocks.triangle[i] = i;
    for (uint64_t done = 0; done < count; done += BVXI_TOUCH_BATCH) {
        uint32_t const n = take_batch(tile->job, id, done, count, &b);
        for (int axis = 0; axis < 3; axis++) {
            int const u = thin_axes[axis][1], v = thin_axes[axis][2];
            double const order[2] = {u < axis ? 1.0 : 0.0, v < axis ? 1.0 : 0.0};
            line_axis const s = {tile, &b, &blocks, &hits, low, high, axis, u, v, {order[0], order[1]}};
            cross_line_blocks(&s, n);
        }
    }
}

BVXI_AVX2_COPY(touch_line_blocks_avx2,
               (bvxi_surface_tile * tile, const uint32_t *id, uint64_t count, const int32_t low[3],
                const int32_t high[3]),
               touch_line_blocks(tile, id, count, low, high))

void bvxi_touch_thin(bvxi_surface_tile *tile, const uint32_t *id, uint64_t count)
{
    const bvxi_surface_job *const job = tile->job;
    int32_t const low[3] = {0, tile->rows.j0, tile->rows.k0};
    int32_t const high[3] = {job->size[0] - 1, tile->rows.j1 - 1, tile->rows.k1 - 1};
    bvxi_touch_batch b;

    /* Lists of attached triangles take them one after the other. */
    if (job->task == BVXI_TOUCH_SET) {
        BVXI_PATH(job->cpu == BVX_CPU_AVX2, touch_line_blocks(tile, id, count, low, high),
                  touch_line_blocks_avx2(tile, id, count, low, high));
        return;
    }
    for (uint64_t done = 0; done < count; done += BVXI_TOUCH_BATCH) {
        uint32_t const n = take_batch(job, id, done, count, &b);
        for (uint32_t i = 0; i < n; i++) {
            /* A triangle crosses lines along an axis only where its box holds a centre along both others. */
            int const x = b.low[0][i] <= b.high[0][i];
            int const y = b.low[1][i] <= b.high[1][i];
            int const z = b.low[2][i] <= b.high[2][i];
            if (y & z) cross_along(tile, &b, i, 0, low, high);
            if (x & z) cross_along(tile, &b, i, 1, low, high);
            if (x & y) cross_along(tile, &b, i, 2, low, high);
        }
    }
}
