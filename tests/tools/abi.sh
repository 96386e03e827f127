#!/bin/sh
# abi.sh quick|full|rewrite - the public interface as compilers, linkers and other machines see it. The last line counts.
#     quick    the header by itself as C99 and C++11; the exported symbols, sizes, offsets and constants are those stored
#     full     quick, and: the header as every C and C++ that is known here, sizes and offsets on other machines, and the
#              types of all functions against tests/golden/bitvox.abi (abidw and abidiff). New functions and fields behind
#              the end of option structs are additions: they are shown. Anything else is a change, which fails.
#     rewrite  tests/golden/bitvox.abi anew, at a release; before the first one, when the interface changes on purpose
# Called by `make abi` (REWRITE=1) and check_house.sh; `make golden` rewrites the lists of symbols and offsets.
set -u
cd "$(dirname "$0")/../.." || exit 1
: "${BUILD:=build}" "${CC:=cc}"
work=$BUILD/abi
mkdir -p "$work"
. tests/tools/counting.sh

strict='-pedantic -Wall -Wextra -Wshadow -Wconversion -Werror'
stored=tests/golden/bitvox.abi

needs() { # TOOL, PACKAGE: leave the check as skipped when it is missing
    command -v "$1" >/dev/null 2>&1 && return
    echo "$1 is missing${2:+ (Debian: $2)}"
    exit 77
}

header_as() { # COMPILER, FLAGS...
    needs "$1"
    echo 'int known;' >"$work/known.c"
    "$@" -c "$work/known.c" -o "$work/alone.o" 2>/dev/null || { echo "this compiler does not know it" && exit 77; }
    echo '#include "bitvox_io.h"' >"$work/alone.c"
    # shellcheck disable=SC2086
    "$@" $strict -Iinclude -c "$work/alone.c" -o "$work/alone.o"
}

# Every function that the header declares is exported, and nothing else is.
exports_the_header() {
    cat include/bitvox*.h | tr '\n' ' ' | grep -o 'BVX_API [^(;]*(' | grep -o 'bvx_[a-z0-9_]*($' | tr -d '(' |
        LC_ALL=C sort -u >"$work/declared.txt"
    [ -s "$work/declared.txt" ] || return 1
    sh tests/tools/list_symbols.sh "$BUILD/libbitvox.so" | diff -u "$work/declared.txt" -
}

only_stored_symbols() {
    sh tests/tools/list_symbols.sh "$BUILD/libbitvox.so" | diff -u tests/golden/symbols.txt -
}

offsets_here() {
    [ "$(getconf LONG_BIT 2>/dev/null)" = 64 ] || { echo "the stored offsets are those of 64-bit machines" && exit 77; }
    # shellcheck disable=SC2086
    sh tests/tools/struct_offsets.sh $CC | diff -u tests/golden/offsets.txt -
}

# RUNNER runs what the compiler makes.
offsets_there() { # STORED, RUNNER, COMPILER
    needs "$3" "gcc-${3%-gcc}"
    [ -z "$2" ] || needs "$2" qemu-user
    RUNNER=$2 sh tests/tools/struct_offsets.sh "$3" -static | diff -u "tests/golden/$1" -
}

# What libabigail sees of the interface: the whole library as one unit without optimisation, its private types left out. No
# paths, no places in the sources, no names of parameters, so that every checkout gives the same.
dump() { # FILE
    needs abidw abigail-tools
    sh src/amalgamate.sh "$work" >/dev/null || return 1
    # shellcheck disable=SC2086
    (cd "$work" && $CC -std=c99 -g -O0 -ffp-contract=off -fPIC -fvisibility=hidden -shared bitvox.c -lm -o interface.so) || return 1
    (cd "$work" && abidw --no-corpus-path --no-comp-dir-path --no-show-locs --no-elf-needed --no-parameter-names \
        --type-id-style hash --header-file bitvox.h --header-file bitvox_io.h --drop-private-types --out-file interface.abi interface.so) || return 1
    mv "$work/interface.abi" "$1"
}

# The lines of abidiff that tell of more than an addition. A field behind the end of an option struct is one: struct_size
# says which fields a caller knows.
changes_of() { # REPORT
    awk '
        /^$/ || /^(Leaf changes|Changed leaf types) summary/ || /summary: 0 Removed, 0 Changed, / { next }
        /^.struct bvx_[a-z_]*_options. changed:$/ { options = 1; next }
        /^[^ ]/ { options = 0 }
        options && /^  type size changed from [0-9]* to [0-9]* / { old = $5; grown = $7 > $5; next }
        options && grown && /^  [0-9]* data member insertions?:$/ { next }
        options && grown && /^    .*, at offset [0-9]* \(in bits\)/ { at = $0; sub(/.*at offset /, "", at); if (at + 0 >= old + 0) next }
        { print }' "$1"
}

types_as_stored() {
    needs abidiff abigail-tools
    rm -f "$work/same"
    dump "$work/now.abi" || return 1
    abidiff --no-added-syms --leaf-changes-only "$stored" "$work/now.abi" >"$work/leaves.txt" 2>&1
    status=$?
    # 1 and 2: abidiff itself failed; 4: something differs; 8: and an old program cannot work
    if [ $((status & 3)) != 0 ]; then cat "$work/leaves.txt" && return 1; fi
    changes_of "$work/leaves.txt" >"$work/changes.txt"
    if [ -s "$work/changes.txt" ] || [ $((status & 8)) != 0 ]; then
        grep . "$work/leaves.txt" | sed 's/^/error: /'
        return 1
    fi
    touch "$work/same"
}

additions() {
    [ -f "$work/same" ] || return 0
    abidiff --leaf-changes-only "$stored" "$work/now.abi" 2>&1 | grep -E "^ *\[A\]|^.struct |^    '" | sed 's/^/note  added: /'
}

# shellcheck disable=SC2086
quick() {
    check 'header alone as C99' header_as $CC -std=c99
    check 'header alone as C99 by clang' header_as clang -std=c99
    check 'header alone as C++11' header_as g++ -std=c++11 -x c++
    check 'header alone as C++11 by clang' header_as clang++ -std=c++11 -x c++
    check 'functions of the header are exported' exports_the_header
    check 'exported symbols as stored' only_stored_symbols
    check 'struct offsets and constants as stored' offsets_here
}

case ${1:-full} in
quick) quick ;;
full)
    needs abidw abigail-tools
    quick
    for standard in c99 c11 c17 c2x; do
        for cc in gcc clang; do check "header as $standard by $cc" header_as $cc -std=$standard -Wc++-compat; done
    done
    for standard in c++11 c++14 c++17 c++20 c++2b; do
        for cxx in g++ clang++; do
            check "header as $standard by $cxx" header_as $cxx -std=$standard -x c++ -Wzero-as-null-pointer-constant
        done
    done
    check 'offsets on 32-bit x86' offsets_there offsets_i686.txt qemu-i386 i686-linux-gnu-gcc
    check 'offsets on 32-bit ARM' offsets_there offsets_armhf.txt qemu-arm arm-linux-gnueabihf-gcc
    check 'offsets on s390x' offsets_there offsets.txt qemu-s390x s390x-linux-gnu-gcc
    check 'offsets on 64-bit ARM' offsets_there offsets.txt qemu-aarch64 aarch64-linux-gnu-gcc
    check 'types of all functions as stored' types_as_stored
    additions
    ;;
rewrite)
    dump "$work/now.abi" || exit
    if [ -f $stored ]; then abidiff $stored "$work/now.abi"; fi
    cp "$work/now.abi" $stored
    exit
    ;;
*)
    echo "abi: no part named $1" >&2
    exit 2
    ;;
esac
finish
