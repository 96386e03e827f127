/* inputs.h - of the bitvox program: inputs by their names, and the lattices that fit them. */
#ifndef BVX_CLI_INPUTS_H
#define BVX_CLI_INPUTS_H

#include "cli_inputs/rules.h"

/* ---- named_formats.c: formats by the names of files ---- */

enum { CLI_MESH = 1, CLI_GRID = 2, CLI_TREE = 3 };

/* CLI_MESH, CLI_GRID or 0, of any BVX_FORMAT_... that is written. */
int cli_kind_of_format(int32_t format);
/* The same of an input: .gltf is read only. */
int cli_kind_of_input(int32_t format);
const char *cli_format_name(int32_t format);
int cli_needs_sidecar(int32_t format);    /* it keeps no lattice */
char *cli_sidecar_name(const char *path); /* to be freed; NULL without memory */
/* The axis of all inputs, of the output: by options, else by formats. */
int32_t cli_input_up(const cli_run *run);
int32_t cli_output_up(const cli_run *run);
/* How the mesh is turned on its way out, BVX_TURN_... */
int32_t cli_turn_of(const cli_run *run);
/* The format of an input by --format or its name, BVX_FORMAT_... */
int32_t cli_input_format(const cli_run *run, const char *path);
/* What an input would be by its name; refuses what is not read. */
int cli_input_kind(cli_run *run, const char *path, int *kind);
/* What makes a file of this name one that is read, or one of it, as the end of a message; "" where nothing is known. */
const char *cli_way_around(const char *path, int written);
/* 1 for formats that hold samples. */
int cli_may_be_volume(int32_t format);
/* How many options choose voxels of a volume by their samples; they exclude each other. */
int cli_selects(const cli_run *run);
/* 1 when the samples of an input are needed, and not what is other than 0. */
int cli_is_volume(const cli_run *run, const char *path);
/* 1 for .csl and .csv. */
int cli_is_contours(const cli_run *run, const char *path);
/* How messages call an input. */
const char *cli_input_name(const char *path);
const char *cli_first_name(const cli_run *run); /* of the first of all */
/* Refuse a lattice that the format of a grid's file cannot hold. */
int cli_check_grid_format(cli_run *run, const char *path, const bvx_lattice *lattice);

/* ---- files.c: whole files in ---- */

typedef struct cli_bytes {
    unsigned char *bytes;
    size_t size, room;
    uint64_t limit; /* of room */
} cli_bytes;

/* Read a file, gzip data unpacked; "-" is standard input. */
int cli_read_file(cli_run *run, const char *path, cli_bytes *bytes);
/* The same within a stage of the caller's, where so many bytes of other
 * files are held already and count against the same limit. */
int cli_read_bytes(cli_run *run, const char *path, uint64_t held, cli_bytes *bytes);
/* Read a file that is to be parsed; creates run->context when there is none. */
int cli_open_input(cli_run *run, const char *path, cli_bytes *bytes);
/* The stage of parsing so many bytes of files ends. */
void cli_end_parse(cli_run *run, uint64_t bytes);
/* CLI_HAS_... of a mesh. */
uint32_t cli_attributes_of(const bvx_mesh *mesh);
/* Read a mesh from a file; creates run->context when there is none. */
int cli_read_mesh(cli_run *run, const char *path, bvx_mesh *mesh);
/* The same, or a cloud of points: .xyz, or .ply without faces. */
int cli_read_mesh_or_cloud(cli_run *run, const char *path, bvx_mesh *mesh, int *cloud);
/* A mesh as calls of the library take it. */
static inline bvx_mesh_view cli_view(const bvx_mesh *mesh)
{
    bvx_mesh_view view;
    bvx_mesh_view_of(mesh, &view);
    return view;
}

/* ---- sidecars.c: FILE.npy.json ---- */

/* The side-car of a file without a lattice, where there is one; grid is all of the file or a part of it. */
int cli_read_sidecar(cli_run *run, const char *path, bvx_grid *grid, int *placed);

/* ---- inputs.c: any input by its ending ---- */

typedef struct cli_input {
    const char *path;
    int kind; /* CLI_MESH, CLI_GRID, or CLI_TREE where that is requested */
    bvx_mesh mesh;
    bvx_grid grid;
    bvx_octree *tree;
    int placed;        /* 0: neither file nor side-car tells a grid's lattice */
    bvx_buffer labels; /* of a .vox with colours, for 'faces' to .glb; else empty */
    uint8_t palette[1024];
} cli_input;

/* Read a grid, or a window of it (NULL or all zero: all), and its side-car; creates run->context when there
 * is none. An octree becomes the grid of its last level, or that of --expand. */
int cli_read_grid(cli_run *run, const char *path, const bvx_window *window, bvx_grid *grid, int *placed);
/* The same, but an octree stays what it is. */
int cli_read_grid_or_tree(cli_run *run, const char *path, const bvx_window *window, cli_input *input);
int cli_read_input(cli_run *run, const char *path, cli_input *input); /* a mesh or a grid */
void cli_free_input(cli_run *run, cli_input *input);
/* Refuse --expand beyond the last level. */
int cli_check_tree_level(cli_run *run, int32_t levels);
/* The last level, or that of --expand, as a grid, or a window of it (all
 * zero: all); path is named in messages. */
int cli_expand_tree(cli_run *run, const bvx_octree *tree, const bvx_window *finest, const char *path,
                    bvx_grid *grid);
/* Read contours; creates run->context when there is none. */
int cli_read_sections(cli_run *run, const char *path, bvx_sections *sections);

/* inflate.c: a bvx_inflate_fn by zlib; without zlib it unpacks nothing. */
int32_t cli_inflate(void *user, const void *packed, uint64_t packed_size, void *plain, uint64_t plain_size);

/* ---- volume_input.c: scalar volumes, and the voxels that are chosen of them ---- */

typedef struct cli_volume {
    cli_bytes file, data; /* samples may stand in either */
    bvx_volume volume;
    bvx_volume_view view; /* the window of it that is wanted */
    int placed;           /* 0: neither file nor side-car gives its lattice */
} cli_volume;

/* Refuse options of volumes where no input is one: nothing would come of them. */
int cli_check_volume_options(cli_run *run);
/* Refuse options that contradict each other. */
int cli_check_selection(cli_run *run, const char *path);
/* Read a volume, or a window of it (NULL or all zero: all); creates run->context when there is none. */
int cli_read_volume(cli_run *run, const char *path, const bvx_window *window, cli_volume *volume);
/* The same of a file whose bytes are in volume->file already; all else in it is zeroed. */
int cli_take_volume(cli_run *run, const char *path, const bvx_window *window, cli_volume *volume);
void cli_free_volume(cli_run *run, cli_volume *volume);
/* Of BVX_SAMPLE_... */
int64_t cli_sample_bytes(int32_t type);
/* Bytes from sample to sample along each axis, also where the view says by zeros that they are packed. */
void cli_volume_strides(const bvx_volume_view *view, int64_t stride[3]);
/* The voxels of --level, --range or --label; without any those whose sample is not 0. */
bvx_status cli_select_voxels(cli_run *run, const cli_volume *volume, bvx_volume_report *report,
                             bvx_grid *grid);
/* What was found in it: a member of the JSON report, a warning. */
void cli_tell_volume(cli_run *run, const cli_volume *volume, const bvx_volume_report *report,
                     cli_text *members);

/* ---- kept_parts.c: --keep-largest and --least-part of voxels ---- */

/* Parts of fewer voxels may go (CLI_KEEPS_PARTS); 0: none for this. */
uint64_t cli_least_part(const cli_run *run);
/* So many of the largest parts stay (CLI_KEEPS_PARTS); 0: all. */
uint64_t cli_keep_largest(const cli_run *run);
/* Refuse these options for meshes of commands that read grids. */
int cli_check_parts(cli_run *run);
/* Keep the parts requested, of a grid in itself or in another one, and count them for the report. */
bvx_status cli_keep_parts(cli_run *run, const bvx_grid *grid, bvx_grid *kept);
void cli_tell_parts(const cli_run *run, cli_text *text);

/* ---- mesh_lattice.c: where voxels of a mesh lie ---- */

typedef struct cli_box {
    double low[3], high[3];
} cli_box;

/* The box of the vertices that a mesh's triangles use; one that holds two. */
void cli_mesh_box(const bvx_mesh *mesh, cli_box *box);
void cli_join_boxes(cli_box *box, const cli_box *other);
/* For qsort. */
int cli_compare_doubles(const void *a, const void *b);
/* The box of points; from infinity to minus infinity where there is none. */
void cli_box_of_points(const void *positions, int32_t type, uint64_t count, cli_box *box);
/* The points that a lattice around a box goes around. */
bvx_mesh_view cli_corners_of_box(const cli_box *box);
/* A lattice by the options, around a mesh or points. */
bvx_status cli_make_lattice(cli_run *run, const bvx_mesh_view *view, bvx_lattice *lattice);
/* --window; all zero when it is not given. */
int cli_window_option(cli_run *run, bvx_window *window);
/* The diagonal of a box, wherever doubles hold it. */
double cli_diagonal(const double low[3], const double high[3]);

/* Refuse a large lattice that is large because of a point far from most others; warn where it leaves these a few voxels. */
int cli_check_far(cli_run *run, const char *path, const bvx_mesh_view *view, const bvx_lattice *lattice);

#endif
