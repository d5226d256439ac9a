#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Batches of bakes from a manifest."""

import json
import os
import unittest

from programs import BUILD_KEYS, THIN_BAND, Case, digest, obj, run, sphere


class Batch(Case):
    def manifest(self, text):
        self.write("sphere.obj", obj(sphere(0.02, rows=8, columns=16)))
        self.write("broken.obj", "v 0 0 0\n")
        return self.write("assets.toml", text)

    GOOD = ('[[asset]]\nname = "{0}"\nmesh = "sphere.obj"\noutput = "{0}.spm.exr"\n'
            'tolerance = "1mm"\nmax-depth = "0.1mm"\nmargin = "0.05mm"\n')
    BAD = '[[asset]]\nmesh = "broken.obj"\noutput = "broken.spm.exr"\n'

    def run_batch(self, text, *options):
        result = run("batch", self.manifest(text), "--json", *options)
        return result, [json.loads(line) for line in result.stdout.splitlines()]

    def test_each_asset_gets_a_line(self):
        text = self.GOOD.format("one") + ('[[asset]]\nmesh = "sphere.obj"\noutput = "two.spm.exr"\n'
                                          'form = "full"\nplanes = 12\nresolution = 9\nseed = 3\n'
                                          'threads = 1\n')
        result, lines = self.run_batch(text)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual([line["name"] for line in lines], ["one", "two"])
        for line in lines:
            self.assertTrue(line["ok"])
            self.assertIsNone(line["error"])
            self.assertEqual(line["exit_code"], 0)
            for key in BUILD_KEYS:
                self.assertIn(key, line)
            self.assertTrue(os.path.exists(self.path(line["name"] + ".spm.exr")))
        self.assertEqual(lines[1]["spm"]["planes"], 12)

    def test_a_failed_asset_ends_the_batch(self):
        result, lines = self.run_batch(self.BAD + self.GOOD.format("after"))
        self.assertEqual(result.returncode, 11)
        self.assertEqual(len(lines), 1)
        self.assertEqual((lines[0]["name"], lines[0]["ok"], lines[0]["exit_code"]),
                         ("broken", False, 3))
        self.assertIn("broken.obj", lines[0]["error"])
        self.assertFalse(os.path.exists(self.path("after.spm.exr")))

    def test_a_batch_that_keeps_going_bakes_the_others_and_still_fails(self):
        result, lines = self.run_batch(self.BAD + self.GOOD.format("after"), "--keep-going")
        self.assertEqual(result.returncode, 11)
        self.assertEqual([line["ok"] for line in lines], [False, True])
        self.assertTrue(os.path.exists(self.path("after.spm.exr")))
        self.assertFalse(os.path.exists(self.path("broken.spm.exr")))

    def test_a_batch_gives_the_bytes_that_build_gives(self):
        self.run_batch(self.GOOD.format("one"))
        alone = run("build", self.path("sphere.obj"), "-o", self.path("alone.spm.exr"),
                    "--tolerance", "1mm", *THIN_BAND)
        self.assertEqual(alone.returncode, 0, alone.stderr)
        self.assertEqual(digest(self.path("one.spm.exr")), digest(self.path("alone.spm.exr")))

    def test_a_manifest_that_cannot_be_read_is_refused_whole(self):
        good = self.GOOD.format("one")
        for what, text, names in (
                ("not TOML", "[[asset]\n", ["line 1"]),
                ("no asset", "# nothing\n", ["asset"]),
                ("a foreign table", good + "[other]\nx = 1\n", ["line 8", "other"]),
                ("a misspelt key", good + 'tolerence = "1mm"\n', ["line 8", "tolerance"]),
                ("a foreign key", good + "colour = 1\n", ["line 8", "colour"]),
                ("no output", good + '[[asset]]\nmesh = "sphere.obj"\n', ["line 8", "output"]),
                ("no unit", good + "fit-diagonal = 2\n", ["line 8", "fit-diagonal", "unit"]),
                ("a wrong type", good + "seed = [1, 2]\n", ["line 8", "seed"]),
                ("an output twice", good + good, ["one.spm.exr"]),
                ("a contradiction", good + "planes = 20\n", ["line 8", "planes", "full"])):
            with self.subTest(what):
                result = run("batch", self.manifest(text))
                self.expect_refusal(result, 3, "assets.toml", *names)
                self.assertFalse(os.path.exists(self.path("one.spm.exr")))
        self.expect_refusal(run("batch", self.path("none.toml")), 2, "none.toml")
        self.expect_refusal(run("batch", self.folder), 2, self.folder)


if __name__ == "__main__":
    unittest.main()
