"""Chunks equal the whole, by bytes, however and wherever they are made."""

import functools
import operator
import os
import pickle
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from multiprocessing import get_context

import conftest
import numpy as np
import pytest
from conftest import REPOSITORY

import bitvox
from bitvox import big
from bitvox.big.chunks import Chunks, join

KNOT = REPOSITORY / "fixtures" / "knot.ply"
needs_knot = pytest.mark.skipif(not KNOT.is_file(), reason="fixtures/knot.ply is not here")


def whole(**options):
    grid = bitvox.voxelize(KNOT, resolution=150, padding=1, **options)
    return grid, bitvox.surface(grid, keys=True)


@pytest.mark.parametrize("size", [(64, 50, 40), (60, 33, 70), 200, (7, 200, 200)])
def test_join_of_windows(size):
    array = np.random.default_rng(9).random((131, 70, 45)) < 0.4
    lattice = bitvox.Lattice(array.shape, 0.25, (1, 2, 3))
    chunks = Chunks(lattice, size)
    parts = []
    for index in chunks:
        (x, y, z), (nx, ny, nz) = chunks.window(index)
        parts.append(bitvox.Grid.from_numpy(array[x : x + nx, y : y + ny, z : z + nz], lattice=lattice, low=(x, y, z)))
    assert len(parts) == len(chunks)
    assert join(lattice, bitvox.Window((0, 0, 0), lattice.shape), parts).to_numpy().tolist() == array.tolist()
    some = join(lattice, bitvox.Window((64, 3, 5), (65, 60, 33)), parts[::-1] + parts)
    assert np.array_equal(some.to_numpy(), array[64:129, 3:63, 5:38])
    assert pickle.loads(pickle.dumps(chunks)).counts == chunks.counts


@needs_knot
@pytest.mark.parametrize("chunks", [64, (60, 100, 33), 1000])
def test_plan_in_any_order_and_twice(chunks):
    grid, mesh = whole()
    plan = big.plan(KNOT, resolution=150, padding=1, chunks=chunks)
    tasks = pickle.loads(pickle.dumps(plan.tasks))
    results = [task() for task in tasks]
    assert all(a == b() for a, b in zip(results, tasks[:3]))  # tried again
    np.random.default_rng(1).shuffle(results)
    joined = plan.merge(results)
    assert joined.content_hash() == mesh.content_hash() and np.array_equal(joined.keys[0], mesh.keys[0])
    grids = big.plan(bitvox.read(KNOT), grid.lattice, chunks=chunks, result="grid")
    with ThreadPoolExecutor(2) as pool:
        assert grids.merge(pool.map(operator.methodcaller("__call__"), grids.tasks)) == grid


@needs_knot
def test_plan_in_processes():
    _, mesh = whole(fill="vote")
    plan = big.plan(KNOT, resolution=150, padding=1, chunks=80, fill="vote")
    with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as pool:
        assert plan.merge(pool.map(operator.methodcaller("__call__"), plan.tasks)).content_hash() == mesh.content_hash()


@needs_knot
def test_plan_refuses():
    for options in ({"fill": "flood"}, {"window": (0, 0, 0, 1, 1, 1)}, {"result": "smoke"}, {"attached": True}, {"chunks": 0},
                    {"chunks": (1, 2)}, {"result": "grid", "surface_options": {"dtype": "float64"}}, {"surface_options": {"keys": True}}):
        with pytest.raises(bitvox.Error):
            big.plan(KNOT, resolution=20, **options)
    plan = big.plan(KNOT, resolution=20, chunks=10)
    with pytest.raises(bitvox.ArgumentError):
        plan.merge([])


def test_far_from_the_origin_all_parts_are_float64():
    v = np.array([[0.0, 0, 0], [9, 0, 0], [0, 9, 0], [0, 0, 9]]) + [-2.0, 3_000_000.0, 0]
    tetrahedron = (v, [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
    plan = big.plan(tetrahedron, resolution=40, chunks=16)
    expected = bitvox.surface(bitvox.voxelize(tetrahedron, resolution=40))
    assert expected.vertices.dtype == np.float64
    assert plan.merge([task() for task in plan.tasks]).content_hash() == expected.content_hash()


@needs_knot
def test_dask_volume():
    da = pytest.importorskip("dask.array")
    grid, mesh = whole()
    volume = big.voxelize(KNOT, grid.lattice, chunks=(64, 70, 30))
    assert volume.count() == grid.count and volume.compute() == grid
    array = volume.array
    assert isinstance(array, da.Array) and array.dtype == bool and array.chunks[0] == (64, 64, grid.shape[0] - 128)
    assert np.array_equal(array.compute(), grid.to_numpy())
    joined = big.surface(volume)
    assert joined.content_hash() == mesh.content_hash() and np.array_equal(joined.keys[1], mesh.keys[1])
    assert big.surface(volume, dtype="float64", face_rule="join").content_hash() == bitvox.surface(grid, dtype="float64", face_rule="join").content_hash()
    shell = big.voxelize(bitvox.read(KNOT), grid.lattice, chunks=(64, 70, 30), mode="conservative")
    assert volume.map(operator.sub, shell).compute() == grid - shell.compute()
    other = shell.compute()
    for combine in (operator.or_, operator.and_, operator.sub, operator.xor):
        assert combine(volume, shell).compute() == combine(grid, other)
    assert (~volume).compute() == ~grid
    with pytest.raises(TypeError):
        volume | grid.to_numpy()  # noqa: B018
    assert volume.map(operator.invert).count() == (~grid).count
    from dask.base import tokenize

    assert tokenize(bitvox.read(KNOT)) == tokenize(bitvox.read(KNOT)) != tokenize(mesh)  # equal work has one name
    assert tokenize(grid) == tokenize(bitvox.Grid.from_numpy(grid.to_numpy(), lattice=grid.lattice)) != tokenize(~grid)
    odd = big.from_dask(array.rechunk((50, 150, 25)), grid.lattice)
    assert odd.compute() == grid and big.surface(odd).content_hash() == mesh.content_hash()
    with pytest.raises(bitvox.ArgumentError, match="rechunk"):
        volume | odd  # noqa: B018
    assert (volume | odd.rechunk(volume.chunks.size)).compute() == grid
    with pytest.raises(bitvox.ArgumentError):
        big.voxelize(KNOT, grid.lattice, resolution=3)


def stretched():
    """Blobs of several sizes that reach all sides, in voxels whose edges differ, with its chunks on Dask."""
    pytest.importorskip("dask.array")
    import dask.array as da

    noise = np.random.default_rng(4).random((70, 30, 26))
    for axis in range(3):
        noise = sum(np.roll(noise, k, axis) for k in range(-2, 3)) / 5
    grid = bitvox.Grid.from_numpy(noise > 0.52, spacing=(0.5, 1.0, 0.75), corner=(-3, 4, 5))
    assert 0.2 < grid.count / noise.size < 0.5

    def volume(size):
        return big.from_dask(da.from_array(grid.to_numpy()), grid.lattice, chunks=size)

    return grid, volume


@pytest.fixture(scope="module")
def local():
    """Tasks run here, one after another, so that small tests are quick."""
    dask = pytest.importorskip("dask")
    with dask.config.set(scheduler="synchronous"):
        yield


SIZES = [(64, 16, 13), (30, 9, 26)]  # rows that begin where words do, and chunks that are smaller than some halos


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("beyond", [False, True])
def test_morphology_of_chunks(local, size, beyond):
    grid, volume = stretched()
    cut = volume(size)
    for name in ("dilate", "erode", "open", "close"):
        for options in ({}, {"connectivity": 26}, {"steps": 3, "connectivity": 18}, {"radius": 0.8}, {"radius": 2.0}):
            made = getattr(cut, name)(**options, beyond=beyond).compute()
            assert made.content_hash() == getattr(grid, name)(**options, beyond=beyond).content_hash(), (name, options)
    assert cut.hollow(1.0, beyond=beyond).compute() == grid.hollow(1.0, beyond=beyond) != grid
    for wrong in (lambda: cut.dilate(connectivity=7), lambda: cut.open(0), lambda: cut.erode(2, radius=1.0), lambda: cut.close(radius=-1.0), lambda: cut.hollow(0.0)):
        with pytest.raises(bitvox.Error):
            wrong()  # before anything is computed


def test_a_halo_of_a_voxel_less_would_show(local):
    one = np.zeros((40, 20, 20), bool)
    one[18, 10, 10] = True  # two voxels behind the second chunk's first ones
    import dask.array as da

    def opened(margin, array):
        return big.from_dask(da.from_array(array), chunks=(16, 20, 20)).around(bitvox.Grid.open, margin, 3).compute()

    body = bitvox.Grid.from_numpy(one).dilate(3)  # its tip, in the first chunk, stands or falls with the voxel that is six away
    assert body.open(3) == opened(6, body.to_numpy()) == body != opened(5, body.to_numpy())
    assert opened((6, 0, 0), body.to_numpy()) == body
    with pytest.raises(bitvox.Error):
        opened(-1, one)


@pytest.mark.parametrize("size", SIZES)
def test_distances_of_chunks(local, size):
    grid, volume = stretched()
    cut = volume(size)
    for side in ("outside", "inside", "signed"):
        for beyond in ("nothing", "empty", "set"):
            whole = grid.distance(side, beyond=beyond)
            for limit in (0.3, 1.7, 2.5):
                found = cut.distance(limit, side, beyond=beyond)
                assert found.dtype == np.float32 and found.chunks[1][0] == size[1]
                assert np.array_equal(found.compute(), np.clip(whole, np.float32(-limit), np.float32(limit))), (side, beyond, limit)
    assert np.array_equal(cut.distance(1e9, dtype="float64").compute(), grid.distance(dtype="float64"))  # a limit beyond all: the whole
    assert np.abs(grid.distance("signed")).max() > 1.7
    sparse = bitvox.Grid.from_numpy(np.arange(70 * 30 * 26).reshape(70, 30, 26) == 40000, lattice=grid.lattice)
    import dask.array as da

    lonely = big.from_dask(da.from_array(sparse.to_numpy()), grid.lattice, chunks=size)
    assert np.array_equal(lonely.distance(6.0).compute(), np.minimum(sparse.distance(), np.float32(6)))
    assert (lonely.distance(6.0, "signed").compute() == np.clip(sparse.distance("signed"), np.float32(-6), np.float32(6))).all()
    for wrong in (lambda: cut.distance(0), lambda: cut.distance(float("nan")), lambda: cut.distance(1, "up"), lambda: cut.distance(1, dtype="int8")):
        with pytest.raises(bitvox.Error):
            wrong()


@pytest.mark.parametrize("size", SIZES)
def test_blocks_of_chunks(local, size):
    grid, volume = stretched()
    cut = volume(size)
    for factor in (2, 3, (4, 1, 7), 64, (100, 100, 100)):
        for rule in ("any", "all", "majority"):
            made = cut.downsample(factor, rule)
            assert made.compute().content_hash() == grid.downsample(factor, rule).content_hash() and made.lattice == grid.downsample(factor).lattice
        assert np.array_equal(cut.coverage(factor).compute(), grid.coverage(factor))
    assert cut.downsample(2).downsample(2).compute() == grid.downsample(2).downsample(2)
    assert cut.rechunk((50, 7, 26)).rechunk(32).compute() == grid
    for wrong in (lambda: cut.downsample(0), lambda: cut.downsample(2, "most"), lambda: cut.rechunk(0)):
        with pytest.raises(bitvox.Error):
            wrong()


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("connectivity", [6, 18, 26])
def test_parts_of_chunks(local, size, connectivity):
    grid, volume = stretched()
    grid = grid & grid.erode(2) ^ bitvox.Grid.from_numpy(np.random.default_rng(7).random(grid.shape) < 0.05, lattice=grid.lattice)
    cut = grid & volume(size) | grid  # an operand on either side
    whole = grid.components(connectivity=connectivity)
    made = cut.components(connectivity=connectivity)
    assert len(whole) > 50 and made.dtype == whole.dtype and all(np.array_equal(made[name], whole[name]) for name in whole.dtype.names)
    labels, count = big.label(cut, connectivity=connectivity)
    assert count == len(whole) and np.array_equal(labels.compute(), grid.label(connectivity=connectivity))
    for options in ({"largest": 20}, {"at_least": 3}, {"largest": 2, "at_least": 4}, {"at_least": 10**6}):
        kept = cut.keep(**options, connectivity=connectivity).compute()
        assert kept.content_hash() == grid.keep(**options, connectivity=connectivity).content_hash(), options
    for at_most in (0, 2):
        filled = (~cut).fill_cavities(connectivity=connectivity, at_most=at_most).compute()
        assert filled == (~grid).fill_cavities(connectivity=connectivity, at_most=at_most) != ~grid
    assert len((cut - grid).components()) == 0 == (cut - cut).keep(largest=1).count() and (cut - cut).fill_cavities().count() == 0
    for wrong in (lambda: cut.keep(largest=0), lambda: cut.keep(connectivity=7), lambda: cut.fill_cavities(at_most=-1), lambda: cut.components(connectivity=4)):
        with pytest.raises(bitvox.Error):
            wrong()


def test_chunks_of_one_voxel(local):
    array = np.random.default_rng(2).random((3, 2, 4)) < 0.5
    grid, volume = bitvox.Grid.from_numpy(array), big.from_dask(array, chunks=1)
    assert len(volume.chunks) == 24 and volume.dilate(2).compute() == grid.dilate(2)
    for connectivity in (6, 26):
        assert volume.keep(largest=1, connectivity=connectivity).compute() == grid.keep(largest=1, connectivity=connectivity)
    assert big.surface(volume).content_hash() == bitvox.surface(grid, keys=True).content_hash()


@pytest.mark.parametrize("size", SIZES)
def test_windows_of_volumes(local, size, tmp_path):
    grid, volume = stretched()
    window = bitvox.Window((5, 3, 2), (60, 21, 23))
    cut, part = volume(size).crop(window), grid.crop(window)
    assert cut.compute().content_hash() == part.content_hash() and (cut.shape, cut.corner, cut.bounds) == (part.shape, part.corner, part.bounds)
    assert big.surface(cut).content_hash() == part.surface(keys=True).content_hash()
    assert np.array_equal(cut.array.compute(), part.to_numpy()) and cut.rechunk(9).compute() == part
    assert cut.close(3, beyond=True).compute() == part.close(3, beyond=True)
    assert np.array_equal(cut.distance(2.0).compute(), np.minimum(part.distance(), np.float32(2)))
    assert np.array_equal(cut.components(), part.components()) and cut.keep(largest=3).compute() == part.keep(largest=3)
    for factor in (2, (3, 4, 5)):
        assert cut.downsample(factor).compute().content_hash() == part.downsample(factor).content_hash()
        assert np.array_equal(cut.coverage(factor).compute(), part.coverage(factor))
    assert (cut | part).compute() == part and (part - cut).count() == 0
    assert cut.crop((0, 0, 0, 70, 30, 26)).compute() == part.crop(((0, 0, 0), (70, 30, 26)))
    big.to_zarr(cut.rechunk(16), tmp_path / "a.zarr", inner=16)
    assert big.from_zarr(tmp_path / "a.zarr").compute() == part
    for other in (grid, bitvox.Grid.from_numpy(part.to_numpy())):
        with pytest.raises(bitvox.LatticeError, match="share lattice and window"):
            cut & other  # noqa: B018
    for wrong in ((0, 0, 0, 71, 30, 26), (-1, 0, 0, 2, 2, 2), None, (0, 0, 0, 0, 1, 1)):
        with pytest.raises(bitvox.Error):
            cut.crop(wrong)


@pytest.mark.parametrize("size", SIZES)
def test_resampling_of_chunks(local, size):
    grid, volume = stretched()
    cut = volume(size)
    for lattice in (bitvox.Lattice((40, 41, 30), 0.7, (-2.2, 5.1, 4.4)), bitvox.Lattice((9, 9, 9), 8.0, (-30, -30, -30)), grid.lattice,
                    bitvox.Lattice((20, 20, 20), 0.11, (500, 4, 5)), bitvox.Lattice((65, 33, 31), (0.25, 0.5, 0.375), (5, 5, 5))):
        assert cut.resample(lattice).compute().content_hash() == grid.resample(lattice).content_hash()
    part = cut.resample(lattice, (3, 4, 5, 40, 30, 20), chunks=(10, 11, 12))
    assert part.chunks.size == (10, 11, 12) and part.compute() == grid.resample(lattice, (3, 4, 5, 40, 30, 20))


@needs_knot
def test_zarr(tmp_path, monkeypatch):
    pytest.importorskip("dask")
    zarr = pytest.importorskip("zarr")
    grid, mesh = whole()
    volume = big.voxelize(KNOT, grid.lattice, chunks=(64, 64, 32))
    big.to_zarr(volume, tmp_path / "a.zarr", inner=32, unit="millimeter")
    back = big.from_zarr(tmp_path / "a.zarr")
    assert back.lattice == grid.lattice and back.chunks.size == (64, 64, 32)
    assert back.compute() == grid and big.surface(back).content_hash() == mesh.content_hash()
    group = zarr.open_group(tmp_path / "a.zarr", mode="r")
    assert group["0"].shards == (32, 64, 64) and group["0"].chunks == (32, 32, 32) and group.metadata.zarr_format == 3
    assert np.array_equal(group["0"][:], grid.to_numpy("zyx"))
    (scales,) = group.attrs["ome"]["multiscales"]
    assert group.attrs["ome"]["version"] == "0.5" and [a["unit"] for a in scales["axes"]] == ["millimeter"] * 3
    assert scales["datasets"][0]["coordinateTransformations"][1]["translation"] == list(grid.center0[::-1])
    shards = [name for _, _, names in os.walk(tmp_path / "a.zarr" / "0" / "c") for name in names]
    assert 0 < len(shards) <= len(volume.chunks)  # empty ones need no file
    with pytest.raises(Exception, match="exist|contain"):
        big.to_zarr(volume, tmp_path / "a.zarr", inner=32)
    again = big.to_zarr(volume, tmp_path / "a.zarr", inner=32, overwrite=True, compute=False)
    import dask

    dask.compute(*again)
    dask.compute(*again)  # a task that is tried again
    assert big.from_zarr(tmp_path / "a.zarr", chunks=50).compute() == grid
    monkeypatch.setattr(big.store, "SLAB", 5000)  # one layer of what is stored at a time
    assert big.from_zarr(tmp_path / "a.zarr", chunks=50).compute(scheduler="synchronous") == grid
    with pytest.raises(bitvox.ArgumentError, match="multiples"):
        big.to_zarr(volume, tmp_path / "b.zarr", inner=48)


def test_zarr_of_others(tmp_path):
    pytest.importorskip("dask")
    zarr = pytest.importorskip("zarr")
    values = np.random.default_rng(3).integers(0, 200, (1, 20, 30, 40), dtype=np.uint16)
    group = zarr.open_group(tmp_path / "a.zarr", mode="w", zarr_format=2)
    group.create_array("full", data=values, chunks=(1, 10, 10, 10))
    group.attrs["multiscales"] = [{"version": "0.4", "axes": [{"name": n} for n in "czyx"], "datasets": [
        {"path": "full", "coordinateTransformations": [{"type": "scale", "scale": [1, 3, 2, 0.5]}, {"type": "translation", "translation": [0, 30, 20, 10]}]}]}]
    volume = big.from_zarr(tmp_path / "a.zarr", threshold=99)
    assert volume.lattice.spacing == (0.5, 2, 3) and volume.lattice.center0 == (10, 20, 30)
    assert np.array_equal(volume.array.compute(), values[0].T > 99)
    zarr.save(tmp_path / "b.zarr", values[0])
    assert big.from_zarr(tmp_path / "b.zarr").count() == (values != 0).sum()
    group.attrs.clear()
    with pytest.raises(bitvox.FormatError, match="full"):
        big.from_zarr(tmp_path / "a.zarr")


@needs_knot
def test_distributed_with_a_killed_worker(tmp_path):
    distributed = pytest.importorskip("distributed")
    pytest.importorskip("zarr")
    grid, mesh = whole()
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None,
                                  local_directory=str(tmp_path)) as cluster, distributed.Client(cluster) as client:
        volume = big.voxelize(bitvox.read(KNOT), grid.lattice, chunks=64)
        assert big.surface(volume).content_hash() == mesh.content_hash()
        pids = list(client.run(os.getpid).values())
        assert len(set(pids)) == 2 and os.getpid() not in pids
        assert volume.close(radius=0.1).compute() == grid.close(radius=0.1)
        killer = volume.map(functools.partial(conftest.killed_once, operator.invert, tmp_path / "killed"))
        parts = client.gather(client.compute(list(killer.blocks.values())))
        assert (tmp_path / "killed").exists() and join(grid.lattice, bitvox.Window((0, 0, 0), grid.shape), parts) == ~grid
        big.to_zarr(volume, tmp_path / "a.zarr")
        assert big.from_zarr(tmp_path / "a.zarr").compute() == grid
        assert big.surface(big.from_zarr(tmp_path / "a.zarr")).content_hash() == mesh.content_hash()


def peak():
    """Most bytes that this process ever held."""
    import resource

    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024


@pytest.mark.skipif(not os.environ.get("BITVOX_LARGE"), reason="takes a minute and 2 GiB: BITVOX_LARGE=1 asks for it")
def test_dragon_of_2048_voxels(shared, tmp_path):
    distributed = pytest.importorskip("distributed")
    path = shared("meshes/dragon_vrip_871414.ply.gz")
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None,
                                  local_directory=str(tmp_path)) as cluster, distributed.Client(cluster) as client:
        volume = big.voxelize(path, resolution=2048, chunks=512)
        mesh = big.surface(volume)
        assert all(held < 1.5 * 2**30 for held in client.run(peak).values())
    found = (mesh.n_faces, mesh.content_hash(), [bitvox.content_hash(keys) for keys in mesh.keys])
    del mesh
    single = bitvox.surface(bitvox.voxelize(path, lattice=volume.lattice), keys=True)
    assert found == (single.n_faces, single.content_hash(), [bitvox.content_hash(keys) for keys in single.keys])


def test_folders_that_are_not_zarrs(tmp_path):
    (tmp_path / "empty").mkdir()
    with pytest.raises(bitvox.FormatError, match="empty is a folder without an array or group"):
        big.from_zarr(tmp_path / "empty")
    with pytest.raises(FileNotFoundError):
        big.from_zarr(tmp_path / "missing")
    volume = big.voxelize(conftest.box_mesh(), resolution=8, chunks=4)
    with pytest.raises(bitvox.ArgumentError, match="path is empty"):
        big.to_zarr(volume, "", inner=4)
    big.to_zarr(volume, tmp_path / "a.zarr", inner=4)
    with pytest.raises(FileExistsError, match="overwrite=True"):
        big.to_zarr(volume, tmp_path / "a.zarr", inner=4)


def test_one_chunk_along_an_axis_may_be_of_any_side(tmp_path):
    box = conftest.box_mesh((0, 0, 0), (24, 20, 10))
    volume = big.voxelize(box, resolution=24, chunks=(12, 12, 64))
    assert volume.chunks.size[2] == 10
    big.to_zarr(volume, tmp_path / "a.zarr", inner=4)
    back = big.from_zarr(tmp_path / "a.zarr")
    assert back.compute() == volume.compute()
    with pytest.raises(bitvox.ArgumentError, match="not multiples of inner=5"):
        big.to_zarr(volume, tmp_path / "b.zarr", inner=5)
