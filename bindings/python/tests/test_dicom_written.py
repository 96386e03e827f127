"""DICOM segmentations and contours: what is written is read back in its place, whatever the directions, and as SimpleITK places it."""

import numpy as np
import pytest
from test_places import ORIGIN, SPACING, TURNS, VALUES

import bitvox
from bitvox import formats

pydicom = pytest.importorskip("pydicom")


@pytest.mark.parametrize("turn", TURNS, ids=lambda t: "")
def test_segments_come_back_in_place(turn, tmp_path):
    pytest.importorskip("highdicom")
    if np.linalg.det(turn) < 0:
        turn = turn @ np.diag([1, 1, -1])  # frames are stacked either way round; a mirrored stack is one that is read backwards
    volume = bitvox.Volume(VALUES, order="zyx", spacing=SPACING, center0=ORIGIN, direction=turn, frame="lps")
    high, low = (bitvox.Volume(mask, spacing=SPACING, center0=ORIGIN, direction=turn, frame="lps") for mask in (volume.array > 500, volume.array < 900))
    formats.write_segmentation({"high": high, "low": low}, tmp_path / "s.dcm")
    found = formats.read_segmentation(tmp_path / "s.dcm")
    assert list(found) == ["high", "low"]
    for name, mask in (("high", high), ("low", low)):  # overlapping ones too
        assert placed(found[name]) == placed(mask), name
    assert found["high"].frame == "lps" and found["high"].array.dtype == np.uint8


def placed(mask):
    """World positions of the set voxels."""
    return {tuple(at) for at in mask.to_world(np.argwhere(mask.array)).round(4) + 0.0}


def test_a_segmentation_belongs_to_its_series(tmp_path):
    pytest.importorskip("highdicom")
    sitk = pytest.importorskip("SimpleITK")
    folder = tmp_path / "series"
    folder.mkdir()
    turn = TURNS[-1] * np.sign(np.linalg.det(TURNS[-1]))
    series(folder, turn)
    volume = bitvox.read_volume(folder)
    mask = bitvox.Volume(volume.array > 300, spacing=volume.spacing, center0=volume.center0, direction=volume.direction, frame="lps")
    formats.write_segmentation({"bone": mask}, tmp_path / "s.dcm", source=folder)
    one, made = pydicom.dcmread(next(folder.iterdir())), pydicom.dcmread(tmp_path / "s.dcm")
    assert (made.FrameOfReferenceUID, made.StudyInstanceUID, made.PatientID) == (one.FrameOfReferenceUID, one.StudyInstanceUID, one.PatientID)
    assert placed(formats.read_segmentation(tmp_path / "s.dcm")["bone"]) == placed(mask)
    reader = sitk.ImageSeriesReader()
    reader.SetFileNames(reader.GetGDCMSeriesFileNames(str(folder)))
    image = reader.Execute()
    set_there = [image.TransformIndexToPhysicalPoint(tuple(map(int, zyx[::-1]))) for zyx in np.argwhere(sitk.GetArrayFromImage(image) > 300)]
    theirs, mine = (np.array(sorted(set(points))) for points in (set_there, placed(mask)))
    assert len(theirs) == len(mine)
    assert np.linalg.norm(theirs[:, None] - mine[None], axis=2).min(axis=1).max() < 1e-3


def series(folder, turn):
    """Slices of VALUES with these directions."""
    study, frame, own = (pydicom.uid.generate_uid() for _ in range(3))
    for k, plane in enumerate(VALUES):
        data = pydicom.Dataset()
        data.file_meta = pydicom.dataset.FileMetaDataset()
        data.file_meta.TransferSyntaxUID = pydicom.uid.ExplicitVRLittleEndian
        data.SOPClassUID = data.file_meta.MediaStorageSOPClassUID = "1.2.840.10008.5.1.4.1.1.2"
        data.SOPInstanceUID = data.file_meta.MediaStorageSOPInstanceUID = pydicom.uid.generate_uid()
        data.StudyInstanceUID, data.SeriesInstanceUID, data.FrameOfReferenceUID = study, own, frame
        data.PatientID, data.PatientName, data.PatientBirthDate, data.PatientSex, data.AccessionNumber = "7", "A^B", "", "", ""
        data.StudyID, data.StudyDate, data.StudyTime, data.ReferringPhysicianName, data.Modality = "1", "20200101", "000000", "", "CT"
        data.InstanceNumber, data.SeriesNumber = k + 1, 1
        data.Rows, data.Columns = plane.shape
        data.PixelSpacing, data.SliceThickness = [SPACING[1], SPACING[0]], SPACING[2]
        data.ImageOrientationPatient = [f"{v:.13f}"[:16] for v in turn[:, :2].T.ravel()]
        data.ImagePositionPatient = [f"{v:.12f}"[:16] for v in np.array(ORIGIN) + turn[:, 2] * SPACING[2] * k]
        data.SamplesPerPixel, data.PhotometricInterpretation, data.BitsAllocated, data.BitsStored, data.HighBit = 1, "MONOCHROME2", 16, 16, 15
        data.PixelRepresentation, data.RescaleSlope, data.RescaleIntercept = 1, 1, 0
        data.PixelData = plane.tobytes()
        data.save_as(folder / f"{k}.dcm", enforce_file_format=True)


def test_grids_and_labels_are_written(tmp_path, ball):
    pytest.importorskip("highdicom")
    grid = bitvox.voxelize(ball, resolution=20)
    formats.write_segmentation(grid, tmp_path / "g.dcm")
    back = formats.read_segmentation(tmp_path / "g.dcm")["segment"]
    assert back.threshold(0.5).count == grid.count and back.surface(0.5).check().closed
    assert placed(back) == placed(bitvox.Volume(grid.to_numpy(), lattice=grid.lattice))
    labels = bitvox.Volume(np.arange(60).reshape(3, 4, 5) % 4, frame="ras")
    formats.write_segmentation(labels, tmp_path / "l.dcm")
    found = formats.read_segmentation(tmp_path / "l.dcm")
    assert list(found) == ["1", "2", "3"] and all(int(one.array.sum()) == 15 for one in found.values())
    assert placed(found["2"]) == placed(bitvox.Volume(labels.array == 2, frame="ras").turned("lps"))
    for wrong, kind in (({}, bitvox.EmptyError), (labels.array, TypeError), ({"a": 3}, TypeError), (grid - grid, bitvox.EmptyError),
                        ({"a": grid, "b": grid.pad(1)}, bitvox.ArgumentError), (bitvox.Volume(np.ones((2, 2, 2))), bitvox.ArgumentError)):
        with pytest.raises(kind):
            formats.write_segmentation(wrong, tmp_path / "w.dcm")
    assert not (tmp_path / "w.dcm").exists()
    (tmp_path / "no.dcm").write_bytes(b"nothing")
    with pytest.raises(bitvox.FormatError):
        formats.read_segmentation(tmp_path / "no.dcm")


def test_contours_come_back(tmp_path, ball):
    upright, slanted = bitvox.slice_mesh(ball, axis="z", spacing=0.5), bitvox.slice_mesh(ball, normal=(1, 2.1, 1.93), spacing=0.5)
    for stack in (upright, slanted):
        formats.write_rtstruct({"heart": stack}, tmp_path / "r.dcm")
        back = bitvox.read(tmp_path / "r.dcm")
        assert back.labels == ["heart"] and len(back.loops) == len(stack.loops)
        assert np.allclose(back.positions, stack.positions, atol=1e-6) and np.allclose(back.normal, stack.normal, atol=1e-6)
        for a, b in zip(back.loops, stack.loops):  # points that DICOM's 16 characters do not tell apart are one
            assert np.linalg.norm(a.points[None] - b.points[:, None], axis=2).min(axis=1).max() < 1e-9
            assert len(np.unique(b.points.round(9), axis=0)) - 12 <= len(a.points) <= len(b.points)
        assert bitvox.from_sections(back).check().volume == pytest.approx(bitvox.from_sections(stack).check().volume, rel=1e-9)
    formats.write_rtstruct(upright, tmp_path / "r.dcm")
    assert bitvox.read(tmp_path / "r.dcm").labels == upright.labels
    with pytest.raises(bitvox.EmptyError):
        formats.write_rtstruct({}, tmp_path / "r.dcm")
    with pytest.raises(TypeError, match="Sections"):
        formats.write_rtstruct({"a": 1}, tmp_path / "r.dcm")


def test_contours_refer_to_their_slices(tmp_path):
    folder = tmp_path / "series"
    folder.mkdir()
    series(folder, np.eye(3))
    box = [(-11, 29), (-9, 29), (-9, 31), (-11, 31)]
    stack = bitvox.Sections([[(x, y, ORIGIN[2] + SPACING[2] * k) for x, y in box] for k in (0, 2)])
    formats.write_rtstruct({"box": stack}, tmp_path / "r.dcm", source=folder)
    made, slices = pydicom.dcmread(tmp_path / "r.dcm"), {one.InstanceNumber: one for one in map(pydicom.dcmread, folder.iterdir())}
    found = [c.ContourImageSequence[0].ReferencedSOPInstanceUID for c in made.ROIContourSequence[0].ContourSequence]
    assert found == [slices[1].SOPInstanceUID, slices[3].SOPInstanceUID] and made.FrameOfReferenceUID == slices[1].FrameOfReferenceUID
