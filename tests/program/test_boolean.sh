#!/bin/sh
# test_boolean.sh [PROGRAM] - the boolean command of the bitvox program. PROGRAM is build/bitvox, or what BITVOX names. One line a
# check, "ok NAME" or "not ok NAME"; the last line is "N passed, N failed[, N skipped]". Runs in the repository's root, works in a
# folder of its own.
set -u
. tests/tools/program_checks.sh

# The result is certified by info, a second reading of the file.
certified() { # NAME, ARGUMENTS...
    name=$1
    shift
    rm -f result.ply
    run boolean "$@" -o result.ply --quiet
    [ $status = 0 ] && [ ! -s err ] && "$program" info result.ply --json 2>>err | grep -q '"closed": true, "manifold": true, "oriented": true'
    result "$name" $?
}

refuses() { # STATUS, WORDS, ARGUMENTS...: one line with these words, and no file
    want=$1 words=$2
    shift 2
    rm -f result.*
    run boolean "$@"
    [ $status = "$want" ] && [ "$(wc -l <err)" = 1 ] && grep -q -e "$words" err && [ ! -e result.ply ] && [ ! -e result.bvx ]
    result "refused ($want): $words" $?
}

count() { sed -n 's/.*"set": \([0-9]*\).*/\1/p' out; }

"$program" faces "$knot" -o blocks.ply --resolution 12 --quiet
for operation in union intersection difference xor; do
    certified "$operation of meshes" $operation "$knot" blocks.ply --resolution 48
done
certified 'sharp' difference blocks.ply "$knot" --resolution 48 --sharp
certified 'interpolation' union blocks.ply "$knot" --resolution 48 --interpolation scalar
certified 'fill' union blocks.ply "$knot" --resolution 48 --fill winding
certified 'spacing' union blocks.ply "$knot" --spacing 0.2

# A slot through a block leaves two parts, one of which stays.
printf 'v %s\n' '0 0 0' '9 0 0' '0 4 0' '9 4 0' '0 0 4' '9 0 4' '0 4 4' '9 4 4' >block.obj
printf 'v %s\n' '3 -1 -1' '4 -1 -1' '3 5 -1' '4 5 -1' '3 -1 5' '4 -1 5' '3 5 5' '4 5 5' >slot.obj
for box in block slot; do printf 'f %s\n' '1 3 4' '1 4 2' '5 6 8' '5 8 7' '1 2 6' '1 6 5' '3 7 8' '3 8 4' '1 5 7' '1 7 3' '2 4 8' '2 8 6' >>$box.obj; done
certified 'the largest part of two' difference block.obj slot.obj --resolution 54 --keep-largest 1
run boolean difference block.obj slot.obj -o result.ply --resolution 54 --keep-largest 1 --json
grep -q '"parts_dropped": 1' out && grep -q '"components": 1, "volume": \(80\|79.9[0-9]*\|80.0[0-9]*\),' out && grep -q '"warnings": \[\]' out
result 'the other part is counted' $?
refuses 2 'one input too many: bitvox boolean OPERATION A B -o OUT' union block.obj slot.obj slot.obj -o result.ply
refuses 2 '--keep-largest is for two meshes' difference block.obj slot.obj -o result.bvx --keep-largest 1

# A plate thinner than a voxel less a bar: a plate with a hole, and a word where it is lost.
printf 'v %s\n' '0 0 -.04' '9 0 -.04' '0 9 -.04' '9 9 -.04' '0 0 .02' '9 0 .02' '0 9 .02' '9 9 .02' >plate.obj
printf 'v %s\n' '2 2 -1' '7 2 -1' '2 6 -1' '7 6 -1' '2 2 .9' '7 2 .9' '2 6 .9' '7 6 .9' >bar.obj
printf 'f %s\n' '1 3 4 2' '5 6 8 7' '1 2 6 5' '3 7 8 4' '1 5 7 3' '2 4 8 6' | tee -a plate.obj >>bar.obj
printf 'v %s\n' '0 0 -1' '1 0 -1' '0 9 -1' '1 9 -1' '0 0 1' '1 0 1' '0 9 1' '1 9 1' >>plate.obj # and a wall
printf 'f %s\n' '9 11 12 10' '13 14 16 15' '9 10 14 13' '11 15 16 12' '9 13 15 11' '10 12 16 14' >>plate.obj
run boolean union plate.obj bar.obj -o result.ply --resolution 64 --json
[ $status = 0 ] && ! grep -q plate.obj err && grep -q '"a": {[^}]*"thin_voxels": [1-9][^}]*"thin_kept": true}, "b": {[^}]*"thin_kept": false}' out
result 'thin walls are kept, of which mesh is said' $?
run boolean union plate.obj bar.obj -o result.ply --resolution 64 --thin drop --json
[ $status = 0 ] && grep -q 'plate.obj: walls thinner than 1.5 voxels are lost' err && grep -q '"a": {[^}]*"thin_kept": false}' out
result 'thin walls that are dropped are warned of' $?
refuses 2 'for two meshes that become a mesh' union plate.obj bar.obj -o result.bvx --thin drop
refuses 2 "'shell'" union plate.obj bar.obj -o result.ply --thin shell

# A half-space that cuts a part is a box a thousand times as large.
printf 'v %s\n' '0 0 0' '9 0 0' '0 9 0' '9 9 0' '0 0 9' '9 0 9' '0 9 9' '9 9 9' >cube.obj
printf 'f %s\n' '1 3 4 2' '5 6 8 7' '1 2 6 5' '3 7 8 4' '1 5 7 3' '2 4 8 6' >sides
cat sides >>cube.obj
printf 'v %s\n' '-5000 -5000 3' '5000 -5000 3' '-5000 5000 3' '5000 5000 3' '-5000 -5000 9999' '5000 -5000 9999' '-5000 5000 9999' '5000 5000 9999' >half.obj
cat sides >>half.obj
certified 'half-space' difference cube.obj half.obj --resolution 64
"$program" boolean difference cube.obj half.obj -o result.ply --resolution 64 >out
grep -q 'volume 24[23]' out
result 'a difference has the lattice of the first' $?
head -12 cube.obj >open.obj
certified 'open' union open.obj open.obj --resolution 48
run boolean union open.obj open.obj -o result.ply --resolution 48 --json
grep -q '"fill": "winding", "reason": "open"' out
result 'an open box is filled by winding' $?
printf 'v %s\n' '1 1 1' '2 1 1' '1 2 1' '2 2 1' '1 1 2' '2 1 2' '1 2 2' '2 2 2' >crumb.obj
cat sides >>crumb.obj
run boolean difference cube.obj crumb.obj -o result.ply --resolution 48 --json
grep -q 'crumb.obj: few or no voxels show this body; a resolution of 576 does' out
result 'a body of few voxels is told' $?
refuses 1 'take a resolution of' union cube.obj crumb.obj -o result.ply --spacing 5
sed 's/^v /v 100/' crumb.obj >far.obj
run boolean difference cube.obj far.obj -o result.ply --resolution 64 --json
grep -q 'far.obj: it does not reach the first body: nothing was taken away' out
result 'a second body beside the first is told' $?

# Mesh and grid agree: the same voxels whatever goes out.
run boolean union "$knot" blocks.ply -o both.bvx --resolution 64 --json
united=$(count)
for mesh in "$knot" blocks.ply; do "$program" boolean intersection both.bvx $mesh -o $(basename $mesh .ply).bvx --quiet; done
run boolean intersection knot.bvx blocks.bvx -o common.npy --json
common=$(count)
run boolean xor "$knot" blocks.ply -o alone.nrrd --resolution 64 --json
alone=$(count)
run boolean difference both.bvx common.npy -o result.bvx --json
[ $status = 0 ] && [ "$(count)" = "$alone" ] && [ $((united - common)) = "$alone" ]
result 'union less intersection is xor, of grids' $?
run boolean xor "$knot" blocks.ply -o result.ply --resolution 64 --least-part 0 --json
[ "$(count)" = "$alone" ] && grep -q '"boolean": {"operation": "xor", "voxels_a": [0-9]*, "voxels_b": [0-9]*, "voxels": [0-9]*, "surfaces_kept": true, "a": {"fill": "parity", "reason": "sound", "turned": 0, "unbalanced_rows": 0, [^}]*"thin_voxels": 0, [^}]*}, "b": {[^}]*}' out
result 'as many voxels for a mesh, and the report for programs' $?
run boolean difference both.bvx "$knot" -o result.vti --json
[ $status = 0 ] && grep -q '"surfaces_kept": false' out
result 'a mesh beside a grid' $?
certified 'grids to a mesh' union both.bvx common.npy
run boolean union both.bvx common.npy -o result.bvx
grep -q '^union of both.bvx and common.npy -> result.bvx' out && grep -q '^  voxels ' out
result 'text' $?
"$program" voxelize "$knot" -o other.bvx --resolution 40 --quiet
refuses 1 '--resample brings B to the lattice of A' union both.bvx other.bvx -o result.bvx
run boolean intersection other.bvx both.bvx -o result.bvx --resample --json
[ $status = 0 ] && [ "$(count)" -gt 1000 ]
result 'another lattice, resampled' $?
for n in 1 3; do "$program" boolean xor "$knot" blocks.ply -o t$n.ply --resolution 64 --threads $n --quiet; done
cmp -s t1.ply t3.ply
result 'threads do not show' $?

refuses 2 'unknown operation' join "$knot" blocks.ply -o result.ply
refuses 2 'lacks an input' union "$knot" -o result.ply
refuses 1 'No such file' union "$knot" missing.ply -o result.ply
refuses 2 'a format that can be written' union "$knot" blocks.ply -o result.txt
refuses 2 'brings its own lattice' union "$knot" both.bvx -o result.ply --resolution 12
refuses 2 '--sharp is for two meshes' union "$knot" blocks.ply -o result.bvx --sharp
refuses 2 '--fill is for meshes' union both.bvx common.npy -o result.bvx --fill vote
refuses 2 '--resample is for two grids' union "$knot" both.bvx -o result.bvx --resample
refuses 1 'nothing remains' difference "$knot" "$knot" -o result.ply
# Two slanted rods of twelve sides that are two voxels thick, apart: what is convex is cut off.
slanted_rod 0 >rod_0.obj
slanted_rod 0.5 >rod_0.5.obj
run boolean union rod_0.obj rod_0.5.obj -o result.ply --resolution 64
[ $status = 0 ] && [ "$(wc -l <err)" = 1 ] && grep -q 'warning: the result has a volume of 0.001[23].*, the input about 0.0014.* (-1[0-9.]* %)' err
result 'a union of rods that become thinner is warned of' $?
run boolean union rod_0.obj rod_0.5.obj -o result.ply --resolution 256
[ $status = 0 ] && [ ! -s err ]
result 'and not where voxels hold them' $?

# A bar inside out that leaves a block where the other body does not reach: it is no cavity there.
printf 'v %s\n' '0 0 0' '4 0 0' '0 4 0' '4 4 0' '0 0 4' '4 0 4' '0 4 4' '4 4 4' '1 1 1' '8 1 1' '1 3 1' '8 3 1' '1 1 3' '8 1 3' '1 3 3' '8 3 3' >crossed.obj
printf 'f %s\n' '1 3 4 2' '5 6 8 7' '1 2 6 5' '3 7 8 4' '1 5 7 3' '2 4 8 6' '10 12 11 9' '15 16 14 13' '13 14 10 9' '12 16 15 11' '11 15 13 9' '14 16 12 10' >>crossed.obj
printf 'v %s\n' '-1 -1 -1' '3.5 -1 -1' '-1 5 -1' '3.5 5 -1' '-1 -1 5' '3.5 -1 5' '-1 5 5' '3.5 5 5' >reach.obj
printf 'f %s\n' '1 3 4 2' '5 6 8 7' '1 2 6 5' '3 7 8 4' '1 5 7 3' '2 4 8 6' >>reach.obj
run boolean intersection crossed.obj reach.obj -o result.ply --resolution 32 --json
grep -q '"components": 1, "volume": \(56\|55.9[0-9]*\|56.0[0-9]*\),' out && grep -q '"warnings": \[\]' out
result 'parts inside out are turned wherever they leave others' $?

# Blocks that have a wall of a third of a voxel in common: what is left of it in crumbs is told.
tilted() { # FROM, TO: a block between these heights, turned about z and x
    awk -v from=$1 -v to=$2 'BEGIN { for (i = 0; i < 8; i++) {
        x = 9 * (i % 2); y = 9 * (int(i / 2) % 2); z = i < 4 ? from : to
        u = 0.9553 * x - 0.2955 * y; v = 0.2955 * x + 0.9553 * y
        print "v", u, 0.9801 * v - 0.1987 * z, 0.1987 * v + 0.9801 * z
    } }'
}
tilted 0 3 >wall_a.obj
tilted 2.9 6 >wall_b.obj
for n in a b; do printf 'f %s\n' '1 3 4 2' '5 6 8 7' '1 2 6 5' '3 7 8 4' '1 5 7 3' '2 4 8 6' >>wall_$n.obj; done
run boolean intersection wall_a.obj wall_b.obj -o result.ply --resolution 30
[ $status = 0 ] && grep -q 'warning: dropped, since what is thinner than a voxel broke: [0-9]* small parts' err
result 'walls between both bodies that broke are told' $?

# Bars aslant, a fifth of a voxel apart, whose boxes overlap.
for y in 0 0.42 0.6; do
    awk -v y=$y 'BEGIN { for (i = 0; i < 8; i++) print "v", 3 * (i % 2), 3 * (i % 2) + 0.4 * (int(i / 2) % 2) + y, 0.3 * int(i / 4) }' >bar_$y.obj
    printf 'f %s\n' '1 3 4 2' '5 6 8 7' '1 2 6 5' '3 7 8 4' '1 5 7 3' '2 4 8 6' >>bar_$y.obj
done
run boolean union bar_0.obj bar_0.42.obj -o result.ply --resolution 40
[ $status = 0 ] && grep -q 'warning: the result has 1 part, the input 2: ' err
result 'a union that closes a gap is warned of, boxes that overlap or not' $?
run boolean union bar_0.obj bar_0.6.obj -o result.ply --resolution 160
[ $status = 0 ] && ! grep -q 'warning: the result has' err
result 'and not where the gap is wide' $?
counts
