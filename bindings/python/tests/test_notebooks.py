"""The ten notebooks of the pages: each is run from top to bottom by Jupyter's own client, and shows pictures."""

import json

import pytest
from conftest import HERE

FOLDER = HERE.parent / "docs" / "notebooks"
NOTEBOOKS = sorted(FOLDER.glob("*.ipynb"))
NEEDS = {"07_orientation": ["SimpleITK", "pydicom", "highdicom"], "10_larger_than_memory": ["dask", "zarr", "DracoPy"]}


def test_there_are_ten():
    if not FOLDER.is_dir():
        pytest.skip("the notebooks are not beside the tests")
    assert [path.name[:3] for path in NOTEBOOKS] == [f"{n:02}_" for n in range(1, 11)]


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_notebook(path, run_notebook):
    for module in NEEDS.get(path.stem, []):
        pytest.importorskip(module)
    stored = json.loads(path.read_text(encoding="utf-8"))["cells"]
    assert all(cell["outputs"] == [] and cell["execution_count"] is None for cell in stored if cell["cell_type"] == "code"), "stored without outputs"
    run, _ = run_notebook
    book = run(path)

    shown = [output for cell in book.cells if cell.cell_type == "code" for output in cell.outputs]
    pictures = [output.data["image/png"] for output in shown if output.output_type in ("display_data", "execute_result") and "image/png" in output.data]
    assert pictures and all(len(picture) > 1000 for picture in pictures)
    # What a result has cost is told to a reader as to any user; other warnings are faults of the notebook.
    assert not [output for output in shown if output.output_type == "error"
                or output.get("name") == "stderr" and "ResultWarning: " not in output.text], "warnings are told"


def test_headings_are_told_on_the_first_page():
    page = FOLDER.parent / "pages" / "index.md"
    if not page.is_file():
        pytest.skip("the pages are not beside the tests")
    text = page.read_text(encoding="utf-8")
    for path in NOTEBOOKS:
        title = json.loads(path.read_text(encoding="utf-8"))["cells"][0]["source"][0].removeprefix("# ").strip()
        assert f"[{title}](notebooks/{path.stem}.md)" in text, title
