"""napari's plugin: files as layers, layers as files. napari finds it by the entry point "napari.manifest"; it is not imported here."""

from __future__ import annotations

import os
from typing import Any

from . import _arrays as arrays
from ._bytes import format_of
from ._errors import Error
from ._files import GRID_FORMATS, MESH_FORMATS, read, write
from ._grid import Grid
from ._mesh import Mesh
from ._volume import BY_LIBRARIES, VOLUME_FORMATS, read_volume

_VOXELS = tuple(kind for kind in GRID_FORMATS if kind not in VOLUME_FORMATS)


def reader_of(path: Any) -> Any:
    """A function that reads ``path``, or None where bitvox does not read such files."""
    if isinstance(path, (list, tuple)):
        return None if len(path) != 1 else reader_of(path[0])
    try:
        kind = format_of(os.fspath(path), None)
    except Error:
        return None
    return layers_of if kind in (*MESH_FORMATS, *GRID_FORMATS, *VOLUME_FORMATS, *BY_LIBRARIES, "nii") else None


def layers_of(path: Any) -> list[Any]:
    """The layers of a file: an image of samples, labels of voxels, a surface of a mesh."""
    name = os.fspath(path[0] if isinstance(path, (list, tuple)) else path)
    kind = format_of(name, None)
    found = read(name) if kind in (*MESH_FORMATS, *_VOXELS) else read_volume(name)
    return [found.to_napari(os.path.basename(name))]


def write_labels(path: str, data: Any, options: dict[str, Any]) -> list[str]:
    """Labels that are not 0 as voxels in ``path``; ``data`` is [z, y, x], ``options`` tell scale and translate."""
    scale, at = options.get("scale", (1.0,) * 3)[-3:][::-1], options.get("translate", (0.0,) * 3)[-3:][::-1]
    array = arrays.numpy("napari").asarray(data)
    write(Grid.from_numpy(array, order="zyx", spacing=scale, corner=[a - 0.5 * s for a, s in zip(at, scale)]), path)
    return [path]


def write_surface(path: str, data: Any, options: dict[str, Any]) -> list[str]:
    """A surface layer as a mesh in ``path``; ``options`` tell scale and translate."""
    np = arrays.numpy("napari")
    vertices = np.asarray(data[0], float) * np.asarray(options.get("scale", 1.0)) + np.asarray(options.get("translate", 0.0))
    write(Mesh(np.ascontiguousarray(vertices[:, ::-1]), np.ascontiguousarray(np.asarray(data[1])[:, ::-1])), path)
    return [path]

