/* inflate.c - deflated bytes of files, as gzip and zlib have them. */
#include "cli_inputs/inputs.h"

#include <string.h>
#ifdef BVX_HAVE_ZLIB
#include <zlib.h>
#endif

/* user is set where the bytes may be plain. Data files that end in .gz are unpacked when they are read. */
int32_t cli_inflate(void *user, const void *packed, uint64_t packed_size, void *plain, uint64_t plain_size)
{
    const unsigned char *const bytes = packed;

    /* Some files say gzip and hold plain bytes. */
    if (user != NULL && packed_size == plain_size &&
        (packed_size < 2 || bytes[0] != 0x1f || bytes[1] != 0x8b)) {
        memcpy(plain, packed, (size_t)plain_size);
        return 0;
    }
#ifdef BVX_HAVE_ZLIB
    {
        z_stream z;
        uint64_t taken = 0, made = 0;
        int result = Z_OK;
        memset(&z, 0, sizeof z);
        if (inflateInit2(&z, 15 + 32) != Z_OK) return 1; /* the head of gzip or zlib */
        while (result == Z_OK) {
            uint64_t const in = packed_size - taken, out = plain_size - made;
            uInt const part_in = in < (1 << 20) ? (uInt)in : 1 << 20;
            uInt const part_out = out < (1 << 20) ? (uInt)out : 1 << 20;
            /* One byte past the end shows whether there is more than there should be. */
            unsigned char beyond;
            z.next_in = (unsigned char *)(uintptr_t)bytes + taken;
            z.avail_in = part_in;
            z.next_out = part_out != 0 ? (unsigned char *)plain + made : &beyond;
            z.avail_out = part_out != 0 ? part_out : 1;
            result = inflate(&z, Z_NO_FLUSH);
            taken += part_in - z.avail_in;
            if (part_out == 0 && z.avail_out == 0) result = Z_DATA_ERROR; /* more than there should be */
            else if (part_out != 0) made += part_out - z.avail_out;
        }
        inflateEnd(&z);
        return result == Z_STREAM_END && made == plain_size ? 0 : 1;
    }
#else
    return 1;
#endif
}
