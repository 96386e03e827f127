# program_checks.sh - read in by the scripts in tests/program, in the repository's root: the program, a folder of its own to work in,
# and checks that count. PROGRAM is the script's first argument, what BITVOX names, or build/bitvox. A check prints "ok NAME" or
# "not ok NAME"; a script ends with the line that `counts` prints. SYSTEM=windows: the program is one for Windows, run by wine.
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
: >out
: >err
: >before
: >after

ok() { passed=$((passed + 1)); echo "ok $1"; }
not_ok() { # NAME, WHY
    failed=$((failed + 1))
    echo "not ok $1"
    echo "# $2"
    sed 's/^/#   /' err | head -n 5
}
counts() {
    echo "$passed passed, $failed failed, $skipped skipped"
    [ $failed = 0 ]
}
skip() { skipped=$((skipped + 1)); echo "ok $1 # SKIP $2"; }
has() { command -v "$1" >/dev/null 2>&1; }

# What a program for Windows meets under wine in another way, or not at all. Checks of these are skipped there and say so.
if [ "${SYSTEM:-}" = windows ]; then windows=yes; else windows=; fi
pipes() { [ -z "$windows" ] && has mkfifo; }              # pipes with names
device() { [ -z "$windows" ] && [ -e "$1" ]; }            # /dev/full, /dev/stdout
links() { [ -z "$windows" ]; }                            # symbolic links are followed, modes are kept
streams() { [ -z "$windows" ]; }                          # standard streams that are closed, a reader that leaves
signals() { [ -z "$windows" ] && has python3; }           # sent by kill, and calls that fail by ptrace
limits() { [ -z "$windows" ] && (ulimit "$@") 2>/dev/null; } # by ulimit, which holds for wine and not for what it runs

run() { # ARGUMENTS...: sets $status; out and err hold what was said
    "$program" "$@" >out 2>err </dev/null
    status=$?
}

result() { # NAME, 0 OR 1
    if [ "$2" = 0 ]; then ok "$1"; else not_ok "$1" "status $status"; fi
}

holds() { # NAME, COMMAND...: the command succeeds
    holds_name=$1
    shift
    if "$@" >/dev/null 2>&1; then ok "$holds_name"; else not_ok "$holds_name" "failed: $*"; fi
}

works() { # NAME, ARGUMENTS...: status 0 and no word on standard error
    works_name=$1
    shift
    run "$@"
    if [ $status = 0 ] && [ ! -s err ]; then ok "$works_name"; else not_ok "$works_name" "status $status"; fi
}

gives() { # NAME, STATUS, WORDS (in out or err), ARGUMENTS...
    gives_name=$1 gives_status=$2 gives_words=$3
    shift 3
    run "$@"
    if [ "$status" != "$gives_status" ]; then not_ok "$gives_name" "exit status $status, not $gives_status"
    elif ! cat out err | grep -q -e "$gives_words"; then not_ok "$gives_name" "nothing says '$gives_words'"
    else ok "$gives_name"; fi
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

slanted_rod() { # PLACE: an .obj of twelve sides, 1/32 thick, moved by PLACE along y
    awk -v place="$1" 'BEGIN {
        for (z = 0; z < 2; z++) for (k = 0; k < 12; k++) {
            x = cos(k * 0.5235988) / 64; y = sin(k * 0.5235988) / 64
            printf "v %.5f %.5f %.5f\n", 0.8 * x + 0.6 * z, 0.28 * x * z + y + 0.3 * z + place, 0.75 * z - 0.64 * x
        }
        for (k = 0; k < 12; k++) {
            a = k + 1; b = (k + 1) % 12 + 1
            print "f", a, b, a + 12 "\nf", b, b + 12, a + 12
            if (k > 0 && k < 11) print "f", 1, b, a "\nf", 13, a + 12, b + 12
        }
    }'
}
