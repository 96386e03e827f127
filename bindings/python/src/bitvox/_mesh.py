"""Meshes: what users have, what the library makes."""

from __future__ import annotations

import os
from array import array as plain_array
from typing import TYPE_CHECKING, Any, ClassVar, Sequence, overload

from . import _arrays as arrays
from ._calls import call, entered
from ._errors import ArgumentError, RangeError, need
from ._html import shown
from ._records import record
from ._run import Progress, Run, choice, ffi, in_range, lib, number_of, options_of, quiet
from ._words import Array, MeshReport

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._words import Collapsing, SmoothMethod
    from .reports import Certificate, MeasureReport, WriteReport

_POSITIONS = {"float32": "BVX_F32", "float64": "BVX_F64"}


def position_type(dtype: Any) -> int:
    """BVX_F32 or BVX_F64 from "float32", "float64", their numpy types or their short names."""
    name = getattr(dtype, "__name__", None) or getattr(dtype, "name", None) or str(dtype)
    name = {"f32": "float32", "f64": "float64", "f4": "float32", "f8": "float64", "float": "float64"}.get(name, name)
    if name not in _POSITIONS:
        raise ArgumentError(f"dtype is {dtype!r}; it must be float32 or float64")
    return getattr(lib, _POSITIONS[name])


class Mesh:
    """Triangles: vertices (n, 3) [world] and faces (m, 3) of vertex indices, counter-clockwise seen from outside.

    Arrays that are given are kept, not copied, where the library can read them as they lie in memory: vertices as float32 or
    float64 with any distance between rows, faces as 16- to 64-bit integers. Other types are copied: integers
    become float64, both exactly or with an error. Do not change arrays while a call works on them.

    Parameters
    ----------
    vertices
        (n, 3), or (m, 3, 3): the corners of m triangles, without faces.
    faces
        (m, 3) integers, each below n. None: vertices 3t, 3t+1, 3t+2 are triangle t.
    colors
        (n, 3) or (n, 4), 0..255 or floats 0..1; pictures show them, files and levels of detail keep them.
    uvs
        (k, 2) texture coordinates; ``uv_faces`` (m, 3) numbers into them, or None when k is n.
    normals
        (n, 3) normals of the vertices, kept as `vertex_normals`.
    uvs2
        (n, 2) second texture coordinates.
    materials
        (m,) index of each triangle's material.
    frame
        added to the vertices when the mesh was made about a local origin [world].

    Raises
    ------
    ArgumentError
        shapes that do not fit.
    TypeError
        values that are not numbers.
    RangeError
        integers that would lose digits; vertex indices below 0 or beyond the vertices (by the call that uses
        them).

    Examples
    --------
    >>> mesh = bitvox.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
    >>> mesh
    Mesh(4 vertices, 4 faces)
    >>> mesh.check().volume
    0.16666666666666666
    """

    __slots__ = ("_vertices", "_faces", "_colors", "_uvs", "_uv_faces", "_uvs2", "_normals", "_materials", "_assets", "_keys", "frame", "report", "__weakref__")

    def __init__(self, vertices: Any, faces: Any = None, *, colors: Any = None, uvs: Any = None, uv_faces: Any = None,
                 normals: Any = None, uvs2: Any = None, materials: Any = None,
                 frame: Sequence[float] = (0.0, 0.0, 0.0)) -> None:
        if faces is None and getattr(vertices, "ndim", 0) == 3:
            vertices = vertices.reshape(-1, 3)
        if isinstance(vertices, (Mesh, str, os.PathLike)) or hasattr(vertices, "vertices"):
            raise TypeError(f"vertices are wanted, not a {type(vertices).__name__}: Mesh.of takes meshes and files")
        self._vertices = arrays.vertices_in(vertices)
        if faces is None:
            if len(self._vertices) % 3:
                raise ArgumentError(f"without faces, vertices come in threes; there are {len(self._vertices)}")
            self._faces = None
        else:
            self._faces = arrays.faces_in(faces, len(self._vertices))
        self._colors: Any = arrays.colors_in(colors, len(self._vertices))
        self._uvs: Any = None
        self._uvs2: Any = arrays.floats_in("uvs2", uvs2, len(self._vertices), 2)
        self._normals: Any = arrays.floats_in("normals", normals, len(self._vertices), 3)
        self._materials: Any = arrays.materials_in(materials, self.n_faces)
        self._assets: Any = None
        self._uv_faces: Any = None
        if uvs is not None:
            self._set_uvs(uvs, uv_faces)
        elif uv_faces is not None:
            raise ArgumentError("uv_faces are given without uvs")
        self._keys: tuple[Any, Any] | None = None
        self.frame: tuple[float, float, float] = arrays.triple("frame", frame)
        self.report: MeshReport = None  # type: ignore[assignment]

    def _set_uvs(self, uvs: Any, uv_faces: Any) -> None:
        np = arrays.numpy("texture coordinates")
        found = np.ascontiguousarray(arrays.as_numpy(uvs, "uvs"), np.float32)
        if found.ndim != 2 or found.shape[1] != 2 or (uv_faces is None and len(found) != len(self._vertices)):
            raise ArgumentError(f"uvs have shape {found.shape}; they must be (n, 2), with uv_faces (k, 2)")
        self._uvs = found
        if uv_faces is not None:
            numbers = arrays.faces_in(uv_faces, len(found))
            if len(numbers) != self.n_faces or (numbers.size and (int(numbers.min()) < 0 or int(numbers.max()) >= len(found))):
                raise RangeError("uv_faces must be (m, 3) numbers into uvs")
            self._uv_faces = np.ascontiguousarray(numbers, np.uint32)

    @classmethod
    def _made(cls, owner: Any) -> Mesh:
        """A mesh over the arrays of a bvx_mesh that the library made."""
        self = cls.__new__(cls)
        n, m = owner.vertex_count, owner.triangle_count
        dtype = "float32" if owner.position_type == lib.BVX_F32 else "float64"
        self._vertices = arrays.array_at(owner.positions, dtype, (n, 3), owner, writable=True)
        self._faces = arrays.array_at(owner.triangles, "uint32", (m, 3), owner, writable=True)
        self._colors = self._uvs = self._uv_faces = self._uvs2 = self._keys = self._normals = self._materials = None
        self._assets = owner if owner.assets != ffi.NULL else None
        if owner.normals != ffi.NULL:
            self._normals = arrays.array_at(owner.normals, "float32", (n, 3), owner, writable=True)
        if owner.uvs2 != ffi.NULL:
            self._uvs2 = arrays.array_at(owner.uvs2, "float32", (n, 2), owner, writable=True)
        if owner.materials != ffi.NULL:
            self._materials = arrays.array_at(owner.materials, "uint32", (m,), owner, writable=True)
        if owner.colours != ffi.NULL:
            self._colors = arrays.array_at(owner.colours, "uint8", (n, 4), owner, writable=True)
        if owner.uvs != ffi.NULL:
            by_vertex = owner.uv_triangles == ffi.NULL
            self._uvs = arrays.array_at(owner.uvs, "float32", (n if by_vertex else owner.uv_count, 2), owner, writable=True)
            if not by_vertex:
                self._uv_faces = arrays.array_at(owner.uv_triangles, "uint32", (m, 3), owner, writable=True)
        if owner.vertex_keys != ffi.NULL and owner.triangle_keys != ffi.NULL:
            self._keys = (arrays.array_at(owner.vertex_keys, "uint64", (n,), owner),
                          arrays.array_at(owner.triangle_keys, "uint64", (m,), owner))
        self.frame = tuple(owner.frame)
        self.report = None  # type: ignore[assignment]
        return self

    @classmethod
    def of(cls, source: Any) -> Mesh:
        """A mesh from what a user has, without a copy where possible.

        Parameters
        ----------
        source
            a `Mesh`; (vertices, faces); a trimesh Trimesh or Scene; a PyVista PolyData; an Open3D mesh, legacy or
            tensor; a meshio Mesh; a file's name. Faces with more than three corners must be convex: they become fans.

        Examples
        --------
        >>> bitvox.Mesh.of('knot.ply').check().closed
        True
        """
        if isinstance(source, cls):
            return source
        with quiet():
            return call("mesh_from", source)

    # ---- what it holds ----

    @property
    def vertices(self) -> Array:
        """(n, 3) float32 or float64 [world, less `frame`]; a memoryview of that shape without numpy."""
        return self._vertices

    @property
    def faces(self) -> Array:
        """(m, 3) vertex indices, uint32 where the library made them."""
        if self._faces is None:
            np = arrays.numpy("numbering vertices")
            self._faces = np.arange(len(self._vertices), dtype=np.uint32).reshape(-1, 3)
        return self._faces

    @property
    def colors(self) -> Array | None:
        """(n, 4) uint8 red, green, blue, alpha, or None."""
        return self._colors

    @property
    def uvs(self) -> Array | None:
        """(k, 2) float32 texture coordinates, or None."""
        return self._uvs

    @property
    def uv_faces(self) -> Array | None:
        """(m, 3) uint32 numbers into `uvs`, or None: each vertex has the coordinates of its own number."""
        return self._uv_faces

    @property
    def uvs2(self) -> Array | None:
        """(n, 2) float32 second texture coordinates, or None."""
        return self._uvs2

    @property
    def vertex_normals(self) -> Array | None:
        """(n, 3) float32 normals as they were given, or as a glTF file has them, or None; `normals` computes them."""
        return self._normals

    @property
    def materials(self) -> Array | None:
        """(m,) uint32 indices of materials, of a glTF file's where it was read from one, or None; a face without one has the index
        after the last."""
        return self._materials

    @property
    def keys(self) -> tuple[Any, Any] | None:
        """Canonical keys of vertices and of triangles' cells, uint64, where they were requested; else None."""
        return self._keys

    @property
    def n_vertices(self) -> int:
        """How many vertices there are."""
        return len(self._vertices)

    @property
    def n_faces(self) -> int:
        """How many triangles there are."""
        return len(self._vertices) // 3 if self._faces is None else len(self._faces)

    def astype(self, vertices: Any = None, faces: Any = None) -> Mesh:
        """The same mesh with arrays of other types: ``mesh.astype("float64", "int64")`` is what trimesh works with.

        Parameters
        ----------
        vertices
            float32 or float64.
        faces
            uint32, int32, uint64, int64. None leaves them. Numbers that do not fit are
            an error.

        Examples
        --------
        >>> bitvox.Mesh.of('knot.ply').astype('float64', 'int64').faces.dtype.name
        'int64'
        """
        np = arrays.numpy("astype")
        other = Mesh.__new__(Mesh)
        other._vertices = self._vertices if vertices is None else np.asarray(self._vertices).astype(vertices, copy=False)
        found = np.asarray(self.faces)
        if faces is not None:
            if found.size and int(found.max()) > np.iinfo(faces).max:
                raise RangeError(f"vertex {found.max()} does not fit {np.dtype(faces)}")
            found = found.astype(faces, copy=False)
        other._faces = found
        other._colors, other._uvs, other._uv_faces = self._colors, self._uvs, self._uv_faces
        other._uvs2, other._normals, other._materials, other._assets = self._uvs2, self._normals, self._materials, self._assets
        other._keys, other.frame, other.report = self._keys, self.frame, self.report
        return other

    def _with_vertices(self, vertices: Any) -> Mesh:
        """The same mesh with other positions."""
        other = self.astype()
        other._normals = None  # of the surface that it was
        other._vertices = arrays.vertices_in(vertices)
        return other

    def _part(self, chosen: Any) -> Mesh:
        """These triangles with the vertices and attributes that they use."""
        np = arrays.numpy("parts of meshes")
        used, numbers = np.unique(np.asarray(self.faces)[chosen], return_inverse=True)
        other = self.astype()
        other._vertices, other._faces = np.asarray(self._vertices)[used], numbers.reshape(-1, 3).astype(np.uint32)
        for name in ("_colors", "_normals", "_uvs2", *(("_uvs",) if self._uv_faces is None else ())):
            values = getattr(self, name)
            setattr(other, name, None if values is None else np.asarray(values)[used])
        for name in ("_materials", "_uv_faces"):
            values = getattr(self, name)
            setattr(other, name, None if values is None else np.ascontiguousarray(np.asarray(values)[chosen]))
        other._keys = other.report = None  # type: ignore[assignment]
        return other

    def _pieces(self) -> list[Any]:
        """Indices of the triangles of each piece, the one of most area first."""
        np = arrays.numpy("pieces of meshes")
        faces = np.asarray(self.faces).astype(np.int64)
        arrays.refuse_negative(faces)
        if faces.size and int(faces.max()) >= self.n_vertices:
            raise RangeError(f"vertex index {faces.max()}, but there are {self.n_vertices} vertices")
        label, before = np.arange(self.n_vertices), None
        while before is None or (label != before).any():  # each vertex takes the least label around it, then that one's own
            before = label.copy()
            np.minimum.at(label, faces, label[faces].min(axis=1, keepdims=True))
            label = label[label]
        _, piece = np.unique(label[faces[:, 0]], return_inverse=True)
        a, b, c = (self.in_world()[faces[:, k]] for k in range(3))
        area = np.bincount(piece, np.linalg.norm(np.cross(b - a, c - a), axis=1))
        parts = np.split(np.argsort(piece, kind="stable"), np.cumsum(np.bincount(piece))[:-1])
        return [parts[i] for i in np.argsort(-area, kind="stable")]

    def split(self) -> list[Mesh]:
        """The pieces of the mesh, which share no vertex, the one of most area first, each with its attributes.

        Examples
        --------
        >>> grid = bitvox.Grid.from_numpy(np.array([[[1, 0, 1, 1]]]))
        >>> len(grid.surface().split())
        2
        """
        return [self._part(piece) for piece in self._pieces()]

    def keep(self, *, largest: int) -> Mesh:
        """The pieces of most area, as `split` has them, in one mesh. The wall of a cavity is a piece of its own.

        Parameters
        ----------
        largest
            so many.

        Examples
        --------
        >>> bitvox.read('knot.ply').keep(largest=1).check().components
        1
        """
        np = arrays.numpy("Mesh.keep")
        pieces = self._pieces()[: in_range("largest", largest, 1, 2**63 - 1)]
        return self._part(np.sort(np.concatenate(pieces))) if pieces else self

    def drop_nonfinite(self) -> Mesh:
        """A copy without vertices that are NaN or infinite and without the triangles that use them, which every other call
        refuses; ``mesh.n_faces`` less that of the copy is how many went.

        Raises
        ------
        RangeError
            a vertex index beyond the vertices.

        Examples
        --------
        >>> bitvox.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [np.nan, 0, 1]], [[0, 1, 2], [0, 1, 3]]).drop_nonfinite().n_faces
        1
        """
        np = arrays.numpy("drop_nonfinite")
        faces = np.asarray(self.faces)
        arrays.refuse_negative(faces)
        if faces.size and int(faces.max()) >= self.n_vertices:
            raise RangeError(f"vertex index {faces.max()}, but there are {self.n_vertices} vertices")
        other = Mesh(np.array(self._vertices, order="C"), np.array(faces, np.uint32, order="C"), frame=self.frame)
        if self._colors is not None:
            other._colors = np.array(self._colors)
        if self._uvs is not None:
            other._uvs = np.array(self._uvs)
            other._uv_faces = None if self._uv_faces is None else np.array(self._uv_faces)
        other._uvs2 = None if self._uvs2 is None else np.array(self._uvs2)
        other._normals = None if self._normals is None else np.array(self._normals)
        other._materials, other._assets = None if self._materials is None else np.array(self._materials), self._assets
        with Run() as run:
            mesh, dropped = other._struct(run), ffi.new("uint64_t *")
            run.check(lib.bvx_mesh_drop_nonfinite(run.context, mesh, dropped))
            n, m = mesh.vertex_count, mesh.triangle_count
        other._vertices, other._faces = other._vertices[:n], other.faces[:m]
        if other._colors is not None:
            other._colors = other._colors[:n]
        if other._normals is not None:
            other._normals = other._normals[:n]
        if other._uvs2 is not None:
            other._uvs2 = other._uvs2[:n]
        if other._materials is not None:
            other._materials = other._materials[:m]
        if other._uv_faces is not None:
            other._uv_faces = other._uv_faces[:m]
        elif other._uvs is not None:
            other._uvs = other._uvs[:n]
        return other

    # ---- for the library ----

    def _view(self, run: Run) -> Any:
        """A bvx_mesh_view; run keeps what it points at."""
        view = ffi.new("bvx_mesh_view *")
        v = arrays.borrow_vertices(self.in_world() if any(self.frame) else self._vertices)
        run.keep(v.keep)
        view.positions, view.vertex_count, view.position_type, view.position_stride = v.pointer, v.count, v.kind, v.stride
        if self._faces is None:
            view.triangle_count = v.count // 3
        else:
            f = arrays.borrow_faces(self._faces)
            if f.count == 0:
                f.pointer = v.pointer  # no triangle, where NULL would stand for soup
            view.indices, view.triangle_count, view.index_type, view.index_stride = f.pointer, f.count, f.kind, f.stride
        if self._colors is not None:
            view.colours = ffi.cast("uint8_t *", arrays.address(self._colors))
        run.meshes.append(self)
        return view

    def _view_of_all(self, run: Run) -> Any:
        """The same with all attributes, for levels that have them too."""
        view = self._view(run)
        for name, kind, values in (("normals", "float *", self._normals), ("uvs", "float *", self._uvs), ("uvs2", "float *", self._uvs2),
                                   ("uv_indices", "uint32_t *", self._uv_faces), ("materials", "uint32_t *", self._materials)):
            if values is not None:
                setattr(view, name, ffi.cast(kind, arrays.address(values)))
        view.uv_count = 0 if self._uvs is None else len(self._uvs)
        return view

    def _struct(self, run: Run) -> Any:
        """A bvx_mesh over packed arrays, for the functions that take one."""
        np = arrays.numpy_or_none()
        keep = []
        mesh = ffi.new("bvx_mesh *")
        positions: Any = self._vertices
        faces: Any = self.faces
        if np is not None:
            positions = np.ascontiguousarray(positions)
            arrays.refuse_negative(faces)
            if faces.dtype.itemsize > 4 and faces.size and int(faces.max()) >= 2**32:
                raise RangeError(f"vertex index {faces.max()} does not fit 32 bits")
            faces = np.ascontiguousarray(faces, np.uint32)
        elif faces.itemsize != 4:
            faces = memoryview(plain_array("I", [i for row in faces.tolist() for i in row]))
        borrowed = arrays.borrow_vertices(positions)
        mesh.positions, mesh.position_type = borrowed.pointer, borrowed.kind
        mesh.triangles = ffi.cast("uint32_t *", arrays.address(faces))
        mesh.vertex_count = mesh.vertex_capacity = self.n_vertices
        mesh.triangle_count = mesh.triangle_capacity = self.n_faces
        mesh.frame = self.frame
        keep += [positions, faces]
        if self._colors is not None:
            mesh.colours = ffi.cast("uint8_t *", arrays.address(self._colors))
        if self._uvs is not None:
            mesh.uvs = ffi.cast("float *", arrays.address(self._uvs))
            mesh.uv_count = len(self._uvs)
            if self._uv_faces is not None:
                mesh.uv_triangles = ffi.cast("uint32_t *", arrays.address(self._uv_faces))
        if self._normals is not None:
            mesh.normals = ffi.cast("float *", arrays.address(self._normals))
        if self._uvs2 is not None:
            mesh.uvs2 = ffi.cast("float *", arrays.address(self._uvs2))
        if self._materials is not None:
            mesh.materials = ffi.cast("uint32_t *", arrays.address(self._materials))
        if self._assets is not None:
            mesh.assets = self._assets.assets
        if self._keys is not None:
            mesh.vertex_keys = ffi.cast("uint64_t *", arrays.address(self._keys[0]))
            mesh.triangle_keys = ffi.cast("uint64_t *", arrays.address(self._keys[1]))
        run.meshes.append(self)
        run.keep(keep)
        return mesh

    def _refuse_negative_faces(self) -> None:
        arrays.refuse_negative(self._faces)

    # ---- questions ----

    @property
    def bounds(self) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
        """Low and high corner of the vertices: ((x, y, z), (x, y, z)) [world]."""
        if not len(self._vertices):
            return (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
        np = arrays.numpy_or_none()
        if np is not None:
            low, high = self._vertices.min(axis=0), self._vertices.max(axis=0)
        else:
            rows = self._vertices.tolist()
            low, high = [min(r[i] for r in rows) for i in range(3)], [max(r[i] for r in rows) for i in range(3)]
        (a, b, c), (d, e, f), (x, y, z) = map(float, low), map(float, high), self.frame
        return (a + x, b + y, c + z), (d + x, e + y, f + z)

    @property
    def volume(self) -> float:
        """What the faces enclose, negative where they face inwards [world^3]; of an open mesh as if its borders were closed from the
        origin: see `is_closed`. Each access checks the whole mesh; `check` gives all at once."""
        return self.check().volume

    @property
    def area(self) -> float:
        """Of all faces [world^2]."""
        return self.check().area

    @property
    def is_closed(self) -> bool:
        """Whether every edge has a face on each of its sides: no borders."""
        return bool(self.check().closed)

    def transform(self, matrix: Any) -> Mesh:
        """A copy in another place: ``matrix`` (4, 4), or (3, 3) without a shift, is applied to all vertices. A mirror turns the faces,
        so that they still look outwards.

        Raises
        ------
        ArgumentError
            a matrix of another shape, one that flattens, or one whose last row is not 0 0 0 1.

        Examples
        --------
        >>> mesh = bitvox.read('knot.ply').transform([[2, 0, 0, 5], [0, 2, 0, 0], [0, 0, 2, 0], [0, 0, 0, 1]])
        >>> round(mesh.volume / bitvox.read('knot.ply').volume, 3)
        8.0
        """
        np = arrays.numpy("Mesh.transform")
        full = arrays.matrix_in(matrix)
        made = self._with_vertices(arrays.moved_by(full, self.in_world()).astype(np.asarray(self._vertices).dtype))
        made.frame, made._keys, made.report = (0.0, 0.0, 0.0), None, None  # type: ignore[assignment]
        if np.linalg.det(full[:3, :3]) < 0:
            made._faces = np.ascontiguousarray(np.asarray(made.faces)[:, ::-1])
            if made._uv_faces is not None:
                made._uv_faces = np.ascontiguousarray(made._uv_faces[:, ::-1])
        return made

    def check(self, *, weld: bool = False, threads: int | None = None, memory_limit: int | None = None,
              progress: Progress = None) -> Certificate:
        """What the mesh is: closed, edge_manifold, vertex_manifold, oriented, components, volume, area and counts.

        Parameters
        ----------
        weld
            take vertices at equal positions for one.

        Returns
        -------
        Certificate
            A `bitvox.reports.Certificate`.

        Examples
        --------
        >>> found = bitvox.read('knot.ply').check()
        >>> found.closed, found.oriented, found.components
        (True, True, 1)
        """
        out = ffi.new("bvx_certificate *")
        with Run(threads, memory_limit, progress) as run:
            run.check(lib.bvx_mesh_check(run.context, self._view(run), int(bool(weld)), out))
        return record(out)

    def check_written(self, format: str, *, origin: Any = None, quantize: bool = False, threads: int | None = None, memory_limit: int | None = None,
                      progress: Progress = None) -> WriteReport:
        """What readers of a file in a format get, without writing it: stl and glb hold 32-bit floats.

        Parameters
        ----------
        format
            stl, obj, ply, off or glb.
        origin, quantize
            as `bitvox.write` takes them.

        Returns
        -------
        WriteReport
            A `bitvox.reports.WriteReport`: ``file``, the certificate with the positions as the file rounds them; what rounding moves,
            merges and spoils; and whether `bitvox.write` takes it without ``allow_rounding``.

        Examples
        --------
        >>> bool(bitvox.read('knot.ply').check_written('stl').file.closed)
        True
        """
        out = ffi.new("bvx_write_report *")
        with Run(threads, memory_limit, progress) as run:
            mesh = self._struct(run)
            subtract(mesh, origin)
            options = options_of("write_options")
            options.quantize = int(bool(quantize))
            options.reports = out
            run.check(lib.bvx_write_mesh(run.context, mesh, 1, options, number_of(format.lower().lstrip(".")), ffi.NULL))
        return record(out)

    def crossings(self, *, threads: int | None = None, memory_limit: int | None = None, progress: Progress = None) -> Array:
        """Pairs of faces that cross: that have a common point which is neither a common vertex nor on a common edge.

        Vertices at equal positions are one. Touching is crossing, and so is an overlap in one plane or a face that is there
        twice; faces without area are left out. Exact, without a tolerance.

        Returns
        -------
        Array
            An (n, 2) uint32 array of face indices, the lower one first, in ascending order.

        Examples
        --------
        >>> len(bitvox.read('knot.ply').crossings())
        0
        """
        np = arrays.numpy("Mesh.crossings")
        count = ffi.new("uint64_t *")
        with Run(threads, memory_limit, progress, calls=2) as run:
            view = self._view(run)
            run.check(lib.bvx_mesh_crossings(run.context, view, count, ffi.NULL, 0))
            pairs = np.empty((count[0], 2), np.uint32)
            if len(pairs):
                pointer = ffi.cast("uint32_t *", arrays.address(pairs))
                run.check(lib.bvx_mesh_crossings(run.context, view, count, pointer, len(pairs)))
        return pairs

    def measure(self, *, density: float = 1.0, resolution: int | None = None, threads: int | None = None, memory_limit: int | None = None,
                progress: Progress = None) -> MeasureReport:
        """Volume, center of mass and inertia of the body that the mesh encloses, also of one with holes or flipped faces, with bounds of the errors.

        Parameters
        ----------
        density
            mass of a unit of volume.
        resolution
            voxels along each axis, of bodies that cannot be summed up exactly; None: 128.

        Returns
        -------
        MeasureReport
            A `bitvox.reports.MeasureReport`: ``volume``, ``mass``, ``center``, ``inertia`` (xx, yy, zz, xy, xz, yz about the center), and
            ``volume_error``, ``center_error``, ``inertia_error``.

        Raises
        ------
        ArgumentError
            a density that is not positive, a resolution beyond 1 to 2048.
        EmptyError
            no faces.
        RangeError
            coordinates.

        Examples
        --------
        >>> found = bitvox.read('knot.ply').measure(density=2700)
        >>> round(found.volume, 3), found.volume_error < 1e-9
        (28.906, True)
        """
        options, out = options_of("measure_options"), ffi.new("bvx_measure_report *")
        if not density > 0:
            raise ArgumentError(f"density is {density}; it must be above 0 and finite")
        options.density, options.resolution = density, in_range("resolution", 128 if resolution is None else resolution, 1, 2048)
        with Run(threads, memory_limit, progress) as run:
            run.check(lib.bvx_measure(run.context, self._view(run), options, out))
        made: MeasureReport = record(out)
        return made

    def normals(self, *, averaged: bool = False) -> tuple[Any, Any]:
        """Normals of length 1: (n, 3) of the vertices, facets counted by their areas, and (m, 3) of the facets; float32.

        Parameters
        ----------
        averaged
            a facet's is the mean of its three vertices' normals, not its own.

        Examples
        --------
        >>> vertices, facets = bitvox.read('knot.ply').normals()
        >>> vertices.shape[1]
        3
        """
        np = arrays.numpy("normals")
        vertices, facets = np.empty((self.n_vertices, 3), np.float32), np.empty((self.n_faces, 3), np.float32)
        with Run() as run:
            run.check(lib.bvx_mesh_normals(run.context, self._view(run), int(bool(averaged)),
                                           ffi.cast("float *", arrays.address(vertices)), ffi.cast("float *", arrays.address(facets))))
        return vertices, facets

    def smooth(self, *, method: SmoothMethod = "sinc", iterations: int = 20, pass_band: float = 0.1, sharp_angle: float = 0.0, hold_border: bool = False,
               no_crossings: bool = False, threads: int | None = None, memory_limit: int | None = None, progress: Progress = None) -> Mesh:
        """The same mesh with smooth positions; faces and attributes but normals stay. What is slower than the pass band keeps its size.

        Parameters
        ----------
        method
            "sinc" (Taubin, Zhang, Golub: the pass band ends sharply) or "taubin" (a step in, a larger one out).
        iterations
            steps, 1 to 1000; the more, the sharper the pass band ends.
        pass_band
            0.001 to 1: smaller is smoother; 0.1 keeps waves of about 14 edges and more.
        sharp_angle
            vertices of edges whose faces turn by more stay [degrees]; 0: none.
        hold_border
            vertices of borders stay, bit for bit; else they are smoothed along these.
        no_crossings
            moves are undone where faces would cross that did not.

        Returns
        -------
        Mesh
            Its ``report`` is a `bitvox.reports.SmoothReport`: volumes before and after, the largest move, vertices that stayed or went back.

        Examples
        --------
        >>> stairs = bitvox.faces(bitvox.voxelize('knot.ply', resolution=40))
        >>> smooth = stairs.smooth(no_crossings=True)
        >>> smooth.area < 0.8 * stairs.area, abs(smooth.volume / stairs.volume - 1) < 0.01
        (True, True)
        """
        np = arrays.numpy("Mesh.smooth")
        options, report = options_of("smooth_options"), ffi.new("bvx_smooth_report *")
        options.method = choice("method", method, "BVX_SMOOTH_", ("sinc", "taubin"))
        options.iterations, options.pass_band = in_range("iterations", iterations, 1, 1000), pass_band or -1.0
        options.sharp_angle, options.hold_border, options.no_crossings = sharp_angle, int(bool(hold_border)), int(bool(no_crossings))
        options.report = report
        made = np.empty((self.n_vertices, 3), np.asarray(self._vertices).dtype)
        with Run(threads, memory_limit, progress) as run:
            view, own = self._view(run), arrays.borrow_vertices(self._vertices)
            run.keep(own.keep)
            view.positions, view.position_type, view.position_stride = own.pointer, own.kind, own.stride  # the frame stays
            run.check(lib.bvx_mesh_smooth(run.context, view, options, ffi.cast("void *", arrays.address(made))))
        smoothed = self._with_vertices(made)
        smoothed.report = record(report)
        return smoothed

    @overload
    def simplify(self, *, triangles: int | None = None, error: float | str | None = None, count: None = None, **options: Unpack[Collapsing]) -> Mesh: ...  # type: ignore[overload-overlap]
    @overload
    def simplify(self, *, triangles: Sequence[int] | None = None, error: Sequence[float | str] | None = None, count: int | None = None, **options: Unpack[Collapsing]) -> list[Mesh]: ...
    def simplify(self, *, triangles: int | Sequence[int] | None = None, error: float | str | Sequence[float | str] | None = None,
                 count: int | None = None, **options: Unpack[Collapsing]) -> Any:
        """Fewer triangles for the mesh as it is, by collapsing the edges that cost least.

        Parameters
        ----------
        triangles, error, count, options
            as for `bitvox.simplify`.

        Returns
        -------
        Any
            A `Mesh` for one target, a list for several.

        Examples
        --------
        >>> bitvox.read('knot.ply').simplify(triangles=500).n_faces <= 500
        True
        """
        return call("simplify", self, triangles=triangles, error=error, count=count, **options)

    def content_hash(self) -> int:
        """The library's hash of type, counts, frame, vertices and triangles: the same on every machine.

        Examples
        --------
        >>> bitvox.read('knot.ply').content_hash() == bitvox.read('knot.ply').content_hash()
        True
        """
        out = ffi.new("uint64_t *")
        with Run() as run:
            run.check(lib.bvx_mesh_hash(run.context, self._struct(run), out))
        return out[0]

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Mesh):
            return NotImplemented
        if (self.n_vertices, self.n_faces, self.frame) != (other.n_vertices, other.n_faces, other.frame):
            return False
        np = arrays.numpy_or_none()
        if np is None:
            return self._vertices == other._vertices and self._faces == other._faces
        return bool(np.array_equal(self._vertices, other._vertices) and np.array_equal(self.faces, other.faces))

    __hash__: ClassVar[None] = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        return f"Mesh({self.n_vertices} vertices, {self.n_faces} faces)"

    def __dask_tokenize__(self) -> Any:
        return (type(self).__name__, *self.__getstate__()[:2])

    def __getstate__(self) -> Any:
        np = arrays.numpy("pickling")
        held = [self._vertices, self._faces, self._colors, self._uvs, self._uv_faces, *(self._keys or (None, None)), self._normals, self._materials, self._uvs2]
        return [None if a is None else np.array(a) for a in held], self.frame, self.report

    def __setstate__(self, state: Any) -> None:
        held = state[0]
        self.frame, self.report = state[1:]
        self._vertices, self._faces, self._colors, self._uvs, self._uv_faces = held[:5]
        self._normals, self._materials, self._uvs2, self._assets = held[7], held[8], held[9], None
        self._keys = None if held[5] is None else (held[5], held[6])

    # ---- to others ----

    def in_world(self) -> Array:
        """Vertices with the frame added, float64.

        Examples
        --------
        >>> bitvox.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], frame=(5, 0, 0)).in_world()[0].tolist()
        [5.0, 0.0, 0.0]
        """
        np = arrays.numpy("in_world")
        return np.asarray(self._vertices, np.float64) + np.asarray(self.frame) if any(self.frame) else np.asarray(self._vertices, np.float64)

    def to_trimesh(self) -> Any:
        """A trimesh.Trimesh with the same vertices and faces, in the same order, and colors where there are any; with texture coordinates
        where there are some: vertices on seams are then there once for each.

        Examples
        --------
        >>> bitvox.read('knot.ply').to_trimesh().is_watertight
        True
        """
        trimesh = need("trimesh", "formats")
        if self._uvs is None:
            return trimesh.Trimesh(self.in_world(), self.faces.astype("int64"), vertex_colors=self._colors, process=False)
        vertices, faces, uvs = self._seams_split()
        visual = need("trimesh.visual", "formats").TextureVisuals(uv=uvs)
        return trimesh.Trimesh(vertices, faces, visual=visual, process=False)

    def _seams_split(self) -> tuple[Any, Any, Any]:
        """Vertices, faces and one texture coordinate a vertex: those on seams are there once for each."""
        np = arrays.numpy("texture coordinates")
        faces = np.asarray(self.faces).astype("int64")
        if self._uv_faces is None:
            return self.in_world(), faces, np.asarray(self._uvs, float)
        pairs = np.stack([faces.ravel(), np.asarray(self._uv_faces).ravel().astype("int64")], axis=1)
        unique, numbers = np.unique(pairs, axis=0, return_inverse=True)
        return self.in_world()[unique[:, 0]], numbers.reshape(-1, 3), np.asarray(self._uvs, float)[unique[:, 1]]

    def to_pyvista(self) -> Any:
        """A pyvista.PolyData; colors become the point data "colors".

        Examples
        --------
        >>> bitvox.read('knot.ply').to_pyvista().is_manifold
        True
        """
        np = arrays.numpy("to_pyvista")
        pyvista = need("pyvista", "view")
        flat = np.empty((self.n_faces, 4), np.int64)
        flat[:, 0] = 3
        flat[:, 1:] = self.faces
        made = pyvista.PolyData(self.in_world(), flat.ravel())
        if self._colors is not None:
            made.point_data["colors"] = np.asarray(self._colors)
        if self._uvs is not None and self._uv_faces is None:
            made.active_texture_coordinates = np.asarray(self._uvs)
        return made

    def to_open3d(self) -> Any:
        """An open3d.geometry.TriangleMesh, with colors where there are any; needs ``bitvox[open3d]``.

        Examples
        --------
        >>> bitvox.read('knot.ply').to_open3d().is_watertight()
        True
        """
        np, open3d = arrays.numpy("to_open3d"), need("open3d", "open3d")
        made = open3d.geometry.TriangleMesh(open3d.utility.Vector3dVector(np.ascontiguousarray(self.in_world())),
                                            open3d.utility.Vector3iVector(np.ascontiguousarray(self.faces, np.int32)))
        if self._colors is not None:
            made.vertex_colors = open3d.utility.Vector3dVector(np.asarray(self._colors)[:, :3] / 255.0)
        return made

    def to_meshio(self) -> Any:
        """A meshio.Mesh of triangles; colors become the point data "colors". Needs ``bitvox[formats]``.

        Examples
        --------
        >>> bitvox.read('knot.ply').to_meshio().cells[0].type
        'triangle'
        """
        np, meshio = arrays.numpy("to_meshio"), need("meshio", "formats")
        data = {} if self._colors is None else {"colors": np.asarray(self._colors)}
        return meshio.Mesh(self.in_world(), [("triangle", np.asarray(self.faces).astype(np.int64))], point_data=data)

    def to_napari(self, name: str | None = None) -> Any:
        """A surface layer of napari as it takes them, ``(data, options, "surface")``: ``viewer.add_layer(napari.layers.Layer.create(*...))``.
        Axes are z, y, x there.

        Parameters
        ----------
        name
            of the layer; None: "mesh".

        Examples
        --------
        >>> data, options, kind = bitvox.read('knot.ply').to_napari()
        >>> kind
        'surface'
        """
        np = arrays.numpy("to_napari")
        faces = np.ascontiguousarray(np.asarray(self.faces)[:, ::-1])  # x, y, z backwards mirror the triangles
        return (np.ascontiguousarray(self.in_world()[:, ::-1]), faces, np.ones(self.n_vertices, np.float32)), {"name": name or "mesh"}, "surface"

    def plot(self, **options: Any) -> Any:
        """Show it in a window through PyVista; options are those of ``pyvista.PolyData.plot``.

        Examples
        --------
        >>> bitvox.read('knot.ply').plot()  # doctest: +SKIP
        """
        if self._colors is not None:
            options = {"scalars": "colors", "rgb": True, **options}
        return self.to_pyvista().plot(**options)

    def _repr_html_(self) -> str:
        return shown(self, {"vertices": self.n_vertices, "faces": self.n_faces, "low": self.bounds[0], "high": self.bounds[1]}, self._repr_png_())

    def _repr_png_(self) -> bytes | None:
        return call("render", self, size=(480, 360)).packed_png() if self.n_faces else None

    def save(self, path: str | os.PathLike[str], format: str | None = None, *, normals: bool = False, origin: Any = None,
             allow_rounding: bool = False, up: str | None = None, quantize: bool = False) -> None:
        """Write it to the file ``path``, in the format of its ending or in ``format``: .stl, .obj, .ply, .off, .glb, .3mf,
        with ``bitvox[view]`` .vtp; with ``normals`` of the vertices too
        in .ply and .obj, less by an ``origin``; ``allow_rounding`` writes what it spoils; ``up="y"`` turns z up to y up, ``"z"``
        back; ``quantize`` makes a .glb small. See `bitvox.write`.

        Examples
        --------
        >>> bitvox.read('knot.ply').save('knot.stl')
        """
        call("write", self, path, format=format, normals=normals, origin=origin, allow_rounding=allow_rounding, up=up, quantize=quantize)


def new_mesh() -> Any:
    """An empty bvx_mesh that is freed with the last array over it."""
    return ffi.gc(ffi.new("bvx_mesh *"), lib.bvxpy_free_mesh)


def with_positions(options: Any, dtype: Any, make: Any, **limits: Any) -> Mesh:
    """A mesh in the requested type; None: float32, or float64 where float32 does not distinguish neighboring positions."""
    with Run(**limits) as run:
        held = options.placing if hasattr(options, "placing") else options
        held.position_type = lib.BVX_POSITION_AUTO if dtype is None else position_type(dtype)
        made = new_mesh()
        run.check(make(run, made))
    return Mesh._made(made)


def used_bounds(mesh: Mesh) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
    """Low and high corner of the vertices that triangles use, which lattices are fitted to."""
    np = arrays.numpy_or_none()
    if mesh._faces is None or np is None:
        return mesh.bounds
    return Mesh(mesh._vertices[np.unique(mesh._faces)], np.zeros((1, 3), np.uint32), frame=mesh.frame).bounds


def subtract(mesh: Any, origin: Any) -> None:
    """Positions in the file are less by the origin."""
    if origin is not None:
        x, y, z = (float(v) for v in origin)
        mesh.frame = (mesh.frame[0] - x, mesh.frame[1] - y, mesh.frame[2] - z)


@entered
def mesh_of(source: Any) -> Mesh:
    """`Mesh.of`, for modules below."""
    return Mesh.of(source)
