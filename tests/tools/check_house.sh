#!/bin/sh
# check_house.sh [FOLDER] - checks of the header, the sources and the built libraries; FOLDER holds the objects that they
# were made from; without it all is built first, as make is told to by its environment. Each check counts as one test.
set -u
: "${BUILD:=build}" "${CC:=cc}" "${MAKE_COMMAND:=make}"
export BUILD CC
objects=${1:-}
if [ -z "$objects" ]; then
    "$MAKE_COMMAND" --no-print-directory all >/dev/null || exit 1
    objects=$("$MAKE_COMMAND" -s print-folder)
fi
work=$BUILD/house
rm -rf "$work"
mkdir -p "$work"
. tests/tools/counting.sh

strict='-pedantic -Wall -Wextra -Wshadow -Wconversion -Werror'
core=$(find src -name '*.c' ! -path 'src/cli_*' | LC_ALL=C sort)
core_files=$(find src -name '*.[ch]' ! -path 'src/cli_*' | LC_ALL=C sort)

needs() { # TOOL: leave the check as skipped when it is missing
    command -v "$1" >/dev/null 2>&1 && return
    echo "$1 is missing"
    exit 77
}

empty() { # FILE, WHAT ITS LINES ARE: the check holds when there are none
    [ -s "$1" ] || return 0
    sed "s|^|error: $2 |" "$1"
    return 1
}

# ---- sources ----

# The core asks for nothing but these when there is no operating system; the compiler's own helpers come from libgcc. -O0 drops no call
# that the source has, and takes a third of the time of -O1.
freestanding() { # after amalgamation, which leaves one source of all
    needs nm
    $CC -std=c99 -O0 -ffreestanding -DBVX_FREESTANDING -ffp-contract=off -fno-stack-protector -U_FORTIFY_SOURCE \
        -c "$work/one/bitvox.c" -o "$work/free-core.o" || return 1
    $CC -nostdlib -r "$work/free-core.o" -lgcc -o "$work/free.o" || return 1
    nm -u "$work/free.o" | awk '{ print $NF }' |
        grep -v -x -E 'memcpy|memset|memmove|memcmp|sqrt|floor|_GLOBAL_OFFSET_TABLE_' >"$work/wanted.txt"
    empty "$work/wanted.txt" 'the core needs'
}

# With this macro no object asks the compiler's runtime which processor it runs on.
no_cpu_detection() {
    needs nm
    for flags in '' '-mavx2 -mbmi -mbmi2 -mpopcnt'; do
        [ -z "$flags" ] || [ "$(uname -m)" = x86_64 ] || continue
        # shellcheck disable=SC2086
        $CC -std=c99 -Wall -Wextra -Werror $flags -DBVX_NO_CPU_DETECTION -Iinclude -Isrc -c src/core/cpu.c -o "$work/cpu.o" || return 1
        nm -u "$work/cpu.o" | grep cpu >"$work/cpu.txt"
        empty "$work/cpu.txt" 'without detection cpu.c needs' || return 1
    done
}

# Functions without a result that a machine could change, and without work that could fail, are named here.
plain='bvx_context_create_version bvx_context_destroy bvx_context_fault bvx_context_threads bvx_format_of_name
    bvx_grid_bound bvx_last_error bvx_last_message bvx_memory_peak bvx_memory_reset_peak bvx_memory_used bvx_next_warning
    bvx_status_text bvx_version'

every_function_proven() {
    : >"$work/unproven.txt"
    for f in $(grep -o 'bvx_[a-z0-9_]*' tests/golden/symbols.txt); do
        case " $(echo $plain) " in *" $f "*) continue ;; esac
        case $f in *_free) continue ;; esac # every use of a struct runs through them
        grep -q -w "$f" tests/fault/*.[ch] || echo "$f: no fault test" >>"$work/unproven.txt"
        grep -q -w "$f" tests/fuzz/*.[ch] || echo "$f: no fuzz target" >>"$work/unproven.txt"
        grep -q -w "$f" tests/golden/*.[ch] || echo "$f: no golden row" >>"$work/unproven.txt"
        grep -q -w "$f" tests/unit/test_calls.c tests/unit/call_table.h || [ "$f" = bvx_hash ] || [ "$f" = bvx_octree_levels ] ||
            echo "$f: not called wrongly" >>"$work/unproven.txt"
    done
    empty "$work/unproven.txt" 'unproven functions'
}

# The contents at the top of each header name its sections, in their order.
contents_of_the_header() {
    for header in include/bitvox.h include/bitvox_io.h; do
        sed -n '/^ \* Contents/,/^ \* What holds/s/^ \*     //p' $header | sed 's/  .*//' | tr ',' '\n' | sed 's/^ *//' >"$work/contents.txt"
        sed -n 's|^/\* ---- \(.*[^ -]\) -* \*/$|\1|p' $header | diff "$work/contents.txt" - && [ -s "$work/contents.txt" ] || return 1
    done
}

# Names of values come from the header's lists: no list of a source begins with the first two names of one. A name is the constant's own
# in small letters, as the Python package takes it. Texts of endings come from src/cli_shell/endings.h, and a reserved field is refused
# in one wording.
lists_stand_once() {
    awk '/^#define BVX_[A-Z]*_LIST\(X\)/ { list = $2; sub(/_LIST.*/, "", list); n = 0 }
        list != "" && list !~ /STATUS|REASON|WARN/ {
            for (line = $0; match(line, /X\(BVX_[A-Z0-9_]*, *[0-9]+, *"[^"]*"\)/); line = substr(line, RSTART + RLENGTH)) {
                name = text = substr(line, RSTART + 2, RLENGTH - 4)
                sub(/,.*/, "", name)
                sub(/^[^"]*"/, "", text)
                print ++n, name, text, list
            }
        }
        /^enum/ { list = "" }' include/bitvox*.h >"$work/lists.txt"
    awk '{ own = tolower(substr($2, length($4) + 2)); gsub(/_/, "-", own); if ($4 == "BVX_SIDE" || $4 == "BVX_REAL") { own = tolower($2); sub(/bvx_(open_)?/, "", own); gsub(/_/, "-", own) }
        if (own != $3) print "include/bitvox.h: " $2 " is called " $3 }' "$work/lists.txt" >"$work/twice.txt"
    [ "$(grep -c '^1 ' "$work/lists.txt")" -ge 20 ] || echo 'include/bitvox.h: where are its lists?' >>"$work/twice.txt"
    awk '$1 == 1 { first = $3 } $1 == 2 { print "[({] *\"" first "\", *\"" $3 "\"" }' "$work/lists.txt" >"$work/begins.txt"
    printf '%s\n' '[({] *"npy", *"binvox"' '[({] *"csl", *"csv"' >>"$work/begins.txt" # its later parts
    grep -n -E -f "$work/begins.txt" -r src bindings/python/src/bitvox --include='*.[ch]' --include='*.py' >>"$work/twice.txt"
    grep -n -F -e '.ply .obj .stl' -e '.stl .obj .ply' -e '.npy .binvox .vox .nrrd .vti .bvx' src/cli_*/*.[ch] | grep -v '^src/cli_shell/endings\.h:' >>"$work/twice.txt"
    # shellcheck disable=SC2086
    grep -n -i -E 'bvxi_fail(_for)?\(.*[a-z.]*reserved[^"]* (is|must)' $core | grep -v -E 'reserved byte|reserved2?(\[%u\])? must be 0' >>"$work/twice.txt"
    empty "$work/twice.txt" 'a list or wording by hand:'
}

words_of_the_glossary() {
    needs python3
    python3 tests/tools/check_words.py
}

options_agree() {
    needs python3
    mkdir -p "$work/options"
    python3 tests/tools/check_options.py "$work/options" "$BUILD/libbitvox.a"
}

# A result may be passed again: tests/unit/test_reuse.c has a row for every function that makes one. Handles of bvx_closest_create
# are made anew each time.
every_result_reused() {
    cat include/bitvox*.h | tr '\n' ' ' | grep -o 'BVX_API bvx_status [^;]*;' | sed 's/const [a-z_ ]*bvx_[a-z_]* \*[a-z_]*//g' |
        grep -E '[( ]bvx_(grid|mesh|attached|field|octree|sections|buffer|image|volume) \*' | grep -o 'bvx_[a-z0-9_]*(' | tr -d '(' |
        while read -r f; do grep -q "$f\b" tests/unit/test_reuse.c || echo "$f"; done >"$work/unused.txt"
    empty "$work/unused.txt" 'no row in test_reuse.c:'
}

# One rise of progress around each public function that takes a context and returns a status, but for those that report nothing.
every_function_rises() {
    # shellcheck disable=SC2086
    awk '/^bvx_status bvx_[a-z0-9_]*\(bvx_context \*/ { name = $2; sub(/\(.*/, "", name); rises = 0 }
        name != "" && /BVXI_CALL/ { rises = 1 }
        name != "" && /^}/ { if (!rises) print name; name = "" }' $core |
        grep -v -x -E 'bvx_(lattice_make|grid_create|octree_lattice|octree_neighbours|volume_data_name)' >"$work/flat.txt"
    empty "$work/flat.txt" 'without BVXI_CALL'
}

# Callers decide by statuses and reasons; messages are for people. name_input looks whether the program's own line names its input.
nobody_reads_messages() {
    grep -n -E '(strstr|strn?cmp|strn?casecmp|strr?chr|strspn|strpbrk|memcmp|sscanf)[[:space:]]*\([^;]*(message|last_error|->text|error_text)' src/cli_*/*.[ch] |
        grep -v -F 'strncmp(message, in, strlen(in))' >"$work/read.txt"
    grep -n -E "(in|==|!=) *(str|repr)\(|(in|==|!=) [a-z_.]*message\(\)|str\([a-z_]+\)\.(startswith|endswith|find|index|partition|split)|message\(\)\.(startswith|endswith|find|index|partition|split)|bvx_last_message|re\.(match|search|fullmatch)\([^)]*str\((e|error|exc|why|exception)\)" \
        -r bindings/python/src/bitvox --include='*.py' | grep -i -E 'error|exc|why|message|\(e\)' >>"$work/read.txt"
    grep -n 'bvx_last_message' src/cli_*/*.[ch] >>"$work/read.txt"
    empty "$work/read.txt" 'a message is read:'
}

# heap.c is the file named for the C library's heap, openmp.c, threads.c and processors.c for the system; the fast paths need intrinsics.
includes() {
    # shellcheck disable=SC2086
    grep -n -E '^[[:space:]]*#[[:space:]]*include[[:space:]]*<' $core_files |
        grep -v -E '<(stddef|stdint|string|stdarg|math|immintrin|arm_neon|wasm_simd128)\.h>' |
        grep -v -E '^src/core/heap\.c:[0-9]+:#include <stdlib\.h>|^src/core/(openmp|threads|processors)\.c:' \
            >"$work/includes.txt"
    empty "$work/includes.txt" 'forbidden include'
}

# One file of all sources, without warnings, and a program that uses it through its header as C++. At -O0, which takes half the time of
# -O1: one processor compiles all of it, and warnings of -O3 come from the rows that compile file by file. Indentation is theirs too: for it
# gcc reads the file anew from its first line, at each branch, which took 17 of 29 s.
amalgamation() {
    sh src/amalgamate.sh "$work/one" || return 1
    # shellcheck disable=SC2086
    $CC -std=c99 -O0 $strict -Wno-misleading-indentation -ffp-contract=off -c "$work/one/bitvox.c" -o "$work/one/bitvox.o" || return 1
    cat >"$work/one/use.c" <<'END'
#include "bitvox.h"
int main(void)
{
    bvx_context *ctx = 0;
    if (bvx_context_create(0, &ctx) != BVX_OK) return 1;
    bvx_context_destroy(ctx);
    return 0;
}
END
    $CC -std=c99 "$work/one/use.c" "$work/one/bitvox.o" -lm -o "$work/one/use" && "$work/one/use" || return 1
    if command -v g++ >/dev/null 2>&1; then
        g++ -x c++ -Wall -Wextra -Werror "$work/one/use.c" -x none "$work/one/bitvox.o" -lm -o "$work/one/use++" && "$work/one/use++"
    fi
}

# Contracted products would change results: such a build says so and does nothing. The look at the arithmetic is core's, which needs no
# other room; the same sources with the same flags but that one do their work.
contraction_is_refused() {
    grep -q -w fma /proc/cpuinfo 2>/dev/null || { echo "no processor with fused products" && exit 77; }
    for contraction in off fast; do
        $CC -std=gnu99 -O1 -fexpensive-optimizations -mfma -ffp-contract=$contraction -Iinclude -Isrc "$work/one/use.c" src/core/*.c -lm \
            -o "$work/one/contracted-$contraction" || return 1
    done
    "$work/one/contracted-off" || { echo "without contraction it is refused too" && return 1; }
    ! "$work/one/contracted-fast"
}

# Microsoft's compiler has no attributes, no builtins and no __int128; clang with its target takes those paths.
compiles_for_windows() {
    needs clang
    echo 'int main(void) { return 0; }' >"$work/none.c"
    clang --target=x86_64-pc-windows-msvc -fsyntax-only "$work/none.c" || { echo "clang knows no such target" && exit 77; }
    for target in x86_64-pc-windows-msvc i686-pc-windows-msvc aarch64-pc-windows-msvc; do
        # shellcheck disable=SC2086
        clang --target=$target -std=c99 -O2 $strict -ffp-contract=off -isystem tests/tools/msvc -fsyntax-only \
            "$work/one/bitvox.c" || return 1
    done
}

tables_as_generated() {
    needs python3
    sh tests/tools/check_tables.sh
}

# But for room.h, which tells each room's neighbours what they may use.
file_names_unique() {
    find src -name '*.[ch]' ! -name room.h | sed 's|.*/||' | sort | uniq -d >"$work/twice.txt"
    empty "$work/twice.txt" 'two files are named'
}

refuses_fast_math() {
    "$MAKE_COMMAND" BUILD="$work/fast" CFLAGS='-O2 -ffast-math' library >"$work/fast.txt" 2>&1 && return 1
    grep -q 'would change results' "$work/fast.txt" || return 1
    ! $CC -std=c99 -ffast-math -Iinclude -Isrc -c src/core/message.c -o "$work/fast.o" || return 1
    ! $CC -std=c99 -ffinite-math-only -Iinclude -Isrc -c src/core/message.c -o "$work/fast.o" || return 1
    printf '%s\n' '#include "core/context.h"' 'int main(void) { return bvxi_arithmetic_fault() == NULL; }' >"$work/fast.c"
    for part in -funsafe-math-optimizations -freciprocal-math; do # these have no macro: a look at the arithmetic tells
        $CC -std=c99 -O2 -ffp-contract=off $part -Iinclude -Isrc "$work/fast.c" src/core/exact.c -o "$work/fast-part" || return 1
        "$work/fast-part" || { echo "$part is not seen" && return 1; }
    done
}

# ---- libraries ----

static_names() {
    nm -g --defined-only "$objects/libbitvox.a" | awk 'NF == 3 && $3 !~ /^bvxi?_/ { print "error: global name " $3; bad = 1 }
        END { exit bad }'
}

no_globals() {
    needs size
    size -A "$objects/libbitvox.a" | awk '/^[^ ]*\.o / { file = $1 }
        /^\.(data|bss|tdata|tbss)/ && !/^\.data\.rel\.ro/ && $2 > 0 { print "error: " file " has " $2 " bytes in " $1; bad = 1 }
        END { exit bad }'
}

shared_name() {
    needs readelf
    readelf -d "$BUILD/libbitvox.so" | grep 'soname: \[libbitvox\.so\.[0-9.]*\]'
}

no_executable_stack() {
    needs readelf
    readelf -lW "$BUILD/libbitvox.so" | grep GNU_STACK | grep -v RWE
}

up_to_date() {
    "$MAKE_COMMAND" --no-print-directory all | grep . && return 1
    return 0
}

# The bundled meshes and clouds are what their generators write.
fixtures_as_generated() {
    for maker in make_fixture make_terrain make_volume make_cloud; do
        # shellcheck disable=SC2086
        $CC -std=c99 -O1 $strict -ffp-contract=off tests/tools/$maker.c -o "$work/$maker" -lm || return 1
    done
    "$work/make_fixture" "$work/mesh.ply" && cmp "$work/mesh.ply" fixtures/knot.ply &&
        "$work/make_terrain" before "$work/mesh.ply" && cmp "$work/mesh.ply" fixtures/terrain.ply &&
        "$work/make_terrain" after "$work/mesh.ply" && cmp "$work/mesh.ply" fixtures/terrain_quarry.ply &&
        "$work/make_volume" waves "$work/samples" && cmp "$work/samples" fixtures/waves.raw &&
        "$work/make_volume" labels "$work/samples" && cmp "$work/samples" fixtures/labels.npy &&
        "$work/make_cloud" "$work/cloud.xyz" && cmp "$work/cloud.xyz" fixtures/ball.xyz
}

sh tests/tools/abi.sh quick >"$(log_of abi)" 2>&1
add_script abi "$(log_of abi)" $?
check 'links of the pages' sh tests/tools/check_docs.sh links
check 'C examples of the pages' sh tests/tools/check_docs.sh programs
check 'commands of the pages' sh tests/tools/check_docs.sh commands
check 'figures of the pages' python3 tests/bench/page.py check docs/measured.json README.md docs/measured.md
check 'pictures of the pages' sh tests/tools/check_docs.sh pictures
check 'amalgamation' amalgamation
check 'contracted products are refused' contraction_is_refused
check 'core compiles for Windows' compiles_for_windows
check 'core is freestanding' freestanding
check 'no processor detection where it is turned off' no_cpu_detection
check 'core includes' includes
check 'sources are formatted' sh tests/tools/format.sh check
check 'rooms use what the map allows' sh tests/tools/check_rooms.sh
check 'case table is what its generator prints' tables_as_generated
check 'file names are unique' file_names_unique
check 'fixtures are what their generators write' fixtures_as_generated
check 'fast-math is refused' refuses_fast_math
check 'every function is one rise of progress' every_function_rises
check 'no caller reads messages' nobody_reads_messages
check 'every result can be passed again' every_result_reused
check 'lists stand once' lists_stand_once
check 'words of the glossary' words_of_the_glossary
check 'the contents of the header are its sections' contents_of_the_header
check 'options agree in header, library, program and package' options_agree
check 'every function has a fault test, a fuzz target and a golden row' every_function_proven
check 'global names of the static library' static_names
check 'no writable globals' no_globals
check 'soname' shared_name
check 'stack is not executable' no_executable_stack
check 'a second make does nothing' up_to_date
finish
