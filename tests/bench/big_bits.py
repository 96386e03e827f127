"""big_bits.py MESH [RESOLUTION [CHUNK [WORKERS [FOLDER]]]] - the bits of a mesh in Zarr, its parts counted, and windows of it beside those of `refine`.

The mesh is closed first if it is not, by repair at 512. Its voxels, those that it touches and those inside, at RESOLUTION [2048] along the longest
axis in chunks of CHUNK [512] go to a Zarr in FOLDER [/tmp] on WORKERS processes [2] of one thread; their parts are counted from there. Prints Markdown: what
each stage took of all processes together, voxels a processor second, what it wrote, and the most that all processes held at once. Then 24 windows of
256 voxels a side about corners of the mesh, and 8 anywhere, are compared bit by bit with those of an octree that is refined in them.
"""

import os
import resource
import sys
import threading
import time

import numpy as np
from big import at_work, numbers_of, spent, written

import bitvox
from bitvox import big

SIDE = 256  # voxels of a window


def held(pids):
    """GiB that processes hold at the moment; pages that they share count once in each."""
    total = 0
    for pid in pids:
        with open(f"/proc/{pid}/statm") as file:
            total += int(file.read().split()[1])
    return total * resource.getpagesize() / 2**30


def main():
    source = sys.argv[1]
    resolution, chunk, workers = numbers_of(sys.argv[2:5], (2048, 512, 2))
    with at_work(workers, sys.argv[5] if len(sys.argv) > 5 else None) as (folder, client):
        at = {name: os.path.join(folder, name) for name in ("mesh.ply", "bits.zarr")}
        mesh = bitvox.Mesh.of(source)
        if not mesh.check().closed:
            mesh = bitvox.repair(mesh, resolution=512)
        bitvox.write(mesh, at["mesh.ply"])
        levels = max(2, (resolution // 256).bit_length() - 1)
        base = bitvox.Lattice.fit(mesh, resolution=-(-resolution >> levels))
        lattice = bitvox.refine(mesh, base=base, levels=levels, window=((0, 0, 0), (8, 8, 8))).lattice()
        total = lattice.shape[0] * lattice.shape[1] * lattice.shape[2]

        most, run = [0.0], threading.Event()

        def watch():
            pids = [os.getpid(), *client.run(os.getpid).values()]
            while not run.wait(0.1):
                most[0] = max(most[0], held(pids))

        threading.Thread(target=watch, daemon=True).start()

        def seconds():
            return sum(each[0] for each in client.run(spent).values()) + spent()[0]

        print(f"{mesh.n_faces} triangles, {' x '.join(map(str, lattice.shape))} voxels, {total / 2**33:.2f} GiB of bits\n\n"
              f"| {os.path.basename(source)} at {resolution}, chunks of {chunk}, {workers} workers | processor s | s | million voxels a processor s | written [MiB] | all so far [GiB] | a worker | here |\n"
              "| --- | --- | --- | --- | --- | --- | --- | --- |")

        def stage(name, work, output=None):
            begin, clock = seconds(), time.perf_counter()
            made = work()
            used, clock = seconds() - begin, time.perf_counter() - clock
            print(f"| {name} | {used:.1f} | {clock:.1f} | {total / used / 1e6:.1f} | {written(output) / 2**20 if output else 0:.1f} | {most[0]:.2f} | "
                  f"{max(each[1] for each in client.run(spent).values()):.2f} | {spent()[1]:.2f} |", flush=True)
            return made

        volume = big.voxelize(at["mesh.ply"], lattice, chunks=chunk, fill="parity", add_shell=True)
        stage("voxels to Zarr", lambda: big.to_zarr(volume, at["bits.zarr"]), at["bits.zarr"])
        bits = big.from_zarr(at["bits.zarr"])
        parts = stage("connected parts", bits.components)
        print(f"\n{len(parts)} parts of {int(parts['voxels'].sum())} voxels\n")
        run.set()

        random, corners = np.random.default_rng(1), np.asarray(mesh.vertices)
        middles = [*((corners[random.integers(len(corners), size=24)] - lattice.corner) / lattice.spacing).astype(int), *random.integers(lattice.shape, size=(8, 3))]
        same, full = 0, 0
        for middle in middles:
            low = np.clip(middle - SIDE // 2, 0, np.subtract(lattice.shape, SIDE))
            window = tuple(map(int, low)), (SIDE,) * 3
            tree = bitvox.refine(mesh, base=base, levels=levels, window=window)
            ours, theirs = bits.crop(window).compute(scheduler="synchronous"), tree.expand(window=window)
            same += ours == theirs
            full += ours.count
        print(f"{same} of {len(middles)} windows of {SIDE}³ are equal to refine's, {full / len(middles) / SIDE**3:.3f} of their voxels are set", flush=True)


if __name__ == "__main__":
    main()
