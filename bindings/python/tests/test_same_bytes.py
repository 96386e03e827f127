"""One answer to one question: each command of the program and its call in Python write the same bytes from the same input, and the
rows that the C library's golden test keeps come out of Python too.

``COMMANDS`` has a row for every command; a command without one fails. Needs the program, named by BITVOX; the golden rows do not.
"""

import json
import math
import os
import re
import subprocess

import numpy as np
import pytest
from conftest import REPOSITORY

import bitvox

PROGRAM = os.environ.get("BITVOX", "")
FIXTURES = REPOSITORY / "fixtures"
KNOT = FIXTURES / "knot.ply"

needs_program = pytest.mark.skipif(not (os.path.isfile(PROGRAM) and KNOT.is_file()), reason="BITVOX names no program here")


class Folder:
    """Files that one command writes, beside what Python makes of the same."""

    def __init__(self, path):
        self.path, self.compared = path, 0
        self.solid = bitvox.voxelize(KNOT, resolution=40, padding=2)
        self.wall = bitvox.voxelize(KNOT, resolution=40, mode="thin")
        self.solid.save(self / "solid.bvx")
        self.wall.save(self / "wall.bvx")
        (self.solid & bitvox.Grid.from_numpy(self.solid.to_numpy()[::-1], lattice=self.solid.lattice)).save(self / "other.bvx")

    def __truediv__(self, name):
        return self.path / name

    def run(self, *words, json_too=False, status=0):
        found = subprocess.run([PROGRAM, *map(str, words), "--json" if json_too else "--quiet"], capture_output=True, text=True, check=False)
        assert found.returncode == status, found.stderr
        return json.loads(found.stdout) if json_too else None

    def same(self, thing, name, format=None, **options):
        """A file of the program, and what Python writes into one of that format."""
        theirs = (self / name).read_bytes()
        mine = thing if isinstance(thing, bytes) else bitvox.dumps(thing, format or name.rpartition(".")[2], **options)
        assert mine == theirs and len(mine) > 60, name
        self.compared += 1


def voxelize(at):
    for mode in ("solid", "conservative", "thin", "sampled"):
        at.run("voxelize", KNOT, "-o", at / f"{mode}.bvx", "--mode", mode, "--resolution", 33)
        at.same(bitvox.voxelize(KNOT, mode=mode, resolution=33), f"{mode}.bvx")
    for format in ("npy", "binvox", "vox", "nrrd", "vti"):
        at.run("convert", at / "solid.bvx", "-o", at / f"a.{format}")
        at.same(bitvox.read(at / "solid.bvx"), f"a.{format}")
    at.run("voxelize", FIXTURES / "ball.xyz", "-o", at / "p.bvx", "--resolution", 20, "--body", "--close-gaps", 2)
    at.same(bitvox.voxelize_points(FIXTURES / "ball.xyz", resolution=20, body=True, close_gaps=2), "p.bvx")
    at.run("voxelize", FIXTURES / "waves.nhdr", "-o", at / "w.ply", "--level", 0.25)
    at.same(bitvox.read_volume(FIXTURES / "waves.nhdr").surface(0.25), "w.ply")
    for format in ("npy", "nrrd", "vti"):
        at.run("voxelize", KNOT, "-o", at / f"f.{format}", "--mode", "field", "--resolution", 20)
        at.same(bitvox.field(KNOT, resolution=20), f"f.{format}")


def lod(at):
    for words, options in ((("--triangles", "2000,500"), {"triangles": (2000, 500)}), (("--levels", "20,10"), {"levels": (20, 10)})):
        at.run("lod", KNOT, "-o", at / "l_%d.ply", *words)
        for i, level in enumerate(bitvox.lod(KNOT, **options)):
            at.same(level, f"l_{i}.ply")
    at.run("lod", KNOT, "-o", at / "l.glb", "--triangles", "900,100")
    bitvox.write_levels(at / "mine.glb", bitvox.lod(KNOT, triangles=(900, 100)))
    at.same((at / "mine.glb").read_bytes(), "l.glb")


def simplify(at):
    at.run("simplify", KNOT, "-o", at / "s.ply", "--error", "0.2%")
    at.same(bitvox.simplify(KNOT, error="0.2%"), "s.ply")


def hull(at):
    at.run("hull", KNOT, "-o", at / "h.stl", "--resolution", 40, "--triangles", 900)
    at.same(bitvox.hull(KNOT, resolution=40, triangles=900), "h.stl")


def labels(at):
    at.run("labels", FIXTURES / "labels.npy", "-o", at / "l_%s.ply")
    for value, mesh in bitvox.read_volume(FIXTURES / "labels.npy").surfaces().items():
        at.same(mesh, f"l_{value}.ply")
    at.run("labels", FIXTURES / "labels.npy", "-o", at / "f_%s.ply", "--triangles", 2000)
    for value, mesh in bitvox.read_volume(FIXTURES / "labels.npy").surfaces(triangles=2000).items():
        at.same(mesh, f"f_{value}.ply")


def repair(at):
    at.run("repair", KNOT, "-o", at / "r.stl", "--resolution", 40)
    at.same(bitvox.repair(KNOT, resolution=40), "r.stl")


def refine(at):
    at.run("refine", KNOT, "-o", at / "t.bvx", "--base", 5, "--halvings", 3)
    at.same(bitvox.refine(KNOT, base=5, levels=3), "t.bvx")
    at.run("convert", at / "t.bvx", "-o", at / "t.vtu")
    at.same(bitvox.read(at / "t.bvx"), "t.vtu")


def sections(at):
    bitvox.slice_mesh(KNOT, spacing=0.25).save(at / "c.csl")
    at.run("sections", at / "c.csl", "-o", at / "b.ply", "--caps", "taper", "--grid", "20x30")
    at.same(bitvox.from_sections(at / "c.csl", caps="taper", grid=(20, 30)), "b.ply")


def slices(at):
    for format, axis in (("csl", "x"), ("csv", "z")):
        at.run("slice", KNOT, "-o", at / f"c.{format}", "--axis", axis, "--spacing", 0.3)
        at.same(bitvox.slice_mesh(KNOT, axis=axis, spacing=0.3), f"c.{format}")


def faces(at):
    at.run("faces", at / "solid.bvx", "-o", at / "f.obj", "--merge")
    at.same(bitvox.faces(at.solid, merge=True), "f.obj")


def fill(at):
    at.run("fill", at / "wall.bvx", "-o", at / "i.bvx", "--mesh", KNOT)
    at.same(at.wall.fill(bitvox.find_pockets(at.wall, KNOT)), "i.bvx")


def components(at):
    at.run("components", at / "other.bvx", "-o", at / "k.bvx", "--keep-largest", 2, "--fill-cavities")
    kept = bitvox.read(at / "other.bvx").keep(largest=2).fill_cavities()
    at.same(kept, "k.bvx")
    assert kept.count > 0


def compare(at):
    found = at.run("compare", at / "solid.bvx", at / "other.bvx", json_too=True)
    mine = bitvox.compare(at.solid, bitvox.read(at / "other.bvx"))
    assert found["difference"]["only_a"] == mine.only_a > 0
    bitvox.simplify(KNOT, triangles=500).save(at / "s.ply")
    found = at.run("compare", KNOT, at / "s.ply", json_too=True)
    distances = bitvox.compare(KNOT, at / "s.ply")
    assert found["distance"]["max"] == distances.max and found["distance"]["mean"] == distances.mean
    at.compared += 1


def morph(at):
    for action, words, options in (("dilate", ("--steps", 2), {"steps": 2}), ("erode", ("--radius", 0.2), {"radius": 0.2}), ("open", (), {}),
                                   ("close", ("--neighbourhood", 26), {"connectivity": 26}), ("hollow", ("--thickness", 0.3), {"thickness": 0.3})):
        at.run("morph", action, at / "solid.bvx", "-o", at / f"{action}.bvx", *words)
        at.same(getattr(at.solid, action)(**options), f"{action}.bvx")


def boolean(at):
    for operation, made in (("union", at.solid.__or__), ("difference", at.solid.__sub__), ("xor", at.solid.__xor__), ("intersection", at.solid.__and__)):
        at.run("boolean", operation, at / "solid.bvx", at / "other.bvx", "-o", at / "g.bvx")
        at.same(made(bitvox.read(at / "other.bvx")), "g.bvx")
    knot = bitvox.read(KNOT)
    bitvox.Mesh(knot.vertices + np.array([0.5, 0.25, 0.125], np.float32), knot.faces).save(at / "moved.ply")
    at.run("boolean", "union", KNOT, at / "moved.ply", "-o", at / "m.ply", "--resolution", 30, "--fill", "winding")
    at.same(bitvox.boolean(KNOT, at / "moved.ply", "union", resolution=30, fill="winding"), "m.ply")


def convert(at):
    for format in ("stl", "obj", "off", "glb", "ply"):
        at.run("convert", KNOT, "-o", at / f"k.{format}")
        at.same(bitvox.read(KNOT), f"k.{format}")


def info(at):
    found = at.run("info", KNOT, json_too=True)["meshes"][0]
    mine = bitvox.check(KNOT)
    assert (found["volume"], found["area"], found["edges"], found["closed"]) == (mine.volume, mine.area, mine.edges, mine.closed)
    at.compared += 1


def check(at):
    found = at.run("check", KNOT, "--resolution", 40, "--walls", 0.8, "--gaps", 0.5, "--up", "x", json_too=True, status=1)["check"]
    mine = bitvox.inspect(KNOT, resolution=40, walls=0.8, gaps=0.5, up="x")
    assert found["sound"] is mine.sound and found["volume"] == mine.report.volume and found["least_thickness"] == mine.report.least_thickness
    assert [found[kind]["count"] for kind in ("wall", "gap", "cavity", "island")] == list(mine.report.found)
    assert [tuple(one["position"]) for one in found["wall"]["places"]] == [one.position for one in mine.walls]
    at.compared += 1


def render(at):
    at.run("render", KNOT, "-o", at / "p.png", "--size", "120x90", "--wireframe")
    at.same(bitvox.render(KNOT, size=(120, 90), wireframe=True).png(), "p.png")
    at.run("render", at / "solid.bvx", "-o", at / "g.png", "--size", "120x90")
    at.same(bitvox.render(at.solid, size=(120, 90)).png(), "g.png")


COMMANDS = {"voxelize": voxelize, "lod": lod, "simplify": simplify, "repair": repair, "hull": hull, "labels": labels, "refine": refine, "sections": sections, "slice": slices,
            "faces": faces, "fill": fill, "components": components, "compare": compare, "morph": morph, "boolean": boolean,
            "convert": convert, "info": info, "check": check, "render": render}


@needs_program
def test_every_command_has_a_row():
    text = subprocess.run([PROGRAM, "help"], capture_output=True, text=True, check=True).stdout
    assert set(re.findall(r"^  ([a-z]+)  ", text, flags=re.M)) == set(COMMANDS)


@needs_program
@pytest.mark.parametrize("command", COMMANDS)
def test_command_and_call_write_the_same_bytes(tmp_path, command):
    at = Folder(tmp_path)
    COMMANDS[command](at)
    assert at.compared > 0


# ---- the C library's golden rows, from Python ----


def golden(file, row):
    """The values of a golden row by their keys; of keys that stand there twice, both."""
    path = FIXTURES / "golden" / file
    if not path.is_file():
        pytest.skip("fixtures/golden is not here")
    line = next(line for line in path.read_text().splitlines() if line.split()[0] == row)
    values = {}
    for word in line.split()[1:]:
        key, _, value = word.partition("=")
        values.setdefault(key, []).append(value)
    return values


def generator(seed):
    mask = 2**64 - 1
    while True:
        seed ^= seed << 13 & mask
        seed ^= seed >> 7
        seed ^= seed << 17 & mask
        yield (seed >> 40) / 16777216.0 - 0.5


def on_circle(i, n):
    quarter = 4 * i // n
    u = 4.0 * i / n - quarter
    d = 1.0 + u * u
    a, b = (1.0 - u * u) / d, 2.0 * u / d
    return ((a, b), (-b, a), (-a, -b), (b, -a))[quarter]


@pytest.fixture(scope="module")
def torus():
    """The torus of tests/golden/shapes.h."""
    n, m, random, vertices, faces = 96, 40, generator(7), [], []
    for i in range(n):
        x, y = on_circle(i, n)
        for j in range(m):
            wobble = 1.0 + 0.25 * next(random)
            c, z = on_circle(j, m)
            vertices.append((x * (2.0 + 0.75 * c * wobble), y * (2.0 + 0.75 * c * wobble), 0.75 * z * wobble + 0.25 * x * y))
    for i in range(n):
        for j in range(m):
            i0, i1, j1 = i * m, (i + 1) % n * m, (j + 1) % m
            faces += [(i0 + j, i1 + j, i1 + j1), (i0 + j, i1 + j1, i0 + j1)]
    return bitvox.Mesh(np.array(vertices), np.array(faces, np.uint32))


def hashed(thing):
    return f"{thing.content_hash():016x}"


@pytest.mark.parametrize("row, options", [("torus_130", {"resolution": 130, "fill": "parity"}), ("torus_64_nonzero", {"resolution": 64, "fill": "nonzero"}),
                                          ("torus_130_window", {"resolution": 130, "fill": "parity", "window": ((17, 5, 3), (65, 70, 11))})])
def test_golden_solids(torus, row, options):
    want = golden("solid.txt", row)
    solid = bitvox.voxelize(torus, **options)
    assert ([str(solid.count)], [hashed(solid)]) == (want["set"], want["bits"])
    sides = ("x-low", "x-high", "y-low", "y-high", "z-low", "z-high")
    surface = solid.surface(dtype="float32")
    assert ([str(surface.n_faces)], [hashed(surface)]) == (want["triangles"], want["surface"])
    assert [hashed(solid.surface(face_rule="join", dtype="float64"))] == want["joined_f64"]
    assert [hashed(solid.surface(face_rule="join", dtype="float64", open_sides=sides, local_frame=True))] == want["open_local"]
    if "ratio24" in want:
        for method, key in (("edge-ratio", "ratio"), ("coverage", "coverage")):
            for level, n in zip(bitvox.lod(solid, levels=(24, 13, 6), method=method, dtype="float32"), (24, 13, 6)):
                assert [hashed(level)] == want[f"{key}{n}"]
        assert [hashed(bitvox.lod(solid, triangles=1500, collapse=2.5, dtype="float32")[0])] == want["collapsed"]


def test_golden_fills(torus):
    want = golden("fills.txt", "torus_90")
    for fill, (value,) in want.items():
        gaps = {"close_gaps": 1} if fill == "flood" else {}
        assert hashed(bitvox.voxelize(torus, resolution=90, fill=fill, **gaps)) == value, fill


def test_golden_octree(torus):
    want = golden("octree.txt", "torus_8_by_5")
    tree = bitvox.refine(torus, base=8, levels=5)
    data = bitvox.dumps(tree, "bvx")
    assert ([str(len(data))], [f"{bitvox.content_hash(data):016x}"]) == (want["bytes"], want["file"])
    assert [hashed(tree.surface())] == want["mesh"]


@pytest.mark.parametrize("row, dtype", [("knot_f32", "float32"), ("knot_f64", "float64")])
def test_golden_levels(row, dtype):
    want = golden("levels.txt", row)
    fine, coarse = bitvox.simplify(KNOT, triangles=(900, 120), dtype=dtype, even=0.000001)
    assert ([hashed(fine)], [hashed(coarse)]) == (want["fine"], want["coarse"])
    assert [str(fine.n_faces), str(coarse.n_faces)] == want["triangles"]


def test_golden_grid_and_hashes():
    at = np.ogrid[:130, :7, :4]
    pattern = (at[0] + 3 * at[1] + 5 * at[2]) % 11 < 4
    grid = bitvox.Grid.from_numpy(pattern, lattice=bitvox.Lattice((200, 9, 7), (0.5, 0.25, 1.0), (-1.5, 0.25, 10.0)), low=(30, 1, 2))
    want = golden("grid.txt", "pattern_in_window")
    assert ([str(grid.count)], [hashed(grid)]) == (want["set"], want["bits"])
    assert [f"{bitvox.content_hash(b''):016x}"] == golden("hash.txt", "empty")["hash"]


def test_golden_terms_are_exact():
    """The shapes are sums, products and quotients alone, so Python makes the same doubles as C."""
    assert on_circle(0, 96) == (1.0, 0.0) and all(math.isclose(x * x + y * y, 1.0) for x, y in (on_circle(i, 96) for i in range(96)))
