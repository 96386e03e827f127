"""Stacks of slice images through Pillow."""

from __future__ import annotations

import glob
import os
import re
from typing import Any, Sequence

from .. import _arrays as arrays
from .._errors import ArgumentError, EmptyError, FormatError, need
from .._grid import Grid
from ._values import choose


def read_images(source: Any, *, threshold: Any = None, labels: Any = None, spacing: Any = 1.0,
                corner: Sequence[float] = (0.0, 0.0, 0.0), flip_y: bool = True) -> Grid:
    """A grid from pictures of its slices, the first one lowest in z.

    Parameters
    ----------
    source
        file names in order, a pattern such as ``"scan_*.png"`` (sorted by the numbers in the names), or one file of
        several pages (TIFF).
    threshold, labels
        which values are set; without either, all other than 0. Color pictures count by their brightness.
    spacing, corner
        of the lattice [world].
    flip_y
        pictures have their top row first, which is the highest y.

    Examples
    --------
    >>> names = bitvox.formats.write_images(bitvox.Grid.from_numpy(np.ones((4, 5, 6))), 't_%02d.png')
    >>> bitvox.formats.read_images('t_*.png').shape
    (4, 5, 6)
    """
    np = arrays.numpy("pictures")
    library = need("PIL.Image", "formats", "Pillow")
    sequence = need("PIL.ImageSequence", "formats", "Pillow")
    if isinstance(source, (str, os.PathLike)):
        paths = sorted(glob.glob(os.fspath(source)), key=_by_numbers) if glob.has_magic(os.fspath(source)) else [os.fspath(source)]
    else:
        paths = [os.fspath(path) for path in source]
    layers = []
    for path in paths:
        with library.open(path) as picture:
            for page in sequence.Iterator(picture):
                plain = page if page.mode in ("1", "L", "P", "I", "F", "I;16", "I;16L", "I;16B") else page.convert("L")
                layers.append(choose(np.asarray(plain), threshold, labels))
                if layers[-1].shape != layers[0].shape:
                    raise FormatError(f"{path}: {plain.size[0]} x {plain.size[1]} pixels where the first has {layers[0].shape[1]} x {layers[0].shape[0]}")
    if not layers:
        raise EmptyError(f"no picture is named {source}")
    zyx = np.stack(layers)
    return Grid.from_numpy(zyx[:, ::-1] if flip_y else zyx, order="zyx", spacing=spacing, corner=corner)


def _by_numbers(path: str) -> list[Any]:
    return [(0, int(part), "") if part.isdigit() else (1, 0, part) for part in re.split(r"(\d+)", path) if part]


def write_images(grid: Grid, pattern: str | os.PathLike[str], *, flip_y: bool = True) -> list[str]:
    """Write a grid as pictures of its slices, white where set.

    Parameters
    ----------
    pattern
        a name with ``%d`` (or ``%04d``) for the slice's number, or one that ends in .tif for one file of all slices.
    flip_y
        as for `read_images`.

    Returns
    -------
    list[str]
        The names of the files.

    Examples
    --------
    >>> len(bitvox.formats.write_images(bitvox.voxelize('knot.ply', resolution=8), 's_%02d.png')) >= 1
    True
    """
    np = arrays.numpy("pictures")
    library = need("PIL.Image", "formats", "Pillow")
    name = os.fspath(pattern)
    zyx = grid.to_numpy("zyx")
    pages = [library.fromarray((z[::-1] if flip_y else z).astype(np.uint8) * 255) for z in zyx]
    if "%" in name:
        names = [name % i for i in range(len(pages))]
        if len(set(names)) < len(names):
            raise ArgumentError(f"{name}: %d must stand for the slice's number")
        for page, one in zip(pages, names):
            page.save(one)
        return names
    if not name.lower().endswith((".tif", ".tiff")):
        raise ArgumentError(f"{name}: give a name with %d, or one that ends in .tif")
    pages[0].save(name, save_all=True, append_images=pages[1:], compression="tiff_deflate")
    return [name]
