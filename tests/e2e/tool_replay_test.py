#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Recordings, trajectories and traces of a hand that holds a tool with six degrees of freedom: a box on
a larger one."""

import csv
import json
import math
import os
import sys
import unittest

from programs import BAKE, SERVO, Case, models_of, run

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), os.pardir, os.pardir, "scripts",
                                "charts"))

from recording_file import CONTACT, TOOL, read_recording  # noqa: E402

TOP, SCALE = 0.032, 0.3  # m, half the height of models/box along z, and what the tool is of it
FORCE_CAP, TORQUE_CAP = 12, 0.6  # N and N m, of the scene's profile
RESTS = TOP * (1 + SCALE)  # m, where a hand is whose tool touches


class ToolReplay(Case):
    @classmethod
    def setUpClass(cls):
        cls.models = models_of(cls, "box")
        cls.asset = os.path.join(cls.models, "box.spm.exr")
        result = run("build", os.path.join(cls.models, "box.obj"), "-o", cls.asset, "--tolerance", "50um",
                     "--quiet", program=BAKE)
        assert result.returncode == 0, result.stderr

    def scene(self, scale=SCALE):
        return self.write(f"scene{scale}.toml",
                          f'[device]\nprofile = "omega3"\n[tool]\nasset = "{self.asset}"\nscale = {scale}\n'
                          f'[[object]]\nasset = "{self.asset}"\nfriction = {{ slide = 0.2, stick = 0.3 }}\n')

    def record(self, device, *options):
        """Runs a hand that follows poses on the simulated device, and returns the report."""
        device = f"{device},hand=path,path={self.poses('way.txt')}"
        result = run("run", "--scene", self.scene(), "--duration", "2", "--device", device, "--realtime",
                     "off", "--black-box", "off", "--socket", self.path("a.sock"), "--json", *options,
                     program=SERVO)
        self.assertEqual(result.returncode, 0, result.stderr)
        return json.loads(result.stdout)

    def poses(self, name, quaternions=True):
        """Down on the box's top, and then turned about y on it."""
        lines = []
        for i in range(600):
            turn = 0.1 * max(0, i - 300) / 300 if quaternions else 0
            words = [0, 0, RESTS + 0.001 - 0.003 * min(1, i / 300)]
            if quaternions:
                words += [math.cos(turn / 2), 0, math.sin(turn / 2), 0]
            lines.append(" ".join(map(repr, words)))
        return self.write(name, "\n".join(lines) + "\n")

    def table(self, name):
        with open(self.path(name), encoding="ascii", newline="") as file:
            return [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file)]

    def test_a_recording_replays_bit_by_bit_torque_and_all(self):
        for device, turns, torque in (("sim:seed=3", True, True), ("sim:seed=4,torque=off", True, False),
                                      ("sim:seed=5,turns=off", False, False)):
            with self.subTest(device=device):
                report = self.record(device, "--record", self.path("run.spmrec"))
                rows = list(read_recording(self.path("run.spmrec")).rows())
                self.assertGreater(sum(row.patches > 0 for row in rows), 200)
                self.assertTrue(all(row.flags & TOOL for row in rows if row.flags & CONTACT))
                largest = max(math.hypot(*row.sent_torque) for row in rows)
                self.assertEqual(largest > 0, torque)
                self.assertEqual(any(abs(row.orientation[0]) < 1 - 1e-9 for row in rows), turns)
                self.assertAlmostEqual(report["devices"][0].get("torque_max_n_m", 0), largest, 12)
                result = run("replay", self.path("run.spmrec"), "--json", program=SERVO)
                self.assertEqual((result.returncode, result.stderr), (0, ""))
                compared = json.loads(result.stdout)["recording"]
                self.assertIs(compared["forces_equal"], True)
                self.assertEqual(compared["compared_ticks"], len(rows))
                self.assertEqual(compared["largest_difference_n_m"], 0)

    def test_the_report_tells_of_the_tool_and_not_of_a_probe(self):
        report = self.record("sim:seed=3")
        self.assertEqual(report["tool"]["asset"], self.asset)
        self.assertEqual(report["tool"]["scale"], SCALE)
        self.assertGreater(report["tool"]["samples"], 1000)
        self.assertGreater(report["tool"]["spacing_m"], 0)
        self.assertNotIn("probe", report)
        self.assertNotIn("probe_radius_m", report)

    def test_the_scenes_profile_is_not_that_of_a_device_that_the_command_line_names(self):
        for device, profile in (("sim:seed=3", "low"), ("sim:profile=falcon", "falcon")):
            with self.subTest(device=device):
                self.assertEqual(self.record(device)["devices"][0]["profile"], profile)

    def test_poses_of_seven_columns_are_replayed_and_the_table_has_torque(self):
        result = run("replay", self.poses("poses.txt"), "--scene", self.scene(), "--out",
                     self.path("out.csv"), program=SERVO)
        self.assertEqual(result.returncode, 0, result.stderr)
        rows = self.table("out.csv")
        self.assertEqual((len(rows), rows[0]["fz"]), (600, 0))
        last = rows[-1]
        self.assertGreater(last["fz"], 0.3)
        self.assertLess(last["ty"], -1e-4)
        self.assertGreater(last["patches"], 0)
        self.assertGreater(last["tool_z"], RESTS - 0.001)
        self.assertAlmostEqual(last["qw"], math.cos(0.05), 4)

    def test_positions_without_a_quaternion_are_of_a_hand_that_is_not_turned(self):
        three = self.poses("three.txt", quaternions=False)
        with open(three, encoding="ascii") as file:
            seven = self.write("seven.txt", "".join(line.strip() + " 1 0 0 0\n" for line in file))
        for path, out in ((three, "three.csv"), (seven, "seven.csv")):
            result = run("replay", path, "--scene", self.scene(), "--out", self.path(out), program=SERVO)
            self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(self.table("three.csv"), self.table("seven.csv"))
        self.assertGreater(self.table("seven.csv")[-1]["fz"], 0)

    def test_a_pose_that_is_none_is_refused_with_its_line(self):
        for quaternion in ("2 0 0 0", "0 0 0 0", "nan 0 0 0", "1 0 0"):
            path = self.write("bad.txt", f"0 0 1 1 0 0 0\n0 0 1 {quaternion}\n")
            result = run("replay", path, "--scene", self.scene(), "--out", self.path("out.csv"),
                         program=SERVO)
            self.assertEqual(result.returncode, 3, quaternion)
            self.assertIn("line 2", result.stderr)

    def test_no_size_start_or_turn_of_a_tool_gives_more_than_the_device_may(self):
        ways = "1 0 0 0", "0 1 0 0"
        half_turns = "".join(f"0 0 {RESTS - 1e-3!r} {ways[i // 10 % 2]}\n" for i in range(100))
        for scale in (1e-6, SCALE, 1, 1e3, 1e6):
            for name, poses in (("inside.txt", "0 0 0.01 1 0 0 0\n" * 100), ("turns.txt", half_turns)):
                with self.subTest(scale=scale, hand=name):
                    result = run("replay", self.write(name, poses), "--scene", self.scene(scale), "--out",
                                 self.path("out.csv"), program=SERVO)
                    self.assertEqual((result.returncode, result.stderr), (0, ""))
                    for row in self.table("out.csv"):
                        size = [math.hypot(*(row[kind + axis] for axis in "xyz")) for kind in "ft"]
                        self.assertLessEqual(size[0], FORCE_CAP * (1 + 1e-9))
                        self.assertLessEqual(size[1], TORQUE_CAP * (1 + 1e-9))

    def two_tools(self, *options):
        """Runs two hands with tools of their own in the air, which meet, press and turn; the report."""
        scene = self.write("two.toml",
                           '[device]\nprofile = "omega3"\n' + 2 * f'[[tool]]\nasset = "{self.asset}"\n'
                           f'scale = {SCALE}\n' + f'[[object]]\nasset = "{self.asset}"\n')
        half, devices = TOP * SCALE, []
        for number, side in enumerate((-1, 1)):
            lines = []
            for i in range(900):
                turn, way = 0.1 * side * max(0, i - 600) / 300, 0.004 - 0.006 * min(1, i / 300)
                words = [0, 0, 0.2 + side * (half + way), math.cos(turn / 2), math.sin(turn / 2), 0, 0]
                lines.append(" ".join(map(repr, words)))
            path = self.write(f"hand{number}.txt", "\n".join(lines) + "\n")
            devices += ["--device", f"sim:hand=path,path={path},seed={number + 3}"]
        result = run("run", "--scene", scene, "--duration", "1", *devices, "--realtime", "off",
                     "--black-box", "off", "--socket", self.path("a.sock"), "--json", *options,
                     program=SERVO)
        self.assertEqual(result.returncode, 0, result.stderr)
        return json.loads(result.stdout)

    def test_two_devices_press_their_tools_on_each_other_and_that_replays_bit_by_bit(self):
        self.two_tools("--record", self.path("two.spmrec"))
        both = [list(read_recording(self.path("two.spmrec")).rows(device)) for device in (0, 1)]
        late = [[row for row in rows if row.patches > 0][-100:] for rows in both]
        self.assertEqual([len(some) for some in late], [100, 100])
        mean = [sum(row.wanted[2] for row in some) / len(some) for some in late]
        # How near both are to one another is a matter of time in the tick; without a clock the unit
        # tests of two tools hold it.
        self.assertLess(mean[0], -0.1)
        self.assertGreater(mean[1], 0.1)
        rows = [len(rows) for rows in both]
        for options, compared in (((), sum(rows)), (("--device-number", "1"), rows[1])):
            result = run("replay", self.path("two.spmrec"), "--json", *options, program=SERVO)
            self.assertEqual((result.returncode, result.stderr), (0, ""))
            found = json.loads(result.stdout)["recording"]
            self.assertIs(found["forces_equal"], True)
            self.assertEqual(found["compared_ticks"], compared)

    def test_tools_of_their_own_for_another_number_of_devices_are_refused(self):
        tool = f'[[tool]]\nasset = "{self.asset}"\n'
        scene = self.write("three.toml", 3 * tool + f'[[object]]\nasset = "{self.asset}"\n')
        result = run("run", "--scene", scene, "--device", "sim", "--device", "sim", "--duration", "1",
                     program=SERVO)
        self.assertEqual(result.returncode, 3, result.stderr)
        self.assertIn("line 6: the scene names 3 tools for 2 devices; give each device its [[tool]]",
                      result.stderr)

    def test_a_path_with_a_scene_of_two_tools_is_told_to_be_of_the_first(self):
        tool = f'[[tool]]\nasset = "{self.asset}"\nscale = {SCALE}\n'
        scene = self.write("pair.toml", 2 * tool + f'[[object]]\nasset = "{self.asset}"\n')
        result = run("replay", self.poses("way.txt"), "--scene", scene, "--out", self.path("out.csv"),
                     program=SERVO)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("pair.toml: the scene has 2 tools, and a file of positions is of one hand",
                      result.stderr)

    def test_a_replay_by_a_scene_whose_tool_is_another_says_so(self):
        self.record("sim:seed=3", "--record", self.path("run.spmrec"))
        result = run("replay", self.path("run.spmrec"), "--scene", self.scene(0.4), program=SERVO)
        self.assertEqual(result.returncode, 10, result.stderr)
        self.assertIn("what differs: tool", result.stderr)

    def test_a_trace_has_the_tools_pose_and_the_torque_and_plot_draws_it(self):
        self.record("sim:seed=3", "--trace", self.path("felt.csv"), "--record", self.path("run.spmrec"))
        rows = self.table("felt.csv")
        self.assertGreater(max(abs(row["tx"]) + abs(row["ty"]) for row in rows), 0)
        self.assertGreater(max(row["patches"] for row in rows), 0)
        self.assertTrue(any(row["tool_x"] or row["tool_y"] or row["tool_z"] for row in rows))
        result = run("plot", self.path("run.spmrec"), self.path("run.svg"), program=SERVO)
        self.assertEqual(result.returncode, 0, result.stderr)
        with open(self.path("run.svg"), encoding="utf-8") as file:
            self.assertIn("</svg>", file.read())


if __name__ == "__main__":
    unittest.main()
