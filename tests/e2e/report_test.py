#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The page of spm-bake's --report in headless Chromium."""

import json
import os
import pathlib
import shutil
import tempfile
import unittest

from browser import Browser, is_there
from programs import BIN, Case, generate, models_of, run

PAGE = os.path.join(BIN, os.pardir, "share", "spm-haptics", "report", "report.html")
PICTURES = os.path.join(BIN, os.pardir, "pictures")
HOSTILE = "<img src=x onerror='window.harmed=1'>&amp;.spm.exr"
LARGEST = 600_000  # bytes, of the report of a small bake

WITHOUT = ("npm has not built the page: run scripts/build_page" if not os.path.exists(PAGE) else
           "chromium and chromedriver are not there: install chromium-driver" if not is_there() else "")


def setUpModule():
    if WITHOUT:
        raise unittest.SkipTest(WITHOUT)
    Shown.browser = Browser()
    unittest.addModuleCleanup(Shown.browser.close)


class Shown(Case):
    """The browser, which all tests share, and what they ask it."""

    browser = None

    def show(self, page, ready):
        self.browser.open(pathlib.Path(page).as_uri())
        self.browser.wait(f"window.{ready}")
        self.assertEqual(self.browser.errors(), [])

    def text(self, name):
        return self.browser.run(f"return document.getElementById('{name}').textContent")


class Report(Shown):
    """A report of a bake, on an asset whose name is hostile."""

    @classmethod
    def setUpClass(cls):
        cls.models = models_of(cls, "box", "sphere")
        cls.mesh = os.path.join(cls.models, "box.obj")
        cls.asset = os.path.join(cls.models, HOSTILE)
        cls.page = os.path.join(cls.models, "baked.html")
        done = run("build", cls.mesh, "-o", cls.asset, "--tolerance", "50um", "--report", cls.page, "--json")
        assert done.returncode == 0, done.stderr
        cls.built = json.loads(done.stdout)

    def open(self, page):
        self.show(page, "spmReport")

    def test_the_report_of_a_bake_says_and_draws_what_was_found(self):
        self.open(self.page)
        self.assertTrue(self.text("verdict").startswith("The promise is kept"))
        self.assertEqual(self.text("title"), HOSTILE)
        self.assertIn("50 µm", self.text("facts"))
        self.assertIn(f"{self.built['bytes']:,} bytes", self.text("facts"))
        self.assertEqual(self.browser.run("return document.querySelectorAll('#histogram g rect').length"), 41)
        self.assertEqual(self.browser.run("return document.querySelectorAll('#worst tbody tr').length"), 20)
        self.assertEqual(self.browser.run("return document.querySelectorAll('#pictures img').length"), 8)
        self.assertIn("total", self.text("times"))
        self.assertLess(os.path.getsize(self.page), LARGEST)

    def test_the_surface_is_drawn_and_turns_to_a_place_that_is_asked_for(self):
        self.open(self.page)
        colours = self.browser.run(
            "const s = spmReport.surface, seen = new Set(), one = new Uint8Array(4); s.draw();"
            "const gl = s.renderer.getContext();"
            "for (let i = 1; i < 40; ++i) for (let k = 1; k < 40; ++k) {"
            "  gl.readPixels(i * gl.drawingBufferWidth / 40, k * gl.drawingBufferHeight / 40, 1, 1,"
            "                gl.RGBA, gl.UNSIGNED_BYTE, one); seen.add(one.join()); }"
            "return seen.size")
        self.assertGreaterEqual(colours, 3)
        before = self.browser.run("return spmReport.surface.camera.position.toArray()")
        self.browser.run("document.querySelector('#worst button').click()")
        self.assertNotEqual(self.browser.run("return spmReport.surface.camera.position.toArray()"), before)

    def test_a_hostile_name_stays_text(self):
        self.open(self.page)
        self.assertIsNone(self.browser.run("return window.harmed ?? null"))
        self.assertEqual(self.browser.run("return document.querySelectorAll('h1 img').length"), 0)

    def test_wide_and_narrow_fit_the_window(self):
        self.open(self.page)
        self.addCleanup(self.browser.resize, 1280, 800)
        os.makedirs(PICTURES, exist_ok=True)
        for name, width, height in (("wide", 1280, 1600), ("narrow", 390, 844)):
            self.browser.resize(width, height)
            self.assertLessEqual(self.browser.run("return document.documentElement.scrollWidth"), width)
            self.browser.screenshot(os.path.join(PICTURES, f"report-{name}.png"))

    def test_the_page_may_reach_nothing(self):
        self.open(self.page)
        self.assertEqual(self.browser.run(
            "return fetch('http://127.0.0.1:9/').then(() => 'reached', () => 'kept')"), "kept")
        self.browser.errors()  # what the browser says of it

    def test_verify_writes_the_same_page_without_what_only_a_bake_knows(self):
        page = os.path.join(self.models, "verified.html")
        done = run("verify", self.asset, self.mesh, "--samples", "20000", "--report", page, "--json")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(json.loads(done.stdout)["report"], page)
        self.open(page)
        self.assertTrue(self.browser.run("return document.getElementById('times-box').hidden"))
        self.assertIn("20,000 even", self.text("facts"))

    def test_another_mesh_leaves_no_report(self):
        page = os.path.join(self.models, "other.html")
        done = run("verify", self.asset, os.path.join(self.models, "sphere.obj"), "--report", page)
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertFalse(os.path.exists(page))

    def test_without_the_mesh_there_is_a_sentence_and_no_report(self):
        page = os.path.join(self.models, "without.html")
        done = run("verify", self.asset, os.path.join(self.models, "gone.obj"), "--report", page)
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertIn("gone.obj", done.stderr)
        self.assertFalse(os.path.exists(page))

    def test_a_report_that_cannot_be_written_is_refused_before_the_work(self):
        asset = os.path.join(self.models, "never.spm.exr")
        done = run("build", self.mesh, "-o", asset, "--report", os.path.join(self.models, "no", "a.html"))
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertFalse(os.path.exists(asset))


class BatchReport(Shown):
    """The page of a batch: two assets, one of a hostile name, and one that fails."""

    @classmethod
    def setUpClass(cls):
        cls.models = tempfile.mkdtemp(prefix="spm-e2e-batch-report-")
        cls.addClassCleanup(shutil.rmtree, cls.models, ignore_errors=True)
        generate(cls.models, "box", "sphere")
        cls.manifest = os.path.join(cls.models, "three.toml")
        with open(cls.manifest, "w", encoding="utf-8") as file:
            for name, mesh, depth in (("large", "sphere.obj", "2mm"), (HOSTILE, "box.obj", "0.1mm"),
                                      ("missing", "none.obj", "0.1mm")):
                file.write(f'[[asset]]\nname = {json.dumps(name)}\nmesh = "{mesh}"\n'
                           f'output = "{len(name)}.spm.exr"\ntolerance = "50um"\nmax-depth = "{depth}"\n')
        cls.page = os.path.join(cls.models, "batch.html")
        done = run("batch", cls.manifest, "--keep-going", "--report", cls.page, "--json")
        assert done.returncode == 11, done.stderr
        cls.lines = [json.loads(line) for line in done.stdout.splitlines()]

    def open_batch(self):
        self.show(self.page, "spmBatch")

    def names(self):
        return self.browser.run("return [...document.querySelectorAll('#assets tbody tr')]"
                                ".map((line) => line.cells[1].textContent)")

    def sort(self, key):
        self.browser.run("document.querySelector(`th[data-key=${arguments[0]}] button`).click()", key)
        return self.names()

    def test_failures_come_first_and_say_why(self):
        self.open_batch()
        self.assertEqual(self.names(), ["missing", "large", HOSTILE])
        self.assertTrue(self.text("verdict").startswith("1 of 3 assets failed"))
        self.assertIn("none.obj cannot be opened", self.browser.run(
            "return document.querySelector('#assets tbody tr').textContent"))

    def test_a_head_sorts_both_ways_and_what_is_missing_stays_last(self):
        self.open_batch()
        sizes = {line["name"]: line["bytes"] for line in self.lines if line["ok"]}
        self.assertGreater(sizes["large"], sizes[HOSTILE])
        self.assertEqual(self.sort("bytes"), [HOSTILE, "large", "missing"])
        self.assertEqual(self.sort("bytes"), ["large", HOSTILE, "missing"])
        self.assertEqual(self.browser.run("return document.querySelector('th[data-key=bytes]').ariaSort"),
                         "descending")
        self.assertEqual(self.sort("name")[1:], ["large", "missing"])

    def test_names_are_found_and_a_picture_and_the_proof_are_shown(self):
        self.open_batch()
        self.browser.run("const f = document.getElementById('filter'); f.value = 'LARGE';"
                         "f.dispatchEvent(new Event('input'))")
        self.assertEqual(self.names(), ["large"])
        self.assertEqual(self.text("shown"), "1 of 3")
        self.assertTrue(self.browser.run("return document.querySelector('#assets img').naturalWidth") > 50)
        self.assertIn("µm", self.browser.run(
            "return document.querySelector('#assets tbody tr').cells[6].textContent"))
        self.assertIsNone(self.browser.run("return window.harmed ?? null"))

    def test_the_page_fits_wide_and_narrow(self):
        self.open_batch()
        self.addCleanup(self.browser.resize, 1280, 800)
        os.makedirs(PICTURES, exist_ok=True)
        for name, width, height in (("wide", 1280, 700), ("narrow", 390, 844)):
            self.browser.resize(width, height)
            self.assertLessEqual(self.browser.run("return document.documentElement.scrollWidth"), width)
            self.browser.screenshot(os.path.join(PICTURES, f"batch-{name}.png"))

    def test_a_page_of_a_dry_run_is_refused(self):
        done = run("batch", self.manifest, "--dry-run", "--report", os.path.join(self.models, "never.html"))
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertIn("--report", done.stderr)


if __name__ == "__main__":
    unittest.main()
