#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The examples in C, Python and C#, against one server.

Usage: client_example_test.py [unittest options]; in the build folder, or with the environment of
client_daemon.py.
"""

import os
import re
import subprocess
import sys
import unittest

from client_daemon import (BIN, CAN_C_SHARP, EXAMPLES, WithDaemon, c_sharp_environment,
                           compile_c_sharp)


class Examples(WithDaemon):
    def run_example(self, *command, environment=None) -> str:
        with self.client():  # which waits for the first tick
            pass
        done = subprocess.run(command, capture_output=True, text=True, timeout=120,
                              env=environment)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def test_the_c_example_prints_the_state(self) -> None:
        shown = self.run_example(BIN / "spm_client_example", self.socket, "3", "0.5")
        self.assertEqual(len(re.findall(r"^tick \d+: at .* mm, force .* N", shown, re.M)), 3)

    def test_the_python_example_moves_the_object(self) -> None:
        shown = self.run_example(sys.executable, EXAMPLES / "move_object.py", self.socket, "0.5")
        self.assertGreater(len(set(re.findall(r"object at (\S+) mm", shown))), 2)

    def test_the_python_example_guides_the_hand(self) -> None:
        shown = self.run_example(sys.executable, EXAMPLES / "guide_hand.py", self.socket, "0.5")
        self.assertGreater(len(set(re.findall(r"pushed by (\S+) N, force", shown))), 2)

    @unittest.skipUnless(CAN_C_SHARP, "mcs or mono is not installed (mono-mcs and mono-runtime)")
    def test_the_c_sharp_example_prints_the_state_and_what_was_counted(self) -> None:
        program = os.path.join(self.folder.name, "ReadState.exe")
        compile_c_sharp(program, EXAMPLES / "ReadState.cs")
        shown = self.run_example("mono", program, self.socket, "3",
                                 environment=c_sharp_environment())
        self.assertEqual(len(re.findall(r"^tick \d+: hand at .* mm, force .* N", shown, re.M)), 3)
        self.assertRegex(
            shown, r"\nloop: \d+ ticks, \d+ missed, late p99 0\.3 us, busy p99 0\.5 us\n"
                   r"hand: \d+ ticks in contact, largest force 1\.50 N\n"
                   r"connected: ReadState example \(process \d+\)\n")
        missing = subprocess.run(["mono", program, self.socket + ".not"], capture_output=True,
                                 text=True, env=c_sharp_environment())
        self.assertEqual(missing.returncode, 2)
        self.assertIn("no daemon answers at", missing.stderr)

    WATCHED = r"^tick \d+: hand .* mm, proxy .* mm, force .* N$"

    def test_the_examples_that_watch_the_proxy_see_each_tick_and_lower_the_cap(self) -> None:
        for command in ([BIN / "spm_client_watch_proxy"],
                        [sys.executable, EXAMPLES / "watch_proxy.py"]):
            shown = self.run_example(*command, self.socket, "5", "1.5")
            self.assertEqual(len(re.findall(self.WATCHED, shown, re.M)), 5)

    @unittest.skipUnless(CAN_C_SHARP, "mcs or mono is not installed (mono-mcs and mono-runtime)")
    def test_the_c_sharp_example_that_watches_the_proxy_sees_each_tick(self) -> None:
        program = os.path.join(self.folder.name, "WatchProxy.exe")
        compile_c_sharp(program, EXAMPLES / "WatchProxy.cs")
        shown = self.run_example("mono", program, self.socket, "5", "1.5",
                                 environment=c_sharp_environment())
        self.assertEqual(len(re.findall(self.WATCHED, shown, re.M)), 5)

    def test_examples_without_a_daemon_end_with_the_sentence(self) -> None:
        for command in ([BIN / "spm_client_example"], [BIN / "spm_client_watch_proxy"],
                        [sys.executable, EXAMPLES / "move_object.py"],
                        [sys.executable, EXAMPLES / "watch_proxy.py"],
                        [sys.executable, EXAMPLES / "guide_hand.py"]):
            done = subprocess.run([*command, self.socket + ".not"], capture_output=True, text=True)
            self.assertEqual(done.returncode, 2)
            self.assertIn("no daemon answers at", done.stderr)


if __name__ == "__main__":
    unittest.main()
