/* gltf_array.c - accessors of a glTF file: numbers of any of its types, strides and normalizations, with sparse
 * elements in place of others.
 *
 * Sources: Khronos Group. glTF 2.0 Specification, 3.6.2; KHR_mesh_quantization. Guarantee: where an array lies
 * is checked before its first element is read, and no element outside its bufferView is. */
#include "io_mesh/gltf.h"

static uint64_t gltf_component_size(int32_t type)
{
    return type == BVXI_GLTF_I8 || type == BVXI_GLTF_U8     ? 1
           : type == BVXI_GLTF_I16 || type == BVXI_GLTF_U16 ? 2
                                                            : 4;
}

/* ---- where elements lie ---- */

/* count elements of size bytes in a bufferView, from an offset: inside it, and aligned as the format wants. */
static bvx_status gltf_place(bvxi_gltf *f, uint64_t accessor, uint32_t object, int must, uint64_t count,
                             uint64_t size, uint64_t component, const uint8_t **place, uint64_t *stride)
{
    uint32_t view;
    uint64_t offset, bytes, at;

    *place = NULL;
    *stride = size;
    BVXI_TRY(bvxi_gltf_index(f, BVXI_GLTF_ACCESSOR, accessor, object, "bufferView", BVXI_GLTF_VIEW, &view));
    if (view == BVXI_JSON_NONE)
        return must ? bvxi_gltf_fail(f, BVXI_GLTF_ACCESSOR, accessor, "its sparse part has no bufferView")
                    : BVX_OK;
    BVXI_TRY(bvxi_gltf_whole(f, BVXI_GLTF_ACCESSOR, accessor, object, "byteOffset", 0, &offset));
    BVXI_TRY(bvxi_gltf_view(f, view, place, &bytes, stride, &at));
    if (*stride == 0) *stride = size;
    if (*stride < size)
        return bvxi_gltf_fail(f, BVXI_GLTF_ACCESSOR, accessor, "its elements are longer than their stride");
    if (offset % component != 0 || (offset + at) % component != 0 || *stride % component != 0)
        return bvxi_gltf_fail(f, BVXI_GLTF_ACCESSOR, accessor,
                              "its elements do not begin at a multiple of their component's size");

    /* In this order no sum or product leaves 64 bits. */
    if (offset > bytes || bytes - offset < size || (bytes - offset - size) / *stride < count - 1)
        return BVXI_FILE_FAIL(f->source, BVX_ERR_FORMAT,
                              "accessor %u: %u elements of %u bytes from byte %u on lie beyond bufferView %u",
                              accessor, count, *stride, offset, (uint64_t)view);
    *place += offset;
    return BVX_OK;
}

static bvx_status gltf_take_sparse(bvxi_gltf *f, uint64_t accessor, uint32_t sparse, bvxi_gltf_array *a)
{
    uint64_t const component = gltf_component_size(a->type);
    uint32_t const indices = bvxi_json_member(&f->json, sparse, "indices");
    uint32_t const values = bvxi_json_member(&f->json, sparse, "values");
    uint64_t type, stride, size;

    BVXI_TRY(
        bvxi_gltf_whole(f, BVXI_GLTF_ACCESSOR, accessor, sparse, "count", BVXI_GLTF_MUST, &a->sparse_count));
    if (a->sparse_count == 0 || a->sparse_count > a->count)
        return bvxi_gltf_fail(f, BVXI_GLTF_ACCESSOR, accessor, "its sparse part has no valid count");
    BVXI_TRY(
        bvxi_gltf_whole(f, BVXI_GLTF_ACCESSOR, accessor, indices, "componentType", BVXI_GLTF_MUST, &type));
    if (type != BVXI_GLTF_U8 && type != BVXI_GLTF_U16 && type != BVXI_GLTF_U32)
        return bvxi_gltf_fail(f, BVXI_GLTF_ACCESSOR, accessor,
                              "its sparse indices have another componentType");
    a->sparse_type = (int32_t)type;

    /* Both are packed, whatever their bufferViews say. */
    size = gltf_component_size(a->sparse_type);
    BVXI_TRY(gltf_place(f, accessor, indices, 1, a->sparse_count, size, size, &a->sparse_index, &stride));
    if (stride != size)
        return bvxi_gltf_fail(f, BVXI_GLTF_ACCESSOR, accessor, "its sparse indices have a stride");
    size = component * (uint64_t)a->components;
    BVXI_TRY(gltf_place(f, accessor, values, 1, a->sparse_count, size, component, &a->sparse_value, &stride));
    return stride == size
               ? BVX_OK
               : bvxi_gltf_fail(f, BVXI_GLTF_ACCESSOR, accessor, "its sparse values have a stride");
}

bvx_status bvxi_gltf_array_of(bvxi_gltf *f, uint64_t accessor, bvxi_gltf_array *a)
{
    static const char *const types[] = {"SCALAR", "VEC2", "VEC3", "VEC4"};
    const bvxi_json *const j = &f->json;
    uint32_t value, type, sparse;
    uint64_t component;

    memset(a, 0, sizeof *a);
    BVXI_TRY(bvxi_gltf_item(f, BVXI_GLTF_ACCESSOR, accessor, "a primitive", &value));
    type = bvxi_json_member(j, value, "type");
    for (int k = 0; k < 4; k++)
        if (bvxi_json_is(j, type, types[k])) a->components = k + 1;
    if (a->components == 0)
        return bvxi_gltf_fail(f, BVXI_GLTF_ACCESSOR, accessor, "its type is not SCALAR, VEC2, VEC3 or VEC4");
    BVXI_TRY(
        bvxi_gltf_whole(f, BVXI_GLTF_ACCESSOR, accessor, value, "componentType", BVXI_GLTF_MUST, &component));
    /* There is no signed 32-bit type. */
    if (component < BVXI_GLTF_I8 || component > BVXI_GLTF_F32 || component == 5124)
        return BVXI_FILE_FAIL(f->source, BVX_ERR_FORMAT, "accessor %u: componentType %u is unknown", accessor,
                              component);
    a->type = (int32_t)component;
    a->normalized = bvxi_json_kind(j, bvxi_json_member(j, value, "normalized")) == BVXI_JSON_TRUE;
    BVXI_TRY(bvxi_gltf_whole(f, BVXI_GLTF_ACCESSOR, accessor, value, "count", BVXI_GLTF_MUST, &a->count));
    if (a->count == 0) return bvxi_gltf_fail(f, BVXI_GLTF_ACCESSOR, accessor, "its count is 0");

    component = gltf_component_size(a->type);
    BVXI_TRY(gltf_place(f, accessor, value, 0, a->count, component * (uint64_t)a->components, component,
                        &a->at, &a->stride));
    sparse = bvxi_json_member(j, value, "sparse");
    return sparse != BVXI_JSON_NONE ? gltf_take_sparse(f, accessor, sparse, a) : BVX_OK;
}

/* ---- values ---- */

/* Component k of an element; what is normalized lies in 0 to 1 or -1 to 1. */
static inline double gltf_component(const uint8_t *p, int32_t type, int32_t normalized)
{
    double v;

    switch (type) {
    case BVXI_GLTF_F32: return (double)bvxi_load_f32(p, 0);
    case BVXI_GLTF_U32: return (double)bvxi_load_u32(p, 0);
    case BVXI_GLTF_U16: v = (double)bvxi_load_u16(p, 0); return normalized ? v / 65535.0 : v;
    case BVXI_GLTF_U8: return normalized ? (double)*p / 255.0 : (double)*p;
    case BVXI_GLTF_I16:
        v = (double)bvxi_load_u16(p, 0);
        if (v >= 32768.0) v -= 65536.0;
        return !normalized ? v : v < -32767.0 ? -1.0 : v / 32767.0;
    default:
        v = *p >= 128 ? (double)*p - 256.0 : (double)*p;
        return !normalized ? v : v < -127.0 ? -1.0 : v / 127.0;
    }
}

static void gltf_element(const bvxi_gltf_array *a, const uint8_t *p, double v[4])
{
    uint64_t const size = gltf_component_size(a->type);
    for (int32_t k = 0; k < a->components; k++)
        v[k] = p != NULL ? gltf_component(p + (uint64_t)k * size, a->type, a->normalized) : 0.0;
}

bvx_status bvxi_gltf_each(bvxi_gltf *f, uint64_t accessor, const bvxi_gltf_array *a, bvxi_gltf_put *put,
                          void *user)
{
    uint64_t const size = gltf_component_size(a->type) * (uint64_t)a->components;
    uint64_t const index_size = gltf_component_size(a->sparse_type);
    double v[4];

    for (uint64_t i = 0; i < a->count; i++) {
        gltf_element(a, a->at != NULL ? a->at + i * a->stride : NULL, v);
        BVXI_TRY(put(user, i, v));
    }
    for (uint64_t i = 0; i < a->sparse_count; i++) {
        uint64_t const at = (uint64_t)gltf_component(a->sparse_index + i * index_size, a->sparse_type, 0);

        if (at >= a->count)
            return BVXI_FILE_FAIL_FOR(f->source, BVX_ERR_RANGE, BVX_REASON_INDEX,
                                      "accessor %u: a sparse index is %u; there are %u elements", accessor,
                                      at, a->count);
        gltf_element(a, a->sparse_value + i * size, v);
        BVXI_TRY(put(user, at, v));
    }
    return BVX_OK;
}
