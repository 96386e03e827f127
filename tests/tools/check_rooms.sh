#!/bin/sh
# check_rooms.sh - who may use whom: the table "Rooms" of docs/architecture.md is read, and each #include of another room in src/ held to it.
# A row may name rooms of rows before it only, so there is no circle. A room without a row fails, and a permission that nothing uses.
# The program's rooms go up like a stair: each header includes that of the room below, and no circle of files is left (check_circles.sh).
set -eu
cd "$(dirname "$0")/../.."

grep -Hno '#include "[a-z_]*/' src/*/*.c src/*/*.h | sed 's|^src/\([a-z_]*\)/\([^:]*\):\([0-9]*\):#include "\([a-z_]*\)/|\1 \4 src/\1/\2:\3|' | awk '
    NR == FNR {
        if (/^## /) table = ($2 == "Rooms")
        if (!table || !/^\| `/) next
        split($0, column, "|")
        room = column[2]
        gsub(/[` ]/, "", room)
        count = split(column[4], used, " ")
        for (i = 1; i <= count; i++) {
            if (!(used[i] in seen)) { print "docs/architecture.md: " room " uses " used[i] ", which is no row before it"; bad = 1 }
            may[room, used[i]] = 1
        }
        seen[room] = 1
        rooms++
        next
    }
    !($1 in seen) { print $3 ": the room " $1 " is not in docs/architecture.md"; bad = 1; next }
    $1 != $2 && ($1, $2) in may { met[$1, $2] = 1 }
    $1 != $2 && !(($1, $2) in may) { print $3 ": " $1 " may not use " $2 " (docs/architecture.md)"; bad = 1 }
    END {
        for (pair in may) {
            split(pair, part, SUBSEP)
            if (!(pair in met)) { print "docs/architecture.md: " part[1] " has no need of " part[2]; bad = 1 }
        }
        if (rooms < 5) { print "docs/architecture.md: no table of rooms"; bad = 1 }
        exit bad
    }' docs/architecture.md -

sh tests/tools/check_circles.sh
