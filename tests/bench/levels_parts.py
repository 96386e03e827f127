"""levels_parts.py - ten parts as a machinist would make them: planes, cylinders, edges of 30 to 90 degrees; finely tessellated.

The same shapes each time, in millimetres. Edges are halved until a part has 20,000 triangles, so that a few percent of them
are still a good model of it.
"""
import numpy as np
from manifold3d import CrossSection, Manifold

LEAST_TRIANGLES = 20000


def cylinder(height, radius, top=None, sides=192, at=(0, 0, 0)):
    return Manifold.cylinder(height, radius, radius if top is None else top, sides).translate(at)


def box(size, at=(0, 0, 0)):
    return Manifold.cube(size).translate(at)


def prism(points, height):
    return Manifold.extrude(CrossSection([np.array(points, dtype=float)]), height)


def ring_of(points, radius):
    """Corners of a regular polygon."""
    angle = 2 * np.pi * np.arange(points) / points
    return np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1)


def around(shape, count):
    """The union of copies turned around z."""
    result = Manifold()
    for i in range(count):
        result += shape.rotate((0, 0, 360 * i / count))
    return result


def plate():
    body = box((80, 50, 8))
    for x, y, radius in ((12, 12, 4), (68, 12, 4), (12, 38, 4), (68, 38, 4), (40, 25, 12)):
        body -= cylinder(10, radius, at=(x, y, -1))
    return body - box((20, 6, 10), (30, 3, 5))


def flange():
    body = cylinder(8, 40) + cylinder(30, 20) + cylinder(4, 25, 20, at=(0, 0, 8))
    body -= cylinder(40, 14, at=(0, 0, -1))
    return body - around(cylinder(10, 4, at=(30, 0, -1)), 6)


def bracket():
    body = box((60, 40, 6)) + box((6, 40, 45))
    body += prism([(6, 6), (30, 6), (6, 30)], 5).rotate((90, 0, 0)).translate((0, 22, 0))
    for y in (8, 32):
        body -= cylinder(10, 3.5, at=(48, y, -2))
        body -= cylinder(10, 3.5).rotate((0, 90, 0)).translate((-2, y, 36))
    return body


def wedge():
    body = prism([(0, 0), (60, 0), (60, 60 * np.tan(np.radians(30)))], 30)
    body -= cylinder(40, 7, sides=512, at=(45, 12, -2))
    return body - cylinder(34, 3, sides=256, at=(34, 9, -2)) - box((8, 40, 12), (20, -2, 9))


def nut():
    body = prism(ring_of(6, 20), 16)
    chamfer = cylinder(40, 30, 10, at=(0, 0, -2)) ^ cylinder(40, 10, 30, at=(0, 0, -22))
    return (body ^ chamfer) - cylinder(20, 10, at=(0, 0, -2))


def shaft():
    body = cylinder(30, 12) + cylinder(40, 16, at=(0, 0, 30)) + cylinder(25, 10, at=(0, 0, 70))
    body += cylinder(3, 10, 7, at=(0, 0, 95)) + cylinder(4, 20, at=(0, 0, 48))
    return body - box((30, 5, 20), (6, -2.5, 4)) - cylinder(12, 3, at=(0, 0, 88))


def tee():
    outer = cylinder(80, 14) + cylinder(40, 12).rotate((0, 90, 0)).translate((0, 0, 40))
    outer += cylinder(5, 20) + cylinder(5, 20, at=(0, 0, 75)) + cylinder(5, 18).rotate((0, 90, 0)).translate((36, 0, 40))
    return outer - cylinder(84, 10, at=(0, 0, -2)) - cylinder(50, 8).rotate((0, 90, 0)).translate((0, 0, 40))


def knob():
    top = Manifold.extrude(CrossSection([ring_of(12, 25)]), 8, scale_top=(0.7, 0.7))
    body = prism(ring_of(12, 25), 20) + top.translate((0, 0, 20))
    return body - prism(ring_of(8, 9), 14).translate((0, 0, -1)) - around(cylinder(40, 2.5, sides=96, at=(25, 0, -1)), 12)


def dovetail():
    slide = prism([(-12, 0), (12, 0), (18, 10.4), (-18, 10.4)], 70)
    body = prism([(-30, -12), (30, -12), (30, 10.4), (-30, 10.4)], 70) - slide.translate((0, 0.001, 0))
    for z in (12, 58):
        body -= cylinder(30, 4).rotate((90, 0, 0)).translate((0, 15, z))
    return body


def sprocket():
    tooth = prism([(24, -4.5), (34, -1.8), (34, 1.8), (24, 4.5)], 9)
    body = cylinder(9, 27) + around(tooth, 14) + cylinder(16, 11)
    body -= cylinder(20, 6, at=(0, 0, -2)) + box((4, 8, 20), (-2, 0, -2))
    return body - around(cylinder(12, 4.5, at=(18, 0, -1)), 5)


PARTS = (plate, flange, bracket, wedge, nut, shaft, tee, knob, dovetail, sprocket)


def part_mesh(make):
    """Positions and triangles of a part, its edges cut until there are enough of them."""
    solid = make()
    low, high = np.array(solid.bounding_box()).reshape(2, 3)
    length = float(np.linalg.norm(high - low)) / 16
    while True:
        fine = solid.refine_to_length(length)
        if fine.num_tri() >= LEAST_TRIANGLES:
            break
        length *= 0.85
    mesh = fine.to_mesh()
    return np.asarray(mesh.vert_properties)[:, :3].astype(np.float32), np.asarray(mesh.tri_verts)
