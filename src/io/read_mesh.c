/* read_mesh.c - a mesh from the bytes of a file: the checks around the readers, and what they share. */
#include "io/formats.h"
#include "mesh/finite.h"

enum { SOURCE_ASK_BYTES = 1 << 20, SOURCE_WORD_SHOWN = 24, SOURCE_GROUP = 64 };

void bvxi_source_pass(bvxi_source *source, double from, double to)
{
    source->ask = source->begin;
    source->from = from;
    source->to = to;
}

bvx_status bvxi_source_ask(bvxi_source *source, const char *at)
{
    double const done = (double)(at - source->begin) / (double)(source->end - source->begin);
    double const fraction = source->from + (source->to - source->from) * done;
    source->ask = source->end - at > SOURCE_ASK_BYTES ? at + SOURCE_ASK_BYTES : source->end;
    if (source->ask == at) return BVX_OK;
    if (fraction > source->reached) source->reached = fraction;
    return bvxi_progress(source->ctx, "read", source->reached);
}

typedef struct source_group {
    bvx_task_fn *task;
    void *user;
    int32_t first;
} source_group;

static void source_run_piece(void *user, int32_t index, int32_t worker)
{
    const source_group *const g = user;
    g->task(g->user, g->first + index, worker);
}

/* A few pieces at a time, so that a large file asks for progress as often as a small one. */
bvx_status bvxi_source_pieces(bvxi_source *source, double from, double to, int32_t count, bvx_task_fn *task,
                              void *user)
{
    double const share = (to - from) / (double)count;

    for (int32_t i = 0; i < count; i += SOURCE_GROUP) {
        int32_t const n = count - i < SOURCE_GROUP ? count - i : SOURCE_GROUP;
        source_group g = {task, user, 0};
        g.first = i;
        source->reached = i + n == count ? to : from + share * (double)(i + n);
        BVXI_TRY(bvxi_parallel(source->ctx, "read", from + share * (double)i, source->reached, n,
                               source_run_piece, &g));
    }
    return BVX_OK;
}

uint64_t bvxi_source_line(const bvxi_source *source, const char *at)
{
    uint64_t n = 1;
    for (const char *p = source->begin; p < at; p++) /* a lone carriage return ends a line too */
        n += *p == '\n' || (*p == '\r' && (p + 1 == source->end || p[1] != '\n'));
    return n;
}

bvx_status bvxi_fail_expected(const bvxi_source *source, const char *at, const char *expected)
{
    char word[SOURCE_WORD_SHOWN + 4];
    const char *const stop = bvxi_skip_word(at, source->end);
    size_t const n = (size_t)(stop - at);
    size_t const shown = n < SOURCE_WORD_SHOWN ? n : SOURCE_WORD_SHOWN;

    if (source->ctx == NULL) return BVX_ERR_FORMAT;
    if (at == source->end)
        return bvxi_fail(source->ctx, BVX_ERR_FORMAT, "%s: line %u: the file ends where %s was expected",
                         source->format, bvxi_source_line(source, at), expected);
    if (n == 0)
        return bvxi_fail(source->ctx, BVX_ERR_FORMAT, "%s: line %u: the line ends where %s was expected",
                         source->format, bvxi_source_line(source, at), expected);
    memcpy(word, at, shown);
    for (size_t i = 0; i < shown; i++)
        if (word[i] == 0) word[i] = '?';
    memcpy(word + shown, n > shown ? "..." : "", n > shown ? 4 : 1);
    return bvxi_fail(source->ctx, BVX_ERR_FORMAT, "%s: line %u: expected %s, found '%s'", source->format,
                     bvxi_source_line(source, at), expected, word);
}

bvx_status bvxi_make_positions(bvx_context *ctx, bvx_mesh *mesh, int32_t type, uint64_t count)
{
    BVXI_TRY(bvxi_alloc(ctx, BVXI_RESULT, count * (type == BVX_F64 ? 24 : 12), "the vertices of the file",
                        &mesh->positions));
    mesh->position_type = type;
    mesh->vertex_count = mesh->vertex_capacity = count;
    mesh->owned = 1;
    return BVX_OK;
}

bvx_status bvxi_make_triangles(bvx_context *ctx, bvx_mesh *mesh, uint64_t count)
{
    BVXI_TRY(bvxi_alloc(ctx, BVXI_RESULT, count * 12, "the triangles of the file", &mesh->triangles));
    mesh->triangle_count = mesh->triangle_capacity = count;
    mesh->owned = 1;
    return BVX_OK;
}

bvx_status bvxi_make_colours(bvx_context *ctx, bvx_mesh *mesh)
{
    return bvxi_alloc(ctx, BVXI_RESULT, mesh->vertex_capacity * 4, "the colours of the file", &mesh->colours);
}

bvx_status bvxi_make_uvs(bvx_context *ctx, bvx_mesh *mesh, uint64_t count)
{
    BVXI_TRY(bvxi_alloc(ctx, BVXI_RESULT, count * 8, "the texture coordinates of the file", &mesh->uvs));
    mesh->uv_count = count;
    return BVX_OK;
}

bvx_status bvxi_make_uv_triangles(bvx_context *ctx, bvx_mesh *mesh)
{
    return bvxi_alloc(ctx, BVXI_RESULT, mesh->triangle_capacity * 12, "the texture numbers of the file",
                      &mesh->uv_triangles);
}

void bvxi_drop_colours(bvx_context *ctx, bvx_mesh *mesh)
{
    bvxi_free(ctx, mesh->colours, mesh->vertex_capacity * 4);
    mesh->colours = NULL;
}

void bvxi_drop_uvs(bvx_context *ctx, bvx_mesh *mesh)
{
    bvxi_free(ctx, mesh->uv_triangles, mesh->triangle_capacity * 12);
    bvxi_free(ctx, mesh->uvs, mesh->uv_count * 8);
    mesh->uv_triangles = NULL;
    mesh->uvs = NULL;
    mesh->uv_count = 0;
}

int bvxi_mesh_is_empty(const bvx_mesh *m)
{
    return m->positions == NULL && m->triangles == NULL && m->vertex_keys == NULL &&
           m->triangle_keys == NULL && m->colours == NULL && m->uvs == NULL && m->uv_triangles == NULL;
}

static bvx_status read_mesh_as(bvxi_source *source, int32_t format, bvx_mesh *mesh)
{
    source->format = format == BVX_FORMAT_STL   ? "STL"
                     : format == BVX_FORMAT_OBJ ? "OBJ"
                     : format == BVX_FORMAT_PLY ? "PLY"
                                                : "OFF";
    if (source->begin == source->end)
        return bvxi_fail(source->ctx, BVX_ERR_EMPTY, "%s: the file has no bytes", source->format);
    bvxi_source_pass(source, 0, 1);
    switch (format) {
    case BVX_FORMAT_STL: return bvxi_read_stl(source, mesh);
    case BVX_FORMAT_OBJ: return bvxi_read_obj(source, mesh);
    case BVX_FORMAT_PLY: return bvxi_read_ply(source, mesh);
    default: return bvxi_read_off(source, mesh);
    }
}

/* dropped NULL: what is not finite is refused. */
static bvx_status run_read_mesh(bvx_context *context, const char *function, const void *bytes, uint64_t size,
                                int32_t format, uint64_t *dropped, bvx_mesh *mesh)
{
    bvxi_source source = {0};
    bvx_mesh made = {0};
    uint64_t count = 0;
    bvx_status status;

    if (context == NULL) return BVX_ERR_ARGUMENT;
    if (mesh == NULL) return bvxi_fail_null(context, function, "mesh");
    if (bytes == NULL) return bvxi_fail_null(context, function, "bytes");
    if (size > SIZE_MAX / 2)
        return bvxi_fail(context, BVX_ERR_ARGUMENT, "%s: size is %u, more than memory can hold", function,
                         size);
    if (format < 0 || format > BVX_FORMAT_SVG || (BVX_MESHES_READ >> format & 1) == 0)
        return bvxi_fail_format(context, BVX_ERR_ARGUMENT, function, "mesh that is read", format,
                                BVX_MESHES_READ);
    if (mesh->owned != 1 && !bvxi_mesh_is_empty(mesh))
        return bvxi_fail(context, BVX_ERR_ARGUMENT,
                         "%s: mesh brings arrays, which are not used; zero it first", function);
    source.ctx = context;
    source.begin = bytes;
    source.end = source.begin + (size_t)size;
    source.takes_any = dropped != NULL;
    status = read_mesh_as(&source, format, &made);
    if (status == BVX_OK && dropped != NULL) {
        status = bvxi_mesh_drop_nonfinite(context, function, &made, &count);
        if (status == BVX_OK && made.triangle_count == 0)
            status = bvxi_fail_for(context, BVX_ERR_EMPTY, BVX_REASON_NOT_FINITE,
                                   "%s: each of the %u triangles has a corner that is not finite",
                                   source.format, count);
    }
    if (status != BVX_OK) {
        bvx_mesh_free(context, &made);
        return status;
    }
    bvx_mesh_free(context, mesh);
    *mesh = made;
    if (dropped != NULL) *dropped = count;
    return BVX_OK;
}

bvx_status bvx_read_mesh(bvx_context *context, const void *bytes, uint64_t size, int32_t format,
                         bvx_mesh *mesh)
{
    return BVXI_CALL(context, run_read_mesh(context, "bvx_read_mesh", bytes, size, format, NULL, mesh));
}

bvx_status bvx_read_mesh_finite(bvx_context *context, const void *bytes, uint64_t size, int32_t format,
                                uint64_t *dropped, bvx_mesh *mesh)
{
    static const char *const function = "bvx_read_mesh_finite";
    if (context != NULL && dropped == NULL) return bvxi_fail_null(context, function, "dropped");
    return BVXI_CALL(context, run_read_mesh(context, function, bytes, size, format, dropped, mesh));
}
