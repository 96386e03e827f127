/* face_rectangles.c - exposed voxel faces of one plane and side merged into rectangles.
 *
 * Idea: the faces of a plane are bits of rows; the first one left (z, y, x) begins a rectangle as long as its
 * run, which grows row by row while the next one holds the whole run. Planes across y and z are rows of
 * voxels as they lie, those across x come from blocks of 64 x 64 bits turned over. Rectangles are counted,
 * then listed; their corners are bits whose rank is the vertex.
 * Guarantee: each exposed face lies in one rectangle; planes by axis x, y, z, then rising, the side of the
 * normal along - before the one along +, in a plane by their first faces; no thread shows in it. */
#include "bits/runs.h"
#include "surface/faces.h"

/* ---- counts and the mesh, of single faces too ---- */

bvx_status bvxi_faces_check_counts(bvx_context *ctx, const bvxi_faces *f)
{
    if (f->vertex_count < UINT32_MAX && f->face_count < UINT32_MAX / 2) return BVX_OK;
    return bvxi_fail_for(
        ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
        "%s: the faces have %u vertices and %u triangles; 2^32 - 1 are possible, extract them by windows",
        f->function, f->vertex_count, 2 * f->face_count);
}

bvx_status bvxi_faces_open_mesh(bvx_context *ctx, bvxi_faces *f, bvx_mesh *mesh)
{
    BVXI_TRY(bvxi_mesh_open(ctx, f->function, f->options.position_type, 0, f->vertex_count, 2 * f->face_count,
                            mesh));
    if (f->options.local_frame) memcpy(mesh->frame, f->grid->lattice.origin, sizeof mesh->frame);
    f->mesh = mesh;
    return BVX_OK;
}

/* ---- rectangles ---- */

enum { RECTANGLE_GRAIN = 4096 };

/* Faces [u0, u1) x [v0, v1) of a plane: across x u is y and v is z; across y x and z; across z x and y. */
typedef struct face_rectangle {
    int32_t axis, positive, plane, u0, u1, v0, v1;
} face_rectangle;

typedef struct face_merge {
    bvxi_faces *f;
    int32_t tasks; /* blocks of 64 planes across x, planes across y, planes across z */
    /* rectangles before each task's (counts before the prefix sum) [Size: tasks + 1] */
    uint64_t *before;
    uint64_t *scratch;      /* bits of planes, by worker */
    uint64_t scratch_words; /* of one worker */
    face_rectangle *list;   /* NULL: only count */
    uint64_t *corners;      /* used ones, rows of f->words */
    uint32_t *prefix;
    bvxi_rank rank;
} face_merge;

/* The first clear bit from a set one on, or the end of the words. */
static int32_t end_of_run(const uint64_t *row, int32_t words, int32_t begin)
{
    int32_t k = begin / BVXI_WORD_BITS;
    uint64_t clear = ~row[k] & ~UINT64_C(0) << (begin % BVXI_WORD_BITS);
    while (clear == 0) {
        if (++k == words) return words * BVXI_WORD_BITS;
        clear = ~row[k];
    }
    return k * BVXI_WORD_BITS + bvxi_lowest(clear);
}

/* Clear a run; 0 when not all of it was set, and nothing is done. */
static int take_run(uint64_t *row, int32_t begin, int32_t end)
{
    int32_t const first = begin / BVXI_WORD_BITS, last = (end - 1) / BVXI_WORD_BITS;
    /* First look, then clear: a run that is not whole stays for a rectangle of its own. */
    for (int32_t k = first; k <= last; k++)
        if ((~row[k] & bvxi_run_mask(begin, end, k)) != 0) return 0;
    for (int32_t k = first; k <= last; k++) row[k] &= ~bvxi_run_mask(begin, end, k);
    return 1;
}

/* The faces of one plane that look one way: a bit each; used up. */
typedef struct face_plane {
    uint64_t *bits;
    int32_t rows, words;
    int32_t axis, positive, plane;
} face_plane;

/* Cut a plane's bits into rectangles from number `at` on; list may be NULL. Returns the next number. */
static uint64_t cut_plane(const face_merge *m, const face_plane *p, uint64_t at)
{
    int32_t const rows = p->rows, words = p->words;

    for (int32_t v = 0; v < rows; v++) {
        uint64_t *const row = p->bits + (size_t)v * (size_t)words;

        /* The lowest face left begins the next rectangle. */
        for (int32_t k = 0; k < words; k++)
            while (row[k] != 0) {
                int32_t const begin = k * BVXI_WORD_BITS + bvxi_lowest(row[k]);
                int32_t const end = end_of_run(row, words, begin);
                int32_t next = v + 1;
                take_run(row, begin, end);
                while (next < rows && take_run(p->bits + (size_t)next * (size_t)words, begin, end)) next++;
                if (m->list != NULL) {
                    face_rectangle const r = {p->axis, p->positive, p->plane, begin, end, v, next};
                    m->list[at] = r; /* Counting and listing go the same way, so numbers agree. */
                }
                at++;
            }
    }
    return at;
}

/* Across y or z, at the corners of index i along it. */
static uint64_t cut_across(const face_merge *m, uint64_t *bits, int32_t axis, int32_t i, uint64_t at)
{
    const bvxi_faces *const f = m->f;
    int32_t const words = f->grid->words_per_row, rows = f->grid->size[3 - axis];

    /* The two sides apart: faces that look the other way never join a rectangle. */
    for (int32_t positive = 0; positive < 2; positive++) {
        for (int32_t r = 0; r < rows; r++) {
            /* The set voxel lies before the corners where its face looks up. */
            int32_t const set = i - positive, other = i - !positive;
            const uint64_t *const own = axis == 1 ? bvxi_face_voxels(f, f->own, set, r)
                                                  : bvxi_face_voxels(f, f->own, r, set);
            const uint64_t *const beyond = axis == 1 ? bvxi_face_voxels(f, f->grid, other, r)
                                                     : bvxi_face_voxels(f, f->grid, r, other);
            for (int32_t w = 0; w < words; w++)
                bits[(size_t)r * (size_t)words + (size_t)w] = own[w] & ~beyond[w];
        }
        face_plane const plane = {bits, rows, words, axis, positive, i};
        at = cut_plane(m, &plane, at);
    }
    return at;
}

/* The 64 planes across x at the corners of word w. Turned over, each plane's bits run along y. */
static uint64_t cut_across_x(const face_merge *m, uint64_t *bits, int32_t w, uint64_t at)
{
    const bvxi_faces *const f = m->f;
    int32_t const ny = f->grid->size[1], nz = f->grid->size[2], words = bvxi_row_words(ny);
    size_t const plane_words = (size_t)words * (size_t)nz;
    uint64_t *const sides[2] = {bits, bits + 64 * plane_words};

    /* 64 planes at once, since a word holds one bit of each: turned over, each plane has its own words. */
    for (int32_t k = 0; k < nz; k++)
        for (int32_t v = 0; v < words; v++) {
            uint64_t block[2][64];
            for (int32_t n = 0; n < 64; n++) {
                int32_t const j = v * 64 + n; /* beyond the window rows are empty */
                uint64_t before, own_before;
                uint64_t const here = bvxi_face_word(f, bvxi_face_voxels(f, f->grid, j, k), w, &before);
                uint64_t const own = bvxi_face_word(f, bvxi_face_voxels(f, f->own, j, k), w, &own_before);
                block[0][n] = own & ~before;
                block[1][n] = own_before & ~here;
            }
            for (int s = 0; s < 2; s++) {
                bvxi_transpose_64(block[s]);
                for (size_t i = 0; i < 64; i++)
                    sides[s][i * plane_words + (size_t)k * (size_t)words + (size_t)v] = block[s][i];
            }
        }

    /* Plane after plane, both sides of one before the next: the order of the result. */
    for (int32_t i = 0; i < 64; i++)
        for (int32_t s = 0; s < 2; s++) {
            face_plane const plane = {sides[s] + (size_t)i * plane_words, nz, words, 0, s, w * 64 + i};
            at = cut_plane(m, &plane, at);
        }
    return at;
}

static void cut_task(void *user, int32_t task, int32_t worker)
{
    face_merge *const m = user;
    const bvxi_faces *const f = m->f;
    uint64_t *const bits = m->scratch + (size_t)worker * m->scratch_words;
    int32_t const across_y = task - f->words, across_z = across_y - (f->grid->size[1] + 1);
    uint64_t const from = m->list != NULL ? m->before[task] : 0;
    uint64_t const to = across_y < 0   ? cut_across_x(m, bits, task, from)
                        : across_z < 0 ? cut_across(m, bits, 1, across_y, from)
                                       : cut_across(m, bits, 2, across_z, from);
    /* The first run only counts. Prefix sums then give every task its place in the list. */
    if (m->list == NULL) m->before[task] = to;
}

/* The rectangle's corners as numbers of bits; counter-clockwise seen from the positive side. */
static void rectangle_corners(const face_merge *m, const face_rectangle *r, uint64_t bit[4])
{
    /* ends of u (1) and v (2) */
    static const uint8_t turn[3][4] = {{0, 1, 3, 2}, {0, 2, 3, 1}, {0, 1, 3, 2}};
    for (int n = 0; n < 4; n++) {
        int32_t const u = (turn[r->axis][n] & 1) != 0 ? r->u1 : r->u0;
        int32_t const v = (turn[r->axis][n] & 2) != 0 ? r->v1 : r->v0;
        int32_t const i = r->axis == 0 ? r->plane : u, j = r->axis == 0 ? u : r->axis == 1 ? r->plane : v;
        int32_t const k = r->axis == 2 ? r->plane : v;
        uint64_t const row = (uint64_t)k * ((uint64_t)m->f->grid->size[1] + 1) + (uint64_t)j;
        bit[n] = row * (uint64_t)m->f->words * BVXI_WORD_BITS + (uint64_t)i;
    }
}

static void emit_corner_rows(void *user, uint64_t begin, uint64_t end)
{
    const face_merge *const m = user;
    const bvxi_faces *const f = m->f;
    uint64_t const rows = (uint64_t)f->grid->size[1] + 1;

    /* A piece begins with the rank of its first bit and counts from there, so none waits for another. */
    uint64_t vertex = bvxi_rank_before(&m->rank, begin * (uint64_t)f->words * BVXI_WORD_BITS);
    for (uint64_t row = begin; row < end; row++) {
        const uint64_t *const corners = m->corners + (size_t)row * (size_t)f->words;
        double const y = bvxi_corner_along(f, 1, (int32_t)(row % rows));
        double const z = bvxi_corner_along(f, 2, (int32_t)(row / rows));
        for (int32_t w = 0; w < f->words; w++) {
            bvxi_put_corners(f, corners[w], w, vertex, y, z);
            vertex += bvxi_popcount(corners[w]);
        }
    }
}

static void emit_rectangles(void *user, uint64_t begin, uint64_t end)
{
    const face_merge *const m = user;
    for (uint64_t n = begin; n < end; n++) {
        uint64_t bit[4];
        rectangle_corners(m, &m->list[n], bit);
        bvxi_put_face(m->f->mesh->triangles + 6 * (size_t)n, bvxi_rank_before(&m->rank, bit[0]),
                      bvxi_rank_before(&m->rank, bit[1]), bvxi_rank_before(&m->rank, bit[2]),
                      bvxi_rank_before(&m->rank, bit[3]), m->list[n].positive);
    }
}

static bvx_status emit_merged(bvx_context *ctx, face_merge *m)
{
    BVXI_TRY(bvxi_for_ranges(ctx, "faces", 0.6, 0.8, m->f->pieces, m->f->row_count, emit_corner_rows, m));
    return BVXI_SHARE(ctx, 0.8, 1.0,
                      bvxi_for(ctx, "faces", m->f->face_count, RECTANGLE_GRAIN, emit_rectangles, m));
}

bvx_status bvxi_faces_merge(bvx_context *ctx, bvxi_faces *f, bvx_mesh *mesh)
{
    uint64_t const threads = (uint64_t)bvxi_threads(ctx), mark = bvxi_scratch_begin(ctx);
    face_merge m = {0};
    m.f = f;
    m.tasks = f->words + f->grid->size[1] + 1 + f->grid->size[2] + 1;

    /* Words of the largest planes' bits: all slices of 64 planes across x and both sides, or the rows of
     * one across y or z. */
    const bvx_grid *const g = f->grid;
    uint64_t const x = 128 * (uint64_t)bvxi_row_words(g->size[1]) * (uint64_t)g->size[2];
    uint64_t const across = (uint64_t)(g->size[1] > g->size[2] ? g->size[1] : g->size[2]) *
                            (uint64_t)g->words_per_row;
    m.scratch_words = x > across ? x : across;

    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, ((uint64_t)m.tasks + 1) * 8, "the planes' counts", &m.before));
    /* Scratch for each worker, as planes are cut side by side. */
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, threads * m.scratch_words * 8, "planes of faces", &m.scratch));
    BVXI_TRY(bvxi_parallel(ctx, "faces", 0.0, 0.3, m.tasks, cut_task, &m));
    m.f->face_count = bvxi_place_counts(m.before, (uint64_t)m.tasks);
    BVXI_TRY(bvxi_faces_check_counts(ctx, m.f));
    uint64_t const words = m.f->row_count * (uint64_t)m.f->words;
    BVXI_TRY(BVXI_ARRAY(ctx, m.f->face_count, "the rectangles", m.list));
    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, words * 8, "the corners", &m.corners));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, bvxi_rank_bytes(words), "the corners' ranks", &m.prefix));
    BVXI_TRY(bvxi_parallel(ctx, "faces", 0.3, 0.6, m.tasks, cut_task, &m));
    for (uint64_t n = 0; n < m.f->face_count; n++) {
        uint64_t bit[4];
        rectangle_corners(&m, &m.list[n], bit);
        /* Rectangles share corners: a bit is set as often as needed. */
        for (int c = 0; c < 4; c++)
            m.corners[bit[c] / BVXI_WORD_BITS] |= UINT64_C(1) << (bit[c] % BVXI_WORD_BITS);
    }

    m.f->vertex_count = bvxi_rank_build(&m.rank, m.corners, words, m.prefix);
    BVXI_TRY(bvxi_faces_check_counts(ctx, m.f));
    if (mesh == NULL) return bvxi_scratch_end(ctx, mark, BVX_OK);
    int const mine = mesh->positions == NULL;
    BVXI_TRY(bvxi_faces_open_mesh(ctx, m.f, mesh));
    return bvxi_scratch_end(ctx, mark, bvxi_mesh_made(ctx, emit_merged(ctx, &m), mine, mesh));
}
