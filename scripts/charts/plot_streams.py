#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws what streams of commands of an application did to a hand, before and now, from what
measure_streams printed: energy beyond what the changes allow, and the largest step of the force on a hand
that keeps still. Writes PREFIX.svg and PREFIX.png; equal input gives equal bytes.

Needs matplotlib, Debian package python3-matplotlib: run it with /usr/bin/python3.
"""

import json
import sys

from chart_io import chart_parser
from chart_style import OURS, save

import matplotlib.pyplot as plt

BEFORE = "#1f5f8b"
WORDS = {"same_far": "material, unchanged,\nof another object", "same_touched": "material, unchanged",
         "material": "material", "texture": "texture", "added_far": "object added,\n0.7 m away",
         "added_here": "object added here", "method": "method", "stabilizers": "stabilization",
         "cap": "force cap", "same_cap": "force cap,\nnever met", "spring": "spring's point",
         "detents": "detents", "push": "push", "clutch": "clutch", "placed": "object placed"}
NOT_OF_THE_POTENTIAL = ("push", "clutch")


def bars(axes, kinds: list[str], before: dict, now: dict, colours: tuple[str, str]) -> None:
    for side, (values, colour, name) in enumerate(((before, colours[0], "before"),
                                                   (now, colours[1], "now"))):
        there = [(place, values[kind]) for place, kind in enumerate(kinds)
                 if values.get(kind) is not None]
        axes.barh([place + 0.2 - 0.4 * side for place, _ in there], [value for _, value in there],
                  height=0.36, color=colour, label=name, zorder=2)
    axes.set_yticks(range(len(kinds)), [WORDS.get(kind, kind) for kind in kinds], fontsize=8.5)
    axes.invert_yaxis()
    axes.grid(True, axis="x", color="#e4e4e4", linewidth=0.6)
    axes.set_axisbelow(True)


def column(report: dict, key: str, factor: float, leave_out: tuple[str, ...] = ()) -> dict:
    """Values above 0 alone: a stream that takes energy from the hand made none."""
    return {row["kind"]: max(0.0, factor * row[key]) for row in report["kinds"]
            if row["kind"] not in leave_out}


def main() -> int:
    parser = chart_parser(__doc__)
    parser.add_argument("report", help="JSON with what measure_streams printed, before and now")
    arguments = parser.parse_args()
    with open(arguments.report, encoding="utf-8") as file:
        report = json.load(file)
    if missing := [key for key in ("before", "now") if not report.get(key, {}).get("kinds")]:
        sys.exit(f"{arguments.report}: no {missing[0]}; scripts/measure --only streams makes it")
    before, now = report["before"], report["now"]
    kinds = [row["kind"] for row in now["kinds"]]
    figure, panels = plt.subplots(1, 2, figsize=(10.5, 5.6), sharey=True, constrained_layout=True)
    bars(panels[0], kinds, column(before, "beyond_allowed_max_j", 1e3, NOT_OF_THE_POTENTIAL),
         column(now, "beyond_allowed_max_j", 1e3, NOT_OF_THE_POTENTIAL), (BEFORE, OURS))
    bars(panels[1], kinds, column(before, "still_step_max_n", 1),
         column(now, "still_step_max_n", 1), (BEFORE, OURS))
    panels[0].invert_yaxis()  # shared: each call has turned it
    panels[0].set_xlabel("energy beyond the change, most of all streams, mJ")
    panels[1].set_xlabel("largest step on a hand that keeps still, N a tick")
    panels[1].axvline(0.12, color="#999999", linewidth=0.9, linestyle=":", zorder=1)
    panels[0].legend(loc="lower right", frameon=False)
    figure.suptitle(f"{now['streams']:,} streams of commands, 15 to 1000 a second, of 1.5 s each; "
                    "dotted: 120 N/s", x=0.008, ha="left", fontsize=12, fontweight="bold")
    save(figure, arguments.prefix)
    return 0


if __name__ == "__main__":
    sys.exit(main())
