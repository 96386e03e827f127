"""Connected parts of a volume in chunks, numbered as those of the whole."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING, Any, NamedTuple, Sequence

from .. import _arrays as arrays
from .._errors import ArgumentError, RangeError, need
from .._grid import Grid
from .._lattice import Window
from .._run import settings
from .chunks import Index

if TYPE_CHECKING:
    from .volume import Volume

_STEPS = {6: 0, 18: 1, 26: 2}  # how far neighbors across a cut may lie beside each other, in steps along its two axes


class Found(NamedTuple):
    """The parts of a volume: their records, for each chunk the whole's label of each of its own, and a voxel of each of those."""

    components: Any
    labels: dict[Index, Any]
    seeds: dict[Index, Any]


def label(volume: Volume, *, connectivity: int = 6) -> tuple[Any, int]:
    """Number the voxels of a volume by their connected part.

    Each chunk numbers its own parts on the workers, and finds which of them touch those of the next ones; here they are joined, which
    computes the chunks once. The array numbers them again when it is computed.

    Parameters
    ----------
    connectivity
        6 (across faces), 18 (and edges) or 26 (and corners).

    Returns
    -------
    tuple[Any, int]
        A Dask array of uint32 [x, y, z] with the chunks of the volume, and how many parts there are: the labels of
        ``volume.compute().label()``.

    Examples
    --------
    >>> labels, count = bitvox.big.label(bitvox.big.voxelize('knot.ply', resolution=64, chunks=32))
    >>> int(labels.max().compute()) == count
    True
    """
    da, np, cut = need("dask.array", "big"), arrays.numpy("bitvox.big"), volume.chunks
    known = found(volume, connectivity)
    number = need("dask", "big").delayed(_numbered, pure=True)

    def one(index: Index) -> Any:
        made = number(volume.blocks[index], connectivity, known.labels[index])
        return da.from_delayed(made, cut.window(index).size, np.uint32)

    nx, ny, nz = cut.counts
    return da.block([[[one((x, y, z)) for z in range(nz)] for y in range(ny)] for x in range(nx)]), len(known.components)


def found(volume: Volume, connectivity: int) -> Found:
    """The parts of a volume; computes. What comes here is a record a part of each chunk and pairs of those that touch."""
    dask, np, cut = need("dask", "big"), arrays.numpy("bitvox.big"), volume.chunks
    if connectivity not in _STEPS:
        raise ArgumentError(f"connectivity is {connectivity}; it must be 6, 18 or 26")
    look, touch = dask.delayed(_look, pure=True, nout=7), dask.delayed(_touching, pure=True)
    looks = {index: look(volume.blocks[index], connectivity) for index in cut}
    reach, across = (-1, 0, 1) if _STEPS[connectivity] else (0,), []
    for index, axis in itertools.product(cut, range(3)):
        sides = [(1,) if a == axis else reach for a in range(3)]
        near: list[Any] = [tuple(i + d for i, d in zip(index, step)) for step in itertools.product(*sides)]
        near = [i for i in near if i in looks]
        if near:
            across.append((index, near, touch(cut.window(index), axis, looks[index][1 + axis], [cut.window(i) for i in near],
                                              [looks[i][4 + axis] for i in near], _STEPS[connectivity])))
    made, pairs = dask.compute([one[0] for one in looks.values()], [pair for _, _, pair in across])
    begin = dict(zip(cut, np.cumsum([0, *map(len, made)]).tolist()))  # a chunk's label n is number begin + n - 1
    parent = np.arange(sum(map(len, made)))
    for (index, near, _), touching in zip(across, pairs):
        base = np.array([begin[i] for i in near])
        _unite(parent, np.stack([touching[:, 0] + begin[index] - 1, base[touching[:, 1]] + touching[:, 2] - 1], axis=1))

    # In voxels of the whole, and numbered in the order of their first ones.
    seeds = {i: np.stack(np.unravel_index(one["first"].astype(np.int64), cut.window(i).size, "F"), axis=1) for i, one in zip(cut, made)}
    shift = np.concatenate([np.broadcast_to(np.subtract(cut.window(i).low, volume.box.low), at.shape) for i, at in seeds.items()])
    every = np.concatenate(made)
    first = np.ravel_multi_index(tuple((np.concatenate(list(seeds.values())) + shift).T), volume.shape, order="F")
    every["first"], every["low"] = first, every["low"] + shift
    roots, number = np.unique(_roots(parent, np), return_inverse=True)
    if len(roots) >= 2**32:
        raise RangeError(f"{len(roots)} parts are more than labels of 32 bits hold")
    whole = _gathered(every.astype(made[0].dtype), number, len(roots), np)
    order = np.argsort(whole["first"])
    rank = np.empty(len(roots), np.uint32)
    rank[order] = np.arange(1, len(roots) + 1)
    labels = {i: np.concatenate([[0], rank[number[begin[i] : begin[i] + len(one)]]]).astype(np.uint32) for i, one in zip(cut, made)}
    return Found(whole[order], labels, seeds)


def _gathered(every: Any, number: Any, count: int, np: Any) -> Any:
    """The records of joined parts."""
    whole, high = np.zeros(count, every.dtype), np.zeros((count, 3), np.int32)
    whole["first"], whole["low"] = 2**64 - 1, 2**31 - 1
    np.add.at(whole["voxels"], number, every["voxels"])
    np.minimum.at(whole["first"], number, every["first"])
    np.minimum.at(whole["low"], number, every["low"])
    np.maximum.at(high, number, every["low"] + every["size"])
    whole["size"] = high - whole["low"]
    return whole


def _look(grid: Grid, connectivity: int) -> Any:
    """A chunk's parts, and the labels of its three high and its three low sides, in as few bytes as they need: many chunks of a body's
    box are empty, and their sides wait for those of the next chunks."""
    np = arrays.numpy("bitvox.big")
    with settings(threads=1):
        found = grid.components(connectivity=connectivity)
        labels = grid.label(connectivity=connectivity) if len(found) else np.broadcast_to(np.uint32(0), grid.shape)
    small = np.min_scalar_type(len(found))
    sides = [labels[(slice(None),) * axis + (end,)] for end in (-1, 0) for axis in range(3)]  # take() would copy all labels first
    return found, *(np.ascontiguousarray(side, small) if side.any() else np.broadcast_to(small.type(0), side.shape) for side in sides)


def _touching(own: Window, axis: int, high: Any, windows: Sequence[Window], lows: Sequence[Any], steps: int) -> Any:
    """Rows (label, index of the next chunk, label there) of parts that touch across a chunk's high side along an axis, each once."""
    np = arrays.numpy("bitvox.big")
    across = [a for a in range(3) if a != axis]
    if not high.any():
        return np.zeros((0, 3), np.int64)
    plane = np.zeros([n + 2 for n in high.shape], np.int64)  # what lies beyond the side, and one more around
    for k, (window, low) in enumerate(zip(windows, lows)):
        begin = [window.low[a] - own.low[a] + 1 for a in across]
        shared = [(max(0, b), min(n, b + m)) for b, n, m in zip(begin, plane.shape, low.shape)]
        part = low[tuple(slice(p - b, q - b) for (p, q), b in zip(shared, begin))].astype(np.int64)
        plane[tuple(slice(*s) for s in shared)] = np.where(part != 0, part | k << 32, 0)
    found = []
    for i, j in itertools.product((-1, 0, 1), repeat=2):
        if abs(i) + abs(j) <= steps:
            there = plane[1 + i : 1 + i + high.shape[0], 1 + j : 1 + j + high.shape[1]]
            both = (high != 0) & (there != 0)
            found.append(np.stack([high[both].astype(np.int64), there[both] >> 32, there[both] & (2**32 - 1)], axis=1))
    return np.unique(np.concatenate(found), axis=0)


def _numbered(grid: Grid, connectivity: int, labels: Any) -> Any:
    return labels[grid.label(connectivity=connectivity, threads=1)]


def _unite(parent: Any, pairs: Any) -> None:
    for a, b in pairs.tolist():
        while parent[a] != a:
            parent[a] = parent[parent[a]]
            a = parent[a]
        while parent[b] != b:
            parent[b] = parent[parent[b]]
            b = parent[b]
        if a != b:
            parent[max(a, b)] = min(a, b)


def _roots(parent: Any, np: Any) -> Any:
    while True:
        above = parent[parent]
        if np.array_equal(above, parent):
            return parent
        parent = above
