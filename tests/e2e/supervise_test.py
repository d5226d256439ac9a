#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""`spm-servo supervise`: a supervisor outside of what a daemon may be paused with."""

import os
import signal
import subprocess
import unittest

from programs import SERVO, THIN_BAND, Case, bake_box, run

LONG = 30  # s, for what is done at once


class Supervise(Case):
    @classmethod
    def setUpClass(cls):
        bake_box(cls, "--tolerance", "200um", *THIN_BAND)

    def setUp(self):
        super().setUp()
        self.socket = self.path("supervisor.sock")
        self.said = self.path("said")

    def supervise(self):
        with open(self.said, "wb") as said:
            process = subprocess.Popen([SERVO, "supervise", "--socket", self.socket],
                                       stderr=said, env={**os.environ, "XDG_STATE_HOME": self.folder})
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        self.wait_for(lambda: "listens" in self.told())
        return process

    def told(self):
        with open(self.said, encoding="utf-8") as said:
            return said.read()

    def serve(self, *options):
        process = subprocess.Popen(
            [SERVO, "run", "--asset", self.asset, "--device", "sim", "--socket", "off", "--supervisor",
             self.socket, *options], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        return process

    def test_a_killed_daemon_has_its_last_ticks_kept_outside(self):
        self.supervise()
        daemon = self.serve()
        self.wait_for(lambda: "has a supervisor" in self.told())
        with self.assertRaises(subprocess.TimeoutExpired):
            daemon.wait(1)
        os.kill(daemon.pid, signal.SIGKILL)
        self.wait_for(lambda: "the last ticks are kept in " + self.folder in self.told())

    def test_a_daemon_that_ends_as_it_should_leaves_nothing_to_say(self):
        server = self.supervise()
        self.assertEqual(self.serve("--duration", "0.3s").wait(LONG), 0)
        server.terminate()
        self.assertEqual(server.wait(LONG), 0)
        self.assertNotIn("without a good-bye", self.told())
        self.assertFalse(os.path.exists(self.socket))

    def test_a_daemon_does_not_start_without_the_supervisor_that_it_asks_for(self):
        self.expect_refusal(
            run("run", "--asset", self.asset, "--device", "sim", "--duration", "0.1s", "--supervisor",
                self.socket, program=SERVO), 2, self.socket + ": there is no supervisor to ask")
        self.expect_refusal(run("run", "--asset", self.asset, "--supervisor", "maybe", program=SERVO), 1,
                            "'maybe' is neither on, off, nor the path")


if __name__ == "__main__":
    unittest.main()
