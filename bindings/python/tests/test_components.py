"""Parts of grids and clouds of points, beside scipy, cc3d and scikit-image."""

import gzip

import numpy as np
import pytest
from conftest import REPOSITORY, ball_grid

import bitvox

SHAPES = [(1, 5, 7), (63, 6, 5), (64, 5, 6), (65, 7, 4), (129, 4, 5)]


def noise(shape, share, seed=3):
    return np.random.default_rng(seed).random(shape) < share


def canonical(labels):
    """The same parts, numbered by their first voxel in the order z, y, x."""
    flat = labels.transpose(2, 1, 0).reshape(-1)
    _, first = np.unique(flat[flat != 0], return_index=True)
    table = np.zeros(int(flat.max()) + 1, np.uint32)
    table[flat[flat != 0][np.sort(first)]] = np.arange(1, len(first) + 1)
    return table[labels]


@pytest.mark.parametrize("connectivity", [6, 18, 26])
@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("share", [0.05, 0.3, 0.9])
def test_labels_are_scipys(shape, share, connectivity):
    ndimage = pytest.importorskip("scipy.ndimage")
    array = noise(shape, share)
    grid = bitvox.Grid.from_numpy(array)
    wanted, count = ndimage.label(array, ndimage.generate_binary_structure(3, {6: 1, 18: 2, 26: 3}[connectivity]))
    labels = grid.label(connectivity=connectivity)
    assert labels.dtype == np.uint32 and labels.shape == shape
    assert np.array_equal(labels, canonical(wanted))
    parts = grid.components(connectivity=connectivity)
    assert len(parts) == count
    assert parts["voxels"].tolist() == np.bincount(labels.reshape(-1), minlength=count + 1)[1:].tolist()
    for i, box in enumerate(ndimage.find_objects(labels.astype(np.int64))):
        assert parts["low"][i].tolist() == [s.start for s in box] and parts["size"][i].tolist() == [s.stop - s.start for s in box]
        x, y, z = np.unravel_index(parts["first"][i], shape, order="F")
        assert labels[x, y, z] == i + 1


def test_labels_are_cc3ds():
    cc3d = pytest.importorskip("cc3d")
    array = noise((130, 40, 30), 0.2)
    for connectivity in (6, 18, 26):
        assert np.array_equal(bitvox.Grid.from_numpy(array).label(connectivity=connectivity), canonical(cc3d.connected_components(array, connectivity=connectivity)))


def test_euler_is_scikit_images():
    measure = pytest.importorskip("skimage.measure")
    for seed, share in enumerate((0.05, 0.3, 0.6, 0.95)):
        array = noise((70, 9, 8), share, seed)
        grid = bitvox.Grid.from_numpy(array)
        assert grid.topology(connectivity=6).euler == measure.euler_number(array, connectivity=1)
        assert grid.topology(connectivity=26).euler == measure.euler_number(array, connectivity=3)
        assert grid.topology().components == len(grid.components())


def test_keep_and_fill():
    ndimage = pytest.importorskip("scipy.ndimage")
    array = noise((80, 12, 11), 0.25)
    grid = bitvox.Grid.from_numpy(array)
    parts, labels = grid.components(), grid.label()
    kept = grid.keep(at_least=4)
    assert np.array_equal(kept.to_numpy(), np.isin(labels, 1 + np.flatnonzero(parts["voxels"] >= 4)))
    assert kept.report.kept == (parts["voxels"] >= 4).sum() and kept.report.voxels_dropped == grid.count - kept.count
    largest = np.argsort(-parts["voxels"].astype(np.int64), kind="stable")[:3]
    assert np.array_equal(grid.keep(largest=3).to_numpy(), np.isin(labels, 1 + largest))
    seed = np.argwhere(array)[7]
    assert np.array_equal(grid.keep(seeds=[seed]).to_numpy(), labels == labels[tuple(seed)])
    full = noise((40, 20, 20), 0.8)
    assert np.array_equal(bitvox.Grid.from_numpy(full).fill_cavities().to_numpy(), ndimage.binary_fill_holes(full))
    with pytest.raises(bitvox.ArgumentError):
        grid.keep(seeds=np.zeros((0, 3)))
    with pytest.raises(ValueError, match="connectivity"):
        grid.label(connectivity=8)


def test_topology_of_a_hollow_ball():
    hollow = ball_grid(24) & ~ball_grid(24, 4)
    found = bitvox.Grid.from_numpy(hollow).topology()
    assert (found.components, found.cavities, found.tunnels, found.euler) == (1, 1, 0, 2)


# ---- Points ----


def test_points_are_histogram_bins():
    points = np.random.default_rng(1).integers(0, 64, (5000, 3)) / 8  # exact in the lattice's fixed point
    lattice = bitvox.Lattice((8, 8, 8))
    counts, _ = np.histogramdd(points, bins=(8, 8, 8), range=[(0, 8)] * 3)
    for minimum in (1, 2, 9):
        grid = bitvox.voxelize_points(points, lattice=lattice, minimum=minimum)
        assert np.array_equal(grid.to_numpy(), counts >= minimum)
    assert grid.report.inside == 5000 and grid.report.outside == 0
    assert bitvox.voxelize_points(points.astype(np.float32), lattice=lattice) == bitvox.voxelize_points(points, lattice=lattice)
    part = bitvox.voxelize_points(points, lattice=lattice, window=(1, 2, 3, 7, 8, 5))
    assert np.array_equal(part.to_numpy(), (counts >= 1)[1:7, 2:8, 3:5])


def test_a_cloud_of_a_ball_becomes_a_body(tmp_path):
    cloud = REPOSITORY / "fixtures" / "ball.xyz"
    if not cloud.is_file():
        pytest.skip("fixtures/ball.xyz is not here")
    points = bitvox.read_points(cloud)
    assert points.shape == (800, 3) and points.dtype == np.float64
    assert np.allclose(points, np.loadtxt(cloud)[:, :3])
    body = bitvox.voxelize_points(cloud, spacing=0.1, body=True, close_gaps=1)
    assert body.report.pockets == 1 and body == bitvox.voxelize_points(points, spacing=0.1, body=True, close_gaps=1)
    assert 0.9 < body.volume / (4 / 3 * np.pi) < 1.2
    packed = tmp_path / "b.xyz.gz"
    packed.write_bytes(gzip.compress(cloud.read_bytes()))
    assert np.array_equal(bitvox.read_points(packed), points)
    with pytest.raises(bitvox.ArgumentError):
        bitvox.voxelize_points(points, close_gaps=1)
    with pytest.raises(bitvox.EmptyError):
        bitvox.voxelize_points(np.zeros((0, 3)), spacing=1)
    with pytest.raises(bitvox.RangeError, match=r"points\[1, "):
        bitvox.voxelize_points([[0, 0, 0], [0, np.nan, 0]], spacing=1)
    with pytest.raises(bitvox.UnsupportedError):
        bitvox.read_points("cloud.stl")


# ---- Chunks ----


@pytest.mark.parametrize("connectivity", [6, 18, 26])
@pytest.mark.parametrize("share", [0.04, 0.12, 0.3, 0.7])
def test_labels_of_chunks_are_those_of_the_whole(connectivity, share):
    da = pytest.importorskip("dask.array")
    import bitvox.big

    array = noise((70, 41, 33), share)
    whole = bitvox.Grid.from_numpy(array).label(connectivity=connectivity)
    for chunks in ((32, 16, 11), (64, 41, 10), (70, 41, 33)):
        volume = bitvox.big.from_dask(da.from_array(array, chunks=chunks))
        labels, count = bitvox.big.label(volume, connectivity=connectivity)
        assert labels.dtype == np.uint32 and count == whole.max()
        assert np.array_equal(labels.compute(scheduler="synchronous"), whole)
    with pytest.raises(bitvox.ArgumentError):
        bitvox.big.label(volume, connectivity=4)
