"""DICOM through pydicom: series of slices, contours of structures."""

from __future__ import annotations

import io
import os
from types import SimpleNamespace
from typing import Any, Sequence

from .. import _arrays as arrays
from .._bytes import read_bytes
from .._errors import EmptyError, FormatError, UnsupportedError, need, reading
from .._grid import Grid
from .._sections import Loop, Sections, stacked
from .._volume import Volume
from ._values import choose


def _files(source: Any) -> list[str]:
    if isinstance(source, (str, os.PathLike)):
        folder = os.fspath(source)
        if os.path.isdir(folder):  # exports put series into folders of folders
            return sorted(os.path.join(inner, name) for inner, _, names in os.walk(folder) for name in names)
        return [folder]
    return [os.fspath(path) for path in source]


def read_dicom(source: Any, *, threshold: Any = None, labels: Any = None, series: str | None = None) -> Grid:
    """A grid from a DICOM series.

    Parameters
    ----------
    source, series
        as for `read_dicom_volume`, which also says what is refused.
    threshold
        values above it are set; (low, high): from low to high.
    labels
        values that are set. Without either, all values other than 0.

    Examples
    --------
    >>> bitvox.formats.read_dicom('folder', threshold=300)  # doctest: +SKIP
    """
    volume = read_dicom_volume(source, series=series)
    if (volume.direction != arrays.numpy("DICOM").eye(3)).any():
        raise UnsupportedError("slices lie oblique to the patient's axes; take read_dicom_volume(...).aligned().threshold(...)")
    return Grid.from_numpy(choose(volume.array, threshold, labels), lattice=volume.lattice)


def read_dicom_volume(source: Any, *, series: str | None = None) -> Volume:
    """The samples of a DICOM series after slope and intercept (Hounsfield units of CT), in the patient's millimeters (x to the left,
    y to the back, z to the head).

    Parameters
    ----------
    source
        a folder (with those in it), or the files of the slices in any order; one file of many frames (enhanced CT and MR) is a series
        too. Files without a picture are skipped.
    series
        SeriesInstanceUID, when the files are of several.

    Raises
    ------
    FormatError
        slices that do not belong together, are missing or not evenly spaced.
    UnsupportedError
        slices that are shifted against each other. What lies oblique keeps its ``direction``.

    Examples
    --------
    >>> bitvox.formats.read_dicom_volume('folder')  # doctest: +SKIP
    """
    pydicom, slices = need("pydicom", "medical"), []
    for path in _files(source):
        with reading(path, "pydicom"):
            try:
                one = pydicom.dcmread(path)
            except pydicom.errors.InvalidDicomError:
                continue
            if "PixelData" in one and (series is None or one.SeriesInstanceUID == series):
                slices += _frames(one) if "PerFrameFunctionalGroupsSequence" in one else [one] if "ImagePositionPatient" in one else []
    with reading(source, "pydicom"):
        return _stacked(slices)


def _stacked(slices: list[Any]) -> Volume:
    """A volume of slices in any order."""
    np = arrays.numpy("DICOM")
    if not slices:
        raise EmptyError("no DICOM slice with a position is here")
    found: dict[str, list[Any]] = {}
    for one in slices:
        found.setdefault(str(getattr(one, "SeriesInstanceUID", "")), []).append(one)
    if len(found) > 1:
        told = [f"{uid!r} ({getattr(some[0], 'SeriesDescription', None) or 'without a description'}, {len(some)} slices)" for uid, some in sorted(found.items())]
        raise FormatError(f"slices of {len(found)} series; give series= one of {', '.join(told)}")
    first = slices[0]
    rows, columns = np.array(first.ImageOrientationPatient[:3], float), np.array(first.ImageOrientationPatient[3:], float)
    normal = np.cross(rows, columns)
    for one in slices:
        same = np.allclose(one.ImageOrientationPatient, first.ImageOrientationPatient, atol=1e-4)
        if not same or (one.Rows, one.Columns) != (first.Rows, first.Columns) or not np.allclose(one.PixelSpacing, first.PixelSpacing):
            raise FormatError("slices differ in size, spacing or orientation")
    slices.sort(key=lambda s: float(np.dot(s.ImagePositionPatient, normal)))
    at = np.array([float(np.dot(s.ImagePositionPatient, normal)) for s in slices])
    step = float(np.diff(at).mean()) if len(at) > 1 else float(getattr(first, "SliceThickness", 1.0) or 1.0)
    if len(at) > 1 and (step <= 0 or (np.abs(np.diff(at) - step) > 0.01 * step).any()):
        raise FormatError(f"slices are not evenly spaced: steps from {np.diff(at).min():g} to {np.diff(at).max():g} mm")
    for one in slices[1:]:  # a gantry's tilt moves slices sideways
        moved = np.array(one.ImagePositionPatient, float) - np.array(slices[0].ImagePositionPatient, float)
        if np.abs(moved - normal * (moved @ normal)).max() > 0.01 * min(map(float, first.PixelSpacing)):
            raise UnsupportedError("slices are shifted against each other (a tilted gantry); resample the series first")
    values = np.stack([_values(s, np) for s in slices])  # [slice, row, column]
    between_rows, between_columns = map(float, first.PixelSpacing)
    axes = [(normal, step), (columns, between_rows), (rows, between_columns)]
    return _placed(values, axes, np.array(slices[0].ImagePositionPatient, float))


def _frames(data: Any) -> list[Any]:
    """The frames of an enhanced picture as slices: what all have in common stands in one group, what is its own in the frame's."""
    shared = data.SharedFunctionalGroupsSequence[0] if getattr(data, "SharedFunctionalGroupsSequence", None) else {}
    pixels, slices = data.pixel_array, []
    pixels = pixels[None] if pixels.ndim == 2 else pixels
    for values, own in zip(pixels, data.PerFrameFunctionalGroupsSequence):
        def group(name: str, own: Any = own) -> Any:
            found = next((where[name].value[0] for where in (own, shared) if name in where and where[name].value), None)
            if found is None and name != "PixelValueTransformationSequence":
                raise UnsupportedError(f"frames without {name}: their places are not said")
            return found

        measures, shift = group("PixelMeasuresSequence"), group("PixelValueTransformationSequence")
        slices.append(SimpleNamespace(
            SeriesInstanceUID=data.SeriesInstanceUID, SeriesDescription=getattr(data, "SeriesDescription", None), Rows=data.Rows, Columns=data.Columns,
            ImagePositionPatient=group("PlanePositionSequence").ImagePositionPatient, PixelSpacing=measures.PixelSpacing,
            ImageOrientationPatient=group("PlaneOrientationSequence").ImageOrientationPatient, SliceThickness=getattr(measures, "SliceThickness", None),
            RescaleSlope=getattr(shift, "RescaleSlope", 1), RescaleIntercept=getattr(shift, "RescaleIntercept", 0), pixel_array=values))
    return slices


def _values(one: Any, np: Any) -> Any:
    values = one.pixel_array
    slope, intercept = float(getattr(one, "RescaleSlope", 1) or 1), float(getattr(one, "RescaleIntercept", 0) or 0)
    if values.ndim != 2:
        raise UnsupportedError("color pictures, and frames without a place of their own, are not a volume of numbers")
    if slope == 1.0 and intercept.is_integer() and abs(intercept) < 2**30 and values.dtype.itemsize <= 2:
        whole = values.astype(np.int32) + int(intercept)
        small = not whole.size or (int(whole.min()) >= -(2**15) and int(whole.max()) < 2**15)
        return whole.astype(np.int16) if small else whole
    return values if slope == 1.0 and intercept == 0.0 else values * slope + intercept


def _placed(values: Any, axes: Sequence[tuple[Any, float]], center: Any) -> Volume:
    """Turn [slice, row, column] so that axes run along +x, +y, +z of the patient."""
    np = arrays.numpy("DICOM")
    order, spacing = [-1, -1, -1], [0.0, 0.0, 0.0]
    if any(abs(np.abs(direction).max() - 1.0) > 1e-4 for direction, _ in axes):  # oblique: as it lies
        turn, steps = np.stack([direction for direction, _ in axes[::-1]], axis=1), [step for _, step in axes[::-1]]
        return Volume(values, order="zyx", spacing=steps, center0=center, direction=turn, frame="lps")
    for i, (direction, step) in enumerate(axes):
        axis = int(np.abs(direction).argmax())
        order[axis], spacing[axis] = i, step
        if direction[axis] < 0:
            values = np.flip(values, i)
            center = center + direction * step * (values.shape[i] - 1)
    corner = [c - 0.5 * s for c, s in zip(center, spacing)]
    return Volume(values.transpose(order), spacing=spacing, corner=corner, frame="lps")


def is_picture(path: str | os.PathLike[str]) -> bool:
    """Whether a DICOM file holds a picture, not contours."""
    pydicom = need("pydicom", "medical")
    with reading(path, "pydicom"):
        return "Rows" in pydicom.dcmread(io.BytesIO(read_bytes(path)), stop_before_pixels=True)


def read_rtstruct(path: str | os.PathLike[str], *, names: Sequence[str] | None = None, tolerance: float = 0.01) -> Sections:
    """Contours of structures from a DICOM RTSTRUCT file, in the patient's millimeters.

    Parameters
    ----------
    path
        the file.
    names
        only these structures; a name that is not there is an error.
    tolerance
        how far points may lie off their plane [mm].

    Returns
    -------
    Sections
        `Sections` whose loops carry the structures' names as labels, in planes of any direction. Points and open lines are left out. Contours that reach
        their holes by a line there and back ("keyholes") become an outer and an inner loop.

    Raises
    ------
    FormatError
        the file is not an RTSTRUCT, or has no structure of a name.
    EmptyError
        no closed contour of these structures.
    ArgumentError
        a contour that does not lie in a plane.

    Examples
    --------
    >>> bitvox.formats.write_rtstruct(bitvox.slice_mesh('knot.ply', spacing=0.2), 'r.dcm')
    >>> bitvox.formats.read_rtstruct('r.dcm').labels
    ['1']
    """
    pydicom = need("pydicom", "medical")
    with reading(path, "pydicom"):
        return _structures(pydicom.dcmread(io.BytesIO(read_bytes(path))), path, names, tolerance)  # .gz too


def _structures(data: Any, path: Any, names: Sequence[str] | None, tolerance: float) -> Sections:
    """The loops of a dataset."""
    np = arrays.numpy("DICOM")
    if "ROIContourSequence" not in data or "StructureSetROISequence" not in data:
        raise FormatError(f"{os.fspath(path)} is not an RTSTRUCT: it has no contours")
    called = {int(roi.ROINumber): str(roi.ROIName) for roi in data.StructureSetROISequence}
    missing = set(names or ()) - set(called.values())
    if missing:
        raise FormatError(f"{os.fspath(path)} has no structure named {', '.join(sorted(missing))}; there are: {', '.join(called.values())}")
    loops = []
    for roi in data.ROIContourSequence:
        name = called.get(int(roi.ReferencedROINumber), "")
        if names is not None and name not in names:
            continue
        for contour in getattr(roi, "ContourSequence", []):
            if str(contour.ContourGeometricType).upper() in ("CLOSED_PLANAR", "CLOSEDPLANAR_XOR"):
                points = np.array(contour.ContourData, float).reshape(-1, 3)
                loops += [Loop(part, name) for part in _without_bridges(points, np)]
    if not loops:
        raise EmptyError(f"{os.fspath(path)} has no closed contour of these structures")
    return stacked(loops, _normal_of(loops, np), tolerance)


def _without_bridges(points: Any, np: Any) -> list[Any]:
    """A contour as loops: what it runs along in both directions is left out, and what is left falls apart there."""
    points = points[(points != np.roll(points, -1, axis=0)).any(axis=1)]  # a last point that repeats the first, and others
    corners, number = np.unique(points, axis=0, return_inverse=True)
    walk = number.reshape(-1).tolist()
    if len(corners) == len(walk):
        return [points] if len(points) >= 3 else []
    steps = list(zip(walk, walk[1:] + walk[:1]))
    bridges = set(steps) & {(b, a) for a, b in steps}
    after: dict[int, list[int]] = {}
    for a, b in steps:
        if (a, b) not in bridges:
            after.setdefault(a, []).append(b)
    parts = []
    while after:
        part, at = [], next(iter(after))
        while at in after:  # as many steps lead to a corner as away from it, so this ends where it began
            part.append(at)
            follows = after[at]
            at = follows.pop(0)
            if not follows:
                del after[part[-1]]
        parts.append(corners[part])
    return [part for part in parts if len(part) >= 3]


def _normal_of(loops: list[Loop], np: Any) -> Any:
    """Across the largest loop, by its area vector, pointing to the positive side of its main axis."""
    areas = [np.cross(loop.points, np.roll(loop.points, -1, axis=0)).sum(0) for loop in loops]
    best = max(areas, key=lambda a: float(a @ a))
    best = best / (np.sqrt(best @ best) or 1.0)
    main = int(np.abs(best).argmax())
    if abs(best[main]) > 1.0 - 1e-6:
        best = np.eye(3)[main]
    return best if best[main] > 0 else -best
