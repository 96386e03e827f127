"""bitvox as a voxelizer of trimesh: ``mesh.voxelized(pitch, method="bitvox")``."""

from __future__ import annotations

import importlib.machinery
import sys
from typing import Any

from . import _arrays as arrays
from ._errors import need
from ._lattice import Lattice
from ._stages import voxelize


def voxelized(mesh: Any, pitch: float, **options: Any) -> Any:
    """A trimesh VoxelGrid of a mesh, on trimesh's own places: centers at whole multiples of the pitch.

    Parameters
    ----------
    mesh
        a trimesh.Trimesh.
    pitch
        edge of a voxel [world].
    options
        those of `bitvox.voxelize` about rules, such as ``mode="conservative"`` or ``fill="vote"``; the default is the solid.
    """
    np = arrays.numpy("trimesh")
    base, transformations = need("trimesh.voxel.base", "formats"), need("trimesh.transformations", "formats")
    low, high = (np.floor(np.asarray(corner) / pitch + 0.5) for corner in mesh.bounds)
    lattice = Lattice((high - low + 1).astype(int).tolist(), pitch, ((low - 0.5) * pitch).tolist())
    grid = voxelize(mesh, lattice=lattice, **options)
    return base.VoxelGrid(grid.to_numpy(), transform=transformations.scale_and_translate(scale=pitch, translate=low * pitch))


def register_with_trimesh() -> None:
    """Put it into trimesh's table of voxelizers under the name "bitvox", as often as one likes.

    `import bitvox` does it too, whether trimesh is imported before or after.

    Examples
    --------
    >>> import trimesh
    >>> bitvox.register_with_trimesh()
    >>> int(trimesh.creation.box().voxelized(0.25, method='bitvox').filled_count)
    64
    """
    table = need("trimesh.voxel.creation", "formats").voxelizers
    if "bitvox" not in table:  # trimesh's table takes a name once
        table["bitvox"] = voxelized


class _WhenImported:
    """Watches for one import of trimesh's voxelizers and registers after it; everything else is left to the other finders."""

    name = "trimesh.voxel.creation"

    def find_spec(self, fullname: str, path: Any = None, target: Any = None) -> Any:
        if fullname != self.name:
            return None
        if self in sys.meta_path:
            sys.meta_path.remove(self)
        spec = importlib.machinery.PathFinder.find_spec(fullname, path)
        if spec is not None and spec.loader is not None:
            self.loader: Any = spec.loader
            spec.loader = self  # type: ignore[assignment]
        return spec

    def create_module(self, spec: Any) -> Any:
        return self.loader.create_module(spec)

    def exec_module(self, module: Any) -> None:
        module.__spec__.loader = module.__loader__ = self.loader
        self.loader.exec_module(module)
        table = getattr(module, "voxelizers", None)
        if table is not None and "bitvox" not in table:
            table["bitvox"] = voxelized


def register_with_its_import() -> None:
    """`register_with_trimesh`, now when trimesh's voxelizers are there, else when they are imported."""
    if _WhenImported.name in sys.modules:
        try:
            register_with_trimesh()
        except Exception:  # trimesh without its own optional parts, or half imported: it works without us
            pass
    elif not any(isinstance(finder, _WhenImported) for finder in sys.meta_path):
        sys.meta_path.insert(0, _WhenImported())  # type: ignore[arg-type]
