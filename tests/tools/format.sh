#!/bin/sh
# format.sh write|check - all C sources by the top level's .clang-format: write them so, or name those that look otherwise.
# Another version of clang-format breaks lines at other places, so only the one that the sources are written by will do.
set -u
version=14

tool=
for name in "clang-format-$version" clang-format; do
    if command -v "$name" >/dev/null 2>&1 && "$name" --version | grep -q "version $version\\."; then
        tool=$name
        break
    fi
done
if [ -z "$tool" ]; then
    echo "clang-format $version is missing (Debian: clang-format-$version)"
    exit 77
fi

# What a generator prints looks as the generator has it.
sources=$(find src include tests bindings/js/src -name '*.[ch]' ! -path src/surface/tables.h ! -path tests/tools/cell_tables.h | LC_ALL=C sort)
case ${1:-} in
write) for f in $sources; do echo "$f"; done | xargs "$tool" -i ;;
check)
    for f in $sources; do echo "$f"; done | xargs "$tool" --dry-run -Werror 2>&1 |
        sed -n 's/^\([^:]*:[0-9]*\):.*error: code should be clang-formatted.*/\1: make format writes this line otherwise/p' |
        sort -u -t: -k1,1 >"${TMPDIR:-/tmp}/format.$$"
    head -n 20 "${TMPDIR:-/tmp}/format.$$"
    [ ! -s "${TMPDIR:-/tmp}/format.$$" ]
    status=$?
    rm -f "${TMPDIR:-/tmp}/format.$$"
    exit $status
    ;;
*)
    echo "usage: format.sh write|check"
    exit 2
    ;;
esac
