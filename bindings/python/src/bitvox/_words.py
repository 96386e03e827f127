"""The words that options take, for type checkers; `tests/test_types.py` compares them with the library's own lists."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Callable, Iterable, Literal, TypedDict

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from . import reports

    Array = NDArray[Any]

    class GridReport(reports.SolidReport, reports.SurfaceReport, reports.HollowReport, reports.KeepReport, reports.VolumeReport,  # type: ignore[misc]
                     reports.PointsReport):
        """One of these or None, which the call that made a grid decides: type checkers take it for each of them, and find what none has."""

    class MeshReport(reports.FieldSurfaceReport, reports.BooleanReport, reports.RepairReport, reports.LevelReport, reports.LevelsReport,  # type: ignore[misc]
                     reports.SmoothReport, reports.HullReport, reports.SectionsReport, reports.LodReport):
        """The same of a mesh."""

        distance: reports.Distances  # type: ignore[assignment]  # where it was measured
else:
    Array = GridReport = MeshReport = Any

if TYPE_CHECKING:
    from ._options import HullOptions, SimplifyOptions

    class Running(TypedDict, total=False):
        threads: int | None
        memory_limit: int | None
        progress: bool | Callable[[str, float], Any] | None

    class Collapsing(SimplifyOptions, Running, total=False):
        lock_border: bool
        strict: bool
        dtype: Any

    class Hulling(HullOptions, Running, total=False):
        resolution: int | None
        close_gaps: int
        shell: float | None
        enclose: float | str | None
        keep_largest: int | None
        carry: bool

    class Surfacing(Running, total=False):
        face_rule: FaceRule
        dtype: Any
        open_sides: str | Iterable[str]
        keys: bool
        local_frame: bool
        mesh: Any
        offset: float
        sharp: bool | None

Fill = Literal["parity", "nonzero", "vote", "flood", "regions", "below", "winding", "auto"]
BooleanFill = Literal["parity", "nonzero", "vote", "winding", "auto"]
Sign = Literal["auto", "parity", "nonzero", "vote", "winding", "normal", "none"]
RepairSign = Literal["auto", "parity", "vote", "winding"]
Interpolation = Literal["vector", "scalar", "middle", "paper", "tangent"]
FaceRule = Literal["separate", "join"]
Mode = Literal["solid", "conservative", "thin", "sampled"]
Operation = Literal["union", "intersection", "difference", "xor"]
Method = Literal["collapse", "coverage", "edge-ratio"]
SmoothMethod = Literal["sinc", "taubin"]
Vertices = Literal["placed", "kept"]
Topology = Literal["keep", "simplify"]
ErrorKind = Literal["mean", "max"]
Thin = Literal["shell", "keep", "drop"]
ThinCheck = Literal["auto", "never", "always"]
Caps = Literal["flat", "taper", "open"]
Touching = Literal["apart", "shared"]
Crossings = Literal["exact", "paper", "classic"]
Reduce = Literal["any", "all", "majority"]
DistanceSide = Literal["outside", "inside", "signed"]
Beyond = Literal["nothing", "empty", "set"]
Side = Literal["x-low", "x-high", "y-low", "y-high", "z-low", "z-high"]
Axis = Literal["x", "y", "z"]
Order = Literal["xyz", "zyx"]
Frame = Literal["lps", "ras"]
Direction = Literal["-x", "-y", "-z", "+x", "+y", "+z"]
Resampling = Literal["linear", "nearest"]
FloatName = Literal["float32", "float64"]
