/* nearest_eight_body.h - which listed leaves, then which of their triangles, may be nearest to one of eight
 * centres. Included by nearest_eight.c once for each level of core/simd.h, with the same bits in each. */

/* ---- Leaves ---- */

/* Squares of how far a place lies outside of eight boxes, along one axis. */
BVXI_SIMD_CODE static inline floats8 BVXI_SIMD(near_outside)(floats8 low, floats8 high, float place)
{
    floats8 const x = eight_all(place);
    floats8 const out = eight_max(eight_max(eight_sub(low, x), eight_sub(x, high)), eight_all(0.0f));
    return eight_mul(out, out);
}

BVXI_SIMD_CODE static inline void BVXI_SIMD(sieve_near_block)(
    const bvxi_near_block *b, const bvxi_near_places *places, floats8 limit2,
    float square[3][BVXI_NEAR_SIDE][BVXI_NEAR_WIDTH], uint8_t reach[8])
{
    floats8 least[3][2];

    for (int a = 0; a < 3; a++) {
        floats8 const low = eight_load(b->low[a]), high = eight_load(b->high[a]);

        for (int i = 0; i < 2; i++) {
            floats8 const x2 = BVXI_SIMD(near_outside)(low, high, places->at[a][2 * i]);
            floats8 const y2 = BVXI_SIMD(near_outside)(low, high, places->at[a][2 * i + 1]);

            eight_store(square[a][2 * i], x2);
            eight_store(square[a][2 * i + 1], y2);
            least[a][i] = eight_min(x2, y2);
        }
    }

    for (int g = 0; g < 8; g++) {
        floats8 const near2 = eight_add(eight_add(least[0][g & 1], least[1][g >> 1 & 1]), least[2][g >> 2]);
        reach[g] = (uint8_t)(eight_bits(eight_less_equal(near2, limit2)) & b->listed);
    }
}

BVXI_SIMD_CODE static void BVXI_SIMD(sieve_near_list)(const bvxi_near_list *list,
                                                      const bvxi_near_places *places, float limit2,
                                                      bvxi_near_sieve *sieve)
{
    for (int32_t i = 0; i < list->count; i++) BVXI_SIMD(sieve_near_block)
    (&list->block[i], places, eight_all(limit2), sieve->square[i], sieve->reach[i]);
}

/* Boxes within drop2 of one of the two centres that share the squares of two axes. */
BVXI_SIMD_CODE static inline eight_mask BVXI_SIMD(near_either)(floats8 left, floats8 right, floats8 beside,
                                                               const float drop2[2])
{
    return eight_or(eight_less_equal(eight_add(left, beside), eight_all(drop2[0])),
                    eight_less_equal(eight_add(right, beside), eight_all(drop2[1])));
}

/* Bits of eight boxes that lie within drop2 of some centre, from the squares of
 * their distances along the axes: of the two places x, y and z. */
BVXI_SIMD_CODE static inline uint32_t BVXI_SIMD(near_boxes)(const floats8 x[2], const floats8 y[2],
                                                            const floats8 z[2], const float drop2[8])
{
    floats8 const a = eight_add(x[0], y[0]), b = eight_add(x[1], y[0]);
    floats8 const c = eight_add(x[0], y[1]), d = eight_add(x[1], y[1]);
    eight_mask const p = BVXI_SIMD(near_either)(a, b, z[0], drop2);
    eight_mask const q = BVXI_SIMD(near_either)(c, d, z[0], drop2 + 2);
    eight_mask const r = BVXI_SIMD(near_either)(a, b, z[1], drop2 + 4);
    eight_mask const s = BVXI_SIMD(near_either)(c, d, z[1], drop2 + 6);
    return eight_bits(eight_or(eight_or(p, q), eight_or(r, s)));
}

BVXI_SIMD_CODE static inline uint32_t BVXI_SIMD(near_leaves)(
    const float square[3][BVXI_NEAR_SIDE][BVXI_NEAR_WIDTH], const bvxi_near_eight *e)
{
    const float(*const sx)[BVXI_NEAR_WIDTH] = square[0] + (e->group & 1) * 2;
    const float(*const sy)[BVXI_NEAR_WIDTH] = square[1] + (e->group & 2);
    const float(*const sz)[BVXI_NEAR_WIDTH] = square[2] + (e->group >> 2) * 2;
    floats8 const x[2] = {eight_load(sx[0]), eight_load(sx[1])};
    floats8 const y[2] = {eight_load(sy[0]), eight_load(sy[1])};
    floats8 const z[2] = {eight_load(sz[0]), eight_load(sz[1])};
    return BVXI_SIMD(near_boxes)(x, y, z, e->drop2);
}

BVXI_SIMD_CODE static void BVXI_SIMD(take_near_list)(const bvxi_near_list *list, const bvxi_near_sieve *sieve,
                                                     bvxi_near_eight *e)
{
    floats8 const ax = eight_load(e->at[0]), ay = eight_load(e->at[1]), az = eight_load(e->at[2]);
    floats8 least2 = eight_load(e->least2);
    uint32_t count = 0;

    /* A point of each leaf that the group reaches is no further than the nearest. */
    for (int32_t i = 0; i < list->count; i++)
        count += BVXI_SIMD(near_append)(sieve->reach[i][e->group], (uint32_t)(i * BVXI_NEAR_WIDTH),
                                        e->leaf + count);
    for (uint32_t i = 0; i < count; i++) {
        const bvxi_near_block *const b = &list->block[e->leaf[i] / BVXI_NEAR_WIDTH];
        int const k = e->leaf[i] % BVXI_NEAR_WIDTH;
        floats8 const from[3] = {eight_sub(ax, eight_all(b->point[0][k])),
                                 eight_sub(ay, eight_all(b->point[1][k])),
                                 eight_sub(az, eight_all(b->point[2][k]))};

        least2 = eight_min(least2, eight_dot(from, from));
    }
    eight_store(e->least2, least2);
    slacken_near_eight(e);

    /* Only now are boxes compared, with what all points together leave. */
    count = 0;
    for (int32_t i = 0; i < list->count; i++)
        count += BVXI_SIMD(near_append)(sieve->reach[i][e->group] &
                                            BVXI_SIMD(near_leaves)(sieve->square[i], e),
                                        (uint32_t)(i * BVXI_NEAR_WIDTH), e->leaf + count);
    e->leaves = (int32_t)count;
}

/* ---- Triangles ---- */

BVXI_SIMD_CODE static inline uint32_t BVXI_SIMD(near_triangles)(const bvxi_near_leaf *leaf,
                                                                const bvxi_near_block *b, uint32_t slot,
                                                                const bvxi_near_eight *e)
{
    floats8 s[3][2];
    for (int a = 0; a < 3; a++) {
        floats8 const low = eight_load(leaf->low[a]), high = eight_load(leaf->high[a]);
        for (int i = 0; i < 2; i++)
            s[a][i] = BVXI_SIMD(near_outside)(low, high, e->ends[a][i] - b->low[a][slot]);
    }
    return BVXI_SIMD(near_boxes)(s[0], s[1], s[2], e->drop2);
}

/* Choose triangles, as many as there is room for. Returns the new count. */
BVXI_SIMD_CODE static inline int32_t BVXI_SIMD(choose_near_triangles)(const bvxi_nearest *n,
                                                                      const bvxi_near_list *list,
                                                                      bvxi_near_eight *e)
{
    int32_t count = e->count, next = e->next;

    for (; next < e->leaves && count <= BVXI_NEAR_MEASURED - BVXI_NEAR_WIDTH; next++) {
        const bvxi_near_block *const b = &list->block[e->leaf[next] / BVXI_NEAR_WIDTH];
        uint32_t const slot = e->leaf[next] % BVXI_NEAR_WIDTH, number = b->first + slot;
        uint32_t const later =
            e->leaf[next + NEAR_AHEAD_LEAVES < e->leaves ? next + NEAR_AHEAD_LEAVES : next];

        /* The boxes of a leaf are three lines of a cache, and leaves lie anywhere in memory. */
        const char *const soon =
            (const char *)&n->leaves[list->block[later / BVXI_NEAR_WIDTH].first + later % BVXI_NEAR_WIDTH];
        for (int i = 0; i < 3; i++) BVXI_PREFETCH(soon + 64 * i);

        count += (int32_t)BVXI_SIMD(near_append_wide)(
            BVXI_SIMD(near_triangles)(&n->leaves[number], b, slot, e), number * BVXI_NEAR_WIDTH,
            e->place + count);
    }
    e->next = next;
    return count;
}

/* bvxi_near_distance2 of eight places to one triangle. */
BVXI_SIMD_CODE static inline floats8 BVXI_SIMD(near_distances)(const float f[BVXI_NEAR_NUMBERS],
                                                               const float origin[3], floats8 ax, floats8 ay,
                                                               floats8 az)
{
    floats8 const zero = eight_all(0.0f);
    floats8 const at[3] = {eight_add(ax, eight_all(origin[0] - f[0])),
                           eight_add(ay, eight_all(origin[1] - f[1])),
                           eight_add(az, eight_all(origin[2] - f[2]))};
    floats8 const e1[3] = {eight_all(f[3]), eight_all(f[4]), eight_all(f[5])};
    floats8 const e2[3] = {eight_all(f[6]), eight_all(f[7]), eight_all(f[8])};
    floats8 const e3[3] = {eight_all(f[9]), eight_all(f[10]), eight_all(f[11])};

    /* In the triangle's frame; the left part is turned over to the right. */
    floats8 const u = eight_dot(at, e1), v = eight_dot(at, e2), w = eight_dot(at, e3);
    floats8 const h = eight_all(f[BVXI_NEAR_H]);
    floats8 const r = eight_choose(eight_less(u, zero), eight_all(f[BVXI_NEAR_P]), eight_all(f[BVXI_NEAR_Q]));
    floats8 const before = eight_sub(r, eight_size(u));

    /* The base, and the edge; a maximum gives its second operand for no number, as of 0 / 0. */
    floats8 const beyond = eight_min(before, zero);
    floats8 const base2 = eight_add(eight_mul(beyond, beyond), eight_mul(v, v));
    floats8 const t = eight_div(eight_add(eight_mul(before, r), eight_mul(v, h)),
                                eight_add(eight_mul(r, r), eight_mul(h, h)));
    floats8 const s = eight_min(eight_max(t, zero), eight_all(1.0f));
    floats8 const dx = eight_sub(before, eight_mul(s, r)), dy = eight_sub(v, eight_mul(s, h));
    floats8 const edge2 = eight_add(eight_mul(dx, dx), eight_mul(dy, dy));

    /* Above the triangle itself neither counts. */
    floats8 const side = eight_sub(eight_mul(before, h), eight_mul(v, r));
    eight_mask const above = eight_less(zero, eight_min(v, side));
    return eight_add(eight_drop(above, eight_min(base2, edge2)), eight_mul(w, w));
}

BVXI_SIMD_CODE static void BVXI_SIMD(look_near)(const bvxi_nearest *n, const bvxi_near_list *list,
                                                const float origin[3], bvxi_near_eight *e)
{
    floats8 const ax = eight_load(e->at[0]), ay = eight_load(e->at[1]), az = eight_load(e->at[2]);
    floats8 least2 = eight_load(e->least2);
    int32_t const count = BVXI_SIMD(choose_near_triangles)(n, list, e);
    const bvxi_near_leaf *const leaves = n->leaves;

    for (int32_t i = e->count; i < count; i++) {
        uint32_t const later = e->place[i + NEAR_AHEAD_OF < count ? i + NEAR_AHEAD_OF : i];
        BVXI_PREFETCH((const char *)near_frame(leaves, later));

        floats8 const d = BVXI_SIMD(near_distances)(near_frame(leaves, e->place[i])->f, origin, ax, ay, az);
        eight_store(e->distance2[i], d);
        least2 = eight_min(d, least2);
    }

    e->count = count;
    eight_store(e->least2, least2);
}

/* ---- The end ---- */

BVXI_SIMD_CODE static int32_t BVXI_SIMD(find_near_winners)(const bvxi_near_leaf *leaves, const float most2[8],
                                                           const bvxi_near_eight *e,
                                                           bvxi_near_winner *winners)
{
    floats8 const most = eight_load(most2);
    int32_t count = 0;

    for (int32_t i = 0; i < e->count; i++) {
        uint32_t mask = eight_bits(eight_less_equal(eight_load(e->distance2[i]), most));

        for (; mask != 0; mask &= mask - 1) {
            winners[count].triangle = near_frame(leaves, e->place[i])->triangle;
            winners[count++].centre = bvxi_lowest(mask);
        }
    }
    return count;
}
