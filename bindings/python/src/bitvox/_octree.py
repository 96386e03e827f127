"""Octrees: voxels of several sizes."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, ClassVar, Iterable, Union

from . import _arrays as arrays
from ._bytes import by_file
from ._calls import TABLE, call
from ._errors import ArgumentError, need
from ._grid import Grid, new_grid
from ._html import shown
from ._lattice import Lattice, WindowLike, set_window
from ._mesh import Mesh, with_positions
from ._records import record
from ._run import FACE_RULES, Progress, Run, choice, ffi, in_range, lib, names_of, options_of, or_none
from ._words import Array, Direction, FaceRule

if TYPE_CHECKING:
    from .reports import OctreeLevel

STATES = names_of("BVX_STATE_")
_DIRECTIONS = ("-x", "-y", "-z", "+x", "+y", "+z")

States = Union[str, Iterable[str], None]


def states_of(states: States) -> int:
    """A set of states as the library takes it; None: surface and inside."""
    if states is None:
        return 0
    names = states.split(",") if isinstance(states, str) else list(states)
    if not names:
        raise ArgumentError("states names none")
    total = 0
    for name in names:
        total |= choice("states", name, "BVX_STATE_", STATES)
    return total


class Octree:
    """Voxels of several sizes; made by `bitvox.refine`.

    Leaves come as record arrays with the fields ``ijk`` (index among the voxels of their level), ``level`` (0 is the base)
    and ``state`` (1 outside, 2 inside, 4 surface).

    Examples
    --------
    >>> tree = bitvox.refine('knot.ply', base=4, levels=2)
    >>> tree.levels, len(tree.counts())
    (2, 3)
    """

    __slots__ = ("_c", "__weakref__")

    def __init__(self, owner: Any) -> None:
        self._c = owner

    @property
    def levels(self) -> int:
        """How many times the base's voxels are halved: the number of the last level."""
        return lib.bvx_octree_levels(self._c)

    def lattice(self, level: int | None = None) -> Lattice:
        """The lattice of a level; None: of the last.

        Examples
        --------
        >>> tree = bitvox.refine('knot.ply', base=8, levels=2)
        >>> tree.lattice().shape[0]
        32
        """
        out = ffi.new("bvx_lattice *")
        with Run() as run:
            run.check(lib.bvx_octree_lattice(run.context, self._c, self._level(level), out))
        return Lattice._of(out)

    @property
    def shape(self) -> tuple[int, int, int]:
        """Voxels of the last level along x, y, z."""
        return self.lattice().shape

    @property
    def spacing(self) -> tuple[float, float, float]:
        """Edges of a voxel of the last level [world]."""
        return self.lattice().spacing

    @property
    def corner(self) -> tuple[float, float, float]:
        """Low corner of the first voxel, of every level [world]."""
        return self.lattice().corner

    @property
    def center0(self) -> tuple[float, float, float]:
        """Center of the first voxel of the last level [world]."""
        return self.lattice().center0

    @property
    def origin(self) -> tuple[float, float, float]:
        """`center0` under the name that SimpleITK and NRRD have for it [world]; the library and the program call the `corner` so."""
        return self.center0

    @property
    def bounds(self) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
        """Low and high corner of all its voxels: ((x, y, z), (x, y, z)) [world]."""
        return self.lattice().bounds

    @property
    def volume(self) -> float:
        """Of the leaves at the surface and inside: that of ``expand()`` [world^3]."""
        total = 0.0
        for level, counts in enumerate(self.counts()):
            a, b, c = self.lattice(level).spacing
            total += (counts.surface + counts.inside) * (a * b * c)
        return total

    def _level(self, level: int | None) -> int:
        return self.levels if level is None else in_range("level", level, 0, self.levels)

    def counts(self) -> list[OctreeLevel]:
        """Counts of each level (`bitvox.reports.OctreeLevel`): voxels, split, surface, inside, outside, bytes.

        Examples
        --------
        >>> tree = bitvox.refine('knot.ply', base=8, levels=2)
        >>> [one.voxels > 0 for one in tree.counts()]
        [True, True, True]
        """
        n = self.levels + 1
        out = ffi.new("bvx_octree_level[]", n)
        with Run() as run:
            run.check(lib.bvx_octree_count(run.context, self._c, out, n))
        return [record(out[i]) for i in range(n)]

    def at(self, voxels: Any) -> Any:
        """The leaves that hold voxels (n, 3) of the last level.

        Examples
        --------
        >>> tree = bitvox.refine('knot.ply', base=4, levels=3)
        >>> leaf = tree.leaves('surface')[:1]
        >>> tree.at(leaf['ijk']) == leaf
        array([ True])
        """
        given = arrays.numbers_in(voxels, "voxels", 3, "int32")
        out = ffi.new("bvx_octree_leaf[]", max(1, given.count))
        with Run() as run:
            run.check(lib.bvx_octree_at(run.context, self._c, ffi.cast("int32_t *", given.pointer), given.count, out))
        return arrays.records_at(out, "bvx_octree_leaf", given.count, out)

    def find(self, points: Any) -> Any:
        """The leaves that hold points (n, 3) [world]; beyond the lattice: state outside, level 255.

        Examples
        --------
        >>> bitvox.refine('knot.ply', base=4, levels=3).find([[100, 100, 100]])['level'].tolist()
        [255]
        """
        given = arrays.numbers_in(points, "points", 3)
        out = ffi.new("bvx_octree_leaf[]", max(1, given.count))
        with Run() as run:
            run.check(lib.bvx_octree_find(run.context, self._c, ffi.cast("double *", given.pointer), given.count, out))
        return arrays.records_at(out, "bvx_octree_leaf", given.count, out)

    def neighbors(self, leaf: Any, direction: Direction) -> Any:
        """The leaves that share a face with a ``leaf`` (one record), in the ``direction`` "-x", "-y", "-z", "+x", "+y" or "+z".

        Examples
        --------
        >>> tree = bitvox.refine('knot.ply', base=4, levels=3)
        >>> len(tree.neighbors(tree.leaves('surface')[0], '+x')) > 0
        True
        """
        if direction not in _DIRECTIONS:
            raise ArgumentError(f"direction is {direction!r}; it must be one of {', '.join(_DIRECTIONS)}")
        one = ffi.new("bvx_octree_leaf *", {"ijk": [int(x) for x in leaf["ijk"]], "level": int(leaf["level"]), "state": int(leaf["state"])})
        count = ffi.new("uint64_t *")
        side = _DIRECTIONS.index(direction)
        with Run() as run:
            run.check(lib.bvx_octree_neighbours(run.context, self._c, one, side, ffi.NULL, 0, count))
            out = ffi.new("bvx_octree_leaf[]", max(1, count[0]))
            run.check(lib.bvx_octree_neighbours(run.context, self._c, one, side, out, count[0], count))
        return arrays.records_at(out, "bvx_octree_leaf", count[0], out)

    def cast(self, rays: Any, *, states: States = None, t_max: float = float("inf"), threads: int | None = None,
             memory_limit: int | None = None, progress: Progress = None) -> Any:
        """Where rays first meet a leaf in a set of states.

        Parameters
        ----------
        rays
            (n, 6) origin and direction, of any length but 0 [world].
        states
            by default ("surface", "inside").
        t_max
            hits have ``0 <= t <= t_max``, position = origin + t * direction.

        Returns
        -------
        Any
            A record array of n hits with t, position [world], leaf, axis (-1: the ray starts inside), hit (0 or 1).

        Examples
        --------
        >>> tree = bitvox.refine('knot.ply', base=4, levels=3)
        >>> bool(tree.cast([[-10, 2, 0, 1, 0, 0]])['hit'][0])
        True
        """
        given = arrays.numbers_in(rays, "rays", 6)
        out = ffi.new("bvx_octree_hit[]", max(1, given.count))
        with Run(threads, memory_limit, progress) as run:
            run.check(lib.bvx_octree_cast(run.context, self._c, states_of(states), ffi.cast("double *", given.pointer), given.count, t_max, out))
        return arrays.records_at(out, "bvx_octree_hit", given.count, out)

    def leaves(self, states: States = None) -> Array:
        """The leaves in a set of states, by default ("surface", "inside").

        Examples
        --------
        >>> tree = bitvox.refine('knot.ply', base=8, levels=2)
        >>> len(tree.leaves('surface')) > 0
        True
        """
        count = ffi.new("uint64_t *")
        with Run() as run:
            run.check(lib.bvx_octree_leaves(run.context, self._c, states_of(states), ffi.NULL, 0, count))
            out = ffi.new("bvx_octree_leaf[]", max(1, count[0]))
            run.check(lib.bvx_octree_leaves(run.context, self._c, states_of(states), out, count[0], count))
        return arrays.records_at(out, "bvx_octree_leaf", count[0], out)

    def expand(self, level: int | None = None, *, states: States = None, window: WindowLike = None, threads: int | None = None,
               memory_limit: int | None = None, progress: Progress = None) -> Grid:
        """The voxels of one level as a grid.

        Parameters
        ----------
        level
            None: the last.
        states
            which leaves count, by default ("surface", "inside").
        window
            only this box of the level's lattice.

        Examples
        --------
        >>> tree = bitvox.refine('knot.ply', base=8, levels=2)
        >>> tree.expand(1).shape[0]
        16
        """
        made = new_grid()
        box = ffi.new("bvx_window *")
        set_window("window", box, window)
        with Run(threads, memory_limit, progress) as run:
            run.check(lib.bvx_octree_expand(run.context, self._c, self._level(level), states_of(states), box, made))
        return Grid._made(made)

    def surface(self, *, states: States = None, dtype: Any = None, face_rule: FaceRule = "separate", local_frame: bool = False,
                keys: bool = False, threads: int | None = None, memory_limit: int | None = None, progress: Progress = None) -> Mesh:
        """The closed surface of the last level's voxels in a set of states.

        Parameters
        ----------
        states
            by default ("surface", "inside").
        dtype, face_rule, local_frame, keys
            as for `bitvox.surface`.

        Examples
        --------
        >>> tree = bitvox.refine('knot.ply', base=8, levels=2)
        >>> tree.surface().check().closed
        True
        """
        options = options_of("extract_options")
        options.face_rule = choice("face_rule", face_rule, "BVX_FACE_", FACE_RULES)
        options.local_frame, options.keys = int(bool(local_frame)), int(bool(keys))
        return with_positions(
            options, dtype, lambda run, made: lib.bvx_extract_octree(run.context, self._c, states_of(states), options, made),
            threads=threads, memory_limit=memory_limit, progress=progress)

    def to_pyvista(self, *, states: States = None) -> Any:
        """A pyvista.UnstructuredGrid of the leaves in a set of ``states``, as the .vtu that `save` writes has it; needs ``bitvox[view]``.

        Examples
        --------
        >>> bitvox.refine('knot.ply', base=8, levels=2).to_pyvista().n_cells > 100
        True
        """
        return by_file(call("dumps", self, "vtu", states=states), "vtu", need("pyvista", "view").read)

    def save(self, path: str | os.PathLike[str], *, states: States = None) -> None:
        """Write to ``path`` the whole octree (.bvx, which `bitvox.read` reads), or a VTK unstructured grid (.vtu) of the leaves
        in a set of states.

        Examples
        --------
        >>> tree = bitvox.refine('knot.ply', base=8, levels=2)
        >>> tree.save('knot.vtu')
        """
        call("write", self, path, states=states)

    def __eq__(self, other: object) -> bool:
        return bool(call("dumps", self, "bvx") == call("dumps", other, "bvx")) if isinstance(other, Octree) else NotImplemented

    __hash__: ClassVar[None] = None  # type: ignore[assignment]

    def __reduce__(self) -> Any:
        return TABLE["loads"], (call("dumps", self, "bvx"), "bvx")

    def _repr_html_(self) -> str:
        finest = self.lattice()
        return shown(self, {"levels": self.levels, "leaves": sum(c.voxels - c.split for c in self.counts()), "finest": finest.shape,
                            "spacing": finest.spacing})

    def __repr__(self) -> str:
        counts = self.counts()
        return f"Octree({self.levels} levels, {sum(c.voxels - c.split for c in counts)} leaves)"


def _base_of(run: Run, source: Mesh, base: Any, levels: int | None, resolution: int | None, options: Any) -> Lattice:
    """The lattice of level 0; with a resolution alone the library chooses it and sets the options' levels."""
    if isinstance(base, Lattice):
        return base
    if resolution is None:
        return Lattice.fit(source, resolution=8 if base is None else base)
    finest = in_range("resolution", resolution, 1, 1 << 25)
    if levels is not None:
        return Lattice.fit(source, resolution=-(-finest // 2**levels))
    chosen = ffi.new("bvx_lattice *")
    run.check(lib.bvx_refine_choose(run.context, source._view(run), finest, options, chosen))
    return Lattice._of(chosen)


def refine(
    mesh: Any,
    *,
    base: Any = None,
    levels: int | None = None,
    resolution: int | None = None,
    window: WindowLike = None,
    outer_levels: int | None = None,
    adaptive: float = 0.0,
    start_level: int = -1,
    threads: int | None = None,
    memory_limit: int | None = None,
    progress: Progress = None,
) -> Octree:
    """Voxelize a mesh with small voxels only at its surface.

    Parameters
    ----------
    mesh
        what `Mesh.of` takes.
    base
        voxels along the longest axis before any is halved, or the `Lattice` of level 0. Default 8.
    levels
        how many times voxels that triangles touch are halved. Default 6; with ``resolution``: until the base has at most 256
        voxels a side.
    resolution
        voxels of the last level along the longest axis, at least, in place of ``base``.
    window
        voxels of the last level; beyond it voxels are halved ``outer_levels`` times only (default 0).
    adaptive
        a voxel whose triangles lie within this distance of one plane is not halved; 0: all are [world].
    start_level
        levels up to this one come from one grid; -1 chooses. Shows in time and memory only.

    Returns
    -------
    Octree
        An `Octree`. Expanded at its last level it has the bits of ``voxelize(mode="conservative")`` there and of what a flood
        from outside does not reach.

    Raises
    ------
    ArgumentError
        options that contradict each other.
    EmptyError
        no triangles.
    RangeError, MemoryLimitError

    Examples
    --------
    >>> bitvox.refine('knot.ply', base=8, levels=2).expand().shape[0]
    32
    """
    if resolution is not None and base is not None:
        raise ArgumentError("resolution and base contradict each other; give one of them")
    options = options_of("refine_options")
    options.levels = 0 if levels is None else or_none(in_range("levels", levels, 0, 25))
    options.start_level = 0 if in_range("start_level", start_level, -1, 25) < 0 else or_none(start_level)
    options.tolerance = float(adaptive)
    set_window("window", options.window, window)
    if outer_levels is not None:
        if window is None:
            raise ArgumentError("outer_levels is taken together with window")
        options.outer_levels = in_range("outer_levels", outer_levels, 0, 25)
    source = Mesh.of(mesh)
    out = ffi.new("bvx_octree **")
    chosen = resolution is not None and levels is None and not isinstance(base, Lattice)
    with Run(threads, memory_limit, progress, calls=1 + chosen) as run:
        lattice = _base_of(run, source, base, levels, resolution, options)
        run.check(lib.bvx_refine(run.context, source._view(run), lattice._c, options, out))
    return Octree(ffi.gc(out[0], lib.bvxpy_free_octree))
