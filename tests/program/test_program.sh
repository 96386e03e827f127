#!/bin/sh
# test_program.sh [PROGRAM] - the bitvox program from outside: what it says, writes, leaves behind and returns.
# PROGRAM is build/bitvox, or what BITVOX names. One line a check, "ok NAME" or "not ok NAME"; the last line is
# "N passed, N failed[, N skipped]". Runs in the repository's root, works in a folder of its own.
set -u
program=${1:-${BITVOX:-build/bitvox}}
case $program in
/*) ;;
*) program=$PWD/$program ;;
esac
root=$PWD
knot=$root/fixtures/knot.ply
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
trap 'exit 130' INT TERM
cd "$work" || exit 1
passed=0 failed=0 skipped=0

ok() { passed=$((passed + 1)); echo "ok $1"; }
not_ok() { # NAME, WHY
    failed=$((failed + 1))
    echo "not ok $1"
    echo "# $2"
    sed 's/^/#   /' err | head -n 5
}
skip() { skipped=$((skipped + 1)); echo "ok $1 # SKIP $2"; }
has() { command -v "$1" >/dev/null 2>&1; }

: >out
: >err
: >before
: >after
run() { # ARGUMENTS...: sets $status; out and err hold what was said
    "$program" "$@" >out 2>err </dev/null
    status=$?
}

holds() { # NAME, COMMAND...: the command succeeds
    holds_name=$1
    shift
    if "$@" >/dev/null 2>&1; then ok "$holds_name"; else not_ok "$holds_name" "failed: $*"; fi
}

# What must hold after a refusal: the status, one line on standard error with these words, nothing else anywhere.
refuses() { # STATUS, WORDS, ARGUMENTS...
    want=$1 words=$2
    shift 2
    name="refused ($want): $(printf '%s ' "$@" | sed "s|$root/||g" | tr -d '\n' | cut -c 1-90)"
    ls -A >before
    run "$@"
    ls -A >after
    if [ $status != "$want" ]; then not_ok "$name" "status $status"
    elif [ "$(wc -l <err)" -ne 1 ]; then not_ok "$name" "$(wc -l <err) lines on standard error"
    elif ! grep -q '^bitvox: ' err; then not_ok "$name" "no 'bitvox: ' before the message"
    elif ! grep -q -F -e "$words" err; then not_ok "$name" "no '$words' in the message"
    elif [ -s out ]; then not_ok "$name" "something on standard output"
    elif ! cmp -s before after; then not_ok "$name" "the folder changed: $(diff before after | tr '\n' ' ')"
    else ok "$name"; fi
}

# The value of a key in the JSON report, by python3.
json() { # FILE, EXPRESSION over r
    python3 -c 'import json, sys; r = json.load(open(sys.argv[1])); print(eval(sys.argv[2]))' "$1" "$2"
}

# ---- help ----

run
holds 'without a command: status 2' test $status = 2
holds 'without a command: the commands are listed' grep -q 'voxelize' err
for words in 'help' '--help' 'help lod' 'lod --help' 'info -h' 'voxelize --help' 'render --help' '--version'; do
    # shellcheck disable=SC2086
    run $words
    if [ $status = 0 ] && [ -s out ] && [ ! -s err ]; then ok "bitvox $words"; else not_ok "bitvox $words" "status $status"; fi
done
run --version
version=$(awk '/define BVX_VERSION_(MAJOR|MINOR|PATCH) / { v = v (v == "" ? "" : ".") $3 } END { print v }' "$root/include/bitvox.h")
holds "the version is the header's" test "$(cat out)" = "bitvox $version"

# The example in each help works as it stands, in the project's folder with the program on the path.
mkdir example bin
ln -s "$program" bin/bitvox
ln -s "$root/fixtures" example/fixtures
for command in info lod voxelize render; do
    run $command --help
    example=$(tail -n 1 out)
    holds "the example of $command works" sh -c "cd example && PATH='$work/bin:$PATH' && $example"
done
rm -rf example bin

# ---- wrong usage: status 2 ----

refuses 2 "'render' meant" rendre "$knot"
refuses 2 "'lod' meant" lods "$knot"
refuses 2 'is no command' xyzzy
refuses 2 'is no command' help xyzzy
refuses 2 'too many' help lod info
refuses 2 '--resolution meant' lod "$knot" -o x_%d.ply --resolutoin 64
refuses 2 '--resolution meant' lod "$knot" -o x_%d.ply --res 64
refuses 2 '--threads meant' info "$knot" --thread 1
refuses 2 'is no option of info' info "$knot" --quux
refuses 2 'is no option of info' info "$knot" -v
refuses 2 'has no use for --fill' info "$knot" --fill parity
refuses 2 'has no use for -o' info "$knot" -o x.ply
refuses 2 'has no use for --smooth' lod "$knot" -o x_%d.ply --smooth
refuses 2 'has no use for --levels' render "$knot" -o x.png --levels 3
refuses 2 'lacks its input' info
refuses 2 'lacks -o' lod "$knot"
refuses 2 'too many' info "$knot" "$knot"
refuses 2 'lacks its value' info "$knot" --threads
refuses 2 'given twice' info "$knot" --threads 1 --threads=2
refuses 2 'takes no value' info "$knot" --quiet=1
for value in '' x -1 1.5 1025 0x10 ' 1' '1 ' 99999999999999999999; do refuses 2 'whole number from 0 to 1024' info "$knot" --threads "$value"; done
for value in '' 0 1T 1KK 99999999999G -5 K; do refuses 2 'count of bytes' info "$knot" --memory-limit "$value"; done
for value in '' 64, ,64 64,,32 64,0 a 64,32,b 1e3; do refuses 2 'whole numbers' lod "$knot" -o x_%d.ply --levels "$value"; done
for value in 0 1 -0.5 nan inf 0x1p-1 0.5x 1e; do refuses 2 'above 0 and below 1' lod "$knot" -o x_%d.ply --threshold "$value"; done
for value in 0.99 65 x; do refuses 2 'a number from 1 to 64' lod "$knot" -o x_%d.ply --triangles 100 --collapse "$value"; done
refuses 2 'one of: parity, nonzero' lod "$knot" -o x_%d.ply --fill odd
refuses 2 'one of: edge-ratio, coverage' lod "$knot" -o x_%d.ply --method best
refuses 2 'exclude each other' lod "$knot" -o x_%d.ply --levels 3 --triangles 100
refuses 2 'needs --method edge-ratio' lod "$knot" -o x_%d.ply --method coverage --edge-samples 4
refuses 2 'needs --triangles' lod "$knot" -o x_%d.ply --collapse 3
refuses 2 'below level 64' lod "$knot" -o x_%d.ply --levels 64,32 --resolution 63
refuses 2 'whole number from 1' lod "$knot" -o x_%d.ply --resolution 64,64,64
refuses 2 'need %d' lod "$knot" -o x.ply
refuses 2 'stands twice' lod "$knot" -o x_%d_%d.ply
refuses 2 'no mesh format that is written' lod "$knot" -o x_%d.npy
refuses 2 'no mesh format that is written' lod "$knot" -o x_%d.ply.gz
refuses 2 'no grid format that is written' voxelize "$knot" -o x.ply
refuses 2 'exclude each other' voxelize "$knot" -o x.npy --resolution 9 --spacing 1
refuses 2 'one whole number or three' voxelize "$knot" -o x.npy --resolution 9,9
refuses 2 'needs --spacing' voxelize "$knot" -o x.npy --origin 0,0,0
refuses 2 'three numbers' voxelize "$knot" -o x.npy --spacing 1 --origin 0,0
refuses 2 '6 whole numbers' voxelize "$knot" -o x.npy --window 0,0,0,9,9
refuses 2 'window is empty' voxelize "$knot" -o x.npy --window 0,5,0,9,5,9
refuses 2 'above 0' voxelize "$knot" -o x.npy --spacing 0
refuses 2 'no picture format' render "$knot" -o x.jpg
refuses 2 'like 1024x768' render "$knot" -o x.png --size 100
refuses 2 'like 1024x768' render "$knot" -o x.png --size 0x100
refuses 2 'points nowhere' render "$knot" -o x.png --from 0,0,0
refuses 2 'standard input' info -
refuses 2 'standard output' render "$knot" -o -

# ---- bad input: status 1 ----

refuses 1 'No such file' info missing.ply
refuses 1 'no mesh format that is read' info missing.npy
refuses 1 'no mesh format that is read' info missing
mkdir folder.ply
refuses 1 'irectory' info folder.ply
rmdir folder.ply
: >empty.ply
: >empty.obj
: >empty.stl
for file in empty.ply empty.obj empty.stl; do refuses 1 "$file: " info $file; done
head -c 100000 "$knot" >cut.ply
for command in info 'lod -o x_%d.ply' 'voxelize -o x.npy' 'render -o x.png'; do
    # shellcheck disable=SC2086
    refuses 1 'cut.ply: ' $command cut.ply
done
printf 'v 0 0 0\nv 1 0 0\nv 0 1 nan\nf 1 2 3\n' >nan.obj
refuses 1 'nan.obj: ' info nan.obj
refuses 1 'nan.obj: ' render nan.obj -o x.png
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n' >index.obj
refuses 1 'index.obj: ' info index.obj
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 x\n' >letter.obj
refuses 1 'line 4' info letter.obj
printf 'v 5 5 5\nv 5 5 5\nv 5 5 5\nf 1 2 3\n' >point.obj
refuses 1 'one point' lod point.obj -o x_%d.ply
refuses 1 'one point' render point.obj -o x.png
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n' >flat.obj
refuses 1 'flat.obj: ' lod flat.obj -o x_%d.ply --quiet
printf 'v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n' >line.obj
refuses 1 'line.obj: ' lod line.obj -o x_%d.ply --triangles 100,50 --quiet
refuses 1 'lattice' voxelize "$knot" -o x.npy --resolution 16 --window 0,0,0,99,9,9
refuses 1 'limit' voxelize "$knot" -o x.npy --resolution 1000 --memory-limit 4M
refuses 1 'memory-limit' info "$knot" --memory-limit 1000
refuses 1 'limit' lod "$knot" -o x_%d.ply --resolution 3000 --memory-limit 100M
refuses 1 'level 1' lod "$knot" -o x_%d.ply --levels 32,1 --samples 0 --threshold 0.9
printf '%s' "$(printf 'x%.0s' 1 2 3 4 5 6 7 8)" >"new
line.ply"
refuses 1 'new?line.ply' info "new
line.ply"
rm -f -- *.ply *.obj *.stl

# ---- outputs that cannot be ----

refuses 1 'cannot be written' render "$knot" -o missing/x.png
refuses 1 'cannot be written' lod "$knot" -o missing/x_%d.ply
mkdir folder.png
refuses 1 'cannot be written' render "$knot" -o folder.png
rmdir folder.png
mkdir x_1.ply
refuses 1 'x_1.ply: cannot be written' lod "$knot" -o x_%d.ply
rmdir x_1.ply
if [ "$(id -u)" != 0 ]; then
    mkdir locked
    chmod 555 locked
    refuses 1 'cannot be written' render "$knot" -o locked/x.png
    chmod 755 locked
    rmdir locked
    echo kept >locked.png
    chmod 444 locked.png
    refuses 1 'cannot be written' render "$knot" -o locked.png
    rm -f locked.png
else
    skip 'locked files and folders' 'root may write everywhere'
fi
if [ -c /dev/full ]; then
    ln -s /dev/full full.png
    refuses 1 'cannot be written' render "$knot" -o full.png --size 50x50
    holds 'a device stays a device' test -c full.png
    rm full.png
    "$program" info "$knot" >/dev/full 2>err
    holds 'a full standard output is a failure' test $? = 1
else
    skip 'a full device' 'there is no /dev/full'
fi
echo kept >x.png
refuses 1 'No such file' render missing.ply -o x.png
holds 'a failure leaves an older file alone' grep -q '^kept$' x.png

# ---- what is written ----

run render "$knot" -o x.png --size 120x90
holds 'render writes a picture' test $status = 0
holds 'a picture is a PNG' sh -c "head -c 8 x.png | od -An -tx1 | tr -d ' \n' | grep -q '^89504e470d0a1a0a$'"
cp x.png y.png
run render "$knot" -o y.png --size 120x90 --threads 1
holds 'render: threads do not show' cmp x.png y.png
run render "$knot" -o y.png --size 120x90 --smooth
holds 'render --smooth is another picture' sh -c '! cmp -s x.png y.png'
run render "$knot" "$knot" -o y.png --size 60x45
holds 'render takes several meshes' test $status = 0
rm -f x.png y.png

run lod "$knot" -o x_%d.ply --samples 500
cp out table.txt
holds 'lod writes its usual levels' sh -c "test $status = 0 && test -s x_0.ply && test -s x_1.ply && test -s x_2.ply"
holds 'lod: the certificate of each level' test "$(grep -c -E '^ +[0-2] +[0-9]+x.* yes$' table.txt)" = 3
holds 'lod: the choice of resolution is told' grep -q 'resolution 512, 8 x the finest level' table.txt
holds 'lod: samples and seed are told' grep -q '500 random points on each mesh, seed 1' table.txt
holds 'lod leaves nothing else' test "$(ls -A | grep -c '^x_')" = 3
for level in 0 1 2; do
    run info x_$level.ply
    holds "level $level is closed, manifold and oriented" test "$(grep -c -E '^  (closed|manifold|oriented) +yes$' out)" = 3
    holds "level $level has the knot's topology" grep -q 'components  1, Euler number 0' out
done
cp x_0.ply first.ply
run lod "$knot" -o x_%d.ply --samples 0 --threads 1 --quiet
holds 'lod: threads do not show' cmp x_0.ply first.ply
holds '--quiet says nothing' sh -c 'test ! -s out && test ! -s err'
run lod "$knot" -o y.stl --levels 24 --samples 0
holds 'lod writes one level without %d' test -s y.stl
run info y.stl
holds 'an STL level is closed' grep -q -E '^  closed +yes$' out
run lod "$knot" -o z%d.obj --triangles 3000,800 --samples 0
holds 'lod --triangles' test $status = 0
run info z0.obj
holds 'no more triangles than asked for' test "$(awk '/triangles/ { print $2 }' out)" -le 3000
run lod "$knot" -o y.ply --levels 128 --samples 0 --resolution 128 --method edge-ratio --edge-samples 3
holds 'a level larger than the input is told' grep -q 'more triangles than the input' err
run render "$knot" -o voxels.png --voxels 40 --size 200x150
holds 'render --voxels' test $status = 0 -a -s voxels.png
refuses 2 'needs --voxels' render "$knot" -o x.png --fill nonzero
run lod "$knot" -o y.ply --levels 64 --samples 0 --memory-limit 6M
holds 'a memory limit lowers the resolution' grep -q 'what memory allows' out
cp "$knot" same.ply
run lod same.ply -o same.ply --levels 16 --samples 0
holds 'input and output may be one file' sh -c "test $status = 0 && test \$(wc -c <same.ply) -lt 100000"
rm -f x_* y.* z* first.ply same.ply

run voxelize "$knot" -o x.npy --resolution 50
cp out said.txt
set -- $(awk '/dims/ { print $2, $4, $6 }' said.txt)
holds 'voxelize: the longest axis has 50' test "$2" = 50
holds 'voxelize: one byte a voxel behind the header' test "$(wc -c <x.npy)" = $((128 + $1 * $2 * $3))
holds 'voxelize: as many are set as it says' test "$(tail -c +129 x.npy | tr -d '\000' | wc -c)" = "$(awk '/voxels/ { print $2 }' said.txt)"
run voxelize "$knot" -o y.npy --resolution 50 --window "0,0,0,$1,$2,$3" --threads 1
holds 'voxelize: the window of everything is everything' cmp x.npy y.npy
run voxelize "$knot" -o y.npy --resolution 50 --fill nonzero
holds 'voxelize: both rules agree on a clean mesh' cmp x.npy y.npy
run voxelize "$knot" -o y.npy --spacing 0.25 --origin -4,-4,-2
holds 'voxelize --origin' grep -q 'origin      -4, -4, -2' out
run voxelize "$knot" -o y.npy --resolution 20,30,10 --padding 2
holds 'voxelize by axes, with padding' grep -q 'dims        24 x 34 x 14' out
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\n' >open.obj
run voxelize open.obj -o y.npy --resolution 16
holds 'voxelize: rows that do not balance are a warning' grep -q '^bitvox: warning: .*do not balance' err
holds 'voxelize: a warning is no failure' test $status = 0
rm -f ./*.npy open.obj said.txt

# ---- names ----

cp "$knot" ./-dash.ply
run info -- -dash.ply
holds 'a name with a dash behind --' test $status = 0
rm -f -- -dash.ply
mkdir 'a folder'
cp "$knot" 'a folder/ä "quoted".PLY'
run lod 'a folder/ä "quoted".PLY' -o 'a folder/100% %d.ply' --levels 8,6 --samples 0
holds 'spaces, quotes and percent signs in names' test -s 'a folder/100% 1.ply'
if has python3; then
    "$program" info --json 'a folder/ä "quoted".PLY' >out 2>err
    holds 'a name in JSON' test "$(json out 'r["meshes"][0]["path"]')" = 'a folder/ä "quoted".PLY'
fi
rm -rf 'a folder'

# ---- gzip ----

if has gzip; then
    gzip -c "$knot" >k.ply.gz
    run info k.ply.gz
    if grep -q 'made without zlib' err; then
        ok 'without zlib: it says so'
    else
        holds 'a .gz is read' grep -q -E '^  closed +yes$' out
        cp k.ply.gz k.ply
        run info k.ply
        holds 'gzip data are known by their first bytes' test $status = 0
        { head -c 300000 "$knot" | gzip -c; tail -c +300001 "$knot" | gzip -c; } >two.ply.gz
        run info two.ply.gz
        holds 'gzip files joined are read' test $status = 0
        head -c 100000 k.ply.gz >cut.ply.gz
        refuses 1 'end in their middle' info cut.ply.gz
        cp "$knot" no.ply.gz
        refuses 1 'gzip: ' info no.ply.gz
        : >none.ply.gz
        refuses 1 'end in their middle' info none.ply.gz
        head -c 50000000 /dev/zero | gzip -c >bomb.ply.gz
        refuses 1 'memory-limit' info bomb.ply.gz --memory-limit 20M
    fi
    rm -f ./*.gz k.ply
else
    skip 'gzip' 'gzip is missing'
fi

# ---- JSON ----

if has python3; then
    run lod "$knot" -o x_%d.ply --json --samples 200 --levels 32,16
    cp out lod.json
    holds 'lod --json is JSON' python3 -m json.tool lod.json
    holds 'lod --json: nothing else is said' test ! -s err
    holds 'lod --json: what the contract names' python3 - <<'P'
import json
r = json.load(open('lod.json'))
assert r['status'] == 'done' and r['warnings'] == [] and 'error' not in r
assert len(r['lattice']['origin']) == 3 and len(r['lattice']['spacing']) == 3 and max(r['lattice']['dims']) == 256
assert 0 < r['set'] and 0 < r['peak_bytes']
assert {'read', 'voxelize', 'level 0', 'level 1', 'write'} <= {s['name'] for s in r['stages']}
assert all(s['seconds'] >= 0 for s in r['stages'])
assert [m['path'] for m in r['meshes']] == ['x_0.ply', 'x_1.ply']
for m in r['meshes']:
    assert m['closed'] is True and m['manifold'] is True and m['oriented'] is True and m['components'] == 1
    assert m['vertices'] * 2 == m['triangles'] and 20 < m['volume'] < 30
    assert 0 < m['mean_distance'] < m['max_distance'] < 0.5
P
    run info --json missing.ply
    cp out info.json
    holds 'a failure is JSON too' test "$(json info.json 'r["status"], r["error"]["code"]')" = "('failed', 'FILE')"
    holds 'a failure: the message on standard error too' grep -q '^bitvox: missing.ply: ' err
    head -c 100000 "$knot" >cut.ply
    run info --json cut.ply
    holds "a failure of the library has its status' name" test "$(json out 'r["error"]["code"]')" = BVX_ERR_FORMAT
    run info --json --nonsense
    holds 'wrong usage is JSON too' test "$(json out 'r["error"]["code"]')" = USAGE
    run lod "$knot" -o x_%d.ply --json --samples 0 --levels 128 --resolution 128
    holds 'a warning stands in JSON' test "$(json out 'len(r["warnings"])')" = 1
    for words in "info $knot" "voxelize $knot -o x.npy --resolution 9" "render $knot -o x.png --size 40x30"; do
        # shellcheck disable=SC2086
        run $words --json
        holds "${words%% *} --json is JSON" python3 -m json.tool out
    done
    rm -f x* cut.ply ./*.json
else
    skip 'JSON' 'python3 is missing'
fi

# ---- interrupts ----

# Each run is stopped after a while; it must end with 130 and leave the folder as it was. A run that is quicker than
# that ends with 0; the longest wait that still stops it counts.
if env --default-signal=INT true 2>/dev/null; then
    mkdir stop
    interrupt() { # NAME, ARGUMENTS...
        interrupt_name=$1
        shift
        stopped=0 wrong=
        for wait in 0.02 0.1 0.3; do
            env --default-signal=INT "$program" "$@" >out 2>err </dev/null &
            child=$!
            sleep $wait
            kill -INT $child 2>/dev/null
            wait $child
            status=$?
            case $status in
            130)
                stopped=1
                [ -z "$(ls -A stop)" ] || wrong="left behind: $(ls -A stop)"
                grep -q '^bitvox: interrupted' err || wrong='no message'
                ;;
            0) rm -f stop/* ;;
            *) wrong="status $status" ;;
            esac
        done
        if [ -n "$wrong" ]; then not_ok "$interrupt_name" "$wrong"
        elif [ $stopped = 0 ]; then not_ok "$interrupt_name" 'it was never stopped'
        else ok "$interrupt_name"; fi
    }
    interrupt 'an interrupted lod' lod "$knot" -o stop/x_%d.ply --levels 400,300 --resolution 1200 --samples 1000000
    interrupt 'an interrupted voxelize' voxelize "$knot" -o stop/x.npy --resolution 1200
    interrupt 'an interrupted render' render "$knot" -o stop/x.png --size 4000x4000
else
    skip 'interrupts' 'env cannot restore signals here'
fi

echo "$passed passed, $failed failed$([ $skipped = 0 ] || echo ", $skipped skipped")"
[ $failed = 0 ]
