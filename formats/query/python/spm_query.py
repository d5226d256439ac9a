# SPDX-License-Identifier: Apache-2.0
"""libspm_query from Python: signed distance, normal and force from a baked asset.

    import numpy as np
    from spm_query import Asset

    with Asset("teeth.spm.exr") as asset:
        answers = asset.query(np.random.uniform(-0.01, 0.01, (100_000, 3)))
        print(answers["distance"].min(), asset.force((0, 0, 0.001), stiffness=1000).force)

Points are in the asset's frame, metres; distances negative inside; forces in newtons, on the hand.
A batch of points is one call of the library, which reads them where they lie: anything with a buffer
of doubles will do, such as a NumPy array or an array.array. Without NumPy answers are ctypes structs.

The library is looked for in $SPM_QUERY_LIBRARY, beside this file, in the build folder of the
checkout that this file lies in, and where the system has its libraries. Nothing but the standard
library is needed.
"""

from __future__ import annotations

import ctypes
import enum
import os
from pathlib import Path
from types import TracebackType
from typing import Any, NamedTuple, Optional, Sequence

__all__ = ["Answer", "Asset", "Contact", "Method", "QueryError", "Source", "Status"]


class Status(enum.IntEnum):
    """Where a point lies."""
    EXACT = 0   # in the band
    DEEP = 1    # inside, beyond the band: distance is a bound
    FAR = 2     # outside, beyond the margin: distance is NaN
    PRUNED = 3  # left out by the bake: distance is NaN


class Source(enum.IntEnum):
    """What answered."""
    TILE = 0
    TRIANGLES = 1
    NONE = 2


class Method(enum.IntEnum):
    """How a force is computed."""
    SPM = 0
    PAPER = 1        # `full` assets
    PAPER_PROBE = 2  # likewise


class Answer(ctypes.Structure):
    """spm_query_answer of spm_query.h."""
    _fields_ = [("distance", ctypes.c_double), ("normal", ctypes.c_double * 3),
                ("plane", ctypes.c_int32), ("layer", ctypes.c_int32), ("source", ctypes.c_int32),
                ("status", ctypes.c_int32)]


class ForceSettings(ctypes.Structure):
    """spm_query_force_settings of spm_query.h."""
    _fields_ = [("stiffness", ctypes.c_double), ("probe_radius", ctypes.c_double),
                ("method", ctypes.c_int32), ("probe", ctypes.c_int32),
                ("probe_length", ctypes.c_double), ("probe_axis", ctypes.c_double * 3),
                ("form", ctypes.c_int32), ("reserved", ctypes.c_int32)]


class ContactData(ctypes.Structure):
    """spm_query_contact of spm_query.h."""
    _fields_ = [("force", ctypes.c_double * 3), ("normal", ctypes.c_double * 3),
                ("depth", ctypes.c_double), ("contact", ctypes.c_int32), ("deep", ctypes.c_int32)]


class Contact(NamedTuple):
    """Force for a probe: N, unit, m."""
    force: tuple[float, ...]
    normal: tuple[float, ...]
    depth: float
    touching: bool
    deep: bool


class QueryError(Exception):
    """What went wrong, in a sentence, with the exit code that spm-bake would have."""

    def __init__(self, code: int, message: str) -> None:
        super().__init__(message)
        self.code = code


POINT = ctypes.c_double * 3


def _built() -> list[str]:
    """Where a checkout that this file lies in builds the library; nothing where it is installed."""
    return [str(checkout / "build" / preset / "lib" / "libspm_query.so.1")
            for checkout in list(Path(__file__).resolve().parents)[3:4]
            if (checkout / "CMakePresets.json").exists() for preset in ("release", "debug")]


def _load() -> ctypes.CDLL:
    beside = Path(__file__).resolve().parent
    names = [os.environ.get("SPM_QUERY_LIBRARY"), str(beside / "libspm_query.so.1"), *_built(),
             "libspm_query.so.1"]
    problem = ""
    for name in filter(None, names):
        try:
            return _typed(ctypes.CDLL(name))
        except OSError as why:
            problem = str(why)
    raise QueryError(2, f"libspm_query.so.1 was not found ({problem}): install libspm-query1, build it in "
                        "the checkout by scripts/build, or set SPM_QUERY_LIBRARY to its path")


def _typed(library: ctypes.CDLL) -> ctypes.CDLL:
    asset, pointer = ctypes.c_void_p, ctypes.POINTER
    for name, result, arguments in (
            ("open", ctypes.c_int, [ctypes.c_char_p, pointer(asset), ctypes.c_char_p, ctypes.c_size_t]),
            ("close", None, [asset]),
            ("lost", ctypes.c_int, [asset]),
            ("band", None, [asset, pointer(ctypes.c_double), pointer(ctypes.c_double)]),
            ("memory", ctypes.c_size_t, [asset]),
            ("box", None, [asset, POINT, POINT]),
            ("batch", None, [asset, ctypes.c_void_p, ctypes.c_size_t, ctypes.c_void_p]),
            ("force", ctypes.c_int, [asset, pointer(ForceSettings), POINT, pointer(ContactData)])):
        function = getattr(library, "spm_query_" + name)
        function.restype, function.argtypes = result, arguments
    return library


def _numpy() -> Any:
    try:
        import numpy
    except ImportError:
        return None
    return numpy


class Asset:
    """A baked file, opened: checked whole and mapped. Raises QueryError. Any number of threads may
    query one asset. Closed by `close` or at the end of `with`."""

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self._handle = ctypes.c_void_p()
        self._library = _load()
        message = ctypes.create_string_buffer(1024)
        code = self._library.spm_query_open(os.fsencode(path), ctypes.byref(self._handle), message,
                                            len(message))
        if code != 0:
            raise QueryError(code, message.value.decode("utf-8", "replace"))

    def close(self) -> None:
        """May be called again."""
        handle, self._handle = self._handle, ctypes.c_void_p()
        if handle:
            self._library.spm_query_close(handle)

    def __enter__(self) -> Asset:
        return self

    def __exit__(self, kind: Optional[type[BaseException]], value: Optional[BaseException],
                 trace: Optional[TracebackType]) -> None:
        self.close()

    @property
    def lost(self) -> bool:
        """Whether bytes of the file vanished, so that answers are no longer to be trusted."""
        return bool(self._library.spm_query_lost(self._open()))

    @property
    def band(self) -> tuple[float, float]:
        """The depth inside and the margin outside that are answered exactly, m."""
        depth, margin = ctypes.c_double(), ctypes.c_double()
        self._library.spm_query_band(self._open(), ctypes.byref(depth), ctypes.byref(margin))
        return depth.value, margin.value

    @property
    def memory(self) -> int:
        """Bytes that answers may come from."""
        return self._library.spm_query_memory(self._open())

    @property
    def box(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """The two corners of the object's box, m."""
        low, high = POINT(), POINT()
        self._library.spm_query_box(self._open(), low, high)
        return tuple(low), tuple(high)

    def query(self, points: Any) -> Any:
        """Answers at points, x y z each: from a buffer of doubles without a copy, from any other
        sequence with one. Gives a structured NumPy array, or an array of Answer without NumPy."""
        buffer, count = _doubles(points)
        answers = (Answer * count)()
        address = ctypes.addressof(buffer) if buffer is not None else None
        self._library.spm_query_batch(self._open(), address, count, answers)
        numpy = _numpy()
        return answers if numpy is None else numpy.ctypeslib.as_array(answers)

    def force(self, point: Sequence[float], *, stiffness: float, probe_radius: float = 0.0,
              method: Method = Method.SPM, settings: Optional[ForceSettings] = None) -> Contact:
        """The force of a spring, N/m, on a ball at a point. `settings` has what else
        spm_query_force_settings can say, and replaces the other arguments."""
        if settings is None:
            settings = ForceSettings(stiffness=stiffness, probe_radius=probe_radius, method=method)
        found = ContactData()
        code = self._library.spm_query_force(self._open(), ctypes.byref(settings), POINT(*point),
                                             ctypes.byref(found))
        if code != 0:
            raise QueryError(code, "the settings of the force are out of range, or not for this asset; "
                                   "see spm_query_force in spm_query.h")
        return Contact(tuple(found.force), tuple(found.normal), found.depth, bool(found.contact),
                       bool(found.deep))

    def _open(self) -> ctypes.c_void_p:
        if not self._handle:
            raise QueryError(1, "the asset is closed; open it again")
        return self._handle


def _doubles(points: Any) -> tuple[Any, int]:
    """Points as a ctypes array over their own memory where they are doubles in one piece, and their
    number."""
    try:
        view = memoryview(points)
    except TypeError:
        numpy = _numpy()
        if numpy is not None:
            view = memoryview(numpy.ascontiguousarray(points, dtype=float))
        else:
            flat = [float(value) for point in points for value in point]
            view = memoryview((ctypes.c_double * len(flat))(*flat))
    if view.format not in ("d", "<d", "=d") or not view.c_contiguous:
        numpy = _numpy()
        if numpy is None:
            raise QueryError(1, "points must be doubles in one piece; convert them first")
        view = memoryview(numpy.ascontiguousarray(points, dtype=float))
    count, left = divmod(view.nbytes, ctypes.sizeof(POINT))
    if left or (view.ndim == 2 and view.shape[1] != 3) or view.ndim > 2:
        raise QueryError(1, "points must have three coordinates each: an array of N x 3")
    if count == 0:
        return None, 0
    if view.readonly:
        return (ctypes.c_char * view.nbytes).from_buffer_copy(view), count
    return (ctypes.c_char * view.nbytes).from_buffer(view), count
