#!/bin/sh
# test_level_meshes.sh [PROGRAM] - levels of every shared mesh at 10, 3 and 1 % of its triangles: certified and without crossing triangles as info
# reads the files. PROGRAM is build/bitvox, or what BITVOX names. One line a check, "ok NAME" or "not ok NAME"; the last line is
# "N passed, N failed[, N skipped]". Runs in the repository's root, works in a folder of its own.
set -u
. tests/tools/program_checks.sh
meshes=$root/../shared/meshes

whole_levels() { # NAME, MESH
    rm -f level_*.ply
    "$program" info "$2" --json >out 2>err || return 1
    count=$(grep -o '"triangles": [0-9]*' out | head -n 1 | tr -dc 0-9)
    run lod "$2" --triangles "$((count / 10 + 4)),$((count * 3 / 100 + 4)),$((count / 100 + 4))" -o level_%d.ply --json
    [ $status = 0 ] && ! grep -q '"[a-z_]*components[a-z_]*": [0-9]\{9\}' out || return 1
    for i in 0 1 2; do
        "$program" info level_$i.ply --json --crossings >out 2>>err || return 1
        grep -q '"closed": true, "manifold": true, "oriented": true' out && grep -q '"crossings": 0' out || return 1
    done
}

whole_levels knot "$knot"
result 'levels of the knot' $?
if [ -d "$meshes" ]; then
    for mesh in "$meshes"/*; do
        whole_levels "$(basename "$mesh")" "$mesh"
        result "levels of $(basename "$mesh")" $?
    done
else
    skip 'levels of real meshes' '../shared/meshes is missing'
fi

counts
