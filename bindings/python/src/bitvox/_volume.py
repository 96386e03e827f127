"""Scalar volumes: CT, MRI, fields and label maps, as numpy arrays that are read where they lie."""

from __future__ import annotations

import math
import operator
import os
import re
import zlib
from typing import TYPE_CHECKING, Any, BinaryIO, ClassVar, Iterable, Sequence

from . import _arrays as arrays
from ._bytes import by_file, bytes_of_open, format_of, read_bytes
from ._calls import call, entered
from ._errors import ArgumentError, FormatError, MissingExtraError, UnsupportedError, need
from ._grid import Grid, new_grid
from ._html import shown
from ._labels import Segment, Surfaces, label_surfaces, segments_of
from ._lattice import Lattice, WindowLike, set_window
from ._mesh import Mesh, with_positions
from ._nrrd import unpacked
from ._options import SurfaceOptions
from ._records import record
from ._run import FACE_RULES, Progress, Rise, Run, choice, ffi, formats_in, in_range, known, lib, options_of, put_open_sides
from ._stages import collapsed, level_target
from ._vti import without_blocks
from ._words import Array, Frame, Order, Resampling

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from .reports import Label, VolumeReport

_TYPES = {"u1": "U8", "i1": "I8", "u2": "U16", "i2": "I16", "u4": "U32", "i4": "I32", "u8": "U64", "i8": "I64", "f4": "F32", "f8": "F64"}
_INFINITY = float("inf")
BY_LIBRARIES = ("mha", "mhd", "gipl", "hdr", "img", "mgz", "mgh", "tif", "tiff", "vtk", "slc", "npz", "inr")  # SimpleITK, tifffile, PyVista, numpy
_OF_SEVERAL_FILES = ("nhdr", "mhd", "hdr", "img")
FRAMES: tuple[Frame, ...] = ("lps", "ras")
VOLUME_FORMATS = (*formats_in(lib.BVX_VOLUMES_READ), "nhdr")


def _type_number(code: str) -> int:
    return getattr(lib, f"BVX_SAMPLE_{_TYPES[code]}")


class Volume:
    """Samples at the centers of voxels; it looks at its array and does not copy it.

    Parameters
    ----------
    array
        three axes, of any integer or float type and any strides. bool counts as 0 and 1. Copied are half-precision floats
        (to float32), other byte orders, and what is not a numpy array.
    order
        "xyz" (array[x, y, z]) or "zyx" (array[z, y, x], as most medical readers give it).
    spacing, corner
        of the lattice that is made: edges of a voxel, low corner of voxel (0, 0, 0) [world]. The corner is at 0 where none is given, so the
        first sample is half a voxel from 0; with numpy's indices, scikit-image, SimpleITK and VTK it is at 0: ``center0=(0, 0, 0)``.
    center0
        center of voxel (0, 0, 0), in place of the corner: what SimpleITK, NRRD and VTK's point data call the origin [world].
    direction
        three by three numbers whose columns are the directions of the array's axes x, y and z in the world, as SimpleITK's
        GetDirection and VTK's direction_matrix give them; flipped, permuted and oblique ones too. None: along the world's.
    lattice, low
        a lattice that the array is a window of, at voxel ``low``; in place of spacing, corner and center0.
    frame
        what the world's axes are: "lps" (x to the patient's left, y to the back, z to the head), "ras", or None: not said.

    Attributes
    ----------
    report
        what the last of `threshold` and `surface` counted, a named tuple with the samples that are NaN or infinite, those
        inside, the least and the greatest; None before.
    segments
        names and colors of labels by their value, `Segment`: what an NRRD of 3D Slicer says, and what is put there.

    Examples
    --------
    >>> volume = bitvox.Volume(np.arange(60.0).reshape(3, 4, 5), spacing=(1, 1, 2), center0=(10, 20, 30))
    >>> volume.threshold(30).count, volume.center0
    (30, (10.0, 20.0, 30.0))
    """

    __slots__ = ("_array", "_c", "_turn", "frame", "report", "segments", "__weakref__")
    frame: Frame | None
    report: VolumeReport
    segments: dict[int, Segment]

    def __init__(self, array: Any, *, order: Order = "xyz", spacing: Any = 1.0, corner: Sequence[float] | None = None,
                 center0: Sequence[float] | None = None, direction: Any = None, lattice: Lattice | None = None,
                 low: Sequence[int] | None = None, frame: Frame | None = None) -> None:
        np = arrays.numpy("Volume")
        if any(hasattr(array, name) for name in ("GetDirection", "dataobj", "direction_matrix")):  # their places would be lost
            raise TypeError(f"array must be an array, not {type(array).__name__}; Volume.of takes images of SimpleITK, nibabel and PyVista with their places")
        if isinstance(array, (str, os.PathLike)):
            raise TypeError("array must be an array, not a file's name; bitvox.read_volume reads files")
        if isinstance(array, Volume) or hasattr(array, "lattice"):
            raise TypeError(f"array must be an array, not {type(array).__name__}, whose place would be lost; Volume.of keeps it")
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
            raise TypeError(f"array must be integers or floats of up to 8 bytes, not {found.dtype}")
        if not found.dtype.isnative:
            found = found.astype(found.dtype.newbyteorder("="))
        if not any(found.strides):  # one number everywhere: strides of 0 would stand for packed ones
            found = np.array(found)
        turn = turn_of(direction)
        if lattice is None:
            lattice = self._placed(found.shape, spacing, corner, center0, turn)
        elif corner is not None or center0 is not None:
            raise ArgumentError("lattice contradicts corner and center0; give one of them")
        self._set(found, lattice, tuple(low or (0, 0, 0)), turn, frame_of(frame))

    @staticmethod
    def _placed(shape: Any, spacing: Any, corner: Any, center0: Any, turn: Any) -> Lattice:
        """The lattice in the volume's own frame, from which ``turn`` leads into the world."""
        if corner is not None and center0 is not None:
            raise ArgumentError("corner and center0 contradict each other; give one of them")
        given = arrays.triple("corner", (0.0, 0.0, 0.0)) if corner is None else arrays.triple("corner", corner)
        own = given if turn is None else tuple(from_world(turn, [given])[0].tolist())
        if center0 is not None:
            steps, given = arrays.triple("spacing", spacing), arrays.triple("center0", center0)
            middle = given if turn is None else from_world(turn, [given])[0].tolist()
            own = tuple(c - 0.5 * s for c, s in zip(middle, steps))
        return Lattice(shape, spacing, own)

    def _set(self, array: Any, lattice: Lattice, low: Any, turn: Any = None, frame: Frame | None = None, segments: dict[int, Segment] | None = None) -> None:
        self._turn, self.frame, self.segments = turn, frame, dict(segments or {})
        view = ffi.new("bvx_volume_view *")
        view.samples = arrays.address(array)
        view.sample_type = _type_number(array.dtype.kind + str(array.dtype.itemsize))
        view.low, view.size, view.strides = low, array.shape, array.strides
        view.lattice = lattice._c[0]
        self._array, self._c, self.report = array, view, None  # type: ignore[assignment]

    @property
    def array(self) -> Array:
        """The samples as array[x, y, z]; no copy."""
        return self._array

    @classmethod
    def of(cls, source: Any, *, scalars: str | None = None, order: Order | None = None, spacing: Any = None, center0: Any = None,
           frame: Frame | None = None) -> Volume:
        """A volume of what other libraries hold, with its place and directions; the samples are not copied where that is possible.

        Parameters
        ----------
        source
            an image of SimpleITK or nibabel, a ``pyvista.ImageData``, an xarray ``DataArray``, a Zarr array, a `Grid` (0 and 1), a `Field`
            (signed distances), or a `Volume`.
        scalars
            of PyVista: which point or cell data; None: the active ones.
        order
            of xarray and Zarr, "xyz" or "zyx": which axes the array has. Default: by their names, else "zyx".
        spacing, center0
            of Zarr, which has none.
        frame
            the world to come out in, "lps" or "ras", by turning x and y. None: that of the source, "lps" of SimpleITK, "ras" of nibabel;
            the others do not say theirs and cannot be turned.

        Examples
        --------
        >>> bitvox.Volume.of(bitvox.Volume(np.zeros((2, 2, 2)))).shape
        (2, 2, 2)
        """
        if isinstance(source, cls):
            return source
        if isinstance(source, (str, os.PathLike)):
            raise TypeError("source is a file's name; bitvox.read_volume reads files")
        if hasattr(source, "lattice") and hasattr(source, "to_numpy"):
            if any(option is not None for option in (scalars, order, spacing, center0, frame)):
                raise ArgumentError(f"a {type(source).__name__} says its order, spacing and place itself, and has no frame")
            return volume_of_bits(source) if isinstance(source, Grid) else cls(source.to_numpy(), spacing=source.spacing, center0=source.center0)
        made: Volume = call("volume_from", source, scalars, order, spacing, center0, frame_of(frame))
        return made

    @property
    def direction(self) -> Array:
        """Three by three float64: columns are the directions of the axes x, y, z in the world."""
        np = arrays.numpy("Volume")
        return np.eye(3) if self._turn is None else self._turn.copy()

    @property
    def corner(self) -> tuple[float, float, float]:
        """Low corner of the first voxel, where its axes begin [world]."""
        return self._world([(low - 0.5) for low in (0, 0, 0)])

    @property
    def center0(self) -> tuple[float, float, float]:
        """Center of the first voxel: what SimpleITK calls the origin [world]."""
        return self._world((0, 0, 0))

    @property
    def origin(self) -> tuple[float, float, float]:
        """`center0` under the name that SimpleITK and NRRD have for it [world]."""
        return self.center0

    def _world(self, ijk: Any) -> tuple[float, float, float]:
        x, y, z = self.to_world([ijk])[0].tolist()
        return (x, y, z)

    def to_world(self, ijk: Any) -> Array:
        """Positions (n, 3) of places given by ``ijk`` (n, 3), counted in samples from the first one [world].

        Examples
        --------
        >>> turn = [[0, -1, 0], [1, 0, 0], [0, 0, 1]]
        >>> bitvox.Volume(np.zeros((3, 3, 3)), center0=(0, 0, 0), direction=turn).to_world([[2, 0, 0]]).tolist()
        [[0.0, 2.0, 0.0]]
        """
        np = arrays.numpy("Volume")
        own = np.array(tuple(self._c.lattice.origin)) + (np.asarray(ijk, float) + self.low + 0.5) * np.asarray(self.spacing)
        return own if self._turn is None else arrays.moved_by(self._turn, own)

    @property
    def bounds(self) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
        """Low and high corner of the box along the world's axes that holds all voxels [world]."""
        np = arrays.numpy("Volume")
        ends = [[0 if end >> a & 1 == 0 else n for a, n in enumerate(self.shape)] for end in range(8)]
        found = self.to_world(np.array(ends) - 0.5)
        (a, b, c), (d, e, f) = found.min(axis=0).tolist(), found.max(axis=0).tolist()
        return (a, b, c), (d, e, f)

    def transform(self, matrix: Any) -> Volume:
        """The same samples in another place: ``matrix`` (4, 4), or (3, 3) without a shift, is applied to all positions. No copy.

        Raises
        ------
        ArgumentError
            a matrix of another shape, one that flattens, or one whose last row is not 0 0 0 1.

        Examples
        --------
        >>> volume = bitvox.Volume(np.zeros((2, 2, 2)), center0=(1, 2, 3))
        >>> volume.transform([[0, -1, 0], [1, 0, 0], [0, 0, 1]]).center0
        (-2.0, 1.0, 3.0)
        """
        np = arrays.numpy("Volume.transform")
        full = arrays.matrix_in(matrix)
        steps = full[:3, :3] @ (self.direction * np.asarray(self.spacing))
        spacing = np.sqrt((steps**2).sum(axis=0))
        center0 = arrays.moved_by(full, [self.center0])[0]
        return self._named(Volume(self._array, spacing=spacing.tolist(), center0=center0.tolist(), direction=steps / spacing, frame=self.frame))

    def _named(self, other: Volume) -> Volume:
        """Another one of the same labels."""
        other.segments = dict(self.segments)
        return other

    def turned(self, frame: Frame) -> Volume:
        """The same samples in the world of another ``frame``, "lps" or "ras": x and y change their sign. No copy.

        Examples
        --------
        >>> bitvox.Volume(np.zeros((2, 2, 2)), center0=(1, 2, 3), frame='lps').turned('ras').center0
        (-1.0, -2.0, 3.0)
        """
        np = arrays.numpy("Volume")
        wanted = frame_of(frame)
        if self.frame is None or wanted is None:
            raise ArgumentError("which frame the volume is in is not said: give Volume(..., frame=)")
        if wanted == self.frame:
            return self
        made, change = Volume.__new__(Volume), np.diag([-1.0, -1.0, 1.0])
        turn = change @ self.direction
        made._set(self._array, self.lattice, self.low, None if (turn == np.eye(3)).all() else turn, wanted, self.segments)
        return made

    def aligned(self, *, spacing: Any = None, method: Resampling = "linear", outside: Any = None) -> Volume:
        """The volume with axes along the world's: what lies flipped or permuted is turned without a copy, what lies oblique is
        sampled anew on a lattice around it.

        Parameters
        ----------
        spacing
            of the new lattice of an oblique one. Default: its own smallest, along all axes [world].
        method
            of an oblique one, "linear" or "nearest" (for labels).
        outside
            value beyond the samples. Default: the least sample.

        Examples
        --------
        >>> turn = [[0, -1, 0], [1, 0, 0], [0, 0, 1]]
        >>> bitvox.Volume(np.zeros((2, 3, 4)), direction=turn).aligned().shape
        (3, 2, 4)
        """
        np = arrays.numpy("Volume")
        if self._turn is None:
            return self
        order = np.abs(self._turn).argmax(axis=0)
        plain = np.zeros((3, 3))
        plain[order, range(3)] = np.sign(self._turn[order, range(3)])
        if sorted(order) == [0, 1, 2] and np.abs(self._turn - plain).max() <= 1e-9:
            axes = [int(a) for a in np.argsort(order)]  # of the samples, which becomes x, y, z
            flips = [float(plain[a, axes[a]]) < 0 for a in range(3)]
            array = self._array.transpose(axes)[tuple(slice(None, None, -1) if f else slice(None) for f in flips)]
            first = [0 if not f else n - 1 for f, n in zip((flips[int(a)] for a in order), self.shape)]
            return self._named(Volume(array, spacing=[self.spacing[a] for a in axes], center0=self._world(first), frame=self.frame))
        return self._named(call("resampled", self, spacing, method, outside))

    @property
    def lattice(self) -> Lattice:
        """The lattice whose voxels' centers the samples are; with a direction, in the volume's own frame: the world is
        ``direction @ position``."""
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

        Parameters
        ----------
        window
            (low, size) or (x0, y0, z0, x1, y1, z1), counted from the volume's own first sample.

        Examples
        --------
        >>> bitvox.Volume(np.zeros((4, 4, 4))).window(((1, 1, 1), (2, 2, 2))).center0
        (1.5, 1.5, 1.5)
        """
        box = ffi.new("bvx_window *")
        set_window("window", box, window)
        part = tuple(slice(a, a + n) for a, n in zip(box.low, box.size))
        if any(s.start < 0 or s.stop > n for s, n in zip(part, self.shape)):
            raise ArgumentError(f"window: not inside the volume's {self.shape}")
        made = Volume.__new__(Volume)
        made._set(self._array[part], self.lattice, tuple(a + s.start for a, s in zip(self.low, part)), self._turn, self.frame, self.segments)
        return made

    def to_numpy(self, order: Order = "xyz") -> Array:
        """The samples, ``array[x, y, z]``, or with order "zyx" ``array[z, y, x]``; no copy.

        Examples
        --------
        >>> bitvox.Volume(np.zeros((2, 3, 4))).to_numpy('zyx').shape
        (4, 3, 2)
        """
        if order not in ("xyz", "zyx"):
            raise ArgumentError(f"order is {order!r}; it must be 'xyz' or 'zyx'")
        return self._array if order == "xyz" else self._array.transpose(2, 1, 0)

    def __array__(self, dtype: Any = None, copy: Any = None) -> Any:
        return arrays.handed(self._array, dtype, copy)

    def __getitem__(self, index: Any) -> Any:
        """``volume[x, y, z]`` and all else that numpy takes, of the samples."""
        return self._array[index]

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Volume):
            return NotImplemented
        np = arrays.numpy("Volume")
        return (self._array.dtype == other._array.dtype and (self.lattice, self.low, self.frame) == (other.lattice, other.low, other.frame)
                and np.array_equal(self.direction, other.direction)
                and np.array_equal(self._array, other._array, equal_nan=self._array.dtype.kind == "f"))

    __hash__: ClassVar[None] = None  # type: ignore[assignment]

    def __gt__(self, other: Any) -> Any:
        raise TypeError("a volume is compared by volume.threshold(low, high), which gives a Grid, or as volume.array, which gives an array")

    def __ge__(self, other: Any) -> Any:
        return self > other

    def __lt__(self, other: Any) -> Any:
        return self > other

    def __le__(self, other: Any) -> Any:
        return self > other

    def __reduce__(self) -> Any:
        np = arrays.numpy("pickling")
        return _volume_from, (np.array(self._array), self.lattice, self.low, self._turn, self.frame, self.report, self.segments)

    def _repr_html_(self) -> str:
        middle = [n // 2 for n in self.shape]
        facts = {"samples": self.shape, "type": self._array.dtype, "spacing": self.spacing, "center0": self.center0,
                 "axes": "along the world's" if self._turn is None else self._turn.round(6).tolist(), "frame": self.frame or "not said",
                 f"value at {tuple(middle)}": self._array[tuple(middle)]}
        return shown(self, facts)

    def save(self, path: str | os.PathLike[str], format: str | None = None) -> None:
        """Write it to the file ``path``, in the format of its ending or in ``format``: .nrrd, .mha, .nii or .vti; see `bitvox.write`.

        Examples
        --------
        >>> bitvox.Volume(np.zeros((2, 3, 4), np.int16)).save('a.nrrd')
        >>> bitvox.read_volume('a.nrrd').array.dtype.name
        'int16'
        """
        call("write", self, path, format=format)

    def to_napari(self, name: str | None = None) -> Any:
        """An image layer of napari as it takes them, ``(data, options, "image")``, with place and directions. Axes are z, y, x there.

        Parameters
        ----------
        name
            of the layer; None: "volume".

        Examples
        --------
        >>> bitvox.Volume(np.zeros((2, 3, 4))).to_napari()[0].shape
        (4, 3, 2)
        """
        np = arrays.numpy("to_napari")
        affine = np.eye(4)
        affine[:3, :3] = (self.direction * np.asarray(self.spacing))[::-1, ::-1]
        affine[:3, 3] = self.center0[::-1]
        return self.to_numpy("zyx"), {"name": name or "volume", "affine": affine}, "image"

    def to_sitk(self) -> Any:
        """An image of SimpleITK in the same place, in its world "lps"; a copy. Needs ``bitvox[medical]``.

        Examples
        --------
        >>> bitvox.Volume.of(bitvox.Volume(np.zeros((2, 3, 4))).to_sitk()).shape
        (2, 3, 4)
        """
        return call("to_sitk", self)

    def to_nibabel(self) -> Any:
        """A Nifti1Image of nibabel in the same place, in its world "ras". Needs ``bitvox[medical]``.

        Examples
        --------
        >>> bitvox.Volume(np.zeros((2, 3, 4))).to_nibabel().shape
        (2, 3, 4)
        """
        return call("to_nibabel", self)

    def to_pyvista(self) -> Any:
        """A pyvista.ImageData with the point data "samples". Needs ``bitvox[view]``.

        Examples
        --------
        >>> bitvox.Volume(np.zeros((2, 3, 4))).to_pyvista().dimensions
        (2, 3, 4)
        """
        pyvista = need("pyvista", "view")
        image = pyvista.ImageData(dimensions=self.shape, spacing=self.spacing, origin=self.center0)
        image.direction_matrix = self.direction
        image.point_data["samples"] = self.to_numpy("zyx").reshape(-1)
        return image

    # ---- what is made of it ----

    def threshold(self, low: float = -_INFINITY, high: float = _INFINITY, *, threads: int | None = None,
                  memory_limit: int | None = None, progress: Progress = None) -> Grid:
        """The voxels with low <= sample <= high, exactly; NaN and infinite samples are never set.

        Returns
        -------
        Grid
            A `Grid` of the volume's window; its ``report`` and that of the volume say what was counted. Of a volume whose axes are
            flipped or permuted, the grid is that of `aligned`.

        Examples
        --------
        >>> bitvox.Volume(np.arange(8).reshape(2, 2, 2)).threshold(2, 4).count
        3
        """
        low, high = _exact("low", low), _exact("high", high)
        if low > high:
            raise ArgumentError(f"low is {low} and high is {high}: no sample is at or above the one and at or below the other")
        grid, report = new_grid(), ffi.new("bvx_volume_report *")
        given = self._without_resampling()
        bounds, function = _bounds(self._array.dtype, low, high)
        with Run(threads, memory_limit, progress) as run:
            run.check(function(run.context, given._c, *bounds, report, grid))
        self.report = record(report)
        return Grid._made(grid, self.report)

    def _without_resampling(self) -> Volume:
        """With axes along the world's, where that needs no new samples."""
        np = arrays.numpy("Volume")
        if self._turn is not None and (np.abs(np.abs(self._turn).max(axis=0) - 1.0) > 1e-9).any():
            raise ArgumentError("the volume lies oblique to the world's axes, and a Grid lies along them: take volume.aligned().threshold(...), "
                                "which samples it anew, or volume.surface(level), which does not (of a pyvista.ImageData: image.bitvox.volume())")
        return self.aligned()

    def label(self, value: int, *, crop: bool = False, threads: int | None = None, memory_limit: int | None = None, progress: Progress = None) -> Grid:
        """The voxels of a label: those whose sample is ``value``; with ``crop`` in their box alone, which keeps its place.

        Examples
        --------
        >>> volume = bitvox.Volume(np.arange(8).reshape(2, 2, 2))
        >>> volume.label(3).count, volume.label(3, crop=True).shape
        (1, (1, 1, 1))
        """
        value = in_range("value", value, -(2**63), 2**64 - 1)
        grid = self.threshold(value, value, threads=threads, memory_limit=memory_limit, progress=progress)
        if crop and grid:
            grid, grid.report = grid.crop(), self.report  # type: ignore[assignment]
        return grid

    def labels(self, *, threads: int | None = None, memory_limit: int | None = None, progress: Progress = None) -> list[Label]:
        """The values other than 0 of integer samples, ascending, each with its voxels and their box in the window.

        Examples
        --------
        >>> [one.value for one in bitvox.Volume(np.arange(8).reshape(2, 2, 2) % 3).labels()]
        [1, 2]
        """
        count = ffi.new("uint64_t *")
        unsigned = self._c.sample_type == lib.BVX_SAMPLE_U64
        with Run(threads, memory_limit, progress, calls=2) as run:
            run.check(lib.bvx_list_labels(run.context, self._c, ffi.NULL, 0, count))
            found = ffi.new("bvx_label[]", max(1, count[0]))
            run.check(lib.bvx_list_labels(run.context, self._c, found, count[0], count))
        labels = [record(found[i]) for i in range(count[0])]
        return [one._replace(value=one.value % 2**64) for one in labels] if unsigned else labels

    def surfaces(self, *, background: int = 0, smooth: bool = True, triangles: int | None = None, error: float | None = None,
                 open: bool = False, dtype: Any = None, threads: int | None = None, memory_limit: int | None = None, progress: Progress = None) -> Surfaces:
        """The surfaces of all labels of integer samples at once, as a mapping from each value to its `Mesh`.

        Bodies that touch share positions and faces, so nothing lies in none or in two. Each is closed and manifold; no two triangles cross.

        Parameters
        ----------
        background
            the value that is no body; beyond the volume is background too.
        smooth
            vertices move within half a voxel, and labels keep their volumes to 0.1 %, but where most faces are at junctions. False: the voxels' own
            sides.
        triangles, error
            fewer triangles, so many in all, or as many as keep that mean distance of both directions to all of them [world]. Bodies still share
            faces, and junctions of labels.
        open
            the volume is a `window` that others join: where the lattice goes on, it has one voxel more than its own part, and its bodies end in the
            plane before that voxel, where those of the next window begin, with the same bits.
        dtype
            of positions; None takes float32 where it distinguishes neighbors.

        Examples
        --------
        >>> halves = np.ones((8, 8, 8), np.uint8)
        >>> halves[4:] = 2
        >>> bodies = bitvox.Volume(halves).surfaces()
        >>> bodies.labels[0].voxels, round(bodies[1].check().volume), bodies[2].check().closed
        (256, 256, True)
        """
        targets = level_target(triangles, error, None)
        unsigned = self._c.sample_type == lib.BVX_SAMPLE_U64
        background = in_range("background", background, -(2**63), 2**64 - 1)
        if self._turn is not None and dtype is None:
            dtype = "float64"  # turned positions need more digits than the lattice's own
        return label_surfaces(self._c, background, smooth, targets, dtype, unsigned, self._in_world, self.segments, open=open,
                              threads=threads, memory_limit=memory_limit, progress=progress)

    def surface(self, level: float = 0.0, *, below: bool = False, dtype: Any = None, open_sides: str | Iterable[str] = (), keys: bool = False,
                keep_largest: int | None = None, triangles: int | None = None, error: float | str | None = None, threads: int | None = None,
                memory_limit: int | None = None, progress: Progress = None, **advanced: Unpack[SurfaceOptions]) -> Mesh:
        """The closed, manifold surface of a level by marching cubes, vertices by linear interpolation between samples.

        Parameters
        ----------
        level
            what lies at or above it is inside; vertices stay 1/128 of an edge off the samples. NaN and infinite samples are outside, and so is all beyond the volume.
        below
            what lies at or below the level is inside.
        dtype, open_sides, keys
            as for `bitvox.surface`.
        keep_largest
            the surface of this many of the largest connected parts, without the crumbs; each has its cavities.
        triangles, error
            most triangles of the surface, or its distance to what it would be without, by edges that
            collapse: as for `bitvox.repair`. Not with ``keys`` or ``open_sides``.
        advanced
            `SurfaceOptions`: ``face_rule``, ``local_frame``, ``error_kind``.

        Returns
        -------
        Mesh
            A `Mesh` with uint32 faces, in the world; ``report`` of the volume says what was counted.

        Examples
        --------
        >>> x, y, z = np.mgrid[-1:1:20j, -1:1:20j, -1:1:20j]
        >>> ball = bitvox.Volume(0.7 - np.sqrt(x * x + y * y + z * z), spacing=2 / 19, center0=(-1, -1, -1)).surface(0.0)
        >>> ball.check().closed, round(ball.check().volume, 1)
        (True, 1.4)
        """
        known(Volume.surface, SurfaceOptions, advanced)
        targets = level_target(triangles, error, advanced.get("error_kind"))
        if self._turn is not None and (keys or open_sides):
            raise ArgumentError("keys and open_sides are for volumes whose axes are the world's: take volume.aligned() first")
        if self._turn is not None and dtype is None:
            dtype = "float64"  # turned positions need more digits than the lattice's own
        if targets and (keys or open_sides):
            raise ArgumentError(f"{next(iter(targets))} and {'keys' if keys else 'open_sides'} contradict each other: parts of a surface are "
                                "merged whole; simplify what merge makes")
        limits: dict[str, Any] = {"threads": threads, "memory_limit": memory_limit, "progress": progress}
        given = self if keep_largest is None else self._without_crumbs(number("level", level), below, keep_largest, {**limits, "progress": None})
        options, report = options_of("scalar_options"), ffi.new("bvx_volume_report *")
        options.level, options.below, options.report = number("level", level), int(bool(below)), report
        options.face_rule = choice("face_rule", advanced.get("face_rule", "separate"), "BVX_FACE_", FACE_RULES)
        options.keys, options.local_frame = int(bool(keys)), int(bool(advanced.get("local_frame")))
        put_open_sides(options, open_sides)
        with Rise(progress, 30, *((70,) if targets else ())) as limits["progress"]:
            mesh = with_positions(options, dtype, lambda run, made: lib.bvx_extract_scalar(run.context, given._c, options, made), **limits)
            self.report = record(report)
            return self._in_world(collapsed(mesh, targets, limits))

    def _without_crumbs(self, level: float, below: bool, largest: int, limits: dict[str, Any]) -> Volume:
        """A copy whose smaller parts have a sample of outside: parts share no edge of the lattice, so the others' surface stays."""
        np, plain = arrays.numpy("Volume.surface"), Volume.__new__(Volume)
        plain._set(self._array, self.lattice, self.low, None, self.frame)
        every = plain.threshold(*((-_INFINITY, level) if below else (level, _INFINITY)), **limits)
        dropped = (every - every.keep(largest=largest, **limits)).to_numpy()
        if not dropped.any():
            return self
        array = np.array(self._array)
        array[dropped] = self._array[~every.to_numpy()][0]
        plain._set(array, self.lattice, self.low, self._turn, self.frame)
        return plain

    def _in_world(self, mesh: Mesh) -> Mesh:
        """A mesh in the volume's own frame, turned into the world; a mirror turns its faces."""
        if self._turn is None:
            return mesh
        np = arrays.numpy("Volume")
        faces = np.asarray(mesh.faces)
        if np.linalg.det(self._turn) < 0:
            faces = np.ascontiguousarray(faces[:, ::-1])
        turned = arrays.moved_by(self._turn, np.asarray(mesh.vertices, np.float64)).astype(np.asarray(mesh.vertices).dtype)
        made = Mesh(turned, faces, frame=tuple(arrays.moved_by(self._turn, np.asarray([mesh.frame]))[0].tolist()))
        made.report = mesh.report
        return made

    def __repr__(self) -> str:
        x, y, z = self.shape
        return f"Volume({x} x {y} x {z}, {self._array.dtype})"


def frame_of(frame: str | None) -> Frame | None:
    """A frame's name, or an error."""
    for one in FRAMES:
        if frame == one:
            return one
    if frame is None:
        return None
    raise ArgumentError(f"frame is {frame!r}; it must be 'lps' or 'ras'")


def turn_of(direction: Any) -> Any:
    """A matrix of directions of length 1, or None for those of the world."""
    if direction is None:
        return None
    np = arrays.numpy("Volume")
    found = np.array(arrays.as_numpy(direction, "direction"), np.float64)
    if found.size != 9:
        raise ArgumentError(f"direction has shape {found.shape}; it must be (3, 3), columns the directions of x, y and z")
    found = found.reshape(3, 3)
    if not np.isfinite(found).all() or (np.abs(np.linalg.norm(found, axis=0) - 1.0) > 1e-3).any() or abs(np.linalg.det(found)) < 1e-6:
        raise ArgumentError("direction: its columns must be of length 1 and lie in no plane")
    return None if (found == np.eye(3)).all() else found


def from_world(turn: Any, points: Any) -> Any:
    """The other way round; exact for axes that are flipped and permuted."""
    np = arrays.numpy("Volume")
    transposed = np.abs(turn.T @ turn - np.eye(3)).max() < 1e-12
    return arrays.moved_by(turn.T if transposed else np.linalg.inv(turn), points)


def number(name: str, value: Any) -> float:
    """A number, not a text of one."""
    if isinstance(value, (str, bytes)):
        raise TypeError(f"{name} must be a number, not {value!r}")
    return float(value)


def _exact(name: str, value: Any) -> int | float:
    """A number without rounding."""
    try:
        return operator.index(value)
    except TypeError:
        return number(name, value)


def _bounds(dtype: Any, low: int | float, high: int | float) -> tuple[tuple[Any, Any], Any]:
    """The ends of a threshold as the samples' own kind of numbers, inwards, and the library's function of that kind."""
    if low != low or high != high:
        raise ArgumentError(f"low is {low} and high is {high}; neither may be NaN")
    if dtype.kind == "f":
        ends = float(low), float(high)  # an integer may lie between two doubles
        return (math.nextafter(ends[0], _INFINITY) if ends[0] < low else ends[0],
                math.nextafter(ends[1], -_INFINITY) if ends[1] > high else ends[1]), lib.bvx_threshold
    least, most = (0, 2 ** (8 * dtype.itemsize) - 1) if dtype.kind == "u" else (-(2 ** (8 * dtype.itemsize - 1)), 2 ** (8 * dtype.itemsize - 1) - 1)
    first = least if low <= least else most + 1 if low > most else math.ceil(low)
    last = most if high >= most else least - 1 if high < least else math.floor(high)
    if first > last:
        first, last = 1, 0  # nothing
    return tuple(end - 2**64 if end >= 2**63 else end for end in (first, last)), lib.bvx_threshold_whole  # type: ignore[return-value]


def _volume_from(array: Any, lattice: Lattice, low: Any, turn: Any, frame: Frame | None, report: Any,
                 segments: dict[int, Segment] | None = None) -> Volume:
    made = Volume.__new__(Volume)
    made._set(array, lattice, low, turn, frame, segments)
    made.report = report
    return made


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


def read_volume(path: str | os.PathLike[str] | BinaryIO, *, format: str | None = None, shape: Sequence[int] | None = None, dtype: Any = None,
                spacing: Any = None, corner: Sequence[float] | None = None, offset: int = 0, order: Order = "xyz", frame: Frame | None = None,
                threads: int | None = None, memory_limit: int | None = None, progress: Progress = None) -> Volume:
    """Read a volume's samples from a file.

    Parameters
    ----------
    path
        a name, or an open binary file of one of these formats (but .nhdr, .mhd, .hdr and .img, which lie in several files). .nrrd, .nhdr (raw, ascii, gzip or, of .nrrd, bzip2; its data files are looked for beside it), .npy, .vti or .raw, each also as .gz; .npz of one
        array, .inr; with ``bitvox[medical]`` .nii, .nii.gz, .mha, .mhd, .gipl, .hdr, .img, .mgz, .nrrd of any kind (SimpleITK), .tif
        and OME-TIFF (tifffile), and the folder of a DICOM series, for which `bitvox.formats` has more choices; with ``bitvox[view]``
        .vtk, .slc and a .vti whose axes are turned.
    format
        one of these endings, in place of the name's own.
    shape, dtype, offset
        of .raw: samples along x, y, z (x runs fastest), their numpy type with its byte order, and the bytes
        before the first.
    spacing, corner
        the lattice of files that have none (.raw, .npy, .npz) [world].
    order
        of .npy and .npz: "zyx" for an array[z, y, x].
    frame
        the world to come out in, "lps" or "ras", by turning x and y. None, the default of all formats: the numbers that stand in
        the file; ``volume.frame`` says which world that is (NIfTI "ras"; DICOM, MetaImage "lps"; NRRD what it says).

    Returns
    -------
    Volume
        A `Volume`. Use `Volume.threshold`, `Volume.surface` and `Volume.labels` to make something of it.

    Examples
    --------
    >>> np.save('scan.npy', np.zeros((4, 5, 6), np.int16))
    >>> bitvox.read_volume('scan.npy', spacing=(1, 1, 2)).spacing
    (1.0, 1.0, 2.0)
    """
    np = arrays.numpy("read_volume")
    if hasattr(path, "read"):
        data, kind = bytes_of_open(path, format)
        if kind in _OF_SEVERAL_FILES:
            raise UnsupportedError(f".{kind} has its samples in another file, so an open one is not enough: give its name")
        return by_file(data, kind, lambda name: read_volume(name, shape=shape, dtype=dtype, spacing=spacing, corner=corner, offset=offset, order=order,
                                                            frame=frame, threads=threads, memory_limit=memory_limit, progress=progress))
    path = os.fsdecode(path)
    kind = "dcm" if format is None and os.path.isdir(path) else format_of(path, format)
    if order != "xyz" and kind not in ("npy", "npz"):
        raise ArgumentError(f"order is for .npy and .npz: {path} says its own")
    if kind in ("nii", "dcm"):
        if any(option is not None for option in (shape, dtype, spacing, corner)) or offset:
            raise ArgumentError(f"{path}: the file says shape, dtype, spacing and corner itself")
        return _in_frame(call("read_nifti_volume" if kind == "nii" else "read_dicom_volume", path), frame, path)
    if kind == "npz" and shape is None and dtype is None and not offset:
        return Volume(call("array_of_npz", path), order=order, spacing=1.0 if spacing is None else spacing, corner=corner)
    if kind in BY_LIBRARIES:
        if any(option is not None for option in (shape, dtype, spacing, corner)) or offset:
            raise ArgumentError(f"{path}: the file says shape, dtype, spacing and corner itself")
        return _in_frame(call("read_by_library", path, kind), frame, path)
    if kind not in VOLUME_FORMATS:
        raise ArgumentError(f"{path}: format {kind!r} is not read; volumes are {', '.join((*VOLUME_FORMATS, 'nii', 'dcm', *BY_LIBRARIES))}")
    options = options_of("read_volume_options")
    if kind == "raw":
        if shape is None or dtype is None:
            raise ArgumentError(f"{path}: a raw file needs shape and dtype")
        asked = np.dtype(dtype)
        code = asked.kind + str(asked.itemsize)
        if code not in _TYPES:
            raise TypeError(f"dtype must be integers or floats of 1 to 8 bytes, not {asked}")
        options.size, options.sample_type = arrays.triple("shape", shape, int), _type_number(code)
        big = asked.byteorder == ">" or (asked.byteorder == "=" and not arrays.LITTLE)
        options.big_endian, options.offset = int(big), in_range("offset", offset, 0, 2**63)
    elif shape is not None or dtype is not None or offset:
        raise ArgumentError("shape, dtype and offset are for raw files")
    data = read_bytes(path)
    if kind == "vti":
        data = without_blocks(data, memory_limit)
    if kind == "nrrd":
        data = unpacked(data, memory_limit, kept=b"g")  # gzip the library unpacks as it reads
    held = ffi.from_buffer(data)
    volume = ffi.gc(ffi.new("bvx_volume *"), lib.bvxpy_free_volume)
    beside: bytes | None = None
    try:
        beside = _fill(volume, held, path, kind, options, threads, memory_limit, progress)
    except UnsupportedError:
        if kind not in ("nrrd", "nhdr", "vti"):
            raise
        try:
            found: Volume = call("read_by_library", path, kind)  # axes that are turned, bzip2 and the like
            found.segments = segments_of(data) if kind in ("nrrd", "nhdr") else {}
            return _in_frame(found, frame, path)
        except MissingExtraError:
            pass
        raise
    view = volume.view
    code = next(c for c in _TYPES if _type_number(c) == view.sample_type)
    size = tuple(view.size)
    step = np.dtype(code).itemsize
    strides = tuple(view.strides) if any(view.strides) else (step, step * size[0], step * size[0] * size[1])
    memory = arrays.memory(view.samples, step * size[0] * size[1] * size[2], (volume, data, beside)).toreadonly()
    array = np.ndarray(size, np.dtype(code), buffer=memory, strides=strides)
    if (spacing is not None or corner is not None) and volume.placed:
        raise ArgumentError(f"{path}: the file says its lattice itself")
    lattice = Lattice._of(view.lattice) if spacing is None and corner is None else Lattice(size, 1.0 if spacing is None else spacing,
                                                                                        corner or (0.0, 0.0, 0.0))
    if order != "xyz":
        return Volume(array, order=order, spacing=1.0 if spacing is None else spacing, corner=corner)
    made = Volume(array, lattice=lattice, frame=_frame_told(data) if kind in ("nrrd", "nhdr") else None)
    made.segments = segments_of(data) if kind in ("nrrd", "nhdr") else {}
    return _in_frame(made, frame, path)


def _fill(volume: Any, held: Any, path: str, kind: str, options: Any, threads: Any, memory_limit: Any, progress: Progress) -> bytes | None:
    """Read a volume by the library; the bytes of the data files, which it may look at."""
    with Run(threads, memory_limit, progress) as run:
        beside = _data_files(run, held, path) if kind in ("nrrd", "nhdr") else None
        if beside is not None:
            options.data = ffi.from_buffer(beside)
            options.data_size = len(beside)
        options.inflate = lib.bvxpy_inflate
        format_number = lib.BVX_FORMAT_NRRD if kind == "nhdr" else getattr(lib, f"BVX_FORMAT_{kind.upper()}")
        run.check(lib.bvx_read_volume(run.context, held, len(held), format_number, options, volume))
    return beside


def _frame_told(data: Any) -> Frame | None:
    """What an NRRD's head says of its space."""
    head = bytes(data[: 1 << 16]).split(b"\n\n", 1)[0]
    said = re.search(rb"^space:\s*(\S+)", head, flags=re.M)
    names: dict[bytes, Frame] = {b"left-posterior-superior": "lps", b"lps": "lps", b"right-anterior-superior": "ras", b"ras": "ras"}
    return names.get(said[1].lower()) if said else None


def _in_frame(volume: Volume, frame: Frame | None, path: str) -> Volume:
    if frame_of(frame) is None or frame is None:
        return volume
    if volume.frame is None:
        raise ArgumentError(f"{path}: the file does not say what its axes are, so it cannot be turned to {frame!r}")
    return volume.turned(frame)


@entered
def resampled_bits(grid: Grid, matrix: Any, spacing: Any) -> Grid:
    """See `Grid.transform`: what `Volume.aligned` makes of 0 and 1 by the nearest sample."""
    volume = volume_of_bits(grid).transform(matrix).aligned(spacing=spacing, method="nearest", outside=0)
    return Grid.from_numpy(volume.array, spacing=volume.spacing, center0=volume.center0)


@entered
def grid_from(source: Any, scalars: str | None) -> Grid:
    """See `Grid.of`."""
    volume = Volume.of(source, scalars=scalars)._without_resampling()
    return Grid.from_numpy(volume.array, lattice=volume.lattice, low=volume.low)


def volume_of_bits(grid: Grid) -> Volume:
    """A grid's voxels as samples of 0 and 1."""
    np = arrays.numpy("Volume")
    return Volume(grid.to_numpy().view(np.uint8), spacing=grid.spacing, center0=grid.center0)
