# counting.sh - read in by the test scripts: run checks and programs, count what passed, end with one line
#     N passed, N failed[, N skipped]
passed=0
failed=0
skipped=0
: "${logs:=${BUILD:-build}/logs}"
mkdir -p "$logs"

pass() { # NAME
    passed=$((passed + 1))
    echo "ok    $1"
}

skip() { # NAME, WHY
    skipped=$((skipped + 1))
    echo "skip  $1: $2"
}

fail() { # NAME, LOG: shows the lines of the log that tell most
    failed=$((failed + 1))
    echo "FAIL  $1"
    [ -z "${2:-}" ] || show "$2"
}

show() { # LOG
    grep -v -E '^  (CC|AR|LINK) |^make.*not remade' "$1" >"$logs/shown"
    if [ "$(wc -l <"$logs/shown")" -gt 40 ]; then
        grep -E ':FAIL|^not ok|^FAIL|^#|error|ERROR|warning:|WARNING:|SUMMARY:|undefined reference' "$logs/shown" | head -n 25
        echo "... and last:"
        tail -n 12 "$logs/shown"
    else
        cat "$logs/shown"
    fi | sed 's/^/      | /'
}

log_of() { # NAME
    echo "$logs/$(printf '%s' "$1" | tr -c 'A-Za-z0-9_.' '-').log"
}

# One check by its exit status; 77 stands for skipped, with the reason in its last line.
check() { # NAME, COMMAND...
    check_name=$1
    check_log=$(log_of "$1")
    shift
    ("$@") >"$check_log" 2>&1 </dev/null
    case $? in
    0) pass "$check_name" ;;
    77) skip "$check_name" "$(tail -n 1 "$check_log")" ;;
    *) fail "$check_name" "$check_log" ;;
    esac
}

# What a log of Unity, of TAP or of a test script says: "passed failed skipped", nothing when it counts no test.
# A TAP plan that was not kept counts as failures.
counts_of() { # LOG
    awk '
        /^[0-9]+ Tests [0-9]+ Failures [0-9]+ Ignored/ { p += $1 - $3 - $5; f += $3; s += $5; n += $1 }
        /^1\.\.[0-9]+$/ { planned += substr($0, 4) }
        /^ok [0-9]+/ { tap++; if (/# SKIP/) s++; else p++ }
        /^not ok [0-9]+/ { tap++; if (/^not ok [0-9]+ # SKIP/) s++; else f++ } # cmocka calls a skipped test not ok
        /^[0-9]+ passed, [0-9]+ failed/ { p += $1; f += $3; if ($6 == "skipped") s += $5; n += $1 + $3 + $5 }
        END { if (planned > tap) f += planned - tap; if (n + tap + planned > 0) print p + 0, f + 0, s + 0 }' "$1"
}

# A program that counts its own tests. One that ends badly without a failed test, or runs none, is a failure.
count() { # NAME, COMMAND...
    count_name=$1
    count_log=$(log_of "$1")
    shift
    sh tests/tools/logged.sh "$count_log" "$allowed" "$@"
    # shellcheck disable=SC2046
    add_counts "$count_name" "$count_log" $(cat "$count_log.end")
}

# Seconds are those of the processor, which other work on the machine does not change much.
add_counts() { # NAME, LOG, EXIT STATUS, SECONDS
    add_name=$1 add_log=$2 add_status=$3 add_seconds=$4
    # shellcheck disable=SC2046
    set -- $(counts_of "$add_log")
    if [ $# = 0 ] || [ $(($1 + $2 + $3)) = 0 ]; then
        case $add_status in
        124 | 137 | 152) fail "$add_name: stopped after $add_seconds s" "$add_log" ;;
        *) fail "$add_name: ended with status $add_status and no count of tests" "$add_log" ;;
        esac
        return
    fi
    passed=$((passed + $1))
    failed=$((failed + $2))
    skipped=$((skipped + $3))
    if [ "$3" != 0 ]; then grep -E ':IGNORE|^(not )?ok .*# SKIP' "$add_log" | sed "s|^|skip  $add_name: |"; fi
    if [ "$2" != 0 ]; then
        echo "FAIL  $add_name: $2 of $(($1 + $2))"
        show "$add_log"
    elif [ "$add_status" != 0 ]; then
        fail "$add_name: all tests passed, yet it ended with status $add_status" "$add_log"
    else
        echo "ok    $add_name ($1$([ "$add_seconds" -lt 2 ] || echo ", $add_seconds s"))"
    fi
}

# A test script that reads in this file too: its lines stand among ours, its counts are added.
add_script() { # NAME, LOG, EXIT STATUS
    sed '$d' "$2"
    add_name=$1 add_log=$2 add_status=$3
    # shellcheck disable=SC2046
    set -- $(tail -n 1 "$add_log" | grep -E '^[0-9]+ passed, [0-9]+ failed' | tr -dc '0-9 ') 0
    if [ $# -lt 3 ]; then
        fail "$add_name: ended early, status $add_status"
        return
    fi
    passed=$((passed + $1))
    failed=$((failed + $2))
    skipped=$((skipped + $3))
    if [ "$2" = 0 ] && [ "$add_status" != 0 ]; then fail "$add_name: ended with status $add_status"; fi
}

# No test may hang for ever: $limit stands before a command that could.
allow() { # SECONDS of processor time
    allowed=$1
    limit="sh tests/tools/limited.sh $1"
}
allow "${TEST_SECONDS:-300}"

# Sets $spent: processor seconds of all that the script has run so far. Other work on the machine does not change them much.
count_spent() {
    times >"$logs/times"
    spent=$(awk 'NR == 2 { split($0, t, /[ms ]+/); print t[1] * 60 + t[2] + t[3] * 60 + t[4] }' "$logs/times")
}

finish() {
    echo "$passed passed, $failed failed$([ $skipped = 0 ] || echo ", $skipped skipped")"
    [ $failed = 0 ]
}
