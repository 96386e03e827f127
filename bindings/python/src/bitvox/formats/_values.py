"""Which values of a volume are set."""

from __future__ import annotations

from typing import Any, Iterable

from .. import _arrays as arrays
from .._errors import ArgumentError


def choose(values: Any, threshold: Any, labels: Any) -> Any:
    """A bool array: above a threshold, within (low, high), of some labels; without either, other than 0."""
    np = arrays.numpy("volumes")
    if threshold is not None and labels is not None:
        raise ArgumentError("threshold and labels contradict each other; give one of them")
    if labels is not None:
        return np.isin(values, list(labels) if isinstance(labels, Iterable) else [labels])
    if threshold is None:
        if values.dtype.kind == "f" and np.isnan(values).any():
            raise ArgumentError("the volume holds NaN; give a threshold")
        return values != 0
    if hasattr(threshold, "__len__"):
        low, high = threshold
        return (values >= low) & (values <= high)
    return values > threshold
