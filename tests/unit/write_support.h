/* write_support.h - what the tests of mesh writers share: meshes of random
 * numbers, and files written by workers of all kinds. */
#ifndef TEST_WRITE_SUPPORT_H
#define TEST_WRITE_SUPPORT_H

#include "read_support.h"

enum { VERTICES = 300, TRIANGLES = 500, UVS = 400 };

enum { WITH_COLOURS = 1, WITH_UVS = 2, WITH_CORNER_UVS = 4 };

static float xyz32[VERTICES * 3];
static double xyz64[VERTICES * 3];
static uint32_t triangles[TRIANGLES * 3];
static uint8_t colours[VERTICES * 4];
static float uvs[UVS * 2];
static uint32_t uv_triangles[TRIANGLES * 3];

/* Any bits but those of infinities and NaN: every exponent, denormals, -0. */
static inline float any_float(uint64_t *state)
{
    uint32_t const bits = (uint32_t)next_random(state);
    float v;
    memcpy(&v, &bits, sizeof v);
    return v - v == 0.0f ? v : -0.0f;
}

/* A mesh over the arrays above. Every vertex is a corner of some triangle. */
static inline bvx_mesh random_mesh(int32_t type, int with, uint64_t seed)
{
    bvx_mesh m = {0};
    uint64_t state = seed * 77 + 1;

    for (int i = 0; i < VERTICES * 3; i++) {
        uint64_t const r = next_random(&state);
        xyz32[i] = any_float(&state);
        memcpy(&xyz64[i], &r, sizeof r);
        if (!(xyz64[i] - xyz64[i] == 0.0)) xyz64[i] = -0.0;
    }
    for (uint32_t i = 0; i < TRIANGLES * 3; i++) {
        triangles[i] = i < VERTICES ? i : (uint32_t)(next_random(&state) % VERTICES);
        uv_triangles[i] = (uint32_t)(next_random(&state) % UVS);
    }
    for (int i = 0; i < VERTICES * 4; i++) colours[i] = (uint8_t)(next_random(&state) >> 8 & 255);
    for (int i = 0; i < UVS * 2; i++) uvs[i] = any_float(&state);
    m.positions = type == BVX_F32 ? (void *)xyz32 : (void *)xyz64;
    m.triangles = triangles;
    m.vertex_count = m.vertex_capacity = VERTICES;
    m.triangle_count = m.triangle_capacity = TRIANGLES;
    m.position_type = type;
    if (with & WITH_COLOURS) m.colours = colours;
    if (with & (WITH_UVS | WITH_CORNER_UVS)) {
        m.uvs = uvs;
        m.uv_count = UVS; /* more than there are vertices, as a capacity may be */
    }
    if (with & WITH_CORNER_UVS) m.uv_triangles = uv_triangles;
    return m;
}

static inline bvx_buffer write_file(const bvx_mesh *m, int32_t format)
{
    bvx_buffer b = {0};
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_write_mesh(ctx, m, 1, NULL, format, &b),
                                    bvx_last_message(ctx));
    TEST_ASSERT_TRUE(b.size > 0 && b.size <= b.capacity);
    return b;
}

/* Whatever rounding to floats does to it. */
static inline bvx_buffer write_rounded(const bvx_mesh *m, int32_t format)
{
    bvx_write_options o = {.struct_size = sizeof o};
    bvx_buffer b = {0};
    o.rounding = BVX_ROUNDING_ALLOW;
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_write_mesh(ctx, m, 1, &o, format, &b), bvx_last_message(ctx));
    return b;
}

/* Write, free the buffer, read what was written. */
static inline bvx_mesh write_and_read(const bvx_mesh *m, int32_t format)
{
    bvx_mesh back = {0};
    bvx_buffer b = write_file(m, format);
    uint8_t *const bytes = malloc((size_t)b.size);
    size_t const size = (size_t)b.size;

    memcpy(bytes, b.bytes, size);
    bvx_buffer_free(ctx, &b);
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_read_mesh(ctx, bytes, size, format, NULL, &back),
                                    bvx_last_message(ctx));
    free(bytes);
    return back;
}

/* Text of floats is read as doubles, which are near them; as floats they are the same. */
static inline double as_written(const bvx_mesh *m, double read)
{
    return m->position_type == BVX_F32 ? (double)(float)read : read;
}

/* The texture coordinate of a triangle's corner. */
static inline const float *uv_of(const bvx_mesh *m, uint64_t t, int k)
{
    const uint32_t *const number = m->uv_triangles != NULL ? m->uv_triangles : m->triangles;
    return m->uvs + 2 * (size_t)number[t * 3 + (uint64_t)k];
}

/* Attributes of what was read are those of what was written, corner by
 * corner; alpha where the format keeps it. */
static inline void check_same_attributes(const bvx_mesh *m, const bvx_mesh *back, int alpha)
{
    TEST_ASSERT_EQUAL_INT(m->colours != NULL, back->colours != NULL);
    TEST_ASSERT_EQUAL_INT(m->uvs != NULL, back->uvs != NULL);
    if (m->colours != NULL)
        for (size_t v = 0; v < m->vertex_count; v++) {
            TEST_ASSERT_EQUAL_UINT8_ARRAY(m->colours + 4 * v, back->colours + 4 * v, 3);
            TEST_ASSERT_EQUAL_UINT8(alpha ? m->colours[4 * v + 3] : 255, back->colours[4 * v + 3]);
        }
    if (m->uvs != NULL)
        for (uint64_t t = 0; t < m->triangle_count; t++)
            for (int k = 0; k < 3; k++) TEST_ASSERT_EQUAL_MEMORY(uv_of(m, t, k), uv_of(back, t, k), 8);
}

static inline void check_not_written(const bvx_mesh *m, int32_t format, bvx_status status, const char *words)
{
    bvx_buffer b = {0};
    TEST_ASSERT_EQUAL_INT32_MESSAGE(status, bvx_write_mesh(ctx, m, 1, NULL, format, &b), words);
    TEST_ASSERT_TRUE(b.bytes == NULL && b.size == 0 && b.capacity == 0);
    if (strstr(bvx_last_message(ctx), words) == NULL) TEST_ASSERT_EQUAL_STRING(words, bvx_last_message(ctx));
    TEST_ASSERT_EQUAL_UINT64(0, bvx_memory_used(ctx));
}

static inline void run_backwards(void *user, int32_t count, bvx_task_fn *task, void *task_user)
{
    (void)user;
    for (int32_t i = count; i-- > 0;) task(task_user, i, i % 3);
}

/* The same bytes by one worker, by three, and by pieces made in another order. */
static inline void check_workers_change_nothing(const bvx_mesh *m, int32_t format)
{
    bvx_context *const plain = ctx;
    bvx_buffer one = write_file(m, format);

    for (int way = 0; way < 2; way++) {
        bvx_context_options o = {.struct_size = sizeof o};
        o.threads = 3;
        if (way == 1) o.parallel.call = run_backwards;
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_context_create(&o, &ctx));
        bvx_buffer other = write_file(m, format);
        TEST_ASSERT_EQUAL_UINT64(one.size, other.size);
        TEST_ASSERT_EQUAL_MEMORY(one.bytes, other.bytes, (size_t)one.size);
        bvx_buffer_free(ctx, &other);
        bvx_context_destroy(ctx);
        ctx = plain;
    }
    bvx_buffer_free(ctx, &one);
}

/* Many vertices and triangles, so that files have many pieces: a strip with
 * numbers of all lengths. Freed by free_strip. */
static inline bvx_mesh make_strip(uint32_t vertices)
{
    bvx_mesh m = {0};
    float *const p = malloc((size_t)vertices * 12);

    m.triangles = malloc((size_t)(vertices - 2) * 12);
    m.colours = malloc((size_t)vertices * 4);
    m.uvs = malloc((size_t)vertices * 8);
    for (uint32_t v = 0; v < vertices; v++) {
        p[3 * v] = (float)(v / 2) * (v % 7 < 3 ? 0.1f : 1.0f);
        p[3 * v + 1] = v % 2 ? 1.0f / (float)(v + 1) : 0.0f;
        p[3 * v + 2] = -0.0f;
        for (uint32_t c = 0; c < 4; c++) m.colours[4 * v + c] = (uint8_t)((v >> 2 * c) & 255);
        m.uvs[2 * v] = (float)v / (float)vertices;
        m.uvs[2 * v + 1] = 0.25f;
    }
    for (uint32_t t = 0; t + 2 < vertices; t++) {
        m.triangles[3 * t] = t;
        m.triangles[3 * t + 1] = t % 2 ? t + 2 : t + 1;
        m.triangles[3 * t + 2] = t % 2 ? t + 1 : t + 2;
    }
    m.positions = p;
    m.vertex_count = m.vertex_capacity = m.uv_count = vertices;
    m.triangle_count = m.triangle_capacity = vertices - 2;
    m.position_type = BVX_F32;
    return m;
}

static inline void free_strip(bvx_mesh *m)
{
    free(m->positions);
    free(m->triangles);
    free(m->colours);
    free(m->uvs);
    memset(m, 0, sizeof *m);
}

#endif
