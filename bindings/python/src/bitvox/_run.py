"""Calls into the library: a context for each, settings, progress, cancellation, errors.

A context is made and dropped within one call of Python (about two microseconds), so any number of threads may call at
once, and no call leaves anything behind but its result.
"""

from __future__ import annotations

import contextlib
import contextvars
import difflib
import functools
import os
import re
import sys
import time
import warnings
from typing import Any, Callable, Iterator, NamedTuple, Union

from . import _native
from ._errors import BY_CODE, ArgumentError, Error, OptionRangeError, ResultWarning, UnsupportedError, VersionError, need

ffi, lib = _native.ffi, _native.lib

Progress = Union[bool, Callable[[str, float], Any], None]


class _Settings(NamedTuple):
    threads: int = 0
    memory_limit: int = 0
    progress: Progress = None


_settings: contextvars.ContextVar[_Settings] = contextvars.ContextVar("bitvox", default=_Settings())
_forked = False
_counted: tuple[float, int] = (0.0, 0)
_REMEDIES = {"bvx_repair": "bitvox.repair", "bvx_build_levels": "bitvox.lod", "bvx_grid_distance": "Grid.distance"}
_AMERICAN = {"colour": "color", "centre": "center", "neighbour": "neighbor"}  # the library's words; what a message quotes stays


def _spelled(text: Any) -> str:
    """Words of the library as this package has them."""
    words = ffi.string(text).decode("utf-8", "replace")
    for theirs, ours in _REMEDIES.items():
        words = words.replace(theirs, ours)
    return re.sub(rf"(?<!['\"])\b({'|'.join(_AMERICAN)})", lambda found: _AMERICAN[found[1]], words)


def depth_of_caller() -> int:
    """How many frames above the function that asks the first one outside this package stands, as stacklevel counts."""
    depth = 1
    while sys._getframe(depth).f_globals.get("__name__", "").split(".")[0] == "bitvox" and sys._getframe(depth).f_back:
        depth += 1
    return depth


@functools.cache
def _reasons() -> dict[int, str]:
    """The names of all reasons by their numbers."""
    return {getattr(lib, name): name for name in dir(lib) if name.startswith("BVX_REASON_") and name != "BVX_REASON_COUNT"}


def _after_fork() -> None:
    global _forked
    _forked = True


if hasattr(os, "register_at_fork"):
    # The children of multiprocessing share the processors: each takes one where nothing else is said.
    os.register_at_fork(after_in_child=_after_fork)


def _default_threads() -> int:
    """As many as the library would take. To count them takes ten times as long as a context, so once a second is enough."""
    global _counted
    if _forked:
        return 1
    now = time.monotonic()
    if _counted[1] == 0 or now - _counted[0] > 1.0:
        out = ffi.new("bvx_context **")
        threads = 1
        if lib.bvx_context_create_version(lib.BVX_VERSION, ffi.NULL, out) == lib.BVX_OK:
            threads = lib.bvx_context_threads(out[0])
            lib.bvx_context_destroy(out[0])
        _counted = (now, threads)
    return _counted[1]


@contextlib.contextmanager
def settings(*, threads: int | None = None, memory_limit: int | None = None, progress: Progress = None) -> Iterator[None]:
    """Options of all calls inside a ``with`` block, for this thread (or asynchronous task).

    Parameters
    ----------
    threads
        most workers; 0 takes one a processor that this process may use (affinity, a container's quota,
        ``OMP_NUM_THREADS``), in a forked child one. Small calls and busy machines get fewer, at no cost.
    memory_limit
        most bytes that one call may hold, its result included; 0 is no limit.
    progress
        True for a bar (needs tqdm), or a callable ``progress(stage, fraction)``. Each call that is given one is one rise
        of the fraction: it never falls, and 1 is its last value, where the call succeeds. When it returns a false value that
        is not None (False, 0, numpy's False) the call ends with `Cancelled` (except at the last value, when the result is there), and
        what it raises comes out of the call.
        Set here, it is called for what takes a while, not for lengths and hashes.

    Examples
    --------
    >>> with bitvox.settings(threads=1, memory_limit=2**28):
    ...     solid = bitvox.voxelize('knot.ply', resolution=32)
    """
    old = _settings.get()
    token = _settings.set(_Settings(
        old.threads if threads is None else threads,
        old.memory_limit if memory_limit is None else memory_limit,
        old.progress if progress is None else progress,
    ))
    try:
        yield
    finally:
        _settings.reset(token)


@ffi.def_extern(error=1, onerror=lambda kind, value, trace: _stopped(value))
def bvxpy_progress(user: Any, stage: Any, fraction: float) -> int:
    run = ffi.from_handle(user)
    if run.progress is None:
        return 0
    try:
        said = run.report(ffi.string(stage).decode("utf-8", "replace"), fraction)
        return 1 if said is not None and not said else 0
    except BaseException as error:
        run.error = error
        return 1


def _stopped(error: BaseException) -> None:
    """An exception before bvxpy_progress could take it: Ctrl-C. Given to every call of this thread; it is cancelled."""
    for run in _running.get():
        run.error = error


_running: contextvars.ContextVar[tuple[Run, ...]] = contextvars.ContextVar("bitvox_running", default=())


class _Bar:
    """tqdm as a progress callable."""

    def __init__(self) -> None:
        self.bar = need("tqdm.auto", "view").tqdm(total=100.0, unit="%", leave=False, bar_format="{desc} {bar} {n:.0f}%")

    def __call__(self, stage: str, fraction: float) -> None:
        self.bar.set_description_str(stage, refresh=False)
        self.bar.n = 100.0 * fraction
        self.bar.refresh()

    def close(self) -> None:
        self.bar.close()


def _callable_of(progress: Progress) -> tuple[Callable[[str, float], Any] | None, _Bar | None]:
    """What is to be called, and the bar that is to be closed."""
    bar = _Bar() if progress is True else None
    callback = bar if progress is True else progress or None
    if callback is not None and not callable(callback):
        raise TypeError(f"progress must be True or a callable, not {type(progress).__name__}")
    return callback, bar


class Rise:
    """One rise of progress over several calls, one after the other, each with the share of its weight.

    ``with Rise(progress, 80, 20) as progress:`` gives what to pass to each of them as ``progress``. Calls inside that are given
    none are silent.
    """

    __slots__ = ("told", "bar", "ends", "done", "reached", "stage", "token")

    def __init__(self, progress: Progress, *weights: float) -> None:
        self.told, self.bar = _callable_of(_settings.get().progress if progress is None else progress)
        total = sum(weights)
        self.ends = [sum(weights[:i + 1]) / total for i in range(len(weights))]
        self.done = 0
        self.reached = 0.0
        self.stage = "done"

    def __enter__(self) -> Progress:
        self.token = _settings.set(_settings.get()._replace(progress=False))
        return False if self.told is None else self

    def __call__(self, stage: str, fraction: float) -> Any:
        self.stage = stage
        if fraction >= 1.0:  # one of the calls has ended
            self.done += 1
            return None
        assert self.told is not None
        low = 0.0 if self.done == 0 else self.ends[min(self.done, len(self.ends)) - 1]
        high = self.ends[min(self.done, len(self.ends) - 1)]
        self.reached = max(self.reached, low + (high - low) * fraction)
        return self.told(stage, self.reached) if self.reached < 1.0 else None

    def __exit__(self, kind: Any, *_: object) -> None:
        _settings.reset(self.token)
        try:
            if kind is None and self.told is not None:
                self.told(self.stage, 1.0)
        finally:
            if self.bar is not None:
                self.bar.close()


@contextlib.contextmanager
def quiet() -> Iterator[None]:
    """No progress from calls that are given none: for inputs that are made on the way."""
    token = _settings.set(_settings.get()._replace(progress=False))
    try:
        yield
    finally:
        _settings.reset(token)


class Run:
    """One call: ``with Run(...) as run: run.check(lib.bvx_...(run.context, ...))``.

    Its progress is one rise over ``calls`` calls of the library that take a while.
    """

    __slots__ = ("context", "memory_limit", "progress", "error", "handle", "meshes", "kept", "token", "bar", "calls", "call", "moved",
                 "reached", "stage", "asked", "__weakref__")

    def __init__(self, threads: int | None = None, memory_limit: int | None = None, progress: Progress = None, calls: int = 1) -> None:
        given = _settings.get()
        options = ffi.new("bvx_context_options *")
        options.struct_size = ffi.sizeof("bvx_context_options")
        wanted = given.threads if threads is None else threads
        options.threads = in_range("threads (0: all processors)", wanted, 0, 1024) or _default_threads()
        limit = given.memory_limit if memory_limit is None else memory_limit
        self.memory_limit = options.memory_limit = in_range("memory_limit (bytes)", limit, 0, 2**64 - 1)
        self.handle = ffi.new_handle(self)
        options.progress.call = lib.bvxpy_progress
        options.progress.user = self.handle
        self.asked = progress is not None
        self.progress, self.bar = _callable_of(given.progress if progress is None else progress)
        self.calls, self.call, self.moved = calls, 0, False
        self.reached, self.stage = 0.0, "done"
        self.error: BaseException | None = None
        self.meshes: list[Any] = []
        self.kept: list[Any] = []
        out = ffi.new("bvx_context **")
        status = lib.bvx_context_create_version(lib.BVX_VERSION, options, out)
        if status != lib.BVX_OK:
            fault = lib.bvx_context_fault(lib.BVX_VERSION, options)
            text = ffi.string(fault).decode() if fault != ffi.NULL else ffi.string(lib.bvx_status_text(status)).decode()
            raise BY_CODE.get(status, Error)(f"no context: {text}")
        self.context = ffi.gc(out[0], lib.bvx_context_destroy)

    def __enter__(self) -> Run:
        self.token = _running.set((*_running.get(), self))
        return self

    def __exit__(self, kind: Any, *_: object) -> None:
        _running.reset(self.token)
        self.context = self.handle = None
        try:
            if kind is None and self.progress is not None and (self.asked or self.reached > 0.0 or self.moved):
                self.progress(self.stage, 1.0)
        finally:
            if self.bar is not None:
                self.bar.close()

    def report(self, stage: str, fraction: float) -> Any:
        """What the library reports, as a part of the one rise; its 1 comes at the end of all."""
        self.stage = stage
        if fraction >= 1.0:
            if self.moved and self.call + 1 < self.calls:
                self.call, self.moved = self.call + 1, False
            return None
        assert self.progress is not None
        self.moved = True
        self.reached = max(self.reached, (self.call + fraction) / self.calls)
        return self.progress(stage, self.reached)

    def keep(self, things: Any) -> None:
        """Hold on to what a struct points at until the call is over."""
        self.kept.append(things)

    def message(self) -> str:
        """What was wrong, without the name of the C function before it; functions that are a remedy have their names here."""
        return _spelled(lib.bvx_last_error(self.context).text)

    def warn(self) -> None:
        """Hand on the warnings of the call that has ended, each once, at the caller's line."""
        while (found := lib.bvx_next_warning(self.context)) != ffi.NULL:
            box = (tuple(found.low), tuple(found.high)) if found.placed else None
            code = ffi.string(found.name).decode()
            text = f"{_spelled(found.text)} [{code}]"
            warnings.warn(ResultWarning(text, code, tuple(found.value[0:found.value_count]), box), stacklevel=depth_of_caller())

    def check(self, status: int) -> None:
        """Raise what a status other than 0 stands for."""
        if status == 0:
            if self.error is not None and not isinstance(self.error, Exception):
                raise self.error  # an interrupt that came with the last word of a call
            self.warn()
            return
        if status == lib.BVX_CANCELLED and self.error is not None:
            raise self.error
        if status == lib.BVX_ERR_RANGE:
            for mesh in self.meshes:
                mesh._refuse_negative_faces()
        raise self.failure(status)

    def failure(self, status: int) -> Error:
        """The last failure as an exception."""
        found = lib.bvx_last_error(self.context)
        kind = BY_CODE.get(status, Error)
        if found.status == status == lib.BVX_ERR_ARGUMENT and found.reason == lib.BVX_REASON_RANGE:
            kind = OptionRangeError
        made = kind(self.message() or ffi.string(lib.bvx_status_text(status)).decode())
        if found.status == status:
            made.reason = _reasons().get(found.reason, made.reason)
            made.index = found.index if found.index >= 0 else None
        return made


def in_range(name: str, value: Any, low: int, high: int) -> int:
    """An integer between bounds; 3.0 and numpy's numbers pass, 3.5, True and text do not."""
    if isinstance(value, bool):
        raise TypeError(f"{name} must be an integer, not {value!r}")
    try:
        number = value.__index__()
    except AttributeError:
        if not isinstance(value, float) or not value.is_integer():
            raise TypeError(f"{name} must be an integer, not {value!r}") from None
        number = int(value)
    if not low <= number <= high:
        raise OptionRangeError(f"{name} is {number}; it must be {low} to {high}")
    return number


def connected(connectivity: Any) -> int:
    """Neighbors of a voxel: through faces, edges too, or corners too."""
    if in_range("connectivity", connectivity, -(2**63), 2**63) not in (6, 18, 26):
        raise OptionRangeError(f"connectivity is {connectivity}; it must be 6 (faces), 18 (edges too) or 26 (corners too)")
    return int(connectivity)


def options_of(kind: str) -> Any:
    """An option struct with its defaults: zero, but for its size."""
    options = ffi.new(f"bvx_{kind} *")
    options.struct_size = ffi.sizeof(f"bvx_{kind}")
    return options


def or_none(value: float, name: str = "") -> float:
    """A number as options take it whose 0 stands for their default, and -1 for 0."""
    if value < 0:
        raise OptionRangeError(f"{name} is {value}; it must not be below 0")
    return value or lib.BVX_NONE


def sharpness(sharp: bool | None) -> int:
    """BVX_SHARP_..., None for what the mesh's edges say."""
    return lib.BVX_SHARP_AUTO if sharp is None else lib.BVX_SHARP_ALWAYS if sharp else lib.BVX_SHARP_NEVER


def function(name: str) -> Any:
    """A function of the library that an older build may lack."""
    found = getattr(lib, name, None)
    if found is None:
        raise UnsupportedError(f"this build of the library has no {name}")
    return found


def choice(name: str, value: Any, prefix: str, names: dict[str, str] | tuple[str, ...]) -> int:
    """The number behind a name: choice("fill", "parity", "BVX_FILL_", (...))."""
    if not isinstance(value, str):
        raise TypeError(f"{name} must be one of {', '.join(names)}, not {value!r}")
    plain = value.lower().replace("_", "-")
    if plain not in names:
        meant = next((f" ({word!r} is meant?)" for word, others in _PEERS.items() if word in names and plain in others), "")
        raise ArgumentError(f"{name} is {value!r}; it must be one of {', '.join(names)}{meant}")
    number = getattr(lib, prefix + plain.upper().replace("-", "_"), None)
    if number is None:
        raise UnsupportedError(f"{name}={value!r}: this build of the library has no such rule")
    return number


# What other libraries call an operation, and a target of simplification.
_PEERS = {"difference": ("subtract", "subtraction", "minus", "sub", "diff", "not"), "intersection": ("intersect", "and", "common"),
          "union": ("add", "or", "merge", "unite", "unify", "fuse", "sum")}
_TARGETS = {**{name: f"round({name} * mesh.n_faces)" for name in ("ratio", "target_ratio", "percent", "factor")},
            **{name: f"round((1 - {name}) * mesh.n_faces)" for name in ("reduction", "target_reduction")},
            **{name: name for name in ("face_count", "target_count", "target_faces", "target_number_of_triangles")}}


def known(function: Any, options: Any, given: Any) -> None:
    """Refuse a name that is none of a function's options, with the nearest one, or with what other libraries' name of a target is here."""
    for name in given.keys() - options.__annotations__.keys():
        if name in _TARGETS and "triangles" in function.__kwdefaults__:
            raise TypeError(f"{function.__name__} takes no {name}: give triangles={_TARGETS[name]}")
        near = difflib.get_close_matches(name, [*function.__kwdefaults__, *options.__annotations__], 1)
        raise TypeError(f"{function.__name__}() got an unexpected keyword argument {name!r}" + "".join(f". Did you mean {word!r}?" for word in near))


def number_of(format: str) -> int:
    number = getattr(lib, f"BVX_FORMAT_{format.upper()}", None)
    if number is None:
        raise UnsupportedError(f"this build of the library has no format {format!r}")
    return number


def name_of(value: int, prefix: str, names: tuple[str, ...]) -> str:
    """The other way round."""
    for name in names:
        if getattr(lib, prefix + name.upper().replace("-", "_"), None) == value:
            return name
    return str(value)


_NAMES = dir(lib)


def names_of(prefix: str, *but: str) -> tuple[str, ...]:
    """The choices that the header has, by their numbers: names_of("BVX_FILL_", ...) begins with "auto"."""
    found = (name for name in _NAMES if name.startswith(prefix) and not name.startswith(("BVX_FORMAT_UNKNOWN", prefix + "COUNT", *but)))
    return tuple(name.removeprefix(prefix).lower().replace("_", "-") for name in sorted(found, key=lambda name: getattr(lib, name)))


def formats_in(bits: int) -> tuple[str, ...]:
    """The formats of one of the header's sets, such as BVX_MESHES_READ."""
    return tuple(name for name in names_of("BVX_FORMAT_") if bits >> getattr(lib, "BVX_FORMAT_" + name.upper()) & 1)


FACE_RULES = names_of("BVX_FACE_")
SIDES = names_of("BVX_OPEN_")
INSIDE_RULES = names_of("BVX_FILL_", "BVX_FILL_REASON_")
FILLS, REPAIR_SIGNS, SIGN_RULES = (tuple(name for number, name in enumerate(INSIDE_RULES) if bits >> number & 1)
                                   for bits in (lib.BVX_FILLS_OF_SOLID, lib.BVX_FILLS_OF_REPAIR, lib.BVX_FILLS_OF_FIELD))
FILL_REASONS = names_of("BVX_FILL_REASON_")


def put_open_sides(options: Any, sides: Any) -> None:
    """Sides by name, or one string with commas between, into options."""
    for side in sides.split(",") if isinstance(sides, str) and sides else sides:
        options.open_sides |= choice("open_sides", side, "BVX_OPEN_", SIDES)


def version() -> str:
    """The library's version, ``"0.1.0"``."""
    number = lib.bvx_version()
    return f"{number // 10000}.{number // 100 % 100}.{number % 100}"


if lib.bvx_version() != lib.BVX_VERSION:
    raise VersionError("the extension's header and code are of different versions")
