/* oblique.h - bodies through contours on planes of any position: planes, lattice, tetrahedra. Not installed.
 *
 * All places are in cells of the lattice: one of its vertices is at whole numbers, and OBLIQUE_NEAR of a cell
 * is nothing. What is decided (a side, a sign, which plane a vertex lies on) is decided once and kept; the
 * tetrahedra change by splitting edges and faces only, so they fill their cells without gaps whatever
 * rounding does. */
#ifndef BVXI_OBLIQUE_H
#define BVXI_OBLIQUE_H

#include "contours/section.h"

#define BVXI_OBLIQUE_NEAR   1e-6 /* cells: what lies nearer to a plane or an edge lies on it */
#define BVXI_CROSSING_LEAST 0.02 /* of an edge: no crossing is nearer to its ends */

enum { BVXI_OBLIQUE_PLANES = 1024, BVXI_BLOCK_SIDE = 4, BVXI_BLOCK_SIZE = 64, BVXI_SIGN_UNKNOWN = 2 };

/* A plane with its contours: frame has the units of fixed point, plane the loops. */
typedef struct bvxi_oblique_plane {
    double normal[3], offset, axis[2][3];
    bvxi_stack frame;
    bvxi_plane plane;
    double low[2], high[2]; /* of its contours */
    float *raster;          /* signed distances at whole steps, inside above 0; NULL: no loops */
    float *rest;            /* what the smooth number leaves of them */
    double raster_low[2];
    int32_t raster_size[2];
    uint32_t knot;    /* the first on its contours, or BVXI_NONE */
    uint32_t *vertex; /* of each of its points */
} bvxi_oblique_plane;

/* Where a contour crosses another plane: on the segment that begins at a point, or at that point. */
typedef struct bvxi_knot {
    double at[3];         /* where the contour has it */
    double share;         /* of the segment's way */
    uint32_t plane;       /* whose contour */
    uint32_t segment;     /* or the point, when share is 0 */
    uint32_t other;       /* the plane that is crossed there */
    uint32_t next;        /* on the same plane */
    uint32_t joined;      /* root of those that are one place */
    uint32_t vertex;      /* of the tetrahedra, at the root */
    double sum[3], count; /* at the root: of the places */
    int exact;            /* at the root: a contour's point, which does not move */
} bvxi_knot;

typedef struct bvxi_tetra {
    uint32_t v[4];        /* positive: the last one sees the others counter-clockwise from outside */
    uint32_t n[4];        /* across the face opposite each; BVXI_NONE: nothing that is split */
    uint32_t chain;       /* the next of the same cell */
    uint32_t twin, stamp; /* scratch of splitting, of walking */
} bvxi_tetra;

typedef struct bvxi_tetra_vertex {
    double at[3];
    uint32_t parent[2]; /* the edge that it split; first BVXI_NONE: one of the lattice's, second its place
                           among the values of known blocks, or BVXI_NONE */
    uint32_t tetra;     /* one that it is a corner of */
    float value;
    int8_t sign; /* 1 inside, -1 outside, 0 on a contour */
    int8_t lattice;
} bvxi_tetra_vertex;

/* A grid of nodes over the lattice, or of one of several bodies over its surroundings. */
typedef struct bvxi_smooth {
    double low[3]; /* of node (1, 1, 1) */
    int32_t size[3];
    double scale; /* nodes a cell */
    double *node;
} bvxi_smooth;

/* Edges of a block's vertices along the seven ways of axes: a bit each where the surface of plain cells
 * crosses it, and the number of the first one's vertex. */
typedef struct bvxi_oblique_crossed {
    uint64_t edges[7];
    uint32_t first[7];
} bvxi_oblique_crossed;

typedef struct bvxi_oblique {
    bvx_context *ctx;
    const char *function;
    const bvx_sections *given;
    bvx_sections_options options;
    bvx_sections_report report;
    uint64_t handles_left, specks, apart; /* what contours leave open, for warnings */
    double apart_at[3];                   /* the first place */

    /* Several bodies at once (joint.h): each by itself, on the same lattice; body_count is 0 for a body by
     * itself. Kinds are 0 outside and 1 inside then, else which of the bodies, from 1. */
    struct bvxi_oblique *body;
    uint32_t body_count;
    int of_all; /* 1: the lattice covers the contours of all labels */
    uint32_t
        end[2]; /* parallel planes: the first and the last, beyond which there is nothing; or BVXI_NONE */
    double beyond[2]; /* 1, or -1 where that is against the plane's normal */

    bvxi_oblique_plane *plane;
    uint32_t plane_count;
    uint32_t plane_words;   /* of a set of planes */
    double low[3], high[3]; /* box of the contours, in cells */
    /* Where the number is made: the lattice; of one of several bodies its contours and what is around
     * them. */
    double near_low[3], near_high[3];
    double origin[3], step; /* world = origin + step * cells */
    double agree;           /* cells */
    uint32_t point_count;   /* of all planes' contours */
    double longest;         /* side of the box */
    bvxi_plane all;         /* arrays that the planes have stretches of */

    bvxi_smooth smooth;
    double reach; /* cells: planes farther away have no say between planes */

    bvxi_knot *knot;
    uint64_t knot_count, knot_room;

    /* the lattice: blocks of 4 x 4 x 4 vertices */
    int32_t blocks[3], side[3]; /* side: vertices */
    uint8_t *block_kind;        /* of blocks whose vertices are not known */
    int32_t *block_at;          /* among the known ones, or -1 */
    uint64_t *contour_cells;    /* [blocks] a bit a cell that contours run through */
    uint32_t *known;            /* blocks whose vertices are known */
    uint32_t known_count;
    uint64_t known_room;
    float *value; /* [known * 64] */
    uint64_t value_room;
    uint64_t *inside;         /* [kind_bits * known] a bit a vertex, one bit of kinds after the other */
    uint32_t *vertex_at;      /* [known * 64] among those of the tetrahedra, or BVXI_NONE */
    bvxi_map lattice_vertex;  /* the same of other blocks: block, number in it */
    uint64_t *split, *active; /* [known] a bit a cell: those that are split; others whose corners differ */
    uint32_t *split_first;    /* [known + 1] split cells of the blocks before */
    uint32_t *touch_first;    /* [known + 1] and how often planes touch them */
    bvxi_oblique_crossed *crossed; /* [known] */

    /* split cells: each has a chain of tetrahedra, and which planes touch it */
    uint32_t (*cell)[2]; /* block, number in it; its first tetrahedron is 6 times its number */
    uint64_t cell_count;
    uint32_t (*touch)[2]; /* cell, plane */
    uint64_t touch_count;
    uint32_t *plane_touch; /* [plane + 1] where its cells begin in touch_cell */
    uint32_t *touch_cell;

    bvxi_tetra *tetra;
    uint8_t *mark; /* scratch: what was seen of each at once */
    uint64_t tetra_count, tetra_room, mark_room;
    uint32_t stamps;

    bvxi_tetra_vertex *vertex;
    uint64_t *on;                       /* [vertex * plane_words] planes that it lies on */
    uint64_t vertex_count, vertex_room; /* of both */

    uint32_t *ring, *star; /* scratch: tetrahedra round an edge, round a vertex */
    uint64_t ring_count, ring_room, star_count, star_room;

    bvxi_map contour_edge; /* stretches of contours: twice the plane, 1 more: it runs from the higher end */

    /* the surface */
    bvxi_map crossing; /* vertices on edges */
    bvxi_section_mesh mesh;
    uint8_t *kept;    /* [vertex] scratch: it has a point's coordinates; it stands for a body that stays */
    uint32_t *owner;  /* the tetrahedron of each triangle after those of plain cells */
    uint32_t *output; /* [tetra vertex] of those on contours */
    uint64_t plain_triangles; /* of plain cells, which come first */
    uint64_t owner_room, output_room;
} bvxi_oblique;

/* oblique.c: the closed surface through contours on planes that are not parallel. */
bvx_status bvxi_oblique_body(bvx_context *ctx, const char *function, const bvx_sections *given,
                             const bvx_sections_options *options, bvx_sections_report *report,
                             bvx_mesh *mesh);

static inline int bvxi_oblique_kind_of(const bvxi_oblique *o, float value)
{
    return o->body_count != 0 ? (int)value : value > 0.0F;
}

/* Bits that tell all kinds apart. */
static inline uint32_t bvxi_oblique_kind_bits(const bvxi_oblique *o)
{
    uint32_t bits = 1;
    while (o->body_count >> bits != 0) bits++;
    return bits;
}

/* oblique_planes.c */
bvx_status bvxi_oblique_take_planes(bvxi_oblique *o);
/* The first steps of that: the lattice, and the planes without their contours. */
bvx_status bvxi_oblique_lay_planes(bvxi_oblique *o);
/* 1: a place on a plane, by its coordinates there, lies inside contours of it. */
int bvxi_oblique_encloses(const bvxi_oblique *o, uint32_t plane, const double uv[2]);
/* Signed distance on a plane, exact in sign and value. */
double bvxi_oblique_exact(const bvxi_oblique *o, uint32_t plane, const double at[3]);

/* A point given, in cells. */
static inline void bvxi_oblique_in_cells(const bvxi_oblique *o, const double *point, double at[3])
{
    for (int k = 0; k < 3; k++) at[k] = (point[k] - o->origin[k]) / o->step;
}

/* oblique_lines.c: contours on lines where planes cross are held against each other. */
bvx_status bvxi_oblique_settle(bvxi_oblique *o);
/* The root of the knots that are one place with this one, and that place: the mean of theirs. */
uint32_t bvxi_knot_root(const bvxi_oblique *o, uint32_t knot);
void bvxi_knot_place(const bvxi_oblique *o, uint32_t knot, double at[3]);
/* The next knot on a contour's segment after a share of it, or BVXI_NONE. */
uint32_t bvxi_knot_after(const bvxi_oblique *o, uint32_t plane, uint32_t segment, double share);

#define BVXI_RASTER_STEP 2.0 /* cells */

/* oblique_raster.c */
bvx_status bvxi_oblique_raster(bvxi_oblique *o);
/* The signed distance on a plane with contours to a curve through their points. hint: as of
 * bvxi_plane_distance. */
double bvxi_oblique_curved(const bvxi_oblique *o, uint32_t plane, const double uv[2], uint32_t *hint);
/* Each row of the rasters of all planes. */
typedef void bvxi_row_fn(const bvxi_oblique *o, const bvxi_oblique_plane *plane, int32_t row);
bvx_status bvxi_oblique_rows(const bvxi_oblique *o, bvxi_row_fn *row);
/* What a raster of a plane has at a place's foot point. */
double bvxi_oblique_raster_at(const bvxi_oblique_plane *p, const float *raster, const double at[3]);

/* oblique_field.c: what the smooth number leaves of the distances, once it is made. */
bvx_status bvxi_oblique_rest(bvxi_oblique *o);
/* The number at a place: the smooth one, and what it leaves of near planes' distances. */
double bvxi_oblique_number(const bvxi_oblique *o, const double at[3]);
/* The same, when all planes that have a say there are among these; NULL: all. */
double bvxi_oblique_number_among(const bvxi_oblique *o, const double at[3], const uint32_t *plane,
                                 uint32_t count);
/* Where the lattice's vertex is; 1: on a plane that is very near, all of which are among these. */
int bvxi_oblique_place_among(const bvxi_oblique *o, const int32_t vertex[3], const uint32_t *plane,
                             uint32_t count, double at[3]);

/* ---- joint_fields.c: where the bodies of several labels are ---- */

enum {
    BVXI_JOINT_BODIES = 63, /* a bit each, and one for the outside */
    BVXI_JOINT_BEYOND = 3   /* the sign of vertices beyond the planes that all bodies end on */
};

/* The bodies' own numbers, then all contours on one set of planes. */
bvx_status bvxi_joint_open(bvxi_oblique *o, const int32_t *labels, uint32_t count);
/* 1: beyond a plane that all bodies end on; what lies on it, as plane says, is not. Planes that end all are
 * parallel, so that one plane is enough. */
int bvxi_joint_is_beyond(const bvxi_oblique *o, uint32_t plane, const double at[3]);
/* The kind at a place; plane: on which it lies, or BVXI_NONE; heard: the planes with a say there, NULL:
 * all. */
int bvxi_joint_kind(const bvxi_oblique *o, uint32_t plane, const double at[3], const uint32_t *heard,
                    uint32_t count);
/* The same of some kinds only. */
int bvxi_joint_kind_among(const bvxi_oblique *o, const double at[3], uint64_t kinds);
/* How much more a place is of some bodies than of other kinds. */
double bvxi_joint_lead(const bvxi_oblique *o, uint32_t plane, const double at[3], uint64_t bodies,
                       uint64_t others);

/* oblique_smooth.c: a thin plate through the planes' distances. */
bvx_status bvxi_oblique_smooth(bvxi_oblique *o);
double bvxi_smooth_at(const bvxi_smooth *g, const double at[3]);

/* oblique_lattice.c: the lattice's values wherever the surface may be. */
bvx_status bvxi_oblique_lattice(bvxi_oblique *o);

/* The value of a vertex, never 0, of several bodies its kind; the kind by the lattice that is made. */
float bvxi_oblique_vertex_value(const bvxi_oblique *o, const int32_t vertex[3]);
int bvxi_oblique_kind(const bvxi_oblique *o, const int32_t vertex[3]);
/* What a plane says of a point on it. */
int bvxi_oblique_kind_on(const bvxi_oblique *o, uint32_t plane, const double at[3]);
/* A point that a plane has in a cube; 0: none. */
int bvxi_oblique_in_cube(const bvxi_oblique_plane *p, const int32_t first[3], double side, double at[3]);
void bvxi_oblique_block_place(const bvxi_oblique *o, uint32_t block, int32_t first[3]);

/* The block of a vertex or cell, and its number in it. */
static inline uint64_t bvxi_oblique_block(const bvxi_oblique *o, const int32_t c[3], int *bit)
{
    *bit = (c[0] & 3) | (c[1] & 3) << 2 | (c[2] & 3) << 4;
    return ((uint64_t)(c[2] >> 2) * (uint64_t)o->blocks[1] + (uint64_t)(c[1] >> 2)) * (uint64_t)o->blocks[0] +
           (uint64_t)(c[0] >> 2);
}

/* A vertex or cell by its number in a block that begins at first. */
static inline void bvxi_oblique_in_block(const int32_t first[3], int bit, int32_t at[3])
{
    for (int k = 0; k < 3; k++) at[k] = first[k] + (bit >> 2 * k & 3);
}

/* The planes in a block or near its vertices and those behind it; plane: [BVXI_OBLIQUE_PLANES]. */
uint32_t bvxi_oblique_near_planes(const bvxi_oblique *o, const int32_t first[3], uint32_t *plane);

/* Those that have a say somewhere in that block. */
uint32_t bvxi_oblique_heard_planes(const bvxi_oblique *o, const int32_t first[3], uint32_t *plane);

extern const uint8_t bvxi_kuhn[6][4];
/* oblique_plain.c: the surface in cells that are not split comes first, with room for more triangles. */
bvx_status bvxi_oblique_plain(bvxi_oblique *o, uint64_t more);
/* The vertex on a lattice's edge, from a vertex of a known block along a way, or BVXI_NONE. */
uint32_t bvxi_oblique_plain_vertex(const bvxi_oblique *o, uint32_t known, int bit, int way);
/* Signs of known blocks' vertices become bits; cells of a block whose corners differ. */
bvx_status bvxi_oblique_take_signs(bvxi_oblique *o);
uint64_t bvxi_oblique_mixed(const bvxi_oblique *o, uint32_t known);
/* Edges that the surface crosses in a tetrahedron, by bits of its corners inside; their number. */
int bvxi_oblique_case(int inside, uint8_t edge[4][2]);
void bvxi_oblique_cross_edge(const double in[3], double rise, const double out[3], double fall, double at[3]);
/* Then once more, by the number at the place found. */
void bvxi_oblique_cross_again(const double in[3], double rise, const double out[3], double fall,
                              double middle, double at[3]);

/* oblique_cells.c: cells that planes and the surface share become tetrahedra, split by the planes. */
bvx_status bvxi_oblique_cells(bvxi_oblique *o);
bvx_status bvxi_oblique_split_planes(bvxi_oblique *o);
/* The number of a cell among those that are split, or BVXI_NONE. */
uint32_t bvxi_oblique_cell_at(const bvxi_oblique *o, const int32_t at[3]);

/* oblique_contours.c: contours become edges of the tetrahedra. */
bvx_status bvxi_oblique_contours(bvxi_oblique *o);

/* oblique_regions.c: signs on planes by their regions; *torn: vertices of which two planes say different
 * things. */
bvx_status bvxi_oblique_regions(bvxi_oblique *o, uint32_t **torn, uint64_t *torn_count);

/* oblique_signs.c */
bvx_status bvxi_oblique_signs(bvxi_oblique *o);
/* Edges and faces between contours' vertices that are no contour's get a vertex. */
bvx_status bvxi_oblique_part_contours(bvxi_oblique *o);
/* The middle of n vertices. */
void bvxi_oblique_middle(const bvxi_oblique *oblique, const uint32_t *v, int n, double at[3]);

/* oblique_handles.c: handles that no contour needs are filled or cut, and counted; *settled: how many, after
 * which the surface is to be made anew. owner: the tetrahedra of its triangles, from the first that is no
 * plain cell's. */
bvx_status bvxi_oblique_handles(bvxi_oblique *o, const uint32_t *owner, uint64_t *settled);

/* oblique_surface.c */
bvx_status bvxi_oblique_surface(bvxi_oblique *o, bvx_mesh *mesh);

/* ---- tetrahedra.c ---- */

bvx_status bvxi_tetra_add_vertex(bvxi_oblique *o, const double at[3], uint32_t *number);
bvx_status bvxi_tetra_add(bvxi_oblique *o, const uint32_t v[4], const uint32_t n[4], uint32_t chain_of,
                          uint32_t *number);
/* The tetrahedra round an edge of one of them, into o->ring; *closed: they go all the way round. */
bvx_status bvxi_tetra_ring(bvxi_oblique *o, uint32_t tetra, uint32_t a, uint32_t b, int *closed);
/* No tetrahedron has the stamp that o->stamps is after it. */
void bvxi_tetra_new_stamp(bvxi_oblique *o);
/* Those round a vertex, into o->star. */
bvx_status bvxi_tetra_star(bvxi_oblique *o, uint32_t vertex);
/* Put a new vertex m into the edge a b of a tetrahedron, and into all others round it. */
bvx_status bvxi_tetra_split_edge(bvxi_oblique *o, uint32_t tetra, uint32_t a, uint32_t b, const double at[3],
                                 uint32_t *m);
/* Put a new vertex into the face opposite a corner, of both tetrahedra there. */
bvx_status bvxi_tetra_split_face(bvxi_oblique *o, uint32_t tetra, int corner, const double at[3],
                                 uint32_t *m);
/* A tetrahedron with the edge, or BVXI_NONE; fills the star of a. */
bvx_status bvxi_tetra_with_edge(bvxi_oblique *o, uint32_t a, uint32_t b, uint32_t *tetra);

/* ---- oblique_look.c: by several threads at once ---- */

enum { BVXI_LOOK_MOST = 512, BVXI_LOOK_WORDS = 16 };

/* The tetrahedra round a vertex, and the vertices of those; hash tables of their indices. */
typedef struct bvxi_look {
    uint32_t *tetra, *vertex, *joined;
    int8_t *sign;
    uint32_t *seen, *key, *place; /* [4 * most] */
    uint32_t count, vertices, most;
} bvxi_look;

/* block: [BVXI_LOOK_WORDS * most] */
static inline bvxi_look bvxi_look_in(uint32_t *block, uint32_t most)
{
    bvxi_look const look = {.tetra = block,
                            .vertex = block + most,
                            .joined = block + 2 * (size_t)most,
                            .sign = (int8_t *)(block + 3 * (size_t)most),
                            .seen = block + 4 * (size_t)most,
                            .key = block + 8 * (size_t)most,
                            .place = block + 12 * (size_t)most,
                            .most = most};
    return look;
}

/* 0: there are too many. */
int bvxi_look_link(const bvxi_oblique *o, bvxi_look *look, uint32_t vertex);
/* Of the link that was looked at: whether a sign has several stretches in it; the Euler number of what is
 * inside, *any: there is some, *all: there is nothing else; whether no face of the star is a border. */
int bvxi_look_torn(const bvxi_oblique *o, bvxi_look *look, uint32_t vertex);
/* The stretches of outside, contours as part of it or of neither, and of inside in the link that was looked at. */
void bvxi_look_stretches(const bvxi_oblique *o, bvxi_look *look, uint32_t vertex, int contours,
                         uint32_t stretches[2]);
int64_t bvxi_look_euler(const bvxi_oblique *o, const bvxi_look *look, uint32_t vertex, int *any, int *all);
int bvxi_look_whole(const bvxi_oblique *o, const bvxi_look *look, uint32_t vertex);

static inline bvx_status bvxi_edge_add(const bvxi_oblique *o, bvxi_map *map, uint32_t a, uint32_t b,
                                       uint32_t **value)
{
    return bvxi_map_add(o->ctx, map, bvxi_edge_key(a, b), value);
}

static inline uint32_t bvxi_edge_find(const bvxi_map *map, uint32_t a, uint32_t b)
{
    return bvxi_map_find(map, bvxi_edge_key(a, b));
}

static inline uint64_t *bvxi_tetra_on(const bvxi_oblique *o, uint32_t vertex)
{
    return o->on + (uint64_t)vertex * o->plane_words;
}

static inline int bvxi_is_on(const bvxi_oblique *o, uint32_t vertex, uint32_t plane)
{
    return (int)(bvxi_tetra_on(o, vertex)[plane / 64] >> plane % 64 & 1);
}

static inline void bvxi_set_on(bvxi_oblique *o, uint32_t vertex, uint32_t plane)
{
    bvxi_tetra_on(o, vertex)[plane / 64] |= UINT64_C(1) << plane % 64;
}

/* 1: n vertices lie on one plane. */
static inline int bvxi_share_plane(const bvxi_oblique *o, const uint32_t *v, int n)
{
    for (uint32_t w = 0; w < o->plane_words; w++) {
        uint64_t on = UINT64_MAX;
        for (int i = 0; i < n; i++) on &= bvxi_tetra_on(o, v[i])[w];
        if (on != 0) return 1;
    }
    return 0;
}

/* The corners of the face opposite one. */
static inline void bvxi_tetra_face(const bvxi_tetra *t, int corner, uint32_t v[3])
{
    for (int k = 0, n = 0; k < 4; k++)
        if (k != corner) v[n++] = t->v[k];
}

/* How many corners lie on contours. */
static inline int bvxi_on_contours(const bvxi_oblique *o, const bvxi_tetra *t)
{
    int n = 0;
    for (int k = 0; k < 4; k++) n += o->vertex[t->v[k]].sign == 0;
    return n;
}

/* The first plane that a vertex lies on, or BVXI_NONE. */
static inline uint32_t bvxi_first_plane(const bvxi_oblique *o, uint32_t vertex)
{
    const uint64_t *const on = bvxi_tetra_on(o, vertex);
    for (uint32_t w = 0; w < o->plane_words; w++) {
        uint32_t p = 64 * w;
        if (on[w] == 0) continue;
        while (!bvxi_is_on(o, vertex, p)) p++;
        return p;
    }
    return BVXI_NONE;
}

static inline void bvxi_flip_sign(const bvxi_oblique *o, uint32_t vertex)
{
    o->vertex[vertex].sign = (int8_t)-o->vertex[vertex].sign;
    o->vertex[vertex].value = -o->vertex[vertex].value;
}

/* The corner of a tetrahedron that a vertex is; 4: none. */
static inline int bvxi_corner_of(const bvxi_tetra *t, uint32_t vertex)
{
    return t->v[0] == vertex ? 0 : t->v[1] == vertex ? 1 : t->v[2] == vertex ? 2 : t->v[3] == vertex ? 3 : 4;
}

/* 1: where the number is made. */
static inline int bvxi_oblique_is_near(const bvxi_oblique *o, const double at[3])
{
    for (int k = 0; k < 3; k++)
        if (at[k] < o->near_low[k] || at[k] > o->near_high[k]) return 0;
    return 1;
}

/* 0: too far from a plane's contours to lie within them. */
static inline int bvxi_oblique_in_bounds(const bvxi_oblique_plane *p, const double uv[2], double margin)
{
    return p->plane.contour_count != 0 && uv[0] >= p->low[0] - margin && uv[0] <= p->high[0] + margin &&
           uv[1] >= p->low[1] - margin && uv[1] <= p->high[1] + margin;
}

static inline double bvxi_oblique_height(const bvxi_oblique_plane *p, const double at[3])
{
    return ((p->normal[0] * at[0] + p->normal[1] * at[1]) + p->normal[2] * at[2]) - p->offset;
}

static inline void bvxi_oblique_uv(const bvxi_oblique_plane *p, const double at[3], double uv[2])
{
    for (int k = 0; k < 2; k++)
        uv[k] = (p->axis[k][0] * at[0] + p->axis[k][1] * at[1]) + p->axis[k][2] * at[2];
}

#endif
