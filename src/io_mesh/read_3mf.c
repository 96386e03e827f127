/* read_3mf.c - the bodies that a 3MF file builds, as one mesh: bvx_read_mesh.
 *
 * Source: 3MF Consortium. 3D Manufacturing Format: Core Specification 1.3, Production Extension 1.1, Materials
 * and Properties Extension 1.2.
 *
 * The tags of the models of the container are read once, 3D/3dmodel.model last, since it names objects of the
 * others. An object is a range of vertices and triangles: its mesh, or what its components, all
 * of them earlier objects, have there. The build is the last range. No other file is opened, no document type
 * is read.
 * Guarantee: what copies lead to has at most MODEL_REPEATS times the bytes of the file, which is known before
 * they are made; an id is found in as many steps as the number of resources has bits. */
#include "io/xml_scan.h"
#include "io_mesh/glb.h"
#include "io_mesh/models_3mf.h"

enum { MODEL_RESOURCES = 16384, MODEL_REPEATS = 1024 };

/* An object, or a group of materials or colours. */
typedef struct model_resource {
    uint64_t id; /* part << 32 | the part's own id */
    uint64_t vertex, vertices, triangle, triangles;
    uint64_t labels[2]; /* the first and how many, of a group; those that an object's triangles count from */
    uint64_t label;     /* of an object's triangles that state none */
} model_resource;

typedef struct model_label {
    bvxi_xml_text name;
    uint8_t colour[4];
} model_label;

typedef struct model_file {
    bvx_context *ctx;
    const char *function;
    bvxi_source *source;
    bvxi_xml xml;
    bvxi_models models;
    uint64_t part; /* the model that is read */
    model_resource *resources, build;
    uint16_t *order; /* numbers of the resources by their ids, of equal ones the last behind */
    double *positions;
    uint32_t *corners; /* three, counted from the range's first vertex, and the label */
    model_label *labels;
    uint64_t resource_count, vertex_count, triangle_count, label_count;
    uint64_t resource_room, vertex_room, triangle_room, label_room;
    double unit; /* in millimeters */
    uint32_t *lost;
} model_file;

/* ---- Values ---- */

static BVXI_COLD bvx_status fail_tag(const model_file *f, bvx_status status, const char *why)
{
    return BVXI_FILE_FAIL(f->source, status, "line %u of the model: %s",
                          bvxi_source_line(&f->xml.source, f->xml.tag), why);
}

/* count numbers of an attribute between white space, and nothing else. */
static bvx_status take_reals(const model_file *f, const char *name, int count, int any, double *value)
{
    bvxi_xml_text text;

    if (!bvxi_xml_attribute(&f->xml, name, &text))
        return bvxi_fail_expected(&f->xml.source, f->xml.tag, "a tag with its numbers");
    for (int i = 0; i < count; i++) {
        text.p = bvxi_skip_space(text.p, text.end);
        size_t const n = bvxi_parse_double(text.p, text.end, &value[i]);

        if (n == 0) return bvxi_fail_expected(&f->xml.source, text.p, "a number");
        if (!any && !(value[i] - value[i] == 0.0))
            return fail_tag(f, BVX_ERR_RANGE, "a number is not finite");
        text.p += n;
    }
    if (bvxi_skip_space(text.p, text.end) == text.end) return BVX_OK;
    return bvxi_fail_expected(&f->xml.source, text.p, "the end of the value");
}

static int is_index(double v, uint64_t count)
{
    return v >= 0.0 && v < (double)count && v == floor(v);
}

static bvx_status take_index(const model_file *f, const char *name, uint64_t count, uint64_t *index)
{
    double v;

    BVXI_TRY(take_reals(f, name, 1, 0, &v));
    if (!is_index(v, count)) return fail_tag(f, BVX_ERR_RANGE, "an index or id is out of range");
    *index = (uint64_t)v;
    return BVX_OK;
}

/* Behind the resources whose ids are at most this one, in their order. */
static uint64_t place_of_id(const model_file *f, uint64_t id)
{
    uint64_t low = 0, high = f->resource_count;
    while (low < high) {
        uint64_t const middle = (low + high) / 2;
        if (f->resources[f->order[middle]].id <= id) low = middle + 1;
        else high = middle;
    }
    return low;
}

/* What an attribute names, among the resources before this tag; NULL: none. */
static bvx_status find_resource(const model_file *f, const char *name, uint64_t part,
                                const model_resource **r)
{
    uint64_t id = 0;

    BVXI_TRY(take_index(f, name, UINT32_MAX, &id));
    id |= part << 32;
    uint64_t const i = place_of_id(f, id);
    *r = i > 0 && f->resources[f->order[i - 1]].id == id ? &f->resources[f->order[i - 1]] : NULL;
    return BVX_OK;
}

/* ---- Tags ---- */

/* The label of a property, if the tag has that: of a group of its own or those so far. Texture coordinates and
 * mixtures have none. */
static bvx_status take_label(const model_file *f, const char *property, uint64_t labels[2], uint64_t *label)
{
    const model_resource *group;
    bvxi_xml_text text;

    if (!bvxi_xml_attribute(&f->xml, property, &text)) return BVX_OK;
    if (bvxi_xml_attribute(&f->xml, "pid", &text)) {
        BVXI_TRY(find_resource(f, "pid", f->part, &group));
        labels[1] = 0;
        if (group != NULL) memcpy(labels, group->labels, sizeof group->labels);
    }
    *label = UINT32_MAX;
    if (labels[1] == 0) *f->lost |= BVX_LOST_ATTRIBUTES;
    if (labels[1] == 0) return BVX_OK;
    BVXI_TRY(take_index(f, property, labels[1], label));
    *label += labels[0];
    return BVX_OK;
}

static bvx_status take_resource(model_file *f)
{
    model_resource r = {.vertex = f->vertex_count, .triangle = f->triangle_count, .label = UINT32_MAX};

    if (f->build.triangles > 0) return fail_tag(f, BVX_ERR_FORMAT, "an object is there after the build");
    if (f->resource_count >= MODEL_RESOURCES)
        return fail_tag(f, BVX_ERR_UNSUPPORTED, "there are too many objects");
    BVXI_TRY(take_index(f, "id", UINT32_MAX, &r.id));
    r.id |= f->part << 32;
    r.labels[0] = f->label_count;
    BVXI_TRY(take_label(f, "pindex", r.labels, &r.label));
    BVXI_TRY(BVXI_GROW_BESIDE(f, f->order, f->resource_count, f->resource_room, sizeof *f->order,
                              "the objects' order"));
    BVXI_TRY(BVXI_GROW(f, f->resources, f->resource_count, f->resource_room, "the objects"));
    uint16_t *const place = f->order + place_of_id(f, r.id);
    memmove(place + 1, place, (size_t)(f->order + f->resource_count - place) * sizeof *place);
    *place = (uint16_t)f->resource_count;
    f->resources[f->resource_count++] = r;
    return BVX_OK;
}

static bvx_status add_vertex(model_file *f, model_resource *o, const double p[3])
{
    BVXI_TRY(BVXI_GROW_BY(f, f->positions, f->vertex_count, f->vertex_room, 24, "the objects' vertices"));
    memcpy(f->positions + 3 * f->vertex_count++, p, 24);
    o->vertices++;
    return BVX_OK;
}

static bvx_status add_3mf_triangle(model_file *f, model_resource *o, const double v[3], uint64_t label)
{
    uint32_t corners[4] = {0, 0, 0, (uint32_t)label};

    for (int k = 0; k < 3; k++) {
        if (!is_index(v[k], o->vertices)) return fail_tag(f, BVX_ERR_RANGE, "an index is out of range");
        corners[k] = (uint32_t)v[k];
    }
    BVXI_TRY(BVXI_GROW_BY(f, f->corners, f->triangle_count, f->triangle_room, 16, "the objects' triangles"));
    memcpy(f->corners + 4 * f->triangle_count++, corners, 16);
    o->triangles++;
    return BVX_OK;
}

static bvx_status take_vertex(model_file *f, model_resource *o)
{
    static const char *const names[3] = {"x", "y", "z"};
    double p[3];

    for (int a = 0; a < 3; a++) BVXI_TRY(take_reals(f, names[a], 1, f->source->takes_any, &p[a]));
    return add_vertex(f, o, p);
}

static bvx_status take_triangle(model_file *f, model_resource *o)
{
    static const char *const names[3] = {"v1", "v2", "v3"}, *const properties[3] = {"p1", "p2", "p3"};
    uint64_t labels[2] = {o->labels[0], o->labels[1]}, label = o->label;
    bvxi_xml_text first, text;
    double v[3];

    for (int k = 0; k < 3; k++) BVXI_TRY(take_reals(f, names[k], 1, 0, &v[k]));
    BVXI_TRY(take_label(f, "p1", labels, &label));
    for (int k = 1; k < 3 && bvxi_xml_attribute(&f->xml, "p1", &first); k++)
        if (bvxi_xml_attribute(&f->xml, properties[k], &text) && !bvxi_xml_same(first, text))
            *f->lost |= BVX_LOST_ATTRIBUTES;
    return add_3mf_triangle(f, o, v, label);
}

/* A copy of an object, x' = x m[0] + y m[3] + z m[6] + m[9], after all ranges. A mirror turns triangles. */
static bvx_status add_copy(model_file *f, model_resource *to, const model_resource *of, const double m[12])
{
    double const first = (double)to->vertices;
    uint64_t const size = (uint64_t)(f->source->end - f->source->begin);
    int const mirrors = m[0] * (m[4] * m[8] - m[5] * m[7]) - m[1] * (m[3] * m[8] - m[5] * m[6]) +
                            m[2] * (m[3] * m[7] - m[4] * m[6]) <
                        0.0;

    if ((f->vertex_count + of->vertices) * 24 + (f->triangle_count + of->triangles) * 16 >
        MODEL_REPEATS * size)
        return BVXI_FILE_FAIL_FOR(f->source, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                                  "objects are repeated to more than %d times the bytes of the file",
                                  (int64_t)MODEL_REPEATS);
    for (uint64_t i = of->vertex; i < of->vertex + of->vertices; i++) {
        const double *const p = f->positions + 3 * i;
        double moved[3];

        for (int a = 0; a < 3; a++) moved[a] = p[0] * m[a] + p[1] * m[3 + a] + p[2] * m[6 + a] + m[9 + a];
        BVXI_TRY(add_vertex(f, to, moved));
    }
    for (uint64_t i = of->triangle; i < of->triangle + of->triangles; i++) {
        const uint32_t *const c = f->corners + 4 * i;
        double const v[3] = {first + c[mirrors ? 2 : 0], first + c[1], first + c[mirrors ? 0 : 2]};

        BVXI_TRY(add_3mf_triangle(f, to, v, c[3]));
    }
    return BVX_OK;
}

/* A component or an item. Other models are named by a path from the container's root. */
static bvx_status take_use(model_file *f, model_resource *to)
{
    double m[12] = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0};
    const model_resource *of;
    bvxi_xml_text text;
    uint64_t part = f->part;

    if (bvxi_xml_attribute(&f->xml, "p:path", &text))
        part = bvxi_models_find(&f->models, text.p, (uint64_t)(text.end - text.p));
    if (bvxi_xml_attribute(&f->xml, "transform", &text)) BVXI_TRY(take_reals(f, "transform", 12, 0, m));
    BVXI_TRY(find_resource(f, "objectid", part, &of));
    if (of == NULL || of == to)
        return fail_tag(f, BVX_ERR_FORMAT, "an object is named that is not there, or not before this place");
    return of->triangles > 0 ? add_copy(f, to, of, m) : BVX_OK;
}

/* #RRGGBB or #RRGGBBAA; what is none is white. */
static bvx_status add_label(model_file *f, model_resource *group, const char *colour)
{
    model_label label = {.colour = {255, 255, 255, 255}};
    bvxi_xml_text text;

    if (!bvxi_xml_attribute(&f->xml, "name", &label.name)) label.name.p = label.name.end = NULL;
    if (bvxi_xml_attribute(&f->xml, colour, &text))
        for (int i = 1; i < 9 && text.end - text.p > i; i++) {
            uint32_t const digit = (uint32_t)bvxi_word_is(text.p + i, 1, "0|1|2|3|4|5|6|7|8|9|a|b|c|d|e|f") -
                                   1;
            uint8_t *const byte = &label.colour[(i - 1) / 2];
            *byte = (uint8_t)(i % 2 != 0 ? digit << 4 & 0xf0 : (*byte & 0xf0) | (digit & 15));
        }
    BVXI_TRY(BVXI_GROW(f, f->labels, f->label_count, f->label_room, "the materials"));
    f->labels[f->label_count++] = label;
    group->labels[1]++;
    return BVX_OK;
}

/* The unit, and no extension that may change what the bodies are. */
static bvx_status take_model(model_file *f)
{
    static const double size[] = {0.001, 1, 10, 25.4, 304.8, 1000};
    bvxi_xml_text text;
    int32_t unit = 2;

    if (bvxi_xml_attribute(&f->xml, "unit", &text))
        unit = bvxi_word_is(text.p, (size_t)(text.end - text.p),
                            "micron|millimeter|centimeter|inch|foot|meter");
    if (unit == 0) return fail_tag(f, BVX_ERR_FORMAT, "the unit is unknown");
    f->unit = size[unit - 1];
    if (!bvxi_xml_attribute(&f->xml, "requiredextensions", &text)) return BVX_OK;
    while ((text.p = bvxi_skip_space(text.p, text.end)) < text.end) {
        const char *const word = text.p;

        text.p = bvxi_skip_word(text.p, text.end);
        if (!bvxi_word_is(word, (size_t)(text.p - word), "p|m"))
            return fail_tag(f, BVX_ERR_UNSUPPORTED, "an extension other than p and m is required");
    }
    return BVX_OK;
}

static bvx_status take_tag(model_file *f)
{
    static const char *const paths[] = {"model",
                                        "model/resources/object",
                                        "model/resources/basematerials",
                                        "model/resources/m:colorgroup",
                                        "model/resources/basematerials/base",
                                        "model/resources/m:colorgroup/m:color",
                                        "model/resources/object/mesh/vertices/vertex",
                                        "model/resources/object/mesh/triangles/triangle",
                                        "model/resources/object/components/component",
                                        "model/build/item"};
    model_resource *const last = f->resource_count > 0 ? &f->resources[f->resource_count - 1] : NULL;
    int k = 0;

    while (k < 10 && !bvxi_xml_is_at(&f->xml, paths[k])) k++;
    switch (k) {
    case 0: return take_model(f);
    case 1:
    case 2:
    case 3: return take_resource(f);
    case 4: return add_label(f, last, "displaycolor");
    case 5: return add_label(f, last, "color");
    case 6: return take_vertex(f, last);
    case 7: return take_triangle(f, last);
    case 8: return take_use(f, last);
    case 9:
        return f->part + 1 == f->models.count ? take_use(f, &f->build) : BVX_OK; /* others build nothing */
    default: return BVX_OK;
    }
}

/* <vertex x="1" y="2" z="3"/> or <triangle v1="0" v2="1" v3="2"/>, which most of a file is, up to another tag. */
static bvx_status take_3mf_run(model_file *f, int vertices)
{
    static const char *const before[2][3] = {{"<triangle v1=\"", "\" v2=\"", "\" v3=\""},
                                             {"<vertex x=\"", "\" y=\"", "\" z=\""}};
    model_resource *const o = &f->resources[f->resource_count - 1];
    const char *const end = f->xml.source.end;

    for (;;) {
        const char *p = bvxi_skip_space(f->xml.p, end);
        double v[3];

        f->xml.tag = p;
        for (int a = 0; a < 3; a++) {
            size_t const n = bvxi_text_length(before[vertices][a]);
            if ((size_t)(end - p) <= n || memcmp(p, before[vertices][a], n) != 0) return BVX_OK;
            size_t const digits = bvxi_parse_double(p + n, end, &v[a]);
            if (digits == 0 || !(v[a] - v[a] == 0.0)) return BVX_OK;
            p += n + digits;
        }
        if (end - p < 4 || *p != '"') return BVX_OK;
        p += p[1] == ' ' ? 2 : 1;
        if (p[0] != '/' || p[1] != '>') return BVX_OK;
        BVXI_TRY(vertices ? add_vertex(f, o, v) : add_3mf_triangle(f, o, v, o->label));
        f->xml.p = p + 2;
        BVXI_TRY(bvxi_source_at(&f->xml.source, f->xml.p));
    }
}

static bvx_status read_part(model_file *f)
{
    const bvxi_model *const part = &f->models.model[f->part];
    double const share = 0.9 / (double)f->models.count;

    bvxi_xml_start(&f->xml, f->ctx, "3MF", part->text, part->text + part->size);
    bvxi_source_pass(&f->xml.source, share * (double)f->part, share * (double)(f->part + 1));
    for (;;) {
        BVXI_TRY(bvxi_xml_next(&f->xml));
        BVXI_TRY(bvxi_source_at(&f->xml.source, f->xml.p));
        if (f->xml.event == BVXI_XML_END) return BVX_OK;
        if (f->xml.event == BVXI_XML_OPEN) BVXI_TRY(take_tag(f));
        if (f->xml.depth != 5 || f->xml.is_empty) continue;
        if (bvxi_xml_is_at(&f->xml, "model/resources/object/mesh/vertices")) BVXI_TRY(take_3mf_run(f, 1));
        if (bvxi_xml_is_at(&f->xml, "model/resources/object/mesh/triangles")) BVXI_TRY(take_3mf_run(f, 0));
    }
}

/* ---- The mesh ---- */

/* As glTF has them. A name that JSON would write otherwise is left out. */
static void put_3mf_materials(const model_file *f, bvxi_output *out)
{
    for (uint64_t i = 0; i < f->label_count; i++) {
        const model_label *const l = &f->labels[i];
        const char *p = l->name.p;
        double rgb[3];

        while (p < l->name.end && *p >= ' ' && *p <= '~' && *p != '"' && *p != '\\' && *p != '&') p++;
        bvxi_output_print(out, "%s{\"name\":\"", i > 0 ? "," : "[");
        if (p == l->name.end && p != NULL) bvxi_output_add(out, l->name.p, (size_t)(p - l->name.p));
        for (int k = 0; k < 3; k++) rgb[k] = (double)glb_linear_light[l->colour[k]] / 65535.0;
        bvxi_output_print(
            out, "\",\"pbrMetallicRoughness\":{\"metallicFactor\":0,\"baseColorFactor\":[%v,%g]}%s}", rgb,
            ",", (double)l->colour[3] / 255.0, l->colour[3] < 255 ? ",\"alphaMode\":\"BLEND\"" : "");
    }
    bvxi_output_add(out, "]", 2);
    for (uint64_t i = 0; i < f->label_count; i++) bvxi_output_add(out, f->labels[i].colour, 4);
}

bvx_status bvxi_read_3mf(bvxi_source *source, const bvx_read_options *options, uint32_t *lost, bvx_mesh *mesh)
{
    model_file f = {.ctx = source->ctx, .function = "3MF", .source = source, .lost = lost, .unit = 1.0};
    bvxi_output out = {0};
    bvx_assets *a;

    BVXI_TRY(bvxi_models_open(source, options, &f.models));
    for (f.part = 0; f.part < f.models.count; f.part++) BVXI_TRY(read_part(&f));
    const double *const p = f.positions + 3 * (f.vertex_count - f.build.vertices);
    const uint32_t *c = f.corners + 4 * (f.triangle_count - f.build.triangles);

    if (f.build.triangles == 0)
        return BVXI_FILE_FAIL(f.source, BVX_ERR_EMPTY, "the build has no item with triangles");
    BVXI_TRY(bvxi_make_positions(f.ctx, mesh, BVX_F64, f.build.vertices));
    BVXI_TRY(bvxi_make_triangles(f.ctx, mesh, f.build.triangles));
    if (f.label_count > 0) BVXI_TRY(bvxi_make_array(f.ctx, mesh, BVXI_MESH_MATERIALS));
    for (uint64_t i = 0; i < 3 * mesh->vertex_count; i++) {
        double const v = p[i] * f.unit;

        ((double *)mesh->positions)[i] = v;
        if (!f.source->takes_any && !(v - v == 0.0))
            return BVXI_FILE_FAIL_FOR(f.source, BVX_ERR_RANGE, BVX_REASON_NOT_FINITE,
                                      "vertex %u has a coordinate that is not finite", i / 3);
    }
    for (uint64_t t = 0; t < mesh->triangle_count; t++, c += 4) {
        memcpy(mesh->triangles + 3 * t, c, 12);
        if (mesh->materials != NULL)
            mesh->materials[t] = c[3] < f.label_count ? c[3] : (uint32_t)f.label_count;
    }
    if (f.label_count == 0) return BVX_OK;

    put_3mf_materials(&f, &out);
    BVXI_TRY(bvxi_alloc_zero(f.ctx, BVXI_RESULT, sizeof *a + out.size, "the materials", &a));
    a->block_bytes = sizeof *a + out.size;
    a->material_count = f.label_count;
    a->materials = (const char *)(a + 1);
    out = (bvxi_output){.bytes = (uint8_t *)(a + 1)};
    put_3mf_materials(&f, &out);
    a->base_colours = (const uint8_t *)(a + 1) + out.size - 4 * f.label_count;
    mesh->assets = a;
    return BVX_OK;
}
