"""NIfTI through nibabel."""

from __future__ import annotations

import os
from typing import Any

from .. import _arrays as arrays
from .._errors import UnsupportedError, need, reading
from .._foreign import placed_by
from .._grid import Grid
from .._volume import Volume
from ._values import choose

GRID_MARK = b"bitvox grid: 1 is inside"  # the description in the head of a file that was written of a Grid


def read_nifti_volume(path: str | os.PathLike[str], *, index: int | None = None) -> Volume:
    """The samples of a NIfTI volume, in the file's world (millimeters, x to the right, y forward, z up: the frame "ras"), with the axes
    nearest to the world's first; what lies oblique to them keeps its ``direction``.

    Parameters
    ----------
    path
        .nii or .nii.gz.
    index
        which volume of a series of them.

    Raises
    ------
    UnsupportedError
        a series of volumes, without an index.

    Examples
    --------
    >>> bitvox.Volume(np.arange(24.0).reshape(2, 3, 4)).save('v.nii')
    >>> bitvox.formats.read_nifti_volume('v.nii').frame
    'ras'
    """
    np, nibabel = arrays.numpy("NIfTI"), need("nibabel", "medical")
    with reading(path, "nibabel"):
        image = nibabel.as_closest_canonical(nibabel.load(os.fspath(path)))
        values = np.asanyarray(image.dataobj)
    affine = np.asarray(image.affine, float)
    turn = affine[:3, :3]
    spacing = np.diag(turn).copy()
    oblique = not (np.abs(turn - np.diag(spacing)) <= 1e-6 * np.abs(spacing).max()).all() or (spacing <= 0).any()
    values = values if values.ndim < 4 or index is None else values[..., index]
    while values.ndim > 3 and values.shape[-1] == 1:
        values = values[..., 0]
    if values.ndim != 3:
        raise UnsupportedError(f"{os.fspath(path)} has shape {values.shape}; give index for one of its volumes")
    if oblique:
        return Volume(values, **placed_by(affine), frame="ras")
    return Volume(values, spacing=spacing, corner=affine[:3, 3] - 0.5 * spacing, frame="ras")


def read_nifti(path: str | os.PathLike[str], *, threshold: Any = None, labels: Any = None, index: int | None = None) -> Grid:
    """A grid from a NIfTI volume or mask.

    Parameters
    ----------
    path, index
        as for `read_nifti_volume`, which also says what is refused.
    threshold
        values above it are set; (low, high): from low to high.
    labels
        values (one or several) that are set.
        Without either, all values other than 0.

    Examples
    --------
    >>> bitvox.formats.write_nifti(bitvox.voxelize('knot.ply', resolution=16), 'm.nii.gz')
    >>> bitvox.formats.read_nifti('m.nii.gz').shape[0]
    16
    """
    volume = read_nifti_volume(path, index=index)
    if (volume.direction != np_eye()).any():
        raise UnsupportedError(f"{os.fspath(path)}: its axes are oblique to the world's; take read_nifti_volume(path).aligned().threshold(...)")
    return Grid.from_numpy(choose(volume.array, threshold, labels), lattice=volume.lattice)


def grid_of_nifti(path: str) -> Grid:
    """The grid of a file that was written of one, which the description in its head says. A mask that something else wrote, or of which
    something else made other samples, is refused: nothing in such a file says which of its values are inside."""
    np, nibabel = arrays.numpy("NIfTI"), need("nibabel", "medical")
    volume = read_nifti_volume(path)
    described = bytes(nibabel.load(path).header.get("descrip", b"")).rstrip(b"\0")
    if described != GRID_MARK or volume.array.dtype != np.uint8 or volume.array.max(initial=0) > 1:
        raise UnsupportedError(f"{path}: was not written of a Grid, so which values are inside is not said; bitvox.formats.read_nifti(path) takes all that are not "
                               "0 (a mask), with threshold= or labels= those; bitvox.read_volume(path) gives the samples")
    return read_nifti(path)


def np_eye() -> Any:
    """Directions along the world's axes."""
    return arrays.numpy("NIfTI").eye(3)


def write_nifti(grid: Grid, path: str | os.PathLike[str]) -> None:
    """Write a grid to ``path`` (.nii or .nii.gz) as a mask (uint8); its affine carries the center of the first voxel, its description that it
    is a grid: `bitvox.read` gives it back.

    The format keeps places as float32: what is read back has the same voxels on a lattice that may lie a rounding beside.

    Examples
    --------
    >>> bitvox.formats.write_nifti(bitvox.voxelize('knot.ply', resolution=16), 'w.nii.gz')
    """
    np, nibabel = arrays.numpy("NIfTI"), need("nibabel", "medical")
    affine = np.diag([*grid.spacing, 1.0])
    affine[:3, 3] = grid.center0
    image = nibabel.Nifti1Image(grid.to_numpy().view(np.uint8), affine)
    image.header.set_xyzt_units("mm")
    image.header["descrip"] = GRID_MARK
    image.set_sform(affine, 1)
    nibabel.save(image, os.fspath(path))
