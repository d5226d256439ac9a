#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs the pid device on the real hidapi and hidraw calls against sticks that umockdev plugs in.

Usage: pid_device_test.py MOCK CLIENT [unittest options], the programs mock_hid and hid_client. No
time decides a test; only what happened, and in which order, does.
"""

import json
import subprocess
import sys
import unittest

MOCK = CLIENT = ""
LONGEST_RUN = 120  # s
MOST_TICKS = 100000
MOST_TRIES = 10
RESETS = 2  # of one set-up
FULL = "full_force=10N"  # the client pushes with 1 N, a tenth of it


class PidDevice(unittest.TestCase):
    def run_command(self, device: str, faults: tuple[str, ...],
                    command: list[str]) -> tuple[int, str, str, dict]:
        """Exit code, output and messages of a command beside a stick, and what the stick saw."""
        done = subprocess.run([MOCK, device, *faults, "--", *command], capture_output=True,
                              text=True, timeout=LONGEST_RUN, check=False)
        messages, _, last = done.stderr.rstrip("\n").rpartition("\n")
        return done.returncode, done.stdout, messages, json.loads(last)

    def run_undisturbed(self, device: str, options: tuple[str, ...],
                        command: list[str]) -> tuple[int, str, str, dict]:
        """As run_command, of a client that the machine never kept waiting for long: one that was
        stops its effects and opens the stick again, which is not what these tests are about."""
        for _ in range(MOST_TRIES):
            done = self.run_command(device, options, command)
            if done[3]["stops"] <= done[3]["freed"]:
                break
        return done

    def run_client(self, device: str, reports: int, options: str = FULL,
                   *faults: str) -> tuple[dict, dict]:
        """What a client saw, and its stick, until the stick has sent so many reports."""
        code, output, messages, mock = self.run_undisturbed(
            device, (*faults, f"until={reports}"), [CLIENT, "pid", str(MOST_TICKS), options])
        self.assertEqual(code, 0, f"{messages}\n{mock}")
        self.assertEqual(mock["wrong_commands"], 0)
        seen = json.loads(output)
        self.assertEqual(seen["read"]["fault"], 0, seen)
        return seen, mock

    def refused(self, device: str, options: str = FULL) -> tuple[int, str, dict]:
        """Exit code and sentence of a client that cannot use its stick."""
        code, _, messages, mock = self.run_command(device, (), [CLIENT, "pid", "10", options])
        return code, messages, mock

    def assert_pushed(self, mock: dict, x: float, y: float) -> None:
        """The greatest force of the run, as parts of the stick's, and none at its end."""
        self.assertAlmostEqual(mock["largest_force"][0], x, delta=0.003)
        self.assertAlmostEqual(mock["largest_force"][1], y, delta=0.003)
        self.assertEqual(mock["last_force"], [0, 0])

    def assert_followed(self, seen: dict) -> None:
        """The emulated stick swings by 0.6 and 0.4 of its way, which is 50 mm to each side."""
        self.assertGreater(seen["new_positions"], 10)
        self.assertGreater(seen["max_m"][0], 0.02)
        self.assertLess(seen["max_m"][0], 0.031)
        self.assertGreater(seen["min_m"][0], -0.031)
        self.assertLess(seen["max_m"][1], 0.021)
        self.assertEqual([seen["min_m"][2], seen["max_m"][2]], [0, 0])

    def test_a_stick_is_set_up_by_its_descriptor_followed_and_pushed(self) -> None:
        for device, reports in (("pid", 800), ("pid-axes", 20)):
            with self.subTest(device):
                seen, mock = self.run_client(device, reports)
                self.assert_followed(seen)
                self.assertGreater(seen["read"]["ok"], 10)
                self.assertEqual(seen["read"]["gone"], 0)
                self.assertEqual(seen["buttons"], 2)
                self.assertEqual(seen["force_cap_N"], 10)
                self.assertEqual(seen["device"]["axes"], 2)
                self.assert_pushed(mock, 0.1, 0)
                self.assertEqual(mock["resets"], RESETS)
                self.assertEqual(mock["created"], 2)
                self.assertEqual(mock["durations"], [200, 200])
                self.assertEqual([mock["stops"], mock["freed"], mock["playing"]], [2, 2, 0])
                # The other one has no gain of its own.
                self.assertEqual(mock["gain"], 255 if device == "pid" else 0)

    def test_the_descriptors_way_of_directions_and_resolution_are_taken(self) -> None:
        for device, reports, way, counts in (("pid", 300, "polar", 65534),
                                             ("pid-axes", 8, "axes", 255)):
            with self.subTest(device):
                seen, _ = self.run_client(device, reports)
                self.assertEqual(seen["device"]["direction"], way)
                self.assertAlmostEqual(seen["encoder_step_m"], 0.1 / counts, delta=1e-9)

    def test_options_turn_the_force_hold_it_and_scale_the_way(self) -> None:
        seen, mock = self.run_client(
            "pid", 800, "full_force=4N,force_cap=500mN,force_signs=-+,travel=200mm")
        self.assert_pushed(mock, -0.125, 0)
        self.assertGreater(seen["max_m"][0], 0.04)

    def test_a_stick_that_seldom_tells_anything_is_asked_in_between(self) -> None:
        seen, mock = self.run_client("pid-axes", 30)
        self.assertGreater(mock["asked"], 10)
        self.assertGreater(seen["new_positions"], 35)

    def test_effects_are_kept_up_and_end_by_themselves_where_the_client_is_killed(self) -> None:
        # The stick's own time goes on while its reports are read by somebody else.
        read = ("import os; stick = os.open('/dev/hidraw7', os.O_RDONLY)\n"
                "for _ in range(1000): os.read(stick, 64)")
        script = ('trap \'kill -9 $client; wait $client; "$1" -c "$2"; exit 0\' TERM; '
                  f'"$0" pid {MOST_TICKS} {FULL} > /dev/null & client=$!; wait $client; exit 1')
        code, _, messages, mock = self.run_undisturbed(
            "pid", ("until=600",), ["bash", "-c", script, CLIENT, sys.executable, read])
        self.assertEqual(code, 0, messages)
        self.assertAlmostEqual(mock["largest_force"][0], 0.1, delta=0.002)
        self.assertGreater(mock["starts"], 4)
        self.assertEqual(mock["stops"], 0)
        self.assertEqual(mock["expired"], 2)
        self.assertEqual([mock["playing"], *mock["last_force"]], [0, 0, 0])

    def test_without_the_watchdog_effects_are_endless_and_started_once(self) -> None:
        _, mock = self.run_client("pid", 600, FULL + ",watchdog=off")
        self.assertEqual(mock["durations"], [0xFFFF, 0xFFFF])
        self.assertEqual(mock["starts"], 2)
        self.assert_pushed(mock, 0.1, 0)

    def test_short_reports_cost_only_themselves(self) -> None:
        seen, mock = self.run_client("pid", 800, FULL, "short=10")
        self.assert_followed(seen)
        self.assertEqual(seen["read"]["gone"], 0)
        self.assert_pushed(mock, 0.1, 0)

    def test_silence_is_told_and_ends_with_the_next_report(self) -> None:
        seen, mock = self.run_client("pid", 1300, FULL, "silence=300:500")
        after = seen["changes"][seen["changes"].index("ok"):]
        self.assertIn("ok", after[after.index("silent"):])
        self.assertEqual(seen["read"]["gone"], 0)
        self.assertEqual(mock["last_force"], [0, 0])

    def test_unplugged_and_plugged_in_again_it_is_set_up_anew(self) -> None:
        seen, mock = self.run_client("pid", 1400, FULL, "unplug=400:50")
        self.assertEqual(mock["unplugged"], 3)
        self.assertEqual(seen["device"]["reopened"], 3)
        changes = seen["changes"]
        self.assertIn("ok", changes[changes.index("gone"):])
        self.assertEqual(mock["resets"], 4 * RESETS)
        self.assertEqual(mock["created"], 8)
        self.assertEqual(mock["last_force"], [0, 0])

    def test_after_a_report_that_failed_there_is_no_force_until_it_is_set_up_anew(self) -> None:
        # The first four or five set it up, the next gives the force and is repeated with the watchdog.
        for at, fails in ((40, 1), (40, 2)):
            with self.subTest(at=at, fails=fails):
                seen, mock = self.run_client("pid", 2000, FULL, f"refuse={at}:{fails}")
                self.assertGreaterEqual(seen["device"]["reopened"], 1)
                off = [time for time in mock["force_ended_ns"] if time > mock["refused_ns"]]
                off_ms = (off[0] - mock["refused_ns"]) / 1e6
                print(f"pid: no force {off_ms:.1f} ms after {fails} failed transfers",
                      file=sys.stderr)
                self.assertLess(off_ms, 100)
                self.assert_pushed(mock, 0.1, 0)

    def test_a_stick_without_constant_force_is_refused_with_what_it_lacks(self) -> None:
        code, message, mock = self.refused("pid-no-constant")
        self.assertEqual(code, 5)
        self.assertIn("lacks a Set Constant Force report (usage 0x73)", message)
        self.assertIn("1209:ffb0", message)
        self.assertEqual(mock["commands"], 0)

    def test_a_direction_that_the_descriptor_has_not_is_refused(self) -> None:
        code, message, mock = self.refused("pid-axes", FULL + ",direction=polar")
        self.assertEqual(code, 5)
        self.assertIn("lacks a direction (usage 0x57)", message)
        self.assertIn("direction=", message)
        self.assertEqual(mock["commands"], 0)

    def test_an_effect_that_is_refused_is_told_and_the_first_one_ended(self) -> None:
        code, message, mock = self.refused("pid-full")
        self.assertEqual(code, 2)
        self.assertIn("no room for another effect", message)
        self.assertEqual([mock["created"], mock["starts"], mock["stops"], mock["freed"]],
                         [2, 1, 1, 1])
        self.assertEqual([mock["wrong_commands"], mock["playing"]], [0, 0])
        code, message, mock = self.refused("pid-busy")
        self.assertEqual(code, 2)
        self.assertIn("refuses an effect of constant force", message)
        self.assertEqual(mock["starts"], 0)

    def test_without_its_full_force_it_is_not_even_looked_for(self) -> None:
        code, message, mock = self.refused("pid", "")
        self.assertEqual(code, 1)
        self.assertIn("full_force is missing", message)
        self.assertEqual(mock["commands"], 0)

    def test_another_serial_number_or_device_is_not_found(self) -> None:
        for device, options in (("pid", FULL + ",serial=X"), ("spacemouse", FULL),
                                ("wooden-v1", FULL)):
            with self.subTest(device):
                code, message, _ = self.refused(device, options)
                self.assertEqual(code, 2)
                self.assertIn("is plugged in: plug it in", message)

    def test_a_second_program_is_told_that_the_stick_is_in_use(self) -> None:
        script = (f'for i in 1 2; do "$0" pid {MOST_TICKS} {FULL} > /dev/null & done; '
                  'wait -n; code=$?; kill $(jobs -p); wait; exit $code')
        code, _, messages, mock = self.run_command("pid", (), ["bash", "-c", script, CLIENT])
        self.assertEqual(code, 2)
        self.assertIn("in use by another program", messages)
        self.assertEqual(mock["resets"], RESETS)


if __name__ == "__main__":
    MOCK, CLIENT = sys.argv[1:3]
    unittest.main(argv=sys.argv[:1] + sys.argv[3:], verbosity=2)
