"""Samples in chunks, and volumes as Dask's own collections."""

import numpy as np
import pytest

import bitvox

dask = pytest.importorskip("dask")
da = pytest.importorskip("dask.array")
zarr = pytest.importorskip("zarr")
from bitvox import big  # noqa: E402

RNG = np.random.default_rng(5)
VALUES = np.cumsum(RNG.normal(size=(23, 19, 17)), axis=0)  # [x, y, z]
PLACE = bitvox.Lattice(VALUES.shape, (0.5, 1.0, 2.0), (-3.0, 4.0, 5.0))


@pytest.mark.parametrize("chunks", [8, (23, 5, 7), 64])
@pytest.mark.parametrize("dtype", ["float64", "float32", "int16"])
def test_levels_are_those_of_the_whole(chunks, dtype):
    values = (10 * VALUES).astype(dtype)
    samples = big.Samples(da.from_array(values, chunks=(9, 9, 9)), PLACE)
    whole = bitvox.Volume(values, lattice=PLACE)
    assert samples.surface(1.0, chunks=chunks).content_hash() == whole.surface(1.0, keys=True, dtype="float64").content_hash()
    below = samples.surface(-2.5, below=True, face_rule="join", dtype="float32", chunks=chunks)
    assert below.content_hash() == whole.surface(-2.5, below=True, face_rule="join", dtype="float32", keys=True).content_hash()
    assert samples.threshold(0.0, 9.0, chunks=chunks).compute() == whole.threshold(0.0, 9.0)
    assert samples.compute() == whole and samples.shape == whole.shape


def test_samples_of_zarr_with_channels(tmp_path):
    stored = np.stack([VALUES.transpose(2, 1, 0), -VALUES.transpose(2, 1, 0)])[None]  # t, c, z, y, x
    group = zarr.open_group(str(tmp_path / "a.zarr"), mode="w", zarr_format=3)
    group.create_array("0", shape=stored.shape, chunks=(1, 1, 8, 8, 8), dtype="float64")[...] = stored
    axes = [{"name": "t", "type": "time"}, {"name": "c", "type": "channel"}, *({"name": a, "type": "space"} for a in "zyx")]
    places = [{"type": "scale", "scale": [1, 1, *PLACE.spacing[::-1]]}, {"type": "translation", "translation": [0, 0, *PLACE.center0[::-1]]}]
    group.attrs["ome"] = {"version": "0.5", "multiscales": [{"axes": axes, "datasets": [{"path": "0", "coordinateTransformations": places}]}]}
    for channel, sign in ((0, 1), (1, -1), ((0, 1), -1)):
        samples = big.samples_from_zarr(tmp_path / "a.zarr", channel=channel)
        assert np.array_equal(samples.array.compute(), sign * VALUES) and samples.lattice == PLACE
        assert big.from_zarr(tmp_path / "a.zarr", channel=channel, threshold=1.0).compute() == bitvox.Grid.from_numpy(sign * VALUES > 1.0, lattice=PLACE)
    with pytest.raises(bitvox.FormatError, match="channel="):
        big.from_zarr(tmp_path / "a.zarr")
    for wrong in (2, (0, 0, 0), -1):
        with pytest.raises(bitvox.Error):
            big.samples_from_zarr(tmp_path / "a.zarr", channel=wrong)
    samples = big.samples_from_zarr(tmp_path / "a.zarr", channel=1, chunks=8)
    assert samples.array.chunksize == (8, 8, 8) and samples.surface(0.5).n_faces == bitvox.Volume(-VALUES, lattice=PLACE).surface(0.5).n_faces
    with pytest.raises(bitvox.ArgumentError):
        big.Samples(samples.array[0])
    with pytest.raises(bitvox.ArgumentError):
        big.Samples(samples.array, bitvox.Lattice((2, 2, 2)))
    with pytest.raises(bitvox.ArgumentError):
        samples.threshold(3, 2)


def test_volumes_are_collections(ball):
    volume = big.voxelize(ball, resolution=24, chunks=16)
    whole = bitvox.voxelize(ball, resolution=24)
    assert dask.is_dask_collection(volume)
    (made,) = dask.compute(volume)
    assert isinstance(made, bitvox.Grid) and made == whole
    both, count = dask.compute(volume, volume.array.sum())
    assert both == whole and count == whole.count
    for kept in (volume.persist(), dask.persist(volume)[0]):
        assert isinstance(kept, big.Volume) and kept.compute() == whole and len(kept.__dask_graph__()) == len(kept.chunks)
    (plain,) = dask.optimize(volume)
    assert plain.compute() == whole
    assert dask.base.tokenize(volume) == dask.base.tokenize(big.voxelize(ball, resolution=24, chunks=16))
    assert dask.base.tokenize(volume) != dask.base.tokenize(volume.erode())
    assert "24" in volume._repr_html_() and "chunks" in volume._repr_html_()
    assert volume.compute(scheduler="synchronous") == whole


def test_arrays_that_are_laid_out():
    assert big.from_dask(np.ones((4, 4, 4))).count() == 64 and big.Samples(np.ones((4, 4, 4))).threshold(0.5).count() == 64
    near = np.array([2**53 + 1, 2**53 + 2], "u8").reshape(1, 1, 2)
    assert big.Samples(da.from_array(near, chunks=1)).threshold(2**53 + 1, 2**53 + 1).count() == 1
    unknown = da.from_array(np.ones((4, 4, 4)), chunks=2)
    unknown = unknown[unknown[:, 0, 0] > 0]
    for take in (big.from_dask, big.Samples):
        with pytest.raises(bitvox.ArgumentError, match="compute_chunk_sizes"):
            take(unknown)


def test_names_of_stored_samples_last_until_files_change(tmp_path):
    array = zarr.open_array(str(tmp_path / "s.zarr"), mode="w", shape=(8, 8, 8), chunks=(4, 4, 4), dtype="float32")
    array[...] = 1
    first, again = (big.samples_from_zarr(tmp_path / "s.zarr").threshold(0.5) for _ in range(2))
    assert first.__dask_keys__() == again.__dask_keys__()
    said = []
    for _ in range(2):
        big.run(big.samples_from_zarr(tmp_path / "s.zarr").threshold(0.5), tmp_path / "pieces", show=said.append)
    assert "0 of them there" in said[0] and "8 of them there" in next(line for line in said[1:] if "of them there" in line)
    array[0, 0, 0] = 0
    assert big.samples_from_zarr(tmp_path / "s.zarr").threshold(0.5).__dask_keys__() != first.__dask_keys__()


def test_stores_are_whole_or_not_read(tmp_path):
    volume = big.from_dask(da.ones((8, 8, 8), chunks=4))
    path = tmp_path / "v.zarr"
    broken = volume.map(lambda grid: 1 // 0)
    with pytest.raises(ZeroDivisionError):
        big.to_zarr(broken, path, inner=4)
    with pytest.raises(bitvox.Error):  # it has no metadata before all chunks are there
        big.from_zarr(path)
    big.to_zarr(volume, path, inner=4, overwrite=True)
    big.to_zarr(big.from_zarr(path).erode(), path, inner=4, overwrite=True)
    big.to_zarr(~big.samples_from_zarr(path).threshold(0.5), path, inner=4, overwrite=True)
    assert big.from_zarr(path).count() == 512 - 216
    with pytest.raises(ZeroDivisionError):
        big.to_zarr(broken, path, inner=4, overwrite=True)
    assert big.from_zarr(path).count() == 512 - 216 and [one.name for one in tmp_path.iterdir()] == ["v.zarr"]
