/* faces.c - the faces between set and empty voxels as a mesh: bvx_extract_faces. Merged ones: face_rectangles.c.
 *
 * Idea: a face lies between two voxels of which one is set, and a corner belongs to a face exactly when its
 * eight voxels are not alike. So both are word operations on rows, and a corner's number is the rank of its
 * bit. A first pass counts corners and faces of each row of corners, prefix sums give every row its place, a
 * second pass writes.
 * Guarantee: each exposed face once, outwards, vertices shared, canonical order; no thread shows in it. */
#include "surface/faces.h"
#include "surface/march.h"

/* The four rows of voxels about a row of corners: (j - 1, k - 1), (j, k - 1), (j - 1, k), (j, k). */
typedef struct face_voxels {
    const uint64_t *row[4], *own[4];
} face_voxels;

static inline face_voxels voxels_about(const bvxi_faces *f, int32_t j, int32_t k)
{
    face_voxels v;
    for (int32_t n = 0; n < 4; n++) {
        v.row[n] = bvxi_face_voxels(f, f->grid, j - 1 + (n & 1), k - 1 + (n >> 1));
        v.own[n] = bvxi_face_voxels(f, f->own, j - 1 + (n & 1), k - 1 + (n >> 1));
    }
    return v;
}

/* Faces between voxels a and b; own: of those that are set, whose faces are the window's. */
static inline uint64_t exposed(uint64_t a, uint64_t own_a, uint64_t b, uint64_t own_b)
{
    return (own_a & ~b) | (own_b & ~a);
}

/* The same where some voxels are a neighbour's: corners of one of the twelve faces around them. */
static uint64_t used_own_corners(const bvxi_faces *f, const face_voxels *v, int32_t w)
{
    static const uint8_t pair[4][2] = {{0, 1}, {2, 3}, {0, 2}, {1, 3}};
    uint64_t at[2][4], own[2][4], used = 0;

    for (int32_t n = 0; n < 4; n++) {
        at[0][n] = bvxi_face_word(f, v->row[n], w, &at[1][n]);
        own[0][n] = bvxi_face_word(f, v->own[n], w, &own[1][n]);
        used |= exposed(at[0][n], own[0][n], at[1][n], own[1][n]);
    }
    for (int i = 0; i < 8; i++) {
        int const s = i & 1, a = pair[i >> 1][0], b = pair[i >> 1][1];
        used |= exposed(at[s][a], own[s][a], at[s][b], own[s][b]);
    }
    return used;
}

static inline uint64_t used_corners(const bvxi_faces *f, const face_voxels *v, int32_t w)
{
    uint64_t any = 0, all = ~UINT64_C(0);
    /* A corner is used where its eight voxels are not alike; of some voxels' faces only at such ones. */
    for (int32_t n = 0; n < 4; n++) {
        uint64_t before, here = bvxi_face_word(f, v->row[n], w, &before);
        any |= here | before;
        all &= here & before;
    }
    return f->own == f->grid || (any & ~all) == 0 ? any & ~all : used_own_corners(f, v, w);
}

/* Faces whose low corner is bit i of word w, by axis; behind: the positive sides are set. */
static inline void faces_of_word(const bvxi_faces *f, const face_voxels *v, int32_t j, int32_t k, int32_t w,
                                 uint64_t face[3], uint64_t *behind)
{
    uint64_t before, unused;
    uint64_t const here = bvxi_face_word(f, v->row[3], w, &before);
    uint64_t const below_y = bvxi_face_word(f, v->row[2], w, &unused);
    uint64_t const below_z = bvxi_face_word(f, v->row[1], w, &unused);
    uint64_t own = here, own_before = before, own_y = below_y, own_z = below_z;

    if (f->own != f->grid) {
        own = bvxi_face_word(f, v->own[3], w, &own_before);
        own_y = bvxi_face_word(f, v->own[2], w, &unused);
        own_z = bvxi_face_word(f, v->own[1], w, &unused);
    }
    /* A face stands at its low corner; the last rows have none beyond the window. */
    face[0] = j < f->grid->size[1] && k < f->grid->size[2] ? exposed(here, own, before, own_before) : 0;
    face[1] = k < f->grid->size[2] ? exposed(here, own, below_y, own_y) : 0;
    face[2] = j < f->grid->size[1] ? exposed(here, own, below_z, own_z) : 0;
    *behind = here;
}

static void corner_row(const bvxi_faces *f, uint64_t row, int32_t *j, int32_t *k)
{
    uint64_t const rows = (uint64_t)f->grid->size[1] + 1;
    *j = (int32_t)(row % rows);
    *k = (int32_t)(row / rows);
}

static void count_face_piece(void *user, uint64_t begin, uint64_t end)
{
    bvxi_faces *const f = user;
    for (uint64_t row = begin; row < end; row++) {
        uint32_t corners = 0, faces = 0;
        int32_t j, k;

        corner_row(f, row, &j, &k);
        face_voxels const v = voxels_about(f, j, k);
        for (int32_t w = 0; w < f->words; w++) {
            uint64_t const used = used_corners(f, &v, w);
            uint64_t face[3], behind;
            if (f->used != NULL) f->used[row] = used;
            if (used == 0) continue;
            corners += bvxi_popcount(used);
            faces_of_word(f, &v, j, k, w, face, &behind);
            for (int a = 0; a < 3; a++) faces += bvxi_popcount(face[a]);
        }
        f->rows[row].vertex = corners;
        f->rows[row].face = faces;
    }
}

/* Four rows of corners that faces from one row reach: (j, k), (j + 1, k), (j, k + 1), (j + 1, k + 1). */
typedef struct face_reach {
    face_voxels voxels[4];
    uint32_t first[4]; /* number of the word's first vertex */
    uint64_t used[4];
} face_reach;

/* The number of corner `bit` of row n; the next corner along x of the same face has the next number. */
static inline uint32_t corner_number(const face_reach *c, int32_t n, int32_t bit)
{
    return c->first[n] + bvxi_popcount(c->used[n] & ((UINT64_C(1) << bit) - 1));
}

static uint32_t *put_faces_at(const face_reach *c, const uint64_t face[3], uint64_t behind, int32_t bit,
                              uint32_t *out)
{
    uint32_t const low = corner_number(c, 0, bit);
    /* the set voxel lies on the negative side: outwards is the positive one */
    int const positive = (behind >> bit & 1) == 0;

    if ((face[0] >> bit & 1) != 0) {
        bvxi_put_face(out, low, corner_number(c, 1, bit), corner_number(c, 3, bit), corner_number(c, 2, bit),
                      positive);
        out += 6;
    }
    if ((face[1] >> bit & 1) != 0) { /* y: seen from its positive side z comes before x */
        uint32_t const back = corner_number(c, 2, bit);
        bvxi_put_face(out, low, back, back + 1, low + 1, positive);
        out += 6;
    }
    if ((face[2] >> bit & 1) != 0) {
        uint32_t const up = corner_number(c, 1, bit);
        bvxi_put_face(out, low, low + 1, up + 1, up, positive);
        out += 6;
    }
    return out;
}

static void emit_face_piece(void *user, uint64_t begin, uint64_t end)
{
    const bvxi_faces *const f = user;
    face_reach c;
    uint64_t last = UINT64_MAX - 1;

    /* last: the row that c is of; the next one shares half of what is about it. */
    for (uint64_t row = begin; row < end; row++) {
        uint32_t *out = f->mesh->triangles + 6 * (size_t)f->rows[row].face;
        int32_t j, k;

        /* No corner is used here. A face's low corner would be one, so there is no face either. */
        if (f->rows[row].vertex == f->rows[row + 1].vertex) continue;
        corner_row(f, row, &j, &k);
        double const y = bvxi_corner_along(f, 1, j), z = bvxi_corner_along(f, 2, k);
        for (int32_t n = 0; n < 4; n++) {
            uint64_t const at = row + (uint64_t)(n & 1) + (n >> 1 != 0 ? (uint64_t)f->grid->size[1] + 1 : 0);
            if (f->used != NULL) c.used[n] = at < f->row_count ? f->used[at] : 0;
            else if (j > 0 && last + 1 == row && (n & 1) == 0) c.voxels[n] = c.voxels[n + 1];
            else c.voxels[n] = voxels_about(f, j + (n & 1), k + (n >> 1));
            /* beyond the last rows there are no faces to ask */
            c.first[n] = at < f->row_count ? f->rows[at].vertex : 0;
        }
        if (f->used != NULL) c.voxels[0] = voxels_about(f, j, k);
        last = row;
        for (int32_t w = 0; w < f->words; w++) {
            uint64_t face[3], behind, any;

            /* The used corners of all four rows, so that a corner's number is a popcount away. */
            for (int32_t n = 0; n < 4 && f->used == NULL; n++) c.used[n] = used_corners(f, &c.voxels[n], w);
            bvxi_put_corners(f, c.used[0], w, c.first[0], y, z);
            faces_of_word(f, &c.voxels[0], j, k, w, face, &behind);
            any = face[0] | face[1] | face[2];
            for (; any != 0; any &= any - 1) out = put_faces_at(&c, face, behind, bvxi_lowest(any), out);
            for (int32_t n = 0; n < 4; n++) c.first[n] += bvxi_popcount(c.used[n]);
        }
    }
}

static bvx_status make_single_faces(bvx_context *ctx, bvxi_faces *f, bvx_mesh *mesh)
{
    uint64_t const bytes = (f->row_count + 1) * sizeof *f->rows;
    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, bytes, "the rows' numbers", &f->rows));
    /* Windows of a word, as chunks of a world are, keep what is counted. */
    if (f->words == 1) BVXI_TRY(BVXI_ARRAY(ctx, f->row_count, "the rows' corners", f->used));
    BVXI_TRY(bvxi_for_ranges(ctx, "faces", 0.0, 0.3, f->pieces, f->row_count, count_face_piece, f));
    f->vertex_count = f->face_count = 0;
    /* With 64 bits, as the sum may pass what is possible. */
    for (uint64_t row = 0; row < f->row_count; row++) {
        f->vertex_count += f->rows[row].vertex;
        f->face_count += f->rows[row].face;
    }
    BVXI_TRY(bvxi_faces_check_counts(ctx, f));

    uint32_t vertex = 0, face = 0;
    for (uint64_t row = 0; row <= f->row_count; row++) {
        bvxi_face_row const n = f->rows[row]; /* the last one is zero */
        f->rows[row].vertex = vertex;
        f->rows[row].face = face;
        vertex += n.vertex;
        face += n.face;
    }

    if (mesh == NULL) return BVX_OK;
    int const mine = mesh->positions == NULL;
    BVXI_TRY(bvxi_faces_open_mesh(ctx, f, mesh));
    return bvxi_mesh_made(
        ctx, bvxi_for_ranges(ctx, "faces", 0.3, 1.0, f->pieces, f->row_count, emit_face_piece, f), mine,
        mesh);
}

/* ---- the call ---- */

enum { FACE_GRAIN = 64 };

static const bvxi_option faces_rows[] = {
    BVXI_CHOICE(bvx_faces_options, position_type, BVX_POSITION_AUTO, BVX_F64),
    BVXI_SWITCH(bvx_faces_options, local_frame),
    BVXI_SWITCH(bvx_faces_options, merged),
    BVXI_WHOLE(bvx_faces_options, open_sides, 0, 63),
};

/* The grid, or those voxels of it that are named, without the outermost ones at open sides. */
static bvx_status open_own(bvx_context *ctx, bvxi_faces *f, bvx_grid *own)
{
    const bvx_grid *const of = f->options.of != NULL ? f->options.of : f->grid;
    int32_t const open = f->options.open_sides, *const size = f->grid->size;
    uint64_t const words = bvxi_grid_words(f->grid);
    uint64_t *row;

    f->own = f->grid;
    if (open == 0 && of == f->grid) return BVX_OK;
    *own = *f->grid;
    f->own = own;
    BVXI_TRY(BVXI_ARRAY(ctx, words, "the window's own voxels", own->words));
    for (uint64_t i = 0; i < words; i++) own->words[i] = f->grid->words[i] & of->words[i];
    row = own->words;
    for (int32_t k = 0; k < size[2]; k++)
        for (int32_t j = 0; j < size[1]; j++, row += own->words_per_row) {
            if (((open & BVX_OPEN_Y_LOW) != 0 && j == 0) || ((open & BVX_OPEN_Z_LOW) != 0 && k == 0) ||
                ((open & BVX_OPEN_Y_HIGH) != 0 && j + 1 == size[1]) ||
                ((open & BVX_OPEN_Z_HIGH) != 0 && k + 1 == size[2]))
                memset(row, 0, (size_t)own->words_per_row * 8);
            if ((open & BVX_OPEN_X_LOW) != 0) row[0] &= ~UINT64_C(1);
            if ((open & BVX_OPEN_X_HIGH) != 0)
                row[(size[0] - 1) / BVXI_WORD_BITS] &= ~(UINT64_C(1) << (size[0] - 1) % BVXI_WORD_BITS);
        }
    return BVX_OK;
}

static bvx_status run_extract_faces(bvx_context *ctx, const bvx_grid *grid, const bvx_faces_options *options,
                                    bvx_mesh *mesh)
{
    bvxi_faces faces = {.function = "bvx_extract_faces", .grid = grid}, *const f = &faces;
    bvx_faces_options *const o = &f->options;
    bvx_grid own;
    uint64_t *empty;

    if (mesh == NULL) return bvxi_fail_null(ctx, f->function, "mesh");
    BVXI_TRY(bvxi_take_options(ctx, f->function, options, o, sizeof *o));
    BVXI_TRY(bvxi_grid_check(ctx, f->function, grid));
    BVXI_TRY(bvxi_grid_check_past(ctx, f->function, grid));
    BVXI_TRY(bvxi_check_options(ctx, f->function, o, BVXI_OPTIONS(faces_rows)));
    if (o->of != NULL) {
        BVXI_TRY(bvxi_grid_check(ctx, "bvx_extract_faces, of", o->of));
        BVXI_TRY(bvxi_grid_same(ctx, f->function, grid, o->of));
    }
    for (int32_t a = 0; a < 3; a++) {
        f->spacing[a] = grid->lattice.spacing[a];
        f->origin[a] = o->local_frame ? 0.0 : grid->lattice.origin[a];
    }
    BVXI_TRY(bvxi_choose_position_type(ctx, f->function, grid, f->origin, &f->options.position_type));

    /* A row of corners more than of voxels: the last voxels' high sides. */
    f->words = grid->size[0] / BVXI_WORD_BITS + 1;
    f->row_count = ((uint64_t)grid->size[1] + 1) * ((uint64_t)grid->size[2] + 1);
    f->pieces = bvxi_piece_count(f->row_count, FACE_GRAIN);
    uint64_t const empty_bytes = (uint64_t)grid->words_per_row * 8;
    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, empty_bytes, "an empty row", &empty));
    f->empty_row = empty;
    BVXI_TRY(open_own(ctx, f, &own));
    return f->options.merged ? bvxi_faces_merge(ctx, f, mesh) : make_single_faces(ctx, f, mesh);
}

bvx_status bvx_extract_faces(bvx_context *context, const bvx_grid *grid, const bvx_faces_options *options,
                             bvx_mesh *mesh)
{
    return BVXI_CALL(context, run_extract_faces(context, grid, options, mesh));
}
