#!/bin/sh
# make_units.sh FOLDER N SOURCES... - write N sources unit_N.c in FOLDER that include the SOURCES of src/, in order, and print their names.
# A unit that would not change is left alone. Called by the Makefile where UNITS is set; file names and statics are unique over src/.
set -eu
folder=$1 units=$2
shift 2
mkdir -p "$folder"
made=$folder/units-$$
mkdir "$made"
printf '%s\n' "$@" | awk -v folder="$made" -v units="$units" -v total=$# '
    { sub(/^src\//, ""); printf "#include \"%s\"\n", $0 > sprintf("%s/unit_%02d.c", folder, (NR - 1) * units / total) }'
for unit in "$made"/*.c; do
    kept=$folder/$(basename "$unit")
    cmp -s "$unit" "$kept" || cp "$unit" "$kept"
    echo "$kept"
done
rm -rf "$made"
