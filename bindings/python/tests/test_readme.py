"""The README does what it says: every piece of Python in it is run, and the API reference is made from the docstrings."""

import re
import shutil
import subprocess
import sys

import pytest
from conftest import HERE, REPOSITORY, public_names

import bitvox
from bitvox import big, formats

README = HERE.parent / "README.md"
NEEDS = {"SimpleITK": ["SimpleITK"], "npe2": ["npe2"], "trimesh": ["trimesh"], "pyvista": ["pyvista"], "big": ["dask", "zarr", "DracoPy"], "formats": ["nibabel", "PIL"]}


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
    if "write_segmentation" in code:
        pytest.importorskip("highdicom")
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


def test_pages_are_built(tmp_path, run_notebook):
    """Their code runs, their pictures are made, every reference leads somewhere, and the manual of each public name is there."""
    for module in ("material", "mkdocstrings_handlers.python", "highdicom", "SimpleITK", "zarr"):
        pytest.importorskip(module)
    build = HERE.parent / "docs" / "build.py"
    if not build.is_file() or not (REPOSITORY / "fixtures" / "knot.ply").is_file():
        pytest.skip("the pages are not beside the tests")
    run, ready = run_notebook
    for path in sorted((HERE.parent / "docs" / "notebooks").glob("*.ipynb")):
        run(path)
    found = subprocess.run([sys.executable, str(build), str(tmp_path), str(ready)], capture_output=True, text=True, timeout=300, check=False)
    assert found.returncode == 0 and "WARNING" not in found.stderr, found.stdout + found.stderr
    pages = {path.parent.name: path.read_text(encoding="utf-8") for path in (tmp_path / "reference").glob("*/index.html")}
    whole = "".join(pages.values())
    for name in [*public_names(bitvox), *(f"big.{n}" for n in big.__all__), *(f"formats.{n}" for n in formats.__all__)]:
        assert name in ("big", "formats", "reports") or f'id="bitvox.{name}"' in whole, name
    for name in ("close_gaps", "half_width"):
        assert name in pages["stages"]
    assert "cavities_dropped" in pages["reports"]
    shown = re.findall(r'<img [^>]*src="\.\./(\w+\.png)"', (tmp_path / "gallery" / "index.html").read_text(encoding="utf-8"))
    assert len(shown) >= 8 and all((tmp_path / name).read_bytes()[1:4] == b"PNG" for name in shown)
    books = sorted((tmp_path / "notebooks").glob("*/index.html"))
    assert len(books) == 10
    for book in books:  # a picture each, which is there
        shown = re.findall(r'<img [^>]*src="\.\./(\w+\.png)"', book.read_text(encoding="utf-8"))
        assert shown and all((book.parent.parent / name).read_bytes()[1:4] == b"PNG" for name in shown), book.parent.name
