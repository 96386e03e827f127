/* trace_field.c - sections on which the field decides: those in the paper's and the classic way.
 *
 * An edge between a corner inside and one outside is crossed where the field, linear between them, is 0. Two
 * crossings of a cell's face are joined; four by the field at the point where the lines joining opposite ones
 * meet; more, as subdivided neighbours may make, each stretch inside by itself. In the paper's way the
 * contour's points in the cell are put into the lines, each into the nearer one where there are two. */
#include "layers/trace.h"

/* ---- the arrays of a loop, which grow on the calling thread, never in a view that other threads have ---- */

bvx_status bvxi_trace_reserve(const bvxi_trace *t, void *array, uint64_t count, uint64_t *room, uint64_t item)
{
    if (BVXI_LIKELY(count <= *room)) return BVX_OK;
    if (t->s->fixed) return BVX_ERR_BUDGET;
    return bvxi_reserve(t->s->ctx, array, count + count / 2 + 64, room, item, "the loops of a cell");
}

bvx_status bvxi_trace_open_loop(bvxi_trace *t, uint64_t count)
{
    uint64_t room[4] = {t->loop_room, t->loop_room, t->loop_room, t->loop_room};
    BVXI_TRY(bvxi_trace_reserve(t, &t->faces, count, &room[0], sizeof *t->faces));
    BVXI_TRY(bvxi_trace_reserve(t, (void *)&t->at, count, &room[1], sizeof *t->at));
    BVXI_TRY(bvxi_trace_reserve(t, &t->next, count, &room[2], sizeof *t->next));
    BVXI_TRY(bvxi_trace_reserve(t, &t->before, count, &room[3], sizeof *t->before));
    return bvxi_trace_reserve(t, &t->vertex, count, &t->loop_room, sizeof *t->vertex);
}

bvx_status bvxi_trace_add_to_loop(bvxi_trace *t, uint32_t *count, uint32_t vertex, uint32_t faces)
{
    if (*count >= t->loop_room) BVXI_TRY(bvxi_trace_open_loop(t, (uint64_t)*count + 1));
    t->vertex[*count] = vertex;
    t->faces[(*count)++] = (uint8_t)faces;
    return BVX_OK;
}

/* ---- crossings ---- */

#define FIELD_EDGE_MARGIN (1.0 / 1024.0)

bvx_status bvxi_trace_edge(bvxi_trace *t, int k, const bvxi_trace_node *a, const bvxi_trace_node *b,
                           uint32_t *vertex)
{
    bvxi_stack *const s = t->s;
    int const axis = a->at[0] == b->at[0], turned = a->at[axis] > b->at[axis];
    const bvxi_trace_node *const low = turned ? b : a, *const high = turned ? a : b;
    uint64_t const key = (uint64_t)(uint32_t)low->at[0] << 32 | (uint64_t)(uint32_t)low->at[1] << 1 |
                         (uint64_t)axis;
    uint32_t *found, number;
    double from, to, share, place[3], uv[2];

    /* A neighbouring cell may have made this vertex already; from its low end both compute the same. */
    BVXI_TRY(bvxi_stack_map_add(s, t->level[k].edges, key, &found));
    *vertex = *found;
    if (*found != BVXI_NONE) return BVX_OK;
    from = bvxi_field_corner(t->field, low->at, k, low->inside[k]);
    to = bvxi_field_corner(t->field, high->at, k, high->inside[k]);
    share = from - to != 0.0 ? from / (from - to) : 0.5;
    /* Off the corners, so that no triangle is without area. */
    if (!(share > FIELD_EDGE_MARGIN)) share = FIELD_EDGE_MARGIN;
    if (share > 1.0 - FIELD_EDGE_MARGIN) share = 1.0 - FIELD_EDGE_MARGIN;
    for (int i = 0; i < 2; i++) {
        double const l = bvxi_fixed_u(s, i, low->at[i]), h = bvxi_fixed_u(s, i, high->at[i]);
        uv[i] = i == axis ? l + share * (h - l) : l;
    }
    bvxi_section_place(s, uv[0], uv[1], t->level[k].w, place);
    BVXI_TRY(bvxi_section_add_vertex(s, place, &number));
    *found = *vertex = number;
    return BVX_OK;
}

static void uv_of_vertex(const bvxi_trace *t, uint32_t vertex, double uv[2])
{
    const double *const p = bvxi_section_vertex(t->s, vertex);
    for (int k = 0; k < 2; k++) uv[k] = bvxi_along_axis(t->s->axis[k], p);
}

void bvxi_trace_face(bvxi_trace *t, int k)
{
    uint32_t const n = t->cross_count[k];
    uint32_t const *const cross = t->cross[k];
    /* crossings into the inside, counter-clockwise, are those of this parity */
    uint32_t const enters = t->node[0].inside[k];
    int joins = 0;

    /* The field where the lines joining opposite crossings of a face meet. */
    if (n == 4) {
        double p[4][2], d, share;
        for (int i = 0; i < 4; i++) uv_of_vertex(t, t->point[cross[i]].vertex, p[i]);
        d = (p[2][0] - p[0][0]) * (p[3][1] - p[1][1]) - (p[2][1] - p[0][1]) * (p[3][0] - p[1][0]);
        share = ((p[1][0] - p[0][0]) * (p[3][1] - p[1][1]) - (p[1][1] - p[0][1]) * (p[3][0] - p[1][0])) / d;
        /* Lines that do not meet between their ends: the middle will do. */
        if (!(share > 0.0 && share < 1.0)) share = 0.5;
        joins = bvxi_field_at(t->field, p[0][0] + share * (p[2][0] - p[0][0]),
                              p[0][1] + share * (p[2][1] - p[0][1]), k) > 0.0;
    }
    for (uint32_t i = enters; i < n; i += 2) {
        uint32_t const in = cross[i], out = cross[joins ? (i + n - 1) % n : (i + 1) % n];
        bvxi_trace_point *const p = &t->point[k == 0 ? out : in];
        p->next = k == 0 ? in : out;
        p->link = k == 0 ? BVXI_LINK_FIELD : BVXI_LINK_FIELD_BACK;
    }
}

/* 1 when the point belongs to the line from a to b, and not to a nearer one of the face. */
static int is_nearest_line(bvxi_trace *t, int k, uint32_t from, uint32_t to, const double a[2],
                           const double b[2], const double p[2])
{
    double const own = bvxi_segment_square(a, b, p);

    for (uint32_t i = 0; i < t->cross_count[k]; i++) {
        uint32_t const c = t->cross[k][i], d = t->point[c].next;
        double e[2], f[2], other;
        if (c == from || (t->point[c].link != BVXI_LINK_FIELD && t->point[c].link != BVXI_LINK_FIELD_BACK))
            continue;
        if (t->point[c].link != (k == 0 ? BVXI_LINK_FIELD : BVXI_LINK_FIELD_BACK)) continue;
        uv_of_vertex(t, t->point[c].vertex, e);
        uv_of_vertex(t, t->point[d].vertex, f);
        other = bvxi_segment_square(e, f, p);
        /* Equally near: by the numbers of the ends, so that just one line takes it. */
        if (other < own || (other == own && t->point[c].vertex + t->point[d].vertex <
                                                t->point[from].vertex + t->point[to].vertex))
            return 0;
    }
    return 1;
}

bvx_status bvxi_trace_insert(bvxi_trace *t, int k, uint32_t from, uint32_t to, int back, uint32_t *count)
{
    const bvxi_level *const level = &t->level[k];
    bvxi_plane *const p = level->plane;
    uint32_t const face = k == 0 ? BVXI_FACE_BELOW : BVXI_FACE_ABOVE;
    uint32_t n = 0, first, arcs;
    double a[2], b[2];

    if (!level->inserts) return BVX_OK;
    /* In the direction of the contour, whichever way the loop runs. */
    uv_of_vertex(t, t->point[back ? to : from].vertex, a);
    uv_of_vertex(t, t->point[back ? from : to].vertex, b);
    first = bvxi_plane_arcs_in(p, t->key, &arcs);
    for (uint32_t arc = first; arc < first + arcs; arc++) {
        uint32_t i = p->arc[arc].point;
        BVXI_TRY(BVXI_RESERVE(t->s, t->insert, n + p->arc[arc].count, t->insert_room,
                              "the contour points of a cell"));
        for (uint32_t j = 0; j < p->arc[arc].count; j++, i = p->next[i]) {
            double const along = (p->uv[i][0] - a[0]) * (b[0] - a[0]) + (p->uv[i][1] - a[1]) * (b[1] - a[1]);
            uint32_t at = n;
            if (!is_nearest_line(t, k, from, to, a, b, p->uv[i])) continue;
            for (; at > 0 && t->insert[at - 1].along > along; at--) t->insert[at] = t->insert[at - 1];
            t->insert[at].along = along;
            t->insert[at].point = i;
            n++;
        }
    }
    for (uint32_t j = 0; j < n; j++) {
        /* A point becomes a vertex when it is first taken; both slabs at the plane share it. */
        uint32_t const i = t->insert[back ? n - 1 - j : j].point;
        if (p->ring[i] == BVXI_NONE) {
            BVXI_TRY(
                bvxi_section_add_vertex(t->s, t->s->given->points + 3 * (uint64_t)p->given[i], &p->ring[i]));
            t->s->report.unkept_points--;
        }
        BVXI_TRY(bvxi_trace_add_to_loop(t, count, p->ring[i], face));
    }
    return BVX_OK;
}
