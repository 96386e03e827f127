"""Objects that behave as numpy's and Python's: arrays, copies, equality, indexing, cancelling, what notebooks show."""

import copy
import math
import pickle
import warnings

import numpy as np
import pytest
from conftest import ball_grid, box_mesh

import bitvox


@pytest.fixture(scope="module")
def things():
    mesh = bitvox.Mesh(*box_mesh((0, 0, 0), (1, 2, 3)), colors=np.arange(24).reshape(8, 3))
    grid = bitvox.voxelize(mesh, resolution=12, padding=2)
    values = np.arange(60.0).reshape(3, 4, 5)
    values[1, 1, 1] = np.nan
    return {
        "mesh": mesh, "grid": grid, "lattice": grid.lattice, "surface grid": bitvox.voxelize(mesh, resolution=6, mode="thin", attached=True),
        "volume": bitvox.Volume(values, spacing=(1, 2, 3), center0=(5, 6, 7), direction=[[0, 1, 0], [-1, 0, 0], [0, 0, 1]], frame="ras"),
        "field": bitvox.field(mesh, resolution=8, features=True), "unsigned field": bitvox.field(mesh, resolution=8, sign="none", vectors=False),
        "closest": bitvox.Closest(mesh), "rays": bitvox.Rays(grid), "octree": bitvox.refine(mesh, base=4, levels=2), "image": bitvox.render(grid, size=(40, 30)),
        "sections": bitvox.slice_mesh(mesh, spacing=0.5), "loops": bitvox.Sections([np.array([[0.0, 0, 1], [1, 0, 1], [0, 1, 1]])]),
    }


NAMES = ("mesh", "grid", "lattice", "surface grid", "volume", "field", "unsigned field", "closest", "rays", "octree", "image", "sections", "loops")


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("again", [lambda x: pickle.loads(pickle.dumps(x)), copy.deepcopy, copy.copy], ids=["pickle", "deepcopy", "copy"])
def test_copies_are_equal_and_whole(things, name, again):
    first = things[name]
    second = again(first)
    assert second == first and type(second) is type(first) and repr(second).split(" at 0x")[0] == repr(first).split(" at 0x")[0]
    assert getattr(second, "report", None) == getattr(first, "report", None)
    assert first != 1 and (first == object()) is False
    other = {k: v for k, v in things.items() if k != name and type(v) is type(first)}
    assert all(first != one for one in other.values())


def test_copies_of_grids_keep_report_and_triangles(things):
    first, second = things["surface grid"], pickle.loads(pickle.dumps(things["surface grid"]))
    assert first.report is not None and second.report == first.report
    assert np.array_equal(second.attached.triangles, first.attached.triangles) and np.array_equal(second.attached.offsets, first.attached.offsets)


def test_copies_work(things):
    field = pickle.loads(pickle.dumps(things["field"]))
    assert field.surface().content_hash() == things["field"].surface().content_hash() and field.inside == things["field"].inside
    assert bitvox.dumps(field, "nrrd") == bitvox.dumps(things["field"], "nrrd")
    assert (pickle.loads(pickle.dumps(things["closest"])).find([[5, 5, 5]]) == things["closest"].find([[5, 5, 5]])).all()
    assert pickle.loads(pickle.dumps(things["image"])).png() == things["image"].png()
    changed = things["volume"].array.copy()
    changed[0, 0, 0] += 1
    assert bitvox.Volume(changed, spacing=(1, 2, 3)) != bitvox.Volume(changed + 1, spacing=(1, 2, 3))
    assert bitvox.Volume(changed) == bitvox.Volume(changed.copy()) != bitvox.Volume(changed, center0=(1, 1, 1))


def test_numpy_takes_them(things):
    volume, field, grid, image = (things[n] for n in ("volume", "field", "grid", "image"))
    assert np.asarray(volume) is volume.array and np.nanmax(volume) == 59 and np.asarray(volume, "f4").dtype == "f4"
    assert np.shares_memory(np.asarray(volume), volume.array) and not np.shares_memory(np.array(volume), volume.array)
    assert np.array_equal(np.asarray(field), field.to_numpy()) and np.asarray(grid).shape == grid.shape and np.asarray(image).shape == (30, 40, 3)
    assert volume.to_numpy("zyx").shape == (5, 4, 3) and volume[1, 2, 3] == volume.array[1, 2, 3]


INDICES = [5, -1, (3, 4), np.s_[2:5], np.s_[1:9:3, ::-1], np.s_[..., 2], np.s_[:, 3], (1, 2, 3), (-1, -2, -3), np.s_[1, :, 2:4], np.s_[70, 1:2, :],
           np.s_[::2, -3, ::-2], np.s_[5:5], (np.array([1, 2]), 3, 4), None, np.s_[-70:3, -1, 0]]


@pytest.mark.parametrize("index", INDICES, ids=str)
def test_grids_are_indexed_by_numpys_rules(index):
    array = np.random.default_rng(3).random((71, 9, 7)) < 0.5
    grid = bitvox.Grid.from_numpy(array)
    found, wanted = grid[index], array[index]
    assert np.array_equal(found, wanted) and np.shape(found) == np.shape(wanted)
    mask = array.copy()
    assert np.array_equal(grid[mask], array[mask])


@pytest.mark.parametrize("index", [(1.0, 1, 1), (9, 9, 99), (0, -10, 0), "a", (1, 2, 3, 4), (99, slice(None), 0)], ids=str)
def test_grids_refuse_what_numpy_refuses(index):
    grid = bitvox.Grid.from_numpy(np.ones((9, 9, 9), bool))
    with pytest.raises(IndexError):
        np.ones((9, 9, 9), bool)[index]
    with pytest.raises(IndexError):
        grid[index]


@pytest.mark.parametrize("order", "CF")
@pytest.mark.parametrize("dtype", ["?", "u1", "i2", "f4", "f8"])
def test_packing_of_any_order(order, dtype):
    array = np.asarray(np.random.default_rng(5).integers(-2, 2, (130, 17, 33)), order=order).astype(dtype, order="K")
    if dtype[0] == "f":
        array[3, 3, 3], array[4, 4, 4] = np.inf, -np.inf
    lattice = bitvox.Lattice((200, 40, 50), 0.5)
    for given, name in ((array, "xyz"), (array[::-1, :, ::2], "xyz"), (array.transpose(2, 1, 0), "zyx")):
        grid = bitvox.Grid.from_numpy(given, order=name, lattice=lattice, low=(5, 6, 7))
        wanted = given != 0 if name == "xyz" else given.transpose(2, 1, 0) != 0
        assert np.array_equal(grid.to_numpy(), wanted) and grid.low == (5, 6, 7) and grid.lattice == lattice


@pytest.mark.parametrize("said", [False, 0, 0.0, np.False_, np.int64(0)], ids=repr)
def test_any_false_value_cancels(said, knot):
    with pytest.raises(bitvox.Cancelled):
        bitvox.voxelize(knot, resolution=40, progress=lambda stage, fraction: said)
    assert bitvox.voxelize(knot, resolution=40, progress=lambda stage, fraction: None).count > 0


@pytest.mark.parametrize("name", NAMES)
def test_notebooks_show_everything(things, name):
    text = things[name]._repr_html_()
    assert text.startswith("<div") and f"bitvox.{type(things[name]).__name__}" in text and "0x" not in text.partition("<img")[0]


def test_pictures_of_notebooks_are_packed(knot):
    shown = bitvox.voxelize(knot, resolution=40)._repr_png_()
    assert len(shown) < 150_000  # 518,863 bytes as they are
    pil = pytest.importorskip("PIL.Image")
    import io

    image = bitvox.render(knot, size=(50, 40))
    assert (np.asarray(pil.open(io.BytesIO(image._repr_png_()))) == image.pixels).all()


def test_what_has_no_effect_is_told():
    solid = bitvox.Grid.from_numpy(ball_grid(20))
    with pytest.warns(UserWarning, match="no voxel is deeper than the thickness of 50.*no hole"):
        assert solid.hollow(50.0, drain=1.0) == solid
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert solid.hollow(2.0).report.hollowed > 0
    points = np.random.default_rng(0).normal(size=(300, 3))
    with pytest.warns(UserWarning, match="close_gaps=1 with padding=1"):
        bitvox.voxelize_points(points, resolution=64, body=True)


def test_wrong_kinds_of_numbers_name_the_argument():
    grid = bitvox.Grid.from_numpy(ball_grid(12))
    volume = bitvox.Volume(np.zeros((3, 3, 3)))
    for call, kind, words in ((lambda: grid.dilate(1.5), TypeError, "steps"), (lambda: grid.components(connectivity="6"), TypeError, "connectivity"),
                              (lambda: grid.dilate(2**40), bitvox.RangeError, "steps"), (lambda: grid.downsample(2**31), bitvox.RangeError, "must be 1 to 33554432"), (lambda: grid.downsample(0), bitvox.RangeError, "must be 1 to"),
                              (lambda: grid.dilate(radius=-1), bitvox.ArgumentError, "radius is -1; it must be finite and not negative"),
                              (lambda: volume.surface("300"), TypeError, "level"), (lambda: volume.threshold("1"), TypeError, "low"),
                              (lambda: volume.threshold(10, 5), bitvox.ArgumentError, "low is 10 and high is 5"),
                              (lambda: bitvox.check(grid), TypeError, r"give its surface, grid.surface\(\)"),
                              (lambda: bitvox.boolean(grid, box_mesh(), "union"), TypeError, "combined by")):
        with pytest.raises(kind, match=words):
            call()


def test_labels_may_be_numbers(knot):
    cut = bitvox.slice_mesh(knot, spacing=0.5, label=7)
    assert bitvox.from_sections(cut, label=7).content_hash() == bitvox.from_sections(cut, label="7").content_hash()
    assert cut.of(7) == cut.of("7")


def test_colors_and_textures_come_through():
    trimesh, pyvista = pytest.importorskip("trimesh"), pytest.importorskip("pyvista")
    colors = np.arange(24, dtype=np.uint8).reshape(8, 3)
    mesh = bitvox.Mesh(*box_mesh(), colors=colors)
    assert (bitvox.Mesh.of(mesh.to_pyvista()).colors[:, :3] == colors).all() and (bitvox.Mesh.of(mesh.to_trimesh()).colors[:, :3] == colors).all()
    ball = pyvista.Sphere()
    ball.point_data["RGB"] = np.full((ball.n_points, 3), 9, np.uint8)
    assert (bitvox.Mesh.of(ball).colors == [9, 9, 9, 255]).all()
    red = trimesh.creation.box()
    red.visual.face_colors = [255, 0, 0, 255]
    assert (bitvox.Mesh.of(red).colors == [255, 0, 0, 255]).all()
    uvs = np.random.default_rng(1).random((8, 2)).astype("f4")
    textured = bitvox.Mesh(*box_mesh(), uvs=uvs).to_trimesh()
    assert np.allclose(textured.visual.uv, uvs) and np.array_equal(bitvox.Mesh.of(textured).uvs, uvs)
    assert np.array_equal(bitvox.Mesh.of(bitvox.Mesh(*box_mesh(), uvs=uvs).to_pyvista()).uvs, uvs)
    seams = bitvox.Mesh(*box_mesh(), uvs=np.random.default_rng(2).random((36, 2)), uv_faces=np.arange(36).reshape(12, 3))
    split = seams.to_trimesh()
    assert len(split.vertices) == 36 and split.volume == pytest.approx(1.0)
    assert np.allclose(split.visual.uv[split.faces], seams.uvs[seams.uv_faces])


def test_glb_comes_back_as_it_was(tmp_path, knot):
    pytest.importorskip("trimesh")
    knot.save(tmp_path / "k.glb")
    back = bitvox.read(tmp_path / "k.glb")
    assert np.allclose(back.bounds, knot.bounds) and np.allclose(back.vertices, knot.vertices, atol=1e-6) and back.check().volume > 0
    assert bitvox.voxelize(tmp_path / "k.glb", resolution=20).shape == bitvox.voxelize(knot, resolution=20).shape


def test_dir_shows_the_parts():
    assert {"big", "formats", "reports", "Grid"} <= set(dir(bitvox)) and not {"Any", "TYPE_CHECKING", "importlib"} & set(dir(bitvox))


def test_level_off_the_samples():
    """1/128 of an edge, as the docstring says."""
    array = np.zeros((3, 3, 3))
    array[1, 1, 1] = 1
    low, high = bitvox.Volume(array).surface(1.0, dtype="float64").bounds
    assert low == (1.5 - 1 / 128,) * 3 and high == (1.5 + 1 / 128,) * 3 and "1/128" in bitvox.Volume.surface.__doc__
    assert math.isclose(bitvox.Volume(array).center0[0], 0.5)


def test_messages_name_the_remedy(tmp_path, ball):
    (tmp_path / "a.xyz").write_text("0 0 0\n1 1 1\n")
    for call, kind, words in ((lambda: bitvox.voxelize(ball, spacing=0), bitvox.RangeError, "spacing is 0; it must be finite and above 0"),
                              (lambda: bitvox.voxelize(ball, spacing=(1, -1, 1)), bitvox.RangeError, "above 0"),
                              (lambda: bitvox.read(tmp_path), bitvox.ArgumentError, "is a folder; bitvox.read_volume"),
                              (lambda: bitvox.read(tmp_path / "a.xyz"), bitvox.UnsupportedError, "bitvox.read_points"),
                              (lambda: ball.save(tmp_path / "missing" / "a.ply"), FileNotFoundError, "no such folder: '.*missing'")):
        with pytest.raises(kind, match=words):
            call()
    assert not list(tmp_path.glob(".bitvox-*"))


def test_one_notion_has_one_name_everywhere(knot):
    grid = bitvox.Grid.from_numpy(np.ones((3, 4, 5), bool), spacing=(1, 2, 3), corner=(7, 8, 9))
    volume = bitvox.Volume(np.ones((3, 4, 5)), spacing=(1, 2, 3), corner=(7, 8, 9))
    box = bitvox.Mesh(*box_mesh())
    field = bitvox.field(box, lattice=grid.lattice)
    for thing in (grid, volume, field):
        assert thing.bounds == ((7, 8, 9), (10, 16, 24)) and thing.corner == (7, 8, 9) and thing.center0 == (7.5, 9, 10.5)
        assert thing.spacing == (1, 2, 3) and thing.shape == (3, 4, 5) and thing.to_numpy().shape == (3, 4, 5)
    found = knot.check()
    assert (knot.volume, knot.area, knot.is_closed) == (found.volume, found.area, True) and not bitvox.Mesh(knot.vertices, knot.faces[1:]).is_closed
    assert grid.volume == 60 * 6


def test_meshes_are_transformed(knot):
    turn = np.array([[0, -1, 0, 10], [1, 0, 0, 20], [0, 0, 1, 30], [0, 0, 0, 1]], float)
    moved = knot.transform(turn)
    assert np.allclose(moved.vertices, knot.vertices @ turn[:3, :3].T + turn[:3, 3], atol=1e-5) and moved.vertices.dtype == knot.vertices.dtype
    mirror = knot.transform(np.diag([1, 1, -1]))
    assert mirror.volume == pytest.approx(knot.volume) and mirror.check().oriented
    far = bitvox.Mesh(*box_mesh(), frame=(100, 0, 0)).transform(np.eye(3))
    assert far.bounds[0][0] == 100 + box_mesh()[0][:, 0].min()
    painted = bitvox.Mesh(*box_mesh(), colors=np.full((8, 3), 9), uvs=np.zeros((36, 2)), uv_faces=np.arange(36).reshape(12, 3)).transform(np.diag([-1, 1, 1]))
    assert (painted.colors[:, :3] == 9).all() and (painted.uv_faces == np.arange(36).reshape(12, 3)[:, ::-1]).all()


def test_open_files_are_read(tmp_path, knot):
    import gzip
    import io

    knot.save(tmp_path / "a.stl")
    data = (tmp_path / "a.stl").read_bytes()
    with open(tmp_path / "a.stl", "rb") as file:
        assert bitvox.read(file).n_faces == knot.n_faces
    assert bitvox.read(io.BytesIO(gzip.compress(data)), format="stl").n_faces == knot.n_faces
    with pytest.raises(bitvox.ArgumentError, match="format="):
        bitvox.read(io.BytesIO(data))
    with open(tmp_path / "a.stl", encoding="latin-1") as file, pytest.raises(TypeError, match="'rb'"):
        bitvox.read(file)


def test_what_is_left_out_is_told(ball):
    box = bitvox.Mesh(*box_mesh((0, 0, 0), (8, 6, 4)))
    with pytest.warns(UserWarning, match=r"begins at \(0.0, 0.0, 0.0\), below the corner \(1.0, 1.0, 1.0\)"):
        bitvox.voxelize(box, corner=(1, 1, 1), spacing=0.5)
    with pytest.warns(UserWarning, match="the result is empty.*conservative"):
        assert bitvox.voxelize(([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]), resolution=16).count == 0
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        bitvox.voxelize(box, corner=(0, 0, 0), spacing=0.5)
        bitvox.voxelize(box, corner=(-1, -1, -1), spacing=0.5)


def test_points_are_called_points():
    with pytest.raises(bitvox.RangeError, match=r"points\[2, 1\] is nan") as found:
        bitvox.voxelize_points([[0, 0, 0], [1, 1, 1], [0, np.nan, 0]], resolution=4)
    assert found.value.index == 2
    with pytest.raises(bitvox.ArgumentError, match="points have shape"):
        bitvox.voxelize_points([[0, 0]], resolution=4)
    with pytest.raises(bitvox.Error) as found:  # finite, although their sum is not
        bitvox.voxelize_points(np.full((4, 3), 1e308), resolution=4)
    assert "points[" not in str(found.value)


def test_squares_are_of_cubes():
    grid = bitvox.Grid.from_numpy(np.ones((4, 4, 4)), spacing=(1, 2, 3))
    with pytest.raises(bitvox.ArgumentError, match="squares=False"):
        grid.distance(squares=True)


@pytest.mark.parametrize("name", ["dilate", "erode", "open", "close", "components", "label"])
def test_connectivity_is_one_word(name):
    grid = bitvox.Grid.from_numpy(ball_grid(12))
    call = getattr(grid, name)
    for connectivity in (6, 18, 26):
        call(connectivity=connectivity)
    for wrong in (4, 7):
        with pytest.raises(bitvox.ArgumentError, match=rf"^connectivity is {wrong}; it must be 6 \(faces\), 18"):
            call(connectivity=wrong)


def test_everything_says_what_it_is(knot):
    assert repr(bitvox.Closest(knot)) == f"Closest({knot.n_vertices} vertices, {knot.n_faces} faces)"
    assert repr(bitvox.Rays(bitvox.Grid.from_numpy(np.ones((2, 3, 4))))) == "Rays(2 x 3 x 4 voxels)"
    assert repr(bitvox.slice_mesh(box_mesh((0, 0, 0), (4, 4, 4)), spacing=4.0)) == "Sections(1 plane, 1 loop, 1 body)"


def test_what_is_not_a_grid_has_a_remedy(knot):
    volume = bitvox.Volume(np.zeros((3, 3, 3)))
    for wrong, words in ((knot, "voxelize"), ("knot.ply", "voxelize"), (volume, "method surface"), (3, "three-dimensional array")):
        with pytest.raises(TypeError, match=f"is not a grid: .*{words}"):
            bitvox.surface(wrong)


def test_rows_of_different_lengths():
    for rows in ([[0, 0, 0], [1, 1]], np.array([[0, 0, 0], [1, 1]], dtype=object)):
        with pytest.raises(bitvox.ArgumentError, match="vertices: rows of different lengths"):
            bitvox.Mesh(rows, [[0, 0, 0]])
    with pytest.raises(TypeError, match="not object"):
        bitvox.Mesh(np.array([[0, 0, None]], dtype=object), [[0, 0, 0]])
