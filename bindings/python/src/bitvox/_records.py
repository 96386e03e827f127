"""Plain reports: C structs as named tuples with the fields of the header."""

from __future__ import annotations

from collections import namedtuple
from typing import Any

from ._arrays import plain
from ._run import ffi

_NAMES = {
    "bvx_certificate": "Certificate",
    "bvx_distance_report": "Distances",
    "bvx_grid_difference": "Difference",
    "bvx_solid_report": "SolidReport",
    "bvx_fill_comparison": "FillComparison",
    "bvx_seed": "Seed",
    "bvx_surface_report": "SurfaceReport",
    "bvx_octree_level": "OctreeLevel",
    "bvx_octree_leaf": "OctreeLeaf",
    "bvx_field_surface_report": "FieldSurfaceReport",
    "bvx_lod_report": "LodReport",
    "bvx_repair_report": "RepairReport",
    "bvx_sections_report": "SectionsReport",
    "bvx_volume_report": "VolumeReport",
    "bvx_label": "Label",
}
_YES_NO = {"closed", "edge_manifold", "vertex_manifold", "oriented", "exceeds_source", "found", "verified", "flood_leaked",
           "shelled"}


def __getattr__(name: str) -> Any:
    for kind, known in _NAMES.items():
        if known == name:
            return type_of(kind)
    raise AttributeError(name)


def type_of(kind: str) -> Any:
    """The named tuple for a C struct: its fields but for reserved ones."""
    name = _NAMES[kind]
    if name not in globals():
        fields = [field for field, _ in ffi.typeof(kind).fields if not field.startswith("reserved")]
        made = namedtuple(name, fields)  # type: ignore[misc]
        made.__module__ = __name__
        made.__doc__ = f"``{kind}`` of the C header, which tells what each field means."
        globals()[name] = made
    return globals()[name]


def _plain_name(kind: Any) -> str:
    return kind.cname.removeprefix("struct ")


def record(struct: Any) -> Any:
    """A struct's values; what is 0 or 1 becomes a bool."""
    kind = ffi.typeof(struct)
    made = type_of(_plain_name(kind.item if kind.kind == "pointer" else kind))
    return made(*(_value(field, getattr(struct, field)) for field in made._fields))


def _value(field: str, value: Any) -> Any:
    if field in _YES_NO:
        return bool(value)
    if isinstance(value, ffi.CData) and ffi.typeof(value).kind == "struct":
        if _plain_name(ffi.typeof(value)) == "bvx_lattice":
            from ._lattice import Lattice

            return Lattice._of(value)
        return record(value)
    return plain(value)
