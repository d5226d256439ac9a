#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs the daemon for minutes on an emulated WoodenHaptics, below the real hidapi, with SCHED_FIFO
and a baked asset, and cyclictest beside it; compares the ticks that it missed with how late the
machine woke up cyclictest."""

import argparse
import json
import os
import sys

from cyclictest import watch
from soak_tools import (HOME, Daemon, Folder, add_common_options, asset_or_demo, cores_of, program,
                        show, write_scene)

STIFFNESS = 300.0  # N/m: the emulated arm swings centimetres deep, whatever it feels


def table(found: dict) -> list[list]:
    run, machine, device = found["run"], found["cyclictest"], found["device"]
    rows = [["ticks", run["ticks"]], ["in contact", run["contact_ticks"]],
            ["reports of the device", device["reports"]],
            ["scheduling", f"{run['realtime']['policy']} {run['realtime']['priority']}"],
            ["missed ticks", run["missed"]], ["in so many stalls", found["stalls"]],
            ["cyclictest: wake-ups", machine["wake_ups"]],
            ["cyclictest: a tick late or later", machine["late"]],
            ["cyclictest: ticks that the loop would have missed by these", machine["as_missed"]],
            ["missed that the target allows", found["allowed"]],
            ["within the target", found["within"]],
            ["missed that cyclictest does not explain", found["unexplained"]],
            ["page faults in the loop", run["page_faults"]],
            ["processor time stolen by the host, s", found["stolen_s"]]]
    for name, key in (("woke up late", "wake_us"), ("busy", "busy_us")):
        rows += [[f"{name}, {label}, us", float(run[key][share])]
                 for label, share in (("p50", "p50"), ("p99", "p99"), ("p99.9", "p999"),
                                      ("max", "max"))]
    rows += [[f"cyclictest: woke up late, {label}, us", machine[key]]
             for label, key in (("p50", "p50_us"), ("p99", "p99_us"), ("p99.9", "p999_us"),
                                ("max", "max_us"))]
    return rows + [[f"force off: {off['cause']}, ticks", off["count"]] for off in run["force_off"]]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--minutes", type=float, default=10)
    parser.add_argument("--rate", type=float, default=1000, help="Hz (default 1000)")
    parser.add_argument("--device", default="wooden-v2",
                        choices=("wooden-v1", "wooden-v2", "wooden-v3"))
    parser.add_argument("--asset", help="baked asset (default: models' demo is baked)")
    parser.add_argument("--core", help="the loop's core: run --core (default: any)")
    add_common_options(parser)
    arguments = parser.parse_args()
    seconds, cores = arguments.minutes * 60, cores_of(arguments.cores)
    with Folder() as folder:
        asset, low, high = asset_or_demo(arguments.asset, folder)
        middle = [(a + b) / 2 for a, b in zip(low, high)]
        scene = write_scene(os.path.join(folder, "scene.toml"), asset,
                            [tuple(at - of for at, of in zip(HOME, middle))], STIFFNESS)
        seen = os.path.join(folder, "device.json")
        daemon = Daemon(folder, "--scene", scene, "--device", "woodenhaptics:home_confirmed=always,signs=+++",
                        "--rate", str(arguments.rate), "--duration", str(seconds),
                        "--realtime", "require",
                        *(("--core", arguments.core) if arguments.core else ()),
                        mock=[program("mock_hid"), arguments.device, f"report={seen}"],
                        cores=cores)
        found = watch(daemon, arguments.rate, seconds, cores)
        with open(seen, encoding="utf-8") as file:
            found["device"] = json.load(file)
    found["settings"] = {"minutes": arguments.minutes, "device": arguments.device,
                         "asset": os.path.basename(asset), "cores": arguments.cores,
                         "core": arguments.core}
    show(arguments.out, f"{arguments.minutes:g} minutes at {arguments.rate:g} Hz on an emulated "
         f"{arguments.device}, {os.path.basename(asset)}", ["what", "found"], table(found), found)
    return 0


if __name__ == "__main__":
    sys.exit(main())
