"""DICOM written: segmentations (SEG) through highdicom, contours (RTSTRUCT) through pydicom; and segmentations read."""

from __future__ import annotations

import datetime
import os
import re
from typing import Any, Mapping, Sequence

from .. import _arrays as arrays
from .._bytes import write_bytes
from .._errors import ArgumentError, EmptyError, FormatError, need, reading
from .._foreign import affine_of, placed_by
from .._grid import Grid
from .._sections import Sections
from .._volume import Volume, volume_of_bits

_RTSTRUCT = "1.2.840.10008.5.1.4.1.1.481.3"
_SEGMENTATION = "1.2.840.10008.5.1.4.1.1.66.4"
_COLOURS = ((230, 25, 75), (60, 180, 75), (0, 130, 200), (245, 130, 48), (145, 30, 180), (70, 240, 240), (240, 50, 230), (210, 245, 60))


def write_segmentation(segments: Any, path: str | os.PathLike[str], *, source: Any = None, description: str = "bitvox") -> None:
    """Write masks as a DICOM segmentation (SEG), each voxel in its place, whatever the directions are.

    Parameters
    ----------
    segments
        a `Grid`; a `Volume`, whose labels other than 0 become segments named by their numbers; or a dict of names and grids or
        volumes of 0 and 1 that share their place. Segments may overlap. Grids are in the patient's millimeters, "lps", as volumes
        that do not say their frame; volumes in "ras" are turned.
    path
        of the file.
    source
        the series that was segmented: a folder, or files or pydicom's datasets of its slices. The file then belongs to its patient, study and frame of
        reference. Default: a new study of a patient without a name.
    description
        of the new series.

    Raises
    ------
    ArgumentError
        masks that do not share their place.
    EmptyError
        no voxel is set.

    Examples
    --------
    >>> bitvox.formats.write_segmentation({'knot': bitvox.voxelize('knot.ply', resolution=16)}, 'seg.dcm')
    >>> list(bitvox.formats.read_segmentation('seg.dcm'))
    ['knot']
    """
    np, hd, pydicom = arrays.numpy("DICOM"), need("highdicom", "medical"), need("pydicom", "medical")
    masks = _masks(segments)
    first = next(iter(masks.values()))
    for name, one in masks.items():
        if one.shape != first.shape or not np.allclose(affine_of(one), affine_of(first), rtol=0, atol=1e-9):
            raise ArgumentError(f"segment {name!r} lies elsewhere than the first: bring all to one lattice by Grid.resample or Grid.crop")
    stacked = np.stack([np.asarray(one) != 0 for one in masks.values()], axis=-1)  # [x, y, z, segment]
    if not stacked.any():
        raise EmptyError("no voxel is set: a segmentation holds at least one")

    # Frames lie across z, their rows run along y and their columns along x: the array's axes are then z, y, x.
    slices = _slices(source) if source is not None else [_patient(pydicom)]
    affine = affine_of(first)[:, [2, 1, 0, 3]]
    volume = hd.Volume(array=np.ascontiguousarray(stacked.transpose(2, 1, 0, 3)).astype(np.uint8), affine=affine, coordinate_system="PATIENT",
                       frame_of_reference_uid=slices[0].FrameOfReferenceUID, channels={"SegmentNumber": range(1, len(masks) + 1)})
    tissue = hd.sr.CodedConcept("85756007", "SCT", "Tissue")
    algorithm = hd.AlgorithmIdentificationSequence(name="bitvox", family=pydicom.sr.codedict.codes.cid7162.MorphologicalOperations, version=_version())
    told = [hd.seg.SegmentDescription(number, name, tissue, tissue, "SEMIAUTOMATIC", algorithm_identification=algorithm, tracking_uid=hd.UID(),
                                      tracking_id=name) for number, name in enumerate(masks, 1)]
    made = hd.seg.Segmentation(slices, volume, "BINARY", told, hd.UID(), 1, hd.UID(), 1, "bitvox", "bitvox", _version(), "0",
                               content_label="SEGMENTATION", series_description=description)
    _save(made, path, pydicom)


def _masks(segments: Any) -> dict[str, Volume]:
    """Names and masks in the patient's frame "lps"."""
    np = arrays.numpy("DICOM")
    if isinstance(segments, Volume):
        values = [int(value) for value in np.unique(segments.array) if value]
        if segments.array.dtype.kind == "f":
            raise ArgumentError("segments are labels: a volume of integers, or masks; Volume.threshold makes a mask of floats")
        segments = {str(value): _like(segments, segments.array == value) for value in values}
    elif isinstance(segments, Grid):
        segments = {"segment": segments}
    if not isinstance(segments, Mapping):
        raise TypeError(f"segments must be a Grid, a Volume or a dict of names and masks, not {type(segments).__name__}")
    if not segments:
        raise EmptyError("no segments are given")
    made: dict[str, Volume] = {}
    for name, one in segments.items():
        volume = volume_of_bits(one) if isinstance(one, Grid) else one
        if not isinstance(volume, Volume):
            raise TypeError(f"segment {name!r} must be a Grid or a Volume, not {type(one).__name__}")
        made[str(name)] = volume if volume.frame is None else volume.turned("lps")
    return made


def _like(volume: Volume, array: Any) -> Volume:
    """Other samples in the place of a volume."""
    return Volume(array, spacing=volume.spacing, center0=volume.center0, direction=volume.direction, frame=volume.frame)


def _version() -> str:
    found: str = need("bitvox", "medical").__version__
    return found


def _slices(source: Any) -> list[Any]:
    """Datasets of the slices of a series."""
    pydicom = need("pydicom", "medical")
    if isinstance(source, (str, os.PathLike)):
        name = os.fspath(source)
        source = sorted(entry.path for entry in os.scandir(name) if entry.is_file()) if os.path.isdir(name) else [name]
    found = []
    for one in source:
        try:
            found.append(pydicom.dcmread(one) if isinstance(one, (str, os.PathLike)) else one)
        except pydicom.errors.InvalidDicomError:
            continue
    found = [one for one in found if "PixelData" in one and "ImagePositionPatient" in one]
    if not found:
        raise EmptyError("source: no DICOM slice with a position is here")
    return found


def _patient(pydicom: Any) -> Any:
    """What a segmentation takes from its source where there is none: one slice of a patient without a name."""
    made, now = pydicom.Dataset(), datetime.datetime.now()
    made.PatientID = made.PatientName = made.PatientBirthDate = made.PatientSex = made.AccessionNumber = made.StudyID = ""
    made.ReferringPhysicianName = ""
    made.StudyDate, made.StudyTime = now.strftime("%Y%m%d"), now.strftime("%H%M%S")
    made.SOPClassUID, made.Modality = "1.2.840.10008.5.1.4.1.1.7", "OT"
    for name in ("StudyInstanceUID", "SeriesInstanceUID", "SOPInstanceUID", "FrameOfReferenceUID"):
        setattr(made, name, pydicom.uid.generate_uid())
    made.Rows = made.Columns = made.SamplesPerPixel = 1
    made.PhotometricInterpretation = "MONOCHROME2"
    made.BitsAllocated, made.BitsStored, made.HighBit, made.PixelRepresentation = 8, 8, 7, 0
    made.ImagePositionPatient, made.ImageOrientationPatient, made.PixelSpacing, made.SliceThickness = [0, 0, 0], [1, 0, 0, 0, 1, 0], [1, 1], 1
    made.PixelData = b"\0\0"
    return made


def _save(made: Any, path: str | os.PathLike[str], pydicom: Any) -> None:
    """Whole or not at all."""
    held = pydicom.filebase.DicomBytesIO()
    made.save_as(held, enforce_file_format=True)
    write_bytes(os.fspath(path), held.getvalue())


def read_segmentation(path: str | os.PathLike[str]) -> dict[str, Volume]:
    """The segments of a DICOM segmentation (SEG) or of Slicer's .seg.nrrd, in its place and directions, in the patient's millimeters ("lps").

    Parameters
    ----------
    path
        the file. A .seg.nrrd may have its segments in one layer, as labels, or overlapping in several.

    Returns
    -------
    dict[str, Volume]
        Volumes by the segments' names (and a number after names that occur twice): uint8 of 0 and 1, or of a fractional segmentation
        float32 from 0 to 1. ``volume.threshold(0.5)`` makes a `Grid`, ``volume.surface(0.5)`` a mesh.

    Raises
    ------
    FormatError
        the file is not a segmentation, or its frames do not make a volume.

    Examples
    --------
    >>> solid = bitvox.voxelize('knot.ply', resolution=16)
    >>> bitvox.formats.write_segmentation(solid, 'seg.dcm')
    >>> bitvox.formats.read_segmentation('seg.dcm')['segment'].threshold(0.5).count == solid.count
    True
    """
    name = os.fspath(path)
    if name.lower().endswith(".nrrd"):
        return _segments_of_nrrd(name)
    np, hd, pydicom = arrays.numpy("DICOM"), need("highdicom", "medical"), need("pydicom", "medical")
    with reading(name, "pydicom"):
        found = pydicom.dcmread(name)
    if found.SOPClassUID != _SEGMENTATION:
        raise FormatError(f"{name} is not a segmentation: it is {pydicom.uid.UID(found.SOPClassUID).name}")
    try:
        whole = hd.seg.Segmentation.from_dataset(found).get_volume()
    except (RuntimeError, ValueError) as why:
        raise FormatError(f"{name}: its frames do not make a volume: {why}") from why
    kind = np.float32 if whole.array.dtype.kind == "f" else np.uint8
    place = placed_by(np.asarray(whole.affine)[:, [2, 1, 0, 3]])
    made: dict[str, Volume] = {}
    for i, segment in enumerate(found.SegmentSequence):
        called = str(segment.SegmentLabel)
        called = called if called not in made else f"{called} {segment.SegmentNumber}"
        made[called] = Volume(np.ascontiguousarray(whole.array[..., i]).astype(kind), order="zyx", frame="lps", **place)
    return made


def _segments_of_nrrd(name: str) -> dict[str, Volume]:
    """Slicer's segments: each is one label of one layer."""
    np, sitk = arrays.numpy("NRRD"), need("SimpleITK", "medical")
    if not os.path.isfile(name):
        raise FileNotFoundError(name)
    try:
        image = sitk.ReadImage(name)
    except RuntimeError as why:
        raise FormatError(f"{name}: SimpleITK cannot read it: {str(why).strip().splitlines()[-1]}") from why
    told = {key: image.GetMetaData(key) for key in image.GetMetaDataKeys()}
    numbers = sorted(int(key[7:-3]) for key in told if re.fullmatch(r"Segment\d+_ID", key))
    if image.GetDimension() != 3 or not numbers:
        raise FormatError(f"{name} is not a segmentation: it names no segments")
    values = sitk.GetArrayFromImage(image)
    layers = values if values.ndim == 4 else values[..., None]
    place = {"spacing": image.GetSpacing(), "center0": image.GetOrigin(), "direction": np.reshape(image.GetDirection(), (3, 3))}
    made: dict[str, Volume] = {}
    for number in numbers:
        layer, label = (int(told.get(f"Segment{number}_{field}", default)) for field, default in (("Layer", 0), ("LabelValue", 1)))
        if not 0 <= layer < layers.shape[3]:
            raise FormatError(f"{name}: segment {number} is in layer {layer} of {layers.shape[3]}")
        called = told.get(f"Segment{number}_Name", f"Segment_{number}")
        called = called if called not in made else f"{called} {number}"
        made[called] = Volume((layers[..., layer] == label).astype(np.uint8), order="zyx", frame="lps", **place)
    return made


def write_rtstruct(sections: Any, path: str | os.PathLike[str], *, source: Any = None, description: str = "bitvox") -> None:
    """Write contours as a DICOM RTSTRUCT, in the patient's millimeters.

    Parameters
    ----------
    sections
        `Sections`, whose labels name the structures, or a dict of names and `Sections` or meshes' slices.
    path
        of the file.
    source
        the series that the contours belong to, as for `write_segmentation`; each contour on one of its planes refers to it.
    description
        the structure set's label, of at most 16 characters.

    Raises
    ------
    EmptyError
        no contour.

    Examples
    --------
    >>> bitvox.formats.write_rtstruct({'knot': bitvox.slice_mesh('knot.ply', spacing=0.2)}, 'rs.dcm')
    >>> bitvox.read('rs.dcm').labels
    ['knot']
    """
    np, pydicom = arrays.numpy("DICOM"), need("pydicom", "medical")
    given = {"": sections} if isinstance(sections, Sections) else dict(sections)
    loops: dict[str, list[Any]] = {}
    for name, stack in given.items():
        if not isinstance(stack, Sections):
            raise TypeError(f"contours must be Sections, not {type(stack).__name__}; bitvox.slice_mesh makes them")
        for loop in stack.loops:
            loops.setdefault(str(name) or loop.label or "structure", []).append(loop.points)
    if not loops:
        raise EmptyError("no contours are given")

    slices = _slices(source) if source is not None else []
    base = slices[0] if slices else _patient(pydicom)
    made, now = pydicom.Dataset(), datetime.datetime.now()
    made.file_meta = pydicom.dataset.FileMetaDataset()
    made.file_meta.TransferSyntaxUID = pydicom.uid.ExplicitVRLittleEndian
    made.SOPClassUID = made.file_meta.MediaStorageSOPClassUID = _RTSTRUCT
    made.SOPInstanceUID = made.file_meta.MediaStorageSOPInstanceUID = pydicom.uid.generate_uid()
    for name in ("PatientID", "PatientName", "PatientBirthDate", "PatientSex", "StudyDate", "StudyTime", "StudyID", "AccessionNumber",
                 "ReferringPhysicianName", "StudyInstanceUID"):
        setattr(made, name, getattr(base, name, ""))
    made.Modality, made.Manufacturer, made.ManufacturerModelName, made.SoftwareVersions = "RTSTRUCT", "bitvox", "bitvox", _version()
    made.OperatorsName = ""
    made.SeriesInstanceUID, made.SeriesNumber, made.SeriesDescription = pydicom.uid.generate_uid(), 1, description
    made.FrameOfReferenceUID = base.FrameOfReferenceUID
    made.PositionReferenceIndicator = ""
    made.StructureSetLabel = description[:16]
    made.StructureSetDate, made.StructureSetTime = now.strftime("%Y%m%d"), now.strftime("%H%M%S")
    made.ReferencedFrameOfReferenceSequence = [_reference(base, slices, pydicom)]
    made.StructureSetROISequence, made.ROIContourSequence, made.RTROIObservationsSequence = [], [], []
    for number, (name, rings) in enumerate(loops.items(), 1):
        roi, contours, seen = pydicom.Dataset(), pydicom.Dataset(), pydicom.Dataset()
        roi.ROINumber, roi.ROIName, roi.ReferencedFrameOfReferenceUID = number, name, base.FrameOfReferenceUID
        roi.ROIGenerationAlgorithm = "SEMIAUTOMATIC"
        contours.ReferencedROINumber, contours.ROIDisplayColor = number, list(_COLOURS[(number - 1) % len(_COLOURS)])
        contours.ContourSequence = [_contour(points, slices, np, pydicom) for points in rings]
        seen.ObservationNumber = seen.ReferencedROINumber = number
        seen.RTROIInterpretedType = seen.ROIInterpreter = ""
        made.StructureSetROISequence.append(roi)
        made.ROIContourSequence.append(contours)
        made.RTROIObservationsSequence.append(seen)
    _save(made, path, pydicom)


def _reference(base: Any, slices: Sequence[Any], pydicom: Any) -> Any:
    """Which study and slices a structure set belongs to."""
    frame = pydicom.Dataset()
    frame.FrameOfReferenceUID = base.FrameOfReferenceUID
    if slices:
        study, series = pydicom.Dataset(), pydicom.Dataset()
        study.ReferencedSOPClassUID, study.ReferencedSOPInstanceUID = "1.2.840.10008.3.1.2.3.1", base.StudyInstanceUID
        series.SeriesInstanceUID = base.SeriesInstanceUID
        series.ContourImageSequence = [_image(one, pydicom) for one in slices]
        study.RTReferencedSeriesSequence = [series]
        frame.RTReferencedStudySequence = [study]
    return frame


def _image(one: Any, pydicom: Any) -> Any:
    made = pydicom.Dataset()
    made.ReferencedSOPClassUID, made.ReferencedSOPInstanceUID = one.SOPClassUID, one.SOPInstanceUID
    return made


def _contour(points: Any, slices: Sequence[Any], np: Any, pydicom: Any) -> Any:
    """One closed contour, numbers of at most 16 characters as DICOM's texts have them."""
    made = pydicom.Dataset()
    made.ContourGeometricType, made.NumberOfContourPoints = "CLOSED_PLANAR", len(points)
    made.ContourData = [pydicom.valuerep.format_number_as_ds(float(value)) for value in np.asarray(points).ravel()]
    for one in slices:
        across = np.cross(np.array(one.ImageOrientationPatient[:3], float), np.array(one.ImageOrientationPatient[3:], float))
        if np.abs((points - np.array(one.ImagePositionPatient, float)) @ across).max() < 0.01:
            made.ContourImageSequence = [_image(one, pydicom)]
            break
    return made
