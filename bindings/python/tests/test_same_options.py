"""One answer to one question, option by option: whatever an option of the program does to a file, the argument of its call in Python does
to the same bytes.

``ROWS`` has, for each command, lines of words and the call that makes the same. A row's files are compared byte by byte, and every option
that a command's help lists stands in a row, or in ``ELSEWHERE`` with where it is tested. Needs the program, named by BITVOX.
"""

import io
import json
import re
import subprocess

import numpy as np
import pytest
from test_same_bytes import COMMANDS, FIXTURES, PROGRAM, Folder, needs_program

import bitvox

KNOT, TERRAIN, QUARRY, BALL = (FIXTURES / name for name in ("knot.ply", "terrain.ply", "terrain_quarry.ply", "ball.xyz"))
WAVES, LABELS = FIXTURES / "waves.nhdr", FIXTURES / "labels.npy"

# What changes no file, or which file it is.
ELSEWHERE = {
    "-o": "each row has it", "--output-dir": "tests/program/test_files.sh", "--format": "tests/program/test_files.sh",
    "--threads": "test_running.py", "--memory-limit": "test_running.py", "--json": "test_same_bytes.py", "--progress": "test_running.py",
    "--quiet": "each row has it", "--help": "tests/program/test_commands.sh", "--help-all": "tests/program/test_program.sh",
    "--up": "tests/program/test_files.sh", "--input-up": "tests/program/test_files.sh", "--quantize": "tests/program/test_files.sh",
}
# Of one command: they look and report, or write a second file, which test_same_bytes.py or tests/program compare.
REPORTS = {
    "repair": {"--measure"},
    "lod": {"--samples"}, "simplify": {"--samples"},
    "sections": {"--block-model", "--block"}, "compare": {"--samples", "--seed"}, "info": {"--crossings", "--measure", "--density", "--resolution"},
    "check": {"--walls", "--gaps", "--density", "--up", "--resolution", "--most"},
}


# Two squares on planes that cross.
CROSSED = ("CSLC\n2 1\n1 4 1 0 0 1 0\n0 0 0 4 0 0 4 4 0 0 4 0\n4 1 0 1 2 3\n"
           "2 4 1 1 0 0 -2\n2 0 -2 2 4 -2 2 4 2 2 0 2\n4 1 0 1 2 3\n")


class Files(Folder):
    """A folder of inputs for all rows."""

    def __init__(self, path):
        super().__init__(path)
        self.small = bitvox.simplify(KNOT, triangles=1500)
        self.small.save(self / "small.ply")
        moved = bitvox.Mesh(self.small.vertices + np.array([0.5, 0.25, 0.125], np.float32), self.small.faces)
        moved.save(self / "moved.ply")
        # Two bodies apart, the second the smaller one.
        pair = np.concatenate([self.small.vertices, self.small.vertices * np.float32(0.5) + np.float32(6)])
        bitvox.Mesh(pair, np.concatenate([self.small.faces, np.asarray(self.small.faces) + len(self.small.vertices)])).save(self / "pair.ply")
        colors = np.stack([(self.small.vertices[:, a] > 0) * 200 for a in range(3)], axis=1).astype(np.uint8)
        bitvox.Mesh(self.small.vertices, self.small.faces, colors=colors).save(self / "colored.ply")
        bitvox.Mesh(self.small.vertices, self.small.faces[40:]).save(self / "torn.ply")
        bitvox.slice_mesh(self.small, spacing=0.25).save(self / "c.csl")
        bitvox.slice_mesh(self.small, positions=[0.1]).save(self / "one.csl")
        bitvox.slice_mesh(self.small, spacing=0.25).save(self / "c.csv")
        (self / "cross.csl").write_text(CROSSED)
        (self / "apart.csl").write_text(CROSSED.replace("2 4 -2 2 4 2", "2 6 -2 2 6 2"))
        self.tree = bitvox.refine(self.small, base=5, levels=3)
        self.tree.save(self / "t.bvx")
        self.samples = np.add.outer(np.add.outer(np.arange(12), np.arange(9) * 2), np.arange(7) * 3).astype(">u2")  # [x, y, z]
        (self / "names.txt").write_text("1  One  10 20 30 0\n7  Seven\n")
        (self / "s.raw").write_bytes(b"head" + self.samples.transpose(2, 1, 0).tobytes())

    def joint(self, spacing):
        """The lattice around both meshes of a boolean, with a voxel on every side."""
        boxes = [bitvox.read(self / name).bounds for name in ("small.ply", "moved.ply")]
        low, high = np.min([b[0] for b in boxes], axis=0), np.max([b[1] for b in boxes], axis=0)
        return bitvox.Lattice.fit_box(low, high, spacing=spacing, padding=1)

    @property
    def raw(self):
        return bitvox.read_volume(self / "s.raw", shape=(12, 9, 7), dtype=">u2", offset=4, spacing=(1, 2, 0.5))


RAW = "s.raw --shape 12,9,7 --sample-type u16 --big-endian --skip 4 --voxel-size 1,2,0.5"
BOX = ((2, 3, 4), (18, 18, 8))


def knot(at, **options):
    """The surface of a solid with its vertices on the mesh, as voxelize writes it."""
    return bitvox.surface(bitvox.voxelize(at.small, resolution=24, padding=1), mesh=at.small, **options)


def chosen(at, **options):
    """Parts of the voxels of a volume."""
    return bitvox.read_volume(WAVES).threshold(120).keep(**options)


def npy_of(array):
    """An array as a file of NumPy's own, x fastest as the program has it."""
    file = io.BytesIO()
    np.save(file, np.asfortranarray(array))
    return file.getvalue()


def named(at):
    """Labels with the names and colors of a table."""
    volume = bitvox.read_volume(LABELS)
    volume.segments = bitvox.read_segments(at / "names.txt")
    return volume


def segments(at):
    """Voxels with the colors of a mesh."""
    mesh, path = bitvox.read(at / "colored.ply"), at / "segments.nrrd"
    grid = bitvox.voxelize(mesh, resolution=16)
    bitvox.write_labels(path, grid, *bitvox.label_voxels(mesh, grid))
    return path.read_bytes()


def written(surfaces, path):
    """The file that labels are saved in."""
    surfaces.save(path)
    return path.read_bytes()


def only(thing, **options):
    """A result whose file is written with these options."""
    return thing, options


# For each command: words, the ending of the output, and what is in it: a thing that has files, one with options of its file (only), or one
# for each number of the output's name.
ROWS = {
    "voxelize": (
        ("KNOT --resolution 24 --padding 2 --window 2,3,4,20,21,12", "bvx", lambda at: bitvox.voxelize(KNOT, resolution=24, padding=2, window=BOX)),
        ("colored.ply --resolution 16 --segments", "nrrd", segments),
        ("KNOT --spacing 0.25 --origin -5,-5,-3", "bvx", lambda at: bitvox.voxelize(KNOT, spacing=0.25, corner=(-5, -5, -3))),
        ("torn.ply --resolution 24 --fill flood --close-gaps 2", "bvx",
         lambda at: bitvox.voxelize(at / "torn.ply", resolution=24, fill="flood", close_gaps=2)),
        ("torn.ply --resolution 24 --fill vote --add-shell --check-thin always", "bvx",
         lambda at: bitvox.voxelize(at / "torn.ply", resolution=24, fill="vote", add_shell=True, check_thin="always")),
        ("TERRAIN --resolution 24 --fill below --base 3 --up z", "bvx",
         lambda at: bitvox.voxelize(TERRAIN, resolution=24, fill="below", base=3, up="z")),
        ("TERRAIN --resolution 24 --fill below --second QUARRY", "bvx",
         lambda at: bitvox.voxelize(TERRAIN, resolution=24, fill="below", second=QUARRY)),
        ("small.ply --resolution 20 --mode field --half-width 2 --sign winding --value-type f64", "npy",
         lambda at: bitvox.field(at.small, resolution=20, half_width=2, sign="winding", dtype="float64")),
        ("small.ply --resolution 20 --mode field --vectors", "npy", lambda at: only(bitvox.field(at.small, resolution=20), vectors=True)),
        ("BALL --resolution 20 --minimum 2", "bvx", lambda at: bitvox.voxelize_points(BALL, resolution=20, minimum=2)),
        ("BALL --resolution 20 --body", "bvx", lambda at: bitvox.voxelize_points(BALL, resolution=20, body=True)),
        ("small.ply --resolution 24 --sharp --output-origin 1,2,3", "ply", lambda at: only(knot(at, sharp=True), origin=(1, 2, 3))),
        ("small.ply --resolution 24 --no-sharp --triangles 300", "ply", lambda at: knot(at, sharp=False).simplify(triangles=300)),
        ("small.ply --resolution 24 --error 0.5% --error-kind max", "ply", lambda at: knot(at).simplify(error="0.5%", error_kind="max")),
        ("WAVES --level 120 --keep-largest 1", "bvx", lambda at: chosen(at, largest=1)),
        ("WAVES --level 120 --least-part 40", "bvx", lambda at: chosen(at, at_least=40)),
        ("WAVES --level 60 --below", "bvx", lambda at: bitvox.read_volume(WAVES).threshold(high=60)),
        ("WAVES --range 60,120", "bvx", lambda at: bitvox.read_volume(WAVES).threshold(60, 120)),
        ("LABELS --label 2", "bvx", lambda at: bitvox.read_volume(LABELS).label(2)),
        (f"{RAW} --level 20", "bvx", lambda at: at.raw.threshold(20)),
    ),
    "lod": (
        ("small.ply --error 0.5%,2% --error-kind max --strict", "ply", lambda at: bitvox.lod(at.small, error=("0.5%", "2%"), error_kind="max", strict=True)),
        ("small.ply --count 2 --even 0.01 --normals --output-origin 1,2,3", "ply",
         lambda at: [only(level, normals=True, origin=(1, 2, 3)) for level in bitvox.lod(at.small, count=2, even=0.01)]),
        ("colored.ply --triangles 400,100 --attributes 5", "ply",
         lambda at: bitvox.lod(at / "colored.ply", triangles=(400, 100), attribute_weight=5)),
        ("colored.ply --triangles 400 --solid --carry", "ply", lambda at: bitvox.lod(at / "colored.ply", triangles=400, solid=True, carry=True)),
        ("torn.ply --triangles 400 --lock-border", "ply", lambda at: bitvox.lod(at / "torn.ply", triangles=400, lock_border=True)),
        ("torn.ply --triangles 400 --topology simplify", "ply", lambda at: bitvox.lod(at / "torn.ply", triangles=400, topology="simplify")),
        ("colored.ply --triangles 400 --keep-vertices", "ply", lambda at: bitvox.lod(at / "colored.ply", triangles=400, vertices="kept")),
        ("small.ply --triangles 400 --solid --resolution 30 --sign winding --shell 2 --least-part 9 --least-cavity 5 --sharp", "ply",
         lambda at: bitvox.lod(at.small, triangles=400, solid=True, resolution=30, sign="winding", shell=2, least_part=9, least_cavity=5, sharp=True)),
        ("pair.ply --triangles 400 --keep-largest 1", "ply", lambda at: bitvox.lod(at / "pair.ply", triangles=400, keep_largest=1)),
        ("small.ply --triangles 400 --solid --resolution 30 --outer-hull --no-sharp", "ply",
         lambda at: bitvox.lod(at.small, triangles=400, solid=True, resolution=30, outer_hull=True, sharp=False)),
        ("small.ply --levels 16,8 --resolution 40 --padding 1 --method coverage --threshold 0.4 --fill flood --close-gaps 1", "ply",
         lambda at: bitvox.lod(at.small, levels=(16, 8), resolution=40, padding=1, method="coverage", threshold=0.4, fill="flood", close_gaps=1)),
        ("small.ply --triangles 400 --method edge-ratio --edge-samples 3 --collapse 2", "ply",
         lambda at: bitvox.lod(at.small, triangles=400, method="edge-ratio", edge_samples=3, collapse=2)),
        ("WAVES --level 60 --below --levels 16 --keep-largest 1", "ply",
         lambda at: bitvox.lod(bitvox.read_volume(WAVES).threshold(high=60).keep(largest=1), levels=16)),
        ("WAVES --range 60,120 --levels 16", "ply", lambda at: bitvox.lod(bitvox.read_volume(WAVES).threshold(60, 120), levels=16)),
        ("LABELS --label 2 --levels 16", "ply", lambda at: bitvox.lod(bitvox.read_volume(LABELS).label(2), levels=16)),
        (f"{RAW} --level 20 --levels 5", "ply", lambda at: bitvox.lod(at.raw.threshold(20), levels=5)),
    ),
    "simplify": (
        ("small.ply --error 1% --error-kind max --strict --normals --output-origin 1,2,3", "ply",
         lambda at: [only(level, normals=True, origin=(1, 2, 3)) for level in bitvox.simplify(at.small, error=("1%",), error_kind="max", strict=True)]),
        ("colored.ply --triangles 400 --attributes 5 --even 0.01", "ply",
         lambda at: bitvox.simplify(at / "colored.ply", triangles=(400,), attribute_weight=5, even=0.01)),
        ("torn.ply --count 2 --lock-border", "ply", lambda at: bitvox.simplify(at / "torn.ply", count=2, lock_border=True)),
        ("torn.ply --count 2 --topology simplify", "ply", lambda at: bitvox.simplify(at / "torn.ply", count=2, topology="simplify")),
        ("colored.ply --triangles 400 --keep-vertices", "ply", lambda at: bitvox.simplify(at / "colored.ply", triangles=(400,), vertices="kept")),
    ),
    "repair": (
        ("torn.ply --resolution 30 --sign vote --interpolation scalar --sharp --thin shell --shell 2 --least-part 9 --least-cavity 5", "ply",
         lambda at: bitvox.repair(at / "torn.ply", resolution=30, sign="vote", interpolation="scalar", sharp=True, thin="shell", shell=2, least_part=9, least_cavity=5)),
        ("pair.ply --resolution 60 --keep-largest 1", "ply", lambda at: bitvox.repair(at / "pair.ply", resolution=60, keep_largest=1)),
        ("small.ply --if-needed --normals --output-origin 1,2,3", "ply", lambda at: only(bitvox.repair(at.small, if_needed=True), normals=True, origin=(1, 2, 3))),
        ("colored.ply --resolution 30 --no-sharp --carry", "ply", lambda at: bitvox.repair(at / "colored.ply", resolution=30, sharp=False, carry=True)),
        ("torn.ply --resolution 30 --triangles 500", "ply", lambda at: bitvox.repair(at / "torn.ply", resolution=30, triangles=500)),
        ("torn.ply --resolution 30 --error 0.5% --error-kind max", "ply",
         lambda at: bitvox.repair(at / "torn.ply", resolution=30, error="0.5%", error_kind="max")),
    ),
    "hull": (
        ("torn.ply --resolution 30 --close-gaps 2 --interpolation scalar --sharp --shell 3 --least-part 9", "ply",
         lambda at: bitvox.hull(at / "torn.ply", resolution=30, close_gaps=2, interpolation="scalar", sharp=True, shell=3, least_part=9)),
        ("torn.ply --enclose 4% --triangles 300", "ply", lambda at: bitvox.hull(at / "torn.ply", enclose="4%", triangles=300)),
        ("pair.ply --resolution 60 --keep-largest 1 --no-sharp", "ply", lambda at: bitvox.hull(at / "pair.ply", resolution=60, keep_largest=1, sharp=False)),
        ("colored.ply --resolution 30 --count 2 --carry", "ply", lambda at: list(bitvox.hull(at / "colored.ply", resolution=30, count=2, carry=True))),
        ("small.ply --resolution 30 --triangles 500 --normals --output-origin 1,2,3", "ply",
         lambda at: only(bitvox.hull(at.small, resolution=30, triangles=500), normals=True, origin=(1, 2, 3))),
        ("torn.ply --resolution 30 --error 0.5% --error-kind max", "ply", lambda at: bitvox.hull(at / "torn.ply", resolution=30, error="0.5%", error_kind="max")),
    ),
    "refine": (
        ("small.ply --base 5 --halvings 3 --window 8,8,2,24,24,10 --outer-levels 1", "bvx",
         lambda at: bitvox.refine(at.small, base=5, levels=3, window=((8, 8, 2), (16, 16, 8)), outer_levels=1)),
        ("small.ply --resolution 40 --halvings 3 --adaptive 0.05", "bvx", lambda at: bitvox.refine(at.small, resolution=40, levels=3, adaptive=0.05)),
        ("small.ply --base 5 --halvings 3 --states surface --expand 2", "npy", lambda at: at.tree.expand(2, states="surface")),
        ("small.ply --base 5 --halvings 3 --output-origin 1,2,3", "ply", lambda at: only(at.tree.surface(), origin=(1, 2, 3))),
    ),
    "sections": (
        ("c.csl --spacing 0.2 --caps open --subdivide 3 --output-origin 1,2,3", "ply",
         lambda at: only(bitvox.from_sections(at / "c.csl", spacing=0.2, caps="open", subdivide=3), origin=(1, 2, 3))),
        ("one.csl --grid 20x30 --thickness 0.5 --caps taper", "ply", lambda at: bitvox.from_sections(at / "one.csl", grid=(20, 30), thickness=0.5, caps="taper")),
        ("c.csl --grid 20x30 --mend --crossings paper --label 1", "ply",
         lambda at: bitvox.from_sections(at / "c.csl", grid=(20, 30), mend=True, crossings="paper", label=1)),
        ("c.csl --cells 16 --label all --touching shared", "ply",
         lambda at: {int(name): body for name, body in bitvox.read(at / "c.csl").bodies(touching="shared", cells=16).items()}),
        ("cross.csl --cells 16", "ply", lambda at: bitvox.from_sections(at / "cross.csl", cells=16)),
        ("apart.csl --cells 16 --agree 2.5", "ply", lambda at: bitvox.from_sections(at / "apart.csl", cells=16, agree=2.5)),
        ("c.csv --grid 20x30 --close-gap 5", "ply", lambda at: bitvox.from_sections(bitvox.read(at / "c.csv", close_gap=5), grid=(20, 30))),
        ("c.csl --grid 20x30 --triangles 300", "ply", lambda at: bitvox.from_sections(at / "c.csl", grid=(20, 30), triangles=300)),
        ("c.csl --grid 20x30 --error 1% --error-kind max", "ply", lambda at: bitvox.from_sections(at / "c.csl", grid=(20, 30), error="1%", error_kind="max")),
    ),
    "slice": (("small.ply --axis y --spacing 0.3", "csl", lambda at: bitvox.slice_mesh(at.small, axis="y", spacing=0.3)),),
    "faces": (
        ("small.ply --resolution 20 --padding 1 --fill flood --close-gaps 1 --merge --output-origin 1,2,3", "ply",
         lambda at: only(bitvox.faces(bitvox.voxelize(at.small, resolution=20, padding=1, fill="flood", close_gaps=1), merge=True), origin=(1, 2, 3))),
        ("small.ply --spacing 0.25 --origin -5,-5,-3", "ply", lambda at: bitvox.faces(bitvox.voxelize(at.small, spacing=0.25, corner=(-5, -5, -3)))),
        ("WAVES --level 60 --below --keep-largest 1", "ply", lambda at: bitvox.faces(bitvox.read_volume(WAVES).threshold(high=60).keep(largest=1))),
        ("WAVES --range 60,120 --least-part 40", "ply", lambda at: bitvox.faces(bitvox.read_volume(WAVES).threshold(60, 120).keep(at_least=40))),
        ("LABELS --label 2", "ply", lambda at: bitvox.faces(bitvox.read_volume(LABELS).label(2))),
        (f"{RAW} --level 20", "ply", lambda at: bitvox.faces(at.raw.threshold(20))),
    ),
    "fill": (
        ("wall.bvx --mesh KNOT --add-shell", "bvx", lambda at: at.wall | at.wall.fill(bitvox.find_pockets(at.wall, KNOT))),
        ("wall.bvx --seed 0,0,0 --connectivity 26", "bvx", lambda at: at.wall.fill([(0, 0, 0)], connectivity=26)),
        ("wall.bvx --mesh KNOT --triangles 300 --output-origin 1,2,3", "ply",
         lambda at: only(at.wall.fill(bitvox.find_pockets(at.wall, KNOT)).surface().simplify(triangles=300), origin=(1, 2, 3))),
        ("wall.bvx --mesh KNOT --error 1% --error-kind max", "ply",
         lambda at: at.wall.fill(bitvox.find_pockets(at.wall, KNOT)).surface().simplify(error="1%", error_kind="max")),
    ),
    "components": (
        ("other.bvx --at-least 30 --connectivity 26", "bvx", lambda at: bitvox.read(at / "other.bvx").keep(at_least=30, connectivity=26)),
        ("solid.bvx --keep-largest 1 --fill-cavities", "bvx", lambda at: at.solid.keep(largest=1).fill_cavities()),
        ("solid.bvx --seed SEED", "bvx", lambda at: at.solid.keep(seeds=[tuple(at.solid.voxels()[0])])),
        ("solid.bvx --triangles 300 --output-origin 1,2,3", "ply", lambda at: only(at.solid.surface().simplify(triangles=300), origin=(1, 2, 3))),
        ("solid.bvx --error 1% --error-kind max", "ply", lambda at: at.solid.surface().simplify(error="1%", error_kind="max")),
    ),
    "compare": (), "check": (),
    "morph": (
        ("dilate small.ply --resolution 24 --padding 3 --fill flood --close-gaps 1 --steps 2 --neighbourhood 18", "bvx",
         lambda at: bitvox.voxelize(at.small, resolution=24, padding=3, fill="flood", close_gaps=1).dilate(2, connectivity=18)),
        ("erode small.ply --spacing 0.25 --origin -5,-5,-3 --radius 0.3 --beyond set", "bvx",
         lambda at: bitvox.voxelize(at.small, spacing=0.25, corner=(-5, -5, -3)).erode(radius=0.3, beyond=True)),
        ("hollow solid.bvx --thickness 0.3 --drain 0.2 --drain-side x-high", "bvx", lambda at: at.solid.hollow(0.3, drain=0.2, drain_side="x-high")),
        ("dilate small.ply --resolution 24 --padding 4 --sharp", "ply",
         lambda at: bitvox.surface(bitvox.voxelize(at.small, resolution=24, padding=4).dilate(), mesh=at.small, sharp=True)),
        ("erode small.ply --resolution 40 --padding 1 --no-sharp", "ply",
         lambda at: bitvox.surface(bitvox.voxelize(at.small, resolution=40, padding=1).erode(), mesh=at.small, sharp=False)),
        ("distance solid.bvx --side signed --value-type f64", "npy", lambda at: npy_of(at.solid.distance("signed", dtype="float64"))),
        ("dilate solid.bvx --triangles 300 --output-origin 1,2,3", "ply", lambda at: only(at.solid.dilate().surface().simplify(triangles=300), origin=(1, 2, 3))),
        ("dilate solid.bvx --error 1% --error-kind max", "ply", lambda at: at.solid.dilate().surface().simplify(error="1%", error_kind="max")),
    ),
    "boolean": (
        ("union small.ply solid.bvx --fill parity", "bvx", lambda at: bitvox.voxelize(at.small, lattice=at.solid.lattice, fill="parity") | at.solid),
        ("union small.ply moved.ply --spacing 0.25", "ply", lambda at: bitvox.boolean(at.small, at / "moved.ply", "union", lattice=at.joint(0.25))),
        ("difference small.ply moved.ply --resolution 30 --interpolation scalar --sharp --thin drop --least-part 9", "ply",
         lambda at: bitvox.boolean(at.small, at / "moved.ply", "difference", resolution=30, interpolation="scalar", sharp=True, thin="drop", least_part=9)),
        ("union small.ply moved.ply --resolution 30 --fill nonzero --no-sharp --output-origin 1,2,3", "ply",
         lambda at: only(bitvox.boolean(at.small, at / "moved.ply", "union", resolution=30, fill="nonzero", sharp=False), origin=(1, 2, 3))),
        ("union small.ply pair.ply --resolution 60 --keep-largest 1", "ply",
         lambda at: bitvox.boolean(at.small, at / "pair.ply", "union", resolution=60, keep_largest=1)),
        ("intersection small.ply moved.ply --resolution 30 --triangles 300", "ply",
         lambda at: bitvox.boolean(at.small, at / "moved.ply", "intersection", resolution=30, triangles=300)),
        ("xor small.ply moved.ply --resolution 30 --error 1% --error-kind max", "ply",
         lambda at: bitvox.boolean(at.small, at / "moved.ply", "xor", resolution=30, error="1%", error_kind="max")),
        ("union solid.bvx coarse.bvx --resample", "bvx", lambda at: at.solid | bitvox.read(at / "coarse.bvx").resample(at.solid.lattice)),
    ),
    "convert": (
        ("solid.bvx --window 5,6,7,30,31,12", "npy", lambda at: at.solid.crop(((5, 6, 7), (25, 25, 5)))),
        ("solid.bvx --keep-largest 1", "npy", lambda at: at.solid.keep(largest=1)),
        ("other.bvx --least-part 40", "npy", lambda at: bitvox.read(at / "other.bvx").keep(at_least=40)),
        ("t.bvx --states surface --expand 2", "npy", lambda at: at.tree.expand(2, states="surface")),
        ("small.ply --normals --output-origin 1,2,3", "ply", lambda at: only(at.small, normals=True, origin=(1, 2, 3))),
        ("WAVES --level 60 --below", "npy", lambda at: bitvox.read_volume(WAVES).threshold(high=60)),
        ("WAVES --range 60,120", "npy", lambda at: bitvox.read_volume(WAVES).threshold(60, 120)),
        ("LABELS --label 2", "bvx", lambda at: bitvox.read_volume(LABELS).label(2)),
        (f"{RAW} --level 20", "npy", lambda at: at.raw.threshold(20)),
    ),
    "labels": (
        ("LABELS --only 2", "ply", lambda at: bitvox.read_volume(LABELS).surfaces()[2]),
        ("LABELS --only 7 --triangles 900", "ply", lambda at: bitvox.read_volume(LABELS).surfaces(triangles=900)[7]),
        ("LABELS --only 2 --error 0.1", "ply", lambda at: bitvox.read_volume(LABELS).surfaces(error=0.1)[2]),
        ("LABELS --only 1 --staircase --background 2 --normals --output-origin 1,2,3", "ply",
         lambda at: only(bitvox.read_volume(LABELS).surfaces(background=2, smooth=False)[1], normals=True, origin=(1, 2, 3))),
        ("LABELS --only 1 --window 0,0,0,20,20,20", "ply",
         lambda at: bitvox.Volume(bitvox.read_volume(LABELS).array[:20, :20, :20], lattice=bitvox.read_volume(LABELS).lattice).surfaces()[1]),
        ("LABELS --only 1 --window 0,0,0,20,20,20 --open", "ply", lambda at: bitvox.read_volume(LABELS).window((0, 0, 0, 20, 20, 20)).surfaces(open=True)[1]),
        ("LABELS", "glb", lambda at: written(bitvox.read_volume(LABELS).surfaces(), at / "written.glb")),
        ("LABELS --names names.txt", "glb", lambda at: written(named(at).surfaces(), at / "written.glb")),
        (f"{RAW} --only LABEL", "ply", lambda at: at.raw.surfaces()[int(at.samples.max())]),
    ),
    "info": ((RAW, None, lambda at: {"least": float(at.samples.min()), "greatest": float(at.samples.max())}),),
    "render": (
        ("small.ply --size 90x60 --from 1,2,3 --up 0,1,0 --smooth --cut x=0.5", "png",
         lambda at: bitvox.render(at.small, size=(90, 60), from_=(1, 2, 3), up=(0, 1, 0), smooth=True, cut={"x": 0.5})),
        ("small.ply --size 90x60 --wireframe", "png", lambda at: bitvox.render(at.small, size=(90, 60), wireframe=True)),
        ("small.ply --size 90x60 --voxels 30 --fill flood --close-gaps 1", "png",
         lambda at: bitvox.render(bitvox.voxelize(at.small, resolution=30, fill="flood", close_gaps=1), size=(90, 60))),
        ("solid.bvx --size 90x60 --compare other.bvx", "png", lambda at: bitvox.render(at.solid, size=(90, 60), compare=bitvox.read(at / "other.bvx"))),
        ("other.bvx --size 90x60 --keep-largest 1", "png", lambda at: bitvox.render(bitvox.read(at / "other.bvx").keep(largest=1), size=(90, 60))),
        ("other.bvx --size 90x60 --least-part 40", "png", lambda at: bitvox.render(bitvox.read(at / "other.bvx").keep(at_least=40), size=(90, 60))),
        ("t.bvx --size 90x60 --states surface --expand 2", "png", lambda at: bitvox.render(at.tree.expand(2, states="surface"), size=(90, 60))),
        ("WAVES --size 90x60 --level 60 --below", "png", lambda at: bitvox.render(bitvox.read_volume(WAVES).threshold(high=60), size=(90, 60))),
        ("WAVES --size 90x60 --range 60,120", "png", lambda at: bitvox.render(bitvox.read_volume(WAVES).threshold(60, 120), size=(90, 60))),
        ("LABELS --size 90x60 --label 2", "png", lambda at: bitvox.render(bitvox.read_volume(LABELS).label(2), size=(90, 60))),
        (f"{RAW} --size 90x60 --level 20", "png", lambda at: bitvox.render(at.raw.threshold(20), size=(90, 60))),
    ),
}

NAMES = {"KNOT": KNOT, "TERRAIN": TERRAIN, "QUARRY": QUARRY, "BALL": BALL, "WAVES": WAVES, "LABELS": LABELS}


@pytest.fixture(scope="module")
def at(tmp_path_factory):
    files = Files(tmp_path_factory.mktemp("same"))
    bitvox.voxelize(KNOT, resolution=20, padding=1).save(files / "coarse.bvx")
    return files


def word_of(at, word):
    if word == "LABEL":
        return str(int(at.samples.max()))
    if word == "SEED":
        return ",".join(str(int(v)) for v in at.solid.voxels()[0])
    return str(NAMES.get(word) or (at / word if (at / word).is_file() else word))


def bytes_of(thing, ending):
    thing, options = thing if isinstance(thing, tuple) else (thing, {})
    if isinstance(thing, bytes):
        return thing
    return thing.png() if ending == "png" else bitvox.dumps(thing, ending, **options)


def numbered(made, ending):
    """Numbers of files and their bytes."""
    rows = made.items() if isinstance(made, dict) else enumerate(made)
    return {number: bytes_of(thing, ending) for number, thing in rows}


@needs_program
@pytest.mark.parametrize("command, row", [(command, i) for command in ROWS for i in range(len(ROWS[command]))])
def test_option_and_argument_write_the_same_bytes(at, command, row):
    words, ending, made = ROWS[command][row]
    mine, line = made(at), [PROGRAM, command, *(word_of(at, word) for word in words.split())]
    several = isinstance(mine, (list, dict)) and ending is not None
    out = at / f"{command}_{row}{'_%d' if several else ''}.{ending}"
    line += ["--json"] if ending is None else ["-o", str(out), "--quiet"]
    found = subprocess.run(line, capture_output=True, text=True, check=False)
    assert found.returncode == 0, found.stderr

    if ending is None:  # a report: the members that the row has
        report = json.loads(found.stdout)["samples"]
        assert {key: report[key] for key in mine} == mine
    elif several:
        theirs = {n: path.read_bytes() for n, data in numbered(mine, ending).items() if (path := at / out.name.replace("%d", str(n))).is_file()}
        assert numbered(mine, ending) == theirs and len(theirs) == len(list(at.path.glob(out.name.replace("%d", "*")))) > 0
    else:
        assert bytes_of(mine, ending) == out.read_bytes() and out.stat().st_size > 60


@needs_program
@pytest.mark.parametrize("command", COMMANDS)
def test_every_option_that_makes_output_has_a_row(command):
    text = subprocess.run([PROGRAM, command, "--help-all"], capture_output=True, text=True, check=True).stdout
    options = set(re.findall(r"^  (--?[a-z-]+)", text, flags=re.M))
    used = {word for words, _, _ in ROWS[command] for word in words.split() if word.startswith("-")} & options
    assert options - used - set(ELSEWHERE) - REPORTS.get(command, set()) == set()
