"""AMF, the additive manufacturing file format (ISO/ASTM 52915): meshes in XML, plain or zipped."""

from __future__ import annotations

import gzip
import io
import os
import zipfile
from typing import Any
from xml.etree import ElementTree

from .. import _arrays as arrays
from .._errors import EmptyError, FormatError
from .._mesh import Mesh


def read_amf(path: str | os.PathLike[str]) -> Mesh:
    """One mesh of all objects of an AMF file, or of all instances of its constellations where it has some, in the file's own
    unit. Curved triangles are taken as flat.

    Parameters
    ----------
    path
        .amf, plain, zipped or packed as .gz.

    Raises
    ------
    FormatError
        damaged XML, invalid numbers, vertex indices beyond the vertices.

    Examples
    --------
    >>> bitvox.formats.read_amf('part.amf')  # doctest: +SKIP
    """
    with open(path, "rb") as file:
        data = file.read()
    if data[:2] == b"\x1f\x8b":
        data = gzip.decompress(data)
    if data[:2] == b"PK":
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            names = [n for n in archive.namelist() if n.lower().endswith(".amf")]
            if not names:
                raise FormatError(f"{os.fspath(path)}: the archive has no .amf")
            data = archive.read(names[0])
    try:
        root = ElementTree.fromstring(data)
    except ElementTree.ParseError as why:
        raise FormatError(f"{os.fspath(path)}: {why}") from None
    if _tag(root) != "amf":
        raise FormatError(f"{os.fspath(path)}: the document is <{_tag(root)}>, not <amf>")
    objects = {o.get("id", ""): _object(o, os.fspath(path)) for o in root if _tag(o) == "object"}
    constellations = {c.get("id", ""): c for c in root if _tag(c) == "constellation"}
    parts = list(_placed(objects, constellations, os.fspath(path))) if constellations else list(objects.values())
    np = arrays.numpy("AMF")
    if not sum(len(f) for _, f in parts):
        raise EmptyError(f"{os.fspath(path)} has no triangles")
    starts = np.cumsum([0] + [len(v) for v, _ in parts])
    return Mesh(np.concatenate([v for v, _ in parts]), np.concatenate([f + n for (_, f), n in zip(parts, starts)]))


def _tag(element: Any) -> str:
    return element.tag.rpartition("}")[2]


def _child(element: Any, name: str) -> Any:
    return next((c for c in element if _tag(c) == name), None)


def _object(element: Any, path: str) -> tuple[Any, Any]:
    np = arrays.numpy("AMF")
    vertices: list[Any] = []
    faces: list[Any] = []
    called = element.get("id", "?")
    try:
        for mesh in (m for m in element if _tag(m) == "mesh"):
            first = len(vertices)
            for group in mesh:
                if _tag(group) == "vertices":
                    for vertex in (v for v in group if _tag(v) == "vertex"):
                        at = _child(vertex, "coordinates")
                        vertices.append([float(_child(at, axis).text) for axis in "xyz"])
            for group in mesh:
                if _tag(group) == "volume":
                    for triangle in (t for t in group if _tag(t) == "triangle"):
                        corners = [int(_child(triangle, name).text) for name in ("v1", "v2", "v3")]
                        if min(corners) < 0 or max(corners) >= len(vertices) - first:
                            raise FormatError(f"{path}: object {called}: triangle {len(faces)} names a vertex that is not there")
                        faces.append([first + c for c in corners])
    except (TypeError, ValueError, AttributeError) as why:
        if isinstance(why, FormatError):
            raise
        raise FormatError(f"{path}: object {called}: vertex {len(vertices)}, triangle {len(faces)}: a number is missing or none") from None
    return np.array(vertices, float).reshape(-1, 3), np.array(faces, np.int64).reshape(-1, 3)


def _placed(objects: Any, constellations: Any, path: str) -> Any:
    """The instances of all constellations that no other one uses; each chain of uses at most once through each."""
    used = {i.get("objectid") for c in constellations.values() for i in c if _tag(i) == "instance"}
    tops = [key for key in constellations if key not in used] or [next(iter(constellations))]
    np = arrays.numpy("AMF")

    def walk(key: str, turn: Any, shift: Any, above: tuple[str, ...]) -> Any:
        if key in objects:
            vertices, faces = objects[key]
            yield vertices @ turn.T + shift, faces
            return
        if key not in constellations or key in above:
            raise FormatError(f"{path}: an instance of object {key!r}, which is not there or holds itself")
        for instance in (i for i in constellations[key] if _tag(i) == "instance"):
            move, rotate = _numbers(instance, ("deltax", "deltay", "deltaz"), path), _numbers(instance, ("rx", "ry", "rz"), path)
            own = _turn(rotate)
            yield from walk(instance.get("objectid", ""), turn @ own, turn @ np.array(move) + shift, (*above, key))

    for key in tops:
        yield from walk(key, np.eye(3), np.zeros(3), ())


def _numbers(instance: Any, names: tuple[str, ...], path: str) -> list[float]:
    try:
        return [0.0 if _child(instance, n) is None else float(_child(instance, n).text) for n in names]
    except (TypeError, ValueError):
        raise FormatError(f"{path}: an instance's number is none") from None


def _turn(degrees: list[float]) -> Any:
    """Rotations about x, then y, then z; quarter turns are exact."""
    np = arrays.numpy("AMF")
    total = np.eye(3)
    for axis, angle in enumerate(degrees):
        quarter = {0.0: (1, 0), 90.0: (0, 1), 180.0: (-1, 0), 270.0: (0, -1)}.get(angle % 360)
        c, s = quarter if quarter is not None else (np.cos(np.radians(angle)), np.sin(np.radians(angle)))
        i, j = (axis + 1) % 3, (axis + 2) % 3
        one = np.eye(3)
        one[i, i], one[i, j], one[j, i], one[j, j] = c, -s, s, c
        total = one @ total
    return total
