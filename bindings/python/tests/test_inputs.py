"""Meshes of other libraries in, and back out."""

import subprocess
import sys
from types import SimpleNamespace

import numpy as np
import pytest
from conftest import HERE, box_mesh

import bitvox

V, F = box_mesh((0, 0, 0), (8, 6, 4))
WANTED = bitvox.voxelize((V, F), spacing=1.0)


def same(source):
    assert bitvox.voxelize(source, spacing=1.0) == WANTED
    return bitvox.Mesh.of(source)


def test_trimesh():
    trimesh = pytest.importorskip("trimesh")
    mesh = trimesh.Trimesh(V, F, process=False)
    taken = same(mesh)
    assert type(taken.vertices) is np.ndarray and taken.colors is None
    back = taken.to_trimesh()
    assert back.is_watertight and np.array_equal(back.vertices, V) and np.array_equal(back.faces, F)
    mesh.visual.vertex_colors = np.tile([9, 8, 7, 255], (8, 1))
    painted = bitvox.Mesh.of(mesh)
    assert painted.colors[3].tolist() == [9, 8, 7, 255]
    assert painted.to_trimesh().visual.vertex_colors[3].tolist() == [9, 8, 7, 255]
    same(trimesh.Scene([mesh]))
    assert bitvox.surface(WANTED).to_trimesh().volume == pytest.approx(bitvox.surface(WANTED).check().volume)


def test_trimesh_clouds():
    trimesh = pytest.importorskip("trimesh")
    points = np.random.default_rng(1).random((50, 3))
    assert bitvox.voxelize_points(trimesh.PointCloud(points), resolution=9) == bitvox.voxelize_points(points, resolution=9)


def test_trimesh_registry():
    trimesh = pytest.importorskip("trimesh")
    bitvox.register_with_trimesh()
    mesh = trimesh.Trimesh(V - 0.5, F, process=False)
    grid = mesh.voxelized(1.0, method="bitvox")
    assert grid.filled_count == 8 * 6 * 4 and np.allclose(grid.points.min(0), 0) and np.allclose(grid.points.max(0), [7, 5, 3])
    sphere = trimesh.creation.icosphere(subdivisions=3, radius=5)
    mine = {tuple(p) for p in np.round(sphere.voxelized(0.5, method="bitvox", mode="conservative").points / 0.5).astype(int)}
    theirs = {tuple(p) for p in np.round(sphere.voxelized(0.5, method="subdivide").points / 0.5).astype(int)}
    assert theirs <= mine
    bitvox.register_with_trimesh()  # a notebook's cell that is run again


@pytest.mark.parametrize("first", ["import trimesh, bitvox", "import bitvox, trimesh", "import bitvox; import trimesh; import importlib; importlib.reload(bitvox)"])
def test_trimesh_registry_in_any_order_of_imports(first):
    pytest.importorskip("trimesh")
    code = f"{first}\nprint('voxelizers' in dir(trimesh.voxel.creation), trimesh.creation.box().voxelized(0.25, method='bitvox').filled_count)\nbitvox.register_with_trimesh()"
    found = subprocess.run([sys.executable, "-W", "error", "-c", code], capture_output=True, text=True, check=False)
    assert found.stdout == "True 64\n" and found.stderr == ""


def test_pyvista():
    pyvista = pytest.importorskip("pyvista")
    data = pyvista.PolyData(V, np.c_[np.full(12, 3), F].ravel())
    same(data)
    quads = np.array([[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]])
    same(pyvista.PolyData(V, np.c_[np.full(6, 4), quads].ravel()))
    back = bitvox.surface(WANTED).to_pyvista()
    assert back.is_manifold and back.n_cells == bitvox.surface(WANTED).n_faces
    image = WANTED.to_pyvista()
    assert image.n_cells == 192 and image.cell_data["solid"].sum() == WANTED.count
    solid = data.bitvox.voxelize(resolution=16)
    assert solid.cell_data["solid"].sum() == bitvox.voxelize((V, F), resolution=16).count
    assert data.bitvox.check().closed and data.bitvox.lod(levels=8)[0].n_cells > 0
    assert solid.bitvox.grid("solid") == bitvox.voxelize((V, F), resolution=16)
    assert solid.bitvox.surface("solid").is_manifold
    field = data.bitvox.field(resolution=12)
    assert np.array_equal(field.point_data["distance"], bitvox.field((V, F), resolution=12).to_numpy("zyx").ravel())
    assert bitvox.field((V, F), resolution=12).to_pyvista(vectors=True).point_data["vector"].shape == (field.n_points, 3)
    middle = field.find_closest_point((4.0, 3.0, 2.0))
    assert field.point_data["distance"][middle] == field.point_data["distance"].min()
    points = pyvista.ImageData(dimensions=(4, 5, 6), spacing=(1, 2, 3), origin=(7, 8, 9))
    points.point_data["x"] = np.arange(120.0)
    grid = points.bitvox.grid("x", threshold=59.5)
    assert grid.count == 60 and grid.center0 == (7, 8, 9)
    with pytest.raises(bitvox.ArgumentError):
        points.bitvox.grid("y")
    for other, words in ((data.cast_to_unstructured_grid(), r"is not a mesh: give its surface, \.extract_surface\(\)$"), (image, r"or its voxels, \.bitvox\.grid\(\)"),
                         (pyvista.MultiBlock([data]), "several data sets")):
        with pytest.raises(TypeError, match=words):
            bitvox.check(other)
    with pytest.raises(TypeError, match="MultiBlock is not a volume"):
        bitvox.Volume.of(pyvista.MultiBlock([data]))


def test_plot(tmp_path):
    pytest.importorskip("pyvista")
    code = f"""import sys
sys.path.insert(0, {str(HERE)!r})
import bitvox
from conftest import HERE, box_mesh
mesh = bitvox.Mesh(*box_mesh(), colors=[[255, 0, 0]] * 8)
mesh.plot(off_screen=True, screenshot={str(tmp_path / "a.png")!r}, window_size=(80, 60))
bitvox.voxelize(mesh, resolution=4).plot(off_screen=True, screenshot={str(tmp_path / "b.png")!r}, window_size=(80, 60))
"""
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=120, check=False)
    if found.returncode < 0 or "Traceback" not in found.stderr and found.returncode:
        pytest.skip("PyVista cannot draw here")
    assert found.returncode == 0, found.stderr
    for name in ("a.png", "b.png"):
        assert (tmp_path / name).read_bytes()[1:4] == b"PNG"


def test_meshio():
    meshio = pytest.importorskip("meshio")
    same(meshio.Mesh(V, [("triangle", F)]))
    same(meshio.Mesh(V, [("triangle", F[:5]), ("line", [[0, 1]]), ("triangle", F[5:])]))
    same(meshio.Mesh(V, [("quad", [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]])]))
    with pytest.raises(bitvox.UnsupportedError, match="tetra"):
        bitvox.Mesh.of(meshio.Mesh(V, [("tetra", [[0, 1, 2, 3]])]))


class Vector(list):
    """Open3D's Vector3dVector, as far as numpy sees it."""

    def __array__(self, dtype=None, copy=None):
        return np.array(list(self), dtype=dtype)


class Tensor:
    """Open3D's Tensor."""

    def __init__(self, array):
        self.array = array

    def cpu(self):
        return self

    def numpy(self):
        return self.array


class Table(dict):
    """Open3D's TensorMap."""

    def __getattr__(self, name):
        try:
            return self[name]
        except KeyError:
            raise AttributeError(name) from None


def test_open3d_stand_ins():
    legacy = SimpleNamespace(vertices=Vector(V.tolist()), triangles=Vector(F.tolist()), triangle_normals=Vector(),
                             vertex_colors=Vector([[1.0, 0, 0]] * 8), has_vertex_colors=lambda: True)
    assert same(legacy).colors[0].tolist() == [255, 0, 0, 255]
    tensor = SimpleNamespace(vertex=Table(positions=Tensor(V.astype(np.float32))), triangle=Table(indices=Tensor(F.astype(np.int32))))
    same(tensor)


def test_open3d():
    open3d = pytest.importorskip("open3d")
    legacy = open3d.geometry.TriangleMesh(open3d.utility.Vector3dVector(V), open3d.utility.Vector3iVector(F))
    same(legacy)
    same(open3d.t.geometry.TriangleMesh.from_legacy(legacy))
