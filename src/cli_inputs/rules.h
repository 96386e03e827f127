/* rules.h - of the bitvox program: which options are of no use beside what, as rows. */
#ifndef BVX_CLI_RULES_H
#define BVX_CLI_RULES_H

#include "cli_args/args.h"

/* What rows ask for. The first four are of the input and come from the command, which knows what it has; the
 * others follow from the options and the outputs' names. */
enum {
    CLI_OF_MESH = 1 << 0,
    CLI_OF_GRID = 1 << 1,
    CLI_OF_VOLUME = 1 << 2,
    CLI_OF_CLOUD = 1 << 3,
    CLI_FILLS_FLOOD = 1 << 4, /* --fill flood, and so on */
    CLI_FILLS_REGIONS = 1 << 5,
    CLI_FILLS_BELOW = 1 << 6,
    CLI_PADS = 1 << 7,          /* --padding above 0 */
    CLI_KEEPS_PARTS = 1 << 8,   /* some parts of voxels may go */
    CLI_TO_MESH = 1 << 9,       /* -o names a mesh's format */
    CLI_TO_GRID = 1 << 10,      /* a grid's */
    CLI_TO_STL = 1 << 11,       /* .stl */
    CLI_TO_NORMALS = 1 << 12,   /* a format with normals of vertices */
    CLI_TO_DISTANCES = 1 << 13, /* a format that holds numbers on voxels */
    CLI_TO_GLB = 1 << 14,       /* .glb */
    CLI_HAS_UP = 1 << 15,       /* an axis is up in the inputs */
    CLI_TO_UP = 1 << 16,        /* and in the output */
    CLI_FIRST_FACT = 17         /* the command's own begin at this bit */
};

/* A row refuses the line when all of its conditions hold. In the message %o is the option that was given,
 * %b the one beside it, %i the input, %f the output, %w the caller's word. */
typedef struct cli_rule {
    uint32_t when, unless; /* facts: all of these, none of those */
    const char *given;     /* one of these options, names with spaces between; NULL: whatever is given */
    const char *beside;    /* and one of these; NULL: whatever */
    const char *lacking;   /* and none of these */
    const char *message;   /* NULL: the row stands for a table or for the end */
    const struct cli_rule *also; /* the rows of this table; NULL: the end */
} cli_rule;

/* Set run->options->facts, once all options and names stand; CLI_HOLDS says whether one of them holds. */
void cli_find_facts(cli_run *run);
#define CLI_HOLDS(run, fact) (((run)->options->facts & (fact)) != 0)
/* Say what the first row that holds says; CLI_DONE where none does. */
int cli_check_rules(cli_run *run, const cli_rule *rules, uint32_t facts, const char *word);
/* The first of the names, with spaces between, that stands on the command line, or NULL. */
const char *cli_given_of(const cli_run *run, const char *names);

/* --resolution, --spacing, --origin, --padding; --fill and its options; --triangles and --error; --sharp;
 * what of a mesh its file shall hold. */
extern const cli_rule cli_lattice_rules[], cli_fill_rules[], cli_reduction_rules[], cli_sharp_rules[],
    cli_mesh_file_rules[];
/* The output is a mesh, or a grid, by its name. */
extern const cli_rule cli_to_mesh_rules[], cli_to_grid_rules[];
/* It is either: voxels, or the mesh of their surface, with the options of that. */
extern const cli_rule cli_to_voxels_rules[];
/* A grid is voxels already; the word names it. */
extern const cli_rule cli_grid_rules[];

#endif
