/* read_volume.c - the samples of a file as a volume: bvx_read_volume.
 *
 * The readers of grids tell where samples stand. Those that stand there as they are needed are left where
 * they are; others are unpacked, turned into this machine's byte order, or read from text, into an array
 * packed with x fastest. Guarantee: values are those of the file, exactly. */
#include "volume/room.h"
#include "io_grid/grid_formats.h"

enum { VOLUME_ASK_SAMPLES = 1 << 20, VOLUME_GRAIN = 1 << 16 };

void bvx_volume_free(bvx_context *context, bvx_volume *volume)
{
    if (context == NULL || volume == NULL) return;
    if (volume->owned) bvxi_free(context, (void *)(uintptr_t)volume->view.samples, volume->bytes);
    memset(volume, 0, sizeof *volume);
}

/* ---- samples alone ---- */

static bvx_status find_raw(const bvxi_grid_source *source, bvxi_dense *d)
{
    const bvx_read_volume_options *const o = source->volume;
    uint64_t const have = (uint64_t)(source->end - source->begin);
    uint64_t dims[3];
    int fits = 1;

    if (bvxi_type_size(o->sample_type) == 0)
        return BVXI_FILE_FAIL_FOR(source, BVX_ERR_ARGUMENT, BVX_REASON_CHOICE, "sample type %d is unknown",
                                  (int64_t)o->sample_type);
    if ((o->big_endian & ~1) != 0)
        return BVXI_FILE_FAIL_FOR(source, BVX_ERR_ARGUMENT, BVX_REASON_CHOICE, "big_endian is 0 or 1");
    for (int a = 0; a < 3; a++) {
        if (o->size[a] < 1)
            return BVXI_FILE_FAIL_FOR(source, BVX_ERR_ARGUMENT, BVX_REASON_RANGE, "size[%d] is %d",
                                      (int64_t)a, (int64_t)o->size[a]);
        dims[a] = (uint64_t)o->size[a];
    }
    BVXI_TRY(bvxi_file_box(source, o->origin, o->spacing, dims, &d->box));
    d->size = bvxi_mul(bvxi_mul(bvxi_mul(dims[0], dims[1], &fits), dims[2], &fits),
                       bvxi_type_size(o->sample_type), &fits);
    /* The difference is taken only after the offset is known to be inside. */
    if (!fits || o->offset > have || d->size > have - o->offset)
        return BVXI_FILE_FAIL(
            source, BVX_ERR_FORMAT, "%u x %u x %u samples of %u bytes after %u others, but the file has %u",
            dims[0], dims[1], dims[2], (uint64_t)bvxi_type_size(o->sample_type), o->offset, have);
    d->samples.first = source->begin + (size_t)o->offset;
    d->samples.kind = o->sample_type;
    d->samples.big = o->big_endian;
    bvxi_pack_strides(&d->samples, &d->box);
    return BVX_OK;
}

/* ---- samples turned into this machine's ---- */

/* A half's value as a float's bits: exact. */
static uint32_t widen_half(uint16_t h)
{
    uint32_t const sign = (uint32_t)(h & 0x8000) << 16, exponent = h >> 10 & 31, rest = h & 1023;
    /* Infinity and NaN keep their bits; a normal number has its exponent moved from bias 15 to 127. */
    if (exponent == 31) return sign | UINT32_C(0x7f800000) | rest << 13;
    if (exponent != 0) return sign | (exponent + 112) << 23 | rest << 13;
    if (rest == 0) return sign;
    /* A subnormal half is a normal float: its leading bit moves up, and each step costs the exponent one. */
    uint32_t shift = 0, r = rest;
    while ((r & 1024) == 0) {
        r <<= 1;
        shift++;
    }
    return sign | (113 - shift) << 23 | (r & 1023) << 13;
}

typedef struct turn_samples_job {
    const bvxi_samples *from;
    uint8_t *to;
    const int32_t *dims;
    uint32_t to_size;
} turn_samples_job;

static void turn_one(const uint8_t *p, int32_t kind, int big, uint8_t *out)
{
    switch (bvxi_sample_size(kind)) {
    case 1: *out = *p; break;
    /* By size, as turning bytes does not depend on what they mean; halves are the exception. */
    case 2: {
        uint16_t const v = bvxi_load_u16(p, big);
        uint32_t const wide = kind == BVXI_SAMPLE_F16 ? widen_half(v) : 0;
        if (kind == BVXI_SAMPLE_F16) memcpy(out, &wide, 4);
        else memcpy(out, &v, 2);
        break;
    }
    case 4: {
        uint32_t const v = bvxi_load_u32(p, big);
        memcpy(out, &v, 4);
        break;
    }
    default: {
        uint64_t const v = bvxi_load_u64(p, big);
        memcpy(out, &v, 8);
        break;
    }
    }
}

static void turn_piece(void *user, uint64_t row, uint64_t end)
{
    const turn_samples_job *const j = user;
    const bvxi_samples *const s = j->from;
    uint64_t const nx = (uint64_t)j->dims[0], ny = (uint64_t)j->dims[1];
    /* Rows are the unit, so that pieces write apart from each other. */
    for (; row < end; row++) {
        const uint8_t *const p = s->first + (ptrdiff_t)((int64_t)(row % ny) * s->stride[1] +
                                                        (int64_t)(row / ny) * s->stride[2]);
        uint8_t *const out = j->to + row * nx * j->to_size;
        for (uint64_t i = 0; i < nx; i++)
            turn_one(p + (ptrdiff_t)((int64_t)i * s->stride[0]), s->kind, s->big, out + i * j->to_size);
    }
}

static bvx_status turn_samples(bvx_context *ctx, const bvxi_samples *from, const int32_t dims[3],
                               uint32_t to_size, uint8_t *to)
{
    turn_samples_job job = {.from = from, .to = to, .dims = dims, .to_size = to_size};
    /* Many small rows share a piece; a row longer than the grain is a piece alone. */
    return bvxi_for(ctx, "read", (uint64_t)dims[1] * (uint64_t)dims[2], 1 + VOLUME_GRAIN / (uint64_t)dims[0],
                    turn_piece, &job);
}

/* ---- samples in a text ---- */

/* A number of a text becomes a sample of a type that holds it; whole numbers of 64 bits up to 2^53. */
static int put_text_sample(double v, int32_t type, uint8_t *out)
{
    static const struct {
        double least, most;
    } holds[9] = {{0, 0},
                  {0, 255.0},
                  {-128.0, 127.0},
                  {0, 65535.0},
                  {-32768.0, 32767.0},
                  {0, 4294967295.0},
                  {-2147483648.0, 2147483647.0},
                  {0, 9007199254740992.0},
                  {-9007199254740992.0, 9007199254740992.0}};
    float const f = (float)v;

    /* Floats take any number; the others must hold it exactly. */
    if (type == BVX_SAMPLE_F32) memcpy(out, &f, 4);
    if (type == BVX_SAMPLE_F64) memcpy(out, &v, 8);
    if (type >= BVX_SAMPLE_F32) return 1;
    /* Compared as doubles before the cast, which is undefined outside the type. */
    if (!(v >= holds[type].least && v <= holds[type].most)) return 0;
    int64_t const i = (int64_t)v;
    if ((double)i != v) return 0;
    /* Kept modulo the size: a negative number is stored in two's complement. */
    switch (bvxi_type_size(type)) {
    case 1: *out = (uint8_t)(i & 255); break;
    case 2: {
        uint16_t const bits = (uint16_t)(i & 65535);
        memcpy(out, &bits, 2);
        break;
    }
    case 4: {
        uint32_t const bits = (uint32_t)((uint64_t)i & UINT32_MAX);
        memcpy(out, &bits, 4);
        break;
    }
    default: memcpy(out, &i, 8); break;
    }
    return 1;
}

/* ---- steps ---- */

/* Samples that are needed as they stand: in bytes that are there, or in those just unpacked. */
static int stands_ready(const bvxi_samples *s)
{
    return s->kind != BVXI_SAMPLE_F16 && (bvxi_sample_size(s->kind) == 1 || s->big == bvxi_machine_is_big());
}

static bvx_status unpack_volume(const bvxi_grid_source *source, const bvxi_dense *d, uint8_t *to)
{
    bvxi_samples samples = d->samples;
    uint8_t *bytes = NULL;
    uint32_t const to_size = d->samples.kind == BVXI_SAMPLE_F16 ? 4 : bvxi_sample_size(d->samples.kind);

    /* Text and raw samples go to the result at once; packed ones need a block between only to be turned. */
    if (d->encoding == BVXI_DENSE_TEXT) {
        uint32_t const size = bvxi_sample_size(d->samples.kind);
        uint64_t const all = d->size / size;
        const char *p = d->begin;

        for (uint64_t n = 0; n < all; n++) {
            const char *const before = bvxi_skip_space(p, d->end);
            double v;
            if (n % VOLUME_ASK_SAMPLES == 0)
                BVXI_TRY(bvxi_progress(source->ctx, "read", (double)n / (double)all));
            BVXI_TRY(bvxi_take_sample(&d->source, d->box.dims, n, &p, &v));
            if (!put_text_sample(v, d->samples.kind, to + n * size))
                return bvxi_fail_expected(&d->source, before, "a number that the type of the samples holds");
        }

        /* A sample more than the size says would be left out without a word. */
        p = bvxi_skip_space(p, d->end);
        return p == d->end ? BVX_OK : bvxi_fail_expected(&d->source, p, d->behind);
    }
    if (d->encoding == BVXI_DENSE_RAW) return turn_samples(source->ctx, &samples, d->box.dims, to_size, to);
    if (stands_ready(&samples)) return bvxi_unpack_dense(source, d, to);
    BVXI_TRY(bvxi_alloc(source->ctx, BVXI_SCRATCH, d->size, "the unpacked samples", &bytes));
    samples.first = bytes;
    BVXI_TRY(bvxi_unpack_dense(source, d, bytes));
    return turn_samples(source->ctx, &samples, d->box.dims, to_size, to);
}

static bvx_status make_volume(const bvxi_grid_source *source, const bvxi_dense *d, bvx_volume *v)
{
    int const half = d->samples.kind == BVXI_SAMPLE_F16;
    uint8_t *made = NULL;
    int fits = 1;

    v->view.sample_type = half ? BVX_SAMPLE_F32 : d->samples.kind;
    v->view.lattice = d->box;
    v->placed = d->placed;
    memcpy(v->view.size, d->box.dims, sizeof v->view.size);

    /* No copy: the samples stay in the caller's bytes, which must outlive the volume. */
    if (d->encoding == BVXI_DENSE_RAW && stands_ready(&d->samples)) {
        v->view.samples = d->samples.first;
        memcpy(v->view.strides, d->samples.stride, sizeof v->view.strides);
        return BVX_OK;
    }

    /* A half becomes a float of twice the size, as C99 has no type for halves. */
    v->bytes = half ? bvxi_mul(d->size, 2, &fits) : d->size;
    BVXI_TRY(bvxi_alloc(source->ctx, BVXI_RESULT, v->bytes, "the volume", &made));
    bvx_status const status = unpack_volume(source, d, made);
    if (status != BVX_OK) {
        bvxi_free(source->ctx, made, v->bytes);
        return status;
    }
    v->view.samples = made;
    v->owned = 1;
    return BVX_OK;
}

static const bvxi_option read_volume_rows[] = {
    BVXI_SWITCH(bvx_read_volume_options, big_endian),
    BVXI_RESERVED(bvx_read_volume_options, reserved0),
    BVXI_RESERVED(bvx_read_volume_options, reserved),
};

static bvx_status run_read_volume(bvx_context *context, const void *bytes, uint64_t size, int32_t format,
                                  const bvx_read_volume_options *options, bvx_volume *volume)
{
    static const char name[] = "bvx_read_volume";
    bvx_read_volume_options o;
    bvxi_grid_source source;
    bvxi_dense dense = {0};
    bvx_volume made = {0};

    if (volume == NULL) return bvxi_fail_null(context, name, "volume");
    BVXI_TRY(bvxi_take_grid_file(context, name, bytes, size, format, &source));
    BVXI_TRY(bvxi_take_options(context, name, options, &o, sizeof o));
    BVXI_TRY(bvxi_check_options(context, name, &o, BVXI_OPTIONS(read_volume_rows)));
    for (int a = 0; a < 3; a++) o.spacing[a] = o.spacing[a] == 0.0 ? 1.0 : o.spacing[a];
    if (o.data_size > SIZE_MAX / 2)
        return bvxi_fail_for(context, BVX_ERR_ARGUMENT, BVX_REASON_TOO_MANY,
                             "%s: data_size is %u, more than memory can hold", name, o.data_size);
    if (size == 0) return bvxi_fail(context, BVX_ERR_FORMAT, "%s: the file has no bytes", name);
    source.volume = &o;
    /* Found before it is made: what is wrong with the head costs no memory. */
    switch (format) {
    case BVX_FORMAT_NRRD: BVXI_TRY(bvxi_find_nrrd(&source, &dense)); break;
    case BVX_FORMAT_NPY: BVXI_TRY(bvxi_find_npy(&source, &dense)); break;
    case BVX_FORMAT_VTI: BVXI_TRY(bvxi_find_vti(&source, &dense)); break;
    case BVX_FORMAT_RAW: BVXI_TRY(find_raw(&source, &dense)); break;
    default: return bvxi_fail_format(context, BVX_ERR_ARGUMENT, name, "volume", format, BVX_VOLUMES_READ);
    }
    BVXI_TRY(make_volume(&source, &dense, &made));
    if (volume->owned == 1) bvx_volume_free(context, volume);
    *volume = made;
    return BVX_OK;
}

bvx_status bvx_read_volume(bvx_context *context, const void *bytes, uint64_t size, int32_t format,
                           const bvx_read_volume_options *options, bvx_volume *volume)
{
    return BVXI_CALL(context, run_read_volume(context, bytes, size, format, options, volume));
}
