/* test_write_field.c - distance fields in NPY, NRRD and VTI files: heads
 * byte by byte, numbers, what our own readers make of them. */
#include "field_support.h"

static const int32_t formats[] = {BVX_FORMAT_NPY, BVX_FORMAT_NRRD, BVX_FORMAT_VTI};

static double file_number(const uint8_t *p, int32_t type)
{
    uint64_t bits = 0;
    float f;
    double d;
    uint32_t low;

    for (int i = (type == BVX_F32 ? 4 : 8) - 1; i >= 0; i--) bits = bits << 8 | p[i];
    low = (uint32_t)bits;
    if (type == BVX_F64) {
        memcpy(&d, &bits, sizeof d);
        return d;
    }
    memcpy(&f, &low, sizeof f);
    return (double)f;
}

/* A field of a window that begins away from the lattice's corner. */
static bvx_field small_field(int32_t type, int32_t sign)
{
    static const double low[3] = {11, 23, 31}, high[3] = {13, 29, 31.75};
    bvx_lattice const l = lattice_with(10, 20, 30, 1, 2, 0.5, 72, 8, 6);
    bvx_field_options o = field_options(0.75, sign);

    maker_clear(&mesh);
    maker_box(&mesh, low, high);
    o.value_type = type;
    o.window.low[0] = 1;
    o.window.low[1] = 0;
    o.window.low[2] = 2;
    o.window.size[0] = 66;
    o.window.size[1] = 3;
    o.window.size[2] = 2;
    return field_by(ctx, &l, &o);
}

static bvx_buffer file_of(const bvx_field *f, int32_t vectors, int32_t format)
{
    bvx_buffer b = {0};
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_write_field(ctx, f, vectors, format, &b),
                                    bvx_last_message(ctx));
    return b;
}

/* Heads for f32 and f64, distances and vectors; the length that VTI puts before its numbers is no text. */
static const char *head_of(int32_t format, int32_t type, int32_t vectors, char *text)
{
    int const wide = type == BVX_F64, bits = wide ? 64 : 32;

    if (format == BVX_FORMAT_NPY) { /* 0x76 bytes behind the prefix: 128 in all */
        int n = sprintf(text + 10, "{'descr': '<f%d', 'fortran_order': True, 'shape': (66, 3, 2%s), }",
                        bits / 8, vectors ? ", 3" : "");
        memcpy(text, "\x93NUMPY\x01\0\x76\0", 10);
        for (n += 10; n < 127; n++) text[n] = ' ';
        strcpy(text + 127, "\n");
    } else if (format == BVX_FORMAT_NRRD) {
        sprintf(
            text,
            "NRRD0004\ntype: %s\ndimension: %d\nspace dimension: 3\nsizes: %s66 3 2\nspace directions: %s(1,0,0) (0,2,0) (0,0,0.5)\n"
            "space origin: (11.5,21,31.25)\ncenterings: %scell cell cell\nkinds: %sdomain domain domain\nendian: little\n"
            "encoding: raw\nbitvox low corner:=(11,20,31)\n\n",
            wide ? "double" : "float", vectors ? 4 : 3, vectors ? "3 " : "", vectors ? "none " : "",
            vectors ? "none " : "", vectors ? "vector " : "");
    } else {
        sprintf(
            text,
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\" "
            "header_type=\"UInt64\">\n  <ImageData WholeExtent=\"0 65 0 2 0 1\" Origin=\"11.5 21 31.25\" Spacing=\"1 2 0.5\">\n"
            "    <Piece Extent=\"0 65 0 2 0 1\">\n      <PointData %s>\n        <DataArray type=\"Float%d\" Name=\"%s\"%s "
            "format=\"appended\" offset=\"0\"/>\n      </PointData>\n      <CellData>\n      </CellData>\n    </Piece>\n"
            "  </ImageData>\n  <AppendedData encoding=\"raw\">\n    _",
            vectors ? "Vectors=\"vector\"" : "Scalars=\"distance\"", bits, vectors ? "vector" : "distance",
            vectors ? " NumberOfComponents=\"3\"" : "");
    }
    return text;
}

static void check_file(const bvx_field *f, int32_t vectors, int32_t format)
{
    static const char tail[] = "\n  </AppendedData>\n</VTKFile>\n";
    char text[1024];
    size_t const voxels = 66 * 3 * 2, each = vectors ? 3 : 1, number = f->value_type == BVX_F32 ? 4 : 8;
    size_t head = format == BVX_FORMAT_NPY ? 128 : strlen(head_of(format, f->value_type, vectors, text));
    size_t const end = format == BVX_FORMAT_VTI ? sizeof tail - 1 : 0;
    bvx_buffer b = file_of(f, vectors, format);

    head_of(format, f->value_type, vectors, text);
    TEST_ASSERT_EQUAL_MEMORY(text, b.bytes, head);
    if (format == BVX_FORMAT_VTI) {
        TEST_ASSERT_EQUAL_UINT64(voxels * each * number,
                                 (uint64_t)b.bytes[head] | (uint64_t)b.bytes[head + 1] << 8);
        for (size_t i = 2; i < 8; i++) TEST_ASSERT_EQUAL_UINT8(0, b.bytes[head + i]);
        head += 8;
        TEST_ASSERT_EQUAL_MEMORY(tail, b.bytes + b.size - end, end);
    }
    TEST_ASSERT_EQUAL_UINT64(head + voxels * each * number + end, b.size);
    for (size_t i = 0; i < voxels; i++) {
        int32_t const x = (int32_t)(i % 66), y = (int32_t)(i / 66 % 3), z = (int32_t)(i / 66 / 3);
        uint64_t const n = bvx_field_value(f, x, y, z);
        int const inside = f->inside.words != NULL && bvx_grid_get(&f->inside, x, y, z);
        for (size_t a = 0; a < each; a++) {
            size_t const at = format == BVX_FORMAT_NPY ? a * voxels + i : i * each + a;
            double const want = n == UINT64_MAX ? (vectors  ? 0.0
                                                   : inside ? -f->half_width
                                                            : f->half_width)
                                : vectors       ? number_at(f, f->vectors, 3 * n + a)
                                                : number_at(f, f->distances, n);
            double const got = file_number(b.bytes + head + at * number, f->value_type);
            TEST_ASSERT_EQUAL_DOUBLE(want, got);
            if (!vectors) TEST_ASSERT_EQUAL_INT(inside, signbit(got) != 0);
        }
    }
    bvx_buffer_free(ctx, &b);
}

static void test_heads_and_numbers(void)
{
    for (int32_t type = BVX_F32; type <= BVX_F64; type++)
        for (int32_t sign = BVX_FILL_PARITY; sign <= BVX_FILL_NONE; sign += BVX_FILL_NONE - BVX_FILL_PARITY) {
            bvx_field f = small_field(type, sign);
            TEST_ASSERT_TRUE_MESSAGE(f.value_count >= 12 && f.value_count < 66 * 6,
                                     "a band of a part of the window");
            for (int i = 0; i < 3; i++)
                for (int32_t vectors = 0; vectors < 2; vectors++) check_file(&f, vectors, formats[i]);
            bvx_field_free(ctx, &f);
        }
}

/* Our readers find the window's box, and a voxel where the distance is not 0. */
static void test_our_readers_find_the_place(void)
{
    bvx_field f = small_field(BVX_F32, BVX_FILL_PARITY);

    for (int i = 1; i < 3; i++) {
        bvx_buffer b = file_of(&f, 0, formats[i]);
        bvx_grid g = {0};
        TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_read_grid(ctx, b.bytes, b.size, formats[i], NULL, &g),
                                        bvx_last_message(ctx));
        TEST_ASSERT_EQUAL_DOUBLE(11, g.lattice.origin[0]);
        TEST_ASSERT_EQUAL_DOUBLE(20, g.lattice.origin[1]);
        TEST_ASSERT_EQUAL_DOUBLE(31, g.lattice.origin[2]);
        TEST_ASSERT_EQUAL_DOUBLE(2, g.lattice.spacing[1]);
        TEST_ASSERT_EQUAL_MEMORY(f.band.size, g.size, sizeof g.size);
        bvx_grid_free(ctx, &g);
        bvx_buffer_free(ctx, &b);
    }
    bvx_field_free(ctx, &f);
}

static void test_threads_and_code_paths_change_nothing(void)
{
    static const int32_t ways[][2] = {{1, BVX_CPU_PORTABLE}, {2, BVX_CPU_BEST}, {8, BVX_CPU_BEST}};
    bvx_lattice const l = lattice_with(0, 0, 0, 1, 1, 1, 70, 50, 40);
    static const double low[3] = {11, 13, 11}, high[3] = {60, 29, 31.75};
    bvx_field f;

    maker_box(&mesh, low, high);
    f = field_of(&l, 2, BVX_FILL_PARITY);
    for (int i = 0; i < 3; i++)
        for (int32_t vectors = 0; vectors < 2; vectors++) {
            bvx_buffer one = file_of(&f, vectors, formats[i]);
            for (int w = 0; w < 3; w++) {
                bvx_context *const other = suite_context(ways[w][0], ways[w][1]);
                bvx_buffer b = {0};
                TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_write_field(other, &f, vectors, formats[i], &b));
                TEST_ASSERT_EQUAL_UINT64(one.size, b.size);
                TEST_ASSERT_EQUAL_INT(0, memcmp(one.bytes, b.bytes, (size_t)b.size));
                bvx_buffer_free(other, &b);
                bvx_context_destroy(other);
            }
            bvx_buffer_free(ctx, &one);
        }
    bvx_field_free(ctx, &f);
}

static void test_refusals(void)
{
    bvx_field f = small_field(BVX_F32, BVX_FILL_PARITY), bad;
    bvx_buffer b = {0};
    uint8_t byte = 0;

#define REFUSED(status, word, field, vectors, format)                                             \
    do {                                                                                          \
        TEST_ASSERT_EQUAL_INT32(status, bvx_write_field(ctx, field, vectors, format, &b));        \
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(bvx_last_message(ctx), word), bvx_last_message(ctx)); \
        TEST_ASSERT_TRUE(b.bytes == NULL && b.size == 0);                                         \
    } while (0)
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_write_field(NULL, &f, 0, BVX_FORMAT_NPY, &b));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_write_field(ctx, &f, 0, BVX_FORMAT_NPY, NULL));
    REFUSED(BVX_ERR_ARGUMENT, "field", NULL, 0, BVX_FORMAT_NPY);
    REFUSED(BVX_ERR_ARGUMENT, "vectors is 3", &f, 3, BVX_FORMAT_NPY);
    REFUSED(BVX_ERR_UNSUPPORTED, "format 8", &f, 0, BVX_FORMAT_BINVOX);
    REFUSED(BVX_ERR_UNSUPPORTED, "format -1", &f, 0, -1);
    bad = f;
    bad.vectors = NULL;
    REFUSED(BVX_ERR_ARGUMENT, "no vectors", &bad, 1, BVX_FORMAT_NRRD);
    bad = f;
    bad.reserved[0] = 1;
    REFUSED(BVX_ERR_ARGUMENT, "reserved[0]", &bad, 0, BVX_FORMAT_NPY);
    memset(&bad, 0, sizeof bad);
    REFUSED(BVX_ERR_ARGUMENT, "empty", &bad, 0, BVX_FORMAT_NPY);
    b.bytes = &byte;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_write_field(ctx, &f, 0, BVX_FORMAT_NPY, &b));
    bvx_field_free(ctx, &f);
#undef REFUSED
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_heads_and_numbers);
    RUN_TEST(test_our_readers_find_the_place);
    RUN_TEST(test_threads_and_code_paths_change_nothing);
    RUN_TEST(test_refusals);
    return UNITY_END();
}
