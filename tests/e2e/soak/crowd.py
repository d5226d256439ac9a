#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs a tool with six degrees of freedom among many objects for minutes: it lies on five and slides on
them, the others are a hair beside it. On the simulated device, with SCHED_FIFO, and cyclictest beside
it: the ticks that were lost against how late the machine woke up cyclictest."""

import argparse
import math
import os
import statistics
import sys
import threading
import time

from cyclictest import finish_beside
from soak_tools import (PATIENCE, Client, ClientError, Daemon, DaemonState, Folder, TickClock,
                        add_common_options, bake, cores_of, missed, read_recording, show,
                        start_of_grid)
from stalls import INTERVAL, LEAST, StallWatch, explained

RATE = 1000  # Hz
TOUCHED = 5  # objects that carry the tool
TOOL, PAD = 0.3, 0.1  # scales of the model
GAP = 2e-4  # m, from the tool to what is beside it
PRESSED, SLIDE = 2e-3, 1.5e-4  # m, below the surface and to each side
TURN = 2e-3  # rad, to each side
PERIOD = 2.0  # s, of the hand's motion


def write_crowd(path: str, asset: str, half: list[float], objects: int) -> str:
    """Pads under the middle and the corners of a tool at the origin, and rings of boxes about it."""
    tool, pad = [TOOL * edge for edge in half], [PAD * edge for edge in half]
    down = -tool[2] - pad[2]
    aside = [0.6 * edge for edge in tool[:2]]
    places = [(0.0, 0.0, down)] + [(x * aside[0], y * aside[1], down) for x in (-1, 1) for y in (-1, 1)]
    side, storey = 0, 0
    while len(places) < objects:
        # Two to a side, one storey above the other.
        axis, sign, along = side // 4, 1 - side // 2 % 2 * 2, side % 2 - 0.5
        place = [0.0, 0.0, 2.1 * pad[2] * storey]
        place[axis] = sign * (tool[axis] + pad[axis] + GAP)
        place[1 - axis] = along * tool[1 - axis]
        places.append(tuple(place))
        side = (side + 1) % 8
        storey += 1 if side == 0 else 0
    with open(path, "w", encoding="utf-8") as file:
        file.write(f'[device]\nprofile = "omega3"\n[tool]\nasset = "{asset}"\nscale = {TOOL}\n')
        for place in places:
            file.write(f'[[object]]\nasset = "{asset}"\nscale = {PAD}\npose = {list(place)}\n'
                       'friction = { stick = 0.2, slide = 0.15 }\n')
    return path


def write_hand(path: str, seconds: float) -> str:
    """Comes down, presses, slides in circles and turns; starts above."""
    with open(path, "w", encoding="ascii") as file:
        for tick in range(round(seconds * RATE) + RATE):
            phase = 2 * math.pi * tick / RATE / PERIOD
            down = 5e-4 - (PRESSED + 5e-4) * min(1.0, tick / 500)
            turn = TURN * math.sin(0.7 * phase) / 2
            file.write(f"{SLIDE * math.cos(phase):.9f} {SLIDE * math.sin(phase):.9f} {down:.9f} "
                       f"{math.cos(turn):.12f} 0 0 {math.sin(turn):.12f}\n")
    return path


class Touches:
    """How many objects the tool touches, read by an application now and then."""

    def __init__(self, daemon: Daemon) -> None:
        self.counts: list[int] = []
        self.daemon = daemon

    def read(self) -> None:
        """Until the daemon ends."""
        try:
            with Client(path=self.daemon.socket) as client:
                while client.daemon_state()[0] == DaemonState.RUNNING:
                    self.counts.append(len({contact.object for contact in client.contacts()}))
                    time.sleep(0.05)
        except ClientError:
            pass  # it has ended


def watch(daemon: Daemon, recording: str, seconds: float, core: int) -> dict:
    """Lets a daemon that ends by itself run, and tells which of its lost ticks the core explains."""
    priority = daemon.required_priority()
    clock = TickClock(daemon.socket)
    sample = clock.now()
    clock.close()
    beside = StallWatch(priority + 1, core)
    run, stalls, stolen = finish_beside(daemon, beside, seconds)
    rate, rows = read_recording(recording)
    lost, times = missed(rows)
    start = start_of_grid(sample, rate, rows)
    found = explained(rows, start, rate, stalls)
    most = explained(rows, start, rate, stalls, earlier=INTERVAL * 1e3)
    return {"run": run, "stolen_s": stolen, "lost": lost, "stalls": times, "explained": found,
            "perhaps": most - found, "unexplained": lost - most,
            "core": {"stood_still": len(stalls),
                     "longest_us": max((one.end - one.begin for one in stalls), default=0) / 1e3}}


def table(found: dict) -> list[list]:
    run, core = found["run"], found["core"]
    device = run["devices"][0]
    rows = [["objects", found["settings"]["objects"]],
            ["touched at once, median", found["touched"]],
            ["samples of the tool", max(asset.get("tool_samples", 0) for asset in run["assets"])],
            ["ticks", run["ticks"]], ["in contact", run["contact_ticks"]],
            ["at a coarser level of the samples", device["coarse_ticks"]],
            ["with too little time for all steps", run["degraded_ticks"]],
            ["lost ticks", found["lost"]], ["in so many stalls", found["stalls"]],
            ["lost while the core stood still", found["explained"]],
            [f"more where it stood still {INTERVAL / 1e3} ms before that was seen", found["perhaps"]],
            ["lost that this does not explain", found["unexplained"]],
            [f"times that the core stood still for {LEAST / 1e3} ms or more", core["stood_still"]],
            ["the longest of them, us", float(core["longest_us"])],
            ["page faults in the loop", run["page_faults"]],
            ["processor time stolen by the host, s", found["stolen_s"]]]
    return rows + [[f"{name}, {label}, us", float(run[key][share])]
                   for name, key in (("woke up late", "wake_us"), ("busy", "busy_us"))
                   for label, share in (("p50", "p50"), ("p99", "p99"), ("p99.9", "p999"), ("max", "max"))]


def among(objects: int, options: argparse.Namespace, core: int) -> dict:
    """What a run among so many objects shows, beside cyclictest."""
    seconds, cores = options.minutes * 60, cores_of(options.cores)
    with Folder() as folder:
        asset, low, high = bake(folder, "box", "--tolerance", "50um")
        half = [(b - a) / 2 for a, b in zip(low, high)]
        scene = write_crowd(os.path.join(folder, "scene.toml"), asset, half, objects)
        hand = write_hand(os.path.join(folder, "hand.txt"), seconds)
        recording = os.path.join(folder, "run.spmrec")
        daemon = Daemon(folder, "--scene", scene, "--device", f"sim:hand=path,path={hand}",
                        "--rate", str(RATE), "--duration", str(seconds), "--realtime", "require",
                        "--core", str(core), "--record", recording, cores=cores)
        touches = Touches(daemon)
        reading = threading.Thread(target=touches.read, daemon=True)
        reading.start()
        found = watch(daemon, recording, seconds, core)
        reading.join(PATIENCE)
    late = touches.counts[len(touches.counts) // 2:]
    found["touched"] = int(statistics.median(late)) if late else 0
    found["settings"] = {"minutes": options.minutes, "objects": objects, "cores": options.cores,
                         "core": core}
    return found


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--minutes", type=float, default=10)
    parser.add_argument("--objects", type=int, nargs="+", default=[20],
                        help="one after the other; at least 5 (default 20)")
    parser.add_argument("--core", type=int,
                        help="the core of the loop and of cyclictest (default: the last one)")
    add_common_options(parser)
    arguments = parser.parse_args()
    core = max(os.sched_getaffinity(0)) if arguments.core is None else arguments.core
    if min(arguments.objects) < TOUCHED:
        parser.error(f"--objects: give at least {TOUCHED}")
    crowds = [among(objects, arguments, core) for objects in arguments.objects]
    rows = [[same[0][0], *(value for _, value in same)] for same in zip(*map(table, crowds))]
    show(arguments.out, f"{arguments.minutes:g} minutes with a tool among objects",
         ["what", *(f"found among {objects}" for objects in arguments.objects)], rows,
         {"crowds": crowds})
    return 0


if __name__ == "__main__":
    sys.exit(main())
