"""peers_components.py OUT BENCH_COMPONENTS MESHES - numbers of connected parts by other libraries; writes OUT/peers_components.md.

Grids of 512 x 512 x 512: the dragon's solid and a tenth of all voxels at random. Ours and theirs take turns (the program
BENCH_COMPONENTS does one run of ours on demand). Processor time of one thread, least of the runs. All make an array of uint32 a voxel
(scipy: int32): ours into fresh and into warm memory; what counting the parts alone takes stands beside it."""
import importlib.metadata
import os
import subprocess
import sys
import time

import numpy as np

out, program, meshes = sys.argv[1:4]
runs = int(os.environ.get("BENCH_PEER_RUNS", "5"))
turns = subprocess.Popen([program, "turns", meshes, out], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
if turns.stdout.readline().strip() != "ready":
    sys.exit("peers_components: no answer from " + program)
rows, versions = [], []


def ours(name, connectivity):
    turns.stdin.write(f"{name} {connectivity}\n")
    turns.stdin.flush()
    return [float(word) for word in turns.stdout.readline().split()]


def measure(library, name, connectivity, job):
    found, theirs, our_times = job(), [], []
    for _ in range(runs):
        our_times.append(ours(name, connectivity))
        start = time.process_time()
        job()
        theirs.append((time.process_time() - start) * 1e3)
    count, fresh, warm = (min(t[i] for t in our_times) for i in range(3))
    if our_times[0][3] != found:
        sys.exit(f"peers_components: {library} finds {found} parts, ours {our_times[0][3]}")
    rows.append(f"| {name} | {connectivity} | {found:,} | {count:.0f} | {fresh:.0f} | {warm:.0f} | {library} | {min(theirs):.0f} | {min(theirs) / fresh:.1f} |"
                f" {min(theirs) / warm:.1f} | {min(theirs) / count:.0f} |")
    print(rows[-1], flush=True)


for name in ("dragon", "random"):
    array = np.load(os.path.join(out, f"components_{name}.npy"))
    for connectivity in (6, 18, 26):
        try:
            import cc3d

            measure("cc3d", name, connectivity, lambda: cc3d.connected_components(array, connectivity=connectivity, out_dtype=np.uint32, return_N=True)[1])
        except ImportError:
            pass
        try:
            from scipy import ndimage

            structure = ndimage.generate_binary_structure(3, {6: 1, 18: 2, 26: 3}[connectivity])
            runs, kept = 1, runs
            measure("scipy.ndimage.label", name, connectivity, lambda: ndimage.label(array, structure)[1])
            runs = kept
        except ImportError:
            pass
turns.stdin.close()
for package in ("connected-components-3d", "scipy"):
    try:
        versions.append(f"{package} {importlib.metadata.version(package)}")
    except importlib.metadata.PackageNotFoundError:
        versions.append(f"{package} missing")
with open(os.path.join(out, "peers_components.md"), "w", encoding="utf-8") as file:
    file.write("| grid | connectivity | parts | ours, count ms | labels fresh ms | labels warm ms | library | ms | times ours fresh | warm | count |\n")
    file.write("|---|--:|--:|--:|--:|--:|---|--:|--:|--:|--:|\n" + "\n".join(rows) + "\n\n" + ", ".join(versions) + "\n")
