"""The C library beside this package, in units that compile beside one another, and what its header declares.

In the repository the sources are copied anew at each build; a source distribution carries them.
"""

from __future__ import annotations

import io
import re
from pathlib import Path

HERE = Path(__file__).resolve().parent
SOURCE = HERE / "csrc"
REPOSITORY = HERE.parent.parent

# Units of about one size: enough to keep many processors busy to the end, few enough that headers are not read again and again.
UNITS = 16
_UNIT_HEAD = """#if defined(__linux__) && !defined(_GNU_SOURCE)
#define _GNU_SOURCE /* what -std=c99 hides: clocks and affinity, for threads alone */
#endif
#if defined(__clang__)
#pragma clang diagnostic ignored "-Wunused-function" /* inline helpers that not every target needs */
#endif
"""


HEADERS = ("bitvox.h", "bitvox_io.h")


def _text(header: Path) -> str:
    """Both headers, of which the first one is given."""
    return "\n".join((header.parent / name).read_text(encoding="utf-8") for name in HEADERS)


def prepare() -> Path:
    """Make sure that the sources and the header are in csrc and up to date; returns the header's path."""
    if (REPOSITORY / "src" / "core").is_dir() and (REPOSITORY / "include" / "bitvox.h").is_file():
        rooms = [path for path in sorted((REPOSITORY / "src").iterdir()) if path.is_dir()]
        files = {f"src/{room.name}/{path.name}": path.read_bytes() for room in rooms for path in sorted(room.glob("*.[ch]"))}
        files |= {f"unit_{i:02}.c": text.encode() for i, text in enumerate(_units(files))}
        files |= {name: (REPOSITORY / "include" / name).read_bytes() for name in HEADERS} | {"LICENSE": (REPOSITORY / "LICENSE").read_bytes()}
        _lay(files)
    header = SOURCE / "bitvox.h"
    if not header.is_file() or not units():
        raise SystemExit("csrc/bitvox.h is missing: build from the repository or from a source distribution")
    return header


def _units(files: dict[str, bytes]) -> list[str]:
    """Sources that include the library's, a part each; names of statics are unique over all of them."""
    sources = sorted(name for name in files if name.endswith(".c") and not name.startswith("src/cli"))
    total, at, texts = sum(len(files[name]) for name in sources), 0, [_UNIT_HEAD] * UNITS
    for name in sources:
        texts[at * UNITS // total] += f'#include "{name}"\n'
        at += len(files[name])
    return texts


def _lay(files: dict[str, bytes]) -> None:
    """Files in csrc and no others; what has not changed is left alone."""
    for path in [*SOURCE.rglob("*")] if SOURCE.is_dir() else []:
        if path.is_file() and path.relative_to(SOURCE).as_posix() not in files:
            path.unlink()
    for name, data in files.items():
        path = SOURCE / name
        path.parent.mkdir(parents=True, exist_ok=True)
        if not path.is_file() or path.read_bytes() != data:
            path.write_bytes(data)


def units() -> list[Path]:
    """The files to compile."""
    return sorted(SOURCE.glob("unit_*.c"))


def program() -> list[Path]:
    """The files of the command, beside those of the library."""
    return sorted(SOURCE.glob("src/cli_*/*.c"))


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

    text = re.sub(r"^#\s*include.*$", "", _text(header), flags=re.M)
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
    text = re.sub(r"/\*.*?\*/", " ", _text(header), flags=re.S)
    return sorted(set(re.findall(r"^BVX_API [^;]*?\b(bvx_\w+)\(", text, flags=re.M)))


def missing(header: Path) -> list[str]:
    """Of these, the ones that the sources do not define."""
    source = "\n".join(path.read_text(encoding="utf-8") for path in sorted(header.parent.glob("src/*/*.c")))
    defined = set(re.findall(r"^[a-z][\w \*]*?\b(bvx_\w+)\([^;{]*\)\s*\{", source, flags=re.M))
    return [name for name in declared(header) if name not in defined]


# ---- reports: structs that the library fills, as named tuples of Python ----

_REPORTS = {"bvx_topology": "Topology", "bvx_distance_report": "Distances", "bvx_certificate": "Certificate", "bvx_grid_difference": "Difference",
                "bvx_seed": "Seed", "bvx_finding": "Finding", "bvx_octree_level": "OctreeLevel",
                "bvx_label": "Label"}
_TYPES = {"double": "float", "float": "float", "size_t": "int", **{f"{u}int{n}_t": "int" for u in ("", "u") for n in (8, 16, 32, 64)}}


def _members(body: str) -> list[tuple[str, str, list[int], str]]:
    """Type, name, sizes and comment of each member of a struct; reserved ones are left out."""
    found = []
    for kind, names, comment in re.findall(r"^\s*(\w+) ([\w\[\], ]+);(?:\s*/\*\*<\s*(.*?)\s*\*/)?", body, flags=re.M | re.S):
        note = re.sub(r"\s+", " ", re.sub(r"\[Units: ([^\]]+)\]", r"[\1]", comment))
        for british, american in (("colour", "color"), ("centre", "center"), ("neighbour", "neighbor")):
            note = note.replace(british, american)
        for part in names.split(","):
            name, *sizes = re.findall(r"\w+", part)
            if kind == "bvx_box":  # its corners are members here
                found += [("double", corner, [3], f"{corner} corner of the {note}") for corner in ("low", "high")]
            elif not name.startswith("reserved"):
                found.append((kind, name, [int(n) for n in sizes], note))
    return found


def _annotation(kind: str, name: str, sizes: list[int], note: str, classes: dict[str, str]) -> str:
    if sizes:
        inner = _annotation(kind, name, sizes[1:], note, classes)
        return f"tuple[{inner}, ...]" if sizes[0] > 4 else f"tuple[{', '.join([inner] * sizes[0])}]"
    if kind == "bvx_lattice":
        return '"Lattice"'
    if name in ("sign", "fill", "fill_reason"):  # rules, by name
        return "str"
    if name == "distance":  # where it was measured
        return f"{classes[kind]} | None"
    return classes.get(kind) or ("bool" if kind == "int32_t" and note.startswith("1: ") else _TYPES[kind])


def _note(note: str, sizes: list[int]) -> str:
    return note.removeprefix("1: ").replace("\\", "") if not sizes else note


def reports(header: Path) -> str:
    """A module of one named tuple for each struct that calls fill, with the header's words on each field."""
    text = _text(header)
    structs = re.findall(r"^typedef struct (bvx_\w+) \{\n(.*?)^\} \1;", text, flags=re.M | re.S)
    wanted = [(name, body) for name, body in structs if name.endswith("_report") or name in _REPORTS]
    classes = {name: _REPORTS.get(name) or "".join(w.capitalize() for w in name.split("_")[1:]) for name, _ in wanted}
    lines = ['"""What calls report: named tuples of numbers, with the fields of the C header\'s structs.', "",
             'Made from the header when the package is built."""', "", "from typing import TYPE_CHECKING, Any, NamedTuple", "",
             "if TYPE_CHECKING:", "    from ._lattice import Lattice", ""]
    for name, body in wanted:
        members = _members(body)
        lines += ["", f"class {classes[name]}(NamedTuple):", f'    """``{name}`` of the C header.', "", "    Attributes", "    ----------"]
        lines += [line for _, member, sizes, note in members for line in (f"    {member}", f"        {_note(note, sizes)}".rstrip()) if line.strip()]
        lines += ['    """', ""]
        lines += [f"    {member}: {_annotation(kind, member, sizes, note, classes)}" for kind, member, sizes, note in members]
        lines.append("")
    lines += ["", "BY_STRUCT: dict[str, Any] = {", *(f'    "{name}": {kind},' for name, kind in classes.items()), "}", "", "",
              "def report_class(struct: str) -> Any:", '    """The class of a struct by its name in C."""', "    return BY_STRUCT[struct]", "", "",
              "__all__ = [", *(f'    "{name}",' for name in sorted(classes.values())), "]", ""]
    return "\n".join(lines)


def cdef(header: Path) -> str:
    """The declarations of all that can be called."""
    text = declarations(header)
    for name in missing(header):
        text = re.sub(rf"^[^\n;{{}}]*\b{name}\([^;]*;", "", text, flags=re.M)
    return text
