#!/bin/sh
# rewrite_golden.sh PROGRAM BUILD - recompute fixtures/golden/ and the list of symbols, and show what changed.
# A change of golden values is a deliberate act: say in the commit why.
set -eu
program=$1
build=$2
before=$build/golden-before
rm -rf "$before"
mkdir -p "$before" fixtures/golden
cp fixtures/golden/*.txt tests/golden/symbols.txt "$before" 2>/dev/null || true
"$program" --write
sh tests/tools/list_symbols.sh "$build/libbitvox.so" >tests/golden/symbols.txt
changed=0
for f in fixtures/golden/*.txt tests/golden/symbols.txt; do
    old=$before/$(basename "$f")
    [ -f "$old" ] || old=/dev/null
    diff -u "$old" "$f" || changed=1
done
if [ $changed = 0 ]; then echo "golden: nothing changed"; fi
