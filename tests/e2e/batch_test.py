#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Batches of bakes from a manifest."""

import json
import os
import pty
import subprocess
import unittest

from programs import BAKE, BUILD_KEYS, SERVO, TETRAHEDRON, Case, digest, obj, run, sphere, tetrahedron


class Batch(Case):
    def manifest(self, text):
        self.write("small.obj", obj(tetrahedron(0.05)))
        self.write("broken.obj", "v 0 0 0\n")
        return self.write("assets.toml", text)

    GOOD = ('[[asset]]\nname = "{0}"\nmesh = "small.obj"\noutput = "{0}.spm.exr"\n'
            'tolerance = "1mm"\nmax-depth = "10mm"\nmargin = "5mm"\n')
    BAD = '[[asset]]\nmesh = "broken.obj"\noutput = "broken.spm.exr"\n'

    def run_batch(self, text, *options):
        result = run("batch", self.manifest(text), "--json", *options)
        return result, [json.loads(line) for line in result.stdout.splitlines()]

    def test_each_asset_gets_a_line(self):
        text = self.GOOD.format("one") + ('[[asset]]\nmesh = "small.obj"\noutput = "two.spm.exr"\n'
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
        alone = run("build", self.path("small.obj"), "-o", self.path("alone.spm.exr"),
                    "--tolerance", "1mm", "--max-depth", "10mm", "--margin", "5mm")
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
                ("no output", good + '[[asset]]\nmesh = "small.obj"\n', ["line 8", "output"]),
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


class ManyAssets(Case):
    """A pattern over four small meshes, one of which is no mesh, and a fifth on its own."""

    MANIFEST = ('[defaults]\noutput = "baked/{stem}.spm.exr"\ntolerance = "1mm"\n'
                'max-depth = "10mm"\nmargin = "5mm"\n'
                '[[asset]]\nmesh = "meshes/*.obj"\n'
                '[[asset]]\nmesh = "meshes/c.obj"\nname = "special"\ntolerance = "0.5mm"\n')
    NAMES = ["a", "b", "broken", "special"]

    def setUp(self):
        super().setUp()
        self.output_folder("meshes")
        self.output_folder("baked")
        for place, letter in enumerate("abc"):
            self.write(f"meshes/{letter}.obj", obj(tetrahedron(0.05 + place / 1000)))
        self.write("meshes/broken.obj", "v 0 0 0\n")
        self.manifest = self.write("assets.toml", self.MANIFEST)

    def batch(self, *options):
        result = run("batch", self.manifest, "--json", *options)
        return result, [json.loads(line) for line in result.stdout.splitlines()]

    def baked(self):
        folder = self.path("baked")
        return {name: digest(os.path.join(folder, name)) for name in sorted(os.listdir(folder))}

    def test_lines_and_bytes_are_the_same_for_any_number_of_jobs(self):
        found = []
        for jobs in (1, 4):
            result, lines = self.batch("-j", jobs, "--keep-going")
            self.assertEqual(result.returncode, 11, result.stderr)
            self.assertEqual([line["name"] for line in lines], self.NAMES)
            self.assertEqual([line["ok"] for line in lines], [True, True, False, True])
            self.assertEqual([line.get("tolerance_um") for line in lines], [1000, 1000, None, 500])
            self.assertIn("1 of 4 assets failed: broken (exit 3)", result.stderr.splitlines()[-1])
            found.append(self.baked())
        self.assertEqual(list(found[0]), [f"{name}.spm.exr" for name in "abc"])
        self.assertEqual(found[0], found[1])

    def test_failures_are_summed_up_at_the_end(self):
        os.rename(self.path("meshes/broken.obj"), self.path("meshes/a.obj"))
        result, lines = self.batch()
        self.assertEqual([line["name"] for line in lines], ["a"])
        self.assertIn("1 of 3 assets failed and 2 were not begun: a (exit 3)",
                      result.stderr.splitlines()[-1])

    def test_a_missing_mesh_is_told_before_anything_is_baked(self):
        text = self.MANIFEST + '[[asset]]\nmesh = "meshes/none.obj"\n'
        self.manifest = self.write("assets.toml", text)
        result, lines = self.batch()
        self.assertEqual(result.returncode, 11)
        self.assertEqual(self.baked(), {})
        self.assertEqual([line["name"] for line in lines], ["none"])
        self.assertEqual(lines[0]["exit_code"], 2)
        for what in ("line 13", "'mesh'", "none.obj"):
            self.assertIn(what, lines[0]["error"])
        os.unlink(self.path("meshes/b.obj"))
        os.unlink(self.path("meshes/c.obj"))
        result, lines = self.batch("--keep-going", "-j", 3)
        self.assertEqual(result.returncode, 11)
        self.assertEqual([line["ok"] for line in lines], [True, False, False, False])

    def test_a_missing_folder_for_outputs_is_made(self):
        os.rmdir(self.path("baked"))
        result, lines = self.batch("--dry-run")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertFalse(os.path.exists(self.path("baked")))
        self.batch("--keep-going")
        self.assertIn("a.spm.exr", self.baked())

    def test_a_folder_that_cannot_be_made_is_told_with_its_line(self):
        os.rmdir(self.path("baked"))
        self.write("baked", "a file")
        result, lines = self.batch("--keep-going")
        self.assertEqual(result.returncode, 11)
        self.assertEqual({line["exit_code"] for line in lines}, {2})
        self.assertIn("line 2: 'output'", lines[0]["error"])

    def test_a_batch_fails_on_what_nobody_wants_in_its_meshes(self):
        vertices, triangles = TETRAHEDRON
        self.write("meshes/b.obj", obj((vertices, triangles[1:])))
        result, lines = self.batch("--fail-on", "sheets,open", "--keep-going")
        self.assertEqual(result.returncode, 11)
        refused = [line for line in lines if line["name"] == "b"][0]
        self.assertEqual(refused["exit_code"], 3)
        self.assertIn("--fail-on open", refused["error"])
        self.assertTrue([line for line in lines if line["name"] == "a"][0]["ok"])

    def test_a_dry_run_lists_the_assets_and_bakes_nothing(self):
        result, lines = self.batch("--dry-run")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual([line["name"] for line in lines], self.NAMES)
        self.assertEqual({line["dry_run"] for line in lines}, {True})
        self.assertEqual(lines[0]["output"], self.path("baked/a.spm.exr"))
        self.assertEqual(self.baked(), {})
        self.assertIn("meshes/a.obj -> ", run("batch", self.manifest, "--dry-run").stdout)
        os.unlink(self.path("meshes/c.obj"))
        result, lines = self.batch("--dry-run")
        self.assertEqual(result.returncode, 11)
        self.assertEqual([line["ok"] for line in lines], [True] * 3 + [False])

    def test_a_terminal_shows_how_much_is_done_of_how_many(self):
        master, slave = pty.openpty()
        self.addCleanup(os.close, master)
        process = subprocess.Popen([BAKE, "batch", self.manifest, "-j", "2", "--keep-going"],
                                   stdout=subprocess.DEVNULL, stderr=slave)
        os.close(slave)
        shown = b""
        while True:
            try:
                block = os.read(master, 4096)
            except OSError:  # the other end is closed
                break
            if not block:
                break
            shown += block
        self.assertEqual(process.wait(), 11)
        self.assertRegex(shown.decode(), r"batch +\d+ %.*; \d of 4 assets, \w+: \w+")

    def test_the_time_limit_of_one_asset_ends_no_other(self):
        self.write("meshes/fine.obj", obj(sphere(0.05, rows=96, columns=192)))
        self.manifest = self.write("assets.toml", (
            '[defaults]\noutput = "baked/{stem}.spm.exr"\ntolerance = "1mm"\n'
            '[[asset]]\nmesh = "meshes/fine.obj"\ntolerance = "2um"\ntime-limit = 1\n'
            '[[asset]]\nmesh = "meshes/a.obj"\nmax-depth = "10mm"\nmargin = "5mm"\n'))
        result, lines = self.batch("--keep-going", "-j", 2)
        self.assertEqual(result.returncode, 11)
        self.assertEqual([line["exit_code"] for line in lines], [10, 0])
        self.assertIn("time limit of 1 s", lines[0]["error"])
        self.assertEqual(list(self.baked()), ["a.spm.exr"])


class Scenes(Case):
    """A scene of two small meshes, one of which is the tool."""

    MANIFEST = ('[defaults]\noutput = "baked/{stem}.spm.exr"\ntolerance = "1mm"\n'
                'max-depth = "10mm"\nmargin = "5mm"\n'
                '[[asset]]\nmesh = "meshes/*.obj"\n'
                '[[scene]]\nscene = "scenes/*.toml"\noutput = "baked/{stem}.toml"\n')
    SCENE = ('[device]\nprofile = "touch"\n[tool]\nmesh = "../meshes/tool.obj"\n'
             '[[object]]\nmesh = "../meshes/thing.obj"\n')

    def setUp(self):
        super().setUp()
        for folder in ("meshes", "scenes", "baked"):
            self.output_folder(folder)
        self.write("meshes/thing.obj", obj(tetrahedron(0.05)))
        self.write("meshes/tool.obj", obj(tetrahedron(0.02)))
        self.write("scenes/table.toml", self.SCENE)
        self.manifest = self.write("assets.toml", self.MANIFEST)

    def batch(self, *options, command="batch"):
        result = run(command, self.manifest, *options, "--json")
        return result, [json.loads(line) for line in result.stdout.splitlines()]

    def test_one_batch_bakes_a_library_and_the_scenes_that_the_servo_then_plays(self):
        result, lines = self.batch()
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual([line["name"] for line in lines], ["thing", "tool", "table"])
        self.assertEqual(lines[2]["output"], self.path("baked/table.toml"))
        self.assertEqual(len(lines[2]["assets"]), 2)
        way = self.write("way.txt", "".join(f"0 0 {z} 1 0 0 0\n" for z in (0.2, 0.1, 0.02)))
        os.rename(self.path("scenes"), self.path("elsewhere"))
        replayed = run("replay", way, "--scene", self.path("baked/table.toml"), "--out",
                       self.path("out.csv"), "--json", program=SERVO)
        self.assertEqual(replayed.returncode, 0, replayed.stderr)
        self.assertEqual(json.loads(replayed.stdout)["ticks"], 3)

    def test_a_scene_with_a_failed_asset_is_not_written(self):
        self.write("meshes/tool.obj", "v 0 0 0\n")
        result, lines = self.batch("--keep-going")
        self.assertEqual(result.returncode, 11)
        self.assertEqual([line["ok"] for line in lines], [True, False, False])
        self.assertIn("tool", lines[2]["error"])
        self.assertFalse(os.path.exists(self.path("baked/table.toml")))

    def test_shards_leave_their_scenes_to_the_merge(self):
        results = [self.path(f"{shard}.json") for shard in (1, 2)]
        for shard, file in enumerate(results, 1):
            result, lines = self.batch("--shard", f"{shard}/2", "--result", file)
            self.assertEqual(result.returncode, 0, result.stderr)
            self.assertEqual(len(lines), 1)
        self.assertFalse(os.path.exists(self.path("baked/table.toml")))
        result, (merged,) = self.batch(*results, command="merge")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual([scene["ok"] for scene in merged["scenes"]], [True])
        self.assertTrue(os.path.exists(self.path("baked/table.toml")))


if __name__ == "__main__":
    unittest.main()
