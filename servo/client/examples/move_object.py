#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Swings the scene's first object to and fro, 90 poses a second, and prints what the hand feels.

Usage: move_object.py [SOCKET [SECONDS]]
"""

import math
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "python"))

from spm_client import Client, ClientError  # noqa: E402

RATE = 90.0       # poses a second
AMPLITUDE = 0.01  # m
FREQUENCY = 0.5   # 1/s


def main() -> int:
    path = sys.argv[1] if len(sys.argv) > 1 else None
    seconds = float(sys.argv[2]) if len(sys.argv) > 2 else 10.0
    try:
        with Client(path=path, application="move_object example") as client:
            start = client.object(0)
            for frame in range(round(seconds * RATE)):
                phase = 2 * math.pi * FREQUENCY * frame / RATE
                position = (start.position[0] + AMPLITUDE * math.sin(phase), *start.position[1:])
                client.move(0, position, start.orientation, period=1 / RATE)
                if frame % 9 == 0:
                    hand, moved = client.device(0), client.object(0)
                    print(f"object at {moved.position[0] * 1e3:.2f} mm, "
                          f"force {math.hypot(*hand.force):.2f} N {hand.cause_text}", flush=True)
                time.sleep(1 / RATE)
            refusals = client.refusals()
            if refusals.refused:
                print(f"refused {refusals.refused} times: {refusals.reason}", file=sys.stderr)
                return 3
    except ClientError as problem:
        print(f"error: {problem}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
