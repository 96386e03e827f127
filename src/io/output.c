/* output.c - text of files, whose numbers read back to the same ones whatever the locale is. */
#include "io/bytes.h"

#include <stdarg.h>

static void print_text(bvxi_output *o, const char *text)
{
    bvxi_output_add(o, text, bvxi_text_length(text));
}

static void print_one_double(bvxi_output *o, double v)
{
    char text[32];
    bvxi_output_add(o, text, (size_t)bvxi_print_double(v, text));
}

static void print_whole(bvxi_output *o, uint64_t v)
{
    char digits[20];
    size_t n = sizeof digits;
    do {
        digits[--n] = (char)('0' + v % 10);
        v /= 10;
    } while (v != 0);
    bvxi_output_add(o, digits + n, sizeof digits - n);
}

/* Quotes, backslashes and control characters are escaped. */
static void print_quoted(bvxi_output *o, const char *text)
{
    static const char hex[] = "0123456789abcdef";
    print_text(o, "\"");
    for (const char *p = text; *p != 0; p++) {
        uint8_t const c = (uint8_t)*p;
        char const escape[6] = {'\\', 'u', '0', '0', hex[c >> 4], hex[c & 15]};
        if (c < 32 || c == '"' || c == '\\') bvxi_output_add(o, escape, sizeof escape);
        else bvxi_output_add(o, p, 1);
    }
    print_text(o, "\"");
}

static void print_three(bvxi_output *o, const double *doubles, const int32_t *counts, const char *between)
{
    for (int a = 0; a < 3; a++) {
        if (a > 0) print_text(o, between);
        if (doubles != NULL) print_one_double(o, doubles[a]);
        else print_whole(o, (uint64_t)counts[a]);
    }
}

void bvxi_output_print(bvxi_output *o, const char *format, ...)
{
    va_list args;

    va_start(args, format);
    for (const char *p = format; *p != 0; p++) {
        const char *const text = p;
        while (*p != 0 && *p != '%') p++;
        bvxi_output_add(o, text, (size_t)(p - text));
        if (*p == 0) break;
        switch (*++p) {
        case 's': print_text(o, va_arg(args, const char *)); break;
        case 'q': print_quoted(o, va_arg(args, const char *)); break;
        case 'u': print_whole(o, va_arg(args, uint64_t)); break;
        case 'd': {
            int64_t const v = va_arg(args, int64_t);
            if (v < 0) print_text(o, "-");
            print_whole(o, v < 0 ? 0 - (uint64_t)v : (uint64_t)v);
            break;
        }
        case 'g': print_one_double(o, va_arg(args, double)); break;
        case 'v': {
            const double *const v = va_arg(args, const double *);
            print_three(o, v, NULL, va_arg(args, const char *));
            break;
        }
        default: {
            const int32_t *const v = va_arg(args, const int32_t *);
            print_three(o, NULL, v, va_arg(args, const char *));
            break;
        }
        }
    }
    va_end(args);
}
