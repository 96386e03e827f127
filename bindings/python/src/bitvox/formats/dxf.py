"""DXF through ezdxf."""

from __future__ import annotations

import os
from typing import Any, Sequence

from .. import _arrays as arrays
from .._errors import ArgumentError, EmptyError, need, reading
from .._sections import Loop, Sections, stacked


def read_dxf(path: Any, *, positions: Sequence[float] | None = None, layers: Sequence[str] | None = None,
             normal: Sequence[float] | None = None, close: bool = False, sagitta: float | None = None,
             tolerance: float = 1e-6) -> Sections:
    """Closed polylines of DXF drawings as sections; labels are the layers' names.

    Parameters
    ----------
    path
        a drawing, or several of them.
    positions
        one for each drawing, where each is one section drawn flat: its x and y stay, its z becomes the position.
    layers
        only these; a name that no drawing has is an error.
    normal
        of the sections' planes. Default: across z where all polylines are, else each polyline's own plane.
    close
        join the ends of open polylines too; otherwise they are left out.
    sagitta
        how far chords may lie off arcs [drawing units]. Default: a thousandth of the polyline's size.
    tolerance
        how far points may lie off their plane [drawing units].

    Returns
    -------
    Sections
        `Sections`, from POLYLINE, LWPOLYLINE, SPLINE, CIRCLE and ELLIPSE in model space and in the blocks that it inserts.

    Raises
    ------
    EmptyError
        no closed polyline, a layer that is not there.
    FormatError
        no drawing, or a damaged one.
    ArgumentError
        a polyline that does not lie in a plane, or not across ``normal``.

    Examples
    --------
    >>> bitvox.formats.read_dxf('plan.dxf', layer='walls')  # doctest: +SKIP
    """
    names = [os.fspath(path)] if isinstance(path, (str, os.PathLike)) else [os.fspath(one) for one in path]
    if positions is not None and len(positions) != len(names):
        raise ArgumentError(f"there are {len(positions)} positions for {len(names)} drawings")
    drawings = [_drawing(name) for name in names]
    if layers is not None:
        known = {layer for drawing in drawings for layer in _layers(drawing)}
        missing = [name for name in layers if name.lower() not in known]
        if missing:
            raise EmptyError(f"{', '.join(names)}: no layer is named {', '.join(missing)}")
    wanted = None if layers is None else {name.lower() for name in layers}
    loops = []
    for i, drawing in enumerate(drawings):
        found = _loops(drawing, wanted, close, sagitta, tolerance)
        if positions is not None:
            found = [_lifted(loop, float(positions[i])) for loop in found]
        loops += found
    if not loops:
        raise EmptyError(f"{', '.join(names)}: no polyline is closed" + ("" if close else "; close=True joins the ends of open ones"))
    return stacked(loops, (0.0, 0.0, 1.0), tolerance) if normal is None else Sections(loops, normal, tolerance=tolerance)


def _drawing(name: str) -> Any:
    ezdxf = need("ezdxf", "geo")
    with reading(name, "ezdxf"):
        return ezdxf.readfile(name)


def _layers(drawing: Any) -> set[str]:
    return {layer.dxf.name.lower() for layer in drawing.layers} | {e.dxf.layer.lower() for e in drawing.modelspace()}


def _lifted(loop: Loop, position: float) -> Loop:
    points = loop.points.copy()
    points[:, 2] = position
    return Loop(points, loop.label)


def _loops(drawing: Any, wanted: set[str] | None, close: bool, sagitta: float | None, tolerance: float) -> list[Loop]:
    """The closed outlines of one drawing."""
    np, paths = arrays.numpy("DXF"), need("ezdxf.path", "geo")
    loops = []
    for entity in _entities(drawing.modelspace()):
        if entity.dxftype() not in ("LWPOLYLINE", "POLYLINE", "SPLINE", "CIRCLE", "ELLIPSE") or (wanted is not None and entity.dxf.layer.lower() not in wanted):
            continue
        if entity.dxftype() == "POLYLINE" and not (entity.is_2d_polyline or entity.is_3d_polyline):
            continue  # meshes
        outline = paths.make_path(entity)
        points = np.array([tuple(p) for p in outline.flattening(sagitta or _thousandth(outline))], float)
        if len(points) > 1 and np.allclose(points[0], points[-1], rtol=0, atol=tolerance):
            points = points[:-1]
        elif not close:
            continue
        if len(points) >= 3:
            loops.append(Loop(points, str(entity.dxf.layer)))
    return loops


def _thousandth(outline: Any) -> float:
    points = list(outline.control_vertices())
    size = max((max(p[i] for p in points) - min(p[i] for p in points) for i in range(3)), default=1.0)
    return size / 1000.0 or 1e-6


def _entities(layout: Any) -> Any:
    for entity in layout:
        if entity.dxftype() == "INSERT":
            yield from entity.virtual_entities()
        else:
            yield entity
