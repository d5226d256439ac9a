#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Inputs at the edge of what can be baked: each gets a clear answer, soon, and nothing half written."""

import os
import random
import unittest

from programs import TETRAHEDRON, THIN_BAND, Case, merged, obj, off, reversed_faces, run, stl


def box(size, corner=0.0):
    """A cube from a corner, outward."""
    vertices = [tuple(corner + size * (i >> axis & 1) for axis in range(3)) for i in range(8)]
    sides = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    return vertices, [t for a, b, c, d in sides for t in ((a, b, c), (a, c, d))]


def frame(size, hole):
    """A cube with a square hole through it, from bottom to top."""
    vertices = [(half * x, half * y, z) for z in (-size / 2, size / 2)
                for half in (size / 2, hole / 2) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    triangles = []
    for k in range(4):
        n = (k + 1) % 4
        for a, b, c, d in ((k, n, 8 + n, 8 + k), (4 + n, 4 + k, 12 + k, 12 + n),
                           (n, k, 4 + k, 4 + n), (8 + k, 8 + n, 12 + n, 12 + k)):
            triangles += [(a, b, c), (a, c, d)]
    return vertices, triangles


def grid(cells):
    """A flat square of cells x cells squares."""
    row = cells + 1
    vertices = [(0.1 * i / cells, 0.1 * j / cells, 0.0) for j in range(row) for i in range(row)]
    corners = [j * row + i for j in range(cells) for i in range(cells)]
    return vertices, [t for a in corners
                      for t in ((a, a + 1, a + row + 1), (a, a + row + 1, a + row))]


def soup(count):
    """Triangles anywhere, which bound nothing and cross one another."""
    numbers = random.Random(1)
    vertices = []
    for _ in range(count):
        middle = [numbers.uniform(0, 0.1) for _ in range(3)]
        vertices += [tuple(x + numbers.uniform(-0.01, 0.01) for x in middle) for _ in range(3)]
    return vertices, [(3 * i, 3 * i + 1, 3 * i + 2) for i in range(count)]


NAN = ([(float("nan"), 0.0, 0.0)] + TETRAHEDRON[0][1:], TETRAHEDRON[1])
ONE_TRIANGLE = (TETRAHEDRON[0][:3], [(0, 1, 2)])
ONE_PLACE = ([(0.01, 0.02, 0.03)] * 4, TETRAHEDRON[1])
CAVITIES = merged(frame(0.1, 0.02), reversed_faces(box(0.02, 0.02)))
COARSE = ["--tolerance", "5mm", *THIN_BAND]

# What the input is, the file's name, its bytes, options, exit code, words of the answer.
INPUTS = [
    ("a tolerance of a unit that is none", "a.obj", obj(TETRAHEDRON), ["--tolerance", "1nm"],
     1, ["'1nm'", "unit"]),
    ("a tolerance that floats hold and no proof reaches", "a.obj", obj(TETRAHEDRON),
     ["--tolerance", "0.1um", *THIN_BAND], 10, ["can be proven", "--tolerance"]),
    ("a probe wider than a hollow and a hole through", "a.obj", obj(CAVITIES),
     ["--tolerance", "5mm", "--max-depth", "1mm", "--probe", "sphere:12mm"],
     0, ["sparse form"]),
    ("a NaN in an STL", "a.stl", stl(NAN), [], 3, ["a.stl", "triangle 0", "not finite"]),
    ("a NaN in an OFF", "a.off", off(NAN), [], 3, ["a.off", "line 3", "not finite"]),
    ("a single triangle", "a.obj", obj(ONE_TRIANGLE), [], 0, ["a sheet", "tolerance", "met"]),
    ("a plane of 200 triangles", "a.obj", obj(grid(10)), [], 0, ["a sheet", "met"]),
    ("every vertex in one place", "a.obj", obj(ONE_PLACE), [], 3, ["has an area"]),
    ("a closed mesh twice, and once inside out", "a.obj",
     obj(merged(TETRAHEDRON, TETRAHEDRON, reversed_faces(TETRAHEDRON))), COARSE,
     0, ["8 triangles dropped"]),
    ("a box of a thousandth of a millimetre", "a.obj", obj(box(1e-6)), ["--unit", "m"], 0, ["met"]),
    ("a box of a thousand kilometres", "a.obj", obj(box(1e6)), ["--unit", "m"], 0, ["met"]),
    ("a box of a metre, a thousand kilometres away", "a.obj", obj(box(1.0, 1e6)),
     ["--tolerance", "30mm", "--max-depth", "10mm"], 0, ["met"]),
    ("a tolerance too fine so far away", "a.obj", obj(box(1.0, 1e6)), ["--tolerance", "1mm"],
     1, ["finer than the floats", "0.015 m or more"]),
    ("a few triangles anywhere", "a.obj", obj(soup(4)), COARSE, 0, ["4 parts", "sheets", "met"]),
    ("two thousand triangles anywhere", "a.obj", obj(soup(2000)), ["--time-limit", "1"],
     10, ["not written", "time limit of 1 s", "in the stage", "2000 triangles in", "simplify the mesh"]),
    ("twenty thousand triangles anywhere", "a.stl", stl(soup(20000)), ["--time-limit", "1"],
     10, ["not written", "time limit of 1 s", "simplify the mesh"]),
]


class HardInput(Case):
    def test_an_input_at_the_edge_gets_a_clear_answer(self):
        for what, name, content, options, code, words in INPUTS:
            with self.subTest(what):
                out = self.output_folder(what)
                result = run("build", self.write(name, content), "-o",
                             os.path.join(out, "a.spm.exr"), *options)
                if code != 0:
                    self.expect_refusal(result, code, *words)
                    self.assertEqual(os.listdir(out), [])
                    continue
                self.assertEqual(result.returncode, 0, result.stderr)
                self.assertEqual(os.listdir(out), ["a.spm.exr"])
                for word in words:
                    self.assertIn(word, result.stdout)
                self.assertNotIn("NOT met", result.stdout)


if __name__ == "__main__":
    unittest.main()
