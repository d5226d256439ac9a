#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes a ball displaced by noise, of as many triangles as asked for: a mesh for timing, whose
every triangle has relief of its own. OBJ, metres, diagonal about 0.1 m.

The noise is a sum of waves in random directions, of lengths from the ball's radius down to a few
triangles, their heights in proportion. Same number and seed, same bytes.
"""

import argparse
import math
import random
import sys

sys.dont_write_bytecode = True

from mesh import Mesh  # noqa: E402

RADIUS = 0.028  # m
ROUGHNESS = 0.02  # height of a wave over its length
WAVES_AN_OCTAVE = 5
SIDES = [((1, 0, 0), (0, 1, 0)), ((0, 1, 0), (0, 0, 1)), ((0, 0, 1), (1, 0, 0))]


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def waves(shortest: float, seed: int) -> list[tuple[float, float, float, float, float]]:
    """Wave vectors (1/m), phases and heights (m), each octave half as long as the one before."""
    source = random.Random(seed)
    found = []
    length = RADIUS
    while length > shortest:
        for _ in range(WAVES_AN_OCTAVE):
            z, turn = source.uniform(-1, 1), source.uniform(0, 2 * math.pi)
            flat = math.sqrt(1 - z * z)
            k = 2 * math.pi / length
            found.append((k * flat * math.cos(turn), k * flat * math.sin(turn), k * z,
                          source.uniform(0, 2 * math.pi),
                          ROUGHNESS * length / math.sqrt(WAVES_AN_OCTAVE)))
        length /= 2
    return found


def make(triangles: int, seed: int) -> Mesh:
    """A cube's six faces of n x n squares each, blown up to a ball and displaced outwards."""
    n = max(2, round(math.sqrt(triangles / 12)))
    noise = waves(8 * RADIUS * math.pi / (2 * n), seed)
    mesh = Mesh()
    numbers: dict[tuple[int, int, int], int] = {}

    def corner(place: tuple[int, int, int]) -> int:
        if place in numbers:
            return numbers[place]
        # Even angles, not even lengths, keep the squares alike.
        x, y, z = (math.tan(math.pi / 4 * (2 * c / n - 1)) for c in place)
        size = RADIUS / math.sqrt(x * x + y * y + z * z)
        x, y, z = x * size, y * size, z * size
        height = sum(h * math.sin(a * x + b * y + c * z + p) for a, b, c, p, h in noise)
        grown = 1 + height / RADIUS
        numbers[place] = mesh.vertex(x * grown, y * grown, z * grown)
        return numbers[place]

    for u, v in SIDES:
        w = cross(u, v)
        for side in (0, n):
            for j in range(n):
                for i in range(n):
                    square = [corner(tuple(u[k] * a + v[k] * b + w[k] * side for k in range(3)))
                              for a, b in ((i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1))]
                    mesh.quad(*(square if side else square[::-1]))
    return mesh


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("output", metavar="FILE.obj")
    parser.add_argument("--triangles", type=int, default=1_000_000, metavar="N",
                        help="about how many (default 1000000)")
    parser.add_argument("--seed", type=int, default=1, metavar="N", help="of the noise (default 1)")
    arguments = parser.parse_args()
    if arguments.triangles < 48:
        parser.error("--triangles must be 48 or more")
    mesh = make(arguments.triangles, arguments.seed)
    mesh.write(arguments.output, "SPM Haptics, a ball displaced by noise; metres")
    print(f"{arguments.output}: {len(mesh.triangles)} triangles")
    return 0


if __name__ == "__main__":
    sys.exit(main())
