/* named_formats.c - formats by the names of files: what they are called, and what they hold; which inputs
 * are volumes or contours. */
#include "cli_inputs/inputs.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#define INPUT_ENDINGS CLI_MESHES_READ ", or " CLI_GRIDS " .nhdr .raw, also with .gz"

int cli_kind_of_format(int32_t format)
{
    if (format < 0 || format > 30) return 0;
    return (BVX_MESHES_WRITTEN >> format & 1) != 0  ? CLI_MESH
           : (BVX_GRIDS_WRITTEN >> format & 1) != 0 ? CLI_GRID
                                                    : 0;
}

int cli_kind_of_input(int32_t format)
{
    return format == BVX_FORMAT_GLTF                               ? CLI_MESH
           : format == BVX_FORMAT_VDB || format == BVX_FORMAT_NVDB ? 0
                                                                   : cli_kind_of_format(format);
}

const char *cli_format_name(int32_t format)
{
    switch (format) {
#define FORMAT_NAME(name, value, text) \
    case name: return text;
        BVX_FORMAT_LIST(FORMAT_NAME)
#undef FORMAT_NAME
    default: return "unknown";
    }
}

int cli_needs_sidecar(int32_t format)
{
    return format == BVX_FORMAT_NPY || format == BVX_FORMAT_VOX;
}

char *cli_sidecar_name(const char *path)
{
    /* Never packed itself: FILE.npy.gz has FILE.npy.json beside it. */
    size_t const n = strlen(path) - (cli_is_packed(path) ? 3 : 0);
    char *const name = malloc(n + 6);
    if (name != NULL) {
        memcpy(name, path, n);
        memcpy(name + n, ".json", 6);
    }
    return name;
}

const char *cli_input_name(const char *path)
{
    return strcmp(path, "-") == 0 ? "standard input" : path;
}

const char *cli_first_name(const cli_run *run)
{
    return cli_input_name(run->options->input[0]);
}

int32_t cli_input_format(const cli_run *run, const char *path)
{
    return strcmp(path, "-") == 0 ? run->options->format : bvx_format_of_name(path);
}

/* The axis that is up in such a file, CLI_UP_...; none where programs do not agree on one. */
static int32_t up_of_format(int32_t format)
{
    return format == BVX_FORMAT_GLB || format == BVX_FORMAT_GLTF || format == BVX_FORMAT_OBJ ? CLI_UP_Y
           : format == BVX_FORMAT_STL || format == BVX_FORMAT_3MF                            ? CLI_UP_Z
                                                                                             : CLI_UP_NONE;
}

int32_t cli_input_up(const cli_run *run)
{
    const cli_options *const o = run->options;
    int32_t up = o->input_up;
    for (int i = 0; i < o->inputs && o->input_up == CLI_UP_NONE; i++) {
        int32_t const one = up_of_format(cli_input_format(run, o->input[i]));
        if (i > 0 && one != up) return CLI_UP_NONE;
        up = one;
    }
    return up;
}

int32_t cli_output_up(const cli_run *run)
{
    const cli_options *const o = run->options;
    return o->up != CLI_UP_NONE ? o->up : up_of_format(bvx_format_of_name(o->output));
}

int32_t cli_turn_of(const cli_run *run)
{
    int32_t const from = cli_input_up(run), to = cli_output_up(run);
    if (from == CLI_UP_Z && to == CLI_UP_Y) return BVX_TURN_Z_TO_Y;
    return from == CLI_UP_Y && to == CLI_UP_Z ? BVX_TURN_Y_TO_Z : BVX_TURN_NONE;
}

const char *cli_way_around(const char *path, int written)
{
    static const struct {
        const char *endings, *way[2]; /* from a file of these, and to one */
    } known[] = {{".fbx .dae .blend .3ds .usd .usdz .usdc .x3d .abc ",
                  {"; Blender makes .glb of it", "; Blender makes it of .glb"}},
                 {".step .stp .iges .igs .brep .fcstd ",
                  {"; FreeCAD and Gmsh make .stl of it", "; FreeCAD makes it of .stl"}},
                 {".gltf ", {"", "; .glb is the same in one file"}},
                 {".vdb ", {"; OpenVDB's vdb_tool makes .ply of it", ""}},
                 {".nvdb ", {"; OpenVDB's nanovdb_convert makes .vdb of it", ""}},
                 {".schematic ", {"; FileToVox makes .vox of it", "; ObjToSchematic makes it of .obj"}},
                 {".schem .litematic ", {"", "; ObjToSchematic makes it of .obj"}},
                 {".amf .dxf .dcm ", {"; the Python package reads it", ""}},
                 {".vtp ", {"; the Python package reads it", "; the Python package writes it"}},
                 {".nii .nii.gz .mha ",
                  {"; the Python package makes .nrrd of it", "; the Python package makes it of .nrrd"}}};
    const char *dot = strrchr(path, '.');
    char ending[16] = "";

    if (dot != NULL && dot - path > 4 && cli_same_name(dot, ".gz") && dot[-4] == '.') dot -= 4;
    for (size_t i = 0; dot != NULL && strlen(dot) < sizeof ending - 1 && dot[i] != 0; i++)
        ending[i] = (char)(dot[i] >= 'A' && dot[i] <= 'Z' ? dot[i] + ('a' - 'A') : dot[i]);
    if (ending[0] != 0) ending[strlen(ending)] = ' ';
    for (size_t i = 0; ending[0] != 0 && i < sizeof known / sizeof known[0]; i++)
        if (strstr(known[i].endings, ending) != NULL) return known[i].way[written];
    return "";
}

int cli_input_kind(cli_run *run, const char *path, int *kind)
{
    int32_t const format = cli_input_format(run, path);
    *kind = format == BVX_FORMAT_RAW ? CLI_GRID : cli_kind_of_input(format);
    if (*kind != 0) return CLI_DONE;
    if (strcmp(path, "-") == 0)
        return cli_usage(run,
                         "--format does not name a mesh or grid format that can be read (" CLI_MESHES_READ
                         " " CLI_GRIDS ")");
    return cli_fail(
        run, "%s: the name does not end in a mesh or grid format that can be read (" INPUT_ENDINGS ")%s",
        path, cli_way_around(path, 0));
}

int cli_may_be_volume(int32_t format)
{
    return format == BVX_FORMAT_NRRD || format == BVX_FORMAT_NPY || format == BVX_FORMAT_VTI ||
           format == BVX_FORMAT_RAW;
}

int cli_selects(const cli_run *run)
{
    /* --label of sections is another one: it chooses bodies. */
    return cli_given(run, "--level") + cli_given(run, "--range") +
           (run->command->bit != CLI_SECTIONS && cli_given(run, "--label"));
}

int cli_is_volume(const cli_run *run, const char *path)
{
    int32_t const format = cli_input_format(run, path);
    size_t const n = strlen(path);
    int const detached = n >= 5 && strcmp(path + n - 5, ".nhdr") == 0;
    return cli_may_be_volume(format) && (cli_selects(run) != 0 || format == BVX_FORMAT_RAW || detached);
}

int cli_is_contours(const cli_run *run, const char *path)
{
    int32_t const format = cli_input_format(run, path);
    return format == BVX_FORMAT_CSL || format == BVX_FORMAT_CSV;
}

int cli_check_grid_format(cli_run *run, const char *path, const bvx_lattice *l)
{
    int32_t const format = bvx_format_of_name(path);
    /* One scale is stored for all three axes. */
    if (format == BVX_FORMAT_BINVOX && (l->spacing[0] != l->spacing[1] || l->spacing[0] != l->spacing[2]))
        return cli_fail(
            run, "%s: voxels of %.9g x %.9g x %.9g; .binvox holds only cubic ones: take another format", path,
            l->spacing[0], l->spacing[1], l->spacing[2]);
    return CLI_DONE;
}
