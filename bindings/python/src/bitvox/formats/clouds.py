"""Clouds of points through the libraries that know their files: PCD, LAS, LAZ, E57."""

from __future__ import annotations

import os
from typing import Any

from .. import _arrays as arrays
from .._errors import EmptyError, need, reading


def read_cloud(path: str, kind: str) -> Any:
    """The points of ``path`` as float64 (n, 3), those that are not finite left out; ``kind`` is pcd, las, laz or e57.

    The scans of an .e57 come into one world by their poses.
    """
    np = arrays.numpy("clouds of points")
    if not os.path.isfile(path):
        raise FileNotFoundError(path)
    take, library, package = {"pcd": (_pcd, "pypcd4", None), "las": (_las, "laspy", None), "laz": (_las, "laspy", "laspy[lazrs]"), "e57": (_e57, "pye57", None)}[kind]
    found = need(library, "points", package)
    with reading(path, library):
        points = np.asarray(take(found, path, np), np.float64)
    points = points[np.isfinite(points).all(axis=1)]
    if not len(points):
        raise EmptyError(f"{path} has no points")
    return np.ascontiguousarray(points)


def _pcd(library: Any, path: str, np: Any) -> Any:
    return library.PointCloud.from_path(path).numpy(("x", "y", "z"))


def _las(library: Any, path: str, np: Any) -> Any:
    return np.asarray(library.read(path).xyz)


def _e57(library: Any, path: str, np: Any) -> Any:
    with_all = library.E57(path)
    try:
        scans = [with_all.read_scan(i, ignore_missing_fields=True, transform=True) for i in range(with_all.scan_count)]
    finally:
        with_all.close()
    parts = [np.stack([scan["cartesianX"], scan["cartesianY"], scan["cartesianZ"]], axis=1) for scan in scans]
    return np.concatenate(parts) if parts else np.zeros((0, 3))
