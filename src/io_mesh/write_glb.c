/* write_glb.c - a mesh, or several levels of detail, to binary glTF 2.0 with the materials that a file had;
 * first vertices are repeated where their corners have several texture coordinates.
 *
 * Sources: Khronos Group. glTF 2.0 Specification. 2017. Khronos Group. KHR_mesh_quantization. Microsoft.
 * MSFT_lod. Guarantee: repeated vertices stand in the order of their first use. */
#include "io_mesh/glb.h"
#include "mesh/facet.h"
#include "mesh/view.h"

/* ---- Vertices repeated where their corners have several texture coordinates ---- */

/* Corners are sorted by vertex and texture coordinate; the sort keeps the order of equal ones, so the first
 * of each group is its first use. One more walk over the corners gives out the numbers.
 * Guarantee: the order is that of first use. Cost: O(corners), whatever the indices are. */

static bvx_status sort_corners(bvx_context *ctx, const bvx_mesh *mesh, bvxi_seams *seams)
{
    uint64_t const corners = mesh->triangle_count * 3;
    uint64_t *keys = NULL;
    uint32_t *corner = NULL;

    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, corners * 8, "the corners' keys", &keys));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, corners * 4, "the corners' numbers", &corner));
    for (uint64_t c = 0; c < corners; c++) {
        /* Vertex above, texture coordinate below: equal keys
         * are corners that can share one vertex of the file. */
        keys[c] = (uint64_t)mesh->triangles[c] << 32 | mesh->uv_triangles[c];
        corner[c] = (uint32_t)c;
    }
    BVXI_TRY(bvxi_radix_sort(ctx, keys, corner, corners));

    /* first[corner] becomes the first corner with the same pair. Returns how many pairs there are. */
    uint64_t pairs = 0;
    uint32_t leader = 0;

    for (uint64_t i = 0; i < corners; i++) {
        if (i == 0 || keys[i] != keys[i - 1]) {
            leader = corner[i];
            pairs++;
        }
        seams->triangles[corner[i]] = leader;
    }
    seams->count = pairs;
    return BVX_OK;
}

/* Vertices as written are the pairs of vertex and texture coordinate that corners
 * have, in the order of their first use. The mesh has uv_triangles and fewer than
 * 2^32 corners. On failure nothing is held. Scratch: 28 bytes a corner. */
static bvx_status split_seams(bvx_context *ctx, const bvx_mesh *mesh, bvxi_seams *seams)
{
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, mesh->triangle_count * 12, "the triangles with seams",
                        &seams->triangles));
    BVXI_TRY(BVXI_SCOPE(ctx, sort_corners(ctx, mesh, seams)));

    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, seams->count * 4, "the vertices at seams", &seams->vertex));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, seams->count * 4, "the texture coordinates at seams", &seams->uv));

    /* A corner that is the first of its pair gets the next number; the others have been given theirs
     * before. */
    uint32_t n = 0;

    for (uint64_t c = 0; c < mesh->triangle_count * 3; c++) {
        if (seams->triangles[c] == c) {
            seams->vertex[n] = mesh->triangles[c];
            seams->uv[n] = mesh->uv_triangles[c];
            seams->triangles[c] = n++;
        } else {
            /* The leader comes before its group, so its entry is
             * an index of the file by now, no longer a corner. */
            seams->triangles[c] = seams->triangles[seams->triangles[c]];
        }
    }
    return BVX_OK;
}

/* ---- A mesh to binary glTF 2.0, or several levels of detail to one such file ---- */

/* Source: Khronos. glTF 2.0 Specification (ISO/IEC 12113:2022).
 * Attributes are those of the mesh; where it has no normals they are smooth, over seams of the texture too.
 * Positions in 32-bit floats go out as they are, others as floats relative to the centre of the bounds, which
 * nodes carry as doubles: so a mesh far from the origin keeps its shape. Levels share one centre, since some
 * readers swap meshes below one node; the arrays of a level follow those of the one before it. Colours become
 * linear light with 16 bits; the texture's v runs down in glTF, so it is turned over. Indices have 16 bits
 * where they suffice: half the size, and all that older graphics interfaces draw. Materials, textures and
 * images are copied as they are. */

#define GLB_PREPARED   0.5   /* share of the work before the first byte is written */
#define GLB_NORMAL_ONE 127.0 /* a component of 1 in a signed byte */

enum { GLB_PARTS = BVXI_GLB_ARRAYS + 1 }; /* of a level: its arrays and the padding after them */
/* the file's head with that of its first chunk; the head of the second */
enum { GLB_HEAD = 20, GLB_CHUNK = 8 };

/* ---- what is written ---- */

static size_t glb_source(const bvxi_glb *glb, uint64_t vertex)
{
    return glb->seams.vertex != NULL ? glb->seams.vertex[vertex] : (size_t)vertex;
}

/* Relative to the frame, in its steps where it has some. */
static void glb_position(const bvxi_glb *glb, uint64_t vertex, double p[3])
{
    const bvxi_file_frame *const frame = glb->frame;
    bvxi_world_position(glb->mesh, glb_source(glb, vertex), p);
    for (int a = 0; a < 3; a++) {
        if (frame->step > 0.0) p[a] = bvxi_frame_steps(frame, a, p[a]);
        else if (frame->origin[a] != 0.0)
            p[a] -= frame->origin[a]; /* to take 0 would change nothing but -0 */
    }
}

static uint8_t *glb_put_positions(const void *user, uint64_t begin, uint64_t end, uint8_t *at)
{
    const bvxi_glb *const glb = user;
    double p[3];

    for (uint64_t v = begin; v < end; v++) {
        glb_position(glb, v, p);
        if (glb->frame->step > 0.0) {
            for (int a = 0; a < 3; a++) bvxi_store_u16(at + 2 * a, (uint16_t)p[a]);
            bvxi_store_u16(at + 6, 0); /* arrays are read in fours of bytes */
            at += 8;
        } else
            for (int a = 0; a < 3; a++, at += 4) bvxi_store_f32(at, (float)p[a]);
    }
    return at;
}

static uint8_t *glb_put_normals(const void *user, uint64_t begin, uint64_t end, uint8_t *at)
{
    const bvxi_glb *const glb = user;
    float n[3];

    /* One sum for each vertex of the mesh, not of the file: seams of the texture do not show in the light. */
    for (uint64_t v = begin; v < end; v++) {
        bvxi_written_normal(glb->mesh, glb->normal, glb_source(glb, v), n);
        if (glb->frame->step > 0.0) {
            for (int a = 0; a < 3; a++)
                at[a] = (uint8_t)((int32_t)floor((double)n[a] * GLB_NORMAL_ONE + 0.5) & 255);
            at[3] = 0;
            at += 4;
        } else
            for (int a = 0; a < 3; a++, at += 4) bvxi_store_f32(at, n[a]);
    }
    return at;
}

static uint8_t *glb_put_colours(const void *user, uint64_t begin, uint64_t end, uint8_t *at)
{
    const bvxi_glb *const glb = user;
    for (uint64_t v = begin; v < end; v++, at += 8) {
        const uint8_t *const colour = glb->mesh->colours + glb_source(glb, v) * 4;
        for (int c = 0; c < 3; c++) bvxi_store_u16(at + 2 * c, glb_linear_light[colour[c]]);
        bvxi_store_u16(at + 6, (uint16_t)(colour[3] * 257));
    }
    return at;
}

/* One pair. v runs down in glTF; the difference is taken in doubles, so it is rounded once. */
static uint8_t *glb_put_uv(const float uv[2], int32_t component, uint8_t *at)
{
    double const pair[2] = {(double)uv[0], 1.0 - (double)uv[1]};
    for (int a = 0; a < 2; a++) {
        if (component == BVXI_GLB_U16) bvxi_store_u16(at + 2 * a, (uint16_t)(pair[a] * UINT16_MAX + 0.5));
        else bvxi_store_f32(at + 4 * a, (float)pair[a]);
    }
    return at + (component == BVXI_GLB_U16 ? 4 : 8);
}

static uint8_t *glb_put_uvs(const void *user, uint64_t begin, uint64_t end, uint8_t *at)
{
    const bvxi_glb *const glb = user;
    for (uint64_t v = begin; v < end; v++) {
        size_t const i = glb->seams.uv != NULL ? glb->seams.uv[v] : (size_t)v;
        at = glb_put_uv(glb->mesh->uvs + 2 * i, glb->kind[BVXI_GLB_UV].component, at);
    }
    return at;
}

static uint8_t *glb_put_second_uvs(const void *user, uint64_t begin, uint64_t end, uint8_t *at)
{
    const bvxi_glb *const glb = user;
    for (uint64_t v = begin; v < end; v++)
        at = glb_put_uv(glb->mesh->uvs2 + 2 * glb_source(glb, v), glb->kind[BVXI_GLB_UV2].component, at);
    return at;
}

static uint8_t *glb_put_indices(const void *user, uint64_t begin, uint64_t end, uint8_t *at)
{
    const bvxi_glb *const glb = user;
    const uint32_t *const index = glb->seams.triangles != NULL ? glb->seams.triangles : glb->mesh->triangles;
    for (uint64_t i = begin; i < end; i++) {
        uint64_t const from = glb->order != NULL ? (uint64_t)glb->order[i / 3] * 3 + i % 3 : i;
        if (glb->kind[BVXI_GLB_INDEX].size == 2) bvxi_store_u16(at, (uint16_t)index[from]);
        else bvxi_store_u32(at, index[from]);
        at += glb->kind[BVXI_GLB_INDEX].size;
    }
    return at;
}

static uint8_t *glb_put_image(const void *user, uint64_t begin, uint64_t end, uint8_t *at)
{
    memcpy(at, ((const bvxi_asset_image *)user)->bytes + begin, (size_t)(end - begin));
    return at + (end - begin);
}

static uint8_t *glb_put_padding(const void *user, uint64_t begin, uint64_t end, uint8_t *at)
{
    (void)user;
    memset(at, 0, (size_t)(end - begin));
    return at + (end - begin);
}

/* ---- the file ---- */

uint8_t *bvxi_glb_put_head(uint64_t json, uint64_t end, bvx_buffer *file)
{
    uint8_t *const p = file->bytes;
    uint64_t const padded = bvxi_glb_padded(json);

    memcpy(p, "glTF", 4);
    bvxi_store_u32(p + 4, 2);
    bvxi_store_u32(p + 8, (uint32_t)file->size);
    bvxi_store_u32(p + 12, (uint32_t)padded);
    memcpy(p + 16, "JSON", 4);

    /* JSON is padded with spaces, which it ignores; the binary
     * chunk after it begins at a multiple of four bytes. */
    memset(p + GLB_HEAD + json, ' ', (size_t)(padded - json));

    bvxi_store_u32(p + GLB_HEAD + padded, (uint32_t)bvxi_glb_padded(end));
    memcpy(p + GLB_HEAD + padded + 4, "BIN", 4); /* with its zero */
    return p + GLB_HEAD;
}

/* part [Size: levels * GLB_PARTS + images * 2] */
static void glb_list_parts(const bvxi_glb_file *glb, bvxi_file_part *part)
{
    static const bvxi_file_part parts[GLB_PARTS] = {
        {.put = glb_put_positions},  {.put = glb_put_normals}, {.put = glb_put_colours}, {.put = glb_put_uvs},
        {.put = glb_put_second_uvs}, {.put = glb_put_indices}, {.put = glb_put_padding}};

    for (uint64_t l = 0; l < glb->levels; l++, part += GLB_PARTS) {
        const bvxi_glb *const level = &glb->level[l];
        memcpy(part, parts, sizeof parts);
        for (int i = 0; i < BVXI_GLB_ARRAYS; i++) {
            part[i].count = level->count[i];
            part[i].most = level->kind[i].size;
            part[i].user = level;
        }
        part[BVXI_GLB_ARRAYS].count = bvxi_glb_padded(level->end) - level->end;
        part[BVXI_GLB_ARRAYS].most = 1;
    }

    for (uint64_t i = 0; i < bvxi_glb_images(glb); i++, part += 2) {
        const bvxi_asset_image *const image = &glb->assets->images[i];
        bvxi_file_part const two[2] = {
            {.count = image->size, .most = 1, .put = glb_put_image, .user = image},
            {.count = bvxi_glb_padded(image->size) - image->size, .most = 1, .put = glb_put_padding}};
        memcpy(part, two, sizeof two);
    }
}

static bvx_status glb_make_file(bvx_context *ctx, const bvxi_glb_file *glb, bvx_buffer *file)
{
    uint64_t const parts = glb->levels * GLB_PARTS + bvxi_glb_images(glb) * 2;
    bvxi_output json = {0};
    bvxi_file_part *part;

    bvxi_glb_put_json(glb, &json);
    uint64_t const head = GLB_HEAD + bvxi_glb_padded(json.size) + GLB_CHUNK;
    BVXI_TRY(bvxi_glb_check_size(ctx, head + bvxi_glb_padded(glb->end), glb->levels));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, parts * sizeof *part, "the list of arrays", &part));
    glb_list_parts(glb, part);
    /* Arrays are written before the head: the head needs the size that the file has in the end. */
    BVXI_TRY(bvxi_make_file(ctx, "the GLB file", GLB_PREPARED, head, part, (int32_t)parts, file));
    json.bytes = bvxi_glb_put_head(json.size, glb->end, file);
    json.size = 0;
    bvxi_glb_put_json(glb, &json);
    return BVX_OK;
}

/* ---- what is known before the first byte ---- */

/* Bounds of the positions as they are written; all must be floats. */
static bvx_status glb_find_bounds(bvx_context *ctx, const char *name, bvxi_glb *glb)
{
    double p[3];

    /* Steps of an extent that is no double would all be 0. */
    if (!(glb->frame->step * BVXI_STEPS < BVXI_FLOAT_LIMIT))
        return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_TOO_FAR,
                             "%s: the mesh is too large for steps of 32-bit floats; take PLY or OBJ", name);
    for (uint64_t v = 0; v < glb->vertices; v++) {
        glb_position(glb, v, p);
        for (int a = 0; a < 3; a++) {
            /* As bounds of the floats that are written, since validators compare them with those. */
            float const f = (float)p[a];
            if (!(p[a] < BVXI_FLOAT_LIMIT && p[a] > -BVXI_FLOAT_LIMIT))
                return bvxi_fail_for(
                    ctx, BVX_ERR_RANGE, BVX_REASON_TOO_FAR,
                    "%s: vertex %i is %g from the middle of the mesh, too far for the format's 32-bit "
                    "floats; take PLY or OBJ",
                    name, (uint64_t)glb_source(glb, v), p[a]);
            if (v == 0 || f < glb->low[a]) glb->low[a] = f;
            if (v == 0 || f > glb->high[a]) glb->high[a] = f;
        }
    }
    return BVX_OK;
}

/* 1 when all texture coordinates are in 0..1, where 16 bits hold them. */
static int glb_in_unit(const float *uvs, uint64_t count)
{
    for (uint64_t i = 0; i < count * 2; i++)
        if (!(uvs[i] >= 0.0f && uvs[i] <= 1.0f)) return 0;
    return 1;
}

/* Sort triangles by material: counts, which become where each group begins; order keeps that of the mesh. */
static bvx_status glb_group_triangles(bvx_context *ctx, uint64_t materials, bvxi_glb *level)
{
    const uint32_t *const of = materials != 0 ? level->mesh->materials : NULL;
    uint64_t const triangles = level->mesh->triangle_count;

    /* Group g is counted at g + 2 and its triangles are placed from g + 1 on, which is then where it ends. */
    BVXI_TRY(BVXI_ZEROS(ctx, materials + 3, "the triangles of each material", level->group));
    uint64_t *const next = level->group + 1;
    if (of == NULL) {
        next[materials] = triangles;
        return BVX_OK;
    }
    for (uint64_t t = 0; t < triangles; t++) next[(of[t] < materials ? of[t] : materials) + 1]++;
    for (uint64_t g = 0; g < materials; g++) next[g + 1] += next[g];

    BVXI_TRY(BVXI_ARRAY(ctx, triangles, "the triangles by material", level->order));
    for (uint64_t t = 0; t < triangles; t++)
        level->order[next[of[t] < materials ? of[t] : materials]++] = (uint32_t)t;
    return BVX_OK;
}

static bvx_status glb_plan_level(bvx_context *ctx, const bvxi_glb_file *glb, uint64_t l)
{
    bvxi_glb *const level = &glb->level[l];
    const bvx_mesh *const mesh = level->mesh;
    uint64_t const begin = l > 0 ? bvxi_glb_padded(level[-1].end) : 0;
    char name[BVXI_LEVEL_NAME] = "GLB";
    bvx_mesh_view view;

    if (glb->levels > 1) bvxi_level_name("GLB", l, name);

    /* Also keeps the corners below 2^32, as splitting needs it. */
    BVXI_TRY(bvxi_glb_check_size(ctx, begin + mesh->triangle_count * 6, glb->levels));
    if (mesh->uv_triangles != NULL) BVXI_TRY(split_seams(ctx, mesh, &level->seams));
    level->vertices = mesh->uv_triangles != NULL ? level->seams.count : mesh->vertex_count;
    if (mesh->uvs != NULL) level->uv_unit = glb_in_unit(mesh->uvs, bvxi_written_uvs(mesh));
    if (mesh->uvs2 != NULL) level->uv2_unit = glb_in_unit(mesh->uvs2, mesh->vertex_count);
    bvxi_glb_layout(level, begin);
    BVXI_TRY(bvxi_glb_check_size(ctx, level->end, glb->levels));
    BVXI_TRY(bvxi_progress(ctx, "write", ((double)l + 0.6) / (double)glb->levels * GLB_PREPARED));
    BVXI_TRY(glb_find_bounds(ctx, name, level));
    BVXI_TRY(glb_group_triangles(ctx, glb->materials, level));

    /* Normals come last: they need memory, which a mesh that does not fit should not cost. */
    if (mesh->normals != NULL) return BVX_OK;
    bvx_mesh_view_of(mesh, &view);
    return bvxi_sum_normals(ctx, &view, 1.0, &level->normal);
}

bvx_status bvxi_write_glb(bvx_context *ctx, const bvx_mesh *levels, uint64_t level_count,
                          const bvx_write_options *options, bvx_buffer *file)
{
    bvxi_glb_file glb = {.levels = level_count};
    uint64_t const bytes = level_count * sizeof *glb.level;

    BVXI_TRY(bvxi_progress(ctx, "write", 0.0));
    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, bytes, "the list of levels", &glb.level));
    /* One frame for all: a level with one of its own would jump when a reader swaps it in. */
    BVXI_TRY(bvxi_find_frame(ctx, levels, level_count, BVX_FORMAT_GLB, options->quantize, &glb.frame));
    for (uint64_t l = 0; l < level_count; l++) {
        glb.level[l].mesh = &levels[l];
        glb.level[l].frame = &glb.frame;
    }
    glb.names = options->names;
    glb.colours = options->names != NULL ? options->colours : NULL;
    /* The file's materials are those of the source, or of the first level that has some. */
    if (glb.colours == NULL) {
        int colours = 0;
        if (options->source != NULL) glb.assets = options->source->assets;
        for (uint64_t l = 0; l < glb.levels; l++) {
            const bvx_mesh *const mesh = glb.level[l].mesh;
            if (options->source == NULL && glb.assets == NULL) glb.assets = mesh->assets;
            colours |= mesh->colours != NULL;
        }
        if (glb.assets != NULL && glb.assets->materials != NULL) glb.materials = glb.assets->material_count;
        glb.matte = colours && glb.materials == 0;
    }

    for (uint64_t l = 0; l < level_count; l++) BVXI_TRY(glb_plan_level(ctx, &glb, l));
    glb.end = glb.level[level_count - 1].end;
    for (uint64_t i = 0; i < bvxi_glb_images(&glb); i++) {
        glb.end = bvxi_glb_padded(glb.end) + glb.assets->images[i].size;
        BVXI_TRY(bvxi_glb_check_size(ctx, glb.end, level_count));
    }
    return glb_make_file(ctx, &glb, file);
}
