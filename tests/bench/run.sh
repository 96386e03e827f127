#!/bin/sh
# run.sh - all measurements; called by `make bench`, which hands over BENCHES, the folder of the measuring programs.
#
# Prints tables and leaves everything in BUILD/bench, report.md first. Other libraries come from pip into BUILD/bench/venv;
# without Python or network the report says what is missing and shows ours.
#     MESHES=FOLDER         where the real meshes are [../shared/meshes]
#     BENCH_RUNS=N          runs of each of our jobs [25]
#     BENCH_PEERS=0         leave the other libraries out
#     BENCH_PYTHON=PROGRAM  a Python that has the other libraries, instead of the venv
#     BENCH_ONLY=a,b        these parts alone, without a report: core files voxels field grids morph volumes labels makers components
#                           levels sections paper, and calls: the smallest call of each kind, in Python too where BENCH_PYTHON has the package
#     BENCH_VDB_FLAGS=...   for the C++ compiler: where OpenVDB is, when not in the usual folders
set -u
cd "$(dirname "$0")/../.." || exit 1
: "${BENCHES:?}" "${BUILD:=build}" "${MESHES:=../shared/meshes}" "${BENCH_RUNS:=25}" "${BENCH_PEERS:=1}" "${BENCH_PYTHON:=}" "${BENCH_ONLY:=}"
out=$BUILD/bench
mesh=$MESHES/dragon_vrip_871414.ply.gz
packages="numpy vtk pyvista scikit-image meshoptimizer fast-simplification open3d trimesh libigl meshlib mesh2sdf pymeshfix manifold3d scipy edt connected-components-3d zmesh itk-morphologicalcontourinterpolation pymeshlab"

load() { cut -d ' ' -f 1 /proc/loadavg 2>/dev/null || echo unknown; }

if [ ! -f "$mesh" ]; then
    echo "bench: $mesh is missing; MESHES=FOLDER says where it is"
    exit 1
fi
mkdir -p "$out/ours"
load >"$out/load"

# One package that cannot be installed leaves the others.
prepare_venv() {
    python3 -m venv "$out/venv" >"$out/venv.log" 2>&1 || return 1
    for package in $packages; do
        "$out/venv/bin/python" -m pip install --quiet --disable-pip-version-check "$package" >>"$out/venv.log" 2>&1 ||
            echo "bench: pip could not install $package, see $out/venv.log"
    done
    "$out/venv/bin/python" -c 'import numpy' 2>/dev/null && touch "$out/venv/complete"
}

# Warm memory for them as for us: glibc keeps what was freed instead of giving it back to the system.
peer() { MALLOC_MMAP_MAX_=0 MALLOC_TRIM_THRESHOLD_=17179869184 "$python" "$@"; }

# Sets python where there is one with the other libraries.
python=
find_python() {
    if [ "$BENCH_PEERS" = 0 ]; then return; fi
    python=$BENCH_PYTHON
    if [ -z "$python" ]; then
        if [ ! -f "$out/venv/complete" ]; then prepare_venv; fi
        if [ -f "$out/venv/complete" ]; then python=$out/venv/bin/python; fi
    fi
    if [ -z "$python" ] || ! "$python" -c 'import numpy'; then
        echo "missing: a Python environment with $packages, see $out/venv.log"
        python=
    fi
}

measure_voxels() {
    rm -f "$out"/voxels* "$out"/refine* "$out"/peers_voxels.md "$out"/fills.md
    echo "== surfaces of voxels, fills, the TIN paper's tables"
    "$BENCHES/bench_voxels" "$MESHES" "$out" 9 >"$out/voxels.md" && cat "$out/voxels.md"
    if [ -n "$python" ]; then peer tests/bench/peers_voxels.py "$out" "$BENCHES/bench_voxels" "$MESHES"; fi
    if [ -n "$python" ] && [ -f tests/bench/peers_fills.py ] && [ -x "$BUILD/bitvox" ]; then
        "$python" tests/bench/peers_fills.py "$out" "$BUILD/bitvox" "$MESHES"
    fi
    echo "== refinement, and its paper's tables"
    "$BENCHES/bench_refine" "$MESHES" "$out" 5 >"$out/refine.md" && cat "$out/refine.md"
}

measure_field() {
    rm -f "$out"/field* "$out"/peers_field* "$out/step.md" "$out/defects.md"
    echo "== distance fields and repair"
    "$BENCHES/bench_field" "$MESHES" "$out" 9 >"$out/field.md" && cat "$out/field.md"
    if [ -n "$python" ]; then peer tests/bench/peers_field.py "$out" "$BENCHES/bench_field" "$MESHES"; fi
    echo "== repair of shapes that were spoilt"
    "$BENCHES/bench_defects" >"$out/defects.md" && cat "$out/defects.md"
    echo "== the repair paper's experiment"
    "$BENCHES/bench_step" "$MESHES" >"$out/step.md" && cat "$out/step.md"
}

measure_grids() {
    rm -f "$out"/grids* "$out"/peers_grids*
    echo "== grids: set algebra, booleans of meshes"
    "$BENCHES/bench_grids" "$MESHES" "$out" 9 >"$out/grids.md" && cat "$out/grids.md"
    if [ -n "$python" ]; then peer tests/bench/peers_grids.py "$out" "$BENCHES/bench_grids" "$MESHES"; fi
}

measure_morph() {
    rm -f "$out"/morph* "$out/peers_morph.md"
    echo "== morphology and distances of grids"
    "$BENCHES/bench_morph" "$MESHES" "$out" 9 >"$out/morph.md" && cat "$out/morph.md"
    if [ -n "$python" ]; then peer tests/bench/peers_morph.py "$out"; fi
}

measure_volumes() {
    rm -f "$out"/volume*
    echo "== scalar volumes"
    "$BENCHES/bench_volumes" "$MESHES" "$out" 9 >"$out/volumes.md" && cat "$out/volumes.md"
    if [ -n "$python" ]; then peer tests/bench/peers_volumes.py "$out" | tee -a "$out/volumes.md"; fi
    rm -f "$out/volume_dragon.f32"
}

measure_labels() {
    rm -f "$out/labels.md"
    echo "== surfaces of labels"
    if [ -n "$python" ] && [ -x "$BUILD/bitvox" ]; then peer tests/bench/peers_labels.py "$out" "$BUILD/bitvox" | tee "$out/labels.md"; fi
    rm -f "$out"/voronoi_*
}

measure_makers() {
    echo "== hulls, levels that enclose, mass, what can be made"
    "$BENCHES/bench_makers" "$MESHES" >"$out/makers.md" && cat "$out/makers.md"
    if [ -n "$python" ]; then peer tests/bench/peers_makers.py "$out" "$MESHES"; fi
}

measure_components() {
    rm -f "$out"/components.md "$out"/peers_components.md
    echo "== parts of grids"
    "$BENCHES/bench_components" "$MESHES" "$out" 5 >"$out/components.md" && cat "$out/components.md"
    if [ -n "$python" ]; then peer tests/bench/peers_components.py "$out" "$BENCHES/bench_components" "$MESHES"; fi
    rm -f "$out"/components_*.npy
}

measure_levels() {
    rm -f "$out"/levels.md "$out"/levels_time.md "$out"/levels_each.md "$out"/levels*.json*
    echo "== levels of detail beside other libraries"
    if [ -z "$python" ] || ! "$python" -c 'import igl, manifold3d, scipy, trimesh'; then
        echo "missing: Python with libigl, manifold3d, scipy and trimesh, which measure levels"
        return
    fi
    "$python" tests/bench/peers_levels.py "$out" "$BUILD/bitvox" "$MESHES" && cat "$out/levels.md"
    if "$python" -c 'import meshoptimizer' 2>/dev/null; then
        peer tests/bench/levels_time.py "$out" "$BUILD/bitvox" "$mesh" | tee "$out/levels_time.md"
    fi
}

measure_core() {
    rm -rf "$out/peers" "$out/peers.json" "$out/judged.jsonl" "$out/core.json" "$out/solid.json"
    echo "== ours"
    "$BENCHES/bench_core" "$mesh" "$out" "$BENCH_RUNS" | tee "$out/core.txt"
    [ -s "$out/solid.json" ] || exit 1
    echo "== levels of detail: distance to the original, two-way in percent of the diagonal"
    "$BENCHES/bench_quality" ours "$mesh" "$out/ours" 2>&1 >"$out/ours.jsonl" | tee "$out/quality.txt"
    if [ -z "$python" ]; then return; fi
    echo "== other libraries (least and median milliseconds, ours in turns with them)"
    peer tests/bench/peers.py "$out" "$BENCHES/bench_turns"
    if [ -d "$out/peers" ]; then
        "$BENCHES/bench_quality" judge "$mesh" "$out"/peers/*.ply 2>&1 >"$out/judged.jsonl" | tee -a "$out/quality.txt"
    fi
}

measure_files() {
    echo "== files"
    mkdir -p "$out/files"
    rm -f "$out/files.md"
    "$BENCHES/bench_files" "$mesh" "$out" 9 >"$out/files.jsonl" && cat "$out/files.jsonl"
    if [ -n "$python" ]; then "$python" tests/bench/peers_files.py "$out" && cat "$out/files.md"; fi
}

measure_sections() {
    rm -f "$out/sections.md" "$out/planes.md"
    echo "== bodies from sections"
    "$BENCHES/bench_sections" "$out" 9 >"$out/sections.md" && cat "$out/sections.md"
    if [ -n "$python" ]; then "$python" tests/bench/peers_sections.py "$out" 9 | tee -a "$out/sections.md"; fi
    if [ -n "$python" ] && "$python" -c 'import scipy, skimage, itk' 2>/dev/null; then
        "$python" tests/bench/peers_planes.py "$out" "$BUILD/bitvox" "$MESHES" >"$out/planes.md" && cat "$out/planes.md"
    fi
}

measure_paper() {
    echo "== the LOD paper's tables"
    "$BENCHES/bench_paper" "$MESHES" >"$out/paper.md" && echo "in $out/paper.md"
}

measure_calls() {
    "$BENCHES/bench_calls" | tee "$out/calls.md"
    if [ -n "$BENCH_PYTHON" ]; then "$BENCH_PYTHON" tests/bench/calls.py | tee -a "$out/calls.md"; fi
}

if [ "$BENCH_ONLY" != calls ]; then find_python; fi
if [ -z "$BENCH_ONLY" ]; then rm -f "$out/report.md" "$out/report.json"; fi
for part in $(echo "${BENCH_ONLY:-core,files,voxels,field,grids,morph,volumes,labels,makers,components,levels,sections,paper}" | tr , ' '); do
    started=$(date +%s)
    "measure_$part"
    echo "== $part took $(($(date +%s) - started)) s"
    load >>"$out/load"
done
if [ -n "$BENCH_ONLY" ]; then exit 0; fi

if command -v python3 >/dev/null 2>&1; then
    python3 tests/bench/report.py "$out" || exit 1
    cat "$out/report.md"
else
    echo "missing: python3, which puts the ratios together; report.md has the plain tables"
    { cat "$out/core.txt" && echo && cat "$out/quality.txt" "$out/paper.md"; } >"$out/report.md"
fi
echo "report: $out/report.md, numbers: $out/*.json*"
