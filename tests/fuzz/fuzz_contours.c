/* fuzz_contours.c - the contour readers on damaged files, and bodies from whatever was read: no crash, no
 * leak, no more memory than the file's size allows; an error in words, or a stack that is written and read to
 * itself; a body that is closed and manifold. */
#include "fuzz_files.h"

static const fuzz_format formats[] = {
    {"csl", BVX_FORMAT_CSL},
    {"csv", BVX_FORMAT_CSV},
};

/* Loops come back section by section, in their order, each with points of its own: those that shared points,
 * as a hole does that bounds another body too, no longer do. */
static void fuzz_check_same(const bvx_sections *s, const bvx_sections *back)
{
    uint64_t loop = 0, point = 0;

    fuzz_require(back->section_count == s->section_count && back->loop_count == s->loop_count,
                 "other sections or loops");
    for (uint64_t k = 0; k < s->section_count; k++)
        for (uint64_t i = 0; i < s->loop_count; i++) {
            const bvx_section_loop *const a = &s->loops[i], *const b = &back->loops[loop];
            if (a->section != k) continue;
            fuzz_require(b->section == k && b->label == a->label && b->point_count == a->point_count,
                         "another loop");
            fuzz_require(b->first_point == point, "points out of order");
            for (uint64_t j = 0; j < 3 * (uint64_t)a->point_count; j++)
                fuzz_require(back->points[3 * b->first_point + j] == s->points[3 * a->first_point + j],
                             "another point");
            point += a->point_count;
            loop++;
        }
    fuzz_require(back->point_count == point, "points of no loop");
}

static void fuzz_check_writing(bvx_context *ctx, const bvx_sections *s)
{
    bvx_buffer file = {0};
    bvx_sections back;

    memset(&back, 0, sizeof back);
    /* negative labels and numbers that are too large are refused */
    if (bvx_write_sections(ctx, s, BVX_FORMAT_CSL, &file) == BVX_OK) {
        fuzz_require(bvx_read_sections(ctx, file.bytes, file.size, BVX_FORMAT_CSL, NULL, &back) == BVX_OK,
                     bvx_last_message(ctx));
        fuzz_check_same(s, &back);
    }
    bvx_sections_free(ctx, &back);
    bvx_buffer_free(ctx, &file);
}

static void fuzz_check_body(bvx_context *ctx, const bvx_sections *s, int32_t choice)
{
    bvx_sections_options o = {.struct_size = sizeof o};
    bvx_mesh mesh = {0};
    bvx_mesh_view view;
    bvx_certificate c;
    bvx_status status;

    o.slabs.grid[0] = 2 + choice % 7;
    o.slabs.grid[1] = 2 + choice % 11;
    o.slabs.depth = choice % 5;
    o.caps = choice % 2;
    o.mend = choice / 64 % 2;
    o.label = s->loops[0].label;
    o.cells = 8 + choice % 13;
    o.thickness = choice / 512 % 2 == 0 ? 0.0 : 0.5; /* of one section alone */
    o.agree = choice / 256 % 3 == 0 ? 0.0 : 1e9;     /* of planes that are not parallel */
    status = bvx_build_sections(ctx, s, &o, &mesh);
    if (status == BVX_OK) {
        bvx_mesh_view_of(&mesh, &view);
        fuzz_require(bvx_mesh_check(ctx, &view, 0, &c) == BVX_OK, bvx_last_message(ctx));
        fuzz_require(c.closed && c.edge_manifold && c.vertex_manifold && c.oriented,
                     "a body that is not closed or not manifold");
    } else {
        fuzz_require(mesh.positions == NULL && bvx_last_message(ctx)[0] != 0,
                     "a failure with a result, or without words");
        fuzz_require(status != BVX_ERR_ARGUMENT || strstr(bvx_last_message(ctx), "stands for none") != NULL,
                     bvx_last_message(ctx));
        fuzz_require(strstr(bvx_last_message(ctx), "does not close") == NULL, bvx_last_message(ctx));
    }
    bvx_mesh_free(ctx, &mesh);
}

/* All bodies at once, the first few of them. */
static void fuzz_check_bodies(bvx_context *ctx, const bvx_sections *s, int32_t choice)
{
    bvx_sections_options o = {.struct_size = sizeof o};
    bvx_mesh mesh[4] = {0};
    int32_t label[4];
    uint32_t count = 0;
    bvx_status status;

    for (uint64_t i = 0; i < s->loop_count && count < 4; i++) {
        uint32_t n = 0;
        while (n < count && label[n] != s->loops[i].label) n++;
        if (n == count) label[count++] = s->loops[i].label;
    }
    o.cells = 8 + choice % 9;
    o.caps = choice / 16 % 2;
    o.agree = choice / 32 % 2 == 0 ? 0.0 : 1e9;
    status = bvx_build_bodies(ctx, s, &o, label, count, mesh);
    for (uint32_t i = 0; i < count; i++) {
        bvx_mesh_view view;
        bvx_certificate c;
        if (status != BVX_OK) {
            fuzz_require(mesh[i].positions == NULL && bvx_last_message(ctx)[0] != 0,
                         "a failure with a result, or without words");
            continue;
        }
        bvx_mesh_view_of(&mesh[i], &view);
        fuzz_require(bvx_mesh_check(ctx, &view, 0, &c) == BVX_OK, bvx_last_message(ctx));
        fuzz_require(c.closed && c.edge_manifold && c.vertex_manifold && c.oriented,
                     "one of several bodies that is not closed or not manifold");
        bvx_mesh_free(ctx, &mesh[i]);
    }
}

/* The options of the body follow from the file's bytes. */
static int fuzz_read(bvx_context *ctx, const uint8_t *file, size_t size, int format)
{
    static const bvx_sections empty;
    bvx_sections s;
    int good;

    memset(&s, 0, sizeof s);
    good = fuzz_was_read(ctx, bvx_read_sections(ctx, file, size, formats[format].number, NULL, &s),
                         READ_SECTIONS, size, 0);
    if (good) {
        fuzz_require(s.loop_count > 0 && s.owned == 1, "a stack without loops");
        fuzz_check_writing(ctx, &s);
        fuzz_check_body(ctx, &s, (int32_t)(bvx_hash(file, size, 0) >> 40));
        /* One in eight: its cells take longer than all else here. */
        if (bvx_hash(file, size, 1) % 8 == 0)
            fuzz_check_bodies(ctx, &s, (int32_t)(bvx_hash(file, size, 0) >> 41));
    } else {
        fuzz_require(memcmp(&s, &empty, sizeof s) == 0, "a result behind an error");
    }
    bvx_sections_free(ctx, &s);
    return good;
}

/* ---- files to begin with ---- */

static const char fuzz_csv[] =
    "section,position,loop,x,y\n1,0,1,0,0\n1,0,1,9,0\n1,0,1,9,7\n1,0,1,0,7\n1,0,2,2,2\n1,0,2,5,2\n1,0,2,5,4\n2,4,1,1,1\n2,4,1,8,1\n"
    "2,4,1,8,8\n2,4,1,3,6\n3,6,1,1,1\n3,6,1,4,1\n3,6,1,4,4\n3,6,2,6,5\n3,6,2,7,7\n3,6,2,5,7\n";
static const char fuzz_csl[] =
    "CSLC\n2 2\n\n1 7 2 0 0 1 -0.5\n\n0 0 0.5\n4 0 0.5\n4 4 0.5\n0 4 0.5\n1 1 .5\n2 1 .5\n1 2 .5\n\n4 1 0 1 2 3\n3h0 1 4 5 6\n"
    "2 3 1 0 0 -1 1.5\n0 0 1.5 4 0 1.5 4 4 1.5\n3 1 2 1 0\n";

/* planes that cross, three with squares and one that no loop lies on */
static const char fuzz_planes[] =
    "CSLC\n4 2\n\n1 4 1 0 0 1 -0.5\n0 0 0.5\n4 0 0.5\n4 4 0.5\n0 4 0.5\n4 1 0 1 2 3\n"
    "2 4 1 0 1 0.1 -2\n0 2.2 -2\n4 2.2 -2\n4 1.8 2\n0 1.8 2\n4 1 0 1 2 3\n"
    "3 4 1 1 0 0 -2\n2 0 -2\n2 4 -2\n2 4 2\n2 0 2\n4 1 0 1 2 3\n4 0 0 1 1 1 40\n";

static const char *const fuzz_words[] = {
    "section",     "position",   "loop", "label", "x",     "y",      ",",
    ";",           "\t",         "\n",   "\"",    "#",     "CSLC\n", "h0 ",
    "3 1 0 1 2\n", "4294967295", "-1",   "nan",   "1e999", "0",      "99999999999999999999"};

static int fuzz_make_seeds(bvx_context *ctx, fuzz_file *seeds)
{
    int n = 0;
    (void)ctx;
    fuzz_seed_text(seeds, &n, "csv", fuzz_csv);
    fuzz_seed_text(seeds, &n, "csl", fuzz_csl);
    fuzz_seed_text(seeds, &n, "csl", fuzz_planes);
    return n;
}

static const fuzz_target *fuzz_reader(void)
{
    static const fuzz_target target = {formats,        sizeof formats / sizeof formats[0],
                                       fuzz_words,     sizeof fuzz_words / sizeof fuzz_words[0],
                                       fuzz_read,      NULL,
                                       fuzz_make_seeds};
    return &target;
}
