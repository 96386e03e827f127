"""Volumes written with their place and directions (NRRD, MetaImage, NIfTI, VTI), and read through SimpleITK, tifffile and PyVista."""

from __future__ import annotations

import gzip
import os
import re
import tempfile
import warnings
import zlib
from typing import Any

from .. import _arrays as arrays
from .._bytes import read_bytes, write_bytes
from .._errors import FormatError, UnsupportedError, need, reading
from .._foreign import affine_of
from .._grid import Grid
from .._nrrd import unpacked
from .._run import depth_of_caller
from .._volume import Volume
from .nifti import GRID_MARK

BY_SIMPLEITK = ("mha", "mhd", "gipl", "hdr", "img", "mgz", "mgh", "nhdr", "nrrd")
_INR_TYPES = {("unsigned fixed", 8): "u1", ("unsigned fixed", 16): "u2", ("unsigned fixed", 32): "u4", ("signed fixed", 8): "i1",
              ("signed fixed", 16): "i2", ("signed fixed", 32): "i4", ("float", 32): "f4", ("float", 64): "f8"}
_NRRD_TYPES = {"u1": "uint8", "i1": "int8", "u2": "uint16", "i2": "int16", "u4": "uint32", "i4": "int32", "u8": "uint64", "i8": "int64",
               "f4": "float", "f8": "double"}
_META_TYPES = {"u1": "MET_UCHAR", "i1": "MET_CHAR", "u2": "MET_USHORT", "i2": "MET_SHORT", "u4": "MET_UINT", "i4": "MET_INT",
               "u8": "MET_ULONG_LONG", "i8": "MET_LONG_LONG", "f4": "MET_FLOAT", "f8": "MET_DOUBLE"}
_SPACES = {"lps": "left-posterior-superior", "ras": "right-anterior-superior"}


def volume_bytes(volume: Volume, kind: str, of_grid: bool = False) -> bytes:
    """The bytes of a file that holds a ``volume``: ``kind`` is nrrd, mha, nii or vti; ``of_grid``: its samples are those of a grid, which NIfTI and MetaImage say.

    What a volume's frame is stands in the file. NIfTI is always in "ras" and MetaImage in "lps": positions of the other one are turned;
    where the frame is not said they are written as they are.
    """
    np = arrays.numpy("volumes")
    if volume.segments and kind in ("nii", "mha", "vti"):
        warnings.warn(f".{kind} does not keep names and colors of labels; .nrrd does", stacklevel=depth_of_caller())
    if kind == "nii":
        return _nifti(volume if volume.frame is None else volume.turned("ras"), of_grid)
    if kind == "mha" and volume.frame is not None:
        volume = volume.turned("lps")
    packed = np.ascontiguousarray(volume.to_numpy("zyx"))
    packed = packed.astype(packed.dtype.newbyteorder("<"), copy=False)
    code, steps = packed.dtype.str[1:], affine_of(volume)
    if kind == "mha":
        head = {"ObjectType": "Image", "NDims": 3, "BinaryData": True, "BinaryDataByteOrderMSB": False, "CompressedData": True}
        head |= {"Comment": GRID_MARK.decode()} if of_grid else {}
        data = zlib.compress(packed.tobytes(), 6)
        head |= {"CompressedDataSize": len(data), "TransformMatrix": _words(volume.direction.T.ravel()), "Offset": _words(volume.center0),
                 "CenterOfRotation": "0 0 0", "ElementSpacing": _words(volume.spacing), "DimSize": _words(volume.shape),
                 "ElementType": _META_TYPES[code], "ElementDataFile": "LOCAL"}
        return "".join(f"{name} = {value}\n" for name, value in head.items()).encode() + data
    if kind == "vti":
        return _vti(volume, packed)
    if kind != "nrrd":
        raise UnsupportedError(f"Volume is not written as {kind!r}; take one of nrrd, mha, nii, vti, or numpy.save(path, volume.array) without its place")
    vectors = " ".join("(" + ",".join(map(_number, steps[:3, i])) + ")" for i in range(3))
    space = [f"space: {_SPACES[volume.frame]}"] if volume.frame else ["space dimension: 3"]
    lines = ["NRRD0005", f"type: {_NRRD_TYPES[code]}", "dimension: 3", *space, f"sizes: {_words(volume.shape)}",
             f"space directions: {vectors}", "kinds: domain domain domain", "endian: little", "encoding: gzip",
             "space origin: (" + ",".join(map(_number, volume.center0)) + ")"]
    for i, (value, one) in enumerate(volume.segments.items()):  # as 3D Slicer has them
        lines += [f"Segment{i}_ID:=Segment_{value}", f"Segment{i}_LabelValue:={value}", f"Segment{i}_Name:={' '.join(one.name.split())}"]
        lines += [f"Segment{i}_Color:={_words(part / 255 for part in one.color)}"] if one.color else []
    return ("\n".join(lines) + "\n\n").encode() + gzip.compress(packed.tobytes(), 6, mtime=0)


def _vti(volume: Volume, packed: Any) -> bytes:
    """VTK's image: samples are its points, under the name "samples"."""
    name = {"u": "UInt", "i": "Int", "f": "Float"}[packed.dtype.kind] + str(8 * packed.dtype.itemsize)
    extent = " ".join(f"0 {n - 1}" for n in volume.shape)
    turn = "" if (volume.direction == arrays.numpy("volumes").eye(3)).all() else f' Direction="{_words(volume.direction.ravel())}"'
    head = f"""<?xml version="1.0"?>
<VTKFile type="ImageData" version="1.0" byte_order="LittleEndian" header_type="UInt64">
<ImageData WholeExtent="{extent}" Origin="{_words(volume.center0)}" Spacing="{_words(volume.spacing)}"{turn}>
<Piece Extent="{extent}"><PointData Scalars="samples"><DataArray type="{name}" Name="samples" format="appended" offset="0"/></PointData></Piece>
</ImageData>
<AppendedData encoding="raw">_"""
    data = packed.tobytes()
    return head.encode() + len(data).to_bytes(8, "little") + data + b"\n</AppendedData>\n</VTKFile>\n"


def _number(value: Any) -> str:
    return repr(float(value)) if not float(value).is_integer() else str(int(value))


def _words(values: Any) -> str:
    return " ".join(map(_number, values))


def _nifti(volume: Volume, of_grid: bool) -> bytes:
    np, nibabel = arrays.numpy("NIfTI"), need("nibabel", "medical")
    affine = affine_of(volume)
    wide = volume.array.dtype.kind in "iu" and volume.array.dtype.itemsize == 8
    image = nibabel.Nifti1Image(np.asarray(volume.array), affine, dtype=volume.array.dtype if wide else None)
    image.header.set_xyzt_units("mm")
    if of_grid:
        image.header["descrip"] = GRID_MARK
    image.set_qform(affine, 1)
    image.set_sform(affine, 1)
    made: bytes = image.to_bytes()
    return made


def read_by_library(path: str, kind: str) -> Volume:
    """A volume of a file that the library does not read itself: by SimpleITK (MetaImage, NRRD of any kind, GIPL, Analyze, MGZ), by
    tifffile (TIFF, OME-TIFF) or by PyVista (VTK's)."""
    if not os.path.isfile(path):
        raise FileNotFoundError(path)
    if kind == "inr":
        return _inr(path)
    if kind in ("tif", "tiff"):
        return _tiff(path)
    if kind in ("mhd", "mha", "nrrd", "nhdr"):
        with open(path, "rb") as file:
            named = re.findall(rb"^(?:data ?file:|ElementDataFile *=) *(.*)$", file.read(1 << 16), flags=re.M)
        if any(os.path.isabs(name) or b".." in name.replace(b"\\", b"/").split(b"/") for name in named):
            raise FormatError(f"{path}: its samples are said to be in another folder; only files in its own folder or below are read")
    if kind == "nrrd" or (kind in BY_SIMPLEITK and path.lower().endswith(".gz")):
        data = read_bytes(path)
        plain = unpacked(data) if kind == "nrrd" else data
        if plain is not data or path.lower().endswith(".gz"):  # SimpleITK has no bzip2, takes .gz of few formats, and reads files only
            with tempfile.TemporaryDirectory(prefix="bitvox-") as folder:
                write_bytes(beside := os.path.join(folder, f"volume.{kind}"), plain)
                return _by_simpleitk(beside, path)
    if kind in BY_SIMPLEITK:
        return _by_simpleitk(path, path)
    pyvista = need("pyvista", "view")
    with reading(path, "PyVista"):
        image = pyvista.read(path)
    return Volume.of(image)


def _by_simpleitk(path: str, name: str) -> Volume:
    """The volume of a file, which messages call ``name``."""
    sitk = need("SimpleITK", "medical")
    try:
        image = sitk.ReadImage(path)
    except RuntimeError as why:
        raise FormatError(f"{name}: SimpleITK cannot read it: {str(why).strip().splitlines()[-1]}") from why
    if image.GetDimension() == 3 and image.GetNumberOfComponentsPerPixel() > 1 and any(key.startswith("Segment0_") for key in image.GetMetaDataKeys()):
        raise UnsupportedError(f"{name}: a segmentation in {image.GetNumberOfComponentsPerPixel()} layers; bitvox.formats.read_segmentation gives a "
                               "volume of each segment")
    return Volume.of(image)


def grid_of_meta(path: str) -> Grid:
    """The grid of a MetaImage that was written of one, which its comment says; others are refused as `read` of a NIfTI mask is."""
    np = arrays.numpy("MetaImage")
    with open(path, "rb") as file:
        begin = file.read(1 << 12)
    volume = read_by_library(path, "mha")  # refuses what is damaged
    head = zlib.decompressobj(31).decompress(begin) if begin[:2] == b"\x1f\x8b" else begin
    if b"Comment = " + GRID_MARK not in head or volume.array.dtype != np.uint8 or volume.array.max(initial=0) > 1 or (volume.direction != np.eye(3)).any():
        raise UnsupportedError(f"{path}: was not written of a Grid, so which values are inside is not said; bitvox.read_volume(path) gives a Volume, whose "
                               "threshold makes a Grid")
    return Grid.from_numpy(volume.array, spacing=volume.spacing, center0=volume.center0)


def array_of_npz(path: str) -> Any:
    """The one array with three axes of a file of numpy's ``savez``."""
    np = arrays.numpy("npz")
    with reading(path, "numpy"), np.load(path) as held:
        found = {name: held[name] for name in held.files if held[name].ndim == 3}
    if len(found) != 1:
        names = f" ({', '.join(found)})" if found else ""
        raise UnsupportedError(f"{path} holds {len(found)} arrays with three axes{names}; give Volume(numpy.load(path)[name]) one of them")
    return next(iter(found.values()))


def _inr(path: str) -> Volume:
    """INRIMAGE: a head of 256 bytes, or a multiple, then the samples, x fastest."""
    np = arrays.numpy("inr")
    data = read_bytes(path)
    end = data.find(b"##}")
    told = dict(re.findall(rb"^(\w+) *= *(.*?) *$", data[:max(end, 0)], flags=re.M))
    try:
        sides = [int(told[name]) for name in (b"XDIM", b"YDIM", b"ZDIM")]
        steps = [float(told.get(name, b"1")) for name in (b"VX", b"VY", b"VZ")]
        first = [float(told.get(name, b"0")) for name in (b"TX", b"TY", b"TZ")]
        bits = int(told[b"PIXSIZE"].split()[0])
        code, many = _INR_TYPES.get((told[b"TYPE"].decode("ascii", "replace"), bits)), int(told.get(b"VDIM", b"1"))
    except (KeyError, ValueError, IndexError) as why:
        raise FormatError(f"{path}: not a head of INRIMAGE: {why}") from why
    if code is None or many != 1:
        raise UnsupportedError(f"{path}: {many} numbers a sample of type {told[b'TYPE'].decode('ascii', 'replace')} with {bits} bits")
    start, count = -(-(end + 3) // 256) * 256, sides[0] * sides[1] * sides[2]
    if end < 0 or min(sides) < 1 or len(data) < start + count * bits // 8:
        raise FormatError(f"{path}: {len(data)} bytes, but its head wants {start} and {sides[0]} x {sides[1]} x {sides[2]} samples of {bits} bits")
    big = told.get(b"CPU", b"decm") in (b"sun", b"sgi")
    array = np.frombuffer(data, (">" if big else "<") + code, count, start).reshape(sides[::-1])
    return Volume(array, order="zyx", spacing=steps, center0=first)


def _tiff(path: str) -> Volume:
    """A stack of gray pictures, the first lowest in z, with the spacing that stands in the file (OME's, ImageJ's, or pixels by
    centimeter or inch, which become millimeters); rows run along y as they stand in the file."""
    np, tifffile = arrays.numpy("tiff"), need("tifffile", "medical")
    with reading(path, "tifffile"), tifffile.TiffFile(path) as file:
        series = file.series[0]
        axes, values = list(series.axes), series.asarray()
        for i in reversed(range(values.ndim)):
            if values.shape[i] == 1 and axes[i] not in "ZYX" and values.ndim > 3:
                values, axes = values.squeeze(i), axes[:i] + axes[i + 1 :]
        steps = _tiff_steps(file)
    if values.ndim == 2 and axes == ["Y", "X"]:
        values, axes = values[np.newaxis], ["Z", *axes]
    if values.ndim != 3 or axes[1:] != ["Y", "X"]:
        raise UnsupportedError(f"{path} has axes {''.join(axes)} of {values.shape}; a volume has Z, Y and X: take "
                               "bitvox.Volume(tifffile.imread(path)[...], order='zyx')")
    return Volume(values, order="zyx", spacing=steps, center0=(0.0, 0.0, 0.0))


def _tiff_steps(file: Any) -> list[float]:
    """Distances between samples along x, y, z."""
    if file.is_ome:
        told = dict(re.findall(r'PhysicalSize([XYZ]|[XYZ]Unit)="([^"]*)"', file.ome_metadata))
        units = {told.get(axis + "Unit", "\u00b5m") for axis in "XYZ" if axis in told}
        if len(units) > 1:
            raise ValueError(f"axes in different units: {', '.join(sorted(units))}")
        return [float(told.get(axis, 1.0)) for axis in "XYZ"]
    tags, steps = file.pages[0].tags, [1.0, 1.0, 1.0]
    unit = {2: 25.4, 3: 10.0}.get(int(tags["ResolutionUnit"].value)) if "ResolutionUnit" in tags else None
    imagej = file.imagej_metadata or {}
    if imagej.get("unit") not in (None, "", "pixel"):
        unit = 1.0
    for i, name in enumerate(("XResolution", "YResolution")):
        if name in tags and unit is not None and tags[name].value[0]:
            over, under = tags[name].value
            steps[i] = unit * under / over
    if "spacing" in imagej:
        steps[2] = float(imagej["spacing"])
    return steps
