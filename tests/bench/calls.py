"""calls.py [BATCHES] - what a call of the Python package costs by itself: the smallest of each kind, on a tetrahedron and four voxels a side.

Prints Markdown: microseconds a call, the least of so many batches [200]. bench_calls.c has the same calls in C."""

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


main()
