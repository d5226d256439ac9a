#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A simulated Falcon's hand presses a wall of 2.7 N/mm again and again, while an application beside
the real spm-servo sends one kind of command each frame. Tells the net work on the hand, by the
daemon's own account of what was sent: above zero, the commands have driven the hand.

Each stream has a daemon of its own, as many times as `--times`; the greatest of these is told. What
was felt, and in how many presses, is told from recordings.
"""

import argparse
import math
import os
import sys
import time
from typing import Callable, NamedTuple

from soak_tools import (PATIENCE, Client, ClientError, Code, Daemon, Folder, add_common_options,
                        baked_box, cores_of, read_recording, show, write_scene)
from spm_client import Material

STIFFNESS = 2700.0  # N/m
PERIOD = 4.6 / 6    # s, of a press
ABOVE, DEEPEST = 0.003, 0.012  # m, that the hand wants to be above the wall's top, and below it
REST = 1.0          # s above the wall, before the first press and after the last
RATE = 1000         # ticks a second
FAR, ADDED_FAR = 0.5, 0.7  # m to the side
TOUCHED, ASIDE = 0, 1  # ids of the scene's objects
CAPS = (8.0, 7.8)   # N; the hand meets neither
PRESSED, LET_GO = 1.0, 0.1  # N, above and below which a press has begun and ended

Command = Callable[[Client, int], None]  # of a frame with this number


def damp_far(client: Client, _: int) -> None:
    client.set_material(ASIDE, Material(damping=0.0))


def stiffen_touched(client: Client, _: int) -> None:
    client.set_material(TOUCHED, Material(stiffness=STIFFNESS))


def cap(client: Client, frame: int) -> None:
    client.set_force_cap(0, CAPS[frame % 2])


class AddFar:
    """One object more in each frame; the one of the frame before goes, since there is room for few."""

    def __init__(self) -> None:
        self.added: int | None = None

    def __call__(self, client: Client, _: int) -> None:
        before, self.added = self.added, client.add(0, (ADDED_FAR, 0.0, 0.0))
        if before is not None:
            client.remove(before)


class Stream(NamedTuple):
    name: str
    what: str
    rate: float  # Hz
    command: Callable[[], Command | None]


STREAMS = (
    Stream("none", "an application that only reads", 60, lambda: None),
    Stream("far_60", f"`damping` as it is, of an object {FAR} m away", 60, lambda: damp_far),
    Stream("far_20", f"`damping` as it is, of an object {FAR} m away", 20, lambda: damp_far),
    Stream("touched_30", "`stiffness` as it is, of the object that is pressed", 30,
           lambda: stiffen_touched),
    Stream("added_60", f"an object added {ADDED_FAR} m away, the one before removed", 60, AddFar),
    Stream("cap_60", f"a force cap of {CAPS[0]} and {CAPS[1]} N in turns", 60, lambda: cap))


def write_path(path: str, top: float, presses: int) -> int:
    """Where the hand wants to be, tick by tick; returns the number of ticks."""
    rest, period = round(REST * RATE), PERIOD * RATE
    ticks = 2 * rest + round(presses * period)
    with open(path, "w", encoding="ascii") as file:
        for tick in range(ticks):
            phase = (tick - rest) / period
            share = (1 - math.cos(2 * math.pi * phase)) / 2 if 0 < phase < presses else 0.0
            file.write(f"0 0 {top + ABOVE - (ABOVE + DEEPEST) * share!r}\n")
    return ticks


def patiently(read: Callable):
    """What is read, again where the loop wrote too often meanwhile."""
    deadline = time.monotonic() + PATIENCE
    while True:
        try:
            return read()
        except ClientError as problem:
            if problem.code != Code.BUSY or time.monotonic() > deadline:
                raise


def send(client: Client, stream: Stream, ticks: int) -> int:
    """Sends the stream until the loop has run so many ticks; returns the number of frames."""
    command, frame = stream.command(), 0
    begun = time.monotonic()
    while patiently(client.loop).ticks < ticks:
        if command:
            command(client, frame)
        patiently(client.device)
        frame += 1
        now = time.monotonic()
        if now - begun > PATIENCE + ticks / RATE:
            raise RuntimeError(f"{stream.name}: the loop does not come to tick {ticks}")
        time.sleep(max(0.0, begun + frame / stream.rate - now))
    return frame


def presses_of(sizes: list[float]) -> int:
    """How often a force came and went."""
    count, pressed = 0, False
    for size in sizes:
        if not pressed and size > PRESSED:
            count, pressed = count + 1, True
        elif size < LET_GO:
            pressed = False
    return count


def run_stream(stream: Stream, presses: int, cores: set[int] | None = None) -> dict:
    """What one daemon's hand got of a stream."""
    asset, top = baked_box()
    with Folder() as folder:
        path, recording = os.path.join(folder, "hand.txt"), os.path.join(folder, "run.spmrec")
        ticks = write_path(path, top, presses)
        scene = write_scene(os.path.join(folder, "scene.toml"), asset,
                            [(0.0, 0.0, 0.0), (FAR, 0.0, 0.0)], STIFFNESS)
        daemon = Daemon(folder, "--scene", scene, "--device",
                        f"sim:profile=falcon,hand=path,path={path}", "--rate", str(RATE),
                        "--record", recording, cores=cores)
        try:
            with Client(path=daemon.socket, application="presses", timeout=PATIENCE) as client:
                begun = time.monotonic()
                frames = send(client, stream, ticks)
                took = time.monotonic() - begun
                counts, loop = patiently(client.device_counts), patiently(client.loop)
                commands = client.refusals()
            daemon.stop()
        finally:
            daemon.kill()
        _, rows = read_recording(recording)
    return {"energy_j": counts.energy, "generated_max_j": counts.generated_max,
            "frames_a_second": frames / took, "sent": commands.sent, "taken": commands.taken,
            "refused": commands.refused, "refusal": commands.reason, "missed": loop.missed,
            "presses": presses_of([row.size for row in rows]),
            "force_max_n": max(row.size for row in rows)}


def measure(stream: Stream, presses: int, times: int, cores: set[int] | None) -> dict:
    runs = [run_stream(stream, presses, cores) for _ in range(times)]
    return {"stream": stream.name, "what": stream.what, "rate_hz": stream.rate, "times": times,
            "energy_j": max(run["energy_j"] for run in runs),
            "generated_max_j": max(run["generated_max_j"] for run in runs), "runs": runs}


def row_of(found: dict) -> list:
    runs = found["runs"]
    return [found["what"], found["rate_hz"], found["times"], sum(run["sent"] for run in runs),
            sum(run["refused"] for run in runs), min(run["presses"] for run in runs),
            max(run["force_max_n"] for run in runs), f"{1e3 * found['energy_j']:.2f}",
            f"{1e3 * found['generated_max_j']:.2f}", max(run["missed"] for run in runs)]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--presses", type=int, default=6)
    parser.add_argument("--times", type=int, default=3, help="of each stream (default 3)")
    parser.add_argument("--stream", action="append", choices=[one.name for one in STREAMS],
                        help="may be repeated (default: all)")
    add_common_options(parser)
    arguments = parser.parse_args()
    load = os.getloadavg()[0]
    streams = [one for one in STREAMS if not arguments.stream or one.name in arguments.stream]
    found = []
    for stream in streams:
        print(f"{stream.name} ...", file=sys.stderr, flush=True)
        found.append(measure(stream, arguments.presses, arguments.times,
                             cores_of(arguments.cores)))
    show(arguments.out, f"{arguments.presses} presses in {arguments.presses * PERIOD:.1f} s on a "
         f"wall of {STIFFNESS / 1e3} N/mm, a simulated Falcon; load of the machine {load:.1f} at "
         f"the beginning, {os.getloadavg()[0]:.1f} at the end",
         ["beside it", "Hz", "times", "commands", "refused", "presses felt", "largest force, N",
          "net work on the hand, mJ, at most", "most in between, mJ", "ticks missed, at most"],
         [row_of(one) for one in found],
         {"presses": arguments.presses, "seconds": arguments.presses * PERIOD,
          "stiffness_n_m": STIFFNESS, "load_before": load, "load_after": os.getloadavg()[0],
          "streams": found})
    return 0


if __name__ == "__main__":
    sys.exit(main())
