#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A scene that is edited while `spm-servo run` serves it to the simulated device."""

import json
import math
import os
import queue
import signal
import subprocess
import sys
import threading
import time
import unittest

from programs import BAKE, SERVO, Case, models_of, obj, run, sphere

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), os.pardir, os.pardir, "scripts",
                                "charts"))

from recording_file import read_recording  # noqa: E402

TOP = 0.032  # m, half the height of models/box
GRIP = 700  # N/m, servo/devices/sim/sim_profile.hpp
FRICTION = 0.02  # N, of the profile `low`, beside the hand's spring
DEPTH = 0.002  # m, where the hand wants to be below the box's top
RADIUS = 0.02  # m, of the ball
PATIENCE = 60  # s
# N/m: what `low` holds stably, the default (common/contact/stiffness_borders.hpp)
DEFAULT = 0.6 * 1660
PROFILE = '[device]\nprofile = "low"\n'
HEAD = f"{PROFILE}[workspace]\npose = [0, 0, {TOP}]\n"


def balance(*springs):
    """The force between the hand's spring and surfaces, each its stiffness and how far it is raised
    above the box's top."""
    stiffness = sum(k for k, _ in springs)
    # At a depth x below the top: GRIP (DEPTH - x) = sum of k (x + raised).
    depth = (GRIP * DEPTH - sum(k * raised for k, raised in springs)) / (GRIP + stiffness)
    return sum(k * (depth + raised) for k, raised in springs)


class SceneReload(Case):
    @classmethod
    def setUpClass(cls):
        cls.models = models_of(cls, "box")
        with open(os.path.join(cls.models, "ball.obj"), "w", encoding="ascii") as file:
            file.write(obj(sphere(RADIUS)))
        for name in ("box", "ball"):
            base = os.path.join(cls.models, name)
            result = run("build", base + ".obj", "-o", base + ".spm.exr", "--tolerance", "50um",
                         "--quiet", program=BAKE)
            assert result.returncode == 0, result.stderr

    def start(self, scene):
        """The daemon, a hand that presses on the box's top, and what it says, line by line."""
        steps = [DEPTH - 2e-5 * i for i in range(int(2 * DEPTH / 2e-5) + 1)]
        path = self.write("hand.txt", "".join(f"0.001 0.002 {z!r}\n" for z in steps))
        daemon = subprocess.Popen(
            [SERVO, "run", "--scene", scene, "--device", f"sim:profile=low,hand=path,path={path}",
             "--record", self.path("out.spmrec"), "--black-box", "off",
             "--socket", self.path("socket"), "--realtime", "off", "--json"],
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
            env={**os.environ, "LC_ALL": "C.UTF-8"})
        self.addCleanup(daemon.wait)
        self.addCleanup(daemon.kill)
        lines = queue.Queue()
        # What it says of scenes; of the machine it may say more.
        reader = threading.Thread(target=lambda: [lines.put(line) for line in daemon.stderr
                                                  if "taken up" in line])
        reader.start()
        self.addCleanup(daemon.stderr.close)
        self.addCleanup(reader.join)
        self.addCleanup(daemon.kill)  # the first to run: the reader then comes to its end
        end = time.monotonic() + PATIENCE
        while not os.path.exists(self.path("socket")) and time.monotonic() < end:
            time.sleep(0.01)
        self.lines = lines
        return daemon

    def says(self, *parts):
        """The next sentence of the daemon has all of these in it."""
        line = self.lines.get(timeout=PATIENCE)
        for part in parts:
            self.assertIn(part, line)

    def save(self, *objects):
        """As editors do: another file, renamed over the old one."""
        text = HEAD + "".join("[[object]]\n" + content.replace("@", self.models + os.sep) + "\n"
                              for content in objects)
        os.replace(self.write("scene.toml.new", text), self.path("scene.toml"))
        return self.path("scene.toml")

    def rows(self):
        """Ticks, forces along z, and causes of zero force, of the recording."""
        recording = read_recording(self.path("out.spmrec"))
        return [(row.tick, row.sent[2], recording.causes[row.cause]) for row in recording.rows()]

    def replay_of_the_first_scene_ends_where_it_was_edited(self, box, rows):
        """Forces from there on are of other scenes, and are not compared."""
        result = run("replay", self.path("out.spmrec"), "--scene", self.save(box), "--out",
                     self.path("out.csv"), "--json", program=SERVO)
        self.assertEqual(result.returncode, 0, result.stderr)
        recording = json.loads(result.stdout)["recording"]
        changed = recording["scene_changed"]
        self.assertEqual(changed["by"], "edit")
        self.assertEqual(rows[changed["row"]][0], changed["tick"])
        self.assertEqual(recording["compared_ticks"], changed["row"])
        self.assertIs(recording["forces_equal"], True)
        # The first edit came after the force of the first scene was held.
        self.assertGreater(rows[changed["row"] - 1][1], 0)
        warnings = result.stderr.splitlines()
        self.assertEqual(len(warnings), 1, result.stderr)
        self.assertIn(f"from tick {changed['tick']} of the recording on an edited scene was served",
                      warnings[0])

    def replay_without_options_is_equal_in_every_tick(self, rows):
        """The recording has the edits, and replays whatever the scene's file says now."""
        result = run("replay", self.path("out.spmrec"), "--json", program=SERVO)
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        recording = json.loads(result.stdout)["recording"]
        self.assertEqual(recording["compared_ticks"], len(rows))
        self.assertIs(recording["forces_equal"], True)

    def test_an_edited_scene_is_felt_and_one_that_will_not_do_changes_nothing(self):
        box = 'asset = "@box.spm.exr"\n'
        raised = 0.001
        ball = f'asset = "@ball.spm.exr"\npose = [0.001, 0.002, {TOP - RADIUS!r}]\n'
        scene = self.save(box)
        daemon = self.start(scene)
        steady = 0.7  # s, in which a force fades in and the hand comes to rest

        time.sleep(steady)
        self.save(box + 'stiffness = "2N/mm"')
        self.says("info", "scene.toml: taken up again: object 0: stiffness")
        time.sleep(steady)
        self.save(box + f'stiffness = "2N/mm"\npose = [0, 0, {raised!r}]')
        self.says("object 0: pose")
        time.sleep(steady)
        self.write("scene.toml", HEAD + "[[object]]\nasset = \"box.spm.exr\"\nstiffness = 2N/mm\n")
        self.says("warning", "the scene stays as it was", "scene.toml: line 7", "not TOML")
        self.save(box + 'stiffness = "2N/mm"\nstifness = "1N/mm"')
        self.says("warning", "scene.toml: line 8", "did you mean 'stiffness'?")
        self.save(box, 'asset = "@missing.spm.exr"')
        self.says("warning", "missing.spm.exr")
        os.replace(self.write("new.toml", f"{PROFILE}force_cap = \"1N\"\n[[object]]\n" +
                              box.replace("@", self.models + os.sep)), scene)
        self.says("warning", "'force_cap' of [device]", "start it again")
        self.save(box, ball)
        self.says("object 0: pose, stiffness; object 1 added (ball.spm.exr)")
        time.sleep(steady)
        self.save(ball)
        self.says("object 0 removed")
        time.sleep(steady)

        daemon.send_signal(signal.SIGINT)
        report = json.loads(daemon.stdout.read())
        daemon.stdout.close()
        self.assertEqual(daemon.wait(timeout=PATIENCE), 0)
        self.assertEqual([os.path.basename(asset["path"]) for asset in report["assets"]],
                         ["box.spm.exr", "ball.spm.exr"])
        self.assertEqual([os.path.basename(o["asset"]) for o in report["objects"]],
                         ["ball.spm.exr"])
        self.assertTrue(self.lines.empty())

        rows = self.rows()
        self.assertEqual(len(rows), report["ticks"])
        self.assertEqual(report["unrecorded"], 0)
        self.assertTrue(all(a[0] < b[0] for a, b in zip(rows, rows[1:])))
        # From the first tick to the last but the end, nothing ever took the force away.
        off = [cause for _, _, cause in rows if cause != "none"]
        self.assertEqual(set(off) - {"starting", "stopping"}, set())
        self.assertLess(len(off), len(rows) / 10)
        # Each scene was felt, in its turn.
        at, last = 0, len(rows)
        for wanted in (balance((DEFAULT, 0)), balance((2000, 0)), balance((2000, raised)),
                       balance((DEFAULT, 0), (DEFAULT, 0)), balance((DEFAULT, 0))):
            held = 0
            while held < 50:
                self.assertLess(at, last, f"{wanted:.3f} N was not felt")
                near = math.isclose(rows[at][1], wanted, abs_tol=2 * FRICTION)
                held, at = held + 1 if near else 0, at + 1
        self.replay_of_the_first_scene_ends_where_it_was_edited(box, rows)
        self.replay_without_options_is_equal_in_every_tick(rows)
        # No scene kicked: at once, the millimetre that the box was raised would be 2 N.
        kick = max(b[1] - a[1] for a, b in zip(rows, rows[1:]))
        self.assertLess(kick, 0.5)


if __name__ == "__main__":
    unittest.main()
