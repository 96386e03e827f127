/* test_read_sections.c - contour files: CSL and CSV by hand, round trips,
 * every cut, and what they refuse; contours of meshes. */
#include "tools/section_maker.h"
#include "suite.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static bvx_sections s, t;
static bvx_buffer file;
static section_maker made;
static maker_mesh body;

void setUp(void)
{
    suite_open(0);
    maker_clear(&body);
}

void tearDown(void)
{
    bvx_sections_free(ctx, &s);
    bvx_sections_free(ctx, &t);
    bvx_buffer_free(ctx, &file);
    maker_free(&body);
    suite_close();
}

static bvx_status read_text(const char *text, int32_t format)
{
    bvx_sections_free(ctx, &s);
    return bvx_read_sections(ctx, text, strlen(text), format, NULL, &s);
}

static void refuse(const char *text, int32_t format, bvx_status status, const char *words)
{
    TEST_ASSERT_EQUAL_INT32(status, read_text(text, format));
    if (strstr(bvx_last_message(ctx), words) == NULL) TEST_FAIL_MESSAGE(bvx_last_message(ctx));
    TEST_ASSERT_NULL(s.points);
}

/* ---- CSL ---- */

static const char csl[] =
    "CSLC\n2 3\n\n1 7 2 0 0 1 -0.5\n\n0 0 0.5\n4 0 0.5\n4 4 0.5\n0 4 0.5\n1 1 .5\n2 1 .5\n1 2 .5\n\n4 1 0 1 2 3\n3h0 1 4 5 6\n"
    "2 3 1 0 0 -1 1.5\n0 0 1.5 4 0 1.5 4 4 1.5\n3 2 2 1 0\n";

static void test_csl_by_hand(void)
{
    TEST_ASSERT_EQUAL_INT32(BVX_OK, read_text(csl, BVX_FORMAT_CSL));
    TEST_ASSERT_EQUAL_UINT64(2, s.section_count);
    TEST_ASSERT_EQUAL_UINT64(3, s.loop_count);
    TEST_ASSERT_EQUAL_UINT64(10, s.point_count);
    TEST_ASSERT_EQUAL_DOUBLE(0.5, s.positions[0]);
    TEST_ASSERT_EQUAL_DOUBLE(1.5, s.positions[1]); /* the second plane is given from its other side */
    TEST_ASSERT_EQUAL_DOUBLE(1.0, s.normal[2]);
    TEST_ASSERT_EQUAL_UINT32(3, s.loops[1].point_count);
    TEST_ASSERT_EQUAL_INT32(2, s.loops[2].label);
    TEST_ASSERT_EQUAL_UINT32(1, s.loops[2].section);
    TEST_ASSERT_EQUAL_DOUBLE(4.0, s.points[3 * 7]);
}

static const char drum[] =
    "CSLC\n2 2\n1 8 2 0 0 1 -1\n0 0 1 4 0 1 4 4 1 0 4 1 1 1 1 3 1 1 3 3 1 1 3 1\n4 1 0 1 2 3\n4h0 %d 4 5 6 7\n"
    "2 8 2 0 0 1 -3\n0 0 3 4 0 3 4 4 3 0 4 3 1 1 3 3 1 3 3 3 3 1 3 3\n4h1 %d 4 5 6 7\n4 1 0 1 2 3\n";

/* A hole bounds the body around it whatever its own label, and the body of that label. */
static void test_csl_holes_belong_to_what_is_around_them(void)
{
    static const struct {
        int label, loops, of_one, of_other;
    } cases[] = {{1, 4, 4, 0}, {0, 4, 4, 0}, {2, 6, 4, 2}};
    char text[400];
    for (int i = 0; i < 3; i++) {
        int of_one = 0, of_other = 0;
        snprintf(text, sizeof text, drum, cases[i].label, cases[i].label);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, read_text(text, BVX_FORMAT_CSL));
        TEST_ASSERT_EQUAL_UINT64(cases[i].loops, s.loop_count);
        TEST_ASSERT_EQUAL_UINT64(16, s.point_count);
        for (uint64_t l = 0; l < s.loop_count; l++) {
            of_one += s.loops[l].label == 1;
            of_other += s.loops[l].label == 2;
            TEST_ASSERT_EQUAL_UINT32(4, s.loops[l].point_count);
            TEST_ASSERT_EQUAL_INT32(0, s.loops[l].reserved);
        }
        TEST_ASSERT_EQUAL_INT(cases[i].of_one, of_one);
        TEST_ASSERT_EQUAL_INT(cases[i].of_other, of_other);
    }
}

static void test_csl_has_a_byte_order_mark(void)
{
    char text[400];
    snprintf(text, sizeof text, "\xef\xbb\xbf%s", csl);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, read_text(text, BVX_FORMAT_CSL));
    TEST_ASSERT_EQUAL_UINT64(2, s.section_count);
}

/* The planes as they are; positions along each one's own normal. */
static void test_csl_has_planes_of_any_direction(void)
{
    bvx_sections again;

    memset(&again, 0, sizeof again);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, read_text("CSLC\n3 2\n1 3 1 0 0 2 0\n0 0 0 1 0 0 1 1 0\n3 1 0 1 2\n"
                                              "2 3 1 -3 0 0 1.5\n.5 0 0 .5 1 0 .5 1 1\n3 1 0 1 2\n"
                                              "3 0 0 0 3 4 -10\n",
                                              BVX_FORMAT_CSL));
    TEST_ASSERT_NOT_NULL(s.normals);
    TEST_ASSERT_EQUAL_DOUBLE(1.0, s.normals[2]);
    TEST_ASSERT_EQUAL_DOUBLE(-1.0, s.normals[3]);
    TEST_ASSERT_EQUAL_DOUBLE(0.8, s.normals[8]);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, s.positions[0]);
    TEST_ASSERT_EQUAL_DOUBLE(-0.5, s.positions[1]);
    TEST_ASSERT_EQUAL_DOUBLE(2.0, s.positions[2]);

    /* and out and in again */
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_write_sections(ctx, &s, BVX_FORMAT_CSL, &file));
    TEST_ASSERT_EQUAL_INT32(BVX_OK,
                            bvx_read_sections(ctx, file.bytes, file.size, BVX_FORMAT_CSL, NULL, &again));
    TEST_ASSERT_EQUAL_DOUBLE_ARRAY(s.normals, again.normals, 9);
    TEST_ASSERT_EQUAL_DOUBLE_ARRAY(s.positions, again.positions, 3);
    TEST_ASSERT_EQUAL_DOUBLE_ARRAY(s.points, again.points, 18);
    bvx_sections_free(ctx, &again);
}

/* Planes that lean by less than what is distinguished are a stack, whichever way their normals point. */
static void test_csl_of_parallel_planes_has_one_normal(void)
{
    TEST_ASSERT_EQUAL_INT32(BVX_OK, read_text("CSLC\n2 2\n1 3 1 0 0 1 0\n0 0 0 1 0 0 1 1 0\n3 1 0 1 2\n"
                                              "2 3 1 0 0.00001 -1 1\n0 0 1 1 0 1 1 1 1\n3 1 0 1 2\n",
                                              BVX_FORMAT_CSL));
    TEST_ASSERT_NULL(s.normals);
    TEST_ASSERT_EQUAL_DOUBLE(1.0, s.positions[1]);
}

/* Some writers have A x + B y + C z = D. */
static void test_csl_with_the_other_sign_of_d(void)
{
    static const char text[] = "CSLC\n4 2\n1 3 1 0 0 1 1\n0 0 1 1 0 1 1 1 1\n3 1 0 1 2\n"
                               "2 3 1 0 0 -1 -2\n0 0 2 1 0 2 1 1 2\n3 1 0 1 2\n3 0 0 0 0 1 3\n"
                               "4 3 1 0 0 1 0\n0 0 0 1 0 0 1 1 0\n3 1 0 1 2\n";
    uint64_t flipped = 7;
    bvx_read_sections_options o = {.struct_size = sizeof o};

    o.flipped = &flipped;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_read_sections(ctx, text, sizeof text - 1, BVX_FORMAT_CSL, &o, &s));
    TEST_ASSERT_EQUAL_UINT64(2, flipped); /* the plane without points and that at 0 have no side to tell */
    TEST_ASSERT_EQUAL_UINT64(4, s.section_count);
    for (int i = 0; i < 4; i++) TEST_ASSERT_EQUAL_DOUBLE((i + 1) % 4, s.positions[i]);

    /* One plane has the right sign: which of the two does? */
    refuse(
        "CSLC\n2 2\n1 3 1 0 0 1 1\n0 0 1 1 0 1 1 1 1\n3 1 0 1 2\n2 3 1 0 0 1 -2\n0 0 2 1 0 2 1 1 2\n3 1 0 1 2\n",
        BVX_FORMAT_CSL, BVX_ERR_FORMAT, "line 6: the plane's points do not lie where");
}

static void test_csl_refusals(void)
{
    refuse("CSLC\n1 2\n1 3 1 0 0 1 7\n0 0 1 1 0 1 1 1 1\n3 1 0 1 2\n", BVX_FORMAT_CSL, BVX_ERR_FORMAT,
           "line 3: the plane's points do not lie where");
    refuse("CSLC\n1 2\n1 3 1 0 0 1 0\n0 0 0 1 0 0 1 1 0\n3h1 1 0 1 2\n", BVX_FORMAT_CSL, BVX_ERR_FORMAT,
           "a hole lies in loop 1, which");

    refuse("", BVX_FORMAT_CSL, BVX_ERR_FORMAT, "line 1: the file does not begin with CSLC");
    refuse("CSLC\n1 2\n1 3 1 0 0 0 1\n0 0 0 1 0 0 1 1 0\n3 1 0 1 2\n", BVX_FORMAT_CSL, BVX_ERR_FORMAT,
           "line 3: the plane's normal has no length");
    refuse("CSLC\n0 2\n", BVX_FORMAT_CSL, BVX_ERR_EMPTY, "no loop");
    refuse("CSLC\n1 2\n1 3 1 0 0 1 0\n0 0 0 1 0 0 1 1 0\n3 1 0 1 3\n", BVX_FORMAT_CSL, BVX_ERR_FORMAT,
           "there is no point 3 on this plane");
    refuse("CSLC\n1 2\n1 3 1 0 0 1 0\n0 0 0 1 0 x 1 1 0\n3 1 0 1 2\n", BVX_FORMAT_CSL, BVX_ERR_FORMAT,
           "line 4: expected a point's coordinate");
    refuse("CSLC\n1 2\n1 3 1 0 0 1 0\n0 0 0 1 0 inf 1 1 0\n3 1 0 1 2\n", BVX_FORMAT_CSL, BVX_ERR_RANGE,
           "line 4: a number is not finite");
    refuse("CSLC\n1 2\n1 999999999999 1 0 0 1 0\n", BVX_FORMAT_CSL, BVX_ERR_FORMAT, "more than can be there");
    refuse("CSLC\n1 2\n1 3 1 0 0 1 0\n0 0 0 1 0 0 1 1 0\n3 1 0 1 2\nmore", BVX_FORMAT_CSL, BVX_ERR_FORMAT,
           "line 6: there is more");
    refuse("CSLC\n1 2\n1 3 1 0 0 1 0\n0 0 0 1 0 0 1 1 0\n0 1\n", BVX_FORMAT_CSL, BVX_ERR_FORMAT,
           "a loop without points");
    refuse("x", BVX_FORMAT_STL, BVX_ERR_UNSUPPORTED, "holds no contours");
}

/* ---- CSV ---- */

static void test_csv_by_hand(void)
{
    TEST_ASSERT_EQUAL_INT32(
        BVX_OK,
        read_text(
            "\xef\xbb\xbf\"Y\";x;Section;grade;position;loop;label\r\n# a remark\r\n1;2;A;9;10.5;1;7\r\n1;4;A;9;10.5;1;7\r\n"
            "3;4;A;9;10.5;1;7\r\n1;2;A;9;10.5;1;7\r\n\r\n0;0;B;9;11;1;7\n0;1;B;9;11;1;7\n1;1;B;9;11;1;7",
            BVX_FORMAT_CSV));
    TEST_ASSERT_EQUAL_UINT64(2, s.section_count);
    TEST_ASSERT_EQUAL_UINT64(2, s.loop_count);
    TEST_ASSERT_EQUAL_UINT64(6, s.point_count); /* the first point came again at the end */
    TEST_ASSERT_EQUAL_DOUBLE(10.5, s.positions[0]);
    TEST_ASSERT_EQUAL_DOUBLE(2.0, s.points[0]);
    TEST_ASSERT_EQUAL_DOUBLE(1.0, s.points[1]);
    TEST_ASSERT_EQUAL_DOUBLE(10.5, s.points[2]);
    TEST_ASSERT_EQUAL_INT32(7, s.loops[1].label);
    TEST_ASSERT_EQUAL_INT32(
        BVX_OK, read_text("section\tposition\tloop\tx\ty\n1\t0\t1\t0\t0\n1\t0\t1\t1\t0\n1\t0\t1\t1\t1\n",
                          BVX_FORMAT_CSV));
    TEST_ASSERT_EQUAL_UINT64(3, s.point_count);
}

#define HEAD   "section,position,loop,x,y\n"
#define PLANES "section,position,loop,x,y,z,nx,ny,nz\n"

/* Planes of any direction: normals as they stand, of any length, and points of the world. */
static void test_csv_of_planes(void)
{
    TEST_ASSERT_EQUAL_INT32(
        BVX_OK,
        read_text("nz;ny;nx;z;y;x;loop;position;section\n0;0;-2;0;0;.5;a;-.5;P\n0;0;-2;0;1;.5;a;-.5;P\n"
                  "0;0;-2;1;1;.5;a;-.5;P\n0;0;-2;0;0;.5;a;-.5;P\n4;3;0;2.5;0;0;a;2;Q\n4;3;0;2.5;0;1;a;2;Q\n"
                  "4;3;0;1.75;1;1;a;2;Q\n",
                  BVX_FORMAT_CSV));
    TEST_ASSERT_EQUAL_UINT64(2, s.section_count);
    TEST_ASSERT_EQUAL_UINT64(6, s.point_count); /* the first point came again at the end */
    TEST_ASSERT_NOT_NULL(s.normals);
    TEST_ASSERT_EQUAL_DOUBLE(-2.0, s.normals[0]);
    TEST_ASSERT_EQUAL_DOUBLE(4.0, s.normals[5]);
    TEST_ASSERT_EQUAL_DOUBLE(-0.5, s.positions[0]);
    TEST_ASSERT_EQUAL_DOUBLE(2.5, s.points[11]);

    /* A z without normals is a column like any other. */
    TEST_ASSERT_EQUAL_INT32(
        BVX_OK,
        read_text("section,position,loop,x,y,z\n1,0,1,0,0,9\n1,0,1,1,0,9\n1,0,1,1,1,9\n", BVX_FORMAT_CSV));
    TEST_ASSERT_NULL(s.normals);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, s.points[2]);

    refuse("section,position,loop,x,y,nx,ny,nz\n", BVX_FORMAT_CSV, BVX_ERR_FORMAT,
           "line 1: the head line has no column z (normals need z, nx, ny, nz)");
    refuse("section,position,loop,x,y,z,ny,nz\n", BVX_FORMAT_CSV, BVX_ERR_FORMAT, "no column nx");
    refuse(PLANES "1,0,1,0,0,0,0,0,0\n", BVX_FORMAT_CSV, BVX_ERR_FORMAT,
           "line 2: the plane's normal has no length");
    refuse(PLANES "1,0,1,0,0,0,1e200,1e200,0\n", BVX_FORMAT_CSV, BVX_ERR_FORMAT, "normal has no length");
    refuse(PLANES "1,0,1,0,0,0,x,0,1\n", BVX_FORMAT_CSV, BVX_ERR_FORMAT, "line 2: expected a number as nx");
    refuse(PLANES "1,0,1,0,0,inf,0,0,1\n", BVX_FORMAT_CSV, BVX_ERR_RANGE, "line 2: a number is not finite");
    refuse(PLANES "1,0,1,0,0,0,0,0,1\n1,0,1,1,0,0,0,0,2\n", BVX_FORMAT_CSV, BVX_ERR_FORMAT,
           "line 3: the section has another normal on an earlier line");
    refuse(PLANES "1,0,1,0,0,0,0,0,1\n2,0,1,1,0,0,0,1,0\n1,0,2,0,0,0,0,1,1\n", BVX_FORMAT_CSV, BVX_ERR_FORMAT,
           "line 4: the section has another normal on an earlier line");
    refuse(PLANES "1,0,1,0,0,0,0,0\n", BVX_FORMAT_CSV, BVX_ERR_FORMAT, "line 2: the line has fewer columns");
}

/* A line without loop and point states its section: between others, before, after, by a name, with a normal. */
static void test_csv_of_empty_sections(void)
{
    static const char text[] =
        "section,position,loop,label,x,y\ntop,5,,,,\n1,0,a,3,0,0\n1,0,a,3,1,0\n1,0,a,3,1,1\n\"2\", 1 , , ,\t,\n"
        "3,2,a,3,0,0\n3,2,a,3,1,0\n3,2,,,,\n3,2,a,3,1,1\n";
    static const char planes[] = PLANES
        "1,0,a,0,0,0,0,0,1\n1,0,a,1,0,0,0,0,1\n1,0,a,1,1,0,0,0,1\nQ,7,,,,,0,3,4\n";

    TEST_ASSERT_EQUAL_INT32(BVX_OK, read_text(text, BVX_FORMAT_CSV));
    TEST_ASSERT_EQUAL_UINT64(4, s.section_count);
    TEST_ASSERT_EQUAL_UINT64(2, s.loop_count);
    TEST_ASSERT_EQUAL_UINT64(6, s.point_count);
    for (int i = 0; i < 4; i++) TEST_ASSERT_EQUAL_DOUBLE(i == 0 ? 5.0 : i - 1, s.positions[i]);
    TEST_ASSERT_EQUAL_UINT32(1, s.loops[0].section);
    TEST_ASSERT_EQUAL_UINT32(3, s.loops[1].section);

    TEST_ASSERT_EQUAL_INT32(BVX_OK, read_text(planes, BVX_FORMAT_CSV));
    TEST_ASSERT_EQUAL_UINT64(2, s.section_count);
    TEST_ASSERT_EQUAL_DOUBLE(7.0, s.positions[1]);
    TEST_ASSERT_EQUAL_DOUBLE(4.0, s.normals[5]);

    /* Written and read again, whatever the order of sections and loops. */
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_write_sections(ctx, &s, BVX_FORMAT_CSV, &file));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_read_sections(ctx, file.bytes, file.size, BVX_FORMAT_CSV, NULL, &t));
    TEST_ASSERT_EQUAL_UINT64(2, t.section_count);
    TEST_ASSERT_EQUAL_MEMORY(s.normals, t.normals, 48);

    refuse(HEAD "1,0,,,\n", BVX_FORMAT_CSV, BVX_ERR_EMPTY, "no loop");
    refuse(HEAD "1,,,,\n", BVX_FORMAT_CSV, BVX_ERR_FORMAT, "line 2: expected a number as the position");
    refuse(HEAD "1,0,,\n", BVX_FORMAT_CSV, BVX_ERR_FORMAT, "line 2: the line has fewer columns");
    refuse(HEAD "1,0,a,,\n", BVX_FORMAT_CSV, BVX_ERR_FORMAT, "line 2: expected a number as x");
    refuse(HEAD "1,0,,,2\n", BVX_FORMAT_CSV, BVX_ERR_FORMAT, "line 2: expected a number as x");
    refuse(HEAD "1,0,a,0,0\n1,2,,,\n", BVX_FORMAT_CSV, BVX_ERR_FORMAT,
           "line 3: the section has another position");
    refuse(PLANES "1,0,,,,,0,0,0\n", BVX_FORMAT_CSV, BVX_ERR_FORMAT,
           "line 2: the plane's normal has no length");
    refuse(PLANES "1,0,,,,,0,0,\n", BVX_FORMAT_CSV, BVX_ERR_FORMAT, "line 2: expected a number as nz");
    refuse(PLANES "1,0,,,,1,0,0,1\n", BVX_FORMAT_CSV, BVX_ERR_FORMAT, "line 2: expected a number as x");
}

/* Two rounds over very many sections: each loop finds its own, in a time
 * that does not grow with their square. */
static void test_csv_of_many_sections(void)
{
    uint32_t const sections = quick ? 2000 : 100000;
    char *const text = malloc((size_t)sections * 60 + 100);
    int n = sprintf(text, "loop,section,x,y,position\n");

    TEST_ASSERT_NOT_NULL(text);
    for (uint32_t i = 0; i < 2 * sections; i++)
        n += sprintf(text + n, "%u,%u,1,2,%u\n", (unsigned)(i / sections), (unsigned)(i % sections * 7),
                     (unsigned)(i % sections));
    bvx_status const status = bvx_read_sections(ctx, text, (uint64_t)n, BVX_FORMAT_CSV, NULL, &s);
    free(text);
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, status, bvx_last_message(ctx));
    TEST_ASSERT_EQUAL_UINT64(sections, s.section_count);
    TEST_ASSERT_EQUAL_UINT64(2 * sections, s.loop_count);
    for (uint32_t i = 0; i < 2 * sections; i++) TEST_ASSERT_EQUAL_UINT32(i % sections, s.loops[i].section);
    for (uint32_t i = 0; i < sections; i++) TEST_ASSERT_TRUE(s.positions[i] == i);
}

static void test_csv_refusals(void)
{
    bvx_read_sections_options o = {.struct_size = sizeof o};
    static const char gap[] = HEAD "1,0,1,0,0\n1,0,1,1,0\n1,0,1,1,1\n";

    refuse("", BVX_FORMAT_CSV, BVX_ERR_EMPTY, "no head line");
    refuse(HEAD, BVX_FORMAT_CSV, BVX_ERR_EMPTY, "no loop");
    refuse("section,position,x,y\n", BVX_FORMAT_CSV, BVX_ERR_FORMAT, "no column loop");
    refuse("section,position,loop,x,y,x\n", BVX_FORMAT_CSV, BVX_ERR_FORMAT, "twice");
    refuse(HEAD "1,0,1,0\n", BVX_FORMAT_CSV, BVX_ERR_FORMAT, "line 2: the line has fewer columns");
    refuse(HEAD "1,0,1,0,0x\n", BVX_FORMAT_CSV, BVX_ERR_FORMAT, "line 2: expected a number as y");
    refuse(HEAD "1,0,1,0,nan\n", BVX_FORMAT_CSV, BVX_ERR_RANGE, "line 2: a number is not finite");
    refuse(HEAD "1,0,1,0,0\n1,2,1,1,0\n", BVX_FORMAT_CSV, BVX_ERR_FORMAT,
           "line 3: the section has another position");
    refuse(HEAD "1,0,1,0,0\n2,5,1,1,0\n1,2,1,1,0\n", BVX_FORMAT_CSV, BVX_ERR_FORMAT,
           "line 4: the section has another position");
    refuse(HEAD "1,0,1,0,0\n1,0,2,1,0\n1,0,1,1,0\n", BVX_FORMAT_CSV, BVX_ERR_FORMAT,
           "have one name in one section");
    refuse("section,position,loop,x,y,label\n1,0,1,0,0,1.5\n", BVX_FORMAT_CSV, BVX_ERR_FORMAT,
           "line 2: the label is not a whole number");
    refuse("section,position,loop,x,y,label\n1,0,1,0,0,1\n1,0,1,1,0,2\n", BVX_FORMAT_CSV, BVX_ERR_FORMAT,
           "line 3: the loop has another label");
    o.close_gap = 1.5;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_read_sections(ctx, gap, sizeof gap - 1, BVX_FORMAT_CSV, &o, &t));
    bvx_sections_free(ctx, &t);
    o.close_gap = 1.4;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_FORMAT,
                            bvx_read_sections(ctx, gap, sizeof gap - 1, BVX_FORMAT_CSV, &o, &t));
    o.close_gap = -1.0;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT,
                            bvx_read_sections(ctx, gap, sizeof gap - 1, BVX_FORMAT_CSV, &o, &t));
}

/* ---- both ---- */

static void assert_same(const bvx_sections *a, const bvx_sections *b)
{
    TEST_ASSERT_EQUAL_UINT64(a->section_count, b->section_count);
    TEST_ASSERT_EQUAL_UINT64(a->loop_count, b->loop_count);
    TEST_ASSERT_EQUAL_UINT64(a->point_count, b->point_count);
    TEST_ASSERT_EQUAL_MEMORY(a->points, b->points, (size_t)a->point_count * 24);
    TEST_ASSERT_EQUAL_MEMORY(a->loops, b->loops, (size_t)a->loop_count * sizeof *a->loops);
    for (uint64_t i = 0; i < a->section_count; i++)
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, a->positions[i], b->positions[i]);
}

static void test_round_trips(void)
{
    static const int32_t formats[] = {BVX_FORMAT_CSL, BVX_FORMAT_CSV};
    uint64_t seed = 3;

    for (int i = 0; i < 40; i++) {
        stack_random(&made, &seed);
        for (int f = 0; f < 2; f++) {
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_write_sections(ctx, &made.s, formats[f], &file));
            TEST_ASSERT_EQUAL_INT32(BVX_OK,
                                    bvx_read_sections(ctx, file.bytes, file.size, formats[f], NULL, &t));
            assert_same(&made.s, &t);
            bvx_sections_free(ctx, &t);
            bvx_buffer_free(ctx, &file);
        }
    }
}

/* Written and read again: the same planes to the last bit, and the same body. */
static void test_csv_of_planes_round_trip(void)
{
    uint64_t seed = 5, hash[2];

    stack_oblique(&made);
    for (int i = 0; i < 7; i++) stack_ball_cut(&made, stack_any_plane(&made, &seed, 0.7), 0.1, 0, 0, 1.0, 24);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_write_sections(ctx, &made.s, BVX_FORMAT_CSV, &file));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_read_sections(ctx, file.bytes, file.size, BVX_FORMAT_CSV, NULL, &t));
    TEST_ASSERT_EQUAL_UINT64(made.s.section_count, t.section_count);
    assert_same(&made.s, &t);
    TEST_ASSERT_EQUAL_MEMORY(made.s.normals, t.normals, (size_t)t.section_count * 24);
    TEST_ASSERT_EQUAL_MEMORY(made.s.positions, t.positions, (size_t)t.section_count * 8);
    for (int i = 0; i < 2; i++) {
        bvx_mesh mesh = {0};
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_build_sections(ctx, i == 0 ? &made.s : &t, NULL, &mesh));
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_hash(ctx, &mesh, &hash[i]));
        bvx_mesh_free(ctx, &mesh);
    }
    TEST_ASSERT_EQUAL_HEX64(hash[0], hash[1]);
    bvx_sections_free(ctx, &t);
    bvx_buffer_free(ctx, &file);
}

/* A file that is cut short is an error or, where whole lines were lost, a
 * smaller stack; in no case memory is lost. */
static void test_every_cut(void)
{
    static const char table[] = HEAD "1,0,1,0,0\n1,0,1,1,0\n1,0,1,1,1\n2,1,1,0,0\n2,1,1,1,0\n2,1,1,1,1\n";

    for (size_t n = 0; n < sizeof csl - 1; n++) {
        bvx_status const status = bvx_read_sections(ctx, csl, n, BVX_FORMAT_CSL, NULL, &t);
        TEST_ASSERT_TRUE(status == BVX_ERR_FORMAT || (n + 2 > sizeof csl - 1 && status == BVX_OK));
        bvx_sections_free(ctx, &t);
    }
    for (size_t n = 0; n < sizeof table - 1; n++) {
        bvx_read_sections(ctx, table, n, BVX_FORMAT_CSV, NULL, &t);
        bvx_sections_free(ctx, &t);
    }
}

static void test_writers_refuse(void)
{
    uint64_t seed = 4;

    stack_random(&made, &seed);
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_write_sections(ctx, &made.s, BVX_FORMAT_STL, &file));
    made.point[2] += 1e-9;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_UNSUPPORTED, bvx_write_sections(ctx, &made.s, BVX_FORMAT_CSV, &file));
    made.s.normal[0] = 1.0;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_UNSUPPORTED, bvx_write_sections(ctx, &made.s, BVX_FORMAT_CSV, &file));
    made.loop[0].label = -1;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_UNSUPPORTED, bvx_write_sections(ctx, &made.s, BVX_FORMAT_CSL, &file));
    stack_clear(&made);
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_EMPTY, bvx_write_sections(ctx, &made.s, BVX_FORMAT_CSL, &file));
}

/* ---- contours of meshes ---- */

static bvx_status slice(const bvx_slice_options *o)
{
    bvx_mesh_view const view = maker_view(&body);
    bvx_sections_free(ctx, &t);
    return bvx_slice_mesh(ctx, &view, o, &t);
}

static void test_slices_of_a_box(void)
{
    static const double low[3] = {0, 0, 0}, high[3] = {4, 3, 2}, at[3] = {0.0, 1.0, 2.0};
    bvx_slice_options o = {.struct_size = sizeof o};

    maker_box(&body, low, high);
    o.positions = at;
    o.position_count = 3;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, slice(&o));
    TEST_ASSERT_EQUAL_UINT64(3, t.section_count);
    /* vertices on a plane count as above: 1 and the top, and not the bottom */
    TEST_ASSERT_EQUAL_UINT64(2, t.loop_count);
    for (uint64_t i = 0; i < t.loop_count; i++) {
        const bvx_section_loop *const l = &t.loops[i];
        double area = 0.0;
        for (uint32_t k = 0; k < l->point_count; k++) {
            const double *const a = t.points + 3 * (l->first_point + k);
            const double *const b = t.points + 3 * (l->first_point + (k + 1) % l->point_count);
            area += 0.5 * (a[0] * b[1] - a[1] * b[0]);
            TEST_ASSERT_EQUAL_DOUBLE(t.positions[l->section], a[2]);
        }
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, 12.0, area); /* counter-clockwise */
    }
    o.positions = NULL;
    o.spacing = 0.5;
    o.normal[0] = 1.0;
    o.normal[2] = 0.0;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, slice(&o));
    TEST_ASSERT_EQUAL_UINT64(8, t.section_count);
    TEST_ASSERT_EQUAL_DOUBLE(0.25, t.positions[0]);
    TEST_ASSERT_EQUAL_UINT64(8, t.loop_count);
}

static void test_slices_refuse(void)
{
    static const double low[3] = {0, 0, 0}, high[3] = {4, 3, 2}, up[2] = {1.0, 1.0};
    bvx_slice_options o = {.struct_size = sizeof o};

    maker_box(&body, low, high);
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, slice(&o));
    o.spacing = 1e-9;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, slice(&o));
    o.spacing = 1.0;
    o.positions = up;
    o.position_count = 2;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, slice(&o));
    o.spacing = 0.0;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, slice(&o));
    o.position_count = 1;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, slice(&o));
    maker_remove(&body, 0);
    maker_remove(&body, 0);
    maker_remove(&body, 0);
    maker_remove(&body, 0);
    maker_remove(&body, 0);
    o.position_count = 1;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_FORMAT, slice(&o));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "does not close near"));
}

/* Mesh to contours to mesh: volume comes back as sections grow closer. */
static void test_mesh_to_contours_to_mesh(void)
{
    static const double centre[3] = {1, 2, 3}, radius[3] = {3, 2, 2.5};
    uint64_t seed = 11;
    double last = 1e9;

    maker_star(&body, &seed, centre, radius, 0.1, 12, 17, 1 << 20);
    bvx_mesh_view const view = maker_view(&body);
    bvx_certificate c;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_check(ctx, &view, 0, &c));
    double const volume = c.volume;
    for (int n = 8; n <= 64; n *= 2) {
        bvx_slice_options o = {.struct_size = sizeof o};
        bvx_sections_options b = {.struct_size = sizeof b};
        bvx_mesh back = {0};
        bvx_mesh_view v;
        o.spacing = (c.box.high[2] - c.box.low[2]) / n;
        TEST_ASSERT_EQUAL_INT32(BVX_OK, slice(&o));
        b.caps = BVX_CAPS_TAPER;
        if (bvx_build_sections(ctx, &t, &b, &back) != BVX_OK) TEST_FAIL_MESSAGE(bvx_last_message(ctx));
        bvx_mesh_view_of(&back, &v);
        bvx_certificate k;
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_check(ctx, &v, 0, &k));
        bvx_mesh_free(ctx, &back);
        TEST_ASSERT_TRUE(k.closed && k.edge_manifold && k.vertex_manifold && k.oriented);
        double const error = fabs(k.volume / volume - 1.0);
        TEST_ASSERT_TRUE(error < last);
        last = error;
    }
    TEST_ASSERT_TRUE(last < 0.005);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_csl_by_hand);
    RUN_TEST(test_csl_holes_belong_to_what_is_around_them);
    RUN_TEST(test_csl_has_a_byte_order_mark);
    RUN_TEST(test_csl_has_planes_of_any_direction);
    RUN_TEST(test_csl_of_parallel_planes_has_one_normal);
    RUN_TEST(test_csl_with_the_other_sign_of_d);
    RUN_TEST(test_csl_refusals);
    RUN_TEST(test_csv_by_hand);
    RUN_TEST(test_csv_of_many_sections);
    RUN_TEST(test_csv_of_empty_sections);
    RUN_TEST(test_csv_of_planes);
    RUN_TEST(test_csv_of_planes_round_trip);
    RUN_TEST(test_csv_refusals);
    RUN_TEST(test_round_trips);
    RUN_TEST(test_every_cut);
    RUN_TEST(test_writers_refuse);
    RUN_TEST(test_slices_of_a_box);
    RUN_TEST(test_slices_refuse);
    RUN_TEST(test_mesh_to_contours_to_mesh);
    return UNITY_END();
}
