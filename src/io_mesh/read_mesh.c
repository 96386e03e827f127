/* read_mesh.c - a mesh from the bytes of a file: bvx_read_mesh. The checks around the
 * formats' own readers: arguments, text of two bytes a letter, corners that are not finite. */
#include "io_mesh/mesh_formats.h"
#include "mesh/view.h"

static bvx_status read_mesh_as(bvxi_source *source, int32_t format, const bvx_read_options *options,
                               uint32_t *lost, bvx_mesh *mesh)
{
    int const gltf = format == BVX_FORMAT_GLB || format == BVX_FORMAT_GLTF;

    source->format = format == BVX_FORMAT_STL   ? "STL"
                     : format == BVX_FORMAT_OBJ ? "OBJ"
                     : format == BVX_FORMAT_PLY ? "PLY"
                     : format == BVX_FORMAT_3MF ? "3MF"
                     : gltf                     ? "glTF"
                                                : "OFF";

    /* An empty file is refused first, or its reader would name a line that nobody wrote. */
    if (source->begin == source->end) return BVXI_FILE_FAIL(source, BVX_ERR_EMPTY, "the file has no bytes");
    /* Text of two bytes a letter, of which readers would find no word: by its byte order mark, or by letters of which
     * every other byte is 0. */
    const unsigned char *const b = (const unsigned char *)source->begin;
    int const words = source->end - source->begin >= 4 && format != BVX_FORMAT_STL &&
                      format != BVX_FORMAT_3MF;
    if (words &&
        ((b[0] == 0xff && b[1] == 0xfe && b[3] == 0) || (b[0] == 0xfe && b[1] == 0xff && b[2] == 0) ||
         ((b[0] == 0) != (b[1] == 0) && (b[0] == 0) == (b[2] == 0) && (b[1] == 0) == (b[3] == 0))))
        return BVXI_FILE_FAIL(source, BVX_ERR_FORMAT, "the file is text in UTF-16; save it as UTF-8");
    bvxi_source_pass(source, 0, 1);
    switch (format) {
    case BVX_FORMAT_STL: return bvxi_read_stl(source, mesh);
    case BVX_FORMAT_OBJ: return bvxi_read_obj(source, lost, mesh);
    case BVX_FORMAT_PLY: return bvxi_read_ply(source, mesh);
    case BVX_FORMAT_OFF: return bvxi_read_off(source, mesh);
    case BVX_FORMAT_3MF: return bvxi_read_3mf(source, options, lost, mesh);
    default: return bvxi_read_gltf(source, options, lost, mesh);
    }
}

static const bvxi_option read_rows[] = {
    BVXI_SWITCH(bvx_read_options, drop_nonfinite),
    BVXI_SWITCH(bvx_read_options, keep_file),
};

static bvx_status check_read(bvx_context *context, const char *function, const void *bytes, uint64_t size,
                             int32_t format, bvx_read_options *options, const bvx_mesh *mesh)
{
    if (mesh == NULL) return bvxi_fail_null(context, function, "mesh");
    if (bytes == NULL) return bvxi_fail_null(context, function, "bytes");
    BVXI_TRY(bvxi_check_options(context, function, options, BVXI_OPTIONS(read_rows)));
    if ((options->open_file == NULL) != (options->close_file == NULL))
        return bvxi_fail_for(context, BVX_ERR_ARGUMENT, BVX_REASON_CONTRADICTION,
                             "%s: open_file and close_file are set together or not at all", function);
    if (size > SIZE_MAX / 2)
        return bvxi_fail_for(context, BVX_ERR_ARGUMENT, BVX_REASON_TOO_MANY,
                             "%s: size is %u, more than memory can hold", function, size);
    if (format < 0 || format > BVX_FORMAT_3MF || (BVX_MESHES_READ >> format & 1) == 0)
        return bvxi_fail_format(context, BVX_ERR_ARGUMENT, function, "mesh that is read", format,
                                BVX_MESHES_READ);
    if (mesh->owned != 1 && !bvxi_mesh_is_empty(mesh))
        return bvxi_fail_for(context, BVX_ERR_ARGUMENT, BVX_REASON_NOT_EMPTY,
                             "%s: mesh brings arrays, which are not used; zero it first", function);
    return BVX_OK;
}

static bvx_status run_read_mesh(bvx_context *context, const void *bytes, uint64_t size, int32_t format,
                                const bvx_read_options *given, bvx_mesh *mesh)
{
    static const char function[] = "bvx_read_mesh";
    bvx_mesh made = {0};
    bvx_read_report report = {0};
    bvx_read_options options;

    BVXI_TRY(bvxi_take_options(context, function, given, &options, sizeof options));
    BVXI_TRY(check_read(context, function, bytes, size, format, &options, mesh));

    /* Nothing is read into the caller's mesh: after a failure it is as it was. */
    bvxi_source source = {.ctx = context, .begin = bytes};
    source.end = source.begin + (size_t)size;
    source.takes_any = options.drop_nonfinite;
    bvx_status status = BVXI_SCOPE(context, read_mesh_as(&source, format, &options, &report.lost, &made));

    /* Vertices with odd coordinates are kept by the readers
     * only so that their triangles can be dropped here. */
    if (status == BVX_OK && options.drop_nonfinite) {
        status = bvxi_mesh_drop_nonfinite(context, function, &made, &report.dropped);
        if (status == BVX_OK && made.triangle_count == 0)
            status = BVXI_FILE_FAIL_FOR(&source, BVX_ERR_EMPTY, BVX_REASON_NOT_FINITE,
                                        "each of the %u triangles has a corner that is not finite",
                                        report.dropped);
    }
    if (status != BVX_OK) {
        bvx_mesh_free(context, &made);
        return status;
    }

    /* The old arrays are freed only now, when the new ones are complete. */
    bvx_mesh_free(context, mesh);
    *mesh = made;
    if (options.report != NULL) *options.report = report;
    return BVX_OK;
}

bvx_status bvx_read_mesh(bvx_context *context, const void *bytes, uint64_t size, int32_t format,
                         const bvx_read_options *options, bvx_mesh *mesh)
{
    return BVXI_CALL(context, run_read_mesh(context, bytes, size, format, options, mesh));
}
