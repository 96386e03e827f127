/* option_table.c - the options of all commands: the parser, the help, the man page and the completion read
 * this table.
 *
 * An option that several commands take with the same meaning has one row; where the meaning differs it has
 * several. */
#include "cli_args/args.h"

#define FIELD(name)  offsetof(cli_options, name)
#define LARGEST_SIDE 33554432.0 /* 2^25, a lattice's limit */

/* NAME, VALUE as the help shows it, COMMANDS, FIELD of cli_options, what the kind needs, HELP */
#define FLAG(name, commands, field, help)                                       \
    {                                                                           \
        name, NULL, CLI_FLAG, commands, FIELD(field), 0, 0, 0, 0, NULL, 0, help \
    }
#define WHOLE(name, value, commands, field, low, high, help)                         \
    {                                                                                \
        name, value, CLI_INT, commands, FIELD(field), low, high, 0, 0, NULL, 0, help \
    }
#define WHOLE_OR(name, value, commands, field, low, high, names, base, help)             \
    {                                                                                    \
        name, value, CLI_INT, commands, FIELD(field), low, high, 0, 0, names, base, help \
    }
#define LONG(name, value, commands, field, low, high, help)                           \
    {                                                                                 \
        name, value, CLI_LONG, commands, FIELD(field), low, high, 0, 0, NULL, 0, help \
    }
#define BETWEEN(name, value, commands, field, low, high, help) /* both excluded */    \
    {                                                                                 \
        name, value, CLI_REAL, commands, FIELD(field), low, high, 0, 0, NULL, 0, help \
    }
#define FROM_TO(name, value, commands, field, low, high, help) /* both allowed */     \
    {                                                                                 \
        name, value, CLI_REAL, commands, FIELD(field), low, high, 1, 0, NULL, 0, help \
    }
#define TRIPLE(name, value, commands, field, help)                                 \
    {                                                                              \
        name, value, CLI_TRIPLE, commands, FIELD(field), 0, 0, 0, 0, NULL, 0, help \
    }
#define LIST(name, value, commands, field, low, high, least, most, help)                     \
    {                                                                                        \
        name, value, CLI_LIST, commands, FIELD(field), low, high, least, most, NULL, 0, help \
    }
#define BYTES(name, value, commands, field, help)                                    \
    {                                                                                \
        name, value, CLI_BYTES, commands, FIELD(field), 1, 1e18, 0, 0, NULL, 0, help \
    }
#define CHOICE(name, value, commands, field, names, base, help)                        \
    {                                                                                  \
        name, value, CLI_CHOICE, commands, FIELD(field), 0, 0, 0, 0, names, base, help \
    }
#define SIZE(name, value, commands, field, high, help)                              \
    {                                                                               \
        name, value, CLI_SIZE, commands, FIELD(field), 1, high, 2, 2, NULL, 0, help \
    }
#define NUMBER(name, value, commands, field, help)                                 \
    {                                                                              \
        name, value, CLI_NUMBER, commands, FIELD(field), 0, 0, 0, 0, NULL, 0, help \
    }
#define SET(name, value, commands, field, names, base, help)                        \
    {                                                                               \
        name, value, CLI_SET, commands, FIELD(field), 0, 0, 0, 0, names, base, help \
    }
#define FILE_NAME(name, value, commands, field, help)                            \
    {                                                                            \
        name, value, CLI_FILE, commands, FIELD(field), 0, 0, 0, 0, NULL, 0, help \
    }

#define ERRORS(name, value, commands, field, most, help)                              \
    {                                                                                 \
        name, value, CLI_ERRORS, commands, FIELD(field), 0, 0, 1, most, NULL, 0, help \
    }

#define TAKES_VOLUMES (CLI_VOXELIZE | CLI_LOD | CLI_FACES | CLI_RENDER | CLI_CONVERT)
#define MAKES_LEVELS  (CLI_LOD | CLI_SIMPLIFY)
#define VOXELS_OUT    (CLI_VOXELIZE | CLI_MORPH | CLI_FILL | CLI_COMPONENTS)
#define REDUCES       (CLI_REPAIR | CLI_BOOLEAN | CLI_SECTIONS | VOXELS_OUT)

#define WRITES_MESHES (REDUCES | MAKES_LEVELS | CLI_FACES | CLI_CONVERT | CLI_REFINE)

/* Names come from the header's lists, in the order of their numbers; "" cannot be requested, NULL ends. */
#define SIGN_OF_REPAIR(name, value, text)  (BVX_SIGNS_OF_REPAIR >> (value)&1) != 0 ? text : "",
#define FILL_OF_BOOLEAN(name, value, text) (BVX_FILLS_OF_BOOLEAN >> (value)&1) != 0 ? text : "",
#define THIN_OF_BOOLEAN(name, value, text) (value) == BVX_THIN_SHELL ? "" : text,
#define OPEN_INPUT(name, value, text)      (value) == BVX_OPEN_SHELL ? "refuse" : text,
#define FORMAT_ASKED_FOR(name, value, text) \
    [value] = (value) == BVX_FORMAT_PNG ? "" : (value) == BVX_FORMAT_SVG ? NULL : text,

static const char *const method_names[] = {BVX_LOD_LIST(CLI_NAME_OF) "collapse", NULL};
static const char *const error_names[] = {BVX_ERROR_LIST(CLI_NAME_OF) NULL};
static const char *const source_names[] = {BVX_LEVELS_LIST(CLI_NAME_OF) NULL};
const char *const cli_fill_names[] = {BVX_FILL_LIST(CLI_NAME_OF) NULL};
const char *const cli_mode_names[] = {"solid", BVX_SURFACE_LIST(CLI_NAME_OF) "field", NULL};
const char *const cli_sign_names[] = {BVX_SIGN_LIST(CLI_NAME_OF) NULL};
static const char *const repair_sign_names[] = {BVX_SIGN_LIST(SIGN_OF_REPAIR) NULL};
static const char *const boolean_fill_names[] = {BVX_FILL_LIST(FILL_OF_BOOLEAN) NULL};
static const char *const edge_names[] = {BVX_EDGE_LIST(CLI_NAME_OF) NULL};
static const char *const value_type_names[] = {BVX_REAL_LIST(CLI_NAME_OF) NULL};
static const char *const axis_names[] = {"x", "y", "z", NULL};
static const char *const state_names[] = {BVX_STATE_LIST(CLI_NAME_OF) NULL};
static const char *const connectivity_names[] = {"6", "18", "26", NULL};
const int32_t cli_neighbours[] = {6, 18, 26};
static const char *const side_names[] = {BVX_SIDE_LIST(CLI_NAME_OF) NULL};
static const char *const distance_names[] = {BVX_DISTANCE_LIST(CLI_NAME_OF) NULL};
static const char *const beyond_names[] = {BVX_BEYOND_LIST(CLI_NAME_OF) NULL};
static const char *const auto_names[] = {"auto", NULL};
static const char *const caps_names[] = {BVX_CAPS_LIST(CLI_NAME_OF) NULL};
static const char *const blend_names[] = {BVX_BLEND_LIST(CLI_NAME_OF) NULL};
static const char *const nesting_names[] = {BVX_NESTING_LIST(CLI_NAME_OF) NULL};
static const char *const crossings_names[] = {BVX_CROSSINGS_LIST(CLI_NAME_OF) NULL};
static const char *const progress_names[] = {"auto", "bar", "json", "none", NULL};
static const char *const check_thin_names[] = {"auto", "never", "always", NULL}; /* -1, 0, 1 */
static const char *const thin_names[] = {BVX_THIN_LIST(CLI_NAME_OF) NULL};
static const char *const boolean_thin_names[] = {BVX_THIN_LIST(THIN_OF_BOOLEAN) NULL};
const char *const cli_sample_names[] = {BVX_SAMPLE_LIST(CLI_NAME_OF) NULL};
/* By BVX_FORMAT_...; glb and vtu are only written, png and svg are not
 * requested. A gap ends the names before those of contours. */
static const char *const every_format[] = {BVX_FORMAT_LIST(FORMAT_ASKED_FOR)};
#define FORMAT_NAMES         (every_format + BVX_FORMAT_STL)
#define CONTOUR_FORMAT_NAMES (every_format + BVX_FORMAT_CSL)

/* Of lod and then of simplify. */
static const char *const open_names[] = {BVX_OPEN_LIST(CLI_NAME_OF) NULL};
static const char *const open_input_names[] = {BVX_OPEN_LIST(OPEN_INPUT) NULL};

static const cli_argument arguments[] = {
    FILE_NAME(
        "-o", "FILE",
        CLI_VOXELIZE | CLI_LOD | CLI_RENDER | CLI_CONVERT | CLI_FACES | CLI_REFINE | CLI_FILL | CLI_SECTIONS |
            CLI_SLICE | CLI_REPAIR | CLI_BOOLEAN | CLI_MORPH | CLI_COMPONENTS | CLI_SIMPLIFY,
        output,
        "where the result goes; its ending gives the format, with .gz after it\nthe file is packed; - is standard output, with --format"),
    FILE_NAME(
        "--output-dir", "DIR", CLI_REPAIR | CLI_SIMPLIFY | CLI_CONVERT | CLI_VOXELIZE, output_dir,
        "in place of -o: a folder, for any number of inputs; each goes to a\nfile of its name there, in --format [its own; voxelize: bvx]"),
    LIST("--resolution", "N", CLI_LOD, resolution, 1, LARGEST_SIDE, 1, 1,
         "voxels along the longest axis: the mesh's surface is measured with so\n"
         "many, or a solid is made of them for --levels [collapse: as the finest\n"
         "level needs; else 8 x the finest level, less where memory is short]"),
    LIST("--resolution", "N|X,Y,Z", CLI_VOXELIZE | CLI_FACES | CLI_MORPH, resolution, 1, LARGEST_SIDE, 1, 3,
         "voxels along the longest axis, or along each axis [256]"),
    LIST("--resolution", "N", CLI_BOOLEAN, resolution, 1, 16777216.0, 1, 1,
         "voxels along the longest axis of both meshes together [256]"),
    BETWEEN("--spacing", "S", CLI_VOXELIZE | CLI_FACES | CLI_BOOLEAN | CLI_MORPH, spacing, 0, 1e300,
            "edge of a voxel in the mesh's unit, in place of --resolution"),
    TRIPLE("--origin", "X,Y,Z", CLI_VOXELIZE | CLI_FACES | CLI_MORPH, origin,
           "low corner of voxel 0,0,0, with --spacing [the mesh's low corner]"),
    LIST("--window", "A,B,C,D,E,F", CLI_VOXELIZE, window, 0, LARGEST_SIDE, 6, 6,
         "only voxels A..D-1, B..E-1, C..F-1 of the lattice"),
    LIST("--window", "A,B,C,D,E,F", CLI_CONVERT, window, 0, LARGEST_SIDE, 6, 6,
         "only voxels A..D-1, B..E-1, C..F-1 of a grid's file, or of the last\nlevel of an octree"),
    LIST("--window", "A,B,C,D,E,F", CLI_REFINE, window, 0, LARGEST_SIDE, 6, 6,
         "halve voxels to the last level only in A..D-1, B..E-1, C..F-1 of it"),
    WHOLE("--padding", "N", CLI_VOXELIZE, padding, 0, 65536,
          "empty voxels added on every side [0; --mode field: the half-width]"),
    WHOLE("--padding", "N", CLI_LOD | CLI_FACES, padding, 0, 65536, "empty voxels added on every side [0]"),
    WHOLE("--padding", "N", CLI_MORPH, padding, 0, 65536,
          "empty voxels added on every side [0; dilate: what it reaches]"),
    LIST("--triangles", "A,B,C", CLI_LOD, triangles, 1, 4294967295.0, 1, CLI_MAX_LEVELS,
         "most triangles of each level"),
    LIST("--triangles", "A,B,C", CLI_SIMPLIFY, triangles, 1, 4294967295.0, 1, CLI_MAX_LEVELS,
         "most triangles, of each level where there are several [half]"),
    ERRORS(
        "--error", "A,B,C", MAKES_LEVELS, errors, CLI_MAX_LEVELS,
        "largest distance of each level to the mesh, in its unit, or with % in\npercent of its diagonal: 0.05%,0.2%"),
    CHOICE("--error-kind", "KIND", MAKES_LEVELS, error_kind, error_names, BVX_ERROR_MEAN,
           "of --error: the mean of both ways, or max, the largest one [mean]"),
    WHOLE("--count", "N", CLI_LOD, count, 1, CLI_MAX_LEVELS,
          "levels of 1/2, 1/4, 1/8 ... of the triangles [4, or as many as leave\n20 triangles]"),
    WHOLE("--count", "N", CLI_SIMPLIFY, count, 1, CLI_MAX_LEVELS,
          "levels of 1/2, 1/4, 1/8 ... of the triangles [1]"),
    FLAG("--strict", MAKES_LEVELS, strict,
         "a level that cannot keep its target is an error: nothing is written"),
    FROM_TO("--even", "W", MAKES_LEVELS, even, 0, 1,
            "pull to triangles of even size where the surface is flat [1e-9]"),
    FROM_TO(
        "--colour-weight", "W", MAKES_LEVELS, colour_weight, 0, 1,
        "with --carry: borders between colours stay where they are; a difference of\n255 costs as much as a distance of W of the mesh's longest side; 0.02 to 0.1\n"
        "keep borders well [0]"),
    CHOICE(
        "--source", "WHAT", CLI_LOD, source, source_names, BVX_LEVELS_AUTO,
        "what levels are made from. mesh: the mesh itself, which must be closed,\nmanifold and oriented; measured: its surface, measured as repair does;\n"
        "auto: the mesh where it is that and does not cross itself [auto; measured with\n--resolution, --sign, --least-part, --least-cavity, --outer-hull]"),
    CHOICE(
        "--open", "WHAT", CLI_LOD, open, open_names, BVX_OPEN_SHELL,
        "what becomes of open sheets. shell: thin closed shells; keep: they stay\nopen, with their borders, and what joins three triangles at an edge is\n"
        "measured; cut: as keep, but cut along such edges [shell]"),
    CHOICE(
        "--open", "WHAT", CLI_SIMPLIFY, open, open_input_names, BVX_OPEN_SHELL,
        "what becomes of open sheets. keep: they stay open, with their borders;\ncut: as keep, but cut along edges of three triangles and more;\n"
        "refuse: they are an error [keep]"),
    FLAG("--sharp", CLI_LOD, sharp, "of the measured surface: put vertices on sharp edges and corners"),
    FLAG("--no-sharp", CLI_LOD, no_sharp,
         "do not put vertices there [where many of the mesh's edges are sharp]"),
    FLAG("--outer-hull", CLI_LOD, outer_hull, "inner shells and cavities go"),
    CHOICE(
        "--method", "NAME", CLI_LOD, method, method_names, BVX_LOD_EDGE_RATIO,
        "collapse: edges of the mesh collapse; edge-ratio, coverage: samples of a\nsolid [collapse; edge-ratio for grids, volumes, and with --levels,\n"
        "--threshold, --edge-samples, --collapse, --fill, --close-gaps, --padding]"),
    LIST("--levels", "A,B,C", CLI_LOD, levels, 1, LARGEST_SIDE, 1, CLI_MAX_LEVELS,
         "edge-ratio, coverage: samples along the longest axis of each level\n[64,32,16]"),
    BETWEEN("--threshold", "T", CLI_LOD, threshold, 0, 1, "a sample above it is inside, 0 < T < 1 [0.5]"),
    WHOLE("--edge-samples", "N", CLI_LOD, edge_samples, 1, 65536,
          "steps along an edge, with --method edge-ratio [the ratio, rounded up]"),
    FROM_TO("--collapse", "F", CLI_LOD, collapse, 1, 64,
            "edge-ratio, coverage with --triangles: make up to F times as many, then\n"
            "collapse the cheapest edges; 2 to 4 comes much nearer to the mesh [off]"),
    CHOICE("--mode", "MODE", CLI_VOXELIZE, mode, cli_mode_names, CLI_MODE_SOLID,
           "solid: what lies inside; conservative: all voxels that the surface\n"
           "touches; thin: those that keep a flood through faces out; sampled:\n"
           "those of points less than a voxel apart; field: distances from the\n"
           "voxels' centres to the surface, negative inside [solid]"),
    FROM_TO(
        "--half-width", "W", CLI_VOXELIZE, half_width, 0, 1e9,
        "with --mode field: how far from the surface centres have a distance,\nin voxels; 0: all have one [3]"),
    CHOICE(
        "--sign", "RULE", CLI_VOXELIZE, sign, cli_sign_names, BVX_SIGN_AUTO,
        "with --mode field, what is inside. exact: as --fill parity; winding:\nholes and overlaps; vote: holes and flipped triangles; pseudonormal,\n"
        "normal: the side of the closest place or triangle; none; auto: as\n--fill auto [auto]"),
    FLAG("--vectors", CLI_VOXELIZE, vectors,
         "with --mode field: vectors to the closest points, not distances"),
    CHOICE("--value-type", "TYPE", CLI_VOXELIZE, value_type, value_type_names, BVX_F32,
           "with --mode field: f32 or f64 [f32]"),
    CHOICE(
        "--fill", "RULE", CLI_VOXELIZE | CLI_LOD | CLI_RENDER | CLI_FACES | CLI_MORPH, fill, cli_fill_names,
        BVX_FILL_PARITY,
        "auto: parity where closed shells do not cross, nonzero where they do,\nwinding where there are holes, flipped triangles turned before;\n"
        "parity: nested shells are cavities; nonzero: overlapping and\ninverted shells are one solid; vote: what rows along three axes agree\n"
        "on, else all directions, whichever way triangles face; flood: what a\nflood from outside cannot reach, cavities included; regions: what the\n"
        "surface parts is inside or outside as a whole; below: all under a terrain;\n"
        "winding: more than half a turn, for holes in overlapping parts [auto]"),
    WHOLE("--close-gaps", "N", CLI_VOXELIZE, close_gaps, 0, 65535,
          "with --fill flood, or --body: gaps of up to N voxels hold the flood [0]"),
    WHOLE("--close-gaps", "N", CLI_LOD | CLI_RENDER | CLI_FACES | CLI_MORPH, close_gaps, 0, 65535,
          "with --fill flood: gaps of up to N voxels hold the flood [0]"),
    CHOICE(
        "--fill", "RULE", CLI_BOOLEAN, fill, boolean_fill_names, BVX_FILL_PARITY,
        "what is inside a mesh. auto: what suits it; parity: nested shells are\ncavities; nonzero: overlapping and inverted shells are one solid; vote,\n"
        "winding: for meshes with holes [auto]"),
    FLAG("--resample", CLI_BOOLEAN, resample,
         "bring a grid of another lattice to that of A, by its values at the\nvoxels' centres"),
    WHOLE("--minimum", "N", CLI_VOXELIZE, minimum, 1, 2147483647.0,
          "of a cloud: points that a voxel needs to be set [1]"),
    FLAG("--body", CLI_VOXELIZE, body, "of a cloud: set what a flood from outside cannot reach too"),
    FLAG("--add-shell", CLI_VOXELIZE | CLI_FILL, add_shell, "set all voxels of the surface too"),
    FLAG("--check-edges", CLI_VOXELIZE, check_edges,
         "count edges with one triangle, and those between flipped ones"),
    CHOICE(
        "--check-thin", "WHEN", CLI_VOXELIZE, check_thin, check_thin_names, -1,
        "look for walls too thin for the voxels, for a warning with their place.\nauto: in whole lattices; always; never [auto]"),
    FLAG("--compare-fills", CLI_VOXELIZE, compare_fills,
         "a table of what each rule would set, and where they differ"),
    NUMBER("--base", "H", CLI_VOXELIZE, base,
           "with --fill below: the height that columns stand on [the lattice's\nlow end]"),
    FILE_NAME("--second", "MESH", CLI_VOXELIZE, second,
              "with --fill below: what lies between IN and this terrain; reports cut\nand fill"),
    CHOICE("--up", "AXIS", CLI_VOXELIZE, up_axis, axis_names, 1, "with --fill below: x, y or z [z]"),
    NUMBER("--level", "V", TAKES_VOLUMES, level,
           "of a volume: set voxels whose sample is V or more (--below: or less)"),
    {"--range", "A,B", CLI_PAIR, TAKES_VOLUMES, FIELD(range), 0, 0, 0, 0, NULL, 0,
     "of a volume: set voxels whose sample lies from A to B; one end may be\nleft out"},
    LONG("--label", "N", TAKES_VOLUMES, value_label, 0, 9007199254740992.0,
         "of a label map: set the voxels of value N"),
    FLAG("--all-labels", CLI_VOXELIZE, all_labels,
         "of a label map: a mesh for each value but 0, to OUT_%d.EXT"),
    FLAG("--below", TAKES_VOLUMES, below, "with --level: what lies below it is inside"),
    LIST("--shape", "X,Y,Z", TAKES_VOLUMES | CLI_INFO, shape, 1, LARGEST_SIDE, 3, 3,
         "samples along each axis of a .raw file, x fastest"),
    CHOICE("--sample-type", "TYPE", TAKES_VOLUMES | CLI_INFO, sample_type, cli_sample_names, BVX_SAMPLE_U8,
           "of a .raw file: u8, i8, u16, i16, u32, i32, u64, i64, f32 or f64"),
    FLAG("--big-endian", TAKES_VOLUMES | CLI_INFO, big_endian,
         "the samples of a .raw file have their highest byte first"),
    LONG("--skip", "BYTES", TAKES_VOLUMES | CLI_INFO, skip, 0, 9007199254740992.0,
         "bytes before the samples of a .raw file [0]"),
    TRIPLE("--voxel-size", "X,Y,Z", TAKES_VOLUMES | CLI_INFO, voxel_size,
           "sides of a voxel of a .raw file [1,1,1]"),
    FLAG("--merge", CLI_FACES, merge, "faces of one plane become few rectangles"),
    LIST(
        "--resolution", "N", CLI_REFINE, resolution, 1, LARGEST_SIDE, 1, 1,
        "voxels of the last level along the longest axis, at least, in place\nof --base [--base x 2^--halvings]"),
    WHOLE("--base", "N", CLI_REFINE, base_voxels, 1, LARGEST_SIDE,
          "voxels along the longest axis before any is halved [8]"),
    WHOLE_OR(
        "--halvings", "L|auto", CLI_REFINE, depth, 0, 25, auto_names, -1,
        "how many times voxels are halved [6]; auto: with --resolution, as it\ntakes least time by an estimate [auto with --resolution]"),
    WHOLE("--outer-levels", "L", CLI_REFINE, outer_levels, 0, 25,
          "with --window: how many times beyond it [0]"),
    BETWEEN("--adaptive", "T", CLI_REFINE, adaptive, 0, 1e300,
            "a voxel whose triangles lie within T of one plane is not halved,\nin the mesh's unit [off]"),
    SET("--states", "A,B", CLI_REFINE | CLI_CONVERT | CLI_RENDER, states, state_names, BVX_STATE_OUTSIDE,
        "which voxels of an octree: surface, inside, outside [surface,inside]"),
    FLAG("--leaves", CLI_REFINE, leaves, "a mesh of boxes, one a leaf, in colours of their levels"),
    {"--cut", "AXIS=VALUE", CLI_CUT, CLI_REFINE, FIELD(cut), 0, 0, 0, 0, NULL, 0,
     "with --leaves: only those below a plane, once for each axis"},
    WHOLE(
        "--expand", "L", CLI_REFINE | CLI_CONVERT | CLI_RENDER, expand, 0, 25,
        "the level of an octree that a grid is made of [the last]; with it\na .bvx file is written as a grid, not as an octree"),
    SIZE("--grid", "NxM", CLI_SECTIONS, size, 8192,
         "cells over the sections [auto: sides of twice the mean length of the\ncontours' segments]"),
    BETWEEN("--spacing", "S", CLI_SECTIONS, spacing, 0, 1e300,
            "side of a cell in the contours' unit, in place of --grid"),
    WHOLE("--cells", "N", CLI_SECTIONS, cells, 8, 1024,
          "planes that are not parallel: cells along the longest side of the\ncontours' box [auto: 64]"),
    FROM_TO(
        "--agree", "D", CLI_SECTIONS, agree, 0, 1e300,
        "planes that are not parallel: contours at most so far apart where two\nplanes cross are moved to agree [a hundredth of that longest side]"),
    FROM_TO(
        "--close-gap", "G", CLI_SECTIONS, close_gap, 0, 1e300,
        "of .csv: loops whose ends lie further apart than G are refused as open\npolylines; 0 closes all of them by a straight side [0]"),
    WHOLE("--layers", "N", CLI_SECTIONS, layers, 1, 64, "layers of cells from section to section [1]"),
    CHOICE("--blend", "HOW", CLI_SECTIONS, blend, blend_names, BVX_BLEND_LINEAR,
           "from section to section: linear, or cubic over four of them, smooth\nacross sections [linear]"),
    CHOICE(
        "--caps", "HOW", CLI_SECTIONS, caps, caps_names, BVX_CAPS_FLAT,
        "the ends: flat on the first and last section; taper: each part to a\nridge half a spacing beyond, also those that end in between; open [flat]"),
    CHOICE(
        "--nesting", "HOW", CLI_SECTIONS, nesting, nesting_names, BVX_NESTING_LEVELS,
        "loops in loops between two sections: levels, outlines and holes each\nfor themselves, so that walls have no windows; whole, both at\nonce [levels]"),
    FLAG(
        "--mend", CLI_SECTIONS, mend,
        "split loops where they touch or cross, in place of refusing them; inside\nstays what an odd number of loops enclose"),
    CHOICE(
        "--crossings", "HOW", CLI_SECTIONS, crossings, crossings_names, BVX_CROSSINGS_EXACT,
        "on the sections' planes: exact, by the contours themselves; paper, by\ninterpolated distances with the contours' points put in; classic,\nmarching cubes [exact]"),
    FLAG("--crossings", CLI_INFO, count_crossings,
         "also count the pairs of triangles that cross or touch beyond what they\nshare; of meshes"),
    WHOLE("--subdivide", "N", CLI_SECTIONS, subdivide, 0, 8,
          "halve cells that a contour crosses twice on a side, N times at most [5]"),
    WHOLE("--label", "L", CLI_SECTIONS, label, -2147483647.0, 2147483647.0,
          "the body, where the file holds several"),
    FILE_NAME("--block-model", "CSV", CLI_SECTIONS, block_model,
              "also write blocks: centre, sides and the share that is inside"),
    TRIPLE("--block", "X,Y,Z", CLI_SECTIONS, block, "sides of a block, with --block-model"),
    CHOICE("--axis", "AXIS", CLI_SLICE, up_axis, axis_names, 1, "planes lie across x, y or z [z]"),
    BETWEEN("--spacing", "S", CLI_SLICE, spacing, 0, 1e300,
            "from plane to plane; the first lies half of it above the low end"),
    LIST("--resolution", "N", CLI_REPAIR, resolution, 1, 16777216.0, 1, 1,
         "voxels along the longest axis [256]"),
    LIST("--triangles", "N", REDUCES, triangles, 1, 4294967295.0, 1, 1,
         "of a mesh: edges of the result collapse to so many triangles or fewer\n[all are kept]"),
    ERRORS(
        "--error", "E", REDUCES, errors, 1,
        "of a mesh: edges of the result collapse until it would lie further than\nE from what it was, in its unit or with % in percent of its diagonal"),
    CHOICE("--error-kind", "KIND", REDUCES, error_kind, error_names, BVX_ERROR_MEAN,
           "of --error: the mean of both ways, or max, the largest one [mean]"),
    CHOICE(
        "--sign", "RULE", CLI_REPAIR | CLI_LOD, sign, repair_sign_names, BVX_SIGN_AUTO,
        "winding: holes and overlaps; vote: holes and flipped triangles;\nexact: nested shells are cavities; auto: winding, flipped triangles\nturned before, or vote where they cannot be oriented [auto]"),
    CHOICE(
        "--interpolation", "HOW", CLI_REPAIR | CLI_BOOLEAN, interpolation, edge_names, BVX_EDGE_VECTOR,
        "tangent: from the planes at the closest points; vector: from the line\nthrough them; scalar: from the signed distance; middle; paper: vector\nwith the paper's clamps [tangent]"),
    FLAG("--sharp", CLI_REPAIR | CLI_BOOLEAN | CLI_VOXELIZE | CLI_MORPH, sharp,
         "of a mesh: put vertices on sharp edges and corners"),
    FLAG("--no-sharp", CLI_REPAIR | CLI_BOOLEAN | CLI_VOXELIZE | CLI_MORPH, no_sharp,
         "do not put vertices there [where many of a mesh's edges are sharp]"),
    CHOICE(
        "--thin", "WHAT", CLI_REPAIR, thin, thin_names, BVX_THIN_SHELL,
        "walls of bodies too thin for the voxels. keep: whole, about as thick as\nthey are; shell: pieces without a voxel become shells, other walls are\nlost where no centre lies in them, with a warning; drop: lost [keep]"),
    CHOICE(
        "--thin", "WHAT", CLI_BOOLEAN, thin, boolean_thin_names, BVX_THIN_SHELL,
        "walls of the meshes too thin for the voxels. keep: whole, about as thick\nas they are; drop: lost where no centre lies in them, with a warning [keep]"),
    FROM_TO("--shell", "T", CLI_REPAIR | CLI_LOD, shell, 0, 1e6,
            "thickness of shells in voxels, from 1.5; 0: none are made [2]"),
    LONG(
        "--least-part", "N", CLI_REPAIR | CLI_LOD | CLI_BOOLEAN, least_part, 0, 1e15,
        "parts of fewer voxels are dropped, 0: none is [crumbs: small, nowhere three\nvoxels thick, where the mesh has no part of its own]"),
    LONG("--least-cavity", "N", CLI_REPAIR | CLI_LOD, least_cavity, 0, 1e15,
         "cavities of fewer voxels are filled [0]"),
    FLAG("--if-needed", CLI_REPAIR, if_needed, "copy a mesh that needs nothing, its positions as they are"),
    FLAG("--measure", CLI_REPAIR, measure, "report distances between input and result, and overlaps"),
    FLAG("--normals", CLI_CONVERT | CLI_REPAIR | MAKES_LEVELS, normals,
         "of a mesh: also write smooth normals of its vertices to .ply and .obj,\n"
         "averaged by area over sharp edges too; .glb always has them"),
    TRIPLE(
        "--output-origin", "X,Y,Z", WRITES_MESHES, output_origin,
        "of a mesh: taken from the positions in the file, as .stl and other\n32-bit floats need it far from the origin [0,0,0]"),
    FLAG("--carry", CLI_REPAIR, carry,
         "give the result the colours and texture coordinates of the nearest\npoints on the input"),
    FLAG("--carry", MAKES_LEVELS, carry,
         "give each level the colours and texture coordinates of the nearest\npoints on the mesh"),
    LONG("--samples", "N", MAKES_LEVELS | CLI_COMPARE, samples, 0, 2147483647,
         "points on each mesh for the distances, 0: none [20000]"),
    LIST(
        "--seed", "X,Y,Z", CLI_FILL, seeds, 0, LARGEST_SIDE, 3, 63,
        "empty voxels to fill from, counted from the grid's first one, three\nnumbers each [one in every pocket]"),
    FILE_NAME("--mesh", "MESH", CLI_FILL, mesh,
              "the mesh that the surface came from: pockets outside of it stay empty"),
    LIST(
        "--seed", "X,Y,Z", CLI_COMPONENTS, seeds, 0, LARGEST_SIDE, 3, 63,
        "keep parts that hold one of these voxels, counted from the grid's\nfirst one, three numbers each [all]"),
    LONG(
        "--keep-largest", "N", TAKES_VOLUMES, keep_largest, 1, 1e15,
        "of voxels, of a volume's or a grid's (voxelize: also those it makes):\nkeep so many of the largest parts, through faces [all]"),
    LONG("--least-part", "N", TAKES_VOLUMES & ~CLI_LOD, least_part, 0, 1e15,
         "likewise: drop parts of fewer voxels [0]"),
    LONG("--keep-largest", "N", CLI_COMPONENTS, keep_largest, 1, 1e15,
         "keep so many of the largest parts, of those that other rules leave [all]"),
    LONG("--at-least", "N", CLI_COMPONENTS, at_least, 0, 1e15, "keep parts of so many voxels or more [0]"),
    FLAG("--fill-cavities", CLI_COMPONENTS, fill_cavities,
         "fill the empty parts that are closed in through faces"),
    FILE_NAME("--labels", "FILE", CLI_COMPONENTS, labels, "also write the parts' numbers: .npy, u32"),
    CHOICE("--connectivity", "N", CLI_FILL | CLI_COMPONENTS, connectivity, connectivity_names, 0,
           "6: through faces; 18: and edges; 26: and corners [6]"),
    CHOICE("--neighbourhood", "N", CLI_MORPH, neighbourhood, connectivity_names, 0,
           "6: voxels across faces; 18: and edges; 26: and corners [6]"),
    WHOLE("--steps", "N", CLI_MORPH, steps, 1, 65536, "how many times the neighbourhood is applied [1]"),
    FROM_TO("--radius", "R", CLI_MORPH, radius, 0, 1e300,
            "a ball in place of the neighbourhood, in the lattice's unit"),
    FROM_TO("--thickness", "T", CLI_MORPH, thickness, 0, 1e300,
            "hollow: of the shell, in the lattice's unit"),
    FROM_TO("--drain", "R", CLI_MORPH, drain, 0, 1e300,
            "hollow: radius of a round hole through the shell [none]"),
    CHOICE("--drain-side", "SIDE", CLI_MORPH, drain_side, side_names, 0,
           "where the hole comes from: x-low, x-high, y-low, y-high, z-low or\nz-high [z-low]"),
    CHOICE(
        "--side", "NAME", CLI_MORPH, side, distance_names, BVX_DISTANCE_OUTSIDE,
        "distance. outside: of each centre to the nearest set one; inside: to\nthe nearest empty one; signed: the first less the second [outside]"),
    CHOICE(
        "--beyond", "WHAT", CLI_MORPH, beyond, beyond_names, 0,
        "what lies beyond the grid: empty or set voxels; distance: or nothing\n[empty; distance: nothing]"),
    CHOICE("--value-type", "TYPE", CLI_MORPH, value_type, value_type_names, BVX_F32,
           "distance: f32 or f64 [f32]"),
    LONG("--seed", "N", CLI_COMPARE, seed, 0, 4294967295.0, "another seed, other points [1]"),
    SIZE("--size", "WxH", CLI_RENDER, size, 16384,
         "pixels of a picture [1024x768; 640x480 each for several meshes]"),
    TRIPLE("--from", "X,Y,Z", CLI_RENDER, from, "direction from the model to the eye [3,-4,2]"),
    TRIPLE("--up", "X,Y,Z", CLI_RENDER, up, "what is up in the picture [0,0,1]"),
    WHOLE("--voxels", "N", CLI_RENDER, voxels, 1, LARGEST_SIDE,
          "draw the voxels of a mesh's solid, N along its longest axis\n[256 with --compare]"),
    FLAG("--smooth", CLI_RENDER, smooth, "smooth shading; sharp edges stay sharp"),
    FLAG("--wireframe", CLI_RENDER, wireframe, "draw the edges of triangles or voxels too"),
    {"--cut", "AXIS=VALUE", CLI_CUT, CLI_RENDER, FIELD(cut), 0, 0, 0, 0, NULL, 0,
     "take away what lies between a plane and the eye, in the model's unit;\nonce for each axis, or x=0.5,z=1"},
    {"--slices", "AXIS:N", CLI_SLICES, CLI_RENDER, FIELD(slices), 1, 1024, 0, 0, NULL, 0,
     "a sheet of N slices of the voxels across an axis, like z:16"},
    FLAG("--compare", CLI_RENDER, difference,
         "two inputs in one picture: what the second adds green, what it lacks red"),
    WHOLE("--turntable", "N", CLI_RENDER, turntable, 2, 360,
          "N pictures once around the axis of --up, to OUT_%d.png"),
    CHOICE("--format", "NAME", CLI_SECTIONS, format, CONTOUR_FORMAT_NAMES, BVX_FORMAT_CSL,
           "format of standard input, with - as input: csl or csv"),
    CHOICE(
        "--format", "NAME", CLI_ALL & ~CLI_SECTIONS, format, FORMAT_NAMES, BVX_FORMAT_STL,
        "format of standard input and output, with - as input or after -o,\nor of files in --output-dir: stl, obj, ply ...\n[output: ply, bvx, nrrd for distances, csv, png]"),
    WHOLE("--threads", "N", CLI_ALL, general.threads, 0, 1024, "workers, 0: all there are [0]"),
    BYTES("--memory-limit", "BYTES", CLI_ALL, general.memory_limit,
          "most memory for data; K, M and G are understood [what there is;\nfiles: half of it]"),
    FLAG("--json", CLI_ALL, general.json, "a report for programs on standard output, in place of the text"),
    CHOICE("--progress", "HOW", CLI_ALL, general.progress, progress_names, CLI_BAR_AUTO,
           "auto: a bar on a terminal; bar; json: lines of JSON on standard error;\nnone [auto]"),
    FLAG("--quiet", CLI_ALL, general.quiet, "no text, no bar, no warnings"),
    FLAG("--help", CLI_ALL, general.help, "this text"),
};

#define ARGUMENTS (sizeof arguments / sizeof arguments[0])

typedef char arguments_fit[ARGUMENTS <= CLI_MAX_OPTIONS ? 1 : -1]; /* into cli_run.given */

const cli_argument *cli_argument_at(int i)
{
    return i >= 0 && (size_t)i < ARGUMENTS ? &arguments[i] : NULL;
}
