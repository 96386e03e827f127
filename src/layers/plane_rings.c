/* plane_rings.c - the ring of each plane is what the cells above and below it share: the points and crossings
 * of each loop one after the other, crossings of subdivided cells from above and below included, so an arc's
 * vertices are a stretch of it whatever cells it was cut for. Rings are the first vertices of the mesh, plane
 * by plane; planes are gone over side by side, once to count and once to place. */
#include "layers/slab.h"

enum { RINGS_GRAIN = 4096 };

/* Order of two crossings on one segment: -1, 0 (they are one), 1. */
static int order_on_segment(const bvxi_plane *p, const bvxi_line_cut *c, const bvxi_line_cut *d)
{
    const int32_t *const a = p->q[c->segment], *const b = p->q[p->next[c->segment]];
    if (c->axis == d->axis) {
        if (c->line == d->line) return 0;
        return (c->line < d->line) == (b[c->axis] > a[c->axis]) ? -1 : 1;
    }
    if (c->axis == 0) return bvxi_x_first(a, b, c->line, d->line) ? -1 : 1;
    return bvxi_x_first(a, b, d->line, c->line) ? 1 : -1;
}

/* Cuts by segment in start[], then in order along each; few lie on one. */
static void sort_cuts(const bvxi_plane *p, uint32_t *start, uint32_t *sorted)
{
    for (uint32_t i = 0; i < p->cut_count; i++) start[p->cut[i].segment]++;
    bvxi_place_counts32(start, p->point_count);
    for (uint32_t i = 0; i < p->cut_count; i++) sorted[start[p->cut[i].segment]++] = i;
    for (uint32_t i = p->point_count; i-- > 0;) start[i] = i == 0 ? 0 : start[i - 1];
    for (uint32_t k = 0; k < p->point_count; k++) {
        uint32_t const end = k + 1 < p->point_count ? start[k + 1] : p->cut_count;
        for (uint32_t i = start[k] + 1; i < end; i++) {
            uint32_t const x = sorted[i];
            uint32_t j = i;
            if (x < p->grid_cut_count) continue; /* those come first, and in order */
            for (; j > start[k] && order_on_segment(p, &p->cut[x], &p->cut[sorted[j - 1]]) < 0; j--)
                sorted[j] = sorted[j - 1];
            sorted[j] = x;
        }
    }
}

/* Arcs as stretches of a ring whose crossings are numbered. */
static void number_ring_arcs(bvxi_plane *p)
{
    for (uint32_t i = 0; i < p->arc_count; i++) {
        if (p->arc[i].from == BVXI_NONE) continue;
        p->ring_arc[i].from = p->cut[p->arc[i].from].ring;
        p->ring_arc[i].to = p->cut[p->arc[i].to].ring;
    }
}

/* Where a crossing lies, on the segment as given. One through a meeting of two lines, which are two crossings
 * at one place, is moved a little along the segment, as the lines are thought to be. */
static void cut_place(const bvxi_stack *s, const bvxi_plane *p, const bvxi_line_cut *c, double at[3])
{
    const int32_t *const a = p->q[c->segment], *const b = p->q[p->next[c->segment]];
    const double *const from = s->given->points + 3 * (uint64_t)p->given[c->segment];
    const double *const to = s->given->points + 3 * (uint64_t)p->given[p->next[c->segment]];
    double const length = (double)((int64_t)b[c->axis] - a[c->axis]);
    double t = (double)((int64_t)c->line - a[c->axis]) / length;
    int const o = 1 - c->axis;

    if (c->axis == 0) { /* the line u + e_u */
        int64_t const d = (int64_t)b[o] - a[o];
        int64_t const num = ((int64_t)c->line - a[0]) * d;
        int64_t const den = (int64_t)b[0] - a[0];
        /* The other coordinate is a whole number there, and one that a line may have. */
        if (num % den == 0 && ((a[o] + num / den) & ((1 << (s->fine - BVXI_SECTION_DEEPEST)) - 1)) == 0)
            t += 0.25 / length;
    }
    for (int k = 0; k < 3; k++) at[k] = from[k] + t * (to[k] - from[k]);
}

typedef struct ring_job {
    bvxi_stack *s;
    uint32_t *start, *sorted; /* of each plane */
    uint64_t *first;          /* where its part of sorted begins */
    int32_t pieces;
} ring_job;

static void ring_count_piece(void *user, uint64_t begin, uint64_t end)
{
    const ring_job *const job = user;
    for (uint64_t i = begin; i < end; i++) {
        /* Pieces take whole planes, and arrays are shared: no worker writes where another does. */
        bvxi_plane *const p = &job->s->plane[i];
        uint32_t *const start = job->start + (p->ring - job->s->all.ring);
        uint32_t *const sorted = job->sorted + job->first[i];
        sort_cuts(p, start, sorted);
        uint32_t n = 0;

        for (uint32_t k = 0; k < p->point_count; k++) {
            uint32_t const last = k + 1 < p->point_count ? start[k + 1] : p->cut_count;
            p->ring[k] = n++;
            for (uint32_t m = start[k]; m < last; m++) {
                bvxi_line_cut *const c = &p->cut[sorted[m]];
                /* Only a cut of a subdivided cell may repeat one: both slabs may have made it. */
                int const may_repeat = m > start[k] &&
                                       (sorted[m] >= p->grid_cut_count || sorted[m - 1] >= p->grid_cut_count);
                if (may_repeat && order_on_segment(p, c, &p->cut[sorted[m - 1]]) == 0) n--;
                c->ring = n++;
            }
        }
        p->ring_count = n;
        number_ring_arcs(p);
    }
}

static void ring_place_piece(void *user, uint64_t begin, uint64_t end)
{
    const bvxi_stack *const s = ((const ring_job *)user)->s;
    for (const bvxi_plane *p = s->plane + begin; p < s->plane + end; p++) {
        double *const position = s->mesh.position + 3 * (uint64_t)p->vertex;
        for (uint32_t i = 0; i < p->point_count; i++)
            memcpy(position + 3 * (uint64_t)p->ring[i], s->given->points + 3 * (uint64_t)p->given[i], 24);
        for (uint32_t i = 0; i < p->cut_count; i++)
            cut_place(s, p, &p->cut[i], position + 3 * (uint64_t)p->cut[i].ring);
    }
}

bvx_status bvxi_rings_make(bvxi_stack *s)
{
    ring_job job = {.s = s};
    uint64_t cuts = 0, vertices = 0;

    /* Scratch as large as all planes' cuts, so that planes need not wait for each other. */
    for (uint32_t i = 0; i < s->plane_count; i++) cuts += s->plane[i].cut_count;
    job.pieces = bvxi_section_pieces(s->plane_count, s->all.point_room + cuts, RINGS_GRAIN);
    BVXI_TRY(BVXI_ZEROS(s->ctx, s->all.point_room, "the crossings of segments", job.start));
    BVXI_TRY(BVXI_ARRAY(s->ctx, cuts, "the crossings in order", job.sorted));
    BVXI_TRY(BVXI_ARRAY(s->ctx, s->plane_count, "the crossings in order", job.first));
    cuts = 0;
    for (uint32_t i = 0; i < s->plane_count; i++) {
        job.first[i] = cuts;
        cuts += s->plane[i].cut_count;
    }
    BVXI_TRY(bvxi_for_ranges(s->ctx, "rings", 0.0, 0.5, job.pieces, s->plane_count, ring_count_piece, &job));

    /* Rings lie one after the other, so a vertex is a plane's first and its place in the ring. */
    for (uint32_t i = 0; i < s->plane_count; i++) {
        s->plane[i].vertex = (uint32_t)vertices;
        vertices += s->plane[i].ring_count;
        if (vertices > UINT32_MAX - 1)
            return bvxi_fail_for(s->ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                                 "%s: the surface has more than 2^32 vertices", s->function);
    }
    BVXI_TRY(BVXI_ARRAY(s->ctx, 3 * vertices, "the vertices of a body", s->mesh.position));
    s->mesh.vertex_room = s->mesh.vertex_count = vertices;
    /* Copies of planes for levels hold rings of their own, which follow the crossings just numbered. */
    for (uint32_t i = 0; i < s->nesting.plane_count; i++) {
        bvxi_nesting_refresh(&s->nesting.plane[i]);
        number_ring_arcs(&s->nesting.plane[i]);
    }
    return bvxi_for_ranges(s->ctx, "rings", 0.5, 1.0, job.pieces, s->plane_count, ring_place_piece, &job);
}
