#!/bin/sh
# test_sections.sh [PROGRAM] - bodies from section contours by the bitvox program: sections and slice. PROGRAM is build/bitvox, or what
# BITVOX names. One line a check, "ok NAME" or "not ok NAME"; the last line is "N passed, N failed[, N skipped]". Runs in the repository's
# root, works in a folder of its own; CONTOURS is the folder of real contours [../shared/contours].
set -u
. tests/tools/program_checks.sh
contours=${CONTOURS:-$root/../shared/contours}

gives() { # NAME, STATUS, WORDS (in out or err), ARGUMENTS...
    gives_name=$1 gives_status=$2 gives_words=$3
    shift 3
    run "$@"
    if [ "$status" != "$gives_status" ]; then not_ok "$gives_name" "exit status $status, not $gives_status"
    elif ! cat out err | grep -q -F -e "$gives_words"; then not_ok "$gives_name" "nothing says: $gives_words"
    else ok "$gives_name"; fi
}

field() { # NAME: a number of the JSON report in out
    sed -n "s/.*\"$1\": \([-0-9.e+]*\).*/\1/p" out | head -n 1
}

near() { # NAME, A, B, SHARE
    if awk -v a="$2" -v b="$3" -v s="$4" 'BEGIN { d = a - b; if (d < 0) d = -d; if (b < 0) b = -b; exit !(a != "" && d <= s * b) }'; then ok "$1"
    else not_ok "$1" "$2 is not near $3"; fi
}

is() { # NAME, A, B
    if [ "$2" = "$3" ]; then ok "$1"; else not_ok "$1" "$2 is not $3"; fi
}

cat >prism.csv <<'END'
section,position,loop,x,y
1,0,1,0,0
1,0,1,10,0
1,0,1,10,8
1,0,1,0,8
1,0,2,3,3
1,0,2,6,3
1,0,2,6,5
1,0,2,3,5
2,4,1,0,0
2,4,1,10,0
2,4,1,10,8
2,4,1,0,8
2,4,2,3,3
2,4,2,6,3
2,4,2,6,5
2,4,2,3,5
END

gives prism 0 'closed, manifold, oriented' sections prism.csv -o prism.ply
run sections prism.csv -o prism.ply --grid 12x9 --json --block-model blocks.csv --block 2,2,1
near 'volume of a prism with a hole' "$(field volume)" 296 1e-9
near 'volume by blocks' "$(field block_volume)" 296 0.02
near 'volume by prismoids' "$(field prismoid_volume)" 296 1e-9
near 'block model adds up' "$(awk -F, 'NR > 1 { v += $4 * $5 * $6 * $7 } END { print v }' blocks.csv)" 296 0.02
if [ "$(head -n 1 blocks.csv)" = x,y,z,dx,dy,dz,fraction ]; then ok 'head of a block model'; else not_ok 'head of a block model' "$(head -n 1 blocks.csv)"; fi
if awk -F, 'NR > 1 && ($7 <= 0 || $7 > 1 || ($1 - 1) % 2 != 0) { bad = 1 } END { exit bad }' blocks.csv; then ok 'blocks lie at whole multiples'
else not_ok 'blocks lie at whole multiples' 'a centre or share is wrong'; fi
gives 'parts and handles' 0 '1 part, 1 handle' sections prism.csv -o prism.ply
run sections prism.csv -o prism.ply --json
if grep -q '"parts": 1, "genus": 1' out; then ok 'parts and handles in a report'; else not_ok 'parts and handles in a report' "$(cat out)"; fi
gives 'taper' 0 'closed, manifold, oriented' sections prism.csv -o prism.ply --caps taper
gives 'open' 0 'manifold, oriented, open' sections prism.csv -o prism.ply --caps open
awk 'BEGIN { print "section,position,loop,x,y"; for (k = 0; k < 5; k++) for (l = 0; l < 2; l++) for (i = 0; i < 40; i++) {
    a = i * 3.14159265 / 20; r = 3 - 0.3 * l; printf "%d,%d,%d,%.9f,%.9f\n", k, k, l, 0.8 * k + r * cos(a), r * sin(a) } }' >wall.csv
run sections wall.csv -o wall.ply --json
is 'a leaning wall has no window' "$(field euler)" 0
is 'its levels' "$(field joined_slabs)" 0
near 'its volume' "$(field volume)" "$(field prismoid_volume)" 0.02
sed 's/$//' wall.csv | awk -F, 'NR == 1 { print; next } { r = $3 == 1 ? 2.99 / 2.7 : 1; x = $4 - 0.8 * $1; printf "%s,%s,%s,%.9f,%.9f\n", $1, $2, $3, 0.8 * $1 + r * x, r * $5 }' >thin.csv
gives 'a wall too thin for the cells' 0 'walls are too thin for the cells' sections thin.csv -o wall.ply --grid 8x8
printf 'section,position,loop,x,y\n' >keyhole.csv
for k in 0 1; do for p in 0,0 4,0 4,4 0,4 0,2 1,2 1,3 3,3 3,1 1,1 1,2 0,2; do echo "$k,$k,0,$p"; done; done >>keyhole.csv
printf 'section,position,loop,x,y\n0,0,0,1,1\n0,0,0,1,1\n0,0,0,1,1\n' >dot.csv
sed 's/^0,0,0/0,0,1/;1d' keyhole.csv >>dot.csv
gives 'a loop of one point is refused' 1 'has 1 different point; a loop needs three; --mend leaves such loops out' sections dot.csv -o x.ply
gives 'and left out' 0 'loops mended' sections dot.csv -o dot.ply --mend
gives 'a keyhole is refused' 1 '; --mend splits loops there' sections keyhole.csv -o x.ply
run sections keyhole.csv -o keyhole.ply --mend --json
near 'volume of a mended keyhole' "$(field volume)" 12 1e-6
is 'loops mended' "$(field mended_loops) $(field holes)" '2 2'
gives 'paper' 0 'closed, manifold, oriented' sections prism.csv -o prism.stl --crossings paper --spacing 0.7
gives 'classic' 0 'closed, manifold, oriented' sections prism.csv -o prism.obj --crossings classic --spacing 0.7
gives 'no contour file' 2 'does not end in a contour format' sections "$knot" -o x.ply
gives 'no mesh file' 2 'does not end in a mesh format' sections prism.csv -o x.csv
gives 'grid and spacing' 2 'contradict' sections prism.csv -o x.ply --grid 5x5 --spacing 1
gives 'block without model' 2 'block requires --block-model' sections prism.csv -o x.ply --block 1,1,1
gives 'blocks of an open body' 2 'closed body' sections prism.csv -o x.ply --caps open --block 1,1,1 --block-model b.csv
gives 'another label' 1 'no loop has the label 4' sections prism.csv -o x.ply --label 4
sed 's/^1,0,2,6,5$/1,0,2,60,5/' prism.csv >crossed.csv
gives 'loops that cross' 1 '; --mend splits loops there' sections crossed.csv -o x.ply
printf 'CSLC\n2 2\n1 3 1 0 0 1 1\n0 0 1 4 0 1 4 4 1\n3 1 0 1 2\n2 3 1 0 0 1 2\n0 0 2 4 0 2 4 4 2\n3 1 0 1 2\n' >signs.csl
gives 'the other sign of D' 0 'closed, manifold' sections signs.csl -o signs.ply
holds 'with a warning' grep -q 'signs.csl: D has the other sign on all planes' err
sed -n '1p;/^1,/p' prism.csv >single.csv
gives 'a single section' 1 'in only one section (index 0, at 0)' sections single.csv -o x.ply
sed 's/^2,4/2,0/' prism.csv >repeated.csv
gives 'two sections at one position' 1 'sections 0 and 1 lie at one position, 0' sections repeated.csv -o x.ply
head -n 1 prism.csv >empty.csv
gives 'a table without lines' 1 'the file holds no loop' sections empty.csv -o x.ply
gives 'open polylines' 1 'line 6: the loop that ends before this line is open' sections prism.csv -o x.ply --close-gap 0.5
gives 'polylines that are nearly closed' 0 'closed, manifold, oriented' sections prism.csv -o prism.ply --close-gap 8
printf 'CSLC\n2 1\n1 3 1 0 0 1 0\n0 0 0 4 0 0 4 4 0\n3 1 0 1 2\n2 3 1 0 0 1 -1\n0 0 1 4 0 1 4 4 1.2\n3 1 0 1 2\n' >off.csl
gives 'points off their plane' 1 'off its plane' sections off.csl -o x.ply
printf 'CSLC\n2 1\n1 4 1 0 0 1 0\n0 0 0 4 0 0 4 4 0 0 4 0\n4 1 0 1 2 3\n2 4 1 1 0 0 -2\n2 0 -2 2 4 -2 2 4 2 2 0 2\n4 1 0 1 2 3\n' >cross.csl
gives 'planes that cross' 0 'closed, manifold, oriented' sections cross.csl -o cross.ply --cells 16
printf 'CSLC\n2 1\n1 8 2 0 0 1 0\n0 0 0 4 0 0 4 4 0 0 4 0 4 4 0 8 4 0 8 8 0 4 8 0\n4 1 0 1 2 3\n4 1 4 5 6 7\n2 4 1 1 0 0 -2\n2 0 -2 2 4 -2 2 4 2 2 0 2\n4 1 0 1 2 3\n' >corner.csl
gives 'planes that cross: loops that touch' 1 'cross or touch, after their points 0 and 2, near (4, 4, 0); --mend splits loops there' sections corner.csl -o x.ply
gives 'are mended' 0 '; 2 loops mended' sections corner.csl -o corner.ply --mend --cells 16
printf 'CSLC\n2 1\n1 4 1 1 0 -0.1 -3\n-3 -1 0 -3 1 0 -2.9 1 1 -2.9 -1 1\n4 1 0 1 2 3\n2 4 1 1 0 0.1 -3\n3 -1 0 3 1 0 2.9 1 1 2.9 -1 1\n4 1 0 1 2 3\n' |
    sed 's/^1 4 1 1 0 -0.1 -3/1 4 1 1 0 -0.1 3/' >ends.csl
gives 'a body that falls into parts' 0 'parts that end towards another one with no plane between: 1, one at ' sections ends.csl -o ends.ply --cells 16
sed 's/2 4 -2 2 4 2/2 6 -2 2 6 2/' cross.csl >apart.csl
gives 'planes that contradict each other' 1 'sections 0 and 1 contradict each other where their planes cross, near (2, ' sections apart.csl -o x.ply
gives 'contours that are moved to agree' 0 ' gaps left where planes cross, contours ' sections apart.csl -o cross.ply --agree 2.5
gives 'cells or spacing' 2 'contradict each other' sections cross.csl -o x.ply --cells 16 --spacing 1
for option in '--grid 20x20' '--crossings classic' '--subdivide 2'; do
    gives "planes that cross: $option" 2 "${option%% *} is for parallel planes; those of cross.csl are not" sections cross.csl -o x.ply $option
done
gives 'parallel planes: --cells' 2 '--cells is for planes that are not parallel; those of prism.csv are' sections prism.csv -o x.ply --cells 16
gives 'parallel planes: --agree' 2 '--agree is for planes that are not parallel; those of prism.csv do not cross' sections prism.csv -o x.ply --agree 1
gives 'no polylines in .csl' 2 '--close-gap is for .csv' sections off.csl -o x.ply --close-gap 1
"$program" sections - --format csv -o piped.ply <prism.csv >out 2>err
if [ $? = 0 ] && grep -q 'standard input' out; then ok 'contours from standard input'; else not_ok 'contours from standard input' "$(cat out)"; fi
gives 'standard input without a format' 2 'give it with --format' sections - -o x.ply
if [ -e x.ply ] || [ -e b.csv ]; then not_ok 'refusals leave no file' 'x.ply or b.csv is there'; else ok 'refusals leave no file'; fi

gives 'slice' 0 'planes' slice "$knot" -o knot.csl --spacing 0.05
gives 'slice to a table' 0 'points' slice "$knot" -o knot.csv --spacing 0.05
gives 'a table across x' 2 'take .csl' slice "$knot" -o knot2.csv --axis x --spacing 0.2
gives 'slice without spacing' 2 '--spacing is needed' slice "$knot" -o knot2.csl
run info "$knot" --json
volume=$(field volume)
run sections knot.csl -o knot.ply --caps taper --json
near 'mesh to contours to mesh' "$(field volume)" "$volume" 0.03
cp knot.ply first.ply
run sections knot.csv -o knot.ply --caps taper --json
if cmp -s first.ply knot.ply; then ok 'both contour formats give one body'; else not_ok 'both contour formats give one body' 'the meshes differ'; fi

for name in orex_eight_15.csl.gz orex_SideBishop.csl; do
    if [ ! -f "$contours/$name" ]; then
        skip "$name" 'the file is not there'
        continue
    fi
    gives "$name" 0 'closed, manifold, oriented' sections "$contours/$name" -o real.ply --caps taper
done
if [ -f "$contours/orex_eight_15_reference.stl.gz" ]; then
    run sections "$contours/orex_eight_15.csl.gz" -o real.ply --caps taper --json
    cell=$(sed -n 's/.*"cell": \[\([0-9.e-]*\),.*/\1/p' out)
    run compare real.ply "$contours/orex_eight_15_reference.stl.gz"
    mean=$(awk '/both ways/ { print $3 }' out)
    if awk -v m="$mean" -v c="$cell" 'BEGIN { exit !(m > 0 && m < c / 2) }'; then ok 'mean distance to the reference below half a cell'
    else not_ok 'mean distance to the reference below half a cell' "$mean of $cell"; fi
    run sections "$contours/orex_eight_15.csl.gz" -o real.ply --caps taper --crossings paper
    run compare real.ply "$contours/orex_eight_15_reference.stl.gz"
    straight=$(awk '/both ways/ { print $3 }' out)
    if awk -v m="$mean" -v s="$straight" 'BEGIN { exit !(m > 0 && m < s) }'; then ok 'the cubic is nearer to it than the paper'
    else not_ok 'the cubic is nearer to it than the paper' "$mean of $straight"; fi
else
    skip 'distance to the reference' 'the file is not there'
fi
if [ -e "$contours/pig_heart_A05.tsv.gz" ]; then
    for frame in 10 29; do # the wall of a heart's chamber: a loop and a hole in it in each section
        gzip -dc "$contours/pig_heart_A05.tsv.gz" | awk -v f=$frame 'BEGIN { print "section,position,loop,x,y" }
            $4 == f { printf "%d,%d,%d,%s,%s\n", $3, 8 * $3, $5, $1, $2 }' >heart.csv
        run sections heart.csv -o heart.ply --json
        near "heart $frame: volume" "$(field volume)" "$(field prismoid_volume)" 0.01
        is "heart $frame: no window" "$(field euler) $(field components) $(field joined_slabs)" '0 1 0'
        run info heart.ply --crossings --json
        is "heart $frame: nothing crosses" "$(field crossings)" 0
    done
else
    skip 'walls of a heart' 'the file is not there'
fi

# ---- info ----

printf 'section,position,loop,label,x,y\n' >two.csv
for z in 3 0 1; do # planes in any order, not evenly spaced
    for corner in 0,0 4,0 4,4 0,4; do echo "$z,$z,0,1,$corner" >>two.csv; done
    [ $z = 0 ] || for corner in 6,-1 8,-1 7,5; do echo "$z,$z,1,7,$corner" >>two.csv; done
done
gives 'info: sections' 0 'sections    3' info two.csv
for words in 'loops       5 of 18 points' 'labels      2: 1 (3 loops), 7 (2 loops)' 'across 0, 0, 1, from 0 to 3' '1.5 from plane to plane in the mean' \
    'x           0 .. 8 (8)' 'y           -1 .. 5 (6)' 'z           0 .. 3 (3)'; do
    gives "info: $words" 0 "$words" info two.csv
done
run info two.csv --json
is 'info: the report' "$(field sections) $(field empty_sections) $(field first_position) $(field last_position) $(field mean_distance)" '3 0 0 3 1.5'
gives 'info: labels in the report' 0 '"labels": [{"label": 1, "loops": 3, "points": 12}, {"label": 7, "loops": 2, "points": 6}]' info two.csv --json

# One section alone: a slab or a lens of a thickness.
awk -F, 'NR == 1 || $1 == 1' prism.csv >alone.csv
gives 'one section is too few' 1 'it needs two, or a thickness' sections alone.csv -o alone.ply
gives 'a slab' 0 '"closed": true, "manifold": true' sections alone.csv -o alone.ply --thickness 0.5 --json
near 'of its thickness' "$(field volume)" 37 1e-9
gives 'a lens' 0 'closed, manifold, oriented' sections alone.csv -o alone.ply --thickness 0.5 --caps taper
gives 'no thickness' 2 '--thickness takes a number above 0' sections alone.csv -o alone.ply --thickness 0
gives 'thickness of several sections' 0 'warning: --thickness is for one section alone; the body has' sections prism.csv -o x.ply --thickness 2

# Planes of any direction in a table: three squares across the axes, which agree where they cross.
awk 'BEGIN { print "section,position,loop,x,y,z,nx,ny,nz"; split("-1 -1 1 -1 1 1 -1 1", p)
    for (k = 0; k < 3; k++) for (i = 1; i < 8; i += 2) { c[0] = c[1] = c[2] = 0; c[(k + 1) % 3] = p[i]; c[(k + 2) % 3] = p[i + 1]
        print k ",0,0," c[0] "," c[1] "," c[2] "," (k == 0) "," (k == 1) "," (k == 2) } }' >cross.csv
gives 'a table of planes' 0 '  planes      3 of any direction' sections cross.csv -o cross.ply --cells 16
gives 'info of a table of planes' 0 'planes' info cross.csv
sed 's/^2,0,0,1,1,0,0,0,1/2,0,0,1,1,0,0,0,2/' cross.csv >turned.csv
gives 'a plane with two normals' 1 'the section has another normal on an earlier line' sections turned.csv -o x.ply

# Slanted parts that share no area.
printf 'section,position,loop,x,y\n' >slant.csv
for k in 0 1 2 3; do printf "$k,$k,0,%s,0\n$k,$k,0,%s,0\n$k,$k,0,%s,4\n$k,$k,0,%s,4\n" ${k}0 ${k}4 ${k}4 ${k}0 >>slant.csv; done
gives 'slanted squares fall apart' 0 'do not join it; sections that lie closer together may help' sections slant.csv -o slant.ply

# --label all: a file for each body, the same as one by one.
gives 'all labels' 0 'label 7: body_7.ply' sections two.csv -o body_%d.ply --label all
for l in 1 7; do
    gives "label $l alone" 0 '' sections two.csv -o alone_$l.ply --label $l
    is "label $l of all is label $l alone" "$(cksum <body_$l.ply)" "$(cksum <alone_$l.ply)"
done
gives 'all labels in the report' 0 '"bodies": [{"label": 1, "sections": {"grid": [' sections two.csv -o body_%d.ply --label all --json
gives 'all labels, one name' 2 '--label all writes a mesh for each label: body.ply needs %d in its name' sections two.csv -o body.ply --label all
gives 'a number without labels' 2 'b_%d.ply: %d is for --label all' sections two.csv -o b_%d.ply --label 1
# --touching shared: all bodies at once, with the same faces where two touch.
awk 'BEGIN { print "section,position,loop,label,x,y"; for (s = 0; s < 3; s++) for (l = 0; l < 2; l++)
    { print s "," s "," l "," l + 3 "," 2 * l ",0"; print s "," s "," l "," l + 3 "," 2 * l + 2 ",0"
      print s "," s "," l "," l + 3 "," 2 * l + 2 ",2"; print s "," s "," l "," l + 3 "," 2 * l ",2" } }' >touch.csv
gives 'bodies that touch' 0 'label 4: body_4.obj' sections touch.csv -o body_%d.obj --label all --touching shared --cells 24
if grep -q -e ' loops$' -e '^  handles' out; then not_ok 'no counts of what is not counted' "$(cat out)"; else ok 'no counts of what is not counted'; fi
for l in 3 4; do grep '^v ' body_$l.obj | LC_ALL=C sort >vertices_$l.txt; done
LC_ALL=C comm -12 vertices_3.txt vertices_4.txt | awk '$2 < 1.9 || $2 > 2.1 { far = 1 } END { exit !(NR > 50 && !far) }'
result 'vertices of both lie between them' $?
gives 'touching in the report' 0 '"bodies": [{"label": 3, ' sections touch.csv -o body_%d.obj --label all --touching shared --json
if grep -q '"parts": 1, "genus": 0}}, {"label": 4, ' out; then ok 'topology of each body that touches'; else not_ok 'topology of each body that touches' "$(cat out)"; fi
sed '/^.,.,0,3,2,/s/,2,\([02]\)$/,2.2,\1/' touch.csv >over.csv
gives 'bodies that overlap' 1 'on section 0 the labels 3 and 4 overlap near (2' sections over.csv -o over_%d.obj --label all --touching shared --cells 16
gives 'bodies that overlap by less than they may' 0 'label 4: over_4.obj' sections over.csv -o over_%d.obj --label all --touching shared --cells 16 --agree 0.3
gives 'touching without labels' 2 '--touching is for --label all' sections touch.csv -o b.ply --label 3 --touching shared
gives 'touching by a grid' 2 '--grid is not used with --touching shared' sections touch.csv -o b_%d.ply --label all --touching shared --grid 20x20
gives 'touching and collapsed' 2 '--triangles would change faces' sections touch.csv -o b_%d.ply --label all --touching shared --triangles 50
gives 'touching and open' 2 '--touching shared makes closed bodies' sections touch.csv -o b_%d.ply --label all --touching shared --caps open
gives 'two numbers' 2 'b_%d_%d.ply: the name has two %d' sections two.csv -o b_%d_%d.ply --label all
gives 'all labels and a block model' 2 '--block-model is for one body; choose it by its label, not by --label all' \
    sections two.csv -o b_%d.ply --label all --block-model b.csv --block 1,1,1
gives 'a label that is no number' 2 '--label takes a whole number from -2147483647 to 2147483647 or all' sections two.csv -o b.ply --label al
rm -f body_*.ply
awk 'BEGIN { print "section,position,loop,label,x,y"; for (s = 0; s < 2; s++) {
    split("0 0 2 0 2 2 0 2", a); split("3 0 5 2 5 0 3 2", b)
    for (i = 1; i < 8; i += 2) print s "," s ",0,1," a[i] "," a[i + 1]
    for (i = 1; i < 8; i += 2) print s "," s ",1,2," b[i] "," b[i + 1] } }' >crossing.csv
gives 'the second body fails' 1 '' sections crossing.csv -o body_%d.ply --label all
is 'no body is left when one fails' "$(ls | grep -c '^body_.*ply')" 0
gives 'info: no crossings of contours' 2 '--crossings is used with meshes' info two.csv --crossings
gives 'info: bad contours' 1 'two.csl' info two.csl
if [ -e "$contours/orex_eight_15.csl.gz" ]; then
    gives 'info: a packed .csl' 0 'loops       21 of 2028 points' info "$contours/orex_eight_15.csl.gz"
else
    skip 'info: a packed .csl' 'the file is not there'
fi
printf 'CSLC\n3 1\n\n1 4 1 0 0 1 0\n0 0 0\n4 0 0\n4 4 0\n0 4 0\n4 1 0 1 2 3\n\n2 0 0 0 0 1 -1\n\n3 4 1 0 0 1 -2\n0 0 2\n4 0 2\n4 4 2\n0 4 2\n4 1 0 1 2 3\n' >gap.csl
gives 'info: empty sections' 0 'sections    3, 1 of them empty' info gap.csl
printf 'section,position,loop,x,y\n1,0,a,0,0\n1,0,a,4,0\n1,0,a,4,4\n1,0,a,0,4\n2,1,,,\n3,3,a,0,0\n3,3,a,4,0\n3,3,a,4,4\n3,3,a,0,4\n' >gap.csv
gives 'info: empty sections of a table' 0 'sections    3, 1 of them empty' info gap.csv
gives 'sections: the body ends at an empty section of a table' 0 '2 parts, 0 handles' sections gap.csv -o gap.ply
sed 's/^2,1,,,$/2,1,b,,/' gap.csv >bad_gap.csv
refuses 1 'line 6: expected a number as x' sections bad_gap.csv -o bad.ply

counts
