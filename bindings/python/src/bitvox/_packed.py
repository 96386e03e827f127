"""Files packed by gzip; imported by the first of them."""

from __future__ import annotations

import gzip
import io
from typing import Any


def unpacking(data: bytes) -> Any:
    """A file of what ``data`` holds packed."""
    return gzip.GzipFile(fileobj=io.BytesIO(data))


def packed(data: bytes) -> bytes:
    """``data`` packed, without a time."""
    return gzip.compress(data, 6, mtime=0)
