"""peers_volumes.py OUT - surfaces of a level by other libraries, beside bench_volumes' (run it first).

Reads OUT/volume_dragon.f32 (512^3 samples, x fastest) and OUT/volumes.ms; prints Markdown and writes OUT/volumes.jsonl (targets). One
thread, processor time, the least of the runs after one that is not counted; scikit-image, which is slow, runs once.
"""
import json
import os
import sys
import time

import numpy as np

SIDE = 512
TARGET = "vtkFlyingEdges3D : surface of a level in 512^3 f32"


def least(job, runs):
    job()
    times = []
    for _ in range(runs):
        start = time.process_time()
        job()
        times.append((time.process_time() - start) * 1e3)
    return min(times)


def flying_edges(samples):
    import vtk
    from vtk.util.numpy_support import numpy_to_vtk

    vtk.vtkSMPTools.SetBackend("Sequential")
    image = vtk.vtkImageData()
    image.SetDimensions(SIDE, SIDE, SIDE)
    image.GetPointData().SetScalars(numpy_to_vtk(samples, deep=False))
    rows = {}
    for name, normals in (("vtkFlyingEdges3D", 0), ("vtkFlyingEdges3D with normals", 1)):
        cut = vtk.vtkFlyingEdges3D()
        cut.SetInputData(image)
        cut.SetValue(0, 0.0)
        cut.SetComputeNormals(normals)
        cut.SetComputeGradients(0)
        cut.SetComputeScalars(0)

        def job():
            cut.Modified()
            cut.Update()

        rows[name] = (least(job, 5), cut.GetOutput().GetNumberOfPolys())
    return rows


def scikit_image(samples):
    from skimage.measure import marching_cubes

    start = time.process_time()
    faces = marching_cubes(samples.reshape(SIDE, SIDE, SIDE), 0.0)[1]
    return {"skimage.measure.marching_cubes": ((time.process_time() - start) * 1e3, len(faces))}


def main():
    out = sys.argv[1]
    if not os.path.isfile(f"{out}/volume_dragon.f32"):
        return print("missing: volume_dragon.f32, which bench_volumes writes")
    samples = np.fromfile(f"{out}/volume_dragon.f32", np.float32)
    ours = float(open(f"{out}/volumes.ms", encoding="ascii").read())
    rows = {}
    for peer in (flying_edges, scikit_image):
        try:
            rows |= peer(samples)
        except ImportError as why:
            print(f"missing: {why}")
    print("| surface of the level, f32 | least ms | triangles | times ours |\n|---|--:|--:|--:|")
    for name, (ms, triangles) in rows.items():
        print(f"| {name} | {ms:.0f} | {triangles} | {ms / ours:.1f} |")
    with open(f"{out}/volumes.jsonl", "w", encoding="ascii") as file:
        if "vtkFlyingEdges3D" in rows:
            value = rows["vtkFlyingEdges3D"][0] / ours
            file.write(json.dumps({"title": TARGET, "value": value, "unit": "times", "target": 2.0, "below": False}) + "\n")
    return None


main()
