"""Files that bitvox.read passes on: AMF, and meshes that trimesh reads."""

from __future__ import annotations

import gzip
import io
import os
from typing import Any

from .._errors import EmptyError, UnsupportedError, need, reading
from .._mesh import Mesh
from .._volume import BY_LIBRARIES
from .amf import read_amf
from .dicom import is_picture, read_rtstruct
from .dxf import read_dxf
from .nifti import grid_of_nifti
from .volumes import grid_of_meta

_OTHERS = ("dae", "zae", "ctm", "xaml", "3dxml")


def _vtp(path: str) -> Mesh:
    """VTK's surface, through PyVista; faces of many corners become triangles."""
    pyvista = need("pyvista", "view")
    if not os.path.isfile(path):
        raise FileNotFoundError(path)
    made = Mesh.of(pyvista.read(path))
    if not made.n_faces:
        raise EmptyError(f"{path} has no triangles")
    return made


def read_other(path: str, kind: str) -> Any:
    """What `bitvox.read` does with a ``path`` of a ``kind`` (its ending) that the library itself does not read.

    Examples
    --------
    >>> bitvox.formats.read_other('part.dae', 'dae')  # doctest: +SKIP
    """
    if kind == "nii":
        return grid_of_nifti(path)
    if kind == "mha":
        return grid_of_meta(path)
    if kind == "dxf":
        return read_dxf(path)
    if kind == "dcm":
        if is_picture(path):
            raise UnsupportedError(f"{path}: which values are set is not said; bitvox.formats.read_dicom(folder, threshold=...) takes it, bitvox.read_volume gives the samples")
        return read_rtstruct(path)
    if kind == "amf":
        return read_amf(path)
    if kind in ("xyz", "pts", "pcd", "las", "laz", "e57"):
        raise UnsupportedError(f"{path}: holds points, not a mesh; bitvox.read_points reads it, bitvox.voxelize_points takes them")
    if kind == "vtp":
        return _vtp(path)
    if kind in BY_LIBRARIES or kind in ("nhdr", "raw"):
        raise UnsupportedError(f"{path}: .{kind} holds samples; bitvox.read_volume(path) gives a Volume, whose threshold makes a Grid")
    if kind not in _OTHERS:
        raise UnsupportedError(f"{path}: no format is known by the ending .{kind}")
    trimesh = need("trimesh", "formats")
    if not os.path.isfile(path):
        raise FileNotFoundError(path)
    with reading(path, "trimesh"):
        if path.lower().endswith(".gz"):
            with gzip.open(path) as file:
                scene = trimesh.load(io.BytesIO(file.read()), file_type=kind)
        else:
            scene = trimesh.load(path, file_type=kind)
        mesh = scene.to_mesh() if hasattr(scene, "to_mesh") else scene
    if not hasattr(mesh, "faces") or not len(mesh.faces):
        raise EmptyError(f"{path} has no triangles")
    return Mesh.of(mesh)
