# SPDX-License-Identifier: Apache-2.0
"""What the programs that measure the live view share: a daemon whose hand may be led, and a view."""

import contextlib
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from programs import BAKE, SERVO, generate  # noqa: E402

PAGE = Path(SERVO).parent.parent / "share" / "spm-haptics" / "view"


def stop(process):
    """Ends a program in order; what it printed."""
    process.terminate()
    return process.communicate(timeout=60)[0]


def bake_box(folder):
    generate(folder, "box")
    asset = os.path.join(folder, "box.spm.exr")
    subprocess.run([BAKE, "build", os.path.join(folder, "box.obj"), "-o", asset, "--tolerance", "50um",
                    "--quiet"], check=True)
    return asset


class Watched:
    """`folder` is of this daemon alone; `realtime` as spm-servo run takes it."""

    def __init__(self, folder, asset, realtime="off"):
        self.environment = {**os.environ, "XDG_RUNTIME_DIR": folder}
        self.daemon = self.start("run", "--asset", asset, "--device", "sim:hand=live", "--realtime", realtime,
                                 "--black-box", "off", "--json")
        self.view = self.start("view", "--json")
        self.url = json.loads(self.view.stdout.readline())["url"]

    def start(self, *words):
        return subprocess.Popen([SERVO, *words], env=self.environment, stdout=subprocess.PIPE, text=True)

    def end(self):
        """The daemon's report."""
        stop(self.view)
        return json.loads(stop(self.daemon))


@contextlib.contextmanager
def watched_box(realtime="off"):
    with tempfile.TemporaryDirectory(prefix="spm-view-") as folder:
        watched = Watched(folder, bake_box(folder), realtime)
        try:
            yield watched
        finally:
            for process in (watched.view, watched.daemon):
                if process.poll() is None:
                    stop(process)
