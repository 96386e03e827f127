"""The work as a list of picklable tasks."""

from __future__ import annotations

import functools
import os
from typing import Any, Iterable, Sequence

from .._errors import ArgumentError
from .._grid import Grid
from .._lattice import Lattice, Window
from .._mesh import Mesh
from .._stages import merge, surface, voxelize
from .chunks import Chunks, Index, in_halves, join


@functools.lru_cache(maxsize=1)
def _from_file(path: str, size: int, changed: int) -> Mesh:
    return Mesh.of(path)


def load(source: Any) -> Mesh:
    """The mesh; a file is read once in each process."""
    if isinstance(source, str):
        known = os.stat(source)
        return _from_file(source, known.st_size, known.st_mtime_ns)
    return Mesh.of(source)


class Task:
    """One piece of work: call it, on any machine, any number of times; the result is always the same.

    Attributes
    ----------
    source
        the mesh or its file.
    chunks, index
        the cut lattice, and which chunk of it.
    result
        "surface" or "grid". options, surface_options: as for `plan`.

    Examples
    --------
    >>> bitvox.big.plan('knot.ply', resolution=32, chunks=16, result='grid').tasks[0]().shape
    (16, 16, 13)
    """

    __slots__ = ("source", "chunks", "index", "result", "options", "surface_options")
    source: Any
    chunks: Chunks
    index: Index
    result: str
    options: dict[str, Any]
    surface_options: dict[str, Any]

    def __init__(self, source: Any, chunks: Chunks, index: Index, result: str, options: dict[str, Any], surface_options: dict[str, Any]) -> None:
        self.source, self.chunks, self.index, self.result = source, chunks, index, result
        self.options, self.surface_options = options, surface_options

    def __call__(self) -> Any:
        """The chunk's `Grid`, or its part of the surface as a `Mesh` with keys."""
        return self.on(load(self.source))

    def on(self, mesh: Mesh) -> Any:
        """The same, of a mesh that is already here.

        Examples
        --------
        >>> plan = bitvox.big.plan('knot.ply', resolution=32, chunks=16)
        >>> mesh = bitvox.read('knot.ply')
        >>> plan.merge([task.on(mesh) for task in plan.tasks]).check().closed
        True
        """
        if self.result == "grid":
            return voxelize_window(mesh, self.chunks.lattice, self.chunks.window(self.index), self.options)
        window, sides = self.chunks.cells(self.index)
        grid = voxelize_window(mesh, self.chunks.lattice, window, self.options)
        return surface(grid, keys=True, open_sides=sides, **{"threads": 1, **self.surface_options})

    def __getstate__(self) -> Any:
        return tuple(getattr(self, name) for name in self.__slots__)

    def __setstate__(self, state: Any) -> None:
        for name, value in zip(self.__slots__, state):
            setattr(self, name, value)

    def __repr__(self) -> str:
        return f"Task({self.result} of chunk {self.index})"


def voxelize_window(mesh: Mesh, lattice: Lattice, window: Window, options: dict[str, Any]) -> Grid:
    """A window's voxels, by one thread where the options do not say how many: the engine runs many tasks beside one another."""
    parts = in_halves(lambda part: voxelize(mesh, lattice=lattice, window=part, **{"threads": 1, **options}), window)
    return parts[0] if len(parts) == 1 else join(lattice, window, parts)


class Plan:
    """All tasks of a job, and how their results are put together.

    Attributes
    ----------
    chunks
        the cut lattice.
    tasks
        one `Task` a chunk.
    result
        "surface" or "grid".

    Examples
    --------
    >>> len(bitvox.big.plan('knot.ply', resolution=32, chunks=32).tasks) >= 1
    True
    """

    chunks: Chunks
    tasks: list[Task]
    result: str

    def __init__(self, chunks: Chunks, tasks: list[Task], result: str) -> None:
        self.chunks, self.tasks, self.result = chunks, tasks, result

    def merge(self, results: Iterable[Any]) -> Any:
        """The whole `Grid` or `Mesh` from the tasks' results, in any order: the bytes of a single run.

        Examples
        --------
        >>> plan = bitvox.big.plan('knot.ply', resolution=32, chunks=16)
        >>> plan.merge([task() for task in plan.tasks]).check().closed
        True
        """
        results = list(results)
        if len(results) != len(self.tasks):
            raise ArgumentError(f"{len(results)} results of {len(self.tasks)} tasks")
        if self.result == "grid":
            lattice = self.chunks.lattice
            return join(lattice, Window((0, 0, 0), lattice.shape), results)
        return merge(results)

    def __len__(self) -> int:
        return len(self.tasks)

    def __repr__(self) -> str:
        return f"Plan({len(self.tasks)} tasks, {self.result} of {self.chunks!r})"


_LOCAL = ("voxelize's modes of surfaces, and fill parity, nonzero, vote, below and winding")
_WINDOW_OPTIONS = ("lattice", "window", "attached", "progress")


def check_options(options: dict[str, Any]) -> None:
    """Options that mean nothing for chunks are errors before anything runs."""
    for name in _WINDOW_OPTIONS:
        if name in options:
            raise ArgumentError(f"{name} is not an option of work in chunks")
    if options.get("fill") in ("flood", "regions"):
        raise ArgumentError(f"fill {options['fill']!r} needs the whole lattice at once; chunks take {_LOCAL}")


def place_chunks(source: Any, lattice: Lattice | None, chunks: int | Sequence[int], where: dict[str, Any]) -> Chunks:
    """The lattice that was given or one fitted to the mesh, cut."""
    if lattice is None:
        lattice = Lattice.fit(load(source), **where)
    elif where:
        raise ArgumentError(f"{', '.join(where)} and lattice contradict each other; give one of them")
    return Chunks(lattice, chunks)


def split_place(options: dict[str, Any]) -> dict[str, Any]:
    """Take the options that place a lattice out of those of voxelize."""
    return {name: options.pop(name) for name in ("resolution", "spacing", "padding", "corner") if options.get(name) is not None}


def source_of(mesh: Any) -> Any:
    """A file's absolute name, or a mesh."""
    return os.path.abspath(os.fspath(mesh)) if isinstance(mesh, (str, os.PathLike)) else Mesh.of(mesh)


def plan(mesh: Any, lattice: Lattice | None = None, *, chunks: int | Sequence[int] = 512, result: str = "surface",
         surface_options: dict[str, Any] | None = None, **options: Any) -> Plan:
    """The work as plain tasks for any engine::

        plan = bitvox.big.plan("/data/dragon.ply", resolution=2048, chunks=512)
        mesh = plan.merge(pool.map(operator.call, plan.tasks))      # concurrent.futures, Ray, a batch queue ...

    Parameters
    ----------
    mesh
        a file that every worker can read, or a mesh, which then travels with each task.
    lattice, resolution, spacing, padding, corner
        where; as for `bitvox.voxelize`.
    chunks
        voxels of a chunk along each axis; multiples of 64 along x are fastest.
    result
        "surface" or "grid".
    surface_options
        face_rule, dtype and local_frame of `bitvox.surface`.
    options
        rules of `bitvox.voxelize`; not fill "flood" or "regions", which look at the whole.

    Returns
    -------
    Plan
        A `Plan`: ``plan.tasks`` are callables without arguments, ``plan.merge(results)`` makes the whole.

    Examples
    --------
    >>> plan = bitvox.big.plan('knot.ply', resolution=32, chunks=16)
    >>> plan.merge([task() for task in plan.tasks]).check().closed
    True
    """
    if result not in ("surface", "grid"):
        raise ArgumentError(f"result is {result!r}; it must be 'surface' or 'grid'")
    if surface_options and result == "grid":
        raise ArgumentError("surface_options are for result 'surface'")
    source = source_of(mesh)
    where = split_place(options)
    check_options(options)
    cut = place_chunks(source, lattice, chunks, where)
    extra = one_type(cut.lattice, dict(surface_options or {})) if result == "surface" else {}
    return Plan(cut, [Task(source, cut, index, result, options, extra) for index in cut], result)


def one_type(lattice: Lattice, options: dict[str, Any]) -> dict[str, Any]:
    """All parts need one type: the one that the surface of the whole would choose."""
    for name in ("keys", "open_sides", "progress"):
        if name in options:
            raise ArgumentError(f"{name} is not an option of work in chunks")
    if options.get("dtype") is None:
        far = tuple(n - 1 for n in lattice.shape)
        ends = [] if options.get("local_frame") else [~Grid(lattice, (low, (1, 1, 1))) for low in ((0, 0, 0), far)]
        wide = any(surface(end).vertices.itemsize == 8 for end in ends)  # the largest coordinates are at the ends
        options["dtype"] = "float64" if wide else "float32"
    return options
