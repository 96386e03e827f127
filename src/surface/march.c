/* march.c - the surface between set and empty voxel centres: bvx_extract_surface.
 *
 * Source: Lorensen, Cline. Marching Cubes. 1987; two passes with row offsets as in Schroeder et al. Flying
 * Edges. 2015.
 *
 * Rows are read 64 cells at a time: crossing masks by shift and XOR, vertex indices by rank, no cell or edge
 * is cached. A first pass counts vertices and triangles of each row of cells, prefix sums give every row its
 * place, a second pass writes. Guarantee: closed where sides are closed, outwards, manifold, canonical order;
 * no thread shows in it. */
#include "surface/cells.h"

enum { SLOT_GRAIN = 64 };

/* f32 holds coordinates up to the one, and distinguishes neighbours where it has this many steps a voxel. */
#define FLOAT_LIMIT 3.0e38
#define FLOAT_STEPS 256.0

static const bvxi_option extract_rows[] = {
    BVXI_CHOICE(bvx_extract_options, face_rule, BVX_FACE_SEPARATE, BVX_FACE_JOIN),
    BVXI_CHOICE(bvx_extract_options, position_type, BVX_POSITION_AUTO, BVX_F64),
    BVXI_WHOLE(bvx_extract_options, open_sides, 0, 63),
    BVXI_SWITCH(bvx_extract_options, keys),
    BVXI_SWITCH(bvx_extract_options, local_frame),
    BVXI_RESERVED(bvx_extract_options, reserved),
};

/* The largest coordinate of a grid along an axis, without its sign. */
static double farthest_coordinate(const bvx_grid *grid, const double origin[3], int32_t a)
{
    double const spacing = grid->lattice.spacing[a];
    double const low = bvxi_absolute(origin[a] + grid->low[a] * spacing);
    double const high = bvxi_absolute(origin[a] + ((double)grid->low[a] + grid->size[a]) * spacing);
    return low > high ? low : high;
}

/* The step from one f32 to the next at a coordinate. */
static double float_step(double coordinate)
{
    /* 2^-149, the least step of f32 */
    double step = 1.0 / 9007199254740992.0 / 9007199254740992.0 / 8796093022208.0;
    /* A float has 24 bits, so its step doubles whenever the coordinate reaches 2^24 of them. Doubling is
     * exact and needs no logarithm of a library; most of the way goes by 16 doublings at once. */
    while (step * 16777216.0 * 65536.0 <= coordinate) step *= 65536.0;
    while (step * 16777216.0 <= coordinate) step *= 2;
    return step;
}

int bvxi_fits_f32(const bvx_grid *grid, const double origin[3])
{
    for (int32_t a = 0; a < 3; a++) {
        double const most = farthest_coordinate(grid, origin, a);
        if (!(most < FLOAT_LIMIT) || float_step(most) > grid->lattice.spacing[a] / FLOAT_STEPS) return 0;
    }
    return 1;
}

bvx_status bvxi_choose_position_type(bvx_context *ctx, const char *function, const bvx_grid *grid,
                                     const double origin[3], int32_t *position_type)
{
    if (*position_type == BVX_F32) {
        for (int32_t a = 0; a < 3; a++) {
            double const spacing = grid->lattice.spacing[a], most = farthest_coordinate(grid, origin, a);

            /* Negated, so that a NaN is refused too. */
            if (!(most < FLOAT_LIMIT))
                return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_FLOATS_COARSE,
                                     "%s: coordinates up to %g do not fit f32; take f64 or a local frame",
                                     function, most);
            if (float_step(most) > spacing / FLOAT_STEPS)
                return bvxi_fail_for(
                    ctx, BVX_ERR_RANGE, BVX_REASON_FLOATS_COARSE,
                    "%s: at %g f32 has steps of %g, too coarse for voxels of %g; take f64 or a local frame",
                    function, most, float_step(most), spacing);
        }
        return BVX_OK;
    }
    if (*position_type == BVX_POSITION_AUTO) *position_type = bvxi_fits_f32(grid, origin) ? BVX_F32 : BVX_F64;
    return BVX_OK;
}

bvx_status bvxi_check_f64(bvx_context *ctx, const char *function, const bvx_grid *grid,
                          const double origin[3])
{
    for (int32_t a = 0; a < 3; a++) {
        double const spacing = grid->lattice.spacing[a], most = farthest_coordinate(grid, origin, a);
        if (!(most <= spacing * 17592186044416.0)) /* 2^44, so that 2^-53 of it is 1/512 of a voxel */
            return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_DOUBLES_COARSE,
                                 "%s: at %g doubles are too coarse for voxels of %g; take a local frame",
                                 function, most, spacing);
    }
    return BVX_OK;
}

/* Cells by their low corner: from the layer before the window to its last voxel, less open sides. */
static void choose_cells(bvxi_march *m)
{
    int32_t const nx = m->grid->size[0];

    /* A closed side has one more layer of cells, half outside: their outer corners are empty and close it. */
    for (int32_t a = 0; a < 3; a++) {
        m->cell_low[a] = (m->options.open_sides >> (2 * a) & 1) != 0 ? 0 : -1;
        m->cell_high[a] = m->grid->size[a] - ((m->options.open_sides >> (2 * a + 1) & 1) != 0 ? 2 : 1);
    }
    m->no_cells = m->cell_high[0] < m->cell_low[0] || m->cell_high[1] < m->cell_low[1] ||
                  m->cell_high[2] < m->cell_low[2];

    /* Cells and x-edges are shifted by one bit against voxels, so a row of them may need one word more. */
    m->edge_words = nx / 64 + 1;
    m->first_mask = ~UINT64_C(0) << (m->cell_low[0] + 1); /* cell -1 is bit 0 */
    m->past_mask = bvxi_grid_past(m->grid);
    int32_t const last_bit = (m->cell_high[0] + 1) - (m->edge_words - 1) * 64;
    m->last_mask = last_bit < 0 ? 0 : last_bit >= 63 ? ~UINT64_C(0) : (UINT64_C(2) << last_bit) - 1;
}

static bvx_status number_slots(bvx_context *ctx, bvxi_march *m)
{
    uint64_t vertices = 0, triangles = 0, past = 0;

    for (int32_t p = 0; p < m->pieces; p++) {
        vertices += m->piece_counts[3 * p];
        triangles += m->piece_counts[3 * p + 1];
        past |= m->piece_counts[3 * p + 2];
    }

    /* Bits past a row's end would become cells that do not exist. They are found while counting, which reads
     * every word anyway. */
    if (past != 0) return bvxi_grid_fail_past(ctx, m->function, m->grid);
    if (vertices >= UINT32_MAX || triangles >= UINT32_MAX)
        return bvxi_fail_for(
            ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
            "%s: the surface has %u vertices and %u triangles; 2^32 - 1 are possible, extract it by windows",
            m->function, vertices, triangles);
    m->vertex_count = vertices;
    m->triangle_count = triangles;
    vertices = triangles = 0;

    /* Prefix sums in the order of slots, x before y before z within one: the canonical order of vertices. */
    for (uint64_t s = 0; s < m->slot_count; s++) {
        bvxi_slot *const slot = &m->slots[s];
        uint32_t const x = slot->edge[0], y = slot->edge[1], z = slot->edge[2], t = slot->triangle;
        slot->edge[0] = (uint32_t)vertices;
        slot->edge[1] = (uint32_t)(vertices + x);
        slot->edge[2] = (uint32_t)(vertices + x + y);
        slot->triangle = (uint32_t)triangles;
        vertices += (uint64_t)x + y + z;
        triangles += t;
    }

    /* One slot past the end, so that a row's count is its successor's first number less its own. */
    memset(&m->slots[m->slot_count], 0, sizeof *m->slots);
    m->slots[m->slot_count].edge[0] = (uint32_t)vertices;
    m->slots[m->slot_count].triangle = (uint32_t)triangles;
    return BVX_OK;
}

/* ---- the first pass: crossings and triangles of each row of cells ---- */

/* The bits at or past size[0] set in the slot's first row: every row is the first of one slot. */
BVXI_VECTOR_INLINE uint64_t count_slot(const bvxi_march *m, uint64_t slot, int fast)
{
    bvxi_slot *const s = &m->slots[slot];
    const uint8_t *const triangles = bvxi_cell_triangle_count[m->options.face_rule];
    int32_t const words = m->grid->words_per_row;
    uint32_t n[3] = {0, 0, 0}, triangle_count = 0;
    const uint64_t *row[4];
    bvxi_case_list cases;
    uint64_t has[4]; /* all ones where the slot owns what it counts */
    int32_t j, k;

    bvxi_slot_row(m, slot, &j, &k);
    bvxi_cell_rows(m, j, k, row);
    for (int32_t a = 0; a < 4; a++) has[a] = bvxi_slot_has(m, a, j, k) ? ~UINT64_C(0) : 0;

    /* By blocks of words, so that the cases of active cells are listed and then counted in one loop. */
    for (int32_t first = 0; first < m->edge_words; first += BVXI_CELL_BLOCK) {
        int32_t const block = m->edge_words - first < BVXI_CELL_BLOCK ? m->edge_words - first
                                                                      : BVXI_CELL_BLOCK;
        cases.count = 0;
        for (uint32_t busy = bvxi_busy_words(row, first, block, words); busy != 0; busy &= busy - 1) {
            int32_t const w = first + bvxi_lowest(busy);
            uint64_t const visited = bvxi_visited(m, w);
            bvxi_cell_words c;
            bvxi_load_cells(row, w, words, &c);
            /* Edges are owned by the slot at their low end, so none is counted twice. */
            n[0] += bvxi_count_bits((c.low[0] ^ c.high[0]) & visited & has[0], fast);
            n[1] += bvxi_count_bits((c.high[0] ^ c.high[1]) & has[1], fast);
            n[2] += bvxi_count_bits((c.high[0] ^ c.high[2]) & has[2], fast);
            uint64_t const active = bvxi_active_cells(&c) & visited & has[3];
#if BVXI_HAVE_AVX2
            if (fast) {
                bvxi_list_cases_bmi2(&cases, &c, active);
                continue;
            }
#endif
            bvxi_list_cases(&cases, &c, active);
        }
        for (uint32_t i = 0; i < cases.count; i++) triangle_count += triangles[cases.number[i]];
    }
    for (int32_t a = 0; a < 3; a++) s->edge[a] = n[a];
    s->triangle = triangle_count;
    return row[0][words - 1] & m->past_mask;
}

BVXI_VECTOR_INLINE void count_piece(bvxi_march *m, int32_t piece, int fast)
{
    uint64_t begin, end, vertices = 0, triangles = 0, past = 0;
    bvxi_piece(m->slot_count, m->pieces, piece, &begin, &end);
    for (uint64_t s = begin; s < end; s++) {
        past |= count_slot(m, s, fast);
        vertices += (uint64_t)m->slots[s].edge[0] + m->slots[s].edge[1] + m->slots[s].edge[2];
        triangles += m->slots[s].triangle;
    }
    m->piece_counts[3 * piece] = vertices;
    m->piece_counts[3 * piece + 1] = triangles;
    m->piece_counts[3 * piece + 2] = past;
}

BVXI_AVX2_COPY(count_piece_avx2, (bvxi_march * m, int32_t piece), count_piece(m, piece, 1))

static void march_count_piece(void *march, int32_t piece)
{
    bvxi_march *const m = march;
    BVXI_PATH(m->cpu == BVX_CPU_AVX2, count_piece(m, piece, 0), count_piece_avx2(m, piece));
}

bvx_status bvxi_march_open(bvx_context *ctx, bvxi_march *m, const bvx_grid *grid,
                           const bvx_extract_options *options)
{
    BVXI_TRY(bvxi_grid_check(ctx, m->function, grid));
    m->options = *options;

    bvx_extract_options *const o = &m->options;
    BVXI_TRY(bvxi_check_options(ctx, m->function, o, BVXI_OPTIONS(extract_rows)));
    /* A key packs three coordinates of 20 bits and an axis into one word, which merging sorts by. */
    for (int32_t a = 0; o->keys && a < 3; a++)
        if (grid->lattice.dims[a] >= 1 << 20)
            return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                                 "%s: keys hold lattices of up to %d voxels along an axis, this one has %d",
                                 m->function, (int64_t)(1 << 20) - 1, (int64_t)grid->lattice.dims[a]);

    m->grid = grid;
    m->cpu = bvxi_cpu(ctx);
    for (int32_t a = 0; a < 3; a++) {
        m->spacing[a] = grid->lattice.spacing[a];
        m->origin[a] = options->local_frame ? 0.0 : grid->lattice.origin[a];
    }
    BVXI_TRY(bvxi_choose_position_type(ctx, m->function, grid, m->origin, &m->options.position_type));
    choose_cells(m);
    m->slot_count = ((uint64_t)grid->size[1] + 1) * ((uint64_t)grid->size[2] + 1);

    /* How the work is divided follows from the shape only, never from the number of threads. */
    m->pieces = bvxi_piece_count(m->slot_count, SLOT_GRAIN);
    BVXI_TRY(BVXI_ARRAY(ctx, (m->slot_count + 1), "the rows' vertex indices", m->slots));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, (uint64_t)m->pieces * 24, "the counts", &m->piece_counts));
    BVXI_TRY(BVXI_ZEROS(ctx, grid->words_per_row, "an empty row", m->empty_row));
    BVXI_TRY(bvxi_each(ctx, "surface", 0.0, 0.35, m->pieces, march_count_piece, m));
    return number_slots(ctx, m);
}

/* ---- keys, by which the surfaces of windows merge into the whole's ---- */

/* Vertices: (z, y, axis, x) of their edge's low end, triangles: (z, y, x) of their cell's low corner, lattice
 * indices plus one, 20 bits each: their order is the order of the whole's arrays. */

static uint64_t make_key(const bvxi_march *m, int32_t i, int32_t j, int32_t k, int32_t axis)
{
    const int32_t *const low = m->grid->low;
    return (uint64_t)(low[2] + k + 1) << 42 | (uint64_t)(low[1] + j + 1) << 22 | (uint64_t)axis << 20 |
           (uint64_t)(low[0] + i + 1);
}

static uint64_t *key_bits(const bvxi_march *m, uint64_t mask, int32_t w, int32_t j, int32_t k, int32_t axis,
                          uint64_t *out)
{
    for (; mask != 0; mask &= mask - 1)
        *out++ = make_key(m, w * 64 + bvxi_lowest(mask) - (axis == 0), j, k, axis);
    return out;
}

static void key_slots(void *march, uint64_t begin, uint64_t end)
{
    const bvxi_march *const m = march;
    const uint8_t *const triangles = bvxi_cell_triangle_count[m->options.face_rule];

    for (uint64_t slot = begin; slot < end; slot++) {
        const bvxi_slot *const s = &m->slots[slot];
        uint64_t *out[3], *triangle = m->mesh->triangle_keys + s->triangle;
        const uint64_t *row[4];
        int32_t j, k;

        bvxi_slot_row(m, slot, &j, &k);
        bvxi_cell_rows(m, j, k, row);
        for (int32_t a = 0; a < 3; a++) out[a] = m->mesh->vertex_keys + s->edge[a];
        for (int32_t w = 0; w < m->edge_words; w++) {
            uint64_t const visited = bvxi_visited(m, w);
            bvxi_cell_words c;
            bvxi_load_cells(row, w, m->grid->words_per_row, &c);
            if (bvxi_slot_has(m, 0, j, k))
                out[0] = key_bits(m, (c.low[0] ^ c.high[0]) & visited, w, j, k, 0, out[0]);
            if (bvxi_slot_has(m, 1, j, k)) out[1] = key_bits(m, c.high[0] ^ c.high[1], w, j, k, 1, out[1]);
            if (bvxi_slot_has(m, 2, j, k)) out[2] = key_bits(m, c.high[0] ^ c.high[2], w, j, k, 2, out[2]);
            if (!bvxi_slot_has(m, 3, j, k)) continue;
            for (uint64_t active = bvxi_active_cells(&c) & visited; active != 0; active &= active - 1) {
                int32_t const i = bvxi_lowest(active);
                /* A cell's triangles have one key: a stable sort keeps their order. */
                for (uint8_t n = triangles[bvxi_cell_case(&c, i)]; n > 0; n--)
                    *triangle++ = make_key(m, w * 64 + i - 1, j, k, 0);
            }
        }
    }
}

/* ---- the call ---- */

bvx_status bvxi_march_fill(bvx_context *ctx, bvxi_march *m, bvx_mesh *mesh)
{
    int const mine = mesh->positions == NULL;

    /* x of every edge's middle (bit e lies between centres e-1 and e) and of every centre (bit i). */
    int32_t const n = m->grid->size[0] + 2;
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, ((uint64_t)m->grid->size[0] + 2) * 2 * sizeof(double),
                        "the columns' positions", &m->across[0]));
    m->across[1] = m->across[0] + n;
    /* From the lattice index, not by adding up spacings, so that a window has the positions of the whole. */
    for (int32_t i = 0; i < n; i++) {
        m->across[0][i] = m->origin[0] + (double)(m->grid->low[0] + i) * m->spacing[0];
        m->across[1][i] = m->origin[0] + ((double)(m->grid->low[0] + i) + 0.5) * m->spacing[0];
    }

    /* Exact counts are known by now: arrays are made once, and pieces write their own parts. */
    BVXI_TRY(bvxi_mesh_open(ctx, m->function, m->options.position_type, m->options.keys, m->vertex_count,
                            m->triangle_count, mesh));
    if (m->options.local_frame) memcpy(mesh->frame, m->grid->lattice.origin, sizeof mesh->frame);
    m->mesh = mesh;
    bvx_status status = bvxi_each(ctx, "surface", 0.35, 1.0, m->pieces, bvxi_march_emit_piece, m);
    if (status == BVX_OK && m->options.keys)
        status = bvxi_for_ranges(ctx, "surface", 1.0, 1.0, m->pieces, m->slot_count, key_slots, m);
    return bvxi_mesh_made(ctx, status, mine, mesh);
}

static bvx_status run_extract_count(bvx_context *context, const bvx_grid *grid,
                                    const bvx_extract_options *options, uint64_t *vertex_count,
                                    uint64_t *triangle_count)
{
    static const char name[] = "bvx_extract_count";
    bvx_extract_options o;
    bvxi_march m = {0};
    if (vertex_count == NULL || triangle_count == NULL) return bvxi_fail_null(context, name, "a count");
    BVXI_TRY(bvxi_take_options(context, name, options, &o, sizeof o));
    m.function = name;
    BVXI_TRY(bvxi_march_open(context, &m, grid, &o));
    *vertex_count = m.vertex_count;
    *triangle_count = m.triangle_count;
    return BVX_OK;
}

bvx_status bvx_extract_count(bvx_context *context, const bvx_grid *grid, const bvx_extract_options *options,
                             uint64_t *vertex_count, uint64_t *triangle_count)
{
    return BVXI_CALL(context, run_extract_count(context, grid, options, vertex_count, triangle_count));
}

static bvx_status run_extract_surface(bvx_context *context, const bvx_grid *grid,
                                      const bvx_extract_options *options, bvx_mesh *mesh)
{
    static const char name[] = "bvx_extract_surface";
    bvx_extract_options o;
    bvxi_march m = {0};
    if (mesh == NULL) return bvxi_fail_null(context, name, "mesh");
    BVXI_TRY(bvxi_take_options(context, name, options, &o, sizeof o));
    m.function = name;
    BVXI_TRY(bvxi_march_open(context, &m, grid, &o));
    return bvxi_march_fill(context, &m, mesh);
}

bvx_status bvx_extract_surface(bvx_context *context, const bvx_grid *grid, const bvx_extract_options *options,
                               bvx_mesh *mesh)
{
    return BVXI_CALL(context, run_extract_surface(context, grid, options, mesh));
}
