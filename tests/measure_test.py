#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Holds that a measurement that was broken off goes on with what it has, and with nothing else.

Usage: measure_test.py SOURCE_DIR [unittest options]
"""

import subprocess
import sys
import tempfile
import unittest
from importlib.machinery import SourceFileLoader
from importlib.util import module_from_spec, spec_from_loader
from pathlib import Path
from unittest import mock

SOURCE = Path()


def measure_script():
    loader = SourceFileLoader("measure", str(SOURCE / "scripts/measure"))
    module = module_from_spec(spec_from_loader("measure", loader))
    loader.exec_module(module)
    return module


class BrokenOff(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory(prefix="spm-measure-")
        self.addCleanup(folder.cleanup)
        self.parts = Path(folder.name) / "parts"
        self.script = measure_script()
        self.measured = []

    def run_at(self, commit: str):
        run = self.script.Run(False, self.parts)
        run.commit = commit
        run.keep_only_own()
        return run

    def measure(self, commit: str, part: str, fails: bool = False) -> None:
        """One part, by a stand-in for spm-bench that writes a file, or half of it."""
        def bench(run, mode: str) -> None:
            self.measured.append(mode)
            (run.folder / "half.json").write_text("{}")
            if fails:
                raise subprocess.CalledProcessError(1, "spm-bench")
            (run.folder / "half.json").rename(run.folder / f"{mode}.json")

        with mock.patch.object(self.script, "bench", bench), mock.patch("sys.stderr"):
            self.run_at(commit).measure(part)

    def test_a_finished_part_is_kept_and_an_unfinished_one_made_anew(self) -> None:
        self.measure("one", "bytes")
        with self.assertRaises(subprocess.CalledProcessError):
            self.measure("one", "forces", fails=True)
        self.measure("one", "bytes")
        self.measure("one", "forces")
        self.assertEqual(self.measured, ["bytes", "forces", "forces"])
        self.assertEqual([file.name for file in (self.parts / "forces").iterdir()],
                         ["forces.json"])

    def test_parts_of_another_commit_or_machine_are_not_taken_up(self) -> None:
        self.measure("one", "bytes")
        self.measure("two", "bytes")
        with mock.patch.object(self.script, "machine_here", lambda: {"processor": "another"}):
            self.measure("two", "bytes")
        self.assertEqual(self.measured, ["bytes"] * 3)


if __name__ == "__main__":
    SOURCE = Path(sys.argv.pop(1)).resolve()
    sys.dont_write_bytecode = True
    unittest.main()
