/* trace.c - the surface in one cell: its loops over the cell's faces, each filled with triangles.
 *
 * Round the cell's sides, counter-clockwise, stand its corners and those of finer cells; between two of them
 * is a strip. Crossings of both levels' edges and of the corners' heights are points; each strip links its
 * points, and each level links crossings along its contours. Loops run with the inside on their right, seen
 * from outside of the cell: along contours below, against those above. Every point gets one successor, so
 * loops close, and what the neighbours see of a face is the same with the other direction. */
#include "layers/trace.h"

#include "lattice/wide.h"

enum { TRACE_FEW = 64 };

/* ---- arrays, which grow on the calling thread, never in a view of the stack that other threads have ---- */

static bvx_status add_trace_point(bvxi_trace *t, uint32_t vertex, uint32_t faces, uint32_t *point)
{
    BVXI_TRY(BVXI_SLAB_GROW(t->s, t->point, t->point_count, t->point_room, "the crossings of a cell"));
    *point = t->point_count++;
    t->point[*point] = (bvxi_trace_point){.vertex = vertex,
                                          .next = BVXI_NONE,
                                          .arc = BVXI_NONE,
                                          .faces = (uint8_t)faces,
                                          .link = BVXI_LINK_STRAIGHT};
    return BVX_OK;
}

static bvx_status open_rows(bvxi_trace *t, uint64_t ends, uint64_t nodes)
{
    for (int k = 0; k < 2; k++) {
        BVXI_TRY(bvxi_trace_reserve(t, &t->row[k], ends + 1, &t->row_room[k], sizeof *t->row[k]));
        BVXI_TRY(bvxi_trace_reserve(t, &t->cross[k], nodes + 1, &t->cross_room[k], sizeof *t->cross[k]));
    }
    return BVX_OK;
}

bvx_status bvxi_trace_open(bvxi_trace *t, uint32_t loop)
{
    bvxi_stack *const s = t->s;
    BVXI_TRY(BVXI_SLAB_GROW(s, t->node, 0, t->node_room, "the corners of a cell"));
    BVXI_TRY(BVXI_SLAB_GROW(s, t->point, 0, t->point_room, "the crossings of a cell"));
    BVXI_TRY(BVXI_SLAB_GROW(s, t->end, 0, t->end_room, "the crossings of a cell"));
    BVXI_TRY(open_rows(t, TRACE_FEW, TRACE_FEW));
    BVXI_TRY(bvxi_map_reserve(s->ctx, &t->folds, 32));
    return bvxi_trace_open_loop(t, loop);
}

/* ---- corners ---- */

/* The corner of finer cells at a place or, in the order of rows or of columns, first beyond it. */
static uint32_t hanging_from(const bvxi_field *f, int by_column, const int32_t place[2])
{
    int const across = by_column ? 0 : 1, along = 1 - across;
    const uint32_t *const start = (by_column ? f->hanging_column : f->hanging_row) +
                                  (place[across] >> f->s->fine);
    uint32_t low = start[0], high = start[1];
    while (low < high) {
        uint32_t const middle = low + (high - low) / 2;
        const int32_t *const at = f->slab->hanging[by_column ? f->slab->by_u[middle] : middle].at;
        if (at[across] < place[across] || (at[across] == place[across] && at[along] < place[along]))
            low = middle + 1;
        else high = middle;
    }
    return low;
}

/* Corners of finer cells between two corners of this one, counter-clockwise. */
static bvx_status add_hanging_nodes(bvxi_trace *t, int side)
{
    const bvxi_slab *const slab = t->field->slab;
    int const along = side & 1, across = 1 - along; /* sides 0 and 2 run along u */
    int32_t const line = t->low[across] + (side == 1 || side == 2 ? t->size : 0);
    int32_t const to = t->low[along] + t->size;
    int32_t const after[2] = {along == 0 ? t->low[0] + 1 : line, along == 0 ? line : t->low[1] + 1};
    uint32_t low, n;

    if (slab->hanging_count == 0) return BVX_OK;
    low = hanging_from(t->field, along, after);
    for (n = 0; low + n < slab->hanging_count; n++) {
        const int32_t *const at = slab->hanging[along == 0 ? low + n : slab->by_u[low + n]].at;
        if (at[across] != line || at[along] >= to) break;
    }
    for (uint32_t i = 0; i < n; i++) {
        /* Sides 2 and 3 run towards lower coordinates. */
        uint32_t const number = side >= 2 ? low + n - 1 - i : low + i;
        const bvxi_hanging *const h = &slab->hanging[along == 0 ? number : slab->by_u[number]];
        BVXI_TRY(BVXI_SLAB_GROW(t->s, t->node, t->node_count, t->node_room, "the corners of a cell"));
        bvxi_trace_node *const node = &t->node[t->node_count++];
        memcpy(node->at, h->at, sizeof node->at);
        node->faces = (uint8_t)(BVXI_FACE_SIDE << side);
        memcpy(node->inside, h->inside, sizeof node->inside);
        node->vertex = h->inside[0] != h->inside[1] ? h->vertex : BVXI_NONE;
    }
    return BVX_OK;
}

static bvx_status add_corner(bvxi_trace *t, int i)
{
    static const uint8_t faces[4] = {
        BVXI_FACE_SIDE | BVXI_FACE_SIDE << 3, BVXI_FACE_SIDE | BVXI_FACE_SIDE << 1,
        BVXI_FACE_SIDE << 1 | BVXI_FACE_SIDE << 2, BVXI_FACE_SIDE << 2 | BVXI_FACE_SIDE << 3};
    const bvxi_slab *const slab = t->field->slab;
    int32_t const fine = t->s->fine, part = (1 << fine) - 1;

    BVXI_TRY(BVXI_SLAB_GROW(t->s, t->node, t->node_count, t->node_room, "the corners of a cell"));
    bvxi_trace_node *const n = &t->node[t->node_count++];
    n->at[0] = t->low[0] + (i == 1 || i == 2 ? t->size : 0);
    n->at[1] = t->low[1] + (i >= 2 ? t->size : 0);
    n->faces = faces[i];
    if ((n->at[0] & part) == 0 && (n->at[1] & part) == 0) {
        int32_t const x = n->at[0] >> fine, y = n->at[1] >> fine;
        for (int k = 0; k < 2; k++) n->inside[k] = (uint8_t)bvxi_grid_bit(t->s, slab->plane[k], x, y);
        n->vertex = n->inside[0] != n->inside[1] ? t->field->first + bvxi_line_number(t->field, x, y)
                                                 : BVXI_NONE;
    } else {
        const bvxi_hanging *const h = &slab->hanging[hanging_from(t->field, 0, n->at)];
        memcpy(n->inside, h->inside, sizeof n->inside);
        n->vertex = h->inside[0] != h->inside[1] ? h->vertex : BVXI_NONE;
    }
    return BVX_OK;
}

/* ---- one strip of a side ---- */

/* Marching squares; with four crossings the field where the lines joining opposite ones meet decides. All of it
 * depends on the strip only, corners in the order of their coordinates, so the cells beside it decide alike. More
 * crossings of a level are joined in pairs over a vertex on the strip, until at most one is left. */

static void link_points(bvxi_trace *t, uint32_t from, uint32_t to)
{
    t->point[from].next = to;
    t->point[from].link = BVXI_LINK_STRAIGHT;
}

static const double *vertex_place(const bvxi_trace *t, uint32_t point)
{
    return bvxi_section_vertex(t->s, t->point[point].vertex);
}

static double share_of(double low, double high, double x)
{
    double const t = (x - low) / (high - low);
    return t < 0.0 ? 0.0 : t > 1.0 ? 1.0 : t;
}

/* 1 when the inside is joined. Points: below, right, above, left. */
static int strip_joins(bvxi_trace *t, const bvxi_trace_node *left, const bvxi_trace_node *right,
                       const uint32_t p[4])
{
    bvxi_stack *const s = t->s;
    int const axis = left->at[0] == right->at[0];
    int const turned = left->at[axis] > right->at[axis];
    const bvxi_trace_node *const a = turned ? right : left, *const b = turned ? left : right;
    double const from = bvxi_fixed_u(s, axis, a->at[axis]), to = bvxi_fixed_u(s, axis, b->at[axis]);
    double const below = share_of(from, to, bvxi_along_axis(s->axis[axis], vertex_place(t, p[0])));
    double const above = share_of(from, to, bvxi_along_axis(s->axis[axis], vertex_place(t, p[2])));
    double const low = share_of(t->low_w, t->high_w,
                                bvxi_along_axis(s->axis[2], vertex_place(t, p[turned ? 1 : 3])));
    double const high = share_of(t->low_w, t->high_w,
                                 bvxi_along_axis(s->axis[2], vertex_place(t, p[turned ? 3 : 1])));
    /* not 0 but where both lines run from corner to corner */
    double const d = 1.0 - (above - below) * (high - low);
    double const y = d > 0.0 ? (low + below * (high - low)) / d : 0.5, x = below + (above - below) * y;
    double place[2];

    place[axis] = from + x * (to - from);
    place[1 - axis] = bvxi_fixed_u(s, 1 - axis, a->at[1 - axis]);
    return bvxi_field_at(t->field, place[0], place[1], y) > 0.0;
}

/* Two crossings of one level, in the order of the strip; the corner before them is inside or not. */
static bvx_status join_pair(bvxi_trace *t, int k, uint32_t first, uint32_t second, int inside_before,
                            int side)
{
    bvxi_stack *const s = t->s;
    const double *const a = vertex_place(t, first), *const b = vertex_place(t, second);
    double const height = t->high_w - t->low_w;
    double const w = t->level[k].w + (k == 0 ? 0.125 : -0.125) * height;
    uint32_t const va = t->point[first].vertex, vb = t->point[second].vertex;
    double place[3], raise;
    uint32_t *vertex, point, number;

    for (int i = 0; i < 3; i++) place[i] = va < vb ? 0.5 * (a[i] + b[i]) : 0.5 * (b[i] + a[i]);
    raise = w - bvxi_along_axis(s->axis[2], place);
    for (int i = 0; i < 3; i++) place[i] += raise * s->axis[2][i];
    BVXI_TRY(bvxi_stack_map_add(s, &t->folds, (uint64_t)(va < vb ? va : vb) << 1 | (uint64_t)k, &vertex));
    if (*vertex == BVXI_NONE) {
        BVXI_TRY(bvxi_section_add_vertex(s, place, &number));
        *vertex = number;
    }
    BVXI_TRY(add_trace_point(t, *vertex, (uint32_t)BVXI_FACE_SIDE << side, &point));

    /* counter-clockwise around the strip from P to Q inside: P to Q. The strip's order is that below. */
    if ((k == 0) == !inside_before) {
        link_points(t, first, point);
        link_points(t, point, second);
    } else {
        link_points(t, second, point);
        link_points(t, point, first);
    }
    return BVX_OK;
}

static bvx_status trace_strip(bvxi_trace *t, const bvxi_strip *strip)
{
    const bvxi_trace_node *const left = strip->left, *const right = strip->right;
    uint32_t p[4] = {BVXI_NONE, BVXI_NONE, BVXI_NONE, BVXI_NONE}, found[4];
    uint8_t const after[4] = {right->inside[0], right->inside[1], left->inside[1], left->inside[0]};
    uint32_t n = 0;
    uint8_t first_inside = 0;

    /* pairs are taken from the end with lower coordinates, from whichever cell it is seen */
    int const turned = left->at[0] > right->at[0] || left->at[1] > right->at[1];

    for (int k = 0; k < 2; k++) {
        const uint32_t *const row = strip->row[k];
        uint32_t const count = strip->count[k];
        uint32_t const skip = turned ? count & 1 : 0;
        for (uint32_t i = skip; i + 1 < count; i += 2)
            BVXI_TRY(join_pair(t, k, row[i], row[i + 1], left->inside[k] ^ (int)(i & 1), strip->side));
        if ((count & 1) != 0) p[k == 0 ? 0 : 2] = row[turned ? 0 : count - 1];
    }
    p[1] = strip->right_point;
    p[3] = strip->left_point;
    for (uint32_t i = 0; i < 4; i++)
        if (p[i] != BVXI_NONE) {
            if (n == 0) first_inside = after[i];
            found[n++] = p[i];
        }
    if (n == 2) {
        if (first_inside) link_points(t, found[0], found[1]);
        else link_points(t, found[1], found[0]);
    } else if (n == 4) {
        /* the corners behind crossings 0 and 2 are alike; cut off those, or the two others */
        int const joins = strip_joins(t, left, right, p);
        if (joins == !after[0]) { /* behind 0 and 2 is cut off */
            for (uint32_t i = 0; i < 4; i += 2) {
                if (after[0]) link_points(t, p[i], p[i + 1]);
                else link_points(t, p[i + 1], p[i]);
            }
        } else {
            for (uint32_t i = 1; i < 4; i += 2) {
                if (after[1]) link_points(t, p[i], p[(i + 1) & 3]);
                else link_points(t, p[(i + 1) & 3], p[i]);
            }
        }
    }
    return BVX_OK;
}

/* ---- the loops of a cell ---- */

static bvx_status gather_ends(bvxi_trace *t)
{
    t->end_count = 0;
    for (int k = 0; k < 2; k++) {
        const bvxi_plane *const p = t->level[k].plane;
        if (t->level[k].kind != BVXI_PLANE_EXACT) continue;
        for (uint32_t i = 0; i < t->arc_count[k]; i++) {
            const bvxi_arc *const a = &t->arc[k][i];
            if (a->from == BVXI_NONE) continue;
            for (int to = 0; to < 2; to++) {
                const bvxi_line_cut *const c = &p->cut[to ? a->to : a->from];
                BVXI_TRY(BVXI_SLAB_GROW(t->s, t->end, t->end_count, t->end_room, "the crossings of a cell"));
                bvxi_trace_end *const e = &t->end[t->end_count++];
                e->arc = i;
                e->cut = to ? a->to : a->from;
                e->k = (uint8_t)k;
                e->side = (uint8_t)bvxi_side_of(c, t->low);
                BVXI_TRY(add_trace_point(t, p->vertex + c->ring,
                                         (k == 0 ? BVXI_FACE_BELOW : BVXI_FACE_ABOVE) |
                                             (uint32_t)BVXI_FACE_SIDE << e->side,
                                         &e->point));
            }
        }
    }
    return BVX_OK;
}

/* 1 when crossing c comes before d on one line, towards higher coordinates; exact. */
static int cut_before(const bvxi_plane *p, const bvxi_line_cut *c, const bvxi_line_cut *d)
{
    int const k = c->axis, o = 1 - k;
    const int32_t *const ca = p->q[c->segment], *const cb = p->q[p->next[c->segment]];
    const int32_t *const da = p->q[d->segment], *const db = p->q[p->next[d->segment]];
    int64_t const origin = ca[o];
    int64_t cn = ((int64_t)c->line - ca[k]) * ((int64_t)cb[o] - ca[o]), cd = (int64_t)cb[k] - ca[k];
    int64_t dn = ((int64_t)da[o] - origin) * ((int64_t)db[k] - da[k]) +
                 ((int64_t)d->line - da[k]) * ((int64_t)db[o] - da[o]);
    int64_t dd = (int64_t)db[k] - da[k];

    /* Denominators above 0, so that the products compare as the quotients do. */
    if (cd < 0) {
        cd = -cd;
        cn = -cn;
    }
    if (dd < 0) {
        dd = -dd;
        dn = -dn;
    }
    /* Products of three differences, which 64 bits do not hold. */
    return bvxi_wide_sign(bvxi_wide_add(bvxi_wide_mul(cn, dd), bvxi_wide_mul(-dn, cd))) < 0;
}

/* The ends on one side, of one level, counter-clockwise. */
static uint32_t sort_side(const bvxi_trace *t, int side, int k)
{
    const bvxi_plane *const p = t->level[k].plane;
    uint32_t *const row = t->row[k];
    uint32_t n = 0;

    for (uint32_t i = 0; i < t->end_count; i++) {
        uint32_t j;
        if (t->end[i].side != side || t->end[i].k != k) continue;
        for (j = n++; j > 0; j--) {
            int const before = cut_before(p, &p->cut[t->end[i].cut], &p->cut[t->end[row[j - 1]].cut]);
            /* Sides 2 and 3 run towards lower coordinates. */
            if (before == (side >= 2)) break;
            row[j] = row[j - 1];
        }
        row[j] = i;
    }
    return n;
}

/* A side of the cell on the way along its strips: ends in the rows below and above, those that are done. */
typedef struct side_walk {
    int side;
    uint32_t count[2], done[2];
} side_walk;

static bvx_status link_strip(bvxi_trace *t, side_walk *w, uint32_t a, uint32_t b, const uint32_t points[],
                             int last)
{
    bvxi_trace_node *const left = &t->node[a], *const right = &t->node[b];
    bvxi_strip strip = {
        .left = left, .right = right, .left_point = points[a], .right_point = points[b], .side = w->side};
    uint32_t crossing[2];

    for (int k = 0; k < 2; k++) {
        uint32_t *const row = t->row[k] + w->done[k];

        strip.row[k] = row;
        if (t->level[k].kind == BVXI_PLANE_EXACT) {
            const bvxi_plane *const p = t->level[k].plane;
            int32_t const m = right->at[w->side & 1]; /* sides 0 and 2 run along u */
            uint32_t n = 0;
            while (w->done[k] + n < w->count[k] &&
                   (last || bvxi_cut_beyond(p, &p->cut[t->end[row[n]].cut], m) == (w->side >= 2)))
                n++;
            for (uint32_t i = 0; i < n; i++) row[i] = t->end[row[i]].point;
            strip.count[k] = n;
            w->done[k] += n;
        } else if (t->level[k].kind == BVXI_PLANE_FIELD && left->inside[k] != right->inside[k]) {
            uint32_t vertex;
            BVXI_TRY(bvxi_trace_edge(t, k, left, right, &vertex));
            BVXI_TRY(add_trace_point(
                t, vertex, (k == 0 ? BVXI_FACE_BELOW : BVXI_FACE_ABOVE) | (uint32_t)BVXI_FACE_SIDE << w->side,
                &crossing[k]));
            t->cross[k][t->cross_count[k]++] = crossing[k];
            strip.row[k] = &crossing[k];
            strip.count[k] = 1;
        }
    }
    return trace_strip(t, &strip);
}

/* node: counter-clockwise, corner[i] the place of the i-th corner in it. */
static bvx_status link_sides(bvxi_trace *t, const uint32_t corner[5], uint32_t *points)
{
    for (uint32_t i = 0; i < t->node_count; i++) {
        const bvxi_trace_node *const n = &t->node[i];
        points[i] = BVXI_NONE;
        if (n->vertex != BVXI_NONE) BVXI_TRY(add_trace_point(t, n->vertex, n->faces, &points[i]));
    }
    t->cross_count[0] = t->cross_count[1] = 0;

    for (int side = 0; side < 4; side++) {
        side_walk walk = {.side = side};
        for (int k = 0; k < 2; k++)
            if (t->level[k].kind == BVXI_PLANE_EXACT) walk.count[k] = sort_side(t, side, k);
        for (uint32_t i = corner[side]; i < corner[side + 1]; i++)
            BVXI_TRY(link_strip(t, &walk, i, i + 1 == t->node_count ? 0 : i + 1, points,
                                i + 1 == corner[side + 1]));
    }
    return BVX_OK;
}

bvx_status bvxi_trace_slab_cell(bvxi_trace *t)
{
    uint32_t corner[5];
    t->point_count = 0;

    /* Its nodes, counter-clockwise; corner: positions of its own four among them, and the count. */
    t->node_count = 0;
    for (int i = 0; i < 4; i++) {
        corner[i] = t->node_count;
        BVXI_TRY(add_corner(t, i));
        if (t->beside_split) BVXI_TRY(add_hanging_nodes(t, i));
    }
    corner[4] = t->node_count;

    BVXI_TRY(gather_ends(t));
    BVXI_TRY(open_rows(t, t->end_count, t->node_count));
    BVXI_TRY(bvxi_trace_open_loop(t, (uint64_t)t->node_count + 16));
    /* the loop's scratch holds the nodes' points until loops are followed */
    BVXI_TRY(link_sides(t, corner, t->next));

    /* Each end's point goes on along its arc: contours below run forwards, above backwards. */
    for (uint32_t i = 0; i + 1 < t->end_count; i += 2) { /* from, to */
        const bvxi_trace_end *const from = &t->end[i], *const to = &t->end[i + 1];
        const bvxi_trace_end *const a = from->k == 0 ? from : to, *const b = from->k == 0 ? to : from;
        bvxi_trace_point *const p = &t->point[a->point];
        p->next = b->point;
        p->arc = from->arc;
        p->link = from->k == 0 ? BVXI_LINK_ARC : BVXI_LINK_ARC_BACK;
    }

    for (int k = 0; k < 2; k++)
        if (t->level[k].kind == BVXI_PLANE_FIELD) bvxi_trace_face(t, k);
    return bvxi_trace_loops(t);
}
