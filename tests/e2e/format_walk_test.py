#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The baked file read by what FORMAT.md says alone: a reader in plain Python walks from a place to its
leaf, to the distance map that the leaf names, and on by eq. 1 to 5, and finds what spm-bake tells."""

import csv
import math
import random
import subprocess
import sys
import unittest
from pathlib import Path

from programs import Case, generate, run

SCRIPTS = Path(__file__).resolve().parents[2] / "scripts"
sys.path.insert(0, str(SCRIPTS))

from format_reader import Reader  # noqa: E402


class FormatWalk(Case):
    def test_a_reader_of_the_format_s_page_finds_what_the_program_tells(self):
        generate(self.folder, "demo")
        asset = self.path("demo.spm.exr")
        baked = run("build", self.path("demo.obj"), "-o", asset, "--tolerance", "100um", "--unit", "m",
                    "--quiet")
        self.assertEqual(baked.returncode, 0, baked.stderr)
        with open(self.path("demo.obj"), encoding="ascii") as file:
            corners = [tuple(map(float, line.split()[1:4])) for line in file if line.startswith("v ")]
        draw = random.Random(5)
        places = [[x + draw.uniform(-1e-3, 5e-4) for x in draw.choice(corners)] for _ in range(8000)]
        points = self.write("points.txt", "".join(" ".join(map(repr, place)) + "\n" for place in places))
        told = run("query", asset, "--points", points, "-o", self.path("told.csv"), "--quiet")
        self.assertEqual(told.returncode, 0, told.stderr)
        with open(self.path("told.csv"), newline="", encoding="ascii") as file:
            rows = list(csv.DictReader(file))
        reader, compared = Reader(asset), 0
        for place, row in zip(places, rows):
            found = reader.answer(place)
            if found is None or row["status"] != "exact":
                continue
            compared += 1
            self.assertAlmostEqual(float(row["distance"]), found[0], delta=1e-8)
            self.assertLess(math.dist([float(row[k]) for k in ("nx", "ny", "nz")], found[1]), 1e-4)
        self.assertGreater(compared, 2000)
        self.assertGreater(reader.edges, 0)
        exact = [(place, row) for place, row in zip(places, rows)
                 if row["status"] == "exact" and row["source"] == "map"]
        place, row = exact[0]
        walked = subprocess.run([sys.executable, SCRIPTS / "walk_query", asset, *map(repr, place)],
                                capture_output=True, text=True, check=True).stdout.splitlines()
        for name in ("Definition 1", "eq. 1", "eq. 2", "eq. 3", "eq. 5"):
            self.assertTrue(any(name in line for line in walked), walked)
        self.assertAlmostEqual(float(walked[-2].split()[-1]), float(row["distance"]), delta=1e-6)


if __name__ == "__main__":
    unittest.main()
