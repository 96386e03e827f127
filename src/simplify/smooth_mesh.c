/* smooth_mesh.c - smooth the positions of a mesh: bvx_mesh_smooth.
 *
 * Sources: Taubin. A Signal Processing Approach to Fair Surface Design. 1995 (a step in, a larger one out). Taubin,
 * Zhang, Golub. Optimal Surface Smoothing as Filter Design. 1996 (Chebyshev polynomials of the Laplacian under a
 * Hamming window).
 *
 * Vertices at one position are one. The Laplacian is the mean of a vertex's neighbours less the vertex. On edges of one
 * triangle, or of three and more, only the two neighbours along them count, so borders and seams of sheets are smoothed
 * as lines; where other than two such edges meet, the vertex stays. A step reads one buffer and writes another, and
 * neighbours have a fixed order, so the result follows from the mesh alone. */
#include "core/vec3.h"
#include "mesh/facet.h"
#include "mesh/mesh.h"
#include "mesh/topology.h"
#include "mesh/view.h"
#include "simplify/room.h"

static const char smooth_name[] = "bvx_mesh_smooth";

enum { SMOOTH_GRAIN = 4096, UNDO_ROUNDS = 64, UNDO_STRIKES = 3, STRUCK = 128 };

#define SMOOTH_STEPS 20
#define SMOOTH_BAND  0.1
#define TAUBIN_STEP  0.5

static const bvxi_option smooth_rows[] = {
    BVXI_CHOICE(bvx_smooth_options, method, BVX_SMOOTH_SINC, BVX_SMOOTH_TAUBIN),
    BVXI_OR(bvx_smooth_options, iterations, WHOLE, SMOOTH_STEPS, 1, 1000),
    BVXI_OR(bvx_smooth_options, pass_band, REAL, SMOOTH_BAND, 0.001, 1.0),
    BVXI_REAL(bvx_smooth_options, sharp_angle, 0.0, 180.0),
    BVXI_SWITCH(bvx_smooth_options, hold_border),
    BVXI_SWITCH(bvx_smooth_options, no_crossings),
    BVXI_RESERVED(bvx_smooth_options, reserved),
};

/* Positions are in units of the mesh's size. */
typedef struct mesh_filter {
    const bvx_mesh_view *view;
    const bvx_smooth_options *options;
    uint32_t *place; /* the least vertex at each vertex's position */
    double scale;
    uint64_t *key; /* both ends of each half-edge, the lower one above [Size: 3 * triangles] */
    uint32_t *half;
    uint64_t edges;  /* half-edges that have two ends */
    uint64_t *first; /* where each vertex's neighbours begin [Size: vertices + 1] */
    uint32_t *neighbours;
    uint8_t *lines; /* of each vertex: edges of other than two triangles, up to 3; 4: it stays */
    double *given, *at, *before, *sum;
    double own, mean, other,
        weight; /* of a step: factors of a vertex, its neighbours' mean, before; in the sum */
} mesh_filter;

/* ---- Neighbours ---- */

static void corner_places(const mesh_filter *w, uint64_t t, uint32_t c[3])
{
    bvxi_view_triangle(w->view, t, c);
    for (int k = 0; k < 3; k++) c[k] = w->place[c[k]];
}

/* Whether the triangles of two half-edges of one edge turn by more than the angle. */
static int turns_sharply(const mesh_filter *w, const uint32_t half[2])
{
    double normal[2][3], across[3];
    uint32_t from[2];

    for (int i = 0; i < 2; i++) {
        double p[3][3];
        uint32_t c[3];
        corner_places(w, half[i] / 3, c);
        from[i] = c[half[i] % 3];
        for (int k = 0; k < 3; k++) memcpy(p[k], w->given + 3 * (size_t)c[k], sizeof p[k]);
        bvxi_facet_cross((const double(*)[3])p, normal[i]);
    }
    bvxi_vec_cross(normal[0], normal[1], across);
    double const along = bvxi_vec_dot(normal[0], normal[1]);
    /* Triangles that face different ways run along the edge in the same one. */
    double const turn = bvxi_angle(from[0] != from[1] ? along : -along, bvxi_vec_length(across));
    return turn > w->options->sharp_angle * (BVXI_PI / 180.0);
}

/* Count or fill, in the order of edges: vertices on two lines have the neighbours along these. */
static void add_neighbours(mesh_filter *w, uint64_t *next)
{
    for (uint64_t i = 0, end; i < w->edges; i = end) {
        for (end = i + 1; end < w->edges && w->key[end] == w->key[i];) end++;
        uint32_t const v[2] = {(uint32_t)(w->key[i] >> 32), (uint32_t)w->key[i]};
        for (int k = 0; k < 2; k++) {
            uint8_t const lines = w->lines[v[k]];
            if (lines != 0 && (lines != 2 || end - i == 2)) continue;
            if (w->neighbours != NULL) w->neighbours[next[v[k]]] = v[1 - k];
            next[v[k]]++;
        }
    }
}

static bvx_status find_neighbours(bvx_context *ctx, mesh_filter *w)
{
    uint64_t const vertices = w->view->vertex_count;

    uint64_t const triangles = w->view->triangle_count;

    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, triangles * 24, "the half-edges", &w->key));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, triangles * 12, "the half-edges' numbers", &w->half));
    for (uint64_t t = 0; t < triangles; t++) {
        uint32_t c[3];
        corner_places(w, t, c);
        for (uint32_t k = 0; k < 3; k++) {
            uint32_t const a = c[k], b = c[(k + 1) % 3];
            if (a == b) continue;
            w->key[w->edges] = a < b ? (uint64_t)a << 32 | b : (uint64_t)b << 32 | a;
            w->half[w->edges++] = (uint32_t)(3 * t + k);
        }
    }
    BVXI_TRY(bvxi_radix_sort(ctx, w->key, w->half, w->edges));

    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, vertices, "the lines at vertices", &w->lines));
    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, (vertices + 2) * 8, "where neighbours begin", &w->first));

    /* Which edges hold their ends, and how many lines meet at a vertex. */
    for (uint64_t i = 0, end; i < w->edges; i = end) {
        for (end = i + 1; end < w->edges && w->key[end] == w->key[i];) end++;
        int const sharp = end - i == 2 && w->options->sharp_angle > 0.0 && turns_sharply(w, w->half + i);
        int const holds = sharp || (end - i == 1 && w->options->hold_border);
        uint32_t const v[2] = {(uint32_t)(w->key[i] >> 32), (uint32_t)w->key[i]};
        for (int k = 0; k < 2; k++) {
            uint8_t *const lines = &w->lines[v[k]];
            if (holds) *lines = 4;
            else if (end - i != 2 && *lines < 3) ++*lines;
        }
    }

    /* Counted at v + 2, summed up, and filled from v + 1 on, which is then where they end. */
    add_neighbours(w, w->first + 2);
    for (uint64_t v = 0; v < vertices; v++) w->first[v + 2] += w->first[v + 1];
    BVXI_TRY(BVXI_ARRAY(ctx, w->first[vertices + 1] + 1, "the neighbours", w->neighbours));
    add_neighbours(w, w->first + 1);
    bvxi_drop(ctx, w->key);
    bvxi_drop(ctx, w->half);
    return BVX_OK;
}

/* ---- Filters ---- */

static void smooth_range(void *user, uint64_t begin, uint64_t end)
{
    const mesh_filter *const w = user;

    for (uint64_t v = begin; v < end; v++) {
        uint64_t const from = w->first[v], to = w->first[v + 1];
        const double *const p = w->at + 3 * v;
        double m[3] = {0.0, 0.0, 0.0};

        if (from == to) continue;
        for (uint64_t i = from; i < to; i++)
            for (int a = 0; a < 3; a++) m[a] += w->at[3 * (size_t)w->neighbours[i] + (size_t)a];
        for (uint64_t a = 0; a < 3; a++) {
            double *const next = &w->before[3 * v + a];
            *next = w->own * p[a] + w->mean * (m[a] / (double)(to - from)) + w->other * *next;
            w->sum[3 * v + a] += w->weight * *next;
        }
    }
}

static bvx_status smooth_step(bvx_context *ctx, mesh_filter *w, int32_t step, int32_t steps)
{
    uint64_t const vertices = w->view->vertex_count;
    double *const at = w->at;
    BVXI_TRY(bvxi_for_ranges(ctx, "smooth", 0.3 + 0.7 * (double)step / (double)steps,
                             0.3 + 0.7 * (double)(step + 1) / (double)steps,
                             bvxi_piece_count(vertices, SMOOTH_GRAIN), vertices, smooth_range, w));
    w->at = w->before;
    w->before = at;
    return BVX_OK;
}

/* The result is in at. */
static bvx_status filter_taubin(bvx_context *ctx, mesh_filter *w)
{
    int32_t const steps = 2 * w->options->iterations;
    double const factor[2] = {TAUBIN_STEP, 1.0 / (w->options->pass_band - 1.0 / TAUBIN_STEP)};
    for (int32_t i = 0; i < steps; i++) {
        w->mean = factor[i & 1];
        w->own = 1.0 - w->mean;
        BVXI_TRY(smooth_step(ctx, w, i, steps));
    }
    return BVX_OK;
}

/* The cosine_of of an angle up to pi, by its series. */
static double cosine_of(double x)
{
    double sum = 1.0;
    for (int k = 34; k > 0; k -= 2) sum = 1.0 - x * x / (double)(k * (k - 1)) * sum;
    return sum;
}

/* The pass band ends before the window's transition, half of which is 3.3 pi a length, or half of what is left.
 * Weights of the polynomials are 1 together, so that what does not change is kept. The result is in sum. */
static bvx_status filter_sinc(bvx_context *ctx, mesh_filter *w)
{
    int32_t const steps = w->options->iterations;
    double const cut = 1.0 - 0.5 * w->options->pass_band, band = bvxi_angle(cut, sqrt(1.0 - cut * cut));
    double const half = 3.3 * BVXI_PI / (double)(2 * steps + 1), most = 0.5 * (BVXI_PI - band);
    double const angle = band + (half < most ? half : most), c = cosine_of(angle), s = sqrt(1.0 - c * c);
    double const window = cosine_of(BVXI_PI / (double)(steps + 1));
    double weight[1001], sine[2] = {0.0, s}, cosines[2] = {1.0, window}, total;

    weight[0] = total = angle;
    for (int32_t n = 1; n <= steps; n++) {
        weight[n] = 2.0 * sine[1] / (double)n * (0.54 + 0.46 * cosines[1]);
        total += weight[n];
        double const next[2] = {2.0 * c * sine[1] - sine[0], 2.0 * window * cosines[1] - cosines[0]};
        sine[0] = sine[1];
        cosines[0] = cosines[1];
        sine[1] = next[0];
        cosines[1] = next[1];
    }

    for (uint64_t i = 0; i < 3 * w->view->vertex_count; i++) w->sum[i] = weight[0] / total * w->given[i];
    for (int32_t n = 1; n <= steps; n++) {
        w->own = w->mean = n == 1 ? 0.5 : 1.0;
        w->other = n == 1 ? 0.0 : -1.0;
        w->weight = weight[n] / total;
        BVXI_TRY(smooth_step(ctx, w, n - 1, steps));
    }
    w->at = w->sum;
    return BVX_OK;
}

/* ---- What comes out ---- */

static int is_held(const mesh_filter *w, uint64_t place)
{
    return w->first[place] == w->first[place + 1];
}

static void put_smoothed(const mesh_filter *w, void *positions)
{
    for (uint64_t v = 0; v < w->view->vertex_count; v++) {
        uint64_t const place = w->place[v];
        double p[3];
        bvxi_view_position(w->view, v, p);
        for (uint64_t a = 0; a < 3; a++) {
            if (!is_held(w, place)) p[a] = w->at[3 * place + a] / w->scale;
            if (bvxi_view_type(w->view) == BVX_F32) ((float *)positions)[3 * v + a] = (float)p[a];
            else ((double *)positions)[3 * v + a] = p[a];
        }
    }
}

typedef struct pair_list {
    uint32_t *pairs;
    uint64_t count;
} pair_list;

static bvx_status list_pairs(bvx_context *ctx, const bvx_mesh_view *view, pair_list *list)
{
    bvx_status status = BVX_ERR_CAPACITY;
    /* Far more than there are; else they are searched for again. */
    list->count = view->triangle_count / 4 + 64;
    for (int i = 0; i < 2 && status == BVX_ERR_CAPACITY; i++) {
        uint64_t const capacity = list->count;
        BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, capacity * 8, "the crossings", &list->pairs));
        status = bvx_mesh_crossings(ctx, view, &list->count, list->pairs, capacity);
    }
    return status;
}

/* Half the way back, the third time all of it. */
static void strike(mesh_filter *w, uint32_t place)
{
    uint8_t *const state = &w->lines[place];
    if ((*state & STRUCK) != 0) return;
    *state = (uint8_t)((*state & ~STRUCK) + 1);
    for (uint64_t i = 3 * (uint64_t)place; i < 3 * (uint64_t)place + 3; i++)
        w->at[i] = *state < UNDO_STRIKES ? 0.5 * (w->at[i] + w->given[i]) : w->given[i];
    *state = (uint8_t)((*state < UNDO_STRIKES ? *state : UNDO_STRIKES) | STRUCK);
}

/* Vertices of pairs that the mesh does not have go back; *fresh counts those pairs. */
static bvx_status undo_round(bvx_context *ctx, mesh_filter *w, const bvx_mesh_view *smoothed,
                             const pair_list *own, uint64_t *fresh)
{
    pair_list found;
    uint64_t k = 0;

    BVXI_TRY(list_pairs(ctx, smoothed, &found));
    for (uint64_t v = 0; v < w->view->vertex_count; v++) w->lines[v] &= (uint8_t)~STRUCK;
    *fresh = 0;
    for (uint64_t i = 0; i < found.count; i++) {
        const uint32_t *const pair = found.pairs + 2 * i;
        while (k < own->count && (own->pairs[2 * k] < pair[0] ||
                                  (own->pairs[2 * k] == pair[0] && own->pairs[2 * k + 1] < pair[1])))
            k++;
        if (k < own->count && own->pairs[2 * k] == pair[0] && own->pairs[2 * k + 1] == pair[1]) continue;
        ++*fresh;
        for (int t = 0; t < 2; t++) {
            uint32_t c[3];
            corner_places(w, pair[t], c);
            for (int a = 0; a < 3; a++) strike(w, c[a]);
        }
    }
    return BVX_OK;
}

static bvx_status undo_crossings(bvx_context *ctx, mesh_filter *w, void *positions)
{
    bvx_mesh_view smoothed = *w->view;
    pair_list own;
    uint64_t fresh = 1;

    smoothed.positions = positions;
    smoothed.position_type = bvxi_view_type(w->view);
    smoothed.position_stride = 0;
    smoothed.transform = NULL;
    BVXI_TRY(list_pairs(ctx, w->view, &own));
    memset(w->lines, 0, (size_t)w->view->vertex_count);
    for (int32_t round = 0; round < UNDO_ROUNDS && fresh != 0; round++) {
        BVXI_TRY(BVXI_SCOPE(ctx, undo_round(ctx, w, &smoothed, &own, &fresh)));
        if (fresh != 0) put_smoothed(w, positions);
    }
    if (fresh == 0) return BVX_OK;

    /* Not seen yet: the mesh itself has no crossings but its own. */
    memcpy(w->at, w->given, (size_t)w->view->vertex_count * 24);
    memset(w->lines, UNDO_STRIKES, (size_t)w->view->vertex_count);
    put_smoothed(w, positions);
    return BVX_OK;
}

static double volume_of(const mesh_filter *w, const double *at)
{
    double sum = 0.0;

    for (uint64_t t = 0; t < w->view->triangle_count; t++) {
        double p[3][3], n[3];
        uint32_t c[3];
        corner_places(w, t, c);
        for (size_t k = 0; k < 3; k++)
            for (size_t a = 0; a < 3; a++) p[k][a] = at[3 * (size_t)c[k] + a] - w->given[a];
        bvxi_vec_cross(p[1], p[2], n);
        sum += bvxi_vec_dot(p[0], n);
    }
    return sum / 6.0 / w->scale / w->scale / w->scale;
}

static bvx_status open_positions(bvx_context *ctx, mesh_filter *w)
{
    uint64_t const bytes = w->view->vertex_count * 24;
    uint64_t different;

    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, w->view->vertex_count * 4, "the vertices' places", &w->place));
    BVXI_TRY(BVXI_SHARE(ctx, 0.0, 0.1, bvxi_weld(ctx, w->view, w->place, &different)));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, bytes, "the given positions", &w->given));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, bytes, "the positions", &w->at));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, bytes, "the positions before", &w->before));
    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, bytes, "the sum of positions", &w->sum));
    for (uint64_t v = 0; v < w->view->vertex_count; v++) {
        bvxi_view_position(w->view, v, w->given + 3 * v);
        for (int a = 0; a < 3; a++) w->given[3 * v + (uint64_t)a] *= w->scale;
    }
    memcpy(w->at, w->given, (size_t)bytes);
    memcpy(w->before, w->given, (size_t)bytes);
    return BVX_OK;
}

static bvx_status run_mesh_smooth(bvx_context *ctx, const bvx_mesh_view *mesh,
                                  const bvx_smooth_options *options, void *positions)
{
    bvx_smooth_options o;
    mesh_filter w = {.view = mesh, .options = &o};
    double low[3], high[3];

    if (mesh == NULL) return bvxi_fail_null(ctx, smooth_name, "mesh");
    if (positions == NULL) return bvxi_fail_null(ctx, smooth_name, "positions");
    BVXI_TRY(bvxi_take_options(ctx, smooth_name, options, &o, sizeof o));
    BVXI_TRY(bvxi_check_options(ctx, smooth_name, &o, BVXI_OPTIONS(smooth_rows)));
    BVXI_TRY(bvxi_view_check(ctx, smooth_name, mesh));
    BVXI_TRY(bvxi_view_bounds(ctx, smooth_name, mesh, low, high));
    if (mesh->triangle_count > UINT32_MAX / 3)
        return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY, "%s: %u triangles, the limit is %u",
                             smooth_name, mesh->triangle_count, (uint64_t)UINT32_MAX / 3);

    w.scale = bvxi_unit_scale(low, high);
    BVXI_TRY(open_positions(ctx, &w));
    BVXI_TRY(BVXI_SHARE(ctx, 0.1, 0.3, find_neighbours(ctx, &w)));
    BVXI_TRY(BVXI_SHARE(ctx, 0.0, o.no_crossings ? 0.5 : 1.0,
                        o.method == BVX_SMOOTH_SINC ? filter_sinc(ctx, &w) : filter_taubin(ctx, &w)));
    for (uint64_t v = 0; v < mesh->vertex_count; v++)
        if (is_held(&w, v)) memcpy(w.at + 3 * v, w.given + 3 * v, 24);
    put_smoothed(&w, positions);
    if (o.no_crossings) BVXI_TRY(BVXI_SHARE(ctx, 0.5, 1.0, undo_crossings(ctx, &w, positions)));
    if (o.report == NULL) return BVX_OK;

    bvx_smooth_report *const report = o.report;
    memset(report, 0, sizeof *report);
    report->volume_before = volume_of(&w, w.given);
    report->volume_after = volume_of(&w, w.at);
    for (uint64_t v = 0; v < mesh->vertex_count; v++) {
        if (w.place[v] != v) continue;
        double const move = is_held(&w, v) ? 0.0 : bvxi_vec_distance2(w.given + 3 * v, w.at + 3 * v);
        if (move > report->largest_move) report->largest_move = move;
        report->held += (uint64_t)is_held(&w, v);
        report->undone += o.no_crossings && (w.lines[v] & ~STRUCK) != 0;
    }
    report->largest_move = sqrt(report->largest_move) / w.scale;
    return BVX_OK;
}

bvx_status bvx_mesh_smooth(bvx_context *context, const bvx_mesh_view *mesh, const bvx_smooth_options *options,
                           void *positions)
{
    return BVXI_CALL(context, run_mesh_smooth(context, mesh, options, positions));
}
