/* components.c - connected components of runs by union-find.
 *
 * Source: Rosenfeld, Pfaltz. Sequential Operations in Digital Picture Processing. 1966, on runs; union by the least number,
 * paths halved on the way (Tarjan, van Leeuwen. Worst-case Analysis of Set Union Algorithms. 1984).
 *
 * Runs come in the order of their voxels, so a component's first run holds its least voxel: the root of each tree is its
 * least run, and numbering the roots as they come is the canonical numbering. A run looks back at the rows that can hold
 * neighbours: the one below in y and the three below in z. In each of them a cursor goes forward as the runs do, so all
 * looking back costs no more than the runs and the pairs that touch. Only the runs that cursors can still reach are kept. */
#include "grid/components.h"

/* Rows behind, and for each connectivity how far a neighbour there may lie beside a run along x; -1: not at all. */
static const struct component_rows {
    int32_t dy, dz, reach6, reach18, reach26;
} component_rows[4] = {{-1, 0, 0, 1, 1}, {0, -1, 0, 1, 1}, {-1, -1, -1, 0, 1}, {1, -1, -1, 0, 1}};

static void plan_component_rows(int32_t connectivity, bvxi_components *c)
{
    for (int32_t i = 0; i < 4; i++) {
        const struct component_rows *const r = &component_rows[i];
        int32_t const reach = connectivity == BVXI_CONNECT_6    ? r->reach6
                              : connectivity == BVXI_CONNECT_18 ? r->reach18
                                                                : r->reach26;
        if (reach < 0) continue;
        bvxi_component_reach *const to = &c->reach[c->reach_count++];
        to->dy = r->dy;
        to->dz = r->dz;
        to->reach = reach;
        to->cursor = 0;
    }
}

/* The most runs that can lie between a run and the first row that it looks back to: a slice and two rows. */
static uint64_t component_ring_bound(const int32_t size[3], uint64_t run_count)
{
    uint64_t const bound = ((uint64_t)size[1] + 2) * (((uint64_t)size[0] + 1) / 2); /* below 2^50 */
    uint64_t const least = bound < run_count ? bound : run_count;
    return least < 1 ? 1 : least;
}

bvx_status bvxi_components_open(bvx_context *ctx, const char *function, int32_t connectivity, const int32_t size[3],
                                uint64_t run_count, bvxi_components *c)
{
    bvx_status status;
    memset(c, 0, sizeof *c);
    c->ctx = ctx;
    if (run_count >= UINT32_MAX)
        return bvxi_fail(ctx, BVX_ERR_RANGE, "%s: the voxels lie in %u runs along x; fewer than 2^32 - 1 are possible", function, run_count);
    c->run_count = run_count;
    c->ny = size[1];
    c->ring_size = (uint32_t)component_ring_bound(size, run_count);
    plan_component_rows(connectivity, c);
    status = bvxi_alloc(ctx, BVXI_SCRATCH, run_count * sizeof *c->label, "the components' labels", &c->label);
    if (status == BVX_OK)
        status = bvxi_alloc(ctx, BVXI_SCRATCH, (uint64_t)c->ring_size * sizeof *c->ring, "the components' runs", &c->ring);
    if (status != BVX_OK) bvxi_components_free(c);
    return status;
}

static void free_component_ring(bvxi_components *c)
{
    bvxi_free(c->ctx, c->ring, (uint64_t)c->ring_size * sizeof *c->ring);
    c->ring = NULL;
}

void bvxi_components_free(bvxi_components *c)
{
    if (c->ctx == NULL) return;
    free_component_ring(c);
    bvxi_free(c->ctx, c->label, c->run_count * sizeof *c->label);
    memset(c, 0, sizeof *c);
}

static uint32_t component_root(uint32_t *parent, uint32_t i)
{
    while (parent[i] != i) {
        parent[i] = parent[parent[i]];
        i = parent[i];
    }
    return i;
}

static void unite_components(uint32_t *parent, uint32_t i, uint32_t j)
{
    uint32_t const a = component_root(parent, i), b = component_root(parent, j);
    if (a < b) parent[b] = a;
    else parent[a] = b;
}

/* Unite the new run, number i, with the runs of an earlier row that touch it. */
static void look_back(bvxi_components *c, bvxi_component_reach *r, const bvxi_component_run *run, uint64_t row, uint32_t i)
{
    uint32_t const live = i > c->ring_size ? i - c->ring_size : 0; /* what fell out of the ring lies in rows before */
    uint32_t j = r->cursor < live ? live : r->cursor;
    uint32_t slot = j % c->ring_size;
    for (; j < i; j++, slot = slot + 1 == c->ring_size ? 0 : slot + 1) {
        const bvxi_component_run *const q = &c->ring[slot];
        if (q->row > row || (q->row == row && q->end + r->reach > run->begin)) break;
    }
    r->cursor = j;
    for (; j < i; j++, slot = slot + 1 == c->ring_size ? 0 : slot + 1) {
        const bvxi_component_run *const q = &c->ring[slot];
        if (q->row != row || q->begin >= run->end + r->reach) break;
        unite_components(c->label, i, j);
    }
}

void bvxi_components_add(bvxi_components *c, int32_t begin, int32_t end, int32_t y, int32_t z)
{
    uint32_t const i = (uint32_t)c->added;
    bvxi_component_run run;
    if (c->added == c->run_count) return;
    run.row = (uint64_t)z * (uint64_t)c->ny + (uint64_t)y;
    run.begin = begin;
    run.end = end;
    c->label[i] = i;
    for (int32_t k = 0; k < c->reach_count; k++) {
        int32_t const ny = y + c->reach[k].dy, nz = z + c->reach[k].dz;
        if (ny < 0 || ny >= c->ny || nz < 0) continue;
        look_back(c, &c->reach[k], &run, (uint64_t)nz * (uint64_t)c->ny + (uint64_t)ny, i);
    }
    c->ring[i % c->ring_size] = run;
    c->added++;
}

void bvxi_components_number(bvxi_components *c)
{
    uint32_t next = 0;
    for (uint64_t i = 0; i < c->added; i++) /* a parent is an earlier run, whose label is final by now */
        c->label[i] = c->label[i] == i ? next++ : c->label[c->label[i]];
    c->component_count = next;
    free_component_ring(c);
}
