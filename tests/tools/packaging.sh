#!/bin/sh
# packaging.sh [quick|cmake|mingw|zig|vcpkg|conan|parts] - projects that use the library. Called by `make packaging`.
#   cmake        find_package, add_subdirectory and FetchContent, each by make and by Ninja, by gcc and clang; find_package from what `make install` and
#                from what `cmake --install` put there, static and shared; pkg-config there too
#   mingw        the same ways for Windows, run by wine
#   zig          the library as one file by `zig cc`: for musl, run here; for Windows, run by wine; for macOS, linked only
#   vcpkg        the port of tests/packaging/vcpkg, its lines run with stand-ins for vcpkg's functions (vcpkg cannot be had from Debian or pip)
#   conan        the recipe of tests/packaging/conan, `conan create` without a network
#   parts        tests/tools/test_parts.sh
# Each consumer is built and run, and must print the count that the library is known to give. A row that is skipped says what it lacks.
# quick: by make install and as a subdirectory, by gcc and make; a name: those rows alone. The library is compiled some twenty times: ccache, where
# it is, makes that eight. Ends with "N passed, N failed[, N skipped]".
set -u
tier=${1:-full}
cd "$(dirname "$0")/../.." || exit 1
: "${BUILD:=build}" "${MAKE_COMMAND:=make}" "${PYTHON:=python3}"
source=$PWD
work=$BUILD/packaging
rm -rf "$work"
mkdir -p "$work/consumer"
work=$(cd "$work" && pwd) || exit 1
logs=$work/logs
. tests/tools/counting.sh
has() { command -v "$1" >/dev/null 2>&1; }

has cmake || { skip packaging "cmake is missing (Debian: cmake)"; finish; exit; }

expected=43680
cp tests/tools/consumer.c "$work/consumer/use.c"

# One project, which finds the library in the way that it is told.
cat >"$work/consumer/CMakeLists.txt" <<TEXT
cmake_minimum_required(VERSION 3.16)
project(consumer C)
if(WAY STREQUAL find_package)
    find_package(bitvox 0.1 REQUIRED)
elseif(WAY STREQUAL add_subdirectory)
    add_subdirectory("$source" bitvox)
else()
    include(FetchContent)
    FetchContent_Declare(bitvox SOURCE_DIR "$source")
    FetchContent_MakeAvailable(bitvox)
endif()
add_executable(use use.c)
target_link_libraries(use PRIVATE bitvox::bitvox)
TEXT

launcher=
if has ccache; then launcher=-DCMAKE_C_COMPILER_LAUNCHER=ccache; fi
jobs=$(getconf _NPROCESSORS_ONLN)
# Sources in batches, as users may set it, and CMake's own flags in place of make's: a quarter of the time, and the list of the sources is
# CMake's all the same.
batches= flags_of=
if [ $tier = quick ]; then batches='-DCMAKE_UNITY_BUILD=ON -DCMAKE_UNITY_BUILD_BATCH_SIZE=25' flags_of='env -u CFLAGS'; fi

# ---- CMake ----

consumer() { # NAME, RUNNER, GENERATOR, SETTINGS...
    folder=$work/$1 runner=$2 generator=$3
    shift 3
    # shellcheck disable=SC2086
    $flags_of cmake -S "$work/consumer" -B "$folder" -G "$generator" $launcher $batches "$@" || return 1
    cmake --build "$folder" --parallel "$jobs" || return 1
    for program in "$folder/use" "$folder/use.exe"; do
        if [ -f "$program" ]; then break; fi
    done
    prints_count $runner "$program"
}

prints_count() { # COMMAND...
    printed=$("$@" | tr -d '\r')
    echo "printed: $printed"
    [ "$printed" = "$expected" ]
}

# The other version of a series that may differ is not taken.
refuses_other_minor() {
    sed 's/bitvox 0\.1 REQUIRED/bitvox 0.2 REQUIRED/' "$work/consumer/CMakeLists.txt" >"$work/newer.txt"
    mkdir -p "$work/newer" && cp "$work/newer.txt" "$work/newer/CMakeLists.txt" && cp "$work/consumer/use.c" "$work/newer/"
    cmake -S "$work/newer" -B "$work/newer/build" -DWAY=find_package -DCMAKE_PREFIX_PATH="$1" >"$work/newer.log" 2>&1 && return 1
    grep -q 'version: 0\.1\.' "$work/newer.log"
}

by_cmake() { # NAME, SETTINGS...
    prefix_name=$1
    shift
    # shellcheck disable=SC2086
    cmake -S "$source" -B "$work/$prefix_name-library" $launcher -DCMAKE_INSTALL_PREFIX="$work/$prefix_name" -DCMAKE_INSTALL_LIBDIR=lib \
        -DBITVOX_PROGRAM=OFF -DCMAKE_BUILD_TYPE=None "$@" || return 1
    cmake --build "$work/$prefix_name-library" --parallel "$jobs" && cmake --install "$work/$prefix_name-library"
}

by_make() { "$MAKE_COMMAND" --no-print-directory install PREFIX="$work/by-make"; }

finds() { # COMPILER, GENERATOR, PREFIX, RUNNER, SETTINGS...
    finds_name="$1, $2: find_package, $(basename "$3")" finds_folder=$1-$2-$(basename "$3")
    case $2 in ninja) finds_by=Ninja ;; *) finds_by='Unix Makefiles' ;; esac
    finds_prefix=$3 finds_runner=$4
    shift 4
    check "$finds_name" consumer "$finds_folder" "$finds_runner" "$finds_by" -DWAY=find_package -DCMAKE_PREFIX_PATH="$finds_prefix" \
        -DCMAKE_FIND_ROOT_PATH="$finds_prefix" "$@"
}

takes_sources() { # COMPILER, GENERATOR, RUNNER, SETTINGS...
    takes_name="$1, $2" takes_folder=$1-$2 takes_runner=$3
    case $2 in ninja) takes_by=Ninja ;; *) takes_by='Unix Makefiles' ;; esac
    shift 3
    for way in add_subdirectory FetchContent; do
        [ $tier = quick ] && [ $way = FetchContent ] && continue
        check "$takes_name: $way" consumer "$takes_folder-$way" "$takes_runner" "$takes_by" -DWAY=$way "$@"
    done
}

# Ways of one compiler: three by each generator, which is nine of make and nine of Ninja for all.
all_ways() { # COMPILER, RUNNER, PREFIXES, SETTINGS...
    ways_compiler=$1 ways_runner=$2 ways_prefixes=$3
    shift 3
    for generator in make ninja; do
        if [ $generator = ninja ] && ! has ninja; then
            skip "$ways_compiler, ninja" "ninja is missing (Debian: ninja-build)"
            continue
        fi
        for prefix in $ways_prefixes; do finds "$ways_compiler" $generator "$work/$prefix" "$ways_runner" "$@"; done
        takes_sources "$ways_compiler" $generator "$ways_runner" "$@"
    done
}

# ---- pkg-config ----

by_pkg_config() { # COMPILER, PREFIX, WORD OF PKG-CONFIG
    export PKG_CONFIG_PATH="$work/$2/lib/pkgconfig"
    [ "$(pkg-config --modversion bitvox)" = "$(sed -n 's/^Version: //p' "$work/by-make/lib/pkgconfig/bitvox.pc")" ] || return 1
    # shellcheck disable=SC2046,SC2086
    "$1" -std=c99 "$work/consumer/use.c" $(pkg-config $3 --cflags --libs bitvox) -o "$work/use-pkg" || return 1
    prints_count env LD_LIBRARY_PATH="$work/$2/lib" "$work/use-pkg"
}

# ---- vcpkg ----

# The names that vcpkg's schema requires, and the version of the header.
vcpkg_describes() {
    "$PYTHON" - tests/packaging/vcpkg/bitvox/vcpkg.json "$(sed -n 's/^Version: //p' "$work/by-make/lib/pkgconfig/bitvox.pc")" <<'TEXT'
import json, re, sys
port = json.load(open(sys.argv[1]))
assert set(port) <= {"name", "version", "description", "license", "dependencies", "features", "homepage", "supports"}, port.keys()
assert re.fullmatch(r"[a-z0-9]+(-[a-z0-9]+)*", port["name"]) and port["version"] == sys.argv[2] and port["description"], port
for dependency in port["dependencies"]: assert isinstance(dependency, str) or set(dependency) <= {"name", "host", "features", "platform"}
for feature in port["features"].values(): assert set(feature) <= {"description", "dependencies", "supports"} and feature["description"]
TEXT
}

vcpkg_port() { # static or dynamic, FEATURES
    rm -rf "$work/vcpkg-build"
    cmake -DPORT_DIR="$source/tests/packaging/vcpkg/bitvox" -DWORK="$work/vcpkg-build" -DCURRENT_PACKAGES_DIR="$work/vcpkg-$1" -DFEATURES="$2" \
        -DVCPKG_LIBRARY_LINKAGE="$1" -DLAUNCHER="$launcher" -P tests/tools/vcpkg_stand_ins.cmake || return 1
    (cd "$work/vcpkg-$1" && find . ! -type d | LC_ALL=C sort) >"$work/vcpkg-$1.files"
    cat "$work/vcpkg-$1.files"
}

# What vcpkg looks for after a build: no headers and no share for debugging, CMake's files in share, no empty folder, a copyright.
vcpkg_layout() { # static or dynamic
    cd "$work/vcpkg-$1" || return 1
    [ ! -e debug/include ] && [ ! -e debug/share ] && [ ! -e lib/cmake ] && [ -z "$(find . -type d -empty)" ] || return 1
    [ -s share/bitvox/copyright ] && [ -s share/bitvox/bitvoxConfig.cmake ] && [ -s share/bitvox/usage ] && [ -s include/bitvox.h ]
}

# A project that is built for debugging takes the library that is.
vcpkg_serves() { # static or dynamic
    for kind in Release Debug; do
        consumer "vcpkg-$1-$kind" '' 'Unix Makefiles' -DWAY=find_package -DCMAKE_PREFIX_PATH="$work/vcpkg-$1" -DCMAKE_BUILD_TYPE=$kind || return 1
    done
    grep -q "vcpkg-$1/debug/lib/libbitvox" "$work/vcpkg-$1-Debug/CMakeFiles/use.dir/link.txt" &&
        ! grep -q "vcpkg-$1/debug" "$work/vcpkg-$1-Release/CMakeFiles/use.dir/link.txt"
}

# ---- Conan ----

# Conan from the path, or by pip in an environment of its own.
conan_here() {
    has conan && conan --version && return
    "$PYTHON" -m venv "$work/conan-venv" && "$work/conan-venv/bin/pip" install --quiet --disable-pip-version-check 'conan>=2.4' ||
        { echo "conan is missing and pip cannot fetch it"; exit 77; }
}

conan_creates() { # OPTIONS...
    if [ -x "$work/conan-venv/bin/conan" ]; then PATH="$work/conan-venv/bin:$PATH"; fi
    has conan || { echo "conan is missing and pip cannot fetch it"; exit 77; }
    export CONAN_HOME="$work/conan"
    [ -f "$CONAN_HOME/profiles/default" ] || conan profile detect || return 1
    conan create tests/packaging/conan --no-remote -s build_type=Debug -c tools.cmake.cmake_layout:test_folder="$work/conan-test" "$@"
}

# ---- Rows ----

rows_of_cmake() {
    check 'cmake --install' by_cmake by-cmake
    check 'cmake --install, shared' by_cmake by-cmake-shared -DBUILD_SHARED_LIBS=ON
    for compiler in gcc clang; do
        if has $compiler; then
            all_ways $compiler '' 'by-make by-cmake' -DCMAKE_C_COMPILER=$compiler
        else
            skip "$compiler, make and ninja, three ways" "$compiler is missing (Debian: $compiler)"
        fi
    done
    check 'find_package refuses another minor version' refuses_other_minor "$work/by-make"
    check 'the shared library of make install' consumer shared "env LD_LIBRARY_PATH=$work/by-make/lib" 'Unix Makefiles' \
        -DWAY=find_package -DCMAKE_PREFIX_PATH="$work/by-make" -DBUILD_SHARED_LIBS=ON
    check 'the shared library of cmake --install' consumer shared-cmake '' 'Unix Makefiles' \
        -DWAY=find_package -DCMAKE_PREFIX_PATH="$work/by-cmake-shared"

    if has pkg-config; then
        for compiler in gcc clang; do
            has $compiler || continue
            check "pkg-config, $compiler: make install, shared" by_pkg_config $compiler by-make ''
            check "pkg-config, $compiler: cmake --install, static" by_pkg_config $compiler by-cmake ''
            check "pkg-config, $compiler: cmake --install, shared" by_pkg_config $compiler by-cmake-shared ''
        done
    else
        skip pkg-config "pkg-config is missing (Debian: pkg-config)"
    fi
}

rows_of_mingw() {
    if ! has x86_64-w64-mingw32-gcc || ! has wine; then
        skip 'mingw, make and ninja, three ways, static and shared' "mingw or wine is missing (Debian: gcc-mingw-w64-x86-64 wine wine64)"
    else
        export WINEDEBUG=-all WINEPREFIX="$work/wine"
        set -- -DCMAKE_SYSTEM_NAME=Windows -DCMAKE_C_COMPILER=x86_64-w64-mingw32-gcc
        check 'cmake --install, mingw' by_cmake mingw-static "$@"
        check 'cmake --install, mingw, shared' by_cmake mingw-shared -DBUILD_SHARED_LIBS=ON "$@"
        all_ways mingw wine mingw-static "$@"
        finds mingw make "$work/mingw-shared" "env WINEPATH=$work/mingw-shared/bin wine" "$@"
    fi
}

# zig from the path, or pip's ziglang in an environment of its own. The first program for musl takes minutes: zig compiles musl itself, so what
# it has made is kept in $BUILD/zig. -O1: twice as long as -O0, and what is tried is that it links and counts right.
zig_here() {
    if has zig; then printf '#!/bin/sh\nexec zig "$@"\n' >"$work/zig"; else
        [ -x "$zig_home/venv/bin/python" ] && "$zig_home/venv/bin/python" -m ziglang version >"$work/zig.version" 2>&1 ||
            { "$PYTHON" -m venv "$zig_home/venv" && "$zig_home/venv/bin/pip" install --quiet --disable-pip-version-check ziglang; } ||
            { echo "zig is missing and pip cannot fetch ziglang"; exit 77; }
        printf '#!/bin/sh\nexec "%s" -m ziglang "$@"\n' "$zig_home/venv/bin/python" >"$work/zig"
    fi
    chmod +x "$work/zig" && "$work/zig" version
}

by_zig() { # TARGET, RUNNER; linked: is not run
    [ -x "$work/zig" ] || { echo "zig is missing and pip cannot fetch ziglang"; exit 77; }
    if [ "$2" = wine ] && ! has wine; then echo "wine is missing (Debian: wine wine64)"; exit 77; fi
    case $1 in
    *musl) system='-static -lm' ending= ;;
    *windows*) system= ending=.exe ;;
    *) system= ending= ;;
    esac
    # shellcheck disable=SC2086
    ZIG_LOCAL_CACHE_DIR="$zig_home" ZIG_GLOBAL_CACHE_DIR="$zig_home" "$work/zig" cc -target "$1" -std=c99 -O1 -ffp-contract=off -fno-sanitize=undefined \
        -DBVX_NO_CPU_DETECTION -I"$work/one" "$work/consumer/use.c" "$work/one/bitvox.c" $system -o "$work/use-$1$ending" || return 1
    [ "$2" = linked ] && return
    # shellcheck disable=SC2086
    prints_count $2 "$work/use-$1$ending"
}

rows_of_zig() {
    mkdir -p "$BUILD/zig"
    zig_home=$(cd "$BUILD/zig" && pwd)
    export WINEDEBUG=-all WINEPREFIX="$work/wine"
    check 'zig: by path or pip' zig_here
    check 'zig: the library as one file' sh src/amalgamate.sh "$work/one"
    check 'zig cc: x86_64-linux-musl, static' by_zig x86_64-linux-musl ''
    check 'zig cc: x86_64-windows-gnu, by wine' by_zig x86_64-windows-gnu wine
    check 'zig cc: aarch64-macos, linked and not run' by_zig aarch64-macos linked
}

rows_of_vcpkg() {
    check 'vcpkg: what vcpkg.json says' vcpkg_describes
    for linkage in static dynamic; do
        if [ $linkage = static ]; then features=tools; else features=core; fi
        check "vcpkg: the port with stand-ins, $linkage" vcpkg_port $linkage $features
        check "vcpkg: the layout, $linkage" vcpkg_layout $linkage
        check "vcpkg: projects, $linkage" vcpkg_serves $linkage
    done
    check 'vcpkg: its program' "$work/vcpkg-static/tools/bitvox/bitvox" --version
    skip 'vcpkg: vcpkg install' "vcpkg itself cannot be had from Debian or pip; the rows above ran the port's lines with stand-ins"
}

rows_of_conan() {
    check 'Conan: conan by path or pip' conan_here
    check 'Conan: conan create, static' conan_creates
    check 'Conan: conan create, shared' conan_creates -o 'bitvox/*:shared=True'
}

rows_of_parts() {
    allow 1800
    count 'parts' sh tests/tools/test_parts.sh
}

check 'make install' by_make
case $tier in
quick)
    finds gcc make "$work/by-make" '' -DCMAKE_C_COMPILER=gcc
    takes_sources gcc make '' -DCMAKE_C_COMPILER=gcc
    check 'find_package refuses another minor version' refuses_other_minor "$work/by-make"
    ;;
full) for rows in cmake mingw zig vcpkg conan parts; do rows_of_$rows; done ;;
cmake | mingw | zig | vcpkg | conan | parts) rows_of_"$tier" ;;
*)
    echo "packaging: no rows named $tier" >&2
    exit 2
    ;;
esac
finish
