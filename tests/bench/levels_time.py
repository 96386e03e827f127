"""levels_time.py OUT PROGRAM MESH - time of levels of the large dragon beside meshoptimizer's, in turns; one or two threads.

meshoptimizer's C function gets the welded arrays that peers_levels.py left in OUT/levels; ours is the whole job, from the arrays
as they are in the file to those of 27,000 and 4,000 triangles, without reading and writing. Time of day for both, which
needs an idle machine; the least of the runs. Writes OUT/levels_time.json.
    BENCH_LEVELS_OPTIONS=...  more options of `bitvox lod`
"""
import ctypes
import hashlib
import json
import os
import shlex
import subprocess
import sys
import time

import meshoptimizer
import numpy as np

out, program, mesh = sys.argv[1:4]
runs = int(os.environ.get("BENCH_PEER_RUNS", "5"))
FINEST, LEVELS = 27000, "27000,4000"


def meshoptimizer_job():
    """One simplification, arrays to arrays; returns milliseconds and the number of triangles."""
    name = hashlib.sha256(open(mesh, "rb").read()).hexdigest()[:16]
    with np.load(os.path.join(out, "levels", f"{name}_welded.npz")) as file:
        positions = np.ascontiguousarray(file["positions"], dtype=np.float32)
        indices = np.ascontiguousarray(file["triangles"].ravel(), dtype=np.uint32)
    result = np.empty_like(indices)
    simplify = ctypes.CDLL(meshoptimizer._loader.lib_path).meshopt_simplify
    simplify.restype = ctypes.c_size_t
    pointer, size = ctypes.c_void_p, ctypes.c_size_t
    simplify.argtypes = [pointer, pointer, size, pointer, size, size, size, ctypes.c_float, ctypes.c_uint, pointer]

    def job():
        start = time.perf_counter()
        used = simplify(result.ctypes.data, indices.ctypes.data, len(indices), positions.ctypes.data, len(positions), 12,
                        3 * FINEST, 1e9, 0, None)
        return (time.perf_counter() - start) * 1e3, used // 3

    return job


def our_job(threads):
    """Milliseconds of all stages that touch no file."""
    pattern = os.path.join(out, "levels", "time_%d.ply")
    line = [program, "lod", mesh, "-o", pattern, "--triangles", LEVELS, "--threads", str(threads), "--samples", "0"]
    line += shlex.split(os.environ.get("BENCH_LEVELS_OPTIONS", "")) + ["--json", "--quiet"]
    report = json.loads(subprocess.run(line, stdout=subprocess.PIPE, text=True).stdout)
    files = ("read", "parse", "check", "write", "distance")
    return sum(stage["seconds"] for stage in report["stages"] if not stage["name"].startswith(files)) * 1e3


def main():
    job = meshoptimizer_job()
    job()
    theirs, ours = [], {1: [], 2: []}
    for _ in range(runs):
        theirs.append(job()[0])
        for threads in ours:
            ours[threads].append(our_job(threads))

    least = min(theirs)
    print(f"Time of day, least of {runs} runs in turns.\n")
    print("| | ms | of meshoptimizer's |\n|---|--:|--:|")
    print(f"| meshoptimizer simplify to {job()[1]:,}, one thread | {least:.0f} | 1 |")
    for threads, times in ours.items():
        name = f"ours to {LEVELS.replace(',', ' and ')}, {threads} thread{'s' * (threads > 1)}"
        print(f"| {name} | {min(times):.0f} | {min(times) / least:.2f} |")
    with open(os.path.join(out, "levels_time.json"), "w") as file:
        json.dump({"meshoptimizer": theirs, "ours": ours}, file, indent=1)


main()
