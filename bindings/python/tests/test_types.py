"""Types: the words of options are the library's, checkers find wrong uses, and every public name has a known type."""

import inspect
import os
import re
import subprocess
import sys
import textwrap
from typing import get_args

import pytest
from conftest import public_names

import bitvox
from bitvox import _field, _grid, _levels, _octree, _run, _sections, _stages, _volume, _words

LISTS = {
    "Fill": _run.FILLS, "Sign": _run.SIGN_RULES, "RepairSign": _run.REPAIR_SIGNS, "Interpolation": _field.EDGES, "FaceRule": ("separate", "join"),
    "Mode": _stages.MODES, "Operation": _stages.OPERATIONS, "Method": _levels.METHODS, "SmoothMethod": ("sinc", "taubin"), "Vertices": _levels.VERTICES, "Topology": _levels.TOPOLOGY,
    "ErrorKind": _levels.ERROR_KINDS, "Thin": ("shell", "keep", "drop"), "ThinCheck": _stages.THIN_CHECKS,
    "Caps": _sections.CAPS, "Touching": _sections.TOUCHING, "Crossings": _sections.CROSSINGS, "Reduce": _grid.RULES,
    "DistanceSide": _grid.DISTANCE_SIDES,
    "Beyond": _grid.BEYONDS, "Side": _grid.SIDES, "Axis": ("x", "y", "z"), "Order": ("xyz", "zyx"),
    "Frame": _volume.FRAMES, "Direction": _octree._DIRECTIONS, "Resampling": ("linear", "nearest"), "FloatName": ("float32", "float64"),
    "BooleanFill": ("auto", "parity", "nonzero", "vote", "winding"),
}


def test_words_are_the_librarys():
    mine = {name: get_args(kind) for name, kind in vars(_words).items() if get_args(kind) and name[0].isupper()}
    assert {name: sorted(words) for name, words in mine.items()} == {name: sorted(words) for name, words in LISTS.items()}


def test_words_are_taken():
    """What a literal says, the call takes; what it does not say is refused."""
    solid = bitvox.voxelize(([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]), resolution=12)
    mesh = solid.surface()
    for fill in get_args(_words.BooleanFill):
        assert bitvox.boolean(mesh, mesh, "union", resolution=16, fill=fill).n_faces
    for fill in set(get_args(_words.Fill)) - set(get_args(_words.BooleanFill)):
        with pytest.raises(bitvox.Error):
            bitvox.boolean(mesh, mesh, "union", resolution=16, fill=fill)
    for rule in get_args(_words.Reduce):
        solid.downsample(2, rule)
    for side in get_args(_words.DistanceSide):
        for beyond in get_args(_words.Beyond):
            solid.distance(side, beyond=beyond)
    for sign in get_args(_words.RepairSign):
        bitvox.repair(mesh, resolution=12, sign=sign)


def test_no_option_of_words_is_plain_text():
    """An option whose docstring lists words in quotes is a Literal, not any text."""
    plain = []
    for name in public_names(bitvox):
        thing = getattr(bitvox, name)
        methods = [thing] if inspect.isfunction(thing) else [v for v in vars(thing).values() if inspect.isfunction(v)] if isinstance(thing, type) else []
        for function in methods:
            for option, parameter in inspect.signature(function).parameters.items():
                if str(parameter.annotation).partition(" ")[0] == "str" and isinstance(parameter.default, str) and parameter.default:
                    plain.append(f"{name}.{function.__name__}.{option}")
    assert plain == []


RIGHT = """
    import numpy as np
    import bitvox
    from bitvox import big, formats, reports

    solid: bitvox.Grid = bitvox.voxelize("a.ply", resolution=8, fill="parity", mode="solid")
    mesh: bitvox.Mesh = solid.surface()
    certificate: reports.Certificate = mesh.check()
    closed: bool = certificate.closed
    levels: bitvox.Levels = bitvox.lod(mesh, triangles=(20, 10), method="collapse")
    first: bitvox.Mesh = levels[0]
    volume = bitvox.Volume(np.zeros((3, 3, 3)), center0=(0, 0, 0), frame="lps")
    total: float = float(volume.array.sum()) + float(solid.to_numpy().sum())
    low, high = mesh.bounds
    width: float = high[0] - low[0]
    mask: bitvox.Grid = formats.read_nifti("a.nii", threshold=1)
    lazy: big.Volume = big.voxelize("a.ply", resolution=8)
    field = bitvox.field(mesh, sign="winding")
    surface: bitvox.Mesh = field.surface(interpolation="tangent")
    many: list[bitvox.Mesh] = bitvox.simplify(mesh, triangles=(20, 10), strict=True)
    inside: bool = solid[1, 2, 3]
    told: tuple[str, bool, int, float] = solid.report.fill, levels[0].report.met, mesh.report.holes, levels[0].report.distance.mean
    least: float = volume.report.least
    fine: bitvox.Grid = bitvox.voxelize(mesh, resolution=(8, 8, 9))
    sums: int = sum(one.value for one in volume.labels())
    nearest: int = int(solid.distance(nearest=True)[1].max()) + int(field.to_numpy().shape[0]) + int(solid.components()["voxels"][0])


    def load(path: str) -> bitvox.Mesh:
        return bitvox.read(path)


    def solid_of(path: str) -> bitvox.Grid:
        return bitvox.read(path).crop()


    def fewer(given: bitvox.Mesh) -> bitvox.Mesh:
        return given.simplify(triangles=500)


"""
WRONG = ["bitvox.voxelise('x')", "bitvox.does_not_exist", "bitvox.voxelize('x', fill='partiy')", "bitvox.voxelize('x', mode='hollow')", "solid.surface().sav('x')",
         "bitvox.boolean('a', 'b', 'minus')", "solid.downsample(2, 'some')", "bitvox.lod('x', method='fast')", "bitvox.check('x').close", "solid.distance('left')",
         "bitvox.from_sections('x', caps='round')", "bitvox.repair('x', sign='normal')", "bitvox.Volume([1], frame='las')", "bitvox.field('x').surface(interpolation='best')",
         "solid.to_numpy('yxz')", "bitvox.slice_mesh('x', axis='w')", "solid.hollow(1.0, drain_side='down')", "bitvox.surface(solid, face_rule='none')", "bitvox.simplify('x', open='shell')",
         "bitvox.read('x').sav()", "mesh.simplify(triangles=5).fac", "mesh.simplify(triangles=(5, 4)).faces", "volume.labels()[0].valu", "solid[0, 0, 0].shape",
         "solid.distance().shap", "field.to_numpy().shap", "bitvox.repair('x', mesure=True)", "bitvox.lod('x', edge_samples='2')", "mesh.simplify(topolgy='keep')",
         "bitvox.boolean('a', 'b', 'union', thin='fat')", "solid.surface(bogus=1)",
         "solid.report.boundry", "mesh.report.mett", "levels[0].report.certificat", "volume.report.leest", "bitvox.voxelize('x', resolution='64')"]


HEAD = textwrap.dedent(RIGHT)
# What cffi gives is Any, so values that come from there are not looked at in the package; all else is strict. The types of VTK would take
# mypy four fifths of its time.
SETTINGS = """[mypy]
strict = True
[mypy-bitvox.*]
warn_return_any = False
warn_unused_ignores = False
disallow_untyped_decorators = False
[mypy-pyvista.*,vtkmodules.*]
follow_imports = skip
"""


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    """What mypy finds in the package and in uses of it, by one run: most of its time goes into the types of others."""
    pytest.importorskip("mypy")
    folder = tmp_path_factory.mktemp("types")
    (folder / "mypy.ini").write_text(SETTINGS)
    (folder / "use.py").write_text(HEAD + "".join(f"_{i} = {line}\n" for i, line in enumerate(WRONG)))
    return subprocess.run([sys.executable, "-m", "mypy", "--no-error-summary", "--config-file", "mypy.ini", "--cache-dir", "cache", "-p", "bitvox", "-m", "use"],
                          capture_output=True, text=True, check=False, cwd=folder).stdout


def test_mypy_takes_right_uses_and_finds_wrong_ones(found):
    start = HEAD.count("\n")
    lines = {int(n) for n in re.findall(r"^use\.py:(\d+): error", found, flags=re.M)}
    assert lines == {start + 1 + i for i in range(len(WRONG))}, found


def test_the_package_itself(found):
    assert "use.py:" in found
    assert not [line for line in found.splitlines() if not line.startswith("use.py:")], found


def test_every_public_type_is_known(tmp_path):
    pytest.importorskip("pyright")
    folder = os.path.dirname(sys.executable)  # it looks for packages where the first python of PATH has them
    found = subprocess.run([sys.executable, "-m", "pyright", "--ignoreexternal", "--verifytypes", "bitvox"], capture_output=True, text=True, check=False,
                           cwd=tmp_path, env={**os.environ, "PATH": folder + os.pathsep + os.environ["PATH"], "VIRTUAL_ENV": os.path.dirname(folder)})
    if "completeness score" not in found.stdout or "No py.typed" in found.stdout:
        pytest.skip("pyright does not run here")
    assert "Type completeness score: 100%" in found.stdout, found.stdout
