#!/bin/sh
# test_install.sh - make install as a packager and as a user meet it: files, pkg-config, a program built against the
# installed static and shared library, uninstall.
set -u
cd "$(dirname "$0")/../.." || exit 1
: "${BUILD:=build}" "${CC:=cc}" "${MAKE_COMMAND:=make}"
work=$BUILD/install-test
rm -rf "$work"
mkdir -p "$work"
work=$(cd "$work" && pwd) || exit 1
logs=$work/logs
. tests/tools/counting.sh

mk() { "$MAKE_COMMAND" --no-print-directory "$@"; }

cp tests/tools/consumer.c "$work/use.c"

# What DESTDIR holds is what a package holds: nothing beside it is written, nothing in it names DESTDIR.
stages_files() {
    mk install DESTDIR="$work/stage" PREFIX=/usr LIBDIR=/usr/lib/x86_64-any || return 1
    (cd "$work/stage" && find . ! -type d | LC_ALL=C sort) >"$work/files"
    version=$(sed -n 's/^Version: //p' "$work/stage/usr/lib/x86_64-any/pkgconfig/bitvox.pc")
    cat >"$work/expected" <<END
./usr/bin/bitvox
./usr/include/bitvox.h
./usr/include/bitvox_io.h
./usr/lib/x86_64-any/cmake/bitvox/bitvoxConfig.cmake
./usr/lib/x86_64-any/cmake/bitvox/bitvoxConfigVersion.cmake
./usr/lib/x86_64-any/libbitvox.a
./usr/lib/x86_64-any/libbitvox.so
./usr/lib/x86_64-any/libbitvox.so.${version%.*}
./usr/lib/x86_64-any/libbitvox.so.$version
./usr/lib/x86_64-any/pkgconfig/bitvox.pc
./usr/share/bash-completion/completions/bitvox
./usr/share/man/man1/bitvox.1
END
    diff -u "$work/expected" "$work/files" || return 1
    ! grep -r -l "$work" "$work/stage/usr/lib/x86_64-any/pkgconfig" "$work/stage/usr/share"
}

uninstalls() {
    mk uninstall DESTDIR="$work/stage" PREFIX=/usr LIBDIR=/usr/lib/x86_64-any || return 1
    [ -z "$(find "$work/stage" ! -type d)" ]
}

pkg() { PKG_CONFIG_PATH=$1/lib/pkgconfig pkg-config "$2" "$3" bitvox; }

builds_shared() {
    command -v pkg-config >/dev/null 2>&1 || { echo "pkg-config is missing" && exit 77; }
    mk install PREFIX="$work/shared" || return 1
    # shellcheck disable=SC2046
    $CC -std=c99 "$work/use.c" $(pkg "$work/shared" --cflags --libs) -o "$work/use-shared" || return 1
    [ "$(LD_LIBRARY_PATH=$work/shared/lib "$work/use-shared")" = "$expected" ] || return 1
    LD_LIBRARY_PATH=$work/shared/lib ldd "$work/use-shared" | grep -q 'libbitvox\.so\.0\.'
}

# Only the archive is there, and only the flags of --static: what a program needs beside it must be among them.
builds_static() { # MAKE SETTINGS...
    command -v pkg-config >/dev/null 2>&1 || { echo "pkg-config is missing" && exit 77; }
    rm -rf "$work/static"
    mk install PREFIX="$work/static" "$@" || return 1
    rm -f "$work/static"/lib/*.so*
    # shellcheck disable=SC2046
    $CC -std=c99 "$work/use.c" $(PKG_CONFIG_PATH=$work/static/lib/pkgconfig pkg-config --static --cflags --libs bitvox) \
        -o "$work/use-static" || return 1
    [ "$("$work/use-static")" = "$expected" ]
}

static_without_threads() {
    builds_static THREADS=0 ZLIB=0 CFLAGS=-O0 UNITS=16 BUILD="$work/plain" || return 1
    ! grep -q -e openmp -e gomp -e pthread "$work/static/lib/pkgconfig/bitvox.pc"
}

manual_reads() {
    command -v man >/dev/null 2>&1 || { echo "man is missing" && exit 77; }
    LC_ALL=C.UTF-8 MANROFFSEQ='' man --warnings -l "$work/shared/share/man/man1/bitvox.1" >"$work/manual" 2>"$work/warnings" || return 1
    [ ! -s "$work/warnings" ] && grep -q 'EXIT STATUS' "$work/manual"
}

expected=43680
check 'install stages exactly its files' stages_files
check 'uninstall removes them all' uninstalls
check 'a program against the shared library' builds_shared
check 'a program against the static library' builds_static
check 'a program against it without threads' static_without_threads
check 'the man page reads without warnings' manual_reads
finish
