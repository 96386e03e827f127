"""The same bytes as the program's, where BITVOX names it."""

import inspect
import os
import re
import subprocess

import pytest
from conftest import REPOSITORY, more_options

import bitvox

PROGRAM = os.environ.get("BITVOX", "")
KNOT = REPOSITORY / "fixtures" / "knot.ply"

pytestmark = pytest.mark.skipif(not (os.path.isfile(PROGRAM) and KNOT.is_file()), reason="BITVOX names no program here")


def program(*arguments):
    found = subprocess.run([PROGRAM, *map(str, arguments), "--quiet"], capture_output=True, text=True, check=False)
    assert found.returncode == 0, found.stderr


# Options of all commands that take a volume, which is an object of its own in Python.
VOLUME = [bitvox.Volume.surface, bitvox.read_volume]
OF_VOLUMES = {"range": bitvox.Volume.threshold, "label": bitvox.Volume.label, "sample-type": "dtype", "big-endian": "dtype", "skip": "offset",
              "voxel-size": "spacing", "keep-largest": bitvox.Grid.keep, "least-part": bitvox.Grid.keep}
OF_MESHES = {"output-origin": bitvox.write}
# Options of the program that a function of Python has under another name, or that are functions or methods of their own.
NAMES = {
    "voxelize": ([bitvox.voxelize, bitvox.voxelize_points, bitvox.field, bitvox.surface, *VOLUME], {"origin": "corner", "value-type": "dtype", "no-sharp": "sharp", "segments": bitvox.write_labels, **OF_MESHES, **OF_VOLUMES}),
    "lod": ([bitvox.lod, *VOLUME], {"attributes": "attribute_weight", "keep-vertices": "vertices", "no-sharp": "sharp", "normals": bitvox.write, **OF_MESHES, **OF_VOLUMES}),
    "simplify": ([bitvox.simplify], {"attributes": "attribute_weight", "keep-vertices": "vertices", "normals": bitvox.write, **OF_MESHES}),
    "repair": ([bitvox.repair], {"normals": bitvox.write, "no-sharp": "sharp", **OF_MESHES}),
    "hull": ([bitvox.hull], {"normals": bitvox.write, "no-sharp": "sharp", **OF_MESHES}),
    "check": ([bitvox.inspect], {}),
    "refine": ([bitvox.refine], {"states": bitvox.Octree.expand, "expand": bitvox.Octree.expand, "halvings": "levels", **OF_MESHES}),
    "sections": ([bitvox.from_sections, bitvox.read, bitvox.Sections.bodies], {"block-model": None, "block": None, **OF_MESHES}),
    "slice": ([bitvox.slice_mesh], {}),
    "faces": ([bitvox.faces, bitvox.voxelize, *VOLUME], {"origin": "corner", **OF_MESHES, **OF_VOLUMES}),
    "fill": ([bitvox.Grid.fill, bitvox.find_seed, bitvox.find_pockets, bitvox.simplify], {"seed": "seeds", "add-shell": bitvox.Grid.__or__, **OF_MESHES}),
    "components": ([bitvox.Grid.components, bitvox.Grid.keep, bitvox.simplify], {**OF_MESHES, "seed": "seeds", "keep-largest": "largest", "fill-cavities": bitvox.Grid.fill_cavities}),
    "labels": ([bitvox.Volume.surfaces, bitvox.read_volume], {"staircase": "smooth", "only": bitvox.Surfaces, "names": bitvox.read_segments, "window": bitvox.Volume.window, "normals": bitvox.write, "sample-type": "dtype", "big-endian": "dtype",
                                                              "skip": "offset", "voxel-size": "spacing", **OF_MESHES}),
    "compare": ([bitvox.compare], {}),
    "morph": ([bitvox.Grid.dilate, bitvox.Grid.hollow, bitvox.Grid.distance, bitvox.voxelize, bitvox.surface, bitvox.simplify],
              {"origin": "corner", "value-type": "dtype", "no-sharp": "sharp", "neighbourhood": "connectivity", **OF_MESHES}),
    "boolean": ([bitvox.boolean], {"spacing": bitvox.Lattice, "resample": bitvox.Grid.resample, "no-sharp": "sharp", **OF_MESHES}),
    "convert": ([bitvox.read, bitvox.dumps, *VOLUME], {"expand": bitvox.Octree.expand, **OF_MESHES, **OF_VOLUMES}),
    "info": ([bitvox.read, bitvox.read_volume, bitvox.Mesh.measure], {"crossings": bitvox.Mesh.crossings, "measure": bitvox.Mesh.measure, "sample-type": "dtype", "big-endian": "dtype", "skip": "offset",
                                               "voxel-size": "spacing"}),
    "render": ([bitvox.render, *VOLUME], {"from": "from_", "fill": bitvox.voxelize, "close-gaps": bitvox.voxelize, "voxels": bitvox.voxelize, "states": bitvox.Octree.expand,
                                 "expand": bitvox.Octree.expand, **OF_VOLUMES}),
}
OF_THE_PROGRAM = {"format", "json", "quiet", "help", "help-all", "output-dir", "up", "input-up", "quantize"}  # files, how they are read and written, and reports


def test_every_command_is_known_here():
    text = subprocess.run([PROGRAM, "help"], capture_output=True, text=True, check=True).stdout
    assert set(re.findall(r"^  ([a-z]+)  ", text, flags=re.M)) == set(NAMES)


@pytest.mark.parametrize("command", NAMES)
def test_options_have_the_programs_names(command):
    text = subprocess.run([PROGRAM, command, "--help-all"], capture_output=True, text=True, check=True).stdout
    functions, others = NAMES[command]
    text = text.replace("--colour", "--color")  # American here
    known = {name.replace("_", "-") for f in functions for name in (*inspect.signature(f).parameters, *getattr(more_options(f), "__annotations__", ()))}
    options = set(re.findall(r"^  --([a-z-]+)", text, flags=re.M)) - OF_THE_PROGRAM
    assert {"threads", "memory-limit", "progress"} <= options <= known | set(others), sorted(options - known - set(others))
    for option, other in others.items():
        assert option in options and (not isinstance(other, str) or other.replace("_", "-") in known), option


@pytest.mark.parametrize("options", [
    {"resolution": 100}, {"resolution": 40, "fill": "vote"}, {"spacing": 0.05, "padding": 2}, {"spacing": 0.07, "corner": (-1.5, -2, -0.75)}, {"resolution": 50, "mode": "thin"},
    {"resolution": 64, "fill": "flood", "close_gaps": 1}, {"resolution": 30, "window": (3, 4, 5, 20, 21, 9)}])
def test_voxelize(tmp_path, options):
    words = []
    for name, value in options.items():
        words += ["--" + {"corner": "origin"}.get(name, name).replace("_", "-"), ",".join(map(str, value)) if isinstance(value, tuple) else value]
    program("voxelize", KNOT, "-o", tmp_path / "a.bvx", *words)
    assert bitvox.dumps(bitvox.voxelize(KNOT, **options), "bvx") == (tmp_path / "a.bvx").read_bytes()


@pytest.mark.parametrize("sharp", [None, True])
def test_voxels_as_a_mesh(tmp_path, sharp):
    program("voxelize", KNOT, "-o", tmp_path / "a.ply", "--resolution", 60, *(["--sharp"] if sharp else []))
    grid = bitvox.voxelize(KNOT, resolution=60, padding=1)
    made = bitvox.field(KNOT, lattice=grid.lattice, half_width=2, features=True).surface(grid=grid, sharp=sharp)
    assert bitvox.dumps(made, "ply") == (tmp_path / "a.ply").read_bytes()
    program("voxelize", KNOT, "-o", tmp_path / "b.ply", "--resolution", 60, "--mode", "conservative")
    shell = bitvox.voxelize(KNOT, resolution=60, padding=1, mode="conservative")
    assert bitvox.dumps(shell.surface(), "ply") == (tmp_path / "b.ply").read_bytes()


def words_of(options):
    """Options of Python as those of the program."""
    words = []
    for name, value in options.items():
        name = name.replace("_", "-")
        words += [("--" if value else "--no-") + name] if isinstance(value, bool) else ["--" + name, ",".join(map(str, value)) if isinstance(value, tuple) else value]
    return words


@pytest.mark.parametrize("options", [
    {}, {"triangles": (2000, 500)}, {"error": ("0.1%", 0.05)}, {"error": "0.7%", "error_kind": "max"}, {"count": 2, "even": 0.01},
    {"triangles": 900, "solid": True, "sharp": True}, {"triangles": 900, "outer_hull": True, "sign": "vote", "sharp": False, "least_part": 9},
    {"triangles": (2000, 500), "method": "edge-ratio"}, {"levels": (40, 10), "method": "coverage"}, {"levels": (40, 10)},
    {"triangles": 900, "collapse": 3, "threshold": 0.4, "fill": "nonzero"}])
def test_lod(tmp_path, options):
    program("lod", KNOT, "-o", tmp_path / "l_%d.ply", *words_of(options))
    made = bitvox.lod(KNOT, **options)
    assert len(made) == len(list(tmp_path.iterdir()))
    for i, level in enumerate(made):
        assert bitvox.dumps(level, "ply") == (tmp_path / f"l_{i}.ply").read_bytes()


@pytest.mark.parametrize("options", [{}, {"triangles": 700, "close_gaps": 2}, {"error": "0.3%", "sharp": True, "shell": 3}])
def test_hull(tmp_path, options):
    program("hull", KNOT, "-o", tmp_path / "a.ply", "--resolution", 40, *words_of(options))
    assert bitvox.dumps(bitvox.hull(KNOT, resolution=40, **options), "ply") == (tmp_path / "a.ply").read_bytes()


@pytest.mark.parametrize("options", [{}, {"triangles": 700}, {"error": "0.3%", "even": 0.001}])
def test_simplify(tmp_path, options):
    program("simplify", KNOT, "-o", tmp_path / "a.ply", *words_of(options))
    assert bitvox.dumps(bitvox.simplify(KNOT, **options), "ply") == (tmp_path / "a.ply").read_bytes()


def test_render_faces_refine(tmp_path):
    program("render", KNOT, "-o", tmp_path / "a.png", "--size", "200x150", "--cut", "z=0", "--from", "1,2,3")
    assert bitvox.render(KNOT, size=(200, 150), cut={"z": 0.0}, from_=(1, 2, 3)).png() == (tmp_path / "a.png").read_bytes()
    program("refine", KNOT, "-o", tmp_path / "a.vtu", "--halvings", "3", "--states", "surface")
    assert bitvox.dumps(bitvox.refine(KNOT, levels=3), "vtu", states="surface") == (tmp_path / "a.vtu").read_bytes()


@pytest.mark.parametrize("options", [{}, {"sharp": True}, {"shell": 3, "least_part": 5, "interpolation": "vector", "sign": "vote"}, {"triangles": 800}, {"thin": "drop"},
                                     {"error": "0.2%"}])
def test_repair(tmp_path, options):
    program("repair", KNOT, "-o", tmp_path / "a.ply", "--resolution", 60, *words_of(options))
    assert bitvox.dumps(bitvox.repair(KNOT, resolution=60, **options), "ply") == (tmp_path / "a.ply").read_bytes()


@pytest.mark.parametrize("options", [{}, {"half_width": 0}, {"half_width": 1.5, "sign": "normal"}, {"padding": 1}, {"window": (3, 4, 5, 20, 21, 9)}])
def test_field(tmp_path, options):
    words = []
    for name, value in options.items():
        words += ["--" + name.replace("_", "-"), ",".join(map(str, value)) if isinstance(value, tuple) else value]
    program("voxelize", KNOT, "-o", tmp_path / "a.vti", "--mode", "field", "--resolution", 30, *words)
    assert bitvox.dumps(bitvox.field(KNOT, resolution=30, **options), "vti") == (tmp_path / "a.vti").read_bytes()


@pytest.mark.parametrize("options", [{}, {"caps": "taper"}, {"crossings": "paper", "grid": (20, 30), "subdivide": 0},
                                     {"error": "0.3%"}])
def test_slice_and_sections(tmp_path, options):
    program("slice", KNOT, "-o", tmp_path / "a.csl", "--spacing", 0.2, "--axis", "y")
    sections = bitvox.slice_mesh(KNOT, spacing=0.2, axis="y")
    assert bitvox.dumps(sections, "csl") == (tmp_path / "a.csl").read_bytes()
    words = []
    for name, value in options.items():
        words += ["--" + name, "x".join(map(str, value)) if isinstance(value, tuple) else value]
    program("sections", tmp_path / "a.csl", "-o", tmp_path / "a.ply", *words)
    assert bitvox.dumps(bitvox.from_sections(tmp_path / "a.csl", **options), "ply") == (tmp_path / "a.ply").read_bytes()


@pytest.mark.parametrize("options", [{"resolution": 100}, {"resolution": 100, "levels": 3}, {"base": 5, "levels": 4, "adaptive": 0.01}])
def test_refine(tmp_path, options):
    names = {"levels": "halvings"}
    program("refine", KNOT, "-o", tmp_path / "a.bvx", *[w for name, value in options.items() for w in ("--" + names.get(name, name), value)])
    assert bitvox.dumps(bitvox.refine(KNOT, **options), "bvx") == (tmp_path / "a.bvx").read_bytes()


@pytest.fixture()
def grids(tmp_path):
    """Two grids of one lattice, and their files."""
    a = bitvox.voxelize(KNOT, resolution=70, padding=3)
    b = bitvox.Grid.from_numpy(a.to_numpy()[::-1, :, ::-1], lattice=a.lattice)
    a.save(tmp_path / "a.bvx")
    b.save(tmp_path / "b.bvx")
    return a, b


@pytest.mark.parametrize("action, options", [("dilate", {"steps": 3, "connectivity": 18}), ("erode", {"radius": 0.25, "beyond": "set"}), ("open", {"connectivity": 26}),
                                             ("close", {"radius": 0.3}), ("hollow", {"thickness": 0.2, "drain": 0.12, "drain_side": "y-high"})])
def test_morph(tmp_path, grids, action, options):
    words = [w for name, value in options.items() for w in ("--" + {"connectivity": "neighbourhood"}.get(name, name).replace("_", "-"), value)]
    program("morph", action, tmp_path / "a.bvx", "-o", tmp_path / "c.bvx", *words)
    if "beyond" in options:
        options = {**options, "beyond": options["beyond"] == "set"}
    made = getattr(grids[0], action)(**options)
    assert made != grids[0] and bitvox.dumps(made, "bvx") == (tmp_path / "c.bvx").read_bytes()


def test_distances(tmp_path, grids):
    program("morph", "distance", tmp_path / "a.bvx", "-o", tmp_path / "d.npy", "--side", "signed", "--beyond", "empty", "--value-type", "f64")
    mine = grids[0].distance("signed", beyond="empty", dtype="float64")
    theirs = bitvox.read_volume(tmp_path / "d.npy").array
    assert mine.min() < 0 < mine.max() and (mine == theirs).all() and theirs.dtype == "f8"


@pytest.mark.parametrize("operation, combined", [("union", "__or__"), ("intersection", "__and__"), ("difference", "__sub__"), ("xor", "__xor__")])
def test_boolean(tmp_path, grids, operation, combined):
    a, b = grids
    program("boolean", operation, tmp_path / "a.bvx", tmp_path / "b.bvx", "-o", tmp_path / "c.bvx")
    assert bitvox.dumps(getattr(a, combined)(b), "bvx") == (tmp_path / "c.bvx").read_bytes()
    other = bitvox.Mesh(bitvox.read(KNOT).vertices + [0.3, 0.2, 0.1], bitvox.read(KNOT).faces)
    other.save(tmp_path / "other.ply")
    program("boolean", operation, KNOT, tmp_path / "other.ply", "-o", tmp_path / "c.ply", "--resolution", 50, "--fill", "nonzero")
    mesh = bitvox.boolean(KNOT, tmp_path / "other.ply", operation, resolution=50, fill="nonzero")
    assert mesh.n_faces > 0 and bitvox.dumps(mesh, "ply") == (tmp_path / "c.ply").read_bytes()
    program("boolean", operation, KNOT, tmp_path / "other.ply", "-o", tmp_path / "c.ply", "--resolution", 50, "--triangles", 700)
    small = bitvox.boolean(KNOT, tmp_path / "other.ply", operation, resolution=50, triangles=700)
    assert bitvox.dumps(small, "ply") == (tmp_path / "c.ply").read_bytes()


def test_volume(tmp_path, grids):
    near = grids[0].distance("signed")
    values = (near * 1000).astype("<i2")
    values.T.tofile(tmp_path / "a.raw")
    words = [tmp_path / "a.raw", "--shape", ",".join(map(str, values.shape)), "--sample-type", "i16", "--voxel-size", "0.5,0.5,1"]
    volume = bitvox.read_volume(tmp_path / "a.raw", shape=values.shape, dtype="<i2", spacing=(0.5, 0.5, 1))
    assert (volume.array == values).all()
    program("voxelize", *words, "-o", tmp_path / "b.bvx", "--range=-200,-50")
    assert bitvox.dumps(volume.threshold(-200, -50), "bvx") == (tmp_path / "b.bvx").read_bytes() and volume.report.inside > 0
    program("voxelize", *words, "-o", tmp_path / "b.ply", "--level", 20, "--below")
    assert bitvox.dumps(volume.surface(20, below=True), "ply") == (tmp_path / "b.ply").read_bytes()
    program("voxelize", *words, "-o", tmp_path / "b.ply", "--level", 20, "--below", "--triangles", 900)
    assert bitvox.dumps(volume.surface(20, below=True, triangles=900), "ply") == (tmp_path / "b.ply").read_bytes()
