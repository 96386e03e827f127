"""made_planes.py - contours of a lumpy body on the planes of a sweep, and where they lie on a mesh. For pictures."""
import math


def radius(x, y, z):
    """Of the body, by direction."""
    return 0.8 + 0.25 * z + 0.35 * x * y + 0.3 * x * z * z + 0.15 * math.sin(3 * y)


def dot(a, b):
    return sum(p * q for p, q in zip(a, b))


def unit(a):
    length = math.sqrt(dot(a, a))
    return [p / length for p in a]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def sweep():
    """Normals and heights: six planes through one line, as of a turned ultrasound probe, and two across it."""
    fan = [([math.cos(math.pi * i / 6), math.sin(math.pi * i / 6), 0.0], 0.0) for i in range(6)]
    return fan + [(unit([0.1, 0.2, 1.0]), 0.45), (unit([-0.2, 0.1, 1.0]), -0.3)]


def contour(normal, height, count):
    """Points where rays in the plane, from the foot of the origin on, leave the body: found by halving."""
    u = unit(cross(normal, [0.3, 0.5, 0.8]))
    v = cross(normal, u)
    points = []
    for i in range(count):
        turn = 2 * math.pi * i / count
        way = [math.cos(turn) * a + math.sin(turn) * b for a, b in zip(u, v)]
        low, high = 0.0, 3.0
        for _ in range(60):
            middle = (low + high) / 2
            p = [height * n + middle * w for n, w in zip(normal, way)]
            length = math.sqrt(dot(p, p))
            low, high = (middle, high) if length < radius(*(k / length for k in p)) else (low, middle)
        points.append([height * n + low * w for n, w in zip(normal, way)])
    return points


def write_csl(path, planes, count=72):
    with open(path, 'w') as out:
        out.write('CSLC\n%d 2\n\n' % len(planes))
        for i, (normal, height) in enumerate(planes):
            points = contour(normal, height, count)
            out.write('%d %d 1 %r %r %r %r\n\n' % (i + 1, count, *normal, -height))
            out.writelines('%r %r %r\n' % tuple(p) for p in points)
            out.write('\n%d 1 %s\n\n' % (count, ' '.join(map(str, range(count)))))


def paint(path, painted, planes, near):
    """An OFF file again, its vertices at most so near a plane in red: the contours."""
    lines = open(path).read().split('\n')
    count = int(lines[1].split()[0])
    with open(painted, 'w') as out:
        out.write('COFF\n%s\n' % lines[1])
        for line in lines[2:2 + count]:
            p = [float(word) for word in line.split()[:3]]
            on = min(abs(dot(normal, p) - height) for normal, height in planes) < near
            out.write('%s %s\n' % (' '.join(line.split()[:3]), '190 40 30 255' if on else '215 205 185 255'))
        out.write('\n'.join(lines[2 + count:]))
