# SPDX-License-Identifier: Apache-2.0
"""cyclictest (Debian package rt-tests) beside the daemon: how late this machine wakes up any thread
of the loop's priority, in the same minutes.

The loop counts every tick that was due during a stall, and the late one itself, as missed;
cyclictest counts a stall as one late wake-up. What the loop would have counted in its place is told
too."""

import os
import shutil
import signal
import subprocess
import sys
from typing import Any

from soak_tools import PATIENCE, Daemon, stolen_seconds

LONGEST = 100_000  # us, to which cyclictest keeps its histogram
FACTOR, PLUS = 2, 5  # the target: missed at most so many times its late wake-ups, plus so many


def start_cyclictest(priority: int, interval: int, *options: str,
                     cores: set[int] | None = None) -> subprocess.Popen:
    """One thread that wakes up each `interval`, us."""
    if shutil.which("cyclictest") is None:
        sys.exit("cyclictest is missing; install it with: apt-get install rt-tests")
    pin = (lambda: os.sched_setaffinity(0, cores)) if cores else None
    return subprocess.Popen(
        ["cyclictest", "--quiet", "--mlockall", "--threads=1", f"--priority={priority}",
         f"--interval={interval}", *options],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, preexec_fn=pin)


def end_cyclictest(process: subprocess.Popen) -> tuple[str, str]:
    """What it printed, and its messages."""
    if process.poll() is None:
        process.send_signal(signal.SIGINT)
    return process.communicate(timeout=PATIENCE)


class Cyclictest:
    """One thread that wakes up at the loop's interval, with its policy and priority."""

    def __init__(self, rate_hz: float, priority: int, cores: set[int] | None) -> None:
        self.interval = round(1e6 / rate_hz)
        self.process = start_cyclictest(priority, self.interval, f"--histogram={LONGEST}",
                                        cores=cores)

    def end(self) -> dict:
        """Ends it; its wake-ups, in us. `late` are those that came after the next was due already,
        `lost` the intervals that they cost, `as_missed` what the loop would have counted."""
        output, messages = end_cyclictest(self.process)
        counts, overflows, longest = [], 0, 0
        for line in output.splitlines():
            if line.startswith("# Histogram Overflows:"):
                overflows = int(line.split(":")[1])
            elif line.startswith("# Max Latencies:"):
                longest = int(line.split(":")[1])
            elif line[:1].isdigit():
                lateness, count = line.split()[:2]
                counts.append((int(lateness), int(count)))
        total = sum(count for _, count in counts) + overflows
        if total == 0:
            raise RuntimeError("cyclictest counted nothing: " + (messages or output))
        late = [(lateness, count) for lateness, count in counts if lateness >= self.interval]
        if overflows > 0:
            late.append((longest, overflows))
        stalls = sum(count for _, count in late)
        lost = sum(count * (lateness // self.interval) for lateness, count in late)
        return {"interval_us": self.interval, "wake_ups": total, "late": stalls, "lost": lost,
                "as_missed": stalls + lost,
                "p50_us": self._at(counts, total, 0.5), "p99_us": self._at(counts, total, 0.99),
                "p999_us": self._at(counts, total, 0.999), "max_us": longest}

    @staticmethod
    def _at(counts: list[tuple[int, int]], total: int, share: float) -> int:
        seen = 0
        for lateness, count in counts:
            seen += count
            if seen >= share * total:
                return lateness
        return LONGEST


def finish_beside(daemon: Daemon, beside, seconds: float) -> tuple[dict, Any, float]:
    """Waits for the end of a daemon that ends by itself, and ends what runs beside it: both reports,
    and the seconds that the host took of the processors."""
    stolen = stolen_seconds()
    try:
        run = daemon.finish(seconds + PATIENCE)
        stolen = stolen_seconds() - stolen
    finally:
        seen = beside.end()
    return run, seen, stolen


def watch(daemon: Daemon, rate_hz: float, seconds: float, cores: set[int] | None) -> dict:
    """Lets a daemon that ends by itself run with cyclictest beside it: both reports, and whether
    the missed ticks are within the target."""
    priority = daemon.required_priority()
    beside = Cyclictest(rate_hz, priority, cores)
    run, machine, stolen = finish_beside(daemon, beside, seconds)
    allowed = FACTOR * machine["late"] + PLUS
    return {"run": run, "cyclictest": machine, "stolen_s": stolen, "allowed": allowed,
            "within": run["missed"] <= allowed,
            "stalls": run["missed"] - run["skipped"],
            "unexplained": run["missed"] - machine["as_missed"]}
