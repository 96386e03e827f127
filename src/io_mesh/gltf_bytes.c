/* gltf_bytes.c - the bytes of a glTF file's buffers and images: of the GLB's own chunk, of data URIs, of files
 * that the caller opens.
 *
 * Sources: Khronos Group. glTF 2.0 Specification, 3.6.1. RFC 2397 (data URIs), RFC 3986 (percent-encoding).
 * A name that is not relative to the file's own folder or below is never asked for. Nothing is opened or
 * decoded before it is used. */
#include "io_mesh/gltf.h"
#include "io/xml_scan.h"

/* ---- uris ---- */

/* Percent-encoding is replaced in place. Returns 0 where the name is no relative one: of another folder, with
 * a scheme or a drive, or with bytes that no name has. */
static int gltf_plain_name(char *name)
{
    char *to = name;
    const char *segment = name;

    for (const char *p = name; *p != 0; p++) {
        unsigned char c = (unsigned char)*p;

        if (c == '%') {
            static const char digits[] = "0123456789abcdef0123456789ABCDEF";
            const char *const stop = digits + 32;
            const char *const high = bvxi_find_byte(digits, stop, p[1]);
            const char *const low = high != stop ? bvxi_find_byte(digits, stop, p[2]) : stop;

            if (high == stop || low == stop) return 0;
            c = (unsigned char)((unsigned)(high - digits) % 16 * 16 + (unsigned)(low - digits) % 16);
            p += 2;
        }
        if (c < ' ' || c == '\\' || c == ':' || c == 0x7f) return 0;
        *to++ = (char)c;
    }
    *to = 0;

    if (*name == 0 || *name == '/') return 0;
    for (const char *p = name;; p++) {
        if (*p != '/' && *p != 0) continue;
        if (p - segment == 2 && segment[0] == '.' && segment[1] == '.') return 0;
        if (*p == 0) return 1;
        segment = p + 1;
    }
}

/* The base64 of a data URI, which may be megabytes: at is where it stands in the file, for messages. */
static bvx_status gltf_decode(const bvxi_gltf *f, const char *p, const char *end, uint64_t at,
                              bvxi_gltf_bytes *found)
{
    bvx_context *const ctx = f->source->ctx;
    uint64_t digits = 0;
    bvxi_base64 b;

    bvxi_base64_start(&b, p, end);
    for (const char *c = p; c < end; c++) digits += b.digit[(unsigned char)*c] < 64;
    found->size = digits / 4 * 3 + (digits % 4 != 0 ? digits % 4 - 1 : 0);
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, found->size, "the bytes of a data URI", &found->decoded));
    found->bytes = found->decoded;
    if (!bvxi_base64_take(&b, found->decoded, found->size) || digits % 4 == 1)
        return BVXI_FILE_FAIL(f->source, BVX_ERR_FORMAT, "byte %u: the data URI is not base64",
                              at + (uint64_t)(b.p - p));
    for (const char *c = b.p; c < end; c++)
        if (b.digit[(unsigned char)*c] == 64)
            return BVXI_FILE_FAIL(f->source, BVX_ERR_FORMAT, "byte %u: the data URI is not base64",
                                  at + (uint64_t)(c - p));
    return BVX_OK;
}

/* size: of the name, which ends earlier where a zero byte is in it. */
static bvx_status gltf_open_file(bvxi_gltf *f, char *name, uint32_t size, bvxi_gltf_bytes *found)
{
    const bvx_read_options *const o = f->options;

    if (bvxi_text_length(name) != size || !gltf_plain_name(name) || o->open_file == NULL) return BVX_OK;
    if (o->open_file(o->user, name, &found->file) != 0) return BVX_OK;
    found->is_open = 1;
    found->bytes = found->file.bytes;
    found->size = found->bytes != NULL ? found->file.size : 0;
    if (found->size > SIZE_MAX / 2 || found->size > UINT64_MAX / 2 - f->bytes)
        return BVXI_FILE_FAIL_FOR(f->source, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                                  "a file that it names has %u bytes, more than memory can hold",
                                  found->size);
    f->bytes += found->size;
    return BVX_OK;
}

bvx_status bvxi_gltf_uri(bvxi_gltf *f, uint32_t uri, bvxi_gltf_bytes *found)
{
    static const char data[] = "data:", base64[] = ";base64";
    bvx_context *const ctx = f->source->ctx;
    const char *const start = f->json.text + f->json.value[uri].at + 1;
    uint32_t size, comma;
    const char *text = bvxi_json_text(&f->json, uri, &size);
    char *plain = NULL;
    bvx_status status = BVX_OK;

    /* A text without escapes is read where it stands: it may be most of the file. */
    if (bvxi_find_byte(text, text + size, '\\') != text + size || size < 5 || memcmp(text, data, 5) != 0) {
        BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, (uint64_t)size + 1, "a uri", &plain));
        size = bvxi_json_plain(&f->json, uri, plain);
        text = plain;
    }
    if (size >= 5 && memcmp(text, data, 5) == 0) {
        comma = (uint32_t)(bvxi_find_byte(text, text + size, ',') - text);
        if (comma == size || comma < 12 || memcmp(text + comma - 7, base64, 7) != 0)
            return BVXI_BYTE_FAIL(f->source, start, BVX_ERR_FORMAT, "a data URI without ';base64,'");
        status = gltf_decode(f, text + comma + 1, text + size, bvxi_source_byte(f->source, start) + comma + 1,
                             found);
    } else {
        status = gltf_open_file(f, plain, size, found);
    }
    bvxi_drop(ctx, plain);
    return status;
}

static void gltf_close_bytes(const bvxi_gltf *f, bvxi_gltf_bytes *list, uint32_t count)
{
    for (uint32_t i = 0; list != NULL && i < count; i++)
        if (list[i].is_open) f->options->close_file(f->options->user, &list[i].file);
}

void bvxi_gltf_close(bvxi_gltf *f)
{
    gltf_close_bytes(f, f->buffer, f->list_count[BVXI_GLTF_BUFFER]);
    gltf_close_bytes(f, f->image, f->list_count[BVXI_GLTF_IMAGE]);
}

/* ---- buffers and their views ---- */

static bvx_status gltf_buffer(bvxi_gltf *f, uint64_t i, bvxi_gltf_bytes **buffer)
{
    bvxi_gltf_bytes *b;
    uint32_t value, uri;
    uint64_t length;

    BVXI_TRY(bvxi_gltf_item(f, BVXI_GLTF_BUFFER, i, "a bufferView", &value));
    *buffer = b = &f->buffer[i];
    if (b->bytes != NULL) return BVX_OK;
    BVXI_TRY(bvxi_gltf_whole(f, BVXI_GLTF_BUFFER, i, value, "byteLength", BVXI_GLTF_MUST, &length));

    uri = bvxi_json_member(&f->json, value, "uri");
    if (bvxi_json_kind(&f->json, uri) == BVXI_JSON_TEXT) {
        char shown[64];
        BVXI_TRY(bvxi_gltf_uri(f, uri, b));
        uint32_t size, n;
        const char *const text = bvxi_json_text(&f->json, uri, &size);
        n = size < 60 ? size : 60;
        memcpy(shown, text, n);
        memcpy(shown + n, size > 60 ? "..." : "", size > 60 ? 4 : 1);
        if (b->bytes == NULL)
            return BVXI_FILE_FAIL(
                f->source, BVX_ERR_FORMAT,
                "buffer %u: there is no file '%s' beside the file that names it; a .glb holds "
                "all in one file",
                i, shown);
    } else if (i == 0 && f->chunk != NULL) {
        b->bytes = f->chunk;
        b->size = f->chunk_size;
    } else {
        return bvxi_gltf_fail(f, BVXI_GLTF_BUFFER, i, "it has neither a uri nor a chunk of the file");
    }
    if (length > b->size)
        return BVXI_FILE_FAIL(f->source, BVX_ERR_FORMAT, "buffer %u: byteLength is %u, there are %u bytes", i,
                              length, b->size);
    b->size = length;
    return BVX_OK;
}

bvx_status bvxi_gltf_view(bvxi_gltf *f, uint64_t view, const uint8_t **bytes, uint64_t *size,
                          uint64_t *stride, uint64_t *at)
{
    static const char *const packed[] = {"EXT_meshopt_compression", "KHR_meshopt_compression"};
    bvxi_gltf_bytes *buffer = NULL;
    uint32_t value, index;
    uint64_t begin;

    BVXI_TRY(bvxi_gltf_item(f, BVXI_GLTF_VIEW, view, "an accessor or an image", &value));
    for (size_t k = 0; k < 2; k++)
        if (bvxi_json_member(&f->json, bvxi_json_member(&f->json, value, "extensions"), packed[k]) !=
            BVXI_JSON_NONE)
            return BVXI_FILE_FAIL(f->source, BVX_ERR_UNSUPPORTED,
                                  "bufferView %u is compressed by %s, which is not read; export the file "
                                  "without mesh compression",
                                  view, packed[k]);
    BVXI_TRY(bvxi_gltf_index(f, BVXI_GLTF_VIEW, view, value, "buffer", BVXI_GLTF_BUFFER, &index));
    if (index == BVXI_JSON_NONE) return bvxi_gltf_fail(f, BVXI_GLTF_VIEW, view, "it has no buffer");
    BVXI_TRY(bvxi_gltf_whole(f, BVXI_GLTF_VIEW, view, value, "byteOffset", 0, &begin));
    BVXI_TRY(bvxi_gltf_whole(f, BVXI_GLTF_VIEW, view, value, "byteLength", BVXI_GLTF_MUST, size));
    BVXI_TRY(bvxi_gltf_whole(f, BVXI_GLTF_VIEW, view, value, "byteStride", 0, stride));
    BVXI_TRY(gltf_buffer(f, index, &buffer));

    if (begin > buffer->size || *size > buffer->size - begin)
        return BVXI_FILE_FAIL(f->source, BVX_ERR_FORMAT,
                              "bufferView %u: bytes %u to %u lie beyond the %u of buffer %u", view, begin,
                              begin + *size, buffer->size, (uint64_t)index);
    if (*stride != 0 && (*stride < 4 || *stride > 252 || *stride % 4 != 0))
        return bvxi_gltf_fail(f, BVXI_GLTF_VIEW, view, "byteStride is not a multiple of 4 from 4 to 252");
    *bytes = buffer->bytes + begin;
    *at = begin;
    return BVX_OK;
}
