"""Connected parts of a volume in chunks, numbered as those of the whole."""

from __future__ import annotations

from typing import Any

from .. import _arrays as arrays
from .._errors import ArgumentError, RangeError, need
from .._grid import Grid
from .chunks import Index
from .volume import Volume

_STEPS = {6: 0, 18: 1, 26: 2}  # how far neighbors across a cut may lie beside each other, in steps along its two axes


def label(volume: Volume, *, connectivity: int = 6) -> tuple[Any, int]:
    """Number the voxels of a volume by their connected part.

    Each chunk numbers its own parts on the workers; what touches across the chunks' sides is joined here, which computes the
    chunks once. The array numbers them again when it is computed.

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
    dask, da, np = need("dask", "big"), need("dask.array", "big"), arrays.numpy("bitvox.big")
    if connectivity not in _STEPS:
        raise ArgumentError(f"connectivity is {connectivity}; it must be 6, 18 or 26")
    cut = volume.chunks
    look = dask.delayed(_look, pure=True)
    found = dict(zip(cut, dask.compute(*[look(volume.blocks[index], connectivity) for index in cut])))
    tables, count = _join(volume, found, connectivity, np)
    number = dask.delayed(_numbered, pure=True)

    def one(index: Index) -> Any:
        made = number(volume.blocks[index], connectivity, tables[index])
        return da.from_delayed(made, cut.window(index).size, np.uint32)

    nx, ny, nz = cut.counts
    return da.block([[[one((x, y, z)) for z in range(nz)] for y in range(ny)] for x in range(nx)]), count


def _look(grid: Grid, connectivity: int) -> Any:
    """Least voxels (x, y, z) of a chunk's parts in the lattice, and the labels of its six sides."""
    np = arrays.numpy("bitvox.big")
    labels = grid.label(connectivity=connectivity, threads=1)
    first = grid.components(connectivity=connectivity, threads=1)["first"]
    nx, ny, _ = grid.shape
    least = np.stack([first % nx, first // nx % ny, first // nx // ny], axis=1).astype(np.int64) + np.array(grid.low)
    sides = [[np.ascontiguousarray(labels.take(end, axis=axis)) for end in (0, -1)] for axis in range(3)]
    return least, sides


def _numbered(grid: Grid, connectivity: int, table: Any) -> Any:
    return table[grid.label(connectivity=connectivity, threads=1)]


def _join(volume: Volume, found: dict[Index, Any], connectivity: int, np: Any) -> tuple[dict[Index, Any], int]:
    """For each chunk the whole's label of each of its own."""
    begin, total = {}, 1
    for index, (least, _) in found.items():
        begin[index] = total  # a chunk's label n is number begin + n - 1; 0 is empty
        total += len(least)
    parent = np.arange(total, dtype=np.int64)
    for axis in range(3):
        for at in range(1, volume.chunks.counts[axis]):
            low, high = (_plane(volume, found, begin, axis, i, np) for i in (at - 1, at))
            _unite(parent, _pairs(low[1], high[0], _STEPS[connectivity], np))
    root = _roots(parent, np)
    least = np.concatenate([np.full((1, 3), -1, np.int64)] + [f[0] for f in found.values()])
    order = np.lexsort((least[:, 0], least[:, 1], least[:, 2]))  # number 0, empty, comes first
    _, first = np.unique(root[order], return_index=True)
    roots = root[order][np.sort(first)]  # in the order of their least voxels
    if len(roots) > 2**32:
        raise RangeError(f"{len(roots) - 1} parts are more than labels of 32 bits hold")
    rank = np.zeros(total, np.uint32)
    rank[roots] = np.arange(len(roots), dtype=np.uint64).astype(np.uint32)
    whole = rank[root]
    return {i: np.concatenate([whole[:1], whole[begin[i] : begin[i] + len(found[i][0])]]) for i in found}, len(roots) - 1


def _plane(volume: Volume, found: dict[Index, Any], begin: dict[Index, int], axis: int, at: int, np: Any) -> Any:
    """The two sides across an axis of all chunks with index ``at`` along it, as numbers of parts."""
    others = [a for a in range(3) if a != axis]
    made = [np.zeros([volume.shape[a] for a in others], np.int64) for _ in range(2)]
    for index in found:
        if index[axis] != at:
            continue
        window = volume.chunks.window(index)
        place = tuple(slice(window.low[a], window.low[a] + window.size[a]) for a in others)
        for end in range(2):
            labels = found[index][1][axis][end]
            made[end][place] = np.where(labels != 0, labels.astype(np.int64) + (begin[index] - 1), 0)
    return made


def _pairs(low: Any, high: Any, steps: int, np: Any) -> Any:
    """Numbers that touch across a cut, each pair once."""
    found = []
    for i in (-1, 0, 1):
        for j in (-1, 0, 1):
            if abs(i) + abs(j) > steps:
                continue
            a = low[max(0, i) : low.shape[0] + min(0, i), max(0, j) : low.shape[1] + min(0, j)]
            b = high[max(0, -i) : low.shape[0] + min(0, -i), max(0, -j) : low.shape[1] + min(0, -j)]
            both = (a != 0) & (b != 0)
            found.append(np.stack([a[both], b[both]], axis=1))
    return np.unique(np.concatenate(found), axis=0)


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
