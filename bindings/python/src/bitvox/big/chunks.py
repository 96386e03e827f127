"""How a lattice is cut into chunks, and how chunks are put together."""

from __future__ import annotations

import itertools
from typing import Any, Callable, Iterator, Sequence

from .. import _arrays as arrays
from .._errors import ArgumentError, LatticeError, need
from .._grid import Grid
from .._lattice import Lattice, Window, WindowLike, set_window
from .._run import SIDES, ffi, in_range

Index = tuple[int, int, int]


def laid_out(array: Any) -> Any:
    """A Dask array of three axes and known chunks; others are laid out as one."""
    if not hasattr(array, "chunks"):
        array = need("dask.array", "big").from_array(array)
    if array.ndim != 3:
        raise ArgumentError(f"array has {array.ndim} axes; it must have three")
    if any(side != side for side in array.shape):
        raise ArgumentError("array has chunks of unknown size; its compute_chunk_sizes() finds them")
    return array


class Chunks:
    """A lattice cut into boxes of one size; those at the high sides are smaller where it does not divide the shape.

    Parameters
    ----------
    lattice
        what is cut.
    size
        voxels of a chunk along x, y, z, or one number for all.
    box
        the window of the lattice that is cut; None: all of it.
    shared
        surfaces of chunks meet at sides of voxels, as those of `Labels` with shared faces do, not at centers.

    Examples
    --------
    >>> cut = bitvox.big.Chunks(bitvox.Lattice((100, 100, 100)), 64)
    >>> cut.counts, cut.window((1, 0, 0))
    ((2, 2, 2), Window(low=(64, 0, 0), size=(36, 64, 64)))
    """

    __slots__ = ("lattice", "size", "counts", "box", "shared")
    lattice: Lattice
    size: Index
    counts: Index
    box: Window
    shared: bool

    def __init__(self, lattice: Lattice, size: int | Sequence[int], box: Window | None = None, shared: bool = False) -> None:
        self.lattice, self.box, self.shared = lattice, box or Window((0, 0, 0), lattice.shape), shared
        sides = [size] * 3 if not hasattr(size, "__len__") else list(size)  # type: ignore[arg-type]
        if len(sides) != 3:
            raise ArgumentError("chunks must be one number or three")
        self.size = tuple(min(in_range("chunks", n, 1, 2**25), m) for n, m in zip(sides, self.box.size))  # type: ignore[assignment]
        self.counts = tuple(-(-m // n) for n, m in zip(self.size, self.box.size))  # type: ignore[assignment]

    def __iter__(self) -> Iterator[Index]:
        """Indices (x, y, z) of all chunks, x fastest."""
        for z, y, x in itertools.product(*(range(n) for n in self.counts[::-1])):
            yield (x, y, z)

    def __len__(self) -> int:
        return self.counts[0] * self.counts[1] * self.counts[2]

    def window(self, index: Index) -> Window:
        """The voxels of the chunk ``index``.

        Examples
        --------
        >>> cut = bitvox.big.Chunks(bitvox.Lattice((10, 8, 8)), 8)
        >>> cut.window((1, 0, 0))
        Window(low=(8, 0, 0), size=(2, 8, 8))
        """
        low = tuple(b + i * n for b, i, n in zip(self.box.low, index, self.size))
        return Window(low, tuple(min(n, b + m - a) for n, b, m, a in zip(self.size, *self.box, low)))  # type: ignore[arg-type]

    def cells(self, index: Index) -> tuple[Window, list[str]]:
        """What the surface of chunk ``index`` is extracted from: its voxels and one layer of the next chunks, and which sides
        are open. A cell belongs to the chunk that holds its low corner.

        Examples
        --------
        >>> cut = bitvox.big.Chunks(bitvox.Lattice((10, 8, 8)), 8)
        >>> cut.cells((0, 0, 0))
        (Window(low=(0, 0, 0), size=(9, 8, 8)), ['x-high'])
        """
        low, size = self.window(index)
        sides, grown = [], []
        for axis in range(3):
            more = index[axis] + 1 < self.counts[axis]
            grown.append(size[axis] + int(more))
            if index[axis] > 0:
                sides.append(SIDES[axis * 2])
            if more:
                sides.append(SIDES[axis * 2 + 1])
        return Window(low, tuple(grown)), sides  # type: ignore[arg-type]

    def grown(self, index: Index, margin: Sequence[int]) -> Window:
        """The voxels of the chunk ``index`` and ``margin`` more along x, y, z on either side, as far as the box goes.

        Examples
        --------
        >>> cut = bitvox.big.Chunks(bitvox.Lattice((10, 8, 8)), 8)
        >>> cut.grown((1, 0, 0), (2, 2, 2))
        Window(low=(6, 0, 0), size=(4, 8, 8))
        """
        return grown(self.window(index), margin, self.box)

    def over(self, window: Window) -> list[Index]:
        """Indices of the chunks that have voxels in a window, x fastest.

        Examples
        --------
        >>> cut = bitvox.big.Chunks(bitvox.Lattice((10, 8, 8)), 8)
        >>> cut.over(bitvox.Window((7, 0, 0), (2, 1, 1)))
        [(0, 0, 0), (1, 0, 0)]
        """
        spans = [range((a - b) // n, (a - b + m - 1) // n + 1) for a, m, b, n in zip(*window, self.box.low, self.size)]
        return [(x, y, z) for z, y, x in itertools.product(*spans[::-1])]

    def __reduce__(self) -> Any:
        return Chunks, (self.lattice, self.size, self.box, self.shared)

    def __repr__(self) -> str:
        return f"Chunks({' x '.join(map(str, self.counts))} of {' x '.join(map(str, self.size))})"


def window_of(lattice: Lattice, window: WindowLike) -> Window:
    """A window in any of the forms that grids take."""
    if window is None:
        raise ArgumentError("window is missing: what lies in a volume is not known before it is computed")
    box = ffi.new("bvx_window *")
    set_window("window", box, window)
    found = Window(tuple(box.low), tuple(box.size))  # type: ignore[arg-type]
    for end in (0, 1):  # is it one of the lattice?
        Grid(lattice, (tuple(a + end * (n - 1) for a, n in zip(*found)), (1, 1, 1)))
    return found


# ---- the tree of chunks ----


def stride(cut: Chunks, level: int) -> int:
    """Chunks along the side of a piece. Level 1 collapses between the cuts of the finest one: so a piece with twice its side has no
    triangle across its middle planes either, as viewers want it. Levels with shared faces are all made from voxels of chunks."""
    return 1 if cut.shared else 1 << max(0, level - 1)


def indices(cut: Chunks, level: int) -> list[Index]:
    """All pieces of a level, x fastest."""
    counts = [-(-n // stride(cut, level)) for n in cut.counts]
    return [(x, y, z) for z, y, x in itertools.product(*map(range, counts[::-1]))]


def joins(cut: Chunks, level: int, index: Index) -> list[Index]:
    """The pieces of the level before that a piece is made of."""
    if level < 2:
        return [index]
    ends = [-(-n // stride(cut, level - 1)) for n in cut.counts]
    return [(x, y, z) for z, y, x in itertools.product(*(range(2 * i, min(2 * i + 2, n)) for i, n in zip(index[::-1], ends[::-1])))]


def planes(cut: Chunks, level: int, index: Index) -> tuple[list[float], list[float]]:
    """The cuts around a piece; none at the sides of the whole."""
    low, high = [], []
    for i, n, m, a, corner, edge in zip(index, cut.size, cut.counts, cut.box.low, cut.lattice.corner, cut.lattice.spacing):
        ends = [i * stride(cut, level), (i + 1) * stride(cut, level)]
        found = [corner + (a + end * n + (0 if cut.shared else 0.5)) * edge for end in ends]
        low.append(found[0] if i > 0 else float("-inf"))
        high.append(found[1] if ends[1] < m else float("inf"))
    return low, high


def centers(cut: Chunks) -> tuple[list[float], list[float]]:
    """The box between the centers of the outermost voxels: where fragments of viewers begin, and what no level leaves by itself."""
    places = list(zip(cut.lattice.corner, cut.lattice.spacing, *cut.box))
    return [corner + (a + 0.5) * edge for corner, edge, a, _ in places], [corner + (a + n - 0.5) * edge for corner, edge, a, n in places]


# ---- windows ----


def grown(window: Window, margin: Sequence[int], box: Window) -> Window:
    """A window with a halo, as far as a box that holds it goes."""
    wide = Window(tuple(a - m for a, m in zip(window.low, margin)), tuple(n + 2 * m for n, m in zip(window.size, margin)))  # type: ignore[arg-type]
    return overlap(wide, box)  # type: ignore[return-value]


def overlap(a: Window, b: Window) -> Window | None:
    """What two windows share."""
    low = [max(p, q) for p, q in zip(a.low, b.low)]
    size = [min(p + m, q + n) - o for p, m, q, n, o in zip(a.low, a.size, b.low, b.size, low)]
    return Window(tuple(low), tuple(size)) if min(size) > 0 else None  # type: ignore[arg-type]


HALVINGS = 6  # of a window, one after another


def in_halves(work: Callable[[Window], Any], window: Window, times: int = HALVINGS) -> list[Any]:
    """What work makes of a window. Where memory does not suffice, of its halves: parts whose bits depend on nothing else."""
    try:
        return [work(window)]
    except MemoryError:
        axis = max(range(3), key=lambda a: (window.size[a], a))
        if times == 0 or window.size[axis] < 2:
            raise
    (low, size), half = map(list, window), window.size[axis] // 2
    first = Window(window.low, tuple(half if a == axis else n for a, n in enumerate(size)))  # type: ignore[arg-type]
    low[axis], size[axis] = low[axis] + half, size[axis] - half
    return in_halves(work, first, times - 1) + in_halves(work, Window(tuple(low), tuple(size)), times - 1)  # type: ignore[arg-type]


def join(lattice: Lattice, window: Window, parts: Sequence[Grid]) -> Grid:
    """The bits of a window from grids that cover it, which may overlap. A part is cropped so that its rows begin where words of the
    result do; then words are put together."""
    made = Grid(lattice, window)
    np = arrays.numpy("bitvox.big")
    target = made._words(writable=True)
    for part in parts:
        if part.lattice != lattice:
            raise LatticeError("a part is of another lattice")
        shared = overlap(window, Window(part.low, part.shape))
        if shared is None:
            continue
        x, y, z = (a - b for a, b in zip(shared.low, window.low))
        (low_x, *low), (nx, ny, nz) = shared
        words = part.crop(((low_x - x % 64, *low), (nx + x % 64, ny, nz))).words
        place = target[z : z + nz, y : y + ny, x // 64 : x // 64 + words.shape[2]]
        np.bitwise_or(place, words, out=place)
    return made
