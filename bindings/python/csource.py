"""The C library beside this package, as one file, and what its header declares.

In the repository the two files are put together anew at each build; a source distribution carries them.
"""

from __future__ import annotations

import io
import re
import shutil
import subprocess
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
SOURCE = HERE / "csrc"
REPOSITORY = HERE.parent.parent


def prepare() -> Path:
    """Make sure that csrc/bitvox.c and csrc/bitvox.h are there and up to date; returns the header's path."""
    if (REPOSITORY / "src" / "amalgamate.sh").is_file() and (REPOSITORY / "include" / "bitvox.h").is_file():
        SOURCE.mkdir(exist_ok=True)
        with tempfile.TemporaryDirectory() as made:
            subprocess.run(["sh", "src/amalgamate.sh", made], cwd=REPOSITORY, check=True)
            shutil.copyfile(REPOSITORY / "LICENSE", Path(made) / "LICENSE")
            for name in ("bitvox.c", "bitvox.h", "LICENSE"):
                old, new = SOURCE / name, Path(made) / name
                if not old.is_file() or old.read_bytes() != new.read_bytes():
                    shutil.copyfile(new, old)
    header = SOURCE / "bitvox.h"
    if not header.is_file():
        raise SystemExit("csrc/bitvox.c is missing: build from the repository or from a source distribution")
    return header


def _drop_inline(text: str) -> str:
    """Without the inline functions, which Python cannot call."""
    pieces, at = [], 0
    for found in re.finditer(r"static inline", text):
        if found.start() < at:
            continue
        pieces.append(text[at : found.start()])
        depth, at = 0, text.index("{", found.start())
        while True:
            depth += {"{": 1, "}": -1}.get(text[at], 0)
            at += 1
            if depth == 0:
                break
    return "".join(pieces) + text[at:]


def declarations(header: Path) -> str:
    """The header as cffi reads it: preprocessed, without includes and inline functions, and with its numeric macros."""
    from pcpp import Preprocessor

    class Reader(Preprocessor):
        def on_include_not_found(self, *args):  # system headers: cffi knows their types
            return None

        def on_error(self, file, line, message):
            if "Include file" not in message:
                raise SystemExit(f"{file}:{line}: {message}")

    text = header.read_text(encoding="utf-8")
    text = re.sub(r"^#\s*include.*$", "", text, flags=re.M)
    reader = Reader()
    reader.line_directive = None
    reader.define("BVX_STATIC_API 1")
    reader.parse(text, str(header))
    out = io.StringIO()
    reader.write(out)
    plain = _drop_inline(out.getvalue())
    plain = re.sub(r"^\s*#.*$", "", plain, flags=re.M)
    plain = re.sub(r"^\s*static\s+(?=\w)", "", plain, flags=re.M)
    macros = re.findall(r"^#define (BVX_VERSION(?:_\w+)?) ", text, flags=re.M)
    return plain + "\n" + "\n".join(f"#define {name} ..." for name in macros) + "\n"


def declared(header: Path) -> list[str]:
    """Names of the functions that the header exports."""
    text = re.sub(r"/\*.*?\*/", " ", header.read_text(encoding="utf-8"), flags=re.S)
    return sorted(set(re.findall(r"^BVX_API [^;]*?\b(bvx_\w+)\(", text, flags=re.M)))


def missing(header: Path) -> list[str]:
    """Of these, the ones that csrc/bitvox.c does not define."""
    source = header.with_name("bitvox.c").read_text(encoding="utf-8")
    defined = set(re.findall(r"^[a-z][\w \*]*?\b(bvx_\w+)\([^;{]*\)\s*\{", source, flags=re.M))
    return [name for name in declared(header) if name not in defined]


def cdef(header: Path) -> str:
    """The declarations of all that can be called."""
    text = declarations(header)
    for name in missing(header):
        text = re.sub(rf"^[^\n;{{}}]*\b{name}\([^;]*;", "", text, flags=re.M)
    return text
