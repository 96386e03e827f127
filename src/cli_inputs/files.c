/* files.c - whole files in.
 *
 * A file is read as a whole, within --memory-limit or what the machine can bear; gzip data are known by their
 * first bytes and unpacked in memory. */
#if defined(__unix__) || defined(__APPLE__)
#define _POSIX_C_SOURCE 200809L
#define FILES_POSIX     1
#else
#define FILES_POSIX 0
#endif

#include "cli_inputs/inputs.h"

#include <errno.h>
#include <inttypes.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#if FILES_POSIX
#include <sys/stat.h>
#endif
#ifdef BVX_HAVE_ZLIB
#include <zlib.h>
#endif

enum { FILES_CHUNK = 1 << 20, FILES_MATERIALS = 4096 };

#define FILES_MACHINE \
    (UINT64_C(4) << 30) /* bytes for files, twice, where the system does not report its memory */

/* ---- room ---- */

/* Half of what there is: what is made of a file takes as much again. */
static uint64_t bytes_ceiling(const cli_run *run)
{
    uint64_t const there = cli_memory_there(), memory = there != 0 ? there : FILES_MACHINE;
    if (run->general->memory_limit != 0) return run->general->memory_limit;
    return memory / 2 < SIZE_MAX ? memory / 2 : SIZE_MAX;
}

/* more: the bytes that do not fit, in words; limit: what others left of the ceiling. */
static int fail_ceiling(cli_run *run, const char *path, const char *more, uint64_t limit)
{
    if (run->general->memory_limit != 0)
        return cli_fail(run, "%s: %s the %" PRIu64 " bytes that --memory-limit leaves for it",
                        cli_input_name(path), more, limit);
    return cli_fail(
        run, "%s: %s %" PRIu64 " bytes, %shalf of the memory there is; --memory-limit sets another limit",
        cli_input_name(path), more, limit, limit < bytes_ceiling(run) ? "what remains of " : "");
}

static int take_room(cli_run *run, const char *path, size_t room, cli_bytes *b)
{
    unsigned char *const bytes = realloc(b->bytes, room);
    if (bytes == NULL)
        return cli_fail(run, "%s: no memory for %" PRIu64 " bytes of it", cli_input_name(path),
                        (uint64_t)room);
    b->bytes = bytes;
    b->room = room;
    cli_large_block(bytes, room);
    return CLI_DONE;
}

static int grow_bytes(cli_run *run, const char *path, cli_bytes *b)
{
    size_t room = b->room < SIZE_MAX / 2 ? b->room * 2 : SIZE_MAX;
    if (room > b->limit) room = (size_t)b->limit;
    if (room <= b->room) return fail_ceiling(run, path, "holds more than", b->limit);
    return take_room(run, path, room, b);
}

static int start_bytes(cli_run *run, const char *path, uint64_t guess, uint64_t limit, cli_bytes *b)
{
    /* One more, so that the end is seen without growing. */
    uint64_t const room = guess < SIZE_MAX - 1 ? guess + 1 : SIZE_MAX;
    memset(b, 0, sizeof *b);
    b->limit = limit < SIZE_MAX ? limit : SIZE_MAX;
    return take_room(run, path, (size_t)(room < b->limit ? room : b->limit), b);
}

/* ---- reading ---- */

/* Bytes of a plain file; 0 when they show only while reading (a pipe), -1 with errno when it is none to
 * read. */
static int64_t size_of_file(FILE *file)
{
    long size = -1;

#if FILES_POSIX
    struct stat s;
    if (fstat(fileno(file), &s) != 0) return -1;
    if (S_ISDIR(s.st_mode)) {
        errno = EISDIR;
        return -1;
    }
    /* The size that the system tells of a pipe or a device says nothing. */
    if (!S_ISREG(s.st_mode)) return 0;
#endif
    if (fseek(file, 0, SEEK_END) == 0) size = ftell(file);
    rewind(file);
    return size < 0 || size == LONG_MAX ? 0 : size;
}

static int read_bytes(cli_run *run, const char *path, FILE *file, uint64_t held, cli_bytes *b)
{
    uint64_t const ceiling = bytes_ceiling(run), limit = held < ceiling ? ceiling - held : 0;
    int64_t const size = file != stdin ? size_of_file(file) : 0;

    if (size < 0) return cli_fail(run, "%s: %s", path, strerror(errno));
    if (limit == 0) return fail_ceiling(run, path, "is to fit into", limit);
    /* A size that is known beforehand is refused before any memory is taken. */
    if ((uint64_t)size > limit) {
        char more[64];
        snprintf(more, sizeof more, "its %" PRId64 " bytes are more than", size);
        return fail_ceiling(run, path, more, limit);
    }
    int status = start_bytes(run, path, size > 0 ? (uint64_t)size : FILES_CHUNK, limit, b);
    while (status == CLI_DONE) {
        size_t const room = b->room - b->size;
        size_t const want = room == 0 ? 1 : room < FILES_CHUNK ? room : FILES_CHUNK;
        unsigned char next; /* exactly full: is there more? */
        int error;
        unsigned char *const to = room != 0 ? b->bytes + b->size : &next;
        size_t got = 0;
        do {
            clearerr(file);
            errno = 0;
            got += fread(to + got, 1, want - got, file);
            error = !ferror(file) ? 0 : errno != 0 ? errno : EIO;
        } while (error == EINTR && !cli_interrupted()); /* a signal that is none of ours: the rest follows */
        if (room == 0 && got != 0) {
            status = grow_bytes(run, path, b);
            if (status != CLI_DONE) break;
            b->bytes[b->size] = next;
        }
        b->size += got;
        if (cli_progress(run, "read", size > 0 ? (double)b->size / (double)size : 0.0))
            return cli_fail_interrupted(run);
        if (error != 0) return cli_fail(run, "%s: %s", cli_input_name(path), strerror(error));
        if (got < want) break;
    }
    return status;
}

/* ---- gzip ---- */

#ifdef BVX_HAVE_ZLIB
/* One gzip member after the other, as gzip itself reads them; zero bytes after the last are padding. */
static int inflate_all(cli_run *run, const char *path, const cli_bytes *packed, cli_bytes *b, z_stream *z)
{
    size_t taken = 0;

    for (;;) {
        if (b->size == b->room && grow_bytes(run, path, b) != CLI_DONE) return CLI_FAILED;
        size_t const in = packed->size - taken, out = b->room - b->size;
        z->next_in = packed->bytes + taken;
        /* zlib counts in 32 bits, and progress wants to hear of it. */
        z->avail_in = in < FILES_CHUNK ? (uInt)in : FILES_CHUNK;
        z->next_out = b->bytes + b->size;
        z->avail_out = out < FILES_CHUNK ? (uInt)out : FILES_CHUNK;
        int result = inflate(z, Z_NO_FLUSH);
        taken = (size_t)(z->next_in - packed->bytes);
        b->size = (size_t)(z->next_out - b->bytes);
        if (cli_progress(run, "unpack", (double)taken / ((double)packed->size + 1.0)))
            return cli_fail_interrupted(run);
        if (result == Z_STREAM_END) {
            while (taken < packed->size && packed->bytes[taken] == 0) taken++;
            if (taken == packed->size) return CLI_DONE;
            if (packed->size - taken < 2 || packed->bytes[taken] != 0x1f ||
                packed->bytes[taken + 1] != 0x8b) {
                cli_warn(run, BVX_WARN_READ, "%s: gzip: %" PRIu64 " bytes after the data are ignored",
                         cli_input_name(path), (uint64_t)(packed->size - taken));
                return CLI_DONE;
            }
            inflateReset(z);
        } else if (result == Z_BUF_ERROR && taken == packed->size) {
            return cli_fail(run, "%s: gzip: the data end too early, at byte %" PRIu64, cli_input_name(path),
                            (uint64_t)taken);
        } else if (result != Z_OK && result != Z_BUF_ERROR) {
            return cli_fail(run, "%s: gzip: %s near byte %" PRIu64, cli_input_name(path),
                            z->msg != NULL ? z->msg : "damaged data", (uint64_t)taken);
        }
    }
}

static int unpack(cli_run *run, const char *path, cli_bytes *b)
{
    cli_bytes plain;
    z_stream z = {0};
    uint64_t const limit = b->limit > b->size ? b->limit - b->size : 1; /* both are held for a while */
    uint64_t guess = 64;                                                /* where the file is cut off */
    if (b->size >= 18) {
        /* The size modulo 2^32, and of the last member only: a guess that is checked. Deflate: 1032 at most. */
        const unsigned char *const p = b->bytes + b->size - 4;
        guess = (uint64_t)p[0] | (uint64_t)p[1] << 8 | (uint64_t)p[2] << 16 | (uint64_t)p[3] << 24;
        if (guess < b->size || guess / 1100 > b->size) guess = (uint64_t)b->size * 4;
    }
    int status = start_bytes(run, path, guess, limit, &plain);

    if (status != CLI_DONE) return status;
    if (inflateInit2(&z, 15 + 16) != Z_OK) { /* the largest window, gzip's head and foot */
        free(plain.bytes);
        return cli_fail(run, "%s: gzip: no memory to unpack it", cli_input_name(path));
    }
    status = inflate_all(run, path, b, &plain, &z);
    inflateEnd(&z);
    cli_note_peak(run, (uint64_t)b->size + plain.size);
    free(b->bytes);
    *b = plain;
    return status;
}
#else
static int unpack(cli_run *run, const char *path, cli_bytes *b)
{
    (void)b;
    return cli_fail(run, "%s: gzip data, which this build cannot unpack: it was made without zlib",
                    cli_input_name(path));
}
#endif

/* ---- inputs ---- */

int cli_read_bytes(cli_run *run, const char *path, uint64_t held, cli_bytes *b)
{
    int const standard = strcmp(path, "-") == 0;

    memset(b, 0, sizeof *b);
    FILE *const file = standard ? stdin : cli_open_file(path, "rb");
    /* while a pipe had no writer */
    if (file == NULL && errno == EINTR && cli_interrupted()) return cli_fail_interrupted(run);
    if (file == NULL) return cli_fail(run, "%s: %s", path, strerror(errno));
    int status = read_bytes(run, path, file, held, b);
    if (!standard) fclose(file);
    /* By its bytes, and by its name too: a .gz that holds none is refused there. */
    size_t const n = strlen(path);
    int const packed = (b->size >= 2 && b->bytes[0] == 0x1f && b->bytes[1] == 0x8b) ||
                       (n > 3 && strcmp(path + n - 3, ".gz") == 0);
    if (status == CLI_DONE && packed) status = unpack(run, path, b);
    cli_note_peak(run, b->size);
    return status;
}

int cli_read_file(cli_run *run, const char *path, cli_bytes *b)
{
    cli_stage_begin(run, "read");
    int status = cli_read_bytes(run, path, 0, b);
    if (status == CLI_DONE) cli_stage_end(run);
    return status;
}

int cli_open_input(cli_run *run, const char *path, cli_bytes *b)
{
    CLI_TRY(cli_read_file(run, path, b));
    return cli_make_context(run, b->size);
}

void cli_end_parse(cli_run *run, uint64_t bytes)
{
    cli_stage_end(run);
    cli_note_peak(run, bytes);
    /* The file goes after this, so later peaks start without it. */
    bvx_memory_reset_peak(run->context);
}

static int is_mesh_format(int32_t format)
{
    return format > 0 && format < 31 && (BVX_MESHES_READ >> format & 1) != 0;
}

/* ---- files that a file names ---- */

typedef struct files_beside {
    cli_run *run;
    const char *path; /* of the file that names them */
    uint64_t held;    /* bytes of all that are open, and of that file */
    int failed;       /* 1: one is there and cannot be read, which is told */
    bvx_read_report report;
} files_beside;

static int32_t open_beside(void *user, const char *name, bvx_file_bytes *file)
{
    files_beside *const beside = user;
    size_t folder = strlen(beside->path), n = strlen(name);
    cli_bytes *const b = calloc(1, sizeof *b);

    while (folder > 0 && strchr("/\\", beside->path[folder - 1]) == NULL) folder--;
    char *const path = malloc(folder + n + 1);
    if (b == NULL || path == NULL) {
        free(path);
        free(b);
        return 1;
    }
    memcpy(path, beside->path, folder);
    memcpy(path + folder, name, n + 1);

    /* A file that is not there is no failure of the run: the reader knows what it is needed for. */
    FILE *const there = cli_open_file(path, "rb");
    if (there != NULL && !beside->failed)
        beside->failed = read_bytes(beside->run, path, there, beside->held, b) != CLI_DONE;
    if (there == NULL || beside->failed) {
        free(b->bytes);
        free(b);
    } else {
        beside->held += b->room;
        file->handle = b;
        file->bytes = b->bytes;
        file->size = b->size;
    }
    if (there != NULL) fclose(there);
    free(path);
    return file->handle == NULL;
}

static void close_beside(void *user, bvx_file_bytes *file)
{
    cli_bytes *const b = file->handle;
    (void)user;
    free(b->bytes);
    free(b);
}

/* Commands that measure a mesh or describe it leave out triangles that lie nowhere; the others, which keep
 * triangles, refuse them: what keeps every triangle in its place must not lose one silently. */
static bvx_status read_triangles(files_beside *beside, const cli_bytes *b, int32_t format, bvx_mesh *mesh)
{
    cli_run *const run = beside->run;
    const cli_options *const o = run->options;
    int const levels = o->triangles.count + o->errors.count + (int)o->count;
    int const alone = levels == 1 || (levels == 0 && (run->command->bit & CLI_SIMPLIFY) != 0);
    bvx_read_options options = {.struct_size = sizeof options};

    /* Each level becomes the input's file with other triangles, so that nothing of it is lost. */
    options.keep_file = o->keep_vertices && !cli_given(run, "--output-origin") && !o->quantize &&
                        o->output != NULL && bvx_format_of_name(o->output) == BVX_FORMAT_GLB &&
                        cli_turn_of(run) == BVX_TURN_NONE && (alone || strchr(o->output, '%') != NULL);
    options.drop_nonfinite = !options.keep_file &&
                             (run->command->bit & (CLI_REPAIR | CLI_LOD | CLI_VOXELIZE | CLI_BOOLEAN |
                                                   CLI_INFO | CLI_HULL | CLI_CHECK)) != 0;
    options.report = &beside->report;
#ifdef BVX_HAVE_ZLIB
    options.inflate = cli_inflate;
#endif
    if (strcmp(beside->path, "-") != 0) {
        options.open_file = open_beside;
        options.close_file = close_beside;
        options.user = beside;
    }
    return bvx_read_mesh(run->context, b->bytes, b->size, format, &options, mesh);
}

static void warn_of_losses(cli_run *run, const char *path, uint32_t lost)
{
    static const struct {
        uint32_t bit;
        const char *text;
    } known[] = {{BVX_LOST_SKINS, "skins"},
                 {BVX_LOST_MORPHS, "morph targets"},
                 {BVX_LOST_ANIMATIONS, "animations"},
                 {BVX_LOST_POINTS, "points and lines"},
                 {BVX_LOST_IMAGES, "images whose file is not there"},
                 {BVX_LOST_ATTRIBUTES, "further attributes of vertices"},
                 {BVX_LOST_MATERIALS, "materials"}};
    char text[160] = "";
    size_t n = 0;

    /* Most files name some, and only a mesh or coloured voxels could have them. */
    if (!CLI_HOLDS(run, CLI_TO_MESH) && bvx_format_of_name(run->options->output) != BVX_FORMAT_VOX)
        lost &= ~(uint32_t)BVX_LOST_MATERIALS;

    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++)
        if ((lost & known[i].bit) != 0)
            n += (size_t)snprintf(text + n, sizeof text - n, "%s%s", n > 0 ? ", " : "", known[i].text);
    if (n > 0)
        cli_warn(run, BVX_WARN_READ, "%s: not read: %s%s", cli_input_name(path), text,
                 (lost & BVX_LOST_MATERIALS) != 0 ? "; exported as .glb a model has them" : "");
}

uint32_t cli_attributes_of(const bvx_mesh *mesh)
{
    return (mesh->colours != NULL ? CLI_HAS_COLOURS : 0u) | (mesh->uvs != NULL ? CLI_HAS_UVS : 0u) |
           (mesh->uvs2 != NULL ? CLI_HAS_SECOND_UVS : 0u) |
           (mesh->materials != NULL ? CLI_HAS_MATERIALS : 0u);
}

/* cloud NULL: points without triangles are refused. */
static int read_mesh_file(cli_run *run, const char *path, int32_t format, bvx_mesh *mesh, int *cloud)
{
    files_beside beside = {.run = run, .path = path};
    cli_bytes b = {NULL, 0, 0, 0};
    int status = cli_open_input(run, path, &b);

    if (status == CLI_DONE) {
        cli_stage_begin(run, "parse");
        beside.held = b.room;
        bvx_status read = BVX_ERR_EMPTY;
        if (format != BVX_FORMAT_XYZ) read = read_triangles(&beside, &b, format, mesh);
        if (read == BVX_ERR_EMPTY && cloud != NULL &&
            (format == BVX_FORMAT_XYZ || format == BVX_FORMAT_PLY)) {
            *cloud = 1;
            read = bvx_read_points(run->context, b.bytes, b.size, format, mesh);
        }
        cli_end_parse(run, b.size);
        status = beside.failed ? CLI_FAILED : cli_check_call(run, read, cli_input_name(path));
    }
    if (status == CLI_DONE) {
        run->report.nonfinite += beside.report.dropped;

        if (beside.report.dropped != 0)
            cli_warn(run, BVX_WARN_READ,
                     "%s: %" PRIu64 " triangle%s with a corner that is not finite left out",
                     cli_input_name(path), beside.report.dropped, beside.report.dropped == 1 ? "" : "s");

        warn_of_losses(run, path, beside.report.lost);
        run->report.had |= cli_attributes_of(mesh);

        /* Materials in use; those beyond the first of a great many count as one. */
        unsigned char used[FILES_MATERIALS] = {0};
        int count = 0;
        for (uint64_t t = 0; mesh->materials != NULL && t < mesh->triangle_count; t++) {
            uint32_t const m = mesh->materials[t] < FILES_MATERIALS ? mesh->materials[t]
                                                                    : FILES_MATERIALS - 1;
            count += !used[m];
            used[m] = 1;
        }
        run->report.materials += count;
    }
    free(b.bytes);
    return status;
}

int cli_read_mesh(cli_run *run, const char *path, bvx_mesh *mesh)
{
    int32_t const format = cli_input_format(run, path);
    if (strcmp(path, "-") == 0 && !is_mesh_format(format))
        return cli_usage(run, "--format does not name a mesh format that can be read (" CLI_MESHES_READ ")");
    if (!is_mesh_format(format))
        return cli_fail(run,
                        "%s: the name does not end in a mesh format that can be read (" CLI_MESHES_READ
                        ", also with .gz)%s",
                        path, cli_way_around(path, 0));
    return read_mesh_file(run, path, format, mesh, NULL);
}

int cli_read_mesh_or_cloud(cli_run *run, const char *path, bvx_mesh *mesh, int *cloud)
{
    int32_t const format = cli_input_format(run, path);
    *cloud = 0;
    if (format != BVX_FORMAT_XYZ && !is_mesh_format(format)) return cli_read_mesh(run, path, mesh);
    return read_mesh_file(run, path, format, mesh, cloud);
}
