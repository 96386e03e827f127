"""Grids against numpy."""

import pickle

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

import bitvox
from bitvox import Grid, Lattice

cubes = hnp.arrays(np.bool_, hnp.array_shapes(min_dims=3, max_dims=3, max_side=70))


@settings(deadline=None, max_examples=60)
@given(cubes, st.sampled_from(["xyz", "zyx"]))
def test_from_and_to_numpy(array, order):
    grid = Grid.from_numpy(array, order=order)
    assert grid.shape == (array.shape if order == "xyz" else array.shape[::-1])
    assert grid.count == array.sum()
    back = grid.to_numpy(order)
    assert back.dtype == np.bool_ and np.array_equal(back, array)
    other = "zyx" if order == "xyz" else "xyz"
    assert np.array_equal(grid.to_numpy(other), array.transpose(2, 1, 0))


@settings(deadline=None, max_examples=40)
@given(st.data(), hnp.array_shapes(min_dims=3, max_dims=3, max_side=66))
def test_set_algebra(data, shape):
    a, b = (data.draw(hnp.arrays(np.bool_, shape)) for _ in range(2))
    x, y = Grid.from_numpy(a), Grid.from_numpy(b)
    for mine, theirs in ((x | y, a | b), (x & y, a & b), (x - y, a & ~b), (x ^ y, a ^ b), (~x, ~a)):
        assert np.array_equal(mine.to_numpy(), theirs)
        assert mine.count == theirs.sum()  # bits past a row's end are not set
    assert (x == y) == bool(np.array_equal(a, b))
    assert (x <= y) == bool((a <= b).all()) and (x >= y) == bool((b <= a).all())
    assert ((x | y) - y) <= x


@pytest.mark.parametrize("dtype", [np.int8, np.uint8, ">i4", np.uint64, np.float16, ">f8", np.float32])
def test_any_type_and_strides(dtype):
    whole = (np.random.default_rng(1).random((20, 41, 60)) < 0.3) * 3
    view = whole.astype(dtype)[::2, ::-1, 5:50:3]
    assert np.array_equal(Grid.from_numpy(view).to_numpy(), view != 0)
    assert np.array_equal(Grid.from_numpy(view.T, order="zyx").to_numpy(), view != 0)


TYPES = ["?", "i1", "u1", ">i2", "u2", "<i4", ">u4", "i8", "u8", "f2", "<f4", ">f4", "f8", ">f8", "longdouble"]
cuts = st.slices(12)


@settings(deadline=None, max_examples=80)
@given(st.sampled_from(TYPES), st.permutations(range(3)), st.tuples(cuts, cuts, cuts), st.sampled_from(["xyz", "zyx"]), st.sampled_from("CF"),
       st.integers(0, 2**32 - 1), st.booleans())
def test_any_view_of_any_type(dtype, axes, cut, order, layout, seed, frozen):
    whole = np.random.default_rng(seed).integers(0, 3, (12, 12, 12)).astype(dtype, order=layout)
    view = whole.transpose(axes)[cut]  # steps, backwards, any order of axes
    view.flags.writeable = not frozen
    if view.size == 0:
        with pytest.raises(bitvox.ArgumentError):
            Grid.from_numpy(view, order=order)
        return
    grid = Grid.from_numpy(view, order=order)
    assert np.array_equal(grid.to_numpy(order), view != 0) and grid.count == np.count_nonzero(view)


@settings(deadline=None, max_examples=60)
@given(st.sampled_from(TYPES[1:]), st.integers(1, 3), st.integers(0, 2), st.sampled_from("CF"), st.booleans())
def test_points_of_any_type_and_strides(dtype, step, spare, layout, backwards):
    array = np.zeros((8, 8, 8), bool)
    array[2:5, 1:6, 3:4] = True
    grid = Grid.from_numpy(array)
    table = np.full((20 * step, 3 + spare), 99).astype(dtype, order=layout)
    table[::step, spare:] = np.random.default_rng(5).integers(0, 8, (20, 3))
    points = table[::step, spare:][:: -1 if backwards else 1]
    plain = [[int(x) for x in p] for p in points]
    assert grid.sample(points).tolist() == grid.sample(plain).tolist()
    rays = np.concatenate([points, np.ones_like(points)], axis=1)
    assert grid.cast(rays).tobytes() == grid.cast(rays.astype(float)).tobytes()
    if np.dtype(dtype).kind in "iu":
        empty = Grid.from_numpy(array & False)
        assert empty.fill(points).count == 512
    else:
        with pytest.raises(TypeError):
            grid.fill(points)


def test_negative_and_read_only_arrays():
    array = np.full((3, 4, 5), -1)
    array.flags.writeable = False
    assert Grid.from_numpy(array).count == 60


def test_refused_arrays():
    with pytest.raises(bitvox.ArgumentError, match="three axes"):
        Grid.from_numpy(np.zeros((3, 3)))
    with pytest.raises(bitvox.ArgumentError, match="three axes"):
        Grid.from_numpy(np.zeros((3, 0, 3)))
    with pytest.raises(bitvox.ArgumentError, match="NaN"):
        Grid.from_numpy(np.full((2, 2, 2), np.nan))
    with pytest.raises(TypeError):
        Grid.from_numpy(np.zeros((2, 2, 2), complex))
    with pytest.raises(TypeError):
        Grid.from_numpy(np.zeros((2, 2, 2), object))
    with pytest.raises(bitvox.ArgumentError, match="order"):
        Grid.from_numpy(np.zeros((2, 2, 2)), order="yxz")


def test_places():
    lattice = Lattice((10, 20, 30), (1.0, 2.0, 0.5), (5.0, 6.0, 7.0))
    assert lattice.center0 == (5.5, 7.0, 7.25)
    grid = Grid(lattice, ((2, 3, 4), (5, 6, 7)))
    assert (grid.low, grid.shape, grid.count) == ((2, 3, 4), (5, 6, 7), 0)
    assert grid.corner == (7.0, 12.0, 9.0) and grid.center0 == (7.5, 13.0, 9.25)
    assert grid.lattice == lattice and hash(grid.lattice) == hash(lattice)
    assert grid.origin == grid.center0 and lattice.origin == lattice.center0  # and not the corner
    with pytest.raises(bitvox.RangeError):
        Grid(lattice, ((2, 3, 4), (9, 6, 7)))
    with pytest.raises(bitvox.Error):
        Lattice((0, 1, 1))
    with pytest.raises(bitvox.Error):
        Lattice((4, 4, 4), spacing=-1.0)
    with pytest.raises(bitvox.Error):
        Lattice((4, 4, 4), corner=(0.0, float("nan"), 0.0))


def test_one_voxel():
    array = np.zeros((70, 3, 4), bool)
    array[65, 1, 2] = True
    grid = Grid.from_numpy(array)
    assert grid[65, 1, 2] and not grid[64, 1, 2] and grid[-5, -2, -2] is True
    assert grid.voxels().tolist() == [[65, 1, 2]]
    for outside in ((70, 0, 0), (0, -4, 0), (0, 0, 4)):
        with pytest.raises(IndexError):
            grid[outside]
    with pytest.raises(TypeError):
        list(grid)
    assert len(grid) == 1 and bool(grid) and not bool(grid - grid)
    assert not hasattr(grid, "ndim") and not hasattr(grid, "dtype")  # or others would take it for an array
    for call in (lambda: np.sum(grid), lambda: np.logical_and(grid, grid), lambda: array | grid):
        with pytest.raises(TypeError, match=r"takes no Grid: give it grid.to_numpy\(\)"):
            call()


def test_words_are_a_view_that_outlives_the_grid():
    grid = Grid.from_numpy(np.ones((64, 2, 2), bool))
    words = grid.words
    again = grid.words
    assert words.__array_interface__["data"] == again.__array_interface__["data"]
    assert words.shape == (2, 2, 1) and not words.flags.writeable
    del grid, again
    assert (words == np.uint64(2**64 - 1)).all()


def test_other_places_are_refused_or_unequal():
    array = np.ones((4, 4, 4), bool)
    a, b = Grid.from_numpy(array), Grid.from_numpy(array, spacing=2.0)
    assert a != b
    with pytest.raises(bitvox.LatticeError):
        a | b
    with pytest.raises(TypeError):
        a | array
    with pytest.raises(bitvox.LatticeError):
        a.compare(b)


def test_hash_and_pickle():
    rng = np.random.default_rng(2)
    grid = Grid(Lattice((90, 8, 9), 0.5, (1, 2, 3)), ((3, 1, 2), (80, 5, 6)))
    grid = grid ^ Grid.from_numpy(rng.random((80, 5, 6)) < 0.5, lattice=grid.lattice, low=grid.low)
    again = pickle.loads(pickle.dumps(grid))
    assert again == grid and again.content_hash() == grid.content_hash() and hash(again) == hash(grid)
    assert pickle.loads(pickle.dumps(grid.lattice)) == grid.lattice
    assert {grid: 1}[again] == 1


def test_compare():
    a, b = np.zeros((8, 8, 8), bool), np.zeros((8, 8, 8), bool)
    a[1:4, 1:4, 1:4] = True
    b[2:6, 1:4, 1:4] = True
    found = Grid.from_numpy(a).compare(Grid.from_numpy(b))
    assert (found.set_a, found.set_b, found.both, found.only_a, found.only_b) == (27, 36, 18, 9, 18)
    assert found.low == (1, 1, 1) and found.size == (5, 3, 3)


def test_cast_and_sample():
    array = np.zeros((8, 8, 8), bool)
    array[4, 2, 3] = True
    grid = Grid.from_numpy(array, spacing=0.5, corner=(1, 1, 1))
    hits = grid.cast([[0, 2.25, 2.75, 1, 0, 0], [0, 0, 0, -1, 0, 0]])
    assert hits["hit"].tolist() == [1, 0]
    assert hits["t"][0] == 3.0 and hits["voxel"][0].tolist() == [4, 2, 3] and hits["axis"][0] == 0
    values, slopes = grid.sample([[3.25, 2.25, 2.75], [3.5, 2.25, 2.75], [90, 0, 0]], gradients=True)
    assert values.tolist() == [1.0, 0.5, 0.0] and slopes[1].tolist() == [-2.0, -1.0, -1.0]
    assert grid.sample(np.zeros((0, 3))).shape == (0,)
    with pytest.raises(bitvox.RangeError):
        grid.sample([[np.nan, 0, 0]])
    with pytest.raises(bitvox.ArgumentError):
        grid.sample([[0, 0]])
    with pytest.raises(bitvox.ArgumentError):
        grid.cast([[0, 0, 0, 0, 0, 0]])


def test_rays_kept_are_those_of_the_grid():
    rng = np.random.default_rng(7)
    array = rng.random((70, 20, 30)) < 0.01
    first = Grid.from_numpy(array, spacing=0.5, corner=(1, 1, 1))
    lines = np.hstack([rng.random((300, 3)) * 40 - 2, rng.random((300, 3)) - 0.5])
    kept = bitvox.Rays(first)
    assert kept.cast(lines).tobytes() == first.cast(lines).tobytes()
    assert kept.cast(lines[:1], t_max=0.5).tobytes() == first.cast(lines[:1], t_max=0.5).tobytes()
    array[9:33, 4:9, 5:30] = True
    second = Grid.from_numpy(array, spacing=0.5, corner=(1, 1, 1))
    kept.update(second, ((9, 4, 5), (24, 5, 25)))
    assert kept.cast(lines).tobytes() == second.cast(lines).tobytes() != first.cast(lines).tobytes()
    assert kept == bitvox.Rays(second) != bitvox.Rays(first) and kept.cast(np.zeros((0, 6))).shape == (0,)
    for wrong in (lambda: kept.update(Grid.from_numpy(array)), lambda: kept.cast([[0, 0, 0, 0, 0, 0]]), lambda: kept.update(second, ((0, 0, 0), (71, 1, 1)))):
        with pytest.raises(bitvox.Error):
            wrong()
    assert kept.cast(lines).tobytes() == second.cast(lines).tobytes()


def test_fill_and_pockets_against_scipy():
    ndimage = pytest.importorskip("scipy.ndimage")
    array = np.random.default_rng(3).random((40, 30, 20)) < 0.6
    grid = Grid.from_numpy(array)
    labels, count = ndimage.label(~array)
    seed = np.argwhere(~array)[7]
    filled = grid.fill([seed]).to_numpy()
    assert np.array_equal(filled, labels == labels[tuple(seed)])
    inner = set(range(1, count + 1))
    for side in (labels[0], labels[-1], labels[:, 0], labels[:, -1], labels[:, :, 0], labels[:, :, -1]):
        inner -= set(np.unique(side))
    pockets = bitvox.find_pockets(grid)
    assert sorted(labels[tuple(p)] for p in pockets) == sorted(inner)
    with pytest.raises(bitvox.ArgumentError):
        grid.fill([np.argwhere(array)[0]])
    with pytest.raises(bitvox.ArgumentError):
        grid.fill([seed], connectivity=7)
