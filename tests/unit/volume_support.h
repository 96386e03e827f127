/* volume_support.h - volumes of any type and layout for tests, and slow
 * answers to hold the library's against. */
#ifndef VOLUME_SUPPORT_H
#define VOLUME_SUPPORT_H

#include "tools/mesh_maker.h"

#include "suite.h"

#include <math.h>
#include <stdlib.h>

static uint64_t seed;

/* The suite's context anew, with other threads and code. */
static inline void open_again(int32_t threads, int32_t cpu)
{
    bvx_context_options const o = suite_options(threads, cpu);
    suite_close();
    suite_open_with(&o);
}

void setUp(void)
{
    suite_open(1);
    seed = UINT64_C(0x70107e);
}

void tearDown(void)
{
    suite_close();
}

static inline size_t type_size(int32_t type)
{
    static const size_t size[] = {0, 1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
    return size[type];
}

/* Write v, whole and in the type's range where it is a type of whole numbers. */
static inline void store_sample(void *at, int32_t type, double v)
{
    uint8_t u8 = 0;
    int8_t i8 = 0;
    uint16_t u16 = 0;
    int16_t i16 = 0;
    uint32_t u32 = 0;
    int32_t i32 = 0;
    uint64_t u64 = 0;
    int64_t i64 = 0;
    float f32 = 0;

    switch (type) {
    case BVX_SAMPLE_U8:
        u8 = (uint8_t)v;
        memcpy(at, &u8, 1);
        break;
    case BVX_SAMPLE_I8:
        i8 = (int8_t)v;
        memcpy(at, &i8, 1);
        break;
    case BVX_SAMPLE_U16:
        u16 = (uint16_t)v;
        memcpy(at, &u16, 2);
        break;
    case BVX_SAMPLE_I16:
        i16 = (int16_t)v;
        memcpy(at, &i16, 2);
        break;
    case BVX_SAMPLE_U32:
        u32 = (uint32_t)v;
        memcpy(at, &u32, 4);
        break;
    case BVX_SAMPLE_I32:
        i32 = (int32_t)v;
        memcpy(at, &i32, 4);
        break;
    case BVX_SAMPLE_U64:
        u64 = (uint64_t)v;
        memcpy(at, &u64, 8);
        break;
    case BVX_SAMPLE_I64:
        i64 = (int64_t)v;
        memcpy(at, &i64, 8);
        break;
    case BVX_SAMPLE_F32:
        f32 = (float)v;
        memcpy(at, &f32, 4);
        break;
    default: memcpy(at, &v, 8); break;
    }
}

/* A volume of its own memory, with gaps, odd addresses and axes that run
 * either way, and its values as doubles. */
typedef struct test_volume {
    bvx_volume_view view;
    double *value; /* packed, x fastest */
    uint8_t *memory;
} test_volume;

/* order: the axes from the fastest to the slowest as digits (12 = x, y, z is 012); flips: a bit for each
 * axis; gap: bytes between rows of the fastest axis. low: the window begins so far inside its lattice. */
static inline void make_volume(test_volume *t, int32_t type, const int32_t size[3], int32_t low,
                               const int order[3], int flips, int64_t gap)
{
    static const double origin[3] = {-3.25, 10.5, 0.0}, spacing[3] = {0.5, 0.75, 1.25};
    int32_t const dims[3] = {size[0] + 2 * low, size[1] + 2 * low, size[2] + 2 * low};
    int64_t step = (int64_t)type_size(type), first = 1;

    memset(t, 0, sizeof *t);
    t->view.sample_type = type;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_make(ctx, origin, spacing, dims, &t->view.lattice));
    for (int n = 0; n < 3; n++) {
        int const a = order[n];
        t->view.low[a] = low;
        t->view.size[a] = size[a];
        t->view.strides[a] = (flips >> a & 1) != 0 ? -step : step;
        if ((flips >> a & 1) != 0) first += step * (size[a] - 1);
        step = step * size[a] + gap;
    }
    t->memory = calloc((size_t)step + 9, 1);
    t->value = calloc((size_t)size[0] * (size_t)size[1] * (size_t)size[2], sizeof *t->value);
    TEST_ASSERT_NOT_NULL(t->memory);
    TEST_ASSERT_NOT_NULL(t->value);
    t->view.samples = t->memory + first;
}

static inline void free_volume(test_volume *t)
{
    free(t->memory);
    free(t->value);
    memset(t, 0, sizeof *t);
}

static inline size_t value_index(const test_volume *t, int32_t x, int32_t y, int32_t z)
{
    return ((size_t)z * (size_t)t->view.size[1] + (size_t)y) * (size_t)t->view.size[0] + (size_t)x;
}

static inline void set_value(test_volume *t, int32_t x, int32_t y, int32_t z, double v)
{
    int64_t const at = x * t->view.strides[0] + y * t->view.strides[1] + z * t->view.strides[2];
    if (t->view.sample_type == BVX_SAMPLE_F32) v = (double)(float)v;
    store_sample((uint8_t *)(uintptr_t)t->view.samples + at, t->view.sample_type, v);
    t->value[value_index(t, x, y, z)] = v;
}

/* Whole numbers from least to most for all samples. */
static inline void fill_noise(test_volume *t, double least, double most)
{
    const int32_t *const n = t->view.size;
    for (int32_t z = 0; z < n[2]; z++)
        for (int32_t y = 0; y < n[1]; y++)
            for (int32_t x = 0; x < n[0]; x++)
                set_value(t, x, y, z, least + (double)maker_below(&seed, (int32_t)(most - least) + 1));
}

#endif
