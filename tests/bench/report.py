"""report.py - puts what was measured beside what was to be reached: FOLDER/report.md, and FOLDER/report.json for pages (page.py).

    report.py FOLDER

Needs nothing but Python. Ratios are peer's time : our time, so larger is better; a target is a ratio, a time in
milliseconds or a distance in percent.
"""
import datetime
import json
import os
import platform
import re
import subprocess
import sys

folder = sys.argv[1]


def path(name):
    return os.path.join(folder, name)


def load_json(name, default):
    if not os.path.exists(path(name)):
        return default
    with open(path(name)) as file:
        return json.load(file)


def load_lines(name):
    if not os.path.exists(path(name)):
        return []
    with open(path(name)) as file:
        return [json.loads(line) for line in file if line.startswith("{")]


core = load_json("core.json", {})
peers = load_json("peers.json", {"times": {}, "missing": {"all": "not measured"}, "levels": {}, "checks": {}})
ours = load_lines("ours.jsonl")
judged = load_lines("judged.jsonl")
second = peers.get("second_judge", {})
with open(path("load")) as file:
    loads = file.read().split()
out = []


def say(*lines):
    out.extend(lines)


def verdict(value, target, below=False):
    """A value beside its target, and by how much it is missed."""
    good = value <= target if below else value >= target
    if good:
        return "reached"
    return f"missed by {abs(value - target) / target * 100:.0f} %"


def table(head, rows):
    say("", "| " + " | ".join(head) + " |", "|---|" + "--:|" * (len(head) - 1))
    for row in rows:
        say("| " + " | ".join(str(cell) for cell in row) + " |")


def ms(times):
    return f"{times['min']:.2f} ({times['median']:.2f})"


def noise(threads):
    """How far medians lie above the least, in percent."""
    times = [core[stage][f"{code}_{threads}"] for stage in ("solid", "surface", "job") for code in ("portable", "best")]
    return (sum(t["median"] / t["min"] for t in times) / len(times) - 1) * 100


# ---- speed ----

say("# Measurements", "")
say(
    f"Mesh of {core['triangles']:,} triangles, {core['runs']} runs of ours. Milliseconds are the least of all runs, medians in"
    " brackets. One thread: processor time; two: time of day. Ratios are the other's time : ours."
)
say(
    f"The machine's load was {loads[0]} before and {loads[-1]} after; medians lie {noise(1):.0f} % above the least with"
    f" one thread, {noise(2):.0f} % with two."
    + (" Others were at work on it: two-thread figures say little." if noise(2) > 40 else "")
)

base = core["solid"]["baseline"]["min"]
best, portable = core["solid"]["best_1"], core["solid"]["portable_1"]
rows = []
for title, t in (("solid 512, default build", best), ("the same, portable code", portable)):
    ratio = base / t["min"]
    rows.append((title, ms(t), "parity loop", ms(core["solid"]["baseline"]), f"{ratio:.2f}", "2", verdict(ratio, 2)))
rows.append(
    ("solid 512, fast kernels", ms(best), "", "", "", "12 ms", verdict(best["min"], 12, True))
)
told = core["told"]["best_1"]
ratio = told["min"] / best["min"]
rows.append(("the same with its report", ms(told), "without", ms(best), f"{ratio:.2f}", "at most 2.5", verdict(ratio, 2.5, True)))
wanted = {"vtkFlyingEdges3D, 1": 10, "vtkFlyingEdges3D, 2": None, "skimage.measure.marching_cubes, 1": 60}
jobs = {"solid": "solid 512", "surface": "its surface"}
for name, t in peers["times"].items():
    ratio = t["peer"]["min"] / t["ours"]["min"]
    target = wanted.get(name)
    rows.append(
        (
            f"{jobs[t['job'][0]]}, {t['job'][1]} thread{'s' * (t['job'][1] > 1)}",
            ms(t["ours"]),
            name.rsplit(",", 1)[0],
            ms(t["peer"]),
            f"{ratio:.1f}",
            target or "beside",
            verdict(ratio, target) if target else "",
        )
    )
surface, job = core["surface"]["best_1"], core["job"]["best_1"]
title = f"surface, {core['surface_triangles']:,} triangles"
rows.append((title, ms(surface), "", "", "", "15 ms", verdict(surface["min"], 15, True)))
for name, t in peers["levels"].items():
    ratio = t["one"]["min"] / t["ours_job"]["min"]
    due = name.startswith("vtkBinned") or "sloppy" in name
    rows.append(
        (
            f"main job: four levels, {t['threads']} thread{'s' * (t['threads'] > 1)}",
            ms(t["ours_job"]),
            f"{name}, one level",
            ms(t["one"]),
            f"{ratio:.2f}",
            "1" if due else "beside",
            verdict(ratio, 1) if due else "",
        )
    )
    ratio = t["four"]["min"] / t["ours_job"]["min"]
    rows.append(("main job: four levels", ms(t["ours_job"]), f"{name}, four levels", ms(t["four"]), f"{ratio:.2f}", "beside", ""))
rows.append(("main job, one thread", ms(job), "", "", "", "16.7 ms", verdict(job["min"], 16.7, True)))
for name, title in (("solid", "solid 512"), ("surface", "surface"), ("job", "main job")):
    one, two = core[name]["best_1"], core[name]["best_2"]
    ratio = one["min"] / two["min"]
    rows.append((f"{title}, two threads", ms(two), "one thread", ms(one), f"{ratio:.2f}", "1.6", verdict(ratio, 1.6)))
say("", "## Speed")
table(("ours", "ms", "beside", "ms", "ratio", "target", ""), rows)

parts = core["parts"]
pieces = [f"lattice {parts['lattice']:.2f}", f"solid {parts['solid']:.2f}"] + [f"level {t:.2f}" for t in parts["levels"]]
say("", "Main job, one thread: " + ", ".join(pieces) + " ms.")
whole = sum(core["phases"].values())
pieces = [f"{k} {v:.2f} ms ({100 * v / whole:.0f} %)" for k, v in core["phases"].items() if v > 0]
say("", "Phases at 512, one thread: " + ", ".join(pieces) + ".")
say(
    "",
    f"Results: {core['voxels']:,} voxels; the parity loop differs in {core['baseline_differs']}; "
    + "; ".join(f"{k}: {', '.join(f'{a} {b:,.0f}' for a, b in v.items())}" for k, v in peers["checks"].items())
    + ".",
)
say(
    "",
    "Every mesh of ours closed, manifold and oriented; same bytes from portable and fast code, one and two threads: "
    + ("yes." if core["good"] else "NO."),
)

# ---- memory ----

say("", "## Memory of voxelize and extract at 512")
rows = []
for n in (1, 2):
    peak, bound = core["memory"][f"peak_{n}"], core["memory"][f"bound_{n}"]
    rows.append((f"{n} thread{'s' * (n > 1)}", f"{peak / 2**20:.2f}", f"{bound / 2**20:.2f}", verdict(peak, bound, True)))
table(("", "peak with the input's view, MiB", "bound, MiB", ""), rows)

# ---- quality ----

say(
    "",
    "## Levels of detail: distance to the original",
    "",
    "Percent of the diagonal of the original's bounds, 200,000 samples a way. Two-way is the mean of both ways' means. Normals:"
    " mean of 1 - cos between facets. Defects: boundary, non-manifold and flipped edges, non-manifold vertices, after vertices at"
    " equal places are joined.",
)
goals = {27000: 0.043, 4000: 0.217}


def quality_row(row, name, goal):
    defects = sum(row[k] for k in ("boundary_edges", "nonmanifold_edges", "flipped_edges", "nonmanifold_vertices"))
    return (
        name,
        f"{row['triangles']:,}",
        f"{row['two_way']:.4f}",
        f"{row['to_original']:.4f}",
        f"{row['from_original']:.4f}",
        f"{row['max']:.2f}",
        f"{row['normal_to']:.4f}, {row['normal_from']:.4f}",
        f"{row['volume']:.2f}",
        defects or "none",
        verdict(row["two_way"], goal, True) if name.startswith("ours") else "",
    )


for target, goal in goals.items():
    say("", f"About {target:,} triangles; to be better than {goal} % two-way")
    rows = [quality_row(r, f"{r['name']} (ratio {r['ratio']:.1f}, {r['ms']:.0f} ms)", goal) for r in ours if r["target"] == target]
    end = f"_{target}.ply"
    rows += [quality_row(r, r["name"][: -len(end)].replace("_", " "), goal) for r in judged if r["name"].endswith(end)]
    table(("", "triangles", "two-way", "to", "from", "max", "normals", "volume %", "defects", ""), rows)

if second:
    pairs = []
    for row in judged:
        pairs.append((row["name"], row["two_way"]))
    for row in ours:
        if row["shown"]:
            pairs.append((f"{row['shown']}_{row['target']}.ply", row["two_way"]))
    off = [abs(second[n] / v - 1) * 100 for n, v in pairs if n in second and v > 0]
    if off:
        say("", f"A second judge (Open3D's distances, samples of its own) agrees within {max(off):.1f} % on {len(off)} meshes.")

# ---- the paper, what is missing ----

texts = {"speed": "\n".join(out)}
tables = (
    ("files.md", "Files"),
    ("voxels.md", "Surfaces of voxels, fills, the TIN paper's tables"),
    ("peers_voxels.md", "Surfaces of voxels by others"),
    ("fills.md", "Fills beside winding numbers"),
    ("refine.md", "Refinement, and its paper's tables"),
    ("field.md", "Distance fields and repair"),
    ("peers_field.md", "Distance fields and repair by others"),
    ("defects.md", "Repair of shapes that were spoilt"),
    ("grids.md", "Grids: set algebra, booleans of meshes"),
    ("peers_grids.md", "Grids by others"),
    ("morph.md", "Morphology and distances of grids"),
    ("volumes.md", "Scalar volumes"),
    ("labels.md", "Surfaces of labels"),
    ("makers.md", "Hulls, levels that enclose, mass, what can be made"),
    ("peers_makers.md", "Levels that enclose by others"),
    ("components.md", "Parts of grids"),
    ("peers_components.md", "Parts of grids by others"),
    ("peers_morph.md", "Morphology by others"),
    ("step.md", "The repair paper's experiment"),
    ("levels.md", "Levels of detail by others"),
    ("levels_time.md", "Time of levels of the large dragon"),
    ("sections.md", "Bodies from sections"),
    ("planes.md", "Bodies from planes of any direction, by others"),
    ("paper.md", "The LOD paper's tables"),
)
if any(os.path.exists(path(name)) for name, _ in tables):
    rows = []
    for t in sum((load_lines(name + ".jsonl") for name in ("voxels", "refine", "field", "peers_field", "grids", "peers_grids", "levels")), []):
        bound = "at most" if t["below"] else "at least"
        rows.append((t["title"], f"{t['value']:.3g} {t['unit']}", f"{bound} {t['target']:g}", verdict(t["value"], t["target"], t["below"])))
    say("", "## Voxels, fields, repair, grids and levels: targets")
    table(("", "measured", "target", ""), rows)
for name, title in tables:
    if os.path.exists(path(name)):
        say("", "## " + title, "")
        with open(path(name), encoding="utf-8") as file:
            texts[name.removesuffix(".md")] = file.read().rstrip()
        say(texts[name.removesuffix(".md")])
if peers.get("versions"):
    say("", "Versions: " + ", ".join(f"{k} {v}" for k, v in peers["versions"].items()) + ".")
if peers["missing"]:
    say("", "## Missing", "")
    say(*(f"- {k}: {v}" for k, v in peers["missing"].items()))



# ---- the run, for pages ----


def first_line(*command):
    try:
        return subprocess.run(command, capture_output=True, text=True, check=True).stdout.splitlines()[0]
    except (OSError, subprocess.CalledProcessError, IndexError):
        return "unknown"


def processor():
    try:
        with open("/proc/cpuinfo") as file:
            return re.search(r"model name\s*: (.*)", file.read())[1]
    except (OSError, TypeError):
        return platform.machine()


about = {
    "processor": f"{processor()}, {os.cpu_count()} processors",
    "compiler": first_line(os.environ.get("CC", "cc"), "--version"),
    "system": platform.system() + " " + platform.machine(),
    "date": datetime.date.today().isoformat(),
    "load before and after": f"{loads[0]}, {loads[-1]}",
    "others of the first table": ", ".join(f"{k} {v}" for k, v in peers.get("versions", {}).items()) or "none",
    "missing": "; ".join(f"{k}: {v}" for k, v in peers["missing"].items()) or "none",
}
texts["run"] = "\n".join(["| the run | |", "|---|---|"] + [f"| {k} | {v} |" for k, v in about.items()])
with open(path("report.md"), "w", encoding="utf-8") as file:
    file.write("\n".join(out) + "\n")
with open(path("report.json"), "w", encoding="utf-8") as file:
    rows = {"core": core, "quality": ours, "judged": judged, "peers": peers}
    json.dump({"about": about, "texts": texts, "rows": rows}, file, indent=1)
    file.write("\n")
