/* section_field.c - signed distances where the surface asks for them, and its crossings of the lines between two planes.
 *
 * A line over a grid point (or a corner of a subdivided cell) is crossed where the point is inside on one plane and outside on
 * the other: at the share of both distances, kept a little off the planes. A plane without loops is as deep outside
 * everywhere as the other plane's widest place is inside: the body narrows to a ridge there. */
#include "section/section_field.h"

#define FIELD_MARGIN (1.0 / 1024.0)

/* ---- lookup ---- */

static uint32_t map_slot(const bvxi_vertex_map *m, uint64_t key)
{
    uint64_t h = key * UINT64_C(0x9e3779b97f4a7c15);
    uint32_t i = (uint32_t)(h >> 32) & (m->room - 1);
    while (m->key[i] != UINT64_MAX && m->key[i] != key) i = (i + 1) & (m->room - 1);
    return i;
}

static bvx_status map_resize(bvxi_stack *s, bvxi_vertex_map *m, uint32_t room)
{
    bvxi_vertex_map larger = {NULL, NULL, 0, 0};
    bvx_status status;
    larger.room = room;
    larger.count = m->count;
    status = bvxi_alloc(s->ctx, BVXI_SCRATCH, (uint64_t)room * 8, "the crossings of edges", &larger.key);
    if (status == BVX_OK) status = bvxi_alloc(s->ctx, BVXI_SCRATCH, (uint64_t)room * 4, "the crossings of edges", &larger.vertex);
    if (status != BVX_OK) {
        bvxi_free(s->ctx, larger.key, larger.key == NULL ? 0 : (uint64_t)room * 8);
        return status;
    }
    memset(larger.key, 0xff, (size_t)room * 8);
    for (uint32_t i = 0; i < m->room; i++)
        if (m->key[i] != UINT64_MAX) {
            uint32_t const at = map_slot(&larger, m->key[i]);
            larger.key[at] = m->key[i];
            larger.vertex[at] = m->vertex[i];
        }
    bvxi_map_free(s, m);
    *m = larger;
    return BVX_OK;
}

bvx_status bvxi_map_find(bvxi_stack *s, bvxi_vertex_map *m, uint64_t key, uint32_t **vertex)
{
    uint32_t at;
    if (2 * (uint64_t)m->count >= m->room) {
        if (m->room >= UINT32_C(1) << 30) return bvxi_fail(s->ctx, BVX_ERR_RANGE, "%s: more than 2^29 crossings of edges", s->function);
        BVXI_TRY(map_resize(s, m, m->room == 0 ? 64 : 2 * m->room));
    }
    at = map_slot(m, key);
    if (m->key[at] == UINT64_MAX) {
        m->key[at] = key;
        m->vertex[at] = BVXI_NONE;
        m->count++;
    }
    *vertex = &m->vertex[at];
    return BVX_OK;
}

void bvxi_map_clear(bvxi_vertex_map *m)
{
    if (m->count != 0) memset(m->key, 0xff, (size_t)m->room * 8);
    m->count = 0;
}

void bvxi_map_free(bvxi_stack *s, bvxi_vertex_map *m)
{
    bvxi_free(s->ctx, m->vertex, (uint64_t)m->room * 4);
    bvxi_free(s->ctx, m->key, (uint64_t)m->room * 8);
    memset(m, 0, sizeof *m);
}

/* ---- distances ---- */

double bvxi_fixed_u(const bvxi_stack *s, int axis, int32_t q)
{
    return s->origin[axis] + (double)q / (double)(1 << s->fine) * s->step[axis];
}

static double grid_distance(bvxi_field *f, bvxi_plane_field *p, int32_t i, int32_t j)
{
    size_t const n = (size_t)j * (size_t)(f->s->size[0] + 1) + (size_t)i;
    if ((p->known[n >> 6] >> (n & 63) & 1) == 0) {
        p->known[n >> 6] |= UINT64_C(1) << (n & 63);
        p->distance[n] = bvxi_plane_distance(p->plane, f->s->origin[0] + i * f->s->step[0], f->s->origin[1] + j * f->s->step[1], &p->hint);
        f->s->report.distances++;
    }
    return p->distance[n];
}

/* Unsigned, on a plane with loops. */
static double corner_distance(bvxi_field *f, const int32_t at[2], int k)
{
    bvxi_plane_field *const p = &f->plane[k];
    int32_t const fine = f->s->fine, part = (1 << fine) - 1;
    if ((at[0] & part) == 0 && (at[1] & part) == 0) return grid_distance(f, p, at[0] >> fine, at[1] >> fine);
    f->s->report.distances++;
    return bvxi_plane_distance(p->plane, bvxi_fixed_u(f->s, 0, at[0]), bvxi_fixed_u(f->s, 1, at[1]), &p->hint);
}

static int is_nothing(const bvxi_field *f, int k)
{
    return f->slab->plane[k] == &f->s->nothing;
}

double bvxi_field_corner(bvxi_field *f, const int32_t at[2], int k, int inside)
{
    int const from = is_nothing(f, k) ? 1 - k : k; /* one of the two has a contour */
    double d = corner_distance(f, at, from);
    if (from != k) inside = bvxi_grid_bit(f->s, f->slab->plane[from], at[0] >> f->s->fine, at[1] >> f->s->fine);
    if (!inside) d = -d;
    return from == k ? d : d - f->depth;
}

static double plane_at(bvxi_field *f, int k, double u, double v)
{
    int const from = is_nothing(f, k) ? 1 - k : k; /* one of the two has a contour */
    double d;
    f->s->report.distances++;
    d = bvxi_plane_distance(f->slab->plane[from], u, v, &f->plane[from].hint);
    if (!bvxi_plane_inside(f->s, f->slab->plane[from], u, v)) d = -d;
    return from == k ? d : d - f->depth;
}

double bvxi_field_at(bvxi_field *f, double u, double v, double t)
{
    double const below = t < 1.0 ? plane_at(f, 0, u, v) : 0.0, above = t > 0.0 ? plane_at(f, 1, u, v) : 0.0;
    return (1.0 - t) * below + t * above;
}

/* ---- crossings of lines ---- */

/* Where the line over a point is crossed, as a share of the way, and between which levels. */
static double line_share(bvxi_field *f, const int32_t at[2], uint8_t *layer)
{
    double d[2], t;
    int32_t l = 0;
    for (int k = 0; k < 2; k++) d[k] = is_nothing(f, k) ? 0.0 : corner_distance(f, at, k);
    for (int k = 0; k < 2; k++)
        if (is_nothing(f, k)) d[k] = f->depth - d[1 - k];
    t = d[0] + d[1] > 0.0 ? d[0] / (d[0] + d[1]) : 0.5;
    if (f->layers > 1) {
        t *= f->layers;
        l = t >= f->layers ? f->layers - 1 : t > 0.0 ? (int32_t)t : 0;
        t -= l;
    }
    if (!(t > FIELD_MARGIN)) t = FIELD_MARGIN;
    if (t > 1.0 - FIELD_MARGIN) t = 1.0 - FIELD_MARGIN;
    *layer = (uint8_t)l;
    return (l + t) / f->layers;
}

static bvx_status cross_over(bvxi_field *f, const int32_t at[2], uint8_t *layer, uint32_t *vertex)
{
    const double *const w = f->slab->w;
    double const t = line_share(f, at, layer);
    double place[3];
    bvxi_section_place(f->s, bvxi_fixed_u(f->s, 0, at[0]), bvxi_fixed_u(f->s, 1, at[1]), w[0] + t * (w[1] - w[0]), place);
    return bvxi_section_add_vertex(f->s, place, vertex);
}

/* Call it for every grid point whose line is crossed. */
static bvx_status each_crossed(bvxi_field *f, bvx_status (*visit)(bvxi_field *f, const int32_t at[2], size_t number))
{
    bvxi_stack *const s = f->s;
    for (int32_t j = 0; j <= s->size[1]; j++)
        for (int32_t k = 0; k < s->words; k++) {
            uint64_t bits = f->crossed[(size_t)j * (size_t)s->words + (size_t)k];
            for (int32_t i = 64 * k; bits != 0; i++, bits >>= 1) {
                int32_t at[2];
                while ((bits & 0xff) == 0) {
                    bits >>= 8;
                    i += 8;
                }
                if ((bits & 1) == 0) continue;
                at[0] = (int32_t)((uint32_t)i << s->fine);
                at[1] = (int32_t)((uint32_t)j << s->fine);
                BVXI_TRY(visit(f, at, (size_t)j * (size_t)(s->size[0] + 1) + (size_t)i));
            }
        }
    return BVX_OK;
}

static bvx_status cross_grid_point(bvxi_field *f, const int32_t at[2], size_t number)
{
    uint8_t layer;
    BVXI_TRY(cross_over(f, at, &layer, &f->vertex[number]));
    if (f->layers > 1) f->layer[number] = layer;
    return BVX_OK;
}

static bvx_status deepen(bvxi_field *f, const int32_t at[2], size_t number)
{
    double const d = corner_distance(f, at, is_nothing(f, 0));
    (void)number;
    if (d > f->depth) f->depth = d;
    return BVX_OK;
}

static bvx_status cross_lines(bvxi_field *f)
{
    bvxi_slab *const slab = f->slab;
    size_t const words = (size_t)(f->s->size[1] + 1) * (size_t)f->s->words;
    for (size_t i = 0; i < words; i++) f->crossed[i] = slab->plane[0]->inside[i] ^ slab->plane[1]->inside[i];
    f->depth = 0.0;
    if (is_nothing(f, 0) || is_nothing(f, 1)) {
        BVXI_TRY(each_crossed(f, deepen));
        for (uint32_t i = 0; i < slab->hanging_count; i++)
            if (slab->hanging[i].inside[0] != slab->hanging[i].inside[1]) BVXI_TRY(deepen(f, slab->hanging[i].at, 0));
    }
    BVXI_TRY(each_crossed(f, cross_grid_point));
    for (uint32_t i = 0; i < slab->hanging_count; i++) {
        bvxi_hanging *const h = &slab->hanging[i];
        if (h->inside[0] != h->inside[1]) BVXI_TRY(cross_over(f, h->at, &h->layer, &h->vertex));
    }
    return BVX_OK;
}

/* ---- slabs ---- */

static uint64_t known_bytes(const bvxi_stack *s)
{
    return (((uint64_t)s->size[0] + 1) * ((uint64_t)s->size[1] + 1) + 63) / 64 * 8;
}

static void set_plane(bvxi_field *f, bvxi_plane_field *p, const bvxi_plane *plane)
{
    p->plane = plane;
    p->hint = 0;
    memset(p->known, 0, (size_t)known_bytes(f->s));
}

bvx_status bvxi_field_set(bvxi_field *f, bvxi_slab *slab)
{
    f->slab = slab;
    f->layers = slab->plane[0] == &f->s->nothing || slab->plane[1] == &f->s->nothing ? 1 : f->s->options.layers;
    if (f->plane[1].plane == slab->plane[0]) { /* what was above is below now */
        bvxi_plane_field const up = f->plane[1];
        f->plane[1] = f->plane[0];
        f->plane[0] = up;
    } else {
        set_plane(f, &f->plane[0], slab->plane[0]);
    }
    set_plane(f, &f->plane[1], slab->plane[1]);
    return cross_lines(f);
}

bvx_status bvxi_field_open(bvxi_stack *s, bvxi_field *f)
{
    uint64_t const points = ((uint64_t)s->size[0] + 1) * ((uint64_t)s->size[1] + 1);
    memset(f, 0, sizeof *f);
    f->s = s;
    for (int k = 0; k < 2; k++) {
        BVXI_TRY(bvxi_alloc(s->ctx, BVXI_SCRATCH, points * 8, "the distances of a section", &f->plane[k].distance));
        BVXI_TRY(bvxi_alloc_zero(s->ctx, BVXI_SCRATCH, known_bytes(s), "the distances of a section", &f->plane[k].known));
    }
    BVXI_TRY(bvxi_alloc(s->ctx, BVXI_SCRATCH, points * 4, "the crossings of lines", &f->vertex));
    BVXI_TRY(bvxi_alloc_zero(s->ctx, BVXI_SCRATCH, points, "the crossings of lines", &f->layer));
    return bvxi_alloc(s->ctx, BVXI_SCRATCH, ((uint64_t)s->size[1] + 1) * (uint64_t)s->words * 8, "the crossed lines", &f->crossed);
}

void bvxi_field_close(bvxi_field *f)
{
    bvxi_stack *const s = f->s;
    uint64_t const points = ((uint64_t)s->size[0] + 1) * ((uint64_t)s->size[1] + 1);
    bvxi_free(s->ctx, f->crossed, ((uint64_t)s->size[1] + 1) * (uint64_t)s->words * 8);
    bvxi_free(s->ctx, f->layer, points);
    bvxi_free(s->ctx, f->vertex, points * 4);
    for (int k = 2; k-- > 0;) {
        bvxi_free(s->ctx, f->plane[k].known, known_bytes(s));
        bvxi_free(s->ctx, f->plane[k].distance, points * 8);
    }
    memset(f, 0, sizeof *f);
}
