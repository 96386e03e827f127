"""Meshes written by a library that knows the format: VTK's .vtp by PyVista."""

from __future__ import annotations

import os
import tempfile

from .. import _arrays as arrays
from .._mesh import Mesh


def mesh_bytes(mesh: Mesh, kind: str) -> bytes:
    """The bytes of a file that holds a ``mesh``: ``kind`` is vtp."""
    data = mesh.to_pyvista()
    points = arrays.numpy("vtp").asarray(mesh.in_world())
    if points.dtype == "float64":
        data.points = points
    with tempfile.TemporaryDirectory() as folder:  # VTK writes to names alone
        path = os.path.join(folder, "mesh.vtp")
        data.save(path)
        with open(path, "rb") as file:
            return file.read()
