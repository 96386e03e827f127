/* commands.h - of the bitvox program: the commands, and what several of them share. */
#ifndef BVX_CLI_COMMANDS_H
#define BVX_CLI_COMMANDS_H

#include "cli_results/results.h"

extern const cli_command cli_info, cli_voxelize, cli_lod, cli_render, cli_convert, cli_compare, cli_faces,
    cli_refine, cli_fill, cli_sections, cli_slice, cli_repair, cli_boolean, cli_morph, cli_components,
    cli_simplify, cli_labels, cli_hull, cli_check;

/* command_list.c: all of them, NULL after the last. */
enum { CLI_COMMANDS = 19 };
extern const cli_command *const cli_commands[CLI_COMMANDS + 1];

/* cmd_compare.c: bvx_grid_compare with a message that names both. */
int cli_compare_grids(cli_run *run, const cli_input *a, const cli_input *b, bvx_grid_difference *difference);
/* cmd_repair.c: the numbers of a repair as a member of the JSON report. */
void cli_report_repair(cli_text *members, const bvx_repair_report *repair, int measured);
/* ---- solids.c: the rules that fill a mesh ---- */

/* The mesh of an input becomes its solid, on this lattice, or on that of the options in a stage of its own.
 */
int cli_fill_on(cli_run *run, const bvx_lattice *lattice, cli_input *in);
int cli_fill_input(cli_run *run, cli_input *in);

/* --fill and its options; second and the report are the caller's. */
void cli_take_fill(const cli_run *run, bvx_voxelize_options *v);
/* The rule that filled, and why, as a line. */
void cli_tell_fill(cli_text *text, const bvx_solid_report *report);
/* Where thin walls lie, in the mesh's unit: low and high corner. */
void cli_json_losses(cli_text *text, const bvx_lattice *lattice, const bvx_solid_report *report);
/* The solid as a member of the JSON report; that and lines. */
void cli_report_solid(const cli_run *run, cli_text *members, const bvx_lattice *lattice,
                      const bvx_solid_report *report);
void cli_tell_solid(const cli_run *run, const bvx_grid *grid, const bvx_solid_report *report, cli_made *made);

/* ---- cmd_voxelize.c ---- */

/* What the command takes for itself; zero stands for "not given". */
typedef struct cli_voxelize_options {
    bvx_voxelize_options solid;
    bvx_points_options cloud;
    bvx_field_options field;
    int32_t mode;       /* CLI_MODE_... */
    const char *second; /* the other terrain's file */
    int32_t segments;
} cli_voxelize_options;

/* ---- voxelize_volume.c ---- */

/* voxelize of a volume: to a grid, or by the output's ending to a mesh. */
extern const cli_job cli_voxelize_volume;

/* ---- section_info.c, volume_info.c: what info says ---- */

/* Read contours and tell what they are. */
int cli_tell_sections(cli_run *run, const char *path, cli_made *made);
/* The ends of a box and its sides, a line an axis. */
void cli_tell_box(cli_made *made, const double low[3], const double high[3]);
/* The type, range and histogram of a volume's samples, where they are more than bits. */
int cli_tell_samples(cli_run *run, const char *path, cli_made *made);

/* ---- command_checks.c ---- */

/* What holds for all commands once the words are taken. */
int cli_check_line(cli_run *run);
/* What options contradict each other or the names of inputs and output. */
int cli_check_options(cli_run *run);

/* ---- batch.c: --output-dir, and info of several files ---- */

/* Run the command on each input. */
int cli_run_batch(cli_run *run);

/* ---- standard_output.c: -o - ---- */

/* run->options.output becomes a name that stands for standard output; refuses a terminal. */
int cli_take_standard_output(cli_run *run);

#endif
