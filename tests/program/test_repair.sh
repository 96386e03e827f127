#!/bin/sh
# test_repair.sh [PROGRAM] - the commands repair and hull of the bitvox program. PROGRAM is build/bitvox, or what BITVOX names. One line a
# check, "ok NAME" or "not ok NAME"; the last line is "N passed, N failed[, N skipped]". Runs in the repository's root, works in a
# folder of its own.
set -u
. tests/tools/program_checks.sh
terrain=$root/fixtures/terrain.ply
meshes=$root/../shared/meshes

# The result is certified by info, a second reading of the file.
certified() { # NAME, IN, OPTIONS...
    name=$1 in=$2
    shift 2
    rm -f result.ply
    run repair "$in" -o result.ply --quiet "$@"
    [ $status = 0 ] && [ ! -s err ] && "$program" info result.ply --json 2>>err | grep -q '"closed": true, "manifold": true, "oriented": true'
    result "$name" $?
}

refuses() { # STATUS, WORDS, ARGUMENTS...: one line with these words, and no file
    want=$1 words=$2
    shift 2
    rm -f result.ply
    run repair "$@"
    [ $status = "$want" ] && [ "$(wc -l <err)" = 1 ] && grep -q -e "$words" err && [ ! -e result.ply ]
    result "refused ($want): $words" $?
}

# The knot as text, less a third of its triangles; and with every fifth turned over.
"$program" convert "$knot" -o knot.obj --quiet
awk '/^f / { if (++n % 3 == 0) next } { print }' knot.obj >holes.obj
awk '/^f / { if (++n % 5 == 0) { print "f", $3, $2, $4; next } } { print }' knot.obj >flipped.obj

certified 'closed mesh' "$knot" --resolution 96
certified 'holes' holes.obj --resolution 48
certified 'flipped triangles' flipped.obj --resolution 64
run repair "$terrain" -o result.ply --resolution 64
[ $status = 0 ] && grep -q 'warning: [0-9]* triangles with \([0-9]*\) of the area of \1 enclose nothing and became hollow shells.*\[BVX_WARN_SHELLS\]$' err && [ "$(wc -l <err)" = 1 ]
result 'open terrain becomes a shell, with a warning' $?
certified 'sharp' "$knot" --resolution 48 --sharp
for how in vector scalar middle paper tangent; do certified "interpolation $how" holes.obj --resolution 32 --interpolation $how; done
for sign in parity winding vote; do certified "sign $sign" holes.obj --resolution 32 --sign $sign; done
certified 'most triangles' "$knot" --resolution 64 --triangles 3000
certified 'clean' holes.obj --resolution 32 --least-part 20 --least-cavity 20

# A plate of a sixteenth of a voxel.
awk 'BEGIN {
    for (i = 0; i < 8; i++) print "v", i % 2 * 2, int(i / 2) % 2 * 2, int(i / 4) * 0.002
    print "f 1 3 4\nf 1 4 2\nf 5 6 8\nf 5 8 7\nf 1 2 6\nf 1 6 5\nf 3 7 8\nf 3 8 4\nf 1 5 7\nf 1 7 3\nf 2 4 8\nf 2 8 6"
}' >plate.obj
certified 'thin plate' plate.obj --resolution 128
run repair plate.obj -o result.ply --resolution 128 --json
[ $status = 0 ] && grep -q '"thin_resolution": 1500, "thin_kept": true, ' out &&
    grep -q '"volume_after": 0.008' out && [ "$(grep -o '"code": "[A-Z_]*"' out)" = '"code": "BVX_WARN_VOLUME"' ]
result 'thin plate keeps its volume but for 3 %, which is told' $?
# Half of it is a box, so that something is left without the plate.
awk 'BEGIN {
    for (i = 0; i < 8; i++) print "v", 3 + i % 2, int(i / 2) % 2 * 2, int(i / 4)
    print "f 9 11 12\nf 9 12 10\nf 13 14 16\nf 13 16 15\nf 9 10 14\nf 9 14 13\nf 11 15 16\nf 11 16 12\nf 9 13 15\nf 9 15 11\nf 10 12 16\nf 10 16 14"
}' >box.obj
cat plate.obj box.obj >both.obj
run repair both.obj -o result.ply --resolution 64 --thin drop
[ $status = 0 ] && grep -q 'warning: walls thinner than 1.5 voxels are lost .*, in 0,0,.* keeps nine tenths of them' err
result 'dropped walls are warned of' $?

# A lattice too coarse for the knot's gaps; the finer one keeps its one handle.
run repair "$knot" -o result.ply --resolution 10
[ $status = 0 ] && grep -q 'warning: the result has 2 handles, the input 1: ' err
result 'handles that the mesh does not have are warned of' $?
run repair "$knot" -o result.ply --resolution 12
[ $status = 0 ] && ! grep -q handles err
result 'its own handle is not' $?
run repair both.obj -o result.ply --resolution 64
[ $status = 0 ] && grep -q '^  thin .*: kept$' out && grep -q '; 2 components, volume 2.00[78]' out
result 'kept walls are told' $?

# A slanted rod of twelve sides keeps its volume two voxels thick and loses some at little more than one: sound, and with a triangle
# turned, missing, there twice.
slanted_rod 0 >round.obj
awk '/^f/ && ++n == 9 { print "f", $2, $4, $3; next } { print }' round.obj >turned.obj
awk '/^f/ && ++n == 9 { next } { print }' round.obj >missing.obj
awk '{ print } /^f/ && ++n == 9 { print }' round.obj >twice.obj
for rod in round turned missing twice; do
    run repair $rod.obj -o result.ply --resolution 64
    [ $status = 0 ] && [ ! -s err ]
    result "a round rod of two voxels keeps its volume: $rod" $?
    run repair $rod.obj -o result.ply --resolution 36
    [ $status = 0 ] && [ "$(grep -c 'warning: .*volume .* (-[0-9.]* %)' err)" = 1 ] && [ "$(wc -l <err)" = 1 ]
    result "a rod that becomes thinner is told: $rod" $?
done
run lod missing.obj -o result.ply --solid --triangles 2000 --samples 0 --resolution 36
[ $status = 0 ] && grep -q 'warning: the result has a volume of .*, the input about .* (-[0-9.]* %)' err
result 'and by lod --solid' $?
run repair missing.obj -o result.ply --resolution 400
[ $status = 0 ] && [ ! -s err ]
result 'and not where voxels hold it' $?

# A cube without its lid: a sixth of the surface is a guess.
awk 'BEGIN {
    for (i = 0; i < 8; i++) print "v", i % 2, int(i / 2) % 2, int(i / 4)
    print "f 1 3 4\nf 1 4 2\nf 1 2 6\nf 1 6 5\nf 3 7 8\nf 3 8 4\nf 1 5 7\nf 1 7 3\nf 2 4 8\nf 2 8 6"
}' >open.obj
run repair open.obj -o result.ply --resolution 32
[ $status = 0 ] && grep -q 'warning: lids over 1 hole are about [0-9.]* % of the surface, the longest rim is 4, in 0,0,1 to 1,1,1: ' err
result 'lids that are much of the surface are warned of, with the place of the longest rim' $?
! grep -q inward err
result 'and faces that look outward are not' $?

# The same as a room: its walls look inward, and what is in it becomes solid.
awk '$1 == "f" { print "f", $2, $4, $3; next } { print }' open.obj >room.obj
run repair room.obj -o result.ply --resolution 32
[ $status = 0 ] && grep -q 'warning: the faces of the open mesh look inward, around a volume of 0.833333, ' err
result 'an open mesh that faces inward is warned of' $?

# Bars aslant, whose boxes overlap: two cross, and a third one lies a fifth of a voxel beside.
aslant() { # Y OF EACH BAR...
    awk -v places="$*" 'BEGIN {
        n = split(places, y, " ")
        for (b = 1; b <= n; b++) for (i = 0; i < 8; i++) print "v", 3 * (i % 2), 3 * (i % 2) + 0.4 * (int(i / 2) % 2) + y[b], 0.3 * int(i / 4)
        for (b = 0; b < n; b++) for (i = split("1 3 4 1 4 2 5 6 8 5 8 7 1 2 6 1 6 5 3 7 8 3 8 4 1 5 7 1 7 3 2 4 8 2 8 6", c, " "); i > 0; i -= 3)
            print "f", c[i - 2] + 8 * b, c[i - 1] + 8 * b, c[i] + 8 * b
    }'
}
aslant 0 0.2 0.62 >bars.obj
run repair bars.obj -o result.ply --resolution 40
[ $status = 0 ] && grep -q 'warning: the result has 1 part, the input 2: ' err
result 'a gap that closed is warned of where other parts cross' $?
aslant 0 0.2 0.39 >bars.obj
run repair bars.obj -o result.ply --resolution 40
[ $status = 0 ] && ! grep -q 'the input 2' err
result 'and none where all cross' $?

# A rod of a tenth of a voxel, its triangles there twice, once either way: counted once they say that its shell is thicker.
awk 'BEGIN {
    for (z = 0; z < 2; z++) for (y = 0; y < 2; y++) for (x = 0; x < 2; x++) print "v", 10 * x - 0.08 * y, 6 * x + 0.1 * y, 3 * x + 0.1 * z
    n = split("1 3 4 2 5 6 8 7 1 2 6 5 3 7 8 4 1 5 7 3 2 4 8 6", c)
    for (i = 1; i < n; i += 4) {
        print "f", c[i], c[i + 1], c[i + 2] "\nf", c[i], c[i + 2], c[i + 3]
        print "f", c[i], c[i + 2], c[i + 1] "\nf", c[i], c[i + 3], c[i + 2]
    }
}' >rod.obj
run repair rod.obj -o result.ply --resolution 10
[ $status = 0 ] && grep -q 'warning: the result has a volume of .*, all parts of the input together 0.148 (+[0-9]* %): .* became thicker' err
result 'swollen bodies of double triangles are told' $?
run repair rod.obj -o result.ply --resolution 1000
[ $status = 0 ] && [ ! -s err ] && ! grep -q shells out
result 'and not where voxels hold them' $?

run repair flipped.obj -o result.ply --resolution 48 --measure --json
grep -q '"repair": {"sign": "winding", .*"holes": 0,' out && grep -q '"mean_output_to_input": ' out && grep -q '"volume_after": ' out
result 'report for programs' $?
run repair holes.obj -o result.ply --resolution 32 --measure
grep -q '^  found       open' out && grep -q '^  holes  ' out && grep -q 'closed, manifold, oriented' out && grep -q '^  distance' out
result 'text' $?
for n in 1 3; do "$program" repair holes.obj -o t$n.ply --resolution 32 --threads $n --quiet; done
cmp -s t1.ply t3.ply
result 'threads do not show' $?

run repair holes.obj -o result.obj --resolution 32 --normals
test $status = 0 && test "$(grep -c '^vn ' result.obj)" = "$(grep -c '^v ' result.obj)"
result 'normals' $?
refuses 2 'normals of triangles' "$knot" -o result.stl --normals

refuses 1 'No such file' missing.ply -o result.ply
"$program" repair "$knot" -o needed.ply --if-needed --json >needed.json 2>/dev/null && grep -q '"needs": "nothing", "copied": true' needed.json
result 'a sound mesh is copied' $?
# The same format: the file itself, also over itself. Another one: with the attributes.
printf '# its own\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 3/3 2/2\nf 1/1 2/2 4/3\nf 2/2 3/3 4/1\nf 3/3 1/1 4/2\n' >own.obj
cp own.obj same.obj
run repair same.obj -o same.obj --if-needed
[ $status = 0 ] && [ ! -s err ] && cmp -s own.obj same.obj
result 'what needs nothing keeps its bytes' $?
run repair own.obj -o own.ply --if-needed
[ $status = 0 ] && [ ! -s err ] && "$program" convert own.ply -o back.obj --quiet && [ "$(grep -c '^vt ' back.obj)" -ge 3 ]
result 'a copy in another format has the attributes' $?
run repair own.obj -o same.obj --resolution 16
[ $status = 0 ] && grep -q 'texture coordinates are not kept; --carry' err
result 'what is lost is said' $?
run repair own.obj -o same.obj --resolution 16 --carry
[ $status = 0 ] && [ "$(grep -c 'own.obj: seams of its texture are not kept.*\[BVX_WARN_LOST\]' err)" = 1 ]
result 'seams that are not carried are said' $?
{ grep '^v ' own.obj && printf 'vt %s\n' '1 1' '0 1' '1 0' '0 0' && printf 'f %s\n' '1/4 3/2 2/3' '1/4 2/3 4/1' '2/3 3/2 4/1' '3/2 1/4 4/1'; } >whole.obj
run repair whole.obj -o same.obj --resolution 16 --carry
[ $status = 0 ] && ! grep -q seams err
result 'a texture without seams has no word of them' $?
certified 'parts are kept' "$knot" --resolution 24 --least-part 0
# Two boxes apart: the smaller one goes without a word about the volume that is gone with it.
printf 'v %s\n' '0 0 0' '1 0 0' '0 1 0' '1 1 0' '0 0 1' '1 0 1' '0 1 1' '1 1 1' '3 0 0' '3.9 0 0' '3 1 0' '3.9 1 0' '3 0 1' '3.9 0 1' '3 1 1' '3.9 1 1' >boxes.obj
for k in 0 8; do printf 'f %d %d %d\nf %d %d %d\n' $((1+k)) $((3+k)) $((4+k)) $((1+k)) $((4+k)) $((2+k)) $((5+k)) $((6+k)) $((8+k)) $((5+k)) $((8+k)) $((7+k)) \
    $((1+k)) $((2+k)) $((6+k)) $((1+k)) $((6+k)) $((5+k)) $((3+k)) $((7+k)) $((8+k)) $((3+k)) $((8+k)) $((4+k)) \
    $((1+k)) $((5+k)) $((7+k)) $((1+k)) $((7+k)) $((3+k)) $((2+k)) $((4+k)) $((8+k)) $((2+k)) $((8+k)) $((6+k)); done >>boxes.obj
run repair boxes.obj -o result.ply --resolution 64 --keep-largest 1 --json
[ $status = 0 ] && grep -q '"warnings": \[\]' out && grep -q '"parts_dropped": 1' out && grep -q '"components": 1, "volume": \(1\|0.99[0-9]*\|1.00[0-9]*\),' out
result 'the largest part is kept' $?
run repair boxes.obj -o result.ply --resolution 64 --keep-largest 2 --json
[ $status = 0 ] && grep -q '"parts_dropped": 0' out
result 'both parts are kept' $?
run repair boxes.obj -o result.ply --resolution 64 --keep-largest 1
grep -q '^  dropped     1 part' out
result 'the dropped part is told' $?
refuses 2 'a whole number from 1' boxes.obj -o result.ply --keep-largest 0
# The smaller one a cavity of the other: filled as asked, without a word about the volume that is there now.
awk '$1 == "v" && ++n > 8 { print "v", 0.25 + ($2 > 3.5) / 2, 0.25 + $3 / 2, 0.25 + $4 / 2; next } $1 == "f" && ++m > 12 { print $1, $2, $4, $3; next }
    { print }' boxes.obj >hollow.obj
run repair hollow.obj -o result.ply --resolution 64 --least-cavity 1000000 --json
[ $status = 0 ] && grep -q '"warnings": \[\]' out && grep -q '"cavities_dropped": 1' out
result 'a cavity is filled as asked' $?
# Two rings a hair apart, and a spike that crosses one of them at 7 pairs of triangles: those close no 20 handles.
if has python3; then
    python3 - "$root/tests/tools" <<'P'
import sys
sys.path.insert(0, sys.argv[1])
from made_meshes import Mesh, ring
above = ring(Mesh(), 1, 0.3, 24, 12)
m = ring(Mesh(), 1, 0.3, 24, 12).add([(x, y, z + 0.602) for x, y, z in above.points], above.faces)
m.add([(1.2, -.05, 0), (1.6, -.1, -.1), (1.6, .1, -.1), (1.6, 0, .1)], [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]).write('rings.off')
ring(Mesh(), 1, 0.09, 32, 12).write('ring.off')
P
    run repair rings.off -o result.ply --resolution 32
    grep -q '^  crossings   7 pairs' out && grep -q 'warning: .*the result has 22 handles, the input 2: ' err
    result 'handles beyond what crossings explain are told' $?
    run repair rings.off -o result.ply --resolution 64 --measure
    [ $status = 0 ] && ! grep -q handles err
    result 'no handles, no word of them' $?
    run simplify ring.off -o result.ply --triangles 80 --samples 0
    [ $status = 0 ] && grep -q 'a volume of .*BVX_WARN_LEVEL_VOLUME' err
    result 'a level that loses over 2 % of the volume is told' $?
    run simplify ring.off -o result.ply --triangles 120 --samples 0
    [ $status = 0 ] && ! grep -q warning err
    result 'one that loses less is not' $?
else
    skip 'handles beyond what crossings explain are told' 'python3 is missing'
fi
refuses 2 '--sharp and --no-sharp exclude' "$knot" -o result.ply --sharp --no-sharp
refuses 2 'a mesh format' "$knot" -o result.npy
refuses 1 'shell is 1; 0, or 1.5 to 1000000 are possible' "$knot" -o result.ply --shell 1
refuses 2 'takes one of' "$knot" -o result.ply --interpolation round
refuses 2 'takes one of' "$knot" -o result.ply --sign normal
refuses 2 'whole number' "$knot" -o result.ply --resolution 0
refuses 1 'below least_part' "$knot" -o result.ply --resolution 16 --least-part 1000000
printf 'v 0 0 0\nv 1 1 1\nv 2 2 2\nf 1 2 3\n' >line.obj
refuses 1 'has an area' line.obj -o result.ply

# A hull, whichever way triangles face; levels by count.
run hull flipped.obj -o hull_%d.ply --resolution 40 --close-gaps 1 --triangles 2000,500 --json
[ $status = 0 ] && grep -q '"hull": {"outer_triangles": [1-9]' out && [ "$(grep -o '"closed": true, "manifold": true, "oriented": true' out | wc -l)" = 2 ] && [ -s hull_0.ply ] && [ -s hull_1.ply ]
result 'hull: levels of what can be reached from outside' $?
run hull "$knot" -o hull.ply --resolution 24 --count 2
[ $status = 2 ] && grep -q 'levels' err && [ ! -e hull.ply ]
result 'refused (2): two levels, one name' $?
run hull flipped.obj -o proxy.ply --enclose 2% --triangles 300 --json
[ $status = 0 ] && grep -q '"closed": true, "manifold": true, "oriented": true' out && [ -s proxy.ply ]
result 'hull: around every triangle' $?
run hull "$knot" -o hull.ply --enclose 2% --close-gaps 2
[ $status = 2 ] && grep -q 'enclose' err
result 'refused (2): --enclose with --close-gaps' $?
run voxelize "$knot" -o knot.bvx --resolution 16 --quiet
run hull knot.bvx -o hull.ply
[ $status = 2 ] && grep -q 'hull is for meshes; knot.bvx is a grid' err
result 'refused (2): a hull of a grid' $?

if [ -d "$meshes" ]; then
    for mesh in "$meshes"/*; do certified "$(basename "$mesh")" "$mesh" --resolution 48; done
else
    echo "ok real meshes # SKIP ../shared/meshes is missing"
    skipped=$((skipped + 1))
fi

counts
