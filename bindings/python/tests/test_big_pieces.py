"""Surfaces in pieces on disk: the bytes of the whole, levels that close where pieces meet, and what others read."""

import functools
import json
import os

import numpy as np
import pytest
from conftest import REPOSITORY, killed_at, killed_once

import bitvox

dask = pytest.importorskip("dask")
pytest.importorskip("zarr")
from bitvox import big  # noqa: E402
from bitvox.big.chunks import centers, planes  # noqa: E402

KNOT = REPOSITORY / "fixtures" / "knot.ply"
pytestmark = [pytest.mark.skipif(not KNOT.is_file(), reason="fixtures/knot.ply is not here"), pytest.mark.filterwarnings("ignore::bitvox.ResultWarning")]
LEVELS = 4


def volume(size, resolution=90):
    return big.voxelize(KNOT, resolution=resolution, padding=2, chunks=size)


@pytest.fixture(scope="module", params=[24, (33, 50, 11), 500])
def made(request, tmp_path_factory):
    """Pieces in chunks of several shapes, one of them the whole."""
    cut, said = volume(request.param), []
    folder = tmp_path_factory.mktemp("pieces") / "knot"
    return cut, big.run(cut, folder, levels=LEVELS, show=said.append), said


def test_the_finest_level_is_that_of_the_whole(made):
    cut, pieces, said = made
    whole = bitvox.surface(cut.compute(), keys=True)
    joined = pieces.merge()
    assert joined.content_hash() == whole.content_hash() and np.array_equal(joined.keys[1], whole.keys[1])
    assert pieces.n_faces() == whole.n_faces and pieces.lattice == cut.lattice and big.Pieces(pieces.path).records == pieces.records
    assert f"{len(cut.chunks)} chunks" in said[0] and "GiB a thread of a worker" in said[1] and "level 3" in said[-2]


def test_levels_close_where_pieces_meet(made):
    cut, pieces, _ = made
    whole = pieces.merge()
    for level in range(1, LEVELS):
        mesh = pieces.merge(level)
        found = mesh.check()
        assert found.closed and found.oriented and found.vertex_manifold and not len(mesh.crossings()), level
        assert mesh.n_faces < 0.6 * pieces.n_faces(level - 1) and abs(mesh.volume / whole.volume - 1) < 1e-3
        assert bitvox.compare(whole, mesh, samples=2000).max <= 1.05 * pieces.error(level) < 4 * max(cut.spacing) * 2**level
        for index in pieces.records[level]:
            ends, sides = planes(cut.chunks, level, index), centers(cut.chunks)
            low, high = np.maximum(ends[0], sides[0]), np.minimum(ends[1], sides[1])
            at = pieces.read(index, level).in_world()
            assert (at > np.subtract(low, 1e-6)).all() and (at < np.add(high, 1e-6)).all()


def test_pieces_of_different_levels_meet(made):
    _, pieces, _ = made
    some = [pieces.read(index, level=sum(index) % 2) for index in pieces.records[0]]
    mixed = big.pieces._welded(some)
    assert mixed.check().closed and mixed.check().vertex_manifold and not len(mixed.crossings())


def test_a_box_reads_what_lies_in_it(made):
    _, pieces, _ = made
    middle = tuple(np.mean(pieces.bounds, axis=0))
    low = (pieces.bounds[0], middle)
    part = pieces.merge(0, low)
    assert 0 < part.n_faces <= pieces.n_faces() and sum(m.n_faces for m in pieces.meshes(0, low)) == part.n_faces
    inside = (pieces.merge().in_world() < middle).all(axis=1).sum()
    assert (part.in_world() < middle).all(axis=1).sum() == inside
    assert pieces.merge(0, ((1e3,) * 3, (1e4,) * 3)).n_faces == 0
    for wrong in (lambda: pieces.read((9, 9, 9)), lambda: pieces.merge(LEVELS), lambda: pieces.error(-1)):
        with pytest.raises(bitvox.Error):
            wrong()


def test_a_run_that_was_stopped_continues(tmp_path):
    cut, said = volume((40, 90, 20)), []
    folder = tmp_path / "knot"
    first = big.run(cut, folder, levels=3, show=None)
    names = sorted(os.path.join(p, n) for p, _, ns in os.walk(folder) for n in ns if n.endswith(".npz"))
    times = {name: os.stat(name).st_mtime_ns for name in names}
    lost, torn, other = names[1], names[4], names[-1]
    os.unlink(lost)
    with open(torn, "r+b") as file:
        file.truncate(100)
    data = bytearray(open(other, "rb").read())
    data[300] ^= 1
    open(other, "wb").write(data)
    index = json.loads((folder / "index.json").read_text())
    del index["pieces"]  # as it is before the end
    (folder / "index.json").write_text(json.dumps(index))
    with pytest.raises(bitvox.FormatError, match="no finished pieces"):
        big.Pieces(folder)
    again = big.run(volume((40, 90, 20)), folder, levels=3, show=said.append)
    assert again.records == first.records and f"{len(names) - 3} of them there" in said[0]
    assert {name for name in names if os.stat(name).st_mtime_ns != times[name]} == {lost, torn, other}

    more = big.run(cut, folder, levels=4, show=None)  # further levels of the same
    assert more.records[:3] == first.records and len(more.records) == 4
    for different in (lambda: big.run(cut.erode(), folder, show=None), lambda: big.run(cut, tmp_path, show=None), lambda: big.run(cut, folder, face_rule="join", show=None)):
        with pytest.raises(FileExistsError, match="overwrite|other files"):
            different()
    anew = big.run(cut.erode(), folder, overwrite=True, show=None)
    assert anew.merge() == big.surface(cut.erode()) and len(anew.records) == 1
    big.to_zarr(cut.rechunk(32), tmp_path / "knot.zarr", inner=32)
    for there in (0, 18):  # tasks of files have equal names until the files change
        big.run(big.from_zarr(tmp_path / "knot.zarr"), tmp_path / "z", show=said.append)
        assert f"18 pieces, {there} of them there" in said[-3 if there else -4]


def test_folders_of_others_are_kept(tmp_path):
    for name, text in (("index.json", '{"layers": []}'), ("notes.txt", "mine")):
        folder = tmp_path / name.partition(".")[0]
        folder.mkdir()
        (folder / name).write_text(text)
        for overwrite in (False, True):
            with pytest.raises(FileExistsError, match="other files"):
                big.run(volume(500, 16), folder, overwrite=overwrite, show=None)
        assert (folder / name).read_text() == text


def test_a_disk_that_is_full(tmp_path, monkeypatch):
    cut, written, replace = volume((40, 90, 20)), [], os.replace

    def full(source, target):
        written.append(target)
        if len(written) > 5:
            raise OSError(28, "No space left on device")
        replace(source, target)

    with monkeypatch.context() as patched, dask.config.set(scheduler="synchronous"):  # what other threads still wrote would be counted
        patched.setattr(os, "replace", full)
        with pytest.raises(OSError, match="No space"):
            big.run(cut, tmp_path / "knot", levels=2, show=None)
    (tmp_path / "knot" / "0" / f"0_0_0.npz.killed{big.disk.PART}").touch()
    said = []
    assert big.run(cut, tmp_path / "knot", levels=2, show=said.append).merge() == big.surface(cut)
    assert "4 of them there" in said[0] and not list((tmp_path / "knot").rglob("*" + big.disk.PART))


def test_new_vertices_stay_between_cuts(ball, monkeypatch):
    monkeypatch.setattr(big.coarser, "LEFT", 16)
    none, cut = [float("inf")] * 3, ball.bounds[1]  # coarse triangles of a ball reach beyond it
    free, far = big.coarser.collapsed(ball, [-n for n in none], none, [0.01] * 3)
    assert (free.in_world() > cut).any() and far == bitvox.compare(ball, free, samples=free.n_faces).max
    held, far = big.coarser.collapsed(ball, [-n for n in none], cut, [0.01] * 3)
    assert (held.in_world() <= cut).all() and held.check().closed and held.n_faces < ball.n_faces / 3 and far > 0
    boxed, _ = big.coarser.collapsed(ball, [-n for n in none], none, [0.01] * 3, box=([-n for n in none], cut))
    monkeypatch.setattr(big.coarser, "_put_inside", lambda mesh, *_: mesh)
    kept, _ = big.coarser.collapsed(ball, [-n for n in none], none, [0.01] * 3, box=([-n for n in none], cut))
    assert all((mesh.in_world() <= cut).all() and mesh.check().closed and not len(mesh.crossings()) for mesh in (boxed, kept))
    assert boxed.n_faces == free.n_faces < ball.n_faces / 15 and kept.n_faces < ball.n_faces / 3


def test_what_would_cross_is_not_put_inside(ball):
    low, high = np.array(big.coarser.BOUNDLESS)
    ends = ball.bounds
    cap, most = ([*ends[1][:2], ends[0][2] + part * (ends[1][2] - ends[0][2])] for part in (0.9, 0.3))
    flat = big.coarser._put_inside(ball, low, cap, None)
    assert flat is not ball and flat.bounds[1] == pytest.approx(cap) and not len(flat.crossings())
    assert big.coarser._put_inside(ball, low, most, None) is ball  # above and below its middle faces would lie in one plane
    assert big.coarser._put_inside(ball, low, high, None) is ball
    tips = big.disk.beside([ball, ball.transform(np.array([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 100.0], [0, 0, 0, 1]]))])
    assert big.coarser._put_inside(tips, low, [*high[:2], ends[1][2]], None) is tips  # the second ball would be a sheet


@pytest.mark.parametrize("size, padding", [(40, 0), (13, 0), (40, 1)])
def test_levels_stay_in_the_box_of_their_volume(tmp_path, size, padding):
    rng, n = np.random.default_rng(7), 40 + 2 * padding
    at = np.stack(np.meshgrid(*[np.arange(40) + 0.5] * 3, indexing="ij"), axis=-1)
    solid = np.zeros((40, 40, 40), bool)
    for middle, radius in zip(rng.uniform(0, 40, (12, 3)), rng.uniform(6, 12, 12)):  # balls that the sides cut off
        solid |= ((at - middle) ** 2).sum(axis=-1) < radius**2
    pieces = big.run(big.from_dask(np.pad(solid, padding), chunks=size), tmp_path / "balls", levels=4, show=None)
    for level in range(4):
        mesh = pieces.merge(level)
        assert np.min(mesh.bounds) >= padding / 2 and np.max(mesh.bounds) <= n - padding / 2
        assert mesh.check().closed and not len(mesh.crossings())
    assert size < 40 or pieces.n_faces(3) < 0.02 * pieces.n_faces()  # flat sides do not keep their vertices


def test_a_level_encloses_what_its_mesh_does(ball, monkeypatch):
    none = [float("inf")] * 3
    made = ball
    for _ in range(3):  # by the middles of triangles alone it would lose 1.4 %
        made, _ = big.coarser.collapsed(made, [-n for n in none], none, [0.1] * 3)
    assert made.volume == pytest.approx(ball.volume, rel=1e-3) and made.check().closed and not len(made.crossings())
    double = bitvox.surface(bitvox.Grid.from_numpy(np.pad(np.ones((9, 9, 1), bool), 1)))  # a sheet: steps inwards would let its sides cross
    thin = big.coarser._as_large(double.transform(np.diag([1, 1, 1e-3])), double, *big.coarser.BOUNDLESS, 36.0)
    assert not len(thin.crossings()) and thin.volume > 0


def test_pieces_behind_a_url():
    cut = volume(50)
    pieces = big.run(cut, "memory://knot", levels=2, show=None)
    assert big.run(cut, "memory://knot", levels=2, show=None).records == pieces.records == big.Pieces("memory://knot").records
    assert pieces.merge() == big.surface(cut) and pieces.merge(1).check().closed


def test_empty_volumes_and_chunks_of_one(tmp_path):
    nothing = big.from_dask(np.zeros((4, 4, 4)), chunks=2)
    pieces = big.run(nothing, tmp_path / "a", levels=2, show=None)
    assert pieces.n_faces(1) == 0 == pieces.merge(1).n_faces == pieces.error(1)
    cut = big.from_dask(np.random.default_rng(1).random((3, 2, 3)) < 0.5, chunks=1)
    pieces = big.run(cut, tmp_path / "b", levels=3, show=None)
    assert pieces.merge() == big.surface(cut) and all(pieces.merge(level).check().closed for level in (1, 2))


@pytest.mark.parametrize("level", [0, 2])
def test_one_file_of_all(made, tmp_path, level):
    _, pieces, _ = made
    whole = pieces.merge(level)
    for ending in ("ply", "stl"):
        name = tmp_path / f"a.{ending}"
        pieces.save(name, level)
        back = bitvox.read(name)
        assert os.listdir(tmp_path) == [name.name] and back.n_faces == whole.n_faces and back.check(weld=ending == "stl").closed
        corners = [np.sort(np.asarray(m.vertices)[m.faces].reshape(-1, 9).view("V36").ravel()) for m in (back, whole)]
        if ending == "ply":
            assert back.n_vertices == whole.n_vertices and back.volume == pytest.approx(whole.volume)
        assert len(corners[0]) == len(corners[1])
        os.unlink(name)
    with pytest.raises(bitvox.ArgumentError, match=r"\.ply or \.stl"):
        pieces.save(tmp_path / "a.obj")
    pieces.save_regions(tmp_path / "regions", level)
    assert len(os.listdir(tmp_path / "regions")) == len(pieces.records[level])
    index = list(pieces.records[level])[-1]
    assert bitvox.read(tmp_path / "regions" / ("_".join(map(str, index)) + ".glb")).n_faces == pieces.read(index, level).n_faces


@pytest.mark.parametrize("sharded", [False, True])
def test_neuroglancer_reads_what_is_written(made, tmp_path, sharded):
    pytest.importorskip("DracoPy")
    cut, pieces, _ = made
    pieces.to_neuroglancer(tmp_path / "mesh", segment=7, sharded=sharded, nanometers=2.0)
    assert sorted(os.listdir(tmp_path / "mesh")) == (["0.shard", "info"] if sharded else ["7", "7.index", "info"])
    if not sharded:
        draco, head = pytest.importorskip("DracoPy"), np.frombuffer((tmp_path / "mesh" / "7.index").read_bytes(), "<u4")
        sizes = head[7 + 4 * LEVELS :][:LEVELS]  # fragments of each level; then their positions and bytes
        first = int(head[7 + 5 * LEVELS + 3 * sizes[0]])
        points = draco.decode((tmp_path / "mesh" / "7").read_bytes()[:first]).points
        assert np.array_equal(points, np.rint(points)) and points.max() <= 65535
    cloudvolume = pytest.importorskip("cloudvolume")
    info = cloudvolume.CloudVolume.create_new_info(1, "segmentation", "uint64", "raw", [1, 1, 1], [0, 0, 0], cut.shape, mesh="mesh")
    (tmp_path / "info").write_text(json.dumps(info))
    store = cloudvolume.CloudVolume(f"file://{tmp_path}", progress=False)
    for level in range(LEVELS):
        read = store.mesh.get(7, lod=level)
        read = read[7] if isinstance(read, dict) else read
        whole = pieces.merge(level)
        mesh = big.pieces._welded([bitvox.Mesh(read.vertices / 2, read.faces)])
        assert mesh.check().closed and mesh.check().oriented and abs(mesh.volume / whole.volume - 1) < 1e-3, level
        assert bitvox.compare(mesh, whole, samples=500).max < 1e-3 + (0 if level else max(cut.spacing))


@pytest.mark.parametrize("stage", ["_made", "_joined"])
def test_two_workers_and_one_that_is_killed(tmp_path, monkeypatch, two_workers, stage):
    cut = volume(48, 120)
    alone = big.run(cut, tmp_path / "alone", levels=3, show=None)
    monkeypatch.setattr(big.pieces, stage, functools.partial(killed_once, getattr(big.pieces, stage), tmp_path / "killed"))
    found = big.run(cut, tmp_path / "two", levels=3, show=None, client=two_workers)
    assert (tmp_path / "killed").exists() and found.records == alone.records


def test_chunks_are_halved_where_memory_does_not_suffice(tmp_path):
    cut, said = volume(100), []
    found = big.run(cut, tmp_path / "knot", levels=3, memory_limit=3_000_000, show=said.append)
    halves = big.run(cut.rechunk((45, 47, 32)), tmp_path / "halves", levels=3, show=None)
    assert found.records == halves.records and found.merge() == big.surface(cut) and found.merge(2).check().closed
    assert len([line for line in said if "91 x 94 x 41" in line and "again with half the sides" in line]) == 1
    again = big.run(volume(100), tmp_path / "knot", levels=3, show=said.append)
    assert "26 pieces, 26 of them there" in said[-5] and again.records == found.records == big.Pieces(again.path).records
    found.save_regions(tmp_path / "regions", 2)
    assert len(os.listdir(tmp_path / "regions")) == len(found.records[2])
    with pytest.raises(MemoryError):
        big.run(cut, tmp_path / "less", levels=2, memory_limit=500_000, show=None)


def test_windows_are_halved_where_memory_does_not_suffice():
    lattice = bitvox.Lattice.fit(KNOT, resolution=600)
    whole = bitvox.voxelize(KNOT, lattice=lattice)
    assert big.voxelize(KNOT, lattice, chunks=600, memory_limit=8_000_000).compute(scheduler="synchronous") == whole
    with pytest.raises(MemoryError):
        big.voxelize(KNOT, lattice, chunks=600, memory_limit=1_500_000).compute(scheduler="synchronous")

    cut, asked = volume(500).persist(), []
    grid = cut.compute()
    far = np.clip(grid.distance("signed"), -0.3, 0.3)
    with bitvox.settings(memory_limit=300_000), pytest.raises(MemoryError):
        grid.distance("signed")
    with bitvox.settings(memory_limit=300_000):
        assert np.array_equal(cut.distance(0.3, "signed").compute(scheduler="synchronous"), far)

    def some(part):
        asked.append(part.shape)
        if max(part.shape) > 40:
            raise MemoryError
        return part.erode(3)

    assert cut.around(some, 3).compute(scheduler="synchronous") == grid.erode(3) and len(asked) > 8


def test_a_worker_that_is_always_killed(tmp_path, monkeypatch):
    distributed = pytest.importorskip("distributed")
    cut = volume(100)
    monkeypatch.setattr(big.pieces, "_made", functools.partial(killed_at, big.pieces._made, "two"))
    with dask.config.set({"distributed.scheduler.allowed-failures": 0}), distributed.LocalCluster(
            n_workers=1, threads_per_worker=1, processes=True, dashboard_address=None, local_directory=str(tmp_path / "dask")) as cluster:
        with distributed.Client(cluster) as client:
            found = big.run(cut, tmp_path / "two", levels=2, show=None, client=client)
    assert found.chunks.size == (45, 47, 32) and found.merge() == big.surface(cut)
