# SPDX-License-Identifier: Apache-2.0
"""How long the loop's core stood still, and when: cyclictest (Debian package rt-tests) on that core,
one priority above the loop and five times in a millisecond. A tick that was lost is explained by it
where the core stood still in that tick, and the tick would have been in time without that."""

import re
from typing import NamedTuple

from cyclictest import end_cyclictest, start_cyclictest
from soak_tools import Row, overruns

INTERVAL = 200  # us
LEAST = 50  # us, that a stall is kept from
MOST = 500_000  # stalls that are kept

SPIKE = re.compile(r"Spike:\s*(\d+): TS:\s*(\d+)")


class Stall(NamedTuple):
    """When a core stood still, ns of CLOCK_MONOTONIC. It may have begun by cyclictest's interval
    earlier."""
    begin: float
    end: float


class StallWatch:
    """cyclictest on one core; `end` tells what it saw."""

    def __init__(self, priority: int, core: int) -> None:
        self.process = start_cyclictest(priority, INTERVAL, f"--affinity={core}",
                                        f"--spike={LEAST}", f"--spike-nodes={MOST}")

    def end(self) -> list[Stall]:
        output, messages = end_cyclictest(self.process)
        if "spikes =" not in output:
            raise RuntimeError("cyclictest told no stalls: " + (messages or output))
        return [Stall((int(woke) - int(late)) * 1e3, int(woke) * 1e3)
                for late, woke in SPIKE.findall(output)]


def stood_still(stalls: list[Stall], begin: float, end: float) -> float:
    """ns of a time in which the core stood still."""
    still, known = 0.0, begin
    for stall in sorted(stalls):
        still += max(0.0, min(stall.end, end) - max(stall.begin, known))
        known = max(known, stall.end)
    return still


def explained(rows: list[Row], start: float, rate_hz: float, stalls: list[Stall],
              earlier: float = 0) -> int:
    """Of the lost ticks, as the loop counts them, those of stalls of the core. `start`: when tick 0
    was due, ns; `earlier`: by how much each stall may have begun before it was seen, ns."""
    period, found = 1e9 / rate_hz, 0
    stalls = [Stall(one.begin - earlier, one.end) for one in stalls]
    for row, count in overruns(rows):
        due, took = start + row.tick * period, row.wake_ns + row.busy_ns
        near = [one for one in stalls if one.end > due and one.begin < due + took]
        if took - stood_still(near, due, due + took) < period:
            found += count
    return found
