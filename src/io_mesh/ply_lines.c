/* ply_lines.c - the rows of an ASCII PLY file by several threads, where each row is a line.
 *
 * The text after the header is cut into pieces of whole lines and the lines of each are counted, so that a
 * piece knows the row that it begins with. Then each reads its rows by the one reader of rows (ply_rows.c),
 * and holds that each of them ended its line. An element that is written otherwise, or that has something
 * wrong, is read again from its beginning row by row, which is allowed to take many lines and knows the
 * messages.
 *
 * Faces are placed as if all were triangles. Where some are not, this counts how many triangles come before
 * each piece, and the second pass over the faces, which is made then anyway, places them by that.
 * Guarantee: what is read, and every message, is that of one thread. */
#include "io_mesh/ply_file.h"

/* One run over the rows of an element. */
typedef struct ply_lines_job {
    const ply_file *file;
    const ply_element *element;
    int32_t first; /* piece */
    uint64_t end;  /* line after the element's last */
} ply_lines_job;

/* ---- pieces ---- */

/* Newlines, eight bytes at a time. */
static uint64_t count_newlines(const char *p, const char *end)
{
    uint64_t const ones = UINT64_C(0x0101010101010101), low = ones * 127, pattern = ones * '\n';
    uint64_t n = 0;

    while (end - p >= 8) {
        const char *const stop = end - p < 8 * 255 ? p + (end - p) / 8 * 8 : p + 8 * 255;
        uint64_t sums = 0, w;

        /* A byte that is zero, and no other, has its highest bit clear in both; each byte counts its own. */
        for (; p < stop; p += 8) {
            memcpy(&w, p, sizeof w);
            w ^= pattern;
            sums += ~(((w & low) + low) | w | low) >> 7;
        }
        for (; sums != 0; sums >>= 8) n += sums & 255;
    }
    for (; p < end; p++) n += *p == '\n';
    return n;
}

static void count_ply_piece(void *user, int32_t index)
{
    const ply_file *const f = user;
    ply_piece *const piece = &f->pieces[index];
    piece->line = count_newlines(piece->begin, piece->end);
    /* The last line of a file may lack its end. */
    if (piece->end == f->source->end && piece->end > piece->begin && piece->end[-1] != '\n') piece->line++;
}

bvx_status bvxi_ply_cut_lines(ply_file *f)
{
    bvxi_source *const s = f->source;
    uint64_t const size = (uint64_t)(s->end - f->p), count = size / BVXI_PIECE_BYTES + 1;
    const char *p = f->p;

    /* One thread reads at once what the pieces would count first. */
    if (bvxi_threads(s->ctx) == 1 || count < 2 || count > INT32_MAX) return BVX_OK;
    BVXI_TRY(bvxi_alloc_zero(s->ctx, BVXI_SCRATCH, (count + 1) * sizeof *f->pieces, "the pieces of the file",
                             &f->pieces));
    for (uint64_t i = 0; i < count; i++) {
        const char *const aim = f->p + (size_t)(size / count * (i + 1));

        /* A line that crosses the aim belongs to the piece before it. */
        f->pieces[i].begin = p;
        if (i + 1 == count) p = s->end;
        else if (p < aim) p = bvxi_find_byte(aim, s->end, '\n');
        if (p < s->end && p > f->pieces[i].begin) p++;
        f->pieces[i].end = p;
    }
    f->piece_count = (int32_t)count;
    BVXI_TRY(bvxi_source_pieces(s, 0.0, PLY_COUNTING, f->piece_count, count_ply_piece, f));

    /* Counts become the line that each begins with; the one after the last piece has them all. */
    uint64_t lines = 0;
    for (uint64_t i = 0; i <= count; i++) {
        uint64_t const here = f->pieces[i].line;
        f->pieces[i].line = lines;
        lines += here;
    }
    return BVX_OK;
}

/* ---- rows ---- */

/* Rows of a piece, which begins at own->p; 0 when one is not a line or cannot be read. */
static int take_rows_of_lines(ply_file *own, const ply_element *e, uint64_t row, uint64_t end_row)
{
    const char *const end = own->source->end;

    for (; row < end_row; row++) {
        /* A row reads on where its line ends: what it took too much is found at the piece's end. */
        if (own->p >= end || bvxi_ply_take_text_row(own, e, row) != BVX_OK) return 0;
        while (own->p < end && bvxi_is_blank(*own->p)) own->p++;
        if (own->p < end && *own->p++ != '\n') return 0;
    }
    return 1;
}

static void take_ply_piece(void *user, int32_t index)
{
    const ply_lines_job *const job = user;
    const ply_file *const f = job->file;
    ply_piece *const piece = &f->pieces[job->first + index];
    uint64_t const first = piece->line > f->line ? piece->line : f->line;
    uint64_t const end = piece[1].line < job->end ? piece[1].line : job->end;
    uint64_t const row = first - f->line, end_row = end - f->line;
    const char *const begin = index == 0 ? f->p : piece->begin;
    bvxi_source source = *f->source;
    ply_file own = *f;

    /* No context: a failure is a status only. Nor is progress reported, as no row begins at the end. */
    source.ctx = NULL;
    source.end = source.ask = piece->end;
    own.source = &source;
    own.p = begin;

    /* At first a triangle a face is expected, and what would fall into the next piece's is only counted. */
    if (f->fans == NULL) {
        own.triangle_count = f->triangle_count + row;
        own.room = f->triangle_count + end_row < f->room ? f->triangle_count + end_row : f->room;
    } else {
        own.triangle_count = piece->triangles;
        own.polygon_count = piece->polygons;
    }
    uint64_t const triangles = own.triangle_count, polygons = own.polygon_count;

    /* As many newlines as rows, each row having its own at its end: so none had another one inside. */
    piece->is_odd = !take_rows_of_lines(&own, job->element, row, end_row) ||
                    (end == piece[1].line ? own.p != piece->end
                                          : count_newlines(begin, own.p) != end_row - row);
    piece->reached = own.p;
    piece->triangles = own.triangle_count - triangles;
    piece->polygons = own.polygon_count - polygons;
}

/* Where in the pass a place of the file is. */
static double ply_share(const bvxi_source *s, const char *at)
{
    return PLY_COUNTING + (1.0 - PLY_COUNTING) * ((double)(at - s->begin) / (double)(s->end - s->begin));
}

static void count_before_ply_pieces(ply_file *f, int32_t first, int32_t last)
{
    uint64_t triangles = f->triangle_count, polygons = f->polygon_count;

    for (int32_t i = first; i <= last; i++) {
        ply_piece *const piece = &f->pieces[i];
        uint64_t const three = piece->triangles, more = piece->polygons;
        piece->triangles = triangles;
        piece->polygons = polygons;
        triangles += three;
        polygons += more;
    }
    f->triangle_count = triangles;
    f->polygon_count = polygons;
}

bvx_status bvxi_ply_take_lines(ply_file *f, const ply_element *e, int *taken)
{
    ply_lines_job job = {.file = f, .element = e, .end = f->line + e->count};
    int32_t last = 0;

    /* Strips and texture coordinates of corners go on from row to row. */
    *taken = e->count == 0 || e->end == e->first;
    if (*taken || e->kind == PLY_STRIPS || (e->kind == PLY_FACE && f->uvs_at_corners)) return BVX_OK;
    if (job.end < f->line || job.end > f->pieces[f->piece_count].line) return BVX_OK;

    while (f->pieces[job.first + 1].line <= f->line) job.first++;
    for (last = job.first; f->pieces[last + 1].line < job.end;) last++;
    BVXI_TRY(bvxi_source_pieces(f->source, ply_share(f->source, f->p),
                                ply_share(f->source, f->pieces[last].end), last - job.first + 1,
                                take_ply_piece, &job));
    for (int32_t i = job.first; i <= last; i++)
        if (f->pieces[i].is_odd) return BVX_OK;

    if (e->kind == PLY_FACE) count_before_ply_pieces(f, job.first, last);
    f->p = f->pieces[last].reached;
    f->line = job.end;
    *taken = 1;
    return BVX_OK;
}
