/* test_formats.c - formats, rules and methods stand once, in the header's
 * lists: endings and texts of the program agree with them. */
#include "unity.h"

#include "bitvox_io.h"
#include "cli_shell/endings.h"

#include <stdio.h>
#include <string.h>

void setUp(void)
{
}

void tearDown(void)
{
}

static void test_every_ending_is_its_format(void)
{
    static const struct {
        const char *text;
        int32_t format;
    } known[] = {
#define KNOWN(name, value, text) {text, name},
        BVX_FORMAT_LIST(KNOWN)
#undef KNOWN
    };
    char name[32];

    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++) {
        snprintf(name, sizeof name, "a.b/c.%s", known[i].text);
        TEST_ASSERT_EQUAL_INT32_MESSAGE(known[i].format, bvx_format_of_name(name), name);
        snprintf(name, sizeof name, "c.%s.GZ", known[i].text);
        TEST_ASSERT_EQUAL_INT32_MESSAGE(known[i].format, bvx_format_of_name(name), name);
        snprintf(name, sizeof name, "c%s", known[i].text);
        TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_FORMAT_UNKNOWN, bvx_format_of_name(name), name);
    }
    TEST_ASSERT_EQUAL_INT32(BVX_FORMAT_NRRD, bvx_format_of_name("c.nhdr"));
    TEST_ASSERT_EQUAL_INT32(BVX_FORMAT_UNKNOWN, bvx_format_of_name("c.docx"));
}

static void expect_endings(const char *text, int32_t set)
{
    char words[64], *word;
    int32_t found = 0;

    TEST_ASSERT_TRUE(strlen(text) < sizeof words);
    strcpy(words, text);
    for (word = strtok(words, " "); word != NULL; word = strtok(NULL, " ")) {
        int32_t const format = bvx_format_of_name(word);

        TEST_ASSERT_TRUE_MESSAGE(format != BVX_FORMAT_UNKNOWN && (found >> format & 1) == 0, word);
        found |= 1 << format;
    }
    TEST_ASSERT_EQUAL_HEX32_MESSAGE(set, found, text);
}

static void test_texts_of_the_program_name_these_formats(void)
{
    expect_endings(CLI_MESHES_READ, BVX_MESHES_READ);
    expect_endings(CLI_MESHES_WRITTEN, BVX_MESHES_WRITTEN);
    expect_endings(CLI_GRIDS, BVX_GRIDS_READ);
    expect_endings(CLI_GRIDS_WRITTEN, BVX_GRIDS_WRITTEN);
    expect_endings(CLI_CONTOURS_READ, BVX_SECTIONS_READ);
    expect_endings(CLI_CONTOURS_WRITTEN, BVX_SECTIONS_WRITTEN);
}

static int32_t taken(const bvx_context *ctx, bvx_status status)
{
    TEST_ASSERT_TRUE(status == bvx_last_error(ctx)->status && status != BVX_OK);
    return bvx_last_error(ctx)->reason != BVX_REASON_CHOICE;
}

/* Readers refuse what is not in their set as no choice, and what is in it because the bytes are no such
 * file. */
static void test_the_sets_are_what_readers_and_writers_take(void)
{
    static const char bytes[] = "no file of any format";
    static const bvx_mesh no_mesh = {0};
    static const bvx_grid no_grid = {0};
    bvx_context *ctx = NULL;
    bvx_read_volume_options raw = {.struct_size = sizeof raw};
    int32_t meshes = 0, grids = 0, points = 0, contours = 0, volumes = 0;

    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_context_create(NULL, &ctx));
    raw.sample_type = BVX_SAMPLE_U8;
    raw.size[0] = raw.size[1] = raw.size[2] = 9; /* more than there are */
    for (int32_t f = 1; f < 31; f++) {
        bvx_mesh mesh = no_mesh;
        bvx_grid grid = no_grid;
        bvx_sections sections = {0};
        bvx_volume volume = {0};

        meshes |= taken(ctx, bvx_read_mesh(ctx, bytes, sizeof bytes - 1, f, NULL, &mesh)) << f;
        points |= taken(ctx, bvx_read_points(ctx, bytes, sizeof bytes - 1, f, &mesh)) << f;
        grids |= taken(ctx, bvx_read_grid(ctx, bytes, sizeof bytes - 1, f, NULL, &grid)) << f;
        contours |= taken(ctx, bvx_read_sections(ctx, bytes, sizeof bytes - 1, f, NULL, &sections)) << f;
        volumes |= taken(ctx, bvx_read_volume(ctx, bytes, sizeof bytes - 1, f,
                                              f == BVX_FORMAT_RAW ? &raw : NULL, &volume))
                   << f;
        bvx_mesh_free(ctx, &mesh);
    }
    bvx_context_destroy(ctx);
    TEST_ASSERT_EQUAL_HEX32(BVX_MESHES_READ, meshes);
    TEST_ASSERT_EQUAL_HEX32(BVX_POINTS_READ, points);
    TEST_ASSERT_EQUAL_HEX32(BVX_GRIDS_READ, grids);
    TEST_ASSERT_EQUAL_HEX32(BVX_SECTIONS_READ, contours);
    TEST_ASSERT_EQUAL_HEX32(BVX_VOLUMES_READ, volumes);
}

static void test_numbers_of_rules_are_without_gaps(void)
{
#define NUMBER(name, value, text) value,
    static const int32_t fills[] = {BVX_FILL_LIST(NUMBER)};
    static const int32_t methods[] = {BVX_LOD_LIST(NUMBER)};
#undef NUMBER

    TEST_ASSERT_EQUAL_INT(BVX_FILL_COUNT, sizeof fills / sizeof fills[0]);
    for (int32_t i = 0; i < BVX_FILL_COUNT; i++) TEST_ASSERT_EQUAL_INT32(i, fills[i]);
    TEST_ASSERT_EQUAL_INT32(BVX_LOD_EDGE_RATIO, methods[0]);
    TEST_ASSERT_EQUAL_INT32(BVX_LOD_COVERAGE, methods[1]);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_every_ending_is_its_format);
    RUN_TEST(test_texts_of_the_program_name_these_formats);
    RUN_TEST(test_the_sets_are_what_readers_and_writers_take);
    RUN_TEST(test_numbers_of_rules_are_without_gaps);
    return UNITY_END();
}
