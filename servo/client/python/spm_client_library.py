# SPDX-License-Identifier: Apache-2.0
"""The shared library behind spm_client.py: finding it, its structs, and its functions' types."""

from __future__ import annotations

import ctypes
import enum
import os
from pathlib import Path


class Code(enum.IntEnum):
    """What a call of the library returns; see spm_client.h."""
    OK = 0
    BAD_ARGUMENT = 1
    NO_DAEMON = 2
    REFUSED = 3
    INTERNAL = 4
    VERSION_DIFFERS = 5
    RING_FULL = 6
    BUSY = 7
    NOT_THERE = 8
    NOT_MOVABLE = 9


class DaemonState(enum.IntEnum):
    RUNNING = 0
    STALLED = 1
    ENDED = 2
    GONE = 3


class Cause(enum.IntEnum):
    """Why the force is zero. A newer daemon may have further causes: those stay numbers."""
    FORCE_ON = 0
    STARTING = 1
    ASSET_LOST = 2
    NOT_A_NUMBER = 3
    DEVICE_FAULT = 4
    STOPPING = 5
    DEVICE_SILENT = 6
    DEVICE_GONE = 7
    NOT_HOMED = 8
    JUMPED = 9
    CLUTCHED = 10
    OUTSIDE_WORKSPACE = 11
    APPLICATION_SILENT = 12
    STALLED = 13
    UNACKNOWLEDGED = 14
    NOT_ENABLED = 15
    RUNAWAY = 16
    UNCONFIRMED = 17


class Role(enum.IntEnum):
    APPLICATION = 0
    SUPERVISOR = 1
    OBSERVER = 2


class EventKind(enum.IntEnum):
    CONTACT_BEGAN = 1
    CONTACT_ENDED = 2
    BUTTON_PRESSED = 3
    BUTTON_RELEASED = 4
    FORCE_CUT = 5
    FORCE_BACK = 6
    DEVICE_LOST = 7
    DEVICE_FOUND = 8
    DAEMON_LOST = 9
    DAEMON_FOUND = 10


class Limit(enum.IntFlag):
    """Which limits a tick met."""
    NONE = 0
    FORCE_CAP = 1   # of the force that was sent
    TORQUE_CAP = 2  # of the torque that was sent
    TOOL_CAP = 4    # of the coupling of hand and tool: the tool stays behind


class HandState(enum.IntEnum):
    """Whether applications may lead a device's hand."""
    OWN = 0   # it goes its own way
    FREE = 1  # `--device sim:hand=live`: an application may lead it
    LED = 2   # one does


class Method(enum.IntEnum):
    """How the force of an object is found."""
    SPM = 0
    PAPER = 1
    PROXY = 2


class EffectKind(enum.IntEnum):
    SPRING = 1   # pulls towards `point`
    VISCOUS = 2  # brakes by `damping`
    MAGNET = 3   # pulls from outside towards the surface of `object`
    DETENTS = 4  # pulls along `axis` to the nearest of places `spacing` apart, one at `point`


class ClientError(Exception):
    """A call failed: `code` says how, the text what to do."""

    def __init__(self, code: int, text: str) -> None:
        super().__init__(text)
        self.code = Code(code)


# The structs of spm_client.h, in its order.

class OptionsData(ctypes.Structure):
    _fields_ = [("size", ctypes.c_uint32), ("timeout_ms", ctypes.c_int32),
                ("path", ctypes.c_char_p), ("name", ctypes.c_char_p),
                ("application", ctypes.c_char_p), ("role", ctypes.c_uint32),
                ("server_user", ctypes.c_uint32), ("reconnect", ctypes.c_uint32),
                ("reserved", ctypes.c_uint32)]


class InfoData(ctypes.Structure):
    _fields_ = [("size", ctypes.c_uint32), ("process", ctypes.c_uint32),
                ("rate_hz", ctypes.c_double), ("device_count", ctypes.c_uint32),
                ("asset_count", ctypes.c_uint32), ("object_count", ctypes.c_uint32),
                ("cause_count", ctypes.c_uint32), ("daemon_version", ctypes.c_char * 32),
                ("library_version", ctypes.c_char * 32)]


class TickData(ctypes.Structure):
    _fields_ = [("size", ctypes.c_uint32), ("device_count", ctypes.c_uint32),
                ("object_count", ctypes.c_uint32), ("object_total", ctypes.c_uint32),
                ("tick", ctypes.c_uint64), ("time_ns", ctypes.c_int64)]


class DeviceData(ctypes.Structure):
    _fields_ = [("size", ctypes.c_uint32), ("connected", ctypes.c_uint32),
                ("tick", ctypes.c_uint64), ("position", ctypes.c_double * 3),
                ("orientation", ctypes.c_double * 4), ("velocity", ctypes.c_double * 3),
                ("force", ctypes.c_double * 3), ("torque", ctypes.c_double * 3),
                ("depth", ctypes.c_double), ("contact", ctypes.c_uint32),
                ("buttons", ctypes.c_uint32), ("cause", ctypes.c_uint32),
                ("health", ctypes.c_uint32), ("contacts", ctypes.c_uint32),
                ("cuts", ctypes.c_uint32), ("proxy", ctypes.c_double * 3),
                ("force_cap", ctypes.c_double), ("angular_velocity", ctypes.c_double * 3),
                ("torque_cap", ctypes.c_double), ("limits", ctypes.c_uint32),
                ("has_tool", ctypes.c_uint32), ("contact_count", ctypes.c_uint32),
                ("level", ctypes.c_uint32), ("culled", ctypes.c_uint32),
                ("hand", ctypes.c_uint32), ("tool_position", ctypes.c_double * 3),
                ("tool_orientation", ctypes.c_double * 4),
                ("proxy_orientation", ctypes.c_double * 4)]


class ContactData(ctypes.Structure):
    _fields_ = [("size", ctypes.c_uint32), ("device", ctypes.c_uint32),
                ("object", ctypes.c_uint64), ("place", ctypes.c_double * 3),
                ("normal", ctypes.c_double * 3), ("force", ctypes.c_double * 3),
                ("depth", ctypes.c_double)]


class ObjectData(ctypes.Structure):
    _fields_ = [("size", ctypes.c_uint32), ("asset", ctypes.c_uint32), ("id", ctypes.c_uint64),
                ("tick", ctypes.c_uint64), ("position", ctypes.c_double * 3),
                ("orientation", ctypes.c_double * 4), ("scale", ctypes.c_double),
                ("force", ctypes.c_double * 3), ("torque", ctypes.c_double * 3),
                ("silent", ctypes.c_double), ("movable", ctypes.c_uint32),
                ("contact", ctypes.c_uint32), ("driven", ctypes.c_uint32),
                ("reserved", ctypes.c_uint32)]


class PoseData(ctypes.Structure):
    _fields_ = [("size", ctypes.c_uint32), ("reserved", ctypes.c_uint32),
                ("position", ctypes.c_double * 3), ("orientation", ctypes.c_double * 4),
                ("period", ctypes.c_double), ("deadline", ctypes.c_double)]


class MaterialData(ctypes.Structure):
    _fields_ = [("size", ctypes.c_uint32), ("fields", ctypes.c_uint32),
                ("stiffness", ctypes.c_double), ("friction_stick", ctypes.c_double),
                ("friction_slide", ctypes.c_double), ("damping", ctypes.c_double),
                ("texture_amplitude", ctypes.c_double), ("texture_wavelength", ctypes.c_double),
                ("texture_seed", ctypes.c_uint64)]


class PushData(ctypes.Structure):
    _fields_ = [("size", ctypes.c_uint32), ("reserved", ctypes.c_uint32),
                ("force", ctypes.c_double * 3), ("torque", ctypes.c_double * 3),
                ("hold", ctypes.c_double)]


class EffectData(ctypes.Structure):
    _fields_ = [("size", ctypes.c_uint32), ("kind", ctypes.c_uint32),
                ("stiffness", ctypes.c_double), ("damping", ctypes.c_double),
                ("most_force", ctypes.c_double), ("range", ctypes.c_double),
                ("spacing", ctypes.c_double), ("point", ctypes.c_double * 3),
                ("axis", ctypes.c_double * 3), ("object", ctypes.c_uint64)]


class HandData(ctypes.Structure):
    _fields_ = [("size", ctypes.c_uint32), ("reserved", ctypes.c_uint32),
                ("position", ctypes.c_double * 3), ("orientation", ctypes.c_double * 4),
                ("hold", ctypes.c_double)]


class FeelData(ctypes.Structure):
    _fields_ = [("size", ctypes.c_uint32), ("method", ctypes.c_uint32),
                ("stabilized", ctypes.c_uint32), ("reserved", ctypes.c_uint32),
                ("stiffness", ctypes.c_double), ("friction_stick", ctypes.c_double),
                ("friction_slide", ctypes.c_double), ("damping", ctypes.c_double),
                ("texture_amplitude", ctypes.c_double), ("texture_wavelength", ctypes.c_double),
                ("texture_seed", ctypes.c_uint64)]


class CountsData(ctypes.Structure):
    _fields_ = [("size", ctypes.c_uint32), ("last_refusal", ctypes.c_uint32),
                ("sent", ctypes.c_uint64), ("taken", ctypes.c_uint64),
                ("refused", ctypes.c_uint64), ("last_refused", ctypes.c_uint64)]


class EventData(ctypes.Structure):
    _fields_ = [("size", ctypes.c_uint32), ("kind", ctypes.c_uint32), ("device", ctypes.c_uint32),
                ("value", ctypes.c_uint32), ("tick", ctypes.c_uint64)]


class LoopData(ctypes.Structure):
    _fields_ = [("size", ctypes.c_uint32), ("reserved", ctypes.c_uint32),
                ("time_ns", ctypes.c_int64), ("ticks", ctypes.c_uint64),
                ("missed", ctypes.c_uint64), ("skipped", ctypes.c_uint64),
                ("busy_ns", ctypes.c_uint64), ("wake_max_ns", ctypes.c_uint64),
                ("busy_max_ns", ctypes.c_uint64), ("taken", ctypes.c_uint64),
                ("refused", ctypes.c_uint64), ("garbage", ctypes.c_uint64),
                ("wake", ctypes.c_uint64 * 64), ("busy", ctypes.c_uint64 * 64),
                ("degraded", ctypes.c_uint64), ("held", ctypes.c_uint64),
                ("shortened", ctypes.c_uint64), ("coarse", ctypes.c_uint64)]


class DeviceCountsData(ctypes.Structure):
    _fields_ = [("size", ctypes.c_uint32), ("last_cause", ctypes.c_uint32),
                ("contact_ticks", ctypes.c_uint64), ("cap_hits", ctypes.c_uint64),
                ("slew_hits", ctypes.c_uint64), ("force_max", ctypes.c_double),
                ("energy", ctypes.c_double), ("generated_max", ctypes.c_double),
                ("torque_cap_hits", ctypes.c_uint64), ("torque_slew_hits", ctypes.c_uint64),
                ("tool_cap_hits", ctypes.c_uint64), ("torque_max", ctypes.c_double)]


class ApplicationData(ctypes.Structure):
    _fields_ = [("size", ctypes.c_uint32), ("connection", ctypes.c_uint32),
                ("process", ctypes.c_uint32), ("role", ctypes.c_uint32),
                ("name", ctypes.c_char * 64)]


def sized(kind: type[ctypes.Structure]) -> ctypes.Structure:
    return kind(size=ctypes.sizeof(kind))


def _built() -> list[str]:
    """Where a checkout that this file lies in builds the library; nothing where it is installed."""
    return [str(checkout / "build" / preset / "lib" / "libspm_client.so")
            for checkout in list(Path(__file__).resolve().parents)[3:4]
            if (checkout / "CMakePresets.json").exists() for preset in ("release", "debug")]


def load() -> ctypes.CDLL:
    candidates = [os.environ.get("SPM_CLIENT_LIBRARY"),
                  str(Path(__file__).resolve().parent / "libspm_client.so"),
                  *_built(), "libspm_client.so.1"]
    for candidate in filter(None, candidates):
        try:
            library = ctypes.CDLL(candidate)
        except OSError:
            continue
        _declare(library)
        return library
    raise ClientError(Code.INTERNAL, "libspm_client.so was not found: install it, build it in the "
                                     "checkout by scripts/build, or name it in the environment "
                                     "variable SPM_CLIENT_LIBRARY")


def _declare(library: ctypes.CDLL) -> None:
    handle, u32, u64, size = ctypes.c_void_p, ctypes.c_uint32, ctypes.c_uint64, ctypes.c_size_t
    text, pointer = ctypes.c_char_p, ctypes.POINTER
    code = ctypes.c_int
    for name, result, arguments in [
        ("connect", code, [pointer(OptionsData), pointer(handle), text, size]),
        ("disconnect", None, [handle]),
        ("reconnect", code, [handle]),
        ("text", text, [code]),
        ("daemon_state", code, [handle, pointer(ctypes.c_double)]),
        ("read_info", code, [handle, pointer(InfoData)]),
        ("device_name", code, [handle, u32, text, size]),
        ("asset_name", code, [handle, u32, text, size]),
        ("object_name", code, [handle, u64, text, size]),
        ("cause", code, [handle, u32, pointer(text), pointer(text)]),
        ("read_tick", code, [handle, pointer(TickData)]),
        ("read_device", code, [handle, u32, pointer(DeviceData)]),
        ("read_object", code, [handle, u64, pointer(ObjectData)]),
        ("read_contacts", code,
         [handle, u32, pointer(TickData), pointer(ContactData), size, pointer(size)]),
        ("read_all", code, [handle, pointer(TickData), pointer(DeviceData), size, pointer(ObjectData), size]),
        ("add_object", code,
         [handle, u32, pointer(PoseData), ctypes.c_double, pointer(MaterialData), pointer(u64)]),
        ("move_object", code, [handle, u64, pointer(PoseData)]),
        ("place_object", code, [handle, u64, pointer(PoseData)]),
        ("remove_object", code, [handle, u64]),
        ("set_material", code, [handle, u64, pointer(MaterialData)]),
        ("set_clutch", code, [handle, u32, ctypes.c_int]),
        ("set_force_cap", code, [handle, u32, ctypes.c_double]),
        ("set_method", code, [handle, u64, u32]),
        ("stabilize", code, [handle, ctypes.c_int]),
        ("push_hand", code, [handle, u32, pointer(PushData)]),
        ("set_effect", code, [handle, u32, u32, pointer(EffectData)]),
        ("remove_effect", code, [handle, u32, u32]),
        ("acknowledge", code, [handle, u32]),
        ("lead_hand", code, [handle, u32, pointer(HandData)]),
        ("read_feel", code, [handle, u64, pointer(FeelData)]),
        ("asset_path", code, [handle, u32, text, size]),
        ("border", code, [handle, u32, pointer(ctypes.c_double), pointer(ctypes.c_double)]),
        ("wait_tick", code, [handle, u64, ctypes.c_double, pointer(TickData)]),
        ("refusals", code, [handle, pointer(CountsData)]),
        ("refusal", text, [u32]),
        ("next_event", code, [handle, pointer(EventData)]),
        ("read_loop", code, [handle, pointer(LoopData)]),
        ("bucket_end", u64, [u32]),
        ("read_device_counts", code, [handle, u32, pointer(DeviceCountsData)]),
        ("read_application", code, [handle, u32, pointer(ApplicationData)]),
    ]:
        function = getattr(library, f"spm_client_{name}")
        function.restype = result
        function.argtypes = arguments
