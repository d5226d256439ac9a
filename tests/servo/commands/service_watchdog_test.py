#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A service manager's watchdog is told that the loop ticks, also where nobody reads the daemon's
messages, and no longer once the loop stands still.

Usage: service_watchdog_test.py SERVO BAKE [unittest options], the programs spm-servo and spm-bake.
"""

import fcntl
import os
import signal
import socket
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "support"))

from baked_tetrahedron import bake_tetrahedron  # noqa: E402

SERVO = BAKE = ""
WATCHDOG = 0.4  # s, of which the daemon takes the half
PATIENCE = 60  # s, which end a test that has failed


class ServiceWatchdog(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.asset = Path(bake_tetrahedron(BAKE, self.folder))
        self.manager = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        self.addCleanup(self.manager.close)
        self.manager.bind(str(self.folder / "notify"))
        self.manager.settimeout(PATIENCE)

    def start(self, **options) -> subprocess.Popen:
        environment = {**os.environ, "NOTIFY_SOCKET": str(self.folder / "notify"),
                       "WATCHDOG_USEC": str(int(WATCHDOG * 1e6)),
                       "XDG_STATE_HOME": str(self.folder)}
        environment.pop("WATCHDOG_PID", None)
        daemon = subprocess.Popen(
            [SERVO, "run", "--asset", self.asset, "--device", "sim", "--socket", "off",
             "--supervisor", "off"], stdout=subprocess.DEVNULL, env=environment, **options)
        self.addCleanup(daemon.wait)
        self.addCleanup(daemon.kill)
        self.hear("READY=1")
        return daemon

    def hear(self, what: str) -> None:
        while what not in self.manager.recv(4096).decode():
            pass

    def silent(self) -> bool:
        """Whether nothing more comes for some periods."""
        self.manager.settimeout(3 * WATCHDOG)
        try:
            self.manager.recv(4096)
        except TimeoutError:
            return True
        finally:
            self.manager.settimeout(PATIENCE)
        return False

    def test_a_loop_that_ticks_is_told_again_and_again(self) -> None:
        daemon = self.start(stderr=subprocess.DEVNULL)
        for _ in range(4):
            self.hear("WATCHDOG=1")
        daemon.send_signal(signal.SIGTERM)
        self.hear("STOPPING=1")
        self.assertEqual(daemon.wait(PATIENCE), 0)

    def test_a_daemon_whose_messages_nobody_reads_is_no_loop_that_hangs(self) -> None:
        reading, writing = os.pipe()
        self.addCleanup(os.close, reading)
        daemon = self.start(stderr=writing)
        # No more goes into the pipe from now on; what writes to it waits.
        fcntl.fcntl(writing, fcntl.F_SETPIPE_SZ, 4096)
        os.set_blocking(writing, False)
        try:
            while True:
                os.write(writing, b"x")
        except BlockingIOError:
            pass
        os.set_blocking(writing, True)
        # The asset is lost: that is said by the thread that takes the loop's records.
        os.truncate(self.asset, 100)
        time.sleep(4 * WATCHDOG)
        while not self.is_drained():
            pass
        for _ in range(4):
            self.hear("WATCHDOG=1")
        os.close(writing)
        daemon.kill()

    def is_drained(self) -> bool:
        """Whether all that was told before now is heard."""
        self.manager.setblocking(False)
        try:
            self.manager.recv(4096)
        except BlockingIOError:
            return True
        finally:
            self.manager.settimeout(PATIENCE)
        return False

    def test_a_daemon_that_stands_still_is_silent(self) -> None:
        daemon = self.start(stderr=subprocess.DEVNULL)
        self.hear("WATCHDOG=1")
        daemon.send_signal(signal.SIGSTOP)
        while not self.is_drained():
            pass
        self.assertTrue(self.silent())
        daemon.send_signal(signal.SIGCONT)
        self.hear("WATCHDOG=1")


if __name__ == "__main__":
    SERVO, BAKE = sys.argv[1:3]
    unittest.main(argv=sys.argv[:1] + sys.argv[3:], verbosity=2)
