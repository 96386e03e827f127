#!/bin/sh
# debian.sh - Debian packages from tests/packaging/debian, as the proof that a distribution can take bitvox: dpkg-buildpackage, lintian
# without a word, a program against what the packages hold. The .deb files stay in $BUILD/debian. Called by `make deb`.
# Ends with "N passed, N failed[, N skipped]".
set -u
cd "$(dirname "$0")/../.." || exit 1
: "${BUILD:=build}" "${CC:=cc}"
sources=$PWD
work=$BUILD/debian
rm -rf "$work"
mkdir -p "$work"
work=$(cd "$work" && pwd) || exit 1
logs=$work/logs
. tests/tools/counting.sh

for tool in dpkg-buildpackage dh lintian; do
    command -v $tool >/dev/null 2>&1 || { skip debian "$tool is missing (Debian: dpkg-dev debhelper lintian; make deps-proof)"; finish; exit; }
done
number() { sed -n "s/^#define BVX_VERSION_$1 //p" include/bitvox.h; }
version=$(number MAJOR).$(number MINOR).$(number PATCH)
tree=$work/bitvox-$version

names_the_version() { grep "^bitvox ($version-1) " tests/packaging/debian/changelog | head -n 1 | grep . ; }

# What a release would hold: the files under version control where that is here, else all but what was built.
source_tree() {
    mkdir -p "$tree" || return 1
    if git rev-parse --git-dir >/dev/null 2>&1; then
        git ls-files -z --cached --others --exclude-standard | xargs -0 tar -cf - --ignore-failed-read | tar -xf - -C "$tree"
    else
        tar -cf - --exclude=./build --exclude="./${BUILD#./}" . | tar -xf - -C "$tree"
    fi
    tar -czf "$work/bitvox_$version.orig.tar.gz" -C "$work" "bitvox-$version" && cp -r tests/packaging/debian "$tree/debian"
}

packages() {
    unset MAKEFLAGS MFLAGS MAKELEVEL MAKEOVERRIDES CC CFLAGS CPPFLAGS LDFLAGS BUILD PREFIX LIBDIR DESTDIR
    (cd "$tree" && DEB_BUILD_OPTIONS=noautodbgsym dpkg-buildpackage -us -uc)
}

clean_for_lintian() {
    lintian --allow-root --fail-on error,warning,info "$work"/bitvox_"$version"-1_*.changes >"$work/lintian.txt" 2>&1
    status=$?
    cat "$work/lintian.txt"
    [ $status = 0 ] && ! grep -E '^[EWI]: ' "$work/lintian.txt"
}

files() { # PACKAGE: its files, without documentation and folders
    dpkg-deb -c "$work/$1"_*.deb | awk '$1 !~ /^d/ { print $6 }' | grep -v '/share/doc/\|/lintian/' >"$work/$1.files"
}

hold_what_they_should() {
    for p in libbitvox0.1 libbitvox-dev bitvox; do files $p || return 1; done
    cat "$work"/*.files
    grep -q "libbitvox\.so\.$version$" "$work/libbitvox0.1.files" && grep -q 'libbitvox\.a$' "$work/libbitvox-dev.files" &&
        grep -q '/usr/bin/bitvox$' "$work/bitvox.files" && grep -q 'man1/bitvox\.1\.gz$' "$work/bitvox.files" &&
        [ "$(cat "$work"/*.files | wc -l)" = 11 ]
}

# Unpacked beside one another, they are a library that a program finds, and a program.
serve_a_program() {
    for p in "$work"/*.deb; do dpkg-deb -x "$p" "$work/root" || return 1; done
    libraries=$(dirname "$(find "$work/root" -name 'libbitvox.so.*' | head -n 1)")
    $CC -std=c99 -I"$work/root/usr/include" tests/tools/consumer.c -L"$libraries" -lbitvox -o "$work/use" &&
        [ "$(LD_LIBRARY_PATH=$libraries "$work/use")" = 43680 ] && "$work/root/usr/bin/bitvox" info "$sources/fixtures/knot.ply"
}

check 'debian: the changelog names the version of the header' names_the_version
check 'debian: source tree' source_tree
check 'debian: dpkg-buildpackage, with the golden values' packages
check 'debian: lintian is silent' clean_for_lintian
check 'debian: what the packages hold' hold_what_they_should
check 'debian: a program against them' serve_a_program
echo "packages: $(ls "$work"/*.deb 2>/dev/null | sed "s|^$work/||" | tr '\n' ' ') in $work"
finish
