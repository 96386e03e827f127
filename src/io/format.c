/* format.c - which format a file name stands for. */
#include "core/core.h"

/* 1 when the n characters at text are ending, in either case of letters. */
static int name_ends_with(const char *text, size_t n, const char *ending)
{
    size_t const k = bvxi_text_length(ending);
    if (n < k) return 0;
    for (size_t i = 0; i < k; i++) {
        char const c = text[n - k + i];
        if ((c >= 'A' && c <= 'Z' ? (char)(c - 'A' + 'a') : c) != ending[i]) return 0;
    }
    return 1;
}

int32_t bvx_format_of_name(const char *name)
{
    static const struct {
        const char *ending;
        int32_t format;
    } known[] = {{".stl", BVX_FORMAT_STL}, {".obj", BVX_FORMAT_OBJ}, {".ply", BVX_FORMAT_PLY}, {".npy", BVX_FORMAT_NPY},
                 {".png", BVX_FORMAT_PNG}, {".off", BVX_FORMAT_OFF}, {".glb", BVX_FORMAT_GLB}, {".binvox", BVX_FORMAT_BINVOX},
                 {".vox", BVX_FORMAT_VOX}, {".nrrd", BVX_FORMAT_NRRD}, {".vti", BVX_FORMAT_VTI}, {".bvx", BVX_FORMAT_BVX},
                 {".vtu", BVX_FORMAT_VTU}, {".csl", BVX_FORMAT_CSL}, {".csv", BVX_FORMAT_CSV}, {".svg", BVX_FORMAT_SVG},
                 {".nhdr", BVX_FORMAT_NRRD}, {".raw", BVX_FORMAT_RAW}, {".xyz", BVX_FORMAT_XYZ}};
    size_t n;
    if (name == NULL) return BVX_FORMAT_UNKNOWN;
    n = bvxi_text_length(name);
    if (name_ends_with(name, n, ".gz")) n -= 3;
    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++)
        if (name_ends_with(name, n, known[i].ending)) return known[i].format;
    return BVX_FORMAT_UNKNOWN;
}
