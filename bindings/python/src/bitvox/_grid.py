"""Grids: sets of voxels, one bit each."""

from __future__ import annotations

import operator
import os
import warnings
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, Sequence, overload

from . import _arrays as arrays
from ._calls import call
from ._errors import ArgumentError, EmptyError, FormatError, need
from ._html import shown
from ._lattice import Lattice, Window, WindowLike, set_window
from ._records import record
from ._run import SIDES, Progress, Run, choice, connected, ffi, function, in_range, lib, names_of, options_of, quiet
from ._words import Array, Beyond, DistanceSide, FloatName, GridReport, Order, Reduce, Side

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._mesh import Mesh
    from ._words import Surfacing
    from .reports import Difference, Topology

RULES = names_of("BVX_REDUCE_")
DISTANCE_SIDES = names_of("BVX_DISTANCE_")
BEYONDS = names_of("BVX_BEYOND_")


class Attached(NamedTuple):
    """The triangles that touch each set voxel.

    Voxel number r, in the order of the grid's bits (z, y, x), has ``triangles[offsets[r]:offsets[r + 1]]``, ascending.

    Examples
    --------
    >>> grid = bitvox.voxelize('knot.ply', resolution=16, mode='conservative', attached=True)
    >>> len(grid.attached.offsets) == grid.count + 1
    True
    """

    offsets: Any
    triangles: Any


class Grid:
    """A set of voxels of a lattice, or of a window of it; it does not change.

    Operators: ``a | b``, ``a & b``, ``a - b``, ``a ^ b``, ``~a`` (within the window), ``a == b``, ``a <= b`` (is part of),
    ``grid[x, y, z]``, ``len(grid)`` (set voxels), ``bool(grid)`` (is any set). Grids must share lattice and window.

    Examples
    --------
    >>> grid = bitvox.Grid.from_numpy(np.ones((3, 4, 5), bool), spacing=0.5)
    >>> grid
    Grid(3 x 4 x 5, 60 set)
    >>> grid.volume, (~grid).count, grid[0, 1, 2]
    (7.5, 0, True)
    """

    __slots__ = ("_c", "report", "attached", "_hash", "__weakref__")

    def __init__(self, lattice: Lattice, window: WindowLike = None) -> None:
        """An empty grid of a lattice, or of a window of it."""
        if not isinstance(lattice, Lattice):
            raise TypeError(f"lattice must be a Lattice, not {type(lattice).__name__}; Grid.from_numpy takes arrays")
        self._c = new_grid()
        self.report: GridReport = None  # type: ignore[assignment]
        self.attached: Attached | None = None
        self._hash: int | None = None
        box = ffi.new("bvx_window *")
        set_window("window", box, window)
        with Run() as run:
            run.check(lib.bvx_grid_create(run.context, lattice._c, box if window is not None else ffi.NULL, self._c))

    @classmethod
    def _made(cls, owner: Any, report: Any = None) -> Grid:
        self = cls.__new__(cls)
        self._c, self.report, self.attached, self._hash = owner, report, None, None
        return self

    @classmethod
    def from_numpy(cls, array: Any, *, order: Order = "xyz", spacing: Any = 1.0, corner: Sequence[float] | None = None,
                   center0: Sequence[float] | None = None, lattice: Lattice | None = None, low: Sequence[int] | None = None) -> Grid:
        """A grid from a three-dimensional array; values other than 0 are set.

        Parameters
        ----------
        array
            bool or any numbers, any strides; NaN is refused.
        order
            "xyz" (array[x, y, z]) or "zyx" (array[z, y, x]).
        spacing, corner
            of the lattice that is made: edges of a voxel, low corner of voxel (0, 0, 0), by default (0, 0, 0) [world].
        center0
            center of voxel (0, 0, 0), in place of the corner: what SimpleITK, NRRD and VTK's point data call the origin [world].
        lattice, low
            a lattice that the array is a window of, at voxel ``low``; in place of spacing, corner and center0.

        Examples
        --------
        >>> bitvox.Grid.from_numpy(np.eye(3)[:, :, None] * np.ones(3)).count
        9
        """
        np = arrays.numpy("Grid.from_numpy")
        if hasattr(array, "lattice"):
            raise TypeError(f"array must be an array, not {type(array).__name__}, whose place would be lost; " +
                            ("Volume.threshold keeps it" if hasattr(array, "threshold") else "give its to_numpy() and lattice=, low="))
        found = arrays.as_numpy(array, "array")
        if found.ndim != 3 or 0 in found.shape:
            raise ArgumentError(f"array has shape {found.shape}; it must have three axes, none of them empty")
        if order not in ("xyz", "zyx"):
            raise ArgumentError(f"order is {order!r}; it must be 'xyz' or 'zyx'")
        zyx = found.transpose(2, 1, 0) if order == "xyz" else found
        nz, ny, nx = zyx.shape
        if lattice is None:
            if low is not None:
                raise ArgumentError("low is taken together with lattice")
            if center0 is not None and corner is not None:
                raise ArgumentError("corner and center0 contradict each other; give one of them")
            if center0 is not None:
                steps = arrays.triple("spacing", spacing)
                corner = [c - 0.5 * s for c, s in zip(arrays.triple("center0", center0), steps)]
            grid = cls(Lattice((nx, ny, nz), spacing, (0.0, 0.0, 0.0) if corner is None else corner))
        elif corner is not None or center0 is not None:
            raise ArgumentError("lattice contradicts corner and center0; give one of them")
        else:
            grid = cls(lattice, (tuple(low or (0, 0, 0)), (nx, ny, nz)))
        with np.errstate(invalid="ignore"):
            if found.dtype.kind == "f" and np.isnan(found.min()):  # without an array of bools
                raise ArgumentError("array: NaN is neither set nor empty")
        kind = "u1" if found.dtype.kind == "b" else found.dtype.kind + str(found.dtype.itemsize)
        sample = getattr(lib, f"BVX_SAMPLE_{kind[0].upper()}{8 * int(kind[1:])}", None) if kind[0] in "uif" else None
        if sample is not None and found.dtype.isnative and any(found.strides):
            grid._pack(zyx, sample)
            return grid
        rows = grid._words(writable=True)
        for z in range(nz):  # a slice at a time, so that a view with strides costs no copy of the whole
            packed = np.packbits(zyx[z] != 0 if zyx.dtype.kind != "b" else zyx[z], axis=1, bitorder="little")
            padded = np.zeros((ny, rows.shape[2] * 8), np.uint8)
            padded[:, : packed.shape[1]] = packed
            rows[z] = padded.view("<u8")
        return grid

    @classmethod
    def of(cls, source: Any, *, scalars: str | None = None) -> Grid:
        """A grid of what other libraries hold, in its place: the voxels whose value is not 0.

        Parameters
        ----------
        source
            a trimesh VoxelGrid, a mask that `Volume.of` takes (SimpleITK, nibabel, PyVista, xarray), a `Volume` or a `Grid`. Axes that
            are flipped or permuted are turned; oblique ones are refused, as by `Volume.threshold`.
        scalars
            of PyVista: which point or cell data; None: the active ones.

        Examples
        --------
        >>> grid = bitvox.Grid.from_numpy(np.ones((2, 3, 4)))
        >>> bitvox.Grid.of(grid.to_pyvista()) == bitvox.Grid.of(grid.to_trimesh()) == grid
        True
        """
        if isinstance(source, cls):
            return source
        made: Grid = call("grid_from", source, scalars)
        return made

    def _pack(self, zyx: Any, sample: int) -> None:
        """Set what is not 0 in an array [z, y, x], of a type of samples that the library reads where they lie, in any order: all but
        what it finds to be 0."""
        view, made = ffi.new("bvx_volume_view *"), new_grid()
        view.samples, view.sample_type = arrays.address(zyx), sample
        view.low, view.size, view.strides = self.low, self.shape, zyx.strides[::-1]
        view.lattice = self._c.lattice
        with quiet(), Run() as run:
            run.check(lib.bvx_threshold(run.context, view, 0.0, 0.0, ffi.NULL, made))
            run.check(lib.bvx_grid_complement(run.context, made, made))
        self._c = made

    # ---- where it lies ----

    @property
    def lattice(self) -> Lattice:
        """The lattice that its voxels belong to."""
        return Lattice._of(self._c.lattice)

    @property
    def low(self) -> tuple[int, int, int]:
        """Lattice index of the grid's voxel (0, 0, 0): where its window begins."""
        return tuple(self._c.low)  # type: ignore[return-value]

    @property
    def shape(self) -> tuple[int, int, int]:
        """Voxels along x, y, z."""
        return tuple(self._c.size)  # type: ignore[return-value]

    @property
    def spacing(self) -> tuple[float, float, float]:
        """Edges of a voxel [world]."""
        return tuple(self._c.lattice.spacing)  # type: ignore[return-value]

    @property
    def corner(self) -> tuple[float, float, float]:
        """Low corner of the grid's voxel (0, 0, 0) [world]."""
        return tuple(o + i * s for o, i, s in zip(self._c.lattice.origin, self.low, self.spacing))  # type: ignore[return-value]

    @property
    def center0(self) -> tuple[float, float, float]:
        """Center of the grid's voxel (0, 0, 0) [world]."""
        return tuple(o + (i + 0.5) * s for o, i, s in zip(self._c.lattice.origin, self.low, self.spacing))  # type: ignore[return-value]

    @property
    def origin(self) -> tuple[float, float, float]:
        """`center0` under the name that SimpleITK and NRRD have for it [world]; the library and the program call the `corner` so."""
        return self.center0

    @property
    def bounds(self) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
        """Low and high corner of its window, set voxels or not: ((x, y, z), (x, y, z)) [world]."""
        low = self.corner
        return low, tuple(a + n * s for a, n, s in zip(low, self.shape, self.spacing))  # type: ignore[return-value]

    # ---- its bits ----

    @property
    def words(self) -> Array:
        """The bits themselves, (z, y, words a row) uint64, read-only, no copy: voxel x is bit ``x % 64`` of word ``x // 64``."""
        return self._words(writable=False)

    def _words(self, writable: bool) -> Any:
        shape = (self._c.size[2], self._c.size[1], self._c.words_per_row)
        return arrays.array_at(self._c.words, "uint64", shape, self._c, writable)

    def to_numpy(self, order: Order = "xyz") -> Array:
        """A new bool array, one byte a voxel: ``array[x, y, z]``, or with order "zyx" ``array[z, y, x]``.

        Both lie in memory with x running fastest.

        Examples
        --------
        >>> bitvox.voxelize('knot.ply', resolution=16).to_numpy().shape
        (16, 16, 7)
        """
        np = arrays.numpy("Grid.to_numpy")
        if order not in ("xyz", "zyx"):
            raise ArgumentError(f"order is {order!r}; it must be 'xyz' or 'zyx'")
        nx, ny, nz = self.shape
        as_bytes = self.words.astype("<u8", copy=False).view(np.uint8)
        zyx = np.unpackbits(as_bytes, axis=2, count=nx, bitorder="little").view(np.bool_)
        return zyx if order == "zyx" else zyx.transpose(2, 1, 0)

    def __array__(self, dtype: Any = None, copy: Any = None) -> Any:
        if copy is False:
            raise ValueError("the bits are packed: an array of them is always a copy")
        made = self.to_numpy()
        return made if dtype is None else made.astype(dtype)

    @overload
    def __getitem__(self, voxel: tuple[int, int, int]) -> bool: ...  # type: ignore[overload-overlap]
    @overload
    def __getitem__(self, voxel: Any) -> Array: ...
    def __getitem__(self, voxel: Any) -> Any:
        """By numpy's rules: whether voxel ``grid[x, y, z]`` of the window is set, negative numbers count from the end; with slices
        or fewer numbers a new bool array, unpacked of the slices alone."""
        index = voxel if isinstance(voxel, tuple) else (voxel,)
        if len(index) == 3:
            try:
                at = [operator.index(i) for i in index if not isinstance(i, bool)]
            except TypeError:
                at = []
            if len(at) == 3:
                x, y, z = (i + n if i < 0 else i for i, n in zip(at, self.shape))
                nx, ny, nz = self.shape
                if not (0 <= x < nx and 0 <= y < ny and 0 <= z < nz):
                    raise IndexError(f"voxel {voxel} is not in a grid of shape {self.shape}")
                return bool(self._c.words[(z * ny + y) * self._c.words_per_row + (x >> 6)] >> (x & 63) & 1)
        np = arrays.numpy("Grid[...]")
        if len(index) < 3 and not any(i is Ellipsis for i in index):
            index = (*index, *[slice(None)] * (3 - len(index)))
        if len(index) == 3 and all(isinstance(i, (int, np.integer, slice)) and not isinstance(i, bool) for i in index):
            inner = [i if isinstance(i, slice) else slice(i, i + 1 or None) for i in index]
            for axis, (i, n) in enumerate(zip(index, self.shape)):
                if not isinstance(i, slice) and not -n <= i < n:
                    raise IndexError(f"index {i} is out of bounds for axis {axis} with size {n}")
            rows = np.ascontiguousarray(self.words[inner[2], inner[1]].astype("<u8", copy=False)).view(np.uint8)
            bits = np.unpackbits(rows, axis=2, count=self.shape[0], bitorder="little").view(np.bool_).transpose(2, 1, 0)[inner[0]]
            return bits[tuple(slice(None) if isinstance(i, slice) else 0 for i in index)]
        return self.to_numpy()[voxel]

    def __array_ufunc__(self, ufunc: Any, method: str, *inputs: Any, **options: Any) -> Any:
        raise TypeError(f"numpy's {ufunc.__name__} takes no Grid: give it grid.to_numpy(); grid.count is how many voxels are set, | & - ^ "
                        "combine grids, and an array has no place of its own: Grid.from_numpy(array, lattice=grid.lattice, low=grid.low)")

    def __iter__(self) -> Any:
        raise TypeError("a Grid has no rows to walk: take to_numpy() or voxels()")

    def voxels(self) -> Array:
        """Indices (n, 3) int64 of the set voxels in the window, in the order of the bits (z, y, x).

        Examples
        --------
        >>> bitvox.Grid.from_numpy(np.ones((1, 1, 2))).voxels().tolist()
        [[0, 0, 0], [0, 0, 1]]
        """
        np = arrays.numpy("Grid.voxels")
        return np.argwhere(self.to_numpy("zyx"))[:, ::-1]

    @property
    def count(self) -> int:
        """Set voxels."""
        out = ffi.new("uint64_t *")
        with Run() as run:
            run.check(lib.bvx_grid_count(run.context, self._c, out))
        return out[0]

    @property
    def volume(self) -> float:
        """Of the set voxels [world^3]."""
        a, b, c = self.spacing
        return self.count * (a * b * c)

    def __len__(self) -> int:
        return self.count

    def __bool__(self) -> bool:
        return self.count != 0

    def content_hash(self) -> int:
        """The library's hash of lattice, window and bits: the same on every machine.

        Examples
        --------
        >>> a, b = (bitvox.voxelize('knot.ply', resolution=16, threads=n) for n in (1, 2))
        >>> a.content_hash() == b.content_hash()
        True
        """
        if self._hash is None:
            out = ffi.new("uint64_t *")
            with Run() as run:
                run.check(lib.bvx_grid_hash(run.context, self._c, out))
            self._hash = out[0]
        return self._hash

    def __hash__(self) -> int:
        return hash(self.content_hash())

    # ---- set algebra ----

    def _same_place(self, other: Any) -> bool:
        return (self.low, self.shape, self.lattice) == (other.low, other.shape, other.lattice)

    def _combined(self, other: Any, operation: int) -> Grid:
        if hasattr(other, "__array_interface__"):
            raise TypeError("an array has no place of its own: Grid.from_numpy(array, lattice=grid.lattice, low=grid.low) gives it that of a grid")
        if not isinstance(other, Grid):
            return NotImplemented
        return self._through(lambda run, made: lib.bvx_grid_combine(run.context, self._c, other._c, operation, made))

    def _through(self, make: Any) -> Grid:
        made = new_grid()
        with Run() as run:
            run.check(make(run, made))
        return Grid._made(made)

    def __or__(self, other: Any) -> Grid:
        return self._combined(other, lib.BVX_BOOLEAN_UNION)

    def __and__(self, other: Any) -> Grid:
        return self._combined(other, lib.BVX_BOOLEAN_INTERSECTION)

    def __xor__(self, other: Any) -> Grid:
        return self._combined(other, lib.BVX_BOOLEAN_XOR)

    def __sub__(self, other: Any) -> Grid:
        return self._combined(other, lib.BVX_BOOLEAN_DIFFERENCE)

    def __invert__(self) -> Grid:
        return self._through(lambda run, made: lib.bvx_grid_complement(run.context, self._c, made))

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Grid):
            return NotImplemented
        if not self._same_place(other):
            return False
        size = self._c.size[2] * self._c.size[1] * self._c.words_per_row * 8
        return ffi.buffer(self._c.words, size) == ffi.buffer(other._c.words, size)

    def __le__(self, other: Any) -> bool:
        return not (self - other).count if isinstance(other, Grid) else NotImplemented

    def __ge__(self, other: Any) -> bool:
        return other <= self if isinstance(other, Grid) else NotImplemented

    # ---- other lattices and windows ----

    def downsample(self, factor: Any, rule: Reduce = "any") -> Grid:
        """Blocks of voxels become voxels.

        Parameters
        ----------
        factor
            voxels of a block along each axis, one number or three; blocks are counted from the lattice's corner.
        rule
            a block is set when "any" of its voxels are, when "all" are, or the "majority": more than half. Of blocks that
            the window cuts only the voxels in the window count.

        Returns
        -------
        Grid
            A grid of a lattice with the same corner and ``factor`` times the spacing.

        Examples
        --------
        >>> bitvox.voxelize('knot.ply', resolution=32).downsample(2, 'majority')
        Grid(16 x 16 x 7, 221 set)
        """
        blocks, number = triple_of(factor, least=1), choice("rule", rule, "BVX_REDUCE_", RULES)
        return self._through(lambda run, made: lib.bvx_grid_downsample(run.context, self._c, blocks, number, made))

    def coverage(self, factor: Any) -> Array:
        """How many voxels of each block are set: a new uint32 array ``counts[x, y, z]`` with x running fastest in memory.

        Parameters
        ----------
        factor
            as for `downsample`, whose grid has the same shape and place.

        Examples
        --------
        >>> int(bitvox.voxelize('knot.ply', resolution=32).coverage(2).max())
        8
        """
        np = arrays.numpy("Grid.coverage")
        blocks, count = triple_of(factor, least=1), ffi.new("uint64_t *")
        with Run() as run:
            run.check(lib.bvx_grid_coverage(run.context, self._c, blocks, ffi.NULL, 0, count))
            shape = [(low + size - 1) // n - low // n + 1 for low, size, n in zip(self.low, self.shape, blocks)]
            counts = np.empty(shape[::-1], np.uint32)
            pointer = ffi.cast("uint32_t *", arrays.address(counts))
            run.check(lib.bvx_grid_coverage(run.context, self._c, blocks, pointer, counts.size, count))
        return counts.transpose(2, 1, 0)

    def content(self) -> Window | None:
        """The least window of the lattice that holds all set voxels; None when none is set.

        Examples
        --------
        >>> bitvox.voxelize('knot.ply', resolution=16, padding=2).content().low
        (2, 2, 2)
        """
        np = arrays.numpy("Grid.content")
        rows: Any = self.words.any(axis=2)
        if not rows.any():
            return None
        along_x = np.bitwise_or.reduce(self.words, axis=(0, 1)).astype("<u8").view(np.uint8)
        axes: list[Any] = [np.unpackbits(along_x, bitorder="little"), rows.any(axis=0), rows.any(axis=1)]
        set_at = [axis.nonzero()[0].tolist() for axis in axes]
        low: Any = tuple(first + at[0] for first, at in zip(self.low, set_at))
        size: Any = tuple(at[-1] - at[0] + 1 for at in set_at)
        return Window(low, size)

    def crop(self, window: WindowLike = None) -> Grid:
        """The same lattice through another window.

        Parameters
        ----------
        window
            (low, size) of the lattice, which may reach beyond the grid's own, where all is empty; None: `content`.

        Raises
        ------
        EmptyError
            no window is given and no voxel is set.

        Examples
        --------
        >>> bitvox.voxelize('knot.ply', resolution=16, padding=2).crop().shape
        (15, 16, 6)
        """
        if window is None:
            window = self.content()
            if window is None:
                raise EmptyError("no voxel is set, so there is nothing to crop to: give a window")
        box = ffi.new("bvx_window *")
        set_window("window", box, window)
        return self._through(lambda run, made: lib.bvx_grid_crop(run.context, self._c, box, made))

    def pad(self, low: Any, high: Any = None) -> Grid:
        """The same voxels on a lattice that has more of them around; nothing moves in the world.

        Parameters
        ----------
        low
            empty voxels put before the first ones along each axis, one number or three.
        high
            after the last ones; None: as many as ``low``.

        Examples
        --------
        >>> bitvox.Grid.from_numpy(np.ones((2, 2, 2))).pad(1, 2).shape
        (5, 5, 5)
        """
        before = triple_of(low, "low")
        behind = before if high is None else triple_of(high, "high")
        return self._through(lambda run, made: lib.bvx_grid_pad(run.context, self._c, before, behind, made))

    def permute(self, axes: Any = "xyz", flip: Any = ()) -> Grid:
        """Axes changed and mirrored.

        Parameters
        ----------
        axes
            which of the grid's axes become x, y and z: "zyx", or numbers (2, 1, 0).
        flip
            those of the result's axes that run backwards: "x", "xz", or numbers. The lattice's box is mirrored in itself.

        Examples
        --------
        >>> bitvox.Grid.from_numpy(np.ones((1, 2, 3))).permute('zyx').shape
        (3, 2, 1)
        """
        order = [axis_of("axes", a) for a in axes]
        if sorted(order) != [0, 1, 2]:
            raise ArgumentError(f"axes are {axes!r}; they must be x, y and z in any order")
        flips = [0, 0, 0]
        for a in flip:
            flips[axis_of("flip", a)] = 1
        return self._through(lambda run, made: lib.bvx_grid_permute(run.context, self._c, order, flips, made))

    def transform(self, matrix: Any, *, spacing: Any = None) -> Grid:
        """The same set in another place: ``matrix`` (4, 4), or (3, 3) without a shift, is applied to all positions.

        A matrix with one number in each row and column, beside the shift, brings voxels onto voxels: axes are permuted, flipped, scaled
        and shifted, and the lattice and the window with them. Nothing is lost: the same number of voxels is set, and the inverse matrix
        brings them back. Any other one turns the voxels out of the axes, and the set is sampled anew on a lattice around the moved
        window: a voxel is set when its center came out of a set voxel. That takes one byte a voxel of both grids.

        Parameters
        ----------
        spacing
            of the new lattice where the set is sampled anew, one number or three. Default: the smallest edge of the moved voxels, along
            all axes [world].

        Raises
        ------
        ArgumentError
            a matrix of another shape, one that flattens, or one whose last row is not 0 0 0 1; ``spacing`` for a matrix that needs none.

        Examples
        --------
        >>> grid = bitvox.Grid.from_numpy(np.ones((1, 2, 3)))
        >>> grid.transform([[0, -1, 0, 10], [1, 0, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]).bounds
        ((8.0, 0.0, 0.0), (10.0, 1.0, 3.0))
        >>> grid.transform([[0.8, -0.6, 0], [0.6, 0.8, 0], [0, 0, 1]], spacing=0.25).shape
        (8, 9, 12)
        """
        full = arrays.matrix_in(matrix)
        linear = full[:3, :3]
        if ((linear != 0).sum(axis=0) != 1).any():
            made: Grid = call("resampled_bits", self, full, spacing)
            return made
        if spacing is not None:
            raise ArgumentError("spacing is for a matrix that turns voxels out of the axes; this one brings voxels onto voxels")
        axes = [int(a) for a in (linear != 0).argmax(axis=1)]  # which of the grid's become x, y and z
        turned = self.permute(axes, [a for a in range(3) if linear[a, axes[a]] < 0])
        whole = self.lattice
        ends = arrays.moved_by(full, [whole.corner, [c + n * s for c, n, s in zip(whole.corner, whole.shape, whole.spacing)]])
        steps = [abs(float(linear[a, axes[a]])) * whole.spacing[axes[a]] for a in range(3)]
        placed = Grid(Lattice(turned.lattice.shape, steps, ends.min(axis=0).tolist()), (turned.low, turned.shape))
        ffi.memmove(placed._c.words, turned._c.words, ffi.sizeof("uint64_t") * placed._c.words_per_row * turned.shape[1] * turned.shape[2])
        return placed

    def resample(self, lattice: Lattice, window: WindowLike = None) -> Grid:
        """The same set on another lattice: a voxel is set when its center lies in a set voxel of this grid.

        Parameters
        ----------
        lattice
            where the result lies.
        window
            a part of it; None: all.

        Examples
        --------
        >>> solid = bitvox.voxelize('knot.ply', resolution=32)
        >>> solid.resample(bitvox.Lattice.fit('knot.ply', resolution=16))
        Grid(16 x 16 x 7, 256 set)
        """
        box = ffi.new("bvx_window *")
        set_window("window", box, window)
        return self._through(lambda run, made: lib.bvx_grid_resample(run.context, self._c, lattice._c, box, made))

    # ---- questions ----

    def compare(self, other: Grid, *, threads: int | None = None, memory_limit: int | None = None, progress: Progress = None) -> Difference:
        """What this grid and an ``other`` share and where they differ.

        Returns
        -------
        Difference
            A `bitvox.reports.Difference`.

        Raises
        ------
        LatticeError
            they do not share lattice and window.

        Examples
        --------
        >>> solid = bitvox.voxelize('knot.ply', resolution=32)
        >>> solid.compare(solid.erode()).only_b
        0
        """
        out = ffi.new("bvx_grid_difference *")
        with Run(threads, memory_limit, progress) as run:
            run.check(lib.bvx_grid_compare(run.context, self._c, other._c, out))
        return record(out)

    def cast(self, rays: Any, *, t_max: float = float("inf"), threads: int | None = None, memory_limit: int | None = None,
             progress: Progress = None) -> Array:
        """Where rays first meet a set voxel.

        Parameters
        ----------
        rays
            (n, 6) origin and direction, of any length but 0 [world].
        t_max
            hits have ``0 <= t <= t_max``, position = origin + t * direction.

        Returns
        -------
        Array
            A record array of n hits with t, position [world], voxel, axis (-1: the ray starts inside), hit (0 or 1).

        Examples
        --------
        >>> grid = bitvox.Grid.from_numpy(np.ones((2, 2, 2)))
        >>> float(grid.cast([[-3, 1, 1, 1, 0, 0]])['t'][0])
        3.0
        """
        given = arrays.numbers_in(rays, "rays", 6)
        out = ffi.new("bvx_ray_hit[]", max(1, given.count))
        with Run(threads, memory_limit, progress) as run:
            run.check(lib.bvx_grid_cast(run.context, self._c, ffi.cast("double *", given.pointer), given.count, t_max, out))
        return arrays.records_at(out, "bvx_ray_hit", given.count, out)

    def sample(self, points: Any, *, gradients: bool = False, threads: int | None = None, memory_limit: int | None = None,
               progress: Progress = None) -> Any:
        """Trilinear samples at points: 1 at the centers of set voxels, 0 at those of others and beyond the window.

        Parameters
        ----------
        points
            (n, 3) [world].
        gradients
            also return gradients (n, 3) [1 / world].

        Returns
        -------
        Any
            (n,) float64, or (values, gradients).

        Examples
        --------
        >>> grid = bitvox.Grid.from_numpy(np.ones((2, 2, 2)))
        >>> grid.sample([[1, 1, 1], [0, 1, 1]]).tolist()
        [1.0, 0.5]
        """
        given = arrays.numbers_in(points, "points", 3)
        values = ffi.new("double[]", max(1, given.count))
        slopes = ffi.new("double[]", max(1, 3 * given.count)) if gradients else ffi.NULL
        with Run(threads, memory_limit, progress) as run:
            run.check(lib.bvx_grid_sample(run.context, self._c, ffi.cast("double *", given.pointer), given.count, values, slopes))
        first = arrays.array_at(values, "float64", (given.count,), values, writable=True)
        if not gradients:
            return first
        return first, arrays.array_at(slopes, "float64", (given.count, 3), slopes, writable=True)

    def fill(self, seeds: Any, *, connectivity: int = 6, threads: int | None = None, memory_limit: int | None = None,
             progress: Progress = None) -> Grid:
        """All voxels that are connected with one of the seeds through empty voxels.

        Parameters
        ----------
        seeds
            (n, 3) voxels of the window, none of them set.
        connectivity
            6 (across faces), 18 (and edges) or 26 (and corners).

        Examples
        --------
        >>> bitvox.Grid(bitvox.Lattice((4, 4, 4))).fill([[0, 0, 0]]).count
        64
        """
        given = arrays.numbers_in(seeds, "seeds", 3, "int32")
        made = new_grid()
        with Run(threads, memory_limit, progress) as run:
            run.check(lib.bvx_grid_fill(run.context, self._c, ffi.cast("int32_t *", given.pointer), given.count, connected(connectivity), made))
        return Grid._made(made)

    # ---- parts ----

    def components(self, *, connectivity: int = 6, threads: int | None = None, memory_limit: int | None = None,
                   progress: Progress = None) -> Array:
        """The connected parts of the set voxels, in the order of their least voxels (z, y, x).

        Parameters
        ----------
        connectivity
            6 (across faces), 18 (and edges) or 26 (and corners).

        Returns
        -------
        Array
            A record array with first (linear index of the least voxel, x fastest), voxels, low and size (box, in voxels of the window).

        Examples
        --------
        >>> bitvox.Grid.from_numpy(np.array([[[1, 0, 1, 1]]])).components()['voxels'].tolist()
        [1, 2]
        """
        count = ffi.new("uint64_t *")
        with Run(threads, memory_limit, progress, calls=2) as run:
            call = function("bvx_grid_components")
            run.check(call(run.context, self._c, connected(connectivity), ffi.NULL, 0, count))
            out = ffi.new("bvx_component[]", max(1, count[0]))
            run.check(call(run.context, self._c, connected(connectivity), out, count[0], count))
        return arrays.records_at(out, "bvx_component", count[0], out)

    def label(self, *, connectivity: int = 6, threads: int | None = None, memory_limit: int | None = None,
              progress: Progress = None) -> Array:
        """The label of each voxel's part: uint32 ``labels[x, y, z]``, 0 for empty voxels, 1 for the part with the least voxel.

        Parameters
        ----------
        connectivity
            6 (across faces), 18 (and edges) or 26 (and corners).

        Examples
        --------
        >>> bitvox.Grid.from_numpy(np.array([[[1, 0, 1, 1]]])).label().ravel().tolist()
        [1, 0, 2, 2]
        """
        np = arrays.numpy("Grid.label")
        labels = np.empty(self.shape[::-1], np.uint32)
        with Run(threads, memory_limit, progress) as run:
            run.check(function("bvx_grid_label")(run.context, self._c, connected(connectivity), ffi.cast("uint32_t *", labels.ctypes.data), labels.size, ffi.NULL))
        return labels.transpose(2, 1, 0)

    def keep(self, *, largest: int | None = None, at_least: int = 0, seeds: Any = None, connectivity: int = 6,
             threads: int | None = None, memory_limit: int | None = None, progress: Progress = None) -> Grid:
        """Some of the connected parts.

        Parameters
        ----------
        at_least
            parts of fewer voxels are dropped.
        seeds
            (n, 3) voxels of the window: parts that hold none of them are dropped.
        largest
            of what remains, this many of the largest are kept.
        connectivity
            6 (across faces), 18 (and edges) or 26 (and corners).

        Returns
        -------
        Grid
            A `Grid`; ``grid.report`` is a `bitvox.reports.KeepReport`.

        Examples
        --------
        >>> bitvox.Grid.from_numpy(np.array([[[1, 0, 1, 1]]])).keep(largest=1).count
        2
        """
        options = options_of("keep_options")
        options.connectivity = connected(connectivity)
        options.at_least = in_range("at_least", at_least, 0, 2**63)
        if largest is not None:
            options.largest = in_range("largest", largest, 1, 2**63)
        report = ffi.new("bvx_keep_report *")
        options.report = report
        made = new_grid()
        given = None if seeds is None else arrays.numbers_in(seeds, "seeds", 3, "int32")
        if given is not None:
            if given.count == 0:
                raise ArgumentError("seeds are empty: no part would be kept")
            options.seeds, options.seed_count = ffi.cast("int32_t *", given.pointer), given.count
        with Run(threads, memory_limit, progress) as run:
            run.check(function("bvx_grid_keep")(run.context, self._c, options, made))
        return Grid._made(made, record(report))

    def fill_cavities(self, *, connectivity: int = 6, at_most: int = 0, threads: int | None = None, memory_limit: int | None = None,
                      progress: Progress = None) -> Grid:
        """The grid with its cavities filled: connected parts of the empty voxels that touch no side of the window.

        Parameters
        ----------
        connectivity
            of the empty voxels, 6, 18 or 26.
        at_most
            cavities of more voxels stay; 0: all are filled.

        Examples
        --------
        >>> array = np.ones((3, 3, 3))
        >>> array[1, 1, 1] = 0
        >>> bitvox.Grid.from_numpy(array).fill_cavities().count
        27
        """
        made = new_grid()
        with Run(threads, memory_limit, progress) as run:
            run.check(function("bvx_grid_fill_cavities")(run.context, self._c, connected(connectivity), in_range("at_most", at_most, 0, 2**63), made, ffi.NULL))
        return Grid._made(made)

    def topology(self, *, connectivity: int = 6, threads: int | None = None, memory_limit: int | None = None,
                 progress: Progress = None) -> Topology:
        """Parts, cavities, tunnels and the Euler number.

        Parameters
        ----------
        connectivity
            of the set voxels, 6 or 26; the empty ones then connect by 26 or 6.

        Returns
        -------
        Topology
            A `bitvox.reports.Topology`.

        Examples
        --------
        >>> bitvox.voxelize('knot.ply', resolution=64).topology().components
        1
        """
        out = ffi.new("bvx_topology *")
        with Run(threads, memory_limit, progress) as run:
            run.check(function("bvx_grid_topology")(run.context, self._c, connected(connectivity), out))
        return record(out)

    # ---- growing, shrinking, distances ----

    def _morphed(self, operation: int, steps: int, connectivity: int, radius: float | None, beyond: bool, *limits: Any) -> Grid:
        options = options_of("morph_options")
        options.neighbourhood = connected(connectivity) if radius is None else lib.BVX_BALL
        options.steps = in_range("steps", steps, 1, 65536)
        if radius is not None and not 0.0 <= float(radius) < float("inf"):
            raise ArgumentError(f"radius is {radius}; it must be finite and not negative")
        options.radius = 0.0 if radius is None else radius
        options.beyond = int(beyond)
        made = new_grid()
        with Run(*limits) as run:
            run.check(lib.bvx_grid_morph(run.context, self._c, operation, options, made))
        return Grid._made(made)

    def dilate(self, steps: int = 1, *, connectivity: int = 6, radius: float | None = None, beyond: bool = False,
               threads: int | None = None, memory_limit: int | None = None, progress: Progress = None) -> Grid:
        """Voxels that have a set one among their neighbors, or within a ball.

        All is done as in unbounded space and cut to the window; padding of the lattice makes room.

        Parameters
        ----------
        steps
            how many times it is done.
        connectivity
            6 (across faces), 18 (and edges) or 26 (and corners).
        radius
            of a ball, in place of steps and connectivity; centers at most this far count [world].
        beyond
            True when voxels beyond the window count as set.

        Examples
        --------
        >>> bitvox.Grid.from_numpy(np.ones((1, 1, 1))).pad(2).dilate(radius=1.5).count
        19
        """
        return self._morphed(lib.BVX_MORPH_DILATE, steps, connectivity, radius, beyond, threads, memory_limit, progress)

    def erode(self, steps: int = 1, *, connectivity: int = 6, radius: float | None = None, beyond: bool = False,
              threads: int | None = None, memory_limit: int | None = None, progress: Progress = None) -> Grid:
        """Voxels that have no empty one among their neighbors, or within a ball.

        Parameters
        ----------
        steps, connectivity, radius, beyond
            as for `dilate`.

        Examples
        --------
        >>> bitvox.Grid.from_numpy(np.ones((5, 5, 5))).erode(2).count
        1
        """
        return self._morphed(lib.BVX_MORPH_ERODE, steps, connectivity, radius, beyond, threads, memory_limit, progress)

    def open(self, steps: int = 1, *, connectivity: int = 6, radius: float | None = None, beyond: bool = False,
             threads: int | None = None, memory_limit: int | None = None, progress: Progress = None) -> Grid:
        """Eroded, then dilated: without what is too thin; a part of the grid.

        Parameters
        ----------
        steps, connectivity, radius, beyond
            as for `dilate`.

        Examples
        --------
        >>> solid = bitvox.voxelize('knot.ply', resolution=32)
        >>> solid.open() <= solid
        True
        """
        return self._morphed(lib.BVX_MORPH_OPEN, steps, connectivity, radius, beyond, threads, memory_limit, progress)

    def close(self, steps: int = 1, *, connectivity: int = 6, radius: float | None = None, beyond: bool = False,
              threads: int | None = None, memory_limit: int | None = None, progress: Progress = None) -> Grid:
        """Dilated, then eroded: with small gaps filled; the grid is a part of it.

        Parameters
        ----------
        steps, connectivity, radius, beyond
            as for `dilate`.

        Examples
        --------
        >>> solid = bitvox.voxelize('knot.ply', resolution=32)
        >>> solid <= solid.close()
        True
        """
        return self._morphed(lib.BVX_MORPH_CLOSE, steps, connectivity, radius, beyond, threads, memory_limit, progress)

    def hollow(self, thickness: float, *, drain: float = 0.0, drain_side: Side = "z-low", drain_at: Sequence[float] | None = None,
               beyond: bool = False, threads: int | None = None, memory_limit: int | None = None, progress: Progress = None) -> Grid:
        """A shell of the body: its outer surface stays, voxels deeper than ``thickness`` become empty.

        Parameters
        ----------
        thickness
            set voxels whose nearest empty center is at most so far stay [world].
        drain
            radius of a round hole through the shell [world]; 0: none.
        drain_side
            where the hole comes from: "x-low", "x-high", "y-low", "y-high", "z-low" or "z-high".
        drain_at
            the other two coordinates of its axis [world]; None: through the middle of the hollow's layer nearest to that side.
        beyond
            True when voxels beyond the window count as set.

        Returns
        -------
        Grid
            A grid (the body itself, with a warning, where the wall is thicker than the body) whose ``report`` has hollowed, drained
            (voxels) and drain (where the hole meets the hollow).

        Examples
        --------
        >>> grid = bitvox.Grid.from_numpy(np.ones((9, 9, 9)))
        >>> grid.hollow(2.0).report.hollowed
        125
        """
        options, report = options_of("hollow_options"), ffi.new("bvx_hollow_report *")
        options.thickness, options.drain_radius, options.beyond = thickness, drain, int(beyond)
        options.drain_side = choice("drain_side", drain_side, "BVX_OPEN_", SIDES)
        if drain_at is not None:
            if len(drain_at) != 2:
                raise ArgumentError(f"drain_at is {drain_at!r}; it takes two coordinates")
            options.drain_placed = 1
            options.drain_at[0], options.drain_at[1] = drain_at
        options.report = report
        made = new_grid()
        with Run(threads, memory_limit, progress) as run:
            run.check(lib.bvx_grid_hollow(run.context, self._c, options, made))
        found = record(report)
        if found.hollowed == 0 and self:
            warnings.warn(f"nothing is hollow: no voxel is deeper than the thickness of {thickness}" + (", and no hole is drilled" if drain else ""),
                          stacklevel=2)
        return Grid._made(made, found)

    @overload
    def distance(self, side: DistanceSide = ..., *, beyond: Beyond = ..., dtype: FloatName = ..., squares: bool = ..., nearest: Literal[False] = ...,
                 threads: int | None = ..., memory_limit: int | None = ..., progress: Progress = ...) -> Array: ...
    @overload
    def distance(self, side: DistanceSide = ..., *, beyond: Beyond = ..., dtype: FloatName = ..., squares: bool = ..., nearest: Literal[True],
                 threads: int | None = ..., memory_limit: int | None = ..., progress: Progress = ...) -> tuple[Array, Array]: ...
    def distance(self, side: DistanceSide = "outside", *, beyond: Beyond = "nothing", dtype: FloatName = "float32", squares: bool = False,
                 nearest: bool = False, threads: int | None = None, memory_limit: int | None = None, progress: Progress = None) -> Any:
        """Exact Euclidean distances between centers of voxels, an array ``[x, y, z]`` in memory with x running fastest.

        Parameters
        ----------
        side
            "outside": of every center to the nearest set one; "inside": to the nearest empty one; "signed": the first
            less the second, negative on set voxels.
        beyond
            what lies beyond the window: "nothing", "empty" or "set".
        dtype
            "float32" or "float64" [world].
        squares
            integers (uint32) of squared steps in place of lengths; for cubic voxels. 2^32 - 1: there is no such voxel.
        nearest
            also return where the distance is to: linear indices ``x + nx * (y + ny * z)``, uint64; 2^64 - 1: there is
            none, or beyond the window.

        Examples
        --------
        >>> grid = bitvox.Grid.from_numpy(np.array([[[1, 0, 0, 0]]]))
        >>> grid.distance().ravel().tolist()
        [0.0, 1.0, 2.0, 3.0]
        """
        np = arrays.numpy("Grid.distance")
        options = options_of("distance_options")
        options.side = choice("side", side, "BVX_DISTANCE_", DISTANCE_SIDES)
        options.beyond = choice("beyond", beyond, "BVX_BEYOND_", BEYONDS)
        kind = np.dtype("uint32" if squares else dtype)
        if kind not in (np.dtype("uint32"), np.dtype("float32"), np.dtype("float64")) or (kind == np.uint32) != squares:
            raise ArgumentError(f"dtype is {dtype!r}; it must be 'float32' or 'float64'")
        if squares and len(set(self.spacing)) > 1:
            a, b, c = self.spacing
            raise ArgumentError(f"squares counts steps of cubic voxels, and these are {a:g} x {b:g} x {c:g}; take squares=False")
        values = np.empty(self.shape[::-1], kind)
        places = np.empty(self.shape[::-1], np.uint64) if nearest else None
        if places is not None:
            options.nearest = ffi.cast("uint64_t *", places.ctypes.data)
        with Run(threads, memory_limit, progress) as run:
            number = lib.BVX_SQUARES if squares else lib.BVX_F32 if kind == np.float32 else lib.BVX_F64
            run.check(lib.bvx_grid_distance(run.context, self._c, options, number, ffi.cast("void *", values.ctypes.data), values.size))
        turned = values.transpose(2, 1, 0)
        return (turned, places.transpose(2, 1, 0)) if places is not None else turned

    # ---- others ----

    def surface(self, **options: Unpack[Surfacing]) -> Mesh:
        """The closed surface; ``options`` are those of `bitvox.surface`, ``mesh`` and ``offset`` among them.

        Examples
        --------
        >>> bitvox.voxelize('knot.ply', resolution=32).surface().check().closed
        True
        """
        made: Mesh = call("surface", self, **options)
        return made

    def to_pyvista(self) -> Any:
        """A pyvista.ImageData with the cell data "solid" (uint8), as the .vti that `save` writes has it.

        Examples
        --------
        >>> solid = bitvox.voxelize('knot.ply', resolution=16)
        >>> int(solid.to_pyvista().cell_data['solid'].sum()) == solid.count
        True
        """
        pyvista = need("pyvista", "view")
        image = pyvista.ImageData(dimensions=tuple(n + 1 for n in self.shape), spacing=self.spacing, origin=self.corner)
        image.cell_data["solid"] = self.to_numpy("zyx").reshape(-1).view("uint8")
        return image

    def to_trimesh(self) -> Any:
        """A trimesh VoxelGrid of the same voxels in the same place; needs ``bitvox[formats]``.

        Examples
        --------
        >>> int(bitvox.Grid.from_numpy(np.ones((2, 2, 2))).to_trimesh().filled_count)
        8
        """
        np, base = arrays.numpy("to_trimesh"), need("trimesh.voxel.base", "formats")
        place = np.diag([*self.spacing, 1.0])
        place[:3, 3] = self.center0
        return base.VoxelGrid(self.to_numpy(), transform=place)

    def to_napari(self, name: str | None = None) -> Any:
        """A labels layer of napari as it takes them, ``(data, options, "labels")``. Axes are z, y, x there.

        Parameters
        ----------
        name
            of the layer; None: "grid".

        Examples
        --------
        >>> data, options, kind = bitvox.voxelize('knot.ply', resolution=16).to_napari()
        >>> kind
        'labels'
        """
        placed = {"name": name or "grid", "scale": self.spacing[::-1], "translate": self.center0[::-1]}
        return self.to_numpy("zyx").view("uint8"), placed, "labels"

    def plot(self, **options: Any) -> Any:
        """Show its voxels in a window through PyVista; ``options`` are those of its ``plot``.

        Examples
        --------
        >>> bitvox.voxelize('knot.ply', resolution=64).plot()  # doctest: +SKIP
        """
        return self.to_pyvista().threshold(0.5, scalars="solid").plot(**options)

    def _repr_html_(self) -> str:
        return shown(self, {"voxels": self.shape, "set": self.count, "spacing": self.spacing, "corner": self.corner}, self._repr_png_())

    def _repr_png_(self) -> bytes | None:
        return call("render", self, size=(480, 360)).packed_png() if self else None

    def save(self, path: str | os.PathLike[str], format: str | None = None) -> None:
        """Write it to the file ``path``, in the format of its ending or in ``format``; see `bitvox.write`.

        Examples
        --------
        >>> bitvox.voxelize('knot.ply', resolution=32).save('solid.bvx')
        >>> bitvox.read('solid.bvx').shape[0]
        31
        """
        call("write", self, path, format=format)

    def __repr__(self) -> str:
        x, y, z = self.shape
        return f"Grid({x} x {y} x {z}, {self.count} set)"

    def __dask_tokenize__(self) -> Any:
        return (type(self).__name__, self.content_hash())

    def __reduce__(self) -> Any:
        size = self._c.size[2] * self._c.size[1] * self._c.words_per_row * 8
        data = bytes(ffi.buffer(self._c.words, size))
        if not arrays.LITTLE:
            data = self.words.astype("<u8").tobytes()
        kept = {name: value for name, value in (("report", self.report), ("attached", self.attached)) if value is not None}
        return _grid_from, (self.lattice, self.low, self.shape, data, kept)


def _grid_from(lattice: Lattice, low: Any, shape: Any, data: bytes, kept: Any = ()) -> Grid:
    grid = Grid(lattice, (low, shape))
    if not arrays.LITTLE:
        data = arrays.numpy("unpickling").frombuffer(data, "<u8").astype("u8").tobytes()
    if len(data) != 8 * grid._c.words_per_row * grid._c.size[1] * grid._c.size[2]:
        raise FormatError(f"{len(data)} bytes are not those of a grid of shape {grid.shape}")
    ffi.memmove(grid._c.words, data, len(data))
    for name in kept:
        setattr(grid, name, kept[name])
    return grid


def triple_of(values: Any, name: str = "factor", least: int = 0) -> Any:
    """Three integers as the library takes them."""
    return arrays.triple(name, in_range(name, values, least, 2**25) if isinstance(values, (int, float)) else values, int)


def axis_of(name: str, axis: Any) -> int:
    """0, 1 or 2 from "x", "y", "z" or the number itself."""
    return "xyz".index(axis) if axis in ("x", "y", "z") else in_range(name, axis, 0, 2)


def new_grid() -> Any:
    """An empty bvx_grid that is freed with the last thing that looks at it."""
    return ffi.gc(ffi.new("bvx_grid *"), lib.bvxpy_free_grid)
