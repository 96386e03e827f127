#!/bin/sh
# fuzz.sh - run the fuzz targets with coverage guidance (clang's libFuzzer) under ASan and UBSan. Called by `make fuzz`:
#     SECONDS_EACH=60      seconds a target [60]
#     TARGETS="stl solids" these alone: formats of readers, and names of the other sources without fuzz_ and .c
#     JOBS=2               so many at once [1]
#     KEEP=1               put what was found and matters into fixtures/fuzz: some 100 inputs or 10000 bytes a target
# A reader has a target for each of its formats. The corpus in fixtures/fuzz/TARGET is read, new inputs go to
# build/fuzz/TARGET/corpus. What breaks a contract is left in build/fuzz/TARGET; the report goes to build/fuzz/report.md. Ends with
# status 1 when something was found, 77 when something is missing.
set -u
cd "$(dirname "$0")/../.." || exit 1
: "${BUILD:=build}" "${MAKE_COMMAND:=make}" "${SECONDS_EACH:=60}" "${JOBS:=1}"
unset MAKEFLAGS MFLAGS MAKELEVEL MAKEOVERRIDES CC CFLAGS LDFLAGS
. tests/tools/fuzz_targets.sh
out=$BUILD/fuzz
mkdir -p "$out"
sanitize=address,undefined,float-cast-overflow
flags="-O1 -g -fno-omit-frame-pointer -fsanitize=fuzzer-no-link,$sanitize -fno-sanitize-recover=all"

# ---- what must be there ----

if ! command -v clang >/dev/null 2>&1; then
    echo "clang is missing (Debian: clang)"
    exit 77
fi
echo 'int LLVMFuzzerTestOneInput(const unsigned char *data, unsigned long size) { return data[0] == size && 0; }' >"$out/probe.c"
if ! clang -fsanitize=fuzzer,$sanitize "$out/probe.c" -o "$out/probe" >"$out/build.log" 2>&1; then
    echo "clang links no fuzz targets; libFuzzer or the sanitizers are missing (Debian: libclang-rt-$(clang -dumpversion | cut -d . -f 1)-dev)"
    exit 77
fi
command -v llvm-symbolizer >/dev/null 2>&1 || echo "llvm-symbolizer is missing (Debian: llvm): findings are shown without lines"

# ---- build ----

mk() { "$MAKE_COMMAND" --no-print-directory -j "$(getconf _NPROCESSORS_ONLN)" CC=clang CFLAGS="$flags" THREADS=0 BUILD="$out/build" "$@"; }
folder=$(mk print-folder)
mk "$folder/libbitvox.a" >"$out/build.log" 2>&1 || {
    tail -n 20 "$out/build.log"
    exit 1
}

compile() { # SOURCE, OUTPUT, FLAGS...
    compile_source=$1 compile_output=$2
    shift 2
    # shellcheck disable=SC2086
    clang -std=c99 -ffp-contract=off $flags "$@" -Iinclude -Isrc -Itests "$compile_source" "$folder/libbitvox.a" -lm -o "$compile_output" || exit 1
}

# ---- one target ----

# Of the inputs that together cover all that the corpus covers, evenly over their sizes, no more than the repository shall hold.
keep() { # TARGET, LENGTH
    rm -rf "$out/$1/kept" && mkdir "$out/$1/kept"
    "$out/$1/target" -set_cover_merge=1 -max_len="$2" "$out/$1/kept" "$out/$1/corpus" "fixtures/fuzz/$1" >"$out/$1/merge.log" 2>&1 || return
    rm -f "fixtures/fuzz/$1"/*
    files=$(find "$out/$1/kept" -type f | wc -l)
    bytes=$(cat "$out/$1/kept"/* | wc -c)
    ls -Sr "$out/$1/kept" | awk -v files="$files" -v bytes="$bytes" '
        BEGIN { step = files / 100; if (bytes / 10000 > step) step = bytes / 10000; if (step < 1) step = 1 }
        int(NR / step) > int((NR - 1) / step)' | while read -r file; do cp "$out/$1/kept/$file" "fixtures/fuzz/$1/$file"; done
}

run_target() { # SOURCE, TARGET
    here=$out/$2 length=512 words=
    mkdir -p "$here/corpus" "fixtures/fuzz/$2"
    if grep -q '"fuzz_files.h"' "$1"; then
        length=4096
        compile "$1" "$here/program" -DBVX_FUZZ_MAIN
        "$here/program" --seeds "$out" "$2" || exit 1
        words=-dict=$here/words
    fi
    compile "$1" "$here/target" -fsanitize=fuzzer "-DFUZZ_FORMAT=$2"
    start=$(date +%s)
    # shellcheck disable=SC2086
    "$here/target" -max_total_time="$SECONDS_EACH" -max_len=$length $words -rss_limit_mb=2048 -timeout=60 -print_final_stats=1 \
        -artifact_prefix="$here/" "$here/corpus" "fixtures/fuzz/$2" >"$here/log" 2>&1
    status=$?
    took=$(($(date +%s) - start))
    executions=$(sed -n 's/^stat::number_of_executed_units: *//p' "$here/log")
    if [ "${executions:-0}" = 0 ]; then executions=$(sed -n 's/^#\([0-9]*\).*/\1/p' "$here/log" | tail -n 1); fi
    findings=0
    if [ $status != 0 ]; then
        findings=1
        echo "FAIL $2: see $here"
        grep -E 'ERROR|fuzz:|runtime error|SUMMARY' "$here/log" | head -n 5
    elif [ -n "${KEEP:-}" ]; then
        keep "$2" $length
    fi
    echo "$2: $executions executions in $took s, $findings findings"
    echo "| $2 | $took | $executions | $(find "$here/corpus" "fixtures/fuzz/$2" -type f | wc -l) | $findings |" >"$here/row"
}

# ---- all of them, JOBS at a time ----

report=$out/report.md
printf '| target | seconds | executions | corpus | findings |\n|---|--:|--:|--:|--:|\n' >"$report"
export UBSAN_OPTIONS=print_stacktrace=1 ASAN_OPTIONS=allocator_may_return_null=1
running=0
started=
for source in tests/fuzz/fuzz_*.c; do
    for name in $(fuzz_targets "$source"); do
        case " ${TARGETS:-$name} " in *" $name "*) ;; *) continue ;; esac
        started="$started $name"
        rm -f "$out/$name/row"
        run_target "$source" "$name" &
        running=$((running + 1))
        if [ $running -ge "$JOBS" ]; then
            wait
            running=0
        fi
    done
done
wait
failed=0
for name in $started; do
    if [ -f "$out/$name/row" ]; then cat "$out/$name/row" >>"$report"; else failed=1; fi
    case $(cat "$out/$name/row" 2>/dev/null) in *'| 0 |') ;; *) failed=1 ;; esac
done
if [ -z "$started" ]; then
    echo "no target is named ${TARGETS:-}"
    failed=1
fi
echo "report: $report"
exit $failed
