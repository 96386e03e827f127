"""Section contours."""

import pickle
import warnings

import numpy as np
import pytest
from conftest import ball_grid

import bitvox
from bitvox import Loop, Sections

SQUARE = np.array([[0.0, 0, 0], [4, 0, 0], [4, 4, 0], [0, 4, 0]])


def stack(count=4, step=1.5, points=SQUARE):
    return [points + [0, 0, i * step] for i in range(count)]


def test_prism():
    mesh = bitvox.from_sections(stack())
    found = mesh.check()
    assert found.closed and found.edge_manifold and found.oriented and found.volume == pytest.approx(16 * 4.5)
    assert mesh.vertices.dtype == np.float64 and mesh.report.sections == 4 and mesh.report.prismoid_volume == pytest.approx(72)
    corners = {tuple(v) for v in mesh.vertices.tolist()}
    assert all(tuple(p) in corners for loop in stack() for p in loop.tolist())  # contour points are vertices
    hole = Sections(stack() + stack(points=SQUARE / 2 + [1, 1, 0]))
    assert hole.surface(grid=(20, 20)).check().volume == pytest.approx(12 * 4.5, rel=1e-3)
    assert not bitvox.from_sections(stack(), caps="open").check().closed
    assert bitvox.from_sections(stack(), caps="taper", dtype="float32", spacing=0.5).check().closed
    turned = Sections([loop[:, [2, 0, 1]] for loop in stack()], (1, 0, 0))
    assert turned.surface().check().volume == pytest.approx(72)


def test_labels_and_refusals():
    both = Sections([Loop(p, "ore") for p in stack()] + [Loop(p + [9, 0, 0], "waste") for p in stack(3)])
    assert both.surface(label="ore").check().volume == pytest.approx(72)
    assert both.surface(label="waste").check().volume == pytest.approx(48)
    with pytest.raises(bitvox.ArgumentError, match="label= one of 'ore', 'waste'"):
        both.surface()
    with pytest.raises(bitvox.ArgumentError, match="gold"):
        both.surface(label="gold")
    with pytest.raises(bitvox.EmptyError):
        bitvox.from_sections(stack(1))
    crossed = SQUARE[[0, 2, 1, 3]]
    with pytest.raises(bitvox.FormatError):
        bitvox.from_sections(stack(points=crossed))
    for options in ({"grid": (3, 3), "spacing": 1.0}, {"grid": (1, 9)}, {"caps": "round"}, {"subdivide": 9}, {"crossings": "x"}):
        with pytest.raises(bitvox.Error):
            bitvox.from_sections(stack(), **options)


def test_walls_keep_no_windows():
    def ring(x, z, r):
        turn = np.arange(48) * (2 * np.pi / 48)
        return np.stack([x + r * np.cos(turn), r * np.sin(turn), np.full(48, z)], axis=1)

    walls = Sections([Loop(ring(0.8 * z, z, r)) for z in range(5) for r in (3.0, 2.7)])
    levels = walls.surface()
    assert levels.report.joined_slabs == 0
    assert levels.check().euler == 0 and levels.check().volume == pytest.approx(levels.report.prismoid_volume, rel=0.02)


def test_a_ball_is_nearer_from_five_sections_on():
    turn = np.arange(120) * (2 * np.pi / 120)
    ball = Sections([np.stack([r * np.cos(turn), r * np.sin(turn), np.full(120, z)], axis=1)
                     for z in np.linspace(-0.9, 0.9, 7) for r in [(1 - z * z) ** 0.5]])
    error = {}
    for crossings in ("paper", "exact"):  # the paper's way is straight from section to section
        at = ball.surface(crossings=crossings).vertices
        error[crossings] = np.abs(np.sqrt((at * at).sum(axis=1)) - 1)[np.abs(at[:, 2]) < 0.89].mean()
    assert error["exact"] < 0.5 * error["paper"]


def test_loops_that_meet_are_mended():
    keyhole = [(0, 0), (4, 0), (4, 4), (0, 4), (0, 2), (1, 2), (1, 3), (3, 3), (3, 1), (1, 1), (1, 2), (0, 2)]
    meeting = Sections([Loop([(x, y, z) for x, y in keyhole]) for z in (0, 1)])
    with pytest.raises(bitvox.FormatError, match="crosses or touches itself.*; mend=True splits"):
        meeting.surface()
    mended = meeting.surface(mend=True)
    assert (mended.report.mended_loops, mended.report.holes) == (2, 2)
    assert mended.check().volume == pytest.approx(12) and mended.check().euler == 0
    corner = Loop(SQUARE + [4, 4, 0])
    oblique = Sections.on_planes([Loop(SQUARE), corner, Loop(SQUARE + [0, 0, 3] + np.outer(SQUARE[:, 0], [0, 0, 0.1]))])
    with pytest.raises(bitvox.FormatError, match="cross or touch.*; mend=True splits"):
        oblique.surface(cells=16)
    assert oblique.surface(cells=16, mend=True).report.mended_loops == 2


def test_parts_that_end_towards_each_other_are_told():
    ends = Sections.on_planes([np.array([[x, -1, 0], [x, 1, 0], [0.96 * x, 1, 1], [0.96 * x, -1, 1]]) for x in (-3.0, 3.0)])
    with pytest.warns(UserWarning, match="parts that end towards another one with no plane between: 1,"):
        assert ends.surface(cells=16).check().components == 2


def test_slices_of_a_mesh_that_crosses_itself():
    ball = bitvox.surface(ball_grid(), dtype="float64")
    points = np.concatenate([ball.vertices, ball.vertices + [5, 3, 0.3]])
    both = bitvox.Mesh(points, np.concatenate([ball.faces, ball.faces + len(ball.vertices)]))
    cuts = bitvox.slice_mesh(both, spacing=1.0)
    assert cuts.surface().report.mended_loops > 10 and cuts.of(1).surface().report.mended_loops > 10
    with pytest.raises(bitvox.FormatError, match="mend=True"):
        cuts.surface(mend=False)
    with pytest.raises(TypeError, match="Sections is not a mesh: give its surface"):
        bitvox.voxelize(cuts)


def test_contours_of_other_kinds():
    trimesh = pytest.importorskip("trimesh")
    pairs = [(1.5 * i, SQUARE[:, :2].tolist()) for i in range(4)]
    assert bitvox.from_sections(pairs).content_hash() == bitvox.from_sections(stack()).content_hash()
    ball = trimesh.creation.icosphere(3)
    heights = np.linspace(-1.1, 1.1, 12)
    one_by_one = [ball.section(plane_origin=[0, 0, z], plane_normal=[0, 0, 1]) for z in heights]
    for paths in (one_by_one, ball.section_multiplane([0, 0, 0], [0, 0, 1], heights)):
        body = bitvox.from_sections(paths).check()
        assert body.closed and body.volume == pytest.approx(ball.volume, rel=0.06)
    oblique = [ball.section(plane_origin=[0, 0, 0.1], plane_normal=n) for n in ((0, 0, 1), (1, 0, 0.2), (0, 1, 0.3))]
    assert bitvox.Sections.on_planes(oblique).surface(cells=16).check().closed
    with pytest.raises(bitvox.ArgumentError, match="is open"):
        bitvox.from_sections(trimesh.load_path(np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0.0]])))


def test_bad_stacks_are_named():
    head = "section,position,loop,x,y\n"

    def lines(section, position):
        return "".join(f"{section},{position},0,{x:g},{y:g}\n" for x, y, _ in SQUARE)

    for text, kind, words in (
        (head, bitvox.EmptyError, "no loop"),
        (head + lines(1, 0), bitvox.EmptyError, "in only one section"),
        (head + lines(1, 0) + lines(2, 0), bitvox.FormatError, "lie at one position, 0"),
        (head + lines(1, 0) + lines(2, 1).replace("4,4", "4,-4"), bitvox.FormatError, "crosses or touches itself"),
    ):
        with pytest.raises(kind, match=words):
            bitvox.loads(text.encode(), "csv").surface()
    tilted = b"CSLC\n2 1\n1 3 1 0 0 1 0\n0 0 0 4 0 0 4 4 0\n3 1 0 1 2\n2 3 1 0 0.1 1 -1\n0 0 1 4 0 1 4 4 1.2\n3 1 0 1 2\n"
    with pytest.raises(bitvox.FormatError, match="off its plane"):
        bitvox.loads(tilted.replace(b"0 0.1 1", b"0 0 1"), "csl").surface()
    bent = SQUARE + [[0, 0, 0], [0, 0, 0], [0, 0, 0], [0, 0, 0.5]]
    with pytest.raises(bitvox.ArgumentError, match="loop 1 does not lie in a plane"):
        Sections([SQUARE + [0, 0, 1], bent])
    with pytest.raises(bitvox.FormatError, match="cross or touch"):  # loops at one height are of one section
        Sections([*stack(), SQUARE]).surface()


def test_slices_of_a_mesh():
    ball = bitvox.surface(ball_grid(), dtype="float64")
    sections = bitvox.slice_mesh(ball, spacing=1.0)
    assert len(sections) > 15 and sections.labels == ["1"] and sections.normal == (0.0, 0.0, 1.0)
    assert abs(sections.surface().check().volume / ball.check().volume - 1) < 0.05
    one = bitvox.slice_mesh(ball, positions=[12.0], normal=(0, 2, 0), label=7)
    assert len(one) == 1 and (one.loops[0].points[:, 1] == 12.0).all() and one.loops[0].label == "7"
    for options in ({}, {"spacing": 1.0, "positions": [1.0]}, {"spacing": -1.0}, {"positions": []}, {"spacing": 1, "normal": (0, 0, 0)}):
        with pytest.raises(bitvox.Error):
            bitvox.slice_mesh(ball, **options)
    across = bitvox.slice_mesh(ball, axis="x", spacing=2.0)
    assert across.normal == (1.0, 0.0, 0.0)
    grid = bitvox.Grid.from_numpy(ball_grid())
    assert bitvox.dumps(bitvox.slice_mesh(grid, axis="x", spacing=2.0), "csl") == bitvox.dumps(across, "csl")
    with pytest.raises(bitvox.ArgumentError):
        bitvox.slice_mesh(ball, axis="x", normal=(1, 0, 0), spacing=1.0)
    with pytest.raises(bitvox.ArgumentError):
        bitvox.slice_mesh(ball, axis="w", spacing=1.0)
    again = pickle.loads(pickle.dumps(sections))
    assert bitvox.dumps(again, "csl") == bitvox.dumps(sections, "csl")
    points = sections.loops[0].points
    expected = points.copy()
    del sections
    bitvox.slice_mesh(ball, spacing=1.0)
    assert np.array_equal(points, expected)


@pytest.mark.parametrize("ending", ["csl", "csv", "csl.gz"])
def test_files(tmp_path, ending):
    sections = Sections([Loop(p + [0.1, 0.2, 0.3], "3") for p in stack()])
    sections.save(tmp_path / f"a.{ending}")
    back = bitvox.read(tmp_path / f"a.{ending}")
    assert back.positions == sections.positions and back.section_of == sections.section_of
    assert all(np.array_equal(a.points, b.points) and a.label == b.label for a, b in zip(back.loops, sections.loops))
    from_file = bitvox.from_sections(tmp_path / f"a.{ending}")
    assert from_file.content_hash() == bitvox.from_sections(sections).content_hash()
    with pytest.raises(bitvox.FormatError):
        bitvox.loads(b"nonsense", "csl")
    with pytest.raises(bitvox.UnsupportedError):
        bitvox.dumps(sections, "ply")


def test_loops_left_open_in_csv():
    lines = "section,position,loop,x,y\n" + "".join(f"{s},{s},0,{x},{y}\n" for s in (0, 1) for x, y in ((0, 0), (4, 0), (4, 4), (0, 4)))
    assert bitvox.loads(lines.encode(), "csv").surface().check().volume == pytest.approx(16)
    with pytest.raises(bitvox.FormatError):
        bitvox.loads(lines.encode(), "csv", close_gap=0.5)
    with pytest.raises(bitvox.ArgumentError):
        bitvox.loads(b"", "ply", close_gap=1.0)


def test_bishop(shared):
    sections = bitvox.read(shared("contours/orex_SideBishop.csl"))
    assert len(sections) == 10 and len(sections.loops) == 22
    found = sections.surface(grid=(40, 40)).check()
    assert found.closed and found.edge_manifold and found.oriented


def test_planes_of_any_direction() -> None:
    text = (b"CSLC\n2 1\n1 4 1 0 0 1 0\n0 0 0 4 0 0 4 4 0 0 4 0\n4 1 0 1 2 3\n"
            b"2 4 1 1 0 0 -2\n2 0 -2 2 4 -2 2 4 2 2 0 2\n4 1 0 1 2 3\n")
    crossed = bitvox.loads(text, "csl")
    assert crossed.normals == ((0.0, 0.0, 1.0), (1.0, 0.0, 0.0)) and crossed.positions == [0.0, 2.0]
    mesh = crossed.surface(cells=16)
    vertices = {tuple(p) for p in mesh.vertices.tolist()}
    assert all(tuple(p) in vertices for loop in crossed.loops for p in loop.points.tolist())
    assert mesh.report.planes == 2 and mesh.report.gaps == 0
    assert crossed.of(1) == crossed and crossed.of(1).normals is not None
    apart = bitvox.loads(text.replace(b"2 4 -2 2 4 2", b"2 6 -2 2 6 2"), "csl")
    with pytest.raises(bitvox.FormatError, match="sections 0 and 1 contradict each other"):
        apart.surface(cells=16)
    assert apart.surface(cells=16, agree=2.5).report.gaps == 0
    with pytest.raises(bitvox.ArgumentError, match="cells and spacing"):
        crossed.surface(cells=16, spacing=1.0)


def test_bodies_of_all_labels_are_those_one_by_one():
    square = np.array([[0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0]], float)
    loops = [bitvox.Loop(square + [3 * i, 0, z], name) for i, name in enumerate(("a", "b", "c")) for z in (0, 1, 3)]
    stack = bitvox.Sections(loops)
    bodies = stack.bodies(spacing=0.5)
    assert list(bodies) == ["a", "b", "c"]
    for name, body in bodies.items():
        assert body.content_hash() == bitvox.from_sections(stack, label=name, spacing=0.5).content_hash()
    with pytest.raises(TypeError):
        stack.bodies(label="a")


def _faces(mesh):
    """Each triangle by its corners' places, in order, and which way round they go."""
    made = {}
    for corners in mesh.vertices[mesh.faces]:
        places = [tuple(corner) for corner in corners.tolist()]
        order = sorted(range(3), key=places.__getitem__)
        made[tuple(places[i] for i in order)] = order in ([0, 1, 2], [1, 2, 0], [2, 0, 1])
    return made


def test_bodies_that_touch_share_their_faces():
    square = np.array([[0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0]], float)
    loops = [bitvox.Loop(square + [2 * i, 0, z], name) for i, name in enumerate(("a", "b", "c")) for z in (0, 1, 3)]
    bodies = bitvox.Sections(loops).bodies(touching="shared", cells=48)
    assert list(bodies) == ["a", "b", "c"]
    for body in bodies.values():
        assert body.check().closed and body.check().oriented
        assert body.check().volume == pytest.approx(12, rel=0.05)
    faces = {name: _faces(body) for name, body in bodies.items()}
    for one, two, shared in (("a", "b", True), ("b", "c", True), ("a", "c", False)):
        both = set(faces[one]) & set(faces[two])
        assert (len(both) > 20) == shared
        assert all(faces[one][face] != faces[two][face] for face in both)
        assert all(place[0] == pytest.approx(2 if one == "a" else 4, abs=0.1) for face in both for place in face)
    with pytest.raises(bitvox.ArgumentError, match="grid is not used with touching='shared'"):
        bitvox.Sections(loops).bodies(touching="shared", grid=(5, 5))
    with pytest.raises(bitvox.ArgumentError, match="touching is 'glued'"):
        bitvox.Sections(loops).bodies(touching="glued")
    with pytest.raises(bitvox.FormatError, match="labels 1 and 2 overlap"):
        bitvox.Sections([bitvox.Loop(loop.points * [1.5, 1, 1] if loop.label == "a" else loop.points, loop.label) for loop in loops]).bodies(touching="shared")


def test_sections_without_loops_have_no_bodies():
    none = bitvox.Sections([])
    assert none.bodies() == none.bodies(touching="shared") == {}
    with pytest.raises(bitvox.ArgumentError, match="grid is not used"):
        none.bodies(touching="shared", grid=(5, 5))


def test_one_section_alone_is_a_slab_or_a_lens():
    square = np.array([[0, 0, 5], [2, 0, 5], [2, 2, 5], [0, 2, 5]], float)
    with pytest.raises(bitvox.EmptyError, match="or a thickness"):
        bitvox.from_sections([square])
    slab = bitvox.from_sections([square], thickness=0.5).check()
    assert slab.closed and slab.volume == pytest.approx(2.0) and (slab.low[2], slab.high[2]) == (4.75, 5.25)
    lens = bitvox.from_sections([square], thickness=0.5, caps="taper").check()
    assert lens.closed and lens.volume == pytest.approx(2.0 / 3, rel=0.05)
    with pytest.raises(bitvox.ArgumentError):
        bitvox.from_sections([square], thickness=-1)


def test_tables_hold_planes_of_any_direction(tmp_path):
    square = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], float)
    table = ["section,position,loop,x,y,z,nx,ny,nz"]
    for axis in range(3):
        normal = ",".join(str(int(i == axis)) for i in range(3))
        table += [f"{axis},0,0,{x:g},{y:g},{z:g},{normal}" for x, y, z in np.roll(square, axis + 1, axis=1)]
    (tmp_path / "cross.csv").write_text("\n".join(table))
    stack = bitvox.read(tmp_path / "cross.csv")
    assert np.allclose(stack.normals, np.eye(3)) and len(stack.loops) == 3
    assert bitvox.from_sections(stack, cells=16).check().closed
    stack.save(tmp_path / "again.csv")
    assert bitvox.read(tmp_path / "again.csv") == stack


def crossing_circles():
    turn = np.linspace(0, 2 * np.pi, 40, endpoint=False)
    circle = np.stack([np.cos(turn), np.sin(turn), 0 * turn], axis=1)
    return [circle, np.roll(circle, 1, axis=1), np.roll(circle, 2, axis=1), 0.8 * circle + [0, 0, 0.6]]


def test_loops_on_planes_of_any_direction():
    loops = crossing_circles() + [0.3 * crossing_circles()[0] + [0, 3, 0]]
    stack = bitvox.Sections.on_planes(loops)
    assert len(stack.positions) == 4 and stack.section_of == [0, 1, 2, 3, 0]
    assert np.allclose(stack.normals, [[0, 0, 1], [1, 0, 0], [0, 1, 0], [0, 0, 1]]) and np.allclose(stack.positions, [0, 0, 0, 0.6])
    assert bitvox.from_sections(bitvox.Sections.on_planes(crossing_circles()), cells=24).check().closed
    turned = np.array([[0.36, 0.48, -0.8], [-0.8, 0.6, 0.0], [0.48, 0.64, 0.6]])
    parallel = bitvox.Sections.on_planes([loops[0] @ turned, loops[3] @ turned])
    assert parallel.normals is None and len(parallel.positions) == 2
    with pytest.raises(bitvox.ArgumentError, match="loop 0 does not lie in a plane"):
        bitvox.Sections.on_planes([np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0.2], [0, 1, 0]], float)])
    with pytest.raises(bitvox.ArgumentError, match="loop 1 has no area"):
        bitvox.Sections.on_planes([loops[0], np.array([[0, 0, 0], [1, 0, 0], [2, 0, 0]], float)])


def test_drawings_and_structures_keep_planes_of_any_direction(tmp_path):
    ezdxf = pytest.importorskip("ezdxf")
    drawing = ezdxf.new()
    for loop in crossing_circles():
        drawing.modelspace().add_polyline3d(loop.tolist(), close=True)
    drawing.saveas(tmp_path / "cross.dxf")
    stack = bitvox.read(tmp_path / "cross.dxf")
    assert len(stack.normals) == 4
    body = bitvox.from_sections(stack, cells=24).check()
    assert body.closed and body.volume == pytest.approx(4 * np.pi / 3, rel=0.15)
    with pytest.raises(bitvox.ArgumentError, match="across the normal"):
        bitvox.formats.read_dxf(tmp_path / "cross.dxf", normal=(0, 0, 1))

    pytest.importorskip("pydicom")
    bitvox.formats.write_rtstruct(stack, tmp_path / "cross.dcm")
    again = bitvox.read(tmp_path / "cross.dcm")
    assert np.allclose(again.normals, stack.normals, atol=1e-6) and again.section_of == stack.section_of


NAMES = ("left, outer", "rechts \u00e4", "7")


def named_stack():
    square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
    return bitvox.Sections([bitvox.Loop(square + [3 * i, 0, z], name) for i, name in enumerate(NAMES) for z in (0, 1)])


def test_names_of_bodies_stand_in_tables(tmp_path):
    stack = named_stack()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        stack.save(tmp_path / "a.csv")
        assert bitvox.read(tmp_path / "a.csv") == stack and bitvox.loads(bitvox.dumps(stack, "csv"), "csv").labels == list(NAMES)
        assert bitvox.from_sections(tmp_path / "a.csv", label="left, outer").n_faces
        bitvox.slice_mesh(bitvox.Grid.from_numpy(np.ones((4, 4, 4))).surface(), spacing=1, label=5).save(tmp_path / "n.csl")
    assert bitvox.dumps(bitvox.Sections([stack.loops[0].points]), "csv").startswith(b"section,position,loop,label,x,y\n")
    with pytest.warns(UserWarning, match=r"1 for 'left, outer', 2 for .*3 for '7'.*\.csv keeps"):
        stack.save(tmp_path / "a.csl")
    assert bitvox.read(tmp_path / "a.csl").labels == ["1", "2", "3"]


def test_columns_of_others_name_no_bodies():
    head, rows = "section,position,loop,label,x,y,body", ["0,0,0,1,0,0,a", "0,0,0,1,1,0,a", "0,0,0,1,0,1,a"]
    assert bitvox.loads("\n".join([head, *rows]).encode(), "csv").labels == ["a"]
    more = [row.replace("0,0,0,1", "0,0,1,2", 1) for row in rows]
    assert bitvox.loads("\n".join([head, *rows, *more]).encode(), "csv").labels == ["1", "2"]  # two bodies of one name


def test_a_csl_with_the_other_sign_of_d():
    rows = "0 0 {0} 4 0 {0} 4 4 {0}\n3 1 0 1 2\n"
    text = "CSLC\n2 2\n" + "".join(f"{i} 3 1 0 0 1 {sign}{i}\n{rows.format(i)}" for i, sign in ((1, "{s}"), (2, "{s}")))
    with pytest.warns(UserWarning, match="D has the other sign on all planes"):
        found = bitvox.loads(text.replace("{s}", "").encode(), "csl")
    assert found == bitvox.loads(text.replace("{s}", "-").encode(), "csl") and found.positions == [1.0, 2.0]
