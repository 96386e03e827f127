"""Scalar volumes: CT, MRI, fields and label maps, as numpy arrays that are read where they lie."""

from __future__ import annotations

import os
import zlib
from typing import Any, Iterable, Sequence

from . import _arrays as arrays
from ._bytes import format_of, read_bytes
from ._calls import call
from ._errors import ArgumentError, FormatError
from ._grid import Grid, new_grid
from ._lattice import Lattice, WindowLike, set_window
from ._mesh import Mesh, with_positions
from ._records import record
from ._run import FACE_RULES, SIDES, Progress, Rise, Run, choice, ffi, formats_in, in_range, lib, options_of
from ._stages import collapsed, level_target
from ._vti import without_blocks

_TYPES = {"u1": "U8", "i1": "I8", "u2": "U16", "i2": "I16", "u4": "U32", "i4": "I32", "u8": "U64", "i8": "I64", "f4": "F32", "f8": "F64"}
_INFINITY = float("inf")
VOLUME_FORMATS = (*formats_in(lib.BVX_VOLUMES_READ), "nhdr")


def _type_number(code: str) -> int:
    return getattr(lib, f"BVX_SAMPLE_{_TYPES[code]}")


class Volume:
    """Samples at the centres of voxels; it looks at its array and does not copy it.

    Args:
        array: three axes, of any whole-number or float type and any strides. bool counts as 0 and 1. Copied are half-precision floats
            (to float32), other byte orders, and what is no array of numpy.
        order: "xyz" (array[x, y, z]) or "zyx" (array[z, y, x], as most medical readers give it).
        spacing, corner: of the lattice that is made: edges of a voxel, low corner of voxel (0, 0, 0) [world].
        lattice, low: a lattice that the array is a window of, at voxel ``low``; in place of spacing and corner.

    Attributes:
        report: what the last of `threshold` and `surface` counted, a named tuple with the samples that are NaN or infinite, those
            inside, the least and the greatest; None before.
    """

    __slots__ = ("_array", "_c", "report", "__weakref__")

    def __init__(self, array: Any, *, order: str = "xyz", spacing: Any = 1.0, corner: Sequence[float] = (0.0, 0.0, 0.0),
                 lattice: Lattice | None = None, low: Sequence[int] | None = None) -> None:
        np = arrays.numpy("Volume")
        found = arrays.as_numpy(array, "array")
        if found.ndim != 3 or 0 in found.shape:
            raise ArgumentError(f"array has shape {found.shape}; it must have three axes, none of them empty")
        if order not in ("xyz", "zyx"):
            raise ArgumentError(f"order is {order!r}; it must be 'xyz' or 'zyx'")
        if lattice is None and low is not None:
            raise ArgumentError("low is taken together with lattice")
        found = found if order == "xyz" else found.transpose(2, 1, 0)
        if found.dtype.kind == "b":
            found = found.view(np.uint8)
        elif found.dtype == np.float16:
            found = found.astype(np.float32)
        elif found.dtype.kind + str(found.dtype.itemsize) not in _TYPES:
            raise TypeError(f"array must be whole numbers or floats of up to 8 bytes, not {found.dtype}")
        if not found.dtype.isnative:
            found = found.astype(found.dtype.newbyteorder("="))
        if not any(found.strides):  # one number everywhere: strides of 0 would stand for packed ones
            found = np.array(found)
        where = lattice if lattice is not None else Lattice(found.shape, spacing, corner)
        self._set(found, where, tuple(low or (0, 0, 0)))

    def _set(self, array: Any, lattice: Lattice, low: Any) -> None:
        view = ffi.new("bvx_volume_view *")
        view.samples = arrays.address(array)
        view.sample_type = _type_number(array.dtype.kind + str(array.dtype.itemsize))
        view.low, view.size, view.strides = low, array.shape, array.strides
        view.lattice = lattice._c[0]
        self._array, self._c, self.report = array, view, None

    @property
    def array(self) -> Any:
        """The samples as array[x, y, z]; no copy."""
        return self._array

    @property
    def lattice(self) -> Lattice:
        """The lattice whose voxels' centres the samples are."""
        return Lattice._of(self._c.lattice)

    @property
    def low(self) -> tuple[int, int, int]:
        """Lattice index of sample (0, 0, 0)."""
        return tuple(self._c.low)  # type: ignore[return-value]

    @property
    def shape(self) -> tuple[int, int, int]:
        """Samples along x, y, z."""
        return tuple(self._c.size)  # type: ignore[return-value]

    @property
    def spacing(self) -> tuple[float, float, float]:
        """Edges of a voxel [world]."""
        return tuple(self._c.lattice.spacing)  # type: ignore[return-value]

    def window(self, window: WindowLike) -> Volume:
        """A part of it, which keeps its place on the lattice. No copy.

        Args:
            window: (low, size) or (x0, y0, z0, x1, y1, z1), counted from the volume's own first sample.
        """
        box = ffi.new("bvx_window *")
        set_window("window", box, window)
        part = tuple(slice(a, a + n) for a, n in zip(box.low, box.size))
        if any(s.start < 0 or s.stop > n for s, n in zip(part, self.shape)):
            raise ArgumentError(f"window: not inside the volume's {self.shape}")
        made = Volume.__new__(Volume)
        made._set(self._array[part], self.lattice, tuple(a + s.start for a, s in zip(self.low, part)))
        return made

    # ---- what is made of it ----

    def threshold(self, low: float = -_INFINITY, high: float = _INFINITY, *, threads: int | None = None,
                  memory_limit: int | None = None, progress: Progress = None) -> Grid:
        """The voxels with low <= sample <= high, exactly; NaN and infinite samples are never set.

        Returns:
            A `Grid` of the volume's window; its ``report`` and that of the volume tell what was counted.
        """
        grid, report = new_grid(), ffi.new("bvx_volume_report *")
        with Run(threads, memory_limit, progress) as run:
            run.check(lib.bvx_threshold(run.context, self._c, float(low), float(high), report, grid))
        self.report = record(report)
        return Grid._made(grid, self.report)

    def label(self, value: int, *, threads: int | None = None, memory_limit: int | None = None, progress: Progress = None) -> Grid:
        """The voxels of a label: those whose sample is ``value``."""
        if abs(in_range("value", value, -(2**63), 2**64 - 1)) > 2**53:
            raise ArgumentError(f"value is {value}; labels beyond 2**53 cannot be chosen")
        return self.threshold(float(value), float(value), threads=threads, memory_limit=memory_limit, progress=progress)

    def labels(self, *, threads: int | None = None, memory_limit: int | None = None, progress: Progress = None) -> list[Any]:
        """The values other than 0 of whole-number samples, ascending, each with its voxels and their box in the window."""
        count = ffi.new("uint64_t *")
        unsigned = self._c.sample_type == lib.BVX_SAMPLE_U64
        with Run(threads, memory_limit, progress, calls=2) as run:
            run.check(lib.bvx_list_labels(run.context, self._c, ffi.NULL, 0, count))
            found = ffi.new("bvx_label[]", max(1, count[0]))
            run.check(lib.bvx_list_labels(run.context, self._c, found, count[0], count))
        labels = [record(found[i]) for i in range(count[0])]
        return [one._replace(value=one.value % 2**64) for one in labels] if unsigned else labels

    def surface(self, level: float = 0.0, *, below: bool = False, face_rule: str = "separate", dtype: Any = None,
                open_sides: str | Iterable[str] = (), keys: bool = False, triangles: int | None = None,
                error: float | str | None = None, error_kind: str | None = None, local_frame: bool = False, threads: int | None = None,
                memory_limit: int | None = None, progress: Progress = None) -> Mesh:
        """The closed, manifold surface of a level by marching cubes, vertices by linear interpolation between samples.

        Args:
            level: what lies at or above it is inside. NaN and infinite samples are outside, and so is all beyond the volume.
            below: what lies at or below the level is inside.
            face_rule, dtype, open_sides, keys, local_frame: as for `bitvox.surface`.
            triangles, error, error_kind: most triangles of the surface, or its distance to what it would be without, by edges that
                collapse: as for `bitvox.repair`. Not with ``keys`` or ``open_sides``.

        Returns:
            A `Mesh` with uint32 faces; ``report`` of the volume tells what was counted.
        """
        targets = level_target(triangles, error, error_kind)
        if targets and (keys or open_sides):
            raise ArgumentError(f"{next(iter(targets))} and {'keys' if keys else 'open_sides'} contradict each other: parts of a surface are "
                                "merged whole; simplify what merge makes")
        limits: dict[str, Any] = {"threads": threads, "memory_limit": memory_limit, "progress": progress}
        options, report = options_of("scalar_options"), ffi.new("bvx_volume_report *")
        options.level, options.below, options.report = float(level), int(bool(below)), report
        options.face_rule = choice("face_rule", face_rule, "BVX_FACE_", FACE_RULES)
        options.keys, options.local_frame = int(bool(keys)), int(bool(local_frame))
        for side in open_sides.split(",") if isinstance(open_sides, str) and open_sides else open_sides:
            options.open_sides |= choice("open_sides", side, "BVX_OPEN_", SIDES)
        with Rise(progress, 30, *((70,) if targets else ())) as limits["progress"]:
            mesh = with_positions(options, dtype, lambda run, made: lib.bvx_extract_scalar(run.context, self._c, options, made), **limits)
            self.report = record(report)
            return collapsed(mesh, targets, limits)

    def __repr__(self) -> str:
        x, y, z = self.shape
        return f"Volume({x} x {y} x {z}, {self._array.dtype})"


@ffi.def_extern(error=1)
def bvxpy_inflate(user: Any, packed: Any, packed_size: int, plain: Any, plain_size: int) -> int:
    data = ffi.buffer(packed, packed_size)
    if packed_size == plain_size and data[:2] != b"\x1f\x8b":  # a data file that was unpacked by its ending
        ffi.memmove(plain, data, plain_size)
        return 0
    unpacker = zlib.decompressobj(15 + 32)  # the head of gzip or zlib
    out, made, view = ffi.buffer(plain, plain_size), 0, memoryview(data)
    try:
        for at in range(0, packed_size, 1 << 20):
            rest: Any = view[at : at + (1 << 20)]
            while rest and not unpacker.eof:
                piece = unpacker.decompress(rest, min(1 << 24, plain_size - made + 1))
                if made + len(piece) > plain_size:
                    return 1
                out[made : made + len(piece)] = piece
                made += len(piece)
                rest = unpacker.unconsumed_tail
    except zlib.error:
        return 1
    return 0 if unpacker.eof and made == plain_size else 1


def _data_files(run: Run, held: Any, path: str) -> bytes | None:
    """The bytes of the files that a detached head names; None when the samples follow the head."""
    count = ffi.new("uint64_t *")
    run.check(lib.bvx_volume_data_name(run.context, held, len(held), 0, ffi.NULL, 0, count))
    pieces, name = [], ffi.new("char[]", 4096)
    left = run.memory_limit - len(held) if run.memory_limit else None  # a short head may name a large file many times
    for i in range(count[0]):
        run.check(lib.bvx_volume_data_name(run.context, held, len(held), i, name, 4096, count))
        beside = os.fsdecode(ffi.string(name))
        if os.path.isabs(beside) or os.path.splitdrive(beside)[0] or ".." in beside.replace(os.sep, "/").split("/"):
            raise FormatError(f"{path}: its samples are said to be in {beside}; only files in its own folder or below are read")
        pieces.append(read_bytes(os.path.join(os.path.dirname(path), beside), None if left is None else max(left, 0)))
        left = None if left is None else left - len(pieces[-1])
    return b"".join(pieces) if pieces else None


def read_volume(path: str | os.PathLike[str], *, format: str | None = None, shape: Sequence[int] | None = None, dtype: Any = None,
                spacing: Any = None, corner: Sequence[float] | None = None, offset: int = 0, threads: int | None = None,
                memory_limit: int | None = None, progress: Progress = None) -> Volume:
    """Read a volume's samples from a file.

    Args:
        path: .nrrd, .nhdr (raw, ascii or gzip; its data files are looked for beside it), .npy, .vti or .raw, each also as .gz; with
            ``bitvox[medical]`` .nii, .nii.gz, and the folder of a DICOM series, for which `bitvox.formats` has more choices.
        format: one of these endings, in place of the name's own.
        shape, dtype, offset: of .raw: samples along x, y, z (x runs fastest), their numpy type with its byte order, and the bytes
            before the first.
        spacing, corner: the lattice of files that tell none (.raw, .npy) [world].

    Returns:
        A `Volume`. Use `Volume.threshold`, `Volume.surface` and `Volume.labels` to make something of it.
    """
    np = arrays.numpy("read_volume")
    path = os.fspath(path)
    kind = "dcm" if format is None and os.path.isdir(path) else format_of(path, format)
    if kind in ("nii", "dcm"):
        if any(option is not None for option in (shape, dtype, spacing, corner)) or offset:
            raise ArgumentError(f"{path}: the file tells shape, dtype, spacing and corner itself")
        return call("read_nifti_volume" if kind == "nii" else "read_dicom_volume", path)
    if kind not in VOLUME_FORMATS:
        raise ArgumentError(f"{path}: format {kind!r} holds no volume; {', '.join(VOLUME_FORMATS)} do")
    options = options_of("read_volume_options")
    if kind == "raw":
        if shape is None or dtype is None:
            raise ArgumentError(f"{path}: a raw file needs shape and dtype")
        asked = np.dtype(dtype)
        code = asked.kind + str(asked.itemsize)
        if code not in _TYPES:
            raise TypeError(f"dtype must be whole numbers or floats of 1 to 8 bytes, not {asked}")
        options.size, options.sample_type = arrays.triple("shape", shape, int), _type_number(code)
        big = asked.byteorder == ">" or (asked.byteorder == "=" and not arrays.LITTLE)
        options.big_endian, options.offset = int(big), in_range("offset", offset, 0, 2**63)
    elif shape is not None or dtype is not None or offset:
        raise ArgumentError("shape, dtype and offset are for raw files")
    data = read_bytes(path)
    if kind == "vti":
        data = without_blocks(data, memory_limit)
    held = ffi.from_buffer(data)
    volume = ffi.gc(ffi.new("bvx_volume *"), lib.bvxpy_free_volume)
    with Run(threads, memory_limit, progress) as run:
        beside = _data_files(run, held, path) if kind in ("nrrd", "nhdr") else None
        if beside is not None:
            options.data = ffi.from_buffer(beside)
            options.data_size = len(beside)
        options.inflate = lib.bvxpy_inflate
        number = lib.BVX_FORMAT_NRRD if kind == "nhdr" else getattr(lib, f"BVX_FORMAT_{kind.upper()}")
        run.check(lib.bvx_read_volume(run.context, held, len(held), number, options, volume))
    view = volume.view
    code = next(c for c in _TYPES if _type_number(c) == view.sample_type)
    size = tuple(view.size)
    step = np.dtype(code).itemsize
    strides = tuple(view.strides) if any(view.strides) else (step, step * size[0], step * size[0] * size[1])
    memory = arrays.memory(view.samples, step * size[0] * size[1] * size[2], (volume, data, beside)).toreadonly()
    array = np.ndarray(size, np.dtype(code), buffer=memory, strides=strides)
    if (spacing is not None or corner is not None) and volume.placed:
        raise ArgumentError(f"{path}: the file tells its lattice itself")
    lattice = Lattice._of(view.lattice) if spacing is None and corner is None else Lattice(size, 1.0 if spacing is None else spacing,
                                                                                        corner or (0.0, 0.0, 0.0))
    return Volume(array, lattice=lattice)
