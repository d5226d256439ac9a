#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Nothing is baked twice: the cache of batches and builds, and what it survives."""

import json
import os
import random
import shutil
import signal
import subprocess
import tempfile
import time
import unittest

from programs import BAKE, BIN, Case, digest, obj, run, tetrahedron

SMALL = ("--max-depth", "10mm", "--margin", "5mm", "--tolerance", "1mm")  # bakes soonest
LONG_AGO = 1_000_000_000


class CacheCase(Case):
    def setUp(self):
        super().setUp()
        self.cache = self.path("cache")
        self.mesh = self.write("m.obj", obj(tetrahedron(0.05)))

    def build(self, output="m.spm.exr", *options, mesh=None):
        return self.run_json("build", mesh or self.mesh, "-o", self.path(output), *SMALL, "--cache",
                             self.cache, *options)

    def entries(self):
        """The files of the entries, which are all that the folder `entries` may hold."""
        return [os.path.join(folder, name)
                for folder, _, names in os.walk(os.path.join(self.cache, "entries"))
                for name in names]


class OneBuild(CacheCase):
    def test_a_second_build_is_a_hit_with_the_bytes_and_the_report_of_the_first(self):
        first = self.build()
        second = self.build("elsewhere.spm.exr")
        self.assertEqual((first["cache"], second["cache"]), ("miss", "hit"))
        self.assertEqual(digest(self.path("m.spm.exr")), digest(self.path("elsewhere.spm.exr")))
        self.assertEqual(second["output"], self.path("elsewhere.spm.exr"))
        for own in ("output", "cache", "cache_reason", "seconds", "threads", "peak_rss_bytes"):
            del first[own], second[own]
        self.assertEqual(first, second)

    def test_an_output_that_is_right_is_left_alone_and_a_spoilt_one_is_mended(self):
        self.build()
        output = self.path("m.spm.exr")
        right = digest(output)
        os.utime(output, (LONG_AGO, LONG_AGO))
        self.assertEqual(self.build()["cache"], "hit")
        self.assertEqual(os.stat(output).st_mtime, LONG_AGO)
        with open(output, "r+b") as file:
            file.seek(1000)
            file.write(b"spoilt")
        self.build()
        self.assertEqual(digest(output), right)

    def test_misses_are_explained(self):
        self.assertIn("never built", self.build()["cache_reason"])
        found = self.build("m.spm.exr", "--seed", "7")
        self.assertEqual((found["cache"], found["cache_reason"]), ("miss", "seed was 1 and is 7"))
        text = run("build", self.mesh, "-o", self.path("m.spm.exr"), *SMALL, "--cache", self.cache,
                   "--explain").stdout
        self.assertIn("cache    hit: ", text)
        shutil.rmtree(os.path.join(self.cache, "entries"))
        self.assertEqual(self.build()["cache_reason"], "the entry was pruned")

    def test_a_corrupt_entry_is_reported_removed_and_baked_anew(self):
        right = self.build()["content_sha256"]
        entry, = self.entries()
        with open(entry, "r+b") as file:
            file.seek(-100, os.SEEK_END)
            file.write(b"rot")
        verdict = run("cache", "verify", self.cache)
        self.assertEqual(verdict.returncode, 3)
        self.assertIn(entry, verdict.stderr)
        result = run("build", self.mesh, "-o", self.path("m.spm.exr"), *SMALL, "--json", "--cache",
                     self.cache)
        self.assertEqual(result.returncode, 0)
        self.assertIn("warning: an entry of the cache is baked anew", result.stderr)
        report = json.loads(result.stdout)
        self.assertEqual((report["cache"], report["cache_reason"]), ("miss", "the entry was corrupt"))
        self.assertEqual(report["content_sha256"], right)
        self.assertEqual(run("cache", "verify", self.cache).returncode, 0)
        self.assertEqual(self.build()["cache"], "hit")

    def test_a_cache_is_looked_after(self):
        self.build()
        stats = self.run_json("cache", "stats", self.cache)
        self.assertEqual((stats["entries"], stats["leftovers"]), (1, 0))
        self.assertEqual(stats["bytes"], os.path.getsize(self.entries()[0]))
        self.assertEqual(self.run_json("cache", "prune", self.cache, "--max-size", "1GB")["removed"], 0)
        self.assertEqual(self.run_json("cache", "prune", self.cache, "--max-size", "1kB")["removed"], 1)
        self.assertEqual(self.entries(), [])
        self.expect_refusal(run("cache", "prune", self.cache), 1, "--max-size")
        self.expect_refusal(run("cache", "prune", self.cache, "--max-size", "1"), 1, "unit")
        self.expect_refusal(run("cache", "stats", self.path("none")), 2, "none")
        self.expect_refusal(run("cache", "prune", self.folder, "--max-size", "0B"), 3, self.folder)
        self.expect_refusal(run("build", self.mesh, "-o", self.path("x"), "--cache", self.folder), 3,
                            self.folder)

    def test_a_full_disk_costs_the_cache_an_entry_and_the_build_a_warning(self):
        disk = tempfile.mkdtemp(prefix="spm-e2e-disk-")
        self.addCleanup(shutil.rmtree, disk, ignore_errors=True)
        if subprocess.run(["mount", "-t", "tmpfs", "-o", "size=8k", "tmpfs", disk],
                          capture_output=True, check=False).returncode != 0:
            self.skipTest("no small disk can be mounted here; run the tests as root")
        self.addCleanup(subprocess.run, ["umount", disk], check=False)
        self.cache = os.path.join(disk, "cache")
        os.mkdir(self.cache)
        output = self.path("m.spm.exr")
        result = run("build", self.mesh, "-o", output, *SMALL, "--cache", self.cache)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("warning: the cache keeps nothing of this bake", result.stderr)
        self.assertTrue(os.path.exists(output))
        self.assertEqual(self.entries(), [])
        with open(os.path.join(disk, "filler"), "wb", buffering=0) as file:
            try:
                while True:
                    file.write(b"x" * 512)
            except OSError:
                pass
        target = os.path.join(disk, "m.spm.exr")
        self.expect_refusal(run("build", self.mesh, "-o", target, *SMALL, "--quiet"), 2, target, "space")
        self.assertEqual(sorted(os.listdir(disk)), ["cache", "filler"])


class Batches(CacheCase):
    """Three small meshes in a batch."""

    def setUp(self):
        super().setUp()
        for name in ("meshes", "baked"):
            self.output_folder(name)
        for place, letter in enumerate("abc"):
            self.write(f"meshes/{letter}.obj", obj(tetrahedron(0.05 + place / 1000)))
        self.manifest = self.write("assets.toml", (
            '[defaults]\nmax-depth = "10mm"\nmargin = "5mm"\ntolerance = "1mm"\n'
            '[[asset]]\nmesh = "meshes/*.obj"\noutput = "baked/{stem}.spm.exr"\n'))

    def arguments(self, *options):
        return ["batch", self.manifest, "--json", "-j", "2", "--cache", self.cache,
                *map(str, options)]

    def batch(self, *options):
        result = run(*self.arguments(*options))
        self.assertEqual(result.returncode, 0, result.stderr)
        return [json.loads(line) for line in result.stdout.splitlines()]

    def baked(self):
        folder = self.path("baked")
        return {name: digest(os.path.join(folder, name)) for name in sorted(os.listdir(folder))}

    def test_only_what_changed_is_baked_again(self):
        self.assertEqual([line["cache"] for line in self.batch()], ["miss"] * 3)
        before = {name: os.stat(self.path("baked", name)).st_mtime_ns for name in self.baked()}
        self.write("meshes/b.obj", obj(tetrahedron(0.06)))
        lines = self.batch("--dry-run")
        self.assertEqual([line["cache"] for line in lines], ["hit", "miss", "hit"])
        lines = self.batch()
        self.assertEqual([line["cache"] for line in lines], ["hit", "miss", "hit"])
        self.assertEqual(lines[1]["cache_reason"], "the mesh's bytes changed")
        after = {name: os.stat(self.path("baked", name)).st_mtime_ns for name in self.baked()}
        self.assertEqual([name for name in before if before[name] != after[name]], ["b.spm.exr"])

    def test_two_batches_at_once_bake_each_asset_once_and_give_whole_files(self):
        started = [subprocess.Popen([BAKE, *self.arguments()], stdout=subprocess.PIPE, text=True)
                   for _ in range(2)]
        reports = []
        for process in started:
            text, _ = process.communicate(timeout=300)
            self.assertEqual(process.returncode, 0)
            reports += [json.loads(line) for line in text.splitlines()]
        self.assertEqual(sorted(line["cache"] for line in reports), ["hit"] * 3 + ["miss"] * 3)
        self.assertEqual(len(self.baked()), 3)
        self.assertEqual({line["content_sha256"] for line in reports}, set(self.baked().values()))
        self.assertEqual(self.run_json("cache", "stats", self.cache)["leftovers"], 0)

    def test_batches_that_are_killed_leave_nothing_that_a_later_one_stumbles_over(self):
        clean = {line["name"]: line["content_sha256"] for line in self.batch()}
        shutil.rmtree(self.cache)
        shutil.rmtree(self.path("baked"))
        self.output_folder("baked")
        moments = random.Random(28)
        for _ in range(6):
            process = subprocess.Popen([BAKE, *self.arguments()], stdout=subprocess.DEVNULL)
            time.sleep(moments.uniform(0.02, 0.7))
            process.send_signal(signal.SIGKILL)
            process.wait()
            self.wait_until_gone()
            for entry in self.entries():
                self.assertNotIn(".tmp-", entry)
            if os.path.isdir(self.cache):
                self.assertIn(run("cache", "verify", self.cache).returncode, (0, 3))
        lines = self.batch()
        self.assertEqual({line["name"]: line["content_sha256"] for line in lines}, clean)
        self.assertEqual(self.baked(), {f"{name}.spm.exr": value for name, value in clean.items()})
        self.assertEqual(self.run_json("cache", "verify", self.cache)["corrupt"], 0)

    def wait_until_gone(self):
        """The bakes of a batch end with it."""
        deadline = time.monotonic() + 20
        while time.monotonic() < deadline:
            found = subprocess.run(["pgrep", "-f", self.manifest], capture_output=True, check=False)
            if found.returncode == 1:
                return
            time.sleep(0.02)
        self.fail("bakes outlive their batch")

    def test_ninja_and_make_bake_only_what_a_dep_file_says(self):
        if not (shutil.which("ninja") and shutil.which("make")):
            self.skipTest("ninja or make is not installed; scripts/setup run brings ninja")
        bake = os.path.join(BIN, "spm-bake")
        command = f"{bake} batch assets.toml --quiet -j 2 --cache cache --depfile assets.d"
        outputs = " ".join(f"baked/{letter}.spm.exr" for letter in "abc")
        self.write("build.ninja", f"rule bake\n  command = {command}\n  depfile = assets.d\n"
                                  f"  restat = 1\nbuild {outputs}: bake assets.toml\n")
        self.write("Makefile", f"all: {outputs}\n{outputs} &: assets.toml\n"
                               f"\t{command}\n\ttouch {outputs}\n-include assets.d\n")
        for tool in (["ninja"], ["make", "-s"]):
            with self.subTest(tool[0]):
                os.utime(self.manifest)
                self.tool(*tool)
                self.assertEqual(len(self.baked()), 3)
                self.assertIn(self.tool(*tool).strip(), ("", "ninja: no work to do."))
                before = self.baked()
                self.write("meshes/c.obj", obj(tetrahedron(0.07 + len(tool) / 100)))
                self.tool(*tool)
                self.assertEqual([name for name, value in self.baked().items()
                                  if value != before[name]], ["c.spm.exr"])

    def tool(self, *arguments):
        result = subprocess.run(arguments, cwd=self.folder, capture_output=True, text=True,
                                check=False)
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        return result.stdout


if __name__ == "__main__":
    unittest.main()
