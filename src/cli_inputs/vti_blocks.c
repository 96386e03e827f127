/* vti_blocks.c - VTK's XML images with zlib blocks, as VTK and ParaView write them, become the same file
 * without.
 *
 * Source: VTK File Formats (docs.vtk.org). An array is a head of numbers - blocks, bytes of a block, bytes of
 * the last one or 0, packed bytes of each - and the packed blocks; as base64 the head is one text and the
 * blocks together are another. What stands here afterwards has all arrays appended as they are, their tags
 * with the new offsets. Other packers are left to the reader, which refuses them. Guarantee: what a head says
 * is held against the file's bytes, and against the memory allowed, before anything is made. */
#include "cli_inputs/inputs.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#ifdef BVX_HAVE_ZLIB
#include <zlib.h>
#endif

enum { VTI_WORST_RATIO = 1032, VTI_HEAD_NUMBERS = 3 };

typedef struct vti_packed {
    cli_run *run;
    const char *path;
    const char *begin, *end;
    const char *appended; /* after the underscore, or NULL */
    const char *text_end; /* of the tags: "<AppendedData", or "</VTKFile" */
    int head_size, big, appended_base64;
    cli_text text;  /* the new tags */
    cli_bytes data; /* the arrays one after the other, each with its length */
} vti_packed;

/* One array in the file. */
typedef struct vti_source {
    const unsigned char *at;
    size_t have; /* bytes or characters from there on */
    int is_base64;
} vti_source;

/* ---- text ---- */

static const char *find_text(const char *p, const char *end, const char *word)
{
    size_t const n = strlen(word);

    for (; (size_t)(end - p) >= n; p++) {
        p = memchr(p, word[0], (size_t)(end - p) - n + 1);
        if (p == NULL) return NULL;
        if (memcmp(p, word, n) == 0) return p;
    }
    return NULL;
}

/* An attribute's value in a tag; 0 where it has none of this name. */
static int find_attribute(const char *tag, const char *tag_end, const char *name, const char **value,
                          size_t *size)
{
    size_t const n = strlen(name);

    for (const char *p = tag; (p = find_text(p, tag_end, name)) != NULL; p += n) {
        const char *q = p + n;
        const char *close;
        /* A name inside another name or inside a value is not the attribute. */
        if (p == tag || strchr(" \t\r\n", p[-1]) == NULL || (size_t)(tag_end - q) < 2 || q[0] != '=' ||
            (q[1] != '"' && q[1] != '\''))
            continue;
        close = memchr(q + 2, q[1], (size_t)(tag_end - q) - 2);
        if (close == NULL) return 0;
        *value = q + 2;
        *size = (size_t)(close - *value);
        return 1;
    }
    return 0;
}

static int attribute_is(const char *tag, const char *tag_end, const char *name, const char *wanted)
{
    const char *value;
    size_t size;

    return find_attribute(tag, tag_end, name, &value, &size) && size == strlen(wanted) &&
           memcmp(value, wanted, size) == 0;
}

#ifdef BVX_HAVE_ZLIB

static int fail_vti(const vti_packed *v, const char *why)
{
    return cli_fail(v->run, "%s: VTI: %s", v->path, why);
}

/* ---- bytes of an array ---- */

static int base64_digit(unsigned char c)
{
    if (c >= 'A' && c <= 'Z') return c - 'A';
    if (c >= 'a' && c <= 'z') return c - 'a' + 26;
    if (c >= '0' && c <= '9') return c - '0' + 52;
    return c == '+' ? 62 : c == '/' ? 63 : -1;
}

/* Take n bytes; of base64 the text that holds them, to its last four
 * characters. 0 where the source ends before. */
static int take_bytes(vti_source *s, unsigned char *to, size_t n)
{
    if (!s->is_base64) {
        if (s->have < n) return 0;
        memcpy(to, s->at, n);
        s->at += n;
        s->have -= n;
        return 1;
    }
    for (size_t done = 0; done < n;) {
        uint32_t bits = 0;
        int digits = 0;
        for (int k = 0; k < 4; s->at++, s->have--) {
            /* Characters in fours; spaces between them do not count. */
            if (s->have == 0) return 0;
            if (strchr(" \t\r\n", *s->at) != NULL && *s->at != 0) continue;
            int const d = base64_digit(*s->at);
            if (d < 0 && *s->at != '=') return 0;
            bits = bits << 6 | (uint32_t)(d < 0 ? 0 : d);
            digits += d >= 0;
            k++;
        }
        for (int k = 0; k < digits - 1 && done < n; k++)
            to[done++] = (unsigned char)(bits >> (16 - 8 * k) & 255);
        /* Padding ends the text, wanted bytes or not. */
        if (digits < 4 && done < n) return 0;
    }
    return 1;
}

static uint64_t number_at(const vti_packed *v, const unsigned char *p)
{
    uint64_t n = 0;

    for (int k = 0; k < v->head_size; k++) n = n << 8 | p[v->big ? k : v->head_size - 1 - k];
    return n;
}

static void put_number(const vti_packed *v, uint64_t n, unsigned char *p)
{
    for (int k = 0; k < v->head_size; k++)
        p[v->big ? v->head_size - 1 - k : k] = (unsigned char)(n >> (8 * k) & 255);
}

static int inflate_block(const unsigned char *packed, uint64_t packed_size, unsigned char *plain,
                         uint64_t plain_size)
{
    uLongf made = (uLongf)plain_size;

    return packed_size <= UINT32_MAX && plain_size <= UINT32_MAX &&
           uncompress(plain, &made, packed, (uLong)packed_size) == Z_OK && made == plain_size;
}

/* Room for more bytes after the arrays that are there. */
static int make_data_room(vti_packed *v, uint64_t more)
{
    uint64_t const size = v->data.size + more;
    unsigned char *bytes;

    if (size > v->data.limit)
        return cli_fail(v->run,
                        "%s: VTI: %" PRIu64 " bytes of unpacked arrays are more than the %" PRIu64
                        " that are left for them",
                        v->path, size, v->data.limit);
    /* Exactly as much as is said: the sizes of blocks were checked against the file. */
    bytes = realloc(v->data.bytes, (size_t)size);
    if (bytes == NULL) return cli_fail(v->run, "%s: no memory for %" PRIu64 " bytes of it", v->path, size);
    v->data.bytes = bytes;
    return CLI_DONE;
}

/* The blocks, of which the head gives the sizes, after the others. */
static int unpack_blocks(vti_packed *v, vti_source *s, const unsigned char *head, uint64_t blocks)
{
    size_t const step = (size_t)v->head_size;
    uint64_t const block = number_at(v, head + step), last = number_at(v, head + 2 * step);
    uint64_t packed = 0, most, all;
    unsigned char *bytes;
    int status = CLI_DONE;

    for (uint64_t i = 0; i < blocks; i++) {
        uint64_t const n = number_at(v, head + (VTI_HEAD_NUMBERS + i) * step);
        /* Sizes of a stranger's file: checked before anything is added up or allocated. */
        if (n > s->have || packed + n > s->have)
            return fail_vti(v, "packed blocks continue after the end of the file");
        packed += n;
    }
    /* zlib packs no better than that, so more is a lie that memory would pay for. */
    most = packed * VTI_WORST_RATIO + 64;
    if (blocks != 0 && (block > most || last > block || blocks > most / (block != 0 ? block : 1) + 1))
        return fail_vti(v, "packed blocks are said to hold more than they can");
    all = blocks == 0 ? 0 : block * (blocks - 1) + (last != 0 ? last : block);
    status = make_data_room(v, all + step);
    if (status != CLI_DONE) return status;
    /* An array without blocks begins with its length. */
    put_number(v, all, v->data.bytes + v->data.size);
    v->data.size += step;

    bytes = malloc((size_t)packed + 1);
    if (bytes == NULL) return cli_fail(v->run, "%s: no memory for %" PRIu64 " bytes of it", v->path, packed);
    if (!take_bytes(s, bytes, (size_t)packed))
        status = fail_vti(v, "the text of the packed blocks ends too soon");
    for (uint64_t i = 0, at = 0; i < blocks && status == CLI_DONE; i++) {
        uint64_t const n = number_at(v, head + (VTI_HEAD_NUMBERS + i) * step);
        uint64_t const plain = i + 1 == blocks && last != 0 ? last : block;
        if (!inflate_block(bytes + at, n, v->data.bytes + v->data.size, plain))
            status = fail_vti(v, "a packed block is damaged");
        else if (cli_progress(v->run, "unpack", (double)(i + 1) / (double)blocks))
            status = cli_fail_interrupted(v->run);
        v->data.size += (size_t)plain;
        at += n;
    }
    free(bytes);
    return status;
}

static int unpack_array(vti_packed *v, vti_source s)
{
    size_t const step = (size_t)v->head_size;
    vti_source first = s;
    unsigned char number[8], *head;
    uint64_t blocks;
    int status;

    /* The count of blocks says how long the head is; it is read again with it. */
    if (!take_bytes(&first, number, step)) return fail_vti(v, "an array ends within its head");
    blocks = number_at(v, number);
    if (blocks > s.have / step) return fail_vti(v, "an array has more blocks than the file has bytes for");
    head = calloc((size_t)(VTI_HEAD_NUMBERS + blocks), step);
    if (head == NULL)
        return cli_fail(v->run, "%s: no memory for the sizes of %" PRIu64 " blocks", v->path, blocks);
    if (!take_bytes(&s, head, (size_t)(blocks == 0 ? 1 : VTI_HEAD_NUMBERS + blocks) * step))
        status = fail_vti(v, "an array ends within its head");
    else status = unpack_blocks(v, &s, head, blocks);
    free(head);
    return status;
}

/* ---- tags ---- */

/* A tag without one attribute and with others in its place. */
static void put_tag(vti_packed *v, const char *tag, const char *tag_end, const char *without,
                    const char *with)
{
    const char *value;
    size_t size;

    /* Nothing to take out: the tag is copied as it is. */
    if (!find_attribute(tag, tag_end, without, &value, &size)) {
        cli_text_add(&v->text, "%.*s", (int)(tag_end - tag), tag);
        return;
    }
    cli_text_add(&v->text, "%.*s%s%.*s", (int)(value - 2 - strlen(without) - tag), tag, with,
                 (int)(tag_end - value - (ptrdiff_t)size - 1), value + size + 1);
}

static int take_array(vti_packed *v, const char *tag, const char *tag_end, const char **behind)
{
    int const is_inline = attribute_is(tag, tag_end, "format", "binary");
    vti_source s = {(const unsigned char *)tag_end, 0, 1};
    char with[64];
    const char *value, *close;
    size_t size;

    *behind = tag_end;
    if (is_inline) {
        /* The array's text reaches to the next tag and goes; the tag says where it lies now. */
        close = memchr(tag_end, '<', (size_t)(v->end - tag_end));
        s.have = (size_t)((close != NULL ? close : v->end) - tag_end);
        *behind = close != NULL ? close : v->end;
        snprintf(with, sizeof with, "format=\"appended\" offset=\"%" PRIu64 "\"", (uint64_t)v->data.size);
        put_tag(v, tag, tag_end, "format", with);
        return unpack_array(v, s);
    }
    if (!attribute_is(tag, tag_end, "format", "appended") || v->appended == NULL ||
        !find_attribute(tag, tag_end, "offset", &value, &size)) {
        /* ascii; what is wrong is for the reader to refuse */
        cli_text_add(&v->text, "%.*s", (int)(tag_end - tag), tag);
        return CLI_DONE;
    }
    uint64_t const offset = strtoull(value, NULL, 10); /* a quote ends it */
    if (offset > (uint64_t)(v->end - v->appended))
        return fail_vti(v, "an array is said to start after the end of the file");
    s.at = (const unsigned char *)v->appended + offset;
    s.have = (size_t)((uint64_t)(v->end - v->appended) - offset);
    s.is_base64 = v->appended_base64;
    snprintf(with, sizeof with, "offset=\"%" PRIu64 "\"", (uint64_t)v->data.size);
    put_tag(v, tag, tag_end, "offset", with);
    return unpack_array(v, s);
}

static int take_tags(vti_packed *v)
{
    const char *p = v->begin;
    int status = CLI_DONE;

    while (p < v->text_end && status == CLI_DONE) {
        const char *const tag = memchr(p, '<', (size_t)(v->text_end - p));
        const char *tag_end;
        if (tag == NULL) break;
        cli_text_add(&v->text, "%.*s", (int)(tag - p), p);
        tag_end = memchr(tag, '>', (size_t)(v->end - tag));
        if (tag_end == NULL) return fail_vti(v, "a tag does not end");
        p = ++tag_end;
        /* The compressor goes from the root, arrays move behind the tags, all else is copied. */
        if (tag_end - tag > 9 && memcmp(tag, "<VTKFile", 8) == 0) put_tag(v, tag, tag_end, "compressor", "");
        else if (tag_end - tag > 11 && memcmp(tag, "<DataArray", 10) == 0)
            status = take_array(v, tag, tag_end, &p);
        else cli_text_add(&v->text, "%.*s", (int)(tag_end - tag), tag);
    }
    cli_text_add(&v->text, "\n<AppendedData encoding=\"raw\">\n_");
    return status == CLI_DONE && v->text.failed ? cli_fail(v->run, "%s: no memory for its tags", v->path)
                                                : status;
}

/* ---- the file ---- */

static void find_parts(vti_packed *v, const char *root, const char *root_end)
{
    const char *const appended = find_text(root_end, v->end, "<AppendedData");
    const char *tag_end = appended != NULL ? memchr(appended, '>', (size_t)(v->end - appended)) : NULL;

    v->head_size = attribute_is(root, root_end, "header_type", "UInt64") ? 8 : 4;
    v->big = attribute_is(root, root_end, "byte_order", "BigEndian");
    v->text_end = appended != NULL ? appended : find_text(root_end, v->end, "</VTKFile");
    if (v->text_end == NULL) v->text_end = v->end;
    /* No appended arrays: all stand in their tags. */
    if (tag_end == NULL) return;
    v->appended_base64 = attribute_is(appended, tag_end, "encoding", "base64");
    v->appended = memchr(tag_end, '_', (size_t)(v->end - tag_end));
    if (v->appended != NULL) v->appended++;
}

/* Tags, arrays and the end as one file, in place of the packed one. */
static int join_parts(vti_packed *v, cli_bytes *b)
{
    static const char foot[] = "\n</AppendedData>\n</VTKFile>\n";
    size_t const size = v->text.size + v->data.size + sizeof foot - 1;
    unsigned char *const bytes = malloc(size + 1);

    if (bytes == NULL)
        return cli_fail(v->run, "%s: no memory for %" PRIu64 " bytes of it", v->path, (uint64_t)size);
    /* The peak: the packed file, the arrays and the new file together. */
    memcpy(bytes, v->text.bytes, v->text.size);
    if (v->data.size != 0) memcpy(bytes + v->text.size, v->data.bytes, v->data.size);
    memcpy(bytes + v->text.size + v->data.size, foot, sizeof foot - 1);
    cli_note_peak(v->run, (uint64_t)size + v->data.size + b->size);
    free(b->bytes);
    b->bytes = bytes;
    b->size = size;
    b->room = size + 1;
    return CLI_DONE;
}

#endif

int cli_unpack_vti(cli_run *run, const char *path, cli_bytes *b)
{
    const char *const begin = (const char *)b->bytes, *const end = begin + b->size;
    const char *const root = b->size != 0 ? find_text(begin, end, "<VTKFile") : NULL;
    const char *const root_end = root != NULL ? memchr(root, '>', (size_t)(end - root)) : NULL;

    if (root_end == NULL || !attribute_is(root, root_end, "compressor", "vtkZLibDataCompressor"))
        return CLI_DONE;
#ifdef BVX_HAVE_ZLIB
    vti_packed v = {.run = run, .path = cli_input_name(path), .begin = begin, .end = end};
    int status;

    /* arrays, and the file made of them */
    v.data.limit = b->limit > 2 * (uint64_t)b->size ? (b->limit - b->size) / 2 : b->limit / 4;
    find_parts(&v, root, root_end);
    status = take_tags(&v);
    if (status == CLI_DONE) status = join_parts(&v, b);
    free(v.data.bytes);
    cli_text_free(&v.text);
    return status;
#else
    return cli_fail(run, "%s: blocks of zlib, which this build cannot unpack: it was made without",
                    cli_input_name(path));
#endif
}
