#!/bin/sh
# test_files.sh [PROGRAM] - files of the bitvox program: coordinates far from the origin, and reports that describe what is written.
# PROGRAM is build/bitvox, or what BITVOX names. One line a check, "ok NAME" or "not ok NAME"; the last line is
# "N passed, N failed[, N skipped]". Runs in the repository's root, works in a folder of its own.
set -u
. tests/tools/program_checks.sh

warns() { # WORDS, ARGUMENTS...: status 0 and one warning with these words
    words=$1
    shift
    run "$@"
    if [ $status = 0 ] && [ "$(wc -l <err)" = 1 ] && grep '^bitvox: warning: ' err | grep -q -F -e "$words"; then ok "warned: $*"
    else not_ok "warned: $*" "status $status, wanted a warning with '$words'"; fi
}
# Reports of two runs, by python3: every expression over r and s is true.
compares() { # NAME, EXPRESSION: one.json and two.json
    if ! has python3; then
        skip "$1" 'python3 is missing'
    elif python3 -c 'import json, sys
r, s = json.load(open("one.json")), json.load(open("two.json"))
sys.exit(not eval("(" + sys.argv[1] + ")"))' "$2" 2>err; then ok "$1"
    else not_ok "$1" "$2"; fi
}

# ---- far from the origin: .stl and other 32-bit floats ----

# A ball of voxels' sides as a mesh of doubles, in metres of a map projection, and a little away from 0.
run convert "$knot" -o knot.obj
away() { awk -v x="$1" -v y="$2" '$1 == "v" { printf "v %.12f %.12f %s\n", $2 + x, $3 + y, $4; next } { print }' knot.obj; }
away 600000 5000000 >utm.obj
away 6000 50000 >map.obj

advice='--output-origin 600000,5000000,0'
refuses 1 "$advice" convert utm.obj -o utm.stl
refuses 1 "$advice" repair utm.obj -o utm.stl --resolution 48
refuses 1 "$advice" lod utm.obj -o 'utm_%d.stl' --triangles 20000,4000 --samples 0
refuses 1 "$advice" simplify utm.obj -o utm.stl --samples 0
refuses 1 "$advice" faces utm.obj -o utm.stl --resolution 48
refuses 1 "$advice" boolean union utm.obj utm.obj -o utm.stl --resolution 32
refuses 1 '.ply, .obj, .off or .glb' refine utm.obj -o utm.stl --halvings 3
run slice utm.obj -o utm.csv --spacing 0.2
refuses 1 "$advice" sections utm.csv -o utm.stl
for ending in ply obj off glb; do works "far away as .$ending" repair utm.obj -o "far.$ending" --resolution 48; done
warns 'by up to 0.002' convert map.obj -o map.stl
gives 'slivers are counted' 0 'triangles without area or turned over' repair map.obj -o map.stl --resolution 128

works 'brought near' repair utm.obj -o near.stl --resolution 48 --output-origin 600000,5000000,0
run info near.stl --json
cp out one.json
run repair utm.obj -o near.stl --resolution 48 --output-origin 600000,5000000,0 --json
cp out two.json
compares 'the certificate is of the bytes in the file' \
    'all(r["meshes"][0][k] == s["meshes"][0][k] for k in ("vertices", "triangles", "closed", "manifold", "volume", "area", "low", "high")) and abs(r["meshes"][0]["low"][1]) < 5'
works 'levels brought near' lod utm.obj -o near.glb --triangles 20000,9600 --samples 0 --output-origin 600000,5000000,0
gives 'a section brought near' 0 'closed, manifold' sections utm.csv -o near.stl --output-origin 600000,5000000,0 --subdivide 8
refuses 2 'is for meshes; x.npy is not a mesh' convert knot.obj -o x.npy --output-origin 0,0,0
refuses 2 'is for meshes; x.npy is not a mesh' voxelize knot.obj -o x.npy --output-origin 0,0,0

# What makes something of files that are not read.
refuses 1 'Blender makes .glb' info a.fbx
refuses 1 'FreeCAD and Gmsh make .stl' repair part.STEP -o x.ply
refuses 1 'the Python package reads it' lod a.amf -o x.ply

# Two cubes that share an edge by numbers of their own: .ply keeps them apart, readers of .stl join them.
cube() { # FIRST NUMBER, X, Y
    for z in 0 1; do printf 'v %s %s %s\nv %s %s %s\nv %s %s %s\nv %s %s %s\n' "$2" "$3" $z $(($2 + 1)) "$3" $z $(($2 + 1)) $(($3 + 1)) $z "$2" $(($3 + 1)) $z; done
}
sides() { # FIRST NUMBER
    for f in '1 3 2' '1 4 3' '5 6 7' '5 7 8' '1 2 6' '1 6 5' '2 3 7' '2 7 6' '3 4 8' '3 8 7' '4 1 5' '4 5 8'; do
        set -- "$1" $f
        echo "f $(($2 + $1)) $(($3 + $1)) $(($4 + $1))"
    done
}
{ cube 0 0 0; cube 0 1 1; sides 0; sides 8; } >pair.obj
warns 'its readers join vertices at equal positions, and 1 edges' convert pair.obj -o pair.stl
works 'as .ply they stay apart' convert pair.obj -o pair.ply

# ---- sections ----

# A square with a hole of another label, and squares that each share no area with the next.
drum() { # LABEL OF THE HOLE
    printf 'CSLC\n3 2\n'
    for z in 0 1 2; do
        printf '%s 8 2 0 0 1 -%s\n0 0 %s 4 0 %s 4 4 %s 0 4 %s\n1 1 %s 3 1 %s 3 3 %s 1 3 %s\n4 1 0 1 2 3\n4h0 %s 4 5 6 7\n' $z $z $z $z $z $z $z $z $z $z "$1"
    done
}
drum 2 >drum2.csl
drum 1 >drum1.csl
reports_volume() { # NAME, VOLUME, ARGUMENTS...
    volume_name=$1 volume=$2
    shift 2
    run sections "$@"
    if [ $status = 0 ] && grep -q -F "volume      $volume by the mesh" out; then ok "$volume_name"; else not_ok "$volume_name" "$(grep volume out)"; fi
}
reports_volume 'a hole of the body' 24 drum1.csl -o drum.ply
reports_volume 'a hole of another label' 24 drum2.csl -o drum.ply --label 1
reports_volume 'what fills it' 8 drum2.csl -o drum.ply --label 2
refuses 1 'by --label' sections drum2.csl -o drum.ply
{
    echo section,position,loop,x,y
    for i in 0 1 2 3; do printf '%s,%s,0,%s,0\n%s,%s,0,%s,0\n%s,%s,0,%s,4\n%s,%s,0,%s,4\n' $i $i $((i * 10)) $i $i $((i * 10 + 4)) $i $i $((i * 10 + 4)) $i $i $((i * 10)); done
} >stairs.csv
warns 'share no area' sections stairs.csv -o stairs.ply
run sections "$knot" -o x.ply
run slice utm.obj -o utm.csv --spacing 0.2
warns 'a subdivision of 8 may help' sections utm.csv -o x.ply
run sections utm.csv -o x.ply --subdivide 8
if grep -q 'take' err; then not_ok 'no advice beyond the deepest' 'advice'; else ok 'no advice beyond the deepest'; fi

# ---- names, readers that leave, files of other programs ----

works 'digits of levels' simplify knot.obj -o 'k_%03d.ply' --count 2 --samples 0
holds 'as the name says' test -s k_000.ply -a -s k_001.ply
refuses 2 'has two %d' simplify knot.obj -o 'k_%03d_%d.ply' --count 2
for how in '' --json; do
    streams || { skip "a reader that leaves $how" 'its signal does not reach the program'; continue; }
    # shellcheck disable=SC2086
    { "$program" info knot.obj $how; echo $? >code; } 2>err | :
    # shellcheck disable=SC2086
    { sleep 1; "$program" info knot.obj $how; echo $? >code; } 2>err | :
    if [ ! -s err ] && [ "$(cat code)" = 141 ]; then ok "a reader that leaves $how"; else not_ok "a reader that leaves $how" "status $(cat code)"; fi
done
if streams; then
    { sleep 1; "$program" faces knot.obj -o - --resolution 20 --quiet; echo $? >code; } 2>err | :
    if [ ! -s err ] && [ "$(cat code)" = 141 ]; then ok 'a reader of the result that leaves'; else not_ok 'a reader of the result that leaves' "status $(cat code): $(cat err)"; fi
else
    skip 'a reader of the result that leaves' 'its signal does not reach the program'
fi
if device /dev/full; then
    "$program" faces knot.obj -o - --resolution 20 --quiet >/dev/full 2>err
    holds 'a full disk is told by its name' grep -q ': standard output: cannot be written' err
    "$program" info knot.obj >/dev/full 2>err
    holds 'a full disk is told' grep -q 'standard output cannot be written' err
else
    skip 'a full disk is told' 'there is no /dev/full'
fi

printf '\357\273\277ply\nformat ascii 1.0\nCreated by Blender3D\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n' >mark.ply
works 'a byte order mark and a bare comment in .ply' info mark.ply
sed 's/Created/Creatde/' mark.ply >wrong.ply
refuses 1 'expected format, element' info wrong.ply
printf 'solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet material 3\nfacet normal 0 0 1 outer loop vertex 0 0 1 vertex 1 0 1 vertex 0 1 1 endloop endfacet facet normal 0 0 1 outer loop vertex 0 0 2 vertex 1 0 2 vertex 0 1 2 endloop endfacet endsolid a\n' >notes.stl
run info notes.stl
if grep -q 'triangles   3 of' out; then ok 'words behind endfacet'; else not_ok 'words behind endfacet' "$(head -3 out)"; fi
if has gzip && gzip -c mark.ply >tail.ply.gz 2>err; then
    printf 'more' >>tail.ply.gz
    warns '4 bytes after the data' info tail.ply.gz
fi
refuses 2 'boolean OPERATION A B' boolean union knot.obj -o x.ply
refuses 2 'holds bare samples: --shape X,Y,Z and --sample-type say what they are' info "$root/fixtures/waves.raw"

# ---- what files hold ----

run info "$root/fixtures/waves.nhdr"
if grep -q '^samples       u8, from 0 to 184; 13225 are 0' out && grep -q '^ *11.5 .* 5168$' out; then ok 'samples of a volume'; else not_ok 'samples of a volume' "$(head -3 out)"; fi
run info "$root/fixtures/labels.npy"
if grep -q '^ *3 .* 0$' out && [ "$(grep -c '#' out)" = 4 ]; then ok 'few whole numbers have a line each'; else not_ok 'few whole numbers have a line each' "$(head -9 out)"; fi
run voxelize "$knot" -o bits.nrrd --resolution 20
run info bits.nrrd
if grep -q samples out; then not_ok 'bits are no samples' 'told'; else ok 'bits are no samples'; fi
run info "$root/fixtures/waves.nhdr" --json
cp out one.json
run info "$root/fixtures/ball.xyz" --json
cp out two.json
compares 'reports of a volume and a cloud' 'sum(r["samples"]["histogram"]) == 48 * 40 * 32 and r["samples"]["type"] == "u8" and s["cloud"]["points"] > 100'
works 'info of a cloud' info "$root/fixtures/ball.xyz"
refuses 2 '--crossings is used with meshes' info "$root/fixtures/waves.nhdr" --crossings

# ---- options that would do nothing ----

run voxelize "$knot" -o knot.bvx --resolution 20
for option in '--level 16' '--range 1,2' '--label 2' --below '--shape 8,8,8' '--sample-type u8' --big-endian '--skip 4' '--voxel-size 1,1,1'; do
    for command in 'lod knot.obj -o x.ply' 'lod knot.bvx -o x.ply' 'voxelize knot.obj -o x.npy' 'convert knot.obj -o x.ply' \
        'convert knot.bvx -o x.npy' 'faces knot.obj -o x.ply' 'faces knot.bvx -o x.ply' 'render knot.obj -o x.png' 'render knot.bvx -o x.png'; do
        # shellcheck disable=SC2086
        refuses 2 'is for volumes' $command $option
    done
done
refuses 2 'did you mean --levels?' lod knot.obj -o x_%d.ply --level 16
refuses 2 '--states is for octrees' render knot.bvx -o x.png --states inside
refuses 2 '--states is for octrees' render knot.obj -o x.png --states inside
refuses 2 '--body is for clouds of points; '"$root/fixtures/waves.nhdr"' is a volume' voxelize "$root/fixtures/waves.nhdr" -o x.bvx --level 100 --body
refuses 2 '--minimum is for clouds' voxelize "$root/fixtures/waves.nhdr" -o x.ply --level 100 --minimum 2
refuses 2 'neither colours nor texture coordinates' repair knot.obj -o x.ply --resolution 20 --carry
refuses 2 '.stl holds neither' repair knot.obj -o x.stl --resolution 20 --carry
refuses 2 'for .raw files' lod "$root/fixtures/waves.nhdr" -o x.ply --level 100 --levels 8 --skip 3
works 'a volume among them' convert "$root/fixtures/waves.nhdr" -o x.npy --level 100

# ---- corners that are not finite ----

# A tetrahedron with a triangle more, to a vertex that is NaN in one file and infinite in the other.
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv nan 0 0\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\nf 1 2 5\n' >nan.obj
printf 'OFF\n5 5 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\ninf 0 0\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n3 0 1 4\n' >inf.off
sed '/nan/d; /f 1 2 5/d' nan.obj >whole.obj
left_out='1 triangle with a corner that is not finite left out'
for file in nan.obj inf.off; do
    warns "$left_out" repair $file -o mended.ply --resolution 32
    run repair whole.obj -o whole.ply --resolution 32
    holds "$file: repaired as without it" cmp mended.ply whole.ply
    warns "$left_out" lod $file -o lod.ply --triangles 4
    warns "$left_out" voxelize $file -o solid.bvx --resolution 16
    warns "$left_out" voxelize $file -o thin.bvx --resolution 16 --mode thin
    warns "$left_out" voxelize $file -o field.npy --resolution 16 --mode field
    run voxelize whole.obj -o whole.bvx --resolution 16
    holds "$file: the voxels as without it" cmp solid.bvx whole.bvx
    run boolean union $file whole.obj -o both.ply --resolution 16
    holds "$file: left out of a union" grep -q -F "warning: $file: $left_out" err
    run boolean union whole.obj whole.obj -o whole.ply --resolution 16
    holds "$file: a union as without it" cmp both.ply whole.ply
    run repair $file -o mended.ply --json
    grep -q '"nonfinite_triangles": 1,' out
    result "$file: counted in the report" $?
    warns "$file: $left_out" info $file
    tail -n +3 out >told
    run info whole.obj
    tail -n +2 out >whole.txt
    holds "$file: info is of what remains" cmp told whole.txt
    warns "$file: $left_out" info $file --crossings --json
    grep -q '"nonfinite_triangles": 1,.*"triangles": 4, "closed": true' out
    result "$file: counted in the report of info" $?
    gives "$file: info says how many" 0 "^  left out    1 triangle with a corner that is not finite$" info $file
    for command in 'simplify -o x.ply' 'convert -o x.ply' 'faces -o x.ply'; do
        refuses 1 'has a coordinate that is not finite' ${command%% *} $file ${command#"${command%% *}"}
    done
done
printf 'v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n' >none.obj
refuses 1 'each of the 1 triangles has a corner that is not finite' repair none.obj -o x.ply
refuses 1 'each of the 1 triangles has a corner that is not finite' info none.obj

printf '\377\376v\0 \0001\0' >wide.obj
refuses 1 'the file is text in UTF-16; save it as UTF-8' info wide.obj
printf 'v\0 \0001\0' >wide.obj
refuses 1 'the file is text in UTF-16; save it as UTF-8' info wide.obj
printf '\376\377\0v\0 \0001' >wide.off
refuses 1 'the file is text in UTF-16; save it as UTF-8' info wide.off
too_wide=0
for command in info voxelize lod render convert compare faces refine fill sections slice repair boolean morph components simplify labels hull check; do
    too_wide=$((too_wide + $("$program" $command --help-all | awk 'length($0) > 110 { n++ } END { print n + 0 }')))
done
holds 'help fits 110 columns' [ $too_wide = 0 ]
# ---- 3MF ----

works 'to 3MF' convert "$knot" -o k.3mf
works 'and back' convert k.3mf -o k2.3mf
holds 'the same bytes' cmp k.3mf k2.3mf
printf 'PK' >cut.3mf
refuses 1 'no directory of a zip file' info cut.3mf

# ---- OpenVDB: written only ----

works 'voxels to OpenVDB' voxelize "$knot" -o k.vdb --resolution 150
works 'voxels to NanoVDB' voxelize "$knot" -o k.nvdb --resolution 150
refuses 1 "OpenVDB's nanovdb_convert makes .vdb of it" info k.nvdb
works 'distances to OpenVDB' voxelize "$knot" -o d.vdb --resolution 40 --mode field
refuses 1 "also with .gz); OpenVDB's vdb_tool makes .ply of it" info k.vdb
refuses 1 'take NPY, NRRD, VTI or, of distances, VDB or NVDB' voxelize "$knot" -o v.vdb --resolution 40 --mode field --vectors

# ---- OBJ: materials are not read, which is told where a mesh is written ----

printf 'usemtl red\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n' >red.obj
warns 'red.obj: not read: materials; exported as .glb a model has them [BVX_WARN_READ]' convert red.obj -o red.glb
printf 'usemtl red\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv 0 0 1\nv 1 0 1\nv 0 1 1\nv 1 1 1\nf 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n' >box.obj
warns 'box.obj: not read: materials; exported as .glb a model has them [BVX_WARN_READ]' voxelize box.obj -o box.vox --resolution 4
silent=$("$program" voxelize box.obj -o box.bvx --resolution 4 2>&1 >out)
holds 'voxels without colours have none of it' test -z "$silent"
silent=$("$program" info red.obj 2>&1 >out)
holds 'info has none of it' test -z "$silent"

# ---- glTF: text with its bytes in a file beside it, and what no mesh holds ----

mkdir -p scene
zero='\000\000\000\000' one='\000\000\200\077'
# shellcheck disable=SC2059
printf "$zero$zero$zero$one$zero$zero$zero$one$zero" >'scene/three corners.bin'
gltf() { # MEMBERS: a triangle in the file scene/t.gltf
    cat >scene/t.gltf <<END
{"asset": {"version": "2.0"}, "nodes": [{"mesh": 0}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
 "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}], "bufferViews": [{"buffer": 0, "byteLength": 36}],
 $1}
END
}
gltf '"buffers": [{"byteLength": 36, "uri": "three%20corners.bin"}]'
run convert scene/t.gltf -o t.off
holds 'a .gltf with a file beside it' test $status = 0
holds 'a .gltf with a file beside it: its triangle' sh -c 'test "$(tail -n 1 t.off)" = "3 0 1 2" && test "$(wc -l <t.off)" = 6'
works 'info of a .gltf' info scene/t.gltf
holds 'a .gltf from standard input has no file beside it' sh -c '! "$0" info - --format glb <scene/t.gltf 2>err && grep -q "there is no file" err' "$program"
gltf '"animations": [{}], "materials": [{}], "images": [{"uri": "gone.png"}], "buffers": [{"byteLength": 36, "uri": "three corners.bin"}]'
warns 'scene/t.gltf: not read: animations, images whose file is not there' info scene/t.gltf
holds 'info of a .gltf: materials' grep -q '^  materials' out
gltf '"buffers": [{"byteLength": 36, "uri": "../scene/three corners.bin"}]'
refuses 1 'there is no file' convert scene/t.gltf -o u.off
gltf '"extensionsRequired": ["KHR_draco_mesh_compression"]'
refuses 1 'compressed by KHR_draco_mesh_compression' convert scene/t.gltf -o u.off
refuses 2 '.3mf); .glb is the same in one file' convert "$knot" -o knot.gltf
refuses 2 '.3mf); Blender makes it of .glb' repair "$knot" -o knot.fbx
refuses 2 '.3mf); ObjToSchematic makes it of .obj' voxelize "$knot" -o knot.schem
rm -rf scene

counts
