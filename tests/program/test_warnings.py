"""test_warnings.py - what is warned of is so, and what is not warned of is right.

python3 test_warnings.py [PROGRAM [NAME]]

Shapes of known volume, parts and handles go through repair, lod, voxelize, boolean and simplify: rods, plates, combs, lattices, frames,
shells, rings, balls that are torn, flipped, open and nested, as they stand and turned. Volume, parts and handles of results are
counted here, from the files. With BITVOX_LARGE set all 300 shapes do so, 300 pairs of heaps of boxes (NAME: pairs) by each operation,
60 rods with a triangle missing (NAME: rods), and all files of ../shared/meshes or BITVOX_SHARED/meshes; else every fifth, 20 pairs and 20 rods. A result is off where its volume differs by over 2 %, or its parts or handles are not those of the shape.
Fails for each result that is off without a warning, each warning whose numbers are not so, and where over 3 % of right results
carry a warning that they do not need. Ends with both counts and "N passed, N failed, N skipped"."""
import json, math, os, random, subprocess, sys, tempfile

sys.path.insert(0, 'tests/tools')
from made_meshes import Mesh, ball, box, flip, polyhedron_volume, prism, ring

OFF, OFF_VOXELS = 0.02, 0.01
OF_INPUT = ('BVX_WARN_LIDS', 'BVX_WARN_ROWS', 'BVX_WARN_AREA', 'BVX_WARN_APART')  # say what the input or the area has, whatever came of the volume
# What is not so (docs/limits.md): handles of parts that cross are not known to repair; lines of centres see a bar of less than 1.5 voxels
# badly; walls, gaps and necks that arise between two meshes, of less than a third of a voxel, finer lattices may not see either;
# and of pair 257 the difference has the two parts that are right, where finer lattices see one.
KNOWN = ['bars_3 voxelize', 'rod_10 voxelize', 'heap_13 repair'] + ['pair_%d %s' % (i, operation) for operation, pairs in (
    ('union', (39, 207, 249, 259, 270)), ('intersection', (11, 55, 161, 207, 248, 249, 259)),
    ('difference', (39, 103, 211, 218, 235, 248, 257, 260))) for i in pairs]
THIN = ('rod', 'rods', 'plate', 'bars', 'comb', 'frame', 'shell', 'ring', 'specks', 'gap')  # walls of voxels may be lost
RESOLUTION = 48
program = os.path.abspath(sys.argv[1] if len(sys.argv) > 1 else os.environ.get('BITVOX', 'build/bitvox'))
only = sys.argv[2] if len(sys.argv) > 2 else None
large = bool(os.environ.get('BITVOX_LARGE'))
shared = os.path.abspath(os.path.join(os.environ.get('BITVOX_SHARED', '../shared'), 'meshes'))
counts = {'passed': 0, 'failed': 0, 'skipped': 0}
needless, right, silent = [], 0, 0


# ---- what is so, counted from files ----

def count(points, faces):
    """Volume, parts and handles of a closed surface."""
    root = list(range(len(points)))

    def find(i):
        while root[i] != i:
            root[i] = root[root[i]]
            i = root[i]
        return i

    edges = set()
    for a, b, c in faces:
        root[find(a)] = find(b)
        root[find(b)] = find(c)
        edges |= {(min(p, q), max(p, q)) for p, q in ((a, b), (b, c), (c, a))}
    used = {i for f in faces for i in f}
    parts = len({find(i) for i in used})
    mesh = Mesh()
    mesh.points, mesh.faces = points, faces
    return polyhedron_volume(mesh), parts, parts - (len(used) - len(edges) + len(faces)) // 2


def read_off(path):
    with open(path) as file:
        words = file.read().split()
    n, m = int(words[1]), int(words[2])
    numbers = list(map(float, words[4:4 + 3 * n]))
    corners = list(map(int, words[4 + 3 * n:]))
    return [numbers[i:i + 3] for i in range(0, 3 * n, 3)], [corners[i + 1:i + 4] for i in range(0, 4 * m, 4)]


def in_boxes(boxes, at):
    return any(all(b[0][a] < at[a] < b[1][a] for a in range(3)) for b in boxes)


def count_boxes(boxes, inside_of=None):
    """The same of the union of boxes, or of what inside_of says of places, from the cells between all their sides."""
    inside_of = inside_of or (lambda at: in_boxes(boxes, at))
    cuts = [sorted({b[side][a] for b in boxes for side in (0, 1)}) for a in range(3)]
    volume, faces, ids = 0.0, [], {}
    inside = set()
    for x in range(len(cuts[0]) - 1):
        for y in range(len(cuts[1]) - 1):
            for z in range(len(cuts[2]) - 1):
                c = (x, y, z)
                middle = [(cuts[a][c[a]] + cuts[a][c[a] + 1]) / 2 for a in range(3)]
                if inside_of(middle):
                    inside.add(c)
                    volume += math.prod(cuts[a][c[a] + 1] - cuts[a][c[a]] for a in range(3))
    for c in inside:
        for a in range(3):
            for up in (0, 1):
                if tuple(c[k] + (2 * up - 1) * (k == a) for k in range(3)) in inside:
                    continue
                corner = [[c[k] + (up if k == a else (i, j)[k == (a + 2) % 3]) for k in range(3)] for i, j in ((0, 0), (1, 0), (1, 1), (0, 1))]
                q = [ids.setdefault(tuple(p), len(ids)) for p in corner]
                faces += [[q[0], q[1], q[2]], [q[0], q[2], q[3]]]
    points = [None] * len(ids)
    for p, i in ids.items():
        points[i] = [cuts[a][p[a]] for a in range(3)]
    return (volume,) + count(points, faces)[1:]


# ---- shapes ----

def of_boxes(boxes):
    m = Mesh()
    for low, high in boxes:
        box(m, low, high)
    return m, count_boxes(boxes)


def rod(m, x, y, thick, low=0.0, high=1.0, sides=24):
    return prism(m, [(x + thick / 2 * math.cos(2 * math.pi * i / sides), y + thick / 2 * math.sin(2 * math.pi * i / sides)) for i in range(sides)], low, high)


def turned(m, r):
    """Turned by a random unit quaternion."""
    q = [r.gauss(0, 1) for _ in range(4)]
    n = math.sqrt(sum(v * v for v in q))
    w, x, y, z = (v / n for v in q)
    rows = ((1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)), (2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)),
            (2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)))
    m.points = [tuple(sum(a * b for a, b in zip(row, p)) for row in rows) for p in m.points]
    return m


def own(m):
    return m, count(m.points, m.faces)


def cracked(m, shrink):
    points, faces = [], []
    for f in m.faces:
        middle = [sum(m.points[i][a] for i in f) / 3 for a in range(3)]
        faces.append([len(points) + k for k in range(3)])
        points += [tuple(c + shrink * (v - c) for c, v in zip(middle, m.points[i])) for i in f]
    out = Mesh()
    out.points, out.faces = points, faces
    return out


def make(kind, r):
    """A mesh and its volume, parts and handles, or None where nothing but a warning is right."""
    v = 1.0 / RESOLUTION
    unit = lambda: ball(Mesh(), (0, 0, 0), 1, 12)
    if kind == 'rod':
        return own(rod(Mesh(), 0, 0, r.uniform(0.7, 6) * v))
    if kind == 'rods':
        m = Mesh()
        for i in range(4):
            rod(m, 0.25 * (i % 2), 0.25 * (i // 2), r.uniform(2, 5) * v)
        return own(m)
    if kind == 'plate':
        return of_boxes([((0, 0, 0), (1, 0.7, r.uniform(0.3, 4) * v))])
    if kind == 'bars':
        t = r.uniform(1, 5) * v
        at = [0.1, 0.5, 0.85]
        return of_boxes([((0, a, 0), (1, a + t, t)) for a in at] + [((a, 0, 0.3 * t), (a + t, 1, 1.3 * t)) for a in at])
    if kind == 'comb':
        slit, tooth = r.uniform(0.3, 4) * v, 0.12
        return of_boxes([((0, 0, 0), (5 * tooth + 4 * slit, 0.2, 0.3))] + [((i * (tooth + slit), 0.1, 0), (i * (tooth + slit) + tooth, 1, 0.3)) for i in range(5)])
    if kind == 'frame':
        t = r.uniform(1.5, 8) * v
        return of_boxes([((0, 0, 0), (1, t, t)), ((0, 1 - t, 0), (1, 1, t)), ((0, 0, 0), (t, 1, t)), ((1 - t, 0, 0), (1, 1, t))])
    if kind == 'heap':
        boxes = []
        for _ in range(r.randint(2, 6)):
            low = [r.uniform(0, 1) for _ in range(3)]
            boxes.append((low, [a + r.uniform(0.2, 0.8) for a in low]))
        m, truth = of_boxes(boxes)
        return (flip(m, [r.randrange(len(m.faces)) for _ in range(3)]) if r.random() < 0.5 else m), truth
    if kind == 'shell':
        m = ball(unit(), (0, 0, 0), 1 - 2 * r.uniform(0.4, 5) * v, 12, True)
        return own(m)
    if kind == 'ring':
        return own(ring(Mesh(), 1, r.uniform(1, 8) * v, 32, 12))
    if kind == 'flips':
        m, truth = own(unit())
        return flip(m, [r.randrange(len(m.faces)) for _ in range(r.choice((1, 20, 200)))]), truth
    if kind == 'cracked':
        m, truth = own(unit())
        return cracked(m, r.uniform(0.99, 0.999)), truth
    if kind == 'open_box':
        m, truth = of_boxes([((0, 0, 0), (1, r.uniform(0.4, 1), 0.8))])
        del m.faces[r.randrange(12)]
        return m, truth
    if kind == 'half_ball':  # a flat rim has a flat lid
        m = ball(Mesh(), (0, 0, 0), 1, 12, keep=lambda i, j: i < 6)
        return m, (polyhedron_volume(m), 1, 0)
    if kind == 'sheet':
        m = Mesh()
        return m.add([(0, 0, 0), (1, 0, 0.1), (1, 1, 0), (0, 1, 0.2)], [[0, 1, 2], [0, 2, 3]]), None
    if kind == 'nested':
        m, truth = own(unit())
        return ball(m, (0.1, 0, 0), 0.4, 12), truth
    if kind == 'inside_out':
        m, truth = own(unit())
        if r.random() < 0.5:
            m, truth = ball(m, (3, 0, 0), 0.8, 12, True), (truth[0] * 1.512, 2, 0)
            return m, truth
        return flip(m, range(len(m.faces))), truth
    if kind == 'open_and_inside_out':
        m = ball(ball(Mesh(), (0, 0, 0), 1, 16), (2.5, 0, 0), 0.6, 16, True)
        volume = polyhedron_volume(ball(Mesh(), (0, 0, 0), 1, 16))
        faces = len(m.faces)
        box(m, (4, 0, 0), (5, 1, 1))
        del m.faces[faces]
        return m, (volume * 1.216 + 1, 3, 0)
    if kind == 'gap':
        return of_boxes([((0, 0, 0), (0.5, 0.5, 0.5)), ((0.5 + r.uniform(0.2, 4) * v, 0, 0), (1.0 + 4 * v, 0.5, 0.5))])
    if kind == 'specks':
        m = unit()
        for i in range(6):
            ball(m, (1.5, -1 + 0.4 * i, 0), r.uniform(0.5, 4) * v, 4)
        return own(m)
    raise ValueError(kind)


KINDS = ('rod', 'rods', 'plate', 'bars', 'comb', 'frame', 'heap', 'shell', 'ring', 'flips', 'cracked', 'open_box', 'half_ball', 'sheet', 'nested', 'inside_out',
         'open_and_inside_out', 'gap', 'specks')
ASIDE = {'nested': ('voxelize',)}  # by default hollow there, with a warning


# ---- runs ----

def run(*words):
    r = subprocess.run([program, *words, '--json', '--quiet'], capture_output=True, text=True)
    if r.returncode not in (0, 1):
        raise SystemExit('%s: status %d: %s' % (' '.join(words), r.returncode, r.stderr))
    return json.loads(r.stdout)


def judge(name, what, good):
    known = not good and name in KNOWN
    counts['passed' if good else 'skipped' if known else 'failed'] += 1
    if not good:
        print('# known: ' + name + ': ' + what if known else 'not ok %s: %s' % (name, what))


def near(a, b, share):
    return abs(a - b) <= share * max(abs(a), abs(b)) + 1e-12


def check_claims(name, warnings, truth, found):
    """The numbers of warnings are those of the files."""
    for w in warnings:
        v = w['values']
        code = w['code'][len('BVX_WARN_'):]
        if code in ('VOLUME', 'THICKER', 'VOXELS') and found[0] is not None:
            if len(v) < 5 or v[4] == 0:  # else it is that before edges collapsed
                judge(name, '%s says a volume of %g, the file has %g' % (code, v[0], found[0]), near(v[0], found[0], 0.01))
            if truth is not None and code != 'THICKER':
                judge(name, '%s says that the input has about %g, it has %g' % (code, v[1], truth[0]), near(v[1], truth[0], 0.03))
                judge(name, '%s, but %g for %g is not off' % (code, found[0], truth[0]), not near(found[0], truth[0], 0.005))
        if code in ('PARTS', 'JOINED') and found[1] is not None:
            judge(name, '%s says %g parts for %g, the file has %d' % (code, v[0], v[1], found[1]), v[0] == found[1] and (v[0] > v[1]) == (code == 'PARTS'))
            if truth is not None:
                judge(name, '%s, but %d parts are right' % (code, found[1]), found[1] != truth[1])
        if code == 'HANDLES' and found[2] is not None:
            judge(name, 'HANDLES says %g, the file has %d' % (v[0], found[2]), v[0] == found[2])
            if truth is not None:
                judge(name, 'HANDLES, but %d are right' % found[2], found[2] != truth[2])


def check_result(name, report, truth, found):
    global right, silent
    warnings = report['warnings']
    check_claims(name, warnings, truth, found)
    if truth is None:
        judge(name, 'is a guess, no warning', len(warnings) != 0)
        silent += not warnings
        return
    off = ['%s %g for %g' % (what, got, wanted) for what, got, wanted, good in (
        ('volume', found[0], truth[0], found[0] is None or near(found[0], truth[0], OFF if found[1] is not None else OFF_VOXELS)), ('parts', found[1], truth[1], found[1] in (None, truth[1])),
        ('handles', found[2], truth[2], found[2] in (None, truth[2]))) if not good]
    if off:
        judge(name, ', '.join(off) + ', no warning', len(warnings) != 0)
        silent += not warnings
    else:
        right += 1
        counts['passed'] += 1
        thin = name.split('_')[0] in THIN
        if [w for w in warnings if w['code'] not in OF_INPUT and not (thin and w['code'] == 'BVX_WARN_THIN_LOST')]:
            needless.append(name + ': ' + '; '.join(w['message'] for w in warnings))


def check(name, kind, mesh, truth):
    path = name + '.off'
    mesh.write(path)
    at = str(RESOLUTION)
    low = [min(p[a] for p in mesh.points) for a in range(3)]
    side = 0.25 * max(max(p[a] for p in mesh.points) - low[a] for a in range(3))
    box(Mesh(), [a - 1.2 * side for a in low], [a - 0.2 * side for a in low]).write('cube.off')
    far = (truth[0] + side ** 3, truth[1] + 1, truth[2]) if truth is not None else None
    jobs = [(['repair', path, '-o', 'x.off', '--resolution', at], truth), (['boolean', 'union', path, 'cube.off', '-o', 'x.off', '--resolution', at], far)]
    if kind not in ('bars', 'comb', 'frame', 'heap', 'nested', 'gap'):  # parts that overlap stay so
        jobs.append((['simplify', path, '-o', 'x.off', '--triangles', str(max(len(mesh.faces) // 2, 12)), '--samples', '0'], truth))
    jobs.append((['lod', path, '-o', 'x_%d.off', '--solid', '--count', '1', '--samples', '0', '--resolution', at], truth))
    if kind not in ASIDE or 'voxelize' not in ASIDE[kind]:
        jobs.append((['voxelize', path, '-o', 'x.npy', '--resolution', at], truth))
    for words, wanted in jobs:
        report = run(*words)
        if report['status'] != 'done':
            counts['passed'] += 1  # a refusal is a word, too
            continue
        if words[0] == 'voxelize':
            found = (report['solid']['volume'], None, None)
        else:
            found = count(*read_off('x_0.off' if words[0] == 'lod' else 'x.off'))
        # Where it has a volume to keep
        if words[0] == 'simplify' and kind in ('flips', 'cracked', 'open_box', 'half_ball', 'sheet', 'open_and_inside_out', 'inside_out'):
            check_claims(name + ' ' + words[0], report['warnings'], None, found)
        else:
            check_result(name + ' ' + words[0], report, wanted, found)


def check_pair(i):
    """Two heaps of boxes, of which some have defects, and what is left of them by each operation."""
    r, v, heaps, meshes = random.Random(10000 + i), 1.0 / RESOLUTION, [], []
    for k in range(2):
        boxes = []
        for _ in range(r.randint(1, 4)):
            low = [r.uniform(0, 1) for _ in range(3)]
            box_ = low, [a + (r.uniform(1, 4) * v if r.random() < 0.05 else r.uniform(0.2, 0.8)) for a in low]
            if not any(in_boxes([p], q[0]) and in_boxes([p], q[1]) for b in boxes for p, q in ((b, box_), (box_, b))):  # a cavity, or hollow
                boxes.append(box_)
        m = of_boxes(boxes)[0]
        if r.random() < 0.3:
            flip(m, [r.randrange(len(m.faces)) for _ in range(3)])
        if r.random() < 0.2:
            m.faces += [m.faces[r.randrange(len(m.faces))][::r.choice((1, -1))] for _ in range(2)]
        if r.random() < 0.2:
            flip(m, range(12))
        heaps.append(boxes)
        meshes.append(m)
    seed = r.random()
    for k, m in enumerate(meshes):
        (turned(m, random.Random(seed)) if i % 2 else m).write('%s.off' % 'ab'[k])
    for operation, rule in (('union', lambda a, b: a or b), ('intersection', lambda a, b: a and b), ('difference', lambda a, b: a and not b)):
        truth = count_boxes(heaps[0] + heaps[1], lambda at: rule(in_boxes(heaps[0], at), in_boxes(heaps[1], at)))
        report = run('boolean', operation, 'a.off', 'b.off', '-o', 'x.off', '--resolution', str(RESOLUTION))
        if report['status'] != 'done':
            judge('pair_%d %s' % (i, operation), 'nothing for %g' % truth[0], truth[0] < 0.001 or len(report['warnings']) != 0)
        else:
            check_result('pair_%d %s' % (i, operation), report, truth, count(*read_off('x.off')))


def check_open_rod(i):
    """A rod of 1.5 voxels of which one triangle is missing."""
    m = turned(rod(Mesh(), 0, 0, 1.5 / RESOLUTION), random.Random(i))
    side = max(max(p[a] for p in m.points) - min(p[a] for p in m.points) for a in range(3))
    m = turned(rod(Mesh(), 0, 0, 1.5 * side / RESOLUTION), random.Random(i))
    truth = count(m.points, m.faces)
    del m.faces[random.Random(i).randrange(len(m.faces))]
    m.write('rod.off')
    report = run('repair', 'rod.off', '-o', 'x.off', '--resolution', str(RESOLUTION))
    check_result('rod_open_%d repair' % i, report, truth, count(*read_off('x.off')))


def check_file(name, path):
    """Of files no truth is known but what is claimed of results."""
    for words in (['repair', path, '-o', 'x.off', '--resolution', '64'], ['voxelize', path, '-o', 'x.npy', '--resolution', '64']):
        report = run(*words)
        if report['status'] == 'done':
            found = count(*read_off('x.off')) if words[0] == 'repair' else (report['solid']['volume'], None, None)
            check_claims(name + ' ' + words[0], report['warnings'], None, found)


def main():
    with tempfile.TemporaryDirectory() as work:
        os.chdir(work)
        for i in range(300):
            kind = KINDS[i % len(KINDS)]
            name = '%s_%d' % (kind, i // len(KINDS))
            r = random.Random(i)
            mesh, truth = make(kind, r)
            if i // len(KINDS) % 2:
                mesh = turned(mesh, r)
            if name == only or (only is None and (large or i % 5 == 0)):
                check(name, kind, mesh, truth)
        for i in range(300 if large else 20):
            if only in (None, 'rods') and i < 60:
                check_open_rod(i)
            if only in (None, 'pairs', 'pair_%d' % i):
                check_pair(i)
        if large and only is None and os.path.isdir(shared):
            for f in sorted(os.listdir(shared)):
                check_file(f, os.path.join(shared, f))
        elif only is None:
            counts['skipped'] += 1
            print('# files: skipped, BITVOX_LARGE asks for them' if os.path.isdir(shared) else '# %s is not there: made shapes alone' % shared)
    for line in needless:
        print('# needless? ' + line)
    t = os.times()
    print('# off without a warning: %d; right with a warning: %d of %d; %.1f s of processor time' % (silent, len(needless), right, t.children_user + t.children_system + t.user))
    if only is None:
        judge('all', 'over 3 % of right results carry a warning', len(needless) <= 0.03 * right)
    print('%(passed)d passed, %(failed)d failed, %(skipped)d skipped' % counts)
    return counts['failed'] != 0


sys.exit(main())
