#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A SpaceMouse that umockdev plugs in moves a tool against an object through the real spm-servo.

Usage: spacemouse_tool_test.py MOCK_HID SERVO BAKE [unittest options], the programs mock_hid, spm-servo
and spm-bake. The mouse is pushed along x for a third of a second, and again: no time decides the test.
"""

import csv
import json
import subprocess
import sys
import tempfile
import unittest
from itertools import dropwhile, takewhile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[3] / "support"))

from baked_tetrahedron import bake_tetrahedron  # noqa: E402

MOCK_HID = SERVO = BAKE = ""
LONGEST_RUN = 120  # s
# The tool's tip is a fifth of the tetrahedron's 50 mm before the hand, and the object's flat face 5 mm
# farther.
SCALE, TIP, FACE = 0.2, 0.010, 0.015
SCENE = f"""
[tool]
asset = "asset.spm.exr"
scale = {SCALE}
samples = 400
[[object]]
asset = "asset.spm.exr"
pose = [{FACE}, -0.01, -0.01]
"""


class SpaceMouseTool(unittest.TestCase):
    def run_mouse(self, seconds: str) -> tuple[dict, list[dict], str]:
        """The daemon's report, the rows of its trace, and what it said."""
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            bake_tetrahedron(BAKE, folder)
            (folder / "scene.toml").write_text(SCENE, encoding="utf-8")
            trace = folder / "trace.csv"
            done = subprocess.run(
                [MOCK_HID, "spacemouse", "--", SERVO, "run", "--scene", folder / "scene.toml", "--device",
                 "spacemouse", "--duration", seconds, "--trace", trace, "--socket", "off", "--black-box",
                 "off", "--realtime", "off", "--json"],
                capture_output=True, text=True, timeout=LONGEST_RUN, check=False)
            messages, _, last = done.stderr.rstrip("\n").rpartition("\n")
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertEqual(json.loads(last)["wrong_commands"], 0)
            with trace.open(encoding="ascii", newline="") as file:
                rows = [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file)]
            return json.loads(done.stdout), rows, messages

    def test_it_moves_a_tool_against_an_object_and_the_hand_goes_on(self) -> None:
        report, rows, messages = self.run_mouse("3")
        self.assertIn("gives neither force nor torque", messages)
        stop = FACE - TIP
        self.assertGreater(max(row["x"] for row in rows), stop + 0.01)
        # On a busy machine a tool that has not followed in time counts as in contact before it touches,
        # and where the loop stalls it begins anew at the hand.
        pressed = list(takewhile(lambda row: row["contact"],
                                 dropwhile(lambda row: not row["patches"], rows)))
        self.assertGreater(len(pressed), 10)
        self.assertGreater(max(row["tool_x"] for row in pressed), stop - 0.001)
        self.assertLess(max(row["tool_x"] for row in pressed), stop + 0.001)
        # The device bears no force: none is sent, and its cap is met in each contact.
        self.assertEqual(report["force_n"]["max"], 0)
        self.assertEqual({(row["fx"], row["fy"], row["fz"]) for row in rows}, {(0, 0, 0)})
        settled = pressed[len(pressed) // 2:]
        self.assertTrue(all(row["force_capped"] for row in settled))
        # Nothing draws the hand back, which stays as deep as it was driven.
        self.assertEqual(rows[-1]["x"], max(row["x"] for row in rows))


if __name__ == "__main__":
    MOCK_HID, SERVO, BAKE = sys.argv[1:4]
    unittest.main(argv=sys.argv[:1] + sys.argv[4:], verbosity=2)
