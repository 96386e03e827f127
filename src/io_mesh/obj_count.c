/* obj_count.c - the first pass over an OBJ file: pieces of whole lines, and how much of everything stands in
 * each.
 *
 * Where pieces end follows from the size only, and no statement crosses from one to the next. The second
 * pass (read_obj.c) walks the same statements, so that its counts are these. */
#include "io_mesh/obj_text.h"

static const char *obj_count_corners(const obj_file *f, const char *p, uint64_t *corners)
{
    *corners = 0;
    for (p = obj_skip_blank(f, p); !obj_statement_ends(f, p); p = obj_skip_blank(f, p)) {
        /* most words are no more than this */
        while (p < f->end && (unsigned)(unsigned char)*p - '-' <= '9' - '-') p++;
        while (!obj_word_ends(f, p)) p++;
        ++*corners;
    }
    return p;
}

static void obj_count_piece(void *user, int32_t index, int32_t worker)
{
    const obj_file *const f = user;
    obj_piece *const piece = &f->pieces[index];

    (void)worker;
    for (const char *p = piece->begin; p < piece->end;) {
        uint64_t corners;
        p = obj_skip_blank(f, p);
        switch (p < f->end ? obj_take_keyword(f, &p) : OBJ_OTHER) {
        case OBJ_VERTEX:
            /* Where the first vertex and face begin: they decide
             * whether the file has colours and texture coordinates. */
            if (piece->vertices++ == 0) piece->vertex = p;
            p = obj_next_statement(f, p);
            break;
        case OBJ_TEXTURE:
            piece->uvs++;
            p = obj_next_statement(f, p);
            break;
        case OBJ_FACE:
            if (piece->face == NULL) piece->face = p;
            p = obj_next_line(f, obj_count_corners(f, p, &corners));
            /* A fan has two triangles fewer than its polygon has corners. */
            piece->triangles += corners < 3 ? 0 : corners - 2; /* fewer are refused later, with their line */
            piece->polygons += corners > 3;
            break;
        default: p = obj_next_line(f, p); break;
        }
    }
}

/* Pieces end where a line ends that is not continued. */
static bvx_status obj_make_pieces(obj_file *f)
{
    const bvxi_source *const s = f->source;
    uint64_t const size = bvxi_source_byte(s, s->end), count = size / BVXI_PIECE_BYTES + 1;
    const char *p = bvxi_skip_mark(s->begin, s->end);

    if (count > INT32_MAX)
        return bvxi_fail_for(s->ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                             "OBJ: the file has %u bytes, more than 2^50", size);
    f->piece_count = (int32_t)count;
    BVXI_TRY(bvxi_alloc_zero(s->ctx, BVXI_SCRATCH, count * sizeof *f->pieces, "the pieces of the file",
                             &f->pieces));
    for (uint64_t i = 0; i < count; i++) {
        /* A line that crosses the aim belongs to the piece before it, so each line is read once and whole. */
        const char *const aim = i + 1 < count ? s->begin + (size_t)(size / count * (i + 1)) : s->end;
        f->pieces[i].begin = p;
        while (p < s->end && (p < aim || obj_is_continued_end(f, p - 1)))
            p = obj_next_line(f, p < aim ? aim - 1 : p);
        f->pieces[i].end = p;
    }
    return BVX_OK;
}

static uint64_t obj_count_before(uint64_t *here, uint64_t before)
{
    uint64_t const counted = *here;
    *here = before;
    return before + counted;
}

bvx_status bvxi_obj_count(obj_file *file)
{
    obj_file *const f = file;
    bvx_context *const ctx = f->source->ctx;

    BVXI_TRY(obj_make_pieces(f));
    BVXI_TRY(bvxi_source_pieces(f->source, 0, 0.25, f->piece_count, obj_count_piece, f));

    /* Counts become first indices: what comes before each piece. */
    for (int32_t i = 0; i < f->piece_count; i++) {
        obj_piece *const piece = &f->pieces[i];
        f->vertices = obj_count_before(&piece->vertices, f->vertices);
        f->uvs = obj_count_before(&piece->uvs, f->uvs);
        f->triangles = obj_count_before(&piece->triangles, f->triangles);
        f->polygons = obj_count_before(&piece->polygons, f->polygons);
    }

    /* Indices are 32 bits wide. */
    if (f->vertices > UINT32_MAX || f->uvs > UINT32_MAX)
        return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                             "OBJ: the file has %u vertices and %u texture coordinates, the limit is below "
                             "2^32",
                             f->vertices, f->uvs);
    if (f->triangles > INT32_MAX)
        return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                             "OBJ: the file has %u triangles, the limit is below 2^31", f->triangles);
    return BVX_OK;
}
