"""Meshes that are read in parts: the bits of the whole."""

import os
import struct

import numpy as np
import pytest
from conftest import REPOSITORY

import bitvox

pytest.importorskip("dask")
from bitvox import big  # noqa: E402
from bitvox.big import stream  # noqa: E402

KNOT = REPOSITORY / "fixtures" / "knot.ply"
pytestmark = [pytest.mark.skipif(not KNOT.is_file(), reason="fixtures/knot.ply is not here"), pytest.mark.filterwarnings("ignore::bitvox.ResultWarning")]


def big_endian(mesh, path):
    """Doubles, and properties that others write beside the ones that count."""
    head = f"ply\nformat binary_big_endian 1.0\ncomment c\nelement vertex {mesh.n_vertices}\n" + "".join(f"property double {a}\n" for a in "xyz")
    head += f"property uchar red\nelement face {mesh.n_faces}\nproperty uchar flags\nproperty list uchar int vertex_index\nend_header\n"
    points = np.zeros(mesh.n_vertices, [("at", ">f8", 3), ("red", "u1")])
    points["at"] = mesh.vertices
    faces = np.zeros(mesh.n_faces, [("flags", "u1"), ("n", "u1"), ("v", ">i4", 3)])
    faces["n"], faces["v"] = 3, mesh.faces
    path.write_bytes(head.encode() + points.tobytes() + faces.tobytes())


@pytest.mark.parametrize("kind", ["ply", "stl", "big.ply"])
@pytest.mark.parametrize("options", [{"chunks": (64, 16, 7)}, {"chunks": 24, "fill": "nonzero", "padding": 3}, {"chunks": 500, "mode": "conservative"}])
def test_bits_are_those_of_the_whole(kind, options, tmp_path, monkeypatch):
    monkeypatch.setattr(stream, "BLOCK", 1000)
    mesh, path = bitvox.read(KNOT), tmp_path / f"a.{kind}"
    mesh = bitvox.Mesh(np.asarray(mesh.vertices, "f8") + 1e-9 * (kind == "big.ply"), mesh.faces)
    big_endian(mesh, path) if kind == "big.ply" else bitvox.write(bitvox.Mesh(mesh.vertices.astype("f4"), mesh.faces), path)
    volume = big.voxelize(path, resolution=61, spill=tmp_path / "columns", **options)
    rules = {name: options[name] for name in options if name != "chunks"}
    rules = rules if "mode" in rules else {"fill": "parity", **rules}
    whole = bitvox.voxelize(path, resolution=61, **rules)
    assert volume.lattice == whole.lattice and volume.compute() == whole
    times = {one.name: one.stat().st_mtime_ns for one in (tmp_path / "columns").iterdir()}
    again = big.voxelize(path, resolution=61, spill=tmp_path / "columns", **options)  # sorted once
    assert again.__dask_keys__() == volume.__dask_keys__() and {one.name: one.stat().st_mtime_ns for one in (tmp_path / "columns").iterdir()} == times
    other = big.voxelize(path, resolution=50, spill=tmp_path / "columns", **options)
    assert other.compute() == bitvox.voxelize(path, resolution=50, **rules)


def test_what_is_refused(tmp_path):
    mesh = bitvox.read(KNOT)

    def wrong(name, data, match, error=bitvox.FormatError, **options):
        (tmp_path / name).write_bytes(data)
        with pytest.raises(error, match=match):
            big.voxelize(tmp_path / name, resolution=16, spill=tmp_path / "columns", **options)

    def ply(faces, count=3, vertices=3, listed="vertex_indices", more=b"", at=(0.0, 1.0, 2.0)):
        head = f"ply\nformat binary_little_endian 1.0\nelement vertex {vertices}\nproperty float x\nproperty float y\nproperty float z\nelement face {len(faces)}\nproperty list uchar int {listed}\nend_header\n"
        return head.encode() + struct.pack("<9f", *(at * 3)) + b"".join(struct.pack(f"<B{len(face)}i", count, *face) for face in faces) + more

    wrong("a.ply", b"ply\nformat ascii 1.0\nelement vertex 0\nelement face 0\nend_header\n", "binary PLY")
    wrong("b.obj", b"v 0 0 0\n", "neither")
    wrong("c.stl", bytes(80) + struct.pack("<I", 9) + bytes(100), "neither")
    wrong("d.ply", ply([(0, 1, 5)]), "corner beyond its 3 vertices")
    wrong("e.ply", ply([(0, 1, -1)]), "corner beyond")
    wrong("f.ply", ply([(0, 1, 2)], count=4), "no triangles")
    wrong("g.ply", ply([(0, 1, 2)], vertices=999), "ends before its 999 rows")
    wrong("h.ply", ply([(0, 1, 2)], listed="texcoord"), "list of texcoord")
    wrong("i.ply", ply([(0, 1, 2)], at=(float("nan"), 1.0, 2.0)), "NaN")
    wrong("j.ply", ply([]), "has no triangles", bitvox.ArgumentError)
    wrong("k.ply", ply([(0, 1, 2)]), "looks at the whole mesh", bitvox.ArgumentError, fill="winding")
    with pytest.raises(bitvox.ArgumentError, match="in a file"):
        big.voxelize(mesh, resolution=16, spill=tmp_path / "columns")
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "notes").write_text("kept")
    with pytest.raises(FileExistsError, match="other files"):
        big.voxelize(KNOT, resolution=16, spill=tmp_path / "mine")
    assert os.listdir(tmp_path / "mine") == ["notes"]
