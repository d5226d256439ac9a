#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs several spm-servo beside each other: one of each name, which a client can choose.

Usage: daemon_name_test.py SERVO BAKE [unittest options]. No time decides a test.
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


class DaemonName(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.asset = bake_tetrahedron(BAKE, self.folder)
        self.environment = {**os.environ, "XDG_RUNTIME_DIR": folder.name}
        self.environment.pop("SPM_SERVO_NAME", None)

    def command(self, *options: str) -> list:
        return [SERVO, "run", "--asset", self.asset, "--device", "sim", "--black-box", "off",
                "--quiet", *options]

    def run_to_end(self, *options: str) -> subprocess.CompletedProcess:
        return subprocess.run(self.command("--duration", "0.2", *options), capture_output=True,
                              text=True, timeout=LONGEST_RUN, check=False, env=self.environment)

    def start(self, name: str, *options: str, **environment: str) -> subprocess.Popen:
        """A daemon that listens as that name."""
        daemon = subprocess.Popen(self.command(*options), stdout=subprocess.DEVNULL,
                                  env={**self.environment, **environment})
        self.addCleanup(daemon.wait)
        self.addCleanup(daemon.terminate)
        while daemon.poll() is None and not (self.folder / "spm-servo" / f"{name}.sock").exists():
            time.sleep(0.005)
        self.assertIsNone(daemon.poll())
        return daemon

    def top(self, *options: str, **environment: str) -> subprocess.CompletedProcess:
        return subprocess.run([SERVO, "top", "--json", *options], capture_output=True, text=True,
                              timeout=LONGEST_RUN, check=False,
                              env={**self.environment, **environment})

    def test_a_second_daemon_of_one_name_does_not_start_and_is_told_how_to(self) -> None:
        first = self.start("default")
        second = self.run_to_end()
        self.assertEqual(second.returncode, 3, second.stderr)
        self.assertEqual(second.stderr.count("\n"), 1, second.stderr)
        for part in ("error: the name 'default' (", f"a daemon (process {first.pid}) ", "--name"):
            self.assertIn(part, second.stderr)

    def test_daemons_of_several_names_run_and_clients_choose(self) -> None:
        # Far enough from each other that a busy machine does not confuse them.
        self.start("default", "--rate", "1500")
        self.start("left", "--name", "left", "--rate", "500")
        self.start("right", "--rate", "4000", SPM_SERVO_NAME="right")
        for rate, told in ((1500, self.top()), (500, self.top("--name", "left")),
                           (4000, self.top(SPM_SERVO_NAME="right")),
                           (500, self.top("--name", "left", SPM_SERVO_NAME="right"))):
            self.assertEqual(told.returncode, 0, told.stderr)
            seen = json.loads(told.stdout)["rate_hz"]
            self.assertEqual(min((500, 1500, 4000), key=lambda each: abs(each - seen)), rate)

    def test_what_is_no_name_is_told(self) -> None:
        for told in (self.top("--name", "a/b"), self.top(SPM_SERVO_NAME="a/b"),
                     self.run_to_end("--name", "a/b")):
            self.assertEqual(told.returncode, 1)
            self.assertIn("'a/b' is no name", told.stderr)


if __name__ == "__main__":
    SERVO, BAKE = sys.argv[1:3]
    unittest.main(argv=sys.argv[:1] + sys.argv[3:], verbosity=2)
