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

int cli_is_packed(const char *path)
{
    size_t const n = strlen(path);
    return n > 3 && strcmp(path + n - 3, ".gz") == 0;
}

#ifdef BVX_HAVE_ZLIB
/* zlib counts in 32 bits, and progress wants to hear of it: chunk by chunk. */
static uInt chunk_of(uint64_t bytes)
{
    return bytes < (1 << 20) ? (uInt)bytes : 1 << 20;
}

int cli_pack(cli_run *run, const char *path, const bvx_buffer *plain, bvx_buffer *packed)
{
    z_stream z = {0};
    uint64_t taken = 0;
    int result = Z_OK, stopped = 0;

    /* What cannot be packed takes a little more than it was. */
    packed->capacity = plain->size + plain->size / 1000 + 64;
    packed->bytes = packed->capacity <= SIZE_MAX ? malloc((size_t)packed->capacity) : NULL;
    /* the largest window, gzip's head and foot */
    if (packed->bytes == NULL || deflateInit2(&z, 6, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY) != Z_OK)
        return cli_fail(run, "%s: no memory for %" PRIu64 " packed bytes", path, packed->capacity);
    while (result == Z_OK && !stopped) {
        uInt const in = chunk_of(plain->size - taken), out = chunk_of(packed->capacity - packed->size);
        z.next_in = plain->bytes + taken;
        z.avail_in = in;
        z.next_out = packed->bytes + packed->size;
        z.avail_out = out;
        result = deflate(&z, taken + in == plain->size ? Z_FINISH : Z_NO_FLUSH);
        taken += in - z.avail_in;
        packed->size += out - z.avail_out;
        stopped = cli_progress(run, "pack", (double)taken / ((double)plain->size + 1.0)) != 0;
    }
    deflateEnd(&z);
    cli_note_peak(run, packed->size);
    if (stopped) return cli_fail_interrupted(run);
    return result == Z_STREAM_END ? CLI_DONE : cli_fail(run, "%s: cannot be packed", path);
}
#endif
