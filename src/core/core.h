/* core.h - what every room stands on: the context, memory, messages, parallel work, progress, and the macros
 * with which steps return early. Lowest of all rooms: it includes no other. Not installed. */
#ifndef BVXI_CORE_H
#define BVXI_CORE_H

#include "bitvox.h"

#include <string.h>

#if defined(__GNUC__)
#define BVXI_COLD              __attribute__((cold, noinline))
#define BVXI_LIKELY(x)         __builtin_expect(!!(x), 1)
#define BVXI_UNLIKELY(x)       __builtin_expect(!!(x), 0)
#define BVXI_RESTRICT          __restrict__
#define BVXI_PREFETCH(address) __builtin_prefetch(address)
#else
#define BVXI_COLD
#define BVXI_LIKELY(x)   (x)
#define BVXI_UNLIKELY(x) (x)
#define BVXI_RESTRICT
#define BVXI_PREFETCH(address) ((void)(address))
#endif

/* Loops over arrays that compilers turn into vector code; copied into one function a processor level. A build
 * that counts branches defines it without the copies. */
#if defined(BVXI_VECTOR_INLINE)
#elif defined(__GNUC__)
#define BVXI_VECTOR_INLINE static inline __attribute__((always_inline))
#else
#define BVXI_VECTOR_INLINE static inline
#endif
#if defined(__GNUC__) && defined(__x86_64__)
#define BVXI_HAVE_AVX2 1
#define BVXI_AVX2      __attribute__((target("avx2,bmi,bmi2,popcnt")))
/* A copy of a loop for this level, and the call of the one that may run. */
#define BVXI_AVX2_COPY(name, parameters, call) \
    BVXI_AVX2 static void name parameters      \
    {                                          \
        call;                                  \
    }
#define BVXI_PATH(fast, plain, vectors) ((fast) ? vectors : plain)
#else
#define BVXI_HAVE_AVX2 0
#define BVXI_AVX2
#define BVXI_AVX2_COPY(name, parameters, call)
#define BVXI_PATH(fast, plain, vectors) ((void)(fast), plain)
#endif

#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__ > 0)
#error "bitvox keeps its promises only without -ffast-math and -ffinite-math-only"
#endif

enum { BVXI_ALIGN = 64, BVXI_MAX_THREADS = 1024, BVXI_MESSAGE_SIZE = 512 };

/* Which end of an arena a block comes from: results live on, scratch goes before the stage ends. */
enum { BVXI_RESULT = 0, BVXI_SCRATCH = 1 };

/* Leave the function with a status when a call fails. */
#define BVXI_TRY(call)                                   \
    do {                                                 \
        bvx_status const bvxi_status_ = (call);          \
        if (bvxi_status_ != BVX_OK) return bvxi_status_; \
    } while (0)

/* ---- memory.c ---- */

/* *block becomes size bytes aligned to 64, unspecified contents (never NULL on success, also for size 0).
 * what names the block in the message. */
bvx_status bvxi_alloc(bvx_context *ctx, int kind, uint64_t size, const char *what, void *block);
bvx_status bvxi_alloc_zero(bvx_context *ctx, int kind, uint64_t size, const char *what, void *block);
/* Scratch for so many items of an array; of unspecified contents, and of zeros. */
#define BVXI_ARRAY(ctx, count, what, array) \
    bvxi_alloc(ctx, BVXI_SCRATCH, (uint64_t)(count) * sizeof *(array), what, &(array))
#define BVXI_ZEROS(ctx, count, what, array) \
    bvxi_alloc_zero(ctx, BVXI_SCRATCH, (uint64_t)(count) * sizeof *(array), what, &(array))
/* Takes back a block of bvxi_alloc with its size: a result's, which callers hold. NULL is allowed. */
void bvxi_free(bvx_context *ctx, void *block, uint64_t size);
/* Move a block to another size; *block changes, the contents stay as far as both sizes go. */
bvx_status bvxi_resize(bvx_context *ctx, int kind, void *block, uint64_t size, uint64_t new_size,
                       const char *what);

/* Scratch of an array with room for more items than count: by half of what there is; for so many in all. room counts
 * items; of is what holds ctx and function. */
bvx_status bvxi_grow(bvx_context *ctx, const char *function, void *block, uint64_t *room, uint64_t item,
                     const char *what);
#define BVXI_GROW_BY(of, array, count, room, item, what) \
    ((count) < (room) ? BVX_OK : bvxi_grow((of)->ctx, (of)->function, &(array), &(room), item, what))
#define BVXI_GROW(of, array, count, room, what) BVXI_GROW_BY(of, array, count, room, sizeof *(array), what)
/* For arrays that share a room: all but the last grow by these, which leave the room as it is; the last then sets it. */
#define BVXI_GROW_BESIDE(of, array, count, room, item, what) \
    ((count) < (room) ? BVX_OK                               \
                      : bvxi_grow((of)->ctx, (of)->function, &(array), &(uint64_t){room}, item, what))
bvx_status bvxi_reserve(bvx_context *ctx, void *block, uint64_t count, uint64_t *room, uint64_t item,
                        const char *what);
#define BVXI_RESERVE(of, array, count, room, what) \
    bvxi_reserve((of)->ctx, &(array), count, &(room), sizeof *(array), what)
#define BVXI_RESERVE_BESIDE(of, array, count, room, item, what) \
    bvxi_reserve((of)->ctx, &(array), count, &(uint64_t){room}, item, what)

/* ---- memory.c: scratch ---- */

/* Takes back a block of scratch; NULL is allowed. */
void bvxi_drop(bvx_context *ctx, void *block);
/* Scratch since a mark goes at once, so that steps return at the first failure and free nothing:
 *   uint64_t const mark = bvxi_scratch_begin(ctx);
 *   return bvxi_scratch_end(ctx, mark, steps(...));
 * Both return the status. */
uint64_t bvxi_scratch_begin(const bvx_context *ctx);
bvx_status bvxi_scratch_end(bvx_context *ctx, uint64_t mark, bvx_status status);
/* Scratch that `work` takes goes at its end, whatever its status, which is returned. */
#define BVXI_SCOPE(ctx, work) (bvxi_scope_begin(ctx), bvxi_scope_end(ctx, (work)))
void bvxi_scope_begin(bvx_context *ctx);
bvx_status bvxi_scope_end(bvx_context *ctx, bvx_status status);
/* bvxi_scratch_end after a failure only: scratch of what was opened stays until it is closed. */
bvx_status bvxi_scratch_keep(bvx_context *ctx, uint64_t mark, bvx_status status);

/* Scratch since a mark lives on when marks end, the public call's too: what callers hold by a handle. It goes
 * by bvxi_free then. */
void bvxi_scratch_adopt(bvx_context *ctx, uint64_t mark);

/* ---- message.c ---- */

/* Keep a message and return the status. Formats: %s text, %d int64_t (cast it), %u uint64_t (cast it), %g
 * double, %%, and %i uint64_t (cast it): the index of the element that is wrong, which bvx_last_error
 * gives. */
BVXI_COLD bvx_status bvxi_fail(bvx_context *ctx, bvx_status status, const char *format, ...);
/* The same where callers may want to know why: reason is BVX_REASON_.... */
BVXI_COLD bvx_status bvxi_fail_for(bvx_context *ctx, bvx_status status, int32_t reason, const char *format,
                                   ...);
/* The same of a file, "STL: ", or with a unit of a place in it, "STL: line 7: ", before the message. A reason of
 * BVX_REASON_NONE is the status's own. Without a context nothing is kept. */
BVXI_COLD bvx_status bvxi_fail_at(bvx_context *ctx, const char *file, const char *unit, uint64_t place,
                                  bvx_status status, int32_t reason, const char *format, ...);
/* After a failure of a public function without BVXI_CALL, whose works may
 * not know its name: that name. Returns the status. */
BVXI_COLD bvx_status bvxi_fail_in(bvx_context *ctx, const char *function, bvx_status status);
/* The usual refusals, so that they read the same everywhere. */
BVXI_COLD bvx_status bvxi_fail_null(bvx_context *ctx, const char *function, const char *argument);
/* owner stands before the field's name: "" for options, "mesh." and its like for other structs. */
BVXI_COLD bvx_status bvxi_fail_reserved(bvx_context *ctx, const char *function, const char *owner);

/* ---- message.c: warnings ---- */

/* Warn of what the present public call has cost: values as BVX_WARN_LIST's text names them. A call within another
 * one warns of nothing, since its caller does not get what it makes. Returns the warning, whose input and box may
 * be set. */
bvx_warning *bvxi_warn(bvx_context *ctx, int32_t code, int32_t count, const double *value);
#define BVXI_WARN(ctx, code, ...)                                                     \
    bvxi_warn(ctx, code, (int32_t)(sizeof((double[]){__VA_ARGS__}) / sizeof(double)), \
              (const double[]){__VA_ARGS__})
/* Its box: voxels of a lattice, both ends inclusive. */
void bvxi_warn_box(bvx_warning *warning, const bvx_lattice *lattice, const int32_t low[3],
                   const int32_t high[3]);
/* The bits of the call's warnings so far, as reports have them. */
uint64_t bvxi_warned(const bvx_context *ctx);
/* A resolution to advise: as it is up to 4,096, else 0. */
static inline double bvxi_advised(double resolution)
{
    return resolution <= 4096.0 ? resolution : 0.0;
}

/* ---- decimal.c: correctly rounded, locale-free ---- */

/* Shortest decimal that reads back as value; writes at most 32 bytes, ends with 0, returns the length. */
int32_t bvxi_print_double(double value, char *text);
int32_t bvxi_print_float(float value, char *text);
/* Read a decimal number at text (not beyond end): sign, digits, point, exponent, inf, nan (any case).
 * Returns the bytes used, 0 when there is no number. Overflow gives infinity. */
size_t bvxi_parse_double(const char *text, const char *end, double *value);
size_t bvxi_parse_float(const char *text, const char *end, float *value);

/* ---- parallel.c ---- */

/* Run count tasks. stage names them for progress; their share of the work's progress is [from, to].
 * Progress is reported between batches on the calling thread. Returns BVX_OK or BVX_CANCELLED. */
bvx_status bvxi_parallel(bvx_context *ctx, const char *stage, double from, double to, int32_t count,
                         bvx_task_fn *task, void *user);
/* The same for tasks that may take long: `each` is a rough guess of what one takes [Units: nanoseconds], by
 * which batches are cut so that the caller is asked about ten times a second. The guess shows in nothing
 * else. */
bvx_status bvxi_parallel_long(bvx_context *ctx, const char *stage, double from, double to, int32_t count,
                              double each, bvx_task_fn *task, void *user);
/* Both for tasks that do not depend on the worker. */
typedef void bvxi_item_fn(void *user, int32_t index);
bvx_status bvxi_each(bvx_context *ctx, const char *stage, double from, double to, int32_t count,
                     bvxi_item_fn *item, void *user);
bvx_status bvxi_each_long(bvx_context *ctx, const char *stage, double from, double to, int32_t count,
                          double each, bvxi_item_fn *item, void *user);
/* body(user, begin, end) for ranges of [0, count), each of at least grain items, one alone where count is 0. The
 * ranges follow from the shape alone, and bodies write apart from each other. */
typedef void bvxi_range_fn(void *user, uint64_t begin, uint64_t end);
bvx_status bvxi_for(bvx_context *ctx, const char *stage, uint64_t count, uint64_t grain, bvxi_range_fn *body,
                    void *user);
/* The same with the number of ranges, for a share [from, to] of the progress; bvxi_for_pieces for bodies with a
 * result of their own for each range. */
bvx_status bvxi_for_ranges(bvx_context *ctx, const char *stage, double from, double to, int32_t pieces,
                           uint64_t count, bvxi_range_fn *body, void *user);
typedef void bvxi_piece_fn(void *user, int32_t piece, uint64_t begin, uint64_t end);
bvx_status bvxi_for_pieces(bvx_context *ctx, const char *stage, double from, double to, int32_t pieces,
                           uint64_t count, bvxi_piece_fn *body, void *user);
/* bvxi_each and bvxi_for_pieces without reports, for what is short beside the time between two of them. */
void bvxi_tasks(bvx_context *ctx, int32_t count, bvxi_item_fn *item, void *user);
void bvxi_ranges(bvx_context *ctx, int32_t pieces, uint64_t count, bvxi_piece_fn *body, void *user);
/* 0: none */
uint64_t bvxi_memory_limit(const bvx_context *ctx);
int32_t bvxi_threads(const bvx_context *ctx);
/* BVX_CPU_PORTABLE or the fast path that may run. */
int32_t bvxi_cpu(const bvx_context *ctx);

/* ---- parallel.c ---- */

/* The work of a public function, with one rise of progress around it; inside another public function it is a
 * part of that; refused without a context. Its end frees the scratch that it took, so bodies free only what others
 * should have before. */
#define BVXI_CALL(ctx, call) \
    ((ctx) == NULL ? BVX_ERR_ARGUMENT : (bvxi_call_begin(ctx, __func__), bvxi_call_end(ctx, (call))))
void bvxi_call_begin(bvx_context *ctx, const char *function);
bvx_status bvxi_call_end(bvx_context *ctx, bvx_status status);
/* Work that reports 0 to 1 while the present one goes from `from` to `to`. */
#define BVXI_SHARE(ctx, from, to, work) (bvxi_share_begin(ctx, from, to), bvxi_share_end(ctx, (work)))
void bvxi_share_begin(bvx_context *ctx, double from, double to);
bvx_status bvxi_share_end(bvx_context *ctx, bvx_status status);
/* Report how far the present work is, 0 to 1; BVX_CANCELLED when the caller wants to stop. */
bvx_status bvxi_progress(bvx_context *ctx, const char *stage, double fraction);

/* Whose step this is, and its part of the work's progress: what steps pass to those below them. */
typedef struct bvxi_call {
    bvx_context *ctx;
    const char *function,
        *stage; /* for messages and progress; function may be NULL where nothing is refused */
    double from, to;
} bvxi_call;

static inline bvxi_call bvxi_call_of(bvx_context *ctx, const char *function, const char *stage, double from,
                                     double to)
{
    bvxi_call const call = {ctx, function, stage, from, to};
    return call;
}

/* The same step with another part of the progress. */
static inline bvxi_call bvxi_call_part(bvxi_call call, double from, double to)
{
    call.from = from;
    call.to = to;
    return call;
}

/* Piece i of n of a range of count items: [*begin, *end). */
static inline void bvxi_piece(uint64_t count, int32_t n, int32_t i, uint64_t *begin, uint64_t *end)
{
    uint64_t const base = count / (uint64_t)n, rest = count % (uint64_t)n;
    uint64_t const u = (uint64_t)i;
    *begin = base * u + (u < rest ? u : rest);
    *end = *begin + base + (u < rest ? 1 : 0);
}

/* Counts become places: where the items of each begin. Returns how many there are of all. */
static inline uint64_t bvxi_place_counts(uint64_t *count, uint64_t n)
{
    uint64_t sum = 0;
    for (uint64_t i = 0; i < n; i++) {
        uint64_t const own = count[i];
        count[i] = sum;
        sum += own;
    }
    return sum;
}

static inline void bvxi_place_counts32(uint32_t *count, uint64_t n)
{
    uint32_t sum = 0;
    for (uint64_t i = 0; i < n; i++) {
        uint32_t const own = count[i];
        count[i] = sum;
        sum += own;
    }
}

enum { BVXI_MOST_PIECES = 256 }; /* for arrays with a place for each piece */

/* Pieces for work over count items, at least grain items each; from the shape only, not from the threads. */
static inline int32_t bvxi_piece_count(uint64_t count, uint64_t grain)
{
    uint64_t const pieces = count / grain;
    return pieces < 1 ? 1 : pieces > BVXI_MOST_PIECES ? BVXI_MOST_PIECES : (int32_t)pieces;
}

/* Pieces for tasks that each look at everything and take what belongs to a range of their own. That costs a look for
 * each: there are as many as threads, so that ranges may show in nothing. */
static inline int32_t bvxi_looking_pieces(const bvx_context *ctx)
{
    int32_t const threads = bvxi_threads(ctx);
    return threads < BVXI_MOST_PIECES ? threads : BVXI_MOST_PIECES;
}

/* ---- options.c: options of callers older or newer than the library ---- */

/* Refuses points [Size: count * 3] that are NULL or not finite, and more than memory has answers of a size for. */
bvx_status bvxi_check_points(bvx_context *ctx, const char *function, const double *points, uint64_t count,
                             size_t size);

/* The same of rays [Size: count * 6], also those without a direction, and a t_max below 0. */
bvx_status bvxi_check_rays(bvx_context *ctx, const char *function, const double *rays, uint64_t count,
                           double t_max, size_t size);

/* Copy the caller's options; NULL: all zeros. Refuses a struct_size that no version had. */
bvx_status bvxi_take_options(bvx_context *ctx, const char *function, const void *given, void *options,
                             size_t size);

/* What a field of an option struct may be, and what 0 stands for where that is not 0 itself, as the header
 * says: one row each. A test holds the two together. */
typedef struct bvxi_option {
    const char *name;
    size_t at, size;
    int32_t kind;
    double low, high, standard;
} bvxi_option;

enum {
    BVXI_IS_WHOLE,   /* int32_t, low to high */
    BVXI_IS_CHOICE,  /* the same, names of values */
    BVXI_IS_AMONG,   /* int32_t, those whose bit is in low */
    BVXI_IS_COUNT,   /* uint64_t, low to high */
    BVXI_IS_REAL,    /* double, low to high, both allowed */
    BVXI_IS_ABOVE,   /* double, above low, and finite unless high is 0 */
    BVXI_IS_ZERO_OR, /* double, 0 or low to high */
    BVXI_IS_RESERVED /* zero bytes */
};

#define BVXI_OPTION(type, field, kind, low, high, standard)                                  \
    {                                                                                        \
#field, offsetof(type, field), sizeof(((type *)0)->field), kind, low, high, standard \
    }
#define BVXI_WHOLE(type, field, low, high)   BVXI_OPTION(type, field, BVXI_IS_WHOLE, low, high, 0)
#define BVXI_SWITCH(type, field)             BVXI_OPTION(type, field, BVXI_IS_WHOLE, 0, 1, 0)
#define BVXI_CHOICE(type, field, low, high)  BVXI_OPTION(type, field, BVXI_IS_CHOICE, low, high, 0)
#define BVXI_AMONG(type, field, bits)        BVXI_OPTION(type, field, BVXI_IS_AMONG, bits, 0, 0)
#define BVXI_COUNT(type, field, low, high)   BVXI_OPTION(type, field, BVXI_IS_COUNT, low, high, 0)
#define BVXI_REAL(type, field, low, high)    BVXI_OPTION(type, field, BVXI_IS_REAL, low, high, 0)
#define BVXI_ABOVE(type, field, low, high)   BVXI_OPTION(type, field, BVXI_IS_ABOVE, low, high, 0)
#define BVXI_ZERO_OR(type, field, low, high) BVXI_OPTION(type, field, BVXI_IS_ZERO_OR, low, high, 0)
#define BVXI_RESERVED(type, field)           BVXI_OPTION(type, field, BVXI_IS_RESERVED, 0, 0, 0)
/* 0 stands for the standard, and BVX_NONE for 0 where that is allowed. */
#define BVXI_OR(type, field, kind, standard, low, high) \
    BVXI_OPTION(type, field, BVXI_IS_##kind, low, high, standard)
/* Those of structs that several options share. */
#define BVXI_PLACING(type)                                                          \
    BVXI_CHOICE(type, placing.position_type, BVX_POSITION_AUTO, BVX_F64),           \
        BVXI_SWITCH(type, placing.local_frame),                                     \
        BVXI_CHOICE(type, placing.face_rule, BVX_FACE_SEPARATE, BVX_FACE_JOIN),     \
        BVXI_CHOICE(type, placing.interpolation, BVX_EDGE_TANGENT, BVX_EDGE_PAPER), \
        BVXI_CHOICE(type, placing.sharp, BVX_SHARP_AUTO, BVX_SHARP_ALWAYS),         \
        BVXI_RESERVED(type, placing.reserved)
#define BVXI_PARTS(type)   BVXI_SWITCH(type, parts.keep_crumbs), BVXI_RESERVED(type, parts.reserved)
#define BVXI_OPTIONS(rows) rows, sizeof(rows) / sizeof((rows)[0])
#define BVXI_FINITE        1.7976931348623157e308 /* the largest double */

/* Put the standards in, then refuse the first field that its row does not allow, by its name. */
bvx_status bvxi_check_options(bvx_context *ctx, const char *function, void *options, const bvxi_option *rows,
                              size_t count);

/* What a freestanding build has no library for: the length of a text, and
 * the first byte equal to wanted (or end). */
static inline size_t bvxi_text_length(const char *text)
{
    size_t n = 0;
    while (text[n] != 0) n++;
    return n;
}

static inline const char *bvxi_find_byte(const char *p, const char *end, char wanted)
{
    while (p != end && *p != wanted) p++;
    return p;
}

/* 1 when two arrays share a byte; lengths in bytes. */
static inline int bvxi_overlap(const void *a, uint64_t a_size, const void *b, uint64_t b_size)
{
    uintptr_t const x = (uintptr_t)a, y = (uintptr_t)b;
    if (a == NULL || b == NULL || a_size == 0 || b_size == 0) return 0;
    return x <= y ? y - x < a_size : x - y < b_size;
}

/* The nearest float of a finite double. Volatile: gcc 12 at -O3 leaves the
 * rounding out where it makes vectors of several values, and what is
 * decided about a position must be decided about the one that is written. */
static inline double bvxi_nearest_float(double x)
{
    float volatile const nearest = (float)x;
    return (double)nearest;
}

/* a * b and a + b; 0 in *ok when they do not fit 64 bits. */
static inline uint64_t bvxi_mul(uint64_t a, uint64_t b, int *ok)
{
    if (b != 0 && a > UINT64_MAX / b) *ok = 0;
    return a * b;
}

static inline uint64_t bvxi_add(uint64_t a, uint64_t b, int *ok)
{
    if (a > UINT64_MAX - b) *ok = 0;
    return a + b;
}

/* The size of a number. One instruction where the compiler is told what is
 * meant; a comparison, which also branches, elsewhere. */
static inline double bvxi_absolute(double x)
{
#if defined(__GNUC__)
    return __builtin_fabs(x);
#else
    return x < 0.0 ? -x : x;
#endif
}

/* Disjoint sets of numbers: parent[i] is i at a root, which is the least number of its set. Each search
 * halves its path. Source: Tarjan, van Leeuwen. Worst-case Analysis of Set Union Algorithms. 1984. */
static inline uint32_t bvxi_root(uint32_t *parent, uint32_t i)
{
    while (parent[i] != i) {
        parent[i] = parent[parent[i]];
        i = parent[i];
    }
    return i;
}

/* Returns 1 when they were not joined before. */
static inline int bvxi_join(uint32_t *parent, uint32_t a, uint32_t b)
{
    uint32_t const x = bvxi_root(parent, a), y = bvxi_root(parent, b);
    if (x == y) return 0;
    parent[x < y ? y : x] = x < y ? x : y;
    return 1;
}

#endif
