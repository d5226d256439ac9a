#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""spm-bench as a user runs it. The bakes are left out: they take their time."""

import json
import os
import subprocess
import tempfile
import unittest

BENCH = os.environ.get("SPM_BENCH", os.path.join(os.getcwd(), "bin", "spm-bench"))
BOX = """v 0 0 0\nv 2 0 0\nv 2 1 0\nv 0 1 0\nv 0 0 1\nv 2 0 1\nv 2 1 1\nv 0 1 1
f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8
"""
QUICK = ("raw-mesh", "embree")  # in no time


def run(*arguments, shared=None):
    environment = {**os.environ, "LC_ALL": "C.UTF-8"}
    if shared is not None:
        environment["SPM_SHARED"] = shared
    return subprocess.run([BENCH, *arguments], capture_output=True, text=True, env=environment,
                          timeout=300, check=False)


class Bench(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="spm-bench-test-")
        self.addCleanup(folder.cleanup)
        self.folder = folder.name
        self.mesh = os.path.join(folder.name, "box.obj")
        with open(self.mesh, "w", encoding="ascii") as file:
            file.write(BOX)


class Bytes(Bench):
    def bytes(self, *arguments, methods=QUICK):
        methods = [word for name in methods for word in ("--method", name)]
        return run("bytes", "--mesh", self.mesh, "--samples", "500", *methods, *arguments)

    def test_json_is_one_object_with_a_row_a_method_and_setting(self):
        result = self.bytes("--json", methods=("embree", "triangle-grid", "raw-mesh"))
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(result.stderr, "")
        report = json.loads(result.stdout)
        self.assertTrue(report["made"]["command"].startswith("spm-bench bytes --mesh box.obj"))
        self.assertEqual([mesh["mesh"] for mesh in report["meshes"]], ["box"])
        self.assertEqual([(row["method"], row["settings"]) for row in report["rows"]],
                         [("raw-mesh", "floats"), ("triangle-grid", "cell 2 mm"),
                          ("triangle-grid", "cell 2 mm, shared"), ("triangle-grid", "cell 1 mm"),
                          ("triangle-grid", "cell 1 mm, shared"), ("embree", "compact"),
                          ("embree", "default")])
        for row in report["rows"]:
            self.assertGreater(row["file_bytes"], 0)
            self.assertGreater(row["resident_bytes"], 0)
            self.assertEqual(row["bytes"], row["resident_bytes"])
            self.assertLess(row["depth_error_um"]["max"], 0.05)
            self.assertEqual(row["misclassified"], 0)
            self.assertEqual(row["unanswered"], 0)
        self.assertIn("processor", report["made"]["machine"])

    def test_figures_do_not_depend_on_threads(self):
        reports = []
        for threads in ("1", "2"):
            report = json.loads(self.bytes("--json", "--threads", threads).stdout)
            for row in report["rows"]:
                row.pop("build_seconds")
                row.pop("open_seconds")
                if row["method"] == "embree":  # its builder's memory does
                    row.pop("bytes")
                    row.pop("resident_bytes")
            report["made"].pop("command")
            reports.append(report)
        self.assertEqual(*reports)

    def test_the_table_names_mesh_methods_and_settings(self):
        result = self.bytes()
        self.assertEqual(result.returncode, 0, result.stderr)
        for word in ("box: 12 triangles", "embree", "compact", "raw-mesh"):
            self.assertIn(word, result.stdout)
        self.assertEqual(self.bytes("--quiet").stdout, "")

    def test_wrong_words_are_told(self):
        for arguments, words in ((("--method", "magic"), "write one of"),
                                 (("--tolerance", "3"), "unit"),
                                 (("--tolerance", "0um"), "above 0"),
                                 (("--meshes", "x"), "--mesh")):
            with self.subTest(arguments):
                result = self.bytes(*arguments)
                self.assertEqual(result.returncode, 1, result.stderr)
                self.assertIn(words, result.stderr)
                self.assertEqual(result.stderr.count("\n"), 1)

    def test_missing_files_are_told(self):
        result = run("bytes", "--mesh", os.path.join(self.folder, "none.obj"))
        self.assertEqual(result.returncode, 2)
        self.assertIn("none.obj", result.stderr)
        result = run("bytes", shared=os.path.join(self.folder, "nowhere"))
        self.assertEqual(result.returncode, 2)
        self.assertIn("SPM_SHARED", result.stderr)

    def test_it_explains_itself(self):
        for arguments in ((), ("bytes",), ("forces",), ("methods",), ("stability",), ("tables",)):
            result = run(*arguments, "--help")
            self.assertEqual(result.returncode, 0)
            self.assertIn("Usage: " + " ".join(("spm-bench", *arguments)), result.stdout)
        self.assertRegex(run("--version").stdout, r"spm-bench \d+\.\d+\.\d+\n")


class Sixdof(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="spm-bench-test-")
        self.addCleanup(folder.cleanup)
        self.mesh = os.path.join(folder.name, "box.obj")
        with open(self.mesh, "w", encoding="ascii") as file:
            file.write(BOX)

    def sixdof(self, *arguments):
        return run("sixdof", "--tool", self.mesh, "--mesh", self.mesh, "--quick", "--ticks", "200",
                   "--samples", "2000", *arguments)

    def test_json_has_a_row_a_method_and_scenes_of_culling(self):
        result = self.sixdof("--json")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(result.stderr, "")
        report = json.loads(result.stdout)
        # Each of the servo's laws along the slide, without and with a limit, and one along the deep path.
        rows = {}
        for row in report["rows"]:
            rows.setdefault(row["method"], []).append(row)
        self.assertEqual({method: len(of_method) for method, of_method in rows.items()},
                         {"spm": 2, "served-spm": 3, "served-proxy": 2, "every-sample": 1, "fcl": 1,
                          "bullet": 1})
        self.assertEqual(report["ticks"], 200)
        for row in report["rows"]:
            self.assertGreater(row["p99_us"], 0)
            self.assertGreater(row["contacts"], 0)
        for row in rows["spm"] + rows["every-sample"]:  # the same samples, culled and not
            self.assertLess(row["force_error_percent"]["median"], 20)
        self.assertIsNone(rows["fcl"][0]["force_error_percent"])
        for row in report["culling"]:
            self.assertLessEqual(row["hulls_touch"], row["after_spm"])
            self.assertLessEqual(row["after_spm"], row["after_aabb"])

    def test_wrong_words_are_told(self):
        for arguments, words in ((("--samples", "3"), "100 to"), (("--tolerance", "0um"), "above 0")):
            with self.subTest(arguments):
                result = run("sixdof", "--tool", self.mesh, "--mesh", self.mesh, *arguments)
                self.assertEqual(result.returncode, 1, result.stderr)
                self.assertIn(words, result.stderr)


class Methods(Bench):
    def methods(self, *arguments, methods):
        methods = [word for name in methods for word in ("--method", name)]
        return run("methods", "--quick", "--mesh", self.mesh, "--samples", "500", *methods,
                   *arguments)

    def test_json_has_a_row_a_method_with_times_and_errors(self):
        names = ("embree", "cgal-aabb", "fcl", "bullet", "mesh-proxy", "triangle-grid")
        result = self.methods("--json", methods=names)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(result.stderr, "")
        report = json.loads(result.stdout)
        self.assertEqual({row["method"] for row in report["rows"]}, set(names))
        for row in report["rows"]:
            self.assertEqual(set(row["ns"]), {"hot", "hot_p99", "random", "cold"})
            self.assertGreater(row["ns"]["hot"], 0)
            self.assertGreater(row["file_bytes"], 0)
            self.assertGreater(row["resident_bytes"], 0)
            self.assertGreater(row["build_seconds"] + row["open_seconds"], 0)
            self.assertEqual(row["misclassified"], 0)
            if row["method"] != "mesh-proxy":
                self.assertEqual(row["errors_on"], "places")
                self.assertLess(row["depth_error_um"]["max"], 0.05)
                self.assertEqual(row["unanswered"], 0)
            else:
                self.assertEqual(row["errors_on"], "path")
        self.assertEqual({row["method"] for row in report["probe_rows"]}, {"fcl", "bullet"})
        for row in report["probe_rows"]:
            self.assertGreater(row["ns"]["hot"], 0)
            self.assertEqual(row["missed_contacts"], 0)
        self.assertEqual(report["ratios"], [])  # spm was left out
        self.assertIn("processor", report["made"]["machine"])

    def test_the_table_names_methods(self):
        result = self.methods(methods=("embree", "mesh-proxy"))
        self.assertEqual(result.returncode, 0, result.stderr)
        for word in ("box: 12 triangles", "embree", "brute force, force shading"):
            self.assertIn(word, result.stdout)

    def test_wrong_words_are_told(self):
        result = self.methods(methods=("magic",))
        self.assertEqual(result.returncode, 1)
        self.assertIn("write one of spm, paper", result.stderr)


class Forces(Bench):
    def forces(self, *arguments):
        return run("forces", "--quick", "--mesh", self.mesh, "--ticks", "300", *arguments)

    def test_json_has_a_row_a_method_and_traces_a_line_a_tick(self):
        result = self.forces("--json", "--traces", self.folder)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(result.stderr, "")
        report = json.loads(result.stdout)
        self.assertEqual([(row["method"], row["probe_radius_m"]) for row in report["rows"]],
                         [("paper", 0), ("spm", 0), ("spm", 0), ("proxy", 0), ("proxy", 0.0005)])
        self.assertEqual({row["path"] for row in report["rows"]}, {"walked"})
        self.assertEqual([row["turn_limit_rad_per_s"] for row in report["rows"]],
                         [None, None, 120, None, None])
        spm = report["rows"][1]
        self.assertLess(spm["relative_difference"], 0.05)
        self.assertLess(spm["excess_step_n"]["p999"], 0.15)
        self.assertEqual(spm["missing_ticks"], 0)
        for path in report["paths"]:
            self.assertEqual(path["ticks"], 300)
            self.assertGreater(path["judged_ticks"], 100)
        self.assertIn("processor", report["made"]["machine"])
        with open(os.path.join(self.folder, "box-walked.csv"), encoding="ascii") as file:
            lines = file.read().splitlines()
        self.assertEqual(len(lines), 301)
        self.assertIn("spm_x,spm_y,spm_z,spm_limited_x", lines[0])

    def test_figures_do_not_depend_on_threads(self):
        outputs = [self.forces("--json", "--threads", threads).stdout for threads in ("1", "2")]
        self.assertEqual(*[json.loads(output)["rows"] for output in outputs])

    def test_wrong_words_are_told(self):
        for arguments, words in ((("--tolerance", "0um"), "above 0"), (("--ticks", "3"), "100 to"),
                                 (("--traces", "/nowhere/at/all"), "--traces")):
            with self.subTest(arguments):
                result = run("forces", "--mesh", self.mesh, *arguments)
                self.assertEqual(result.returncode, 1, result.stderr)
                self.assertIn(words, result.stderr)
        result = run("forces", shared=os.path.join(self.folder, "nowhere"))
        self.assertEqual(result.returncode, 2)
        self.assertIn("SPM_SHARED", result.stderr)


class Stability(unittest.TestCase):
    """One small case on one profile; the whole catalogue takes its time."""

    def stability(self, *arguments, shared=None):
        return run("stability", "--quick", "--case", "plate-500um-at-50-mm-s", "--method",
                   "exact-penalty", "--method", "proxy", *arguments, shared=shared)

    def test_a_method_that_takes_part_in_no_chosen_case_is_told(self):
        result = run("stability", "--quick", "--case", "tool-rests-a-minute", "--method", "paper", "--part",
                     "theory")
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertIn("--method paper: takes part in none of the chosen cases", result.stderr)

    def test_json_has_a_row_a_case_method_device_and_stiffness_and_traces_a_line_a_tick(self):
        with tempfile.TemporaryDirectory(prefix="spm-bench-test-") as folder:
            result = self.stability("--json", "--traces", folder)
            self.assertEqual(result.returncode, 0, result.stderr)
            self.assertEqual(result.stderr, "")
            report = json.loads(result.stdout)
            with open(os.path.join(folder, "exact-penalty.csv"), encoding="ascii") as file:
                self.assertGreater(len(file.read().splitlines()), 1000)
        self.assertEqual([(row["method"], row["device"], row["fraction"])
                          for row in report["cases"]],
                         [("exact-penalty", "low", 0.6), ("exact-penalty", "low", 1.7),
                          ("proxy", "low", 0.6), ("proxy", "low", 1.7)])
        for row in report["cases"]:
            self.assertEqual(row["stable"], row["reason"] == "")
            self.assertGreaterEqual(row["energy_generated_j"], 0)
        self.assertTrue(report["cases"][0]["popped"])  # a plate thinner than the penalty's reach
        self.assertFalse(report["cases"][2]["popped"])
        self.assertEqual({row["kind"] for row in report["theory"]} >= {"stability", "passivity"},
                         True)
        self.assertIn("processor", report["made"]["machine"])

    def test_figures_do_not_depend_on_threads(self):
        reports = [json.loads(self.stability("--json", "--threads", threads).stdout)
                   for threads in ("1", "2")]
        for report in reports:
            report["made"].pop("command")
        self.assertEqual(*reports)

    def test_a_named_part_is_measured_and_no_other(self):
        result = self.stability("--json", "--part", "theory")
        self.assertEqual(result.returncode, 0, result.stderr)
        report = json.loads(result.stdout)
        for part, is_there in (("cases", True), ("flat_borders", True), ("theory", True),
                               ("borders", False), ("loops", False), ("maps", False),
                               ("costs", False)):
            self.assertEqual(bool(report[part]), is_there, part)

    def test_phases_are_told_where_asked_for(self):
        result = self.stability("--json", "--part", "theory", "--verbose")
        self.assertEqual(result.returncode, 0, result.stderr)
        json.loads(result.stdout)
        for phase in ("preparing plate-500um-at-50-mm-s", "flat borders", "cases", "theory"):
            self.assertRegex(result.stderr, r"(?m)^info: after \d+ s: " + phase)

    def test_the_table_names_cases_and_methods(self):
        result = self.stability()
        self.assertEqual(result.returncode, 0, result.stderr)
        for word in ("plate-500um-at-50-mm-s", "exact-penalty", "at 0.6 of"):
            self.assertIn(word, result.stdout)

    def test_wrong_words_are_told_with_the_nearest_valid_one(self):
        for arguments, words in ((("--case", "flat-wal"), "did you mean flat-wall?"),
                                 (("--method", "poxy"), "did you mean proxy?"),
                                 (("--device", "omega"), "did you mean omega3?"),
                                 (("--method", "magic-of-all-sorts"), "write one of"),
                                 (("--part", "border"), "did you mean borders?"),
                                 (("--traces", "/nowhere/at/all"), "--traces")):
            with self.subTest(arguments):
                result = self.stability(*arguments)
                self.assertEqual(result.returncode, 1, result.stderr)
                self.assertIn(words, result.stderr)


class Tables(Bench):
    def test_missing_files_are_told(self):
        result = run("tables", shared=os.path.join(self.folder, "nowhere"))
        self.assertEqual(result.returncode, 2)
        self.assertIn("SPM_SHARED", result.stderr)
        self.assertEqual(run("tables", "--mesh", self.mesh).returncode, 1)


if __name__ == "__main__":
    unittest.main()
