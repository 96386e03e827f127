#!/bin/sh
# test_level_meshes.sh [PROGRAM] - solid levels of every shared mesh at 10, 3 and 1 % of its triangles: certified and without crossing triangles as
# info reads the files; levels of the small ones as they are, at half and a tenth: no new fault. PROGRAM is build/bitvox, or what BITVOX names. One line a check, "ok NAME" or "not ok NAME"; the last line is
# "N passed, N failed[, N skipped]". Runs in the repository's root, works in a folder of its own.
set -u
. tests/tools/program_checks.sh
meshes=$root/../shared/meshes

whole_levels() { # NAME, MESH
    rm -f level_*.ply
    "$program" info "$2" --json >out 2>err || return 1
    count=$(grep -o '"triangles": [0-9]*' out | head -n 1 | tr -dc 0-9)
    run lod "$2" --solid --triangles "$((count / 10 + 4)),$((count * 3 / 100 + 4)),$((count / 100 + 4))" -o level_%d.ply --json
    [ $status = 0 ] && ! grep -q '"[a-z_]*components[a-z_]*": [0-9]\{9\}' out || return 1
    for i in 0 1 2; do
        "$program" info level_$i.ply --json --crossings >out 2>>err || return 1
        grep -q '"closed": true, "manifold": true, "oriented": true' out && grep -q '"crossings": 0' out || return 1
    done
}

# Of the number after a name in the last report: of the mesh, or of a level.
number_of() { grep -o "\"$1\": [0-9]*" out | head -n 1 | tr -dc 0-9; }
is_true() { grep -q "\"$1\": true" out; }
details_of() { "$program" info "$1" --json --crossings >out 2>>err; }

# No level has more triangles than the mesh, a border or a crossing where there was none, or fewer parts. Edges that no pairing joins are cut, and
# counted.
kept_levels() { # MESH
    rm -f level_*.ply
    details_of "$1" || return 1
    triangles=$(number_of triangles) crossings=$(number_of crossings) border=$(number_of boundary_edges)
    run lod "$1" --triangles "$((triangles / 2)),$((triangles / 10))" --samples 0 -o level_%d.ply --json
    [ $status = 0 ] || return 1
    cut=$(number_of cut) parts=$(number_of input_components)
    for i in 0 1; do
        details_of level_$i.ply && is_true manifold && is_true oriented || return 1
        [ "$(number_of triangles)" -le "$triangles" ] && [ "$(number_of components)" -ge "$parts" ] || return 1
        [ "$(number_of crossings)" -le "$crossings" ] || return 1
        is_true closed || [ "$border" != 0 ] || [ "$cut" != 0 ] || return 1
    done
}

whole_levels knot "$knot"
result 'levels of the knot' $?
kept_levels "$knot"
result 'levels of the knot as it is' $?
if [ -d "$meshes" ]; then
    for mesh in "$meshes"/*; do
        # Smaller ones take the same ways.
        if [ "$(wc -c <"$mesh")" -gt 3145728 ] && [ -z "${BITVOX_LARGE:-}" ]; then
            skip "levels of $(basename "$mesh")" 'BITVOX_LARGE=1 asks for it'
            continue
        fi
        whole_levels "$(basename "$mesh")" "$mesh"
        result "levels of $(basename "$mesh")" $?
        details_of "$mesh"
        [ "$(number_of triangles)" -lt 25000 ] || continue
        kept_levels "$mesh"
        result "levels of $(basename "$mesh") as it is" $?
    done
else
    skip 'levels of real meshes' '../shared/meshes is missing'
fi

counts
