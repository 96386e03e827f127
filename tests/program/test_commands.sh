#!/bin/sh
# test_commands.sh [PROGRAM] - what each command of the bitvox program does: convert, compare, info, voxelize, lod, render.
# PROGRAM is build/bitvox, or what BITVOX names. One line a check, "ok NAME" or "not ok NAME"; the last line is
# "N passed, N failed[, N skipped]". Runs in the repository's root, works in a folder of its own.
# How the program speaks, refuses and cleans up in general is test_program.sh's.
set -u
. tests/tools/program_checks.sh

warns() { # WORDS, ARGUMENTS...: status 0 and one warning with these words
    words=$1
    shift
    run "$@"
    if [ $status = 0 ] && [ "$(wc -l <err)" = 1 ] && grep '^bitvox: warning: ' err | grep -q -F -e "$words"; then ok "warned: $*"
    else not_ok "warned: $*" "status $status, wanted a warning with '$words'"; fi
}

says() { grep -q -E -e "$1" out; } # PATTERN
hash_of() { "$program" info "$1" 2>/dev/null | awk '$1 == "hash" { print $2 }'; }
place_of() { "$program" info "$1" 2>/dev/null | grep -E '^  (spacing|origin|center0)'; }
differ() { ! cmp -s "$1" "$2"; }

# The report of a command, by python3: every expression over r is true.
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
sys.exit(not (r["status"] == "done" and eval("(" + sys.argv[1] + ")")))' "$expression" 2>>err && [ ! -s err ]; then ok "$reports_name"
    else not_ok "$reports_name" "$expression: $(head -c 300 out)"; fi
}

# ---- inputs of our own ----

# A box of 2 x 1 x 1 whose corners are red below x = 1 and blue above it, with and without its colours; and one with a
# texture coordinate at each corner.
faces='f 1 3 2
f 1 4 3
f 5 6 7
f 5 7 8
f 1 2 6
f 1 6 5
f 2 3 7
f 2 7 6
f 3 4 8
f 3 8 7
f 4 1 5
f 4 5 8'
corners() { # BEHIND AT LOW X, BEHIND AT HIGH X
    for z in 0 1; do printf 'v 0 0 %s%s\nv 2 0 %s%s\nv 2 1 %s%s\nv 0 1 %s%s\n' $z "$1" $z "$2" $z "$2" $z "$1"; done
}
{ corners ' 1 0 0' ' 0 0 1'; echo "$faces"; } >red_blue.obj
{ corners '' ''; echo "$faces"; } >plain.obj
{ corners '' ''; printf 'vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n'; echo "$faces" | sed 's/ \([0-9]\)/ \1\/\1/g'; } >uv.obj

# ---- info ----

works 'info of colours' info red_blue.obj
holds 'info: colours of vertices' says '^  colours +of vertices'
works 'info of texture coordinates' info uv.obj
holds 'info: texture coordinates' says '^  texture +coordinates of'
run info plain.obj
holds 'info: neither' sh -c '! grep -q -E "colours|texture" out'
reports 'info --json: colours' 'r["meshes"][0]["colours"] is True and r["meshes"][0]["texture_coordinates"] is False' info red_blue.obj
reports 'info --json: texture coordinates' 'r["meshes"][0]["colours"] is False and r["meshes"][0]["texture_coordinates"] is True' info uv.obj

printf 'v 0 0 0\nv 4 0 0\nv 0 4 0\nv 1 1 -1\nv 1 1 1\nv 2 1 1\nf 1 2 3\nf 4 5 6\nf 1 2 6\n' >crossing.obj
works 'info --crossings' info crossing.obj --crossings
holds 'info: pairs that cross' says '^  crossings +1 pairs of triangles'
reports 'info --json: pairs that cross' 'r["meshes"][0]["crossings"] == 1' info crossing.obj --crossings
reports 'info --json: no pair crosses' 'r["meshes"][0]["crossings"] == 0' info plain.obj --crossings
reports 'info --json: crossings are not counted' '"crossings" not in r["meshes"][0]' info crossing.obj

works 'info --measure' info plain.obj --measure
holds 'info: the element of MuJoCo' says '^  MJCF +<inertial pos="[-0-9.e+ ]+" mass="[0-9.e+-]+" fullinertia="[-0-9.e+ ]+"/>'
reports 'info --json: a mass of its density' 'abs(r["mass"]["mass"] - 4 * r["mass"]["volume"]) < 1e-9 and r["mass"]["volume_error"] >= 0 and r["mass"]["urdf"].startswith("<inertial><origin")' info plain.obj --measure --density 4
reports 'info --json: no mass' '"mass" not in r' info plain.obj
refuses 2 'density is used with --measure' info plain.obj --density 4
refuses 2 'resolution is used with --measure' info plain.obj --resolution 4
refuses 2 '--measure is used with meshes' info "$root/fixtures/waves.raw" --shape 2,2,2 --sample-type u8 --measure
# ---- check: a box of 2 with a hollow of 1, its walls 0.5; a second one 0.25 above it ----

{
    for z in 0 2; do for y in 0 2; do for x in 0 2; do echo "v $x $y $z"; done; done; done
    for z in 0.5 1.5; do for y in 0.5 1.5; do for x in 0.5 1.5; do echo "v $x $y $z"; done; done; done
    for z in 2.25 3.25; do for y in 0 1; do for x in 0 1; do echo "v $x $y $z"; done; done; done
    for face in '1 3 4' '1 4 2' '5 6 8' '5 8 7' '1 2 6' '1 6 5' '3 7 8' '3 8 4' '1 5 7' '1 7 3' '2 4 8' '2 8 6'; do
        # shellcheck disable=SC2086
        set -- $face
        echo "f $1 $2 $3"
        echo "f $(($1 + 8)) $(($3 + 8)) $(($2 + 8))"
        echo "f $(($1 + 16)) $(($2 + 16)) $(($3 + 16))"
    done
} >hollow.obj
report_of='r["check"]["sound"] and abs(r["check"]["volume"] - 8) < 1e-9 and abs(r["check"]["mass"] - 16) < 1e-9 and abs(r["check"]["least_thickness"] - 0.5) < 1e-9 and abs(r["check"]["least_gap"] - 0.25) < 1e-9'
run check hollow.obj --walls 0.4 --resolution 64
holds 'check: what is wrong is the error' grep -q '^bitvox: hollow.obj: cavities: 1$' err
run check hollow.obj --walls 0.6 --gaps 0.3 --resolution 64 --density 2 --json -o hollow.ply
holds 'check: status 1' [ $status = 1 ]
if has python3; then
    holds 'check --json: what is measured' python3 -c "import json; r = json.load(open('out')); assert $report_of, r"
    holds 'check --json: faults and places' python3 -c '
import json
r = json.load(open("out"))
c = r["check"]
assert r["status"] == "failed" and r["error"]["code"] == "CHECK" and r["error"]["message"] == "hollow.obj: thin walls: 6, gaps: 1, cavities: 1", r["error"]
assert c["faults"] == 8 and c["island"]["count"] == 1 and abs(c["island"]["places"][0]["area"] - 1) < 0.1, c
assert abs(c["cavity_volume"] - 1) < 0.1 and all(abs(x - 1) < 0.6 for x in c["cavity"]["places"][0]["position"]), c'
fi
reports 'check -o: thin walls are red' 'r["meshes"][0]["colours"] is True' info hollow.ply
works 'check: nothing wrong' check plain.obj --resolution 16
holds 'check: says so' says 'no fault found'
run check crossing.obj --resolution 16
holds 'check: open edges are a fault' sh -c "[ $status = 1 ] && grep -q '^bitvox: crossing.obj: not sound: open edges' err"
refuses 2 'this format has no colours' check plain.obj -o x.stl
refuses 2 'check is for meshes' check "$root/fixtures/labels.npy"
refuses 2 'walls' check plain.obj --walls -1
refuses 2 'up' check plain.obj --up w

works 'voxelize' voxelize plain.obj -o box.npy --spacing 0.25 --padding 2
holds 'voxelize writes a side-car' test -s box.npy.json
refuses 2 'box.npy is not a mesh' info box.npy --crossings
refuses 2 'waves.raw is not a mesh' info "$root/fixtures/waves.raw" --shape 2,2,2 --sample-type u8 --crossings
# A model of MagicaVoxel: one voxel of colour 5. A file of bitvox has no colours.
printf 'VOX \226\0\0\0MAIN\0\0\0\0\054\0\0\0SIZE\014\0\0\0\0\0\0\0\001\0\0\0\001\0\0\0\001\0\0\0XYZI\010\0\0\0\0\0\0\0\001\0\0\0\0\0\0\005' >five.vox
warns 'five.vox: the colours of its voxels are not kept' convert five.vox -o six.vox
works 'a .vox without colours' convert six.vox -o again.vox
holds 'without a word' test ! -s err
works 'its faces are of that colour' faces five.vox -o five.glb
holds 'which the palette of files without one has' grep -q -a -F '"name":"#ffff33"' five.glb
works 'and come back as labels of a mesh' voxelize five.glb -o back.vox --resolution 2
holds 'with the colour in a palette' sh -c "od -An -v -tx1 back.vox | tr -d ' \n' | grep -q 524742410004000000000000ffff33ff"
works 'as segments too' voxelize five.glb -o back.nrrd --segments --resolution 2
holds 'with the colour as they have it' grep -q -a '^Segment0_Color:=1 1 0.2$' back.nrrd
refuses 1 'neither colours of its vertices nor materials' voxelize "$knot" -o plain.nrrd --segments --resolution 4
refuses 2 'labels are written as .nrrd or .vox' voxelize five.glb -o back.npy --segments
works 'info of a grid' info box.npy
holds 'info: dims' says '^  dims +12 x 8 x 8$'
holds 'info: voxels and share' says '^  voxels +128 set, 16.7 % of all$'
holds 'info: spacing' says '^  spacing +0.25, 0.25, 0.25$'
holds 'info: low corner' says '^  origin +-0.5, -0.5, -0.5$'
holds 'info: centre of the first voxel' says '^  center0 +-0.375, -0.375, -0.375$'
holds 'info: box of the set voxels' says '^  box +8 x 4 x 4 voxels from 2,2,2$'
holds 'info: volume' says '^  volume +2$'
holds 'info: hash' says '^  hash +[0-9a-f]{16}$'
reports 'info --json of a grid' 'r["set"] == 128 and r["lattice"]["dims"] == [12, 8, 8] and r["lattice"]["origin"] == [-0.5] * 3
    and r["lattice"]["spacing"] == [0.25] * 3 and r["grid"]["center0"] == [-0.375] * 3 and r["grid"]["box"] == {"low": [2, 2, 2], "size": [8, 4, 4]}
    and r["grid"]["volume"] == 2 and r["grid"]["lattice_known"] is True and len(r["grid"]["hash"]) == 16 and r["meshes"] == []' info box.npy
cp box.npy alone.npy
works 'a missing side-car is fine' info alone.npy
holds 'a missing side-car is said' says '^  spacing +1, 1, 1 .*no side-car'
reports 'a missing side-car in JSON' 'r["grid"]["lattice_known"] is False' info alone.npy
echo '{' >alone.npy.json
refuses 1 'alone.npy.json: ' info alone.npy
sed 's/12/13/' box.npy.json >alone.npy.json
refuses 1 'alone.npy.json: ' info alone.npy
rm alone.npy.json
mkdir alone.npy.json
refuses 1 'alone.npy.json: ' info alone.npy
rmdir alone.npy.json
refuses 1 'a mesh or grid format that can be read' info box
if has gzip; then
    gzip -c box.npy >packed.npy.gz
    cp box.npy.json packed.npy.json
    run info packed.npy.gz
    if grep -q 'made without zlib' err; then skip 'a packed grid' 'there is no zlib'
    else holds 'a packed grid and its side-car' says '^  origin +-0.5, -0.5, -0.5$'; fi
fi
"$program" info - --format npy <box.npy >out 2>err
holds 'a grid from standard input' says '^  voxels +128 set'

# ---- convert: grids ----

works 'voxelize the knot' voxelize "$knot" -o knot.npy --resolution 60 --padding 1
before=knot.npy
for format in bvx nrrd vti binvox npy vox bvx npy; do
    works "convert ${before##*.} to $format" convert $before -o next_$before.$format
    before=next_$before.$format
    holds "the $format holds the same bits and lattice" test "$(hash_of $before)" = "$(hash_of knot.npy)"
    works "the $format compares" compare knot.npy $before
    holds "the $format is the same" says '^  the same$'
done
holds 'the last .npy is the first one' cmp $before knot.npy
holds 'and so is its side-car' cmp $before.json knot.npy.json
rm -f next_*
works 'convert --window' convert knot.npy -o part.npy --window 10,12,4,40,45,20
holds 'a window is told' says '^  window +from 10,12,4 of a lattice of '
works 'a window of a window' convert part.npy -o corner.bvx --window 1,2,3,10,10,10
works 'the same window at once' convert knot.npy -o direct.bvx --window 11,14,7,20,22,14
holds 'windows of windows are windows' cmp corner.bvx direct.bvx
works 'voxelize --window' voxelize "$knot" -o part.bvx --resolution 60 --padding 1 --window 10,12,4,40,45,20
works 'a window converted is a window voxelized' compare part.npy part.bvx
holds 'to the last bit' says '^  the same$'
warns 'a part of a lattice' convert part.npy -o part.vti
place_of part.npy >wanted
place_of part.vti >found
holds 'the box of a window is where it was' cmp wanted found
refuses 1 'window' convert knot.npy -o x.npy --window 0,0,0,999,9,9
refuses 2 'window is empty' convert knot.npy -o x.npy --window 0,0,9,9,9,9
refuses 2 'is for grids' convert "$knot" -o x.ply --window 0,0,0,9,9,9

# ---- convert: meshes ----

for format in ply obj off stl; do
    works "convert to $format" convert "$knot" -o knot.$format
    run info knot.$format
    holds "the $format is the knot" test "$(awk '$1 == "triangles" { print $2 }' out)" = "$("$program" info "$knot" | awk '$1 == "triangles" { print $2 }')"
    run compare "$knot" knot.$format --samples 500
    holds "the $format is in the same place" says '^  both ways +[0-9.e-]+ +0\.0000%'
done
works 'convert off to ply' convert knot.off -o back.ply
works 'and back' convert back.ply -o back.off
holds 'text and binary keep every bit' cmp back.off knot.off
works 'convert to glb' convert "$knot" -o knot.glb
holds 'a glb is one' sh -c 'test "$(head -c 4 knot.glb)" = glTF'
works 'a glb is read' info knot.glb
holds 'a glb is read: its triangles' says '^  triangles +[0-9]+ of'
holds 'a glb is read: its normals' says '^  normals +of vertices'
for format in ply obj; do
    works "convert --normals to $format" convert "$knot" -o with_normals.$format --normals
    works "normals are left out again from $format" convert with_normals.$format -o without.$format
    holds "the $format is the one without" cmp without.$format knot.$format
done
holds 'ply has normals' sh -c 'head -n 12 with_normals.ply | grep -a -q "property float nz"'
holds 'obj has one a vertex' test "$(grep -c '^vn ' with_normals.obj)" = "$(grep -c '^v ' with_normals.obj)"
works 'glb has them always' convert "$knot" -o with_normals.glb --normals
holds 'so it is the same' cmp with_normals.glb knot.glb
refuses 2 'has the normals of triangles only' convert "$knot" -o x.stl --normals
refuses 2 'no normals are written' convert "$knot" -o x.off --normals
refuses 2 'is for meshes' convert knot.npy -o x.bvx --normals
rm -f with_normals.* without.*

# y is up in .obj and .glb, z in .stl; other formats come as they are.
works 'y up' convert knot.ply -o y.obj
does_not_turn() { # FILE, COMMAND...: as the knot is
    file=$1
    shift
    run convert "$@" -o "$file"
    holds "not turned: $*" sh -c "test $status = 0 && ! grep -q turned out"
}
turns() { # FROM, COMMAND...
    from=$1
    shift
    run convert "$@"
    holds "turned: $*" sh -c "test $status = 0 && grep -q '^  turned  *from $from up' out"
}
does_not_turn x.glb y.obj
does_not_turn x.stl knot.ply
does_not_turn x.ply x.stl
does_not_turn x.stl y.obj --up y
does_not_turn x.glb x.stl --input-up y
turns y y.obj -o turned.stl
turns z turned.stl -o back.glb
turns y knot.ply -o turned.ply --input-up y --up z
works 'and back' convert turned.ply -o back.ply --input-up z --up y
works 'once more without a turn' convert back.ply -o back_as_it_is.ply
holds 'and back: the mesh itself' cmp back.ply knot.ply
run compare knot.ply turned.ply --samples 500
holds 'a turned mesh is elsewhere' sh -c '! grep -q -E "both ways +[0-9.e-]+ +0\.0000%" out'
reports 'a turn in --json' 'r["turned"] == "y to z"' convert y.obj -o turned.stl
refuses 2 'give it with --input-up beside --up' convert knot.ply -o x.glb --up z
refuses 2 'give it with --up beside --input-up' convert y.obj -o x.ply --input-up z
refuses 2 'is for meshes' convert knot.npy -o x.bvx --up y
refuses 2 'one of: y, z' convert knot.ply -o x.glb --up x
works 'quantized' convert knot.ply -o small.glb --quantize
holds 'quantized: a smaller file with the extension' sh -c 'grep -a -q KHR_mesh_quantization small.glb && test "$(wc -c <small.glb)" -lt "$(wc -c <knot.glb)"'
refuses 2 'x.ply: --quantize is for .glb' convert knot.ply -o x.ply --quantize
refuses 2 'x.stl: --quantize is for .glb' repair knot.ply -o x.stl --quantize
rm -f y.obj x.* turned.* back.* back_as_it_is.ply small.glb
works 'colours go to ply' convert red_blue.obj -o rb.ply
works 'and to off' convert rb.ply -o rb.off
works 'and to obj' convert rb.off -o rb.obj
run info rb.obj
holds 'colours survive three formats' says 'colours +of vertices'
warns 'x.stl: colours are not kept; .glb keeps them' convert red_blue.obj -o x.stl
warns 'x.off: texture coordinates are not kept; .glb keeps them' convert uv.obj -o x.off
warns 'x.stl: texture coordinates are not kept; .glb keeps them' convert uv.obj -o x.stl
warns 'x.off: texture coordinates are not kept; .glb with --carry keeps them' repair uv.obj -o x.off --resolution 16
warns 'x.obj: texture coordinates are not kept; --carry keeps them' repair uv.obj -o x.obj --resolution 16
warns 'x.obj: texture coordinates are not kept' boolean union uv.obj uv.obj -o x.obj --resolution 16
works 'texture coordinates go to ply' convert uv.obj -o uv.ply
run info uv.ply
holds 'texture coordinates survive' says 'texture +coordinates'
rm -f x.stl x.off
refuses 2 'bitvox voxelize' convert "$knot" -o x.npy
refuses 2 'a format that can be written' convert knot.npy -o x.csl
refuses 2 'bitvox render' convert knot.npy -o x.png
refuses 2 'a format that can be written' convert "$knot" -o x.xyz
reports 'convert --json' 'r["command"] == "convert" and r["set"] > 0 and "write" in [s["name"] for s in r["stages"]]' convert knot.npy -o x.bvx
rm -f x.bvx
mkdir side
works 'a file of one name before' convert knot.npy -o side/k.npy
mkdir side/k2.npy.json
cp side/k.npy side/before.npy
run convert part.npy -o side/k2.npy
holds 'side-car and grid: both or none' sh -c "test $status = 1 && test ! -e side/k2.npy && test \$(ls -A side | grep -c part) = 0"
rm -rf side

# ---- voxelize ----

for format in npy binvox vox nrrd vti bvx; do works "voxelize to $format" voxelize "$knot" -o v.$format --resolution 40 --check-thin never; done
for format in binvox vox nrrd vti bvx; do holds "voxelize: $format holds what npy holds" test "$(hash_of v.$format)" = "$(hash_of v.npy)"; done
holds '.vox has a side-car, the others have none' sh -c 'test -s v.vox.json && test ! -e v.bvx.json && test ! -e v.nrrd.json'
rm -f v.*
refuses 1 'cubic' voxelize "$knot" -o x.binvox --resolution 20,30,10
works '.vox of more than 256 a side' voxelize "$knot" -o x.vox --resolution 300
works 'the same voxels as .bvx' voxelize "$knot" -o x.bvx --resolution 300
works 'and back' convert x.vox -o y.bvx
holds '.vox of more than 256 a side holds them' cmp x.bvx y.bvx
works 'a window of it' voxelize "$knot" -o x.vox --resolution 300 --window 0,0,0,200,200,90
rm -f x.*
run voxelize "$knot" -o x.vox --resolution 3000 --json
if has python3; then
    holds 'what the format cannot hold is told before the work' \
        python3 -c 'import json, sys; r = json.load(open("out")); sys.exit("set" in r or r["stages"][-1]["name"] == "voxelize")'
fi
refuses 2 'is a grid already' voxelize knot.npy -o x.bvx
refuses 2 'in a grid format that can be written' voxelize "$knot" -o x.csl
reports 'voxelize --json' 'r["lattice"]["dims"][1] == 30 and r["set"] > 0 and r["meshes"] == []' voxelize "$knot" -o x.bvx --resolution 30 --check-thin never
rm -f x.*

# ---- lod ----

works 'lod of a grid' lod knot.npy -o l_%d.ply --levels 40,20 --samples 500
holds 'lod of a grid: distances are to its own surface' says "to the voxels' surface"
holds 'lod of a grid: closed, manifold, oriented' test "$(grep -c -E '^ +[01] +[0-9]+x.* yes$' out)" = 2
run compare "$knot" l_0.ply --samples 2000
holds 'lod of a grid lies where the mesh lies' sh -c "awk '/both ways/ { sub(\"%\", \"\", \$4); exit !(\$4 < 1) }' out"
works 'the grid in another format' convert knot.npy -o knot.bvx
works 'lod of it' lod knot.bvx -o m_%d.ply --levels 40,20 --samples 0
holds 'lod: the format of a grid does not show' cmp l_0.ply m_0.ply
works 'lod of a mesh on the same lattice' lod "$knot" -o n_%d.ply --levels 40,20 --samples 0 --resolution 60 --padding 1 --quiet
holds 'lod of a grid is lod of its mesh' cmp l_1.ply n_1.ply
works 'a small grid' voxelize "$knot" -o small.npy --resolution 33 --check-thin never
works 'lod of a small grid has small levels' lod small.npy -o s_%d.off --samples 0
holds 'lod of a small grid: a half and a quarter of it' sh -c "grep -q 'x33x' out && grep -q 'x16x' out && grep -q 'x8x' out"
works 'lod to glb' lod "$knot" -o l_%d.glb --levels 20,10 --samples 0 --quiet
holds 'lod to glb: two files' sh -c 'test "$(head -c 4 l_1.glb)" = glTF'
warns 'level 1: a volume of 27.8376, but 28.5366 before edges collapsed (-2.45 %); more triangles keep it nearer' lod knot.npy -o l_%d.ply --triangles 2000,500 --samples 0
run info l_1.ply
holds 'no more triangles than asked for' test "$(awk '$1 == "triangles" { print $2 }' out)" -le 500
reports 'lod --json of a grid' 'r["set"] > 0 and len(r["lattice"]["dims"]) == 3 and len(r["meshes"]) == 3 and r["meshes"][2]["mean_distance"] > 0' lod knot.npy -o l_%d.ply --levels 40,30,20 --samples 200
rm -f ?_?.*
for option in '--resolution 50' '--padding 1' '--fill parity' --carry; do
    # shellcheck disable=SC2086
    refuses 2 'is for meshes' lod knot.npy -o x_%d.ply $option
done
refuses 1 'level 0 asks for a resolution of 100' lod knot.npy -o x_%d.ply --levels 100,50 --samples 0
refuses 1 'bitvox: level 1 asks for a resolution of 100' lod knot.npy -o x_%d.ply --levels 20,100 --samples 0
works 'lod --carry' lod red_blue.obj -o c_%d.obj --levels 24,12 --samples 0 --carry --quiet
run info c_1.obj
holds 'each level has colours' says 'colours +of vertices'
# Red falls and blue rises along x; the box goes from 0 to 2.
awk '$1 == "v" { n++; if ($5 - (1 - $2 / 2) > 0.05 || (1 - $2 / 2) - $5 > 0.05 || $5 + $7 < 0.98 || $5 + $7 > 1.02 || $6 > 0.01) bad++ }
    END { exit !(n > 100 && bad == 0) }' c_0.obj
if [ $? = 0 ]; then ok 'carried colours are those of the place'; else not_ok 'carried colours are those of the place' "$(head -n 5 c_0.obj)"; fi
works 'lod --carry of texture coordinates' lod uv.obj -o c_%d.ply --levels 24,12 --samples 0 --carry --quiet
run info c_0.ply
holds 'levels have texture coordinates' says 'texture +coordinates of vertices'
works 'lod without --carry' lod red_blue.obj -o c_%d.obj --levels 24,12 --samples 0 --quiet
run info c_0.obj
holds 'no colours without --carry' sh -c '! grep -q colours out'
refuses 2 'neither colours nor texture coordinates' lod plain.obj -o x_%d.ply --levels 24 --carry
refuses 2 '.stl holds neither' lod red_blue.obj -o x_%d.stl --solid --carry
refuses 2 '.off holds no texture coordinates' lod uv.obj -o x_%d.off --solid --carry
reports 'lod --carry --json' 'all(m["colours"] and not m["texture_coordinates"] for m in r["meshes"])' lod red_blue.obj -o c_%d.ply --levels 12,6 --samples 0 --carry --quiet
rm -f c_*

# ---- compare ----

works 'other voxels' voxelize "$knot" -o other.npy --resolution 60 --padding 1 --fill nonzero
works 'grids of one lattice' compare knot.npy other.npy
holds 'they are the same' says '^  the same$'
printf 'v 1.5 0 0\nv 2 0 0\nv 2 1 0\nv 1.5 1 0\nv 1.5 0 1\nv 2 0 1\nv 2 1 1\nv 1.5 1 1\n%s\n' "$faces" >end.obj
works 'an end of the box' voxelize end.obj -o end.npy --spacing 0.25 --origin -0.5,-0.5,-0.5
works 'the box from the same corner' voxelize plain.obj -o whole.npy --spacing 0.25 --origin -0.5,-0.5,-0.5
works 'compare' compare whole.npy end.npy
holds 'compare: both' says '^  both +32 voxels, 25 %'
holds 'compare: only in A' says '^  only in A +96 voxels, in one piece$'
holds 'compare: only in B' says '^  only in B +none$'
holds 'compare: box' says '^  box .*: 6 x 4 x 4 voxels from 2,2,2,$'
reports 'compare --json of grids' 'r["difference"]["only_a"] == 96 and r["difference"]["both"] == 32 and r["difference"]["same"] is False
    and r["difference"]["components_only_a"] == 1 and r["difference"]["largest_only_a"] == 96 and r["difference"]["size"] == [6, 4, 4]' compare whole.npy end.npy
works 'the same with one padding' voxelize "$knot" -o padded.npy --resolution 60 --padding 2
refuses 1 'origin along x' compare knot.npy padded.npy
works 'the same with another spacing' voxelize plain.obj -o fine.npy --spacing 0.125 --origin -0.5,-0.5,-0.5
refuses 1 'spacing along x' compare whole.npy fine.npy
refuses 1 "window's low along x" compare knot.npy part.npy
cp whole.npy bare.npy
refuses 1 'bare.npy has no side-car' compare whole.npy bare.npy
works 'meshes' compare "$knot" knot.stl --samples 3000 --seed 7
holds 'compare: samples and seed are told' says '3000 random points on each mesh, seed 7$'
holds 'compare: words of the certificate' test "$(grep -c 'closed, manifold, oriented' out)" = 2
cp out first
works 'meshes again' compare "$knot" knot.stl --samples 3000 --seed 7 --threads 1
holds 'compare: the same numbers on one thread' cmp out first
run compare "$knot" knot.stl --samples 3000 --seed 8
printf 'v 0 0 3\nv 2 0 3\nv 2 1 3\nv 0 1 3\nv 0 0 4\nv 2 0 4\nv 2 1 4\nv 0 1 4\n%s\n' "$faces" >moved.obj
reports 'compare --json of meshes' 'r["distance"]["samples"] == 500 and r["distance"]["seed"] == 1 and 2 <= r["distance"]["mean_a_to_b"] <= 3
    and r["distance"]["max_a_to_b"] == 3 and abs(r["distance"]["diagonal"] - 6 ** 0.5) < 1e-9 and len(r["meshes"]) == 2 and r["meshes"][0]["volume"] == 2' compare plain.obj moved.obj --samples 500
works 'compare without distances' compare plain.obj moved.obj --samples 0
holds 'none are said' sh -c '! grep -q distances out'
refuses 2 'a mesh and a grid' compare "$knot" knot.npy
refuses 2 'is for meshes' compare knot.npy other.npy --samples 5
refuses 2 'is for meshes' compare knot.npy other.npy --seed 5
refuses 2 'no use with --samples 0' compare plain.obj moved.obj --samples 0 --seed 5
refuses 2 'lacks an input' compare "$knot"
refuses 2 'too many' compare "$knot" "$knot" "$knot"
refuses 2 'has no use for -o' compare "$knot" "$knot" -o x.ply

# ---- render ----

picture() { # NAME, FILE, ARGUMENTS...
    picture_name=$1 picture_file=$2
    shift 2
    works "$picture_name" render "$@" -o "$picture_file" --size 160x120
}
# Of pictures, by python3: the places that are not background, and how many places have a kind of colour.
cat >pictures.py <<'P'
import struct, sys, zlib

def picture(name):
    b, at, data = open(name, 'rb').read(), 8, b''
    while at < len(b):
        n, kind = struct.unpack('>I4s', b[at:at + 8])
        if kind == b'IHDR': w, h = struct.unpack('>II', b[at + 8:at + 16])
        if kind == b'IDAT': data += b[at + 8:at + 8 + n]
        at += 12 + n
    rows = zlib.decompress(data)
    assert all(rows[y * (3 * w + 1)] == 0 for y in range(h)), 'rows without filters'
    return {(x, y): rows[y * (3 * w + 1) + 1 + 3 * x:][:3] for y in range(h) for x in range(w)}

def shown(name): return {at for at, p in picture(name).items() if p != b'\xff\xff\xff'}
def tall(name): return max(y for x, y in shown(name)) - min(y for x, y in shown(name))
def count(name, kind): return sum(kind(*p) for p in picture(name).values())
def red(r, g, b): return r > 2 * g and r > 2 * b
def green(r, g, b): return g > 1.5 * r and g > 1.5 * b
def blue(r, g, b): return b > 2 * r and b > 2 * g

sys.exit(not eval(sys.argv[1]))
P
pixels() { # NAME, EXPRESSION
    if ! has python3; then skip "$1" 'python3 is missing'
    elif python3 pictures.py "$2" 2>err; then ok "$1"
    else not_ok "$1" "$2"; fi
}

picture 'render a mesh' mesh.png "$knot"
picture 'render a grid' grid.png knot.npy
picture 'render a grid of another format' again.png knot.bvx
holds 'the format does not show' cmp grid.png again.png
picture 'the same on one thread' again.png knot.npy --threads 1
holds 'threads do not show' cmp grid.png again.png
picture 'render a box' box.png plain.obj
picture 'render --wireframe' wire.png plain.obj --wireframe
holds 'edges show' differ box.png wire.png
picture 'render a box of voxels' box.png box.npy
picture 'render --wireframe of a grid' wire.png box.npy --wireframe
holds 'edges of voxels show' differ box.png wire.png
picture 'render --smooth' smooth.png "$knot" --smooth
holds 'smooth shading shows' differ mesh.png smooth.png
picture 'render colours' colours.png red_blue.obj
picture 'render no colours' plain.png plain.obj
holds 'colours show' differ colours.png plain.png
pixels 'they are red and blue' 'count("colours.png", red) > 1000 and count("colours.png", blue) > 1000 and count("plain.png", red) + count("plain.png", blue) == 0'
picture 'render --cut' cut.png "$knot" --cut z=0
holds 'a cut shows' differ mesh.png cut.png
picture 'the same cut from below' below.png "$knot" --cut z=0 --from 3,-4,-2
picture 'from below, uncut' whole.png "$knot" --from 3,-4,-2
holds 'a cut from below shows' differ below.png whole.png
picture 'render --cut beyond the model' far.png "$knot" --cut z=1000
holds 'a cut beyond the model takes nothing away' cmp mesh.png far.png
picture 'render two cuts' two.png "$knot" --cut z=0.5,x=0
picture 'the same cuts apart' apart.png "$knot" --cut x=0 --cut z=0.5
holds 'cuts in a list are cuts apart' cmp two.png apart.png
picture 'render --cut of a grid' gridcut.png knot.npy --cut z=0
holds 'a cut of a grid shows' differ grid.png gridcut.png
# Two of the box's eight layers lie below x = 0.5. Seen from high x these two are left, seen from low x the six others.
works 'layers below the cut' convert whole.npy -o low.npy --window 0,0,0,4,6,6
works 'layers above the cut' convert whole.npy -o high.npy --window 4,0,0,10,6,6
picture 'a cut seen from high x' cut_low.png whole.npy --cut x=0.5 --from 2,1,1
picture 'what it must leave' low.png low.npy --from 2,1,1
picture 'a cut seen from low x' cut_high.png whole.npy --cut x=0.5 --from -2,1,1
picture 'what this must leave' high.png high.npy --from -2,1,1
pixels 'a cut takes the side towards the eye' 'shown("cut_low.png") == shown("low.png") != shown("cut_high.png") == shown("high.png")'
picture 'a mesh cut seen from high x' mesh_low.png plain.obj --cut x=0.5 --from 2,1,1
pixels 'a mesh is cut like its voxels' 'len(shown("mesh_low.png") ^ shown("low.png")) < 0.02 * len(shown("low.png"))'
refuses 1 'cut' render "$knot" -o x.png --cut z=-1000
for value in z z= =1 a=1 z=1,z=2 z=nan z=1, 1; do refuses 2 'planes like' render "$knot" -o x.png --cut "$value"; done
refuses 2 'planes like' render "$knot" -o x.png --cut z=1 --cut z=2

refuses 2 '--voxels is for meshes' render knot.npy -o x.png --voxels 10
refuses 2 '--fill needs --voxels' render knot.npy -o x.png --fill nonzero
refuses 2 '--fill needs --voxels' render "$knot" -o x.png --fill parity

picture 'render --compare of grids' compared.png whole.npy end.npy --compare
holds 'render --compare prints the counts' says '32 voxels of both, 0 added \(green\), 96 removed \(red\)'
picture 'compared the other way' reverse.png end.npy whole.npy --compare
holds 'render --compare prints the counts the other way' says '32 voxels of both, 96 added \(green\), 0 removed \(red\)'
pixels 'what is removed is red, what is added is green' \
    'count("compared.png", red) > 1000 > 0 == count("compared.png", green) and count("reverse.png", green) > 1000 > 0 == count("reverse.png", red)'
picture 'render --compare of meshes' both.png plain.obj end.obj --compare --voxels 8
holds 'meshes compared on one lattice' says '32 voxels of both, 0 added \(green\), 96 removed \(red\)'
picture 'meshes far apart' both.png plain.obj moved.obj --compare --voxels 8
holds 'one lattice covers both' says ' 0 voxels of both, 16 added \(green\), 16 removed \(red\)'
reports 'render --compare --json' 'r["difference"] == {"both": 32, "added": 0, "removed": 96} and r["pictures"] == {"path": "x.png", "count": 1, "width": 40, "height": 30}' render whole.npy end.npy --compare -o x.png --size 40x30
rm -f x.png
refuses 2 'takes two inputs' render knot.npy -o x.png --compare
refuses 2 'takes two inputs' render knot.npy knot.npy knot.npy -o x.png --compare
refuses 2 'two grids or two meshes' render knot.npy "$knot" -o x.png --compare
refuses 1 'origin along x' render knot.npy padded.npy -o x.png --compare

picture 'meshes and grids on one sheet' sheet.png "$knot" knot.npy box.npy
reports 'render --json' 'r["pictures"]["width"] == 60 and r["pictures"]["height"] == 20' render "$knot" knot.npy box.npy -o x.png --size 20x20

# ---- two outputs that are one file; numbers at the ends of what doubles hold ----

if links; then
    run lod "$knot" -o link_0.ply --levels 10 --samples 0
    ln -s link_0.ply link_1.ply
    refuses 1 'link_0.ply and link_1.ply are one file' lod "$knot" -o 'link_%d.ply' --levels 10,5 --samples 0
    rm -f link_0.ply link_1.ply
else
    skip 'two outputs that are one file' 'links are not followed'
fi
printf 'v 0 0 0\nv 1e-310 0 0\nv 0 1e-310 0\nv 0 0 1e-310\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n' >tiny.obj
refuses 1 'too small to divide by; scale the coordinates up' lod tiny.obj -o 'tiny_%d.ply' --levels 8
sed 's/e-310/e308/g' tiny.obj >huge.obj
run lod huge.obj -o huge.ply --levels 8 --quiet
run lod huge.obj -o huge.ply --levels 8
if grep -q -e nan -e inf out; then not_ok 'no nan in the table of a huge mesh' 'nan or inf'; else ok 'no nan in the table of a huge mesh'; fi
refuses 2 'takes one of: stl, obj, ply, npy, off, glb, binvox' info - --format png

counts
