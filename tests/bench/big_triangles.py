"""big_triangles.py MESH [RESOLUTION [CHUNK [WORKERS [FOLDER]]]] - a mesh of very many triangles to a hundredth of them.

The surface of MESH's voxels, RESOLUTION [1024] along its longest side, is written in pieces of CHUNK [512] and streamed to one binary PLY: of
the dragon 12 million triangles at 1565, 100 million at 4430. That file is what is measured: sorted to columns on the disk, voxelized by windows to a
Zarr of bits, those to pieces and three levels, the last of which is joined and brought to a hundredth of the file's triangles. Prints Markdown: what each
stage took of all processes together, what it wrote, and the most that a worker and this process held so far; then whether the result is closed, manifold
and without crossings, and how far it is from MESH: where all fits into 4 GiB, beside the same from the whole file at once.

The bits are compared with those of MESH: a file of a surface gives the voxels that it was made of. Takes about 180 bytes a triangle on the disk of FOLDER [/tmp].
"""

import os
import resource
import sys
import time

from big import at_work, numbers_of, spent, written

import bitvox
from bitvox import big

FITS = 1.5e7  # triangles; to simplify them at once takes 180 bytes each


def same(one, other):
    """Whether two volumes of bits have no voxel that is in only one of them."""
    return (one ^ other).count() == 0


def main():
    source = sys.argv[1]
    resolution, chunk, workers = numbers_of(sys.argv[2:5], (1024, 512, 2))
    with at_work(workers, sys.argv[5] if len(sys.argv) > 5 else None) as (folder, client):
        at = {name: os.path.join(folder, name) for name in ("mesh.ply", "given.zarr", "fine", "huge.ply", "columns", "bits.zarr", "levels")}

        def seconds():
            return sum(each[0] for each in client.run(spent).values()) + spent()[0]

        def stage(name, work, output=None):
            begin, clock = seconds(), time.perf_counter()
            made = work()
            held = [*(each[1] for each in client.run(spent).values()), spent()[1]]
            size = written(at[output]) or os.path.getsize(at[output]) if output else 0
            print(f"| {name} | {seconds() - begin:.1f} | {time.perf_counter() - clock:.1f} | {size / 2**20:.0f} | {max(held[:-1]):.2f} | {held[-1]:.2f} |", flush=True)
            return made

        print(f"| {os.path.basename(source)} at {resolution}, chunks of {chunk}, {workers} workers | processor s | s | written [MiB] | most so far of a worker [GiB] | here [GiB] |\n"
              "| --- | --- | --- | --- | --- | --- |")
        bitvox.write(bitvox.read(source), at["mesh.ply"])
        lattice = bitvox.Lattice.fit(at["mesh.ply"], resolution=resolution, padding=2)
        stage("voxels of the mesh", lambda: big.to_zarr(big.voxelize(at["mesh.ply"], lattice, chunks=chunk), at["given.zarr"]), "given.zarr")
        fine = stage("surface in pieces", lambda: big.run(big.from_zarr(at["given.zarr"]), at["fine"], show=None), "fine")
        stage("one PLY", lambda: fine.save(at["huge.ply"]), "huge.ply")
        total = fine.n_faces()
        volume = stage("triangles to columns", lambda: big.voxelize(at["huge.ply"], lattice, chunks=(lattice.shape[0], chunk // 2, chunk // 2), spill=at["columns"]), "columns")
        stage("voxels by windows", lambda: big.to_zarr(volume, at["bits.zarr"]), "bits.zarr")
        bits = big.from_zarr(at["bits.zarr"], chunks=chunk)
        print(f"\n{total} triangles; bits equal to those of the mesh: {stage('both compared', lambda: same(bits, big.from_zarr(at['given.zarr'], chunks=chunk)))}\n")
        pieces = stage("surface and 3 levels in pieces", lambda: big.run(bits, at["levels"], levels=4, show=None), "levels")
        result = stage(f"{pieces.n_faces(3)} joined, to {total // 100}", lambda: bitvox.simplify(pieces.merge(3), triangles=total // 100))
        print(f"\nlevels of {', '.join(str(pieces.n_faces(level)) for level in range(4))} triangles, at most {pieces.error(3) / max(lattice.spacing):.2f} voxels from the finest")
        judge("by pieces", result, at["mesh.ply"], lattice)
        if total < FITS:
            begin = resource.getrusage(resource.RUSAGE_SELF).ru_utime
            whole = bitvox.simplify(at["huge.ply"], triangles=total // 100)
            print(f"at once: {resource.getrusage(resource.RUSAGE_SELF).ru_utime - begin:.1f} s, {spent()[1]:.2f} GiB here")
            judge("at once", whole, at["mesh.ply"], lattice)


def judge(name, mesh, source, lattice):
    found, far = mesh.check(), bitvox.compare(source, mesh, samples=200_000)
    print(f"- {name}: {mesh.n_faces} triangles, {'closed' if found.closed else 'OPEN'}, {'manifold' if found.vertex_manifold else 'NOT MANIFOLD'}, {len(mesh.crossings())} crossings; "
          f"from the mesh mean {(far.mean_a_to_b + far.mean_b_to_a) / 2 / max(lattice.spacing):.4f} and at most {far.max / max(lattice.spacing):.3f} voxels", flush=True)


if __name__ == "__main__":
    main()
