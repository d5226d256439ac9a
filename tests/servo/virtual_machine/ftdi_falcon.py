#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A Novint Falcon at the serial line of the FTDI chip that QEMU has a model of.

Usage: ftdi_falcon.py SOCKET REPORT, the Unix socket of the chip's line, and the file to which a line of
JSON is written when QEMU ends. The model takes baud rates and modem lines without handing them on, so
that the boot program goes by the bytes alone. Written from the protocol's description, beside
scripted_falcon.cpp and the daemon's codec.
"""

import json
import math
import socket
import sys
import time
from pathlib import Path

BOOT_CALL, BOOT_ANSWER = b"\x0a\x43\x0d", b"\x0a\x44\x2c\x0d"
LOAD_CALL = b"\x41"
FIRMWARE_SIZE = 8492
PACKET_SIZE = 16
ZERO = ord("A")
HOMING_PACKETS = 20
LONGEST_START = 60  # s, until QEMU listens

# All thighs alike, so that the grip moves to and fro on the device's axis, 10 mm each way.
CENTRE_COUNT, SWING_COUNTS = -304, 208
POWER_UP_COUNTS = (-150, 40, -90)


def nibbles(value: int, count: int) -> bytes:
    """The lowest first, each a letter from A on."""
    return bytes(ZERO + ((value >> (4 * i)) & 15) for i in range(count))


def signed(letters: bytes) -> int:
    value = sum((letter - ZERO) << (4 * i) for i, letter in enumerate(letters))
    return value - 0x10000 if value >= 0x8000 else value


def is_packet(packet: bytes) -> bool:
    return (packet[:1] == b"<" and packet[-1:] == b">"
            and all(ZERO <= letter <= ZERO + 15 for letter in packet[1:-1]))


class Falcon:
    """Bytes in, bytes out, from power-up on."""

    def __init__(self) -> None:
        self.state = "off"
        self.held = b""
        self.seen = {"boots": 0, "loaded_bytes": 0, "packets": 0, "packets_with_homing": 0,
                     "wrong_packets": 0, "pushing_packets": 0, "pushes_before_homing": 0,
                     "largest_motor": 0, "last_motors": [0, 0, 0]}

    def take(self, data: bytes) -> bytes:
        answer = b""
        self.held += data
        while True:
            before = len(self.held)
            answer += getattr(self, f"take_{self.state}")()
            if not self.held or len(self.held) == before:
                return answer

    def take_off(self) -> bytes:
        """Nothing runs; the host's packets mean nothing, until it calls the boot program."""
        at = self.held.find(BOOT_CALL)
        if at < 0:
            self.held = self.held[-(len(BOOT_CALL) - 1):]
            return b""
        self.held = self.held[at + len(BOOT_CALL):]
        self.state = "booting"
        self.seen["boots"] += 1
        return BOOT_ANSWER

    def take_booting(self) -> bytes:
        if self.held.startswith(BOOT_CALL):
            self.held = self.held[len(BOOT_CALL):]
            return BOOT_ANSWER
        if self.held.startswith(LOAD_CALL):
            self.held = self.held[len(LOAD_CALL):]
            self.state = "loading"
            return LOAD_CALL
        return b""

    def take_loading(self) -> bytes:
        block = self.held[:FIRMWARE_SIZE - self.seen["loaded_bytes"]]
        self.held = self.held[len(block):]
        self.seen["loaded_bytes"] += len(block)
        if self.seen["loaded_bytes"] == FIRMWARE_SIZE:
            self.state = "running"
        return block

    def take_running(self) -> bytes:
        answer = b""
        while len(self.held) >= PACKET_SIZE:
            packet = self.held[:PACKET_SIZE]
            if is_packet(packet):
                self.held = self.held[PACKET_SIZE:]
                answer += self.answer(packet)
            else:
                self.held = self.held[1:]
                self.seen["wrong_packets"] += 1
        return answer

    def answer(self, packet: bytes) -> bytes:
        seen = self.seen
        seen["packets"] += 1
        seen["packets_with_homing"] += (packet[13] - ZERO) & 1
        homed = seen["packets_with_homing"] > HOMING_PACKETS
        motors = [signed(packet[1 + 4 * i:5 + 4 * i]) for i in range(3)]
        seen["last_motors"] = motors
        seen["largest_motor"] = max(seen["largest_motor"], *map(abs, motors))
        seen["pushing_packets"] += any(motors)
        seen["pushes_before_homing"] += any(motors) and not homed
        count = CENTRE_COUNT + round(SWING_COUNTS * math.sin(0.005 * seen["packets"]))
        counts = [count if homed else count - start for start in POWER_UP_COUNTS]
        flags = bytes([ZERO + (0x70 if homed else 0)])
        return b"<" + b"".join(nibbles(number, 4) for number in counts) + flags + b"A>"


def connect(path: str) -> socket.socket:
    """To QEMU, which may not listen yet."""
    line = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
    end = time.monotonic() + LONGEST_START
    while True:
        try:
            line.connect(path)
            return line
        except OSError:
            if time.monotonic() > end:
                raise
            time.sleep(0.05)


def main(path: str, report: str) -> int:
    line = connect(path)
    falcon = Falcon()
    try:
        while data := line.recv(4096):
            line.sendall(falcon.take(data))
    except ConnectionError:
        pass  # QEMU has ended
    Path(report).write_text(json.dumps(falcon.seen) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    sys.exit(main(*sys.argv[1:]))
