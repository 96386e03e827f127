/* write_dense.c - a number for each voxel to NPY, NRRD and VTI: a grid's voxels as bytes 0 and 1, or a field's
 * samples at the voxels' centres, in the field's own type of numbers.
 *
 * Sources: numpy.lib.format 1.0; Kindlmann, Definition of NRRD File Format; VTK File Formats 1.0, with counts
 * of 64 bits. NPY says by Fortran order that x runs fastest. NRRD's space has no name, since a lattice does not
 * know left from right; its origin is the centre of the first sample, and as half a voxel may round, a key of
 * our own keeps the low corner. VTI has voxels as cells from the low corner on, samples as points from the first
 * centre on. Rows are written by themselves, little-endian, so neither threads nor the machine show. */
#include "field/room.h"
#include "io_grid/grid_formats.h"

enum {
    WRITTEN_GRAIN = 1 << 14, /* samples of the smallest task */
    NPY_PREFIX = 10,
    NPY_ALIGN = 64
};

typedef struct dense_written {
    const bvx_grid *grid;            /* its window is written */
    const bvx_field *field;          /* NULL: the grid's voxels */
    int32_t vectors;                 /* of the field */
    const uint8_t *labels, *palette; /* in place of the voxels; NULL: those */
    uint8_t used[256];               /* labels that voxels have */
    uint32_t bytes;                  /* of a number */
} dense_written;

typedef struct dense_format {
    const char *name, *what;                                    /* "NPY", "the NPY file", for messages */
    void (*put_head)(const dense_written *w, bvxi_output *out); /* called twice: to count and to write */
    const char *tail;
    int32_t planes; /* 1: all x, then all y, then all z of vectors; 0: the three of a centre together */
} dense_format;

static void first_centre(const dense_written *w, const double corner[3], double centre[3])
{
    bvxi_field_centre(w->grid, 0, 0, 0, centre);
    for (int a = 0; w->field == NULL && a < 3; a++) centre[a] = corner[a] + 0.5 * w->grid->lattice.spacing[a];
}

/* ---- heads ---- */

static void put_npy_dict(const dense_written *w, bvxi_output *out)
{
    bvxi_output_print(out, "{'descr': '%s', 'fortran_order': True, 'shape': (%w%s), }",
                      w->field == NULL ? "|b1"
                      : w->bytes == 4  ? "<f4"
                                       : "<f8",
                      w->grid->size, ", ", w->vectors ? ", 3" : "");
}

/* The dictionary is padded so that the numbers begin at a multiple of 64 bytes, and ends with a newline. */
static void put_npy(const dense_written *w, bvxi_output *out)
{
    static const uint8_t magic[8] = {0x93, 'N', 'U', 'M', 'P', 'Y', 1, 0};
    bvxi_output dict = {0};
    uint8_t length[2];
    put_npy_dict(w, &dict);
    uint64_t const size = (NPY_PREFIX + dict.size + 1 + NPY_ALIGN - 1) / NPY_ALIGN * NPY_ALIGN;
    bvxi_store_u16(length, (uint16_t)(size - NPY_PREFIX));
    bvxi_output_add(out, magic, sizeof magic);
    bvxi_output_add(out, length, sizeof length);
    put_npy_dict(w, out);
    while (out->size < size - 1) bvxi_output_print(out, " ");
    bvxi_output_print(out, "\n");
}

static void put_nrrd(const dense_written *w, bvxi_output *out)
{
    const double *const spacing = w->grid->lattice.spacing;
    double corner[3], centre[3];

    bvxi_grid_corner(w->grid, corner);
    first_centre(w, corner, centre);
    /* The axis of vectors comes first and lies in no direction of space. */
    bvxi_output_print(out, "NRRD0004\ntype: %s\ndimension: %s\nspace dimension: 3\nsizes: %s%w",
                      w->field == NULL ? "uint8"
                      : w->bytes == 4  ? "float"
                                       : "double",
                      w->vectors ? "4" : "3", w->vectors ? "3 " : "", w->grid->size, " ");
    bvxi_output_print(out, "\nspace directions:%s (%g,0,0) (0,%g,0) (0,0,%g)\nspace origin: (%v)",
                      w->vectors ? " none" : "", spacing[0], spacing[1], spacing[2], centre, ",");
    bvxi_output_print(out, w->vectors
                               ? "\ncenterings: none cell cell cell\nkinds: vector domain domain domain"
                               : "\ncenterings: cell cell cell\nkinds: domain domain domain");
    bvxi_output_print(out, "%s\nencoding: raw\n" BVXI_NRRD_CORNER_KEY ":=(%v)\n",
                      w->field != NULL ? "\nendian: little" : "", corner, ",");
    for (uint64_t i = 1, n = 0; i < 256 && w->labels != NULL; i++) {
        double rgb[3];

        if (!w->used[i]) continue;
        for (int k = 0; k < 3; k++) rgb[k] = (double)w->palette[4 * i + (uint64_t)k] / 255.0;
        bvxi_output_print(out, "Segment%u_LabelValue:=%u\nSegment%u_Color:=%v\n", n, i, n, rgb, " ");
        n++;
    }
    bvxi_output_print(out, "\n");
}

static void put_vti(const dense_written *w, bvxi_output *out)
{
    uint64_t const numbers = bvxi_grid_rows(w->grid) * (uint64_t)w->grid->size[0] * (w->vectors ? 3 : 1);
    int32_t const points = w->field != NULL;
    int32_t const last[3] = {w->grid->size[0] - points, w->grid->size[1] - points, w->grid->size[2] - points};
    uint8_t length[8];
    double corner[3], centre[3];

    bvxi_grid_corner(w->grid, corner);
    first_centre(w, corner, centre);
    bvxi_output_print(
        out,
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\" version=\"1.0\" "
        "byte_order=\"LittleEndian\" header_type=\"UInt64\">\n  <ImageData WholeExtent=\"0 %w\" "
        "Origin=\"%v\" Spacing=\"%v\">\n    <Piece Extent=\"0 %w\">\n",
        last, " 0 ", points ? centre : corner, " ", w->grid->lattice.spacing, " ", last, " 0 ");
    if (w->field == NULL)
        bvxi_output_print(out, "      <PointData>\n      </PointData>\n      <CellData Scalars=\"solid\">\n"
                               "        <DataArray type=\"UInt8\" Name=\"solid\" format=\"appended\" "
                               "offset=\"0\"/>\n      </CellData>\n");
    else
        bvxi_output_print(
            out,
            "      <PointData %s>\n        <DataArray type=\"Float%u\" Name=\"%s format=\"appended\" "
            "offset=\"0\"/>\n      </PointData>\n      <CellData>\n      </CellData>\n",
            w->vectors ? "Vectors=\"vector\"" : "Scalars=\"distance\"", (uint64_t)w->bytes * 8,
            w->vectors ? "vector\" NumberOfComponents=\"3\"" : "distance\"");
    bvxi_output_print(out, "    </Piece>\n  </ImageData>\n  <AppendedData encoding=\"raw\">\n    _");
    bvxi_store_u64(length, numbers * w->bytes);
    bvxi_output_add(out, length, sizeof length);
}

static const dense_format npy_format = {"NPY", "the NPY file", put_npy, "", 1};
static const dense_format nrrd_format = {"NRRD", "the NRRD file", put_nrrd, "", 0};
static const dense_format vti_format = {"VTI", "the VTI file", put_vti, "\n  </AppendedData>\n</VTKFile>\n",
                                        0};

/* ---- numbers ---- */

typedef struct field_file_job {
    const bvx_field *field;
    uint8_t *bytes;
    uint64_t stride, plane; /* from centre to centre, from component to component [Units: numbers] */
    uint32_t size, each;    /* bytes of a number, numbers of a centre */
} field_file_job;

static void write_field_rows(void *user, uint64_t row, uint64_t end)
{
    const field_file_job *const job = user;
    const bvx_grid *const g = &job->field->band;
    double numbers[3 * BVXI_WORD_BITS];

    for (; row < end; row++) {
        /* Values stand in the order of the set voxels; next is the first one of this row. */
        uint64_t next = job->field->row_values[row], voxel = row * (uint64_t)g->size[0];

        for (int32_t k = 0; k < g->words_per_row; k++) {
            int32_t const left = g->size[0] - k * BVXI_WORD_BITS;
            uint64_t const n = (uint64_t)(left < BVXI_WORD_BITS ? left : BVXI_WORD_BITS);
            bvxi_field_word(job->field, row, k, job->each == 3, &next, numbers);
            for (uint64_t i = 0; i < n; i++, voxel++)
                for (uint64_t a = 0; a < job->each; a++) {
                    uint8_t *const to = job->bytes + (voxel * job->stride + a * job->plane) * job->size;
                    if (job->size == 4) bvxi_store_f32(to, bvxi_field_float(numbers[i * job->each + a]));
                    else bvxi_store_f64(to, numbers[i * job->each + a]);
                }
        }
    }
}

static bvx_status write_numbers(bvx_context *ctx, const dense_written *w, const dense_format *format,
                                uint64_t voxels, uint8_t *bytes)
{
    field_file_job job = {w->field, bytes, 1, 1, w->bytes, w->vectors ? 3 : 1};
    if (w->labels == NULL && w->field == NULL) return bvxi_unpack_grid(ctx, w->grid, bytes);
    if (w->labels != NULL) {
        memcpy(bytes, w->labels, (size_t)voxels);
        return BVX_OK;
    }
    if (format->planes) job.plane = voxels;
    else job.stride = job.each;
    return bvxi_for(ctx, "write", bvxi_grid_rows(w->grid), 1 + WRITTEN_GRAIN / (uint64_t)w->grid->size[0],
                    write_field_rows, &job);
}

static bvx_status write_file(bvx_context *ctx, const char *function, const dense_written *w, int32_t number,
                             bvx_buffer *file)
{
    const dense_format *const format = number == BVX_FORMAT_NPY    ? &npy_format
                                       : number == BVX_FORMAT_NRRD ? &nrrd_format
                                                                   : &vti_format;
    uint64_t const tail = bvxi_text_length(format->tail);
    bvxi_output head = {0};
    bvx_buffer made = {0};
    int fits = 1;

    /* NPY holds no place, so only the others need a finite one. */
    if (format != &npy_format) BVXI_TRY(bvxi_check_written_corner(ctx, format->name, w->grid));
    format->put_head(w, &head);
    uint64_t const voxels = bvxi_mul(bvxi_grid_rows(w->grid), (uint64_t)w->grid->size[0], &fits);
    uint64_t const numbers = bvxi_mul(voxels, w->bytes * (w->vectors ? 3 : 1), &fits);
    uint64_t const size = bvxi_add(numbers, head.size + tail, &fits);
    if (!fits)
        return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                             "%s: the file would have 2^64 bytes or more", function);

    BVXI_TRY(bvxi_make_buffer(ctx, size, format->what, &made));
    head.bytes = made.bytes;
    head.size = 0;
    format->put_head(w, &head);
    memcpy(made.bytes + size - tail, format->tail, (size_t)tail);
    bvx_status const status = write_numbers(ctx, w, format, voxels, made.bytes + head.size);
    if (status != BVX_OK) bvx_buffer_free(ctx, &made);
    else *file = made;
    return status;
}

bvx_status bvxi_write_dense(bvx_context *ctx, const bvx_grid *grid, int32_t format, bvx_buffer *file)
{
    dense_written const w = {.grid = grid, .bytes = 1};
    return write_file(ctx, "bvx_write_grid", &w, format, file);
}

bvx_status bvxi_write_segments(bvx_context *ctx, const bvx_grid *grid, const uint8_t *labels,
                               const uint8_t *palette, bvx_buffer *file)
{
    dense_written w = {.grid = grid, .bytes = 1, .labels = labels, .palette = palette};
    uint64_t const voxels = bvxi_grid_rows(grid) * (uint64_t)grid->size[0];
    for (uint64_t i = 0; i < voxels; i++) w.used[labels[i]] = 1;
    return write_file(ctx, "bvx_write_labels", &w, BVX_FORMAT_NRRD, file);
}

static bvx_status run_write_field(bvx_context *context, const bvx_field *field, int32_t vectors,
                                  int32_t format, bvx_buffer *file)
{
    static const char *const function = "bvx_write_field";
    dense_written w = {.field = field, .vectors = vectors};
    BVXI_TRY(bvxi_renew_buffer(context, function, file));
    BVXI_TRY(bvxi_field_check(context, function, field));
    BVXI_TRY(bvxi_field_check_vectors(context, function, field, vectors));
    if (format == BVX_FORMAT_VDB && vectors == 0) return bvxi_write_vdb(context, &field->band, field, file);
    if (format == BVX_FORMAT_NVDB && vectors == 0) return bvxi_write_nvdb(context, &field->band, field, file);
    if (format != BVX_FORMAT_NPY && format != BVX_FORMAT_NRRD && format != BVX_FORMAT_VTI)
        return bvxi_fail(
            context, BVX_ERR_UNSUPPORTED,
            "%s: format %d holds no such field; take NPY, NRRD, VTI or, of distances, VDB or NVDB", function,
            (int64_t)format);
    w.grid = &field->band;
    w.bytes = field->value_type == BVX_F32 ? 4 : 8;
    return write_file(context, function, &w, format, file);
}

bvx_status bvx_write_field(bvx_context *context, const bvx_field *field, int32_t vectors, int32_t format,
                           bvx_buffer *file)
{
    return BVXI_CALL(context, run_write_field(context, field, vectors, format, file));
}
