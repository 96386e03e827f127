#!/bin/sh
# amalgamate.sh FOLDER [PARTS] - all of the library's sources as FOLDER/bitvox.c, and its headers beside it; with PARTS (words, see
# parts.awk) what these calls need, and headers without the declarations of those that are left out.
# Internal headers are put where they are first included, those named ..._body.h wherever they are; nothing else changes. Run from
# the repository root.
set -eu
out=$1 parts=${2:-}
mkdir -p "$out"
sources=$(find src -name '*.c' ! -path 'src/cli_*' | LC_ALL=C sort)
if [ -z "$parts" ]; then
    cp include/bitvox.h include/bitvox_io.h "$out"
else
    # shellcheck disable=SC2046,SC2086
    chosen=$(awk -f src/parts.awk -v parts="$parts" include/bitvox.h include/bitvox_io.h $(find src -name '*.h' ! -path 'src/cli_*') $sources)
    sources=$(echo "$chosen" | sed '/^-/d')
    # Paragraph by paragraph, a comment goes with the last of its declarations.
    for header in bitvox.h bitvox_io.h; do
    awk -v parts="$parts" -v left="$(echo "$chosen" | sed -n 's/^-//p' | tr '\n' ' ')" '
        BEGIN { count = split(left, names, " "); for (i = 1; i <= count; i++) out["" names[i]] = 1 }
        function finish(    i) {
            if (!dropped || others) {
                if (n || started) for (i = 1; i <= n; i++) print kept[i]
                print ""
                started = 1
            }
            n = dropped = others = dropping = 0
        }
        /^$/ { finish(); next }
        {
            if (/^BVX_API /) {
                declaration = $0
                sub(/\(.*/, "", declaration)
                sub(/.*[ *]/, "", declaration)
                dropping = declaration in out
                dropped += dropping
                others += !dropping
                declaring = 1
            } else if (!declaring && !commenting && !/^\/\*/) others++
            if (/^\/\*/) commenting = 1
            if (/\*\//) commenting = 0
            if (!dropping) kept[++n] = $0
            if (declaring && /;/) declaring = dropping = 0
            if (/^#define BITVOX_H$/) kept[++n] = "#define BVX_PARTS \"" parts "\" /* a part of the library: the other calls are not declared */"
        }
        END { if (n) for (i = 1; i <= n; i++) print kept[i] }' "include/$header" >"$out/$header"
    done
fi
version=$(sed -n 's/^#define BVX_VERSION_\(MAJOR\|MINOR\|PATCH\) //p' include/bitvox.h | tr '\n' '.' | sed 's/\.$//')
{
    cat <<END
/* bitvox.c - the bitvox library $version${parts:+ ($parts)} in one file, put together from its sources; include bitvox.h to use it, and bitvox_io.h for files.
 *
 *   cc -std=c99 -O3 -ffp-contract=off -c bitvox.c        (-fopenmp or -pthread for threads)
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
                    if (name == "bitvox.h" || name == "bitvox_io.h") {
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
