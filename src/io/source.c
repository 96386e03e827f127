/* source.c - the bytes of a file while they are read: progress once a megabyte, pieces read side by side,
 * and messages that say where.
 *
 * Guarantee: of several pieces the first one that fails, in the order of the file, is the one reported. */
#include "io/formats.h"

enum { SOURCE_ASK_BYTES = 1 << 20, SOURCE_WORD_SHOWN = 24, SOURCE_GROUP = 64 };

void bvxi_source_pass(bvxi_source *source, double from, double to)
{
    source->ask = source->begin;
    source->from = from;
    source->to = to;
}

bvx_status bvxi_source_ask(bvxi_source *source, const char *at)
{
    double const done = (double)(at - source->begin) / (double)(source->end - source->begin);
    double const fraction = source->from + (source->to - source->from) * done;
    source->ask = source->end - at > SOURCE_ASK_BYTES ? at + SOURCE_ASK_BYTES : source->end;
    if (source->ask == at) return BVX_OK;
    if (fraction > source->reached) source->reached = fraction;
    return bvxi_progress(source->ctx, "read", source->reached);
}

typedef struct source_group {
    bvxi_item_fn *task;
    void *user;
    int32_t first;
} source_group;

static void source_run_piece(void *user, int32_t index)
{
    const source_group *const g = user;
    g->task(g->user, g->first + index);
}

/* A few pieces at a time, so that a large file reports progress as often as a small one. */
bvx_status bvxi_source_pieces(bvxi_source *source, double from, double to, int32_t count, bvxi_item_fn *task,
                              void *user)
{
    double const share = (to - from) / (double)count;

    for (int32_t i = 0; i < count; i += SOURCE_GROUP) {
        int32_t const n = count - i < SOURCE_GROUP ? count - i : SOURCE_GROUP;
        source_group g = {task, user, 0};
        g.first = i;
        /* The last group ends exactly at to, whatever the sum of shares rounds to. */
        source->reached = i + n == count ? to : from + share * (double)(i + n);
        BVXI_TRY(bvxi_each(source->ctx, "read", from + share * (double)i, source->reached, n,
                           source_run_piece, &g));
    }
    return BVX_OK;
}

uint64_t bvxi_source_line(const bvxi_source *source, const char *at)
{
    uint64_t n = 1;
    if (source->ctx == NULL) return 0;
    for (const char *p = source->begin; p < at; p++) /* a lone carriage return ends a line too */
        n += *p == '\n' || (*p == '\r' && (p + 1 == source->end || p[1] != '\n'));
    return n;
}

bvx_status bvxi_fail_expected(const bvxi_source *source, const char *at, const char *expected)
{
    char word[SOURCE_WORD_SHOWN + 4];
    const char *const stop = bvxi_skip_word(at, source->end);
    size_t const n = (size_t)(stop - at);
    size_t const shown = n < SOURCE_WORD_SHOWN ? n : SOURCE_WORD_SHOWN;

    /* Pieces that are read side by side are silent: the first that failed is read again with a context. */
    if (source->ctx == NULL) return BVX_ERR_FORMAT;
    if (at == source->end)
        return BVXI_LINE_FAIL(source, at, BVX_ERR_FORMAT, "the file ends where %s was expected", expected);
    if (n == 0)
        return BVXI_LINE_FAIL(source, at, BVX_ERR_FORMAT, "the line ends where %s was expected", expected);
    memcpy(word, at, shown);

    /* A message ends at a zero byte, so one in the word must not cut it short. */
    for (size_t i = 0; i < shown; i++)
        if (word[i] == 0) word[i] = '?';
    memcpy(word + shown, n > shown ? "..." : "", n > shown ? 4 : 1);
    return BVXI_LINE_FAIL(source, at, BVX_ERR_FORMAT, "expected %s, found '%s'", expected, word);
}

bvx_status bvxi_check_bytes(bvx_context *ctx, const char *function, const void *bytes, uint64_t size)
{
    if (bytes == NULL) return bvxi_fail_null(ctx, function, "bytes");
    if (size <= SIZE_MAX / 2) return BVX_OK;
    return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_TOO_MANY,
                         "%s: size is %u, more than memory can hold", function, size);
}
