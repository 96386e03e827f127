/* write_field.c - a distance field, dense, to NPY, NRRD and VTI: samples at the centres, in the field's own
 * type of numbers.
 *
 * Sources: numpy.lib.format 1.0; Kindlmann, Definition of NRRD File Format; VTK File Formats 1.0. Here
 * samples are points: NRRD's origin and VTI's Origin are the centre of the window's first voxel; NRRD keeps
 * the low corner beside it, as for grids. Rows are written by themselves, little-endian, so neither threads
 * nor the machine show. */
#include "field/room.h"
#include "io/formats.h"
#include "io_grid/grid_formats.h"

enum {
    FIELD_FILE_GRAIN = 1 << 14,
    /* centres of the smallest task */ FIELD_NPY_PREFIX = 10,
    FIELD_NPY_ALIGN = 64
};

/* A format: what comes before the numbers (called twice: to count and to write) and after them. */
typedef struct field_file {
    const char *what; /* "the NPY file", for messages */
    void (*put_head)(const bvx_field *field, int32_t vectors, bvxi_output *out);
    const char *tail;
    int32_t planes; /* 1: all x, then all y, then all z of vectors; 0: the three of a centre together */
} field_file;

static uint64_t field_number_bytes(const bvx_field *field)
{
    return field->value_type == BVX_F32 ? 4 : 8;
}

static uint64_t field_voxels(const bvx_field *field)
{
    return bvxi_grid_rows(&field->band) * (uint64_t)field->band.size[0];
}

/* ---- text ---- */

static void field_put_number(bvxi_output *out, double v)
{
    char text[32];
    bvxi_output_add(out, text, (size_t)bvxi_print_double(v, text));
}

/* Three numbers between open and close. */
static void field_put_three(bvxi_output *out, const char *open, double x, double y, double z,
                            const char *between, const char *close)
{
    bvxi_output_text(out, open);
    field_put_number(out, x);
    bvxi_output_text(out, between);
    field_put_number(out, y);
    bvxi_output_text(out, between);
    field_put_number(out, z);
    bvxi_output_text(out, close);
}

static void field_put_sizes(bvxi_output *out, const bvx_field *field, const char *between)
{
    for (int a = 0; a < 3; a++) {
        if (a > 0) bvxi_output_text(out, between);
        bvxi_output_number(out, (uint64_t)field->band.size[a]);
    }
}

/* ---- NPY ---- */

static void field_put_npy_dict(const bvx_field *field, int32_t vectors, bvxi_output *out)
{
    bvxi_output_text(out, "{'descr': '<f");
    bvxi_output_number(out, field_number_bytes(field));
    bvxi_output_text(out, "', 'fortran_order': True, 'shape': (");
    field_put_sizes(out, field, ", ");
    bvxi_output_text(out, vectors ? ", 3), }" : "), }");
}

static void field_put_npy(const bvx_field *field, int32_t vectors, bvxi_output *out)
{
    static const uint8_t magic[8] = {0x93, 'N', 'U', 'M', 'P', 'Y', 1, 0};
    bvxi_output dict = {0};
    uint8_t length[2];

    field_put_npy_dict(field, vectors, &dict);

    /* The dictionary is padded so that the numbers begin at a multiple of 64 bytes, as the format advises. */
    uint64_t const size = (FIELD_NPY_PREFIX + dict.size + 1 + FIELD_NPY_ALIGN - 1) / FIELD_NPY_ALIGN *
                          FIELD_NPY_ALIGN;
    uint64_t const end = out->size + size;
    bvxi_store_u16(length, (uint16_t)(size - FIELD_NPY_PREFIX));
    bvxi_output_add(out, magic, sizeof magic);
    bvxi_output_add(out, length, sizeof length);
    field_put_npy_dict(field, vectors, out);
    /* The newline is the last byte of the padding. */
    while (out->size < end - 1) bvxi_output_text(out, " ");
    bvxi_output_text(out, "\n");
}

/* ---- NRRD ---- */

static void field_put_nrrd(const bvx_field *field, int32_t vectors, bvxi_output *out)
{
    const double *const s = field->band.lattice.spacing;
    double c[3], first[3];

    bvxi_grid_corner(&field->band, c);

    /* The centre is what the format calls the origin; the corner
     * goes into a key of its own, as a difference may round. */
    bvxi_field_centre(&field->band, 0, 0, 0, first);
    bvxi_output_text(out, "NRRD0004\ntype: ");
    bvxi_output_text(out, field->value_type == BVX_F32 ? "float" : "double");
    /* With vectors the first axis has three components and lies in no direction of space. */
    bvxi_output_text(out, vectors ? "\ndimension: 4\nspace dimension: 3\nsizes: 3 "
                                  : "\ndimension: 3\nspace dimension: 3\nsizes: ");
    field_put_sizes(out, field, " ");
    bvxi_output_text(out, vectors ? "\nspace directions: none " : "\nspace directions: ");
    field_put_three(out, "(", s[0], 0, 0, ",", ") ");
    field_put_three(out, "(", 0, s[1], 0, ",", ") ");
    field_put_three(out, "(", 0, 0, s[2], ",", ")");
    field_put_three(out, "\nspace origin: (", first[0], first[1], first[2], ",", ")");
    bvxi_output_text(out, vectors ? "\ncenterings: none cell cell cell\nkinds: vector domain domain domain"
                                  : "\ncenterings: cell cell cell\nkinds: domain domain domain");
    bvxi_output_text(out, "\nendian: little\nencoding: raw\n" BVXI_NRRD_CORNER_KEY ":=");
    field_put_three(out, "(", c[0], c[1], c[2], ",", ")\n\n");
}

/* ---- VTI ---- */

static void field_put_vti_extent(const bvx_field *field, bvxi_output *out)
{
    for (int a = 0; a < 3; a++) {
        bvxi_output_text(out, a > 0 ? " 0 " : "0 ");
        bvxi_output_number(out, (uint64_t)field->band.size[a] - 1);
    }
}

static void field_put_vti(const bvx_field *field, int32_t vectors, bvxi_output *out)
{
    const double *const s = field->band.lattice.spacing;
    uint64_t const bytes = field_voxels(field) * field_number_bytes(field) * (vectors ? 3 : 1);
    uint8_t length[8];
    double first[3];

    /* Samples are points here, so the first one is at the origin and the extent ends at size - 1. */
    bvxi_field_centre(&field->band, 0, 0, 0, first);
    bvxi_output_text(
        out,
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\" "
        "header_type=\"UInt64\">\n  <ImageData WholeExtent=\"");
    field_put_vti_extent(field, out);
    field_put_three(out, "\" Origin=\"", first[0], first[1], first[2], " ", "\" Spacing=\"");
    field_put_three(out, "", s[0], s[1], s[2], " ", "\">\n    <Piece Extent=\"");
    field_put_vti_extent(field, out);
    bvxi_output_text(
        out, vectors ? "\">\n      <PointData Vectors=\"vector\">\n        <DataArray type=\"Float"
                     : "\">\n      <PointData Scalars=\"distance\">\n        <DataArray type=\"Float");
    bvxi_output_number(out, 8 * field_number_bytes(field));
    bvxi_output_text(out, vectors ? "\" Name=\"vector\" NumberOfComponents=\"3\"" : "\" Name=\"distance\"");
    bvxi_output_text(
        out,
        " format=\"appended\" offset=\"0\"/>\n      </PointData>\n      <CellData>\n      </CellData>\n    "
        "</Piece>\n"
        "  </ImageData>\n  <AppendedData encoding=\"raw\">\n    _");
    bvxi_store_u32(length, (uint32_t)(bytes & 0xffffffffu));
    bvxi_store_u32(length + 4, (uint32_t)(bytes >> 32));
    bvxi_output_add(out, length, sizeof length);
}

/* ---- numbers ---- */

typedef struct field_file_job {
    const bvx_field *field;
    uint8_t *bytes;
    uint64_t stride, plane; /* from centre to centre, from component to component [Units: numbers] */
    int32_t vectors;
} field_file_job;

static void write_field_rows(void *user, uint64_t row, uint64_t end)
{
    const field_file_job *const job = user;
    const bvx_grid *const g = &job->field->band;
    uint64_t const each = job->vectors ? 3 : 1, size = field_number_bytes(job->field);
    double numbers[3 * BVXI_WORD_BITS];

    for (; row < end; row++) {
        /* Values stand in the order of the set voxels; next is the first one of this row. */
        uint64_t next = job->field->row_values[row], voxel = row * (uint64_t)g->size[0];
        for (int32_t k = 0; k < g->words_per_row; k++) {
            int32_t const left = g->size[0] - k * BVXI_WORD_BITS;
            uint64_t const n = (uint64_t)(left < BVXI_WORD_BITS ? left : BVXI_WORD_BITS);
            /* A word at a time: set voxels take their values,
             * the others what the field says beyond its band. */
            bvxi_field_word(job->field, row, k, job->vectors, &next, numbers);
            for (uint64_t i = 0; i < n; i++, voxel++)
                for (uint64_t a = 0; a < each; a++) {
                    uint8_t *const to = job->bytes + (voxel * job->stride + a * job->plane) * size;
                    if (size == 4) bvxi_store_f32(to, bvxi_field_float(numbers[i * each + a]));
                    else bvxi_store_f64(to, numbers[i * each + a]);
                }
        }
    }
}

static bvx_status write_field_file(bvx_context *ctx, const bvx_field *field, int32_t vectors,
                                   const field_file *kind, bvx_buffer *file)
{
    uint64_t const tail = bvxi_text_length(kind->tail), voxels = field_voxels(field);
    bvxi_output head = {0};
    bvx_buffer made = {0};
    field_file_job job;
    bvx_status status;
    int fits = 1;

    /* The head is counted first; its length is part of the size. */
    kind->put_head(field, vectors, &head);
    uint64_t const numbers = bvxi_mul(voxels, field_number_bytes(field) * (vectors ? 3 : 1), &fits);
    uint64_t const size = bvxi_add(numbers, head.size + tail, &fits);
    if (!fits)
        return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                             "bvx_write_field: the file would have 2^64 bytes or more");

    /* Made once, in its exact size, as all numbers have one length. */
    BVXI_TRY(bvxi_make_buffer(ctx, size, kind->what, &made));
    head.bytes = made.bytes;
    head.size = 0;
    kind->put_head(field, vectors, &head);
    memcpy(made.bytes + size - tail, kind->tail, (size_t)tail);
    job.field = field;
    job.bytes = made.bytes + head.size;

    /* Together: three numbers a centre. In planes: one, and the components a whole array apart. */
    job.stride = vectors && !kind->planes ? 3 : 1;
    job.plane = kind->planes ? voxels : 1;
    job.vectors = vectors;
    status = bvxi_for(ctx, "write", bvxi_grid_rows(&field->band),
                      1 + FIELD_FILE_GRAIN / (uint64_t)field->band.size[0], write_field_rows, &job);
    if (status != BVX_OK) bvx_buffer_free(ctx, &made);
    else *file = made;
    return status;
}

static bvx_status run_write_field(bvx_context *context, const bvx_field *field, int32_t vectors,
                                  int32_t format, bvx_buffer *file)
{
    static const char *const function = "bvx_write_field";
    static const field_file npy = {"the NPY file", field_put_npy, "", 1},
                            nrrd = {"the NRRD file", field_put_nrrd, "", 0},
                            vti = {"the VTI file", field_put_vti, "\n  </AppendedData>\n</VTKFile>\n", 0};

    BVXI_TRY(bvxi_renew_buffer(context, function, file));
    BVXI_TRY(bvxi_field_check(context, function, field));
    BVXI_TRY(bvxi_field_check_vectors(context, function, field, vectors));
    if (format != BVX_FORMAT_NPY && format != BVX_FORMAT_NRRD && format != BVX_FORMAT_VTI)
        return bvxi_fail(context, BVX_ERR_UNSUPPORTED, "%s: format %d holds no field; take NPY, NRRD or VTI",
                         function, (int64_t)format);
    if (format == BVX_FORMAT_NPY) return write_field_file(context, field, vectors, &npy, file);
    /* NPY holds no place, so only the others need a finite one. */
    BVXI_TRY(bvxi_check_written_corner(context, format == BVX_FORMAT_NRRD ? "NRRD" : "VTI", &field->band));
    return write_field_file(context, field, vectors, format == BVX_FORMAT_NRRD ? &nrrd : &vti, file);
}

bvx_status bvx_write_field(bvx_context *context, const bvx_field *field, int32_t vectors, int32_t format,
                           bvx_buffer *file)
{
    return BVXI_CALL(context, run_write_field(context, field, vectors, format, file));
}
