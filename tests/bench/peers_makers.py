"""peers_makers.py OUT MESHES - CGAL's alpha wrapping, by pymeshlab, at the counts of bench_makers; writes OUT/peers_makers.md.

Offsets are a thirtieth of alpha, as in CGAL's example. Processor time of one thread, the least of BENCH_MAKERS_RUNS [5] runs. The volume
that is added is that beside what the mesh encloses.
Source: Portaneri, Rouxel-Labbe, Hemmer, Cohen-Steiner, Alliez. Alpha Wrapping with an Offset. 2022."""
import gzip
import os
import sys
import time

import numpy as np

try:
    import pymeshlab
except ImportError:
    sys.exit(0)

out, folder = sys.argv[1:3]
runs = int(os.environ.get("BENCH_MAKERS_RUNS", "5"))
# Of each mesh: alphas in percent of the diagonal that give about 5,000 and 1,000 triangles.
models = (("rocker-arm", (2.778, 7.453)), ("fandisk", (2.174, 5.161)), ("cow", (2.052, 6.136)))


def volume(mesh):
    corners = mesh.vertex_matrix()[mesh.face_matrix()]
    return float(np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])).sum()) / 6


rows = ""
for name, alphas in models:
    file, plain = os.path.join(folder, f"{name}.obj.gz"), os.path.join(out, "wrapped.obj")
    if not os.path.exists(file):
        continue
    with gzip.open(file) as packed, open(plain, "wb") as there:
        there.write(packed.read())
    for alpha in alphas:
        best = float("inf")
        for _ in range(runs):
            meshes = pymeshlab.MeshSet()
            meshes.load_new_mesh(plain)
            inside = abs(volume(meshes.current_mesh()))
            start = time.process_time()
            meshes.generate_alpha_wrap(alpha=pymeshlab.PercentageValue(alpha), offset=pymeshlab.PercentageValue(alpha / 30))
            best = min(best, time.process_time() - start)
        wrap = meshes.current_mesh()
        rows += f"| {name} | {alpha} | {wrap.face_number()} | {1e3 * best:.0f} | {100 * (abs(volume(wrap)) / inside - 1):.2f} |\n"
    os.remove(plain)
text = "Alpha in % of the diagonal.\n\n| CGAL alpha_wrap_3 | alpha | out | ms | added volume [%] |\n|---|--:|--:|--:|--:|\n" + rows
print(text, end="")
with open(os.path.join(out, "peers_makers.md"), "w", encoding="utf-8") as made:
    made.write(text)
