#!/bin/sh
# deps.sh [proof|js|windows] - install what the tests use beyond a C compiler and make (Debian and Ubuntu names, as root); proof: and what
# matrix, bare, fuzz, san-memory, san-threads, coverage, mcdc, analyze and abi use; js: what the npm package is built and tested with;
# windows: the cross compiler and wine.
# Does nothing when all is there. Without root or apt it names what is missing; the tests then skip those parts and say so. Never removes a package: the cross compilers and gcc-multilib exclude each other, and gcc-multilib stays.
set -u

packages='python3-venv python3-dev libcmocka-dev clang clang-format-14 cmake zlib1g-dev locales pkg-config qemu-user
    gcc-i686-linux-gnu libc6-dev-i386-cross gcc-s390x-linux-gnu libc6-dev-s390x-cross'
proof='ninja-build clang-19 llvm llvm-19 libclang-rt-19-dev g++ gcovr abigail-tools cppcheck clang-tidy
    gcc-aarch64-linux-gnu libc6-dev-arm64-cross gcc-arm-linux-gnueabihf libc6-dev-armhf-cross
    gcc-riscv64-linux-gnu libc6-dev-riscv64-cross gcc-powerpc64le-linux-gnu libc6-dev-ppc64el-cross
    musl-tools gcc-mingw-w64-x86-64 libz-mingw-w64-dev wine64 wine debhelper dpkg-dev lintian ccache emscripten nodejs gcc-arm-none-eabi libnewlib-arm-none-eabi qemu-system-arm'
if [ "${1:-}" = proof ]; then packages="$packages $proof"; fi
if [ "${1:-}" = windows ]; then packages='gcc-mingw-w64-x86-64 libz-mingw-w64-dev wine wine64'; fi
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
install() {
    DEBIAN_FRONTEND=noninteractive apt-get -y -q --no-remove --no-install-recommends -o Acquire::Retries=3 \
        -o DPkg::Lock::Timeout=300 install "$@" </dev/null >>"$log" 2>&1
}

echo "deps: installing$wanted"
# shellcheck disable=SC2086
if ! install $wanted; then
    apt-get -q -o Acquire::Retries=3 update </dev/null >>"$log" 2>&1
    if ! install $wanted; then
        for p in $wanted; do install "$p"; done # one that cannot be had must not keep the others away
    fi
fi
left=$(missing)
if [ -n "$left" ]; then
    tail -n 15 "$log"
    echo "deps: could not install$left; the tests that need them are skipped"
fi
exit 0
