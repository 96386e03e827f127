/* message.c - what went wrong, for people and for programs: the fixed texts of statuses and reasons, and the
 * last failure in parts and in one line; warnings of a call that succeeded.
 *
 * A message is formatted without stdio and locale, into the context, so a failure allocates nothing. */
#include "context.h"

#include <math.h>
#include <stdarg.h>

/* ---- Texts of statuses, and the version ---- */

const char *bvx_status_text(bvx_status status)
{
    switch (status) {
#define BVXI_STATUS_TEXT(name, value, text) \
    case value: return text;
        BVX_STATUS_LIST(BVXI_STATUS_TEXT)
#undef BVXI_STATUS_TEXT
    default: return "unknown status";
    }
}

int32_t bvx_version(void)
{
    return BVX_VERSION;
}

/* ---- Messages ---- */

typedef struct message_line {
    char *text;
    size_t size, used;
    bvx_error *error; /* receives the numbers */
} message_line;

static void message_keep(message_line *l, double value)
{
    bvx_error *const e = l->error;
    if (e->value_count < (int32_t)(sizeof e->value / sizeof e->value[0])) e->value[e->value_count++] = value;
}

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
            /* Taken apart, as the lowest number has no opposite. */
            message_put_unsigned(l, v < 0 ? 0 - (uint64_t)v : (uint64_t)v);
            message_keep(l, (double)v);
            break;
        }
        case 'i':
        case 'u': {
            uint64_t const v = va_arg(args, uint64_t);
            message_put_unsigned(l, v);
            message_keep(l, (double)v);
            /* An index names the element that is wrong. */
            if (*p == 'i') l->error->index = (int64_t)v;
            break;
        }
        case 'g': {
            double const v = va_arg(args, double);
            message_put(l, number, (size_t)bvxi_print_double(v, number));
            message_keep(l, v);
            break;
        }
        default: message_put(l, p, 1); break;
        }
    }
}

/* What a status says by itself: each has a reason that is true of all its failures. */
static int32_t reason_of_status(bvx_status status)
{
    switch (status) {
    case BVX_ERR_MEMORY: return BVX_REASON_MEMORY;
    case BVX_ERR_BUDGET: return BVX_REASON_BUDGET;
    case BVX_ERR_CAPACITY: return BVX_REASON_CAPACITY;
    case BVX_ERR_LATTICE: return BVX_REASON_LATTICE;
    case BVX_CANCELLED: return BVX_REASON_CANCELLED;
    case BVX_ERR_VERSION: return BVX_REASON_VERSION;
    case BVX_ERR_RANGE: return BVX_REASON_TOO_FAR;
    case BVX_ERR_EMPTY: return BVX_REASON_EMPTY;
    case BVX_ERR_FORMAT: return BVX_REASON_DAMAGED;
    case BVX_ERR_UNSUPPORTED: return BVX_REASON_UNSUPPORTED;
    default: return BVX_REASON_INVALID;
    }
}

/* Behind "bvx_name: ", or after "bvx_name, " where a message goes on with which argument it was. */
static const char *behind_function(const char *message)
{
    const char *p = message;
    if (p[0] != 'b' || p[1] != 'v' || p[2] != 'x' || p[3] != '_') return message;
    while (*p == '_' || (*p >= 'a' && *p <= 'z') || (*p >= '0' && *p <= '9')) p++;
    return (*p == ':' || *p == ',') && p[1] == ' ' ? p + 2 : message;
}

typedef struct message_place {
    const char *file, *unit;
    uint64_t number;
} message_place;

static void keep_failure(bvx_context *ctx, bvx_status status, int32_t reason, const message_place *at,
                         const char *format, va_list args)
{
    bvx_error *const e = &ctx->error;
    message_line l = {ctx->message, sizeof ctx->message, 0, e};
    va_list again;

    /* Outside of a public call, as the few are that report no progress, the message knows whose it is. */
    va_copy(again, args);
    int const named = format[0] == '%' && format[1] == 's' && format[2] == ':';
    e->function = ctx->calls != 0 ? ctx->function
                  : at != NULL    ? at->file
                  : named         ? va_arg(again, const char *)
                                  : "";
    va_end(again);

    e->status = status;
    e->reason = reason;
    e->index = -1;
    e->value_count = 0;
    if (at != NULL) {
        message_put(&l, at->file, bvxi_text_length(at->file));
        message_put(&l, ": ", 2);
    }
    if (at != NULL && at->unit != NULL) {
        message_put(&l, at->unit, bvxi_text_length(at->unit));
        message_put(&l, " ", 1);
        message_put_unsigned(&l, at->number);
        message_keep(&l, (double)at->number);
        message_put(&l, ": ", 2);
    }
    message_put_format(&l, format, args);
    e->text = behind_function(ctx->message);
}

bvx_status bvxi_fail(bvx_context *ctx, bvx_status status, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    keep_failure(ctx, status, reason_of_status(status), NULL, format, args);
    va_end(args);
    return status;
}

bvx_status bvxi_fail_for(bvx_context *ctx, bvx_status status, int32_t reason, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    keep_failure(ctx, status, reason, NULL, format, args);
    va_end(args);
    return status;
}

bvx_status bvxi_fail_at(bvx_context *ctx, const char *file, const char *unit, uint64_t place,
                        bvx_status status, int32_t reason, const char *format, ...)
{
    const message_place at = {file, unit, place};
    va_list args;
    if (ctx == NULL) return status;
    va_start(args, format);
    keep_failure(ctx, status, reason == BVX_REASON_NONE ? reason_of_status(status) : reason, &at, format,
                 args);
    va_end(args);
    return status;
}

bvx_status bvxi_fail_in(bvx_context *ctx, const char *function, bvx_status status)
{
    if (ctx->calls == 0) ctx->error.function = function;
    return status;
}

bvx_status bvxi_fail_null(bvx_context *ctx, const char *function, const char *argument)
{
    return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_NULL, "%s: %s is NULL", function, argument);
}

bvx_status bvxi_fail_reserved(bvx_context *ctx, const char *function, const char *owner)
{
    return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_RESERVED, "%s: %sreserved must be 0", function,
                         owner);
}

const char *bvx_last_message(const bvx_context *context)
{
    return bvx_last_error(context)->message;
}

const bvx_error *bvx_last_error(const bvx_context *context)
{
    static const char none[] = "there is no context";
    static const bvx_error without_context = {.status = BVX_ERR_ARGUMENT,
                                              .reason = BVX_REASON_NULL,
                                              .function = "",
                                              .message = none,
                                              .text = none,
                                              .index = -1};
    return context == NULL ? &without_context : &context->error;
}

/* ---- Warnings ---- */

bvx_warning *bvxi_warn(bvx_context *ctx, int32_t code, int32_t count, const double *value)
{
    bvx_warning *const w = &ctx->warning[ctx->warnings];
    memset(w, 0, sizeof *w);
    w->code = code;
    w->input = -1;
    w->value_count = count;
    for (int32_t i = 0; i < count; i++) w->value[i] = value[i];
    if (ctx->calls == 1 && ctx->warnings < BVXI_WARNINGS) ctx->warnings++;
    return w;
}

void bvxi_warn_box(bvx_warning *w, const bvx_lattice *lattice, const int32_t low[3], const int32_t high[3])
{
    w->placed = 1;
    for (int a = 0; a < 3; a++) {
        w->low[a] = lattice->origin[a] + (double)low[a] * lattice->spacing[a];
        w->high[a] = lattice->origin[a] + ((double)high[a] + 1.0) * lattice->spacing[a];
    }
}

uint64_t bvxi_warned(const bvx_context *ctx)
{
    uint64_t bits = 0;
    for (int32_t i = 0; i < ctx->warnings; i++) bits |= (uint64_t)1 << ctx->warning[i].code;
    return bits;
}

/* The text of each warning that the library gives. %d, %g, %p (a share, as a percentage) stand for its values in order, %b for its
 * box. Words in braces are left out where the first value in them is 0. */
static const char *const warning_texts[BVX_WARN_COUNT] = {
    [BVX_WARN_NONE] = "nothing to warn of",
    [BVX_WARN_THIN_LOST] =
        "walls thinner than 1.5 voxels are lost where no voxel's centre lies in them: %d voxel%s, in %b{; a "
        "resolution of %d keeps nine tenths of them}",
    [BVX_WARN_THICKER] =
        "the result has a volume of %g, all parts of the input together %g (%p): what is thinner than a "
        "voxel, or less than one apart, became thicker{; a resolution of %d is nearer}{; so it was before "
        "edges collapsed to %d triangles}",
    [BVX_WARN_VOLUME] =
        "the result has a volume of %g, the input about %g (%p){; a resolution of %d is nearer}{; so it was "
        "before edges collapsed to %d triangles}",
    [BVX_WARN_AREA] =
        "the result has an area of %g, the input %g (%p), and no parts overlap{; a resolution of %d is "
        "nearer}{; so it was before edges collapsed to %d triangles}",
    [BVX_WARN_PARTS] =
        "the result has %d parts, the input %d: what is thinner than a voxel came apart, or a gap closed "
        "around an empty space{; a resolution of %d may keep it}",
    [BVX_WARN_JOINED] =
        "the result has %d part%s, the input %d: parts less than two voxels apart became one, or smaller "
        "ones are lost{; a resolution of %d may keep them}",
    [BVX_WARN_HANDLES] =
        "the result has %d handle%s, the input %d: what is less than a voxel thick, or apart, has opened or "
        "met{; a resolution of %d may keep it}",
    [BVX_WARN_SHELLS] =
        "%d triangle%s with %g of the area of %g enclose nothing and became hollow shells; shell sets their "
        "thickness",
    [BVX_WARN_SHELLED_BODIES] =
        "%d triangle%s of bodies thinner than voxels became shells, which are thicker than these bodies{; a "
        "resolution of %d may keep them}",
    [BVX_WARN_CRUMBS] =
        "dropped, since what is thinner than a voxel broke: %d small part%s that the input does not have{; "
        "a resolution of %d may keep it}",
    [BVX_WARN_LEVEL_PARTS] =
        "{level %d: }%d piece%s, but %d before edges collapsed{; so it is for %d more level%s}",
    [BVX_WARN_LEVEL_VOLUME] =
        "{level %d: }a volume of %g, but %g before edges collapsed (%p); more triangles keep it nearer{; so "
        "it is for %d more level%s}",
    [BVX_WARN_TARGET] =
        "{level %d: }the target of %d triangles is missed: %d are the fewest that collapsing edges leaves "
        "sound{ with %d handle%s}; take a larger target{; %d more level%s missed theirs}",
    [BVX_WARN_ERROR] =
        "{level %d: }no mesh with the target error of %g was found; take a larger one{; %d more level%s "
        "missed theirs}",
    [BVX_WARN_CUT] =
        "cut: %d edge%s of three triangles and more, or whose triangles cannot agree, the first from %b; "
        "levels of the solid join what they part",
    [BVX_WARN_LOWERED] =
        "the memory limit lowered the resolution from %d to %d voxels along the longest axis; a larger "
        "limit keeps more detail",
    [BVX_WARN_DOUBLES] = "left out since others equal them: %d triangle%s",
    [BVX_WARN_TURNED] =
        "{turned since they faced the other way than the rest of their patch: %d triangle%s}{the faces of "
        "the open mesh look inward, around a volume of %g, which became solid; where they are walls of a "
        "room, levels of the mesh as it is keep it open}",
    [BVX_WARN_ROWS] =
        "%d row%s of centres do not balance, where the surface has holes or flipped triangles; a repair "
        "closes them, and the rule below fills under open terrain",
    [BVX_WARN_NESTED] =
        "closed shells lie inside others, face the same way and do not cross: what lies in both is hollow; "
        "the rule nonzero has it solid",
    [BVX_WARN_LEAKS] =
        "the flood came through a hole to %d voxels that are surely inside; a larger close_gaps may hold "
        "it, the rules vote and regions do without",
    [BVX_WARN_MIXED] =
        "%d of %d regions are not on one side, since a hole joins them or the axes disagree: each of their "
        "%d voxels kept its own vote",
    [BVX_WARN_VOXELS] =
        "the voxels have a volume of %g, the input about %g (%p){; a resolution of %d is within 1 %%}",
    [BVX_WARN_FEW] = "few or no voxels show this body{; a resolution of %d does}",
    [BVX_WARN_FEW_RESULT] = "few voxels show the result{; a resolution of %d does}",
    [BVX_WARN_APART] = "it does not reach the first body: nothing was taken away",
    [BVX_WARN_CONTOURS] =
        "at %d points, %d edges and %d gaps where planes cross the surface does not follow the contours, "
        "which contradict each other",
    [BVX_WARN_SPECKS] =
        "parts of one contour alone, smaller than a cell: %d; more cells, or leaving out those contours, "
        "may join them to the body",
    [BVX_WARN_EXTRA_HANDLES] = "left, though no contour needs them: %d handle%s",
    [BVX_WARN_CELLS] =
        "%d edges and %d loops are too fine for the cells: what joins them to the next section is a guess{; "
        "a subdivision of %d may help}",
    [BVX_WARN_WINDOWS] =
        "between %d pairs of sections walls are too thin for the cells and may have windows; a finer grid "
        "closes them",
    [BVX_WARN_REPEATED] = "left out: %d repeated point%s",
    [BVX_WARN_LIDS] =
        "lids over %d hole%s are about %g %% of the surface, the longest rim is %g, in %b: nothing in the "
        "input says how the body went on there; close such holes first where that matters",
    [BVX_WARN_LOST] =
        "textures of %d material%s are not looked up: voxels have base colours alone; colours that "
        "are baked to vertices count",
    [BVX_WARN_OPEN_PARTS] =
        "parts that end towards another one with no plane between: %d, one at %b; whether they are one the "
        "contours leave open, and a section there, or more cells, decides it",
};

static void put_rounded(message_line *l, double value, double most)
{
    char number[32];
    double power = 1.0;
    /* To so many digits. A power of ten up to 10^22 is exact, so the quotient is the double of the decimal. */
    while (bvxi_absolute(value) * power < most / 10.0 && power < 1e22) power *= 10.0;
    if (value > -1e15 && value < 1e15) value = floor(value * power + 0.5) / power;
    message_put(l, number, (size_t)bvxi_print_double(value, number));
}

/* The text with the values of a warning; %s is an s after any whole number but 1. */
static void put_warning(message_line *l, const char *p, const bvx_warning *w)
{
    const double *v = w->value;

    for (; *p != 0; p++) {
        if (*p == '{' && *v == 0.0) {
            for (; *p != '}'; p++) v += p[0] == '%' && p[1] != 's';
        } else if (*p != '%') {
            if (*p != '{' && *p != '}') message_put(l, p, 1);
        } else if (*++p == 's') {
            message_put(l, "s", v[-1] == 1.0 ? 0 : 1);
        } else if (*p == 'b') {
            for (int i = 0; i < 6; i++) {
                put_rounded(l, i < 3 ? w->low[i] : w->high[i - 3], 1e6);
                if (i != 5) message_put(l, i == 2 ? " to " : ",", i == 2 ? 4 : 1);
            }
        } else if (*p == 'p') {
            if (*v > 0.0) message_put(l, "+", 1);
            put_rounded(l, *v++ * 100.0, 1e3);
            message_put(l, " %", 2);
        } else if (*p == '%') {
            message_put(l, p, 1);
        } else {
            put_rounded(l, *v++, *p == 'd' ? 1.0 : 1e6);
        }
    }
}

const bvx_warning *bvx_next_warning(bvx_context *context)
{
#define BVXI_NAME(name, value) [value] = #name,
    static const char *const names[] = {BVX_WARN_LIST(BVXI_NAME)};
#undef BVXI_NAME

    if (context == NULL || context->warnings_read == context->warnings) return NULL;
    bvx_warning *const w = &context->warning[context->warnings_read++];
    message_line l = {context->warning_text, sizeof context->warning_text, 0, NULL};
    put_warning(&l, warning_texts[w->code], w);
    w->name = names[w->code];
    w->text = l.text;
    return w;
}
