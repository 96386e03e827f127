/* message.c - one line about what went wrong, formatted without stdio and without a locale. */
#include "context.h"

#include <stdarg.h>

typedef struct message_line {
    char *text;
    size_t size, used;
} message_line;

static void message_put(message_line *l, const char *text, size_t n)
{
    for (size_t i = 0; i < n && l->used + 1 < l->size; i++) {
        unsigned char const c = (unsigned char)text[i];
        l->text[l->used++] = (char)(c < 32 || c == 127 ? '?' : c); /* names from files stay on one line */
    }
    l->text[l->used] = 0;
}

static void message_put_unsigned(message_line *l, uint64_t v)
{
    char digits[20];
    size_t n = 20;
    do {
        digits[--n] = (char)('0' + v % 10);
        v /= 10;
    } while (v != 0);
    message_put(l, digits + n, 20 - n);
}

static void message_put_format(message_line *l, const char *format, va_list args)
{
    char number[32];
    for (const char *p = format; *p != 0; p++) {
        if (*p != '%') {
            message_put(l, p, 1);
            continue;
        }
        switch (*++p) {
        case 's': {
            const char *const s = va_arg(args, const char *);
            message_put(l, s, bvxi_text_length(s));
            break;
        }
        case 'd': {
            int64_t const v = va_arg(args, int64_t);
            if (v < 0) message_put(l, "-", 1);
            message_put_unsigned(l, v < 0 ? 0 - (uint64_t)v : (uint64_t)v);
            break;
        }
        case 'u': message_put_unsigned(l, va_arg(args, uint64_t)); break;
        case 'g': message_put(l, number, (size_t)bvxi_print_double(va_arg(args, double), number)); break;
        default: message_put(l, p, 1); break;
        }
    }
}

bvx_status bvxi_fail(bvx_context *ctx, bvx_status status, const char *format, ...)
{
    message_line l = {ctx->message, sizeof ctx->message, 0};
    va_list args;
    va_start(args, format);
    message_put_format(&l, format, args);
    va_end(args);
    return status;
}

bvx_status bvxi_fail_null(bvx_context *ctx, const char *function, const char *argument)
{
    return bvxi_fail(ctx, BVX_ERR_ARGUMENT, "%s: %s is NULL", function, argument);
}

const char *bvx_last_message(const bvx_context *context)
{
    return context == NULL ? "there is no context" : context->message;
}
