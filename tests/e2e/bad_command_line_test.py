#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Command lines that cannot be obeyed: exit code 1 and one line that names the option."""

import os
import unittest

from programs import NOBODY, SERVO, TETRAHEDRON, THIN_BAND, Case, bake_box, obj, run

# Options of build after MESH and -o, and words that the message must have.
BUILD = [
    (["--tolerance", "50"], ["--tolerance: '50' has no unit: write a length such as 50um or 2mm"]),
    (["--tolerance", "50parsec"], ["--tolerance", "parsec", "um"]),
    (["--tolerance", "nanmm"], ["--tolerance", "finite"]),
    (["--tolerance", "0um"], ["--tolerance", "above 0"]),
    (["--tolerance=-50um"], ["--tolerance", "above 0"]),
    (["--tolerance", "50 um um"], ["--tolerance"]),
    (["--tolerance", "5,0um"], ["--tolerance"]),
    (["--tolerance"], ["--tolerance"]),
    (["--tolerance", "1mm", "--tolerance", "2mm"], ["--tolerance"]),
    (["--max-depth", "0mm"], ["--max-depth", "above 0"]),
    (["--max-depth", "2"], ["--max-depth", "unit"]),
    (["--margin=-1mm"], ["--margin"]),
    (["--margin", "1mm", "--probe", "sphere:2mm"], ["--margin", "probe"]),
    (["--probe", "cube:1mm"], ["--probe", "cube:1mm", "sphere:RADIUS"]),
    (["--probe", "sphere:1"], ["--probe", "unit"]),
    (["--probe", "sphere:0mm"], ["--probe"]),
    (["--form", "dense"], ["--form", "dense", "sparse or full"]),
    (["--kind", "edge", "--form", "full"], ["--kind", "edge"]),
    (["--planes", "100"], ["--planes", "--form full"]),
    (["--resolution", "65"], ["--resolution", "--form full"]),
    (["--layers", "scalar"], ["--layers", "--form full"]),
    (["--kind", "face"], ["--kind", "--form full"]),
    (["--form", "full", "--tolerance", "50um"], ["--tolerance", "--form sparse"]),
    (["--form", "full", "--planes", "3"], ["--planes", "'3'", "4"]),
    (["--form", "full", "--planes", "many"], ["--planes", "'many'"]),
    (["--form", "full", "--resolution", "1"], ["--resolution", "'1'"]),
    (["--form", "full", "--resolution", "5000"], ["--resolution", "4097"]),
    (["--form", "full", "--layers", "0"], ["--layers", "'0'"]),
    (["--form", "full", "--layers", "256"], ["--layers", "255"]),
    (["--unit", "km"], ["--unit", "km", "mm"]),
    (["--fit-diagonal", "0mm"], ["--fit-diagonal"]),
    (["--fit-diagonal", "100"], ["--fit-diagonal", "unit"]),
    (["--threads", "0"], ["--threads", "'0'"]),
    (["--threads", "2.5"], ["--threads", "'2.5'"]),
    (["--seed=-1"], ["--seed", "'-1'"]),
    (["--color", "red"], ["--color", "red", "auto"]),
    (["--tolerence", "50um"], ["--tolerence", "did you mean --tolerance?"]),
    (["--scene"], ["--scene"]),
    (["--smooth", "edges"], ["--smooth", "edges"]),
    (["--time-limit", "0"], ["--time-limit", "'0'"]),
    (["--device", "falcn"], ["--device", "falcn", "low, falcon, touch, omega3 or wooden"]),
    (["--device", "falcon", "--form", "full"], ["--device", "--form sparse"]),
    (["--max-depth", "1m"], ["--max-depth", "1 m", "diagonal"]),
    (["--margin", "1m"], ["--margin", "1 m", "diagonal"]),
    (["--tolerance", "0.000001um"], ["finer than the floats", "--allow-inexact"]),
    (["another.obj"], ["another.obj"]),
]

# Whole command lines.
OTHERS = [
    ([], ["subcommand", "--help"]),
    (["bulid"], ["bulid", "build"]),
    (["build"], ["required"]),
    (["build", "a.obj"], ["--output"]),
    (["build", "-o", "a.spm.exr"], ["MESH"]),
    (["info"], ["FILE"]),
    (["info", "a.spm.exr", "--png-limit", "0"], ["--png-limit"]),
    (["verify", "a.spm.exr"], ["MESH"]),
    (["verify", "a.spm.exr", "a.obj", "--samples", "0"], ["--samples"]),
    (["verify", "a.spm.exr", "a.obj", "--samples", "1e5"], ["--samples"]),
    (["verify", "a.spm.exr", "a.obj", "--band", "2"], ["--band", "unit"]),
    (["verify", "a.spm.exr", "a.obj", "--band", "0mm"], ["--band"]),
    (["verify", "a.spm.exr", "a.obj", "--worst", "10001"], ["--worst", "10000"]),
    (["verify", "a.spm.exr", "a.obj", "--worst", "-1"], ["--worst"]),
    (["query", "a.spm.exr", "-o", "a.csv"], ["--points"]),
    (["query", "a.spm.exr", "--points", "a.txt"], ["--output"]),
    (["export", "a.spm.exr"], ["--output"]),
    (["batch"], ["MANIFEST"]),
    (["batch", "a.toml", "-j", "0"], ["-j", "1024"]),
    (["batch", "a.toml", "--shard", "3/2"], ["--shard", "3/2"]),
    (["batch", "a.toml", "--memory", "8"], ["--memory", "unit"]),
    (["merge", "a.toml"], ["RESULT"]),
    (["cache", "stats"], ["DIR"]),
    (["cache", "empty", "c"], ["empty", "prune"]),
]


class BadCommandLine(Case):
    def test_an_option_of_build_that_cannot_be_obeyed_is_a_usage_error(self):
        mesh = self.write("a.obj", obj(TETRAHEDRON))
        out = self.output_folder()
        for options, names in BUILD:
            with self.subTest(" ".join(options)):
                result = run("build", mesh, "-o", os.path.join(out, "a.spm.exr"), *options)
                self.expect_refusal(result, 1, *names)
                self.assertEqual(os.listdir(out), [])

    def test_a_command_line_that_cannot_be_obeyed_is_a_usage_error(self):
        for arguments, names in OTHERS:
            with self.subTest(" ".join(arguments)):
                self.expect_refusal(run(*arguments, folder=self.folder), 1, *names)

    def test_a_probe_that_cannot_be_served_is_refused_with_the_cure(self):
        bake_box(self, "--form", "full", "--resolution", "9", "--probe", "sphere:0.5mm", *THIN_BAND[:2])
        path = self.write("path.txt", "0 0 0.032\n")
        for options, code, names in (
                (["--probe", "capsule:0.5mm,5mm", "--method", "spm"], 1,
                 ["method spm knows no probe but a point and a sphere", "method paper", "sphere:500 um"]),
                (["--probe", "capsule:0.5mm,5mm"], 1, ["method proxy knows no probe"]),
                (["--probe", "capsule:0.5mm", "--method", "paper"], 1,
                 ["--probe", "capsule:RADIUS,LENGTH"]),
                (["--probe", "capsule:-1mm,5mm", "--method", "paper"], 1, ["--probe", "above 0"]),
                (["--probe", "sphere:-1mm", "--method", "paper"], 1, ["--probe", "above 0"]),
                (["--probe", "capsule:1mm,0mm", "--method", "paper"], 1, ["--probe", "above 0"]),
                (["--paper-probe", "skin"], 1, ["--paper-probe", "surface or volume"]),
                (["--paper-probe", "volume", "--method", "paper"], 1, ["a point has no volume"]),
                (["--probe", "sphere:0.5mm", "--method", "paper", "--paper-rule", "all-planes"], 1,
                 ["rule all-planes is for a point"]),
                (["--probe", "capsule:1mm,5mm", "--method", "paper"], 3,
                 ["baked for probe sphere:500 um", "capsule:1 mm,5 mm", "bake the mesh again"])):
            with self.subTest(" ".join(options)):
                result = run("replay", path, "--out", self.write("out.csv", ""), "--asset", self.asset,
                             *options, program=SERVO)
                self.expect_refusal(result, code, *names)

    def test_an_asset_or_a_scene_without_its_option_asks_whether_that_was_meant(self):
        for words, meant in ((["run", "a.spm.exr"], "did you mean --asset a.spm.exr?"),
                             (["run", "a.toml"], "did you mean --scene a.toml?"),
                             (["replay", "path.txt", "a.spm.exr"], "did you mean --asset a.spm.exr?")):
            with self.subTest(" ".join(words)):
                self.expect_refusal(run(*words, program=SERVO), 1, meant)

    def test_a_time_that_is_none_says_how_one_is_written(self):
        for text in ("long", "1 parsec", "0s", "-1s", "nan", "1e9min"):
            with self.subTest(text):
                result = run("run", "--asset", "a.spm.exr", f"--duration={text}", program=SERVO)
                self.expect_refusal(result, 1, "--duration", f"'{text}'", "500ms, 10s or 2min")

    def test_a_table_of_forces_is_no_trajectory_and_says_what_to_replay(self):
        table = self.write("trace.csv", "t,x,y,z,fx,fy,fz,tx,ty,tz,depth,contact\n"
                                        "0.001,0,0,0,0,0,0,0,0,0,0,0\n")
        result = run("replay", table, "--asset", "a.spm.exr", "--out", self.path("out.csv"), program=SERVO)
        self.expect_refusal(result, 3, table, "a table of forces", "--record", "cut -d, -f2-4")

    def test_an_unknown_option_of_the_servo_is_a_usage_error(self):
        self.expect_refusal(run("run", "--no-such-option", program=SERVO), 1, "--no-such-option")

    def test_an_output_that_cannot_be_written_is_found_before_the_bake(self):
        mesh = self.write("a.obj", obj(TETRAHEDRON))
        closed = self.output_folder("closed")
        os.chmod(closed, 0o555)
        user = NOBODY if os.geteuid() == 0 else None
        for what, output in (("a directory", self.folder),
                             ("a file as folder", os.path.join(mesh, "a.spm.exr")),
                             ("no permission", os.path.join(closed, "a.spm.exr")),
                             ("no permission for a folder", os.path.join(closed, "b/c", "a.spm.exr"))):
            with self.subTest(what):
                result = run("build", mesh, "-o", output, "--tolerance", "1mm", user=user)
                self.expect_refusal(result, 2, closed if "permission" in what else output)
        # Before the bake also means before the mesh is read.
        result = run("build", self.path("missing.obj"), "-o", os.path.join(mesh, "a.spm.exr"))
        self.expect_refusal(result, 2, "a.obj")

    def test_a_mesh_is_not_overwritten_by_its_own_asset(self):
        mesh = self.write("a.obj", obj(TETRAHEDRON))
        self.expect_refusal(run("build", mesh, "-o", mesh), 1, "a.obj")
        with open(mesh, encoding="utf-8") as file:
            self.assertEqual(file.read(), obj(TETRAHEDRON))


if __name__ == "__main__":
    unittest.main()
