#!/bin/sh
# fuzz.sh - run the fuzz targets with coverage guidance (clang's libFuzzer) under ASan and UBSan. Called by `make fuzz`:
#     SECONDS_EACH=60      seconds a target [60]
#     TARGETS="a b"        these alone (names without fuzz_ and .c)
#     KEEP=1               put what was found and matters into fixtures/fuzz
# The corpus in fixtures/fuzz/TARGET is read, new inputs go to build/fuzz/TARGET/corpus. What breaks a contract is left in
# build/fuzz/TARGET; the report goes to build/fuzz/report.md.
set -u
cd "$(dirname "$0")/../.." || exit 1
: "${BUILD:=build}" "${MAKE_COMMAND:=make}" "${SECONDS_EACH:=60}"
unset MAKEFLAGS MFLAGS MAKELEVEL MAKEOVERRIDES CC CFLAGS LDFLAGS
if ! command -v clang >/dev/null 2>&1; then
    echo "clang is missing (Debian: clang)"
    exit 77
fi
out=$BUILD/fuzz
mkdir -p "$out"
sanitize=address,undefined,float-cast-overflow
flags="-O1 -g -fno-omit-frame-pointer -fsanitize=fuzzer-no-link,$sanitize -fno-sanitize-recover=all"
mk() { "$MAKE_COMMAND" --no-print-directory -j "$(getconf _NPROCESSORS_ONLN)" CC=clang CFLAGS="$flags" OPENMP=0 BUILD="$out/build" "$@"; }
folder=$(mk print-folder)
mk "$folder/libbitvox.a" >"$out/build.log" 2>&1 || {
    tail -n 20 "$out/build.log"
    exit 1
}
report=$out/report.md
printf '| target | seconds | executions | corpus | findings |\n|---|--:|--:|--:|--:|\n' >"$report"
export UBSAN_OPTIONS=print_stacktrace=1 ASAN_OPTIONS=allocator_may_return_null=1
failed=0
for source in tests/fuzz/fuzz_*.c; do
    name=$(basename "$source" .c)
    name=${name#fuzz_}
    case " ${TARGETS:-$name} " in *" $name "*) ;; *) continue ;; esac
    mkdir -p "$out/$name/corpus" "fixtures/fuzz/$name"
    # shellcheck disable=SC2086
    clang -std=c99 -ffp-contract=off $flags -fsanitize=fuzzer,$sanitize -Iinclude -Isrc -Itests "$source" "$folder/libbitvox.a" -lm -o "$out/$name/target" || exit 1
    length=4096
    if grep -q fuzz_input.h "$source"; then length=512; fi
    "$out/$name/target" -max_total_time="$SECONDS_EACH" -max_len=$length -rss_limit_mb=2048 -timeout=60 -print_final_stats=1 \
        -artifact_prefix="$out/$name/" "$out/$name/corpus" "fixtures/fuzz/$name" >"$out/$name/log" 2>&1
    status=$?
    executions=$(sed -n 's/^stat::number_of_executed_units: *//p' "$out/$name/log")
    if [ "${executions:-0}" = 0 ]; then executions=$(sed -n 's/^#\([0-9]*\).*/\1/p' "$out/$name/log" | tail -n 1); fi
    findings=0
    if [ $status != 0 ]; then
        findings=1
        failed=1
        echo "FAIL $name: see $out/$name"
        grep -E 'ERROR|fuzz:|runtime error|SUMMARY' "$out/$name/log" | head -n 5
    elif [ -n "${KEEP:-}" ]; then
        "$out/$name/target" -merge=1 -max_len=$length "fixtures/fuzz/$name" "$out/$name/corpus" >"$out/$name/merge.log" 2>&1
    fi
    echo "$name: $executions executions in $SECONDS_EACH s, $findings findings"
    echo "| $name | $SECONDS_EACH | $executions | $(find "$out/$name/corpus" "fixtures/fuzz/$name" -type f | wc -l) | $findings |" >>"$report"
done
echo "report: $report"
exit $failed
