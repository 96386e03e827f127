"""levels_peers.py PEER MESH.npz OUT TARGET... - simplifies a mesh by another library, in a process of its own.

MESH.npz has positions (floats, moved to the middle of their bounds) and triangles, both welded. Writes OUT_TARGET.npz with
positions, triangles and the least processor time of some runs in milliseconds; arrays are in the library's own form before the
clock starts. A library that fails or does not end leaves its file out.
"""
import sys
import time

import numpy as np

MOST_SECONDS = 1.0  # a job that takes less is run again


def with_meshoptimizer(positions, triangles):
    import meshoptimizer

    indices = np.ascontiguousarray(triangles.ravel(), dtype=np.uint32)
    result = np.zeros_like(indices)

    def simplify(target):
        used = meshoptimizer.simplify(result, indices, positions, target_index_count=3 * target, target_error=1e9)
        return lambda: (positions, result[:used].reshape(-1, 3).copy())

    return simplify


def with_vtk(positions, triangles):
    import vtk
    from vtk.util import numpy_support

    vtk.vtkSMPTools.SetBackend("Sequential")
    points, cells, mesh = vtk.vtkPoints(), vtk.vtkCellArray(), vtk.vtkPolyData()
    points.SetData(numpy_support.numpy_to_vtk(positions, deep=1))
    offsets = np.arange(0, 3 * len(triangles) + 1, 3, dtype=np.int64)
    corners = triangles.ravel().astype(np.int64)
    cells.SetData(numpy_support.numpy_to_vtkIdTypeArray(offsets, deep=1), numpy_support.numpy_to_vtkIdTypeArray(corners, deep=1))
    mesh.SetPoints(points)
    mesh.SetPolys(cells)

    def simplify(target):
        decimation = vtk.vtkQuadricDecimation()
        decimation.SetInputData(mesh)
        decimation.SetTargetReduction(1.0 - target / len(triangles))
        decimation.Update()
        output = decimation.GetOutput()

        def arrays():
            faces = numpy_support.vtk_to_numpy(output.GetPolys().GetConnectivityArray()).reshape(-1, 3)
            return numpy_support.vtk_to_numpy(output.GetPoints().GetData()), faces

        return arrays

    return simplify


def with_fast_simplification(positions, triangles):
    import fast_simplification

    faces = np.ascontiguousarray(triangles, dtype=np.int32)

    def simplify(target):
        result = fast_simplification.simplify(positions, faces, target_count=target)
        return lambda: result

    return simplify


def with_meshlib(positions, triangles):
    import meshlib.mrmeshnumpy as arrays
    import meshlib.mrmeshpy as meshlib

    original = arrays.meshFromFacesVerts(triangles.astype(np.int32), positions)

    def simplify(target):
        mesh = meshlib.Mesh(original)
        settings = meshlib.DecimateSettings()
        settings.maxDeletedFaces = max(0, mesh.topology.numValidFaces() - target)
        settings.packMesh = True
        meshlib.decimateMesh(mesh, settings)
        return lambda: (arrays.getNumpyVerts(mesh), arrays.getNumpyFaces(mesh.topology))

    return simplify


PEERS = {
    "meshoptimizer": ("meshoptimizer", with_meshoptimizer),
    "VTK quadric": ("vtk", with_vtk),
    "fast-simplification": ("fast-simplification", with_fast_simplification),
    "MeshLib": ("meshlib", with_meshlib),
}


def main():
    name, mesh, out = sys.argv[1:4]
    with np.load(mesh) as file:
        simplify = PEERS[name][1](file["positions"], file["triangles"])

    for target in (int(t) for t in sys.argv[4:]):
        times = []
        while len(times) < 5 and sum(times) < MOST_SECONDS:
            start = time.process_time()
            result = simplify(target)
            times.append(time.process_time() - start)
        positions, triangles = result()
        np.savez(f"{out}_{target}.npz", positions=positions, triangles=triangles, ms=min(times) * 1e3)


if __name__ == "__main__":
    main()
