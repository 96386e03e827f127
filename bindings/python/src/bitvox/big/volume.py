"""Grids in chunks on Dask."""

from __future__ import annotations

import math
import operator
import os
from typing import Any, Callable, Sequence

from .. import _arrays as arrays
from .._errors import ArgumentError, LatticeError, need
from .._grid import Grid, triple_of
from .._html import shown
from .._lattice import Lattice, Placed, Window, WindowLike
from .._mesh import Mesh
from .._run import settings
from .._stages import merge
from .._stages import surface as whole_surface
from .chunks import Chunks, Index, grown, in_halves, join, laid_out, overlap, window_of
from .parts import Found, found
from .plan import check_options, load, one_type, place_chunks, source_of, split_place, voxelize_window
from .stream import Triangles, by_rows, column, kind_of, sort_triangles
from .._words import Beyond, DistanceSide, FaceRule, FloatName, Reduce


class Volume(Placed):
    """A grid in chunks, nothing of it computed before it is requested.

    Operators: ``a | b``, ``a & b``, ``a - b``, ``a ^ b``, ``~a``, of volumes that share lattice and chunks (see `rechunk`), and with grids of
    that lattice and window. All methods give the bits and numbers of a single run, whatever the chunks are.

    Attributes
    ----------
    chunks
        the `Chunks` of its lattice.
    blocks
        for each chunk's index (x, y, z) a Dask delayed `Grid` (bits: an eighth of the array's bytes).

    Examples
    --------
    >>> volume = bitvox.big.voxelize('knot.ply', resolution=32, chunks=16)
    >>> (volume - volume.erode()).compute() <= volume.compute()
    True
    """

    __slots__ = ("chunks", "blocks")
    chunks: Chunks
    blocks: dict[Index, Any]

    def __init__(self, chunks: Chunks, blocks: dict[Index, Any]) -> None:
        self.chunks, self.blocks = chunks, blocks

    @property
    def lattice(self) -> Lattice:
        """The lattice that all chunks are windows of."""
        return self.chunks.lattice

    @property
    def box(self) -> Window:
        """The window of the lattice that the volume is: all of it, unless it was cropped."""
        return self.chunks.box

    @property
    def shape(self) -> tuple[int, int, int]:
        """Voxels along x, y, z."""
        return self.box.size

    @property
    def corner(self) -> tuple[float, float, float]:
        """Low corner of the first voxel [world]."""
        return self._grid().corner

    @property
    def center0(self) -> tuple[float, float, float]:
        """Center of the first voxel [world]."""
        return self._grid().center0

    @property
    def bounds(self) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
        """Low and high corner of all voxels: ((x, y, z), (x, y, z)) [world]."""
        low = self.corner
        return low, tuple(a + n * s for a, n, s in zip(low, self.shape, self.spacing))  # type: ignore[return-value]

    def _grid(self) -> Grid:
        """Its first voxel, empty: what is wrong with options is said by it at once."""
        return Grid(self.lattice, (self.box.low, (1, 1, 1)))

    @property
    def array(self) -> Any:
        """A Dask array of bool [x, y, z] whose chunks are those of the volume."""
        made = need("dask", "big").delayed(_as_array, pure=True)
        return _dask_array(self.chunks, {i: made(block) for i, block in self.blocks.items()}, "bool")

    def count(self) -> int:
        """Set voxels; computes.

        Examples
        --------
        >>> volume = bitvox.big.voxelize('knot.ply', resolution=32, chunks=16)
        >>> volume.count() == volume.compute().count
        True
        """
        dask = need("dask", "big")
        return sum(dask.compute(*[dask.delayed(_count, pure=True)(block) for block in self.blocks.values()]))

    def compute(self, **options: Any) -> Grid:
        """The whole grid, here: a bit a voxel; ``options`` are those of ``dask.compute``.

        Examples
        --------
        >>> volume = bitvox.big.voxelize('knot.ply', resolution=32, chunks=16)
        >>> volume.compute().shape[0]
        31
        """
        parts = need("dask", "big").compute(*self.blocks.values(), **options)
        return join(self.lattice, self.box, parts)

    def persist(self, **options: Any) -> Volume:
        """The same volume whose chunks are computed (and, on a cluster, stay on the workers); ``options`` are those of ``dask.persist``.

        Examples
        --------
        >>> volume = bitvox.big.voxelize('knot.ply', resolution=32, chunks=16)
        >>> len(volume.persist().blocks) == len(volume.chunks)
        True
        """
        return Volume(self.chunks, dict(zip(self.blocks, need("dask", "big").persist(*self.blocks.values(), **options))))

    # ---- Dask's collection protocol: dask.compute, persist, optimize and visualize take volumes ----

    def __dask_graph__(self) -> Any:
        merged: dict[Any, Any] = {}
        for block in self.blocks.values():
            merged.update(block.__dask_graph__())
        return merged

    def __dask_keys__(self) -> list[Any]:
        return [block.key for block in self.blocks.values()]

    def __dask_layers__(self) -> tuple[str, ...]:
        return tuple(name for block in self.blocks.values() for name in block.__dask_layers__())

    def __dask_tokenize__(self) -> Any:
        return type(self).__name__, self.lattice._key(), self.chunks.size, self.box, self.__dask_keys__()

    @staticmethod
    def __dask_optimize__(graph: Any, keys: Any, **options: Any) -> Any:
        """Tasks that nothing needs are left out."""
        return need("dask.optimization", "big").cull(dict(graph), [key for key in _flat(keys)])[0]

    @property
    def __dask_scheduler__(self) -> Any:
        return need("dask.threaded", "big").get

    def __dask_postcompute__(self) -> Any:
        return _whole, (self.lattice, self.box)

    def __dask_postpersist__(self) -> Any:
        return _persisted, (self.chunks, self.__dask_keys__())

    def _repr_html_(self) -> str:
        return shown(self, {"voxels": self.shape, "chunks": self.chunks.counts, "of": self.chunks.size, "spacing": self.lattice.spacing,
                            "corner": self.lattice.corner, "tasks": len(self.__dask_graph__())})

    def rechunk(self, chunks: int | Sequence[int]) -> Volume:
        """The same voxels in other ``chunks``: voxels along each axis, one number or three.

        Examples
        --------
        >>> volume = bitvox.big.voxelize('knot.ply', resolution=32, chunks=16)
        >>> volume.rechunk(32).chunks.counts
        (1, 1, 1)
        """
        return self._rejoined(Chunks(self.lattice, chunks, self.box))

    def crop(self, window: WindowLike) -> Volume:
        """The same lattice through another window: `Grid.crop`, in chunks of the same size that begin at its low corner.

        Parameters
        ----------
        window
            (low, size) of the lattice, which may reach beyond the volume's own, where all is empty.

        Examples
        --------
        >>> volume = bitvox.big.voxelize('knot.ply', resolution=32, chunks=16)
        >>> volume.crop(((8, 8, 4), (16, 9, 5))).compute() == volume.compute().crop(((8, 8, 4), (16, 9, 5)))
        True
        """
        return self._rejoined(Chunks(self.lattice, self.chunks.size, window_of(self.lattice, window)))

    def _rejoined(self, cut: Chunks) -> Volume:
        made = need("dask", "big").delayed(join, pure=True)
        return Volume(cut, {i: made(self.lattice, cut.window(i), _parts(self, cut.window(i))) for i in cut})

    def resample(self, lattice: Lattice, window: WindowLike = None, *, chunks: int | Sequence[int] | None = None) -> Volume:
        """The same set on another lattice: `Grid.resample` of the whole.

        Parameters
        ----------
        lattice, window
            as for `Grid.resample`.
        chunks
            of the result; None: as many voxels along each axis as the volume's have.

        Examples
        --------
        >>> volume = bitvox.big.voxelize('knot.ply', resolution=32, chunks=16)
        >>> half = bitvox.Lattice.fit('knot.ply', resolution=16)
        >>> volume.resample(half).compute() == volume.compute().resample(half)
        True
        """
        box = None if window is None else window_of(lattice, window)
        cut = Chunks(lattice, self.chunks.size if chunks is None else chunks, box)
        made, blocks = need("dask", "big").delayed(_resampled, pure=True), {}
        for i in cut:
            # a voxel more on either side: positions are rounded once on each lattice
            low, size = cut.window(i)
            ends = [[math.floor((c + (a + e) * s - o) / t) for c, a, e, s, o, t in zip(lattice.corner, low, end, lattice.spacing, self.lattice.corner, self.spacing)]
                    for end in ((0, 0, 0), size)]
            wide = overlap(Window(tuple(a - 1 for a in ends[0]), tuple(b - a + 3 for a, b in zip(*ends))), self.box)  # type: ignore[arg-type]
            blocks[i] = made(self.lattice, wide, _parts(self, wide) if wide else [], lattice, cut.window(i))
        return Volume(cut, blocks)

    # ---- set algebra ----

    def map(self, function: Callable[..., Grid], *others: Volume | Grid) -> Volume:
        """A volume of ``function(grid, ...)`` of each chunk and of the same chunk of ``others``, for local operations:
        ``a.map(operator.or_, b)``. Grids among them are sent in pieces, one a chunk.

        Examples
        --------
        >>> volume = bitvox.big.voxelize('knot.ply', resolution=32, chunks=16)
        >>> volume.map(lambda grid: ~grid).count() + volume.count() == 31 * 32 * 13
        True
        """
        dask = need("dask", "big")
        made = dask.delayed(function, pure=True)
        found = [self._beside(other) for other in others]
        return Volume(self.chunks, {i: made(block, *(o[i] for o in found)) for i, block in self.blocks.items()})

    def _beside(self, other: Volume | Grid) -> dict[Index, Any]:
        """Blocks of another operand."""
        if isinstance(other, Grid):
            if (other.lattice, other.low, other.shape) != (self.lattice, *self.box):
                raise LatticeError("the grid and the volume do not share lattice and window; crop or resample brings one to the other's")
            return {i: other.crop(self.chunks.window(i)) for i in self.chunks}
        if (other.lattice, other.chunks.size, other.box) != (self.lattice, self.chunks.size, self.box):
            raise ArgumentError("volumes do not share lattice and chunks; rechunk gives one the chunks of the other")
        return other.blocks

    def _combined(self, operation: Callable[..., Grid], other: Any) -> Volume:
        return self.map(operation, other) if isinstance(other, (Volume, Grid)) else NotImplemented

    def __or__(self, other: Any) -> Volume:
        return self._combined(operator.or_, other)

    def __and__(self, other: Any) -> Volume:
        return self._combined(operator.and_, other)

    def __sub__(self, other: Any) -> Volume:
        return self._combined(operator.sub, other)

    def __xor__(self, other: Any) -> Volume:
        return self._combined(operator.xor, other)

    def __rsub__(self, other: Any) -> Volume:
        return self._combined(_from_other, other)

    def __ror__(self, other: Any) -> Volume:
        return self._combined(operator.or_, other)

    def __rand__(self, other: Any) -> Volume:
        return self._combined(operator.and_, other)

    def __rxor__(self, other: Any) -> Volume:
        return self._combined(operator.xor, other)

    def __invert__(self) -> Volume:
        return self.map(operator.invert)

    # ---- growing, shrinking, distances: each chunk with a halo of its neighbors' voxels ----

    def around(self, function: Callable[..., Grid], margin: int | Sequence[int], *arguments: Any) -> Volume:
        """A volume of ``function(grid, *arguments)``, for operations that look at neighbors.

        Parameters
        ----------
        function
            takes a chunk with a halo, a `Grid` of a larger window; what it returns is cut to the chunk.
        margin
            voxels of the halo on either side, one number or three; the lattice's own sides end it.
        arguments
            passed on as they are.

        Examples
        --------
        >>> volume = bitvox.big.voxelize('knot.ply', resolution=32, chunks=16)
        >>> volume.around(bitvox.Grid.erode, 1).compute() == volume.compute().erode()
        True
        """
        made, halo = need("dask", "big").delayed(_around, pure=True), _margin(margin)
        return Volume(self.chunks, {i: made(function, arguments, self.lattice, halo, self.chunks.grown(i, halo), self.chunks.window(i),
                                            _parts(self, self.chunks.grown(i, halo))) for i in self.chunks})

    def _morphed(self, name: str, times: int, steps: int, **options: Any) -> Volume:
        one = self._grid()
        one.dilate(steps, **options)  # what is wrong with the options is said at once
        radius = options["radius"]
        reach = (steps,) * 3 if radius is None else _reach(self.lattice, radius)
        return self.around(_morph, [times * n for n in reach], name, (steps,), options)

    def dilate(self, steps: int = 1, *, connectivity: int = 6, radius: float | None = None, beyond: bool = False) -> Volume:
        """`Grid.dilate` of the whole, with a halo of ``steps`` voxels, or of the ``radius``, around each chunk.

        Parameters
        ----------
        steps, connectivity, radius, beyond
            as for `Grid.dilate`; ``beyond`` the lattice, that is.

        Examples
        --------
        >>> volume = bitvox.big.voxelize('knot.ply', resolution=32, chunks=16)
        >>> volume.dilate(2).compute() == volume.compute().dilate(2)
        True
        """
        return self._morphed("dilate", 1, steps, connectivity=connectivity, radius=radius, beyond=beyond)

    def erode(self, steps: int = 1, *, connectivity: int = 6, radius: float | None = None, beyond: bool = False) -> Volume:
        """`Grid.erode` of the whole; ``steps``, ``connectivity``, ``radius``, ``beyond`` and halo as for `dilate`.

        Examples
        --------
        >>> volume = bitvox.big.voxelize('knot.ply', resolution=32, chunks=16)
        >>> volume.erode().compute() <= volume.compute()
        True
        """
        return self._morphed("erode", 1, steps, connectivity=connectivity, radius=radius, beyond=beyond)

    def open(self, steps: int = 1, *, connectivity: int = 6, radius: float | None = None, beyond: bool = False) -> Volume:
        """`Grid.open` of the whole; ``steps``, ``connectivity``, ``radius``, ``beyond`` as for `dilate`, with twice its halo.

        Examples
        --------
        >>> volume = bitvox.big.voxelize('knot.ply', resolution=32, chunks=16)
        >>> volume.open().compute() == volume.compute().open()
        True
        """
        return self._morphed("open", 2, steps, connectivity=connectivity, radius=radius, beyond=beyond)

    def close(self, steps: int = 1, *, connectivity: int = 6, radius: float | None = None, beyond: bool = False) -> Volume:
        """`Grid.close` of the whole; ``steps``, ``connectivity``, ``radius``, ``beyond`` as for `dilate`, with twice its halo.

        Examples
        --------
        >>> volume = bitvox.big.voxelize('knot.ply', resolution=32, chunks=16)
        >>> volume.close().compute() == volume.compute().close()
        True
        """
        return self._morphed("close", 2, steps, connectivity=connectivity, radius=radius, beyond=beyond)

    def hollow(self, thickness: float, *, beyond: bool = False) -> Volume:
        """`Grid.hollow` of the whole, without a drain hole, which would have to look at all of it; the halo is the thickness.

        Parameters
        ----------
        thickness, beyond
            as for `Grid.hollow`.

        Examples
        --------
        >>> volume = bitvox.big.voxelize('knot.ply', resolution=32, chunks=16)
        >>> volume.hollow(0.3).compute() == volume.compute().hollow(0.3)
        True
        """
        self._grid().hollow(thickness)
        return self.around(_morph, _reach(self.lattice, thickness), "hollow", (thickness,), {"beyond": beyond})

    def distance(self, limit: float, side: DistanceSide = "outside", *, beyond: Beyond = "nothing", dtype: FloatName = "float32") -> Any:
        """A Dask array [x, y, z] of the distances of `Grid.distance`, exact up to a limit; what is farther is as far as the limit.

        A task sees its chunk and a halo of the limit, so it costs memory: a chunk of 256 with a limit of 64 voxels holds 384^3
        numbers for a while.

        Parameters
        ----------
        limit
            largest distance that is distinguished; above 0, and infinite only where one task may see the whole [world].
        side, beyond, dtype
            as for `Grid.distance`; ``beyond`` the lattice, that is. "signed": from -limit to limit.

        Examples
        --------
        >>> volume = bitvox.big.voxelize('knot.ply', resolution=32, chunks=16)
        >>> volume.distance(0.5).shape == volume.shape
        True
        """
        if not limit > 0:
            raise ArgumentError(f"limit is {limit}; it must be above 0")
        self._grid().distance(side, beyond=beyond, dtype=dtype)
        made, halo = need("dask", "big").delayed(_distances, pure=True), _reach(self.lattice, limit)
        blocks = {}
        for index in self.chunks:
            wide = self.chunks.grown(index, halo)
            blocks[index] = made(self.lattice, halo, wide, self.chunks.window(index), _parts(self, wide), limit,
                                 (side,), {"beyond": beyond, "dtype": dtype})
        return _dask_array(self.chunks, blocks, dtype)

    # ---- fewer, larger voxels ----

    def _blocks(self, factor: Any, rule: Reduce) -> tuple[Chunks, dict[Index, Any], tuple[int, ...]]:
        """The cut lattice of the result, for each of its chunks the window that it is made of, and the factors."""
        by = tuple(triple_of(factor))
        made = self._grid().downsample(by, rule)
        first = [a // f for a, f in zip(self.box.low, by)]
        box = Window(tuple(first), tuple((a + n - 1) // f - b + 1 for a, n, f, b in zip(*self.box, by, first)))  # type: ignore[arg-type]
        cut, windows = Chunks(made.lattice, [-(-n // f) for n, f in zip(self.chunks.size, by)], box), {}
        for index in cut:
            blocks = Window(*(tuple(a * f for a, f in zip(part, by)) for part in cut.window(index)))  # type: ignore[arg-type]
            windows[index] = overlap(blocks, self.box)
        return cut, windows, by

    def downsample(self, factor: Any, rule: Reduce = "any") -> Volume:
        """`Grid.downsample` of the whole; chunks keep their size in the world, rounded up to whole blocks.

        Parameters
        ----------
        factor, rule
            as for `Grid.downsample`.

        Examples
        --------
        >>> volume = bitvox.big.voxelize('knot.ply', resolution=32, chunks=16)
        >>> volume.downsample(2).shape
        (16, 16, 7)
        """
        cut, windows, by = self._blocks(factor, rule)
        made = need("dask", "big").delayed(_downsampled, pure=True)
        return Volume(cut, {i: made(self.lattice, window, _parts(self, window), by, rule) for i, window in windows.items()})

    def coverage(self, factor: Any) -> Any:
        """`Grid.coverage` of the whole: a Dask array [x, y, z] of uint32, in chunks as those of `downsample`.

        Parameters
        ----------
        factor
            as for `Grid.coverage`.

        Examples
        --------
        >>> volume = bitvox.big.voxelize('knot.ply', resolution=32, chunks=16)
        >>> int(volume.coverage(2).max().compute())
        8
        """
        cut, windows, by = self._blocks(factor, "any")
        made = need("dask", "big").delayed(_coverage, pure=True)
        return _dask_array(cut, {i: made(self.lattice, window, _parts(self, window), by) for i, window in windows.items()}, "uint32")

    # ---- connected parts: chunks find their own, and those that touch are joined ----

    def components(self, *, connectivity: int = 6) -> Any:
        """The connected parts: the record array of `Grid.components` of the whole; computes.

        Parameters
        ----------
        connectivity
            as for `Grid.components`.

        Examples
        --------
        >>> volume = bitvox.big.voxelize('knot.ply', resolution=32, chunks=16)
        >>> volume.components()['voxels'].tolist() == volume.compute().components()['voxels'].tolist()
        True
        """
        return found(self, connectivity).components

    def keep(self, *, largest: int | None = None, at_least: int = 0, connectivity: int = 6) -> Volume:
        """`Grid.keep` of the whole. Finding the parts computes the chunks once.

        Parameters
        ----------
        largest, at_least, connectivity
            as for `Grid.keep`.

        Examples
        --------
        >>> volume = bitvox.big.voxelize('knot.ply', resolution=32, chunks=16)
        >>> volume.keep(largest=1).compute() == volume.compute().keep(largest=1)
        True
        """
        self._grid().keep(largest=largest, at_least=at_least, connectivity=connectivity)
        known = found(self, connectivity)
        voxels = known.components["voxels"]
        chosen = voxels >= at_least
        if largest is not None:
            chosen[(-voxels.astype("i8")).argsort(kind="stable")[largest:]] = False  # the first ones of equal parts stay
        return self._kept(known, chosen, connectivity)

    def _kept(self, known: Found, chosen: Any, connectivity: int) -> Volume:
        """The chosen parts, each by a voxel of it in every chunk."""
        made = need("dask", "big").delayed(_kept, pure=True)
        return Volume(self.chunks, {i: made(block, known.seeds[i][chosen[known.labels[i][1:] - 1]], connectivity)
                                    for i, block in self.blocks.items()})

    def fill_cavities(self, *, connectivity: int = 6, at_most: int = 0) -> Volume:
        """`Grid.fill_cavities` of the whole. Finding the cavities computes the chunks once.

        Parameters
        ----------
        connectivity, at_most
            as for `Grid.fill_cavities`.

        Examples
        --------
        >>> volume = bitvox.big.voxelize('knot.ply', resolution=32, chunks=16)
        >>> (volume - volume.erode()).fill_cavities().compute() == volume.compute()
        True
        """
        self._grid().fill_cavities(connectivity=connectivity, at_most=at_most)
        empty = ~self
        known = found(empty, connectivity)
        low, size = (known.components[name].astype("i8") for name in ("low", "size"))
        cavity = ((low > 0) & (low + size < self.shape)).all(axis=1)
        if at_most:
            cavity &= known.components["voxels"] <= at_most
        return self | empty._kept(known, cavity, connectivity)

    def __repr__(self) -> str:
        return f"Volume({self.chunks!r})"


def _from_other(ours: Grid, other: Grid) -> Grid:
    return other - ours


def _whole(parts: Sequence[Grid], lattice: Lattice, box: Window) -> Grid:
    return join(lattice, box, parts)


def _flat(keys: Any) -> Any:
    for key in keys:
        if isinstance(key, list):
            yield from _flat(key)
        else:
            yield key


def _persisted(graph: Any, chunks: Chunks, keys: Sequence[Any], *, rename: dict[str, str] | None = None) -> Volume:
    delayed = need("dask.delayed", "big").Delayed
    found = [(rename or {}).get(key, key) for key in keys]
    return Volume(chunks, {index: delayed(key, graph) for index, key in zip(chunks, found)})


# ---- windows of a volume ----


def _crop(grid: Grid, window: Window) -> Grid:
    return grid.crop(window)


def _parts(volume: Volume, window: Window) -> list[Any]:
    """Delayed grids that cover a window: chunks that lie in it, and of the others the part that is needed, so that no more travels."""
    cropped, made, inside = need("dask", "big").delayed(_crop, pure=True), [], overlap(window, volume.box)
    for index in volume.chunks.over(inside) if inside else ():
        own = volume.chunks.window(index)
        shared = overlap(own, window)
        made.append(volume.blocks[index] if shared == own else cropped(volume.blocks[index], shared))
    return made


def _margin(margin: int | Sequence[int]) -> tuple[int, int, int]:
    found = tuple(triple_of(margin, "margin"))
    if min(found) < 0:
        raise ArgumentError(f"margin is {margin}; it must be 0 or more")
    return found  # type: ignore[return-value]


def _reach(lattice: Lattice, radius: float) -> tuple[int, ...]:
    """Voxels along each axis that a length reaches, and one to spare for its rounding."""
    return tuple(int(min(n, math.floor(min(radius / s, n)) + 1)) for n, s in zip(lattice.shape, lattice.spacing))


def _dask_array(cut: Chunks, blocks: dict[Index, Any], dtype: Any) -> Any:
    """A Dask array of delayed arrays, one a chunk."""
    da, np = need("dask.array", "big"), arrays.numpy("bitvox.big")
    nx, ny, nz = cut.counts

    def one(index: Index) -> Any:
        return da.from_delayed(blocks[index], cut.window(index).size, np.dtype(dtype))

    return da.block([[[one((x, y, z)) for z in range(nz)] for y in range(ny)] for x in range(nx)])


# ---- what tasks do, by one thread each: the engine runs many of them beside one another ----


def _around(function: Callable[..., Grid], arguments: Any, lattice: Lattice, margin: Sequence[int], wide: Window, window: Window, parts: Sequence[Grid]) -> Grid:
    with settings(threads=1):
        made = in_halves(lambda part: function(join(lattice, grown(part, margin, wide), parts), *arguments).crop(part), window)
    return made[0] if len(made) == 1 else join(lattice, window, made)


def _morph(grid: Grid, name: str, arguments: Any, options: dict[str, Any]) -> Grid:
    made: Grid = getattr(grid, name)(*arguments, **options)
    return made


def _distances(lattice: Lattice, margin: Sequence[int], wide: Window, window: Window, parts: Sequence[Grid], limit: float, arguments: Any, options: dict[str, Any]) -> Any:
    np = arrays.numpy("bitvox.big")

    def work(part: Window) -> tuple[Window, Any]:
        around = grown(part, margin, wide)
        values = join(lattice, around, parts).distance(*arguments, **options)[_within(around, part)]
        most = values.dtype.type(limit)
        return part, np.clip(values, -most, most)

    with settings(threads=1):
        made = in_halves(work, window)
    if len(made) == 1:
        return made[0][1]
    whole = np.empty(window.size, made[0][1].dtype)
    for part, values in made:
        whole[_within(window, part)] = values
    return whole


def _within(window: Window, part: Window) -> tuple[slice, ...]:
    return tuple(slice(a - b, a - b + n) for a, b, n in zip(part.low, window.low, part.size))


def _kept(grid: Grid, seeds: Any, connectivity: int) -> Grid:
    return grid.keep(seeds=seeds, connectivity=connectivity, threads=1) if len(seeds) else Grid(grid.lattice, (grid.low, grid.shape))


def _resampled(lattice: Lattice, wide: Window | None, found: Sequence[Grid], target: Lattice, window: Window) -> Grid:
    return join(lattice, wide, found).resample(target, window) if wide else Grid(target, window)


def _downsampled(lattice: Lattice, window: Window, parts: Sequence[Grid], factor: Any, rule: Reduce) -> Grid:
    return join(lattice, window, parts).downsample(factor, rule)


def _coverage(lattice: Lattice, window: Window, parts: Sequence[Grid], factor: Any) -> Any:
    return join(lattice, window, parts).coverage(factor)


def _as_array(grid: Grid) -> Any:
    return grid.to_numpy()


def _count(grid: Grid) -> int:
    return grid.count


def _part(chunks: Chunks, index: Index, options: dict[str, Any], *grids: Grid) -> Mesh:
    """A chunk's part of the surface from its grid and those beyond its high sides."""
    window, sides = chunks.cells(index)
    return whole_surface(join(chunks.lattice, window, grids), keys=True, open_sides=sides, **{"threads": 1, **options})


def voxelize(mesh: Any, lattice: Lattice | None = None, *, chunks: int | Sequence[int] = 512, spill: str | os.PathLike[str] | None = None,
             **options: Any) -> Volume:
    """The voxels of a mesh in chunks.

    Parameters
    ----------
    mesh
        a file that every worker can read, or what `Mesh.of` takes, which then is sent to each worker once.
    lattice
        a `bitvox.Lattice`, or resolution, spacing, padding, corner as for `bitvox.voxelize`.
    chunks
        voxels of a chunk along each axis; multiples of 64 along x are fastest.
    spill
        for a mesh that does not fit into memory, a binary PLY or STL of triangles: a folder, that all workers reach, where its triangles are
        sorted to columns of chunks before this returns; about 36 bytes a triangle. Rows are filled by "parity" or "nonzero" there.
    options
        rules of `bitvox.voxelize`; not fill "flood" or "regions", which look at the whole.

    Returns
    -------
    Volume
        A `Volume`; ``volume.array`` is a Dask array, ``volume.compute()`` a `Grid`.

    Examples
    --------
    >>> bitvox.big.voxelize('knot.ply', resolution=32, chunks=16).count() == bitvox.voxelize('knot.ply', resolution=32).count
    True
    >>> bitvox.big.voxelize('knot.ply', resolution=32, chunks=(32, 16, 16), spill='columns').count() == bitvox.voxelize('knot.ply', resolution=32).count
    True
    """
    dask = need("dask", "big")
    source = source_of(mesh)
    where = split_place(options)
    check_options(options)
    if spill is not None:
        return _streamed(source, lattice, chunks, where, os.path.abspath(os.fspath(spill)), by_rows(options))
    cut = place_chunks(source, lattice, chunks, where)
    held = source if isinstance(source, str) else dask.delayed(source, pure=True)
    make = dask.delayed(_voxelized, pure=True)
    state = None
    if isinstance(source, str) and os.path.exists(source):  # tasks of a file that has changed are others
        known = os.stat(source)
        state = known.st_size, known.st_mtime_ns
    return Volume(cut, {index: make(held, cut, index, options, state) for index in cut})


def _streamed(source: Any, lattice: Lattice | None, chunks: Any, where: dict[str, Any], folder: str, options: dict[str, Any]) -> Volume:
    if not isinstance(source, str):
        raise ArgumentError("spill is for a mesh in a file")
    triangles = Triangles(source)
    cut = place_chunks(None, Lattice.fit_box(*triangles.bounds(), **where) if lattice is None else lattice, chunks, {} if lattice is None else where)
    sort_triangles(triangles, cut, folder)
    make, known = need("dask", "big").delayed(_column_voxels, pure=True), os.stat(source)
    return Volume(cut, {i: make(folder, kind_of(triangles), cut, i, options, (source, known.st_size, known.st_mtime_ns)) for i in cut})


def _column_voxels(folder: str, kind: str, cut: Chunks, index: Index, options: dict[str, Any], state: Any) -> Grid:
    mesh, window = column(folder, index, kind), cut.window(index)
    return voxelize_window(mesh, cut.lattice, window, options) if mesh.n_faces else Grid(cut.lattice, window)


def _voxelized(source: Any, cut: Chunks, index: Index, options: dict[str, Any], state: Any) -> Grid:
    return voxelize_window(load(source), cut.lattice, cut.window(index), options)


def from_dask(array: Any, lattice: Lattice | None = None, *, chunks: int | Sequence[int] | None = None) -> Volume:
    """A volume from a Dask array [x, y, z]; values other than 0 are set.

    Parameters
    ----------
    lattice
        where it lies. Default: corner 0, spacing 1.
    chunks
        of the volume; None: the array's own, which must be regular.

    Examples
    --------
    >>> import dask.array
    >>> bitvox.big.from_dask(dask.array.ones((4, 4, 4), chunks=2)).count()
    64
    """
    dask, array = need("dask", "big"), laid_out(array)
    where = Lattice(array.shape) if lattice is None else lattice
    if where.shape != tuple(array.shape):
        raise ArgumentError(f"array has shape {array.shape}, the lattice {where.shape}")
    cut = Chunks(where, [sides[0] for sides in array.chunks] if chunks is None else chunks)
    laid = array.rechunk(cut.size)
    parts, make = laid.to_delayed(), dask.delayed(_from_array, pure=True)
    return Volume(cut, {index: make(parts[index], where, cut.window(index).low) for index in cut})


def _from_array(array: Any, lattice: Lattice, low: Any) -> Grid:
    return Grid.from_numpy(array, lattice=lattice, low=low)


def surface(volume: Volume, *, face_rule: FaceRule = "separate", dtype: Any = None, local_frame: bool = False) -> Mesh:
    """The closed surface of a volume: chunk by chunk on the workers, merged here.

    Parameters
    ----------
    face_rule, dtype, local_frame
        as for `bitvox.surface`.

    Returns
    -------
    Mesh
        A `Mesh` with keys: the bytes of ``bitvox.surface(volume.compute(), keys=True)``.

    Examples
    --------
    >>> bitvox.big.surface(bitvox.big.voxelize('knot.ply', resolution=32, chunks=16)).check().closed
    True
    """
    return merge(need("dask", "big").compute(*surface_parts(volume, face_rule=face_rule, dtype=dtype, local_frame=local_frame)))


def surface_parts(volume: Volume, **options: Any) -> list[Any]:
    """The parts of a surface as delayed meshes with keys, one a chunk, for `bitvox.merge`."""
    dask = need("dask", "big")
    part, chosen, cut = dask.delayed(_part, pure=True), one_type(volume.lattice, options), volume.chunks
    return [part(cut, index, chosen, *_parts(volume, cut.cells(index)[0])) for index in cut]
