"""Volumes written with their place and directions (NRRD, MetaImage, NIfTI), and read through SimpleITK and PyVista."""

from __future__ import annotations

import gzip
import os
import re
import zlib
from typing import Any

from .. import _arrays as arrays
from .._errors import FormatError, UnsupportedError, need
from .._foreign import affine_of
from .._volume import Volume

BY_SIMPLEITK = ("mha", "mhd", "gipl", "hdr", "img", "mgz", "mgh", "nhdr", "nrrd", "tif", "tiff")
BY_PYVISTA = ("vtk", "vti", "mhd", "slc")
_NRRD_TYPES = {"u1": "uint8", "i1": "int8", "u2": "uint16", "i2": "int16", "u4": "uint32", "i4": "int32", "u8": "uint64", "i8": "int64",
               "f4": "float", "f8": "double"}
_META_TYPES = {"u1": "MET_UCHAR", "i1": "MET_CHAR", "u2": "MET_USHORT", "i2": "MET_SHORT", "u4": "MET_UINT", "i4": "MET_INT",
               "u8": "MET_ULONG_LONG", "i8": "MET_LONG_LONG", "f4": "MET_FLOAT", "f8": "MET_DOUBLE"}
_SPACES = {"lps": "left-posterior-superior", "ras": "right-anterior-superior"}


def volume_bytes(volume: Volume, kind: str) -> bytes:
    """The bytes of a file that holds a ``volume``: ``kind`` is nrrd, mha or nii.

    What a volume's frame is stands in the file. NIfTI is always in "ras" and MetaImage in "lps": positions of the other one are turned;
    where the frame is not said they are written as they are.
    """
    np = arrays.numpy("volumes")
    if kind == "nii":
        return _nifti(volume if volume.frame is None else volume.turned("ras"))
    if kind == "mha" and volume.frame is not None:
        volume = volume.turned("lps")
    packed = np.ascontiguousarray(volume.to_numpy("zyx"))
    packed = packed.astype(packed.dtype.newbyteorder("<"), copy=False)
    code, steps = packed.dtype.str[1:], affine_of(volume)
    if kind == "mha":
        head = {"ObjectType": "Image", "NDims": 3, "BinaryData": True, "BinaryDataByteOrderMSB": False, "CompressedData": True}
        data = zlib.compress(packed.tobytes(), 6)
        head |= {"CompressedDataSize": len(data), "TransformMatrix": _words(volume.direction.T.ravel()), "Offset": _words(volume.center0),
                 "CenterOfRotation": "0 0 0", "ElementSpacing": _words(volume.spacing), "DimSize": _words(volume.shape),
                 "ElementType": _META_TYPES[code], "ElementDataFile": "LOCAL"}
        return "".join(f"{name} = {value}\n" for name, value in head.items()).encode() + data
    if kind != "nrrd":
        raise UnsupportedError(f"a volume is not written as {kind!r}; take one of nrrd, mha, nii")
    vectors = " ".join("(" + ",".join(map(_number, steps[:3, i])) + ")" for i in range(3))
    space = [f"space: {_SPACES[volume.frame]}"] if volume.frame else ["space dimension: 3"]
    lines = ["NRRD0005", f"type: {_NRRD_TYPES[code]}", "dimension: 3", *space, f"sizes: {_words(volume.shape)}",
             f"space directions: {vectors}", "kinds: domain domain domain", "endian: little", "encoding: gzip",
             "space origin: (" + ",".join(map(_number, volume.center0)) + ")"]
    return ("\n".join(lines) + "\n\n").encode() + gzip.compress(packed.tobytes(), 6, mtime=0)


def _number(value: Any) -> str:
    return repr(float(value)) if not float(value).is_integer() else str(int(value))


def _words(values: Any) -> str:
    return " ".join(map(_number, values))


def _nifti(volume: Volume) -> bytes:
    np, nibabel = arrays.numpy("NIfTI"), need("nibabel", "medical")
    affine = affine_of(volume)
    wide = volume.array.dtype.kind in "iu" and volume.array.dtype.itemsize == 8
    image = nibabel.Nifti1Image(np.asarray(volume.array), affine, dtype=volume.array.dtype if wide else None)
    image.header.set_xyzt_units("mm")
    image.set_qform(affine, 1)
    image.set_sform(affine, 1)
    made: bytes = image.to_bytes()
    return made


def read_by_library(path: str, kind: str) -> Volume:
    """A volume of a file that the library does not read itself: by SimpleITK (MetaImage, NRRD of any kind, GIPL, Analyze, MGZ, TIFF),
    or by PyVista (VTK's)."""
    if not os.path.isfile(path):
        raise FileNotFoundError(path)
    if kind in ("mhd", "mha", "nrrd", "nhdr"):
        with open(path, "rb") as file:
            named = re.findall(rb"^(?:data ?file:|ElementDataFile *=) *(.*)$", file.read(1 << 16), flags=re.M)
        if any(os.path.isabs(name) or b".." in name.replace(b"\\", b"/").split(b"/") for name in named):
            raise FormatError(f"{path}: its samples are said to be in another folder; only files in its own folder or below are read")
    if kind in BY_SIMPLEITK:
        sitk = need("SimpleITK", "medical")
        try:
            return Volume.of(sitk.ReadImage(path))
        except RuntimeError as why:
            raise FormatError(f"{path}: SimpleITK cannot read it: {str(why).strip().splitlines()[-1]}") from why
    return Volume.of(need("pyvista", "view").read(path))
