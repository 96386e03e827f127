/* check.c - the certificate of a mesh.
 *
 * Vertices are welded where requested, triangles with three different vertices kept; topology.c counts what
 * can be told from their numbers, the sums over positions are taken here, in triangle order, so they are the
 * same everywhere: what each triangle adds is computed by all threads, some ten thousand at a time. */
#include "mesh/facet.h"
#include "mesh/view.h"
#include "mesh/topology.h"

enum { CHECK_ROUND = 1 << 16, CHECK_GRAIN = 1 << 12, CHECK_TASKS = CHECK_ROUND / CHECK_GRAIN };

typedef struct checker {
    const bvx_mesh_view *view;
    const uint32_t *representative; /* given, when welded already */
    int edges_alone;
    uint32_t *renumber;    /* vertex -> number of its position, when welded [Size: vertices of the view] */
    uint64_t vertex_count; /* after welding */
    uint32_t *corners;     /* of the triangles that count [Size: triangles of the view * 3] */
    uint64_t triangle_count;
    bvx_certificate result;
} checker;

/* What a triangle adds: twice its area, or -1 where it does not count, and six times its volume. */
typedef struct check_terms {
    double twice, volume;
} check_terms;

/* A round of collecting: triangles begin .. begin + count. */
typedef struct collector {
    checker *c;
    double scale, centre[3];
    double low[3], high[3]; /* of all triangles, from which those of the ones that count are sought */
    uint64_t begin;
    int32_t count, tasks;
    check_terms *terms; /* [Size: CHECK_ROUND, or the triangles] */
    double least[CHECK_TASKS][3], most[CHECK_TASKS][3];
} collector;

/* Corners go to the triangle's own place at first. */
static void collect_task(void *user, int32_t task, uint64_t from, uint64_t to)
{
    collector *const w = user;
    const checker *const c = w->c;
    double least[3], most[3];

    memcpy(least, w->high, sizeof least);
    memcpy(most, w->low, sizeof most);
    for (uint64_t i = from; i < to; i++) {
        uint32_t *const corner = c->corners + 3 * (w->begin + i);
        double p[3][3], n[3];
        uint32_t raw[3];

        bvxi_view_triangle(c->view, w->begin + i, raw);
        for (int k = 0; k < 3; k++) corner[k] = c->renumber != NULL ? c->renumber[raw[k]] : raw[k];
        /* Two corners at one place leave no triangle: it has no area and no side. */
        w->terms[i].twice = -1.0;
        if (corner[0] == corner[1] || corner[1] == corner[2] || corner[2] == corner[0]) continue;
        for (int k = 0; k < 3; k++) {
            bvxi_view_position(c->view, raw[k], p[k]);
            bvxi_widen(least, most, p[k], 3);
            for (int a = 0; a < 3; a++) p[k][a] *= w->scale;
        }

        /* Twice the area is the length of the normal, so one cross product serves area and volume. */
        w->terms[i].twice = bvxi_facet_normal((const double(*)[3])p, n);
        w->terms[i].volume = (p[0][0] - w->centre[0]) * n[0] + (p[0][1] - w->centre[1]) * n[1] +
                             (p[0][2] - w->centre[2]) * n[2];
    }
    memcpy(w->least[task], least, sizeof least);
    memcpy(w->most[task], most, sizeof most);
}

/* In the order of the triangles, as sums of doubles follow it; those that count move together. */
static void add_round(collector *w, double *area, double *volume)
{
    checker *const c = w->c;

    for (int32_t i = 0; i < w->count; i++) {
        uint64_t const own = w->begin + (uint64_t)i;
        if (w->terms[i].twice < 0.0) continue;
        if (c->triangle_count != own) memcpy(c->corners + 3 * c->triangle_count, c->corners + 3 * own, 12);
        c->triangle_count++;
        c->result.degenerate += w->terms[i].twice == 0.0;
        *area += w->terms[i].twice;
        *volume += w->terms[i].volume;
    }
    for (int32_t t = 0; t < w->tasks; t++)
        for (int a = 0; a < 3; a++) {
            double *const low = &c->result.box.low[a], *const high = &c->result.box.high[a];
            *low = w->least[t][a] < *low ? w->least[t][a] : *low;
            *high = w->most[t][a] > *high ? w->most[t][a] : *high;
        }
}

/* Keep triangles of three vertices after welding; their bounds, area, and volume about the bounds' centre. */
static bvx_status collect_triangles(bvx_context *ctx, checker *c, double progress, const double low[3],
                                    const double high[3])
{
    uint64_t const all = c->view->triangle_count;
    uint64_t const room = all < CHECK_ROUND ? all : CHECK_ROUND;
    bvx_certificate *const r = &c->result;
    double const scale = bvxi_unit_scale(low, high), back = 1.0 / scale;
    double volume = 0.0, area = 0.0;
    collector w = {.c = c, .scale = scale};

    /* Scaled, sums of products neither overflow nor vanish; about the centre, less is lost in the volume. */
    for (int a = 0; a < 3; a++) {
        w.centre[a] = (low[a] * scale + high[a] * scale) * 0.5;
        w.low[a] = r->box.high[a] = low[a];
        w.high[a] = r->box.low[a] = high[a];
    }
    r->degenerate = c->triangle_count = 0;
    BVXI_TRY(BVXI_ARRAY(ctx, room, "what triangles add", w.terms));
    for (; w.begin < all; w.begin += (uint64_t)w.count) {
        double const at = progress + 0.05 * (double)w.begin / (double)all;
        w.count = (int32_t)(all - w.begin < CHECK_ROUND ? all - w.begin : CHECK_ROUND);
        w.tasks = bvxi_piece_count((uint64_t)w.count, CHECK_GRAIN);
        BVXI_TRY(bvxi_for_pieces(ctx, "check", at, at, w.tasks, (uint64_t)w.count, collect_task, &w));
        add_round(&w, &area, &volume);
    }
    r->triangles = c->triangle_count;
    r->collapsed = all - c->triangle_count;

    /* The scale is a power of two: taking it back is exact. */
    r->area = area * 0.5 * back * back;
    r->volume = volume / 6.0 * back * back * back + 0.0;
    for (int a = 0; a < 3; a++) {
        r->box.low[a] = r->triangles != 0 ? r->box.low[a] + 0.0 : 0.0;
        r->box.high[a] = r->triangles != 0 ? r->box.high[a] + 0.0 : 0.0;
    }
    return BVX_OK;
}

/* low and high are the bounds of all triangles, also those that do not count. */
static bvx_status check_whole_mesh(bvx_context *ctx, checker *c, int weld, const double low[3],
                                   const double high[3])
{
    double kept_low[3], kept_high[3];

    BVXI_TRY(bvxi_progress(ctx, "check", 0.0));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, c->view->triangle_count * 12, "the check's corners", &c->corners));

    /* Welding changes which triangles count, so it comes before all sums. */
    if (weld) {
        BVXI_TRY(BVXI_ARRAY(ctx, c->view->vertex_count, "the check's welding", c->renumber));

        /* Representatives become numbers without gaps, in their order. */
        uint32_t next = 0;
        /* Each position is represented by its first vertex, so
         * representatives rise and get the next numbers in their order. */
        if (c->representative == NULL) BVXI_TRY(bvxi_weld(ctx, c->view, c->renumber, &c->vertex_count));
        else memcpy(c->renumber, c->representative, (size_t)c->view->vertex_count * 4);
        for (uint64_t v = 0; v < c->view->vertex_count; v++) {
            uint32_t const r = c->renumber[v]; /* at most v, so an earlier one is renumbered already */
            c->renumber[v] = r == v ? next++ : c->renumber[r];
        }
    }
    BVXI_TRY(BVXI_SCOPE(ctx, collect_triangles(ctx, c, 0.3, low, high)));
    if (c->triangle_count != 0 &&
        !(bvxi_vec_is_same(c->result.box.low, low) && bvxi_vec_is_same(c->result.box.high, high))) {
        memcpy(kept_low, c->result.box.low, sizeof kept_low);
        memcpy(kept_high, c->result.box.high, sizeof kept_high);
        BVXI_TRY(BVXI_SCOPE(ctx, collect_triangles(ctx, c, 0.35, kept_low, kept_high)));
    }
    /* Its memory is freed before the topology needs its own. */
    bvxi_drop(ctx, c->renumber);
    if (c->triangle_count != 0)
        return bvxi_topology(ctx, c->corners, c->triangle_count, c->vertex_count, c->edges_alone, &c->result);
    c->result.unused_vertices = c->vertex_count;
    return BVX_OK;
}

static bvx_status check_count(bvx_context *ctx, const char *function, const bvx_mesh_view *mesh)
{
    if (mesh->triangle_count <= UINT32_MAX / 3) return BVX_OK;
    return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                         "%s: mesh.triangle_count is %u, the limit of a check is %u", function,
                         mesh->triangle_count, (uint64_t)(UINT32_MAX / 3));
}

static bvx_status check_within(bvx_context *ctx, checker *c, int weld, const double low[3],
                               const double high[3], bvx_certificate *certificate)
{
    BVXI_TRY(BVXI_SCOPE(ctx, check_whole_mesh(ctx, c, weld, low, high)));
    *certificate = c->result;
    return BVX_OK;
}

bvx_status bvxi_check_welded(bvx_context *ctx, const char *function, const bvxi_welded *mesh, int edges_alone,
                             bvx_certificate *certificate)
{
    checker c = {0};
    c.view = mesh->view;
    c.vertex_count = mesh->different;
    c.representative = mesh->representative;
    c.edges_alone = edges_alone;
    BVXI_TRY(check_count(ctx, function, mesh->view));
    return check_within(ctx, &c, 1, mesh->low, mesh->high, certificate);
}

static bvx_status run_mesh_check(bvx_context *context, const bvx_mesh_view *mesh, int32_t weld,
                                 bvx_certificate *certificate)
{
    static const char *const function = "bvx_mesh_check";
    double low[3], high[3];
    checker c = {0};

    if (certificate == NULL) return bvxi_fail_null(context, function, "certificate");
    memset(certificate, 0, sizeof *certificate);
    c.view = mesh;
    BVXI_TRY(bvxi_view_check(context, function, mesh));
    if (weld != 0 && weld != 1)
        return bvxi_fail_for(context, BVX_ERR_ARGUMENT, BVX_REASON_CHOICE, "%s: weld is %d, not 0 or 1",
                             function, (int64_t)weld);
    BVXI_TRY(check_count(context, function, mesh));
    if (mesh->triangle_count == 0) {
        certificate->unused_vertices = mesh->vertex_count;
        return BVX_OK;
    }
    BVXI_TRY(bvxi_view_bounds(context, function, mesh, low, high));
    c.vertex_count = mesh->vertex_count;
    return check_within(context, &c, weld, low, high, certificate);
}

bvx_status bvx_mesh_check(bvx_context *context, const bvx_mesh_view *mesh, int32_t weld,
                          bvx_certificate *certificate)
{
    return BVXI_CALL(context, run_mesh_check(context, mesh, weld, certificate));
}
