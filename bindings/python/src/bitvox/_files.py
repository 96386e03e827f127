"""Files and bytes of files."""

from __future__ import annotations

import os
import warnings
from typing import TYPE_CHECKING, Any, BinaryIO, Iterable, Sequence, Union

from . import _arrays as arrays
from ._bytes import by_file, bytes_of_open, format_of, new_beside, read_bytes, umask, write_bytes
from ._calls import call, entered
from ._errors import ArgumentError, UnsupportedError
from ._field import Field
from ._grid import Grid, new_grid
from ._image import Image
from ._lattice import WindowLike, set_window
from ._labels import Segment
from ._mended import mended
from ._mesh import Mesh, new_mesh, subtract
from ._nrrd import unpacked
from ._octree import Octree, states_of
from ._run import Progress, Run, ffi, formats_in, function, lib, number_of, options_of
from ._sections import SECTION_FORMATS, SECTION_OUTPUTS, Sections, named, read_sections
from ._volume import Volume, volume_of_bits
from ._vti import without_blocks

MESH_FORMATS = formats_in(lib.BVX_MESHES_READ)
MESH_OUTPUTS = formats_in(lib.BVX_MESHES_WRITTEN)
GRID_FORMATS = formats_in(lib.BVX_GRIDS_READ)
GRID_OUTPUTS = formats_in(lib.BVX_GRIDS_WRITTEN)
FIELD_OUTPUTS = ("npy", "nrrd", "vti", "vdb", "nvdb")
MESHES_BY_LIBRARIES = ("vtp",)  # PyVista
_TREE_MAGIC = b"\x89BVO"
OF_OTHERS = ("amf", "vtp", "dxf", "nii", "mha", "dcm")  # PyVista, ezdxf, nibabel, SimpleITK, pydicom; amf here
_LOST = ((lib.BVX_LOST_SKINS, "skins"), (lib.BVX_LOST_MORPHS, "morph targets"), (lib.BVX_LOST_ANIMATIONS, "animations"),
         (lib.BVX_LOST_POINTS, "points and lines"), (lib.BVX_LOST_IMAGES, "images whose file is not there"),
         (lib.BVX_LOST_ATTRIBUTES, "further attributes of vertices"))
_BESIDE = ("npy", "vox")  # the lattice stands in FILE.json


if TYPE_CHECKING:
    class Found(Mesh, Grid, Octree, Sections):  # type: ignore[misc]
        """One of these, which a file's name does not tell: type checkers take it for each of them, and find what none has."""
else:
    Found = Union[Mesh, Grid, Octree, Sections]


@entered
def read(path: str | os.PathLike[str] | BinaryIO, *, format: str | None = None, window: WindowLike = None, close_gap: float | None = None,
         drop_nonfinite: bool = False, threads: int | None = None, memory_limit: int | None = None, progress: Progress = None) -> Found:
    """Read a mesh or a grid.

    Parameters
    ----------
    path
        a name, or an open binary file. .stl .obj .ply .off .glb .gltf .3mf (meshes; a .gltf with the files beside it), .npy .binvox .vox .nrrd .vti .bvx (grids; .bvx octrees too), .csl .csv (sections),
        each also as .gz; .amf; other meshes that trimesh reads (.dae), with ``bitvox[formats]``; .vtp with ``bitvox[view]``; .dxf (sections)
        with ``bitvox[geo]``; with ``bitvox[medical]`` the .dcm of an RTSTRUCT (sections) and a .nii or .mha that was written of a grid, which is known
        by its head (other masks: `bitvox.formats.read_nifti`, `bitvox.read_volume`). Beside .npy and .vox, FILE.json
        gives the lattice.
    format
        one of these endings, in place of the name's own.
    window
        of a grid: only these voxels, counted from the file's own first one.
    close_gap
        of .csv: refuse loops whose ends lie further apart than this [world]; None closes every loop.
    drop_nonfinite
        of a mesh: leave out triangles with a corner that is NaN or infinite, which are else an error; a warning
        says how many.

    Returns
    -------
    Found
        A `Mesh`, a `Grid`, an `Octree` or `Sections`.

    Raises
    ------
    FormatError
        what is wrong with which byte or line.
    UnsupportedError
        no such format, or one that needs more options (`bitvox.formats`).
    MissingExtraError
        which extra reads it.
    OSError
        as `open`.

    Examples
    --------
    >>> bitvox.read('knot.ply').n_faces > 1000
    True
    """
    if hasattr(path, "read"):
        return _read_open(path, format, window, close_gap, drop_nonfinite, threads, memory_limit, progress)
    path = os.fsdecode(path)
    kind = format_of(path, format)
    if kind in MESH_FORMATS + GRID_FORMATS + SECTION_FORMATS:
        beside = path + ".json" if kind in _BESIDE and os.path.isfile(path + ".json") else None
        return _loads(read_bytes(path), kind, window, None if beside is None else read_bytes(beside), close_gap, drop_nonfinite,
                      threads, memory_limit, progress, folder=os.path.dirname(os.path.abspath(path)))
    if window is not None or close_gap is not None or drop_nonfinite:
        raise ArgumentError("window is for grids, close_gap for sections, drop_nonfinite for .stl .obj .ply .off .glb .gltf .3mf")
    return call("read_other", path, kind)


def _plain(data: Any, kind: str, memory_limit: int | None) -> Any:
    """The bytes of a file as the library reads them, which has nothing to unpack."""
    if kind == "vti":
        return without_blocks(data, memory_limit)
    return unpacked(data, memory_limit) if kind == "nrrd" else mended(data, kind)


def _read_open(file: Any, format: str | None, window: WindowLike, close_gap: float | None, drop_nonfinite: bool, threads: int | None,
               memory_limit: int | None, progress: Progress) -> Any:
    """What stands in an open file, from where it is to its end."""
    data, kind = bytes_of_open(file, format)
    if data[:2] == b"\x1f\x8b":
        data = call("unpacking", data).read()
    return loads(data, kind, window=window, close_gap=close_gap,
                 drop_nonfinite=drop_nonfinite, threads=threads, memory_limit=memory_limit, progress=progress)


@entered
def loads(data: Any, format: str, *, window: WindowLike = None, lattice: bytes | None = None,
          close_gap: float | None = None, drop_nonfinite: bool = False, threads: int | None = None,
          memory_limit: int | None = None, progress: Progress = None) -> Found:
    """Read a mesh, a grid, an octree or sections from the bytes of a file: all that `read` reads of one file, in memory.

    Parameters
    ----------
    data
        the bytes.
    format
        an ending, such as "ply". Bytes of .nii, .vtp and others that other libraries read are laid into a file of their own first.
    window, close_gap, drop_nonfinite
        as for `read`.
    lattice
        the bytes of the FILE.json beside .npy and .vox.

    Raises
    ------
    FormatError
        what is wrong with which byte or line.
    UnsupportedError
        no such format.

    Examples
    --------
    >>> bitvox.loads(bitvox.dumps(bitvox.read('knot.ply'), 'off'), 'off').n_faces > 1000
    True
    """
    return _loads(data, format.lower().lstrip("."), window, lattice, close_gap, drop_nonfinite, threads, memory_limit, progress)


class _Beside:
    """Files in the folder of one that names them, held until it is read."""

    def __init__(self, folder: str) -> None:
        self.folder = folder
        self.held: list[Any] = []


@ffi.def_extern(error=1)
def bvxpy_open(user: Any, name: Any, file: Any) -> int:
    beside = ffi.from_handle(user)
    try:
        with open(os.path.join(beside.folder, ffi.string(name).decode("utf-8")), "rb") as found:
            data = ffi.from_buffer(found.read())
    except (OSError, UnicodeDecodeError):
        return 1
    beside.held.append(data)
    file.bytes, file.size = data, len(data)
    return 0


@ffi.def_extern()
def bvxpy_close(user: Any, file: Any) -> None:
    """What was opened goes with its `_Beside`."""


def _read_mesh(held: Any, kind: str, drop_nonfinite: bool, folder: str | None, run: Run) -> Mesh:
    mesh, report, options = new_mesh(), ffi.new("bvx_read_report *"), options_of("read_options")
    options.drop_nonfinite = int(bool(drop_nonfinite))
    options.report = report
    options.inflate = lib.bvxpy_inflate
    if folder is not None:
        handle = ffi.new_handle(_Beside(folder))
        options.open_file, options.close_file, options.user = lib.bvxpy_open, lib.bvxpy_close, handle
    run.check(lib.bvx_read_mesh(run.context, held, len(held), number_of(kind), options, mesh))
    if report.dropped:
        warnings.warn(f"{report.dropped} triangles with a corner that is not finite left out", stacklevel=5)
    lost = [text for bit, text in _LOST if report.lost & bit]
    if lost:
        warnings.warn(f"not read: {', '.join(lost)}", stacklevel=5)
    return Mesh._made(mesh)


def _loads(data: Any, kind: str, window: WindowLike, lattice: bytes | None, close_gap: float | None, drop_nonfinite: bool, threads: int | None,
           memory_limit: int | None, progress: Progress, folder: str | None = None) -> Any:
    if kind in OF_OTHERS:
        for name, given in (("window and lattice are for grids of the library's own formats", window is not None or lattice is not None),
                            ("close_gap is for sections", close_gap is not None), ("drop_nonfinite is for meshes", drop_nonfinite)):
            if given:
                raise ArgumentError(name)
        return by_file(data, kind, lambda path: call("read_other", path, kind))
    held = ffi.from_buffer(_plain(data, kind, memory_limit))
    if close_gap is not None and kind not in SECTION_FORMATS:
        raise ArgumentError("close_gap is for sections")
    if drop_nonfinite and kind not in MESH_FORMATS:
        raise ArgumentError("drop_nonfinite is for meshes")
    with Run(threads, memory_limit, progress) as run:
        if kind in MESH_FORMATS:
            if window is not None or lattice is not None:
                raise ArgumentError("window and lattice are for grids")
            return _read_mesh(held, kind, drop_nonfinite, folder, run)
        if kind in SECTION_FORMATS:
            if window is not None or lattice is not None:
                raise ArgumentError("window and lattice are for grids")
            return read_sections(held, number_of(kind), close_gap, run)
        if kind == "bvx" and bytes(ffi.buffer(held, min(4, len(held)))) == _TREE_MAGIC:
            if window is not None or lattice is not None:
                raise ArgumentError("window and lattice are for grids; this file holds an octree")
            tree = ffi.new("bvx_octree **")
            run.check(lib.bvx_read_octree(run.context, held, len(held), tree))
            return Octree(ffi.gc(tree[0], lib.bvxpy_free_octree))
        if kind in GRID_FORMATS:
            grid = new_grid()
            box = ffi.new("bvx_window *")
            set_window("window", box, window)
            run.check(lib.bvx_read_grid(run.context, held, len(held), number_of(kind), box if window is not None else ffi.NULL, grid))
            if lattice is not None:
                if window is not None:
                    raise ArgumentError("a window of a file with a lattice beside it: read it without, or read the .bvx")
                beside = ffi.from_buffer(lattice)
                run.check(lib.bvx_read_lattice(run.context, beside, len(beside), grid))
            return Grid._made(grid)
    raise UnsupportedError(f"format {kind!r} is not read; meshes: {', '.join(MESH_FORMATS)}; grids: {', '.join(GRID_FORMATS)}; " +
                           f"by other libraries: {', '.join(OF_OTHERS)}")


@entered
def dumps(thing: Any, format: str, *, states: Any = None, vectors: bool = False, normals: bool = False,
          origin: Any = None, allow_rounding: bool = False, up: str | None = None, quantize: bool = False,
          threads: int | None = None, memory_limit: int | None = None, progress: Progress = None) -> bytes:
    """The bytes of a file.

    Parameters
    ----------
    thing
        a mesh.
    format
        stl, obj, ply, off, glb or 3mf, with ``bitvox[view]`` vtp; a `Grid`: npy, binvox, vox, nrrd, vti, bvx, vdb, nvdb,
        mha or nii; a `Volume`: nrrd, mha, nii or vti; an `Octree`: vtu or bvx; a `Field`: npy, nrrd, vti, vdb or nvdb; `Sections`: csl or csv; an `Image`: png.
    states
        of an octree's vtu: which leaves, by default ("surface", "inside").
    vectors
        of a field: vectors in place of signed distances.
    normals
        of a mesh's ply or obj: also normals of the vertices, smooth ones averaged by area over sharp edges too; glb has them
        always, stl, off and 3mf are refused.
    origin
        of a mesh: (x, y, z) that is taken from all positions, for formats of 32-bit floats far from the origin.
    allow_rounding
        of a mesh: write stl or glb even where rounding to 32-bit floats spoils it; see `Mesh.check_written`.
    up
        of a mesh: "y", where z is up in it and y in the file: x, y, z become x, z, -y; "z", where y is up in it and z in the file:
        x, y, z become x, -z, y. By default coordinates stay as they are, in every format.
    quantize
        of a mesh's glb: positions of 16 bits and normals of 8, by KHR_mesh_quantization.

    Raises
    ------
    UnsupportedError
        a format that does not hold such a thing.
    RangeError
        sizes or numbers beyond what it holds, and a mesh that rounding would spoil.

    Examples
    --------
    >>> bitvox.dumps(bitvox.Grid.from_numpy(np.ones((2, 2, 2))), 'bvx')[1:4]
    b'BVX'
    """
    kind = format.lower().lstrip(".")
    out = ffi.gc(ffi.new("bvx_buffer *"), lib.bvxpy_free_buffer)
    if states is not None and not isinstance(thing, Octree):
        raise ArgumentError("states are for octrees")
    if vectors and not isinstance(thing, Field):
        raise ArgumentError("vectors are for fields")
    if isinstance(thing, (Grid, Octree, Field, Image, Sections, Volume)):
        for name, given in (("normals are", normals), ("origin is", origin is not None), ("allow_rounding is", allow_rounding),
                            ("up is", up is not None), ("quantize is", quantize)):
            if given:
                raise ArgumentError(f"{name} for meshes")
    if isinstance(thing, Volume) or (isinstance(thing, Grid) and kind in ("nii", "mha")):
        return bytes(call("volume_bytes", thing, kind) if isinstance(thing, Volume) else call("volume_bytes", volume_of_bits(thing), kind, True))
    if kind in MESHES_BY_LIBRARIES and not isinstance(thing, (Grid, Octree, Field, Image, Sections)):
        if normals or origin is not None or allow_rounding or up is not None or quantize:
            raise ArgumentError(f"normals, origin, allow_rounding, up and quantize are for {', '.join(MESH_OUTPUTS)}")
        return bytes(call("mesh_bytes", Mesh.of(thing), kind))
    with Run(threads, memory_limit, progress) as run:
        if isinstance(thing, Image) and kind == "png":
            return thing.png()
        if isinstance(thing, Grid) and kind in GRID_OUTPUTS:
            run.check(lib.bvx_write_grid(run.context, thing._c, number_of(kind), out))
        elif isinstance(thing, Octree) and kind in ("vtu", "bvx"):
            chosen = states_of(states) if kind == "vtu" else 0
            run.check(lib.bvx_write_octree(run.context, thing._c, chosen, number_of(kind), out))
        elif isinstance(thing, Sections) and kind in SECTION_OUTPUTS:
            run.check(function("bvx_write_sections")(run.context, thing._struct(run), number_of(kind), out))
        elif isinstance(thing, Field) and kind in FIELD_OUTPUTS:
            run.check(function("bvx_write_field")(run.context, thing._c, int(vectors), number_of(kind), out))
        elif kind in MESH_OUTPUTS and not isinstance(thing, (Grid, Octree, Field, Image, Sections)):
            mesh = Mesh.of(thing)._struct(run)
            subtract(mesh, origin)
            options = _write_options(normals=normals, allow_rounding=allow_rounding, up=up, quantize=quantize)
            run.check(lib.bvx_write_mesh(run.context, mesh, 1, options, number_of(kind), out))
        else:
            raise UnsupportedError(f"{type(thing).__name__} is not written as {format!r}; {_outputs(thing)}")
    data = bytes(ffi.buffer(out.bytes, out.size))
    return named(data, thing, kind) if isinstance(thing, Sections) else data


def _write_options(*, normals: bool = False, allow_rounding: bool = False, up: str | None = None, quantize: bool = False) -> Any:
    """What `dumps` and `write_levels` say of meshes."""
    turns = {None: lib.BVX_TURN_NONE, "y": lib.BVX_TURN_Z_TO_Y, "z": lib.BVX_TURN_Y_TO_Z}
    if up not in turns:
        raise ArgumentError(f"up is {up!r}; it must be 'y', 'z' or None")
    options = options_of("write_options")
    options.normals = int(bool(normals))
    options.rounding = int(bool(allow_rounding))
    options.turn = turns[up]
    options.quantize = int(bool(quantize))
    return options


def _outputs(thing: Any) -> str:
    """What a thing is written as."""
    known = {"Grid": (*GRID_OUTPUTS, "mha", "nii"), "Volume": ("nrrd", "mha", "nii", "vti"), "Octree": ("vtu", "bvx"), "Field": FIELD_OUTPUTS, "Sections": SECTION_OUTPUTS, "Image": ("png",)}
    endings = ", ".join(known.get(type(thing).__name__, (*MESH_OUTPUTS, *MESHES_BY_LIBRARIES)))
    other = ", or grid.surface().save(...) for a mesh" if isinstance(thing, Grid) else "" if type(thing).__name__ in known else ", or to_trimesh().export(...)"
    return f"take one of {endings}{other}"


def write_levels(path: str | os.PathLike[str], levels: Iterable[Any], *, up: str | None = None, quantize: bool = False,
                 threads: int | None = None, memory_limit: int | None = None, progress: Progress = None) -> None:
    """Write levels of detail to one .glb file, whole or not at all::

        bitvox.write_levels("dragon.glb", bitvox.lod("dragon.ply", levels=(64, 32, 16)))

    Each level is a node, ``level_0``, ``level_1``, ... and a mesh of its own. glTF itself has no levels of detail: they are tied
    together by the vendor extension MSFT_lod, which few readers know. Viewers without it show level_0 alone.

    Parameters
    ----------
    path
        a name that ends in .glb, or .glb.gz, which packs it.
    levels
        meshes, the finest first; with colors and uvs or without, as each is.
    up, quantize
        as for `dumps`.

    Raises
    ------
    UnsupportedError
        another format: write one file a level.
    EmptyError
        a level without faces.
    RangeError
        levels beyond what the format holds (4 GiB).

    Examples
    --------
    >>> bitvox.write_levels('knot.glb', bitvox.lod('knot.ply', triangles=(800, 200)))
    """
    path = os.fsdecode(path)
    kind = format_of(path, None)
    if kind != "glb":
        raise UnsupportedError(f"{path}: levels of detail are not written as {kind!r}; take .glb, or write one file a level")
    if isinstance(levels, Mesh):
        raise TypeError("levels are several meshes, not one; Mesh.save writes one")
    with Run(threads, memory_limit, progress) as run:
        _write_meshes(run, path, [Mesh.of(level) for level in levels], _write_options(up=up, quantize=quantize))


def _write_meshes(run: Run, path: str, meshes: Sequence[Mesh], options: Any) -> None:
    """One .glb of several meshes."""
    out = ffi.gc(ffi.new("bvx_buffer *"), lib.bvxpy_free_buffer)
    borrowed = [mesh._struct(run) for mesh in meshes]
    array = ffi.new("bvx_mesh[]", max(len(borrowed), 1))
    for i, one in enumerate(borrowed):
        array[i] = one[0]
    run.check(lib.bvx_write_mesh(run.context, array, len(borrowed), options, lib.BVX_FORMAT_GLB, out))
    write_bytes(path, bytes(ffi.buffer(out.bytes, out.size)))


@entered
def write_named(path: str, bodies: Sequence[tuple[Segment, Mesh]]) -> None:
    """Nodes of one .glb, each with its name and color."""
    options = _write_options()
    texts = [ffi.new("char[]", one.name.encode(errors="replace").replace(b"\0", b"?")) for one, _ in bodies]
    options.names = names = ffi.new("char *[]", texts)
    options.colours = colors = ffi.new("uint8_t[]", [part for one, _ in bodies for part in (*(one.color or (255,) * 3), 255)])
    with Run() as run:
        _write_meshes(run, path, [mesh for _, mesh in bodies], options)
    del names, colors  # held until now


@entered
def write(thing: Any, path: str | os.PathLike[str], *, format: str | None = None, states: Any = None, vectors: bool = False,
          normals: bool = False, origin: Any = None, allow_rounding: bool = False, up: str | None = None, quantize: bool = False,
          threads: int | None = None, memory_limit: int | None = None, progress: Progress = None) -> None:
    """Write a mesh, grid, octree, field, volume or image to a file, whole or not at all.

    Parameters
    ----------
    thing
        what `dumps` takes.
    path
        its ending gives the format; .gz packs it. Beside .npy and .vox of a grid, FILE.json gets the lattice.
    format
        the format, in place of the name's ending.
    states
        of an octree: which leaves, by default ("surface", "inside").
    vectors
        of a field: vectors in place of signed distances.
    normals, origin, allow_rounding, up, quantize
        of a mesh: as for `dumps`.

    Examples
    --------
    >>> bitvox.write(bitvox.voxelize('knot.ply', resolution=32), 'solid.nrrd')
    >>> bitvox.read('solid.nrrd').shape[0]
    31
    """
    path = os.fsdecode(path)
    kind = format_of(path, format)
    data = dumps(thing, kind, states=states, vectors=vectors, normals=normals, origin=origin, allow_rounding=allow_rounding, up=up,
                 quantize=quantize, threads=threads, memory_limit=memory_limit, progress=progress)
    placed = thing.band if hasattr(thing, "band") else thing
    beside = lattice_json(placed) if isinstance(placed, Grid) and kind in _BESIDE else None
    write_bytes(path, data)
    if beside is not None:
        write_bytes(path + ".json", beside)


def write_labels(path: str | os.PathLike[str], grid: Grid, labels: Any, palette: Any, *, format: str | None = None) -> None:
    """Write a grid whose voxels have labels with colors: a .vox with its palette, or a .nrrd with 3D Slicer's segments.

    Parameters
    ----------
    path
        its ending gives the format, unless ``format`` does. Beside .vox FILE.json gets the lattice.
    grid
        which voxels are set; they have the labels 1 to 255.
    labels
        uint8 ``[x, y, z]``, as of `label_voxels`; 0 elsewhere.
    palette
        red, green, blue (and alpha) of label i in row i.

    Examples
    --------
    >>> grid = bitvox.Grid.from_numpy(np.ones((2, 2, 2)))
    >>> bitvox.write_labels('red.vox', grid, np.ones((2, 2, 2)), [(0, 0, 0), (255, 0, 0)])
    >>> bitvox.read_labels('red.vox')[1][1].tolist()
    [255, 0, 0, 255]
    """
    np = arrays.numpy("write_labels")
    path = os.fsdecode(path)
    kind = format_of(path, format)
    held = np.ascontiguousarray(np.asarray(labels).transpose(), np.uint8)
    rows, colors = np.asarray(palette, np.uint8), np.full((256, 4), 255, np.uint8)
    if held.shape != tuple(grid.shape[::-1]):
        raise ArgumentError(f"labels have the shape {held.shape[::-1]}, the grid has {tuple(grid.shape)}")
    if rows.ndim != 2 or rows.shape[0] > 256 or rows.shape[1] not in (3, 4):
        raise ArgumentError(f"palette has the shape {rows.shape}; it must be at most 256 rows of 3 or 4 numbers")
    colors[: len(rows), : rows.shape[1]] = rows
    out = ffi.gc(ffi.new("bvx_buffer *"), lib.bvxpy_free_buffer)
    with Run() as run:
        run.check(lib.bvx_write_labels(run.context, grid._c, ffi.from_buffer("uint8_t[]", held), ffi.from_buffer("uint8_t[]", colors), number_of(kind), out))
    write_bytes(path, bytes(ffi.buffer(out.bytes, out.size)))
    if kind in _BESIDE:
        write_bytes(path + ".json", lattice_json(grid))


def read_labels(path: str | os.PathLike[str]) -> tuple[Any, Any]:
    """Labels and colors of a .vox, whose voxels ``bitvox.read`` gives as a grid: uint8 ``[x, y, z]`` and ``[256, 4]``.

    Parameters
    ----------
    path
        of the .vox.

    Examples
    --------
    >>> grid = bitvox.voxelize('knot.ply', resolution=16)
    >>> grid.save('knot.vox')  # without colors: white
    >>> labels, palette = bitvox.read_labels('knot.vox')
    >>> labels.shape == grid.shape, int(labels.max()), palette[1].tolist()
    (True, 1, [255, 255, 255, 255])
    """
    np = arrays.numpy("read_labels")
    data, palette, grid = read_bytes(path), np.zeros((256, 4), np.uint8), new_grid()
    held, out = ffi.from_buffer(data), ffi.gc(ffi.new("bvx_buffer *"), lib.bvxpy_free_buffer)
    with Run() as run:
        kind = number_of(format_of(os.fsdecode(path), None))
        run.check(lib.bvx_read_labels(run.context, held, len(held), kind, out, ffi.from_buffer("uint8_t[]", palette)))
        run.check(lib.bvx_read_grid(run.context, held, len(held), kind, ffi.NULL, grid))
    shape = Grid._made(grid).shape
    return np.frombuffer(bytes(ffi.buffer(out.bytes, out.size)), np.uint8).reshape(shape[::-1]).transpose(2, 1, 0).copy("K"), palette


def lattice_json(grid: Grid) -> bytes:
    """The side-car of a format that keeps no lattice."""
    out = ffi.gc(ffi.new("bvx_buffer *"), lib.bvxpy_free_buffer)
    with Run() as run:
        run.check(lib.bvx_write_lattice(run.context, grid._c, out))
    return bytes(ffi.buffer(out.bytes, out.size))


class Writer:
    """Writes a .bvx file slice by slice, so that the whole grid is never in memory::

        with bitvox.Writer("huge.bvx", lattice) as writer:
            for part in parts:          # windows of the lattice, whole in x and y, one on the other in z
                writer.add(part)

    Parameters
    ----------
    path
        of the file; nothing is there until all slices are given.
    lattice
        of the whole.
    window
        the box of it that is written; None: all.

    Raises
    ------
    ArgumentError
        a part that does not begin where the last one ended; slices that were not given.

    Examples
    --------
    >>> grid = bitvox.voxelize('knot.ply', resolution=16)
    >>> with bitvox.Writer('a.bvx', grid.lattice) as writer:
    ...     writer.add(grid)
    >>> bitvox.read('a.bvx') == grid
    True
    """

    def __init__(self, path: str | os.PathLike[str], lattice: Any, window: WindowLike = None) -> None:
        self._path = os.path.realpath(os.fspath(path))
        box = ffi.new("bvx_window *")
        set_window("window", box, window)
        self._low = box.low[2]
        self._end = self._low + (box.size[2] or lattice.shape[2])
        self._at = self._low
        head = self._bytes(lambda run, out: lib.bvx_write_head(run.context, lattice._c, box if window is not None else ffi.NULL, out))
        handle, self._beside = new_beside(self._path)
        self._file = os.fdopen(handle, "wb")
        self._file.write(head)

    @staticmethod
    def _bytes(make: Any) -> bytes:
        out = ffi.gc(ffi.new("bvx_buffer *"), lib.bvxpy_free_buffer)
        with Run() as run:
            run.check(make(run, out))
        return bytes(ffi.buffer(out.bytes, out.size))

    def add(self, part: Grid) -> None:
        """The next slices: a ``part`` as wide and deep as the whole, on top of the last one.

        Examples
        --------
        >>> grid = bitvox.Grid.from_numpy(np.ones((2, 2, 4)))
        >>> with bitvox.Writer('b.bvx', grid.lattice) as writer:
        ...     writer.add(grid.crop(((0, 0, 0), (2, 2, 3))))
        ...     writer.add(grid.crop(((0, 0, 3), (2, 2, 1))))
        """
        if part.low[2] != self._at:
            raise ArgumentError(f"this part begins at slice {part.low[2]}; {self._at} is next")
        self._file.write(self._bytes(lambda run, out: lib.bvx_write_slices(run.context, part._c, out)))
        self._at += part.shape[2]

    def __enter__(self) -> Writer:
        return self

    def __exit__(self, kind: Any, *_: object) -> None:
        self._file.close()
        if kind is None and self._at == self._end:
            os.chmod(self._beside, 0o666 & ~umask())
            os.replace(self._beside, self._path)
            return
        os.unlink(self._beside)
        if kind is None:
            raise ArgumentError(f"{self._path}: slices {self._at} to {self._end - 1} were not given; nothing is written")


__all__ = ["Writer", "dumps", "loads", "read", "write", "write_levels"]
