#!/bin/sh
# command_line.sh - an afternoon with the program: what is this mesh, its voxels, levels for a game, what was lost, pictures.
# Takes the program from BITVOX, a mesh as first word; leaves its files in a folder of its own.
set -eu
bitvox=${BITVOX:-build/bitvox}
mesh=${1:-fixtures/knot.ply}
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT

"$bitvox" info "$mesh"                                                   # closed? manifold? how large?
"$bitvox" voxelize "$mesh" -o "$out/solid.bvx" --resolution 128          # the solid, with its place in the world
"$bitvox" convert "$out/solid.bvx" -o "$out/solid.npy"                   # for NumPy; solid.npy.json keeps the lattice
"$bitvox" convert "$out/solid.npy" -o "$out/solid.nrrd"                  # for 3D Slicer, ParaView, ITK
"$bitvox" compare "$out/solid.bvx" "$out/solid.nrrd"                     # nothing was lost on the way
"$bitvox" lod "$out/solid.bvx" -o "$out/level_%d.glb" --levels 64,32,16  # closed meshes for an engine
"$bitvox" lod "$mesh" -o "$out/fine_%d.ply" --triangles 4000,1000       # edges of the mesh itself collapse
"$bitvox" simplify "$mesh" -o "$out/near.ply" --error 0.05%             # as few triangles as that distance allows
"$bitvox" compare "$mesh" "$out/fine_1.ply"                              # how far the coarsest lies from the mesh
"$bitvox" render "$out/solid.bvx" -o "$out/cut.png" --cut z=0            # look inside
"$bitvox" render "$mesh" "$out"/fine_*.ply -o "$out/levels.png" --wireframe
"$bitvox" info "$out/solid.nrrd" --json | grep -q '"set"'                # for scripts
ls -l "$out"
