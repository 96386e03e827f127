/* fuzz_files.h - what the fuzz targets of readers share: formats and files to begin with, damage, corpora,
 * and what every reading keeps.
 *
 * A target defines fuzz_reader and includes this header. It is a libFuzzer target for one format,
 * -DFUZZ_FORMAT=NAME (the first one without), whose inputs are files; and with BVX_FUZZ_MAIN a program of its
 * own:
 *   fuzz_readers [inputs [seed]]     that many files of all formats, damaged by a fixed generator
 *   fuzz_readers FORMAT FILE...      these files (a corpus)
 *   fuzz_readers --seeds FOLDER FORMAT   writes the good files to FOLDER/FORMAT/corpus and words to
 *   FOLDER/FORMAT/words, for libFuzzer */
#ifndef FUZZ_FILES_H
#define FUZZ_FILES_H

#include "fuzz_input.h"
#include "tools/read_limits.h"

enum { FUZZ_SEED_SIZE = 16384, FUZZ_SEEDS = 24, FUZZ_FILE_SIZE = 4096 };

/* A file of a target's format number format. */
typedef struct fuzz_file {
    int format;
    size_t size;
    uint8_t bytes[FUZZ_SEED_SIZE];
} fuzz_file;

typedef struct fuzz_format {
    const char *name;
    int32_t number; /* BVX_FORMAT_... */
} fuzz_format;

typedef struct fuzz_target {
    const fuzz_format *formats;
    int format_count;
    const char *const *words; /* that mean something in them */
    int word_count;
    /* 1: it was read, 0: refused for a reason */
    int (*read)(bvx_context *ctx, const uint8_t *file, size_t size, int format);
    /* puts right checksums into a file; NULL: there are none */
    void (*seal)(uint8_t *file, size_t size, int format);
    int (*make_seeds)(bvx_context *ctx, fuzz_file *seeds); /* returns how many */
} fuzz_target;

static const fuzz_target *fuzz_reader(void);

/* ---- Contracts ---- */

/* 1: it was read. Else it must say why in a line, and for a reason that
 * files have; and reading never takes more than it may. */
static inline int fuzz_was_read(bvx_context *ctx, bvx_status status, int32_t multiple, uint64_t size,
                                uint64_t asked_for)
{
    const char *const message = bvx_last_message(ctx);
    fuzz_require(bvx_memory_peak(ctx) <= read_limit(multiple, size) + asked_for,
                 "more memory than the file's size allows");
    if (status == BVX_OK) return 1;
    fuzz_require(strlen(message) > 10 && strchr(message, '\n') == NULL, "an error without a line of words");
    fuzz_require(status == BVX_ERR_FORMAT || status == BVX_ERR_RANGE || status == BVX_ERR_EMPTY ||
                     status == BVX_ERR_UNSUPPORTED,
                 message);
    return 0;
}

/* ---- One file ---- */

static inline int fuzz_read_file(bvx_context *ctx, const uint8_t *file, size_t size, int format)
{
    const fuzz_target *const target = fuzz_reader();
    int read;
    bvx_memory_reset_peak(ctx);
    read = target->read(ctx, file, size, format);
    fuzz_require(bvx_memory_used(ctx) == 0, "memory that is not given back");
    return read;
}

/* As it is; and with right checksums, else nothing after them would ever be tried. Both in blocks of exact
 * size, so that a sanitizer sees a read beyond the end. */
static inline int fuzz_read_twice(bvx_context *ctx, const uint8_t *bytes, size_t size, int format)
{
    const fuzz_target *const target = fuzz_reader();
    uint8_t *const file = malloc(size > 0 ? size : 1);
    int read;

    fuzz_require(file != NULL, "no memory");
    if (size > 0) memcpy(file, bytes, size);
    read = fuzz_read_file(ctx, file, size, format);
    if (target->seal != NULL) {
        target->seal(file, size, format);
        if (memcmp(file, bytes, size) != 0) read = fuzz_read_file(ctx, file, size, format);
    }
    free(file);
    return read;
}

static inline int fuzz_format_named(const char *name)
{
    const fuzz_target *const target = fuzz_reader();
    int i = 0;
    while (i < target->format_count && strcmp(target->formats[i].name, name) != 0) i++;
    return i;
}

#if defined(FUZZ_FORMAT)
#define FUZZ_TEXT_OF(name) #name
#define FUZZ_NAME_OF(name) FUZZ_TEXT_OF(name)
static int fuzz_chosen(void)
{
    int const format = fuzz_format_named(FUZZ_NAME_OF(FUZZ_FORMAT));
    fuzz_require(format < fuzz_reader()->format_count, "FUZZ_FORMAT names no format of this target");
    return format;
}
#else
static int fuzz_format_given;
static int fuzz_chosen(void)
{
    return fuzz_format_given;
}
#endif

static void fuzz_one(fuzz_input *in)
{
    bvx_context *const ctx = fuzz_context_with(1, BVX_CPU_BEST);
    fuzz_good_calls += (unsigned long)fuzz_read_twice(ctx, in->data, in->size, fuzz_chosen());
    fuzz_end(ctx);
}

/* ---- Files to begin with ---- */

static inline void fuzz_put(fuzz_file *f, const void *bytes, size_t n)
{
    fuzz_require(n <= sizeof f->bytes - f->size, "a seed that is too long");
    memcpy(f->bytes + f->size, bytes, n);
    f->size += n;
}

static inline void fuzz_put_text(fuzz_file *f, const char *text)
{
    fuzz_put(f, text, strlen(text));
}

static inline fuzz_file *fuzz_begin_file(fuzz_file *seeds, int *count, const char *format)
{
    fuzz_file *const f = &seeds[*count];
    fuzz_require(*count < FUZZ_SEEDS, "too many seeds");
    ++*count;
    f->size = 0;
    f->format = fuzz_format_named(format);
    return f;
}

static inline void fuzz_seed_text(fuzz_file *seeds, int *count, const char *format, const char *text)
{
    fuzz_put_text(fuzz_begin_file(seeds, count, format), text);
}

#if defined(BVX_FUZZ_MAIN)

/* ---- Damage ---- */

static uint64_t fuzz_state;

static size_t fuzz_below(size_t n)
{
    fuzz_state ^= fuzz_state << 13;
    fuzz_state ^= fuzz_state >> 7;
    fuzz_state ^= fuzz_state << 17;
    return (size_t)((fuzz_state >> 16) % n); /* the same on machines of 32 bits */
}

/* A word or a piece of the file put between. */
static size_t fuzz_insert(uint8_t *file, size_t size, size_t at, const char *word)
{
    int const piece = fuzz_below(2) == 0;
    size_t n = piece ? 1 + fuzz_below(60) : strlen(word);

    if (piece && fuzz_below(3) == 0) n = 8 * (1 + n % 4);
    if (piece && n > size - at) n = size - at;
    if (size + n > FUZZ_SEED_SIZE) return size;
    memmove(file + at + n, file + at, size - at);
    if (!piece) memcpy(file + at, word, n);
    return size + n;
}

/* One damage: a bit, a byte, a digit, a number of four bytes, a word laid over or put between, a piece
 * repeated or cut out, or a tail cut off. Heads are hit more often than what follows them. */
static size_t fuzz_damage(uint8_t *file, size_t size)
{
    static const uint32_t numbers[] = {0,      1,   2,       3,       0xffffffffu, 0x7fffffffu, 0x80000000u,
                                       0xffff, 256, 1 << 25, 1 << 28, 0x7f800000u, 0x7fc00000u};
    const fuzz_target *const target = fuzz_reader();
    const char *const word = target->words[fuzz_below((size_t)target->word_count)];
    size_t const at = fuzz_below(2) == 0 ? fuzz_below(size) : fuzz_below(size < 256 ? size : 256);

    switch (fuzz_below(8)) {
    case 0: file[at] ^= (uint8_t)(1u << fuzz_below(8)); return size;
    case 1: file[at] = (uint8_t)fuzz_below(256); return size;
    case 2: file[at] = (uint8_t) "0123456789-+.e /\n\r\t#"[fuzz_below(20)]; return size;
    case 3: {
        uint32_t const v = numbers[fuzz_below(sizeof numbers / sizeof numbers[0])];
        size_t const big = fuzz_below(2), from = fuzz_below(2) == 0 ? at & ~(size_t)3 : at;
        for (size_t i = 0; i < 4 && from + i < size; i++)
            file[from + i] = (uint8_t)(v >> 8 * (big ? 3 - i : i) & 0xff);
        return size;
    }
    case 4:
        for (size_t i = 0; word[i] != 0 && at + i < size; i++) file[at + i] = (uint8_t)word[i];
        return size;
    case 5: return fuzz_insert(file, size, at, word);
    case 6: {
        size_t n = fuzz_below(size - at < 40 ? size - at + 1 : 40);
        if (n >= 8 && fuzz_below(2) == 0) n -= n % 8;
        memmove(file + at, file + at + n, size - at - n);
        return size - n;
    }
    default: return fuzz_below(4) == 0 ? at + 1 : size;
    }
}

/* ---- The program ---- */

/* Words as libFuzzer's dictionaries have them. */
static void fuzz_write_words(const char *name)
{
    const fuzz_target *const target = fuzz_reader();
    static char text[16384];
    size_t n = 0;

    for (int w = 0; w < target->word_count; w++) {
        fuzz_require(n + 4 * strlen(target->words[w]) + 4 < sizeof text, "too many words");
        text[n++] = '"';
        for (const char *c = target->words[w]; *c != 0; c++)
            n += (size_t)snprintf(text + n, 5, "\\x%02x", (unsigned)(unsigned char)*c);
        text[n++] = '"';
        text[n++] = '\n';
    }
    fuzz_write(name, text, n);
}

static int fuzz_write_seeds(const char *folder, const char *format, const fuzz_file *seeds, int count)
{
    char name[1024];

    for (int i = 0; i < count; i++) {
        if (seeds[i].format != fuzz_format_named(format)) continue;
        snprintf(name, sizeof name, "%s/%s/corpus/seed_%d", folder, format, i);
        fuzz_write(name, seeds[i].bytes, seeds[i].size);
    }
    snprintf(name, sizeof name, "%s/%s/words", folder, format);
    fuzz_write_words(name);
    return 0;
}

/* Was this file tried already? Damage may leave a file as it was. */
static int fuzz_is_again(const fuzz_file *work, int format)
{
    static uint64_t seen[1 << 16];
    uint64_t const hash = bvx_hash(work->bytes, work->size, (uint64_t)format + 1);
    uint64_t *const place = &seen[hash >> 48];

    if (*place == hash) return 1;
    *place = hash;
    return 0;
}

int main(int argc, char **argv)
{
    static fuzz_file seeds[FUZZ_SEEDS], work;
    const fuzz_target *const target = fuzz_reader();
    bvx_context *const ctx = fuzz_context_with(1, BVX_CPU_BEST);
    unsigned long inputs = 20000, read = 0;
    int const count = target->make_seeds(ctx, seeds);

    if (argc > 3 && strcmp(argv[1], "--seeds") == 0) {
        fuzz_end(ctx);
        return fuzz_write_seeds(argv[2], argv[3], seeds, count);
    }
    if (argc > 1 && fuzz_format_named(argv[1]) < target->format_count) {
        fuzz_end(ctx);
        fuzz_format_given = fuzz_format_named(argv[1]);
        return fuzz_corpus(argc - 2, argv + 2);
    }
    if (argc > 1) inputs = strtoul(argv[1], NULL, 10);
    fuzz_state = argc > 2 ? strtoul(argv[2], NULL, 10) : 1;
    fuzz_state = fuzz_state * 2 + 1; /* never 0 */
    for (int i = 0; i < count; i++)
        fuzz_require(fuzz_read_twice(ctx, seeds[i].bytes, seeds[i].size, seeds[i].format),
                     bvx_last_message(ctx));
    for (unsigned long i = 0; i < inputs; i++) {
        work = seeds[i % (unsigned long)count];
        for (size_t n = 1 + fuzz_below(4); n > 0 && work.size > 0; n--)
            work.size = fuzz_damage(work.bytes, work.size);
        if (fuzz_below(50) == 0) work.format = (int)fuzz_below((size_t)target->format_count);
        if (fuzz_is_again(&work, work.format)) continue;
        read += (unsigned long)fuzz_read_twice(ctx, work.bytes, work.size, work.format);
    }
    fuzz_end(ctx);
    printf("fuzz: %lu files, %lu of them read, 0 failures\n", inputs, read);
    return read > 0 ? 0 : 1;
}

#endif

#endif
