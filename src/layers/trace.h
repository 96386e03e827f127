/* trace.h - the loops in which the surface meets one cell's faces; the surface of one slab as it is made,
 * cell by cell. Not installed. */
#ifndef BVXI_TRACE_H
#define BVXI_TRACE_H

#include "layers/section_field.h"

/* Cell faces as bits: a loop's vertices say on which they lie. Sides are counter-clockwise from low v. */
enum { BVXI_FACE_BELOW = 1, BVXI_FACE_ABOVE = 2, BVXI_FACE_SIDE = 4 };

/* A section below or above the cells. */
typedef struct bvxi_level {
    int kind; /* BVXI_PLANE_EXACT, _FIELD or _EMPTY */
    bvxi_plane *plane;
    double w;
    bvxi_map *edges; /* FIELD: crossings by edge */
    int inserts;     /* FIELD: contour points are put into its lines */
} bvxi_level;

/* A corner of the cell, or of a finer one on its side. */
typedef struct bvxi_trace_node {
    int32_t at[2];
    uint32_t vertex;   /* where the surface crosses the cell's height over it */
    uint8_t inside[2]; /* on the plane below, above */
    uint8_t faces;
} bvxi_trace_node;

enum { BVXI_LINK_STRAIGHT, BVXI_LINK_ARC, BVXI_LINK_ARC_BACK, BVXI_LINK_FIELD, BVXI_LINK_FIELD_BACK };

/* A vertex where the surface meets an edge of the cell; every one has one successor. */
typedef struct bvxi_trace_point {
    uint32_t vertex, next;
    uint32_t arc; /* of a link along a contour */
    uint8_t faces, link, seen;
} bvxi_trace_point;

typedef struct bvxi_trace_end {
    uint32_t arc, cut, point;
    uint8_t side, k;
} bvxi_trace_end;

typedef struct bvxi_trace {
    bvxi_stack *s;
    bvxi_field *field;
    bvxi_level level[2];
    double low_w, high_w;
    bvxi_map folds; /* vertices on sides where a contour comes back */
    /* the cell */
    int32_t low[2], size;
    uint32_t key;     /* of the grid cell */
    int beside_split; /* 1: it or a cell beside it was subdivided */
    const bvxi_arc *arc[2];
    uint32_t arc_count[2];
    bvxi_trace_node *node;
    uint32_t node_count, point_count, end_count;
    uint64_t node_room, point_room, end_room, insert_room;
    bvxi_trace_point *point;
    bvxi_trace_end *end;
    uint32_t *row[2];   /* crossings of one side in order, below and above */
    uint32_t *cross[2]; /* FIELD: crossings around the cell */
    uint32_t cross_count[2];
    uint64_t row_room[2], cross_room[2];
    struct bvxi_trace_insert {
        double along;
        uint32_t point;
    } * insert; /* contour points of one line */
    /* a loop */
    uint32_t count; /* of the loop that is filled */
    /* 1: around a vertex at the loop's middle in any case, 2: half way from there to the cell's */
    int cone;
    int strip;                   /* out: it became a strip from below to above */
    uint32_t loop_count, strips; /* so far in the cell */
    uint32_t choice;             /* how each is filled */
    uint64_t loop_room;          /* of each of the arrays below */
    uint32_t *vertex;
    uint8_t *faces;
    const double **at;
    uint32_t *next, *before;
} bvxi_trace;

/* Room for what most cells need, so that arrays seldom grow. loop: vertices
 * of the longest loop that is likely. */
bvx_status bvxi_trace_open(bvxi_trace *t, uint32_t loop);
/* Capacity for a loop of count vertices, and of any array of a cell; BVX_ERR_BUDGET in a view that would have to
 * grow, whose slab the calling thread makes again afterwards. */
bvx_status bvxi_trace_open_loop(bvxi_trace *t, uint64_t count);
bvx_status bvxi_trace_reserve(const bvxi_trace *t, void *array, uint64_t count, uint64_t *room,
                              uint64_t item);
bvx_status bvxi_trace_loops(bvxi_trace *t);
/* How much there was before a cell's loops were filled. */
typedef struct bvxi_trace_made {
    uint64_t triangles, vertices;
    uint32_t cap_edges[2];
} bvxi_trace_made;
/* Before the loops of a cell are filled; choice: how each is, digits to the base of three. */
void bvxi_trace_begin_fill(bvxi_trace *t, uint32_t choice, bvxi_trace_made *made);
/* As if they had not been. */
void bvxi_trace_undo_fill(bvxi_trace *t, const bvxi_trace_made *made);
/* 1 when triangles of the cell cross. */
int bvxi_trace_crosses(const bvxi_trace *t, const bvxi_trace_made *made);
/* Such a loop of count vertices is one more of the cell. */
bvx_status bvxi_trace_fill(bvxi_trace *t, uint32_t count);
/* The surface in the cell whose fields above are set (low, size, number, beside_split, arc, arc_count). */
bvx_status bvxi_trace_slab_cell(bvxi_trace *t);
/* A strip of a side between two nodes. */
typedef struct bvxi_strip {
    const bvxi_trace_node *left, *right;
    const uint32_t *row[2]; /* crossings (points) below and above, in order [Size: count] */
    uint32_t count[2];
    uint32_t left_point, right_point;
    int side;
} bvxi_strip;
bvx_status bvxi_trace_add_to_loop(bvxi_trace *t, uint32_t *count, uint32_t vertex, uint32_t faces);
/* Field levels: the crossing of an edge between two nodes, as a vertex. */
bvx_status bvxi_trace_edge(bvxi_trace *t, int k, const bvxi_trace_node *a, const bvxi_trace_node *b,
                           uint32_t *vertex);
/* Field levels: links across the cell's face. */
void bvxi_trace_face(bvxi_trace *t, int k);
/* Contour points between two points of a section in the field's way, appended to the loop at *count. */
bvx_status bvxi_trace_insert(bvxi_trace *t, int k, uint32_t from, uint32_t to, int back, uint32_t *count);

/* ---- The surface of one slab as it is made, cell by cell ---- */

typedef struct bvxi_slab_work {
    bvxi_stack *s; /* the stack, or a view of it */
    bvxi_field field;
    bvxi_trace trace;
    bvxi_map map[2];
    uint64_t *row;       /* cells of one row of the grid that the surface may cross */
    uint64_t *split_bit; /* the subdivided cells, in rows of words */
    uint32_t split;      /* the next subdivided cell */
    uint32_t map_top;    /* the map of the level above */
    uint32_t arc[2];     /* the next arc of either plane */
    uint32_t line[2];    /* the next crossing of a line on the low side of the row and on the high one */
    int plain;           /* 1: cells of this slab may be plain */
    int only_traced;     /* 1: no cell is taken as plain; what comes of it is the same */
} bvxi_slab_work;

/* lines: the most crossings of lines of a slab; loop: vertices of the
 * longest loop that is likely. */
bvx_status bvxi_slab_work_open(bvxi_slab_work *work, bvxi_stack *stack, uint32_t lines, uint32_t loop);
bvx_status bvxi_slab_fill(bvxi_slab_work *work, bvxi_slab *slab);

/* A cell that no contour crosses twice on one side, alone with itself: see
 * plain_cell.c. arc: how many on either plane; line: the vertices over its corners,
 * counter-clockwise. *done is 0, and nothing was made, where the cell is not plain. */
bvx_status bvxi_slab_plain_cell(bvxi_slab_work *work, const uint32_t arcs[2], const uint32_t inside[2],
                                const uint32_t line[4], int *done);

#endif
