# SPDX-License-Identifier: Apache-2.0
"""What the tests of the live view share: a daemon, a view of it and headless Chromium on its page."""

import contextlib
import json
import os
import shutil
import subprocess
import tempfile
import time
import unittest

from browser import Browser, is_there
from programs import BIN, SERVO, Case, generate, run

PAGE = os.path.join(BIN, os.pardir, "share", "spm-haptics", "view", "index.html")
PICTURES = os.path.join(BIN, os.pardir, "pictures")
PATIENCE = 60.0  # s
STIFFNESS = 400.0  # N/m
FORCE = "Math.hypot(...spmView.frame.devices[0].force)"
HOSTILE = "<img src=x onerror='window.harmed=1'>&amp;.spm.exr"

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
        """`there`: the hand is led, and has no place left to go through first."""
        return self.browser.run("const {hand, frame} = spmView, d = frame.devices[0];"
                                "return {force: Math.hypot(...d.force), depth: d.depth, hand: d.hand,"
                                "        contact: d.contact, cap: d.forceCap,"
                                "        there: frame.leads === 1 && !hand.round.length}")

    def on_object(self):
        """The place of the window where the object's middle is seen."""
        return self.browser.run("return spmView.stage.project(spmView.stage.middle)")

    @contextlib.contextmanager
    def pressed(self):
        """The pointer, down where the object's middle is seen."""
        self.browser.press(*self.on_object())
        try:
            yield
        finally:
            self.browser.release()

    def settled(self):
        """The device once its force rests."""
        seen = []
        deadline = time.monotonic() + PATIENCE
        while time.monotonic() < deadline:
            seen = [*seen[-3:], self.device()]
            forces = [state["force"] for state in seen]
            touching = len(seen) == 4 and all(state["there"] and state["contact"] for state in seen)
            if touching and max(forces) - min(forces) < 0.001:
                return seen[-1]
            time.sleep(0.06)
        page = self.browser.run(
            "const {hand, stage, frame} = spmView, place = (v) => v && v.toArray();"
            "return {leads: frame.leads, pointer: hand.pointer ?? null, target: place(hand.target),"
            "        round: hand.round.map(place), seen: place(stage.hand.position),"
            "        position: [...frame.devices[0].position], sent: hand.number, heard: frame.echo,"
            "        message: document.body.innerText.slice(0, 300)}")
        return self.fail(f"the force never rests: {seen}; the page: {page}")

    def slide_stiffness(self, place):
        self.browser.run("const s = document.getElementById('slide-stiffness');"
                         "s.value = arguments[0]; s.dispatchEvent(new Event('input'))", place)

    def picture(self, name):
        os.makedirs(PICTURES, exist_ok=True)
        self.browser.screenshot(os.path.join(PICTURES, f"view-{name}.png"))


def prepare():
    """For a file of tests."""
    if WITHOUT:
        raise unittest.SkipTest(WITHOUT)
    Watched.prepare()


class Other(Case):
    """A daemon, a view and a browser for one test."""

    def watched(self, scene):
        """A browser on the page of a daemon that serves a scene of boxes, box.spm.exr and tool.spm.exr."""
        for name in ("box", "tool"):
            shutil.copy(Watched.hostile, self.path(f"{name}.spm.exr"))
        environment = {**os.environ, "XDG_RUNTIME_DIR": self.folder}
        processes = []
        for words in (["run", "--scene", self.write("scene.toml", scene), "--device", "sim:hand=live",
                       "--realtime", "off", "--black-box", "off", "--quiet"], ["view", "--json"]):
            process = subprocess.Popen([SERVO, *words], env=environment, stdout=subprocess.PIPE, text=True)
            self.addCleanup(process.stdout.close)
            self.addCleanup(Watched.end, process)
            processes.append(process)
        self.daemon = processes[0]
        browser = Browser()
        self.addCleanup(browser.close)
        browser.open(json.loads(process.stdout.readline())["url"])
        return browser
