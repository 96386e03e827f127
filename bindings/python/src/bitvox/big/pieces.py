"""Surfaces in pieces on disk, and coarser levels of them.

Pieces meet in cut planes, through centers of voxels. A level collapses between its cuts, whose vertices stay bit for bit from the finest
level on, so that pieces of one level and of different ones meet without cracks. The cuts between pieces are freed where the next level
joins them.
"""

from __future__ import annotations

import itertools
import json
import os
import time
import warnings
import zipfile
from typing import Any, Callable, Iterator, Sequence

from .. import _arrays as arrays
from .._errors import ArgumentError, FormatError, ResultWarning, need
from .._lattice import Lattice, Placed, Window, _lattice_from
from .._mesh import Mesh
from .._run import in_range, version
from .._stages import compare, merge
from .._words import FaceRule
from . import written
from .chunks import Chunks, Index, centers, indices, joins, planes
from .coarser import LEFT, SAMPLES, collapsed
from .disk import PART, Record, beside, compute, files, index_of, listed, name_of, put, read_bodies, read_piece, write_piece
from .labels import Labels, shared_bodies
from .plan import one_type
from .store import path_of
from .volume import Volume, surface_parts

warnings.filterwarnings("ignore", "the target of|a volume of", ResultWarning, "dask")  # of single pieces, in tasks


SMALL = 32  # voxels along the side of a chunk that is not halved


class Pieces(Placed):
    """A surface in pieces that `run` wrote, read one at a time. Level 0 is the finest: a piece a chunk. A piece of level 1 is one
    of a chunk too; on each level after it they have twice the side, unless labels share faces.

    Parameters
    ----------
    path
        the folder or URL.

    Attributes
    ----------
    chunks
        the `Chunks` of the volume.
    records
        for each level the `Record` of each piece that has triangles, by its index (x, y, z).

    Examples
    --------
    >>> volume = bitvox.big.voxelize('knot.ply', resolution=64, chunks=32)
    >>> pieces = bitvox.big.run(volume, 'knot', levels=3, show=None)
    >>> [len(level) for level in pieces.records], pieces.merge().check().closed, pieces.merge(2).check().closed
    ([4, 4, 1], True, True)
    """

    __slots__ = ("path", "chunks", "records", "_own")
    path: str
    _own: str  # folder of the pieces
    chunks: Chunks
    records: list[dict[Index, Record]]

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self.path = path_of(path)
        known = index_of(self.path)
        if known is None or "pieces" not in known:
            raise FormatError(f"{self.path} holds no finished pieces of bitvox.big.run")
        self._own = _folder(self.path, known)
        self.chunks = Chunks(_lattice_from(*known["lattice"]), known["size"], Window(*map(tuple, known["box"])), known.get("shared", False))
        self.records = [{tuple(map(int, name.split("_"))): Record(*record) for name, record in level.items()} for level in known["pieces"]]  # type: ignore[misc]

    @property
    def lattice(self) -> Lattice:
        """The lattice of the volume."""
        return self.chunks.lattice

    def _of(self, level: int) -> dict[Index, Record]:
        return self.records[in_range("level", level, 0, len(self.records) - 1)]

    @property
    def labels(self) -> list[int]:
        """Labels of all bodies, ascending; none of a volume without labels.

        Examples
        --------
        >>> labels = bitvox.big.Labels(np.arange(27).reshape(3, 3, 3) // 9)
        >>> bitvox.big.run(labels, 'bodies', show=None).labels
        [1, 2]
        """
        return sorted({label for record in self.records[0].values() for label in record.labels})

    def n_faces(self, level: int = 0) -> int:
        """Triangles of a level.

        Examples
        --------
        >>> volume = bitvox.big.voxelize('knot.ply', resolution=32, chunks=16)
        >>> bitvox.big.run(volume, 'a', show=None).n_faces() == bitvox.big.surface(volume).n_faces
        True
        """
        return sum(record.triangles for record in self._of(level).values())

    def error(self, level: int) -> float:
        """Largest distance of a level from the finest one, sampled [world].

        Examples
        --------
        >>> pieces = bitvox.big.run(bitvox.big.voxelize('knot.ply', resolution=32, chunks=16), 'a', levels=2, show=None)
        >>> 0 == pieces.error(0) < pieces.error(1) < 2 * max(pieces.spacing)
        True
        """
        return max((record.error for record in self._of(level).values()), default=0.0)

    def read(self, index: Index, level: int = 0, label: int | None = None) -> Mesh:
        """One piece.

        Parameters
        ----------
        index
            (x, y, z) of a piece of the level.
        level
            0 is the finest.
        label
            of the body; None: all of them.

        Examples
        --------
        >>> pieces = bitvox.big.run(bitvox.big.voxelize('knot.ply', resolution=32, chunks=16), 'a', show=None)
        >>> pieces.read((1, 0, 0)).n_faces == pieces.records[0][1, 0, 0].triangles
        True
        """
        if tuple(index) not in self._of(level):
            raise ArgumentError(f"level {level} has no triangles in piece {tuple(index)}")
        mesh = read_piece(self._own, level, index, label)
        if self.chunks.shared:
            mesh._keys = None  # not those of surfaces
        return mesh

    def meshes(self, level: int = 0, box: Sequence[Any] | None = None, label: int | None = None) -> Iterator[Mesh]:
        """The pieces of a level, one after another.

        Parameters
        ----------
        level
            0 is the finest.
        box
            ((x, y, z), (x, y, z)): only pieces whose bounds meet it [world].
        label
            of the body; None: all of them.

        Examples
        --------
        >>> pieces = bitvox.big.run(bitvox.big.voxelize('knot.ply', resolution=32, chunks=16), 'a', show=None)
        >>> sum(mesh.n_faces for mesh in pieces.meshes()) == pieces.n_faces()
        True
        """
        for index in self._held(level, label, box):
            yield self.read(index, level, label)

    def _held(self, level: int, label: int | None, box: Sequence[Any] | None = None) -> list[Index]:
        """Pieces that have triangles of a label, and bounds that meet a box."""
        return [index for index, record in self._of(level).items() if (label is None or label in record.labels)
                and (box is None or all(a <= q and p <= b for a, b, p, q in zip(record.low, record.high, *box)))]

    def _one(self, label: int | None) -> None:
        if (label is None) == bool(self.labels):
            raise ArgumentError("bodies that touch are not joined into one mesh; give label=" if label is None else "these pieces have no labels")

    def merge(self, level: int = 0, box: Sequence[Any] | None = None, label: int | None = None) -> Mesh:
        """Pieces as one mesh, where they fit into memory. All of level 0 are the bytes of `surface`.

        Parameters
        ----------
        level, box
            as for `meshes`; of a part the sides where it was cut are open.
        label
            of the body: needed where there are labels.

        Examples
        --------
        >>> volume = bitvox.big.voxelize('knot.ply', resolution=32, chunks=16)
        >>> bitvox.big.run(volume, 'a', show=None).merge() == bitvox.big.surface(volume)
        True
        """
        self._one(label)
        found = [read_piece(self._own, level, index, label) for index in self._held(level, label, box)]
        return _welded(found, self.chunks.shared) if level or self.chunks.shared or not found else merge(found)

    def save(self, path: str | os.PathLike[str], level: int = 0, label: int | None = None) -> None:
        """Write a level as one file, piece after piece.

        Parameters
        ----------
        path
            ends in .ply or .stl.
        level
            0 is the finest.
        label
            of the body: needed where there are labels.

        Examples
        --------
        >>> pieces = bitvox.big.run(bitvox.big.voxelize('knot.ply', resolution=32, chunks=16), 'a', show=None)
        >>> pieces.save('a.ply')
        >>> bitvox.read('a.ply').check().closed
        True
        """
        self._one(label)
        written.save(self, path, level, label)

    def save_regions(self, folder: str | os.PathLike[str], level: int = 0, *, format: str = "glb", client: Any = None) -> None:
        """Write each piece of a level as a file of its own, named by its index: ``1_0_2.glb``.

        Parameters
        ----------
        folder
            or a URL, that all workers reach.
        level
            0 is the finest.
        format
            of meshes, as for `bitvox.write`.
        client
            as for `run`.

        Examples
        --------
        >>> pieces = bitvox.big.run(bitvox.big.voxelize('knot.ply', resolution=32, chunks=16), 'a', show=None)
        >>> pieces.save_regions('regions')
        >>> bitvox.read('regions/1_0_0.glb').n_faces == pieces.read((1, 0, 0)).n_faces
        True
        """
        task = need("dask", "big").delayed(written.region, pure=False)
        compute([task(self._own, level, index, path_of(folder), format) for index in self._of(level)], client)

    def to_neuroglancer(self, folder: str | os.PathLike[str], *, segment: int = 1, bits: int = 16, sharded: bool = False,
                        nanometers: float = 1.0, client: Any = None) -> None:
        """Write all levels as Neuroglancer's precomputed multi-resolution mesh, by Draco, with its ``info``; needs DracoPy.

        Positions are rounded to a fragment's side over ``2**bits - 1``; fragments of a level then still join. A body that the low sides
        of the volume cut ends half a voxel further in.

        Parameters
        ----------
        folder
            or a URL, that all workers reach.
        segment
            id of the body, where there are no labels.
        bits
            of a position in its fragment, 10 or 16.
        sharded
            one file, ``0.shard``, in place of two of each body, ``1`` and ``1.index``.
        nanometers
            of one unit of the world.
        client
            as for `run`.

        Examples
        --------
        >>> import os
        >>> pieces = bitvox.big.run(bitvox.big.voxelize('knot.ply', resolution=32, chunks=16), 'a', levels=3, show=None)
        >>> pieces.to_neuroglancer('precomputed')
        >>> sorted(os.listdir('precomputed'))
        ['1', '1.index', 'info']
        """
        written.neuroglancer(self, path_of(folder), segment, bits, sharded, nanometers, client)

    def __repr__(self) -> str:
        return f"Pieces({', '.join(str(self.n_faces(level)) for level in range(len(self.records)))} faces in {self.chunks!r})"


def run(volume: Volume | Labels, path: str | os.PathLike[str], *, levels: int = 1, face_rule: FaceRule = "separate", dtype: Any = None,
        overwrite: bool = False, memory_limit: int | None = None, client: Any = None, show: Callable[[str], Any] | None = print) -> Pieces:
    """Write the surface of a volume in pieces, and coarser levels of it, each of a fourth of the triangles.

    Nothing is gathered here: tasks write pieces, and return what is known of them. A task holds its chunk and the pieces that it joins,
    so its memory depends on the chunk alone. A run that was stopped continues where it was, with the pieces whose hash is right. Where the
    memory of a task does not suffice, or a worker is killed again and again, all begins anew in chunks of half the sides.

    Parameters
    ----------
    volume
        its surface, or of `Labels` that of each body: alone, so that where three meet, gaps of less than a voxel stay between them, unless
        they have shared faces. Then levels are made from the voxels of each chunk, and vertices between chunks stay on all of them.
    path
        a folder or a URL that all workers reach.
    levels
        how many, with the finest.
    face_rule, dtype
        as for `surface`.
    overwrite
        begin anew where there are pieces of another volume or other options.
    memory_limit
        bytes that the library may take for one surface or level of a task.
    client
        of Dask's distributed. Default: the one that is active, or threads here.
    show
        called with the plan, from a timed sample of chunks, and with what came out of it; threads show Dask's bar too. None: silent.

    Returns
    -------
    Pieces
        All that was written.

    Raises
    ------
    FileExistsError
        the folder holds other things.
    MemoryError
        for chunks of 32 voxels, too.

    Examples
    --------
    >>> volume = bitvox.big.voxelize('knot.ply', resolution=32, chunks=16)
    >>> bitvox.big.run(volume, 'knot', levels=2, show=None)
    Pieces(6748, 1682 faces in Chunks(2 x 2 x 1 of 16 x 16 x 13))
    """
    place, count = path_of(path), in_range("levels", levels, 1, 24)
    options = one_type(volume.lattice, {"face_rule": face_rule, "dtype": dtype})
    job = need("dask.base", "big").tokenize(version(), volume, options)
    head = {"job": job, "lattice": volume.lattice._key(), "size": volume.chunks.size, "box": volume.chunks.box, "shared": volume.chunks.shared, "halved": 0}
    head["halved"] = _begin(place, head, overwrite)
    for halved in itertools.count(head["halved"]):
        size = [max(min(n, SMALL), n >> halved) for n in volume.chunks.size]
        cut = volume if halved == 0 else volume.rechunk(size)
        try:
            return _run(cut, place, {**head, "size": cut.chunks.size}, count, {**options, "memory_limit": memory_limit}, client, show)
        except Exception as error:
            # A worker that ran out of memory is killed by others, and says nothing.
            if not isinstance(error, MemoryError) and type(error).__name__ != "KilledWorker" or max(size) <= SMALL:
                raise
            if show:
                show(f"{_by(cut.chunks.size)} voxels a chunk are too many for the memory ({error}); again with half the sides")
            head["halved"] = halved + 1
            put(place, "index.json", json.dumps(head).encode())
    raise AssertionError


def _run(volume: Volume | Labels, place: str, head: dict[str, Any], count: int, options: dict[str, Any], client: Any, show: Callable[[str], Any] | None) -> Pieces:
    """Pieces of chunks as they are. Those of larger chunks may still be written by their tasks, into a folder of their own."""
    dask, cut, top, limit = need("dask", "big"), volume.chunks, place, options["memory_limit"]
    place = _folder(top, head)

    # Pieces that are there and whole, then tasks for the others; coarser ones take the records of those that they join. Of the finest
    # ones a few are made at once, as a sample.
    wanted = [(level, index) for level in range(count) for index in indices(cut, level)]
    files_there = listed(place)
    look, make, join = (dask.delayed(function, pure=False) for function in (_known, _made, _joined))
    there = [at for at in wanted if name_of(*at) in files_there]
    made: dict[Any, Any] = {at: record for at, record in zip(there, compute([look(place, *at) for at in there], client)) if record}
    old = len(made)
    if cut.shared and isinstance(volume, Labels):
        make = dask.delayed(_shared, pure=False, nout=count)
        for index, part in zip(cut, volume._around()):
            if any((level, index) not in made for level in range(count)):
                records = make(place, cut, index, part, volume.background, count, options)
                made.update({(level, index): records[level] for level in range(count)})
    for index, part in () if cut.shared else zip(cut, volume._bodies(options) if isinstance(volume, Labels) else surface_parts(volume, **options)):
        if (0, index) not in made:
            made[0, index] = make(place, index, part)
    if show:
        show(f"{_by(cut.box.size)} voxels in {len(cut)} chunks of {_by(cut.size)}; {count} levels, {len(wanted)} pieces, {old} of them there")
        _sample(cut, made, client, show)
    for level, index in wanted:
        if (level, index) not in made:
            made[level, index] = join(place, cut, level, index, [(i, made[level - 1, i]) for i in joins(cut, level, index)], limit)

    begin = time.perf_counter()
    records = dict(zip(wanted, compute([made[at] for at in wanted], client, bar=bool(show))))
    found = [{"_".join(map(str, i)): records[level, i] for level, i in wanted if level == k and records[level, i].triangles} for k in range(count)]
    put(top, "index.json", json.dumps({**head, "pieces": found}).encode())
    system, root = files(top)
    own = files(place)[1]
    for name in system.find(root):
        if name.endswith(PART) or not name.startswith(f"{own}/") and name.endswith(".npz"):  # of workers that were killed, or of larger chunks
            system.rm_file(name)
    pieces = Pieces(top)
    for level in range(count) if show else ():
        show(f"level {level}: {pieces.n_faces(level)} triangles in {len(found[level])} pieces, at most {pieces.error(level):.3g} from the finest")  # type: ignore[misc]
    if show:
        show(f"in {time.perf_counter() - begin:.0f} s")
    return pieces


def _sample(cut: Chunks, made: dict[Any, Any], client: Any, show: Callable[[str], Any]) -> None:
    """Make a few pieces, and say what all will take."""
    left = [index for index in cut if not isinstance(made[0, index], Record)]
    chosen = sorted({left[len(left) * k // 4] for k in (1, 2, 3)}) if left else []
    if not chosen:
        return
    begin = time.perf_counter()
    made.update(zip([(0, index) for index in chosen], compute([made[0, index] for index in chosen], client)))
    seconds = (time.perf_counter() - begin) / len(chosen)
    found = [made[0, index] for index in chosen]
    faces = sum(record.triangles for record in found) / len(chosen)
    bits = 3 * cut.size[0] * cut.size[1] * cut.size[2] / 8
    memory, disk = 2**27 + max(bits, 300 * max(record.triangles for record in found)), 40 * faces * len(cut)
    show(f"by {len(chosen)} chunks: {faces:.0f} triangles and {seconds:.2g} s each; {memory / 2**30:.2g} GiB a thread of a worker, "
         f"{disk / 2**30:.2g} GiB on the disk, about {seconds * len(left):.0f} s for the finest level")


def _welded(meshes: Sequence[Mesh], shared: bool = False) -> Mesh:
    """One mesh, its vertices at equal positions one; with keys of shared faces those of equal positions and keys, but of 0."""
    mesh = beside(meshes)
    np = arrays.numpy("bitvox.big")
    at = np.ascontiguousarray(mesh.vertices)
    rows = at.view(np.uint8).reshape(len(at), 3 * at.itemsize)
    if shared and mesh.keys:
        key = np.where(mesh.keys[0], mesh.keys[0], np.arange(len(at), dtype=np.uint64) + np.uint64(256))
        rows = np.concatenate([rows, key.view(np.uint8).reshape(len(at), 8)], axis=1)
    _, first, number = np.unique(rows.view(f"V{rows.shape[1]}").ravel(), return_index=True, return_inverse=True)
    return Mesh(at[first], number.astype(np.uint32)[mesh.faces])


# ---- what tasks do ----


def _made(place: str, index: Index, part: Mesh | Sequence[tuple[int, Mesh]]) -> Record:
    return write_piece(place, 0, index, {None: part} if isinstance(part, Mesh) else dict(part), 0.0)  # type: ignore[arg-type]


def _shared(place: str, cut: Chunks, index: Index, array: Any, background: int, count: int, options: dict[str, Any]) -> list[Record]:
    """All levels of a chunk of labels with shared faces, unless a sample has made them."""
    found, there = [_known(place, level, index) for level in range(count)], list[Record]()
    if all(found):
        return found  # type: ignore[return-value]
    fine, error = None, 0.0
    for level in range(count):
        triangles = max(1, fine.n_faces // LEFT**level) if fine else 0
        mesh, bodies = shared_bodies(array, cut, index, background, options, triangles)
        if fine is None:
            fine = mesh
        elif mesh.n_faces:
            gap: Any = compare(fine, mesh, samples=min(SAMPLES, mesh.n_faces), threads=1, memory_limit=options["memory_limit"])
            error = max(error, gap.max)
        there.append(write_piece(place, level, index, bodies, error))
    return there


def _joined(place: str, cut: Chunks, level: int, index: Index, parts: Sequence[tuple[Index, Record]], limit: int | None) -> Record:
    fine: dict[Any, list[Mesh]] = {}
    for i, record in parts:
        for label, mesh in read_bodies(place, level - 1, i)[0].items() if record.triangles else ():
            fine.setdefault(label, []).append(mesh)
    near, ends = [edge / 8 for edge in cut.lattice.spacing], planes(cut, level, index)
    made = {label: collapsed(beside(fine.pop(label)), *ends, near, limit, centers(cut)) for label in sorted(fine)}
    error = max((record.error for _, record in parts), default=0.0) + max((far for _, far in made.values()), default=0.0)
    return write_piece(place, level, index, {label: mesh for label, (mesh, _) in made.items()}, error)


def _known(place: str, level: int, index: Index) -> Record | None:
    """The record of a piece that is there, or None when it is not the mesh that the record says."""
    try:
        bodies, record = read_bodies(place, level, index)
    except (OSError, EOFError, ValueError, TypeError, KeyError, zipfile.BadZipFile):
        return None
    return record if not record.triangles or beside(list(bodies.values())).content_hash() == record.hash else None


def _folder(place: str, head: dict[str, Any]) -> str:
    return f"{place}/halved-{head['halved']}" if head["halved"] else place


def _begin(place: str, head: dict[str, Any], overwrite: bool) -> int:
    """A folder for the pieces of this job: an empty one, or that of a run that was stopped. Returns how often chunks were halved there."""
    system, root = files(place)
    known = index_of(place)
    ours = isinstance(known, dict) and "job" in known
    if ours and overwrite:
        system.rm(root, recursive=True)
    elif not ours and system.exists(root) and system.ls(root):
        raise FileExistsError(f"{place} holds other files")
    elif ours and known["job"] != head["job"]:
        raise FileExistsError(f"{place} holds pieces of another volume, or of other options; overwrite=True replaces them")
    if overwrite or not ours:
        put(place, "index.json", json.dumps(head).encode())
        return 0
    return int(known["halved"])


def _by(numbers: Sequence[int]) -> str:
    return " x ".join(map(str, numbers))
