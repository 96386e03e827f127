/* fuzz_input.h - a fuzzer's bytes taken as structured input: numbers, meshes, lattices; and what every call
 * must keep.
 *
 * A target defines fuzz_one and includes this header: it is a libFuzzer target, and with BVX_FUZZ_MAIN a
 * program of its own:
 *   fuzz_stage [inputs [seed]]   that many random inputs from a fixed generator
 *   fuzz_stage FILE...           these inputs (a corpus) */
#ifndef FUZZ_INPUT_H
#define FUZZ_INPUT_H

#include "bitvox_io.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { FUZZ_MEMORY = 64 << 20, FUZZ_VERTICES = 96, FUZZ_TRIANGLES = 128 };

typedef struct fuzz_input {
    const uint8_t *data;
    size_t size, at;
} fuzz_input;

static void fuzz_one(fuzz_input *in);
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static const char *fuzz_place = ""; /* the corpus file that is tried */

static inline void fuzz_require(int good, const char *what)
{
    if (good) return;
    fprintf(stderr, "fuzz: %s %s\n", what, fuzz_place);
    abort();
}

/* ---- Numbers: after the end of the input all are 0 ---- */

static inline uint32_t fuzz_byte(fuzz_input *in)
{
    return in->at < in->size ? in->data[in->at++] : 0;
}

static inline int32_t fuzz_range(fuzz_input *in, int32_t low, int32_t high)
{
    uint32_t const n = (uint32_t)(high - low) + 1;
    uint32_t const v = n <= 256 ? fuzz_byte(in) : fuzz_byte(in) << 8 | fuzz_byte(in);
    return low + (int32_t)(v % n);
}

/* ---- Contexts ---- */

static inline bvx_context *fuzz_context_with(int32_t threads, int32_t cpu)
{
    bvx_context_options o = {.struct_size = sizeof o};
    bvx_context *ctx = NULL;

    o.threads = threads;
    o.cpu = cpu;
    o.memory_limit = FUZZ_MEMORY;
    fuzz_require(bvx_context_create(&o, &ctx) == BVX_OK, "no context");
    return ctx;
}

/* All is given back. */
static inline void fuzz_end(bvx_context *ctx)
{
    fuzz_require(bvx_memory_used(ctx) == 0, "memory that is not given back");
    bvx_context_destroy(ctx);
}

/* Calls that were good, and those that failed for a reason; a program that sees no good ones tests
 * nothing. */
static unsigned long fuzz_good_calls, fuzz_failed_calls;

/* 1: the call was good. Else it must say why in a line, and for a reason that these inputs can have. */
static inline int fuzz_good(bvx_context *ctx, bvx_status status)
{
    const char *const message = bvx_last_message(ctx);

    if (status == BVX_OK) {
        fuzz_good_calls++;
        return 1;
    }
    fuzz_failed_calls++;
    fuzz_require(strlen(message) > 10 && strchr(message, '\n') == NULL, "a failure without a line of words");
    fuzz_require(status == BVX_ERR_EMPTY || status == BVX_ERR_RANGE || status == BVX_ERR_BUDGET ||
                     status == BVX_ERR_MEMORY,
                 message);
    return 0;
}

static inline void fuzz_must(bvx_context *ctx, bvx_status status)
{
    fuzz_require(status == BVX_OK, bvx_last_message(ctx));
}

/* ---- Meshes ---- */

typedef struct fuzz_mesh {
    double v[FUZZ_VERTICES][3];
    uint32_t t[FUZZ_TRIANGLES][3];
    uint32_t vertices, triangles;
    int closed; /* 1: every edge has as many triangles one way as the other */
    bvx_mesh_view view;
} fuzz_mesh;

/* On a coarse grid, so that ties, coplanar and equal things are common; or anywhere. */
static inline double fuzz_coordinate(fuzz_input *in, int fine)
{
    if (!fine) return fuzz_range(in, 0, 32) / 4.0;
    return fuzz_range(in, 0, 65535) / 8192.0;
}

static inline void fuzz_triangle(fuzz_mesh *m, uint32_t a, uint32_t b, uint32_t c)
{
    if (m->triangles == FUZZ_TRIANGLES) return;
    m->t[m->triangles][0] = a;
    m->t[m->triangles][1] = b;
    m->t[m->triangles][2] = c;
    m->triangles++;
}

/* A tetrahedron (4 vertices) or a box (8); inside out where the input says so. */
static inline void fuzz_solid_part(fuzz_input *in, fuzz_mesh *m, int fine)
{
    static const uint32_t box[12][3] = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                                        {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
    static const uint32_t tetrahedron[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
    int const kind = fuzz_range(in, 0, 3);
    uint32_t const first = m->vertices, corners = (kind & 1) != 0 ? 8 : 4, faces = (kind & 1) != 0 ? 12 : 4;

    if (first + corners > FUZZ_VERTICES || m->triangles + faces > FUZZ_TRIANGLES) return;
    if (corners == 8) {
        double low[3], high[3];
        for (int a = 0; a < 3; a++) {
            low[a] = fuzz_coordinate(in, fine);
            high[a] = low[a] + fuzz_coordinate(in, fine);
        }
        for (uint32_t c = 0; c < 8; c++)
            for (uint32_t a = 0; a < 3; a++) m->v[first + c][a] = (c >> a & 1) != 0 ? high[a] : low[a];
    } else {
        for (uint32_t c = 0; c < 4; c++)
            for (uint32_t a = 0; a < 3; a++) m->v[first + c][a] = fuzz_coordinate(in, fine);
    }
    m->vertices += corners;
    for (uint32_t f = 0; f < faces; f++) {
        const uint32_t *const t = corners == 8 ? box[f] : tetrahedron[f];
        fuzz_triangle(m, first + t[0], first + t[(kind & 2) != 0 ? 2 : 1],
                      first + t[(kind & 2) != 0 ? 1 : 2]);
    }
}

/* Closed parts, a soup of triangles over few vertices, or both; then some
 * triangles are dropped, turned or doubled. */
static inline void fuzz_take_mesh(fuzz_input *in, fuzz_mesh *m)
{
    int const kind = fuzz_range(in, 0, 7), fine = (kind & 4) != 0;

    memset(m, 0, sizeof *m);
    m->closed = (kind & 3) < 2;
    for (int parts = (kind & 3) == 3 ? 0 : fuzz_range(in, 1, 4); parts > 0; parts--)
        fuzz_solid_part(in, m, fine);
    if ((kind & 3) >= 2) {
        uint32_t const first = m->vertices, more = (uint32_t)fuzz_range(in, 3, 12);
        for (uint32_t n = 0; n < more && m->vertices < FUZZ_VERTICES; n++, m->vertices++)
            for (int a = 0; a < 3; a++) m->v[m->vertices][a] = fuzz_coordinate(in, fine);
        for (int n = fuzz_range(in, 1, 20); n > 0; n--) {
            uint32_t c[3];
            for (int a = 0; a < 3; a++)
                c[a] = first + (uint32_t)fuzz_range(in, 0, (int32_t)(m->vertices - first) - 1);
            fuzz_triangle(m, c[0], c[1], c[2]);
        }
    }
    if ((kind & 3) == 1) {
        m->closed = 0;
        for (int n = fuzz_range(in, 1, 4); n > 0 && m->triangles > 1; n--) {
            uint32_t const at = (uint32_t)fuzz_range(in, 0, (int32_t)m->triangles - 1);
            uint32_t const b = m->t[at][1];
            switch (fuzz_range(in, 0, 2)) {
            case 0:
                m->triangles--;
                memcpy(m->t[at], m->t[m->triangles], sizeof m->t[at]);
                break;
            case 1:
                m->t[at][1] = m->t[at][2];
                m->t[at][2] = b;
                break;
            default: fuzz_triangle(m, m->t[at][0], m->t[at][1], m->t[at][2]);
            }
        }
    }
    m->view.positions = m->v;
    m->view.indices = m->t;
    m->view.vertex_count = m->vertices;
    m->view.triangle_count = m->triangles;
    m->view.position_type = BVX_F64;
    m->view.index_type = BVX_U32;
}

/* Round the mesh, or somewhere over it; voxels of any sides. */
static inline int fuzz_take_lattice(fuzz_input *in, bvx_context *ctx, const fuzz_mesh *m, int32_t most,
                                    bvx_lattice *lattice)
{
    double origin[3], spacing[3];
    int32_t dims[3];

    if (fuzz_range(in, 0, 3) != 0) {
        bvx_lattice_options o = {.struct_size = sizeof o};
        o.resolution = fuzz_range(in, 1, most);
        o.padding = fuzz_range(in, 0, 2);
        return fuzz_good(ctx, bvx_lattice_fit_with(ctx, &m->view, &o, lattice));
    }
    for (int a = 0; a < 3; a++) {
        origin[a] = fuzz_range(in, -8, 16) / 4.0;
        spacing[a] = fuzz_range(in, 1, 12) / 8.0;
        dims[a] = fuzz_range(in, 1, a == 0 ? 2 * most : most);
    }
    return fuzz_good(ctx, bvx_lattice_make(ctx, origin, spacing, dims, lattice));
}

static inline bvx_window fuzz_take_window(fuzz_input *in, const bvx_lattice *lattice)
{
    bvx_window w;
    for (int a = 0; a < 3; a++) {
        w.low[a] = fuzz_range(in, 0, lattice->dims[a] - 1);
        w.size[a] = fuzz_range(in, 1, lattice->dims[a] - w.low[a]);
    }
    return w;
}

/* ---- Contracts ---- */

/* part's bits are those of whole there. */
static inline void fuzz_part_equals_whole(const bvx_grid *part, const bvx_grid *whole, const char *what)
{
    for (int32_t z = 0; z < part->size[2]; z++)
        for (int32_t y = 0; y < part->size[1]; y++)
            for (int32_t x = 0; x < part->size[0]; x++)
                fuzz_require(bvx_grid_get(part, x, y, z) == bvx_grid_get(whole,
                                                                         x + part->low[0] - whole->low[0],
                                                                         y + part->low[1] - whole->low[1],
                                                                         z + part->low[2] - whole->low[2]),
                             what);
}

static inline void fuzz_grids_equal(const bvx_grid *a, const bvx_grid *b, const char *what)
{
    uint64_t const words = (uint64_t)a->words_per_row * (uint64_t)a->size[1] * (uint64_t)a->size[2];
    fuzz_require(memcmp(a->size, b->size, sizeof a->size) == 0 &&
                     memcmp(a->words, b->words, (size_t)words * 8) == 0,
                 what);
}

/* Closed, manifold, oriented, and with a volume that is not negative;
 * nothing to hold of a mesh without triangles. */
static inline void fuzz_certified(bvx_context *ctx, const bvx_mesh *mesh, const char *what)
{
    bvx_mesh_view view;
    bvx_certificate c;
    if (mesh->triangle_count == 0) return;
    bvx_mesh_view_of(mesh, &view);
    fuzz_must(ctx, bvx_mesh_check(ctx, &view, 0, &c));
    fuzz_require(c.closed && c.edge_manifold && c.vertex_manifold && c.oriented && c.duplicates == 0 &&
                     c.volume >= 0,
                 what);
}

static inline void fuzz_meshes_equal(bvx_context *ctx, const bvx_mesh *a, const bvx_mesh *b, const char *what)
{
    uint64_t first = 0, second = 0;
    fuzz_must(ctx, bvx_mesh_hash(ctx, a, &first));
    fuzz_must(ctx, bvx_mesh_hash(ctx, b, &second));
    fuzz_require(first == second, what);
}

/* ---- Targets and programs ---- */

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    fuzz_input in;
    in.data = data;
    in.size = size;
    in.at = 0;
    fuzz_one(&in);
    return 0;
}

#if defined(BVX_FUZZ_MAIN)

enum { FUZZ_BYTES = 512 };

static inline void fuzz_write(const char *name, const void *bytes, size_t size)
{
    FILE *const file = fopen(name, "wb");
    fuzz_require(file != NULL, name);
    fuzz_require(fwrite(bytes, 1, size, file) == size && fclose(file) == 0, name);
}

/* Files as inputs, each in a block of its exact size, so that a sanitizer sees a read beyond the end. */
static inline int fuzz_corpus(int count, char **names)
{
    static uint8_t all[1 << 16];

    for (int i = 0; i < count; i++) {
        FILE *const file = fopen(names[i], "rb");
        uint8_t *bytes;
        size_t size;
        fuzz_require(file != NULL, names[i]);
        size = fread(all, 1, sizeof all, file);
        fclose(file);
        bytes = malloc(size > 0 ? size : 1);
        fuzz_require(bytes != NULL, "no memory");
        memcpy(bytes, all, size);
        fuzz_place = names[i];
        LLVMFuzzerTestOneInput(bytes, size);
        free(bytes);
    }
    printf("fuzz: %d files of a corpus, 0 failures\n", count);
    return 0;
}

#if !defined(FUZZ_FILES_H)

int main(int argc, char **argv)
{
    char *end = NULL;
    unsigned long inputs = 300, seed = 1;

    if (argc > 1) inputs = strtoul(argv[1], &end, 10);
    if (end != NULL && *end != 0) return fuzz_corpus(argc - 1, argv + 1);
    if (argc > 2) seed = strtoul(argv[2], NULL, 10);
    for (unsigned long i = 0; i < inputs; i++) {
        uint64_t state = (seed * 1000003 + i) * 2 + 1;
        uint8_t *bytes;
        size_t size;
        for (int n = 0; n < 8; n++) state ^= state << 13, state ^= state >> 7, state ^= state << 17;
        size = 8 + (size_t)(state >> 20) % (FUZZ_BYTES - 8);
        bytes = malloc(size); /* of exact size, so that a sanitizer sees a read beyond the end */
        fuzz_require(bytes != NULL, "no memory");
        for (size_t n = 0; n < size; n++) {
            state ^= state << 13, state ^= state >> 7, state ^= state << 17;
            bytes[n] = (uint8_t)(state >> 33);
        }
        LLVMFuzzerTestOneInput(bytes, size);
        free(bytes);
    }
    printf("fuzz: %lu inputs, %lu stages done, %lu refused, 0 failures\n", inputs, fuzz_good_calls,
           fuzz_failed_calls);
    return fuzz_good_calls > fuzz_failed_calls ? 0 : 1;
}

#endif

#endif

#endif
