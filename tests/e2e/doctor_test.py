#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The servo's tools, and what goes beside the programs: rules, service, man pages, completion."""

import glob
import json
import os
import re
import shutil
import struct
import subprocess
import time
import unittest

from programs import BIN, NOBODY, SERVO, Case, public_copy, run

PACKAGING = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "scripts",
                         "packaging")
PERCENTILES = {"p50", "p99", "p999", "max"}
VERDICTS = {"good", "fair", "poor", "unknown"}


def called(*arguments, environment=None):
    return subprocess.run(arguments, capture_output=True, text=True, timeout=60, check=False,
                          env={**os.environ, "LC_ALL": "C.UTF-8", **(environment or {})})


def packaged(name):
    return os.path.join(PACKAGING, name)


def haptics_may_be_plugged_in():
    return bool(glob.glob("/dev/hidraw*") or glob.glob("/sys/bus/usb/devices/*-*")
                or glob.glob("/dev/serial/by-id/*"))


def usb_device(port, address, vendor, product, name, serial):
    """A USB device of umockdev's, on the root hub's port."""
    descriptors = (struct.pack("<BBHBBBBHHHBBBB", 18, 1, 0x0200, 0, 0, 0, 64, vendor, product, 0x100,
                               1, 2, 3, 1)
                   + struct.pack("<BBHBBBBB", 9, 2, 18, 1, 1, 0, 0x80, 50)
                   + struct.pack("<BBBBBBBBB", 9, 4, 0, 0, 0, 0xFF, 0, 0, 0))
    where = f"-{port}" if port else None
    path = "/devices/pci0000:00/0000:00:14.0/usb1" + (f"/1{where}" if where else "")
    return "\n".join([
        f"P: {path}", f"N: bus/usb/001/{address:03}", "E: SUBSYSTEM=usb", "E: DEVTYPE=usb_device",
        f"E: DEVNAME=/dev/bus/usb/001/{address:03}", "E: BUSNUM=001", f"E: DEVNUM={address:03}",
        "A: busnum=1\\n", f"A: devnum={address}\\n", f"A: devpath={port}\\n", "A: speed=12\\n",
        "A: bConfigurationValue=1\\n", f"A: idVendor={vendor:04x}\\n",
        f"A: idProduct={product:04x}\\n", "A: manufacturer=maker\\n", f"A: product={name}\\n",
        f"A: serial={serial}\\n", f"H: descriptors={descriptors.hex().upper()}", "", ""])


def hid_device(port, vendor, product, name, serial, report_descriptor):
    """The interface, HID device and hidraw node on top of usb_device."""
    interface = f"/devices/pci0000:00/0000:00:14.0/usb1/1-{port}/1-{port}:1.0"
    hid = f"{interface}/0003:{vendor:04X}:{product:04X}.{port:04X}"
    ids = f"0003:{vendor:08X}:{product:08X}"
    return "\n".join([
        f"P: {interface}", "E: SUBSYSTEM=usb", "E: DEVTYPE=usb_interface",
        "A: bInterfaceNumber=00\\n", "",
        f"P: {hid}", "E: SUBSYSTEM=hid", f"E: HID_ID={ids}", f"E: HID_NAME={name}",
        f"E: HID_UNIQ={serial}", f"A: uevent=HID_ID={ids}\\nHID_NAME={name}\\nHID_UNIQ={serial}\\n",
        f"H: report_descriptor={report_descriptor}", "",
        f"P: {hid}/hidraw/hidraw{port}", f"N: hidraw{port}", "E: SUBSYSTEM=hidraw",
        f"E: DEVNAME=/dev/hidraw{port}",
        f"L: device=../../../0003:{vendor:04X}:{product:04X}.{port:04X}", "", ""])


def plugged_in():
    """A Falcon, a WoodenHaptics, a SpaceMouse, a force feedback joystick, and a plain mouse."""
    plain = usb_device(0, 1, 0x1D6B, 0x0002, "hub", "0") + usb_device(2, 5, 0x0403, 0xCB48,
                                                                      "FALCON HAPTIC", "F2")
    for port, vendor, product, name, descriptor in (
            (3, 0x1234, 0x0006, "HID DEVICE", "06ABFF0A0002A101C0"),
            (4, 0x256F, 0xC635, "SpaceMouse Compact", "05010908A101C0"),
            (5, 0x1209, 0xFFB0, "FFBoard", "05010904A101050F0973A102C0C0"),
            (6, 0x1209, 0x0001, "Mouse", "05010902A101C0")):
        plain += usb_device(port, port + 10, vendor, product, name, f"S{port}")
        plain += hid_device(port, vendor, product, name, f"S{port}", descriptor)
    return plain


class Devices(Case):
    def test_every_device_is_told_with_what_it_needs(self):
        report = self.run_json("devices", program=SERVO)
        self.assertIsInstance(report["usb_devices"], int)
        for device in report["devices"]:
            self.assertLessEqual({"driver", "product", "serial", "ids", "node", "permitted", "cure"},
                                 set(device))
            self.assertEqual(device["permitted"], device["cure"] is None)

    @unittest.skipIf(haptics_may_be_plugged_in(), "something is plugged in")
    def test_nothing_plugged_in_is_an_empty_list(self):
        self.assertEqual(self.run_json("devices", program=SERVO)["devices"], [])
        text = run("devices", program=SERVO)
        self.assertEqual(text.returncode, 0, text.stderr)
        self.assertIn("No haptic device", text.stdout)

    def test_a_user_without_rights_gets_an_answer_too(self):
        user = NOBODY if os.geteuid() == 0 else None
        self.assertEqual(run("devices", "--json", program=SERVO, user=user).returncode, 0)

    def test_quiet_says_nothing(self):
        result = run("devices", "--quiet", program=SERVO)
        self.assertEqual((result.returncode, result.stdout, result.stderr), (0, "", ""))

    @unittest.skipUnless(shutil.which("umockdev-run"), "there is no umockdev-run")
    def test_devices_are_found_by_the_libraries_that_drive_them(self):
        if "asan" in called("ldd", SERVO).stdout:
            self.skipTest("a sanitizer and umockdev both want to be loaded first")
        result = called("umockdev-run", "--device", self.write("plugged.umockdev", plugged_in()),
                        "--", SERVO, "devices", "--json")
        self.assertEqual(result.returncode, 0, result.stderr)
        found = {device["driver"]: device for device in json.loads(result.stdout)["devices"]}
        self.assertEqual(set(found), {"falcon", "woodenhaptics", "spacemouse", "pid"})
        self.assertEqual(found["falcon"]["device"], "falcon:path=1-2")
        self.assertEqual(found["falcon"]["node"], "/dev/bus/usb/001/005")
        self.assertEqual(found["falcon"]["product"], "FALCON HAPTIC")
        self.assertEqual(found["woodenhaptics"]["ids"], "1234:0006")
        self.assertEqual(found["woodenhaptics"]["usb"], "1-3")
        self.assertEqual(found["spacemouse"]["device"], "spacemouse:serial=S4")
        self.assertEqual(found["pid"]["node"], "/dev/hidraw5")

    @unittest.skipUnless(os.geteuid() == 0 and shutil.which("umockdev-run")
                         and shutil.which("setpriv"), "needs root, umockdev-run and setpriv")
    def test_a_device_that_may_not_be_opened_is_told_with_its_udev_line(self):
        if "asan" in called("ldd", SERVO).stdout:
            self.skipTest("a sanitizer and umockdev both want to be loaded first")
        # The nodes of hidraw devices are terminals of root's.
        result = called("umockdev-run", "--device", self.write("plugged.umockdev", plugged_in()),
                        "--", "sh", "-c", 'chmod 755 "$UMOCKDEV_DIR"; exec setpriv "$@"', "sh",
                        f"--reuid={NOBODY}", f"--regid={NOBODY}", "--clear-groups",
                        public_copy(SERVO), "devices", "--json")
        self.assertEqual(result.returncode, 0, result.stderr)
        found = {device["driver"]: device for device in json.loads(result.stdout)["devices"]}
        self.assertIs(found["spacemouse"]["permitted"], False)
        self.assertEqual(found["spacemouse"]["udev_rule"],
                         'SUBSYSTEM=="hidraw", ATTRS{idVendor}=="256f", ATTRS{idProduct}=="c635", '
                         'TAG+="uaccess"')
        self.assertIn(found["spacemouse"]["udev_rule"], found["spacemouse"]["cure"])
        self.assertIn("udevadm control --reload", found["spacemouse"]["cure"])


class Doctor(Case):
    def check_report(self, report):
        self.assertIn(report["verdict"], VERDICTS)
        self.assertEqual(set(report["wake_us"]), PERCENTILES)
        self.assertGreater(report["ticks"], 0)
        self.assertGreaterEqual(report["ticks"] + report["wake_late"]["skipped"],
                                report["seconds"] * report["rate_hz"])
        self.assertGreaterEqual(report["wake_late"]["us_200"], report["wake_late"]["us_1000"])
        self.assertIsInstance(report["realtime"]["memory_locked"], bool)
        self.assertIsInstance(report["devices"], list)
        names = [check["name"] for check in report["checks"]]
        self.assertEqual(len(names), len(set(names)))
        self.assertLessEqual({"wake_up", "scheduling", "memory_lock", "governor", "virtual", "kernel",
                              "devices", "usb_round_trip"}, set(names))
        for check in report["checks"]:
            with self.subTest(check["name"]):
                self.assertLessEqual({"name", "verdict", "measured", "cure"}, set(check))
                self.assertIn(check["verdict"], VERDICTS)
                if check["verdict"] in ("fair", "poor"):
                    self.assertTrue(check["cure"])

    def test_a_short_look_reports_everything_and_ends(self):
        began = time.monotonic()
        report = self.run_json("doctor", "--seconds", "1", program=SERVO)
        self.assertLess(time.monotonic() - began, 30)
        self.assertEqual(report["seconds"], 1)
        self.check_report(report)

    def test_limits_of_zero_are_told_and_no_failure(self):
        if os.geteuid() == 0:
            result = run("doctor", "--seconds", "0.2", "--json", program=SERVO, user=NOBODY)
        else:
            result = called("sh", "-c", f"ulimit -r 0; exec '{SERVO}' doctor --seconds 0.2 --json")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(len(result.stdout.splitlines()), 1)

    def test_the_text_begins_with_the_answer(self):
        result = run("doctor", "--seconds", "0.1", program=SERVO)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertRegex(result.stdout.splitlines()[0],
                         r"^Is this machine fit for a loop at 1000 Hz\? (good|fair|poor): ")
        self.assertIn("scheduling", result.stdout)

    def test_a_time_that_will_not_do_is_a_usage_error(self):
        for seconds in ("0", "21", "-1", "nan", "1s", "many"):
            with self.subTest(seconds):
                self.expect_refusal(run("doctor", f"--seconds={seconds}", program=SERVO), 1,
                                    "--seconds", "0.1 to 20")


class Packaging(Case):
    @unittest.skipUnless(shutil.which("udevadm"), "there is no udevadm")
    def test_udev_takes_the_rules(self):
        if "verify" not in called("udevadm", "--help").stdout:
            self.skipTest("this udevadm cannot verify")
        result = called("udevadm", "verify", packaged("70-spm-haptics.rules"))
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)

    def test_the_rules_grant_to_the_user_at_the_machine_only(self):
        with open(packaged("70-spm-haptics.rules"), encoding="utf-8") as file:
            rules = [line.rstrip("\n") for line in file
                     if line.strip() and not line.startswith("#")]
        self.assertEqual(rules[0], 'ACTION=="remove", GOTO="spm_haptics_end"')
        self.assertEqual(rules[-1], 'LABEL="spm_haptics_end"')
        match = r'[A-Z]+(\{[A-Za-z]+\})?=="[^"]*"'
        for rule in rules[1:-1]:
            self.assertRegex(rule, rf'^{match}(, {match})+, TAG\+="uaccess"$')
        for ids in ("0403.*cb48", "1234.*0006", "16c0.*0486", "046d.*c626", "256f.*c635"):
            self.assertTrue(any(rule.startswith('SUBSYSTEM=="usb"') and re.search(ids, rule)
                                for rule in rules), ids)

    @unittest.skipUnless(shutil.which("systemd-analyze"), "there is no systemd-analyze")
    def test_systemd_takes_the_services(self):
        for name, manager in (("spm-servo.service", "--user"),
                              ("spm-servo-system.service", "--system")):
            with self.subTest(name):
                with open(packaged(name), encoding="utf-8") as file:
                    unit = file.read()
                self.assertIn("/usr/local/bin/spm-servo ", unit)
                # The program is not installed here, and neither are its man pages.
                unit = unit.replace("/usr/local/bin/spm-servo", SERVO)
                path = self.write(name, re.sub("(?m)^Documentation=.*\n", "", unit))
                result = called("systemd-analyze", manager, "verify", path,
                                environment={"XDG_RUNTIME_DIR": self.folder})
                self.assertEqual(result.returncode, 0, result.stderr)
                self.assertNotIn(name, result.stderr)

    def test_both_services_supervise_the_daemon_alike(self):
        keys = ("StartLimitIntervalSec", "StartLimitBurst", "Type", "NotifyAccess", "KillSignal",
                "TimeoutStopSec", "KillMode", "OOMPolicy", "WatchdogSec", "Restart", "RestartSec",
                "RestartPreventExitStatus", "OOMScoreAdjust", "DevicePolicy")
        units = []
        for name in ("spm-servo.service", "spm-servo-system.service"):
            with open(packaged(name), encoding="utf-8") as file:
                pairs = [line.rstrip("\n").split("=", 1) for line in file
                         if "=" in line and not line.startswith("#")]
            lines = dict(pairs)
            units.append({key: lines.get(key) for key in keys})
            allowed = {value for key, value in pairs if key == "DeviceAllow"}
            self.assertEqual(allowed, {"char-usb_device rw", "char-hidraw rw", "char-ttyACM rw",
                                       "/dev/cpu_dma_latency rw"})
        self.assertEqual(units[0], units[1])
        self.assertNotIn(None, units[0].values())
        self.assertEqual((units[0]["KillMode"], units[0]["Type"]), ("process", "notify"))
        self.assertEqual(units[0]["DevicePolicy"], "closed")
        self.assertLess(int(units[0]["OOMScoreAdjust"]), 0)

    def test_the_limits_are_for_the_group_alone(self):
        with open(packaged("95-spm-haptics.conf"), encoding="utf-8") as file:
            lines = [line.split() for line in file if line.strip() and not line.startswith("#")]
        self.assertEqual(lines, [["@spm-haptics", "-", "rtprio", "90"],
                                 ["@spm-haptics", "-", "memlock", "unlimited"]])

    @unittest.skipUnless(shutil.which("groff"), "there is no groff")
    def test_groff_has_nothing_to_say_about_the_man_pages(self):
        for name in ("spm-servo.1", "spm-bake.1"):
            with self.subTest(name):
                result = called("groff", "-ww", "-man", "-Tutf8", packaged(name))
                self.assertEqual((result.returncode, result.stderr), (0, ""))
                # Bold letters are struck twice.
                self.assertIn("EXIT STATUS", re.sub(".\b", "", result.stdout))

    def test_the_man_pages_are_what_the_programs_say(self):
        result = called(packaged("make_man_pages"), BIN, "--check")
        self.assertEqual(result.returncode, 0, result.stderr)

    @unittest.skipUnless(shutil.which("bash"), "there is no bash")
    def test_completion_knows_what_the_programs_know(self):
        script = """
            set -u
            . "$1" || exit 9
            shift
            COMP_WORDS=("$@")
            COMP_CWORD=$((${#COMP_WORDS[@]} - 1))
            _spm_complete "$1" "${COMP_WORDS[COMP_CWORD]}" "${COMP_WORDS[COMP_CWORD - 1]}"
            printf '%s\\n' "${COMPREPLY[@]}"
        """
        for words, expected in ((("spm-bake", "b"), ["batch", "build"]),
                                (("spm-servo", "dev"), ["devices"]),
                                (("spm-servo", "doctor", "--sec"), ["--seconds"]),
                                (("spm-bake", "build", "--form", ""), ["full", "sparse"]),
                                (("spm-bake", "build", "--form", "=", "f"), ["full"]),
                                (("spm-bake", "build", "--probe", "s"), ["sphere:"]),
                                (("spm-servo", "run", "--device", ""),
                                 ["auto", "external:", "falcon", "pid:", "sim", "spacemouse",
                                  "woodenhaptics"]),
                                (("spm-servo", "run", "--method", "p"), ["paper", "proxy"]),
                                (("spm-servo", "replay", "--method", "s"), ["spm"]),
                                (("spm-bake", "build", "mesh"), [])):
            with self.subTest(" ".join(words)):
                result = called("bash", "--norc", "-c", script, "bash",
                                packaged("spm-completion.bash"), *words,
                                environment={"PATH": BIN + os.pathsep + os.environ["PATH"]})
                self.assertEqual((result.returncode, result.stderr), (0, ""))
                self.assertEqual(sorted(result.stdout.split()), expected)


if __name__ == "__main__":
    unittest.main()
