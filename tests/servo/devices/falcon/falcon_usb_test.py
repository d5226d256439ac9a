#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs a Falcon device on the real libusb against a scripted Falcon that umockdev plugs in.

Usage: falcon_usb_test.py MOCK CLIENT [unittest options], the programs mock_usb_falcon and
falcon_client. No time decides a test; only what happened, and in which order, does.
"""

import json
import os
import random
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

MOCK = CLIENT = ""
FIRMWARE_SIZE = 8492
LONGEST_RUN = 120  # s


class FalconOverUsb(unittest.TestCase):
    def setUp(self) -> None:
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.firmware = Path(self.folder.name) / "firmware.bin"
        self.firmware.write_bytes(b"\xaa\x08" + random.Random(1).randbytes(FIRMWARE_SIZE - 2))

    def run_client(self, mode: str, ticks: int, options: str | None = None,
                   *mock_options: str) -> tuple[int, str, dict, dict]:
        """The client's exit code and messages, what it saw, and what the mock saw."""
        if options is None:
            options = f"firmware={self.firmware}"
        done = subprocess.run(
            [MOCK, "--mode", mode, "--firmware-size", str(FIRMWARE_SIZE), *mock_options, "--",
             CLIENT, str(ticks), options],
            capture_output=True, text=True, timeout=LONGEST_RUN, check=False,
            env={name: value for name, value in os.environ.items() if name != "FALCON_FIRMWARE"})
        messages, _, last = done.stderr.rstrip("\n").rpartition("\n")
        seen = json.loads(done.stdout) if done.stdout.startswith("{") else {}
        return done.returncode, messages, seen, json.loads(last)

    def run_well(self, mode: str, ticks: int, options: str | None = None,
                 *mock_options: str) -> tuple[dict, dict]:
        code, messages, seen, mock = self.run_client(mode, ticks, options, *mock_options)
        self.assertEqual(code, 0, f"{messages}\n{mock}")
        self.assertTrue(mock["rules_kept"], mock)
        self.assertEqual(mock["packets"], mock["packets_with_homing"])
        self.assertEqual(mock["pushes_before_homing"], 0)
        self.assertGreater(mock["pushing_packets"], 50)
        self.assertEqual(seen["read"]["fault"], 0, seen)
        self.assertGreater(seen["read"]["ok"], 100, seen)
        self.assertGreater(seen["new_positions"], 50, seen)
        # The grip goes 20 mm to each side, 15 mm up and down and 10 mm in and out.
        for axis, way in enumerate((0.0201, 0.0151, 0.0101)):
            self.assertLessEqual(seen["max_m"][axis], way)
            self.assertGreaterEqual(seen["min_m"][axis], -way)
        return seen, mock

    def health(self, seen: dict) -> list[str]:
        return [change["health"] for change in seen["changes"]]

    def test_firmware_is_loaded_and_the_hand_is_followed_once_it_is_homed(self) -> None:
        seen, mock = self.run_well("normal", 1500)
        self.assertEqual(mock["boots"], 1)
        self.assertEqual(mock["loaded_bytes"], FIRMWARE_SIZE)
        self.assertEqual(seen["device"]["firmware"], "uploaded")
        self.assertTrue(seen["device"]["homed"])
        self.assertEqual(seen["device"]["usb_path"], "1-2")
        self.assertEqual(seen["device"]["reopened"], 0)
        self.assertEqual(seen["read"]["gone"], 0)
        self.assertLess(self.health(seen).index("not_homed"), self.health(seen).index("ok"))
        self.assertLessEqual(mock["largest_motor"], 4096)

    def test_firmware_that_runs_is_left_alone_and_needs_no_file(self) -> None:
        seen, mock = self.run_well("running", 1000, "path=1-2")
        self.assertEqual(mock["boots"], 0)
        self.assertEqual(seen["device"]["firmware"], "was_running")

    def test_a_zero_in_front_of_the_boot_program_s_answer_does_no_harm(self) -> None:
        _, mock = self.run_well("zero", 1000)
        self.assertEqual(mock["boots"], 1)

    def test_an_echo_that_was_wrong_once_is_a_second_upload(self) -> None:
        _, mock = self.run_well("echo", 1000)
        self.assertEqual(mock["boots"], 2)

    def test_packets_cut_short_cost_only_themselves(self) -> None:
        self.run_well("short", 1500)

    def test_answers_that_come_late_are_taken_when_they_come(self) -> None:
        seen, _ = self.run_well("late", 1500)
        self.assertEqual(seen["read"]["gone"], 0)

    def test_a_device_that_falls_silent_is_told_from_one_that_is_gone(self) -> None:
        # On a busy machine its 500 packets take most of 1500 ticks.
        seen, mock = self.run_well("silent", 3000, None, "--act-after", "500")
        self.assertEqual(self.health(seen)[-1], "silent")
        self.assertEqual(seen["read"]["gone"], 0)
        self.assertEqual(mock["last_lit"], 4)
        self.assertEqual(mock["last_lights"], 0)  # the end's last command

    def test_unplugged_and_plugged_in_again_it_is_taken_up(self) -> None:
        seen, mock = self.run_well("replug", 4000)
        self.assertEqual(mock["unplugged"], 1)
        self.assertEqual(mock["boots"], 1)
        self.assertGreater(seen["read"]["gone"], 0)
        self.assertEqual(seen["device"]["reopened"], 1)
        health = self.health(seen)
        self.assertIn("ok", health[health.index("gone"):])

    def test_without_power_meanwhile_it_is_given_firmware_again_and_homed_again(self) -> None:
        seen, mock = self.run_well("power", 8000)
        self.assertEqual(mock["boots"], 2)
        self.assertEqual(seen["device"]["firmware_uploads"], 2)
        after = self.health(seen)[self.health(seen).index("gone"):]
        self.assertLess(after.index("not_homed"), after.index("ok"))

    def test_no_firmware_and_no_file_is_exit_code_2_with_the_cure(self) -> None:
        code, messages, _, mock = self.run_client("normal", 10, "")
        self.assertEqual(code, 2)
        self.assertIn("runs no firmware", messages)
        self.assertIn("FALCON_FIRMWARE", messages)
        self.assertEqual(mock["boots"], 0)

    def test_another_path_is_not_found_and_the_right_one_is_named(self) -> None:
        code, messages, _, _ = self.run_client("normal", 10, "path=1-3")
        self.assertEqual(code, 2)
        self.assertIn("1-3, but there is one at 1-2", messages)

    def test_a_device_that_another_program_has_is_exit_code_2_with_the_cure(self) -> None:
        code, messages, _, mock = self.run_client("busy", 10)
        self.assertEqual(code, 2)
        self.assertIn("used by another program", messages)
        self.assertEqual(mock["packets"], 0)


if __name__ == "__main__":
    MOCK, CLIENT = sys.argv[1:3]
    unittest.main(argv=sys.argv[:1] + sys.argv[3:], verbosity=2)
