#!/bin/sh
# coverage.sh - which branches of src/ (without cli) the quick tests take. Called by `make coverage`; needs gcovr.
# Writes build/coverage/summary.txt, one line a file, and lines.txt, the lines with branches that no test takes.
set -u
cd "$(dirname "$0")/../.." || exit 1
: "${BUILD:=build}" "${MAKE_COMMAND:=make}" "${UNITY_DIR:=$BUILD/unity}"
unset MAKEFLAGS MFLAGS MAKELEVEL MAKEOVERRIDES CFLAGS
if ! command -v gcovr >/dev/null 2>&1; then
    echo "gcovr is missing (Debian: gcovr)"
    exit 77
fi
out=$BUILD/coverage
mkdir -p "$out"
out=$(cd "$out" && pwd)
mk() { "$MAKE_COMMAND" --no-print-directory -j "$(getconf _NPROCESSORS_ONLN)" CC=gcc 'CFLAGS=-O0 --coverage -fprofile-abs-path -fprofile-update=atomic' \
    BUILD="$out/build" UNITY_DIR="$UNITY_DIR" "$@"; }
mk all test-programs fault-programs >"$out/build.log" 2>&1 || {
    tail -n 20 "$out/build.log"
    exit 1
}
folder=$(mk print-folder)
find "$folder" -name '*.gcda' -exec rm -f {} +
failed=0
run() { # NAME, COMMAND...
    run_name=$1
    shift
    "$@" >"$out/run.log" 2>&1 </dev/null || {
        echo "FAIL $run_name"
        tail -n 5 "$out/run.log"
        failed=1
    }
}
for test in "$folder"/tests/unit/test_* "$folder"/tests/fault/test_*; do
    case $test in *.[od]|*.gcno|*.gcda) continue ;; esac
    run "$(basename "$test")" "$test"
done
run golden "$folder/tests/golden/golden"
run golden-portable "$folder/tests/golden/golden" --portable --threads 1
BITVOX=$out/build/bitvox
export BITVOX
for script in tests/program/test_*.sh; do
    case $script in *test_install.sh) continue ;; esac
    run "$(basename "$script")" env BUILD="$out/build" sh "$script"
done
gcovr --root . --object-directory "$folder" --filter 'src/' --exclude 'src/cli/' --exclude-unreachable-branches --exclude-throw-branches \
    --gcov-ignore-parse-errors --branches --txt "$out/summary.txt" --json "$out/coverage.json" "$folder" 2>"$out/gcovr.log" || {
    tail -n 5 "$out/gcovr.log"
    exit 1
}
python3 - "$out/coverage.json" >"$out/lines.txt" <<'END'
import json, sys
for f in json.load(open(sys.argv[1]))["files"]:
    for line in f["lines"]:
        b = [x for x in line.get("branches", [])]
        missed = sum(1 for x in b if x["count"] == 0)
        if missed or (line["count"] == 0 and not line.get("gcovr/noncode")):
            print(f'{f["file"]}:{line["line_number"]}: {missed} of {len(b)} branches not taken' + ("" if line["count"] else ", line not run"))
END
tail -n 4 "$out/summary.txt"
echo "report: $out/summary.txt, $out/lines.txt"
exit $failed
