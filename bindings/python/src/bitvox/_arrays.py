"""Arrays in and out: numpy where it is installed, memoryviews and sequences where it is not.

Coming in, an array is borrowed where the library can read it as it lies in memory, and copied otherwise. Going out, arrays
look at the library's memory, which lives as long as any of them.
"""

from __future__ import annotations

import sys
from array import array as plain_array
from typing import Any

from ._errors import ArgumentError, RangeError, need
from ._run import ffi, in_range, lib

_NUMPY: Any = None
_LOOKED = False
_CODES = {"float32": "f", "float64": "d", "uint8": "B", "int32": "i", "uint32": "I", "uint64": "Q"}
_SIZES = {"float32": 4, "float64": 8, "uint8": 1, "int32": 4, "uint32": 4, "uint64": 8}


def numpy_or_none() -> Any:
    """numpy, imported when it is first needed."""
    global _NUMPY, _LOOKED
    if not _LOOKED:
        try:
            import numpy

            _NUMPY = numpy
        except ImportError:
            _NUMPY = None
        _LOOKED = True
    return _NUMPY


def numpy(what: str) -> Any:
    """numpy, or an error that says what needs it."""
    found = numpy_or_none()
    if found is None:
        need("numpy", "big", "numpy")
        raise ImportError(f"{what} needs numpy")
    return found


# ---- out ----


def memory(pointer: Any, size: int, owner: Any) -> Any:
    """size bytes at pointer, which keep owner alive."""
    if size == 0:
        return memoryview(bytearray())
    return memoryview(ffi.buffer(ffi.gc(ffi.cast("char *", pointer), lambda _, owner=owner: None), size))


def array_at(pointer: Any, dtype: str, shape: tuple[int, ...], owner: Any, writable: bool = False) -> Any:
    """The library's memory as an array of a shape (numpy), or as a memoryview of it (without numpy)."""
    size = _SIZES[dtype]
    for n in shape:
        size *= n
    view = memory(pointer, size, owner)
    if not writable:
        view = view.toreadonly()
    np = numpy_or_none()
    if np is not None:
        return np.frombuffer(view, dtype).reshape(shape) if size else np.zeros(shape, dtype)
    if size == 0:
        return view.cast("B").cast(_CODES[dtype])
    return view.cast("B").cast(_CODES[dtype], list(shape))


def records_at(pointer: Any, kind: str, count: int, owner: Any) -> Any:
    """An array of C structs as a numpy record array that shares its memory."""
    np = numpy("this")
    size = ffi.sizeof(kind)
    view = memory(pointer, size * count, owner)
    return np.frombuffer(view, record_type(kind)) if count else np.zeros(0, record_type(kind))


_RECORDS: dict[str, Any] = {}
_SCALARS = {"double": "f8", "float": "f4", "int32_t": "i4", "uint32_t": "u4", "int64_t": "i8", "uint64_t": "u8", "uint8_t": "u1"}


def record_type(kind: str) -> Any:
    """The numpy type of a C struct, with its offsets; fields named reserved are left out."""
    if kind not in _RECORDS:
        names, formats, offsets = [], [], []
        for name, field in ffi.typeof(kind).fields:
            if name.startswith("reserved"):
                continue
            names.append(name)
            offsets.append(field.offset)
            formats.append(_format_of(field.type))
        np = numpy("this")
        _RECORDS[kind] = np.dtype({"names": names, "formats": formats, "offsets": offsets, "itemsize": ffi.sizeof(kind)})
    return _RECORDS[kind]


def _format_of(ctype: Any) -> Any:
    if ctype.kind == "array":
        return (_format_of(ctype.item), (ctype.length,))
    if ctype.kind == "struct":
        return record_type(ctype.cname.removeprefix("struct "))
    return _SCALARS[ctype.cname]


def plain(value: Any) -> Any:
    """A value of a C struct's field as one of Python: numbers, tuples."""
    if isinstance(value, ffi.CData):
        return tuple(plain(value[i]) for i in range(len(value)))
    return value


def handed(array: Any, dtype: Any = None, copy: Any = None) -> Any:
    """What ``__array__`` of something that holds an array gives: that array itself where the type is its own and no copy is wanted."""
    wanted = array if dtype is None else array.astype(dtype, copy=False)
    if copy is False and wanted is not array:
        raise ValueError(f"an array of {dtype} is a copy")
    return wanted.copy() if copy and wanted is array else wanted


# ---- in ----


class Borrowed:
    """Numbers for the library: an address, rows, bytes from row to row, the library's type, and what keeps them alive."""

    __slots__ = ("pointer", "count", "stride", "kind", "keep", "signed")

    def __init__(self, pointer: Any, count: int, stride: int, kind: int, keep: Any, signed: bool = False) -> None:
        self.pointer, self.count, self.stride, self.kind, self.keep, self.signed = pointer, count, stride, kind, keep, signed


def address(array: Any) -> Any:
    """Where a numpy array or a buffer begins."""
    interface = getattr(array, "__array_interface__", None)
    if interface is not None:
        return ffi.cast("void *", interface["data"][0])
    return ffi.cast("void *", ffi.from_buffer(array)) if len(array) else ffi.NULL


def _refuse_type(what: str, dtype: Any, wanted: str) -> None:
    raise TypeError(f"{what} must be {wanted}, not {dtype}")


def as_numpy(values: Any, what: str) -> Any:
    """A numpy array of what was given, without masked, complex or object values."""
    np = numpy_or_none()
    if isinstance(values, np.ndarray) and type(values) is not np.ma.MaskedArray:
        found = values
    else:
        if isinstance(values, np.ma.MaskedArray):
            if np.ma.is_masked(values):
                raise ArgumentError(f"{what}: masked values are not supported")
        try:
            found = np.asarray(values)
        except ValueError as why:
            raise ArgumentError(f"{what}: rows of different lengths ({why})") from None
    if found.dtype.kind not in "iufb":
        sides = {len(row) if hasattr(row, "__len__") else 0 for row in found.ravel()} if found.dtype.kind == "O" else set()
        if len(sides) > 1:  # what numpy before 1.24 makes of such rows
            raise ArgumentError(f"{what}: rows of different lengths ({', '.join(map(str, sorted(sides)))})")
        _refuse_type(what, found.dtype, "numbers")
    return found


def exact_floats(array: Any, what: str) -> Any:
    """Real numbers as float32 or float64, native; integers that float64 does not hold are refused."""
    np = numpy_or_none()
    kind, size = array.dtype.kind, array.dtype.itemsize
    if kind == "b":
        _refuse_type(what, "bool", "numbers")
    if kind == "f" and size in (4, 8):
        return array if array.dtype.isnative else array.astype(array.dtype.newbyteorder("="))
    if kind in "iu" and size == 8 and array.size and (int(array.max()) > 2**53 or int(array.min()) < -(2**53)):
        raise RangeError(f"{what}: integers beyond 2**53 cannot be distinguished as float64")
    return array.astype(np.float64)


def vertices_in(values: Any, what: str = "vertices") -> Any:
    """Vertices as an array (n, 3) of float32 or float64 whose rows the library can walk."""
    if numpy_or_none() is None:
        return _rows_without_numpy(values, "vertices", "d")
    found = as_numpy(values, what)
    if found.size == 0:
        found = found.reshape(0, 3)
    if found.ndim != 2 or found.shape[1] != 3:
        raise ArgumentError(f"{what} have shape {found.shape}; they must be (n, 3)")
    found = exact_floats(found, what)
    return found if _walkable(found) else found.copy(order="C")


def _walkable(array: Any) -> bool:
    size = array.itemsize
    row, column = array.strides
    return column == size and (len(array) < 2 or 3 * size <= row < 2**32)


def faces_in(values: Any, vertex_count: int) -> Any:
    """Faces as an array (m, 3) of integers whose rows the library can walk; negative ones are refused here or later."""
    if numpy_or_none() is None:
        return _rows_without_numpy(values, "faces", "Q")
    found = as_numpy(values, "faces")
    if found.size == 0:
        found = found.reshape(0, 3).astype("uint32")
    if found.ndim != 2 or found.shape[1] != 3:
        raise ArgumentError(f"faces have shape {found.shape}; they must be (m, 3): triangles")
    kind, size = found.dtype.kind, found.dtype.itemsize
    if kind not in "iu":
        _refuse_type("faces", found.dtype, "integers")
    if not found.dtype.isnative:
        found = found.astype(found.dtype.newbyteorder("="))
    # Read as unsigned, a negative number is beyond every vertex, unless the type is short or the vertices are many.
    if kind == "i" and (size < 4 or vertex_count > 2**31):
        refuse_negative(found)
    if size == 1 or (kind == "i" and size == 2):
        found = found.astype("uint32")
    return found if _walkable(found) else found.copy(order="C")


def refuse_negative(faces: Any) -> None:
    """Name the first vertex index below 0."""
    np = numpy_or_none()
    if np is None or faces is None or not len(faces) or faces.dtype.kind != "i" or faces.min() >= 0:
        return
    row, column = np.argwhere(faces < 0)[0]
    raise RangeError(f"faces[{row}, {column}] is {faces[row, column]}: vertex indices start at 0")


def colors_in(values: Any, count: int) -> Any:
    """Colors as (n, 4) uint8, packed; (n, 3) gets alpha 255; floats are taken from 0..1."""
    if values is None:
        return None
    np = numpy("colors")
    found = as_numpy(values, "colors")
    if found.ndim != 2 or found.shape[0] != count or found.shape[1] not in (3, 4):
        raise ArgumentError(f"colors have shape {found.shape}; they must be ({count}, 3) or ({count}, 4)")
    if found.dtype.kind == "f":
        if found.size and not (found.min() >= 0 and found.max() <= 1):
            raise RangeError("colors given as floats lie between 0 and 1")
        found = np.floor(found * 255.0 + 0.5)
    elif found.size and not (found.min() >= 0 and found.max() <= 255):
        raise RangeError("colors given as integers lie between 0 and 255")
    out = np.full((count, 4), 255, np.uint8)
    out[:, : found.shape[1]] = found
    return out


def floats_in(name: str, values: Any, count: int, columns: int) -> Any:
    """Attributes of vertices as (n, columns) float32, packed."""
    if values is None:
        return None
    found = numpy(name).ascontiguousarray(as_numpy(values, name), "float32")
    if found.shape != (count, columns):
        raise ArgumentError(f"{name} have shape {found.shape}; they must be ({count}, {columns})")
    return found


def materials_in(values: Any, count: int) -> Any:
    """Indices of materials as (m,) uint32."""
    if values is None:
        return None
    np = numpy("materials")
    found = as_numpy(values, "materials")
    if found.shape != (count,) or (found.dtype.kind not in "iu" and found.size):
        raise ArgumentError(f"materials are {found.dtype} of shape {found.shape}; they must be ({count},) integers")
    if found.size and not (found.min() >= 0 and found.max() < 2**32):
        raise RangeError("materials lie between 0 and 2**32 - 1")
    return np.ascontiguousarray(found, np.uint32)


def borrow_vertices(array: Any) -> Borrowed:
    """A view of what vertices_in made."""
    if isinstance(array, memoryview):
        kind = lib.BVX_F32 if array.format == "f" else lib.BVX_F64
        return Borrowed(address(array), len(array) if array.ndim > 1 else 0, 0, kind, array)
    kind = lib.BVX_F32 if array.itemsize == 4 else lib.BVX_F64
    return Borrowed(address(array), len(array), array.strides[0] if len(array) > 1 else 0, kind, array)


def borrow_faces(array: Any) -> Borrowed:
    """A view of what faces_in made."""
    kinds = {2: lib.BVX_U16, 4: lib.BVX_U32, 8: lib.BVX_U64}
    if isinstance(array, memoryview):
        return Borrowed(address(array), len(array) if array.ndim > 1 else 0, 0, kinds[array.itemsize], array)
    stride = array.strides[0] if len(array) > 1 else 0
    return Borrowed(address(array), len(array), stride, kinds[array.itemsize], array, array.dtype.kind == "i")


def numbers_in(values: Any, what: str, columns: int, dtype: str = "float64") -> Borrowed:
    """Rows of this many numbers, packed: points (3), rays (6), voxels (3, int32)."""
    np = numpy_or_none()
    kind = lib.BVX_F64
    if np is None:
        view = _rows_without_numpy(values, what, _CODES[dtype], columns)
        return Borrowed(address(view), len(view) if view.ndim > 1 else 0, 0, kind, view)
    found = as_numpy(values, what)
    if found.size == 0:
        found = found.reshape(0, columns)
    if found.ndim == 1 and found.shape[0] == columns:
        found = found.reshape(1, columns)
    if found.ndim != 2 or found.shape[1] != columns:
        raise ArgumentError(f"{what} have shape {found.shape}; they must be (n, {columns})")
    if dtype == "int32":
        if found.dtype.kind not in "iu":
            if found.size:
                _refuse_type(what, found.dtype, "integers")
            found = found.astype("int32")
        if found.size and not (int(found.min()) >= -(2**31) and int(found.max()) < 2**31):
            raise RangeError(f"{what}: a number does not fit 32 bits")
        packed = np.ascontiguousarray(found, np.int32)
    else:
        packed = np.ascontiguousarray(exact_floats(found, what), np.float64)
    return Borrowed(address(packed), len(packed), 0, kind, packed)


def _rows_without_numpy(values: Any, what: str, code: str, columns: int = 3) -> Any:
    """Rows from a two-dimensional buffer of the right type, or from nested sequences."""
    view: Any = None
    try:
        view = memoryview(values)
    except TypeError:
        pass
    if view is not None and view.ndim == 2 and view.c_contiguous and view.shape[1] == columns:
        if view.format.lstrip("@=") == code or (what == "vertices" and view.format in "fd") or (what == "faces" and view.format in "HIQ"):
            return view
    flat: Any = plain_array(code)
    rows = 0
    for i, row in enumerate(values.tolist() if view is not None else values):
        row = list(row)
        if len(row) != columns:
            raise ArgumentError(f"{what}[{i}] has {len(row)} numbers; it must have {columns}")
        for j, x in enumerate(row):
            if code == "Q" and isinstance(x, int) and x < 0:
                raise RangeError(f"{what}[{i}, {j}] is {x}: vertex indices start at 0")
        try:
            flat.extend(row)
        except OverflowError:
            raise RangeError(f"{what}[{i}]: a number does not fit") from None
        rows += 1
    made: Any = memoryview(flat)
    return made.cast("B").cast(code, [rows, columns]) if rows else made


def direction(name: str, values: Any) -> tuple[float, float, float]:
    """Three numbers of which one is not 0."""
    found = triple(name, values)
    if not any(found):
        raise ArgumentError(f"{name} is 0, 0, 0 and points nowhere")
    return found


def triple(name: str, values: Any, kind: type = float) -> tuple[Any, Any, Any]:
    """Three numbers, from a sequence of them or from one for all."""
    if isinstance(values, (int, float)) and not isinstance(values, bool):
        return (kind(values),) * 3
    if isinstance(values, (str, bytes)):
        raise TypeError(f"{name} must be three numbers, not {values!r}")
    try:
        found = tuple(values)
    except TypeError:
        if hasattr(values, "__float__"):
            return (kind(values),) * 3
        raise TypeError(f"{name} must be three numbers, not {values!r}") from None
    if len(found) != 3:
        raise ArgumentError(f"{name} has {len(found)} numbers; it must have 3")
    if kind is int:
        return tuple(in_range(name, x, -(2**31), 2**31 - 1) for x in found)  # type: ignore[return-value]
    return tuple(float(x) for x in found)  # type: ignore[return-value]


def matrix_in(matrix: Any) -> Any:
    """Four by four numbers of an affine transform, which may be given without its shift."""
    np = numpy("transform")
    found = np.array(as_numpy(matrix, "matrix"), np.float64)
    if found.shape == (3, 3):
        full = np.eye(4)
        full[:3, :3] = found
        found = full
    if found.shape != (4, 4):
        raise ArgumentError(f"matrix has shape {found.shape}; it must be (3, 3) or (4, 4)")
    if not np.isfinite(found).all() or found[3].tolist() != [0.0, 0.0, 0.0, 1.0]:
        raise ArgumentError(f"matrix: the last row is {found[3].tolist()}; it must be 0 0 0 1, and all numbers finite")
    if np.linalg.matrix_rank(found[:3, :3]) < 3:
        raise ArgumentError("matrix: it flattens, so nothing of volume would be left")
    return found


def moved_by(matrix: Any, points: Any) -> Any:
    """Points (n, 3) after an affine transform, or a 3 x 3 one: sums in one order, since matrix products of libraries round as the machine likes."""
    np = numpy("transform")
    x, y, z = np.asarray(points, np.float64).T
    return np.stack([row[0] * x + row[1] * y + row[2] * z + (row[3] if len(row) > 3 else 0.0) for row in matrix[:3]], axis=1)


LITTLE = sys.byteorder == "little"
