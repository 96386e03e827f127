"""Levels of detail by edges that collapse: lod, simplify, and targets of the other stages."""

import pickle

import numpy as np
import pytest
from conftest import TETRAHEDRON, ball_grid, box_mesh
from hypothesis import given, settings
from hypothesis import strategies as st

import bitvox
from bitvox import reports

QUICK = settings(max_examples=25, deadline=None)


def certified(mesh):
    """All that a level promises."""
    found = mesh.check()
    assert found.closed and found.edge_manifold and found.vertex_manifold and found.oriented
    if isinstance(mesh.report, reports.LevelReport):
        assert mesh.report.crossings == 0 and mesh.report.certificate == found
    if hasattr(bitvox.Mesh, "crossings"):
        assert len(mesh.crossings()) == 0
    return found


def shuffled(mesh, seed):
    """The same triangles with vertices and triangles in another order, each begun at another corner."""
    rng = np.random.default_rng(seed)
    order, rows = rng.permutation(mesh.n_vertices), rng.permutation(mesh.n_faces)
    faces = np.argsort(order).astype(np.uint32)[np.asarray(mesh.faces)[rows]]
    turn = (np.arange(3) + rng.integers(0, 3, (len(faces), 1))) % 3
    return bitvox.Mesh(np.asarray(mesh.vertices)[order], np.take_along_axis(faces, turn, 1))


def corners(mesh):
    """Its triangles as sets of positions, whatever their order."""
    triangles = np.asarray(mesh.vertices)[np.asarray(mesh.faces)]
    first = np.lexsort(triangles.transpose(2, 0, 1)[::-1], axis=1)[:, :1]
    turned = np.take_along_axis(triangles, ((first + np.arange(3)) % 3)[..., None], 1).reshape(-1, 9)
    return turned[np.lexsort(turned.T[::-1])]


# ---- simplify ----


def test_levels_by_error_do_not_depend_on_order():
    mesh = bitvox.faces(np.ones((9, 8, 7), bool)).astype("float64")
    mesh = bitvox.Mesh(np.asarray(mesh.vertices) + 0.1 * np.sin(np.asarray(mesh.vertices)[:, ::-1]), np.asarray(mesh.faces))
    want = mesh.simplify(error=0.05)
    for seed in range(3):
        got = shuffled(mesh, seed).simplify(error=0.05)
        assert np.array_equal(got.vertices, want.vertices) and np.array_equal(got.faces, want.faces) and got.report == want.report


def test_borders_of_colors_stay():
    x, y, z = (a.ravel() for a in np.meshgrid(*[np.arange(-20.0, 21.0)] * 3, indexing="ij"))
    ball = bitvox.surface((x * x + y * y + z * z < 300).reshape(41, 41, 41))
    side = np.asarray(ball.vertices)[:, 0] > 22.25  # between two columns of vertices
    painted = bitvox.Mesh(ball.vertices, ball.faces, colors=np.where(side[:, None], (250, 0, 0), (0, 0, 250)))

    def shift(level):
        """How far the line between the colors lies from x = 22.25 in the mean."""
        red, x, faces = np.asarray(level.colors)[:, 0] / 250 - 0.5, np.asarray(level.vertices, float)[:, 0], np.asarray(level.faces)
        a, b = faces.ravel(), np.roll(faces, -1, 1).ravel()
        crossed = (red[a] > 0) != (red[b] > 0)
        a, b = a[crossed], b[crossed]
        return np.abs(x[a] + (x[b] - x[a]) * red[a] / (red[a] - red[b]) - 22.25).mean()

    for make in (lambda w: painted.simplify(triangles=600, attribute_weight=w), lambda w: bitvox.lod(painted, triangles=600, attribute_weight=w)[0]):
        plain, kept = make(0), make(10)
        assert certified(kept).closed and shift(kept) < 0.5 * shift(plain)
    assert np.array_equal(corners(painted.simplify(triangles=300, attribute_weight=0)), corners(bitvox.Mesh(ball.vertices, ball.faces).simplify(triangles=300)))


def tube():
    """A tube of 48 by 30 with a seam of its texture, normals, colors and two materials; u = angle, v = height."""
    u, v = (a.ravel() for a in np.meshgrid(np.arange(49) / 48, np.arange(31) / 30))
    angle = 2 * np.pi * (np.arange(49) % 48) / 48
    x, y = np.cos(np.tile(angle, 31)), np.sin(np.tile(angle, 31))
    first = (np.arange(30)[:, None] * 49 + np.arange(48)).ravel()
    faces = np.concatenate([np.stack([first, first + 1, first + 50], 1), np.stack([first, first + 50, first + 49], 1)])
    materials = np.tile(np.arange(30) >= 15, (48, 1)).T.ravel()
    return {"vertices": np.stack([x, y, 3 * v], 1), "faces": faces, "normals": np.stack([x, y, 0 * x], 1), "uvs": np.stack([u, v], 1),
            "uvs2": np.stack([v, u], 1), "materials": np.concatenate([materials, materials]).astype(np.int64),
            "colors": np.stack([255 * v, 0 * v, 255 - 255 * v], 1).astype(np.uint8)}


def test_attributes_are_kept_as_given():
    given = tube()
    mesh = bitvox.Mesh(**given)
    for made in (mesh, mesh.astype(), mesh.drop_nonfinite(), pickle.loads(pickle.dumps(mesh))):
        assert np.array_equal(made.vertex_normals, given["normals"].astype(np.float32)) and made.vertex_normals.dtype == np.float32
        assert np.array_equal(made.uvs2, given["uvs2"].astype(np.float32)) and np.array_equal(made.materials, given["materials"])
        assert made.materials.dtype == np.uint32
    n, m = len(given["vertices"]), len(given["faces"])
    for wrong, words in (({"normals": np.zeros((n, 2))}, rf"\({n}, 3\)"), ({"uvs2": np.zeros((n - 1, 2))}, rf"\({n}, 2\)"),
                         ({"materials": np.zeros(m)}, "integers"), ({"materials": np.zeros(m + 1, int)}, rf"\({m},\)")):
        with pytest.raises(bitvox.ArgumentError, match=words):
            bitvox.Mesh(given["vertices"], given["faces"], **wrong)
    with pytest.raises(bitvox.RangeError, match="materials"):
        bitvox.Mesh(given["vertices"], given["faces"], materials=np.full(m, -1))


def test_levels_have_the_attributes_of_the_mesh():
    given = tube()
    mesh = bitvox.Mesh(**given)
    for level in (mesh.simplify(triangles=400), bitvox.simplify(mesh, triangles=[400])[0], bitvox.lod(mesh, triangles=400)[0]):
        assert level.n_faces <= 400 and level.report.met and level.report.crossings == 0
        n, faces, place = level.n_vertices, np.asarray(level.faces), np.asarray(level.vertices, float)
        assert level.vertex_normals.shape == (n, 3) and level.uvs2.shape == (n, 2) and level.colors.shape == (n, 4) and level.uv_faces is None
        assert np.abs(np.asarray(level.vertex_normals)[:, 2]).max() < 0.01
        u, v = np.asarray(level.uvs, float).T
        assert np.abs(np.ptp(u[faces], axis=1)).max() < 0.5, "a triangle across the seam"
        assert np.abs(v - place[:, 2] / 3).max() < 0.02 and np.allclose(level.uvs2, np.asarray(level.uvs)[:, ::-1], atol=0.02)
        assert np.abs(np.asarray(level.colors, float)[:, 0] / 255 - v).max() < 0.03
        middle = place[faces][:, :, 2].mean(1)
        assert set(level.materials.tolist()) == {0, 1} and middle[level.materials == 0].max() < 1.7 and middle[level.materials == 1].min() > 1.3
    assert bitvox.lod(mesh, triangles=400, solid=True)[0].uvs is None
    assert bitvox.Mesh(given["vertices"], given["faces"]).simplify(triangles=400).vertex_normals is None


def test_texture_coordinates_of_their_own_indices_stay_so():
    given = tube()
    column = np.arange(len(given["vertices"])) % 49
    once = np.cumsum(column < 48) - 1  # the last column is the first one again
    numbers = np.where(column < 48, once, once - 47)
    mesh = bitvox.Mesh(given["vertices"][column < 48], numbers[given["faces"]], uvs=given["uvs"], uv_faces=given["faces"])
    for level in (mesh.simplify(triangles=400), *bitvox.lod(mesh, triangles=400), mesh.simplify(triangles=400, vertices="kept")):
        assert level.check().components == 1 and level.check().boundary_edges > 0 and level.uv_faces.shape == (level.n_faces, 3)
        u = np.asarray(level.uvs, float)[np.asarray(level.uv_faces), 0]
        assert np.abs(np.ptp(u, axis=1)).max() < 0.5


def test_kept_and_locked_vertices():
    mesh = bitvox.Mesh(**tube())
    for level in (mesh.simplify(triangles=400, vertices="kept"), bitvox.lod(mesh, triangles=400, vertices="kept")[0]):
        assert level.n_faces <= 400 and np.array_equal(level.vertices, mesh.vertices) and np.array_equal(level.vertex_normals, mesh.vertex_normals)
        assert np.array_equal(level.uvs, mesh.uvs) and np.array_equal(level.colors, mesh.colors) and set(level.materials.tolist()) == {0, 1}
    rng = np.random.default_rng(3)
    locked = rng.random(mesh.n_vertices) < 0.05
    level = mesh.simplify(triangles=400, locked=locked)
    there = set(map(tuple, np.asarray(level.vertices).tolist()))
    assert all(tuple(p) in there for p in np.asarray(mesh.vertices)[locked].tolist())
    level = bitvox.lod(mesh, triangles=600, lock_border=True)[0]
    ends = [np.asarray(m.vertices)[np.isin(np.asarray(m.vertices)[:, 2], (0, 3))] for m in (mesh, level)]
    assert set(map(tuple, ends[0].tolist())) == set(map(tuple, ends[1].tolist()))


def test_materials_of_a_file_go_into_the_files_of_levels(tmp_path, shared):
    helmet = bitvox.read(shared("gltf/DamagedHelmet.glb"))
    level = helmet.simplify(triangles=4000)
    level.save(tmp_path / "one.glb")
    bitvox.write_levels(tmp_path / "all.glb", bitvox.lod(helmet, triangles=(4000, 1000)))
    for name in ("one.glb", "all.glb"):
        back = (tmp_path / name).read_bytes()
        assert b'"images"' in back and b'"textures"' in back and b'"materials"' in back and b"TEXCOORD_0" in back


def test_what_stays_is_asked_for(ball):
    assert ball.simplify(triangles=300, attribute_weight=0) == ball.simplify(triangles=300)
    with pytest.raises(bitvox.ArgumentError, match="has no attributes"):
        bitvox.lod(ball, triangles=300, solid=True, attribute_weight=2)
    with pytest.raises(bitvox.ArgumentError, match="levels of the mesh as it is have its attributes"):
        bitvox.lod(ball, triangles=300, carry=True)
    for call in (bitvox.simplify, bitvox.lod):
        for options, words in (({"attribute_weight": -1}, "attribute_weight"), ({"attribute_weight": 1001}, "attribute_weight"),
                               ({"vertices": "some"}, "placed, kept"), ({"locked": [1]}, "locked has 1 values")):
            with pytest.raises(bitvox.ArgumentError, match=words):
                call(ball, triangles=300, **options)
    for options in ({"lock_border": True}, {"vertices": "kept"}, {"locked": [0] * ball.n_vertices}):
        with pytest.raises(bitvox.ArgumentError, match="measure a new surface"):
            bitvox.lod(ball, triangles=300, solid=True, **options)


def test_simplify_keeps_flat_faces():
    fine = bitvox.faces(np.ones((12, 12, 12), bool))
    ideal = sorted((float(x), float(y), float(z)) for x in (0, 12) for y in (0, 12) for z in (0, 12))
    for even, digits in ((0, 12), (None, 3)):
        box = fine.simplify(triangles=12, even=even)
        assert box.n_faces == 12 and certified(box).volume == pytest.approx(12.0**3, rel=1e-4)
        assert sorted(map(tuple, np.round(np.asarray(box.vertices, float), digits).tolist())) == ideal
        assert box.report.met and box.report.target == 12 and box.report.least_angle == pytest.approx(45, abs=0.01)


def sheet(n=12):
    """A wavy square of n x n cells, two triangles each."""
    x, y = (a.ravel() for a in np.meshgrid(np.arange(n + 1.0), np.arange(n + 1.0)))
    a = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).ravel()
    faces = np.concatenate([np.stack([a, a + 1, a + n + 2], 1), np.stack([a, a + n + 2, a + n + 1], 1)])
    return bitvox.Mesh(np.stack([x, y, np.sin(x / 3) + np.cos(y / 4)], 1), faces)


def test_sheets_stay_open():
    for level in (bitvox.simplify(sheet(), triangles=60), sheet().simplify(triangles=60), bitvox.lod(sheet(), triangles=60)[0]):
        found = level.check()
        assert level.n_faces <= 60 and not found.closed and found.euler == 1 and found.boundary_edges >= 4
        assert found.edge_manifold and found.vertex_manifold and found.oriented
        assert level.report.certificate.boundary_edges == found.boundary_edges and level.report.crossings == 0
    assert not bitvox.lod(sheet(), triangles=60).report.solid
    shell = bitvox.lod(sheet(), triangles=400, solid=True)
    assert shell.report.solid and certified(shell[0]).closed


def test_joints_are_told_and_cut():
    flat, n = sheet(), 13
    wall = np.concatenate([np.asarray(flat.vertices), np.asarray(flat.vertices)[6::n] + (0, 0, 5)])
    low, high = np.arange(12) * n + 6, n * n + np.arange(12)
    faces = np.concatenate([np.asarray(flat.faces), np.stack([low, low + n, high + 1], 1), np.stack([low, high + 1, high], 1)])
    mesh = bitvox.Mesh(wall, faces)
    cut = bitvox.lod(mesh, triangles=60)
    assert not cut.report.solid and cut.report.cut == 12 and cut.report.cut_edge[0][0] == 6
    assert cut[0].check().edge_manifold and cut[0].check().components == 3
    assert mesh.simplify(triangles=60) == cut[0]
    assert certified(bitvox.lod(mesh, triangles=600, solid=True)[0]).closed


def test_bodies_that_touch_stay_two():
    vertices, faces = box_mesh()
    vertices = np.asarray(vertices, float)
    size = vertices.max(0) - vertices.min(0)
    two = bitvox.Mesh(np.concatenate([vertices, vertices + size * (1, 1, 0)]), np.concatenate([faces, np.asarray(faces) + len(vertices)]))
    levels = bitvox.lod(two, triangles=24)
    assert levels.report.parted == 1 and levels.report.split == 2 and levels.report.cut == 0
    assert certified(levels[0]).components == 2 and levels[0].check().volume == pytest.approx(2 * size.prod())


def test_simplify_gives_a_mesh_or_a_list(knot):
    one = bitvox.simplify(knot, triangles=2000)
    assert isinstance(one, bitvox.Mesh) and one.n_faces <= 2000 and one.vertices.dtype == knot.vertices.dtype
    several = knot.simplify(triangles=(8000, 2000, np.int64(500)))
    assert type(several) is list and [level.report.target for level in several] == [8000, 2000, 500]
    assert several == knot.simplify(triangles=np.array([8000, 2000, 500]))
    assert [level.n_faces for level in knot.simplify(count=3)] == [19200, 9600, 4800]
    half = knot.simplify()
    assert isinstance(half, bitvox.Mesh) and half.n_faces == 19200 and half == knot.simplify(triangles=19200)
    assert len(knot.simplify(triangles=[500])) == 1
    for level in (one, half, *several):
        assert certified(level).components == 1 and level.report.certificate.euler == 0
        assert type(level.report) is reports.LevelReport
    assert knot.simplify(triangles=500, dtype="float64").vertices.dtype == np.float64
    assert pickle.loads(pickle.dumps(one)).report == one.report


def test_errors_are_kept(knot):
    low, high = np.array(knot.bounds)
    diagonal = float(np.linalg.norm(high - low))
    by_share = knot.simplify(error="0.1 %", samples=30000)
    by_units = knot.simplify(error=0.001 * diagonal, samples=30000)
    assert by_share == by_units and by_share.report.met and by_share.report.measured
    assert by_share.report.distance.mean <= 0.001 * diagonal
    assert bitvox.compare(knot, by_share, samples=30000).mean == pytest.approx(by_share.report.distance.mean, rel=0.05)
    usual = knot.simplify(error="0.1%")
    assert usual.report.measured and usual.report.distance.samples == 20000 and not knot.simplify(triangles=900).report.measured
    assert knot.simplify(triangles=900).report.distance is None and bitvox.repair(knot, resolution=16).report.distance is None
    worst = knot.simplify(error="0.1%", error_kind="max")
    assert worst.report.distance.max <= 0.001 * diagonal
    assert worst.n_faces > by_share.n_faces
    near, far = knot.simplify(error=["0.05%", 0.05])
    assert near.n_faces > far.n_faces and near.report.target_error == pytest.approx(0.0005 * diagonal)
    for level in (by_share, worst, near, far):
        certified(level)


@pytest.mark.parametrize("wrong", [0, -1, "0%", "much", "", "%", "1%%", float("nan"), float("inf"), "nan%", True, b"1%", [], [None], ["1%", "x"]])
def test_errors_that_are_none(ball, wrong):
    for call in (bitvox.simplify, bitvox.lod):
        with pytest.raises(bitvox.ArgumentError, match="error"):
            call(ball, error=wrong)


def test_targets_that_cannot_be_kept(ball):
    least = ball.simplify(triangles=1)
    assert not least.report.met and 4 <= least.n_faces < ball.n_faces  # not crumpled
    certified(least)
    with pytest.raises(bitvox.RangeError, match=f"level 0.* {least.n_faces} triangles"):
        ball.simplify(triangles=1, strict=True)
    with pytest.raises(bitvox.RangeError, match="level 1"):
        bitvox.lod(ball, triangles=(100, 1), strict=True)
    assert ball.simplify(triangles=10**9) == ball.simplify(triangles=ball.n_faces)  # nothing goes


def test_meshes_of_any_quality(ball):
    torn = bitvox.Mesh(ball.vertices, np.asarray(ball.faces)[3:])
    turned = bitvox.Mesh(ball.vertices, np.concatenate((np.asarray(ball.faces)[:1, ::-1], np.asarray(ball.faces)[1:])))
    assert torn.simplify(triangles=100).check().boundary_edges > 0 and certified(turned.simplify(triangles=100)).closed
    for mesh in (torn, turned):
        for level in bitvox.lod(mesh, triangles=(200, 60), solid=True):
            certified(level)
    with pytest.raises(bitvox.EmptyError):
        bitvox.Mesh(np.zeros((0, 3)), np.zeros((0, 3), np.uint32)).simplify(triangles=4)
    with pytest.raises(bitvox.RangeError, match="vertex 2"):
        bitvox.simplify((np.where(np.arange(12).reshape(4, 3) == 7, np.nan, TETRAHEDRON[0]), TETRAHEDRON[1]), error="1%")


def test_soup_is_welded(ball):
    soup = bitvox.Mesh(np.asarray(ball.vertices)[np.asarray(ball.faces)])
    assert np.array_equal(corners(soup.simplify(triangles=300)), corners(ball.simplify(triangles=300)))


@QUICK
@given(st.integers(0, 2**32 - 1), st.floats(0.3, 0.7), st.integers(1, 400), st.sampled_from(["float32", "float64"]))
def test_any_closed_mesh_in_any_order(seed, share, target, dtype):
    noise = np.random.default_rng(seed).random((7, 6, 9)) < share
    if not noise.any():
        return
    mesh = bitvox.surface(noise, dtype=dtype)
    before = mesh.check()
    level = mesh.simplify(triangles=target)
    after = certified(level)
    assert (after.components, after.euler) == (before.components, before.euler)
    assert level.report.met == (level.n_faces <= target)
    again = shuffled(mesh, seed).simplify(triangles=target)
    assert np.array_equal(corners(level), corners(again))


def test_frame_and_type_are_kept():
    far = 1.0e7
    grid = bitvox.Grid.from_numpy(ball_grid(20), spacing=0.25, corner=(far, -far, far))
    mesh = grid.surface(local_frame=True, dtype="float32")
    level = mesh.simplify(triangles=200)
    assert level.frame == mesh.frame and level.vertices.dtype == np.float32
    assert certified(level).low[0] == pytest.approx(far, abs=6) and level.bounds[0][0] == pytest.approx(mesh.bounds[0][0], abs=0.3)
    mended = bitvox.repair(mesh, resolution=40, local_frame=True, dtype="float32", triangles=300)
    assert mended.vertices.dtype == np.float32 and mended.n_faces <= 300 and any(mended.frame)
    assert mended.bounds[0][0] == pytest.approx(mesh.bounds[0][0], abs=0.3)


def test_colors_are_carried(ball):
    red = np.asarray(ball.vertices)[:, 0] > np.median(np.asarray(ball.vertices)[:, 0])
    painted = bitvox.Mesh(ball.vertices, ball.faces, colors=np.where(red[:, None], [255, 0, 0], [0, 0, 255]).astype(np.uint8))
    for level in (painted.simplify(triangles=300), *bitvox.lod(painted, triangles=300), *bitvox.lod(painted, triangles=300, solid=True, carry=True)):
        assert level.colors.shape == (level.n_vertices, 4) and {0, 255} <= set(level.colors[:, 0].tolist())
    assert bitvox.lod(painted, triangles=300, solid=True)[0].colors is None


# ---- lod ----


def test_lod_without_options_halves(knot):
    levels = bitvox.lod(knot)
    assert isinstance(levels, list) and [level.n_faces for level in levels] == [19200, 9600, 4800, 2400]
    assert type(levels.report) is reports.LevelsReport and not levels.report.solid and levels.report.before.closed
    for level in levels:
        certified(level)
    assert levels == knot.simplify(count=4)
    assert [level.n_faces for level in bitvox.lod(box_mesh())] == [bitvox.lod(box_mesh())[0].n_faces]  # 12 triangles: one level
    assert len(bitvox.lod(knot, count=7)) == 7
    copied = pickle.loads(pickle.dumps(levels))
    assert copied == levels and copied.report == levels.report


def test_flags_of_any_type(knot):
    assert bitvox.lod(knot, triangles=500, local_frame=0, solid=np.False_) == bitvox.lod(knot, triangles=500)
    assert len(bitvox.lod(knot, levels=(16,), lock_border=0, strict=np.False_)) == 1


def test_lod_of_torn_meshes(knot):
    torn = bitvox.Mesh(knot.vertices, np.asarray(knot.faces)[400:])
    kept = bitvox.lod(torn, triangles=(4000, 1000), samples=5000)
    assert not kept.report.solid and not kept.report.before.closed and all(level.report.distance.mean < 0.05 for level in kept)
    assert 0 < kept[0].check().boundary_edges <= kept.report.before.boundary_edges and kept.report.triangles == torn.n_faces
    levels = bitvox.lod(torn, triangles=(4000, 1000), samples=5000, solid=True)
    assert levels.report.solid and not levels.report.before.closed and levels.report.repair.holes > 0
    assert levels.report.triangles > 4000 and max(levels.report.repair.lattice.shape) >= 256
    for level in levels:
        assert certified(level).components == 1 and level.report.met and level.report.distance.mean < 0.05
    assert bitvox.lod(knot, triangles=1000, solid=True).report.solid and not bitvox.lod(knot, triangles=1000).report.solid
    assert bitvox.lod(knot, triangles=1000, resolution=60).report.solid


def test_what_the_lattice_decides():
    outer, inner = ball_grid(40), np.pad(ball_grid(16), 12)
    grain = np.zeros((60, 40, 40), bool)
    grain[:40] = outer & ~inner
    grain[55:57, 20:22, 20:22] = True
    mesh = bitvox.surface(grain)
    assert mesh.check().components == 3
    whole = bitvox.lod(mesh, triangles=2000, solid=True, sign="parity", resolution=120)[0]
    assert certified(whole).components == 3
    hull = bitvox.lod(mesh, triangles=2000, outer_hull=True, sign="parity", resolution=120)[0]
    assert certified(hull).components == 2 and hull.check().volume > whole.check().volume + 500
    large = bitvox.lod(mesh, triangles=2000, least_part=5000, least_cavity=100000, sign="parity", resolution=120)
    assert certified(large[0]).components == 1 and large.report.repair.parts_dropped == 1
    assert bitvox.lod(mesh, triangles=500, lattice=bitvox.Lattice.fit(mesh, resolution=90, padding=2)).report.repair.lattice.shape[0] == 94


@QUICK
@given(st.integers(0, 2**32 - 1), st.integers(1, 60), st.integers(1, 3))
def test_any_triangles_give_levels_or_a_reason(seed, triangles, count):
    rng = np.random.default_rng(seed)
    soup = bitvox.Mesh(rng.uniform(-1, 1, (triangles, 3, 3)))
    try:
        levels = bitvox.lod(soup, triangles=[400 >> i for i in range(count)], resolution=24)
    except bitvox.EmptyError:
        return
    assert len(levels) == count
    for level in levels:
        certified(level)


def test_the_paper_s_methods_are_chosen_by_their_options(knot):
    voxels = bitvox.voxelize(knot, resolution=64)
    for levels in (bitvox.lod(knot, levels=16), bitvox.lod(voxels), bitvox.lod(voxels, method="edge-ratio", triangles=900), bitvox.lod(voxels.to_numpy(), levels=(16, 8)),
                   bitvox.lod(knot, triangles=900, collapse=2), bitvox.lod(knot, method="coverage"), bitvox.lod(knot, method="edge_ratio", triangles=900),
                   bitvox.lod(knot, triangles=900, fill="vote"), bitvox.lod(knot, triangles=900, threshold=0.4)):
        assert type(levels[0].report) is reports.LodReport and levels.report is None
    smooth = bitvox.lod(voxels, method="collapse", triangles=900)
    assert type(smooth[0].report) is reports.LevelReport and smooth[0].n_faces <= 900
    assert bitvox.lod(voxels, triangles=900) == smooth == [voxels.surface().simplify(triangles=900)]
    assert bitvox.lod(voxels.to_numpy(), error=0.5)[0].report.distance.mean <= 0.5


CONTRADICTIONS = [
    ({"triangles": 100, "error": 0.1}, "triangles and error"), ({"triangles": 100, "count": 2}, "triangles and count"),
    ({"error": "1%", "count": 2}, "error and count"), ({"error_kind": "max"}, "error_kind .* error"),
    ({"error": "1%", "error_kind": "mode"}, "mean, max"), ({"triangles": (100, 200)}, "finest first"), ({"error": ("1%", "0.5%")}, "finest first"),
    ({"triangles": ()}, "names none"), ({"error": 0.1, "levels": 8}, "levels .* error"), ({"levels": 8, "sharp": False}, "levels .* sharp"),
    ({"method": "collapse", "levels": 8}, "levels is for .*; method 'collapse' takes triangles"), ({"method": "coverage", "error": "1%"}, "error is for method 'collapse'"),
    ({"method": "edge-ratio", "strict": True}, "strict is for method 'collapse'"), ({"method": "magic"}, "collapse, edge-ratio, coverage"),
    ({"lock_border": True, "resolution": 64}, "measure a new surface"), ({"vertices": "kept", "outer_hull": True}, "measure a new surface"),
    ({"resolution": 64, "lattice": bitvox.Lattice((4, 4, 4))}, "resolution and lattice"), ({"outer_hull": True, "least_cavity": 5}, "cavity"),
    ({"sign": "none"}, "sign"), ({"even": 2}, "even"), ({"shell": 0.5}, "shell"), ({"dtype": "int8"}, "dtype"),
]


@pytest.mark.parametrize("options, words", CONTRADICTIONS)
def test_contradictions(ball, options, words):
    with pytest.raises(bitvox.ArgumentError, match=words):
        bitvox.lod(ball, **options)


def test_more_slips(ball):
    grid = bitvox.voxelize(ball, resolution=16)
    for call, kind, words in (
        (lambda: bitvox.lod(grid, count=2), ValueError, "method='collapse'"), (lambda: bitvox.lod(grid, triangles=50, carry=True), ValueError, "carry"),
        (lambda: bitvox.lod(grid, method="collapse", triangles=50, carry=True), ValueError, "carry"),
        (lambda: bitvox.lod(ball, method=3), TypeError, "method"), (lambda: bitvox.lod(ball, triangles=99.5), TypeError, "integer"),
        (lambda: bitvox.lod(ball, triangles=0), bitvox.RangeError, "triangles"), (lambda: bitvox.lod(ball, count=0), bitvox.RangeError, "count"),
        (lambda: bitvox.lod(ball, resolution=0), bitvox.RangeError, "resolution"), (lambda: ball.simplify(100), TypeError, "positional"),
        (lambda: bitvox.repair(ball, triangles=(20, 10)), ValueError, "Mesh.simplify takes several"),
        (lambda: bitvox.repair(ball, triangles=20, error="1%"), ValueError, "triangles and error"),
        (lambda: bitvox.simplify(grid, triangles=20), TypeError, "Grid"),
    ):
        with pytest.raises(kind, match=words):
            call()


def test_progress_cancel_and_limits(knot):
    seen = []
    levels = bitvox.lod(knot, triangles=(4000, 1000), progress=lambda stage, fraction: seen.append((stage, fraction)))
    assert len(seen) > 5 and all(0 <= fraction <= 1 for _, fraction in seen)
    assert levels == bitvox.lod(knot, triangles=(4000, 1000), threads=1) == bitvox.lod(knot, triangles=(4000, 1000), threads=3)
    for stop in range(0, len(seen) - 1, max(1, len(seen) // 7)):  # the answer to the last one, of 1, is ignored
        left = [stop]

        def cancel(stage, fraction, left=left):
            left[0] -= 1
            return left[0] >= 0

        with pytest.raises(bitvox.Cancelled):
            bitvox.lod(knot, triangles=(4000, 1000), progress=cancel)
    with pytest.raises(bitvox.Cancelled):
        knot.simplify(triangles=1000, progress=lambda *_: False)
    for limit in (1000, 100_000, 1_000_000):
        with pytest.raises(MemoryError):
            bitvox.lod(knot, triangles=1000, memory_limit=limit)
        with pytest.raises(bitvox.MemoryLimitError):
            knot.simplify(triangles=1000, memory_limit=limit)
    assert knot.simplify(triangles=1000, memory_limit=2**28).n_faces <= 1000


# ---- targets of the other stages ----


def test_repair_to_a_target(knot):
    torn = bitvox.Mesh(knot.vertices, np.asarray(knot.faces)[400:])
    whole = bitvox.repair(torn, resolution=100)
    small = bitvox.repair(torn, resolution=100, triangles=3000, measure=True, measure_samples=5000)
    assert certified(small).triangles <= 3000 and small == whole.simplify(triangles=3000)
    assert type(small.report) is reports.RepairReport and small.report.holes > 0
    assert small.report.after == small.check() and small.report.distance == bitvox.compare(torn, small, samples=5000)
    assert bitvox.repair(torn, resolution=100, error="0.2%") == whole.simplify(error="0.2%")
    assert bitvox.repair(torn, resolution=100, triangles=0) == whole
    flipped = box_mesh()[0], np.concatenate((box_mesh()[1][:4, ::-1], box_mesh()[1][4:]))
    assert bitvox.repair(flipped, sharp=True, resolution=64, triangles=12).n_faces < bitvox.repair(flipped, sharp=True, resolution=64).n_faces / 50


def test_boolean_and_sections_to_a_target(knot):
    moved = bitvox.Mesh(np.asarray(knot.vertices) + np.float32(0.3), knot.faces)
    both = bitvox.boolean(knot, moved, "union", resolution=80, triangles=2000)
    assert certified(both).triangles <= 2000 and type(both.report) is reports.BooleanReport
    far = bitvox.Mesh(np.asarray(knot.vertices) + np.float32(100), knot.faces)
    assert bitvox.boolean(knot, far, "intersection", resolution=80, triangles=2000).n_faces == 0
    around = np.linspace(0, 2 * np.pi, 60, endpoint=False)
    loops = [np.column_stack([r * np.cos(around), r * np.sin(around), np.full(60, z)]) for z, r in ((0, 3.0), (2, 4.0), (5, 2.5))]
    body = bitvox.from_sections(loops, spacing=0.5)
    small = bitvox.from_sections(loops, spacing=0.5, error="0.2%")
    assert certified(small).triangles < body.n_faces / 2 and type(small.report) is reports.SectionsReport
    with pytest.raises(bitvox.ArgumentError, match="open"):
        bitvox.from_sections(loops, caps="open", triangles=100)
    volume = bitvox.Volume(bitvox.voxelize(knot, resolution=60, padding=4).distance("signed"))
    assert certified(volume.surface(0.0, below=True, triangles=2000)).triangles <= 2000
    for options in ({"keys": True}, {"open_sides": "x-low"}):
        with pytest.raises(bitvox.ArgumentError, match="merge"):
            volume.surface(0.0, triangles=2000, **options)
    with pytest.raises(bitvox.ArgumentError, match="error_kind .* error"):
        volume.surface(0.0, error_kind="max")
