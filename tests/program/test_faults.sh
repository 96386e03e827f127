#!/bin/sh
# test_faults.sh [PROGRAM] [all] - what a run of the program leaves when something fails: full and limited devices, folders that
# vanish, pipes in pieces, readers that leave, signals, and every call to the system. PROGRAM is build/bitvox, or what BITVOX
# names; all: every job with every fault, some minutes. One line a check; the last line is "N passed, N failed[, N skipped]".
# Runs in the repository's root, works in a folder of its own.
set -u
. tests/tools/program_checks.sh
all=${2:-}

# Inputs: small ones of every format.
quietly() { "$program" "$@" --quiet </dev/null || echo "# failed: $*"; }
quietly lod "$knot" -o small.ply --levels 12 --samples 0
for format in stl obj off; do quietly convert small.ply -o small.$format; done
for format in npy binvox vox nrrd vti bvx; do quietly voxelize small.ply -o grid.$format --mode thin --resolution 20; done
quietly refine small.ply -o tree.bvx --halvings 3 --base 4
for format in csv csl; do quietly slice small.ply -o knot.$format --spacing 1; done
quietly voxelize "$knot" -o knot.bvx --mode thin --resolution 48
cp grid.bvx small.bvx
cp "$root"/fixtures/waves.* .
cp "$root/fixtures/ball.xyz" "$root/fixtures/labels.npy" .
awk 'BEGIN { print ""; for (i = 0; i < 70000; i++) printf "%05.2f %04.1f %04.1f\n", i % 7, i * 3 % 11, i * 5 % 13 }' >large.xyz
! has gzip || gzip -c small.ply >small.ply.gz

# Each command that writes: its output's ending, and its words without -o.
cat >jobs <<'END'
stl convert small.ply
glb convert small.ply
vti convert grid.bvx
ply lod small.ply --levels 8 --samples 0
ply simplify small.ply --samples 0
ply hull small.ply --resolution 24
ply check small.ply --resolution 24
glb labels labels.npy
npy voxelize small.ply --resolution 20
bvx voxelize ball.xyz --spacing 0.05
vti voxelize small.ply --mode field --resolution 12
ply voxelize waves.nhdr --level 120
ply repair small.ply --resolution 16
vti fill grid.bvx
vti morph close small.ply --resolution 16 --radius 1
nrrd components grid.bvx
vtu refine small.ply --halvings 2 --base 4
bvx refine small.ply --halvings 3 --base 4
ply sections knot.csv
csl slice small.ply --spacing 1
ply boolean union small.ply small.ply --resolution 12
ply faces small.ply --resolution 12
png render small.ply --size 99x99
END

# After a failure: status 1, one line with these words, and the folder "o" as it was before.
start_folder() {
    rm -rf o
    mkdir o
}
fails() { # NAME, WORDS: what ran has set $status and err; the folder's files stand in before
    ls -A o >after
    if [ "$status" != 1 ]; then not_ok "$1" "status $status"
    elif [ "$(grep -c -v '^bitvox: warning: ' err)" != 1 ] || ! grep -q -e "$2" err; then not_ok "$1" "no single line with '$2'"
    elif ! cmp -s before after; then not_ok "$1" "the folder changed: $(tr '\n' ' ' <after)"
    else ok "$1"; fi
}

limited=no not_a_folder='Not a directory'
[ -z "$windows" ] || not_a_folder='No such file'
if limits -f 1; then limited=yes; fi
tried=
while read -r ending words; do
    tried="$tried ${words%% *}"
    name="${words%% *} .$ending"
    # shellcheck disable=SC2086
    set -- $words
    start_folder
    if device /dev/full; then
        ln -s /dev/full o/x."$ending"
        ls -A o >before
        run "$@" -o o/x."$ending" --quiet
        fails "$name to a full device" "x.$ending: cannot be written: No space left"
        holds "$name to a full device: it stays a link" test -c o/x."$ending"
        rm o/x."$ending"
    fi
    if [ $limited = yes ]; then
        echo kept >o/x."$ending"
        ls -A o >before
        (ulimit -f 1 && exec "$program" "$@" -o o/x."$ending" --quiet) >out 2>err </dev/null
        status=$?
        fails "$name beyond the limit of sizes" 'cannot be written: File too large'
        holds "$name beyond the limit of sizes: the older file stays" grep -q -x kept o/x."$ending"
    fi
    echo file >o/file
    ls -A o >before
    run "$@" -o o/file/x."$ending" --quiet
    fails "$name into a file" "cannot be written: $not_a_folder"
    run "$@" -o o/missing/x."$ending" --quiet
    fails "$name into no folder" 'cannot be written: No such file'
    rm -f o/x."$ending"
    mkdir o/x."$ending"
    ls -A o >before
    run "$@" -o o/x."$ending" --quiet
    fails "$name onto a folder" 'cannot be written: Is a directory'
done <jobs
writers=$("$program" help | awk '/^  [a-z]/ { print $1 }' | grep -v -x -e info -e compare)
for command in $writers; do
    case " $tried " in
    *" $command "*) ;;
    *) not_ok "each command that writes is tried" "$command is not" ;;
    esac
done
device /dev/full || skip 'a full device' 'there is no /dev/full'
[ $limited = yes ] || skip 'the limit of sizes' 'ulimit -f does not hold'

# Several outputs: one that fails, whichever it is, leaves all as they were.
if device /dev/full; then
    several() { # THE ONE THAT FAILS, THE OTHERS, WORDS...
        start_folder
        full=$1 others=$2
        shift 2
        ln -s /dev/full "o/$full"
        for other in $others; do echo "kept $other" >"o/$other"; done
        ls -A o >before
        run "$@" --quiet
        fails "several outputs, $full is full: $1" "$full: cannot be written"
        for other in $others; do holds "several outputs, $full is full: $other stays" grep -q -x "kept $other" "o/$other"; done
    }
    for i in 0 1 2; do
        several x_$i.ply "$(echo x_0.ply x_1.ply x_2.ply | sed "s/x_$i.ply//")" lod small.ply -o o/x_%d.ply --levels 8,6,4 --samples 0
    done
    several x.npy.json x.npy voxelize small.ply -o o/x.npy --resolution 20
    several x.csv x.ply sections knot.csv -o o/x.ply --block-model o/x.csv --block 1,1,1
fi

# ---- folders that vanish, and pipes ----

if pipes; then
    mkfifo in.ply
    await() { # the temporary file in folder $1 is there
        for i in 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20; do
            for part in "$1"/bitvox-*-0.part; do [ ! -e "$part" ] || return 0; done
            sleep 0.05
        done
    }
    for way in 'rm -rf o' 'mv o away' 'rm -rf o; mkdir o; echo new >o/new'; do
        start_folder
        rm -rf away
        echo kept >o/x.ply
        "$program" lod in.ply -o o/x.ply --levels 8 --samples 0 --quiet >out 2>err &
        child=$!
        await o
        eval "$way"
        cat small.ply >in.ply
        wait $child
        status=$?
        ls -A o 2>/dev/null >before || :
        holds "a folder that vanishes ($way): status 1 and words" \
            sh -c "test $status = 1 && test \$(wc -l <err) = 1 && grep -q 'x.ply: cannot be written: No such file' err"
        case $way in
        'rm -rf o') holds 'a folder that vanishes does not come back' test ! -e o ;;
        'mv o away') holds 'a folder that moves: the older file goes with it' grep -q -x kept away/x.ply ;;
        *) holds 'a folder that is replaced: nothing gets into it' test "$(ls -A o)" = new ;;
        esac
    done
    rm -rf away o/new


    # Every format in small pieces through a pipe: the same bytes as from a file, also of half of it, which most formats refuse.
    mkdir file pipe
    cp waves.raw file
    cp waves.raw pipe
    reads() { # FILE, WHAT HALF OF IT GIVES (1: refused, 0: it may be read), OUTPUT'S ENDING, COMMAND, OPTIONS...
        [ -e "$1" ] || return 0
        input=$1 half=$2 ending=$3 command=$4
        shift 4
        mkfifo "pipe/$input"
        for part in whole half; do
            rm -f o/*
            bytes=$(wc -c <"$input")
            [ $part = whole ] || bytes=$((bytes / 2))
            head -c "$bytes" "$input" >"file/$input"
            "$program" "$command" "file/$input" "$@" -o "o/file.$ending" --quiet >out 2>err </dev/null
            right=$?
            dd bs=61 <"file/$input" >"pipe/$input" 2>pieces &
            "$program" "$command" "pipe/$input" "$@" -o "o/pipe.$ending" --quiet >out 2>err </dev/null
            status=$?
            wait
            if [ $status != $right ]; then not_ok "$part of $input in pieces" "status $status, not $right"
            elif [ $status = 0 ] && ! cmp -s "o/file.$ending" "o/pipe.$ending"; then not_ok "$part of $input in pieces" 'other bytes'
            elif [ $part = whole ] && [ $status != 0 ]; then not_ok "$part of $input in pieces" "status $status"
            elif [ $part$half = half1 ] && [ $status != 1 ]; then not_ok "$part of $input in pieces" 'taken for a whole'
            elif [ $status = 1 ] && [ "$(wc -l <err)" != 1 ]; then not_ok "$part of $input in pieces" 'not one line of words'
            elif [ $status = 1 ] && [ -n "$(ls -A o)" ]; then not_ok "$part of $input in pieces" 'something is left'
            else ok "$part of $input in pieces"; fi
        done
        rm "pipe/$input" "file/$input"
    }
    start_folder
    for format in stl ply off ply.gz; do reads small.$format 1 glb convert; done
    reads small.obj 0 ply convert
    reads ball.xyz 0 bvx voxelize --spacing 0.2
    for format in npy binvox vox nrrd vti bvx; do reads grid.$format 1 bvx convert; done
    reads tree.bvx 1 vtu convert
    reads waves.nhdr 1 bvx voxelize --level 120
    rm pipe/waves.raw
    reads waves.raw 1 bvx voxelize --level 120 --shape 48,40,32 --sample-type u8
    for format in csv csl; do reads knot.$format 0 ply sections; done

    # A reader that leaves early.
    start_folder
    ls -A o >before
    mkfifo o/x.stl
    ls -A o >before
    head -c 10 o/x.stl >taken &
    run convert "$knot" -o o/x.stl --quiet
    wait
    fails 'a reader that leaves a pipe' 'x.stl: cannot be written: Broken pipe'
    holds 'a reader that leaves a pipe got the first bytes' test "$(wc -c <taken)" = 10
else
    skip 'vanished folders and pipes' 'there are no pipes with names'
fi
if device /dev/stdout; then
    start_folder
    ln -s /dev/stdout o/x.stl
    ls -A o >before
    { "$program" convert "$knot" -o o/x.stl --quiet 2>err; echo $? >code; } | head -c 10 >taken
    status=$(cat code)
    fails 'a reader that leaves standard output' 'x.stl: cannot be written: Broken pipe'
    "$program" convert "$knot" -o o/x.stl --quiet >&- 2>err
    status=$?
    fails 'an output on a closed standard output' 'cannot be written'
fi
if streams; then
    start_folder
    ls -A o >before
    "$program" convert - --format ply -o o/x.stl --quiet <&- >out 2>err
    status=$?
    fails 'a closed standard input' 'standard input: '
    "$program" convert - --format ply -o o/x.stl --quiet <o >out 2>err
    status=$?
    fails 'a standard input that is a folder' 'standard input: '
else
    skip 'a closed standard input' 'wine opens it'
fi

# What is done is done: a report that cannot be written is a failure, but the outputs are whole and have their names.
if device /dev/full; then
    for words in --json ''; do
        start_folder
        echo kept >o/x.stl
        # shellcheck disable=SC2086
        "$program" convert small.ply -o o/x.stl $words >/dev/full 2>err </dev/null
        status=$?
        holds "a report to a full device ($words): status 1 and words" \
            sh -c "test $status = 1 && grep -q 'standard output cannot be written' err"
        holds "a report to a full device ($words): the output is whole" cmp o/x.stl small.stl
    done
fi

# ---- calls that fail, and signals ----

if ! signals; then
    skip 'calls that fail, signals at random moments' 'python3 is missing, or the program hears no signals'
else
    ${CC:-cc} -O1 "$root/tests/tools/fail_calls.c" -o fail_calls >err 2>&1
    ./fail_calls seen write EIO 9999 0 "$program" --version >out 2>&1
    status=$?
    if [ $status = 0 ]; then
        # shellcheck disable=SC2086
        python3 "$root/tests/tools/fail_runs.py" ./fail_calls "$program" $all >lines 2>err
        status=$?
        cat lines
        passed=$((passed + $(grep -c '^ok ' lines)))
        failed=$((failed + $(grep -c '^not ok ' lines)))
        holds 'calls that fail: all were tried' test $status = 0
        [ $status = 0 ] || sed 's/^/# /' err
        # Where the system has no thread to give, an interrupt still ends what waits for a pipe.
        for way in open read write; do
            start_folder
            rm -f in.ply
            mkfifo in.ply
            echo kept >o/x.ply
            case $way in
            open) set -- in.ply -o o/x.ply --levels 8 ;;
            read) exec 9<>in.ply && set -- in.ply -o o/x.ply --levels 8 ;;
            write) mkfifo o/y_1.ply && set -- small.ply -o o/y_%d.ply --levels 8,6 ;;
            esac
            ls -A o >before
            ./fail_calls seen thread EAGAIN 1 0 "$program" lod "$@" --samples 0 --quiet >out 2>err &
            child=$!
            await o
            sleep 0.1
            process=$(ls o | sed -n 's/^bitvox-\([0-9]*\)-0.part$/\1/p')
            kill -TERM "${process:-$child}"
            wait $child
            status=$?
            ls -A o >after
            [ $way != read ] || exec 9>&-
            holds "an interrupt without threads, while it waits to $way" \
                sh -c "test $status = 130 && test \$(wc -l <err) = 1 && grep -q '^bitvox: interrupted' err && cmp before after"
        done
    else
        skip 'calls that fail' "no program is traced here: $(head -n 1 out)"
    fi
    seed=$(od -An -N4 -tu4 /dev/urandom 2>/dev/null | tr -d ' ') # another one every time, so that many runs try many moments
    python3 "$root/tests/tools/stop_runs.py" "$program" "$root/fixtures" "${seed:-1}" 42 >lines 2>&1
    status=$?
    sed 's/^/# /' lines | tail -n 3
    holds "signals at random moments (seed ${seed:-1})" test $status = 0
fi

echo "$passed passed, $failed failed$([ $skipped = 0 ] || echo ", $skipped skipped")"
[ $failed = 0 ]
