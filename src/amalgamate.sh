#!/bin/sh
# amalgamate.sh FOLDER - all of the library's sources as two files, FOLDER/bitvox.c and FOLDER/bitvox.h.
# Internal headers are put where they are first included, those named ..._body.h wherever they are; nothing else changes. Run from
# the repository root.
set -eu
out=$1
mkdir -p "$out"
cp include/bitvox.h "$out/bitvox.h"
sources=$(find src -name '*.c' ! -path 'src/cli_*' | LC_ALL=C sort)
version=$(sed -n 's/^#define BVX_VERSION_\(MAJOR\|MINOR\|PATCH\) //p' include/bitvox.h | tr '\n' '.' | sed 's/\.$//')
{
    cat <<END
/* bitvox.c - the bitvox library $version in one file, put together from its sources; include bitvox.h to use it.
 *
 *   cc -std=c99 -O3 -ffp-contract=off -c bitvox.c        (-pthread for threads)
 *
 * On 32-bit x86 add -msse2 -mfpmath=sse. Never compile it with -ffast-math.
 * Define BVX_FREESTANDING where there is no C heap: contexts then bring their own memory.
 *
 * Licence: MIT. */
#if defined(__linux__) && !defined(_GNU_SOURCE)
#define _GNU_SOURCE /* what -std=c99 hides: clocks and affinity, for threads alone */
#endif
#if defined(__clang__)
#pragma clang diagnostic ignored "-Wunused-function" /* inline helpers that not every target needs */
#endif
END
    # shellcheck disable=SC2086
    awk '
        function show(path,    line, name, folder) {
            seen[path] = 1
            print "\n/* ==== " path " ==== */\n"
            while ((getline line < path) > 0) {
                if (line ~ /^[ \t]*#[ \t]*include[ \t]*"/) {
                    name = line
                    gsub(/^[^"]*"|".*$/, "", name)
                    if (name == "bitvox.h") {
                        if (!seen[name]++) print line
                        continue
                    }
                    folder = path
                    sub(/[^\/]*$/, "", folder)
                    name = (getline line < ("src/" name)) >= 0 ? "src/" name : folder name
                    close(name)
                    if (!seen[name] || name ~ /_body\.h$/) show(name)
                } else print line
            }
            close(path)
        }
        BEGIN { for (i = 1; i < ARGC; i++) show(ARGV[i]) }' $sources
} >"$out/bitvox.c"
