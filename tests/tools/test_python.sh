#!/bin/sh
# test_python.sh - build the Python package, install it in a clean virtual environment and run its tests there.
# Called by run_tests.sh. The wheel that is tested is made from the source distribution, under flags of the environment that would
# change results if they won: one compile stands for all of it.
#     PYTHON=PROGRAM  the interpreter [python3]
# Ends with "N passed, N failed, N skipped"; status 77 when there is nothing to build with.
set -u
cd "$(dirname "$0")/../.." || exit 1
: "${BUILD:=build}" "${PYTHON:=python3}"
work=$BUILD/python
rm -rf "$work"
mkdir -p "$work"
work=$(cd "$work" && pwd)
project=$PWD/bindings/python
shared=${BITVOX_SHARED:-$PWD/../shared}
unset PYTHONPATH

command -v "$PYTHON" >/dev/null 2>&1 || { echo "$PYTHON is missing" && exit 77; }
"$PYTHON" -c 'import sys; sys.exit(sys.version_info < (3, 10))' || { echo "$PYTHON is older than 3.10" && exit 77; }
"$PYTHON" -m venv "$work/venv" || { echo "$PYTHON has no working venv" && exit 77; }
python=$work/venv/bin/python
# Most of what is fetched is never imported, so Python compiles what it imports.
get() { "$python" -m pip install --quiet --disable-pip-version-check --no-compile "$@"; }

get 'setuptools>=77' 'cffi>=1.15' 'pcpp>=1.30' 'numpy>=1.22' pytest hypothesis || { echo "pip cannot install what the build needs" && exit 77; }
set -- scipy scikit-image trimesh rtree networkx lxml tqdm meshio pyvista nibabel pydicom highdicom SimpleITK pynrrd tifffile xarray Pillow ezdxf laspy lazrs pye57 pypcd4 npe2 'dask[array,distributed]' 'zarr>=3' DracoPy cloud-volume numpydoc mkdocs-material 'mkdocstrings[python]' nbclient nbformat ipykernel mypy pyright
get "$@" || for package; do # all at once is quicker
    get "$package" || echo "pip could not install $package: its tests are skipped"
done

passed=0 failed=0 p= s=
check() { # NAME, COMMAND...
    name=$1
    shift
    if "$@"; then passed=$((passed + 1)); else failed=$((failed + 1)) && echo "FAIL  $name"; fi
}
report='import bitvox
v = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
f = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]
solid = bitvox.voxelize((v, f), resolution=97)
print(solid.content_hash(), [m.content_hash() for m in bitvox.lod(solid, levels=(31, 7))])'
echo '11904595649893092191 [11858389553578467053, 185406162864918682]' >"$work/golden.txt" # everywhere the same
finish() {
    echo "$((passed + ${p:-0})) passed, $failed failed, ${s:-0} skipped"
    [ $failed = 0 ]
    exit
}

sdist() { (cd "$project" && "$python" setup.py --quiet sdist --dist-dir "$work/sdist" 2>"$work/sdist.log" || { cat "$work/sdist.log"; false; }); }
wheel() {
    mkdir -p "$work/alone" && tar -xzf "$work"/sdist/bitvox-*.tar.gz -C "$work/alone" --strip-components 1 || return 1
    CFLAGS='-std=gnu17 -march=native -ffast-math' "$python" -m pip wheel --quiet --disable-pip-version-check --no-build-isolation --no-deps \
        -w "$work/wheel" "$work/alone"
}
same_bits() { "$python" -c "$report" | diff "$work/golden.txt" -; }
check 'source distribution' sdist
check 'wheel from it, under fast-math' wheel
check 'wheel is for every Python from 3.10' test -n "$(find "$work/wheel" -name '*-cp310-abi3-*.whl' 2>/dev/null)"
check 'install' get --no-deps --force-reinstall "$work"/wheel/*.whl
check 'the bits of every other build' same_bits

wheels() { BUILD=$work PYTHON=$python sh tests/tools/wheels.sh "$work"/wheel/*.whl; }
check 'wheel for other machines, and without a compiler' wheels

(cd "$work" && BITVOX_SHARED=$shared "$python" -m pytest -q -rs --disable-warnings -p no:cacheprovider "$project/tests") >"$work/pytest.txt" 2>&1
status=$?
cat "$work/pytest.txt"
counted() { tail -n 1 "$work/pytest.txt" | grep -o "[0-9]* $1" | cut -d ' ' -f 1; }
p=$(counted passed) f=$(counted failed) e=$(counted error) s=$(counted skipped)
failed=$((failed + ${f:-0} + ${e:-0}))
[ $status = 0 ] || [ $failed -gt 0 ] || failed=1
finish
