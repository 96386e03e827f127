/* file_parts.c - the bytes of files that are written: buffers, and long files by several workers.
 *
 * The things of all parts, counted through, are cut into pieces. Each piece is written where it would begin
 * if everything before it had its greatest length; afterwards the pieces are pushed together. So text is made
 * once, by all workers, into one block, and files whose things have fixed lengths move nothing.
 * Guarantee: the bytes do not depend on workers or pieces. */
#include "io/file_parts.h"
#include "io/formats.h"

enum { FILE_PIECES = 256, FILE_PIECE_BYTES = 65536 };

typedef struct file_job {
    const bvxi_file_part *part;
    uint8_t *bytes; /* after the head */
    uint64_t things;
    int32_t parts, pieces;
    uint64_t made[FILE_PIECES]; /* bytes of each piece */
} file_job;

/* Where a thing would begin if all before it had their greatest length. */
static uint64_t file_place(const file_job *job, uint64_t thing)
{
    uint64_t place = 0;
    for (int32_t i = 0; i < job->parts; i++) {
        uint64_t const n = thing < job->part[i].count ? thing : job->part[i].count;
        place += n * job->part[i].most;
        thing -= n;
    }
    return place;
}

static void make_file_piece(void *user, int32_t index, uint64_t begin, uint64_t end)
{
    file_job *const job = user;
    uint64_t first = 0;
    uint8_t *start, *at;

    /* The room before a piece suits the longest text, so no worker waits to know how much the others made. */
    start = at = job->bytes + file_place(job, begin);
    /* A piece may reach over several parts: each writes its share of it, at the end of the share before. */
    for (int32_t i = 0; i < job->parts; i++) {
        uint64_t const last = first + job->part[i].count;
        uint64_t const from = begin > first ? begin : first, to = end < last ? end : last;
        if (from < to) at = job->part[i].put(job->part[i].user, from - first, to - first, at);
        first = last;
    }
    job->made[index] = (uint64_t)(at - start);
}

bvx_status bvxi_make_file(bvx_context *ctx, const char *what, double from, uint64_t head,
                          const bvxi_file_part *part, int32_t parts, bvx_buffer *file)
{
    /* The room is for the greatest length, since the true one is only known when the text is made. */
    file_job job = {.part = part, .parts = parts};
    for (int32_t i = 0; i < parts; i++) job.things += part[i].count;
    uint64_t const most = file_place(&job, job.things);
    job.pieces = bvxi_piece_count(most, FILE_PIECE_BYTES);
    BVXI_TRY(bvxi_make_buffer(ctx, head + most, what, file));
    job.bytes = file->bytes + head;
    bvx_status status = bvxi_for_pieces(ctx, "write", from, 1.0, job.pieces, job.things, make_file_piece,
                                        &job);
    if (status != BVX_OK) {
        bvx_buffer_free(ctx, file);
        return status;
    }

    /* What the greatest length has reserved beyond this stays as capacity. */
    /* The bytes of all pieces, now without gaps. */
    uint64_t size = 0, begin, end;

    for (int32_t i = 0; i < job.pieces; i++) {
        /* Bytes move down only, and the piece below has been moved
         * before: nothing is written over that is still needed. */
        bvxi_piece(job.things, job.pieces, i, &begin, &end);
        begin = file_place(&job, begin);
        if (begin != size) memmove(job.bytes + size, job.bytes + begin, (size_t)job.made[i]);
        size += job.made[i];
    }
    file->size = head + size;
    return BVX_OK;
}

bvx_status bvxi_renew_buffer(bvx_context *ctx, const char *function, bvx_buffer *file)
{
    if (file == NULL) return bvxi_fail_null(ctx, function, "file");
    /* Bytes of another allocator cannot be freed here. */
    if (file->bytes != NULL && file->capacity == 0)
        return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_NOT_EMPTY,
                             "%s: file brings bytes, which are not used; zero it first", function);
    bvx_buffer_free(ctx, file);
    return BVX_OK;
}

bvx_status bvxi_make_buffer(bvx_context *ctx, uint64_t size, const char *what, bvx_buffer *file)
{
    BVXI_TRY(bvxi_alloc(ctx, BVXI_RESULT, size, what, &file->bytes));
    file->size = file->capacity = size;
    return BVX_OK;
}
