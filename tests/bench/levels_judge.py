"""levels_judge.py - measures a simplified mesh against the input by nothing of ours: distances by libigl, crossings by MeshLib.

A mesh here is a pair of arrays: positions [n, 3] in doubles, triangles [m, 3]. Distances are from points drawn evenly over the
area of one surface to the nearest point of the other one, with a fixed seed, in percent of the diagonal of the input's bounds.
"""
import igl
import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

try:
    import meshlib.mrmeshnumpy as meshlib_arrays
    import meshlib.mrmeshpy as meshlib
except ImportError:
    meshlib = None

SAMPLES = 100000
SHARP_INPUT, SHARP_LEVEL = 25.0, 20.0  # degrees between the facets of an edge that counts as sharp
SHARP_NEAR, SHARP_TURN = 0.002, 20.0  # kept: a sharp edge within this share of the diagonal that turns by fewer degrees


def weld(positions, triangles):
    """Merges vertices at equal positions and drops triangles with two equal corners."""
    bits = np.ascontiguousarray(positions + 0.0)  # minus zero becomes zero
    _, first, joined = np.unique(bits.view([("", bits.dtype)] * 3).ravel(), return_index=True, return_inverse=True)

    # Vertices stay in the order of the file: some libraries gain by its locality.
    order = np.argsort(first)
    place = np.empty_like(order)
    place[order] = np.arange(len(order))
    faces = place[joined.ravel()][triangles]
    a, b, c = faces.T
    faces = faces[(a != b) & (b != c) & (c != a)]

    used = np.zeros(len(order), dtype=bool)
    used[faces] = True
    return bits[first[order]][used], (np.cumsum(used) - 1)[faces]


def facet_normals(positions, triangles):
    """Unit normals, zero where a triangle has no area; and the areas."""
    a, b, c = (positions[triangles[:, i]] for i in range(3))
    cross = np.cross(b - a, c - a)
    length = np.linalg.norm(cross, axis=1)
    return cross / np.where(length > 0, length, 1)[:, None], 0.5 * length


def sample(positions, triangles, seed, count=SAMPLES):
    """Points drawn evenly over the area, and the triangle of each."""
    random = np.random.default_rng(seed)
    area = facet_normals(positions, triangles)[1]
    facet = random.choice(len(triangles), size=count, p=area / area.sum())
    root, v = np.sqrt(random.random(count))[:, None], random.random(count)[:, None]
    a, b, c = (positions[triangles[facet, i]] for i in range(3))
    return (1 - root) * a + root * (1 - v) * b + root * v * c, facet


# ---- edges, components, crossings ----


def edge_table(triangles):
    """Edges as pairs of vertices, the number of triangles at each, and for each half edge its edge."""
    pairs = np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1).astype(np.int64)
    keys, edge_of, count = np.unique(pairs[:, 0] << 32 | pairs[:, 1], return_inverse=True, return_counts=True)
    return np.stack([keys >> 32, keys & 0xFFFFFFFF], axis=1), count, edge_of.ravel()


def count_components(triangles, vertex_count):
    """Components that hang together through vertices."""
    a = np.concatenate([triangles[:, 0], triangles[:, 1]])
    b = np.concatenate([triangles[:, 1], triangles[:, 2]])
    graph = coo_matrix((np.ones(len(a), dtype=np.int8), (a, b)), shape=(vertex_count, vertex_count))
    return int(connected_components(graph, directed=False)[0])


def crossing_triangles(positions, triangles):
    """Triangles that cross another one; None without MeshLib. It does not count two that share an edge and lie on each other."""
    if meshlib is None:
        return None

    # MeshLib takes floats: what came from floats stays exact, other positions are moved where floats are dense.
    floats = positions.astype(np.float32)
    if (floats != positions).any():
        floats = (positions - (positions.min(axis=0) + positions.max(axis=0)) / 2).astype(np.float32)
    mesh = meshlib_arrays.meshFromFacesVerts(triangles.astype(np.int32), floats)
    return int(meshlib.findSelfCollidingTrianglesBS(meshlib.MeshPart(mesh)).count())


def shape_of(positions, triangles):
    """Counts of a welded mesh."""
    _, count, _ = edge_table(triangles)
    return {
        "boundary_edges": int((count == 1).sum()),
        "nonmanifold_edges": int((count > 2).sum()),
        "components": count_components(triangles, len(positions)),
        "crossing_triangles": crossing_triangles(positions, triangles),
    }


# ---- sharp edges ----


def sharp_edges(positions, triangles, degrees):
    """Ends [n, 2, 3] of the edges between two facets whose normals differ by this angle or more."""
    edges, count, edge_of = edge_table(triangles)
    order = np.argsort(edge_of, kind="stable")
    first = np.cumsum(count) - count
    two = np.flatnonzero(count == 2)
    normals, area = facet_normals(positions, triangles)
    one, other = order[first[two]] // 3, order[first[two] + 1] // 3

    cosine = (normals[one] * normals[other]).sum(axis=1)
    sharp = (cosine <= np.cos(np.radians(degrees))) & (area[one] > 0) & (area[other] > 0)
    return positions[edges[two[sharp]]]


def points_along(ends, step):
    """Points at most a step apart along segments, the direction and the length that each stands for."""
    length = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    count = np.maximum(np.ceil(length / step), 1).astype(np.int64)
    owner = np.repeat(np.arange(len(ends)), count)
    index = np.arange(len(owner)) - np.repeat(np.cumsum(count) - count, count)
    along = ((index + 0.5) / count[owner])[:, None]
    direction = (ends[:, 1] - ends[:, 0]) / np.where(length > 0, length, 1)[:, None]
    return ends[owner, 0] * (1 - along) + ends[owner, 1] * along, direction[owner], (length / count)[owner]


def sharp_kept(ends, level, diagonal):
    """Share of the length of the input's sharp edges that have a sharp edge of the level beside them."""
    points, direction, length = points_along(ends, 0.0005 * diagonal)
    level_ends = sharp_edges(*level, SHARP_LEVEL)
    if len(points) == 0:
        return None
    if len(level_ends) == 0:
        return 0.0
    level_points, level_direction, _ = points_along(level_ends, 0.0005 * diagonal)

    # Where edges meet, the nearest one may turn off: one of the nearest few must run along.
    few = min(8, len(level_points))
    distance, index = cKDTree(level_points).query(points, k=few)
    distance, index = distance.reshape(-1, few), index.reshape(-1, few)
    along = np.abs((level_direction[index] * direction[:, None]).sum(axis=2)) >= np.cos(np.radians(SHARP_TURN))
    return float(length[(along & (distance <= SHARP_NEAR * diagonal)).any(axis=1)].sum() / length.sum())


# ---- the judge ----


class Judge:
    """An input, prepared once; measure() compares a level with it."""

    def __init__(self, positions, triangles, seed=16):
        self.mesh = np.ascontiguousarray(positions, dtype=np.float64), np.ascontiguousarray(triangles, dtype=np.int64)
        self.diagonal = float(np.linalg.norm(np.ptp(self.mesh[0], axis=0)))
        self.seed = seed
        self.tree = igl.AABB()
        self.tree.init(*self.mesh)
        self.points, self.facet = sample(*self.mesh, seed)
        self.normals = facet_normals(*self.mesh)[0]
        self.sharp = None

    def angles(self, mine, theirs):
        """Mean angle in degrees between normals, without triangles that have none."""
        both = mine.any(axis=1) & theirs.any(axis=1)
        cosine = np.clip((mine[both] * theirs[both]).sum(axis=1), -1, 1)
        return float(np.degrees(np.arccos(cosine)).mean())

    def measure(self, positions, triangles, with_sharp=False):
        level = np.ascontiguousarray(positions, dtype=np.float64), np.ascontiguousarray(triangles, dtype=np.int64)
        normals, area = facet_normals(*level)
        if not area.sum() > 0:
            return {"made": len(triangles), "failed": "nothing is left"}

        points, facet = sample(*level, self.seed + 1)
        to_squared, to_facet, _ = self.tree.squared_distance(*self.mesh, points)
        tree = igl.AABB()
        tree.init(*level)
        from_squared, from_facet, _ = tree.squared_distance(*level, self.points)
        percent = 100 / self.diagonal
        to, back = np.sqrt(to_squared) * percent, np.sqrt(from_squared) * percent

        welded = weld(*level)
        result = {
            "made": len(welded[1]),
            "mean": float(to.mean() + back.mean()) / 2,
            "to_input": float(to.mean()),
            "from_input": float(back.mean()),
            "max": float(max(to.max(), back.max())),
            "normal_to": self.angles(normals[facet], self.normals[to_facet]),
            "normal_from": self.angles(self.normals[self.facet], normals[from_facet]),
        }
        result.update(shape_of(*welded))
        if with_sharp:
            if self.sharp is None:
                self.sharp = sharp_edges(*weld(*self.mesh), SHARP_INPUT)
            result["sharp_kept"] = sharp_kept(self.sharp, welded, self.diagonal)
        return result
