"""Meshes that do not fit into memory: binary PLY and STL, their triangles sorted to columns of chunks on a disk.

A row of voxels along x depends on the triangles that its line meets, and on no others. So a column of chunks along x needs the triangles
of its own rows alone.
"""

from __future__ import annotations

import itertools
import json
import os
from contextlib import ExitStack
from typing import Any, Iterator

from .. import _arrays as arrays
from .._errors import ArgumentError, FormatError
from .._mesh import Mesh
from .._run import version
from .chunks import Chunks, Index
from .disk import index_of, put

BLOCK = 1 << 20  # triangles that are held at a time
TYPES = {"char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4", "float": "f4", "double": "f8",
         "int8": "i1", "uint8": "u1", "int16": "i2", "uint16": "u2", "int32": "i4", "uint32": "u4", "float32": "f4", "float64": "f8"}
BY_ROWS = ("parity", "nonzero")


class Triangles:
    """The triangles of a file, block by block."""

    path: str
    np: Any
    points: Any  # of a PLY: mapped, as corners are of all places
    rows: Any  # what a face is stored as; they lie from `begin` on, and are read: pages of a map would stay with the process
    begin: int
    count: int

    def __init__(self, path: str) -> None:
        self.path, self.np = path, arrays.numpy("bitvox.big")
        self.points: Any = None
        with open(path, "rb") as file:
            head = file.read(84)
        if head[:4] in (b"ply\n", b"ply\r"):
            self._ply()
        elif len(head) == 84 and 84 + 50 * int.from_bytes(head[80:], "little") == os.path.getsize(path):
            self.rows = self.np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("unused", "<u2")])
            self.begin, self.count = 84, int.from_bytes(head[80:], "little")
        else:
            raise FormatError(f"{path} is neither a binary PLY nor a binary STL, which alone are read in parts")

    def _ply(self) -> None:
        np, elements, order = self.np, list[Any](), None
        with open(self.path, "rb") as file:
            for line in itertools.islice(file, 1000):
                words = line.decode("latin-1").split()
                if words[:1] == ["format"]:
                    order = {"binary_little_endian": "<", "binary_big_endian": ">"}.get(words[1])
                elif words[:1] == ["element"]:
                    elements.append((words[1], int(words[2]), []))
                elif words[:1] == ["property"]:
                    elements[-1][2].append(words[1:])
                elif words == ["end_header"]:
                    break
            at = file.tell()
        if order is None or [name for name, _, _ in elements[:2]] != ["vertex", "face"]:
            raise FormatError(f"{self.path} is not a binary PLY with vertices and faces first; read in parts are no others")
        for name, count, properties in elements[:2]:
            fields: list[tuple[Any, ...]] = []
            for kind, *rest in properties:
                if kind == "list" and name == "face" and rest[2] in ("vertex_indices", "vertex_index"):
                    fields += [("count", order + TYPES[rest[0]]), ("corners", order + TYPES[rest[1]], 3)]
                elif kind == "list":
                    raise FormatError(f"{self.path} has a list of {rest[2]}, whose rows are of unknown length")
                else:
                    fields.append((rest[0], order + TYPES[kind]))
            rows = np.dtype(fields)
            if at + count * rows.itemsize > os.path.getsize(self.path):
                raise FormatError(f"{self.path} ends before its {count} rows of {name}, or has faces that are no triangles")
            if name == "vertex":
                self.points = np.memmap(self.path, rows, "r", at, (count,)) if count else np.zeros(0, rows)
            else:
                self.rows, self.begin, self.count = rows, at, count
            at += count * rows.itemsize

    def __iter__(self) -> Iterator[Any]:
        """Blocks (n, 3, 3) of corners."""
        np = self.np
        for first in range(0, self.count, BLOCK):
            block = np.fromfile(self.path, self.rows, min(BLOCK, self.count - first), offset=self.begin + first * self.rows.itemsize)
            corners = np.asarray(block["corners"])
            if self.points is not None:
                if (block["count"] != 3).any():
                    raise FormatError(f"{self.path} has faces that are no triangles")
                if len(self.points) <= corners.max(initial=0) or corners.min(initial=0) < 0:
                    raise FormatError(f"{self.path} has a corner beyond its {len(self.points)} vertices")
                some = self.points[corners.ravel()]
                corners = np.stack([some[axis] for axis in "xyz"], axis=-1).reshape(-1, 3, 3)
            if not np.isfinite(corners).all():
                raise FormatError(f"{self.path} has a vertex that is NaN or infinite")
            yield corners.astype(corners.dtype.newbyteorder("="))

    def bounds(self) -> tuple[list[float], list[float]]:
        low, high = [float("inf")] * 3, [float("-inf")] * 3
        for block in self:
            low, high = self.np.minimum(low, block.min(axis=(0, 1))), self.np.maximum(high, block.max(axis=(0, 1)))
        if not self.count:
            raise ArgumentError(f"{self.path} has no triangles")
        return list(map(float, low)), list(map(float, high))


def column_of(folder: str, index: Index) -> str:
    return os.path.join(folder, f"{index[1]}_{index[2]}.triangles")


def sort_triangles(source: Triangles, cut: Chunks, folder: str) -> None:
    """Each triangle to all columns whose rows it may meet: by its bounds, and a voxel more for rounding. What is there of the same file and
    lattice is taken."""
    np, known = source.np, os.stat(source.path)
    job = [version(), source.path, known.st_size, known.st_mtime_ns, repr(cut.lattice._key()), list(cut.size)]
    there = index_of(folder)
    if there == {"columns": job}:
        return
    if os.path.isdir(folder) and os.listdir(folder) and not (isinstance(there, dict) and "columns" in there):
        raise FileExistsError(f"{folder} holds other files")
    os.makedirs(folder, exist_ok=True)
    put(folder, "index.json", b'{"columns": null}')
    for name in os.listdir(folder):
        if name.endswith(".triangles"):
            os.unlink(os.path.join(folder, name))
    for block in source:
        ends = []
        for axis in (1, 2):
            rows = (np.stack([block[:, :, axis].min(axis=1), block[:, :, axis].max(axis=1)]) - cut.lattice.corner[axis]) / cut.lattice.spacing[axis]
            ends.append(np.clip(np.floor((rows + [[-1.5], [1.5]]) / cut.size[axis]), 0, cut.counts[axis] - 1).astype(int))
        (y0, y1), (z0, z1) = ends
        with ExitStack() as opened:
            for z in range(z0.min(), z1.max() + 1):
                layer = (z0 <= z) & (z <= z1)
                for y in range(y0.min(), y1.max() + 1):
                    chosen = block[layer & (y0 <= y) & (y <= y1)]
                    if len(chosen):
                        opened.enter_context(open(column_of(folder, (0, y, z)), "ab")).write(chosen.tobytes())
    put(folder, "index.json", json.dumps({"columns": job}).encode())


def column(folder: str, index: Index, dtype: Any) -> Mesh:
    """The triangles of a column, none of their corners joined."""
    np, name = arrays.numpy("bitvox.big"), column_of(folder, index)
    corners = np.fromfile(name, dtype).reshape(-1, 3) if os.path.exists(name) else np.zeros((0, 3), dtype)
    return Mesh(corners, np.arange(len(corners), dtype=np.uint32).reshape(-1, 3))


def kind_of(source: Triangles) -> str:
    """What corners are stored as."""
    return "f8" if source.points is not None and any(source.points.dtype[axis].itemsize == 8 for axis in "xyz") else "f4"


def by_rows(options: dict[str, Any]) -> dict[str, Any]:
    """Options under which a row needs its own triangles alone."""
    if options.get("mode", "solid") != "solid":
        return options
    if options.get("fill", "parity") not in BY_ROWS:
        raise ArgumentError(f"fill {options['fill']!r} looks at the whole mesh; with spill it is 'parity' (the default there) or 'nonzero'")
    return {"fill": "parity", **options}
