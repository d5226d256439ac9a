#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tools of `full` assets by the paper's equations, as `run` and `replay` serve them."""

import csv
import json
import os
import unittest

from programs import BAKE, SERVO, THIN_BAND, Case, bake_box, models_of, run

TOP = 0.032  # m, half the height of models/box along z
MARGIN = "2.5mm"


class PaperTool(Case):
    @classmethod
    def setUpClass(cls):
        cls.models = models_of(cls, "box", "sphere")
        for name, planes in (("box", ()), ("sphere", ("--planes", "60"))):
            result = run("build", os.path.join(cls.models, name + ".obj"), "-o", cls.asset(name), "--form",
                         "full", "--margin", MARGIN, "--resolution", "33", *planes, "--quiet", program=BAKE)
            assert result.returncode == 0, result.stderr

    @classmethod
    def asset(cls, name):
        return os.path.join(cls.models, name + ".spm.exr")

    def scene(self, tool, obj, keys="", more=""):
        return self.write("scene.toml",
                          f'[tool]\nasset = "{self.asset(tool)}"\n[[object]]\nasset = "{self.asset(obj)}"\n'
                          f'method = "paper"\n{keys}\n{more}')

    def run_sim(self, scene, *options):
        result = run("run", "--scene", scene, "--duration", "2", "--realtime", "off", "--black-box", "off",
                     "--socket", self.path("a.sock"), "--json", *options, program=SERVO)
        self.assertEqual(result.returncode, 0, result.stderr)
        return json.loads(result.stdout), result.stderr

    def test_the_simulated_hand_touches_with_it_for_60_percent_of_the_ticks(self):
        for tool, obj, seed in (("box", "box", 1), ("box", "box", 2), ("sphere", "box", 1),
                                ("sphere", "sphere", 1)):
            with self.subTest(tool=tool, object=obj, seed=seed):
                report, told = self.run_sim(self.scene(tool, obj), "--device", f"sim:seed={seed}")
                self.assertGreater(report["contact_ticks"], 0.6 * report["ticks"])
                self.assertNotIn("no way was found", told)

    def test_ticks_with_too_little_time_are_told_and_replay_bit_by_bit(self):
        scene = self.scene("box", "box")
        with open(scene, encoding="utf-8") as file:
            text = file.read()
        self.write("scene.toml", text.replace("[tool]\n", '[tool]\nbudget = "1us"\n'))
        path = self.write("low.txt", "".join(f"{1e-5 * i!r} 0 {2 * TOP - 0.0005!r}\n" for i in range(500)))
        record = self.path("run.spmrec")
        report, _ = self.run_sim(scene, "--device", f"sim:hand=path,path={path}", "--record", record)
        self.assertGreater(report["degraded_ticks"], 0.9 * report["contact_ticks"])
        self.assertGreater(report["contact_ticks"], 0.9 * report["ticks"])
        result = run("replay", record, "--json", program=SERVO)
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        self.assertIs(json.loads(result.stdout)["recording"]["forces_equal"], True)

    def test_objects_that_are_far_off_are_culled(self):
        more = "".join(f'[[object]]\nasset = "{self.asset("box")}"\nmethod = "paper"\n'
                       f'pose = [{5 + k}, 0.3, 0]\n' for k in range(3))
        path = self.write("low.txt", "".join(f"0 0 {2 * TOP - 0.0005!r}\n" for _ in range(20)))
        out = self.path("felt.csv")
        result = run("replay", path, "--scene", self.scene("box", "box", more=more), "--out", out,
                     program=SERVO)
        self.assertEqual(result.returncode, 0, result.stderr)
        with open(out, newline="", encoding="ascii") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual({row["culled"] for row in rows}, {"3"})
        self.assertEqual({row["contact"] for row in rows}, {"1"})


class OtherMethods(Case):
    @classmethod
    def setUpClass(cls):
        bake_box(cls, "--form", "full", "--resolution", "9", "--probe", "sphere:0.5mm", *THIN_BAND[:2])

    def test_settings_of_method_paper_are_warned_of_where_no_object_is_of_it(self):
        path = self.write("path.txt", f"0 0 {TOP!r}\n")
        probe = self.write("probe.toml", '[tool]\nprobe = "sphere:0.5mm"\npaper_probe = "volume"\n'
                           f'[[object]]\nasset = "{self.asset}"\nmethod = "spm"\n')
        for options, named in ((("--asset", self.asset, "--paper-rule", "all-planes"), "--paper-rule"),
                               (("--asset", self.asset, "--method", "spm", "--probe", "sphere:0.5mm",
                                 "--paper-probe", "volume"), "--paper-probe"),
                               (("--scene", probe), "'paper_probe' of [tool]"),
                               (("--scene", probe, "--method", "paper"), None)):
            with self.subTest(options=options):
                result = run("replay", path, "--out", self.path("out.csv"), *options, program=SERVO)
                self.assertEqual(result.returncode, 0, result.stderr)
                if named is None:
                    self.assertEqual(result.stderr, "")
                else:
                    self.assertIn("warning: ", result.stderr)
                    self.assertIn(named, result.stderr)


if __name__ == "__main__":
    unittest.main()
