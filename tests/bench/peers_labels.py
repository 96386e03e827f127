"""peers_labels.py OUT PROGRAM - surfaces of 100 Voronoi labels by bitvox labels and by other libraries; prints Markdown.

Every face lies between two seeds, so its true plane is known. One thread; processor time, the least of three runs; ours is the share of the
stages "surfaces" and "body" in the program's. Memory is what is held at most beside the samples, the result with it, for each side of a voxel
where labels differ: ours of the report, theirs by which the process grows. What the surfaces are is judged on 256^3: distances of the vertices of
inner faces from the true cells, angles of the faces' normals, and each label as a body by trimesh and manifold3d. Fewer triangles: a tenth, ours of all
labels together, by meshoptimizer of each body of ours alone.
"""
import ctypes
import json
import os
import subprocess
import sys
import time

import numpy as np

LABELS = 100
BORDER = 1.5  # voxels: faces nearer to the volume's sides are between a label and nothing
out, program = sys.argv[1], sys.argv[2]
seeds = np.random.default_rng(1).uniform(0, 1, (LABELS, 3))


def voronoi(side):
    """Labels 1 to 100 of samples at voxels' centers, made once."""
    name = f"{out}/voronoi_{side}.npy"
    if not os.path.isfile(name):
        at = (np.arange(side) + 0.5) / side
        plane = ((at[:, None, None] - seeds[:, 0]) ** 2 + (at[None, :, None] - seeds[:, 1]) ** 2).astype(np.float32)
        whole = np.empty((side, side, side), np.uint8, order="F")
        for z in range(side):
            whole[:, :, z] = 1 + np.argmin(plane + ((at[z] - seeds[:, 2]) ** 2).astype(np.float32), axis=2)
        np.save(name, whole)
    return name


def voxel_faces(side):
    """Sides of voxels with different labels, those of the volume's box included."""
    samples = np.load(voronoi(side))
    return 6 * side**2 + sum(int(np.count_nonzero(np.take(samples, range(1, side), a) != np.take(samples, range(side - 1), a))) for a in range(3))


def growth(job):
    """Bytes by which a process of its own grows by the job at most."""
    def status(name):
        return next(int(line.split()[1]) << 10 for line in open("/proc/self/status") if line.startswith(name))

    ctypes.CDLL(None).malloc_trim(0)  # what is free already would not show
    ends = os.pipe()
    child = os.fork()
    if child == 0:
        before = status("VmRSS")
        made = job()  # held until it is measured
        os.write(ends[1], str(status("VmHWM") - before).encode())
        os._exit(made is None)
    os.waitpid(child, 0)
    return int(os.read(ends[0], 32))


def least(job, runs=3):
    times, grown = [], growth(job)
    for _ in range(runs):
        start = time.process_time()
        made = job()
        times.append(time.process_time() - start)
    return min(times), grown, made


def bitvox(side, options):
    """Seconds, bytes, and the body of each label."""
    times = []
    for _ in range(3):
        words = [program, "labels", voronoi(side), "-o", f"{out}/voronoi_%s.ply", "--threads", "1", "--json", *options]
        before = sum(os.times()[2:4])
        report = json.loads(subprocess.run(words, capture_output=True, check=True).stdout)
        own = sum(one["seconds"] for one in report["stages"] if one["name"] in ("surfaces", "body"))
        times.append((sum(os.times()[2:4]) - before) * own / sum(one["seconds"] for one in report["stages"]))
    return min(times), report["peak_bytes"] - side**3, lambda: {n: read_ply(f"{out}/voronoi_{n}.ply") for n in range(1, LABELS + 1)}


def read_ply(name):
    """Vertices and faces of a binary file of ours."""
    data = open(name, "rb").read()
    head, _, body = data.partition(b"end_header\n")
    vertices, faces = (int(head.split(b"element " + what)[1].split()[0]) for what in (b"vertex", b"face"))
    at = np.frombuffer(body, "<f4", 3 * vertices).reshape(-1, 3)
    return at, np.frombuffer(body, np.dtype([("n", "u1"), ("v", "<u4", 3)]), faces, 12 * vertices)["v"]


def vtk_nets(side, smooth):
    import vtk
    from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy

    vtk.vtkSMPTools.SetBackend("Sequential")
    image = vtk.vtkImageData()
    image.SetDimensions(side + 2, side + 2, side + 2)  # background around it closes the bodies there
    image.SetOrigin(-0.5, -0.5, -0.5)
    samples = np.pad(np.load(voronoi(side)), 1).ravel(order="F")
    image.GetPointData().SetScalars(numpy_to_vtk(samples, deep=False))
    nets = vtk.vtkSurfaceNets3D()
    nets.SetInputData(image)
    nets.GenerateLabels(LABELS, 1, LABELS)
    nets.SetSmoothing(smooth)
    nets.SetOutputMeshTypeToTriangles()

    def job():
        nets.Modified()
        nets.Update()
        return nets.GetOutput()

    seconds, grown, made = least(job)

    def bodies():
        at = vtk_to_numpy(made.GetPoints().GetData())
        faces = vtk_to_numpy(made.GetPolys().GetConnectivityArray()).reshape(-1, 3)
        sides = vtk_to_numpy(made.GetCellData().GetArray("BoundaryLabels"))
        return {n: (at, np.concatenate([faces[sides[:, 0] == n], faces[sides[:, 1] == n][:, ::-1]])) for n in range(1, LABELS + 1)}

    return seconds, grown, bodies


def zmesh(side):
    import zmesh as peer

    samples = np.pad(np.load(voronoi(side)), 1)

    def job():
        mesher = peer.Mesher((1, 1, 1))
        mesher.mesh(samples)
        return {n: mesher.get(n, normals=False, reduction_factor=0) for n in mesher.ids()}

    seconds, grown, made = least(job, 1)
    return seconds, grown, lambda: {n: (one.vertices - 0.5, one.faces) for n, one in made.items()}


def fewer(side):
    """A tenth of the triangles, faces shared."""
    bodies = bitvox(side, [])[2]()
    return bitvox(side, ["--triangles", str(sum(len(faces) for _, faces in bodies.values()) // 20)])


def each_fewer(side):
    """A tenth of each body's triangles."""
    import meshoptimizer

    seconds, _, bodies = bitvox(side, [])
    whole = bodies()

    def job():
        made = {}
        for n, (at, faces) in whole.items():
            out_indices = np.zeros(faces.size, np.uint32)
            count = meshoptimizer.simplify(out_indices, np.ascontiguousarray(faces.ravel()), np.ascontiguousarray(at, np.float32), target_index_count=faces.size // 30 * 3,
                                           target_error=1.0)
            made[n] = at, out_indices[:count].reshape(-1, 3)
        return made

    spent, grown, made = least(job, 1)
    return seconds + spent, grown, lambda: made


def judge(side, bodies):
    """Mean and largest distance from the planes, mean angle of normals, bodies that trimesh calls watertight and manifold3d takes."""
    import manifold3d
    import trimesh

    at, distances, angles, tight, taken = seeds * side, [], [], 0, 0
    for n, (vertices, faces) in bodies.items():
        corners = vertices[faces].astype(np.float64)
        inner = ((corners > BORDER) & (corners < side - BORDER)).all(axis=(1, 2))
        # How far beyond each plane: a cell is convex, so the largest is the distance from its surface.
        ways = np.delete(at, n - 1, axis=0) - at[n - 1]
        ways /= np.linalg.norm(ways, axis=1)[:, None]
        ends = ((np.delete(at, n - 1, axis=0) + at[n - 1]) / 2 * ways).sum(axis=1)
        distances.append(np.abs((vertices[np.unique(faces[inner])].astype(np.float64) @ ways.T - ends).max(axis=1)))
        way = ways[(corners[inner].mean(axis=1) @ ways.T - ends).argmax(axis=1)]
        normal = np.cross(corners[inner][:, 1] - corners[inner][:, 0], corners[inner][:, 2] - corners[inner][:, 0])
        area = np.linalg.norm(normal, axis=1)
        angles.append(np.degrees(np.arccos(np.clip(np.abs((normal * way).sum(axis=1))[area > 0] / area[area > 0], 0, 1))))
        used, numbers = np.unique(faces, return_inverse=True)
        body = trimesh.Trimesh(vertices[used], numbers.reshape(-1, 3), process=False)
        tight += body.is_watertight
        mesh = manifold3d.Mesh(np.asarray(vertices[used], np.float32), np.ascontiguousarray(body.faces, np.uint32))
        taken += manifold3d.Manifold(mesh).status() == manifold3d.Error.NoError
    distances, angles = np.concatenate(distances), np.concatenate(angles)
    return f"{distances.mean():.4f} | {distances.max():.2f} | {angles.mean():.2f} | {tight} | {taken}"


JOBS = (("bitvox labels", lambda side: bitvox(side, [])), ("bitvox labels --staircase", lambda side: bitvox(side, ["--staircase"])),
        ("vtkSurfaceNets3D", lambda side: vtk_nets(side, True)), ("vtkSurfaceNets3D, not smoothed", lambda side: vtk_nets(side, False)),
        ("zmesh", zmesh), ("bitvox labels --triangles, a tenth", fewer), ("meshoptimizer, each body of bitvox labels alone, a tenth", each_fewer))

print("| 100 Voronoi labels | side | s | bytes a face | mean distance [voxels] | largest | normals [degrees] | watertight of 100 | taken by manifold3d |")
print("|---|--:|--:|--:|--:|--:|--:|--:|--:|")
for edge in [int(n) for n in os.environ.get("BENCH_LABELS", "256,512").split(",")]:
    sides = voxel_faces(edge)
    for title, job_of in JOBS:
        if edge > 256 and "tenth" in title:
            continue
        try:
            spent, held, made_bodies = job_of(edge)
            found = judge(edge, made_bodies()) if edge <= 256 else " | | | |"
        except ImportError as why:
            print(f"| {title} | {edge} | missing: {why} | | | | | | |")
            continue
        print(f"| {title} | {edge} | {spent:.2f} | {held / sides:.0f} | {found} |", flush=True)
