"""peers_levels.py OUT PROGRAM MESHES - levels of detail by us and by others: nearness, defects.

Writes OUT/levels.md, levels_each.md (every level), levels.json (the same as numbers), levels.jsonl (what was to be reached).

PROGRAM is bitvox. Ours gets the file; the others get it welded (vertices at equal positions merged, triangles with two equal
corners dropped), which is kinder to them than the file. All are measured by levels_judge.py against the file's triangles.

What the others made is kept in OUT/levels by input, version and count, so that a second run measures ours alone.
    BENCH_LEVELS_OPTIONS=...  more options of `bitvox lod`, such as --collapse 4
    BENCH_LEVELS_COMMAND=...  the command itself; with COUNT in place of COUNTS it is called once a level
                              [lod IN -o OUT --triangles COUNTS --threads 1 --samples 0]
    BENCH_LEVELS_ONLY=a,b     inputs whose names contain one of these
"""
import gzip
import hashlib
import importlib.metadata
import io
import json
import os
import shlex
import subprocess
import sys

import numpy as np
import trimesh

import levels_judge
import levels_parts
from levels_peers import PEERS

out, program, meshes = sys.argv[1:4]
folder = os.path.join(out, "levels")
here = os.path.dirname(os.path.abspath(__file__))
only = [word for word in os.environ.get("BENCH_LEVELS_ONLY", "").split(",") if word]
command = os.environ.get("BENCH_LEVELS_COMMAND", "lod IN -o OUT --triangles COUNTS --threads 1 --samples 0")
SHARES = (0.10, 0.03, 0.01)
CAD_SHARE, CAD_FILES = 0.05, ("fandisk", "rocker-arm", "gears", "thingi_72214")
LARGE, LARGE_TARGETS = "dragon_vrip_871414", (27000, 4000)
# Of many parts, with borders, with a bad vertex.
ASSETS = {"stratocaster": 4300, "dungeon": 5000, "terrain_turbineSiting": 5000, "motorBike": 80000, "cow": 2900}
PEER_SECONDS = 900
OURS, SOLID = "bitvox", "the same with `--solid`"
NAMES = (OURS, *PEERS)
MORE = 1.02  # a level with more triangles than this times the count asked for did not reach it
SAME = 1e-4  # percent of the diagonal, about what floats lose: levels within it count as equally near


# ---- inputs ----


def read_file(path):
    """Positions and triangles as they are in the file, larger faces as fans."""
    plain = path[:-3] if path.endswith(".gz") else path
    with (gzip.open if path.endswith(".gz") else open)(path, "rb") as file:
        data = file.read()
    mesh = trimesh.load(io.BytesIO(data), file_type=plain.rsplit(".", 1)[1], process=False, force="mesh")
    return np.asarray(mesh.vertices, dtype=np.float64), np.asarray(mesh.faces, dtype=np.int64)


def write_ply(path, positions, triangles):
    """Binary PLY of floats."""
    head = (
        "ply\nformat binary_little_endian 1.0\n"
        f"element vertex {len(positions)}\nproperty float x\nproperty float y\nproperty float z\n"
        f"element face {len(triangles)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    records = np.zeros(len(triangles), dtype=[("count", "u1"), ("corner", "<i4", 3)])
    records["count"] = 3
    records["corner"] = triangles
    with open(path, "wb") as file:
        file.write(head.encode() + np.ascontiguousarray(positions, dtype="<f4").tobytes() + records.tobytes())


class Input:
    """A mesh, the counts of its levels, and its judge, made when it is first needed."""

    def __init__(self, path):
        self.path = path
        self.name = os.path.basename(path).split(".")[0]
        self.hash = hashlib.sha256(open(path, "rb").read()).hexdigest()[:16]
        self.mesh_file = os.path.join(folder, self.hash + ".npz")
        self.welded_file = os.path.join(folder, self.hash + "_welded.npz")
        if not os.path.exists(self.welded_file):
            self.prepare()
        with np.load(self.mesh_file) as file:
            self.count = len(file["triangles"])
        with np.load(self.welded_file) as file:
            self.middle = file["middle"]
        self.known_judge = None

    def prepare(self):
        """The file's mesh, and the welded one around its middle: floats of far coordinates would cost the others precision."""
        mesh = read_file(self.path)
        np.savez(self.mesh_file, positions=mesh[0], triangles=mesh[1])
        positions, triangles = levels_judge.weld(*mesh)
        middle = (positions.min(axis=0) + positions.max(axis=0)) / 2
        moved = np.ascontiguousarray(positions - middle, dtype=np.float32)
        np.savez(self.welded_file, positions=moved, triangles=triangles.astype(np.uint32), middle=middle)

    def targets(self, shares):
        return [max(4, round(share * self.count)) for share in shares]

    def judge(self):
        if self.known_judge is None:
            with np.load(self.mesh_file) as file:
                self.known_judge = levels_judge.Judge(file["positions"], file["triangles"])
        return self.known_judge

    def shape(self):
        """Defects that the input has already, welded."""

        def measure():
            with np.load(self.mesh_file) as file:
                return levels_judge.shape_of(*levels_judge.weld(file["positions"], file["triangles"]))

        return kept(f"{self.hash}_{judge_version}_shape", measure)


def kept(key, measure):
    """A result from OUT/levels, measured once."""
    path = os.path.join(folder, key.replace(" ", "-") + ".json")
    if os.path.exists(path):
        with open(path) as file:
            return json.load(file)
    value = measure()
    with open(path, "w") as file:
        json.dump(value, file)
    return value


def part_files():
    """The generated parts as files."""
    paths = []
    for make in levels_parts.PARTS:
        path = os.path.join(folder, f"part_{make.__name__}.ply")
        if not os.path.exists(path):
            write_ply(path, *levels_parts.part_mesh(make))
        paths.append(path)
    return paths


# ---- the others ----


def version_of(name):
    return importlib.metadata.version(PEERS[name][0])


def run_peer(name, source, targets):
    """Makes the levels that are not there yet, in a process that may fail."""
    base = os.path.join(folder, f"{source.hash}_{name}_{version_of(name)}".replace(" ", "-"))
    missing = [t for t in targets if not os.path.exists(f"{base}_{t}.npz") and not os.path.exists(f"{base}_{t}.failed")]
    if missing:
        line = [sys.executable, os.path.join(here, "levels_peers.py"), name, source.welded_file, base, *map(str, missing)]
        try:
            done = subprocess.run(line, stderr=subprocess.PIPE, timeout=PEER_SECONDS, text=True)
            reason = done.stderr.strip().splitlines()[-1] if done.stderr.strip() else f"exit status {done.returncode}"
        except subprocess.TimeoutExpired:
            reason = f"not done in {PEER_SECONDS} seconds"
        for target in missing:
            if not os.path.exists(f"{base}_{target}.npz"):
                with open(f"{base}_{target}.failed", "w") as file:
                    file.write(reason)


def peer_level(name, source, target, with_sharp):
    base = f"{source.hash}_{name}_{version_of(name)}_{target}".replace(" ", "-")
    path = os.path.join(folder, base)

    def measure():
        if not os.path.exists(path + ".npz"):
            with open(path + ".failed") as file:
                return {"failed": file.read()}
        with np.load(path + ".npz") as file:
            level = file["positions"].astype(np.float64) + source.middle, file["triangles"]
            return dict(source.judge().measure(*level, with_sharp), ms=float(file["ms"]))

    return kept(f"{base}_{judge_version}{'_sharp' * with_sharp}", measure)


# ---- ours ----


def job_ms(report, level):
    """Milliseconds from arrays to the arrays of a level and those before it: all stages that touch no file."""
    total = 0.0
    for stage in report.get("stages", []):
        if not stage["name"].startswith(("read", "parse", "check", "write", "distance")):
            total += stage["seconds"] * 1e3
        if stage["name"] == f"level {level}":
            break
    return total


def run_ours(source, targets, tag, more=""):
    """One call for all counts; a level that it does not write is tried alone. Returns (path, ms) or a reason for each."""
    made = {}
    chain = "COUNTS" in command.split()
    for group in [targets] * chain + [[t] for t in targets]:
        group = [t for t in group if not isinstance(made.get(t), tuple)]
        if group:
            pattern = os.path.join(folder, f"ours_{source.name}_{tag}_%d.ply")
            call_ours(made, source.path, group, pattern, pattern if chain else pattern % 0, more)
    return made


def call_ours(made, path, group, pattern, result, more):
    for i in range(len(group)):
        if os.path.exists(pattern % i):
            os.remove(pattern % i)
    counts = ",".join(map(str, group))
    words = {"IN": path, "OUT": result, "COUNTS": counts, "COUNT": counts}
    line = [program] + [words.get(word, word) for word in shlex.split(command)]
    line += shlex.split(more + " " + os.environ.get("BENCH_LEVELS_OPTIONS", "")) + ["--json", "--quiet"]
    done = subprocess.run(line, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    try:
        report = json.loads(done.stdout)
    except ValueError:
        report = {}
    for i, target in enumerate(group):
        if os.path.exists(pattern % i):
            final = pattern.replace("%d", f"of_{target}")
            os.replace(pattern % i, final)
            made[target] = (final, job_ms(report, i))
        else:
            error = report.get("error", {})
            made[target] = error.get("message") or done.stderr.strip() or f"exit status {done.returncode}"


def our_level(made, source, with_sharp):
    if not isinstance(made, tuple):
        return {"failed": made}
    return dict(source.judge().measure(*read_file(made[0]), with_sharp), ms=made[1], file=made[0])


def check_judge(source, level):
    """How far `bitvox compare` is from our judge, in percent of the distance."""
    line = [program, "compare", source.path, level["file"], "--samples", "100000", "--json", "--quiet"]
    done = subprocess.run(line, stdout=subprocess.PIPE, text=True)
    found = json.loads(done.stdout)["distance"]
    return (100 * found["mean"] / source.judge().diagonal / level["mean"] - 1) * 100


# ---- one input ----


def measure_input(source, targets, tag, with_sharp=False):
    """Rows {target, triangles, shape, NAME: result} of an input."""
    made = run_ours(source, targets, tag)
    solid = run_ours(source, targets, tag + "_solid", "--solid") if tag == "large" else {}
    for name in available:
        run_peer(name, source, targets)
    rows = []
    for target in targets:
        row = {"input": source.name, "triangles": source.count, "target": target, "set": tag, "shape": source.shape(), "by": {}}
        row["by"][OURS] = our_level(made[target], source, with_sharp)
        if solid:
            row["by"][SOLID] = our_level(solid[target], source, with_sharp)
        for name in available:
            row["by"][name] = peer_level(name, source, target, with_sharp)
        rows.append(row)
    means = "  ".join(f"{row['target']}: " + " ".join(cell(row, name) for name in NAMES) for row in rows)
    print(f"  {source.name:<24} {means}", flush=True)
    return rows


# ---- tables ----


def short(value):
    return "0" if value == 0 else f"{value:.2g}" if value < 0.001 else f"{value:.4f}"


def usable(row, name):
    return "mean" in row["by"].get(name, {})


def reached(row, name):
    return usable(row, name) and row["by"][name]["made"] <= max(MORE * row["target"], row["target"] + 2)


def cell(row, name):
    """The mean distance, a star on the nearest of those that reached the count, a plus where there are more triangles."""
    if not usable(row, name):
        return "failed" if row["by"].get(name) else "-"
    value = row["by"][name]["mean"]
    best = min((row["by"][n]["mean"] for n in NAMES if reached(row, n)), default=0)
    return short(value) + ("*" if reached(row, name) and value == best else "") + ("" if reached(row, name) else "+")


def table(head, rows, file):
    print("\n| " + " | ".join(head) + " |\n|---|" + "--:|" * (len(head) - 1), file=file)
    for row in rows:
        print("| " + " | ".join(str(c) for c in row) + " |", file=file)


def nearer(rows, peer, times=1.0):
    """How often ours is at most so many times as far, with no more triangles than asked for; and of how many. One that keeps more
    triangles than asked for is no nearer level of that count, whoever made it."""
    both = [r for r in rows if usable(r, peer)]
    good = [r for r in both if reached(r, OURS)
            and (not reached(r, peer) or r["by"][OURS]["mean"] <= max(SAME, times * r["by"][peer]["mean"]))]
    return len(good), len(both)


def show_distances(title, rows, file):
    print(f"\n### {title}", file=file)
    table(["two-way mean, % of diagonal", "of", "asked", *NAMES],
          [[r["input"], r["triangles"], r["target"], *(cell(r, n) for n in NAMES)] for r in rows], file)


def show_nearer(titles, file):
    """The closing lines: titles has the rows of each title."""
    print(file=file)
    for peer in available:
        counts = [f"{good} of {both} {title}" for title, (good, both) in ((t, nearer(r, peer)) for t, r in titles.items())]
        stopped = [str(sum(usable(r, peer) and not reached(r, peer) for r in rows)) for rows in titles.values()]
        more = f"; it keeps more triangles than asked for on {', '.join(stopped)}" if any(s != "0" for s in stopped) else ""
        print(f"- nearer than {peer} on {', '.join(counts)}{more}", file=file)


def defects(row, name):
    """What a level has that the input has not: more of each kind of defect."""
    level, shape = row["by"][name], row["shape"]
    return {key: max(0, (level[key] or 0) - (0 if key == "crossing_triangles" else shape[key] or 0)) for key in shape}


def show_sums(title, rows, file):
    """Over all rows: levels with each kind of defect. No times: the others' may be of an earlier run."""
    lines = []
    for name in NAMES:
        good = [r for r in rows if usable(r, name)]
        if not good:
            continue
        found = [defects(r, name) for r in good]
        bad = [sum(d[key] > 0 for d in found) for key in ("nonmanifold_edges", "boundary_edges", "components", "crossing_triangles")]
        more = sum(not reached(r, name) for r in good)
        lines.append([name, len(good), more, *bad, sum(d["crossing_triangles"] for d in found)])
    print(f"\n### {title}", file=file)
    table(["", "levels", "more triangles than asked", "with more non-manifold edges than the input", "more boundary edges",
           "more components", "with crossing triangles", "crossing triangles"], lines, file)


def show_cad(rows, file):
    def values(row, name):
        level = row["by"][name]
        if not usable(row, name):
            return "failed"
        normal = (level["normal_to"] + level["normal_from"]) / 2
        sharp = level.get("sharp_kept")
        return f"{normal:.2f}, " + ("-" if sharp is None else f"{100 * sharp:.0f} %")

    show_distances("Parts at 5 %", rows, file)
    show_nearer({"parts at 5 %": rows}, file)
    good, both = nearer(rows, "meshoptimizer", 1.2)
    print(f"\nAt most 1.2 times as far as meshoptimizer on {good} of {both}.", file=file)
    names = [n for n in NAMES if n == OURS or n in available]
    table(["mean angle of normals in degrees, sharp edges kept", *names],
          [[r["input"], *(values(r, n) for n in names)] for r in rows], file)


def show_first_page(rows, file):
    """The large dragon, a library a row, with our measured surface beside."""
    given = rows[0]["shape"]["crossing_triangles"]
    asked = [f"{r['target']:,}" for r in rows]
    lines = []
    for name in (OURS, SOLID, *available):
        levels = [r["by"][name] for r in rows if usable(r, name)]
        if len(levels) == len(rows):
            keys = ("nonmanifold_edges", "boundary_edges", "crossing_triangles")
            counts = [", ".join(str(level[key]) for level in levels) for key in keys]
            title = f"`bitvox lod --triangles {','.join(str(r['target']) for r in rows)}`" if name == OURS else name
            lines.append([title, *(f"{level['mean']:.4f}" for level in levels), *counts])
    print("\n### The large dragon by each", file=file)
    table(["", *asked, "non-manifold edges", "open edges", f"crossing triangles, of {given} given"], lines, file)


def show_details(rows, file):
    lines = []
    for r in rows:
        shape = r["shape"]
        lines.append([f"{r['input']} {r['target']}", "input, welded", r["triangles"], "", "", "", "", "", shape["nonmanifold_edges"],
                      shape["boundary_edges"], shape["components"], shape["crossing_triangles"], ""])
        for name in NAMES:
            level = r["by"].get(name, {"failed": "missing"})
            if not usable(r, name):
                lines.append(["", name, "failed: " + level.get("failed", "")[:60]] + [""] * 10)
                continue
            normal = (level["normal_to"] + level["normal_from"]) / 2
            lines.append(["", name, f"{level['made']}{'' if reached(r, name) else '+'}", *(short(level[k]) for k in
                          ("mean", "to_input", "from_input", "max")), f"{normal:.2f}", level["nonmanifold_edges"],
                          level["boundary_edges"], level["components"], level["crossing_triangles"], f"{level['ms']:.1f}"])
    table(["level", "by", "triangles", "mean", "to input", "from input", "max", "normals", "non-manifold edges", "boundary edges",
           "components", "crossing", "ms"], lines, file)


def write_tables(sets, off, file):
    """Everything but the single levels."""
    print("Distances of surfaces in percent of the diagonal of the input's bounds: mean of both ways' means, "
          f"{levels_judge.SAMPLES:,} points each way. A star: the nearest of those that reach the count; a plus: more triangles than "
          "asked for, so the distance says little. Others get the welded mesh.", file=file)
    for share in SHARES:
        if sets[share]:
            show_distances(f"Real meshes at {100 * share:.0f} %", sets[share], file)
    show_nearer({f"at {100 * share:.0f} %": sets[share] for share in SHARES}, file)
    if sets["large"]:
        show_distances("The large dragon", sets["large"], file)
        show_first_page(sets["large"], file)
    if sets["asset"]:
        show_distances("Assets of many parts, with borders and bad vertices", sets["asset"], file)
    if sets["cad"]:
        show_cad(sets["cad"], file)
    show_sums("Defects, real meshes", sum((sets[s] for s in SHARES), []), file)
    show_sums("Defects, the large dragon and parts", sets["large"] + sets["cad"], file)
    if off:
        print(f"\n`bitvox compare` agrees with these distances within {max(map(abs, off)):.1f} % on {len(off)} levels.", file=file)
    print("\nVersions: " + ", ".join(f"{n} {version_of(n)}" for n in available) + ".", file=file)


def write_targets(sets, file):
    """What is to be reached, for report.py; only what a complete run has measured."""

    def say(title, value, unit, target, below):
        print(json.dumps({"title": title, "value": value, "unit": unit, "target": target, "below": below}), file=file)

    for row, goal in zip(sets["large"], (0.0115, 0.054)):
        if usable(row, OURS):
            say(f"levels: large dragon to {row['target']:,}", row["by"][OURS]["mean"], "% of the diagonal", goal, True)
    for share in SHARES:
        count = nearer(sets[share], "meshoptimizer")[0]
        say(f"levels: meshes nearer than by meshoptimizer at {100 * share:.0f} %", count, "meshes", 17, False)
    parts = nearer(sets["cad"], "meshoptimizer", 1.2)
    say("levels: parts at most 1.2 times as far as by meshoptimizer at 5 %", parts[0], "parts", parts[1], False)


# ---- main ----


def wanted(path):
    return not only or any(word in os.path.basename(path) for word in only)


def find_inputs():
    """Shared meshes, the smallest first, and generated parts."""
    if not os.path.isdir(meshes):
        print(f"levels: {meshes} is missing; MESHES=FOLDER says where it is")
        return [], []
    files = [os.path.join(meshes, f) for f in sorted(os.listdir(meshes)) if ".".join(f.split(".")[1:]) not in ("md", "txt")]
    real = sorted((Input(f) for f in files if wanted(f)), key=lambda source: source.count)
    return real, [Input(f) for f in part_files() if wanted(f)]


def jobs_of(real, parts):
    """Inputs with their counts, each a set of rows."""
    for source in real:
        counts = source.targets(SHARES)
        yield source, counts, "share"
        if source.name in CAD_FILES:
            yield source, source.targets([CAD_SHARE]), "cad"
        if source.name in ASSETS:
            yield source, [ASSETS[source.name]], "asset"
        if source.name == LARGE:
            yield source, list(LARGE_TARGETS), "large"
    for source in parts:
        yield source, source.targets([CAD_SHARE]), "cad"


def measure_all(jobs):
    sets = {share: [] for share in SHARES} | {"large": [], "cad": [], "asset": []}
    off = []
    for source, counts, tag in jobs:
        rows = measure_input(source, counts, tag, tag == "cad")
        if tag == "share":
            for share, row in zip(SHARES, rows):
                sets[share].append(row)
            if usable(rows[0], OURS):
                off.append(check_judge(source, rows[0]["by"][OURS]))
        else:
            sets[tag] += rows
    return sets, off


def main():
    real, parts = find_inputs()
    if not real and not parts:
        return
    print("  mean distances by " + ", ".join(NAMES), flush=True)
    sets, off = measure_all(jobs_of(real, parts))

    with open(os.path.join(out, "levels.json"), "w") as file:
        json.dump({"sets": {str(k): v for k, v in sets.items()}, "compare_off": off}, file, indent=1)
    with open(os.path.join(out, "levels.md"), "w") as file:
        write_tables(sets, off, file)
    with open(os.path.join(out, "levels_each.md"), "w") as file:
        show_details(sum(sets.values(), []), file)
    if not only and "meshoptimizer" in available:
        with open(os.path.join(out, "levels.jsonl"), "w") as file:
            write_targets(sets, file)


def installed(name):
    try:
        version_of(name)
        return True
    except importlib.metadata.PackageNotFoundError:
        print(f"  missing: {PEERS[name][0]}")
        return False


os.makedirs(folder, exist_ok=True)
available = [name for name in PEERS if installed(name)]
judge_version = hashlib.sha256(open(levels_judge.__file__, "rb").read()).hexdigest()[:8]
main()
