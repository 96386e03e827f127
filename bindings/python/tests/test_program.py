"""The same bytes as the program's, where BITVOX names it."""

import os
import subprocess

import pytest
from conftest import REPOSITORY

import bitvox

PROGRAM = os.environ.get("BITVOX", "")
KNOT = REPOSITORY / "fixtures" / "knot.ply"

pytestmark = pytest.mark.skipif(not (os.path.isfile(PROGRAM) and KNOT.is_file()), reason="BITVOX names no program here")


def program(*arguments):
    found = subprocess.run([PROGRAM, *map(str, arguments), "--quiet"], capture_output=True, text=True, check=False)
    assert found.returncode == 0, found.stderr


@pytest.mark.parametrize("options", [
    {"resolution": 100}, {"resolution": 40, "fill": "vote"}, {"spacing": 0.05, "padding": 2}, {"resolution": 50, "mode": "thin"},
    {"resolution": 64, "fill": "flood", "close_gaps": 1}, {"resolution": 30, "window": (3, 4, 5, 20, 21, 9)}])
def test_voxelize(tmp_path, options):
    words = []
    for name, value in options.items():
        words += ["--" + name.replace("_", "-"), ",".join(map(str, value)) if isinstance(value, tuple) else value]
    program("voxelize", KNOT, "-o", tmp_path / "a.bvx", *words)
    assert bitvox.dumps(bitvox.voxelize(KNOT, **options), "bvx") == (tmp_path / "a.bvx").read_bytes()


@pytest.mark.parametrize("options", [{}, {"triangles": (2000, 500)}, {"levels": (40, 10), "method": "coverage"}])
def test_lod(tmp_path, options):
    words = []
    for name, value in options.items():
        words += ["--" + name, ",".join(map(str, value)) if isinstance(value, tuple) else value]
    program("lod", KNOT, "-o", tmp_path / "l_%d.ply", *words)
    for i, level in enumerate(bitvox.lod(KNOT, **options)):
        assert bitvox.dumps(level, "ply") == (tmp_path / f"l_{i}.ply").read_bytes()


def test_render_faces_refine(tmp_path):
    program("render", KNOT, "-o", tmp_path / "a.png", "--size", "200x150", "--cut", "z=0", "--from", "1,2,3")
    assert bitvox.render(KNOT, size=(200, 150), cut={"z": 0.0}, from_=(1, 2, 3)).png() == (tmp_path / "a.png").read_bytes()
    program("refine", KNOT, "-o", tmp_path / "a.vtu", "--levels", "3", "--states", "surface")
    assert bitvox.dumps(bitvox.refine(KNOT, levels=3), "vtu", states="surface") == (tmp_path / "a.vtu").read_bytes()
