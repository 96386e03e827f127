/* contour_text.c - contour stacks as readers make them, and which reader a format has. */
#include "io_contour/contour_text.h"

#include "contours/section.h"

static uint64_t contour_line(const bvxi_contour_file *f, const char *at)
{
    uint64_t line = 1;
    for (const char *p = f->begin; p < at; p++) line += *p == '\n';
    return line;
}

bvx_status bvxi_contour_fail(const bvxi_contour_file *f, const char *at, bvx_status status, const char *what)
{
    return BVXI_FILE_FAIL(f, status, "line %u: %s", contour_line(f, at), what);
}

bvx_status bvxi_contour_fail_number(const bvxi_contour_file *f, const char *at, const char *what,
                                    uint64_t number, const char *rest)
{
    return BVXI_FILE_FAIL(f, BVX_ERR_FORMAT, "line %u: %s%u%s", contour_line(f, at), what, number, rest);
}

static bvx_status contour_room(bvxi_contour_file *f, void *block, uint64_t count, uint64_t *room,
                               uint64_t item, const char *what)
{
    /* Half as much again, so adding one at a time costs a constant each on average. */
    uint64_t const larger = *room < 64 ? 64 : *room + *room / 2;
    if (count < *room) return BVX_OK;
    if (larger > INT32_MAX)
        return BVXI_FILE_FAIL_FOR(f, BVX_ERR_RANGE, BVX_REASON_TOO_MANY, "more than 2^31 of %s", what);
    BVXI_TRY(bvxi_resize(f->ctx, BVXI_RESULT, block, *room * item, larger * item, what));
    *room = larger;
    return BVX_OK;
}

bvx_status bvxi_contour_add_section(bvxi_contour_file *f, double position)
{
    bvx_sections *const s = &f->sections;
    BVXI_TRY(contour_room(f, &s->positions, s->section_count, &s->section_capacity, 8, "the sections"));
    s->positions[s->section_count++] = position;
    return BVX_OK;
}

bvx_status bvxi_contour_add_plane(bvxi_contour_file *f, double position, const double normal[3])
{
    bvx_sections *const s = &f->sections;
    BVXI_TRY(contour_room(f, &s->normals, s->section_count, &f->normal_room, 24, "the sections"));
    memcpy(s->normals + 3 * s->section_count, normal, 24);
    return bvxi_contour_add_section(f, position);
}

bvx_status bvxi_contour_add_loop(bvxi_contour_file *f, uint32_t section, int32_t label)
{
    bvx_sections *const s = &f->sections;
    BVXI_TRY(contour_room(f, &s->loops, s->loop_count, &s->loop_capacity, sizeof *s->loops, "the loops"));
    bvx_section_loop *const l = &s->loops[s->loop_count++];
    memset(l, 0, sizeof *l);
    l->first_point = s->point_count;
    l->section = section;
    l->label = label;
    return BVX_OK;
}

bvx_status bvxi_contour_add_point(bvxi_contour_file *f, const double p[3])
{
    bvx_sections *const s = &f->sections;
    BVXI_TRY(contour_room(f, &s->points, s->point_count, &s->point_capacity, 24, "the points"));
    memcpy(s->points + 3 * s->point_count++, p, 24);
    s->loops[s->loop_count - 1].point_count++;
    return BVX_OK;
}

bvx_status bvxi_contour_finish(bvxi_contour_file *f, bvx_sections *sections)
{
    if (f->sections.loop_count == 0) return BVXI_FILE_FAIL(f, BVX_ERR_EMPTY, "the file holds no loop");
    return bvxi_sections_give(f->ctx, &f->sections, f->normal_room, sections);
}
