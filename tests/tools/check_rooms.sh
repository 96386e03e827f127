#!/bin/sh
# check_rooms.sh - who may use whom, by the table of docs/architecture.md (check_rooms.py), and no circle of files in the program
# (check_circles.sh).
set -eu
cd "$(dirname "$0")/../.."
python3 tests/tools/check_rooms.py
sh tests/tools/check_circles.sh
