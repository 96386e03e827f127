"""Levels of detail: edges that collapse, on meshes as they are or on measured solids, and the paper's methods on voxels."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, List, Sequence, Union, overload

from . import _arrays as arrays
from ._calls import entered
from ._errors import ArgumentError, EmptyError, OptionRangeError
from ._grid import Grid
from ._mesh import Mesh, new_mesh, position_type
from ._options import HullOptions, LodOptions, SimplifyOptions
from ._records import record
from ._run import FACE_RULES, REPAIR_SIGNS, Progress, Rise, Run, choice, ffi, in_range, known, lib, names_of, options_of, or_none, sharpness
from ._stages import carried, count_in, grid_of, set_fit, set_parts, set_placing, surface, voxelize
from ._words import FaceRule, Fill, Method

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._words import Collapsing, Hulling
    from .reports import LevelsReport

ERROR_KINDS = names_of("BVX_ERROR_")
VERTICES = names_of("BVX_VERTICES_")
TOPOLOGY = names_of("BVX_TOPOLOGY_")
METHODS = ("collapse", *names_of("BVX_LOD_"))
ERROR_SAMPLES = 20000  # points a side that decide about an error, as in the library
OF_SOLID = ("solid", "lattice", "sign", "sharp", "outer_hull", "shell", "least_part", "keep_largest", "least_cavity")
OF_VOXELS = ("levels", "threshold", "edge_samples", "collapse", "fill", "close_gaps", "padding", "face_rule", "local_frame")
_FLAGS = ("solid", "strict", "outer_hull", "lock_border", "local_frame")  # of any type that is true or false
_USUAL = {"vertices": "placed", "topology": "keep"}
HALVINGS, FEWEST = 4, 20  # levels by halving where none are requested, and triangles that the last one has at least

Distance = Union[float, str]


class Levels(List[Mesh]):
    """The meshes of `lod`, finest first as they were requested: a list.

    Attributes
    ----------
    report
        `bitvox.reports.LevelsReport`: what the mesh was (``before``), what was done to it (``doubles``, ``turned``, ``split``,
        ``parted``, ``cut``), whether a solid was measured (``solid``) and how (``repair``). None for the methods "edge-ratio" and
        "coverage".

    Examples
    --------
    >>> levels = bitvox.lod('knot.ply', triangles=(800, 200))
    >>> [level.n_faces <= n for level, n in zip(levels, (800, 200))]
    [True, True]
    """

    report: LevelsReport | None = None

    def _repr_html_(self) -> str:
        return "".join(level._repr_html_() for level in self)


# ---- what is requested ----


def _many(value: Any) -> bool:
    return not isinstance(value, str) and (hasattr(value, "__len__") or hasattr(value, "__iter__")) and getattr(value, "ndim", 1) > 0


def _listed(value: Any, name: str) -> list[Any]:
    values = list(value) if _many(value) else [value]
    if not values:
        raise ArgumentError(f"{name} names none")
    return values


def _error_of(mesh: Mesh, value: Any, name: str = "error") -> float:
    """A distance in the mesh's units; "0.1%" is of the diagonal of its bounds."""
    text = value.strip() if isinstance(value, str) else value
    share = isinstance(text, str) and text.endswith("%")
    try:
        if isinstance(text, bool):
            raise TypeError
        number = float(text[:-1] if share else text)
    except (TypeError, ValueError):
        raise ArgumentError(f'{name} is {value!r}; it must be a distance, or a part of the diagonal as "0.1%"') from None
    if not 0.0 < number < float("inf"):
        raise ArgumentError(f"{name} is {value!r}; it must be above 0 and finite")
    return number * (_diagonal(mesh) / 100.0) if share else number


def _diagonal(mesh: Mesh) -> float:
    """Of the bounds of the used vertices; squares of large sides would be infinite."""
    found = mesh.check()
    sides = [b - a for a, b in zip(found.low, found.high)]
    longest = max(sides)
    if not longest > 0.0:
        raise EmptyError("no triangle has an area: there is no diagonal that error could be a part of")
    return longest * math.sqrt(sum((side / longest) * (side / longest) for side in sides))


def _falls(values: list[Any], name: str, rising: bool) -> None:
    """Each level is made from the one before, so a level cannot be finer than that."""
    for i in range(1, len(values)):
        if values[i] < values[i - 1] if rising else values[i] > values[i - 1]:
            raise ArgumentError(f"{name} of level {i} is {values[i]} after {values[i - 1]}: each level is made from the one before; "
                                "give the finest first")


class _Targets:
    """Which levels are wanted; owns the array that options point at."""

    def __init__(self, options: Any, mesh: Mesh, triangles: Any, error: Any, given: Any, count: int | None) -> None:
        named = [name for name, value in {"triangles": triangles, "error": error, "count": count}.items() if value is not None]
        if len(named) > 1:
            raise ArgumentError(f"{' and '.join(named)} contradict each other; give one of them")
        if given.get("error_kind") is not None:
            if error is None:
                raise ArgumentError("error_kind is taken together with error")
            options.targets.error_kind = choice("error_kind", given["error_kind"], "BVX_ERROR_", ERROR_KINDS)
        self.array = None
        if triangles is not None:
            wanted = [count_in(n, 1) for n in _listed(triangles, "triangles")]
            _falls(wanted, "triangles", rising=False)
            self.array = options.targets.triangles = ffi.new("uint64_t[]", wanted)
            self.count = len(wanted)
        elif error is not None:
            errors = [_error_of(mesh, e) for e in _listed(error, "error")]
            _falls(errors, "error", rising=True)
            self.array = options.targets.errors = ffi.new("double[]", errors)
            self.count = len(errors)
        else:
            self.count = _halvings(mesh.n_faces) if count is None else in_range("count", count, 1, 64)


def _halvings(triangles: int) -> int:
    """Levels by halving where none are requested: as many as leave this many triangles, but one at least."""
    levels = 1
    while levels < HALVINGS and triangles >> (levels + 1) >= FEWEST:
        levels += 1
    return levels


def _take(array: Any, count: int) -> list[Any]:
    """An array of bvx_meshes that the library made, as bvx_meshes of their own."""
    made = []
    for i in range(count):
        one = new_mesh()
        one[0] = array[i]
        made.append(one)
    return made


def _meshes(made: list[Any], reports: Any, source: Mesh | None, carry_from: Mesh | None, limits: dict[str, Any]) -> Levels:
    """Levels with their reports. source: the mesh that they were made from as it is, whose materials and images go into their files."""
    result = Levels()
    if carry_from is not None:
        with Rise(limits["progress"], *[1] * len(made)) as progress:
            for one in made:
                carried(carry_from, one, {**limits, "progress": progress})
    for i, one in enumerate(made):
        level = Mesh._made(one)
        level.report = record(reports[i])
        if source is not None and level._materials is not None:
            level._assets = source._assets
        result.append(level)
    return result


# ---- fewer triangles for a mesh as it is ----


@overload
def simplify(mesh: Any, *, triangles: int | None = None, error: Distance | None = None, count: None = None, **options: Unpack[Collapsing]) -> Mesh: ...  # type: ignore[overload-overlap]
@overload
def simplify(mesh: Any, *, triangles: Sequence[int] | None = None, error: Sequence[Distance] | None = None, count: int | None = None, **options: Unpack[Collapsing]) -> list[Mesh]: ...
@entered
def simplify(
    mesh: Any,
    *,
    triangles: int | Sequence[int] | None = None,
    error: Distance | Sequence[Distance] | None = None,
    count: int | None = None,
    lock_border: bool = False,
    strict: bool = False,
    dtype: Any = None,
    threads: int | None = None,
    memory_limit: int | None = None,
    progress: Progress = None,
    **advanced: Unpack[SimplifyOptions],
) -> Any:
    """Fewer triangles for a mesh as it is, by collapsing the edges that cost least.

    Parts, handles, borders, sides and own crossings stay: what is closed, manifold, oriented and free of crossings stays so, and
    any other mesh gets no new fault. The result is manifold and oriented, with no more triangles than the mesh. The order of
    vertices and triangles does not change it. `lod` with ``solid`` and `repair` make closed ones.

    The result has the normals, texture coordinates, colors and materials of the mesh, whose seams and borders stay: vertices there are
    duplicated at equal positions. Texture coordinates with ``uv_faces`` need no duplicates.

    Parameters
    ----------
    mesh
        what `Mesh.of` takes; vertices at equal positions are one.
    triangles
        most triangles, of one level or of several, the finest first.
    error
        largest distance between mesh and level, of one level or of several, the finest first: a number [world], or a
        part of the diagonal of the mesh's bounds as ``"0.1%"``.
    count
        this many levels, each with half of the triangles of the one before. With none of these: one level of half.
    lock_border
        vertices on borders stay where they are, so that tiles join.
    strict
        a target that cannot be kept is an error, not the smallest mesh that keeps the guarantee.
    dtype
        float32 or float64; None: the mesh's own.
    advanced
        `SimplifyOptions`: ``error_kind``, ``even``, ``attribute_weight``, ``locked``, ``vertices``, ``topology``, ``samples``.

    Returns
    -------
    Any
        A `Mesh` for one target, a list for a sequence of targets or a ``count``; ``mesh.report`` is a
        `bitvox.reports.LevelReport`: ``met``, ``certificate``, ``crossings``, ``least_angle``, ``distance`` when measured ...

    Raises
    ------
    ArgumentError
        options that contradict each other.
    EmptyError
        no triangles.
    RangeError
        a target that cannot be kept with ``strict``; coordinates.
    MemoryLimitError

    Examples
    --------
    >>> bitvox.simplify('knot.ply', error='1%').check().closed
    True
    """
    known(simplify, SimplifyOptions, advanced)
    source = Mesh.of(mesh)
    options = options_of("simplify_options")
    single = count is None and not _many(triangles) and not _many(error)
    targets = _Targets(options, source, triangles, error, advanced, 1 if single and triangles is None and error is None else count)
    kept = _set_common(options, source, strict, error, {"lock_border": lock_border, "dtype": dtype, **advanced})
    limits: dict[str, Any] = {"threads": threads, "memory_limit": memory_limit, "progress": progress}

    # About its own frame, so that float32 stays float32; the frame goes to the levels.
    frame, local = source.frame, source
    if any(frame):
        local = source.astype()
        local.frame = (0.0, 0.0, 0.0)
    reports = ffi.new("bvx_level_report[]", targets.count)
    options.reports = reports
    array = ffi.new("bvx_mesh[]", targets.count)
    with Run(**limits) as run:
        run.check(lib.bvx_mesh_simplify(run.context, local._view_of_all(run), options, targets.count, array))
    del kept
    levels = _meshes(_take(array, targets.count), reports, source, None, limits)
    for level in levels if any(frame) else ():
        report: Any = level.report
        level.frame, found = frame, report.certificate
        low, high = (tuple(x + f for x, f in zip(corner, frame)) for corner in (found.low, found.high))
        level.report = report._replace(certificate=found._replace(low=low, high=high))
    return levels[0] if single else list(levels)


def set_targets(targets: Any, strict: bool, error: Any, given: Any) -> None:
    """How levels keep their targets. Those by error are measured anyhow: the report says what decided."""
    samples = given.get("samples")
    if samples is None:
        samples = 0 if error is None else ERROR_SAMPLES
    if given.get("even") is not None:
        targets.even = or_none(float(given["even"]), "even")
    targets.strict = int(bool(strict))
    targets.samples = in_range("samples", samples, 0, 2**31 - 1)


def _set_common(options: Any, mesh: Mesh, strict: bool, error: Any, given: Any) -> Any:
    """What simplify_options and levels_options share; returns the array that they point at."""
    set_targets(options.targets, strict, error, given)
    options.collapse.position_type = lib.BVX_POSITION_AUTO if given.get("dtype") is None else position_type(given["dtype"])
    if given.get("attribute_weight") is not None:
        options.collapse.attribute_weight = or_none(float(given["attribute_weight"]), "attribute_weight")
    options.collapse.lock_border = int(bool(given.get("lock_border")))
    options.collapse.vertices = choice("vertices", given.get("vertices", "placed"), "BVX_VERTICES_", VERTICES)
    options.collapse.topology = choice("topology", given.get("topology", "keep"), "BVX_TOPOLOGY_", TOPOLOGY)
    if given.get("locked") is None:
        return None
    values = [bool(value) for value in given["locked"]]
    if len(values) != mesh.n_vertices:
        raise ArgumentError(f"locked has {len(values)} values, the mesh {mesh.n_vertices} vertices")
    array = options.collapse.locked = ffi.new("uint8_t[]", values)
    return array


# ---- what can be reached from outside ----


@overload
def hull(mesh: Any, *, triangles: int | None = None, error: Distance | None = None, count: None = None, **options: Unpack[Hulling]) -> Mesh: ...  # type: ignore[overload-overlap]
@overload
def hull(mesh: Any, *, triangles: Sequence[int] | None = None, error: Sequence[Distance] | None = None, count: int | None = None, **options: Unpack[Hulling]) -> Levels: ...
def hull(
    mesh: Any,
    *,
    resolution: int | None = None,
    close_gaps: int = 0,
    shell: float | None = None,
    enclose: Distance | None = None,
    triangles: int | Sequence[int] | None = None,
    error: Distance | Sequence[Distance] | None = None,
    count: int | None = None,
    keep_largest: int | None = None,
    carry: bool = False,
    threads: int | None = None,
    memory_limit: int | None = None,
    progress: Progress = None,
    **advanced: Unpack[HullOptions],
) -> Any:
    """What of a mesh can be reached from outside, closed: inner walls, shells and parts go.

    The mesh may be anything: walls doubled, welded through holes, crossing, flipped, with loose parts inside. The result lies on the
    outer of two walls, is closed, manifold and oriented, and no two of its triangles cross.

    Parameters
    ----------
    mesh
        what `Mesh.of` takes.
    resolution
        voxels along the longest axis. Default 256. Or a ``lattice`` to work on.
    close_gaps
        openings of up to this many voxels are closed, larger ones stay; 0: those that no empty voxel leads through.
    shell
        thickness of walls that no center lies in, with outside on both sides [largest spacings]; 0: they are lost. Default 2.
    enclose
        go around every triangle, touching none and nowhere further than this from the mesh: a number
        [world], or a part of the diagonal as ``"1%"``. For collisions and planning. ``resolution``, ``lattice``, ``close_gaps``,
        ``least_part`` and ``keep_largest`` are not taken with it, ``shell``, ``interpolation`` and ``sharp`` not used.
    triangles, error, count
        levels as for `simplify`, a part of the diagonal being that of the mesh; none: the hull with all its triangles, and with
        ``count`` each further level has half of them.
    keep_largest
        this many of the largest pieces are kept. None: all.
    carry
        give the result the colors and texture coordinates of the nearest points on the mesh.
    advanced
        `HullOptions`: ``lattice``, ``interpolation``, ``sharp``, ``least_part``, ``error_kind``, ``even``, ``samples``, ``strict``,
        ``face_rule``, ``dtype``, ``local_frame``.

    Returns
    -------
    Any
        A `Mesh`, whose ``report`` is a `bitvox.reports.HullReport`; for a sequence of targets or a ``count`` `Levels` with that report,
        each mesh with a `bitvox.reports.LevelReport`.

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
    >>> bitvox.hull('knot.ply', resolution=48, triangles=2000).check().closed
    True
    """
    known(hull, HullOptions, advanced)
    source, options = Mesh.of(mesh), options_of("hull_options")
    single = count is None and not _many(triangles) and not _many(error)
    targets = _Targets(options, source, triangles, error, advanced, 1 if single and triangles is None and error is None else count)
    set_fit(options, resolution, advanced.get("lattice"))
    set_placing(options.placing, advanced)
    options.placing.position_type = lib.BVX_POSITION_AUTO if advanced.get("dtype") is None else position_type(advanced["dtype"])
    set_parts(options.parts, keep_largest, advanced)
    set_targets(options.targets, bool(advanced.get("strict")), error, advanced)
    options.close_gaps = in_range("close_gaps", close_gaps, 0, 65535)
    if shell is not None:
        options.shell = or_none(float(shell), "shell")
    if enclose is not None:
        options.enclose = _error_of(source, enclose, "enclose")
    reports, report = ffi.new("bvx_level_report[]", targets.count), ffi.new("bvx_hull_report *")
    options.reports, options.report = reports, report
    array = ffi.new("bvx_mesh[]", targets.count)
    limits: dict[str, Any] = {"threads": threads, "memory_limit": memory_limit, "progress": progress}
    with Rise(progress, 80, *((20,) if carry else ())) as limits["progress"]:
        with Run(**limits) as run:
            run.check(lib.bvx_hull(run.context, source._view(run), options, targets.count, array))
        levels = _meshes(_take(array, targets.count), reports, None, source if carry else None, limits)
    levels.report = record(report)
    if single:
        levels[0].report = levels.report  # type: ignore[assignment]
    return levels[0] if single else levels


# ---- levels of any mesh ----


def lod(
    source: Any,
    *,
    triangles: int | Sequence[int] | None = None,
    error: Distance | Sequence[Distance] | None = None,
    count: int | None = None,
    method: Method | None = None,
    solid: bool = False,
    resolution: int | Sequence[int] | None = None,
    strict: bool = False,
    levels: int | Sequence[Any] | None = None,
    carry: bool = False,
    threads: int | None = None,
    memory_limit: int | None = None,
    progress: Progress = None,
    **advanced: Unpack[LodOptions],
) -> Levels:
    """Levels of detail: meshes of several sizes from any mesh, or from a grid.

    The method "collapse" takes a mesh as it is, as `simplify` does: parts, holes, borders and sides stay, and no level has a fault
    that the mesh does not have. With ``solid`` it measures the surface first, as `repair` does: holes get lids, overlapping parts become
    one, sheets become shells, and every level is closed, manifold and oriented, and no two of its triangles cross. Edges collapse,
    each level from the one before. "edge-ratio" and "coverage" are those of the paper: they lay coarser lattices over the voxels of
    the mesh, or over a grid.

    Parameters
    ----------
    source
        what `Mesh.of` takes; a `Grid` or a three-dimensional array.
    triangles
        most triangles of each level, the finest first.
    error
        largest distance between source and level, the finest first: numbers [world], or parts of the diagonal of the
        mesh's bounds as ``"0.1%"``.
    count
        this many levels, each with half of the triangles of the one before, the first with half of the source's. Default
        where no level is requested: 4, or as many as leave 20 triangles.
    method
        "collapse", "edge-ratio" or "coverage". Default: "collapse", of a grid's surface where ``triangles`` or ``error`` are given;
        "edge-ratio" for other grids, and with an option that only the paper's methods have.
    solid
        levels of the surface that `repair` makes of the mesh: closed, manifold, oriented and without crossings. So with
        ``resolution``, ``lattice``, ``sign``, ``sharp``, ``outer_hull``, ``shell``, ``least_part``, ``keep_largest`` and ``least_cavity``.
    resolution
        voxels along the longest axis to measure with. Default: 256 to 320, as many as the finest
        level needs. The paper's methods: of the voxelization; default: 8 times the finest level, less where its bits would take
        more than 1 GiB.
    strict
        a target that cannot be kept is an error, not the smallest mesh that keeps the guarantee.
    levels
        the paper's methods: samples along the longest axis of each level, or triples along x, y, z. Default (64, 32, 16).
    carry
        of a solid and by the paper's methods: give each level the colors and texture coordinates of the nearest points on the mesh.
        Levels of the mesh as it is have its attributes.
    advanced
        `LodOptions`: ``lattice``, ``sign``, ``sharp``, ``outer_hull``, ``shell``, ``least_part``, ``keep_largest``, ``least_cavity``,
        ``threshold``, ``edge_samples``, ``collapse``, ``fill``, ``close_gaps``, ``padding``, ``face_rule``, ``local_frame``,
        ``lock_border``, ``dtype``, and those of `SimplifyOptions`.

    Returns
    -------
    Levels
        A list of one `Mesh` a level, each with a ``report``, a `bitvox.reports.LevelReport` (``met``, ``certificate``,
        ``least_angle``, ``distance`` when measured), or a `bitvox.reports.LodReport` by the paper's methods. The list's own
        ``report`` is a `bitvox.reports.LevelsReport`.

    Raises
    ------
    ArgumentError
        options that contradict each other.
    EmptyError
        nothing inside.
    RangeError
        a target that cannot be kept with ``strict``; a level finer than the voxels; coordinates.
    MemoryLimitError

    Examples
    --------
    >>> fine, coarse = bitvox.lod('knot.ply', triangles=(800, 200))
    >>> coarse.check().closed, coarse.report.certificate.vertex_manifold
    (True, True)
    """
    known(lod, LodOptions, advanced)
    given: dict[str, Any] = {"error": error, "count": count, "solid": solid, "strict": strict, "levels": levels, **advanced}
    given = {name: value for name, value in given.items()
             if value is not None and (bool(value) if name in _FLAGS else value is not False or name == "sharp")
             and not (name in _USUAL and value == _USUAL[name])}
    asked = {name: value for name, value in given.items() if name in OF_VOXELS}
    other = [name for name in given if name not in (*OF_VOXELS, "dtype")]
    if getattr(source, "ndim", 0) == 3 and tuple(source.shape[1:]) == (3, 3):
        raise ArgumentError(f"an array of shape {tuple(source.shape)} may be triangles or voxels: give Mesh(array) or Grid.from_numpy(array)")
    is_grid = isinstance(source, Grid) or (getattr(source, "ndim", 0) == 3 and not hasattr(source, "faces"))
    limits: dict[str, Any] = {"threads": threads, "memory_limit": memory_limit, "progress": progress}

    chosen = _method(method, asked, other, is_grid and triangles is None and error is None)
    if chosen != "collapse":
        return _from_voxels(source, is_grid, chosen, triangles, resolution, carry, advanced.get("dtype"), limits, **asked)
    if is_grid and carry:
        raise ArgumentError("carry is for a source that is a mesh")
    if carry and not any(name in given for name in OF_SOLID) and resolution is None:
        raise ArgumentError("carry is for solid and the methods edge-ratio and coverage: levels of the mesh as it is have its attributes")

    with Rise(progress, *((10,) if is_grid else ()), 80, *((20,) if carry else ())) as limits["progress"]:
        mesh = surface(source, **limits) if is_grid else Mesh.of(source)
        options = options_of("levels_options")
        targets = _Targets(options, mesh, triangles, error, advanced, count)
        kept = _set_common(options, mesh, strict, error, advanced)
        options.solid = int(bool(solid))
        set_fit(options, resolution, advanced.get("lattice"))
        sign, shell = advanced.get("sign"), advanced.get("shell")
        options.sign = choice("sign", "auto" if sign is None else sign, "BVX_FILL_", REPAIR_SIGNS)
        options.sharp = sharpness(advanced.get("sharp"))
        if shell is not None:
            options.shell = or_none(float(shell), "shell")
        set_parts(options.parts, advanced.get("keep_largest"), advanced)
        if advanced.get("outer_hull"):
            if advanced.get("least_cavity"):
                raise ArgumentError("outer_hull fills every cavity; least_cavity is not used with it")
            options.parts.least_cavity = 2**64 - 1
        reports, report = ffi.new("bvx_level_report[]", targets.count), ffi.new("bvx_levels_report *")
        options.reports, options.report = reports, report

        array = ffi.new("bvx_mesh[]", targets.count)
        with Run(**limits) as run:
            run.check(lib.bvx_build_levels(run.context, mesh._view_of_all(run), options, targets.count, array))
        del kept
        result = _meshes(_take(array, targets.count), reports, mesh, mesh if carry else None, limits)
    result.report = record(report)
    return result


def _method(method: Method | None, of_voxels: dict[str, Any], of_collapse: list[str], samples: bool) -> str:
    """The method that was requested, or that the other options require; samples: a grid without a target."""
    if method is not None:
        if not isinstance(method, str):
            raise TypeError(f"method must be one of {', '.join(METHODS)}, not {method!r}")
        plain = method.lower().replace("_", "-")
        if plain not in METHODS:
            raise ArgumentError(f"method is {method!r}; it must be one of {', '.join(METHODS)}")
        if plain == "collapse" and of_voxels:
            raise ArgumentError(f"{next(iter(of_voxels))} is for the methods edge-ratio and coverage; method 'collapse' takes triangles, "
                                "error or count")
        if plain != "collapse" and of_collapse:
            raise ArgumentError(f"{of_collapse[0]} is for method 'collapse', not for {plain!r}")
        return plain
    if of_voxels and of_collapse:
        raise ArgumentError(f"{next(iter(of_voxels))} (of the methods edge-ratio and coverage) and {of_collapse[0]} (of method "
                            "'collapse') contradict each other; give one of them")
    if samples and of_collapse:
        raise ArgumentError(f"{of_collapse[0]} is for method 'collapse': give method='collapse', triangles or error to take the grid's surface as a mesh")
    return "edge-ratio" if of_voxels or samples else "collapse"


# ---- the paper's methods ----


def _from_voxels(source: Any, is_grid: bool, method: str, triangles: Any, resolution: Any, carry: bool, dtype: Any, limits: dict[str, Any], *,
                 levels: Any = None, threshold: float = 0.5, edge_samples: int | None = None, collapse: float | None = None,
                 fill: Fill | None = None, close_gaps: int | None = None, padding: int | None = None, face_rule: FaceRule = "separate",
                 local_frame: bool = False) -> Levels:
    if levels is not None and triangles is not None:
        raise ArgumentError("levels and triangles contradict each other; give one of them")
    if collapse is not None and triangles is None:
        raise ArgumentError("collapse is taken together with triangles")
    if edge_samples is not None and method != "edge-ratio":
        raise ArgumentError("edge_samples is for method 'edge-ratio'")
    options = options_of("lod_options")
    options.sampling.method = choice("method", method, "BVX_LOD_", METHODS[1:])
    if threshold == 0:
        raise OptionRangeError("threshold 0 is not between 0 and 1")
    options.sampling.threshold = float(threshold)
    options.sampling.edge_samples = 0 if edge_samples is None else in_range("edge_samples", edge_samples, 1, 65536)
    options.face_rule = choice("face_rule", face_rule, "BVX_FACE_", FACE_RULES)
    options.local_frame = int(bool(local_frame))
    options.collapse = 0.0 if collapse is None else float(collapse)
    count, kept = _set_levels(options, levels, triangles)
    with Rise(limits["progress"], *(() if is_grid else (40,)), 60, *((20,) if carry else ())) as progress:
        limits = {**limits, "progress": progress}
        mesh: Mesh | None = None
        if is_grid:
            for name, value in {"resolution": resolution, "fill": fill, "close_gaps": close_gaps, "padding": padding, "carry": carry or None}.items():
                if value is not None:
                    raise ArgumentError(f"{name} is for a source that is a mesh")
            solid = grid_of(source)
        else:
            mesh = Mesh.of(source)
            if resolution is None:
                resolution = _plan(mesh, options, count, padding or 0, limits)
            solid = voxelize(mesh, resolution=resolution, fill=fill, close_gaps=close_gaps, padding=padding or 0, **limits)
        reports = ffi.new("bvx_lod_report[]", count)
        options.reports = reports
        made = _build_levels(solid, options, count, dtype, limits)
        del kept
        return _meshes(made, reports, None, mesh if carry else None, limits)


def _plan(mesh: Mesh, options: Any, count: int, padding: int, limits: dict[str, Any]) -> int:
    """The resolution of the solid that suits the levels, as `bitvox lod` plans it."""
    out = ffi.new("int32_t *")
    with Run(None, limits["memory_limit"]) as run:
        run.check(lib.bvx_plan_lods(run.context, mesh._view(run), options, count, padding, out, ffi.NULL))
    return out[0]


def _set_levels(options: Any, levels: Any, triangles: Any) -> tuple[int, Any]:
    """Which levels are wanted: their count, and the array that options point at."""
    if triangles is not None:
        wanted = [in_range("triangles", n, 1, 2**64 - 1) for n in _listed(triangles, "triangles")]
        array = ffi.new("uint64_t[]", wanted)
        options.target_triangles = array
        return len(wanted), array
    given = _listed((64, 32, 16) if levels is None else levels, "levels")
    if any(_many(level) for level in given):
        flat = [n for level in given for n in arrays.triple("levels", level, int)]
        array = ffi.new("int32_t[]", flat)
        options.axis_resolutions = array
        return len(given), array
    wanted = [in_range("levels", n, 1, 2**25) for n in given]
    array = ffi.new("int32_t[]", wanted)
    options.resolutions = array
    return len(wanted), array


def _build_levels(solid: Grid, options: Any, count: int, dtype: Any, limits: dict[str, Any]) -> list[Any]:
    """The levels as bvx_meshes of their own."""
    options.position_type = lib.BVX_POSITION_AUTO if dtype is None else position_type(dtype)
    with Run(**limits) as run:
        array = ffi.new("bvx_mesh[]", count)
        run.check(lib.bvx_build_lods(run.context, solid._c, options, count, array))
    return _take(array, count)
