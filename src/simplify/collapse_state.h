/* collapse_state.h - a mesh while its edges collapse: vertices, quadrics, costs, and what undoes a collapse.
 * Only simplify/ includes this. Not installed. */
#ifndef BVXI_COLLAPSE_STATE_H
#define BVXI_COLLAPSE_STATE_H

#include "simplify/corners.h"
#include "nearest/crossing_tree.h"
#include "simplify/sheets.h"

enum {
    COLLAPSE_GONE = -2, /* in place of a vertex's edge */
    COST_BUCKETS = 1 << 12,
    COLLAPSE_STAR = 96 /* triangles around either end; a vertex of more stays, its neighbours do not */
};

/* How a vertex may move: bits. */
enum {
    VERTEX_LINE = 1,     /* on one line of borders or seams: along it, or across a strip to another line */
    VERTEX_JUNCTION = 2, /* where such lines meet or end: into another junction */
    VERTEX_LOCKED = 4,   /* not at all */
    VERTEX_PINCHED = 8   /* of one that is gone: where it went was no junction before */
};

enum { ATTRIBUTE_CHANNELS = 11 };

/* Sets of attributes, rows, of which a vertex has one on each side of its seams. */
typedef struct bvxi_attributes {
    uint32_t *row;         /* of each corner, or NULL without rows; BVXI_VERTEX_NONE of ghosts */
    uint32_t *material;    /* of each triangle, or NULL */
    uint32_t *vertex, *uv; /* of each row: the vertex of the given mesh, and its texture coordinates' index */
    double *q;             /* of each row [Size: rows * stride] */
    uint64_t rows;
    int32_t stride, channels;
    int32_t uv2_at, normal_at, colour_at; /* where channels of the kinds begin; texture coordinates at 0 */
    double length[ATTRIBUTE_CHANNELS];    /* that a difference of 1 stands for, in units of 1 / scale */
} bvxi_attributes;

#define COST_NOTHING   1e-20f /* the cost that rounding alone makes, in units of the mesh's size */
#define COLLAPSE_NEVER 3e38f  /* the cost of an edge that must not collapse */

/* Mean edges that a vertex may lie from the planes that it stands for, where levels crumple. */
#define CRUMPLED_MOST (2.0 / 3.0)

/* Of mean edge's square to a triangle's area, where all sides are equal. */
#define EDGE_SQUARE 2.309401076758503

/* What undoes the collapse in which a vertex went. */
typedef struct collapse_undo {
    double p[3]; /* of the vertex that stayed, as it was */
    int32_t
        edge; /* corner opposite to the edge; the vertex that stayed is next, the one that went previous */
    uint32_t stayed;
    uint32_t before; /* the vertex that went into it last before this one, or BVXI_VERTEX_NONE */
    uint32_t order;  /* of collapses that touch each other: rises */
} collapse_undo;

/* Triangle i of the star is at corner[i], which is its corner at v for the first of them and at u for the
 * others; link[i] and link[i + 1] are its other vertices, counter-clockwise around both. */
typedef struct collapse_star {
    int32_t of_v, count;
    int32_t corner[2 * COLLAPSE_STAR];
    uint32_t link[2 * COLLAPSE_STAR + 1];
} collapse_star;

/* What became of the edges that were tried. */
typedef struct bvxi_collapse_counts {
    uint64_t collapsed, refused;
    uint64_t split; /* vertices of several fans, when it was opened */
} bvxi_collapse_counts;

typedef struct bvxi_collapse {
    bvx_context *ctx;
    const char *function;
    bvxi_collapse_options options;
    bvxi_corners mesh;
    int fast; /* 1: with AVX2 */

    uint32_t
        *from; /* of each triangle: that of the sheets << 2 | the corner that became its first; or NULL */
    bvxi_attributes attributes;

    float *least;     /* of each vertex: the cost of its cheapest edge */
    int32_t *edge;    /* the corner from which that edge leads to the next vertex, -1, or COLLAPSE_GONE */
    int32_t *any;     /* a corner of the vertex */
    uint8_t *kind;    /* VERTEX_... */
    uint8_t *settled; /* not 0: it has moved by itself and is not judged yet */
    uint8_t *fresh;   /* 1: it has changed since the level was judged */
    uint8_t
        *stale; /* 1: an edge of it has another cost than bvxi_edges_evaluate finds, at both of its ends */
    collapse_undo *undo; /* of vertices that are gone */
    uint32_t *last;      /* the vertex that went into this one last, or BVXI_VERTEX_NONE */

    const bvx_mesh_view *given; /* the mesh as it was given */
    const bvxi_sheets *sheets;
    const bvx_mesh_view *view; /* and as sheets */
    const uint32_t *source;    /* corner of the given mesh at each corner of the sheets, or NULL: the same */
    /* As the mesh was opened: its triangles' corners, the view's vertex at each of its vertices, and the vertex that
     * each is part of, or NULL before the first packing. */
    uint32_t *origin, *first_source, *now;
    uint64_t first_triangles, first_vertices;
    crossing_tree tree; /* while collapses are looked at one by one: node[0] is not NULL */
    uint8_t *came;      /* of each vertex, 1: triangles of the mesh crossed there; or NULL */
    uint32_t *pairs;    /* that crossed when the level was judged, or NULL [Size: crossings * 2] */
    uint64_t crossings;
    int judged; /* 1: they are those of the mesh as it is, unless something is fresh */

    uint32_t *costs; /* counts of costs [Size: bvxi_collapse_cost_pieces() * COST_BUCKETS] */
    float reached;   /* cost of the dearest edges that were tried */
    double crumpled; /* mean edges that a vertex may lie from the planes that it stands for */
    double scale;    /* quadrics measure lengths in units of 1 / scale, the mesh's size */
    double area;     /* of the mesh as it was opened, in the same units */
    double low[3];
    uint64_t alive; /* vertices */
    uint32_t order; /* of the next collapse */
    bvxi_closed closed;
    bvxi_collapse_counts counts;
} bvxi_collapse;

/* 1: a collapse of the mesh must know where its corners come from. */
int bvxi_collapse_needs_sources(const bvx_mesh_view *mesh, const bvxi_collapse_options *options);
/* Take the sheets of a checked mesh, or the mesh itself as a view; BVX_ERR_ARGUMENT: what options->borders does
 * not allow. The order of vertices and triangles does not matter where no two vertices are at one position. Both
 * must live as long as the collapse, which is scratch: 190 bytes a triangle; of n channels of attributes 200 + 32 n a
 * vertex. */
bvx_status bvxi_collapse_open(bvx_context *ctx, const char *function, const bvx_mesh_view *mesh,
                              const bvxi_sheets *sheets, const bvxi_collapse_options *options,
                              bvxi_collapse **collapse);
/* Collapse the cheapest edges until at most target triangles are left or none can go. from, to: share of
 * progress. */
bvx_status bvxi_collapse_to(bvxi_collapse *collapse, uint64_t target, double from, double to);
/* The mesh as it is now, opened as by bvxi_mesh_open, with its attributes where the library owns its arrays; plain:
 * without them, so that what hangs together does so by its indices. */
bvx_status bvxi_collapse_give(bvxi_collapse *collapse, bvx_mesh *level);
bvx_status bvxi_collapse_give_plain(bvxi_collapse *collapse, bvx_mesh *level);
/* Pairs of triangles that cross; cheap where the collapse has counted them already. */
bvx_status bvxi_collapse_crossings(bvxi_collapse *collapse, uint64_t *count);
/* Triangles for the next try. Errors grow about as triangles become fewer, so n * part of them would take up
 * all of it; a collapse cannot be undone, so half of that way is gone, by ratios, and at least a twentieth. */
uint64_t bvxi_collapse_next_try(uint64_t triangles, double part);

/* Nearest value of the type that positions have in the result. */
static inline double bvxi_collapse_rounded(const bvxi_collapse *c, double x)
{
    return c->options.given.position_type == BVX_F32 ? bvxi_nearest_float(x) : x;
}

static inline int bvxi_collapse_is_gone(const bvxi_collapse *c, uint32_t v)
{
    return c->edge[v] == COLLAPSE_GONE;
}

/* edge_costs.c: 1 along borders and seams, which vertices on lines may collapse along. */
int bvxi_collapse_is_feature(const bvxi_collapse *c, int32_t edge);

/* Not memchr, which a freestanding core does not ask for. */
static inline int bvxi_any_marked(const uint8_t *mark, uint64_t count)
{
    uint64_t i = 0;
    while (i < count && mark[i] == 0) i++;
    return i < count;
}

/* edge_costs.c: a corner of each vertex; the cheapest edge by the costs beside them of each that is stale or has none. */
void bvxi_collapse_index(bvxi_collapse *c);
void bvxi_collapse_find_least(bvxi_collapse *c);
/* edge_costs.c: evaluate all edges between stale vertices, and the cheapest of each of them. */
bvx_status bvxi_collapse_evaluate(bvxi_collapse *c);
/* Triangles around a vertex after that of `start`, until one has vertex `other`; 0: too many. */
int bvxi_star_gather_side(const bvxi_corners *m, int32_t start, uint32_t other, int32_t most,
                          collapse_star *star);
/* Close the link; 0: the triangles cannot be those around one vertex. */
int bvxi_star_close(collapse_star *star);
/* Take a triangle out from between its two other edges, which become one; corner is opposite to the
 * collapsing edge. Returns 1 unless it is a ghost. */
int bvxi_collapse_drop_triangle(bvxi_corners *m, int32_t corner);
uint64_t bvxi_collapse_cost_pieces(const bvxi_collapse *c);
/* One round of collapses, the cheapest edges of all vertices; *done counts them. idle: sweeps without one. */
bvx_status bvxi_collapse_sweep(bvxi_collapse *c, uint64_t target, int idle, uint64_t *done);
/* Cut handles and fill holes at most so long around, the smallest first, once a level has been judged; what was
 * collapsed before can no more be undone. *done counts both. */
bvx_status bvxi_collapse_close_small(bvxi_collapse *c, double longest, uint64_t *done);
/* Undo the collapse in which v went, or one after it that builds on it; returns the vertex that is back. */
uint32_t bvxi_collapse_undo(bvxi_collapse *c, uint32_t v);
/* A vertex moves with its quadric. */
void bvxi_collapse_move_quadric(bvxi_collapse *c, uint32_t u, const double p[3]);
/* settle_level.c: move vertices to where the level's triangles lie nearest to the mesh; what they were is at undo, and
 * settled marks them until the level has been judged. */
bvx_status bvxi_collapse_settle(bvxi_collapse *c);
/* One of them goes back. */
void bvxi_collapse_unsettle(bvxi_collapse *c, uint32_t v);
/* Undo all collapses from an order on. */
void bvxi_collapse_undo_since(bvxi_collapse *c, uint32_t order);

/* attributes.c */
bvx_status bvxi_attributes_open(bvxi_collapse *c);
/* The vertex of the given mesh that a corner had when it was opened. */
uint32_t bvxi_given_vertex(const bvxi_collapse *c, int32_t corner);
/* 1: attributes have a seam along an edge of two triangles, or materials a border. */
int bvxi_attributes_part(const bvxi_collapse *c, int32_t edge);
/* 1: each row of one end has a row of its own at the other, so that a collapse and its undoing know which becomes
 * which. Where a seam ends it is 0. */
int bvxi_attributes_match(const bvxi_collapse *c, int32_t edge);
/* Add what a collapse costs in attributes, about the vertex next to the edge's corner; offset leads to the other. */
void bvxi_attributes_add(const bvxi_collapse *c, int32_t edge, const double offset[3], double a[6],
                         double b[3], double *cost);
/* The rows of the vertex that goes become those of the one that stays, which moves by d; corner: those of the
 * former in triangles that stay. */
void bvxi_attributes_merge(bvxi_collapse *c, int32_t edge, const double offset[3], const double d[3],
                           const int32_t *corner, int32_t count);
/* Corners get a row, which moves. */
void bvxi_attributes_move(bvxi_collapse *c, uint32_t row, const double way[3], const int32_t *corner,
                          int32_t count);
/* Undo that, once the triangles are back; back: the way of the vertex that stayed. */
void bvxi_attributes_restore(bvxi_collapse *c, int32_t edge, const double back[3]);
/* 1: two rows of a vertex differ in texture coordinates of their own indices alone. */
int bvxi_attributes_share(const bvxi_collapse *c, uint32_t row, uint32_t other);
/* A row's attributes, of those kinds that there are; moved 0: its own. */
void bvxi_attributes_give(const bvxi_collapse *c, uint32_t row, int moved, float uv[2], float uv2[2],
                          float normal[3], uint8_t colour[4]);

/* pack_level.c: close the gaps in all arrays where they are a third. What was collapsed before can no more be undone. */
bvx_status bvxi_collapse_pack(bvxi_collapse *c);
/* The vertex that one of the mesh is part of now. */
uint32_t bvxi_collapse_now(const bvxi_collapse *c, uint32_t v);

/* pack_level.c: the new index of each vertex that is left. */
bvx_status bvxi_collapse_number(bvxi_collapse *c, uint32_t **index);

/* enclosed.c: 1: a triangle leaves what the level encloses. *hint: as of bvxi_closest_ask. */
int bvxi_collapse_leaves(const bvxi_collapse *c, uint32_t triangle, uint32_t *hint);
/* The same of triangles from p to the edges of a link [Size: count + 1]. */
int bvxi_collapse_fan_leaves(const bvxi_collapse *c, const uint32_t *link, int32_t count, const double *p);
/* Mark those with a fresh vertex that do [Size: triangles]; at: of progress. */
bvx_status bvxi_collapse_mark_leaving(const bvxi_collapse *c, double at, uint8_t **leaves);
/* Pieces that the level does not go around once. */
bvx_status bvxi_collapse_escaped(bvxi_collapse *c, uint64_t *escaped);

/* judge.c: undo collapses until no two triangles cross but beside those of the mesh that do; *undone counts
 * them. From then on collapses are looked at one by one, until the end is called. */
bvx_status bvxi_collapse_judge(bvxi_collapse *c, double from, double to, uint64_t *undone);
void bvxi_collapse_end_careful(bvxi_collapse *c);
/* 1 when triangles from p to the edges of a link [Size: count + 1] would cross others, or each other,
 * once u and v are gone. */
int bvxi_collapse_crosses(const bvxi_collapse *c, uint32_t u, uint32_t v, const uint32_t *link, int32_t count,
                          const double *p);

#endif
