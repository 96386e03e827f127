/* print_check.c - for 3D printing: is this part sound, how much material does it take, and a closed copy of
 * it.
 *
 *     print_check [PART.ply [OUT.stl]]
 *
 * Lengths are taken as millimetres. The solid is what a printer would fill: voxels whose centres lie inside;
 * the copy is the surface of that solid, closed and manifold whatever the part was. */
#include <bitvox_io.h>
#include <stdio.h>
#include <stdlib.h>

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

static int save(const char *path, const bvx_buffer *file)
{
    FILE *const f = fopen(path, "wb");
    size_t written;
    if (f == NULL) return 0;
    written = fwrite(file->bytes, 1, (size_t)file->size, f);
    return (fclose(f) == 0) & (written == file->size);
}

static void tell(const bvx_certificate *c)
{
    printf("part: %u triangles, %.4g x %.4g x %.4g mm\n", (unsigned)c->triangles,
           c->box.high[0] - c->box.low[0], c->box.high[1] - c->box.low[1], c->box.high[2] - c->box.low[2]);
    printf("  %u boundary edges, %u flipped edges, %u edges of three and more triangles\n",
           (unsigned)c->boundary_edges, (unsigned)c->flipped_edges, (unsigned)c->nonmanifold_edges);
    if (c->closed && c->oriented) printf("  sound; volume %.6g mm^3\n", c->volume);
    else printf("  NOT SOUND: a slicer may leave gaps\n");
}

/* Reads a part, writes its closed copy to out when that is not NULL. */
static bvx_status check(bvx_context *ctx, const void *bytes, size_t size, int32_t format, const char *out)
{
    bvx_mesh part = {0}, copy = {0};
    bvx_mesh_view view;
    bvx_certificate c;
    bvx_lattice lattice;
    bvx_grid solid = {0};
    bvx_solid_report report;
    bvx_voxelize_options options = {.struct_size = sizeof options};
    bvx_buffer file = {0};
    uint64_t set = 0;
    bvx_status s = bvx_read_mesh(ctx, bytes, size, format, NULL, &part);
    bvx_mesh_view_of(&part, &view);
    if (s == BVX_OK) s = bvx_mesh_check(ctx, &view, 1, &c);
    if (s == BVX_OK) tell(&c);

    options.fill = BVX_FILL_NONZERO; /* overlapping shells are one body, as slicers see them */
    options.report = &report;
    if (s == BVX_OK) s = bvx_lattice_fit(ctx, &view, 256, &lattice);
    if (s == BVX_OK) s = bvx_voxelize_solid(ctx, &view, &lattice, &options, &solid);
    if (s == BVX_OK) s = bvx_grid_count(ctx, &solid, &set);
    if (s == BVX_OK)
        printf("solid: %.6g mm^3 of material, %u rows with a hole in their wall\n",
               (double)set * lattice.spacing[0] * lattice.spacing[1] * lattice.spacing[2],
               (unsigned)report.unbalanced_rows);
    if (s == BVX_OK) s = bvx_extract_surface(ctx, &solid, NULL, &copy);
    if (s == BVX_OK && out != NULL) {
        s = bvx_write_mesh(ctx, &copy, 1, NULL, BVX_FORMAT_STL, &file);
        if (s == BVX_OK && !save(out, &file)) fprintf(stderr, "print_check: %s cannot be written\n", out);
    }
    if (s == BVX_OK) printf("closed copy: %u triangles\n", (unsigned)copy.triangle_count);
    bvx_buffer_free(ctx, &file);
    bvx_mesh_free(ctx, &copy);
    bvx_grid_free(ctx, &solid);
    bvx_mesh_free(ctx, &part);
    return s;
}

int main(int count, char **word)
{
    const char *const path = count > 1 ? word[1] : "fixtures/knot.ply";
    size_t size;
    void *const bytes = load(path, &size);
    bvx_context *ctx;
    bvx_status status;

    if (bytes == NULL) {
        fprintf(stderr, "print_check: %s cannot be read\n", path);
        return 1;
    }
    if (bvx_context_create(NULL, &ctx) != BVX_OK) return 1;
    status = check(ctx, bytes, size, bvx_format_of_name(path), count > 2 ? word[2] : NULL);
    if (status != BVX_OK) fprintf(stderr, "print_check: %s: %s\n", path, bvx_last_message(ctx));
    bvx_context_destroy(ctx);
    free(bytes);
    return status == BVX_OK ? 0 : 1;
}
