#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Makes the real spm-servo stand still while it drives an emulated WoodenHaptics whose motors hold
the arm's weight, and measures from the event to the first command that reached the device in which
no motor had a current.

It is stopped (SIGSTOP), frozen (a freezer of cgroup v2), killed (SIGKILL, and started again), its
core is taken away (a process of priority 99 beside the loop's 80), and its loop spins by itself on
the core that it shares with its guards.

A busy machine may stop the daemon later than it is told to, and the daemon serves on so long. Two
times are told therefore: since the event, and since the daemon's last command, which is how long a
current stayed that nobody had asked for any more.

Only what the emulation heard counts: umockdev waits for a client in the middle of an exchange, even
one that is stopped, and hears nobody then, which a kernel would. mock_hid notes when it was deaf;
an event in such a time is done again, whatever was measured, and told in a column of its own.
"""

import argparse
import json
import os
import signal
import subprocess
import sys
import time

from soak_tools import (BIN, HERE, PATIENCE, SERVO, Client, ClientError, Folder,
                        add_common_options, baked_box, percentile, program, show)

KINDS = {"stopped": "SIGSTOP", "frozen": "a freezer of cgroup v2", "killed": "SIGKILL",
         "starved": "priority 99 on its core", "spinning": "its loop does not sleep"}
AWAY = 0.3  # s, that it stands still
ON_AGAIN = 0.2  # s, after which a force that came back is no longer faded in
LIMIT_MS = 30.0
NEVER_MS = 1e6
WOODEN = "woodenhaptics:home_confirmed=always,gravity=on,signs=+++"
HIGHEST = 99  # priority of what takes the core
TELLING = 98  # of what makes the daemon stand still, so that it does so when it says
MOST_SESSIONS = 6
SPINNING = os.path.join(BIN, os.pardir, "lib", "libspinning_loop.so")


def freezer_mount() -> str | None:
    """Where cgroup v2 is mounted and a group may be made, if anywhere."""
    with open("/proc/self/mounts", encoding="utf-8") as file:
        mounts = [line.split()[1] for line in file if line.split()[2] == "cgroup2"]
    return next((mount for mount in mounts if os.access(mount, os.W_OK)), None)


def take_priority(priority: int) -> bool:
    try:
        os.sched_setscheduler(0, os.SCHED_FIFO if priority else os.SCHED_OTHER,
                              os.sched_param(priority))
    except PermissionError:
        return False
    return True


def why_not(kind: str) -> str:
    """Why a kind cannot be had on this machine; empty if it can."""
    if kind == "frozen" and freezer_mount() is None:
        return "no cgroup v2 is mounted where this user may make a group"
    if kind in ("starved", "spinning"):
        if not take_priority(HIGHEST):
            return "no real-time priority may be had"
        take_priority(0)
    if kind == "starved" and len(os.sched_getaffinity(0)) < 2:
        return "there is no second core, on which the device could be emulated meanwhile"
    return ""


class Freezer:
    """A group of processes of its own."""

    def __init__(self) -> None:
        self.path = os.path.join(freezer_mount(), f"spm-away-{os.getpid()}")
        os.mkdir(self.path)

    def write(self, file: str, text: str) -> None:
        with open(os.path.join(self.path, file), "w", encoding="ascii") as opened:
            opened.write(text)

    def freeze(self, on: bool) -> None:
        self.write("cgroup.freeze", "1" if on else "0")

    def close(self) -> None:
        os.rmdir(self.path)


class Spinner:
    """A process that takes a core for a while when it is told to."""

    def __init__(self, core: int) -> None:
        self.process = subprocess.Popen([sys.executable, __file__, "--spin", str(core)],
                                        stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.process.stdout.readline()  # it has its priority

    def spin(self) -> int:
        """Returns when it began, ns, once it has ended."""
        self.process.stdin.write("\n")
        self.process.stdin.flush()
        return int(self.process.stdout.readline())

    def close(self) -> None:
        self.process.stdin.close()
        self.process.wait()


def spin(core: int) -> int:
    os.sched_setaffinity(0, {core})
    take_priority(HIGHEST)
    print("ready", flush=True)
    for _ in sys.stdin:
        began = time.monotonic_ns()
        while time.monotonic_ns() - began < AWAY * 1e9:
            pass
        print(began, flush=True)
    return 0


class Inside:
    """Beside the emulated device: a daemon that is made to stand still again and again."""

    def __init__(self, kind: str, folder: str, asset: str, core: int | None) -> None:
        self.kind, self.folder = kind, folder
        self.socket = os.path.join(folder, "servo.sock")
        self.command = [SERVO, "run", "--asset", asset, "--device", WOODEN, "--socket", self.socket,
                        "--black-box", "off", "--json"]
        if core is not None:
            self.command += ["--core", str(core)]
        self.environment = {**os.environ, "LD_PRELOAD": "libumockdev-preload.so.0",
                            "XDG_RUNTIME_DIR": folder, "XDG_STATE_HOME": folder}
        if kind == "spinning":
            self.environment["LD_PRELOAD"] += f":{SPINNING}"
            self.environment["SPIN_AT"] = self.file("spin")
            self.environment["SPIN_BEGAN"] = self.file("spin.began")
        self.freezer = Freezer() if kind == "frozen" else None
        self.spinner = Spinner(core) if kind == "starved" else None
        self.daemon = None
        self.reports: list[dict] = []

    def file(self, name: str) -> str:
        return os.path.join(self.folder, name)

    def start(self) -> None:
        """Returns when there is force."""
        with open(self.file("messages"), "a", encoding="utf-8") as messages:
            self.daemon = subprocess.Popen(self.command, stdout=subprocess.PIPE, stderr=messages,
                                           text=True, env=self.environment)
        deadline = time.monotonic() + PATIENCE
        while not self.has_force():
            if time.monotonic() > deadline or self.daemon.poll() is not None:
                raise RuntimeError("the daemon gives no force")
            time.sleep(0.01)
        if self.freezer:
            self.freezer.write("cgroup.procs", str(self.daemon.pid))
        time.sleep(ON_AGAIN)

    def has_force(self) -> bool:
        try:
            with Client(path=self.socket, timeout=PATIENCE) as client:
                return client.info().process == self.daemon.pid and client.device(0).cause == 0
        except ClientError:  # it has not begun to tick
            return False

    def end(self) -> None:
        self.daemon.send_signal(signal.SIGTERM)
        self.reports.append(json.loads(self.daemon.communicate(timeout=PATIENCE)[0]))

    def go_away(self) -> int:
        """Makes it stand still for a while; returns when that began, ns."""
        if self.kind == "starved":
            return self.spinner.spin()
        if self.kind == "spinning":
            with open(self.file("spin"), "w", encoding="ascii"):
                pass
            while os.path.exists(self.file("spin")):
                time.sleep(0.0005)
            time.sleep(AWAY)
            with open(self.file("spin.began"), encoding="ascii") as told:
                return int(told.read())
        began = time.monotonic_ns()
        if self.kind == "stopped":
            self.daemon.send_signal(signal.SIGSTOP)
            time.sleep(AWAY)
            self.daemon.send_signal(signal.SIGCONT)
        elif self.kind == "frozen":
            self.freezer.freeze(True)
            time.sleep(AWAY)
            self.freezer.freeze(False)
        else:
            self.daemon.kill()
            self.daemon.communicate()
            time.sleep(AWAY)
        return began

    def run(self, times: int, period: float) -> dict:
        began = []
        try:
            for _ in range(times):
                due = time.monotonic() + period
                if self.daemon is None or self.kind == "killed":
                    self.start()
                take_priority(TELLING)
                began.append(self.go_away())
                take_priority(0)
                time.sleep(max(ON_AGAIN, due - time.monotonic()))
            if self.kind != "killed":
                self.end()
        finally:
            if self.daemon is not None and self.daemon.poll() is None:
                if self.freezer:
                    self.freezer.freeze(False)
                self.daemon.kill()
                self.daemon.communicate()
            for helper in (self.freezer, self.spinner):
                if helper:
                    helper.close()
        return {"began_ns": began, "reports": self.reports}


def inside(words: list[str]) -> int:
    kind, folder, asset, core, times, period = words
    run = Inside(kind, folder, asset, int(core) if core else None)
    told = run.run(int(times), float(period))
    with open(os.path.join(folder, "told.json"), "w", encoding="utf-8") as file:
        json.dump(told, file)
    return 0


def times_off(began: list[int], seen: dict) -> list[dict]:
    """Of each event: after which time no motor had a current, ms (NEVER_MS: one had), and that since
    the last command, whether one had a current when it began, and how long the emulation was deaf
    until then, ms."""
    events = []
    for at in began:
        changes = sum(change <= at for key in ("current_began_ns", "current_ended_ns")
                      for change in seen[key])
        ended, last = next(((end, last) for end, last in zip(seen["current_ended_ns"],
                                                             seen["last_current_ns"]) if end > at),
                           (at + NEVER_MS * 1e6, at))
        deaf = sum(min(end, ended) - max(start, at) for start, end in seen["deaf_ns"]
                   if end > at and start < ended)
        events.append({"off_ms": (ended - at) * 1e-6, "unasked_ms": (ended - last) * 1e-6,
                       "current": changes % 2 == 1, "deaf_ms": deaf * 1e-6})
    return events


def run_session(kind: str, times: int, period: float = 0.0, device: str = "wooden-v2",
                core: int | None = None) -> tuple[list[dict], dict, list[dict]]:
    """So many events under one emulated device: the events, what the device saw, and the daemon's
    reports. Where a core is named, the loop's, the device is emulated on the others."""
    asset, _ = baked_box()
    with Folder() as folder:
        report = os.path.join(folder, "device.json")
        cores = sorted(os.sched_getaffinity(0))
        others = [one for one in cores if one != core] or cores
        command = ["taskset", "--cpu-list", ",".join(map(str, others)), program("mock_hid"), device,
                   f"report={report}", "--", "env", "-u", "LD_PRELOAD", "taskset", "--cpu-list",
                   ",".join(map(str, cores)), sys.executable, os.path.join(HERE, "away.py"),
                   "--inside", kind, folder, asset, "" if core is None else str(core), str(times),
                   str(period)]
        done = subprocess.run(command, stderr=subprocess.PIPE, text=True, check=False,
                              timeout=10 * PATIENCE + 4 * times * max(period, 1.0))
        if done.returncode != 0:
            with open(os.path.join(folder, "messages"), encoding="utf-8") as messages:
                raise RuntimeError(f"{kind}: {done.stderr}{messages.read()}")
        with open(report, encoding="utf-8") as file:
            seen = json.load(file)
        with open(os.path.join(folder, "told.json"), encoding="utf-8") as file:
            told = json.load(file)
    return times_off(told["began_ns"], seen), seen, told["reports"]


def counts(event: dict) -> bool:
    """Whether an event tells something: there was a current, and the emulation listened."""
    return event["current"] and event["deaf_ms"] == 0


def measure(kind: str, times: int, period: float, device: str, core: int | None) -> dict:
    events: list[dict] = []
    stalled = 0
    for _ in range(MOST_SESSIONS):
        missing = times - sum(map(counts, events))
        if missing <= 0:
            break
        more, _, reports = run_session(kind, missing, period, device, core)
        events += more
        stalled += sum(cause["count"] for report in reports for cause in report["force_off"]
                       if cause["cause"] in ("stalled", "device_silent"))
    off, unasked = ([event[key] for event in events if counts(event)]
                    for key in ("off_ms", "unasked_ms"))
    deaf = [event for event in events if event["deaf_ms"] > 0]
    return {"kind": kind, "how": KINDS[kind], "why_not": "", "times": len(off),
            "off_ms": {"p50": percentile(off, 0.5), "p99": percentile(off, 0.99),
                       "max": max(off, default=0.0)},
            "unasked_ms": {"p50": percentile(unasked, 0.5), "p99": percentile(unasked, 0.99),
                           "max": max(unasked, default=0.0)},
            "later": sum(one > LIMIT_MS for one in off), "deaf": len(deaf),
            "deaf_off_ms_max": max((event["off_ms"] for event in deaf), default=0.0),
            "without_current": sum(not event["current"] for event in events),
            "found_by_the_loop": stalled, "all_off_ms": [round(one, 3) for one in off],
            "all_unasked_ms": [round(one, 3) for one in unasked]}


def left_out(kind: str, reason: str) -> dict:
    return {"kind": kind, "how": KINDS[kind], "why_not": reason, "times": 0}


def row_of(found: dict) -> list:
    if found["why_not"]:
        return [found["kind"], f"not to be had here: {found['why_not']}", 0, *[""] * 7]
    off = found["off_ms"]
    return [found["kind"], found["how"], found["times"], off["p50"], off["p99"], off["max"],
            found["later"], found["unasked_ms"]["max"], found["deaf"], found["without_current"]]


def main() -> int:
    if sys.argv[1:2] == ["--inside"]:
        return inside(sys.argv[2:])
    if sys.argv[1:2] == ["--spin"]:
        return spin(int(sys.argv[2]))
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--minutes", type=float, default=10)
    parser.add_argument("--times", type=int, default=100, help="of each kind (default 100)")
    parser.add_argument("--kind", action="append", choices=tuple(KINDS),
                        help="may be repeated (default: all)")
    parser.add_argument("--device", choices=("wooden-v1", "wooden-v2", "wooden-v3"),
                        default="wooden-v2", help="the emulated board (default: wooden-v2)")
    add_common_options(parser)
    arguments = parser.parse_args()
    if arguments.cores:
        os.sched_setaffinity(0, {int(core) for core in arguments.cores.split(",")})
    core = max(os.sched_getaffinity(0))
    kinds = arguments.kind or list(KINDS)
    period = arguments.minutes * 60 / (len(kinds) * arguments.times)
    load = os.getloadavg()[0]
    begun = time.monotonic()
    found = [left_out(kind, reason) if (reason := why_not(kind)) else
             measure(kind, arguments.times, period, arguments.device, core) for kind in kinds]
    minutes = (time.monotonic() - begun) / 60
    show(arguments.out, f"{minutes:.1f} minutes on an emulated {arguments.device}, the loop and its "
         f"guards on one core by `--core`; load of the machine {load:.1f} at the beginning, "
         f"{os.getloadavg()[0]:.1f} at the end",
         ["daemon", "by", "times", "no current after, p50, ms", "p99, ms", "max, ms",
          f"later than {LIMIT_MS:g} ms", "since its last command: max, ms",
          "done again, since the emulation was deaf", "no current just then"],
         [row_of(result) for result in found],
         {"device": arguments.device, "minutes": minutes, "limit_ms": LIMIT_MS, "load_before": load,
          "load_after": os.getloadavg()[0], "kinds": found})
    return 0


if __name__ == "__main__":
    sys.exit(main())
