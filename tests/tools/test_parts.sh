#!/bin/sh
# test_parts.sh [TABLE] - parts of the library as one file (make amalgamation PARTS=...): each compiles alone at -O3 without a warning, a
# program that takes the address of every call that its header declares links, and nothing that the linker would not take is in it.
# TABLE: write the sizes there, as docs/c.md has them. Called by `make packaging`. Ends with "N passed, N failed[, N skipped]".
set -u
cd "$(dirname "$0")/../.." || exit 1
: "${BUILD:=build}" "${CC:=cc}"
work=$BUILD/parts-test
rm -rf "$work"
mkdir -p "$work"
logs=$work/logs
. tests/tools/counting.sh

table=${1:-$work/sizes.md}
printf '%s\n' '| PARTS | calls | lines | object, KiB |' '|---|--:|--:|--:|' >"$table"

part() { # PARTS, empty: the whole library
    folder=$work/$(echo "${1:-all}" | tr ' ' '-')
    sh src/amalgamate.sh "$folder" "$1" || return 1
    $CC -std=c99 -O3 -Wall -Wextra -Wshadow -Werror -ffp-contract=off -pthread -c "$folder/bitvox.c" -o "$folder/bitvox.o" || return 1

    # All calls of the header, so that one which is declared and not there is found.
    cat "$folder/bitvox.h" "$folder/bitvox_io.h" | sed 's|/\*.*\*/||' | grep -o '^BVX_API [^(]*' | sed 's/.*[ *]//' | LC_ALL=C sort >"$folder/calls"
    {
        printf '#include "bitvox_io.h"\n#include <stdio.h>\ntypedef void call(void);\nint main(void)\n{\n    call *const calls[] = {\n'
        sed 's/.*/        (call *)&,/' "$folder/calls"
        printf '    };\n    size_t n = 0;\n    while (n < sizeof calls / sizeof *calls && calls[n]) n++;\n    printf("%%u\\n", (unsigned)n);\n    return 0;\n}\n'
    } >"$folder/use.c"
    $CC -std=c99 -Wall -Werror "$folder/use.c" "$folder/bitvox.o" -pthread -lm -o "$folder/use" || return 1
    [ "$("$folder/use")" = "$(wc -l <"$folder/calls")" ] || return 1

    # The header declares what the object defines, neither more nor less.
    nm -g --defined-only "$folder/bitvox.o" | awk '$3 ~ /^bvx_/ { print $3 }' | LC_ALL=C sort | diff "$folder/calls" - || return 1
    size "$folder/bitvox.o" | awk -v name="${1:-all of it}" -v calls="$(wc -l <"$folder/calls")" -v lines="$(wc -l <"$folder/bitvox.c")" \
        'NR == 2 { printf "| %s | %d | %d | %.0f |\n", name, calls, lines, $1 / 1024 }' >>"$table"
}

# The same tetrahedron as elsewhere, by a part alone.
counts_voxels() {
    $CC -std=c99 -I"$work/solid" tests/tools/consumer.c "$work/solid/bitvox.o" -pthread -lm -o "$work/solid/consumer" &&
        [ "$("$work/solid/consumer")" = 43680 ]
}

refuses_unknown() {
    sh src/amalgamate.sh "$work/none" 'solid castle' && return 1
    [ ! -e "$work/none/bitvox.c" ]
}

# Static calls: one file with the user's own code around it. What is declared and not defined would be a warning.
static_calls() {
    mkdir -p "$work/static"
    { echo '#define BVX_STATIC_API'; echo "#include \"../solid/bitvox.c\""; grep -v '#include <bitvox.h>' tests/tools/consumer.c; } >"$work/static/use.c"
    $CC -std=c99 -O1 -Wall -Wextra -Wno-unused-function -Werror -ffp-contract=off -pthread "$work/static/use.c" -lm -o "$work/static/use" &&
        [ "$("$work/static/use")" = 43680 ]
}

for parts in solid extract_surface 'solid surface levels' lods simplify repair boolean morph distance field refine sections 'read_mesh write_mesh' \
    'render_mesh write_png' ''; do
    check "part: ${parts:-all of it}" part "$parts"
done
check 'a program with the solids alone' counts_voxels
check 'a program with static calls' static_calls
check 'a part that is none is refused' refuses_unknown
finish
