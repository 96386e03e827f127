/* pack.c - files whose names end in .gz are packed by gzip before they are written.
 *
 * The same bytes give the same file: neither a time nor a name is stored. */
#include "cli_shell/shell.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#ifdef BVX_HAVE_ZLIB
#include <zlib.h>
#endif

enum { PACK_CHUNK = 1 << 20, PACK_LEVEL = 6, PACK_LEAST = 64 };

int cli_is_packed(const char *path)
{
    size_t const n = strlen(path);
    return n > 3 && strcmp(path + n - 3, ".gz") == 0;
}

#ifdef BVX_HAVE_ZLIB

static int grow_packed(cli_run *run, const char *path, bvx_buffer *packed)
{
    uint64_t const capacity = packed->capacity * 2;
    uint8_t *const bytes = capacity <= SIZE_MAX ? realloc(packed->bytes, (size_t)capacity) : NULL;
    if (bytes == NULL) return cli_fail(run, "%s: no memory for %" PRIu64 " packed bytes", path, capacity);
    packed->bytes = bytes;
    packed->capacity = capacity;
    return CLI_DONE;
}

static int deflate_all(cli_run *run, const char *path, const bvx_buffer *plain, bvx_buffer *packed,
                       z_stream *z)
{
    uint64_t taken = 0;

    for (int result = Z_OK; result != Z_STREAM_END;) {
        /* zlib counts in 32 bits, and progress wants to hear of it: chunk by chunk. */
        uint64_t const in = plain->size - taken, most = in < PACK_CHUNK ? in : PACK_CHUNK;

        if (packed->size == packed->capacity && grow_packed(run, path, packed) != CLI_DONE) return CLI_FAILED;
        uint64_t out = packed->capacity - packed->size;
        if (out > PACK_CHUNK) out = PACK_CHUNK;
        z->next_in = plain->bytes + taken;
        z->avail_in = (uInt)most;
        z->next_out = packed->bytes + packed->size;
        z->avail_out = (uInt)out;
        result = deflate(z, most == in ? Z_FINISH : Z_NO_FLUSH);
        taken += most - z->avail_in;
        packed->size += out - z->avail_out;
        if (cli_progress(run, "pack", (double)taken / ((double)plain->size + 1.0)))
            return cli_fail_interrupted(run);
        if (result != Z_OK && result != Z_STREAM_END && result != Z_BUF_ERROR)
            return cli_fail(run, "%s: cannot be packed", path);
    }
    return CLI_DONE;
}

int cli_pack(cli_run *run, const char *path, const bvx_buffer *plain, bvx_buffer *packed)
{
    z_stream z;

    memset(packed, 0, sizeof *packed);
    /* A guess at the packed size, which doubles as long as it is too small. */
    packed->capacity = plain->size / 4 + PACK_LEAST;
    packed->bytes = packed->capacity <= SIZE_MAX ? malloc((size_t)packed->capacity) : NULL;
    if (packed->bytes == NULL)
        return cli_fail(run, "%s: no memory for %" PRIu64 " packed bytes", path, packed->capacity);

    memset(&z, 0, sizeof z);
    /* the largest window, gzip's head and foot */
    if (deflateInit2(&z, PACK_LEVEL, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY) != Z_OK)
        return cli_fail(run, "%s: no memory to pack it", path);
    int const status = deflate_all(run, path, plain, packed, &z);
    deflateEnd(&z);
    cli_note_peak(run, packed->capacity);
    return status;
}

int cli_can_pack(void)
{
    return 1;
}

#else

int cli_pack(cli_run *run, const char *path, const bvx_buffer *plain, bvx_buffer *packed)
{
    (void)plain;
    (void)packed;
    return cli_fail(run, "%s: this build cannot pack: it was made without zlib", path);
}

int cli_can_pack(void)
{
    return 0;
}

#endif
