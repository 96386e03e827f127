"""The README does what it says: every piece of Python in it is run, and the API reference is made from the docstrings."""

import re
import shutil
import subprocess
import sys

import pytest
from conftest import HERE, REPOSITORY

README = HERE.parent / "README.md"
NEEDS = {"trimesh": ["trimesh"], "pyvista": ["pyvista"], "big": ["dask", "zarr"], "formats": ["nibabel", "PIL"]}


def pieces(path=README):
    if not path.is_file():
        return []
    return re.findall(r"^```python\n(.*?)^```$", path.read_text(encoding="utf-8"), flags=re.M | re.S)


def test_recipes_are_numbered():
    numbers = [int(n) for n in re.findall(r"^### (\d+)\. ", README.read_text(encoding="utf-8"), flags=re.M)]
    assert numbers == list(range(1, len(numbers) + 1)) and len(numbers) >= 16 and len(pieces()) == len(numbers) + 1


def test_every_stage_has_a_recipe():
    shown = set(re.findall(r"\b(?:bitvox|formats)\.(\w+)\(", "".join(pieces())))
    assert {"voxelize", "lod", "repair", "refine", "field", "from_sections", "slice_mesh", "check", "read", "render", "boolean", "read_volume", "Volume"} <= shown


@pytest.mark.parametrize("number", range(len(pieces())))
def test_recipe(number, tmp_path):
    code = pieces()[number]
    for word, modules in NEEDS.items():
        if re.search(rf"import {word}\b", code):
            for module in modules:
                pytest.importorskip(module)
    knot = REPOSITORY / "fixtures" / "knot.ply"
    if "knot.ply" in code:
        if not knot.is_file():
            pytest.skip("fixtures/knot.ply is not here")
        shutil.copy(knot, tmp_path)
    found = subprocess.run([sys.executable, "-W", "error::SyntaxWarning", "-c", code], cwd=tmp_path, capture_output=True, text=True,
                           timeout=300, check=False)
    assert found.returncode == 0, found.stderr
    promised = re.findall(r"^print\(.*\) +# (.*)$", code, flags=re.M)
    if number == 0:
        assert found.stdout.splitlines() == promised


def test_python_example_of_the_main_readme(tmp_path):
    code = pieces(REPOSITORY / "README.md")
    if not code:
        pytest.skip("the main README has no Python example here")
    if (REPOSITORY / "fixtures" / "knot.ply").is_file():
        shutil.copytree(REPOSITORY / "fixtures", tmp_path / "fixtures", ignore=shutil.ignore_patterns("golden"))
    for piece in code:
        found = subprocess.run([sys.executable, "-c", piece], cwd=tmp_path, capture_output=True, text=True, timeout=300, check=False)
        assert found.returncode == 0, found.stderr


def test_reference_is_made_from_the_docstrings(tmp_path):
    pytest.importorskip("pdoc")
    found = subprocess.run([sys.executable, "-m", "pdoc", "-d", "google", "bitvox", "bitvox.reports", "bitvox.formats", "bitvox.big", "-o", str(tmp_path)],
                           capture_output=True, text=True, timeout=300, check=False)
    assert found.returncode == 0, found.stderr
    page = (tmp_path / "bitvox.html").read_text(encoding="utf-8")
    for name in ("voxelize", "close_gaps", "surface", "Octree", "half_width"):
        assert name in page
    assert (tmp_path / "bitvox" / "big.html").is_file() and "longest_hole" in (tmp_path / "bitvox" / "reports.html").read_text(encoding="utf-8")
