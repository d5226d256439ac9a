#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Judges what the virtual machine told of its cases.

Usage: check_cases.py RESULTS FTDI_REPORT [unittest options], the file of the guest's second serial
port, and what ftdi_falcon.py saw. Latencies are printed, and decide nothing: the machine is emulated.
"""

import json
import sys
import unittest
from pathlib import Path

RESULTS = FTDI_REPORT = Path()
FIRMWARE_SIZE = 8492
LEAST_RATE = 900  # Hz, of 1000
HARMLESS = {"starting", "stopping", "device_silent"}  # causes of no force; in_time bounds them
FIGURES = []


def read_cases(path: Path) -> dict[str, dict]:
    """By name; what is told before a case's name belongs to it too."""
    cases, case = {}, {"messages": []}
    for line in path.read_text(encoding="utf-8", errors="replace").splitlines():
        word, _, rest = line.strip().partition(" ")
        if word in {"case", "done"}:
            cases[rest or word] = case
        elif word == "end":
            case = {"messages": []}
        elif word == "message":
            case["messages"].append(rest)
        elif word:
            try:
                case[word] = json.loads(rest)
            except ValueError:
                case["messages"].append(line)
    return cases


class VirtualMachine(unittest.TestCase):
    def __str__(self) -> str:
        return self._testMethodName.removeprefix("test_").replace("_", " ")

    @classmethod
    def setUpClass(cls) -> None:
        cls.cases = read_cases(RESULTS)

    @classmethod
    def tearDownClass(cls) -> None:
        print("\n" + "\n".join(FIGURES), file=sys.stderr)

    def case(self, name: str) -> dict:
        case = self.cases.get(name)
        self.assertTrue(case, "the virtual machine did not come to this case")
        self.assertEqual(case.get("exit"), 0, "\n".join(case["messages"]))
        return case

    def served(self, name: str, *may_be: str) -> tuple[dict, dict]:
        """The case, and its report: the daemon ran at its rate, and no packet was bad; `may_be` are
        causes of no force that belong to the case."""
        case = self.case(name)
        report = case["report"]
        device = report["devices"][0]
        off = {entry["cause"]: entry["count"] for entry in device["force_off"]}
        rate = report["rate_hz"] * report["ticks"] / (report["ticks"] + report["skipped"])
        wake, busy = report["wake_us"], report["busy_us"]
        FIGURES.append(
            f"{name:13}{rate:7.1f} Hz, {report['ticks']} ticks, {report['missed']} missed, in contact "
            f"in {report['contact_ticks']}, {report['page_faults']} page faults\n"
            f"{'':13} woke up late by p50 {wake['p50']:.0f}, p99 {wake['p99']:.0f}, max "
            f"{wake['max']:.0f} us, worked for p50 {busy['p50']:.0f}, p99 {busy['p99']:.0f}, max "
            f"{busy['max']:.0f} us\n{'':13} ticks without force: "
            + ", ".join(f"{count} {cause}" for cause, count in off.items()))
        self.assertEqual(report["realtime"]["policy"], "fifo")
        self.assertGreaterEqual(rate, LEAST_RATE)
        self.assertEqual(set(off) - HARMLESS - set(may_be), set(), off)
        if "device_gone" not in may_be:
            self.assertEqual(device["reopened"], 0)
        self.assertGreater(device["contact_ticks"], 100)
        self.assertGreater(device["force_max_n"], 0.5)
        return case, device

    def in_time(self, case: dict, taken: int) -> None:
        """Of a device in the machine itself, whose clock is the machine's: it was heard in nearly
        every tick, and heard of nearly every tick."""
        ticks = case["report"]["ticks"]
        off = sum(entry["count"] for entry in case["report"]["force_off"])
        self.assertGreaterEqual(ticks - off, ticks * LEAST_RATE / 1000)
        self.assertGreaterEqual(taken, ticks * LEAST_RATE / 1000)

    def wooden(self, name: str, *may_be: str) -> tuple[dict, dict]:
        case, device = self.served(name, *may_be)
        seen = case["seen"]
        FIGURES.append(f"{'':13} the board sent {seen['reports']} reports and took "
                       f"{seen['commands']} commands, {seen['wrong_commands']} of them wrong")
        if "device_gone" not in may_be:
            self.in_time(case, seen["commands"])
        self.assertEqual(case["emulator"], 0, case["messages"])
        self.assertEqual(seen["wrong_commands"], 0)
        self.assertGreater(seen["commands_with_current"], 100)
        self.assertEqual(seen["last_mA"], [0, 0, 0])
        found = case["devices"]["devices"]
        self.assertEqual([entry["driver"] for entry in found], ["woodenhaptics"])
        self.assertEqual((found[0]["kind"], found[0]["permitted"]), ("hidraw", True))
        return seen, device

    def follows_rules(self, seen: dict, boots: int) -> None:
        FIGURES.append(f"{'':13} the Falcon took {seen['packets']} packets, {seen['wrong_packets']} of "
                       f"them wrong, {seen['pushing_packets']} with force")
        self.assertEqual(seen["boots"], boots)
        self.assertEqual(seen["loaded_bytes"], FIRMWARE_SIZE)
        self.assertEqual(seen["wrong_packets"], 0)
        self.assertEqual(seen["packets_with_homing"], seen["packets"])
        self.assertEqual(seen["pushes_before_homing"], 0)
        self.assertGreater(seen["pushing_packets"], 100)
        self.assertLessEqual(seen["largest_motor"], 4096)
        self.assertEqual(seen["last_motors"], [0, 0, 0])

    def falcon(self, name: str, boots: int, *may_be: str) -> tuple[dict, dict]:
        case, device = self.served(name, "not_homed", *may_be)
        self.follows_rules(case["seen"], boots)
        if "device_gone" not in may_be:
            self.in_time(case, case["seen"]["packets"])
        self.assertEqual(case["emulator"], 0, case["messages"])
        self.assertTrue(device["homed"])
        self.assertEqual(device["firmware_uploads"], boots)
        found = case["devices"]["devices"]
        self.assertEqual([entry["driver"] for entry in found], ["falcon"])
        self.assertEqual((found[0]["kind"], found[0]["permitted"]), ("usb", True))
        return case["seen"], device

    def test_uhid_boards_of_each_protocol_are_told_followed_and_pushed(self) -> None:
        for protocol in ("v1", "v2", "v3"):
            with self.subTest(protocol):
                _, device = self.wooden(f"uhid_{protocol}")
                self.assertEqual(device["protocol"], protocol)

    def test_uhid_board_unplugged_three_times_is_taken_up_each_time(self) -> None:
        seen, device = self.wooden("uhid_replug", "device_gone")
        self.assertEqual(seen["unplugged"], 3)
        self.assertEqual(device["reopened"], 3)
        self.assertGreater(seen["commands_with_current_since_plugged_in"], 50)

    def test_usbip_falcon_is_given_firmware_homed_followed_and_pushed(self) -> None:
        self.falcon("usbip", 1)

    def test_usbip_falcon_unplugged_twice_is_taken_up_each_time(self) -> None:
        seen, device = self.falcon("usbip_replug", 1, "device_gone")
        self.assertEqual(seen["unplugged"], 2)
        self.assertEqual(device["reopened"], 2)
        self.assertGreater(seen["pushing_packets_since_plugged_in"], 50)

    def test_usbip_falcon_that_lost_its_power_is_given_firmware_and_homed_again(self) -> None:
        seen, device = self.falcon("usbip_power", 2, "device_gone")
        self.assertEqual(seen["unplugged"], 1)
        self.assertEqual(device["reopened"], 1)
        self.assertGreater(seen["pushing_packets_since_plugged_in"], 50)

    def test_ftdi_chip_of_qemu_is_taken_from_the_kernels_driver_and_given_back(self) -> None:
        case, device = self.served("ftdi", "not_homed")
        self.assertTrue(case["driver_before"])
        self.assertTrue(case["driver_after"])
        self.assertTrue(device["homed"])
        self.follows_rules(json.loads(FTDI_REPORT.read_text(encoding="utf-8")), 1)

    def test_the_machine_came_to_its_end(self) -> None:
        self.assertIn("done", list(self.cases))


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    RESULTS, FTDI_REPORT = map(Path, sys.argv[1:3])
    unittest.main(argv=sys.argv[:1] + sys.argv[3:], verbosity=2)
