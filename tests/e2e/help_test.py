#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What both programs say of themselves."""

import os
import re
import unittest

from programs import BAKE, SERVO, run


ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), os.pardir, os.pardir)


class Help(unittest.TestCase):
    def test_both_programs_explain_themselves(self):
        for program, commands in ((BAKE, ("build", "info", "verify", "query", "export", "batch",
                                          "merge", "cache")),
                                  (SERVO, ("run", "replay", "devices", "doctor", "top", "view", "plot",
                                           "export-mcap", "supervise"))):
            for arguments in ([], *([command] for command in commands)):
                with self.subTest(os.path.basename(program) + " " + " ".join(arguments)):
                    result = run(*arguments, "--help", program=program)
                    self.assertEqual(result.returncode, 0, result.stderr)
                    self.assertEqual(result.stderr, "")
                    self.assertIn("Usage: " + " ".join([os.path.basename(program), *arguments]),
                                  result.stdout)
                    for command in () if arguments else commands:
                        self.assertIn(command, result.stdout)
                    version = run(*arguments, "--version", program=program)
                    self.assertEqual(version.returncode, 0, version.stderr)
                    self.assertRegex(version.stdout,
                                     os.path.basename(program) + r" \d+\.\d+\.\d+\n")

    def test_every_option_of_build_tells_its_default_or_that_it_must_be_given(self):
        text = run("build", "--help").stdout
        for option in ("--form", "--tolerance", "--max-depth", "--margin", "--probe", "--device",
                       "--scene", "--kind", "--planes", "--resolution", "--layers", "--unit",
                       "--threads", "--seed"):
            part = text[text.index(option):]
            part = part.split("\n  -")[0]
            self.assertIn("default", part, option)

    def test_every_option_of_the_simulated_device_stands_in_the_help_and_on_the_page(self):
        told = run("run", "--asset", "a.spm.exr", "--device", "sim:none=1", program=SERVO).stderr
        options = re.search(r"the options are (.*)", told).group(1).strip().replace(" and ", ", ").split(", ")
        self.assertGreater(len(options), 10)
        text = " ".join(run("run", "--help", program=SERVO).stdout.split())
        with open(os.path.join(ROOT, "servo", "commands", "OPTIONS.md"), encoding="utf-8") as file:
            page = next(line for line in file if line.startswith("| `--device"))
        for option in options:
            with self.subTest(option):
                self.assertIn(option + "=", text)
                self.assertIn(f"`{option}`", page)
        self.assertIn("push|path|live", text)


if __name__ == "__main__":
    unittest.main()
