"""Samples in chunks on Dask: numbers of any type, their thresholds and the surfaces of their levels."""

from __future__ import annotations

import os
from typing import Any, Sequence

from .._errors import ArgumentError, need
from .._lattice import Lattice, Placed
from .._mesh import Mesh
from .._run import settings
from .._stages import merge
from .._volume import Volume as WholeVolume
from .._words import FaceRule
from .chunks import Chunks, Index, laid_out
from .store import array_of, path_of, state_of
from .volume import Volume


class Samples(Placed):
    """A volume of samples in chunks, nothing of it computed before it is requested: what `bitvox.Volume` is for one machine.

    Attributes
    ----------
    array
        a Dask array [x, y, z] of integers or floats.
    lattice
        the lattice whose voxels' centers the samples are.

    Examples
    --------
    >>> import dask.array
    >>> samples = bitvox.big.Samples(dask.array.ones((8, 8, 8), chunks=4))
    >>> samples.surface(0.5).check().closed, samples.threshold(0.5).count()
    (True, 512)
    """

    __slots__ = ("array", "lattice", "_stored")
    array: Any
    lattice: Lattice
    _stored: Any  # where a Zarr array is: path, place in its group, index along the axes before, state; and the sides of what is read alone

    def __init__(self, array: Any, lattice: Lattice | None = None) -> None:
        array = laid_out(array)
        where = Lattice(array.shape) if lattice is None else lattice
        if where.shape != tuple(array.shape):
            raise ArgumentError(f"array has shape {array.shape}, the lattice {where.shape}")
        self.array, self.lattice, self._stored = array, where, None

    def compute(self) -> WholeVolume:
        """The whole volume, here.

        Examples
        --------
        >>> import dask.array
        >>> bitvox.big.Samples(dask.array.ones((8, 8, 8), chunks=4)).compute()
        Volume(8 x 8 x 8, float64)
        """
        return WholeVolume(self.array.compute(), lattice=self.lattice)

    def _cut(self, chunks: int | Sequence[int] | None) -> Chunks:
        return Chunks(self.lattice, [sides[0] for sides in self.array.chunks] if chunks is None else chunks)

    def _window(self, low: Sequence[int], size: Sequence[int]) -> Any:
        """A part of the array as one delayed array, put together with x fastest, as files have it. A task reads what is stored in small
        chunks by itself: to have tasks for each of those, and others to put them together, takes the scheduler a kilobyte each."""
        if self._stored and all(2 * n <= m for n, m in zip(self._stored[1], size)):
            return need("dask", "big").delayed(_stored_part, pure=True)(*self._stored[0], tuple(low), tuple(size))
        part = self.array[tuple(slice(a, a + n) for a, n in zip(low, size))].transpose(2, 1, 0).rechunk(tuple(size)[::-1])
        return part.transpose(2, 1, 0).to_delayed().ravel()[0]

    def threshold(self, low: float = float("-inf"), high: float = float("inf"), *, chunks: int | Sequence[int] | None = None) -> Volume:
        """The voxels of `bitvox.Volume.threshold` of the whole.

        Parameters
        ----------
        low, high
            as there.
        chunks
            of the result; None: the array's own.

        Examples
        --------
        >>> import dask.array
        >>> bitvox.big.Samples(dask.array.arange(8, chunks=8).reshape(2, 2, 2)).threshold(3, 5).count()
        3
        """
        if low > high:
            raise ArgumentError(f"low is {low} and high is {high}: no sample is at or above the one and at or below the other")
        cut, made = self._cut(chunks), need("dask", "big").delayed(_threshold, pure=True)
        return Volume(cut, {i: made(self._window(*cut.window(i)), self.lattice, cut.window(i).low, low, high) for i in cut})

    def surface(self, level: float = 0.0, *, below: bool = False, face_rule: FaceRule = "separate", dtype: Any = "float64",
                local_frame: bool = False, chunks: int | Sequence[int] | None = None) -> Mesh:
        """The closed surface of a level: chunk by chunk on the workers, merged here.

        Parameters
        ----------
        level, below, face_rule, dtype, local_frame
            as for `bitvox.Volume.surface`.
        chunks
            samples of a task along each axis; None: the array's own chunks.

        Returns
        -------
        Mesh
            A `Mesh` with keys: the bytes of ``samples.compute().surface(level, keys=True, dtype=dtype)``.

        Examples
        --------
        >>> import dask.array
        >>> bitvox.big.Samples(dask.array.ones((6, 6, 6), chunks=3)).surface(0.5).check().closed
        True
        """
        options = {"below": below, "face_rule": face_rule, "dtype": dtype, "local_frame": local_frame}
        dask, cut = need("dask", "big"), self._cut(chunks)
        part = dask.delayed(_part, pure=True)
        return merge(dask.compute(*[part(self._window(*cut.cells(i)[0]), cut, i, float(level), options) for i in cut]))

    def __repr__(self) -> str:
        x, y, z = self.shape
        return f"Samples({x} x {y} x {z}, {self.array.dtype})"


def _stored_part(path: str, place: str, lead: tuple[int, ...], state: str, low: Sequence[int], size: Sequence[int]) -> Any:
    """A window [x, y, z] of a Zarr array; ``state`` is part of the task's name alone."""
    found = need("zarr", "big").open(path, mode="r")
    array = found[place] if place else found
    return array[lead + tuple(slice(a, a + n) for a, n in zip(low[::-1], size[::-1]))].transpose(2, 1, 0)


def _threshold(array: Any, lattice: Lattice, low: Any, least: float, most: float) -> Any:
    with settings(threads=1):
        return WholeVolume(array, lattice=lattice, low=low).threshold(least, most)


def _part(array: Any, cut: Chunks, index: Index, level: float, options: dict[str, Any]) -> Mesh:
    window, sides = cut.cells(index)
    return WholeVolume(array, lattice=cut.lattice, low=window.low).surface(level, keys=True, open_sides=sides, threads=1, **options)


def samples_from_zarr(path: str | os.PathLike[str], *, dataset: str | None = None, channel: int | Sequence[int] | None = None,
                      chunks: int | Sequence[int] | None = None) -> Samples:
    """Samples of OME-Zarr (0.4 and 0.5) or of a plain Zarr array [z, y, x].

    Parameters
    ----------
    path
        a folder or a URL that all workers reach.
    dataset
        of the group; None: the first, which is the finest.
    channel
        index along the axes before z, such as time and channel: one number for the last of them, or one for each.
    chunks
        samples of a task along each axis; None: the array's own chunks or shards.

    Examples
    --------
    >>> import zarr
    >>> array = zarr.open_array('s.zarr', mode='w', shape=(2, 8, 8, 8), chunks=(1, 4, 4, 4), dtype='float32')
    >>> bitvox.big.samples_from_zarr('s.zarr', channel=1)
    Samples(8 x 8 x 8, float32)
    """
    da = need("dask.array", "big")
    found, lattice, lead, place, _ = array_of(path, dataset, channel)
    pieces, state = (found.shards or found.chunks)[len(lead):], state_of(path)
    name = f"samples-{state}-{found.path.replace('/', '-')}"  # the same for the same files, so that a run can go on
    whole = da.from_array(found, chunks=(1,) * len(lead) + tuple(pieces), name=name)[lead or ...]
    array = whole.transpose(2, 1, 0)
    made = Samples(array if chunks is None else array.rechunk(Chunks(lattice, chunks).size), lattice)
    made._stored = (path_of(path), place, lead, state), found.chunks[len(lead):][::-1]
    return made
