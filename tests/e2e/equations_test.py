#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The paper's equations as commands reach them: runs the command of each row of the table in
common/paper/README.md, and compares what it gives with the equation's closed form."""

import csv
import math
import os
import random
import re
import shlex
import unittest

from programs import BIN, THIN_BAND, Case, models_of, run

TABLE = os.path.join(os.path.dirname(os.path.abspath(__file__)), os.pardir, os.pardir, "common", "paper",
                     "README.md")
# Number, function, and the cell that says how to reach it.
ROW = re.compile(r"^\| (\d+) \|[^|]*\| `(\w+)` \|[^|]*\|[^|]*\| ([^|]*) \|$", re.MULTILINE)
# A command, and a line of the scene's object that it needs.
CELL = re.compile(r"^`(spm-(?:bake|servo) [^`]+)`(?: with `([^`]+)`)?$")

TOP = 0.032  # m, half the height of models/box
EDGE = 0.024  # m, half its width
SPHERE = 0.05 / math.sqrt(3)  # m, radius of models/sphere
K = 1000  # N/m, of a replay without a device
BALL = 0.002  # m
F_C, K_F, K_D, NOISE = 0.2, 100, 2, 20e-6  # as the table's scenes have them
STEP = 2e-5  # m in a tick
# Depths of the hand under the box's top, m, and back; the first is above it.
DEPTHS = [-0.0012 + 1e-5 * i for i in range(300)]
# Where a tool is that stands on the box, beside its middle, m: nearly all of its face is pressed, and
# a small part.
BESIDE = [(0.004, 0.006), (0.028, 0.020)]


def rows():
    with open(TABLE, encoding="utf-8") as file:
        return [(int(number), name, cell) for number, name, cell in ROW.findall(file.read())]


def norm(a):
    return math.sqrt(sum(x * x for x in a))


def skin(depth, radius=BALL):
    """Mean of eq. 10 and 11, m, for a ball whose centre is that deep under a plane, by integration."""
    if depth < 0:
        area = radius ** 2 - depth ** 2
        return depth + 2 / 3 * (radius ** 3 + depth ** 3) / area
    return (radius ** 2 * depth + 2 * radius ** 3 / 3 + depth ** 3 / 3) / (radius ** 2 + depth ** 2)


class Equations(Case):
    @classmethod
    def setUpClass(cls):
        cls.work = models_of(cls, "box", "sphere")
        cls.cells = {number: cell for number, _, cell in rows()}
        cls.ran = {}
        with open(os.path.join(cls.work, "hand.txt"), "w", encoding="ascii") as file:
            for i, depth in enumerate(DEPTHS):
                file.write(f"{STEP * i - 0.003!r} 0.003 {TOP - depth!r}\n")
        with open(os.path.join(cls.work, "about.txt"), "w", encoding="ascii") as file:
            draw = random.Random(7)
            for _ in range(200):
                way = [draw.gauss(0, 1) for _ in range(3)]
                file.write(" ".join(repr((SPHERE - 3e-4) * x / norm(way)) for x in way) + "\n")
        with open(os.path.join(cls.work, "lower.txt"), "w", encoding="ascii") as file:
            for x, y in BESIDE:
                for depth in DEPTHS:
                    file.write(f"{x!r} {y!r} {2 * TOP - depth!r} 1 0 0 0\n")
        # What the other commands read: the table's own box, and a sphere whose few planes stand
        # askew to nearly all of it.
        cls.command(cls.cells[2])
        baked = run("build", "sphere.obj", "-o", "sphere.spm.exr", "--form", "full", "--planes", "20",
                    *THIN_BAND, "--quiet", folder=cls.work)
        assert baked.returncode == 0, baked.stderr

    @classmethod
    def command(cls, cell):
        """Runs a cell's command, once; gives the rows of the table that it writes, if it does."""
        if cell in cls.ran:
            return cls.ran[cell]
        command, line = CELL.match(cell).groups()
        words = shlex.split(command)
        if line:
            with open(os.path.join(cls.work, "scene.toml"), "w", encoding="utf-8") as file:
                file.write('[stabilization]\n[[object]]\nasset = "box.spm.exr"\n'
                           'method = "paper"\n'
                           + line.replace("; ", "\n") + "\n")
        result = run(*words[1:], program=os.path.join(BIN, words[0]), folder=cls.work)
        assert result.returncode == 0, f"{command}: {result.stderr}"
        felt = None
        if "--out" in words:
            with open(os.path.join(cls.work, words[words.index("--out") + 1]), newline="",
                      encoding="ascii") as file:
                felt = [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file)]
        cls.ran[cell] = felt
        return felt

    @classmethod
    def forces(cls, cell):
        return [tuple(row[key] for key in ("fx", "fy", "fz")) for row in cls.command(cell)]

    def felt(self, number):
        self.assertIsNotNone(self.command(self.cells[number]),
                             f"the command of eq. {number} writes no forces")
        felt = self.forces(self.cells[number])
        self.assertTrue(any(norm(force) > 0 for force in felt))
        return felt

    def test_each_equation_has_a_command(self):
        table = rows()
        self.assertEqual([number for number, _, _ in table], list(range(1, 20)))
        for number, _, cell in table:
            with self.subTest(equation=number):
                self.assertTrue(CELL.match(cell), cell)
        self.assertEqual(set(CHECKS), set(range(1, 20)))

    def test_the_command_of_each_equation_gives_what_the_equation_says(self):
        for number, check in CHECKS.items():
            with self.subTest(equation=number):
                self.command(self.cells[number])
                check(self, number)

    def maps_of_the_box(self, number):
        """Eq. 1 and 2: six planes, and a map of each."""
        words = shlex.split(CELL.match(self.cells[number]).group(1))
        asset = os.path.join(self.work, words[words.index("-o") + 1])
        report = self.run_json("info", asset)
        self.assertEqual(report["spm"]["form"], "full")
        self.assertEqual(report["spm"]["planes"], 6)
        self.assertEqual(report["spm"]["samples"] % 6, 0)

    def surface_of_the_box(self, _):
        """Eq. 4: each point of the surface that the maps describe lies on the box."""
        with open(os.path.join(self.work, "surface.ply"), encoding="ascii") as file:
            lines = file.read().splitlines()
        count = next(int(line.split()[-1]) for line in lines if line.startswith("element vertex"))
        begin = lines.index("end_header") + 1
        self.assertGreater(count, 1000)
        for line in lines[begin:begin + count]:
            x, y, z = map(float, line.split()[:3])
            off = max(abs(x) - EDGE, abs(y) - 0.03, abs(z) - TOP)
            self.assertLess(abs(off), 1e-6)

    def depth_as_a_force(self, number):
        """Eq. 3 and 9: the depth under the top, along its normal."""
        for force, depth in zip(self.felt(number), DEPTHS):
            self.assertAlmostEqual(norm(force), K * max(depth, 0), delta=1e-4)
            self.assertAlmostEqual(force[2], K * max(depth, 0), delta=1e-4)

    def slope_of_the_map(self, number):
        """Eq. 5 to 8: normals of a sphere from the slopes of maps on planes askew to it."""
        with open(os.path.join(self.work, "about.txt"), encoding="ascii") as file:
            points = [tuple(map(float, line.split())) for line in file]
        felt = self.felt(number)
        self.assertEqual(len(felt), len(points))
        for force, point in zip(felt, points):
            along = sum(f * p for f, p in zip(force, point)) / norm(force) / norm(point)
            # Facets of the mesh are half a degree wide, and where a ray meets the surface askew a
            # sample is wider still.
            self.assertGreater(along, math.cos(math.radians(2)))

    def mean_over_a_ball(self, number):
        """Eq. 10 and 11, from above the box to wholly in it."""
        for force, depth in zip(self.felt(number), DEPTHS):
            self.assertAlmostEqual(force[2], K * skin(depth), delta=0.03 * K * skin(depth) + 1e-3)
            self.assertLess(math.hypot(force[0], force[1]), 1e-6)

    def pressed(self, number):
        """Where a tool is beside the box's middle, how deep, what it feels, and the face in common."""
        felt = self.command(self.cells[number])
        places = [(beside, depth) for beside in BESIDE for depth in DEPTHS]
        self.assertEqual(len(felt), len(places))
        for (beside, depth), row in zip(places, felt):
            yield beside, depth, row, (2 * EDGE - beside[0]) * (0.06 - beside[1])

    def depth_of_a_face(self, number):
        """Eq. 13: f is the depth of the tool's face, the same at every place of it."""
        for _, depth, row, _ in self.pressed(number):
            self.assertAlmostEqual(row["depth"], max(depth, 0), delta=1e-7)

    def volume_of_two_boxes(self, number):
        """Eq. 12, 14 and 15: the force by the volume, at the middle of the volume. A face that is at
        least a sixteenth of the tool's sides is pushed by the depth, one that is less by the volume."""
        sides = 8 * (EDGE * 0.03 + 0.03 * TOP + TOP * EDGE) / 16
        self.assertLess((2 * EDGE - BESIDE[1][0]) * (0.06 - BESIDE[1][1]), sides)
        for beside, depth, row, face in self.pressed(number):
            wanted = K * max(depth, 0) * min(1, face / sides)
            # A map's sample is 1.1 mm wide, and the face in common 20 mm and more.
            self.assertAlmostEqual(row["fz"], wanted, delta=0.08 * wanted + 1e-9)
            self.assertAlmostEqual(row["tx"], -beside[1] / 2 * row["fz"], delta=6e-4 * row["fz"])
            self.assertAlmostEqual(row["ty"], beside[0] / 2 * row["fz"], delta=6e-4 * row["fz"])
            self.assertEqual((row["fx"], row["fy"]), (0, 0))

    def test_two_balls_feel_the_lens_that_they_share(self):
        scene = self.write("balls.toml", "".join(
            f"{table}\nasset = \"{os.path.join(self.work, 'sphere.spm.exr')}\"\n"
            for table in ("[tool]", "[stabilization]\n[[object]]\nmethod = \"paper\"")))
        overlap = 0.004
        apart = 2 * SPHERE - overlap
        # Along two planes of the balls that look at one another.
        path = self.write("apart.txt", " ".join([repr(apart / math.sqrt(3))] * 3) + "\n")
        out = self.path("balls.csv")
        replayed = run("replay", path, "--scene", scene, "--out", out, program=os.path.join(BIN, "spm-servo"))
        self.assertEqual(replayed.returncode, 0, replayed.stderr)
        with open(out, newline="", encoding="ascii") as file:
            row = {key: float(value) for key, value in next(csv.DictReader(file)).items()}
        lens = math.pi / 12 * (4 * SPHERE + apart) * overlap ** 2
        disc = math.pi * (SPHERE ** 2 - apart ** 2 / 4)
        sides = 24 * SPHERE ** 2 / 16
        self.assertLess(disc, sides)
        self.assertAlmostEqual(row["depth"], lens / disc, delta=0.02 * lens / disc)
        force = norm((row["fx"], row["fy"], row["fz"]))
        self.assertAlmostEqual(force, K * lens / sides, delta=0.1 * K * lens / sides)
        # The lens lies between the middles, to a third of a map's sample.
        self.assertLess(norm((row["tx"], row["ty"], row["tz"])), 3e-4 * force)

    def smoothed_edge(self, number):
        """Eq. 16: an edge that a map sees moves in, and the middle of a face stays."""
        words = shlex.split(CELL.match(self.cells[number]).group(1))
        asset = words[words.index("-o") + 1]
        plain = [word for word in words[1:] if "gaussian" not in word and word != "--smooth-maps"]
        plain[plain.index(asset)] = os.path.join(self.work, "plain.spm.exr")
        plain[plain.index("box.obj")] = os.path.join(self.work, "box.obj")
        self.assertEqual(run(*plain).returncode, 0)
        paths = {"edge": (EDGE - 4e-4, 0.003, TOP - 4e-4), "face": (0.001, 0.003, TOP - 1e-4)}
        felt = {}
        for name, point in paths.items():
            path = self.write("point.txt", " ".join(map(repr, point)) + "\n")
            for form in ("plain.spm.exr", asset):
                out = self.path("point.csv")
                replayed = run("replay", path, "--asset", os.path.join(self.work, form), "--method",
                               "paper", "--out", out, program=os.path.join(BIN, "spm-servo"))
                self.assertEqual(replayed.returncode, 0, replayed.stderr)
                with open(out, newline="", encoding="ascii") as file:
                    felt[name, form] = float(next(csv.DictReader(file))["depth"])
        self.assertGreater(felt["edge", "plain.spm.exr"], 5e-5)
        self.assertAlmostEqual(felt["face", "plain.spm.exr"], 1e-4, delta=1e-5)
        self.assertAlmostEqual(felt["face", asset], felt["face", "plain.spm.exr"], delta=1e-6)
        self.assertEqual(felt["edge", asset], 0)

    def friction(self, number):
        """Eq. 17: against the motion, and more of it at depth."""
        felt = self.felt(number)
        way = (STEP, 0, -1e-5)
        for force, depth in list(zip(felt, DEPTHS))[1:]:
            if depth < 1e-5:
                continue
            size = F_C * (1 + K_F * depth)
            self.assertAlmostEqual(force[0], -size * way[0] / norm(way), delta=1e-5)
            self.assertAlmostEqual(force[2], K * depth - size * way[2] / norm(way), delta=1e-4)

    def sum_of_three(self, number):
        """Eq. 18: reaction, friction, and damping by the velocity of P_M."""
        felt = self.felt(number)
        way = (STEP, 0, -1e-5)
        for force, depth in list(zip(felt, DEPTHS))[1:]:
            if depth < 1e-5:
                continue
            wanted = -F_C * (1 + K_F * depth) * way[0] / norm(way) - K_D * STEP / 1e-3
            self.assertAlmostEqual(force[0], wanted, delta=1e-5)

    def noise(self, number):
        """Eq. 19: the map is off by a noise of that deviation at its samples, and bilinear between."""
        def along_the_way(cell):
            return [force[2] / K - depth for force, depth in zip(self.forces(cell), DEPTHS)
                    if depth > 2e-4]
        noises = along_the_way(self.cells[number])
        bends = [abs(a - 2 * b + c) for a, b, c in zip(noises, noises[1:], noises[2:])]
        # The hand passes a few samples, and the noise is straight from one to the next.
        self.assertGreater(max(bends), 1e-8)
        self.assertLess(sum(bend > 1e-9 for bend in bends), len(bends) / 5)
        drawn = []
        for seed in range(40):
            drawn += along_the_way(self.cells[number].replace("seed = 3", f"seed = {seed}"))[::20]
        self.assertLess(abs(sum(drawn) / len(drawn)), 0.25 * NOISE)
        # Between four samples it is down to a half, in the mean over a line up to 0.82.
        spread = math.sqrt(sum(x * x for x in drawn) / len(drawn))
        self.assertTrue(0.4 * NOISE < spread < 0.95 * NOISE, spread / NOISE)

    def test_the_form_over_the_volume_is_the_mean_depth_of_what_is_in_the_box(self):
        felt = self.forces(self.cells[11][:-1] + " --paper-probe volume`")
        for force, depth in list(zip(felt, DEPTHS))[::20]:
            # Slices of the ball at the depth t, by the midpoint rule.
            area = moment = 0
            for i in range(2000):
                t = (i + 0.5) / 2000 * (depth + BALL)
                slice_area = max(BALL ** 2 - (t - depth) ** 2, 0)
                area, moment = area + slice_area, moment + t * slice_area
            self.assertAlmostEqual(force[2], K * moment / area, delta=0.03 * K * moment / area + 1e-3)

    def test_a_capsule_presses_as_its_lower_end_does(self):
        """It stands along the hand's z axis, so that its end is half of its length below the hand."""
        with open(os.path.join(self.work, "above.txt"), "w", encoding="ascii") as file:
            for depth in DEPTHS:
                file.write(f"0.001 0.003 {TOP - depth + 0.004!r}\n")
        command = self.cells[11].replace("hand.txt", "above.txt")
        felt = self.forces(command.replace("sphere:2mm", "capsule:2mm,8mm"))
        for force, depth in zip(felt, DEPTHS):
            if depth <= 0:
                self.assertAlmostEqual(force[2], K * skin(depth), delta=0.03 * K * skin(depth) + 1e-3)
            else:
                # Its cylinder is in the box, and nothing of its upper side.
                self.assertAlmostEqual(force[2], K * (depth + 2 * BALL / 3), delta=0.03 * force[2])


CHECKS = {1: Equations.maps_of_the_box, 2: Equations.maps_of_the_box,
          3: Equations.depth_as_a_force, 4: Equations.surface_of_the_box,
          5: Equations.slope_of_the_map, 6: Equations.slope_of_the_map,
          7: Equations.slope_of_the_map, 8: Equations.slope_of_the_map,
          9: Equations.depth_as_a_force, 10: Equations.mean_over_a_ball,
          11: Equations.mean_over_a_ball, 12: Equations.volume_of_two_boxes,
          13: Equations.depth_of_a_face, 14: Equations.volume_of_two_boxes,
          15: Equations.volume_of_two_boxes, 16: Equations.smoothed_edge, 17: Equations.friction,
          18: Equations.sum_of_three, 19: Equations.noise}


if __name__ == "__main__":
    unittest.main()
