#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Kills the real spm-servo (SIGKILL) while a simulated hand presses, and starts it again, under an
application that was connected with the option `reconnect` and calls once a millisecond. Tells how
long it takes until a call or an event tells of the kill, and from the new daemon's start until that
application reads force again: any, and half of what the hand felt before.

The time of a start is that of the whole process: it opens and checks the asset, finds the device and
asks for its real-time rights.
"""

import argparse
import os
import sys
import time

from soak_tools import (PATIENCE, Client, ClientError, Code, Daemon, Folder, add_common_options,
                        baked_box, cores_of, percentile, show, write_scene)
from spm_client import EventKind

STIFFNESS = 1000.0  # N/m
DEPTH = 0.003   # m, that the hand wants to be below the top; it begins there, so that nothing is waited for
AWAY = 0.3      # s, from what tells of the kill to the start
EVERY = 0.001   # s, between the application's calls
STEADY = 0.6    # s of force before a kill


class Watcher:
    """The application: what its calls tell, and when."""

    def __init__(self, path: str) -> None:
        self.client = Client(path=path, application="restarts", timeout=1.0, reconnect=True)
        self.lost = self.found = 0  # events

    def look(self) -> tuple[bool, float]:
        """Whether the daemon was told to be gone, by a call or an event, and the force, N."""
        gone, size = False, 0.0
        try:
            for event in self.client.events():
                self.lost += event.kind == EventKind.DAEMON_LOST
                self.found += event.kind == EventKind.DAEMON_FOUND
                gone = gone or event.kind == EventKind.DAEMON_LOST
            size = sum(part * part for part in self.client.device(0).force) ** 0.5
        except ClientError as problem:
            if problem.code not in (Code.NO_DAEMON, Code.BUSY, Code.NOT_THERE):
                raise
            gone = gone or problem.code == Code.NO_DAEMON
        return gone, size

    def wait(self, what: str, holds) -> float:
        """Calls until `holds(gone, size)`; returns when that was, s of CLOCK_MONOTONIC."""
        deadline = time.monotonic() + PATIENCE
        while not holds(*self.look()):
            if time.monotonic() > deadline:
                raise RuntimeError(f"no {what} within {PATIENCE:g} s")
            time.sleep(EVERY)
        return time.monotonic()


def run_kills(kills: int, cores: set[int] | None = None) -> dict:
    """Times of each kill, ms."""
    asset, top = baked_box()
    times: dict[str, list[float]] = {"told_ms": [], "any_force_ms": [], "half_force_ms": []}
    with Folder() as folder:
        path = os.path.join(folder, "hand.txt")
        with open(path, "w", encoding="ascii") as file:
            file.write(f"0 0 {top - DEPTH!r}\n")
        scene = write_scene(os.path.join(folder, "scene.toml"), asset, [(0.0, 0.0, 0.0)], STIFFNESS)
        words = ("--scene", scene, "--device", f"sim:profile=falcon,hand=path,path={path}")
        daemon = Daemon(folder, *words, cores=cores)
        try:
            watcher = Watcher(daemon.socket)
            for _ in range(kills):
                watcher.wait("force", lambda _, size: size > 0)
                time.sleep(STEADY)
                felt = watcher.look()[1]
                begun = time.monotonic()
                daemon.process.kill()
                told = watcher.wait("word of the kill", lambda gone, _: gone)
                daemon.process.communicate()
                time.sleep(AWAY)
                started = time.monotonic()
                daemon = Daemon(folder, *words, cores=cores, awaited=False)
                any_force = watcher.wait("force", lambda _, size: size > 0)
                half = watcher.wait("half of the force", lambda _, size: size > felt / 2)
                for key, end, start in (("told_ms", told, begun), ("any_force_ms", any_force, started),
                                        ("half_force_ms", half, started)):
                    times[key].append(1e3 * (end - start))
            watcher.client.close()
            daemon.stop()
        finally:
            daemon.kill()
    return {"kills": kills, "lost_events": watcher.lost, "found_events": watcher.found, **times}


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--kills", type=int, default=10)
    add_common_options(parser)
    arguments = parser.parse_args()
    load = os.getloadavg()[0]
    run = run_kills(arguments.kills, cores_of(arguments.cores))
    data = {"kills": run["kills"], "lost_events": run["lost_events"],
            "found_events": run["found_events"], "load_before": load,
            "load_after": os.getloadavg()[0]}
    rows = []
    for key, what in (("told_ms", "from the kill until the application is told"),
                      ("any_force_ms", "from the new start until it reads force"),
                      ("half_force_ms", "until that is half of what it was")):
        data[key] = {"p50": percentile(run[key], 0.5), "max": max(run[key])}
        data["all_" + key] = [round(one, 3) for one in run[key]]
        rows.append([what, data[key]["p50"], data[key]["max"]])
    show(arguments.out, f"{arguments.kills} times spm-servo is killed and started again under an "
         f"application with `reconnect`; load of the machine {load:.1f} at the beginning, "
         f"{data['load_after']:.1f} at the end", ["what", "p50, ms", "max, ms"], rows, data)
    return 0


if __name__ == "__main__":
    sys.exit(main())
