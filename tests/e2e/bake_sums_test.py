#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Holds every compiler and every release of the libraries to the same baked bytes and the same forces:
scripts/bake_sums prints for a few models what bake_sums.txt has. After a change that is meant:

    SPM_BAKE_SUMS=write tests/e2e/bake_sums_test.py
"""

import os
import subprocess
import sys
import unittest
from pathlib import Path

from programs import BIN

SOURCE = Path(__file__).resolve().parents[2]
EXPECTED = Path(__file__).with_name("bake_sums.txt")
# The demo's thousands of corners found a compiler that wrote over variables in use.
BAKES = {"sparse": ("models/box.obj", "models/comb.obj", "models/demo.obj", "models/wedge.obj"),
         "full": ("models/box.obj", "models/comb.obj")}


def sums() -> str:
    lines = ""
    for bake, meshes in BAKES.items():
        done = subprocess.run([sys.executable, SOURCE / "scripts/bake_sums", "--bakes", bake, "--", *meshes],
                              capture_output=True, text=True, check=False, env={**os.environ, "SPM_BIN": BIN})
        assert done.returncode == 0, done.stderr
        lines += done.stdout
    return lines


class Sums(unittest.TestCase):
    maxDiff = None

    def test_baked_bytes_and_forces_are_those_of_every_other_machine(self):
        self.assertEqual(sums(), EXPECTED.read_text(encoding="ascii"))


if __name__ == "__main__":
    if os.environ.get("SPM_BAKE_SUMS") == "write":
        EXPECTED.write_text(sums(), encoding="ascii")
    else:
        unittest.main()
