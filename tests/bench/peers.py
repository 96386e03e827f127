"""peers.py - what a user would pick instead: the same jobs by other libraries.

    peers.py FOLDER BENCH_TURNS

FOLDER holds what bench_core and bench_quality wrote: mesh.positions, mesh.triangles, solid.bits, solid.json, core.json,
ours.jsonl, ours/. Writes FOLDER/peers.json and the simplified meshes as FOLDER/peers/NAME_TARGET.ply. A library that cannot
be imported is named as missing; the rest still runs.

Fair play: arrays are in memory in the form that each library wants before the clock starts; every job runs once
without being counted, so that memory is warm (run.sh also keeps the heap from giving it back); ours and theirs take
turns (the program BENCH_TURNS does one run of ours on demand), so that a slow minute of the machine meets both; the
least of the runs is compared, the median stands beside it. What a library prepares from the mesh (a search tree) is
counted, as ours counts snapping.
"""
import importlib.metadata
import json
import os
import statistics
import subprocess
import sys
import time

import numpy as np

folder = sys.argv[1]
turns = subprocess.Popen([sys.argv[2], folder], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
runs = int(os.environ.get("BENCH_PEER_RUNS", "5"))
results = {"times": {}, "missing": {}, "levels": {}, "checks": {}}


def path(*parts):
    return os.path.join(folder, *parts)


def load_json(name):
    with open(path(name)) as file:
        return json.load(file)


positions = np.fromfile(path("mesh.positions"), dtype=np.float32).reshape(-1, 3)
triangles = np.fromfile(path("mesh.triangles"), dtype=np.uint32).reshape(-1, 3)
solid = load_json("solid.json")
core = load_json("core.json")
dims, spacing, origin = solid["dims"], solid["spacing"], np.array(solid["origin"])
words = np.fromfile(path("solid.bits"), dtype="<u8").reshape(dims[2], dims[1], solid["words_per_row"])
# one byte a voxel, axes z, y, x
voxels = np.unpackbits(words.view(np.uint8), axis=2, bitorder="little")[:, :, : dims[0]].copy()


def ours(job, threads):
    """Milliseconds of one run of ours."""
    turns.stdin.write(f"{job} {threads}\n")
    turns.stdin.flush()
    return float(turns.stdout.readline())


def statistics_of(times):
    return {"min": min(times), "median": statistics.median(times)}


def clock(threads):
    """Seconds. One thread: processor time, so that others on the machine count little; more: the time of day."""
    return time.process_time() if threads == 1 else time.perf_counter()


def measure(name, job, beside, count=None):
    """Run job once to warm up, then count times in turns with ours (beside: job and threads); keep the times.

    Returns the last result.
    """
    threads = beside[1]
    job()
    times, our_times = [], []
    for _ in range(count or runs):
        our_times += [ours(*beside) for _ in range(3)]
        start = clock(threads)
        result = job()
        times.append((clock(threads) - start) * 1e3)
    our_times += [ours(*beside) for _ in range(3)]
    results["times"][name] = {"peer": statistics_of(times), "ours": statistics_of(our_times), "job": list(beside)}
    print(
        f"  {name:<52} {min(times):9.2f} {statistics.median(times):9.2f}   ours {min(our_times):8.2f}"
        f" {statistics.median(our_times):8.2f}   1 : {min(times) / min(our_times):.1f}",
        flush=True,
    )
    return result


def section(title, needs):
    """Decorator: run a section now, or say what it misses."""

    def run(function):
        print(title, flush=True)
        try:
            modules = [__import__(n, fromlist=["*"]) for n in needs]
        except Exception as reason:  # a wheel may be there and a system library not
            results["missing"][title] = f"{' '.join(needs)}: {reason}"
            print(f"  missing: {reason}")
            return
        try:
            function(*modules)
        except Exception as reason:
            results["missing"][title] = f"failed: {reason!r}"
            print(f"  failed: {reason!r}")

    return run


def write_ply(name, points, faces):
    """Binary PLY of floats."""
    head = (
        "ply\nformat binary_little_endian 1.0\n"
        f"element vertex {len(points)}\nproperty float x\nproperty float y\nproperty float z\n"
        f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    records = np.zeros(len(faces), dtype=[("count", "u1"), ("corner", "<i4", 3)])
    records["count"] = 3
    records["corner"] = faces
    with open(name, "wb") as file:
        file.write(head.encode())
        file.write(np.ascontiguousarray(points, dtype="<f4").tobytes())
        file.write(records.tobytes())


def same_voxels(name, mask):
    """How many voxels of a peer's solid differ from ours."""
    results["checks"][name] = {"voxels": int(mask.sum()), "differ": int((mask != voxels).sum())}
    print(f"  {'':<58} {results['checks'][name]}")


# ---- VTK's view of the data ----


def vtk_mesh(vtk, numpy_support):
    mesh = vtk.vtkPolyData()
    points = vtk.vtkPoints()
    points.SetData(numpy_support.numpy_to_vtk(positions, deep=1))
    mesh.SetPoints(points)
    cells = vtk.vtkCellArray()
    offsets = np.arange(0, 3 * len(triangles) + 1, 3, dtype=np.int64)
    cells.SetData(
        numpy_support.numpy_to_vtkIdTypeArray(offsets, deep=1),
        numpy_support.numpy_to_vtkIdTypeArray(triangles.ravel().astype(np.int64), deep=1),
    )
    mesh.SetPolys(cells)
    return mesh


def vtk_arrays(mesh, numpy_support):
    points = numpy_support.vtk_to_numpy(mesh.GetPoints().GetData())
    faces = numpy_support.vtk_to_numpy(mesh.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    return points, faces


def vtk_image(vtk, numpy_support, values, padding):
    """An image whose points are the voxels' centres, with layers of zeros around."""
    padded = np.pad(values, padding)
    image = vtk.vtkImageData()
    image.SetDimensions(*padded.shape[::-1])
    image.SetSpacing(spacing, spacing, spacing)
    image.SetOrigin(*(origin + spacing * (0.5 - padding)))
    image.GetPointData().SetScalars(numpy_support.numpy_to_vtk(padded.ravel(), deep=1))
    return image


def with_threads(vtk, count):
    """VTK's wheel is sequential until told otherwise."""
    vtk.vtkSMPTools.SetBackend("STDThread" if count > 1 else "Sequential")
    vtk.vtkSMPTools.Initialize(count)


# ---- solid ----


@section("solid 512 by VTK's stencil", ["vtk", "vtk.util.numpy_support"])
def solid_vtk(vtk, numpy_support):
    mesh = vtk_mesh(vtk, numpy_support)

    def job():
        stencil = vtk.vtkPolyDataToImageStencil()
        stencil.SetInputData(mesh)
        stencil.SetOutputSpacing(spacing, spacing, spacing)
        stencil.SetOutputOrigin(*(origin + 0.5 * spacing))
        stencil.SetOutputWholeExtent(0, dims[0] - 1, 0, dims[1] - 1, 0, dims[2] - 1)
        image = vtk.vtkImageStencilToImage()
        image.SetInputConnection(stencil.GetOutputPort())
        image.SetInsideValue(1)
        image.SetOutsideValue(0)
        image.SetOutputScalarTypeToUnsignedChar()
        image.Update()
        return image.GetOutput()

    for threads in (1, 2):
        with_threads(vtk, threads)
        result = measure(f"VTK polydata to stencil to image, {threads}", job, ("solid", threads), 2)
    mask = numpy_support.vtk_to_numpy(result.GetPointData().GetScalars()).reshape(voxels.shape)
    same_voxels("VTK stencil", mask)


@section("solid 512 by PyVista's mask", ["vtk", "pyvista"])
def solid_pyvista(vtk, pyvista):
    with_threads(vtk, 1)
    faces = np.hstack([np.full((len(triangles), 1), 3), triangles]).astype(np.int64)
    mesh = pyvista.PolyData(positions, faces.ravel())
    frame = pyvista.ImageData(dimensions=dims, spacing=(spacing,) * 3, origin=origin + 0.5 * spacing)
    result = measure(
        "PyVista voxelize_binary_mask, 1", lambda: mesh.voxelize_binary_mask(reference_volume=frame), ("solid", 1)
    )
    same_voxels("PyVista mask", np.asarray(result["mask"]).reshape(voxels.shape))


@section("solid 512 by Open3D's rays", ["open3d"])
def solid_open3d(open3d):
    tensor = open3d.core.Tensor
    points, corners = tensor(positions), tensor(triangles)

    def scene_of(threads):
        scene = open3d.t.geometry.RaycastingScene(threads)
        scene.add_triangles(points, corners)
        return scene

    # one ray a row of voxels, from before the lattice along x
    y = origin[1] + spacing * (np.arange(dims[1]) + 0.5)
    z = origin[2] + spacing * (np.arange(dims[2]) + 0.5)
    rays = np.zeros((dims[2], dims[1], 6), dtype=np.float32)
    before = origin[0] - spacing
    rays[:, :, 0] = before
    rays[:, :, 1] = y[None, :]
    rays[:, :, 2] = z[:, None]
    rays[:, :, 3] = 1
    rays = tensor(rays.reshape(-1, 6))

    def solid_of(scene, threads):
        hits = scene.list_intersections(rays, threads)
        along = np.ceil((hits["t_hit"].numpy() + before - origin[0]) / spacing - 0.5).astype(np.int64)
        row = hits["ray_ids"].numpy().astype(np.int64)
        toggles = np.zeros(voxels.size, dtype=np.uint8)
        inside = along < dims[0]
        np.bitwise_xor.at(toggles, row[inside] * dims[0] + np.maximum(along[inside], 0), 1)
        return np.bitwise_xor.accumulate(toggles.reshape(-1, dims[0]), axis=1).reshape(voxels.shape)

    for threads in (1, 2):
        scene = scene_of(threads)
        scene.list_intersections(rays, threads)  # builds the tree
        beside = ("solid", threads)
        measure(f"Open3D rays alone, tree ready, {threads}", lambda: scene.list_intersections(rays, threads), beside)
        result = measure(f"Open3D tree, rays, fill, {threads}", lambda: solid_of(scene_of(threads), threads), beside)
    same_voxels("Open3D rays", result)

    # what its manual offers for this: the occupancy of points, here of every 16th layer
    layers = np.arange(0, dims[2], 16)
    x = origin[0] + spacing * (np.arange(dims[0]) + 0.5)
    centres = np.stack(np.meshgrid(z[layers], y, x, indexing="ij")[::-1], axis=-1).astype(np.float32)
    centres = tensor(np.ascontiguousarray(centres))
    start = clock(2)
    scene.compute_occupancy(centres, 2)
    guess = (clock(2) - start) * 1e3 * dims[2] / len(layers)
    results["checks"]["Open3D occupancy of all centres, 2 threads, from every 16th layer"] = {"ms": guess}
    print(f"  Open3D occupancy of all centres, 2 threads, from every 16th layer: {guess:.0f} ms")


# ---- surface of our bits ----


@section("surface by vtkFlyingEdges3D", ["vtk", "vtk.util.numpy_support"])
def surface_vtk(vtk, numpy_support):
    image = vtk_image(vtk, numpy_support, voxels, 1)

    def job(extras):
        edges = vtk.vtkFlyingEdges3D()
        edges.SetInputData(image)
        edges.SetValue(0, 0.5)
        edges.SetComputeNormals(extras)
        edges.SetComputeScalars(extras)
        edges.ComputeGradientsOff()
        edges.Update()
        return edges.GetOutput()

    for threads in (1, 2):
        with_threads(vtk, threads)
        result = measure(f"vtkFlyingEdges3D, {threads}", lambda: job(False), ("surface", threads), 7)
        measure(f"vtkFlyingEdges3D with its normals and scalars, {threads}", lambda: job(True), ("surface", threads), 3)
    results["checks"]["vtkFlyingEdges3D"] = {"triangles": int(result.GetNumberOfPolys())}


@section("surface by scikit-image", ["skimage.measure"])
def surface_skimage(measure_module):
    values = np.pad(voxels, 1).astype(np.float32)
    result = measure(
        "skimage.measure.marching_cubes, 1", lambda: measure_module.marching_cubes(values, 0.5), ("surface", 1), 3
    )
    results["checks"]["skimage.measure.marching_cubes"] = {"triangles": len(result[1])}


# ---- levels ----

quality_targets = {}
with open(path("ours.jsonl")) as lines:
    for line in lines:
        row = json.loads(line)
        if row.get("shown"):
            quality_targets.setdefault(row["target"], row["triangles"])
job_targets = core["levels"]


def keep_level(name, target, points, faces):
    os.makedirs(path("peers"), exist_ok=True)
    file = path("peers", f"{name.replace(' ', '_')}_{target}.ply")
    write_ply(file, points, faces)


def levels(name, simplify, threads=1, judged=True):
    """simplify(triangles) -> points, faces: the main job's levels beside ours, then the levels to be judged."""
    simplify(job_targets[0])
    one, four, whole, finest = [], [], [], []
    for _ in range(max(2, runs - 2)):
        whole += [ours("job", threads) for _ in range(3)]
        finest += [ours("level", threads) for _ in range(3)]
        times = []
        for target in job_targets:
            start = clock(threads)
            faces = simplify(target)[1]
            times.append((clock(threads) - start) * 1e3)
            if target == job_targets[0]:
                count = len(faces)
        one.append(times[0])
        four.append(sum(times))
    results["levels"][name] = {
        "threads": threads,
        "triangles": count,
        "one": statistics_of(one),
        "four": statistics_of(four),
        "ours_job": statistics_of(whole),
        "ours_level": statistics_of(finest),
    }
    print(
        f"  {name:<44} one {min(one):8.1f}, four {min(four):8.1f} ms   ours one {min(finest):6.2f}, four {min(whole):6.2f}",
        flush=True,
    )
    for target, count in quality_targets.items() if judged else ():
        keep_level(name, target, *simplify(count))


def divisions_for(count_of, target):
    """The largest number of divisions along the longest axis that keeps the target."""
    low, high = 2, 512
    while high - low > 1:
        middle = (low + high) // 2
        if count_of(middle) <= target:
            low = middle
        else:
            high = middle
    return low


def by_divisions(vtk, numpy_support, name, make, threads=1):
    mesh = vtk_mesh(vtk, numpy_support)
    extent = positions.max(axis=0) - positions.min(axis=0)
    chosen = {}

    def run(n):
        filter = make(mesh, [max(1, int(round(n * e))) for e in extent / extent.max()])
        filter.Update()
        return filter.GetOutput()

    def simplify(target):
        if target not in chosen:
            chosen[target] = divisions_for(lambda n: run(n).GetNumberOfPolys(), target)
        return vtk_arrays(run(chosen[target]), numpy_support)

    for target in job_targets:
        simplify(target)
    levels(name, simplify, threads, threads == 1)


@section("levels by vtkBinnedDecimation", ["vtk", "vtk.util.numpy_support"])
def levels_binned(vtk, numpy_support):
    def make(mesh, n):
        filter = vtk.vtkBinnedDecimation()
        filter.SetInputData(mesh)
        filter.SetNumberOfDivisions(n)
        filter.AutoAdjustNumberOfDivisionsOff()
        filter.SetPointGenerationModeToBinAverages()
        filter.ProducePointDataOff()
        filter.ProduceCellDataOff()
        return filter

    for threads in (1, 2):
        with_threads(vtk, threads)
        by_divisions(vtk, numpy_support, f"vtkBinnedDecimation{', two threads' * (threads - 1)}", make, threads)


@section("levels by vtkQuadricClustering", ["vtk", "vtk.util.numpy_support"])
def levels_clustering(vtk, numpy_support):
    def make(mesh, n):
        filter = vtk.vtkQuadricClustering()
        filter.SetInputData(mesh)
        filter.AutoAdjustNumberOfDivisionsOff()
        filter.SetNumberOfDivisions(n)
        return filter

    with_threads(vtk, 1)
    by_divisions(vtk, numpy_support, "vtkQuadricClustering", make)


@section("levels by vtkQuadricDecimation", ["vtk", "vtk.util.numpy_support"])
def levels_quadric(vtk, numpy_support):
    with_threads(vtk, 1)
    mesh = vtk_mesh(vtk, numpy_support)

    def simplify(target):
        filter = vtk.vtkQuadricDecimation()
        filter.SetInputData(mesh)
        filter.SetTargetReduction(1.0 - target / len(triangles))
        filter.Update()
        return vtk_arrays(filter.GetOutput(), numpy_support)

    # tens of seconds a run: only the levels to be judged, timed once
    for target, count in quality_targets.items():
        start = clock(1)
        points, faces = simplify(count)
        ms = (clock(1) - start) * 1e3
        results["checks"][f"vtkQuadricDecimation to {count}"] = {"ms": ms}
        print(f"  vtkQuadricDecimation to {count}: {ms:.0f} ms, once", flush=True)
        keep_level("vtkQuadricDecimation", target, points, faces)


@section("levels by meshoptimizer", ["meshoptimizer"])
def levels_meshoptimizer(meshoptimizer):
    indices = np.ascontiguousarray(triangles.ravel())
    room = np.zeros_like(indices)

    def by(function):
        def simplify(target):
            used = function(room, indices, positions, target_index_count=3 * target, target_error=1e9)
            return positions, room[:used].reshape(-1, 3).copy()

        return simplify

    levels("meshoptimizer simplify_sloppy", by(meshoptimizer.simplify_sloppy))
    levels("meshoptimizer simplify", by(meshoptimizer.simplify))


@section("levels by fast-simplification", ["fast_simplification"])
def levels_fast(fast_simplification):
    faces = triangles.astype(np.int32)

    def simplify(target):
        return fast_simplification.simplify(positions, faces, target_count=target)

    levels("fast-simplification", simplify)


# ---- a second judge ----


@section("distances by Open3D, to check the judge", ["open3d"])
def second_judge(open3d):
    tensor = open3d.core.Tensor
    random = np.random.default_rng(7)
    diagonal = np.linalg.norm(positions.max(axis=0) - positions.min(axis=0))

    def sample(points, faces, count=200000):
        p = points.astype(np.float64)
        a, b, c = (p[faces[:, i]] for i in range(3))
        area = np.linalg.norm(np.cross(b - a, c - a), axis=1)
        t = random.choice(len(faces), size=count, p=area / area.sum())
        u, v = np.sqrt(random.random(count)), random.random(count)
        return ((1 - u)[:, None] * a[t] + (u * (1 - v))[:, None] * b[t] + (u * v)[:, None] * c[t]).astype(np.float32)

    def scene_of(points, faces):
        scene = open3d.t.geometry.RaycastingScene()
        scene.add_triangles(tensor(points.astype(np.float32)), tensor(faces.astype(np.uint32)))
        return scene

    def mean_distance(scene, samples):
        return float(scene.compute_distance(tensor(samples)).numpy().mean())

    original = scene_of(positions, triangles)
    from_original = sample(positions, triangles)
    second = results["second_judge"] = {}
    for directory in ("ours", "peers"):
        if not os.path.isdir(path(directory)):
            continue
        for name in sorted(os.listdir(path(directory))):
            if not name.endswith(".ply"):
                continue
            mesh = open3d.t.io.read_triangle_mesh(path(directory, name))
            points, faces = mesh.vertex.positions.numpy(), mesh.triangle.indices.numpy()
            to = mean_distance(original, sample(points, faces))
            back = mean_distance(scene_of(points, faces), from_original)
            second[name] = 50.0 * (to + back) / float(diagonal)
            print(f"  {name:<58} two-way {second[name]:.4f} %")


results["versions"] = {}
for package in ("vtk", "pyvista", "scikit-image", "open3d", "meshoptimizer", "fast-simplification"):
    try:
        results["versions"][package] = importlib.metadata.version(package)
    except importlib.metadata.PackageNotFoundError:
        pass
turns.stdin.close()
turns.wait()
with open(path("peers.json"), "w") as file:
    json.dump(results, file, indent=1)
