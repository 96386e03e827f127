#!/usr/bin/env python3
"""Print src/surface/tables.h, the marching-cubes tables: python3 src/surface/tables.py > src/surface/tables.h
With "whole" print what the tests hold against it: python3 src/surface/tables.py whole > tests/tools/cell_tables.h

Source: Lorensen, Cline. Marching Cubes: A High Resolution 3D Surface Construction Algorithm. 1987 (the 256 cases).

Idea: nothing is typed in by hand. The border of a cell's surface is walked face by face, so two cells always agree on
the face between them; each closed loop of it is then cut into triangles, and among all ways to cut it those stay that
  (a) have no inner edge between two vertices of one cell face (such an edge could meet its twin in the next cell, and
      four triangles would share it),
  (b) have no two triangles that cross or touch beyond what they share, wherever the vertices lie strictly inside their
      edges. This is proven here, not sampled: see separated().
Of these the best shaped one at edge midpoints is taken: least sum of squared inner edges, then the largest smallest
angle, then the first in the order of edge numbers. No step measures orientation, so the two face rules come out as
mirrors: the triangles of a case under one rule are those of its complement under the other, turned round.

Numbers: corner = x + 2y + 4z. x-edges 0..3 by (y,z), y-edges 4..7 by (x,z), z-edges 8..11 by (x,y), the first of the
two counting 1 and the second 2. Needs the standard library only, Python 3.6 or later; the output never varies."""

import itertools
import sys
from fractions import Fraction
from functools import lru_cache

SEPARATE, JOIN = 0, 1
AXES = range(3)
ROW = 16  # entries of a case in the tables of triangle corners: 5 triangles and one spare
WIDTH = 110  # of a line in the header


# ---- The cell ----

def corner_point(corner):
    return (corner & 1, corner >> 1 & 1, corner >> 2)


def build_edges():
    """[edge] -> (low corner, high corner)"""
    edges = []
    for axis in AXES:
        first, second = (1 << a for a in AXES if a != axis)
        for n in range(4):
            low = first * (n & 1) + second * (n >> 1)
            edges.append((low, low + (1 << axis)))
    return edges


def build_faces():
    """The corners of each face, counter-clockwise seen from outside the cell."""
    faces = []
    for axis in AXES:
        u, v = 1 << (axis + 1) % 3, 1 << (axis + 2) % 3
        faces.append([0, v, u + v, u])
        faces.append([(1 << axis) + c for c in (0, u, u + v, v)])
    return faces


EDGES = build_edges()
FACES = build_faces()


def edge_between(a, b):
    return EDGES.index((min(a, b), max(a, b)))


FACE_EDGES = [{edge_between(face[k - 1], face[k]) for k in range(4)} for face in FACES]


def is_set(case, corner):
    return case >> corner & 1


def is_crossed(case, edge):
    low, high = EDGES[edge]
    return is_set(case, low) != is_set(case, high)


# ---- Loops ----

def face_segments(case, rule, face):
    """Border segments on one face, from edge to edge. Seen from outside the cell the set corners lie to the right, so
    the surface is counter-clockwise seen from the empty side."""
    state = [is_set(case, corner) for corner in face]
    ambiguous = state in ([0, 1, 0, 1], [1, 0, 1, 0])
    for k in range(4):
        if state[k] and not state[k - 1]:  # a run of set corners starts at k
            if ambiguous and rule == JOIN:
                last = (k - 2) % 4  # round the empty corner before k, back to the set corner before that
            else:
                last = k
                while state[(last + 1) % 4]:
                    last = (last + 1) % 4
            yield edge_between(face[k - 1], face[k]), edge_between(face[last], face[(last + 1) % 4])


def trace_loops(case, rule):
    """Each loop starts at its smallest edge number, loops are ordered by that number."""
    follower = {}
    for face in FACES:
        for start, end in face_segments(case, rule, face):
            assert start not in follower
            follower[start] = end
    loops = []
    while follower:
        loop = [min(follower)]
        while loop[-1] in follower:
            loop.append(follower.pop(loop[-1]))
        assert loop[-1] == loop[0]
        loops.append(loop[:-1])
    return loops


# ---- Triangulations of one loop ----

def triangulate(polygon):
    """All ways to cut a polygon into triangles."""
    if len(polygon) < 3:
        yield []
    for k in range(1, len(polygon) - 1):
        for left in triangulate(polygon[:k + 1]):
            for right in triangulate(polygon[k:]):
                yield left + [(polygon[0], polygon[k], polygon[-1])] + right


def inner_edges(loop, triangles):
    sides = {frozenset((loop[k - 1], loop[k])) for k in range(len(loop))}
    pairs = {frozenset(pair) for triangle in triangles for pair in itertools.combinations(triangle, 2)}
    return sorted(tuple(sorted(pair)) for pair in pairs - sides)


def lies_on_a_face(pair):
    return any(pair[0] in edges and pair[1] in edges for edges in FACE_EDGES)


def squared_length(a, b):
    return sum((p - q) ** 2 for p, q in zip(vertex_point(a, Fraction(1, 2)), vertex_point(b, Fraction(1, 2))))


def largest_squared_cosine(triangles):
    """Of the smallest angle of all, which is at most 60 degrees, so its cosine is positive and larger is sharper."""
    largest = 0
    for triangle in triangles:
        a, b, c = sorted(squared_length(p, q) for p, q in itertools.combinations(triangle, 2))
        largest = max(largest, (b + c - a) ** 2 / (4 * b * c))
    return largest


def shape(loop, triangles):
    """Sort key, smaller is better."""
    inner = inner_edges(loop, triangles)
    return sum(squared_length(a, b) for a, b in inner), largest_squared_cosine(triangles), inner


def candidates(loop):
    kept = [t for t in triangulate(loop) if not any(map(lies_on_a_face, inner_edges(loop, t)))]
    return sorted(kept, key=lambda triangles: shape(loop, triangles))


# ---- Proof that two triangles do not cross ----

def vertex_point(edge, t):
    point = list(corner_point(EDGES[edge][0]))
    point[edge >> 2] = t
    return tuple(point)


def volume(a, b, c, d):
    """Six times the signed volume of a tetrahedron."""
    u, v, w = ([p - q for p, q in zip(x, a)] for x in (b, c, d))
    return (u[0] * (v[1] * w[2] - v[2] * w[1]) + u[1] * (v[2] * w[0] - v[0] * w[2])
            + u[2] * (v[0] * w[1] - v[1] * w[0]))


@lru_cache(maxsize=None)
def fixed_side(plane, vertex):
    """1 or -1 if the vertex lies strictly on that side of the plane for all positions strictly inside their edges, else
    0. Points of the plane: 0..11 a vertex on that edge, 12..19 a corner of the cell. The volume is affine in each
    position alone, hence everywhere a mean, with positive weights, of its values with all positions at their ends."""
    points = plane + (vertex,)
    moving = sorted({p for p in points if p < 12})
    values = []
    for ends in itertools.product((0, 1), repeat=len(moving)):
        at = dict(zip(moving, ends))
        values.append(volume(*(vertex_point(p, at[p]) if p < 12 else corner_point(p - 12) for p in points)))
    return (max(values) > 0 and min(values) >= 0) - (min(values) < 0 and max(values) <= 0)


def side_of_triangle(plane, triangle):
    """The fixed side of all its vertices that do not lie in the plane, 0 if there is none."""
    sides = {fixed_side(plane, vertex) for vertex in triangle if vertex not in plane}
    return sides.pop() if len(sides) == 1 else 0


@lru_cache(maxsize=None)
def separated(one, two):
    """True if a plane through three points, among them all shared vertices, has the other vertices of the two triangles
    strictly on its two sides for all positions. The triangles then meet inside the plane only, and there only in what
    they share, because no three vertices of a cell are ever in line: a line through three points of a cube's surface
    lies in one face, and in a face it meets at most two sides in their inside."""
    shared = tuple(v for v in one if v in two)
    others = [v for v in one + two if v not in shared] + list(range(12, 20))
    planes = (shared + extra for extra in itertools.combinations(others, 3 - len(shared)))
    return any(side_of_triangle(plane, one) * side_of_triangle(plane, two) < 0 for plane in planes)


# ---- Tables ----

def from_smallest(triangle):
    k = triangle.index(min(triangle))
    return triangle[k:] + triangle[:k]


def case_triangles(case, rule):
    """Loop after loop, inside a loop by edge numbers, each triangle from its smallest edge number on."""
    choices = [candidates(loop) for loop in trace_loops(case, rule)]
    for choice in itertools.product(*choices):
        triangles = [t for part in choice for t in part]
        if all(separated(a, b) for a, b in itertools.combinations(triangles, 2)):
            return [t for part in choice for t in sorted(map(from_smallest, part))]
    raise AssertionError("case %d, rule %d has no triangulation" % (case, rule))


def lane_of(edge):
    """x-edges: their row. y-edges: 4 + z. z-edges: 6 + y."""
    return edge if edge < 4 else 4 + (edge - 4 >> 1)


def offset_of(case, edge):
    """The counter of a y- or z-lane stands at the edge on the cell's low-x side; where that is crossed, the edge at
    x = 1 comes one later."""
    return int(edge >= 4 and edge & 1 and is_crossed(case, edge - 1))


def lane_steps(case):
    return [int(is_crossed(case, edge)) for edge in (0, 1, 2, 3, 4, 6, 8, 10)]


def row_text(values):
    """Trailing zeros are left to the compiler."""
    values = list(values)
    while len(values) > 1 and values[-1] == 0:
        values.pop()
    return "{" + (",".join(map(str, values)) or "0") + "}"


def block(cases):
    """The texts of 256 cases filled into lines; a case number before every line that begins a group."""
    group = 32 if len(max(cases, key=len)) == 1 else 8
    lines = []
    for first in range(0, len(cases), group):
        line = "    /* 0x%02x */ " % first
        for text in cases[first:first + group]:
            if len(line) + len(text) + 1 > WIDTH:
                lines.append(line.rstrip())
                line = " " * 15
            line += text + ", "
        lines.append(line.rstrip())
    return lines


def table(comment, name, shape_text, parts):
    """One part: [256]..., two: one for each face rule."""
    lines = ["", "/* %s */" % comment, "static const uint8_t bvxi_cell_%s%s = {" % (name, shape_text)]
    if len(parts) == 1:
        return lines + block(parts[0]) + ["};"]
    return lines + ["    {"] + block(parts[0]) + ["    }, {"] + block(parts[1]) + ["    }", "};"]


HEAD = """\
/* tables.h - marching-cubes cases: generated by src/surface/tables.py, do not edit.
 *
 * Case: bit c set = corner c of the cell is set, c = x + 2y + 4z. Rule: BVX_FACE_SEPARATE or BVX_FACE_JOIN.
 * Vertex numbers in a cell: x-edges 0..3 by (y,z) = (0,0) (1,0) (0,1) (1,1); y-edges 4..7 by (x,z) and
 * z-edges 8..11 by (x,y) in the same order. Triangles are counter-clockwise seen from the empty side. In a case those of one loop are
 * together.
 *
 * Lanes: walking a row of cells along +x, eight counters number the vertices as they come. Lanes 0..3 count
 * the crossed x-edges of the rows (y,z) = (0,0) (1,0) (0,1) (1,1); lanes 4, 5 the crossed y-edges at z = 0,
 * 1; lanes 6, 7 the crossed z-edges at y = 0, 1. A counter is the number of the next crossing at the cell's
 * low-x side, so a triangle corner is vertex counter[lane] + offset, and after the cell every counter grows
 * by its step. */
#ifndef BVXI_SURFACE_TABLES_H
#define BVXI_SURFACE_TABLES_H

#include <stdint.h>

enum {
    BVXI_CELL_CASES = 256,
    BVXI_CELL_EDGES = 12,
    BVXI_CELL_LANES = 8,
    BVXI_CELL_ROW = %d /* entries of a case: three for each triangle, then zeros */
};
"""


WHOLE_HEAD = """\
/* cell_tables.h - vertices and loops of marching-cubes cases, which src/surface/tables.h holds as lanes and
 * offsets: generated by src/surface/tables.py, do not edit. */
#ifndef CELL_TABLES_H
#define CELL_TABLES_H

#include "surface/tables.h"
"""

RULES = (SEPARATE, JOIN)
CASES = range(256)
PER_CORNER = "[2][BVXI_CELL_CASES][BVXI_CELL_ROW]"


def header():
    triangles = [[case_triangles(case, rule) for case in CASES] for rule in RULES]
    flat = [[[v for t in triangles[rule][case] for v in t] for case in CASES] for rule in RULES]
    assert 3 * max(len(t) for part in triangles for t in part) <= ROW
    text = (HEAD % ROW).splitlines()
    text += table("Triangles.", "triangle_count", "[2][BVXI_CELL_CASES]",
                  [[str(len(t)) for t in part] for part in triangles])
    text += table("Lane of each triangle corner, and 8 times its offset, which is 0 or 1.", "triangle", PER_CORNER,
                  [[row_text(lane_of(edge) + 8 * offset_of(case, edge) for edge in part[case]) for case in CASES]
                   for part in flat])
    text += table("Steps of the lanes from a cell to the next along x, for either rule.", "lane_step",
                  "[BVXI_CELL_CASES][BVXI_CELL_LANES]", [[row_text(lane_steps(case)) for case in CASES]])
    return text


def whole():
    text = WHOLE_HEAD.splitlines()
    text += table("Closed loops in which the surface leaves the cell; each bounds one disc of triangles.", "loop_count",
                  "[2][BVXI_CELL_CASES]", [[str(len(trace_loops(case, rule))) for case in CASES] for rule in RULES])
    text += table("Vertex numbers of the triangles' corners.", "triangle_vertex", PER_CORNER,
                  [[row_text(v for t in case_triangles(case, rule) for v in t) for case in CASES] for rule in RULES])
    return text


if __name__ == "__main__":
    lines = whole() if sys.argv[1:] == ["whole"] else header()
    sys.stdout.buffer.write(("\n".join(lines + ["", "#endif"]) + "\n").encode("ascii"))
