"""bitvox as a voxelizer of trimesh: ``mesh.voxelized(pitch, method="bitvox")``."""

from __future__ import annotations

import sys
from typing import Any

from . import _arrays as arrays


def voxelized(mesh: Any, pitch: float, **options: Any) -> Any:
    """A trimesh VoxelGrid of a mesh, on trimesh's own places: centres at whole multiples of the pitch.

    Args:
        mesh: a trimesh.Trimesh. pitch: edge of a voxel [world].
        options: those of `bitvox.voxelize` about rules, such as ``mode="conservative"`` or ``fill="vote"``; the default is the solid.
    """
    from ._errors import need
    from ._lattice import Lattice
    from ._stages import voxelize

    np = arrays.numpy("trimesh")
    base, transformations = need("trimesh.voxel.base", "formats"), need("trimesh.transformations", "formats")
    low, high = (np.floor(np.asarray(corner) / pitch + 0.5) for corner in mesh.bounds)
    lattice = Lattice((high - low + 1).astype(int).tolist(), pitch, ((low - 0.5) * pitch).tolist())
    grid = voxelize(mesh, lattice=lattice, **options)
    return base.VoxelGrid(grid.to_numpy(), transform=transformations.scale_and_translate(scale=pitch, translate=low * pitch))


def register() -> None:
    """Put it into trimesh's table of voxelizers under the name "bitvox"; importing bitvox after trimesh does so itself."""
    from ._errors import need

    need("trimesh.voxel.creation", "formats").voxelizers["bitvox"] = voxelized


def register_if_there() -> None:
    """`register`, when trimesh was imported before and has what it takes."""
    if "trimesh" in sys.modules:
        try:
            register()
        except Exception:  # trimesh without its own optional parts, or half imported: it works without us
            pass
