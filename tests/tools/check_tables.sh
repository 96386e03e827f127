#!/bin/sh
# check_tables.sh - src/surface/tables.h is, byte for byte, what src/surface/tables.py prints. Run from the repository
# root; ends with 77 when it is skipped.
set -eu
python=${PYTHON:-python3}
if ! "$python" -c 'import sys; sys.exit(sys.version_info < (3, 6))' 2>/dev/null; then
    echo "check_tables: skipped, no Python 3.6 or later as '$python'"
    exit 77
fi
made=$(mktemp)
trap 'rm -f "$made"' EXIT
trap 'exit 130' INT TERM
"$python" src/surface/tables.py > "$made"
if ! cmp -s "$made" src/surface/tables.h; then
    echo "check_tables: src/surface/tables.h is not what src/surface/tables.py prints; first differences:" >&2
    diff "$made" src/surface/tables.h | head -n 10 >&2
    exit 1
fi
echo "check_tables: tables.h is what tables.py prints"
