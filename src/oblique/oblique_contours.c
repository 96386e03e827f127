/* oblique_contours.c - contours become edges of the tetrahedra that their planes have split.
 *
 * The faces on a plane are a triangulation of what of it lies in split cells. First the places where contours
 * of crossing planes meet become vertices, which lie on both planes; then each contour's points, in the
 * triangle or edge that they lie in; then each segment is followed from vertex to vertex and splits the edges
 * that it crosses. After that every contour is a way of edges, and each of its points a vertex. */
#include "oblique/oblique.h"

#include <math.h>

/* Rounding could lead a way in a circle; such a segment is counted as not kept. */
enum { CONTOUR_STEPS = 1000000 };

/* Points and segments between two reports. */
enum { CONTOUR_REPORT = 1024 };

/* In cells: a place outside of every triangle by more than rounding lies where the plane is not split. */
#define FACE_MISS 1e-3

/* A cell with more tetrahedra than that is crowded: its triangles are looked for from the point before. */
#define CROWDED_CELL 512

typedef struct plane_face {
    uint32_t tetra;
    int corner;
    double least; /* from the place to the nearest side, below 0 outside [Units: cells] */
    int edge;     /* the corner opposite that side */
} plane_face;

static void vertex_uv(const bvxi_oblique *o, uint32_t plane, uint32_t v, double uv[2])
{
    bvxi_oblique_uv(&o->plane[plane], o->vertex[v].at, uv);
}

static double cross_uv(const double a[2], const double b[2], const double c[2])
{
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/* Replaces *best where uv lies deeper inside the triangle opposite the corner; one with a corner off the
 * plane is none. */
static void keep_better_face(const bvxi_oblique *o, uint32_t plane, uint32_t t, int corner,
                             const double uv[2], plane_face *best)
{
    double at[3][2], area, least = 1e300;
    int edge = 0, n = 0, which[3];

    for (int k = 0; k < 4; k++)
        if (k != corner && !bvxi_is_on(o, o->tetra[t].v[k], plane)) return;
    for (int k = 0; k < 4; k++) {
        if (k == corner) continue;
        vertex_uv(o, plane, o->tetra[t].v[k], at[n]);
        which[n++] = k;
    }

    /* Seen from either side the triangle may run either way: its area's sign decides. */
    area = cross_uv(at[0], at[1], at[2]);
    for (int k = 0; k < 3; k++) {
        const double *const a = at[(k + 1) % 3], *const b = at[(k + 2) % 3];
        double const length = sqrt((b[0] - a[0]) * (b[0] - a[0]) + (b[1] - a[1]) * (b[1] - a[1]));
        double in = cross_uv(a, b, uv) / (length > 0.0 ? length : 1.0);
        if (area < 0.0) in = -in;
        if (in >= least) continue;
        least = in;
        edge = which[k];
    }

    if (!(least > best->least)) return;
    best->tetra = t;
    best->corner = corner;
    best->least = least;
    best->edge = edge;
}

/* Returns how many tetrahedra there are. */
static uint32_t judge_cell_faces(const bvxi_oblique *o, uint32_t plane, uint32_t cell, const double uv[2],
                                 plane_face *best)
{
    uint32_t count = 0;
    for (uint32_t t = 6 * cell; t != BVXI_NONE; t = o->tetra[t].chain, count++)
        for (int k = 0; k < 4; k++) keep_better_face(o, plane, t, k, uv, best);
    return count;
}

/* Where points of contours are looked for: the last one that was found, and whether its cell is crowded. */
typedef struct face_search {
    uint32_t vertex;
    int crowded;
} face_search;

/* The triangle that holds a place: in its cell, or in one next to it, since vertices have moved a little. In a
 * crowded cell points would be looked for in all that those before them have split; the next of a contour is
 * mostly in a triangle round the last. */
static bvx_status find_face(bvxi_oblique *o, uint32_t plane, const double at[3], face_search *search,
                            plane_face *found)
{
    plane_face best = {BVXI_NONE, 0, -1e300, 0};
    double uv[2];
    int32_t c[3];

    bvxi_oblique_uv(&o->plane[plane], at, uv);
    if (search->crowded && search->vertex != BVXI_NONE) {
        BVXI_TRY(bvxi_tetra_star(o, search->vertex));
        for (uint64_t i = 0; i < o->star_count; i++)
            for (int k = 0; k < 4; k++) keep_better_face(o, plane, o->star[i], k, uv, &best);
        *found = best;
        if (best.least > BVXI_OBLIQUE_NEAR) return BVX_OK;
        best.tetra = BVXI_NONE;
        best.least = -1e300;
    }

    for (int k = 0; k < 3; k++) c[k] = (int32_t)floor(at[k]);
    uint32_t cell = bvxi_oblique_cell_at(o, c);
    search->crowded = 0;
    if (cell != BVXI_NONE) search->crowded = judge_cell_faces(o, plane, cell, uv, &best) > CROWDED_CELL;

    for (int n = 0; n < 27 && best.least < 0.0; n++) {
        int32_t const d[3] = {c[0] + n % 3 - 1, c[1] + n / 3 % 3 - 1, c[2] + n / 9 - 1};
        cell = n == 13 ? BVXI_NONE : bvxi_oblique_cell_at(o, d);
        if (cell != BVXI_NONE) judge_cell_faces(o, plane, cell, uv, &best);
    }
    if (best.least < -FACE_MISS) best.tetra = BVXI_NONE;
    *found = best;
    return BVX_OK;
}

/* ---- points ---- */

/* The vertex at a place of a plane, a new one where there is none; on the plane exactly. */
static bvx_status insert_point(bvxi_oblique *o, uint32_t plane, const double given[3], face_search *search,
                               uint32_t *vertex)
{
    const bvxi_oblique_plane *const p = &o->plane[plane];
    double const height = bvxi_oblique_height(p, given);
    double const at[3] = {given[0] - height * p->normal[0], given[1] - height * p->normal[1],
                          given[2] - height * p->normal[2]};
    plane_face f;
    uint32_t end[2];
    int n = 0;

    *vertex = BVXI_NONE;
    BVXI_TRY(find_face(o, plane, at, search, &f));
    if (f.tetra == BVXI_NONE) return BVX_OK;

    /* Two vertices at one place would have an edge of no length: an old one that is as near is taken. */
    const bvxi_tetra *t = &o->tetra[f.tetra];
    for (int k = 0; k < 4; k++) {
        double square = 0.0;
        for (int x = 0; x < 3; x++)
            square += (o->vertex[t->v[k]].at[x] - at[x]) * (o->vertex[t->v[k]].at[x] - at[x]);
        if (k == f.corner || square > 4.0 * BVXI_OBLIQUE_NEAR * BVXI_OBLIQUE_NEAR) continue;
        *vertex = t->v[k];
        return BVX_OK;
    }

    /* Inside the triangle, or so near a side that the side itself is split. */
    if (f.least > BVXI_OBLIQUE_NEAR) return bvxi_tetra_split_face(o, f.tetra, f.corner, at, vertex);
    for (int k = 0; k < 4; k++)
        if (k != f.corner && k != f.edge) end[n++ & 1] = t->v[k];
    return bvxi_tetra_split_edge(o, f.tetra, end[0], end[1], at, vertex);
}

/* A plane may have millions of points. */
static bvx_status report_points(const bvxi_oblique *o, double from, const uint32_t *vertex)
{
    uint64_t const done = (uint64_t)(vertex - o->plane[0].vertex);
    if (done % CONTOUR_REPORT != 0) return BVX_OK;
    return bvxi_progress(o->ctx, "surface", from + 0.5 * (double)done / o->point_count);
}

static bvx_status insert_points(bvxi_oblique *o, uint32_t plane)
{
    uint32_t *const vertex = o->plane[plane].vertex;
    const bvxi_oblique_plane *const f = &o->plane[plane];
    const bvxi_plane *const p = &f->plane;
    face_search search = {BVXI_NONE, 0};

    memset(vertex, 0xff, (size_t)p->point_count * 4);

    /* Points that are knots have their vertex already, where the knot is, which may have moved. */
    for (uint32_t k = f->knot; k != BVXI_NONE; k = o->knot[k].next)
        if (o->knot[k].share == 0.0) {
            uint32_t const at = o->knot[bvxi_knot_root(o, k)].vertex;
            if (at != BVXI_NONE && bvxi_is_on(o, at, plane)) vertex[o->knot[k].segment] = at;
        }
    for (uint32_t i = 0; i < p->point_count; i++) {
        double at[3];
        BVXI_TRY(report_points(o, 0.0, vertex + i));
        if (vertex[i] == BVXI_NONE) {
            bvxi_oblique_in_cells(o, o->given->points + 3 * (uint64_t)p->given[i], at);
            BVXI_TRY(insert_point(o, plane, at, &search, &vertex[i]));
            if (vertex[i] != BVXI_NONE) o->vertex[vertex[i]].sign = 0;
        }
        search.vertex = vertex[i];
    }
    return BVX_OK;
}

/* ---- segments ---- */

/* What a way along a plane meets next, from a vertex: another vertex on it, or an edge that it crosses. */
typedef struct way_step {
    uint32_t vertex;
    uint32_t tetra, edge[2];
    double at[3];
} way_step;

typedef struct way_line {
    uint32_t plane, to;
    double from[2], way[2], length;
    double nearest; /* how far off the vertex lies that was found; -1: it is the end */
} way_line;

/* Judges one edge v of the triangles around where the line begins: any vertex on it comes before any edge
 * that it crosses; of several vertices the one nearest the line, and its end before all. */
static void judge_step(const bvxi_oblique *o, way_line *line, uint32_t t, const uint32_t v[2], way_step *step)
{
    const double *const d = line->way;
    double off[2], along[2], share;

    for (int k = 0; k < 2; k++) {
        double uv[2];
        vertex_uv(o, line->plane, v[k], uv);
        for (int x = 0; x < 2; x++) uv[x] -= line->from[x];
        off[k] = v[k] == line->to ? 0.0 : (uv[1] * d[0] - uv[0] * d[1]) / line->length;
        along[k] = (uv[0] * d[0] + uv[1] * d[1]) / line->length;
        if (bvxi_absolute(off[k]) > BVXI_OBLIQUE_NEAR || !(along[k] > 0.0)) continue;
        /* Rounding may put several vertices on the line: the way must not run past its end. */
        if (bvxi_absolute(off[k]) < line->nearest || v[k] == line->to) {
            line->nearest = v[k] == line->to ? -1.0 : bvxi_absolute(off[k]);
            step->vertex = v[k];
        }
    }
    if (step->vertex != BVXI_NONE || (off[0] > 0.0) == (off[1] > 0.0)) return;

    /* Crossed ahead, not behind, and between the ends: those themselves were looked at above. */
    share = off[0] / (off[0] - off[1]);
    if (!(along[0] + share * (along[1] - along[0]) > 0.0) || !(share > 0.0 && share < 1.0)) return;
    step->tetra = t;
    for (int k = 0; k < 2; k++) step->edge[k] = v[k];
    for (int k = 0; k < 3; k++)
        step->at[k] = o->vertex[v[0]].at[k] + share * (o->vertex[v[1]].at[k] - o->vertex[v[0]].at[k]);
}

static bvx_status next_step(bvxi_oblique *o, uint32_t plane, uint32_t from, uint32_t to, way_step *step)
{
    way_line line = {plane, to, {0.0, 0.0}, {0.0, 0.0}, 0.0, 1e300};
    double end[2];

    step->vertex = step->tetra = BVXI_NONE;
    vertex_uv(o, plane, from, line.from);
    vertex_uv(o, plane, to, end);
    for (int k = 0; k < 2; k++) line.way[k] = end[k] - line.from[k];
    line.length = sqrt(line.way[0] * line.way[0] + line.way[1] * line.way[1]);

    BVXI_TRY(bvxi_tetra_star(o, from));
    for (uint64_t i = 0; i < o->star_count; i++) {
        const bvxi_tetra *const t = &o->tetra[o->star[i]];
        for (int k = 0; k < 4; k++) {
            uint32_t v[2];
            int n = 0, on = t->v[k] != from;
            for (int j = 0; j < 4; j++) {
                if (j == k) continue;
                on &= bvxi_is_on(o, t->v[j], plane);
                if (t->v[j] != from) v[n++ & 1] = t->v[j];
            }
            if (on && n == 2) judge_step(o, &line, o->star[i], v, step);
        }
    }
    return BVX_OK;
}

/* From a vertex of a plane straight to another one; what it goes along becomes a contour's edge. */
static bvx_status insert_segment(bvxi_oblique *o, uint32_t plane, uint32_t from, uint32_t to)
{
    if (from == BVXI_NONE || to == BVXI_NONE) {
        o->report.unkept_edges++;
        return BVX_OK;
    }
    for (uint32_t steps = 0; from != to; steps++) {
        way_step step;
        uint32_t *value;

        BVXI_TRY(next_step(o, plane, from, to, &step));
        if (step.vertex == BVXI_NONE && step.tetra != BVXI_NONE)
            BVXI_TRY(bvxi_tetra_split_edge(o, step.tetra, step.edge[0], step.edge[1], step.at, &step.vertex));
        /* Where contours contradict each other a way may lead nowhere: it is counted and left out. */
        if (step.vertex == BVXI_NONE || steps == CONTOUR_STEPS) {
            o->report.unkept_edges++;
            return BVX_OK;
        }
        o->vertex[step.vertex].sign = 0;
        BVXI_TRY(bvxi_edge_add(o, &o->contour_edge, from, step.vertex, &value));
        *value = 2 * plane + (from > step.vertex);
        from = step.vertex;
    }
    return BVX_OK;
}

bvx_status bvxi_oblique_contours(bvxi_oblique *o)
{
    uint32_t *vertex;

    BVXI_TRY(BVXI_ARRAY(o->ctx, o->point_count, "the points of contours", vertex));
    for (uint32_t i = 0; i < o->plane_count; vertex += o->plane[i++].plane.point_count)
        o->plane[i].vertex = vertex;

    /* Meeting places first: on the lines of planes that cross no edge is missing yet. */
    for (uint64_t i = 0; i < o->knot_count; i++) {
        bvxi_knot *const k = &o->knot[i];
        face_search alone = {BVXI_NONE, 0};
        double at[3];
        if (k->joined != i) continue;
        bvxi_knot_place(o, (uint32_t)i, at);
        BVXI_TRY(insert_point(o, k->plane, at, &alone, &k->vertex));
        if (k->vertex != BVXI_NONE) o->vertex[k->vertex].sign = 0;
    }

    for (uint32_t i = 0; i < o->plane_count; i++) BVXI_TRY(insert_points(o, i));
    for (uint32_t i = 0; i < o->plane_count; i++) {
        const bvxi_plane *const p = &o->plane[i].plane;
        vertex = o->plane[i].vertex;
        for (uint32_t n = 0; n < p->point_count; n++) {
            BVXI_TRY(report_points(o, 0.5, vertex + n));
            /* By way of the meeting places on the segment, in their order. */
            uint32_t from = vertex[n], knot = bvxi_knot_after(o, i, n, 0.0);
            for (; knot != BVXI_NONE; knot = bvxi_knot_after(o, i, n, o->knot[knot].share)) {
                uint32_t const way = o->knot[bvxi_knot_root(o, knot)].vertex;
                /* A knot that was moved off this plane is left out rather than gone to. */
                if (way == BVXI_NONE || !bvxi_is_on(o, way, i)) continue;
                BVXI_TRY(insert_segment(o, i, from, way));
                from = way;
            }
            BVXI_TRY(insert_segment(o, i, from, vertex[p->next[n]]));
        }
    }
    return BVX_OK;
}
