"""Volumes in Zarr, version 3, with OME-Zarr metadata."""

from __future__ import annotations

import os
import shutil
import uuid
from typing import Any, Sequence

from .._errors import ArgumentError, FormatError, need
from .._grid import Grid
from .._lattice import Lattice, Window, _lattice_from
from .._run import in_range
from .chunks import Chunks, Index, join
from .disk import PART
from .volume import Volume


def path_of(path: str | os.PathLike[str]) -> str:
    name = os.fspath(path)
    return name if "://" in name else os.path.abspath(name)


def to_zarr(volume: Volume, path: str | os.PathLike[str], *, inner: int = 64, unit: str | None = None, overwrite: bool = False,
            compute: bool = True) -> Any:
    """Write a volume as OME-Zarr 0.5: uint8 0 and 1, axes z, y, x, one shard a chunk of the volume and a task.

    A task writes one whole shard, so one that is tried again does no harm.

    Parameters
    ----------
    path
        a folder or a URL that all workers reach.
    inner
        voxels of the pieces that can be read alone, along each axis; where several chunks lie along an axis, their side must be a
        multiple of it.
    unit
        of the world, such as "millimeter" (OME-Zarr's names).
    overwrite
        replace what is there; on disks it stays until the new one is whole, so that it may be what the volume is read from.
    compute
        False returns the delayed tasks.

    Examples
    --------
    >>> bitvox.big.to_zarr(bitvox.big.voxelize('knot.ply', resolution=32, chunks=16), 'knot.zarr', inner=16)
    >>> bitvox.big.from_zarr('knot.zarr').shape[0]
    31
    """
    dask, zarr = need("dask", "big"), need("zarr", "big")
    cut, name = volume.chunks, path_of(path)
    pieces = tuple(min(inner, n) for n in cut.size[::-1])
    shards = tuple(-(-n // m) * m for n, m in zip(cut.size[::-1], pieces))  # what reaches beyond the volume is not stored
    if any(n != m and n < whole for n, m, whole in zip(cut.size[::-1], shards, volume.shape[::-1])):
        raise ArgumentError(f"chunks of {cut.size} are not multiples of inner={inner}; give other chunks or another inner")
    if not os.fspath(path):
        raise ArgumentError("path is empty; it must name a folder or a URL")
    local = overwrite and compute and "://" not in name and os.path.isdir(name)
    target = f"{name}.{uuid.uuid4().hex}{PART}" if local else name
    try:
        group = zarr.open_group(target, mode="w" if overwrite else "w-", zarr_format=3)
    except FileExistsError as why:
        raise FileExistsError(f"{name} exists and is not empty; overwrite=True replaces it") from why
    group.create_array("0", shape=volume.shape[::-1], chunks=pieces, shards=shards, dtype="uint8", fill_value=0,
                       compressors=zarr.codecs.ZstdCodec(level=3), dimension_names=("z", "y", "x"))
    write = dask.delayed(_write, pure=False)  # what is on the disk may have changed since
    tasks = [write(target, cut, index, block) for index, block in volume.blocks.items()]
    try:
        if compute:
            dask.compute(*tasks)
        group.attrs.update(_metadata(volume, unit, os.path.basename(name.rstrip("/"))))  # last: without it the group is not read
        if local:
            shutil.rmtree(name)
            os.replace(target, name)
    finally:
        if local:
            shutil.rmtree(target, ignore_errors=True)
    return None if compute else tasks


def _metadata(volume: Volume, unit: str | None, name: str) -> dict[str, Any]:
    axes: list[dict[str, str]] = [{"name": a, "type": "space"} for a in "zyx"]
    for axis in axes if unit else ():
        axis["unit"] = str(unit)
    lattice, center = volume.lattice, volume.center0
    places = [{"type": "scale", "scale": list(lattice.spacing[::-1])}, {"type": "translation", "translation": list(center[::-1])}]
    return {
        "ome": {"version": "0.5", "multiscales": [{"name": name, "axes": axes, "datasets": [{"path": "0", "coordinateTransformations": places}]}]},
        "bitvox": {"shape": list(lattice.shape), "spacing": list(lattice.spacing), "corner": list(lattice.corner),
                   "fraction_bits": lattice.fraction_bits, "box": volume.box},
    }


def _slices(cut: Chunks, index: Index) -> tuple[slice, ...]:
    """Where a chunk lies in an array [z, y, x]."""
    low, size = cut.window(index)
    return tuple(slice(a - b, a - b + n) for a, b, n in zip(low[::-1], cut.box.low[::-1], size[::-1]))


def _write(name: str, cut: Chunks, index: Index, grid: Grid) -> None:
    zarr = need("zarr", "big")
    if not grid.count:
        return  # zeros are not stored
    array = zarr.open_array(name, path="0", mode="r+", zarr_format=3)
    array[_slices(cut, index)] = grid.to_numpy("zyx").view("uint8")


def from_zarr(path: str | os.PathLike[str], *, dataset: str | None = None, channel: int | Sequence[int] | None = None,
              chunks: int | Sequence[int] | None = None, threshold: float | None = None) -> Volume:
    """A volume from OME-Zarr (0.4 and 0.5) or a plain Zarr array [z, y, x].

    Parameters
    ----------
    path
        a folder or a URL that all workers reach.
    dataset
        of the group; None: the first, which is the finest.
    channel
        index along the axes before z, such as time and channel: one number for the last of them, or one for each. Needed where there
        are several.
    chunks
        of the volume; None: the shards, or where there are none pieces of about 256.
    threshold
        values above it are set; None: all other than 0.

    Returns
    -------
    Volume
        A `Volume` on the lattice that was written, or on the one that scale and translation give.

    Examples
    --------
    >>> import zarr
    >>> array = zarr.open_array('z.zarr', mode='w', shape=(4, 5, 6), chunks=(2, 5, 6), dtype='uint8', fill_value=1)
    >>> bitvox.big.from_zarr('z.zarr').count()
    120
    """
    array, lattice, lead, place, box = array_of(path, dataset, channel)
    if chunks is None:
        pieces = array.shards or tuple(max(n, n * max(1, 256 // n)) for n in array.chunks)
        chunks = tuple(pieces[len(lead):][::-1])
    cut = Chunks(lattice, chunks, box)
    state = state_of(path)
    read = need("dask", "big").delayed(_read, pure=True)
    return Volume(cut, {index: read(path_of(path), place, lead, threshold, cut, index, state) for index in cut})


def state_of(path: str | os.PathLike[str]) -> str:
    """A name of what is stored now: another one once a file has changed."""
    system, root = need("fsspec.core", "big").url_to_fs(path_of(path))
    name: str = need("dask.base", "big").tokenize([(one, str(known)) for one, known in sorted(system.find(root, detail=True).items())])
    return name


def array_of(path: str | os.PathLike[str], dataset: str | None, channel: int | Sequence[int] | None) -> tuple[Any, Lattice, tuple[int, ...], str, Window]:
    """A stored array, the lattice of its last three axes z, y, x, the index along those before, its path in the group, and its window
    of the lattice."""
    zarr, name = need("zarr", "big"), path_of(path)
    try:
        found = zarr.open(name, mode="r")
    except FileNotFoundError as why:  # zarr's own errors of what is not there are such ones too
        if "://" not in name and os.path.isdir(name):
            raise FormatError(f"{name} is a folder without an array or group of Zarr") from why
        raise
    attributes, place = dict(found.attrs), ""
    if hasattr(found, "array_keys"):
        place, lattice_parts = _dataset(attributes, dataset, found, name)
        array = found[place]
    else:
        array, lattice_parts = found, None
    count = array.ndim - 3
    if count < 0:
        raise FormatError(f"{name}: shape {array.shape} is not a single volume [z, y, x]")
    lead = _index(array.shape[:count], channel, name)
    shape = tuple(array.shape[count:][::-1])
    own, box = attributes.get("bitvox"), Window((0, 0, 0), shape)
    if own is not None and tuple(own.get("box", (0, own["shape"]))[1]) == shape:
        box = Window(*map(tuple, own.get("box", box)))
        return array, _lattice_from(tuple(own["shape"]), tuple(own["spacing"]), tuple(own["corner"]), int(own["fraction_bits"])), lead, place, box
    if lattice_parts is None:
        return array, Lattice(shape), lead, place, box
    scale, center = ([float(x) for x in part[count:][::-1]] for part in lattice_parts)
    return array, Lattice(shape, scale, [c - 0.5 * s for c, s in zip(center, scale)]), lead, place, box


def _index(sides: Sequence[int], channel: int | Sequence[int] | None, name: str) -> tuple[int, ...]:
    """Which of the volumes along axes before z."""
    given = [] if channel is None else [channel] if not hasattr(channel, "__len__") else list(channel)  # type: ignore[arg-type]
    made = [0] * (len(sides) - len(given)) + [in_range("channel", n, 0, 2**31) for n in given]
    if len(given) > len(sides) or any(n >= m for n, m in zip(made, sides)):
        raise ArgumentError(f"{name}: channel is {channel}; the axes before z have the sizes {tuple(sides)}")
    if any(m != 1 for m in sides[: len(sides) - len(given)]):
        raise FormatError(f"{name}: the axes before z have the sizes {tuple(sides)}; give channel=")
    return tuple(made)


def _dataset(attributes: dict[str, Any], dataset: str | None, group: Any, name: str) -> tuple[str, Any]:
    """Path of a dataset, and its scale and translation."""
    multiscales = attributes.get("ome", attributes).get("multiscales")
    if not multiscales:
        if dataset is None:
            raise FormatError(f"{name} is a group without OME-Zarr metadata; give dataset= one of {', '.join(group.array_keys())}")
        return dataset, None
    entries = multiscales[0]["datasets"]
    chosen = next((e for e in entries if dataset in (None, e["path"])), None)
    if chosen is None:
        raise FormatError(f"{name} has no dataset {dataset!r}; there are: {', '.join(e['path'] for e in entries)}")
    axes = [a["name"] if isinstance(a, dict) else a for a in multiscales[0].get("axes", [])]
    if axes and axes[-3:] != ["z", "y", "x"]:
        raise FormatError(f"{name}: axes are {axes}; the last three must be z, y, x")
    scale, shift = [1.0] * max(3, len(axes)), [0.0] * max(3, len(axes))
    for change in chosen.get("coordinateTransformations", []) + multiscales[0].get("coordinateTransformations", []):
        by = change.get("scale")
        scale = [s * b for s, b in zip(scale, by)] if by else scale
        shift = [s * b for s, b in zip(shift, by)] if by else shift
        by = change.get("translation")
        shift = [s + b for s, b in zip(shift, by)] if by else shift
    return chosen["path"], (scale, shift)


SLAB = 1 << 26  # voxels that a task holds as numbers


def _read(name: str, place: str, lead: tuple[int, ...], threshold: float | None, cut: Chunks, index: Index, state: str) -> Grid:
    """A chunk, in slabs of whole layers of what is stored; ``state`` of the files is part of the task's name alone, so that what was
    computed before they changed is not taken."""
    zarr = need("zarr", "big")
    found = zarr.open(name, mode="r")
    array, window = found[place] if place else found, cut.window(index)
    (z, y, x), (low, size), layer = _slices(cut, index), window, array.chunks[len(lead)]
    step = max(1, SLAB // (size[0] * size[1] * layer)) * layer
    ends, parts = [z.start, *range((z.start // step + 1) * step, z.stop, step), z.stop], []
    for begin, end in zip(ends, ends[1:]):
        values = array[lead + (slice(begin, end), y, x)]
        parts.append(Grid.from_numpy(values if threshold is None else values > threshold, order="zyx", lattice=cut.lattice,
                                     low=(low[0], low[1], low[2] + begin - z.start)))
    return parts[0] if len(parts) == 1 else join(cut.lattice, window, parts)
