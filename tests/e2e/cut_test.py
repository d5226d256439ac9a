#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Bakes of only what a device and a scene need."""

import csv
import os
import unittest

from programs import Case, digest, merged, obj, reversed_faces, run, sphere

RADIUS = 0.02
SPHERE = obj(sphere(RADIUS))
# 8 N over 40 N/mm: a band of 0.2 mm, which bakes soon. The workspace, 51 mm to each side, ends at
# x = 1 mm.
SCENE = """
[device]
profile = "falcon"

[tool]
probe = "sphere:0.2mm"

[workspace]
pose = [-0.05, 0, 0]

[[object]]
mesh = "sphere.obj"
stiffness = "40N/mm"
"""


def hollow(outer, inner):
    """A ball with a sealed hollow: the inner sphere's triangles face the other way."""
    return merged(sphere(outer), reversed_faces(sphere(inner)))


class Cut(Case):
    def setUp(self):
        super().setUp()
        self.mesh = self.write("sphere.obj", SPHERE)
        self.asset = self.path("sphere.spm.exr")

    def build(self, *options, mesh=None):
        return self.run_json("build", mesh or self.mesh, "-o", self.asset, *options)

    def refused(self, scene, code, *names):
        path = self.write("scene.toml", scene)
        result = run("build", self.mesh, "-o", self.asset, "--scene", path)
        self.expect_refusal(result, code, *names)
        self.assertFalse(os.path.exists(self.asset))

    def statuses(self, points):
        path = self.write("points.txt", "".join(f"{x} {y} {z}\n" for x, y, z in points))
        self.run_json("query", self.asset, "--points", path, "-o", self.path("out.csv"))
        with open(self.path("out.csv"), newline="", encoding="ascii") as file:
            rows = list(csv.DictReader(file))
        for row in rows:
            if row["status"] == "pruned":
                self.assertEqual((row["distance"], row["source"], row["plane"]), ("nan", "none", "-1"))
        return [row["status"] for row in rows]

    def saved(self, report):
        for pruned in report["pruned"]:
            self.assertGreater(pruned["bytes"], 0)
        return [pruned["rule"] for pruned in report["pruned"]]

    def test_a_device_gives_half_its_encoder_step_and_says_so(self):
        report = self.build("--device", "falcon", "--max-depth", "0.1mm", "--margin", "0.05mm")
        self.assertAlmostEqual(report["tolerance_um"], 32)
        self.assertEqual(len(report["derived"]), 1)
        self.assertIn("half of falcon's encoder step of 64 um", report["derived"][0])
        self.assertEqual(report["pruned"], [])

    def test_a_scene_cuts_what_its_device_does_not_reach(self):
        scene = self.write("scene.toml", SCENE)
        whole = self.build("--tolerance", "32um", "--max-depth", "0.2mm", "--probe", "sphere:0.2mm")
        report = self.build("--scene", scene)
        self.assertAlmostEqual(report["tolerance_um"], 32)
        self.assertTrue(report["tolerance_met"])
        self.assertEqual(self.saved(report), ["workspace"])
        self.assertLess(report["bytes"], whole["bytes"])
        inside = RADIUS - 0.0001
        self.assertEqual(self.statuses([(-inside, 0, 0), (inside, 0, 0), (0, inside, 0),
                                        (0, 0, 0), (-RADIUS + 0.0005, 0, 0)]),
                         ["exact", "pruned", "exact", "deep", "deep"])
        verified = self.run_json("verify", self.asset, self.mesh, "--samples", "3000")
        self.assertEqual(verified["unanswered"], 0)
        self.assertGreater(verified["pruned"], 0.3)
        self.assertLessEqual(verified["distance_error_um"]["max"], 32)

    def test_the_asset_records_what_was_derived_and_no_path(self):
        scene = self.write("scene.toml", SCENE)
        self.build("--scene", scene)
        content = digest(self.asset)
        with open(self.asset, "rb") as file:
            self.assertNotIn(b"scene.toml", file.read())
        os.rename(scene, self.path("other.toml"))
        self.build("--scene", self.path("other.toml"))
        self.assertEqual(digest(self.asset), content)

    def test_the_command_line_wins_over_the_scene(self):
        scene = self.write("scene.toml", SCENE)
        report = self.build("--scene", scene, "--tolerance", "100um", "--max-depth", "0.1mm",
                            "--probe", "point")
        self.assertAlmostEqual(report["tolerance_um"], 100)
        info = self.run_json("info", self.asset)
        self.assertAlmostEqual(info["band"]["max_depth_m"], 0.0001)

    def test_a_sealed_hollow_is_left_out_and_the_ball_about_it_stays(self):
        mesh = self.write("hollow.obj", obj(hollow(RADIUS, RADIUS / 2)))
        report = self.build("--tolerance", "200um", "--max-depth", "0.2mm", mesh=mesh)
        self.assertEqual(self.saved(report), ["unreachable"])
        inside = RADIUS - 0.0001
        self.assertEqual(self.statuses([(inside, 0, 0), (RADIUS / 2 - 0.0001, 0, 0),
                                        (RADIUS / 2 + 0.0001, 0, 0), (0.75 * RADIUS, 0, 0)]),
                         ["exact", "pruned", "pruned", "deep"])

    def test_a_summary_for_a_person_tells_what_was_left_out_and_why(self):
        scene = self.write("scene.toml", SCENE)
        result = run("build", self.mesh, "-o", self.asset, "--scene", scene)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertRegex(result.stdout, r"pruned +\d+ bytes: outside the device's workspace")
        self.assertIn("derived  max-depth 200 um: 8 N over 40 N/mm", result.stdout)

    def test_a_manifest_takes_a_scene_relative_to_itself(self):
        self.write("scene.toml", SCENE)
        manifest = self.write("assets.toml", '[[asset]]\nmesh = "sphere.obj"\nscene = "scene.toml"\n'
                                             'output = "sphere.spm.exr"\ntolerance = "100um"\n')
        report = self.run_json("batch", manifest)
        self.assertIn("max-depth 200 um", "\n".join(report["derived"]))

    def test_scenes_that_leave_nothing_to_bake_are_refused(self):
        self.refused(SCENE.replace("-0.05", "1"), 3, "scene.toml", "sphere.obj", "workspace")
        self.refused(SCENE.replace('"40N/mm"', '"80N/m"'), 3, "scene.toml", "100 mm deep", "stiffness")
        self.refused(SCENE.replace("stiffness", "stifness"), 3, "line 13", "did you mean 'stiffness'?")
        self.refused(SCENE.replace('"falcon"', '"hawk"'), 3, "line 3", "hawk", "falcon")
        self.refused(SCENE + '[[object]]\nmesh = "sphere.obj"\n', 3, "lines 11 and 14", "sphere.obj")

    def test_a_scene_that_cannot_be_read_is_a_file_error(self):
        result = run("build", self.mesh, "-o", self.asset, "--scene", self.path("none.toml"))
        self.expect_refusal(result, 2, "none.toml", "cannot be opened")

    def test_a_probe_that_touches_all_of_a_ball_cuts_nothing(self):
        report = self.build("--probe", "sphere:2mm", "--max-depth", "0.2mm", "--tolerance", "1mm")
        self.assertEqual(report["pruned"], [])


if __name__ == "__main__":
    unittest.main()
