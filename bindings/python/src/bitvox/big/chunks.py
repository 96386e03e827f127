"""How a lattice is cut into chunks, and how chunks are put together."""

from __future__ import annotations

import itertools
from typing import Any, Iterator, Sequence

from .. import _arrays as arrays
from .._errors import ArgumentError, LatticeError
from .._grid import Grid
from .._lattice import Lattice, Window
from .._run import in_range

Index = tuple[int, int, int]
_SIDES = (("x-low", "x-high"), ("y-low", "y-high"), ("z-low", "z-high"))


class Chunks:
    """A lattice cut into boxes of one size; those at the high sides are smaller where it does not divide the shape.

    Args:
        lattice: what is cut. size: voxels of a chunk along x, y, z, or one number for all.
    """

    __slots__ = ("lattice", "size", "counts")

    def __init__(self, lattice: Lattice, size: int | Sequence[int]) -> None:
        self.lattice = lattice
        sides = [size] * 3 if not hasattr(size, "__len__") else list(size)  # type: ignore[arg-type]
        if len(sides) != 3:
            raise ArgumentError("chunks must be one number or three")
        self.size: Index = tuple(min(in_range("chunks", n, 1, 2**25), m) for n, m in zip(sides, lattice.shape))  # type: ignore[assignment]
        self.counts: Index = tuple(-(-m // n) for n, m in zip(self.size, lattice.shape))  # type: ignore[assignment]

    def __iter__(self) -> Iterator[Index]:
        """Indices (x, y, z) of all chunks, x fastest."""
        for z, y, x in itertools.product(*(range(n) for n in self.counts[::-1])):
            yield (x, y, z)

    def __len__(self) -> int:
        return self.counts[0] * self.counts[1] * self.counts[2]

    def window(self, index: Index) -> Window:
        """The voxels of the chunk ``index``."""
        low = tuple(i * n for i, n in zip(index, self.size))
        return Window(low, tuple(min(n, m - a) for n, m, a in zip(self.size, self.lattice.shape, low)))  # type: ignore[arg-type]

    def cells(self, index: Index) -> tuple[Window, list[str]]:
        """What the surface of chunk ``index`` is extracted from: its voxels and one layer of the next chunks, and which sides
        are open. A cell belongs to the chunk that holds its low corner."""
        low, size = self.window(index)
        sides, grown = [], []
        for axis in range(3):
            more = index[axis] + 1 < self.counts[axis]
            grown.append(size[axis] + int(more))
            if index[axis] > 0:
                sides.append(_SIDES[axis][0])
            if more:
                sides.append(_SIDES[axis][1])
        return Window(low, tuple(grown)), sides  # type: ignore[arg-type]

    def upper(self, index: Index) -> list[Index]:
        """The chunk ``index`` and those that hold the layer beyond its high sides."""
        steps = [(0, 1) if index[a] + 1 < self.counts[a] else (0,) for a in range(3)]
        return [tuple(i + s for i, s in zip(index, step)) for step in itertools.product(*steps)]  # type: ignore[misc]

    def __reduce__(self) -> Any:
        return Chunks, (self.lattice, self.size)

    def __repr__(self) -> str:
        return f"Chunks({' x '.join(map(str, self.counts))} of {' x '.join(map(str, self.size))})"


def join(lattice: Lattice, window: Window, parts: Sequence[Grid]) -> Grid:
    """The bits of a window from grids that cover it; words are copied where rows begin at the same bit, else bits."""
    made = Grid(lattice, window)
    np = arrays.numpy("bitvox.big")
    target, bits = made._words(writable=True), None
    high = [a + n for a, n in zip(window.low, window.size)]
    for part in parts:
        if part.lattice != lattice:
            raise LatticeError("a part is of another lattice")
        low = [max(a, b) for a, b in zip(window.low, part.low)]
        top = [min(a, b + n) for a, b, n in zip(high, part.low, part.shape)]
        if any(a >= b for a, b in zip(low, top)):
            continue
        (x, y, z), (px, py, pz) = (tuple(a - b for a, b in zip(low, o)) for o in (window.low, part.low))
        nx, ny, nz = (b - a for a, b in zip(low, top))
        if x % 64 == 0 and px % 64 == 0:
            words = (nx + 63) // 64
            found = part.words[pz : pz + nz, py : py + ny, px // 64 : px // 64 + words]
            place = target[z : z + nz, y : y + ny, x // 64 : x // 64 + words]
            if nx % 64:
                found = found.copy()
                found[..., -1] &= np.uint64((1 << nx % 64) - 1)
            np.bitwise_or(place, found, out=place)
            continue
        if bits is None:
            bits = np.zeros(window.size[::-1], np.bool_)
        bits[z : z + nz, y : y + ny, x : x + nx] |= part.to_numpy("zyx")[pz : pz + nz, py : py + ny, px : px + nx]
    if bits is not None:
        made = made | Grid.from_numpy(bits, order="zyx", lattice=lattice, low=window.low)
    return made
