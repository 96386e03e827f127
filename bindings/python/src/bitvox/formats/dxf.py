"""DXF through ezdxf."""

from __future__ import annotations

import os
from typing import Any, Sequence

from .. import _arrays as arrays
from .._errors import EmptyError, need
from .._sections import Loop, Sections


def read_dxf(path: str | os.PathLike[str], *, layers: Sequence[str] | None = None, normal: Sequence[float] = (0.0, 0.0, 1.0),
             close: bool = False, sagitta: float | None = None, tolerance: float = 1e-6) -> Sections:
    """Closed polylines of a DXF drawing as sections; labels are the layers' names.

    Args:
        path: the drawing. layers: only these; a name that is not there is an error.
        normal: of the sections' planes.
        close: join the ends of open polylines too; otherwise they are left out.
        sagitta: how far chords may lie off arcs [drawing units]. Default: a thousandth of the polyline's size.
        tolerance: how far points may lie off their plane.

    Returns:
        `Sections`, from POLYLINE, LWPOLYLINE, SPLINE, CIRCLE and ELLIPSE in model space and in the blocks that it inserts.
    """
    np, ezdxf = arrays.numpy("DXF"), need("ezdxf", "geo")
    paths = need("ezdxf.path", "geo")
    drawing = ezdxf.readfile(os.fspath(path))
    if layers is not None:
        known = {layer.dxf.name.lower() for layer in drawing.layers} | {e.dxf.layer.lower() for e in drawing.modelspace()}
        missing = [name for name in layers if name.lower() not in known]
        if missing:
            raise EmptyError(f"{os.fspath(path)} has no layer named {', '.join(missing)}")
    wanted = None if layers is None else {name.lower() for name in layers}
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
    if not loops:
        raise EmptyError(f"{os.fspath(path)} holds no closed polyline" + ("" if close else "; close=True joins the ends of open ones"))
    return Sections(loops, normal, tolerance=tolerance)


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
