/* read_gltf.c - the meshes of a glTF scene, put where their nodes say, as one mesh.
 *
 * Source: Khronos Group. glTF 2.0 Specification (ISO/IEC 12113:2022). All primitives of all nodes of the scene
 * follow each other in the order of nodes; a mesh that several nodes have is repeated. Vertices stay as the
 * file has them: along a seam of attributes it has several at one position. Primitives that follow each other
 * with the same accessors share their vertices. What only some primitives have is made up for the others.
 *
 * Guarantee: all counts are held against the bytes of the file before anything is made of their size; no more
 * than GLTF_REPEATS times these come of them, however often nodes repeat a mesh. Cost: O(bytes + mesh). */
#include "io_mesh/gltf.h"
#include "io_mesh/glb.h"
#include "mesh/facet.h"
#include "mesh/view.h"

enum { GLTF_POSITION, GLTF_NORMAL, GLTF_UV, GLTF_UV2, GLTF_COLOUR, GLTF_ATTRIBUTES };
enum { GLTF_TRIANGLES = 4, GLTF_STRIP = 5, GLTF_FAN = 6 };
enum { GLTF_REPEATS = 4000, GLTF_VERTEX_BYTES = 72, GLTF_TRIANGLE_BYTES = 16 };

/* Positions are floats where these resolve the mesh to a part in so many of its longest side, however far
 * from the origin nodes put it. */
#define GLTF_FAR 16.0

typedef struct gltf_primitive {
    uint32_t attribute[GLTF_ATTRIBUTES]; /* accessors, or BVXI_JSON_NONE */
    uint32_t indices;                    /* accessor, or BVXI_JSON_NONE */
    uint32_t material;
    uint32_t value; /* of the JSON */
    int32_t mode;
    int32_t shares;   /* 1: the vertices of the primitive before it */
    uint64_t corners; /* indices, or vertices without */
    uint64_t vertices, triangles;
} gltf_primitive;

typedef struct gltf_mesh {
    uint32_t first, count;        /* of its primitives that have triangles */
    uint64_t vertices, triangles; /* of all of them */
} gltf_mesh;

typedef struct gltf_reader {
    bvxi_gltf f;
    bvxi_gltf_scene scene;
    gltf_primitive *primitive; /* scratch */
    gltf_mesh *mesh;           /* scratch */
    uint32_t *mesh_of;         /* of each node that is drawn, or BVXI_JSON_NONE; scratch */
    uint32_t *corner;          /* indices of one primitive; scratch */
    uint64_t vertices, triangles, most_corners;
    int has[GLTF_ATTRIBUTES]; /* 1: a primitive has it */
    int lacks_normals;        /* 1: a primitive has none */
    int unkept;          /* 1: two nodes have one mesh, or a primitive has its triangles compressed too */
    uint64_t primitives; /* of meshes that are drawn */
    bvx_mesh *out;
    uint64_t vertex, triangle; /* written so far */
} gltf_reader;

/* ---- primitives ---- */

static const struct {
    const char *name;
    int32_t least, most; /* components */
} gltf_attributes[GLTF_ATTRIBUTES] = {
    {"POSITION", 3, 3}, {"NORMAL", 3, 3}, {"TEXCOORD_0", 2, 2}, {"TEXCOORD_1", 2, 2}, {"COLOR_0", 3, 4},
};

/* What attributes there are beside those that are read. Tangents follow from the others. */
static void gltf_note_attributes(gltf_reader *r, uint32_t attributes)
{
    const bvxi_json *const j = &r->f.json;

    if (bvxi_json_kind(j, attributes) != BVXI_JSON_OBJECT) return;
    for (uint32_t k = attributes + 1; k < j->value[attributes].next; k = j->value[k + 1].next) {
        uint32_t size;
        const char *const name = bvxi_json_text(j, k, &size);
        int known = bvxi_json_is(j, k, "TANGENT");

        for (int a = 0; a < GLTF_ATTRIBUTES; a++) known |= bvxi_json_is(j, k, gltf_attributes[a].name);
        if (known) continue;
        r->f.lost |= (size > 7 && memcmp(name, "JOINTS_", 7) == 0) ||
                             (size > 8 && memcmp(name, "WEIGHTS_", 8) == 0)
                         ? BVX_LOST_SKINS
                         : BVX_LOST_ATTRIBUTES;
    }
}

static bvx_status gltf_check_attribute(gltf_reader *r, uint32_t mesh, int which, gltf_primitive *p)
{
    bvxi_gltf *const f = &r->f;
    bvxi_gltf_array a;

    if (p->attribute[which] == BVXI_JSON_NONE) return BVX_OK;
    BVXI_TRY(bvxi_gltf_array_of(f, p->attribute[which], &a));
    if (a.components < gltf_attributes[which].least || a.components > gltf_attributes[which].most ||
        a.type == BVXI_GLTF_U32)
        return BVXI_FILE_FAIL(f->source, BVX_ERR_FORMAT, "mesh %u: accessor %u is no %s by its type",
                              (uint64_t)mesh, (uint64_t)p->attribute[which], gltf_attributes[which].name);
    if (which == GLTF_POSITION) p->vertices = a.count;
    if (a.count != p->vertices)
        return BVXI_FILE_FAIL(f->source, BVX_ERR_FORMAT, "mesh %u has %u vertices and %u values of %s",
                              (uint64_t)mesh, p->vertices, a.count, gltf_attributes[which].name);
    return BVX_OK;
}

/* Vertices that came with KHR_draco_mesh_compression alone have accessors without bytes. */
static bvx_status gltf_refuse_draco(gltf_reader *r, uint32_t value, const gltf_primitive *p)
{
    static const char draco[] = "KHR_draco_mesh_compression";
    bvxi_gltf *const f = &r->f;
    bvxi_gltf_array a;

    if (bvxi_json_member(&f->json, bvxi_json_member(&f->json, value, "extensions"), draco) == BVXI_JSON_NONE)
        return BVX_OK;
    r->unkept = 1;
    BVXI_TRY(bvxi_gltf_array_of(f, p->attribute[GLTF_POSITION], &a));
    return a.at != NULL
               ? BVX_OK
               : BVXI_FILE_FAIL(f->source, BVX_ERR_UNSUPPORTED,
                                "its meshes are compressed by %s, which is not read; export the file "
                                "without mesh compression",
                                draco);
}

/* Where it has no triangles, p->triangles is 0 and the rest is not set. */
static bvx_status gltf_take_primitive(gltf_reader *r, uint32_t mesh, uint32_t value, gltf_primitive *p)
{
    bvxi_gltf *const f = &r->f;
    uint32_t const attributes = bvxi_json_member(&f->json, value, "attributes");
    uint64_t mode;

    memset(p, 0, sizeof *p);
    p->value = value;
    if (bvxi_json_kind(&f->json, value) != BVXI_JSON_OBJECT)
        return bvxi_gltf_fail(f, BVXI_GLTF_MESH, mesh, "a primitive is not an object");
    BVXI_TRY(bvxi_gltf_whole(f, BVXI_GLTF_MESH, mesh, value, "mode", GLTF_TRIANGLES, &mode));
    if (mode > GLTF_FAN) return bvxi_gltf_fail(f, BVXI_GLTF_MESH, mesh, "the mode of a primitive is unknown");
    if (mode < GLTF_TRIANGLES) {
        f->lost |= BVX_LOST_POINTS;
        return BVX_OK;
    }
    p->mode = (int32_t)mode;
    if (bvxi_json_count(&f->json, bvxi_json_member(&f->json, value, "targets")) > 0)
        f->lost |= BVX_LOST_MORPHS;
    gltf_note_attributes(r, attributes);

    for (int a = 0; a < GLTF_ATTRIBUTES; a++)
        BVXI_TRY(bvxi_gltf_index(f, BVXI_GLTF_MESH, mesh, attributes, gltf_attributes[a].name,
                                 BVXI_GLTF_ACCESSOR, &p->attribute[a]));
    BVXI_TRY(bvxi_gltf_index(f, BVXI_GLTF_MESH, mesh, value, "indices", BVXI_GLTF_ACCESSOR, &p->indices));
    BVXI_TRY(bvxi_gltf_index(f, BVXI_GLTF_MESH, mesh, value, "material", BVXI_GLTF_MATERIAL, &p->material));
    if (p->material == BVXI_JSON_NONE) p->material = f->list_count[BVXI_GLTF_MATERIAL];
    if (p->attribute[GLTF_POSITION] == BVXI_JSON_NONE) return BVX_OK; /* allowed, and nothing to be drawn */
    BVXI_TRY(gltf_refuse_draco(r, value, p));
    for (int a = 0; a < GLTF_ATTRIBUTES; a++) BVXI_TRY(gltf_check_attribute(r, mesh, a, p));
    bvxi_gltf_array a;

    p->corners = p->vertices;
    if (p->indices != BVXI_JSON_NONE) {
        BVXI_TRY(bvxi_gltf_array_of(f, p->indices, &a));
        if (a.components != 1 ||
            (a.type != BVXI_GLTF_U8 && a.type != BVXI_GLTF_U16 && a.type != BVXI_GLTF_U32))
            return bvxi_gltf_fail(f, BVXI_GLTF_ACCESSOR, p->indices,
                                  "indices are unsigned whole numbers, one an element");
        p->corners = a.count;
    }
    if (p->mode == GLTF_TRIANGLES && p->corners % 3 != 0)
        return BVXI_FILE_FAIL(f->source, BVX_ERR_FORMAT, "mesh %u: %u corners are not triangles",
                              (uint64_t)mesh, p->corners);
    p->triangles = p->mode == GLTF_TRIANGLES ? p->corners / 3 : p->corners < 3 ? 0 : p->corners - 2;
    return BVX_OK;
}

static bvx_status gltf_take_mesh(gltf_reader *r, uint32_t mesh, uint32_t first)
{
    bvxi_gltf *const f = &r->f;
    gltf_mesh *const m = &r->mesh[mesh];
    uint32_t const list = bvxi_json_member(&f->json, f->list[BVXI_GLTF_MESH][mesh], "primitives");
    uint32_t const count = bvxi_json_count(&f->json, list);
    uint32_t value = list + 1;

    m->first = first;
    for (uint32_t i = 0; i < count; i++, value = f->json.value[value].next) {
        gltf_primitive *const p = &r->primitive[first + m->count];

        BVXI_TRY(gltf_take_primitive(r, mesh, value, p));
        if (p->triangles == 0) continue;
        p->shares = m->count > 0 && memcmp(p->attribute, p[-1].attribute, sizeof p->attribute) == 0;
        if (!p->shares) m->vertices += p->vertices;
        m->triangles += p->triangles;
        m->count++;
        if (p->corners > r->most_corners) r->most_corners = p->corners;
        for (int a = 0; a < GLTF_ATTRIBUTES; a++) r->has[a] |= p->attribute[a] != BVXI_JSON_NONE;
        r->lacks_normals |= p->attribute[GLTF_NORMAL] == BVXI_JSON_NONE;

        /* Checked at each step, so that no sum leaves 64 bits. */
        if (m->vertices > UINT32_MAX || m->triangles > INT32_MAX)
            return BVXI_FILE_FAIL_FOR(f->source, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                                      "mesh %u has %u vertices and %u triangles, limits are 2^32 and 2^31",
                                      (uint64_t)mesh, m->vertices, m->triangles);
    }
    return BVX_OK;
}

/* ---- the plan ---- */

static bvx_status gltf_mark_meshes(gltf_reader *r, uint8_t *wanted)
{
    bvxi_gltf *const f = &r->f;

    for (uint32_t i = 0; i < f->list_count[BVXI_GLTF_NODE]; i++) {
        uint32_t const value = f->list[BVXI_GLTF_NODE][i];

        r->mesh_of[i] = BVXI_JSON_NONE;
        if (!r->scene.drawn[i]) continue;
        BVXI_TRY(bvxi_gltf_index(f, BVXI_GLTF_NODE, i, value, "mesh", BVXI_GLTF_MESH, &r->mesh_of[i]));
        if (r->mesh_of[i] == BVXI_JSON_NONE) continue;
        r->unkept |= wanted[r->mesh_of[i]];
        wanted[r->mesh_of[i]] = 1;
        if (bvxi_json_member(&f->json, value, "skin") != BVXI_JSON_NONE) f->lost |= BVX_LOST_SKINS;
    }
    for (uint32_t i = 0; i < f->list_count[BVXI_GLTF_MESH]; i++) {
        uint32_t const list = bvxi_json_member(&f->json, f->list[BVXI_GLTF_MESH][i], "primitives");
        if (wanted[i] && bvxi_json_kind(&f->json, list) != BVXI_JSON_ARRAY)
            return bvxi_gltf_fail(f, BVXI_GLTF_MESH, i, "it has no array of primitives");
        if (wanted[i]) r->primitives += bvxi_json_count(&f->json, list);
    }
    return BVXI_ARRAY(f->source->ctx, r->primitives, "the primitives", r->primitive);
}

static bvx_status gltf_count_all(gltf_reader *r)
{
    bvxi_gltf *const f = &r->f;

    for (uint32_t i = 0; i < f->list_count[BVXI_GLTF_NODE]; i++) {
        if (r->mesh_of[i] == BVXI_JSON_NONE) continue;
        r->vertices += r->mesh[r->mesh_of[i]].vertices;
        r->triangles += r->mesh[r->mesh_of[i]].triangles;
        if (r->vertices > UINT32_MAX || r->triangles > INT32_MAX)
            return BVXI_FILE_FAIL_FOR(
                f->source, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                "its nodes have %u vertices and %u triangles or more, limits are 2^32 and "
                "2^31",
                r->vertices, r->triangles);
    }
    if (r->triangles == 0) return BVXI_FILE_FAIL(f->source, BVX_ERR_EMPTY, "there are no triangles");
    if ((r->vertices * GLTF_VERTEX_BYTES + r->triangles * GLTF_TRIANGLE_BYTES + r->most_corners * 4) /
            GLTF_REPEATS >
        f->bytes)
        return BVXI_FILE_FAIL_FOR(
            f->source, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
            "%u vertices and %u triangles of %u bytes: nodes or accessors repeat them more "
            "often than is read",
            r->vertices, r->triangles, f->bytes);
    return BVX_OK;
}

/* ---- values of one primitive ---- */

typedef struct gltf_target {
    gltf_reader *r;
    const bvxi_gltf_world *world;
    double normal[3][3]; /* what turns normals */
    int flips;           /* 1: the matrix mirrors, so triangles turn round */
    uint32_t mesh;
    uint64_t base;          /* where its vertices begin */
    uint64_t limit;         /* of indices */
    double low[3], high[3]; /* of finite positions */
    float *uvs;             /* of the attribute at hand */
} gltf_target;

static void gltf_world_position(const bvxi_gltf_world *w, const double v[3], double p[3])
{
    for (int a = 0; a < 3; a++) p[a] = w->m[a][0] * v[0] + w->m[a][1] * v[1] + w->m[a][2] * v[2] + w->m[a][3];
}

static bvx_status gltf_put_bounds(void *user, uint64_t element, const double *v)
{
    gltf_target *const t = user;
    double p[3];
    (void)element;
    gltf_world_position(t->world, v, p);
    for (int a = 0; a < 3; a++) {
        if (p[a] - p[a] == 0.0 && p[a] < t->low[a]) t->low[a] = p[a];
        if (p[a] - p[a] == 0.0 && p[a] > t->high[a]) t->high[a] = p[a];
    }
    return BVX_OK;
}

static bvx_status gltf_put_position(void *user, uint64_t element, const double *v)
{
    const gltf_target *const t = user;
    const bvxi_gltf *const f = &t->r->f;
    bvx_mesh *const m = t->r->out;
    size_t const at = (size_t)(t->base + element) * 3;
    double p[3];

    gltf_world_position(t->world, v, p);
    for (size_t a = 0; a < 3; a++) {
        double const limit = m->position_type == BVX_F32 ? BVXI_FLOAT_LIMIT : HUGE_VAL;

        if (!(bvxi_absolute(p[a]) < limit)) {
            if (!f->source->takes_any)
                return BVXI_FILE_FAIL_FOR(f->source, BVX_ERR_RANGE, BVX_REASON_NOT_FINITE,
                                          "mesh %u: vertex %i has a coordinate that is not finite",
                                          (uint64_t)t->mesh, element);
            p[a] = HUGE_VAL;
        }
        if (m->position_type == BVX_F32) ((float *)m->positions)[at + a] = (float)p[a];
        else ((double *)m->positions)[at + a] = p[a];
    }
    return BVX_OK;
}

/* A normal that the file has at length 1 stays as exact as its matrix is; others are made so. */
static bvx_status gltf_put_normal(void *user, uint64_t element, const double *v)
{
    const gltf_target *const t = user;
    float *const to = t->r->out->normals + (size_t)(t->base + element) * 3;
    double n[3], squares;

    for (int a = 0; a < 3; a++)
        n[a] = t->normal[a][0] * v[0] + t->normal[a][1] * v[1] + t->normal[a][2] * v[2];
    squares = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
    if (squares > 0.99999 && squares < 1.00001) {
        for (int a = 0; a < 3; a++) to[a] = (float)n[a];
        return BVX_OK;
    }
    for (int a = 0; a < 3; a++)
        if (!(n[a] - n[a] == 0.0)) n[0] = n[1] = n[2] = 0.0; /* what is no direction becomes up */
    bvxi_unit_normal(n, to);
    return BVX_OK;
}

/* v runs down in glTF, and up in a mesh. */
static bvx_status gltf_put_uv(void *user, uint64_t element, const double *v)
{
    const gltf_target *const t = user;
    const bvxi_source *const s = t->r->f.source;
    double const pair[2] = {v[0], 1.0 - v[1]};

    for (size_t k = 0; k < 2; k++) {
        if (!(bvxi_absolute(pair[k]) < BVXI_FLOAT_LIMIT))
            return BVXI_FILE_FAIL_FOR(s, BVX_ERR_RANGE, BVX_REASON_NOT_FINITE,
                                      "mesh %u: vertex %i has a texture coordinate that is not finite",
                                      (uint64_t)t->mesh, element);
        t->uvs[(size_t)(t->base + element) * 2 + k] = (float)pair[k];
    }
    return BVX_OK;
}

static bvx_status gltf_put_colour(void *user, uint64_t element, const double *v)
{
    const gltf_target *const t = user;
    const bvxi_source *const s = t->r->f.source;
    uint8_t *const to = t->r->out->colours + (size_t)(t->base + element) * 4;

    for (int k = 0; k < 4; k++)
        if (!(v[k] - v[k] == 0.0))
            return BVXI_FILE_FAIL_FOR(s, BVX_ERR_RANGE, BVX_REASON_NOT_FINITE,
                                      "mesh %u: vertex %i has a colour that is not finite", (uint64_t)t->mesh,
                                      element);
    for (int k = 0; k < 3; k++) to[k] = glb_colour_byte(v[k]);
    to[3] = bvxi_colour_byte(v[3]);
    return BVX_OK;
}

static bvx_status gltf_put_rgb(void *user, uint64_t element, const double *v)
{
    double const rgba[4] = {v[0], v[1], v[2], 1.0};
    return gltf_put_colour(user, element, rgba);
}

static bvx_status gltf_put_corner(void *user, uint64_t element, const double *v)
{
    const gltf_target *const t = user;
    const bvxi_source *const s = t->r->f.source;
    if (!(v[0] < (double)t->limit))
        return BVXI_FILE_FAIL_FOR(s, BVX_ERR_RANGE, BVX_REASON_INDEX,
                                  "mesh %u: index %i is %u; there are %u vertices", (uint64_t)t->mesh,
                                  element, (uint64_t)v[0], t->limit);
    t->r->corner[element] = (uint32_t)v[0];
    return BVX_OK;
}

/* ---- the mesh ---- */

static bvx_status gltf_take_values(gltf_target *t, uint32_t accessor, int which)
{
    static bvxi_gltf_put *const put[GLTF_ATTRIBUTES] = {gltf_put_position, gltf_put_normal, gltf_put_uv,
                                                        gltf_put_uv, gltf_put_colour};
    bvxi_gltf_array a;
    BVXI_TRY(bvxi_gltf_array_of(&t->r->f, accessor, &a));
    if (which == GLTF_COLOUR) a.normalized = 1;
    t->uvs = which == GLTF_UV2 ? t->r->out->uvs2 : t->r->out->uvs;
    return bvxi_gltf_each(&t->r->f, accessor, &a,
                          which == GLTF_COLOUR && a.components == 3 ? gltf_put_rgb : put[which], t);
}

static bvx_status gltf_emit_triangles(gltf_target *t, const gltf_primitive *p)
{
    gltf_reader *const r = t->r;
    bvxi_gltf_array a;

    t->limit = p->vertices;
    if (p->indices != BVXI_JSON_NONE) {
        BVXI_TRY(bvxi_gltf_array_of(&r->f, p->indices, &a));
        a.normalized = 0;
        BVXI_TRY(bvxi_gltf_each(&r->f, p->indices, &a, gltf_put_corner, t));
    }
    for (uint64_t i = 0; i < p->triangles; i++) {
        uint32_t *const to = r->out->triangles + (size_t)(r->triangle + i) * 3;
        uint64_t c[3] = {3 * i, 3 * i + 1, 3 * i + 2};

        /* Every other triangle of a strip runs the other way. */
        if (p->mode == GLTF_STRIP) c[0] = i, c[1] = i + 1 + i % 2, c[2] = i + 2 - i % 2;
        if (p->mode == GLTF_FAN) c[0] = i + 1, c[1] = i + 2, c[2] = 0;
        for (int k = 0; k < 3; k++) {
            uint64_t const corner = c[t->flips && k > 0 ? 3 - k : k];
            to[k] = (uint32_t)t->base + (p->indices != BVXI_JSON_NONE ? r->corner[corner] : (uint32_t)corner);
        }
        if (r->out->materials != NULL) r->out->materials[r->triangle + i] = p->material;
    }
    r->triangle += p->triangles;
    return BVX_OK;
}

/* Normals go by the cofactors of the matrix, which are the inverse of its transpose times the determinant. */
static void gltf_aim(gltf_target *t, const bvxi_gltf_world *w)
{
    double determinant = 0.0;

    t->world = w;
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++) {
            int const r1 = (r + 1) % 3, r2 = (r + 2) % 3, c1 = (c + 1) % 3, c2 = (c + 2) % 3;
            t->normal[r][c] = w->m[r1][c1] * w->m[r2][c2] - w->m[r1][c2] * w->m[r2][c1];
        }
    for (int c = 0; c < 3; c++) determinant += w->m[0][c] * t->normal[0][c];
    t->flips = determinant < 0.0;
    for (int r = 0; r < 3 && t->flips; r++)
        for (int c = 0; c < 3; c++) t->normal[r][c] = 0.0 - t->normal[r][c];
}

static bvx_status gltf_emit_node(gltf_reader *r, uint32_t node)
{
    gltf_target t = {.r = r, .mesh = r->mesh_of[node]};
    const gltf_mesh *const m = &r->mesh[t.mesh];

    gltf_aim(&t, &r->scene.world[node]);
    for (uint32_t i = 0; i < m->count; i++) {
        const gltf_primitive *const p = &r->primitive[m->first + i];

        BVXI_TRY(
            bvxi_progress(r->f.source->ctx, "read", 0.2 + 0.7 * ((double)r->vertex / (double)r->vertices)));
        if (!p->shares) {
            t.base = r->vertex;
            bvx_mesh *const out = r->out;
            size_t const base = (size_t)t.base, count = (size_t)p->vertices;

            /* Zero normals are found again when all triangles are there, and computed from these. */
            if (out->normals != NULL) memset(out->normals + base * 3, 0, count * 12);
            if (out->uvs != NULL) memset(out->uvs + base * 2, 0, count * 8);
            if (out->uvs2 != NULL) memset(out->uvs2 + base * 2, 0, count * 8);
            if (out->colours != NULL) memset(out->colours + base * 4, 255, count * 4);
            for (int a = 0; a < GLTF_ATTRIBUTES; a++)
                if (p->attribute[a] != BVXI_JSON_NONE) BVXI_TRY(gltf_take_values(&t, p->attribute[a], a));
            r->vertex += p->vertices;
        }
        BVXI_TRY(gltf_emit_triangles(&t, p));
        if (r->f.part == NULL) continue;
        r->f.part_of[p->value] = (uint32_t)r->f.parts;
        r->f.part[r->f.parts++] = (bvxi_asset_part){t.base, p->vertices, p->material, t.flips};
    }
    return BVX_OK;
}

/* Floats, unless nodes put the mesh so far away that they would lose much of it. */
static bvx_status gltf_choose_type(gltf_reader *r, int32_t *type)
{
    gltf_target t = {.r = r};
    double most = 0.0, side = 0.0;

    *type = BVX_F32;
    for (int a = 0; a < 3; a++) {
        t.low[a] = HUGE_VAL;
        t.high[a] = -HUGE_VAL;
    }
    for (uint32_t i = 0; i < r->f.list_count[BVXI_GLTF_NODE]; i++) {
        const gltf_mesh *const m = r->mesh_of[i] == BVXI_JSON_NONE ? NULL : &r->mesh[r->mesh_of[i]];
        const bvxi_gltf_world *const w = &r->scene.world[i];

        /* What is not moved is as exact as the file. */
        if (m == NULL || (w->m[0][3] == 0.0 && w->m[1][3] == 0.0 && w->m[2][3] == 0.0)) continue;
        t.world = w;
        for (uint32_t k = 0; k < m->count; k++) {
            uint32_t const accessor = r->primitive[m->first + k].attribute[GLTF_POSITION];
            bvxi_gltf_array a;
            if (r->primitive[m->first + k].shares) continue;
            BVXI_TRY(bvxi_gltf_array_of(&r->f, accessor, &a));
            BVXI_TRY(bvxi_gltf_each(&r->f, accessor, &a, gltf_put_bounds, &t));
        }
    }
    for (int a = 0; a < 3; a++) {
        if (!(t.low[a] <= t.high[a])) return BVX_OK;
        if (t.high[a] - t.low[a] > side) side = t.high[a] - t.low[a];
        if (bvxi_absolute(t.low[a]) > most) most = bvxi_absolute(t.low[a]);
        if (bvxi_absolute(t.high[a]) > most) most = bvxi_absolute(t.high[a]);
    }
    if (most > GLTF_FAR * side) *type = BVX_F64;
    return BVX_OK;
}

static bvx_status gltf_make_parts(gltf_reader *r)
{
    bvxi_gltf *const f = &r->f;
    bvx_context *const ctx = f->source->ctx;
    if (!f->options->keep_file || f->source->takes_any || r->unkept || r->out->position_type != BVX_F32 ||
        f->list_count[BVXI_GLTF_BUFFER] != 1 || f->buffer[0].bytes == NULL)
        return BVX_OK;
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, (uint64_t)f->json.count * 4, "the parts of values", &f->part_of));
    memset(f->part_of, 0xff, (size_t)f->json.count * 4);
    return bvxi_alloc(ctx, BVXI_SCRATCH, r->primitives * sizeof *f->part, "the mesh's parts", &f->part);
}

/* Smooth normals for the vertices of primitives that have none. */
static bvx_status gltf_fill_normals(gltf_reader *r)
{
    bvx_context *const ctx = r->f.source->ctx;
    bvx_mesh *const m = r->out;
    double low[3] = {0, 0, 0}, high[3] = {0, 0, 0};
    double *sum;
    bvx_mesh_view view;

    if (m->normals == NULL || !r->lacks_normals) return BVX_OK;
    bvx_mesh_view_of(m, &view);
    for (uint64_t v = 0; v < m->vertex_count; v++) {
        double p[3];
        bvxi_view_position(&view, v, p);
        for (int a = 0; a < 3; a++) {
            if (p[a] - p[a] == 0.0 && p[a] < low[a]) low[a] = p[a];
            if (p[a] - p[a] == 0.0 && p[a] > high[a]) high[a] = p[a];
        }
    }
    BVXI_TRY(bvxi_sum_normals(ctx, &view, bvxi_unit_scale(low, high), &sum));
    for (uint64_t v = 0; v < m->vertex_count; v++) {
        float *const n = m->normals + (size_t)v * 3;
        if (n[0] == 0.0f && n[1] == 0.0f && n[2] == 0.0f) bvxi_unit_normal(sum + (size_t)v * 3, n);
    }
    return BVX_OK;
}

static bvx_status gltf_read_all(gltf_reader *r)
{
    BVXI_TRY(bvxi_gltf_open(&r->f));

    bvxi_gltf *const f = &r->f;
    bvx_context *const ctx = f->source->ctx;
    uint32_t const nodes = f->list_count[BVXI_GLTF_NODE], meshes = f->list_count[BVXI_GLTF_MESH];
    uint32_t first = 0;
    uint8_t *wanted;

    BVXI_TRY(bvxi_gltf_scene_of(f, &r->scene));
    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, meshes * sizeof *r->mesh, "the meshes", &r->mesh));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, (uint64_t)nodes * 4, "the meshes of nodes", &r->mesh_of));
    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, meshes, "the meshes that are drawn", &wanted));
    BVXI_TRY(gltf_mark_meshes(r, wanted));
    for (uint32_t i = 0; i < meshes; i++) {
        if (!wanted[i]) continue;
        BVXI_TRY(bvxi_progress(ctx, "read", 0.2));
        BVXI_TRY(gltf_take_mesh(r, i, first));
        first += bvxi_json_count(&f->json,
                                 bvxi_json_member(&f->json, f->list[BVXI_GLTF_MESH][i], "primitives"));
    }
    if (bvxi_json_count(&f->json, bvxi_json_member(&f->json, 0, "animations")) > 0)
        f->lost |= BVX_LOST_ANIMATIONS;
    BVXI_TRY(gltf_count_all(r));

    bvx_mesh *const m = r->out;
    int32_t type;

    BVXI_TRY(gltf_choose_type(r, &type));
    BVXI_TRY(bvxi_make_positions(ctx, m, type, r->vertices));
    BVXI_TRY(bvxi_make_triangles(ctx, m, r->triangles));
    if (r->has[GLTF_COLOUR]) BVXI_TRY(bvxi_make_array(ctx, m, BVXI_MESH_COLOURS));
    if (r->has[GLTF_UV]) BVXI_TRY(bvxi_make_uvs(ctx, m, r->vertices));
    if (r->has[GLTF_NORMAL]) BVXI_TRY(bvxi_make_array(ctx, m, BVXI_MESH_NORMALS));
    if (r->has[GLTF_UV2]) BVXI_TRY(bvxi_make_array(ctx, m, BVXI_MESH_UVS2));
    if (r->f.list_count[BVXI_GLTF_MATERIAL] > 0) BVXI_TRY(bvxi_make_array(ctx, m, BVXI_MESH_MATERIALS));
    BVXI_TRY(gltf_make_parts(r));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, r->most_corners * 4, "the indices of a primitive", &r->corner));
    for (uint32_t i = 0; i < r->f.list_count[BVXI_GLTF_NODE]; i++)
        if (r->mesh_of[i] != BVXI_JSON_NONE) BVXI_TRY(gltf_emit_node(r, i));
    BVXI_TRY(BVXI_SCOPE(ctx, gltf_fill_normals(r)));
    BVXI_TRY(bvxi_progress(r->f.source->ctx, "read", 0.9));
    return bvxi_gltf_assets(&r->f, r->out);
}

bvx_status bvxi_read_gltf(bvxi_source *source, const bvx_read_options *options, uint32_t *lost,
                          bvx_mesh *mesh)
{
    uint64_t const mark = bvxi_scratch_begin(source->ctx);
    gltf_reader r = {.f = {.source = source, .options = options}, .out = mesh};
    bvx_status const status = gltf_read_all(&r);
    /* The lists of what is open are scratch, so they go after it. */
    bvxi_gltf_close(&r.f);
    *lost = r.f.lost;
    return bvxi_scratch_end(source->ctx, mark, status);
}
