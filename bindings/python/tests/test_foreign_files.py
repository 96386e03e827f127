"""Files that others write, in encodings and byte orders that ours do not have: values, spacing, origin and directions beside SimpleITK's, pynrrd's
and VTK's."""

import io
import itertools

import numpy as np
import pytest
from conftest import TETRAHEDRON
from test_places import AXES, ORIGIN, SPACING, TURNS, VALUES, same_place, simpleitk

import bitvox

NRRD_TYPES = ("|u1", "<i2", ">i2", "<u4", ">i8", "<f4", ">f8")


def nrrd_head(turn, dtype="<i2", encoding="gzip"):
    return {"space": "left-posterior-superior", "space directions": (np.asarray(turn) * SPACING).T, "space origin": np.array(ORIGIN), "encoding": encoding,
            "kinds": ["domain"] * 3, "endian": "big" if dtype[0] == ">" else "little"}


@pytest.mark.parametrize("encoding", ["raw", "gzip", "bzip2", "ascii"])
@pytest.mark.parametrize("dtype", NRRD_TYPES)
def test_nrrd_of_every_encoding_and_byte_order(encoding, dtype, tmp_path):
    nrrd = pytest.importorskip("nrrd")
    path = str(tmp_path / "a.nrrd")
    nrrd.write(path, VALUES.T.astype(dtype), nrrd_head(np.eye(3), dtype, encoding))
    theirs, head = nrrd.read(path)
    volume = bitvox.read_volume(path)
    assert np.array_equal(volume.array, theirs) and np.array_equal(volume.to_numpy("zyx"), VALUES.astype(dtype)) and volume.frame == "lps"
    assert volume.spacing == SPACING and volume.origin == tuple(head["space origin"]) == ORIGIN and (volume.direction == np.eye(3)).all()
    if encoding != "bzip2":  # SimpleITK is built without
        same_place(volume, pytest.importorskip("SimpleITK").ReadImage(path))


@pytest.mark.parametrize("encoding", ["raw", "gzip", "bzip2"])
@pytest.mark.parametrize("turn", TURNS)
def test_nrrd_of_every_orientation(encoding, turn, tmp_path):
    nrrd = pytest.importorskip("nrrd")
    pytest.importorskip("SimpleITK")
    path = str(tmp_path / "a.nrrd")
    nrrd.write(path, VALUES.T, nrrd_head(turn, "<i2", encoding))
    volume = bitvox.read_volume(path)
    assert np.array_equal(volume.to_numpy("zyx"), VALUES) and volume.frame == "lps"
    same_place(volume, simpleitk(turn), 1e-9)


def test_grids_packed_by_bzip2(tmp_path):
    nrrd = pytest.importorskip("nrrd")
    bits = np.random.default_rng(2).random((4, 5, 6)) < 0.5
    nrrd.write(str(tmp_path / "a.nrrd"), bits.astype("u1"), nrrd_head(np.eye(3), "|u1", "bzip2"))
    grid = bitvox.read(tmp_path / "a.nrrd")
    assert np.array_equal(grid.to_numpy(), bits) and grid.spacing == SPACING
    data = (tmp_path / "a.nrrd").read_bytes()
    for wrong in (data[:-20], data[:-20] + bytes(20)):
        with pytest.raises(bitvox.FormatError, match="packed samples"):
            bitvox.loads(wrong, "nrrd")
    with pytest.raises(bitvox.MemoryLimitError):
        bitvox.loads(data, "nrrd", memory_limit=50)


@pytest.mark.parametrize("turn", TURNS)
def test_masks_of_metaimage(turn, tmp_path):
    sitk = pytest.importorskip("SimpleITK")
    mask = (VALUES > 500).astype(np.uint8)
    image = simpleitk(turn, mask)
    sitk.WriteImage(image, str(tmp_path / "m.mha"))
    volume = bitvox.read_volume(tmp_path / "m.mha")
    same_place(volume, image, 1e-9)
    assert np.array_equal(volume.to_numpy("zyx"), mask) and volume.array.dtype == np.uint8 and volume.frame == "lps"
    if any(np.array_equal(turn, axes) for axes in AXES):
        assert volume.threshold(1).count == mask.sum()
    with pytest.raises(bitvox.UnsupportedError, match="read_volume"):  # nothing says which values are inside
        bitvox.read(tmp_path / "m.mha")


@pytest.mark.parametrize("most", [True, False])
@pytest.mark.parametrize("code, kind", [("i2", "MET_SHORT"), ("u4", "MET_UINT"), ("f4", "MET_FLOAT"), ("f8", "MET_DOUBLE")])
def test_metaimage_of_either_byte_order(most, code, kind, tmp_path):
    sitk = pytest.importorskip("SimpleITK")
    values = VALUES.astype((">" if most else "<") + code)
    head = (f"ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = {most}\nTransformMatrix = 1 0 0 0 1 0 0 0 1\n"
            f"Offset = -11.5 28.25 36\nElementSpacing = 0.5 1.25 3\nDimSize = 7 6 5\nElementType = {kind}\nElementDataFile = LOCAL\n")
    (tmp_path / "a.mha").write_bytes(head.encode() + values.tobytes())
    volume = bitvox.read_volume(tmp_path / "a.mha")
    same_place(volume, sitk.ReadImage(str(tmp_path / "a.mha")))
    assert np.array_equal(volume.to_numpy("zyx"), values.astype(code)) and volume.origin == ORIGIN


@pytest.mark.parametrize("turn", TURNS)
def test_segmentations_of_slicer_in_layers(turn, tmp_path):
    """Overlapping segments lie in layers, along a first axis that has no direction; others are labels of one."""
    nrrd = pytest.importorskip("nrrd")
    pytest.importorskip("SimpleITK")
    rng = np.random.default_rng(5)
    layers = np.stack([rng.integers(0, 3, (7, 6, 5)), rng.integers(0, 2, (7, 6, 5))]).astype("u1")
    head = nrrd_head(turn)
    segments = [("bone", 0, 1), ("fat", 0, 2), ("skin", 1, 1), ("skin", 0, 1)]
    for i, (name, layer, label) in enumerate(segments):
        head |= {f"Segment{i}_ID": f"Segment_{i}", f"Segment{i}_Name": name, f"Segment{i}_Layer": str(layer), f"Segment{i}_LabelValue": str(label)}
    head |= {"kinds": ["list", "domain", "domain", "domain"], "space directions": np.vstack([np.full(3, np.nan), head["space directions"]])}
    nrrd.write(str(tmp_path / "a.seg.nrrd"), layers, head)
    found = bitvox.formats.read_segmentation(tmp_path / "a.seg.nrrd")
    assert list(found) == ["bone", "fat", "skin", "skin 3"]
    for volume, (_, layer, label) in zip(found.values(), segments):
        assert np.array_equal(volume.array, layers[layer] == label) and volume.frame == "lps"
        same_place(volume, simpleitk(turn), 1e-9)
    with pytest.raises(bitvox.UnsupportedError, match="read_segmentation"):
        bitvox.read_volume(tmp_path / "a.seg.nrrd")


def test_segmentations_of_slicer_in_one_layer(tmp_path):
    nrrd = pytest.importorskip("nrrd")
    pytest.importorskip("SimpleITK")
    labels = np.random.default_rng(5).integers(0, 3, (7, 6, 5)).astype("u1")
    head = nrrd_head(np.eye(3)) | {"Segment0_ID": "a", "Segment0_Name": "bone", "Segment0_LabelValue": "2", "Segment1_ID": "b", "Segment1_LabelValue": "1"}
    nrrd.write(str(tmp_path / "a.seg.nrrd"), labels, head)
    found = bitvox.formats.read_segmentation(tmp_path / "a.seg.nrrd")
    assert list(found) == ["bone", "Segment_1"] and np.array_equal(found["bone"].array, labels == 2) and np.array_equal(found["Segment_1"].array, labels == 1)
    assert np.array_equal(bitvox.read_volume(tmp_path / "a.seg.nrrd").array, labels)
    nrrd.write(str(tmp_path / "plain.nrrd"), labels, nrrd_head(np.eye(3)))
    nrrd.write(str(tmp_path / "layer.nrrd"), labels, head | {"Segment1_Layer": "3"})
    for name, word in (("plain", "names no segments"), ("layer", "layer 3 of 1")):
        with pytest.raises(bitvox.FormatError, match=word):
            bitvox.formats.read_segmentation(tmp_path / f"{name}.nrrd")
    with pytest.raises(FileNotFoundError):
        bitvox.formats.read_segmentation(tmp_path / "nothing.nrrd")


def slc(values, spacing, packed):
    """A file of the SLC format as VTK's reader takes it: a head of words, an icon, and slices of bytes, plain or in runs."""
    nz, ny, nx = values.shape
    head = f"11111\n{nx} {ny} {nz} 8\n{' '.join(map(str, spacing))}\n1 0 0 {int(packed)}\n2 2 X".encode() + bytes(12)
    parts = [head]
    for one in values:
        rows = one.tobytes()
        if packed:  # runs of up to 127 bytes as they are
            runs = b"".join(bytes([128 + len(rows[i : i + 127])]) + rows[i : i + 127] for i in range(0, len(rows), 127)) + b"\0"
            rows = f"{len(runs)} X".encode() + runs
        parts.append(rows)
    return b"".join(parts)


@pytest.mark.parametrize("packed", [False, True])
def test_slc(packed, tmp_path):
    pyvista = pytest.importorskip("pyvista")
    values = np.random.default_rng(3).integers(0, 256, (5, 6, 7)).astype(np.uint8)
    (tmp_path / "a.slc").write_bytes(slc(values, SPACING, packed))
    theirs = pyvista.read(tmp_path / "a.slc")
    volume = bitvox.read_volume(tmp_path / "a.slc")
    assert np.array_equal(volume.to_numpy("zyx"), values) and np.array_equal(volume.to_numpy("zyx").ravel(), theirs.active_scalars)
    assert volume.spacing == SPACING == tuple(theirs.spacing) and volume.origin == tuple(theirs.origin) == tuple(theirs.points[0])


@pytest.mark.parametrize("kind, module", [("nii", "nibabel"), ("mha", "SimpleITK")])
def test_grids_come_back_of_the_bytes_of_others_formats(kind, module, tmp_path):
    pytest.importorskip(module)
    grid = bitvox.Grid.from_numpy(VALUES > 300, order="zyx", spacing=SPACING, center0=ORIGIN)
    data = bitvox.dumps(grid, kind)
    assert bitvox.loads(data, kind) == grid and bitvox.read(io.BytesIO(data), format=kind) == grid
    for name in (f"a.{kind}", f"a.{kind}.gz"):
        grid.save(tmp_path / name)
        assert bitvox.read(tmp_path / name) == grid and bitvox.loads((tmp_path / name).read_bytes(), kind) == grid
    with pytest.raises(bitvox.FormatError, match=f"the bytes of a .{kind}"):
        bitvox.loads(data[:100], kind)
    with pytest.raises(bitvox.ArgumentError, match="window"):
        bitvox.loads(data, kind, window=((0, 0, 0), (1, 1, 1)))
    with pytest.raises(bitvox.UnsupportedError, match="threshold"):
        bitvox.loads(bitvox.dumps(bitvox.Volume(VALUES), kind), kind)


@pytest.mark.parametrize("kind, module", [("glb", "numpy"), ("3mf", "numpy"), ("vtp", "pyvista")])
def test_meshes_of_the_bytes_of_others_formats(kind, module):
    pytest.importorskip("trimesh")
    pytest.importorskip(module)
    mesh = bitvox.Mesh(*TETRAHEDRON)
    again = bitvox.loads(bitvox.dumps(mesh, kind), kind)
    assert again.volume == pytest.approx(mesh.volume) and again.bounds == mesh.bounds
    with pytest.raises(bitvox.Error):
        bitvox.loads(b"no", kind)


def test_what_loads_does_not_know():
    for kind, word in itertools.product(("doc", "mhd"), ("nii", "glb", "stl")):
        with pytest.raises(bitvox.UnsupportedError, match=word):
            bitvox.loads(b"", kind)


@pytest.mark.parametrize("ending, module", [("nrrd", "numpy"), ("nii", "nibabel"), ("nii.gz", "nibabel"), ("mha", "SimpleITK"), ("mha.gz", "SimpleITK"), ("vti", "numpy"),
                                            ("nrrd.gz", "numpy"), ("npy", "numpy")])
def test_volumes_of_open_files(ending, module, tmp_path):
    pytest.importorskip(module)
    path, kind = tmp_path / f"a.{ending}", ending.partition(".")[0]
    volume = bitvox.Volume(VALUES, order="zyx", spacing=SPACING, center0=ORIGIN)
    if kind == "npy":
        np.save(path, VALUES)
    else:
        volume.save(path)
    wanted = bitvox.read_volume(path)
    with open(path, "rb") as file:
        assert bitvox.read_volume(file) == wanted
    assert bitvox.read_volume(io.BytesIO(path.read_bytes()), format=kind) == wanted
    with pytest.raises(bitvox.Error, match=f"the bytes of a .{kind}|NRRD|VTI|NPY|npy"):
        bitvox.read_volume(io.BytesIO(path.read_bytes()[:40]), format=kind)


def test_volumes_that_an_open_file_does_not_hold(tmp_path):
    for kind in ("nhdr", "mhd", "hdr", "img"):
        with pytest.raises(bitvox.UnsupportedError, match="another file"):
            bitvox.read_volume(io.BytesIO(b"NRRD0004"), format=kind)
    with pytest.raises(bitvox.ArgumentError, match="format="):
        bitvox.read_volume(io.BytesIO(b""))
    with pytest.raises(TypeError, match="'rb'"):
        bitvox.read_volume(io.StringIO(""), format="nrrd")
