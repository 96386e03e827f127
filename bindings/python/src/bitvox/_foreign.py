"""Volumes of other libraries, told by what they offer, and volumes sampled anew along the world's axes."""

from __future__ import annotations

import math
from typing import Any

from . import _arrays as arrays
from ._calls import entered
from ._errors import ArgumentError, UnsupportedError, need
from ._volume import Volume, from_world
from ._words import Frame, Order


@entered
def volume_from(source: Any, scalars: str | None, order: Order | None, spacing: Any, center0: Any, frame: Frame | None) -> Volume:
    """See `Volume.of`."""
    for looks, take in ((_is_simpleitk, _from_simpleitk), (_is_nibabel, _from_nibabel)):
        if looks(source):
            made = take(source)
            return made if frame is None else made.turned(frame)
    if frame is not None:
        raise ArgumentError("frame is for images of SimpleITK and nibabel: others do not say what their axes are")
    if hasattr(source, "matrix") and hasattr(source, "filled_count"):
        return Volume(source.matrix, **placed_by(source.transform))  # a trimesh VoxelGrid
    if hasattr(source, "direction_matrix") and hasattr(source, "point_data"):
        return _from_pyvista(source, scalars)
    if scalars is not None:
        raise ArgumentError("scalars is for pyvista.ImageData")
    if hasattr(source, "dims") and hasattr(source, "coords"):
        return _from_xarray(source, order, spacing, center0)
    if isinstance(source, arrays.numpy("Volume.of").ndarray):
        raise TypeError("an array of numpy has no place of its own: give Volume(array, order=..., spacing=..., center0=...)")
    if hasattr(source, "shape") and hasattr(source, "dtype") and len(source.shape) == 3:  # Zarr, h5py and the like
        np = arrays.numpy("Volume.of")
        return Volume(np.asarray(source[...]), order=order or "zyx", spacing=1.0 if spacing is None else spacing, center0=center0)
    raise TypeError(f"{type(source).__name__} is not a volume: give an image of SimpleITK or nibabel, a pyvista.ImageData, an xarray DataArray "
                    "or a Zarr array; Volume(array) takes arrays of numpy")


def _is_simpleitk(source: Any) -> bool:
    return all(hasattr(source, name) for name in ("GetDirection", "GetSpacing", "GetOrigin", "GetNumberOfComponentsPerPixel"))


def _from_simpleitk(image: Any) -> Volume:
    if image.GetDimension() != 3 or image.GetNumberOfComponentsPerPixel() != 1:
        raise UnsupportedError(f"an image of {image.GetDimension()} axes and {image.GetNumberOfComponentsPerPixel()} numbers a sample; "
                               "a volume has three axes and one")
    array = need("SimpleITK", "medical").GetArrayFromImage(image)
    return Volume(array, order="zyx", spacing=image.GetSpacing(), center0=image.GetOrigin(), direction=image.GetDirection(), frame="lps")


def _is_nibabel(source: Any) -> bool:
    return hasattr(source, "affine") and hasattr(source, "dataobj")


def _from_nibabel(image: Any) -> Volume:
    np = arrays.numpy("nibabel")
    values = np.asanyarray(image.dataobj)
    while values.ndim > 3 and values.shape[-1] == 1:
        values = values[..., 0]
    if values.ndim != 3:
        raise UnsupportedError(f"an image of shape {values.shape}; take one of its volumes: image.slicer[..., i]")
    return Volume(values, **placed_by(image.affine), frame="ras")


def placed_by(affine: Any) -> dict[str, Any]:
    """Spacing, center of the first voxel and directions of an affine from indices to the world."""
    np = arrays.numpy("volumes")
    steps = np.asarray(affine, float)
    spacing = np.sqrt((steps[:3, :3] ** 2).sum(axis=0))
    if not (spacing > 0).all():
        raise UnsupportedError("the affine has an axis without length")
    return {"spacing": spacing.tolist(), "center0": steps[:3, 3].tolist(), "direction": steps[:3, :3] / spacing}


def affine_of(volume: Volume) -> Any:
    """Four by four numbers that lead from indices to the world."""
    np = arrays.numpy("volumes")
    made = np.eye(4)
    made[:3, :3], made[:3, 3] = volume.direction * np.asarray(volume.spacing), volume.center0
    return made


@entered
def to_sitk(volume: Volume) -> Any:
    """See `Volume.to_sitk`."""
    there = volume.turned("lps") if volume.frame else volume
    image = need("SimpleITK", "medical").GetImageFromArray(there.to_numpy("zyx"))
    image.SetSpacing(there.spacing)
    image.SetOrigin(there.center0)
    image.SetDirection(there.direction.ravel().tolist())
    return image


@entered
def to_nibabel(volume: Volume) -> Any:
    """See `Volume.to_nibabel`."""
    there = volume.turned("ras") if volume.frame else volume
    return need("nibabel", "medical").Nifti1Image(there.array, affine_of(there), dtype=there.array.dtype)


def _from_pyvista(image: Any, scalars: str | None) -> Volume:
    np = arrays.numpy("PyVista")
    if not hasattr(image, "active_scalars_name"):  # VTK's own
        image = need("pyvista", "view").wrap(image)
    name = image.active_scalars_name if scalars is None else scalars
    turn, steps = np.asarray(image.direction_matrix, float).reshape(3, 3), np.asarray(image.spacing, float)
    first = np.asarray(image.origin, float) + turn @ (np.asarray(image.extent[::2]) * steps)
    if name in image.point_data:
        values, sides = image.point_data[name], list(image.dimensions)
    elif name in image.cell_data:
        values, sides = image.cell_data[name], [n - 1 for n in image.dimensions]
        first = first + turn @ (0.5 * steps)
    else:
        raise ArgumentError("the image has no data" if name is None else f"the image has no cell or point data named {name!r}")
    if values.ndim != 1 or min(sides) < 1:
        raise ArgumentError(f"the data {name!r} are not a volume of single numbers")
    return Volume(np.asarray(values).reshape(sides[::-1]), order="zyx", spacing=steps.tolist(), center0=first.tolist(), direction=turn)


def _from_xarray(source: Any, order: str | None, spacing: Any, center0: Any) -> Volume:
    np = arrays.numpy("xarray")
    if len(source.dims) != 3:
        raise UnsupportedError(f"an array of axes {tuple(source.dims)}; a volume has three: take .isel(...) or .squeeze()")
    names = [str(name) for name in source.dims]
    named: str = order or "zyx"
    if order is None:
        named = "".join(names) if sorted(names) == ["x", "y", "z"] else "zyx"
    if sorted(named) != ["x", "y", "z"]:
        raise ArgumentError(f"order is {named!r}; it must name x, y and z")
    array = np.asarray(source.values).transpose([named.index(a) for a in "xyz"])
    steps, first = [1.0] * 3, [0.0] * 3
    for i, axis in enumerate("xyz"):
        name = source.dims[named.index(axis)]
        if name in source.coords:
            at = np.asarray(source.coords[name].values, float)
            step = (at[-1] - at[0]) / (len(at) - 1) if len(at) > 1 else 1.0
            if step == 0 or (np.abs(np.diff(at) - step) > 1e-6 * abs(step)).any():
                raise UnsupportedError(f"the coordinates of {name!r} are not evenly spaced")
            steps[i], first[i] = float(step), float(at[0])
    turn = np.diag([math.copysign(1.0, s) for s in steps])
    return Volume(array, spacing=[abs(s) for s in steps] if spacing is None else spacing, center0=first if center0 is None else center0, direction=turn)


@entered
def resampled(volume: Volume, spacing: Any, method: str, outside: Any) -> Volume:
    """See `Volume.aligned`: samples of the lattice along the world's axes that covers the volume, slice by slice."""
    np = arrays.numpy("Volume.aligned")
    if method not in ("linear", "nearest"):
        raise ArgumentError(f"method is {method!r}; it must be 'linear' or 'nearest'")
    steps = np.array(arrays.triple("spacing", min(volume.spacing) if spacing is None else spacing))
    low, high = (np.array(end) for end in volume.bounds)
    sides = np.maximum(1, np.ceil((high - low) / steps - 1e-9)).astype(int)
    first = (low + high) / 2 - (sides - 1) / 2 * steps
    values, beyond = volume.array, volume.array.min() if outside is None else outside
    kind = values.dtype if method == "nearest" or values.dtype.kind == "f" else np.dtype(np.float64)
    made = np.empty(sides[::-1], kind)
    x, y = np.meshgrid(first[0] + steps[0] * np.arange(sides[0]), first[1] + steps[1] * np.arange(sides[1]))
    turn, middle = volume.direction, np.array(volume.center0)
    for k in range(sides[2]):
        at = np.stack([x.ravel() - middle[0], y.ravel() - middle[1], np.full(x.size, first[2] + steps[2] * k - middle[2])], axis=1)
        index = from_world(turn, at) / np.asarray(volume.spacing)
        made[k] = (_linear if method == "linear" else _nearest)(values, index, beyond, np).reshape(x.shape)
    return Volume(made, order="zyx", spacing=steps.tolist(), center0=first.tolist(), frame=volume.frame)


def _nearest(values: Any, index: Any, beyond: Any, np: Any) -> Any:
    at = np.floor(index + 0.5).astype(np.int64)
    inside = ((at >= 0) & (at < values.shape)).all(axis=1)
    out = np.full(len(at), beyond, values.dtype)
    out[inside] = values[tuple(at[inside].T)]
    return out


def _linear(values: Any, index: Any, beyond: Any, np: Any) -> Any:
    """Between the eight samples around; half a voxel beyond the outermost ones their value stays."""
    ends = np.array(values.shape) - 1
    inside = ((index >= -0.5 - 1e-9) & (index <= ends + 0.5 + 1e-9)).all(axis=1)
    at = np.clip(index[inside], 0, ends)
    low = np.minimum(np.floor(at).astype(np.int64), np.maximum(ends - 1, 0))
    share = at - low
    total = np.zeros(len(at))
    for corner in range(8):
        step = np.array([corner & 1, corner >> 1 & 1, corner >> 2 & 1])
        weight = np.where(step, share, 1.0 - share).prod(axis=1)
        total += np.where(weight == 0, 0, weight * values[tuple(np.minimum(low + step, ends).T)])
    out = np.full(len(index), float(beyond))
    out[inside] = total
    return out
