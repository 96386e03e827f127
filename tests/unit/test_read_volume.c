/* test_read_volume.c - volumes read from the bytes of files: values,
 * places, what is refused, and files cut at every byte. */
#include "volume_support.h"

#include "bitvox_io.h"

#include <stdio.h>

static bvx_volume volume;

static bvx_status read_text(const char *head, const void *data, size_t size, int32_t format,
                            const bvx_read_volume_options *o)
{
    static uint8_t file[65536];
    size_t const n = strlen(head);
    memcpy(file, head, n);
    if (size != 0) memcpy(file + n, data, size);
    bvx_volume_free(ctx, &volume);
    return bvx_read_volume(ctx, file, n + size, format, o, &volume);
}

static int machine_big(void)
{
    uint16_t const one = 1;
    uint8_t first;
    memcpy(&first, &one, 1);
    return first == 0;
}

/* 24 samples of a type as a file has them. */
static size_t put_samples(uint8_t *to, int32_t type, int big)
{
    size_t const size = type_size(type);
    for (int i = 0; i < 24; i++) {
        uint8_t one[8];
        store_sample(one, type, i * 5);
        for (size_t b = 0; b < size; b++)
            to[(size_t)i * size + b] = one[big == machine_big() ? b : size - 1 - b];
    }
    return 24 * size;
}

static void check_samples(int32_t type)
{
    bvx_volume_report r;

    TEST_ASSERT_EQUAL_INT32(type, volume.view.sample_type);
    for (int i = 0; i < 24; i++) {
        uint8_t one[8];
        int64_t const step = (int64_t)type_size(type);
        int const packed = volume.view.strides[0] == 0;
        int64_t const at = packed ? i * step
                                  : (i % 4) * volume.view.strides[0] + (i / 4 % 3) * volume.view.strides[1] +
                                        (i / 12) * volume.view.strides[2];
        store_sample(one, type, i * 5);
        TEST_ASSERT_EQUAL_MEMORY(one, (const uint8_t *)volume.view.samples + at, (size_t)step);
    }
    bvx_grid g = {0};
    /* the view is a good one */
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_threshold(ctx, &volume.view, 50, INFINITY, &r, &g));
    TEST_ASSERT_EQUAL_UINT64(14, r.inside);
    bvx_grid_free(ctx, &g);
}

static const char *const nrrd_types[] = {"",      "uint8",  "int8",  "uint16", "int16", "uint32",
                                         "int32", "uint64", "int64", "float",  "double"};

static void test_nrrd_of_every_type_and_order(void)
{
    for (int32_t type = BVX_SAMPLE_U8; type <= BVX_SAMPLE_F64; type++)
        for (int big = 0; big < 2; big++) {
            char head[512];
            uint8_t data[256];
            size_t const size = put_samples(data, type, big);
            snprintf(
                head, sizeof head,
                "NRRD0004\ntype: %s\ndimension: 3\nsizes: 4 3 2\nspacings: 1 2 4\naxis mins: 8 9 10\nencoding: raw\nendian: %s\n\n",
                nrrd_types[type], big ? "big" : "little");
            TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, read_text(head, data, size, BVX_FORMAT_NRRD, NULL),
                                            bvx_last_message(ctx));
            /* copied only to be turned */
            TEST_ASSERT_EQUAL_INT32(type_size(type) > 1 && big != machine_big(), volume.owned);
            TEST_ASSERT_EQUAL_DOUBLE(4, volume.view.lattice.spacing[2]);
            TEST_ASSERT_EQUAL_DOUBLE(9, volume.view.lattice.origin[1]);
            TEST_ASSERT_EQUAL_INT32(1, volume.placed);
            check_samples(type);
            bvx_volume_free(ctx, &volume);
        }
}

static void test_nrrd_text_of_every_type(void)
{
    static const char samples[] =
        "0 5 10 15\n20 25 30 35 40 45 50 55 60 65 70 75 80 85 90 95\t100 105 110 115\n";

    for (int32_t type = BVX_SAMPLE_U8; type <= BVX_SAMPLE_F64; type++) {
        char head[512];
        snprintf(head, sizeof head, "NRRD0004\ntype: %s\ndimension: 3\nsizes: 4 3 2\nencoding: ascii\n\n",
                 nrrd_types[type]);
        TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK,
                                        read_text(head, samples, sizeof samples - 1, BVX_FORMAT_NRRD, NULL),
                                        bvx_last_message(ctx));
        TEST_ASSERT_EQUAL_INT32(1, volume.owned);
        check_samples(type);
        bvx_volume_free(ctx, &volume);
    }
}

static void test_nrrd_text_that_the_type_cannot_hold(void)
{
    static const struct {
        const char *type, *number;
    } bad[] = {{"uint8", "256"},        {"uint8", "-1"},     {"int8", "128"},
               {"int8", "-129"},        {"uint16", "65536"}, {"int16", "1.5"},
               {"int32", "2147483648"}, {"uint32", "nan"},   {"int64", "9007199254740994"},
               {"uint64", "-1"},        {"int8", "inf"}};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        char head[512];
        snprintf(head, sizeof head, "NRRD0004\ntype: %s\ndimension: 3\nsizes: 1 1 1\nencoding: ascii\n\n%s\n",
                 bad[i].type, bad[i].number);
        TEST_ASSERT_EQUAL_INT32(BVX_ERR_FORMAT, read_text(head, NULL, 0, BVX_FORMAT_NRRD, NULL));
        TEST_ASSERT_NULL(volume.view.samples);
    }
}

/* "Packing" that turns every bit round. */
static int32_t unpack_inverted(void *user, const void *packed, uint64_t packed_size, void *plain,
                               uint64_t plain_size)
{
    ++*(int *)user;
    if (packed_size != plain_size) return 7;
    for (uint64_t i = 0; i < plain_size; i++) ((uint8_t *)plain)[i] = (uint8_t) ~((const uint8_t *)packed)[i];
    return 0;
}

static void test_nrrd_gzip_by_the_callers_function(void)
{
    int calls = 0;
    bvx_read_volume_options o = {.struct_size = sizeof o};

    o.inflate = unpack_inverted;
    o.inflate_user = &calls;
    for (int big = 0; big < 2; big++) {
        char head[512];
        uint8_t data[256];
        size_t const size = put_samples(data, BVX_SAMPLE_U16, big);
        for (size_t i = 0; i < size; i++) data[i] = (uint8_t)~data[i];
        snprintf(head, sizeof head,
                 "NRRD0004\ntype: ushort\ndimension: 3\nsizes: 4 3 2\nencoding: gzip\nendian: %s\n\n",
                 big ? "big" : "little");
        TEST_ASSERT_EQUAL_INT32(BVX_OK, read_text(head, data, size, BVX_FORMAT_NRRD, &o));
        check_samples(BVX_SAMPLE_U16);
        TEST_ASSERT_EQUAL_INT(big + 1, calls);
        TEST_ASSERT_EQUAL_INT32(BVX_ERR_UNSUPPORTED, read_text(head, data, size, BVX_FORMAT_NRRD, NULL));
    }
    static const char short_head[] = "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 4 3 2\nencoding: gz\n\n";
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_FORMAT, read_text(short_head, "short", 5, BVX_FORMAT_NRRD, &o));
    TEST_ASSERT_NULL(volume.view.samples);
}

static void test_nrrd_detached(void)
{
    static const char head[] =
        "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 4 3 2\nencoding: raw\ndata file: other.raw\n";
    uint8_t data[25];
    char name[64];
    uint64_t count = 0;
    bvx_read_volume_options o = {.struct_size = sizeof o};

    put_samples(data, BVX_SAMPLE_U8, 0);
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_UNSUPPORTED, read_text(head, NULL, 0, BVX_FORMAT_NRRD, &o));
    o.data = data;
    o.data_size = 24;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, read_text(head, NULL, 0, BVX_FORMAT_NRRD, &o));
    TEST_ASSERT_EQUAL_PTR(data, volume.view.samples);
    check_samples(BVX_SAMPLE_U8);
    for (uint64_t size = 0; size < 26; size++) {
        o.data_size = size;
        TEST_ASSERT_EQUAL_INT32(size == 24 ? BVX_OK : BVX_ERR_FORMAT,
                                read_text(head, NULL, 0, BVX_FORMAT_NRRD, &o));
    }
    for (uint64_t room = 0; room < 12; room++)
        TEST_ASSERT_EQUAL_INT32(room < 10 ? BVX_ERR_CAPACITY : BVX_OK,
                                bvx_volume_data_name(ctx, head, sizeof head - 1, 0, name, room, &count));
    TEST_ASSERT_EQUAL_STRING("other.raw", name);
    TEST_ASSERT_EQUAL_UINT64(1, count);
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT,
                            bvx_volume_data_name(ctx, head, sizeof head - 1, 1, name, 64, &count));
}

/* The names that a "data file" field stands for, joined by spaces; or the status. */
static void check_names(const char *field, const char *expected)
{
    char head[512], all[512] = "", name[64];
    uint64_t count = 0, n = 0;
    bvx_status status;

    snprintf(head, sizeof head,
             "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 4 3 2\nencoding: raw\ndata file: %s", field);
    status = bvx_volume_data_name(ctx, head, strlen(head), 0, NULL, 0, &count);
    for (; n < count && status == BVX_OK; n++) {
        status = bvx_volume_data_name(ctx, head, strlen(head), n, name, sizeof name, &count);
        snprintf(all + strlen(all), sizeof all - strlen(all), "%s%s", n == 0 ? "" : " ", name);
    }
    if (status != BVX_OK) snprintf(all, sizeof all, "%d", (int)status);
    TEST_ASSERT_EQUAL_STRING(expected, all);
}

static void test_nrrd_names_of_data_files(void)
{
    check_names("a.raw\n", "a.raw");
    check_names("a b.raw", "a b.raw");
    check_names("s.%d 8 11 1\n", "s.8 s.9 s.10 s.11");
    check_names("s.%03d.raw 8 11 2\n", "s.008.raw s.010.raw");
    check_names("s%2d 9 10 1 2\n", "s 9 s10");
    check_names("s%d 1 -1 -1\n", "s1 s0 s-1");
    check_names("s%d 1 2 0\n", "7");
    check_names("s%d 2 1 1\n", "7");
    check_names("s%d 1 2 1 3\n", "8");
    check_names("50%\n", "50%");
    check_names("s%d 1 3000000000 1\n", "8");
    check_names("s%d -3000000000 1 1\n", "8");
    check_names("s%d 1 2 -1\n", "7");
    check_names("s%020d 7 7 1\n", "s00000000000000000007");
    check_names("s%d 1 2\n", "s%d 1 2"); /* what is no pattern is a name */
    check_names("s%d 1 2 1x\n", "s%d 1 2 1x");
    check_names("s%d 1 2 1 x\n", "s%d 1 2 1 x");
    check_names("s%:d 1 2 1\n", "s%:d 1 2 1");
    check_names("s%21d 1 2 1\n", "s%21d 1 2 1");
    check_names("s%999999999999d 1 2 1\n", "s%999999999999d 1 2 1");
    check_names("LIST\na\r\nb c\n\nd", "a b c d");
    check_names("LIST 2\na\n", "a");
    check_names("LIST\n", "7");
    check_names("\n", "7");
}

/* Names are requested one by one, each time by reading the head. */
static void test_heads_of_too_many_data_files(void)
{
    static const char begin[] =
        "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 4 3 2\nencoding: raw\ndata file: LIST\n";
    size_t const at = sizeof begin - 1;
    uint64_t count = 0, fit = 0;
    size_t const room = at + 2 * 40000;
    char *head = malloc(room), pattern[128];

    TEST_ASSERT_NOT_NULL(head);
    memcpy(head, begin, at);
    for (size_t i = at; i < room; i++) head[i] = (i - at) % 2 == 0 ? 'a' : '\n';
    while ((fit + 1) * (at + 2 * (fit + 1)) <= UINT64_C(1) << 31) fit++;
    TEST_ASSERT_TRUE(fit < 40000);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_volume_data_name(ctx, head, at + 2 * fit, 0, NULL, 0, &count));
    TEST_ASSERT_EQUAL_UINT64(fit, count);
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_UNSUPPORTED,
                            bvx_volume_data_name(ctx, head, at + 2 * fit + 2, 0, NULL, 0, &count));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "more than 2^31"));
    free(head);
    snprintf(
        pattern, sizeof pattern,
        "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 4 3 2\nencoding: raw\ndata file: s%%d 1 2000000000 1\n");
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_UNSUPPORTED,
                            bvx_volume_data_name(ctx, pattern, strlen(pattern), 0, NULL, 0, &count));
}

static void test_several_data_files_are_not_packed_or_skipped(void)
{
    static const char *const fields[] = {"encoding: gzip", "encoding: raw\nline skip: 1",
                                         "encoding: raw\nbyte skip: 1"};
    uint64_t count = 0;
    char head[256];

    for (int i = 0; i < 3; i++)
        for (int files = 1; files < 3; files++) {
            snprintf(head, sizeof head,
                     "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 4 3 2\n%s\ndata file: s%%d 1 %d 1\n",
                     fields[i], files);
            TEST_ASSERT_EQUAL_INT32_MESSAGE(files == 1 ? BVX_OK : BVX_ERR_UNSUPPORTED,
                                            bvx_volume_data_name(ctx, head, strlen(head), 0, NULL, 0, &count),
                                            head);
        }
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT,
                            bvx_volume_data_name(NULL, head, strlen(head), 0, NULL, 0, &count));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_volume_data_name(ctx, NULL, 1, 0, NULL, 0, &count));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT,
                            bvx_volume_data_name(ctx, head, strlen(head), 0, NULL, 0, NULL));
}

static void test_samples_alone(void)
{
    bvx_read_volume_options o = {.struct_size = sizeof o};
    uint8_t data[256];

    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, read_text("x", NULL, 0, BVX_FORMAT_RAW, &o));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, read_text("x", NULL, 0, BVX_FORMAT_RAW, NULL));
    for (int32_t type = BVX_SAMPLE_U8; type <= BVX_SAMPLE_F64; type++)
        for (int big = 0; big < 2; big++) {
            size_t const size = put_samples(data, type, big);
            o.sample_type = type;
            o.big_endian = big;
            o.offset = 3;
            o.size[0] = 4;
            o.size[1] = 3;
            o.size[2] = 2;
            o.spacing[1] = 2.5;
            TEST_ASSERT_EQUAL_INT32(BVX_ERR_FORMAT, read_text("abc", data, size - 1, BVX_FORMAT_RAW, &o));
            TEST_ASSERT_EQUAL_INT32(BVX_OK, read_text("abc", data, size, BVX_FORMAT_RAW, &o));
            check_samples(type);
            TEST_ASSERT_EQUAL_DOUBLE(2.5, volume.view.lattice.spacing[1]);
            /* more may follow */
            TEST_ASSERT_EQUAL_INT32(BVX_OK, read_text("abc", data, size + 1, BVX_FORMAT_RAW, &o));
        }
    o.offset = UINT64_MAX;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_FORMAT, read_text("abc", data, 24, BVX_FORMAT_RAW, &o));
    o.size[2] = 0;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, read_text("abc", data, 24, BVX_FORMAT_RAW, &o));
    o.size[0] = o.size[1] = o.size[2] = INT32_MAX;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, read_text("abc", data, 24, BVX_FORMAT_RAW, &o));
    o.reserved[1] = 1;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, read_text("abc", data, 24, BVX_FORMAT_RAW, &o));
    bvx_volume_free(ctx, &volume);
}

static void test_npy_in_both_orders_of_axes(void)
{
    uint8_t data[256];

    for (int fortran = 0; fortran < 2; fortran++) {
        uint8_t file[512] = "\x93NUMPY\x01\x00\x76\x00";
        int const n = snprintf((char *)file + 10, 119,
                               "{'descr': '>i4', 'fortran_order': %s, 'shape': (4, 3, 2), }",
                               fortran ? "True" : "False");
        memset(file + 10 + n, ' ', (size_t)(117 - n));
        file[127] = '\n';
        put_samples(data, BVX_SAMPLE_I32, 1);
        for (int i = 0; i < 24; i++) {
            int const x = i % 4, y = i / 4 % 3, z = i / 12;
            memcpy(file + 128 + 4 * (fortran ? i : (x * 3 + y) * 2 + z), data + 4 * i, 4);
        }
        bvx_volume_free(ctx, &volume);
        TEST_ASSERT_EQUAL_INT32_MESSAGE(
            BVX_OK, bvx_read_volume(ctx, file, 224, BVX_FORMAT_NPY, NULL, &volume), bvx_last_message(ctx));
        TEST_ASSERT_EQUAL_INT32(0, volume.placed);
        check_samples(BVX_SAMPLE_I32);
        bvx_volume_free(ctx, &volume);
        for (uint64_t cut = 0; cut < 224; cut++)
            TEST_ASSERT_NOT_EQUAL(BVX_OK, bvx_read_volume(ctx, file, cut, BVX_FORMAT_NPY, NULL, &volume));
    }
}

static void test_files_cut_at_every_byte(void)
{
    static const char text[] =
        "NRRD0004\ntype: int16\ndimension: 3\nsizes: 2 2 2\nencoding: ascii\n\n1 2 3 4 5 6 7 89";
    static const char vti[] =
        "<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\"><ImageData WholeExtent=\"0 2 0 2 0 2\">"
        "<Piece Extent=\"0 2 0 2 0 2\"><CellData><DataArray type=\"UInt8\" format=\"binary\">CAAAAAECAwQFBgcI</DataArray>"
        "</CellData></Piece></ImageData></VTKFile>";

    TEST_ASSERT_EQUAL_INT32(BVX_OK, read_text(text, NULL, 0, BVX_FORMAT_NRRD, NULL));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, read_text(vti, NULL, 0, BVX_FORMAT_VTI, NULL));
    TEST_ASSERT_EQUAL_UINT8(8, ((const uint8_t *)volume.view.samples)[7]);
    bvx_volume_free(ctx, &volume);
    for (size_t n = 0; n < sizeof text - 3; n++)
        TEST_ASSERT_NOT_EQUAL(BVX_OK, bvx_read_volume(ctx, text, n, BVX_FORMAT_NRRD, NULL, &volume));
    for (size_t n = 0; n < sizeof vti - 50; n++)
        TEST_ASSERT_NOT_EQUAL(BVX_OK, bvx_read_volume(ctx, vti, n, BVX_FORMAT_VTI, NULL, &volume));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT,
                            bvx_read_volume(ctx, text, sizeof text, BVX_FORMAT_BVX, NULL, &volume));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_read_volume(ctx, NULL, 5, BVX_FORMAT_NRRD, NULL, &volume));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_read_volume(ctx, text, 5, BVX_FORMAT_NRRD, NULL, NULL));
    TEST_ASSERT_NULL(volume.view.samples);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_nrrd_of_every_type_and_order);
    RUN_TEST(test_nrrd_text_of_every_type);
    RUN_TEST(test_nrrd_text_that_the_type_cannot_hold);
    RUN_TEST(test_nrrd_gzip_by_the_callers_function);
    RUN_TEST(test_nrrd_detached);
    RUN_TEST(test_nrrd_names_of_data_files);
    RUN_TEST(test_heads_of_too_many_data_files);
    RUN_TEST(test_several_data_files_are_not_packed_or_skipped);
    RUN_TEST(test_samples_alone);
    RUN_TEST(test_npy_in_both_orders_of_axes);
    RUN_TEST(test_files_cut_at_every_byte);
    return UNITY_END();
}
