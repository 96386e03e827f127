"""Distance fields and repair."""

import math

import numpy as np
import pytest
from conftest import TETRAHEDRON, ball_grid, box_mesh

import bitvox


def brute(lattice, mesh):
    """Distances of all centers to the corners, edges and planes of a convex mesh, sampled."""
    at = [lattice.center0[a] + np.arange(lattice.shape[a]) * lattice.spacing[a] for a in range(3)]
    centers = np.stack(np.meshgrid(*at, indexing="ij"), -1)
    closest = bitvox.Closest(mesh).find(centers.reshape(-1, 3))
    return centers, closest["distance"].reshape(lattice.shape)


@pytest.mark.parametrize("dtype", ["float32", "float64"])
def test_field_against_closest_points(dtype):
    lattice = bitvox.Lattice((14, 13, 12), 0.11, (-0.23, -0.22, -0.21))
    found = bitvox.field(TETRAHEDRON, lattice=lattice, half_width=np.inf, dtype=dtype, features=True)
    centers, expected = brute(lattice, TETRAHEDRON)
    solid = bitvox.voxelize(TETRAHEDRON, lattice=lattice)
    assert found.sign == "parity" and found.inside == solid and found.band.count == 14 * 13 * 12
    voxels = tuple(found.band.voxels().T)
    distances = found.distances
    assert distances.dtype == dtype and np.allclose(np.abs(distances), expected[voxels], atol=1e-6)
    assert (np.signbit(distances) == solid.to_numpy()[voxels]).all()
    assert found.vectors.dtype == dtype and np.allclose(np.sqrt((found.vectors**2).sum(1)), expected[voxels], atol=1e-6)
    other = found.triangles != bitvox.Closest(TETRAHEDRON).find(centers[voxels])["triangle"]
    assert (found.features[other] > 0).all()  # edges and corners, where numpy's centers round to another triangle
    assert found.features.max() <= 6 and not distances.flags.writeable
    assert found.value((3, 4, 5)) == 5 * 13 * 14 + 4 * 14 + 3 and found.row_values[-1] == len(distances)
    with pytest.raises(IndexError):
        found.value((14, 0, 0))
    dense = found.to_numpy()
    assert np.allclose(np.abs(dense), expected, atol=1e-6) and np.array_equal(found.to_numpy("zyx"), dense.transpose(2, 1, 0))
    assert found.to_numpy(vectors=True).shape == (14, 13, 12, 3)


def test_bands_windows_and_options():
    found = bitvox.field(TETRAHEDRON, resolution=24, half_width=2.0)
    assert 0 < found.band.count < np.prod(found.shape) and found.value((0, 0, 0)) in (None, 0)
    assert found.half_width == 2.0 and np.abs(found.distances).max() <= 2.0 * max(found.spacing)
    band, distances = found.band, found.distances
    count, first = band.count, distances.copy()
    del found
    for _ in range(20):
        bitvox.field(TETRAHEDRON, resolution=12)
    assert band.count == count and np.array_equal(distances, first)  # they keep the field's memory alive
    plain = bitvox.field(TETRAHEDRON, resolution=12, vectors=False, sign="none")
    assert plain.vectors is None and plain.inside is None and plain.triangles is None and plain.features is None
    assert (plain.distances >= 0).all() and plain.sign == "none"
    part = bitvox.field(TETRAHEDRON, lattice=bitvox.field(TETRAHEDRON, resolution=12).lattice, window=((2, 3, 4), (5, 6, 7)))
    assert part.shape == (5, 6, 7) and part.band.low == (2, 3, 4)
    for options in ({"half_width": -1.0}, {"half_width": float("nan")}, {"sign": "perhaps"}, {"dtype": "int8"}, {"window": ((90, 0, 0), (1, 1, 1))}):
        with pytest.raises(bitvox.Error):
            bitvox.field(TETRAHEDRON, resolution=12, **options)
    whole = bitvox.field(TETRAHEDRON, resolution=12, half_width=0, padding=1)  # 0 as the program takes it
    assert whole.half_width == np.inf and whole.shape == (14, 14, 14) and whole.band.count == 14**3
    assert bitvox.field(TETRAHEDRON, resolution=12).shape == (18, 18, 18)  # room for a band of three
    placed = bitvox.field(TETRAHEDRON, spacing=0.25, corner=(-1, -1, -1))
    assert placed.lattice.corner == (-1, -1, -1) and placed.shape == (8, 8, 8)
    for options in ({"lattice": placed.lattice, "padding": 2}, {"lattice": placed.lattice, "corner": (0, 0, 0)}):
        with pytest.raises(bitvox.ArgumentError):
            bitvox.field(TETRAHEDRON, **options)
    with pytest.raises(bitvox.ArgumentError):
        whole.surface(sharp_angle=0.5)
    wide = bitvox.field(TETRAHEDRON, resolution=12, half_width=100)  # no lattice a thousand times as large
    assert wide.half_width == 100.0 and wide.shape == (44, 44, 44)


def test_field_files(tmp_path):
    found = bitvox.field(TETRAHEDRON, resolution=10)
    found.save(tmp_path / "a.npy")
    assert np.array_equal(np.load(tmp_path / "a.npy"), found.to_numpy()) and (tmp_path / "a.npy.json").is_file()
    found.save(tmp_path / "v.npy", vectors=True)
    assert np.array_equal(np.load(tmp_path / "v.npy"), found.to_numpy(vectors=True))
    assert bitvox.dumps(found, "vti")[:5] == b"<?xml" and bitvox.dumps(found, "nrrd")[:4] == b"NRRD"
    with pytest.raises(bitvox.UnsupportedError):
        bitvox.dumps(found, "bvx")


@pytest.mark.parametrize("interpolation", ["tangent", "vector", "scalar", "middle", "paper"])
def test_surface_of_a_field(interpolation):
    ball = bitvox.surface(ball_grid(), dtype="float64")
    surface = bitvox.field(ball, resolution=30).surface(interpolation=interpolation)
    certificate = surface.check()
    assert certificate.closed and certificate.edge_manifold and certificate.oriented and surface.report.edges == surface.n_vertices
    off = bitvox.compare(surface, ball, samples=2000)
    assert off.mean < (0.5 if interpolation == "middle" else 0.2)


def test_voxels_that_were_changed_keep_the_surface_of_the_mesh():
    box = box_mesh((0, 0, 0), (10, 9, 8))
    lattice = bitvox.Lattice.fit(box, resolution=23, padding=2)
    whole = bitvox.voxelize(box, lattice=lattice)
    measured = bitvox.field(box, lattice=lattice, half_width=8)
    shell = bitvox.Grid.from_numpy(whole.to_numpy() & (measured.to_numpy() > -1.3), lattice=lattice)
    by_mesh = shell.surface(mesh=box, offset=-1.3)
    certificate = by_mesh.check()
    assert certificate.closed and certificate.edge_manifold and certificate.components == 2 and by_mesh.report.sharp == 1
    hollow = 7.4 * 6.4 * 5.4  # the inner wall's edges are bevelled, which takes a little of the hollow
    off = certificate.volume - (720 - hollow)
    assert 0 < off < 0.01 * hollow
    stairs = shell.surface(mesh=box)
    assert stairs.check().volume - (720 - hollow) > 2 * off and stairs.report.middle == stairs.report.own > 0
    same = whole.surface(mesh=box)
    assert abs(same.check().volume - 720) < 1e-6 * 720 and same.report.own == 0
    assert measured.surface(grid=shell, offset=-1.3, sharp=None).n_vertices == by_mesh.n_vertices


def test_surfaces_of_changed_voxels_that_cannot_be_are_refused():
    box, other = box_mesh((0, 0, 0), (1, 1, 1)), bitvox.Grid.from_numpy(np.ones((3, 3, 3), bool))
    measured = bitvox.field(box, resolution=8)
    for wrong in ({"offset": 1.0}, {"grid": other}, {"grid": measured.inside, "offset": math.nan}):
        with pytest.raises(bitvox.Error):
            measured.surface(**wrong)
    for wrong in ({"mesh": box, "keys": True}, {"mesh": box, "open_sides": "x-low"}, {"offset": 1.0}, {"sharp": True}):
        with pytest.raises(bitvox.ArgumentError):
            other.surface(**wrong)


def test_sharp_surface():
    box = box_mesh((0, 0, 0), (1, 1, 1))
    found = bitvox.field(box, resolution=10, features=True)
    sharp = found.surface(sharp=True)
    assert sharp.report.sharp_cells > 0
    assert abs(sharp.check().volume - 1) <= abs(found.surface(interpolation="scalar").check().volume - 1) + 1e-6
    with pytest.raises(bitvox.Error):
        found.surface(sharp=True, sharp_angle=2.0)


def test_repair(knot):
    torn = bitvox.Mesh(knot.vertices, knot.faces[150:])
    assert not torn.check().closed
    mended = bitvox.repair(torn, resolution=80, measure=True, measure_samples=1000)
    found = mended.check()
    assert found.closed and found.edge_manifold and found.vertex_manifold and found.oriented
    report = mended.report
    assert report.holes >= 1 and report.before.boundary_edges > 0 and report.after.closed and report.lattice.shape
    assert report.distance.samples == 1000 and report.distance.mean > 0
    assert report.sign == "winding"
    painted = bitvox.Mesh(torn.vertices, torn.faces, colors=np.tile([9, 8, 7], (torn.n_vertices, 1)))
    carried = bitvox.repair(painted, resolution=40, carry=True)
    assert carried.colors[:, :3].tolist() == [[9, 8, 7]] * carried.n_vertices and carried.report.after.closed
    assert carried == bitvox.repair(torn, resolution=40)
    small = bitvox.repair(torn, resolution=80, triangles=3000)
    assert small.n_faces <= 3000 and small.check().closed
    sheet = ([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    assert bitvox.repair(sheet, resolution=20).check().closed
    with pytest.raises(bitvox.EmptyError):
        bitvox.repair(sheet, resolution=20, shell=0.0)
    for options in ({"sign": "none"}, {"sign": "normal"}, {"shell": 0.3}, {"measure_samples": 5}, {"resolution": 3, "lattice": bitvox.Lattice((4, 4, 4))}):
        with pytest.raises(bitvox.Error):
            bitvox.repair(torn, **options)


def test_repair_of_thin_walls():
    corners = np.array([[i % 2, i // 2 % 2, i // 4] for i in range(8)], float)
    faces = [[0, 2, 3], [0, 3, 1], [4, 5, 7], [4, 7, 6], [0, 1, 5], [0, 5, 4], [2, 6, 7], [2, 7, 3], [0, 4, 6], [0, 6, 2], [1, 3, 7], [1, 7, 5]]
    plate = bitvox.Mesh(np.concatenate([corners * [1, 1, 0.002], corners + [2, 0, 0]]), faces + [[v + 8 for v in f] for f in faces])
    report = bitvox.repair(plate, resolution=64).report
    assert report.thin_kept and report.thin_voxels > 100 and report.after.components == 2
    assert abs(report.after.volume - 1.002) < 0.005 and 2240 < report.thin_resolution < 2260
    report = bitvox.repair(plate, resolution=64, thin="drop").report
    assert not report.thin_kept and report.thin_voxels > 100 and report.after.components == 1
    with pytest.raises(bitvox.ArgumentError):
        bitvox.repair(plate, thin="no")


def test_fill_by_winding(knot):
    assert bitvox.voxelize(knot, resolution=40, fill="winding") == bitvox.voxelize(knot, resolution=40, fill="nonzero")
