"""Bytes of files: read whole, and written whole or not at all."""

from __future__ import annotations

import os
from typing import Any

from ._calls import call
from ._errors import ArgumentError, MemoryLimitError


def format_of(path: str, format: str | None) -> str:
    if format is not None:
        return format.lower().lstrip(".")
    name = path[:-3] if path.lower().endswith(".gz") else path
    ending = os.path.splitext(name)[1].lower().lstrip(".")
    if not ending and os.path.isdir(path):
        raise ArgumentError(f"{path} is a folder; bitvox.read_volume reads the folder of a DICOM series, everything else is in files")
    if not ending:
        raise ArgumentError(f"{path}: its name has no ending that gives the format; give format=")
    return ending


def read_bytes(path: str | os.PathLike[str], limit: int | None = None) -> bytes:
    """A file's bytes; those of .gz unpacked; at most ``limit`` of them, packed or unpacked."""
    def within(file: Any) -> bytes:
        found = file.read() if limit is None else file.read(limit + 1)
        if limit is not None and len(found) > limit:
            raise MemoryLimitError(f"{os.fspath(path)}: holds more than the {limit} bytes that memory_limit leaves for it")
        return found

    with open(path, "rb") as file:
        data = within(file)
    packed = data[:2] == b"\x1f\x8b" and os.fspath(path).lower().endswith(".gz")
    return within(call("unpacking", data)) if packed else data


def write_bytes(path: str | os.PathLike[str], data: Any) -> None:
    """Write a file whole or not at all: under another name beside it, then renamed; .gz is packed."""
    target = os.path.realpath(os.fspath(path))
    if target.lower().endswith(".gz"):
        data = call("packed", data)
    if os.path.exists(target) and not os.path.isfile(target):  # a pipe or a device
        with open(target, "wb") as file:
            file.write(data)
        return
    handle, beside = new_beside(target)
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(data)
        os.chmod(beside, os.stat(target).st_mode & 0o7777 if os.path.exists(target) else 0o666 & ~umask())
        os.replace(beside, target)
    except BaseException:
        os.unlink(beside)
        raise


def new_beside(path: str) -> tuple[int, str]:
    """A new file for this user alone in the folder of ``path``: its handle and its name."""
    while True:
        beside = os.path.join(os.path.dirname(path), f".bitvox-{os.urandom(6).hex()}")
        try:
            return os.open(beside, os.O_RDWR | os.O_CREAT | os.O_EXCL | getattr(os, "O_BINARY", 0) | getattr(os, "O_NOFOLLOW", 0), 0o600), beside
        except FileExistsError:
            continue
        except FileNotFoundError:
            raise FileNotFoundError(2, "there is no such folder", os.path.dirname(path)) from None


def umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
