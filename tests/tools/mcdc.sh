#!/bin/sh
# mcdc.sh - modified condition/decision coverage of the predicates and tables: what decides geometry in whole numbers. Each
# condition of each decision must be seen to turn the outcome by itself; a decision of one condition must be seen both ways.
# Called by `make mcdc`; needs clang-19 with its profile runtime, llvm-19 (llvm-profdata-19, llvm-cov-19) and python3. Prints a
# line a file, each condition that no test decides by, unless it stands below, and each && and || that clang left out of its
# count (a ! before brackets with && or || inside, or BVXI_LIKELY round them, makes it do so). Ends with "N passed, N failed", one a file.
set -u
cd "$(dirname "$0")/../.." || exit 1
: "${BUILD:=build}" "${MAKE_COMMAND:=make}" "${UNITY_DIR:=$BUILD/unity}"
unset MAKEFLAGS MFLAGS MAKELEVEL MAKEOVERRIDES CFLAGS
for tool in clang-19 llvm-profdata-19 llvm-cov-19 python3; do
    command -v $tool >/dev/null 2>&1 || { echo "$tool is missing (Debian: clang-19 llvm-19 libclang-rt-19-dev python3)"; exit 77; }
done
mkdir -p "$BUILD/mcdc"
echo 'int main(void) { return 0; }' | clang-19 -fprofile-instr-generate -x c - -o "$BUILD/mcdc/probe" >/dev/null 2>&1 || {
    echo "clang-19 finds no profile runtime (Debian: libclang-rt-19-dev)"
    exit 77
}

files='src/core/exact.c src/lattice/lattice.c src/lattice/lattice.h src/lattice/wide.h
    src/mesh/polygon.c src/mesh/polygon.h src/mesh/topology.c
    src/refine/children.c src/refine/cubes.h
    src/contours/section.h src/contours/simple.c
    src/surface/cell_loops.c src/surface/cells.h src/surface/count.c
    src/touch/conservative.c src/solid/covered_rows.h src/solid/crossings.c src/touch/sampled.c
    src/solid/solid_rows.c src/solid/triangle_rows.c src/touch/thin.c src/touch/touch_cells.h src/touch/touch_cells.h src/touch/touch_rows.c'
tests='below boolean check cut_triangle edge_vector faces lattice lod memory merge polygon refine refine_children refine_parts section_parts sections
    sharp sharp_parts solid solid_exact solid_same surface surface_sampled surface_thin surface_voxels tables vote weld winding'

# Conditions that no test can decide by: FILE | TEXT OF THE LINE | REASON. The text may be a part of the line.
exceptions='
src/core/exact.c | if (up != 1.0 | only arithmetic that the library refuses decides here
src/core/exact.c | (one_f + half_f) + half_f | only arithmetic that the library refuses decides here
src/core/exact.c | above * below + minus | only arithmetic that the library refuses decides here
src/lattice/lattice.c | while (log2 < 30 | no side is longer than 2^30: the shift is kept defined whatever is asked
src/contours/simple.c | if (status == BVX_OK) status | failures are made to happen in tests/fault
src/touch/sampled.c | while (k * k > longest) | a rounded root is right already; kept so that the answer does not rest on it
src/touch/sampled.c | while ((k + 1) * (k + 1) | a rounded root is right already; kept so that the answer does not rest on it
src/solid/solid_rows.c | bvxi_solid_rounds(ctx, job, BVXI_COUNT_LIST | failures are made to happen in tests/fault
src/touch/touch_cells.h | id != NULL | lists of triangles are for several tiles, which a build without threads has not
'

out=$(cd "$BUILD/mcdc" && pwd)
mk() { "$MAKE_COMMAND" --no-print-directory -j "$(getconf _NPROCESSORS_ONLN)" CC=clang-19 THREADS=0 \
    'CFLAGS=-O1 -fprofile-instr-generate -fcoverage-mapping -fcoverage-mcdc' BUILD="$out/build" UNITY_DIR="$UNITY_DIR" "$@"; }
folder=$(mk print-folder)
goals=
for t in $tests; do goals="$goals $folder/tests/unit/test_$t"; done
# shellcheck disable=SC2086
mk $goals "$folder/tests/golden/golden" >"$out/build.log" 2>&1 || {
    tail -n 20 "$out/build.log"
    exit 1
}
rm -f "$out"/*.profraw
for program in $goals; do
    LLVM_PROFILE_FILE="$out/$(basename "$program").profraw" "$program" >"$out/run.log" 2>&1 </dev/null || {
        echo "FAIL $(basename "$program")"
        tail -n 5 "$out/run.log"
        exit 1
    }
done
for path in '' --portable; do
    LLVM_PROFILE_FILE="$out/golden$path.profraw" "$folder/tests/golden/golden" $path >"$out/run.log" 2>&1 </dev/null || {
        echo "FAIL golden $path"
        tail -n 5 "$out/run.log"
        exit 1
    }
done
llvm-profdata-19 merge -o "$out/all.profdata" "$out"/*.profraw || exit 1
objects=
for program in $goals; do objects="$objects -object $program"; done
# shellcheck disable=SC2086
llvm-cov-19 export -instr-profile "$out/all.profdata" "$folder/tests/golden/golden" $objects $files >"$out/export.json" 2>"$out/cov.log" || {
    tail -n 5 "$out/cov.log"
    exit 1
}
printf '%s\n' "$exceptions" >"$out/exceptions.txt"
# shellcheck disable=SC2086
python3 - "$out/export.json" "$out/exceptions.txt" $files <<'END'
import json, os, re, sys
data = json.load(open(sys.argv[1]))["data"][0]
allowed = [[p.strip() for p in line.split("|", 2)] for line in open(sys.argv[2]) if line.count("|") >= 2]
def operators(lines):
    "Places of && and || in the code, behind comments and beside lines for the preprocessor."
    code = re.sub(r"/\*.*?\*/", lambda m: re.sub(r"[^\n]", " ", m.group()), "\n".join(lines), flags=re.S).split("\n")
    for k, line in enumerate(code):
        if not line.lstrip().startswith("#") and not (k and code[k - 1].endswith("\\")):
            yield from ((k + 1, m.start() + 1) for m in re.finditer(r"&&|\|\|", line))

used, passed, failed, decided, all_excused = set(), 0, 0, 0, 0
seen = {os.path.relpath(f["filename"]): f for f in data["files"]}
for name in sys.argv[3:]:
    f = seen.get(name)
    if f is None:
        print(f"FAIL  {name}: not in any test")
        failed += 1
        continue
    lines = open(name).read().split("\n")
    decisions, single = {}, {}
    for r in f.get("mcdc_records", []):  # of each copy of an inline function
        place, seen_to_decide = tuple(r[:4]), r[-1]
        old = decisions.get(place, [False] * len(seen_to_decide))
        decisions[place] = [a or b for a, b in zip(old, seen_to_decide)]
    for b in f.get("branches", []):
        place = tuple(b[:4])
        if any((d[0], d[1]) <= (place[0], place[1]) and (place[2], place[3]) <= (d[2], d[3]) for d in decisions):
            continue
        old = single.get(place, (0, 0))
        single[place] = (old[0] + b[4], old[1] + b[5])
    missed = [(l, "not counted by clang") for l, c in operators(lines) if not any(d[:2] <= (l, c) <= d[2:] for d in decisions)]
    uncounted = len(missed)
    for place, conditions in decisions.items():
        missed += [(place[0], f"condition {i + 1} of {len(conditions)}") for i, good in enumerate(conditions) if not good]
    missed += [(p[0], "never " + " nor ".join(["true"] * (t == 0) + ["false"] * (n == 0))) for p, (t, n) in single.items() if t == 0 or n == 0]
    total = sum(len(c) for c in decisions.values()) + len(single)
    open_ones, excused = [], 0
    for line, what in sorted(missed):
        for k, (where, text, _) in enumerate(allowed):
            if where == name and text in lines[line - 1]:
                used.add(k)
                excused += 1
                break
        else:
            open_ones.append(f"      | {name}:{line}: {what}: {lines[line - 1].strip()}")
    good = total - len(missed) + uncounted
    decided += good
    all_excused += excused
    print(f"{'FAIL' if open_ones else 'ok  '}  {name}: {good} of {total} conditions{f', {excused} excepted' if excused else ''}")
    print("\n".join(open_ones), end="\n" if open_ones else "")
    failed += bool(open_ones)
    passed += not open_ones
for k, (where, text, _) in enumerate(allowed):
    if k not in used:
        print(f"note  {where}: an exception for nothing: {text}")
print(f"      {decided} conditions decide by themselves, {all_excused} are excepted")
print(f"{passed} passed, {failed} failed")
sys.exit(failed != 0)
END
