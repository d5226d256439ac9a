# SPDX-License-Identifier: Apache-2.0
"""A headless Chromium, driven by the WebDriver protocol through Debian's chromedriver; no package
but the standard library."""

import base64
import json
import os
import shutil
import subprocess
import tempfile
import time
import urllib.error
import urllib.request

PATIENCE = 60.0  # s, beyond any machine's worst moment
# As on a machine without a graphics card: the processor draws WebGL and puts the page together.
SOFTWARE = ("--disable-gpu", "--enable-unsafe-swiftshader")


def is_there():
    return bool(shutil.which("chromium") and shutil.which("chromedriver"))


class Browser:
    """`width` and `height` in pixels of the window. `webgl` off: a browser that has none."""

    def __init__(self, width=1280, height=800, webgl=True):
        self.profile = tempfile.mkdtemp(prefix="spm-e2e-chromium-")
        self.driver = subprocess.Popen(["chromedriver", "--port=0"], stdout=subprocess.PIPE,
                                       stderr=subprocess.DEVNULL, text=True)
        self.base = self.session = None
        try:
            self.base = f"http://127.0.0.1:{self.find_port()}"
            arguments = ["--headless=new", "--disable-dev-shm-usage", "--no-first-run",
                         f"--user-data-dir={self.profile}", f"--window-size={width},{height}",
                         "--force-device-scale-factor=1",
                         *(SOFTWARE if webgl else ("--disable-3d-apis",)),
                         # Chromium's own sandbox refuses root.
                         *(["--no-sandbox"] if os.geteuid() == 0 else [])]
            wanted = {"browserName": "chrome", "goog:chromeOptions": {"args": arguments},
                      "goog:loggingPrefs": {"browser": "ALL"}}
            answer = self.ask("POST", "/session", {"capabilities": {"alwaysMatch": wanted}})
            self.session = f"/session/{answer['sessionId']}"
        except Exception:
            self.close()
            raise

    def find_port(self):
        for line in self.driver.stdout:
            if "started successfully on port" in line:
                return int(line.rstrip(". \n").rsplit(" ", 1)[1])
        raise RuntimeError("chromedriver did not say its port")

    def ask(self, method, path, body=None):
        data = None if body is None else json.dumps(body).encode()
        request = urllib.request.Request(self.base + path, data, method=method,
                                         headers={"Content-Type": "application/json"})
        try:
            with urllib.request.urlopen(request, timeout=PATIENCE) as answer:
                return json.load(answer)["value"]
        except urllib.error.HTTPError as error:
            raise RuntimeError(json.load(error)["value"]["message"]) from error

    def open(self, url):
        self.ask("POST", f"{self.session}/url", {"url": url})

    def run(self, script, *arguments):
        """The value of a script's `return`."""
        return self.ask("POST", f"{self.session}/execute/sync",
                        {"script": script, "args": list(arguments)})

    def wait(self, condition, *arguments):
        """Until an expression is true."""
        deadline = time.monotonic() + PATIENCE
        while time.monotonic() < deadline:
            # Its value may be an object that has no JSON.
            if self.run(f"return Boolean({condition})", *arguments):
                return
            time.sleep(0.05)
        raise TimeoutError(f"never true: {condition}; the page says: "
                           + self.run("return document.body.innerText")[:500])

    def act(self, *actions, kind="pointer"):
        """WebDriver's actions of one pointer, or of a wheel or the keys."""
        source = {"type": kind, "id": kind, "actions": list(actions)}
        if kind == "pointer":
            source["parameters"] = {"pointerType": "mouse"}
        self.ask("POST", f"{self.session}/actions", {"actions": [source]})

    def press(self, x, y):
        self.act({"type": "pointerMove", "x": round(x), "y": round(y), "duration": 0},
                 {"type": "pointerDown", "button": 0})

    def move(self, x, y, milliseconds=0):
        self.act({"type": "pointerMove", "x": round(x), "y": round(y), "duration": milliseconds})

    def release(self):
        self.act({"type": "pointerUp", "button": 0})

    def drag(self, places):
        """Presses at the first of some places, gives each as the pointer comes there, by an event of
        its own, and releases at the last."""
        x, y = places[0]
        self.press(x, y)
        try:
            yield x, y
            for x, y in places[1:]:
                self.move(x, y)
                yield x, y
        finally:
            self.release()

    def resize(self, width, height):
        """The page's own size: a window may not be as narrow as a phone."""
        self.ask("POST", f"{self.session}/goog/cdp/execute", {
            "cmd": "Emulation.setDeviceMetricsOverride",
            "params": {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 600}})

    def prefer(self, theme):
        """What the system is said to prefer: `light` or `dark`."""
        self.ask("POST", f"{self.session}/goog/cdp/execute", {
            "cmd": "Emulation.setEmulatedMedia",
            "params": {"features": [{"name": "prefers-color-scheme", "value": theme}]}})

    def errors(self):
        """Errors on the console since the last call."""
        return [entry["message"] for entry in self.ask("POST", f"{self.session}/se/log",
                                                       {"type": "browser"})
                if entry["level"] == "SEVERE"]

    def picture(self):
        """What is seen, as a PNG file's bytes."""
        return base64.b64decode(self.ask("GET", f"{self.session}/screenshot"))

    def screenshot(self, path):
        with open(path, "wb") as file:
            file.write(self.picture())

    def heap(self):
        """Bytes that scripts hold, after garbage was collected."""
        execute = f"{self.session}/goog/cdp/execute"
        self.ask("POST", execute, {"cmd": "HeapProfiler.collectGarbage", "params": {}})
        return self.ask("POST", execute, {"cmd": "Runtime.getHeapUsage", "params": {}})["usedSize"]

    def close(self):
        try:
            if self.session:
                self.ask("DELETE", self.session)
        finally:
            self.driver.terminate()
            self.driver.wait()
            self.driver.stdout.close()
            shutil.rmtree(self.profile, ignore_errors=True)
