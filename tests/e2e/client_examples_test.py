#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The examples in C, Python and C#, all at once beside one real daemon."""

import glob
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time
import unittest

from programs import BIN, SERVO, Case, generate, run

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), os.pardir, os.pardir)
EXAMPLES = os.path.join(ROOT, "servo", "client", "examples")
C_SHARP = os.path.join(ROOT, "servo", "client", "csharp")
LIBRARY = os.environ.get("SPM_CLIENT_LIBRARY",
                         os.path.join(os.path.dirname(BIN), "lib", "libspm_client.so"))
PATIENCE = 120.0  # s, beyond any machine's worst moment
BOX = '[[object]]\nasset = "box.spm.exr"\nmovable = true\n'


class ClientExamples(Case):
    def setUp(self):
        super().setUp()
        generate(self.folder, "box")
        baked = run("build", self.path("box.obj"), "-o", self.path("box.spm.exr"), "--tolerance",
                    "50um", "--quiet")
        self.assertEqual(baked.returncode, 0, baked.stderr)
        self.socket = self.path("a.sock")
        self.scene = self.write("scene.toml", f"{BOX}\n{BOX}pose = [0.2, 0, 0]\n")
        self.daemon = subprocess.Popen(
            [SERVO, "run", "--scene", self.scene, "--device", "sim", "--realtime", "off", "--black-box",
             "off", "--socket", self.socket, "--record", self.path("run.spmrec"), "--json"],
            text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        self.addCleanup(self.daemon.communicate)
        self.addCleanup(self.daemon.kill)
        self.await_ticks()
        self.environment = {**os.environ, "LC_ALL": "C.UTF-8", "SPM_CLIENT_LIBRARY": LIBRARY,
                            "LD_LIBRARY_PATH": os.path.dirname(LIBRARY)}

    def await_ticks(self):
        """Until the loop has given force: a client may connect before the first tick."""
        deadline = time.monotonic() + PATIENCE
        while time.monotonic() < deadline:
            shown = run("top", "--once", "--socket", self.socket, program=SERVO)
            if shown.returncode == 0 and ": running" in shown.stdout:
                return
            time.sleep(0.05)
        self.fail("the daemon did not begin in time")

    def commands(self):
        """Each example by its language; the object that it moves is its own."""
        c_sharp = self.path("ReadState.exe")
        yield "C", [os.path.join(BIN, "spm_client_example"), self.socket, "20"]
        yield "Python", [sys.executable, os.path.join(EXAMPLES, "move_object.py"), self.socket, "2"]
        if not (shutil.which("mcs") and shutil.which("mono")):
            return
        subprocess.run(["mcs", f"-out:{c_sharp}", *glob.glob(os.path.join(C_SHARP, "*.cs")),
                        os.path.join(EXAMPLES, "ReadState.cs")], check=True, capture_output=True)
        yield "C#", ["mono", c_sharp, self.socket, "20", "1"]

    def run_at_once(self):
        """What each of them printed."""
        running = {language: subprocess.Popen(command, text=True, env=self.environment,
                                              stdout=subprocess.PIPE, stderr=subprocess.PIPE)
                   for language, command in list(self.commands())}
        shown = {}
        for language, process in running.items():
            shown[language], errors = process.communicate(timeout=PATIENCE)
            self.assertEqual((process.returncode, errors), (0, ""), language)
            print(f"--- {language}\n{shown[language]}", end="", flush=True)
        return shown

    def expect_replay_up_to_the_first_move(self):
        """What an application moved is in the recording, but not in the scene's file."""
        result = run("replay", self.path("run.spmrec"), "--json", program=SERVO)
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        whole = json.loads(result.stdout)["recording"]
        self.assertIs(whole["forces_equal"], True)
        result = run("replay", self.path("run.spmrec"), "--scene", self.scene, "--out",
                     self.path("out.csv"), "--json", program=SERVO)
        self.assertEqual(result.returncode, 0, result.stderr)
        recording = json.loads(result.stdout)["recording"]
        self.assertEqual(recording["scene_changed"]["by"], "application")
        self.assertGreater(recording["compared_ticks"], 0)
        self.assertLess(recording["compared_ticks"], whole["compared_ticks"])
        self.assertIs(recording["forces_equal"], True)
        self.assertIn(f"from tick {recording['scene_changed']['tick']} of the recording on objects "
                      "were moved, added or changed by an application", result.stderr)

    def test_all_of_them_run_beside_one_daemon_which_follows_each(self):
        shown = self.run_at_once()
        self.assertEqual(len(re.findall(r"^tick \d+: at .* mm, force .* N", shown["C"], re.M)), 20)
        self.assertIn(", in contact", shown["C"])
        self.assertGreater(len(set(re.findall(r"object at (\S+) mm", shown["Python"]))), 10)
        if "C#" in shown:
            ticks = re.findall(r"^tick (\d+): sim at .* mm, force .* N", shown["C#"], re.M)
            self.assertEqual((len(ticks), ticks), (20, sorted(ticks, key=int)))
            counted = re.search(r"^loop: (\d+) ticks, ", shown["C#"], re.M)
            self.assertGreaterEqual(int(counted[1]), int(ticks[-1]) - int(ticks[0]))
            self.assertIn("connected: ReadState example ", shown["C#"])
        self.daemon.send_signal(signal.SIGTERM)
        report, _ = self.daemon.communicate(timeout=PATIENCE)
        self.assertEqual(self.daemon.returncode, 0)
        self.assertIn('"contact_ticks"', report)
        self.expect_replay_up_to_the_first_move()
        if "C#" not in shown:
            self.skipTest("mcs or mono is not installed (mono-mcs and mono-runtime): C# not run")


if __name__ == "__main__":
    unittest.main()
