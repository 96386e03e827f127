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


# ---- reports: structs that the library fills, as named tuples of Python ----

_REPORTS = {"bvx_topology": "Topology", "bvx_distance_report": "Distances", "bvx_certificate": "Certificate", "bvx_grid_difference": "Difference",
                "bvx_fill_comparison": "FillComparison", "bvx_seed": "Seed", "bvx_octree_level": "OctreeLevel",
                "bvx_label": "Label"}
_TYPES = {"double": "float", "float": "float", "size_t": "int", **{f"{u}int{n}_t": "int" for u in ("", "u") for n in (8, 16, 32, 64)}}


def _members(body: str) -> list[tuple[str, str, list[int], str]]:
    """Type, name, sizes and comment of each member of a struct; reserved ones are left out."""
    found = []
    for kind, names, comment in re.findall(r"^\s*(\w+) ([\w\[\], ]+);(?:\s*/\*\*<\s*(.*?)\s*\*/)?", body, flags=re.M | re.S):
        note = re.sub(r"\s+", " ", re.sub(r"\[Units: ([^\]]+)\]", r"[\1]", comment))
        for part in names.split(","):
            name, *sizes = re.findall(r"\w+", part)
            if not name.startswith("reserved"):
                found.append((kind, name, [int(n) for n in sizes], note))
    return found


def _annotation(kind: str, name: str, sizes: list[int], note: str, classes: dict[str, str]) -> str:
    if sizes:
        inner = _annotation(kind, name, sizes[1:], note, classes)
        return f"tuple[{inner}, ...]" if sizes[0] > 4 else f"tuple[{', '.join([inner] * sizes[0])}]"
    if kind == "bvx_lattice":
        return '"Lattice"'
    if name in ("sign", "source", "fill", "fill_reason"):  # rules, by name
        return "str"
    return classes.get(kind) or ("bool" if kind == "int32_t" and note.startswith("1: ") else _TYPES[kind])


def _note(note: str, sizes: list[int]) -> str:
    return note.removeprefix("1: ").replace("\\", "") if not sizes else note


def reports(header: Path) -> str:
    """A module of one named tuple for each struct that calls fill, with the header's words on each field."""
    text = header.read_text(encoding="utf-8")
    structs = re.findall(r"^typedef struct (bvx_\w+) \{\n(.*?)^\} \1;", text, flags=re.M | re.S)
    wanted = [(name, body) for name, body in structs if name.endswith("_report") or name in _REPORTS]
    classes = {name: _REPORTS.get(name) or "".join(w.capitalize() for w in name.split("_")[1:]) for name, _ in wanted}
    lines = ['"""What calls report: named tuples of numbers, with the fields of the C header\'s structs.', "",
             'Made from the header when the package is built."""', "", "from typing import TYPE_CHECKING, Any, NamedTuple", "",
             "if TYPE_CHECKING:", "    from ._lattice import Lattice", ""]
    for name, body in wanted:
        members = _members(body)
        lines += ["", f"class {classes[name]}(NamedTuple):", f'    """``{name}`` of the C header.', "", "    Attributes:"]
        lines += [f"        {member}: {_note(note, sizes)}".rstrip() for _, member, sizes, note in members]
        lines += ['    """', ""]
        lines += [f"    {member}: {_annotation(kind, member, sizes, note, classes)}" for kind, member, sizes, note in members]
        lines.append("")
    lines += ["", "BY_STRUCT: dict[str, Any] = {", *(f'    "{name}": {kind},' for name, kind in classes.items()), "}", "",
              "__all__ = [", *(f'    "{name}",' for name in sorted(classes.values())), "]", ""]
    return "\n".join(lines)


def cdef(header: Path) -> str:
    """The declarations of all that can be called."""
    text = declarations(header)
    for name in missing(header):
        text = re.sub(rf"^[^\n;{{}}]*\b{name}\([^;]*;", "", text, flags=re.M)
    return text
