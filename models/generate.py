#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Generates the models that the tests and the demo use, as OBJ in metres, diagonal 0.1 m.

The same version writes the same bytes. Needs nothing but Python.
"""

import argparse
import math
import os
import sys

sys.dont_write_bytecode = True

import blossom  # noqa: E402
import shapes  # noqa: E402
from mesh import components, faults, read  # noqa: E402

MODELS = {
    "sphere": (shapes.sphere, "ball about the origin"),
    "box": (shapes.box, "box"),
    "torus": (shapes.torus, "torus about the z axis"),
    "cylinder": (shapes.cylinder, "cylinder about the z axis"),
    "wedge": (shapes.wedge, "two planes that meet at 60 degrees, closed to a prism"),
    "plate": (shapes.plate, "plate of 0.5 mm"),
    "comb": (shapes.comb, "comb with grooves of 4 mm, 36 mm deep"),
    "nested": (shapes.nested, "ball with a spherical cavity"),
    "peg": (shapes.peg, "peg about the z axis"),
    "hole": (shapes.hole, "block with a blind hole for the peg, about the z axis"),
    "demo": (blossom.make, "bowl of eight twisted petals with fine relief"),
}

# Closed-form volume, m3, and how far below it the facets may stay, as a share.
VOLUMES = {
    "sphere": (4 / 3 * math.pi * shapes.SPHERE_RADIUS**3, 1e-3),
    "box": (math.prod(shapes.BOX_SIDES), 1e-6),
    "torus": (2 * math.pi**2 * shapes.TORUS_RING_RADIUS * shapes.TORUS_TUBE_RADIUS**2, 2e-3),
    "cylinder": (math.pi * shapes.CYLINDER_RADIUS**2 * shapes.CYLINDER_HEIGHT, 2e-4),
    "peg": (math.pi * shapes.PEG_RADIUS**2 * shapes.PEG_LENGTH, 1e-3),
    "hole": (math.pi * (shapes.HOLE_BLOCK_RADIUS**2 * shapes.HOLE_BLOCK_HEIGHT
                        - shapes.HOLE_RADIUS**2 * shapes.HOLE_DEPTH), 1e-3),
    "wedge": (math.sqrt(3) / 4 * shapes.WEDGE_SIDE**2 * shapes.WEDGE_LENGTH, 1e-6),
    "plate": (math.prod(shapes.PLATE_SIDES), 1e-6),
    "comb": (shapes.COMB_LENGTH * (
        0.064 * shapes.COMB_BASE_HEIGHT
        + shapes.COMB_TEETH * shapes.COMB_TOOTH_WIDTH
        * (shapes.COMB_HEIGHT - shapes.COMB_BASE_HEIGHT)), 1e-6),
    "nested": (4 / 3 * math.pi * (shapes.SPHERE_RADIUS**3 - shapes.CAVITY_RADIUS**3), 3e-3),
}
PARTS = {"nested": 2}


def check(name: str, path: str) -> list[str]:
    """What is wrong with a written model; empty where nothing is."""
    mesh = read(path)
    found = faults(mesh)
    if components(mesh) != PARTS.get(name, 1):
        found.append(f"{components(mesh)} parts instead of {PARTS.get(name, 1)}")
    if abs(mesh.diagonal() - shapes.DIAGONAL) > 1e-5:
        found.append(f"the diagonal is {mesh.diagonal():.6f} m instead of {shapes.DIAGONAL} m")
    if name in VOLUMES:
        exact, share = VOLUMES[name]
        if not -1e-6 <= (exact - mesh.volume()) / exact <= share:
            found.append(f"the volume is {mesh.volume():.6e} m3 instead of {exact:.6e} m3")
    if name == "demo" and not 18000 <= len(mesh.triangles) <= 22000:
        found.append(f"{len(mesh.triangles)} triangles instead of about 20,000")
    return found


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*", metavar="NAME",
                        help=f"models to generate: {' '.join(MODELS)} (default: all)")
    parser.add_argument("--out", default=os.path.dirname(os.path.abspath(__file__)), metavar="DIR",
                        help="folder to write NAME.obj to (default: the script's own)")
    parser.add_argument("--check", action="store_true",
                        help="also check each written model: closed, outward, volume, diagonal")
    arguments = parser.parse_args()
    for name in arguments.names:
        if name not in MODELS:
            parser.error(f"there is no model '{name}'; choose of {' '.join(MODELS)}")
    os.makedirs(arguments.out, exist_ok=True)
    failed = False
    for name in arguments.names or MODELS:
        make, what = MODELS[name]
        mesh = make()
        path = os.path.join(arguments.out, f"{name}.obj")
        mesh.write(path, f"SPM Haptics model '{name}': {what}; metres")
        print(f"{path}: {len(mesh.triangles)} triangles")
        for fault in check(name, path) if arguments.check else []:
            print(f"{path}: {fault}", file=sys.stderr)
            failed = True
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
