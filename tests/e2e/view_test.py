#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The live view in a real browser, on the real daemon: headless Chromium leads the simulated hand."""

import base64
import http.client
import json
import os
import shutil
import subprocess
import tempfile
import time
import unittest
import urllib.parse
import xml.dom.minidom

from browser import Browser, is_there
from programs import BIN, SERVO, Case, generate, run

PAGE = os.path.join(BIN, os.pardir, "share", "spm-haptics", "view", "index.html")
PICTURES = os.path.join(BIN, os.pardir, "pictures")
PATIENCE = 60.0  # s
STIFFNESS = 400.0  # N/m
FORCE = "Math.hypot(...spmView.frame.devices[0].force)"
HOSTILE = "<img src=x onerror='window.harmed=1'>&amp;.spm.exr"
HOSTILE_RECORDING = "<img src=x onerror='window.harmed=1'>&amp;.spmrec"

WITHOUT = ("npm has not built the page: run scripts/build_page" if not os.path.exists(PAGE) else
           "chromium and chromedriver are not there: install chromium-driver" if not is_there() else "")


class Watched(Case):
    """A daemon with a hand that may be led, on an object whose name is hostile, a view of it, and two
    browsers, which all tests share: the second has no WebGL."""

    @classmethod
    def prepare(cls):
        """Once, for the whole file."""
        cls.folder = tempfile.mkdtemp(prefix="spm-e2e-view-")
        unittest.addModuleCleanup(shutil.rmtree, cls.folder, ignore_errors=True)
        generate(cls.folder, "box")
        cls.hostile = os.path.join(cls.folder, HOSTILE)
        baked = run("build", os.path.join(cls.folder, "box.obj"), "-o", cls.hostile, "--tolerance", "50um",
                    "--quiet")
        assert baked.returncode == 0, baked.stderr
        cls.environment = {**os.environ, "XDG_RUNTIME_DIR": cls.folder}
        cls.daemon = cls.start_daemon()
        unittest.addModuleCleanup(lambda: cls.end(cls.daemon))
        cls.view = cls.start("view", "--json", stdout=subprocess.PIPE, text=True)
        unittest.addModuleCleanup(cls.view.stdout.close)
        unittest.addModuleCleanup(cls.end, cls.view)
        cls.url = json.loads(cls.view.stdout.readline())["url"]
        cls.browser, cls.bare = Browser(), Browser(800, 700, webgl=False)
        unittest.addModuleCleanup(cls.browser.close)
        unittest.addModuleCleanup(cls.bare.close)
        for browser in (cls.browser, cls.bare):
            browser.open(cls.url)
        cls.browser.wait("window.spmView && spmView.stage && spmView.stage.framed")
        cls.bare.wait("window.spmView && spmView.frames > 20")

    @classmethod
    def start(cls, *words, **how):
        return subprocess.Popen([SERVO, *words], env=cls.environment, **how)

    @classmethod
    def start_daemon(cls, *more):
        return cls.start("run", "--asset", cls.hostile, "--device", "sim:hand=live", "--realtime",
                         "off", "--black-box", "off", "--stiffness", f"{STIFFNESS}N/m", "--quiet",
                         *more, stdout=subprocess.DEVNULL)

    @staticmethod
    def end(process):
        if process.poll() is None:
            process.terminate()
            process.wait(PATIENCE)

    def tearDown(self):
        self.assertEqual(self.browser.errors(), [])

    def device(self):
        return self.browser.run("const d = spmView.frame.devices[0];"
                                "return {force: Math.hypot(...d.force), depth: d.depth, hand: d.hand,"
                                "        contact: d.contact, cap: d.forceCap}")

    def on_object(self):
        """The place of the window where the object's middle is seen."""
        return self.browser.run("return spmView.stage.project(spmView.stage.middle)")

    def settled(self):
        """The device once its force rests."""
        seen = []
        deadline = time.monotonic() + PATIENCE
        while time.monotonic() < deadline:
            seen = [*seen[-3:], self.device()]
            forces = [state["force"] for state in seen]
            if len(seen) == 4 and seen[-1]["contact"] and max(forces) - min(forces) < 0.001:
                return seen[-1]
            time.sleep(0.06)
        return self.fail(f"the force never rests: {seen}")

    def picture(self, name):
        os.makedirs(PICTURES, exist_ok=True)
        self.browser.screenshot(os.path.join(PICTURES, f"view-{name}.png"))


def setUpModule():
    if WITHOUT:
        raise unittest.SkipTest(WITHOUT)
    Watched.prepare()


class Touch(Watched):
    def test_a_dragged_hand_feels_stiffness_times_depth(self):
        self.browser.press(*self.on_object())
        try:
            touched = self.settled()
            self.assertGreater(touched["force"], 0.1)
            self.assertAlmostEqual(touched["force"] / (STIFFNESS * touched["depth"]), 1, delta=0.05)
            self.assertEqual(self.browser.run("return spmView.frame.leads"), 1)
            self.picture("touch")
            x, y = self.on_object()
            self.browser.act({"type": "scroll", "x": round(x), "y": round(y), "deltaX": 0,
                              "deltaY": -400, "duration": 0}, kind="wheel")
            self.browser.wait(f"{FORCE} > {1.3 * touched['force']}")
        finally:
            self.browser.release()
        self.browser.wait(f"{FORCE} < 0.05")

    def test_the_keys_move_the_hand_and_escape_lets_it_go(self):
        self.browser.run("document.getElementById('scene').focus(); spmView.hand.letGo()")
        place = "spmView.frame.devices[0].position[0]"
        before = self.browser.run(f"return {place}")
        self.browser.act(*[{"type": kind, "value": "\ue014"} for _ in range(3)
                           for kind in ("keyDown", "keyUp")], kind="key")
        self.browser.wait("spmView.frame.leads === 1")
        self.browser.wait(f"Math.abs({place} - {before}) > 1e-4")
        self.browser.act({"type": "keyDown", "value": "\ue00c"}, {"type": "keyUp", "value": "\ue00c"},
                         kind="key")
        self.browser.wait("spmView.frame.devices[0].hand === 1")

    def test_the_canvas_shows_the_object_in_its_colours(self):
        colours = self.browser.run(
            "const s = spmView.stage; s.dirty = true; s.drawnAt = 0; s.draw();"
            "const gl = s.renderer.getContext(), seen = new Set(), one = new Uint8Array(4);"
            "for (let i = 1; i < 40; ++i) for (let k = 1; k < 40; ++k) {"
            "  gl.readPixels(i * gl.drawingBufferWidth / 40, k * gl.drawingBufferHeight / 40, 1, 1,"
            "                gl.RGBA, gl.UNSIGNED_BYTE, one); seen.add(one.join()); }"
            "return seen.size")
        self.assertGreaterEqual(colours, 4)

    def test_the_sliders_change_what_is_felt_and_the_scene_that_is_saved(self):
        self.slide_stiffness(447)
        self.addCleanup(self.slide_stiffness, 283)  # STIFFNESS, as far as a slider can
        self.browser.run(
            "const c = document.getElementById('slide-cap'); c.value = 400;"
            "c.dispatchEvent(new Event('input'))")
        self.browser.wait("Math.abs(spmView.scene.objects[0].stiffness - 1000) < 5")
        self.browser.wait("Math.abs(spmView.frame.devices[0].forceCap - 3.2) < 0.01")
        self.browser.wait("document.getElementById('margin').textContent.includes('of')")
        saved = self.browser.run("const r = new XMLHttpRequest(); r.open('GET', 'scene.toml', false);"
                                 "r.send(); return r.responseText")
        self.assertRegex(saved, r"stiffness = '?\"?99\d|stiffness = '?\"?100\d")
        path = os.path.join(self.folder, "saved.toml")
        with open(path, "w", encoding="utf-8") as file:
            file.write(saved)
        again = run("run", "--scene", path, "--device", "sim", "--duration", "0.1", "--realtime", "off",
                    "--socket", "off", "--black-box", "off", "--json", program=SERVO)
        self.assertEqual(again.returncode, 0, again.stderr)
        self.assertAlmostEqual(json.loads(again.stdout)["objects"][0]["stiffness"], 1000, delta=5)

    def slide_stiffness(self, place):
        self.browser.run("const s = document.getElementById('slide-stiffness');"
                         "s.value = arguments[0]; s.dispatchEvent(new Event('input'))", place)

    def test_hostile_names_stay_text(self):
        self.assertIn("<img", self.browser.run(
            "return document.getElementById('object').selectedOptions[0].textContent"))
        self.assertIsNone(self.browser.run("return window.harmed ?? null"))
        self.assertEqual(self.browser.run("return document.querySelectorAll('img').length"), 0)

    def test_a_second_page_watches_while_the_first_leads(self):
        self.browser.press(*self.on_object())
        try:
            self.browser.wait("spmView.frame.leads === 1")
            # The first page's pointer rests pressed, and its page must go on to say so.
            second = self.bare
            second.wait("spmView.frame.leads === 2")
            second.run("spmView.link.send({t: 'hand', device: 0, p: [0, 0, 0], q: [1, 0, 0, 0], n: 1})")
            second.wait("document.getElementById('refused').textContent.includes('watches')")
        finally:
            self.browser.release()

    def test_wide_and_narrow_light_and_dark(self):
        self.addCleanup(self.browser.resize, 1280, 800)
        for theme in ("light", "dark"):
            for name, width, height in (("wide", 1280, 800), ("narrow", 390, 844)):
                self.browser.resize(width, height)
                self.browser.run("if (document.documentElement.dataset.theme !== arguments[0])"
                                 "document.getElementById('theme').click(); spmView.stage.frame()", theme)
                self.browser.press(*self.on_object())
                self.browser.wait(f"{FORCE} > 0.1")
                self.settled()
                self.assertLessEqual(self.browser.run("return document.documentElement.scrollWidth"), width)
                self.picture(f"{name}-{theme}")
                self.browser.release()
        self.browser.wait("spmView.frame.devices[0].hand === 1")


class Away(Watched):
    def test_a_daemon_that_is_killed_and_started_again_is_seen_again(self):
        Watched.daemon.kill()
        Watched.daemon.wait()
        try:
            # First that it hung up, then that none answers.
            self.browser.wait("/hung up|no daemon/.test(document.getElementById('status').textContent)")
        finally:
            Watched.daemon = self.start_daemon()
        self.browser.wait("document.getElementById('status').textContent === 'running'")
        self.browser.press(*self.on_object())
        self.browser.wait(f"{FORCE} > 0.1")
        self.browser.release()

    def test_without_webgl_a_sentence_and_the_charts_go_on(self):
        bare = self.bare
        self.assertIn("no WebGL", bare.run("return document.getElementById('noscene').textContent"))
        self.assertEqual(bare.run("return document.querySelectorAll('#charts canvas').length"), 4)
        frames = bare.run("return spmView.frames")
        bare.wait(f"spmView.frames > {frames} + 20")


class Played(Watched):
    """A recording with a fault, whose name is hostile, beside another method on the same path; and what is
    left of it when it is cut short. In the browser of the others."""

    @classmethod
    def setUpClass(cls):
        cls.asset = asset = os.path.join(cls.folder, "cut.spm.exr")
        shutil.copy(cls.hostile, asset)
        cls.first = os.path.join(cls.folder, HOSTILE_RECORDING)
        cls.second = os.path.join(cls.folder, "second.spmrec")
        touch = cls.start("run", "--asset", asset, "--device", "sim", "--duration", "1.2", "--realtime",
                          "off", "--black-box", "off", "--socket", "off", "--record", cls.first,
                          "--stiffness", f"{STIFFNESS}N/m", stdout=subprocess.DEVNULL,
                          stderr=subprocess.PIPE, text=True)
        cls.addClassCleanup(touch.stderr.close)
        assert any("serving" in line for line in touch.stderr)
        time.sleep(0.7)
        os.truncate(asset, 3000)  # the force goes off: asset_lost
        touch.stderr.read()
        assert touch.wait(PATIENCE) == 0
        shutil.copy(cls.hostile, asset)
        other = run("replay", cls.first, "--method", "spm", "--stabilization", "none", "--record", cls.second,
                    "--quiet", program=SERVO)
        assert other.returncode == 10, other.stderr  # the forces differ
        cls.play(cls.first, cls.second)

    @classmethod
    def play(cls, *recordings):
        player = cls.start("view", "--recording", *recordings, "--json", stdout=subprocess.PIPE, text=True)
        cls.addClassCleanup(player.stdout.close)
        cls.addClassCleanup(cls.end, player)
        cls.browser.open(json.loads(player.stdout.readline())["url"])
        cls.browser.wait("window.spmPlayer && spmPlayer.ready")

    @classmethod
    def tearDownClass(cls):
        cls.browser.open(cls.url)
        cls.browser.wait("window.spmView && spmView.stage && spmView.stage.framed")

    def text(self, name):
        return self.browser.run("return document.getElementById(arguments[0]).textContent", name)

    def key(self, *values):
        self.browser.act(*[{"type": kind, "value": value} for value in values
                           for kind in ("keyDown", "keyUp")], kind="key")

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
                self.picture(f"played-{name}-{theme}")

    def test_what_is_whole_of_a_truncated_recording_is_played_and_the_rest_told(self):
        self.addCleanup(self.play, self.first, self.second)
        self.addCleanup(shutil.copy, self.hostile, self.asset)
        os.remove(self.asset)  # is told too, and the hand's path is seen
        cut = os.path.join(self.folder, "cut.spmrec")
        shutil.copy(self.first, cut)
        os.truncate(cut, os.path.getsize(cut) // 2)
        self.play(cut)
        self.assertIn("was cut short", self.text("loss"))
        self.assertTrue(self.browser.run("return document.getElementById('compared').hidden"))
        self.assertIn("cut.spm.exr", self.text("loss"))
        self.assertTrue(self.browser.run("return spmPlayer.stage.framed"))
        length = self.browser.run("return spmPlayer.length")
        self.assertGreater(length, 0.3)
        self.assertLess(length, 0.9)


class Access(Watched):
    def get(self, path, **headers):
        address = urllib.parse.urlsplit(self.url)
        connection = http.client.HTTPConnection(address.hostname, address.port, timeout=PATIENCE)
        self.addCleanup(connection.close)
        connection.putrequest("GET", path, skip_host="Host" in headers)
        for name, value in headers.items():
            connection.putheader(name.replace("_", "-"), value)
        connection.endheaders()
        answer = connection.getresponse()
        answer.text = answer.read().decode("utf-8", "replace")
        return answer

    def test_a_request_without_the_token_by_another_name_or_from_another_page_is_refused(self):
        address = urllib.parse.urlsplit(self.url)
        page, host = address.path, address.netloc
        self.assertEqual(self.get(page).status, 200)
        for path in ("/", "/view.js", "/0123456789abcdef0123456789abcdef/", "/../etc/passwd"):
            with self.subTest(path=path):
                answer = self.get(path)
                self.assertEqual(answer.status, 403)
                self.assertIn("token", answer.text)
        self.assertEqual(self.get(page, Host="example.org").status, 403)
        self.assertEqual(self.get(page + "../../etc/passwd").status, 404)
        upgrade = {"Connection": "Upgrade", "Upgrade": "websocket", "Sec_WebSocket_Version": "13",
                   "Sec_WebSocket_Key": "dGhlIHNhbXBsZSBub25jZQ=="}
        for origin in ("http://example.org", f"https://{host}", "null"):
            with self.subTest(origin=origin):
                self.assertEqual(self.get(page + "ws", Origin=origin, **upgrade).status, 403)
        self.assertEqual(self.get(page + "ws", **upgrade).status, 403)
        self.assertEqual(self.get(page + "ws", Origin=f"http://{host}", **upgrade).status, 101)

    def test_the_page_may_reach_nothing_else(self):
        policy = self.get(urllib.parse.urlsplit(self.url).path).getheader("Content-Security-Policy")
        self.assertIn("default-src 'none'", policy)
        self.assertEqual(self.browser.run(
            "return fetch('http://127.0.0.1:9/').then(() => 'reached', () => 'kept')"), "kept")
        self.browser.errors()  # what the browser says of it


if __name__ == "__main__":
    unittest.main()
