/* simple_quick.c - most sections hold simple loops whose points are some way apart: these are found good
 * without an allocation, side by side. Whatever is not surely good goes to the full check, which finds what
 * is wrong and says so.
 *
 * Segments are put into buckets of their least u and then in order by insertion; each is held against the
 * boxes of those that still reach so far, kept one after the other. */
#include "section/section.h"

enum { QUICK_BUCKETS = 256, QUICK_MOST_MOVES = 16 };

static int box_segments(const bvxi_plane *p, bvxi_segment_box *box)
{
    for (uint32_t i = 0; i < p->point_count; i++) {
        const int32_t *const a = p->q[i], *const b = p->q[p->next[i]];
        bvxi_segment_box *const x = &box[i];
        /* Points that snapped together are left to the full check. */
        if (a[0] == b[0] && a[1] == b[1]) return 0;
        x->left = a[0] < b[0] ? a[0] : b[0];
        x->right = a[0] < b[0] ? b[0] : a[0];
        x->low = a[1] < b[1] ? a[1] : b[1];
        x->high = a[1] < b[1] ? b[1] : a[1];
        x->segment = i;
    }
    return 1;
}

/* 0 when the order is so uneven that insertion would take long. */
static int sort_boxes(const bvxi_segment_box *box, uint32_t n, bvxi_segment_box *sorted)
{
    uint32_t start[QUICK_BUCKETS], sum = 0, shift = 0;
    int32_t low = box[0].left, high = low;
    uint64_t moves = (uint64_t)n * QUICK_MOST_MOVES;

    for (uint32_t i = 1; i < n; i++) {
        if (box[i].left < low) low = box[i].left;
        if (box[i].left > high) high = box[i].left;
    }
    /* The fewest bits to take off, so that all buckets are used. */
    while (((uint32_t)(high - low) >> shift) >= QUICK_BUCKETS) shift++;
    memset(start, 0, sizeof start);
    for (uint32_t i = 0; i < n; i++) start[(uint32_t)(box[i].left - low) >> shift]++;
    for (uint32_t i = 0; i < QUICK_BUCKETS; i++) {
        uint32_t const count = start[i];
        start[i] = sum;
        sum += count;
    }
    for (uint32_t i = 0; i < n; i++) sorted[start[(uint32_t)(box[i].left - low) >> shift]++] = box[i];

    /* Buckets are in order already; insertion orders each one, and counts what it costs. */
    for (uint32_t i = 1; i < n; i++) {
        bvxi_segment_box const x = sorted[i];
        uint32_t j = i;
        for (; j > 0 && sorted[j - 1].left > x.left; j--) sorted[j] = sorted[j - 1];
        sorted[j] = x;
        if (i - j > moves) return 0;
        moves -= i - j;
    }
    return 1;
}

static int quick_pair_meets(const bvxi_plane *p, uint32_t i, uint32_t j)
{
    uint32_t const in = p->next[i], jn = p->next[j];
    if (in == j) return jn == i || bvxi_folds_back(p->q[j], p->q[i], p->q[jn]);
    if (jn == i) return bvxi_folds_back(p->q[i], p->q[in], p->q[j]);
    return bvxi_segments_meet(p->q[i], p->q[in], p->q[j], p->q[jn]);
}

int bvxi_plane_is_simple(const bvxi_plane *p, bvxi_segment_box *sorted, bvxi_segment_box *active)
{
    uint32_t const n = p->point_count;
    uint32_t reach = 0;

    if (n == 0) return 1;
    if (!box_segments(p, active) || !sort_boxes(active, n, sorted)) return 0;
    for (uint32_t k = 0; k < n; k++) {
        bvxi_segment_box const x = sorted[k];
        for (uint32_t a = 0; a < reach;) {
            const bvxi_segment_box *const y = &active[a];
            /* It ended before this segment begins; the last one takes its place. */
            if (y->right < x.left) {
                active[a] = active[--reach];
                continue;
            }
            if (y->high >= x.low && y->low <= x.high && quick_pair_meets(p, x.segment, y->segment)) return 0;
            a++;
        }
        active[reach++] = x;
    }
    return 1;
}
