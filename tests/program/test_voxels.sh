#!/bin/sh
# test_voxels.sh [PROGRAM] - surfaces, rules that fill, faces of voxels and refinement by the bitvox program: voxelize, faces,
# refine, fill, and the rules in lod and render. PROGRAM is build/bitvox, or what BITVOX names. One line a check, "ok NAME" or
# "not ok NAME"; the last line is "N passed, N failed[, N skipped]". Runs in the repository's root, works in a folder of its own.
set -u
. tests/tools/program_checks.sh
meshes=$root/../shared/meshes

warns() { # WORDS, ARGUMENTS...: status 0 and a warning with these words
    words=$1
    shift
    run "$@"
    if [ $status = 0 ] && ! grep -v -q '^bitvox: warning: ' err && grep -q -F -e "$words" err; then ok "warned: $*"
    else not_ok "warned: $*" "status $status, wanted a warning with '$words'"; fi
}

says() { grep -q -E -e "$1" out; } # PATTERN
set_of() { "$program" info "$1" 2>/dev/null | awk '$1 == "voxels" { print $2 }'; }
differ() { ! cmp -s "$1" "$2"; }
sets() { # COUNT, ARGUMENTS...: voxelize sets so many voxels, whatever it warns of
    sets_count=$1
    shift
    run voxelize "$@" -o sets.bvx
    if [ $status = 0 ] && [ "$(set_of sets.bvx)" = "$sets_count" ]; then ok "$sets_count voxels: $*"
    else not_ok "$sets_count voxels: $*" "status $status, $(set_of sets.bvx) voxels"; fi
}
inside() { # NAME, A, B: every voxel of A is one of B
    run compare "$2" "$3"
    if [ $status = 0 ] && says '^  (only in A +none|the same)$'; then ok "$1"; else not_ok "$1" "$(cat out)"; fi
}
same() { # NAME, A, B
    run compare "$2" "$3"
    if [ $status = 0 ] && says '^  the same$'; then ok "$1"; else not_ok "$1" "$(cat out)"; fi
}

# The report of a command, by python3: every expression over r is true. Warnings are the expression's matter.
reports() { # NAME, EXPRESSION, ARGUMENTS...
    reports_name=$1 expression=$2
    shift 2
    if ! has python3; then
        skip "$reports_name" 'python3 is missing'
        return
    fi
    "$program" "$@" --json >out 2>err </dev/null
    if python3 -c 'import json, sys
r = json.load(open("out"))
sys.exit(not (r["status"] == "done" and eval("(" + sys.argv[1] + ")")))' "$expression" 2>>err; then ok "$reports_name"
    else not_ok "$reports_name" "$expression: $(head -c 300 out)"; fi
}

# ---- inputs of our own ----

# The sides of a box of eight corners, z before y before x, round each side; numbers grow by the argument.
low_x='4 1 5
4 5 8'
others='1 3 2
1 4 3
5 6 7
5 7 8
1 2 6
1 6 5
2 3 7
2 7 6
3 4 8
3 8 7'
sides() { awk -v n="$1" '{ print "f", $1 + n, $2 + n, $3 + n }'; }
corners() { # LOW, HIGH X, HIGH Y, HIGH Z
    for z in "$1" "$4"; do printf 'v %s %s %s\nv %s %s %s\nv %s %s %s\nv %s %s %s\n' "$1" "$1" "$z" "$2" "$1" "$z" "$2" "$3" "$z" "$1" "$3" "$z"; done
}
{ corners 0 2 1 1; echo "$others" | sides 0; echo "$low_x" | sides 0; } >box.obj
{ corners 0 2 1 1; echo "$others" | sides 0; } >open.obj
{ corners 0 2 1 1; echo "$others" | sides 0; echo "$low_x" | sides 0 | tail -n 1; } >half.obj
{ corners 0 2 1 1; echo "$others" | sides 0; echo '4 5 1
4 5 8' | sides 0; } >flipped.obj
{ corners 0 16 16 16; corners 6 10 10 10; { echo "$others"; echo "$low_x"; } >all; sides 0 <all; sides 8 <all; } >nested.obj
{ corners 0 16 16 16; corners 0.3 15.7 15.7 15.7; sides 0 <all; sides 8 <all; } >thin_nested.obj
flat() { # HEIGHT, HIGH X
    printf 'v 0 0 %s\nv %s 0 %s\nv %s 4 %s\nv 0 4 %s\nf 1 2 3\nf 1 3 4\n' "$1" "$2" "$1" "$2" "$1" "$1"
}
flat 1 4 >ground.obj
flat 3 4 >upper.obj
flat 3 2 >part.obj
printf 'v 0 0 1\nv 4 0 3\nv 4 4 3\nv 0 4 1\nf 1 2 3\nf 1 3 4\n' >slope.obj
awk '$1 == "v" { print "v", $4, $2, $3; next } { print }' ground.obj >wall.obj

# ---- surfaces ----

# Sides lie on planes between voxels, so closed boxes on either side touch them: 10 x 6 x 6 less 6 x 2 x 2.
sets 336 box.obj --mode conservative --spacing 0.25 --padding 2
for mode in conservative thin sampled; do
    works "voxelize --mode $mode" voxelize "$knot" -o $mode.bvx --mode $mode --resolution 70
    holds "$mode is told" says "^  surface +$mode$"
    works "$mode on one thread" voxelize "$knot" -o again.bvx --mode $mode --resolution 70 --threads 1
    holds "$mode: threads do not show" cmp $mode.bvx again.bvx
    works "a window of $mode" voxelize "$knot" -o direct.bvx --mode $mode --resolution 70 --window 5,6,7,60,50,20
    works "a part of $mode" convert $mode.bvx -o again.bvx --window 5,6,7,60,50,20
    holds "$mode: a window holds the bits of the whole" cmp direct.bvx again.bvx
done
inside 'thin is a part of conservative' thin.bvx conservative.bvx
inside 'sampled is a part of conservative' sampled.bvx conservative.bvx
holds 'thin is less' test "$(set_of thin.bvx)" -lt "$(set_of conservative.bvx)"
works 'sampled again' voxelize "$knot" -o again.bvx --mode sampled --resolution 70
holds 'the mean subdivision coefficient is told' says '^  samples +[0-9]+ of [0-9]+ triangles, mean subdivision coefficient [0-9]+\.[0-9]+$'
reports 'voxelize --mode sampled --json' 'r["surface"]["mode"] == "sampled" and r["surface"]["samples"] > r["surface"]["triangles"] > 0
    and r["surface"]["mean_subdivision"] >= 1 and "solid" not in r and r["warnings"] == []' voxelize "$knot" -o x.bvx --mode sampled --resolution 70
reports 'voxelize --mode thin --json' 'r["surface"] == {"mode": "thin"} and r["set"] > 0' voxelize "$knot" -o x.bvx --mode thin --resolution 70
reports 'an open mesh has a surface' 'r["set"] > 0 and r["warnings"] == []' voxelize ground.obj -o x.bvx --mode conservative --spacing 1
rm -f x.bvx
for option in '--fill parity' '--close-gaps 2' --add-shell '--check-thin always' '--base 1' "--second $knot" '--up z'; do
    # shellcheck disable=SC2086
    refuses 2 'is for solids' voxelize "$knot" -o x.bvx --mode thin $option
done
refuses 2 'one of: solid, conservative, thin, sampled' voxelize "$knot" -o x.bvx --mode thick

# ---- rules ----

for rule in parity nonzero vote flood regions; do
    works "voxelize --fill $rule" voxelize "$knot" -o $rule.bvx --fill $rule --resolution 70
    holds "$rule is told" says "^  fill +$rule$"
    works "$rule on one thread" voxelize "$knot" -o again.bvx --fill $rule --resolution 70 --threads 1
    holds "$rule: threads do not show" cmp $rule.bvx again.bvx
    [ $rule = parity ] || holds "on a closed mesh $rule is parity" cmp $rule.bvx parity.bvx
done
# A hollow in a block: 16 x 16 x 16, less 4 x 4 x 4.
for rule in parity vote regions; do sets 4032 nested.obj --spacing 1 --padding 2 --fill $rule; done
sets 4096 nested.obj --spacing 1 --padding 2 --fill nonzero
sets 4032 nested.obj --spacing 1 --padding 2
reports 'auto keeps cavities and says why' 'r["solid"]["fill"] == "parity" and r["solid"]["reason"] == "nested" and len(r["warnings"]) == 1' \
    voxelize nested.obj -o x.bvx --spacing 1 --padding 2
reports 'nested shells and no voxel are two warnings' 'len(r["warnings"]) == 2 and r["warnings"][0]["code"] == "BVX_WARN_NESTED"' \
    voxelize thin_nested.obj -o x.bvx --spacing 1 --padding 2
# The flood leaves the hollow to the solid, but voxels of its surface vote: 4 x 4 x 4 less 2 x 2 x 2 stay empty.
sets 4096 nested.obj --spacing 1 --padding 2 --fill flood
reports 'regions are counted' 'r["solid"]["fill"] == "regions" and r["solid"]["regions"] == 3 and r["solid"]["mixed_regions"] == 0
    and r["solid"]["mixed_voxels"] == 0 and r["warnings"] == []' voxelize nested.obj -o x.bvx --spacing 1 --padding 2 --fill regions
# One side of the box is missing: every row along x lacks a crossing.
sets 128 box.obj --spacing 0.25 --padding 2
warns '16 rows of centres do not balance' voxelize open.obj -o x.bvx --spacing 0.25 --padding 2
sets 128 open.obj --spacing 0.25 --padding 2 --fill vote
# Copies of a triangle have no volume.
{ cat box.obj; echo 'f 5 6 7'; echo 'f 5 6 7'; } >copies.obj
reports 'copies of triangles take no volume' 'r["warnings"] == []' voxelize copies.obj -o x.bvx --spacing 0.25 --padding 2
# Triangles are missing where rows along x do not pass.
sed '/^f 1 2 6/d; /^f 1 6 5/d' box.obj >aside.obj
warns '32 rows of centres do not balance' voxelize aside.obj -o x.bvx --spacing 0.25 --padding 2
# Half a side is missing: some rows along x do.
for rule in vote regions; do sets 8192 half.obj --spacing 0.0625 --padding 2 --fill $rule; done
warns 'rows of centres do not balance' voxelize open.obj -o x.bvx --spacing 0.25 --padding 2 --fill vote
warns 'regions are not on one side' voxelize half.obj -o x.bvx --spacing 0.0625 --padding 2 --fill regions
reports 'mixed regions are counted' 'r["solid"]["mixed_regions"] == 1 == r["solid"]["regions"] and r["solid"]["mixed_voxels"] > 0
    and len(r["warnings"]) == 2' voxelize half.obj -o x.bvx --spacing 0.0625 --padding 2 --fill regions
rm -f x.bvx
refuses 1 'the surface has holes' voxelize half.obj -o x.bvx --spacing 0.0625 --padding 2 --fill flood
sets 8192 half.obj --spacing 0.0625 --padding 2 --fill flood --close-gaps 16
reports 'closed gaps hold the flood' 'r["solid"]["leaks"] == 0' \
    voxelize half.obj -o x.bvx --spacing 0.0625 --padding 2 --fill flood --close-gaps 16
# Solid and shell: what either has.
sets 360 box.obj --spacing 0.25 --padding 2 --add-shell
sets 360 box.obj --spacing 0.25 --padding 2 --add-shell --fill flood
refuses 2 '--close-gaps needs --fill flood' voxelize box.obj -o x.bvx --close-gaps 3
refuses 2 '--close-gaps needs --fill flood' voxelize box.obj -o x.bvx --close-gaps 3 --fill regions
for rule in flood regions; do refuses 2 'needs the whole lattice' voxelize box.obj -o x.bvx --fill $rule --window 0,0,0,2,2,2; done
refuses 2 'one of: auto, parity, nonzero, vote, flood, regions, below' voxelize box.obj -o x.bvx --fill all

# A wall of 0.4 voxels beside a block, and what is told of it.
{ corners 0 2 2 2; for z in 3.06 3.1; do printf 'v 2.5 2.5 %s\nv 5 2.5 %s\nv 5 5 %s\nv 2.5 5 %s\n' $z $z $z $z; done; sides 0 <all; sides 8 <all; } >plate.obj
{ corners 0 2 2 2; sides 0 <all; } >two.obj
warns "walls thinner than 1.5 voxels are lost where no voxel's centre lies in them: " voxelize plate.obj -o x.bvx --spacing 0.1
holds 'with a place and a remedy' grep -q -E '[0-9]+ voxels, in 2[.]5,2[.]5,3 to 5,5,3[.]1; a resolution of 188 keeps nine tenths of them' err
reports 'thin walls are in the report' 'r["solid"]["thin_checked"] is True and r["solid"]["thin_voxels"] > 500
    and len(r["solid"]["thin_box"]) == 2 and [w["code"] for w in r["warnings"]] == ["BVX_WARN_THIN_LOST", "BVX_WARN_VOXELS"]
    and "volume of 8, the input about 8.25 (-3.03 %)" in r["warnings"][1]["message"] and r["warnings"][0]["place"][0] == [2.5, 2.5, 3]
    and abs(r["solid"]["volume"] - 8) < 0.01' voxelize plate.obj -o x.bvx --spacing 0.1
reports 'and are not looked for with never' 'r["solid"]["thin_checked"] is False and [w["code"] for w in r["warnings"]] == ["BVX_WARN_VOXELS"]' voxelize plate.obj -o x.bvx --spacing 0.1 --check-thin never
reports 'and nothing is told where nothing is missing' 'r["solid"]["thin_checked"] is True and r["solid"]["thin_voxels"] == 0 and "thin_box" not in r["solid"]' voxelize box.obj -o x.bvx --spacing 0.25
reports 'also with always' 'r["solid"]["thin_checked"] is True and r["solid"]["thin_voxels"] == 0' voxelize box.obj -o x.bvx --spacing 0.25 --check-thin always
# Also of very small ones: a plate of two by two voxels.
{ corners 0 2 2 2; for z in 3.06 3.1; do printf 'v 2.5 2.5 %s\nv 2.7 2.5 %s\nv 2.7 2.7 %s\nv 2.5 2.7 %s\n' $z $z $z $z; done; sides 0 <all; sides 8 <all; } >chip.obj
warns "lost where no voxel's centre lies in them: 4 voxels, in 2.5,2.5,3 to 2.7,2.7,3.1" voxelize chip.obj -o x.bvx --spacing 0.1
# Voxels of 1.3 for a cube of 2: eight of them.
warns 'the result has a volume of 17.576, the input about 8 (+120 %); a resolution of 39' voxelize two.obj -o x.bvx --spacing 1.3
# A per cent and no more, also where the mesh's own sum is not known; and of a mesh it is the surface that counts.
{ corners 0 2 2 1.97; sides 0 <all; } >low.obj
warns 'the voxels have a volume of 8, the input about 7.88 (+1.52 %); a resolution of' voxelize low.obj -o x.bvx --spacing 0.1
{ corners 0 2 2 1.97; corners 1 3 3 2.97; sides 0 <all; sides 8 <all; } >lows.obj
warns 'the voxels have a volume of ' voxelize lows.obj -o x.bvx --spacing 0.1
reports 'in the report too' '0.008 < abs(r["solid"]["volume"] / r["solid"]["crossing_volume"] - 1) and "mesh_volume" not in r["solid"] and r["solid"]["volume_resolution"] > 20' voxelize lows.obj -o x.bvx --spacing 0.1
reports 'not of a mesh' 'r["warnings"] == []' voxelize low.obj -o x.ply --spacing 0.1
reports 'nor where all is well' 'r["warnings"] == [] and r["solid"]["volume_resolution"] == 0 and abs(r["solid"]["crossing_volume"] - 8) < 1e-6' voxelize two.obj -o x.bvx --spacing 0.1
rm -f x.bvx
refuses 2 'has no use with --fill below' voxelize box.obj -o x.bvx --fill below --check-thin always

# ---- below ----

sets 16 ground.obj --spacing 1 --fill below --base 0
sets 48 ground.obj --spacing 1 --fill below --base -2
sets 0 ground.obj --spacing 1 --fill below --base 5
sets 16 wall.obj --spacing 1 --fill below --base 0 --up x
sets 32 ground.obj --spacing 1 --fill below --second upper.obj
holds 'fill is told' says '^  fill +32 voxels, volume 32$'
sets 32 upper.obj --spacing 1 --fill below --second ground.obj
holds 'cut is told' says '^  cut +32 voxels, volume 32$'
sets 16 ground.obj --spacing 1 --fill below --second part.obj
reports 'cut and fill in JSON' 'r["solid"]["cut_voxels"] == 0 and r["solid"]["fill_voxels"] == 128
    and r["solid"]["fill_volume"] == 16 and r["lattice"]["dims"] == [8, 8, 4] and r["warnings"] == []' \
    voxelize ground.obj -o x.bvx --spacing 0.5 --fill below --second part.obj
reports 'the lattice goes down to the base' 'r["lattice"]["dims"] == [4, 4, 3] and r["lattice"]["origin"] == [0, 0, -2]' \
    voxelize ground.obj -o x.bvx --spacing 1 --fill below --base -2
rm -f x.bvx
for option in '--base 1' '--second upper.obj' '--up z'; do
    # shellcheck disable=SC2086
    refuses 2 'needs --fill below' voxelize ground.obj -o x.bvx $option
done
refuses 2 'no use with --fill below' voxelize ground.obj -o x.bvx --fill below --add-shell
refuses 2 'not standard input' voxelize ground.obj -o x.bvx --fill below --second -
refuses 2 'is a grid' voxelize ground.obj -o x.bvx --fill below --second sets.bvx
refuses 1 'missing.obj: ' voxelize ground.obj -o x.bvx --fill below --second missing.obj
refuses 2 'a number' voxelize ground.obj -o x.bvx --fill below --base deep
refuses 2 'one of: z, x, y' voxelize ground.obj -o x.bvx --fill below --up w

# ---- rules in lod and render ----

warns 'rows of centres do not balance' lod open.obj -o l_%d.ply --levels 16 --fill vote --samples 0
run info l_0.ply
holds 'lod --fill vote closes the box' says '^  closed +yes'
works 'lod --fill nonzero' lod nested.obj -o l_%d.ply --levels 16 --fill nonzero --samples 0 --quiet
run info l_0.ply
holds 'lod --fill nonzero fills the hollow' says '^  components +1,'
works 'lod --fill vote' lod nested.obj -o l_%d.ply --levels 16 --fill vote --samples 0 --quiet
run info l_0.ply
holds 'lod --fill vote keeps it' says '^  components +2,'
works 'lod --fill flood' lod "$knot" -o l_%d.ply --levels 16 --fill flood --close-gaps 1 --samples 0 --quiet
works 'lod of a terrain' lod slope.obj -o l_%d.ply --levels 8 --fill below --samples 0 --padding 8 --quiet
run info l_0.ply
holds 'what is under a terrain is closed' says '^  closed +yes$'
refuses 2 '--close-gaps needs --fill flood' lod nested.obj -o x_%d.ply --close-gaps 2
refuses 2 'is for meshes' lod sets.bvx -o x_%d.ply --close-gaps 2
rm -f l_0.ply
for rule in parity flood regions vote; do works "render --fill $rule" render nested.obj -o $rule.png --voxels 32 --fill $rule --cut x=8 --size 80x60; done
holds 'render: the hollow shows by vote' cmp parity.png vote.png
holds 'render: and by regions' cmp parity.png regions.png
holds 'render: not by flood' differ parity.png flood.png
refuses 2 '--fill needs --voxels' render nested.obj -o x.png --fill vote
refuses 2 '--close-gaps needs --fill flood' render nested.obj -o x.png --voxels 20 --close-gaps 2

# ---- faces ----

works 'voxels of a box' voxelize box.obj -o box.npy --spacing 0.25 --padding 1
works 'faces of a grid' faces box.npy -o box.ply
holds 'faces are told' says '^  faces +160$'
holds 'so are triangles' says '^  triangles +320 of 162 vertices$'
holds 'and the volume' says '^  volume +2$'
run info box.ply
holds 'faces are closed' says '^  closed +yes$'
holds 'faces are oriented' says '^  oriented +yes$'
works 'merged faces' faces box.npy -o merged.ply --merge
holds 'a box has six sides' says '^  rectangles +6$'
holds 'merged faces have the same volume' says '^  volume +2$'
works 'faces of a mesh' faces box.obj -o direct.ply --spacing 0.25 --padding 1
holds 'faces of a mesh are those of its grid' cmp direct.ply box.ply
works 'faces of the knot' faces "$knot" -o knot.off --resolution 40 --fill vote
works 'on one thread' faces "$knot" -o again.off --resolution 40 --fill vote --threads 1
holds 'faces: threads do not show' cmp knot.off again.off
reports 'faces --json' 'r["command"] == "faces" and r["set"] == 128 and r["meshes"][0]["triangles"] == 12 and abs(r["meshes"][0]["volume"] - 2) < 1e-9
    and "faces" in [s["name"] for s in r["stages"]]' faces box.npy -o x.ply --merge
for format in obj stl glb; do works "faces to $format" faces box.npy -o x.$format; done
rm -f x.*
warns 'rows of centres do not balance' faces open.obj -o x.ply --spacing 0.25 --fill vote
rm -f x.*
for option in '--resolution 5' '--spacing 1' '--padding 1' '--fill vote' '--close-gaps 1'; do
    # shellcheck disable=SC2086
    refuses 2 'is for meshes' faces box.npy -o x.ply $option
done
refuses 2 'a mesh format that can be written' faces box.npy -o x.vti
refuses 1 'has no faces' faces ground.obj -o x.ply

# ---- refine ----

works 'refine' refine "$knot" -o knot.vtu --halvings 3
holds 'refine: a row a level' test "$(grep -c -E '^ +[0-3]  [0-9]+x[0-9]+x[0-9]+ ' out)" = 4
holds 'refine: leaves and their share' says '^[0-9]+ leaves in place of [0-9]+ voxels of one size, [0-9.]+ %'
holds 'refine: a .vtu' sh -c 'head -c 400 knot.vtu | grep -q "VTKFile.*UnstructuredGrid"'
works 'refine on one thread' refine "$knot" -o again.vtu --halvings 3 --threads 1
holds 'refine: threads do not show' cmp knot.vtu again.vtu
reports 'refine --json' 'r["octree"]["levels"] == 3 and max(r["octree"]["base"]) == 8 and max(r["lattice"]["dims"]) == 64 and len(r["octree"]["level"]) == 4
    and r["octree"]["leaves"] == r["octree"]["surface"] + r["octree"]["inside"] + r["octree"]["outside"]
    and all(a["split"] * 8 == b["voxels"] for a, b in zip(r["octree"]["level"], r["octree"]["level"][1:]))
    and r["octree"]["level"][3]["split"] == 0 and r["octree"]["bytes"] > 0 and r["octree"]["uniform_voxels"] % 512 == 0 and "set" not in r' refine "$knot" -o x.vtu --halvings 3
works 'refine to a grid' refine "$knot" -o fine.bvx --halvings 3 --expand 3
works 'the same surface at once' voxelize "$knot" -o direct.bvx --mode conservative --resolution 64
works 'the refined surface' refine "$knot" -o surface.bvx --halvings 3 --expand 3 --states surface
holds 'as many surface voxels as at once' test "$(set_of direct.bvx)" = "$(set_of surface.bvx)"
works 'the same solid at once' voxelize "$knot" -o direct.bvx --fill flood --add-shell --resolution 64
holds 'as many voxels as at once' test "$(set_of direct.bvx)" = "$(set_of fine.bvx)"
works 'other bases, other levels' refine "$knot" -o again.bvx --base 16 --halvings 2 --expand 2
holds 'base and levels do not show in the voxels' test "$(set_of again.bvx)" = "$(set_of fine.bvx)"
works 'the inside' refine "$knot" -o inner.bvx --halvings 3 --expand 3 --states inside
works 'the outside' refine "$knot" -o outer.bvx --halvings 3 --expand 3 --states outside
works 'all of it' refine "$knot" -o all.bvx --halvings 3 --expand 3 --states outside,surface,inside
run info all.bvx
holds 'every voxel has a state' says ', 100 % of all$'
holds 'every voxel has one state' test $(($(set_of inner.bvx) + $(set_of outer.bvx) + $(set_of surface.bvx))) = "$(set_of all.bvx)"
works 'a lower level' refine "$knot" -o low.bvx --halvings 3 --expand 1
run info low.bvx
holds 'it has its own lattice' says '^  dims +16 x '
works 'no level at all' refine "$knot" -o flat.npy --halvings 0 --base 20
run info flat.npy
holds 'the base alone' says '^  dims +20 x '
works 'a fine window' refine "$knot" -o window.bvx --halvings 3 --expand 3 --window 8,8,8,40,40,16
works 'the window of the whole' convert fine.bvx -o part.bvx --window 8,8,8,40,40,16
same 'a window is as fine as the whole' window.bvx part.bvx
reports 'outside of it voxels are coarse' 'r["octree"]["level"][0]["surface"] > 0' refine "$knot" -o x.vtu --halvings 3 --window 8,8,8,40,40,16
reports 'or halved as often as asked for' 'r["octree"]["level"][0]["surface"] == r["octree"]["level"][1]["surface"] == 0 < r["octree"]["level"][2]["surface"]' \
    refine "$knot" -o x.vtu --halvings 3 --window 8,8,8,40,40,16 --outer-levels 2
reports 'flat places are not halved' 'r["octree"]["level"][1]["surface"] + r["octree"]["level"][2]["surface"] > 0' refine "$knot" -o x.vtu --halvings 3 --adaptive 0.05
reports 'a hollow is inside' 'r["set"] == 16 ** 3 and r["octree"]["inside"] > 0 == r["octree"]["outside"]' refine nested.obj -o x.bvx --halvings 2 --expand 2 --base 4
rm -f x.*
refuses 2 'a format that octrees can be written to' refine "$knot" -o x.xyz
refuses 2 'is a grid' refine fine.bvx -o x.vtu
works 'refine to a mesh' refine "$knot" -o fine.ply --halvings 3
run info fine.ply
holds 'the mesh of the last level is closed' says '^  closed +yes$'
works 'the mesh of its grid' lod fine.bvx -o l_%d.ply --levels 64 --samples 0
run info l_0.ply
holds 'it is the surface of the expanded grid' test "$(awk '$1 == "triangles" { print $2 }' out)" = "$("$program" info fine.ply | awk '$1 == "triangles" { print $2 }')"
rm -f x.*
# ---- the base and the levels that follow from a resolution ----

works 'refine --resolution' refine "$knot" -o auto.npy --resolution 64
works 'refine --halvings auto' refine "$knot" -o again.npy --resolution 64 --halvings auto
holds 'a resolution alone chooses the levels' cmp auto.npy again.npy
works 'refine --resolution with levels' refine "$knot" -o again.npy --resolution 64 --halvings 3
holds 'the choice does not show in the voxels' test "$(set_of auto.npy)" = "$(set_of again.npy)"
reports 'the last level has at least the resolution' '300 <= max(r["lattice"]["dims"]) < 300 + 2 ** r["octree"]["levels"]' refine "$knot" -o x.vtu --resolution 300
reports 'levels that are given' 'max(r["lattice"]["dims"]) == 304 and max(r["octree"]["base"]) == 19' refine "$knot" -o x.vtu --resolution 300 --halvings 4
reports 'windows are found in deep lattices' 'max(r["lattice"]["dims"]) == 65536 and max(r["octree"]["base"]) <= 128 and r["octree"]["level"][-1]["surface"] >= 0' \
    refine "$knot" -o x.bvx --resolution 65536 --window 1000,1000,1000,1100,1100,1100
rm -f x.*
refuses 2 'needs --resolution' refine "$knot" -o x.vtu --halvings auto
refuses 2 'contradict' refine "$knot" -o x.vtu --resolution 64 --base 8
refuses 2 'or auto' refine "$knot" -o x.vtu --halvings most

# ---- octrees as files ----

works 'refine to an octree' refine "$knot" -o tree.bvx --halvings 3
works 'refine to an octree on one thread' refine "$knot" -o again.bvx --halvings 3 --threads 1
holds 'threads do not show in an octree' cmp tree.bvx again.bvx
works 'info of an octree' info tree.bvx
holds 'info tells a row a level' test "$(grep -c -E '^ +[0-3]  [0-9]+x[0-9]+x[0-9]+ ' out)" = 4
reports 'info --json of an octree' 'r["octree"]["levels"] == 3 and max(r["lattice"]["dims"]) == 64 and r["octree"]["leaves"] > 0 and "milliseconds" not in r["octree"]' info tree.bvx
works 'an octree to leaves' convert tree.bvx -o again.vtu
holds 'its leaves are those that are refined' cmp knot.vtu again.vtu
works 'refine takes an octree' refine tree.bvx -o again.vtu
holds 'and writes the same' cmp knot.vtu again.vtu
works 'an octree to a grid' convert tree.bvx -o again.bvx --expand 3
holds 'the grid of its last level' cmp fine.bvx again.bvx
works 'an octree to the grid of a coarser level' convert tree.bvx -o again.bvx --expand 1
holds 'the grid of that level' cmp low.bvx again.bvx
works 'an octree to a part of a grid' convert tree.bvx -o again.npy --window 8,8,8,40,40,16 --states surface,inside
same 'the part' again.npy part.bvx
works 'an octree to itself' convert tree.bvx -o again.bvx
holds 'it is the same file' cmp tree.bvx again.bvx
gzip -c tree.bvx >tree.bvx.gz
works 'a packed octree' convert tree.bvx.gz -o again.bvx
holds 'it is the same file unpacked' cmp tree.bvx again.bvx
works 'an octree to a mesh' refine tree.bvx -o again.ply
holds 'the mesh of its last level' cmp fine.ply again.ply
works 'a picture of an octree' render tree.bvx -o tree.png --size 64x48
works 'a picture of its grid' render fine.bvx -o again.png --size 64x48
holds 'they are the same' cmp tree.png again.png
works 'a picture of a coarser level' render tree.bvx -o again.png --size 64x48 --expand 1
holds 'a coarser picture' differ tree.png again.png
works 'an octree where a grid is read' lod tree.bvx -o l_%d.ply --levels 16 --samples 0
same 'an octree is the grid of its last level' tree.bvx fine.bvx
head -c 1000 tree.bvx >cut.bvx
{ head -c 300 tree.bvx; printf x; tail -c +302 tree.bvx; } >changed.bvx
refuses 1 'the file ends before' info cut.bvx
refuses 1 'is damaged, its checksum differs' convert changed.bvx -o x.vtu
refuses 2 'is for meshes' refine tree.bvx -o x.vtu --halvings 2
refuses 2 'is for meshes' refine tree.bvx -o x.vtu --adaptive 1
refuses 2 'is a grid' refine fine.bvx -o x.vtu
refuses 2 'is only for grids' refine tree.bvx -o x.vtu --window 0,0,0,8,8,8
refuses 2 'is only for grids' convert tree.bvx -o x.vtu --window 0,0,0,8,8,8
refuses 2 'holds the whole octree' refine "$knot" -o x.bvx --states inside
refuses 2 'is beyond the last level' convert tree.bvx -o x.npy --expand 4
refuses 2 'are for octrees' convert fine.bvx -o x.npy --expand 1
refuses 2 'are for octrees' convert fine.bvx -o x.vtu
refuses 2 'is not an octree' convert box.npy -o x.vtu
refuses 2 'is for grids' convert box.obj -o x.ply --expand 1
refuses 2 'is for octrees' render fine.bvx -o x.png --expand 1
refuses 2 'is for octrees' render box.obj -o x.png --expand 1
rm -f x.*

# ---- fill ----

works 'walls to fill' voxelize nested.obj -o walls.bvx --mode conservative --resolution 32 --padding 2
run fill walls.bvx -o pockets.bvx
holds 'fill finds the pockets of both shells' says '^  pockets +2$'
works 'one of them' fill walls.bvx -o shell.bvx --mesh nested.obj
holds 'the inner shell is hollow' says '^  pockets +1$'
inside 'a hollow less' shell.bvx pockets.bvx
reports 'fill --json' 'r["fill"]["pockets"] == len(r["fill"]["seeds"]) == 1 and not r["fill"]["reaches_side"] and r["fill"]["search"]["verified"]
    and r["fill"]["search"]["i"] >= 1 and r["fill"]["search"]["j"] >= 1 and r["fill"]["search"]["k"] >= 1 and r["set"] == r["fill"]["filled"] > 0' \
    fill walls.bvx -o x.bvx --mesh nested.obj
works 'fill with the walls' fill walls.bvx -o full.bvx --add-shell
works 'the flood at once' voxelize nested.obj -o direct.bvx --fill flood --add-shell --resolution 32 --padding 2
same 'pockets and walls are what the flood leaves' full.bvx direct.bvx
works 'fill from a seed' fill walls.bvx -o seeded.bvx --seed 16,16,16
reports 'seeds that are given' 'r["fill"]["given"] == 2 and r["fill"]["seeds"] == [[16, 16, 16], [4, 4, 4]] and "search" not in r["fill"]' \
    fill walls.bvx -o both.bvx --seed 16,16,16,4,4,4
same 'two seeds fill two pockets' both.bvx pockets.bvx
warns "reaches the window's sides" fill walls.bvx -o outside.bvx --seed 0,0,0
works 'a file of one wall' voxelize ground.obj -o wall.bvx --mode conservative --spacing 0.5 --padding 1
rm -f x.*
refuses 1 'enclose no pocket' fill wall.bvx -o x.bvx
refuses 1 'seed 0' fill walls.bvx -o x.bvx --seed 999,0,0
refuses 2 'three numbers a seed' fill walls.bvx -o x.bvx --seed 1,2,3,4
refuses 2 'is a mesh' fill box.obj -o x.bvx
refuses 2 '--mesh takes a mesh' fill walls.bvx -o x.bvx --mesh fine.bvx
refuses 2 'no use with --seed' fill walls.bvx -o x.bvx --mesh box.obj --seed 1,1,1
refuses 2 'one of: 6, 18, 26' fill walls.bvx -o x.bvx --connectivity 8
refuses 2 'in a grid format that can be written' fill walls.bvx -o x.csl

# ---- morph ----

works 'a body to change' voxelize nested.obj -o body.bvx --resolution 32 --padding 4 --fill parity
for action in dilate erode open close; do
    works "morph $action" morph $action body.bvx -o $action.bvx --neighbourhood 18 --steps 2
done
inside 'what is eroded is a part of what is opened' erode.bvx open.bvx
inside 'what is opened is a part of the body' open.bvx body.bvx
inside 'the body is a part of what is closed' body.bvx close.bvx
inside 'what is closed is a part of what is dilated' close.bvx dilate.bvx
works 'a ball of one voxel' morph dilate body.bvx -o ball.bvx --radius 0.5
works 'neighbours across faces' morph dilate body.bvx -o cross.bvx
same 'a ball of one voxel is a cross' ball.bvx cross.bvx
works 'a mesh makes room for what is added' morph dilate nested.obj -o roomy.bvx --resolution 32 --radius 1.5 --fill parity
holds 'three voxels on each side' says '^  dims +38 x 38 x 38$'
works 'a body without room' voxelize nested.obj -o near.bvx --resolution 32 --padding 1 --fill parity
warns "reaches the grid's sides" morph dilate near.bvx -o x.bvx --steps 2
reports 'morph hollow' 'r["morph"]["action"] == "hollow" and r["morph"]["hollowed"] == r["morph"]["before"] - r["morph"]["after"] - r["morph"]["drained"] > 0
    and r["morph"]["drained"] > 4 and abs(r["morph"]["drain"][2] - 1.25) < 1e-9' \
    morph hollow body.bvx -o shell.bvx --thickness 1 --drain 0.8
inside 'a shell is a part of the body' shell.bvx body.bvx
warns 'nothing was hollowed out' morph hollow body.bvx -o x.bvx --thickness 50
for ending in npy nrrd vti; do
    works "distances as .$ending" morph distance body.bvx -o distance.$ending --side signed --value-type f64
done
reports 'morph distance' 'r["morph"]["side"] == "inside" and r["morph"]["least"] == 0 and r["morph"]["greatest"] > 2' \
    morph distance body.bvx -o x.npy --side inside --beyond empty
rm -f x.*
refuses 2 "did you mean 'erode'" morph erod body.bvx -o x.bvx
refuses 2 'unknown action' morph body.bvx erode -o x.bvx
refuses 2 '--radius replaces' morph erode body.bvx -o x.bvx --radius 1 --steps 2
refuses 2 'no use for --thickness' morph erode body.bvx -o x.bvx --thickness 1
refuses 2 'needs --thickness' morph hollow body.bvx -o x.bvx
refuses 2 'is for meshes' morph open body.bvx -o x.bvx --resolution 64
refuses 2 'written as .npy, .nrrd, .vti, .vdb or .nvdb' morph distance body.bvx -o x.bvx
refuses 2 'is for distances' morph erode body.bvx -o x.bvx --beyond nothing
refuses 2 'one of: 6, 18, 26' morph erode body.bvx -o x.bvx --neighbourhood 8

# ---- what refine refuses ----

refuses 2 '--expand is only for grids' refine "$knot" -o x.vtu --expand 2
refuses 2 'beyond the last level' refine "$knot" -o x.bvx --expand 4 --halvings 3
refuses 2 'beyond the last level' refine "$knot" -o x.bvx --halvings 3 --expand 3 --window 0,0,0,9,9,9 --outer-levels 4
refuses 2 '--outer-levels needs --window' refine "$knot" -o x.vtu --outer-levels 2
refuses 2 'one or more of outside, inside, surface' refine "$knot" -o x.vtu --states inner
refuses 2 'one or more of' refine "$knot" -o x.vtu --states inside,inside
refuses 2 'one or more of' refine "$knot" -o x.vtu --states inside,
refuses 2 'from 0 to 25' refine "$knot" -o x.vtu --halvings 26
refuses 1 'levels fit' refine "$knot" -o x.vtu --halvings 25 --base 8
refuses 1 'MiB' refine "$knot" -o x.bvx --halvings 9 --expand 9 --base 8
refuses 1 'limit' refine "$knot" -o x.vtu --halvings 9 --memory-limit 20M

# ---- real meshes ----

if [ -d "$meshes" ]; then
    warns 'rows of centres do not balance' voxelize "$meshes/bunny_scan_69451.ply.gz" -o bunny.bvx --fill vote --resolution 128
    warns 'rows of centres do not balance' voxelize "$meshes/bunny_scan_69451.ply.gz" -o again.bvx --fill regions --resolution 128
    same 'holes of the scan join all regions, so each voxel votes' bunny.bvx again.bvx
    works 'a real terrain' voxelize "$meshes/terrain_turbineSiting.stl.gz" -o terrain.bvx --fill below --base 900 --resolution 200
    works 'open sheets, many in one voxel' refine "$meshes/motorBike.obj.gz" -o bike.bvx --base 16 --halvings 3 --expand 3 --states surface
    works 'the same at once' voxelize "$meshes/motorBike.obj.gz" -o again.bvx --mode conservative --resolution 128
    holds 'refined open sheets are those at once' test "$(set_of bike.bvx)" = "$(set_of again.bvx)"
else
    skip 'real meshes' '../shared/meshes is missing'
fi

# ---- one point far from the others ----

# A cloud and a mesh with one more, a million away, which leaves the others less than one voxel.
{ cat "$root/fixtures/ball.xyz" && echo '1000000 3 2'; } >far.xyz
points=$(grep -c '^[-0-9]' "$root/fixtures/ball.xyz")
run convert "$knot" -o far.obj
vertices=$(grep -c '^v ' far.obj)
printf 'v 1000000 0 0\nv 1000000 1 0\nv 1000000 0 1\nf %d %d %d\n' $((vertices + 1)) $((vertices + 2)) $((vertices + 3)) >>far.obj
warns "point $points at 1000000, 3, 2 lies far from most others, which are" voxelize far.xyz -o x.bvx --resolution 128
warns 'voxels long; take it out of the file, or choose voxels by --spacing' voxelize far.xyz -o x.bvx --resolution 128
far="point $vertices at 1000000, 0, 0 lies far from most others"
warns "$far" voxelize far.obj -o x.nrrd --resolution 128 --mode field
refuses 1 "point $points at 1000000, 3, 2 lies far from most others: a lattice around all" voxelize far.xyz -o x.bvx --spacing 0.05 --body
refuses 1 'take it out of the file, or allow so much by --memory-limit' voxelize far.xyz -o x.bvx --spacing 0.05
refuses 1 "$far" voxelize far.obj -o x.bvx --spacing 0.05
refuses 1 "$far" voxelize far.obj -o x.bvx --spacing 0.05 --mode thin
refuses 1 "$far" voxelize far.obj -o x.nrrd --spacing 0.05 --mode field
refuses 1 "$far" faces far.obj -o x.ply --spacing 0.05
refuses 1 "$far" morph dilate far.obj -o x.bvx --spacing 0.05
works 'far away: a window of it' voxelize far.obj -o x.bvx --spacing 0.05 --window 0,0,0,100,100,40 --fill parity --quiet
run voxelize far.obj -o x.bvx --resolution 64 --quiet
result 'far away: a resolution' $status
printf 'v 0 0 0\nv 100000 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n' >long.obj
works 'a long body is no far point' voxelize long.obj -o x.bvx --spacing 0.1 --window 0,0,0,64,4,4 --quiet

counts
