"""What other programs read though its format does not allow it: text of UTF-16, and lines of a PLY's head that are notes without the word "comment"."""

from __future__ import annotations

import warnings
from typing import Any

from ._errors import FormatError

_TEXTS = ("obj", "off", "stl", "ply", "csv", "xyz")
_PLY_WORDS = (b"ply", b"format", b"comment", b"obj_info", b"element", b"property", b"end_header")


def mended(data: Any, kind: str) -> Any:
    """The bytes as the format wants them; ``data`` itself, without a copy, where they are."""
    begin = bytes(data[:3])
    if kind in _TEXTS and begin[:2] in (b"\xff\xfe", b"\xfe\xff"):
        try:
            return bytes(data).decode("utf-16").encode("utf-8")
        except UnicodeDecodeError as why:
            raise FormatError(f"{kind.upper()}: it begins as text of UTF-16 and is not: {why.reason} at byte {why.start}") from None
    return _ply(data) if kind == "ply" and begin == b"ply" else data


def _ply(data: Any) -> Any:
    """Without lines of the head whose first word is not one of PLY's."""
    start = bytes(data[: 1 << 16])
    end = start.find(b"end_header")
    if end < 0:
        return data
    lines = start[:end].splitlines(keepends=True)
    known = [line for line in lines if not line.strip() or line.split(None, 1)[0] in _PLY_WORDS]
    if len(known) == len(lines):
        return data
    odd = next(line for line in lines if line not in known)
    count = len(lines) - len(known)
    warnings.warn(f"PLY: skipped {count} header line{'s' if count > 1 else ''} without a keyword, the first {odd.strip()[:40].decode('latin-1')!r}", stacklevel=4)
    return b"".join(known) + bytes(data[end:])
