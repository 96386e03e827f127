/* results.h - of the bitvox program: meshes, levels, grids, fields and trees as files and in words. */
#ifndef BVX_CLI_RESULTS_H
#define BVX_CLI_RESULTS_H

#include "cli_inputs/inputs.h"

/* ---- deliver.c: what a command has made; the one place that writes it and tells of it ---- */

typedef struct cli_voxels cli_voxels;

/* What a command has made. One of these goes to run->options.output: */
struct cli_made {
    cli_run *run;
    const bvx_grid *grid;
    const bvx_field *field;
    const bvx_mesh *mesh;
    cli_voxels *voxels;
    int (*write)(cli_run *run, void *work); /* or what this writes */
    int (*judge)(cli_run *run, void *work); /* once all is told: a failure where that is the answer */

    const bvx_grid *shown; /* its lattice is told where no grid is written; NULL: none */
    uint64_t set;          /* voxels of it, or values */
    int placed;            /* 0: nothing says where they lie */
    int untitled;          /* the text has the first line */
    cli_text head, text;   /* lines for people, before those of the lattice and after them */
    cli_text members;      /* of the JSON report, each with ", " before it */
};

/* Another line, or a part of one, for people; another warning. */
#define cli_tell(made, ...)   cli_text_add(&(made)->text, __VA_ARGS__)
#define cli_advise(made, ...) cli_keep_warning((made)->run, __VA_ARGS__)
/* Do what the command says, with run->work zeroed for it: make, write, keep, tell, report and warn, in this
 * order; or fail, and nothing is left. */
int cli_perform(cli_run *run);
/* What it was made with goes; the report has pointers to that. */
void cli_release(cli_run *run);
/* The voxels of a result that has no grid. */
void cli_note_voxels(cli_run *run, const bvx_lattice *lattice, uint64_t set);

/* ---- tree_output.c, tree_report.c: octrees ---- */

enum { CLI_TREE_LEVELS = 25 };

typedef struct cli_tree {
    bvx_octree *tree;
    bvx_lattice base;
    int32_t levels;
    bvx_octree_level level[CLI_TREE_LEVELS + 1];
    int kind;          /* of the output: CLI_MESH, CLI_GRID, or 0 for a tree */
    bvx_window window; /* of the last level */
    bvx_grid grid;     /* what is written of it: a level, a mesh */
    bvx_mesh surface;
    uint64_t triangles; /* of the mesh that was refined; 0: the tree was read */
    double seconds;     /* that it took */
} cli_tree;

/* Refuse outputs that octrees have no use for, and options that have none for the output; sets kind. */
int cli_check_tree_output(cli_run *run, cli_tree *t);
int cli_open_tree_output(cli_run *run, const cli_tree *t);
/* Take over an octree, also on failure: its levels are counted, its lattice is reported. */
int cli_take_tree(cli_run *run, bvx_octree *tree, cli_tree *t);
/* Write run->options.output and keep it. */
int cli_write_tree(cli_run *run, void *tree);
void cli_free_tree(cli_run *run, cli_tree *t);
void cli_tell_levels(const cli_run *run, const cli_tree *t, cli_made *made);
void cli_tell_tree_output(const cli_run *run, const cli_tree *t, cli_made *made);

/* ---- grid_output.c: a grid out, with its side-car where the format keeps no lattice ---- */

/* Open the outputs of a grid, write it as run->options.output and keep it. */
int cli_open_grid_output(cli_run *run, const char *path);
int cli_write_grid(cli_run *run, const bvx_grid *grid);
/* The same with labels by the nearest material or colour of a mesh. */
int cli_write_segments(cli_run *run, const bvx_grid *grid, const bvx_mesh *mesh);
/* The same of distances. */
int cli_write_field(cli_run *run, const bvx_field *field);
/* Write what a call of the library made as the output of this number, or say why it failed; frees it. */
int cli_write_buffer(cli_run *run, int number, bvx_status status, bvx_buffer *file, const char *path);
void cli_tell_grid(const cli_run *run, cli_text *text, const bvx_grid *grid, uint64_t set, int placed);
/* The place of a part (0: the low corner, 0.5: the centre) of a grid's first voxel. */
void cli_grid_corner(const bvx_grid *grid, double part, double corner[3]);

/* 1 when a voxel at a side of the window is set. */
int cli_touches_side(const bvx_grid *grid);

/* ---- mesh_output.c: meshes as files ---- */

/* 1 when a pattern has a %d, or %03d with so many digits; two of them. */
int cli_has_number(const char *pattern);
int cli_has_two_numbers(const char *pattern);
/* A pattern with its %d or %03d replaced, to be freed; NULL without memory. */
char *cli_numbered_path(const char *pattern, int64_t number);
/* Refuse %s and its like, which other programs take, and %d where a command writes one file: a file of that
 * name is not what was meant. */
int cli_check_pattern(cli_run *run);
/* Refuse a name without %d for several levels (count 0: several in any
 * case), but for one .glb, which may hold them. */
int cli_check_level_names(cli_run *run, int count);
/* Refuse --carry of a mesh that has nothing to carry. */
int cli_check_carry(cli_run *run, const bvx_mesh *mesh);
/* With --carry: the attributes of the input's nearest points, in a stage of this name. */
int cli_carry(cli_run *run, const bvx_mesh *input, bvx_mesh *mesh, const char *stage, const char *about);
/* What the meshes in files lack of the inputs' attributes, as a warning. */
void cli_tell_lost(const cli_run *run, cli_made *made);
/* Which axis was turned to which, where one was. */
void cli_tell_turn(const cli_run *run, cli_made *made);
/* Certify the mesh as the entry of this number in the report, of this file; the stage may name the number. */
int cli_check_mesh(cli_run *run, const bvx_mesh *mesh, int number, const char *path, const char *stage);
/* Write the mesh as the output of this number, which is open, but do not keep it: less --output-origin;
 * --normals adds the normals of vertices. Where the file holds other positions than the mesh, or joins them,
 * the certificate of the report's entry of this number, if there is one, becomes the file's; a mesh that the
 * format would spoil is refused. */
int cli_write_mesh_as(cli_run *run, const bvx_mesh *mesh, int number, const char *path);
/* The same as run->options.output, and keep it. */
int cli_write_mesh(cli_run *run, const bvx_mesh *mesh);

/* Open an output for each level; path receives their names, the first one for all where one file holds
 * them. */
int cli_open_levels(cli_run *run, int count, char **path);
/* Write all levels to these outputs and keep them. */
int cli_write_levels(cli_run *run, const bvx_mesh *levels, int count, char *const *path);

/* --triangles and --error of commands that make one mesh. */
typedef struct cli_reduction {
    int done;        /* fewer triangles were requested and made */
    uint64_t before; /* triangles */
    bvx_level_report level;
} cli_reduction;

/* The edges of a closed mesh collapse, where that is requested. */
int cli_reduce(cli_run *run, bvx_mesh *mesh, cli_reduction *r);
/* What became of it: a line of text, a member of the JSON report, a warning. */
void cli_tell_reduction(const cli_reduction *r, cli_made *made);

/* ---- level_tables.c: what is reported of levels ---- */

/* Random points that distances are measured from: --samples; and their seed. */
enum { CLI_SEED = 1 };
uint64_t cli_samples(const cli_run *run);
/* 1 when a mesh is closed, manifold and oriented. */
int cli_is_sound(const bvx_certificate *certificate);
/* Of a sound mesh: Euler's number is 2 a part, less 2 a handle. */
int64_t cli_count_handles(const bvx_certificate *certificate);
/* The line of the report's mesh number n. */
void cli_tell_mesh_of(const cli_run *run, int n, const char *title, cli_made *made);
/* The line of a mesh that is the result. */
void cli_tell_result(const bvx_certificate *c, cli_made *made);
/* The first line: the input's triangles, whether it is sound, its diagonal. */
void cli_tell_input(const cli_run *run, uint64_t triangles, const bvx_certificate *certificate,
                    double diagonal, cli_made *made);
/* The report's levels that edges collapsed to: triangles, targets, what they are and have from the input. */
void cli_tell_collapsed(const cli_run *run, int count, double diagonal, const bvx_certificate *input,
                        cli_made *made);
/* The distances of the report's meshes to the input; to says what that is
 * where it is no mesh, unit_of whose unit they have; decimals of percent. */
void cli_tell_distances(const cli_run *run, int count, double diagonal, int decimals, const char *to,
                        const char *unit_of, cli_made *made);
/* The files' names. */
void cli_tell_written(const cli_run *run, int count, cli_made *made);

/* ---- voxel_output.c: voxels as a grid or as the mesh of their surface ---- */

/* A round hole: its voxels, the axis that it runs along and a place on it. */
typedef struct cli_drill {
    const bvx_grid *hole; /* NULL: none */
    int32_t axis;
    double at[3], radius;
} cli_drill;

struct cli_voxels {
    const char *name; /* of the input */
    const bvx_grid *grid;
    const bvx_mesh *source;    /* what they were made from, or NULL; and then */
    const bvx_grid *solid;     /* its own voxels, on the grid's window */
    const bvx_field *field;    /* measured by cli_measure_source, or NULL */
    const bvx_mesh *labels_of; /* a mesh whose colours or materials become labels, or NULL */
    double offset;             /* of walls from the mesh, negative inside; 0: none moved */
    cli_drill drill;
    bvx_mesh mesh; /* made by cli_write_voxels; zeroed */
    cli_reduction reduction;
    bvx_field_surface_report surface;
};

/* Refuse names of neither, and options of meshes for a grid. */
int cli_check_voxel_name(cli_run *run);
int cli_open_voxels(cli_run *run);
/* Distances to a mesh as far as walls moved, with its voxels as the inside, which they borrow. */
bvx_status cli_measure_source(cli_run *run, const bvx_mesh *source, const bvx_grid *solid, double far,
                              bvx_field *field);
int cli_write_voxels(cli_run *run, cli_voxels *voxels);
/* Of a mesh: lines of text, a member of the JSON report. */
void cli_tell_voxels(const cli_run *run, const cli_voxels *v, cli_made *made);
void cli_free_voxels(cli_run *run, cli_voxels *v);

#endif
