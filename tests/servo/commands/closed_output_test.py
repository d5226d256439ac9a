#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs spm-servo with outputs that nobody reads, or that are not there: it serves on, and ends as it
would otherwise.

Usage: closed_output_test.py SERVO BAKE [unittest options]. No time decides a test.
"""

import json
import os
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "support"))

from baked_tetrahedron import bake_tetrahedron  # noqa: E402

SERVO = BAKE = ""
LONGEST_RUN = 120  # s


def unread_pipe() -> int:
    """The end for writing of a pipe whose reader is gone."""
    reader, writer = os.pipe()
    os.close(reader)
    return writer


def close_standard_files() -> None:
    for number in range(3):
        os.close(number)


class ClosedOutput(unittest.TestCase):
    @classmethod
    def setUpClass(cls) -> None:
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.folder = Path(folder.name)
        cls.asset = bake_tetrahedron(BAKE, cls.folder)

    def run_servo(self, *options: str, **files) -> tuple[int, str, list[str]]:
        """Exit code, standard output, and the lines of the trace."""
        trace = self.folder / f"{self._testMethodName}.csv"
        done = subprocess.run(
            [SERVO, "run", "--asset", self.asset, "--device", "sim", "--duration", "0.2",
             "--socket", "off", "--black-box", "off", "--trace", trace, *options],
            timeout=LONGEST_RUN, check=False, text=True, **files)
        lines = trace.read_text(encoding="utf-8").splitlines() if trace.exists() else []
        return done.returncode, done.stdout, lines

    def assert_whole(self, trace: list[str]) -> None:
        """A trace that was written to its end, and has nothing else in it."""
        self.assertGreater(len(trace), 1)
        for line in trace:
            self.assertEqual(line.count(","), trace[0].count(","), line)

    def test_messages_that_nobody_reads_do_not_end_it(self) -> None:
        code, output, trace = self.run_servo("--json", stdout=subprocess.PIPE, stderr=unread_pipe())
        self.assertEqual(code, 0)
        self.assertGreater(json.loads(output)["ticks"], 10)
        self.assert_whole(trace)

    def test_a_result_that_nobody_reads_is_said_after_everything_else_was_done(self) -> None:
        for kind in ([], ["--json"]):
            with self.subTest(kind):
                code, _, trace = self.run_servo(*kind, stdout=unread_pipe(),
                                                stderr=subprocess.DEVNULL)
                self.assertEqual(code, 2)
                self.assert_whole(trace)

    def test_no_file_takes_the_number_of_an_output_that_is_not_there(self) -> None:
        trace = self.folder / "open.csv"
        with subprocess.Popen(
                [SERVO, "run", "--asset", self.asset, "--device", "sim", "--socket", "off",
                 "--black-box", "off", "--trace", trace],
                preexec_fn=close_standard_files) as daemon:
            while daemon.poll() is None and not list(self.folder.glob(trace.name + "*")):
                time.sleep(0.005)
            files = [os.readlink(f"/proc/{daemon.pid}/fd/{number}") for number in range(3)]
            daemon.terminate()
        self.assertEqual(files, ["/dev/null"] * 3)
        self.assertEqual(daemon.returncode, 0)
        self.assert_whole(trace.read_text(encoding="utf-8").splitlines())


if __name__ == "__main__":
    SERVO, BAKE = sys.argv[1:3]
    unittest.main(argv=sys.argv[:1] + sys.argv[3:], verbosity=2)
