#!/bin/sh
# empty_places.sh [WAY...] - each way of getting bitvox, in one or two commands, where there is nothing of it: a Debian of its own for each, with
# a compiler, make, CMake and Python, made once by debootstrap and laid under an empty folder (overlay), and the files of the last commit.
#     demo make install cmake find_package add_subdirectory FetchContent amalgamation pip conan npm deb
# Ends with a table of times and "N passed, N failed[, N skipped]". Needs root, debootstrap and mounts; what is missing is skipped and said.
# npm and deb take what `make js` and `make deb` put into $BUILD, node and npm are those of this machine.
#     CFLAGS=-O1    the library is compiled so, where time is short
#     ROOT=FOLDER   where the Debian is kept [$BUILD/empty/root]
set -u
cd "$(dirname "$0")/../.." || exit 1
: "${BUILD:=build}" "${SUITE:=bookworm}"
export BUILD
work=$BUILD/empty
mkdir -p "$work"
work=$(cd "$work" && pwd)
logs=$work/logs
. tests/tools/counting.sh
: "${ROOT:=$work/root}"
table=$work/times.md

missing() { skip 'empty places' "$1"; finish; exit; }
[ "$(id -u)" = 0 ] || missing 'a root of its own needs root'
if [ ! -x "$ROOT/usr/bin/gcc" ]; then
    command -v debootstrap >/dev/null 2>&1 || missing 'debootstrap is missing (Debian: debootstrap)'
    debootstrap --variant=minbase --include=gcc,libc6-dev,make,cmake,pkg-config,python3-venv,python3-dev,ca-certificates "$SUITE" "$ROOT" \
        >"$work/debootstrap.log" 2>&1 || missing "debootstrap failed, see $work/debootstrap.log"
fi

mkdir -p "$work/consumer"
cp tests/tools/consumer.c "$work/consumer/use.c"
cat >"$work/consumer/CMakeLists.txt" <<'TEXT'
cmake_minimum_required(VERSION 3.16)
project(consumer C)
if(WAY STREQUAL find_package)
    find_package(bitvox 0.1 REQUIRED)
elseif(WAY STREQUAL add_subdirectory)
    add_subdirectory(/bitvox bitvox)
else()
    include(FetchContent)
    FetchContent_Declare(bitvox SOURCE_DIR /bitvox)
    FetchContent_MakeAvailable(bitvox)
endif()
add_executable(use use.c)
target_link_libraries(use PRIVATE bitvox::bitvox)
TEXT

place=$work/place
leave() {
    for inside in proc dev; do umount "$place/$inside" 2>/dev/null; done
    umount "$place" 2>/dev/null
    rm -rf "$place" "$work/upper" "$work/aside"
}
trap leave EXIT
trap 'exit 130' INT TERM

# An empty Debian with the sources of the last commit in /bitvox and a project that uses the library in /game.
enter() {
    leave
    mkdir -p "$place" "$work/upper" "$work/aside"
    mount -t overlay overlay -o "lowerdir=$ROOT,upperdir=$work/upper,workdir=$work/aside" "$place" || { echo 'no overlay can be mounted here'; exit 77; }
    mount -t proc proc "$place/proc" && mount --bind /dev "$place/dev" || { echo '/proc and /dev cannot be mounted here'; exit 77; }
    for file in /etc/resolv.conf /etc/hosts /etc/pip.conf; do if [ -f $file ]; then cp -L $file "$place$file"; fi; done
    if [ -d /etc/ssl/certs ]; then mkdir -p "$place/etc/ssl/certs" && cp -L /etc/ssl/certs/ca-certificates.crt "$place/etc/ssl/certs/"; fi
    mkdir -p "$place/bitvox" "$place/game"
    git archive HEAD | tar -x -C "$place/bitvox"
    cp "$work"/consumer/* "$place/game/"
}

inside() { # COMMANDS, in /game
    env -i HOME=/root PATH=/usr/local/bin:/usr/local/sbin:/usr/bin:/usr/sbin:/bin:/sbin LC_ALL=C.UTF-8 ${CFLAGS:+CFLAGS="$CFLAGS"} "$(command -v chroot)" "$place" /bin/sh -c "set -e; cd /game; $1"
}

# The commands are those of the README, with the sources in /bitvox; the last one shows that it works.
try() { # COMMANDS, WHAT MUST BE PRINTED LAST, COMMANDS THAT SHOW IT
    inside "command -v bitvox || test -e /usr/local/include/bitvox.h" && { echo 'the place is not empty'; return 1; }
    begin=$(date +%s)
    inside "$1" || return 1
    echo $(($(date +%s) - begin)) >"$work/seconds"
    inside "$3" >"$work/printed" 2>&1
    cat "$work/printed"
    [ "$(tail -n 1 "$work/printed")" = "$2" ]
}

built() { # FILES...
    for file in "$@"; do [ -e "$file" ] || { echo "${file##*/} was not made: make js, make deb"; exit 77; }; done
}

run_way() { # WAY
    enter
    rm -f "$work/seconds"
    case $1 in
    demo) try 'make -C /bitvox demo' 5 'ls /bitvox/build/demo | wc -l' ;;
    make) try 'make -C /bitvox install && cc use.c -lbitvox -Wl,-rpath,/usr/local/lib -o use' 43680 'bitvox --version && ./use' ;;
    pkg-config) try 'make -C /bitvox install && cc use.c $(pkg-config --cflags --libs bitvox) -o use && ldconfig' 43680 ./use ;;
    find_package) try 'make -C /bitvox install && cmake -DWAY=find_package -B b && cmake --build b' 43680 b/use ;;
    cmake) try 'cmake -S /bitvox -B /b && cmake --build /b --parallel && cmake --install /b && cmake -DWAY=find_package -B b && cmake --build b' 43680 b/use ;;
    add_subdirectory | FetchContent) try "cmake -DWAY=$1 -B b && cmake --build b --parallel" 43680 b/use ;;
    amalgamation) try 'make -C /bitvox amalgamation && cc ${CFLAGS:--O2} use.c /bitvox/build/bitvox.c -I/bitvox/build -ffp-contract=off -pthread -lm -o use' 43680 ./use ;;
    pip) try 'python3 -m venv v && v/bin/pip install --quiet /bitvox/bindings/python' 43680 \
        'v/bin/python -c "import bitvox; v = [[0,0,0],[1,0,0],[0,1,0],[0,0,1]]; f = [[0,2,1],[0,1,3],[1,2,3],[2,0,3]]; print(bitvox.voxelize((v, f), resolution=64).count)"' ;;
    conan) try 'python3 -m venv v && v/bin/pip install --quiet conan && PATH=/game/v/bin:$PATH && conan profile detect && conan create /bitvox/tests/packaging/conan --no-remote' \
        yes 'v/bin/conan list "bitvox/*" 2>&1 | grep -q bitvox/0.1.0 && echo yes' ;;
    npm)
        built "$BUILD/js/package/bitvox.js"
        command -v npm >/dev/null 2>&1 || { echo 'npm is missing'; exit 77; }
        modules=$(cd "$(dirname "$(readlink -f "$(command -v npm)")")/.." && pwd)
        cp -rL "$BUILD/js/package" "$place/package" && cp -L "$(command -v node)" "$place/usr/local/bin/" && cp -r "$modules" "$place/npm"
        sed -n '/^```js$/,/^```$/p' bindings/js/README.md | sed '/^```/d' | sed '/console.log.*closed/q' >"$place/game/readme.mjs"
        try 'node /npm/bin/npm-cli.js install --silent /package' true 'node readme.mjs'
        ;;
    deb)
        built "$BUILD/debian"
        cp "$BUILD"/debian/*.deb "$place/game/" 2>/dev/null || { echo 'no Debian package was made: make deb'; exit 77; }
        try 'dpkg -i ./*.deb && cc use.c -lbitvox -o use' 43680 'bitvox --version && ./use'
        ;;
    *)
        echo "no way is named $1"
        return 1
        ;;
    esac
}

printf '| way | seconds |\n|---|--:|\n' >"$table"
# shellcheck disable=SC2048
for way in ${*:-demo make pkg-config find_package cmake add_subdirectory FetchContent amalgamation pip conan npm deb}; do
    rm -f "$work/seconds"
    check "empty place: $way" run_way "$way"
    [ ! -s "$work/seconds" ] || printf '| %s | %s |\n' "$way" "$(cat "$work/seconds")" >>"$table"
done
printf 'load: %s\n' "$(cut -d ' ' -f 1-3 /proc/loadavg)" >>"$table"
cat "$table"
finish
