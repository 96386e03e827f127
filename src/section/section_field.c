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
    if (s->fixed) return BVX_ERR_BUDGET;
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

bvx_status bvxi_map_open(bvxi_stack *s, bvxi_vertex_map *m)
{
    return m->room != 0 ? BVX_OK : map_resize(s, m, 64);
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
    if (p->distance == NULL) {
        f->s->report.distances++;
        return bvxi_plane_distance(p->plane, f->s->origin[0] + i * f->s->step[0], f->s->origin[1] + j * f->s->step[1], &p->hint);
    }
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
    return bvxi_plane_is_nothing(f->slab->plane[k]);
}

double bvxi_field_corner(bvxi_field *f, const int32_t at[2], int k, int inside)
{
    double d;
    if (is_nothing(f, k)) {
        int const other = bvxi_grid_bit(f->s, f->slab->plane[1 - k], at[0] >> f->s->fine, at[1] >> f->s->fine);
        return bvxi_field_corner(f, at, 1 - k, other) - f->depth;
    }
    d = corner_distance(f, at, k);
    return inside ? d : -d;
}

static double plane_at(bvxi_field *f, int k, double u, double v)
{
    double d;
    if (is_nothing(f, k)) return plane_at(f, 1 - k, u, v) - f->depth;
    f->s->report.distances++;
    d = bvxi_plane_distance(f->slab->plane[k], u, v, &f->plane[k].hint);
    return bvxi_plane_inside(f->s, f->slab->plane[k], u, v) ? d : -d;
}

double bvxi_field_at(bvxi_field *f, double u, double v, double t)
{
    double const below = t < 1.0 ? plane_at(f, 0, u, v) : 0.0, above = t > 0.0 ? plane_at(f, 1, u, v) : 0.0;
    return (1.0 - t) * below + t * above;
}

/* ---- crossings of lines ---- */

/* Where a line is crossed, as a share of the way, and between which levels; distances on both planes. */
static double line_share(const bvxi_field *f, double below, double above, uint8_t *layer)
{
    double t = below + above > 0.0 ? below / (below + above) : 0.5;
    int32_t l = 0;
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

static bvx_status cross_over(bvxi_field *f, double u, double v, const double d[2], uint8_t *layer, uint32_t *vertex)
{
    const double *const w = f->slab->w;
    double const below = is_nothing(f, 0) ? f->depth - d[1] : d[0], above = is_nothing(f, 1) ? f->depth - d[0] : d[1];
    double const t = line_share(f, below, above, layer);
    double place[3];
    bvxi_section_place(f->s, u, v, w[0] + t * (w[1] - w[0]), place);
    return bvxi_section_add_vertex(f->s, place, vertex);
}

/* From what was nearest to the last place of this column or one beside it; columns are numbered from 1. */
static void start_near(bvxi_plane_field *p, int32_t i)
{
    const bvxi_column_hint *best = &p->column[i + 1];
    if (p->column[i].row > best->row) best = &p->column[i];
    if (p->column[i + 2].row > best->row) best = &p->column[i + 2];
    if (best->row >= 0) p->hint = best->segment;
}

/* Distances of all crossed lines on one plane. The search begins at what was nearest to the place just before, or above, so it
 * seldom goes far. */
static void measure_lines(bvxi_field *f, int k)
{
    bvxi_stack *const s = f->s;
    bvxi_plane_field *const p = &f->plane[k];
    double *const d = f->line[k];
    uint32_t n = 0;
    for (int32_t i = 0; i <= s->size[0] + 2; i++) p->column[i].row = -1;
    for (int32_t j = 0; j <= s->size[1]; j++) {
        int32_t last = INT32_MIN / 2;
        for (int32_t word = 0; word < s->words; word++)
            for (uint64_t bits = f->crossed[(size_t)j * (size_t)s->words + (size_t)word]; bits != 0; bits &= bits - 1) {
                int32_t const i = 64 * word + bvxi_lowest(bits);
                if (i - last > 1) start_near(p, i);
                d[n++] = grid_distance(f, p, i, j);
                p->column[i + 1].segment = p->hint;
                p->column[i + 1].row = j;
                last = i;
            }
    }
}

/* How far a plane without loops lies below the other one. */
static void find_depth(bvxi_field *f)
{
    int const k = is_nothing(f, 0);
    f->depth = 0.0;
    if (!k && !is_nothing(f, 1)) return;
    for (uint32_t n = 0; n < f->lines; n++)
        if (f->line[k][n] > f->depth) f->depth = f->line[k][n];
    for (uint32_t i = 0; i < f->slab->hanging_count; i++) {
        const bvxi_hanging *const h = &f->slab->hanging[i];
        double d;
        if (h->inside[0] == h->inside[1]) continue;
        d = corner_distance(f, h->at, k);
        if (d > f->depth) f->depth = d;
    }
}

static bvx_status cross_grid_lines(bvxi_field *f)
{
    bvxi_stack *const s = f->s;
    uint32_t n = 0;
    f->first = s->ring_vertices + (uint32_t)s->mesh.vertex_count;
    for (int32_t j = 0; j <= s->size[1]; j++)
        for (int32_t word = 0; word < s->words; word++)
            for (uint64_t bits = f->crossed[(size_t)j * (size_t)s->words + (size_t)word]; bits != 0; bits &= bits - 1, n++) {
                int32_t const i = 64 * word + bvxi_lowest(bits);
                double const d[2] = {f->line[0][n], f->line[1][n]};
                uint32_t vertex;
                uint8_t layer;
                BVXI_TRY(cross_over(f, s->origin[0] + i * s->step[0], s->origin[1] + j * s->step[1], d, &layer, &vertex));
                if (f->layers > 1) f->layer[n] = layer;
            }
    return BVX_OK;
}

static bvx_status cross_lines(bvxi_field *f)
{
    bvxi_slab *const slab = f->slab;
    size_t const words = (size_t)(f->s->size[1] + 1) * (size_t)f->s->words;
    f->lines = 0;
    for (size_t i = 0; i < words; i++) {
        f->crossed[i] = slab->plane[0]->inside[i] ^ slab->plane[1]->inside[i];
        f->before[i] = f->lines;
        f->lines += bvxi_popcount(f->crossed[i]);
    }
    for (int k = 0; k < 2; k++)
        if (!is_nothing(f, k)) measure_lines(f, k);
    find_depth(f);
    BVXI_TRY(cross_grid_lines(f));
    for (uint32_t i = 0; i < slab->hanging_count; i++) {
        bvxi_hanging *const h = &slab->hanging[i];
        double d[2] = {0.0, 0.0};
        if (h->inside[0] == h->inside[1]) continue;
        for (int k = 0; k < 2; k++)
            if (!is_nothing(f, k)) d[k] = corner_distance(f, h->at, k);
        BVXI_TRY(cross_over(f, bvxi_fixed_u(f->s, 0, h->at[0]), bvxi_fixed_u(f->s, 1, h->at[1]), d, &h->layer, &h->vertex));
    }
    return BVX_OK;
}

/* ---- slabs ---- */

static uint64_t known_bytes(const bvxi_stack *s)
{
    return (((uint64_t)s->size[0] + 1) * ((uint64_t)s->size[1] + 1) + 63) / 64 * 8;
}

static uint64_t column_bytes(const bvxi_stack *s)
{
    return ((uint64_t)s->size[0] + 3) * sizeof(bvxi_column_hint);
}

static void set_plane(bvxi_field *f, bvxi_plane_field *p, const bvxi_plane *plane)
{
    p->plane = plane;
    p->hint = 0;
    if (p->known != NULL) memset(p->known, 0, (size_t)known_bytes(f->s));
}

static void index_hanging(bvxi_field *f)
{
    const bvxi_slab *const slab = f->slab;
    for (int k = 0; k < 2; k++) {
        uint32_t *const start = k == 0 ? f->hanging_column : f->hanging_row;
        uint32_t n = 0;
        for (int32_t i = 0; i < f->s->size[k] + 2; i++) {
            while (n < slab->hanging_count && slab->hanging[k == 0 ? slab->by_u[n] : n].at[k] >> f->s->fine < i) n++;
            start[i] = n;
        }
    }
}

bvx_status bvxi_field_set(bvxi_field *f, bvxi_slab *slab)
{
    f->slab = slab;
    f->layers = is_nothing(f, 0) || is_nothing(f, 1) ? 1 : f->s->options.layers;
    if (f->s->options.crossings != BVX_CROSSINGS_EXACT && f->plane[1].plane == slab->plane[0]) { /* what was above is below now */
        bvxi_plane_field const up = f->plane[1];
        f->plane[1] = f->plane[0];
        f->plane[0] = up;
    } else {
        set_plane(f, &f->plane[0], slab->plane[0]);
    }
    set_plane(f, &f->plane[1], slab->plane[1]);
    if (slab->hanging_count != 0) index_hanging(f);
    return cross_lines(f);
}

bvx_status bvxi_field_open(bvxi_stack *s, bvxi_field *f, uint32_t lines)
{
    uint64_t const points = ((uint64_t)s->size[0] + 1) * ((uint64_t)s->size[1] + 1), words = ((uint64_t)s->size[1] + 1) * (uint64_t)s->words;
    memset(f, 0, sizeof *f);
    f->s = s;
    f->line_room = lines;
    for (int k = 0; k < 2; k++) {
        BVXI_TRY(bvxi_alloc(s->ctx, BVXI_SCRATCH, column_bytes(s), "the distances of a section", &f->plane[k].column));
        BVXI_TRY(bvxi_alloc_zero(s->ctx, BVXI_SCRATCH, (uint64_t)lines * 8, "the distances of a section", &f->line[k]));
        if (s->options.crossings == BVX_CROSSINGS_EXACT && s->options.layers == 1) continue;
        BVXI_TRY(bvxi_alloc(s->ctx, BVXI_SCRATCH, points * 8, "the distances of a section", &f->plane[k].distance));
        BVXI_TRY(bvxi_alloc_zero(s->ctx, BVXI_SCRATCH, known_bytes(s), "the distances of a section", &f->plane[k].known));
    }
    if (s->options.layers > 1) BVXI_TRY(bvxi_alloc(s->ctx, BVXI_SCRATCH, lines, "the crossings of lines", &f->layer));
    BVXI_TRY(bvxi_alloc(s->ctx, BVXI_SCRATCH, ((uint64_t)s->size[0] + 2) * 4, "the corners of cells", &f->hanging_column));
    BVXI_TRY(bvxi_alloc(s->ctx, BVXI_SCRATCH, ((uint64_t)s->size[1] + 2) * 4, "the corners of cells", &f->hanging_row));
    BVXI_TRY(bvxi_alloc(s->ctx, BVXI_SCRATCH, words * 4, "the crossed lines", &f->before));
    return bvxi_alloc(s->ctx, BVXI_SCRATCH, words * 8, "the crossed lines", &f->crossed);
}

void bvxi_field_close(bvxi_field *f)
{
    bvxi_stack *const s = f->s;
    uint64_t const points = ((uint64_t)s->size[0] + 1) * ((uint64_t)s->size[1] + 1), words = ((uint64_t)s->size[1] + 1) * (uint64_t)s->words;
    bvxi_free(s->ctx, f->crossed, words * 8);
    bvxi_free(s->ctx, f->before, words * 4);
    bvxi_free(s->ctx, f->hanging_row, ((uint64_t)s->size[1] + 2) * 4);
    bvxi_free(s->ctx, f->hanging_column, ((uint64_t)s->size[0] + 2) * 4);
    bvxi_free(s->ctx, f->layer, f->line_room);
    for (int k = 2; k-- > 0;) {
        bvxi_free(s->ctx, f->plane[k].known, known_bytes(s));
        bvxi_free(s->ctx, f->plane[k].distance, points * 8);
        bvxi_free(s->ctx, f->line[k], (uint64_t)f->line_room * 8);
        bvxi_free(s->ctx, f->plane[k].column, column_bytes(s));
    }
    memset(f, 0, sizeof *f);
}
