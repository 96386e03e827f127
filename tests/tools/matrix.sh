#!/bin/sh
# matrix.sh - recompute the golden values by every compiler, flag, processor and system that is here, and compare their tables.
# Called by `make matrix`, which hands over MAKE_COMMAND, BUILD and
#     MATRIX=row,row   only these rows (names as printed)
#     DEPS=1           install the compilers and emulators first (make deps-proof)
# Every row builds the golden program with its settings and runs it; the hash is of the whole table that it printed. The
# report goes to build/matrix/report.md, with the processor time that the golden program took; rows that are asked for one
# after another gather there for as long as the sources stay the same, and all of them must have one table. A row whose tools
# are missing is skipped and says so. The last line counts.
#
# The golden values are compared in three tiers; minutes are processor time on one x86-64 machine, most of it for compiling.
#     make test        this compiler: by default, by one thread and the portable code, by eight threads; 10 s beside the tests
#     make test-other  gcc at -O0 and -O3, clang, 32-bit x86, big-endian s390x under an emulator; 4 minutes beside the tests
#     make matrix      every row below; 25 to 30 minutes, of which the emulators take ten
set -u
cd "$(dirname "$0")/../.." || exit 1
: "${BUILD:=build}" "${MAKE_COMMAND:=make}"
unset MAKEFLAGS MFLAGS MAKELEVEL MAKEOVERRIDES CC CFLAGS CPPFLAGS LDFLAGS
jobs=$(getconf _NPROCESSORS_ONLN 2>/dev/null || echo 1)
matrix=$BUILD/matrix
logs=$matrix/logs
TEST_SECONDS=${TEST_SECONDS:-1200}
. tests/tools/counting.sh

if [ -n "${DEPS:-}" ]; then sh tests/tools/deps.sh proof; fi

report=$matrix/report.md
sources=$(cat include/*.h src/*/*.[ch] tests/golden/*.[ch] tests/tools/*.h Makefile | cksum | cut -d ' ' -f 1)
if [ "$(head -n 1 "$report" 2>/dev/null)" != "Sources with the checksum $sources:" ]; then
    printf '%s\n' "Sources with the checksum $sources:" '' '| row | compiler | flags | golden rows | table | seconds |' \
        '|---|---|---|--:|---|--:|' >"$report"
fi

# Is this row asked for?
known_rows=,
asked() { # NAME
    known_rows=$known_rows$1,
    case ",${MATRIX:-$1}," in *",$1,"*) return 0 ;; esac
    return 1
}

# Run a built golden program and keep what it says of itself.
table_of() { # NAME, COMPILER, FLAGS, COMMAND...
    row_name=$1 row_compiler=$2 row_flags=$3
    shift 3
    row_log=$(log_of "run-$row_name")
    row_start=$(date +%s)
    count_spent
    row_before=$spent
    $limit "$@" --print >"$row_log" 2>&1 </dev/null
    row_status=$?
    count_spent
    row_seconds=$(($(date +%s) - row_start))
    if [ $row_status = 77 ]; then
        skip "$row_name" "$(tail -n 1 "$row_log")"
        return
    fi
    add_counts "$row_name" "$row_log" $row_status $row_seconds
    row_hash=$(tr -d '\r' <"$row_log" | grep '^= ' | cksum | cut -d ' ' -f 1)
    row_count=$(tr -d '\r' <"$row_log" | sed -n 's/^\([0-9]*\) passed, \([0-9]*\) failed.*/\1 of \1+\2/p' | sed 's/+0$//')
    row_spent=$(echo "$spent $row_before" | awk '{ printf "%.0f", $1 - $2 }')
    awk -F ' [|] ' -v name="| $row_name" '$1 != name' "$report" >"$report.new"
    echo "| $row_name | $row_compiler | $row_flags | ${row_count:-none} | $row_hash | $row_spent |" >>"$report.new"
    mv "$report.new" "$report"
}

# One build; RUNNER and the arguments behind -- go to the golden program.
row() { # NAME, RUNNER, MAKE SETTINGS..., [-- ARGUMENTS OF GOLDEN...]
    name=$1 runner=$2
    shift 2
    compiler=cc cflags=-O3 suffix=
    settings=$matrix/settings
    : >"$settings"
    while [ $# -gt 0 ] && [ "$1" != -- ]; do
        case $1 in
        CC=*) compiler=${1#CC=} ;;
        CFLAGS=*) cflags=${1#CFLAGS=} ;;
        SUFFIX=*)
            suffix=${1#SUFFIX=}
            shift
            continue
            ;;
        esac
        printf '%s\n' "$1" >>"$settings"
        shift
    done
    [ $# = 0 ] || shift
    asked "$name" || return 0
    for tool in ${compiler%% *} $runner; do
        case $tool in -*) continue ;; esac
        if ! command -v "$tool" >/dev/null 2>&1; then
            skip "$name" "$tool is missing"
            return 0
        fi
    done
    make_row() {
        set --
        while IFS= read -r setting; do set -- "$@" "$setting"; done <"$settings"
        "$MAKE_COMMAND" --no-print-directory -j "$jobs" "$@" $goal
    }
    goal=golden-program
    if ! make_row >"$(log_of "build-$name")" 2>&1 </dev/null; then
        fail "$name: does not build" "$(log_of "build-$name")"
        return 0
    fi
    goal=print-folder
    folder=$(make_row)
    version=$(${compiler} --version 2>/dev/null | head -n 1 | sed 's/ *([^)]*)//g')
    table_of "$name" "$version" "$cflags${*:+, golden $*}" $runner "$folder/tests/golden/golden$suffix" "$@"
}

static='LDFLAGS=-static'
bare='THREADS=0 ZLIB=0 WERROR=1'

# This machine: compilers, levels of optimisation, threads.
# A distribution's own -std would lose against the house's; there the house's is taken away.
for cc in gcc clang; do
    row $cc-O0 '' CC=$cc CFLAGS=-O0 WERROR=1
    row $cc-O2 '' CC=$cc CFLAGS=-O2 WERROR=1
    row $cc-O3 '' CC=$cc CFLAGS=-O3 WERROR=1
    row $cc-native '' CC=$cc 'CFLAGS=-O3 -march=native'
    row $cc-distribution '' CC=$cc strict=-std=gnu17 \
        'CFLAGS=-g -O2 -std=gnu17 -fstack-protector-strong -Wformat -Werror=format-security -Wdate-time -D_FORTIFY_SOURCE=2'
done
row gcc-Og '' CC=gcc CFLAGS=-Og WERROR=1
row gcc-Os '' CC=gcc CFLAGS=-Os WERROR=1
row clang-19-O3 '' CC=clang-19 CFLAGS=-O3 WERROR=1
row clang-19-native '' CC=clang-19 'CFLAGS=-O3 -march=native'
for threads in 1 2 3 8; do row threads-$threads '' CC=gcc CFLAGS=-O3 WERROR=1 -- --threads $threads; done

# There are two sets of kernels, chosen at run time: each is forced. Those written for vectors (src/core/simd.h) run as arrays in the
# row arrays, where the portable set has vectors of SSE2; aarch64 has NEON, and arrays too. The last row has no word of a compiler's own (builtins,
# attributes), as for a compiler that is none of GNU's kind; the headers of musl bear that.
row portable '' CC=gcc CFLAGS=-O3 WERROR=1 -- --portable
row avx2 '' CC=gcc CFLAGS=-O3 WERROR=1 -- --avx2
row arrays '' CC=gcc 'CFLAGS=-O3 -DBVX_SIMD_ARRAYS' WERROR=1 -- --portable
row flushed-avx2 '' CC=gcc CFLAGS=-O3 WERROR=1 -- --flush --threads 1 --avx2
row flushed-portable '' CC=clang CFLAGS=-O3 WERROR=1 -- --flush --threads 1 --portable
row plain-c '' CC=musl-gcc 'CFLAGS=-O2 -U__GNUC__' $static THREADS=0 ZLIB=0
row musl '' CC=musl-gcc CFLAGS=-O2 $static $bare

# Other processors, statically linked, under emulators; 32-bit x86 runs by itself on most x86 machines.
row i686 '' CC=i686-linux-gnu-gcc AR=i686-linux-gnu-ar CFLAGS=-O2 $static $bare
row i686-flushed '' CC=i686-linux-gnu-gcc AR=i686-linux-gnu-ar CFLAGS=-O2 $static $bare -- --flush
row clang-i686 '' 'CC=clang --target=i686-linux-gnu' CFLAGS=-O2 $static $bare
row clang-aarch64 qemu-aarch64 'CC=clang --target=aarch64-linux-gnu' CFLAGS=-O2 $static $bare
row aarch64 qemu-aarch64 CC=aarch64-linux-gnu-gcc AR=aarch64-linux-gnu-ar CFLAGS=-O2 $static $bare
row aarch64-O3 qemu-aarch64 CC=aarch64-linux-gnu-gcc AR=aarch64-linux-gnu-ar CFLAGS=-O3 $static $bare -- --flush
row aarch64-arrays qemu-aarch64 CC=aarch64-linux-gnu-gcc AR=aarch64-linux-gnu-ar 'CFLAGS=-O2 -DBVX_SIMD_ARRAYS' $static $bare
row armhf qemu-arm CC=arm-linux-gnueabihf-gcc AR=arm-linux-gnueabihf-ar CFLAGS=-O2 $static $bare
row riscv64 qemu-riscv64 CC=riscv64-linux-gnu-gcc AR=riscv64-linux-gnu-ar CFLAGS=-O2 $static $bare
row ppc64el qemu-ppc64le CC=powerpc64le-linux-gnu-gcc AR=powerpc64le-linux-gnu-ar CFLAGS=-O2 $static $bare
row s390x qemu-s390x CC=s390x-linux-gnu-gcc AR=s390x-linux-gnu-ar CFLAGS=-O2 $static $bare

# Other systems.
export WINEDEBUG=-all WINEPREFIX="${WINEPREFIX:-$(cd "$matrix" && pwd)/wine}"
row windows wine CC=x86_64-w64-mingw32-gcc AR=x86_64-w64-mingw32-ar CFLAGS=-O2 $static $bare SUFFIX=.exe
for simd in '' -msimd128; do
    row wasm${simd:+-simd} node CC=emcc AR=emar "CFLAGS=-O2 $simd" 'LDFLAGS=-O1 -sNODERAWFS=1 -sSINGLE_FILE=1 -sALLOW_MEMORY_GROWTH=1' \
        THREADS=0 ZLIB=0
done

# No system at all; its table is one line, which bare.sh compares with the stored one.
if asked cortex-m3; then check cortex-m3 sh tests/tools/bare.sh; fi

for name in $(echo "${MATRIX:-}" | tr ',' ' '); do
    case $known_rows in *",$name,"*) ;; *) fail "no row is named $name" ;; esac
done
hashes=$(awk -F ' [|] ' 'NR > 4 { print $5 }' "$report")
rows=$(echo "$hashes" | grep -c .)
different=$(echo "$hashes" | sort -u | grep -c .)
if [ "$different" -gt 1 ]; then
    fail "$different different tables of $rows rows, see $report"
elif [ "$different" = 1 ]; then
    pass "one table: $(echo "$hashes" | head -n 1) of $rows rows"
fi
count_spent
echo "report: $report; $(echo "$spent" | awk '{ printf "%.0f", $1 }') s of processor time"
finish
