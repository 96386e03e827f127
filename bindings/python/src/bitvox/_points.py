"""Clouds of points."""

from __future__ import annotations

import os
import warnings
from typing import Any, Sequence

from . import _arrays as arrays
from ._bytes import format_of, read_bytes
from ._calls import call, entered
from ._errors import ArgumentError, UnsupportedError, range_error
from ._grid import Grid, new_grid
from ._lattice import Lattice, WindowLike, set_window
from ._mesh import Mesh, new_mesh
from ._records import record
from ._run import Progress, Run, ffi, formats_in, function, in_range, lib, number_of, options_of

POINT_FORMATS = formats_in(lib.BVX_POINTS_READ)
CLOUD_FORMATS = ("pcd", "las", "laz", "e57")  # by libraries


def read_points(path: str | os.PathLike[str], *, format: str | None = None, threads: int | None = None, memory_limit: int | None = None,
                progress: Progress = None) -> Any:
    """The points of a file as an array (n, 3), float32 or float64.

    Parameters
    ----------
    path
        .xyz (text, x y z and further columns) or .ply (its vertices), each also as .gz; with ``bitvox[points]`` .pcd, .las, .laz and .e57.
    format
        one of these endings, in place of the name's own.

    Raises
    ------
    FormatError
        what is wrong with which byte or line.
    EmptyError
        no point.

    Examples
    --------
    >>> bitvox.read_points('knot.ply').shape[1]
    3
    """
    kind = format_of(os.fspath(path), format)
    if kind in CLOUD_FORMATS:
        return call("read_cloud", os.fspath(path), kind)
    if kind not in POINT_FORMATS:
        raise UnsupportedError(f"format {kind!r} is not read as points; take one of {', '.join((*POINT_FORMATS, *CLOUD_FORMATS))}")
    held = ffi.from_buffer(read_bytes(path))
    out = new_mesh()
    with Run(threads, memory_limit, progress) as run:
        run.check(function("bvx_read_points")(run.context, held, len(held), number_of(kind), out))
    dtype = "float32" if out.position_type == lib.BVX_F32 else "float64"
    return arrays.array_at(out.positions, dtype, (out.vertex_count, 3), out, writable=True)


def points_of(source: Any) -> Any:
    """An array of points from what a user has."""
    if isinstance(source, (str, os.PathLike)):
        return read_points(source)
    if isinstance(source, Mesh):
        return source.in_world() if any(source.frame) else source.vertices
    for name in ("points", "vertices"):  # PyVista and Open3D; trimesh
        if hasattr(source, name) and not hasattr(source, "__array__"):
            return arrays.numpy("points").asarray(getattr(source, name))
    return source


@entered
def points_view(source: Any, run: Run) -> Any:
    """A bvx_mesh_view of points alone; run keeps what it points at."""
    view = ffi.new("bvx_mesh_view *")
    found = arrays.vertices_in(points_of(source), "points")
    np = arrays.numpy_or_none()
    if np is not None and found.size and not np.isfinite(found.sum()):  # the library would speak of a vertex
        for i, axis in np.argwhere(~np.isfinite(found))[:1].tolist():
            raise range_error(f"points[{i}, {axis}] is {found[i, axis]}, which is not finite", i)
    held = arrays.borrow_vertices(found)
    run.keep(held.keep)
    view.positions, view.vertex_count, view.position_type, view.position_stride = held.pointer, held.count, held.kind, held.stride
    return view


def voxelize_points(
    points: Any,
    *,
    resolution: int | Sequence[int] | None = None,
    spacing: Any = None,
    corner: Sequence[float] | None = None,
    padding: int = 0,
    lattice: Lattice | None = None,
    window: WindowLike = None,
    minimum: int = 1,
    body: bool = False,
    close_gaps: int | None = None,
    threads: int | None = None,
    memory_limit: int | None = None,
    progress: Progress = None,
) -> Grid:
    """The voxels that hold points of a cloud, or the body behind them.

    Parameters
    ----------
    points
        (n, 3) numbers, a file's name (that `read_points` takes), a `Mesh` (its vertices), or what has ``points`` or ``vertices``.
    resolution, spacing, corner, padding
        of a lattice around the cloud, as for `voxelize`.
    lattice
        one in place of all these.
    window
        only this box of the lattice.
    minimum
        points that a voxel needs to be set.
    body
        set what a flood from outside cannot reach too.
    close_gaps
        with ``body``: gaps of up to this many voxels stop the flood, which moves as a cube of one voxel more a side.

    Returns
    -------
    Grid
        A `Grid`; ``grid.report`` is a `bitvox.reports.PointsReport`, whose ``pockets`` are 0 when gaps let the flood in everywhere.

    Raises
    ------
    EmptyError
        no points.
    RangeError
        a point that is not finite, with its index.

    Examples
    --------
    >>> bitvox.voxelize_points([[0, 0, 0], [1, 1, 1]], resolution=4).count
    2
    """
    held = points_of(points)
    if lattice is None:
        lattice = Lattice.fit_points(held, resolution=resolution, spacing=spacing, padding=padding, corner=corner)
    else:
        for name, value in {"resolution": resolution, "spacing": spacing, "padding": padding or None, "corner": corner}.items():
            if value is not None:
                raise ArgumentError(f"{name} and lattice contradict each other; give one of them")
    options = options_of("points_options")
    options.minimum = in_range("minimum", minimum, 1, 2**31 - 1)
    options.body = int(bool(body))
    if close_gaps is not None:
        if not body:
            raise ArgumentError("close_gaps is taken together with body")
        options.close_gaps = in_range("close_gaps", close_gaps, 0, 65535)
    set_window("window", options.window, window)
    report = ffi.new("bvx_points_report *")
    options.report = report
    made = new_grid()
    with Run(threads, memory_limit, progress) as run:
        run.check(function("bvx_voxelize_points")(run.context, points_view(held, run), lattice._c, options, made))
    found = record(report)
    if body and found.pockets == 0:
        wider = max(1, 2 * options.close_gaps)
        warnings.warn(f"no body: the flood reaches everything around the points; try close_gaps={wider} with padding={wider}, or a lower resolution",
                      stacklevel=2)
    return Grid._made(made, found)
