#!/bin/sh
# deps.sh [proof|js|windows|first|fetch] - install what the tests use beyond a C compiler and make (Debian and Ubuntu names, as root); proof: and what
# matrix, bare, fuzz, san-memory, san-threads, coverage, mcdc, analyze and abi use; js: what the npm package is built and tested with;
# windows: the cross compiler and wine; first: what the native build and the Python package need; fetch: download the rest, and what
# DEPS_LATER names, into BUILD/debs, while the native build runs: nothing of the system changes under a compiler.
# Does nothing when all is there. Without root or apt it names what is missing; the tests then skip those parts and say so. Never removes a package: the cross compilers and gcc-multilib exclude each other, and gcc-multilib stays.
set -u

first='python3-venv python3-dev libcmocka-dev zlib1g-dev locales'
packages="$first clang clang-format-14 cmake pkg-config qemu-user
    gcc-i686-linux-gnu libc6-dev-i386-cross gcc-s390x-linux-gnu libc6-dev-s390x-cross"
windows='gcc-mingw-w64-x86-64 libz-mingw-w64-dev wine wine64'
proof='ninja-build clang-19 llvm llvm-19 libclang-rt-19-dev g++ gcovr abigail-tools cppcheck clang-tidy
    gcc-aarch64-linux-gnu libc6-dev-arm64-cross gcc-arm-linux-gnueabihf libc6-dev-armhf-cross
    gcc-riscv64-linux-gnu libc6-dev-riscv64-cross gcc-powerpc64le-linux-gnu libc6-dev-ppc64el-cross
    musl-tools gcc-mingw-w64-x86-64 libz-mingw-w64-dev wine64 wine debhelper dpkg-dev lintian ccache emscripten nodejs gcc-arm-none-eabi libnewlib-arm-none-eabi qemu-system-arm'
if [ "${1:-}" = proof ]; then packages="$packages $proof"; fi
case ${1:-} in
first) packages=$first ;;
windows) packages=$windows ;;
fetch) if [ "${DEPS_LATER:-}" = windows ]; then packages="$packages $windows"; fi ;;
esac
if [ "${1:-}" = js ]; then
    packages='emscripten zopfli chromium'
    command -v node >/dev/null 2>&1 || packages="$packages nodejs"
    command -v npm >/dev/null 2>&1 || packages="$packages npm"
fi

missing() {
    for p in $packages; do
        [ "$(dpkg-query -W -f='${db:Status-Status}' "$p" 2>/dev/null)" = installed ] || printf ' %s' "$p"
    done
}

if ! command -v dpkg-query >/dev/null 2>&1 || ! command -v apt-get >/dev/null 2>&1; then
    echo "deps: no apt here; the tests use what they find of:" $packages
    exit 0
fi
wanted=$(missing)
[ -n "$wanted" ] || exit 0
if [ "$(id -u)" != 0 ]; then
    echo "deps: not root, so these are not installed and the tests that need them are skipped:$wanted"
    exit 0
fi

log=$(mktemp)
trap 'rm -f "$log"' EXIT
# Images of containers clean apt's own folder after each install.
mkdir -p "${BUILD:=build}/debs/partial"
debs=$(cd "$BUILD/debs" && pwd)
install() {
    DEBIAN_FRONTEND=noninteractive apt-get -y -q --no-remove --no-install-recommends -o Acquire::Retries=3 \
        -o DPkg::Lock::Timeout=300 -o Dir::Cache::archives="$debs" install "$@" </dev/null >>"$log" 2>&1
}

if [ "${1:-}" = fetch ]; then
    # shellcheck disable=SC2086
    install --download-only $wanted || echo "deps: not all could be fetched ahead"
    exit 0
fi

echo "deps: installing$wanted"
# shellcheck disable=SC2086
if ! install $wanted; then
    apt-get -q -o Acquire::Retries=3 update </dev/null >>"$log" 2>&1
    if ! install $wanted; then
        for p in $wanted; do install "$p"; done # one that cannot be had must not keep the others away
    fi
fi
if [ "${DEPS_LATER:-}" != windows ] || [ "${1:-}" = windows ]; then rm -rf "$debs"; fi
left=$(missing)
if [ -n "$left" ]; then
    tail -n 15 "$log"
    echo "deps: could not install$left; the tests that need them are skipped"
fi
exit 0
