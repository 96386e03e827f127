"""Volumes of other libraries: values, places and directions beside SimpleITK's, in 27 orientations along axes and 20 oblique ones, and files written back."""

import itertools

import numpy as np
import pytest

import bitvox

AXES = [np.eye(3)[:, list(p)] * s for p in itertools.permutations(range(3)) for s in itertools.product((1, -1), repeat=3)]


def rotated(seed):
    q, r = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    return q * np.sign(np.diag(r))


TURNS = [AXES[i] for i in sorted({*range(0, 48, 2), 7, 25, 47})] + [rotated(i) for i in range(20)]  # 27 along axes and 20 oblique
VALUES = np.random.default_rng(1).integers(-500, 1500, (5, 6, 7)).astype(np.int16)  # [z, y, x]
SPACING, ORIGIN = (0.5, 1.25, 3.0), (-11.5, 28.25, 36.0)
PLACES = np.array([[0, 0, 0], [6, 0, 0], [0, 5, 0], [0, 0, 4], [3, 2, 1], [6, 5, 4]])


@pytest.fixture(params=range(len(TURNS)), ids=lambda i: f"turn{i}")
def turn(request):
    return TURNS[request.param]


def simpleitk(turn, values=VALUES):
    sitk = pytest.importorskip("SimpleITK")
    image = sitk.GetImageFromArray(values)
    image.SetSpacing(SPACING)
    image.SetOrigin(ORIGIN)
    image.SetDirection(np.asarray(turn).ravel().tolist())
    return image


def same_place(volume, image, tolerance=1e-12):
    """Voxel by voxel where SimpleITK says that it is."""
    wanted = np.array([image.TransformIndexToPhysicalPoint([int(i) for i in ijk]) for ijk in PLACES])
    assert np.abs(volume.to_world(PLACES) - wanted).max() <= tolerance * 100
    assert np.allclose(volume.spacing, image.GetSpacing(), rtol=1e-7) and np.allclose(volume.center0, image.GetOrigin(), rtol=1e-6, atol=tolerance)
    assert np.allclose(volume.direction.ravel(), image.GetDirection(), atol=max(1e-12, tolerance))


def test_simpleitk(turn):
    image = simpleitk(turn)
    volume = bitvox.Volume.of(image)
    same_place(volume, image)
    assert np.array_equal(volume.to_numpy("zyx"), VALUES) and volume.frame == "lps" and volume.array.dtype == np.int16
    assert volume[6, 5, 4] == image[6, 5, 4]
    corners = np.array([image.TransformContinuousIndexToPhysicalPoint([a, b, c]) for a in (-0.5, 6.5) for b in (-0.5, 5.5) for c in (-0.5, 4.5)])
    assert np.allclose(volume.bounds, (corners.min(0), corners.max(0)))


@pytest.mark.parametrize("ending", ["nrrd", "mha", "nii", "nii.gz", "mha.gz"])
def test_files_written_are_read_by_simpleitk(turn, ending, tmp_path):
    sitk = pytest.importorskip("SimpleITK")
    if ending.startswith("nii"):
        pytest.importorskip("nibabel")
    image = simpleitk(turn)
    volume = bitvox.Volume.of(image)
    volume.save(tmp_path / f"a.{ending}")
    if ending == "mha.gz":
        return  # SimpleITK does not unpack it
    if ending.startswith("nii") and np.linalg.det(turn) < 0:
        pass  # SimpleITK reads the matrix of the sform, mirrored ones too
    back = sitk.ReadImage(str(tmp_path / f"a.{ending}"))
    rounding = 1e-12 if ending in ("nrrd", "mha") else 2e-6  # NIfTI holds float32
    same_place(volume, back, rounding * 50 if ending.startswith("nii") else rounding)
    assert np.array_equal(sitk.GetArrayFromImage(back), VALUES)


@pytest.mark.parametrize("ending", ["nrrd", "mha", "nii.gz", "mhd"])
def test_files_of_simpleitk_are_read(turn, ending, tmp_path):
    sitk = pytest.importorskip("SimpleITK")
    image = simpleitk(turn)
    sitk.WriteImage(image, str(tmp_path / f"a.{ending}"))
    volume = bitvox.read_volume(tmp_path / f"a.{ending}", frame="lps")
    if ending != "nii.gz":
        same_place(volume, image)
        assert np.array_equal(volume.to_numpy("zyx"), VALUES)
    for ijk in PLACES:  # NIfTI's axes are turned to those nearest the world's; each sample lies where SimpleITK has it
        at = volume.to_world(np.stack(np.meshgrid(*map(np.arange, volume.shape), indexing="ij"), -1).reshape(-1, 3))
        nearest = np.abs(at - image.TransformIndexToPhysicalPoint([int(i) for i in ijk])).max(axis=1)
        assert nearest.min() < 1e-3 and np.asarray(volume).reshape(-1)[nearest.argmin()] == image[[int(i) for i in ijk]]


def test_one_image_lies_at_one_place_in_every_format(tmp_path):
    sitk = pytest.importorskip("SimpleITK")
    pytest.importorskip("nibabel")
    image = simpleitk(np.eye(3))
    found = {}
    for ending in ("nrrd", "nii.gz", "mha"):
        sitk.WriteImage(image, str(tmp_path / f"a.{ending}"))
        found[ending] = [np.round(bitvox.read_volume(tmp_path / f"a.{ending}", frame=frame).bounds, 4).tolist() for frame in ("lps", "ras")]
    assert found["nrrd"] == found["nii.gz"] == found["mha"] and found["mha"][0] != found["mha"][1]
    assert [bitvox.read_volume(tmp_path / f"a.{e}").frame for e in found] == ["lps", "ras", "lps"]


def test_surfaces_come_out_in_the_world(turn):
    x, y, z = np.meshgrid(*(np.arange(n) for n in (16, 14, 12)), indexing="ij")
    ball = 5.0 - np.sqrt((x - 7.5) ** 2 + (y - 6.5) ** 2 + (z - 5.5) ** 2)
    volume = bitvox.Volume(ball, spacing=(0.5, 0.5, 0.5), center0=ORIGIN, direction=turn)
    mesh = volume.surface(0.0)
    found = mesh.check()
    middle = volume.to_world([[7.5, 6.5, 5.5]])[0]
    assert found.closed and found.oriented and found.volume == pytest.approx(4 / 3 * np.pi * 2.5**3, rel=0.03)  # outwards, mirrored or not
    distance = np.linalg.norm(mesh.in_world() - middle, axis=1)
    assert 2.4 < distance.min() and distance.max() < 2.51
    local = volume.surface(0.0, local_frame=True)
    assert np.allclose(local.in_world(), mesh.in_world(), atol=1e-6) and volume.surface(0.0, triangles=300).check().volume > 0


def test_aligned(turn):
    volume = bitvox.Volume(VALUES, order="zyx", spacing=SPACING, center0=ORIGIN, direction=turn, frame="lps")
    made = volume.aligned(method="nearest")
    assert (made.direction == np.eye(3)).all() and made.frame == "lps"
    if (np.abs(turn).max(axis=0) == 1).all():
        assert np.shares_memory(made.array, volume.array) and sorted(made.shape) == sorted(volume.shape)
        at = made.to_world(np.stack(np.meshgrid(*map(np.arange, made.shape), indexing="ij"), -1).reshape(-1, 3))
        own = volume.to_world(np.stack(np.meshgrid(*map(np.arange, volume.shape), indexing="ij"), -1).reshape(-1, 3))
        both = [points[np.lexsort(points.round(6).T)] for points in (at, own)]
        assert np.allclose(*both) and np.array_equal(made.array.reshape(-1)[np.lexsort(at.round(6).T)], volume.array.reshape(-1)[np.lexsort(own.round(6).T)])
        grid = volume.threshold(500)
        assert grid.count == (VALUES >= 500).sum() and np.allclose(grid.center0, made.center0)
    else:
        with pytest.raises(bitvox.ArgumentError, match="aligned"):
            volume.threshold(500)
        assert set(np.unique(made.array)) <= set(np.unique(VALUES))
        assert np.all(np.array(made.bounds[0]) <= np.array(volume.bounds[0]) + 1e-9) and np.all(np.array(made.bounds[1]) >= np.array(volume.bounds[1]) - 1e-9)


def test_resampling_is_simpleitks():
    sitk = pytest.importorskip("SimpleITK")
    for turn in TURNS[-3:]:
        image = simpleitk(turn, VALUES.astype(np.float64))
        made = bitvox.Volume.of(image).aligned(spacing=0.75, outside=-999)
        grid = sitk.Image(*made.shape, sitk.sitkFloat64)
        grid.SetSpacing(made.spacing)
        grid.SetOrigin(made.center0)
        theirs = sitk.GetArrayFromImage(sitk.Resample(image, grid, sitk.Transform(), sitk.sitkLinear, -999.0))
        mine = made.to_numpy("zyx")
        both = (theirs != -999) & (mine != -999)
        assert both.sum() > 0.97 * max((theirs != -999).sum(), (mine != -999).sum()) and np.abs(mine - theirs)[both].max() < 1e-6 * 1500


def test_nibabel(turn):
    nibabel = pytest.importorskip("nibabel")
    affine = np.eye(4)
    affine[:3, :3], affine[:3, 3] = turn * np.array(SPACING), ORIGIN
    image = nibabel.Nifti1Image(VALUES.transpose(2, 1, 0), affine)
    volume = bitvox.Volume.of(image)
    assert np.allclose(volume.to_world(PLACES), nibabel.affines.apply_affine(affine, PLACES), atol=1e-9) and volume.frame == "ras"
    turned = bitvox.Volume.of(image, frame="lps")
    assert np.allclose(turned.to_world(PLACES), nibabel.affines.apply_affine(affine, PLACES) * [-1, -1, 1], atol=1e-9)
    assert turned.turned("ras") == volume and np.array_equal(volume.array, VALUES.transpose(2, 1, 0))


def test_pyvista(turn):
    pyvista = pytest.importorskip("pyvista")
    image = pyvista.ImageData(dimensions=VALUES.shape[::-1], spacing=SPACING, origin=ORIGIN)
    if not hasattr(image, "direction_matrix"):
        pytest.skip("this PyVista has no direction_matrix")
    image.direction_matrix = turn
    image.point_data["values"] = VALUES.ravel()
    volume = bitvox.Volume.of(image)
    points = np.asarray(image.points).reshape(*VALUES.shape, 3)
    assert np.allclose(volume.to_world(PLACES), [points[k, j, i] for i, j, k in PLACES], atol=1e-5) and np.array_equal(volume.to_numpy("zyx"), VALUES)
    image.cell_data["cells"] = np.arange(image.n_cells)
    cells = bitvox.Volume.of(image, scalars="cells")
    assert np.allclose(cells.to_world([[0, 0, 0]])[0], np.asarray(image.cell_centers().points)[0], atol=1e-5)
    set_one = np.zeros(image.n_points, np.uint8)
    set_one[100] = 1
    image.point_data["s"] = set_one
    if not (np.isclose(np.abs(turn).max(axis=0), 1)).all():
        with pytest.raises(bitvox.ArgumentError, match="oblique"):
            image.bitvox.grid("s")
        return
    grid = image.bitvox.grid("s")
    assert bitvox.Grid.of(image, scalars="s") == grid
    where = np.array(grid.center0) + grid.voxels() * np.array(grid.spacing)
    reach = 1e-4 if (np.abs(turn).max(axis=0) == 1).all() else max(SPACING)
    assert len(where) >= 1 and np.abs(where - image.points[100]).max() < reach


def test_pyvista_reads_what_is_written_by_default(tmp_path):
    pyvista = pytest.importorskip("pyvista")
    image = pyvista.ImageData(dimensions=(4, 5, 6), spacing=SPACING, origin=ORIGIN)
    image.point_data["v"] = np.arange(120.0)
    for ending in ("vti", "vtk"):
        image.save(tmp_path / f"p.{ending}")
        volume = bitvox.read_volume(tmp_path / f"p.{ending}")
        assert np.allclose(volume.center0, ORIGIN) and np.array_equal(volume.to_numpy("zyx").ravel(), np.arange(120.0)), ending


def test_xarray_and_zarr(tmp_path):
    xarray = pytest.importorskip("xarray")
    at = {"z": 36 + 3.0 * np.arange(5), "y": 28.25 - 1.25 * np.arange(6), "x": -11.5 + 0.5 * np.arange(7)}
    volume = bitvox.Volume.of(xarray.DataArray(VALUES, coords=at, dims=("z", "y", "x")))
    assert volume.spacing == SPACING and volume.center0 == ORIGIN and np.allclose(volume.to_world([[6, 5, 4]])[0], (-8.5, 22.0, 48.0))
    assert np.array_equal(volume.to_numpy("zyx"), VALUES) and (volume.direction == np.diag([1, -1, 1])).all()
    assert bitvox.Volume.of(xarray.DataArray(VALUES.T, coords=at, dims=("x", "y", "z"))) == volume
    uneven = xarray.DataArray(VALUES, coords={"z": [0, 1, 2, 3, 5]}, dims=("z", "y", "x"))
    with pytest.raises(bitvox.UnsupportedError, match="evenly"):
        bitvox.Volume.of(uneven)
    zarr = pytest.importorskip("zarr")
    stored = zarr.open_array(str(tmp_path / "a.zarr"), mode="w", shape=VALUES.shape, dtype=VALUES.dtype, chunks=(2, 3, 4))
    stored[...] = VALUES
    found = bitvox.Volume.of(stored, spacing=SPACING, center0=ORIGIN)
    assert np.array_equal(found.to_numpy("zyx"), VALUES) and np.allclose(found.center0, ORIGIN)


def test_center_in_place_of_the_corner():
    by_center = bitvox.Volume(VALUES, order="zyx", spacing=SPACING, center0=ORIGIN)
    by_corner = bitvox.Volume(VALUES, order="zyx", spacing=SPACING, corner=[o - 0.5 * s for o, s in zip(ORIGIN, SPACING)])
    assert by_center == by_corner and by_center.center0 == ORIGIN and by_center.corner == by_corner.corner
    assert by_center.window(((1, 2, 1), (2, 2, 2))).center0 == tuple(by_center.to_world([[1, 2, 1]])[0])
    for wrong, words in (({"corner": (0, 0, 0), "center0": (0, 0, 0)}, "contradict"), ({"direction": np.ones((3, 3))}, "direction"),
                         ({"direction": [1, 2]}, "direction"), ({"frame": "las"}, "frame"), ({"lattice": by_center.lattice, "center0": (0, 0, 0)}, "contradicts"),
                         ({"direction": np.eye(3) * np.nan}, "direction")):
        with pytest.raises(bitvox.ArgumentError, match=words):
            bitvox.Volume(VALUES, order="zyx", **wrong)
    with pytest.raises(bitvox.ArgumentError, match="frame"):
        by_center.turned("ras")
    with pytest.raises(TypeError, match="is not a volume"):
        bitvox.Volume.of(object())


@pytest.mark.parametrize("dtype", ["u1", "i1", "u2", "i2", "u4", "i4", "u8", "i8", "f4", "f8", ">i2"])
@pytest.mark.parametrize("ending", ["nrrd", "mha", "nii"])
def test_every_type_is_written(dtype, ending, tmp_path):
    sitk = pytest.importorskip("SimpleITK")
    pytest.importorskip("nibabel")
    values = np.abs(VALUES % 100).astype(dtype)
    bitvox.Volume(values, order="zyx", spacing=SPACING, center0=ORIGIN).save(tmp_path / f"a.{ending}")
    back = sitk.GetArrayFromImage(sitk.ReadImage(str(tmp_path / f"a.{ending}")))
    assert np.array_equal(back, values) and back.dtype == np.dtype(dtype).newbyteorder("=")


def test_grids_are_written_as_masks(tmp_path):
    sitk = pytest.importorskip("SimpleITK")
    grid = bitvox.Grid.from_numpy(VALUES > 500, order="zyx", spacing=SPACING, corner=(1, 2, 3))
    grid.save(tmp_path / "g.mha")
    image = sitk.ReadImage(str(tmp_path / "g.mha"))
    assert np.array_equal(sitk.GetArrayFromImage(image) != 0, VALUES > 500) and np.allclose(image.GetOrigin(), grid.center0)


@pytest.mark.parametrize("name", ["../secret.raw", "/etc/passwd"])
def test_samples_of_other_folders_are_refused(name, tmp_path):
    heads = {"mhd": f"ObjectType = Image\nNDims = 3\nDimSize = 1 1 1\nElementType = MET_UCHAR\nElementDataFile = {name}\n",
             "nhdr": f"NRRD0004\ntype: uint8\ndimension: 3\nsizes: 1 1 1\nspace dimension: 3\nspace directions: (-1,0,0) (0,1,0) (0,0,1)\n"
                     f"encoding: raw\ndata file: {name}\n"}
    for ending, head in heads.items():
        (tmp_path / f"a.{ending}").write_text(head)
        with pytest.raises((bitvox.FormatError, bitvox.UnsupportedError)) as refused:
            bitvox.read_volume(tmp_path / f"a.{ending}")
        assert "only files in its own folder" in str(refused.value) or "turned or mirrored" in str(refused.value)


@pytest.mark.parametrize("turn", TURNS[:9], ids=str)
@pytest.mark.parametrize("dtype", ["u1", "i2", "u4", "f4", "f8", "i8"])
def test_vtk_images_are_written(turn, dtype, tmp_path):
    pyvista = pytest.importorskip("pyvista")
    array = (np.random.default_rng(1).random((3, 4, 5)) * 100).astype(dtype)
    volume = bitvox.Volume(array, spacing=(1, 2, 3), center0=(4, 5, 6), direction=turn)
    volume.save(tmp_path / "a.vti")
    there = pyvista.read(tmp_path / "a.vti")
    assert np.array_equal(there.point_data["samples"].reshape(5, 4, 3), array.transpose(2, 1, 0))
    assert np.allclose(there.direction_matrix, volume.direction) and there.origin == volume.center0 and there.spacing == volume.spacing
    back = bitvox.read_volume(tmp_path / "a.vti")
    assert np.array_equal(back.array, array) and back.center0 == volume.center0 and np.allclose(back.direction, volume.direction)


def test_tiff_with_its_spacing(tmp_path):
    tifffile = pytest.importorskip("tifffile")
    array = np.arange(60, dtype="u2").reshape(3, 4, 5)
    sizes = {"axes": "ZYX", "PhysicalSizeX": 0.5, "PhysicalSizeY": 0.25, "PhysicalSizeZ": 2.0}
    tifffile.imwrite(tmp_path / "a.ome.tif", array, metadata=sizes)
    tifffile.imwrite(tmp_path / "b.ome.tif", array[None, :, None], metadata={**sizes, "axes": "TZCYX"})
    tifffile.imwrite(tmp_path / "c.tif", array, imagej=True, resolution=(2, 4), metadata={"axes": "ZYX", "spacing": 2.0, "unit": "um"})
    for name in ("a.ome.tif", "b.ome.tif", "c.tif"):
        volume = bitvox.read_volume(tmp_path / name)
        assert volume.spacing == (0.5, 0.25, 2.0) and volume.center0 == (0, 0, 0) and np.array_equal(volume.to_numpy("zyx"), array), name
    tifffile.imwrite(tmp_path / "d.tif", array, photometric="minisblack", resolution=(20, 40), resolutionunit="CENTIMETER")
    assert bitvox.read_volume(tmp_path / "d.tif").spacing == (0.5, 0.25, 1.0)
    tifffile.imwrite(tmp_path / "e.ome.tif", np.zeros((2, 3, 4, 5), "u1"), metadata={"axes": "CZYX"})
    with pytest.raises(bitvox.UnsupportedError, match="axes CZYX"):
        bitvox.read_volume(tmp_path / "e.ome.tif")
    (tmp_path / "f.tif").write_bytes(b"II*")
    with pytest.raises(bitvox.FormatError, match="tifffile"):
        bitvox.read_volume(tmp_path / "f.tif")


def test_archives_of_numpy(tmp_path):
    array = np.random.default_rng(1).random((3, 4, 5))
    np.savez(tmp_path / "a.npz", scan=array, spacing=np.ones(3))
    assert np.array_equal(bitvox.read_volume(tmp_path / "a.npz", spacing=2.0, corner=(1, 1, 1)), array)
    np.savez(tmp_path / "b.npz", one=array, two=array)
    with pytest.raises(bitvox.UnsupportedError, match="one, two"):
        bitvox.read_volume(tmp_path / "b.npz")
    (tmp_path / "c.npz").write_bytes(b"PK\x03\x04 and no more")
    with pytest.raises(bitvox.FormatError, match="numpy"):
        bitvox.read_volume(tmp_path / "c.npz")


@pytest.mark.parametrize("kind,dtype,cpu", [("unsigned fixed", "<u1", "decm"), ("signed fixed", ">i2", "sun"), ("float", "<f4", "pc")])
def test_inrimage(kind, dtype, cpu, tmp_path):
    array = (np.random.default_rng(1).random((5, 4, 3)) * 100).astype(dtype)
    head = (f"#INRIMAGE-4#{{\nXDIM=3\nYDIM=4\nZDIM=5\nVDIM=1\nTYPE={kind}\nPIXSIZE={8 * array.itemsize} bits\nSCALE=2**0\nCPU={cpu}\n"
            "VX=0.5\nVY=1\nVZ=2\n").ljust(252, "\n") + "##}\n"
    (tmp_path / "a.inr").write_bytes(head.encode() + array.tobytes())
    volume = bitvox.read_volume(tmp_path / "a.inr")
    assert np.array_equal(volume.to_numpy("zyx"), array) and volume.spacing == (0.5, 1, 2) and volume.center0 == (0, 0, 0)
    (tmp_path / "a.inr").write_bytes(head.encode() + array.tobytes()[:-1])
    with pytest.raises(bitvox.FormatError, match="its head wants"):
        bitvox.read_volume(tmp_path / "a.inr")
    (tmp_path / "a.inr").write_bytes(b"something else")
    with pytest.raises(bitvox.FormatError, match="INRIMAGE"):
        bitvox.read_volume(tmp_path / "a.inr")


def test_images_of_others_are_not_stripped_of_their_places():
    sitk = pytest.importorskip("SimpleITK")
    with pytest.raises(TypeError, match="Volume.of takes images"):
        bitvox.Volume(sitk.Image(3, 3, 3, sitk.sitkUInt8))


def test_masks_are_placed_as_volumes_are():
    array = np.random.default_rng(1).random((3, 4, 5)) < 0.5
    volume = bitvox.Volume(array.astype("u1"), spacing=(1, 2, 3), center0=(4, 5, 6))
    assert bitvox.Grid.from_numpy(array, spacing=(1, 2, 3), center0=(4, 5, 6)) == volume.threshold(1)
    assert bitvox.Grid.from_numpy(array, spacing=(1, 2, 3), corner=(3.5, 4, 4.5)) == volume.threshold(1)
    for wrong in ({"corner": (0, 0, 0), "center0": (0, 0, 0)}, {"lattice": bitvox.Lattice((3, 4, 5)), "center0": (0, 0, 0)}):
        with pytest.raises(bitvox.ArgumentError, match="center0"):
            bitvox.Grid.from_numpy(array, **wrong)


def test_places_are_not_lost_by_the_way(tmp_path):
    """What has a place is not taken as a bare array; Volume.of takes it with its place."""
    grid = bitvox.Grid.from_numpy(np.random.default_rng(1).random((5, 6, 7)) < 0.5, spacing=(1, 2, 3), center0=(4, 5, 6))
    volume = bitvox.Volume(grid.to_numpy(), spacing=(1, 2, 3), center0=(4, 5, 6))
    field = bitvox.field(grid.surface(), lattice=grid.lattice)
    assert bitvox.Volume.of(grid) == volume and np.array_equal(bitvox.Volume.of(field), field.to_numpy()) and bitvox.Volume.of(field).center0 == (4, 5, 6)
    for call, words in ((lambda: bitvox.Volume(grid), "Volume.of keeps it"), (lambda: bitvox.Volume(volume), "Volume.of keeps it"), (lambda: bitvox.Volume("a.nrrd"), "read_volume"),
                        (lambda: bitvox.Grid.from_numpy(volume), "Volume.threshold"), (lambda: bitvox.Grid.from_numpy(grid), "to_numpy"),
                        (lambda: bitvox.Volume.of("a.nrrd"), "read_volume"), (lambda: bitvox.Volume.of(grid.to_numpy()), r"Volume\(array")):
        with pytest.raises(TypeError, match=words):
            call()
    with pytest.raises(bitvox.ArgumentError, match="itself"):
        bitvox.Volume.of(grid, frame="lps")
    for name in ("a.mhd", "a.npz", "a.tif", "a.vtk", "a.raw"):
        with pytest.raises(bitvox.UnsupportedError, match="bitvox.read_volume"):
            bitvox.read(tmp_path / name)


def test_volumes_are_transformed():
    volume = bitvox.Volume(np.random.default_rng(2).random((4, 5, 6)), spacing=(1, 2, 3), center0=(4, 5, 6), frame="lps")
    matrix = np.array([[0.8, -0.6, 0, 1], [0.6, 0.8, 0, 2], [0, 0, 2, 3], [0, 0, 0, 1]])
    moved = volume.transform(matrix)
    ijk = np.argwhere(volume.array > -1)
    assert np.allclose(moved.to_world(ijk), volume.to_world(ijk) @ matrix[:3, :3].T + matrix[:3, 3]) and moved.frame == "lps"
    for bad, words in ((np.zeros((3, 3)), "flattens"), (np.eye(2), "shape"), (np.ones((4, 4)), "last row")):
        with pytest.raises(bitvox.ArgumentError, match=words):
            volume.transform(bad)


@pytest.mark.parametrize("turn", AXES)
@pytest.mark.parametrize("scales, shift", [((1, 1, 1), (0, 0, 0)), ((1, 1, 1), (2.5, -3.75, 6)), ((2, 0.5, 4), (-8, 16, 0.25))])
def test_grids_are_moved_voxel_by_voxel(turn, scales, shift):
    """Permuted, flipped, scaled and shifted, of a window: each voxel's box comes to lie where the matrix brings it."""
    lattice = bitvox.Lattice((9, 70, 6), (0.5, 1.25, 3.0), (-11.5, 28.25, 36.0))
    bits = np.random.default_rng(3).random((5, 66, 4)) < 0.3
    grid = bitvox.Grid.from_numpy(bits, lattice=lattice, low=(2, 1, 1))
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = turn * scales, shift
    moved = grid.transform(matrix)
    wanted = np.argwhere(bits) * grid.spacing + grid.center0
    wanted = wanted @ matrix[:3, :3].T + matrix[:3, 3]
    assert sorted(map(tuple, moved.voxels() * moved.spacing + moved.center0)) == sorted(map(tuple, wanted))
    ends = np.array(list(itertools.product(*zip(*grid.bounds)))) @ matrix[:3, :3].T + matrix[:3, 3]
    assert moved.bounds == (tuple(ends.min(0)), tuple(ends.max(0))) and moved.count == grid.count
    assert sorted(moved.lattice.shape) == sorted(lattice.shape) and moved.volume == pytest.approx(grid.volume * np.prod(scales))
    assert moved.transform(np.linalg.inv(matrix)) == grid  # powers of two: nothing is rounded


@pytest.mark.parametrize("seed", range(6))
def test_grids_are_sampled_anew_where_they_lie_oblique(seed):
    """A voxel is set when its center came out of a set voxel."""
    grid = bitvox.Grid.from_numpy(np.random.default_rng(seed).random((6, 7, 5)) < 0.5, spacing=SPACING, corner=(1, 2, 3))
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = rotated(seed) * (1.5, 1, 1), (4, -5, 6)
    for spacing in (None, 0.75, (0.5, 0.75, 1)):
        moved = grid.transform(matrix, spacing=spacing)
        assert moved.spacing == pytest.approx([0.75] * 3 if spacing is None else np.broadcast_to(spacing, 3))
        back = (np.argwhere(np.ones(moved.shape)) * moved.spacing + moved.center0 - matrix[:3, 3]) @ np.linalg.inv(matrix[:3, :3]).T
        at = np.floor((back - grid.corner) / grid.spacing).astype(int)
        inside = ((at >= 0) & (at < grid.shape)).all(axis=1)
        wanted = np.zeros(len(at), bool)
        wanted[inside] = grid.to_numpy()[tuple(at[inside].T)]
        assert np.array_equal(moved.to_numpy().ravel(), wanted) and moved.count
        ends = np.array(list(itertools.product(*zip(*grid.bounds)))) @ matrix[:3, :3].T + matrix[:3, 3]
        assert (np.array(moved.bounds[0]) <= ends.min(0) + 1e-9).all() and (np.array(moved.bounds[1]) >= ends.max(0) - 1e-9).all()


def test_what_a_grid_cannot_be_moved_by():
    grid = bitvox.Grid.from_numpy(np.ones((2, 2, 2)))
    for matrix in (np.eye(2), np.zeros((3, 3)), np.diag([1, 1, 0]), np.diag([1, 1, 1, 2]), np.full((3, 3), np.nan), [[1, 1, 0], [1, 1, 0], [0, 0, 1]]):
        with pytest.raises(bitvox.ArgumentError, match="matrix"):
            grid.transform(matrix)
    with pytest.raises(bitvox.ArgumentError, match="spacing"):
        grid.transform(np.eye(3), spacing=0.5)


def test_meshes_volumes_and_grids_go_the_same_way(ball):
    """One matrix brings all three to the same place."""
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = rotated(2) * 2, (1, 2, 3)
    there = ball.transform(matrix)
    grid = bitvox.voxelize(ball, resolution=48, padding=1)
    of_grid, of_volume = grid.transform(matrix), bitvox.Volume.of(grid).transform(matrix)
    assert of_grid.volume == pytest.approx(there.volume, rel=0.01) and of_volume.surface(0.5).volume == pytest.approx(there.volume, rel=0.02)
    assert of_grid == of_volume.aligned(method="nearest", outside=0).threshold(1)
    middle = np.mean(there.bounds, axis=0)
    for thing in (of_grid, of_volume):
        assert np.abs(np.mean(thing.bounds, axis=0) - middle).max() < 2 * grid.spacing[0]


def test_notions_have_one_name_in_all_classes(knot):
    """The table of the page on frames: which class has what; and `origin` is the center of the first voxel wherever there is one."""
    placed, has = ("bounds", "spacing", "origin", "center0", "corner", "shape"), {}
    grid = bitvox.voxelize(knot, resolution=16, window=((2, 3, 1), (8, 9, 5)))
    has[grid] = (*placed, "volume", "transform", "save")
    volume = bitvox.Volume.of(grid)
    rest = [(volume, (*placed, "transform", "save")), (bitvox.field(knot, resolution=12), (*placed, "save")), (grid.lattice, placed),
            (bitvox.refine(knot, base=4, levels=2), (*placed, "volume", "save")), (knot, ("bounds", "volume", "area", "is_closed", "transform", "save"))]
    for thing, names in [*has.items(), *rest]:
        for name in (*placed, "volume", "area", "is_closed", "transform", "save"):
            assert hasattr(thing, name) == (name in names), (type(thing), name)
        if "origin" in names:
            low, high = np.array(thing.bounds)
            assert thing.origin == thing.center0 and thing.corner == thing.bounds[0]
            assert np.allclose(thing.origin, low + 0.5 * np.array(thing.spacing)) and np.allclose(high - low, np.array(thing.shape) * thing.spacing)
    tree = rest[3][0]
    assert tree.volume == pytest.approx(tree.expand().volume) and tree.bounds == tree.lattice(0).bounds


def test_origin_is_that_of_others():
    """SimpleITK, VTK (of point data), nibabel and NRRD have the center of the first sample; of cells VTK has their corner."""
    volume = bitvox.Volume(np.zeros((3, 4, 5), np.uint8), spacing=SPACING, center0=ORIGIN, frame="lps")
    sitk = pytest.importorskip("SimpleITK")
    pyvista = pytest.importorskip("pyvista")
    image = sitk.GetImageFromArray(np.zeros((5, 4, 3), np.uint8))
    image.SetSpacing(SPACING)
    image.SetOrigin(volume.origin)
    assert bitvox.Volume.of(image).origin == image.GetOrigin() == volume.origin
    points = pyvista.ImageData(dimensions=(3, 4, 5), spacing=SPACING, origin=ORIGIN)
    points.point_data["s"] = np.zeros(60)
    assert bitvox.Volume.of(points).origin == tuple(points.points[0]) == ORIGIN
    grid = bitvox.Grid.from_numpy(np.ones((3, 4, 5)), spacing=SPACING, center0=ORIGIN)
    assert tuple(grid.to_pyvista().origin) == grid.corner and tuple(grid.to_pyvista().cell_centers().points[0]) == grid.origin == ORIGIN
