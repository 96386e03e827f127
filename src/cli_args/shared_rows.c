/* shared_rows.c - the options that several commands take with the same meaning, each in one row; what one
 * command takes for itself stands in the command's file. The parser, the help, the man page and the
 * completion read these rows. */
#include "cli_args/rows.h"

/* Names come from the header's lists, in the order of their numbers; "" cannot be requested, NULL ends. */
#define FILL_OF_SOLID(name, value, text)    (BVX_FILLS_OF_SOLID >> (value)&1) != 0 ? text : "",
#define FILL_OF_FIELD(name, value, text)    (BVX_FILLS_OF_FIELD >> (value)&1) != 0 ? text : "",
#define FILL_OF_REPAIR(name, value, text)   (BVX_FILLS_OF_REPAIR >> (value)&1) != 0 ? text : "",
#define FORMAT_ASKED_FOR(name, value, text) [value] = (value) == BVX_FORMAT_PNG ? "" : text,

static const char *const error_names[] = {BVX_ERROR_LIST(CLI_NAME_OF) NULL};
static const char *const topology_names[] = {BVX_TOPOLOGY_LIST(CLI_NAME_OF) NULL};
const char *const cli_fill_names[] = {BVX_FILL_LIST(CLI_NAME_OF) NULL};
const char *const cli_mode_names[] = {"solid", BVX_SURFACE_LIST(CLI_NAME_OF) "field", NULL};
const char *const cli_sign_names[] = {BVX_FILL_LIST(FILL_OF_FIELD) NULL};
static const char *const solid_fill_names[] = {BVX_FILL_LIST(FILL_OF_SOLID) NULL};
static const char *const repair_sign_names[] = {BVX_FILL_LIST(FILL_OF_REPAIR) NULL};
static const char *const edge_names[] = {BVX_EDGE_LIST(CLI_NAME_OF) NULL};
const char *const cli_value_type_names[] = {BVX_REAL_LIST(CLI_NAME_OF) NULL};
const char *const cli_axis_names[] = {"x", "y", "z", NULL};
static const char *const up_names[] = {"y", "z", NULL};
static const char *const state_names[] = {BVX_STATE_LIST(CLI_NAME_OF) NULL};
const char *const cli_connectivity_names[] = {"6", "18", "26", NULL};
static const char *const progress_names[] = {"auto", "bar", "json", "none", NULL};
const char *const cli_sample_names[] = {BVX_SAMPLE_LIST(CLI_NAME_OF) NULL};
const int32_t cli_neighbours[] = {6, 18, 26};

/* By BVX_FORMAT_...; vtu is only written; glb stands for gltf too. A gap ends the names before contours'. */
const char *const cli_format_names[] = {BVX_FORMAT_LIST(FORMAT_ASKED_FOR)};
#define FORMAT_NAMES (cli_format_names + BVX_FORMAT_STL)

const cli_argument cli_takes_output[] = {
    FILE_NAME("-o", "FILE", SHARED(output),
              "where the result goes; its ending gives the format, with .gz after it\n"
              "the file is packed; - is standard output, with --format"),
    {0}};

const cli_argument cli_takes_output_dir[] = {
    FILE_NAME("--output-dir", "DIR", SHARED(output_dir),
              "in place of -o: a folder, for any number of inputs; each goes to a\n"
              "file of its name there, levels to NAME_0, NAME_1 ..., in --format [its\n"
              "own; voxelize: bvx; lod of grids: ply]"),
    {0}};

const cli_argument cli_takes_spacing[] = {
    BETWEEN("--spacing", "S", SHARED(spacing), 0, 1e300,
            "edge of a voxel in the mesh's unit, in place of --resolution"),
    {0}};

const cli_argument cli_takes_lattice[] = {
    LIST("--resolution", "N|X,Y,Z", SHARED(resolution), 1, LARGEST_SIDE, 1, 3,
         "voxels along the longest axis, or along each axis [256]"),
    {.also = cli_takes_spacing},
    TRIPLE("--origin", "X,Y,Z", SHARED(origin),
           "low corner of voxel 0,0,0, with --spacing [the mesh's low corner]"),
    {0}};

const cli_argument cli_takes_padding[] = {
    WHOLE("--padding", "N", SHARED(padding), 0, 65536, "empty voxels added on every side [0]"), {0}};

const cli_argument cli_takes_fill[] = {
    CHOICE("--fill", "RULE", SHARED(fill), solid_fill_names, BVX_FILL_AUTO,
           "auto: parity where closed shells do not cross, nonzero where they do,\n"
           "winding where there are holes, flipped triangles turned before;\n"
           "parity: nested shells are cavities; nonzero: overlapping and\n"
           "inverted shells are one solid; vote: what rows along three axes agree\n"
           "on, else all directions, whichever way triangles face; flood: what a\n"
           "flood from outside cannot reach, cavities included; regions: what the\n"
           "surface separates is inside or outside as a whole; below: all under a terrain;\n"
           "winding: more than half a turn, for holes in overlapping parts [auto]"),
    {0}};

const cli_argument cli_takes_fill_of_solids[] = {
    {.also = cli_takes_fill},
    WHOLE("--close-gaps", "N", SHARED(close_gaps), 0, 65535,
          "with --fill flood: gaps of up to N voxels hold the flood [0]"),
    {0}};

const cli_argument cli_takes_add_shell[] = {
    FLAG("--add-shell", SHARED(add_shell), "set all voxels of the surface too"), {0}};

const cli_argument cli_takes_selection[] = {
    NUMBER("--level", "V", SHARED(level),
           "of a volume: set voxels whose sample is V or more (--below: or less)"),
    PAIR("--range", "A,B", SHARED(range),
         "of a volume: set voxels whose sample lies from A to B; one end may be\n"
         "left out"),
    LONG("--label", "N", SHARED(value_label), 0, 9223372036854774784.0,
         "of a label map: set the voxels of value N"),
    {0}};

const cli_argument cli_takes_below[] = {
    FLAG("--below", SHARED(below), "with --level: what lies below it is inside"), {0}};

const cli_argument cli_takes_raw[] = {
    LIST("--shape", "X,Y,Z", SHARED(shape), 1, LARGEST_SIDE, 3, 3,
         "samples along each axis of a .raw file, x fastest"),
    CHOICE("--sample-type", "TYPE", SHARED(sample_type), cli_sample_names, BVX_SAMPLE_U8,
           "of a .raw file: u8, i8, u16, i16, u32, i32, u64, i64, f32 or f64"),
    FLAG("--big-endian", SHARED(big_endian), "the samples of a .raw file have their highest byte first"),
    LONG("--skip", "BYTES", SHARED(skip), 0, 9007199254740992.0,
         "bytes before the samples of a .raw file [0]"),
    TRIPLE("--voxel-size", "X,Y,Z", SHARED(voxel_size), "sides of a voxel of a .raw file [1,1,1]"),
    {0}};

const cli_argument cli_takes_volumes[] = {
    {.also = cli_takes_selection}, {.also = cli_takes_below}, {.also = cli_takes_raw}, {0}};

const cli_argument cli_takes_states[] = {
    SET("--states", "A,B", SHARED(states), state_names, BVX_STATE_OUTSIDE,
        "which voxels of an octree: surface, inside, outside [surface,inside]"),
    {0}};

const cli_argument cli_takes_expand[] = {
    WHOLE("--expand", "L", SHARED(expand), 0, 25,
          "the level of an octree that a grid is made of [the last]; with it\n"
          "a .bvx file is written as a grid, not as an octree"),
    {0}};

const cli_argument cli_takes_trees[] = {{.also = cli_takes_states}, {.also = cli_takes_expand}, {0}};

const cli_argument cli_takes_keep_largest[] = {
    LONG("--keep-largest", "N", SHARED(keep_largest), 1, 1e15,
         "keep so many of the largest parts, voxels joined through faces: of a grid or\n"
         "volume, or of what the command makes of a mesh [all]"),
    {0}};

const cli_argument cli_takes_kept_parts[] = {
    {.also = cli_takes_keep_largest},
    LONG("--least-part", "N", SHARED(least_part), 0, 1e15, "likewise: drop parts of fewer voxels [0]"),
    {0}};

const cli_argument cli_takes_errors[] = {
    ERRORS("--error", "A,B,C", SHARED(errors), CLI_MAX_LEVELS,
           "largest distance of each level to the mesh, in its unit, or with % in\n"
           "percent of its diagonal: 0.05%,0.2%"),
    CHOICE("--error-kind", "KIND", SHARED(error_kind), error_names, BVX_ERROR_MEAN,
           "of --error: the mean of both ways, or max, the largest one [mean]"),
    {0}};

const cli_argument cli_takes_collapse[] = {
    FLAG("--strict", SHARED(strict), "a level that cannot keep its target is an error: nothing is written"),
    FROM_TO("--even", "W", SHARED(even), 0, 1,
            "pull to triangles of even size where the surface is flat [1e-9]"),
    FROM_TO("--attributes", "W", SHARED(attributes), 0, 1000,
            "weight of texture coordinates, normals and colours beside the shape;\n"
            "0: they follow it and cost nothing [1]"),
    FLAG("--lock-border", SHARED(lock_border), "vertices on borders stay where they are, so that tiles join"),
    FLAG("--keep-vertices", SHARED(keep_vertices), "levels use vertices of the mesh and make none"),
    CHOICE("--topology", "HOW", SHARED(topology), topology_names, BVX_TOPOLOGY_KEEP,
           "simplify: handles are cut and holes filled that are small beside the\n"
           "triangles of a level, the smallest first; keep: none [keep]"),
    {0}};

const cli_argument cli_takes_reduction[] = {
    LIST("--triangles", "N", SHARED(triangles), 1, 4294967295.0, 1, 1,
         "of a mesh: edges of the result collapse to so many triangles or fewer\n"
         "[all are kept]"),
    ERRORS("--error", "E", SHARED(errors), 1,
           "of a mesh: edges of the result collapse until it would lie further than\n"
           "E from what it was, in its unit or with % in percent of its diagonal"),
    CHOICE("--error-kind", "KIND", SHARED(error_kind), error_names, BVX_ERROR_MEAN,
           "of --error: the mean of both ways, or max, the largest one [mean]"),
    {0}};

const cli_argument cli_takes_sharp[] = {
    FLAG("--sharp", SHARED(sharp), "of a mesh: put vertices on sharp edges and corners"),
    FLAG("--no-sharp", SHARED(no_sharp),
         "do not put vertices there [where many of a mesh's edges are sharp]"),
    {0}};

const cli_argument cli_takes_interpolation[] = {
    CHOICE("--interpolation", "HOW", SHARED(interpolation), edge_names, BVX_EDGE_TANGENT,
           "tangent: from the planes at the closest points; vector: from the line\n"
           "through them; scalar: from the signed distance; middle; paper: vector\n"
           "with the paper's clamps [tangent]"),
    {0}};

const cli_argument cli_takes_sign[] = {
    CHOICE("--sign", "RULE", SHARED(sign), repair_sign_names, BVX_FILL_AUTO,
           "winding: holes and overlaps; vote: holes and flipped triangles;\n"
           "parity: nested shells are cavities; auto: winding, flipped triangles\n"
           "turned before, or vote where they cannot be oriented [auto]"),
    {0}};

const cli_argument cli_takes_least_part[] = {
    LONG("--least-part", "N", SHARED(least_part), 0, 1e15,
         "parts of fewer voxels are dropped, 0: none is [crumbs: small, nowhere three\n"
         "voxels thick, where the mesh has no part of its own; lod of grids: none]"),
    {0}};

const cli_argument cli_takes_shells[] = {
    FROM_TO("--shell", "T", SHARED(shell), 0, 1e6,
            "thickness of shells in voxels, from 1.5; 0: none are made [2]"),
    {.also = cli_takes_least_part},
    LONG("--least-cavity", "N", SHARED(least_cavity), 0, 1e15, "cavities of fewer voxels are filled [0]"),
    {0}};

const cli_argument cli_takes_normals[] = {
    FLAG("--normals", SHARED(normals),
         "of a mesh: also write normals of its vertices to .ply and .obj, where the\n"
         "mesh has none smooth ones, averaged by area over sharp edges too; .glb\n"
         "always has them"),
    {0}};

const cli_argument cli_takes_output_origin[] = {
    TRIPLE("--output-origin", "X,Y,Z", SHARED(output_origin),
           "of a mesh: taken from the positions in the file, before they are turned, as\n"
           ".stl and other 32-bit floats need it far from the origin [0,0,0]"),
    {0}};

const cli_argument cli_takes_quantize[] = {
    FLAG("--quantize", SHARED(quantize),
         "of a .glb: positions of 16 bits, normals of 8, by KHR_mesh_quantization"),
    {0}};

const cli_argument cli_takes_file_of_a_mesh[] = {
    {.also = cli_takes_output_origin},
    {.also = cli_takes_quantize},
    CHOICE("--up", "AXIS", SHARED(up), up_names, CLI_UP_Y,
           "of a mesh: the axis that is up in the file, y or z; it is turned where the\n"
           "input has the other one up [.glb, .obj: y; .stl: z; others: as they come]"),
    CHOICE("--input-up", "AXIS", SHARED(input_up), up_names, CLI_UP_Y,
           "the axis that is up in the input, y or z [as for --up]"),
    {0}};

const cli_argument cli_takes_carry[] = {
    FLAG("--carry", SHARED(carry),
         "give a new surface the colours and texture coordinates of the nearest points\n"
         "on the input; lod: with --solid, edge-ratio and coverage"),
    {0}};

const cli_argument cli_takes_samples[] = {LONG("--samples", "N", SHARED(samples), 0, 2147483647,
                                               "points on each mesh for the distances, 0: none [20000]"),
                                          {0}};

const cli_argument cli_takes_connectivity[] = {CHOICE("--connectivity", "N", SHARED(connectivity),
                                                      cli_connectivity_names, 0,
                                                      "6: through faces; 18: and edges; 26: and corners [6]"),
                                               {0}};

const cli_argument cli_takes_common[] = {
    WHOLE("--threads", "N", SHARED(general.threads), 0, 1024, "workers, 0: all there are [0]"),
    BYTES("--memory-limit", "BYTES", SHARED(general.memory_limit),
          "maximum memory for data; K, M and G are understood [what there is;\n"
          "files: half of it]"),
    FLAG("--json", SHARED(general.json), "a report for programs on standard output, in place of the text"),
    CHOICE("--progress", "HOW", SHARED(general.progress), progress_names, CLI_BAR_AUTO,
           "auto: a bar on a terminal; bar; json: lines of JSON on standard error;\n"
           "none [auto]"),
    FLAG("--quiet", SHARED(general.quiet), "no text, no bar, no warnings"),
    FLAG("--help", SHARED(general.help), "what most runs need"),
    FLAG("--help-all", SHARED(general.help), "every option, in groups"),
    {0}};

const cli_argument cli_takes_all[] = {
    CHOICE("--format", "NAME", SHARED(format), FORMAT_NAMES, BVX_FORMAT_STL,
           "format of standard input and output, with - as input or after -o,\n"
           "or of files in --output-dir: stl, obj, ply ...\n"
           "[output: ply, bvx, nrrd for distances, csv, png]"),
    {.also = cli_takes_common},
    {0}};
