#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Stops, freezes, kills and spins the real spm-servo while it drives a WoodenHaptics that umockdev
plugs in, and measures after which time no motor had a current any longer.

Usage: stall_test.py MOCK_HID MOCK_FALCON SERVO BAKE SPINNING [unittest options], the programs
mock_hid, mock_usb_falcon, spm-servo and spm-bake, and the library spinning_loop. TIMES in the
environment says how often each
is done (default 5). Prints the times, which a busy machine lengthens; the tests ask only that the
force went off while the daemon was away.
"""

import json
import os
import signal
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[3] / "support"))

from baked_tetrahedron import bake_tetrahedron  # noqa: E402

MOCK_HID = MOCK_FALCON = SERVO = BAKE = SPINNING = ""
TIMES = int(os.environ.get("TIMES", "5"))
LONGEST_RUN = 600  # s
AWAY = 0.3  # s, which the daemon is stopped, or spins
BRIEFLY = 0.04  # s, longer than the supervisor waits before it takes a Falcon
MOST_WAIT = 20  # s
# The motors hold the arm's weight, wherever it is: there is a current in every tick.
WOODEN = "woodenhaptics:home_confirmed=always,gravity=on,signs=+++"


def go_away(how: str, daemon: subprocess.Popen, folder: Path) -> int:
    """Makes the daemon stand still for a while; gives when that began, ns."""
    if how in ("stop", "pause"):
        began = time.monotonic_ns()
        daemon.send_signal(signal.SIGSTOP)
        time.sleep(AWAY if how == "stop" else BRIEFLY)
        daemon.send_signal(signal.SIGCONT)
    else:
        (folder / "spin").touch()
        while (folder / "spin").exists():
            time.sleep(0.0005)
        time.sleep(AWAY)
        began = int((folder / "spin.began").read_text(encoding="utf-8"))
    time.sleep(0.25)  # it gives force again
    return began


def inside(how: str, times: str, folder: str, *command: str) -> int:
    """Beside the device: starts a daemon, makes it stand still several times, and ends it. Its
    report goes to the standard output, with the times."""
    environment = dict(os.environ)
    if how == "spin":
        environment["SPIN_AT"] = str(Path(folder) / "spin")
        environment["SPIN_BEGAN"] = str(Path(folder) / "spin.began")
        environment["LD_PRELOAD"] += f":{os.environ['SPINNING']}"
    trace = Path(folder) / "trace.csv"
    with subprocess.Popen([*command, "--trace", trace], stdout=subprocess.PIPE, text=True,
                          env=environment) as daemon:
        while daemon.poll() is None and not any(
                path.stat().st_size > 0 for path in trace.parent.glob(trace.name + "*")):
            time.sleep(0.005)
        if how == "kill":
            began = [time.monotonic_ns()]
            daemon.send_signal(signal.SIGKILL)
            time.sleep(AWAY)
            print(json.dumps({"began": began, "report": {}}))
            return 0
        began = [go_away(how, daemon, Path(folder)) for _ in range(int(times))]
        daemon.send_signal(signal.SIGTERM)
        report = json.loads(daemon.stdout.read())
    print(json.dumps({"began": began, "report": report}))
    return daemon.returncode


class AwayDaemon(unittest.TestCase):
    @classmethod
    def setUpClass(cls) -> None:
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.folder = Path(folder.name)
        cls.asset = bake_tetrahedron(BAKE, cls.folder)

    def run_beside(self, how: str, times: int, *options: str) -> tuple[list[float], dict, dict]:
        """After which times the current ended, ms (infinity for never, 0 where there was none just
        then); what the daemon reported, and what the device saw."""
        folder = tempfile.TemporaryDirectory(dir=self.folder)
        self.addCleanup(folder.cleanup)
        command = [SERVO, "run", "--asset", self.asset, "--device", WOODEN, "--socket", "off",
                   "--black-box", "off", "--json", *options]
        done = subprocess.run(
            [MOCK_HID, "wooden-v2", "--", sys.executable, __file__, "--inside", how, str(times),
             folder.name, *command], capture_output=True, text=True, timeout=LONGEST_RUN,
            check=False, env={**os.environ, "SPINNING": SPINNING})
        self.assertEqual(done.returncode, 0, done.stderr)
        told = json.loads(done.stdout)
        seen = json.loads(done.stderr.rstrip("\n").rpartition("\n")[2])
        off = []
        for began in told["began"]:
            ended = [at for at in seen["current_ended_ns"] if at > began]
            changes = sum(at <= began for key in ("current_began_ns", "current_ended_ns")
                          for at in seen[key])
            flows = changes % 2 == 1
            off.append(0 if not flows else (ended[0] - began) / 1e6 if ended else float("inf"))
        seen["deaf"] = [any(end > began and start < began + AWAY * 1e9
                            for start, end in seen["deaf_ns"]) for began in told["began"]]
        return off, told["report"], seen

    def test_a_falcon_that_its_supervisor_took_is_back_when_the_loop_goes_on(self) -> None:
        folder = tempfile.TemporaryDirectory(dir=self.folder)
        self.addCleanup(folder.cleanup)
        done = subprocess.run(
            [MOCK_FALCON, "--mode", "running", "--", sys.executable, __file__, "--inside", "pause",
             str(TIMES), folder.name, SERVO, "run", "--asset", self.asset, "--device", "falcon",
             "--socket", "off", "--black-box", "off", "--json"],
            capture_output=True, text=True, timeout=LONGEST_RUN, check=False,
            env={**os.environ, "SPINNING": SPINNING})
        self.assertEqual(done.returncode, 0, done.stderr)
        report = json.loads(done.stdout)["report"]
        lost = report["devices"][0]["reopened"]
        causes = {entry["cause"]: entry["count"] for entry in report["force_off"]}
        self.assertGreaterEqual(lost, 1, report)
        gone = causes["device_gone"] / lost
        print(f"a Falcon that was lost {lost} times: gone for {gone:.1f} ticks each (mean)",
              file=sys.stderr)
        self.assertLess(gone, 150)
        self.assertGreater(report["ticks"] - sum(causes.values()), 100)

    def show(self, what: str, off: list[float]) -> None:
        off = sorted(off)
        print(f"{what}: off after {off[len(off) // 2]:.1f} ms (median), {off[-1]:.1f} ms (most), "
              f"{sum(time > 30 for time in off)} of {len(off)} later than 30 ms", file=sys.stderr)

    def test_a_stopped_daemon_s_force_ends_while_it_is_stopped_and_comes_back_softly(self) -> None:
        off, report, seen = self.run_beside("stop", TIMES)
        self.show("stopped", off)
        # A stop in the midst of an exchange with umockdev holds the emulated device too, which then
        # hears nobody, and tells so; a kernel does not wait for a program. Seen in 1 of 8 stops.
        heard = [time for time, deaf in zip(off, seen["deaf"]) if not deaf]
        self.assertGreater(len(heard), 0, off)
        self.assertLess(max(heard), AWAY * 1e3, off)
        causes = {entry["cause"]: entry["count"] for entry in report["force_off"]}
        self.assertGreaterEqual(causes.get("stalled", 0) + causes.get("device_silent", 0), TIMES)
        self.assertGreaterEqual(len(seen["current_began_ns"]), TIMES)
        self.assertEqual(seen["last_mA"], [0, 0, 0])

    def test_a_killed_daemon_s_force_ends(self) -> None:
        off = [time for _ in range(TIMES) for time in self.run_beside("kill", 1)[0]]
        self.show("killed", off)
        self.assertLess(max(off), AWAY * 1e3)

    def test_a_spinning_loop_s_force_ends_while_it_spins_on_the_one_core(self) -> None:
        core = str(min(os.sched_getaffinity(0)))
        for supervisor in ("on", "off"):
            with self.subTest(supervisor=supervisor):
                off, report, _ = self.run_beside("spin", TIMES, "--core", core, "--supervisor",
                                                 supervisor)
                if report["realtime"]["priority"] != 80:
                    self.skipTest("no real-time priority may be had")
                self.show(f"spinning, supervisor {supervisor}", off)
                self.assertLess(max(off), AWAY * 1e3)


if __name__ == "__main__":
    if sys.argv[1:2] == ["--inside"]:
        sys.exit(inside(*sys.argv[2:]))
    MOCK_HID, MOCK_FALCON, SERVO, BAKE, SPINNING = sys.argv[1:6]
    unittest.main(argv=sys.argv[:1] + sys.argv[6:], verbosity=2)
