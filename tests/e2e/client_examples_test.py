#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The examples in C, Python and C#, beside one real daemon."""

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


class WithDaemon(Case):
    """A daemon that serves a scene, and records it."""

    def start(self, scene, device):
        """Serves a scene, whose boxes are baked, and waits for its first ticks."""
        generate(self.folder, "box")
        baked = run("build", self.path("box.obj"), "-o", self.path("box.spm.exr"), "--tolerance",
                    "50um", "--quiet")
        self.assertEqual(baked.returncode, 0, baked.stderr)
        self.socket = self.path("a.sock")
        self.scene = self.write("scene.toml", scene)
        self.daemon = subprocess.Popen(
            [SERVO, "run", "--scene", self.scene, "--device", device, "--realtime", "off", "--black-box",
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

    def compiled(self, source):
        """An example in C#, compiled; None where there is no C#."""
        if not (shutil.which("mcs") and shutil.which("mono")):
            return None
        program = self.path(source.replace(".cs", ".exe"))
        subprocess.run(["mcs", f"-out:{program}", *glob.glob(os.path.join(C_SHARP, "*.cs")),
                        os.path.join(EXAMPLES, source)], check=True, capture_output=True)
        return program

    def started(self, command):
        return subprocess.Popen(command, text=True, env=self.environment, stdout=subprocess.PIPE,
                                stderr=subprocess.PIPE)

    def output_of(self, language, process):
        """What an example printed, which must end in order."""
        shown, errors = process.communicate(timeout=PATIENCE)
        self.assertEqual((process.returncode, errors), (0, ""), language)
        print(f"--- {language}\n{shown}", end="", flush=True)
        return shown

    def end(self):
        """The report of the daemon, which ends in order."""
        self.daemon.send_signal(signal.SIGTERM)
        report, _ = self.daemon.communicate(timeout=PATIENCE)
        self.assertEqual(self.daemon.returncode, 0)
        return json.loads(report)


class ClientExamples(WithDaemon):
    def setUp(self):
        super().setUp()
        self.start(f"{BOX}\n{BOX}pose = [0.2, 0, 0]\n", "sim")

    def commands(self):
        """Each example by its language; the object that it moves is its own."""
        yield "C", [os.path.join(BIN, "spm_client_example"), self.socket, "20"]
        yield "Python", [sys.executable, os.path.join(EXAMPLES, "move_object.py"), self.socket, "2"]
        if c_sharp := self.compiled("ReadState.cs"):
            yield "C#", ["mono", c_sharp, self.socket, "20", "1"]

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
        running = {language: self.started(command) for language, command in list(self.commands())}
        shown = {language: self.output_of(language, process) for language, process in running.items()}
        self.assertEqual(len(re.findall(r"^tick \d+: at .* mm, force .* N", shown["C"], re.M)), 20)
        self.assertIn(", in contact", shown["C"])
        self.assertGreater(len(set(re.findall(r"object at (\S+) mm", shown["Python"]))), 10)
        if "C#" in shown:
            ticks = re.findall(r"^tick (\d+): sim at .* mm, force .* N", shown["C#"], re.M)
            self.assertEqual((len(ticks), ticks), (20, sorted(ticks, key=int)))
            counted = re.search(r"^loop: (\d+) ticks, ", shown["C#"], re.M)
            self.assertGreaterEqual(int(counted[1]), int(ticks[-1]) - int(ticks[0]))
            self.assertIn("connected: ReadState example ", shown["C#"])
        self.assertIn("contact_ticks", self.end())
        self.expect_replay_up_to_the_first_move()
        if "C#" not in shown:
            self.skipTest("mcs or mono is not installed (mono-mcs and mono-runtime): C# not run")


class UnderTool(WithDaemon):
    """Each example moves an object of its own under one tool, a box that the hand holds."""

    def setUp(self):
        super().setUp()
        # A millimetre below the tool, whose half height is 24 mm.
        boxes = "".join(f"{BOX}scale = 0.4\npose = [{x}, -0.036, 0]\n" for x in (-0.022, 0, 0.022))
        tool = '[tool]\nasset = "box.spm.exr"\nscale = 0.8\n'
        hand = self.write("hand.txt", "0 0.001 0 1 0 0 0\n" * 2)
        self.start(f"{boxes}{tool}", f"sim:hand=path,path={hand}")

    def commands(self):
        words = [self.socket, "{}", "2", "4"]
        programs = {"C": [os.path.join(BIN, "spm_client_move_under_tool")],
                    "Python": [sys.executable, os.path.join(EXAMPLES, "move_under_tool.py")]}
        if c_sharp := self.compiled("MoveUnderTool.cs"):
            programs["C#"] = ["mono", c_sharp]
        for number, (language, program) in enumerate(programs.items()):
            yield language, program + [word.format(number) for word in words]

    def test_each_of_them_moves_its_object_under_the_tool_and_reads_the_contacts(self):
        # One after another: of three objects at once two may hold the tool off the third.
        for number, (language, command) in enumerate(self.commands()):
            text = self.output_of(language, self.started(command))
            frames = re.findall(r"^tool at \S+ \S+ \S+ mm touches at (\d+) places; object "
                                rf"{number}: reaction (\S+) N, (\S+) N m$", text, re.M)
            self.assertEqual(len(frames), 20, language)
            self.assertGreater(max(int(count) for count, _, _ in frames), 0, language)
            self.assertGreater(max(float(force) for _, force, _ in frames), 0.05, language)
            contacts = re.findall(r"^  at .* mm on object (\d+): (\S+) N, (\S+) mm deep$", text, re.M)
            self.assertIn(str(number), {number for number, _, _ in contacts}, language)
        report = self.end()
        self.assertGreater(report["contact_ticks"], 0)
        result = run("replay", self.path("run.spmrec"), "--json", program=SERVO)
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        self.assertIs(json.loads(result.stdout)["recording"]["forces_equal"], True)


if __name__ == "__main__":
    unittest.main()
