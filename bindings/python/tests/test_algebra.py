"""What becomes of grids and bodies together: set algebra against numpy, booleans against volumes."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from conftest import box_mesh

import bitvox
from bitvox import Grid, Lattice

shapes = hnp.array_shapes(min_dims=3, max_dims=3, max_side=70)
factors = st.tuples(*[st.integers(1, 9)] * 3)


def blocks_of(array, factor):
    """The array in blocks, filled up with -1: [bx, fx, by, fy, bz, fz] -> [bx, by, bz, voxels]."""
    padded = np.pad(array.astype(np.int8), [(0, -n % f) for n, f in zip(array.shape, factor)], constant_values=-1)
    split = [n for pair in zip((m // f for m, f in zip(padded.shape, factor)), factor) for n in pair]
    return padded.reshape(split).transpose(0, 2, 4, 1, 3, 5).reshape(*split[::2], -1)


@settings(deadline=None, max_examples=60)
@given(st.data(), shapes, factors)
def test_blocks(data, shape, factor):
    array = data.draw(hnp.arrays(np.bool_, shape))
    grid = Grid.from_numpy(array, spacing=(1, 2, 3), corner=(4, 5, 6))
    blocks = blocks_of(array, factor)
    voxels, filled = (blocks >= 0).sum(axis=3), (blocks == 1).sum(axis=3)
    counts = grid.coverage(factor)
    assert counts.dtype == np.uint32 and np.array_equal(counts, filled)
    assert np.array_equal(grid.downsample(factor).to_numpy(), filled > 0)
    assert np.array_equal(grid.downsample(factor, "all").to_numpy(), filled == voxels)
    made = grid.downsample(factor, rule="majority")
    assert np.array_equal(made.to_numpy(), 2 * filled > voxels)
    assert made.corner == (4, 5, 6) and made.lattice.shape == counts.shape
    assert made.spacing == tuple(s * f for s, f in zip((1, 2, 3), factor))


def test_blocks_of_a_window_and_refusals():
    lattice = Lattice((40, 20, 20))
    array = np.random.default_rng(1).random((30, 9, 9)) < 0.5
    grid = Grid.from_numpy(array, lattice=lattice, low=(5, 3, 2))
    whole = np.zeros((40, 20, 20), bool)
    whole[5:35, 3:12, 2:11] = array
    counts = grid.coverage(4)
    assert np.array_equal(counts, blocks_of(whole, (4, 4, 4))[1:9, 0:3, 0:3].clip(0).sum(axis=3))
    assert grid.downsample(4).low == (1, 0, 0)
    with pytest.raises(bitvox.ArgumentError, match="rule"):
        grid.downsample(2, "most")
    with pytest.raises(bitvox.ArgumentError, match="factor"):
        grid.downsample(0)
    with pytest.raises(bitvox.ArgumentError, match="factor"):
        grid.coverage((1, 0, 2))
    with pytest.raises(TypeError):
        grid.downsample(2.5)


@settings(deadline=None, max_examples=40)
@given(st.data(), shapes, st.permutations([0, 1, 2]), st.sets(st.integers(0, 2)))
def test_permute(data, shape, axes, flip):
    array = data.draw(hnp.arrays(np.bool_, shape))
    grid = Grid.from_numpy(array, spacing=(1, 2, 3), corner=(4, 5, 6))
    made = grid.permute(axes, flip)
    assert np.array_equal(made.to_numpy(), np.flip(array.transpose(axes), tuple(flip)))
    assert made.spacing == tuple((1, 2, 3)[a] for a in axes) and made.corner == tuple((4, 5, 6)[a] for a in axes)
    assert made.permute("".join("xyz"[axes.index(a)] for a in range(3)), "".join("xyz"[axes[a]] for a in flip)) == grid


def test_permute_refusals():
    grid = Grid.from_numpy(np.ones((3, 4, 5), bool))
    for axes in ("xxy", (0, 1), "xyw", (0, 1, 3)):
        with pytest.raises((bitvox.Error, TypeError)):
            grid.permute(axes)
    with pytest.raises((bitvox.Error, TypeError)):
        grid.permute(flip="w")


@settings(deadline=None, max_examples=40)
@given(st.data(), shapes)
def test_crop_pad_and_content(data, shape):
    array = data.draw(hnp.arrays(np.bool_, shape))
    grid = Grid.from_numpy(array, spacing=0.5, corner=(1, 2, 3))
    low, high = (data.draw(st.tuples(*[st.integers(0, 66)] * 3)) for _ in range(2))
    padded = grid.pad(low, high)
    assert np.array_equal(padded.to_numpy(), np.pad(array, list(zip(low, high))))
    assert padded.corner == tuple(c - 0.5 * n for c, n in zip((1, 2, 3), low))
    begin = [data.draw(st.integers(0, n - 1)) for n in shape]
    end = [data.draw(st.integers(b + 1, n)) for b, n in zip(begin, shape)]
    part = grid.crop((*begin, *end))
    assert np.array_equal(part.to_numpy(), array[tuple(slice(b, e) for b, e in zip(begin, end))])
    assert part.low == tuple(begin) and part.lattice == grid.lattice
    back = part.crop(((0, 0, 0), shape))
    assert back.count == part.count and back <= grid
    if array.any():
        places = np.argwhere(array)
        window = grid.content()
        assert window.low == tuple(places.min(axis=0)) and window.size == tuple(np.ptp(places, axis=0) + 1)
        assert grid.crop().shape == window.size and grid.crop().count == grid.count
    else:
        assert grid.content() is None
        with pytest.raises(bitvox.EmptyError):
            grid.crop()


def test_pad_by_one_number():
    grid = Grid.from_numpy(np.ones((3, 4, 5), bool))
    assert grid.pad(2).shape == (7, 8, 9) and grid.pad(2, (0, 1, 0)).shape == (5, 7, 7)
    with pytest.raises(bitvox.Error):
        grid.pad(-1)


def test_resample_against_indices():
    array = np.random.default_rng(5).random((40, 30, 20)) < 0.5
    grid = Grid.from_numpy(array, spacing=(1.0, 0.5, 2.0), corner=(-3, 1, 0))
    for spacing in (0.5, 1.3, 3.0):
        lattice = Lattice((50, 40, 30), spacing, (-5, 0.3, 1))
        made = grid.resample(lattice)
        places = [np.floor((c + (np.arange(n) + 0.5) * spacing - o) / s).astype(int)
                  for c, n, o, s in zip(lattice.corner, lattice.shape, grid.corner, grid.spacing)]
        inside = [(p >= 0) & (p < n) for p, n in zip(places, array.shape)]
        want = array[np.ix_(*(p.clip(0, n - 1) for p, n in zip(places, array.shape)))] & np.einsum("i,j,k->ijk", *inside)
        assert np.array_equal(made.to_numpy(), want) and made.lattice == lattice
        window = ((3, 4, 5), (20, 30, 20))
        assert grid.resample(lattice, window) == made.crop(window)


def box(low, high):
    x, y, z = zip(low, high)
    points = [(x[i & 1], y[i >> 1 & 1], z[i >> 2]) for i in range(8)]
    faces = [(0, 2, 1), (1, 2, 3), (4, 5, 6), (5, 7, 6), (0, 1, 4), (1, 5, 4), (2, 6, 3), (3, 6, 7), (0, 4, 2), (2, 4, 6), (1, 3, 5), (3, 7, 5)]
    return np.array(points, float), np.array(faces)


A, B = box((0, 0, 0), (10, 9, 8)), box((4.03, 3.07, 2.11), (12.05, 11.01, 7.13))
BOTH = 5.97 * 5.93 * 5.02
VOLUMES = {"union": 720 + 8.02 * 7.94 * 5.02 - BOTH, "intersection": BOTH, "difference": 720 - BOTH}


@pytest.mark.parametrize("operation", VOLUMES)
def test_boolean_of_boxes(operation):
    mesh = bitvox.boolean(A, B, operation, resolution=64, sharp=True)
    found = mesh.check()
    assert found.closed and found.edge_manifold and found.vertex_manifold and found.oriented
    assert found.volume == pytest.approx(VOLUMES[operation], rel=2e-3)
    report = mesh.report
    assert report.voxels > 1000 and report.surface.edges < len(mesh.vertices) and report.surface.middle == 0


def test_boolean_is_that_of_the_grids():
    lattice = Lattice((40, 36, 30), 0.37, (-0.7, -0.6, -0.8))
    a, b = (bitvox.voxelize(m, lattice=lattice) for m in (A, B))
    for operation, want in {"union": a | b, "intersection": a & b, "difference": a - b, "xor": a ^ b}.items():
        mesh = bitvox.boolean(A, B, operation, lattice=lattice, thin="drop")
        assert bitvox.voxelize(mesh, lattice=lattice) == want
        assert (mesh.report.voxels_a, mesh.report.voxels_b, mesh.report.voxels) == (a.count, b.count, want.count)


def test_boolean_fits_its_lattice_and_says_how_it_filled():
    half = box_mesh((3, -5000, -5000), (10000, 5000, 5000))
    part = box_mesh((0, 0, 0), (8, 6, 4))
    mesh = bitvox.boolean(part, half, "difference", resolution=64, sharp=True)
    assert abs(mesh.check().volume - 72) < 0.5 and mesh.report.few == 0
    assert (mesh.report.solid_a.fill, mesh.report.solid_b.fill_reason) == ("parity", "sound")

    mesh = bitvox.boolean(part, box_mesh((1, 1, 1), (2, 2, 2)), "difference", resolution=40)
    assert (mesh.report.few, mesh.report.advised_resolution) == (2, 512)
    with pytest.raises(bitvox.EmptyError, match="at any resolution of up to 4096"):
        bitvox.boolean(part, half, "union", resolution=64)


def test_boolean_keeps_thin_walls():
    plate, bar = box_mesh((-1, -1, -0.008), (1, 1, 0.008)), box_mesh((-0.4, -0.3, -0.5), (0.4, 0.3, 0.5))
    mesh = bitvox.boolean(plate, bar, "difference", lattice=Lattice((70, 70, 20), 1 / 32, (-35 / 32, -35 / 32, -10 / 32)))
    found = mesh.check()
    assert found.components == 1 and found.euler == 0
    assert abs(found.volume / ((4 - 0.48) * 0.016) - 1) < 0.1
    assert mesh.report.thin_kept == 1 and mesh.report.solid_a.thin_voxels > 0
    with pytest.raises(bitvox.ArgumentError, match="thin"):
        bitvox.boolean(A, B, "union", thin="shell")


def test_boolean_refusals_and_emptiness():
    assert len(bitvox.boolean(A, A, "difference", resolution=20).faces) == 0
    with pytest.raises(bitvox.ArgumentError, match="operation"):
        bitvox.boolean(A, B, "plus")
    with pytest.raises(bitvox.ArgumentError, match="fill"):
        bitvox.boolean(A, B, "union", fill="flood")
    with pytest.raises(bitvox.ArgumentError, match="contradict"):
        bitvox.boolean(A, B, "union", resolution=9, lattice=Lattice((9, 9, 9)))
