"""The same bytes as the program's, where BITVOX names it."""

import inspect
import os
import re
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


# Options of the program that a function of Python has under another name, or that are functions or methods of their own.
NAMES = {
    "voxelize": ([bitvox.voxelize, bitvox.voxelize_points, bitvox.field], {"origin": "corner", "value-type": "dtype", "compare-fills": bitvox.compare_fills}),
    "lod": ([bitvox.lod], {"samples": bitvox.compare}),
    "repair": ([bitvox.repair], {}),
    "refine": ([bitvox.refine], {"states": bitvox.Octree.expand, "expand": bitvox.Octree.expand, "leaves": bitvox.Octree.leaves, "cut": None}),
    "sections": ([bitvox.from_sections], {"block-model": None, "block": None}),
    "slice": ([bitvox.slice_mesh], {}),
    "faces": ([bitvox.faces, bitvox.voxelize], {"origin": "corner"}),
    "fill": ([bitvox.Grid.fill, bitvox.find_seed, bitvox.find_pockets], {"seed": "seeds", "add-shell": bitvox.Grid.__or__}),
    "components": ([bitvox.Grid.components, bitvox.Grid.keep], {"seed": "seeds", "keep-largest": "largest", "fill-cavities": bitvox.Grid.fill_cavities,
                                                               "labels": bitvox.Grid.label}),
    "compare": ([bitvox.compare], {}),
    "render": ([bitvox.render], {"from": "from_", "fill": bitvox.voxelize, "close-gaps": bitvox.voxelize, "voxels": bitvox.voxelize, "states": bitvox.Octree.expand,
                                 "expand": bitvox.Octree.expand, "turntable": None}),
}
OF_THE_PROGRAM = {"format", "json", "quiet", "help"}  # files and reports


@pytest.mark.parametrize("command", NAMES)
def test_options_have_the_programs_names(command):
    text = subprocess.run([PROGRAM, command, "--help"], capture_output=True, text=True, check=True).stdout
    functions, others = NAMES[command]
    known = {name.replace("_", "-") for f in functions for name in inspect.signature(f).parameters}
    options = set(re.findall(r"^  --([a-z-]+)", text, flags=re.M)) - OF_THE_PROGRAM
    assert {"threads", "memory-limit", "progress"} <= options <= known | set(others), sorted(options - known - set(others))
    for option, other in others.items():
        assert option in options and (not isinstance(other, str) or other.replace("_", "-") in known), option


@pytest.mark.parametrize("options", [
    {"resolution": 100}, {"resolution": 40, "fill": "vote"}, {"spacing": 0.05, "padding": 2}, {"spacing": 0.07, "corner": (-1.5, -2, -0.75)}, {"resolution": 50, "mode": "thin"},
    {"resolution": 64, "fill": "flood", "close_gaps": 1}, {"resolution": 30, "window": (3, 4, 5, 20, 21, 9)}])
def test_voxelize(tmp_path, options):
    words = []
    for name, value in options.items():
        words += ["--" + {"corner": "origin"}.get(name, name).replace("_", "-"), ",".join(map(str, value)) if isinstance(value, tuple) else value]
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


@pytest.mark.parametrize("options", [{}, {"sharp": True}, {"shell": 3, "least_part": 5, "interpolation": "vector", "sign": "vote"}])
def test_repair(tmp_path, options):
    words = [w for name, value in options.items() for w in ["--" + name.replace("_", "-"), value] if w is not True]
    program("repair", KNOT, "-o", tmp_path / "a.ply", "--resolution", 60, *words)
    assert bitvox.dumps(bitvox.repair(KNOT, resolution=60, **options), "ply") == (tmp_path / "a.ply").read_bytes()


@pytest.mark.parametrize("options", [{}, {"half_width": 0}, {"half_width": 1.5, "sign": "pseudonormal"}, {"padding": 1}, {"window": (3, 4, 5, 20, 21, 9)}])
def test_field(tmp_path, options):
    words = []
    for name, value in options.items():
        words += ["--" + name.replace("_", "-"), ",".join(map(str, value)) if isinstance(value, tuple) else value]
    program("voxelize", KNOT, "-o", tmp_path / "a.vti", "--mode", "field", "--resolution", 30, *words)
    assert bitvox.dumps(bitvox.field(KNOT, resolution=30, **options), "vti") == (tmp_path / "a.vti").read_bytes()


@pytest.mark.parametrize("options", [{}, {"caps": "taper", "layers": 2}, {"crossings": "paper", "grid": (20, 30), "subdivide": 0}])
def test_slice_and_sections(tmp_path, options):
    program("slice", KNOT, "-o", tmp_path / "a.csl", "--spacing", 0.2, "--axis", "y")
    sections = bitvox.slice_mesh(KNOT, spacing=0.2, axis="y")
    assert bitvox.dumps(sections, "csl") == (tmp_path / "a.csl").read_bytes()
    words = []
    for name, value in options.items():
        words += ["--" + name, "x".join(map(str, value)) if isinstance(value, tuple) else value]
    program("sections", tmp_path / "a.csl", "-o", tmp_path / "a.ply", *words)
    assert bitvox.dumps(bitvox.from_sections(tmp_path / "a.csl", **options), "ply") == (tmp_path / "a.ply").read_bytes()


@pytest.mark.parametrize("options", [{"resolution": 100}, {"resolution": 100, "levels": 3}, {"base": 5, "levels": 4, "adaptive": 0.01}])
def test_refine(tmp_path, options):
    program("refine", KNOT, "-o", tmp_path / "a.bvx", *[w for name, value in options.items() for w in ("--" + name, value)])
    assert bitvox.dumps(bitvox.refine(KNOT, **options), "bvx") == (tmp_path / "a.bvx").read_bytes()
