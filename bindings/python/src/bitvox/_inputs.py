"""Meshes of other libraries, told by what they offer; none of these libraries is imported."""

from __future__ import annotations

import os
from typing import Any

from . import _arrays as arrays
from ._calls import call, entered
from ._errors import ArgumentError, UnsupportedError
from ._mesh import Mesh


@entered
def mesh_from(source: Any) -> Mesh:
    """See `Mesh.of`."""
    if isinstance(source, (str, os.PathLike)):
        found = call("read", source)
        if not isinstance(found, Mesh):
            raise ArgumentError(f"{os.fspath(source)} holds a grid where a mesh is wanted")
        return found
    if isinstance(source, (tuple, list)):
        if len(source) != 2:
            raise ArgumentError(f"a mesh is (vertices, faces); this has {len(source)} parts")
        return Mesh(source[0], source[1])
    for looks, take in (
        (_is_open3d_tensor, _from_open3d_tensor),
        (_is_open3d, _from_open3d),
        (_is_scene, _from_scene),
        (_is_polydata, _from_polydata),
        (_is_meshio, _from_meshio),
        (_is_trimesh, _from_trimesh),
    ):
        if looks(source):
            return take(source)
    if getattr(source, "ndim", 0) == 3 and not hasattr(source, "words"):
        return Mesh(source)
    if hasattr(source, "words") and hasattr(source, "surface"):
        raise TypeError("a Grid is not a mesh: give its surface, grid.surface() (or bitvox.faces(grid)); grids are combined by |, &, -, ^")
    if (hasattr(source, "lattice") or hasattr(source, "section_of")) and hasattr(source, "surface"):
        raise TypeError(f"{type(source).__name__} is not a mesh: give its surface()")
    if _has(source, "combine", "extract_geometry", "keys"):
        raise TypeError(f"{type(source).__name__} is several data sets, not a mesh: give one of them, or .combine().extract_surface()")
    if _has(source, "extract_surface"):
        image = _has(source, "direction_matrix")
        raise TypeError(f"{type(source).__name__} is not a mesh: give its surface, .extract_surface()" +
                        (", or its voxels, .bitvox.grid() or .bitvox.volume()" if image else ""))
    raise TypeError(
        f"{type(source).__name__} is not a mesh: give (vertices, faces), a Mesh, or a mesh of trimesh, PyVista, Open3D or meshio"
    )


def _has(source: Any, *names: str) -> bool:
    return all(hasattr(source, name) for name in names)


def _is_trimesh(source: Any) -> bool:
    return _has(source, "vertices", "faces")


def _from_trimesh(source: Any) -> Mesh:
    visual = getattr(source, "visual", None)
    kind = getattr(visual, "kind", None)
    colors = getattr(visual, "vertex_colors", None) if kind in ("vertex", "face") else None  # of faces: the mean around each vertex
    uvs = getattr(visual, "uv", None) if kind == "texture" else None
    return Mesh(_base(source.vertices), _base(source.faces), colors=None if colors is None else _base(colors),
                uvs=None if uvs is None or len(uvs) != len(source.vertices) else _base(uvs))


def _base(array: Any) -> Any:
    """A plain array where a library hands out its own kind."""
    np = arrays.numpy_or_none()
    return array.view(np.ndarray) if np is not None and isinstance(array, np.ndarray) else array


def _is_scene(source: Any) -> bool:
    return _has(source, "geometry", "graph") and (_has(source, "to_mesh") or _has(source, "dump"))


def _from_scene(source: Any) -> Mesh:
    return _from_trimesh(source.to_mesh() if hasattr(source, "to_mesh") else source.dump(concatenate=True))


def _is_polydata(source: Any) -> bool:
    return _has(source, "points", "faces", "triangulate", "n_points")


def _from_polydata(source: Any) -> Mesh:
    np = arrays.numpy("PyVista")
    plain = source.is_all_triangles
    if not (plain() if callable(plain) else plain):
        source = source.triangulate()
    faces = np.asarray(source.faces)
    if faces.size % 4 or (faces[::4] != 3).any():
        raise ArgumentError("the PolyData holds faces that triangulate() leaves")
    return Mesh(np.asarray(source.points), faces.reshape(-1, 4)[:, 1:], colors=_point_colors(source),
                uvs=getattr(source, "active_texture_coordinates", None))


COLOR_NAMES = ("colors", "RGB", "RGBA", "rgb", "rgba")


def _point_colors(source: Any) -> Any:
    """PyVista's colors: bytes by point, three or four, under a name that says so."""
    for name in COLOR_NAMES:
        if name in source.point_data:
            found = source.point_data[name]
            if found.dtype == "uint8" and found.ndim == 2 and found.shape[1] in (3, 4):
                return found
    return None


def _is_open3d_tensor(source: Any) -> bool:
    return _has(source, "vertex", "triangle") and hasattr(source.vertex, "positions")


def _from_open3d_tensor(source: Any) -> Mesh:
    colors = source.vertex.colors.cpu().numpy() if "colors" in source.vertex else None
    return Mesh(source.vertex.positions.cpu().numpy(), source.triangle.indices.cpu().numpy(), colors=colors)


def _is_open3d(source: Any) -> bool:
    return _has(source, "vertices", "triangles", "triangle_normals")


def _from_open3d(source: Any) -> Mesh:
    np = arrays.numpy("Open3D")
    colors = np.asarray(source.vertex_colors) if source.has_vertex_colors() else None
    return Mesh(np.asarray(source.vertices), np.asarray(source.triangles), colors=colors)


def _is_meshio(source: Any) -> bool:
    return _has(source, "points", "cells", "cell_data") and not _has(source, "extract_surface")  # as PyVista's grids have


def _from_meshio(source: Any) -> Mesh:
    np = arrays.numpy("meshio")
    parts = []
    for block in source.cells:
        kind, data = (block.type, np.asarray(block.data)) if hasattr(block, "type") else (block[0], np.asarray(block[1]))
        if kind in ("vertex", "line"):
            continue
        if kind not in ("triangle", "quad", "polygon") and not kind.startswith("polygon"):
            raise UnsupportedError(f"meshio cells of type {kind}: only triangles, quads and polygons make a surface")
        for i in range(1, data.shape[1] - 1):
            parts.append(np.stack((data[:, 0], data[:, i], data[:, i + 1]), axis=1))
    faces = np.concatenate(parts) if parts else np.zeros((0, 3), np.uint32)
    return Mesh(np.asarray(source.points), faces)
