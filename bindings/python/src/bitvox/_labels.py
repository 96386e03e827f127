"""Surfaces of all labels of a volume: bodies that share their faces."""

from __future__ import annotations

import os
import re
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Callable, Iterator, NamedTuple

from . import _arrays as arrays
from ._bytes import format_of
from ._calls import call
from ._errors import ArgumentError, FormatError, need
from ._mesh import Mesh, new_mesh, position_type
from ._records import record
from ._run import Progress, Run, ffi, lib, options_of
from ._words import Array

if TYPE_CHECKING:
    from .reports import Label


class Segment(NamedTuple):
    """What a label of a segmentation is called, in `Volume.segments` and `Surfaces.segments`.

    Attributes
    ----------
    name
        as files and nodes are named.
    color
        red, green and blue from 0 to 255; None: `Surfaces` gives one.

    Examples
    --------
    >>> halves = bitvox.Volume(np.arange(16).reshape(4, 2, 2) // 8 + 1)
    >>> halves.segments[2] = bitvox.Segment('liver', (200, 80, 60))
    >>> [one.name for one in halves.surfaces().segments.values()]
    ['1', 'liver']
    """

    name: str
    color: tuple[int, int, int] | None = None


def segments_of(data: Any) -> dict[int, Segment]:
    """The names and colors that 3D Slicer writes into an NRRD's head."""
    head = re.split(rb"\r?\n\r?\n", bytes(data[: 1 << 20]), maxsplit=1)[0].decode(errors="replace")
    told: dict[str, dict[str, str]] = {}
    for number, key, text in re.findall(r"^Segment(\d+)_(LabelValue|Name|Color):=(.*?)\r?$", head, flags=re.M):
        told.setdefault(number, {})[key] = text
    found: dict[int, Segment] = {}
    for one in told.values():
        try:
            red, green, blue = (min(255, max(0, round(255 * float(part)))) for part in one.get("Color", "").split())
            color = red, green, blue
        except ValueError:
            color = None
        if re.fullmatch(r"-?\d{1,20}", value := one.get("LabelValue", "")):
            found.setdefault(int(value), Segment(one.get("Name") or value, color))
    return found


# ITK-SNAP; .csv and .tsv, whose names may stand in quotes; FreeSurfer. As the program has them.
_COLOR = r"[,;\t]\s*(?P<red>\d{1,3})[,;\t]\s*(?P<green>\d{1,3})[,;\t]\s*(?P<blue>\d{1,3})"
_ROWS = tuple(re.compile(row) for row in (
    r'\s*(?P<value>\S+)\s+(?P<red>\d{1,3})\s+(?P<green>\d{1,3})\s+(?P<blue>\d{1,3})\s+\d+\s+\d+\s+\d+\s*"(?P<name>[^"]+)',
    rf'\s*(?P<value>[^,;\t]+)[,;\t]"(?P<name>[^"]+)"(?:{_COLOR})?', rf"\s*(?P<value>[^,;\t]+)[,;\t](?P<name>[^,;\t\r]+)(?:{_COLOR})?",
    r"\s*(?P<value>\S+)\s+(?P<name>\S+)(?:\s+(?P<red>\d{1,3})\s+(?P<green>\d{1,3})\s+(?P<blue>\d{1,3}))?",
))


def read_segments(path: str | os.PathLike[str]) -> dict[int, Segment]:
    """Names and colors of labels from a table, for `Volume.segments`.

    Parameters
    ----------
    path
        lines of a number, a name and, if it has them, red, green and blue from 0 to 255: a FreeSurfer look-up table, .csv, .tsv; or labels of
        ITK-SNAP. The first line of a number counts; other lines are passed over.

    Examples
    --------
    >>> with open('atlas.csv', 'w') as file:
    ...     _ = file.write('index,name\\n1,"Gray, matter"\\n2,Thalamus,20,90,200\\n')
    >>> bitvox.read_segments('atlas.csv')
    {1: Segment(name='Gray, matter', color=None), 2: Segment(name='Thalamus', color=(20, 90, 200))}
    """
    found: dict[int, Segment] = {}
    with open(path, "rb") as file:
        lines = file.read().decode(errors="replace").split("\n")
    for line in lines:
        row = next((row for row in (form.match(line) for form in _ROWS) if row), None)
        if row and re.fullmatch(r"-?\d{1,20}", row["value"]):
            color = tuple(int(row[part]) for part in ("red", "green", "blue")) if row["red"] else None
            found.setdefault(int(row["value"]), Segment(row["name"], color if color and max(color) < 256 else None))  # type: ignore[arg-type]
    if not found:
        raise FormatError(f"{os.fsdecode(path)}: no line has the number of a label and a name")
    return found


class Complex(NamedTuple):
    """The faces between labels, each once.

    Attributes
    ----------
    vertices
        (n, 3) positions, shared by all bodies [world].
    faces
        (m, 3) vertex indices; two after one another make the face between two voxels, unless there are fewer triangles.
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


# Of labels without one, as the program has them: the themes "Set2" and "Dark2" of colorbrewer2.org, by turns.
COLORS = ((102, 194, 165), (217, 95, 2), (141, 160, 203), (231, 41, 138), (166, 216, 84), (117, 112, 179), (255, 217, 47),
          (27, 158, 119), (252, 141, 98), (102, 166, 30), (231, 138, 195), (166, 118, 29), (229, 196, 148), (102, 102, 102))


class Surfaces(Mapping[int, Mesh]):
    """The body of each label, by its value; made by `Volume.surfaces`.

    A body is made when it is requested: closed, manifold and oriented, with the positions and faces of its neighbors where they touch.

    Attributes
    ----------
    labels
        the values with their voxels and boxes.
    segments
        name and color of each value: those of `Volume.segments`, else the number and a color that differs from its neighbors'.

    Examples
    --------
    >>> bodies = bitvox.Volume(np.arange(27).reshape(3, 3, 3) % 3).surfaces()
    >>> [(value, mesh.n_faces) for value, mesh in bodies.items()]
    [(1, 60), (2, 60)]
    """

    __slots__ = ("_at", "_background", "_c", "_place", "_type", "labels", "segments")
    _at: dict[int, int]
    _background: int
    _c: Any
    _place: Callable[[Mesh], Mesh]
    _type: str
    labels: list[Label]
    segments: dict[int, Segment]

    @classmethod
    def _made(cls, made: Any, background: int, unsigned: bool, place: Callable[[Mesh], Mesh], segments: Mapping[int, Segment]) -> Surfaces:
        self = cls.__new__(cls)
        found = [record(made.labels[i]) for i in range(made.label_count)]
        self.labels = [one._replace(value=one.value % 2**64) for one in found] if unsigned else found
        self._at = {one.value: i for i, one in enumerate(self.labels)}
        self._c, self._place, self._background = made, place, background
        self._type = "uint64" if unsigned else "int64"
        self.segments = {}
        for i, value in enumerate(self._at):
            told = Segment(*segments.get(value, (str(value),)))
            self.segments[value] = Segment(str(told.name), told.color or COLORS[i % len(COLORS)])
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
        return Complex(mesh.vertices, mesh.faces, values[sides] if self._c.single else np.repeat(values[sides], 2, axis=0))

    def to_pyvista(self) -> Any:
        """A pyvista.MultiBlock with a block for each label, by its name; each has its value and color as field data.

        Examples
        --------
        >>> bitvox.Volume(np.ones((2, 2, 2), int)).surfaces().to_pyvista().keys()
        ['1']
        """
        blocks = need("pyvista", "view").MultiBlock()
        for value, mesh in self.items():
            made = mesh.to_pyvista()
            made.field_data["value"], made.field_data["color"] = arrays.numpy("to_pyvista").array([value], self._type), self.segments[value].color
            blocks.append(made, self.segments[value].name)
        return blocks

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write all bodies.

        Parameters
        ----------
        path
            a name that ends in .glb, which gets a node for each with its name and color; or one with ``%s``, for a file each: the label's name
            stands there, or its value where two have one name.

        Examples
        --------
        >>> bitvox.Volume(np.ones((2, 2, 2), int)).surfaces().save('body_%s.ply')
        >>> bitvox.read('body_1.ply').is_closed
        True
        """
        before, place, after = os.fsdecode(path).partition("%s")
        names = [one.name.lower() for one in self.segments.values()]
        if not place and format_of(before, None) != "glb":
            raise ArgumentError(f"{before}: several bodies need %s in the name, for the name of each; only .glb holds several")
        if not place:
            call("write_named", before, [(self.segments[value], mesh) for value, mesh in self.items()])
            return
        for value, mesh in self.items():
            name = self.segments[value].name
            name = str(value) if names.count(name.lower()) > 1 else re.sub(r'[/\\:*?"<>|\x00-\x1f]', "_", name)
            mesh.save(before + name + after)

    def __repr__(self) -> str:
        return f"Surfaces({len(self)} labels, {self._c.mesh.triangle_count} faces)"


def label_surfaces(view: Any, background: int, smooth: bool, targets: dict[str, Any], dtype: Any, unsigned: bool, place: Callable[[Mesh], Mesh],
                   segments: Mapping[int, Segment], *, open: bool, threads: int | None, memory_limit: int | None, progress: Progress) -> Surfaces:
    """The surfaces of a checked view."""
    options = options_of("labels_options")
    options.background = background - 2**64 if background >= 2**63 else background
    options.staircase, options.open = int(not smooth), int(bool(open))
    options.triangles, options.error = targets.get("triangles", 0), targets.get("error", 0)
    options.position_type = lib.BVX_POSITION_AUTO if dtype is None else position_type(dtype)
    made = ffi.gc(ffi.new("bvx_complex *"), lib.bvxpy_free_complex)
    with Run(threads, memory_limit, progress) as run:
        run.check(lib.bvx_label_surfaces(run.context, view, options, made))
    return Surfaces._made(made, background, unsigned, place, segments)
