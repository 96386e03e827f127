"""peers_morph.py OUT - scipy.ndimage and edt on the grids that bench_morph wrote to OUT; prints Markdown, writes OUT/peers_morph.md.

Processor time of one thread, for two threads the clock; the least of BENCH_MORPH_RUNS [2] runs, memory warm from the run before."""
import os
import resource
import sys
import time

import numpy as np

try:
    from scipy import ndimage
except ImportError:
    ndimage = None
try:
    import edt
except ImportError:
    edt = None

out = sys.argv[1]
runs = int(os.environ.get("BENCH_MORPH_RUNS", "2"))


def now(threads):
    if threads > 1:
        return time.perf_counter()
    used = resource.getrusage(resource.RUSAGE_SELF)
    return used.ru_utime + used.ru_stime


def least(job, threads=1):
    best = float("inf")
    for _ in range(runs):
        start = now(threads)
        job()
        best = min(best, now(threads) - start)
    return f"{1e3 * best:.0f}"


grids = [np.load(os.path.join(out, f"morph_{name}.npy")).astype(bool) for name in ("dragon", "random")]
rows = []
if ndimage is not None:
    cross = ndimage.generate_binary_structure(3, 1)
    rows.append(["scipy.ndimage.binary_dilation, 6 neighbours"] + [least(lambda g=g: ndimage.binary_dilation(g, cross)) for g in grids])
for threads in (1, 2) if edt is not None else ():
    rows.append([f"edt.edtsq, {threads} thread{'s' if threads > 1 else ''}"]
                + [least(lambda g=g: edt.edtsq(~g, parallel=threads), threads) for g in grids])
text = "| 512 x 512 x 512 [ms] | dragon | random tenth |\n|---|---|---|\n" + "".join("| " + " | ".join(row) + " |\n" for row in rows)
print(text, end="")
with open(os.path.join(out, "peers_morph.md"), "w", encoding="utf-8") as file:
    file.write(text)
