/* nrrd.c - an NRRD file: where the samples of three axes, x fastest, stand, and where they lie in space.
 *
 * Source: Kindlmann. Definition of NRRD File Format. Geometry: "space directions" with "space origin", the
 * centre of the first sample whatever the centring; else "spacings", or the axes' ends divided up, with "axis
 * mins", which are the low faces of cells (cells where the file leaves it open, as the reference library
 * does) or the first samples of nodes; else the first sample is at 0, as SimpleITK and VTK have it. The
 * lattice's origin is the low corner of the first voxel. A space's name (which way is left) changes no
 * number. A detached head's samples stand in bytes of the caller's. Guarantee: the bytes agree with the
 * head, as far as is known, before anything is made. */
#include "io_grid/nrrd_head.h"

/* ---- geometry ---- */

/* NaN in a file says "unknown". */
static int nrrd_knows(const nrrd_head *h, int32_t has, double v)
{
    return (h->has & has) != 0 && v == v;
}

static void nrrd_place(const nrrd_head *h, double origin[3], double spacing[3])
{
    for (int a = 0; a < 3; a++) {
        /* n cells span n steps, n nodes only n - 1. */
        double const steps = (double)h->sizes[a] - (double)h->node[a];
        int const low = nrrd_knows(h, NRRD_HAS_MIN, h->min[a]), high = nrrd_knows(h, NRRD_HAS_MAX, h->max[a]);
        spacing[a] = (h->has & NRRD_HAS_DIRECTION) != 0               ? h->direction[a]
                     : nrrd_knows(h, NRRD_HAS_SPACING, h->spacing[a]) ? h->spacing[a]
                     : low && high && steps > 0                       ? (h->max[a] - h->min[a]) / steps
                                                                      : 1.0;
        /* An origin is the centre of the first sample; a minimum is a face or a centre, by the axis. */
        /* Half a voxel below the first sample; exactly what our writer had, if it gives the same sample. */
        int const exact = (h->has & NRRD_HAS_CORNER) != 0 && h->corner[a] + 0.5 * spacing[a] == h->origin[a];
        if ((h->has & NRRD_HAS_ORIGIN) != 0)
            origin[a] = exact ? h->corner[a] : h->origin[a] - 0.5 * spacing[a];
        else origin[a] = (low ? h->min[a] : 0.0) - (low && !h->node[a] ? 0.0 : 0.5 * spacing[a]);
    }
}

/* ---- samples ---- */

/* Where samples begin after lines and bytes to be skipped; raw: their bytes must be size. */
static bvx_status nrrd_find_samples(const nrrd_head *h, const char *p, const char *file_end, uint64_t size,
                                    const char **samples)
{
    const bvxi_source *const s = &h->source;
    const char *end;

    for (int64_t i = 0; i < h->line_skip; i++) {
        p = bvxi_nrrd_line(p, file_end, &end);
        if (p == NULL)
            return BVXI_FILE_FAIL(s, BVX_ERR_FORMAT, "fewer than %d lines to skip after the head",
                                  h->line_skip);
    }
    /* Skipping inside packed samples would require unpacking them here. */
    if (h->encoding == NRRD_GZIP && h->byte_skip != 0)
        return BVXI_FILE_FAIL(s, BVX_ERR_UNSUPPORTED, "bytes to be skipped in packed samples");
    if (h->byte_skip > file_end - p)
        return BVXI_FILE_FAIL(s, BVX_ERR_FORMAT, "%d bytes to skip, but %d follow the head", h->byte_skip,
                              (int64_t)(file_end - p));
    if (h->byte_skip > 0) p += h->byte_skip;

    uint64_t const have = (uint64_t)(file_end - p);
    if (h->encoding == NRRD_GZIP  ? have < size / 1100 /* what deflate can do at most is 1032 to 1 */
        : h->encoding == NRRD_RAW ? have < size || (have > size && h->byte_skip != -1)
                                  : have < size)
        return BVXI_FILE_FAIL(
            s, BVX_ERR_FORMAT, "%u x %u x %u samples are %s%u bytes, but the file has %u for them",
            h->sizes[0], h->sizes[1], h->sizes[2], h->encoding == NRRD_RAW ? "" : "at least ",
            h->encoding == NRRD_GZIP ? size / 1100 : size, have);
    /* -1 means that the samples are the last bytes of the file. */
    *samples = h->byte_skip == -1 ? file_end - size : p;
    return BVX_OK;
}

/* Refuse what only those who want the samples can bring: other files, and a way to unpack. */
static bvx_status nrrd_check_source(const bvxi_grid_source *source, const nrrd_head *h)
{
    const bvx_read_volume_options *const o = source->volume;

    /* A reader of grids has neither; a reader of volumes may have been given both. */
    if (h->files != NULL && (o == NULL || o->data == NULL))
        return bvxi_nrrd_unsupported(
            h, BVX_REASON_UNSUPPORTED, h->files,
            o == NULL ? "the samples are in another file; join head and samples in one .nrrd "
                        "(unu save -f nrrd -e raw)"
                      : "the samples are in another file, whose bytes were not given");
    if (h->encoding == NRRD_GZIP && (o == NULL || o->inflate == NULL))
        return bvxi_nrrd_unsupported(h, BVX_REASON_COMPRESSED, h->encoding_at,
                                     o == NULL
                                         ? "compressed or hex samples; save them with encoding raw (unu save "
                                           "-f nrrd -e raw)"
                                         : "compressed samples, and nothing was given to unpack them");
    return BVX_OK;
}

static void nrrd_head_source(const bvxi_grid_source *source, nrrd_head *h)
{
    memset(h, 0, sizeof *h);
    h->source.ctx = source->ctx;
    h->source.format = "NRRD";
    h->source.begin = (const char *)source->begin;
    h->source.end = (const char *)source->end;
}

bvx_status bvxi_find_nrrd(const bvxi_grid_source *source, bvxi_dense *dense)
{
    nrrd_head h;
    double origin[3], spacing[3];
    int fits = 1;

    nrrd_head_source(source, &h);
    BVXI_TRY(bvxi_nrrd_head_read(&h));
    BVXI_TRY(nrrd_check_source(source, &h));

    /* The place needs the head only; it is checked as that of every file is. */
    nrrd_place(&h, origin, spacing);
    BVXI_TRY(bvxi_file_box(source, origin, spacing, h.sizes, &dense->box));
    uint64_t const sample = bvxi_sample_size(h.kind);
    uint64_t const voxels = bvxi_mul(bvxi_mul(h.sizes[0], h.sizes[1], &fits), h.sizes[2], &fits);
    /* a digit and a space */
    uint64_t const size = bvxi_mul(voxels, sample, &fits), digits = bvxi_mul(voxels, 2, &fits);

    /* The product is a file's claim: checked before it is compared with any size. */
    if (!fits || size > INT64_MAX)
        return BVXI_FILE_FAIL(source, BVX_ERR_FORMAT, "%u x %u x %u samples are more than any file holds",
                              h.sizes[0], h.sizes[1], h.sizes[2]);

    /* From here on, sizes fit in 64 bits, and the bytes decide whether they are true. */
    const char *const begin = h.files != NULL ? source->volume->data : h.data;
    dense->placed = 1;
    dense->size = size;
    dense->source = h.source;
    dense->encoding = h.encoding == NRRD_RAW    ? BVXI_DENSE_RAW
                      : h.encoding == NRRD_TEXT ? BVXI_DENSE_TEXT
                                                : BVXI_DENSE_GZIP;
    dense->end = h.files != NULL ? begin + (size_t)source->volume->data_size : h.source.end;
    dense->behind = "the end of the file after the last sample";
    BVXI_TRY(
        nrrd_find_samples(&h, begin, dense->end, h.encoding == NRRD_TEXT ? digits - 1 : size, &dense->begin));
    /* lines are those of the other file */
    if (h.files != NULL && h.encoding == NRRD_TEXT) dense->source.begin = begin;
    dense->source.end = dense->end;
    dense->samples.first = (const uint8_t *)dense->begin;
    dense->samples.kind = h.kind;
    dense->samples.big = h.big;
    bvxi_pack_strides(&dense->samples, &dense->box);
    return BVX_OK;
}

static size_t nrrd_print_number(const nrrd_file_name *f, char text[48])
{
    uint64_t v = f->number < 0 ? 0 - (uint64_t)f->number : (uint64_t)f->number;
    char digit[20];
    size_t n = 0, used = 0;

    do digit[n++] = (char)('0' + v % 10);
    while ((v /= 10) != 0);
    size_t const sign = f->number < 0, wide = n + sign;
    size_t const fill = f->digits > 0 && (size_t)f->digits > wide ? (size_t)f->digits - wide : 0;
    /* Blanks go before the sign, zeros after it, as printf does. */
    for (size_t i = 0; i < fill && !f->zeros; i++) text[used++] = ' ';
    if (sign) text[used++] = '-';
    for (size_t i = 0; i < fill && f->zeros; i++) text[used++] = '0';
    while (n > 0) text[used++] = digit[--n];
    return used;
}

bvx_status bvx_volume_data_name(bvx_context *context, const void *bytes, uint64_t size, uint64_t index,
                                char *name, uint64_t capacity, uint64_t *count)
{
    static const char function[] = "bvx_volume_data_name";
    bvxi_grid_source source;
    nrrd_file_name f = {0};
    nrrd_head h;
    char number[48];
    uint64_t files = 0;

    if (context == NULL) return BVX_ERR_ARGUMENT;
    BVXI_TRY(bvxi_take_grid_file(context, function, bytes, size, BVX_FORMAT_NRRD, &source));
    if (count == NULL) return bvxi_fail_null(context, function, "count");
    nrrd_head_source(&source, &h);
    BVXI_TRY(bvxi_nrrd_head_read(&h));
    if (h.files != NULL) BVXI_TRY(bvxi_nrrd_data_file(&h, index, &f, &files));
    *count = files;
    if (name == NULL) return BVX_OK;
    if (index >= files)
        return bvxi_fail_for(context, BVX_ERR_ARGUMENT, BVX_REASON_INDEX,
                             "%s: index is %u, the head names %u data files", function, index, files);

    size_t const digits = f.pattern ? nrrd_print_number(&f, number) : 0;
    size_t const first = f.pattern ? f.place : f.length;
    size_t const rest = f.pattern ? f.length - f.rest : 0;
    if (capacity < (uint64_t)(first + digits + rest) + 1)
        return bvxi_fail(context, BVX_ERR_CAPACITY, "%s: the name has %u bytes with its end, name holds %u",
                         function, (uint64_t)(first + digits + rest) + 1, capacity);
    memcpy(name, f.name, first);
    memcpy(name + first, number, digits);
    memcpy(name + first + digits, f.name + f.rest, rest);
    name[first + digits + rest] = 0;
    return BVX_OK;
}
