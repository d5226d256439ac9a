#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Recordings in the page of spm-servo view, in headless Chromium: played, compared, saved as pictures."""

import base64
import json
import os
import shutil
import subprocess
import time
import unittest
import xml.dom.minidom

from browser import Browser, is_there
from programs import BIN, SERVO, Case, bake_box, run

PAGE = os.path.join(BIN, os.pardir, "share", "spm-haptics", "view", "recording.html")
PICTURES = os.path.join(BIN, os.pardir, "pictures")
PATIENCE = 60.0  # s
STIFFNESS = 400.0  # N/m
HOSTILE = "<img src=x onerror='window.harmed=1'>&amp;.spmrec"

WITHOUT = ("npm has not built the page: run scripts/build_page" if not os.path.exists(PAGE) else
           "chromium and chromedriver are not there: install chromium-driver" if not is_there() else "")


def setUpModule():
    if WITHOUT:
        raise unittest.SkipTest(WITHOUT)


class Played(Case):
    """A recording with a fault, whose name is hostile, beside another method on the same path; and what is
    left of it when it is cut short."""

    @classmethod
    def setUpClass(cls):
        bake_box(cls, "--tolerance", "50um")
        asset = os.path.join(cls.models, "touched.spm.exr")
        cls.touched = asset
        shutil.copy(cls.asset, asset)
        cls.first = os.path.join(cls.models, HOSTILE)
        cls.second = os.path.join(cls.models, "second.spmrec")
        cls.browser = Browser()
        cls.addClassCleanup(cls.browser.close)
        touch = subprocess.Popen(
            [SERVO, "run", "--asset", asset, "--device", "sim", "--duration", "1.2", "--realtime", "off",
             "--black-box", "off", "--socket", "off", "--record", cls.first,
             "--stiffness", f"{STIFFNESS}N/m"],
            stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        cls.addClassCleanup(touch.stderr.close)
        assert any("serving" in line for line in touch.stderr)
        time.sleep(0.7)
        os.truncate(asset, 3000)  # the force goes off: asset_lost
        touch.stderr.read()
        assert touch.wait(PATIENCE) == 0
        shutil.copy(cls.asset, asset)
        other = run("replay", cls.first, "--method", "spm", "--stabilization", "none", "--record", cls.second,
                    "--quiet", program=SERVO)
        assert other.returncode == 10, other.stderr  # the forces differ
        cls.play(cls.first, cls.second)

    @classmethod
    def play(cls, *recordings):
        player = subprocess.Popen([SERVO, "view", "--recording", *recordings, "--json"],
                                  stdout=subprocess.PIPE, text=True)

        def end():
            player.terminate()
            player.wait(PATIENCE)
            player.stdout.close()
        cls.addClassCleanup(end)
        cls.browser.open(json.loads(player.stdout.readline())["url"])
        cls.browser.wait("window.spmPlayer && spmPlayer.ready")

    def tearDown(self):
        self.assertEqual(self.browser.errors(), [])

    def text(self, name):
        return self.browser.run("return document.getElementById(arguments[0]).textContent", name)

    def key(self, *values):
        self.browser.act(*[{"type": kind, "value": value} for value in values
                           for kind in ("keyDown", "keyUp")], kind="key")

    def slowly(self):
        """Plays ten times slower, so that a page that is short of time still sees the middle of it."""
        choose = "document.getElementById('speed').value = arguments[0]"
        self.browser.run(choose, "0.1")
        self.addCleanup(self.browser.run, choose, "1")

    def bytes_of(self, promise):
        """The bytes of a promise of a Blob."""
        script = ("const done = arguments[0]; Promise.resolve(" + promise + ").then((blob) => {"
                  "  const reader = new FileReader();"
                  "  reader.onload = () => done(reader.result.split(',')[1]);"
                  "  reader.readAsDataURL(blob); })")
        return base64.b64decode(self.browser.ask("POST", f"{self.browser.session}/execute/async",
                                                 {"script": script, "args": []}))

    def test_the_time_is_moved_by_keys_and_by_playing(self):
        self.browser.run("document.getElementById('scene').focus(); spmPlayer.line.go(0.3)")
        tick = self.browser.run("return spmPlayer.recordings[0].at(spmPlayer.line.time)")
        self.key(".", ".", ",")
        self.assertEqual(self.browser.run("return spmPlayer.recordings[0].at(spmPlayer.line.time)"), tick + 1)
        self.slowly()
        self.key(" ")
        self.browser.wait("spmPlayer.line.playing && spmPlayer.line.time > 0.4")
        self.key(" ")
        self.assertFalse(self.browser.run("return spmPlayer.line.playing"))
        self.key("\ue010")
        self.assertEqual(self.browser.run("return spmPlayer.line.time"),
                         self.browser.run("return spmPlayer.length"))
        self.browser.run("document.getElementById('time').focus()")
        self.key("\ue012")  # one tick back on the time line itself
        self.browser.wait("spmPlayer.line.time < spmPlayer.length")

    def test_force_and_place_are_those_of_the_tick(self):
        self.browser.run("const {columns, times} = spmPlayer.recordings[1];"
                         "spmPlayer.line.go(times[columns.depth.indexOf(Math.max(...columns.depth))])")
        told = self.browser.run(
            "const d = spmPlayer.frame.other, held = spmPlayer.stage.other.position.toArray();"
            "return {force: Math.hypot(...d.force), depth: d.depth, held, hand: d.position}")
        self.assertGreater(told["depth"], 0)
        self.assertAlmostEqual(told["force"] / (STIFFNESS * told["depth"]), 1, delta=0.001)
        apart = sum((one - other) ** 2 for one, other in zip(told["held"], told["hand"])) ** 0.5
        self.assertAlmostEqual(apart / told["depth"], 1, delta=0.01)
        self.assertIn(f"/ {told['force']:.3f} N", self.browser.run(
            "return document.querySelector('.chart h2 span:last-child').textContent"))

    def test_a_fault_is_marked_and_told_with_its_cure(self):
        self.browser.run("spmPlayer.line.go(0)")
        item = self.browser.run(
            "const item = [...document.querySelectorAll('#mark-list li')].find("
            "  (one) => one.textContent.includes('asset_lost')); item.querySelector('button').click();"
            "return item.textContent")
        self.assertIn("bake the asset again", item)
        self.assertIn("No force: asset_lost", self.text("held"))
        self.assertGreater(self.browser.run("return spmPlayer.line.time"), 0)
        self.assertIsNotNone(self.browser.run("return document.querySelector('#marks .off span')"))

    def test_the_difference_of_two_methods_is_told_and_drawn(self):
        self.assertRegex(self.text("difference"),
                         r"proxy.* and second\.spmrec \(spm.*differ by at most [\d.]+ N.*one path")
        titles = self.browser.run("return [...document.querySelectorAll('.chart h2')]"
                                  ".map((head) => head.textContent)")
        self.assertEqual(len(titles), 5)
        self.assertIn("Difference", titles[1])
        self.assertTrue(self.browser.run("return spmPlayer.stage.other.visible"))

    def test_a_click_in_a_chart_moves_the_time_and_a_drag_zooms_all(self):
        self.browser.run("document.querySelector('aside').scrollTop = 0")
        box = self.browser.run("const b = document.querySelector('.u-over').getBoundingClientRect();"
                               "return [b.left, b.top, b.width, b.height]")
        x, y = box[0], box[1] + box[3] / 2
        self.browser.press(x + box[2] / 2, y)
        self.browser.release()
        self.browser.wait("Math.abs(spmPlayer.line.time - spmPlayer.length / 2) < 0.1")
        self.browser.press(x + box[2] / 4, y)
        self.browser.move(x + box[2] / 2, y)
        self.browser.release()
        self.browser.wait("spmPlayer.charts.plots.every((p) => p.scales.x.max < 0.7 * spmPlayer.length)")
        self.browser.run("for (const p of spmPlayer.charts.plots)"
                         "  p.setScale('x', {min: 0, max: spmPlayer.length})")

    def test_pictures_and_a_film_are_saved(self):
        self.browser.run("spmPlayer.line.go(0.4)")
        self.assertTrue(self.bytes_of("spmPlayer.picture()").startswith(b"\x89PNG\r\n\x1a\n"))
        svg = xml.dom.minidom.parseString(self.browser.run("return spmPlayer.svg()"))
        self.assertEqual(svg.getElementsByTagName("img"), [])
        self.assertIn("<img", svg.getElementsByTagName("title")[0].firstChild.data)
        self.assertGreater(len(svg.getElementsByTagName("path")), 10)
        self.slowly()
        self.browser.run("document.getElementById('film').click()")
        self.browser.wait("spmPlayer.film && spmPlayer.line.time > 0.8")
        self.browser.run("document.getElementById('film').click()")
        self.browser.wait("spmPlayer.filmed")
        film = self.bytes_of("spmPlayer.filmed")
        self.assertTrue(film.startswith(b"\x1aE\xdf\xa3"))
        self.assertGreater(len(film), 2000)

    def test_hostile_names_of_recordings_stay_text(self):
        self.assertIn("<img", self.text("status"))
        self.assertIsNone(self.browser.run("return window.harmed ?? null"))
        self.assertEqual(self.browser.run("return document.querySelectorAll('img').length"), 0)

    def test_the_player_fits_wide_and_narrow_light_and_dark(self):
        self.addCleanup(self.browser.resize, 1280, 800)
        self.browser.run("spmPlayer.line.go(0.6)")
        for theme in ("dark", "light"):
            self.browser.run("if (document.documentElement.dataset.theme !== arguments[0])"
                             "document.getElementById('theme').click()", theme)
            for name, width, height in (("wide", 1280, 800), ("narrow", 390, 844)):
                self.browser.resize(width, height)
                self.browser.wait("!spmPlayer.stage.dirty")
                self.assertLessEqual(self.browser.run("return document.documentElement.scrollWidth"), width)
                os.makedirs(PICTURES, exist_ok=True)
                self.browser.screenshot(os.path.join(PICTURES, f"played-{name}-{theme}.png"))

    def test_each_device_of_a_recording_can_be_chosen(self):
        self.addCleanup(self.play, self.first, self.second)
        two = os.path.join(self.models, "two.spmrec")
        done = run("run", "--asset", self.touched, "--device", "sim", "--device", "sim:profile=falcon",
                   "--duration", "0.3", "--realtime", "off", "--black-box", "off", "--socket", "off",
                   "--record", two, "--quiet", program=SERVO)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.play(two)
        self.browser.run("const d = document.getElementById('device'); d.value = '1';"
                         "d.dispatchEvent(new Event('change'))")
        self.browser.wait("window.spmPlayer?.ready && spmPlayer.recordings[0].device === 1")
        self.assertFalse(self.browser.run("return document.getElementById('which').hidden"))

    def test_what_is_whole_of_a_truncated_recording_is_played_and_the_rest_told(self):
        self.addCleanup(self.play, self.first, self.second)
        self.addCleanup(shutil.copy, self.asset, self.touched)
        os.remove(self.touched)  # is told too, and the hand's path is seen
        cut = os.path.join(self.models, "cut.spmrec")
        shutil.copy(self.first, cut)
        os.truncate(cut, os.path.getsize(cut) // 2)
        self.play(cut)
        self.assertIn("was cut short", self.text("loss"))
        self.assertTrue(self.browser.run("return document.getElementById('compared').hidden"))
        self.assertIn("touched.spm.exr", self.text("loss"))
        self.assertTrue(self.browser.run("return spmPlayer.stage.framed"))
        length = self.browser.run("return spmPlayer.length")
        self.assertGreater(length, 0.3)
        self.assertLess(length, 0.9)


if __name__ == "__main__":
    unittest.main()
