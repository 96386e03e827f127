#!/bin/sh
# packaging.sh [quick] - projects that use the library through CMake: from what `make install` and `cmake --install` put there, as a
# subdirectory, and by FetchContent; by gcc with make, clang with Ninja and, under wine, mingw.
# Called by `make packaging`. Each consumer is built and run, and must print the count that the library is known to give.
# quick: by make install and as a subdirectory, without mingw. Ends with "N passed, N failed[, N skipped]".
set -u
tier=${1:-full}
cd "$(dirname "$0")/../.." || exit 1
: "${BUILD:=build}" "${MAKE_COMMAND:=make}"
source=$PWD
work=$BUILD/packaging
rm -rf "$work"
mkdir -p "$work/consumer"
work=$(cd "$work" && pwd) || exit 1
logs=$work/logs
. tests/tools/counting.sh

command -v cmake >/dev/null 2>&1 || { skip packaging "cmake is missing (Debian: cmake)"; finish; exit; }

expected=43680
cp tests/tools/consumer.c "$work/consumer/use.c"

# One project, which finds the library in the way that it is told.
cat >"$work/consumer/CMakeLists.txt" <<END
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
END

launcher=
if command -v ccache >/dev/null 2>&1; then launcher=-DCMAKE_C_COMPILER_LAUNCHER=ccache; fi

consumer() { # NAME, RUNNER, GENERATOR, SETTINGS...
    folder=$work/$1 runner=$2 generator=$3
    shift 3
    # shellcheck disable=SC2086
    cmake -S "$work/consumer" -B "$folder" -G "$generator" $launcher "$@" || return 1
    cmake --build "$folder" --parallel "$(getconf _NPROCESSORS_ONLN)" || return 1
    for program in "$folder/use" "$folder/use.exe"; do
        if [ -f "$program" ]; then break; fi
    done
    [ "$($runner "$program" | tr -d '\r')" = "$expected" ]
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
    cmake -S "$source" -B "$work/$prefix_name-library" $launcher -DCMAKE_INSTALL_PREFIX="$work/$prefix_name" "$@" || return 1
    cmake --build "$work/$prefix_name-library" --parallel "$(getconf _NPROCESSORS_ONLN)" && cmake --install "$work/$prefix_name-library"
}

by_make() { "$MAKE_COMMAND" --no-print-directory install PREFIX="$work/by-make"; }

all_ways() { # NAME, RUNNER, GENERATOR, PREFIX, SETTINGS...
    name=$1 runner=$2 generator=$3 prefix=$4
    shift 4
    check "$name: find_package" consumer "$name-find" "$runner" "$generator" -DWAY=find_package -DCMAKE_PREFIX_PATH="$prefix" \
        -DCMAKE_FIND_ROOT_PATH="$prefix" "$@"
    check "$name: add_subdirectory" consumer "$name-subdirectory" "$runner" "$generator" -DWAY=add_subdirectory "$@"
    [ "$tier" = quick ] || check "$name: FetchContent" consumer "$name-fetch" "$runner" "$generator" -DWAY=FetchContent "$@"
}

check 'make install' by_make
all_ways gcc '' 'Unix Makefiles' "$work/by-make" -DCMAKE_C_COMPILER=gcc
check 'find_package refuses another minor version' refuses_other_minor "$work/by-make"
check 'the shared library of make install' consumer shared "env LD_LIBRARY_PATH=$work/by-make/lib" 'Unix Makefiles' \
    -DWAY=find_package -DCMAKE_PREFIX_PATH="$work/by-make" -DBUILD_SHARED_LIBS=ON

if [ "$tier" = quick ]; then
    finish
    exit
fi

if command -v clang >/dev/null 2>&1 && command -v ninja >/dev/null 2>&1; then
    check 'cmake --install, shared' by_cmake clang-prefix -G Ninja -DCMAKE_C_COMPILER=clang -DBUILD_SHARED_LIBS=ON
    all_ways clang '' Ninja "$work/clang-prefix" -DCMAKE_C_COMPILER=clang
else
    skip clang "clang or ninja is missing (Debian: clang ninja-build)"
fi

if command -v x86_64-w64-mingw32-gcc >/dev/null 2>&1 && command -v wine >/dev/null 2>&1; then
    export WINEDEBUG=-all WINEPREFIX="$work/wine"
    set -- -DCMAKE_SYSTEM_NAME=Windows -DCMAKE_C_COMPILER=x86_64-w64-mingw32-gcc
    check 'cmake --install, mingw' by_cmake mingw-prefix -DBITVOX_PROGRAM=OFF "$@"
    all_ways mingw wine 'Unix Makefiles' "$work/mingw-prefix" "$@"
else
    skip mingw "mingw or wine is missing (Debian: gcc-mingw-w64-x86-64 wine)"
fi
finish
