#!/bin/sh
# test_voxel_meshes.sh [PROGRAM] - meshes out of every command that makes voxels, by the ending of -o: their volumes against
# those of boxes and balls known by hand, what lies on the mesh and what half way. PROGRAM is build/bitvox, or what BITVOX names.
# The last line is "N passed, N failed[, N skipped]". Runs in the repository's root, works in a folder of its own.
set -u
. tests/tools/program_checks.sh

printf '%s\n' 'v 0 0 0' 'v 10 0 0' 'v 0 9 0' 'v 10 9 0' 'v 0 0 8' 'v 10 0 8' 'v 0 9 8' 'v 10 9 8' \
    'f 1 3 4' 'f 1 4 2' 'f 5 6 8' 'f 5 8 7' 'f 1 2 6' 'f 1 6 5' 'f 3 7 8' 'f 3 8 4' 'f 1 5 7' 'f 1 7 3' 'f 2 4 8' 'f 2 8 6' >box.obj

number() { sed -n "s/.*\"$1\": \(-\{0,1\}[0-9.e+-]*\).*/\1/p" out | head -1; }

# The result is certified, without crossings, and has this volume within a share.
makes() { # NAME, VOLUME, SHARE, FILE, ARGUMENTS...
    makes_name=$1 makes_volume=$2 makes_share=$3 makes_file=$4
    shift 4
    rm -f "$makes_file"
    run "$@" -o "$makes_file" --json
    if [ $status != 0 ] || [ -s err ]; then
        not_ok "$makes_name" "status $status"
        return
    fi
    cp out made.json
    run info "$makes_file" --crossings --json
    if ! grep -q '"closed": true, "manifold": true, "oriented": true' out || [ "$(number crossings)" != 0 ]; then
        not_ok "$makes_name" "not certified: $(cut -c 1-300 out)"
    elif ! awk -v a="$(number volume)" -v b="$makes_volume" -v s="$makes_share" 'BEGIN { d = a - b; exit !((d < 0 ? -d : d) <= s * b) }'; then
        not_ok "$makes_name" "volume $(number volume), not $makes_volume"
    else ok "$makes_name"; fi
    mv made.json out
}
counted() { # NAME, MEMBER, TEST...: of the last report's surface
    counted_name=$1 counted_value=$(number "$2")
    shift 2
    if [ "$counted_value" "$@" ]; then ok "$counted_name"; else not_ok "$counted_name" "$counted_value"; fi
}

# ---- voxelize ----

makes 'a solid has the volume of its mesh' 720 1e-6 a.ply voxelize box.obj --resolution 23
counted 'all of it is on the mesh' half_way -eq 0
makes 'without sharp edges a little less' 718 4e-3 a.stl voxelize box.obj --resolution 23 --no-sharp
makes 'on any origin' 720 1e-6 a.off voxelize box.obj --spacing 0.37 --origin=-1,-2,-1.3
makes 'few triangles' 720 1e-3 b.ply voxelize box.obj --resolution 23 --triangles 60
makes 'the surface voxels end half way' 346 0.02 a.obj voxelize box.obj --resolution 23 --mode conservative
counted 'none of it is on the mesh' on_mesh -eq 0

# ---- morph ----

# The hollow is 7.4 x 6.4 x 5.4 with bevelled edges.
makes 'a hollow box has its wall' 464.3 0.01 h.ply morph hollow box.obj --thickness 1.3 --resolution 46
counted 'its inner wall stands at the thickness' half_way -eq 0
counted 'and has vertices' at_distance -gt 1000
makes 'a drilled one loses a cylinder of the wall' 462.17 1e-3 h.ply morph hollow box.obj --thickness 1.3 --resolution 46 --drain 0.8 --drain-side x-high
makes 'a box that shrank is a box' 431.376 1e-3 s.ply morph erode box.obj --radius 0.7 --resolution 46
makes 'one that grew is round at its edges' 1101.8 1e-3 s.ply morph dilate box.obj --radius 0.7 --resolution 46
counted 'all of it at the radius' half_way -eq 0
makes 'what is opened keeps its faces' 704 5e-3 o.ply morph open box.obj --radius 0.7 --resolution 46
counted 'its edges are half way' half_way -gt 1000
counted 'its faces on the mesh' on_mesh -gt 8000
makes 'steps of voxels end half way' 931 1e-2 o.ply morph dilate box.obj --steps 2 --resolution 46

# ---- grids ----

works 'a grid' voxelize box.obj -o box.bvx --spacing 1 --quiet
makes 'the surface of a grid is half way' 720 0.1 g.ply convert box.bvx
works 'walls' voxelize box.obj -o walls.bvx --spacing 1 --padding 2 --mode thin --quiet
makes 'what they hold' 492.7 0.01 f.ply fill walls.bvx
makes 'the same, by components' 720 0.1 k.ply components box.bvx --keep-largest 1
makes 'with few triangles' 720 0.2 k.ply components box.bvx --keep-largest 1 --error 0.2%
works 'an octree' refine box.obj -o box_tree.bvx --base 4 --halvings 2 --quiet
works 'its surface' convert box_tree.bvx -o tree.obj --quiet
printf '%s\n' '0 0 0' '1 0 0' '2 0 0' '0 1 0' >points.xyz
makes 'voxels of a cloud' 2 1 p.ply voxelize points.xyz --spacing 1 --padding 1

# ---- refusals ----

refuses 2 'the result is a grid' morph dilate box.obj -o x.npy --steps 1 --triangles 9
refuses 2 'the result is a grid' voxelize box.obj -o x.npy --sharp
refuses 2 '--sharp and --no-sharp' voxelize box.obj -o x.ply --sharp --no-sharp
refuses 2 '--sharp is for solids' voxelize box.obj -o x.ply --mode thin --sharp
refuses 2 '--sharp is for meshes' voxelize points.xyz -o x.ply --spacing 1 --sharp
refuses 2 'nor in a mesh format' voxelize box.obj -o x.csl
refuses 2 'makes a grid of a mesh' convert box.obj -o x.npy
refuses 2 'would hold voxels' convert box.bvx -o x.npy --normals
"$program" voxelize box.obj -o grid.bvx --resolution 20 --quiet
refuses 2 '--sharp is for meshes; grid.bvx is a grid' morph dilate grid.bvx -o x.ply --sharp
refuses 2 '--no-sharp is for meshes; grid.bvx is a grid' morph hollow grid.bvx -o x.ply --thickness 1 --no-sharp
refuses 2 'distances are written as' morph distance box.obj -o x.ply
refuses 1 'there is no surface to write' components box.bvx -o x.ply --at-least 5000
counts
