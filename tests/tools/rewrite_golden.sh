#!/bin/sh
# rewrite_golden.sh PROGRAM BUILD - recompute fixtures/golden/, the list of symbols and the struct offsets, and show what changed.
# A change of golden values is a deliberate act: say in the commit why.
set -eu
program=$1
build=$2
before=$build/golden-before
rm -rf "$before"
mkdir -p "$before" fixtures/golden
cp fixtures/golden/*.txt tests/golden/*.txt "$before" 2>/dev/null || true
"$program" --write
sh tests/tools/list_symbols.sh "$build/libbitvox.so" >tests/golden/symbols.txt
sh tests/tools/struct_offsets.sh "${CC:-cc}" >tests/golden/offsets.txt
offsets_there() { # MACHINE, RUNNER, COMPILER: where they are here
    command -v "$3" >/dev/null 2>&1 || return 0
    [ -z "$2" ] || command -v "$2" >/dev/null 2>&1 || return 0
    RUNNER=$2 sh tests/tools/struct_offsets.sh "$3" -static >"tests/golden/offsets_$1.txt"
}
offsets_there i686 qemu-i386 i686-linux-gnu-gcc
offsets_there armhf qemu-arm arm-linux-gnueabihf-gcc
changed=0
for f in fixtures/golden/*.txt tests/golden/*.txt; do
    old=$before/$(basename "$f")
    [ -f "$old" ] || old=/dev/null
    diff -u "$old" "$f" || changed=1
done
if [ $changed = 0 ]; then echo "golden: nothing changed"; fi
