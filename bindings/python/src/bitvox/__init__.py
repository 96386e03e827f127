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

import importlib as _importlib
import typing as _typing

from . import _foreign as _foreign  # these two enter their calls into the table
from . import _inputs as _inputs
from ._errors import (
    ArgumentError as ArgumentError, Cancelled as Cancelled, CapacityError as CapacityError, EmptyError as EmptyError, Error as Error,
    FormatError as FormatError, LatticeError as LatticeError, MemoryLimitError as MemoryLimitError, MissingExtraError as MissingExtraError,
    OptionRangeError as OptionRangeError, OutOfMemoryError as OutOfMemoryError, RangeError as RangeError, ResultWarning as ResultWarning,
    UnsupportedError as UnsupportedError, VersionError as VersionError,
)
from ._field import Field as Field, field as field
from ._files import Writer as Writer, dumps as dumps, loads as loads, read as read, read_labels as read_labels, write as write, write_labels as write_labels, write_levels as write_levels
from ._grid import Attached as Attached, Grid as Grid
from ._image import Image as Image, render as render
from ._labels import Complex as Complex, Segment as Segment, Surfaces as Surfaces, read_segments as read_segments
from ._lattice import Lattice as Lattice, Window as Window
from ._levels import Levels as Levels, hull as hull, lod as lod, simplify as simplify
from ._mesh import Mesh as Mesh
from ._octree import Octree as Octree, refine as refine
from ._options import (
    BooleanOptions as BooleanOptions, FieldOptions as FieldOptions, HullOptions as HullOptions, LodOptions as LodOptions, RenderOptions as RenderOptions,
    RepairOptions as RepairOptions, SectionsOptions as SectionsOptions, SimplifyOptions as SimplifyOptions,
    SurfaceOptions as SurfaceOptions, VoxelizeOptions as VoxelizeOptions,
)
from ._points import read_points as read_points, voxelize_points as voxelize_points
from ._run import settings as settings
from ._run import version as _version
from ._sections import Loop as Loop, Sections as Sections, from_sections as from_sections, slice_mesh as slice_mesh
from ._stages import (
    Closest as Closest, boolean as boolean, carry as carry, check as check, compare as compare, content_hash as content_hash, faces as faces,
    find_pockets as find_pockets, find_seed as find_seed, Inspection as Inspection, inspect as inspect, label_voxels as label_voxels, merge as merge, Rays as Rays, repair as repair, surface as surface, surface_counts as surface_counts,
    voxelize as voxelize,
)
from ._trimesh import register_with_trimesh as register_with_trimesh
from ._trimesh import register_with_its_import as _register_with_its_import
from ._volume import Volume as Volume, read_volume as read_volume

if _typing.TYPE_CHECKING:
    from . import big as big, formats as formats, reports as reports
else:

    def __getattr__(name: str) -> _typing.Any:
        """The parts that not everybody needs are imported when they are first used."""
        if name in ("big", "formats", "reports"):
            return _importlib.import_module(f".{name}", __name__)
        raise AttributeError(f"module 'bitvox' has no attribute {name!r}")


def __dir__() -> list[str]:
    own = (name for name, value in globals().items() if name[0] != "_" and not isinstance(value, type(_typing)))
    return sorted({*own, "__version__", "big", "formats", "reports"})


__version__ = _version()
_register_with_its_import()

# `help(bitvox)` is one line a name: without __all__, pydoc does not print the pages of all classes behind it.
__doc__ = f"{__doc__}\nAll names, each with a page of its own, as `help(bitvox.voxelize)`; `help(bitvox.RepairOptions)` lists options that are given by name as\nall others:\n\n" + "".join(
    f"    {name:20} {(thing.__doc__ or '').partition(chr(10))[0]}\n" for name, thing in sorted(globals().items()) if name[0] != "_")
