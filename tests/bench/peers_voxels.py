"""peers_voxels.py OUT BENCH_VOXELS MESHES - voxels of a surface by other libraries; writes OUT/peers_voxels.md.

The dragon of 871,414 triangles. Arrays are in memory in the form that each library wants before the clock starts; every job
runs once without being counted; ours and theirs take turns (the program BENCH_VOXELS does one run of ours on demand).
Processor time of one process, least and median of the runs. Each library lays its own lattice of the same spacing; Open3D is also
given the bounds of ours, so that counts can be compared."""
import importlib.metadata
import os
import statistics
import subprocess
import sys
import time

import numpy as np

out, program, meshes = sys.argv[1:4]
runs = int(os.environ.get("BENCH_PEER_RUNS", "5"))
turns = subprocess.Popen([program, "turns", meshes, out], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
if turns.stdout.readline().strip() != "ready":
    sys.exit("peers_voxels: no answer from " + program)
points = np.fromfile(os.path.join(out, "voxels.points"), dtype=np.float64).reshape(-1, 3)
triangles = np.fromfile(os.path.join(out, "voxels.triangles"), dtype=np.uint32).reshape(-1, 3)
rows, missing, versions = [], [], []


def ours(resolution):
    """One run of ours: milliseconds, voxels, spacing, origin, dims."""
    turns.stdin.write(f"{resolution}\n")
    turns.stdin.flush()
    word = turns.stdout.readline().split()
    return float(word[0]), int(word[1]), float(word[2]), np.array(word[3:6], dtype=float), np.array(word[6:9], dtype=int)


def measure(name, resolution, job, count, times=runs):
    """job(): a result of which count() takes the voxels."""
    found = count(job())
    theirs, our_times = [], []
    for _ in range(times):
        our_times += [ours(resolution)[0] for _ in range(3)]
        start = time.process_time()
        job()
        theirs.append((time.process_time() - start) * 1e3)
    ratio = min(theirs) / min(our_times)
    rows.append(
        f"| {resolution} | {min(our_times):.1f} ({statistics.median(our_times):.1f}) | {ours(resolution)[1]:,} | {name}"
        f" | {min(theirs):.0f} ({statistics.median(theirs):.0f}) | {found:,} | {ratio:.0f} |"
    )
    print(rows[-1], flush=True)


def peer(package):
    """Decorator: run now, or say what is missing."""

    def run(function):
        try:
            module = __import__(package)
        except Exception as reason:  # a wheel may be there and a system library not
            missing.append(f"{package}: {reason}")
            return
        versions.append(f"{package} {importlib.metadata.version(package)}")
        try:
            function(module)
        except Exception as reason:
            missing.append(f"{package} failed: {reason!r}")

    return run


@peer("open3d")
def open3d_grid(open3d):
    mesh = open3d.geometry.TriangleMesh(
        open3d.utility.Vector3dVector(points), open3d.utility.Vector3iVector(triangles.astype(np.int32))
    )
    grid = open3d.geometry.VoxelGrid
    for resolution in (256, 512):
        _, _, spacing, origin, dims = ours(resolution)
        count = lambda voxels: len(voxels.get_voxels())
        measure(
            "Open3D `VoxelGrid.create_from_triangle_mesh`",
            resolution,
            lambda: grid.create_from_triangle_mesh(mesh, voxel_size=spacing),
            count,
        )
        measure(
            "the same within our lattice's bounds",
            resolution,
            lambda: grid.create_from_triangle_mesh_within_bounds(mesh, spacing, origin, origin + dims * spacing),
            count,
        )


@peer("trimesh")
def trimesh_grid(trimesh):
    mesh = trimesh.Trimesh(points, triangles, process=False)
    spacing = ours(256)[2]
    measure("trimesh `voxelized`", 256, lambda: mesh.voxelized(spacing), lambda voxels: int(voxels.filled_count), 2)


turns.stdin.close()
with open(os.path.join(out, "peers_voxels.md"), "w") as file:
    print("| at | conservative, ms | voxels | beside | ms | voxels | times ours |", file=file)
    print("|--:|--:|--:|---|--:|--:|--:|", file=file)
    print(*rows, sep="\n", file=file)
    if versions:
        print("\nVersions: " + ", ".join(versions) + ".", file=file)
    for line in missing:
        print(f"\nMissing: {line}", file=file)
for line in missing:
    print("missing:", line)
