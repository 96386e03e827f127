#!/bin/sh
# test_levels.sh [PROGRAM] - levels that edges collapse to: lod by its default method, simplify, and --triangles and --error of the
# commands that make one mesh. PROGRAM is build/bitvox, or what BITVOX names. One line a check, "ok NAME" or "not ok NAME"; the last
# line is "N passed, N failed[, N skipped]". Runs in the repository's root, works in a folder of its own.
set -u
. tests/tools/program_checks.sh

warns() { # WORDS, ARGUMENTS...: status 0 and a warning with these words
    words=$1
    shift
    run "$@"
    if [ $status = 0 ] && grep '^bitvox: warning: ' err | grep -q -F -e "$words"; then ok "warned: $words"
    else not_ok "warned: $words" "status $status"; fi
}

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
sys.exit(not (r["status"] == "done" and eval("(" + sys.argv[1] + ")")))' "$expression" 2>>err; then ok "$reports_name"
    else not_ok "$reports_name" "$expression: $(head -c 300 out)"; fi
}

says() { grep -q -E -e "$1" out; } # PATTERN
triangles_of() { "$program" info "$1" 2>/dev/null | awk '$1 == "triangles" { print $2 }'; }
whole() { # FILE: closed, manifold, oriented, and no triangles cross
    "$program" info "$1" --crossings | grep -c -E '^  (closed|manifold|oriented) +yes$|^  crossings +0 pairs' | grep -q -x 4
}

# ---- Inputs ----

"$program" convert "$knot" -o knot.obj --quiet
awk '/^f / { if (++n % 3 == 0) next } { print }' knot.obj >holes.obj
awk '/^f / { if (++n % 5 == 0) { print "f", $3, $2, $4; next } } { print }' knot.obj >flipped.obj
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n' >flat.obj
printf 'v 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nv 0 0 2\nv 2 0 2\nv 2 2 2\nv 0 2 2\nf 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n' >cube.obj
# Two cubes that overlap, one inside another, and one on a thin neck.
awk '{ print } $1 == "v" { more = more "v " $2 + 1 " " $3 + 0.5 " " $4 + 0.25 "\n" }
    $1 == "f" { more = more "f " $2 + 8 " " $3 + 8 " " $4 + 8 " " $5 + 8 "\n" } END { printf "%s", more }' cube.obj >two.obj
awk '{ print } $1 == "v" { more = more "v " 0.5 + $2 / 2 " " 0.5 + $3 / 2 " " 0.5 + $4 / 2 "\n" }
    $1 == "f" { more = more "f " $5 + 8 " " $4 + 8 " " $3 + 8 " " $2 + 8 "\n" } END { printf "%s", more }' cube.obj >hollow.obj
awk '{ print } $1 == "v" { more = more "v " 0.01 + $2 / 200 + 2.2 " " $3 / 200 " " $4 / 200 "\n" }
    $1 == "f" { more = more "f " $2 + 8 " " $3 + 8 " " $4 + 8 " " $5 + 8 "\n" } END { printf "%s", more }' cube.obj >speck.obj
awk '$1 == "v" { print $0, $2 / 10 + 0.5, 0, 1; next } { print }' knot.obj >coloured.obj

# ---- lod ----

does() { # NAME, ARGUMENTS...: status 0; small levels of the knot lose volume, which is warned of
    does_name=$1
    shift
    run "$@"
    if [ $status = 0 ]; then ok "$does_name"; else not_ok "$does_name" "status $status"; fi
}

works_here() { # NAME, FILES, ARGUMENTS...: each of the files is whole
    works_here_name=$1 files=$2
    shift 2
    works "$works_here_name" "$@"
    for file in $files; do holds "$works_here_name: $file is whole" whole "$file"; done
}

works_here 'lod' 'l_0.ply l_1.ply l_2.ply l_3.ply' lod "$knot" -o l_%d.ply
cp out table.txt
holds 'lod: what levels are made from' grep -q '^levels from the mesh as it is, 1 piece, in ' table.txt
holds 'lod: four halvings' test "$(awk '/^ +[0-3] .*met +yes$/ { printf "%s %s %s,", $2, $3, $4 }' table.txt)" = '19200 19200 50.00%,9600 9600 25.00%,4800 4800 12.50%,2400 2400 6.25%,'
holds 'lod: distances of four levels' test "$(sed '1,/both\|^distances/d' table.txt | grep -c -E '^ +[0-3]( +[0-9.e-]+ +[0-9.]+%){4}$')" = 4
holds 'lod: near to the mesh' sh -c "sed '1,/^distances/d' table.txt | awk '/^ +3 / { sub(\"%\", \"\", \$3); exit !(\$3 < 0.15) }'"
holds 'lod: files are named' grep -q '^written: l_0.ply, l_1.ply, l_2.ply, l_3.ply$' table.txt
"$program" lod "$knot" -o t_%d.ply --threads 1 --quiet
holds 'lod: threads do not show' sh -c 'cmp l_0.ply t_0.ply && cmp l_3.ply t_3.ply'
"$program" lod - --format ply -o t_%d.ply --quiet <"$knot"
holds 'lod reads standard input' cmp l_3.ply t_3.ply
if has gzip; then
    gzip -c "$knot" >packed.ply.gz
    "$program" lod packed.ply.gz -o t_%d.ply --quiet 2>err
    if grep -q 'made without zlib' err; then ok 'without zlib: it says so'; else holds 'lod reads .gz' cmp l_3.ply t_3.ply; fi
else
    skip 'lod reads .gz' 'gzip is missing'
fi
rm -f ?_?.ply packed.ply.gz

works_here 'lod --triangles' 'l_0.ply l_1.ply' lod "$knot" -o l_%d.ply --triangles 5000,2500 --samples 0
holds 'lod --triangles: no more than asked for' sh -c "test $(triangles_of l_0.ply) -le 5000 && test $(triangles_of l_1.ply) -le 2500"
holds 'lod --samples 0: no distances' sh -c '! grep -q distances out'
works_here 'lod --count' 'l_0.ply l_1.ply' lod "$knot" -o l_%d.ply --count 2 --samples 0
holds 'lod --count: two files' test ! -e l_2.ply
works_here 'lod --error' 'l_0.ply l_1.ply' lod "$knot" -o l_%d.ply --error 0.05%,0.01
holds 'lod --error: both targets stand in the table' sh -c "grep -q -E '^ +0 .* 0.05% .* met +yes$' out && grep -q -E '^ +1 .* 0.08958% .* met +yes$' out"
reports 'lod --error: kept, and not for nothing' 'all(0.7 * e < m["mean_distance"] <= e and m["met"] and m["target"] is None and m["target_error"] == e for m, e in
zip(r["meshes"], (0.0005 * r["levels"]["diagonal"], 0.01)))' lod "$knot" -o l_%d.ply --error 0.05%,0.01
reports 'lod --error-kind max' '0.3 < r["meshes"][0]["max_distance"] / (0.005 * r["levels"]["diagonal"]) <= 1' lod "$knot" -o l_%d.ply --error 0.5% --error-kind max
does 'one level needs no %d' lod "$knot" -o one.off --triangles 900 --samples 0
holds 'one level needs no %d: it is there' whole one.off
does 'a small mesh has few levels' lod cube.obj -o s_%d.ply --samples 0
holds 'a small mesh has few levels: one' sh -c 'test -e s_0.ply && ! test -e s_1.ply'
does 'lod --even' lod "$knot" -o e.ply --triangles 900 --samples 0 --even 0.01
does 'lod --normals' lod "$knot" -o n_%d.obj --triangles 900,90 --samples 0 --normals
holds 'lod --normals: one a vertex' test "$(grep -c '^vn ' n_1.obj)" = "$(grep -c '^v ' n_1.obj)"
rm -f ?_?.* one.off e.ply

reports 'lod --json' 'r["levels"]["solid"] is False and r["warnings"] == [] and "repair" not in r and
all(r["levels"][k] == 0 for k in ("collapsed", "doubles", "turned", "split", "parted", "cut")) and
[s["name"] for s in r["stages"] if s["name"][:4] in ("leve", "dist", "writ", "read")] == ["read", "level 0", "distance 0", "distance 1", "write"] and
all(m["met"] is True and m["crossings"] == 0 and m["target"] >= m["triangles"] and m["least_angle"] > 0.1 and m["solid"] is False and
m["closed"] and m["manifold"] and m["oriented"] and m["components"] == 1 and m["distance"]["mean_to_input"] > 0 and
m["simplification_rate"] == m["triangles"] / 38400 for m in r["meshes"])' lod "$knot" -o l_%d.ply --triangles 6000,3000

reports 'lod --json: what was not measured is null' 'all(m[k] is None for m in r["meshes"] for k in ("mean_distance", "max_distance", "distance"))' \
    lod "$knot" -o l_%d.ply --triangles 6000,3000 --samples 0
reports 'lod --error --samples 0: measured to be found' '0 < r["meshes"][0]["mean_distance"] <= 0.01' lod "$knot" -o l.ply --error 0.01 --samples 0

# Solids on request, and what asks for them.
why() { # WORDS, FILE, ARGUMENTS...
    why=$1 input=$2
    shift 2
    run lod "$input" -o w.ply --triangles 2000 --samples 0 "$@"
    if [ $status = 0 ] && says "^levels from its measured surface, as $why asks, in [0-9.]+ ms$" && whole w.ply; then ok "measured, $why"
    else not_ok "measured, $why" "status $status: $(grep levels out)"; fi
    rm -f w.ply
}
why --solid holes.obj --solid --resolution 96
holds 'holes are counted' says '^holes closed: [0-9]+'
why --solid flipped.obj --solid --resolution 96
why --solid two.obj --solid
why --solid "$knot" --solid
why --resolution "$knot" --resolution 64
holds '--resolution is heeded' says '^measured: 6[0-9] x 70 x 3[0-9] voxels, inside by winding; '
why --resolution "$knot" --resolution 100 --sign winding --sharp
why --sign "$knot" --sign vote
why --sharp "$knot" --sharp
why --no-sharp "$knot" --no-sharp
why --resolution hollow.obj --resolution 64 --outer-hull
holds '--outer-hull: the inner shell is gone' says '^filled: 1 cavit'
holds '--outer-hull: no warning that it is' test ! -s err
why --resolution speck.obj --resolution 256 --least-part 100
holds '--least-part: the speck is gone' says '^dropped: 1 part'
reports 'levels of one fault in one warning' '[w["code"] for w in r["warnings"]] == ["BVX_WARN_LEVEL_VOLUME", "BVX_WARN_TARGET"] and
r["warnings"][1]["values"] == [1, 6, 12, 0, 38] and r["warnings"][1]["place"] is None and len(r["meshes"]) == 40' lod hollow.obj -o again_%d.ply --count 40 --samples 0
reports 'a level that the next target leaves as it is is none that cannot be smaller' 'not any(w["code"] == "BVX_WARN_TARGET" for w in r["warnings"]) and
[m["triangles"] for m in r["meshes"]] == [1000, 1000]' lod "$knot" -o again_%d.ply --triangles 1001,1000 --samples 0
why --keep-largest speck.obj --keep-largest 1
holds '--keep-largest: the speck is gone' says '^dropped: 1 part'
why --solid flat.obj --solid
holds 'a triangle becomes a shell' says '^made into shells: 1 triangles that enclose nothing'
why --no-sharp flat.obj --shell 4 --no-sharp
reports 'a measured surface in --json' 'r["levels"]["solid"] is True and r["repair"]["holes"] > 0 and
r["meshes"][0]["solid"] is True and r["levels"]["surface_triangles"] > 5000 and max(r["lattice"]["dims"]) > 64' lod holes.obj -o l.ply --triangles 2000 --samples 0 --solid --resolution 96
rm -f l.ply l_?.ply

# Without it what is given is kept.
reports 'holes stay' 'r["levels"]["solid"] is False and r["meshes"][0]["boundary_edges"] > 0 and r["warnings"] == []' lod holes.obj -o k.ply --triangles 12000 --samples 0
holds 'a hint at --solid stands in one line' sh -c "'$program' lod holes.obj -o k.ply --triangles 12000 --samples 0 | grep -c -e --solid | grep -q -x 1"
reports 'bodies that overlap stay two' 'r["meshes"][0]["components"] == 2 and r["meshes"][0]["triangles"] == 24 and r["meshes"][0]["crossings"] > 0 and r["warnings"] == []' \
    lod two.obj -o k.ply --triangles 24 --samples 0
works 'lod of bodies that overlap' lod two.obj -o k.ply --triangles 24 --samples 0
holds 'crossings are those of the input' says ' met +[0-9]+ crossings .of the input.$'
reports 'flipped triangles are turned' 'r["levels"]["turned"] == 7680 and r["meshes"][0]["oriented"] and r["meshes"][0]["closed"]' lod flipped.obj -o k.ply --triangles 2000 --samples 0
holds 'lod of flipped triangles is whole' whole k.ply
reports 'a triangle stays one' 'r["meshes"][0]["triangles"] == 1 and r["meshes"][0]["met"]' lod flat.obj -o k.ply --triangles 4 --samples 0
awk '{ print } $1 == "v" { more = more "v " $2 + 2 " " $3 + 2 " " $4 "\n" }
    $1 == "f" { more = more "f " $2 + 8 " " $3 + 8 " " $4 + 8 " " $5 + 8 "\n" } END { printf "%s", more }' cube.obj >beside.obj
reports 'cubes that touch along an edge stay two' 'r["levels"]["parted"] == 1 and r["levels"]["split"] == 2 and r["meshes"][0]["components"] == 2 and
r["meshes"][0]["volume"] == 16 and r["meshes"][0]["closed"] and r["warnings"] == []' lod beside.obj -o k.ply --triangles 24 --samples 0
holds 'what was made ready is told' sh -c "'$program' lod beside.obj -o k.ply --triangles 24 --samples 0 | grep -q '^made ready: 2 vertices split where fans meet, 1 edge of several sheets parted$'"
reports 'a solid has no more triangles than the input' 'r["levels"]["surface_triangles"] > 40000 and all(m["triangles"] <= 25600 and not m["met"] for m in r["meshes"])' \
    lod holes.obj -o k_%d.ply --resolution 96 --error 1e-7,2e-7 --samples 500
warns 'no mesh with the target error of 1e-7 was found; take a larger one; 1 more level missed theirs' lod holes.obj -o k_%d.ply --resolution 96 --error 1e-7,2e-7 --samples 500
rm -f k.ply k_?.ply

# Warnings, and targets that cannot be kept.
warns 'level 1: the target of 2 triangles is missed: 4 are' lod cube.obj -o c_%d.ply --triangles 4,2 --samples 0
holds 'a target that is not kept is marked' says '^ +1 +4 +2 .* NOT MET +yes$'
holds 'a target that is not kept: both levels are written' sh -c 'test -s c_0.ply && test -s c_1.ply'
rm -f c_?.ply
refuses 1 'level 1' lod cube.obj -o c_%d.ply --triangles 4,2 --samples 0 --strict
refuses 1 'level 0' simplify cube.obj -o c.ply --triangles 2 --strict
warns 'a volume of 1, but 8 before edges collapsed (-87.5 %)' lod cube.obj -o c.ply --triangles 4 --samples 0
rm -f c.ply
warns 'the memory limit lowered the resolution from 256 to ' lod "$knot" -o c.ply --triangles 400 --solid --memory-limit 20M --samples 0
reports 'lod with a memory limit' '32 <= r["levels"]["resolution"] < r["levels"]["planned_resolution"] == 256 and r["peak_bytes"] <= 20 * 2 ** 20' \
    lod "$knot" -o c.ply --triangles 400 --solid --memory-limit 20M --samples 0
refuses 1 'limit' lod "$knot" -o c.ply --triangles 400 --resolution 256 --memory-limit 20M --samples 0
works 'a finer mesh for memory limits' repair "$knot" -o fine.ply --resolution 96 --quiet
reports 'lod of a fine mesh' 'r["levels"]["solid"] is False' lod fine.ply -o c.ply --triangles 400 --samples 0
refuses 1 'bytes is too small for 64672 triangles; ' lod fine.ply -o c.ply --triangles 400 --samples 0 --memory-limit 9M
holds 'what the file takes of the limit' grep -q 'suffice; the file takes 1228971 bytes of --memory-limit besides' err
rm -f fine.ply
reports 'parts that cross become one, as they should' 'r["meshes"][0]["components"] == 1 and r["warnings"] == []' lod two.obj -o c.ply --triangles 200 --samples 0 --solid
rm -f c.ply

# Colours go along.
works 'lod of colours' lod coloured.obj -o c_%d.obj --triangles 4000,2500 --samples 0 --quiet
awk '$1 == "v" { n++; d = $5 - ($2 / 10 + 0.5); if (d > 0.03 || d < -0.03 || $7 < 0.99) bad++ } END { exit !(n > 200 && bad == 0) }' c_1.obj
result 'colours are those of the position' $?
reports 'lod of colours --json' 'all(m["colours"] for m in r["meshes"])' lod coloured.obj -o c_%d.ply --triangles 400,50 --samples 0
works 'lod --solid --carry' lod coloured.obj -o c_%d.obj --triangles 4000,2500 --samples 0 --solid --carry --quiet
awk '$1 == "v" { n++; d = $5 - ($2 / 10 + 0.5); if (d > 0.03 || d < -0.03 || $7 < 0.99) bad++ } END { exit !(n > 200 && bad == 0) }' c_1.obj
result 'carried colours are those of the position' $?
refuses 2 'levels of the mesh as it is have what it has' lod coloured.obj -o c_%d.obj --triangles 4000 --carry
refuses 2 'the surface that --solid measures has none' lod coloured.obj -o c_%d.obj --triangles 4000 --solid --attributes 2
warns 'colours are not kept; --carry keeps them' lod coloured.obj -o c_0.obj --triangles 400 --samples 0 --solid
warns 'colours are not kept; .glb keeps them' simplify coloured.obj -o c_0.stl --triangles 400 --samples 0
# A tetrahedron with a side twice, and one with a side turned: mended with a warning.
tetrahedron() { printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\n%s\n' "$1"; }
{ tetrahedron 'f 2 3 4'; echo 'f 2 3 4'; } >doubled.obj
tetrahedron 'f 2 4 3' >turned.obj
reports 'simplify says that triangles are there twice' '[(w["code"], w["values"]) for w in r["warnings"]] == [("BVX_WARN_DOUBLES", [1])]' \
    simplify doubled.obj -o x.ply --triangles 4 --samples 0
reports 'and which were turned' '[(w["code"], w["values"]) for w in r["warnings"]] == [("BVX_WARN_TURNED", [1])]' simplify turned.obj -o x.ply --triangles 4 --samples 0
works 'simplify of colours' simplify coloured.obj -o c_0.obj --triangles 4000 --samples 0 --quiet
holds 'simplify of colours: six numbers a vertex' test "$(awk '$1 == "v" && NF == 7' c_0.obj | wc -l)" -gt 1000
awk '/^f/ && ++n == 500 { next } 1' knot.obj >holed.obj
reports 'simplify --topology keep: a hole stays' 'r["meshes"][0]["holes_filled"] == 0 and not r["meshes"][0]["closed"]' \
    simplify holed.obj -o x.ply --triangles 2000 --samples 0 --topology keep
reports 'lod --topology simplify: it is filled' 'r["meshes"][0]["holes_filled"] == 1 and r["meshes"][0]["closed"] and r["meshes"][0]["longest_closed"] > 0' \
    lod holed.obj -o x_%d.ply --triangles 2000 --samples 0 --topology simplify
refuses 2 'simplify has no use for --carry' simplify coloured.obj -o c_0.obj --carry
refuses 2 'neither colours nor texture coordinates' lod knot.obj -o x_%d.ply --solid --carry
works 'simplify --keep-vertices' simplify coloured.obj -o c_0.obj --triangles 4000 --samples 0 --keep-vertices --quiet
holds 'simplify --keep-vertices: all of them, with their colours' sh -c 'grep "^v " coloured.obj | wc -l >n && test "$(awk "\$1 == \"v\" && NF == 7" c_0.obj | wc -l)" -eq "$(cat n)"'

# A skin stays in the file where levels use its vertices; else it is said to be lost.
cat >skin.gltf <<'END'
{"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1]}], "nodes": [{"mesh": 0, "skin": 0}, {"name": "hip"}], "skins": [{"joints": [1]}],
"meshes": [{"primitives": [{"attributes": {"POSITION": 0, "JOINTS_0": 1, "WEIGHTS_0": 2}, "indices": 3}]}], "accessors": [
{"bufferView": 0, "componentType": 5126, "count": 9, "type": "VEC3", "min": [0, 0, 0], "max": [2, 2, 0]},
{"bufferView": 1, "componentType": 5121, "count": 9, "type": "VEC4"}, {"bufferView": 2, "componentType": 5126, "count": 9, "type": "VEC4"},
{"bufferView": 3, "componentType": 5121, "count": 24, "type": "SCALAR"}], "bufferViews": [{"buffer": 0, "byteLength": 108},
{"buffer": 0, "byteOffset": 108, "byteLength": 36}, {"buffer": 0, "byteOffset": 144, "byteLength": 144}, {"buffer": 0, "byteOffset": 288, "byteLength": 24}],
"buffers": [{"byteLength": 312, "uri": "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAQAAAAAAAAAAAAAAAAAAAgD8AAAAAAACAPwAAgD8AAAAAAAAAQAAAgD8AAAAAAAAAAAAAAEAAAAAAAACAPwAAAEAAAAAAAAAAQAAAAEAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAAAAAAAAAIA/AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAAAAAAAAAIA/AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAAAAAAAAAIA/AAAAAAAAAAAAAAAAAAEEAAQDAQIFAQUEAwQHAwcGBAUIBAgH"}]}
END
works 'simplify --keep-vertices of a skin' simplify skin.gltf -o skin.glb --triangles 2 --keep-vertices
holds 'simplify --keep-vertices of a skin: no loss' sh -c '! grep -q "not read" err && grep -q -a "skins" skin.glb'
works 'lod --keep-vertices of a skin' lod skin.gltf -o skin_%d.glb --triangles 6,2 --keep-vertices
holds 'lod --keep-vertices of a skin: no loss' sh -c '! grep -q "not read" err && grep -q -a "skins" skin_0.glb && grep -q -a "WEIGHTS_0" skin_1.glb'
for lost in '-o skin_%d.glb --triangles 6,2' '-o skin.glb --triangles 6,2 --keep-vertices' '-o skin.ply --triangles 2 --keep-vertices' \
    '-o skin.glb --triangles 2 --keep-vertices --quantize' '-o skin.glb --triangles 2 --keep-vertices --output-origin 1,0,0'; do
    warns 'skin.gltf: not read: skins' simplify skin.gltf $lost
done

rm -f n

# Borders between colours.
awk '$1 == "v" { print $0, $2 < 0 ? "1 0 0" : "0 0 1"; next } { print }' knot.obj >painted.obj
works 'simplify --attributes 0' simplify painted.obj -o plain.obj --triangles 1500 --samples 0 --quiet --attributes 0
works 'simplify --attributes' simplify painted.obj -o c_0.obj --triangles 1500 --samples 0 --attributes 5 --quiet
works 'lod --attributes' lod painted.obj -o c_1.obj --triangles 1500 --samples 0 --attributes 5 --quiet
holds 'both weigh colours alike' cmp -s c_0.obj c_1.obj
# How far vertices of mixed colours lie from the border at x = 0, in the mean.
mixed() { awk '$1 == "v" && $5 > 0.02 && $5 < 0.98 { n++; sum += $2 < 0 ? -$2 : $2 } END { printf "%d\n", n == 0 ? 0 : 1e6 * sum / n }' "$1"; }
holds "the border between the colours stays: $(mixed c_0.obj), $(mixed plain.obj)" test "$(mixed c_0.obj)" -lt "$(mixed plain.obj)"
for value in -0.1 1000.1 x; do refuses 2 'from 0 to 1000' lod painted.obj -o x_%d.ply --attributes "$value"; done
rm -f plain.obj c_?.obj
refuses 2 '.stl holds neither' lod coloured.obj -o x.stl --count 1 --solid --carry
rm -f c_?.*

# All levels in one file.
does 'all levels in one .glb' lod "$knot" -o all.glb --triangles 3000,600,100 --samples 0
holds 'all levels in one .glb: it is named once' says '^written: all.glb$'
holds 'all levels in one .glb: three nodes, and the extension' sh -c 'for i in 0 1 2; do grep -a -q "\"level_$i\"" all.glb || exit 1; done; grep -a -q MSFT_lod all.glb'
works_here '.glb by halves' '' lod "$knot" -o halves.glb --samples 0
holds '.glb by halves: four' sh -c 'grep -a -q level_3 halves.glb && ! grep -a -q level_4 halves.glb'
works 'one level in a .glb' simplify "$knot" -o one.glb --samples 0
holds 'one level in a .glb: no extension' sh -c '! grep -a -q MSFT_lod one.glb'
works 'levels by samples in one .glb' lod "$knot" -o samples.glb --levels 24,12 --samples 0 --quiet
warns 'level 1 has 3 parts, the mesh 1: what is thinner than its samples broke' lod "$knot" -o samples.glb --levels 24,12 --samples 0
warns 'level 0 has a volume of 26.3' lod "$knot" -o samples.glb --levels 24,12 --samples 0
echo older >k_1.ply
warns 'level 1, 1 x 1 x 1 samples, keeps nothing of the solid; take more samples for it, or a lower threshold; k_1.ply is not written' \
    lod "$knot" -o k_%d.ply --levels 32,1,16 --samples 500
holds 'a level that keeps nothing: the others are written, what stood at its name stays' sh -c 'test -s k_0.ply && test -s k_2.ply && test "$(cat k_1.ply)" = older'
holds 'a level that keeps nothing: nothing else is there' test "$(ls k_* bitvox-* 2>/dev/null | tr '\n' ' ')" = 'k_0.ply k_1.ply k_2.ply '
holds 'a level that keeps nothing: the others keep their numbers' test "$(awk '/^ +[0-9] / { printf "%s ", $1 }' out)" = '0 2 0 2 '
holds 'a level that keeps nothing: what is written' says '^written: k_0.ply, k_2.ply$'
"$program" lod "$knot" -o alone.ply --levels 16 --resolution 256 --samples 0 --quiet 2>err
holds 'a level that keeps nothing: the one after it is as if alone' cmp k_2.ply alone.ply
reports 'a level that keeps nothing --json' '[(m["level"], m["path"]) for m in r["meshes"]] == [(0, "k_0.ply"), (2, "k_2.ply")] and
[s["name"] for s in r["stages"] if s["name"][-1] in "12"] == ["level 1", "level 2", "check 2", "distance 2"] and
any(w["message"].startswith("level 1, ") and w["message"].endswith("k_1.ply is not written") for w in r["warnings"])' lod "$knot" -o k_%d.ply --levels 32,1,16 --samples 500
warns 'or a lower threshold; samples.glb is written without it' lod "$knot" -o samples.glb --levels 32,16,1 --samples 0
holds 'a level that keeps nothing in a .glb: two' sh -c 'grep -a -q level_1 samples.glb && ! grep -a -q level_2 samples.glb'
rm -f k_?.ply alone.ply
echo older >k_1.ply
warns 'level 1 asks for at most 4 triangles; none of the resolutions tried keeps anything in so few; take more triangles for it, or --method collapse; k_1.ply is not written' \
    lod "$knot" -o k_%d.ply --method coverage --triangles 3000,4,900 --samples 0
holds 'a target by samples too small: the others are written, what stood at its name stays' sh -c 'test -s k_0.ply && test -s k_2.ply && test "$(cat k_1.ply)" = older'
holds 'a target by samples too small: what is written' says '^written: k_0.ply, k_2.ply$'
refuses 1 'level 1 asks for at most 2 triangles; none of the resolutions tried keeps anything in so few; take more triangles for it, or --method collapse' \
    lod "$knot" -o k_%d.ply --method coverage --triangles 4,2 --resolution 64 --samples 0
rm -f k_?.ply
does 'levels by samples in one .glb' lod "$knot" -o samples.glb --levels 24,12 --samples 0
holds 'levels by samples in one .glb: both' grep -a -q level_1 samples.glb
reports 'levels in one .glb --json' '[m["path"] for m in r["meshes"]] == ["all.glb", "all.glb"] and r["meshes"][1]["triangles"] <= 100' lod "$knot" -o all.glb --triangles 600,100 --samples 0
does '.glb each' lod "$knot" -o each_%d.glb --triangles 600,100 --samples 0
holds '.glb each: two files' sh -c 'test -s each_0.glb && test -s each_1.glb && ! grep -a -q MSFT_lod each_0.glb'
rm -f ./*.glb

# ---- Contradictions ----

refuses 2 '--levels is for --method edge-ratio and coverage' lod "$knot" -o x_%d.ply --method collapse --levels 64
refuses 2 'collapse takes --triangles, --error or --count' lod "$knot" -o x_%d.ply --method collapse --fill nonzero
refuses 2 '--error is for --method collapse, and --levels for' lod "$knot" -o x_%d.ply --levels 64 --error 1%
refuses 2 '--count is for --method collapse, not for coverage' lod "$knot" -o x_%d.ply --method coverage --count 3
refuses 2 '--triangles and --error exclude each other' lod "$knot" -o x_%d.ply --triangles 3 --error 1
refuses 2 '--triangles and --count exclude each other' lod "$knot" -o x_%d.ply --triangles 3 --count 1
refuses 2 '--error and --count exclude each other' simplify "$knot" -o x_%d.ply --error 3 --count 1
refuses 2 '--error-kind needs --error' lod "$knot" -o x_%d.ply --error-kind max
refuses 2 '--sharp and --no-sharp exclude' lod "$knot" -o x_%d.ply --sharp --no-sharp
refuses 2 '--outer-hull fills every cavity' lod "$knot" -o x_%d.ply --outer-hull --least-cavity 9
for option in --solid '--resolution 64' '--sign vote' --sharp '--shell 3' --outer-hull '--least-part 9' '--keep-largest 1'; do
    # shellcheck disable=SC2086 # an option and its value
    refuses 2 'keeps vertices of the mesh, and --' lod "$knot" -o x_%d.ply --lock-border $option
done
refuses 2 'keeps vertices of the mesh, and --solid' lod "$knot" -o x_%d.ply --keep-vertices --solid
refuses 2 'is not an option of lod' lod "$knot" -o x_%d.ply --source mesh
refuses 2 'simplify has no use for --open' simplify "$knot" -o x_%d.ply --open keep
refuses 2 'is for volumes' lod "$knot" -o x_%d.ply --level 16
refuses 2 'more than the 16777216' lod "$knot" -o x_%d.ply --resolution 20000000
refuses 2 'need %d' lod "$knot" -o x.ply --count 2
refuses 2 'need %d' simplify "$knot" -o x.obj --triangles 3000,300
refuses 2 'only .glb holds several' lod "$knot" -o x.ply
refuses 2 'has two %d' lod "$knot" -o x_%d_%d.glb
for value in '' 0 -1 0% 1,,2 1% 1%%; do
    [ "$value" = 1% ] || refuses 2 'distances above 0' lod "$knot" -o x_%d.ply --error "$value"
done
for value in 0 65 1.5; do refuses 2 'from 1 to 64' lod "$knot" -o x_%d.ply --count "$value"; done
for value in -0.1 1.1 x; do refuses 2 'from 0 to 1' lod "$knot" -o x_%d.ply --even "$value"; done
"$program" voxelize "$knot" -o grid.npy --resolution 20 --quiet
refuses 2 'grid.npy is a grid, whose surface is closed' lod grid.npy -o x_%d.ply --triangles 500 --solid
refuses 2 '--count is for --method collapse, not for edge-ratio' lod grid.npy -o x_%d.ply --count 2
refuses 2 'simplify is for meshes' simplify grid.npy -o x.ply
works 'a grid still has levels' lod grid.npy -o g_%d.ply --samples 0
holds 'a grid has levels by samples' says '^level  resolution '
does '--triangles of a grid' lod grid.npy -o g_%d.ply --triangles 500,100 --samples 0
holds '--triangles of a grid: whole' whole g_1.ply
holds '--triangles of a grid: its surface collapses' says "^levels from the grid's surface, 1 piece, in "
does '--error of a grid' lod grid.npy -o g_%d.ply --error 0.5% --samples 0
does '--method collapse of a grid' lod grid.npy -o g_%d.ply --method collapse --count 2 --samples 0
works '--method edge-ratio of a grid by triangles' lod grid.npy -o g_%d.ply --method edge-ratio --triangles 500,100 --samples 0
holds '--method edge-ratio of a grid by triangles: samples' says '^level  resolution '
works_here '--triangles of a volume' g_0.ply lod "$root/fixtures/waves.nhdr" -o g_%d.ply --level 120 --triangles 1500 --samples 0
rm -f grid.npy* g_?.ply

# ---- simplify ----

works_here 'simplify' s.ply simplify "$knot" -o s.ply
holds 'simplify: half' test "$(triangles_of s.ply)" = 19200
holds 'simplify: the table' says '^ +0 +19200 +19200 +50.00% .* met +yes$'
works_here 'simplify --triangles' 's_0.stl s_1.stl' simplify "$knot" -o s_%d.stl --triangles 4000,3000
works_here 'simplify --count' 's_0.ply s_1.ply s_2.ply' simplify "$knot" -o s_%d.ply --count 3 --samples 0
works_here 'simplify --error' s.ply simplify "$knot" -o s.ply --error 0.01
reports 'simplify --json' 'r["meshes"][0]["met"] and r["meshes"][0]["solid"] is False and 0.007 < r["meshes"][0]["mean_distance"] <= 0.01' simplify "$knot" -o s.ply --error 0.01
"$program" simplify "$knot" -o a.ply --triangles 700 --quiet
"$program" lod "$knot" -o b.ply --triangles 700 --quiet
holds 'simplify and lod agree on a sound mesh' cmp a.ply b.ply
works_here 'simplify turns flipped triangles' s.ply simplify flipped.obj -o s.ply --triangles 2000 --samples 0 --quiet

# ---- sheets ----

# A square of 8 x 8 cells with a hole, and the same with a wall on it.
awk 'BEGIN { for (y = 0; y <= 8; y++) for (x = 0; x <= 8; x++) print "v", x, y, 0
    for (y = 0; y < 8; y++) for (x = 0; x < 8; x++) if (x < 3 || x > 4 || y < 3 || y > 4) { a = 9 * y + x + 1; print "f", a, a + 1, a + 10, a + 9 } }' >sheet.obj
awk '{ print } END { for (y = 0; y <= 8; y++) print "v", 2, y, 3; for (y = 0; y < 8; y++) print "f", 9 * y + 3, 9 * y + 12, 83 + y, 82 + y }' sheet.obj >wall.obj
works 'simplify of a sheet' simplify sheet.obj -o s.ply --triangles 8 --even 0
holds 'simplify of a sheet: it stays open' says '^ +0 +8 +8 .* met +8 border edges .of the input.$'
reports 'lod of a sheet' 'r["levels"]["solid"] is False and r["levels"]["input_border_edges"] == 40 and r["levels"]["cut"] == 0 and
not r["meshes"][0]["closed"] and r["meshes"][0]["manifold"] and r["meshes"][0]["oriented"] and r["meshes"][0]["boundary_edges"] == 8 and
r["meshes"][0]["crossings"] == 0 and r["warnings"] == []' lod sheet.obj -o s.ply --triangles 8
why --solid sheet.obj --solid
warns 'cut: 8 edges of three triangles and more, or whose triangles cannot agree, the first from 2,' lod wall.obj -o s.ply --triangles 12 --samples 0
works 'lod --solid of three sheets' lod wall.obj -o s.ply --triangles 400 --samples 0 --solid --quiet
holds 'lod --solid of three sheets: a shell' whole s.ply
warns 'cut: 8 edges of three triangles' simplify wall.obj -o s.ply
rm -f s.ply
refuses 2 'has no use for --resolution' simplify "$knot" -o x.ply --resolution 64
refuses 1 'No such file' simplify missing.ply -o x.ply
rm -f s.ply s_?.* a.ply b.ply

# ---- One mesh and fewer triangles ----

works_here 'repair --triangles' r.ply repair holes.obj -o r.ply --resolution 48 --triangles 3000 --measure
holds 'repair --triangles: all that was asked for' test "$(triangles_of r.ply)" -ge 2990 -a "$(triangles_of r.ply)" -le 3000
holds 'repair --triangles: told' says '^  collapsed   (2999|3000|299[0-9]) of [0-9]+ triangles are left; smallest angle '
works_here 'repair --error' r.ply repair holes.obj -o r.ply --resolution 48 --error 0.1%
reports 'repair --triangles --json' 'r["simplify"]["met"] and r["simplify"]["triangles_before"] > 9000 and r["meshes"][0]["triangles"] <= 1000 and
r["simplify"]["crossings"] == 0 and r["meshes"][0]["mean_distance"] > 0' repair "$knot" -o r.ply --resolution 64 --triangles 1000 --measure
warns 'before edges collapsed (-4.33 %); more triangles keep it nearer' repair coloured.obj -o r.obj --resolution 64 --triangles 400 --carry
holds 'repair --triangles --carry: colours' grep -q -E '^v( [^ ]+){6}$' r.obj
refuses 2 'exclude each other' repair "$knot" -o x.ply --triangles 10 --error 1
refuses 2 '--error-kind needs --error' repair "$knot" -o x.ply --error-kind max
works_here 'a cube that was flipped has 12 triangles again' r.ply repair cube.obj -o r.ply --resolution 64 --sharp --triangles 12
works_here 'boolean --triangles' r.ply boolean union cube.obj two.obj -o r.ply --resolution 48 --triangles 300
works_here 'boolean --error of grids' r.ply boolean xor cube.obj two.obj -o r.ply --resolution 48 --error 1%
refuses 2 'the result is a grid' boolean union cube.obj two.obj -o x.npy --triangles 300
"$program" slice "$knot" -o knot.csv --spacing 0.2 --quiet
run sections knot.csv -o r.ply --triangles 2000 --quiet
holds 'sections --triangles' sh -c "test $status = 0 && test $(triangles_of r.ply) -le 2000"
reports 'sections --triangles --json' 'r["simplify"]["triangles"] == r["meshes"][0]["triangles"] <= 2000 and r["sections"]["points"] > 100' sections knot.csv -o r.ply --triangles 2000 --quiet
refuses 2 'needs a closed body' sections knot.csv -o x.ply --triangles 2000 --caps open
works_here 'voxelize --level --triangles' r.ply voxelize "$root/fixtures/waves.nhdr" -o r.ply --level 120 --triangles 1500
refuses 2 'the result is a grid' voxelize "$knot" -o x.npy --triangles 9
refuses 2 'the result is a grid' voxelize "$root/fixtures/waves.nhdr" -o x.bvx --level 120 --error 9
warns 'the target of 2 triangles is missed: 12 are' repair cube.obj -o r.ply --resolution 32 --triangles 2
rm -f r.* p_?.ply knot.csv

counts
