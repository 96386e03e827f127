/* simplify_complex.c - fewer triangles in the faces between labels, which stay shared.
 *
 * Source: Garland, Heckbert. Surface Simplification Using Quadric Error Metrics. 1997. Dey, Edelsbrunner, Guha,
 * Nekhayev. Topology Preserving Edge Contraction. 1999 (the link condition where edges have many triangles).
 *
 * Idea: rounds, each of which leaves a quarter of the triangles at least. First the lines where three labels or more
 * meet collapse along themselves, by their own quadrics and to as many edges as their length takes beside such
 * triangles; points where lines meet stay. Then the faces between two labels are sheets of their own, whose borders are
 * locked, and all of them collapse at once as any mesh does (collapse.c). What crosses after the first step is held and
 * the step made anew; the second undoes its own.
 *
 * Guarantee: sheets share the vertices of lines, and no edge of a sheet joins two of these that did not before. So each
 * body stays closed, edge-manifold and oriented, and no two triangles cross where none did. In open windows vertices on
 * seams stay. */
#include "core/vec3.h"
#include "mesh/mesh.h"
#include "mesh/view.h"
#include "simplify/edge_costs.h"

#include <math.h>

enum { LINE_ALONG = 1, LINE_FIXED = 2 }; /* kinds of vertices; 0: inside of a sheet */
enum { ROUND_SHARE = 4, LINE_TRIES = 8, ERROR_SAMPLES = 20000, ERROR_SEED = 1 };

/* In met: triangles at both ends of an edge that have a vertex, up to three, and 1 where both ends are in one. */
enum { MET_U = 1, MET_V = 4, MET_APEX = 16 };

#define LINE_EVEN   0.01 /* of the length to the fourth, which edges cost beside their quadrics */
#define LINE_PULL   1e-3 /* of the quadric's trace, towards the middle of the edge */
#define LINE_COSINE 0.2  /* triangles turn by less */
#define LINE_SHAPE \
    0.02 /* twice the area over the sum of squared sides, from which on a triangle may get no worse */

typedef struct complex_parts {
    bvx_mesh mesh;
    uint32_t *sides; /* [Size: triangles * 2] */
    uint8_t *junctions;
    const double *box; /* as in bvxi_collapse_options */
} complex_parts;

typedef struct complex_round {
    bvx_context *ctx;
    const char *function;
    const complex_parts *from;
    bvxi_corner_vertex *at;
    uint32_t *triangle;     /* the second vertex of one that is gone is inverted */
    uint32_t *first, *next; /* a corner of each vertex, and of each corner the next one of its vertex */
    uint32_t *into;         /* where each vertex went, else itself */
    uint8_t *kind, *held, *fresh, *busy, *met;
    uint64_t left, lines;     /* triangles, edges of lines */
    uint32_t *ends;           /* of candidates */
    uint32_t *source, *owner; /* of each vertex of the sheets: its own and a triangle */
    double low[3], scale;
} complex_round;

static int is_corner_gone(const complex_round *r, uint32_t corner)
{
    return r->triangle[corner / 3 * 3 + 1] >> 31 != 0;
}

/* The first corner of v's triangles from one on. */
static uint32_t alive_from(const complex_round *r, uint32_t corner)
{
    while (corner != BVXI_VERTEX_NONE && is_corner_gone(r, corner)) corner = r->next[corner];
    return corner;
}

#define EACH_CORNER(r, v, c) \
    for (uint32_t c = alive_from(r, (r)->first[v]); c != BVXI_VERTEX_NONE; c = alive_from(r, (r)->next[c]))

/* The vertex so many corners after one in its triangle. */
static uint32_t vertex_after(const complex_round *r, uint32_t corner, uint32_t n)
{
    return r->triangle[corner / 3 * 3 + (corner % 3 + n) % 3];
}

static uint32_t across_from(const complex_round *r, uint32_t corner, uint32_t v)
{
    uint32_t const x = vertex_after(r, corner, 1), y = vertex_after(r, corner, 2);
    return x == v ? y : y == v ? x : BVXI_VERTEX_NONE;
}

/* The other ends of the lines' edges at a vertex: how many, and the first two. */
static uint32_t line_ends(const complex_round *r, uint32_t v, uint32_t ends[2])
{
    uint32_t count = 0;

    EACH_CORNER(r, v, c)
    for (uint32_t n = 1; n < 3; n++) {
        uint8_t *const met = &r->met[vertex_after(r, c, n)];
        *met = (uint8_t)(*met + (*met < 3));
    }
    EACH_CORNER(r, v, c)
    for (uint32_t n = 1; n < 3; n++) {
        uint32_t const x = vertex_after(r, c, n);
        if (r->met[x] > 2 && count++ < 2) ends[count - 1] = x;
        r->met[x] = 0;
    }
    return count;
}

/* ---- Lines ---- */

/* Planes of all triangles by their area, and lines by the square of their length. */
static void line_quadric(complex_round *r, uint32_t v)
{
    bvxi_quadric *const q = &r->at[v].q;
    const double *const p = r->at[v].p;
    uint32_t ends[2] = {v, v};
    double n[3];

    memset(q, 0, sizeof *q);
    r->kind[v] = (uint8_t)line_ends(r, v, ends);
    if ((r->from->junctions[v] & BVX_ON_SEAM) != 0) r->kind[v] = LINE_FIXED | BVX_ON_SEAM;
    if (r->kind[v] == 0) return;
    r->kind[v] = r->kind[v] == 2 ? LINE_ALONG : (r->kind[v] & BVX_ON_SEAM) | LINE_FIXED;
    for (uint32_t i = 0; i < 2; i++) {
        for (int a = 0; a < 3; a++) n[a] = r->at[ends[i]].p[a] - p[a];
        double const weight = bvxi_vec_dot(n, n);
        for (int a = 0, index = 0; a < 3; a++)
            for (int b = a; b < 3; b++) q->a[index++] += (a == b ? weight : 0.0) - n[a] * n[b];
    }
    EACH_CORNER(r, v, c)
    {
        bvxi_area_normal(p, r->at[vertex_after(r, c, 1)].p, r->at[vertex_after(r, c, 2)].p, n);
        double const area = bvxi_vec_length(n);
        for (int a = 0, index = 0; a < 3 && area > 0; a++)
            for (int b = a; b < 3; b++) q->a[index++] += n[a] * n[b] / area;
    }
}

/* Where an edge of a line would collapse to, the quadric of both ends about u, and what it costs; 0: nowhere. */
static int plan_line(const complex_round *r, uint32_t *u, uint32_t *v, bvxi_quadric *q, double p[3],
                     double *cost)
{
    const double *const box = r->from->box;
    double way[3], d[3] = {0, 0, 0}, from_middle = 0, square;

    if ((r->kind[*v] & LINE_FIXED) != 0) {
        uint32_t const swap = *u;
        *u = *v;
        *v = swap;
    }
    if ((r->kind[*v] & LINE_FIXED) != 0 || r->held[*u] || r->held[*v]) return 0;
    for (int a = 0; a < 3; a++) way[a] = r->at[*v].p[a] - r->at[*u].p[a];
    square = bvxi_vec_dot(way, way);
    bvxi_quadrics_join(&r->at[*u].q, &r->at[*v].q, way, q);
    if (r->kind[*u] == LINE_ALONG) {
        double const pull = LINE_PULL * (q->a[0] + q->a[3] + q->a[5]);
        bvxi_quadric all = *q;

        for (int a = 0; a < 3; a++) {
            all.a[a == 0 ? 0 : a == 1 ? 3 : 5] += pull;
            all.b[a] -= 0.5 * pull * way[a];
        }
        int const solved = bvxi_quadric_solve(all.a, all.b, d);
        for (int a = 0; a < 3; a++) from_middle += (d[a] - 0.5 * way[a]) * (d[a] - 0.5 * way[a]);
        for (int a = 0; a < 3 && !(solved && from_middle <= square); a++) d[a] = 0.5 * way[a];
    }
    for (int a = 0; a < 3; a++) {
        double const to = r->at[*u].p[a] + d[a];
        p[a] = r->from->mesh.position_type == BVX_F32 ? bvxi_nearest_float(to) : to;
        if (box != NULL && (p[a] < box[2 * a] || p[a] > box[2 * a + 1])) return 0;
    }
    *cost = bvxi_quadric_at(q, d) + LINE_EVEN * square * square;
    return 1;
}

/* The link condition, with a cone over each border of a sheet: what both ends have around them is what their edge has. */
static int link_holds(const complex_round *r, uint32_t u, uint32_t v)
{
    int good = 1;

    EACH_CORNER(r, u, c)
    {
        uint32_t const apex = across_from(r, c, v);
        for (uint32_t n = 1; n < 3; n++) {
            uint8_t *const met = &r->met[vertex_after(r, c, n)];
            *met = (uint8_t)(*met + (*met % MET_V < 3 ? MET_U : 0));
        }
        if (apex != BVXI_VERTEX_NONE) r->met[apex] |= MET_APEX;
    }
    EACH_CORNER(r, v, c)
    {
        uint32_t const x = vertex_after(r, c, 1), y = vertex_after(r, c, 2);
        for (uint32_t n = 1; n < 3; n++) {
            uint8_t *const met = &r->met[vertex_after(r, c, n)];
            *met = (uint8_t)(*met + (*met % MET_APEX / MET_V < 3 ? MET_V : 0));
        }
        if (x == u || y == u) continue;
        /* The other windows may have an edge of two vertices on seams, too. */
        good &= (r->kind[u] &
                 ((r->met[x] < MET_APEX ? r->kind[x] : 0) | (r->met[y] < MET_APEX ? r->kind[y] : 0)) &
                 BVX_ON_SEAM) == 0;
        int const near_x = r->met[x] % MET_V != 0, near_y = r->met[y] % MET_V != 0;
        good &= !(near_x && near_y) && (!near_x || r->met[x] >= MET_APEX) &&
                (!near_y || r->met[y] >= MET_APEX);
    }
    EACH_CORNER(r, v, c)
    {
        uint32_t const apex = across_from(r, c, u);
        /* A sheet of this triangle alone would go. */
        good &= apex == BVXI_VERTEX_NONE || r->met[apex] != MET_APEX + 3 * MET_V + 3 * MET_U;
    }
    for (int end = 0; end < 2; end++) EACH_CORNER(r, end == 0 ? u : v, c)
    for (uint32_t n = 1; n < 3; n++) r->met[vertex_after(r, c, n)] = 0;
    return good;
}

/* 1: triangles of v, but those of its edge with u, keep their sides and shapes when it moves to p. */
static int shapes_hold(const complex_round *r, uint32_t v, uint32_t u, const double p[3])
{
    EACH_CORNER(r, v, c)
    {
        uint32_t const x = vertex_after(r, c, 1), y = vertex_after(r, c, 2);
        const double *const a = r->at[x].p, *const b = r->at[y].p, *const old = r->at[v].p;
        double before[3], after[3];

        if (x == u || y == u) continue;
        bvxi_area_normal(old, a, b, before);
        bvxi_area_normal(p, a, b, after);
        double const area = bvxi_vec_length(after), was = bvxi_vec_length(before);
        double const side = bvxi_vec_distance2(a, b);
        double const sides = side + bvxi_vec_distance2(p, a) + bvxi_vec_distance2(p, b);
        double const sides_were = side + bvxi_vec_distance2(old, a) + bvxi_vec_distance2(old, b);
        if (!(area > 0) || (was > 0 && bvxi_vec_dot(before, after) <= LINE_COSINE * area * was)) return 0;
        if (area < LINE_SHAPE * sides && area * sides_were < was * sides) return 0;
    }
    return 1;
}

static void collapse_line(complex_round *r, uint32_t u, uint32_t v, const bvxi_quadric *q, const double p[3])
{
    bvxi_corner_vertex *const at = &r->at[u];
    uint32_t last = r->first[v];
    double d[3];

    for (uint32_t c = last; c != BVXI_VERTEX_NONE; c = r->next[c]) {
        last = c;
        if (is_corner_gone(r, c)) continue;
        r->left -= across_from(r, c, u) != BVXI_VERTEX_NONE;
        if (across_from(r, c, u) == BVXI_VERTEX_NONE) r->triangle[c] = u;
        else r->triangle[c / 3 * 3 + 1] = ~r->triangle[c / 3 * 3 + 1];
    }
    r->next[last] = r->first[u];
    r->first[u] = r->first[v];
    r->first[v] = BVXI_VERTEX_NONE;
    r->into[v] = u;
    r->fresh[u] = r->busy[u] = 1;
    r->lines--;
    for (int a = 0; a < 3; a++) d[a] = p[a] - at->p[a];
    at->q = *q;
    at->q.c = bvxi_quadric_at(q, d);
    bvxi_half_gradient(q, d, at->q.b);
    memcpy(at->p, p, sizeof at->p);
}

/* All edges of lines that may collapse, by rising cost; with costs NULL they are counted. */
static uint64_t list_lines(const complex_round *r, uint64_t *costs)
{
    uint64_t count = 0;
    bvxi_quadric q;
    double p[3], cost;

    for (uint64_t i = 0; i < r->from->mesh.vertex_count; i++) {
        if (r->kind[i] != LINE_ALONG || r->first[i] == BVXI_VERTEX_NONE) continue;
        uint32_t ends[2] = {0, 0};
        uint32_t const met = line_ends(r, (uint32_t)i, ends);
        for (uint32_t n = 0; n < 2 && met == 2; n++) {
            uint32_t u = ends[n], v = (uint32_t)i;
            if (r->kind[u] == LINE_ALONG && u > v) continue;
            if (costs == NULL) count++;
            else if (plan_line(r, &u, &v, &q, p, &cost)) {
                memcpy(&costs[count], &cost, sizeof cost); /* bits of positive numbers are in their order */
                r->ends[2 * count] = u;
                r->ends[2 * count++ + 1] = v;
            }
        }
    }
    return count;
}

/* Sweeps of the cheaper half of all edges, or of all after one in vain, until so many are left. */
static bvx_status collapse_lines(complex_round *r, uint64_t wanted)
{
    uint64_t *costs, done = 1, room = list_lines(r, NULL);
    uint32_t *order;
    int idle = 0;

    r->lines = room;
    BVXI_TRY(bvxi_alloc(r->ctx, BVXI_SCRATCH, room * 8, "the lines' costs", &costs));
    BVXI_TRY(bvxi_alloc(r->ctx, BVXI_SCRATCH, room * 4, "the lines' order", &order));
    BVXI_TRY(bvxi_alloc(r->ctx, BVXI_SCRATCH, room * 8, "the lines' ends", &r->ends));
    while (r->lines > wanted && idle < 2) {
        uint64_t const count = list_lines(r, costs), tried = idle == 0 ? count / 2 + 1 : count;

        for (uint64_t i = 0; i < count; i++) order[i] = (uint32_t)i;
        BVXI_TRY(bvxi_radix_sort(r->ctx, costs, order, count));
        memset(r->busy, 0, (size_t)r->from->mesh.vertex_count);
        done = r->lines;
        for (uint64_t i = 0; i < tried && i < count && r->lines > wanted; i++) {
            uint32_t u = r->ends[2 * (size_t)order[i]], v = r->ends[2 * (size_t)order[i] + 1];
            bvxi_quadric q;
            double p[3], cost;

            if (r->busy[u] || r->busy[v] || r->into[v] != v || r->into[u] != u) continue;
            if (plan_line(r, &u, &v, &q, p, &cost) && link_holds(r, u, v) && shapes_hold(r, u, v, p) &&
                shapes_hold(r, v, u, p))
                collapse_line(r, u, v, &q, p);
        }
        idle = done == r->lines ? idle + 1 : 0;
        BVXI_TRY(bvxi_progress(r->ctx, "lines", 0.02));
    }
    return BVX_OK;
}

/* Hold what has become of triangles that cross; *count: pairs. */
static bvx_status hold_crossings(complex_round *r, uint64_t *count)
{
    crossing_tree tree = {.at = r->at[0].p,
                          .vertex = r->triangle,
                          .at_step = sizeof *r->at / sizeof *tree.at,
                          .vertex_step = 3,
                          .fresh = r->fresh,
                          .triangles = r->from->mesh.triangle_count,
                          .scale = r->scale,
                          .slanted = 1};
    uint32_t *pairs;

    memcpy(tree.low, r->low, sizeof tree.low);
    BVXI_TRY(bvxi_crossing_tree_open(r->ctx, &tree));
    BVXI_TRY(bvxi_crossings_find(r->ctx, &tree, 0.02, 0.02, UINT64_MAX, &pairs, count));
    for (uint64_t i = 0; i < 2 * *count; i++)
        for (uint64_t k = 0; k < 3; k++) r->met[r->triangle[3 * (size_t)pairs[i] + k]] = 1;
    for (uint32_t v = 0; v < r->from->mesh.vertex_count && *count != 0; v++) {
        uint32_t to = v;
        while (r->into[to] != to) to = r->into[to];
        r->held[v] |= r->met[to] & r->fresh[to];
    }
    memset(r->met, 0, (size_t)r->from->mesh.vertex_count);
    return BVX_OK;
}

/* Lines get longer edges as triangles get larger ones. What would cross is held, and all is done anew. */
static bvx_status thin_junction_lines(complex_round *r, uint64_t target)
{
    double const share = sqrt((double)target / (double)r->from->mesh.triangle_count);

    for (int tries = 0;; tries++) {
        uint64_t crossings = 0;

        /* The complex as the round found it. */
        const bvx_mesh *const mesh = &r->from->mesh;
        bvx_mesh_view view;

        bvx_mesh_view_of(mesh, &view);
        r->left = mesh->triangle_count;
        memcpy(r->triangle, mesh->triangles, (size_t)mesh->triangle_count * 12);
        memset(r->first, 0xff, (size_t)mesh->vertex_count * 4);
        for (uint64_t c = 3 * mesh->triangle_count; c-- > 0;) {
            r->next[c] = r->first[r->triangle[c]];
            r->first[r->triangle[c]] = (uint32_t)c;
        }
        for (uint64_t v = 0; v < mesh->vertex_count; v++) {
            bvxi_view_position(&view, v, r->at[v].p);
            r->into[v] = (uint32_t)v;
            r->fresh[v] = 0;
        }
        for (uint64_t v = 0; v < mesh->vertex_count; v++) line_quadric(r, (uint32_t)v);

        if (tries == LINE_TRIES) return BVX_OK;
        BVXI_TRY(BVXI_SCOPE(r->ctx, collapse_lines(r, (uint64_t)(share * (double)list_lines(r, NULL)))));
        BVXI_TRY(BVXI_SCOPE(r->ctx, hold_crossings(r, &crossings)));
        if (crossings == 0) return BVX_OK;
    }
}

/* ---- Sheets ---- */

/* A vertex of lines is one of each sheet around it: view becomes the mesh of all sheets. */
static bvx_status part_label_sheets(complex_round *r, bvx_mesh_view *view)
{
    uint32_t *number, *indices, count = 0;
    double *positions;
    uint64_t written = 0;

    BVXI_TRY(
        bvxi_alloc(r->ctx, BVXI_SCRATCH, r->from->mesh.triangle_count * 12, "the sheets' corners", &number));
    BVXI_TRY(bvxi_alloc(r->ctx, BVXI_SCRATCH, r->left * 24, "the sheets' vertices", &r->source));
    BVXI_TRY(bvxi_alloc(r->ctx, BVXI_SCRATCH, r->left * 12, "the sheets' triangles", &indices));
    r->owner = r->source + 3 * r->left;
    for (uint64_t v = 0; v < r->from->mesh.vertex_count; v++) EACH_CORNER(r, v, c)
        {
            uint32_t d = alive_from(r, r->first[v]);
            while (d != c && r->kind[v] != 0 &&
                   memcmp(r->from->sides + c / 3 * 2, r->from->sides + d / 3 * 2, 8) != 0)
                d = alive_from(r, r->next[d]);
            number[c] = d == c ? count : number[d];
            if (d != c) continue;
            r->source[count] = (uint32_t)v;
            r->owner[count++] = c / 3;
        }
    for (uint32_t c = 0; c < 3 * r->from->mesh.triangle_count; c++)
        if (!is_corner_gone(r, c)) indices[written++] = number[c];
    BVXI_TRY(bvxi_alloc(r->ctx, BVXI_SCRATCH, (uint64_t)count * 24, "the sheets' positions", &positions));
    for (uint64_t i = 0; i < count; i++) memcpy(positions + 3 * i, r->at[r->source[i]].p, 24);
    *view = (bvx_mesh_view){.positions = positions,
                            .indices = indices,
                            .vertex_count = count,
                            .triangle_count = r->left,
                            .position_type = BVX_F64,
                            .index_type = BVX_U32};
    return BVX_OK;
}

/* What is left of the sheets, with shared vertices, which keep their order. */
static bvx_status join_label_sheets(complex_round *r, const bvxi_collapse *c, complex_parts *to)
{
    const bvx_mesh *const from = &r->from->mesh;
    const bvxi_corners *const m = &c->mesh;
    uint32_t *number, count = 0, t = 0;

    BVXI_TRY(bvxi_alloc_zero(r->ctx, BVXI_SCRATCH, from->vertex_count * 4, "the new vertices", &number));
    for (uint64_t v = 0; v < m->vertices; v++)
        if (!bvxi_collapse_is_gone(c, (uint32_t)v)) number[r->source[m->source[v]]] = 1;
    for (uint64_t v = 0; v < from->vertex_count; v++) number[v] = number[v] != 0 ? count++ : UINT32_MAX;
    BVXI_TRY(bvxi_mesh_open(r->ctx, r->function, from->position_type, 0, count, m->left, &to->mesh));
    memcpy(to->mesh.frame, from->frame, sizeof from->frame);
    BVXI_TRY(bvxi_alloc(r->ctx, BVXI_RESULT, m->left * 8, "the triangles' labels", &to->sides));
    BVXI_TRY(bvxi_alloc(r->ctx, BVXI_RESULT, count, "the junctions", &to->junctions));
    for (uint64_t v = 0; v < m->vertices; v++) {
        if (bvxi_collapse_is_gone(c, (uint32_t)v)) continue;
        uint32_t const source = r->source[m->source[v]], index = number[source];
        int const stays = (r->kind[source] & BVX_ON_SEAM) != 0;
        to->junctions[index] = stays ? r->from->junctions[source] : r->kind[source];
        for (uint64_t a = 0; a < 3; a++) {
            if (from->position_type == BVX_F64)
                ((double *)to->mesh.positions)[3 * (size_t)index + a] = m->at[v].p[a];
            else ((float *)to->mesh.positions)[3 * (size_t)index + a] = (float)m->at[v].p[a];
        }
    }
    for (uint64_t i = 0; i < m->triangles; i++) {
        const uint32_t *const v = m->triangle[i].vertex;
        if (bvxi_triangle_gone(&m->triangle[i])) continue;
        for (uint64_t k = 0; k < 3; k++)
            to->mesh.triangles[3 * (size_t)t + k] = number[r->source[m->source[v[k]]]];
        memcpy(to->sides + 2 * (size_t)t++, r->from->sides + 2 * (size_t)r->owner[m->source[v[0]]], 8);
    }
    return BVX_OK;
}

/* ---- Rounds ---- */

static bvx_status run_complex_round(bvx_context *ctx, const char *function, const complex_parts *from,
                                    uint64_t target, complex_parts *to)
{
    uint64_t const vertices = from->mesh.vertex_count, triangles = from->mesh.triangle_count;
    complex_round r = {.ctx = ctx, .function = function, .from = from};
    double high[3], size = 0;
    bvx_mesh_view view;

    bvx_mesh_view_of(&from->mesh, &view);
    BVXI_TRY(bvxi_view_bounds(ctx, function, &view, r.low, high));
    for (int a = 0; a < 3; a++) size = high[a] - r.low[a] > size ? high[a] - r.low[a] : size;
    r.scale = 1 / size;
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, vertices * sizeof *r.at, "the vertices", &r.at));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, triangles * 24 + vertices * 8, "the triangles", &r.triangle));
    r.next = r.triangle + 3 * triangles;
    r.first = r.next + 3 * triangles;
    r.into = r.first + vertices;
    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, vertices * 5, "the vertices' kinds", &r.kind));
    r.held = r.kind + vertices;
    r.fresh = r.held + vertices;
    r.busy = r.fresh + vertices;
    r.met = r.busy + vertices;
    BVXI_TRY(thin_junction_lines(&r, target));
    bvxi_collapse_options options = {
        .even = BVXI_EVEN, .borders = BVXI_BORDERS_KEPT, .sheets = 1, .box = r.from->box};
    bvxi_sheets sheets = {.corner = NULL};
    bvxi_collapse *c;

    options.given.position_type = r.from->mesh.position_type;
    options.given.lock_border = 1;
    BVXI_TRY(part_label_sheets(&r, &sheets.view));
    if (r.from->box != NULL) {
        uint64_t const count = sheets.view.vertex_count;
        uint8_t *locked;
        BVXI_TRY(bvxi_alloc(r.ctx, BVXI_SCRATCH, count, "the seams", &locked));
        for (uint64_t i = 0; i < count; i++) locked[i] = r.from->junctions[r.source[i]] & BVX_ON_SEAM;
        options.given.locked = locked;
    }
    BVXI_TRY(bvxi_collapse_open(r.ctx, r.function, &sheets.view, &sheets, &options, &c));
    BVXI_TRY(bvxi_collapse_to(c, target, 0.2, 1.0));
    return join_label_sheets(&r, c, to);
}

/* 1: each body has two triangles at each of its edges. Label none is no body. */
static bvx_status bodies_hold(bvx_context *ctx, const complex_parts *parts, uint64_t none, int *hold)
{
    uint64_t const edges = 3 * parts->mesh.triangle_count;
    const uint32_t *const triangles = parts->mesh.triangles;
    uint64_t *keys, end;
    uint32_t *order;

    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, edges * 8, "the edges' keys", &keys));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, edges * 4, "the edges' order", &order));
    for (uint64_t e = 0; e < edges; e++) {
        uint64_t const a = triangles[e], b = triangles[e - e % 3 + (e % 3 + 1) % 3];
        keys[e] = a < b ? a << 32 | b : b << 32 | a;
        order[e] = (uint32_t)e;
    }
    BVXI_TRY(bvxi_radix_sort(ctx, keys, order, edges));
    *hold = 1;
    for (uint64_t first = 0; first < edges; first = end) {
        for (end = first; end < edges && keys[end] == keys[first];) end++;
        /* Bodies of open windows end there. */
        int const seam = (parts->junctions[keys[first] >> 32] & parts->junctions[keys[first] & UINT32_MAX] &
                          BVX_ON_SEAM) != 0;
        for (uint64_t i = 2 * first; i < 2 * end; i++) {
            uint32_t const label = parts->sides[order[i / 2] / 3 * 2 + i % 2];
            int met = 0;
            for (uint64_t k = 2 * first; k < 2 * end; k++)
                met += parts->sides[order[k / 2] / 3 * 2 + k % 2] == label;
            *hold &= met == 2 || label == none || (met == 1 && seam);
        }
    }
    return BVX_OK;
}

static void free_complex_parts(bvx_context *ctx, const bvx_complex *complex, complex_parts *parts)
{
    bvxi_free(ctx, parts->sides, parts->mesh.triangle_count * 8);
    parts->sides = NULL;
    /* The first ones are the complex's. */
    if (parts->mesh.positions == complex->mesh.positions) return;
    bvxi_free(ctx, parts->junctions, parts->mesh.vertex_count);
    bvx_mesh_free(ctx, &parts->mesh);
}

/* Rounds down to a count, or as long as the mean distance keeps the error. */
static bvx_status run_complex_rounds(bvx_context *ctx, const char *function, const bvx_complex *complex,
                                     uint64_t triangles, double error, complex_parts *now)
{
    bvxi_distance_tree kept = {.built = 0};
    bvx_status status = BVX_OK;
    double at = 0.0, share = 0.0;
    bvx_mesh_view view, view_next;

    bvx_mesh_view_of(&complex->mesh, &view);
    while (status == BVX_OK && now->mesh.triangle_count > triangles) {
        uint64_t const before = now->mesh.triangle_count, near = before / ROUND_SHARE;
        uint64_t const target = error > 0          ? bvxi_collapse_next_try(before, share)
                                : near > triangles ? near
                                                   : triangles;
        double const to = 0.5 + 0.5 * at;
        complex_parts next = {.box = now->box};
        bvx_distance_report d;

        status = BVXI_SHARE(ctx, at, to,
                            BVXI_SCOPE(ctx, run_complex_round(ctx, function, now, target, &next)));
        if (status == BVX_OK && error > 0) {
            bvx_mesh_view_of(&next.mesh, &view_next);
            status = bvxi_mesh_distance(ctx, &view, &kept, &view_next, ERROR_SAMPLES, ERROR_SEED, &d);
            share = d.mean / error;
        }
        int hold = 0;
        if (status == BVX_OK) status = BVXI_SCOPE(ctx, bodies_hold(ctx, &next, complex->label_count, &hold));
        at = to;
        int const better = status == BVX_OK && hold && share <= 1 && next.mesh.triangle_count < before;
        free_complex_parts(ctx, complex, better ? now : &next);
        if (!better) break;
        *now = next;
    }
    bvxi_distance_forget(ctx, &kept);
    if (status == BVX_OK && now->mesh.triangle_count > triangles && error == 0)
        BVXI_WARN(ctx, BVX_WARN_TARGET, 0.0, (double)triangles, (double)now->mesh.triangle_count, 0.0, 0.0);
    return status;
}

bvx_status bvxi_complex_simplify(bvx_context *ctx, const char *function, bvx_complex *complex,
                                 uint64_t triangles, double error, const double *box)
{
    uint64_t const vertices = complex->mesh.vertex_count, count = complex->mesh.triangle_count;
    complex_parts now = {.mesh = complex->mesh, .junctions = complex->junctions, .box = box};

    if (count > INT32_MAX / 4)
        return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                             "%s: %u triangles are too many to collapse; %u are possible, take windows",
                             function, count, (uint64_t)INT32_MAX / 4);
    BVXI_TRY(bvxi_alloc(ctx, BVXI_RESULT, count * 8, "the triangles' labels", &now.sides));

    /* Those of one cell can be at one position, so their places tell them apart. */
    for (uint64_t v = 0; v < vertices; v++) {
        uint32_t place = 0;
        if ((now.junctions[v] & BVX_ON_SEAM) == 0) continue;
        while (place < v && complex->cells[v - place - 1] == complex->cells[v]) place++;
        now.junctions[v] = (uint8_t)(BVX_ON_SEAM | place);
    }
    for (uint64_t t = 0; t < count; t++) memcpy(now.sides + 2 * t, complex->sides + t / 2 * 2, 8);
    bvx_status const status = run_complex_rounds(ctx, function, complex, triangles, error, &now);
    if (status != BVX_OK) {
        free_complex_parts(ctx, complex, &now);
        return status;
    }
    bvxi_free(ctx, complex->sides, complex->face_count * 8);
    bvxi_free(ctx, complex->cells, vertices * 8);
    if (now.mesh.positions != complex->mesh.positions) {
        bvxi_free(ctx, complex->junctions, vertices);
        bvx_mesh_free(ctx, &complex->mesh);
    }
    complex->mesh = now.mesh;
    complex->sides = now.sides;
    complex->junctions = now.junctions;
    complex->cells = NULL;
    complex->face_count = now.mesh.triangle_count;
    complex->single = 1;
    return BVX_OK;
}
