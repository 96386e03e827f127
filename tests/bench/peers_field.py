"""peers_field.py OUT BENCH_FIELD MESHES - distance fields and repair by other libraries.

Writes OUT/peers_field.md and OUT/peers_field.jsonl (targets). The dragon of 871,414 triangles at 256 and a band of three voxels;
the bunny's scan of 69,451 triangles. Arrays are in memory in the form that each library wants before the clock starts; jobs run
once without being counted, but for slow ones, which run once in all, and pymeshfix, whose first run is its fastest. Ours and theirs
take turns (the program BENCH_FIELD does one run of ours on demand). One thread: processor time of a process held on one processor;
two: time of day. OpenVDB is measured by a small C++ program when the compiler finds its headers (Debian: libopenvdb-dev,
libboost-dev; BENCH_VDB_FLAGS: more flags for the compiler).

    peers_field.py worker OUT NAME THREADS   one job for each line of standard input: milliseconds and what it counted
"""
import importlib.metadata
import os
import statistics
import subprocess
import sys
import time

import numpy as np

VDB = r"""
#include <openvdb/openvdb.h>
#include <openvdb/tools/MeshToVolume.h>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <iostream>
#include <string>
#include <vector>
template <class T> static std::vector<T> values(const std::string &path)
{
    FILE *file = std::fopen(path.c_str(), "rb");
    if (file == nullptr) std::exit(1);
    std::fseek(file, 0, SEEK_END);
    std::vector<T> all(std::ftell(file) / sizeof(T));
    std::rewind(file);
    if (std::fread(all.data(), sizeof(T), all.size(), file) != all.size()) std::exit(1);
    std::fclose(file);
    return all;
}
static double now(int threads)
{
    if (threads == 1) {
        timespec t;
        clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
        return t.tv_sec * 1e3 + t.tv_nsec * 1e-6;
    }
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch()).count();
}
int main(int, char **argv)
{
    const std::string out = argv[1];
    const int threads = std::atoi(argv[2]);
    const double voxel = std::atof(argv[3]);
    openvdb::initialize();
    const auto p = values<double>(out + "/field_dragon.points");
    const auto t = values<std::uint32_t>(out + "/field_dragon.triangles");
    std::vector<openvdb::Vec3s> points;
    std::vector<openvdb::Vec3I> triangles;
    for (std::size_t i = 0; i < p.size(); i += 3) points.emplace_back(float(p[i]), float(p[i + 1]), float(p[i + 2]));
    for (std::size_t i = 0; i < t.size(); i += 3) triangles.emplace_back(t[i], t[i + 1], t[i + 2]);
    const auto transform = openvdb::math::Transform::createLinearTransform(voxel);
    std::printf("ready %s\n", OPENVDB_LIBRARY_VERSION_STRING);
    std::fflush(stdout);
    for (std::string line; std::getline(std::cin, line);) {
        const double start = now(threads);
        const auto grid = openvdb::tools::meshToLevelSet<openvdb::FloatGrid>(*transform, points, triangles, 3.0f);
        const double ms = now(threads) - start;
        std::printf("%.3f %llu\n", ms, static_cast<unsigned long long>(grid->activeVoxelCount()));
        std::fflush(stdout);
    }
}
"""


def load(out, name, kind, type):
    return np.fromfile(os.path.join(out, f"field_{name}.{kind}"), dtype=type)


def model(out, name):
    return load(out, name, "points", np.float64).reshape(-1, 3), load(out, name, "triangles", np.uint32).reshape(-1, 3)


# ---- their jobs: each returns (package, job, what to say of its result) ----


def frame():
    """Spacing and origin of our lattice and its dims, from the command line."""
    word = [float(w) for w in sys.argv[5:]]
    return word[0], np.array(word[1:4]), np.array(word[4:7], dtype=int)


def centres(out):
    spacing, origin, _ = frame()
    return origin + (load(out, "dragon", "places", np.int32).reshape(-1, 3) + 0.5) * spacing


def agreement(out, distances):
    """How far their distances lie from ours, in voxels, and how many signs differ."""
    ours = load(out, "dragon", "distances", np.float32).astype(np.float64)
    off = np.abs(np.abs(ours) - np.abs(distances)).max() / frame()[0]
    signs = int(((ours < 0) != (distances < 0)).sum())
    return f"{len(ours):,} distances: at most {off:.1e} voxel off ours, {signs:,} signs differ"


def meshlib_field(out):
    from meshlib import mrmeshnumpy, mrmeshpy

    points, triangles = model(out, "dragon")
    mesh = mrmeshnumpy.meshFromFacesVerts(triangles.astype(np.int32), points)
    holes = mesh.topology.findHoleRepresentiveEdges()  # it wants a closed mesh: that is done before the clock starts
    mrmeshpy.fillHoles(mesh, holes)
    o = mrmeshpy.MeshToVolumeParams()
    o.type = mrmeshpy.MeshToVolumeParams.Type.Signed
    o.surfaceOffset = 3
    o.voxelSize = mrmeshpy.Vector3f(*[frame()[0]] * 3)
    say = lambda volume: f"{len(holes)} holes closed before; {volume.dims.x} x {volume.dims.y} x {volume.dims.z}"
    return "meshlib", lambda: mrmeshpy.meshToVolume(mesh, o), say


def mesh2sdf_field(out):
    import mesh2sdf

    points, triangles = model(out, "dragon")
    low, high = points.min(axis=0), points.max(axis=0)
    points = (points - (low + high) / 2) / ((high - low).max() / 2) * (256 / 264)
    return "mesh2sdf", lambda: mesh2sdf.compute(points, triangles, 264), lambda sdf: f"{sdf.size:,} values"


def igl_field(out):
    import igl

    points, triangles = model(out, "dragon")
    triangles, places = triangles.astype(np.int64), centres(out)
    return "libigl", lambda: igl.signed_distance(places, points, triangles), lambda r: agreement(out, r[0])


def open3d_field(out):
    import open3d

    points, triangles = model(out, "dragon")
    points, places = (open3d.core.Tensor(a.astype(np.float32)) for a in (points, centres(out)))
    triangles = open3d.core.Tensor(triangles)

    def job():
        scene = open3d.t.geometry.RaycastingScene()
        scene.add_triangles(points, triangles)
        return scene.compute_signed_distance(places).numpy()

    return "open3d", job, lambda distances: agreement(out, distances.astype(np.float64))


def keep(out, name, points, triangles):
    np.asarray(points, dtype=np.float32).tofile(os.path.join(out, f"field_{name}.points"))
    np.asarray(triangles, dtype=np.uint32).tofile(os.path.join(out, f"field_{name}.triangles"))
    return f"{len(triangles):,} triangles"


def pymeshfix_repair(out):
    import pymeshfix

    points, triangles = model(out, "bunny")
    triangles = triangles.astype(np.int32)

    def job():
        fix = pymeshfix.MeshFix(points, triangles)
        fix.repair()
        return fix.points, fix.faces

    return "pymeshfix", job, lambda mesh: keep(out, "pymeshfix_repair", *mesh)


def meshlib_repair(out):
    from meshlib import mrmeshnumpy, mrmeshpy

    points, triangles = model(out, "bunny")
    triangles = triangles.astype(np.int32)

    def job():
        mesh = mrmeshnumpy.meshFromFacesVerts(triangles, points)
        mrmeshpy.fillHoles(mesh, mesh.topology.findHoleRepresentiveEdges())
        mesh.pack()
        return mrmeshnumpy.getNumpyVerts(mesh), mrmeshnumpy.getNumpyFaces(mesh.topology)

    return "meshlib", job, lambda mesh: keep(out, "meshlib_repair", *mesh)


def work(out, name, threads):
    clock = time.process_time if threads == 1 else time.perf_counter
    package, job, say = globals()[name](out)
    print("ready", package, importlib.metadata.version(package), flush=True)
    for _ in sys.stdin:
        start = clock()
        result = job()
        ms = (clock() - start) * 1e3
        print(f"{ms:.3f} {say(result)}", flush=True)


if sys.argv[1] == "worker":
    work(sys.argv[2], sys.argv[3], int(sys.argv[4]))
    sys.exit(0)

# ---- ours and theirs in turns ----

out, program, meshes = sys.argv[1:4]
runs = int(os.environ.get("BENCH_PEER_RUNS", "5"))
processors = sorted(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else []


class Program:
    """A program that answers each line with a line."""

    def __init__(self, command, hold=False):
        pin = (lambda: os.sched_setaffinity(0, processors[-1:])) if hold and processors else None
        with open(os.path.join(out, "peers_field.log"), "a") as log:
            self.process = subprocess.Popen(
                [str(c) for c in command], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=log, text=True, preexec_fn=pin
            )
        self.greeting = self.answer("ready")

    def answer(self, first=""):
        """Libraries print messages too: lines of theirs are passed over."""
        for line in self.process.stdout:
            if (first and line.startswith(first)) or (not first and line[:1].isdigit()):
                return line.split(maxsplit=1)[1].strip() if first else line.strip()
        raise RuntimeError("no answer, see peers_field.log")

    def ask(self, line=""):
        self.process.stdin.write(line + "\n")
        self.process.stdin.flush()
        ms, rest = self.answer().split(maxsplit=1)
        return float(ms), rest

    def close(self):
        self.process.stdin.close()
        self.process.wait()


turns = Program([program, "turns", meshes, out])
lattice = turns.greeting.split()
rows, missing, versions, targets = [], [], {}, []


def compile_vdb():
    source, binary = os.path.join(out, "vdb_field.cpp"), os.path.join(out, "vdb_field")
    with open(source, "w") as file:
        file.write(VDB)
    flags = os.environ.get("BENCH_VDB_FLAGS", "").split()
    command = [os.environ.get("CXX", "c++"), "-O2", "-DNDEBUG", "-std=c++17", source, "-o", binary, *flags, "-lopenvdb", "-ltbb"]
    found = subprocess.run(command, capture_output=True, text=True)
    if found.returncode != 0:
        raise RuntimeError(next((s for s in found.stderr.splitlines() if "error" in s), "it does not compile"))
    return binary


def show(times):
    return f"{min(times):.0f} ({statistics.median(times):.0f})"


def start(name, threads):
    if name == "vdb":
        return Program([os.path.join(out, "vdb_field"), out, threads, lattice[0]], threads == 1)
    return Program([sys.executable, __file__, "worker", out, name, threads, *lattice], threads == 1)


def measure(job, title, name, threads, times=runs, target=None, fresh=False):
    """fresh: a new process for each run, for a library whose first run is its fastest."""
    peer = None
    theirs, ours = [], []
    try:
        turns.ask(f"{job} {threads}")
        for run in range(times):
            if peer is None or fresh:
                if peer:
                    peer.close()
                peer = start(name, threads)
                if not fresh and times > 1:
                    peer.ask()
            ours += [turns.ask(f"{job} {threads}")[0] for _ in range(3)]
            ms, said = peer.ask()
            theirs.append(ms)
        package, _, version = ("OpenVDB " + peer.greeting if name == "vdb" else peer.greeting).rpartition(" ")
        versions[package] = version
    except Exception as reason:
        missing.append(f"{title}, {threads} threads: {reason}")
        return
    finally:
        if peer:
            peer.close()
    ratio = min(theirs) / min(ours)
    if name == "vdb":
        said = f"{int(said):,} active voxels"
    rows.append(f"| {job} | {threads} | {show(ours)} | {title} | {show(theirs)} | {ratio:.2f} | {target or ''} | {said} |")
    print(rows[-1], flush=True)
    if target:
        line = f'{{"title": "{job}, {threads} thread{"s" * (threads > 1)} : {title}", "value": {ratio:.4g}, "unit": "times", '
        targets.append(line + f'"target": {target}, "below": false}}')


open(os.path.join(out, "peers_field.log"), "w").close()
try:
    compile_vdb()
    vdb = True
except (OSError, RuntimeError) as reason:
    vdb = False
    missing.append(f"OpenVDB: {reason}")
for threads in (1, 2):
    measure("field", "MeshLib meshToVolume", "meshlib_field", threads, target=10 if threads == 2 else None)
    if vdb:
        measure("field", "OpenVDB meshToLevelSet", "vdb", threads, target=15 if threads == 1 else None)
measure("repair", "pymeshfix", "pymeshfix_repair", 1, target=8, fresh=True)
measure("repair", "MeshLib fillHoles", "meshlib_repair", 1)
measure("field", "Open3D compute_signed_distance", "open3d_field", 1, 1)
measure("field", "libigl signed_distance", "igl_field", 1, 1)
measure("field", "mesh2sdf", "mesh2sdf_field", 1, 1)
turns.close()

# ---- what others say of the repaired meshes ----


def judge(name, title):
    if not os.path.exists(os.path.join(out, f"field_{name}.points")):
        return None
    points = load(out, name, "points", np.float32).reshape(-1, 3)
    triangles = load(out, name, "triangles", np.uint32).reshape(-1, 3)
    said = [title, f"{len(triangles):,}"]
    try:
        import trimesh

        body = trimesh.Trimesh(points.astype(np.float64), triangles, process=False)
        said += ["yes" if body.is_volume else "NO", f"{body.volume:.6g}"]
    except Exception as reason:
        said += [f"missing: {reason!r}", ""]
    try:
        import manifold3d

        solid = manifold3d.Manifold(manifold3d.Mesh(points, triangles))
        said += [str(solid.status()).rpartition(".")[2], f"{solid.num_tri():,}"]
    except Exception as reason:
        said += [f"missing: {reason!r}", ""]
    return "| " + " | ".join(said) + " |"


names = (("repaired", "ours"), ("pymeshfix_repair", "pymeshfix"), ("meshlib_repair", "MeshLib fillHoles"))
judged = [line for line in (judge(*pair) for pair in names) if line]
with open(os.path.join(out, "peers_field.jsonl"), "w") as file:
    print(*targets, sep="\n", file=file)
with open(os.path.join(out, "peers_field.md"), "w") as file:
    print("| job | threads | ours, ms | beside | ms | times ours | target | their result |", file=file)
    print("|---|--:|--:|---|--:|--:|--:|---|", file=file)
    print(*rows, sep="\n", file=file)
    print("\n| repaired by | triangles | trimesh is_volume | its volume | manifold3d status | its triangles |", file=file)
    print("|---|--:|---|--:|---|--:|", file=file)
    print(*judged, sep="\n", file=file)
    print("\nVersions: " + ", ".join(" ".join(pair) for pair in versions.items()) + ".", file=file)
    for line in missing:
        print(f"\nMissing: {line}", file=file)
print(*judged, sep="\n")
for line in missing:
    print("missing:", line)
