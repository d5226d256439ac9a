#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Moves an object up and down under the tool that the first device's hand holds (a scene with `[tool]
asset`), and prints where the tool lies, where it touches, and what the tools do to the object.

Usage: move_under_tool.py [SOCKET [OBJECT [SECONDS [MILLIMETRES]]]]
"""

import math
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "python"))

from spm_client import Client, ClientError  # noqa: E402

RATE = 60.0      # poses a second
FREQUENCY = 0.5  # 1/s


def in_mm(vector: tuple[float, ...]) -> str:
    return " ".join(f"{1e3 * value:.2f}" for value in vector)


def main() -> int:
    path = sys.argv[1] if len(sys.argv) > 1 else None
    number = int(sys.argv[2]) if len(sys.argv) > 2 else 0
    seconds = float(sys.argv[3]) if len(sys.argv) > 3 else 10.0
    amplitude = float(sys.argv[4]) * 1e-3 if len(sys.argv) > 4 else 2e-3
    try:
        with Client(path=path, application="move_under_tool example") as client:
            client.wait_tick()  # a daemon may be so young that it had none
            start = client.object(number)
            for frame in range(round(seconds * RATE)):
                up = amplitude * math.sin(2 * math.pi * FREQUENCY * frame / RATE)
                x, y, z = start.position
                client.move(number, (x, y + up, z), start.orientation, period=1 / RATE)
                if frame % 6 == 0:
                    hand, moved, contacts = client.device(0), client.object(number), client.contacts(0)
                    print(f"tool at {in_mm(hand.tool_position)} mm touches at {len(contacts)} places; "
                          f"object {number}: reaction {math.hypot(*moved.force):.2f} N, "
                          f"{math.hypot(*moved.torque):.4f} N m", flush=True)
                    for contact in contacts:
                        print(f"  at {in_mm(contact.place)} mm on object {contact.object}: "
                              f"{math.hypot(*contact.force):.2f} N, {1e3 * contact.depth:.3f} mm deep",
                              flush=True)
                time.sleep(1 / RATE)
    except ClientError as problem:
        print(f"error: {problem}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
