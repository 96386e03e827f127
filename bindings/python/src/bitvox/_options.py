"""Options beyond the twelve of a signature: given by name as all others, listed and told by one class for each call."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Sequence, TypedDict

if TYPE_CHECKING:
    from ._words import (Axis, Crossings, ErrorKind, FaceRule, Fill, Interpolation, RepairSign, Thin, ThinCheck, Topology, Vertices)


class VoxelizeOptions(TypedDict, total=False):
    """More options of `voxelize`.

    Parameters
    ----------
    close_gaps
        with fill "flood": gaps of up to this many voxels stop the flood.
    add_shell
        set all voxels that the surface touches too.
    check_thin
        look for walls too thin for the voxels, for the report's ``thin_voxels``, ``thin_box`` and
        ``thin_resolution``: "auto" (the default: in whole lattices), "always", "never". The report's ``volume``,
        ``mesh_volume`` (0 where that says nothing) and ``crossing_volume`` tell more: where they are more than 1 % apart,
        ``volume_resolution`` is the resolution that is within it, else 0.
    base, up, second
        with fill "below": the height that columns stand on [world], the axis that is up ("x", "y" or "z"), a
        second terrain: what lies between the two. Where no lattice is given it holds both terrains, down to the base.

    Examples
    --------
    >>> more: bitvox.VoxelizeOptions = {'close_gaps': 2}
    >>> bitvox.voxelize('knot.ply', resolution=32, fill='flood', **more).report.fill
    'flood'
    """

    close_gaps: int | None
    add_shell: bool
    check_thin: ThinCheck | None
    base: float | None
    second: Any
    up: Axis | None


class FieldOptions(TypedDict, total=False):
    """More options of `field`.

    Parameters
    ----------
    vectors
        keep the vectors to the closest points, which `Field.surface` uses: the default.
    features
        keep the closest triangles and where on them the points lie.

    Examples
    --------
    >>> more: bitvox.FieldOptions = {'vectors': False}
    >>> bitvox.field('knot.ply', resolution=24, **more).to_numpy().ndim
    3
    """

    vectors: bool
    features: bool


class SurfaceOptions(TypedDict, total=False):
    """More options of `Volume.surface`.

    Parameters
    ----------
    face_rule, local_frame
        as for `surface`.
    error_kind
        of ``error``: "mean" (the default) or "max" distance.

    Examples
    --------
    >>> more: bitvox.SurfaceOptions = {'face_rule': 'join'}
    >>> bitvox.Volume(np.eye(3)[:, :, None]).surface(0.5, **more).check().components
    1
    """

    face_rule: FaceRule
    local_frame: bool
    error_kind: ErrorKind | None


class BooleanOptions(SurfaceOptions, total=False):
    """More options of `boolean`, beside those of `SurfaceOptions`.

    Parameters
    ----------
    interpolation
        where vertices go: "vector", "scalar", "middle", "paper" or "tangent". None: the library's default.
    thin
        walls of a and b thinner than 1.5 voxels: "keep" (whole, about as thick as they are; a thin wall of b is a slot in a
        difference) or "drop" (lost where no center lies in them): the report's ``thin_kept`` (1: a, 2: b, added up), and
        ``thin_voxels`` and ``thin_resolution`` of its ``solid_a`` and ``solid_b``.
    least_part
        smaller parts are dropped [voxels]; None: crumbs that neither mesh has a part for, as for `repair`.
    dtype
        as for `surface`.

    Examples
    --------
    >>> more: bitvox.BooleanOptions = {'dtype': 'float64'}
    >>> bitvox.boolean('knot.ply', 'knot.ply', 'union', resolution=32, **more).vertices.dtype
    dtype('float64')
    """

    interpolation: Interpolation | None
    thin: Thin
    least_part: int | None
    dtype: Any


class RepairOptions(BooleanOptions, total=False):
    """More options of `repair`, beside ``dtype`` and those of `SurfaceOptions`.

    Parameters
    ----------
    interpolation
        where vertices go: "tangent" (the default: by the planes at the closest points), "vector" (by the line
        through them), "scalar" (by the signed distances), "middle" or "paper" (vector with the paper's clamps).
    sharp
        cells on sharp edges and corners get a vertex there: always, never, or (None) where many of the mesh's edges are sharp,
        as in machine parts.
    thin
        walls of bodies thinner than 1.5 voxels: "keep" (the default: whole, about as thick as they are), "shell" (pieces without
        a voxel become shells, other walls are lost where no center lies in them) or "drop" (lost). They are described by
        the report's ``thin_voxels`` and ``thin_resolution``.
    least_part, least_cavity
        smaller pieces are dropped, smaller cavities filled [voxels]. least_part None: crumbs are dropped, small
        pieces nowhere three voxels thick where the mesh has no part of its own; 0: nothing is dropped.
    measure, measure_samples
        measure the distances between input and result, from so many points a side.

    Examples
    --------
    >>> more: bitvox.RepairOptions = {'thin': 'drop', 'measure': True}
    >>> bitvox.repair('knot.ply', resolution=48, **more).report.distance.max < 0.2
    True
    """

    sharp: bool | None
    least_cavity: int
    measure: bool
    measure_samples: int | None


class HullOptions(SurfaceOptions, total=False):
    """More options of `hull`, beside those of `SurfaceOptions`.

    Parameters
    ----------
    lattice
        a `Lattice` to work on, in place of a resolution.
    interpolation, sharp, dtype
        as for `repair`.
    least_part
        smaller pieces are dropped [voxels].
    even, samples, strict
        as for `simplify`; distances are measured from the hull before edges collapse.

    Examples
    --------
    >>> more: bitvox.HullOptions = {'least_part': 9, 'sharp': False}
    >>> bitvox.hull('knot.ply', resolution=32, **more).check().closed
    True
    """

    lattice: Any
    interpolation: Interpolation | None
    sharp: bool | None
    least_part: int
    even: float | None
    samples: int | None
    strict: bool
    dtype: Any


class SimplifyOptions(TypedDict, total=False):
    """More options of `simplify` and `Mesh.simplify`, and of `lod` for levels by collapses.

    Parameters
    ----------
    error_kind
        of ``error``: "mean" (the default) or "max" distance, measured both ways.
    even
        pull towards triangles of even size where the surface is flat, 0 to 1. Default 1e-9.
    attribute_weight
        of texture coordinates, normals and colors beside the shape, 0 to 1000. Default 1: texture coordinates by 0.3 of their length
        on the surface, a difference of 1 in normals and colors by a hundredth of the mesh's longest side. 0: they follow the shape
        and cost nothing.
    locked
        one value a vertex: those with a value other than 0 stay where they are.
    vertices
        "placed" (the default): new ones, where they lie nearest to the mesh; `Closest` of the mesh gives each one's triangle and
        barycentric weights there. "kept": the mesh's own, all of them, of which ``faces`` are indices; what is stored by vertex stays
        as it is.
    topology
        "keep" (the default) or "simplify": handles are cut and holes filled that come to be less than three mean edges of the level
        around, the smallest first; ``handles_cut``, ``holes_filled`` and ``longest_closed`` [world] of the report say what was done.
    samples
        measure the distances between mesh and level from this many points a side, for the report. Default:
        20000 with ``error``, else 0: they are not.

    Examples
    --------
    >>> more: bitvox.SimplifyOptions = {'vertices': 'kept', 'samples': 1000}
    >>> bitvox.simplify('knot.ply', triangles=500, **more).n_faces <= 500
    True
    """

    error_kind: ErrorKind | None
    even: float | None
    attribute_weight: float | None
    locked: Any
    vertices: Vertices
    topology: Topology
    samples: int | None


class LodOptions(SimplifyOptions, total=False):
    """More options of `lod`, beside those of `SimplifyOptions`: of levels of a solid, and of the paper's methods.

    Parameters
    ----------
    lattice
        a `Lattice` to measure on, in place of a resolution.
    sign
        solid: what decides that a center is inside, as for `repair`.
    sharp
        solid: vertices on sharp edges and corners: always, never, or (None) where many of the mesh's edges are sharp.
    outer_hull
        solid: inner shells and cavities are removed.
    shell
        solid: thickness that open sheets are given [largest spacings]; 0: none are made. Default 2.
    least_part, least_cavity
        solid: smaller pieces are dropped, smaller cavities filled [voxels].
    keep_largest
        solid: this many of the largest pieces are kept, as for `repair`; of a grid, `Grid.keep` does that.
    threshold
        the paper's methods: a sample above it is inside, between 0 and 1. Default 0.5.
    edge_samples
        "edge-ratio": steps along an edge. Default: the ratio, rounded up.
    collapse
        the paper's methods, with ``triangles``: make up to this many times as many, then collapse the cheapest edges.
    fill, close_gaps, padding
        the paper's methods: as for `voxelize`, when the source is a mesh.
    face_rule, local_frame
        the paper's methods: as for `surface`.
    lock_border
        vertices on borders stay where they are, so that tiles join.
    dtype
        float32 or float64. None: the mesh's own, float32 where voxels are made, or float64 where that does not distinguish positions.

    Examples
    --------
    >>> more: bitvox.LodOptions = {'outer_hull': True, 'sign': 'winding'}
    >>> len(bitvox.lod('knot.ply', triangles=(500, 100), solid=True, resolution=48, **more))
    2
    """

    lattice: Any
    sign: RepairSign | None
    sharp: bool | None
    outer_hull: bool
    shell: float | None
    least_part: int | None
    keep_largest: int | None
    least_cavity: int | None
    threshold: float | None
    edge_samples: int | None
    collapse: float | None
    fill: Fill | None
    close_gaps: int | None
    padding: int | None
    face_rule: FaceRule | None
    local_frame: bool
    lock_border: bool
    dtype: Any


class SectionsOptions(TypedDict, total=False):
    """More options of `from_sections`.

    Parameters
    ----------
    cells
        planes that are not parallel: cells along the longest side of the contours' box. Default 64; ``spacing`` does the
        same by a cell's side.
    agree
        planes that are not parallel: contours at most so far apart where two planes cross are moved to agree [world].
        Default: a hundredth of that longest side.
    crossings
        on the planes: "exact" (the default: by the contours themselves, all of whose points become vertices), "paper" (by
        interpolated distances with the contours' points put in) or "classic" (marching cubes).
    subdivide
        a cell that a contour crosses twice on a side is halved at most this often. Default 5.
    error_kind
        as for `repair`.
    dtype
        float64 (the default) keeps the contours' points; float32 rounds them.

    Examples
    --------
    >>> more: bitvox.SectionsOptions = {'crossings': 'paper'}
    >>> bitvox.from_sections(bitvox.slice_mesh('knot.ply', spacing=0.5), mend=True, **more).check().closed
    True
    """

    cells: int | None
    agree: float | None
    crossings: Crossings
    subdivide: int | None
    error_kind: ErrorKind | None
    dtype: Any


class RenderOptions(TypedDict, total=False):
    """More options of `render`.

    Parameters
    ----------
    cut_low, cut_high
        take away what lies below and above these three [world].
    background
        red, green, blue. Default white.
    samples
        rays a pixel along each side, 1 to 4. Default 2.
    show
        half width and half height that the frame shows at least [world].

    Examples
    --------
    >>> more: bitvox.RenderOptions = {'background': (0, 0, 0), 'samples': 1}
    >>> bitvox.render('knot.ply', size=(64, 48), **more).size
    (64, 48)
    """

    cut_low: Sequence[float] | None
    cut_high: Sequence[float] | None
    background: Sequence[int]
    samples: int
    show: Sequence[float] | None
