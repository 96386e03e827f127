#!/bin/sh
# test_labels.sh [PROGRAM] - the bodies of a segmentation by the bitvox program: labels. PROGRAM is build/bitvox, or what BITVOX
# names. One line a check, "ok NAME" or "not ok NAME"; the last line is "N passed, N failed[, N skipped]". Runs in the repository's
# root, works in a folder of its own.
set -u
. tests/tools/program_checks.sh
labels=$root/fixtures/labels.npy
same() { if cmp -s "$2" "$3"; then ok "$1"; else not_ok "$1" "$2 and $3 differ"; fi; } # NAME, FILE, FILE
count() { LC_ALL=C grep -a -o -e "$1" "$2" | wc -l; }                                   # PATTERN, FILE

# ---- a file a label, one file of all ----
gives 'a file a label' 0 'part_7.ply: 1788 triangles, closed, manifold' labels "$labels" -o part_%s.ply
for n in 1 2 7; do gives "part $n is closed" 0 'closed      yes' info part_$n.ply; done
gives 'three threads' 0 'three_7.ply' labels "$labels" -o three_%s.ply --threads 3
for n in 1 2 7; do same "part $n is the same by three threads" part_$n.ply three_$n.ply; done
works 'one label needs no %s' labels "$labels" -o seven.ply --only 7 --quiet
same 'one label alone and among all' seven.ply part_7.ply
works 'two of three' labels "$labels" -o two_%s.ply --only 7,1 --quiet
if [ -f two_1.ply ] && [ -f two_7.ply ] && [ ! -f two_2.ply ]; then ok 'and no other'; else not_ok 'and no other' "$(ls two_*)"; fi
works 'all in one .glb' labels "$labels" -o all.glb --quiet
holds 'a node, a mesh and a material each' [ "$(count '"name":"2"' all.glb)" = 3 ]
holds 'all are in the scene' [ "$(count '"scenes":\[{"nodes":\[0,1,2\]}\]' all.glb)" = 1 ]
holds 'no levels of detail' [ "$(count MSFT_lod all.glb)" = 0 ]
gives 'a .glb a label' 0 'one_2.glb: 4524 triangles' labels "$labels" -o one_%s.glb
holds 'it has its own name only' [ "$(count '"name":"' one_2.glb)" = 3 ]
gives 'the .glb is read again' 0 'components  3' info all.glb
gives 'standard output' 0 '^ply' labels "$labels" -o - --only 7
gives 'the report' 0 '"labels": \[{"value": 1, "name": "1", "voxels": 3071, "low": \[' labels "$labels" -o r_%s.ply --json
gives 'corners of voxels' 0 'closed, manifold, volume 3071, 1 surface' labels "$labels" -o s_%s.ply --staircase
gives 'smoothed within 0.1 %' 0 'volume 307[01]' labels "$labels" -o s_%s.ply --only 1
gives 'fewer triangles' 0 'f_1.ply: .* closed, manifold' labels "$labels" -o f_%s.ply --triangles 900
gives 'within an error' 0 'e_7.ply: .* closed, manifold' labels "$labels" -o e_%s.ply --error 0.1
gives 'not of the staircase' 2 'exclude each other' labels "$labels" -o e_%s.ply --error 0.1 --staircase
gives 'by one of both' 2 'exclude each other' labels "$labels" -o e_%s.ply --error 0.1 --triangles 9
gives 'another background' 0 'b_0.ply: ' labels "$labels" -o b_%s.ply --background 2
holds 'is no body' [ ! -f b_2.ply ]
gives 'a window' 0 'w_1.ply: ' labels "$labels" -o w_%s.ply --window 0,0,0,20,20,20
gives 'of 3,036 triangles those of one window' 0 'p_1.ply: 2474 triangles, NOT closed' labels "$labels" -o p_%s.ply --window 0,0,0,21,40,32 --open
gives 'and those of the next' 0 'q_1.ply: 562 triangles, NOT closed' labels "$labels" -o q_%s.ply --window 19,0,0,48,40,32 --open
holds 'a label is where it has faces' [ -f p_7.ply -a ! -f q_7.ply ]
gives 'faces only in others' 1 'no label has a face of its own in this window' labels "$labels" -o r_%s.ply --window 8,8,10,14,14,16 --open
gives 'open windows are windows' 2 'needs --window' labels "$labels" -o r_%s.ply --open

# ---- names and colours of segments ----
segments() { # NAME OF 3, NAME OF 5: two boxes that touch, and a segment that no voxel has
    printf 'NRRD0004\ntype: uint8\ndimension: 3\nsizes: 6 4 4\nspacings: 1 1 2\nencoding: ascii\n'
    printf 'Segment0_LabelValue:=3\nSegment0_Name:=%s\nSegment0_Color:=1 0 0\n' "$1"
    printf 'Segment1_LabelValue:=5\nSegment1_Name:=%s\nSegment1_Color:=0 0.5 1\n' "$2"
    printf 'Segment2_LabelValue:=9\nSegment2_Name:=absent\n\n'
    for z in 0 1 2 3; do for y in 0 1 2 3; do
        case $z$y in [12][12]) echo '0 3 3 5 5 0' ;; *) echo '0 0 0 0 0 0' ;; esac
    done; done
}
segments 'left lung' '5th' >s.seg.nrrd
gives 'names of segments' 0 'left lung.ply: .* closed, manifold' labels s.seg.nrrd -o %s.ply
holds 'are in the names of files' [ -f 'left lung.ply' ]
works 'and chosen by' labels s.seg.nrrd -o by.ply --only 'left lung' --quiet
same 'the same' by.ply 'left lung.ply'
works 'and in a .glb' labels s.seg.nrrd -o s.glb --quiet
holds 'with their colours' [ "$(count '"name":"left lung","pbrMetallicRoughness":{"baseColorFactor":\[1,0,0,1\]' s.glb)" = 1 ]
holds 'and others' [ "$(count 'baseColorFactor":\[0,0.2[0-9]*,1,1\]' s.glb)" = 1 ]
gives 'the report has them' 0 '{"value": 3, "name": "left lung", "voxels": 8' labels s.seg.nrrd -o s.glb --json
segments same same >s.seg.nrrd
gives 'two of one name have their numbers' 0 'x_5.ply' labels s.seg.nrrd -o x_%s.ply
segments ../a/b '5' >s.seg.nrrd
gives 'a name is no folder' 0 'y_.._a_b.ply' labels s.seg.nrrd -o y_%s.ply
segments 'a "b" \' '5' >s.seg.nrrd
works 'quotes in a name' labels s.seg.nrrd -o q.glb --quiet
gives 'are escaped' 0 'components  2' info q.glb

# ---- names of a table ----
printf '# no\n1   Left-Thalamus  255 0 255 0\n 7 Late 400 0 0 0\n1 Again 0 0 0 0\n' >fs.txt
printf '3 Left-Thalamus\n' >three.txt
printf 'no names\n' >none.txt
printf '    0   0 0 0  0 0 0    "Clear Label"\n    1   255    0  255        1  1  1    "Label, 1"\n' >snap.txt
printf 'index,name,r,g,b\r\n1,"Gray, matter",255,0,255\r\n2,b c' >t.csv
printf 'index\tname\tabbreviation\n2\tLeft Hippocampus\tLH\n' >t.tsv
gives 'names of FreeSurfer' 0 'n_Left-Thalamus.ply: .* closed' labels "$labels" -o n_%s.ply --names fs.txt
holds 'a label without one has its number' [ -f n_2.ply ]
gives 'names of ITK-SNAP' 0 'n_Label, 1.ply' labels "$labels" -o n_%s.ply --names snap.txt
gives 'names of .csv' 0 'n_b c.ply' labels "$labels" -o n_%s.ply --names t.csv --only 'b c'
gives 'names of .tsv' 0 'n_Left Hippocampus.ply' labels "$labels" -o n_%s.ply --names t.tsv
for n in fs.txt snap.txt t.csv; do
    works "colours of $n" labels "$labels" -o n.glb --names $n --quiet
    holds 'are in the .glb' [ "$(count 'baseColorFactor":\[1,0,1,1\]' n.glb)" = 1 ]
done
gives 'the table first' 0 'x_Left-Thalamus' labels s.seg.nrrd -o x_%s.ply --names three.txt
refuses 1 'none.txt: no line has the number of a label and a name' labels "$labels" -o x_%s.ply --names none.txt
refuses 1 'absent.txt' labels "$labels" -o x_%s.ply --names absent.txt

# ---- 64 bits: 2^53, one more and two more are one double ----
# shellcheck disable=SC2059
for k in 0 1 2; do printf "\\00$k\\0\\0\\0\\0\\0\\040\\0"; done >wide.raw
for type in i64 u64; do
    gives "labels of 64 bits, $type" 0 'wide_9007199254740993.stl' labels wide.raw -o wide_%s.stl --shape 3,1,1 --sample-type $type
    works "one of them, $type" labels wide.raw -o w.ply --shape 3,1,1 --sample-type $type --only 9007199254740993 --quiet
done
printf '\377\377\377\377\377\377\377\377' >last.raw
gives 'the last label' 0 'l_18446744073709551615.ply' labels last.raw -o l_%s.ply --shape 1,1,1 --sample-type u64
gives 'a negative one' 0 'l_-1.ply' labels last.raw -o l_%s.ply --shape 1,1,1 --sample-type i64 --only -1

# ---- refusals ----
refuses 2 '3 labels need %s in the name' labels "$labels" -o x.ply
refuses 2 '%d is not replaced in a name; %s is' labels "$labels" -o x_%d.ply
refuses 2 'the name has two %s' labels "$labels" -o x_%s_%s.ply
refuses 1 "there is no label '3'; the first is 1, the last 7" labels "$labels" -o x_%s.ply --only 1,3
refuses 1 "there is no label ''" labels "$labels" -o x_%s.ply --only 1,
refuses 2 'labels are of volumes' labels "$knot" -o x_%s.ply
refuses 2 'which atlas.nii.gz is not; the Python package makes .nrrd of it' labels atlas.nii.gz -o x_%s.ply
refuses 2 'does not end in a mesh format' labels "$labels" -o x_%s.bvx
refuses 2 '.stl has the normals of triangles only' labels "$labels" -o x_%s.stl --normals
refuses 2 'lacks -o' labels "$labels"
refuses 1 'the samples are floats; labels are whole numbers' labels wide.raw -o x_%s.ply --shape 3,1,1 --sample-type f64
refuses 2 'holds bare samples' labels wide.raw -o x_%s.ply
head -c 24 /dev/zero >none.raw
refuses 1 'all samples are the background' labels none.raw -o x_%s.ply --shape 3,1,1 --sample-type u64
refuses 1 '--memory-limit' labels "$labels" -o x_%s.ply --memory-limit 40000
awk 'BEGIN { printf "NRRD0004\ntype: uint16\ndimension: 3\nsizes: 600 1 1\nspacings: 1 1 1\nencoding: ascii\n\n"; for (i = 1; i <= 600; i++) print i }' >many.nrrd
refuses 1 '600 labels, more than the 512 meshes of one run; choose some by --only' labels many.nrrd -o x_%s.ply
gives 'one of many' 0 'm.ply' labels many.nrrd -o m.ply --only 600

counts
