/* read_support.h - what the tests of readers and writers share: files in
 * blocks of their exact size, and the checks that hold after every call. */
#ifndef TEST_READ_SUPPORT_H
#define TEST_READ_SUPPORT_H

#include "bitvox_io.h"
#include "mesh/mesh.h"
#include "mesh/polygon.h"
#include "tools/read_limits.h"

#include "suite.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void setUp(void)
{
    bvx_context_options o = suite_options(1, BVX_CPU_BEST);
    o.memory_limit = 64 << 20;
    suite_open_with(&o);
}

void tearDown(void)
{
    suite_close();
}

/* Numbers of texture coordinates in range, all of them finite. Returns the
 * bytes of all attributes. */
static inline uint64_t check_valid_attributes(const bvx_mesh *m)
{
    uint64_t bytes = m->colours != NULL ? m->vertex_count * 4 : 0;

    if (m->normals != NULL) bytes += m->vertex_count * 12;
    if (m->uvs2 != NULL) bytes += m->vertex_count * 8;
    if (m->materials != NULL) bytes += m->triangle_count * 4;
    bytes += bvxi_assets_bytes(m->assets);
    if (m->uvs == NULL) {
        TEST_ASSERT_NULL(m->uv_triangles);
        TEST_ASSERT_EQUAL_UINT64(0, m->uv_count);
        return bytes;
    }
    for (uint64_t i = 0; i < m->uv_count * 2; i++) TEST_ASSERT_TRUE(m->uvs[i] - m->uvs[i] == 0.0f);
    if (m->uv_triangles == NULL) TEST_ASSERT_EQUAL_UINT64(m->vertex_capacity, m->uv_count);
    else
        for (uint64_t i = 0; i < m->triangle_count * 3; i++)
            TEST_ASSERT_TRUE(m->uv_triangles[i] < m->uv_count);
    return bytes + m->uv_count * 8 + (m->uv_triangles != NULL ? m->triangle_count * 12 : 0);
}

/* Indices in range, coordinates finite, arrays of exact size. */
static inline void check_valid_mesh(const bvx_mesh *m)
{
    TEST_ASSERT_TRUE(m->triangle_count > 0 && m->vertex_count > 0 && m->owned == 1);
    TEST_ASSERT_EQUAL_UINT64(m->vertex_count, m->vertex_capacity);
    TEST_ASSERT_EQUAL_UINT64(m->triangle_count, m->triangle_capacity);
    TEST_ASSERT_NULL(m->vertex_keys);
    TEST_ASSERT_NULL(m->triangle_keys);
    for (uint64_t i = 0; i < m->triangle_count * 3; i++) TEST_ASSERT_TRUE(m->triangles[i] < m->vertex_count);
    for (uint64_t i = 0; i < m->vertex_count * 3; i++) {
        double const v = m->position_type == BVX_F32 ? (double)((float *)m->positions)[i]
                                                     : ((double *)m->positions)[i];
        TEST_ASSERT_TRUE(v - v == 0.0);
    }
    TEST_ASSERT_EQUAL_UINT64(m->vertex_count * (m->position_type == BVX_F32 ? 12 : 24) +
                                 m->triangle_count * 12 + check_valid_attributes(m),
                             bvx_memory_used(ctx));
}

/* What reading may take, whatever the file says. The tests of each reader hold the usual files to less. */
static inline uint64_t most_memory(int32_t format, uint64_t size)
{
    return read_limit(format == BVX_FORMAT_STL   ? READ_STL
                      : format == BVX_FORMAT_OBJ ? READ_OBJ
                      : format == BVX_FORMAT_PLY ? READ_PLY
                      : format == BVX_FORMAT_OFF ? READ_OFF
                      : format == BVX_FORMAT_3MF ? READ_3MF
                                                 : READ_GLTF,
                      size);
}

/* Read from a block that ends where the file ends, so that a sanitizer sees a read beyond it. */
static inline bvx_status read_file(const void *bytes, size_t size, int32_t format, bvx_mesh *mesh)
{
    static const bvx_mesh empty = {0};
    char *const copy = malloc(size > 0 ? size : 1);

    memset(mesh, 0, sizeof *mesh);
    memcpy(copy, bytes, size);
    bvx_memory_reset_peak(ctx);
    bvx_status const status = bvx_read_mesh(ctx, copy, size, format, NULL, mesh);
    free(copy);
    TEST_ASSERT_TRUE(bvx_memory_peak(ctx) <= most_memory(format, size));
    if (status == BVX_OK) {
        check_valid_mesh(mesh);
    } else {
        TEST_ASSERT_EQUAL_MEMORY(&empty, mesh, sizeof empty);
        TEST_ASSERT_EQUAL_UINT64(0, bvx_memory_used(ctx));
        TEST_ASSERT_TRUE(strlen(bvx_last_message(ctx)) > 0);
    }
    return status;
}

static inline void check_refused(const void *bytes, size_t size, int32_t format, bvx_status status,
                                 const char *words)
{
    bvx_mesh m;
    bvx_status const got = read_file(bytes, size, format, &m);
    TEST_ASSERT_EQUAL_INT32_MESSAGE(status, got, got == BVX_OK ? (const char *)bytes : bvx_last_message(ctx));
    if (strstr(bvx_last_message(ctx), words) == NULL)
        TEST_ASSERT_EQUAL_STRING_MESSAGE(words, bvx_last_message(ctx), "the message lacks these words");
}

static inline void check_refused_text(const char *text, int32_t format, bvx_status status, const char *words)
{
    check_refused(text, strlen(text), format, status, words);
}

/* Cut the file at every byte: an error, or a valid mesh of no more
 * triangles. Returns how many cuts were read. */
static inline int check_every_prefix(const void *bytes, size_t size, int32_t format, uint64_t triangles)
{
    int good = 0;

    for (size_t n = 0; n <= size; n++) {
        bvx_mesh m;
        if (read_file(bytes, n, format, &m) != BVX_OK) continue;
        TEST_ASSERT_TRUE(m.triangle_count <= triangles);
        if (n == size) TEST_ASSERT_EQUAL_UINT64(triangles, m.triangle_count);
        bvx_mesh_free(ctx, &m);
        good++;
    }
    return good;
}

/* Every line "element name count" of a header with every bad count in its place: an error, or a valid mesh
 * where the count is right after all (0 rows of something that nobody wants). Returns how many were read. */
static inline int check_every_count(const void *bytes, size_t size, int32_t format)
{
    static const char *const counts[] = {"0",
                                         "1",
                                         "-1",
                                         "2147483648",
                                         "4294967295",
                                         "9223372036854775808",
                                         "18446744073709551615",
                                         "18446744073709551617"};
    const char *const text = bytes;
    char *const other = malloc(size + 30);
    int good = 0;

    for (size_t at = 0; at + 8 < size; at++) {
        if (memcmp(text + at, "element ", 8) != 0) continue;
        size_t from = at + 8, to;
        while (text[from++] != ' ') continue;
        for (to = from; text[to] != '\n'; to++) continue;
        for (size_t i = 0; i < sizeof counts / sizeof counts[0]; i++) {
            size_t const n = strlen(counts[i]);
            bvx_mesh m;
            memcpy(other, text, from);
            memcpy(other + from, counts[i], n);
            memcpy(other + from + n, text + to, size - to);
            if (read_file(other, size - (to - from) + n, format, &m) != BVX_OK) continue;
            /* rows without values have any count */
            if (memcmp(text + to + 1, "property", 8) == 0) TEST_ASSERT_TRUE(i < 2);
            bvx_mesh_free(ctx, &m);
            good++;
        }
    }
    free(other);
    return good;
}

/* What the library makes of a polygon; its own tests say whether that is right. */
static inline void cut_polygon(const double (*corner)[3], uint64_t count, uint32_t *triangles)
{
    bvxi_polygon work = {0};
    work.ctx = ctx;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_polygon_cut(&work, corner, count, triangles));
    bvxi_drop(ctx, work.block);
}

/* Corner k of triangle t. */
static inline void corner_of(const bvx_mesh *m, uint64_t t, int k, double p[3])
{
    size_t const v = m->triangles[t * 3 + (uint64_t)k];
    for (size_t a = 0; a < 3; a++)
        p[a] = m->position_type == BVX_F32 ? (double)((float *)m->positions)[3 * v + a]
                                           : ((double *)m->positions)[3 * v + a];
}

static inline uint64_t next_random(uint64_t *state)
{
    *state ^= *state << 13;
    *state ^= *state >> 7;
    *state ^= *state << 17;
    return *state;
}

static inline void put_u32(uint8_t *p, uint32_t v, int big)
{
    for (int i = 0; i < 4; i++) p[i] = (uint8_t)(v >> 8 * (big ? 3 - i : i) & 0xff);
}

static inline void put_f32(uint8_t *p, float v, int big)
{
    uint32_t bits;
    memcpy(&bits, &v, sizeof bits);
    put_u32(p, bits, big);
}

/* The same file with several workers: the same mesh to the byte, or the same message. */
static inline void check_same_with_threads(const void *bytes, size_t size, int32_t format)
{
    bvx_context *const plain = ctx;
    char message[512];
    bvx_mesh a, b;
    bvx_status const status = read_file(bytes, size, format, &a);

    strcpy(message, bvx_last_message(ctx));
    for (int32_t threads = 2; threads <= 5; threads += 3) {
        ctx = suite_context(threads, BVX_CPU_BEST);
        TEST_ASSERT_EQUAL_INT32(status, read_file(bytes, size, format, &b));
        if (status == BVX_OK) {
            TEST_ASSERT_EQUAL_UINT64(a.vertex_count, b.vertex_count);
            TEST_ASSERT_EQUAL_UINT64(a.triangle_count, b.triangle_count);
            TEST_ASSERT_EQUAL_UINT64(a.uv_count, b.uv_count);
            TEST_ASSERT_EQUAL_MEMORY(a.positions, b.positions,
                                     a.vertex_count * (a.position_type == BVX_F32 ? 12 : 24));
            TEST_ASSERT_EQUAL_MEMORY(a.triangles, b.triangles, a.triangle_count * 12);
            TEST_ASSERT_TRUE((a.colours == NULL) == (b.colours == NULL) &&
                             (a.uv_triangles == NULL) == (b.uv_triangles == NULL));
            if (a.colours != NULL) TEST_ASSERT_EQUAL_MEMORY(a.colours, b.colours, a.vertex_count * 4);
            if (a.uvs != NULL) TEST_ASSERT_EQUAL_MEMORY(a.uvs, b.uvs, a.uv_count * 8);
            if (a.uv_triangles != NULL)
                TEST_ASSERT_EQUAL_MEMORY(a.uv_triangles, b.uv_triangles, a.triangle_count * 12);
        } else TEST_ASSERT_EQUAL_STRING(message, bvx_last_message(ctx));
        bvx_mesh_free(ctx, &b);
        bvx_context_destroy(ctx);
        ctx = plain;
    }
    if (status == BVX_OK) bvx_mesh_free(ctx, &a);
}

/* A progress callback that stops at its user's count-th call. */
static inline int32_t cancel_at(void *user, const char *stage, double fraction)
{
    int *const left = user;
    (void)stage;
    TEST_ASSERT_TRUE(fraction >= 0 && fraction <= 1);
    return fraction < 1.0 && --*left < 0; /* the report of 1 cancels nothing */
}

/* Cancel at every progress call of reading; returns how many there were. */
static inline int check_every_cancel(const void *bytes, size_t size, int32_t format)
{
    bvx_context *const plain = ctx;

    for (int stop = 0;; stop++) {
        bvx_context_options o = suite_options(1, BVX_CPU_BEST);
        bvx_mesh m;
        int left = stop;
        o.progress.call = cancel_at;
        o.progress.user = &left;
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_context_create(&o, &ctx));
        bvx_status const status = read_file(bytes, size, format, &m);
        bvx_mesh_free(ctx, &m);
        TEST_ASSERT_EQUAL_UINT64(0, bvx_memory_used(ctx));
        bvx_context_destroy(ctx);
        ctx = plain;
        if (status == BVX_OK) return stop;
        TEST_ASSERT_EQUAL_INT32(BVX_CANCELLED, status);
    }
}

/* Every memory limit below what reading takes is refused in words, nothing is left. */
static inline void check_every_limit(const void *bytes, size_t size, int32_t format)
{
    bvx_context *const plain = ctx;
    bvx_status status = BVX_ERR_BUDGET;

    for (uint64_t limit = 1; status != BVX_OK; limit += limit / 8 + 1) {
        bvx_context_options o = suite_options(1, BVX_CPU_BEST);
        bvx_mesh m;
        o.memory_limit = limit;
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_context_create(&o, &ctx));
        status = read_file(bytes, size, format, &m);
        TEST_ASSERT_TRUE(bvx_memory_peak(ctx) <= limit);
        bvx_mesh_free(ctx, &m);
        bvx_context_destroy(ctx);
        ctx = plain;
        TEST_ASSERT_TRUE(status == BVX_OK || status == BVX_ERR_BUDGET);
    }
}

#endif
