/* lone_section.c - one section alone: between which planes its body lies.
 *
 * A body needs two planes, or one that it tapers to on both sides. Where the caps taper, the section itself
 * is enough and the ends reach half a thickness beyond it: a lens. Else it is copied half a thickness to
 * either side: a slab. The section stays in the middle, so that its points are vertices as they were given.
 *
 * Loops are looked at before they are copied, so that what is refused is named by the numbers of those
 * given. */
#include "bodies/lone_section.h"

enum { COPIES = 3 };

typedef struct lone_count {
    uint64_t loops, points;
    uint32_t section;
} lone_count;

/* What the body has; 0 where it is not in one section alone, or not one body. */
static int count_lone(const bvx_sections *given, uint32_t section, int32_t label, lone_count *n)
{
    n->loops = n->points = 0;
    for (uint64_t i = 0; i < given->loop_count; i++) {
        const bvx_section_loop *const l = &given->loops[i];
        if (label != BVXI_LABEL_ONLY && l->label != label) continue;
        if (section != BVXI_NONE && l->section != section) continue;
        if (n->loops != 0 && l->section != n->section) return 0;
        if (label == BVXI_LABEL_ONLY && l->label != given->loops[0].label) return 0;
        n->section = l->section;
        n->loops++;
        n->points += l->point_count;
    }
    return n->loops != 0;
}

static void add_copy(const bvx_sections *given, const bvx_sections_options *o, const lone_count *n,
                     const double axis[3], double by, bvx_sections *to)
{
    uint32_t const section = (uint32_t)to->section_count++;

    to->positions[section] = given->positions[n->section] + by;
    for (uint64_t i = 0; i < given->loop_count; i++) {
        bvx_section_loop l = given->loops[i];
        const double *const from = given->points + 3 * l.first_point;
        double *const at = to->points + 3 * to->point_count;
        if (o->label != BVXI_LABEL_ONLY && l.label != o->label) continue;
        if (l.section != n->section) continue;
        /* The middle copy has the coordinates given, to the bit. */
        for (uint64_t k = 0; k < 3 * (uint64_t)l.point_count; k++)
            at[k] = by == 0.0 ? from[k] : from[k] + by * axis[k % 3];
        l.first_point = to->point_count;
        l.section = section;
        to->loops[to->loop_count++] = l;
        to->point_count += l.point_count;
    }
}

static bvx_status copy_section(bvx_context *ctx, const char *function, const bvx_sections *one,
                               const bvx_sections_options *o, const lone_count *n, bvxi_lone *lone)
{
    bvx_sections *const to = &lone->copies;
    double axis[3][3];

    /* Before anything is taken: a stack within the limits may be beyond them three times over. */
    if (COPIES * n->points > INT32_MAX || COPIES * n->loops > INT32_MAX)
        return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                             "%s: %u points of one section; a slab of it takes them three times, and the "
                             "limit is 2^31",
                             function, n->points);
    BVXI_TRY(bvxi_section_frame(ctx, function, one->normal, axis));
    memcpy(to->normal, one->normal, sizeof to->normal);
    BVXI_TRY(BVXI_ARRAY(ctx, 3 * (COPIES * n->points), "the points of a slab", to->points));
    BVXI_TRY(BVXI_ARRAY(ctx, COPIES * n->loops, "the loops of a slab", to->loops));
    BVXI_TRY(BVXI_ARRAY(ctx, COPIES, "the positions of a slab", to->positions));
    for (int k = 0; k < COPIES; k++) add_copy(one, o, n, axis[2], 0.5 * (k - 1) * o->thickness, to);
    return BVX_OK;
}

bvx_status bvxi_lone_open(bvx_context *ctx, const char *function, const bvx_sections *given, uint32_t section,
                          const bvx_sections_options *o, bvxi_lone *lone)
{
    bvxi_stack stack;
    lone_count n = {0};

    memset(lone, 0, sizeof *lone);
    if (o->thickness == 0.0 || !count_lone(given, section, o->label, &n)) return BVX_OK;
    /* The planes beside it are of no use to the body, and theirs may be other normals. */
    bvx_sections one = *given;
    if (given->normals != NULL)
        memcpy(one.normal, given->normals + 3 * (uint64_t)n.section, sizeof one.normal);
    one.normals = NULL;
    lone->times = 1;
    lone->sections = one;

    /* A lens needs no copies: its ends reach half the thickness beyond the one plane. */
    if (o->caps == BVX_CAPS_TAPER) return BVX_OK;

    /* A stack of one plane, made and dropped: it refuses what a slab of copies would. */
    if (!o->mend) BVXI_TRY(BVXI_SCOPE(ctx, bvxi_stack_open(ctx, function, &one, o, &stack)));
    BVXI_TRY(copy_section(ctx, function, &one, o, &n, lone));
    lone->times = COPIES;
    lone->sections = lone->copies;
    return BVX_OK;
}

void bvxi_lone_report(const bvxi_lone *lone, bvx_sections_report *report)
{
    report->sections /= (uint64_t)lone->times;
    report->loops /= (uint64_t)lone->times;
    report->holes /= (uint64_t)lone->times;
    report->points /= (uint64_t)lone->times;
    report->repeated_points /= (uint64_t)lone->times;
    report->mended_loops /= (uint64_t)lone->times;
}
