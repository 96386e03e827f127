"""big_peers.py FOLDER [SIDE [CHUNK [FRAGMENT]]] - the labels of big.py by igneous: SIDE^3 voxels [256] in tasks of CHUNK [128], with up to three coarser
levels: as many as a body has halvings above FRAGMENT voxels [CHUNK].

igneous and its cloud-volume want an environment of their own, so two steps: with bitvox `big_peers.py FOLDER SIDE` writes FOLDER/labels.npy, and in an
environment with igneous-pipeline it reads that. Prints processor seconds, and of each level triangles, bodies that are not closed and volumes.
"""

import os
import resource
import sys

import numpy as np

LEVELS = 4


def spent():
    return sum(used.ru_utime + used.ru_stime for used in map(resource.getrusage, (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)))


def judged(at, faces):
    """Whether each edge has one face on either side, vertices at equal positions being one; and the volume."""
    _, number = np.unique(np.ascontiguousarray(at, "f4").view("V12").ravel(), return_inverse=True)
    corners = number.ravel()[faces]
    faces, corners = (part[(corners != np.roll(corners, 1, axis=1)).all(axis=1)] for part in (faces, corners))
    a, b = corners.ravel().astype("u8"), np.roll(corners, -1, axis=1).ravel().astype("u8")
    one, other = np.sort(a << np.uint64(32) | b), np.sort(b << np.uint64(32) | a)
    p, q, r = (at[faces[:, k]].astype(float) for k in range(3))
    return len(np.unique(one)) == len(one) and np.array_equal(one, other), abs((p * np.cross(q, r)).sum()) / 6


def main():
    folder = os.path.abspath(sys.argv[1])
    side, chunk = (int(one) for one in (*sys.argv[2:4], *(256, 128)[len(sys.argv) - 2 :]))
    name = os.path.join(folder, "labels.npy")
    if not os.path.exists(name):
        import big
        import dask.array

        formula = dask.array.map_blocks(big.numbers, chunks=dask.array.core.normalize_chunks(chunk, (side,) * 3), dtype="u8", meta=np.zeros((0, 0, 0), "u8"))
        return np.save(name, formula.compute())

    import igneous.task_creation as create
    from cloudvolume import CloudVolume
    from taskqueue import LocalTaskQueue

    labels, path = np.load(name), f"file://{folder}/layer"
    CloudVolume.from_numpy(labels, path, resolution=(1, 1, 1), chunk_size=(64, 64, 64), layer_type="segmentation", progress=False)
    queue, begin = LocalTaskQueue(parallel=1, progress=False), spent()
    for make in (lambda: create.create_meshing_tasks(path, 0, (chunk,) * 3, sharded=True, mesh_dir="mesh", max_simplification_error=1, spatial_index=True),
                 lambda: create.create_sharded_multires_mesh_tasks(path, num_lod=LEVELS - 1, mesh_dir="mesh", min_chunk_size=(int(sys.argv[4]) if sys.argv[4:] else chunk,) * 3, progress=False)):
        queue.insert(make())
        queue.execute()
        print(f"{spent() - begin:.1f} processor s", flush=True)
    store, counts = CloudVolume(path, progress=False), np.unique(labels[labels > 0], return_counts=True)
    chosen = list(zip(*(one.tolist() for one in counts)))[:: max(1, len(counts[0]) // 16)]
    for level in range(LEVELS):
        found, triangles = [], 0
        for label, count in chosen:
            try:
                mesh = store.mesh.get(label, lod=level)
            except Exception as error:
                print(f"level {level} of {label}: {error}", file=sys.stderr)
                continue
            mesh = mesh[label] if isinstance(mesh, dict) else mesh
            faces = np.asarray(mesh.faces).reshape(-1, 3)
            closed, volume = judged(np.asarray(mesh.vertices), faces)
            found.append((closed, volume / count - 1))
            triangles += len(faces)
        if found:
            print(f"- level {level}: {triangles} triangles of {len(found)} bodies, {sum(closed for closed, _ in found)} of them closed, volumes "
                  f"{100 * min(v for _, v in found):+.2f} to {100 * max(v for _, v in found):+.2f} % of their voxels")


if __name__ == "__main__":
    main()
