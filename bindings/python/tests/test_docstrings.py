"""Docstrings are numpydoc's, and the example of each public name runs and prints what it says."""

import doctest
import importlib
import inspect
import os
import re
import shutil

import numpy as np
import pytest
from conftest import REPOSITORY, public_names

import bitvox

MODULES = ("bitvox", "bitvox.formats", "bitvox.big")
NEEDS = {"big.": ("dask", "zarr"), "to_neuroglancer": ("DracoPy",), "import trimesh": ("trimesh",), "to_trimesh": ("trimesh",), "to_pyvista": ("pyvista",), "to_open3d": ("open3d",), "to_meshio": ("meshio",), "nifti": ("nibabel",), "images(": ("PIL",), "segmentation": ("highdicom",), "rtstruct": ("pydicom",), ".nii": ("nibabel",)}


def public():
    """Functions, classes and their own methods, by name."""
    for module in MODULES:
        for name in public_names(importlib.import_module(module)):
            thing = getattr(importlib.import_module(module), name)
            if inspect.ismodule(thing):
                continue
            yield f"{module}.{name}", thing
            if isinstance(thing, type) and not issubclass(thing, (Exception, tuple)):
                for member, value in vars(thing).items():
                    value = getattr(value, "__func__", value)
                    if not member.startswith("_") and inspect.isfunction(value):
                        yield f"{module}.{name}.{member}", value


THINGS = dict(public())
NAMES = [name for name in THINGS if name.count(".") == (2 if name.startswith(("bitvox.formats", "bitvox.big")) else 1)]
WITH_EXAMPLES = [name for name, thing in THINGS.items() if ">>> " in (thing.__doc__ or "")]


def test_every_public_name_has_an_example():
    assert [name for name in NAMES if name not in WITH_EXAMPLES] == []
    assert [name for name in THINGS if name not in WITH_EXAMPLES] == []  # methods too
    skipped = [name for name in WITH_EXAMPLES if "+SKIP" in THINGS[name].__doc__]
    assert len(skipped) <= 7  # files that only other programs write, and windows


@pytest.mark.parametrize("name", WITH_EXAMPLES)
def test_example(name, tmp_path):
    text = THINGS[name].__doc__
    for word, modules in NEEDS.items():
        if word in text.partition("Examples\n")[2] or word in name:
            for module in modules:
                pytest.importorskip(module)
    knot = REPOSITORY / "fixtures" / "knot.ply"
    if "knot.ply" in text:
        if not knot.is_file():
            pytest.skip("fixtures/knot.ply is not here")
        shutil.copy(knot, tmp_path)
    test = doctest.DocTestParser().get_doctest(text, {"bitvox": bitvox, "np": np}, name, None, 0)
    said = []
    before = os.getcwd()
    os.chdir(tmp_path)
    try:
        found = doctest.DocTestRunner(optionflags=doctest.NORMALIZE_WHITESPACE).run(test, out=said.append)
    finally:
        os.chdir(before)
    assert (found.attempted or "+SKIP" in text) and not found.failed, "".join(said)


@pytest.mark.parametrize("name", list(THINGS))
def test_sections_are_numpydocs(name):
    text = inspect.cleandoc(THINGS[name].__doc__ or "")
    assert not re.search(r"^(Args|Attributes|Returns|Raises):\s*$", text, flags=re.M)
    docscrape = pytest.importorskip("numpydoc.docscrape")
    parsed = docscrape.NumpyDocString(text)
    told = {one.strip().lstrip("*") for entry in parsed["Parameters"] for one in entry.name.split(",")}
    thing = THINGS[name]
    if inspect.isfunction(thing) and not any(p.kind is p.VAR_KEYWORD for p in inspect.signature(thing).parameters.values()):
        assert told <= set(inspect.signature(thing).parameters), told - set(inspect.signature(thing).parameters)
    assert all(entry.desc for entry in parsed["Parameters"])
