"""Bytes of files: read whole, and written whole or not at all."""

from __future__ import annotations

import os
import tempfile
from typing import Any, Callable

from ._calls import call
from ._errors import ArgumentError, Error, MemoryLimitError


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
    return within(call("unpacking", data, os.fspath(path))) if packed else data


def by_file(data: Any, kind: str, read: Callable[[str], Any]) -> Any:
    """What ``read`` makes of a file with these bytes, for libraries that read files only; messages do not name it."""
    with tempfile.TemporaryDirectory(prefix="bitvox-", ignore_cleanup_errors=True) as folder:
        path = os.path.join(folder, f"bytes.{kind}" + (".gz" if bytes(data[:2]) == b"\x1f\x8b" else ""))
        with open(path, "wb") as file:
            file.write(data)
        try:
            return read(path)
        except Error as why:
            raise type(why)(str(why).replace(path, f"the bytes of a .{kind}")) from None


def bytes_of_open(file: Any, format: str | None) -> tuple[bytes, str]:
    """What stands in an open file, from where it is to its end, and in which format."""
    name = getattr(file, "name", None)
    if format is None and not isinstance(name, (str, os.PathLike)):
        raise ArgumentError("an open file without a name: give format=, such as 'stl'")
    data = file.read()
    if isinstance(data, str):
        raise TypeError("the file is open as text; open it with mode 'rb'")
    return data, format_of(os.fspath(name) if isinstance(name, (str, os.PathLike)) else "", format)


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
            folder = os.path.dirname(path)
            why = "no file can be made in this folder" if os.path.isdir(folder) else "there is no such folder"
            raise FileNotFoundError(2, why, folder) from None


def umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
