"""peers_planes.py - bodies through contours on planes of any position, and through stacks, beside what else there is.

    peers_planes.py FOLDER BITVOX MESHES [CELLS [meshes]]

Analytic bodies are cut by 3 to 60 random planes, real meshes by 12 and 24 and by stacks; each way makes a body of the same contours on the
same lattice (CELLS along the longest side [48]); meshes: these alone. Ways:

- bitvox sections, with nothing else said;
- a signed-distance RBF: scipy's RBFInterpolator, thin plate, 40 neighbours (more in stacks), of the signed distances on a raster of each plane and of the
  contours' points; marching cubes of scikit-image;
- a blend of the planes' signed distances by inverse cubes of the distances to the planes; marching cubes;
- stacks: masks of the sections, filled in by ITK's morphological contour interpolation, smoothed by a Gauss filter of one cell;
  marching cubes.

The number is the mean distance between the body made and the true one, both ways, in thousandths of the true one's diagonal. Prints Markdown and writes
FOLDER/planes.json.
"""
import json
import subprocess
import sys
from pathlib import Path

import numpy as np
from scipy.interpolate import RBFInterpolator
from scipy.spatial import cKDTree
from skimage.measure import find_contours, marching_cubes

FOLDER, PROGRAM, MESHES = Path(sys.argv[1]), sys.argv[2], Path(sys.argv[3])
CELLS = int(sys.argv[4]) if len(sys.argv) > 4 else 48
SAMPLES = 60000


# ---- true bodies: below 0 inside ----

def ball(p):
    return np.linalg.norm(p, axis=-1) - 1.0


def torus(p):
    return np.hypot(np.hypot(p[..., 0], p[..., 1]) - 0.8, p[..., 2]) - 0.3


def merging(p):
    """Two balls that run into one."""
    a, b = (np.linalg.norm(p - [x, 0, 0], axis=-1) for x in (-0.6, 0.6))
    return -np.log(np.exp(-8 * (a - 0.6)) + np.exp(-8 * (b - 0.6))) / 8


def shell(p):
    return np.abs(np.linalg.norm(p, axis=-1) - 0.75) - 0.25


BODIES = {"ball": ball, "torus": torus, "two balls that merge": merging, "shell with a cavity": shell}


# ---- contours ----

def frame(normal):
    n = np.asarray(normal, float) / np.linalg.norm(normal)
    u = np.cross(n, [0.3, 0.5, 0.8])
    u /= np.linalg.norm(u)
    return n, u, np.cross(n, u)


def cut_body(body, normal, height, side=161, count=100):
    """Loops of a plane, their points on the true body."""
    n, u, v = frame(normal)
    line = np.linspace(-1.6, 1.6, side)
    b, a = np.meshgrid(line, line, indexing="ij")
    grid = height * n + a[..., None] * u + b[..., None] * v
    loops = []
    for c in find_contours(body(grid), 0.0):
        uv = np.stack([np.interp(c[:, 1], range(side), line), np.interp(c[:, 0], range(side), line)], axis=1)[:-1]
        if len(uv) < 8:
            continue
        uv = uv[np.unique(np.linspace(0, len(uv) - 1, min(count, len(uv))).astype(int))]
        for _ in range(12):  # onto the body, along the plane
            at = height * n + uv[:, :1] * u + uv[:, 1:] * v
            f = body(at)
            g = np.stack([(body(at + 1e-5 * w) - body(at - 1e-5 * w)) / 2e-5 for w in (u, v)], axis=1)
            uv = uv - np.clip(f / np.maximum((g * g).sum(1), 1e-3), -0.01, 0.01)[:, None] * g
        loops.append(height * n + uv[:, :1] * u + uv[:, 1:] * v)
    return loops


def random_planes(rng, count, spread):
    return [(n / np.linalg.norm(n), rng.uniform(-spread, spread)) for n in rng.normal(size=(count, 3))]


def write_csl(path, sections):
    with open(path, "w") as out:
        out.write(f"CSLC\n{len(sections)} 2\n\n")
        for i, (normal, height, loops) in enumerate(sections):
            points = np.concatenate(loops) if loops else np.zeros((0, 3))
            out.write(f"{i + 1} {len(points)} {len(loops)} {' '.join(map(repr, map(float, normal)))} {-float(height)!r}\n\n")
            out.writelines(f"{float(x)!r} {float(y)!r} {float(z)!r}\n" for x, y, z in points)
            first = 0
            for loop in loops:
                out.write(f"\n{len(loop)} 1 {' '.join(map(str, range(first, first + len(loop))))}\n")
                first += len(loop)
            out.write("\n")


def read_csl(path):
    words = iter(path.read_text().split())
    next(words)
    count, _ = int(next(words)), next(words)
    sections = []
    for _ in range(count):
        _, points, loops = next(words), int(next(words)), int(next(words))
        plane = [float(next(words)) for _ in range(4)]
        p = np.array([float(next(words)) for _ in range(3 * points)]).reshape(-1, 3)
        found = []
        for _ in range(loops):
            size, _ = int(next(words)), next(words)
            found.append(p[[int(next(words)) for _ in range(size)]])
        sections.append((np.array(plane[:3]), -plane[3], found))
    return sections


# ---- distances on planes ----

def inside(uv, loops):
    odd = np.zeros(len(uv), bool)
    for loop in loops:
        for (ax, ay), (bx, by) in zip(loop, np.roll(loop, -1, axis=0)):
            cross = (ay > uv[:, 1]) != (by > uv[:, 1])
            with np.errstate(divide="ignore", invalid="ignore"):
                odd ^= cross & (uv[:, 0] < ax + (uv[:, 1] - ay) * (bx - ax) / (by - ay))
    return odd


class Plane:
    """Signed distances on a fine raster of the plane, above 0 inside."""

    def __init__(self, section, low, high, far):
        (self.n, self.u, self.v), self.height = frame(section[0]), section[1]
        self.height /= np.linalg.norm(section[0])
        corners = np.array([[x, y, z] for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])])
        uv = np.stack([corners @ self.u, corners @ self.v], axis=1)
        self.low, size = uv.min(0), uv.max(0) - uv.min(0)
        self.side = 128
        self.step = size / (self.side - 1)
        b, a = np.meshgrid(range(self.side), range(self.side), indexing="ij")
        at = self.low + np.stack([a.ravel(), b.ravel()], axis=1) * self.step
        loops = [np.stack([loop @ self.u, loop @ self.v], axis=1) for loop in section[2]]
        if loops:
            dense = np.concatenate([a + (b - a) * t for loop in loops for a, b in [(loop, np.roll(loop, -1, axis=0))] for t in np.arange(0, 1, 0.1)])
            d = cKDTree(dense).query(at)[0]
            self.value = np.where(inside(at, loops), d, -d).reshape(self.side, self.side)
        else:
            self.value = np.full((self.side, self.side), -far)

    def at(self, p):
        x = np.clip((p @ self.u - self.low[0]) / self.step[0], 0, self.side - 1.001)
        y = np.clip((p @ self.v - self.low[1]) / self.step[1], 0, self.side - 1.001)
        i, j = x.astype(int), y.astype(int)
        s, t = x - i, y - j
        v = self.value
        return (v[j, i] * (1 - s) + v[j, i + 1] * s) * (1 - t) + (v[j + 1, i] * (1 - s) + v[j + 1, i + 1] * s) * t


# ---- ways ----

class Lattice:
    def __init__(self, sections):
        points = np.concatenate([loop for s in sections for loop in s[2]])
        low, high = points.min(0), points.max(0)
        self.step = (high - low).max() / CELLS
        self.low, self.high = low - 6 * self.step, high + 6 * self.step
        self.box = low, high
        axes = [np.arange(a, b, self.step) for a, b in zip(self.low, self.high)]
        self.size = tuple(len(a) for a in axes)
        self.at = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)

    def surface(self, values):
        """Beyond the contours' box the way to it is taken off, as bitvox does."""
        off = np.linalg.norm(np.maximum(0, np.maximum(self.box[0] - self.at, self.at - self.box[1])), axis=1)
        grid = np.pad((values - off).reshape(self.size), 1, constant_values=-self.step)
        if not (grid.max() > 0):
            return None
        v, f = marching_cubes(grid, 0.0)[:2]
        return (v - 1) * self.step + self.low, f


def blend(lattice, planes):
    value, weight = np.zeros(len(lattice.at)), np.zeros(len(lattice.at))
    for p in planes:
        w = 1 / (np.abs(lattice.at @ p.n - p.height) + 1e-6 * lattice.step) ** 3
        value += w * p.at(lattice.at)
        weight += w
    return value / weight


def by_rbf(lattice, planes, sections, near):
    """Only next to where the blend says that the surface is; farther off its sign is the blend's."""
    points, values = [], []
    for p, s in zip(planes, sections):
        steps = np.arange(0, p.side, 4)
        a, b = (x.ravel() for x in np.meshgrid(steps, steps))
        at = p.height * p.n + (p.low[0] + a * p.step[0])[:, None] * p.u + (p.low[1] + b * p.step[1])[:, None] * p.v
        keep = ((at > lattice.low) & (at < lattice.high)).all(1)
        points += [at[keep]] + s[2]
        values += [p.value[b, a][keep]] + [np.zeros(len(loop)) for loop in s[2]]
    points, values = np.concatenate(points), np.concatenate(values)
    points, first = np.unique(np.round(points, 6), axis=0, return_index=True)
    band = np.abs(near) < 8 * lattice.step
    out = near.copy()
    for neighbours in (40, 80, 160, 320):  # more where so many lie in one plane
        try:
            rbf = RBFInterpolator(points, values[first], neighbors=neighbours, kernel="thin_plate_spline", smoothing=1e-6)
            out[band] = rbf(lattice.at[band])
            return out
        except np.linalg.LinAlgError:
            pass
    return np.full(len(near), -1.0)


def by_masks(lattice, sections):
    """Slices of a stack along z as labels, filled in between."""
    import itk
    _, y, z = (np.unique(np.round(lattice.at[:, k], 9)) for k in range(3))
    mask = np.zeros(lattice.size, np.uint8)
    grid = lattice.at.reshape(*lattice.size, 3)
    layers = {}
    for normal, height, loops in sections:
        at = height * (1 if normal[2] > 0 else -1) / np.linalg.norm(normal)
        k = int(np.argmin(np.abs(z - at)))
        flat = grid[:, :, k, :2].reshape(-1, 2)
        mask[:, :, k] = inside(flat, [loop[:, :2] for loop in loops]).reshape(lattice.size[:2])
        layers[k] = at
    image = itk.image_from_array(np.ascontiguousarray(mask.transpose(2, 1, 0)))
    filled = itk.morphological_contour_interpolator(image, axis=2)
    smooth = itk.smoothing_recursive_gaussian_image_filter(filled.astype(itk.F), sigma=1.0)
    return (itk.array_from_image(smooth).transpose(2, 1, 0) - 0.5).reshape(-1) * lattice.step


def by_bitvox(sections, *options):
    write_csl(FOLDER / "planes.csl", sections)
    run = subprocess.run([PROGRAM, "sections", FOLDER / "planes.csl", "-o", FOLDER / "planes.off", *options],
                         capture_output=True, text=True)
    if run.returncode != 0:
        print(run.stderr.strip(), file=sys.stderr)
        return None
    return read_off(FOLDER / "planes.off")


def read_off(path):
    words = path.read_text().split()
    v, f = int(words[1]), int(words[2])
    points = np.array(words[4:4 + 3 * v], float).reshape(-1, 3)
    return points, np.array(words[4 + 3 * v:4 + 3 * v + 4 * f], int).reshape(-1, 4)[:, 1:]


# ---- judging ----

def samples(mesh, rng):
    p, f = mesh
    a, b, c = p[f[:, 0]], p[f[:, 1]], p[f[:, 2]]
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    t = rng.choice(len(f), SAMPLES, p=area / area.sum())
    r, s = np.sqrt(rng.random(SAMPLES)), rng.random(SAMPLES)
    return (1 - r)[:, None] * a[t] + (r * (1 - s))[:, None] * b[t] + (r * s)[:, None] * c[t]


def foot_distances(points, others, mesh_points):
    """From points to a mesh, taken as its dense samples with the tangent plane of the nearest three."""
    d, i = cKDTree(others).query(points, k=3)
    a, b, c = (others[i[:, k]] for k in range(3))
    n = np.cross(b - a, c - a)
    size = np.linalg.norm(n, axis=1)
    flat = np.abs(((points - a) * n).sum(1)) / np.maximum(size, 1e-300)
    good = size > 0.05 * np.linalg.norm(b - a, axis=1) * np.linalg.norm(c - a, axis=1)
    return np.where(good, np.minimum(flat, d[:, 0]), d[:, 0])


def judge(mesh, truth):
    """truth: a function, or a mesh, with samples of the true surface."""
    if mesh is None:
        return float("nan")
    rng = np.random.default_rng(5)
    got = samples(mesh, rng)
    there = np.abs(truth["body"](got)) if truth["body"] is not None else foot_distances(got, truth["samples"], None)
    back = foot_distances(truth["samples"], got, None)
    return 1e3 * 0.5 * (there.mean() + back.mean()) / truth["diagonal"]


def truth_of_body(body):
    line = np.linspace(-1.5, 1.5, 121)
    v, f = marching_cubes(-body(np.stack(np.meshgrid(line, line, line, indexing="ij"), axis=-1)), 0.0)[:2]
    mesh = v * (line[1] - line[0]) - 1.5, f
    return {"body": body, "samples": samples(mesh, np.random.default_rng(1)), "diagonal": np.linalg.norm(np.ptp(mesh[0], axis=0))}


def truth_of_mesh(path):
    subprocess.run([PROGRAM, "convert", path, "-o", FOLDER / "truth.off"], check=True, capture_output=True)
    mesh = read_off(FOLDER / "truth.off")
    return {"body": None, "samples": samples(mesh, np.random.default_rng(1)), "diagonal": np.linalg.norm(np.ptp(mesh[0], axis=0))}, mesh


def cut_mesh(mesh, normal, height):
    """The loops of one plane: the mesh is turned until the plane lies across z, and is cut by the first of few planes."""
    n, u, v = frame(normal)
    turned = mesh[0] @ np.stack([u, v, n], axis=1)
    with open(FOLDER / "turned.off", "w") as out:
        out.write(f"OFF\n{len(turned)} {len(mesh[1])} 0\n")
        np.savetxt(out, turned, "%.17g")
        np.savetxt(out, np.c_[np.full(len(mesh[1]), 3), mesh[1]], "%d")
    spacing = 2 * (height - turned[:, 2].min())
    if not (0 < height - turned[:, 2].min() and height < turned[:, 2].max()):
        return []
    run = subprocess.run([PROGRAM, "slice", FOLDER / "turned.off", "-o", FOLDER / "cut.csl", "--spacing", repr(float(spacing))],
                         capture_output=True, text=True)
    if run.returncode != 0:
        print(run.stderr.strip(), file=sys.stderr)
        return []
    return [loop @ np.stack([u, v, n]) for loop in read_csl(FOLDER / "cut.csl")[0][2]]


rows = []


def compare(name, what, sections, truth, stack):
    lattice = Lattice(sections)
    far = 0.25 * (lattice.box[1] - lattice.box[0]).max()
    planes = [Plane(s, lattice.low, lattice.high, far) for s in sections]
    cells = () if stack else ("--cells", str(CELLS))
    near = blend(lattice, planes)
    row = {"body": name, "planes": what, "bitvox": judge(by_bitvox(sections, *cells), truth)}
    if stack:
        row["masks"] = judge(lattice.surface(by_masks(lattice, sections)), truth)
    row["rbf"] = judge(lattice.surface(by_rbf(lattice, planes, sections, near)), truth)
    row["blend"] = judge(lattice.surface(near), truth)
    rows.append(row)
    print("| " + " | ".join([name, what] + [f"{row[k]:.2f}" if k in row else "" for k in ("bitvox", "rbf", "blend", "masks")]) + " |", flush=True)


print("| body | planes | bitvox | RBF | inverse cubes | ITK masks |\n|---|--:|--:|--:|--:|--:|")
for name, body in BODIES.items() if len(sys.argv) < 6 else ():
    truth = truth_of_body(body)
    for count in (3, 6, 12, 24, 60):
        rng = np.random.default_rng(count)
        sections = [(n, h, cut_body(body, n, h)) for n, h in random_planes(rng, count, 0.4)]
        compare(name, str(count), sections, truth, False)
for name in ("rocker-arm.obj.gz", "fandisk.obj.gz"):
    truth, mesh = truth_of_mesh(MESHES / name)
    low, high = mesh[0].min(0), mesh[0].max(0)
    heights = np.linspace(low[2], high[2], 16 + 1)[:-1] + (high[2] - low[2]) / 32
    compare(name.split(".")[0], "stack of 16", [(np.array([0, 0, 1.0]), h, cut_mesh(mesh, [0, 0, 1], h)) for h in heights], truth, True)
    for count in (12, 24):
        rng = np.random.default_rng(count)
        sections = []
        for n, h in random_planes(rng, count, 0.35):
            at = float(n @ (low + high) / 2 + h * np.abs(n) @ (high - low) / 2)
            sections.append((n, at, cut_mesh(mesh, n, at)))
        compare(name.split(".")[0], str(count), sections, truth, False)
(FOLDER / "planes.json").write_text(json.dumps(rows))
