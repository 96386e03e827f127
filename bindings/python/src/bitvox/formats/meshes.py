"""Meshes written by libraries that know a format: 3MF by trimesh, VTK's .vtp by PyVista."""

from __future__ import annotations

import os
import tempfile
from typing import Any

from .. import _arrays as arrays
from .._errors import need
from .._mesh import Mesh


def mesh_bytes(mesh: Mesh, kind: str) -> bytes:
    """The bytes of a file that holds a ``mesh``: ``kind`` is 3mf or vtp."""
    if kind == "3mf":
        need("trimesh", "formats"), need("networkx", "formats"), need("lxml", "formats")
        made: Any = mesh.to_trimesh().export(file_type="3mf")
        return bytes(made)
    data = mesh.to_pyvista()
    points = arrays.numpy("vtp").asarray(mesh.in_world())
    if points.dtype == "float64":
        data.points = points
    with tempfile.TemporaryDirectory() as folder:  # VTK writes to names alone
        path = os.path.join(folder, "mesh.vtp")
        data.save(path)
        with open(path, "rb") as file:
            return file.read()
