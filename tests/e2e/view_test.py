#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The live view in a real browser, on the real daemon: headless Chromium leads the simulated hand."""

import http.client
import json
import os
import time
import unittest
import urllib.parse

from programs import SERVO, run
from watched_view import FORCE, PATIENCE, STIFFNESS, Watched, prepare


def setUpModule():
    prepare()


class Touch(Watched):
    def test_a_dragged_hand_feels_stiffness_times_depth(self):
        with self.pressed():
            touched = self.settled()
            self.assertGreater(touched["force"], 0.1)
            self.assertAlmostEqual(touched["force"] / (STIFFNESS * touched["depth"]), 1, delta=0.05)
            self.assertEqual(self.browser.run("return spmView.frame.leads"), 1)
            self.picture("touch")
            x, y = self.on_object()
            self.browser.act({"type": "scroll", "x": round(x), "y": round(y), "deltaX": 0,
                              "deltaY": -400, "duration": 0}, kind="wheel")
            self.browser.wait(f"{FORCE} > {1.3 * touched['force']}")
        self.browser.wait(f"{FORCE} < 0.05")

    def test_a_hand_goes_round_an_object_that_hides_the_place_that_is_pressed(self):
        turn = ("const s = spmView.stage, t = s.controls.target; s.camera.position.sub(t).applyAxisAngle("
                "s.camera.up, Math.PI).add(t); s.controls.update(); s.camera.updateMatrixWorld()")
        self.addCleanup(self.browser.run, turn)
        with self.pressed():
            self.settled()
        self.browser.wait("spmView.frame.devices[0].hand === 1")
        self.browser.run(turn)
        with self.pressed():
            touched = self.settled()
            self.assertLess(touched["depth"], 0.005)
            self.assertTrue(self.browser.run(
                "const f = spmView.frame.devices[0].force, s = spmView.stage;"
                "const w = s.camera.position.clone().sub(s.middle);"
                "return f[0] * w.x + f[1] * w.y + f[2] * w.z > 0"))
        self.browser.wait("spmView.frame.devices[0].hand === 1")

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

    def test_a_gamepad_moves_the_hand_and_six_axes_turn_it(self):
        self.addCleanup(self.browser.run, "delete navigator.getGamepads; spmView.hand.letGo();"
                                          "spmView.hand.turn.identity()")
        self.browser.run("spmView.hand.letGo(); window.pad = [1, 0, 0, 0];"
                         "navigator.getGamepads = () => [null, { axes: window.pad }]")
        self.browser.wait("spmView.frame.leads === 1")
        far = "spmView.hand.target.distanceTo(spmView.stage.middle) > spmView.stage.size"
        self.browser.wait(far)  # it goes on as long as the stick is held
        self.browser.run("window.pad = [0, 0, 0, 0, 0, 1]")
        self.browser.wait("spmView.hand.turn.w < 0.99")
        # A stick at rest is never quite at 0. The page looks at it once a frame.
        self.browser.run("window.pad = [0.1, 0, 0, 0]; window.drawn = 0; (function next() {"
                         "if (++window.drawn < 3) requestAnimationFrame(next) })()")
        self.browser.wait("window.drawn === 3")
        rests = self.browser.run("return spmView.hand.target.toArray()")
        time.sleep(0.2)
        self.assertEqual(self.browser.run("return spmView.hand.target.toArray()"), rests)

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

    def test_method_and_stabilization_are_chosen_on_the_page(self):
        def choose(method):
            self.browser.run("const m = document.getElementById('method'); m.value = arguments[0];"
                             "m.dispatchEvent(new Event('change'))", method)

        self.assertEqual(self.browser.run("return document.getElementById('method').value"), "2")
        self.addCleanup(choose, "2")
        choose("0")
        self.browser.wait("spmView.scene.objects[0].method === 'spm'")
        choose("1")  # the asset is sparse
        self.browser.wait("document.getElementById('refused').textContent.includes('full asset')")
        self.assertEqual(self.browser.run("return document.getElementById('method').value"), "0")
        for stabilized, word in (("false", "without"), ("true", "with")):
            self.browser.run("document.getElementById('stabilized').click()")
            self.browser.wait(f"spmView.scene.objects[0].stabilized === {stabilized}")
            self.browser.wait(f"document.getElementById('margin').textContent.includes('{word} stab')")

    def test_hostile_names_stay_text(self):
        self.assertIn("<img", self.browser.run(
            "return document.getElementById('object').selectedOptions[0].textContent"))
        self.assertIsNone(self.browser.run("return window.harmed ?? null"))
        self.assertEqual(self.browser.run("return document.querySelectorAll('img').length"), 0)

    def test_a_second_page_watches_while_the_first_leads(self):
        with self.pressed():
            self.browser.wait("spmView.frame.leads === 1")
            # The first page's pointer rests pressed, and its page must go on to say so.
            second = self.bare
            second.wait("spmView.frame.leads === 2")
            second.run("spmView.link.send({t: 'hand', device: 0, p: [0, 0, 0], q: [1, 0, 0, 0], n: 1})")
            second.wait("document.getElementById('refused').textContent.includes('watches')")

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
            self.browser.wait("document.getElementById('status').textContent === 'gone'")
            # First that it hung up, then that none answers.
            self.browser.wait("/hung up|no daemon/.test(document.getElementById('held').textContent)")
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
