/* read_nrrd.c - an NRRD file to a grid: three axes, x fastest, every number other than 0 is a voxel.
 *
 * Source: Kindlmann. Definition of NRRD File Format. Geometry: "space directions" with "space origin", the centre of the
 * first sample whatever the centring; else "spacings", or the axes' ends divided up, with "axis mins", which are the low
 * faces of cells (cells where the file leaves it open, as the reference library does) or the first samples of nodes. The
 * lattice's origin is the low corner of the first voxel. A space's name (which way is left) changes no number.
 * Guarantee: the file's size agrees with its head before the grid is made. */
#include "io/nrrd_head.h"

/* ---- geometry ---- */

/* NaN in a file says "unknown". */
static int nrrd_knows(const nrrd_head *h, int32_t has, double v)
{
    return (h->has & has) != 0 && v == v;
}

/* Half a voxel below the first sample; exactly what a writer of ours had, where that leads to the same sample. */
static double nrrd_corner(const nrrd_head *h, double spacing, int axis)
{
    if ((h->has & NRRD_HAS_CORNER) != 0 && h->corner[axis] + 0.5 * spacing == h->origin[axis]) return h->corner[axis];
    return h->origin[axis] - 0.5 * spacing;
}

static void nrrd_place(const nrrd_head *h, double origin[3], double spacing[3])
{
    for (int a = 0; a < 3; a++) {
        double const steps = (double)h->sizes[a] - (double)h->node[a];
        int const low = nrrd_knows(h, NRRD_HAS_MIN, h->min[a]), high = nrrd_knows(h, NRRD_HAS_MAX, h->max[a]);
        spacing[a] = (h->has & NRRD_HAS_DIRECTION) != 0 ? h->direction[a]
                     : nrrd_knows(h, NRRD_HAS_SPACING, h->spacing[a]) ? h->spacing[a]
                     : low && high && steps > 0 ? (h->max[a] - h->min[a]) / steps : 1.0;
        if ((h->has & NRRD_HAS_ORIGIN) != 0) origin[a] = nrrd_corner(h, spacing[a], a);
        else origin[a] = !low ? 0.0 : h->node[a] ? h->min[a] - 0.5 * spacing[a] : h->min[a];
    }
}

/* ---- samples ---- */

/* Where samples begin behind lines and bytes to be skipped; their number of bytes must be size exactly. */
static bvx_status nrrd_find_samples(const nrrd_head *h, uint64_t size, const char **samples)
{
    const bvxi_source *const s = &h->source;
    const char *p = h->data, *end;
    for (int64_t i = 0; i < h->line_skip; i++) {
        p = bvxi_nrrd_line(p, s->end, &end);
        if (p == NULL)
            return bvxi_fail(s->ctx, BVX_ERR_FORMAT, "NRRD: fewer than %d lines to skip behind the head", h->line_skip);
    }
    if (h->byte_skip > s->end - p)
        return bvxi_fail(s->ctx, BVX_ERR_FORMAT, "NRRD: %d bytes to skip, but %d stand behind the head", h->byte_skip,
                         (int64_t)(s->end - p));
    if (h->byte_skip > 0) p += h->byte_skip;
    uint64_t const have = (uint64_t)(s->end - p);
    if (h->encoding == NRRD_RAW ? have < size || (have > size && h->byte_skip != -1) : have < size)
        return bvxi_fail(s->ctx, BVX_ERR_FORMAT, "NRRD: %u x %u x %u samples are %s%u bytes, but the file has %u for them",
                         h->sizes[0], h->sizes[1], h->sizes[2], h->encoding == NRRD_RAW ? "" : "at least ", size, have);
    *samples = h->byte_skip == -1 ? s->end - size : p;
    return BVX_OK;
}

static bvx_status nrrd_read_text(const bvxi_grid_source *source, const nrrd_head *h, const char *samples,
                                 const bvx_lattice *box, const bvx_window *part, bvx_grid *grid)
{
    const char *stop;
    BVXI_TRY(bvxi_pack_text(source->ctx, "NRRD", h->source.begin, samples, h->source.end, box->dims, part, grid, &stop));
    stop = bvxi_skip_space(stop, h->source.end);
    return stop == h->source.end ? BVX_OK : bvxi_fail_expected(&h->source, stop, "the end of the file behind the last sample");
}

bvx_status bvxi_read_nrrd(const bvxi_grid_source *source, bvx_grid *grid)
{
    nrrd_head h;
    double origin[3], spacing[3];
    bvxi_samples samples;
    bvx_lattice box;
    bvx_window part;
    const char *first = NULL;
    int fits = 1;
    memset(&h, 0, sizeof h);
    h.source.ctx = source->ctx;
    h.source.format = "NRRD";
    h.source.begin = (const char *)source->begin;
    h.source.end = (const char *)source->end;
    BVXI_TRY(bvxi_nrrd_head_read(&h));
    nrrd_place(&h, origin, spacing);
    BVXI_TRY(bvxi_file_box(source->ctx, "NRRD", origin, spacing, h.sizes, &box));
    uint64_t const sample = bvxi_sample_size(h.kind);
    uint64_t const voxels = bvxi_mul(bvxi_mul(h.sizes[0], h.sizes[1], &fits), h.sizes[2], &fits);
    uint64_t const size = h.encoding == NRRD_RAW ? bvxi_mul(voxels, sample, &fits)
                                                 : bvxi_mul(voxels, 2, &fits) - 1; /* a digit and a space, none at the end */
    if (!fits)
        return bvxi_fail(source->ctx, BVX_ERR_FORMAT, "NRRD: %u x %u x %u samples are more than any file holds", h.sizes[0],
                         h.sizes[1], h.sizes[2]);
    BVXI_TRY(nrrd_find_samples(&h, size, &first));
    BVXI_TRY(bvxi_open_file_grid(source, "NRRD", &box, NULL, &part, grid));
    if (h.encoding == NRRD_TEXT) return nrrd_read_text(source, &h, first, &box, &part, grid);
    samples.first = (const uint8_t *)first;
    samples.kind = h.kind;
    samples.big = h.big;
    samples.stride[0] = sample;
    samples.stride[1] = sample * h.sizes[0];
    samples.stride[2] = sample * h.sizes[0] * h.sizes[1];
    return bvxi_pack_samples(source->ctx, &samples, &part, grid);
}
