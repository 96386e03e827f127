/* write_mesh.c - a mesh, or levels of detail, to the bytes of a file: bvx_write_mesh.
 *
 * The checks around the formats' own writers: arguments, normals, and whether rounding to 32-bit floats
 * would spoil the mesh. */
#include "io_mesh/mesh_formats.h"
#include "mesh/facet.h"
#include "mesh/view.h"
#include "mesh/topology.h"

enum { WRITTEN_LEVELS = 65536 }; /* more is an error of the caller's */

/* Texture coordinates that are written are finite; unused ones may hold anything. */
static bvx_status check_finite_uvs(bvx_context *ctx, const char *function, const char *which,
                                   const float *uvs, uint64_t count)
{
    for (size_t i = 0; i < (size_t)count * 2; i++)
        if (!(uvs[i] - uvs[i] == 0.0f))
            return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_NOT_FINITE,
                                 "%s: %stexture coordinate %i is not finite", function, which,
                                 (uint64_t)(i / 2));
    return BVX_OK;
}

static bvx_status check_written_uvs(bvx_context *ctx, const char *function, const bvx_mesh *mesh)
{
    if (mesh->uvs == NULL) {
        if (mesh->uv_triangles != NULL || mesh->uv_count != 0)
            return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_NULL, "%s: mesh.uvs is NULL beside %s",
                                 function,
                                 mesh->uv_triangles != NULL ? "uv_triangles" : "a uv_count above 0");
        return BVX_OK;
    }
    /* Indices are 32 bits wide. */
    if (mesh->uv_count > UINT32_MAX)
        return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                             "%s: mesh.uv_count is %u, the limit is below 2^32", function, mesh->uv_count);

    /* Without indices of their own, corners take the vertex's: there must be one for each vertex. */
    if (mesh->uv_triangles == NULL && mesh->uv_count < mesh->vertex_count)
        return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_NULL,
                             "%s: mesh.uv_count is %u for %u vertices, and uv_triangles is NULL", function,
                             mesh->uv_count, mesh->vertex_count);
    if (mesh->uv_triangles != NULL)
        for (size_t i = 0; i < (size_t)mesh->triangle_count * 3; i++)
            if (mesh->uv_triangles[i] >= mesh->uv_count)
                return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_INDEX,
                                     "%s: triangle %i has texture coordinate number %u, there are %u",
                                     function, (uint64_t)(i / 3), (uint64_t)mesh->uv_triangles[i],
                                     mesh->uv_count);

    return check_finite_uvs(ctx, function, "", mesh->uvs, bvxi_written_uvs(mesh));
}

static bvx_status check_written_mesh(bvx_context *ctx, const char *function, const bvx_mesh *mesh)
{
    bvx_mesh_view view;
    double low[3], high[3], p[3];

    /* Arrays before numbers: what is checked later is read through what is checked here. */
    BVXI_TRY(bvxi_mesh_check_reserved(ctx, function, mesh));
    if (mesh->triangle_count != 0 && mesh->triangles == NULL)
        return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_NULL, "%s: mesh.triangles is NULL", function);
    if (mesh->position_type != BVX_F32 && mesh->position_type != BVX_F64 && mesh->vertex_count != 0)
        return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_CHOICE,
                             "%s: mesh.position_type is %d, not BVX_F32 (1) or BVX_F64 (2)", function,
                             (int64_t)mesh->position_type);
    bvx_mesh_view_of(mesh, &view);
    BVXI_TRY(bvxi_view_check(ctx, function, &view));
    BVXI_TRY(bvxi_view_bounds(ctx, function, &view, low, high));
    /* All positions are finite; they must be so with the frame added. */
    int const framed = mesh->frame[0] != 0.0 || mesh->frame[1] != 0.0 || mesh->frame[2] != 0.0;
    for (uint64_t v = 0; framed && v < mesh->vertex_count; v++) {
        /* Two finite numbers may have an infinite sum. */
        bvxi_world_position(mesh, v, p);
        for (int a = 0; a < 3; a++)
            if (!(p[a] - p[a] == 0.0))
                return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_NOT_FINITE,
                                     "%s: vertex %i is not finite when mesh.frame is added", function, v);
    }
    BVXI_TRY(check_written_uvs(ctx, function, mesh));
    if (mesh->uvs2 == NULL) return BVX_OK;
    return check_finite_uvs(ctx, function, "second ", mesh->uvs2, mesh->vertex_count);
}

/* ---- normals ---- */

typedef bvx_status normals_writer(bvx_context *ctx, const bvxi_written *what, bvx_buffer *file);

static bvx_status write_with_normals(bvx_context *ctx, const bvx_mesh *mesh, normals_writer *write,
                                     bvx_buffer *file)
{
    bvx_mesh_view view;
    double low[3], high[3], *sum = NULL;
    bvxi_written what = {mesh, 1, NULL};

    BVXI_TRY(bvxi_progress(ctx, "write", 0.0));
    if (mesh->normals == NULL) {
        /* Text and doubles hold coordinates whose products leave the range of doubles. */
        bvx_mesh_view_of(mesh, &view);
        BVXI_TRY(bvxi_view_bounds(ctx, "bvx_write_mesh", &view, low, high));
        BVXI_TRY(bvxi_sum_normals(ctx, &view, bvxi_unit_scale(low, high), &sum));
    }

    what.sum = sum;
    return write(ctx, &what, file);
}

/* ---- one mesh ---- */

/* What messages about one of several meshes begin with. */
static const char *level_name(const char *function, uint64_t level, uint64_t level_count,
                              char text[BVXI_LEVEL_NAME])
{
    if (level_count == 1) return function;
    bvxi_level_name(function, level, text);
    return text;
}

static bvx_status check_mesh_format(bvx_context *ctx, const char *function, int32_t format,
                                    const bvx_write_options *o)
{
    switch (format) {
    case BVX_FORMAT_STL:
    case BVX_FORMAT_OFF:
    case BVX_FORMAT_3MF:
        if (!o->normals) break;
        return bvxi_fail(ctx, BVX_ERR_UNSUPPORTED, "%s: %s; take PLY, OBJ or GLB", function,
                         format == BVX_FORMAT_STL ? "STL holds normals of triangles only, and always has them"
                         : format == BVX_FORMAT_OFF ? "OFF is written without normals"
                                                    : "3MF holds no normals");
    case BVX_FORMAT_OBJ:
    case BVX_FORMAT_PLY:
    case BVX_FORMAT_GLB: break;
    default: return bvxi_fail_format(ctx, BVX_ERR_UNSUPPORTED, function, "mesh", format, BVX_MESHES_WRITTEN);
    }
    if ((!o->quantize && o->names == NULL) || format == BVX_FORMAT_GLB) return BVX_OK;
    return bvxi_fail(ctx, BVX_ERR_UNSUPPORTED, "%s: options.%s is for GLB; format is %d", function,
                     o->quantize ? "quantize" : "names", (int64_t)format);
}

/* The format is one of those that hold a mesh; only GLB holds several. GLB always has normals. */
static bvx_status write_format(bvx_context *ctx, const bvx_mesh *meshes, uint64_t count,
                               const bvx_write_options *o, int32_t format, bvx_buffer *file)
{
    normals_writer *const write = format == BVX_FORMAT_OBJ ? bvxi_write_obj : bvxi_write_ply;
    bvxi_written const plain = {meshes, 0, NULL};

    switch (format) {
    case BVX_FORMAT_STL: return bvxi_write_stl(ctx, meshes, file);
    case BVX_FORMAT_OFF: return bvxi_write_off(ctx, meshes, file);
    case BVX_FORMAT_3MF: return bvxi_write_3mf(ctx, meshes, file);
    case BVX_FORMAT_GLB:
        return count == 1 && bvxi_glb_keeps(meshes, o) ? bvxi_write_kept(ctx, meshes, o->source->assets, file)
                                                       : bvxi_write_glb(ctx, meshes, count, o, file);
    default: return o->normals ? write_with_normals(ctx, meshes, write, file) : write(ctx, &plain, file);
    }
}

/* The meshes of one file are checked; rounding is looked at before anything is made. */
static bvx_status write_checked(bvx_context *ctx, const char *function, const bvx_mesh *meshes,
                                uint64_t count, const bvx_write_options *o, int32_t format, bvx_buffer *file)
{
    char name[BVXI_LEVEL_NAME];
    bvx_buffer made = {0};
    bvx_mesh *turned;
    bvxi_file_frame frame;

    BVXI_TRY(bvxi_find_frame(ctx, meshes, count, format, o->quantize, &frame));
    for (uint64_t l = 0; o->rounding == BVX_ROUNDING_REFUSE && l < count; l++)
        BVXI_TRY(bvxi_refuse_rounding(ctx, level_name(function, l, count, name), &meshes[l], format, &frame));

    BVXI_TRY(bvxi_turn_meshes(ctx, meshes, count, o->turn, &turned));
    BVXI_TRY(BVXI_SHARE(ctx, 0.4, 1.0,
                        write_format(ctx, turned != NULL ? turned : meshes, count, o, format, &made)));
    *file = made;
    return BVX_OK;
}

/* ---- what a file holds ---- */

static bvx_status count_positions(bvx_context *ctx, const bvx_mesh_view *view, uint64_t *different)
{
    uint32_t *representative;
    BVXI_TRY(BVXI_ARRAY(ctx, view->vertex_count, "the vertices' positions", representative));
    return bvxi_weld(ctx, view, representative, different);
}

static bvx_status check_file_view(bvx_context *ctx, const bvx_mesh_view *mesh, const bvx_mesh_view *file,
                                  int32_t format, int rounded, bvx_write_report *report)
{
    uint64_t before = 0, after = 0;

    /* Vertices that rounding has merged are the difference of
     * both counts; without rounding there is none to find. */
    if (rounded) {
        BVXI_TRY(bvxi_progress(ctx, "check", 0.1));
        BVXI_TRY(BVXI_SHARE(ctx, 0.1, 0.3, BVXI_SCOPE(ctx, count_positions(ctx, mesh, &before))));
        BVXI_TRY(bvxi_progress(ctx, "check", 0.3));
        BVXI_TRY(BVXI_SHARE(ctx, 0.3, 0.5, BVXI_SCOPE(ctx, count_positions(ctx, file, &after))));
    }
    report->merged = before - after;
    /* STL has no indices, so its readers weld: the check sees what they will see. */
    return BVXI_SHARE(ctx, rounded ? 0.5 : 0.0, 1.0,
                      bvx_mesh_check(ctx, file, format == BVX_FORMAT_STL, &report->file));
}

static bvx_status check_written_file(bvx_context *ctx, const char *name, const bvx_mesh *mesh, int32_t format,
                                     const bvxi_file_frame *frame, bvx_write_report *report)
{
    int const rounded = bvxi_is_rounded(mesh, format, frame);
    uint64_t const bytes = mesh->vertex_count * 3 * sizeof(double);
    bvxi_rounding rounding = {0};
    bvx_mesh_view view, file;
    double *positions = NULL;

    BVXI_TRY(bvxi_progress(ctx, "check", 0.0));
    bvx_mesh_view_of(mesh, &view);
    file = view;
    report->fits = 1;

    /* What rounding does is measured against the mesh as it is, before the positions are replaced. */
    if (rounded) {
        bvxi_measure_rounding(mesh, frame, &rounding);
        if (!rounding.finite)
            return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_TOO_FAR,
                                 "%s: the mesh has coordinates too large for the format's 32-bit floats; "
                                 "take PLY or OBJ",
                                 name);
        report->fits = bvxi_rounding_fits(&rounding, mesh->triangle_count);
        report->largest_move = rounding.largest_move;
        report->mean_edge = rounding.mean_edge;
        report->spoilt = rounding.spoilt;
    }

    if (rounded || mesh->frame[0] != 0.0 || mesh->frame[1] != 0.0 || mesh->frame[2] != 0.0) {
        BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, bytes, "the file's positions", &positions));
        /* The positions that readers get, where they are not simply those of the mesh. */
        for (uint64_t v = 0; v < mesh->vertex_count; v++) {
            double *const to = positions + 3 * (size_t)v;
            bvxi_world_position(mesh, v, to);
            if (!rounded) continue;
            double const p[3] = {to[0], to[1], to[2]};
            bvxi_round_position(frame, p, to);
        }
        file.positions = positions;
        file.position_type = BVX_F64;
        file.position_stride = 0;
    }
    return check_file_view(ctx, &view, &file, format, rounded, report);
}

/* A report for each level. Those of GLB share one frame; other formats have a file for each. */
static bvx_status report_files(bvx_context *ctx, const char *function, const bvx_mesh *levels,
                               uint64_t level_count, const bvx_write_options *o, int32_t format)
{
    char name[BVXI_LEVEL_NAME];
    bvxi_file_frame frame;
    bvx_mesh *turned;

    BVXI_TRY(bvxi_turn_meshes(ctx, levels, level_count, o->turn, &turned));
    if (turned != NULL) levels = turned;
    BVXI_TRY(bvxi_find_frame(ctx, levels, level_count, format, o->quantize, &frame));

    for (uint64_t l = 0; l < level_count; l++) {
        memset(&o->reports[l], 0, sizeof o->reports[l]);
        BVXI_TRY(
            BVXI_SHARE(ctx, (double)l / (double)level_count, (double)(l + 1) / (double)level_count,
                       BVXI_SCOPE(ctx, check_written_file(ctx, level_name(function, l, level_count, name),
                                                          &levels[l], format, &frame, &o->reports[l]))));
    }
    return BVX_OK;
}

static bvx_status run_write_mesh(bvx_context *context, const bvx_mesh *levels, uint64_t level_count,
                                 const bvx_write_options *options, int32_t format, bvx_buffer *file)
{
    static const char *const function = "bvx_write_mesh";
    bvx_write_options o;

    static const bvxi_option rows[] = {
        BVXI_SWITCH(bvx_write_options, normals),
        BVXI_CHOICE(bvx_write_options, rounding, BVX_ROUNDING_REFUSE, BVX_ROUNDING_ALLOW),
        BVXI_CHOICE(bvx_write_options, turn, BVX_TURN_NONE, BVX_TURN_Y_TO_Z),
        BVXI_SWITCH(bvx_write_options, quantize),
    };

    BVXI_TRY(bvxi_take_options(context, function, options, &o, sizeof o));
    BVXI_TRY(bvxi_check_options(context, function, &o, BVXI_OPTIONS(rows)));

    int reported = o.reports != NULL;
    if (levels == NULL) return bvxi_fail_null(context, function, "levels");
    if (!reported || file != NULL) BVXI_TRY(bvxi_renew_buffer(context, function, file));
    BVXI_TRY(check_mesh_format(context, function, format, &o));
    if (level_count > 1 && format != BVX_FORMAT_GLB && file != NULL)
        return bvxi_fail(context, BVX_ERR_UNSUPPORTED,
                         "%s: format %d does not hold levels; write one file a level, or take GLB", function,
                         (int64_t)format);

    if (file != NULL) BVXI_TRY(bvxi_progress(context, "write", 0.0));
    char name[BVXI_LEVEL_NAME];
    if (level_count == 0 || level_count > WRITTEN_LEVELS)
        return bvxi_fail_for(context, level_count == 0 ? BVX_ERR_ARGUMENT : BVX_ERR_RANGE,
                             level_count == 0 ? BVX_REASON_RANGE : BVX_REASON_TOO_MANY,
                             "%s: level_count is %u; 1 to %u levels make a file", function, level_count,
                             (uint64_t)WRITTEN_LEVELS);
    for (uint64_t l = 0; l < level_count; l++)
        BVXI_TRY(check_written_mesh(context, level_name(function, l, level_count, name), &levels[l]));
    if (reported)
        BVXI_TRY(BVXI_SHARE(context, 0.0, file != NULL ? 0.5 : 1.0,
                            report_files(context, function, levels, level_count, &o, format)));
    if (file == NULL) return BVX_OK;
    return BVXI_SHARE(context, reported ? 0.5 : 0.0, 1.0,
                      write_checked(context, function, levels, level_count, &o, format, file));
}

bvx_status bvx_write_mesh(bvx_context *context, const bvx_mesh *levels, uint64_t level_count,
                          const bvx_write_options *options, int32_t format, bvx_buffer *file)
{
    return BVXI_CALL(context, run_write_mesh(context, levels, level_count, options, format, file));
}
