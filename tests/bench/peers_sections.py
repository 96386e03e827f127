"""peers_sections.py - the ore-like stack of bench_sections by what a user would pick instead: VTK's image stencil and flying edges.

    peers_sections.py FOLDER [RUNS]

FOLDER holds ore.csv of bench_sections. The contours become one vtkPolyData of closed lines before the clock starts; the clock sees
vtkPolyDataToImageStencil on the grid's points, vtkImageStencilToImage (quicker than a stencil over a uniform image), and vtkFlyingEdges3D
at half its value. The least of several runs: processor time of one thread, time of day of two. What it gives is another thing: bits inside on
grid points, so crossings half way along edges, whatever the contours are between them. Prints Markdown.
"""
import csv
import sys
import time

try:
    import vtk
except ImportError:
    print("missing: vtk")
    sys.exit(0)

runs = int(sys.argv[2]) if len(sys.argv) > 2 else 5

loops = {}
with open(sys.argv[1] + "/ore.csv") as file:
    for row in csv.DictReader(file):
        loops.setdefault((row["section"], row["loop"]), []).append((float(row["x"]), float(row["y"]), float(row["position"])))

points, lines = vtk.vtkPoints(), vtk.vtkCellArray()
points.SetDataTypeToDouble()
for loop in loops.values():
    first = points.GetNumberOfPoints()
    lines.InsertNextCell(len(loop) + 1)
    for i, p in enumerate(loop):
        points.InsertNextPoint(p)
        lines.InsertCellPoint(first + i)
    lines.InsertCellPoint(first)
stack = vtk.vtkPolyData()
stack.SetPoints(points)
stack.SetLines(lines)
bounds = stack.GetBounds()
heights = sorted({p[2] for loop in loops.values() for p in loop})
step = heights[1] - heights[0]


def run(n, clock):
    side = [(bounds[2 * k + 1] - bounds[2 * k]) / (n - 0.75) for k in range(2)]
    origin = [bounds[0] - 0.381966 * side[0], bounds[2] - 0.290569 * side[1], heights[0] - step]
    start = clock()
    stencil = vtk.vtkPolyDataToImageStencil()
    stencil.SetInputData(stack)
    stencil.SetOutputOrigin(origin)
    stencil.SetOutputSpacing([side[0], side[1], step])
    stencil.SetOutputWholeExtent([0, n, 0, n, 0, len(heights) + 1])  # one empty section at either end closes the surface
    image = vtk.vtkImageStencilToImage()
    image.SetInputConnection(stencil.GetOutputPort())
    image.SetOutputScalarTypeToUnsignedChar()
    image.SetInsideValue(255)
    image.SetOutsideValue(0)
    edges = vtk.vtkFlyingEdges3D()
    edges.SetInputConnection(image.GetOutputPort())
    edges.SetValue(0, 127.5)
    edges.ComputeNormalsOff()
    edges.ComputeScalarsOff()
    edges.Update()
    return 1e3 * (clock() - start), edges.GetOutput()


def set_threads(n):
    vtk.vtkSMPTools.Initialize(n)
    vtk.vtkMultiThreader.SetGlobalMaximumNumberOfThreads(n)
    vtk.vtkMultiThreader.SetGlobalDefaultNumberOfThreads(n)


def best(n, clock):
    run(n, clock)
    return min((run(n, clock) for _ in range(runs)), key=lambda r: r[0])


def volume(mesh):
    mass = vtk.vtkMassProperties()
    mass.SetInputData(mesh)
    mass.Update()
    return mass.GetVolume()


print(f"VTK {vtk.vtkVersion().GetVTKVersion()}: image stencil and flying edges\n")
print("| grid | ms | two threads: ms | triangles | volume |\n|--:|--:|--:|--:|--:|")
for n in (20, 40, 400):
    set_threads(1)
    one, mesh = best(n, time.thread_time)
    set_threads(2)
    two, _ = best(n, time.perf_counter)
    print(f"| {n} x {n} | {one:.2f} | {two:.2f} | {mesh.GetNumberOfCells()} | {volume(mesh):.5g} |", flush=True)
