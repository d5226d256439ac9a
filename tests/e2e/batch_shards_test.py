#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A batch in shards, as a cluster or a CI service runs it, and what merge says of the results."""

import json
import os
import unittest

from programs import Case, digest, obj, run, tetrahedron


class Shards(Case):
    NAMES = ["a", "b", "c", "d"]

    def setUp(self):
        super().setUp()
        for name in ("meshes", "baked"):
            self.output_folder(name)
        for place, letter in enumerate(self.NAMES):
            self.write(f"meshes/{letter}.obj", obj(tetrahedron(0.05 + place / 1000)))
        self.manifest = self.write("assets.toml", (
            '[defaults]\nmax-depth = "10mm"\nmargin = "5mm"\ntolerance = "1mm"\n'
            '[[asset]]\nmesh = "meshes/*.obj"\noutput = "baked/{stem}.spm.exr"\n'))

    def shard(self, index, count, *options, jobs=2):
        result = run("batch", self.manifest, "--json", "-j", jobs, "--shard", f"{index}/{count}",
                     "--result", self.result(index), *options)
        return result, [json.loads(line) for line in result.stdout.splitlines()]

    def result(self, index):
        return self.path(f"result-{index}.json")

    def merge(self, *shards):
        found = run("merge", self.manifest, *[self.result(index) for index in shards], "--json")
        return found, json.loads(found.stdout) if found.stdout else None

    def baked(self):
        folder = self.path("baked")
        return {name: digest(os.path.join(folder, name)) for name in sorted(os.listdir(folder))}

    def test_shards_give_the_bytes_of_one_run_and_merge_finds_them_all(self):
        self.assertEqual(run("batch", self.manifest, "-j", "2", "--quiet").returncode, 0)
        whole = self.baked()
        for name in whole:
            os.unlink(self.path("baked", name))
        seen = []
        for index in (1, 2, 3):
            result, lines = self.shard(index, 3)
            self.assertEqual(result.returncode, 0, result.stderr)
            seen += [line["name"] for line in lines]
        self.assertEqual(sorted(seen), self.NAMES)
        self.assertEqual(self.baked(), whole)
        found, report = self.merge(1, 2, 3)
        self.assertEqual(found.returncode, 0, found.stderr)
        self.assertEqual((report["done"], report["passed"]), (4, True))

        found, report = self.merge(3, 1)
        self.assertEqual(found.returncode, 11)
        self.assertEqual(report["missing_shards"], [2])
        self.assertIn("shard 2/3", found.stderr)
        for name in report["missing"]:
            self.assertIn(f"error: {name}: missing", found.stderr)

        os.unlink(self.path("baked/c.spm.exr"))
        found, report = self.merge(1, 2, 3)
        self.assertEqual((found.returncode, report["lost"]), (11, ["c"]))
        self.assertIn("error: c: ", found.stderr)

        with open(self.manifest, "a", encoding="utf-8") as file:
            file.write("# another state of it\n")
        self.expect_refusal(self.merge(1, 2, 3)[0], 3, self.result(1), "another manifest")
        self.expect_refusal(run("merge", self.manifest, self.manifest), 3, self.manifest)
        self.expect_refusal(run("merge", self.manifest, self.path("none")), 2, "none")

    def test_a_failed_asset_is_told_by_name_and_an_old_result_is_no_result(self):
        self.write("meshes/b.obj", "v 0 0 0\n")
        self.write("result-1.json", "an old one")
        result, _ = self.shard(1, 1, "--keep-going")
        self.assertEqual(result.returncode, 11)
        found, report = self.merge(1)
        self.assertEqual(found.returncode, 11)
        self.assertEqual([failed["name"] for failed in report["failed"]], ["b"])
        self.assertIn("error: b: ", found.stderr)
        self.shard(1, 1, jobs=1)
        self.assertEqual(self.merge(1)[1]["missing"], ["c", "d"])

    def test_shards_out_of_range_and_results_that_cannot_be_written_are_refused(self):
        for shard in ("0/4", "5/4", "1/0", "1", "x/2", "-1/2"):
            self.expect_refusal(run("batch", self.manifest, f"--shard={shard}"), 1, "--shard", shard)
        self.expect_refusal(run("batch", self.manifest, "--result", self.path("no/r.json")), 2, "no/r.json")
        self.expect_refusal(run("batch", self.manifest, "--memory", "8"), 1, "--memory", "unit")
        self.assertEqual(self.baked(), {})

    def test_more_shards_than_assets_leave_some_empty(self):
        for index in range(1, 6):
            result, lines = self.shard(index, 5, "--dry-run")
            self.assertEqual(result.returncode, 0, result.stderr)
            self.assertEqual(len(lines), 1 if index < 5 else 0)
        result, lines = self.shard(5, 5)
        self.assertEqual((result.returncode, lines), (0, []))
        with open(self.result(5), encoding="utf-8") as file:
            self.assertEqual(json.load(file)["assets"], [])

    def test_little_memory_bakes_one_asset_after_the_other(self):
        result = run("batch", self.manifest, "-j", "4", "--memory", "1MB", "--shard", "1/2")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(len(self.baked()), 2)


if __name__ == "__main__":
    unittest.main()
