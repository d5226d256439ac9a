#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Kills the real spm-servo while it drives devices that umockdev plugs in, and looks what these
heard last: zero force from its supervisor, or without one the daemon's last command.

Usage: supervisor_test.py MOCK_HID MOCK_FALCON SERVO BAKE [unittest options], the programs mock_hid,
mock_usb_falcon, spm-servo and spm-bake. No time decides a test.
"""

import json
import os
import signal
import subprocess
import sys
import tempfile
import time
import unittest
from collections.abc import Callable
from functools import partial
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[3] / "support"))

from baked_tetrahedron import bake_tetrahedron  # noqa: E402

MOCK_HID = MOCK_FALCON = SERVO = BAKE = ""
LONGEST_RUN = 120  # s
MOST_KILLS = 5
CONFUSED = 70  # exit code of the program that emulates HID devices
# The motors hold the arm's weight, wherever it is: there is a current in every tick.
WOODEN = "woodenhaptics:home_confirmed=always,gravity=on,signs=+++"
SENTENCE = "error: spm-servo ended without a good-bye, killed or crashed: zero force was sent to "


def drives(trace: Path) -> bool:
    """Whether a daemon has written the first rows of its trace, which are some hundred ticks; until
    its end into a file of a longer name."""
    return any(path.stat().st_size > 0 for path in trace.parent.glob(trace.name + "*"))


def only_supervisor(daemon: int) -> int:
    """The only child of a daemon, which runs; a child that has ended and was not waited for is one
    too."""
    children = [child for task in Path(f"/proc/{daemon}/task").iterdir()
                for child in (task / "children").read_text(encoding="utf-8").split()]
    if len(children) != 1:
        sys.exit(f"the daemon has the children {children}")
    state = Path(f"/proc/{children[0]}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()[0]
    if state == "Z":
        sys.exit("the supervisor that ended was not waited for")
    return int(children[0])


def end(how: str, trace: str, *command: str) -> int:
    """Beside the device: starts a daemon, ends it once it drives the device, and waits until nobody
    holds its standard error any longer, its supervisor neither. `how`: kill, end, moved, which
    kills once the device was lost and is driven again, or unguarded, which kills the supervisor,
    twice, and the daemon once it has another."""
    with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                          text=True) as daemon:
        while daemon.poll() is None and not drives(Path(trace)):
            time.sleep(0.005)
        said = ""
        for _ in range(2 if how == "unguarded" else 0):
            os.kill(only_supervisor(daemon.pid), signal.SIGKILL)
            line = daemon.stderr.readline()
            while line and "it was started again" not in line:
                line = daemon.stderr.readline()
            said += line
            only_supervisor(daemon.pid)
        while how == "moved" and not ("device_gone" in said and said.endswith("on again\n")):
            line = daemon.stderr.readline()
            if not line:
                return 1
            said += line
        sys.stderr.write(said)
        daemon.send_signal(signal.SIGTERM if how == "end" else signal.SIGKILL)
        sys.stderr.write(daemon.stderr.read())
    expected = 0 if how == "end" else -signal.SIGKILL
    return 0 if daemon.returncode == expected else 1


class KilledDaemon(unittest.TestCase):
    @classmethod
    def setUpClass(cls) -> None:
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.folder = Path(folder.name)
        cls.asset = bake_tetrahedron(BAKE, cls.folder)

    def run_beside(self, mock: list[str], device: str, how: str, supervisor: str,
                   may_confuse: bool = False) -> tuple[str, dict]:
        """What the daemon and its supervisor said, and what the device saw. `may_confuse`: also
        where the device was sent what its protocol does not know."""
        folder = tempfile.TemporaryDirectory(dir=self.folder)
        self.addCleanup(folder.cleanup)
        trace = Path(folder.name) / "trace.csv"
        command = [SERVO, "run", "--asset", self.asset, "--device", device, "--trace", trace,
                   "--socket", "off", "--black-box", "off", "--supervisor", supervisor,
                   *([] if how in ("moved", "unguarded") else ["--quiet"])]
        inside = [sys.executable, __file__, "--end", how, trace, *command]
        done = subprocess.run([*mock, "--", *inside], capture_output=True, text=True,
                              timeout=LONGEST_RUN, check=False)
        messages, _, last = done.stderr.rstrip("\n").rpartition("\n")
        self.assertIn(done.returncode, [0, CONFUSED] if may_confuse else [0], done.stderr)
        self.assertTrue(last.startswith("{"), done.stderr)
        return messages, json.loads(last)

    def run_wooden(self, device: str, how: str, supervisor: str) -> tuple[str, dict]:
        named = f"{WOODEN},protocol={device[-2:]}"
        said, seen = self.run_beside([MOCK_HID, device], named, how, supervisor)
        self.assertEqual(seen["wrong_commands"], 0, seen)
        self.assertGreater(seen["commands_with_current"], 10, seen)
        return said, seen

    def test_a_wooden_arm_is_sent_no_current_after_the_daemon_was_killed(self) -> None:
        for device in ("wooden-v1", "wooden-v2", "wooden-v3"):
            with self.subTest(device):
                said, seen = self.run_wooden(device, "kill", "on")
                self.assertEqual(seen["last_mA"], [0, 0, 0])
                self.assertIn(f"{SENTENCE}woodenhaptics:protocol={device[-2:]},serial=", said)

    def test_a_supervisor_that_was_killed_is_started_again_and_ends_the_force(self) -> None:
        said, seen = self.run_wooden("wooden-v2", "unguarded", "on")
        self.assertEqual(said.count("had ended, killed or crashed: it was started again"), 2)
        self.assertIn(f"{SENTENCE}woodenhaptics:protocol=v2,serial=", said)
        self.assertEqual(seen["last_mA"], [0, 0, 0])

    def leaves(self, forceful: Callable[[dict], bool], run: Callable[[], tuple[str, dict]]) -> bool:
        """Whether some daemon without a supervisor left its device so when it was killed; one that
        the machine kept waiting just then had sent zero force itself."""
        for _ in range(MOST_KILLS):
            said, seen = run()
            self.assertNotIn("good-bye", said)
            if forceful(seen):
                return True
        return False

    def test_without_a_supervisor_a_wooden_arm_keeps_its_currents(self) -> None:
        for device in ("wooden-v1", "wooden-v2", "wooden-v3"):
            with self.subTest(device):
                self.assertTrue(self.leaves(lambda seen: any(seen["last_mA"]),
                                            partial(self.run_wooden, device, "kill", "off")))

    def test_after_a_clean_end_no_motor_holds_a_current_and_the_supervisor_is_silent(self) -> None:
        for device in ("wooden-v1", "wooden-v2", "wooden-v3"):
            for supervisor in ("on", "off"):
                with self.subTest(device, supervisor=supervisor):
                    said, seen = self.run_wooden(device, "end", supervisor)
                    self.assertNotIn("good-bye", said)
                    self.assertEqual(seen["last_mA"], [0, 0, 0])

    def test_a_stick_s_effects_are_ended_after_the_daemon_was_killed(self) -> None:
        said, seen = self.run_stick("on", 4)
        self.assertEqual([seen["playing"], *seen["last_force"]], [0, 0, 0])
        self.assertIn(SENTENCE + "pid:full_force=1N,serial=", said)
        self.assertTrue(self.leaves(lambda seen: seen["playing"] > 0,
                                    partial(self.run_stick, "off", 2)))

    def run_stick(self, supervisor: str, resets: int) -> tuple[str, dict]:
        """Of a daemon that was never kept waiting: one that is has its stick reset meanwhile, which
        then does not know the daemon's effects any longer."""
        for _ in range(MOST_KILLS):
            # Without its watchdog they are endless.
            said, seen = self.run_beside([MOCK_HID, "pid"], "pid:full_force=4N,watchdog=off",
                                         "kill", supervisor, may_confuse=True)
            if seen["resets"] == resets:
                break
        self.assertEqual((seen["resets"], seen["wrong_commands"]), (resets, 0), seen)
        return said, seen

    def test_a_falcon_hears_a_last_packet_that_no_daemon_sends(self) -> None:
        # A running daemon lights one of its lamps in every packet; the supervisor's have no lamp.
        mock = [MOCK_FALCON, "--mode", "running"]
        said, seen = self.run_beside(mock, "falcon", "kill", "on")
        self.assertTrue(seen["rules_kept"], seen)
        self.assertEqual(seen["boots"], 0)
        self.assertEqual(seen["last_lights"], 0)
        self.assertIn(SENTENCE + "falcon:path=1-2", said)
        self.assertTrue(self.leaves(lambda seen: seen["last_lights"] != 0,
                                    partial(self.run_beside, mock, "falcon", "kill", "off")))

    def test_a_falcon_that_was_plugged_in_elsewhere_hears_the_last_packet_there(self) -> None:
        # A loss late enough that there was force before it.
        mock = [MOCK_FALCON, "--mode", "move", "--act-after", "1000", "--replug-ms", "100"]
        for _ in range(MOST_KILLS):
            said, seen = self.run_beside(mock, "falcon", "moved", "on")
            # A daemon that was kept waiting loses it before: its supervisor takes it then.
            if seen["unplugged"] == 1:
                break
        self.assertTrue(seen["rules_kept"], seen)
        self.assertEqual(seen["unplugged"], 1)
        self.assertEqual(seen["last_lights"], 0)
        self.assertIn(SENTENCE + "falcon:path=1-3", said)


if __name__ == "__main__":
    if sys.argv[1:2] == ["--end"]:
        sys.exit(end(*sys.argv[2:]))
    MOCK_HID, MOCK_FALCON, SERVO, BAKE = sys.argv[1:5]
    unittest.main(argv=sys.argv[:1] + sys.argv[5:], verbosity=2)
