"""Files of other fields, round trips and real data."""

import gzip
import subprocess
import sys
import warnings
import zipfile

import numpy as np
import pytest
from conftest import ball_grid, box_mesh

import bitvox
from bitvox import formats

ODD = ball_grid(14)[:, 2:, 4:]  # sides that differ


def grid_of(array=ODD, **options):
    return bitvox.Grid.from_numpy(array, **{"spacing": (0.5, 1.0, 2.0), "corner": (-3.0, 4.0, 5.5), **options})


def test_nifti(tmp_path):
    nibabel = pytest.importorskip("nibabel")
    grid = grid_of()
    formats.write_nifti(grid, tmp_path / "a.nii.gz")
    assert formats.read_nifti(tmp_path / "a.nii.gz") == grid
    # turned by right angles: the same voxels at the same places
    image = nibabel.load(tmp_path / "a.nii.gz")
    turned = image.as_reoriented(nibabel.orientations.axcodes2ornt("PIR"))
    nibabel.save(turned, tmp_path / "b.nii")
    back = formats.read_nifti(tmp_path / "b.nii")
    assert back == grid and back.center0 == grid.center0
    values = np.arange(24.0, dtype=np.float32).reshape(2, 3, 4)
    nibabel.save(nibabel.Nifti1Image(values, np.eye(4)), tmp_path / "c.nii")
    assert np.array_equal(formats.read_nifti(tmp_path / "c.nii", threshold=11.5).to_numpy(), values > 11.5)
    assert formats.read_nifti(tmp_path / "c.nii", threshold=(3, 5)).count == 3
    assert formats.read_nifti(tmp_path / "c.nii", labels=[1, 7]).count == 2
    volume = bitvox.read_volume(tmp_path / "c.nii")
    assert np.array_equal(volume.array, values) and volume.lattice.center0 == (0, 0, 0) and volume.threshold(12).count == 12
    with pytest.raises(bitvox.ArgumentError, match="spacing"):
        bitvox.read_volume(tmp_path / "c.nii", spacing=2)
    with pytest.raises(bitvox.ArgumentError):
        formats.read_nifti(tmp_path / "c.nii", threshold=1, labels=1)
    oblique = np.eye(4)
    oblique[0, 1] = 0.3
    nibabel.save(nibabel.Nifti1Image(values, oblique), tmp_path / "d.nii")
    with pytest.raises(bitvox.UnsupportedError, match="oblique"):
        formats.read_nifti(tmp_path / "d.nii")
    nibabel.save(nibabel.Nifti1Image(np.stack([values, -values], -1), np.eye(4)), tmp_path / "e.nii")
    with pytest.raises(bitvox.UnsupportedError, match="index"):
        formats.read_nifti(tmp_path / "e.nii")
    assert formats.read_nifti(tmp_path / "e.nii", index=1, threshold=-1.5).count == 2
    with pytest.raises(bitvox.UnsupportedError, match=r"formats.read_nifti\(path\) takes all that are not 0 \(a mask\), with threshold= or labels="):
        bitvox.read(tmp_path / "c.nii")


def test_grids_come_back_of_nifti(tmp_path):
    nibabel = pytest.importorskip("nibabel")
    grid = grid_of()
    for name in ("a.nii", "a.nii.gz"):
        grid.save(tmp_path / name)
        back = bitvox.read(tmp_path / name)
        assert type(back) is bitvox.Grid and back == grid
        formats.write_nifti(grid, tmp_path / name)
        assert bitvox.read(tmp_path / name) == grid
    empty = grid_of(np.zeros((3, 4, 5), bool))
    empty.save(tmp_path / "empty.nii")
    assert bitvox.read(tmp_path / "empty.nii") == empty
    # turned by right angles by another program: the head is kept, the voxels are at the same places
    image = nibabel.load(tmp_path / "a.nii")
    nibabel.save(image.as_reoriented(nibabel.orientations.axcodes2ornt("PIR")), tmp_path / "b.nii")
    assert bitvox.read(tmp_path / "b.nii") == grid
    # samples of 0 and 1 that nobody called a grid; a head that was kept over other samples
    bitvox.Volume(grid.to_numpy().view(np.uint8)).save(tmp_path / "volume.nii")
    nibabel.save(nibabel.Nifti1Image(3 * np.asarray(image.dataobj), image.affine, image.header), tmp_path / "three.nii")
    nibabel.save(nibabel.Nifti1Image(np.asarray(image.dataobj, np.float32), image.affine, image.header), tmp_path / "float.nii")
    for name in ("volume.nii", "three.nii", "float.nii"):
        with pytest.raises(bitvox.UnsupportedError, match="was not written of a Grid"):
            bitvox.read(tmp_path / name)
        assert formats.read_nifti(tmp_path / name).count == grid.count  # what the message advises
    with pytest.raises(FileNotFoundError):
        bitvox.read(tmp_path / "missing.nii")


def test_brain(shared):
    pytest.importorskip("nibabel")
    brain = formats.read_nifti(shared("volumes/ch2bet.nii.gz"), threshold=40)
    assert brain.shape == (181, 217, 181) and brain.spacing == (1.0, 1.0, 1.0) and brain.count > 1_000_000
    assert brain.surface().check().closed


def dicom_series(folder, values, orientation=(1, 0, 0, 0, 1, 0), spacing=(2.0, 0.5), step=3.0, start=(10.0, 20.0, 30.0), flip=False):
    pydicom = pytest.importorskip("pydicom")
    from pydicom.uid import ExplicitVRLittleEndian, generate_uid

    series, normal = generate_uid(), np.cross(orientation[:3], orientation[3:])
    for i, layer in enumerate(values):
        meta = pydicom.dataset.FileMetaDataset()
        meta.TransferSyntaxUID, meta.MediaStorageSOPClassUID, meta.MediaStorageSOPInstanceUID = ExplicitVRLittleEndian, "1.2.840.10008.5.1.4.1.1.2", generate_uid()
        one = pydicom.dataset.FileDataset("", {}, file_meta=meta, preamble=b"\0" * 128)
        one.SOPClassUID, one.SOPInstanceUID, one.SeriesInstanceUID = meta.MediaStorageSOPClassUID, meta.MediaStorageSOPInstanceUID, series
        one.Rows, one.Columns = layer.shape
        one.PixelSpacing, one.ImageOrientationPatient = list(spacing), list(orientation)
        one.ImagePositionPatient = [float(x) for x in np.array(start) + normal * step * i]
        one.SamplesPerPixel, one.PhotometricInterpretation, one.PixelRepresentation = 1, "MONOCHROME2", 0
        one.BitsAllocated = one.BitsStored = 16
        one.HighBit, one.RescaleSlope, one.RescaleIntercept = 15, "1", "-1000"
        one.PixelData = (layer + 1000).astype("<u2").tobytes()
        one.save_as(folder / f"{(len(values) - i) if flip else i:03d}.dcm", enforce_file_format=True)
    return series


def enhanced_dicom(path, values, orientation, spacing, step, start):
    """One file of many frames: orientation and spacing are common to all, positions are each frame's own; the last frame stands first."""
    pydicom = pytest.importorskip("pydicom")
    from pydicom.sequence import Sequence
    from pydicom.uid import ExplicitVRLittleEndian, generate_uid

    def group(**told):
        one = pydicom.Dataset()
        for name, value in told.items():
            setattr(one, name, value)
        return one

    meta = pydicom.dataset.FileMetaDataset()
    meta.TransferSyntaxUID, meta.MediaStorageSOPClassUID, meta.MediaStorageSOPInstanceUID = ExplicitVRLittleEndian, "1.2.840.10008.5.1.4.1.1.2.1", generate_uid()
    whole = pydicom.dataset.FileDataset("", {}, file_meta=meta, preamble=b"\0" * 128)
    whole.SOPClassUID, whole.SOPInstanceUID, whole.SeriesInstanceUID = meta.MediaStorageSOPClassUID, meta.MediaStorageSOPInstanceUID, generate_uid()
    whole.Modality, whole.NumberOfFrames, whole.Rows, whole.Columns = "CT", len(values), *values[0].shape
    whole.SamplesPerPixel, whole.PhotometricInterpretation, whole.PixelRepresentation, whole.BitsAllocated, whole.BitsStored, whole.HighBit = 1, "MONOCHROME2", 0, 16, 16, 15
    whole.SharedFunctionalGroupsSequence = Sequence([group(
        PlaneOrientationSequence=Sequence([group(ImageOrientationPatient=list(orientation))]),
        PixelMeasuresSequence=Sequence([group(PixelSpacing=list(spacing), SliceThickness=step)]),
        PixelValueTransformationSequence=Sequence([group(RescaleSlope="1", RescaleIntercept="-1000", RescaleType="HU")]))])
    normal, order = np.cross(orientation[:3], orientation[3:]), [len(values) - 1, *range(len(values) - 1)]
    whole.PerFrameFunctionalGroupsSequence = Sequence([group(
        PlanePositionSequence=Sequence([group(ImagePositionPatient=[float(x) for x in np.array(start) + normal * step * i])])) for i in order])
    whole.PixelData = np.stack([values[i] + 1000 for i in order]).astype("<u2").tobytes()
    whole.save_as(path, enforce_file_format=True)


@pytest.mark.parametrize("orientation", [(1, 0, 0, 0, 1, 0), (0, 1, 0, 0, 0, -1), (0.8, 0.6, 0, -0.6, 0.8, 0)], ids=str)
def test_dicom_of_many_frames(orientation, tmp_path):
    """A file of many frames is the series that its frames are as files."""
    zyx = np.random.default_rng(4).integers(-1000, 2000, (4, 6, 5))
    one, many = tmp_path / "one", tmp_path / "many"
    one.mkdir(), many.mkdir()
    enhanced_dicom(one / "all.dcm", zyx, orientation, (2.0, 0.5), 3.0, (10.0, 20.0, 30.0))
    dicom_series(many, zyx, orientation)
    volume, wanted = bitvox.read_volume(one), bitvox.read_volume(many)
    assert volume == wanted and volume.array.dtype == np.int16 and volume.frame == "lps"
    assert bitvox.read_volume(one / "all.dcm") == wanted


def test_dicom_in_folders_of_folders(tmp_path):
    inner = tmp_path / "STUDY" / "SERIES"
    inner.mkdir(parents=True)
    first = dicom_series(inner, np.zeros((3, 4, 5), int))
    assert bitvox.read_volume(tmp_path) == bitvox.read_volume(inner)
    (tmp_path / "OTHER").mkdir()
    second = dicom_series(tmp_path / "OTHER", np.ones((2, 4, 5), int))
    with pytest.raises(bitvox.FormatError, match="2 series.*3 slices") as found:
        bitvox.read_volume(tmp_path)
    assert first in str(found.value) and second in str(found.value) and "without a description, 2 slices" in str(found.value)
    assert formats.read_dicom_volume(tmp_path, series=second).array.max() == 1


@pytest.mark.parametrize("ending,module", [("npz", "numpy"), ("nii", "nibabel"), ("tif", "tifffile"), ("mha.gz", "SimpleITK"), ("dcm", "pydicom"), ("dxf", "ezdxf"),
                                           ("vtk", "pyvista")])
def test_damaged_files_of_other_libraries(ending, module, tmp_path):
    """Whatever the library that reads them raises, it is an error of this package."""
    pytest.importorskip(module)
    path, samples = tmp_path / f"a.{ending}", np.arange(120, dtype=np.uint8).reshape(4, 5, 6)
    if ending == "npz":
        np.savez(path, samples)
    elif ending == "tif":
        pytest.importorskip("tifffile").imwrite(path, samples)
    elif ending == "vtk":
        pytest.importorskip("pyvista")
        vtk = pytest.importorskip("vtkmodules.vtkIOLegacy").vtkDataSetWriter()
        vtk.SetFileName(str(path))
        vtk.SetInputData(bitvox.Volume(samples).to_pyvista())
        vtk.Write()
    elif ending == "dxf":
        drawing = pytest.importorskip("ezdxf").new()
        drawing.modelspace().add_lwpolyline([(0, 0), (1, 0), (1, 1)], close=True)
        drawing.saveas(path)
    elif ending == "dcm":
        formats.write_rtstruct(bitvox.slice_mesh(box_mesh((0, 0, 0), (5, 5, 5)), spacing=0.5), path)
    else:
        bitvox.Volume(samples).save(path)
    whole, random, refused = path.read_bytes(), np.random.default_rng(7), 0
    for _ in range(150):
        data = bytearray(whole)
        for at in random.integers(0, min(len(data), 4000 if ending in ("dcm", "dxf") else 700), 3):
            data[at] = random.integers(0, 256)
        path.write_bytes(data[: random.integers(1, len(data))] if random.random() < 0.2 else data)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            try:
                (bitvox.read if ending in ("mha.gz", "dcm", "dxf") else bitvox.read_volume)(path)
            except (bitvox.Error, MemoryError):
                refused += 1
    assert refused > 20


@pytest.mark.parametrize("name,data", [("a.nii", b"hello" * 200), ("a.nii.gz", b"hello" * 200), ("a.nii.gz", "cut")], ids=["none", "not packed", "cut"])
def test_damaged_nifti(name, data, tmp_path):
    pytest.importorskip("nibabel")
    if data == "cut":
        bitvox.Volume(np.random.default_rng(0).random((9, 9, 9))).save(tmp_path / "whole.nii.gz")
        data = (tmp_path / "whole.nii.gz").read_bytes()[:3000]
    (tmp_path / name).write_bytes(data)
    with pytest.raises(bitvox.FormatError, match="nibabel"):
        bitvox.read_volume(tmp_path / name)
    with pytest.raises(FileNotFoundError):
        bitvox.read_volume(tmp_path / "missing.nii")


def test_dicom_series(tmp_path):
    pydicom = pytest.importorskip("pydicom")
    zyx = ODD.transpose(2, 1, 0) * 300
    dicom_series(tmp_path, zyx, flip=True)
    (tmp_path / "README").write_text("no picture")
    with pytest.raises(bitvox.UnsupportedError, match="read_dicom"):
        bitvox.read(tmp_path / "001.dcm")
    grid = formats.read_dicom(tmp_path, threshold=150)
    assert grid.spacing == (0.5, 2.0, 3.0) and grid.center0 == (10.0, 20.0, 30.0)
    assert np.array_equal(grid.to_numpy(), ODD)
    volume = bitvox.read_volume(tmp_path)
    assert np.array_equal(volume.array, ODD * 300) and volume.lattice == grid.lattice
    (tmp_path / "007.dcm").unlink()
    with pytest.raises(bitvox.FormatError, match="evenly"):
        formats.read_dicom(tmp_path)
    other = tmp_path / "sagittal"
    other.mkdir()
    dicom_series(other, ODD * 300, orientation=(0, 1, 0, 0, 0, -1), spacing=(2.0, 1.0), step=0.5, start=(1.0, 2.0, 50.0))
    turned = formats.read_dicom(other, threshold=(100, 400))
    assert turned.spacing == (0.5, 1.0, 2.0)
    assert np.array_equal(turned.to_numpy(), ODD.transpose(0, 2, 1)[::-1, :, ::-1])  # x by slices, y by columns, z by rows
    assert formats.read_dicom_volume(other).threshold(100, 400) == turned
    assert turned.center0 == (1.0 - 0.5 * (ODD.shape[0] - 1), 2.0, 50.0 - 2.0 * (ODD.shape[1] - 1))
    empty = tmp_path / "empty"
    empty.mkdir()
    with pytest.raises(bitvox.EmptyError):
        formats.read_dicom(empty)
    slanted = tmp_path / "slanted"
    slanted.mkdir()
    dicom_series(slanted, zyx[:2], orientation=(0.8, 0.6, 0, -0.6, 0.8, 0))
    with pytest.raises(bitvox.UnsupportedError, match="oblique"):
        formats.read_dicom(slanted)
    assert pydicom is not None


def test_rtstruct(tmp_path):
    pydicom = pytest.importorskip("pydicom")
    from pydicom.dataset import Dataset
    from pydicom.uid import ExplicitVRLittleEndian

    data = Dataset()
    data.file_meta = pydicom.dataset.FileMetaDataset()
    data.file_meta.TransferSyntaxUID = ExplicitVRLittleEndian
    data.file_meta.MediaStorageSOPClassUID = data.SOPClassUID = "1.2.840.10008.5.1.4.1.1.481.3"
    data.file_meta.MediaStorageSOPInstanceUID = data.SOPInstanceUID = "1.2.3"
    data.StructureSetROISequence, data.ROIContourSequence = [], []
    for number, name in ((1, "heart"), (2, "lung")):
        roi, contours = Dataset(), Dataset()
        roi.ROINumber, roi.ROIName, contours.ReferencedROINumber, contours.ContourSequence = number, name, number, []
        for z in (0.0, 2.5):
            one = Dataset()
            one.ContourGeometricType = "CLOSED_PLANAR"
            one.ContourData = [0, 0, z, number, 0, z, number, number, z, 0, number, z]
            contours.ContourSequence.append(one)
        for z in (0.0, 2.5) if name == "lung" else ():  # a ring: out, along a line to its hole, round it, back along the line
            one = Dataset()
            one.ContourGeometricType = "CLOSED_PLANAR"
            ring = [(10, 0), (18, 0), (18, 8), (10, 8), (10, 4), (12, 4), (12, 6), (14, 6), (14, 2), (12, 2), (12, 4), (10, 4)]
            one.ContourData = [x for p in ring for x in (*p, z)]
            contours.ContourSequence.append(one)
        point = Dataset()
        point.ContourGeometricType, point.ContourData = "POINT", [9, 9, 9]
        contours.ContourSequence.append(point)
        data.StructureSetROISequence.append(roi)
        data.ROIContourSequence.append(contours)
    data.save_as(tmp_path / "rs.dcm", enforce_file_format=True)
    sections = formats.read_rtstruct(tmp_path / "rs.dcm")
    assert sections.labels == ["heart", "lung"] and sections.positions == [0.0, 2.5] and sections.normal == (0.0, 0.0, 1.0)
    assert len(sections.of("lung").loops) == 6 and len(sections.on(1)) == 4
    assert sorted(len(loop.points) for loop in sections.of("lung").on(1)) == [4, 5, 5]
    assert sections.of("lung").surface(grid=(40, 40)).check().volume == pytest.approx((64 - 8 + 4) * 2.5)
    assert bitvox.from_sections(tmp_path / "rs.dcm", label="heart").check().volume == pytest.approx(2.5)
    assert bitvox.read(tmp_path / "rs.dcm").labels == ["heart", "lung"]
    with pytest.raises(bitvox.ArgumentError, match="heart"):
        bitvox.from_sections(tmp_path / "rs.dcm")
    (tmp_path / "no.dcm").write_bytes(b"nothing of the kind")
    with pytest.raises(bitvox.FormatError, match="no.dcm"):
        bitvox.from_sections(tmp_path / "no.dcm")
    assert sections.of("lung").on(1)[0].points[2].tolist() == [2.0, 2.0, 2.5]
    assert formats.read_rtstruct(tmp_path / "rs.dcm", names=["heart"]).labels == ["heart"]
    with pytest.raises(bitvox.FormatError, match="liver"):
        formats.read_rtstruct(tmp_path / "rs.dcm", names=["liver"])


def test_sections():
    square = np.array([[0, 0, 1], [1, 0, 1], [1, 1, 1.0]])
    sections = bitvox.Sections([square, bitvox.Loop(square + [0, 0, 2], "b"), square + [5, 5, 0]])
    assert len(sections) == 2 and sections.positions == [1.0, 3.0] and sections.section_of == [0, 1, 0]
    assert bitvox.Sections([square[:, [2, 0, 1]]], (2, 0, 0)).normal == (1.0, 0.0, 0.0)
    for bad in ([square[:2]], [square * np.nan], [square + [[0, 0, 0], [0, 0, 1], [0, 0, 0]]], [[[0, 0]] * 3]):
        with pytest.raises(bitvox.Error):
            bitvox.Sections(bad)
    with pytest.raises(bitvox.ArgumentError):
        bitvox.Sections([square], (0, 0, 0))
    with pytest.raises(bitvox.ArgumentError):
        sections.of("c")


def test_dxf(tmp_path):
    ezdxf = pytest.importorskip("ezdxf")
    drawing = ezdxf.new()
    space = drawing.modelspace()
    space.add_lwpolyline([(0, 0), (4, 0), (4, 4), (0, 4)], close=True, dxfattribs={"layer": "ore", "elevation": 10})
    space.add_polyline3d([(0, 0, 20), (1, 0, 20), (1, 1, 20)], close=True, dxfattribs={"layer": "ore"})
    space.add_lwpolyline([(0, 0), (4, 0), (4, 4)], dxfattribs={"layer": "waste"})
    space.add_circle((1, 1, 10), 2, dxfattribs={"layer": "pipe"})
    space.add_line((0, 0), (1, 1))
    drawing.saveas(tmp_path / "a.dxf")
    sections = formats.read_dxf(tmp_path / "a.dxf")
    assert sections.labels == ["ore", "pipe"] and sections.positions == [10.0, 20.0]
    assert sections.loops[0].points.tolist() == [[0, 0, 10], [4, 0, 10], [4, 4, 10], [0, 4, 10]]
    circle = sections.of("pipe").loops[0].points
    assert np.allclose(np.hypot(*(circle[:, :2] - 1).T), 2, atol=1e-3) and len(circle) > 20
    assert formats.read_dxf(tmp_path / "a.dxf", layers=["WASTE"], close=True).labels == ["waste"]
    with pytest.raises(bitvox.EmptyError):
        formats.read_dxf(tmp_path / "a.dxf", layers=["waste"])
    with pytest.raises(bitvox.EmptyError, match="gold"):
        formats.read_dxf(tmp_path / "a.dxf", layers=["gold"])
    assert bitvox.read(tmp_path / "a.dxf").labels == sections.labels
    (tmp_path / "b.dxf").write_text("nothing of the kind")
    with pytest.raises(bitvox.FormatError, match="b.dxf"):
        bitvox.read(tmp_path / "b.dxf")
    with pytest.raises(FileNotFoundError):
        bitvox.read(tmp_path / "none.dxf")


def test_drawings_of_sections_one_by_one(tmp_path):
    ezdxf = pytest.importorskip("ezdxf")
    names = [tmp_path / f"S_{i}.dxf" for i in range(3)]
    for i, name in enumerate(names):
        drawing = ezdxf.new()
        drawing.modelspace().add_lwpolyline([(0, 0), (4, 0), (4, 4), (0, 4)], close=True, dxfattribs={"layer": "ore"})
        drawing.saveas(name)
    sections = formats.read_dxf(names, positions=[0, 10, 25])
    assert sections.positions == [0.0, 10.0, 25.0] and sections.labels == ["ore"]
    assert bitvox.from_sections(sections).check().volume == pytest.approx(16 * 25)
    with pytest.raises(bitvox.ArgumentError, match="positions"):
        formats.read_dxf(names, positions=[0, 10])
    stacked = tmp_path / "stacked.dxf"
    drawing = ezdxf.new()
    for z in (0, 10, 25):
        drawing.modelspace().add_lwpolyline([(0, 0), (4, 0), (4, 4), (0, 4)], close=True, dxfattribs={"elevation": z})
    drawing.saveas(stacked)
    assert bitvox.from_sections(stacked).check().volume == pytest.approx(16 * 25)


def test_mine_sections(shared):
    pytest.importorskip("ezdxf")
    paths = [shared(f"contours/mine_sections_dxf/S_{y}.dxf") for y in (0, 50, 100)]
    sections = formats.read_dxf(paths, positions=(0, 50, 100), layers=["bbox"])
    assert sections.positions == [0.0, 50.0, 100.0] and sections.labels == ["bbox"]
    assert bitvox.from_sections(sections).check().closed


@pytest.mark.parametrize("name", ["slice_%d.png", "stack.tif"])
def test_images(tmp_path, name):
    pytest.importorskip("PIL")
    grid = grid_of()
    names = formats.write_images(grid, tmp_path / name)
    source = tmp_path / name.replace("%d", "*")
    assert formats.read_images(source, spacing=grid.spacing, corner=grid.corner) == grid
    if len(names) > 1:
        assert formats.read_images(names, threshold=128, spacing=grid.spacing, corner=grid.corner) == grid
        assert len(names) == 10 and formats.read_images(names, flip_y=False).to_numpy()[:, ::-1].tolist() == ODD.tolist()
    with pytest.raises(bitvox.ArgumentError):
        formats.write_images(grid, tmp_path / "a.png")
    with pytest.raises(bitvox.EmptyError):
        formats.read_images(tmp_path / "none_*.png")


def test_pictures_top_row_is_the_highest_y(tmp_path):
    image = pytest.importorskip("PIL.Image")
    picture = np.zeros((4, 5), np.uint8)
    picture[0, 1] = 255
    image.fromarray(picture).save(tmp_path / "a.png")
    assert formats.read_images(tmp_path / "a.png").voxels().tolist() == [[1, 3, 0]]


AMF = """<?xml version="1.0"?><amf unit="millimeter"><object id="1"><mesh><vertices>{vertices}</vertices>
<volume>{triangles}</volume></mesh></object>{more}</amf>"""


def amf_of(more=""):
    v, f = box_mesh((0, 0, 0), (1, 2, 3))
    return AMF.format(more=more, vertices="".join(f"<vertex><coordinates><x>{x}</x><y>{y}</y><z>{z}</z></coordinates></vertex>" for x, y, z in v),
                      triangles="".join(f"<triangle><v1>{a}</v1><v2>{b}</v2><v3>{c}</v3></triangle>" for a, b, c in f))


def test_amf(tmp_path):
    (tmp_path / "a.amf").write_text(amf_of())
    assert bitvox.read(tmp_path / "a.amf").check().volume == 6.0
    with zipfile.ZipFile(tmp_path / "b.amf", "w") as archive:
        archive.writestr("b.amf", amf_of())
    assert bitvox.read(tmp_path / "b.amf").check().closed
    (tmp_path / "b.amf.gz").write_bytes(gzip.compress((tmp_path / "b.amf").read_bytes()))
    assert bitvox.read(tmp_path / "b.amf.gz").check().closed
    both = ('<constellation id="9"><instance objectid="1"/><instance objectid="1"><deltax>10</deltax><rz>90</rz></instance></constellation>')
    (tmp_path / "c.amf").write_text(amf_of(both))
    found = bitvox.read(tmp_path / "c.amf").check()
    assert found.components == 2 and found.low == (0, 0, 0) and found.high == (10, 2, 3) and found.volume == 12.0
    for broken in ("<amf>", "<stl/>", amf_of().replace("<v1>0</v1>", "<v1>99</v1>", 1), amf_of().replace("<x>0.0</x>", "<x>wide</x>", 1),
                   amf_of('<constellation id="9"><instance objectid="9"/></constellation>'),
                   amf_of('<constellation id="9"><instance objectid="5"/></constellation>')):
        (tmp_path / "d.amf").write_text(broken)
        with pytest.raises(bitvox.FormatError):
            bitvox.read(tmp_path / "d.amf")
    (tmp_path / "d.amf").write_text("<amf></amf>")
    with pytest.raises(bitvox.EmptyError):
        bitvox.read(tmp_path / "d.amf")


@pytest.mark.parametrize("ending", ["3mf", "3mf.gz", "glb", "glb.gz"])
def test_meshes_that_trimesh_writes(tmp_path, ending):
    trimesh = pytest.importorskip("trimesh")
    pytest.importorskip("networkx")
    if ending.startswith("3mf"):
        pytest.importorskip("lxml")
    v, f = box_mesh((0, 0, 0), (1, 2, 3))
    data = trimesh.Trimesh(v, f).export(file_type=ending.removesuffix(".gz"))
    (tmp_path / f"a.{ending}").write_bytes(gzip.compress(data) if ending.endswith("gz") else data)
    assert bitvox.check(tmp_path / f"a.{ending}", weld=True).volume == 6.0
    (tmp_path / f"b.{ending}").write_bytes(gzip.compress(b"nothing") if ending.endswith("gz") else b"nothing")
    with pytest.raises(bitvox.FormatError, match="zip" if ending.startswith("3mf") else "JSON"):
        bitvox.read(tmp_path / f"b.{ending}")


def test_unknown_endings(tmp_path):
    with pytest.raises(bitvox.UnsupportedError, match="docx"):
        bitvox.read(tmp_path / "a.docx")
    pytest.importorskip("trimesh")
    with pytest.raises(FileNotFoundError):
        bitvox.read(tmp_path / "a.dae")


@pytest.mark.parametrize(("module", "extra", "call"), [
    ("nibabel", "medical", "formats.read_nifti('a.nii')"), ("pydicom", "medical", "formats.read_dicom('.')"),
    ("ezdxf", "geo", "formats.read_dxf('a.dxf')"), ("PIL", "formats", "formats.read_images('a.png')"),
    ("trimesh", "formats", "bitvox.read('a.dae')"), ("dask", "big", "bitvox.big.voxelize(([], []), resolution=8, chunks=8)"),
    ("zarr", "big", "bitvox.big.from_zarr('a.zarr')")])
def test_a_missing_extra_is_named(module, extra, call):
    code = f"""import sys
sys.modules[{module!r}] = None
import bitvox, bitvox.big
from bitvox import formats
try:
    {call}
except bitvox.MissingExtraError as error:
    print(error)
"""
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert f"bitvox[{extra}]" in found.stdout, found.stderr


def test_hounsfield_units_stay_whole_numbers():
    dicom = pytest.importorskip("bitvox.formats.dicom")

    class Slice:
        RescaleSlope, RescaleIntercept = "1", "-1024"
        pixel_array = np.array([[0, 4095]], np.uint16)

    found = dicom._values(Slice(), np)
    assert found.dtype == np.int16 and found.tolist() == [[-1024, 3071]]
    Slice.pixel_array = np.array([[65535]], np.uint16)
    assert dicom._values(Slice(), np).tolist() == [[64511]]
    Slice.RescaleSlope = "0.5"
    assert dicom._values(Slice(), np).tolist() == [[65535 * 0.5 - 1024]]
