#!/bin/sh
# test_program.sh [PROGRAM] - the bitvox program from outside: what it says, writes, leaves behind and returns.
# PROGRAM is build/bitvox, or what BITVOX names. One line a check, "ok NAME" or "not ok NAME"; the last line is
# "N passed, N failed[, N skipped]". Runs in the repository's root, works in a folder of its own.
set -u
. tests/tools/program_checks.sh

# The value of a key in the JSON report, by python3.
json() { # FILE, EXPRESSION over r
    python3 -c 'import json, sys; r = json.load(open(sys.argv[1])); print(eval(sys.argv[2]))' "$1" "$2"
}

# ---- help ----

run
holds 'without a command: status 2' test $status = 2
holds 'without a command: the commands are listed' grep -q 'voxelize' err
commands=$("$program" help | awk '/^  [a-z]/ { print $1 }')
holds 'the overview names the commands' test "$(echo "$commands" | grep -c -x -E 'lod|info|voxelize|render')" = 4
# shellcheck disable=SC2086
for words in help --help help/lod info/-h --version help/--man help/--bash-completion $(printf '%s/--help %s/--help-all ' $(echo "$commands" | sed 'p')); do
    words=$(echo "$words" | tr / ' ')
    # shellcheck disable=SC2086
    run $words
    if [ $status = 0 ] && [ -s out ] && [ ! -s err ]; then ok "bitvox $words"; else not_ok "bitvox $words" "status $status"; fi
done
run --version
version=$(awk '/define BVX_VERSION_(MAJOR|MINOR|PATCH) / { v = v (v == "" ? "" : ".") $3 } END { print v }' "$root/include/bitvox.h")
holds "the version is the header's" test "$(cat out)" = "bitvox $version"

# Every example in each command's help works as it stands, in the project's folder with the program on the path.
mkdir example bin
ln -s "$program" bin/bitvox
ln -s "$root/fixtures" example/fixtures
for command in $commands; do
    "$program" "$command" --help | awk '/^  -/ { print $1 }' >few
    "$program" "$command" --help-all | awk '/^  -/ { print $1 }' >all
    holds "the help of $command: at most 15 options, all of them options" \
        test "$(wc -l <few)" -le 15 -a "$(grep -c -x -F -f all few)" = "$(wc -l <few)" -a "$(wc -l <few)" -ge 10
    holds "the help of $command: at most two examples" test "$("$program" "$command" --help | sed '1,/^examples*:$/d' | wc -l)" -le 2
    "$program" "$command" --help-all | sed '1,/^examples*:$/d' >examples
    holds "$command has an example" test -s examples
    while IFS= read -r example; do
        # shellcheck disable=SC2086
        holds "works: $(echo $example)" sh -c "cd example && PATH='$work/bin:$PATH' && $example"
    done <examples
done
rm -rf example

# The completion for bash, as it would be asked while typing.
if has bash; then
    "$program" help --bash-completion >completion
    cat >complete.sh <<'END'
source ./completion
compopt() { asked=$1; }
COMP_WORDS=(bitvox "$@")
COMP_CWORD=$#
_bitvox
[[ $asked == -o ]] && echo FILES || echo ${COMPREPLY[@]}
END
    complete_as() { bash complete.sh "$@"; } # WORDS...: what may stand in place of the last one
    bash -c 'source ./completion; complete -p bitvox' >registered 2>&1
    holds 'completion: bash registers it and says nothing' test "$(cat registered)" = 'complete -o default -F _bitvox bitvox'
    holds 'completion: commands' test "$(complete_as ren)" = render
    holds 'completion: all commands and help' test "$(complete_as '' | wc -w)" = $(($(echo "$commands" | wc -l) + 3))
    holds 'completion: options' test "$(complete_as lod x.ply --res)" = --resolution
    holds 'completion: options of this command alone' test "$(complete_as info --le)" = ''
    holds 'completion: names of a value' test "$(complete_as voxelize --fill n)" = nonzero
    holds 'completion: names behind an equals sign' test "$(complete_as voxelize --progress = j)" = json
    holds 'completion: right behind the equals sign' test "$(complete_as voxelize --progress =)" = 'auto bar json none'
    holds 'completion: numbers are not guessed' test "$(complete_as lod --levels '')" = ''
    holds 'completion: files' test "$(complete_as info '')" = FILES
    holds 'completion: files behind -o' test "$(complete_as lod -o a)" = FILES
    holds 'completion: files behind --' test "$(complete_as info -- -)" = FILES
    holds 'completion: help' test "$(complete_as help --m)" = --man
    for command in $commands; do
        "$program" "$command" --help-all | awk '/^  -/ { print $1 }' | sort >wanted
        complete_as "$command" - | tr ' ' '\n' | grep . | sort >offered
        holds "completion: all options of $command" cmp wanted offered
    done
    rm -f wanted offered completion complete.sh registered
else
    skip 'completion' 'bash is missing'
fi

# The manual page: nothing to warn about, and nothing of the tables is missing.
"$program" help --man >bitvox.1
if has groff; then
    groff -man -Tascii -ww -z bitvox.1 >warnings 2>&1
    holds 'the manual page: groff warns of nothing' test ! -s warnings
fi
if has mandoc; then holds 'the manual page: mandoc finds no fault' mandoc -T lint -W error bitvox.1; fi
if has man && man --version 2>/dev/null | grep -q '^man [0-9]'; then
    LC_ALL=C man --warnings=w -l bitvox.1 >shown 2>warnings </dev/null
    holds 'the manual page: man shows it and warns of nothing' sh -c 'grep -q "EXIT STATUS" shown && test ! -s warnings'
fi
sed 's/\\f[BIR]//g; s/\\-/-/g; s/\\e/\\/g; s/\\&//g' bitvox.1 >plain.txt
for command in $commands; do
    "$program" "$command" --help-all | awk '/^  -/ { print $1 }' | while read -r option; do
        grep -q -e "^$option\( \|\$\)" plain.txt || echo "$option"
    done >lacking
    "$program" "$command" --help-all | sed '1,/^examples*:$/d; s/^  //' | while IFS= read -r example; do
        grep -q -x -F -e "$example" plain.txt || echo "$example"
    done >>lacking
    grep -q -F "bitvox $command " plain.txt || echo "$command" >>lacking
    holds "the manual page: $command with its options and examples" test ! -s lacking
done
holds 'the manual page: its sections' \
    test "$(grep -c -x -E '\.SH (NAME|SYNOPSIS|DESCRIPTION|COMMANDS|FILES|EXIT STATUS|EXAMPLES)' bitvox.1)" = 7
rm -f bitvox.1 plain.txt lacking examples shown warnings

# ---- wrong usage: status 2 ----

refuses 2 "did you mean 'render'" rendre "$knot"
refuses 2 "did you mean 'lod'" lods "$knot"
refuses 2 'unknown command' xyzzy
refuses 2 'unknown command' help xyzzy
refuses 2 'too many' help lod info
refuses 2 'did you mean --resolution' lod "$knot" -o x_%d.ply --resolutoin 64
refuses 2 'did you mean --resolution' lod "$knot" -o x_%d.ply --res 64
refuses 2 'did you mean --threads' info "$knot" --thread 1
refuses 2 'is not an option of info' info "$knot" --quux
refuses 2 'is not an option of info' info "$knot" -v
refuses 2 'has no use for --fill' info "$knot" --fill parity
refuses 2 'has no use for -o' info "$knot" -o x.ply
refuses 2 'has no use for --smooth' lod "$knot" -o x_%d.ply --smooth
refuses 2 'has no use for --levels' render "$knot" -o x.png --levels 3
refuses 2 'lacks its input' info
refuses 2 'lacks -o' lod "$knot"
refuses 2 'too many' compare "$knot" "$knot" "$knot" "$knot"
refuses 2 'lacks its value' info "$knot" --threads
refuses 2 'given twice' info "$knot" --threads 1 --threads=2
refuses 2 'takes no value' info "$knot" --quiet=1
for value in '' x -1 1.5 1025 0x10 ' 1' '1 ' 99999999999999999999; do refuses 2 'whole number from 0 to 1024' info "$knot" --threads "$value"; done
for value in '' 0 1T 1KK 99999999999G -5 K; do refuses 2 'count of bytes' info "$knot" --memory-limit "$value"; done
for value in '' 64, ,64 64,,32 64,0 a 64,32,b 1e3; do refuses 2 'whole numbers' lod "$knot" -o x_%d.ply --levels "$value"; done
for value in 0 1 -0.5 nan inf 0x1p-1 0.5x 1e; do refuses 2 'above 0 and below 1' lod "$knot" -o x_%d.ply --threshold "$value"; done
for value in 0.99 65 x; do refuses 2 'a number from 1 to 64' lod "$knot" -o x_%d.ply --triangles 100 --collapse "$value"; done
refuses 2 'one of: auto, parity, nonzero' lod "$knot" -o x_%d.ply --fill odd
refuses 2 'one of: edge-ratio, coverage, collapse' lod "$knot" -o x_%d.ply --method best
refuses 2 'exclude each other' lod "$knot" -o x_%d.ply --levels 3 --triangles 100
refuses 2 'needs --method edge-ratio' lod "$knot" -o x_%d.ply --method coverage --edge-samples 4
refuses 2 'needs --triangles' lod "$knot" -o x_%d.ply --collapse 3
refuses 2 'below level 64' lod "$knot" -o x_%d.ply --levels 64,32 --resolution 63
refuses 2 'whole number from 1' lod "$knot" -o x_%d.ply --resolution 64,64,64
refuses 2 'need %d' lod "$knot" -o x.ply
refuses 2 'has two %d' lod "$knot" -o x_%d_%d.ply
refuses 2 'a mesh format that can be written' lod "$knot" -o x_%d.npy
refuses 2 'in a grid format that can be written' voxelize "$knot" -o x.csl
refuses 2 'exclude each other' voxelize "$knot" -o x.npy --resolution 9 --spacing 1
refuses 2 'one whole number or three' voxelize "$knot" -o x.npy --resolution 9,9
refuses 2 'needs --spacing' voxelize "$knot" -o x.npy --origin 0,0,0
refuses 2 'three numbers' voxelize "$knot" -o x.npy --spacing 1 --origin 0,0
refuses 2 '6 whole numbers' voxelize "$knot" -o x.npy --window 0,0,0,9,9
refuses 2 'window is empty' voxelize "$knot" -o x.npy --window 0,5,0,9,5,9
refuses 2 'above 0' voxelize "$knot" -o x.npy --spacing 0
refuses 2 'a picture format' render "$knot" -o x.jpg
refuses 2 'like 1024x768' render "$knot" -o x.png --size 100
refuses 2 'like 1024x768' render "$knot" -o x.png --size 0x100
refuses 2 'points nowhere' render "$knot" -o x.png --from 0,0,0
refuses 2 'give it with --format' info -
refuses 2 'is for standard input' info "$knot" --format ply
refuses 2 'takes one of: stl, obj' info - --format png
refuses 2 'only once' render - - --format ply -o x.png
refuses 2 'one of: auto, bar, json, none' info "$knot" --progress=yes
refuses 2 'exclude each other' info "$knot" --progress=bar --quiet
refuses 2 'given twice' info "$knot" --progress=bar --progress=json
refuses 2 'did you mean --progress' info "$knot" --progres
refuses 2 'did you mean --memory-limit' info "$knot" --memory 1G
refuses 2 'did you mean --from' render "$knot" -o x.png --fron 1,2,3
refuses 2 'did you mean --size' render "$knot" -o x.png -size 9x9

# ---- bad input: status 1 ----

refuses 1 'No such file' info missing.ply
refuses 1 'No such file' info missing.npy
refuses 1 'a mesh or grid format that can be read' info missing
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
refuses 1 'has an area' lod point.obj -o x_%d.ply
refuses 1 'one point' lod point.obj -o x_%d.ply --levels 8,4
refuses 1 'one point' render point.obj -o x.png
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n' >flat.obj
refuses 1 'flat.obj: ' lod flat.obj -o x_%d.ply --levels 8,4 --quiet
printf 'v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n' >line.obj
refuses 1 'line.obj: ' lod line.obj -o x_%d.ply --triangles 100,50 --quiet
refuses 1 'lattice' voxelize "$knot" -o x.npy --resolution 16 --window 0,0,0,99,9,9
refuses 1 'limit' voxelize "$knot" -o x.npy --resolution 1000 --memory-limit 4M
refuses 1 'the limit is' voxelize "$knot" -o x.npy --resolution 200000 # a limit that is not asked for is the machine's memory
refuses 1 'memory-limit' info "$knot" --memory-limit 1000
refuses 1 'limit' lod "$knot" -o x_%d.ply --resolution 3000 --memory-limit 100M
refuses 1 'limit' lod "$knot" -o x_%d.ply --levels 64,32 --resolution 3000 --memory-limit 100M
refuses 1 'level 0, 1 x 1 x 1 samples, keeps nothing' lod "$knot" -o x_%d.ply --levels 1 --resolution 32 --samples 0 --threshold 0.9 --quiet
refuses 1 'no level before it keeps anything either' lod "$knot" -o x_%d.ply --levels 2,1 --resolution 32 --samples 0 --threshold 0.9 --quiet
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
if device /dev/full; then
    ln -s /dev/full full.png
    refuses 1 'cannot be written' render "$knot" -o full.png --size 50x50
    holds 'a device stays a device' test -c full.png
    rm full.png
    "$program" info "$knot" >/dev/full 2>err
    holds 'a full standard output is a failure' test $? = 1
    "$program" info --json "$knot" >/dev/full 2>err
    status=$?
    holds 'a full standard output is a failure of --json too' sh -c "test $status = 1 && grep -q '^bitvox: standard output' err"
    "$program" help >/dev/full 2>err
    holds 'a full standard output is a failure of help too' test $? = 1
else
    skip 'a full device' 'there is no /dev/full'
fi
not_a_folder='Not a directory'
[ -z "$windows" ] || not_a_folder='No such file'
echo kept >x.png
refuses 1 'No such file' render missing.ply -o x.png
holds 'a failure leaves an older file alone' grep -q '^kept$' x.png
refuses 1 "$not_a_folder" render "$knot" -o x.png/x.png
rm -f x.png
if streams; then
    "$program" info "$knot" >&- 2>err
    holds 'a closed standard output is a failure' test $? = 1
    "$program" render "$knot" -o x.png --size 50x50 --quiet <&- >&- 2>&-
    status=$?
    holds 'closed streams do not get into files' sh -c "test $status = 0 && head -c 4 x.png | grep -q PNG"
    rm -f x.png
else
    skip 'closed standard streams' 'wine opens them'
fi

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

run lod "$knot" -o x_%d.ply --method edge-ratio --samples 500
cp out table.txt
holds 'lod --method edge-ratio writes its usual levels' sh -c "test $status = 0 && test -s x_0.ply && test -s x_1.ply && test -s x_2.ply"
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
run lod "$knot" -o x_%d.ply --method edge-ratio --samples 0 --threads 1 --quiet
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
cp same.ply right.ply
mkdir sub
for way in 'ln -s same.ply other.ply' 'ln same.ply other.ply' 'ln -s ../same.ply sub/other.ply' 'ls same.ply'; do
    case $way in
    'ln -s'*) links || { skip "input and output one file by $way" 'links are not followed'; continue; } ;;
    esac
    cp "$knot" same.ply
    chmod 640 same.ply
    $way >/dev/null
    other=./sub/..//same.ply
    for name in other.ply sub/other.ply; do [ ! -e $name ] || other=$name; done
    run lod same.ply -o "$other" --levels 16 --samples 0
    holds "input and output one file by $way" sh -c "test $status = 0 && cmp $other right.ply"
    case $way in
    'ln -s'*) holds "input and output one file by $way: the link stays" test -L "$other" ;;
    esac
    [ -n "$windows" ] || holds "input and output one file by $way: so does the mode" test "$(ls -lL "$other" | cut -c 1-10)" = '-rw-r-----'
    rm -f same.ply other.ply sub/*
done
rmdir sub
if links; then
    ln -s later.ply dangling.ply
    run lod "$knot" -o dangling.ply --levels 16 --samples 0
    holds 'a link to nothing gets its file' sh -c 'test -L dangling.ply && cmp later.ply right.ply'
    ln -s loop.ply loop.ply
    refuses 1 'cannot be written' lod "$knot" -o loop.ply --levels 16
    rm -f loop.ply dangling.ply later.ply
fi
# Where capitals do not count, neither may they between outputs.
if [ -n "$windows" ]; then
    cp "$knot" a.ply
    cp "$knot" b.ply
    refuses 2 'would both become' convert a.ply A.ply --output-dir capitals --format stl
    refuses 2 'would replace the input' convert a.ply b.ply --output-dir . --format ply
    refuses 2 'would replace the input' convert A.PLY --output-dir . --format ply
    rm -f a.ply b.ply
    run lod "$knot" -o 'größe_猫.ply' --levels 16 --samples 0
    holds 'names in UTF-8' sh -c "test $status = 0 && cmp größe_猫.ply right.ply && grep -q größe_猫.ply out"
    run lod 'größe_猫.ply' -o 'größe_猫.ply' --levels 16 --samples 0
    holds 'and as input and output' sh -c "test $status = 0 && ls | grep -c größe | grep -q -x 1"
    rm -f größe_猫.ply
fi
if pipes; then
    mkfifo out.ply in.ply
    cat out.ply >piped.ply &
    run lod "$knot" -o out.ply --levels 16 --samples 0
    wait
    holds 'an output that is a pipe' sh -c "test $status = 0 && test -p out.ply && cmp piped.ply right.ply"
    : <out.ply &
    run lod "$knot" -o out.ply --levels 300 --resolution 300 --samples 0
    wait
    holds 'an output that is a pipe which nobody reads to its end' sh -c "test $status = 1 && grep -q 'out.ply: cannot be written' err"
    cat "$knot" >in.ply &
    run lod in.ply -o piped.ply --levels 16 --samples 0
    wait
    holds 'an input that is a pipe' cmp piped.ply right.ply
    # One after the other: while the run waits for its input, the place of its second output is taken.
    rm -f x_*
    echo kept >x_0.ply
    "$program" lod in.ply -o x_%d.ply --levels 16,12,8 --samples 0 >out 2>err &
    child=$!
    for i in 1 2 3 4 5 6 7 8 9; do ls bitvox-*-2.part >/dev/null 2>&1 || sleep 0.1; done
    mkdir x_1.ply
    cat "$knot" >in.ply
    wait $child
    status=$?
    holds 'several outputs: of one that fails it is told that those before it are written' \
        sh -c "test $status = 1 && grep -q 'x_1.ply: cannot be written.*; the outputs before it are written' err && cmp x_0.ply right.ply && test ! -e x_2.ply"
    holds 'several outputs: nothing is left behind' sh -c '! ls | grep -E "part$|old$"'
    rmdir x_1.ply
    run lod "$knot" -o x_%d.ply --levels 16,12,8 --samples 0
    holds 'several outputs replace what was there' sh -c 'cmp x_0.ply right.ply && ! ls | grep -E "part$|old$"'
    rm -f in.ply out.ply piped.ply
fi
if device /dev/stdout; then
    ln -s /dev/stdout stdout.ply
    run lod "$knot" -o stdout.ply --levels 16 --samples 0
    holds 'an output that is standard output, a file' cmp out right.ply
    "$program" lod "$knot" -o stdout.ply --levels 16 --samples 0 2>err | cat >piped.ply
    holds 'an output that is standard output, a pipe' cmp piped.ply right.ply
    run lod "$knot" -o stdout.ply --levels 16 --json
    holds 'the report and an output cannot both go there' sh -c "test $status = 2 && grep -q 'where --json' err"
    rm -f stdout.ply piped.ply
fi
"$program" lod - --format ply -o same.ply --levels 16 --samples 0 <"$knot" >out 2>err
holds 'standard input with --format' cmp same.ply right.ply
if streams; then
    "$program" info - --format ply <&- >out 2>err
    holds 'a closed standard input' test $? = 1
fi
rm -f x_* y.* z* first.ply same.ply right.ply

run voxelize "$knot" -o x.npy --resolution 50
cp out said.txt
set -- $(awk '/dims/ { print $2, $4, $6 }' said.txt)
holds 'voxelize: the longest axis has 50' test "$2" = 50
holds 'voxelize: one byte a voxel behind the header' test "$(wc -c <x.npy)" = $((128 + $1 * $2 * $3))
holds 'voxelize: as many are set as it says' test "$(tail -c +129 x.npy | tr -d '\000' | wc -c)" = "$(awk '/^  voxels/ { print $2 }' said.txt)"
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
odd='ä "quoted".PLY'
[ -z "$windows" ] || odd="ä 'quoted'.PLY" # no name has the other quotes there
mkdir 'a folder'
cp "$knot" "a folder/$odd"
run lod "a folder/$odd" -o 'a folder/100% %d.ply' --levels 8,6 --samples 0
holds 'spaces, quotes and percent signs in names' test -s 'a folder/100% 1.ply'
if has python3; then
    "$program" info --json "a folder/$odd" >out 2>err
    holds 'a name in JSON' test "$(json out 'r["meshes"][0]["path"]')" = "a folder/$odd"
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
        refuses 1 'the data end too early' info cut.ply.gz
        cp "$knot" no.ply.gz
        refuses 1 'gzip: ' info no.ply.gz
        : >none.ply.gz
        refuses 1 'the data end too early' info none.ply.gz
        head -c 50000000 /dev/zero | gzip -c >bomb.ply.gz
        refuses 1 'memory-limit' info bomb.ply.gz --memory-limit 20M
        # 10 GB of zeros in members of 100 MB; the memory taken is that of the limit and little more.
        head -c 100000000 /dev/zero | gzip -c >part.gz
        for i in 1 2 3 4 5 6 7 8 9 10; do cat part.gz; done >ten.gz
        for i in 1 2 3 4 5 6 7 8 9 10; do cat ten.gz; done >bomb.ply.gz
        refuses 1 '--memory-limit leaves for it' info bomb.ply.gz --memory-limit 50M
        if signals; then
            holds 'a bomb takes the limit and little more' python3 - "$program" <<'P'
import resource, subprocess, sys
r = subprocess.run([sys.argv[1], 'info', 'bomb.ply.gz', '--memory-limit', '50M'], stdout=subprocess.PIPE, stderr=subprocess.PIPE)
most = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss * 1024
assert r.returncode == 1 and most < 80e6, most
P
        fi
        if limits -v 600000 && (ulimit -v 600000 && "$program" info "$knot" --threads 1) >/dev/null 2>&1; then
            (ulimit -v 600000 && "$program" info bomb.ply.gz --threads 1) >out 2>err
            holds 'a bomb without a limit stops at half the memory' grep -q 'holds more than [0-9]* bytes, what remains of half of the memory there is' err
        else
            skip 'a bomb without a limit' 'the address space cannot be limited here'
        fi
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
    holds 'lod --json: of the coarse level, and nothing else' test "$(sed 's/ a volume.*//' err)" = 'bitvox: warning: level 1 has'
    holds 'lod --json: what the contract names' python3 - <<'P'
import json
r = json.load(open('lod.json'))
assert r['status'] == 'done' and [(w['code'], w['message'][:18]) for w in r['warnings']] == [('BVX_WARN_VOLUME', 'level 1 has a volu')] and 'error' not in r
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
    # Whatever happens and whatever the files are called: one valid object with what the contract names.
    cat >schema.py <<'P'
import json, sys
line = open(sys.argv[1], encoding='utf-8').read()
r = json.loads(line)
assert line.count('\n') == 1
assert r['status'] == sys.argv[2], r['status']
assert isinstance(r['stages'], list) and isinstance(r['meshes'], list) and isinstance(r['warnings'], list)
assert isinstance(r['peak_bytes'], int)
assert all(isinstance(s['name'], str) and s['seconds'] >= 0 for s in r['stages'])
for m in r['meshes']:
    for key in ('path', 'vertices', 'triangles', 'closed', 'manifold', 'oriented', 'components', 'volume'):
        assert key in m, key
if r['status'] == 'done':
    assert 'error' not in r
else:
    assert r['error']['code'] and r['error']['message'] and '\n' not in r['error']['message']
P
    good_report() { holds "$1" python3 schema.py out "$2"; } # NAME, STATUS
    for word in info lod voxelize render; do
        run $word --json
        good_report "$word --json without anything" failed
    done
    run rendre --json x.ply
    good_report 'no such command, with --json' failed
    run info --json --threads
    good_report 'a value that lacks, with --json' failed
    strange=
    if [ -n "$windows" ]; then
        skip 'names of quotes, control bytes and no UTF-8' 'there are none'
    else
        strange=$(printf 'a"b\\\001\033\177\377\300\200\355\240\200\303\244.obj')
        printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n' >"$strange"
        run info --json "$strange"
        good_report 'a name of quotes, control bytes and no UTF-8' done
        holds 'such a name: what is UTF-8 stays' test "$(json out '"ä" in r["meshes"][0]["path"] and r["meshes"][0]["path"].count(chr(0xfffd))')" = 6
        run lod --json "$strange" -o "$strange" --levels 8 --samples 0
        good_report 'such a name as input and output' done
        run info --json "missing $strange"
        good_report 'such a name in an error' failed
        holds 'such a name: one line of text without control bytes' sh -c "test \$(wc -l <err) = 1 && ! tr -d '\n' <err | LC_ALL=C grep -q '[[:cntrl:]]'"
        run info "missing $strange"
        holds 'such a name: likewise without --json' sh -c "test \$(wc -l <err) = 1 && ! tr -d '\n' <err | LC_ALL=C grep -q '[[:cntrl:]]'"
    fi
    run info -- --json
    holds '--json behind -- is a name' test ! -s out
    rm -f x* cut.ply ./*.json ${strange:+"$strange"}

    # ---- progress ----

    cat >lines.py <<'P'
import json, sys
fraction, seen = 0, set()
count = 0
for line in open('err', encoding='utf-8'):
    if line.startswith('bitvox: warning: '):
        continue
    p = json.loads(line)
    assert set(p) == {'stage', 'fraction', 'elapsed'} and 0 <= p['fraction'] <= 1 and p['elapsed'] >= 0
    assert p['fraction'] >= fraction, (line, fraction)
    assert fraction < 1 or len(seen) == len({p['stage']} | seen), (line, 'after 1')
    fraction = p['fraction']
    seen.add(p['stage'])
    count += 1
r = json.load(open('out'))
assert r['status'] == 'done', r
assert seen == {s['name'] for s in r['stages']}, (seen, r['stages'])
assert fraction == 1, fraction
assert count <= 2 * len(r['stages']) + 10 * sum(s['seconds'] for s in r['stages']) + 2, count
P
    run lod "$knot" -o x_%d.ply --triangles 3000,800 --collapse 3 --samples 300000 --progress=json --json
    holds '--progress=json: valid lines, stages of the report, fractions that never fall, not too many' python3 lines.py
    run info missing.ply --progress=json
    holds '--progress=json: an error is still one line' test "$(grep -v '^{' err | wc -l)" = 1
    for words in 'lod --resolution 200 --count 2' 'simplify --error 0.02%,0.1%' lod; do
        # shellcheck disable=SC2086
        run $words "$knot" -o x_%d.ply --samples 50000 --progress=json --json
        holds "--progress=json: the same of $words" python3 lines.py
    done

    # Every command, those that make what others read before these.
    while read -r words; do
        # shellcheck disable=SC2086
        run $(echo "$words" | sed "s|KNOT|$knot|; s|WAVES|$(dirname "$knot")/waves.nhdr|") --progress=json --json
        holds "--progress=json: one rise to 1 of $words" python3 lines.py
    done <<'W'
info KNOT --crossings
info WAVES
voxelize KNOT -o x.bvx --resolution 40
voxelize KNOT -o x_shell.bvx --resolution 40 --mode conservative
voxelize KNOT -o x_field.nrrd --resolution 40 --mode field
lod KNOT -o x.glb --levels 24,12 --samples 1000
lod WAVES -o x_w%d.ply --level 120 --levels 24,12 --samples 1000
repair KNOT -o x_r.ply --resolution 40 --measure --triangles 500
boolean union KNOT x_r.ply -o x_u.ply --resolution 40
boolean union KNOT x.bvx -o x_u.bvx
refine KNOT -o x_t.bvx --resolution 16 --halvings 2
refine KNOT -o x_t.ply --resolution 16 --halvings 2
convert x_t.bvx -o x_e.bvx --expand 1
convert KNOT -o x_c.stl
check KNOT -o x_i.ply --resolution 24
convert x.bvx -o x.npy
convert WAVES -o x_v.npy --level 120
components x.bvx -o x_k.bvx --at-least 2
faces x.bvx -o x_f.ply
fill x_shell.bvx -o x_p.bvx
morph dilate x.bvx -o x_d.bvx
morph hollow x.bvx -o x_h.bvx --thickness 0.2
morph distance x.bvx -o x_s.npy
compare x.bvx x_d.bvx
compare KNOT x_r.ply --samples 1000
render KNOT x.bvx -o x.png --size 64x64
slice KNOT -o x.csl --spacing 0.1
sections x.csl -o x_b.ply
W
    run lod "$knot" -o x_%d.ply --quiet --progress=json --samples 100
    holds '--progress=json beside --quiet' sh -c 'test ! -s out && test -s err'
    run lod "$knot" -o y.ply --samples 1000000 --threads 1 --levels 32 --progress=bar
    holds '--progress=bar: a bar, taken away at the end' sh -c "tr '\r' '\n' <err | grep -q '% distance 0'"
    holds '--progress=bar: nothing of it stays' test "$(tr '\r' '\n' <err | tail -n 1)" = "$(printf '\033[K')"
    run lod "$knot" -o y.ply --samples 1000000 --threads 1 --levels 32
    holds 'no bar where there is no terminal' test ! -s err
    if [ -n "$windows" ]; then skip 'a bar on a terminal' 'none is drawn there'; else
    python3 - "$program" "$knot" >shown 2>&1 <<'P'
import os, pty, signal, sys
pid, terminal = pty.fork()
if pid == 0:
    os.environ['TERM'] = 'xterm'
    os.execv(sys.argv[1], [sys.argv[1], 'lod', sys.argv[2], '-o', 'y.ply', '--levels', '32', '--samples', '16000000', '--threads', '1'])
text = b''
while True:
    try:
        part = os.read(terminal, 65536)
    except OSError:
        break
    if not part:
        break
    text += part
    if b' left' in text and b'distance 0' in text:
        os.kill(pid, signal.SIGINT)
        break
lines = text.decode().replace('\x1b[K', '').split('\r')
bars = [l for l in lines if l.startswith('[')]
assert os.waitpid(pid, 0)[1] >> 8 == 130
assert bars and all(len(b) < 80 for b in bars), bars
assert any('distance 0' in b for b in bars)
assert any(' left' in b for b in bars), bars
shares = [int(b.split(']')[1].split('%')[0]) for b in bars]
assert shares == sorted(shares), shares
P
    holds 'a bar on a terminal, with the time left' test ! -s shown
    [ ! -s shown ] || sed 's/^/# /' shown
    fi
    rm -f x_* y.ply lines.py shown
else
    skip 'JSON and progress' 'python3 is missing'
fi

# ---- interrupts ----

# Each run is stopped at a random moment of its life; it ends with 130 in time, leaves the folder as it was (or, when
# everything was done, with all outputs) and tells it in one line and in its report. One that waits for a pipe too.
if signals; then
    cat >interrupts.py <<'P'
import json, os, random, shutil, signal, subprocess, sys, time
program, knot, seed = sys.argv[1], sys.argv[2], int(sys.argv[3])
random.seed(seed)
names = ['x_0.ply', 'x_1.ply', 'x.npy', 'x.png']
jobs = [
    ['lod', knot, '-o', 'stop/x_%d.ply', '--levels', '200,100', '--resolution', '600', '--samples', '100000'],
    ['lod', knot, '-o', 'stop/x_%d.ply', '--triangles', '30000,9000', '--collapse', '3'],
    ['lod', knot, '-o', 'stop/x_%d.ply', '--triangles', '16000,400', '--resolution', '250'],
    ['simplify', knot, '-o', 'stop/x_%d.ply', '--error', '0.05%,0.2%'],
    ['voxelize', knot, '-o', 'stop/x.npy', '--resolution', '500'],
    ['render', knot, '-o', 'stop/x.png', '--size', '1500x1500'],
    ['info', 'big.obj'],
    ['info', 'pipe.ply'],
    ['lod', 'pipe.ply', '-o', 'stop/x_%d.ply', '--levels', '9,5'],
    ['lod', knot, '-o', 'stop/pipe.ply', '--levels', '9'],
]
with open('big.obj', 'w') as f: # one long sequential step: to read and to check
    n = 500
    for i in range(n):
        for k in range(n):
            f.write('v %d %d %d\n' % (i, k, (i * k) % 7))
    for i in range(n - 1):
        for k in range(1, n):
            f.write('f %d %d %d\n' % (i * n + k, i * n + k + 1, i * n + n + k))
os.mkfifo('pipe.ply')

def fresh(job):
    shutil.rmtree('stop', ignore_errors=True)
    os.mkdir('stop')
    for name in names:
        open('stop/' + name, 'w').write('kept')
    if 'stop/pipe.ply' in job:
        os.mkfifo('stop/pipe.ply')

def folder():
    return {n: open('stop/' + n, 'rb').read(4) for n in os.listdir('stop') if n != 'pipe.ply'}

def start(job):
    return subprocess.Popen([program] + job, stdin=subprocess.DEVNULL, stdout=open('out', 'wb'), stderr=open('err', 'wb'),
                            preexec_fn=lambda: [signal.signal(s, signal.SIG_DFL) for s in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)])

slowest, stopped, longest = 0, 0, 0
for job in jobs:
    waits = any('pipe.ply' in w for w in job)
    life = 0.1
    fresh(job)
    if not waits:
        before = time.monotonic()
        assert start(job).wait() == 0, open('err').read()
        life = time.monotonic() - before
        longest = max(longest, life)
    for turn in range(4):
        fresh(job)
        before = folder()
        p = start(job + (['--json'] if turn % 2 else []))
        time.sleep(0.02 + random.random() * life)
        asked = time.monotonic()
        number = random.choice([signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
        p.send_signal(number)
        if turn == 3:
            p.send_signal(number) # a second one changes nothing
        status = p.wait()
        if status != 0:
            slowest = max(slowest, time.monotonic() - asked)
        after, said, report = folder(), open('err').read(), open('out').read()
        what = (job, turn, status, said, report, after)
        assert not any(n.endswith('.part') for n in after), what
        assert status in (0, 130), what
        if status == 0:
            assert not waits, what
            continue
        stopped += 1
        lines = [l for l in said.split('\n') if not l.startswith('bitvox: warning: ')]
        assert len(lines) == 2 and lines[0].startswith('bitvox: interrupted') and lines[1] == '', what
        if 'is written' not in said:
            assert after == before, what
        if turn % 2:
            r = json.loads(report)
            assert r['status'] == 'interrupted' and r['error']['code'] == 'BVX_CANCELLED', what
            assert all(k in r for k in ('stages', 'meshes', 'warnings', 'peak_bytes')), what
print('%d interrupted, slowest %.0f ms' % (stopped, slowest * 1e3))
# beside other programs as much slower as the work itself
assert stopped > len(jobs) and slowest < max(1.0, longest / 4)
P
    # a seed that differs every time, so that many runs try many moments
    seed=$(od -An -N4 -tu4 /dev/urandom 2>/dev/null | tr -d ' ')
    python3 interrupts.py "$program" "$knot" "${seed:-1}" >moments 2>&1
    status=$?
    sed 's/^/# /' moments | tail -n 5
    holds "interrupts at random moments (seed ${seed:-1})" test $status = 0
    python3 - "$program" >moments 2>&1 <<'P'
import os, signal, subprocess, sys, time
def run(setup, job, number, out):
    p = subprocess.Popen([sys.argv[1]] + job, stdin=subprocess.DEVNULL, stdout=out, stderr=subprocess.PIPE, preexec_fn=setup)
    time.sleep(0.1)
    p.send_signal(number)
    time.sleep(0.3)
    return p
def ignore():
    signal.signal(signal.SIGHUP, signal.SIG_IGN)
    signal.signal(signal.SIGINT, signal.SIG_DFL)
p = run(ignore, ['info', 'pipe.ply'], signal.SIGHUP, subprocess.DEVNULL)
assert p.poll() is None, 'an ignored signal ended it'
p.send_signal(signal.SIGINT)
assert p.wait() == 130
# A report that nobody takes, in a full pipe: the run ends all the same.
reader, writer = os.pipe()
os.set_blocking(writer, False)
try:
    while True:
        os.write(writer, b' ' * 4096)
except BlockingIOError:
    os.set_blocking(writer, True)
p = run(lambda: signal.signal(signal.SIGINT, signal.SIG_DFL), ['help', '--man'], signal.SIGINT, writer)
assert p.wait() == 130 and p.stderr.read() == b'bitvox: interrupted; nothing was written\n'
p = run(lambda: signal.signal(signal.SIGINT, signal.SIG_DFL), ['info', 'big.obj', '--json'], signal.SIGINT, writer)
assert p.wait() == 130
P
    status=$?
    sed 's/^/# /' moments | tail -n 5
    holds 'ignored signals stay ignored; a full pipe does not hold an interrupt' test $status = 0
    rm -rf stop pipe.ply big.obj moments interrupts.py schema.py
else
    skip 'interrupts' 'python3 is missing, or the program hears no signals'
fi

counts
