#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs the HID devices on the real hidapi and hidraw calls against devices that umockdev plugs in.

Usage: hid_devices_test.py MOCK CLIENT [unittest options], the programs mock_hid and hid_client. No
time decides a test; only what happened, and in which order, does.
"""

import json
import os
import subprocess
import sys
import tempfile
import unittest
import unittest.mock

MOCK = CLIENT = ""
LONGEST_RUN = 120  # s
MOST_TICKS = 100000
WOODEN = ("wooden-v1", "wooden-v2", "wooden-v3")
SIGNS = "signs=+++"
HOMED = f"home_confirmed=always,{SIGNS}"
HOME = (0, 0.205, 0.025)  # m, where the tool stands at home, in the world's frame


class HidDevices(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        state = unittest.mock.patch.dict(os.environ, XDG_STATE_HOME=folder.name)
        state.start()
        self.addCleanup(state.stop)

    def run_command(self, device: str, faults: tuple[str, ...],
                    command: list[str]) -> tuple[int, str, str, dict]:
        """Exit code, output and messages of a command beside a device, and what the device saw."""
        done = subprocess.run([MOCK, device, *faults, "--", *command], capture_output=True,
                              text=True, timeout=LONGEST_RUN, check=False)
        messages, _, last = done.stderr.rstrip("\n").rpartition("\n")
        return done.returncode, done.stdout, messages, json.loads(last)

    def run_client(self, device: str, reports: int, options: str = "",
                   *faults: str) -> tuple[dict, dict]:
        """What a client saw, and its device, until the device has sent so many reports."""
        name = "spacemouse" if device == "spacemouse" else "woodenhaptics"
        if device == "wooden-v3" and "serial=" not in options:
            options += ("," if options else "") + "protocol=v3"
        code, output, messages, mock = self.run_command(
            device, (*faults, f"until={reports}"), [CLIENT, name, str(MOST_TICKS), options])
        self.assertEqual(code, 0, f"{messages}\n{mock}")
        self.assertEqual(mock["wrong_commands"], 0)
        seen = json.loads(output)
        self.assertEqual(seen["read"]["fault"], 0, seen)
        return seen, mock

    def run_wooden(self, device: str, reports: int, options: str = HOMED,
                   *faults: str) -> tuple[dict, dict]:
        seen, mock = self.run_client(device, reports, options, *faults)
        self.assertEqual(seen["device"]["protocol"], device.removeprefix("wooden-"))
        # 1 N to the right asks less than 0.7 A of any motor, and at home 0.59 A of the first.
        self.assertLess(mock["largest_mA"], 700)
        return seen, mock

    def assert_followed(self, seen: dict) -> None:
        """The emulated arm swings about home by 300, 200 and 250 counts."""
        self.assertGreater(seen["read"]["ok"], 10, seen)
        self.assertGreater(seen["new_positions"], 10, seen)
        for axis in range(3):
            self.assertLess(seen["max_m"][axis], HOME[axis] + 0.018)
            self.assertGreater(seen["min_m"][axis], HOME[axis] - 0.018)

    def test_each_protocol_is_told_and_the_arm_is_followed_and_pushed(self) -> None:
        for device in WOODEN:
            with self.subTest(device):
                seen, mock = self.run_wooden(device, 800)
                self.assert_followed(seen)
                self.assertGreater(seen["max_m"][0] - seen["min_m"][0], 0.003)
                self.assertEqual(seen["read"]["gone"], 0)
                self.assertGreater(mock["commands_with_current"], 10)
                self.assertGreater(mock["largest_mA"], 500)
                self.assertEqual(mock["last_mA"], [0, 0, 0])
                self.assertEqual(seen["force_cap_N"], 5)

    def test_without_a_confirmed_home_no_current_is_ever_sent(self) -> None:
        for device in WOODEN:
            with self.subTest(device):
                seen, mock = self.run_wooden(device, 400, SIGNS)
                self.assertEqual(seen["read"]["ok"], 0)
                self.assertGreater(seen["read"]["not_homed"], 10)
                self.assertGreater(mock["commands"], 10)
                self.assertEqual(mock["commands_with_current"], 0)

    def test_without_confirmed_signs_the_arm_is_followed_and_no_current_is_sent(self) -> None:
        for device in WOODEN:
            with self.subTest(device):
                seen, mock = self.run_wooden(device, 400, "home_confirmed=always,gravity=on")
                self.assertEqual(seen["read"]["ok"], 0)
                self.assertGreater(seen["read"]["unconfirmed"], 10)
                self.assertFalse(seen["device"]["signs_confirmed"])
                self.assertGreater(mock["commands"], 10)
                self.assertEqual(mock["commands_with_current"], 0)

    def test_signs_that_were_kept_once_hold_at_the_next_start(self) -> None:
        for options, read, signs in (
                ("", "unconfirmed", "-+-+++"),
                ("signs=--+,keep_signs=on", "ok", "--++++"),
                ("", "ok", "--++++"),
                ("model=vintage", "unconfirmed", "++++++"),
                ("signs=+++", "ok", "++++++"),
                ("", "ok", "--++++")):
            with self.subTest(options):
                options += ",home_confirmed=always" if options else "home_confirmed=always"
                seen, mock = self.run_client("wooden-v2", 400, options)
                self.assertEqual(seen["device"]["signs"], signs)
                self.assertGreater(seen["read"][read], 10)
                self.assertEqual(mock["commands_with_current"] > 0, read == "ok")

    def test_a_board_with_ids_of_others_is_driven_only_where_it_is_named(self) -> None:
        code, _, messages, mock = self.run_command("wooden-v3", (),
                                                   [CLIENT, "woodenhaptics", "10", HOMED])
        self.assertEqual(code, 2)
        self.assertIn("16c0:0486", messages)
        self.assertIn("protocol=v3", messages)
        self.assertEqual(mock["reports"], 0)
        for named in ("protocol=v3", "serial=7654321"):
            with self.subTest(named):
                code, output, messages, _ = self.run_command(
                    "wooden-v3", ("until=300",),
                    [CLIENT, "woodenhaptics", str(MOST_TICKS), f"{HOMED},{named}"])
                self.assertEqual(code, 0, messages)
                self.assertGreater(json.loads(output)["read"]["ok"], 10)

    def test_the_calibration_button_makes_the_pose_home(self) -> None:
        for device in ("wooden-v2", "wooden-v3"):
            with self.subTest(device):
                seen, mock = self.run_wooden(device, 900, SIGNS, "press=300")
                self.assertEqual(mock["commands_with_current_before_set"], 0)
                self.assertGreaterEqual(mock["set_counters"], 1)
                self.assertGreater(mock["commands_with_current"], 10)
                self.assertLess(seen["changes"].index("not_homed"), seen["changes"].index("ok"))
                for axis in range(3):
                    self.assertAlmostEqual(seen["first_m"][axis], HOME[axis], delta=3e-3)

    def test_a_press_from_before_the_start_does_not_count(self) -> None:
        for device in ("wooden-v2", "wooden-v3"):
            with self.subTest(device):
                seen, mock = self.run_wooden(device, 400, SIGNS, "press=0")
                self.assertGreaterEqual(mock["set_counters"], 1)
                self.assertEqual(mock["commands_with_current"], 0)
                self.assertEqual(seen["read"]["ok"], 0)

    def test_a_board_that_waits_to_be_asked_is_asked(self) -> None:
        for device, options in (("wooden-v2", HOMED), ("wooden-v2", HOMED + ",protocol=v2"),
                                ("wooden-v3", HOMED)):
            with self.subTest(options):
                seen, _ = self.run_wooden(device, 500, options, "quiet")
                self.assert_followed(seen)

    def test_short_reports_cost_only_themselves(self) -> None:
        for device in WOODEN:
            with self.subTest(device):
                seen, _ = self.run_wooden(device, 800, HOMED, "short=10")
                self.assert_followed(seen)
                self.assertEqual(seen["read"]["gone"], 0)

    def test_counters_that_wrap_are_followed(self) -> None:
        seen, _ = self.run_wooden("wooden-v2", 800, HOMED + ",home=-32760:0:6000",
                                  "start=32760:0:0")
        self.assert_followed(seen)

    def test_late_reports_are_silence_and_no_loss(self) -> None:
        seen, _ = self.run_wooden("wooden-v2", 800, HOMED, "late=50:30")
        self.assertIn("silent", seen["changes"])
        self.assertGreater(seen["read"]["ok"], 10)
        self.assertEqual(seen["read"]["gone"], 0)

    def test_silence_is_told_and_ends_with_the_next_report(self) -> None:
        for device in WOODEN:
            with self.subTest(device):
                seen, _ = self.run_wooden(device, 600, HOMED, "silence=200:150")
                after = seen["changes"][seen["changes"].index("ok"):]
                self.assertIn("ok", after[after.index("silent"):])
                self.assertEqual(seen["read"]["gone"], 0)

    def test_unplugged_and_plugged_in_again_it_is_taken_up(self) -> None:
        for device in WOODEN:
            with self.subTest(device):
                seen, mock = self.run_wooden(device, 700, HOMED, "unplug=200:50")
                self.assertEqual(mock["unplugged"], 3)
                self.assertEqual(seen["device"]["reopened"], 3)
                changes = seen["changes"]
                self.assertIn("ok", changes[changes.index("gone"):])

    def test_after_a_report_that_failed_no_motor_has_a_current_until_the_loop_gives_force_anew(
            self) -> None:
        for device in WOODEN:
            for fails in (1, 2):
                with self.subTest(device, fails=fails):
                    seen, mock = self.run_wooden(device, 900, HOMED, f"refuse=300:{fails}")
                    off = [at for at in mock["current_ended_ns"] if at > mock["refused_ns"]]
                    off_ms = (off[0] - mock["refused_ns"]) / 1e6
                    print(f"{device}: no current {off_ms:.1f} ms after {fails} failed transfers",
                          file=sys.stderr)
                    self.assertLess(off_ms, 100)
                    changes = seen["changes"]
                    self.assertIn("ok", changes[changes.index("gone"):])
                    self.assertGreaterEqual(seen["device"]["reopened"], 1)

    def test_a_home_confirmed_once_is_lost_by_unplugging(self) -> None:
        for device in WOODEN:
            with self.subTest(device):
                seen, _ = self.run_wooden(device, 500, f"home_confirmed=once,{SIGNS}",
                                          "unplug=200:50")
                changes = seen["changes"]
                self.assertIn("ok", changes[:changes.index("gone")])
                self.assertNotIn("ok", changes[changes.index("gone"):])
                self.assertIn("not_homed", changes[changes.index("gone"):])

    def test_a_second_program_is_told_that_the_arm_is_in_use(self) -> None:
        # Of two the slower one ends, at once; the other one is ended then.
        script = ('for i in 1 2; do "$0" woodenhaptics 100000 "" > /dev/null & done; '
                  'wait -n; code=$?; kill $(jobs -p); wait; exit $code')
        code, _, messages, _ = self.run_command("wooden-v2", (), ["bash", "-c", script, CLIENT])
        self.assertEqual(code, 2)
        self.assertIn("in use by another program", messages)

    @unittest.skipIf(os.geteuid() != 0, "only root can become a user without permission")
    def test_a_missing_permission_is_told_with_its_cure(self) -> None:
        script = ('chmod -R a+rwX "$UMOCKDEV_DIR"; '
                  'exec setpriv --reuid=65534 --clear-groups "$0" woodenhaptics 10 ""')
        code, _, messages, _ = self.run_command("wooden-v1", (), ["sh", "-c", script, CLIENT])
        self.assertEqual(code, 2)
        self.assertIn("may not be opened by this user", messages)
        self.assertIn("70-spm-haptics.rules", messages)

    def test_a_board_of_no_known_length_is_refused(self) -> None:
        code, _, messages, _ = self.run_command("wooden-v1", ("short=1",),
                                                [CLIENT, "woodenhaptics", "10", ""])
        self.assertEqual(code, 2)
        self.assertIn("7 bytes", messages)

    def test_another_device_serial_number_or_protocol_is_not_found(self) -> None:
        for device, name, options in (("spacemouse", "woodenhaptics", ""),
                                      ("wooden-v1", "spacemouse", ""),
                                      ("wooden-v1", "woodenhaptics", "serial=X"),
                                      ("wooden-v1", "woodenhaptics", "protocol=v3"),
                                      ("wooden-v3", "woodenhaptics", "protocol=v2")):
            with self.subTest(device=device, name=name, options=options):
                code, _, messages, mock = self.run_command(device, (),
                                                           [CLIENT, name, "10", options])
                self.assertEqual(code, 2)
                self.assertIn("is plugged in: plug it in", messages)
                self.assertEqual(mock["reports"], 0)

    def test_a_spacemouse_moves_the_tool_and_silence_is_no_loss(self) -> None:
        seen, mock = self.run_client("spacemouse", 160)
        self.assertEqual(seen["changes"], ["ok"])
        self.assertEqual(seen["force_cap_N"], 0)
        self.assertGreater(seen["max_m"][0], 0.02)
        self.assertEqual(seen["min_m"], [0, 0, 0])
        self.assertEqual(seen["max_m"][1:], [0, 0])
        self.assertEqual(seen["buttons"], 1)
        # It is put out at the end, and before that if a busy machine makes the loop stall.
        self.assertIn(mock["light"], ([1, 0], [1, 0, 0]))
        self.assertEqual(list(seen["device"]["latency_us"]), ["report_age"])
        self.assertGreater(seen["device"]["latency_us"]["report_age"]["p50"], 0)

    def test_an_unplugged_spacemouse_is_gone_and_taken_up_again(self) -> None:
        seen, mock = self.run_client("spacemouse", 100, "", "unplug=40:50")
        self.assertGreaterEqual(mock["unplugged"], 1)
        self.assertEqual(seen["changes"][:3], ["ok", "gone", "ok"])
        self.assertLess(seen["farthest_step_m"], 0.005)


if __name__ == "__main__":
    MOCK, CLIENT = sys.argv[1:3]
    unittest.main(argv=sys.argv[:1] + sys.argv[3:], verbosity=2)
