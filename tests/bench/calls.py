"""calls.py [BATCHES] - what a call of the Python package costs by itself: the smallest of each kind, on a tetrahedron and four voxels a side.

Prints Markdown: microseconds a call, the least of so many batches [200]. bench_calls.c has the same calls in C. Then one ray a call at
the dragon of MESHES, beside Embree through trimesh, where these are there."""

import importlib.util
import os
import sys
import time

import bitvox

VERTICES = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
FACES = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]


def refused(call):
    try:
        call()
    except bitvox.Error:
        return
    raise AssertionError("was not refused")


def main():
    batches = int(sys.argv[1]) if len(sys.argv) > 1 else 200
    mesh = bitvox.Mesh(VERTICES, FACES)
    solid = bitvox.voxelize(mesh, resolution=4)
    calls = {
        "Grid.count": lambda: solid.count,
        "Grid | Grid": lambda: solid | solid,
        "Grid.dilate": lambda: solid.dilate(1),
        "voxelize": lambda: bitvox.voxelize(mesh, resolution=4),
        "surface": lambda: bitvox.surface(solid),
        "check": lambda: bitvox.check(mesh),
        "Mesh of lists": lambda: bitvox.Mesh(VERTICES, FACES),
        "refused: an option out of range": lambda: refused(lambda: bitvox.voxelize(mesh, resolution=0)),
        "refused: options that contradict": lambda: refused(lambda: bitvox.voxelize(mesh, resolution=4, spacing=1.0)),
    }
    print("| the smallest call in Python | µs |\n|---|--:|")
    for name, call in calls.items():
        least = float("inf")
        for _ in range(batches):
            start = time.process_time_ns()
            for _ in range(20):
                call()
            least = min(least, (time.process_time_ns() - start) / 20)
        print(f"| {name} | {least / 1000:.1f} |")


def one_ray_a_call(path, count=2000):
    import numpy as np
    import trimesh
    from trimesh.ray.ray_pyembree import RayMeshIntersector

    mesh = bitvox.Mesh.of(path)
    vertices, faces = np.asarray(mesh.vertices, float), np.asarray(mesh.faces)
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    draw = np.random.default_rng(1)
    way = draw.normal(size=(count, 3))
    start = low + (high - low) * draw.random((count, 3)) - 2 * np.linalg.norm(high - low) * way / np.linalg.norm(way, axis=1)[:, None]
    rays, ours, theirs = np.hstack([start, way]), bitvox.Closest(mesh), RayMeshIntersector(trimesh.Trimesh(vertices, faces, process=False))
    both = {
        "`Closest.cast`": lambda i: ours.cast(rays[i : i + 1], threads=1)["triangle"],
        "Embree, `intersects_first`": lambda i: theirs.intersects_first(start[i : i + 1], way[i : i + 1]),
        "Embree, `intersects_location`": lambda i: theirs.intersects_location(start[i : i + 1], way[i : i + 1], multiple_hits=False),
    }
    print(f"\n| one ray a call at {len(faces)} triangles | µs |\n|---|--:|")
    for name, cast in both.items():
        least = float("inf")
        for _ in range(3):
            begin = time.process_time_ns()
            for i in range(count):
                cast(i)
            least = min(least, (time.process_time_ns() - begin) / count)
        print(f"| {name} | {least / 1000:.1f} |")


main()
dragon = os.path.join(os.environ.get("MESHES", "../shared/meshes"), "dragon_vrip_871414.ply.gz")
if os.path.exists(dragon) and all(importlib.util.find_spec(name) for name in ("trimesh", "embreex")):
    one_ray_a_call(dragon)
else:
    print("\nmissing: one ray a call at the dragon, which needs MESHES, trimesh and embreex")
