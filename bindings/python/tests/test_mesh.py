"""Meshes: arrays of any kind, without a wrong answer."""

import os
import pickle
import warnings

import numpy as np
import pytest
from conftest import TETRAHEDRON, ball_grid, box_mesh
from hypothesis import given, settings
from hypothesis import strategies as st

import bitvox
from bitvox import Mesh

V, F = box_mesh((0, 0, 0), (8, 6, 4))
WANTED = bitvox.voxelize((V, F), spacing=1.0)


def solid(vertices, faces):
    return bitvox.voxelize((vertices, faces), spacing=1.0)


@pytest.mark.parametrize("dtype", ["f2", "f4", "f8", ">f4", ">f8", "i1", "u1", "i2", ">i4", "i8", "u8", np.longdouble])
def test_vertices_of_any_type(dtype):
    assert solid(V.astype(dtype), F) == WANTED


@pytest.mark.parametrize("dtype", ["i1", "u1", "i2", "u2", "i4", "u4", "i8", "u8", ">i2", ">u4", ">i8"])
def test_faces_of_any_type(dtype):
    assert solid(V, F.astype(dtype)) == WANTED


@settings(deadline=None, max_examples=40)
@given(st.sampled_from(["f4", "f8"]), st.sampled_from(["i4", "u4", "i8", "u2"]), st.integers(1, 3), st.integers(0, 2),
       st.sampled_from(["C", "F", "columns", "backwards", "rows"]))
def test_any_strides(vtype, ftype, step, spare, how):
    def lay(array, dtype):
        array = array.astype(dtype)
        if how == "F":
            return np.asfortranarray(array)
        if how == "columns":  # columns of a wider table
            wide = np.full((len(array) * step, 3 + spare), 99, dtype)
            wide[::step, spare:] = array
            return wide[::step, spare:]
        if how == "backwards":
            return array[::-1].copy()[::-1]
        if how == "rows":
            wide = np.full((len(array), 3 * (spare + 1)), 7, dtype)
            wide[:, :: spare + 1] = array
            return wide[:, :: spare + 1]
        return array

    mesh = Mesh(lay(V, vtype), lay(F, ftype))
    assert np.array_equal(mesh.vertices, V) and np.array_equal(mesh.faces, F)
    assert bitvox.voxelize(mesh, spacing=1.0) == WANTED
    assert mesh.content_hash() == Mesh(V.astype(vtype), F).content_hash()


def test_arrays_are_borrowed_where_they_can_be():
    wide = np.zeros((8, 6))
    wide[:, :3] = V
    mesh = Mesh(wide[:, :3], F)
    assert np.shares_memory(mesh.vertices, wide) and np.shares_memory(mesh.faces, F)
    V2, F2 = V.copy(), F.copy()
    V2.flags.writeable = F2.flags.writeable = False
    assert solid(V2, F2) == WANTED


def test_unaligned_arrays():
    raw = np.zeros(8 * 24 + 1, np.uint8)
    odd = raw[1:].view("f8").reshape(8, 3)
    odd[:] = V
    assert not odd.flags.aligned and solid(odd, F) == WANTED


@pytest.mark.parametrize("dtype", ["i1", "i2", "i4", "i8"])
def test_negative_faces_are_named(dtype):
    bad = F.astype(dtype)
    bad[5, 1] = -1
    with pytest.raises(bitvox.RangeError, match=r"faces\[5, 1\] is -1"):
        bitvox.check((V, bad))
    with pytest.raises(bitvox.RangeError, match=r"faces\[5, 1\] is -1"):
        solid(V, bad)
    with pytest.raises(bitvox.RangeError, match=r"faces\[5, 1\] is -1"):
        bitvox.dumps((V, bad), "ply")


def test_faces_beyond_the_vertices():
    bad = F.copy()
    bad[3, 2] = 8
    with pytest.raises(bitvox.RangeError, match="3"):
        bitvox.check((V, bad))
    bad[3, 2] = 2**40
    with pytest.raises(bitvox.RangeError):
        solid(V, bad)
    with pytest.raises(bitvox.RangeError):
        Mesh(V, bad).content_hash()


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_vertices_that_are_no_numbers_are_named(value):
    bad = V.copy()
    bad[6, 1] = value
    with pytest.raises(bitvox.RangeError, match="6"):
        bitvox.check((bad, F))
    with pytest.raises(ValueError, match="6"):
        solid(bad, F)


def test_refused_values():
    for vertices in (V.astype(complex), V.astype(object), V.astype(str), V > 1):
        with pytest.raises(TypeError):
            Mesh(vertices, F)
    for faces in (F.astype(float), F > 1, F.astype(object)):
        with pytest.raises(TypeError):
            Mesh(V, faces)
    for vertices in (V[:, :2], V.ravel(), V[None]):
        with pytest.raises(bitvox.ArgumentError):
            Mesh(vertices, F)
    for faces in (F[:, :2], F.ravel(), np.zeros((2, 4), int)):
        with pytest.raises(bitvox.ArgumentError):
            Mesh(V, faces)
    with pytest.raises(bitvox.RangeError, match="2\\*\\*53"):
        Mesh(np.full((3, 3), 2**60 + 1), [[0, 1, 2]])
    with pytest.raises(bitvox.ArgumentError, match="masked"):
        Mesh(np.ma.masked_greater(V, 5), F)
    with pytest.raises(bitvox.ArgumentError):
        Mesh([[0, 0, 0], [1, 0]], F)
    with pytest.raises(bitvox.ArgumentError, match="threes"):
        Mesh(V)
    with pytest.raises(TypeError):
        bitvox.check(3)
    with pytest.raises(bitvox.ArgumentError):
        bitvox.check((V, F, F))


def test_soup_and_lists():
    triangles = V[F]
    assert bitvox.voxelize(triangles, spacing=1.0) == WANTED
    assert bitvox.voxelize(Mesh(triangles.reshape(-1, 3)), spacing=1.0) == WANTED
    assert solid(V.tolist(), F.tolist()) == WANTED
    assert solid(tuple(map(tuple, V.tolist())), [tuple(f) for f in F.tolist()]) == WANTED
    soup = Mesh(triangles)
    assert soup.n_faces == 12 and soup.faces.tolist() == np.arange(36).reshape(12, 3).tolist()
    assert not soup.check().closed and soup.check(weld=True).closed


def test_empty():
    empty = Mesh(np.zeros((0, 3)), np.zeros((0, 3), int))
    assert not empty.check().closed and empty.n_faces == 0
    with pytest.raises(bitvox.EmptyError):
        bitvox.voxelize(empty)
    with pytest.raises(bitvox.EmptyError):
        bitvox.voxelize((V, np.zeros((0, 3), int)))
    with pytest.raises(bitvox.EmptyError):
        bitvox.voxelize(([], []))


def test_certificate():
    found = bitvox.check((V, F))
    assert found.closed and found.edge_manifold and found.vertex_manifold and found.oriented
    assert (found.vertices, found.edges, found.triangles, found.euler) == (8, 18, 12, 2)
    assert found.volume == 192.0 and found.area == 208.0 and found.high == (8.0, 6.0, 4.0)
    assert isinstance(found.closed, bool)
    opened = bitvox.check((V, F[1:]))
    assert not opened.closed and opened.boundary_edges == 3


def test_types_as_asked():
    mesh = bitvox.surface(WANTED)
    assert mesh.vertices.dtype == np.float32 and mesh.faces.dtype == np.uint32
    wide = mesh.astype("float64", "int64")
    assert wide.vertices.dtype == np.float64 and wide.faces.dtype == np.int64
    assert np.array_equal(wide.faces, mesh.faces)
    assert np.shares_memory(mesh.astype().vertices, mesh.vertices)
    assert bitvox.surface(WANTED, dtype="float64").vertices.dtype == np.float64
    assert bitvox.surface(WANTED, dtype=np.float64).vertices.dtype == np.float64
    with pytest.raises(bitvox.ArgumentError):
        bitvox.surface(WANTED, dtype="float16")
    with pytest.raises(bitvox.RangeError):
        Mesh(np.zeros((300, 3)), [[0, 1, 299]]).astype(faces="uint8")


def test_arrays_outlive_the_mesh():
    mesh = bitvox.surface(WANTED)
    vertices, faces, expected = mesh.vertices, mesh.faces, mesh.vertices.copy()
    del mesh
    for _ in range(50):
        bitvox.surface(WANTED)
    assert np.array_equal(vertices, expected) and faces.max() < len(vertices)


def test_pickle_equality_repr():
    mesh = bitvox.surface(WANTED, keys=True)
    again = pickle.loads(pickle.dumps(mesh))
    assert again == mesh and again.content_hash() == mesh.content_hash()
    assert np.array_equal(again.keys[0], mesh.keys[0])
    assert mesh != Mesh(V, F) and mesh != 3
    assert repr(Mesh(V, F)) == "Mesh(8 vertices, 12 faces)"
    certificate = mesh.check()
    assert pickle.loads(pickle.dumps(certificate)) == certificate


def test_a_lattice_around_a_box():
    low, high = (-1.5, 0.25, 1e4), (4.0, 0.5, 1e4 + 2)
    for options in ({}, {"resolution": 33, "padding": 2}, {"resolution": (3, 4, 5)}, {"spacing": 0.3}, {"spacing": 0.3, "corner": (-2, 0, 9999)}):
        assert bitvox.Lattice.fit_box(low, high, **options) == bitvox.Lattice.fit(box_mesh(low, high), **options)
    with pytest.raises(bitvox.ArgumentError, match="along x"):
        bitvox.Lattice.fit_box(high, low)
    with pytest.raises(bitvox.EmptyError):
        bitvox.Lattice.fit_box(low, low)
    with pytest.raises(bitvox.RangeError):
        bitvox.Lattice.fit_box(low, (1, float("nan"), 3))


def test_float64_where_float32_is_too_coarse():
    far = (V + [500000.0, 5000000.0, 0.0], F)
    grid = bitvox.voxelize(far, spacing=0.5)
    assert bitvox.surface(grid).vertices.dtype == np.float64
    with pytest.raises(bitvox.RangeError, match="f64"):
        bitvox.surface(grid, dtype="float32")
    local = bitvox.surface(grid, dtype="float32", local_frame=True)
    assert local.frame == grid.corner
    assert np.allclose(local.in_world(), bitvox.surface(grid).vertices)
    assert bitvox.lod(grid, levels=4)[0].vertices.dtype == np.float64


def test_a_local_frame_is_not_forgotten():
    """What was made about a local origin lies where the world has it, for every function."""
    far = (V + [500000.0, 5000000.0, 0.0], F)
    grid = bitvox.voxelize(far, spacing=0.5)
    local, world = (bitvox.surface(grid, local_frame=yes, dtype="float64") for yes in (True, False))
    assert local.frame == grid.corner and world.frame == (0, 0, 0) and local.bounds == world.bounds
    assert bitvox.voxelize(local, lattice=grid.lattice) == bitvox.voxelize(world, lattice=grid.lattice) == grid
    assert local.check().low == world.check().low
    assert bitvox.Closest(local).find([world.vertices[5]])["distance"][0] == 0.0
    assert bitvox.compare(local, world, samples=100).max < 1e-6
    assert bitvox.dumps(bitvox.slice_mesh(local, spacing=1.0), "csl") == bitvox.dumps(bitvox.slice_mesh(world, spacing=1.0), "csl")
    assert bitvox.refine(local, levels=2).lattice() == bitvox.refine(world, levels=2).lattice()
    assert bitvox.repair(local, resolution=16).content_hash() == bitvox.repair(world, resolution=16).content_hash()


def test_colors_and_uvs():
    mesh = Mesh(V, F, colors=np.linspace(0, 1, 24).reshape(8, 3))
    assert mesh.colors.shape == (8, 4) and (mesh.colors[:, 3] == 255).all()
    assert mesh.colors[7].tolist() == [233, 244, 255, 255]
    back = bitvox.loads(bitvox.dumps(mesh, "ply"), "ply")
    assert np.array_equal(back.colors, mesh.colors)
    level = bitvox.lod(mesh, levels=8, carry=True)[0]
    assert level.colors.shape == (level.n_vertices, 4) and level.colors[:, 0].max() > 150
    painted = bitvox.carry(mesh, bitvox.surface(WANTED))
    assert painted.colors.shape == (painted.n_vertices, 4)
    again = bitvox.carry(Mesh(V, F, colors=np.full((8, 3), 9)), painted)
    assert (again.colors[:, :3] == 9).all() and not (painted.colors[:, :3] == 9).all()
    textured = Mesh(V, F, uvs=V[:, :2] / 8)
    assert np.allclose(bitvox.carry(textured, Mesh(V, F)).uvs, V[:, :2] / 8)
    for bad in (np.zeros((7, 3)), np.zeros((8, 2)), np.full((8, 3), 300), np.full((8, 3), -0.5), np.full((8, 3), np.nan)):
        with pytest.raises(ValueError):
            Mesh(V, F, colors=bad)
    with pytest.raises(ValueError):
        Mesh(V, F, uvs=np.zeros((8, 2)), uv_faces=np.full((12, 3), 8))


def test_closest_against_brute_force():
    tetra = TETRAHEDRON
    closest = bitvox.Closest(tetra)
    points = np.random.default_rng(4).normal(size=(50, 3))
    found = closest.find(points)
    weights = np.random.default_rng(5).dirichlet([0.4, 0.4, 0.4], 20000)
    samples = np.concatenate([weights @ tetra[0][f] for f in tetra[1]])
    brute = np.sqrt(((points[:, None] - samples) ** 2).sum(-1)).min(1)
    assert (found["distance"] <= brute + 1e-12).all() and (brute - found["distance"] < 0.05).all()
    corners = tetra[0][tetra[1][found["triangle"]]]
    assert np.allclose((found["weight"][..., None] * corners).sum(1), found["position"])
    assert closest.find([0.0, 0.0, 0.0])["feature"][0] >= 4


def test_measure(tetrahedron, knot):
    v, f = np.asarray(tetrahedron[0], float), np.asarray(tetrahedron[1])
    found = bitvox.Mesh(v, f).measure(density=3)
    volume = abs(np.linalg.det(v[1:] - v[0])) / 6
    about = np.einsum("ia,ib->ab", v - v.mean(0), v - v.mean(0)) * volume / 20 * 3
    assert np.isclose(found.volume, volume) and np.isclose(found.mass, 3 * volume) and found.resolution == 0
    assert np.allclose(found.center, v.mean(0)) and np.allclose(found.inertia[:3], [about.trace() - about[a, a] for a in range(3)])
    assert np.allclose(found.inertia[3:], [-about[0, 1], -about[0, 2], -about[1, 2]])
    moved = bitvox.Mesh(v, f, frame=(1000, 0, -2000)).measure()
    assert np.allclose(moved.center, v.mean(0) + (1000, 0, -2000)) and np.isclose(moved.volume, volume)
    turned = np.where((np.arange(knot.n_faces) % 5 == 0)[:, None], np.asarray(knot.faces)[:, ::-1], knot.faces)
    assert np.isclose(bitvox.Mesh(knot.vertices, turned).measure().volume, knot.measure().volume)
    torn = bitvox.Mesh(knot.vertices, np.asarray(knot.faces)[200:]).measure(resolution=64)
    assert torn.resolution == 64 and torn.fill == "winding" and abs(torn.volume - knot.volume) < torn.volume_error
    for wrong in ({"density": 0}, {"density": float("nan")}, {"resolution": 0}, {"resolution": 2049}):
        with pytest.raises(bitvox.ArgumentError):
            knot.measure(**wrong)
    with pytest.raises(bitvox.EmptyError):
        bitvox.Mesh(v, f[:0]).measure()


def test_inspect(knot):
    v = np.array([[x, y, z] for x in (0, 4) for y in (0, 3) for z in (0, 0.5)], float)
    f = np.array([[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]])
    found = bitvox.inspect((v, f), walls=0.6, density=2, thickness=True, resolution=40)
    assert found.sound and found.needs == "nothing" and np.isclose(found.report.volume, 6) and np.isclose(found.report.mass, 12)
    assert np.allclose(found.thickness, 0.5) and np.isclose(found.report.least_thickness, 0.5) and found.report.least_gap == np.inf
    assert len(found.walls) == found.report.found[0] == 1 and np.isclose(found.walls[0].size, 0.5) and abs(found.walls[0].position[2] - 0.25) < 0.1
    assert found.gaps == found.cavities == found.islands == () and np.isclose(found.report.thin_area, 24)
    # A second plate above: a gap, and an island along z, none along x.
    two = bitvox.inspect((np.concatenate([v, v + (0, 0, 1)]), np.concatenate([f, f + 8])), gaps=0.7, resolution=40)
    assert two.sound and np.isclose(two.gaps[0].size, 0.5) and len(two.islands) == 1 and np.isclose(two.islands[0].size, 12, rtol=0.1)
    assert bitvox.inspect((np.concatenate([v, v + (0, 0, 1)]), np.concatenate([f, f + 8])), up="x", resolution=40).islands == ()
    torn = bitvox.inspect((knot.vertices, np.asarray(knot.faces)[9:]), resolution=24, most=1)
    assert not torn.sound and torn.needs == "lids" and torn.report.least_thickness > 0.5 and torn.thickness is None
    for wrong in ({"walls": -1}, {"gaps": float("nan")}, {"density": 0}, {"up": "w"}, {"most": 0}, {"resolution": 0}):
        with pytest.raises(bitvox.ArgumentError):
            bitvox.inspect(knot, **wrong)
    with pytest.raises(bitvox.EmptyError):
        bitvox.inspect((v, f[:0]))


def test_crossings(tetrahedron):
    v, f = np.asarray(tetrahedron[0], float), np.asarray(tetrahedron[1])
    assert bitvox.Mesh(v, f).crossings().shape == (0, 2)
    assert bitvox.Mesh(np.zeros((3, 3)), np.zeros((0, 3), np.uint32)).crossings().shape == (0, 2)
    twice = bitvox.Mesh(np.concatenate([v, v + 0.125]), np.concatenate([f, f + len(v)]))
    pairs = twice.crossings(threads=2)
    assert pairs.dtype == np.uint32 and pairs.shape[1] == 2 and len(pairs) > 2
    assert (pairs[:, 0] < len(f)).all() and (pairs[:, 1] >= len(f)).all()
    assert pairs.tolist() == sorted(pairs.tolist())
    same = bitvox.Mesh(v, np.concatenate([f, f[:1, ::-1]])).crossings()
    assert same.tolist() == [[0, len(f)]]
    with pytest.raises(bitvox.RangeError):
        bitvox.Mesh(np.where(v == 0, v, np.inf), f).crossings()


def test_normals():
    ball = bitvox.surface(ball_grid(), dtype="float64")
    vertices, facets = ball.normals()
    assert vertices.shape == (ball.n_vertices, 3) and facets.shape == (ball.n_faces, 3) and facets.dtype == np.float32
    corners = ball.vertices[ball.faces]
    own = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert np.allclose(facets, own / np.linalg.norm(own, axis=1, keepdims=True), atol=1e-6)
    mean = vertices[ball.faces].sum(axis=1)
    assert np.allclose(ball.normals(averaged=True)[1], mean / np.linalg.norm(mean, axis=1, keepdims=True), atol=1e-6)
    with pytest.raises(bitvox.EmptyError):
        bitvox.Mesh(np.zeros((3, 3)), np.zeros((0, 3), np.uint32)).normals()


def test_pieces_keep_their_attributes():
    (a, faces), (b, _) = box_mesh(), box_mesh((5, 0, 0), (9, 4, 4))
    both = bitvox.Mesh(np.concatenate([a, b]), np.concatenate([faces, faces + 8]), colors=np.arange(48).reshape(16, 3), normals=np.ones((16, 3)),
                       materials=np.arange(24), uvs=np.arange(10).reshape(5, 2), uv_faces=np.arange(72).reshape(24, 3) % 5)
    large, small = both.split()
    assert large.check().volume == pytest.approx(64) and small.check().volume == pytest.approx(1) and small.check().closed
    assert np.array_equal(large.colors, both.colors[8:]) and np.array_equal(large.materials, both.materials[12:])
    assert np.array_equal(small.uv_faces, both.uv_faces[:12]) and np.array_equal(small.uvs, both.uvs)
    assert both.keep(largest=1) == large and both.keep(largest=2).n_faces == 24 and bitvox.Mesh(np.zeros((0, 3)), np.zeros((0, 3), int)).split() == []
    corners = bitvox.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [2, 0, 0], [3, 0, 0]], [[0, 1, 2], [3, 4, 1]])
    assert len(corners.split()) == 1  # a common vertex is enough
    chain = np.arange(4001)
    long = bitvox.Mesh(np.c_[chain, chain % 2, 0 * chain].astype(float), np.c_[chain[:-2], chain[1:-1], chain[2:]][:, ::-1])
    assert len(long.split()) == 1


def test_a_surface_without_crumbs():
    array = np.zeros((30, 20, 20))
    array[3:12, 3:17, 3:17], array[6:9, 7:12, 7:12] = 5.0, 0.0  # a body with a cavity
    array[15:17, 4:6, 4:6], array[20, 10, 10], array[28, 2, 2] = 5.0, 5.0, 2.0
    for turn in (None, [[0, -1, 0], [1, 0, 0], [0, 0, 1]], [[0.8, -0.6, 0], [0.6, 0.8, 0], [0, 0, 1]]):
        volume, alone = (bitvox.Volume(np.where(mask, array, 0.0), direction=turn) for mask in (True, np.arange(30)[:, None, None] < 13))
        assert volume.surface(3.0).check().components == 4
        assert volume.surface(3.0, keep_largest=1) == alone.surface(3.0) and volume.report.inside == alone.report.inside
        assert volume.surface(3.0, keep_largest=2).check().components == 3


def test_lists_of_bodies():
    bodies = [bitvox.Mesh(*box_mesh((x, 0, 0), (x + 2, 2, 2))) for x in (0, 1, 5)]
    union = bitvox.boolean(bodies, "union", resolution=64)
    assert union.check().closed and union.volume == pytest.approx(20, rel=0.03)
    assert bitvox.boolean(bodies, "difference", resolution=64).volume == pytest.approx(4, rel=0.05)
    with pytest.raises(bitvox.ArgumentError, match="two at a time"):
        bitvox.boolean(bodies, "xor")
    for wrong in ((bodies[0], "union"), (bodies[0], bodies[1])):
        with pytest.raises(TypeError, match="two meshes and an operation"):
            bitvox.boolean(*wrong)


def test_lists_of_bodies_inside_one_another():
    """What lies inside another body of a list is no cavity of it, whichever way it faces and whatever the rule."""
    def box(x, y, side, inwards=False):
        corners, faces = box_mesh((x - side, y - side, -side), (x + side, y + side, side))
        return np.asarray(corners, float), np.asarray(faces)[:, :: -1 if inwards else 1]

    def both(*boxes):
        return bitvox.Mesh(np.concatenate([v for v, _ in boxes]), np.concatenate([f + 8 * i for i, (_, f) in enumerate(boxes)]))

    first, large = box(6, 0, 1), box(0, 0, 1)
    for bodies, want in (((first, large, box(0, 0, 0.5)), 16), ((first, large, box(0, 0, 0.5, True)), 16), ((first, box(0, 0, 0.5), large), 16),
                         ((first, large, both(box(0, 0, 0.5), box(-6, 0, 1))), 24), ((first, both(large, box(0, 0, 0.5, True)), box(0, 0, 0.25)), 15.125)):
        with warnings.catch_warnings():
            warnings.filterwarnings("error", ".*hollow")
            assert bitvox.boolean(list(bodies), "union", resolution=64).volume == pytest.approx(want, rel=0.005)
    for fill, body in (("parity", box(1, 1, 1)), ("nonzero", box(1, 1, 1, True))):
        assert bitvox.boolean([first, large, body], "union", resolution=64, fill=fill).volume == pytest.approx(22, rel=0.005)
    assert bitvox.boolean([box(0, 0, 2), large, box(0, 0, 0.5)], "difference", resolution=64).volume == pytest.approx(56, rel=0.005)


def test_words_of_other_libraries(knot):
    for call, hint in ((lambda: knot.simplify(ratio=0.1), r"round\(ratio \* mesh"), (lambda: bitvox.lod(knot, target_reduction=0.9), r"round\(\(1 - target_reduction\)"),
                       (lambda: bitvox.simplify(knot, face_count=10), "triangles="), (lambda: bitvox.lod(knot, triangles=0.1), r"round\(0.1 \* mesh"),
                       (lambda: bitvox.boolean(knot, knot, "subtract"), "'difference' is meant"), (lambda: knot.check(threads=-1), "0: all processors"),
                       (lambda: bitvox.Volume(np.zeros((2, 2, 2))) > 0.5, "threshold"), (lambda: bitvox.Volume(np.zeros((2, 2, 2))) <= 0.5, "threshold"),
                       (lambda: bitvox.repair(knot, triangles=0.1), r"round\(0.1 \* mesh"), (lambda: knot.check(memory_limit="1GB"), "bytes"),
                       (lambda: bitvox.Volume(np.ones((2, 2, 2), int)).surfaces(triangles=0.1), r"round\(0.1 \* mesh"), (lambda: bitvox.Grid.from_numpy(np.ones((2, 2, 2))) | np.ones((2, 2, 2)), "from_numpy"),
                       (lambda: knot.transform(np.zeros((4, 4))), "last row is")):
        with pytest.raises((TypeError, bitvox.Error), match=hint):
            call()


def test_a_missed_target_is_said():
    noise = bitvox.Grid.from_numpy(np.random.default_rng(0).random((8, 8, 8)) > 0.5).surface()
    with pytest.warns(UserWarning, match="the target of 10 triangles is missed: [0-9]+ are"):
        assert not noise.simplify(triangles=10).report.met
    with pytest.warns(UserWarning, match="is missed.*1 more level missed"):
        bitvox.lod(noise, triangles=(10, 5))
    with pytest.raises(bitvox.RangeError), warnings.catch_warnings():
        warnings.simplefilter("error")
        noise.simplify(triangles=10, strict=True)


def test_names_of_files_may_be_bytes(knot, tmp_path):
    knot.save(os.fsencode(tmp_path / "k.ply"))
    assert bitvox.read(os.fsencode(tmp_path / "k.ply")) == knot


def test_rays_meet_a_box_once_where_triangles_meet():
    box = bitvox.Closest((V, F))
    rays = [[4, 3, -5, 0, 0, 1], [0, 0, -5, 8, 6, 9], [4, 3, 9, 0, 0, 1], [-1, 3, 2, 2, 0, 0]]
    hits = box.cast(rays)
    assert hits["side"].tolist() == [1, 1, 0, 1]
    assert hits["position"][[0, 3]].tolist() == [[4, 3, 0], [0, 3, 2]]
    offsets, found = box.crossings(rays)
    assert np.diff(offsets.astype(int)).tolist() == [2, 2, 0, 2]
    assert found["side"].tolist() == [1, -1] * 3 and found["t"][:2].tolist() == [5, 9]
    assert box.cast(rays, t_max=4.5)["side"].tolist() == [0, 1, 0, 1]
    with pytest.raises(bitvox.ArgumentError, match="direction"):
        box.cast([[0, 0, 0, 0, 0, 0]])


def test_a_mesh_contains_the_centers_of_its_solid(knot):
    knot = Mesh.of(knot)
    grid = bitvox.voxelize(knot, resolution=40)
    index = np.argwhere(np.ones(grid.shape, bool))
    points = np.asarray(grid.lattice.corner) + (index + 0.5) * np.asarray(grid.lattice.spacing)
    asked = bitvox.Closest(knot)
    inside = asked.contains(points)
    assert (inside == grid.to_numpy()[tuple(index.T)]).mean() > 0.999  # the mesh is snapped to the lattice there
    assert np.array_equal(asked.winding(points), inside)
    distance = asked.find(points, signed=True)["distance"]
    assert ((distance < 0) == inside).all() and np.array_equal(np.abs(distance), asked.find(points)["distance"])


@pytest.mark.parametrize("links", [6, 18, 26])
def test_links_end_where_rays_meet_the_mesh(knot, links):
    knot = Mesh.of(knot)
    solid = bitvox.voxelize(knot, resolution=24)
    beside = ~solid & solid.dilate(connectivity=links)
    asked = bitvox.Closest(knot)
    values = asked.links(beside, links)
    assert values.shape == (beside.count, links) and values.dtype == np.float32
    ways = np.array([way[::-1] for way in np.ndindex(3, 3, 3)]) - 1
    ways = ways[np.isin(np.abs(ways).sum(axis=1), range(1, {6: 2, 18: 3, 26: 4}[links]))]
    centers = np.asarray(solid.lattice.corner) + (beside.voxels() + 0.5) * np.asarray(solid.spacing)
    rays = np.concatenate([np.repeat(centers, links, axis=0), np.tile(ways * np.asarray(solid.spacing), (len(centers), 1))], axis=1)
    hits = asked.cast(rays, t_max=1)
    assert np.array_equal(values.ravel(), np.where(hits["side"] == 0, -1, hits["t"]).astype(np.float32))
    assert (values >= 0).any(axis=1).mean() > 0.999  # the mesh is snapped to the lattice in voxelize
    for wrong in (7, -1, 2**30):
        with pytest.raises(bitvox.ArgumentError, match=f"6, 18 or 26 links, not {wrong}"):
            asked.links(beside, wrong)


def test_smooth_keeps_faces_attributes_and_volume():
    stairs = bitvox.faces(bitvox.Grid.from_numpy(ball_grid(24)))
    colored = bitvox.Mesh(stairs.vertices, stairs.faces, colors=np.full((stairs.n_vertices, 4), 200, np.uint8), normals=np.ones((stairs.n_vertices, 3)), frame=(1, 2, 3))
    for method in ("sinc", "taubin"):
        smooth = colored.smooth(method=method, no_crossings=True)
        assert (smooth.faces == stairs.faces).all() and (smooth.colors == 200).all() and smooth.normals()[0].shape == (stairs.n_vertices, 3)
        assert smooth.frame == (1, 2, 3) and smooth.vertices.dtype == stairs.vertices.dtype
        assert smooth.report.volume_before == pytest.approx(stairs.volume) and smooth.volume == pytest.approx(stairs.volume, rel=0.02)
        assert smooth.area < 0.8 * stairs.area and len(smooth.crossings()) <= len(stairs.crossings())
    assert stairs.smooth(threads=1) == stairs.smooth(threads=3)
    held = stairs.smooth(sharp_angle=45)
    assert held.report.held > 1000 and (held.vertices == stairs.vertices).all()  # all others lie in planes
    for wrong in ({"method": "laplace"}, {"iterations": 0}, {"pass_band": 0}, {"pass_band": 2}, {"sharp_angle": 200}):
        with pytest.raises(bitvox.Error):
            stairs.smooth(**wrong)
