/* section.h - contour stacks made ready: planes in fixed point, their crossings with the grid, cells between
 * two of them. Not installed.
 *
 * Coordinates. A stack has a frame u, v, w (w along the normal). On the planes u and v are snapped to fixed
 * point: 2^fine units a grid cell, contour points on odd numbers, grid lines of every level on even ones
 * (fine is larger than the depth of subdivision). So no contour point lies on a line. A segment may pass
 * through a meeting of two lines: there every line is thought of as moved by (e_u, e_v), e_u >> e_v > 0, so
 * that all order along lines and segments is strict.
 *
 * Bit budgets. |q| < 2^30, differences < 2^31, products < 2^62, sums of two < 2^63; the order of two
 * crossings on one line compares fractions by products below 2^94: 128 bits. */
#ifndef BVXI_SECTION_H
#define BVXI_SECTION_H

#include "core/core.h"
#include "core/vec3.h"

#define BVXI_NONE UINT32_MAX

enum { BVXI_SECTION_DEEPEST = 8, BVXI_SECTION_EXTENT_BITS = 29 };

/* Where a contour's segment crosses a line of the grid: axis 0 is a line of one u, axis 1 of one v. */
typedef struct bvxi_line_cut {
    uint32_t segment; /* from point segment to the next one of its loop */
    int32_t line;     /* fixed point */
    int32_t axis;
    uint32_t ring; /* its place in the plane's ring, once that is known */
} bvxi_line_cut;

/* A piece of a loop within a cell, inside on its left: from a cut over count points, the first of them point,
 * to a cut. A loop that lies in the cell whole has no cuts. */
typedef struct bvxi_arc {
    uint32_t from, to;
    uint32_t point, count;
} bvxi_arc;

typedef struct bvxi_contour {
    uint32_t first, count; /* points */
    uint32_t given;        /* number in the stack given */
    int32_t hole;
    double end[2]; /* a part that ends below, above: how deep its inside is at most; else 0 */
} bvxi_contour;

/* An arc as stretch of the plane's ring, between two places on sides of its
 * cell (0 low v, 1 high u, 2 high v, 3 low u). */
typedef struct bvxi_ring_arc {
    uint32_t from, to; /* places in the ring; from is none where the loop lies in the cell whole */
    uint8_t from_side, to_side;
} bvxi_ring_arc;

enum { BVXI_SEGMENT_GROUP = 4 };

/* Segments as distances take them: where each begins, where it leads, the square of its length. */
typedef struct bvxi_segment_group {
    double u[BVXI_SEGMENT_GROUP], v[BVXI_SEGMENT_GROUP], du[BVXI_SEGMENT_GROUP], dv[BVXI_SEGMENT_GROUP],
        square[BVXI_SEGMENT_GROUP];
} bvxi_segment_group;

/* How a plane meets the grid's edges. */
enum { BVXI_PLANE_EXACT, BVXI_PLANE_FIELD, BVXI_PLANE_EMPTY };

typedef struct bvxi_plane {
    double w;
    uint32_t section; /* number in the stack given */
    uint32_t point_count, contour_count;
    uint64_t point_room, contour_room; /* of all */
    uint32_t *given;                   /* number of each point in the stack given */
    int32_t (*q)[2];
    double (*uv)[2];
    uint32_t *next;
    bvxi_contour *contour;
    uint64_t *inside; /* a bit a grid point, rows of words */
    /* first those with lines of the grid, in ring order, then those of subdivided cells */
    bvxi_line_cut *cut;
    uint32_t cut_count, cut_room, grid_cut_count;
    bvxi_line_cut *shared_cut; /* its range of all planes' array: cut, until more than was counted is added */
    uint32_t shared_room;
    bvxi_arc *arc;           /* in the cells of the grid, in the order of the cells */
    bvxi_ring_arc *ring_arc; /* the same; once the ring is known */
    uint32_t *arc_cell;      /* of each, see bvxi_cell_key */
    /* cells whose sides the contours cross more than once, or that hold a loop; ascending */
    uint32_t *asking;
    uint32_t arc_count, asking_count;
    uint32_t *ring; /* place of each point in the ring: points and cuts in the order of the loops */
    uint32_t ring_count;
    uint32_t vertex; /* the mesh's vertex at place 0 of the ring */
    bvxi_segment_group *group;
    double (*box)[4];    /* binary heap over groups of segments */
    uint32_t leaf_count; /* power of two */
    double slack;        /* what rounding may make of squares of distances */
    double area;
    int lines;       /* of a cap: points are vertices, and their segments cross nothing */
    uint8_t ends[2]; /* some part ends below, above */
    /* of a nesting level (slab.h): the section that it is a part of; else NULL */
    struct bvxi_plane *whole;
    /* the segments that distances and inside tests are taken from, ascending; NULL: all */
    const uint32_t *segment;
    uint32_t segment_count;
    int turned; /* 1: what its loops enclose is outside: a level of holes */
} bvxi_plane;

/* A plane without loops, where a body begins or ends between sections. */
static inline int bvxi_plane_is_nothing(const bvxi_plane *plane)
{
    return plane->section == BVXI_NONE;
}

typedef struct bvxi_section_mesh {
    double *position;
    uint32_t *triangle;
    uint64_t vertex_count, vertex_room, triangle_count, triangle_room;
} bvxi_section_mesh;

/* What becomes of nesting levels between two sections: blended as all are; linearly, where they would
 * cross otherwise; not apart from each other, where they would cross all the same. */
enum { BVXI_LEVELS_APART, BVXI_LEVELS_LINEAR, BVXI_LEVELS_JOINED, BVXI_LEVELS_CROSSED = 0x80 };

typedef struct bvxi_nesting {
    /* [loops of all planes] each loop's level between its plane and the one above, and the one below */
    uint8_t *level[2];
    /* [planes] levels between a plane and the next one; 1: the sections are blended as they are */
    uint8_t *count;
    uint8_t *joined; /* [planes] what became of levels that crossed there: BVXI_LEVELS_... */
    /* levels as planes of their own: below and above, level by level, from slab to slab */
    bvxi_plane *plane;
    uint32_t plane_count;
} bvxi_nesting;

typedef struct bvxi_stack {
    bvx_context *ctx;
    const char *function;
    const bvx_sections *given;
    /* of each point given: steps by which it is moved in fixed point; or NULL. See mend.c */
    const int16_t (*nudge)[2];
    double axis[3][3];      /* u, v, w in the world */
    double low[2], high[2]; /* bounds of the contours */
    double origin[2];       /* grid point (0, 0) */
    double step[2];         /* sides of a cell */
    int32_t size[2];        /* cells */
    int32_t fine;           /* bits below a cell */
    int32_t words;          /* a row of grid points */
    bvxi_plane *plane;      /* ascending in w */
    uint32_t plane_count;
    double reach[2];    /* of tapered ends beyond the first and the last plane */
    bvxi_plane all;     /* arrays that the planes have stretches of */
    bvxi_plane nothing; /* a plane without loops: only its bits are there */
    bvxi_nesting nesting;
    uint32_t slab_count;
    int cubic; /* 1: distances go from section to section by the cubic; 0: straight */
    bvx_sections_options options;
    bvx_sections_report report;
    bvxi_section_mesh mesh;
    bvxi_section_mesh slab_mesh; /* arrays that the slabs' meshes are stretches of */
    /* in a slab's own view of the stack: of the vertices before those of its mesh */
    const double *ring_position;
    uint32_t ring_vertices;
    /* 1: a view on another thread, whose arrays do not grow and which leaves no messages */
    int fixed;
    /* in the field's way: the lines on the first and the last plane, inside on their left */
    uint32_t (*cap_edge[2])[2];
    uint32_t cap_edge_count[2];
    uint64_t cap_edge_room[2];
} bvxi_stack;

/* A point's coordinate along an axis of the stack. */
static inline double bvxi_along_axis(const double axis[3], const double p[3])
{
    return (axis[0] * p[0] + axis[1] * p[1]) + axis[2] * p[2];
}

/* A coordinate of fixed point along an axis of the plane. */
static inline double bvxi_fixed_u(const bvxi_stack *s, int axis, int32_t q)
{
    return s->origin[axis] + (double)q / (double)(1 << s->fine) * s->step[axis];
}

/* Words of a bit a grid point. */
static inline uint64_t bvxi_stack_words(const bvxi_stack *s)
{
    return ((uint64_t)s->size[1] + 1) * (uint64_t)s->words;
}

/* Square of the distance from a place to a segment. */
static inline double bvxi_segment_square(const double a[2], const double b[2], const double at[2])
{
    double const dx = b[0] - a[0], dy = b[1] - a[1], x = at[0] - a[0], y = at[1] - a[1];
    double const along = x * dx + y * dy, length = dx * dx + dy * dy;
    double const share = along <= 0.0 ? 0.0 : along >= length ? 1.0 : along / length;
    double const ex = x - share * dx, ey = y - share * dy;
    return ex * ex + ey * ey;
}

/* ---- stack.c: the planes of one body, their points snapped, loops directed with the inside on their
 * left */

bvx_status bvxi_stack_open(bvx_context *ctx, const char *function, const bvx_sections *given,
                           const bvx_sections_options *options, bvxi_stack *stack);
/* The same in two steps: loops and grid; then, with stack->nudge set where
 * points are moved apart, all that fixed point decides. */
bvx_status bvxi_stack_begin(bvx_context *ctx, const char *function, const bvx_sections *given,
                            const bvx_sections_options *options, bvxi_stack *stack);
bvx_status bvxi_stack_finish(bvxi_stack *stack);
/* A label becomes the only one that there is, or some loop has it. */
bvx_status bvxi_choose_label(bvx_context *ctx, const char *function, const bvx_sections *given,
                             int32_t *label);
/* Arrays of all planes, which are fields of items of so many bytes; points, loops: by section. */
bvx_status bvxi_planes_open(bvx_context *ctx, bvxi_plane *all, bvxi_plane *plane, uint64_t stride,
                            uint32_t count, const uint64_t *points, const uint64_t *loops);
/* The points of a loop, but those equal to the one before. */
bvx_status bvxi_plane_take_loop(bvx_context *ctx, const char *function, const bvx_sections *given,
                                bvx_sections_report *report, bvxi_plane *plane, uint64_t number);

/* stack_grid.c: lay the grid over the bounds; or take that of another stack whose bounds hold this one's. */
typedef struct bvxi_section_grid {
    double origin[2], step[2];
    int32_t size[2], fine;
} bvxi_section_grid;
void bvxi_stack_give_grid(const bvxi_stack *stack, bvxi_section_grid *grid);
void bvxi_stack_take_grid(bvxi_stack *stack, const bvxi_section_grid *grid);

/* ---- stack_check.c: invalid arrays are refused, planes are put into order ---- */

bvx_status bvxi_sections_check(bvx_context *ctx, const char *function, const bvx_sections *given);
/* Refuse a result that is NULL or in use, which would be lost. */
bvx_status bvxi_sections_check_result(bvx_context *ctx, const char *function, const bvx_sections *result);
/* The arrays of made, cut to what they hold, replace those of to. normal_room: capacity of made's normals. */
bvx_status bvxi_sections_give(bvx_context *ctx, bvx_sections *made, uint64_t normal_room, bvx_sections *to);
/* sections.c: options out of their limits are refused; so are contours so far off or so small that
 * volumes are infinite or 0. */
bvx_status bvxi_section_options_check(bvx_context *ctx, const char *function, bvx_sections_options *o);

/* A label of options as it is meant. Once they are taken 0 is a label and this number the only one. */
#define BVXI_LABEL_ONLY BVX_LABEL_ZERO
static inline int32_t bvxi_label_taken(int32_t label, int32_t standard)
{
    return label == 0 ? standard : label == BVX_LABEL_ZERO ? 0 : label;
}
bvx_status bvxi_sections_check_extent(bvx_context *ctx, const char *function, const bvx_sections *given);
/* sections.c: warn of what a report says; depth: as in the options. */
void bvxi_sections_warn(bvx_context *ctx, bvx_sections_report *report, int32_t depth);
/* An orthonormal frame with w along normal, exact where that is an axis. */
bvx_status bvxi_section_frame(bvx_context *ctx, const char *function, const double normal[3],
                              double axis[3][3]);
/* 1: within 1e-4 rad of each other; *against: one points the other way. */
int bvxi_section_parallel(const double a[3], const double b[3], int *against);

/* ---- planes.c: what each plane needs, side by side ---- */

/* Pieces for so many planes or slabs with so much work in all: small bodies
 * are not worth waking a thread for. */
static inline int32_t bvxi_section_pieces(uint64_t count, uint64_t work, uint64_t grain)
{
    int32_t const pieces = bvxi_piece_count(work, grain);
    return (uint64_t)pieces < count ? pieces : (int32_t)count;
}

bvx_status bvxi_planes_place(bvxi_stack *stack);
/* Fixed point, directions, areas, boxes, crossings with the grid. */
bvx_status bvxi_planes_ready(bvxi_stack *stack);
void bvxi_plane_snap(const bvxi_stack *stack, bvxi_plane *plane);
/* Steps of the fixed point from the grid's begin to a place along axis k; the coordinate is twice that and
 * 1. */
int32_t bvxi_snap_steps(const bvxi_stack *stack, int k, double along);
/* 1 when a loop encloses a point of none of its segments. */
int bvxi_loop_contains(const bvxi_plane *plane, const bvxi_contour *contour, const int32_t *at);
/* The number of the contour that a point is one of. */
static inline uint32_t bvxi_contour_of(const bvxi_plane *p, uint32_t point)
{
    uint32_t low = 0, high = p->contour_count;
    while (high - low > 1) {
        uint32_t const middle = low + (high - low) / 2;
        if (p->contour[middle].first <= point) low = middle;
        else high = middle;
    }
    return low;
}
/* Least u and v, then largest, of a loop in fixed point. */
void bvxi_loop_box(const bvxi_plane *plane, const bvxi_contour *contour, int32_t box[4]);
/* box: scratch, one a loop. */
bvx_status bvxi_plane_direct(bvxi_stack *stack, bvxi_plane *plane, int32_t (*box)[4]);

/* ---- simple.c ---- */

bvx_status bvxi_plane_check_simple(bvxi_stack *stack, bvxi_plane *plane);

/* A segment's box and number. */
typedef struct bvxi_segment_box {
    int32_t left, right, low, high;
    uint32_t segment;
} bvxi_segment_box;

static inline bvxi_segment_box bvxi_box_segment(const int32_t *a, const int32_t *b, uint32_t segment)
{
    bvxi_segment_box const box = {a[0] < b[0] ? a[0] : b[0], a[0] < b[0] ? b[0] : a[0],
                                  a[1] < b[1] ? a[1] : b[1], a[1] < b[1] ? b[1] : a[1], segment};
    return box;
}

/* Each two segments whose boxes meet: a segment with those that begin at a lower u, in their order. What is not BVX_OK
 * ends it. */
typedef bvx_status bvxi_pair_fn(void *user, uint32_t segment, uint32_t before);
bvx_status bvxi_sweep(bvx_context *ctx, const bvxi_segment_box *box, uint32_t count, bvxi_pair_fn *pair,
                      void *user);

/* 1 when loops surely neither cross nor touch; 0 requires the check above. sorted, box: scratch, one a segment. */
int bvxi_plane_is_simple(bvxi_plane *plane, bvxi_segment_box *sorted, bvxi_segment_box *box);
/* 1 where c lies on the left of a to b, -1 on the right, 0 on its line. */
static inline int bvxi_turn_sign(const int32_t *a, const int32_t *b, const int32_t *c)
{
    int64_t const t = ((int64_t)b[0] - a[0]) * ((int64_t)c[1] - a[1]) -
                      ((int64_t)b[1] - a[1]) * ((int64_t)c[0] - a[0]);
    return (t > 0) - (t < 0);
}

/* 1 when c lies on the segment from a to b. */
int bvxi_segment_holds(const int32_t *a, const int32_t *b, const int32_t *c);
/* 1 when two segments that follow each other in no loop meet. */
int bvxi_segments_meet(const int32_t *a, const int32_t *b, const int32_t *c, const int32_t *d);
/* Two segments that share an end: they meet elsewhere when one folds back onto the other. */
int bvxi_folds_back(const int32_t *shared, const int32_t *a, const int32_t *b);

/* ---- loop_arcs.c ---- */

/* A cell of the grid as a number that sorts like its rows. */
static inline uint32_t bvxi_cell_key(int32_t i, int32_t j)
{
    return (uint32_t)j << 16 | (uint32_t)i;
}

/* Room for sorting the arcs of one plane by cell: one an arc, and one a column or row of cells and one
 * more. */
typedef struct bvxi_arc_scratch {
    bvxi_arc *arc;
    uint32_t *cell, *order[2], *start;
} bvxi_arc_scratch;

void bvxi_plane_count_cuts(const bvxi_stack *stack, const bvxi_plane *plane, uint64_t *cuts, uint64_t *arcs);
/* Cut the loops at the grid's lines, into arrays that have room; set the bits of the grid points inside. */
void bvxi_plane_cut(bvxi_stack *stack, bvxi_plane *plane, const bvxi_arc_scratch *scratch);
/* The arcs in a cell: the first of them, and how many. */
uint32_t bvxi_plane_arcs_in(const bvxi_plane *plane, uint32_t key, uint32_t *count);
/* A new crossing's number. */
bvx_status bvxi_plane_add_cut(bvxi_stack *stack, bvxi_plane *plane, uint32_t segment, int32_t axis,
                              int32_t line, uint32_t *number);
void bvxi_plane_look_at_cells(const bvxi_stack *stack, bvxi_plane *plane);
/* Bits at which a row's parity changes, into the bits inside. */
void bvxi_plane_fill_rows(const bvxi_stack *stack, uint64_t *inside);
/* The area inside, by the trapezoid rule about the bounds' corner. */
double bvxi_plane_area(const bvxi_stack *stack, const bvxi_plane *plane);

/* ---- plane_rings.c ---- */

/* Number points and cuts of each plane along its loops, one number for cuts
 * that are one; they become the first vertices of the mesh. */
bvx_status bvxi_rings_make(bvxi_stack *stack);
/* Where a contour's stretch of the ring begins and ends. */
static inline void bvxi_ring_stretch(const bvxi_plane *p, uint32_t contour, uint32_t *first, uint32_t *end)
{
    *first = p->ring[p->contour[contour].first];
    *end = contour + 1 < p->contour_count ? p->ring[p->contour[contour + 1].first] : p->ring_count;
}

/* ---- distance2d.c ---- */

/* Arrays for the tree of so many segments. */
bvx_status bvxi_plane_open_tree(bvx_context *ctx, bvxi_plane *plane, uint32_t segments);
void bvxi_plane_tree(bvxi_plane *plane);
/* Distance from a place to the nearest contour; *hint is a segment thought
 * to be near, and becomes the nearest found. */
double bvxi_plane_distance(const bvxi_plane *plane, double u, double v, uint32_t *hint);
/* The same distance, and the segment of least number among those that lie so near. */
double bvxi_plane_nearest(const bvxi_plane *p, double u, double v, uint32_t *segment);
/* 1 when the snapped place is inside. */
int bvxi_plane_inside(const bvxi_stack *stack, const bvxi_plane *plane, double u, double v);
/* 1 when the place is inside, by the boxes: for values only, as places next to a contour may be told
 * otherwise. */
int bvxi_plane_encloses(const bvxi_plane *plane, double u, double v);

/* ---- part_ends.c: parts that end before the next section ---- */

bvx_status bvxi_stack_ends(bvxi_stack *stack);
/* The outer loop of each loop's part: its own number, or around a hole. */
void bvxi_plane_parts(const bvxi_plane *plane, uint32_t *part);
/* Distance to the nearest contour, and its number: the least of those that lie so near. */
double bvxi_contour_distance(const bvxi_plane *plane, double u, double v, uint32_t *hint, uint32_t *contour);

bvx_status bvxi_section_add_vertex(bvxi_stack *stack, const double position[3], uint32_t *number);
bvx_status bvxi_section_more_triangles(bvxi_stack *stack);

static inline bvx_status bvxi_section_add_triangle(bvxi_stack *stack, uint32_t a, uint32_t b, uint32_t c)
{
    bvxi_section_mesh *const m = &stack->mesh;
    if (BVXI_UNLIKELY(m->triangle_count == m->triangle_room)) BVXI_TRY(bvxi_section_more_triangles(stack));
    uint32_t *t = m->triangle + 3 * m->triangle_count++;
    t[0] = a;
    t[1] = b;
    t[2] = c;
    return BVX_OK;
}

static inline const double *bvxi_section_vertex(const bvxi_stack *stack, uint32_t number)
{
    return number < stack->ring_vertices
               ? stack->ring_position + 3 * (uint64_t)number
               : stack->mesh.position + 3 * (uint64_t)(number - stack->ring_vertices);
}

/* The world's place of u, v, w. */
void bvxi_section_place(const bvxi_stack *stack, double u, double v, double w, double position[3]);
void bvxi_section_locate(bvxi_stack *stack, double u, double v, double w);

/* BVXI_GROW but in views: rooms that were laid out beforehand do not grow, and the caller tries again with others. */
#define BVXI_SLAB_GROW(s, array, count, room, what) \
    (BVXI_LIKELY((count) < (room)) ? BVX_OK         \
     : (s)->fixed                  ? BVX_ERR_BUDGET \
                                   : BVXI_GROW(s, array, count, room, what))

/* Numbers by a key. near: keys with one upper half lie beside one another, for halves that come in order; else they
 * are spread by a hash. */
typedef struct bvxi_map {
    uint64_t *key; /* UINT64_MAX: free */
    uint32_t *value;
    uint64_t room, count;
    int near;
} bvxi_map;

/* The value of a key, BVXI_NONE at first; add makes room. */
bvx_status bvxi_map_add(bvx_context *ctx, bvxi_map *map, uint64_t key, uint32_t **value);
bvx_status bvxi_map_reserve(bvx_context *ctx, bvxi_map *map, uint64_t count);
uint32_t bvxi_map_find(const bvxi_map *map, uint64_t key);
void bvxi_map_clear(bvxi_map *map);
/* The same for maps that do not grow in views. */
bvx_status bvxi_stack_map_add(const bvxi_stack *s, bvxi_map *map, uint64_t key, uint32_t **value);
/* The key of an edge, whichever end comes first. */
static inline uint64_t bvxi_edge_key(uint32_t a, uint32_t b)
{
    return a < b ? (uint64_t)a << 32 | b : (uint64_t)b << 32 | a;
}

/* Keep a place in a report. */
static inline void bvxi_report_place(bvx_sections_report *report, const double at[3])
{
    if (report->located < BVX_SECTIONS_LOCATED) memcpy(report->unkept[report->located++], at, 24);
}

/* Closed, oriented, edge- and vertex-manifold? Any other mesh is freed where its arrays are not the caller's. */
bvx_status bvxi_section_check_mesh(bvx_context *ctx, bvx_mesh *mesh, int own, int *sound);

/* ---- slab.c, caps.c ---- */

/* Subdivide cells between two planes where they require it; adds cuts to both. */
typedef struct bvxi_slab bvxi_slab;
bvx_status bvxi_slabs_make(bvxi_stack *stack, bvxi_slab **slabs);
/* The surface in all slabs: the exact way each into a mesh of its own, side
 * by side; the field's way into the stack's. */
bvx_status bvxi_slabs_fill(bvxi_stack *stack, bvxi_slab *slabs, uint32_t count);
/* The mesh of the rings, then of the slabs, then of what came last. */
bvx_status bvxi_slabs_join(bvxi_stack *stack, const bvxi_slab *slabs, uint32_t count, bvx_mesh *mesh);
/* The section's region as triangles; side 1: seen from above, -1: from below. */
bvx_status bvxi_cap_fill(bvxi_stack *stack, const bvxi_plane *plane, int32_t side);
/* The smallest outer loop around each hole, or BVXI_NONE; that of outer loops is BVXI_NONE. */
void bvxi_plane_owners(const bvxi_plane *plane, uint32_t *owner);
/* The same for the region within lines between vertices. */
bvx_status bvxi_cap_fill_edges(bvxi_stack *stack, const uint32_t (*edge)[2], uint32_t count, int32_t side);

/* ---- exact order ---- */

/* A segment's crossings with the lines u = x and v = y, both between its
 * ends: 1 when that with x comes first. */
static inline int bvxi_x_first(const int32_t *a, const int32_t *b, int32_t x, int32_t y)
{
    int64_t const dx = (int64_t)b[0] - a[0], dy = (int64_t)b[1] - a[1];
    int64_t l = ((int64_t)x - a[0]) * dy, r = ((int64_t)y - a[1]) * dx;
    if (l < 0) l = -l; /* each the way along its own axis times the other's length */
    if (r < 0) r = -r;
    return l < r || (l == r && dx < 0);
}

/* 1 when a crossing lies beyond the line m of the other axis. */
static inline int bvxi_cut_beyond(const bvxi_plane *p, const bvxi_line_cut *c, int32_t m)
{
    const int32_t *const a = p->q[c->segment], *const b = p->q[p->next[c->segment]];
    int const k = c->axis, o = 1 - k;
    int64_t const dk = (int64_t)b[k] - a[k], d = (int64_t)b[o] - a[o];
    int64_t s = ((int64_t)c->line - a[k]) * d - ((int64_t)m - a[o]) * dk;
    if (dk < 0) s = -s;
    if (s != 0) return s > 0;
    /* through a meeting of lines: on u + e_u it lies beyond v + e_v where it rises */
    return k == 0 && (d > 0) == (dk > 0);
}

#endif
