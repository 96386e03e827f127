/* endings.h - endings of formats as texts show them, the advised ones
 * first. tests/unit/test_formats.c holds them to the header's lists. */
#ifndef CLI_ENDINGS_H
#define CLI_ENDINGS_H

#define CLI_MESHES_READ      ".stl .obj .ply .off .glb .gltf .3mf"
#define CLI_MESHES_WRITTEN   ".ply .obj .stl .off .glb .3mf"
#define CLI_GRIDS            ".npy .binvox .vox .nrrd .vti .bvx" /* read and written */
#define CLI_GRIDS_WRITTEN    CLI_GRIDS " .vdb .nvdb"
#define CLI_CONTOURS_READ    ".csl .csv"
#define CLI_CONTOURS_WRITTEN ".csl .csv"

#endif
