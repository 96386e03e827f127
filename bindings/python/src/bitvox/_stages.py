"""The stages as functions: voxelize, surface, faces, repair, and what goes with them; levels of detail are in _levels."""

from __future__ import annotations

import math
import os
import warnings
from typing import TYPE_CHECKING, Any, ClassVar, Iterable, Literal, NamedTuple, Sequence

from . import _arrays as arrays
from ._calls import call, entered
from ._errors import ArgumentError
from ._field import EDGES, surface_of_mesh
from ._grid import Attached, Grid, new_grid
from ._html import shown
from ._lattice import Lattice, WindowLike, place, set_window
from ._mesh import Mesh, new_mesh, used_bounds, with_positions
from ._options import BooleanOptions, RepairOptions, VoxelizeOptions
from ._records import record
from ._run import (FACE_RULES, FILLS, REPAIR_SIGNS, Progress, Rise, Run, choice, ffi, function, in_range, known, lib, names_of, options_of,
                   or_none, put_open_sides, quiet, sharpness)
from ._words import Array, Axis, BooleanFill, ErrorKind, FaceRule, Fill, Mode, Operation, RepairSign

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from .reports import Certificate, Difference, Distances, Finding, InspectReport, Seed

OPERATIONS = names_of("BVX_BOOLEAN_")
MODES = ("solid", "conservative", "thin", "sampled")
THIN_CHECKS = names_of("BVX_CHECK_")


def voxelize(
    mesh: Any,
    *,
    resolution: int | Sequence[int] | None = None,
    spacing: Any = None,
    corner: Sequence[float] | None = None,
    padding: int = 0,
    lattice: Lattice | None = None,
    window: WindowLike = None,
    mode: Mode = "solid",
    fill: Fill | None = None,
    attached: bool = False,
    threads: int | None = None,
    memory_limit: int | None = None,
    progress: Progress = None,
    **advanced: Unpack[VoxelizeOptions],
) -> Grid:
    """The voxels of a mesh: what lies inside it, or what its surface touches.

    Parameters
    ----------
    mesh
        what `Mesh.of` takes: (vertices, faces), a mesh of trimesh, PyVista, Open3D or meshio, a file's name.
    resolution
        voxels along the longest axis, or three numbers, one for each axis. Default 256.
    spacing
        edges of a voxel, one number or three, in place of a resolution [world].
    corner
        low corner of voxel (0, 0, 0), with ``spacing`` and without ``padding`` (the program's ``--origin``) [world].
    padding
        empty voxels added on every side.
    lattice
        a `Lattice` to work on, in place of all these.
    window
        only this box of the lattice: (low, size) or (x0, y0, z0, x1, y1, z1).
    mode
        "solid": voxels whose centers lie inside. "conservative": all voxels that the surface touches. "thin": those that
        keep a flood through faces out. "sampled": those of points less than a voxel apart.
    fill
        what is inside: "auto" (the default: parity where closed shells do not cross, nonzero where they do, winding where
        there are holes, flipped triangles turned before; ``grid.report.fill`` and ``fill_reason`` say which and why), "parity"
        (nested shells are cavities), "nonzero" (overlapping and inverted shells are one solid), "vote" (majority of three axes:
        whichever way triangles face), "flood" (what a flood from outside cannot reach), "regions" (each region that the surface
        separates, as a whole), "below" (all under a terrain), "winding" (more than half a turn: holes and overlaps).
    attached
        surface modes: keep the triangles that touch each voxel in ``grid.attached``.
    advanced
        `VoxelizeOptions`: ``close_gaps``, ``add_shell``, ``check_thin``, ``base``, ``second``, ``up``.

    Returns
    -------
    Grid
        A `Grid`; ``grid.report`` is a `bitvox.reports.SolidReport` or a `bitvox.reports.SurfaceReport`.

    Raises
    ------
    ArgumentError
        options that contradict each other, or that the mode or the rule does not take.
    EmptyError
        no triangles.
    RangeError
        coordinates or vertex indices, the first one named.
    MemoryLimitError

    Examples
    --------
    >>> solid = bitvox.voxelize('knot.ply', resolution=32)
    >>> solid.shape[0], solid.report.fill
    (31, 'parity')
    >>> touched = bitvox.voxelize('knot.ply', lattice=solid.lattice, mode='conservative')
    >>> (solid - touched) <= solid
    True
    """
    known(voxelize, VoxelizeOptions, advanced)
    of_solids: dict[str, Any] = {"fill": fill, **advanced}
    close_gaps, check_thin, base, second, up = (of_solids.get(name) for name in ("close_gaps", "check_thin", "base", "second", "up"))
    source = Mesh.of(mesh)
    where = place(source, resolution, spacing, padding, lattice, corner)
    if lattice is None and fill == "below" and (second is not None or base is not None):
        second = None if second is None else Mesh.of(second)
        where = Lattice.fit_box(*_terrain_box(source, second, base, up), resolution=resolution, spacing=spacing, padding=padding, corner=corner)
    if corner is not None and source.n_vertices and any(a < b for a, b in zip(source.bounds[0], where.corner)):
        warnings.warn(f"the mesh begins at {source.bounds[0]}, below the corner {where.corner}: what lies below it is left out", stacklevel=2)
    made = new_grid()
    if choice_of_mode(mode) != "solid":
        for name, value in of_solids.items():
            if value is not None and value is not False:
                raise ArgumentError(f"{name} is for mode 'solid', not for {mode!r}")
        return _surface_voxels(source, where, window, choice_of_mode(mode), attached, made, threads, memory_limit, progress)
    if attached:
        raise ArgumentError("attached is for the modes of surfaces: conservative, thin, sampled")
    options = options_of("voxelize_options")
    options.fill = choice("fill", "auto" if fill is None else fill, "BVX_FILL_", FILLS)
    set_window("window", options.window, window)
    if options.fill != lib.BVX_FILL_BELOW:
        for name, value in {"base": base, "second": second, "up": up}.items():
            if value is not None:
                raise ArgumentError(f"{name} is for fill 'below'")
    if close_gaps is not None:
        if options.fill != lib.BVX_FILL_FLOOD:
            raise ArgumentError("close_gaps is for fill 'flood'")
        options.close_gaps = in_range("close_gaps", close_gaps, 0, 65535)
    options.add_shell = int(bool(advanced.get("add_shell")))
    if check_thin is not None:
        options.check_thin = choice("check_thin", check_thin, "BVX_CHECK_", THIN_CHECKS)
    if base is not None:
        options.has_base, options.base = 1, float(base)
    if up is not None:
        if up not in ("x", "y", "z"):
            raise ArgumentError(f"up is {up!r}; it must be x, y or z")
        options.up = choice("up", up, "BVX_UP_", ("x", "y", "z"))
    report = ffi.new("bvx_solid_report *")
    options.report = report
    with Run(threads, memory_limit, progress) as run:
        if second is not None:
            other = Mesh.of(second)._view(run)
            options.second = other
        run.check(lib.bvx_voxelize_solid(run.context, source._view(run), where._c, options, made))
    solid = Grid._made(made, record(report))
    if not solid and window is None and lattice is None:
        warnings.warn("the result is empty: the mesh contains no voxel's center; a finer resolution, or mode='conservative', which sets the "
                      "voxels of its surface, may have more", stacklevel=2)
    return solid


def _terrain_box(source: Mesh, second: Mesh | None, base: float | None, up: str | None) -> tuple[list[float], list[float]]:
    """What holds the triangles of both terrains, and reaches down to the base."""
    boxes = [used_bounds(source)]
    if second is not None:
        Lattice.fit(second, resolution=1)  # refuses what has no box
        boxes.append(used_bounds(second))
    low, high = [min(box[0][a] for box in boxes) for a in range(3)], [max(box[1][a] for box in boxes) for a in range(3)]
    axis = {"x": 0, "y": 1}.get(up or "z", 2)
    # Columns go down to the base, which may lie below the terrain. What is no height is refused by the library.
    if base is not None and math.isfinite(base):
        low[axis] = min(low[axis], float(base))
    return low, high


def choice_of_mode(mode: str) -> str:
    """The mode's plain name, or an error."""
    plain = mode.lower() if isinstance(mode, str) else mode
    if plain == "field":
        raise ArgumentError("distances are measured by bitvox.field, not by a mode of voxelize")
    if plain not in MODES:
        raise ArgumentError(f"mode is {mode!r}; it must be one of {', '.join(MODES)}")
    return plain


def _surface_voxels(source: Mesh, where: Lattice, window: WindowLike, mode: str, attached: bool, made: Any, threads: Any,
                    memory_limit: Any, progress: Progress) -> Grid:
    options = options_of("surface_options")
    options.mode = choice("mode", mode, "BVX_SURFACE_", MODES)
    set_window("window", options.window, window)
    report = ffi.new("bvx_surface_report *")
    options.report = report
    pairs = ffi.gc(ffi.new("bvx_attached *"), lib.bvxpy_free_attached) if attached else ffi.NULL
    options.attached = pairs
    with Run(threads, memory_limit, progress) as run:
        run.check(lib.bvx_voxelize_surface(run.context, source._view(run), where._c, options, made))
    grid = Grid._made(made, record(report))
    if attached:
        grid.attached = Attached(arrays.array_at(pairs.offsets, "uint64", (pairs.voxel_count + 1,), pairs),
                                 arrays.array_at(pairs.triangles, "uint32", (pairs.triangle_count,), pairs))
    return grid


def find_seed(surface: Grid, mesh: Any = None, *, limit: int = 0, threads: int | None = None, memory_limit: int | None = None,
              progress: Progress = None) -> Seed:
    """One voxel inside a surface, found by scanning lines of voxels.

    Parameters
    ----------
    surface
        voxels of a surface, as `voxelize` with a surface mode makes them.
    mesh
        the mesh that it came from; the seed is then verified to lie inside it.
    limit
        most lines to scan; 0: all that there are.

    Returns
    -------
    Seed
        A `bitvox.reports.Seed`; ``found`` False is not an error.

    Examples
    --------
    >>> surface = bitvox.voxelize('knot.ply', resolution=48, mode='thin')
    >>> bitvox.find_seed(surface, 'knot.ply').found
    True
    """
    out = ffi.new("bvx_seed *")
    with Run(threads, memory_limit, progress) as run:
        view = ffi.NULL if mesh is None else Mesh.of(mesh)._view(run)
        run.check(lib.bvx_find_seed(run.context, surface._c, view, in_range("limit", limit, 0, 2**64 - 1), out))
    return record(out)


def find_pockets(surface: Grid, mesh: Any = None, *, threads: int | None = None, memory_limit: int | None = None,
                 progress: Progress = None) -> Any:
    """One voxel (n, 3) int32 of each pocket inside a surface, for `Grid.fill`.

    Parameters
    ----------
    surface
        voxels of a surface.
    mesh
        the mesh that it came from: a pocket counts when it is inside; without it, when it does not touch the window's sides.

    Examples
    --------
    >>> surface = bitvox.voxelize('knot.ply', resolution=48, mode='thin')
    >>> len(bitvox.find_pockets(surface)) >= 1
    True
    """
    count = ffi.new("uint64_t *")
    with Run(threads, memory_limit, progress, calls=2) as run:
        view = ffi.NULL if mesh is None else Mesh.of(mesh)._view(run)
        status = lib.bvx_find_pockets(run.context, surface._c, view, ffi.NULL, 0, count)
        run.check(status)
        seeds = ffi.new("int32_t[]", max(1, 3 * count[0]))
        if count[0]:
            run.check(lib.bvx_find_pockets(run.context, surface._c, view, seeds, count[0], count))
    return arrays.array_at(seeds, "int32", (count[0], 3), seeds, writable=True)


@entered
def surface(
    grid: Grid,
    *,
    face_rule: FaceRule = "separate",
    dtype: Any = None,
    open_sides: str | Iterable[str] = (),
    keys: bool = False,
    local_frame: bool = False,
    mesh: Any = None,
    offset: float = 0.0,
    sharp: bool | None = None,
    threads: int | None = None,
    memory_limit: int | None = None,
    progress: Progress = None,
) -> Mesh:
    """The closed, manifold surface between set and empty voxel centers, by marching cubes.

    Parameters
    ----------
    grid
        a `Grid`, or a three-dimensional array [x, y, z] for `Grid.from_numpy`.
    mesh
        what the voxels were made from, as `Mesh.of` takes it: where the grid still ends where the mesh does, vertices are
        the mesh's, as those of `repair`; elsewhere in the middle, or at ``offset``.
    offset, sharp
        with ``mesh``: as for `Field.surface`, ``sharp`` by default None. A body hollowed to a thickness t has
        ``offset=-t``, one that grew by r ``offset=r``.
    face_rule
        "separate" (set corners are kept apart across a face) or "join".
    dtype
        of the vertices, float32 or float64; None: float32 where it distinguishes neighboring positions.
    open_sides
        sides of the window that are left open for `merge`: "x-low", "x-high", "y-low" ...
    keys
        keep canonical keys, which `merge` needs.
    local_frame
        vertices relative to the lattice's corner, which goes to ``mesh.frame``.

    Returns
    -------
    Mesh
        A `Mesh` with uint32 faces; an empty grid gives an empty mesh.

    Examples
    --------
    >>> mesh = bitvox.surface(bitvox.voxelize('knot.ply', resolution=32))
    >>> mesh.check().closed, mesh.check().vertex_manifold
    (True, True)
    """
    if mesh is not None:
        if open_sides or keys:
            raise ArgumentError("open_sides and keys are for surfaces without a mesh")
        return surface_of_mesh(grid_of(grid), mesh, offset, sharp=sharp, face_rule=face_rule, dtype=dtype, local_frame=local_frame,
                               threads=threads, memory_limit=memory_limit, progress=progress)
    if offset or sharp is not None:
        raise ArgumentError("offset and sharp are taken together with mesh")
    options = options_of("extract_options")
    options.face_rule = choice("face_rule", face_rule, "BVX_FACE_", FACE_RULES)
    options.keys, options.local_frame = int(bool(keys)), int(bool(local_frame))
    put_open_sides(options, open_sides)
    found = grid_of(grid)
    return with_positions(options, dtype, lambda run, made: lib.bvx_extract_surface(run.context, found._c, options, made),
                          threads=threads, memory_limit=memory_limit, progress=progress)


def surface_counts(grid: Grid, *, face_rule: FaceRule = "separate") -> tuple[int, int]:
    """Vertices and triangles that `surface` would make of a ``grid`` by a ``face_rule``, without making them.

    Examples
    --------
    >>> bitvox.surface_counts(bitvox.Grid.from_numpy(np.ones((2, 2, 2))))
    (24, 44)
    """
    options, vertices, triangles = options_of("extract_options"), ffi.new("uint64_t *"), ffi.new("uint64_t *")
    options.face_rule = choice("face_rule", face_rule, "BVX_FACE_", FACE_RULES)
    with Run() as run:
        run.check(lib.bvx_extract_count(run.context, grid_of(grid)._c, options, vertices, triangles))
    return vertices[0], triangles[0]


def faces(grid: Grid, *, merge: bool = False, open_sides: str | Iterable[str] = (), dtype: Any = None, local_frame: bool = False,
          of: Grid | None = None, threads: int | None = None, memory_limit: int | None = None, progress: Progress = None) -> Mesh:
    """The voxels themselves as a mesh: each face between a set and an empty voxel, outwards, as two triangles.

    Parameters
    ----------
    grid
        a `Grid` or a three-dimensional array.
    merge
        faces of one plane and side become few rectangles (which may meet in T-junctions).
    open_sides
        sides as for `surface`, whose outermost voxels are a neighbor's and have their faces there: chunks cut out with a voxel of
        each neighbor have every face of the whole once.
    dtype, local_frame
        as for `surface`.
    of
        only faces of these voxels of the grid, such as those of one label; same lattice and window.

    Examples
    --------
    >>> bitvox.faces(bitvox.Grid.from_numpy(np.ones((1, 1, 1)))).n_faces
    12
    """
    options = options_of("faces_options")
    options.merged, options.local_frame = int(bool(merge)), int(bool(local_frame))
    put_open_sides(options, open_sides)
    found, some = grid_of(grid), None if of is None else grid_of(of)
    if some is not None:
        options.of = some._c
    return with_positions(options, dtype, lambda run, made: lib.bvx_extract_faces(run.context, found._c, options, made),
                          threads=threads, memory_limit=memory_limit, progress=progress)


def grid_of(source: Any) -> Grid:
    if isinstance(source, Grid):
        return source
    if getattr(source, "ndim", 0) == 3:
        return Grid.from_numpy(source)
    remedy = ("bitvox.voxelize makes a grid of a mesh" if hasattr(source, "faces") or isinstance(source, (str, os.PathLike)) else
              "it has a method surface" if hasattr(source, "lattice") else "give a Grid or a three-dimensional array")
    raise TypeError(f"{type(source).__name__} is not a grid: {remedy}")


def merge(parts: Sequence[Mesh], *, threads: int | None = None, memory_limit: int | None = None, progress: Progress = None) -> Mesh:
    """Join the surfaces of windows of one lattice into one: the bytes of the whole extracted at once.

    Parameters
    ----------
    parts
        meshes that `surface` made with ``keys=True`` and open sides, of windows that overlap by one layer of voxels.

    Examples
    --------
    >>> whole = bitvox.Grid.from_numpy(np.ones((4, 4, 4)))
    >>> low, high = whole.crop(((0, 0, 0), (4, 4, 3))), whole.crop(((0, 0, 2), (4, 4, 2)))
    >>> parts = [bitvox.surface(low, keys=True, open_sides='z-high'), bitvox.surface(high, keys=True, open_sides='z-low')]
    >>> bitvox.merge(parts).check().closed
    True
    """
    parts = list(parts)
    made = new_mesh()
    with Run(threads, memory_limit, progress) as run:
        array = ffi.new("bvx_mesh[]", max(1, len(parts)))
        for i, part in enumerate(parts):
            if part.keys is None:
                raise ArgumentError(f"part {i} has no keys: make it with surface(..., keys=True)")
            array[i] = part._struct(run)[0]
        run.check(lib.bvx_mesh_merge(run.context, array, len(parts), made))
    return Mesh._made(made)


def carried(source: Mesh, target: Any, limits: dict[str, Any]) -> None:
    """Give a bvx_mesh that the library made the colors and texture coordinates of the nearest points of a mesh."""
    with Run(**limits) as run:
        run.check(lib.bvx_mesh_carry(run.context, source._struct(run), target))


def carry(source: Any, target: Any, *, threads: int | None = None, memory_limit: int | None = None, progress: Progress = None) -> Mesh:
    """The target with the colors and texture coordinates of the source's nearest points.

    Parameters
    ----------
    source
        a mesh with ``colors`` or ``uvs``.
    target
        a mesh in the same frame; it stays as it is.

    Examples
    --------
    >>> mesh = bitvox.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], colors=[[255, 0, 0]] * 3)
    >>> bitvox.carry(mesh, ([[0, 0, 1], [1, 0, 1], [0, 1, 1]], [[0, 1, 2]])).colors[0].tolist()
    [255, 0, 0, 255]
    """
    after = Mesh.of(target)
    owner = new_mesh()
    with Run(threads, memory_limit, progress) as run:
        borrowed = after._struct(run)
        borrowed.colours = borrowed.uvs = borrowed.uv_triangles = ffi.NULL
        borrowed.uv_count, borrowed.owned = 0, 1  # what it gets is its own; what it has stays ours
        run.check(lib.bvx_mesh_carry(run.context, Mesh.of(source)._struct(run), borrowed))
    for name in ("colours", "uvs", "uv_triangles", "uv_count", "vertex_count", "triangle_count", "vertex_capacity",
                 "triangle_capacity", "owned"):
        setattr(owner, name, getattr(borrowed, name))
    made = after.astype()
    if owner.colours != ffi.NULL:
        made._colors = arrays.array_at(owner.colours, "uint8", (after.n_vertices, 4), owner, writable=True)
    if owner.uvs != ffi.NULL:
        made._uvs = arrays.array_at(owner.uvs, "float32", (after.n_vertices, 2), owner, writable=True)
        made._uv_faces = None
    return made


carry_over = carry  # for functions that have an option of this name


def label_voxels(mesh: Any, grid: Grid, *, threads: int | None = None, memory_limit: int | None = None,
                 progress: Progress = None) -> tuple[Array, Array]:
    """Labels of a grid's voxels by the material or color of the mesh's nearest point, and the color of each label.

    Parameters
    ----------
    mesh
        a mesh with ``colors``, or a glTF or 3MF file's with materials.
    grid
        of the same coordinates, such as ``bitvox.voxelize(mesh)``.

    Returns
    -------
    labels
        uint8 ``[x, y, z]``, x fastest in memory; 0 where no voxel is set. A mesh without colors of vertices: 1 + the index of the
        material. Else a label is a color, of 255 at most.
    palette
        uint8 red, green, blue, alpha ``[256, 4]``.

    Examples
    --------
    >>> mesh = bitvox.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], colors=[[255, 0, 0]] * 3)
    >>> labels, palette = bitvox.label_voxels(mesh, bitvox.Grid.from_numpy(np.ones((2, 2, 2))))
    >>> int(labels.max()), palette[1].tolist()
    (1, [255, 0, 0, 255])
    """
    np = arrays.numpy("label_voxels")
    source, found = Mesh.of(mesh), grid_of(grid)
    labels, palette = np.zeros(found.shape[::-1], np.uint8), np.zeros((256, 4), np.uint8)
    with Run(threads, memory_limit, progress) as run:
        run.check(lib.bvx_label_voxels(run.context, source._struct(run), found._c, ffi.from_buffer("uint8_t[]", labels), ffi.from_buffer("uint8_t[]", palette)))
    return labels.transpose(2, 1, 0), palette


def check(mesh: Any, *, weld: bool = False, threads: int | None = None, memory_limit: int | None = None,
          progress: Progress = None) -> Certificate:
    """What a mesh is: closed, edge_manifold, vertex_manifold, oriented, components, volume, area and counts.

    Parameters
    ----------
    mesh
        what `Mesh.of` takes.
    weld
        take vertices at equal positions for one.

    Returns
    -------
    Certificate
        A `bitvox.reports.Certificate`.

    Raises
    ------
    RangeError
        a coordinate that is not finite, a vertex index beyond the vertices: the first one is named.

    Examples
    --------
    >>> bitvox.check('knot.ply').boundary_edges
    0
    """
    return Mesh.of(mesh).check(weld=weld, threads=threads, memory_limit=memory_limit, progress=progress)


FINDINGS = names_of("BVX_FINDING_")
NEEDS = names_of("BVX_NEEDS_")


class Inspection(NamedTuple):
    """What `inspect` finds.

    Attributes
    ----------
    sound
        closed, manifold, oriented, outwards and free of crossings.
    needs
        the first thing that is wrong: "nothing", "lids", "manifold", "turns", "area", "outside-in" or "uncrossing".
    walls, gaps, cavities, islands
        the worst of what was found, each a `bitvox.reports.Finding`: ``size`` (thickness, width, volume, area), ``position``, the box
        from ``low`` to ``high``, ``voxels``.
    thickness
        at each vertex the least beside it, a float64 array; infinity where there is none. None unless asked for.
    report
        a `bitvox.reports.InspectReport`: ``least_thickness`` and ``least_gap`` with both ends, shares of ``thickness``, ``volume``, ``mass``,
        ``crossings``, the ``certificate``, and in ``found`` how many walls, gaps, cavities and islands there are.

    Examples
    --------
    >>> bitvox.inspect('knot.ply', resolution=64).sound
    True
    """

    sound: bool
    needs: str
    walls: tuple[Finding, ...]
    gaps: tuple[Finding, ...]
    cavities: tuple[Finding, ...]
    islands: tuple[Finding, ...]
    thickness: Array | None
    report: InspectReport


def inspect(
    mesh: Any,
    *,
    walls: float = 0.0,
    gaps: float = 0.0,
    density: float = 1.0,
    up: Axis = "z",
    resolution: int | None = None,
    lattice: Lattice | None = None,
    most: int = 8,
    thickness: bool = False,
    threads: int | None = None,
    memory_limit: int | None = None,
    progress: Progress = None,
) -> Inspection:
    """Whether a mesh can be made: is it sound, how thick are its walls, how narrow its gaps, what is trapped, which parts of layers hang.

    Thickness is the way straight inwards to the other side, from points of each triangle a voxel apart; a gap is the way outwards. Both
    count where the other side faces the ray to 60 degrees.

    Parameters
    ----------
    mesh
        what `Mesh.of` takes.
    walls, gaps
        thinner walls and narrower gaps are findings; 0: none [world].
    density
        mass of a unit of volume.
    up
        the axis towards whose high end layers are built: "x", "y" or "z". They are a voxel high.
    resolution
        voxels along the longest axis. Default 256. Or a ``lattice`` to work on.
    most
        findings of each kind that are listed, the worst first.
    thickness
        give it for each vertex.

    Returns
    -------
    Inspection
        What is wrong where, and a `bitvox.reports.InspectReport`.

    Raises
    ------
    ArgumentError
        a number out of its range.
    EmptyError
        no triangle of area.
    RangeError
        see `voxelize`.
    MemoryLimitError

    Examples
    --------
    >>> found = bitvox.inspect('knot.ply', walls=0.8, resolution=64)
    >>> found.report.found[0] > 0, found.walls[0].size < 0.8, len(found.cavities)
    (True, True, 0)
    """
    source, options, out = Mesh.of(mesh), options_of("inspect_options"), ffi.new("bvx_inspect_report *")
    if not density > 0:
        raise ArgumentError(f"density is {density}; it must be above 0 and finite")
    set_fit(options, resolution, lattice)
    options.walls, options.gaps, options.density = float(walls), float(gaps), float(density)
    options.up, options.most = choice("up", up, "BVX_UP_", ("x", "y", "z")), in_range("most", most, 1, 2**20)
    places = ffi.new("bvx_finding[]", len(FINDINGS) * most)
    options.findings = places
    values = None
    if thickness:
        values = arrays.numpy("thickness").empty(source.n_vertices)
        options.thickness = ffi.cast("double *", arrays.address(values))
    with Run(threads, memory_limit, progress) as run:
        run.check(lib.bvx_inspect(run.context, source._view(run), options, out))
    found = [tuple(record(places[kind * most + i]) for i in range(min(out.found[kind], most))) for kind in range(len(FINDINGS))]
    return Inspection(out.needs == lib.BVX_NEEDS_NOTHING, NEEDS[out.needs], found[0], found[1], found[2], found[3], values, record(out))


def compare(a: Any, b: Any, *, samples: int | None = None, seed: int | None = None, threads: int | None = None,
            memory_limit: int | None = None, progress: Progress = None) -> Difference | Distances:
    """Two grids: what they share and where they differ. Two meshes: distances both ways, from random points.

    Parameters
    ----------
    a, b
        two `Grid` of one lattice and window, or two meshes (what `Mesh.of` takes).
    samples
        points on each mesh. Default 20000.
    seed
        another seed, other points. Both are for meshes.

    Returns
    -------
    Difference | Distances
        `bitvox.reports.Difference` for grids, `bitvox.reports.Distances` for meshes.

    Raises
    ------
    LatticeError
        grids that do not share lattice and window.
    EmptyError
        a mesh without triangles.
    TypeError
        a grid and a mesh.
    RangeError
        coordinates.

    Examples
    --------
    >>> solid = bitvox.voxelize('knot.ply', resolution=32)
    >>> bitvox.compare(solid, solid).only_a
    0
    """
    if isinstance(a, Grid) and isinstance(b, Grid):
        if samples is not None or seed is not None:
            raise ArgumentError("samples and seed are for meshes; grids are compared voxel by voxel")
        return a.compare(b, threads=threads, memory_limit=memory_limit, progress=progress)
    if isinstance(a, Grid) or isinstance(b, Grid):
        raise TypeError("a grid is compared with a grid, a mesh with a mesh")
    first, second = Mesh.of(a), Mesh.of(b)
    points, start = 20000 if samples is None else samples, 1 if seed is None else seed
    out = ffi.new("bvx_distance_report *")
    with Run(threads, memory_limit, progress) as run:
        run.check(lib.bvx_mesh_distance(run.context, first._view(run), second._view(run),
                                        in_range("samples", points, 1, 2**31 - 1), in_range("seed", start, 0, 2**64 - 1), out))
    return record(out)


class Closest:
    """A mesh made ready for questions about nearest points, rays and inside; keeps a copy of what it needs.

    Parameters
    ----------
    mesh
        what `Mesh.of` takes.

    Examples
    --------
    >>> nearest = bitvox.Closest(([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])).find([[0, 0, 3]])
    >>> float(nearest['distance'][0])
    3.0
    """

    __slots__ = ("_c", "_mesh")

    def __init__(self, mesh: Any, *, threads: int | None = None, memory_limit: int | None = None, progress: Progress = None) -> None:
        out = ffi.new("bvx_closest **")
        self._mesh = Mesh.of(mesh)  # the caller's arrays are not copied; for pickling and equality
        with Run(threads, memory_limit, progress) as run:
            run.check(lib.bvx_closest_create(run.context, self._mesh._view(run), out))
        self._c = ffi.gc(out[0], lib.bvxpy_free_closest)

    def __eq__(self, other: object) -> bool:
        return self._mesh == other._mesh if isinstance(other, Closest) else NotImplemented

    __hash__: ClassVar[None] = None  # type: ignore[assignment]

    def _repr_html_(self) -> str:
        return shown(self, {"vertices": self._mesh.n_vertices, "faces": self._mesh.n_faces})

    def __reduce__(self) -> Any:
        return Closest, (self._mesh,)

    def __repr__(self) -> str:
        return f"Closest({self._mesh.n_vertices} vertices, {self._mesh.n_faces} faces)"

    def find(self, points: Any, *, signed: bool = False, threads: int | None = None, progress: Progress = None) -> Array:
        """The nearest points of the mesh.

        Parameters
        ----------
        points
            (n, 3) [world].
        signed
            distances are negative inside, where `contains` is True.

        Returns
        -------
        Array
            A record array of n: position [world], distance [world], weight (barycentric), triangle, feature (0 inside the
            triangle, 1 2 3 on an edge, 4 5 6 at a corner).

        Examples
        --------
        >>> nearest = bitvox.Closest(([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]))
        >>> nearest.find([[0.25, 0.25, 2]])['triangle'].tolist()
        [0]
        """
        given = arrays.numbers_in(points, "points", 3)
        out = ffi.new("bvx_closest_point[]", max(1, given.count))
        with Run(threads, None, progress) as run:
            run.check(lib.bvx_closest_find(run.context, self._c, ffi.cast("double *", given.pointer), given.count, out))
        found = arrays.records_at(out, "bvx_closest_point", given.count, out)
        if signed:
            found = found.copy()
            found["distance"][self.contains(points, threads=threads)] *= -1
        return found

    def cast(self, rays: Any, *, t_max: float = float("inf"), threads: int | None = None, progress: Progress = None) -> Array:
        """Where rays first meet the mesh, decided exactly: no ray passes between triangles with a common edge.

        Parameters
        ----------
        rays, t_max
            as in `Grid.cast`.

        Returns
        -------
        Array
            A record array of n: t, position [world], weight (barycentric), triangle, side (1: the side that the normal points to,
            -1: the other one, 0: the ray meets nothing).

        Examples
        --------
        >>> triangle = bitvox.Closest(([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]))
        >>> float(triangle.cast([[0.25, 0.25, 2, 0, 0, -1]])['t'][0])
        2.0
        """
        given = arrays.numbers_in(rays, "rays", 6)
        out = ffi.new("bvx_mesh_hit[]", max(1, given.count))
        with Run(threads, None, progress) as run:
            run.check(lib.bvx_closest_cast(run.context, self._c, ffi.cast("double *", given.pointer), given.count, t_max, out))
        return arrays.records_at(out, "bvx_mesh_hit", given.count, out)

    def crossings(self, rays: Any, *, t_max: float = float("inf"), threads: int | None = None,
                  progress: Progress = None) -> tuple[Array, Array]:
        """All places where rays meet the mesh: an edge or a corner between triangles that lie side by side is one.

        Parameters
        ----------
        rays, t_max
            as in `cast`.

        Returns
        -------
        tuple
            offsets (n + 1,) and the hits as in `cast`, by t: those of ray i are ``hits[offsets[i]:offsets[i + 1]]``.

        Examples
        --------
        >>> knot = bitvox.Closest('knot.ply')
        >>> offsets, hits = knot.crossings([[0, 0, 0, 1, 0, 0]])
        >>> bool(len(hits) == offsets[1])
        True
        """
        np = arrays.numpy("crossings")
        given = arrays.numbers_in(rays, "rays", 6)
        offsets = np.zeros(given.count + 1, np.uint64)
        starts = ffi.cast("uint64_t *", offsets.ctypes.data)
        with Run(threads, None, progress) as run:
            asked = (run.context, self._c, ffi.cast("double *", given.pointer), given.count, t_max, starts)
            run.check(lib.bvx_closest_crossings(*asked, ffi.NULL, 0))
            count = int(offsets[-1])
            out = ffi.new("bvx_mesh_hit[]", max(1, count))
            run.check(lib.bvx_closest_crossings(*asked, out, count))
        return offsets, arrays.records_at(out, "bvx_mesh_hit", count, out)

    def winding(self, points: Any, *, threads: int | None = None, progress: Progress = None) -> Array:
        """How often the mesh goes around points; exact.

        Parameters
        ----------
        points
            (n, 3) [world].

        Returns
        -------
        Array
            (n,) int64: of a closed, oriented mesh 0 outside and 1 inside. Of an open one it is the signed number of triangles that
            lie ahead along x: `measure_field` with sign "winding" is for these.

        Examples
        --------
        >>> bitvox.Closest('knot.ply').winding([[100, 0, 0]]).tolist()
        [0]
        """
        np = arrays.numpy("winding")
        given = arrays.numbers_in(points, "points", 3)
        turns = np.zeros(given.count, np.int64)
        with Run(threads, None, progress) as run:
            run.check(lib.bvx_closest_winding(run.context, self._c, ffi.cast("double *", given.pointer), given.count,
                                              ffi.cast("int64_t *", turns.ctypes.data)))
        return turns

    def contains(self, points: Any, *, threads: int | None = None, progress: Progress = None) -> Array:
        """Which points lie inside: (n,) bool, where `winding` is not 0.

        Examples
        --------
        >>> bitvox.Closest('knot.ply').contains([[100, 0, 0]]).tolist()
        [False]
        """
        return self.winding(points, threads=threads, progress=progress) != 0

    def links(self, grid: Grid, links: Literal[6, 18, 26] = 18, *, threads: int | None = None, progress: Progress = None) -> Array:
        """Where links from the set voxels of a grid to their neighbors meet the mesh, as lattice Boltzmann methods use them.

        Parameters
        ----------
        grid
            the voxels that are asked about: of a fluid those with a neighbor that is none.
        links
            how many neighbors: those across faces, edges too, or corners too, in order (z, y, x) from -1 to 1.

        Returns
        -------
        Array
            (count, links) float32, in the order of `Grid.voxels`: the part of the way to the neighbor's center at the first hit
            of `cast`, 0 to 1; -1: none.

        Examples
        --------
        >>> solid = bitvox.voxelize('knot.ply', resolution=32)
        >>> fluid = ~solid
        >>> beside = fluid & solid.dilate(connectivity=26)
        >>> bitvox.Closest('knot.ply').links(beside, 26).shape == (beside.count, 26)
        True
        """
        np = arrays.numpy("links")
        values = np.empty((grid.count, links if links in (6, 18, 26) else 0), np.float32)  # others are refused below
        with Run(threads, None, progress) as run:
            run.check(lib.bvx_closest_links(run.context, self._c, grid._c, links, ffi.cast("float *", values.ctypes.data)))
        return values


class Rays:
    """A grid made ready for rays, so that one ray costs what it does among many; keeps the grid.

    Parameters
    ----------
    grid
        voxels; 1/512 of their memory is added.

    Examples
    --------
    >>> rays = bitvox.Rays(bitvox.voxelize('knot.ply', resolution=64))
    >>> [int(rays.cast([[x, 0, 90, 0, 0, -1]])['hit'][0]) for x in (0, 2)]
    [0, 1]
    """

    __slots__ = ("_c", "_grid")

    def __init__(self, grid: Grid, *, threads: int | None = None, memory_limit: int | None = None, progress: Progress = None) -> None:
        out = ffi.new("bvx_rays **")
        self._grid = grid
        with Run(threads, memory_limit, progress) as run:
            run.check(function("bvx_rays_create")(run.context, grid._c, out))
        self._c = ffi.gc(out[0], lib.bvxpy_free_rays)

    def __eq__(self, other: object) -> bool:
        return self._grid == other._grid if isinstance(other, Rays) else NotImplemented

    __hash__: ClassVar[None] = None  # type: ignore[assignment]

    def _repr_html_(self) -> str:
        return shown(self, {"shape": self._grid.shape})

    def __reduce__(self) -> Any:
        return Rays, (self._grid,)

    def __repr__(self) -> str:
        return f"Rays({' x '.join(map(str, self._grid.shape))} voxels)"

    def cast(self, rays: Any, *, t_max: float = float("inf"), threads: int | None = None, progress: Progress = None) -> Array:
        """As `Grid.cast`, with the same bits.

        Parameters
        ----------
        rays, t_max
            as there.

        Examples
        --------
        >>> rays = bitvox.Rays(bitvox.Grid.from_numpy(np.ones((2, 2, 2))))
        >>> float(rays.cast([[-3, 1, 1, 1, 0, 0]])['t'][0])
        3.0
        """
        given = arrays.numbers_in(rays, "rays", 6)
        out = ffi.new("bvx_ray_hit[]", max(1, given.count))
        with Run(threads, None, progress) as run:
            run.check(lib.bvx_rays_cast(run.context, self._c, ffi.cast("double *", given.pointer), given.count, t_max, out))
        return arrays.records_at(out, "bvx_ray_hit", given.count, out)

    def update(self, grid: Grid, window: WindowLike = None, *, threads: int | None = None, progress: Progress = None) -> None:
        """Take another grid of the same lattice and window that differs from the one kept inside a window only.

        Parameters
        ----------
        grid
            the voxels from now on.
        window
            (low, size) of the lattice, beyond which nothing has changed; None: all of it is looked at.

        Examples
        --------
        >>> wall, rays = np.ones((8, 8, 8), bool), bitvox.Rays(bitvox.Grid.from_numpy(np.zeros((8, 8, 8))))
        >>> rays.update(bitvox.Grid.from_numpy(wall), ((0, 0, 0), (8, 8, 8)))
        >>> float(rays.cast([[-3, 1, 1, 1, 0, 0]])['t'][0])
        3.0
        """
        box = ffi.new("bvx_window *")
        set_window("window", box, window)
        with Run(threads, None, progress) as run:
            run.check(lib.bvx_rays_update(run.context, self._c, grid._c, box))
        self._grid = grid


def repair(
    mesh: Any,
    *,
    resolution: int | None = None,
    lattice: Lattice | None = None,
    sign: RepairSign = "auto",
    shell: float | None = None,
    keep_largest: int | None = None,
    if_needed: bool = False,
    triangles: int | None = None,
    error: float | str | None = None,
    carry: bool = False,
    threads: int | None = None,
    memory_limit: int | None = None,
    progress: Progress = None,
    **advanced: Unpack[RepairOptions],
) -> Mesh:
    """Make a closed, manifold, oriented mesh without crossing triangles from any mesh.

    Parameters
    ----------
    mesh
        what `Mesh.of` takes.
    resolution
        voxels along the longest axis. Default 256. Or a ``lattice`` to work on.
    sign
        what decides that a center is inside: "winding" (holes and overlaps), "vote" (holes and flipped triangles), "parity"
        (nested shells are cavities), or "auto": winding, flipped triangles turned before, or vote where they cannot be oriented.
    shell
        thickness that open sheets are given [largest spacings]; 0: none are made. Default 2.
    keep_largest
        this many of the largest pieces are kept, by voxels that join through faces, of what ``least_part`` leaves; the report
        counts ``parts_dropped``. None: all.
    if_needed
        a mesh that needs nothing is copied, its positions as they are (``report.copied``; ``report.needs`` is one of
        ``BVX_NEEDS_...``: 0 nothing, 1 lids, 2 manifold, 3 turns, 4 area, 5 outside in, 6 uncrossing).
    triangles
        most triangles: edges of the result collapse as by `simplify`; 0 or None: no limit.
    error
        as few triangles as keep this distance to the repaired surface: a number [world], or a part of its diagonal
        as ``"0.1%"``; in place of ``triangles``.
    carry
        give the result the colors and texture coordinates of the nearest points on the mesh.
    advanced
        `RepairOptions`: ``interpolation``, ``sharp``, ``thin``, ``least_part``, ``least_cavity``, ``error_kind``, ``measure``,
        ``measure_samples``, ``face_rule``, ``dtype``, ``local_frame``.

    Returns
    -------
    Mesh
        A `Mesh`; ``mesh.report`` (`bitvox.reports.RepairReport`) says what was found and done: ``holes``, ``turned``,
        the certificates ``before`` and ``after``, ``distance`` when measured ...
        With ``triangles`` or ``error``, ``after`` and ``distance`` are of the collapsed mesh.

    Raises
    ------
    EmptyError
        no triangle of area, or nothing left.
    ArgumentError
        options that contradict each other.
    RangeError
        see `voxelize`.
    MemoryLimitError

    Examples
    --------
    >>> knot = bitvox.read('knot.ply')
    >>> torn = bitvox.Mesh(knot.vertices, knot.faces[100:])
    >>> bitvox.repair(torn, resolution=64).check().closed
    True
    """
    known(repair, RepairOptions, advanced)
    dtype, measure, measure_samples = advanced.get("dtype"), advanced.get("measure"), advanced.get("measure_samples")
    mend = function("bvx_repair")
    options = options_of("repair_options")
    set_fit(options, resolution, lattice)
    options.sign = choice("sign", sign, "BVX_FILL_", REPAIR_SIGNS)
    set_placing(options.placing, {"interpolation": "tangent", **advanced})
    if shell is not None:
        options.shell = or_none(float(shell), "shell")
    options.thin = choice("thin", advanced.get("thin", "keep"), "BVX_THIN_", names_of("BVX_THIN_"))
    options.if_needed, options.parts.keep_crumbs = int(bool(if_needed)), int(advanced.get("least_part") is not None)
    set_parts(options.parts, keep_largest, advanced)
    targets = level_target(triangles, error, advanced.get("error_kind"))
    if measure_samples is not None and not measure:
        raise ArgumentError("measure_samples is taken together with measure")
    if measure:
        options.samples = 100000 if measure_samples is None else in_range("measure_samples", measure_samples, 1, 2**31 - 1)
    report = ffi.new("bvx_repair_report *")
    options.report = report
    source = Mesh.of(mesh)
    limits: dict[str, Any] = {"threads": threads, "memory_limit": memory_limit, "progress": progress}
    small_weights = (40, 40) if targets and measure else (40,) if targets else ()
    with Rise(progress, 100, *small_weights, *((20,) if carry else ())) as limits["progress"]:
        made = with_positions(options, dtype, lambda run, out: mend(run.context, source._view(run), options, out), **limits)
        found = record(report)
        small = collapsed(made, targets, limits)
        if small is not made:
            found = found._replace(after=small.report.certificate)
            if measure:
                found = found._replace(distance=compare(source, small, samples=options.samples, **limits))
            made = small
        if found.copied and not targets and dtype is None:
            made = source.astype()  # with its attributes
        elif carry:
            made = carry_over(source, made, **limits)
    made.report = found
    return made


def set_fit(options: Any, resolution: Any, lattice: Lattice | None) -> None:
    """The lattice to measure on, or its voxels along the longest axis."""
    if lattice is not None:
        if resolution is not None:
            raise ArgumentError("resolution and lattice contradict each other; give one of them")
        options.fit.lattice = lattice._c
    elif resolution is not None:
        options.fit.resolution = in_range("resolution", resolution, 1, 2**24)


def set_parts(parts: Any, keep_largest: int | None, given: Any) -> None:
    """Which parts and cavities are kept."""
    for name, value, least in (("keep_largest", keep_largest, 1), *((name, given.get(name), 0) for name in ("least_part", "least_cavity"))):
        if value is not None:
            setattr(parts, name, in_range(name, value, least, 2**64 - 1))


def set_placing(placing: Any, given: Any) -> None:
    """Where vertices go."""
    if given.get("interpolation") is not None:
        placing.interpolation = choice("interpolation", given["interpolation"], "BVX_EDGE_", EDGES)
    placing.face_rule = choice("face_rule", given.get("face_rule", "separate"), "BVX_FACE_", FACE_RULES)
    placing.sharp, placing.local_frame = sharpness(given.get("sharp")), int(bool(given.get("local_frame")))


def level_target(triangles: Any, error: Any, error_kind: ErrorKind | None) -> dict[str, Any]:
    """What a result is to be collapsed to, as options of `simplify`; none where it stays as it is."""
    if triangles is not None and error is not None:
        raise ArgumentError("triangles and error contradict each other; give one of them")
    for name, value in {"triangles": triangles, "error": error}.items():
        if isinstance(value, (list, tuple)) or getattr(value, "ndim", 0) != 0:
            raise ArgumentError(f"{name} is one number here; Mesh.simplify takes several")
    if error is not None:
        return {"error": error, "error_kind": error_kind}
    if error_kind is not None:
        raise ArgumentError("error_kind is taken together with error")
    return {"triangles": triangles} if triangles is not None and count_in(triangles, 0) else {}


def count_in(triangles: Any, least: int) -> int:
    """Triangles that are wanted."""
    if isinstance(triangles, float) and 0.0 < triangles < 1.0:
        raise ArgumentError(f"triangles is {triangles!r}; it must be a number of them: of a share, round({triangles!r} * mesh.n_faces)")
    return in_range("triangles", triangles, least, 2**64 - 1)


def collapsed(made: Mesh, targets: dict[str, Any], limits: dict[str, Any]) -> Mesh:
    """A closed mesh that a stage made, with fewer triangles where they are requested."""
    if not targets or made.n_faces == 0:
        return made
    return call("simplify", made, **targets, **limits)


def boolean(
    a: Any,
    b: Any,
    operation: Operation | None = None,
    *,
    resolution: int | None = None,
    lattice: Lattice | None = None,
    fill: BooleanFill = "auto",
    sharp: bool | None = None,
    keep_largest: int | None = None,
    triangles: int | None = None,
    error: float | str | None = None,
    threads: int | None = None,
    memory_limit: int | None = None,
    progress: Progress = None,
    **advanced: Unpack[BooleanOptions],
) -> Mesh:
    """The union, intersection, difference or symmetric difference of two bodies, as a closed, manifold mesh.

    Vertices lie on the surface of the mesh that bounds the result there; walls of a and b thinner than voxels are kept. Grids are
    combined by their operators: ``a | b``, ``a & b``, ``a - b``, ``a ^ b``.

    Parameters
    ----------
    a, b
        what `Mesh.of` takes; or ``boolean([a, b, c], "union")``, a list and the operation: the union of all, or the first without all
        others. The surface is measured anew on voxels, so flat faces get more triangles than they had: ``triangles`` and ``error``.
    operation
        "union", "intersection", "difference" (a without b) or "xor".
    resolution
        voxels along the longest axis: of a for a difference, of the box that both have in common for an intersection, else
        of both together. Default 256. Or a ``lattice`` to work on.
    fill
        what is inside a mesh: "auto" (what suits it, as for `voxelize`), "parity", "nonzero", "vote" or "winding".
    sharp
        cells on sharp edges and corners, and where the meshes meet, get a vertex there; None: as for `repair`.
    keep_largest
        this many of the largest parts are kept, as for `repair`; None: all.
    triangles, error
        most triangles of the result, or its distance to what it would be without: as for `repair`.
    advanced
        `BooleanOptions`: ``interpolation``, ``thin``, ``least_part``, ``error_kind``, ``face_rule``, ``dtype``, ``local_frame``.

    Returns
    -------
    Mesh
        A `Mesh`, empty when nothing is left; ``mesh.report`` has the fields of ``bvx_boolean_report``: ``solid_a`` and ``solid_b`` tell
        how each was filled and why, ``few`` (1: a, 2: b, 4: the result, added up) what has few voxels, ``advised_resolution`` what
        would show it.

    Raises
    ------
    EmptyError
        none of the voxels has its center inside a, or b, though all of it lies on the lattice.

    Examples
    --------
    >>> knot = bitvox.read('knot.ply')
    >>> moved = bitvox.Mesh(knot.vertices + [0.4, 0.3, 0.0], knot.faces)
    >>> bitvox.boolean(knot, moved, 'union', resolution=64).check().closed
    True
    """
    known(boolean, BooleanOptions, advanced)
    if operation is None:
        (a, *others, b), operation = _steps(a, b, fill)
        placed: dict[str, Any] = {name: value for name, value in advanced.items() if name in ("interpolation", "thin", "face_rule", "dtype")}
        with quiet():
            for other in others:
                a = boolean(a, other, operation, resolution=resolution, lattice=lattice, fill=fill, sharp=sharp, threads=threads,
                            memory_limit=memory_limit, **placed)
    options = options_of("boolean_options")
    set_fit(options, resolution, lattice)
    number = choice("operation", operation, "BVX_BOOLEAN_", OPERATIONS)
    options.fill = choice("fill", fill, "BVX_FILL_", FILLS)
    set_placing(options.placing, {"sharp": sharp, **advanced})
    options.thin = choice("thin", advanced.get("thin", "keep"), "BVX_THIN_", names_of("BVX_THIN_", "BVX_THIN_SHELL"))
    options.parts.keep_crumbs = int(advanced.get("least_part") is not None)
    set_parts(options.parts, keep_largest, advanced)
    report = ffi.new("bvx_boolean_report *")
    options.report = report
    targets = level_target(triangles, error, advanced.get("error_kind"))
    first, second = Mesh.of(a), Mesh.of(b)
    limits: dict[str, Any] = {"threads": threads, "memory_limit": memory_limit, "progress": progress}
    with Rise(progress, 60, *((40,) if targets else ())) as limits["progress"]:
        made = with_positions(
            options, advanced.get("dtype"), lambda run, out: lib.bvx_boolean(run.context, first._view(run), second._view(run), number, options, out), **limits)
        made = collapsed(made, targets, limits)
    made.report = record(report)
    return made


def _steps(bodies: Any, operation: Any, fill: str) -> tuple[list[Mesh], Any]:
    """boolean([a, b, c], operation) as a and what it meets one after the other, and the operation. Closed bodies go together: their rule takes
    what crosses for one solid, but what lies inside another body for its cavity."""
    if not isinstance(operation, str) or not isinstance(bodies, (list, tuple)) or len(bodies) < 2:
        raise TypeError("boolean takes two meshes and an operation, or a list of two and more and an operation")
    meshes = [Mesh.of(body) for body in bodies]
    if len(meshes) > 2 and operation not in ("union", "difference"):
        raise ArgumentError(f"{operation} of {len(meshes)} meshes: take two at a time; union and difference take several")
    np = arrays.numpy("boolean of a list")
    groups: list[list[tuple[Mesh, Certificate]]] = []
    for mesh in meshes[1:]:
        found = mesh.check(weld=True)
        alone = fill != "auto" or not found.closed
        group = next((group for group in groups if not alone and not any(_may_nest(found, other) for _, other in group)), None)
        if group is None:
            groups.append([(mesh, found)])
        else:
            group.append((mesh, found))
    steps = [meshes[0]]
    for group in groups:
        first = np.cumsum([0, *(mesh.n_vertices for mesh, _ in group)])
        faces = np.concatenate([np.asarray(mesh.faces, np.int64) + k for (mesh, _), k in zip(group, first)])
        steps.append(Mesh(np.concatenate([mesh.in_world() for mesh, _ in group]), faces))
    return steps, operation


def _may_nest(a: Certificate, b: Certificate) -> bool:
    """Whether a part of one may lie inside the other, by their boxes; next to what is open everything may."""
    apart = any(a.high[k] < b.low[k] or b.high[k] < a.low[k] for k in range(3))
    held = (all(p.low[k] >= q.low[k] and p.high[k] <= q.high[k] for k in range(3)) for p, q in ((a, b), (b, a)))
    return not (a.closed and b.closed) or not apart and (a.components > 1 or b.components > 1 or any(held))


def content_hash(data: Any, seed: int = 0) -> int:
    """The library's hash of the bytes of ``data`` (anything with a buffer), from a ``seed``; see ``bvx_hash`` in the C header.

    Examples
    --------
    >>> bitvox.content_hash(b'voxels') == bitvox.content_hash(bytearray(b'voxels'))
    True
    """
    held = ffi.from_buffer(data)
    return lib.bvx_hash(held, len(held), in_range("seed", seed, 0, 2**64 - 1))
