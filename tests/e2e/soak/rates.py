#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs the simulated device at 4 kHz with one object and with fifty, apart and all at one place,
and at rates from 500 Hz to 4 kHz, each with cyclictest beside it."""

import argparse
import os
import sys

from cyclictest import watch
from soak_tools import (Daemon, Folder, add_common_options, asset_or_demo, cores_of, show,
                        write_scene)

FASTEST = 4000  # Hz
RATES = (500, 1000, 2000, 3000, 4000)  # Hz
OBJECTS, COLUMNS = 50, 10
STIFFNESS = 1000.0  # N/m
STEP = 0.95  # of an object's size: neighbours overlap a little


def side_by_side(low: list[float], high: list[float]) -> list[tuple[float, ...]]:
    """Places of fifty objects in rows, the first where it would be alone."""
    width, height = (STEP * (high[i] - low[i]) for i in (0, 1))
    return [(column * width, row * height, 0.0)
            for row in range(OBJECTS // COLUMNS) for column in range(COLUMNS)]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=60, help="of a run at 4 kHz (default 60)")
    parser.add_argument("--sweep-seconds", type=float, default=10,
                        help="of a run at another rate (default 10)")
    parser.add_argument("--asset", help="baked asset (default: models' demo is baked)")
    add_common_options(parser)
    arguments = parser.parse_args()
    cores = cores_of(arguments.cores)
    found = []
    with Folder() as folder:
        asset, low, high = asset_or_demo(arguments.asset, folder)

        def scene(name: str, poses: list[tuple[float, ...]], stiffness: float) -> str:
            return write_scene(os.path.join(folder, name), asset, poses, stiffness)

        one = scene("one.toml", [(0.0, 0.0, 0.0)], STIFFNESS)
        many = scene("many.toml", side_by_side(low, high), STIFFNESS)
        heap = scene("heap.toml", [(0.0, 0.0, 0.0)] * OBJECTS, STIFFNESS / OBJECTS)
        runs = [("one object", one, FASTEST, arguments.seconds),
                (f"{OBJECTS} objects side by side", many, FASTEST, arguments.seconds),
                (f"{OBJECTS} objects at one place", heap, FASTEST, arguments.seconds)]
        runs += [("one object", one, rate, arguments.sweep_seconds) for rate in RATES]
        for name, path, rate, seconds in runs:
            daemon = Daemon(folder, "--scene", path, "--device", "sim", "--rate", str(rate),
                            "--duration", str(seconds), "--realtime", "require", cores=cores)
            result = watch(daemon, rate, seconds, cores)
            print(f"{name} at {rate} Hz: {result['run']['missed']} missed", file=sys.stderr)
            found.append({"scene": name, "rate_hz": rate, "seconds": seconds, **result})
    rows = []
    for result in found:
        run, machine = result["run"], result["cyclictest"]
        rows.append([result["scene"], result["rate_hz"], float(result["seconds"]), run["ticks"],
                     run["contact_ticks"], run["missed"], result["stalls"], machine["late"],
                     machine["as_missed"], result["within"],
                     float(run["busy_us"]["p50"]), float(run["busy_us"]["p99"]),
                     float(run["busy_us"]["max"]), run["page_faults"]])
    show(arguments.out, f"Rates on sim, {os.path.basename(asset)}",
         ["scene", "Hz", "s", "ticks", "in contact", "missed", "in stalls", "cyclictest late",
          "as the loop counts", "within the target", "busy p50, us", "busy p99, us", "busy max, us",
          "page faults"], rows, {"runs": found})
    return 0


if __name__ == "__main__":
    sys.exit(main())
