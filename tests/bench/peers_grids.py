"""peers_grids.py OUT BENCH_GRIDS MESHES - what other libraries take for what is done with grids.

Writes OUT/peers_grids.md and OUT/peers_grids.jsonl (targets). Arrays are in memory in the form that each library wants before the
clock starts; jobs run once without being counted. Ours and theirs take turns (the program BENCH_GRIDS does one run of ours on
demand). One thread: processor time of a process held on one processor.

    peers_grids.py worker OUT NAME   one job for each line of standard input: milliseconds and what it made
"""
import importlib.metadata
import os
import statistics
import subprocess
import sys
import time

import numpy as np


def load(out, name, type):
    return np.fromfile(os.path.join(out, f"grids_{name}"), dtype=type)


# ---- their jobs: each returns (package, job, what to say of its result) ----


def numpy_coverage(out):
    bits = np.unpackbits(load(out, "random.words", "<u8").view(np.uint8), bitorder="little").view(bool).reshape(512, 512, 512)
    return "numpy", lambda: bits.reshape(128, 4, 128, 4, 128, 4).sum(axis=(1, 3, 5)), lambda n: hash_of(n.astype("<u4"))


def dragons(out):
    """Both dragons with vertices at equal positions joined: exact libraries want a closed mesh."""
    triangles = load(out, "triangles", np.uint32).reshape(-1, 3)
    for name in "ab":
        points, place = np.unique(load(out, f"{name}.points", np.float32).reshape(-1, 3), axis=0, return_inverse=True)
        joined = place.reshape(-1)[triangles]
        keep = (joined[:, 0] != joined[:, 1]) & (joined[:, 1] != joined[:, 2]) & (joined[:, 2] != joined[:, 0])
        yield points, joined[keep].astype(np.uint32)


def volume_of(points, triangles):
    p = points.astype(np.float64)
    p -= p.mean(axis=0)
    a, b, c = (p[triangles[:, i]] for i in range(3))
    return np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6


def manifold_boolean(out, operation, given=""):
    """From arrays; given: from bodies as manifold3d holds them."""
    import manifold3d

    arrays = list(dragons(out))

    def bodies():
        return [manifold3d.Manifold(manifold3d.Mesh64(p.astype(np.float64), t.astype(np.uint64))) for p, t in arrays]

    made_before = bodies() if given else None

    def job():
        a, b = made_before or bodies()
        made = {"union": lambda: a + b, "intersection": lambda: a ^ b, "difference": lambda: a - b}[operation]()
        mesh = made.to_mesh64()
        return mesh.vert_properties, mesh.tri_verts

    return "manifold3d", job, lambda m: f"{volume_of(m[0][:, :3], m[1]):.12g} {len(m[1])}"


def meshlib_boolean(out, operation):
    from meshlib import mrmeshnumpy, mrmeshpy

    arrays = list(dragons(out))
    spacing = float(sys.argv[4])
    call = {"union": "Unite", "intersection": "Intersect", "difference": "Subtract"}[operation]

    def job():
        a, b = (mrmeshnumpy.meshFromFacesVerts(t.astype(np.int32), p) for p, t in arrays)
        made = getattr(mrmeshpy, "voxelBoolean" + call)(a, b, spacing)
        return mrmeshnumpy.getNumpyVerts(made), mrmeshnumpy.getNumpyFaces(made.topology)

    return "meshlib", job, lambda m: f"{volume_of(*m):.12g} {len(m[1])}"


def hash_of(array):
    """The library's hash of bytes."""
    h = 0xCBF29CE484222325
    data = array.tobytes()
    for word in [*np.frombuffer(data, "<u8").tolist(), len(data)]:
        h = ((h ^ word) * 0x100000001B3) & (2**64 - 1)
        h ^= h >> 32
    return f"{h:016x}"


def work(out, name):
    package, job, say = globals()[name.split(":")[0]](out, *name.split(":")[1:])
    print("ready", package, importlib.metadata.version(package), flush=True)
    for _ in sys.stdin:
        start = time.process_time()
        result = job()
        ms = (time.process_time() - start) * 1e3
        print(f"{ms:.3f} {say(result)}", flush=True)


if sys.argv[1] == "worker":
    work(sys.argv[2], sys.argv[3])
    sys.exit(0)

# ---- ours and theirs in turns ----

out, program, meshes = sys.argv[1:4]
runs = int(os.environ.get("BENCH_PEER_RUNS", "3"))
processors = sorted(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else []


class Program:
    """A program that answers each line with a line."""

    def __init__(self, command):
        pin = (lambda: os.sched_setaffinity(0, processors[-1:])) if processors else None
        with open(os.path.join(out, "peers_grids.log"), "a") as log:
            self.process = subprocess.Popen(
                [str(c) for c in command], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=log, text=True, preexec_fn=pin
            )
        self.greeting = self.answer("ready")

    def answer(self, first=""):
        """Libraries print messages too: lines of theirs are passed over."""
        for line in self.process.stdout:
            if (first and line.startswith(first)) or (not first and line[:1].isdigit()):
                return line.split(maxsplit=1)[1].strip() if first else line.strip()
        raise RuntimeError("no answer, see peers_grids.log")

    def ask(self, line=""):
        self.process.stdin.write(line + "\n")
        self.process.stdin.flush()
        ms, rest = self.answer().split(maxsplit=1)
        return float(ms), rest

    def close(self):
        self.process.stdin.close()
        self.process.wait()


open(os.path.join(out, "peers_grids.log"), "w").close()
turns = Program([program, "turns", meshes, out])
rows, missing, versions, targets, said = [], [], {}, [], {}


def show(times):
    return f"{min(times):.1f} ({statistics.median(times):.1f})"


def measure(job, title, name, target=None, times=runs):
    """Least times of ours and theirs in turns, one thread; what each said of its result."""
    peer, theirs, ours = None, [], []
    try:
        turns.ask(f"{job} 1")
        peer = Program([sys.executable, __file__, "worker", out, name, turns.greeting])
        if times > 1:
            peer.ask()
        for _ in range(times):
            for _ in range(3):
                ms, mine = turns.ask(f"{job} 1")
                ours.append(ms)
            ms, their = peer.ask()
            theirs.append(ms)
        package, _, version = peer.greeting.rpartition(" ")
        versions[package] = version
    except Exception as reason:
        missing.append(f"{title}, {job}: {reason}")
        return
    finally:
        if peer:
            peer.close()
    ratio = min(theirs) / min(ours)
    said[job, "ours"], said[job, title] = mine, their
    rows.append(f"| {job} | {show(ours)} | {title} | {show(theirs)} | {ratio:.1f} | {target or ''} |")
    print(rows[-1], flush=True)
    if target:
        targets.append(f'{{"title": "{job}, one thread : {title}", "value": {ratio:.4g}, "unit": "times", "target": {target}, "below": false}}')


def measure_blocks():
    measure("coverage", "numpy reshape and sum", "numpy_coverage", target=20)
    same = said.get(("coverage", "ours")) == said.get(("coverage", "numpy reshape and sum"))
    return [] if same else ["DIFFERENT: our counts and numpy's"]


def measure_booleans():
    """Times, and how far volumes lie from the exact ones of manifold3d."""
    lines = ["| of two dragons | by | triangles | volume | off the exact one |", "|---|---|--:|--:|--:|"]
    for operation in ("union", "intersection", "difference"):
        measure(operation, "manifold3d, exact", f"manifold_boolean:{operation}", times=1)
        measure(operation, "manifold3d, its bodies given", f"manifold_boolean:{operation}:given", times=1)
        measure(operation, "MeshLib voxelBoolean", f"meshlib_boolean:{operation}", times=1)
        exact = said.get((operation, "manifold3d, exact"))
        for by in ("manifold3d, exact", "ours", "MeshLib voxelBoolean"):
            if (operation, by) not in said:
                continue
            volume, triangles = said[operation, by].split()
            off = f"{(float(volume) / float(exact.split()[0]) - 1) * 100:+.4f} %" if exact else ""
            lines.append(f"| {operation} | {by} | {int(triangles):,} | {float(volume):.9g} | {off} |")
    return lines


notes = measure_blocks()
table = measure_booleans()
turns.close()
with open(os.path.join(out, "peers_grids.jsonl"), "w") as file:
    print(*targets, sep="\n", file=file)
with open(os.path.join(out, "peers_grids.md"), "w") as file:
    print("| job | ours, ms | beside | ms | times ours | target |", file=file)
    print("|---|--:|---|--:|--:|--:|", file=file)
    print(*rows, "", *table, "", *notes, sep="\n", file=file)
    print("\nVersions: " + ", ".join(" ".join(pair) for pair in versions.items()) + ".", file=file)
    for line in missing:
        print(f"\nMissing: {line}", file=file)
print(*table, *notes, sep="\n")
for line in missing:
    print("missing:", line)
