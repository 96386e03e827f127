/* test_vti.c - VTK image files of ours and in the forms that VTK writes, put together by hand. */
#include "dense_file_support.h"

static hand_file made;

/* The voxels of the files below: 3 x 2 x 2. */
static int wanted(int x, int y, int z)
{
    return 0x6a5 >> (x + 3 * (y + 2 * z)) & 1;
}

static void check_made(double x, double y, double z, double sx, double sy, double sz)
{
    bvx_grid g;
    read_good_grid(made.bytes, made.size, BVX_FORMAT_VTI, NULL, &g);
    check_file_box(&g, x, y, z, sx, sy, sz, 3, 2, 2);
    for (int i = 0; i < 12; i++)
        TEST_ASSERT_EQUAL_INT(wanted(i % 3, i / 3 % 2, i / 6), bvx_grid_get(&g, i % 3, i / 3 % 2, i / 6));
    check_windows(made.bytes, made.size, BVX_FORMAT_VTI, &g, 8);
    bvx_grid_free(ctx, &g);
}

/* A file with this root's attributes, image's attributes, piece's extent and contents of the piece. */
static void make_vti(const char *root, const char *image, const char *extent, const char *piece)
{
    made.size = 0;
    hand_text(
        &made,
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\" %s>\n<ImageData WholeExtent=\"0 9 0 9 0 9\" %s>\n"
        "<Piece Extent=\"%s\">\n%s</Piece></ImageData>",
        root, image, extent, piece);
}

static void end_vti(void)
{
    hand_text(&made, "</VTKFile>\n");
}

#define VTI_OLD        "version=\"0.1\" byte_order=\"LittleEndian\""
#define VTI_ASCII_DATA "1 0 1 0 0 1\n0 1 0 1 1 0\n"
#define VTI_CELLS                                                                                   \
    "<CellData Scalars=\"a\"><DataArray type=\"UInt8\" Name=\"a\" format=\"ascii\">" VTI_ASCII_DATA \
    "</DataArray></CellData>"

static void test_vti_rounds(void)
{
    check_grid_rounds(BVX_FORMAT_VTI, 1);
}

static void test_vti_writes(void)
{
    static const double origin[3] = {10, 20, 30}, spacing[3] = {1, 2, 0.5};
    static const int32_t dims[3] = {5, 4, 3};
    static const bvx_window window = {{1, 2, 2}, {3, 2, 1}};
    static const char want[] =
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n"
        "  <ImageData WholeExtent=\"0 3 0 2 0 1\" Origin=\"11 24 31\" Spacing=\"1 2 0.5\">\n    <Piece Extent=\"0 3 0 2 0 1\">\n"
        "      <PointData>\n      </PointData>\n      <CellData Scalars=\"solid\">\n        <DataArray type=\"UInt8\" "
        "Name=\"solid\" format=\"appended\" offset=\"0\"/>\n      </CellData>\n    </Piece>\n  </ImageData>\n"
        "  <AppendedData encoding=\"raw\">\n    _\6\0\0\0\0\0\0";
    static const char tail[] = "\n  </AppendedData>\n</VTKFile>\n";
    bvx_buffer b = {0};
    bvx_grid g = random_grid(origin, spacing, dims, &window, 3);

    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_write_grid(ctx, &g, BVX_FORMAT_VTI, &b));
    TEST_ASSERT_EQUAL_UINT64(sizeof want + 6 + sizeof tail - 1, b.size);
    TEST_ASSERT_EQUAL_MEMORY(want, b.bytes, sizeof want); /* its last 0 is the length's last byte */
    for (int i = 0; i < 6; i++)
        TEST_ASSERT_EQUAL_UINT8(bvx_grid_get(&g, i % 3, i / 3, 0), b.bytes[sizeof want + (size_t)i]);
    TEST_ASSERT_EQUAL_MEMORY(tail, b.bytes + b.size - (sizeof tail - 1), sizeof tail - 1);
    bvx_buffer_free(ctx, &b);
    bvx_grid_free(ctx, &g);
}

static void test_vti_places(void)
{
    static const char points[] =
        "<PointData Scalars=\"p\"><DataArray type=\"Float32\" Name=\"p\" format=\"ascii\"> 1 0 nan 0 -0 1e9 "
        "0 0.5 0e3 -1 1 0 </DataArray></PointData><CellData/>";

    make_vti(VTI_OLD, "", "0 3 0 2 0 2", VTI_CELLS);
    end_vti();
    check_made(0, 0, 0, 1, 1, 1);
    make_vti(VTI_OLD, "Origin=\"1 2 3\" Spacing='0.5 2 4'", "0 3 0 2 0 2", VTI_CELLS);
    end_vti();
    check_made(1, 2, 3, 0.5, 2, 4);
    make_vti(VTI_OLD, "Origin=\"1 2 3\" Spacing=\"0.5 2 4\" Direction=\"1 0 0 0 1 0 -0 0 1.0\"",
             "4 7 -3 -1 1 3", VTI_CELLS);
    end_vti();
    check_made(3, -4, 7, 0.5, 2, 4);
    make_vti("version=\"2.2\" header_type=\"UInt64\"", "Origin=\"1 2 3\" Spacing=\"0.5 2 4\"", "0 2 0 1 0 1",
             points);
    end_vti();
    check_made(0.75, 1, 1, 0.5, 2, 4);
    make_vti("version=\"1.0\" header_type=\"UInt64\"", "Origin=\"1 2 3\" Spacing=\"0.5 2 4\"",
             "4 6 -3 -2 1 2", points);
    end_vti();
    check_made(2.75, -5, 5, 0.5, 2, 4);
}

/* ---- encodings ---- */

static void put_base64(const uint8_t *p, size_t n)
{
    static const char alphabet[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (size_t i = 0; i < n; i += 3) {
        uint32_t bits = 0;
        for (size_t k = 0; k < 3; k++) bits = bits << 8 | (i + k < n ? p[i + k] : 0u);
        for (size_t k = 0; k < 4; k++)
            hand_text(&made, "%c", i + k <= n ? alphabet[bits >> (18 - 6 * k) & 63] : '=');
    }
}

/* Length and samples of the file's voxels as numbers of a size, at the end of made. */
static size_t put_array(int size, int big, int header, uint64_t one)
{
    size_t const start = made.size;
    hand_number(&made, (uint64_t)(12 * size), header, big);
    for (int i = 0; i < 12; i++) hand_number(&made, wanted(i % 3, i / 3 % 2, i / 6) ? one : 0, size, big);
    return start;
}

/* In base 64, length and samples at once (as VTK does without compression) or each by itself. */
static void put_array_base64(int size, int big, int header, uint64_t one, int apart)
{
    static uint8_t array[200];
    size_t const start = put_array(size, big, header, one), n = made.size - start;
    memcpy(array, made.bytes + start, n);
    made.size = start;
    if (apart) put_base64(array, (size_t)header);
    put_base64(array + (apart ? header : 0), n - (size_t)(apart ? header : 0));
}

static void test_vti_encodings(void)
{
    static const struct {
        const char *name;
        int size;
        uint64_t one;
    } types[] = {{"UInt8", 1, 1},
                 {"Int8", 1, 0x80},
                 {"UInt16", 2, 0x100},
                 {"Int16", 2, 0x8000},
                 {"UInt32", 4, 1},
                 {"Int32", 4, 0x80000000u},
                 {"Float32", 4, 0x3f800000},
                 {"UInt64", 8, 1},
                 {"Int64", 8, UINT64_C(1) << 63},
                 {"Float64", 8, UINT64_C(0x3ff) << 52}};
    char root[100], piece[300];
    for (size_t i = 0; i < sizeof types / sizeof types[0]; i++)
        for (int big = 0; big < 2; big++)
            for (int header = 4; header <= 8; header += 4) {
                int const size = types[i].size;
                sprintf(root, "version=\"1.0\" byte_order=\"%s\" header_type=\"UInt%d\"",
                        big ? "BigEndian" : "LittleEndian", 8 * header);
                for (int apart = 0; apart < 2; apart++) {
                    sprintf(
                        piece,
                        "<CellData Scalars=\"a\"><DataArray type=\"%s\" Name=\"a\" format=\"binary\">\n  ",
                        types[i].name);
                    make_vti(root, "", "0 3 0 2 0 2", piece);
                    made.size -= strlen("</Piece></ImageData>");
                    put_array_base64(size, big, header, types[i].one, apart);
                    hand_text(
                        &made,
                        "\n<InformationKey name=\"x\"><Value index=\"0\"> 1 </Value></InformationKey></DataArray>"
                        "</CellData></Piece></ImageData>");
                    end_vti();
                    check_made(0, 0, 0, 1, 1, 1);
                    sprintf(
                        piece,
                        "<CellData><DataArray type=\"%s\" Name=\"a\" format=\"appended\" offset=\"5\"/></CellData>",
                        types[i].name);
                    make_vti(root, "", "0 3 0 2 0 2", piece);
                    hand_text(&made, "<AppendedData encoding=\"base64\">\n _AAAA=");
                    put_array_base64(size, big, header, types[i].one, apart);
                    hand_text(&made, "</AppendedData>");
                    end_vti();
                    check_made(0, 0, 0, 1, 1, 1);
                }
                make_vti(root, "", "0 3 0 2 0 2", piece);
                hand_text(&made, "<AppendedData encoding='raw'>\n _<&_>\t");
                put_array(size, big, header, types[i].one);
                hand_text(&made, "</AppendedData>");
                end_vti();
                check_made(0, 0, 0, 1, 1, 1);
            }
}

/* ---- which array ---- */

#define VTI_ARRAY(name, type, data) \
    "<DataArray type=\"" type "\" Name=\"" name "\" format=\"ascii\">" data "</DataArray>"
#define VTI_ZEROS "0 0 0 0 0 0 0 0 0 0 0 0"

static void check_piece(const char *piece)
{
    make_vti(VTI_OLD, "", "0 3 0 2 0 2", piece);
    end_vti();
    check_made(0, 0, 0, 1, 1, 1);
}

static void test_vti_arrays(void)
{
    check_piece("<CellData Scalars=\"b\">" VTI_ARRAY("a", "UInt8", VTI_ZEROS)
                    VTI_ARRAY("b", "UInt8", VTI_ASCII_DATA) "</CellData>");
    check_piece("<CellData>" VTI_ARRAY("a", "UInt8", VTI_ASCII_DATA)
                    VTI_ARRAY("b", "UInt8", VTI_ZEROS) "</CellData>");
    check_piece(
        "<CellData Vectors=\"v\"><DataArray type=\"Float32\" Name=\"v\" NumberOfComponents=\"3\" format=\"ascii\"/>"
        "<DataArray type=\"String\" Name=\"s\" format=\"ascii\"> x </DataArray>" VTI_ARRAY(
            "a", "Int8", VTI_ASCII_DATA) "</CellData>");
    check_piece("<PointData Scalars=\"p\">" VTI_ARRAY(
        "p", "UInt8", "1") "</PointData><CellData Scalars=\"a\">" VTI_ARRAY("a", "UInt8",
                                                                            VTI_ASCII_DATA) "</CellData>");
    check_piece("<PointData>" VTI_ARRAY("p", "UInt8", "1") "</PointData><CellData>" VTI_ARRAY(
        "a", "UInt8", VTI_ASCII_DATA) "</CellData>");

    /* names as VTK writes them, and escaped in one place only */
    check_piece("<CellData Scalars=\"x & <y>\">" VTI_ARRAY("a", "UInt8", VTI_ZEROS)
                    VTI_ARRAY("x &amp; &lt;y&gt;", "UInt8", VTI_ASCII_DATA) "</CellData>");
    check_piece("<CellData Scalars='\"&apos;'>" VTI_ARRAY("a", "UInt8", VTI_ZEROS)
                    VTI_ARRAY("&quot;'", "UInt8", VTI_ASCII_DATA) "</CellData>");

    /* comments, and arrays elsewhere */
    check_piece("<!-- <CellData> --><?pi <a ?><CellData Scalars=\"a\" ><!--x-->" VTI_ARRAY(
        "a", "UInt8", VTI_ASCII_DATA) "</CellData>");
    make_vti(VTI_OLD, "><FieldData>" VTI_ARRAY("a", "UInt8", "7") "</FieldData><Other x='1'",
             "0 3 0 2 0 2\"></Piece></Other><Piece Extent=\"0 3 0 2 0 2", VTI_CELLS);
    end_vti();
    check_made(0, 0, 0, 1, 1, 1);
    make_vti(VTI_OLD, "", "0 2 0 1 0 1",
             "<PointData Scalars=\"p\">" VTI_ARRAY(
                 "p", "UInt8", VTI_ASCII_DATA) "</PointData><CellData>" VTI_ARRAY("c", "UInt8",
                                                                                  "1 1") "</CellData>");
    end_vti();
    check_made(-0.5, -0.5, -0.5, 1, 1, 1); /* active points before cells that are not */
}

/* ---- refusals ---- */

static void check_made_refused(bvx_status status, const char *words)
{
    check_grid_refused(made.bytes, made.size, BVX_FORMAT_VTI, status, words);
}

static void check_vti_refused(const char *root, const char *image, const char *extent, const char *piece,
                              bvx_status status, const char *words)
{
    make_vti(root, image, extent, piece);
    end_vti();
    check_made_refused(status, words);
}

/* A good file but for what stands in its one array's tag and behind. */
static void check_array_refused(const char *array, const char *words)
{
    char piece[300];
    sprintf(piece, "<CellData><DataArray type=\"UInt8\" %s</CellData>", array);
    check_vti_refused(VTI_OLD, "", "0 3 0 2 0 2", piece, BVX_ERR_FORMAT, words);
}

static void check_text_refused(const char *text, bvx_status status, const char *words)
{
    check_grid_refused(text, strlen(text), BVX_FORMAT_VTI, status, words);
}

static void test_vti_refuses(void)
{
    static const char good[] = "0 3 0 2 0 2";

    check_vti_refused("version=\"3.0\"", "", good, VTI_CELLS, BVX_ERR_UNSUPPORTED, "line 2: a version other");
    check_vti_refused("version=\"1.0\" header_type=\"UInt16\"", "", good, VTI_CELLS, BVX_ERR_FORMAT,
                      "UInt32 or UInt64");
    check_vti_refused("version=\"1.0\" byte_order=\"Middle\"", "", good, VTI_CELLS, BVX_ERR_FORMAT,
                      "LittleEndian or BigEndian");
    check_vti_refused(VTI_OLD " compressor=\"vtkZLibDataCompressor\"", "", good,
                      "<CellData><DataArray type=\"UInt8\" format=\"binary\">AQAAAA==</DataArray></CellData>",
                      BVX_ERR_UNSUPPORTED, "SetCompressorTypeToNone");
    check_vti_refused(VTI_OLD, "Direction=\"0 1 0 1 0 0 0 0 1\"", good, VTI_CELLS, BVX_ERR_UNSUPPORTED,
                      "line 3: Direction turns");
    check_vti_refused(VTI_OLD, "Direction=\"1 0 0 0 1 0 0 0\"", good, VTI_CELLS, BVX_ERR_FORMAT, "a number");
    check_vti_refused(VTI_OLD, "Spacing=\"1 0 1\"", good, VTI_CELLS, BVX_ERR_FORMAT, "spacing along y is 0");
    check_vti_refused(VTI_OLD, "Spacing=\"1 1\"", good, VTI_CELLS, BVX_ERR_FORMAT, "expected a number");
    check_vti_refused(VTI_OLD, "Spacing=\"1 1 1 1\"", good, VTI_CELLS, BVX_ERR_FORMAT, "no further number");
    check_vti_refused(VTI_OLD, "Origin=\"1 1 inf\"", good, VTI_CELLS, BVX_ERR_FORMAT,
                      "origin is not finite along z");
    check_vti_refused(VTI_OLD, "Origin=\"1 1 1\" Origin=\"1 1 1\"", good, VTI_CELLS, BVX_ERR_FORMAT,
                      "each attribute once");
    check_vti_refused(VTI_OLD, "", "0 3 0 2 2 2", VTI_CELLS, BVX_ERR_FORMAT, "no voxels along z");
    check_vti_refused(VTI_OLD, "", "0 3 0 2 2 0", VTI_CELLS, BVX_ERR_FORMAT, "no voxels along z");
    check_vti_refused(VTI_OLD, "", "0 3 0 2 0 2.5", VTI_CELLS, BVX_ERR_FORMAT, "whole numbers");
    check_vti_refused(VTI_OLD, "", "0 3 0 2 0 4294967296", VTI_CELLS, BVX_ERR_FORMAT, "whole numbers");
    check_vti_refused(VTI_OLD, "", "-2147483648 2147483647 0 1 0 1", VTI_CELLS, BVX_ERR_RANGE,
                      "4294967295 voxels along x");
    check_vti_refused(VTI_OLD, "", "0 4194304 0 4194304 0 4194304", VTI_CELLS, BVX_ERR_FORMAT,
                      "more than any file");
    check_vti_refused(VTI_OLD, "", "0 3 0 2 0 30", VTI_CELLS, BVX_ERR_FORMAT, "180 values in 24 bytes");
    check_vti_refused(VTI_OLD, "", "0 3 0 2 0 1", VTI_CELLS, BVX_ERR_FORMAT,
                      "expected the end of the array, found '0'");
    check_vti_refused(
        VTI_OLD, "", good,
        "<CellData><DataArray type=\"UInt8\" format=\"ascii\">1 0 1 0 0 1 0 1 0 1 1      </DataArray></CellData>",
        BVX_ERR_FORMAT, "the samples end after 11 of 3 x 2 x 2");
    check_vti_refused(VTI_OLD, "", good, VTI_CELLS "</Piece><Piece Extent=\"0 3 0 2 2 4\">",
                      BVX_ERR_UNSUPPORTED, "a second piece");
    check_vti_refused(VTI_OLD, "", good, "", BVX_ERR_FORMAT, "array of cells or points");
    check_vti_refused(VTI_OLD, "", good,
                      "<CellData Scalars=\"v\"><DataArray type=\"UInt8\" Name=\"v\" "
                      "NumberOfComponents=\"3\" format=\"ascii\"/></CellData>",
                      BVX_ERR_UNSUPPORTED, "active scalars");
    check_vti_refused(VTI_OLD, "", good,
                      "<CellData Scalars=\"v\"><DataArray type=\"Bit\" Name=\"v\" format=\"ascii\"/>"
                      "</CellData>",
                      BVX_ERR_UNSUPPORTED, "active scalars");
    check_array_refused("format=\"hex\"/>", "ascii, binary or appended");
    check_array_refused("/>", "no format");
    check_array_refused("format=\"appended\"/>", "no offset");
    check_array_refused("format=\"appended\" offset=\"-1\"/>", "a whole number");
    check_array_refused("format=\"appended\" offset=\"0\"/>", "no AppendedData");
    check_array_refused("format=\"binary\">DAAAAAEAAQAAAQABAAEB</DataArray>", "not all there");
    check_array_refused("format=\"binary\">DAAAAAEAAQAAAQABAAEBAAAA</DataArray>", "the end of the array");
    check_array_refused("format=\"binary\">DAAAAAEAAQ*AAQABAAEBAA==</DataArray>", "not all there");
    check_array_refused("format=\"binary\">DAAAAAEAAQAAAQABAAEBAA=A</DataArray>", "not all there");
    check_array_refused("format=\"binary\">DQAAAAEAAQAAAQABAAEBAA==</DataArray>",
                        "13 bytes, its extent asks for 12");
    make_vti(VTI_OLD, "", good,
             "<CellData><DataArray type=\"UInt8\" format=\"appended\" offset=\"1000\"/></CellData>");
    hand_text(&made, "<AppendedData encoding=\"raw\">_");
    check_made_refused(BVX_ERR_FORMAT, "not all there");
    make_vti(VTI_OLD, "", good,
             "<CellData><DataArray type=\"UInt8\" format=\"appended\" offset=\"0\"/></CellData>");
    hand_text(&made, "<AppendedData encoding=\"hex\">_");
    check_made_refused(BVX_ERR_FORMAT, "no encoding");
    make_vti(VTI_OLD, "", good,
             "<CellData><DataArray type=\"UInt8\" format=\"appended\" offset=\"0\"/></CellData>");
    hand_text(&made, "<AppendedData encoding=\"raw\"> x");
    check_made_refused(BVX_ERR_FORMAT, "'_'");
}

static void test_vti_refuses_bad_xml(void)
{
    char deep[200] = "";

    check_text_refused("VTKFile", BVX_ERR_FORMAT, "no element VTKFile");
    check_text_refused("<VTKFile type=\"ImageData\" version=\"1.0\"/>", BVX_ERR_FORMAT,
                       "no element ImageData");
    check_text_refused("<VTKFile type=\"ImageData\" version=\"1.0\"/><b/>", BVX_ERR_FORMAT,
                       "a second element");
    check_text_refused("<VTKFile type=\"PolyData\" version=\"1.0\"/>", BVX_ERR_UNSUPPORTED, "not ImageData");
    check_text_refused("<html></html>", BVX_ERR_FORMAT, "not a VTKFile");
    check_text_refused("<!DOCTYPE a><VTKFile/>", BVX_ERR_FORMAT, "elements and comments only");
    check_text_refused("<VTKFile type=\"ImageData\" version=\"1.0\"></VTKFiles>", BVX_ERR_FORMAT,
                       "the closing tag");
    check_text_refused("<VTKFile type=\"ImageData\" version=\"1.0\"></VTKFile></VTKFile>", BVX_ERR_FORMAT,
                       "the closing tag");
    check_text_refused("<VTKFile type=\"ImageData\" version=\"1.0\"><!-- ", BVX_ERR_FORMAT, "-->");
    check_text_refused("<VTKFile type=\"ImageData\" version=\"1.0>", BVX_ERR_FORMAT, "ends with its quote");
    check_text_refused("<VTKFile type=ImageData>", BVX_ERR_FORMAT, "a value in quotes");
    check_text_refused("<VTKFile type>", BVX_ERR_FORMAT, "'=' after");
    check_text_refused("<VTKFile a=\"1\"b=\"2\">", BVX_ERR_FORMAT, "white space before an attribute");
    check_text_refused("<VTKFile / >", BVX_ERR_FORMAT, "'>'");
    check_text_refused("< VTKFile>", BVX_ERR_FORMAT, "an element's name");
    strcat(deep, "<VTKFile type=\"ImageData\" version=\"1.0\">");
    for (int i = 0; i < 16; i++) strcat(deep, "<a>");
    check_text_refused(deep, BVX_ERR_FORMAT, "nested less deeply");
    made.size = 0;
    hand_text(&made, "<VTKFile");
    for (int i = 0; i < 65; i++) hand_text(&made, " a%d='1'", i);
    hand_text(&made, ">");
    check_made_refused(BVX_ERR_FORMAT, "fewer attributes");
}

static void test_vti_damage(void)
{
    make_vti(VTI_OLD, "Origin=\"1 2 3\" Spacing=\"0.5 2 4\"", "0 3 0 2 0 2", VTI_CELLS);
    end_vti();
    check_every_cut(made.bytes, made.size, BVX_FORMAT_VTI, 1);
    TEST_ASSERT_TRUE(check_every_number(made.bytes, made.size, made.size, BVX_FORMAT_VTI) > 10);
    check_random_damage(made.bytes, made.size, BVX_FORMAT_VTI, 5000);

    make_vti("version=\"1.0\" byte_order=\"BigEndian\" header_type=\"UInt32\"", "", "0 3 0 2 0 2",
             "<PointData/><CellData><DataArray type=\"Int16\" format=\"appended\" offset=\"3\"/></CellData>");
    hand_text(&made, "<AppendedData encoding=\"raw\">\n_abc");
    put_array(2, 1, 4, 1);
    check_every_cut(made.bytes, made.size, BVX_FORMAT_VTI, 0);
    check_every_number(made.bytes, made.size, made.size - 28, BVX_FORMAT_VTI);
    check_random_damage(made.bytes, made.size, BVX_FORMAT_VTI, 5000);

    make_vti("version=\"1.0\" byte_order=\"BigEndian\" header_type=\"UInt64\"", "", "0 3 0 2 0 2",
             "<CellData><DataArray type=\"Int16\" format=\"binary\">");
    made.size -= strlen("</Piece></ImageData>");
    put_array_base64(2, 1, 8, 1, 0);
    hand_text(&made, "</DataArray></CellData></Piece></ImageData></VTKFile>");
    check_every_cut(made.bytes, made.size, BVX_FORMAT_VTI, 0);
    check_every_number(made.bytes, made.size, made.size, BVX_FORMAT_VTI);
    check_random_damage(made.bytes, made.size, BVX_FORMAT_VTI, 5000);
}

/* ---- blocks ---- */

/* "Packing" that turns every bit around. */
static int32_t unpack_inverted(void *user, const void *packed, uint64_t packed_size, void *plain,
                               uint64_t plain_size)
{
    (void)user;
    if (packed_size != plain_size) return 1;
    for (uint64_t i = 0; i < plain_size; i++) ((uint8_t *)plain)[i] = (uint8_t) ~((const uint8_t *)packed)[i];
    return 0;
}

/* The samples as bytes in blocks of five, and the last one of two; one number of the head may be wrong. */
static void make_blocks(int header, int big, int is_text, int wrong, uint64_t value)
{
    static uint8_t head[64];
    uint64_t number[6] = {3, 5, 2, 5, 5, 2};
    uint8_t packed[12];
    char root[160];
    size_t start;

    if (wrong >= 0) number[wrong] = value;
    for (int i = 0; i < 12; i++) packed[i] = (uint8_t)~wanted(i % 3, i / 3 % 2, i / 6);
    snprintf(
        root, sizeof root,
        "version=\"1.0\" byte_order=\"%sEndian\" header_type=\"UInt%d\" compressor=\"vtkZLibDataCompressor\"",
        big ? "Big" : "Little", 8 * header);
    make_vti(root, "", "0 3 0 2 0 2",
             is_text ? "<CellData><DataArray type=\"UInt8\" format=\"binary\">"
                     : "<CellData><DataArray type=\"UInt8\" format=\"appended\" offset=\"0\"/></CellData>");
    if (is_text) made.size -= strlen("</Piece></ImageData>");
    else hand_text(&made, "<AppendedData encoding=\"raw\">_");
    start = made.size;
    for (int i = 0; i < 6; i++) hand_number(&made, number[i], header, big);
    if (is_text) {
        memcpy(head, made.bytes + start, (size_t)(6 * header));
        made.size = start;
        put_base64(head, (size_t)(6 * header));
        put_base64(packed, 12);
        hand_text(&made, "</DataArray></CellData></Piece></ImageData></VTKFile>");
    } else {
        memcpy(made.bytes + made.size, packed, 12);
        made.size += 12;
    }
}

static bvx_status read_blocks(uint64_t size, bvx_volume *v)
{
    bvx_read_volume_options const o = {.struct_size = sizeof o, .inflate = unpack_inverted};
    return bvx_read_volume(ctx, made.bytes, size, BVX_FORMAT_VTI, &o, v);
}

static void check_blocks_refused(int wrong, uint64_t value, const char *words)
{
    bvx_volume v = {0};

    for (int is_text = 0; is_text < 2; is_text++) {
        make_blocks(4, 0, is_text, wrong, value);
        TEST_ASSERT_EQUAL_INT32(BVX_ERR_FORMAT, read_blocks(made.size, &v));
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(bvx_last_message(ctx), words), bvx_last_message(ctx));
    }
}

static void test_vti_blocks(void)
{
    bvx_volume v = {0};
    bvx_grid g = {0};

    for (int kind = 0; kind < 8; kind++) {
        make_blocks(kind & 1 ? 8 : 4, kind >> 1 & 1, kind >> 2, -1, 0);
        TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, read_blocks(made.size, &v), bvx_last_message(ctx));
        for (int i = 0; i < 12; i++)
            TEST_ASSERT_EQUAL_INT(wanted(i % 3, i / 3 % 2, i / 6), ((const uint8_t *)v.view.samples)[i]);
        bvx_volume_free(ctx, &v);
        TEST_ASSERT_EQUAL_INT32(BVX_ERR_UNSUPPORTED,
                                bvx_read_grid(ctx, made.bytes, made.size, BVX_FORMAT_VTI, NULL, &g));
        for (size_t n = 0; n < made.size; n++)
            if (read_blocks(n, &v) == BVX_OK) bvx_volume_free(ctx, &v);
    }
    check_blocks_refused(0, 1000, "more blocks than the file has bytes for");
    check_blocks_refused(0, 0, "has 0 bytes, its extent asks for 12");
    check_blocks_refused(1, 100000, "hold more than they can");
    check_blocks_refused(1, 6, "has 14 bytes");
    check_blocks_refused(2, 6, "hold more than they can");
    check_blocks_refused(3, 1000, "after the end of the file");
    check_blocks_refused(3, 4, "a packed block is damaged");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_vti_rounds);
    RUN_TEST(test_vti_writes);
    RUN_TEST(test_vti_places);
    RUN_TEST(test_vti_encodings);
    RUN_TEST(test_vti_arrays);
    RUN_TEST(test_vti_refuses);
    RUN_TEST(test_vti_refuses_bad_xml);
    RUN_TEST(test_vti_damage);
    RUN_TEST(test_vti_blocks);
    return UNITY_END();
}
