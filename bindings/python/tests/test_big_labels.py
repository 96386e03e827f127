"""Labels in chunks: each body is that of the whole, closed on each level, and what Neuroglancer reads."""

import functools
import json
import os

import numpy as np
import pytest
from conftest import killed_once

import bitvox

dask = pytest.importorskip("dask")
da = pytest.importorskip("dask.array")
zarr = pytest.importorskip("zarr")
from bitvox import big  # noqa: E402

pytestmark = pytest.mark.filterwarnings("ignore::bitvox.ResultWarning")
PLACE = bitvox.Lattice((50, 44, 38), (0.5, 1.0, 0.75), (-3.0, 4.0, 5.0))
HIGH = 2**63 + 5  # does not fit into a float


def cells(dtype="uint64", shape=PLACE.shape, count=12):
    """Voronoi cells in a ball, some beyond the sides; of one body two voxels lie apart."""
    rng = np.random.default_rng(3)
    at = np.stack(np.meshgrid(*map(np.arange, shape), indexing="ij"), axis=-1)
    seeds = rng.random((count, 3)) * shape
    nearest = np.argmin([((at - seed) ** 2).sum(axis=-1) for seed in seeds], axis=0) + 1
    values = np.where(((at - np.divide(shape, 2)) ** 2).sum(axis=-1) < (0.48 * max(shape)) ** 2, nearest, 0).astype(dtype)
    values[values == 3] = HIGH if np.dtype(dtype) == np.uint64 else -7 if np.dtype(dtype).kind == "i" else 3
    values[0, 0, :2] = 5
    return values


@pytest.mark.parametrize("chunks", [16, (50, 9, 20), 64])
def test_bodies_are_those_of_the_whole(chunks, tmp_path):
    values = cells()
    labels = big.Labels(da.from_array(values, chunks=(20, 44, 17)), PLACE, chunks=chunks)
    counts = dict(zip(*(part.tolist() for part in np.unique(values[values != 0], return_counts=True))))
    assert labels.counts() == counts and labels.volume(HIGH).count() == counts[HIGH] and labels.lattice == PLACE and labels.shape == PLACE.shape
    pieces = big.run(labels, tmp_path / "bodies", levels=3, show=None)
    assert pieces.labels == sorted(counts) and big.Pieces(tmp_path / "bodies").records == pieces.records
    total = 0
    for label, count in counts.items():
        whole = bitvox.surface(bitvox.Grid.from_numpy(values == label, lattice=PLACE), keys=True)
        assert pieces.merge(label=label) == whole
        total += whole.n_faces
        for level in (1, 2):
            mesh = pieces.merge(level, label=label)
            assert mesh.check().closed and mesh.check().oriented and mesh.check().vertex_manifold and not len(mesh.crossings())
            if count > 1000:
                assert abs(mesh.volume / whole.volume - 1) < 1e-3
    assert pieces.n_faces() == total and pieces.n_faces(1) < total / 2
    pieces.save(tmp_path / "a.ply", 1, label=HIGH)
    assert bitvox.read(tmp_path / "a.ply").check().closed


def test_same_bytes_from_other_chunks_and_kinds(tmp_path):
    values = cells("int16")
    made = [big.run(big.Labels(big.Samples(da.from_array(values.astype(kind), chunks=sides), PLACE), chunks=16), tmp_path / f"{k}", levels=3, show=None)
            for k, (kind, sides) in enumerate((("int16", 11), ("int64", (50, 3, 38))))]
    assert made[0].records == made[1].records and -7 in made[0].labels
    other = big.run(big.Labels(values, PLACE, background=4, chunks=16), tmp_path / "other", show=None)
    assert 0 in other.labels and 4 not in other.labels


def test_chunks_are_halved_where_memory_does_not_suffice(tmp_path):
    values = np.arange(64**3).reshape(64, 64, 64) // 2**17 + 1
    values[20:30, 20:30, 20:30] = 7
    found = big.run(big.Labels(values), tmp_path / "a", levels=2, memory_limit=3_500_000, show=None)
    assert found.chunks.size == (32, 32, 32) and found.labels == [1, 2, 7]
    assert found.records == big.run(big.Labels(values, chunks=32), tmp_path / "b", levels=2, show=None).records


def test_what_is_refused(tmp_path):
    pieces = big.run(big.Labels(cells(), PLACE, chunks=64), tmp_path / "a", show=None)
    for wrong in (lambda: pieces.merge(), lambda: pieces.save(tmp_path / "a.ply"), lambda: big.Labels(np.ones((4, 4, 4))), lambda: big.Labels(np.ones((4, 4), int)),
                  lambda: big.Labels(np.ones((4, 4, 4), int), background=0.5), lambda: big.run(big.from_dask(np.ones((3, 3, 3))), tmp_path / "b", show=None).merge(label=1)):
        with pytest.raises((bitvox.Error, TypeError)):
            wrong()
    assert pieces.merge(label=77).n_faces == 0
    pytest.importorskip("DracoPy")
    with pytest.raises(bitvox.Error, match="label"):  # no segment below 1
        big.run(big.Labels(cells("int16"), PLACE, chunks=64), tmp_path / "c", show=None).to_neuroglancer(tmp_path / "mesh")
    assert not big.run(big.Labels(np.zeros((5, 5, 5), int)), tmp_path / "d", levels=2, show=None).labels
    noise = np.random.default_rng(1).integers(0, 30, (5, 4, 3))
    pieces = big.run(big.Labels(noise, chunks=1), tmp_path / "e", levels=2, show=None)
    assert pieces.merge(label=7) == bitvox.surface(bitvox.Grid.from_numpy(noise == 7), keys=True) and pieces.merge(1, label=7).check().closed


def assert_cloudvolume_reads(pieces, folder, shape):
    """Each body of each level, closed and as large as it was written; folder has the meshes in "mesh"."""
    cloudvolume = pytest.importorskip("cloudvolume")
    info = cloudvolume.CloudVolume.create_new_info(1, "segmentation", "uint64", "raw", [1, 1, 1], [0, 0, 0], shape, mesh="mesh")
    (folder / "info").write_text(json.dumps(info))
    store = cloudvolume.CloudVolume(f"file://{folder}", progress=False)
    for label in pieces.labels:
        for level in range(3):
            read = store.mesh.get(label, lod=level)
            read = read[label] if isinstance(read, dict) else read
            mesh, whole = big.pieces._welded([bitvox.Mesh(read.vertices, read.faces)]), pieces.merge(level, label=label)
            assert mesh.check().closed and abs(mesh.volume / whole.volume - 1) < 0.02, (label, level)


@pytest.mark.parametrize("sharded", [False, True])
def test_neuroglancer_reads_each_body(tmp_path, sharded, monkeypatch):
    pytest.importorskip("DracoPy")
    monkeypatch.setattr(big.written, "OPEN", 2)
    values = np.pad(cells(count=6), 2)  # what the low sides cut would end half a voxel further in
    lattice = bitvox.Lattice(values.shape)
    pieces = big.run(big.Labels(values, lattice, chunks=16), tmp_path / "bodies", levels=3, show=None)
    pieces.to_neuroglancer(tmp_path / "mesh", sharded=sharded)
    named = {"0.shard", "info"} if sharded else {"info", *(f"{label}{end}" for label in pieces.labels for end in ("", ".index"))}
    assert set(os.listdir(tmp_path / "mesh")) == named
    assert_cloudvolume_reads(pieces, tmp_path, lattice.shape)


@pytest.mark.parametrize("stage", ["_joined", "_shared"])  # of bodies alone, of bodies with shared faces
def test_a_worker_that_is_killed(tmp_path, monkeypatch, two_workers, stage):
    array = zarr.open_array(str(tmp_path / "l.zarr"), mode="w", shape=(64, 64, 64), chunks=(32, 32, 32), dtype="uint64")
    array[...] = cells(shape=(64, 64, 64))
    labels = big.Labels(big.samples_from_zarr(tmp_path / "l.zarr"), chunks=24, shared=stage == "_shared")
    alone = big.run(labels, tmp_path / "alone", levels=3, show=None)
    monkeypatch.setattr(big.pieces, stage, functools.partial(killed_once, getattr(big.pieces, stage), tmp_path / "killed"))
    made = big.run(labels, tmp_path / "two", levels=3, client=two_workers, show=None)
    assert (tmp_path / "killed").exists() and made.records == alone.records


def faces_of(mesh):
    """Corners of faces by position, whatever they begin with."""
    at = np.asarray(mesh.vertices)[mesh.faces]
    first = np.lexsort(at.transpose(2, 0, 1)[::-1], axis=1)[:, 0]
    return {tuple(map(tuple, np.roll(corners, -k, axis=0).tolist())) for corners, k in zip(at, first)}


@pytest.mark.parametrize("chunks", [14, (25, 9, 36), 64])
def test_bodies_share_their_faces(chunks, tmp_path):
    values = cells(count=7)
    labels = big.Labels(da.from_array(values, chunks=(20, 44, 17)), PLACE, chunks=chunks, shared=True)
    counts = labels.counts()
    pieces = big.run(labels, tmp_path / "bodies", levels=3, show=None)
    assert pieces.labels == sorted(counts) and big.Pieces(tmp_path / "bodies").records == pieces.records
    if chunks == 64:
        whole = bitvox.Volume(values, lattice=PLACE).surfaces()
        assert all(faces_of(whole[label]) == faces_of(pieces.merge(label=label)) for label in counts)
    voxel = float(np.prod(PLACE.spacing))
    for level in range(3):
        bodies = {label: pieces.merge(level, label=label) for label in counts}
        assert all(mesh.check().closed and mesh.check().oriented and mesh.check().vertex_manifold for mesh in bodies.values())
        for label, count in counts.items():  # small chunks have much of their faces in seams, which are smoothed less
            assert count < 1000 or bodies[label].volume == pytest.approx(count * voxel, rel=0.03 if level else 0.005), (level, label)
        assert sum(mesh.volume for mesh in bodies.values()) == pytest.approx(sum(counts.values()) * voxel, rel=0.01 if level else 0.001)
        every = [faces_of(mesh) for mesh in bodies.values()]
        turned = [{(a, c, b) for a, b, c in faces} for faces in every]
        shared = sum(len(faces & other) for faces in every for other in turned)
        assert shared > 0.2 * sum(map(len, every)) and not any(len(bodies[label].crossings()) for label in counts)
        alone = np.array([face for k, faces in enumerate(every) for face in faces if not any(face in other for other in turned[:k])], "f4")
        number = big.pieces._welded([bitvox.Mesh(alone.reshape(-1, 3), np.arange(3 * len(alone)).reshape(-1, 3))])
        assert not len(number.crossings())  # of all bodies together
    assert pieces.n_faces(2) < (0.8 if chunks == 14 else 0.5) * pieces.n_faces() and 0 < pieces.error(1) < 2
    part = pieces.read(next(iter(pieces.records[0])), level=1)
    again = big.run(labels, tmp_path / "bodies", levels=4, show=None)
    assert again.records[:3] == pieces.records and part == again.read(next(iter(pieces.records[0])), level=1)


def test_shared_faces_need_two_voxels():
    with pytest.raises(bitvox.ArgumentError, match="one voxel"):
        big.Labels(cells(), PLACE, chunks=7, shared=True)
    assert big.Labels(cells(), PLACE, chunks=64, shared=True).rechunk(8).shared


def test_neuroglancer_reads_bodies_with_shared_faces(tmp_path):
    pytest.importorskip("DracoPy")
    labels = big.Labels(np.pad(cells(count=6), 2), chunks=16, shared=True)
    pieces, said = big.run(labels, tmp_path / "bodies", levels=3, show=None), []
    assert big.run(labels, tmp_path / "bodies", levels=3, show=said.append).records == pieces.records and "of them there" in said[0]
    pieces.to_neuroglancer(tmp_path / "mesh", sharded=True)
    assert_cloudvolume_reads(pieces, tmp_path, labels.shape)


def test_tasks_read_small_chunks_of_zarr_themselves(tmp_path):
    values = cells(shape=(64, 64, 64))
    array = zarr.create_array(str(tmp_path / "l.zarr"), shape=(1, 64, 64, 64), chunks=(1, 8, 8, 8), dtype="uint64")
    array[0] = values.transpose(2, 1, 0)
    labels = big.Labels(big.samples_from_zarr(tmp_path / "l.zarr", channel=0), chunks=32)
    inside = big.Labels(values, chunks=32)
    assert labels.counts() == inside.counts() and labels.rechunk(16).counts() == inside.counts()
    assert all(len(part.__dask_graph__()) <= 2 for part in labels._bodies({"dtype": "float32"}))  # not one for each of 512 stored chunks
    found, same = (big.run(one, tmp_path / name, levels=2, show=None) for one, name in ((labels, "a"), (inside, "b")))
    assert found.records == same.records
