"""peers_labels.py OUT PROGRAM - surfaces of 100 Voronoi labels by bitvox labels and by other libraries; prints Markdown.

Every face lies between two seeds, so its true plane is known. One thread; ours are the stages "surfaces" and "body" of the program's report,
theirs processor time, the least of three runs. What the surfaces are is judged on 256^3: distances of the corners of inner faces from the
true cells, angles of the faces' normals, and each label as a body by trimesh and manifold3d.
"""
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


def least(job, runs=3):
    times = []
    for _ in range(runs):
        start = time.process_time()
        made = job()
        times.append(time.process_time() - start)
    return min(times), made


def bitvox(side, options):
    """Seconds, and the body of each label."""
    times = []
    for _ in range(3):
        words = [program, "labels", voronoi(side), "-o", f"{out}/voronoi_%s.ply", "--threads", "1", "--json", *options]
        report = json.loads(subprocess.run(words, capture_output=True, check=True).stdout)
        times.append(sum(one["seconds"] for one in report["stages"] if one["name"] in ("surfaces", "body")))
    return min(times), lambda: {n: read_ply(f"{out}/voronoi_{n}.ply") for n in range(1, LABELS + 1)}


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

    seconds, made = least(job)

    def bodies():
        at = vtk_to_numpy(made.GetPoints().GetData())
        faces = vtk_to_numpy(made.GetPolys().GetConnectivityArray()).reshape(-1, 3)
        sides = vtk_to_numpy(made.GetCellData().GetArray("BoundaryLabels"))
        return {n: (at, np.concatenate([faces[sides[:, 0] == n], faces[sides[:, 1] == n][:, ::-1]])) for n in range(1, LABELS + 1)}

    return seconds, bodies


def zmesh(side):
    import zmesh as peer

    samples = np.pad(np.load(voronoi(side)), 1)

    def job():
        mesher = peer.Mesher((1, 1, 1))
        mesher.mesh(samples)
        return {n: mesher.get(n, normals=False, reduction_factor=0) for n in mesher.ids()}

    seconds, made = least(job, 1)
    return seconds, lambda: {n: (one.vertices - 0.5, one.faces) for n, one in made.items()}


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
        distances.append(np.abs((corners[inner].reshape(-1, 3) @ ways.T - ends).max(axis=1)))
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
        ("zmesh", zmesh))

print("| 100 Voronoi labels | side | s | mean distance [voxels] | largest | normals [degrees] | watertight of 100 | taken by manifold3d |")
print("|---|--:|--:|--:|--:|--:|--:|--:|")
for edge in [int(n) for n in os.environ.get("BENCH_LABELS", "256,512").split(",")]:
    for title, job_of in JOBS:
        try:
            spent, made_bodies = job_of(edge)
            found = judge(edge, made_bodies()) if edge <= 256 else " | | | |"
        except ImportError as why:
            print(f"| {title} | {edge} | missing: {why} | | | | | |")
            continue
        print(f"| {title} | {edge} | {spent:.2f} | {found} |", flush=True)
