"""One piece with fewer triangles, which stays between its cuts and in its volume, and encloses as much as before."""

from __future__ import annotations

import math
from typing import Any, Iterator, Sequence

from .. import _arrays as arrays
from .._levels import simplify
from .._mesh import Mesh
from .._stages import compare

SAMPLES = 2000  # points a side, and no more than triangles, from which the distance between a piece and its next level is measured
LEFT = 4  # one triangle of so many is left by a level: that of a lattice with voxels twice as large
ROUNDS = 3  # of steps along normals, each by what the ones before left
BOUNDLESS = (-math.inf,) * 3, (math.inf,) * 3


def collapsed(mesh: Mesh, low: Sequence[float], high: Sequence[float], near: Sequence[float], limit: int | None = None,
              box: Sequence[Sequence[float]] = BOUNDLESS) -> tuple[Mesh, float]:
    """A level of a piece between its cuts and in a box, and how far it is from the piece.

    Vertices on cuts stay. So do the triangles at low cuts: collapses there could lay triangles into the cut, and the piece beyond it
    could do so too, where they would overlap. New vertices may come to lie beyond a cut, or out of the box where the piece is not: then
    those of the mesh stay that are as near to it, and where that does not help, no vertex is new.
    """
    np = arrays.numpy("bitvox.big")
    at, faces, (first, last) = np.asarray(mesh.vertices), np.asarray(mesh.faces), mesh.bounds
    locked = np.zeros(len(at), bool)
    locked[faces[(at < np.add(low, near)).any(axis=1)[faces].any(axis=1)]] = True
    wanted: dict[str, Any] = {"triangles": max(1, mesh.n_faces // LEFT), "lock_border": True, "threads": 1, "memory_limit": limit}
    least = np.minimum(np.maximum(low, box[0]), first).astype(at.dtype)
    most = np.maximum(np.minimum(high, box[1]), last).astype(at.dtype)
    sides = np.where(np.isinf(low), least, -np.inf), np.where(np.isinf(high), most, np.inf)
    for _ in range(3):
        made = _put_inside(simplify(mesh, locked=locked, **wanted), *sides, limit)
        found = np.asarray(made.vertices)
        below, above = (np.maximum(0, beyond.max(axis=0)) for beyond in (least - found, found - most))
        if not below.any() and not above.any():
            break
        locked |= (at < least + 4 * below).any(axis=1) | (at > most - 4 * above).any(axis=1)
    else:
        made = simplify(mesh, vertices="kept", locked=locked, **wanted)._part(slice(None))
    made = _as_large(mesh, made, np.maximum(np.add(low, near), least), np.minimum(np.subtract(high, near), most), 4 * max(near), limit)
    gap: Any = compare(mesh, made, samples=min(SAMPLES, made.n_faces), threads=1, memory_limit=limit)
    return made, gap.max


def _put_inside(mesh: Mesh, low: Any, high: Any, limit: int | None) -> Mesh:
    """Vertices that are out of a box go to its sides, unless faces would then cross or have no area. The mesh that they stand for lies in
    the box, so all come nearer to it. A flat side is left by so many that to lock what is near would lock most of it."""
    np = arrays.numpy("bitvox.big")
    at, faces = np.asarray(mesh.vertices), np.asarray(mesh.faces)
    moved = np.clip(at, low, high).astype(at.dtype)
    new = faces[(moved != at).any(axis=1)[faces].any(axis=1)]
    if not len(new) or not np.any(_crossed(_corners(moved.astype(float), new)), axis=0).all():
        return mesh
    made = Mesh(moved, mesh.faces)
    return mesh if len(made.crossings(threads=1, memory_limit=limit)) else made


def _as_large(mesh: Mesh, made: Mesh, low: Any, high: Any, most: float, limit: int | None = None) -> Mesh:
    """A level that encloses what its mesh does: vertices in a box, that are not at cuts or in sides of the volume, move along their
    normals, all by one distance, and stay in it.

    Vertices of a level settle by the middles of the triangles before it, which lie further in than their corners: what is round would
    shrink from level to level. Sums are exact or in the order of faces, so that every machine writes the same bytes.
    """
    np = arrays.numpy("bitvox.big")
    begin, faces, middle = np.asarray(made.vertices, float), np.asarray(made.faces, np.int64), np.mean(mesh.bounds, axis=0)
    wanted = _enclosed(np.asarray(mesh.vertices, float) - middle, mesh.faces)
    normal, area = _normals(_corners(begin, faces), faces, len(begin))
    at, best, step, free = begin, made, 0.0, ((begin > low) & (begin < high)).all(axis=1)
    for _ in range(ROUNDS):
        taken = math.fsum(area[free].tolist())
        more = (wanted - _enclosed(at - middle, faces)) / taken if taken > 0 else 0.0
        if abs(more) < most / 400:
            break
        step = min(max(step + more, -most), most)
        while True:
            moved = np.where(free[:, None], begin + step * normal, begin).astype(made.vertices.dtype)
            found = Mesh(moved, made.faces)
            bad = ~((moved > low) & (moved < high)).all(axis=1)
            bad[faces[found.crossings(threads=1, memory_limit=limit)]] = True
            if not (bad & free).any():
                break
            free &= ~bad
        at, best = moved.astype(float), found
    return best


def _corners(at: Any, faces: Any) -> Any:
    """Coordinates [axis][corner, face]: of one axis after another they are gathered twice as fast as point by point."""
    np = arrays.numpy("bitvox.big")
    turned = np.ascontiguousarray(np.asarray(faces).T)
    return [np.take(part, turned) for part in np.ascontiguousarray(at.T)]


BLOCK = 1 << 16  # faces whose corners are held at a time


def _enclosed(at: Any, faces: Any) -> float:
    """With the cuts: of two surfaces that end in the same border the difference is what lies between them."""

    def parts() -> Iterator[float]:
        for first in range(0, len(faces), BLOCK):
            corners = _corners(at, faces[first : first + BLOCK])
            x, y, z = _crossed(corners)
            yield from ((corners[0][0] * x + corners[1][0] * y + corners[2][0] * z) / 6).tolist()

    return math.fsum(parts())


def _normals(corners: Any, faces: Any, count: int) -> tuple[Any, Any]:
    """Of each vertex the normal, and the volume that a step of one along it adds, in the first order."""
    np, of = arrays.numpy("bitvox.big"), faces.ravel()
    x, y, z = (np.bincount(of, np.repeat(part / 6, 3), count) for part in _crossed(corners))
    length = np.sqrt(x * x + y * y + z * z)
    return np.stack([x, y, z], axis=1) / np.where(length > 0, length, 1)[:, None], length


def _crossed(corners: Any) -> tuple[Any, Any, Any]:
    """Twice the areas of faces, along their normals."""
    (p, u), (q, v), (r, w) = ((part[1] - part[0], part[2] - part[0]) for part in corners)
    return q * w - r * v, r * u - p * w, p * v - q * u
