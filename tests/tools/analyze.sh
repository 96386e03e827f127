#!/bin/sh
# analyze.sh - cppcheck, clang-tidy, clang's and gcc's analyzers over src/, and the stack that each function takes.
# Called by `make analyze`. TOOLS="cppcheck tidy clang gcc stack": these alone. What they report and is none is listed below,
# each with its reason. Ends with "N passed, N failed".
set -u
cd "$(dirname "$0")/../.." || exit 1
: "${BUILD:=build}" "${TOOLS:=cppcheck tidy clang gcc stack}"
logs=$BUILD/analyze/logs
. tests/tools/counting.sh
work=$BUILD/analyze
: "${JOBS:=$(getconf _NPROCESSORS_ONLN 2>/dev/null || echo 1)}"
jobs=$JOBS
mkdir -p "$work"

# Reports that are none: TOOL CHECK FILE REASON. cppcheck does not follow values through pointers that a function fills. The two
# analyzers follow one file and not what holds between numbers; what holds across files they are told in analyze_model.h.
cat >"$work/known.txt" <<'END'
cppcheck AssignmentIntegerToAddress src/layers/fill_loop.c an entry of the table is a row of two, which is an address
cppcheck arrayIndexThenCheck src/simplify/corners.c two vertices are compared, not an index and its limit
cppcheck ctuuninitvar src/nearest/closest.c a place for the result, set before it is read
cppcheck ctuuninitvar src/nearest/closest_build.c a place for the tree, cleared first
cppcheck ctuuninitvar src/touch/sampled.c the triangle's sides are set in the loop above
cppcheck incorrectLogicOperator src/field/sign_normal.c hexadecimal floats are taken for whole numbers
cppcheck legacyUninitvar src/grid/sample.c a place for gradients that nobody reads
cppcheck pointerSize src/core/heap.c the pointer itself is stored in front of the block
cppcheck uninitvar src/contours/distance2d.c what lies below the top was put there
cppcheck uninitvar src/layers/fill_loop.c shorter pieces of the loop are in the table before longer ones ask for them
cppcheck uninitvar src/surface/sharp_cells.c the first corner sets both ends before the others are compared with them
tidy bugprone-integer-division src/refine/children.c the division is an index
tidy bugprone-not-null-terminated-result src/cli_inputs/inputs.c the name's end is copied with its zero
tidy bugprone-not-null-terminated-result src/io/png.c bytes of a file, no text
tidy bugprone-not-null-terminated-result src/io_mesh/write_glb.c bytes of a file, no text
tidy bugprone-not-null-terminated-result src/io_grid/vox.c bytes of a file, no text
tidy bugprone-signed-char-misuse src/io_mesh/ply.c a small number, no character
clang core.BitwiseShift src/mesh/orient.c no exponent lies below the lowest of its axis
clang core.BitwiseShift src/surface/cells.h at least one word is looked at
clang core.BitwiseShift src/surface/face_rectangles.c a word is asked for only where the run meets it
clang core.UndefinedBinaryOperatorResult src/layers/fill_loop.c shorter pieces of the loop are in the table before longer ones ask for them
clang core.CallAndMessage src/layers/section_field.c a place without an ending part has depth 0, which is looked at first
clang core.UndefinedBinaryOperatorResult src/layers/section_field.c as above
clang core.uninitialized.Assign src/layers/section_field.c as above
clang core.UndefinedBinaryOperatorResult src/surface/cell_loops.c the corners of a triangle are three that were just set
clang core.UndefinedBinaryOperatorResult src/surface/edge_cut.c an end without a triangle has a normal of size 0, which is looked at first
clang core.UndefinedBinaryOperatorResult src/winding/sheet.c what is summed round a point is set wherever reach is above 0, and looked at only there
clang core.NullDereference src/winding/sheet_lanes_body.h edges and triangles are kept only where reach is above 0, which goes with a place to look
clang core.uninitialized.Assign src/winding/sheet.c as above
clang unix.Errno src/cli_inputs/files.c a size that cannot be told is 0 and no failure; errno is set to 0 before each read
clang unix.Stream src/cli_inputs/files.c a last read of nothing ends the loop
clang core.BitwiseShift src/refine/expand.c no node of the last level is entered, so none has a level below it
clang core.DivideZero src/io_grid/read_volume.c the kind of samples is one of those that have a size
clang core.NullDereference src/nearest/nearest_fill.c where nothing is remembered all slots are unknown
clang core.NullDereference src/grid/coverage.c a part of the grid that has rows has words
clang core.NullDereference src/morphology/transform.c the places are there when the nearest are asked for, which a callee does not change
clang core.NullDereference src/io_grid/read_bvx.c runs are unpacked after all of them were checked; a NULL was refused there
clang core.UndefinedBinaryOperatorResult src/grid/coverage.c no word behind the row's last is taken
clang core.uninitialized.Assign src/mesh/view.c a block has a vertex at least, so three lanes
gcc -Wanalyzer-null-dereference src/io_grid/read_bvx.c runs are unpacked after all of them were checked; a NULL was refused there
gcc -Wanalyzer-null-dereference src/winding/sheet_lanes_body.h edges are kept only where reach is above 0, which goes with a place to look
END

# Reports as FILE:LINE:COLUMN: warning: TEXT [CHECK], without those that are known. A known one that is not reported is named: it
# should go, but is no failure, as versions of the tools differ.
judge() { # TOOL LOG
    awk -v tool="$1" -v here="$PWD/" '
        FILENAME ~ /known\.txt$/ { if ($1 == tool) known[$2 " " $3] = 1; next }
        / (warning|error): / && !seen[$0]++ {
            if (index($0, here) == 1) $0 = substr($0, length(here) + 1)
            file = $0; sub(/:.*/, "", file); sub(/^\.\//, "", file)
            check = $0; sub(/.*\[/, "", check); sub(/\].*/, "", check); sub(/,.*/, "", check)
            if ((check " " file) in known) { hidden[check " " file] = 1; next }
            print; bad = 1
        }
        END {
            for (k in hidden) n++
            print n + 0 " known reports are none"
            for (k in known) if (!(k in hidden)) print "note: known, but not reported: " k
            exit bad
        }' "$work/known.txt" "$2"
}

run_cppcheck() {
    command -v cppcheck >/dev/null 2>&1 || { echo "cppcheck is missing"; return 77; }
    cppcheck --std=c99 --enable=warning,performance,portability --quiet --max-configs=1 -D__GNUC__=12 -j "$jobs" \
        --template='{file}:{line}:{column}: warning: {message} [{id}]' -Iinclude -Isrc src/*/*.c >"$work/cppcheck.txt" 2>&1
    judge cppcheck "$work/cppcheck.txt"
}

# Left out: what the house does on purpose or the compiler's own warnings (-Wconversion) decide.
run_tidy() {
    command -v clang-tidy >/dev/null 2>&1 || { echo "clang-tidy is missing"; return 77; }
    checks='-*,bugprone-*'
    for off in easily-swappable-parameters narrowing-conversions implicit-widening-of-multiplication-result reserved-identifier \
        assignment-in-if-condition branch-clone macro-parentheses; do
        checks=$checks,-bugprone-$off
    done
    printf '%s\n' src/*/*.c | xargs -P "$jobs" -n 8 sh -c \
        'checks=$1; shift; clang-tidy --quiet --checks="$checks" "$@" -- -std=c99 -Iinclude -Isrc 2>/dev/null' sh "$checks" >"$work/tidy.txt"
    judge tidy "$work/tidy.txt"
}

# Every source with the model: COMMAND... at file. Left to the caller: how the reports are written.
each_source() { # COMMAND...
    printf '%s\n' src/*/*.c | xargs -P "$jobs" -I {} sh -c \
        'file=$1; shift; room=${file%/*}; name=${file##*/}
        "$@" -std=c99 -ffp-contract=off -Iinclude -Isrc "-DIN_${room##*/}" "-DANALYZED_${name%.c}" -include tests/tools/analyze_model.h -c "$file" 2>&1' \
        sh {} "$@"
}

# Left out: dead stores (the last step of a cursor counts). Failures are told through several calls, so it looks deeper.
run_clang() {
    clang=
    for c in clang-19 clang; do command -v $c >/dev/null 2>&1 && clang=${clang:-$c}; done
    [ -n "$clang" ] || { echo "clang is missing"; return 77; }
    each_source $clang --analyze --analyzer-output text -Xclang -analyzer-inline-max-stack-depth -Xclang 8 \
        -Xclang -analyzer-disable-checker -Xclang deadcode.DeadStores >"$work/clang.txt"
    judge clang "$work/clang.txt"
}

# Left out: uninitialized values. Of an array that a loop fills, gcc 12 knows the first element alone; clang knows better.
run_gcc() {
    command -v gcc >/dev/null 2>&1 || { echo "gcc is missing"; return 77; }
    each_source gcc -O1 -fanalyzer -Wno-analyzer-use-of-uninitialized-value -o /dev/null >"$work/gcc.txt"
    judge gcc "$work/gcc.txt"
}

# Stack that functions take; none depends on the input. A frame of more than 8 KiB stands here with its limit, and
# what it holds; each thread needs one of its own, and none of them can fail. The deepest chain of calls must leave 48 KiB of
# the 128 KiB that threads of musl have to callbacks and the thread itself. The cli is left out.
stack_limits='
    touch_all_avx2        24576 a batch of triangles and what is known of each, in the nearest caches
    touch_all_portable    24576 the same
    touch_start_tile      24576 a batch of triangles
    mark_by_lists         24576 a batch of triangles
    walk_tile             24576 a tile of samples that is turned
    bvxi_sheet_block      16384 bricks that wait, and what is known of the sheet round four of them
    bvxi_read_stl         16384 triangles that wait for one look into the table of vertices
    sort_near_along_curve 16384 counts of three digits of a sort
    bvxi_touch_sampled    12288 a batch of triangles
    bvxi_touch_thin       12288 a batch of triangles
    judge_neighbours      12288 neighbours of a star and the boxes of its triangles
    bvxi_radix_sort       12288 counts of eight digits of a sort
'
stack_deepest=81920

run_stack() {
    command -v gcc >/dev/null 2>&1 || { echo "gcc is missing"; return 77; }
    rm -rf "$work/stack"
    mkdir -p "$work/stack"
    printf '%s\n' src/*/*.c | grep -v '^src/cli_' | xargs -P "$jobs" -I {} sh -c \
        'gcc -std=c99 -O2 -fstack-usage -fcallgraph-info=su -ffp-contract=off -Iinclude -Isrc -c "$1" -o "$2/$(basename "$1" .c).o"' sh {} "$work/stack" || return 1
    cat "$work"/stack/*.su | sort -t "$(printf '\t')" -k 2 -n -r >"$work/stack.txt"
    if grep 'dynamic$' "$work/stack.txt"; then # "dynamic,bounded" is a frame that is aligned
        echo "FAIL stack whose size the compiler cannot bound"
        return 1
    fi
    printf '%s\n' "$stack_limits" >"$work/limits.txt"
    awk '
        NR == FNR { if (NF) { limit[$1] = $2; why = $0; sub(/^ *[^ ]+ +[^ ]+ +/, "", why); reason[$1] = why } next }
        {
            split($1, part, ":"); name = part[4]; room = name in limit ? limit[name] : 8192
            if ($2 > 8192) printf "%6d bytes  %s (limit %d): %s\n", $2, name, room, name in reason ? reason[name] : "not listed"
            if ($2 > room) { print "FAIL " $0; bad = 1 }
        }
        END { exit bad }' "$work/limits.txt" "$work/stack.txt" || return 1
    awk -F '\t' '$2 <= 8192' "$work/stack.txt" | head -n 1 | awk '{ print "all others at most " $2 " bytes; every function: '"$work/stack.txt"'" }'
    command -v python3 >/dev/null 2>&1 || { echo "python3 is missing: chains are not summed"; return 0; }
    python3 tests/tools/stack_chains.py "$stack_deepest" "$work"/stack/*.ci
}

for tool in $TOOLS; do
    count_spent
    before=$spent
    check "$tool" run_$tool
    count_spent
    case $tool in
    stack) cat "$(log_of stack)" ;;
    *) grep '^note: ' "$(log_of "$tool")" ;;
    esac
    echo "$tool $spent $before" | awk '{ printf "      %s took %.0f s of processor time\n", $1, $2 - $3 }'
done
finish
