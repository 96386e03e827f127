"""bitvox: shapes to bit-packed voxels and voxels to closed meshes, exactly.

    >>> import bitvox
    >>> solid = bitvox.voxelize("knot.ply", resolution=256)      # or (vertices, faces), trimesh, PyVista, Open3D, meshio
    >>> mesh = solid.surface()                                     # closed, manifold, oriented
    >>> fine, coarse = bitvox.lod("knot.ply", triangles=(20000, 2000))

Coordinates are (x, y, z), world units are those of the mesh, voxel (i, j, k) is the box from ``corner + ijk * spacing`` to
``corner + (ijk + 1) * spacing``. Results are the same bits on every machine and for any number of threads. The interpreter's
lock is free during every call. Options are keyword-only; every function takes ``threads``, ``memory_limit`` and ``progress``
where its work can be long, and `settings` sets them for all calls.
"""

import importlib
from typing import TYPE_CHECKING, Any

from . import _foreign as _foreign  # these two enter their calls into the table
from . import _inputs as _inputs
from ._errors import (
    ArgumentError,
    Cancelled,
    CapacityError,
    EmptyError,
    Error,
    FormatError,
    LatticeError,
    MemoryLimitError,
    MissingExtraError,
    OptionRangeError,
    OutOfMemoryError,
    RangeError,
    ResultWarning,
    UnsupportedError,
    VersionError,
)
from ._field import Field, field
from ._files import Writer, dumps, loads, read, write, write_levels
from ._grid import Attached, Grid
from ._image import Image, render
from ._lattice import Lattice, Window
from ._levels import Levels, lod, simplify
from ._mesh import Mesh
from ._octree import Octree, refine
from ._points import read_points, voxelize_points
from ._run import settings
from ._run import version as _version
from ._sections import Loop, Sections, from_sections, slice_mesh
from ._stages import (
    Closest,
    boolean,
    carry,
    check,
    compare,
    content_hash,
    faces,
    find_pockets,
    find_seed,
    merge,
    repair,
    surface,
    surface_counts,
    voxelize,
)
from ._trimesh import register as register_with_trimesh
from ._trimesh import register_with_its_import as _register_with_its_import
from ._volume import Volume, read_volume


if TYPE_CHECKING:
    from . import big, formats, reports
else:

    def __getattr__(name: str) -> Any:
        """The parts that not everybody needs are imported when they are first used."""
        if name in ("big", "formats", "reports"):
            return importlib.import_module(f".{name}", __name__)
        raise AttributeError(f"module 'bitvox' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted({*__all__, "__version__", "big", "formats", "reports"})


__version__ = _version()
_register_with_its_import()

__all__ = [
    "ArgumentError", "Attached", "Cancelled", "CapacityError", "Closest", "EmptyError", "Error", "Field",
    "FormatError", "Grid", "Image", "Lattice", "LatticeError", "Levels", "Loop", "MemoryLimitError", "Mesh", "MissingExtraError", "Octree",
    "OptionRangeError", "OutOfMemoryError", "RangeError", "ResultWarning", "Sections", "UnsupportedError", "VersionError", "Volume", "Window", "Writer", "boolean",
    "carry", "check", "compare", "content_hash", "dumps", "faces", "field", "find_pockets",
    "find_seed", "from_sections", "loads", "lod", "merge", "read", "read_points", "read_volume", "refine",
    "register_with_trimesh", "render", "repair", "settings", "simplify", "slice_mesh", "surface", "surface_counts", "voxelize",
    "voxelize_points", "write", "write_levels", "big", "formats", "reports",
]
