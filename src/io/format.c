/* format.c - which format the ending of a file name stands for: bvx_format_of_name; and the refusal of a
 * format that a call does not have. */
#include "io/formats.h"

const char bvxi_axis_name[3][2] = {"x", "y", "z"};

int32_t bvxi_word_is(const char *text, size_t n, const char *names)
{
    const char *const end = names + bvxi_text_length(names);

    for (int32_t which = 1;; which++) {
        const char *const stop = bvxi_find_byte(names, end, '|');
        size_t i = 0;

        while (i < n && names + i < stop &&
               (text[i] >= 'A' && text[i] <= 'Z' ? (char)(text[i] - 'A' + 'a') : text[i]) == names[i])
            i++;
        if (i == n && names + i == stop) return which;
        if (stop == end) return 0;
        names = stop + 1;
    }
}

static int name_ends_with(const char *text, size_t n, const char *ending)
{
    size_t const k = bvxi_text_length(ending);
    return n >= k && bvxi_word_is(text + n - k, k, ending);
}

int32_t bvx_format_of_name(const char *name)
{
#define BVXI_FORMAT_ENDING(name, value, text) {"." text, name},
    static const struct {
        const char *ending;
        int32_t format;
    } known[] = {BVX_FORMAT_LIST(BVXI_FORMAT_ENDING){".nhdr", BVX_FORMAT_NRRD}};
#undef BVXI_FORMAT_ENDING
    if (name == NULL) return BVX_FORMAT_UNKNOWN;
    size_t n = bvxi_text_length(name);
    /* A packed file is what it is when unpacked: the name before .gz decides. */
    if (name_ends_with(name, n, ".gz")) n -= 3;
    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++)
        if (name_ends_with(name, n, known[i].ending)) return known[i].format;
    return BVX_FORMAT_UNKNOWN;
}

bvx_status bvxi_fail_format(bvx_context *ctx, bvx_status status, const char *function, const char *what,
                            int32_t format, int32_t set)
{
#define BVXI_FORMAT_TEXT(name, value, text) {" ." text, name},
    static const struct {
        const char *text;
        int32_t format;
    } known[] = {BVX_FORMAT_LIST(BVXI_FORMAT_TEXT)};
#undef BVXI_FORMAT_TEXT
    char endings[128] = "";
    size_t n = 0;

    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++) {
        size_t const k = bvxi_text_length(known[i].text);

        /* What does not fit is left out: a list that is cut in a word would be worse than a shorter one. */
        if ((set >> known[i].format & 1) == 0 || n + k >= sizeof endings) continue;
        memcpy(endings + n, known[i].text, k + 1);
        n += k;
    }
    return bvxi_fail_for(ctx, status, BVX_REASON_CHOICE, "%s: format %d holds no %s; take%s", function,
                         (int64_t)format, what, endings);
}

void bvx_buffer_free(bvx_context *context, bvx_buffer *buffer)
{
    if (context == NULL || buffer == NULL) return;
    bvxi_free(context, buffer->bytes, buffer->capacity);
    memset(buffer, 0, sizeof *buffer);
}
