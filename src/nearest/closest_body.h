/* closest_body.h - the search of closest.c for one point: boxes of a node and triangles that wait, several
 * at a time. Included by closest.c once for each level of core/simd.h.
 *
 * Floats decide only which boxes are looked at; distances are evaluated in doubles, so every level gives the
 * same bits. */

/* Squared distances in floats to the boxes in four nodes side by side, of
 * which the tree has children; returns the bits of those that are not above
 * limit. Elements of nodes that there are not are the last one's again. */
BVXI_SIMD_CODE static inline uint32_t BVXI_SIMD(distances_of_sixteen)(const bvxi_closest_node *node,
                                                                      int children, const float at[3],
                                                                      float limit, float d[CLOSEST_SIXTEEN])
{
    floats8 const zero = eight_all(0.0f), most = eight_all(limit);
    uint32_t bits = 0;

    for (int i = 0; i < 2; i++) {
        /* Two nodes fill a vector; a last one without a partner is looked at twice. */
        const bvxi_closest_node *const one = node + (2 * i < children ? 2 * i : children - 1);
        const bvxi_closest_node *const two = node + (2 * i + 1 < children ? 2 * i + 1 : children - 1);
        floats8 out[3], sum;

        for (int a = 0; a < 3; a++) {
            floats8 const x = eight_all(at[a]);
            floats8 const below = eight_sub(eight_load_two(one->low[a], two->low[a]), x);
            floats8 const above = eight_sub(x, eight_load_two(one->high[a], two->high[a]));
            out[a] = eight_max(eight_max(below, above), zero);
        }
        sum = eight_dot(out, out);
        eight_store(d + 8 * i, sum);
        bits |= eight_bits(eight_less_equal(sum, most)) << (8 * i);
    }
    return bits;
}

/* Corners of four triangles as vectors of each coordinate. */
BVXI_SIMD_CODE static inline void BVXI_SIMD(corners_of_four)(const closest_search *s, const uint32_t place[4],
                                                             doubles4 corner[9])
{
    const bvxi_closest_tree *const tree = s->tree;
    doubles4 const scale = four_all(tree->scale);

    if (tree->position_type == BVX_F32) {
        const float *const f = tree->corners;
        const float *const t[4] = {f + 9 * (size_t)place[0], f + 9 * (size_t)place[1],
                                   f + 9 * (size_t)place[2], f + 9 * (size_t)place[3]};
        doubles4 last[4];

        four_columns_f32(t[0], t[1], t[2], t[3], corner);

        /* Nine numbers a triangle are read as three overlapping columns of four. */
        four_columns_f32(t[0] + 4, t[1] + 4, t[2] + 4, t[3] + 4, corner + 4);
        four_columns_f32(t[0] + 5, t[1] + 5, t[2] + 5, t[3] + 5, last);
        corner[8] = last[3];
    } else {
        const double *const f = tree->corners;
        const double *const t[4] = {f + 9 * (size_t)place[0], f + 9 * (size_t)place[1],
                                    f + 9 * (size_t)place[2], f + 9 * (size_t)place[3]};
        doubles4 last[4];

        four_columns_f64(t[0], t[1], t[2], t[3], corner);
        four_columns_f64(t[0] + 4, t[1] + 4, t[2] + 4, t[3] + 4, corner + 4);
        four_columns_f64(t[0] + 5, t[1] + 5, t[2] + 5, t[3] + 5, last);
        corner[8] = last[3];
    }
    for (int v = 0; v < 9; v++) corner[v] = four_mul(corner[v], scale);
}

/* Look at the triangles that wait; where there are less than four, at some of them twice. */
BVXI_SIMD_CODE static inline void BVXI_SIMD(look_at_waiting)(closest_search *s)
{
    doubles4 corner[9], q[3], d;
    doubles4 const p[3] = {four_all(s->point[0]), four_all(s->point[1]), four_all(s->point[2])};
    double distance2[4];

    /* The same triangle again changes no least, so the vector needs no mask. */
    for (int32_t i = s->waiting; i < 4; i++) s->wait[i] = s->wait[0];
    s->waiting = 0;
    BVXI_SIMD(corners_of_four)(s, s->wait, corner);
    uint32_t const done = BVXI_SIMD(bvxi_closest_on_four)(p, corner, corner + 3, corner + 6, q, &d);
    uint32_t nearer = four_bits(four_less_equal(d, four_all(s->best->distance2))) | (15u ^ done);

    /* Equal distances go through too: then the lesser index decides. */
    four_store(distance2, d);
    for (; nearer != 0; nearer &= nearer - 1) {
        int32_t const i = bvxi_lowest(nearer);
        if (done >> i & 1) take_closest(s, s->wait[i], distance2[i]);
        else try_closest_triangle(s, s->wait[i]);
    }
}

BVXI_SIMD_CODE static inline void BVXI_SIMD(take_triangles)(closest_search *s, uint32_t bits, uint32_t first)
{
    for (; bits != 0; bits &= bits - 1) {
        uint32_t const place = first + (uint32_t)bvxi_lowest(bits);
        s->wait[s->waiting++] = place;
        if (s->waiting == 4) BVXI_SIMD(look_at_waiting)(s);
    }
}

/* Look at the boxes two levels below a node; one level below the root where that makes their number come out
 * even. Returns how many boxes are on the stack afterwards. */
BVXI_SIMD_CODE static inline int BVXI_SIMD(visit_closest)(closest_search *s, const closest_visit *v,
                                                          closest_visit *stack, int used)
{
    const bvxi_closest_tree *const tree = s->tree;
    int const steps = v->level % 2 == 1 ? 2 : 1;
    int32_t const level = v->level - steps; /* of the boxes: -1 for triangles */
    uint64_t const first = (uint64_t)v->node << 2 * steps;
    uint64_t const total = level < 0 ? tree->triangle_count : tree->level_nodes[level];
    uint64_t const rest = total - first, width = UINT64_C(1) << 2 * steps;
    int const count = (int)(rest < width ? rest : width);
    int const children = (count + BVXI_CLOSEST_WIDTH - 1) / BVXI_CLOSEST_WIDTH;
    const bvxi_closest_node *const node =
        &tree->nodes[tree->level_first[level + 1] + first / BVXI_CLOSEST_WIDTH];
    int const bottom = used <= CLOSEST_SORTED ? 0 : used;
    float near[CLOSEST_SIXTEEN];
    double far[CLOSEST_SIXTEEN];
    uint32_t bits;

    if (s->is_near) {
        float const limit = (float)(s->limit * (1.0 + 0x1p-22)); /* not below, whatever the rounding */
        bits = BVXI_SIMD(distances_of_sixteen)(node, children, s->at_f, limit, near);
    } else {
        bits = far_distances_of_sixteen(node, children, s->at, s->limit, far);
    }
    bits &= (UINT32_C(2) << (count - 1)) - 1;

    if (level < 0) {
        BVXI_SIMD(take_triangles)(s, bits, (uint32_t)first);
        return used;
    }

    /* The nearest on top; of all that wait, or where they are many, of these. */
    for (; bits != 0; bits &= bits - 1) {
        int32_t const k = bvxi_lowest(bits);
        double const d = s->is_near ? (double)near[k] : far[k];
        int i = used++;

        for (; i > bottom && stack[i - 1].distance2 < d; i--) stack[i] = stack[i - 1];
        stack[i].distance2 = d;
        stack[i].level = level;
        stack[i].node = (uint32_t)first + (uint32_t)k;
    }
    return used;
}

BVXI_SIMD_CODE static void BVXI_SIMD(search_closest)(closest_search *s)
{
    closest_visit stack[CLOSEST_STACK];
    int used = 1;

    stack[0].distance2 = 0.0;
    stack[0].level = s->tree->level_count - 1;
    stack[0].node = 0;
    while (used > 0) {
        closest_visit const v = stack[--used];

        if (v.distance2 <= s->limit) used = BVXI_SIMD(visit_closest)(s, &v, stack, used);
    }
    if (s->waiting > 0) BVXI_SIMD(look_at_waiting)(s);
}
