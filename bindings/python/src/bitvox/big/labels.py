"""Labels in chunks on Dask: segmentations that do not fit into memory."""

from __future__ import annotations

import operator
from typing import Any, Sequence

from .. import _arrays as arrays
from .._errors import ArgumentError, need
from .._grid import Grid
from .._lattice import Lattice, Placed
from .._mesh import Mesh
from .._run import SIDES, in_range, lib
from .._stages import surface
from .._volume import Volume as WholeVolume
from .chunks import Chunks, Index
from .samples import Samples
from .volume import Volume, from_dask


class Labels(Placed):
    """A volume of whole numbers in chunks, one a body, nothing of it computed before it is requested. `run` writes all bodies in pieces.

    Parameters
    ----------
    array
        a Dask array [x, y, z] of integers to 64 bits, or `Samples` of such.
    lattice
        where it lies. Default: corner 0, spacing 1.
    background
        the number that is no body.
    chunks
        voxels of a task along each axis; None: the array's own.
    shared
        bodies that touch have the same faces there, smoothed, as those of `bitvox.Volume.surfaces`, on each level. Chunks have two voxels and more.

    Attributes
    ----------
    chunks
        the `Chunks` of its lattice.
    background, shared
        as given.

    Examples
    --------
    >>> import dask.array
    >>> labels = bitvox.big.Labels(dask.array.arange(27, chunks=27).reshape(3, 3, 3) // 9, chunks=2)
    >>> labels.counts()
    {1: 9, 2: 9}
    >>> bitvox.big.run(labels, 'bodies', show=None).merge(label=2).check().closed
    True
    """

    __slots__ = ("_samples", "chunks", "background", "shared")
    _samples: Samples
    chunks: Chunks
    background: int
    shared: bool

    def __init__(self, array: Any, lattice: Lattice | None = None, *, background: int = 0, chunks: int | Sequence[int] | None = None,
                 shared: bool = False) -> None:
        samples = array if isinstance(array, Samples) and lattice is None else Samples(getattr(array, "array", array), lattice)
        if samples.array.dtype.kind not in "iub":
            raise ArgumentError(f"array has samples of {samples.array.dtype}; labels are integers")
        cut = samples._cut(chunks)
        if shared and any(count > 1 and min(size, n - size * (count - 1)) < 2 for size, count, n in zip(cut.size, cut.counts, cut.box.size)):
            raise ArgumentError(f"{cut!r} leave a layer of one voxel, where shared faces cannot be joined; take other chunks")
        self._samples, self.shared, self.background = samples, shared, in_range("background", background, -(2**63), 2**64 - 1)
        self.chunks = Chunks(cut.lattice, cut.size, cut.box, shared)

    @property
    def array(self) -> Any:
        """The Dask array."""
        return self._samples.array

    @property
    def lattice(self) -> Lattice:
        """The lattice whose voxels have the labels."""
        return self.chunks.lattice

    def counts(self) -> dict[int, int]:
        """Voxels of each label, ascending, without the background; computes.

        Examples
        --------
        >>> import dask.array
        >>> bitvox.big.Labels(dask.array.ones((4, 4, 4), chunks=2, dtype='uint64')).counts()
        {1: 64}
        """
        dask, np = need("dask", "big"), arrays.numpy("bitvox.big")
        look = dask.delayed(_counts, pure=True)
        labels, counts = map(np.concatenate, zip(*dask.compute(*[look(self._samples._window(*self.chunks.window(i))) for i in self.chunks])))
        found, number = np.unique(labels, return_inverse=True)
        total = np.zeros(len(found), np.int64)
        np.add.at(total, number, counts)
        return {label: count for label, count in zip(found.tolist(), total.tolist()) if label != self.background}

    def volume(self, label: int) -> Volume:
        """The voxels of one label.

        Examples
        --------
        >>> import dask.array
        >>> bitvox.big.Labels(dask.array.ones((4, 4, 4), chunks=2, dtype='uint64')).volume(1).count()
        64
        """
        return from_dask(self.array == in_range("label", label, -(2**63), 2**64 - 1), self.lattice, chunks=self.chunks.size)

    def rechunk(self, chunks: int | Sequence[int]) -> Labels:
        """The same labels in other ``chunks``: voxels along each axis, one number or three.

        Examples
        --------
        >>> bitvox.big.Labels(np.ones((4, 4, 4), int), chunks=4).rechunk(2).chunks.counts
        (2, 2, 2)
        """
        return Labels(self._samples, background=self.background, chunks=chunks, shared=self.shared)

    def _around(self) -> list[Any]:
        """For each chunk its voxels and one more on each side where there are others."""
        return [self._samples._window(*self.chunks.grown(i, (1, 1, 1))) for i in self.chunks]

    def _bodies(self, options: dict[str, Any]) -> list[Any]:
        """For each chunk its part of the surface of each label in it."""
        made = need("dask", "big").delayed(_bodies_of, pure=True)
        cut = self.chunks
        return [made(self._samples._window(*cut.cells(i)[0]), cut, i, self.background, options) for i in cut]

    def __dask_tokenize__(self) -> Any:
        return type(self).__name__, self.array.name, self.lattice._key(), self.chunks.size, self.background, self.shared

    def __repr__(self) -> str:
        return f"Labels({self.array.dtype}, {self.chunks!r})"


def _runs(flat: Any, row: int) -> Any:
    """Where runs of one number begin in rows of a length, one after another."""
    np = arrays.numpy("bitvox.big")
    begins = np.ones(flat.size, bool)
    np.not_equal(flat[1:], flat[:-1], out=begins[1:])
    begins[::row] = True
    return np.flatnonzero(begins)


def _counts(array: Any) -> tuple[Any, Any]:
    np, flat = arrays.numpy("bitvox.big"), array.ravel("K")
    first = _runs(flat, flat.size)
    labels, number = np.unique(flat[first], return_inverse=True)
    counts = np.zeros(len(labels), np.int64)
    np.add.at(counts, number, np.diff(first, append=flat.size))
    return labels, counts


def _boxes(array: Any, background: int) -> list[tuple[Any, Any, Any]]:
    """Each label of an array [z, y, x] with its lowest and highest voxel (x, y, z), by runs along rows."""
    np, (nz, ny, nx) = arrays.numpy("bitvox.big"), array.shape
    flat = array.ravel()
    first = _runs(flat, nx)
    last = np.append(first[1:], flat.size) - 1
    order = np.argsort(flat[first], kind="stable")
    labels, first, last = flat[first][order], first[order], last[order]
    group = np.flatnonzero(np.append(True, labels[1:] != labels[:-1]))
    y, z = first // nx % ny, first // (nx * ny)
    low = np.stack([np.minimum.reduceat(values, group) for values in (first % nx, y, z)], axis=1)
    high = np.stack([np.maximum.reduceat(values, group) for values in (last % nx, y, z)], axis=1)
    return [one for one in zip(labels[group], low, high) if int(one[0]) != background]


def shared_bodies(array: Any, cut: Chunks, index: Index, background: int, options: dict[str, Any], triangles: int = 0) -> tuple[Mesh, dict[Any, Mesh]]:
    """All faces of a chunk, each once, at most so many triangles; and the bodies of its labels, which share them. Keys of their vertices are
    equal where chunks meet in them, as positions are not alone: a cell may hold several vertices in one place. Others are 0."""
    np = arrays.numpy("bitvox.big")
    volume = WholeVolume(array.view("u1") if array.dtype == bool else array, lattice=cut.lattice, low=cut.grown(index, (1, 1, 1)).low)
    found = volume.surfaces(background=background, triangles=triangles, open=True, dtype=options["dtype"], threads=1, memory_limit=options["memory_limit"])
    c, whole, bodies = found._c, Mesh(found.complex.vertices, found.complex.faces), dict[Any, Mesh]()
    junctions, begin = arrays.array_at(c.junctions, "uint8", (whole.n_vertices,), c), np.arange(whole.n_vertices)
    if c.single:
        place = junctions & 127
    else:
        cells = arrays.array_at(c.cells, "uint64", (whole.n_vertices,), c)
        place = begin - np.maximum.accumulate(np.where(np.append(True, cells[1:] != cells[:-1])[: len(cells)], begin, 0))
    key = np.where(junctions & lib.BVX_ON_SEAM, place.astype(np.uint64) + np.uint64(1), np.uint64(0))

    first = arrays.array_at(c.first, "uint64", (c.label_count + 1,), c)
    listed = arrays.array_at(c.faces, "uint32", (int(first[-1]),), c)
    sides = arrays.array_at(c.sides, "uint32", (c.face_count, 2), c)
    corners = np.asarray(whole.faces).reshape(len(sides), 1 if c.single else 2, 3)
    for i, (value, mesh) in enumerate(found.items()):
        own = listed[int(first[i]) : int(first[i + 1])]
        behind = (sides[own, 0] == i)[:, None, None]
        turned = np.where(behind, corners[own], corners[own][:, :, [0, 2, 1]]).reshape(-1, 3)  # a body's faces look away from it
        of = np.zeros(mesh.n_vertices, np.int64)
        of[np.asarray(mesh.faces)] = turned
        mesh._keys = key[of], np.zeros(mesh.n_faces, np.uint64)
        bodies[value] = mesh
    return whole, bodies


def _bodies_of(array: Any, cut: Chunks, index: Index, background: int, options: dict[str, Any]) -> list[tuple[int, Mesh]]:
    """Of each label that is in a chunk its surface there, from a window about its voxels."""
    np, (window, sides) = arrays.numpy("bitvox.big"), cut.cells(index)
    values, made = np.ascontiguousarray(array.transpose(2, 1, 0)), []
    for label, low, high in _boxes(values, background):
        low, high = np.maximum(low - 1, 0), np.minimum(high + 2, window.size)
        part = values[tuple(slice(a, b) for a, b in zip(low[::-1], high[::-1]))] == label
        grid = Grid.from_numpy(part, order="zyx", lattice=cut.lattice, low=tuple(map(operator.add, window.low, low.tolist())))
        ends = [side for axis in range(3) for side, there in zip(SIDES[2 * axis :], (low[axis] == 0, high[axis] == window.size[axis])) if there]
        mesh = surface(grid, keys=True, open_sides=[side for side in ends if side in sides], threads=1, **options)
        if mesh.n_faces:
            made.append((int(label), mesh))
    return made
