#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""How long a tick works where many objects are touched at once, on the simulated device.

Usage: measure_crowd.py SPM_SERVO SPM_BAKE [--objects N] [--seconds S] [--mesh FILE] [OPTION of run...]
Prints one JSON object: busy time of a tick in us, missed ticks, and answers that were coarser.
"""

import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[3]))
from tests.support.baked_tetrahedron import bake_tetrahedron  # noqa: E402


def scene_of(asset: Path, objects: int, method: str, apart: float) -> str:
    """Objects that lie in one place, each a little deeper than the last."""
    text = ""
    for number in range(objects):
        text += (f'[[object]]\nasset = "{asset}"\nmethod = "{method}"\nstiffness = "20N/m"\n'
                 f"pose = [0, 0, {-number * apart}]\nfriction = {{ slide = 0.2, stick = 0.3 }}\n")
    return text


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("servo")
    parser.add_argument("bake")
    parser.add_argument("--objects", type=int, default=64)
    parser.add_argument("--seconds", type=float, default=10)
    parser.add_argument("--mesh", help="instead of a tetrahedron of 5 cm; made 10 cm large")
    parser.add_argument("--method", default="proxy")
    parser.add_argument("--device", default="sim")
    arguments, more = parser.parse_known_args()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        if arguments.mesh:
            asset = folder / "asset.spm.exr"
            subprocess.run([arguments.bake, "build", arguments.mesh, "-o", asset, "--quiet",
                            "--fit-diagonal", "100mm", "--tolerance", "50um"], check=True)
        else:
            asset = bake_tetrahedron(arguments.bake, folder)
        scene = folder / "crowd.toml"
        scene.write_text(scene_of(asset, arguments.objects, arguments.method, 1e-6), encoding="utf-8")
        run = subprocess.run(
            [arguments.servo, "run", "--scene", scene, "--device", arguments.device, "--duration",
             str(arguments.seconds), "--socket", "off", "--black-box", "off", "--json", *more],
            check=True, stdout=subprocess.PIPE, text=True)
    report = json.loads(run.stdout)
    wanted = ("ticks", "missed", "contact_ticks", "degraded_ticks", "degraded_answers", "busy_us", "wake_us")
    print(json.dumps({key: report[key] for key in wanted if key in report}))


if __name__ == "__main__":
    main()
