"""Stacks of section contours."""

from __future__ import annotations

from typing import Any, Iterable, NamedTuple, Sequence

from . import _arrays as arrays
from ._errors import ArgumentError


class Loop(NamedTuple):
    """One closed contour: points (n, 3) [world], the last one joined to the first, and the body that it belongs to."""

    points: Any
    label: str = ""


class Sections:
    """Closed contours on parallel planes: what DICOM RTSTRUCT and DXF files hold.

    Args:
        loops: `Loop` tuples or arrays (n, 3) [world]; each lies in one plane across ``normal``.
        normal: of all planes.
        tolerance: how far a point may lie off its loop's plane, and how far apart planes may lie that count as one [world].

    Raises:
        ArgumentError: a loop of fewer than three points, or one that does not lie in a plane across the normal.
    """

    __slots__ = ("loops", "normal", "positions", "section_of")

    def __init__(self, loops: Iterable[Any], normal: Sequence[float] = (0.0, 0.0, 1.0), *, tolerance: float = 1e-6) -> None:
        np = arrays.numpy("Sections")
        direction = np.array(arrays.triple("normal", normal))
        length = float(np.sqrt(direction @ direction))
        if not length > 0.0 or not np.isfinite(length):
            raise ArgumentError("normal has no direction")
        self.normal: tuple[float, float, float] = tuple((direction / length).tolist())
        self.loops: list[Loop] = []
        heights = []
        for i, loop in enumerate(loops):
            found = loop if isinstance(loop, Loop) else Loop(loop)
            points = arrays.exact_floats(arrays.as_numpy(found.points, f"loop {i}"), f"loop {i}").astype(np.float64)
            if points.ndim != 2 or points.shape[1] != 3 or len(points) < 3:
                raise ArgumentError(f"loop {i} has shape {points.shape}; it must be (n, 3), n at least 3")
            if not np.isfinite(points).all():
                raise ArgumentError(f"loop {i} holds a coordinate that is not finite")
            along = points @ direction / length
            if along.max() - along.min() > 2 * tolerance + 1e-12 * np.abs(along).max():
                raise ArgumentError(f"loop {i} does not lie in a plane across the normal: it reaches from {along.min()} to {along.max()}")
            heights.append(float(along.mean()))
            self.loops.append(Loop(points, found.label))
        self.positions, self.section_of = _planes(heights, tolerance)

    @property
    def labels(self) -> list[str]:
        """The bodies, in order of their first loops."""
        return list(dict.fromkeys(loop.label for loop in self.loops))

    def of(self, label: str) -> Sections:
        """The loops of one body."""
        made = Sections.__new__(Sections)
        chosen = [i for i, loop in enumerate(self.loops) if loop.label == label]
        if not chosen:
            raise ArgumentError(f"no loop has the label {label!r}; there are: {', '.join(map(repr, self.labels))}")
        made.loops, made.normal, made.positions = [self.loops[i] for i in chosen], self.normal, self.positions
        made.section_of = [self.section_of[i] for i in chosen]
        return made

    def on(self, section: int) -> list[Loop]:
        """The loops on one plane, by its number in ``positions``."""
        return [loop for loop, at in zip(self.loops, self.section_of) if at == section]

    def __len__(self) -> int:
        return len(self.positions)

    def __repr__(self) -> str:
        return f"Sections({len(self.positions)} planes, {len(self.loops)} loops, {len(self.labels)} bodies)"


def _planes(heights: list[float], tolerance: float) -> tuple[list[float], list[int]]:
    """Positions of the different planes, ascending, and the number of each loop's plane."""
    order = sorted(range(len(heights)), key=lambda i: heights[i])
    positions: list[float] = []
    section = [0] * len(heights)
    for i in order:
        if not positions or heights[i] - positions[-1] > 2 * tolerance:
            positions.append(heights[i])
        section[i] = len(positions) - 1
    return positions, section
