#!/bin/sh
# test_outputs.sh [PROGRAM] - where the bitvox program writes: standard output, packed files, folders.
# PROGRAM is build/bitvox, or what BITVOX names. One line a check, "ok NAME" or "not ok NAME"; the last line is
# "N passed, N failed[, N skipped]". Runs in the repository's root, works in a folder of its own.
set -u
. tests/tools/program_checks.sh

# ---- -o -: standard output ----

contours=$root/fixtures/contours.csv
[ -f "$contours" ] || { run slice "$knot" -o contours.csv --spacing 0.2 && contours=contours.csv; }
run voxelize "$knot" -o knot.bvx --resolution 40
run voxelize "$knot" -o shell.bvx --resolution 40 --mode conservative
same() { # FILE, ARGUMENTS with OUT for its name: what goes to standard output is what goes to the file
    file=$1
    shift
    for word; do
        shift
        [ "$word" = OUT ] && word=$file
        set -- "$@" "$word"
    done
    "$program" "$@" >/dev/null 2>&1 </dev/null || { not_ok "the file: $*" ''; return; }
    for word; do
        shift
        [ "$word" = "$file" ] && word=-
        set -- "$@" "$word"
    done
    run "$@" --quiet
    if [ $status = 0 ] && [ ! -s err ] && cmp -s out "$file"; then ok "to standard output: $*"; else not_ok "to standard output: $*" "status $status"; fi
}
# The format that is meant where none is said.
same x.ply repair "$knot" -o OUT --resolution 32
same x.ply lod "$knot" -o OUT --triangles 2000
same x.ply simplify "$knot" -o OUT --triangles 2000
same x.ply check "$knot" -o OUT --resolution 32
same x.ply faces "$knot" -o OUT --resolution 32
same x.ply convert "$knot" -o OUT
same x.ply boolean union "$knot" "$knot" -o OUT --resolution 32
same x.ply sections "$contours" -o OUT
same x.bvx voxelize "$knot" -o OUT --resolution 32
same x.bvx refine "$knot" -o OUT --halvings 2
same x.bvx convert knot.bvx -o OUT
same x.bvx boolean xor knot.bvx knot.bvx -o OUT
same x.bvx fill shell.bvx -o OUT
same x.bvx components knot.bvx -o OUT --keep-largest 1
same x.bvx morph dilate knot.bvx -o OUT
same x.nrrd morph distance knot.bvx -o OUT
same x.nrrd voxelize "$knot" -o OUT --mode field --resolution 24
same x.csv slice "$knot" -o OUT --spacing 0.3
same x.png render "$knot" -o OUT --size 64x48
rm -f x.*
# And the one of --format.
for format in stl obj off glb; do
    run convert "$knot" -o "right.$format"
    run convert "$knot" -o - --format $format --quiet
    holds "a mesh as $format" cmp out right.$format
done
for format in nrrd vti binvox; do
    run convert knot.bvx -o "right.$format"
    run convert knot.bvx -o - --format $format --quiet
    holds "a grid as $format" cmp out right.$format
done
run lod "$knot" -o right.glb --count 2
run lod "$knot" -o - --count 2 --format glb --quiet
holds 'several levels in one .glb' cmp out right.glb

# Both ends of a pipe: --format is that of both where both hold the same.
"$program" convert - -o - --format off <right.off 2>err >back.off
holds 'from a pipe into a pipe' cmp back.off right.off
"$program" voxelize - -o - --format off --resolution 40 <right.off 2>err >back.bvx
run voxelize right.off -o right.bvx --resolution 40
holds 'from a mesh to a grid' cmp back.bvx right.bvx

# What is said goes to standard error.
run convert "$knot" -o -
holds 'the text is on standard error' grep -q 'triangles   38400' err
run repair "$knot" -o - --resolution 64 --json
holds 'the report is on standard error' sh -c "grep -q '^{\"status\": \"done\"' err && test \$(head -c 3 out) = ply"
run repair none.ply -o - --json
holds 'and so it is after a failure' sh -c "grep -q '^{\"status\": \"failed\"' err && ! test -s out"

refuses 2 'only .glb holds several' lod "$knot" -o -
refuses 2 'one output; .npy.json would be another' voxelize "$knot" -o - --format npy
refuses 2 'fields are written as' voxelize "$knot" -o - --format off --mode field
refuses 2 'a picture format' render "$knot" -o - --format ply
refuses 2 '--format is for standard input and output' convert "$knot" -o x.ply --format ply
refuses 1 'none.ply' repair none.ply -o -
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n' >uv.obj
run convert uv.obj -o - --format stl
holds 'a warning of standard output by its name' grep -q '^bitvox: warning: standard output: texture' err
run render "$knot" -o - --size 16x16
holds 'a picture on standard output by its name' grep -q '^standard output: 16 x 16 pixels' err
run repair uv.obj -o - --json --resolution 16
holds 'and in --json' grep -q '"path": "standard output",' err
refuses 2 'did you mean -o?' repair "$knot" --output x.ply
run repair "$knot" -o - --format obj --resolution 16
holds 'standard output by its name' sh -c "grep -q -e '-> standard output\$' err"
if streams && has script && script -qc true /dev/null >/dev/null 2>&1; then
    script -qc "'$program' convert '$knot' -o -" typed >/dev/null 2>&1
    holds 'a terminal is refused' grep -q 'standard output is a terminal' typed
else
    skip 'a terminal is refused' 'script is missing'
fi
if device /dev/full; then
    "$program" convert "$knot" -o - >/dev/full 2>err
    holds 'a full standard output is a failure' test $? = 1
fi
# A file of the name that messages use is none of the program's.
: >'standard output.ply'
run convert "$knot" -o - --quiet
holds 'a file of such a name stays' sh -c "test -s out && ! test -s 'standard output.ply'"
rm -f 'standard output.ply'

# ---- .gz: packed outputs ----

packed() { # NAME, ARGUMENTS with OUT for it: NAME.gz unpacks to what NAME holds
    file=$1
    shift
    for name in "$file" "$file.gz"; do
        (
            for word; do
                shift
                [ "$word" = OUT ] && word=$name
                set -- "$@" "$word"
            done
            "$program" "$@" --quiet >/dev/null 2>err </dev/null
        ) || { not_ok "packed: $*" "no $name"; return; }
    done
    if gzip -dc "$file.gz" | cmp -s - "$file" && [ "$(wc -c <"$file.gz")" -lt "$(wc -c <"$file")" ]; then ok "packed: $*"; else not_ok "packed: $*" ''; fi
    again=$(cksum <"$file.gz")
    run convert "$file.gz" -o "$file.gz" --quiet
    case $file in
    *.ply) if [ $status = 0 ] && [ "$(cksum <"$file.gz")" = "$again" ]; then ok "packed again: $file"; else not_ok "packed again: $file" "status $status"; fi ;;
    esac
}
run convert "$knot" -o x.ply.gz
if grep -q 'made without zlib' err; then
    holds 'without zlib no .gz is written' sh -c "test $status = 1 && ! test -e x.ply.gz"
elif ! has gzip; then
    skip 'packed outputs' 'gzip is missing'
else
    packed x.ply repair "$knot" -o OUT --resolution 32
    packed x.obj convert "$knot" -o OUT
    packed x.stl lod "$knot" -o OUT --triangles 3000
    packed x.off faces "$knot" -o OUT --resolution 16
    packed x.glb simplify "$knot" -o OUT
    packed x.nrrd voxelize "$knot" -o OUT --resolution 64
    packed x.bvx refine "$knot" -o OUT --halvings 2
    packed x.csv slice "$knot" -o OUT --spacing 0.3
    run lod "$knot" -o 'x_%d.ply.gz' --triangles 3000,1000
    holds 'levels, packed' sh -c 'gzip -t x_0.ply.gz && gzip -t x_1.ply.gz'
    run voxelize "$knot" -o g.npy --resolution 16
    run voxelize "$knot" -o h.npy.gz --resolution 16
    gzip -dc h.npy.gz | cmp -s - g.npy && cmp -s h.npy.json g.npy.json
    result 'a packed grid with its side-car' $?
    works 'and both are read' convert h.npy.gz -o h.bvx
    refuses 2 'a picture format' render "$knot" -o x.png.gz
    if device /dev/full; then
        ln -s /dev/full full.ply.gz
        run convert "$knot" -o full.ply.gz
        holds 'a full disk is told' sh -c "test $status = 1 && grep -q 'full.ply.gz: cannot be written' err"
        rm -f full.ply.gz
    fi
    run convert "$knot" -o x.ply.gz
    run repair x.ply.gz -o y.ply --resolution 32
    run repair "$knot" -o z.ply --resolution 32
    holds 'what was packed is read as it was' cmp y.ply z.ply
fi

# ---- --output-dir: several inputs ----

mkdir in in/sub
for ending in stl obj off; do run convert "$knot" -o in/a_$ending.$ending; done
echo bad >in/bad.stl
cp in/a_stl.stl in/sub/a_stl.stl
each() { # NAME, ENDING, FOLDER, COMMAND...: each of a_stl, a_obj, a_off gives the file that it gives alone
    name=$1 ending=$2 folder=$3 good=0
    shift 3
    command=$1
    shift
    "$program" "$command" in/a_stl.stl in/a_obj.obj in/a_off.off --output-dir "$folder" "$@" >out 2>err </dev/null || good=1
    for input in stl obj off; do
        run "$command" in/a_$input.$input -o "alone.${ending:-$input}" ${only:-"$@"}
        cmp -s "alone.${ending:-$input}" "$folder/a_$input.${ending:-$input}" || good=1
    done
    result "$name" $good
}
each 'repair of several' '' of_repair repair --resolution 32
each 'voxelize of several' bvx of_voxelize voxelize --resolution 24
only='--count 1' each 'simplify of several' ply of_simplify simplify --count 1 --format ply
only='--quiet' each 'convert of several' glb of_convert convert --format glb --quiet
only=
rm -f alone.*

run repair in/a_stl.stl in/bad.stl in/a_off.off none.ply --output-dir some --resolution 32
holds 'a failing input does not stop the others' sh -c "test $status = 1 && test \"\$(ls some)\" = 'a_off.off
a_stl.stl' && cmp some/a_off.off of_repair/a_off.off && grep -q '^bitvox: in/bad.stl: STL' err && grep -q '^bitvox: none.ply: ' err &&
    grep -q '^2 of 4 files written to some; failed: .*, ' out"
run voxelize knot.bvx in/bad.stl --output-dir some
holds 'the status is that of the first failure' test $status = 2
run repair in/a_stl.stl in/bad.stl --output-dir some --resolution 32 --json
if has python3; then
    python3 -c 'import json
r = json.load(open("out"))
assert (r["status"], r["command"], r["done"], r["failed"]) == ("failed", "repair", 1, 1)
a, b = r["files"]
assert (a["input"], a["output"], a["status"]) == ("in/a_stl.stl", "some/a_stl.stl", "done") and a["meshes"][0]["closed"]
assert (b["input"], b["status"], b["error"]["code"]) == ("in/bad.stl", "failed", "BVX_ERR_FORMAT")' 2>err
    result 'one report of all' $?
else
    skip 'one report of all' 'python3 is missing'
fi
warned='in/a_stl.stl: '
run repair in/a_stl.stl in/a_obj.obj --output-dir some --resolution 24
holds 'warnings name their file' sh -c "grep -q '^bitvox: warning: $warned' err && ! grep '^bitvox: warning: ' err | grep -v -q ': in/a_'"
if [ -e in/../some ] && gzip -c in/a_off.off >in/packed.off.gz 2>/dev/null && run info in/packed.off.gz && [ $status = 0 ]; then
    run convert in/packed.off.gz --output-dir some --format ply
    holds 'the ending in place of a packed one' test -s some/packed.ply
fi
run voxelize "$root/fixtures/waves.nhdr" "$root/fixtures/labels.npy" --output-dir volumes --level 3 --format ply
holds 'volumes' sh -c "test $status = 0 && test -s volumes/waves.ply && test -s volumes/labels.ply"
rm -rf some of_* volumes

# Levels of several inputs: numbered after the name of each.
run lod in/a_stl.stl in/a_obj.obj --output-dir of_lod --triangles 900,300 --samples 0
holds 'lod of several' sh -c "test $status = 0 && test \"\$(ls of_lod | tr '\n' ' ')\" = 'a_obj_0.obj a_obj_1.obj a_stl_0.stl a_stl_1.stl '"
run lod in/a_stl.stl -o alone_%d.stl --triangles 900,300 --samples 0
holds 'lod of several: as of one' sh -c 'cmp alone_0.stl of_lod/a_stl_0.stl && cmp alone_1.stl of_lod/a_stl_1.stl'
run lod in/a_stl.stl in/bad.stl in/a_obj.obj --output-dir of_lod --count 1 --samples 0 --format ply
holds 'lod of several: one level is numbered, and a failure stops no other' sh -c "test $status = 1 && test -s of_lod/a_stl_0.ply && test -s of_lod/a_obj_0.ply"
run lod in/a_stl.stl in/a_off.off --output-dir of_lod --triangles 900,300 --samples 0 --format glb
holds 'lod of several: all levels of each in one .glb' sh -c "test $status = 0 && test -s of_lod/a_off.glb && grep -a -q level_1 of_lod/a_stl.glb"
run lod "$root/fixtures/waves.nhdr" --output-dir of_lod --level 120 --levels 24,12 --samples 0
holds 'lod of a volume: .ply' sh -c "test $status = 0 && test -s of_lod/waves_0.ply && test -s of_lod/waves_1.ply"
run simplify in/a_stl.stl in/a_off.off --output-dir of_simplify --triangles 900,300 --samples 0
holds 'several levels of several' sh -c "test $status = 0 && cmp alone_1.stl of_simplify/a_stl_1.stl && test -s of_simplify/a_off_1.off"
cp in/a_stl.stl of_lod/k.stl && cp in/a_stl.stl of_lod/k_1.stl
refuses 2 'of_lod/k_1.stl would replace the input of_lod/k_1.stl' lod of_lod/k.stl of_lod/k_1.stl --output-dir of_lod --count 2
rm -rf of_* alone_*

refuses 2 'would both become some/a_stl.ply' convert in/a_stl.stl in/sub/a_stl.stl --output-dir some --format ply
refuses 2 'would replace the input in/a_stl.stl' convert in/a_obj.obj in/a_stl.stl --format stl --output-dir in
refuses 2 'lacks the format' convert in/a_stl.stl --output-dir some
refuses 2 'exclude each other' repair in/a_stl.stl --output-dir some -o x.ply
refuses 2 'is not written by repair' repair in/a_stl.stl --output-dir some --format npy
refuses 2 'standard input has no name' repair - --output-dir some
refuses 2 'several with --output-dir' repair in/a_stl.stl in/a_obj.obj -o x.ply
refuses 2 'is not written by lod' lod in/a_stl.stl --output-dir some --format npy
refuses 2 'refine has no use for --output-dir' refine in/a_stl.stl --output-dir some
refuses 1 'the folder cannot be made' repair in/a_stl.stl --output-dir in/bad.stl
refuses 2 'lacks its input' repair --output-dir some

# Names with the marks of other programs, or with a number where one file is written.
refuses 2 'out_%s.stl: %s is not replaced in a name; %d is, by the number of each file' lod in/a_stl.stl -o out_%s.stl --triangles 100
refuses 2 'out_%03i.stl: %03i is not replaced' simplify in/a_stl.stl -o out_%03i.stl --triangles 100
refuses 2 'out_%d.stl: %d is for the numbers of several files; repair writes one' repair in/a_stl.stl -o out_%d.stl
run convert in/a_stl.stl -o 50%scaled.ply
if [ "$status" = 0 ] && [ -e 50%scaled.ply ]; then ok 'a percent sign in a name'; else not_ok 'a percent sign in a name'; fi

counts
