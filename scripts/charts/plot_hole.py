#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws the force along a path through a place where baked files once had no answer, before and after,
from what measure_hole.py printed. Writes PREFIX.svg and PREFIX.png; equal input gives equal bytes.

Needs matplotlib, Debian package python3-matplotlib: run it with /usr/bin/python3.
"""

import json
import sys

from chart_io import chart_parser
from chart_style import COLOURS, OURS, save

import matplotlib.pyplot as plt
import numpy as np

EXACT = COLOURS["exact-penalty"]
BEFORE = "#1f5f8b"


def gap(way: np.ndarray, force: np.ndarray, exact: np.ndarray) -> tuple[float, float] | None:
    """First and last place, mm, where there is no force though the exact mesh pushes."""
    missing = np.flatnonzero((force == 0) & (exact > 0))
    return (way[missing[0]], way[missing[-1]]) if len(missing) else None


def draw(axes, way, force, exact, colour, title) -> None:
    axes.plot(way, exact, color=EXACT, linewidth=3.2, alpha=0.5, zorder=2)
    axes.plot(way, force, color=colour, linewidth=1.3, zorder=3)
    axes.set_title(title, color=colour, fontweight="bold")
    axes.set_xlabel("path of the hand, mm")
    axes.grid(True, axis="y", color="#e4e4e4", linewidth=0.6)
    axes.set_axisbelow(True)
    if found := gap(way, force, exact):
        axes.annotate(f"no force for {found[1] - found[0] + way[1]:.2f} mm", (found[1], 0.1),
                      xytext=(8, 0), textcoords="offset points", va="center", color=colour)


def main() -> int:
    parser = chart_parser(__doc__)
    parser.add_argument("report", help="JSON that measure_hole.py printed")
    arguments = parser.parse_args()
    with open(arguments.report, encoding="utf-8") as file:
        report = json.load(file)
    if missing := [key for key in ("before", "after") if key not in report]:
        sys.exit(f"{arguments.report}: no {missing[0]}; scripts/charts/measure_hole.py makes it")
    exact = np.array(report["exact_n"])
    length = np.linalg.norm(np.subtract(report["to_mm"], report["from_mm"]))
    way = np.linspace(0, length, len(exact))
    figure, panels = plt.subplots(1, 2, figsize=(10.5, 3.3), sharey=True, sharex=True,
                                  constrained_layout=True)
    for axes, key, colour, title in ((panels[0], "before", BEFORE, "Before"),
                                     (panels[1], "after", OURS, "Now")):
        draw(axes, way, np.array(report[key]["force_n"]), exact, colour, title)
        commit = report[key].get("commit") or report.get("made", {}).get("commit", "")
        axes.set_title(f"commit {commit}" if commit else "", loc="right", fontsize=8.5,
                       color="#666666")
    panels[0].set_ylabel("force, N")
    panels[0].set_xlim(0, length)
    panels[0].set_ylim(0, 1.25 * max(exact.max(), *report["before"]["force_n"]))
    figure.suptitle("A hand slides inside a thin limb, 1 N/mm; grey: the exact mesh's penalty",
                    x=0.008, ha="left", fontsize=13, fontweight="bold")
    save(figure, arguments.prefix)
    return 0


if __name__ == "__main__":
    sys.exit(main())
