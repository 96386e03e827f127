"""The stages against brute force and against other libraries."""

import pickle

import numpy as np
import pytest
from conftest import TETRAHEDRON, ball_grid, box_mesh

import bitvox


def test_box_fills_exactly_its_voxels():
    grid = bitvox.voxelize(box_mesh((0, 0, 0), (4, 4, 4)), spacing=1.0)
    assert grid.shape == (4, 4, 4) and grid.count == 64
    assert grid.volume == 64.0


def test_tetrahedron_against_half_spaces():
    lattice = bitvox.Lattice((40, 40, 40), 0.0293, (-0.05, -0.06, -0.07))
    grid = bitvox.voxelize(TETRAHEDRON, lattice=lattice)
    at = [lattice.center0[a] + np.arange(40) * lattice.spacing[a] for a in range(3)]
    x, y, z = np.meshgrid(*at, indexing="ij")
    inside = (x > 0) & (y > 0) & (z > 0) & (x + y + z < 1)
    near = np.minimum.reduce([abs(x), abs(y), abs(z), abs(x + y + z - 1)]) < 1e-5  # snapped to the lattice's fixed point
    assert ((grid.to_numpy() == inside) | near).all() and inside.sum() > 5000


def test_solid_against_trimesh(ball):
    trimesh = pytest.importorskip("trimesh")
    pytest.importorskip("rtree")
    grid = bitvox.voxelize(ball, resolution=11)
    centers = np.stack(np.meshgrid(*[grid.center0[a] + np.arange(grid.shape[a]) * grid.spacing[a] for a in range(3)], indexing="ij"), -1)
    inside = trimesh.Trimesh(ball.vertices, ball.faces).contains(centers.reshape(-1, 3)).reshape(grid.shape)
    assert (grid.to_numpy() != inside).sum() <= 2  # rays that graze an edge


def test_windows_are_parts_of_the_whole(knot):
    whole = bitvox.voxelize(knot, resolution=90)
    lattice = whole.lattice
    window = ((7, 11, 3), (40, 30, 9))
    part = bitvox.voxelize(knot, lattice=lattice, window=window)
    x, y, z = window[0]
    assert np.array_equal(part.to_numpy(), whole.to_numpy()[x : x + 40, y : y + 30, z : z + 9])
    assert part == bitvox.voxelize(knot, lattice=lattice, window=(7, 11, 3, 47, 41, 12))


@pytest.mark.parametrize("fill", ["parity", "nonzero", "vote", "flood", "regions"])
def test_fills_agree_on_closed_meshes(ball, fill):
    grid = bitvox.voxelize(ball, resolution=30, fill=fill)
    assert grid == bitvox.voxelize(ball, resolution=30)


def test_fill_auto_takes_what_suits_and_says_why():
    def joined(*boxes):
        return np.concatenate([b[0] for b in boxes]), np.concatenate([b[1] + 8 * i for i, b in enumerate(boxes)])

    large, small, crossing = box_mesh((0, 0, 0), (8, 8, 8)), box_mesh((2, 2, 2), (4, 4, 4)), box_mesh((4, 2, 2), (12, 6, 6))
    for mesh, fill, reason, count in ((large, "parity", "sound", 512), (joined(large, small), "parity", "nested", 504),
                                      (joined(large, crossing), "nonzero", "overlap", 512 + 64)):
        grid = bitvox.voxelize(mesh, spacing=1.0)
        assert (grid.report.fill, grid.report.fill_reason, grid.report.turned, grid.count) == (fill, reason, 0, count)

    vertices, faces = joined(large, crossing)
    faces = faces.copy()
    faces[12:] = faces[12:, ::-1]  # one of them inside out
    grid = bitvox.voxelize((vertices, faces), spacing=1.0)
    assert (grid.report.fill, grid.report.turned, grid.count) == ("nonzero", 12, 512 + 64)

    grid = bitvox.voxelize((large[0], large[1][:-1]), spacing=1.0)
    assert (grid.report.fill, grid.report.fill_reason) == ("winding", "open")


def test_walls_that_voxels_lose_are_in_the_report():
    block, plate = box_mesh((0, 0, 0), (2, 2, 2)), box_mesh((2.5, 2.5, 3.06), (5, 5, 3.1))
    both = np.concatenate([block[0], plate[0]]), np.concatenate([block[1], plate[1] + 8])
    told = bitvox.voxelize(both, resolution=50).report
    assert told.thin_checked is True and told.thin_voxels > 500
    assert told.thin_resolution in range(186, 191) and list(told.thin_box[0])[2] in (30, 31)
    assert abs(told.volume - 8) < 1e-9 and abs(told.mesh_volume - 8.25) < 1e-6
    assert abs(told.crossing_volume - 8) < 1e-3 and told.volume_resolution > 50
    assert bitvox.voxelize(both, resolution=50, check_thin="never").report.thin_checked is False
    whole = bitvox.voxelize(block, resolution=20, check_thin="always").report
    assert (whole.thin_checked, whole.thin_voxels, whole.thin_resolution, whole.volume_resolution) == (True, 0, 0, 0)
    low = bitvox.voxelize(box_mesh((0, 0, 0), (2, 2, 1.97)), resolution=20).report
    assert abs(low.crossing_volume - 7.88) < 0.01 and low.volume_resolution > 20
    with pytest.raises(bitvox.ArgumentError, match="check_thin is 'often'"):
        bitvox.voxelize(both, check_thin="often")
    with pytest.raises(bitvox.ArgumentError, match="check_thin is for mode 'solid'"):
        bitvox.voxelize(both, mode="thin", check_thin="always")



def test_fill_below():
    v = np.array([[0.0, 0, 2], [8, 0, 2], [8, 8, 2], [0, 8, 2]])
    sheet = (v, [[0, 1, 2], [0, 2, 3]])
    lattice = bitvox.Lattice((8, 8, 8))
    grid = bitvox.voxelize(sheet, lattice=lattice, fill="below")
    assert grid.count == 8 * 8 * 2
    assert bitvox.voxelize(sheet, lattice=lattice, fill="below", base=1.0).count == 64
    upper = (v + [0, 0, 3], sheet[1])
    between = bitvox.voxelize(sheet, lattice=lattice, fill="below", second=upper)
    assert between.count == 64 * 3
    side = bitvox.voxelize((v[:, [2, 0, 1]], sheet[1]), lattice=lattice, fill="below", up="x")
    assert side.count == 128 and side[1, 0, 0] and not side[2, 0, 0]


def touches(lattice, triangle):
    """Voxels whose closed box meets a triangle, by separating axes in numpy."""
    centers = np.stack(np.meshgrid(*[np.arange(n) + 0.5 for n in lattice.shape], indexing="ij"), -1)
    p = (triangle - np.array(lattice.corner)) / lattice.spacing
    edges = [p[1] - p[0], p[2] - p[1], p[0] - p[2]]
    axes = [*np.eye(3), np.cross(edges[0], edges[1]), *(np.cross(e, a) for e in edges for a in np.eye(3))]
    hit = np.ones(lattice.shape, bool)
    for axis in axes:
        along, at = p @ axis, centers @ axis
        reach = 0.5 * np.abs(axis).sum()
        hit &= (along.max() >= at - reach) & (along.min() <= at + reach)
    return hit


def test_conservative_surface_and_its_triangles_against_brute_force():
    rng = np.random.default_rng(6)
    lattice = bitvox.Lattice((20, 18, 16))
    points = np.round(rng.uniform(1, 15, (12, 3)) * 1024) / 1024  # on the fixed point
    faces = rng.permutation(12).reshape(4, 3)
    grid = bitvox.voxelize((points, faces), lattice=lattice, mode="conservative", attached=True)
    hits = [touches(lattice, points[f]) for f in faces]
    assert np.array_equal(grid.to_numpy(), np.any(hits, axis=0))
    offsets, triangles = grid.attached
    for n, voxel in enumerate(grid.voxels()):
        assert triangles[offsets[n] : offsets[n + 1]].tolist() == [i for i, h in enumerate(hits) if h[tuple(voxel)]]


def test_surface_modes_hold_each_other(ball):
    conservative, thin, sampled = (bitvox.voxelize(ball, resolution=24, mode=m) for m in ("conservative", "thin", "sampled"))
    assert thin <= conservative and sampled <= conservative and thin.count > 0
    assert sampled.report.samples > 0


def test_options_are_not_ignored(ball):
    for options in (
        {"mode": "thin", "fill": "parity"}, {"mode": "thin", "close_gaps": 1}, {"mode": "solid", "attached": True},
        {"fill": "parity", "close_gaps": 2}, {"fill": "vote", "base": 1.0}, {"up": "z"}, {"fill": "nonzero", "second": ball},
        {"resolution": 8, "spacing": 1.0}, {"resolution": 8, "corner": (0, 0, 0)}, {"spacing": 1.0, "corner": (0, 0, 0), "padding": 1},
        {"spacing": 1.0, "corner": (0, 0, float("inf"))}, {"spacing": 1.0, "corner": (0, 0)},
        {"lattice": bitvox.Lattice((4, 4, 4)), "resolution": 8}, {"lattice": bitvox.Lattice((4, 4, 4)), "padding": 1},
        {"fill": "sideways"}, {"mode": "hollow"}, {"mode": "field"}, {"resolution": 0}, {"padding": -1}, {"resolution": 2.5, }, {"window": (1, 2, 3)},
        {"fill": "flood", "window": (0, 0, 0, 2, 2, 2)}, {"threads": -1}, {"memory_limit": -5},
    ):
        with pytest.raises((bitvox.Error, TypeError)):
            bitvox.voxelize(ball, **options)
    with pytest.raises(TypeError):
        bitvox.voxelize(ball, 64)  # options have names
    for options in ({"levels": 8, "triangles": 10}, {"levels": 8, "collapse": 2}, {"levels": ()}, {"method": "magic"},
                    {"method": "coverage", "edge_samples": 3, "levels": 8}, {"threshold": 1.5, "levels": 8}):
        with pytest.raises(bitvox.Error):
            bitvox.lod(ball, **options)
    with pytest.raises(bitvox.Error):
        bitvox.lod(bitvox.voxelize(ball, resolution=16), levels=8, fill="vote")


def test_surface_is_closed_and_has_the_volume(ball):
    for seed in range(3):
        noise = np.random.default_rng(seed).random((17, 13, 70)) < 0.5
        for rule in ("separate", "join"):
            mesh = bitvox.surface(noise, face_rule=rule)
            found = mesh.check()
            assert found.closed and found.edge_manifold and found.vertex_manifold and found.oriented
            assert bitvox.surface_counts(noise_grid(noise), face_rule=rule) == (mesh.n_vertices, mesh.n_faces)
    assert abs(ball.check().volume / (4 / 3 * np.pi * (24 * 0.4 * 0.25) ** 3) - 1) < 0.03


def noise_grid(array):
    return bitvox.Grid.from_numpy(array)


def test_surface_against_scikit_image():
    measure = pytest.importorskip("skimage.measure")
    array = ball_grid(20)
    mine = bitvox.surface(array)
    theirs = measure.marching_cubes(np.pad(array, 1).astype(np.float32), 0.5)
    ours = {tuple(v) for v in mine.vertices.tolist()}
    others = {tuple(v) for v in (theirs[0] - 0.5).tolist()}  # centers: padded by one, at half voxels
    assert ours == others


def test_windows_merge_to_the_whole():
    rng = np.random.default_rng(8)
    array = rng.random((30, 20, 24)) < 0.5
    lattice = bitvox.Lattice(array.shape, 0.5, (1, 2, 3))
    whole = bitvox.surface(bitvox.Grid.from_numpy(array, lattice=lattice), keys=True)
    parts = []
    for low, high, sides in ((0, 13, ["x-high"]), (12, 30, "x-low")):
        window = bitvox.Grid.from_numpy(array[low:high], lattice=lattice, low=(low, 0, 0))
        parts.append(bitvox.surface(window, keys=True, open_sides=sides))
    joined = bitvox.merge(parts)
    assert joined == whole and joined.content_hash() == whole.content_hash()
    with pytest.raises(bitvox.ArgumentError, match="keys"):
        bitvox.merge([bitvox.surface(array)])


def test_chunks_with_a_voxel_of_each_neighbor_have_all_faces_once():
    whole = bitvox.Grid.from_numpy(np.random.default_rng(4).random((20, 12, 9)) > 0.5)
    triangles = [mesh.vertices[mesh.faces] for mesh in (
        bitvox.faces(whole.crop(((0, 0, 0), (11, 12, 9))), open_sides="x-high"), bitvox.faces(whole.crop(((9, 0, 0), (11, 12, 9))), open_sides=["x-low"]))]
    every = bitvox.faces(whole)

    def listed(of):
        return sorted(map(tuple, of.reshape(-1, 9).tolist()))
    assert listed(np.concatenate(triangles)) == listed(every.vertices[every.faces])
    with pytest.raises(bitvox.ArgumentError, match="open_sides"):
        bitvox.faces(whole, open_sides="up")


def test_faces():
    array = np.zeros((5, 5, 5), bool)
    array[1:4, 1:4, 1:4] = True
    grid = bitvox.Grid.from_numpy(array)
    mesh = bitvox.faces(grid)
    assert mesh.n_faces == 6 * 9 * 2 and mesh.check().volume == 27.0
    assert bitvox.faces(grid, merge=True).n_faces == 12


def test_lod(knot):
    levels = bitvox.lod(knot, levels=(48, 24))
    assert [max(level.report.resolution) for level in levels] == [48, 24]
    for level in levels:
        found = level.check()
        assert found.closed and found.edge_manifold and found.vertex_manifold and found.oriented
    small = bitvox.lod(knot, triangles=900, collapse=2)[0]
    assert 700 < small.n_faces <= 900
    solid = bitvox.voxelize(knot, resolution=128)
    assert bitvox.lod(solid, levels=[(32, 32, 16)])[0].report.resolution == (32, 32, 16)
    assert bitvox.lod(solid.to_numpy(), levels=[16], method="coverage")[0].n_faces > 0
    with pytest.raises(bitvox.RangeError):
        bitvox.lod(solid, levels=500)
    with pytest.raises(bitvox.ArgumentError, match="triangles or voxels"):
        bitvox.lod(knot.vertices[knot.faces], levels=8)


def test_positions_are_doubles_only_where_floats_are_too_coarse():
    cube = np.zeros((32, 32, 32), bool)
    cube[4:28, 4:28, 4:28] = True
    grid = bitvox.Grid.from_numpy(cube, spacing=1 / 16, corner=(0, 4096, 0))
    fine, coarse = bitvox.lod(grid, levels=(32, 4))
    assert fine.vertices.dtype == np.float64 and coarse.vertices.dtype == np.float32
    made = bitvox.surface(grid)
    assert made.vertices.dtype == np.float64 and (made.n_vertices, made.n_faces) == bitvox.surface_counts(grid)
    with pytest.raises(bitvox.RangeError, match="too coarse"):
        bitvox.surface(grid, dtype="float32")
    assert bitvox.surface(grid, local_frame=True).vertices.dtype == np.float32


def test_compare_meshes(ball):
    moved = bitvox.Mesh(ball.vertices + np.float32(0.01), ball.faces)
    found = bitvox.compare(ball, moved, samples=2000)
    assert found.samples == 2000 and 0 < found.mean < 0.02
    assert bitvox.compare(ball, ball, samples=100).max < 1e-6
    with pytest.raises(TypeError):
        bitvox.compare(ball, bitvox.voxelize(ball, resolution=8))
    grid = bitvox.voxelize(ball, resolution=8)
    assert bitvox.compare(grid, ~grid).both == 0
    with pytest.raises(bitvox.ArgumentError, match="meshes"):
        bitvox.compare(grid, ~grid, samples=10)


def test_seed():
    ball = bitvox.surface(ball_grid(16))
    shell = bitvox.voxelize(ball, resolution=20, padding=1, mode="conservative")
    seed = bitvox.find_seed(shell, ball)
    assert seed.found and seed.verified
    pockets = bitvox.find_pockets(shell, ball)
    assert len(pockets) == 1 and shell.fill(pockets) == shell.fill([seed.voxel])
    assert not bitvox.find_seed(shell, limit=1).found


def test_refine_to_a_resolution_and_files_of_trees(knot):
    tree = bitvox.refine(knot, resolution=64)
    assert max(tree.lattice().shape) >= 64
    two = bitvox.refine(knot, resolution=50, levels=2)
    assert two.levels == 2 and max(two.lattice(0).shape) == 13 and max(two.lattice().shape) == 52
    data = bitvox.dumps(tree, "bvx")
    again = bitvox.loads(data, "bvx")
    assert isinstance(again, bitvox.Octree) and bitvox.dumps(again, "bvx") == data
    assert again.expand() == tree.expand()
    assert bitvox.dumps(pickle.loads(pickle.dumps(tree)), "bvx") == data
    with pytest.raises(bitvox.FormatError):
        bitvox.loads(data[:-1], "bvx")
    with pytest.raises(bitvox.ArgumentError):
        bitvox.loads(data, "bvx", window=((0, 0, 0), (1, 1, 1)))
    with pytest.raises(bitvox.ArgumentError):
        bitvox.refine(knot, base=bitvox.Lattice.fit(knot, resolution=8), resolution=64)


def test_octree(knot):
    tree = bitvox.refine(knot, base=8, levels=3)
    assert tree.levels == 3
    lattice = tree.lattice()
    expected = bitvox.voxelize(knot, lattice=lattice, mode="conservative")
    assert tree.expand(states="surface") == expected
    leaves = tree.leaves()
    assert sum(8 ** (3 - int(l)) for l in leaves["level"]) == tree.expand().count
    middle = np.array(lattice.corner) + (expected.voxels()[:5] + 0.5) * lattice.spacing
    assert (tree.find(middle)["state"] == 4).all()
    assert np.array_equal(tree.at(expected.voxels()[:5])["ijk"], tree.find(middle)["ijk"])
    assert sum(c.voxels - c.split for c in tree.counts()) == len(tree.leaves(("outside", "inside", "surface")))
    beside = tree.neighbors(leaves[len(leaves) // 2], "+x")
    assert all(leaf["state"] in (1, 2, 4) for leaf in beside)
    hits = tree.cast([[*(middle[0] - [9, 0, 0]), 1, 0, 0]])
    assert hits["hit"][0] == 1 and hits["leaf"]["level"][0] <= 3
    assert tree.surface(states="surface,inside").content_hash() == tree.expand().surface().content_hash()
    assert b"UnstructuredGrid" in bitvox.dumps(tree, "vtu")[:400]
    for options in ({"levels": 26}, {"outer_levels": 1}, {"adaptive": -1.0}, {"base": 8, "resolution": 64}, {"base": 0}):
        with pytest.raises(bitvox.Error):
            bitvox.refine(knot, **options)
    with pytest.raises(bitvox.Error):
        tree.leaves("soft")


def test_render(ball):
    grid = bitvox.voxelize(ball, resolution=24)
    image = bitvox.render(ball, size=(60, 40))
    assert image.size == (60, 40) and image.pixels.shape == (40, 60, 3)
    assert image.png() == bitvox.render(ball, size=(60, 40), threads=1).png()
    assert image.png()[:8] == b"\x89PNG\r\n\x1a\n" == ball._repr_png_()[:8] == grid._repr_png_()[:8] == image._repr_png_()[:8]
    assert (np.asarray(image)[0, 0] == 255).all() and (np.asarray(image)[20, 30] < 255).any()
    different = [bitvox.render(grid, size=(240, 180), **o).png() for o in (
        {}, {"cut": {"x": 3.0}}, {"wireframe": True}, {"from_": (1, 0, 0)}, {"color": (255, 0, 0)},
        {"compare": grid - bitvox.voxelize(ball, lattice=grid.lattice, mode="thin")}, {"background": (0, 0, 0)})]
    assert len(set(different)) == len(different)
    painted = bitvox.Mesh(ball.vertices, ball.faces, colors=np.tile([250, 10, 10], (ball.n_vertices, 1)))
    pixel = bitvox.render(painted, size=(60, 40)).pixels[20, 30]
    assert pixel[0] > 2 * pixel[1]
    for options in ({"size": (0, 10)}, {"cut": {"q": 1}}, {"samples": 9}, {"color": (1, 2)}):
        with pytest.raises(bitvox.Error):
            bitvox.render(grid, **options)
    with pytest.raises(bitvox.ArgumentError):
        bitvox.render(ball, compare=grid)


def test_what_needs_no_repair_keeps_its_attributes(knot):
    colored = bitvox.Mesh(knot.vertices, knot.faces, colors=np.full((knot.n_vertices, 3), 9), uvs=np.zeros((knot.n_vertices, 2)))
    same = bitvox.repair(colored, if_needed=True)
    assert same == colored and same.report.copied and (same.colors == colored.colors).all() and same.uvs is not None and colored.report is None
    assert bitvox.repair(colored, if_needed=True, triangles=500).n_faces <= 500
