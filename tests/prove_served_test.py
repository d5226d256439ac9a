#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Holds that meshes by seed are what they are said to be, and that scripts/prove_served goes on where
it was stopped.

Usage: prove_served_test.py SOURCE_DIR [unittest options]
"""

import json
import math
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

SOURCE = Path()
MADE = 20

# Stands for spm-bake: notes what it is asked, and finds one place missed with the seed that is named.
STUB = """#!{python}
import json, sys
with open({log!r}, "a") as log:
    print(*sys.argv[1:], file=log)
arguments = sys.argv[1:]
if arguments[0] == "build":
    open(arguments[arguments.index("-o") + 1], "w").write("baked")
    print(json.dumps({{"bytes": 5, "mesh": {{"triangles": 9, "closed": True}}}}))
    sys.exit()
seed, samples = (int(arguments[arguments.index(k) + 1]) for k in ("--seed", "--samples"))
missed = seed == {missed}
place = {{"point": [1, 2, 3], "error_um": 150, "kind": "beyond_tolerance"}}
counts = {{"unanswered": 0, "wrong_side": 0, "beyond_tolerance": int(missed), "pruned": 0}}
error = {{"max": 150 if missed else 50}}
print(json.dumps({{"samples": samples, "counts": counts, "jumps": None, "passed": not missed,
    "adversarial": {{"samples": samples // 2, "counts": counts | {{"beyond_tolerance": 0}},
                     "distance_error_um": error}}, "distance_error_um": error,
    "worst": [place] if missed else []}}))
sys.exit(10 if missed else 0)
"""


class MadeMeshes(unittest.TestCase):
    def setUp(self):
        sys.path.insert(0, str(SOURCE / "scripts"))
        import made_meshes
        self.made = made_meshes

    def test_they_are_closed_turned_outwards_and_of_the_size_that_is_said(self):
        for number in range(MADE):
            vertices, triangles = self.made.made_mesh(number, 1)
            with self.subTest(mesh=self.made.name_of(number, 1)):
                self.assertTrue(5000 <= len(triangles) <= 20000, len(triangles))
                self.assertTrue(self.made.is_closed((vertices, triangles)))
                self.assertEqual(self.made.outwards((vertices, triangles))[1], triangles)
                self.assertEqual(set(range(len(vertices))), {v for t in triangles for v in t})
                low, high = (tuple(map(end, zip(*vertices))) for end in (min, max))
                self.assertTrue(70 < math.dist(low, high) < 130)

    def test_a_number_and_a_seed_name_one_mesh(self):
        for number in (0, 5, 9):
            text = self.made.to_obj(self.made.made_mesh(number, 3))
            self.assertEqual(text, self.made.to_obj(self.made.made_mesh(number, 3)))
            self.assertNotEqual(text, self.made.to_obj(self.made.made_mesh(number, 4)))
            self.assertNotEqual(text, self.made.to_obj(self.made.made_mesh(number + 10, 3)))


class GoesOn(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="spm-proved-")
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.log = self.folder / "log"
        self.set_program(missed=-1)

    def set_program(self, missed):
        self.program = self.folder / "stub"
        self.program.write_text(STUB.format(python=sys.executable, log=str(self.log), missed=missed))
        self.program.chmod(0o755)

    def run_script(self, samples):
        """The exit code, the row, and what the program was asked in this run."""
        self.log.write_text("")
        ran = subprocess.run([SOURCE / "scripts/prove_served", "--program", self.program, "--meshes",
                              "made", "--only", "torus-1-1", "--out", self.folder / "out", "--samples",
                              str(samples)], capture_output=True, text=True, check=False)
        report = json.loads((self.folder / "out/served.json").read_text())
        return ran.returncode, report["rows"][0], self.log.read_text().splitlines()

    def test_what_is_done_is_not_done_again(self):
        code, row, asked = self.run_script(2_500_000)
        self.assertEqual(code, 0)
        self.assertEqual((row["samples"], row["hard_samples"]), (2_500_000, 1_250_000))
        self.assertEqual((row["bytes"], row["passed"], row["missed"]), (5, True, []))
        self.assertEqual([line.split()[0] for line in asked], ["build"] + 3 * ["verify"])
        self.assertEqual(len({line.split()[line.split().index("--seed") + 1] for line in asked[1:]}), 3)
        again = self.run_script(2_500_000)
        self.assertEqual(again, (code, row, []))
        # More places: only those that are missing.
        self.assertEqual(len(self.run_script(4_000_000)[2]), 2)

    def test_another_program_does_it_all_again_and_a_missed_place_is_told_with_its_seed(self):
        self.run_script(1_000_000)
        self.set_program(missed=1_000_000)
        code, row, asked = self.run_script(1_000_000)
        self.assertEqual((code, len(asked)), (10, 2))
        self.assertEqual((row["beyond_tolerance"], row["passed"]), (1, False))
        self.assertEqual(row["missed"][0]["seed"], 1_000_000)
        self.assertEqual(row["missed"][0]["point"], [1, 2, 3])


if __name__ == "__main__":
    SOURCE = Path(sys.argv.pop(1)).resolve()
    unittest.main()
