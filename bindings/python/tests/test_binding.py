"""The binding against the header it is made from."""

import inspect
import pydoc
import re
import sys
from pathlib import Path

import pytest
from conftest import more_options, public_names

import bitvox
from bitvox import _native

PACKAGE = Path(bitvox.__file__).parent
PROJECT = Path(__file__).resolve().parent.parent
lib, ffi = _native.lib, _native.ffi

# Functions that Python has no need to call: contexts are made and dropped by each call.
NOT_NEEDED = {
    "bvx_context_threads", "bvx_memory_used", "bvx_memory_peak", "bvx_memory_reset_peak",
    "bvx_format_of_name",  # Python looks at the ending itself, for it knows more formats
    "bvx_mesh_view_of",  # views are made of Python's arrays
    "bvx_grid_bound",  # grids are made by the library
    "bvx_lattice_fit",  # bvx_lattice_fit_with has all choices
    "bvx_last_message",  # bvx_last_error has it in parts
}


@pytest.fixture(scope="module")
def csource():
    pytest.importorskip("pcpp")
    if not (PROJECT / "csource.py").is_file():
        pytest.skip("the build files are not beside the tests")
    sys.path.insert(0, str(PROJECT))
    try:
        import csource

        return csource
    finally:
        sys.path.remove(str(PROJECT))


def test_package_under_test_is_the_installed_one():
    assert PROJECT not in PACKAGE.parents


def test_every_function_of_the_header_is_bound_or_not_implemented(csource):
    header = csource.prepare()
    bound = {name for name in dir(lib) if name.startswith("bvx_")}
    missing = set(csource.missing(header))
    assert bound == set(csource.declared(header)) - missing
    if missing:
        pytest.skip("declared, but not in the library yet: " + ", ".join(sorted(missing)))


def layout(kind):
    return [(name, field.type.cname.replace("struct ", "")) for name, field in kind.fields]


def test_structs_and_constants_are_those_of_the_header(csource):
    from cffi import FFI

    fresh = FFI()
    fresh.cdef(csource.cdef(csource.prepare()))
    typedefs, _, _ = fresh.list_types()
    compared = 0
    for name in typedefs:
        if name.endswith("_fn"):
            continue
        kind = fresh.typeof(name)
        if kind.kind == "struct" and kind.fields:
            mine = ffi.typeof(name)
            assert layout(kind) == layout(mine), name
            compared += 1
    assert compared > 30
    text = csource.declarations(csource.prepare())
    names = set(re.findall(r"\bBVX_[A-Z0-9_]+\b", text)) - {"BVX_API", "BVX_STATIC_API"}
    assert names and all(hasattr(lib, name) for name in names)


def test_public_functions_that_python_cannot_reach():
    source = "\n".join(path.read_text(encoding="utf-8") for path in PACKAGE.rglob("*.py"))
    called = set(re.findall(r"\bbvx_\w+", source))
    glue = set(re.findall(r"bvxpy_free_(\w+)", source))
    called |= {f"bvx_{thing}_free" for thing in glue}
    unreachable = {name for name in dir(lib) if name.startswith("bvx_")} - called - NOT_NEEDED
    assert unreachable == set()
    assert NOT_NEEDED <= {name for name in dir(lib)}


def test_arithmetic_is_the_librarys_own():
    assert lib.bvx_context_fault(lib.BVX_VERSION, ffi.NULL) == ffi.NULL


def test_version():
    assert bitvox.__version__ == f"{lib.BVX_VERSION_MAJOR}.{lib.BVX_VERSION_MINOR}.{lib.BVX_VERSION_PATCH}"


def test_every_status_is_an_exception():
    from bitvox._errors import BY_CODE

    names = re.findall(r"\bBVX_ERR_[A-Z]+|\bBVX_CANCELLED", "\n".join(dir(lib)))
    assert {getattr(lib, name) for name in names} == set(BY_CODE)
    for code, kind in BY_CODE.items():
        assert getattr(lib, kind.name) == code and issubclass(kind, bitvox.Error)


def test_everything_public_has_a_docstring():
    bare = []
    for name in public_names(bitvox):
        thing = getattr(bitvox, name)
        if not thing.__doc__:
            bare.append(name)
        if isinstance(thing, type) and thing.__module__.startswith("bitvox"):
            for member, value in vars(thing).items():
                if not member.startswith("_") and (callable(value) or isinstance(value, property)) and not value.__doc__:
                    bare.append(f"{name}.{member}")
    assert bare == []


def test_typed():
    assert (PACKAGE / "py.typed").is_file()


def test_reports_are_the_headers(csource):
    """Named tuples with all fields of the structs, each with the header's words."""
    from bitvox import reports

    header = csource.prepare()
    assert (PACKAGE / "reports.py").read_text(encoding="utf-8") == csource.reports(header)
    for name, made in reports.BY_STRUCT.items():
        fields = [field for field, _ in ffi.typeof(name).fields if not field.startswith("reserved")]
        if "box" in fields:  # its corners
            fields[fields.index("box"):fields.index("box") + 1] = ["low", "high"]
        assert list(made._fields) == fields and all(f"\n    {field}\n" in made.__doc__ for field in fields), name
    found = bitvox.check(([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]))
    assert type(found) is reports.Certificate and found.closed is False and found.oriented is True


def public_callables():
    """Functions, classes and methods that are part of the interface, by name."""
    import importlib

    for module in ("bitvox", "bitvox.formats", "bitvox.big"):
        for name in public_names(importlib.import_module(module)):
            thing = getattr(importlib.import_module(module), name)
            yield f"{module}.{name}", thing
            if isinstance(thing, type) and thing.__module__.startswith("bitvox") and not issubclass(thing, (Exception, tuple)):
                for member, value in vars(thing).items():
                    value = getattr(value, "__func__", value)
                    if not member.startswith("_") and inspect.isfunction(value):
                        yield f"{module}.{name}.{member}", value


def test_signatures_have_at_most_twelve_keywords_and_help_is_short():
    functions = {name: thing for name, thing in public_callables() if inspect.isfunction(thing)}
    keywords = {name: [p.name for p in inspect.signature(f).parameters.values() if p.kind is p.KEYWORD_ONLY] for name, f in functions.items()}
    assert {name: len(words) for name, words in keywords.items() if len(words) > 12} == {}
    assert len(pydoc.render_doc(bitvox).splitlines()) < 1500
    listed = {name: more for name, f in functions.items() if (more := more_options(f))}
    assert {more.__name__ for more in listed.values()} == {name for name in public_names(bitvox) if name.endswith("Options")}
    for name, more in listed.items():  # each option stands in one place, is told there, and named by the function
        assert not set(keywords[name]) & set(more.__annotations__)
        beside = getattr(bitvox, (re.findall(r"beside .*`(\w+Options)`", more.__doc__) or [more.__name__])[0])
        assert [option for option in more.__annotations__ if not re.search(rf"\b{option}\b", more.__doc__ + beside.__doc__)] == []
        apart = bitvox.SimplifyOptions.__annotations__ if name == "bitvox.lod" else {}
        assert [option for option in more.__annotations__ if option not in apart and f"``{option}``" not in functions[name].__doc__] == []


def test_wrong_names_are_refused_with_the_nearest():
    body = ([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
    for call, wrong, meant in ((bitvox.repair, "shel", "shell"), (bitvox.repair, "mesure", "measure"), (bitvox.lod, "edge_sample", "edge_samples"),
                               (bitvox.simplify, "attribute_weigth", "attribute_weight"), (bitvox.voxelize, "closegaps", "close_gaps"),
                               (bitvox.field, "halfwidth", "half_width"), (bitvox.render, "backgroud", "background"),
                               (bitvox.from_sections, "crosings", "crossings"), (bitvox.Mesh(*body).simplify, "tringles", "triangles")):
        with pytest.raises(TypeError, match=rf"unexpected keyword argument '{wrong}'. Did you mean '{meant}'\?"):
            call(*(() if hasattr(call, "__self__") else (body,)), **{wrong: 1})
    with pytest.raises(TypeError, match="unexpected keyword argument 'zzz'$"):
        bitvox.boolean(body, body, "union", zzz=1)
    with pytest.raises(TypeError, match=r"repair takes no ratio: give triangles=round\(ratio \* mesh.n_faces\)"):
        bitvox.repair(body, ratio=0.1)


def test_docstrings_tell_every_option():
    limits = {"self", "cls", "threads", "memory_limit", "progress", "owner"}  # told once, by settings; owner: not for users
    untold = []
    for name, thing in public_callables():
        if not inspect.isfunction(thing) and not (isinstance(thing, type) and "__init__" in vars(thing)):
            continue
        text = (thing.__doc__ or "") + (thing.__init__.__doc__ or "" if isinstance(thing, type) else "")
        untold += [f"{name}: {p}" for p in inspect.signature(thing).parameters if p not in limits and not re.search(rf"\b{p}\b", text)]
    assert untold == []
