/* rows.h - of the bitvox program: how a row of a command's options is written, and the rows that several
 * commands share.
 *
 * A row names the option, its value as the help shows it (a flag has none), the field that it fills, what
 * its kind needs, and its lines of help. The field is SHARED(name), of cli_options, or OWN(name), of the
 * command's options:
 *
 *     #define OWN(name) CLI_OWN(bvx_faces_options, name)
 *
 *     static const cli_argument faces_rows[] = {
 *         {.also = cli_takes_output},
 *         FLAG("--merge", OWN(merged), "faces of one plane become few rectangles"),
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
#define ROW(n, v, k, h)                      .name = n, .value = v, .kind = CLI_##k, .help = h
#define LOW_HIGH(lo, hi)                     .low = lo, .high = hi
#define NAMES(list, first)                   .choice = list, .base = first
#define FLAG(n, at, h)                       {ROW(n, NULL, FLAG, h), at}
#define WHOLE(n, v, at, lo, hi, h)           {ROW(n, v, INT, h), LOW_HIGH(lo, hi), at}
/* or one of the names, which stand for first, first + 1 .. */
#define WHOLE_OR(n, v, at, lo, hi, list, first, h) \
    {ROW(n, v, INT, h), LOW_HIGH(lo, hi), NAMES(list, first), at}
#define LONG(n, v, at, lo, hi, h)            {ROW(n, v, LONG, h), LOW_HIGH(lo, hi), at}
/* both ends excluded; both allowed */
#define BETWEEN(n, v, at, lo, hi, h)         {ROW(n, v, REAL, h), LOW_HIGH(lo, hi), at}
#define FROM_TO(n, v, at, lo, hi, h)         {ROW(n, v, REAL, h), LOW_HIGH(lo, hi), .least = 1, at}
#define NUMBER(n, v, at, h)                  {ROW(n, v, NUMBER, h), at}
#define TRIPLE(n, v, at, h)                  {ROW(n, v, TRIPLE, h), at}
/* or the name of an axis */
#define DIRECTION(n, v, at, h)               {ROW(n, v, TRIPLE, h), NAMES(cli_axis_names, 0), at}
#define PAIR(n, v, at, h)                    {ROW(n, v, PAIR, h), at}
#define LIST(n, v, at, lo, hi, few, many, h) \
    {ROW(n, v, LIST, h), LOW_HIGH(lo, hi), .least = few, .most = many, at}
#define ERRORS(n, v, at, many, h)            {ROW(n, v, ERRORS, h), .least = 1, .most = many, at}
#define SIZE(n, v, at, hi, h)                {ROW(n, v, SIZE, h), LOW_HIGH(1, hi), .least = 2, .most = 2, at}
#define BYTES(n, v, at, h)                   {ROW(n, v, BYTES, h), LOW_HIGH(1, 1e18), at}
#define CHOICE(n, v, at, list, first, h)     {ROW(n, v, CHOICE, h), NAMES(list, first), at}
#define SET(n, v, at, list, first, h)        {ROW(n, v, SET, h), NAMES(list, first), at}
#define PLANES(n, v, at, h)                  {ROW(n, v, CUT, h), at}
#define TEXT(n, v, at, h)                    {ROW(n, v, TEXT, h), at}
#define FILE_NAME(n, v, at, h)               {ROW(n, v, FILE, h), at}
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
    cli_takes_collapse[],                     /* --strict, --even, --attributes .. */
    cli_takes_reduction[],                    /* --triangles, --error, --error-kind of one mesh */
    cli_takes_sharp[],                        /* --sharp, --no-sharp */
    cli_takes_interpolation[],                /* --interpolation */
    cli_takes_sign[],                         /* --sign of measured surfaces */
    cli_takes_least_part[],                   /* --least-part of measured surfaces */
    cli_takes_shells[],                       /* --shell, --least-part, --least-cavity */
    cli_takes_normals[],                      /* --normals */
    cli_takes_output_origin[],                /* --output-origin */
    cli_takes_quantize[],                     /* --quantize */
    cli_takes_file_of_a_mesh[],               /* both, --up, --input-up */
    cli_takes_carry[],                        /* --carry */
    cli_takes_samples[],                      /* --samples */
    cli_takes_connectivity[],                 /* --connectivity */
    cli_takes_common[],                       /* what all commands take */
    cli_takes_all[];                          /* --format, and what all commands take */

/* Names of values that several commands take. */
extern const char *const cli_value_type_names[], *const cli_axis_names[], *const cli_connectivity_names[];
/* By BVX_FORMAT_...; NULL after those of meshes and grids, and after those of contours. */
extern const char *const cli_format_names[];

#endif
