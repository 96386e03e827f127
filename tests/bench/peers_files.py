"""peers_files.py OUT - others read the files that bench_files left in OUT/files; writes OUT/files.md beside ours.

Ours go from bytes in memory to arrays, welding STL. trimesh reads from memory too (process=False: without its merging of
vertices; as it comes: with it). assimp is its command, less what it takes to start. Times are processor time, least of the runs."""
import io
import json
import os
import shutil
import subprocess
import sys
import time
import resource

out = sys.argv[1]
ours = [json.loads(line) for line in open(os.path.join(out, "files.jsonl"))]
reads = {row["name"]: row for row in ours if row["job"] == "read"}


def least(job, runs=3):
    best = None
    for _ in range(runs):
        start = time.process_time()
        job()
        took = (time.process_time() - start) * 1e3
        best = took if best is None else min(best, took)
    return best


def child_ms(command):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode != 0:
        return None
    return (after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime) * 1e3


def assimp_ms(path):
    if shutil.which("assimp") is None:
        return None
    times = [child_ms(["assimp", "info", path, "--silent", "--raw"]) for _ in range(3)]
    idle = min(child_ms(["assimp", "version"]) for _ in range(3))
    return None if None in times else max(min(times) - idle, 0.0)


try:
    import trimesh
except ImportError:
    trimesh = None

rows = []
for name, row in reads.items():
    path = os.path.join(out, "files", name)
    data = open(path, "rb").read()
    kind = name.rsplit(".", 1)[1]
    cell = {"name": name, "ours": row["ms"], "speed": row["mb_per_s"]}
    if trimesh is not None:
        cell["raw"] = least(lambda: trimesh.load(io.BytesIO(data), file_type=kind, process=False))
        cell["merged"] = least(lambda: trimesh.load(io.BytesIO(data), file_type=kind), 1)
    cell["assimp"] = assimp_ms(path)
    rows.append(cell)


def shown(cell, key):
    value = cell.get(key)
    return "-" if value is None else f"{value:.0f} ms, {value / cell['ours']:.1f}"


with open(os.path.join(out, "files.md"), "w") as file:
    print("| reading the dragon | ours | MB/s | trimesh raw, times ours | trimesh as it comes | assimp command, less its start |", file=file)
    print("|---|--:|--:|--:|--:|--:|", file=file)
    for c in rows:
        print(f"| {c['name']} | {c['ours']:.1f} ms | {c['speed']} | {shown(c, 'raw')} | {shown(c, 'merged')} | {shown(c, 'assimp')} |",
              file=file)
    print("\n| other jobs | bytes | ms | MB/s |\n|---|--:|--:|--:|", file=file)
    for row in ours:
        if row["job"] != "read":
            print(f"| {row['job']} {row['name']} | {row['bytes']:,} | {row['ms']:.1f} | {row['mb_per_s']} |", file=file)
