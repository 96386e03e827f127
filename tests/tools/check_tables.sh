#!/bin/sh
# check_tables.sh - src/surface/tables.h and tests/tools/cell_tables.h are, byte for byte, what src/surface/tables.py
# prints. Run from the repository root; ends with 77 when it is skipped.
set -eu
python=${PYTHON:-python3}
if ! "$python" -c 'import sys; sys.exit(sys.version_info < (3, 6))' 2>/dev/null; then
    echo "check_tables: skipped, no Python 3.6 or later as '$python'"
    exit 77
fi
made=$(mktemp)
trap 'rm -f "$made"' EXIT
trap 'exit 130' INT TERM
# The file is what was printed.
held() {
    cmp -s "$made" "$1" && return
    echo "check_tables: $1 is not what src/surface/tables.py prints; first differences:" >&2
    diff "$made" "$1" | head -n 10 >&2
    exit 1
}
"$python" src/surface/tables.py > "$made"
held src/surface/tables.h
"$python" src/surface/tables.py whole > "$made"
held tests/tools/cell_tables.h
echo "check_tables: tables.h and cell_tables.h are what tables.py prints"
