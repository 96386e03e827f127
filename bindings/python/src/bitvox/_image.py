"""Pictures of meshes and grids."""

from __future__ import annotations

import math
import os
import struct
import zlib
from typing import TYPE_CHECKING, Any, ClassVar, Sequence

from . import _arrays as arrays
from ._bytes import write_bytes
from ._calls import entered
from ._errors import ArgumentError
from ._grid import Grid
from ._html import shown
from ._mesh import Mesh
from ._options import RenderOptions
from ._run import Progress, Run, ffi, in_range, known, lib, options_of
from ._words import Array

if TYPE_CHECKING:
    from typing_extensions import Unpack


class Image:
    """Pixels (height, width, 3) uint8; shows itself in a notebook.

    Examples
    --------
    >>> picture = bitvox.render('knot.ply', size=(40, 30))
    >>> picture.size, picture.pixels.shape
    ((40, 30), (30, 40, 3))
    """

    __slots__ = ("_c",)

    def __init__(self, owner: Any) -> None:
        self._c = owner

    @property
    def size(self) -> tuple[int, int]:
        """Width and height in pixels."""
        return (self._c.width, self._c.height)

    @property
    def pixels(self) -> Array:
        """(height, width, 3) uint8: red, green, blue, top row first; read-only, no copy."""
        return arrays.array_at(self._c.pixels, "uint8", (self._c.height, self._c.width, 3), self._c)

    def png(self) -> bytes:
        """A PNG file's bytes; they depend on the pixels alone.

        Examples
        --------
        >>> bitvox.render('knot.ply', size=(40, 30)).png()[1:4]
        b'PNG'
        """
        out = ffi.gc(ffi.new("bvx_buffer *"), lib.bvxpy_free_buffer)
        with Run() as run:
            run.check(lib.bvx_write_png(run.context, self._c, out))
        return bytes(ffi.buffer(out.bytes, out.size))

    def packed_png(self) -> bytes:
        """A smaller PNG file's bytes with the same pixels, for notebooks; what zlib makes of them depends on its version.

        Examples
        --------
        >>> bitvox.render('knot.ply', size=(80, 60)).packed_png()[1:4]
        b'PNG'
        """
        width, height = self.size
        rows = bytes(ffi.buffer(self._c.pixels, 3 * width * height))
        plain = b"".join(b"\0" + rows[3 * width * y : 3 * width * (y + 1)] for y in range(height))
        parts = ((b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)), (b"IDAT", zlib.compress(plain, 6)), (b"IEND", b""))
        return b"\x89PNG\r\n\x1a\n" + b"".join(struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))
                                               for name, data in parts)

    def _repr_html_(self) -> str:
        return shown(self, {"width, height": self.size}, self.packed_png())

    def _repr_png_(self) -> bytes:
        return self.packed_png()

    def __array__(self, dtype: Any = None, copy: Any = None) -> Any:
        return arrays.handed(self.pixels, dtype, copy)

    def __eq__(self, other: object) -> bool:
        return self.size == other.size and bytes(self.pixels) == bytes(other.pixels) if isinstance(other, Image) else NotImplemented

    __hash__: ClassVar[None] = None  # type: ignore[assignment]

    def __reduce__(self) -> Any:
        return _image_from, (*self.size, bytes(self.pixels))

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write a PNG file; ``path`` ends in .png.

        Examples
        --------
        >>> bitvox.render('knot.ply', size=(40, 30)).save('small.png')
        """
        if not os.fspath(path).lower().endswith(".png"):
            raise ArgumentError(f"{os.fspath(path)}: pictures are written as .png")
        write_bytes(path, self.png())

    def __repr__(self) -> str:
        return f"Image({self.size[0]} x {self.size[1]})"


def _image_from(width: int, height: int, data: bytes) -> Image:
    made, pixels = ffi.new("bvx_image *"), ffi.new("uint8_t[]", data)
    made.pixels, made.width, made.height = pixels, width, height
    return Image(ffi.gc(made, lambda _, pixels=pixels: None))


def _color(name: str, value: Sequence[int]) -> tuple[int, int, int, int]:
    found = tuple(value)
    if len(found) != 3:
        raise ArgumentError(f"{name} must be red, green, blue")
    return (*(in_range(name, x, 0, 255) for x in found), 255)  # type: ignore[return-value]


@entered
def render(
    source: Any,
    *,
    size: Sequence[int] = (1024, 768),
    from_: Sequence[float] | None = None,
    up: Sequence[float] | None = None,
    smooth: bool = False,
    wireframe: bool = False,
    cut: dict[str, float] | None = None,
    color: Sequence[int] = (200, 196, 188),
    compare: Any = None,
    threads: int | None = None,
    memory_limit: int | None = None,
    progress: Progress = None,
    **advanced: Unpack[RenderOptions],
) -> Image:
    """A shaded picture of a mesh or a grid; the same bytes on every machine.

    Parameters
    ----------
    source
        a mesh (what `Mesh.of` takes; the colors of its vertices show) or a `Grid`.
    size
        width and height in pixels.
    from_
        direction from the model to the eye (the program's ``--from``). Default (3, -4, 2).
    up
        what is up in the picture. Default (0, 0, 1).
    smooth
        smooth shading in place of facets.
    wireframe
        edges of triangles or voxels drawn over the surface.
    cut
        take away what lies between planes and the eye: ``{"x": 0.5, "z": 1.0}`` [world].
    color
        red, green, blue.
    compare
        a second grid: what it adds is green, what it lacks red.
    advanced
        `RenderOptions`: ``cut_low``, ``cut_high``, ``background``, ``samples``, ``show``.

    Returns
    -------
    Image
        An `Image`.

    Raises
    ------
    ArgumentError
        options that contradict each other.
    EmptyError
        nothing to see.
    LatticeError
        grids that do not share lattice and window.
    RangeError, MemoryLimitError

    Examples
    --------
    >>> bitvox.render('knot.ply', size=(64, 48)).save('knot.png')
    """
    known(render, RenderOptions, advanced)
    cut_low, cut_high, show = advanced.get("cut_low"), advanced.get("cut_high"), advanced.get("show")
    options = options_of("render_options")
    options.width, options.height = (in_range("size", n, 1, 16384) for n in size)
    options.camera.direction = (3, -4, 2) if from_ is None else arrays.direction("from_", from_)
    if up is not None:
        options.camera.up = arrays.direction("up", up)
    if show is not None:
        options.camera.show = tuple(float(x) for x in show)
    options.smooth, options.wireframe, options.samples = int(bool(smooth)), int(bool(wireframe)), in_range("samples", advanced.get("samples", 2), 1, 4)
    options.colour, options.background = _color("color", color), _color("background", advanced.get("background", (255, 255, 255)))
    options.cut.sides = 63  # all sides; those that nothing is said of lie at infinity
    options.cut.low = (-math.inf,) * 3 if cut_low is None else arrays.triple("cut_low", cut_low)
    options.cut.high = (math.inf,) * 3 if cut_high is None else arrays.triple("cut_high", cut_high)
    if cut is not None and not hasattr(cut, "items"):
        raise TypeError(f'cut must be like {{"x": 0.5}}, not {cut!r}')
    for axis, at in (cut or {}).items():
        if axis not in ("x", "y", "z"):
            raise ArgumentError(f"cut: {axis!r} is not an axis; it must be x, y or z")
        i = "xyz".index(axis)
        if options.camera.direction[i] >= 0:
            options.cut.high[i] = min(options.cut.high[i], float(at))
        else:
            options.cut.low[i] = max(options.cut.low[i], float(at))
    image = ffi.gc(ffi.new("bvx_image *"), lib.bvxpy_free_image)
    with Run(threads, memory_limit, progress) as run:
        if compare is not None:
            if not isinstance(source, Grid):
                raise ArgumentError("compare is for grids")
            run.check(lib.bvx_render_difference(run.context, source._c, compare._c, options, image))
        elif isinstance(source, Grid):
            run.check(lib.bvx_render_grid(run.context, source._c, options, image))
        else:
            run.check(lib.bvx_render_mesh(run.context, Mesh.of(source)._view(run), options, image))
    return Image(image)
