/* ray_boxes_body.h - which of a node's boxes a ray meets, a box a lane. Included by mesh_rays.c once for each level of
 * core/simd.h. */

/* Bits of the boxes on the ray; enter: where each begins. */
BVXI_SIMD_CODE static uint32_t BVXI_SIMD(meet_boxes)(const ray_visit *w, const bvxi_closest_node *node,
                                                     double enter[BVXI_CLOSEST_WIDTH])
{
    const mesh_ray *const r = &w->line;
    doubles4 from = four_all(0.0), to = four_all(w->limit);

    for (int a = 0; a < 3; a++) {
        doubles4 const over = four_all(r->over[a]), at = four_all(r->at[a]), margin = four_all(r->margin);
        double wide[2][BVXI_CLOSEST_WIDTH];

        for (int k = 0; k < BVXI_CLOSEST_WIDTH; k++) wide[0][k] = (double)node->low[a][k];
        for (int k = 0; k < BVXI_CLOSEST_WIDTH; k++) wide[1][k] = (double)node->high[a][k];
        doubles4 const low = four_sub(four_sub(four_load(wide[0]), margin), at);
        doubles4 const high = four_sub(four_add(four_load(wide[1]), margin), at);

        /* Without a way along the axis: all of it, or none. */
        if (r->over[a] == 0.0) {
            doubles4 const zero = four_all(0.0);
            to = four_choose(four_and(four_less_equal(low, zero), four_less_equal(zero, high)), to,
                             four_all(-1.0));
            continue;
        }
        doubles4 const first = four_mul(r->over[a] < 0.0 ? high : low, over);
        doubles4 const last = four_mul(r->over[a] < 0.0 ? low : high, over);
        from = four_max(first, from);
        to = four_choose(four_less(last, to), last, to);
    }
    four_store(enter, from);
    return four_bits(four_less_equal(from, four_add(to, four_mul(four_size(to), four_all(0x1p-40)))));
}
