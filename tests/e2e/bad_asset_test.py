#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Baked files that are not what they should be: refused by every command that opens one."""

import os
import unittest

from programs import NOBODY, Case, obj, plain_exr, run, sphere

SPHERE = obj(sphere(0.02, rows=8, columns=16))


def flipped(data, share):
    """The bytes with one bit turned over at a share of their length."""
    place = min(int(share * len(data)), len(data) - 1)
    return data[:place] + bytes([data[place] ^ 0x10]) + data[place + 1:]


class BadAsset(Case):
    @classmethod
    def setUpClass(cls):
        cls.asset_bytes = None

    def setUp(self):
        super().setUp()
        self.mesh = self.write("sphere.obj", SPHERE)
        if BadAsset.asset_bytes is None:
            path = self.path("good.spm.exr")
            result = run("build", self.mesh, "-o", path, "--tolerance", "1mm", "--allow-inexact",
                         "--max-depth", "0.1mm", "--margin", "0.05mm", "--quiet")
            self.assertEqual(result.returncode, 0, result.stderr)
            with open(path, "rb") as file:
                BadAsset.asset_bytes = file.read()
            os.remove(path)
        self.points = self.write("points.txt", "0 0 0.02\n")

    def commands(self, asset, out):
        return (["info", asset], ["verify", asset, self.mesh, "--samples", "10"],
                ["query", asset, "--points", self.points, "-o", os.path.join(out, "a.csv")],
                ["export", asset, "-o", os.path.join(out, "a.ply")])

    def refused(self, asset, code, user=None):
        out = self.output_folder()
        os.chmod(out, 0o777)
        for command in self.commands(asset, out):
            self.expect_refusal(run(*command, user=user), code, os.path.basename(asset))
            self.assertEqual(os.listdir(out), [])

    def test_the_good_asset_is_taken(self):
        asset = self.write("good.spm.exr", self.asset_bytes)
        for command in self.commands(asset, self.output_folder()):
            result = run(*command)
            self.assertEqual(result.returncode, 0, result.stderr)
            self.assertEqual(result.stderr, "")

    def test_a_damaged_or_foreign_file_is_refused_as_invalid_input(self):
        good = self.asset_bytes
        version = good.replace(b'"format_version":13', b'"format_version":14', 1)
        damaged = [
            ("empty", b""),
            ("text", b"This is no asset.\n"),
            ("a mesh", SPHERE.encode()),
            ("an EXR that no bake wrote", plain_exr()),
            ("bytes at the end", good + b"\0" * 16),
            ("zeros", b"\0" * len(good)),
            ("cut by a byte", good[:-1]),
            ("another version", version),
        ]
        damaged += [(f"cut at {share}", good[:int(share * len(good))])
                    for share in (0.0001, 0.01, 0.3, 0.7, 0.99)]
        damaged += [(f"a bit flipped at {share}", flipped(good, share))
                    for share in (0, 0.001, 0.01, 0.1, 0.35, 0.6, 0.85, 1)]
        self.assertFalse(version == good)
        for what, content in damaged:
            with self.subTest(what):
                self.refused(self.write("damaged.spm.exr", content), 3)

    def test_a_file_that_cannot_be_opened_is_a_file_error(self):
        with self.subTest("missing"):
            self.refused(self.path("missing.spm.exr"), 2)
        with self.subTest("a directory"):
            os.mkdir(self.path("folder.spm.exr"))
            self.refused(self.path("folder.spm.exr"), 2)
        with self.subTest("no permission"):
            path = self.write("secret.spm.exr", self.asset_bytes)
            os.chmod(path, 0)
            self.refused(path, 2, user=NOBODY if os.geteuid() == 0 else None)

    def test_verify_refuses_what_is_not_the_assets(self):
        asset = self.write("good.spm.exr", self.asset_bytes)
        other = self.write("other.obj", obj(sphere(0.021, rows=8, columns=16)))
        self.expect_refusal(run("verify", asset, other), 3, "other.obj")
        self.expect_refusal(run("verify", asset, self.path("none.obj")), 2, "none.obj")
        self.expect_refusal(run("verify", asset, self.folder), 2, self.folder)
        self.expect_refusal(run("verify", asset, self.mesh, "--band", "3mm"), 3, "--band", "100 um")

    def test_query_refuses_points_that_are_none(self):
        asset = self.write("good.spm.exr", self.asset_bytes)
        out = self.output_folder()
        for what, content, code in (("missing", None, 2), ("two numbers", "0 0 0\n1 2\n", 3),
                                    ("a word", "0 0 zero\n", 3), ("a NaN", "0 nan 0\n", 3),
                                    ("garbage", b"\x00\xff\x80" * 50, 3)):
            with self.subTest(what):
                points = (self.path("none.txt") if content is None
                          else self.write("points.txt", content))
                result = run("query", asset, "--points", points, "-o", os.path.join(out, "a.csv"))
                self.expect_refusal(result, code, os.path.basename(points))
                self.assertEqual(os.listdir(out), [])

    def test_results_that_cannot_be_written_are_file_errors(self):
        asset = self.write("good.spm.exr", self.asset_bytes)
        missing = self.path("none", "a.out")
        self.expect_refusal(run("query", asset, "--points", self.points, "-o", missing), 2, "none")
        self.expect_refusal(run("export", asset, "-o", missing), 2, "none")
        self.expect_refusal(run("info", asset, "--png", self.points), 2, "points.txt")


if __name__ == "__main__":
    unittest.main()
