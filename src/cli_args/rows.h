/* rows.h - of the bitvox program: how a row of a command's options is written, and the rows that several commands share.
 *
 * A row names the option, its value as the help shows it (a flag has none), the field that it fills, what its kind needs,
 * and its lines of help. The field is SHARED(name), of cli_options, or OWN(name), of the command's options:
 *
 *     #define OWN(name) CLI_OWN(faces_options, name)
 *
 *     static const cli_argument faces_rows[] = {
 *         {.also = cli_takes_output},
 *         FLAG("--merge", OWN(merge), "faces of one plane become few rectangles"),
 *         {0}};
 *
 * Rows stand in the order of the help. */
#ifndef BVX_CLI_ROWS_H
#define BVX_CLI_ROWS_H

#include "cli_args/args.h"

#define SHARED(name)        .field = offsetof(cli_options, name)
#define CLI_OWN(type, name) .field = offsetof(type, name), .own = 1

#define LARGEST_SIDE 33554432.0 /* 2^25, a lattice's limit */

/* clang-format off */
#define FLAG(n, at, h)                          {.name = n, .kind = CLI_FLAG, at, .help = h}
#define WHOLE(n, v, at, lo, hi, h)              {.name = n, .value = v, .kind = CLI_INT, at, .low = lo, .high = hi, .help = h}
#define WHOLE_OR(n, v, at, lo, hi, list, first, h) /* or one of the names, which stand for first, first + 1 .. */ \
    {.name = n, .value = v, .kind = CLI_INT, at, .low = lo, .high = hi, .choice = list, .base = first, .help = h}
#define LONG(n, v, at, lo, hi, h)               {.name = n, .value = v, .kind = CLI_LONG, at, .low = lo, .high = hi, .help = h}
#define BETWEEN(n, v, at, lo, hi, h) /* both excluded */ \
    {.name = n, .value = v, .kind = CLI_REAL, at, .low = lo, .high = hi, .help = h}
#define FROM_TO(n, v, at, lo, hi, h) /* both allowed */ \
    {.name = n, .value = v, .kind = CLI_REAL, at, .low = lo, .high = hi, .least = 1, .help = h}
#define NUMBER(n, v, at, h)                     {.name = n, .value = v, .kind = CLI_NUMBER, at, .help = h}
#define TRIPLE(n, v, at, h)                     {.name = n, .value = v, .kind = CLI_TRIPLE, at, .help = h}
#define PAIR(n, v, at, h)                       {.name = n, .value = v, .kind = CLI_PAIR, at, .help = h}
#define LIST(n, v, at, lo, hi, few, many, h)    {.name = n, .value = v, .kind = CLI_LIST, at, .low = lo, .high = hi, .least = few, .most = many, .help = h}
#define ERRORS(n, v, at, many, h)               {.name = n, .value = v, .kind = CLI_ERRORS, at, .least = 1, .most = many, .help = h}
#define SIZE(n, v, at, hi, h)                   {.name = n, .value = v, .kind = CLI_SIZE, at, .low = 1, .high = hi, .least = 2, .most = 2, .help = h}
#define BYTES(n, v, at, h)                      {.name = n, .value = v, .kind = CLI_BYTES, at, .low = 1, .high = 1e18, .help = h}
#define CHOICE(n, v, at, list, first, h)        {.name = n, .value = v, .kind = CLI_CHOICE, at, .choice = list, .base = first, .help = h}
#define SET(n, v, at, list, first, h)           {.name = n, .value = v, .kind = CLI_SET, at, .choice = list, .base = first, .help = h}
#define PLANES(n, v, at, h)                     {.name = n, .value = v, .kind = CLI_CUT, at, .help = h}
#define SLICES(n, v, at, lo, hi, h)             {.name = n, .value = v, .kind = CLI_SLICES, at, .low = lo, .high = hi, .help = h}
#define FILE_NAME(n, v, at, h)                  {.name = n, .value = v, .kind = CLI_FILE, at, .help = h}
/* clang-format on */

extern const cli_argument cli_takes_output[], /* -o */
    cli_takes_output_dir[],                   /* --output-dir */
    cli_takes_spacing[],                      /* --spacing */
    cli_takes_lattice[],                      /* --resolution, --spacing, --origin */
    cli_takes_padding[],                      /* --padding */
    cli_takes_fill[],                         /* --fill */
    cli_takes_fill_of_solids[],               /* --fill, --close-gaps */
    cli_takes_add_shell[],                    /* --add-shell */
    cli_takes_selection[],                    /* --level, --range, --label: voxels of a volume */
    cli_takes_below[],                        /* --below */
    cli_takes_raw[],                          /* what a .raw file does not tell */
    cli_takes_volumes[],                      /* all three */
    cli_takes_states[],                       /* --states */
    cli_takes_expand[],                       /* --expand */
    cli_takes_trees[],                        /* both: of octrees */
    cli_takes_kept_parts[],                   /* --keep-largest, --least-part: parts of voxels */
    cli_takes_keep_largest[],                 /* --keep-largest */
    cli_takes_errors[],                       /* --error, --error-kind of levels */
    cli_takes_collapse[],                     /* --strict, --even, --colour-weight */
    cli_takes_reduction[],                    /* --triangles, --error, --error-kind of one mesh */
    cli_takes_sharp[],                        /* --sharp, --no-sharp */
    cli_takes_interpolation[],                /* --interpolation */
    cli_takes_sign[],                         /* --sign of measured surfaces */
    cli_takes_least_part[],                   /* --least-part of measured surfaces */
    cli_takes_shells[],                       /* --shell, --least-part, --least-cavity */
    cli_takes_normals[],                      /* --normals */
    cli_takes_output_origin[],                /* --output-origin */
    cli_takes_carry[],                        /* --carry of levels */
    cli_takes_samples[],                      /* --samples */
    cli_takes_connectivity[],                 /* --connectivity */
    cli_takes_common[],                       /* what all commands take */
    cli_takes_all[];                          /* --format, and what all commands take */

/* Names of values that several commands take. */
extern const char *const cli_value_type_names[], *const cli_axis_names[], *const cli_connectivity_names[];
/* By BVX_FORMAT_...; NULL after those of meshes and grids, and after those of contours. */
extern const char *const cli_format_names[];

#endif
