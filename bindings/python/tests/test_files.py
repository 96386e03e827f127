"""Files: round trips, and what goes wrong."""

import gzip
import io
import json
import os
import warnings

import numpy as np
import pytest
from conftest import ball_grid

import bitvox


@pytest.mark.parametrize("ending", ["ply", "obj", "off", "stl", "3mf", "ply.gz", "3mf.gz"])
def test_meshes_round_trip(ball, tmp_path, ending):
    path = tmp_path / f"ball.{ending}"
    ball.save(path)
    back = bitvox.read(path)
    assert back.n_faces == ball.n_faces and back.check() == ball.check()._replace() if ending != "stl" else back.check().closed
    assert bitvox.Mesh.of(path).n_faces == bitvox.Mesh.of(str(path)).n_faces == ball.n_faces
    assert sorted(os.listdir(tmp_path)) == [path.name]


def gltf(*members):
    """A triangle in a file of text whose bytes stand beside it."""
    return ('{"asset": {"version": "2.0"}, "nodes": [{"mesh": 0}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 0, "TEXCOORD_0": 1},'
            ' "material": 0}]}], "materials": [{}], "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},'
            ' {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC2"}], "bufferViews": [{"buffer": 0, "byteLength": 36}],'
            ' "buffers": [{"byteLength": 36, "uri": "sub/a%20b.bin"}]' + "".join(members) + "}")


def test_gltf_with_files_beside_it(tmp_path):
    (tmp_path / "sub").mkdir()
    (tmp_path / "sub" / "a b.bin").write_bytes(np.array([0, 0, 1, 1, 0, 0, 0, 1, 0], "<f4").tobytes())
    (tmp_path / "a.gltf").write_text(gltf())
    mesh = bitvox.read(tmp_path / "a.gltf")
    assert mesh.vertices.tolist() == [[0, 0, 1], [1, 0, 0], [0, 1, 0]] and mesh.faces.tolist() == [[0, 1, 2]]
    assert mesh.vertex_normals.tolist() == mesh.vertices.tolist() and mesh.materials.tolist() == [0] and mesh.uvs.tolist()[0] == [0, 1]
    (tmp_path / "b.gltf").write_text(gltf(', "images": [{"uri": "gone.png"}], "animations": [{}]'))
    with pytest.warns(UserWarning, match="not read: animations, images"):
        bitvox.read(tmp_path / "b.gltf")
    with pytest.raises(bitvox.FormatError, match="there is no file"):
        bitvox.loads(gltf().encode(), "gltf")
    assert bitvox.check(tmp_path / "a.gltf").triangles == 1


def test_glb_is_written(ball, tmp_path):
    ball.save(tmp_path / "ball.glb")
    assert (tmp_path / "ball.glb").read_bytes()[:4] == b"glTF"


def of_trimesh(data):
    trimesh = pytest.importorskip("trimesh")
    scene = trimesh.load(io.BytesIO(data), file_type="glb")
    return scene.to_mesh() if hasattr(scene, "to_mesh") else scene.dump(concatenate=True)


def test_glb_keeps_its_axes_unless_asked(ball):
    """As another reader gets them; vertices are in the order of the mesh, which trimesh may change."""
    assert sorted(map(tuple, of_trimesh(bitvox.dumps(ball, "glb")).vertices)) == sorted(map(tuple, np.asarray(ball.vertices, float)))
    x, y, z = np.asarray(ball.vertices, float).T
    for up, want in (("y", (x, z, -y)), ("z", (x, -z, y))):
        turned = of_trimesh(bitvox.dumps(ball, "glb", up=up))
        assert np.allclose(sorted(map(tuple, turned.vertices)), sorted(zip(*want)), atol=0) and turned.volume == pytest.approx(ball.volume)
        assert bitvox.loads(bitvox.dumps(ball, "ply", up=up), "ply").volume == pytest.approx(ball.volume)
    with pytest.raises(bitvox.ArgumentError, match="'y', 'z' or None"):
        bitvox.dumps(ball, "glb", up="x")
    with pytest.raises(bitvox.ArgumentError, match="up is for meshes"):
        bitvox.dumps(bitvox.Grid.from_numpy(ball_grid(8)), "npy", up="y")


def test_quantized_glb(ball, tmp_path):
    data = bitvox.dumps(ball, "glb", quantize=True)
    low, high = ball.bounds
    step = max(h - l for l, h in zip(low, high)) / 65535
    back = of_trimesh(data)
    assert len(data) < len(bitvox.dumps(ball, "glb")) and b"KHR_mesh_quantization" in data
    assert np.allclose(back.bounds, ball.bounds, atol=step) and back.volume == pytest.approx(ball.volume, rel=1e-4)
    assert ball.check_written("glb", quantize=True).largest_move <= step
    bitvox.write_levels(tmp_path / "levels.glb", [ball, ball], quantize=True, up="y")
    assert b"KHR_mesh_quantization" in (tmp_path / "levels.glb").read_bytes()
    for ending in ("ply", "stl", "obj", "off"):
        with pytest.raises(bitvox.UnsupportedError, match="quantize"):
            bitvox.dumps(ball, ending, quantize=True)


@pytest.mark.parametrize("ending", ["ply", "obj", "ply.gz"])
def test_normals_are_written_and_left_out_again(ball, tmp_path, ending):
    ball.save(tmp_path / f"plain.{ending}")
    ball.save(tmp_path / f"smooth.{ending}", normals=True)
    assert bitvox.read(tmp_path / f"smooth.{ending}") == bitvox.read(tmp_path / f"plain.{ending}")
    text = bitvox.dumps(ball, "obj", normals=True)
    normals = np.array([line.split()[1:] for line in text.splitlines() if line.startswith(b"vn ")], float)
    assert normals.shape == (ball.n_vertices, 3)
    np.testing.assert_allclose(normals, ball.normals()[0], atol=1e-6)


def test_normals_where_there_are_none(ball):
    assert bitvox.dumps(ball, "glb", normals=True) == bitvox.dumps(ball, "glb")
    for ending in ("stl", "off"):
        with pytest.raises(bitvox.UnsupportedError, match="normals"):
            bitvox.dumps(ball, ending, normals=True)
    with pytest.raises(bitvox.ArgumentError, match="for meshes"):
        bitvox.dumps(bitvox.Grid.from_numpy(ball_grid(8)), "npy", normals=True)


def test_levels_go_to_one_file(ball, tmp_path):
    colored = bitvox.Mesh(ball.vertices, ball.faces[::2], colors=np.full((ball.n_vertices, 4), 7, np.uint8))
    path = tmp_path / "levels.glb"
    bitvox.write_levels(path, [ball, colored, (ball.vertices, ball.faces[:5])])
    data = path.read_bytes()
    size = int.from_bytes(data[12:16], "little")
    described = json.loads(data[20 : 20 + size])
    assert [node["name"] for node in described["nodes"]] == ["level_0", "level_1", "level_2"]
    assert described["nodes"][0]["extensions"] == {"MSFT_lod": {"ids": [1, 2]}} and described["extensionsUsed"] == ["MSFT_lod"]
    assert described["scenes"] == [{"nodes": [0]}] and len(described["meshes"]) == 3
    has_colors = ["COLOR_0" in mesh["primitives"][0]["attributes"] for mesh in described["meshes"]]
    assert has_colors == [False, True, False]
    bitvox.write_levels(path, (mesh for mesh in [ball]))
    assert path.read_bytes() == bitvox.dumps(ball, "glb")


def test_levels_that_are_not_written(ball, tmp_path):
    with pytest.raises(bitvox.UnsupportedError, match="one file a level"):
        bitvox.write_levels(tmp_path / "levels.ply", [ball, ball])
    with pytest.raises(bitvox.UnsupportedError, match="one file a level"):
        bitvox.write_levels(tmp_path / "levels.npy", [ball, ball])
    with pytest.raises(bitvox.ArgumentError, match="level_count is 0"):
        bitvox.write_levels(tmp_path / "levels.glb", [])
    with pytest.raises(bitvox.EmptyError, match="level 1"):
        bitvox.write_levels(tmp_path / "levels.glb", [ball, bitvox.Mesh(ball.vertices, ball.faces[:0])])
    with pytest.raises(TypeError, match="several meshes"):
        bitvox.write_levels(tmp_path / "levels.glb", ball)
    assert not list(tmp_path.iterdir())


def test_openvdb_is_written_only(tmp_path):
    array = ball_grid(20)
    bitvox.Grid.from_numpy(array).save(tmp_path / "a.vdb")
    assert (tmp_path / "a.vdb").read_bytes()[:4] == b" BDV"
    with pytest.raises(bitvox.UnsupportedError):
        bitvox.read(tmp_path / "a.vdb")
    vdb = pytest.importorskip("pyopenvdb")
    theirs = np.zeros(array.shape, bool)
    vdb.read(str(tmp_path / "a.vdb"), "solid").copyToArray(theirs)
    assert np.array_equal(theirs, array)


def test_nanovdb_is_written_only(tmp_path):
    bitvox.Grid.from_numpy(ball_grid(20)).save(tmp_path / "a.nvdb")
    assert (tmp_path / "a.nvdb").read_bytes()[:8] == b"NanoVDB0"
    with pytest.raises(bitvox.UnsupportedError):
        bitvox.read(tmp_path / "a.nvdb")


@pytest.mark.parametrize("ending", ["npy", "binvox", "vox", "nrrd", "vti", "bvx", "nrrd.gz"])
def test_grids_round_trip(tmp_path, ending):
    grid = bitvox.Grid.from_numpy(ball_grid(20), spacing=0.5, corner=(1, 2, 3))
    path = tmp_path / f"ball.{ending}"
    grid.save(path)
    back = bitvox.read(path)
    assert back == grid and back.corner == (1, 2, 3) and back.center0 == (1.25, 2.25, 3.25)
    if ending in ("npy", "vox"):
        beside = json.loads((tmp_path / f"ball.{ending}.json").read_text())
        assert beside["origin"] == [1, 2, 3] and beside["center0"] == [1.25, 2.25, 3.25]
        os.unlink(tmp_path / f"ball.{ending}.json")
        assert bitvox.read(path).corner == (0, 0, 0)
    window = bitvox.read(path, window=(2, 3, 4, 10, 12, 14))
    assert np.array_equal(window.to_numpy(), grid.to_numpy()[2:10, 3:12, 4:14])


def test_labels_keep_materials_and_colors(tmp_path):
    path = tmp_path / "two.gltf"  # one triangle of a red material
    (tmp_path / "sub").mkdir()
    (tmp_path / "sub" / "a b.bin").write_bytes(np.array([0, 0, 1, 1, 0, 0, 0, 1, 0], "<f4").tobytes())
    path.write_text(gltf().replace('"materials": [{}]', '"materials": [{"pbrMetallicRoughness": {"baseColorFactor": [1, 0, 0, 1]}}]'))
    grid = bitvox.Grid.from_numpy(np.arange(24).reshape(2, 3, 4) % 3 > 0, spacing=0.5)
    labels, palette = bitvox.label_voxels(path, grid)
    assert np.array_equal(labels, grid.to_numpy().astype(np.uint8)) and palette[1].tolist() == [255, 0, 0, 255]
    path.write_text(path.read_text().replace('"baseColorFactor"', '"baseColorTexture": {"index": 0}, "baseColorFactor"'))
    with pytest.warns(bitvox.ResultWarning, match="textures of 1 material are not looked up"):
        assert np.array_equal(bitvox.label_voxels(path, grid)[0], labels)
    ramp = bitvox.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], colors=[[0, 0, 0], [255, 0, 0], [0, 255, 0]])
    labels, palette = bitvox.label_voxels(ramp, bitvox.Grid.from_numpy(np.ones((30, 30, 1)), spacing=1 / 30))
    assert labels.min() == 1 and labels.max() > 60 and abs(palette[labels[14, 3, 0]].astype(int) - [123, 30, 0, 255]).max() < 40
    many = np.where(grid.to_numpy(), np.arange(24).reshape(2, 3, 4), 0)
    bitvox.write_labels(tmp_path / "a.vox", grid, many, [(i, 2 * i, 255 - i) for i in range(30)])
    back, colors = bitvox.read_labels(tmp_path / "a.vox")
    assert np.array_equal(back, many) and colors[7].tolist() == [7, 14, 248, 255] and bitvox.read(tmp_path / "a.vox") == grid
    bitvox.write_labels(tmp_path / "a.nrrd", grid, many, colors)
    assert np.array_equal(bitvox.read_volume(tmp_path / "a.nrrd").to_numpy(), many)
    assert b"\nSegment1_LabelValue:=2\nSegment1_Color:=0.00784" in (tmp_path / "a.nrrd").read_bytes()
    parts = [bitvox.faces(grid, of=bitvox.Grid.from_numpy(many == i, spacing=0.5)).n_faces for i in np.unique(many)[1:]]
    assert sum(parts) == bitvox.faces(grid).n_faces
    with pytest.raises(bitvox.ArgumentError, match="neither"):
        bitvox.label_voxels(bitvox.Mesh(ramp.vertices, ramp.faces), grid)
    with pytest.raises(bitvox.ArgumentError, match="label 0"):
        bitvox.write_labels(tmp_path / "b.vox", grid, many * 0, colors)
    with pytest.raises(bitvox.ArgumentError, match="shape"):
        bitvox.write_labels(tmp_path / "b.vox", grid, many[:1], colors)
    with pytest.raises(bitvox.ArgumentError, match="palette"):
        bitvox.write_labels(tmp_path / "b.vox", grid, many, [1, 2, 3])


def test_npy_is_numpys(tmp_path):
    array = ball_grid(12)
    bitvox.Grid.from_numpy(array).save(tmp_path / "a.npy")
    assert np.array_equal(np.load(tmp_path / "a.npy"), array)
    np.save(tmp_path / "b.npy", array.astype(np.float32) * 7)
    assert np.array_equal(bitvox.read(tmp_path / "b.npy").to_numpy(), array)


def test_slices_one_by_one(tmp_path):
    grid = bitvox.Grid.from_numpy(ball_grid(20), spacing=0.5)
    with bitvox.Writer(tmp_path / "whole.bvx", grid.lattice) as writer:
        for low, high in ((0, 7), (7, 8), (8, 20)):
            writer.add(bitvox.Grid.from_numpy(grid.to_numpy()[:, :, low:high], lattice=grid.lattice, low=(0, 0, low)))
    assert (tmp_path / "whole.bvx").read_bytes() == bitvox.dumps(grid, "bvx")
    with pytest.raises(bitvox.ArgumentError, match="not given"):
        with bitvox.Writer(tmp_path / "half.bvx", grid.lattice) as writer:
            writer.add(bitvox.Grid.from_numpy(grid.to_numpy()[:, :, :7], lattice=grid.lattice))
    assert os.listdir(tmp_path) == ["whole.bvx"]


def test_what_goes_wrong(ball, tmp_path):
    with pytest.raises(FileNotFoundError):
        bitvox.read(tmp_path / "none.ply")
    with pytest.raises(bitvox.ArgumentError, match="ending"):
        bitvox.read(tmp_path / "none")
    with pytest.raises(bitvox.UnsupportedError):
        ball.save(tmp_path / "ball.npy")
    with pytest.raises(bitvox.UnsupportedError):
        bitvox.Grid.from_numpy(ball_grid(8)).save(tmp_path / "ball.ply")
    with pytest.raises(bitvox.ArgumentError):
        bitvox.loads(bitvox.dumps(ball, "ply"), "ply", window=(0, 0, 0, 1, 1, 1))
    with pytest.raises(FileNotFoundError):
        ball.save(tmp_path / "no" / "ball.ply")
    with pytest.raises(bitvox.ArgumentError):
        bitvox.voxelize(_saved(bitvox.Grid.from_numpy(ball_grid(8)), tmp_path / "g.bvx"))
    (tmp_path / "cut.ply").write_bytes(bitvox.dumps(ball, "ply")[:300])
    with pytest.raises(bitvox.FormatError):
        bitvox.read(tmp_path / "cut.ply")
    (tmp_path / "cut.obj.gz").write_bytes(gzip.compress(b"v 0 0 0\n")[:-9])
    with pytest.raises(bitvox.FormatError, match="gzip is damaged or cut short"):
        bitvox.read(tmp_path / "cut.obj.gz")
    old = (tmp_path / "cut.ply").read_bytes()
    with pytest.raises(bitvox.Error):
        bitvox.write(bitvox.Mesh(np.zeros((0, 3)), np.zeros((0, 3), int)), tmp_path / "cut.ply")
    assert (tmp_path / "cut.ply").read_bytes() == old


def _saved(thing, path):
    thing.save(path)
    return path


def test_links_and_modes_stay(ball, tmp_path):
    target = tmp_path / "real.ply"
    target.write_bytes(b"")
    os.chmod(target, 0o640)
    os.symlink(target, tmp_path / "link.ply")
    ball.save(tmp_path / "link.ply")
    assert (tmp_path / "link.ply").is_symlink() and os.stat(target).st_mode & 0o777 == 0o640
    assert bitvox.read(target).n_faces == ball.n_faces


def test_picture(ball, tmp_path):
    bitvox.render(ball, size=(20, 20)).save(tmp_path / "a.png")
    assert (tmp_path / "a.png").read_bytes()[1:4] == b"PNG"
    with pytest.raises(bitvox.ArgumentError):
        bitvox.render(ball, size=(20, 20)).save(tmp_path / "a.jpg")


def far_ball(ball):
    return bitvox.Mesh(np.asarray(ball.vertices, np.float64) / 50 + [600000, 5000000, 0], ball.faces)


def test_what_floats_would_spoil_is_refused(ball, tmp_path):
    far = far_ball(ball)
    with pytest.raises(bitvox.RangeError, match="32-bit floats move vertices"):
        far.save(tmp_path / "far.stl")
    assert os.listdir(tmp_path) == []
    far.save(tmp_path / "far.ply")
    far.save(tmp_path / "near.stl", origin=(600000, 5000000, 0))
    near = bitvox.read(tmp_path / "near.stl").check(weld=True)
    assert near.closed and near.vertices == ball.n_vertices and abs(near.low[1]) < 10
    assert bitvox.read(tmp_path / "far.ply").check().low[1] > 4e6


def test_the_report_of_a_format_is_that_of_its_file(ball, tmp_path):
    far = far_ball(ball)
    report = far.check_written("stl")
    assert not report.fits and report.spoilt > 0 and report.merged > 0 and report.largest_move > 0.1
    far.save(tmp_path / "far.stl", allow_rounding=True)
    assert bitvox.read(tmp_path / "far.stl").check(weld=True) == report.file
    assert far.check_written("ply").file == far.check() and far.check_written("ply").fits
    assert far.check_written("stl", origin=(600000, 5000000, 0)).fits
    with pytest.raises(bitvox.ArgumentError, match="origin is for meshes"):
        bitvox.dumps(bitvox.Grid.from_numpy(ball_grid(8)), "npy", origin=(0, 0, 0))


def test_triangles_that_are_not_finite_are_left_out_where_asked(tmp_path):
    text = b"v 0 0 0\nv nan 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 4 3\nf 1 2 3\nf 1 3 5\nf 1 5 4\nf 3 4 5\n"
    (tmp_path / "nan.obj").write_bytes(text)
    with pytest.raises(bitvox.RangeError, match="vertex 2 has a coordinate that is not finite"):
        bitvox.read(tmp_path / "nan.obj")
    with pytest.warns(UserWarning, match="1 triangles with a corner that is not finite left out"):
        mesh = bitvox.read(tmp_path / "nan.obj", drop_nonfinite=True)
    assert (mesh.n_vertices, mesh.n_faces) == (4, 4) and mesh.check().closed
    with pytest.raises(bitvox.ArgumentError, match="for meshes"):
        bitvox.loads(b"", "npy", drop_nonfinite=True)


@pytest.mark.parametrize("dtype", ["float32", "float64"])
@pytest.mark.parametrize("order", ["C", "F"])
def test_drop_nonfinite_of_arrays(dtype, order):
    v = np.array([[0, 0, 0], [np.nan, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [0, np.inf, 0]], dtype, order=order)
    f = np.array([[0, 3, 2], [0, 1, 2], [0, 2, 4], [0, 4, 3], [5, 2, 3], [2, 3, 4]])
    colors = np.arange(6, dtype=np.uint8)[:, None].repeat(4, 1)
    uvs = np.arange(6, dtype=np.float32)[:, None].repeat(2, 1)
    mesh = bitvox.Mesh(v, f, colors=colors, uvs=uvs)
    with pytest.raises(bitvox.RangeError, match="not finite"):
        bitvox.repair(mesh)
    found = mesh.drop_nonfinite()
    assert np.array_equal(found.vertices, v[[0, 2, 3, 4]]) and found.vertices.dtype == dtype
    assert np.array_equal(found.faces, [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    assert found.colors[:, 0].tolist() == [0, 2, 3, 4] and found.uvs[:, 0].tolist() == [0, 2, 3, 4]
    assert found.check().closed and mesh.n_faces == 6 and np.isnan(mesh.vertices[1, 0])
    with pytest.raises(bitvox.RangeError, match="vertex index 6"):
        bitvox.Mesh(v, [[0, 1, 6]]).drop_nonfinite()


def test_text_of_utf_16_is_read():
    text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
    for coding in ("utf-16-le", "utf-16-be"):
        mark = "\ufeff".encode(coding)
        assert bitvox.loads(mark + text.encode(coding), "obj") == bitvox.loads(text.encode(), "obj")
    with pytest.raises(bitvox.FormatError, match="UTF-16"):
        bitvox.loads(b"\xff\xfe" + b"v 0 0 0", "obj")


def test_notes_in_a_ply_head_are_passed_over():
    """As a file of assimp's has them: without the word comment."""
    mesh = bitvox.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    right = bitvox.dumps(mesh, "ply")
    odd = right.replace(b"element vertex", b"Created by hand, element of nothing\nelement vertex", 1)
    with pytest.warns(UserWarning, match="skipped 1 header line without.*Created by hand"):
        assert bitvox.loads(odd, "ply") == bitvox.loads(right, "ply")
    for wrong in (right.replace(b"property", b"properties"), right.replace(b"end_header", b"end_of_head")):
        with pytest.raises(bitvox.FormatError), warnings.catch_warnings():
            warnings.simplefilter("ignore")
            bitvox.loads(wrong, "ply")
