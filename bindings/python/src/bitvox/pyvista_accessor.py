"""PyVista's ``dataset.bitvox``: ``mesh.bitvox.voxelize(resolution=128)`` and the like, datasets in and out.

PyVista finds it by itself (an entry point), from 0.48 on; with an older one import this module.
"""

from __future__ import annotations

from typing import Any

import pyvista

from . import _levels, _stages
from ._field import field as measure
from ._grid import Grid
from ._octree import refine
from ._volume import Volume


class MeshAccessor:
    """What bitvox does with a PolyData."""

    def __init__(self, dataset: Any) -> None:
        self._dataset = dataset

    def voxelize(self, **options: Any) -> Any:
        """A pyvista.ImageData with the cell data "set"; options as for `bitvox.voxelize`."""
        return _stages.voxelize(self._dataset, **options).to_pyvista()

    def lod(self, **options: Any) -> list[Any]:
        """Levels of detail as PolyData; options as for `bitvox.lod`."""
        return [level.to_pyvista() for level in _levels.lod(self._dataset, **options)]

    def simplify(self, **options: Any) -> Any:
        """A PolyData of fewer triangles, or a list of them; options as for `bitvox.simplify`."""
        made = _levels.simplify(self._dataset, **options)
        return [level.to_pyvista() for level in made] if isinstance(made, list) else made.to_pyvista()

    def repair(self, **options: Any) -> Any:
        """A closed PolyData; options as for `bitvox.repair`."""
        return _stages.repair(self._dataset, **options).to_pyvista()

    def field(self, **options: Any) -> Any:
        """A pyvista.ImageData with the cell data "distance"; options as for `bitvox.field`."""
        return measure(self._dataset, **options).to_pyvista()

    def check(self, **options: Any) -> Any:
        """The certificate of `bitvox.check`."""
        return _stages.check(self._dataset, **options)

    def refine(self, **options: Any) -> Any:
        """The `bitvox.Octree` of `bitvox.refine`."""
        return refine(self._dataset, **options)


class ImageAccessor:
    """What bitvox does with an ImageData: the cells whose scalars are not 0 (or all above ``threshold``) are set."""

    def __init__(self, dataset: Any) -> None:
        self._dataset = dataset

    def grid(self, scalars: str | None = None, *, threshold: float | None = None) -> Grid:
        """A `bitvox.Grid` of cell data, or of point data: then voxels lie about the points. Directions are kept: flipped and permuted axes
        are turned, of oblique ones the nearest samples are taken."""
        volume = self.volume(scalars).aligned(method="nearest", outside=0)
        array = volume.array
        return Grid.from_numpy(array if threshold is None else array > threshold, lattice=volume.lattice)

    def volume(self, scalars: str | None = None) -> Volume:
        """A `bitvox.Volume` of point or cell data, with the image's directions; ``scalars``: which. For ``.surface(level)``."""
        return Volume.of(self._dataset, scalars=scalars)

    def surface(self, scalars: str | None = None, *, threshold: float | None = None, **options: Any) -> Any:
        """The closed surface as PolyData; options as for `bitvox.surface`."""
        return _stages.surface(self.grid(scalars, threshold=threshold), **options).to_pyvista()


if hasattr(pyvista, "register_dataset_accessor"):
    pyvista.register_dataset_accessor("bitvox", pyvista.PolyData)(MeshAccessor)
    pyvista.register_dataset_accessor("bitvox", pyvista.ImageData)(ImageAccessor)
else:
    pyvista.PolyData.bitvox = property(MeshAccessor)
    pyvista.ImageData.bitvox = property(ImageAccessor)
