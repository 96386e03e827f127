/* smooth.c - smooth the vertices of a complex inside their cells.
 *
 * Sources: Gibson. Constrained Elastic Surface Nets. 1998 (towards the mean of the neighbours, no vertex leaves its
 * cell). Golub, Varga. Chebyshev Semi-iterative Methods. 1961 (weights with which few steps do the work of many).
 *
 * Steps go from one buffer to another, so no order of vertices shows; each goes on from the last two. On a junction
 * only neighbours along it count. Offsets are 16 bits a coordinate; links and area vectors are where positions will
 * be. Volumes of faces are whole numbers of them.
 * In seams of windows only neighbours in the same seams count, which all of these windows have.
 * What the faces between two labels have swept since the staircase is then undone: their free vertices move along
 * normals. A label's volume is that of its voxels and what all its faces have swept, since the walls that edges
 * sweep cancel; so it comes back without a system of equations over labels. */
#include "core/vec3.h"
#include "labels/labels.h"
#include "mesh/mesh.h"

enum {
    STEPS = 6 /* even: the last one ends in the offsets */,
    CORRECTIONS = 16,
    VERTEX_GRAIN = 4096,
    AHEAD = 16,
    LARGE_PAIR = 1 << 16,
    AXIS_SHIFT = 30,
    FACE_BITS = (1 << AXIS_SHIFT) - 1
};

#define SQUARE       ((int64_t)BVXI_NET_UNITS * BVXI_NET_UNITS)
#define VOLUME_UNITS (36.0 * BVXI_NET_UNITS * (double)SQUARE)

/* What waves keep is least for eigenvalues of the mean's step from 0.25 to 2. */
static float const relax_step = 2.0F / 2.25F;
static float const radius_squared = 1.75F / 2.25F * (1.75F / 2.25F);
static double const correct = 2.0;       /* further than any pair moves */
static double const longest_move = 0.25; /* move of a round [Units: voxels] */
static double const kept_volume = 1e-4;  /* most that a pair keeps, for each face [Units: voxels^3] */
static double const last_step = 8.0;     /* times that volume */

typedef struct net_work {
    bvxi_net *net;
    const int16_t *from;               /* offsets before a step */
    int16_t *to;                       /* those of the step before, then after this one */
    float of_last, of_own, of_mean[7]; /* weights of a step; of a sum by how many it has */
    float *areas;                      /* vectors of vertices; in the place of positions */
    uint32_t *pairs;                   /* where each pair's faces begin */
    uint32_t *faces;                   /* in the order of pairs, their axes in the highest bits */
    uint64_t pair_count;
    double *moved; /* of each pair, or correct */
} net_work;

static double limited(double x, double limit)
{
    return x < -limit ? -limit : x > limit ? limit : x;
}

static int16_t clamp(float most, float x)
{
    /* Positive when it is cut off, so it is rounded to the nearest. */
    return (int16_t)((int32_t)((x < -most ? -most : x > most ? most : x) + 32768.5F) - 32768);
}

/* The sides of its cell across which a vertex goes with others. */
static uint32_t sides_along(const bvxi_net *net, uint64_t vertex)
{
    uint32_t const junction = net->complex->junctions[vertex];
    uint32_t const mask = (junction & 63) != 0 ? junction & 63 : 63;
    uint64_t cell[3];

    if ((junction & BVX_AT_SEAM) == 0) return mask;
    if (bvxi_shares_cell(net->complex, vertex)) return 0;
    bvxi_cell_of(net->complex, vertex, cell);
    uint32_t const seams = bvxi_net_seams(net, cell);
    return mask & ~((seams & 1) * 3 | (seams >> 1 & 1) * 12 | (seams >> 2) * 48);
}

static void relax_range(void *user, uint64_t begin, uint64_t end)
{
    const net_work *const w = user;
    const bvxi_net *const net = w->net;

    for (uint64_t v = begin; v < end; v++) {
        const int16_t *const own = w->from + 3 * v;
        int16_t *const to = w->to + 3 * v;
        uint32_t const mask = net->complex->junctions[v] == 0 ? 63 : sides_along(net, v);
        float const most = (net->complex->junctions[v] & BVX_AT_SEAM) != 0 ? (float)BVXI_SEAM_LIMIT
                                                                           : (float)BVXI_NET_LIMIT;
        int32_t sum[3] = {0, 0, 0}, count = 0;

        for (int32_t side = 0; side < 6; side++) {
            uint32_t const link = bvxi_net_link(net, v, side);
            if ((mask >> side & 1) == 0 || link == UINT32_MAX) continue;
            const int16_t *const o = w->from + 3 * (size_t)link;
            for (int a = 0; a < 3; a++) sum[a] += o[a];
            sum[side >> 1] += (side & 1) != 0 ? BVXI_NET_UNITS : -BVXI_NET_UNITS;
            count++;
        }
        float const of_own = count == 0 ? w->of_own + w->of_mean[1] : w->of_own, of_sum = w->of_mean[count];
        for (int a = 0; a < 3; a++)
            to[a] = clamp(most, w->of_last * (float)to[a] + of_own * (float)own[a] + of_sum * (float)sum[a]);
    }
}

/* ---- Volumes between pairs of labels ---- */

/* Split faces along the shorter diagonal: beside a junction that has become straight the longer one would lie on it. */
static void split_faces(void *user, uint64_t begin, uint64_t end)
{
    const net_work *const w = user;

    for (uint64_t i = begin; i < end; i++) {
        uint32_t *const t = w->net->complex->mesh.triangles + 6 * (size_t)i;
        uint32_t const axis = bvxi_net_axis(w->net, (uint32_t)i);
        int64_t diagonal[2] = {0, 0};
        bvxi_face f;

        w->faces[i] = (uint32_t)i | axis << AXIS_SHIFT;
        bvxi_read_face(w->net, (uint32_t)i, axis, &f);
        for (int32_t n = 0; n < 6; n++) {
            int64_t const way = bvxi_corner(&f, n % 2 + 2, n / 2) - bvxi_corner(&f, n % 2, n / 2);
            diagonal[n % 2] += way * way;
        }
        if (axis == BVXI_NET_FLAP || diagonal[1] >= diagonal[0]) continue;
        t[0] = t[3] = f.vertex[1];
        t[1] = f.vertex[2];
        t[2] = t[4] = f.vertex[3];
        t[5] = f.vertex[0];
    }
}

/* 36 times the volume that a triangle sweeps; last gets twice its area vector at the end. That is a quadratic of the
 * share of the way: its mean is that of both ends less a sixth of the quadratic term. Ways are shorter than 2 voxels, so
 * up to 55 bits: a double may round the last two, everywhere alike. */
static inline double swept(const bvxi_face *f, int32_t b, int32_t c, double last[3])
{
    double place[2][3], moved[2][3], bent[3], sum = 0.0;

    for (int32_t a = 0; a < 3; a++) {
        moved[0][a] = (double)(f->moved[b][a] - f->moved[0][a]);
        moved[1][a] = (double)(f->moved[c][a] - f->moved[0][a]);
        place[0][a] = (double)(bvxi_corner(f, b, a) - f->moved[0][a]);
        place[1][a] = (double)(bvxi_corner(f, c, a) - f->moved[0][a]);
    }
    bvxi_vec_cross(place[0], place[1], last);
    bvxi_vec_cross(moved[0], moved[1], bent);
    for (int32_t a = 0; a < 3; a++) {
        double const begin = a == 2 ? (double)(f->square * SQUARE) : 0.0;
        sum += (double)(f->moved[0][a] + f->moved[b][a] + f->moved[c][a]) *
               (3.0 * (begin + last[a]) - bent[a]);
    }
    return sum;
}

/* A face in the order of pairs. These lie wide apart in memory, so corners of the next ones are requested ahead,
 * and offsets and areas of their vertices. */
static inline uint32_t take_face(const net_work *w, uint64_t i, uint64_t end, int areas)
{
    const uint32_t *const triangles = w->net->complex->mesh.triangles;
    uint64_t const near = i + AHEAD < end ? i + AHEAD : i, far = near + AHEAD < end ? near + AHEAD : i;
    const uint32_t *const t = triangles + 6 * (size_t)(w->faces[near] & FACE_BITS);

    BVXI_PREFETCH(triangles + 6 * (size_t)(w->faces[far] & FACE_BITS));
    for (int32_t n = 0; n < 4; n++) {
        BVXI_PREFETCH(w->net->offset + 3 * (size_t)t[n == 3 ? 5 : n]);
        if (areas) BVXI_PREFETCH(w->areas + 3 * (size_t)t[n == 3 ? 5 : n]);
    }
    return w->faces[i];
}

/* What a pair's faces have swept. With area, areas get the area vectors of its free vertices, to which those of the
 * faces around them add up, area[0] the sum of their sizes, and area[1] how many corners of faces they are. */
static double measure_pair(const net_work *w, uint64_t begin, uint64_t end, double *area)
{
    const uint8_t *const junctions = w->net->complex->junctions;
    double volume = 0.0;

    for (uint64_t i = begin; i < end; i++) {
        uint32_t const face = take_face(w, i, end, area != NULL);
        double half[2][3];
        bvxi_face f;

        bvxi_read_face(w->net, face & FACE_BITS, face >> AXIS_SHIFT, &f);
        volume += swept(&f, 1, 2, half[0]) + swept(&f, 2, 3, half[1]);
        if (area == NULL) continue;
        double const first = bvxi_vec_length(half[0]), second = bvxi_vec_length(half[1]);
        for (int32_t n = 0; n < 4; n++) {
            if (junctions[f.vertex[n]] != 0) continue;
            float *const sum = w->areas + 3 * (size_t)f.vertex[n];
            for (int32_t a = 0; a < 3; a++) {
                double const both = half[0][a] + half[1][a];
                sum[f.axis[a]] += (float)(f.sign[a] * (n == 1 ? half[0][a] : n == 3 ? half[1][a] : both));
            }
            area[0] += n == 1 ? first : n == 3 ? second : first + second;
            area[1] += 1.0;
        }
    }
    return volume / VOLUME_UNITS;
}

/* One step of a pair, as *moved says how far it has come. */
static void correct_pair(const net_work *w, uint64_t begin, uint64_t end, double *moved)
{
    double const faces = (double)(end - begin), before = *moved, kept = kept_volume * faces;
    double area[2] = {0.0, 0.0};

    *moved = correct;
    if (before != 0.0 && bvxi_absolute(measure_pair(w, begin, end, NULL)) <= kept) return;
    double const volume = measure_pair(w, begin, end, area);
    if (area[0] == 0.0 || bvxi_absolute(volume) <= kept) return;

    /* What has shrunk to nearly nothing sweeps nothing to divide by. A few free vertices do not make up for what all
     * faces at junctions have swept. */
    double const normal = area[0] / (6.0 * (double)SQUARE); /* by moving 1 along the normals */
    double const share = area[1] / (4.0 * faces), limit = share * share;
    double const way = -volume / (normal > 0.5 * faces ? normal : 0.5 * faces);
    double const step = limited(limited(before + way, limit) - before, longest_move);
    if (step == 0.0) return;

    /* Move a pair's free vertices along their normals, each once: its area vector becomes 0. */
    const bvx_complex *const c = w->net->complex;

    for (uint64_t i = begin; i < end; i++) {
        const uint32_t *const t = c->mesh.triangles + 6 * (size_t)(take_face(w, i, end, 1) & FACE_BITS);

        for (int32_t n = 0; n < 4; n++) {
            uint32_t const vertex = t[n == 3 ? 5 : n];
            float *const sum = w->areas + 3 * (size_t)vertex;
            int16_t *const o = w->net->offset + 3 * (size_t)vertex;
            double const own[3] = {(double)sum[0], (double)sum[1], (double)sum[2]};
            if (c->junctions[vertex] != 0 || bvxi_vec_is_zero(own)) continue;
            double const size = bvxi_vec_length(own);
            for (int32_t d = 0; d < 3; d++) {
                o[d] = clamp((float)BVXI_NET_LIMIT,
                             (float)((double)o[d] + step * BVXI_NET_UNITS * own[d] / size));
                sum[d] = 0.0F;
            }
        }
    }

    /* A first step leaves a fiftieth at most where it is not cut off, so it is not measured. Later ones are,
     * but for the few whose difference is exact. */
    if (step != way || bvxi_absolute(volume) > last_step * kept) *moved = before + step;
}

/* Free vertices have one pair's faces around them, so pairs are corrected apart from each other. Large ones take a
 * step at a time. */
static void correct_pairs(void *user, uint64_t first, uint64_t last)
{
    const net_work *const w = user;

    for (uint64_t p = first; p < last; p++) {
        uint64_t const begin = w->pairs[p], end = w->pairs[p + 1];
        int32_t const steps = end - begin < LARGE_PAIR ? CORRECTIONS : 1;
        for (int32_t i = 0; i < steps && w->moved[p] != correct; i++)
            correct_pair(w, begin, end, &w->moved[p]);
    }
}

/* By the lower label, then by the higher: counted by the higher first. */
static bvx_status sort_faces(bvx_context *ctx, net_work *w)
{
    const bvx_complex *const c = w->net->complex;
    uint64_t const faces = c->face_count, labels = c->label_count + 1;
    uint64_t *count, last = UINT64_MAX;

    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, (faces + 1) * 4, "the faces' pairs", &w->pairs));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, labels * 8, "faces of each label", &count));
    for (int32_t side = 1; side >= 0; side--) {
        const uint32_t *const from = side == 1 ? w->faces : w->pairs, *const sides = c->sides + side;
        uint32_t *const to = side == 1 ? w->pairs : w->faces;

        memset(count, 0, (size_t)labels * 8);
        for (uint64_t f = 0; f < faces; f++) count[sides[2 * f]]++;
        (void)bvxi_place_counts(count, labels);
        for (uint64_t i = 0; i < faces; i++) {
            if (i + AHEAD < faces) BVXI_PREFETCH(sides + 2 * (size_t)(from[i + AHEAD] & FACE_BITS));
            to[count[sides[2 * (size_t)(from[i] & FACE_BITS)]]++] = from[i];
        }
    }
    bvxi_drop(ctx, count);

    for (uint64_t i = 0; i < faces; i++) {
        const uint32_t *const own = c->sides + 2 * (size_t)(w->faces[i] & FACE_BITS);
        if (i + AHEAD < faces) BVXI_PREFETCH(c->sides + 2 * (size_t)(w->faces[i + AHEAD] & FACE_BITS));
        if (last != (own[0] | (uint64_t)own[1] << 32)) w->pairs[w->pair_count++] = (uint32_t)i;
        last = own[0] | (uint64_t)own[1] << 32;
    }
    w->pairs[w->pair_count] = (uint32_t)faces;
    return BVX_OK;
}

void bvxi_net_put(const bvxi_net *net, uint64_t vertex)
{
    const bvx_complex *const c = net->complex;
    uint64_t cell[3];
    double p[3];

    bvxi_cell_of(c, vertex, cell);
    for (uint64_t a = 0; a < 3; a++) {
        double const offset = net->offset != NULL ? (double)net->offset[3 * vertex + a] / BVXI_NET_UNITS
                                                  : 0.0;
        p[a] = net->origin[a] + ((double)c->low[a] + (double)cell[a] + offset) * net->spacing[a];
    }
    bvxi_put_position(&c->mesh, c->mesh.position_type, vertex, p[0], p[1], p[2]);
}

bvx_status bvxi_net_smooth(bvx_context *ctx, bvxi_net *net)
{
    uint64_t const vertices = net->complex->mesh.vertex_count;
    net_work w = {.net = net};
    float weight = 1.0F;
    int16_t *second;

    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, vertices * 6, "the moved offsets", &second));
    for (int32_t i = 0; i < STEPS; i++) {
        w.from = i % 2 == 0 ? net->offset : second;
        w.to = i % 2 == 0 ? second : net->offset;
        w.of_last = 1.0F - weight;
        w.of_own = weight * (1.0F - relax_step);
        for (int32_t n = 1; n < 7; n++) w.of_mean[n] = weight * relax_step / (float)n;
        weight = 1.0F / (1.0F - (i == 0 ? 0.5F : 0.25F * weight) * radius_squared);
        BVXI_TRY(bvxi_for_ranges(ctx, "smooth", 0.7 * (double)i / (double)STEPS,
                                 0.7 * (double)(i + 1) / (double)STEPS,
                                 bvxi_piece_count(vertices, VERTEX_GRAIN), vertices, relax_range, &w));
    }
    bvxi_drop(ctx, second);
    bvxi_drop(ctx, net->above);

    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, net->complex->face_count * 4, "the faces by pair", &w.faces));
    BVXI_TRY(bvxi_for(ctx, "faces", net->complex->face_count, VERTEX_GRAIN, split_faces, &w));
    BVXI_TRY(sort_faces(ctx, &w));
    w.areas = net->complex->mesh.positions;
    memset(w.areas, 0, (size_t)vertices * 12);
    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, w.pair_count * 8, "the pairs' moves", &w.moved));
    for (int32_t i = 0; i < CORRECTIONS; i++)
        BVXI_TRY(bvxi_for_ranges(ctx, "volumes", 0.7 + 0.3 * (double)i / (double)CORRECTIONS,
                                 0.7 + 0.3 * (double)(i + 1) / (double)CORRECTIONS,
                                 bvxi_piece_count(w.pair_count, 1), w.pair_count, correct_pairs, &w));
    return BVX_OK;
}
