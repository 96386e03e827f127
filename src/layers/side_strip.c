/* side_strip.c - how the surface runs over one strip of a cell's side: a rectangle between two corners and
 * two levels.
 *
 * Marching squares: two crossings are joined; with four the field at the point where the lines joining
 * opposite crossings meet says whether the inside is joined. All of it depends on the strip only, with its
 * corners in the order of their coordinates, so the cells on both sides of it decide alike.
 *
 * A strip that a contour crosses more than once although cells were subdivided as far as allowed:
 * neighbouring crossings are joined in pairs, over a vertex on the strip between them, until at most one is
 * left on either level. */
#include "layers/trace.h"

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
    double place[2], level = t->level[0].t + y * (t->level[1].t - t->level[0].t);

    place[axis] = from + x * (to - from);
    place[1 - axis] = bvxi_fixed_u(s, 1 - axis, a->at[1 - axis]);
    return bvxi_field_at(t->field, place[0], place[1], level) > 0.0;
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
    BVXI_TRY(bvxi_trace_add_point(t, *vertex, (uint32_t)BVXI_FACE_SIDE << side, &point));

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

bvx_status bvxi_trace_strip(bvxi_trace *t, const bvxi_strip *strip)
{
    const bvxi_trace_node *const left = strip->left, *const right = strip->right;
    uint32_t p[4] = {BVXI_NONE, BVXI_NONE, BVXI_NONE, BVXI_NONE}, found[4];
    /* the corner behind each */
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
