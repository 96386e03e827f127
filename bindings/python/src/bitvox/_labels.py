"""Surfaces of all labels of a volume: bodies that share their faces."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Callable, Iterator, NamedTuple

from . import _arrays as arrays
from ._mesh import Mesh, new_mesh, position_type
from ._records import record
from ._run import Progress, Run, ffi, lib, options_of
from ._words import Array

if TYPE_CHECKING:
    from .reports import Label


class Complex(NamedTuple):
    """The faces between labels, each once.

    Attributes
    ----------
    vertices
        (n, 3) positions, shared by all bodies [world].
    faces
        (m, 3) vertex indices; two after one another make the face between two voxels.
    sides
        (m, 2) the labels behind each triangle and in front of it, from where it is seen counter-clockwise.

    Examples
    --------
    >>> faces = bitvox.Volume(np.arange(27).reshape(3, 3, 3) % 3).surfaces().complex
    >>> len(faces.faces), np.unique(faces.sides, axis=0).tolist()
    (102, [[1, 0], [1, 2], [2, 0]])
    """

    vertices: Array
    faces: Array
    sides: Array


class Surfaces(Mapping[int, Mesh]):
    """The body of each label, by its value; made by `Volume.surfaces`.

    A body is made when it is requested: closed, manifold and oriented, with the positions and faces of its neighbors where they touch.

    Examples
    --------
    >>> bodies = bitvox.Volume(np.arange(27).reshape(3, 3, 3) % 3).surfaces()
    >>> [(value, mesh.n_faces) for value, mesh in bodies.items()]
    [(1, 60), (2, 60)]
    """

    __slots__ = ("_at", "_background", "_c", "_place", "_type", "labels")
    _at: dict[int, int]
    _background: int
    _c: Any
    _place: Callable[[Mesh], Mesh]
    _type: str
    labels: list[Label]

    @classmethod
    def _made(cls, made: Any, background: int, unsigned: bool, place: Callable[[Mesh], Mesh]) -> Surfaces:
        self = cls.__new__(cls)
        found = [record(made.labels[i]) for i in range(made.label_count)]
        self.labels = [one._replace(value=one.value % 2**64) for one in found] if unsigned else found
        self._at = {one.value: i for i, one in enumerate(self.labels)}
        self._c, self._place, self._background = made, place, background
        self._type = "uint64" if unsigned else "int64"
        return self

    def __getitem__(self, value: int) -> Mesh:
        at, mesh = self._at[value], new_mesh()
        with Run() as run:
            run.check(lib.bvx_label_mesh(run.context, self._c, at, mesh))
        return self._place(Mesh._made(mesh))

    def __iter__(self) -> Iterator[int]:
        return iter(self._at)

    def __len__(self) -> int:
        return len(self.labels)

    @property
    def complex(self) -> Complex:
        """All faces with shared vertices, each once, and the labels on its sides."""
        np = arrays.numpy("Surfaces.complex")
        whole = ffi.gc(ffi.new("bvx_mesh *", self._c.mesh), lambda _, owner=self._c: None)
        mesh = self._place(Mesh._made(whole))
        values = np.array([*(one.value for one in self.labels), self._background], self._type)
        sides = arrays.array_at(self._c.sides, "uint32", (self._c.face_count, 2), self._c)
        return Complex(mesh.vertices, mesh.faces, np.repeat(values[sides], 2, axis=0))

    def __repr__(self) -> str:
        return f"Surfaces({len(self)} labels, {self._c.mesh.triangle_count} faces)"


def label_surfaces(view: Any, background: int, smooth: bool, dtype: Any, unsigned: bool, place: Callable[[Mesh], Mesh], *,
                   threads: int | None, memory_limit: int | None, progress: Progress) -> Surfaces:
    """The surfaces of a checked view."""
    options = options_of("labels_options")
    options.background = background - 2**64 if background >= 2**63 else background
    options.staircase = int(not smooth)
    options.position_type = lib.BVX_POSITION_AUTO if dtype is None else position_type(dtype)
    made = ffi.gc(ffi.new("bvx_complex *"), lib.bvxpy_free_complex)
    with Run(threads, memory_limit, progress) as run:
        run.check(lib.bvx_label_surfaces(run.context, view, options, made))
    return Surfaces._made(made, background, unsigned, place)
