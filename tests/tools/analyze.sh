#!/bin/sh
# analyze.sh - cppcheck, clang's analyzer (through clang-tidy) and gcc's over src/, and the stack that each function takes.
# Called by `make analyze`. TOOLS="cppcheck clang gcc stack": these alone. Findings that are none are suppressed below, each
# with its reason. Ends with "N passed, N failed".
set -u
cd "$(dirname "$0")/../.." || exit 1
: "${BUILD:=build}" "${TOOLS:=cppcheck clang gcc stack}"
logs=$BUILD/analyze/logs
. tests/tools/counting.sh
work=$BUILD/analyze
jobs=$(getconf _NPROCESSORS_ONLN 2>/dev/null || echo 1)

# cppcheck does not follow values through a pointer that a function fills (ctuuninitvar, uninitvar, legacyUninitvar: the arrays in
# question are written before they are read, or are places for results that nobody reads), takes hexadecimal floats for whole
# numbers (incorrectLogicOperator), the room for a pointer that is stored before a block for a slip (pointerSize), a struct that
# points to a caller's local for as long as the caller waits for an escape (autoVariables), parameters named alike in other
# functions for an index and its limit (arrayIndexThenCheck), and a table's row for a number (AssignmentIntegerToAddress).
cppcheck_suppressions='ctuuninitvar uninitvar legacyUninitvar pointerSize:src/core/heap.c incorrectLogicOperator:src/field/sign_side.c
    arrayIndexThenCheck:src/mesh/collapse.c autoVariables:src/voxelize/vote.c autoVariables:src/voxelize/winding.c
    AssignmentIntegerToAddress:src/section/trace.c'

run_cppcheck() {
    command -v cppcheck >/dev/null 2>&1 || { echo "cppcheck is missing"; return 77; }
    set --
    for s in $cppcheck_suppressions; do set -- "$@" "--suppress=$s"; done
    cppcheck --std=c99 --enable=warning,performance,portability --quiet --max-configs=1 -D__GNUC__=12 -j "$jobs" --error-exitcode=1 \
        "$@" -Iinclude -Isrc src/*/*.c
}

# Left out: dead stores (the last step of a cursor counts), the insecureAPI check (wants functions of an annex that nobody has),
# and what the house does on purpose or the compiler's own warnings (-Wconversion) decide.
run_clang() {
    command -v clang-tidy >/dev/null 2>&1 || { echo "clang-tidy is missing"; return 77; }
    checks='-*,clang-analyzer-*,-clang-analyzer-deadcode.DeadStores,-clang-analyzer-security.insecureAPI.*,bugprone-*'
    for off in easily-swappable-parameters narrowing-conversions implicit-widening-of-multiplication-result reserved-identifier \
        assignment-in-if-condition branch-clone macro-parentheses; do
        checks=$checks,-bugprone-$off
    done
    printf '%s\n' src/*/*.c | xargs -P "$jobs" -n 8 sh -c \
        'checks=$1; shift; clang-tidy --quiet --warnings-as-errors="*" --checks="$checks" "$@" -- -std=c99 -Iinclude -Isrc 2>/dev/null' sh "$checks"
}

run_gcc() {
    mkdir -p "$work/gcc"
    printf '%s\n' src/*/*.c | xargs -P "$jobs" -I {} sh -c \
        'gcc -std=c99 -O1 -fanalyzer -Werror -ffp-contract=off -Iinclude -Isrc -c "$1" -o "$2/$(basename "$1").o"' sh {} "$work/gcc"
}

# Stack that a function takes; none depends on the input, and none may take more than a page. The cli is left out.
run_stack() {
    mkdir -p "$work/stack"
    printf '%s\n' $(ls src/*/*.c | grep -v '^src/cli/') | xargs -P "$jobs" -I {} sh -c \
        'gcc -std=c99 -O2 -fstack-usage -ffp-contract=off -Iinclude -Isrc -c "$1" -o "$2/$(basename "$1" .c).o"' sh {} "$work/stack" || return 1
    cat "$work"/stack/*.su | sort -t "$(printf '\t')" -k 2 -n -r >"$work/stack.txt"
    if grep 'dynamic$' "$work/stack.txt"; then # "dynamic,bounded" is a frame that is aligned
        echo "FAIL stack whose size the compiler cannot bound"
        return 1
    fi
    awk -F '\t' '$2 > 8192 { print; bad = 1 } END { exit bad }' "$work/stack.txt" || {
        echo "FAIL stack of more than 8 KiB"
        return 1
    }
    echo "most stack:"
    head -n 5 "$work/stack.txt"
}

for tool in $TOOLS; do
    check "$tool" run_$tool
    [ "$tool" != stack ] || cat "$(log_of stack)"
done
finish
