#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Gives the first device's hand a spring to where it is, detents across it, and a push that swings
to and fro, and prints what it feels.

Usage: guide_hand.py [SOCKET [SECONDS]]
"""

import math
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "python"))

from spm_client import Client, ClientError, Effect, EffectKind  # noqa: E402

RATE = 60.0      # pushes a second
PUSH = 0.5       # N
FREQUENCY = 1.0  # 1/s


def main() -> int:
    path = sys.argv[1] if len(sys.argv) > 1 else None
    seconds = float(sys.argv[2]) if len(sys.argv) > 2 else 10.0
    try:
        with Client(path=path, application="guide_hand example") as client:
            client.wait_tick()  # a daemon may be so young that it had none
            here = client.device(0).position
            client.set_effect(0, 0, Effect(EffectKind.SPRING, stiffness=50.0, most_force=1.0,
                                           point=here))
            client.set_effect(0, 1, Effect(EffectKind.DETENTS, stiffness=200.0, spacing=0.005,
                                           point=here, axis=(1.0, 0.0, 0.0)))
            for frame in range(round(seconds * RATE)):
                push = PUSH * math.sin(2 * math.pi * FREQUENCY * frame / RATE)
                # Held over two frames more, so that a late one is not felt.
                client.push(0, (0.0, push, 0.0), hold=3 / RATE)
                if frame % 6 == 0:
                    hand = client.device(0)
                    print(f"at {hand.position[0] * 1e3:.2f} {hand.position[1] * 1e3:.2f} mm, "
                          f"pushed by {push:.2f} N, force {math.hypot(*hand.force):.2f} N "
                          f"{hand.cause_text}", flush=True)
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
