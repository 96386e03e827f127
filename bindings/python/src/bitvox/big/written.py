"""Pieces as files of others: one PLY or STL, a file a piece, and the meshes of Neuroglancer. One piece is held at a time."""

from __future__ import annotations

import itertools
import json
import os
import shutil
import struct
import tempfile
from typing import TYPE_CHECKING, Any, BinaryIO, Iterator, Sequence

from .. import _arrays as arrays
from .._errors import ArgumentError, RangeError, need
from .._files import dumps
from .._run import in_range
from .chunks import Chunks, Index, planes
from .disk import beside, compute, files, put, read_bodies, read_piece, whole

if TYPE_CHECKING:
    from .pieces import Pieces


def save(pieces: Pieces, path: str | os.PathLike[str], level: int, label: int | None) -> None:
    """A single file, which is there when it is whole."""
    name = os.fspath(path)
    write = {".ply": _ply, ".stl": _stl}.get(os.path.splitext(name)[1].lower())
    if write is None:
        raise ArgumentError(f"{name}: pieces are written as one .ply or .stl")
    folder, own = os.path.split(os.path.abspath(name))
    with whole(folder, own) as file:
        write(pieces, level, label, file)


def _stl(pieces: Pieces, level: int, label: int | None, file: BinaryIO) -> None:
    total = 0
    file.write(bytes(84))
    for mesh in pieces.meshes(level, label=label):
        file.write(dumps(mesh, "stl")[84:])
        total += mesh.n_faces
    file.seek(80)
    file.write(struct.pack("<I", total))


def _ply(pieces: Pieces, level: int, label: int | None, file: BinaryIO) -> None:
    """Vertices on cuts are those of the piece that came first; no more than two layers of pieces can share one."""
    np, total, triangles, layer = arrays.numpy("bitvox.big"), 0, 0, -1
    above: dict[bytes, int] = {}
    here: dict[bytes, int] = {}
    near = [edge / 8 for edge in pieces.spacing]
    kind = np.dtype("f8" if any(mesh.vertices.itemsize == 8 for mesh in itertools.islice(pieces.meshes(level, label=label), 1)) else "f4")
    file.write(_ply_head(kind, 0, 0))
    with tempfile.TemporaryFile(dir=os.path.dirname(file.name)) as corners:
        for index in pieces._held(level, label):
            mesh = pieces.read(index, level, label)
            if index[2] != layer:
                above, here, layer = here if index[2] == layer + 1 else {}, {}, index[2]
            at, number = np.ascontiguousarray(mesh.vertices, kind), np.full(mesh.n_vertices, -1)
            low, high = planes(pieces.chunks, level, index)
            cut = np.nonzero(((at < np.add(low, near)) | (at > np.subtract(high, near))).any(axis=1))[0].tolist()
            keys = {v: at[v].tobytes() for v in cut}
            for v, key in keys.items():
                here[key] = number[v] = here.get(key, above.get(key, -1))
            new = number < 0
            number[new] = np.arange(total, total + new.sum())
            here.update((key, int(number[v])) for v, key in keys.items())
            total, triangles = total + int(new.sum()), triangles + mesh.n_faces
            rows = np.empty(mesh.n_faces, np.dtype([("n", "u1"), ("v", "<u4", 3)]))
            rows["n"], rows["v"] = 3, number[np.asarray(mesh.faces)]
            file.write(at[new].astype(kind.newbyteorder("<")).tobytes())
            corners.write(rows.tobytes())
        if total > 2**32:
            raise RangeError(f"{total} vertices are more than a PLY with indices of 32 bits holds; take a coarser level")
        corners.seek(0)
        shutil.copyfileobj(corners, file, 2**20)
    file.seek(0)
    file.write(_ply_head(kind, total, triangles))


def _ply_head(kind: Any, vertices: int, triangles: int) -> bytes:
    """Of one length, whatever the counts are."""
    name = {4: "float", 8: "double"}[kind.itemsize]
    lines = [f"element vertex {vertices}", *(f"property {name} {axis}" for axis in "xyz"), f"element face {triangles}", "property list uchar uint vertex_indices", "end_header\n"]
    return "\n".join(["ply", "format binary_little_endian 1.0", "comment " + "-" * (40 - len(f"{vertices}{triangles}")), *lines]).encode()


def region(place: str, level: int, index: Index, folder: str, format: str) -> None:
    """A piece as a file of its own."""
    put(folder, f"{'_'.join(map(str, index))}.{format}", dumps(read_piece(place, level, index), format))


# ---- Neuroglancer's multi-resolution meshes ----
#
# Source: google/neuroglancer, src/datasource/precomputed/meshes.md and sharded.md. A fragment of level 0 is a piece; one of a coarser
# level holds 2 x 2 x 2 pieces, so no triangle crosses its middle planes. Positions are in voxels from the corner of the lattice.


def fragments(pieces: Pieces, level: int) -> dict[Index, list[Index]]:
    """The fragments of a level in the order of a Z-curve, and the pieces that each holds."""
    found: dict[Index, list[Index]] = {}
    halvings = level if pieces.chunks.shared else min(level, 1)
    for index in pieces.records[level]:
        found.setdefault(tuple(i >> halvings for i in index), []).append(index)  # type: ignore[arg-type]
    return {index: found[index] for index in sorted(found, key=_morton)}


def _morton(index: Index) -> int:
    return sum((n >> bit & 1) << (3 * bit + axis) for axis, n in enumerate(index) for bit in range(n.bit_length()))


def encode(source: str, cut: Chunks, level: int, index: Index, held: Sequence[Index], place: str, name: str, bits: int, segment: int) -> Any:
    """Write the fragments of a place, of all bodies in it one after another; their labels and bytes are returned. Vertices on cuts get equal numbers
    in the fragments beside them. What reaches half a voxel beyond the first centers, at the low sides of the whole, is put onto the side of
    the fragment."""
    np, draco = arrays.numpy("bitvox.big"), need("DracoPy", "big")
    size, most = np.multiply(cut.size, 2**level), 2**bits - 1
    begin, bodies, sizes = origin(cut) + np.multiply(index, size), dict[int, list[Any]](), list[int]()
    for one in held:
        for label, mesh in read_bodies(source, level, one)[0].items():
            bodies.setdefault(segment if label is None else label, []).append(mesh)
    # Numbers as floats whose quantization by Draco is the identity: the viewer takes what is below it, and unsigned integers it refuses.
    options = {"quantization_bits": bits, "quantization_range": most, "quantization_origin": (0, 0, 0), "compression_level": 7}
    with whole(place, name) as file:
        for label in sorted(bodies):
            mesh = beside(bodies[label])
            at = (mesh.in_world() - cut.lattice.corner) / cut.lattice.spacing
            x, y, z = np.clip(np.rint((at - begin) / size * most), 0, most).astype(np.uint64).T
            packed, number = np.unique(x << np.uint64(32) | y << np.uint64(16) | z, return_inverse=True)
            points = np.stack([packed >> np.uint64(32), packed >> np.uint64(16) & np.uint64(0xFFFF), packed & np.uint64(0xFFFF)], axis=1)
            corners = number[np.asarray(mesh.faces)].reshape(-1, 3)
            flat = (corners == np.roll(corners, 1, axis=1)).any(axis=1)
            data = draco.encode(points.astype(np.float32), corners[~flat].astype(np.uint32), **options) if not flat.all() else b""
            sizes.append(file.write(data))
    return np.array(sorted(bodies), np.uint64), np.array(sizes, np.int64)


def origin(cut: Chunks) -> Any:
    """Where the first fragment begins: as all cuts at centers of voxels, or at their sides."""
    return arrays.numpy("bitvox.big").add(cut.box.low, 0 if cut.shared else 0.5)


def manifest(pieces: Pieces, sizes: Sequence[dict[Index, int]]) -> bytes:
    """The index of a segment from the bytes of its fragments."""
    np, cut = arrays.numpy("bitvox.big"), pieces.chunks
    levels = len(sizes)
    head = [*map(float, cut.size), *origin(cut)]
    scales = [2.0**level for level in range(levels)]
    made = [struct.pack("<6fI", *head, levels), np.array([*scales, *[0.0] * 3 * levels], "<f4").tobytes(), np.array([len(one) for one in sizes], "<u4").tobytes()]
    for one in sizes:
        made += [np.array(list(one), "<u4").reshape(-1, 3).T.tobytes(), np.array(list(one.values()), "<u4").tobytes()]
    return b"".join(made)


def neuroglancer(pieces: Pieces, place: str, segment: int, bits: int, sharded: bool, nanometers: float, client: Any) -> None:
    if bits not in (10, 16):
        raise ArgumentError(f"bits is {bits}; it must be 10 or 16")
    need("DracoPy", "big")
    segment, count = in_range("segment", segment, 1, 2**64 - 1), len(pieces.records)
    labels = [in_range("label", label, 1, 2**64 - 1) for label in pieces.labels] or [segment]
    system, root = files(place)
    task, every = need("dask", "big").delayed(encode, pure=False), [fragments(pieces, level) for level in range(count)]
    names = [[f"{PARTS}/{level}_{'_'.join(map(str, index))}" for index in one] for level, one in enumerate(every)]
    try:
        made = compute([[task(pieces._own, pieces.chunks, level, index, every[level][index], place, name, bits, segment) for index, name in zip(every[level], names[level])]
                        for level in range(count)], client)
        bodies = _bodies(pieces, labels, every, made, lambda level, k: system.open(f"{root}/{names[level][k]}", "rb"))
        if sharded:
            with whole(place, "0.shard") as file:
                _shard(file, bodies)
        for label, parts, index in () if sharded else bodies:
            with whole(place, str(label)) as file:
                file.writelines(parts)
            put(place, f"{label}.index", index)
    finally:
        if system.exists(f"{root}/{PARTS}"):
            system.rm(f"{root}/{PARTS}", recursive=True)

    shard = {"@type": "neuroglancer_uint64_sharded_v1", "preshift_bits": 0, "hash": "identity", "minishard_bits": 0, "shard_bits": 0,
             "minishard_index_encoding": "raw", "data_encoding": "raw"}
    (a, b, c), (x, y, z) = ([n * nanometers for n in part] for part in (pieces.spacing, pieces.lattice.corner))
    info = {"@type": "neuroglancer_multilod_draco", "vertex_quantization_bits": bits, "transform": [a, 0, 0, x, 0, b, 0, y, 0, 0, c, z],
            "lod_scale_multiplier": 1, **({"sharding": shard} if sharded else {})}
    put(place, "info", json.dumps(info).encode())


PARTS = ".fragments"  # folder of what tasks wrote, until it is in files of bodies
OPEN = 64  # files that are open at a time


def _bodies(pieces: Pieces, labels: Sequence[int], every: Sequence[dict[Index, Any]], made: Sequence[Sequence[Any]], open_part: Any) -> Iterator[tuple[int, Iterator[bytes], bytes]]:
    """Each label, its fragments, and its index. Files of fragments have labels ascending, and so they are read from front to back."""
    np, index, held = arrays.numpy("bitvox.big"), [list(one) for one in every], dict[tuple[int, int], Any]()
    every_label, *table = map(np.concatenate, zip((np.zeros(0, np.uint64), *np.zeros((4, 0), np.int64)), *(
        (own, np.full(len(own), level), np.full(len(own), k), np.cumsum(sizes) - sizes, sizes) for level, one in enumerate(made) for k, (own, sizes) in enumerate(one))))
    order, rows = np.argsort(every_label, kind="stable"), np.stack(table, axis=1)
    ends = [np.searchsorted(every_label[order], np.array(labels, np.uint64), side).tolist() for side in ("left", "right")]

    def data(found: Any) -> Iterator[bytes]:
        for level, k, begin, size in found:
            if (level, k) not in held:
                if len(held) == OPEN:
                    held.pop(next(iter(held))).close()
                held[level, k] = open_part(level, k)
            held[level, k].seek(begin)
            yield held[level, k].read(size)

    try:
        for label, first, last in zip(labels, *ends):
            found = rows[order[first:last]].tolist()
            yield label, data(found), manifest(pieces, [{index[n][k]: size for n, k, _, size in found if n == level} for level in range(len(made))])
    finally:
        for file in held.values():
            file.close()


def _shard(file: BinaryIO, bodies: Iterator[tuple[int, Iterator[bytes], bytes]]) -> None:
    """One shard with one minishard, whose index is at the end. A body's fragments lie before its manifest; that is what the index tells of."""
    np, at, rows, before = arrays.numpy("bitvox.big"), 0, [], (0, 0)
    file.write(bytes(16))
    for label, parts, index in bodies:
        size = sum(map(file.write, parts))
        rows.append((label - before[0], at + size - before[1], len(index)))
        at += size + file.write(index)
        before = label, at
    table = np.array(rows, "<u8").T.tobytes()
    file.write(table)
    file.seek(0)
    file.write(struct.pack("<2Q", at, at + len(table)))

