/* slice.c - the contours of a mesh on parallel planes.
 *
 * A triangle that a plane cuts gives one piece of contour, from the edge that its boundary comes down by to the
 * one that it goes up by. Pieces are joined by their edges, the two indices of their ends, so that no comparison
 * of coordinates decides. Vertices on a plane count as above it, so no plane meets a vertex. On a closed and
 * oriented mesh every piece has one before and one after it. */
#include "contours/section.h"
#include "mesh/mesh.h"
#include "mesh/view.h"
#include "mesh/topology.h"

#include <math.h>

void bvx_sections_free(bvx_context *context, bvx_sections *sections)
{
    if (context == NULL || sections == NULL) return;
    if (sections->owned) {
        bvxi_free(context, sections->normals,
                  sections->normals == NULL ? 0 : sections->section_capacity * 24);
        bvxi_free(context, sections->positions, sections->section_capacity * 8);
        bvxi_free(context, sections->loops, sections->loop_capacity * sizeof *sections->loops);
        bvxi_free(context, sections->points, sections->point_capacity * 24);
    }
    memset(sections, 0, sizeof *sections);
}

bvx_status bvxi_sections_give(bvx_context *ctx, bvx_sections *s, uint64_t normal_room, bvx_sections *to)
{
    BVXI_TRY(bvxi_resize(ctx, BVXI_RESULT, &s->positions, s->section_capacity * 8, s->section_count * 8,
                         "the sections"));
    s->section_capacity = s->section_count;
    BVXI_TRY(bvxi_resize(ctx, BVXI_RESULT, &s->loops, s->loop_capacity * sizeof *s->loops,
                         s->loop_count * sizeof *s->loops, "the loops"));
    s->loop_capacity = s->loop_count;
    BVXI_TRY(
        bvxi_resize(ctx, BVXI_RESULT, &s->points, s->point_capacity * 24, s->point_count * 24, "the points"));
    s->point_capacity = s->point_count;
    /* Last, as who frees them after a failure goes by normal_room. */
    if (s->normals != NULL)
        BVXI_TRY(bvxi_resize(ctx, BVXI_RESULT, &s->normals, normal_room * 24, s->section_count * 24,
                             "the sections"));

    /* The old stack is freed only when the new one is complete; s gives up its arrays with the copy. */
    bvx_sections_free(ctx, to);
    *to = *s;
    memset(s, 0, sizeof *s);
    return BVX_OK;
}

static const char slice_name[] = "bvx_slice_mesh";

typedef struct slice_work {
    bvx_context *ctx;
    const bvx_mesh_view *view;
    double axis[3][3];
    uint32_t *weld;   /* [vertices] */
    double *height;   /* [vertices] */
    double *position; /* of the planes */
    uint64_t plane_count;
    double narrow;   /* loops up to this width are left out */
    uint64_t *first; /* [planes + 1] of each plane's triangles in list */
    uint32_t *list;
    uint64_t list_count;
    uint64_t *from, *to; /* edges of one plane's pieces, as the lower number << 32 | the higher */
    uint32_t *order;     /* pieces by from */
    uint8_t *used;
    uint64_t most; /* pieces of a plane */
    bvx_sections made;
    int32_t label;
} slice_work;

/* ---- planes ---- */

enum { SLICE_MOST_PLANES = 1 << 20 };

#define SLICE_NARROW \
    (1.0 / 67108864.0) /* of the mesh across the normal: the fixed point of sections distinguishes no less */

static bvx_status make_planes(slice_work *w, const bvx_slice_options *o, double low, double high)
{
    if (o->positions != NULL) {
        if (o->spacing != 0.0)
            return bvxi_fail_for(w->ctx, BVX_ERR_ARGUMENT, BVX_REASON_CONTRADICTION,
                                 "%s: spacing and positions are both given", slice_name);
        if (o->position_count < 1 || o->position_count > SLICE_MOST_PLANES)
            return bvxi_fail_for(w->ctx, BVX_ERR_ARGUMENT, BVX_REASON_RANGE,
                                 "%s: %u positions, allowed are 1 to %d", slice_name, o->position_count,
                                 (int64_t)SLICE_MOST_PLANES);
        for (uint64_t i = 0; i < o->position_count; i++) {
            if (!(o->positions[i] - o->positions[i] == 0.0))
                return bvxi_fail_for(w->ctx, BVX_ERR_RANGE, BVX_REASON_NOT_FINITE,
                                     "%s: position %i is not finite", slice_name, i);
            if (i > 0 && !(o->positions[i] > o->positions[i - 1]))
                return bvxi_fail_for(w->ctx, BVX_ERR_ARGUMENT, BVX_REASON_RANGE,
                                     "%s: position %i does not lie above the one before it", slice_name, i);
        }
        w->plane_count = o->position_count;
    } else {
        if (!(o->spacing > 0.0) || o->spacing - o->spacing != 0.0)
            return bvxi_fail_for(w->ctx, BVX_ERR_ARGUMENT, BVX_REASON_NULL,
                                 "%s: a spacing above 0 or positions are needed", slice_name);

        double const count = floor((high - low) / o->spacing + 0.5);
        if (!(count <= SLICE_MOST_PLANES))
            return bvxi_fail_for(w->ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                                 "%s: a spacing of %g makes %g planes, %d is the limit", slice_name,
                                 o->spacing, count, (int64_t)SLICE_MOST_PLANES);
        w->plane_count = count < 1.0 ? 1 : (uint64_t)count;
    }
    BVXI_TRY(BVXI_ARRAY(w->ctx, w->plane_count, "the planes", w->position));
    for (uint64_t i = 0; i < w->plane_count; i++)
        w->position[i] = o->positions != NULL ? o->positions[i] : low + ((double)i + 0.5) * o->spacing;
    return BVX_OK;
}

/* The first plane that does not lie below a height; all vertices at or above a plane count as above it. */
static uint64_t planes_up_to(const slice_work *w, double height)
{
    uint64_t low = 0, high = w->plane_count;
    while (low < high) {
        uint64_t const middle = low + (high - low) / 2;
        if (w->position[middle] <= height) low = middle + 1;
        else high = middle;
    }
    return low;
}

static bvx_status read_heights(slice_work *w, double *low, double *high)
{
    double across[2][2] = {{1e308, -1e308}, {1e308, -1e308}}, reach = 0.0;
    uint64_t different;

    *low = 1e308;
    *high = -1e308;
    BVXI_TRY(bvxi_weld(w->ctx, w->view, w->weld, &different));
    for (uint64_t i = 0; i < w->view->vertex_count; i++) {
        double p[3];
        bvxi_view_position(w->view, i, p);
        w->height[i] = bvxi_along_axis(w->axis[2], p);
        for (int k = 0; k < 2; k++) {
            double const at = bvxi_along_axis(w->axis[k], p);
            bvxi_widen(&across[k][0], &across[k][1], &at, 1);
        }
    }
    for (int k = 0; k < 2; k++)
        if (across[k][1] - across[k][0] > reach) reach = across[k][1] - across[k][0];
    w->narrow = SLICE_NARROW * reach;
    for (uint64_t t = 0; t < w->view->triangle_count; t++) {
        uint32_t c[3];
        bvxi_view_triangle(w->view, t, c);
        for (int k = 0; k < 3; k++) { bvxi_widen(low, high, &w->height[w->weld[c[k]]], 1); }
    }
    return BVX_OK;
}

/* ---- triangles by plane ---- */

static void slice_corners(const slice_work *w, uint64_t t, uint32_t c[3])
{
    bvxi_view_triangle(w->view, t, c);
    for (int k = 0; k < 3; k++) c[k] = w->weld[c[k]];
}

static void range_of(const slice_work *w, uint64_t t, uint64_t *begin, uint64_t *end)
{
    double low, high;
    uint32_t c[3];
    slice_corners(w, t, c);
    low = high = w->height[c[0]];
    for (int k = 1; k < 3; k++) bvxi_widen(&low, &high, &w->height[c[k]], 1);
    /* Planes above its lowest corner and up to its highest; none where both counts are equal. */
    *begin = planes_up_to(w, low);
    *end = planes_up_to(w, high);
}

static bvx_status list_by_plane(slice_work *w)
{
    BVXI_TRY(BVXI_ZEROS(w->ctx, w->plane_count + 1, "the triangles of planes", w->first));
    for (uint64_t t = 0; t < w->view->triangle_count; t++) {
        uint64_t begin, end;
        range_of(w, t, &begin, &end);
        for (uint64_t i = begin; i < end; i++) w->first[i + 1]++;
    }
    for (uint64_t i = 0; i < w->plane_count; i++) {
        if (w->first[i + 1] > w->most) w->most = w->first[i + 1];
        w->first[i + 1] += w->first[i];
    }
    w->list_count = w->first[w->plane_count];
    if (w->list_count == 0)
        return bvxi_fail(w->ctx, BVX_ERR_EMPTY, "%s: no plane meets the mesh", slice_name);
    if (w->list_count > INT32_MAX)
        return bvxi_fail_for(w->ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                             "%s: planes part more than 2^31 triangles", slice_name);
    BVXI_TRY(BVXI_ARRAY(w->ctx, w->list_count, "the triangles of planes", w->list));
    /* Filled from the back, so that triangles stay in order and each start ends where it should. */
    for (uint64_t t = w->view->triangle_count; t-- > 0;) {
        uint64_t begin, end;
        range_of(w, t, &begin, &end);
        for (uint64_t i = begin; i < end; i++) w->list[--w->first[i + 1]] = (uint32_t)t;
    }
    for (uint64_t i = 0; i < w->plane_count; i++) w->first[i] = w->first[i + 1];
    w->first[w->plane_count] = w->list_count;
    return BVX_OK;
}

/* ---- one plane ---- */

static void edge_place(const slice_work *w, uint64_t key, double position, double p[3])
{
    uint32_t const a = (uint32_t)(key >> 32), b = (uint32_t)key;
    /* From the lower number to the higher one, so both triangles at an edge compute the same place. */
    double const share = (position - w->height[a]) / (w->height[b] - w->height[a]);
    double from[3], to[3];
    bvxi_view_position(w->view, a, from);
    bvxi_view_position(w->view, b, to);
    for (int k = 0; k < 3; k++) {
        p[k] = from[k] + share * (to[k] - from[k]);
        if (w->axis[2][k] == 1.0) p[k] = position; /* planes across an axis are exact */
        else if (w->axis[2][k] == -1.0) p[k] = -position;
    }
}

static uint64_t gather_pieces(slice_work *w, uint64_t plane)
{
    double const z = w->position[plane];
    uint64_t n = 0;

    for (uint64_t i = w->first[plane]; i < w->first[plane + 1]; i++) {
        uint32_t c[3];
        slice_corners(w, w->list[i], c);
        for (int k = 0; k < 3; k++) {
            uint32_t const a = c[k], b = c[(k + 1) % 3];
            int const up = w->height[a] < z && w->height[b] >= z;
            int const down = w->height[a] >= z && w->height[b] < z;
            if (up) w->to[n] = bvxi_edge_key(a, b);
            if (down) w->from[n] = bvxi_edge_key(a, b);
        }
        w->order[n] = (uint32_t)n;
        n++;
    }
    return n;
}

/* 1 when a loop is so narrow that it encloses no area: twice the area is the width times the way round. */
static int encloses_none(const slice_work *w, const double *p, uint64_t count)
{
    const double *const n = w->axis[2];
    double area = 0.0, way = 0.0;

    for (uint64_t i = 0; i < count; i++) {
        /* About the first point, so that large coordinates do not take the digits. */
        const double *const a = p + 3 * i, *const b = p + 3 * (i + 1 == count ? 0 : i + 1);
        double const x = b[0] - a[0];
        double const y = b[1] - a[1];
        double const z = b[2] - a[2];
        double const u = a[0] - p[0];
        double const v = a[1] - p[1];
        double const t = a[2] - p[2];
        area += (n[0] * (v * z - t * y) + n[1] * (t * x - u * z)) + n[2] * (u * y - v * x);
        way += sqrt((x * x + y * y) + z * z);
    }
    return (area < 0.0 ? -area : area) <= w->narrow * way;
}

/* Where the pieces from an edge begin in the order, or count. */
static uint64_t find_piece(const slice_work *w, const uint64_t *sorted, uint64_t count, uint64_t key)
{
    uint64_t low = 0, high = count;
    while (low < high) {
        uint64_t const middle = low + (high - low) / 2;
        if (sorted[middle] < key) low = middle + 1;
        else high = middle;
    }
    while (low < count && sorted[low] == key && w->used[low]) low++; /* several sheets may share an edge */
    return low < count && sorted[low] == key ? low : count;
}

/* w->from is sorted; order[i] is the piece that it belongs to. */
static bvx_status follow_pieces(slice_work *w, uint64_t plane, uint64_t n)
{
    double const z = w->position[plane];
    bvx_sections *const s = &w->made;

    memset(w->used, 0, (size_t)n);
    for (uint64_t start = 0; start < n; start++) {
        bvx_section_loop l;
        uint64_t const first = w->from[start];
        if (w->used[start]) continue;
        memset(&l, 0, sizeof l);
        l.first_point = s->point_count;
        l.section = (uint32_t)plane;
        l.label = w->label;

        for (uint64_t i = start;;) {
            uint64_t const key = w->to[w->order[i]];
            double p[3];
            w->used[i] = 1;
            edge_place(w, key, z, p);
            if (l.point_count == 0 || !bvxi_vec_is_same(s->points + 3 * (s->point_count - 1), p)) {
                memcpy(s->points + 3 * s->point_count++, p, 24);
                l.point_count++;
            }
            if (key == first) break;
            i = find_piece(w, w->from, n, key);
            if (i == n)
                return bvxi_fail(
                    w->ctx, BVX_ERR_FORMAT,
                    "%s: the contour at %g does not close near (%g, %g, %g): the mesh has a hole or flipped triangles there",
                    slice_name, z, p[0], p[1], p[2]);
        }
        const double *const begin = s->points + 3 * l.first_point;
        const double *const last = s->points + 3 * (s->point_count - 1);
        /* The first point may be the last one's place, as neighbours' are. */
        if (l.point_count > 1 && bvxi_vec_is_same(begin, last)) {
            l.point_count--;
            s->point_count--;
        }
        if (l.point_count < 3 || encloses_none(w, s->points + 3 * l.first_point, l.point_count))
            s->point_count = l.first_point;
        else s->loops[s->loop_count++] = l;
    }
    return BVX_OK;
}

/* ---- result ---- */

static bvx_status slice_all(slice_work *w, const bvx_slice_options *o, bvx_sections *sections)
{
    double low, high, bounds[2][3];

    BVXI_TRY(bvxi_progress(w->ctx, "slice", 0.0));
    BVXI_TRY(bvxi_view_bounds(w->ctx, slice_name, w->view, bounds[0], bounds[1]));
    /* The frame before all else: it refuses a normal that is none. */
    BVXI_TRY(bvxi_section_frame(w->ctx, slice_name, o->normal, w->axis));
    BVXI_TRY(BVXI_ARRAY(w->ctx, w->view->vertex_count, "the vertices' numbers", w->weld));
    BVXI_TRY(BVXI_ARRAY(w->ctx, w->view->vertex_count, "the vertices' heights", w->height));
    BVXI_TRY(read_heights(w, &low, &high));
    BVXI_TRY(make_planes(w, o, low, high));
    BVXI_TRY(bvxi_progress(w->ctx, "slice", 0.3));
    BVXI_TRY(list_by_plane(w));
    bvx_sections *const s = &w->made;

    s->owned = 1;
    s->section_capacity = w->plane_count;
    /* A loop has three pieces at least, and a point for each. */
    s->loop_capacity = w->list_count / 3 + 1;
    s->point_capacity = w->list_count;
    BVXI_TRY(bvxi_alloc(w->ctx, BVXI_RESULT, s->section_capacity * 8, "the sections", &s->positions));
    BVXI_TRY(bvxi_alloc(w->ctx, BVXI_RESULT, s->loop_capacity * sizeof *s->loops, "the loops", &s->loops));
    BVXI_TRY(bvxi_alloc(w->ctx, BVXI_RESULT, s->point_capacity * 24, "the points", &s->points));
    memcpy(s->positions, w->position, (size_t)w->plane_count * 8);
    memcpy(s->normal, w->axis[2], sizeof s->normal);
    s->section_count = w->plane_count;

    BVXI_TRY(BVXI_ARRAY(w->ctx, w->most, "the pieces of a contour", w->from));
    BVXI_TRY(BVXI_ARRAY(w->ctx, w->most, "the pieces of a contour", w->to));
    BVXI_TRY(BVXI_ARRAY(w->ctx, w->most, "the pieces of a contour", w->order));
    BVXI_TRY(BVXI_ARRAY(w->ctx, w->most, "the pieces of a contour", w->used));
    for (uint64_t i = 0; i < w->plane_count; i++) {
        BVXI_TRY(bvxi_progress(w->ctx, "slice", 0.7 + 0.3 * (double)i / (double)w->plane_count));
        uint64_t const n = gather_pieces(w, i);
        if (n == 0) continue;
        BVXI_TRY(bvxi_radix_sort(w->ctx, w->from, w->order, n));
        BVXI_TRY(follow_pieces(w, i, n));
    }
    if (s->loop_count == 0)
        return bvxi_fail(w->ctx, BVX_ERR_EMPTY, "%s: no plane meets more of the mesh than points and lines",
                         slice_name);
    return bvxi_sections_give(w->ctx, s, 0, sections);
}

static const bvxi_option slice_rows[] = {
    BVXI_REAL(bvx_slice_options, spacing, 0.0, BVXI_FINITE),
    BVXI_RESERVED(bvx_slice_options, reserved),
};

static bvx_status run_slice_mesh(bvx_context *context, const bvx_mesh_view *mesh,
                                 const bvx_slice_options *options, bvx_sections *sections)
{
    bvx_slice_options o;
    slice_work w = {.ctx = context, .view = mesh};
    if (mesh == NULL) return bvxi_fail_null(context, slice_name, "mesh");
    BVXI_TRY(bvxi_sections_check_result(context, slice_name, sections));
    BVXI_TRY(bvxi_take_options(context, slice_name, options, &o, sizeof o));
    BVXI_TRY(bvxi_check_options(context, slice_name, &o, BVXI_OPTIONS(slice_rows)));
    BVXI_TRY(bvxi_view_check(context, slice_name, mesh));
    w.label = bvxi_label_taken(o.label, 1);
    if (bvxi_vec_is_zero(o.normal)) o.normal[2] = 1.0;
    bvx_status const status = slice_all(&w, &o, sections);
    bvx_sections_free(context, &w.made);
    return status;
}

bvx_status bvx_slice_mesh(bvx_context *context, const bvx_mesh_view *mesh, const bvx_slice_options *options,
                          bvx_sections *sections)
{
    return BVXI_CALL(context, run_slice_mesh(context, mesh, options, sections));
}
