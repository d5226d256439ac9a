# SPDX-License-Identifier: Apache-2.0
"""Applications that misbehave, as child processes: they flood the daemon with commands, write
garbage into the memory that they share with it, stop in the middle of a command, or connect and say
nothing. None of them ends by itself. The numbers of the layout are those of
servo/shared/shared_layout.h."""

import math
import mmap
import os
import random
import signal
import socket
import struct
import time

from soak_tools import PATIENCE, Client, ClientError
from spm_client import Code, Material

ANSWER, ANSWER_BYTES = struct.Struct("<QIIIIII"), 320
READY = struct.Struct("<QII32s64s")
MAGIC = 0x6B636F53204D5053  # SPM Sock
WELCOME = 0
HEAD, SLOTS, SLOT_BYTES, SLOT_COUNT = 64, 192, 192, 256
KINDS = ("flood", "garbage", "torn", "stall", "mute")
CONNECTED, REFUSED = 1, 2  # what a child notes
STUBBORN = 1.0  # s, that a refused application tries again


class Refused(Exception):
    pass


def connect_by_hand(path: str, say_ready: bool = True) -> tuple[socket.socket, mmap.mmap]:
    """As the library does it, to get at the memory itself."""
    deadline = time.monotonic() + STUBBORN
    while True:
        connection = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        connection.connect(path)
        connection.settimeout(PATIENCE)
        answer, descriptors, _, _ = socket.recv_fds(connection, ANSWER_BYTES, 2)
        if len(descriptors) == 2:
            break
        connection.close()
        if time.monotonic() > deadline:
            raise Refused
        time.sleep(0.01)
    magic, version, layout, status, _, _, ring_bytes = ANSWER.unpack_from(answer)
    assert magic == MAGIC and status == WELCOME
    ring = mmap.mmap(descriptors[1], ring_bytes)
    for descriptor in descriptors:
        os.close(descriptor)
    if say_ready:
        connection.send(READY.pack(MAGIC, version, layout, b"", b"hostile"))
        connection.recv(ANSWER_BYTES)
    return connection, ring


def connect_politely(path: str) -> Client:
    deadline = time.monotonic() + STUBBORN
    while True:
        try:
            return Client(path=path, application="hostile", timeout=PATIENCE)
        except ClientError:
            if time.monotonic() > deadline:
                raise Refused from None
            time.sleep(0.01)


def command_bytes(random_numbers: random.Random, sequence: int) -> bytes:
    """A valid pose of the scene's first object, a hair from where it was."""
    pose = [random_numbers.uniform(-1e-4, 1e-4) for _ in range(3)] + [1.0, 0.0, 0.0, 0.0]
    body = struct.pack("<QIIQq7d", sequence, 2, 0, 0, 0, *pose)
    return body + bytes(SLOT_BYTES - len(body))


def flood(path: str, numbers: random.Random, note) -> None:
    """Every command there is, as fast as it goes; also such as make no sense."""
    client = connect_politely(path)
    note(CONNECTED)
    added: list[int] = []

    def add() -> None:
        added.append(client.add(0, [numbers.uniform(-1, 1) for _ in range(3)]))

    def remove() -> None:
        client.remove(added.pop() if added else numbers.getrandbits(40))

    def move() -> None:
        client.move(numbers.choice([0, *added[-3:]]),
                    [numbers.uniform(-1e-3, 1e-3) for _ in range(3)], period=numbers.random())

    def change() -> None:
        client.set_material(0, Material(stiffness=numbers.uniform(100, 2000),
                                        damping=numbers.uniform(0, 3)))

    def wrong() -> None:
        client.move(0, (math.nan, 0.0, 0.0))

    actions = (add, remove, move, move, move, move, change, wrong)
    while True:
        try:
            numbers.choice(actions)()
        except ClientError as problem:
            if problem.code not in (Code.RING_FULL, Code.BAD_ARGUMENT, Code.NOT_THERE, Code.BUSY):
                raise


def garbage(path: str, numbers: random.Random, note) -> None:
    """Random bytes all over the ring: heads, tails, sequence numbers, commands."""
    _, ring = connect_by_hand(path)
    note(CONNECTED)
    while True:
        size = numbers.choice((8, 8, 64, SLOT_BYTES, 4096))
        at = numbers.choice((HEAD, numbers.randrange(0, len(ring) - size)))
        ring[at:at + size] = numbers.randbytes(size)


def torn(path: str, numbers: random.Random, note) -> None:
    """Commands that are announced before they are whole, and at times rewritten afterwards."""
    _, ring = connect_by_hand(path)
    note(CONNECTED)
    head = 0
    while True:
        at = SLOTS + head % SLOT_COUNT * SLOT_BYTES
        command = command_bytes(numbers, head + 1)
        cut = numbers.randrange(8, SLOT_BYTES)
        ring[at:at + cut] = command[:cut]
        head += 1
        ring[HEAD:HEAD + 8] = struct.pack("<Q", head)
        ring[at + cut:at + SLOT_BYTES] = command[cut:]
        if numbers.random() < 0.1:
            ring[at:at + SLOT_BYTES] = numbers.randbytes(SLOT_BYTES)


def stall(path: str, numbers: random.Random, note) -> None:
    """Half a command, and then nothing more: stopped, its connection open."""
    _, ring = connect_by_hand(path)
    note(CONNECTED)
    ring[HEAD:HEAD + 8] = struct.pack("<Q", numbers.choice((1, 3, SLOT_COUNT)))
    ring[SLOTS:SLOTS + SLOT_BYTES // 2] = command_bytes(numbers, 1)[:SLOT_BYTES // 2]
    os.kill(os.getpid(), signal.SIGSTOP)
    time.sleep(PATIENCE * PATIENCE)


def mute(path: str, _: random.Random, note) -> None:
    """Is greeted, and never says that it is ready."""
    _, ring = connect_by_hand(path, say_ready=False)
    note(CONNECTED)
    ring[0:8] = b"\xff" * 8
    time.sleep(PATIENCE * PATIENCE)


def bystander(_: str, numbers: random.Random, note) -> None:
    """No application at all, but as busy as one: for comparison."""
    while True:
        numbers.randbytes(64)


def run(kind: str, path: str, seed: int, note) -> None:
    """In a child process: is of a kind until it is killed."""
    try:
        globals()[kind](path, random.Random(seed), note)
    except (Refused, OSError):  # it hangs up on those that it refuses
        note(REFUSED)
