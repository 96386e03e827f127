"""Morphology and distances against scipy.ndimage."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import bitvox
from bitvox import Grid

ndimage = pytest.importorskip("scipy.ndimage")
STRUCTURES = {6: 1, 18: 2, 26: 3}


def random_grid(seed, shape, share, spacing=1.0):
    array = np.random.default_rng(seed).random(shape) < share
    return array, Grid.from_numpy(array, spacing=spacing)


@settings(deadline=None, max_examples=40)
@given(st.integers(0, 2**32), st.tuples(st.sampled_from([1, 63, 64, 65, 127, 128, 129]), st.integers(1, 9), st.integers(1, 9)),
       st.sampled_from([0.02, 0.4, 0.95]), st.sampled_from([6, 18, 26]), st.integers(1, 4), st.booleans())
def test_neighborhoods(seed, shape, share, connectivity, steps, beyond):
    array, grid = random_grid(seed, shape, share)
    structure = ndimage.generate_binary_structure(3, STRUCTURES[connectivity])
    room = 2 * steps + 1
    wide = np.pad(array, room, constant_values=beyond)
    inner = tuple(slice(room, -room) for _ in range(3))

    def dilated(a):
        return ndimage.binary_dilation(a, structure, iterations=steps, border_value=beyond)

    def eroded(a):
        return ndimage.binary_erosion(a, structure, iterations=steps, border_value=beyond)

    options = {"connectivity": connectivity, "beyond": beyond}
    assert np.array_equal(grid.dilate(steps, **options).to_numpy(), dilated(wide)[inner])
    assert np.array_equal(grid.erode(steps, **options).to_numpy(), eroded(wide)[inner])
    assert np.array_equal(grid.open(steps, **options).to_numpy(), dilated(eroded(wide))[inner])
    assert np.array_equal(grid.close(steps, **options).to_numpy(), eroded(dilated(wide))[inner])


@pytest.mark.parametrize("spacing", [(1.0, 1.0, 1.0), (0.5, 1.0, 2.0)])
@pytest.mark.parametrize("radius", [1.0, 2.5, 4.0, 41.0])
def test_balls_are_thresholds_of_distances(spacing, radius):
    array, grid = random_grid(7, (70, 21, 20), 0.001, spacing)
    array[3, 3, 3] = True
    grid = Grid.from_numpy(array, spacing=spacing)
    outside = ndimage.distance_transform_edt(~array, sampling=spacing)
    assert np.array_equal(grid.dilate(radius=radius).to_numpy(), outside <= radius * (1 + 1e-12))
    inside = ndimage.distance_transform_edt(array, sampling=spacing)
    assert np.array_equal(grid.erode(radius=radius, beyond=True).to_numpy(), array & (inside > radius * (1 + 1e-12)))


@pytest.mark.parametrize("share", [0.0005, 0.1, 0.9])
def test_distances(share):
    array, grid = random_grid(3, (65, 40, 33), share)
    array[0, 0, 0] = True
    grid = Grid.from_numpy(array)
    theirs, where = ndimage.distance_transform_edt(~array, return_indices=True)
    mine, nearest = grid.distance(dtype="float64", nearest=True)
    assert mine.shape == array.shape and np.allclose(mine, theirs, rtol=1e-15, atol=0)
    x, y, z = np.unravel_index(nearest, array.shape, order="F")
    assert array[x, y, z].all()
    i, j, k = np.indices(array.shape)
    assert np.array_equal((i - x) ** 2 + (j - y) ** 2 + (k - z) ** 2, grid.distance(squares=True))
    assert where.shape[0] == 3
    assert np.array_equal(grid.distance(), mine.astype(np.float32))
    signed = grid.distance("signed", dtype="float64")
    inside = ndimage.distance_transform_edt(array)
    assert np.allclose(signed, theirs - inside, rtol=1e-15, atol=0)


def test_distances_of_stretched_voxels_and_sides():
    array, _ = random_grid(5, (30, 20, 25), 0.7)
    grid = Grid.from_numpy(array, spacing=(0.3, 1.1, 0.7))
    theirs = ndimage.distance_transform_edt(array, sampling=(0.3, 1.1, 0.7))
    assert np.allclose(grid.distance("inside", dtype="float64"), theirs, rtol=1e-14, atol=0)
    wide = np.pad(array, 1)
    theirs = ndimage.distance_transform_edt(wide, sampling=(0.3, 1.1, 0.7))[1:-1, 1:-1, 1:-1]
    assert np.allclose(grid.distance("inside", beyond="empty", dtype="float64"), theirs, rtol=1e-14, atol=0)
    empty = Grid.from_numpy(np.zeros((3, 4, 5), bool))
    assert np.isposinf(empty.distance()).all() and (empty.distance(squares=True) == 2**32 - 1).all()


def test_hollow():
    array = np.zeros((40, 40, 40), bool)
    array[5:35, 5:35, 5:35] = True
    shell = Grid.from_numpy(array).hollow(3.0, drain=1.0, drain_side="z-high", drain_at=(20.5, 12.5))
    theirs = array & (ndimage.distance_transform_edt(array) <= 3.0)
    theirs[19:22, 12, 32:] = theirs[20, 11:14, 32:] = False
    assert np.array_equal(shell.to_numpy(), theirs)
    assert shell.report.hollowed == 24**3 and shell.report.drained == 15
    assert tuple(shell.report.drain) == (20.5, 12.5, 31.5)
    assert Grid.from_numpy(array).hollow(3.0).count == 30**3 - 24**3


def test_what_is_refused():
    grid = Grid.from_numpy(np.ones((3, 3, 3), bool), spacing=(1, 1, 2))
    for wrong in (lambda: grid.dilate(connectivity=7), lambda: grid.open(2, radius=1.0),
                  lambda: grid.close(radius=-1.0), lambda: grid.hollow(0.0), lambda: grid.hollow(1.0, drain_side="top"),
                  lambda: grid.hollow(1.0, drain_at=(1, 2, 3)), lambda: grid.distance("up"), lambda: grid.distance(dtype="int32"),
                  lambda: grid.distance(squares=True), lambda: grid.distance(beyond="full")):
        with pytest.raises(bitvox.ArgumentError):
            wrong()
    for steps in (0, 65537):
        with pytest.raises(bitvox.RangeError, match="1 to 65536"):
            grid.erode(steps)
