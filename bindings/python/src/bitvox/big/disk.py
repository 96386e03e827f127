"""Pieces on disk, or wherever fsspec reaches."""

from __future__ import annotations

import io
import json
import os
import uuid
from contextlib import contextmanager, nullcontext, suppress
from typing import Any, Iterator, NamedTuple, Sequence

from .. import _arrays as arrays
from .._errors import need
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


def empty() -> Mesh:
    """No triangles."""
    np = arrays.numpy("bitvox.big")
    return Mesh(np.zeros((0, 3), np.float32), np.zeros((0, 3), np.uint32))


def write_piece(place: str, level: int, index: Index, mesh: Mesh | None, error: float) -> Record:
    np = arrays.numpy("bitvox.big")
    if mesh is None or not mesh.n_faces:
        mesh, record = empty(), Record(0, 0, (0, 0, 0), (0, 0, 0), 0.0, 0)
    else:
        record = Record(mesh.n_vertices, mesh.n_faces, *mesh.bounds, error, mesh.content_hash())
    keys = mesh.keys or (np.zeros(0, np.uint64),) * 2
    data = io.BytesIO()
    np.savez(data, vertices=mesh.vertices, faces=mesh.faces, vertex_keys=keys[0], face_keys=keys[1], record=json.dumps(record))
    put(place, name_of(level, index), data.getbuffer())  # type: ignore[arg-type]
    return record


def read_piece(place: str, level: int, index: Index) -> tuple[Mesh, Record]:
    np = arrays.numpy("bitvox.big")
    system, root = files(place)
    with system.open(f"{root}/{name_of(level, index)}", "rb") as file, np.load(file) as held:
        mesh = Mesh(held["vertices"], held["faces"])
        if len(held["vertex_keys"]):
            mesh._keys = held["vertex_keys"], held["face_keys"]
        return mesh, Record(*json.loads(str(held["record"])))


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
