"""NRRD files whose samples gzip or bzip2 has packed become the same file without."""

from __future__ import annotations

import bz2
import math
import re
import zlib
from typing import Any

from ._errors import FormatError, MemoryLimitError

_PACKED = re.compile(rb"^(encoding:\s*)(gzip|gz|bzip2|bz2)\s*?(?=\r?$)", re.M | re.I)
_ELSEWHERE = re.compile(rb"^(?:data ?file|line ?skip|byte ?skip):", re.M | re.I)
_SIZES = re.compile(rb"^sizes:([ \t\d]+)\r?$", re.M | re.I)
_LARGEST_SAMPLE = 8


def unpacked(data: Any, limit: int | None = None, kept: bytes = b"") -> Any:
    """The bytes of an .nrrd with its samples unpacked; ``data`` itself where they are not packed in it, or by what begins with ``kept``.

    Raises
    ------
    FormatError
        the packed samples are damaged.
    MemoryLimitError
        they hold more than ``limit`` bytes.
    """
    begin = bytes(data[: 1 << 16])  # heads are short, samples may be large
    end = re.search(rb"\r?\n\r?\n", begin)
    head = begin[: end.end()] if end else b""
    sizes = _SIZES.search(head)
    # Lines or bytes to skip, and samples in other files, are the library's to refuse.
    found = _PACKED.search(head)
    if not head.startswith(b"NRRD") or sizes is None or found is None or _ELSEWHERE.search(head) or (kept and found[2].lower().startswith(kept)):
        return data

    # What the head says bounds what is unpacked, so that a few bytes cannot take all memory.
    most = math.prod(int(n) for n in sizes[1].split()) * _LARGEST_SAMPLE + 1
    if limit is not None:
        most = min(most, limit + 1)
    unpack: Any = bz2.BZ2Decompressor() if found[2].lower().startswith(b"b") else zlib.decompressobj(15 + 32)  # the head of gzip or zlib
    try:
        plain = unpack.decompress(bytes(data[len(head) :]), min(most, 2**62))
    except (zlib.error, OSError) as why:
        raise FormatError("NRRD: the packed samples are damaged") from why
    if limit is not None and len(plain) > limit:
        raise MemoryLimitError(f"NRRD: the unpacked samples hold more than the {limit} bytes of memory_limit")
    if not unpack.eof:
        raise FormatError("NRRD: the packed samples are cut short, or more than the sizes say")
    return _PACKED.sub(rb"\1raw", head) + plain
