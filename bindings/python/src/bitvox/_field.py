"""Distance fields."""

from __future__ import annotations

import math
import os
from typing import TYPE_CHECKING, Any, ClassVar, Sequence

from . import _arrays as arrays
from ._calls import call
from ._errors import ArgumentError, need
from ._grid import Grid
from ._html import shown
from ._lattice import Lattice, WindowLike, place, set_window
from ._mesh import Mesh, position_type, with_positions
from ._options import FieldOptions
from ._records import record
from ._run import FACE_RULES, SIGN_RULES, Progress, Run, choice, ffi, function, known, lib, name_of, names_of, options_of, sharpness
from ._words import Array, FaceRule, Interpolation, Order, Sign

if TYPE_CHECKING:
    from typing_extensions import Unpack

EDGES = names_of("BVX_EDGE_")


class Field:
    """Distances from the centers of voxels to a mesh; made by `bitvox.field`.

    Value n belongs to set voxel n of ``band``, in the order of its bits (z, y, x), which is that of ``band.voxels()``.

    Examples
    --------
    >>> field = bitvox.field('knot.ply', resolution=24)
    >>> bool(field.distances.min() < 0 < field.distances.max())
    True
    """

    __slots__ = ("_c", "_mesh", "__weakref__")

    def __init__(self, owner: Any, mesh: Mesh) -> None:
        self._c, self._mesh = owner, mesh

    def _grid(self, part: Any) -> Grid | None:
        if part.words == ffi.NULL:
            return None
        owner = self._c
        kept = ffi.gc(ffi.new("bvx_grid *", part), lambda _, owner=owner: None)
        kept.owned = 0
        return Grid._made(kept)

    @property
    def band(self) -> Grid:
        """The centers that have a value; no copy."""
        return self._grid(self._c.band)  # type: ignore[return-value]

    @property
    def inside(self) -> Grid | None:
        """The centers inside, in all of the window; None for sign "none"; no copy."""
        return self._grid(self._c.inside)

    @property
    def lattice(self) -> Lattice:
        """The lattice that it was measured on."""
        return Lattice._of(self._c.band.lattice)

    @property
    def shape(self) -> tuple[int, int, int]:
        """Voxels of its window along x, y, z."""
        return tuple(self._c.band.size)  # type: ignore[return-value]

    @property
    def spacing(self) -> tuple[float, float, float]:
        """Edges of a voxel [world]."""
        return self.band.spacing

    @property
    def corner(self) -> tuple[float, float, float]:
        """Low corner of the first voxel of its window [world]."""
        return self.band.corner

    @property
    def center0(self) -> tuple[float, float, float]:
        """Center of the first voxel of its window, where its first value is [world]."""
        return self.band.center0

    @property
    def origin(self) -> tuple[float, float, float]:
        """`center0` under the name that SimpleITK and NRRD have for it [world]; the library and the program call the `corner` so."""
        return self.center0

    @property
    def bounds(self) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
        """Low and high corner of its window [world]."""
        return self.band.bounds

    @property
    def half_width(self) -> float:
        """Of the band [largest spacings], as `field` takes it; infinity: every center has a value."""
        return round(self._c.half_width / max(self.spacing), 12)  # the library keeps the product

    @property
    def sign(self) -> str:
        """The rule that decided what is inside."""
        return name_of(self._c.sign, "BVX_FILL_", SIGN_RULES)

    def _values(self, pointer: Any, columns: int, dtype: str | None = None) -> Any:
        if pointer == ffi.NULL:
            return None
        n = self._c.value_count
        kind = dtype or ("float32" if self._c.value_type == lib.BVX_F32 else "float64")
        return arrays.array_at(pointer, kind, (n, columns) if columns > 1 else (n,), self._c)

    @property
    def distances(self) -> Array:
        """(n,) distances to the closest points, negative inside [world]; read-only, no copy."""
        return self._values(self._c.distances, 1)

    @property
    def vectors(self) -> Array | None:
        """(n, 3) from centers to closest points [world], or None; read-only, no copy."""
        return self._values(self._c.vectors, 3)

    @property
    def triangles(self) -> Array | None:
        """(n,) uint32 closest triangles, or None; read-only, no copy."""
        return self._values(self._c.triangles, 1, "uint32")

    @property
    def features(self) -> Array | None:
        """(n,) uint8 where on the triangle: 0 inside, 1 2 3 edges, 4 5 6 corners; or None; read-only, no copy."""
        return self._values(self._c.features, 1, "uint8")

    @property
    def row_values(self) -> Any:
        """Index of each row's first value, row ``z * shape[1] + y``; read-only, no copy."""
        return arrays.array_at(self._c.row_values, "uint64", (self.shape[1] * self.shape[2] + 1,), self._c)

    def value(self, voxel: Any) -> int | None:
        """Index of the value at voxel (x, y, z) of the window, or None where it has none.

        Examples
        --------
        >>> field = bitvox.field('knot.ply', resolution=24)
        >>> voxel = field.band.voxels()[0]
        >>> field.value(voxel)
        0
        """
        x, y, z = arrays.triple("voxel", voxel, int)
        nx, ny, nz = self.shape
        if not (0 <= x < nx and 0 <= y < ny and 0 <= z < nz):
            raise IndexError(f"voxel {(x, y, z)} is not in a field of shape {self.shape}")
        number = lib.bvx_field_value(self._c, x, y, z)
        return None if number == 2**64 - 1 else number

    def to_numpy(self, order: Order = "xyz", *, vectors: bool = False, threads: int | None = None,
                 memory_limit: int | None = None, progress: Progress = None) -> Array:
        """Every center of the window as float32: ``array[x, y, z]`` or, with order "zyx", ``array[z, y, x]``.

        Where the band has no value stands the half width, negative inside, or a vector of 0.

        Parameters
        ----------
        vectors
            the vectors, with one more axis of three, in place of signed distances.

        Examples
        --------
        >>> field = bitvox.field('knot.ply', resolution=24)
        >>> field.to_numpy().shape == field.shape
        True
        """
        np = arrays.numpy("Field.to_numpy")
        if order not in ("xyz", "zyx"):
            raise ArgumentError(f"order is {order!r}; it must be 'xyz' or 'zyx'")
        nx, ny, nz = self.shape
        made = np.empty((nz, ny, nx, 3) if vectors else (nz, ny, nx), np.float32)
        with Run(threads, memory_limit, progress) as run:
            run.check(lib.bvx_field_dense(run.context, self._c, int(bool(vectors)), ffi.cast("float *", arrays.address(made))))
        if order == "zyx":
            return made
        return made.transpose(2, 1, 0, 3) if vectors else made.transpose(2, 1, 0)

    def surface(
        self,
        *,
        interpolation: Interpolation = "tangent",
        face_rule: FaceRule = "separate",
        sharp: bool | None = False,
        sharp_angle: float | None = None,
        grid: Grid | None = None,
        offset: float = 0.0,
        dtype: Any = None,
        local_frame: bool = False,
        threads: int | None = None,
        memory_limit: int | None = None,
        progress: Progress = None,
    ) -> Mesh:
        """The closed surface between inside and outside centers, with vertices where the field has it.

        Parameters
        ----------
        interpolation
            "tangent" (by the planes at the closest points, nearest to the mesh), "vector" (by the line through
            these points), "scalar" (by the signed distances), "middle" or "paper" (vector with the paper's clamps).
        face_rule, dtype, local_frame
            as for `bitvox.surface`.
        sharp
            cells on sharp edges and corners get a vertex there: always, never, or (None) where many of the mesh's edges
            are sharp; ``sharp_angle`` is the cosine between facets that still count as smooth (default 0.8).
        grid
            other voxels of the field's window, whose surface is wanted in place of that of ``inside``: where both are the
            same, vertices are the mesh's, elsewhere those of ``offset``, or in the middle between set and empty ones.
        offset
            with ``grid``: where this distance to the mesh, negative inside, lies between a set and an empty center, the
            surface passes there: ``-t`` for the inner wall of a hollow body of thickness t [world].

        Returns
        -------
        Mesh
            A `Mesh`; ``mesh.report`` is a `bitvox.reports.FieldSurfaceReport`.

        Examples
        --------
        >>> field = bitvox.field('knot.ply', resolution=24)
        >>> field.surface(sharp=True).check().closed
        True
        """
        options = options_of("field_surface_options")
        options.placing.interpolation = choice("interpolation", interpolation, "BVX_EDGE_", EDGES)
        options.placing.face_rule = choice("face_rule", face_rule, "BVX_FACE_", FACE_RULES)
        options.placing.sharp = sharpness(sharp)
        options.placing.local_frame = int(bool(local_frame))
        if offset and grid is None:
            raise ArgumentError("offset is taken together with grid")
        if grid is not None:
            options.grid, options.offset = grid._c, float(offset)
        if sharp_angle is not None:
            if sharp is False:
                raise ArgumentError("sharp_angle is taken together with sharp")
            options.sharp_angle = float(sharp_angle) or 5e-324  # 0 is the default
        report = ffi.new("bvx_field_surface_report *")
        options.report = report
        extract = function("bvx_extract_field_surface")
        made = with_positions(options, dtype, lambda run, out: extract(run.context, self._c, self._mesh._view(run), options, out),
                              threads=threads, memory_limit=memory_limit, progress=progress)
        made.report = record(report)
        return made

    def to_pyvista(self, *, vectors: bool = False) -> Any:
        """A pyvista.ImageData with the point data "distance" (points are the voxels' centers, as in the .vti that `save` writes) and, with
        ``vectors``, "vector".

        Examples
        --------
        >>> bitvox.field('knot.ply', resolution=24).to_pyvista().array_names
        ['distance']
        """
        pyvista, band = need("pyvista", "view"), self.band
        image = pyvista.ImageData(dimensions=self.shape, spacing=band.spacing, origin=band.center0)
        image.point_data["distance"] = self.to_numpy("zyx").reshape(-1)
        if vectors:
            image.point_data["vector"] = self.to_numpy("zyx", vectors=True).reshape(-1, 3)
        return image

    def save(self, path: str | os.PathLike[str], format: str | None = None, *, vectors: bool = False) -> None:
        """Write signed distances, or ``vectors``, to ``path`` as .npy, .nrrd, .vti, .vdb or .nvdb (both distances only; or ``format``, in place of the ending).

        Examples
        --------
        >>> field = bitvox.field('knot.ply', resolution=24)
        >>> field.save('distance.vti')
        """
        call("write", self, path, format=format, vectors=vectors)

    def _repr_html_(self) -> str:
        return shown(self, {"voxels": self.shape, "values": self._c.value_count, "half width": self.half_width, "sign": self.sign,
                            "spacing": self.band.spacing, "corner": self.band.corner})

    def __array__(self, dtype: Any = None, copy: Any = None) -> Any:
        if copy is False:
            raise ValueError("a field is a band: an array of all centers is always a copy")
        return arrays.handed(self.to_numpy(), dtype)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Field):
            return NotImplemented
        np = arrays.numpy("Field")
        mine, theirs = self._state(), other._state()
        return all(a is None and b is None or type(a) is type(b) and (np.array_equal(a, b) if isinstance(a, np.ndarray) else a == b)
                   for a, b in zip(mine, theirs))

    __hash__: ClassVar[None] = None  # type: ignore[assignment]

    def _state(self) -> tuple[Any, ...]:
        c = self._c
        return (self.band, self.inside, self.row_values, self.distances, self.vectors, self.triangles, self.features, c.value_type, c.sign,
                c.half_width)

    def __reduce__(self) -> Any:
        np = arrays.numpy("pickling")
        return _field_from, (self._mesh, *(np.array(a) if isinstance(a, np.ndarray) else a for a in self._state()))

    def __repr__(self) -> str:
        x, y, z = self.shape
        return f"Field({x} x {y} x {z}, {self._c.value_count} values, sign {self.sign})"


def _field_from(mesh: Mesh, band: Grid, inside: Grid | None, rows: Any, distances: Any, vectors: Any, triangles: Any, features: Any,
                value_type: int, sign: int, half_width: float) -> Field:
    """A field over arrays that Python holds."""
    made, kept = ffi.new("bvx_field *"), (band, inside, rows, distances, vectors, triangles, features)
    for grid, part in ((band, made.band), (inside, made.inside)):
        if grid is not None:
            ffi.memmove(ffi.addressof(part), grid._c, ffi.sizeof("bvx_grid"))
            part.owned = 0
    made.row_values, made.value_count = ffi.cast("uint64_t *", arrays.address(rows)), int(rows[-1])
    made.distances = arrays.address(distances)
    for name, values, kind in (("vectors", vectors, "void *"), ("triangles", triangles, "uint32_t *"), ("features", features, "uint8_t *")):
        if values is not None:
            setattr(made, name, ffi.cast(kind, arrays.address(values)))
    made.value_type, made.sign, made.half_width = value_type, sign, half_width
    return Field(ffi.gc(made, lambda _, kept=kept: None), mesh)


def _touches_side(grid: Grid) -> bool:
    """A voxel at a side of the window is set."""
    inner = tuple(n - 2 for n in grid.shape)
    return min(inner) < 1 or grid.crop(((1, 1, 1), inner)).count != grid.count


def surface_of_mesh(grid: Grid, mesh: Any, offset: float, **options: Any) -> Mesh:
    """The surface of voxels that were made from a mesh: `Field.surface` of a field measured as far as the offset."""
    # An edge of the lattice that leaves it has no value at its other end. Where no voxel lies at a side there is none.
    if (grid.low, grid.shape) == ((0, 0, 0), grid.lattice.shape) and _touches_side(grid):
        grid = grid.pad(1)
    far = 2.0 + abs(float(offset)) / max(grid.lattice.spacing)
    limits: dict[str, Any] = {name: options.get(name) for name in ("threads", "memory_limit", "progress")}
    window = (grid.low, grid.shape)
    measured = field(mesh, lattice=grid.lattice, window=window, half_width=far, features=True, **limits)
    return measured.surface(grid=grid, offset=offset, **options)


def field(
    mesh: Any,
    *,
    resolution: int | Sequence[int] | None = None,
    spacing: Any = None,
    corner: Sequence[float] | None = None,
    padding: int | None = None,
    lattice: Lattice | None = None,
    half_width: float = 3.0,
    sign: Sign = "auto",
    dtype: Any = "float32",
    window: WindowLike = None,
    threads: int | None = None,
    memory_limit: int | None = None,
    progress: Progress = None,
    **advanced: Unpack[FieldOptions],
) -> Field:
    """Measure the distance from the centers of voxels to a mesh.

    Parameters
    ----------
    mesh
        what `Mesh.of` takes.
    resolution, spacing, corner
        as for `voxelize`; or a ``lattice``.
    padding
        empty voxels added on every side. Default: the half-width, so that the band fits, but at most 16 (3 without a band; 0
        with a ``corner``).
    half_width
        of the band: centers so near to the mesh have a value [largest spacings]; 0 or infinity: all centers.
    sign
        what decides that a center is inside: "parity" (as the fill), "winding" (holes and overlaps), "vote" (holes
        and flipped triangles), "normal" (the side of the closest triangle), "none", or "auto":
        inside is what fill "auto" has inside.
    dtype
        of the values, float32 or float64 (the program's ``--value-type``).
    window
        only this box of the lattice.
    advanced
        `FieldOptions`: ``vectors``, ``features``.

    Returns
    -------
    Field
        A `Field`.

    Raises
    ------
    ArgumentError
        options that contradict each other.
    EmptyError
        no triangle of area.
    RangeError, MemoryLimitError

    Examples
    --------
    >>> bitvox.field('knot.ply', resolution=24, half_width=2).surface().check().closed
    True
    """
    known(field, FieldOptions, advanced)
    measure = function("bvx_measure_field")
    options = options_of("field_options")
    width = float(half_width) or math.inf
    options.half_width, options.value_type = width, position_type(dtype)
    options.sign = choice("sign", sign, "BVX_FILL_", SIGN_RULES)
    options.no_vectors, options.features = int(not advanced.get("vectors", True)), int(bool(advanced.get("features")))
    set_window("window", options.window, window)
    source = Mesh.of(mesh)
    if padding is None:  # room for the band around the mesh
        padding = 0 if lattice is not None or corner is not None else 3 if math.isinf(width) else math.ceil(min(width, 16.0)) if width > 0.0 else 3
    where = place(source, resolution, spacing, padding, lattice, corner)
    made = ffi.gc(ffi.new("bvx_field *"), function("bvxpy_free_field"))
    with Run(threads, memory_limit, progress) as run:
        run.check(measure(run.context, source._view(run), where._c, options, made))
    return Field(made, source)
