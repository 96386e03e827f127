"""Where voxels lie: lattices and windows of them."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple, Sequence, Union

from ._arrays import triple
from ._calls import call
from ._errors import ArgumentError, OptionRangeError, RangeError
from ._html import shown
from ._run import Run, ffi, in_range, lib, options_of


class Window(NamedTuple):
    """A box of a lattice: voxels ``low .. low + size - 1`` along x, y, z.

    Examples
    --------
    >>> grid = bitvox.voxelize('knot.ply', resolution=32, window=bitvox.Window((8, 8, 4), (16, 8, 4)))
    >>> grid.shape
    (16, 8, 4)
    """

    low: tuple[int, int, int]
    size: tuple[int, int, int]


WindowLike = Union[Window, Sequence[Any], None]


def set_window(name: str, target: Any, window: WindowLike) -> None:
    """Fill a bvx_window from a Window, from (low, size) or from (x0, y0, z0, x1, y1, z1) as the program takes it."""
    if window is None:
        return
    parts = tuple(window)
    if len(parts) == 6:
        low, high = triple(name, parts[:3], int), triple(name, parts[3:], int)
        size = tuple(b - a for a, b in zip(low, high))
    elif len(parts) == 2:
        low, size = triple(name, parts[0], int), triple(name, parts[1], int)
    else:
        raise ArgumentError(f"{name} must be (low, size) or six numbers x0, y0, z0, x1, y1, z1")
    if min(size) < 1:
        raise ArgumentError(f"{name} has no voxels: its size is {size}")
    target.low, target.size = low, size


class Lattice:
    """A regular lattice of voxels in space.

    Voxel ``(i, j, k)`` is the box from ``corner + ijk * spacing`` to ``corner + (ijk + 1) * spacing``; samples are taken
    at its center. Two lattices are equal when all their fields are.

    Parameters
    ----------
    shape
        voxels along x, y and z, each 1 to 2**25.
    spacing
        edges of a voxel, one number or three [world].
    corner
        low corner of voxel (0, 0, 0) [world].

    Raises
    ------
    RangeError
        a number out of range, or a lattice beyond what doubles tell apart.

    Examples
    --------
    >>> bitvox.Lattice((4, 5, 6), spacing=0.5, corner=(1, 2, 3)).center0
    (1.25, 2.25, 3.25)
    """

    __slots__ = ("_c",)

    def __init__(self, shape: Sequence[int], spacing: Any = 1.0, corner: Sequence[float] = (0.0, 0.0, 0.0)) -> None:
        self._c = ffi.new("bvx_lattice *")
        with Run() as run:
            run.check(lib.bvx_lattice_make(run.context, triple("corner", corner), triple("spacing", spacing),
                                           triple("shape", shape, int), self._c))

    @classmethod
    def _of(cls, struct: Any) -> Lattice:
        self = cls.__new__(cls)
        self._c = ffi.new("bvx_lattice *", struct[0] if ffi.typeof(struct).kind == "pointer" else struct)
        return self

    @classmethod
    def fit(cls, mesh: Any, *, resolution: int | Sequence[int] | None = None, spacing: Any = None, padding: int = 0, corner: Any = None) -> Lattice:
        """A lattice around a mesh, low-aligned: the least shape that covers the bounds.

        Parameters
        ----------
        mesh
            what `bitvox.Mesh.of` takes.
        resolution
            voxels along the longest axis (cubic voxels), or three numbers, one for each axis. Default 256.
        spacing
            edges of a voxel, in place of a resolution [world].
        padding
            empty voxels added on every side.
        corner
            low corner of voxel (0, 0, 0), with ``spacing`` and without ``padding``, in place of the mesh's own [world].

        Examples
        --------
        >>> bitvox.Lattice.fit('knot.ply', resolution=32).shape
        (31, 32, 13)
        """
        source = call("mesh_of", mesh)
        with Run() as run:
            return cls._fitted(run, source._view(run), resolution, spacing, padding, corner)

    @classmethod
    def fit_points(cls, points: Any, *, resolution: int | Sequence[int] | None = None, spacing: Any = None, padding: int = 0, corner: Any = None) -> Lattice:
        """A lattice around a cloud of points, as `fit` makes it around a mesh.

        Parameters
        ----------
        points
            (n, 3) numbers, or what `bitvox.voxelize_points` takes.
        resolution, spacing, padding, corner
            as for `fit`.

        Examples
        --------
        >>> bitvox.Lattice.fit_points([[0, 0, 0], [4, 2, 1]], resolution=8).shape
        (8, 4, 2)
        """
        with Run() as run:
            return cls._fitted(run, call("points_view", points, run), resolution, spacing, padding, corner)

    @classmethod
    def fit_box(cls, low: Sequence[float], high: Sequence[float], *, resolution: int | Sequence[int] | None = None, spacing: Any = None, padding: int = 0,
                corner: Any = None) -> Lattice:
        """A lattice around a box, as `fit` makes it around a mesh with these bounds.

        Parameters
        ----------
        low, high
            corners of the box [world].
        resolution, spacing, padding, corner
            as for `fit`.

        Examples
        --------
        >>> bitvox.Lattice.fit_box((0, 0, 0), (4, 2, 1), spacing=0.5).shape
        (8, 4, 2)
        """
        ends = triple("low", low), triple("high", high)
        finite = all(map(math.isfinite, (*ends[0], *ends[1])))  # else the library names the vertex
        for axis, a, b in zip("xyz", *ends):
            if finite and a > b:
                raise ArgumentError(f"low is above high along {axis}: {a} and {b}")
        with Run() as run:
            return cls._fitted(run, call("points_view", ends, run), resolution, spacing, padding, corner)

    @classmethod
    def _fitted(cls, run: Run, view: Any, resolution: Any, spacing: Any, padding: int, corner: Any) -> Lattice:
        if corner is not None and (spacing is None or padding):
            raise ArgumentError("corner is taken together with spacing, and without padding")
        if corner is not None and not all(map(math.isfinite, triple("corner", corner))):
            raise RangeError(f"corner is {tuple(corner)}; its numbers must be finite")
        options = options_of("lattice_options")
        if spacing is not None:
            if resolution is not None:
                raise ArgumentError("resolution and spacing contradict each other; give one of them")
            options.spacing = steps = triple("spacing", spacing)
            if not all(0.0 < s < math.inf for s in steps):
                raise OptionRangeError(f"spacing is {spacing}; it must be finite and above 0")
        elif resolution is None:
            options.resolution = 256
        elif isinstance(resolution, (list, tuple)) or getattr(resolution, "ndim", None):
            options.axis_resolution = triple("resolution", resolution, int)
        else:
            options.resolution = in_range("resolution", resolution, 1, 2**25)
        options.padding = in_range("padding", padding, 0, 65536)
        self = cls.__new__(cls)
        self._c = ffi.new("bvx_lattice *")
        run.check(lib.bvx_lattice_fit_with(run.context, view, options, self._c))
        return self if corner is None else self._from_corner(triple("corner", corner))

    def _from_corner(self, corner: tuple[float, float, float]) -> Lattice:
        """From a given corner up to the end of a lattice that covers a mesh."""
        ends = (c + n * s for c, n, s in zip(self.corner, self.shape, self.spacing))
        counts = (-math.floor((a - b) / s) for a, b, s in zip(corner, ends, self.spacing))
        return Lattice([min(max(1, n), 2**31 - 1) for n in counts], self.spacing, corner)

    @property
    def shape(self) -> tuple[int, int, int]:
        """Voxels along x, y, z."""
        return tuple(self._c.dims)  # type: ignore[return-value]

    @property
    def spacing(self) -> tuple[float, float, float]:
        """Edges of a voxel along x, y, z [world]."""
        return tuple(self._c.spacing)  # type: ignore[return-value]

    @property
    def corner(self) -> tuple[float, float, float]:
        """Low corner of voxel (0, 0, 0) [world]."""
        return tuple(self._c.origin)  # type: ignore[return-value]

    @property
    def center0(self) -> tuple[float, float, float]:
        """Center of voxel (0, 0, 0) [world]."""
        return tuple(o + 0.5 * s for o, s in zip(self.corner, self.spacing))  # type: ignore[return-value]

    @property
    def origin(self) -> tuple[float, float, float]:
        """`center0` under the name that SimpleITK and NRRD have for it [world]; the library and the program call the `corner` so."""
        return self.center0

    @property
    def bounds(self) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
        """Low and high corner of all its voxels: ((x, y, z), (x, y, z)) [world]."""
        return self.corner, tuple(a + n * s for a, n, s in zip(self.corner, self.shape, self.spacing))  # type: ignore[return-value]

    @property
    def fraction_bits(self) -> int:
        """Fixed-point bits below a voxel, to which vertices are snapped."""
        return self._c.fraction_bits

    def _key(self) -> tuple[Any, ...]:
        return (self.shape, self.spacing, self.corner, self.fraction_bits)

    def __eq__(self, other: object) -> bool:
        return self._key() == other._key() if isinstance(other, Lattice) else NotImplemented

    def __hash__(self) -> int:
        return hash(self._key())

    def __reduce__(self) -> Any:
        return _lattice_from, self._key()

    def _repr_html_(self) -> str:
        return shown(self, {"voxels": self.shape, "spacing": self.spacing, "corner": self.corner})

    def __repr__(self) -> str:
        return f"Lattice(shape={self.shape}, spacing={self.spacing}, corner={self.corner})"


class Placed:
    """Where something lies that has a ``lattice`` and fills it."""

    __slots__ = ()

    if TYPE_CHECKING:

        @property
        def lattice(self) -> Lattice: ...

    @property
    def shape(self) -> tuple[int, int, int]:
        """Voxels along x, y, z."""
        return self.lattice.shape

    @property
    def spacing(self) -> tuple[float, float, float]:
        """Edges of a voxel [world]."""
        return self.lattice.spacing

    @property
    def corner(self) -> tuple[float, float, float]:
        """Low corner of the first voxel [world]."""
        return self.lattice.corner

    @property
    def center0(self) -> tuple[float, float, float]:
        """Center of the first voxel [world]."""
        return self.lattice.center0

    @property
    def origin(self) -> tuple[float, float, float]:
        """`center0` under the name that SimpleITK and NRRD have for it [world]; the library and the program call the `corner` so."""
        return self.center0

    @property
    def bounds(self) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
        """Low and high corner of all voxels: ((x, y, z), (x, y, z)) [world]."""
        return self.lattice.bounds


def place(source: Any, resolution: Any, spacing: Any, padding: int, lattice: Lattice | None, corner: Any = None) -> Lattice:
    """The lattice that was given, or one fitted to the mesh."""
    if lattice is None:
        return Lattice.fit(source, resolution=resolution, spacing=spacing, padding=padding, corner=corner)
    given = {"resolution": resolution, "spacing": spacing, "padding": padding or None, "corner": corner}
    for name, value in given.items():
        if value is not None:
            raise ArgumentError(f"{name} and lattice contradict each other; give one of them")
    return lattice


def _lattice_from(shape: Any, spacing: Any, corner: Any, fraction_bits: int) -> Lattice:
    self = Lattice.__new__(Lattice)
    self._c = ffi.new("bvx_lattice *", {"origin": corner, "spacing": spacing, "dims": shape, "fraction_bits": fraction_bits})
    return self
