/* outputs.c - whole files out.
 *
 * An output is written under a temporary name in its own folder, which also shows at once whether that is
 * possible, and gets its name when all outputs are written; whatever happens before leaves the folder as it was.
 * So an output may also be the file that is read. Symbolic links stay, and what they point at is replaced.
 * What is no plain file (a pipe, a device, standard output by one of its names) is written in place. */
#if defined(__unix__) || defined(__APPLE__)
#define _POSIX_C_SOURCE 200809L
#define OUTPUTS_POSIX   1
#else
#define OUTPUTS_POSIX 0
#endif
#if OUTPUTS_POSIX || defined(_WIN32)
#define OUTPUTS_REPLACES 1
#else
#define OUTPUTS_REPLACES 0
#endif

#include "cli_shell/shell.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#if OUTPUTS_POSIX
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#elif defined(_WIN32)
#include <process.h>
#endif

enum { OUTPUT_CHUNK = 1 << 20, OUTPUT_TRIES = 1000 };

/* ---- names ---- */

static char *copy_text(const char *text)
{
    char *const copy = malloc(strlen(text) + 1);
    if (copy != NULL) memcpy(copy, text, strlen(text) + 1);
    return copy;
}

/* Length of the folder's part of a path, its last slash included. */
static size_t folder_length(const char *path)
{
    const char *slash = strrchr(path, '/');
#if defined(_WIN32)
    const char *const back = strrchr(path, '\\');
    if (back != NULL && (slash == NULL || back > slash)) slash = back;
#endif
    return slash != NULL ? (size_t)(slash - path) + 1 : 0;
}

/* Name number i beside path, short so that it fits where path fits. */
static char *name_beside(const char *path, int i, const char *ending)
{
    size_t const folder = folder_length(path), room = folder + 64;
    char *const name = malloc(room);
    long process = 0;
#if OUTPUTS_POSIX
    /* Runs at the same time in one folder must not meet. */
    process = (long)getpid();
#elif defined(_WIN32)
    process = (long)_getpid();
#endif
    if (name != NULL) snprintf(name, room, "%.*sbitvox-%ld-%d.%s", (int)folder, path, process, i, ending);
    return name;
}

#if OUTPUTS_POSIX

/* The file behind symbolic links, also when there is none yet. NULL with errno. */
static char *follow_links(const char *path)
{
    char *now = copy_text(path);

    /* As many links as the system itself follows before it calls them a loop. */
    for (int i = 0; i < 40 && now != NULL; i++) {
        char link[4096];
        ssize_t const n = readlink(now, link, sizeof link);
        size_t const folder = n > 0 && link[0] == '/' ? 0 : folder_length(now);
        if (n < 0 || (size_t)n >= sizeof link) return now; /* no link */
        char *const next = malloc(folder + (size_t)n + 1);
        if (next != NULL) {
            memcpy(next, now, folder);
            memcpy(next + folder, link, (size_t)n);
            next[folder + (size_t)n] = 0;
        }
        free(now);
        now = next;
    }
    free(now);
    errno = now == NULL ? ENOMEM : ELOOP;
    return NULL;
}

/* Kind and target of what is at o->path, and its mode (0: nothing). 0 with errno when refused. */
static int look_at_output(cli_output *o, unsigned *mode)
{
    struct stat s, standard, behind;

    if (stat(o->path, &s) != 0) {
        if (errno != ENOENT) return 0;
    } else {
        if (S_ISDIR(s.st_mode)) {
            errno = EISDIR;
            return 0;
        }
        /* /dev/stdout, or the file that standard output was sent to. */
        if (fstat(STDOUT_FILENO, &standard) == 0 && standard.st_dev == s.st_dev &&
            standard.st_ino == s.st_ino)
            o->kind = CLI_OUT_STANDARD;
        else if (access(o->path, W_OK) != 0) return 0;
        else if (!S_ISREG(s.st_mode)) o->kind = CLI_OUT_IN_PLACE;
        if (o->kind != CLI_OUT_NEW) return 1;
        *mode = (unsigned)s.st_mode & 0777u;
    }
    /* The link stays; the file behind it is replaced, so the temporary must lie beside that. */
    o->target = follow_links(o->path);
    if (o->target == NULL) return 0;
    if (*mode != 0 &&
        (stat(o->target, &behind) != 0 || behind.st_dev != s.st_dev || behind.st_ino != s.st_ino))
        o->kind = CLI_OUT_IN_PLACE; /* open somewhere, but without a name */
    return 1;
}

static FILE *create_file(const char *name, unsigned mode)
{
    int const number = open(name, O_WRONLY | O_CREAT | O_EXCL, mode != 0 ? (mode_t)mode : 0666);
    if (number < 0) return NULL;
    if (mode != 0) (void)!fchmod(number, (mode_t)mode); /* as the file that it will replace */
    FILE *const file = fdopen(number, "wb");
    if (file == NULL) close(number);
    return file;
}

#else

#if defined(_WIN32)

/* Links are not followed: the file gets their name. */
static int look_at_output(cli_output *o, unsigned *mode)
{
    int const kind = cli_kind_of_name(o->path);
    (void)mode;
    errno = EISDIR;
    if (kind == CLI_NAME_FOLDER) return 0;
    if (kind == CLI_NAME_DEVICE) {
        o->kind = CLI_OUT_IN_PLACE;
        return 1;
    }
    o->target = copy_text(o->path);
    return o->target != NULL;
}

static int is_there(const char *name)
{
    return cli_kind_of_name(name) != CLI_NAME_NONE;
}

#else

static int look_at_output(cli_output *o, unsigned *mode)
{
    (void)mode;
    o->target = copy_text(o->path);
    return o->target != NULL;
}

static int is_there(const char *name)
{
    FILE *const file = fopen(name, "rb");
    if (file != NULL) fclose(file);
    return file != NULL;
}

#endif

static FILE *create_file(const char *name, unsigned mode)
{
    int const there = is_there(name);
    (void)mode;
    errno = EEXIST;
    return there ? NULL : cli_open_file(name, "wb");
}

#endif

/* ---- opening and writing ---- */

/* A new file beside the target. 0 with errno. */
static int make_temporary(cli_output *o, unsigned mode)
{
    FILE *file = NULL;
    for (int i = 0; i < OUTPUT_TRIES && file == NULL; i++) {
        /* In the same folder: a rename there is one step, and shows now whether the folder can be written. */
        o->temporary = name_beside(o->target, i, "part");
        if (o->temporary == NULL) return 0;
        file = create_file(o->temporary, mode);
        if (file != NULL) break;
        free(o->temporary);
        o->temporary = NULL;
        if (errno != EEXIST) return 0;
    }
    return file != NULL && fclose(file) == 0;
}

/* The output opened before whose file this one would replace too, or NULL. */
static const char *same_file(const cli_run *run, const cli_output *o)
{
    for (int i = 0; i < run->outputs; i++) {
        const cli_output *const other = &run->output[i];
        if (other != o && o->kind == CLI_OUT_NEW && other->kind == CLI_OUT_NEW &&
            cli_same_name(other->target, o->target))
            return other->path;
    }
    return NULL;
}

int cli_open_output(cli_run *run, const char *path)
{
    cli_output *const o = &run->output[run->outputs];
    unsigned mode = 0;

    if (run->outputs == CLI_MAX_OUTPUTS)
        return cli_fail(run, "%s: more than %d outputs", path, CLI_MAX_OUTPUTS);
#ifndef BVX_HAVE_ZLIB
    if (cli_is_packed(path))
        return cli_fail(run, "%s: this build cannot pack: it was made without zlib; give a name without .gz",
                        path);
#endif
    memset(o, 0, sizeof *o);
    o->path = copy_text(path);
    cli_watch_last(NULL);
    run->outputs++;
    /* The copy of the path is the first thing that can fail. */
    errno = ENOMEM;
    if (cli_is_standard_output(run, path)) o->kind = CLI_OUT_STANDARD;
    int good = o->path != NULL && (o->kind == CLI_OUT_STANDARD || look_at_output(o, &mode));
    const char *const same = good ? same_file(run, o) : NULL;
    good = good && same == NULL && (o->kind != CLI_OUT_NEW || make_temporary(o, mode));
    int const error = errno;
    if (same != NULL) return cli_fail(run, "%s and %s are one file", same, path);
    if (!good) return cli_fail(run, "%s: cannot be written: %s", path, strerror(error));
    if (run->standard_name[0] != 0 && run->outputs > 1) {
        const char *other = cli_is_standard_output(run, path) ? run->output[0].path : path;
        /* A side-car of what has no name itself. */
        if (strncmp(other, run->standard_name, strlen(run->standard_name)) == 0) other += strcspn(other, ".");
        return cli_usage(run, "-o - is for one output; %s would be another", other);
    }
    if (o->kind != CLI_OUT_STANDARD || cli_is_standard_output(run, path)) return CLI_DONE;
    if (run->general->json)
        return cli_usage(run, "%s is standard output, where --json writes its report", path);
    run->standard_taken = 1;
    return CLI_DONE;
}

static int write_bytes(cli_run *run, cli_output *o, const bvx_buffer *buffer)
{
    int const standard = o->kind == CLI_OUT_STANDARD;
    FILE *file;
    if (o->kind == CLI_OUT_NEW) {
        file = cli_open_file(o->temporary,
                             "r+b"); /* ext4 writes out truncated files at once when they close */
    } else {
        file = o->kind == CLI_OUT_STANDARD ? stdout
                                           : cli_open_file(o->path, "wb"); /* may wait for a reader */
        o->begun = 1;
    }
    uint64_t written = 0;
    int error = file == NULL ? errno : 0, stopped = 0;

    /* while a pipe had no reader */
    if (error == EINTR && cli_interrupted()) return cli_fail_interrupted(run);
    if (file == NULL) return cli_fail(run, "%s: cannot be written: %s", o->path, strerror(error));
    /* parts are large, and after a failure it must be known how much was taken */
    setvbuf(file, NULL, _IONBF, 0);
    while (written < buffer->size && error == 0 && !stopped) {
        size_t const rest = (size_t)(buffer->size - written);
        size_t const part = rest < OUTPUT_CHUNK ? rest : OUTPUT_CHUNK;
        /* fwrite need not set it. */
        errno = 0;
        size_t const taken = fwrite(buffer->bytes + written, 1, part, file);
        written += taken;
        if (taken != part) error = errno != 0 ? errno : EIO;
        stopped = cli_progress(run, "write", (double)written / (double)buffer->size) != 0;
        if (error != EINTR) continue;
        error = 0; /* a signal that is none of ours: the rest follows */
        clearerr(file);
    }
    /* A close can fail without saying why; what failed first is told. */
    errno = 0;
    if ((standard ? fflush(file) : fclose(file)) != 0 && error == 0) error = errno != 0 ? errno : EIO;
    if (stopped) return cli_fail_interrupted(run);
    if (error == 0) return CLI_DONE;

    /* -o - is the only output, so nothing of another one is half done; a file that leads there may be one
     * of several. */
    if (cli_is_standard_output(run, o->path)) cli_end_without_reader();
    return cli_fail(run, "%s: cannot be written: %s", o->path, strerror(error));
}

int cli_write_output(cli_run *run, int number, const bvx_buffer *buffer)
{
    cli_output *const o = &run->output[number];
    bvx_buffer packed = {0};
    int status = CLI_DONE;
#ifdef BVX_HAVE_ZLIB
    if (cli_is_packed(o->path)) {
        status = cli_pack(run, o->path, buffer, &packed);
        buffer = &packed;
    }
#endif
    if (status == CLI_DONE) status = write_bytes(run, o, buffer);
    free(packed.bytes);
    return status;
}

void cli_forget_output(cli_run *run, int number)
{
    cli_output *const o = &run->output[number];
    if (o->temporary != NULL) cli_remove_file(o->temporary);
    free(o->temporary);
    free(o->target);
    free(o->path);
    run->outputs--;
    memmove(o, o + 1, (size_t)(run->outputs - number) * sizeof *o);
}

/* ---- the end ---- */

static int give_name(cli_output *o)
{
    if (o->kind != CLI_OUT_NEW) return 1;
#if !OUTPUTS_REPLACES
    cli_remove_file(o->target);
#endif
    if (cli_rename_file(o->temporary, o->target) != 0) return 0;
    free(o->temporary);
    o->temporary = NULL;
    return 1;
}

int cli_keep_outputs(cli_run *run)
{
    if (cli_interrupted()) return cli_fail_interrupted(run);
    for (int i = 0; i < run->outputs; i++)
        if (!give_name(&run->output[i]))
            return cli_fail(run, "%s: cannot be written: %s%s", run->output[i].path, strerror(errno),
                            i > 0 ? "; the outputs before it are written" : "");
    cli_watch_last("bitvox: interrupted; what was requested is written\n");
    return CLI_DONE;
}

void cli_drop_outputs(cli_run *run)
{
    for (int i = 0; i < run->outputs; i++) {
        cli_output *const o = &run->output[i];
        if (o->temporary != NULL) cli_remove_file(o->temporary);
        free(o->temporary);
        free(o->target);
        o->temporary = o->target = NULL;
    }
    cli_watch_last("");
}
