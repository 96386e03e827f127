/* nearest_cell_body.h - which leaves may hold the nearest point of some centre of a cell: eight boxes at a
 * time. Included by nearest_cell.c once for each level of core/simd.h, with the same bits in each. */

/* ---- Eight children against a cell ---- */

/* Bit k is set when child k may matter; distance2 becomes the squares of the distances from the origin. */
BVXI_SIMD_CODE static inline uint32_t BVXI_SIMD(near_children)(const bvxi_near_node *node,
                                                               const bvxi_near_cell *cell,
                                                               float distance2[BVXI_NEAR_WIDTH])
{
    floats8 const zero = eight_all(0.0f);
    floats8 worst = zero, gap = zero, middle = zero;

    for (int a = 0; a < 3; a++) {
        floats8 const origin = eight_all(cell->origin[a]);
        floats8 const f = eight_all(cell->first[a]), l = eight_all(cell->last[a]);
        floats8 const low = eight_sub(eight_load(node->low[a]), origin);
        floats8 const high = eight_sub(eight_load(node->high[a]), origin);
        floats8 const low_out = eight_sub(low, l), high_out = eight_sub(f, high);

        /* How far the box lies from the two ends, from what is between them, and from the origin. */
        floats8 const left = eight_max(eight_max(eight_sub(low, f), high_out), zero);
        floats8 const right = eight_max(eight_max(low_out, eight_sub(l, high)), zero);
        floats8 const out = eight_max(eight_max(low_out, high_out), zero);
        floats8 const from = eight_max(eight_max(low, eight_sub(zero, high)), zero);

        /* Convex along the axis, so the larger of both ends bounds all that is between. */
        worst = eight_add(worst,
                          eight_max(eight_sub(eight_all(cell->first_bound[a]), eight_mul(left, left)),
                                    eight_sub(eight_all(cell->last_bound[a]), eight_mul(right, right))));
        gap = eight_add(gap, eight_mul(out, out));
        middle = eight_add(middle, eight_mul(from, from));
    }

    eight_store(distance2, middle);
    return eight_bits(
        eight_and(eight_less_equal(zero, worst), eight_less_equal(gap, eight_all(cell->limit2))));
}

/* Shift a node's leaves. *far_corner becomes the largest of the listed: sums of
 * their boxes' largest coordinates. Returns the listed leaf whose point is
 * nearest to the middle of the cell, if it is nearer than what is known, or -1. */
BVXI_SIMD_CODE static inline int32_t BVXI_SIMD(shift_near_leaves)(const bvxi_near_node *node,
                                                                  const bvxi_near_cell *cell, uint32_t listed,
                                                                  bvxi_near_block *b, float *far_corner)
{
    floats8 const zero = eight_all(0.0f);
    eight_mask const is_listed = eight_lanes(listed);
    floats8 corner = zero, d = zero;

    for (int a = 0; a < 3; a++) {
        floats8 const origin = eight_all(cell->origin[a]);
        floats8 const middle = eight_all((cell->first[a] + cell->last[a]) * 0.5f);
        floats8 const low = eight_sub(eight_load(node->low[a]), origin);
        floats8 const high = eight_sub(eight_load(node->high[a]), origin);
        floats8 const point = eight_add(low, eight_load(node->point[a])), from = eight_sub(point, middle);

        eight_store(b->low[a], low);
        eight_store(b->high[a], high);
        eight_store(b->point[a], point);
        corner = eight_add(corner, eight_add(eight_max(eight_sub(zero, low), high), eight_sub(high, low)));
        d = eight_add(d, eight_mul(from, from));
    }

    float const farthest = -eight_least(eight_sub(zero, eight_keep(is_listed, corner)));
    *far_corner = farthest > *far_corner ? farthest : *far_corner;

    /* What is not listed is further than anything. */
    d = eight_choose(is_listed, d, eight_all(0x1p126f));
    float const least = eight_least(d);
    if (!(least < cell->point_distance2)) return -1;
    return bvxi_lowest(eight_bits(eight_equal(d, eight_all(least))));
}

/* ---- The search ---- */

BVXI_SIMD_CODE static void BVXI_SIMD(begin_near_search)(const bvxi_nearest *n, const bvxi_near_start *start,
                                                        bvxi_near_cell *cell)
{
    float distance2[BVXI_NEAR_WIDTH];

    cell->open = 0;
    if (start == NULL || start->count < 0) {
        cell->stack[0].distance2 = 0.0f;
        cell->stack[0].level = n->level_count - 1;
        cell->stack[0].node = 0;
        cell->open = 1;
        return;
    }

    for (int32_t i = 0; i < start->count; i += BVXI_NEAR_WIDTH) {
        uint32_t mask = BVXI_SIMD(near_children)(&start->box[i / BVXI_NEAR_WIDTH], cell, distance2);

        for (; mask != 0; mask &= mask - 1) {
            int32_t const k = bvxi_lowest(mask);
            cell->stack[cell->open].distance2 = distance2[k];
            cell->stack[cell->open].level = 0;
            cell->stack[cell->open++].node = start->node[i + k];
        }
    }
}

BVXI_SIMD_CODE static void BVXI_SIMD(start_near_cell)(const bvxi_nearest *n, bvxi_near_cell *cell,
                                                      bvxi_near_start *start)
{
    start->count = n->level_count == 1 ? -1 : 0;
    BVXI_SIMD(begin_near_search)(n, NULL, cell);

    while (cell->open > 0 && start->count >= 0) {
        bvxi_near_visit const visit = cell->stack[--cell->open];
        const bvxi_near_node *const node = &n->level[visit.level][visit.node];
        float distance2[BVXI_NEAR_WIDTH];
        uint32_t const mask = BVXI_SIMD(near_children)(node, cell, distance2);

        if (visit.level > 1) push_near_children(cell, visit.level - 1, node->first, mask, distance2);
        else if (start->count <= (BVXI_NEAR_STARTS - 1) * BVXI_NEAR_WIDTH)
            start_near_children(node, mask, start);
        else start->count = -1;
    }

    /* Eight boxes are looked at together: those that there are not lie so far off that none is near. */
    for (int32_t k = start->count; k > 0 && k % BVXI_NEAR_WIDTH != 0; k++)
        for (int a = 0; a < 3; a++)
            start->box[k / BVXI_NEAR_WIDTH].low[a][k % BVXI_NEAR_WIDTH] =
                start->box[k / BVXI_NEAR_WIDTH].high[a][k % BVXI_NEAR_WIDTH] = 0x1p62f;
}

BVXI_SIMD_CODE static int32_t BVXI_SIMD(list_near_cell)(const bvxi_nearest *n, bvxi_near_cell *cell,
                                                        bvxi_near_list *list)
{
    float far_corner = 0.0f;

    list->count = 0;
    while (cell->open > 0 && list->count < BVXI_NEAR_BLOCKS) {
        bvxi_near_visit const visit = cell->stack[--cell->open];
        const bvxi_near_node *const node = &n->level[visit.level][visit.node];
        bvxi_near_block *const block = &list->block[list->count];
        float distance2[BVXI_NEAR_WIDTH];
        uint32_t const mask = BVXI_SIMD(near_children)(node, cell, distance2);

        if (mask == 0) continue;
        if (visit.level > 0) {
            push_near_children(cell, visit.level - 1, node->first, mask, distance2);
            continue;
        }

        int32_t const nearest = BVXI_SIMD(shift_near_leaves)(node, cell, mask, block, &far_corner);
        block->first = node->first;
        block->listed = mask;
        list->count++;

        /* A nearer point of the mesh leaves less of what is still on the stack. */
        if (nearest < 0) continue;
        for (int a = 0; a < 3; a++) cell->point[a] = block->point[a][nearest];
        cell->point_error = near_error(far_corner, cell);
        bound_near_cell(cell);
    }
    list->error = near_error(far_corner, cell);
    return cell->open == 0;
}
