"""big.py [SIDE [CHUNK [WORKERS [labels [small]]]]] - surfaces larger than memory: SIDE^3 voxels [512] in chunks of CHUNK [256] on WORKERS processes [2].

The body is a formula, tubes and cells of known volume, so that nothing is read; with labels each of them is a body of its own, and small ones are an
eighth as large: 256^3 in chunks of 32 has as many bodies, chunks and files as 2048^3 in chunks of 256, for what this process holds. Prints Markdown: what each stage took of all processes
together (processor seconds; voxels a second of them), bytes written, and the most memory that a worker and this process ever held. Then
levels are joined where they fit: closed, without crossings, and their volume against the formula's.
"""

import contextlib
import os
import resource
import sys
import tempfile
import time

import dask.array
import distributed
import numpy as np
import zarr

from bitvox import big

# Radii of as many voxels as their volume says, to 0.03 %: what levels lose is not covered by what voxels do.
PERIOD, CELL, TUBE = (8, 1.91, 1.24) if "small" in sys.argv else (64, 15.3, 9.9)  # voxels
AT, AXIS = PERIOD * 5 / 16, PERIOD * 3 / 4  # of each period: where the center of a cell lies on each axis, and the axis of a tube


def bodies(block_info=None):
    """A chunk [x, y, z] of the formula, slice by slice."""
    (x, y, z), end = (np.arange(*place) for place in block_info[None]["array-location"]), block_info[None]["shape"][0]
    made = np.empty((len(x), len(y), len(z)), bool)
    wave = [((at + 0.5) % PERIOD).astype("f4") for at in (x, y, z)]
    tube = ((wave[1] - AXIS) ** 2)[:, None] + (wave[2] - AXIS) ** 2 < TUBE**2
    cell = ((wave[1] - AT) ** 2)[:, None] + (wave[2] - AT) ** 2
    for i, at in enumerate(x):
        made[i] = cell < CELL**2 - (wave[0][i] - AT) ** 2
        if 2 <= at < end - 2:
            made[i] |= tube
    return made


def numbers(block_info=None):
    """Labels [x, y, z]: each tube and each cell has its own."""
    (x, y, z), end = (np.arange(*place) // PERIOD for place in block_info[None]["array-location"]), block_info[None]["shape"][0] // PERIOD
    tube = 1 + y[:, None] * end + z
    wave = (np.arange(*block_info[None]["array-location"][1]) + 0.5) % PERIOD, (np.arange(*block_info[None]["array-location"][2]) + 0.5) % PERIOD
    cell = ((wave[0] - AT) ** 2)[:, None] + (wave[1] - AT) ** 2 < (CELL + PERIOD / 64) ** 2
    made = bodies(block_info).astype("u8")
    for i, at in enumerate(x):
        made[i] *= np.where(cell, (at + 1) * (end * end) + tube, tube).astype("u8")
    return made


def label_stages(stage, folder, formula):
    """Labels in Zarr to pieces, levels and a shard; then a few bodies are joined."""
    at = [os.path.join(folder, name) for name in ("labels.zarr", "bodies", "precomputed")]
    chunk = formula.chunksize[0]
    stored = zarr.create_array(at[0], shape=formula.shape, chunks=(min(PERIOD, chunk),) * 3, dtype="u8")  # a task writes a chunk, in many files
    stage("formula to Zarr", lambda: formula.transpose(2, 1, 0).store(stored, lock=False), at[0])
    labels = big.Labels(big.samples_from_zarr(at[0]), chunks=chunk)
    counts = stage("voxels of each label", labels.counts)
    pieces = stage("bodies and 3 levels in pieces", lambda: big.run(labels, at[1], levels=4, show=None), at[1])
    stage("sharded Draco", lambda: pieces.to_neuroglancer(at[2], sharded=True), at[2])
    return pieces, counts


def judge_labels(pieces, counts):
    chosen = list(counts)[:: max(1, len(counts) // 16)]
    for level in range(4):
        found = [(pieces.merge(level, label=label).check(), counts[label]) for label in chosen]
        print(f"- level {level}: {pieces.n_faces(level)} triangles of {len(counts)} bodies; of {len(chosen)} that were joined {sum(one.closed and one.vertex_manifold for one, _ in found)} are "
              f"closed, volumes {100 * min(one.volume / n - 1 for one, n in found):+.2f} to {100 * max(one.volume / n - 1 for one, n in found):+.2f} % of their voxels")


def spent():
    used = resource.getrusage(resource.RUSAGE_SELF)
    return used.ru_utime + used.ru_stime, used.ru_maxrss / 2**20


def written(folder):
    return sum(os.path.getsize(os.path.join(path, name)) for path, _, names in os.walk(folder) for name in names)


def numbers_of(given, usual):
    return (int(one) for one in (*given, *usual[len(given) :]))


@contextlib.contextmanager
def at_work(workers, parent=None):
    """A folder of its own, and a client of so many processes of one thread."""
    with tempfile.TemporaryDirectory(dir=parent) as folder, distributed.LocalCluster(
            n_workers=workers, threads_per_worker=1, dashboard_address=None, memory_limit=0, local_directory=folder) as cluster, distributed.Client(cluster) as client:
        yield folder, client


def main():
    side, chunk, workers = numbers_of(sys.argv[1:4], (512, 256, 2))
    with at_work(workers) as (folder, client):

        def seconds():
            return sum(each[0] for each in client.run(spent).values()) + spent()[0]

        print(f"| {side}³, chunks of {chunk}, {workers} workers | processor s | s | million voxels a processor s | written [MiB] |\n| --- | --- | --- | --- | --- |")

        def stage(name, work, output=None):
            begin, clock = seconds(), time.perf_counter()
            made = work()
            used, clock = seconds() - begin, time.perf_counter() - clock
            print(f"| {name} | {used:.1f} | {clock:.1f} | {side**3 / used / 1e6:.1f} | {written(output) / 2**20 if output else 0:.1f} |", flush=True)
            return made

        if "labels" in sys.argv:
            formula = dask.array.map_blocks(numbers, chunks=dask.array.core.normalize_chunks(chunk, (side,) * 3), dtype="u8", meta=np.zeros((0, 0, 0), "u8"))
            pieces, counts = label_stages(stage, folder, formula)
            print(f"\nmost memory: {max(each[1] for each in client.run(spent).values()):.2f} GiB a worker, {spent()[1]:.2f} GiB here\n")
            return judge_labels(pieces, counts)
        at = [os.path.join(folder, name) for name in ("bits.zarr", "pieces", "precomputed")]
        formula = dask.array.map_blocks(bodies, chunks=dask.array.core.normalize_chunks(chunk, (side,) * 3), dtype=bool, meta=np.zeros((0, 0, 0), bool))
        stage("formula to Zarr", lambda: big.to_zarr(big.from_dask(formula), at[0]), at[0])
        volume = big.from_zarr(at[0])
        parts = stage("parts", lambda: len(volume.components()))
        pieces = stage("surface and 3 levels in pieces", lambda: big.run(volume, at[1], levels=4, show=None), at[1])
        stage("sharded Draco", lambda: pieces.to_neuroglancer(at[2], sharded=True), at[2])
        stage("one PLY of level 1", lambda: pieces.save(os.path.join(folder, "level.ply"), 1))
        print(f"\n{parts} parts; most memory: {max(each[1] for each in client.run(spent).values()):.2f} GiB a worker, {spent()[1]:.2f} GiB here\n")

        # What was printed is measured; from here on this process holds whole levels.
        periods = side // PERIOD
        known = periods**2 * (periods * 4 / 3 * np.pi * CELL**3 + (side - 4) * np.pi * TUBE**2)
        for level in range(4):
            whole = f"{pieces.n_faces(level)} triangles, at most {pieces.error(level):.2f} voxels from the finest"
            if pieces.n_faces(level) < 5e6:
                mesh = pieces.merge(level)
                found = mesh.check()
                whole += f", {'closed' if found.closed and found.vertex_manifold else 'OPEN'}, {len(mesh.crossings())} crossings, volume {100 * (found.volume / known - 1):+.2f} %"
            print(f"- level {level}: {whole}")


if __name__ == "__main__":
    main()
