#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The Python module of the query library.

Usage: query_package_test.py [unittest options]; in the build folder, or with SPM_BIN: folder of
spm-bake; SPM_QUERY_LIBRARY: libspm_query.so.
"""

import array
import ctypes
import math
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[3]
BIN = Path(os.environ.get("SPM_BIN", Path.cwd() / "bin"))
os.environ.setdefault("SPM_QUERY_LIBRARY", str(Path.cwd() / "lib" / "libspm_query.so"))
MODULE = SOURCE / "formats" / "query" / "python"

sys.path[:0] = [str(MODULE), str(SOURCE / "tests" / "support")]
import spm_query  # noqa: E402
from baked_tetrahedron import bake_tetrahedron  # noqa: E402
from made_checkout import find_in_checkout  # noqa: E402
from spm_query import Asset, QueryError, Source, Status  # noqa: E402

try:
    import numpy
except ImportError:
    numpy = None

NEAR = 0.00005  # m below the face x = 0
POINTS = [(NEAR, 0.01, 0.01), (0.01, NEAR, 0.01), (0.005, 0.005, 0.005), (1.0, 1.0, 1.0)]


class Package(unittest.TestCase):
    @classmethod
    def setUpClass(cls) -> None:
        folder = tempfile.TemporaryDirectory(prefix="spm-query-")
        cls.addClassCleanup(folder.cleanup)
        cls.path = bake_tetrahedron(str(BIN / "spm-bake"), Path(folder.name))
        cls.asset = Asset(cls.path)
        cls.addClassCleanup(cls.asset.close)

    def test_an_asset_says_what_it_answers(self) -> None:
        for found, right in zip(self.asset.band, (0.0001, 0.00005)):
            self.assertAlmostEqual(found, right)
        self.assertEqual([round(value, 6) for value in sum(self.asset.box, ())], [0] * 3 + [0.05] * 3)
        self.assertEqual(self.asset.memory > 1000, True)
        self.assertFalse(self.asset.lost)

    def expect_answers(self, answers) -> None:
        self.assertEqual(len(answers), len(POINTS))
        distances = [float(answer["distance"]) for answer in answers]
        for found in distances[:2]:
            self.assertAlmostEqual(found, -NEAR, delta=1e-5)
        self.assertTrue(math.isnan(distances[3]))
        self.assertEqual([Status(int(answer["status"])) for answer in answers],
                         [Status.EXACT, Status.EXACT, Status.DEEP, Status.FAR])
        self.assertAlmostEqual(float(answers[0]["normal"][0]), -1, delta=0.1)
        self.assertIn(Source(int(answers[0]["source"])), (Source.TILE, Source.TRIANGLES))

    @unittest.skipUnless(numpy, "python3-numpy is not installed")
    def test_arrays_are_answered_however_they_lie(self) -> None:
        points = numpy.array(POINTS)
        whole = numpy.zeros((4, 6))
        whole[:, ::2] = points
        frozen = points.copy()
        frozen.flags.writeable = False
        for name, given in {"rows": points, "columns first": numpy.asfortranarray(points),
                            "every second column": whole[:, ::2], "flat": points.reshape(-1),
                            "not to be written": frozen, "a list": POINTS,
                            "a buffer": array.array("d", points.reshape(-1))}.items():
            with self.subTest(name):
                self.expect_answers(self.asset.query(given))

    @unittest.skipUnless(numpy, "python3-numpy is not installed")
    def test_points_of_another_shape_are_refused_and_no_points_are_fine(self) -> None:
        for given in (numpy.zeros((3, 2)), numpy.zeros(4), numpy.zeros((1, 1, 3))):
            with self.assertRaises(QueryError):
                self.asset.query(given)
        self.assertEqual(len(self.asset.query(numpy.zeros((0, 3)))), 0)

    def test_without_numpy_answers_are_structs(self) -> None:
        code = ("import sys; sys.modules['numpy'] = None\n"
                "import spm_query, array\n"
                f"asset = spm_query.Asset({str(self.path)!r})\n"
                f"for points in ({POINTS!r}, array.array('d', sum({POINTS!r}, ()))):\n"
                "    print([answer.status for answer in asset.query(points)])\n")
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False,
                              env={**os.environ, "PYTHONPATH": str(MODULE)})
        self.assertEqual((done.stdout, done.stderr), ("[0, 0, 1, 2]\n" * 2, ""))

    def test_a_force_pushes_out_of_the_object(self) -> None:
        contact = self.asset.force(POINTS[0], stiffness=1000)
        self.assertTrue(contact.touching)
        self.assertAlmostEqual(contact.force[0], -1000 * NEAR, delta=0.01)
        self.assertFalse(self.asset.force(POINTS[3], stiffness=1000).touching)
        with self.assertRaises(QueryError) as caught:
            self.asset.force(POINTS[0], stiffness=-1)
        self.assertIn("out of range", str(caught.exception))

    def test_what_fails_says_why(self) -> None:
        with self.assertRaises(QueryError) as caught:
            Asset("/nowhere.spm.exr")
        self.assertEqual(caught.exception.code, 2)
        self.assertIn("/nowhere.spm.exr", str(caught.exception))
        closed = Asset(self.path)
        closed.close()
        closed.close()
        with self.assertRaises(QueryError):
            closed.query(POINTS)

    def test_in_a_checkout_it_finds_the_library_of_the_build_folder(self) -> None:
        with tempfile.TemporaryDirectory(prefix="spm-query-") as folder:
            found = find_in_checkout(Path(folder), MODULE, "formats/query/python",
                                     os.environ["SPM_QUERY_LIBRARY"], "libspm_query.so.1",
                                     "import spm_query; print(spm_query._load()._name)")
        self.assertEqual(found, "build/release/lib/libspm_query.so.1")

    def test_the_structs_are_as_long_as_those_of_the_header(self) -> None:
        kept = (SOURCE / "tests" / "e2e" / "struct_layouts.txt").read_text(encoding="utf-8")
        sizes = {line.split()[0]: int(line.split()[1]) for line in kept.splitlines()}
        for name, struct in (("answer", spm_query.Answer), ("contact", spm_query.ContactData),
                             ("force_settings", spm_query.ForceSettings)):
            self.assertEqual(ctypes.sizeof(struct), sizes["spm_query_" + name])


if __name__ == "__main__":
    unittest.main()
