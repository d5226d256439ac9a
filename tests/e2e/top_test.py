#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""`top` beside a real daemon, and `plot` of what it recorded."""

import json
import os
import pty
import select
import shutil
import signal
import stat
import subprocess
import termios
import time
import unittest

from programs import SERVO, Case, bake_box, run

PATIENCE = 120.0  # s, beyond any machine's worst moment
BEGIN_SCREEN, END_SCREEN = b"\x1b[?1049h\x1b[?25l", b"\x1b[?25h\x1b[?1049l"
PERCENTILES = {"p50", "p99", "max"}


def can_draw():
    return any(subprocess.run([python, "-c", "import matplotlib, numpy"], capture_output=True,
                              check=False).returncode == 0
               for python in ("python3", "/usr/bin/python3") if shutil.which(python))


class WithAsset(Case):
    @classmethod
    def setUpClass(cls):
        bake_box(cls, "--tolerance", "50um")

    def command(self, *options):
        return [SERVO, "run", "--device", "sim", "--realtime", "off", "--black-box", "off",
                *options]

    def eventually(self, so):
        deadline = time.monotonic() + PATIENCE
        while time.monotonic() < deadline:
            found = so()
            if found:
                return found
            time.sleep(0.05)
        return self.fail("it did not come to be in time")


class Screen:
    """`top` on a terminal of its own."""

    def __init__(self, case, *options):
        self.ours, self.theirs = pty.openpty()
        case.addCleanup(os.close, self.ours)
        case.addCleanup(os.close, self.theirs)
        self.before = self.settings()
        self.shown = b""
        self.process = subprocess.Popen([SERVO, "top", *options], stdin=self.theirs,
                                        stdout=self.theirs, stderr=self.theirs,
                                        start_new_session=True)
        case.addCleanup(self.end)

    def end(self):
        if self.process.poll() is None:
            self.process.kill()
            self.process.wait()

    def settings(self):
        return termios.tcgetattr(self.theirs)

    def read_on(self):
        while select.select([self.ours], [], [], 0.05)[0]:
            self.shown += os.read(self.ours, 65536)
        return self.shown

    def press(self, key):
        os.write(self.ours, key)

    def ended(self):
        """Whether it has, with all that it showed read."""
        has_ended = self.process.poll() is not None
        self.read_on()
        return has_ended


class Top(WithAsset):
    def setUp(self):
        super().setUp()
        self.socket = self.path("a.sock")
        self.copy = shutil.copy(self.asset, self.path("box.spm.exr"))
        self.daemon = subprocess.Popen(
            self.command("--asset", self.copy, "--socket", self.socket), text=True,
            stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
        self.addCleanup(self.end_daemon)
        # The file is there before somebody listens at it.
        self.eventually(lambda: self.top("--once", "--quiet").returncode == 0)

    def end_daemon(self):
        if self.daemon.poll() is None:
            self.daemon.kill()
        self.daemon.wait()
        self.daemon.stderr.close()

    def top(self, *options):
        return run("top", "--socket", self.socket, *options, program=SERVO)

    def seen(self, *options):
        return self.run_json("top", "--socket", self.socket, "--once", *options, program=SERVO)

    def running(self):
        """What is seen once the loop has run for all of the time that was looked at."""
        def found():
            seen = self.seen()
            return seen if seen["daemon"] == "running" and seen["rate_hz"] > 0 else None
        return self.eventually(found)

    def test_it_tells_of_the_loop_its_device_and_its_applications(self):
        first = self.running()
        self.assertEqual(first["process"], self.daemon.pid)
        self.assertEqual(first["wanted_rate_hz"], 1000)
        self.assertGreater(first["seconds"], 0)
        for name in ("wake_us", "busy_us"):
            self.assertEqual(set(first[name]), PERCENTILES)
            self.assertLessEqual(first[name]["p50"], first[name]["p99"])
            self.assertLessEqual(first[name]["p99"], first[name]["max"])
            self.assertGreater(first[name]["max"], 0)
        self.assertGreater(first["busy_share"], 0)
        self.assertLess(first["busy_share"], 1)
        for name in ("missed", "skipped"):
            self.assertLessEqual(first[name]["recent"], first[name]["total"])
        self.assertLessEqual(first["skipped"]["total"], first["missed"]["total"])
        self.assertEqual([device["name"] for device in first["devices"]], ["sim"])
        self.assertIs(first["devices"][0]["connected"], True)
        # It takes none of the places that applications have.
        self.assertEqual([(application["name"], application["role"])
                          for application in first["applications"]], [("spm-servo top", "observer")])
        self.assertEqual(first["commands"], {"taken": 0, "refused": 0, "garbage": 0})
        later = self.seen()
        self.assertGreater(later["ticks"], first["ticks"])

        # The simulated hand slides over the surface.
        def touching():
            device = self.seen()["devices"][0]
            return device if device["contact"] else None
        device = self.eventually(touching)
        self.assertGreater(device["contacts"], 0)
        self.assertGreater(device["force_n"]["max"], 0)
        self.assertGreaterEqual(device["force_n"]["max"], device["force_n"]["now"])
        self.assertIsNone(device["force_off"])

    def test_a_cause_of_zero_force_comes_with_its_cure(self):
        self.running()
        os.truncate(self.copy, 100)  # one that is gone, or exchanged, is served on

        def lost():
            device = self.seen()["devices"][0]
            return device if device["force_off"] else None
        device = self.eventually(lost)
        self.assertEqual(device["force_off"]["cause"], "asset_lost")
        self.assertIn("put the file back", device["force_off"]["cure"])
        self.assertEqual(device["force_n"]["now"], 0)
        self.assertEqual(device["cuts"]["total"], 1)
        self.assertIn("NO FORCE, asset_lost: ", self.top().stdout)

    def test_where_the_output_is_no_terminal_it_prints_one_screen(self):
        self.running()
        result = self.top()
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        self.assertNotIn("\x1b", result.stdout)
        lines = result.stdout.splitlines()
        self.assertRegex(lines[0],
                         rf"^spm-servo \d+\.\d+\.\d+, process {self.daemon.pid}: running$")
        for beginning in ("rate ", "late ", "busy ", "missed ", "device ", "sim ",
                          "1 application: "):
            self.assertTrue(any(line.startswith(beginning) for line in lines), beginning)

    def test_on_a_terminal_it_draws_until_a_key_ends_it_and_leaves_the_terminal_as_it_was(self):
        self.running()
        for end in (b"q", b"\x03"):
            with self.subTest(key=end):
                screen = Screen(self, "--socket", self.socket)
                self.eventually(lambda: screen.read_on().count(b"device ") >= 3)
                # Another client sees it among the applications.
                names = [application["name"] for application in self.seen()["applications"]]
                self.assertEqual(names, ["spm-servo top"] * 2)
                screen.press(end)
                self.eventually(screen.ended)
                self.assertEqual(screen.process.returncode, 0)
                self.assertTrue(screen.shown.startswith(BEGIN_SCREEN), screen.shown[:40])
                self.assertTrue(screen.shown.endswith(END_SCREEN), screen.shown[-40:])
                self.assertEqual(screen.settings(), screen.before)

    def test_a_daemon_that_is_killed_while_it_is_watched_is_told(self):
        self.running()
        screen = Screen(self, "--socket", self.socket)
        self.eventually(lambda: screen.read_on().count(b"device ") >= 3)
        self.daemon.send_signal(signal.SIGKILL)
        self.eventually(screen.ended)
        self.assertEqual(screen.process.returncode, 2)
        after = screen.shown[screen.shown.index(END_SCREEN):]
        self.assertIn(b"GONE", after)
        self.assertIn(b"it crashed or was killed", after)
        self.assertEqual(screen.settings(), screen.before)

    def test_a_daemon_that_ends_while_it_is_watched_ends_it(self):
        self.running()
        screen = Screen(self, "--socket", self.socket)
        self.eventually(lambda: screen.read_on().count(b"device ") >= 3)
        self.daemon.send_signal(signal.SIGTERM)
        self.eventually(screen.ended)
        self.assertEqual(screen.process.returncode, 0)
        self.assertIn(b"it has ended", screen.shown[screen.shown.index(END_SCREEN):])

    def test_without_a_daemon_it_says_so(self):
        self.daemon.send_signal(signal.SIGTERM)
        self.assertEqual(self.daemon.wait(timeout=PATIENCE), 0)
        for options in ((), ("--once",), ("--json",)):
            self.expect_refusal(self.top(*options), 2, "spm-servo run", self.socket)


class Plot(WithAsset):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.recording = os.path.join(cls.models, "a.spmrec")
        result = run("run", "--device", "sim", "--realtime", "off", "--black-box", "off",
                     "--socket", "off", "--asset", cls.asset, "--duration", "0.3", "--record",
                     cls.recording, "--quiet", program=SERVO)
        assert result.returncode == 0, result.stderr

    def setUp(self):
        super().setUp()
        self.mine = shutil.copy(self.recording, self.path("a.spmrec"))

    def plot(self, *arguments, environment=None):
        return subprocess.run([SERVO, "plot", *arguments], capture_output=True, text=True,
                              timeout=300, check=False,
                              env={**os.environ, "LC_ALL": "C.UTF-8", **(environment or {})})

    @unittest.skipUnless(can_draw(), "there is no matplotlib")
    def test_it_draws_what_is_asked_for_and_leaves_nothing_else(self):
        for name, beginning in (("b.svg", b"<?xml"), ("b.png", b"\x89PNG\r\n")):
            with self.subTest(name):
                before = set(os.listdir(self.folder))
                result = self.plot(self.mine, self.path(name))
                self.assertEqual((result.returncode, result.stderr), (0, ""))
                self.assertIn(self.path(name), result.stdout)
                self.assertEqual(set(os.listdir(self.folder)) - before, {name})
                with open(self.path(name), "rb") as file:
                    self.assertTrue(file.read(8).startswith(beginning))

    @unittest.skipUnless(can_draw(), "there is no matplotlib")
    def test_without_a_name_the_drawing_is_beside_the_recording(self):
        result = self.plot(self.mine, "--json")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(json.loads(result.stdout),
                         {"recording": self.mine, "out": self.path("a.svg")})
        self.assertTrue(os.path.exists(self.path("a.svg")))

    def stub(self, code):
        """A folder with a python3 that only ends."""
        folder = self.output_folder("stub")
        path = self.write(os.path.join("stub", "python3"), f"#!/bin/sh\nexit {code}\n")
        os.chmod(path, os.stat(path).st_mode | stat.S_IXUSR)
        return {"PATH": folder}

    @unittest.skipUnless(os.path.exists("/usr/bin/python3") and can_draw(), "no python3 that draws")
    def test_a_python_without_matplotlib_is_not_taken(self):
        if subprocess.run(["/usr/bin/python3", "-c", "import matplotlib"], capture_output=True,
                          check=False).returncode != 0:
            self.skipTest("the system's python3 has no matplotlib")
        result = self.plot(self.mine, self.path("b.svg"), environment=self.stub(1))
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertTrue(os.path.exists(self.path("b.svg")))

    def test_the_exit_code_of_what_draws_is_passed_on_and_nothing_is_written(self):
        folder = self.output_folder("stub")
        # Has what is asked for, and fails when it is to draw.
        path = self.write(os.path.join("stub", "python3"),
                          '#!/bin/sh\ntest "$1" = -c && exit 0\necho "no ink" >&2\nexit 7\n')
        os.chmod(path, 0o755)
        before = set(os.listdir(self.folder))
        result = self.plot(self.mine, self.path("b.svg"),
                           environment={"PATH": folder + os.pathsep + os.environ["PATH"]})
        self.assertEqual((result.returncode, result.stderr), (7, "no ink\n"))
        self.assertEqual(set(os.listdir(self.folder)), before)

    def test_what_cannot_be_drawn_is_refused_and_writes_nothing(self):
        text = self.write("a.txt", "no recording")
        os.makedirs(self.path("folder.svg"))
        before = set(os.listdir(self.folder))
        for arguments, code, names in (
                ((self.path("missing.spmrec"),), 2, ("missing.spmrec",)),
                ((text,), 3, ("a.txt", "no recording")),
                ((self.mine, self.path("b.pdf")), 1, (".svg or .png",)),
                ((self.mine, self.path("b")), 1, (".svg or .png",)),
                ((self.mine, self.path("nowhere", "b.svg")), 2, ("nowhere",)),
                ((self.mine, self.path("folder.svg")), 2, ("folder.svg",)),
                ((self.mine, "--device-number", "1"), 1, ("--device-number", "of 1 device"))):
            with self.subTest(arguments):
                self.expect_refusal(self.plot(*arguments), code, *names)
                self.assertEqual(set(os.listdir(self.folder)), before)


if __name__ == "__main__":
    unittest.main()
