#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""scripts/tool_scenes: the peg in its hole is baked, run, replayed and drawn. It needs no shared mesh."""

import json
import os
import shutil
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree

from programs import BIN, Case

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), os.pardir, os.pardir)
SECONDS = 3  # the peg touches the hole's edge after 1.3 s, and its floor after 2.1 s
DRAWS = os.path.exists("/usr/bin/python3") and subprocess.run(
    ["/usr/bin/python3", "-c", "import matplotlib, numpy"], capture_output=True, check=False).returncode == 0


def scenes(out, *options, programs=BIN):
    """Runs the script. For meshes it looks where there are none."""
    return subprocess.run([sys.executable, os.path.join(ROOT, "scripts", "tool_scenes"), "--out", out,
                           "--programs", programs, "--meshes", os.path.join(out, "none"), *options],
                          capture_output=True, text=True, timeout=300, check=False)


class ToolScenes(Case):
    @classmethod
    def setUpClass(cls):
        cls.out = tempfile.mkdtemp(prefix="spm-e2e-scenes-")
        cls.addClassCleanup(shutil.rmtree, cls.out, ignore_errors=True)
        cls.told = scenes(cls.out)

    def scenes(self, *options, programs=BIN):
        """In the folder where everything is baked already."""
        return scenes(self.out, *options, programs=programs)

    def check_report(self):
        """What was felt is told, and was felt again."""
        with open(os.path.join(self.out, "tool-scenes.json"), encoding="utf-8") as file:
            rows = json.load(file)["scenes"]
        self.assertEqual([row["scene"] for row in rows], ["peg-in-hole"])
        row = rows[0]
        self.assertEqual(row["device"], "sim:profile=omega3,path=peg.path")
        self.assertAlmostEqual(row["seconds"], SECONDS, 0)
        self.assertGreater(row["contact_ticks"], 100)
        self.assertGreater(row["force_max_n"], 0.1)
        self.assertGreater(row["torque_max_n_m"], 1e-4)
        self.assertGreater(row["depth_max_m"], 1e-5)
        self.assertEqual(row["compared_forces"], row["ticks"])
        self.assertEqual((row["differing_forces"], row["largest_difference_n"],
                          row["largest_difference_n_m"]), (0, 0, 0))

    def check_drawings(self):
        for name in ("peg-in-hole.svg", "peg-in-hole-tool.svg"):
            root = xml.etree.ElementTree.parse(os.path.join(self.out, name)).getroot()
            self.assertEqual(root.tag, "{http://www.w3.org/2000/svg}svg")
        with open(os.path.join(self.out, "peg-in-hole-tool.png"), "rb") as file:
            self.assertEqual(file.read(8), b"\x89PNG\r\n\x1a\n")

    def check_a_part(self):
        """Of the recording's drawing, as scripts/measure puts it on a page."""
        script = os.path.join(ROOT, "scripts", "charts", "plot_recording.py")
        for words, code in ((("--from", "1", "--to", "2"), 0), (("--from", "100"), 1)):
            result = subprocess.run(["/usr/bin/python3", "-B", script,
                                     os.path.join(self.out, "peg-in-hole.rec"), *words, "-o",
                                     self.path("part")], capture_output=True, text=True, check=False)
            self.assertEqual(result.returncode, code, result.stderr)
        self.assertTrue(os.path.exists(self.path("part.png")))
        self.assertIn("has no tick from --from to --to; it is from 0 s to ", result.stderr)

    def test_the_peg_is_felt_felt_again_and_drawn(self):
        result = self.scenes("--run", str(SECONDS), "--picture")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("has no drill.obj, so drill-on-teeth is left out", result.stderr)
        self.assertEqual(len(result.stdout.splitlines()), 1, result.stdout)
        self.assertTrue(result.stdout.startswith("peg-in-hole: "), result.stdout)
        self.check_report()
        if not DRAWS:
            self.assertIn("matplotlib is missing, so the drawings are left out", result.stderr)
            self.skipTest("matplotlib is missing, so nothing is drawn")
        self.check_drawings()
        self.check_a_part()

    def test_a_replay_that_gives_another_force_is_refused(self):
        """A stand-in for spm-servo, whose replay finds that one force differs."""
        programs = self.output_folder("programs")
        os.symlink(os.path.join(BIN, "spm-bake"), os.path.join(programs, "spm-bake"))
        script = self.write("programs/spm-servo", f"""#!{sys.executable}
import json, subprocess, sys
done = subprocess.run([{os.path.join(BIN, "spm-servo")!r}, *sys.argv[1:]], stdout=subprocess.PIPE)
if sys.argv[1] != "replay":
    sys.stdout.buffer.write(done.stdout)
    sys.exit(done.returncode)
report = json.loads(done.stdout)
report["recording"].update(forces_equal=False, differing_ticks=1, largest_difference_n=0.5)
print(json.dumps(report))
sys.exit(10)
""")
        os.chmod(script, 0o755)
        result = self.scenes("--run", "0.2", programs=programs)
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertRegex(result.stderr.splitlines()[-1],
                         r"^scripts/tool_scenes: the replay gives other forces than the recording has: "
                         r"1 of \d+ forces of peg-in-hole$")

    def test_without_run_it_tells_how_each_is_run(self):
        self.assertEqual(self.told.returncode, 0, self.told.stderr)
        lines = self.told.stdout.splitlines()
        self.assertEqual(len(lines), 1, self.told.stdout)
        self.assertIn("spm-servo run --scene ", lines[0])

    def test_bad_input_is_refused_in_one_sentence(self):
        empty = self.output_folder("empty")
        half = self.output_folder("half")
        shutil.copy(os.path.join(BIN, "spm-bake"), half)
        with open(os.path.join(half, "spm-servo"), "w", encoding="ascii"):
            pass  # no program: it may not be run
        for programs, name in ((empty, "spm-bake"), (half, "spm-servo"), (self.path("nowhere"), "spm-bake")):
            with self.subTest(programs=programs):
                result = self.scenes("--run", "1", programs=programs)
                self.assertEqual((result.returncode, result.stdout), (1, ""), result.stderr)
                self.assertEqual(result.stderr.splitlines(),
                                 [f"scripts/tool_scenes: {programs} has no program {name}; build it with "
                                  "scripts/build, or name the folder of built programs with --programs"])
        for options, words in ((("--run", "0"), "--run must be above 0"),
                               (("--run", "nan"), "--run must be above 0"),
                               (("--picture",), "--picture draws what was felt")):
            with self.subTest(options=options):
                result = self.scenes(*options)
                self.assertEqual((result.returncode, result.stdout), (2, ""), result.stderr)
                self.assertIn(words, result.stderr)


if __name__ == "__main__":
    unittest.main()
