"""Chunks equal the whole, by bytes, however and wherever they are made."""

import operator
import os
import pickle
import signal
import time
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from multiprocessing import get_context

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
    assert volume.map(operator.invert).count() == (~grid).count
    from dask.base import tokenize

    assert tokenize(bitvox.read(KNOT)) == tokenize(bitvox.read(KNOT)) != tokenize(mesh)  # equal work has one name
    assert tokenize(grid) == tokenize(bitvox.Grid.from_numpy(grid.to_numpy(), lattice=grid.lattice)) != tokenize(~grid)
    odd = big.from_dask(array.rechunk((50, 150, 25)), grid.lattice)
    assert odd.compute() == grid and big.surface(odd).content_hash() == mesh.content_hash()
    with pytest.raises(bitvox.ArgumentError):
        volume.map(operator.or_, odd)
    with pytest.raises(bitvox.ArgumentError):
        big.voxelize(KNOT, grid.lattice, resolution=3)


@needs_knot
def test_zarr(tmp_path):
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


def slowly(grid):
    time.sleep(0.15)
    return grid


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
        slow = volume.map(slowly)
        futures = client.compute(list(slow.blocks.values()))
        while not any(f.status == "finished" for f in futures):
            time.sleep(0.02)
        os.kill(pids[0], signal.SIGKILL)
        parts = client.gather(futures)
        assert join(grid.lattice, bitvox.Window((0, 0, 0), grid.shape), parts) == grid
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
