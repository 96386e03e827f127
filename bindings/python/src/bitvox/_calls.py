"""The table of calls: what classes offer as methods and modules above them do.

Modules stand in layers, and none imports one above itself. A class knows what it holds; what is made of it, files, pictures and
levels among them, is known further up. Those functions enter themselves here under their names, and methods reach them by
name, so that each exists once and no ring of imports is needed. ``tests/test_layers.py`` holds both.
"""

from __future__ import annotations

import importlib
from typing import Any, Callable, TypeVar

Function = TypeVar("Function", bound=Callable[..., Any])

TABLE: dict[str, Callable[..., Any]] = {}

# Calls of parts that need an optional extra, or that many programs never need: their module is imported by the first call, which keeps
# `import bitvox` short.
LATER = {
    "read_other": ".formats.other",
    "read_nifti_volume": ".formats.nifti",
    "read_dicom_volume": ".formats.dicom",
    "read_cloud": ".formats.clouds",
    "read_by_library": ".formats.volumes",
    "array_of_npz": ".formats.volumes",
    "mesh_bytes": ".formats.meshes",
    "volume_bytes": ".formats.volumes",
    "report_class": ".reports",
    "unpacking": "._packed",
    "packed": "._packed",
}


def entered(function: Function) -> Function:
    """Put a function into the table, under its own name."""
    TABLE[function.__name__] = function
    return function


def call(name: str, *arguments: Any, **options: Any) -> Any:
    """Call the function of this name."""
    if name not in TABLE:
        TABLE[name] = getattr(importlib.import_module(LATER[name], __package__), name)
    return TABLE[name](*arguments, **options)
