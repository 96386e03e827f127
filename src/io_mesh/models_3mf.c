/* models_3mf.c - the models in the container of a 3MF file, which is a zip file.
 *
 * Source: PKWARE. APPNOTE 6.3. No other file is opened.
 * Guarantee: the models have at most MODEL_PACKED times the bytes of the file, which is known before they are
 * unpacked; one is found in as many steps as their number has bits. */
#include "io_mesh/models_3mf.h"

enum { MODEL_PACKED = 128 };

static BVXI_COLD bvx_status fail_zip(const bvxi_source *s, const uint8_t *at, const char *why)
{
    return BVXI_BYTE_FAIL(s, at, BVX_ERR_FORMAT, "%s", why);
}

/* The bytes of an entry are where its local header says. Numbers of which all 32 bits are set have 64, one after
 * the other, in the extra field 1. */
static bvx_status find_bytes(const bvxi_source *s, bvxi_model *part)
{
    static const size_t fields[3] = {24, 20, 42};
    const uint8_t *const begin = (const uint8_t *)s->begin, *const e = part->entry;
    const uint8_t *extra = e + 46 + part->name, *const end = extra + bvxi_load_u16(e + 30, 0);
    uint64_t const size = (uint64_t)(s->end - s->begin);
    uint16_t const method = bvxi_load_u16(e + 10, 0);
    uint8_t wide[24] = {0}, *next = wide;
    uint64_t v[3], data;

    for (; end - extra >= 4; extra += 4 + bvxi_load_u16(extra + 2, 0)) {
        size_t const n = bvxi_load_u16(extra + 2, 0);
        if (n > (size_t)(end - extra) - 4) break;
        if (bvxi_load_u16(extra, 0) == 1) memcpy(wide, extra + 4, n < 24 ? n : 24);
    }
    for (int i = 0; i < 3; i++) {
        v[i] = bvxi_load_u32(e + fields[i], 0);
        if (v[i] != UINT32_MAX) continue;
        v[i] = bvxi_load_u64(next, 0);
        next += 8;
    }
    part->size = v[0];
    part->packed = v[1];
    if ((bvxi_load_u16(e + 8, 0) & 1) != 0 || (method != 0 && method != 8))
        return BVXI_FILE_FAIL(s, BVX_ERR_UNSUPPORTED,
                              "a model is encrypted or packed by another method than deflate");
    if (v[2] > size || size - v[2] < 30 || bvxi_load_u32(begin + v[2], 0) != 0x04034b50)
        return fail_zip(s, e, "the directory names an entry that is not there");
    data = v[2] + 30 + bvxi_load_u16(begin + v[2] + 26, 0) + bvxi_load_u16(begin + v[2] + 28, 0);
    if (data > size || part->packed > size - data) return fail_zip(s, begin + v[2], "an entry is cut off");
    if (method == 0 && part->size != part->packed) return fail_zip(s, e, "an entry has two sizes");
    part->text = begin + data;
    return BVX_OK;
}

/* The models in the order of the directory, 3D/3dmodel.model last. */
static bvx_status find_models(const bvxi_source *s, bvxi_models *m, const uint8_t *p, const uint8_t *end,
                              uint64_t entries)
{
    bvxi_model root = {0};
    uint64_t left = MODEL_PACKED * (uint64_t)(s->end - s->begin);

    BVXI_TRY(BVXI_ARRAY(s->ctx, (end - p) / 46 + 1, "the models' places", m->model));
    for (uint64_t whole; entries != 0; entries--, p += whole) {
        bvxi_model part = {.entry = p};

        if (end - p < 46 || bvxi_load_u32(p, 0) != 0x02014b50) return fail_zip(s, p, "an entry is damaged");
        part.name = bvxi_load_u16(p + 28, 0);
        whole = 46 + part.name + bvxi_load_u16(p + 30, 0) + bvxi_load_u16(p + 32, 0);
        if (whole > (uint64_t)(end - p)) return fail_zip(s, p, "an entry is cut off");
        const uint8_t *const name = p + 46;
        for (uint64_t i = 0; i < part.name; i++)
            if (name[i] == '\\' || name[i] == ':' || (name[i] == '/' && i == 0) ||
                (name[i] == '.' && i > 0 && name[i - 1] == '.'))
                return fail_zip(s, name, "an entry has a name outside the container");
        if (part.name < 6 || !bvxi_word_is((const char *)p + 40 + part.name, 6, ".model")) continue;
        BVXI_TRY(find_bytes(s, &part));
        if (part.size > left)
            return BVXI_FILE_FAIL_FOR(s, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                                      "the models would have more than %d times the bytes of the file",
                                      (int64_t)MODEL_PACKED);
        left -= part.size;
        if (bvxi_word_is((const char *)p + 46, (size_t)part.name, "3d/3dmodel.model")) root = part;
        else m->model[m->count++] = part;
    }
    if (root.text == NULL) return BVXI_FILE_FAIL(s, BVX_ERR_FORMAT, "the file has no part 3D/3dmodel.model");
    m->model[m->count++] = root;
    return BVX_OK;
}

/* Deflate as gzip has it: with a header, and a trailer of what the directory states. */
static bvx_status unpack_model(const bvxi_source *s, const bvx_read_options *o, bvxi_model *part)
{
    static const uint8_t head[10] = {0x1f, 0x8b, 8, 0, 0, 0, 0, 0, 0, 255};
    uint32_t const crc = bvxi_load_u32(part->entry + 16, 0);
    uint8_t *packed, *plain = NULL;
    int failed;

    if (bvxi_load_u16(part->entry + 10, 0) == 0) {
        failed = bvxi_crc32(part->text, (size_t)part->size) != crc;
    } else {
        if (o->inflate == NULL)
            return BVXI_FILE_FAIL(s, BVX_ERR_UNSUPPORTED,
                                  "the model is packed; options.inflate is needed to unpack it");
        BVXI_TRY(BVXI_ARRAY(s->ctx, part->size, "the unpacked model", plain));
        BVXI_TRY(BVXI_ARRAY(s->ctx, part->packed + 18, "the packed model", packed));
        memcpy(packed, head, sizeof head);
        memcpy(packed + 10, part->text, (size_t)part->packed);
        bvxi_store_u32(packed + 10 + part->packed, crc);
        bvxi_store_u32(packed + 14 + part->packed, (uint32_t)part->size);
        failed = o->inflate(o->inflate_user, packed, part->packed + 18, plain, part->size) != 0;
        bvxi_drop(s->ctx, packed);
    }
    if (failed) return fail_zip(s, part->text, "the model is damaged");
    if (plain != NULL) part->text = plain;
    return BVX_OK;
}

/* Among the models by their names, the shorter ones first: behind those that are less than this one, or behind
 * those that are equal too. */
static uint64_t place_of_name(const bvxi_models *m, const void *name, uint64_t size, uint64_t count,
                              int equal)
{
    uint64_t low = 0, high = count;
    while (low < high) {
        uint64_t const middle = (low + high) / 2;
        const bvxi_model *const at = &m->model[m->order[middle]];
        int const sign = at->name != size ? at->name < size ? -1 : 1
                                          : memcmp(at->entry + 46, name, (size_t)size);
        if (sign < equal) low = middle + 1;
        else high = middle;
    }
    return low;
}

uint64_t bvxi_models_find(const bvxi_models *m, const char *path, uint64_t size)
{
    if (size == 0 || *path != '/') return m->count;
    uint64_t const i = place_of_name(m, path + 1, size - 1, m->count, 0);
    if (i == m->count) return m->count;
    const bvxi_model *const at = &m->model[m->order[i]];
    return at->name == size - 1 && memcmp(at->entry + 46, path + 1, (size_t)size - 1) == 0 ? m->order[i]
                                                                                           : m->count;
}

bvx_status bvxi_models_open(const bvxi_source *s, const bvx_read_options *o, bvxi_models *m)
{
    const uint8_t *const begin = (const uint8_t *)s->begin, *const end = (const uint8_t *)s->end;
    const uint8_t *p = end;
    uint64_t offset = UINT64_MAX, record;

    /* The last record that ends the file, its comment aside; before it may be the place of one of 64 bits. */
    while (p - begin >= 22 && end - p <= 65535 &&
           (bvxi_load_u32(p - 22, 0) != 0x06054b50 || bvxi_load_u16(p - 2, 0) != (uint64_t)(end - p)))
        p--;
    if (p - begin >= 22 && end - p <= 65535) offset = bvxi_load_u32(p - 6, 0);
    if (offset == UINT32_MAX && p - begin >= 22 + 20 + 56) {
        record = bvxi_load_u64(p - 22 - 12, 0);
        if (record < (uint64_t)(p - 22 - 20 - 56 - begin) + 1) offset = bvxi_load_u64(begin + record + 48, 0);
    }
    if (p - begin < 22 || offset > (uint64_t)(p - 22 - begin))
        return fail_zip(s, end, "no directory of a zip file ends the file");
    BVXI_TRY(find_models(s, m, begin + offset, p - 22, bvxi_load_u16(p - 12, 0)));
    for (uint64_t i = 0; i < m->count; i++) BVXI_TRY(unpack_model(s, o, &m->model[i]));

    BVXI_TRY(BVXI_ARRAY(s->ctx, m->count, "the models' order", m->order));
    for (uint64_t i = 0; i < m->count; i++) {
        const bvxi_model *const own = &m->model[i];
        uint16_t *const place = m->order + place_of_name(m, own->entry + 46, own->name, i, 1);
        memmove(place + 1, place, (size_t)(m->order + i - place) * sizeof *place);
        *place = (uint16_t)i;
    }
    return BVX_OK;
}
