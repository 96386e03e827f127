"""peers_fills.py OUT PROGRAM MESHES - fills beside libigl's winding numbers, and ground beside sums of columns; writes
OUT/fills.md.

PROGRAM is bitvox. Centres of a lattice of 256: igl.fast_winding_number for all of them (one half of a turn and more is inside);
the exact igl.winding_number replaces it within 0.1 of one half, where a rule differs from it, and at BENCH_EXACT [2000] centres
near the surface that are drawn by lot, which tell how far off the fast one is. A row is a line of centres along x, y or z.
Columns of ground are summed here in doubles, from each triangle's plane, by nothing of ours."""
import gzip
import json
import os
import subprocess
import sys
import time

import numpy as np

try:
    import igl
except ImportError:
    igl = None

out, program, meshes = sys.argv[1:4]
folder = os.path.join(out, "fills")
os.makedirs(folder, exist_ok=True)
by_lot = int(os.environ.get("BENCH_EXACT", "2000"))
limit_share, limit_row = 1e-4, 8


def plain_file(name):
    """The mesh as a file that is not packed."""
    path = os.path.join(folder, name)
    if not os.path.exists(path):
        with gzip.open(os.path.join(meshes, name + ".gz")) as packed, open(path, "wb") as file:
            file.write(packed.read())
    return path


def voxelize(path, *options):
    """The grid with axes x, y, z, and the program's report; (None, report) where a rule refuses."""
    result = os.path.join(folder, "grid.npy")
    done = subprocess.run([program, "voxelize", path, "-o", result, "--json", "--quiet", *options], stdout=subprocess.PIPE)
    report = json.loads(done.stdout)
    return (np.load(result) if done.returncode == 0 else None), report


def centres(lattice, index):
    return np.array(lattice["origin"]) + (index + 0.5) * np.array(lattice["spacing"])


# ---- Winding numbers ----


def exact_numbers(mesh, lattice, winding, where):
    index = np.argwhere(where)
    if len(index):
        numbers = np.asarray(igl.winding_number(*mesh, np.ascontiguousarray(centres(lattice, index)))).ravel()
        winding[tuple(index.T)] = numbers
    return len(index)


def near_surface(inside):
    """Centres with another one within two voxels along an axis that lies on the other side."""
    near = np.zeros_like(inside)
    for axis in range(3):
        for by in (1, 2):
            a = np.moveaxis(inside, axis, 0)
            n = np.moveaxis(near, axis, 0)
            differ = a[by:] != a[:-by]
            n[by:] |= differ
            n[:-by] |= differ
    return near


def winding_numbers(path, lattice, grids):
    mesh = [np.ascontiguousarray(a, dtype=t) for a, t in zip(igl.read_triangle_mesh(path), (np.float64, np.int64))]
    index = np.indices(lattice["dims"]).reshape(3, -1).T
    start = time.perf_counter()
    fast = np.asarray(igl.fast_winding_number(*mesh, centres(lattice, index))).reshape(lattice["dims"])
    seconds = time.perf_counter() - start
    winding = fast.copy()
    done = np.abs(np.abs(fast) - 0.5) < 0.1
    for grid in grids:
        done |= grid != (np.abs(fast) > 0.5)
    exact = exact_numbers(mesh, lattice, winding, done)
    near = np.argwhere(near_surface(grids[0]) & ~done)
    lot = np.zeros_like(done)
    lot[tuple(near[np.random.default_rng(4).permutation(len(near))[:by_lot]].T)] = True
    exact += exact_numbers(mesh, lattice, winding, lot)
    off = float(np.abs(winding - fast)[lot].max()) if lot.any() else 0.0
    return winding, {"seconds": seconds, "exact": exact, "off": off}


def show_rules(name, file):
    path = plain_file(name)
    rules = {rule: voxelize(path, "--fill", rule, "--threads", "1") for rule in ("vote", "regions", "parity")}
    lattice = rules["vote"][1]["lattice"]
    winding, note = winding_numbers(path, lattice, [grid for grid, _ in rules.values()])
    inside = np.abs(winding) > 0.5
    holds = True
    for rule, (grid, report) in rules.items():
        wrong = grid != inside
        worst = [int(wrong.sum(axis=axis).max()) for axis in range(3)]
        share = wrong.sum() / inside.sum()
        seconds = next(stage["seconds"] for stage in report["stages"] if stage["name"] == "voxelize")
        if rule != "parity":
            holds &= share < limit_share and max(worst) <= limit_row
        print(f"| {name.split('.')[0]} | {rule} | {seconds * 1e3:.0f} ms | {grid.sum():,} | {wrong.sum():,} | {100 * share:.5f} % | "
              f"{worst[0]}, {worst[1]}, {worst[2]} |", file=file)
    print(f"| | libigl | {note['seconds'] * 1e3:.0f} ms | {inside.sum():,} | exact at {note['exact']:,} | fast off by {note['off']:.3f} | |",
          file=file)
    return holds


# ---- Ground ----


def read_corners(path):
    """Corners of an STL file's triangles [n, 3, 3]."""
    lines = open(path).read().split()
    at = [i for i, word in enumerate(lines) if word == "vertex"]
    return np.array([[float(w) for w in lines[i + 1 : i + 4]] for i in at]).reshape(-1, 3, 3)


def write_off(path, corners):
    with open(path, "w") as file:
        print(f"OFF\n{3 * len(corners)} {len(corners)} 0", file=file)
        for p in corners.reshape(-1, 3):
            print(*(repr(float(v)) for v in p), file=file)
        for i in range(len(corners)):
            print(3, 3 * i, 3 * i + 1, 3 * i + 2, file=file)


def heights(corners, lattice):
    """Height of the highest triangle over each column's centre; minus infinity where there is none."""
    low, step, dims = np.array(lattice["origin"]), np.array(lattice["spacing"]), lattice["dims"]
    top = np.full(dims[:2], -np.inf)
    for a, b, c in corners:
        area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
        least = np.maximum(np.floor((np.minimum(np.minimum(a, b), c) - low)[:2] / step[:2] - 0.5).astype(int), 0)
        most = np.minimum(np.ceil((np.maximum(np.maximum(a, b), c) - low)[:2] / step[:2] - 0.5).astype(int), np.array(dims[:2]) - 1)
        if area == 0 or (least > most).any():
            continue
        x, y = np.meshgrid(*(low[i] + (np.arange(least[i], most[i] + 1) + 0.5) * step[i] for i in range(2)), indexing="ij")
        u = ((x - a[0]) * (c[1] - a[1]) - (y - a[1]) * (c[0] - a[0])) / area
        v = ((b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0])) / area
        over = (u >= 0) & (v >= 0) & (u + v <= 1)
        part = top[least[0] : most[0] + 1, least[1] : most[1] + 1]
        np.maximum(part, np.where(over, a[2] + u * (b[2] - a[2]) + v * (c[2] - a[2]), -np.inf), out=part)
    return top


def voxels_under(top, lattice, base=None):
    """Centres of each column below its height and not below the base."""
    low, step, count = lattice["origin"][2], lattice["spacing"][2], lattice["dims"][2]
    upper = np.clip(np.ceil((np.where(np.isfinite(top), top, low) - low) / step - 0.5), 0, count)
    lower = 0 if base is None else np.clip(np.ceil((base - low) / step - 0.5), 0, count)
    return np.maximum(upper - lower, 0).astype(np.int64)


def show_column(what, ours, theirs, volume, file):
    differ = ours != theirs
    print(f"| {what} | {ours.sum():,} | {theirs.sum():,} | {differ.sum()} of {differ.size} | {int(np.abs(ours - theirs).max())} | {volume} |",
          file=file)
    return differ.sum() <= differ.size // 1000 and np.abs(ours - theirs).max() <= 1


def show_ground(name, file):
    path = plain_file(name)
    corners = read_corners(path)
    # the second ground: waves on the first, so that it is cut here and filled there; its corners are the first's
    other = corners.copy()
    span = np.ptp(corners.reshape(-1, 3), axis=0)
    other[..., 2] += span[2] / 8 * np.sin(corners[..., 0] * 9 / span[0]) * np.cos(corners[..., 1] * 7 / span[1])
    write_off(os.path.join(folder, "second.off"), other)
    spacing = ["--spacing", repr(float(span.max() / 512)), "--padding", "8"]
    holds = True
    grid, report = voxelize(path, "--fill", "below", *spacing)
    lattice = report["lattice"]
    first = heights(corners, lattice)
    volume = float(np.prod(lattice["spacing"]))
    low = lattice["origin"][2]
    true = np.where(np.isfinite(first), first - low, 0).sum() * volume / lattice["spacing"][2]
    holds &= show_column("down to the lattice", grid.sum(axis=2), voxels_under(first, lattice),
                         f"{grid.sum() * volume / true - 1:+.4%}", file)
    base = low + float(np.ceil(0.3 * span[2] / lattice["spacing"][2])) * lattice["spacing"][2]
    grid, _ = voxelize(path, "--fill", "below", *spacing, "--base", repr(base))
    true = np.maximum(np.where(np.isfinite(first), first - base, 0), 0).sum() * volume / lattice["spacing"][2]
    holds &= show_column("down to a base", grid.sum(axis=2), voxels_under(first, lattice, base),
                         f"{grid.sum() * volume / true - 1:+.4%}", file)
    grid, report = voxelize(path, "--fill", "below", *spacing, "--second", os.path.join(folder, "second.off"))
    lattice = report["lattice"]
    volume = float(np.prod(lattice["spacing"]))
    first, second = heights(corners, lattice), heights(other, lattice)
    both = np.isfinite(first) & np.isfinite(second)
    rise = np.where(both, voxels_under(first, lattice) - voxels_under(second, lattice), 0)
    gap = (np.where(both, first, 0) - np.where(both, second, 0)) * volume / lattice["spacing"][2]
    cut = np.where(np.where(both, first > second, False)[:, :, None], grid, False).sum(axis=2)
    fill = grid.sum(axis=2) - cut
    for what, ours, theirs, true, told in (("cut", cut, np.maximum(rise, 0), gap[gap > 0].sum(), report["solid"]["cut_voxels"]),
                                           ("fill", fill, np.maximum(-rise, 0), -gap[gap < 0].sum(), report["solid"]["fill_voxels"])):
        holds &= show_column(f"second ground: {what}, {told:,} by the report", ours, theirs, f"{told * volume / true - 1:+.4%}", file)
        holds &= abs(told - int(theirs.sum())) <= 1e-4 * told
    return holds


def main():
    verdicts = {}
    with open(os.path.join(out, "fills.md"), "w") as file:
        if igl is None:
            print("missing: igl (pip: libigl), which the fills are compared with", file=file)
        else:
            print("| fills at 256 | rule | time | voxels | other than libigl | of the solid | most in a row along x, y, z |", file=file)
            print("|---|---|--:|--:|--:|--:|--:|", file=file)
            for name in ("bunny_scan_69451.ply", "dragon_vrip_871414.ply"):
                verdicts[name] = show_rules(name, file)
        print("\n| ground | voxels | sum of columns | columns that differ | by | volume, beside that under the planes |", file=file)
        print("|---|--:|--:|--:|--:|--:|", file=file)
        verdicts["ground"] = show_ground("terrain_turbineSiting.stl", file)
        for name, holds in verdicts.items():
            print(f"\n{name}: {'holds' if holds else 'MISSED'}", file=file, end="")
        print(file=file)
    print(open(os.path.join(out, "fills.md")).read(), end="")
    return 0 if all(verdicts.values()) else 1


sys.exit(main())
