"""Errors, limits, progress, cancellation, threads, forks, leaks."""

import inspect
import os
import pickle
import re
import resource
import signal
import subprocess
import sys
import textwrap
import threading
import time
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from conftest import TETRAHEDRON, ball_grid, public_names

import bitvox

MAIN_THREAD_ONLY = pytest.mark.skipif(os.name == "nt", reason="signals of POSIX")


def run(code, **environment):
    """A fresh interpreter."""
    return subprocess.run([sys.executable, "-c", textwrap.dedent(code)], capture_output=True, text=True, timeout=300,
                          env={**os.environ, **environment}, check=False)


def test_errors_are_what_python_users_catch():
    with pytest.raises(ValueError) as caught:
        bitvox.voxelize(([], []))
    assert isinstance(caught.value, bitvox.EmptyError) and caught.value.code == 6 and caught.value.name == "BVX_ERR_EMPTY"
    with pytest.raises(MemoryError) as caught:
        bitvox.voxelize(TETRAHEDRON, resolution=512, memory_limit=1000)
    assert isinstance(caught.value, bitvox.MemoryLimitError)
    with pytest.raises(NotImplementedError):
        bitvox.loads(b"", "docx")
    with pytest.raises(bitvox.FormatError, match="byte|line|header|short|size"):
        bitvox.loads(b"not a mesh", "ply")


def test_errors_have_reasons_and_indices():
    vertices, faces = TETRAHEDRON
    with pytest.raises(bitvox.RangeError) as caught:
        bitvox.voxelize((vertices, [[0, 1, 2], [0, 1, 9]]))
    assert (caught.value.reason, caught.value.index) == ("BVX_REASON_INDEX", 1)
    spoiled = [[float("nan")] * 3 if n == 2 else list(v) for n, v in enumerate(vertices)]
    with pytest.raises(bitvox.RangeError) as caught:
        bitvox.voxelize((spoiled, faces), resolution=8)
    assert (caught.value.reason, caught.value.index) == ("BVX_REASON_NOT_FINITE", 2)
    again = pickle.loads(pickle.dumps(caught.value))
    assert (str(again), again.reason, again.index) == (str(caught.value), "BVX_REASON_NOT_FINITE", 2)
    far = [[x + 5e6 for x in v] for v in vertices]
    with pytest.raises(bitvox.RangeError) as caught:
        bitvox.surface(bitvox.voxelize((far, faces), resolution=64), dtype="float32")
    assert caught.value.reason == "BVX_REASON_FLOATS_COARSE"
    with pytest.raises(bitvox.MemoryLimitError) as caught:
        bitvox.voxelize(TETRAHEDRON, resolution=512, memory_limit=1000)
    assert (caught.value.reason, caught.value.index) == ("BVX_REASON_BUDGET", None)
    with pytest.raises(bitvox.Cancelled) as caught:
        bitvox.voxelize(TETRAHEDRON, resolution=300, progress=lambda stage, fraction: False)
    assert caught.value.reason == "BVX_REASON_CANCELLED"
    with pytest.raises(bitvox.ArgumentError) as caught:
        bitvox.voxelize(TETRAHEDRON, resolution=8, spacing=1.0)  # found in Python
    assert (caught.value.reason, caught.value.index) == ("BVX_REASON_INVALID", None)
    for out_of_range in (lambda: bitvox.voxelize(TETRAHEDRON, resolution=0),  # found in Python
                         lambda: bitvox.repair(TETRAHEDRON, shell=-1.0)):  # found by the library
        for kind in (bitvox.OptionRangeError, bitvox.ArgumentError, bitvox.RangeError, ValueError):
            with pytest.raises(kind) as caught:
                out_of_range()
            assert (caught.value.code, caught.value.name, caught.value.reason) == (1, "BVX_ERR_ARGUMENT", "BVX_REASON_RANGE")


def test_settings_nest_and_end():
    with bitvox.settings(memory_limit=1000):
        with pytest.raises(bitvox.MemoryLimitError):
            bitvox.voxelize(TETRAHEDRON, resolution=256)
        with bitvox.settings(threads=1):
            with pytest.raises(bitvox.MemoryLimitError):
                bitvox.voxelize(TETRAHEDRON, resolution=256)
            assert bitvox.voxelize(TETRAHEDRON, resolution=256, memory_limit=2**30).count > 0
    assert bitvox.voxelize(TETRAHEDRON, resolution=256).count > 0


def test_progress_and_cancellation():
    seen = []
    grid = bitvox.voxelize(TETRAHEDRON, resolution=300, progress=lambda stage, fraction: seen.append((stage, fraction)))
    assert len(seen) > 3 and all(isinstance(s, str) and 0 <= f <= 1 for s, f in seen)
    assert grid == bitvox.voxelize(TETRAHEDRON, resolution=300)
    with pytest.raises(bitvox.Cancelled):
        bitvox.voxelize(TETRAHEDRON, resolution=300, progress=lambda stage, fraction: False)
    with bitvox.settings(progress=lambda stage, fraction: False):
        with pytest.raises(bitvox.Cancelled):
            bitvox.surface(grid)

    class Mine(Exception):
        pass

    def fail(stage, fraction):
        raise Mine(stage)

    with pytest.raises(Mine):
        bitvox.lod(TETRAHEDRON, levels=16, progress=fail)
    with pytest.raises(Mine):
        bitvox.lod(TETRAHEDRON, progress=fail)
    with pytest.raises(TypeError):
        bitvox.surface(grid, progress=3)


def _with_progress():
    """A call of each public function that takes ``progress``, by name."""
    mesh = bitvox.Mesh(*TETRAHEDRON)
    colored = bitvox.Mesh(*TETRAHEDRON, colors=np.full((4, 4), 200, np.uint8))
    grid = bitvox.voxelize(mesh, resolution=32)
    shell = bitvox.voxelize(mesh, resolution=32, mode="conservative")
    tree = bitvox.refine(mesh, base=4, levels=2)
    field = bitvox.field(mesh, resolution=16)
    volume = bitvox.Volume(np.arange(512, dtype=np.float32).reshape(8, 8, 8))
    sections = bitvox.slice_mesh(mesh, spacing=0.1)
    part = bitvox.surface(grid, keys=True)
    rays, points = [[-1, 0.2, 0.2, 1, 0, 0]], [[0.2, 0.2, 0.2]]
    finder, caster, skin, ply = bitvox.Closest(mesh), bitvox.Rays(grid), bitvox.surface(grid), bitvox.dumps(mesh, "ply")
    return {
        "voxelize": lambda **p: bitvox.voxelize(mesh, resolution=32, **p),
        "voxelize surface": lambda **p: bitvox.voxelize(mesh, resolution=32, mode="thin", **p),
        "voxelize_points": lambda **p: bitvox.voxelize_points(mesh.vertices, resolution=8, **p),
        "find_seed": lambda **p: bitvox.find_seed(shell, mesh, **p),
        "find_pockets": lambda **p: bitvox.find_pockets(shell, mesh, **p),
        "surface": lambda **p: bitvox.surface(grid, **p),
        "faces": lambda **p: bitvox.faces(grid, **p),
        "merge": lambda **p: bitvox.merge([part], **p),
        "carry": lambda **p: bitvox.carry(colored, mesh, **p),
        "label_voxels": lambda **p: bitvox.label_voxels(colored, grid, **p),
        "check": lambda **p: bitvox.check(mesh, **p),
        "compare": lambda **p: bitvox.compare(mesh, mesh, samples=100, **p),
        "compare grids": lambda **p: bitvox.compare(grid, shell, **p),
        "crossings": lambda **p: mesh.crossings(**p),
        "measure": lambda **p: mesh.measure(resolution=16, **p),
        "inspect": lambda **p: bitvox.inspect(mesh, resolution=16, **p),
        "Closest": lambda **p: bitvox.Closest(mesh, **p),
        "Closest.find": lambda **p: finder.find(points, **p),
        "Rays": lambda **p: bitvox.Rays(grid, **p),
        "Rays.cast": lambda **p: caster.cast(rays, **p),
        "Rays.update": lambda **p: caster.update(grid, **p),
        "repair": lambda **p: bitvox.repair(mesh, resolution=16, **p),
        "hull": lambda **p: bitvox.hull(colored, resolution=16, triangles=40, carry=True, **p),
        "repair, all of it": lambda **p: bitvox.repair(colored, resolution=16, triangles=40, measure=True, measure_samples=50, carry=True, **p),
        "boolean": lambda **p: bitvox.boolean(mesh, mesh, "union", resolution=16, **p),
        "boolean, fewer": lambda **p: bitvox.boolean(mesh, mesh, "union", resolution=16, triangles=40, **p),
        "lod": lambda **p: bitvox.lod(mesh, triangles=(8, 4), **p),
        "lod with colors": lambda **p: bitvox.lod(colored, solid=True, resolution=16, triangles=(200, 100), carry=True, **p),
        "lod of a grid": lambda **p: bitvox.lod(grid, levels=(16, 8), **p),
        "lod of a grid by collapse": lambda **p: bitvox.lod(grid, method="collapse", triangles=(200, 100), **p),
        "lod of a mesh by levels": lambda **p: bitvox.lod(colored, levels=(16, 8), carry=True, **p),
        "simplify": lambda **p: skin.simplify(triangles=(200, 100), **p),
        "refine": lambda **p: bitvox.refine(mesh, resolution=32, **p),
        "expand": lambda **p: tree.expand(**p),
        "octree surface": lambda **p: tree.surface(**p),
        "octree cast": lambda **p: tree.cast(rays, **p),
        "field": lambda **p: bitvox.field(mesh, resolution=16, **p),
        "field surface": lambda **p: field.surface(**p),
        "field dense": lambda **p: field.to_numpy(**p),
        "threshold": lambda **p: volume.threshold(100, **p),
        "volume surface": lambda **p: volume.surface(100.0, **p),
        "volume surface, fewer": lambda **p: volume.surface(100.0, triangles=50, **p),
        "from_sections": lambda **p: bitvox.from_sections(sections, **p),
        "slice_mesh": lambda **p: bitvox.slice_mesh(mesh, spacing=0.1, **p),
        "slice_mesh of a grid": lambda **p: bitvox.slice_mesh(grid, spacing=0.1, **p),
        "render": lambda **p: bitvox.render(mesh, size=(32, 32), **p),
        "components": lambda **p: grid.components(**p),
        "label": lambda **p: grid.label(**p),
        "keep": lambda **p: grid.keep(largest=1, **p),
        "dilate": lambda **p: grid.dilate(2, **p),
        "open": lambda **p: grid.open(2, **p),
        "hollow": lambda **p: grid.hollow(0.05, **p),
        "distance": lambda **p: grid.distance(**p),
        "cast": lambda **p: grid.cast(rays, **p),
        "sample": lambda **p: grid.sample(points, **p),
        "topology": lambda **p: grid.topology(**p),
        "dumps": lambda **p: bitvox.dumps(mesh, "ply", **p),
        "loads": lambda **p: bitvox.loads(ply, "ply", **p),
    }


def test_every_function_with_progress_is_in_the_table():
    takes = {name for name in public_names(bitvox) if callable(getattr(bitvox, name)) and not isinstance(getattr(bitvox, name), type)
             and "progress" in inspect.signature(getattr(bitvox, name)).parameters}
    files = {"read", "read_points", "read_volume", "write", "write_levels"}  # what they do is in loads and dumps
    assert takes - files - {"settings"} <= {name.split()[0].strip(",") for name in _with_progress()}


def test_progress_is_one_rise_of_each_call():
    for name, call in _with_progress().items():
        for threads in (1, 3):
            seen = []
            call(threads=threads, progress=lambda stage, fraction: seen.append((stage, fraction)))
            fractions = [fraction for _, fraction in seen]
            assert fractions and fractions == sorted(fractions), (name, seen)
            assert fractions[-1] == 1.0 and fractions.count(1.0) == 1, (name, seen)
            assert all(stage for stage, _ in seen), (name, seen)


def test_progress_of_settings_is_one_rise_of_each_call():
    for name, call in _with_progress().items():
        seen = []
        with bitvox.settings(threads=1, progress=lambda stage, fraction, seen=seen: seen.append(fraction)):
            call()
        assert seen == sorted(seen) and seen.count(1.0) == (1 if seen else 0), (name, seen)
        assert not seen or seen[-1] == 1.0, (name, seen)


def test_the_last_value_of_progress_cancels_nothing():
    assert bitvox.voxelize(TETRAHEDRON, resolution=32, progress=lambda stage, fraction: fraction < 1).count > 0

    def fail(stage, fraction):
        if fraction == 1:
            raise KeyError(stage)

    with pytest.raises(KeyError):
        bitvox.voxelize(TETRAHEDRON, resolution=32, progress=fail)


def test_a_call_that_fails_does_not_reach_1():
    seen = []
    with pytest.raises(bitvox.MemoryLimitError):
        bitvox.voxelize(TETRAHEDRON, resolution=256, memory_limit=10_000, progress=lambda stage, fraction: seen.append(fraction))
    with pytest.raises(bitvox.Cancelled):
        bitvox.repair(TETRAHEDRON, resolution=32, triangles=40, progress=lambda stage, fraction: seen.append(fraction) or fraction < 0.5)
    assert seen and max(seen) < 1


def test_calls_inside_a_progress_callable():
    inner = []
    bitvox.voxelize(TETRAHEDRON, resolution=64, progress=lambda s, f: inner.append(bitvox.voxelize(TETRAHEDRON, resolution=8).count))
    assert len(set(inner)) == 1


def test_bar():
    pytest.importorskip("tqdm")
    assert bitvox.voxelize(TETRAHEDRON, resolution=64, progress=True).count > 0


def test_missing_extra_is_named():
    found = run("""
        import sys
        sys.modules["tqdm"] = None
        sys.modules["pyvista"] = None
        import bitvox
        for call in (lambda: bitvox.voxelize(([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]), resolution=4, progress=True),
                     lambda: bitvox.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]).to_pyvista()):
            try:
                call()
            except ImportError as error:
                assert isinstance(error, bitvox.Error) and "bitvox[view]" in str(error) and "pip install" in str(error), error
            else:
                raise SystemExit("no error")
        """)
    assert found.returncode == 0, found.stderr


@MAIN_THREAD_ONLY
def test_interrupt_ends_a_call():
    found = run("""
        import os, signal, threading, time, bitvox
        signal.signal(signal.SIGINT, signal.default_int_handler)   # jobs in the background begin with it ignored
        threading.Timer(0.4, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
        start = time.monotonic()
        try:
            while time.monotonic() - start < 60:
                bitvox.voxelize(([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]),
                                resolution=600, threads=1)
        except KeyboardInterrupt:
            print("interrupted", time.monotonic() - start)
            assert bitvox.voxelize(([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]), resolution=4, mode="conservative").count > 0
        """)
    assert found.returncode == 0 and found.stdout.startswith("interrupted"), found.stderr
    assert found.stderr == ""  # no word about an exception that was ignored


def everything(mesh, grid):
    """One call of each kind, as hashes."""
    solid = bitvox.voxelize(mesh, resolution=40)
    tree = bitvox.refine(mesh, levels=2)
    closest = bitvox.Closest(mesh)
    surface = bitvox.surface(grid, keys=True)
    measured = bitvox.field(mesh, resolution=12, features=True)
    sections = bitvox.slice_mesh(mesh, spacing=2.0)
    volume = bitvox.Volume(np.asarray(grid.distance("signed") * 10, np.int16))
    painted = bitvox.Mesh(mesh.vertices, mesh.faces, colors=np.abs(mesh.vertices) / np.abs(mesh.vertices).max())
    leaf = tree.leaves()[0]
    return [
        measured.distances.tobytes(), measured.to_numpy().tobytes(), measured.surface().content_hash(), bitvox.dumps(measured, "nrrd"),
        bitvox.repair(mesh, resolution=16).content_hash(), bitvox.hull(mesh, resolution=16).content_hash(), bitvox.dumps(sections, "csl"),
        bitvox.from_sections(sections, grid=(12, 12)).content_hash(), bitvox.carry(painted, surface).colors.tobytes(),
        bitvox.find_pockets(bitvox.voxelize(mesh, resolution=20, padding=1, mode="thin"), mesh).tolist(), bitvox.surface_counts(grid),
        bitvox.content_hash(b"abc"), bitvox.render(grid, size=(40, 30), compare=~grid).png(),
        tree.at([[0, 0, 0]]).tobytes(), tree.find([[1.0, 2, 3]]).tobytes(), tree.neighbors(leaf, "+x").tobytes(),
        tree.cast([[0.0, 0, 0, 1, 1, 1]]).tobytes(), tree.expand().content_hash(), bitvox.dumps(tree, "vtu"),
        bitvox.refine(mesh, resolution=24).counts(), grid.fill([[0, 0, 0]]).content_hash(),
        solid.content_hash(), bitvox.voxelize(mesh, resolution=30, mode="conservative", attached=True).content_hash(),
        surface.content_hash(), bitvox.faces(grid).content_hash(), bitvox.merge([surface]).content_hash(),
        [level.content_hash() for level in bitvox.lod(solid, levels=(12, 6))], bitvox.check(mesh), bitvox.compare(mesh, surface, samples=200),
        grid.compare(~grid), tree.counts(), tree.leaves().tobytes(),
        tree.surface().content_hash(), closest.find([[1.0, 2, 3]]).tobytes(), grid.cast([[0.0, 0, 0, 1, 1, 1]]).tobytes(),
        grid.sample([[3.0, 3, 3]]).tolist(), bitvox.find_seed(solid)[0], bitvox.dumps(mesh, "obj"), bitvox.dumps(grid, "bvx"),
        bitvox.loads(bitvox.dumps(mesh, "ply"), "ply").content_hash(), bitvox.render(mesh, size=(40, 30)).png(),
        (grid | grid).content_hash(), bitvox.Lattice.fit(mesh, resolution=9),
        bitvox.boolean(mesh, surface, "union", resolution=20).content_hash(), (grid - ~grid ^ grid & grid).content_hash(),
        [g.content_hash() for g in (grid.dilate(2), grid.erode(connectivity=26), grid.open(radius=2.0), grid.close(steps=2), grid.hollow(1.5))],
        [g.content_hash() for g in (grid.downsample(2), grid.crop(), grid.pad(3), grid.permute("zyx", "y"), grid.resample(solid.lattice),
                                  grid.transform([[0.8, -0.6, 0], [0.6, 0.8, 0], [0, 0, 1]]))],
        grid.distance("signed", nearest=True)[1].tobytes(), grid.distance(squares=True).tobytes(), grid.coverage(3).tobytes(), grid.content(),
        volume.threshold(-20, 5).content_hash(), volume.surface(-3, keys=True).content_hash(), volume.labels(), volume.label(10).count,
        volume.surfaces()[10].content_hash(),
        grid.components().tobytes(), grid.label(connectivity=26).tobytes(), grid.keep(largest=1).content_hash(), grid.fill_cavities().content_hash(),
        grid.topology(), [level.content_hash() for level in bitvox.lod(mesh, triangles=(300, 100))],
        bitvox.simplify(mesh, error="1%").content_hash(),
        bitvox.voxelize_points(mesh.vertices, resolution=12, body=True, close_gaps=1).content_hash(), bitvox.inspect(mesh, resolution=16)[:2],
        bitvox.label_voxels(painted, grid)[0].tobytes(),
    ]


def test_everything_calls_every_function():
    """What a stage brings later belongs there too."""
    called = set(re.findall(r"\.(\w+)\(", inspect.getsource(everything)))
    elsewhere = {"read", "read_volume", "read_segments", "read_labels", "write", "write_labels", "write_levels", "register_with_trimesh", "settings", "read_points"}  # files and settings have tests of their own
    assert {name for name in public_names(bitvox) if inspect.isfunction(getattr(bitvox, name))} - called == elsewhere
    of_grids = {name for name, thing in vars(bitvox.Grid).items() if not name.startswith("_") and inspect.isfunction(thing)}
    assert of_grids - called == {"to_pyvista", "to_trimesh", "to_napari", "voxels", "plot", "save"}
    of_volumes = {name for name, thing in vars(bitvox.Volume).items() if not name.startswith("_") and inspect.isfunction(thing)}
    assert of_volumes - called == {"window", "save", "to_world", "turned", "aligned", "to_napari", "to_sitk", "to_nibabel", "to_pyvista"}  # places have tests of their own


def test_every_function_from_four_threads(ball):
    grid = bitvox.Grid.from_numpy(ball_grid(16))
    expected = everything(ball, grid)
    barrier = threading.Barrier(4)

    def work(_):
        barrier.wait()
        return [everything(ball, grid) for _ in range(2)]

    with ThreadPoolExecutor(4) as pool:
        for results in pool.map(work, range(4)):
            assert all(r == expected for r in results)


def test_threads_do_not_show(ball):
    grid = bitvox.Grid.from_numpy(ball_grid(16))
    results = []
    for threads in (1, 2, 8):
        with bitvox.settings(threads=threads):
            results.append(everything(ball, grid))
    assert results[0] == results[1] == results[2]


def test_the_interpreter_runs_on_while_a_call_works():
    grid = ~bitvox.Grid(bitvox.Lattice((600, 600, 600)))
    ticks, done = [], threading.Event()

    def tick():
        while not done.is_set():
            ticks.append(time.monotonic())
            time.sleep(0.001)

    thread = threading.Thread(target=tick)
    thread.start()
    within = 0
    for _ in range(100):  # a busy system may leave the thread no turn during a call
        start = time.monotonic()
        bitvox.dumps(grid, "nrrd", threads=1)
        end = time.monotonic()
        within = max(within, sum(start < t < end for t in ticks))
        if within >= 3:
            break
    done.set()
    thread.join()
    assert within >= 3


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork here")
def test_forked_child_works_alone():
    found = run("""
        import os, signal, bitvox
        mesh = ([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
        from bitvox._run import Run, lib
        expected = bitvox.voxelize(mesh, resolution=200, threads=2).content_hash()
        child = os.fork()
        if child == 0:
            signal.alarm(60)
            ok = bitvox.voxelize(mesh, resolution=200, threads=2).content_hash() == expected
            with Run() as run:
                ok = ok and lib.bvx_context_threads(run.context) == 1
            with Run(threads=8) as run:
                ok = ok and lib.bvx_context_threads(run.context) == 8
            os._exit(0 if ok else 3)
        assert os.waitpid(child, 0)[1] == 0
        with Run(threads=8) as run:
            assert lib.bvx_context_threads(run.context) == 8
        import multiprocessing
        with multiprocessing.get_context("fork").Pool(2) as pool:
            hashes = pool.map(bitvox.Grid.content_hash, [bitvox.voxelize(mesh, resolution=50)] * 4)
        assert len(set(hashes)) == 1
        """)
    assert found.returncode == 0, found.stderr


def resident():
    with open("/proc/self/statm", encoding="ascii") as file:
        return int(file.read().split()[1]) * resource.getpagesize()


@pytest.mark.skipif(not os.path.exists("/proc/self/statm"), reason="no /proc here")
def test_thousands_of_calls_leak_nothing(tetrahedron, tmp_path):
    lattice = bitvox.Lattice((32, 32, 32), 1 / 32)
    data = bitvox.dumps(tetrahedron, "ply")
    seeds = [[31, 31, 31]]

    def calls():  # more than thirty of them
        grid = bitvox.voxelize(tetrahedron, lattice=lattice)
        grid.surface(keys=True).vertices.sum()
        bitvox.loads(data, "ply").check()
        bitvox.refine(tetrahedron, levels=1).leaves()
        bitvox.Closest(tetrahedron).find([[1, 2, 3]])
        bitvox.lod(grid, levels=(8, 4))
        bitvox.render(grid, size=(16, 16)).pixels
        bitvox.voxelize(tetrahedron, lattice=lattice, mode="thin", attached=True)
        grid.fill(seeds)
        measured = bitvox.field(tetrahedron, lattice=lattice)
        measured.distances.sum()
        measured.surface().bounds
        sections = bitvox.slice_mesh(tetrahedron, spacing=0.3)
        bitvox.from_sections(sections, grid=(4, 4)).report
        bitvox.loads(bitvox.dumps(sections, "csl"), "csl")
        bitvox.repair(tetrahedron, resolution=8)
        grid.surface().simplify(count=2)[1].report
        bitvox.lod(tetrahedron, resolution=8, triangles=20).report
        bitvox.merge([grid.surface(keys=True)])
        (grid | ~grid).downsample(3).pad(1)
        grid.close(radius=0.1).hollow(0.1).report
        far = grid.distance("signed")
        volume = bitvox.Volume(far)
        volume.threshold(0.1)
        volume.surface(0.1)
        bitvox.boolean(tetrahedron, tetrahedron, "union", resolution=8).report
        try:
            volume.threshold(np.nan)
        except bitvox.ArgumentError:
            pass
        try:
            bitvox.repair(tetrahedron, resolution=8, interpolation="none")
        except bitvox.ArgumentError:
            pass
        try:
            bitvox.voxelize(tetrahedron, lattice=lattice, progress=lambda s, f: False)
        except bitvox.Cancelled:
            pass
        try:
            bitvox.loads(data[:200], "ply")
        except bitvox.FormatError:
            pass

    for threads, rounds in ((2, 10), (1, 100)):  # one thread is ten times as fast for so small things
        with bitvox.settings(threads=threads):
            for _ in range(10):
                calls()
            before = resident()
            for _ in range(rounds):
                calls()
            assert resident() - before < 1.4 * 2**20  # 14 KiB a round


def test_without_numpy():
    found = run("""
        import sys
        sys.modules["numpy"] = None
        from array import array
        import bitvox
        v = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
        f = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]
        grid = bitvox.voxelize((v, f), resolution=32)
        mesh = grid.surface()
        assert mesh.check().closed and len(mesh.vertices) == mesh.n_vertices
        assert mesh.vertices.shape == (mesh.n_vertices, 3) and isinstance(mesh.vertices[0, 0], float)
        assert mesh.faces[3, 2] < mesh.n_vertices and grid.words.shape[:2] == grid.shape[:0:-1]
        flat = memoryview(array("f", [x for p in v for x in p])).cast("B").cast("f", [4, 3])
        short = memoryview(array("H", [x for p in f for x in p])).cast("B").cast("H", [4, 3])
        assert bitvox.voxelize((flat, short), resolution=32) == grid
        assert (grid | ~grid).count == 32 ** 3 and grid[0, 0, 0] and grid.count == len(grid)
        assert bitvox.loads(bitvox.dumps(mesh, "ply"), "ply").content_hash() == mesh.content_hash()
        assert bitvox.loads(bitvox.dumps(grid, "bvx"), "bvx") == grid
        assert bitvox.lod((v, f), levels=8)[0].n_faces > 0 and bitvox.lod(mesh, error="1%", carry=False)[0].n_faces < mesh.n_faces
        assert mesh.simplify(triangles=20).n_faces <= 20
        assert bitvox.repair((v, f), resolution=16, triangles=20).n_faces <= 20 and mesh.bounds[0] >= (0, 0, 0)
        assert bitvox.render(grid, size=(20, 20)).png()[:4] == b"\\x89PNG"
        assert grid.sample([[0.1, 0.1, 0.1]])[0] == 1.0
        assert bitvox.refine((v, f), levels=2).counts()
        for wrong in (lambda: grid.to_numpy(), lambda: bitvox.Grid.from_numpy([[[1]]])):
            try:
                wrong()
            except ImportError as error:
                assert "numpy" in str(error)
            else:
                raise SystemExit("no error")
        for bad, kind in ((([[0, 0]], f), ValueError), ((v, [[0, 1, -1]]), ValueError), ((v, [[0, 1, 9]]), ValueError),
                          ((v, [[0, 1, 2 ** 70]]), ValueError), (([[0, 0, float("nan")]] + v[1:], f), ValueError),
                          ((v, [[0.5, 1, 2]]), TypeError), ((v, [["a", 1, 2]]), TypeError)):
            try:
                bitvox.check(bad)
            except kind:
                pass
            else:
                raise SystemExit(f"no error for {bad}")
        assert "numpy" not in {name.partition(".")[0] for name, module in sys.modules.items() if module is not None}
        print("done")
        """)
    assert found.stdout == "done\n", found.stderr


def test_import_brings_no_numpy():
    found = run("import sys, bitvox; print('numpy' in sys.modules)")
    assert found.stdout == "False\n", found.stderr


def test_interrupt_of_the_parent_reaches_no_thread(ball):
    assert signal.getsignal(signal.SIGINT) is not None  # this package installs no handler of its own
    before = signal.getsignal(signal.SIGINT)
    bitvox.voxelize(ball, resolution=10)
    assert signal.getsignal(signal.SIGINT) is before


def test_numbers_of_numpy_as_options(ball):
    assert bitvox.voxelize(ball, resolution=np.int32(16)) == bitvox.voxelize(ball, resolution=16)
    assert bitvox.voxelize(ball, spacing=np.float32(0.25)).spacing == (0.25,) * 3
    assert bitvox.lod(ball, levels=np.array([8, 4]))[1].n_faces > 0


def test_what_a_new_user_types(ball, tmp_path):
    """Slips get an answer that says what to do."""
    grid = bitvox.voxelize(ball, resolution=10)
    cases = [
        (lambda: bitvox.Mesh(ball), TypeError, "Mesh.of"), (lambda: bitvox.Mesh("a.stl"), TypeError, "Mesh.of"),
        (lambda: bitvox.Grid(np.zeros((3, 3, 3))), TypeError, "from_numpy"),
        (lambda: ball.save(tmp_path / "a.dae"), bitvox.UnsupportedError, "take one of stl"),
        (lambda: grid.save(tmp_path / "a.stl"), bitvox.UnsupportedError, r"take one of npy.*, or grid.surface\(\).save\(...\)"),
        (lambda: bitvox.render(ball, cut="x=0.5"), TypeError, "cut must be like"),
        (lambda: bitvox.voxelize(ball, mode="field"), ValueError, "bitvox.field"),
        (lambda: bitvox.voxelize((ball.vertices * np.nan, ball.faces)), ValueError, "^vertex 0"),  # no C function's name before it
    ]
    for call, kind, words in cases:
        with pytest.raises(kind, match=words):
            call()
    assert run("import bitvox; bitvox.big.plan; bitvox.formats.read_amf; bitvox.reports.Certificate").returncode == 0
    with pytest.raises(AttributeError):
        bitvox.smoke  # noqa: B018


@pytest.mark.parametrize("name, least", [("close", 14), ("label", 17)])
def test_long_steps_are_reported_on_the_way(name, least):
    """A large ball has few pieces of slices, and numbers of voxels one step: both were a few reports, or reports of one fraction."""
    box = bitvox.Grid.from_numpy(np.ones((250, 250, 250) if name == "close" else (340, 340, 340), np.uint8))
    reached = set()
    run = {"close": lambda p: box.close(radius=30, progress=p, threads=1), "label": lambda p: box.label(progress=p, threads=1)}[name]
    run(lambda stage, fraction: reached.add(fraction))
    assert len(reached) >= least


def test_warnings_are_results():
    far = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=float)
    faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]
    thin = (np.concatenate([far, far * [1, 1, 0.001] + [0, 0, 2]]), np.concatenate([faces, np.add(faces, 4)]))
    with pytest.warns(bitvox.ResultWarning) as told:
        report = bitvox.repair(thin, resolution=16, thin="shell").report
    assert report.warnings == sum(1 << number for number in {_number(w.message.code) for w in told})
    assert all(w.message.code in str(w.message) and w.filename == __file__ for w in told)


def _number(code):
    from bitvox import _native
    return getattr(_native.lib, code)
