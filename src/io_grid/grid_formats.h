/* grid_formats.h - the readers and writers of grids, one a format, and what they share. They trust their
 * arguments: grid_file.c has checked them. Not installed. */
#ifndef BVXI_GRID_FORMATS_H
#define BVXI_GRID_FORMATS_H

#include "grid/grid.h"
#include "io/xml_scan.h"
#include "io/formats.h"

/* ---- readers: arguments are checked; grid is what the caller gave, and freed by him on failure ---- */

typedef struct bvxi_grid_source {
    bvx_context *ctx;
    const char *format; /* "BVX", for messages */
    const uint8_t *begin, *end;
    const bvx_window *window;              /* voxels of the file that are wanted; NULL: all */
    const bvx_read_volume_options *volume; /* the samples themselves are wanted; NULL: a grid */
} bvxi_grid_source;

/* The source of a file, refused where it is no bytes. */
bvx_status bvxi_take_grid_file(bvx_context *ctx, const char *function, const void *bytes, uint64_t size,
                               int32_t format, bvxi_grid_source *source);
static inline uint64_t bvxi_grid_byte(const bvxi_grid_source *source, const void *at)
{
    return (uint64_t)((const uint8_t *)at - source->begin);
}

bvx_status bvxi_read_binvox(const bvxi_grid_source *source, bvx_grid *grid);
/* labels NULL: the grid only. */
bvx_status bvxi_read_vox(const bvxi_grid_source *source, bvx_grid *grid, bvx_buffer *labels,
                         uint8_t *palette);
bvx_status bvxi_read_bvx(const bvxi_grid_source *source, bvx_grid *grid);

/* The box that a file says it holds: refused (with the format's name in the message) when it is no
 * lattice. */
bvx_status bvxi_file_box(const bvxi_grid_source *source, const double origin[3], const double spacing[3],
                         const uint64_t dims[3], bvx_lattice *box);
/* Make the grid for the wanted part of the file's window: all bits zero. *part becomes what is wanted,
 * counted from the file's first voxel. Refuses a window outside the file. Call it only when the file's size
 * agrees with its head, so that a small file cannot require much memory (packed formats: at most what their
 * bytes can stand for). */
bvx_status bvxi_open_file_grid(const bvxi_grid_source *source, const bvx_lattice *lattice,
                               const bvx_window *file_window, bvx_window *part, bvx_grid *grid);

/* A run of set voxels of the file, [x, end) in row (y, z) of the file's
 * box; what lies outside part is left out. */
void bvxi_set_file_run(bvx_grid *grid, const bvx_window *part, int64_t x, int64_t end, int64_t y, int64_t z);

/* ---- dense samples: npy, nrrd, vti ---- */

/* Kinds of numbers in files: BVX_SAMPLE_..., and one that volumes hold as F32. */
enum { BVXI_SAMPLE_F16 = BVX_SAMPLE_F64 + 1 };

/* Bytes of one number; 0 for no kind. */
static inline uint32_t bvxi_sample_size(int32_t kind)
{
    static const uint8_t size[12] = {0, 1, 1, 2, 2, 4, 4, 8, 8, 4, 8, 2};
    return kind >= 1 && kind <= 11 ? size[kind] : 0;
}

/* Samples in a file: the one of voxel (x,y,z) stands at first + x *
 * stride[0] + y * stride[1] + z * stride[2]. */
typedef struct bvxi_samples {
    const uint8_t *first;
    int64_t stride[3]; /* [Units: bytes] */
    int32_t kind;      /* BVX_SAMPLE_..., BVXI_SAMPLE_F16 */
    int32_t big;       /* 1: big-endian */
} bvxi_samples;

/* One after the other, x fastest; the bytes of all of them fit 63 bits. */
static inline void bvxi_pack_strides(bvxi_samples *samples, const bvx_lattice *box)
{
    samples->stride[0] = (int64_t)bvxi_sample_size(samples->kind);
    samples->stride[1] = samples->stride[0] * box->dims[0];
    samples->stride[2] = samples->stride[1] * box->dims[1];
}

/* How a file holds samples. */
enum { BVXI_DENSE_RAW = 0, BVXI_DENSE_TEXT, BVXI_DENSE_BASE64, BVXI_DENSE_GZIP, BVXI_DENSE_BLOCKS };

/* What a file of samples says of itself, checked: sizes agree with the
 * bytes that are there as far as is known. */
typedef struct bvxi_dense {
    bvx_lattice box;
    int32_t placed;   /* 0: the file tells no lattice */
    int32_t encoding; /* BVXI_DENSE_... */
    /* RAW: where they stand; others: packed, x fastest, from the first byte of what is unpacked */
    bvxi_samples samples;
    uint64_t size;           /* of all samples, but for TEXT [Units: bytes] */
    bvxi_source source;      /* TEXT, BASE64: the file that lines are counted in; its end is the text's */
    const char *begin, *end; /* TEXT, GZIP: what is to be unpacked */
    /* TEXT, BASE64: "the end of the array": what must stand there; NULL: anything may */
    const char *behind;
    const char *array;  /* BASE64, BLOCKS: its tag, for messages */
    bvxi_base64 base64; /* BASE64, BLOCKS: where samples or their head begin, and where the text ends */
    int32_t is_text, number_size; /* BLOCKS: 1: in base 64; bytes of a number of the head */
} bvxi_dense;

bvx_status bvxi_find_npy(const bvxi_grid_source *source, bvxi_dense *dense);
bvx_status bvxi_find_nrrd(const bvxi_grid_source *source, bvxi_dense *dense);
bvx_status bvxi_find_vti(const bvxi_grid_source *source, bvxi_dense *dense);
/* vti_blocks.c: refuse packed blocks that the bytes cannot hold; how many bytes they say they make. */
bvx_status bvxi_check_blocks(const bvxi_dense *dense, uint64_t *size);
bvx_status bvxi_unpack_blocks(const bvxi_grid_source *source, const bvxi_dense *dense, uint8_t *bytes);
/* "VTI: line 3: the array's 64 bytes are not all there (byte 70)". */
BVXI_COLD bvx_status bvxi_fail_short_array(const bvxi_source *source, const char *array, uint64_t size,
                                           const char *at);

/* dense_file.c: the voxels whose sample is not 0. */
bvx_status bvxi_read_dense_grid(const bvxi_grid_source *source, const bvxi_dense *dense, bvx_grid *grid);
/* Packed samples of encodings other than RAW and TEXT, dense->size bytes in the file's byte order. */
bvx_status bvxi_unpack_dense(const bvxi_grid_source *source, const bvxi_dense *dense, uint8_t *bytes);
/* The next number of a text, with white space or the end after it; done is
 * how many there were. *p moves after it. */
bvx_status bvxi_take_sample(const bvxi_source *source, const int32_t dims[3], uint64_t done, const char **p,
                            double *value);

/* Set the grid's voxels where samples are not 0 (-0 is 0, NaN is not); the grid is of the part of the file
 * that is wanted. Rows of bytes in x order are packed eight at a time; runs in parallel over slices. */
bvx_status bvxi_pack_samples(bvx_context *ctx, const bvxi_samples *samples, const bvx_window *part,
                             bvx_grid *grid);
/* All rows of the grid, one after the other; runs in parallel. */
bvx_status bvxi_unpack_grid(bvx_context *ctx, const bvx_grid *grid, uint8_t *bytes);

/* ---- writers: arguments are checked ---- */

/* write_dense.c: NPY, NRRD, VTI. */
bvx_status bvxi_write_dense(bvx_context *ctx, const bvx_grid *grid, int32_t format, bvx_buffer *file);
/* NRRD of labels with the colours of those that voxels have. */
bvx_status bvxi_write_segments(bvx_context *ctx, const bvx_grid *grid, const uint8_t *labels,
                               const uint8_t *palette, bvx_buffer *file);
/* Refuse a grid whose first voxel has a corner or centre that is not
 * finite: text of a format could not give it. */
bvx_status bvxi_check_written_corner(bvx_context *ctx, const char *format, const bvx_grid *grid);

bvx_status bvxi_write_binvox(bvx_context *ctx, const bvx_grid *grid, bvx_buffer *file);
/* labels NULL: all voxels are white. */
bvx_status bvxi_write_vox(bvx_context *ctx, const bvx_grid *grid, const uint8_t *labels,
                          const uint8_t *palette, bvx_buffer *file);
bvx_status bvxi_write_bvx(bvx_context *ctx, const bvx_grid *grid, bvx_buffer *file);
/* The voxels of a grid, or the distances of a field, whose band is the grid. */
bvx_status bvxi_write_vdb(bvx_context *ctx, const bvx_grid *grid, const bvx_field *field, bvx_buffer *file);
bvx_status bvxi_write_nvdb(bvx_context *ctx, const bvx_grid *grid, const bvx_field *field, bvx_buffer *file);

/* Key of an NRRD file that keeps the low corner unrounded. */
#define BVXI_NRRD_CORNER_KEY "bitvox low corner"

/* The world's place of the low corner of the grid's window. */
static inline void bvxi_grid_corner(const bvx_grid *grid, double corner[3])
{
    for (int a = 0; a < 3; a++)
        corner[a] = grid->lattice.origin[a] + (double)grid->low[a] * grid->lattice.spacing[a];
}

#endif
