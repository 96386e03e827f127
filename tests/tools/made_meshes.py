"""made_meshes.py - meshes that are like what people have: overlaps, holes, flips, thin walls, acute edges. For tests and pictures."""
import math, random


class Mesh:
    def __init__(self):
        self.points, self.faces = [], []

    def add(self, points, faces, turned=False):
        first = len(self.points)
        self.points += points
        for f in faces:
            f = [first + i for i in f]
            self.faces.append(f[::-1] if turned else f)
        return self

    def write(self, path):
        with open(path, 'w') as out:
            out.write('OFF\n%d %d 0\n' % (len(self.points), len(self.faces)))
            for p in self.points:
                out.write('%r %r %r\n' % tuple(p))
            for f in self.faces:
                out.write('%d %s\n' % (len(f), ' '.join(map(str, f))))


def box(mesh, low, high, turned=False):
    p = [(low[0] if i % 2 == 0 else high[0], low[1] if i // 2 % 2 == 0 else high[1], low[2] if i < 4 else high[2]) for i in range(8)]
    quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    return mesh.add(p, [t for q in quads for t in ([q[0], q[1], q[2]], [q[0], q[2], q[3]])], turned)


def ball(mesh, centre, radius, n=24, turned=False, keep=lambda i, j: True, turns=0.0):
    """n rings of 2n vertices; keep leaves faces out."""
    cos, sin = math.cos(turns), math.sin(turns)
    p = [(0.0, 0.0, 1.0), (0.0, 0.0, -1.0)]
    for i in range(1, n):
        for j in range(2 * n):
            a, b = math.pi * i / n, math.pi * j / n
            p.append((math.sin(a) * math.cos(b), math.sin(a) * math.sin(b), math.cos(a)))
    p = [(centre[0] + radius * (x * cos - z * sin), centre[1] + radius * y, centre[2] + radius * (x * sin + z * cos)) for x, y, z in p]
    at = lambda i, j: 2 + (i - 1) * 2 * n + j % (2 * n)
    faces = []
    for j in range(2 * n):
        if keep(0, j):
            faces.append([0, at(1, j), at(1, j + 1)])
        if keep(n - 1, j):
            faces.append([1, at(n - 1, j + 1), at(n - 1, j)])
        for i in range(1, n - 1):
            if keep(i, j):
                faces += [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]]
    return mesh.add(p, faces, turned)


def prism(mesh, outline, low, high):
    """A closed prism of an outline that its middle sees as a whole: the ends are fans around it."""
    n = len(outline)
    middle = [sum(c) / n for c in zip(*outline)]
    p = [(x, y, low) for x, y in outline] + [(x, y, high) for x, y in outline] + [(*middle, low), (*middle, high)]
    faces = []
    for i in range(n):
        j = (i + 1) % n
        faces += [[i, j, n + j], [i, n + j, n + i], [2 * n, j, i], [2 * n + 1, n + i, n + j]]
    return mesh.add(p, faces)


def ring(mesh, large, small, n=48, m=24, turned=False):
    at = lambda i, j: i % n * m + j % m
    p = []
    for i in range(n):
        for j in range(m):
            a, b = 2 * math.pi * i / n, 2 * math.pi * j / m
            r = large + small * math.cos(b)
            p.append((r * math.cos(a), r * math.sin(a), small * math.sin(b)))
    faces = [t for i in range(n) for j in range(m) for t in ([at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)])]
    return mesh.add(p, faces, turned)


def flip(mesh, which):
    for i in which:
        mesh.faces[i % len(mesh.faces)].reverse()
    return mesh


def polyhedron_volume(mesh):
    sum6 = 0.0
    for f in mesh.faces:
        a, b, c = (mesh.points[i] for i in f)
        sum6 += a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0])
    return sum6 / 6


def made_meshes():
    """Rows of a name, a mesh, its true volume or None, and the mesh before it was spoilt where that is not the mesh."""
    one = polyhedron_volume(ball(Mesh(), (0, 0, 0), 1))
    yield 'ball', ball(Mesh(), (0, 0, 0), 1), one
    yield 'ball_inside_out', ball(Mesh(), (0, 0, 0), 1, turned=True), one, ball(Mesh(), (0, 0, 0), 1)
    yield 'ball_one_flip', flip(ball(Mesh(), (0, 0, 0), 1), [500]), one, ball(Mesh(), (0, 0, 0), 1)
    yield 'ball_many_flips', flip(ball(Mesh(), (0, 0, 0), 1), range(0, 2000, 7)), one, ball(Mesh(), (0, 0, 0), 1)
    yield 'ball_holes', ball(Mesh(), (0, 0, 0), 1, keep=lambda i, j: (i * 7 + j) % 97 != 0), one
    yield 'ball_window', ball(Mesh(), (0, 0, 0), 1, keep=lambda i, j: not (8 <= i < 13 and j < 5)), None
    yield 'half_ball', ball(Mesh(), (0, 0, 0), 1, keep=lambda i, j: i < 12), None
    # The union of two balls of radius 1 whose centres are 1 apart has 27/32 of their volumes.
    for name, which in (('two_balls', []), ('two_balls_one_flip', [900]), ('two_balls_flips', range(0, 4000, 11))):
        yield name, flip(ball(ball(Mesh(), (0, 0, 0), 1), (1, 0, 0), 1), which), 2 * one * 27 / 32, ball(ball(Mesh(), (0, 0, 0), 1), (1, 0, 0), 1)
    yield 'two_balls_one_inside_out', ball(ball(Mesh(), (0, 0, 0), 1), (1, 0, 0), 1, turned=True), 2 * one * 27 / 32, ball(ball(Mesh(), (0, 0, 0), 1), (1, 0, 0), 1)
    yield 'ball_in_ball_cavity', ball(ball(Mesh(), (0, 0, 0), 1), (0, 0, 0), 0.5, turned=True), one * 0.875
    yield 'ball_in_ball_same_way', ball(ball(Mesh(), (0, 0, 0), 1), (0, 0, 0), 0.5), None
    for wall in (1.6, 1.28, 0.9, 0.64, 0.45, 0.26):
        inner = 1 - wall / 64
        yield 'shell_%.2f_voxels' % wall, ball(ball(Mesh(), (0, 0, 0), 1, 48), (0, 0, 0), inner, 48, True), one * (1 - inner ** 3)
    for t in (0.002, 0.01, 0.016, 0.03):
        yield 'plate_%g' % t, box(Mesh(), (-1, -1, -t / 2), (1, 1, t / 2)), 4 * t
    yield 'box_open', Mesh().add(*cut_box()), None
    for degrees in (10, 20, 30, 40, 50, 60):
        x = 2 / math.tan(math.radians(degrees))
        yield 'wedge_%d' % degrees, prism(Mesh(), [(0, 0), (x, 0), (x, 2)], 0, 2), 2 * x
    yield 'star', prism(Mesh(), [((1, 0.3)[i % 2] * math.cos(math.pi * i / 9), (1, 0.3)[i % 2] * math.sin(math.pi * i / 9)) for i in range(18)], 0, 1), 9 * 0.3 * math.sin(math.pi / 9)
    for small in (0.4, 0.1, 0.02, 0.008):
        m = ring(Mesh(), 1, small)
        yield 'ring_%g' % small, m, polyhedron_volume(m)
    yield 'ring_two_linked', ring(Mesh(), 1, 0.3).add([(x + 1, z, y) for x, y, z in ring(Mesh(), 1, 0.3).points], ring(Mesh(), 1, 0.3).faces, True), None

    m = Mesh()  # seat, four legs, a back of slats
    box(m, (0, 0, 0.9), (1, 1, 1))
    for x in (0, 0.93):
        for y in (0, 0.93):
            box(m, (x, y, 0), (x + 0.07, y + 0.07, 0.95))
    for i in range(9):
        box(m, (0.05 + 0.1 * i, 0.97, 0.95), (0.1 + 0.1 * i, 0.985, 2))
    yield 'chair', m, None

    m = Mesh()  # tray: floor and four walls thinner than a voxel at 128
    t = 0.012
    for low, high in (((0, 0, 0), (2, 1, t)), ((0, 0, 0), (t, 1, 0.2)), ((2 - t, 0, 0), (2, 1, 0.2)), ((0, 0, 0), (2, t, 0.2)), ((0, 1 - t, 0), (2, 1, 0.2))):
        box(m, low, high)
    yield 'tray', m, None

    r = random.Random(5)
    m, right = Mesh(), Mesh()  # gantry: many bars that overlap
    for i in range(60):
        low = [r.uniform(0, 4) for _ in range(3)]
        size = [r.uniform(0.05, 0.2) for _ in range(3)]
        size[r.randrange(3)] = r.uniform(1, 4)
        box(m, low, [a + b for a, b in zip(low, size)])
        box(right, low, [a + b for a, b in zip(low, size)])
    yield 'gantry', right, None
    yield 'gantry_flips', flip(m, range(0, 700, 13)), None, right

    for seed in range(6):
        r = random.Random(seed)
        m, right = Mesh(), Mesh()
        for i in range(r.randint(2, 6)):
            c, size, turned = [r.uniform(-1, 1) for _ in range(3)], r.uniform(0.3, 1), r.random() < 0.2
            if r.random() < 0.5:
                angle = r.uniform(0, 3)
                ball(m, c, size, 12, turned, turns=angle)
                ball(right, c, size, 12, turns=angle)
            else:
                high = [a + r.uniform(0.1, 1.5) for a in c]
                box(m, c, high, turned)
                box(right, c, high)
        if seed % 2:
            flip(m, [r.randrange(len(m.faces)) for _ in range(r.randint(1, 20))])
        yield 'heap_%d' % seed, m, None, right
    for name, turned in (('halves_apart', []), ('halves_apart_mirrored', [1])):
        yield name, pieces_apart(2, 1, turned), one + 0.004 * math.pi, pieces_apart(2, 1, [])
    for name, turned in (('eighths_apart', [3]), ('eighths_apart_mirrored', [1, 4, 6])):
        yield name, pieces_apart(4, 2, turned), None, pieces_apart(4, 2, [])
    m = ball(Mesh(), (0, 0, 0), 1, 16)
    yield 'ball_twice', Mesh().add(list(m.points), m.faces + [f[::-1] for f in m.faces]), polyhedron_volume(m), m
    yield 'ball_far', Mesh().add([(x + 600000, y + 5000000, z) for x, y, z in m.points], m.faces), polyhedron_volume(m)
    yield 'balls_apart', ball(ball(Mesh(), (0, 0, 0), 0.2, 12), (10, 0, 0), 1, 16), one * 0 + polyhedron_volume(ball(ball(Mesh(), (0, 0, 0), 0.2, 12), (10, 0, 0), 1, 16))


def pieces_apart(around, high, inside_out):
    """A ball of pieces, 0.004 between them; some are inside out."""
    m, n = Mesh(), 24
    for k in range(around * high):
        j0, h = k % around, k // around
        angle = 2 * math.pi * (j0 + 0.5) / around
        shift = [0.002 * s for s in ((0, math.copysign(1, math.sin(angle))) if around == 2 else (math.copysign(1, math.cos(angle)), math.copysign(1, math.sin(angle))))]
        keep = lambda i, j: j * around // (2 * n) == j0 and i * high // n == h
        ball(m, (shift[0], shift[1], 0 if high == 1 else 0.002 - 0.004 * h), 1, n, k in inside_out, keep)
    return m


def cut_box():
    m = box(Mesh(), (0, 0, 0), (1, 1, 1))
    return m.points, m.faces[2:]
