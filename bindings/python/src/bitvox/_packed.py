"""Files packed by gzip; imported by the first of them."""

from __future__ import annotations

import gzip
import io
import zlib
from typing import Any

from ._errors import FormatError


class _Unpacking(gzip.GzipFile):
    """What is damaged or cut short is an error of ours, as of every other format."""

    def read(self, size: int | None = -1) -> bytes:
        try:
            return super().read(size)
        except (EOFError, OSError, zlib.error) as why:
            raise FormatError(f"{self.name or 'the packed bytes'}: gzip is damaged or cut short: {why}") from None


def unpacking(data: bytes, name: str = "") -> Any:
    """A file of what ``data``, of the file ``name``, holds packed."""
    return _Unpacking(name, fileobj=io.BytesIO(data))


def packed(data: bytes) -> bytes:
    """``data`` packed, without a time."""
    return gzip.compress(data, 6, mtime=0)
