#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Waits for each tick of the loop, and prints the first device's place, that of its proxy and the
force, which it holds below a cap. After a fault that the daemon wants acknowledged (run --recovery
acknowledge) it asks, and acknowledges it.

Usage: watch_proxy.py [SOCKET [TICKS [NEWTONS]]]
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "python"))

from spm_client import Cause, Client, ClientError  # noqa: E402


def in_mm(place: tuple) -> str:
    return " ".join(f"{1e3 * length:.2f}" for length in place)


def main() -> int:
    path = sys.argv[1] if len(sys.argv) > 1 else None
    ticks = int(sys.argv[2]) if len(sys.argv) > 2 else 1000
    cap = float(sys.argv[3]) if len(sys.argv) > 3 else 2.0  # N
    try:
        with Client(path=path, application="watch_proxy example") as client:
            client.set_force_cap(0, cap)
            tick = None
            for _ in range(ticks):
                tick = client.wait_tick(tick)
                if tick is None:
                    print("error: no tick for a second: look at the daemon", file=sys.stderr)
                    return 3
                hand = client.device(0)
                print(f"tick {hand.tick}: hand {in_mm(hand.position)} mm, "
                      f"proxy {in_mm(hand.proxy)} mm, "
                      f"force {' '.join(f'{one:.2f}' for one in hand.force)} N", flush=True)
                if hand.cause == Cause.UNACKNOWLEDGED:
                    input("The force is off after a fault. Is all well again? Press Enter. ")
                    client.acknowledge(0)
    except ClientError as problem:
        print(f"error: {problem}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
