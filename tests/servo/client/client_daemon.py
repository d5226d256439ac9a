# SPDX-License-Identifier: Apache-2.0
"""What the tests of the Python and C# clients and of the examples share: a server with a stand-in for
the loop, and how C# is compiled. SPM_BIN: folder of client_test_daemon and the examples;
SPM_CLIENT_LIBRARY: libspm_client.so."""

import os
import shutil
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[3]
BIN = Path(os.environ.get("SPM_BIN", Path.cwd() / "bin"))
LIBRARY = Path(os.environ.setdefault("SPM_CLIENT_LIBRARY",
                                     str(Path.cwd() / "lib" / "libspm_client.so")))
EXAMPLES = SOURCE / "servo" / "client" / "examples"
C_SHARP_FOLDER = SOURCE / "servo" / "client" / "csharp"
C_SHARP = sorted(C_SHARP_FOLDER.glob("*.cs"))
CAN_C_SHARP = shutil.which("mcs") and shutil.which("mono")
PATIENCE = 20.0  # s, beyond any machine's worst moment

sys.path[:0] = [str(SOURCE / "servo" / "client" / "python"), str(SOURCE / "tests" / "support")]
from spm_client import Client  # noqa: E402


def compile_c_sharp(program: str, *sources: Path) -> None:
    done = subprocess.run(["mcs", "-warn:4", "-warnaserror", f"-out:{program}", *C_SHARP, *sources],
                          capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


def c_sharp_environment() -> dict[str, str]:
    return {**os.environ, "LD_LIBRARY_PATH": str(LIBRARY.parent), "LC_ALL": "C.UTF-8"}


def eventually(so) -> bool:
    deadline = time.monotonic() + PATIENCE
    while not so():
        if time.monotonic() > deadline:
            return False
        time.sleep(0.002)
    return True


class WithDaemon(unittest.TestCase):
    """Each test has a server of its own."""

    def setUp(self) -> None:
        self.folder = tempfile.TemporaryDirectory(prefix="spm-client-")
        self.addCleanup(self.folder.cleanup)
        self.socket = os.path.join(self.folder.name, "a.sock")
        self.daemon = subprocess.Popen([BIN / "client_test_daemon", self.socket],
                                       stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.addCleanup(self.end_daemon)
        self.assertEqual(self.daemon.stdout.readline(), "ready\n")

    def end_daemon(self) -> None:
        if self.daemon.poll() is None:
            self.daemon.stdin.close()
            self.assertEqual(self.daemon.wait(timeout=PATIENCE), 0)
        self.daemon.stdout.close()

    def tell(self, what: str) -> None:
        self.daemon.stdin.write(what)
        self.daemon.stdin.flush()

    def client(self, **options) -> Client:
        client = Client(path=self.socket, timeout=PATIENCE, **options)
        self.addCleanup(client.close)
        # It can connect before the first tick, when there is nothing to read.
        self.assertTrue(eventually(lambda: client.daemon_state()[1] >= 0))
        return client
