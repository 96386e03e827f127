"""PyVista's ``dataset.bitvox``: ``mesh.bitvox.voxelize(resolution=128)`` and the like, datasets in and out.

PyVista finds it by itself (an entry point), from 0.48 on; with an older one import this module.
"""

from __future__ import annotations

import operator
import warnings
from typing import Any

import pyvista

from . import _arrays as arrays
from . import _files, _levels, _stages
from ._errors import ArgumentError
from ._field import field as measure
from ._grid import Grid
from ._inputs import COLOR_NAMES
from ._mesh import Mesh
from ._octree import refine
from ._run import depth_of_caller
from ._sections import Sections, slice_mesh
from ._volume import Volume
from ._words import Operation


class MeshAccessor:
    """What bitvox does with a PolyData."""

    def __init__(self, dataset: Any) -> None:
        self._dataset = dataset

    def voxelize(self, **options: Any) -> Any:
        """A pyvista.ImageData with the cell data "solid"; options as for `bitvox.voxelize`."""
        return _stages.voxelize(self._dataset, **options).to_pyvista()

    def _with_data(self, made: list[Mesh]) -> list[Any]:
        """PolyData with what the dataset has at its points: between them by the nearest triangle, integers by its nearest corner."""
        np, source = arrays.numpy("PyVista"), Mesh.of(self._dataset)
        found = [mesh.to_pyvista() for mesh in made]
        data = {name: np.asarray(values) for name, values in self._dataset.point_data.items() if values.dtype.kind in "fiub"}
        color = next((name for name in COLOR_NAMES if name in data), "colors")
        self._warn_of(self._dataset.cell_data, "cells")
        if not data or not source.n_faces:
            return found
        nearest = _stages.Closest(source)
        for mesh, one in zip(made, found):
            at = nearest.find(mesh.in_world())
            corners, weight = np.asarray(source.faces)[at["triangle"]], np.asarray(at["weight"])
            if mesh.colors is not None and color != "colors":
                one.rename_array("colors", color)
            for name, values in data.items():
                if name in one.point_data:
                    continue
                if values.dtype.kind != "f":
                    one.point_data[name] = values[corners[np.arange(len(corners)), weight.argmax(axis=1)]]
                    continue
                between = np.einsum("nk...,nk->n...", values[corners], weight)
                if name == self._dataset.point_data.active_normals_name:
                    between /= np.maximum(np.linalg.norm(between, axis=1, keepdims=True), 1e-30)
                one.point_data[name] = between.astype(values.dtype)
        return found

    @staticmethod
    def _warn_of(data: Any, where: str) -> None:
        if lost := [name for name in data if name != "Normals"]:
            warnings.warn(f"data of {where} are not kept: {', '.join(lost)}", stacklevel=depth_of_caller())

    def lod(self, **options: Any) -> list[Any]:
        """Levels of detail as PolyData with the data of the dataset's points; options as for `bitvox.lod`."""
        return self._with_data(_levels.lod(self._dataset, **options))

    def simplify(self, **options: Any) -> Any:
        """A PolyData of fewer triangles, or a list of them, with the data of the dataset's points; options as for `bitvox.simplify`."""
        made = _levels.simplify(self._dataset, **options)
        return self._with_data(made) if isinstance(made, list) else self._with_data([made])[0]

    def repair(self, **options: Any) -> Any:
        """A closed PolyData with the data of the dataset's points; options as for `bitvox.repair`."""
        return self._with_data([_stages.repair(self._dataset, **options)])[0]

    def field(self, **options: Any) -> Any:
        """A pyvista.ImageData with the point data "distance"; options as for `bitvox.field`."""
        return measure(self._dataset, **options).to_pyvista()

    def check(self, **options: Any) -> Any:
        """The certificate of `bitvox.check`."""
        return _stages.check(self._dataset, **options)

    def refine(self, **options: Any) -> Any:
        """The `bitvox.Octree` of `bitvox.refine`."""
        return refine(self._dataset, **options)

    def boolean(self, other: Any, operation: Operation, **options: Any) -> Any:
        """A closed PolyData of this mesh and ``other``, anything that `bitvox.boolean` takes; ``operation`` and options as there."""
        self._warn_of(self._dataset.array_names, "points and cells")
        return _stages.boolean(self._dataset, other, operation, **options).to_pyvista()

    def hollow(self, thickness: float, *, resolution: Any = 128, **options: Any) -> Any:
        """A closed PolyData of a wall of ``thickness`` with the data of the dataset's points: the mesh's voxels at a ``resolution``, hollow; options
        as for `bitvox.Grid.hollow`."""
        return self._with_data([_stages.voxelize(self._dataset, resolution=resolution, padding=1).hollow(thickness, **options).surface()])[0]

    def sections(self, **options: Any) -> Any:
        """PolyData of closed lines, the cell data "section" and "label" their planes and bodies; options as for `bitvox.slice_mesh`."""
        return lines_of(slice_mesh(self._dataset, **options))


def lines_of(sections: Sections) -> Any:
    """Loops as a PolyData of closed lines."""
    np = arrays.numpy("PyVista")
    made, first = pyvista.PolyData(), 0
    cells: list[int] = []
    for loop in sections.loops:
        n = len(loop.points)
        cells += [n + 1, *range(first, first + n), first]
        first += n
    if sections.loops:
        made.points = np.concatenate([loop.points for loop in sections.loops])
        made.lines = np.array(cells)
        made.cell_data["section"] = np.array(sections.section_of)
        made.cell_data["label"] = np.array([loop.label for loop in sections.loops])
    return made


class ImageAccessor:
    """What bitvox does with an ImageData: the cells whose scalars are not 0 (or all above ``threshold``) are set."""

    def __init__(self, dataset: Any) -> None:
        self._dataset = dataset

    def grid(self, scalars: str | None = None, *, threshold: float | None = None) -> Grid:
        """A `bitvox.Grid` of cell data, or of point data: then voxels lie about the points. Flipped and permuted axes are turned; an oblique
        image is refused, as by `bitvox.Volume.threshold`."""
        volume = self.volume(scalars)._without_resampling()
        array = volume.array
        return Grid.from_numpy(array if threshold is None else array > threshold, lattice=volume.lattice)

    def volume(self, scalars: str | None = None) -> Volume:
        """A `bitvox.Volume` of point or cell data, with the image's directions; ``scalars``: which. For ``.surface(level)``."""
        return Volume.of(self._dataset, scalars=scalars)

    def surface(self, scalars: str | None = None, *, level: float | None = None, threshold: float | None = None, **options: Any) -> Any:
        """The closed surface as PolyData.

        Parameters
        ----------
        scalars
            which data; None: the active ones.
        level
            of samples: the surface where they reach it, between them, without steps; options as for `bitvox.Volume.surface`.
        threshold
            of voxels: their faces' surface, of those above it, or without either of those that are not 0; options as for
            `bitvox.surface`.
        """
        if level is not None:
            if threshold is not None:
                raise ArgumentError("level and threshold contradict each other: level is for samples, threshold for voxels")
            return self.volume(scalars).surface(level, **options).to_pyvista()
        return _stages.surface(self.grid(scalars, threshold=threshold), **options).to_pyvista()

    def boolean(self, other: Any, operation: Operation, scalars: str | None = None) -> Any:
        """An ImageData of these voxels and those of ``other``: an ImageData or a `bitvox.Grid` of the same place.

        Parameters
        ----------
        operation
            "union", "intersection", "difference" or "xor".
        scalars
            which data of both images.
        """
        mine = self.grid(scalars)
        theirs = other if isinstance(other, Grid) else ImageAccessor(other).grid(scalars)
        if operation not in _GRIDS:
            raise ArgumentError(f"operation is {operation!r}; it must be one of {', '.join(_GRIDS)}")
        return _GRIDS[operation](mine, theirs).to_pyvista()

    def hollow(self, thickness: float, scalars: str | None = None, **options: Any) -> Any:
        """An ImageData of the voxels' wall of ``thickness``; options as for `bitvox.Grid.hollow`."""
        return self.grid(scalars).hollow(thickness, **options).to_pyvista()

    def components(self, scalars: str | None = None, *, connectivity: int = 6) -> Any:
        """An ImageData with the cell data "component": 0 where nothing is set, else the number of the connected part.

        Parameters
        ----------
        scalars
            which data; None: the active ones.
        connectivity
            6, 18 or 26.
        """
        grid = self.grid(scalars)
        image = grid.to_pyvista()
        image.cell_data["component"] = grid.label(connectivity=connectivity).transpose(2, 1, 0).reshape(-1)
        return image

    def sections(self, scalars: str | None = None, **options: Any) -> Any:
        """PolyData of closed lines: slices of the voxels' surface; options as for `bitvox.slice_mesh`."""
        return lines_of(slice_mesh(self.grid(scalars), **options))


_GRIDS = {"union": operator.or_, "intersection": operator.and_, "difference": operator.sub, "xor": operator.xor}


def read(path: str, **options: Any) -> Any:
    """For ``pyvista.read``: what `bitvox.read` makes of ``path`` and ``options``, as PyVista's kind of dataset."""
    found = _files.read(path, **options)
    if isinstance(found, Sections):
        return lines_of(found)
    return found.to_pyvista()


def write(dataset: Any, path: str, **options: Any) -> None:
    """For ``dataset.save``: a PolyData or an ImageData of voxels to ``path``; ``options`` as for `bitvox.write`."""
    _files.write(ImageAccessor(dataset).grid() if hasattr(dataset, "direction_matrix") else dataset, path, **options)


if hasattr(pyvista, "register_dataset_accessor"):
    pyvista.register_dataset_accessor("bitvox", pyvista.PolyData)(MeshAccessor)
    pyvista.register_dataset_accessor("bitvox", pyvista.ImageData)(ImageAccessor)
else:
    pyvista.PolyData.bitvox = property(MeshAccessor)
    pyvista.ImageData.bitvox = property(ImageAccessor)
