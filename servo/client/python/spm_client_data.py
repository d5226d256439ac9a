# SPDX-License-Identifier: Apache-2.0
"""What spm_client.py returns and takes: devices, objects, contacts, counts."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Optional

from spm_client_library import EffectKind, EventKind, HandState, Limit, Method

Vector = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]

IDENTITY: Quaternion = (1.0, 0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Info:
    rate_hz: float
    process: int
    devices: list[str]
    assets: list[str]
    objects: list[str]
    daemon_version: str
    library_version: str


@dataclass(frozen=True)
class Device:
    """One device in one tick."""
    tick: int
    connected: bool
    position: Vector
    orientation: Quaternion
    velocity: Vector
    force: Vector
    torque: Vector
    depth: float
    contact: bool
    buttons: int
    cause: int
    cause_text: str  # empty while there is force
    health: int
    contacts: int
    cuts: int
    proxy: Vector     # where the surface holds the hand; the position without contact
    force_cap: float  # N, that holds now
    angular_velocity: Vector  # rad/s
    torque_cap: float         # N m, that holds now; 0: the device gives no torque
    limits: Limit             # which were met in this tick
    has_tool: bool            # the hand holds an object of its own, the scene's `[tool] asset`
    contact_count: int        # places at which that tool touches: Client.contacts
    level: int                # levels by which its samples were coarser than the finest
    culled: int               # objects that were found apart from the tool as a whole
    tool_position: Vector     # of the tool's own frame as it lies in the scene
    tool_orientation: Quaternion
    proxy_orientation: Quaternion
    hand: HandState           # whether Client.lead_hand may lead it


@dataclass(frozen=True)
class Contact:
    """A place where a device's tool touches an object, or the tool of another device: then the object is
    TOOL_OF_DEVICE and that device's number."""
    device: int
    object: int
    place: Vector   # the middle of the pressure
    normal: Vector  # unit, out of the object
    force: Vector   # N, on the tool
    depth: float


@dataclass(frozen=True)
class Object:
    """One object in one tick; force and torque are the reaction on it."""
    id: int
    asset: int
    tick: int
    position: Vector
    orientation: Quaternion
    scale: float
    force: Vector
    torque: Vector
    silent: float
    movable: bool
    contact: bool
    driven: bool


@dataclass(frozen=True)
class Material:
    """How an object feels; what is None stays as it is."""
    stiffness: Optional[float] = None               # N/m
    friction: Optional[tuple[float, float]] = None  # mu at rest, mu in motion
    damping: Optional[float] = None                 # N s/m
    texture: Optional[tuple[float, float, int]] = None  # amplitude m, wavelength m, seed


@dataclass(frozen=True)
class Feel:
    """How an object feels now, before the limits of the device."""
    method: Method
    stabilized: bool
    stiffness: float  # N/m
    friction: tuple[float, float]  # mu at rest, mu in motion
    damping: float                 # N s/m
    texture: tuple[float, float, int]  # amplitude m, wavelength m, seed


@dataclass(frozen=True)
class Effect:
    """A simple effect on a hand; what its kind does not use has no effect. A pull rises with
    `stiffness`, stays at `most_force`, and falls to zero at `range`; 0 for either: no limit."""
    kind: EffectKind
    stiffness: float = 0.0   # N/m
    damping: float = 0.0     # N s/m
    most_force: float = 0.0  # N
    range: float = 0.0       # m
    spacing: float = 0.0     # m
    point: Vector = (0.0, 0.0, 0.0)
    axis: Vector = (0.0, 0.0, 0.0)  # unit
    object: int = 0


@dataclass(frozen=True)
class Refusals:
    sent: int
    taken: int
    refused: int
    last_refused: int
    reason: str


@dataclass(frozen=True)
class Event:
    kind: EventKind
    device: int
    value: int
    tick: int


@dataclass(frozen=True)
class Loop:
    """What the loop counted since it began. Bucket i of `wake` and `busy` ends at
    Client.bucket_end(i)."""
    time: float          # s of CLOCK_MONOTONIC, when the last tick that is counted began
    ticks: int
    missed: int          # not finished before the next one was due, including skipped ones
    skipped: int         # missed ticks that were not run at all
    busy_time: float     # s, of all ticks together
    wake_max: float      # s
    busy_max: float      # s
    wake: list[int]      # ticks by how late they began
    busy: list[int]      # ticks by how long they worked
    degraded: int        # ticks that had too little time for all objects
    held: int            # answers of objects that were coarser by that: the last plane
    shortened: int       # the same: a proxy that made fewer queries
    coarse: int          # ticks of devices at a coarser level of the tool's samples


@dataclass(frozen=True)
class DeviceCounts:
    """What the loop counted for one device since it began."""
    contact_ticks: int
    cap_hits: int
    slew_hits: int
    force_max: float      # N
    energy: float         # J, net work on the hand of what was sent
    generated_max: float  # J, largest positive value of energy
    last_cause: int
    torque_cap_hits: int
    torque_slew_hits: int
    tool_cap_hits: int    # ticks in which the coupling of hand and tool met its cap
    torque_max: float     # N m


@dataclass(frozen=True)
class Application:
    """An application that is connected."""
    connection: int
    process: int
    name: str
    supervisor: bool = False
    observer: bool = False
