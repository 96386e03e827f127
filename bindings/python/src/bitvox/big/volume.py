"""Grids in chunks on Dask."""

from __future__ import annotations

from typing import Any, Callable, Sequence

from .. import _arrays as arrays
from .._errors import ArgumentError, need
from .._grid import Grid
from .._lattice import Lattice, Window
from .._mesh import Mesh
from .._stages import merge
from .._stages import surface as whole_surface
from .chunks import Chunks, Index, join
from .plan import check_options, load, one_type, place_chunks, source_of, split_place, voxelize_window


class Volume:
    """A grid in chunks, nothing of it computed before it is asked for.

    Attributes:
        chunks: the `Chunks` of its lattice.
        blocks: for each chunk's index (x, y, z) a Dask delayed `Grid` (bits: an eighth of the array's bytes).
    """

    __slots__ = ("chunks", "blocks")

    def __init__(self, chunks: Chunks, blocks: dict[Index, Any]) -> None:
        self.chunks, self.blocks = chunks, blocks

    @property
    def lattice(self) -> Lattice:
        """The lattice that all chunks are windows of."""
        return self.chunks.lattice

    @property
    def shape(self) -> tuple[int, int, int]:
        """Voxels along x, y, z."""
        return self.lattice.shape

    @property
    def array(self) -> Any:
        """A Dask array of bool [x, y, z] whose chunks are those of the volume."""
        da, np = need("dask.array", "big"), arrays.numpy("bitvox.big")
        delayed = need("dask", "big").delayed(_as_array, pure=True)
        nx, ny, nz = self.chunks.counts

        def one(index: Index) -> Any:
            return da.from_delayed(delayed(self.blocks[index]), self.chunks.window(index).size, np.bool_)

        return da.block([[[one((x, y, z)) for z in range(nz)] for y in range(ny)] for x in range(nx)])

    def count(self) -> int:
        """Set voxels; computes."""
        dask = need("dask", "big")
        return sum(dask.compute(*[dask.delayed(_count, pure=True)(block) for block in self.blocks.values()]))

    def compute(self) -> Grid:
        """The whole grid, here: a bit a voxel."""
        parts = need("dask", "big").compute(*self.blocks.values())
        return join(self.lattice, Window((0, 0, 0), self.lattice.shape), parts)

    def map(self, function: Callable[..., Grid], *others: Volume) -> Volume:
        """A volume of ``function(grid, ...)`` of each chunk and of the same chunk of ``others``, for local operations:
        ``a.map(operator.or_, b)``."""
        dask = need("dask", "big")
        for other in others:
            if (other.lattice, other.chunks.size) != (self.lattice, self.chunks.size):
                raise ArgumentError("volumes do not share lattice and chunks")
        made = dask.delayed(function, pure=True)
        return Volume(self.chunks, {i: made(block, *(o.blocks[i] for o in others)) for i, block in self.blocks.items()})

    def __repr__(self) -> str:
        return f"Volume({self.chunks!r})"


def _as_array(grid: Grid) -> Any:
    return grid.to_numpy()


def _count(grid: Grid) -> int:
    return grid.count


def _part(chunks: Chunks, index: Index, options: dict[str, Any], *grids: Grid) -> Mesh:
    """A chunk's part of the surface from its grid and those beyond its high sides."""
    window, sides = chunks.cells(index)
    return whole_surface(join(chunks.lattice, window, grids), keys=True, open_sides=sides, **{"threads": 1, **options})


def _layer(grid: Grid, low: tuple[int, int, int], size: tuple[int, int, int]) -> Grid:
    """The part of a chunk that its neighbour needs, so that no more than that travels."""
    return join(grid.lattice, Window(low, size), [grid])


def voxelize(mesh: Any, lattice: Lattice | None = None, *, chunks: int | Sequence[int] = 512, **options: Any) -> Volume:
    """The voxels of a mesh in chunks.

    Args:
        mesh: a file that every worker can read, or what `Mesh.of` takes, which then is sent to each worker once.
        lattice: a `bitvox.Lattice`, or resolution, spacing, padding, corner as for `bitvox.voxelize`.
        chunks: voxels of a chunk along each axis; multiples of 64 along x are fastest.
        options: rules of `bitvox.voxelize`; not fill "flood" or "regions", which look at the whole.

    Returns:
        A `Volume`; ``volume.array`` is a Dask array, ``volume.compute()`` a `Grid`.
    """
    dask = need("dask", "big")
    source = source_of(mesh)
    where = split_place(options)
    check_options(options)
    cut = place_chunks(source, lattice, chunks, where)
    held = source if isinstance(source, str) else dask.delayed(source, pure=True)
    make = dask.delayed(_voxelized, pure=True)
    return Volume(cut, {index: make(held, cut, index, options) for index in cut})


def _voxelized(source: Any, cut: Chunks, index: Index, options: dict[str, Any]) -> Grid:
    return voxelize_window(load(source), cut.lattice, cut.window(index), options)


def from_dask(array: Any, lattice: Lattice | None = None, *, chunks: int | Sequence[int] | None = None) -> Volume:
    """A volume from a Dask array [x, y, z]; values other than 0 are set.

    Args:
        lattice: where it lies. Default: corner 0, spacing 1.
        chunks: of the volume; None: the array's own, which must be regular.
    """
    dask = need("dask", "big")
    if array.ndim != 3:
        raise ArgumentError(f"array has {array.ndim} axes; it must have three")
    where = Lattice(array.shape) if lattice is None else lattice
    if where.shape != tuple(array.shape):
        raise ArgumentError(f"array has shape {array.shape}, the lattice {where.shape}")
    cut = Chunks(where, [sides[0] for sides in array.chunks] if chunks is None else chunks)
    laid = array.rechunk(cut.size)
    parts, make = laid.to_delayed(), dask.delayed(_from_array, pure=True)
    return Volume(cut, {index: make(parts[index], where, cut.window(index).low) for index in cut})


def _from_array(array: Any, lattice: Lattice, low: Any) -> Grid:
    return Grid.from_numpy(array, lattice=lattice, low=low)


def surface(volume: Volume, *, face_rule: str = "separate", dtype: Any = None, local_frame: bool = False) -> Mesh:
    """The closed surface of a volume: chunk by chunk on the workers, merged here.

    Args:
        face_rule, dtype, local_frame: as for `bitvox.surface`.

    Returns:
        A `Mesh` with keys: the bytes of ``bitvox.surface(volume.compute(), keys=True)``.
    """
    return merge(need("dask", "big").compute(*surface_parts(volume, face_rule=face_rule, dtype=dtype, local_frame=local_frame)))


def surface_parts(volume: Volume, **options: Any) -> list[Any]:
    """The parts of a surface as delayed meshes with keys, one a chunk, for `bitvox.merge`."""
    dask = need("dask", "big")
    chosen = one_type(volume.lattice, options)
    part, layer = dask.delayed(_part, pure=True), dask.delayed(_layer, pure=True)
    cut, made = volume.chunks, []
    for index in cut:
        window, _ = cut.cells(index)
        grids = []
        for beside in cut.upper(index):
            block = volume.blocks[beside]
            if beside != index:
                low, size = cut.window(beside)
                top = [min(a + n, b + m) for a, n, b, m in zip(window.low, window.size, low, size)]
                first = [max(a, b) for a, b in zip(window.low, low)]
                block = layer(block, tuple(first), tuple(b - a for a, b in zip(first, top)))
            grids.append(block)
        made.append(part(cut, index, chosen, *grids))
    return made
