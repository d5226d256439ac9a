# SPDX-License-Identifier: Apache-2.0
"""libspm_client from Python: applications beside the daemon `spm-servo run`.

The daemon computes the force beside the device. An application reads what the hand does, moves the
objects of the scene and changes how they feel, at its own pace. Lengths in metres, forces in
newtons, torques in newton metres, quaternions unit with w first, all in the world frame.

    from spm_client import Client

    with Client(application="my study") as client:
        hand = client.device(0)
        print(hand.position, hand.force, hand.cause_text)
        client.move(0, position=(0.0, 0.01, 0.0), period=1 / 90)

The library is looked for in $SPM_CLIENT_LIBRARY, beside this file, in the build folder of the
checkout that this file lies in, and where the system has its libraries. Nothing but the standard
library is needed.
"""

from __future__ import annotations

import ctypes
import os
from types import TracebackType
from typing import Iterator, Optional, Sequence

from spm_client_data import (IDENTITY, Application, Contact, Device, DeviceCounts, Effect, Event, Feel,
                             Info, Loop, Material, Object, Refusals)
from spm_client_library import (ApplicationData, Cause, ClientError, Code, ContactData,
                                CountsData, DaemonState, DeviceCountsData, DeviceData, EffectData,
                                EffectKind, EventData, EventKind, FeelData, HandData, HandState,
                                InfoData, Limit, LoopData, MaterialData, Method, ObjectData,
                                OptionsData, PoseData, PushData, Role, TickData, load, sized)

__all__ = ["Application", "Client", "ClientError", "Code", "Cause", "Contact", "DaemonState",
           "Device", "DeviceCounts", "Effect", "EffectKind", "Event", "EventKind", "Feel", "HandState",
           "Info", "Limit", "Loop", "Material", "Method", "Object", "Refusals"]

NAME_BYTES = 64
PATH_BYTES = 512
MAX_DEVICES = 8
MAX_OBJECTS = 64
MAX_CONTACTS = 16  # of a device's tool
ALL_EFFECTS = 2**32 - 1
TOOL_OF_DEVICE = 2**63  # Contact.object where the tool of another device is touched: this and its number


class Client:
    """A connection to the daemon, closed by `close` or at the end of `with`. Raises ClientError.

    A `supervisor` may change what belongs to other applications; an `observer` reads alone, and takes
    none of the 16 places for applications. `server_user`: id of a user whose daemon is trusted, beside
    those of this user and of root. With `reconnect` a daemon that was restarted is found by the next
    call; until then calls raise Code.NO_DAEMON, and `events` tells EventKind.DAEMON_LOST and
    DAEMON_FOUND. What this application had added and set is gone then."""

    def __init__(self, *, path: Optional[str] = None, name: Optional[str] = None,
                 application: str = "python", timeout: float = 1.0, supervisor: bool = False,
                 observer: bool = False, server_user: int = 0, reconnect: bool = False) -> None:
        self._handle = ctypes.c_void_p()
        self._library = load()
        options = sized(OptionsData)
        options.timeout_ms = max(1, round(timeout * 1000))
        options.path = os.fsencode(path) if path is not None else None
        options.name = os.fsencode(name) if name is not None else None
        options.application = application.encode("ascii", "replace")
        options.role = (Role.OBSERVER if observer else Role.SUPERVISOR if supervisor
                        else Role.APPLICATION)
        options.server_user = server_user
        options.reconnect = int(reconnect)
        message = ctypes.create_string_buffer(512)
        code = self._library.spm_client_connect(ctypes.byref(options), ctypes.byref(self._handle),
                                                message, len(message))
        if code != Code.OK:
            raise ClientError(code, message.value.decode("utf-8", "replace"))

    def close(self) -> None:
        """Disconnects; objects that were added are removed. May be called again."""
        handle, self._handle = self._handle, ctypes.c_void_p()
        if handle:
            self._library.spm_client_disconnect(handle)

    def reconnect(self) -> None:
        """Looks for the daemon again where it is gone, once."""
        self._check(self._library.spm_client_reconnect(self._open()))

    def __enter__(self) -> Client:
        return self

    def __exit__(self, kind: Optional[type[BaseException]], value: Optional[BaseException],
                 trace: Optional[TracebackType]) -> None:
        self.close()

    def daemon_state(self) -> tuple[DaemonState, float]:
        """Whether the daemon lives, and how long ago its last tick was, s (-1: none so far)."""
        age = ctypes.c_double()
        state = self._library.spm_client_daemon_state(self._open(), ctypes.byref(age))
        return DaemonState(state), age.value

    def info(self) -> Info:
        found = sized(InfoData)
        self._check(self._library.spm_client_read_info(self._open(), ctypes.byref(found)))
        return Info(found.rate_hz, found.process,
                    self._names("device", found.device_count),
                    self._names("asset", found.asset_count),
                    self._names("object", found.object_count),
                    found.daemon_version.decode(), found.library_version.decode())

    def cause(self, cause: int) -> tuple[str, str]:
        """Name of a cause of zero force, and what to do about it; empty for an unknown cause."""
        name, cure = ctypes.c_char_p(), ctypes.c_char_p()
        self._library.spm_client_cause(self._open(), cause, ctypes.byref(name), ctypes.byref(cure))
        return (name.value or b"").decode(), (cure.value or b"").decode()

    def device(self, device: int = 0) -> Device:
        found = sized(DeviceData)
        self._check(self._library.spm_client_read_device(self._open(), device,
                                                         ctypes.byref(found)))
        return self._device(found)

    def contacts(self, device: int = 0) -> list[Contact]:
        """Where the device's tool, ball or point touches, the strongest places, of one tick."""
        found, count = (ContactData * MAX_CONTACTS)(), ctypes.c_size_t()
        found[0].size = ctypes.sizeof(ContactData)
        self._check(self._library.spm_client_read_contacts(
            self._open(), device, None, found, MAX_CONTACTS, ctypes.byref(count)))
        return [Contact(one.device, one.object, tuple(one.place), tuple(one.normal),
                        tuple(one.force), one.depth) for one in found[:count.value]]

    def object(self, id: int) -> Object:
        found = sized(ObjectData)
        self._check(self._library.spm_client_read_object(self._open(), id, ctypes.byref(found)))
        return self._object(found)

    def all(self) -> tuple[list[Device], list[Object]]:
        """All devices and objects, of one and the same tick."""
        tick = sized(TickData)
        devices, objects = (DeviceData * MAX_DEVICES)(), (ObjectData * MAX_OBJECTS)()
        devices[0].size, objects[0].size = ctypes.sizeof(DeviceData), ctypes.sizeof(ObjectData)
        self._check(self._library.spm_client_read_all(self._open(), ctypes.byref(tick), devices,
                                                      MAX_DEVICES, objects, MAX_OBJECTS))
        return ([self._device(devices[i]) for i in range(tick.device_count)],
                [self._object(objects[i]) for i in range(tick.object_count)])

    def events(self) -> Iterator[Event]:
        """What has changed since the last call."""
        event = sized(EventData)
        while True:
            code = self._library.spm_client_next_event(self._open(), ctypes.byref(event))
            if code in (Code.NOT_THERE, Code.BUSY):
                return
            self._check(code)
            yield Event(EventKind(event.kind), event.device, event.value, event.tick)

    def add(self, asset: int, position: Sequence[float] = (0.0, 0.0, 0.0),
            orientation: Sequence[float] = IDENTITY, *, scale: float = 1.0,
            material: Optional[Material] = None) -> int:
        """Adds an object; returns its id."""
        identity = ctypes.c_uint64()
        feel = ctypes.byref(_material(material)) if material is not None else None
        self._check(self._library.spm_client_add_object(
            self._open(), asset, ctypes.byref(_pose(position, orientation, 0.0, 0.0)), scale, feel,
            ctypes.byref(identity)))
        return identity.value

    def move(self, id: int, position: Sequence[float], orientation: Sequence[float] = IDENTITY, *,
             period: float = 0.0, deadline: float = 0.0) -> None:
        """Sends an object's pose; `period` in s is the time to the next one, if it is known."""
        pose = _pose(position, orientation, period, deadline)
        self._check(self._library.spm_client_move_object(self._open(), id, ctypes.byref(pose)))

    def place(self, id: int, position: Sequence[float],
              orientation: Sequence[float] = IDENTITY, *, deadline: float = 0.0) -> None:
        """Puts an object to a pose at once, as if it were lifted and put down there."""
        pose = _pose(position, orientation, 0.0, deadline)
        self._check(self._library.spm_client_place_object(self._open(), id, ctypes.byref(pose)))

    def remove(self, id: int) -> None:
        self._check(self._library.spm_client_remove_object(self._open(), id))

    def set_material(self, id: int, material: Material) -> None:
        feel = _material(material)
        self._check(self._library.spm_client_set_material(self._open(), id, ctypes.byref(feel)))

    def set_clutch(self, device: int, on: bool) -> None:
        """While it is on, the hand moves freely and the tool stays."""
        self._check(self._library.spm_client_set_clutch(self._open(), device, int(on)))

    def set_force_cap(self, device: int, newtons: float) -> None:
        """Holds the device's force below this while connected; never raises the daemon's cap."""
        self._check(self._library.spm_client_set_force_cap(self._open(), device, newtons))

    def set_method(self, id: int, method: Method) -> None:
        """The method by which an object is felt. Method.PAPER needs a `full` asset."""
        self._check(self._library.spm_client_set_method(self._open(), id, method))

    def stabilize(self, on: bool) -> None:
        """The scene's stabilization off or on, as a supervisor; without it a device may shake."""
        self._check(self._library.spm_client_stabilize(self._open(), int(on)))

    def push(self, device: int, force: Sequence[float], hold: float,
             torque: Sequence[float] = (0.0, 0.0, 0.0)) -> None:
        """Pushes the hand by a force, N, and a torque about the tool's origin, N m, for `hold` s (at
        most 1), in place of the last push. A device that gives no torque refuses one."""
        data = sized(PushData)
        data.force = _numbers("force", force, 3)
        data.torque = _numbers("torque", torque, 3)
        data.hold = hold
        self._check(self._library.spm_client_push_hand(self._open(), device, ctypes.byref(data)))

    def set_effect(self, device: int, number: int, effect: Effect) -> None:
        """Sets an effect on the hand, or changes the one that has this number of one's own. It
        stays until it is removed or this application leaves; changes of it make no step."""
        data = sized(EffectData)
        for name in ("kind", "stiffness", "damping", "most_force", "range", "spacing", "object"):
            setattr(data, name, getattr(effect, name))
        data.point = _numbers("point", effect.point, 3)
        data.axis = _numbers("axis", effect.axis, 3)
        self._check(self._library.spm_client_set_effect(self._open(), device, number,
                                                        ctypes.byref(data)))

    def remove_effect(self, device: int, number: int = ALL_EFFECTS) -> None:
        """Removes one's own effect of that number, or all of one's own; a supervisor all."""
        self._check(self._library.spm_client_remove_effect(self._open(), device, number))

    def lead_hand(self, device: int, position: Sequence[float],
                  orientation: Sequence[float] = IDENTITY, *, hold: float = 0.4) -> None:
        """Leads the hand of a simulated device (`--device sim:hand=live`), which is let go after
        `hold` s (at most 1) unless the next pose came. The loop refuses a hand that another
        application leads."""
        data = sized(HandData)
        data.position = _numbers("position", position, 3)
        data.orientation = _numbers("orientation", orientation, 4)
        data.hold = hold
        self._check(self._library.spm_client_lead_hand(self._open(), device, ctypes.byref(data)))

    def free_hand(self, device: int) -> None:
        """Lets a hand go that this application leads: it is slack then."""
        self._check(self._library.spm_client_lead_hand(self._open(), device, None))

    def feel(self, id: int) -> Feel:
        """How an object feels now."""
        found = sized(FeelData)
        self._check(self._library.spm_client_read_feel(self._open(), id, ctypes.byref(found)))
        return Feel(Method(found.method), bool(found.stabilized), found.stiffness,
                    (found.friction_stick, found.friction_slide), found.damping,
                    (found.texture_amplitude, found.texture_wavelength, found.texture_seed))

    def asset_path(self, asset: int) -> str:
        """Where the daemon found an asset, absolute; "" where that is longer than it tells."""
        path = ctypes.create_string_buffer(PATH_BYTES)
        self._check(self._library.spm_client_asset_path(self._open(), asset, path, len(path)))
        return os.fsdecode(path.value)

    def borders(self, device: int = 0) -> tuple[float, float]:
        """N/m at which the device begins to shake, without and with stabilization, as the stability
        laboratory simulates it; 0: not known."""
        bare, stabilized = ctypes.c_double(), ctypes.c_double()
        self._check(self._library.spm_client_border(self._open(), device, ctypes.byref(bare),
                                                    ctypes.byref(stabilized)))
        return bare.value, stabilized.value

    def acknowledge(self, device: int) -> None:
        """Says that a fault is over, where the daemon waits for it (Cause.UNACKNOWLEDGED)."""
        self._check(self._library.spm_client_acknowledge(self._open(), device))

    def wait_tick(self, after: Optional[int] = None, timeout: float = 1.0) -> Optional[int]:
        """Waits for a tick after `after` (None: after the newest) and returns it; None if none
        came within `timeout`, s."""
        tick = sized(TickData)
        if after is None:
            code = self._library.spm_client_read_tick(self._open(), ctypes.byref(tick))
            after = tick.tick if code == Code.OK else 0
        code = self._library.spm_client_wait_tick(self._open(), after, timeout, ctypes.byref(tick))
        if code == Code.NOT_THERE:
            return None
        self._check(code)
        return tick.tick

    def refusals(self) -> Refusals:
        """How many commands were sent, taken and refused, and why the last one was."""
        counts = sized(CountsData)
        self._check(self._library.spm_client_refusals(self._open(), ctypes.byref(counts)))
        reason = self._library.spm_client_refusal(counts.last_refusal) if counts.refused else b""
        return Refusals(counts.sent, counts.taken, counts.refused, counts.last_refused,
                        reason.decode())

    def loop(self) -> Loop:
        found = sized(LoopData)
        self._check(self._library.spm_client_read_loop(self._open(), ctypes.byref(found)))
        return Loop(found.time_ns * 1e-9, found.ticks, found.missed, found.skipped,
                    found.busy_ns * 1e-9, found.wake_max_ns * 1e-9, found.busy_max_ns * 1e-9,
                    list(found.wake), list(found.busy), found.degraded, found.held,
                    found.shortened, found.coarse)

    def bucket_end(self, bucket: int) -> float:
        """The end of a bucket of a loop's `wake` and `busy`, s."""
        return self._library.spm_client_bucket_end(bucket) * 1e-9

    def device_counts(self, device: int = 0) -> DeviceCounts:
        found = sized(DeviceCountsData)
        self._check(self._library.spm_client_read_device_counts(self._open(), device,
                                                                ctypes.byref(found)))
        return DeviceCounts(found.contact_ticks, found.cap_hits, found.slew_hits, found.force_max,
                            found.energy, found.generated_max, found.last_cause,
                            found.torque_cap_hits, found.torque_slew_hits, found.tool_cap_hits,
                            found.torque_max)

    def applications(self) -> list[Application]:
        """The applications that are connected; this one is among them."""
        connected: list[Application] = []
        found = sized(ApplicationData)
        while True:
            code = self._library.spm_client_read_application(self._open(), len(connected),
                                                             ctypes.byref(found))
            if code == Code.NOT_THERE:
                return connected
            self._check(code)
            connected.append(Application(found.connection, found.process,
                                         found.name.decode("ascii", "replace"),
                                         found.role == Role.SUPERVISOR, found.role == Role.OBSERVER))

    def _open(self) -> ctypes.c_void_p:
        if not self._handle:
            raise ClientError(Code.BAD_ARGUMENT, "the connection is closed; make a new Client")
        return self._handle

    def _check(self, code: int) -> None:
        if code != Code.OK:
            raise ClientError(code, self._library.spm_client_text(code).decode())

    def _names(self, kind: str, count: int) -> list[str]:
        names = []
        for index in range(count):
            name = ctypes.create_string_buffer(NAME_BYTES)
            function = getattr(self._library, f"spm_client_{kind}_name")
            self._check(function(self._open(), index, name, len(name)))
            names.append(name.value.decode("utf-8", "replace"))
        return names

    def _device(self, found: DeviceData) -> Device:
        text = ""
        if found.cause != Cause.FORCE_ON:
            name, cure = self.cause(found.cause)
            text = f"{name}: {cure}"
        return Device(found.tick, bool(found.connected), tuple(found.position),
                      tuple(found.orientation), tuple(found.velocity), tuple(found.force),
                      tuple(found.torque), found.depth, bool(found.contact), found.buttons,
                      found.cause, text, found.health, found.contacts, found.cuts,
                      tuple(found.proxy), found.force_cap, tuple(found.angular_velocity),
                      found.torque_cap, Limit(found.limits), bool(found.has_tool),
                      found.contact_count, found.level, found.culled,
                      tuple(found.tool_position),
                      tuple(found.tool_orientation), tuple(found.proxy_orientation),
                      HandState(found.hand))

    @staticmethod
    def _object(found: ObjectData) -> Object:
        return Object(found.id, found.asset, found.tick, tuple(found.position),
                      tuple(found.orientation), found.scale, tuple(found.force),
                      tuple(found.torque), found.silent, bool(found.movable), bool(found.contact),
                      bool(found.driven))


def _numbers(name: str, values: Sequence[float], count: int) -> ctypes.Array:
    """That many numbers: fewer would be filled up with zeros."""
    if len(values) != count:
        raise ClientError(Code.BAD_ARGUMENT,
                          f"{name} has {len(values)} numbers: it has to have {count}")
    return (ctypes.c_double * count)(*values)


def _pose(position: Sequence[float], orientation: Sequence[float], period: float,
          deadline: float) -> PoseData:
    pose = sized(PoseData)
    pose.position = _numbers("position", position, 3)
    pose.orientation = _numbers("orientation", orientation, 4)
    pose.period = period
    pose.deadline = deadline
    return pose


def _material(material: Material) -> MaterialData:
    feel = sized(MaterialData)
    if material.stiffness is not None:
        feel.fields |= 1
        feel.stiffness = material.stiffness
    if material.friction is not None:
        feel.fields |= 2
        feel.friction_stick, feel.friction_slide = material.friction
    if material.damping is not None:
        feel.fields |= 4
        feel.damping = material.damping
    if material.texture is not None:
        feel.fields |= 8
        feel.texture_amplitude, feel.texture_wavelength, feel.texture_seed = material.texture
    return feel
