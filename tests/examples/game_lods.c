/* game_lods.c - for an asset pipeline: three levels of detail of a mesh in memory, inside one block of fixed
 * size.
 *
 *     game_lods [MESH.ply]
 *
 * The library allocates nothing but from the block: the levels grow from its low end, what is needed
 * meanwhile from its high end. So a tool can bake assets in parallel with a known number of bytes each, and
 * give everything back at once. */
#include <bitvox_io.h>
#include <stdio.h>
#include <stdlib.h>

enum { BLOCK_BYTES = 48 << 20, FINEST = 96, LEVELS = 3 };

static int fail(const bvx_context *ctx, const char *what)
{
    fprintf(stderr, "game_lods: %s: %s\n", what, bvx_last_message(ctx));
    return 1;
}

/* A file's bytes come from the tool's own file system. */
static void *load(const char *path, size_t *size)
{
    FILE *const f = fopen(path, "rb");
    char *bytes = NULL;
    long end;

    *size = 0;
    if (f == NULL) return NULL;
    if (fseek(f, 0, SEEK_END) == 0 && (end = ftell(f)) > 0 && fseek(f, 0, SEEK_SET) == 0 &&
        (bytes = malloc((size_t)end)) != NULL)
        *size = fread(bytes, 1, (size_t)end, f);
    fclose(f);
    return bytes;
}

static int bake(bvx_context *ctx, const void *file, size_t size)
{
    static const int32_t resolutions[LEVELS] = {FINEST, FINEST / 2, FINEST / 4};
    bvx_mesh mesh = {0}, level[LEVELS] = {{0}};
    bvx_mesh_view view;
    bvx_lattice lattice;
    bvx_grid solid = {0};
    bvx_lod_report report[LEVELS];
    bvx_lod_options options = {.struct_size = sizeof options};
    if (bvx_read_mesh(ctx, file, size, BVX_FORMAT_PLY, NULL, &mesh) != BVX_OK) return fail(ctx, "reading");
    bvx_mesh_view_of(&mesh, &view); /* an engine points the view at its own arrays instead */
    if (bvx_lattice_fit(ctx, &view, 8 * FINEST, &lattice) != BVX_OK) return fail(ctx, "lattice");
    if (bvx_voxelize_solid(ctx, &view, &lattice, NULL, &solid) != BVX_OK) return fail(ctx, "solid");

    options.resolutions = resolutions;
    options.reports = report;
    if (bvx_build_lods(ctx, &solid, &options, LEVELS, level) != BVX_OK) return fail(ctx, "levels");
    for (int i = 0; i < LEVELS; i++) {
        bvx_certificate c;
        bvx_mesh_view_of(&level[i], &view);
        if (bvx_mesh_check(ctx, &view, 0, &c) != BVX_OK) return fail(ctx, "check");
        printf("level %d: %u triangles, %.1f voxels a sample, %s\n", i, (unsigned)level[i].triangle_count,
               report[i].ratio[0],
               c.closed && c.edge_manifold && c.vertex_manifold && c.oriented ? "closed and manifold"
                                                                              : "NOT CLOSED");
        if (!c.closed) return 1;
    }
    printf("%.1f of %.1f MiB used at most\n", (double)bvx_memory_peak(ctx) / 1048576.0,
           BLOCK_BYTES / 1048576.0);
    return 0;
}

int main(int count, char **word)
{
    size_t size;
    void *const file = load(count > 1 ? word[1] : "fixtures/knot.ply", &size);
    void *const block = malloc(BLOCK_BYTES);
    bvx_context_options options = {.struct_size = sizeof options};
    bvx_context *ctx;
    int status = 1;

    options.arena.memory = block;
    options.arena.size = BLOCK_BYTES;
    options.threads = 1; /* the tool bakes one asset a thread */
    if (file != NULL && block != NULL && bvx_context_create(&options, &ctx) == BVX_OK)
        status = bake(ctx, file, size);
    else fprintf(stderr, "game_lods: the file cannot be read, or there is no memory\n");
    free(block); /* context, mesh, solid and levels end with it */
    free(file);
    return status;
}
