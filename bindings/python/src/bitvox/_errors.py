"""Errors: one class for each status of the library, each also what a Python user would catch."""

from __future__ import annotations

import contextlib
import importlib
from typing import Any, Iterator


class Error(Exception):
    """Something that the library refused or could not do.

    Attributes
    ----------
    code
        the library's status, an integer that never changes its meaning.
    name
        the status as the C header writes it, such as ``"BVX_ERR_RANGE"``.
    reason
        why, finer than the status and as fixed as it: a name of the C header's BVX_REASON_LIST, such as
        ``"BVX_REASON_FLOATS_COARSE"``. Where Python finds it before the library does, the one of the status.
    index
        of the vertex, triangle, level, loop or other element that the message names first; None: it names none.

    Examples
    --------
    >>> try:
    ...     bitvox.voxelize('knot.ply', resolution=0)
    ... except bitvox.Error as error:
    ...     print(error.reason)
    BVX_REASON_RANGE
    """

    code: int = 0
    name: str = "BVX_OK"
    reason: str = "BVX_REASON_NONE"
    index: int | None = None


class ResultWarning(UserWarning):
    """What a call that succeeded has cost, or could not do: one warning of the library's list.

    Attributes
    ----------
    code
        the warning as the C header writes it, such as ``"BVX_WARN_VOLUME"``; fixed, as its values are.
    values
        the numbers that its text names, in order.
    box
        the corners of the box that it is about, or None.

    Examples
    --------
    >>> import warnings
    >>> warnings.simplefilter('error', bitvox.ResultWarning)
    """

    def __init__(self, text: str, code: str, values: tuple[float, ...], box: tuple[tuple[float, ...], tuple[float, ...]] | None) -> None:
        super().__init__(text)
        self.code = code
        self.values = values
        self.box = box


class ArgumentError(Error, ValueError):
    """An argument is out of range or contradicts another.

    Examples
    --------
    >>> try:
    ...     bitvox.voxelize('knot.ply', fill='partiy')
    ... except bitvox.ArgumentError as error:
    ...     print(str(error)[:43])
    fill is 'partiy'; it must be one of auto, p
    """

    code: int = 1
    name: str = "BVX_ERR_ARGUMENT"
    reason: str = "BVX_REASON_INVALID"


class VersionError(Error, RuntimeError):
    """Binding and library do not belong together.

    Examples
    --------
    >>> issubclass(bitvox.VersionError, bitvox.Error)
    True
    """

    code: int = 2
    name: str = "BVX_ERR_VERSION"
    reason: str = "BVX_REASON_VERSION"


class OutOfMemoryError(Error, MemoryError):
    """The machine gave no more memory.

    Examples
    --------
    >>> issubclass(bitvox.OutOfMemoryError, MemoryError)
    True
    """

    code: int = 3
    name: str = "BVX_ERR_MEMORY"
    reason: str = "BVX_REASON_MEMORY"


class MemoryLimitError(Error, MemoryError):
    """The option ``memory_limit`` does not allow it.

    Examples
    --------
    >>> try:
    ...     bitvox.voxelize('knot.ply', resolution=64, memory_limit=1000)
    ... except MemoryError as error:
    ...     print(type(error).__name__)
    MemoryLimitError
    """

    code: int = 4
    name: str = "BVX_ERR_BUDGET"
    reason: str = "BVX_REASON_BUDGET"


class RangeError(Error, ValueError):
    """A coordinate, a vertex index or a size is outside what can be represented; the message names it.

    Examples
    --------
    >>> try:
    ...     bitvox.voxelize(([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 7]]), resolution=8)
    ... except bitvox.RangeError as error:
    ...     print(error.index)
    0
    """

    code: int = 5
    name: str = "BVX_ERR_RANGE"
    reason: str = "BVX_REASON_TOO_FAR"


class OptionRangeError(ArgumentError, RangeError):
    """An option is a number outside its range; ``ArgumentError`` and ``RangeError`` both catch it.

    The library's BVX_ERR_ARGUMENT with BVX_REASON_RANGE, whether Python finds it or the library.

    Examples
    --------
    >>> try:
    ...     bitvox.voxelize('knot.ply', resolution=0)
    ... except bitvox.OptionRangeError as error:
    ...     print(error.reason)
    BVX_REASON_RANGE
    """

    reason: str = "BVX_REASON_RANGE"


class EmptyError(Error, ValueError):
    """The input holds nothing to work on.

    Examples
    --------
    >>> try:
    ...     bitvox.from_sections([])
    ... except bitvox.EmptyError as error:
    ...     print(type(error).__name__)
    EmptyError
    """

    code: int = 6
    name: str = "BVX_ERR_EMPTY"
    reason: str = "BVX_REASON_EMPTY"


class FormatError(Error, ValueError):
    """A file is damaged or not of the stated format; the message says at which byte or line.

    Examples
    --------
    >>> try:
    ...     bitvox.loads(b'solid nothing', 'ply')
    ... except bitvox.FormatError as error:
    ...     print(type(error).__name__)
    FormatError
    """

    code: int = 7
    name: str = "BVX_ERR_FORMAT"
    reason: str = "BVX_REASON_DAMAGED"


class UnsupportedError(Error, NotImplementedError):
    """A valid request that this build or this format cannot serve.

    Examples
    --------
    >>> try:
    ...     bitvox.loads(b'', 'doc')
    ... except bitvox.UnsupportedError as error:
    ...     print(type(error).__name__)
    UnsupportedError
    """

    code: int = 8
    name: str = "BVX_ERR_UNSUPPORTED"
    reason: str = "BVX_REASON_UNSUPPORTED"


class CapacityError(Error, ValueError):
    """An array is too small.

    Examples
    --------
    >>> issubclass(bitvox.CapacityError, bitvox.Error)
    True
    """

    code: int = 9
    name: str = "BVX_ERR_CAPACITY"
    reason: str = "BVX_REASON_CAPACITY"


class LatticeError(Error, ValueError):
    """Grids do not share one lattice or window.

    Examples
    --------
    >>> a, b = (bitvox.Grid(bitvox.Lattice((n, n, n))) for n in (3, 4))
    >>> try:
    ...     a | b
    ... except bitvox.LatticeError as error:
    ...     print(type(error).__name__)
    LatticeError
    """

    code: int = 10
    name: str = "BVX_ERR_LATTICE"
    reason: str = "BVX_REASON_LATTICE"


class Cancelled(Error):
    """The progress callable returned False, 0 or another false value that is not None.

    Examples
    --------
    >>> try:
    ...     bitvox.repair('knot.ply', resolution=64, progress=lambda stage, fraction: fraction < 0.1)
    ... except bitvox.Cancelled as error:
    ...     print(type(error).__name__)
    Cancelled
    """

    code: int = 11
    name: str = "BVX_CANCELLED"
    reason: str = "BVX_REASON_CANCELLED"


class MissingExtraError(Error, ImportError):
    """A package that this function needs is not installed; the message says how to install it.

    Examples
    --------
    >>> issubclass(bitvox.MissingExtraError, ImportError)
    True
    """

    code: int = 8
    name: str = "BVX_ERR_UNSUPPORTED"
    reason: str = "BVX_REASON_UNSUPPORTED"


BY_CODE: dict[int, type[Error]] = {
    kind.code: kind
    for kind in (ArgumentError, VersionError, OutOfMemoryError, MemoryLimitError, RangeError, EmptyError, FormatError,
                 UnsupportedError, CapacityError, LatticeError, Cancelled)
}


def range_error(message: str, index: int) -> RangeError:
    """A number out of range, of the element ``index``."""
    made = RangeError(message)
    made.index = index
    return made


def need(module: str, extra: str, package: str | None = None) -> Any:
    """Import a module of an optional package, or say which extra brings it."""
    try:
        return importlib.import_module(module)
    except ImportError as why:
        name = package or module.partition(".")[0]
        raise MissingExtraError(f"this needs {name}, which the extra bitvox[{extra}] brings: pip install {name} ({why})") from why


@contextlib.contextmanager
def reading(path: Any, library: str) -> Iterator[None]:
    """What a library raises while it reads a file has no common kind: it becomes a FormatError."""
    try:
        yield
    except (Error, FileNotFoundError, PermissionError, ImportError, MemoryError):
        raise
    except Exception as why:
        raise FormatError(f"{path}: {library} cannot read it: {type(why).__name__}: {why}") from why
