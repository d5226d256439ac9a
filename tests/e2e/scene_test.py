#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Scenes: the forces that `spm-servo replay --scene` writes, against their closed forms."""

import csv
import math
import os
import unittest

from programs import SERVO, Case, models_of, run

TOP = 0.032  # m, half the height of models/box
K = 1000  # N/m
TICK = 1e-3  # s


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def norm(a):
    return math.sqrt(dot(a, a))


def added(a, b, times=1.0):
    return tuple(x + times * y for x, y in zip(a, b))


def there_and_back(depth=0.001, step=4e-5, ticks=300):
    """Over the box's top and the same way back."""
    forth = [(-0.006 + step * i, 0.003, TOP - depth) for i in range(ticks)]
    return forth + forth[-2::-1]


class Scenes(Case):
    @classmethod
    def setUpClass(cls):
        cls.models = models_of(cls, "box")
        mesh = os.path.join(cls.models, "box.obj")
        for form, options in (("sparse", ("--tolerance", "50um", "--probe", "sphere:0.5mm")),
                              ("full", ("--form", "full", "--resolution", "17"))):
            asset = os.path.join(cls.models, form + ".spm.exr")
            result = run("build", mesh, "-o", asset, *options, "--quiet")
            assert result.returncode == 0, result.stderr

    def scene(self, *objects, head="", name="scene.toml"):
        """A scene of objects given by what stands below [[object]]; assets are sparse or full."""
        text = head
        for content in objects:
            text += "\n[[object]]\n" + content.replace("@", self.models + os.sep) + "\n"
        return self.write(name, text)

    def trajectory(self, points):
        return self.write("path.txt", "".join(f"{x!r} {y!r} {z!r}\n" for x, y, z in points))

    def replay(self, points, *options):
        """Forces and depths of a replay."""
        path, out = self.trajectory(points), self.path("out.csv")
        report = self.run_json("replay", path, "--out", out, *options, program=SERVO)
        self.assertEqual(report["ticks"], len(points))
        with open(out, newline="", encoding="ascii") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(len(rows), len(points))
        forces = [tuple(float(row[key]) for key in ("fx", "fy", "fz")) for row in rows]
        return forces, [float(row["depth"]) for row in rows]

    def felt(self, points, *objects, head=""):
        """Of a scene that names what these closed forms hold for: `spm`, not stabilized."""
        named = [content + ("" if "method" in content else '\nmethod = "spm"') for content in objects]
        return self.replay(points, "--scene", self.scene(*named, head=head + "\n[stabilization]\n"))

    def test_friction_opposes_the_motion_and_is_never_more_than_mu_times_the_pressing_force(self):
        points = there_and_back()
        for method in ("spm", "proxy"):
            with self.subTest(method):
                forces, depths = self.felt(points, 'asset = "@sparse.spm.exr"\n'
                                           f'method = "{method}"\n'
                                           "friction = { stick = 0.5, slide = 0.4, "
                                           'stiffness = "5N/mm" }')
                sliding = 0
                for i in range(1, len(points)):
                    pressing = K * depths[i]
                    along = math.sqrt(max(dot(forces[i], forces[i]) - pressing ** 2, 0))
                    self.assertLessEqual(along, 0.5 * pressing + 1e-9)
                    motion = added(points[i], points[i - 1], -1)
                    if along > 0.39 * pressing and abs(i - 299) > 50:
                        self.assertLess(dot(forces[i], motion), 0)
                        # Depths, from tick to tick, are as fine as a float tells 6 cm: 4 nm.
                        self.assertLessEqual(along, (0.4 + 4e-6) * pressing)
                        sliding += 1
                self.assertGreater(sliding, 400)
                plain, _ = self.felt(points, f'asset = "@sparse.spm.exr"\nmethod = "{method}"')
                self.assertLess(max(abs(force[0]) for force in plain), 0.05)

    def test_damping_takes_in_proportion_to_the_speed(self):
        points = there_and_back()
        smooth, _ = self.felt(points, 'asset = "@sparse.spm.exr"')
        forces, _ = self.felt(points, 'asset = "@sparse.spm.exr"\ndamping = "1.5N s/m"')
        for i in (100, 200, 400, 500):
            speed = (points[i][0] - points[i - 1][0]) / TICK
            self.assertAlmostEqual(forces[i][0] - smooth[i][0], -1.5 * speed, places=6)

    def test_texture_is_of_the_place_and_of_the_seed(self):
        points = there_and_back()
        rough = 'asset = "@sparse.spm.exr"\ntexture = { amplitude = "30um", wavelength = "0.5mm"'
        forces, _ = self.felt(points, rough + ", seed = 7 }")
        smooth, depths = self.felt(points, 'asset = "@sparse.spm.exr"')
        most = 0
        for i, force in enumerate(forces):
            self.assertLess(norm(added(force, forces[len(points) - 1 - i], -1)), 1e-12)
            most = max(most, abs(force[2] - smooth[i][2]))
            self.assertLessEqual(abs(force[2] - smooth[i][2]), K * 30e-6 * 1.5)
        self.assertGreater(most, K * 5e-6)
        self.assertNotEqual(self.felt(points, rough + ", seed = 8 }")[0], forces)
        self.assertEqual(self.felt(points, rough + ", seed = 7 }"), (forces, depths))

    def test_the_forces_of_two_objects_add_up(self):
        first = 'asset = "@sparse.spm.exr"\nfriction = { slide = 0.3 }'
        # The second stands on the first, a millimetre deep in it.
        second = ('asset = "@sparse.spm.exr"\nscale = 1.5\nstiffness = "0.7N/mm"\n'
                  f"pose = [0.001, 0, {TOP * 2.5 - 0.001!r}, 0, 1, 0, 0]\n"
                  'damping = "1Ns/m"')
        points = [(x, y, z - 2e-4) for x, y, z in there_and_back(0.0003)]
        one, depth_one = self.felt(points, first)
        two, depth_two = self.felt(points, second)
        both, depth = self.felt(points, first, second)
        self.assertGreater(min(norm(force) for force in one), 0.3)
        self.assertGreater(min(norm(force) for force in two), 0.2)
        for i in range(len(points)):
            self.assertLess(norm(added(added(both[i], one[i], -1), two[i], -1)), 1e-12)
            self.assertEqual(depth[i], max(depth_one[i], depth_two[i]))

    def test_pose_and_scale_place_an_object_and_its_stiffness_stays_the_worlds(self):
        half = math.sqrt(0.5)
        # Turned by a quarter about y, the box's top looks along x.
        placed = ('asset = "@sparse.spm.exr"\nscale = 2\nstiffness = "0.5N/mm"\n'
                  f"pose = [0.1, 0.2, 0.3, {half!r}, 0, {half!r}, 0]")
        points = [(0.1 + 2 * TOP - depth, 0.201, 0.303) for depth in (0.0005, 0.001, 0.003, -0.0005)]
        forces, depths = self.felt(points, placed)
        for force, depth, wanted in zip(forces, depths, (0.0005, 0.001, 0.003, 0)):
            self.assertAlmostEqual(depth, wanted, delta=5e-6)
            self.assertLess(norm(added(force, (500 * wanted, 0, 0), -1)), 2e-3)

    def test_a_workspace_moves_turns_and_scales_the_hand(self):
        half = math.sqrt(0.5)
        # The hand's z is the world's x here, twice as long.
        head = f"[workspace]\npose = [0, 0, 0.01, {half!r}, 0, {half!r}, 0]\nscale = 2\n"
        points = [(0.005, 0, (0.024 - 0.001) / 2)]
        forces, depths = self.felt(points, 'asset = "@sparse.spm.exr"', head=head)
        self.assertAlmostEqual(depths[0], 0.001, delta=2e-6)
        self.assertLess(norm(added(forces[0], (0, 0, 1), -1)), 2e-3)

    def test_the_probe_is_the_scenes_and_the_command_lines_wins(self):
        points = [(0.001, 0.002, TOP + 0.0002)]
        scene = self.scene('asset = "@sparse.spm.exr"', head='[tool]\nprobe = "sphere:0.3mm"\n')
        _, depths = self.replay(points, "--scene", scene)
        self.assertAlmostEqual(depths[0], 0.0001, delta=2e-6)
        _, depths = self.replay(points, "--scene", scene, "--probe", "sphere:0.5mm")
        self.assertAlmostEqual(depths[0], 0.0003, delta=2e-6)
        _, depths = self.replay(points, "--scene", scene, "--probe", "point")
        self.assertEqual(depths[0], 0)

    def test_without_effects_a_scene_is_its_asset(self):
        points = there_and_back()
        for form, method in (("sparse", "spm"), ("sparse", "proxy"), ("full", "paper")):
            with self.subTest(method):
                asset = os.path.join(self.models, form + ".spm.exr")
                alone = self.replay(points, "--asset", asset, "--method", method, "--stabilization",
                                    "none")
                scene = self.felt(points, f'asset = "@{form}.spm.exr"\nmethod = "{method}"')
                self.assertEqual(scene, alone)

    def test_by_the_papers_letter_equations_17_to_19_hold(self):
        points = there_and_back()
        asset = 'asset = "@full.spm.exr"\nmethod = "paper"\n'
        reaction, depths = self.felt(points, asset)
        forces, _ = self.felt(points, asset + 'friction = { force = "0.3N", depth_gain = "0.1/mm" }\n'
                              'damping = "2Ns/m"')
        for i in range(1, len(points)):
            motion = added(points[i], points[i - 1], -1)
            # eq. 17, the damping of section 4.2 and the sum of eq. 18; P_M moves as the hand does.
            friction = tuple(-0.3 * (1 + 100 * depths[i]) * m / norm(motion) for m in motion)
            damping = tuple(-2 * m / TICK for m in motion)
            wanted = added(added(reaction[i], friction), damping)
            self.assertLess(norm(added(forces[i], wanted, -1)), 1e-6)
        # eq. 19: along the normal, as far off as Gaussian noise of 10 um on the map, and the same again
        # on the way back.
        noisy, _ = self.felt(points, asset + 'texture = { noise = "10um", seed = 3 }')
        off = [(norm(a) - norm(b)) / K for a, b in zip(noisy, reaction)]
        for a, b in zip(noisy, reaction):
            self.assertLess(abs(dot(a, b) - norm(a) * norm(b)), 1e-9)
        self.assertGreater(max(map(abs, off)), 2e-6)
        self.assertLess(max(map(abs, off)), 50e-6)
        for there, back in zip(off, off[::-1]):
            self.assertAlmostEqual(there, back, delta=1e-12)
        self.assertEqual(self.felt(points, asset + 'texture = { noise = "10um", seed = 3 }')[0],
                         noisy)

    def test_a_scene_that_will_not_do_is_refused_with_its_line_and_writes_nothing(self):
        path, out = self.trajectory([(0, 0, TOP)]), self.path("out.csv")
        good = 'asset = "@sparse.spm.exr"\n'
        for content, code, names in (
                ("", 3, ("line 2", "needs 'mesh'")),
                ('mesh = "box.obj"', 3, ("line 2", "spm-bake build")),
                ('asset = "missing.spm.exr"', 2, ("missing.spm.exr",)),
                ('asset = "scene.toml"', 3, ("scene.toml",)),
                (good + "scale = 0", 3, ("line 4", "above 0")),
                (good + "scale = -1", 3, ("line 4", "mirror")),
                (good + "pose = [0, 0, 0, 0.9, 0, 0, 0]", 3, ("line 4", "unit length")),
                (good + "friction = 0.4", 3, ("line 4", "slide")),
                (good + 'damping = "1N"', 3, ("line 4", "Ns/m")),
                (good + 'texture = { noise = "1um" }', 3, ("line 2", "method paper")),
                (good + 'method = "paper"', 3, ("line 2", "--form full")),
                (good + "frction = {}", 3, ("line 4", "did you mean 'friction'?"))):
            with self.subTest(content):
                scene = self.scene(content)
                result = run("replay", path, "--scene", scene, "--out", out, program=SERVO)
                self.expect_refusal(result, code, *names)
                self.assertFalse(os.path.exists(out))
        for text in ("", "object = []\n", "[device]\nprofile = \"falcon\"\n"):
            scene = self.write("empty.toml", text)
            result = run("replay", path, "--scene", scene, "--out", out, program=SERVO)
            self.expect_refusal(result, 3, "empty.toml", "[[object]]")
        scene = self.scene(good)
        both = run("replay", path, "--scene", scene, "--asset", "a", "--out", out, program=SERVO)
        self.expect_refusal(both, 1, "--asset", "--scene")
        self.expect_refusal(run("replay", path, "--out", out, program=SERVO), 1, "--scene")
        self.expect_refusal(run("run", "--duration", "0.1", program=SERVO), 1, "--scene")


if __name__ == "__main__":
    unittest.main()
