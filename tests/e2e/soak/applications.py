#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Rounds in which applications beside the daemon are killed in the middle of a write, stopped,
flood it with commands or write garbage into the memory they share with it, sixteen at once; two of
them are honest and must go on reading. Tells the missed ticks of these rounds beside those of two
control periods of the same run, which take turns with the rounds: one without such applications,
and one with as many processes that are as busy but no applications, since those alone make a
machine late.
"""

import argparse
import math
import mmap
import os
import random
import signal
import struct
import sys
import time

import hostile
from soak_tools import (PATIENCE, Client, ClientError, Daemon, Folder, TickClock, add_common_options,
                        baked_box, cores_of, missed, percentile, read_recording, show, write_scene)

STIFFNESS = 500.0  # N/m
MOST_CLIENTS, READERS = 16, 2
HOSTILE = MOST_CLIENTS - READERS - 1  # one more tells the time
SHORTEST, LONGEST = 0.005, 0.03  # s, that a round's applications have
AHEAD = 10  # steps of niceness that this program is ahead of its children, so that rounds are short
KILLED, STOPPED = 0.7, 0.85  # shares: below the first killed, below the second stopped, else left
NOTES = struct.Struct("<qqqq")  # of a child; a reader's: reads, failures, last tick, longest gap ns


class Crowd:
    """Child processes at numbered places, each with a few numbers that it notes for its parent."""

    def __init__(self, places: int) -> None:
        self.notes = mmap.mmap(-1, places * NOTES.size)
        self.pids = [0] * places
        self.stopped = [False] * places

    def start(self, place: int, work) -> None:
        """`work(note)` in a child, where note(*numbers) tells the parent."""
        self._note(place, 0)
        pid = os.fork()
        if pid == 0:
            code = 1
            try:
                os.nice(max(0, -os.nice(0)))
                work(lambda *numbers: self._note(place, *numbers))
                code = 0
            finally:
                os._exit(code)
        self.pids[place] = pid
        self.stopped[place] = False

    def _note(self, place: int, *numbers: int) -> None:
        padded = (*numbers, 0, 0, 0)[:4]
        self.notes[place * NOTES.size:(place + 1) * NOTES.size] = NOTES.pack(*padded)

    def noted(self, place: int) -> tuple[int, ...]:
        return NOTES.unpack_from(self.notes, place * NOTES.size)

    def stop(self, place: int) -> None:
        if self.pids[place]:
            os.kill(self.pids[place], signal.SIGSTOP)
            self.stopped[place] = True

    def kill(self, place: int) -> None:
        if self.pids[place]:
            os.kill(self.pids[place], signal.SIGKILL)
            os.waitpid(self.pids[place], 0)
            self.pids[place] = 0

    def kill_all(self) -> None:
        for place in range(len(self.pids)):
            self.kill(place)


def read_on(path: str, note) -> None:
    """An honest application: reads about once a tick, and notes how it went."""
    reads = failures = longest = 0
    before = time.monotonic_ns()
    with Client(path=path, application="reader", timeout=PATIENCE) as client:
        while True:
            try:
                tick = client.device(0).tick
                reads += 1
            except ClientError:
                failures += 1
                continue
            now = time.monotonic_ns()
            longest, before = max(longest, now - before), now
            note(reads, failures, tick, longest)
            time.sleep(0.001)


class Rounds:
    """The hostile applications, and what was done to them."""

    def __init__(self, path: str, seed: int) -> None:
        self.path, self.numbers = path, random.Random(seed)
        self.crowd = Crowd(HOSTILE)
        self.done = {"rounds": 0, "started": 0, "connected": 0, "killed": 0, "stopped": 0,
                     **{kind: 0 for kind in hostile.KINDS}}

    def one(self) -> None:
        crowd, numbers = self.crowd, self.numbers
        for place in range(HOSTILE):
            if crowd.pids[place] == 0:
                kind, seed = numbers.choice(hostile.KINDS), numbers.getrandbits(32)
                crowd.start(place, lambda note: hostile.run(kind, self.path, seed, note))
                self.done["started"] += 1
                self.done[kind] += 1
        time.sleep(numbers.uniform(SHORTEST, LONGEST))
        for place in range(HOSTILE):
            fate = numbers.random()
            if fate < KILLED or crowd.stopped[place]:
                self.done["connected"] += crowd.noted(place)[0] == hostile.CONNECTED
                crowd.kill(place)
                self.done["killed"] += 1
            elif fate < STOPPED:
                crowd.stop(place)
                self.done["stopped"] += 1
        self.done["rounds"] += 1


def hurry() -> None:
    try:
        os.nice(-AHEAD)
    except PermissionError:
        pass  # the rounds take longer


def bystanders(seconds: float) -> None:
    crowd = Crowd(HOSTILE)
    for place in range(HOSTILE):
        crowd.start(place, lambda note: hostile.run("bystander", "", place, note))
    time.sleep(seconds)
    crowd.kill_all()


class Run:
    """A daemon with its honest applications."""

    def __init__(self, folder: str, cores: set[int] | None, seed: int) -> None:
        asset, _ = baked_box()
        scene = write_scene(os.path.join(folder, "scene.toml"), asset, [(0.0, 0.0, 0.0)], STIFFNESS,
                            movable=True)
        self.recording = os.path.join(folder, "run.spmrec")
        self.daemon = Daemon(folder, "--scene", scene, "--device", "sim", "--record",
                             self.recording, cores=cores)
        self.clock = TickClock(self.daemon.socket)
        self.readers = Crowd(READERS)
        for place in range(READERS):
            self.readers.start(place, lambda note: read_on(self.daemon.socket, note))
        self.rounds = Rounds(self.daemon.socket, seed)
        self.seen = [(0, 0, 0, 0)] * READERS

    def check(self) -> list[str]:
        """What is wrong: a daemon that ended or stands still, a reader that reads no more."""
        wrong = [] if self.daemon.is_alive() else ["the daemon has ended: " + self.daemon.told()]
        deadline = time.monotonic() + PATIENCE
        for place in range(READERS):
            # Both its reads and the ticks that it sees have to go on.
            while any(now <= before for now, before in
                      zip(self.readers.noted(place)[0:3:2], self.seen[place][0:3:2])):
                if time.monotonic() > deadline:
                    wrong.append(f"reader {place} reads no more")
                    break
                time.sleep(0.002)
            self.seen[place] = self.readers.noted(place)
        return wrong

    def end(self) -> dict:
        self.rounds.crowd.kill_all()
        self.readers.kill_all()
        self.clock.close()
        try:
            return self.daemon.stop()
        finally:
            self.daemon.kill()


def attack(run: Run, rounds: int) -> tuple[tuple[int, int], float]:
    """First and last tick, and how long it took."""
    first, begun = run.clock.now()[0], time.monotonic()
    for _ in range(rounds):
        run.rounds.one()
    took = time.monotonic() - begun
    last = run.clock.now()[0]
    run.rounds.crowd.kill_all()
    return (first, last), took


def summary(name: str, windows: list[tuple[int, int]], rows: list, rate: float) -> dict:
    """What a recording tells of the ticks in some windows."""
    ticks = lost = stalls = 0
    wake: list[int] = []
    busy: list[int] = []
    for first, last in windows:
        inside = [row for row in rows if first <= row.tick <= last]
        gaps = missed(inside)
        ticks, lost, stalls = ticks + last - first, lost + gaps[0], stalls + gaps[1]
        wake += [row.wake_ns for row in inside]
        busy += [row.busy_ns for row in inside]
    period = 1e9 / rate
    return {"period": name, "seconds": ticks / rate, "ticks": ticks, "missed": lost,
            "stalls": stalls, "missed_a_minute": 60 * rate * lost / max(1, ticks),
            "busy_longer_than_a_tick": sum(value > period for value in busy),
            "wake_us": {"p50": percentile(wake, 0.5) / 1e3, "p99": percentile(wake, 0.99) / 1e3,
                        "max": max(wake, default=0) / 1e3},
            "busy_us": {"p50": percentile(busy, 0.5) / 1e3, "p99": percentile(busy, 0.99) / 1e3,
                        "max": max(busy, default=0) / 1e3}}


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=1000)
    parser.add_argument("--blocks", type=int, default=10, help="of rounds, with controls between")
    parser.add_argument("--seed", type=int, default=1)
    add_common_options(parser)
    arguments = parser.parse_args()
    hurry()
    windows: dict[str, list[tuple[int, int]]] = {"idle": [], "bystanders": [], "applications": []}
    wrong: list[str] = []
    with Folder() as folder:
        run = Run(folder, cores_of(arguments.cores), arguments.seed)
        wrong += run.check()
        for block in range(arguments.blocks):
            share = arguments.rounds * (block + 1) // arguments.blocks - run.rounds.done["rounds"]
            window, seconds = attack(run, share)
            windows["applications"].append(window)
            for name, control in (("idle", time.sleep), ("bystanders", bystanders)):
                first = run.clock.now()[0]
                control(seconds)
                windows[name].append((first, run.clock.now()[0]))
            wrong += run.check()
            if wrong:
                break
        notes = [run.readers.noted(place) for place in range(READERS)]
        report = run.end()
        rate, rows = read_recording(run.recording)
    found = [summary(name, windows[name], rows, rate) for name in windows]
    idle, busy, attacked = found
    # By chance alone two counts of the same differ by twice this in one of twenty runs.
    chance = 2 * math.sqrt(attacked["stalls"] + busy["stalls"])
    caused = attacked["stalls"] - busy["stalls"] > chance
    data = {"periods": found, "done": run.rounds.done, "wrong": wrong, "report": report,
            "readers": [dict(zip(("reads", "failures", "last_tick", "longest_gap_ns"), note))
                        for note in notes],
            "stalls_beyond_bystanders": attacked["stalls"] - busy["stalls"],
            "explained_by_chance": chance, "more_than_chance": caused, "seed": arguments.seed}
    columns = ["period", "s", "missed", "in stalls", "missed a minute", "busy longer than a tick",
               "woke up late p50 / p99 / max, us", "busy p50 / p99 / max, us"]
    table = [[one["period"], one["seconds"], one["missed"], one["stalls"], one["missed_a_minute"],
              one["busy_longer_than_a_tick"],
              *(" / ".join(f"{one[key][share]:.1f}" for share in ("p50", "p99", "max"))
                for key in ("wake_us", "busy_us"))] for one in found]
    show(arguments.out, f"{run.rounds.done['rounds']} rounds of {MOST_CLIENTS} applications",
         columns, table, data)
    done = run.rounds.done
    print(f"{done['started']} hostile applications, {done['connected']} of {done['killed']} killed "
          f"while connected, {done['stopped']} stopped; readers: " +
          ", ".join(f"{note[0]} reads, {note[1]} failed, longest gap {note[3] / 1e6:.1f} ms"
                    for note in notes) +
          f"; stalls beyond those with bystanders: {data['stalls_beyond_bystanders']} "
          f"({'more than' if caused else 'within'} chance)")
    for line in wrong:
        print("wrong: " + line)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
