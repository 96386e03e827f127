#!/bin/sh
# test_python.sh [prepare|wheels|pytest N] - build the Python package, install it in a clean virtual environment and run its tests there.
# Called by run_tests.sh, part by part; without a part it does all of them.
#     prepare   the environment, the wheel and the same bits; the wheel that is tested is made from the source distribution, under flags
#               of the environment that would change results if they won: one compile stands for all of it
#     wheels    that wheel for other machines, and where there is no compiler
#     pytest N  the tests of bindings/python/tests: 1 those named below, 2 all others; both take about as long and run beside each other
#     PYTHON=PROGRAM  the interpreter [python3]
# Ends with "N passed, N failed, N skipped"; status 77 when there is nothing to build with.
set -u
part=${1:-all} group=${2:-}
cd "$(dirname "$0")/../.." || exit 1
: "${BUILD:=build}" "${PYTHON:=python3}"
work=$BUILD/python
case $part in all | prepare) rm -rf "$work" ;; esac
mkdir -p "$work"
work=$(cd "$work" && pwd)
project=$PWD/bindings/python
shared=${BITVOX_SHARED:-$PWD/../shared}
unset PYTHONPATH

# Notebooks are run once for two files, so both stand in one group.
first_group='test_notebooks test_readme test_same_options test_same_bytes'

python=$work/venv/bin/python
# Most of what is fetched is never imported, so Python compiles what it imports.
get() { "$python" -m pip install --quiet --disable-pip-version-check --no-compile "$@"; }
# A hundred packages take pip ten times the processor time that uv takes; where uv does not get them, pip tries.
get_many() {
    get uv && UV_CACHE_DIR=$work/uv "$work/venv/bin/uv" pip install --quiet --python "$python" "$@" && return
    get "$@"
}

passed=0 failed=0 skipped=0
check() { # NAME, COMMAND...
    name=$1
    shift
    if "$@"; then passed=$((passed + 1)); else failed=$((failed + 1)) && echo "FAIL  $name"; fi
}
finish() {
    echo "$passed passed, $failed failed, $skipped skipped"
    [ $failed = 0 ]
    exit
}

# ---- Environment and wheel ----

make_environment() {
    command -v "$PYTHON" >/dev/null 2>&1 || { echo "$PYTHON is missing" && exit 77; }
    "$PYTHON" -c 'import sys; sys.exit(sys.version_info < (3, 10))' || { echo "$PYTHON is older than 3.10" && exit 77; }
    "$PYTHON" -m venv "$work/venv" || { echo "$PYTHON has no working venv" && exit 77; }
    get 'setuptools>=77' 'cffi>=1.15' 'pcpp>=1.30' 'numpy>=1.22' pytest hypothesis || { echo "pip cannot install what the build needs" && exit 77; }
    set -- scipy scikit-image trimesh rtree networkx lxml tqdm meshio pyvista nibabel pydicom highdicom SimpleITK pynrrd tifffile xarray Pillow ezdxf laspy lazrs pye57 pypcd4 npe2 'dask[array,distributed]' 'zarr>=3' DracoPy cloud-volume numpydoc mkdocs-material 'mkdocstrings[python]' nbclient nbformat ipykernel mypy pyright
    get_many "$@" || for package; do # all at once is quicker
        get "$package" || echo "pip could not install $package: its tests are skipped"
    done
}

sdist() { (cd "$project" && "$python" setup.py --quiet sdist --dist-dir "$work/sdist" 2>"$work/sdist.log" || { cat "$work/sdist.log"; false; }); }
wheel() {
    mkdir -p "$work/alone" && tar -xzf "$work"/sdist/bitvox-*.tar.gz -C "$work/alone" --strip-components 1 || return 1
    CFLAGS='-O2 -std=gnu17 -march=native -ffast-math' "$python" -m pip wheel --quiet --disable-pip-version-check --no-build-isolation --no-deps \
        -w "$work/wheel" "$work/alone"
}
report='import bitvox
v = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
f = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]
solid = bitvox.voxelize((v, f), resolution=97)
print(solid.content_hash(), [m.content_hash() for m in bitvox.lod(solid, levels=(31, 7))])'
same_bits() {
    echo '11904595649893092191 [11858389553578467053, 185406162864918682]' >"$work/golden.txt" # everywhere the same
    "$python" -c "$report" | diff "$work/golden.txt" -
}

prepare() {
    make_environment
    check 'source distribution' sdist
    check 'wheel from it, under fast-math' wheel
    check 'wheel is for every Python from 3.10' test -n "$(find "$work/wheel" -name '*-cp310-abi3-*.whl' 2>/dev/null)"
    check 'install' get --no-deps --force-reinstall "$work"/wheel/*.whl
    check 'the bits of every other build' same_bits
}

# ---- Tests ----

wheels() { BUILD=$work PYTHON=$python sh tests/tools/wheels.sh "$work"/wheel/*.whl; }

run_pytest() { # GROUP
    log=$work/pytest-$1.txt
    set -- "$1"
    for name in $first_group; do
        case $1 in
        1) set -- "$@" "$project/tests/$name.py" ;;
        *) set -- "$@" "--ignore=$project/tests/$name.py" ;;
        esac
    done
    if [ "$1" != 1 ]; then set -- "$@" "$project/tests"; fi
    shift
    (cd "$work" && BITVOX_SHARED=$shared "$python" -m pytest -q -rs --disable-warnings -p no:cacheprovider "$@") >"$log" 2>&1
    status=$?
    cat "$log"
    counted() { tail -n 1 "$log" | grep -o "[0-9]* $1" | cut -d ' ' -f 1; }
    p=$(counted passed) f=$(counted failed) e=$(counted error) s=$(counted skipped)
    passed=$((passed + ${p:-0})) skipped=$((skipped + ${s:-0})) failed=$((failed + ${f:-0} + ${e:-0}))
    [ $status = 0 ] || [ $failed -gt 0 ] || failed=1
}

case $part in
all)
    prepare
    check 'wheel for other machines, and without a compiler' wheels
    run_pytest 1
    run_pytest 2
    ;;
prepare) prepare ;;
wheels) check 'wheel for other machines, and without a compiler' wheels ;;
pytest) run_pytest "$group" ;;
*) echo "test_python: no part named $part" && exit 2 ;;
esac
finish
