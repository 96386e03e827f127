"""Build the pages of the Python package: run what they show, make their pictures and the recipes' page, then mkdocs.

    python bindings/python/docs/build.py FOLDER

Needs mkdocs-material, mkdocstrings[python] and an installed bitvox. Ends with status 1 where a page's code fails, a picture that a page shows
is not made, or mkdocs finds a reference that leads nowhere.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

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


def main(target: str) -> int:
    with tempfile.TemporaryDirectory() as work:
        shutil.copytree(HERE / "pages", Path(work) / "pages")
        shutil.copy(HERE / "mkdocs.yml", work)
        for page in sorted((Path(work) / "pages").glob("*.md")):
            run_page(page, page.parent)
        (Path(work) / "pages" / "recipes.md").write_text(recipes(), encoding="utf-8")  # which the tests run
        return subprocess.run([sys.executable, "-m", "mkdocs", "build", "--quiet", "--site-dir", str(Path(target).resolve())], cwd=work,
                              env={**os.environ, "NO_MKDOCS_2_WARNING": "1"}, check=False).returncode


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
