/* sharp.c - sharp edges and corners of a field's surface.
 *
 * Source: Kobbelt, Botsch, Schwanecke, Seidel. Feature Sensitive Surface Extraction from Volume Data. 2001
 * (extended marching cubes: a vertex a loop, then flips); Ju, Losasso, Schaefer, Warren. Dual Contouring of
 * Hermite Data. 2002.
 *
 * A loop of a cell whose vertices' facets differ gets an apex: a vertex strictly inside the cell, nearest to
 * the facets' planes, and the loop's triangles become a fan. Where two such cells share a face, the side of
 * the fans that lies on it may be turned to join the apexes, so that the sharp edge runs from vertex to
 * vertex.
 *
 * No triangles cross, whatever the numbers are:
 *  - A fan over a loop on a box's surface from a point strictly inside the box is embedded, as every ray from
 *    the point meets the surface once; it touches the cell's faces in the loop only, so neighbours are
 *    unchanged.
 *  - Cells with several loops keep their apexes only if all triangles of different loops are proven apart.
 *  - A side is turned only between two cells of one loop each, on a face that is cut once. The line from apex
 *    to apex lies in the two boxes together and passes the face strictly inside, at q. So turning is the same
 *    as making the side v w the path v q w in both loops, which stay simple: the fans over them are embedded
 *    as before, whatever other sides do.
 *  - All that holds for coordinates as written: apexes are rounded first and compared with the rounded faces.
 * What is done to a loop or side depends on nothing else that is done, so order and threads do not show. */
#include "surface/sharp.h"
#include "mesh/mesh.h"

/* ---- The last pass: sides that are turned ---- */

/* An edge between two fans is flipped where it runs better from apex to apex, as a sharp edge does. */

/* A turned side must follow its facets better by this, or flat places would
 * turn by rounding. [Units: cosines] */
#define LEAST_GAIN (1.0 / 64.0)

/* The kept loop of the cell at x of a slot, where it is the cell's only one; else NULL. */
static bvxi_sharp_loop *sharp_loop_alone(const bvxi_sharp_work *w, uint64_t slot, int32_t x)
{
    /* Loops lie in the order of cells: by bisection. */
    uint32_t low = w->first[slot], high = w->first[slot + 1];
    while (low < high) {
        uint32_t const middle = low + (high - low) / 2;
        if (w->loops[middle].x < x) low = middle + 1;
        else high = middle;
    }
    if (low == w->first[slot + 1] || w->loops[low].x != x || !w->loops[low].alone || !w->loops[low].kept)
        return NULL;
    return &w->loops[low];
}

/* The kept loop of the neighbour across a face of the cell at x, where it is its only one; else NULL. */
static bvxi_sharp_loop *sharp_beside(const bvxi_sharp_work *w, uint64_t slot, int32_t x, int32_t face)
{
    uint64_t const rows = (uint64_t)w->march->grid->size[1] + 1;
    uint64_t const step = face >> 1 == 0 ? 0 : face >> 1 == 1 ? 1 : rows;
    int32_t const up = face & 1;
    if (face >> 1 == 0) x += up ? 1 : -1; /* The neighbour across y and z lies in another row. */
    /* a cell with a cut face has a neighbour there */
    return sharp_loop_alone(w, up ? slot + step : slot - step, x);
}

/* How far the worse of two triangles follows facets at its vertices a and b; the apexes have none. */
static double follows(const double n[3], const double facet[3], double worst)
{
    double const cosine = bvxi_vec_dot(n, facet);
    return cosine < worst ? cosine : worst;
}

/* Would the fans' side from a to b, seen from apex p, better run from apex p to the neighbour's q? */
static int better_turned(const bvxi_sharp_work *w, uint32_t a, uint32_t b, const double p[3],
                         const double q[3])
{
    double const unit = w->cuts->unit;
    double at[3], bt[3], na[3], nb[3], n[3], keep = 1.0, turn = 1.0;

    if (!bvxi_sharp_normal(w, a, na) || !bvxi_sharp_normal(w, b, nb)) return 0;
    bvxi_sharp_vertex(w->march, a, at);
    bvxi_sharp_vertex(w->march, b, bt);

    /* A triangle without area has no side: then nothing is turned. */
    if (!bvxi_normal_of(at, bt, p, unit, n)) return 0;
    keep = follows(n, nb, follows(n, na, keep));
    if (!bvxi_normal_of(bt, at, q, unit, n)) return 0;
    keep = follows(n, nb, follows(n, na, keep));
    if (!bvxi_normal_of(at, q, p, unit, n)) return 0;
    turn = follows(n, na, turn);
    if (!bvxi_normal_of(bt, p, q, unit, n)) return 0;
    turn = follows(n, nb, turn);
    return turn > 0.0 && turn > keep + LEAST_GAIN;
}

static void sharp_turn_piece(void *work, int32_t piece, uint64_t begin, uint64_t end)
{
    bvxi_sharp_work *const w = work;
    uint64_t count = 0;
    for (uint64_t s = begin; s < end; s++) {
        bvxi_cell_walk c;
        if (w->first[s + 1] == w->first[s]) continue;
        for (bvxi_start_cells(w->march, s, &c); bvxi_next_cell(&c);) {
            bvxi_sharp_loop *const here = sharp_loop_alone(w, s, c.x);
            bvxi_cell_loops loops;
            const bvxi_cell_loop *const l = &loops.loop[0];

            if (here == NULL) continue;
            bvxi_trace_walked(&c, &loops);
            for (int32_t i = 0; i < l->corners; i++) {
                int32_t const next = i + 1 < l->corners ? i + 1 : 0;
                int32_t const face = bvxi_face_of_edges(l->edge[i], l->edge[next]);
                /* Each face is decided once, by the cell on its negative side. */
                if ((face & 1) == 0 || bvxi_face_is_cut_twice(c.cell_case, face)) continue;
                const bvxi_sharp_loop *beside = sharp_beside(w, s, c.x, face);
                if (beside == NULL ||
                    !better_turned(w, l->vertex[i], l->vertex[next], here->apex, beside->apex))
                    continue;
                here->turned = (uint8_t)(here->turned | 1u << (face >> 1));
                count++;
            }
        }
    }
    w->counts[piece] = count;
}

/* Vertex number of the apex beyond the face of a side that is turned, or UINT32_MAX. */
static uint32_t apex_beyond(const bvxi_sharp_work *w, uint64_t slot, const bvxi_cell_walk *c,
                            const bvxi_sharp_loop *s, int32_t face)
{
    /* The mark of a turned side stands with the cell on its negative side. */
    if (!s->alone || ((face & 1) != 0 && (s->turned >> (face >> 1) & 1) == 0)) return UINT32_MAX;
    if (bvxi_face_is_cut_twice(c->cell_case, face)) return UINT32_MAX;
    const bvxi_sharp_loop *beside = sharp_beside(w, slot, c->x, face);
    if (beside == NULL || ((face & 1) == 0 && (beside->turned >> (face >> 1) & 1) == 0)) return UINT32_MAX;
    return (uint32_t)w->march->vertex_count + beside->before;
}

/* The fan of a loop. A turned side's two triangles come one from each cell:
 * the side's second vertex gives way to the other apex. */
static uint32_t *write_fan(const bvxi_sharp_work *w, uint64_t slot, const bvxi_cell_walk *c,
                           const bvxi_cell_loop *l, const bvxi_sharp_loop *s, uint32_t *out)
{
    /* From corner to corner; a turned side takes the neighbour's apex in place of its second vertex. */
    for (int32_t i = 0; i < l->corners; i++) {
        int32_t const next = i + 1 < l->corners ? i + 1 : 0;
        uint32_t const beyond = apex_beyond(w, slot, c, s, bvxi_face_of_edges(l->edge[i], l->edge[next]));
        *out++ = l->vertex[i];
        *out++ = beyond != UINT32_MAX ? beyond : l->vertex[next];
        *out++ = (uint32_t)w->march->vertex_count + s->before;
    }
    return out;
}

static void write_slot_triangles(const bvxi_sharp_work *w, uint64_t slot)
{
    const bvxi_march *const m = w->march;
    const bvxi_slot *const from = &m->slots[slot];
    uint64_t const first = w->first[slot];
    uint64_t const kept = first < w->first[m->slot_count] ? w->loops[first].before
                                                          : w->surface->vertex_count - m->vertex_count;
    uint32_t *out = w->surface->triangles + 3 * (size_t)(from->triangle + 2 * kept);
    const bvxi_sharp_loop *s = w->loops + first, *const end = w->loops + w->first[slot + 1];
    bvxi_cell_walk c;

    /* Rows without sharp cells are copied whole. */
    if (s == end) {
        memcpy(out, m->mesh->triangles + 3 * (size_t)from->triangle,
               (size_t)(from[1].triangle - from->triangle) * 12);
        return;
    }
    for (bvxi_start_cells(m, slot, &c); bvxi_next_cell(&c);) {
        const uint32_t *const old = m->mesh->triangles + 3 * (size_t)c.triangle;
        bvxi_cell_loops loops;
        /* Not listed: the cell keeps its triangles. */
        if (s == end || s->x != c.x) {
            size_t const n = 3 * (size_t)bvxi_cell_triangle_count[m->options.face_rule][c.cell_case];
            memcpy(out, old, n * sizeof *out);
            out += n;
            continue;
        }
        bvxi_trace_walked(&c, &loops);
        for (int32_t l = 0; l < loops.count; l++) {
            const bvxi_cell_loop *const loop = &loops.loop[l];
            int const listed = s != end && s->x == c.x && s->loop == l;
            /* An apex that was taken back leaves the loop as it was. */
            if (listed && s->kept) out = write_fan(w, slot, &c, loop, s, out);
            else {
                memcpy(out, old + 3 * (size_t)loop->first, 3 * (size_t)loop->triangles * sizeof *out);
                out += 3 * (size_t)loop->triangles;
            }
            s += listed;
        }
    }
}

static void write_sharp_piece(void *work, uint64_t begin, uint64_t end)
{
    const bvxi_sharp_work *const w = work;
    for (uint64_t s = begin; s < end; s++) write_slot_triangles(w, s);
}

static bvx_status write_sharp(bvx_context *ctx, bvxi_sharp_work *w, uint32_t kept, bvx_mesh *surface)
{
    const bvxi_march *const m = w->march;
    int const mine = surface->positions == NULL;
    BVXI_TRY(bvxi_mesh_open(ctx, m->function, m->options.position_type, 0, m->vertex_count + kept,
                            m->triangle_count + 2 * (uint64_t)kept, surface));
    memcpy(surface->frame, m->mesh->frame, sizeof surface->frame);
    w->surface = surface;
    size_t const bytes = m->options.position_type == BVX_F32 ? 12 : 24;

    /* Vertices of the surface first, with their numbers; apexes after them. */
    memcpy(w->surface->positions, m->mesh->positions, (size_t)m->vertex_count * bytes);
    for (uint64_t n = 0; n < w->first[m->slot_count]; n++) {
        const bvxi_sharp_loop *const s = &w->loops[n];
        size_t const to = 3 * ((size_t)m->vertex_count + s->before);
        if (!s->kept) continue;
        for (size_t a = 0; a < 3; a++)
            if (m->options.position_type == BVX_F32)
                ((float *)w->surface->positions)[to + a] = (float)s->apex[a];
            else ((double *)w->surface->positions)[to + a] = s->apex[a];
    }

    bvx_status status = bvxi_for_ranges(ctx, "sharp edges", 0.8, 1.0, m->pieces, m->slot_count,
                                        write_sharp_piece, w);
    return bvxi_mesh_made(ctx, status, mine, surface);
}

bvx_status bvxi_sharpen(bvx_context *ctx, const bvxi_march *march, const bvxi_cuts *cuts, double least_cosine,
                        bvx_mesh *surface, bvx_field_surface_report *report)
{
    bvxi_sharp_work w = {march, cuts, least_cosine, NULL, NULL, NULL, NULL};
    uint64_t const slot_bytes = (march->slot_count + 1) * sizeof *w.first;
    uint64_t const piece_bytes = (uint64_t)march->pieces * sizeof *w.counts;
    uint64_t total = 0;

    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, slot_bytes, "the rows' sharp cells", &w.first));

    /* Sharp loops are counted, then filled, so that one array holds all. */
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, piece_bytes, "the counts of turned edges", &w.counts));
    BVXI_TRY(bvxi_for_ranges(ctx, "sharp edges", 0.0, 0.3, march->pieces, march->slot_count,
                             bvxi_sharp_count_piece, &w));
    for (uint64_t s = 0; s < march->slot_count; s++) {
        uint32_t const n = w.first[s];
        w.first[s] = (uint32_t)total;
        total += n;
    }
    w.first[march->slot_count] = (uint32_t)total;
    /* Each apex adds two triangles: a fan has as many as corners, where there were two less. */
    if (march->vertex_count + total >= UINT32_MAX || march->triangle_count + 2 * total >= UINT32_MAX)
        return bvxi_fail_for(
            ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
            "%s: %u vertices and %u more inside cells; 2^32 - 1 are possible, take fewer voxels",
            march->function, march->vertex_count, total);
    BVXI_TRY(BVXI_ARRAY(ctx, total, "the sharp cells", w.loops));
    BVXI_TRY(bvxi_for_ranges(ctx, "sharp edges", 0.3, 0.6, march->pieces, march->slot_count,
                             bvxi_sharp_fill_piece, &w));
    uint32_t kept = 0;
    for (uint64_t n = 0; n < total; kept += w.loops[n++].kept) w.loops[n].before = kept;
    BVXI_TRY(bvxi_for_pieces(ctx, "sharp edges", 0.6, 0.8, march->pieces, w.march->slot_count,
                             sharp_turn_piece, &w));
    BVXI_TRY(write_sharp(ctx, &w, kept, surface));
    for (int32_t p = 0; p < march->pieces; p++) report->flipped_edges += w.counts[p];
    report->sharp_cells = kept;
    report->sharp_taken_back = total - kept;
    return BVX_OK;
}
