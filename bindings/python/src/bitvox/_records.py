"""C structs that calls fill, as the named tuples of `bitvox.reports`."""

from __future__ import annotations

from typing import Any

from ._arrays import plain
from ._calls import call
from ._lattice import Lattice
from ._run import FILL_REASONS, INSIDE_RULES, ffi, name_of


def _plain_name(kind: Any) -> str:
    return kind.cname.removeprefix("struct ")


def record(struct: Any) -> Any:
    """A struct's values; what is 0 or 1 becomes a bool, a rule's number its name."""
    kind = ffi.typeof(struct)
    made = call("report_class", _plain_name(kind.item if kind.kind == "pointer" else kind))
    return made(*(_value(field, wanted, _field(struct, field)) for field, wanted in made.__annotations__.items()))


def _field(struct: Any, name: str) -> Any:
    return getattr(struct if hasattr(struct, name) else struct.box, name)


# Fields that hold the number of a rule: the prefix of its constants, and their names.
_RULES = {"sign": ("BVX_FILL_", INSIDE_RULES), "fill": ("BVX_FILL_", INSIDE_RULES), "fill_reason": ("BVX_FILL_REASON_", FILL_REASONS)}


def _value(field: str, wanted: Any, value: Any) -> Any:
    if wanted is bool:
        return bool(value)
    if wanted is str:
        return name_of(value, *_RULES[field])
    if isinstance(value, ffi.CData) and ffi.typeof(value).kind == "struct":
        if _plain_name(ffi.typeof(value)) == "bvx_lattice":
            return Lattice._of(value)
        if field == "distance" and value.samples == 0:
            return None  # it was not measured
        return record(value)
    return plain(value)
