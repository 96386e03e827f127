"""Stacks of section contours."""

from __future__ import annotations

import os
import warnings
from typing import TYPE_CHECKING, Any, ClassVar, Iterable, NamedTuple, Sequence

from . import _arrays as arrays
from ._calls import call
from ._errors import ArgumentError, Error
from ._grid import Grid
from ._html import shown
from ._mesh import Mesh, new_mesh, position_type
from ._options import SectionsOptions
from ._records import record
from ._run import Progress, Rise, Run, choice, ffi, formats_in, function, in_range, known, lib, names_of, options_of, or_none
from ._stages import collapsed, level_target, surface
from ._words import Axis, Caps, Touching

if TYPE_CHECKING:
    from typing_extensions import Unpack

CAPS = names_of("BVX_CAPS_")
CROSSINGS = names_of("BVX_CROSSINGS_")
TOUCHING = ("apart", "shared")
SECTION_FORMATS = formats_in(lib.BVX_SECTIONS_READ)
SECTION_OUTPUTS = formats_in(lib.BVX_SECTIONS_WRITTEN)


class Loop(NamedTuple):
    """One closed contour: points (n, 3) [world], the last one joined to the first, and the body that it belongs to.

    Examples
    --------
    >>> square = bitvox.Loop(np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float), 'heart')
    >>> bitvox.Sections([square]).labels
    ['heart']
    """

    points: Any
    label: str = ""


class Sections:
    """Closed contours on planes: what .csl, .csv, .dxf and DICOM RTSTRUCT files hold, and `slice_mesh` makes.

    ``positions`` are the planes, ascending: point . normal [world]; ``section_of`` gives the plane of each of ``loops``.
    ``normals`` is None where all planes are parallel, else a tuple with the normal of each: a .csl file may hold such planes.

    Loops inside loops are holes, in these islands, and so on; in any order and direction.

    Parameters
    ----------
    loops
        `Loop` tuples, arrays (n, 3) [world] or trimesh's paths, each in one plane across ``normal``; pairs (z, (n, 2)).
    normal
        of all planes.
    tolerance
        how far a point may lie off its loop's plane, and how far apart planes may lie that count as one [world].

    Raises
    ------
    ArgumentError
        a loop of fewer than three points, or one that does not lie in a plane across the normal.

    Examples
    --------
    >>> square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
    >>> stack = bitvox.Sections([square, square + [0, 0, 2]])
    >>> stack.positions, len(stack.loops)
    ([0.0, 2.0], 2)
    """

    __slots__ = ("_sliced", "loops", "normal", "normals", "positions", "section_of")
    _sliced: bool  # set of what slice_mesh made
    normals: tuple[tuple[float, float, float], ...] | None
    positions: list[float]
    section_of: list[int]

    def __init__(self, loops: Iterable[Any], normal: Sequence[float] = (0.0, 0.0, 1.0), *, tolerance: float = 1e-6) -> None:
        np = arrays.numpy("Sections")
        direction = np.array(arrays.direction("normal", normal))
        length = float(np.sqrt(direction @ direction))
        if not length > 0.0 or not np.isfinite(length):
            raise ArgumentError("normal has no direction")
        self.normal: tuple[float, float, float] = tuple((direction / length).tolist())
        self.normals = None
        self.loops: list[Loop] = []
        heights = []
        for i, loop in enumerate(_each(loops)):
            found = _checked(i, loop)
            along = found.points @ direction / length
            if along.max() - along.min() > 2 * tolerance + 1e-12 * np.abs(along).max():
                raise ArgumentError(f"loop {i} does not lie in a plane across the normal: it reaches from {along.min()} to {along.max()}")
            heights.append(float(along.mean()))
            self.loops.append(found)
        self.positions, self.section_of = _planes(heights, tolerance)

    @property
    def labels(self) -> list[str]:
        """The bodies, in order of their first loops."""
        return list(dict.fromkeys(loop.label for loop in self.loops))

    def of(self, label: str | int) -> Sections:
        """The loops of the body with this ``label``; a number is its text.

        Examples
        --------
        >>> stack = bitvox.slice_mesh('knot.ply', spacing=0.3, label=7)
        >>> len(stack.of(7).loops) == len(stack.loops)
        True
        """
        made, label = Sections.__new__(Sections), str(label)
        chosen = [i for i, loop in enumerate(self.loops) if loop.label == label]
        if not chosen:
            raise ArgumentError(f"no loop has the label {label!r}; there are: {', '.join(map(repr, self.labels))}")
        made.loops, made.normal, made.positions = [self.loops[i] for i in chosen], self.normal, self.positions
        made.normals = self.normals
        made.section_of = [self.section_of[i] for i in chosen]
        made._sliced = getattr(self, "_sliced", False)
        return made

    @classmethod
    def on_planes(cls, loops: Iterable[Any], *, tolerance: float = 1e-6) -> Sections:
        """Loops that each lie in a plane of some direction: those of one plane become one section.

        Parameters
        ----------
        loops
            `Loop` tuples, arrays (n, 3) [world], trimesh's paths, pairs (z, (n, 2)).
        tolerance
            how far a point may lie off its loop's plane, and loops off a plane that they have in common [world].

        Returns
        -------
        Sections
            With ``normals`` unless all planes are parallel. Normals point to the positive side of their main axis.

        Raises
        ------
        ArgumentError
            a loop of fewer than three points, one without an area, or one that does not lie in a plane.

        Examples
        --------
        >>> square = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], float)
        >>> cross = bitvox.Sections.on_planes([square, np.roll(square, 1, axis=1)])
        >>> cross.normals
        ((0.0, 0.0, 1.0), (1.0, 0.0, 0.0))
        >>> bitvox.from_sections(cross, cells=16).check().closed
        True
        """
        np = arrays.numpy("Sections")
        given = [_checked(i, loop) for i, loop in enumerate(_each(loops))]
        normals: list[Any] = []
        positions: list[float] = []
        section_of = []
        for i, loop in enumerate(given):
            direction, height = _plane_of(i, loop.points, tolerance)
            for k, (normal, position) in enumerate(zip(normals, positions)):
                turned = float(np.linalg.norm(np.cross(normal, direction)))
                if turned < _SAME_DIRECTION and float(np.abs(loop.points @ normal - position).max()) <= 2 * tolerance:
                    section_of.append(k)
                    break
            else:
                section_of.append(len(normals))
                normals.append(direction)
                positions.append(height)
        if all(float(np.linalg.norm(np.cross(normal, normals[0]))) <= _PARALLEL for normal in normals):
            return cls(given, normals[0].tolist() if normals else (0.0, 0.0, 1.0), tolerance=max(tolerance, _spread(given, normals)))
        made = cls.__new__(cls)
        made.loops, made.positions, made.section_of = given, positions, section_of
        made.normals = tuple((float(x), float(y), float(z)) for x, y, z in normals)
        made.normal = made.normals[0]
        return made

    def bodies(self, *, touching: Touching = "apart", **options: Any) -> dict[str, Mesh]:
        """The body of each label: what `from_sections` makes of it with these options.

        Parameters
        ----------
        touching
            "shared": all bodies are made at once, so that where the contours of two run along each other both have the same
            faces there, the other way round. Parallel planes are then taken as those of any direction are: of the options
            ``cells``, ``spacing``, ``agree``, ``caps``, ``dtype``, ``threads``, ``memory_limit`` and ``progress`` count, others
            are refused; each mesh has the report of all bodies together. "apart": each body for itself.
        **options
            those of `from_sections`, but for ``label``. ``progress`` rises once for each body.

        Returns
        -------
        dict
            a `Mesh` for each label, in the order of ``labels``; none without loops.

        Examples
        --------
        >>> square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
        >>> loops = [bitvox.Loop(square + [x, 0, z], name) for x, name in ((0, 'left'), (3, 'right')) for z in (0, 2)]
        >>> {name: round(body.check().volume, 6) for name, body in bitvox.Sections(loops).bodies().items()}
        {'left': 2.0, 'right': 2.0}
        >>> touching = bitvox.Sections([bitvox.Loop(square + [x, 0, z], str(x)) for x in (0, 1) for z in (0, 1, 2)])
        >>> all(body.check().closed for body in touching.bodies(touching='shared', cells=16).values())
        True

        Raises
        ------
        FormatError
            with ``touching="shared"``: bodies that overlap; the section and both labels are named.
        ArgumentError
            with ``touching="shared"``: an option that it does not use.
        """
        if touching not in TOUCHING:
            raise ArgumentError(f"touching is {touching!r}; it must be one of {', '.join(TOUCHING)}")
        if touching == "shared":
            return _joint_bodies(self, **options)
        return {label: from_sections(self, label=label, **options) for label in self.labels}

    def on(self, section: int) -> list[Loop]:
        """The loops on one plane; ``section`` is its number in ``positions``.

        Examples
        --------
        >>> stack = bitvox.slice_mesh('knot.ply', spacing=0.3)
        >>> len(stack.on(0)) >= 1
        True
        """
        return [loop for loop, at in zip(self.loops, self.section_of) if at == section]

    def _numbers(self) -> dict[str, int]:
        """The library's number of each label: its own when all are numbers, else 1, 2, 3 ..."""
        labels = self.labels
        try:
            numbers = {label: int(label) if label else 0 for label in labels}
        except ValueError:
            return {label: i + 1 for i, label in enumerate(labels)}
        fits = all(-(2**31) < n < 2**31 for n in numbers.values()) and len(set(numbers.values())) == len(labels)
        return numbers if fits else {label: i + 1 for i, label in enumerate(labels)}

    def _struct(self, run: Run) -> Any:
        """A bvx_sections over packed arrays; run keeps them."""
        np = arrays.numpy("Sections")
        function("bvx_build_sections")
        made = ffi.new("bvx_sections *")
        points = np.ascontiguousarray(np.concatenate([loop.points for loop in self.loops]) if self.loops else np.zeros((0, 3)))
        loops, numbers, first = ffi.new("bvx_section_loop[]", max(1, len(self.loops))), self._numbers(), 0
        for i, loop in enumerate(self.loops):
            loops[i].first_point, loops[i].point_count = first, len(loop.points)
            loops[i].section, loops[i].label = self.section_of[i], numbers[loop.label]
            first += len(loop.points)
        positions = ffi.new("double[]", self.positions or [0.0])
        made.points, made.loops, made.positions = ffi.cast("double *", arrays.address(points)), loops, positions
        made.point_count = made.point_capacity = len(points)
        made.loop_count = made.loop_capacity = len(self.loops)
        made.section_count = made.section_capacity = len(self.positions)
        made.normal = self.normal
        normals = ffi.new("double[]", [x for normal in self.normals or () for x in normal] or [0.0])
        if self.normals is not None:
            made.normals = normals
        run.keep((points, loops, positions, normals))
        return made

    @classmethod
    def _made(cls, owner: Any) -> Sections:
        """Sections over the arrays of a bvx_sections that the library made."""
        self = cls.__new__(cls)
        points = arrays.array_at(owner.points, "float64", (owner.point_count, 3), owner)
        found = [owner.loops[i] for i in range(owner.loop_count)]
        self.loops = [Loop(points[f.first_point : f.first_point + f.point_count], str(f.label)) for f in found]
        self.section_of = [f.section for f in found]
        self.positions = [owner.positions[i] for i in range(owner.section_count)]
        x, y, z = owner.normal
        length = (x * x + y * y + z * z) ** 0.5
        self.normal = (x / length, y / length, z / length)
        self.normals = None
        if owner.normals != ffi.NULL:
            self.normals = tuple((owner.normals[3 * i], owner.normals[3 * i + 1], owner.normals[3 * i + 2])
                                 for i in range(owner.section_count))
        return self

    def surface(self, **options: Any) -> Mesh:
        """The closed surface through all contours; ``options`` are those of `from_sections`.

        Examples
        --------
        >>> bitvox.slice_mesh('knot.ply', spacing=0.1).surface().check().closed
        True
        """
        return from_sections(self, **options)

    def save(self, path: Any, format: str | None = None) -> None:
        """Write to ``path``, by its ending or ``format``: .csl or .csv (planes z = position). Names of bodies stand in
        .csv; .csl holds numbers alone, which a warning lists.

        Examples
        --------
        >>> bitvox.slice_mesh('knot.ply', spacing=0.3).save('knot.csl')
        """
        call("write", self, path, format=format)

    def __len__(self) -> int:
        return len(self.positions)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Sections):
            return NotImplemented
        np = arrays.numpy("Sections")
        return ((self.normal, self.normals, self.section_of, self.positions)
                == (other.normal, other.normals, other.section_of, other.positions)
                and all(a.label == b.label and np.array_equal(a.points, b.points) for a, b in zip(self.loops, other.loops)))

    __hash__: ClassVar[None] = None  # type: ignore[assignment]

    def _repr_html_(self) -> str:
        return shown(self, {"planes": len(self.positions), "loops": len(self.loops), "bodies": self.labels, "normal": self.normal})

    def __repr__(self) -> str:
        counts = ((len(self.positions), "plane", "planes"), (len(self.loops), "loop", "loops"), (len(self.labels), "body", "bodies"))
        return f"Sections({', '.join(f'{n} {one if n == 1 else more}' for n, one, more in counts)})"


_PARALLEL = 1e-4  # rad, as the library takes planes for parallel
_SAME_DIRECTION = 1e-3  # rad, of loops in one plane: the direction of a small loop is known less well


def _each(loops: Any) -> Iterable[Any]:
    """Loops one by one: those of each trimesh path, and pairs (z, xy) as loops on z."""
    np = arrays.numpy("Sections")
    for given in [loops] if hasattr(loops, "discrete") else loops:
        if hasattr(given, "discrete"):
            if not given.is_closed:
                raise ArgumentError("a path is open; contours are closed")
            yield from (path[:-1] for path in (given.to_3D() if "to_3D" in given.metadata else given).discrete)
        elif isinstance(given, tuple) and not isinstance(given, Loop) and len(given) == 2 and np.ndim(given[0]) == 0:
            xy = np.asarray(given[1], np.float64)
            yield np.column_stack((xy, np.full(len(xy), given[0]))) if xy.ndim == 2 else xy
        elif given is not None:  # where a plane misses the mesh trimesh has None
            yield given


def _checked(i: int, loop: Any) -> Loop:
    """A loop over finite doubles."""
    np = arrays.numpy("Sections")
    found = loop if isinstance(loop, Loop) else Loop(loop)
    points = arrays.exact_floats(arrays.as_numpy(found.points, f"loop {i}"), f"loop {i}").astype(np.float64)
    if points.ndim != 2 or points.shape[1] != 3 or len(points) < 3:
        raise ArgumentError(f"loop {i} has shape {points.shape}; it must be (n, 3), n at least 3")
    if not np.isfinite(points).all():
        raise ArgumentError(f"loop {i} holds a coordinate that is not finite")
    return Loop(points, found.label)


def _plane_of(i: int, points: Any, tolerance: float) -> tuple[Any, float]:
    """The unit normal of a loop's plane, by its area, and the plane's distance from the origin."""
    np = arrays.numpy("Sections")
    middle = points.mean(0)
    around = points - middle
    area = np.cross(around, np.roll(around, -1, axis=0)).sum(0)
    size = float(np.linalg.norm(area))
    if not size > 1e-12 * float((around * around).sum()):
        raise ArgumentError(f"loop {i} has no area, so it has no plane")
    normal = area / size
    normal = (-normal if normal[int(np.abs(normal).argmax())] < 0 else normal) + 0.0
    off = float(np.abs(around @ normal).max())
    if off > tolerance + 1e-12 * float(np.abs(points).max()):
        raise ArgumentError(f"loop {i} does not lie in a plane: points lie up to {off} off it")
    return normal, float(middle @ normal)


def stacked(loops: list[Loop], normal: Any, tolerance: float) -> Sections:
    """Across the normal where all loops are, else each in its own plane."""
    np = arrays.numpy("Sections")
    direction = np.asarray(normal, float) / np.linalg.norm(normal)
    flat = all(float(np.ptp(loop.points @ direction)) <= 2 * tolerance for loop in loops)
    return Sections(loops, normal, tolerance=tolerance) if flat else Sections.on_planes(loops, tolerance=tolerance)


def _spread(loops: list[Loop], normals: list[Any]) -> float:
    """How far loops reach along the first of normals that are almost one."""
    np = arrays.numpy("Sections")
    return max((float(np.ptp(loop.points @ normals[0])) for loop in loops), default=0.0)


def _planes(heights: list[float], tolerance: float) -> tuple[list[float], list[int]]:
    """Positions of the different planes, ascending, and the number of each loop's plane."""
    order = sorted(range(len(heights)), key=lambda i: heights[i])
    positions: list[float] = []
    section = [0] * len(heights)
    for i in order:
        if not positions or heights[i] - positions[-1] > 2 * tolerance:
            positions.append(heights[i])
        section[i] = len(positions) - 1
    return positions, section


def new_sections() -> Any:
    """An empty bvx_sections that is freed with the last array over it."""
    free = function("bvxpy_free_sections")
    return ffi.gc(ffi.new("bvx_sections *"), free)


def _stack_of(source: Any) -> Sections:
    """Sections as they are, the contours of a file, or loops."""
    if isinstance(source, Sections):
        return source
    if not isinstance(source, (str, os.PathLike)):
        return Sections(source)
    found = call("read", source)
    if not isinstance(found, Sections):
        raise ArgumentError(f"{os.fspath(source)} holds no contours; .csl, .csv, .dxf and RTSTRUCT's .dcm do")
    return found


def _mesh_to_cut(source: Any, limits: dict[str, Any]) -> Mesh:
    """A mesh; a grid becomes its surface."""
    if isinstance(source, (str, os.PathLike)):
        source = call("read", source)
    return surface(source, dtype="float64", **limits) if isinstance(source, Grid) else Mesh.of(source)


def from_sections(
    sections: Any,
    *,
    grid: Sequence[int] | None = None,
    spacing: float | None = None,
    caps: Caps = "flat",
    thickness: float | None = None,
    mend: bool | None = None,
    label: str | int | None = None,
    triangles: int | None = None,
    error: float | str | None = None,
    threads: int | None = None,
    memory_limit: int | None = None,
    progress: Progress = None,
    **advanced: Unpack[SectionsOptions],
) -> Mesh:
    """The closed surface of a body through all of its section contours.

    Parameters
    ----------
    sections
        `Sections`, a file (``.csl``, ``.csv``, ``.dxf``, a DICOM RTSTRUCT's ``.dcm``), or loops on planes across z: arrays
        (n, 3), pairs (z, (n, 2)), or paths of trimesh (``section``, ``section_multiplane``).
    grid
        cells along the planes' two axes, or ``spacing``: the side of a square cell [world]. Default: twice the mean length
        of the contours' segments.
    caps
        how the body ends: "flat" on the first and the last section, "taper" to a ridge half a spacing beyond, or "open".
    thickness
        of a body with a single section, which is refused without: half to either side of it, a slab with flat caps, with
        tapered ones a lens [world]. Bodies with several sections ignore it.
    mend
        split loops where they touch or cross themselves or each other, in place of refusing them; inside stays what an odd
        number of loops enclose. Default: contours of `slice_mesh` are, as of a mesh that crosses itself; others are refused.
    label
        which body, when there are several; `Sections.bodies` makes all of them.
    triangles, error
        most triangles, or the distance to the body's whole surface, by edges that collapse: as for `repair`.
        Contour points are then no longer vertices; ``caps="open"`` cannot be collapsed.
    advanced
        `SectionsOptions`: ``cells``, ``agree``, ``crossings``, ``subdivide``,
        ``error_kind``, ``dtype``.

    Returns
    -------
    Mesh
        A `Mesh`; ``mesh.report`` is a `bitvox.reports.SectionsReport`.

    Raises
    ------
    FormatError
        loops that cross or touch, points off their plane: section, loop and point are named.
    EmptyError
        no loop, or a single section and no ``thickness``.
    ArgumentError
        several bodies and no ``label`` (`Sections.bodies` makes all of them); options that contradict each other.
    RangeError, MemoryLimitError

    Examples
    --------
    >>> square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
    >>> body = bitvox.from_sections([square, square + [0, 0, 2]], spacing=0.25)
    >>> body.check().closed, round(body.check().volume, 2)
    (True, 2.0)
    """
    known(from_sections, SectionsOptions, advanced)
    subdivide = advanced.get("subdivide")
    build = function("bvx_build_sections")
    targets = level_target(triangles, error, advanced.get("error_kind"))
    if targets and caps == "open":
        raise ArgumentError(f"{next(iter(targets))} needs a closed body; caps 'open' leaves it open")
    given = _stack_of(sections)
    options = options_of("sections_options")
    if grid is not None:
        if spacing is not None:
            raise ArgumentError("grid and spacing contradict each other; give one of them")
        if len(grid) != 2:
            raise ArgumentError("grid must be two numbers of cells")
        options.slabs.grid = [in_range("grid", n, 2, 8192) for n in grid]
    _set_cells(options, advanced.get("cells"), spacing, advanced.get("agree"))
    options.caps = choice("caps", caps, "BVX_CAPS_", CAPS)
    if thickness is not None:
        options.thickness = float(thickness)
    mend = getattr(given, "_sliced", False) if mend is None else mend
    options.mend = int(bool(mend))
    options.slabs.crossings = choice("crossings", advanced.get("crossings", "exact"), "BVX_CROSSINGS_", CROSSINGS)
    if subdivide is not None:
        options.slabs.depth = or_none(in_range("subdivide", subdivide, 0, 8))
    if label is None and len(given.labels) > 1:
        raise ArgumentError(f"there are several bodies; give label= one of {', '.join(map(repr, given.labels))}")
    if label is not None:
        label, numbers = str(label), given._numbers()
        if label not in numbers:
            raise ArgumentError(f"no loop has the label {label!r}; there are: {', '.join(map(repr, given.labels))}")
        options.label = numbers[label] or lib.BVX_LABEL_ZERO
    options.position_type = position_type(advanced.get("dtype", "float64"))
    report = ffi.new("bvx_sections_report *")
    options.report = report
    made = new_mesh()
    limits: dict[str, Any] = {"threads": threads, "memory_limit": memory_limit, "progress": progress}
    with Rise(progress, 60, *((40,) if targets else ())) as limits["progress"]:
        with Run(**limits) as run:
            try:
                run.check(build(run.context, given._struct(run), options, made))
            except Error as why:
                if why.reason in ("BVX_REASON_LOOPS_MEET", "BVX_REASON_LOOP_FLAT") and not mend:
                    why.args = (f"{why}; mend=True {'splits loops there' if why.reason.endswith('MEET') else 'leaves such loops out'}",)
                raise
        mesh = Mesh._made(made)
        mesh = collapsed(mesh, targets, limits)
    mesh.report = record(report)
    return mesh


def _set_cells(options: Any, cells: int | None, spacing: float | None, agree: float | None) -> None:
    """What decides the lattice's cells, and how far contours may be apart to be made to agree."""
    if cells is not None:
        if spacing is not None:
            raise ArgumentError("cells and spacing contradict each other; give one of them")
        options.cells = in_range("cells", cells, 8, 1024)
    if spacing is not None:
        options.spacing = float(spacing)
    if agree is not None:
        options.agree = float(agree)


def _joint_bodies(stack: Sections, *, spacing: float | None = None, cells: int | None = None, agree: float | None = None,
                  caps: Caps = "flat", dtype: Any = "float64", threads: int | None = None, memory_limit: int | None = None,
                  progress: Progress = None, **others: Any) -> dict[str, Mesh]:
    """All bodies by one call, with the same faces where two touch."""
    build = function("bvx_build_bodies")
    if others:
        raise ArgumentError(f"{next(iter(others))} is not used with touching='shared', which makes bodies by cells")
    options = options_of("sections_options")
    _set_cells(options, cells, spacing, agree)
    options.caps = choice("caps", caps, "BVX_CAPS_", CAPS)
    options.position_type = position_type(dtype)
    if not stack.labels:
        return {}
    report = ffi.new("bvx_sections_report *")
    options.report = report
    numbers = stack._numbers()
    labels = ffi.new("int32_t[]", [numbers[label] for label in stack.labels])
    array = ffi.new("bvx_mesh[]", len(stack.labels))
    with Run(threads=threads, memory_limit=memory_limit, progress=progress) as run:
        run.check(build(run.context, stack._struct(run), options, labels, len(stack.labels), array))
    made = {}
    for i, label in enumerate(stack.labels):
        owner = new_mesh()
        owner[0] = array[i]
        made[label] = Mesh._made(owner)
        made[label].report = record(report)
    return made


def slice_mesh(mesh: Any, *, axis: Axis | None = None, normal: Sequence[float] | None = None, spacing: float | None = None,
               positions: Sequence[float] | None = None, label: int = 1, threads: int | None = None,
               memory_limit: int | None = None, progress: Progress = None) -> Sections:
    """The contours of a closed mesh, or of a grid's surface, on parallel planes: exact.

    Parameters
    ----------
    mesh
        what `Mesh.of` takes, a `Grid`, or the file of one of them.
    axis
        planes lie across "x", "y" or "z" (the default), or across a ``normal``.
    spacing
        from plane to plane; the first lies half of it above the lowest point [world].
    positions
        the planes in place of a spacing, ascending: point . normal / |normal| [world].
    label
        a number that all loops get.

    Returns
    -------
    Sections
        `Sections`; loops run with the inside on their left, seen against the normal.

    Raises
    ------
    FormatError
        the mesh is open where a plane meets it.
    EmptyError
        no plane meets it.
    ArgumentError, RangeError, MemoryLimitError

    Examples
    --------
    >>> stack = bitvox.slice_mesh('knot.ply', axis='z', spacing=0.2)
    >>> len(stack) == len(stack.positions)
    True
    """
    cut = function("bvx_slice_mesh")
    options = options_of("slice_options")
    if (spacing is None) == (positions is None):
        raise ArgumentError("give spacing or positions")
    if axis is not None and normal is not None:
        raise ArgumentError("axis and normal contradict each other; give one of them")
    if axis not in (None, "x", "y", "z"):
        raise ArgumentError(f"axis is {axis!r}; it must be x, y or z")
    options.normal = [float(a == (axis or "z")) for a in "xyz"] if normal is None else arrays.direction("normal", normal)
    if spacing is not None:
        options.spacing = float(spacing)
    held = None
    if positions is not None:
        held = ffi.new("double[]", [float(x) for x in positions] or [0.0])
        options.positions, options.position_count = held, len(positions)
    options.label = in_range("label", label, -(2**31) + 1, 2**31 - 1) or lib.BVX_LABEL_ZERO
    made = new_sections()
    limits: dict[str, Any] = {"threads": threads, "memory_limit": memory_limit, "progress": progress}
    with Rise(progress, *((30,) if isinstance(mesh, Grid) else ()), 70) as limits["progress"]:
        source = _mesh_to_cut(mesh, limits)
        with Run(**limits) as run:
            run.check(cut(run.context, source._view(run), options, made))
    del held
    cuts = Sections._made(made)
    cuts._sliced = True
    return cuts


def read_sections(data: Any, number: int, close_gap: float | None, run: Run) -> Sections:
    """Sections from the bytes of a .csl or .csv file."""
    made = new_sections()
    options = options_of("read_sections_options")
    options.close_gap = 0.0 if close_gap is None else float(close_gap)
    flipped = options.flipped = ffi.new("uint64_t *")
    run.check(function("bvx_read_sections")(run.context, data, len(data), number, options, made))
    if flipped[0]:
        warnings.warn("D has the other sign on all planes of the .csl, A x + B y + C z = D; the points were taken", stacklevel=5)
    found = Sections._made(made)
    names = _names_in(bytes(ffi.buffer(data))) if number == lib.BVX_FORMAT_CSV else {}
    found.loops = [loop._replace(label=names.get(loop.label, loop.label)) for loop in found.loops]
    return found


def named(data: bytes, sections: Sections, kind: str) -> bytes:
    """A file of numbered bodies with the names that they have; a warning where the format has no place for names."""
    names = {str(number): label for label, number in sections._numbers().items() if label not in (str(number), "")}
    if names and kind == "csl":
        said = ", ".join(f"{number} for {name!r}" for number, name in names.items())
        warnings.warn(f".csl has numbers in place of names: {said}; .csv keeps names", stacklevel=5)
    if not names or kind != "csv":
        return data
    rows = data.decode().splitlines()
    texts = {number: " ".join(name.split()) for number, name in names.items()}
    return "".join(f"{row},{texts.get(row.split(',')[3], '') if i else 'body'}\n" for i, row in enumerate(rows)).encode()


def _names_in(data: bytes) -> dict[str, str]:
    """The names of bodies that the last column of a table has, as `named` writes it."""
    head, _, rest = data.partition(b"\n")
    columns = head.decode(errors="replace").strip().split(",")
    if columns[-1] != "body" or "label" not in columns:
        return {}
    at, found = columns.index("label"), {}
    for row in rest.decode(errors="replace").splitlines():
        words = row.split(",", len(columns) - 1)  # a name may hold commas
        if len(words) == len(columns) and words[at] and words[-1]:
            found[words[at]] = words[-1]
    return found if len(set(found.values())) == len(found) else {}
