#!/bin/sh
# coverage.sh - which branches of src/ (without cli) the quick tests take. Called by `make coverage`; needs gcc, gcovr, cmocka and
# python3. Prints the 30 files with most branches that no test takes, and fails below 95 % of all. Writes build/coverage/files.txt
# (every file), lines.txt (the lines with such branches) and coverage.json (gcovr's).
#
# Unit and fault tests, golden values (by the fast paths and without them) and the examples in C are run; what the program's
# scripts run besides is left out, since the program's own threads would lose counts. Only the core is counted in, at -O1 without
# what merges branches (early inlining, phiopt): at -O0 the tests would take longer by half. Loops that are copied into one function
# a processor level are counted once, like other functions. Threads run one after another
# (OMP_THREAD_LIMIT), so counts need no atomic updates; how work is cut up does not depend on that. No branch is left out by gcovr:
# the options that guess at unreachable branches are not used.
set -u
cd "$(dirname "$0")/../.." || exit 1
: "${BUILD:=build}" "${MAKE_COMMAND:=make}" "${UNITY_DIR:=$BUILD/unity}" "${LEAST:=95}"
unset MAKEFLAGS MFLAGS MAKELEVEL MAKEOVERRIDES CFLAGS
for tool in gcc gcovr python3; do
    command -v $tool >/dev/null 2>&1 || { echo "$tool is missing (Debian: gcc gcovr python3)"; exit 77; }
done

# Branches that no test can take: FILE | TEXT OF THE LINE | REASON. The text may be a part of the line. Where the reason is a number
# of things, a test would need so many of them in memory.
exceptions='
src/core/exact.c | (one + half) + half != 1.0 | only arithmetic that the library refuses decides here
src/core/exact.c | above * below + minus | only arithmetic that the library refuses decides here
src/field/measure.c | n > UINT64_MAX / 24 | 2^59 values
src/grid/grid.c | words > SIZE_MAX / 8 | 32-bit machines alone
src/io_mesh/obj.c | count > INT32_MAX | a file of 2^31 corners
src/io_mesh/obj.c | f->vertices > UINT32_MAX | a file of 2^32 vertices
src/io_mesh/obj.c | f->triangles > INT32_MAX | a file of 2^31 triangles
src/io_mesh/off.c | triangles > INT32_MAX | a file of 2^31 triangles
src/io_mesh/ply.c | triangles > INT32_MAX | a file of 2^31 triangles
src/io_mesh/read_points.c | count > UINT32_MAX | a file of 2^32 points
src/io_grid/tree_file.c | octets >= (uint64_t)1 << 28 | a file of 2^28 octets
src/io_mesh/stl.c | vertex_count == UINT32_MAX | 2^32 vertices
src/io_mesh/stl.c | triangle_count + s->waiting > INT32_MAX | 2^31 triangles
src/io_mesh/ply.c | vertex_count > INT32_MAX | 2^31 vertices
src/io_grid/write_vtu.c | v.count >= (uint64_t)1 << 28 | 2^28 leaves
src/lattice/lattice.c | log2 < 30 | no side is longer than 2^30: the shift is kept defined whatever is asked
src/refine/refine_level.c | next->count >= (uint64_t)1 << 28 | 2^28 octets
src/refine/refine_start.c | voxels >= UINT32_MAX | 2^32 surface voxels
src/refine/refine_start.c | words > SIZE_MAX / 8 | 32-bit machines alone
src/refine/states.c | octets + cubes >= UINT32_MAX | 2^32 octets
src/contours/loop_arcs.c | room > INT32_MAX | 2^31 crossings
src/contours/planes.c | cuts > INT32_MAX | 2^31 crossings
src/layers/plane_rings.c | vertices > UINT32_MAX - 1 | 2^32 vertices
src/contours/section_mesh.c | >= UINT32_MAX - 1 | 2^32 vertices
src/contours/section_mesh.c | triangle_count >= INT32_MAX | 2^31 triangles
src/layers/slab.c | larger > INT32_MAX | 2^31 crossings
src/layers/all_slabs.c | vertices > UINT32_MAX - 1 | 2^32 vertices
src/layers/all_slabs.c | triangles > INT32_MAX | 2^31 triangles
src/contours/slice.c | list_count > INT32_MAX | 2^31 triangles
src/surface/faces.c | face_count < UINT32_MAX / 2 | 2^31 faces
src/surface/march.c | vertices >= UINT32_MAX | 2^32 vertices
src/surface/sharp.c | >= UINT32_MAX | 2^32 vertices
src/volume/labels.c | room > UINT32_MAX / 2 | 2^31 labels
src/touch/voxelize_surface.c | voxels >= UINT32_MAX | 2^32 surface voxels
'

jobs=$(getconf _NPROCESSORS_ONLN 2>/dev/null || echo 1)
out=$BUILD/coverage
mkdir -p "$out"
out=$(cd "$out" && pwd)
mk() { "$MAKE_COMMAND" --no-print-directory -j "$jobs" CC=gcc CFLAGS=-O2 LDFLAGS=--coverage BUILD="$out/build" UNITY_DIR="$UNITY_DIR" \
    CORE_FLAGS='-DBVXI_VECTOR_INLINE=static -O1 -fno-early-inlining -fno-ssa-phiopt --coverage -fprofile-abs-path -fprofile-update=single' "$@"; }
folder=$(mk print-folder)
mk test-programs fault-programs >"$out/build.log" 2>&1 || {
    tail -n 20 "$out/build.log"
    exit 1
}
find "$folder" -name '*.gcda' -exec rm -f {} +
for notes in "$folder"/src/*/*.gcno; do # of sources that are gone
    source=${notes#"$folder"/}
    [ -f "${source%.gcno}.c" ] || rm -f "$notes"
done

# Each program once, as many at a time as there are processors; programs add their counts to the files under a lock.
rm -rf "$out/runs"
mkdir -p "$out/runs"
{
    for source in tests/unit/test_*.c tests/fault/test_*.c tests/examples/*.c; do echo "$folder/${source%.c}"; done
    echo "$folder/tests/golden/golden"
    echo "$folder/tests/golden/golden --portable"
} >"$out/programs.txt"
export OMP_THREAD_LIMIT=1
# shellcheck disable=SC2016
xargs -P "$jobs" -I '{}' sh -c 'log=$1/$(echo "${2##*/}" | tr " " _); $2 >"$log" 2>&1 </dev/null || echo "exit status $?" >"$log.failed"' \
    sh "$out/runs" '{}' <"$out/programs.txt"
failed=0
for run in "$out"/runs/*.failed; do
    [ -f "$run" ] || continue
    echo "FAIL  $(basename "$run" .failed)"
    tail -n 5 "${run%.failed}" "$run" | sed 's/^/      | /'
    failed=1
done
[ $failed = 0 ] || exit 1

gcovr --root . --object-directory "$folder" --filter 'src/' --exclude 'src/cli_' -j "$jobs" --json "$out/coverage.json" "$folder/src" \
    >"$out/gcovr.log" 2>&1 || {
    tail -n 5 "$out/gcovr.log"
    exit 1
}
printf '%s\n' "$exceptions" >"$out/exceptions.txt"
python3 - "$out" "$LEAST" <<'END'
import glob, json, os, sys
out, least = sys.argv[1], float(sys.argv[2])
allowed = [[p.strip() for p in line.split("|", 2)] for line in open(f"{out}/exceptions.txt") if line.count("|") >= 2]
seen = {f["file"]: f["lines"] for f in json.load(open(f"{out}/coverage.json"))["files"]}
sources = [s for s in sorted(glob.glob("src/*/*.c")) if not s.startswith("src/cli_")]
absent = [s for s in sources if s not in seen]
used, table, open_lines = set(), [], []
for name, counted in sorted(seen.items()):
    text = open(name).read().split("\n")
    total = taken = excused = 0
    for line in counted:
        branches = line["branches"]
        untaken = sum(b["count"] == 0 for b in branches)
        total += len(branches)
        taken += len(branches) - untaken
        if untaken == 0:
            continue
        words = text[line["line_number"] - 1].strip()
        for k, (where, part, _) in enumerate(allowed):
            if where == name and part in words:
                used.add(k)
                excused += untaken
                break
        else:
            state = "" if line["count"] else ", never run"
            open_lines.append(f"{name}:{line['line_number']}: {untaken} of {len(branches)} not taken{state}: {words}")
    table.append((total - taken - excused, name, total, taken, excused))
rows = ["not taken  taken  branches  excepted  file"]
for missed, name, total, taken, excused in sorted(table, key=lambda r: (-r[0], r[1])):
    rows.append(f"{missed:9}  {100 * taken / total if total else 100:4.0f}%  {total:8}  {excused:8}  {name}")
print("\n".join(rows[:31]))
open(f"{out}/files.txt", "w").write("\n".join(rows) + "\n")
open(f"{out}/lines.txt", "w").write("".join(line + "\n" for line in open_lines))
for name in absent:
    print(f"FAIL  {name}: not counted")
for k, (where, part, _) in enumerate(allowed):
    if k not in used:
        print(f"note  {where}: an exception for nothing: {part}")
total, taken, excused = (sum(row[i] for row in table) for i in (2, 3, 4))
judged = total - excused
share = 100 * taken / judged if judged else 0
good = share >= least and not absent
print(f"{'ok  ' if good else 'FAIL'}  {taken} of {judged} branches taken, {share:.2f} % (at least {least:g} %); {excused} more excepted")
print(f"all {len(table)} files: {out}/files.txt; lines with branches not taken: {out}/lines.txt")
sys.exit(not good)
END
