"""Pieces on disk, or wherever fsspec reaches."""

from __future__ import annotations

import io
import json
import os
import threading
import uuid
from contextlib import contextmanager, nullcontext, suppress
from typing import Any, Iterator, NamedTuple, Sequence

from .. import _arrays as arrays
from .._errors import RangeError, need
from .._mesh import Mesh
from .chunks import Index


class Record(NamedTuple):
    """What is known of a piece.

    Attributes
    ----------
    vertices, triangles
        how many it has.
    low, high
        bounds [world].
    error
        largest distance from the finest level: sampled from level to level, and added [world].
    hash
        of its mesh: `Mesh.content_hash`.
    labels
        of the bodies in it, ascending; none of a volume without labels.

    Examples
    --------
    >>> bitvox.big.Record(3, 1, (0, 0, 0), (1, 1, 1), 0.5, 0).error
    0.5
    """

    vertices: int
    triangles: int
    low: Sequence[float]
    high: Sequence[float]
    error: float
    hash: int
    labels: Sequence[int] = ()


Bodies = dict["int | None", Mesh]  # what a piece has of each label; of a volume without labels one under None


def files(place: str) -> tuple[Any, str]:
    """The file system of a folder or URL, and its name there."""
    found: tuple[Any, str] = need("fsspec.core", "big").url_to_fs(place)
    return found


def name_of(level: int, index: Index) -> str:
    return f"{level}/{'_'.join(map(str, index))}.npz"


PART = ".part"  # ending of files that are not whole yet


@contextmanager
def whole(place: str, name: str) -> Iterator[Any]:
    """A file to write. On disks it is there whole or not at all: another name becomes its own at the end. Of a store of objects a write
    that was cut off may stay; pieces know it by their hash."""
    system, root = files(place)
    target = f"{root}/{name}"
    system.makedirs(target.rpartition("/")[0], exist_ok=True)
    beside = f"{target}.{uuid.uuid4().hex}{PART}" if isinstance(system, need("fsspec.implementations.local", "big").LocalFileSystem) else target
    try:
        with system.open(beside, "wb") as file:
            yield file
        if beside != target:
            os.replace(beside, target)
    except BaseException:
        if beside != target:
            with suppress(FileNotFoundError):
                os.unlink(beside)
        raise


def put(place: str, name: str, data: bytes) -> None:
    with whole(place, name) as file:
        file.write(data)


def beside(meshes: Sequence[Mesh]) -> Mesh:
    """All as one mesh, none of their vertices joined, with keys where all have them."""
    np = arrays.numpy("bitvox.big")
    begin = np.cumsum([0, *(mesh.n_vertices for mesh in meshes)])
    if begin[-1] >= 2**32:
        raise RangeError(f"{begin[-1]} vertices are more than one mesh holds; take a box, or a coarser level")
    if not meshes:
        return Mesh(np.zeros((0, 3), np.float32), np.zeros((0, 3), np.uint32))
    made = Mesh(np.concatenate([mesh.vertices for mesh in meshes]),
                np.concatenate([np.asarray(mesh.faces) + np.uint32(n) for mesh, n in zip(meshes, begin)]))
    keys = [mesh.keys for mesh in meshes]
    made._keys = tuple(map(np.concatenate, zip(*keys))) if all(keys) else None
    return made


def write_piece(place: str, level: int, index: Index, bodies: Bodies, error: float) -> Record:
    np = arrays.numpy("bitvox.big")
    bodies = {label: mesh for label, mesh in bodies.items() if mesh.n_faces}
    mesh, labels = beside(list(bodies.values())), [label for label in bodies if label is not None]
    record = Record(mesh.n_vertices, mesh.n_faces, *mesh.bounds, error, mesh.content_hash(), labels) if bodies else Record(0, 0, (0, 0, 0), (0, 0, 0), 0.0, 0)
    keys = mesh.keys or (np.zeros(0, np.uint64),) * 2
    ends = np.cumsum([(one.n_vertices, one.n_faces) for one in bodies.values()] or [(0, 0)], axis=0)
    data = io.BytesIO()
    np.savez(data, vertices=mesh.vertices, faces=mesh.faces, vertex_keys=keys[0], face_keys=keys[1], ends=ends, record=json.dumps(record))
    put(place, name_of(level, index), data.getbuffer())  # type: ignore[arg-type]
    return record


# Heads of arrays are literals of Python to numpy, which threads of Python 3.11 may not read side by side: their depth is counted once for all.
HEADS = threading.Lock()


def read_bodies(place: str, level: int, index: Index) -> tuple[Bodies, Record]:
    np, made = arrays.numpy("bitvox.big"), dict[Any, Mesh]()
    system, root = files(place)
    with system.open(f"{root}/{name_of(level, index)}", "rb") as file:
        data = file.read()
    with HEADS, np.load(io.BytesIO(data)) as held:
        record, begin = Record(*json.loads(str(held["record"]))), (0, 0)
        at, faces, keys = held["vertices"], held["faces"], (held["vertex_keys"], held["face_keys"])
        labels: list[int | None] = [*record.labels] or [None]
        for label, end in zip(labels, held["ends"]):
            (v, f), (w, g) = begin, end
            made[label] = Mesh(at[v:w], faces[f:g] - np.uint32(v))
            if len(keys[0]):
                made[label]._keys = keys[0][v:w], keys[1][f:g]
            begin = end
    return made, record


def read_piece(place: str, level: int, index: Index, label: int | None = None) -> Mesh:
    """A piece, or what it has of a label."""
    bodies, _ = read_bodies(place, level, index)
    return beside([mesh for one, mesh in bodies.items() if label in (None, one)])


def compute(tasks: Any, client: Any, bar: bool = False) -> Any:
    """What tasks return: by a client of Dask's distributed, or by what is active."""
    with need("dask.diagnostics", "big").ProgressBar() if bar else nullcontext():
        return need("dask", "big").compute(tasks, **({} if client is None else {"scheduler": client}))[0]


def index_of(place: str) -> Any:
    system, root = files(place)
    try:
        return json.loads(system.cat_file(f"{root}/index.json"))
    except FileNotFoundError:
        return None


def listed(place: str) -> set[str]:
    system, root = files(place)
    return {"/".join(name.split("/")[-2:]) for name in system.find(root)}
