#!/bin/sh
# struct_offsets.sh CC - size of every public struct and offset of every field, one a line, as this compiler lays them out, and
# the value of every constant. They are read from both headers, so none is forgotten. Run from the repository root.
# RUNNER in the environment: what runs the compiler's programs, when this machine does not.
set -eu
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
{
    echo '#include "bitvox_io.h"'
    echo '#include <stdio.h>'
    echo 'int main(void) {'
    awk '{ # without comments
        line = $0
        code = ""
        while (line != "") {
            at = index(line, inside ? "*/" : "/*")
            if (!inside) code = code (at ? substr(line, 1, at - 1) : line)
            line = at ? substr(line, at + 2) : ""
            if (at) inside = !inside
        }
        print code
    }' include/bitvox.h include/bitvox_io.h | awk '
        /^typedef struct bvx_[a-z0-9_]* \{/ {
            name = $3
            print "printf(\"%s %u\\n\", \"" name "\", (unsigned)sizeof(" name "));"
            on = 1
            next
        }
        on && /^\}/ { on = 0 }
        on && /;/ {
            line = $0
            sub(/;.*/, "", line)
            sub(/^ *(const )?[a-zA-Z0-9_]+ +/, "", line)
            n = split(line, field, ",")
            for (i = 1; i <= n; i++) {
                sub(/\[.*/, "", field[i])
                gsub(/\* *const /, "", field[i])
                gsub(/[* ]/, "", field[i])
                print "printf(\"  %s.%s %u\\n\", \"" name "\", \"" field[i] "\", (unsigned)offsetof(" name ", " field[i] "));"
            }
        }'
    "$@" -std=c99 -E -P include/bitvox_io.h | tr '\n' ' ' | grep -o 'enum *{[^}]*}' | grep -o 'BVX_[A-Z0-9_]*' |
        awk '!known[$0]++ { print "printf(\"" $0 " %d\\n\", (int)" $0 ");" }'
    echo 'return 0; }'
} >"$work/offsets.c"
"$@" -std=c99 -Iinclude "$work/offsets.c" -o "$work/offsets"
${RUNNER:-} "$work/offsets"
