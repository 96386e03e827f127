/* repair.h - one mesh on its way to a closed one: what the steps of bvx_repair know of it and pass on. Files
 * of pipeline/ only include this. Not installed. */
#ifndef BVXI_REPAIR_H
#define BVXI_REPAIR_H

#include "mesh/topology.h"
#include "pipeline/steps.h"
#include "pipeline/thicken.h"
#include "winding/holes.h"

/* What warnings need to know beside the report. */
typedef struct bvxi_repair_facts {
    bvxi_rim longest_rim;
    uint64_t sheet_edges; /* crossings of the result far from the input's surface: on lids over holes */
    uint64_t bodies;      /* of closed parts, those that cross as one; 0: no more than the result has parts */
    uint64_t overlaps;    /* voxels in more than one turn of the surface, where sizes changed */
    uint64_t thin_shelled; /* of shelled_triangles, those of components with a volume but few voxels */
    double shelled_area;   /* of shelled_triangles [Units: world^2] */
    double parts_volume;   /* sum of the components' volumes; 0: open, or sides are unknown [Units: world] */
    int32_t thin_low[3], thin_high[3]; /* the box of thin_voxels, inclusive [Units: voxels] */
    int32_t
        handles; /* of the input, turned, with a lid in each hole; -1: copied, not manifold, or no sides */
} bvxi_repair_facts;

typedef struct bvxi_repair_job {
    bvx_context *ctx;
    const bvx_repair_options *options;
    const bvx_mesh_view *given;
    /* of given, welded and without collapsed triangles, where the caller has it, or NULL */
    const bvx_certificate *known;
    bvx_mesh_view mesh;   /* given, without triangles that are there twice */
    bvx_mesh_view body;   /* of these, those that enclose something */
    bvx_mesh_view sheets; /* and those that do not, which become shells */
    uint32_t *corner;     /* mesh's [Size: given->triangle_count * 3], or NULL: mesh is given */
    uint32_t *parted;     /* body's, then sheets', or NULL: body is mesh [Size: mesh.triangle_count * 3] */
    /* of each vertex: the least one that it hangs together with, or NULL [Size: given->vertex_count] */
    uint32_t *piece;
    bvxi_patches patches; /* of mesh, where edges were looked at; until its pieces are known */
    bvx_lattice lattice;
    int32_t resolution;  /* that it was fitted by, where none was given */
    bvx_grid solid;      /* what body encloses */
    bvx_grid inside;     /* the result: solid and shells, less small parts and cavities */
    uint64_t grid_bytes; /* of the words of each */
    bvxi_thin thin;
    bvxi_holes holes;      /* of mesh, then of body, on the lattice, as the sign sees them */
    bvxi_winding *winding; /* while sheets are looked for, and the surface made: for lids over holes */
    int32_t fill;          /* BVX_FILL_... that the sign stands for */
    bvx_repair_report report;
    bvxi_repair_facts facts;
} bvxi_repair_job;

extern const char bvxi_repair_name[];

/* repair.c: bvx_repair for a caller that has checked the mesh, as in bvxi_repair_job; facts are filled where
 * options have a report. */
bvx_status bvxi_repair_known(bvx_context *ctx, const bvx_mesh_view *mesh, const bvx_certificate *known,
                             const bvx_repair_options *options, bvxi_repair_facts *facts, bvx_mesh *repaired);

/* repair_input.c: what the mesh is, its sign, its triangles once each, its pieces. */
bvx_status bvxi_repair_take(bvxi_repair_job *job);
/* A view of triangles that are listed, over the given mesh's vertices. */
void bvxi_repair_view(const bvxi_repair_job *job, const uint32_t *corner, uint64_t count,
                      bvx_mesh_view *view);

/* repair_input.c: the lattice of a resolution, or the one that was given. */
bvx_status bvxi_repair_lattice(bvxi_repair_job *job, int32_t resolution);

/* repair_inside.c: solid and inside on job->lattice. */
bvx_status bvxi_repair_inside(bvxi_repair_job *job);

/* repair_sheets.c: of the triangles of job->mesh that are ASKED, those that job->body encloses become
 * ENCLOSED. Only for fill rules with winding numbers. job->holes are those of job->mesh. Scratch: as
 * bvxi_winding_open, and the body's holes. */
enum { BVXI_TRIANGLE_ASKED = 1, BVXI_TRIANGLE_ENCLOSED = 2 };

/* repair_sheets.c: part mesh into body and sheets by what job->solid, the
 * solid of all of it, keeps of each piece. */
bvx_status bvxi_repair_part(bvxi_repair_job *job);
/* Put to inside what lies within half the shell's thickness of the sheets. */
bvx_status bvxi_repair_lay_shells(bvxi_repair_job *job);

/* repair_thin.c: find walls of the body too thin for the lattice, and put centres to inside until they
 * hold. */
bvx_status bvxi_repair_thicken(bvxi_repair_job *job);

/* small_parts.c: drop small parts of inside and fill small cavities; count all. */
bvx_status bvxi_repair_clean(bvxi_repair_job *job);

/* repair_surface.c: the surface of inside. */
bvx_status bvxi_repair_surface(bvxi_repair_job *job, bvx_mesh *repaired);

/* repair_needs.c: why the mesh needs a repair; a copy of one that needs none. */
bvx_status bvxi_repair_needs(bvxi_repair_job *job);
/* What a certificate says of it, BVX_NEEDS_.... */
bvx_status bvxi_repair_copy(bvxi_repair_job *job, bvx_mesh *copy);

/* piece_volumes.c: a piece of a mesh, six times its volume and its box around the middle of the mesh. */
typedef struct bvxi_mesh_piece {
    double volume6, low[3], high[3];
    uint64_t triangles, mark;
    uint64_t turned; /* 1: bvxi_mark_inside_out found it so */
} bvxi_mesh_piece;

/* What tells triangles of one piece: its lowest vertex or its lowest triangle. */
typedef struct bvxi_piece_marks {
    const uint32_t *piece; /* of each vertex, as bvxi_pieces says */
    const uint32_t *part;  /* of each triangle, as bvxi_patches_open says, in place of piece; or NULL */
} bvxi_piece_marks;

uint32_t bvxi_piece_mark(const bvx_mesh_view *mesh, const bvxi_piece_marks *by, uint64_t t);

/* All pieces with triangles, in the order of their marks; of: the mesh's box. Scratch: 80 bytes a piece, until
 * they are dropped, and 4 a vertex, or a triangle where parts mark them. */
bvx_status bvxi_mesh_pieces_open(bvx_context *ctx, const bvx_mesh_view *mesh, const bvxi_piece_marks *by,
                                 const bvx_certificate *of, bvxi_mesh_piece **pieces, uint64_t *count);
/* The volumes of all, each as positive: of closed pieces no solid has more. */
double bvxi_mesh_pieces_volume(const bvxi_mesh_piece *pieces, uint64_t count);
/* 1: each piece that faces inward has the box of one that faces outward around it. */
int bvxi_cavities_lie_within(const bvxi_mesh_piece *pieces, uint64_t count);
/* Mark bodies that face inward though they are nobody's cavities by their boxes, and what lies in them;
 * returns how many pieces. Of more than 4,096 none. */
uint64_t bvxi_mark_inside_out(bvxi_mesh_piece *pieces, uint64_t count);
/* The whole lattice filled by two rules. Scratch: two grids of the lattice, the words that come out. */
bvx_status bvxi_fill_twice(bvx_context *ctx, const bvx_mesh_view *mesh, const bvx_lattice *lattice,
                           const int32_t rule[2], uint64_t *words[2]);

/* repair_report.c: what the report says beyond what the steps have counted. */
bvx_status bvxi_repair_measure(bvxi_repair_job *job, const bvx_mesh *repaired);
/* Warn of what a report says; resolution: at which it was made. collapsed: triangles of the level that stands for
 * the result, or 0. */
void bvxi_repair_warn(bvx_context *ctx, bvx_repair_report *report, const bvxi_repair_facts *facts,
                      int32_t resolution, uint64_t collapsed);
/* 1: volume and area of the mesh are those of its body. */
int bvxi_has_own_size(const bvx_repair_report *report, const bvxi_repair_facts *facts);

#endif
