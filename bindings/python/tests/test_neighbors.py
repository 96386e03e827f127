"""Doors to and from other libraries: trimesh, Open3D, meshio, napari, PyVista's accessor, readers and writers, clouds of points."""

import os
import subprocess
import sys

import numpy as np
import pytest

import bitvox


@pytest.fixture(scope="module")
def solid():
    return bitvox.voxelize(([[0, 0, 0], [8, 0, 0], [0, 6, 0], [0, 0, 4]], [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]), spacing=(0.5, 0.25, 1.0))


def test_trimesh_voxels(solid):
    pytest.importorskip("trimesh")
    theirs = solid.to_trimesh()
    at = np.array(solid.center0) + solid.voxels() * np.array(solid.spacing)
    assert theirs.filled_count == solid.count and np.allclose(np.sort(theirs.points, axis=0), np.sort(at, axis=0))


def test_meshes_go_out(ball):
    colored = bitvox.Mesh(ball.vertices, ball.faces, colors=np.tile([[10, 20, 30, 255]], (ball.n_vertices, 1)).astype(np.uint8))
    meshio = pytest.importorskip("meshio")
    theirs = colored.to_meshio()
    assert isinstance(theirs, meshio.Mesh) and bitvox.Mesh.of(theirs).content_hash() == bitvox.Mesh.of((ball.in_world(), np.asarray(ball.faces).astype(np.int64))).content_hash()
    assert theirs.point_data["colors"][0].tolist() == [10, 20, 30, 255]


@pytest.mark.parametrize("ending", ["vtp"])
def test_meshes_are_written_by_libraries(ball, ending, tmp_path):
    pytest.importorskip("pyvista")
    ball.save(tmp_path / f"a.{ending}")
    back = bitvox.read(tmp_path / f"a.{ending}")
    assert np.allclose(back.vertices, ball.vertices) and np.array_equal(back.faces, ball.faces)
    ball.save(tmp_path / f"a.{ending}.gz")
    with pytest.raises(bitvox.ArgumentError, match="normals"):
        ball.save(tmp_path / f"b.{ending}", normals=True)
    assert not (tmp_path / f"b.{ending}").exists()


def test_open3d_meshes(ball):
    pytest.importorskip("open3d")
    theirs = ball.to_open3d()
    back = bitvox.Mesh.of(theirs)
    assert theirs.is_watertight() and np.array_equal(back.vertices, ball.in_world()) and np.array_equal(back.faces, ball.faces)
    colored = bitvox.Mesh(ball.vertices, ball.faces, colors=np.random.default_rng(1).integers(0, 256, (ball.n_vertices, 3)))
    assert np.array_equal(bitvox.Mesh.of(colored.to_open3d()).colors, colored.colors)
    tensor = pytest.importorskip("open3d").t.geometry.TriangleMesh.from_legacy(colored.to_open3d())
    assert np.abs(bitvox.Mesh.of(tensor).colors.astype(int) - colored.colors).max() <= 1  # float32 there


def test_napari_layers(solid, ball, tmp_path):
    data, options, kind = solid.to_napari()
    assert kind == "labels" and np.array_equal(data, solid.to_numpy("zyx")) and options["scale"] == (1.0, 0.25, 0.5)
    assert np.allclose(np.array(options["translate"])[::-1], solid.center0)
    turn = np.array([[0.8, -0.6, 0], [0.6, 0.8, 0], [0, 0, 1]])
    volume = bitvox.Volume(np.zeros((3, 4, 5)), spacing=(1, 2, 3), center0=(7, 8, 9), direction=turn)
    data, options, kind = volume.to_napari()
    at = options["affine"] @ [4, 3, 2, 1]  # z, y, x
    assert kind == "image" and data.shape == (5, 4, 3) and np.allclose(at[:3][::-1], volume.to_world([[2, 3, 4]])[0])
    (vertices, faces, values), options, kind = ball.to_napari()
    back = bitvox.Mesh(vertices[:, ::-1], faces[:, ::-1])
    assert kind == "surface" and len(values) == ball.n_vertices and back.check().volume == pytest.approx(ball.check().volume)
    assert bitvox.Mesh(vertices, faces).check().volume > 0  # outwards in napari's own axes too


def test_napari_plugin(solid, ball, tmp_path):
    npe2 = pytest.importorskip("npe2")
    from bitvox import _napari

    manifest = npe2.PluginManifest.from_file(os.path.join(os.path.dirname(bitvox.__file__), "napari.yaml"))
    for command in manifest.contributions.commands:
        assert callable(command.python_name.import_name() if hasattr(command.python_name, "import_name") else getattr(_napari, command.python_name.split(":")[1]))
    solid.save(tmp_path / "a.bvx")
    ball.save(tmp_path / "b.ply")
    bitvox.Volume(np.arange(24.0).reshape(2, 3, 4)).save(tmp_path / "c.nrrd")
    kinds = [_napari.reader_of(str(tmp_path / name))(str(tmp_path / name))[0][2] for name in ("a.bvx", "b.ply", "c.nrrd")]
    assert kinds == ["labels", "surface", "image"] and _napari.reader_of(str(tmp_path / "d.png")) is None and _napari.reader_of(["a.bvx", "b.bvx"]) is None
    data, options, _ = solid.to_napari()
    _napari.write_labels(str(tmp_path / "e.bvx"), data, options)
    assert np.array_equal(bitvox.read(tmp_path / "e.bvx").to_numpy(), solid.to_numpy()) and np.allclose(bitvox.read(tmp_path / "e.bvx").corner, solid.corner)
    _napari.write_surface(str(tmp_path / "f.ply"), ball.to_napari()[0], {"scale": (2, 2, 2)})
    assert bitvox.read(tmp_path / "f.ply").check().volume == pytest.approx(8 * ball.check().volume, rel=1e-5)


# ---- PyVista ----


def test_accessor_of_meshes(ball):
    pyvista = pytest.importorskip("pyvista")
    from bitvox import pyvista_accessor  # what the entry point does

    data, moved = ball.to_pyvista(), ball.to_pyvista().translate((1.0, 0.5, 0.0))
    both = data.bitvox.boolean(moved, "union", resolution=48)
    assert both.is_manifold and both.volume > data.volume
    shell = data.bitvox.hollow(0.5, resolution=40)
    assert shell.is_manifold and shell.volume < 0.8 * data.volume
    lines = data.bitvox.sections(axis="z", spacing=0.5)
    stack = bitvox.slice_mesh(ball, axis="z", spacing=0.5)
    assert lines.n_cells == len(stack.loops) and set(lines.cell_data["section"]) == set(stack.section_of)
    assert isinstance(pyvista_accessor.lines_of(bitvox.Sections([])), pyvista.PolyData)


def test_accessor_of_images():
    """A sphere's area by samples is within 1 % of theory (6.28), by voxels it was 9 % more."""
    pyvista = pytest.importorskip("pyvista")
    n = 41
    image = pyvista.ImageData(dimensions=(n, n, n), spacing=(0.05,) * 3, origin=(-1.0,) * 3)
    image.point_data["d"] = np.sqrt(0.5) - np.linalg.norm(image.points, axis=1)
    mesh = image.bitvox.surface("d", level=0.0)
    assert mesh.is_manifold and mesh.area == pytest.approx(2 * np.pi, rel=0.01)
    with pytest.raises(bitvox.ArgumentError, match="contradict"):
        image.bitvox.surface("d", level=0.0, threshold=1.0)
    image.point_data["in"] = (image.point_data["d"] > 0).astype("u1")
    image.point_data["up"] = (image.points[:, 2] > 0).astype("u1")
    grid = image.bitvox.grid("in")
    other = image.copy()
    other.point_data["in"] = image.point_data["up"]
    assert image.bitvox.boolean(other, "intersection", "in").bitvox.grid("solid") == grid & other.bitvox.grid("in")
    assert image.bitvox.boolean(grid, "difference", "in").cell_data["solid"].sum() == 0
    hollow = image.bitvox.hollow(0.1, "in")
    assert 0 < hollow.cell_data["solid"].sum() < grid.count
    two = bitvox.Grid.from_numpy(np.array([1, 0, 1, 1], bool).reshape(4, 1, 1)).to_pyvista()
    assert two.bitvox.components().cell_data["component"].tolist() == [1, 0, 2, 2]
    assert image.bitvox.sections("in", axis="z", spacing=0.25).n_cells > 0


def test_one_name_in_file_and_memory(solid, tmp_path):
    pyvista = pytest.importorskip("pyvista")
    from bitvox import pyvista_accessor  # noqa: F401

    solid.save(tmp_path / "g.vti")
    there, here = pyvista.read(tmp_path / "g.vti"), solid.to_pyvista()
    assert there.bitvox.grid("solid") == here.bitvox.grid("solid") == solid
    field = bitvox.field(solid.surface(), lattice=solid.lattice)
    field.save(tmp_path / "f.vti")
    there, here = pyvista.read(tmp_path / "f.vti"), field.to_pyvista()
    assert np.allclose(there.points, here.points) and np.allclose(there.point_data["distance"], here.point_data["distance"])


def test_pyvista_reads_and_writes_files(solid, ball, tmp_path):
    pyvista = pytest.importorskip("pyvista")
    if not hasattr(pyvista, "register_reader"):
        pytest.skip("this PyVista takes no readers")
    solid.save(tmp_path / "a.bvx")
    code = f"""import pyvista
image = pyvista.read({str(tmp_path / 'a.bvx')!r})
print(int(image.cell_data["solid"].sum()))
image.save({str(tmp_path / 'b.bvx')!r})
pyvista.Sphere().save({str(tmp_path / 'c.off')!r})
"""
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert found.stdout.split() == [str(solid.count)], found.stderr
    assert bitvox.read(tmp_path / "b.bvx") == solid and bitvox.read(tmp_path / "c.off").check(weld=True).closed


# ---- clouds ----

CLOUD = np.random.default_rng(3).integers(-40000, 40000, (200, 3)) / 1000.0


def check_cloud(path, tolerance):
    found = bitvox.read_points(path)
    assert found.dtype == np.float64 and np.abs(found - CLOUD).max() <= tolerance
    assert bitvox.voxelize_points(path, resolution=32).count == bitvox.voxelize_points(found, resolution=32).count > 0


@pytest.mark.parametrize("ending", ["las", "laz"])
def test_las(ending, tmp_path):
    laspy = pytest.importorskip("laspy")
    if ending == "laz" and not laspy.LazBackend.detect_available():
        pytest.skip("no LAZ here")
    head = laspy.LasHeader(point_format=3, version="1.2")
    head.scales = [0.001] * 3
    data = laspy.LasData(head)
    data.x, data.y, data.z = CLOUD.T
    data.write(str(tmp_path / f"a.{ending}"))
    check_cloud(tmp_path / f"a.{ending}", 1e-9)


def test_pcd(tmp_path):
    pytest.importorskip("pypcd4")
    head = "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 201\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 201\nDATA "
    rows = np.vstack([CLOUD, [[np.nan] * 3]]).astype("<f4")
    (tmp_path / "a.pcd").write_bytes((head + "binary\n").encode() + rows.tobytes())
    check_cloud(tmp_path / "a.pcd", 4e-6)
    (tmp_path / "b.pcd").write_text(head + "ascii\n" + "\n".join(" ".join(map(repr, row.tolist())) for row in rows) + "\n")
    check_cloud(tmp_path / "b.pcd", 4e-6)
    (tmp_path / "c.pcd").write_bytes(b"VERSION .7\n")
    with pytest.raises(bitvox.FormatError):
        bitvox.read_points(tmp_path / "c.pcd")
    with pytest.raises(FileNotFoundError):
        bitvox.read_points(tmp_path / "missing.pcd")


def test_e57(tmp_path):
    pye57 = pytest.importorskip("pye57")
    file = pye57.E57(str(tmp_path / "a.e57"), mode="w")
    for part, move in ((CLOUD[:120], np.zeros(3)), (CLOUD[120:], np.array([5.0, 6.0, 7.0]))):  # scans are stored about their own places
        x, y, z = (part - move).T.copy()
        file.write_scan_raw({"cartesianX": x, "cartesianY": y, "cartesianZ": z}, rotation=np.array([1.0, 0, 0, 0]), translation=move)
    file.close()
    check_cloud(tmp_path / "a.e57", 1e-5)  # pye57 writes floats of 32 bits


def test_data_of_points_stay_with_levels():
    pyvista = pytest.importorskip("pyvista")
    from bitvox import pyvista_accessor  # noqa: F401

    mesh = pyvista.Sphere(theta_resolution=40, phi_resolution=40).elevation()
    mesh.point_data["part"] = (mesh.points[:, 2] > 0).astype(np.int32) * 7
    mesh.point_data["RGB"] = np.tile(np.uint8([200, 10, 60]), (mesh.n_points, 1))
    for level in (*mesh.bitvox.lod(triangles=(600, 200)), mesh.bitvox.simplify(triangles=300), mesh.bitvox.repair(resolution=24)):
        assert {"Elevation", "part", "RGB", "Normals"} <= set(level.point_data.keys()) and "colors" not in level.point_data
        assert np.abs(level.point_data["Elevation"] - level.points[:, 2]).max() < 0.05
        assert set(level.point_data["part"]) == {0, 7} and (level.point_data["part"] == 7 * (level.points[:, 2] > 0)).mean() > 0.9
        assert (level.point_data["RGB"][:, :3] == [200, 10, 60]).all()
        assert np.allclose(np.linalg.norm(level.point_data["Normals"], axis=1), 1, atol=1e-5)
    wall = mesh.bitvox.hollow(0.1, resolution=32)
    assert np.abs(wall.point_data["Elevation"] - wall.points[:, 2]).max() < 0.15 and set(wall.point_data["part"]) == {0, 7}
    mesh.cell_data["face"] = np.arange(mesh.n_cells)
    with pytest.warns(UserWarning, match="cells are not kept: face"):
        mesh.bitvox.simplify(triangles=300)
    with pytest.warns(UserWarning, match="points and cells are not kept: .*Elevation.*face") as said:
        mesh.bitvox.boolean(mesh, "union", resolution=24)
    assert said[0].filename == __file__


def test_octrees_are_leaves_in_pyvista(tmp_path):
    pyvista = pytest.importorskip("pyvista")
    from bitvox import pyvista_accessor

    tree = bitvox.refine(bitvox.Grid.from_numpy(np.ones((4, 4, 4))).surface(), base=4, levels=3)
    tree.save(tmp_path / "deep.bvx")
    found = pyvista_accessor.read(str(tmp_path / "deep.bvx"))
    assert isinstance(found, pyvista.UnstructuredGrid) and found.volume == pytest.approx(tree.volume)
    assert tree.to_pyvista(states="inside").n_cells < found.n_cells == len(tree.leaves())


@pytest.mark.parametrize("kind", ["to_sitk", "to_nibabel", "to_pyvista"])
@pytest.mark.parametrize("frame", ["lps", "ras", None])
def test_volumes_go_where_they_came_from(kind, frame):
    for module in ("SimpleITK", "nibabel", "pyvista"):
        pytest.importorskip(module)
    turn = np.array([[0.8, -0.6, 0], [0.6, 0.8, 0], [0, 0, -1]])
    volume = bitvox.Volume(np.arange(60, dtype=np.int64).reshape(3, 4, 5), spacing=(1, 2, 3), center0=(4, 5, 6), direction=turn, frame=frame)
    back = bitvox.Volume.of(getattr(volume, kind)())
    assert np.array_equal(back.array, volume.array) and back.array.dtype == volume.array.dtype
    wanted = volume if frame in (back.frame, None) or back.frame is None else volume.turned(back.frame)
    assert np.allclose(back.to_world([[0, 0, 0], [2, 3, 4]]), wanted.to_world([[0, 0, 0], [2, 3, 4]]))


def test_grids_of_others():
    for module in ("SimpleITK", "trimesh", "pyvista"):
        pytest.importorskip(module)
    grid = bitvox.Grid.from_numpy(np.random.default_rng(2).random((5, 4, 3)) > 0.5, spacing=(1, 2, 3), corner=(7, 8, 9))
    for held in (grid, bitvox.Volume.of(grid), bitvox.Volume.of(grid).to_sitk(), bitvox.Volume.of(grid).to_pyvista(), grid.to_pyvista(), grid.to_trimesh()):
        assert bitvox.Grid.of(held) == grid
