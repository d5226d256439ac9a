#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes the way of a hand that holds the peg of scenes/peg-in-hole.toml: a row of `x y z qw qx qy qz`
for each tick of 1 ms, metres, y up. The peg enters the hole tilted, is pressed to its floor and its
walls, turned about its axis, and pulled out; then again."""

import argparse
import math
import sys

GRIP = 0.030  # m, from the peg's tip to where the hand holds it
TICK = 1e-3  # s
TILT = math.radians(4)

# Seconds to get there, then the tip's place (m), the tilt about z and the turn about y (rad).
LEGS = [
    (0.6, (0.0, 0.004, 0.0), TILT, 0.0),
    (0.6, (0.0004, -0.002, 0.0), TILT, 0.0),
    (0.5, (0.0, -0.010, 0.0), 0.0, 0.0),
    (0.6, (0.0, -0.036, 0.0), 0.0, 0.0),
    (0.4, (0.006, -0.036, 0.0), 0.0, 0.0),
    (0.4, (0.0, -0.036, 0.006), 0.0, 0.3),
    (0.4, (-0.006, -0.036, 0.0), 0.05, 0.6),
    (0.5, (0.0, -0.036, -0.006), -0.05, -0.6),
    (0.4, (0.003, -0.034, 0.0), 0.0, 0.0),
    (0.8, (0.0, -0.004, 0.0), 0.0, 0.0),
    (0.8, (0.0, 0.010, 0.0), 0.0, 0.0),
]
START = ((0.0, 0.010, 0.0), 0.0, 0.0)


def product(a: tuple, b: tuple) -> tuple:
    """Of two quaternions, w first."""
    return (a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
            a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
            a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
            a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0])


def pose(tip: tuple, tilt: float, turn: float) -> tuple:
    """The hand's pose: it is above the tip, along the tilted peg."""
    about_z = (math.cos(tilt / 2), 0.0, 0.0, math.sin(tilt / 2))
    about_y = (math.cos(turn / 2), 0.0, math.sin(turn / 2), 0.0)
    above = (-GRIP * math.sin(tilt), GRIP * math.cos(tilt), 0.0)
    return tuple(p + q for p, q in zip(tip, above)) + product(about_z, about_y)


def rows(seconds: float):
    """A row for each tick. Ways begin and end at rest."""
    left = round(seconds / TICK)
    at = START
    while True:
        for time, *to in LEGS:
            ticks = round(time / TICK)
            for tick in range(1, ticks + 1):
                share = 0.5 - 0.5 * math.cos(math.pi * tick / ticks)
                tip = tuple(a + share * (b - a) for a, b in zip(at[0], to[0]))
                yield pose(tip, *(a + share * (b - a) for a, b in zip(at[1:], to[1:])))
                left -= 1
                if left <= 0:
                    return
            at = to


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("-o", "--output", required=True, metavar="FILE", help="file to write")
    parser.add_argument("--seconds", type=float, default=60, help="how long it is (default: 60)")
    arguments = parser.parse_args()
    if not 0 < arguments.seconds <= 3600:
        parser.error("--seconds must be above 0 and at most an hour")
    with open(arguments.output, "w", encoding="ascii") as file:
        for row in rows(arguments.seconds):
            file.write(" ".join(f"{number:.7g}" for number in row) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
