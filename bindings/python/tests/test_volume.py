"""Scalar volumes beside numpy, scikit-image and the files of other writers."""

import gzip
import json
import pickle
import struct

import numpy as np
import pytest

import bitvox
from conftest import REPOSITORY, SHARED

TYPES = ("u1", "i1", "u2", "i2", "u4", "i4", "u8", "i8", "f4", "f8")


def noise(shape=(70, 9, 7), dtype="f4", seed=1):
    """Whole numbers 0 to 100."""
    return np.random.default_rng(seed).integers(0, 101, shape).astype(dtype)


@pytest.mark.parametrize("dtype", [*TYPES, ">i2", ">f8", "f2"])
def test_threshold_of_every_type(dtype):
    a = noise(dtype=dtype)
    for view in (a, np.asfortranarray(a), a[::-1, ::2, ::-3], a.transpose(1, 2, 0), a[5:6]):
        v = bitvox.Volume(view)
        assert (v.threshold(30, 60).to_numpy() == ((view >= 30) & (view <= 60))).all()
        assert v.report.inside == ((view >= 30) & (view <= 60)).sum()
        assert (v.report.least, v.report.greatest) == (view.min(), view.max())


def test_arrays_are_not_copied():
    a = noise((20, 20, 20))
    for view in (a, a[::-2, ::3], a.T):
        assert np.shares_memory(bitvox.Volume(view).array, a)
    assert bitvox.Volume(np.broadcast_to(np.float32(3), (4, 5, 6))).threshold(3).count == 120
    assert bitvox.Volume(a > 50).threshold(1).count == (a > 50).sum()


def test_nan_and_infinity_are_outside_and_counted():
    a = noise()
    a[3, 4, 5], a[10, 2, 2], a[69, 8, 6] = np.nan, np.inf, -np.inf
    v = bitvox.Volume(a)
    assert (v.threshold().to_numpy() == np.isfinite(a)).all()
    assert (v.report.nan, v.report.infinite) == (1, 2)
    mesh = v.surface(50)
    assert (v.report.nan, v.report.infinite) == (1, 2)
    c = mesh.check()
    assert c.closed and c.edge_manifold and c.vertex_manifold and c.oriented


def test_order_spacing_and_lattice():
    a = noise((5, 6, 7))
    v = bitvox.Volume(a, order="zyx", spacing=(1, 2, 3), corner=(9, 8, 7))
    assert v.shape == (7, 6, 5) and v.spacing == (1, 2, 3)
    assert v.threshold(50) == bitvox.Grid.from_numpy(a >= 50, order="zyx", spacing=(1, 2, 3), corner=(9, 8, 7))
    part = v.window((1, 2, 0, 6, 5, 4))
    assert part.low == (1, 2, 0) and part.shape == (5, 3, 4)
    assert (part.threshold(50).to_numpy() == v.threshold(50).to_numpy()[1:6, 2:5, 0:4]).all()
    with pytest.raises(bitvox.ArgumentError):
        v.window((0, 0, 0, 8, 1, 1))


def test_refusals():
    for bad in (np.zeros((3, 3)), np.zeros((3, 0, 3))):
        with pytest.raises(bitvox.ArgumentError):
            bitvox.Volume(bad)
    with pytest.raises(TypeError):
        bitvox.Volume(np.zeros((2, 2, 2), complex))
    with pytest.raises(bitvox.ArgumentError):
        bitvox.Volume(np.zeros((2, 2, 2))).threshold(np.nan)
    with pytest.raises(bitvox.UnsupportedError):
        bitvox.Volume(np.zeros((2, 2, 2))).labels()


def ball(n=40):
    at = (np.arange(n) + 0.5) * 2 / n - 1
    x, y, z = np.meshgrid(at, at, at, indexing="ij")
    return 0.8 - np.sqrt(x * x + y * y + z * z)


def test_surface_beside_scikit_image():
    measure = pytest.importorskip("skimage.measure")
    a = ball()
    mesh = bitvox.Volume(a, spacing=0.05, corner=(-1, -1, -1)).surface(0, dtype="float64")
    theirs, _, _, _ = measure.marching_cubes(a, 0, spacing=(0.05,) * 3)
    theirs = theirs - 1 + 0.025
    assert len(theirs) == mesh.n_vertices  # one vertex an edge; none of these lies at an edge's end
    mine = np.asarray(mesh.vertices)
    order = lambda v: v[np.lexsort(np.round(v, 5).T)]  # noqa: E731
    inner = 1 / 128 * 0.05 * 1.01  # what keeping off the ends may move
    assert np.abs(order(mine) - order(theirs)).max() < inner
    assert mesh.check().volume == pytest.approx(4 / 3 * np.pi * 0.8**3, rel=0.01)


def test_windows_merge_to_the_whole():
    v = bitvox.Volume(noise((33, 12, 10)))
    whole = v.surface(50, keys=True)
    parts = [v.window((0, 0, 0, 17, 12, 10)).surface(50, keys=True, open_sides="x-high"),
             v.window((16, 0, 0, 33, 12, 10)).surface(50, keys=True, open_sides="x-low")]
    assert bitvox.merge(parts).content_hash() == whole.content_hash()


@pytest.mark.parametrize("dtype", ["u1", "i2", "i4", "i8", "u8"])
def test_labels(dtype):
    a = np.random.default_rng(3).integers(-5 if dtype[0] == "i" else 0, 9, (20, 10, 8)).astype(dtype)
    v = bitvox.Volume(a)
    values, counts = np.unique(a[a != 0], return_counts=True)
    found = v.labels()
    assert [(f.value, f.voxels) for f in found] == list(zip(values.tolist(), counts.tolist()))
    for one in found:
        at = np.argwhere(a == one.value)
        assert one.low == tuple(at.min(0)) and one.size == tuple(np.ptp(at, axis=0) + 1)
        assert (v.label(one.value).to_numpy() == (a == one.value)).all()


# ---- files ----


def nrrd(a, encoding="raw", more="", data=None):
    """The bytes of an .nrrd file."""
    kind = {"u1": "uint8", "i2": "int16", "u2": "uint16", "i4": "int32", "f4": "float", "f8": "double", "u8": "uint64"}
    head = f"NRRD0004\ntype: {kind[a.dtype.str[1:]]}\ndimension: 3\nsizes: {' '.join(map(str, a.shape))}\nencoding: {encoding}\n"
    head += f"endian: {'big' if a.dtype.byteorder == '>' else 'little'}\n{more}"
    raw = a.tobytes(order="F")
    packed = gzip.compress(raw) if encoding == "gzip" else " ".join(map(str, a.ravel(order="F"))).encode() if encoding == "ascii" else raw
    return (head.encode() + b"\n" + packed) if data is None else head.encode() + f"data file: {data}\n".encode()


@pytest.mark.parametrize("encoding", ["raw", "gzip", "ascii"])
@pytest.mark.parametrize("dtype", ["u1", "<i2", ">i2", "<f4", ">f8", "<u8"])
def test_nrrd(tmp_path, encoding, dtype):
    a = noise((11, 5, 4), dtype)
    (tmp_path / "a.nrrd").write_bytes(nrrd(a, encoding, "spacings: 0.5 1 2\n"))
    v = bitvox.read_volume(tmp_path / "a.nrrd")
    assert v.array.dtype == a.dtype.newbyteorder("=") and (v.array == a).all() and v.spacing == (0.5, 1, 2)


def test_nrrd_with_data_files(tmp_path):
    a = noise((6, 5, 4), "<i2")
    (tmp_path / "one.raw").write_bytes(a.tobytes(order="F"))
    (tmp_path / "a.nhdr").write_bytes(nrrd(a, data="one.raw"))
    assert (bitvox.read_volume(tmp_path / "a.nhdr").array == a).all()
    for z in range(4):
        (tmp_path / f"s.{z + 8:03d}").write_bytes(a[:, :, z].tobytes(order="F"))
    (tmp_path / "b.nhdr").write_bytes(nrrd(a, data="s.%03d 8 11 1"))
    assert (bitvox.read_volume(tmp_path / "b.nhdr").array == a).all()
    (tmp_path / "c.nhdr").write_bytes(nrrd(a, data="LIST\n" + "\n".join(f"s.{z + 8:03d}" for z in range(4))))
    assert (bitvox.read_volume(tmp_path / "c.nhdr").array == a).all()
    (tmp_path / "one.raw.gz").write_bytes(gzip.compress(a.tobytes(order="F")))
    (tmp_path / "d.nhdr").write_bytes(nrrd(a, "gzip", data="one.raw.gz"))
    assert (bitvox.read_volume(tmp_path / "d.nhdr").array == a).all()
    (tmp_path / "s.010").unlink()
    with pytest.raises(OSError):
        bitvox.read_volume(tmp_path / "b.nhdr")
    for away in ("../one.raw", str(tmp_path / "one.raw"), "sub/../../one.raw"):
        (tmp_path / "e.nhdr").write_bytes(nrrd(a, data=away))
        with pytest.raises(bitvox.FormatError, match="only files in its own folder"):
            bitvox.read_volume(tmp_path / "e.nhdr")


def test_data_files_count_together(tmp_path):
    (tmp_path / "one.raw").write_bytes(bytes(100_000))
    (tmp_path / "one.raw.gz").write_bytes(gzip.compress(bytes(100_000)))
    for name in ("one.raw", "one.raw.gz"):
        head = "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 100 100 80\nencoding: raw\ndata file: LIST\n"
        (tmp_path / "a.nhdr").write_text(head + f"{name}\n" * 8)
        assert bitvox.read_volume(tmp_path / "a.nhdr", memory_limit=900_000).shape == (100, 100, 80)
        with pytest.raises(bitvox.MemoryLimitError, match="99[0-9]{3} bytes that memory_limit leaves"):
            bitvox.read_volume(tmp_path / "a.nhdr", memory_limit=300_000)


def test_damaged_gzip_is_refused(tmp_path):
    a = noise((11, 5, 4), "<i2")
    good = nrrd(a, "gzip")
    at = good.index(b"\n\n") + 2
    for bad in (good[:-9], good[:at] + gzip.compress(a.tobytes()[:-2]), good[:at] + gzip.compress(a.tobytes() + b"xx"),
                good[: at + 20] + bytes([good[at + 20] ^ 255]) + good[at + 21 :]):
        (tmp_path / "a.nrrd").write_bytes(bad)
        with pytest.raises(bitvox.FormatError):
            bitvox.read_volume(tmp_path / "a.nrrd")


@pytest.mark.parametrize("order", "CF")
@pytest.mark.parametrize("dtype", ["?", "u1", ">u2", "<i4", "<i8", "f2", ">f2", "f4", ">f8"])
def test_npy(tmp_path, dtype, order):
    a = np.asarray(noise((11, 5, 4), "f8") / 7 - 6).astype(dtype, order=order)
    np.save(tmp_path / "a.npy", a)
    v = bitvox.read_volume(tmp_path / "a.npy", spacing=2)
    assert (v.array == a).all() and v.spacing == (2, 2, 2)


def test_half_precision_is_exact(tmp_path):
    a = np.arange(65536, dtype=np.uint16).view(np.float16).reshape(64, 32, 32)
    np.save(tmp_path / "a.npy", a)
    mine = bitvox.read_volume(tmp_path / "a.npy").array
    assert np.array_equal(mine, a.astype(np.float32), equal_nan=True)


def test_raw(tmp_path):
    a = noise((7, 6, 5), ">u2")
    (tmp_path / "a.raw").write_bytes(b"skip" + a.tobytes(order="F") + b"more")
    v = bitvox.read_volume(tmp_path / "a.raw", shape=(7, 6, 5), dtype=">u2", offset=4, spacing=(1, 2, 3), corner=(4, 5, 6))
    assert (v.array == a).all() and v.lattice.corner == (4, 5, 6)
    with pytest.raises(bitvox.FormatError):
        bitvox.read_volume(tmp_path / "a.raw", shape=(7, 6, 6), dtype=">u2")
    with pytest.raises(bitvox.ArgumentError):
        bitvox.read_volume(tmp_path / "a.raw")


def test_vti_of_a_field(tmp_path):
    a = noise((6, 5, 4), "<f4")
    raw = a.tobytes(order="F")
    head = ('<VTKFile type="ImageData" version="1.0" byte_order="LittleEndian" header_type="UInt32"><ImageData WholeExtent="0 5 0 4 0 3" '
            'Origin="1 2 3" Spacing="2 2 2"><Piece Extent="0 5 0 4 0 3"><PointData Scalars="d"><DataArray type="Float32" Name="d" '
            'format="appended" offset="0"/></PointData></Piece></ImageData><AppendedData encoding="raw">_')
    (tmp_path / "a.vti").write_bytes(head.encode() + struct.pack("<I", len(raw)) + raw + b"</AppendedData></VTKFile>")
    v = bitvox.read_volume(tmp_path / "a.vti")
    assert (v.array == a).all() and v.lattice.corner == (0, 1, 2)


def test_bundled_volumes():
    folder = REPOSITORY / "fixtures"
    if not (folder / "waves.nhdr").is_file():
        pytest.skip("fixtures/waves.nhdr is not here")
    waves = bitvox.read_volume(folder / "waves.nhdr")
    assert waves.shape == (48, 40, 32) and waves.spacing == (1, 1, 1.25)
    assert waves.surface(120).check().closed
    assert [one.value for one in bitvox.read_volume(folder / "labels.npy").labels()] == [1, 2, 7]


def test_ct_head(tmp_path):
    tarfile = pytest.importorskip("tarfile")
    packed = SHARED / "volumes" / "vtk_headsq_quarter.tar.gz"
    if not packed.is_file():
        pytest.skip("the CT head is not here")
    with tarfile.open(packed) as archive:
        archive.extractall(tmp_path, filter="data") if hasattr(tarfile, "data_filter") else archive.extractall(tmp_path)
    head = next(tmp_path.rglob("quarter.nhdr"))
    v = bitvox.read_volume(head)
    assert v.shape == (64, 64, 93) and v.spacing == (3.2, 3.2, 1.5)
    slices = np.stack([np.fromfile(head.parent / f"quarter.{i}", "<i2").reshape(64, 64).T for i in range(1, 94)], axis=2)
    assert (v.array == slices).all()
    skull = v.surface(1150)
    c = skull.check()
    assert c.closed and c.edge_manifold and c.vertex_manifold and c.oriented and c.triangles > 50000


@pytest.mark.parametrize("how", ["raw", "base64", "binary"])
@pytest.mark.parametrize("head", ["<I", "<Q", ">I"])
def test_vti_with_blocks_of_zlib(tmp_path, how, head):
    import base64
    import struct
    import zlib

    a = np.arange(6 * 5 * 7, dtype=head[0] + "u2").reshape(7, 5, 6)
    tags, tail = "", b""
    for name in ("other", "wanted"):
        plain = (a if name == "wanted" else a * 0).tobytes()
        parts = [plain[i : i + 100] for i in range(0, len(plain), 100)]
        packed = [zlib.compress(p) for p in parts]
        front = struct.pack(f"{head[0]}{3 + len(parts)}{head[1]}", len(parts), 100, len(plain) % 100, *map(len, packed))
        body = front + b"".join(packed) if how == "raw" else base64.b64encode(front) + base64.b64encode(b"".join(packed))
        if how == "binary":
            tags += f'<DataArray type="UInt16" Name="{name}" format="binary">\n{body.decode()}\n</DataArray>'
        else:
            tags += f'<DataArray type="UInt16" Name="{name}" format="appended" offset="{len(tail)}"/>'
            tail += body
    order = "BigEndian" if head[0] == ">" else "LittleEndian"
    text = (f'<VTKFile type="ImageData" version="1.0" byte_order="{order}" header_type="UInt{32 if head[1] == "I" else 64}" '
            f'compressor="vtkZLibDataCompressor"><ImageData WholeExtent="0 6 0 5 0 7" Origin="0 0 0" Spacing="1 1 1">'
            f'<Piece Extent="0 6 0 5 0 7"><CellData Scalars="wanted">{tags}</CellData></Piece></ImageData>').encode()
    if how != "binary":
        text += f'<AppendedData encoding="{how}">_'.encode() + tail + b"</AppendedData>"
    (tmp_path / "x.vti").write_bytes(text + b"</VTKFile>")
    v = bitvox.read_volume(tmp_path / "x.vti")
    assert np.array_equal(np.asarray(v.array), a.transpose(2, 1, 0))
    assert bitvox.read(tmp_path / "x.vti").count == a.size - 1
    if how == "raw":
        spoilt = bytearray(text)
        spoilt[-60:-40] = bytes(20)
        (tmp_path / "bad.vti").write_bytes(spoilt)
        with pytest.raises(bitvox.FormatError, match="damaged"):
            bitvox.read_volume(tmp_path / "bad.vti")
        with pytest.raises(bitvox.MemoryLimitError):
            bitvox.read_volume(tmp_path / "x.vti", memory_limit=100)


def test_grid_of_gzip_samples(tmp_path):
    import gzip

    a = (np.arange(6 * 5 * 7) % 3).astype(np.uint8)
    head = b"NRRD0004\ntype: uint8\ndimension: 3\nsizes: 6 5 7\nspacings: 1 1 2\nencoding: %s\n\n"
    (tmp_path / "plain.nrrd").write_bytes(head % b"raw" + a.tobytes())
    (tmp_path / "packed.nrrd").write_bytes(head % b"gzip" + gzip.compress(a.tobytes()))
    plain = bitvox.read(tmp_path / "plain.nrrd")
    assert plain.count == 140
    assert bitvox.read(tmp_path / "packed.nrrd") == plain
    assert bitvox.read(tmp_path / "packed.nrrd", window=((1, 1, 1), (3, 2, 4))) == bitvox.read(tmp_path / "plain.nrrd", window=((1, 1, 1), (3, 2, 4)))
    packed = (tmp_path / "packed.nrrd").read_bytes()
    for bad in (packed[:-20], packed[: len(head) + 12] + b"XXXX" + packed[len(head) + 16 :]):
        with pytest.raises(bitvox.FormatError, match="packed samples"):
            bitvox.loads(bad, "nrrd")
    with pytest.raises(bitvox.FormatError, match="cut short, or more"):
        bitvox.loads(head % b"gzip" + gzip.compress(a.tobytes() * 100), "nrrd")
    with pytest.raises(bitvox.MemoryLimitError):
        bitvox.loads(packed, "nrrd", memory_limit=100)


def thirds():
    """Three labels that meet in a line, askew, and a fourth in a corner that touches itself along an edge."""
    x, y, z = np.mgrid[:24, :22, :20]
    a = np.where(3 * x + y < 40, 5, np.where(y + z < 24, 7, 9)).astype(np.int16)
    a[:4, :4, :4] = -3 * ((x + y + z)[:4, :4, :4] % 2) + 5 * ((x + y + z)[:4, :4, :4] % 2 == 0)
    return a


@pytest.mark.parametrize("smooth", [True, False])
def test_surfaces_of_labels_share_faces(smooth):
    v = bitvox.Volume(thirds(), spacing=(1, 2, 0.5), corner=(10, 20, -30))
    bodies = v.surfaces(smooth=smooth)
    assert list(bodies) == [-3, 5, 7, 9] == [one.value for one in v.labels()] and len(bodies) == 4
    faces = {}
    for one in bodies.labels:
        mesh = bodies[one.value]
        found = mesh.check(weld=False)
        assert found.closed and found.edge_manifold and found.vertex_manifold and found.oriented
        if one.value > 0:
            assert found.volume == pytest.approx(one.voxels, rel=5e-3 if smooth else 1e-9)  # one has a corner of noise
        for corners in np.asarray(mesh.vertices)[mesh.faces].reshape(-1, 9):
            key = tuple(sorted(map(tuple, corners.reshape(3, 3))))
            faces[key] = faces.get(key, 0) + 1
    whole = bodies.complex
    inner = (whole.sides != 0).all(axis=1)
    assert len(faces) == len(whole.faces) and sum(faces.values()) == len(whole.faces) + inner.sum()
    assert len(bitvox.Mesh(whole.vertices, whole.faces).crossings()) == 0
    assert set(np.unique(whole.sides)) == {-3, 0, 5, 7, 9}
    with pytest.raises(KeyError):
        bodies[4]


def test_surfaces_with_fewer_triangles_share_faces():
    v = bitvox.Volume(thirds())
    all_of_it = v.surfaces().complex
    for few in (v.surfaces(triangles=len(all_of_it.faces) // 4), v.surfaces(error=0.1)):
        whole = few.complex
        assert len(whole.sides) == len(whole.faces) <= len(all_of_it.faces) // 3
        for value, mesh in few.items():
            certificate = mesh.check()
            assert certificate.closed and certificate.edge_manifold and certificate.vertex_manifold
            assert mesh.n_faces == (whole.sides == value).sum()
        assert len(bitvox.Mesh(whole.vertices, whole.faces).crossings()) == 0
    with pytest.raises(bitvox.ArgumentError, match="contradict"):
        v.surfaces(triangles=9, error=0.1)
    with pytest.raises(bitvox.ArgumentError, match="exclude"):
        v.surfaces(triangles=9, smooth=False)


@pytest.mark.parametrize("options", [{}, {"smooth": False}, {"triangles": 900}])
def test_open_windows_of_labels_join(options):
    v, ends = bitvox.Volume(thirds(), spacing=(1, 2, 0.5), corner=(10, 20, -30)), (0, 9, 24)
    whole, joined, found = v.surfaces(**options), {}, 0
    for low, high in zip(ends, ends[1:]):
        wide = max(low - 1, 0), min(high + 1, 24)  # a voxel more where there are others
        part = v.window(((wide[0], 0, 0), (wide[1] - wide[0], 22, 20))).surfaces(open=True, **options)
        found += len(part.complex.faces)
        for value, mesh in part.items():
            assert (np.asarray(mesh.vertices)[:, 0] >= 10 + low - (low == 0)).all() and (np.asarray(mesh.vertices)[:, 0] <= 10 + high + (high == 24)).all()
            joined.setdefault(value, []).append(mesh)
    assert "triangles" in options or found == len(whole.complex.faces)
    for value, parts in joined.items():
        before = np.cumsum([0, *(mesh.n_vertices for mesh in parts)])
        mesh = bitvox.Mesh(np.concatenate([mesh.vertices for mesh in parts]), np.concatenate([mesh.faces + n for mesh, n in zip(parts, before.astype("u4"))]))
        found = mesh.check(weld=True)
        assert found.closed and (found.oriented and found.vertex_manifold or value < 7), value  # two have a corner of noise, where positions are equal
        assert value < 5 or mesh.volume == pytest.approx(whole[value].volume, rel=0.01)


def test_surfaces_take_background_type_and_direction():
    v = bitvox.Volume(thirds())
    assert list(v.surfaces(background=7)) == [-3, 5, 9]
    assert v.surfaces(dtype="float64")[9].vertices.dtype == np.float64
    with pytest.raises(bitvox.ArgumentError, match="background"):
        v.surfaces(background=40000)
    with pytest.raises(bitvox.UnsupportedError):
        bitvox.Volume(np.zeros((2, 2, 2))).surfaces()
    mirrored = bitvox.Volume(thirds(), direction=((0, -1, 0), (1, 0, 0), (0, 0, -1)))
    assert mirrored.surfaces()[9].check().volume == pytest.approx(v.surfaces()[9].check().volume, rel=1e-6)
    big = bitvox.Volume(np.full((2, 1, 1), 2**64 - 1, np.uint64))
    assert list(big.surfaces()) == [2**64 - 1] and big.surfaces().complex.sides.tolist() == [[2**64 - 1, 0]] * 20
    assert len(bitvox.Volume(np.zeros((2, 2, 2), np.uint8)).surfaces()) == 0


def segmentation(path, turned=False, names=("left lung/\u03b1", "2")):
    """A file as 3D Slicer writes it; its second name is the value of no label of its own."""
    samples = np.zeros((6, 5, 4), np.uint8)
    samples[1:3, 1:4, 1:3], samples[3:5, 1:4, 1:3] = 3, 5
    head = ("NRRD0004\ntype: uint8\ndimension: 3\nspace: left-posterior-superior\nsizes: 6 5 4\n"
            f"space directions: {'(0,1,0) (1,0,0)' if turned else '(1,0,0) (0,1,0)'} (0,0,2)\nkinds: domain domain domain\nencoding: raw\nspace origin: (0,0,0)\n")
    for i, (value, name, color) in enumerate([(3, names[0], "1 0 0.5"), (5, names[1], "broken"), (9, "absent", "0 0 0")]):
        head += f"Segment{i}_LabelValue:={value}\nSegment{i}_Name:={name}\nSegment{i}_Color:={color}\n"
    path.write_bytes((head + "\n").encode() + samples.tobytes(order="F"))
    return path


@pytest.mark.parametrize("turned", [False, True])
def test_segments_have_the_names_and_colors_of_the_file(tmp_path, turned):
    if turned:
        pytest.importorskip("SimpleITK")
    volume = bitvox.read_volume(segmentation(tmp_path / "s.seg.nrrd", turned))
    assert volume.segments == {3: ("left lung/\u03b1", (255, 0, 128)), 5: ("2", None), 9: ("absent", (0, 0, 0))}
    for same in (volume.window((0, 0, 0, 5, 5, 4)), volume.turned("ras"), pickle.loads(pickle.dumps(volume))):
        assert same.segments == volume.segments
    bodies = volume.surfaces()
    assert {value: one.name for value, one in bodies.segments.items()} == {3: "left lung/\u03b1", 5: "2"}
    assert bodies.segments[3].color == (255, 0, 128) and len(bodies.segments[5].color) == 3
    bodies.save(tmp_path / "all.glb")
    head = glb_head(tmp_path / "all.glb")
    assert [node["name"] for node in head["nodes"]] == ["left lung/\u03b1", "2"] == [one["name"] for one in head["materials"]]
    assert head["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] == pytest.approx([1, 0, 0.2158, 1], abs=1e-3)
    bodies.save(tmp_path / "%s.ply")
    assert bitvox.read(tmp_path / "left lung_\u03b1.ply") == bodies[3] and bitvox.read(tmp_path / "2.ply") == bodies[5]
    with pytest.raises(bitvox.ArgumentError, match="%s"):
        bodies.save(tmp_path / "all.ply")


def glb_head(path):
    data = path.read_bytes()
    return json.loads(data[20 : 20 + int.from_bytes(data[12:16], "little")])


def test_segments_are_read_from_tables(tmp_path):
    tables = {
        "freesurfer.txt": ("# id name r g b a\n0 Unknown 0 0 0 0\n 3   Left-Thalamus  0 118 14 0\n5 Late 400 0 0 0\n3 Again 1 1 1 0\n",
                           {0: ("Unknown", (0, 0, 0)), 3: ("Left-Thalamus", (0, 118, 14)), 5: ("Late", None)}),
        "snap.label": ('####\n    0     0    0    0        0  0  0    "Clear Label"\n    3   255    0    7        1  1  1    "Label, 3"\n',
                       {0: ("Clear Label", (0, 0, 0)), 3: ("Label, 3", (255, 0, 7))}),
        "atlas.csv": ('index,name,r,g,b\r\n3,"Gray, matter",10,20,30\r\n5,b c\r\n', {3: ("Gray, matter", (10, 20, 30)), 5: ("b c", None)}),
        "atlas.tsv": ("index\tname\tabbreviation\n3\tLeft Hippocampus\tLH\n", {3: ("Left Hippocampus", None)}),
    }
    volume = bitvox.read_volume(segmentation(tmp_path / "s.nrrd"))
    for name, (text, wanted) in tables.items():
        (tmp_path / name).write_text(text, newline="")
        assert bitvox.read_segments(tmp_path / name) == wanted
        volume.segments = bitvox.read_segments(tmp_path / name)
        assert volume.surfaces().segments[3].name == wanted[3][0]
    (tmp_path / "none.csv").write_text("index,name\n")
    with pytest.raises(bitvox.FormatError, match="none.csv: no line has"):
        bitvox.read_segments(tmp_path / "none.csv")


def test_segments_of_one_name_are_saved_by_their_values(tmp_path):
    bodies = bitvox.read_volume(segmentation(tmp_path / "s.nrrd", names=("same", "Same"))).surfaces()
    bodies.save(tmp_path / "%s.stl")
    assert (tmp_path / "3.stl").is_file() and (tmp_path / "5.stl").is_file()


def test_surfaces_as_blocks_of_pyvista():
    pytest.importorskip("pyvista")
    bodies = bitvox.Volume(thirds()).surfaces()
    blocks = bodies.to_pyvista()
    assert blocks.keys() == ["-3", "5", "7", "9"] and blocks["7"].n_points == bodies[7].n_vertices
    assert blocks["9"].field_data["value"].tolist() == [9] and blocks["9"].field_data["color"].tolist() == list(bodies.segments[9].color)


def test_names_of_segments_stay(tmp_path):
    named = {3: bitvox.Segment("left  lung", (255, 0, 128)), -3: bitvox.Segment("2")}
    volume = bitvox.Volume(thirds(), direction=[[-1, 0, 0], [0, 0, 1], [0, 1, 0]], frame="lps")
    volume.segments = dict(named)
    tilted = volume.transform([[0.8, -0.6, 0], [0.6, 0.8, 0], [0, 0, 1]])
    assert volume.aligned().segments == tilted.segments == tilted.aligned(method="nearest").segments == named
    volume.save(tmp_path / "named.nrrd")
    assert bitvox.read_volume(tmp_path / "named.nrrd").segments == named | {3: bitvox.Segment("left lung", (255, 0, 128))}
    for ending in ("mha", "vti"):
        with pytest.warns(UserWarning, match="names and colors of labels; .nrrd does"):
            volume.save(tmp_path / f"unnamed.{ending}")


def test_files_of_numpy_by_slices(tmp_path):
    zyx = np.arange(24).reshape(2, 3, 4)
    np.save(tmp_path / "a.npy", zyx)
    np.savez(tmp_path / "a.npz", zyx)
    for name in ("a.npy", "a.npz"):
        assert bitvox.read_volume(tmp_path / name, order="zyx", spacing=2) == bitvox.Volume(zyx, order="zyx", spacing=2)
    bitvox.Volume(zyx).save(tmp_path / "a.nrrd")
    with pytest.raises(bitvox.ArgumentError, match="order is for .npy and .npz"):
        bitvox.read_volume(tmp_path / "a.nrrd", order="zyx")


def test_a_label_cropped_to_its_box():
    volume = bitvox.Volume(thirds(), spacing=(1, 2, 0.5), corner=(10, 20, -30)).window((2, 1, 0, 22, 20, 18))
    for value in (5, 7, 9):
        whole, part = volume.label(value), volume.label(value, crop=True)
        box = next(one for one in volume.labels() if one.value == value)
        assert part.shape == box.size and part.low == tuple(a + b for a, b in zip(box.low, volume.low)) and part.count == whole.count == box.voxels
        assert part.surface() == whole.surface()
    assert volume.label(77, crop=True).count == 0
    flipped = bitvox.Volume(thirds(), direction=[[-1, 0, 0], [0, 0, 1], [0, 1, 0]])
    part = flipped.label(7, crop=True)
    assert part == flipped.label(7).crop() and part.report.inside == part.count
    assert bitvox.Volume(np.array([[[2**64 - 1, 2**53, 2**53 + 1]]], np.uint64)).label(2**53 + 1, crop=True).low == (0, 0, 2)


@pytest.mark.parametrize("dtype", ["i8", "u8"])
def test_64_bit_integers_are_told_apart(dtype):
    near = [2**53 + 1, 2**53 + 2, 2**53 + 3, *([2**64 - 1, 2**64 - 2, 2**63] if dtype == "u8" else [-(2**63), 1 - 2**63, 2**63 - 1])]
    v = bitvox.Volume(np.array(near, dtype).reshape(1, 1, 6))
    assert [v.threshold(a, a).count for a in near] == [v.label(a).count for a in near] == [1] * 6
    assert [v.label(one.value).count for one in v.labels()] == [1] * 6
    assert v.threshold(np.array(near[1], dtype)[()]).count == sum(a >= near[1] for a in near)
    assert v.threshold(2**53 + 4, 2**62).count == 0 and v.threshold(2**64).count == 0 and v.threshold(0.2, 0.8).count == 0
    assert v.threshold().count == 6 and v.label(-7).count == 0
    floats = bitvox.Volume(np.full((1, 1, 1), 2.0**53))
    assert (floats.threshold(2**53).count, floats.threshold(2**53 + 1).count, floats.threshold(0, 2**53 - 1).count) == (1, 0, 0)
    with pytest.raises(bitvox.ArgumentError, match="9007199254740993"):
        v.threshold(2**53 + 1, 2**53)
    with pytest.raises(bitvox.ArgumentError, match="NaN"):
        v.threshold(float("nan"))
