/* files.c - whole files in, whole files out.
 *
 * A file is read as a whole, within --memory-limit; gzip data are told by their first bytes and unpacked in memory.
 * An output is written under a temporary name in its own folder, which also shows at once whether that is possible,
 * and gets its name when everything is done; whatever happens before leaves the folder as it was. */
#if defined(__unix__) || defined(__APPLE__)
#define _POSIX_C_SOURCE 200809L
#define FILES_POSIX 1
#else
#define FILES_POSIX 0
#endif

#include "cli/cli.h"

#include <errno.h>
#include <inttypes.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#if FILES_POSIX
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#endif
#ifdef BVX_HAVE_ZLIB
#include <zlib.h>
#endif

enum { FILES_CHUNK = 1 << 20 };

/* Bytes of a file; size of them count, room are there. */
typedef struct file_bytes {
    unsigned char *bytes;
    size_t size, room;
    uint64_t limit; /* of room; 0: none */
} file_bytes;

/* ---- in ---- */

/* Room for more bytes: as much again, within the limit. */
static int grow_bytes(cli_run *run, const char *path, file_bytes *b)
{
    size_t room = b->room < SIZE_MAX / 2 ? b->room * 2 : SIZE_MAX;
    unsigned char *more;
    if (b->limit != 0 && room > b->limit) room = (size_t)b->limit;
    if (room <= b->room)
        return cli_fail(run, "%s: holds more than the %" PRIu64 " bytes that --memory-limit leaves for it", path,
                        b->limit != 0 ? b->limit : (uint64_t)SIZE_MAX);
    more = realloc(b->bytes, room);
    if (more == NULL) return cli_fail(run, "%s: no memory for %" PRIu64 " bytes of it", path, (uint64_t)room);
    b->bytes = more;
    b->room = room;
    return CLI_DONE;
}

static int start_bytes(cli_run *run, const char *path, uint64_t guess, uint64_t limit, file_bytes *b)
{
    memset(b, 0, sizeof *b);
    b->limit = limit;
    if (guess > SIZE_MAX - 1) guess = SIZE_MAX - 1;
    b->room = (size_t)guess + 1; /* one more, so that the end is seen without growing */
    if (limit != 0 && b->room > limit) b->room = (size_t)limit;
    b->bytes = malloc(b->room);
    if (b->bytes == NULL) return cli_fail(run, "%s: no memory for %" PRIu64 " bytes of it", path, (uint64_t)b->room);
    return CLI_DONE;
}

/* Bytes held beside what the context has now. */
static void note_peak(cli_run *run, uint64_t bytes)
{
    uint64_t const all = bytes + bvx_memory_peak(run->context);
    if (all > run->report.peak_bytes) run->report.peak_bytes = all;
}

static int read_bytes(cli_run *run, const char *path, FILE *file, file_bytes *b)
{
    long size = -1;
    int status, error = 0;
    if (fseek(file, 0, SEEK_END) == 0) size = ftell(file);
    rewind(file);
    if (size < 0 || size == LONG_MAX) size = 0; /* a pipe, a folder: the size shows while reading */
    if (run->options.memory_limit != 0 && (uint64_t)size > run->options.memory_limit)
        return cli_fail(run, "%s: its %ld bytes are more than the %" PRIu64 " that --memory-limit allows", path, size,
                        run->options.memory_limit);
    status = start_bytes(run, path, size > 0 ? (uint64_t)size : FILES_CHUNK, run->options.memory_limit, b);
    while (status == CLI_DONE) {
        size_t want = b->room - b->size, got;
        if (want == 0) {
            int const next = getc(file); /* exactly full: is there more? */
            if (next == EOF) break;
            ungetc(next, file);
            status = grow_bytes(run, path, b);
            continue;
        }
        got = fread(b->bytes + b->size, 1, want < FILES_CHUNK ? want : FILES_CHUNK, file);
        error = errno; /* what follows may change it */
        b->size += got;
        if (cli_progress(run, "read", 0.0)) return cli_fail_interrupted(run);
        if (got == 0) break;
    }
    if (status == CLI_DONE && ferror(file)) return cli_fail(run, "%s: %s", path, strerror(error));
    return status;
}

#ifdef BVX_HAVE_ZLIB
/* One gzip member after the other, as gzip itself reads them; zero bytes behind the last are padding. */
static int inflate_all(cli_run *run, const char *path, const file_bytes *packed, file_bytes *b, z_stream *z)
{
    size_t taken = 0;
    for (;;) {
        int result;
        if (b->size == b->room && grow_bytes(run, path, b) != CLI_DONE) return CLI_FAILED;
        size_t const in = packed->size - taken, out = b->room - b->size;
        z->next_in = packed->bytes + taken;
        z->avail_in = in < FILES_CHUNK ? (uInt)in : FILES_CHUNK;
        z->next_out = b->bytes + b->size;
        z->avail_out = out < FILES_CHUNK ? (uInt)out : FILES_CHUNK;
        result = inflate(z, Z_NO_FLUSH);
        taken = (size_t)(z->next_in - packed->bytes);
        b->size = (size_t)(z->next_out - b->bytes);
        if (cli_progress(run, "unpack", (double)taken / ((double)packed->size + 1.0))) return cli_fail_interrupted(run);
        if (result == Z_STREAM_END) {
            while (taken < packed->size && packed->bytes[taken] == 0) taken++;
            if (taken == packed->size) return CLI_DONE;
            inflateReset(z);
        } else if (result == Z_BUF_ERROR && taken == packed->size) {
            return cli_fail(run, "%s: gzip: the data end in their middle, at byte %" PRIu64, path, (uint64_t)taken);
        } else if (result != Z_OK && result != Z_BUF_ERROR) {
            return cli_fail(run, "%s: gzip: %s near byte %" PRIu64, path, z->msg != NULL ? z->msg : "damaged data",
                            (uint64_t)taken);
        }
    }
}

static int unpack(cli_run *run, const char *path, file_bytes *b)
{
    file_bytes plain;
    z_stream z;
    uint64_t const limit = b->limit > b->size ? b->limit - b->size : b->limit != 0 ? 1 : 0; /* both are held for a while */
    int status = start_bytes(run, path, (uint64_t)b->size * 4, limit, &plain);
    if (status != CLI_DONE) return status;
    memset(&z, 0, sizeof z);
    if (inflateInit2(&z, 15 + 16) != Z_OK) { /* the largest window, gzip's head and foot */
        free(plain.bytes);
        return cli_fail(run, "%s: gzip: no memory to unpack it", path);
    }
    status = inflate_all(run, path, b, &plain, &z);
    inflateEnd(&z);
    note_peak(run, (uint64_t)b->size + plain.size);
    free(b->bytes);
    *b = plain;
    return status;
}
#else
static int unpack(cli_run *run, const char *path, file_bytes *b)
{
    (void)b;
    return cli_fail(run, "%s: gzip data, which this build cannot unpack: it was made without zlib", path);
}
#endif

static int is_gzip(const char *path, const file_bytes *b)
{
    size_t const n = strlen(path);
    return (b->size >= 2 && b->bytes[0] == 0x1f && b->bytes[1] == 0x8b) || (n > 3 && strcmp(path + n - 3, ".gz") == 0);
}

int cli_read_mesh(cli_run *run, const char *path, bvx_mesh *mesh)
{
    int32_t const format = bvx_format_of_name(path);
    double start = cli_seconds();
    file_bytes b = {NULL, 0, 0, 0};
    FILE *file;
    int status;
    if (format != BVX_FORMAT_STL && format != BVX_FORMAT_OBJ && format != BVX_FORMAT_PLY)
        return cli_fail(run, "%s: the name ends in no mesh format that is read (.stl .obj .ply, also with .gz)", path);
    file = fopen(path, "rb");
    if (file == NULL) return cli_fail(run, "%s: %s", path, strerror(errno));
    status = read_bytes(run, path, file, &b);
    fclose(file);
    if (status == CLI_DONE && is_gzip(path, &b)) status = unpack(run, path, &b);
    cli_stage(run, start, "read");
    if (status == CLI_DONE && run->context == NULL) status = cli_make_context(run, b.size);
    if (status == CLI_DONE) {
        start = cli_seconds();
        bvx_status const read = bvx_read_mesh(run->context, b.bytes, b.size, format, mesh);
        cli_stage(run, start, "parse");
        note_peak(run, b.size);
        bvx_memory_reset_peak(run->context);
        if (read != BVX_OK) status = cli_fail_status(run, read, path);
    }
    free(b.bytes);
    return status;
}

/* ---- out ---- */

static char *copy_text(const char *text)
{
    char *const copy = malloc(strlen(text) + 1);
    if (copy != NULL) memcpy(copy, text, strlen(text) + 1);
    return copy;
}

/* A new file beside path, under a name that no file has. NULL with errno. */
static FILE *make_temporary(const char *path, char **name)
{
    size_t const room = strlen(path) + 40;
    char *const text = malloc(room);
    FILE *file = NULL;
    if (text == NULL) return NULL;
    for (int i = 0; i < 100 && file == NULL; i++) {
#if FILES_POSIX
        int number;
        snprintf(text, room, "%s.%ld-%d.part", path, (long)getpid(), i);
        number = open(text, O_WRONLY | O_CREAT | O_EXCL, 0666);
        if (number < 0 && errno != EEXIST) break;
        if (number >= 0) file = fdopen(number, "wb");
#else
        snprintf(text, room, "%s.%d.part", path, i);
        file = fopen(text, "rb");
        if (file != NULL) {
            fclose(file);
            file = NULL;
            continue;
        }
        file = fopen(text, "wb");
        if (file == NULL) break;
#endif
    }
    if (file == NULL) free(text);
    else *name = text;
    return file;
}

/* What stands at path: 0 nothing or a plain file that may be replaced, 1 something to write into as it is (a pipe, a
 * device), -1 refused with errno. */
static int look_at_output(const char *path)
{
#if FILES_POSIX
    struct stat s;
    if (stat(path, &s) != 0) return errno == ENOENT ? 0 : -1;
    if (S_ISDIR(s.st_mode)) {
        errno = EISDIR;
        return -1;
    }
    if (access(path, W_OK) != 0) return -1;
    return S_ISREG(s.st_mode) ? 0 : 1;
#else
    (void)path;
    return 0;
#endif
}

int cli_open_output(cli_run *run, const char *path)
{
    cli_output *const o = &run->output[run->outputs];
    int const kind = look_at_output(path);
    FILE *file;
    if (kind < 0) return cli_fail(run, "%s: cannot be written: %s", path, strerror(errno));
    o->temporary = NULL;
    o->path = copy_text(path);
    if (o->path == NULL) return cli_fail(run, "%s: no memory for its name", path);
    run->outputs++;
    if (kind == 1) return CLI_DONE;
    file = make_temporary(path, &o->temporary);
    if (file == NULL) return cli_fail(run, "%s: cannot be written: %s", path, strerror(errno));
    fclose(file);
    return CLI_DONE;
}

int cli_write_output(cli_run *run, int number, const bvx_buffer *file)
{
    const cli_output *const o = &run->output[number];
    FILE *const out = fopen(o->temporary != NULL ? o->temporary : o->path, "wb");
    uint64_t written = 0;
    if (out == NULL) return cli_fail(run, "%s: cannot be written: %s", o->path, strerror(errno));
    errno = 0;
    while (written < file->size) {
        size_t const rest = (size_t)(file->size - written), part = rest < FILES_CHUNK ? rest : FILES_CHUNK;
        if (fwrite(file->bytes + written, 1, part, out) != part) break;
        written += part;
        if (cli_progress(run, "write", (double)written / (double)file->size)) {
            fclose(out);
            return cli_fail_interrupted(run);
        }
    }
    if ((fclose(out) != 0) | (written < file->size))
        return cli_fail(run, "%s: cannot be written: %s", o->path, strerror(errno != 0 ? errno : EIO));
    return CLI_DONE;
}

int cli_keep_outputs(cli_run *run)
{
    for (int i = 0; i < run->outputs; i++) {
        cli_output *const o = &run->output[i];
        if (o->temporary == NULL) continue;
#if !FILES_POSIX
        remove(o->path); /* rename does not replace there */
#endif
        if (rename(o->temporary, o->path) != 0) return cli_fail(run, "%s: cannot be written: %s", o->path, strerror(errno));
        free(o->temporary);
        o->temporary = NULL;
    }
    return CLI_DONE;
}

void cli_drop_outputs(cli_run *run)
{
    for (int i = 0; i < run->outputs; i++) {
        if (run->output[i].temporary != NULL) remove(run->output[i].temporary);
        free(run->output[i].temporary);
        free(run->output[i].path);
    }
    run->outputs = 0;
}
