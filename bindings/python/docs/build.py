"""Build the pages of the Python package: run what they and the notebooks show, make their pictures and the recipes' page, then mkdocs.

    python bindings/python/docs/build.py FOLDER [NOTEBOOKS]

Needs mkdocs-material, mkdocstrings[python], nbclient, ipykernel and an installed bitvox with what the notebooks import. NOTEBOOKS is a
folder of notebooks that were run already. Ends with status 1 where a page's code fails, a picture that a page shows
is not made, or mkdocs finds a reference that leads nowhere.
"""

from __future__ import annotations

import base64
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

HERE = Path(__file__).resolve().parent
PYTHON = re.compile(r"^```python\n(.*?)^```$", flags=re.M | re.S)


def recipes() -> str:
    """The recipes of the README, with the pictures' folder in its place."""
    text = (HERE.parent / "README.md").read_text(encoding="utf-8")
    part = text[text.index("## Recipes") : text.index("## What to know")]
    return "# Recipes\n" + re.sub(r"^### ", "## ", part.removeprefix("## Recipes"), flags=re.M)


def run_page(page: Path, pictures: Path) -> None:
    """All code of a page, in its order, in one folder with the knot; pictures go beside the page."""
    code = "\n".join(PYTHON.findall(page.read_text(encoding="utf-8")))
    if not code:
        return
    with tempfile.TemporaryDirectory() as folder:
        shutil.copy(HERE.parents[2] / "fixtures" / "knot.ply", folder)
        found = subprocess.run([sys.executable, "-c", code], cwd=folder, capture_output=True, text=True, check=False)
        if found.returncode:
            raise SystemExit(f"{page.name}: its code fails\n{found.stderr}")
        for picture in Path(folder).glob("*.png"):
            shutil.copy(picture, pictures)


def run_notebook(path: Path, work: Path) -> Any:
    """The notebook with its outputs, run from top to bottom in a folder."""
    import nbclient
    import nbformat

    book = nbformat.read(path, as_version=4)
    nbclient.NotebookClient(book, timeout=300, kernel_name="python3", resources={"metadata": {"path": str(work)}}).execute()
    return book


def notebook_page(path: Path, folder: Path, ready: Path | None) -> None:
    """A page of a notebook: its texts, its code, what that prints, its pictures; beside it the notebook, with its outputs."""
    import nbformat

    if ready is not None:
        book = nbformat.read(ready / path.name, as_version=4)
    else:
        with tempfile.TemporaryDirectory() as work:
            book = run_notebook(path, Path(work))
    nbformat.write(book, folder / path.name)
    page = []
    for cell in book.cells:
        if cell.cell_type == "markdown":
            page.append(cell.source)
            continue
        page.append(f"```python\n{cell.source}\n```")
        for output in cell.outputs:
            data = output.get("data", {})
            if output.output_type == "stream":
                page.append(f"```text\n{output.text.rstrip()}\n```")
            elif "image/png" in data:
                name = f"{path.stem}_{len(page)}.png"
                (folder / name).write_bytes(base64.b64decode(data["image/png"]))
                page.append(f"![{data.get('text/plain', path.stem)}]({name})")
            elif "text/plain" in data:
                page.append(f"```text\n{data['text/plain']}\n```")
    page.append(f"[The notebook]({path.name})")
    (folder / f"{path.stem}.md").write_text("\n\n".join(page) + "\n", encoding="utf-8")


def main(target: str, ready: str | None = None) -> int:
    with tempfile.TemporaryDirectory() as work:
        shutil.copytree(HERE / "pages", Path(work) / "pages")
        shutil.copy(HERE / "mkdocs.yml", work)
        for page in sorted((Path(work) / "pages").glob("*.md")):
            run_page(page, page.parent)
        (Path(work) / "pages" / "notebooks").mkdir()
        for notebook in sorted((HERE / "notebooks").glob("*.ipynb")):
            notebook_page(notebook, Path(work) / "pages" / "notebooks", None if ready is None else Path(ready))
        (Path(work) / "pages" / "recipes.md").write_text(recipes(), encoding="utf-8")  # which the tests run
        return subprocess.run([sys.executable, "-m", "mkdocs", "build", "--quiet", "--site-dir", str(Path(target).resolve())], cwd=work,
                              env={**os.environ, "NO_MKDOCS_2_WARNING": "1"}, check=False).returncode


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:3]))
