/* rules.c - options that are of no use beside other options, inputs or outputs: what rows say is refused.
 *
 * A table is read from its first row on and the first row that holds is told, so rows go from what the line
 * is about to its details. tests/tools/check_options.py finds names that no command has. */
#include "cli_inputs/inputs.h"

#include <stdio.h>
#include <string.h>

#define VOLUME_FORMATS                                                                            \
    (1u << BVX_FORMAT_NPY | 1u << BVX_FORMAT_NRRD | 1u << BVX_FORMAT_VTI | 1u << BVX_FORMAT_VDB | \
     1u << BVX_FORMAT_NVDB)
#define NORMAL_FORMATS (1u << BVX_FORMAT_PLY | 1u << BVX_FORMAT_OBJ | 1u << BVX_FORMAT_GLB)

const cli_rule cli_lattice_rules[] = {
    {.given = "--resolution", .beside = "--spacing", .message = "%o and %b exclude each other"},
    {.given = "--origin", .lacking = "--spacing", .message = "%o needs --spacing"},
    {.when = CLI_PADS, .given = "--origin", .beside = "--padding", .message = "%o and %b exclude each other"},
    {0}};

const cli_rule cli_fill_rules[] = {
    {.unless = CLI_FILLS_FLOOD,
     .given = "--close-gaps",
     .lacking = "--body",
     .message = "%o needs --fill flood"},
    {.when = CLI_FILLS_BELOW, .given = "--add-shell", .message = "%o has no use with --fill below"},
    {.when = CLI_FILLS_FLOOD, .given = "--window", .message = "--fill flood needs the whole lattice, no %o"},
    {.when = CLI_FILLS_REGIONS,
     .given = "--window",
     .message = "--fill regions needs the whole lattice, no %o"},
    {0}};

const cli_rule cli_reduction_rules[] = {
    {.when = CLI_TO_GRID,
     .given = "--triangles --error --error-kind",
     .message = "%o is for a mesh; the result is a grid"},
    {.given = "--triangles", .beside = "--error", .message = "%o and %b exclude each other"},
    {.given = "--error-kind", .lacking = "--error", .message = "%o needs --error"},
    {0}};

const cli_rule cli_to_mesh_rules[] = {
    {.unless = CLI_TO_MESH,
     .message = "%f: the name does not end in a mesh format that can be written (" CLI_MESHES_WRITTEN ")%a"},
    {0}};

const cli_rule cli_to_grid_rules[] = {
    {.unless = CLI_TO_GRID,
     .message = "%f: the name does not end in a grid format that can be written (" CLI_GRIDS_WRITTEN ")%a"},
    {0}};

const cli_rule cli_to_voxels_rules[] = {
    {.unless = CLI_TO_GRID | CLI_TO_MESH,
     .message = "%f: the name ends neither in a grid format that can be written (" CLI_GRIDS_WRITTEN
                ") nor in a mesh format (" CLI_MESHES_WRITTEN ")%a"},
    {.when = CLI_TO_GRID, .given = "--sharp --no-sharp", .message = "%o is for a mesh; the result is a grid"},
    {.also = cli_reduction_rules},
    {.also = cli_sharp_rules},
    {0}};

const cli_rule cli_sharp_rules[] = {
    {.given = "--sharp", .beside = "--no-sharp", .message = "%o and %b exclude each other"}, {0}};

const cli_rule cli_mesh_file_rules[] = {
    {.when = CLI_TO_STL,
     .given = "--carry",
     .message = "%f: .stl holds neither colours nor texture coordinates; take .ply, .obj or .glb for %o"},
    {.when = CLI_TO_STL,
     .given = "--normals",
     .message = "%f: %o is for .ply and .obj; .stl has the normals of triangles only"},
    {.unless = CLI_TO_NORMALS,
     .given = "--normals",
     .message = "%f: %o is for .ply and .obj; no normals are written to this format"},
    {0}};

const cli_rule cli_grid_rules[] = {
    {.given = "--resolution --spacing --origin --padding --fill --close-gaps --carry",
     .message = "%o is for meshes; %w is a grid"},
    {0}};

static uint32_t fact_if(int holds, uint32_t fact)
{
    return holds ? fact : 0;
}

const char *cli_given_of(const cli_run *run, const char *names)
{
    for (const char *p = names; *p != 0;) {
        size_t const n = strcspn(p, " ");
        const char *const name = cli_given_name(run, p, n);
        if (name != NULL) return name;
        p += n + (p[n] != 0);
    }
    return NULL;
}

static int check_rows(cli_run *run, const cli_rule *rules, uint32_t facts, const char *word)
{
    for (const cli_rule *r = rules; r->message != NULL || r->also != NULL; r++) {
        const char *option = NULL, *beside = NULL;
        if ((facts & r->when) != r->when || (facts & r->unless) != 0) continue;
        if (r->also != NULL) {
            CLI_TRY(check_rows(run, r->also, facts, word));
            continue;
        }
        if (r->given != NULL && (option = cli_given_of(run, r->given)) == NULL) continue;
        if (r->beside != NULL && (beside = cli_given_of(run, r->beside)) == NULL) continue;
        if (r->lacking != NULL && cli_given_of(run, r->lacking) != NULL) continue;

        char text[512];
        size_t n = 0;

        for (const char *p = r->message; *p != 0 && n + 1 < sizeof text; p++) {
            /* Not by printf: an option or a name may hold a percent sign. */
            const char *const put = *p != '%'     ? NULL
                                    : p[1] == 'o' ? option
                                    : p[1] == 'b' ? beside
                                    : p[1] == 'i' ? cli_first_name(run)
                                    : p[1] == 'f' ? run->options->output
                                    : p[1] == 'a' ? cli_way_around(run->options->output, 1)
                                    : p[1] == 'w' ? word
                                                  : NULL;

            if (put == NULL) text[n++] = *p;
            else n += (size_t)snprintf(text + n, sizeof text - n, "%s", put);
            p += put != NULL;
            if (n >= sizeof text) n = sizeof text - 1;
        }
        text[n] = 0;
        return cli_usage(run, "%s", text);
    }
    return CLI_DONE;
}

void cli_find_facts(cli_run *run)
{
    const cli_options *const o = run->options;
    int32_t const format = o->output != NULL ? bvx_format_of_name(o->output) : BVX_FORMAT_UNKNOWN;
    int const kind = cli_kind_of_format(format);
    uint32_t const bit = format >= 0 && format < 32 ? 1u << format : 0;
    run->options->facts = fact_if(o->fill == BVX_FILL_FLOOD, CLI_FILLS_FLOOD) |
                          fact_if(o->fill == BVX_FILL_REGIONS, CLI_FILLS_REGIONS) |
                          fact_if(o->fill == BVX_FILL_BELOW, CLI_FILLS_BELOW) |
                          fact_if(o->padding != 0, CLI_PADS) |
                          fact_if(cli_keep_largest(run) != 0 || cli_least_part(run) != 0, CLI_KEEPS_PARTS) |
                          fact_if(cli_input_up(run) != CLI_UP_NONE, CLI_HAS_UP) |
                          fact_if(o->output != NULL && cli_output_up(run) != CLI_UP_NONE, CLI_TO_UP) |
                          fact_if(kind == CLI_MESH, CLI_TO_MESH) | fact_if(kind == CLI_GRID, CLI_TO_GRID) |
                          fact_if(format == BVX_FORMAT_STL, CLI_TO_STL) |
                          fact_if(format == BVX_FORMAT_GLB, CLI_TO_GLB) |
                          fact_if((bit & NORMAL_FORMATS) != 0, CLI_TO_NORMALS) |
                          fact_if((bit & VOLUME_FORMATS) != 0, CLI_TO_DISTANCES);
    /* A mesh that is made of voxels is not as far off as they are. */
    if (CLI_HOLDS(run, CLI_TO_MESH) || run->command->bit == CLI_LOD)
        run->unheard = (uint64_t)1 << BVX_WARN_VOXELS;
}

int cli_check_rules(cli_run *run, const cli_rule *rules, uint32_t facts, const char *word)
{
    return check_rows(run, rules, facts | run->options->facts, word);
}
