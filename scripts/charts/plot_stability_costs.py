#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws what `spm-bench stability --json` measured of stable, accurate and fast: the largest stable
stiffness of each method against its rendering error and against its time per tick. Writes PREFIX.svg
and PREFIX.png; equal input gives equal bytes.

Needs matplotlib, Debian package python3-matplotlib: run it with /usr/bin/python3.
"""

import sys

from chart_io import report_and_prefix
from chart_style import BACKGROUND, COLOURS, NAMES, save
from label_places import LabelPlaces
from stability_rows import methods_of

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.ticker import FixedLocator, NullLocator

ERRORS = {0.01: "0.01 %", 0.1: "0.1 %", 1: "1 %", 10: "10 %", 100: "100 %", 1000: "1000 %"}
TIMES = {0.1: "0.1 us", 0.3: "0.3 us", 1: "1 us", 3: "3 us", 10: "10 us", 30: "30 us",
         100: "100 us", 300: "300 us"}
LEAST_ERROR = 0.01  # %; the exact penalty has none


def borders_of(report: dict, method: str) -> np.ndarray:
    """Of the first device, as shares of its flat border."""
    first = report["flat_borders"][0]["device"]
    return np.array([row["border_n_m"] / row["flat_border_n_m"] for row in report["borders"]
                     if row["method"] == method and row["device"] == first and row["degrees"] == 3])


def marks_of(report: dict) -> list[dict]:
    costs = {row["method"]: row for row in report["costs"]}
    marks = []
    for method in methods_of(report["costs"]):
        borders = borders_of(report, method)
        if not len(borders):
            continue
        row = costs[method]
        error = max(100 * row.get("median_error", row["relative_error"]), LEAST_ERROR)
        marks.append({
            "method": method, "error": error,
            "error_reach": max(100 * row["relative_error"], error), "time": row["mean_us"],
            "time_reach": row["p99_us"], "middle": borders.mean(), "worst": borders.min(),
            "bare": "+" not in method, "colour": COLOURS.get(method.split("+")[0], "#222222")})
    return marks


def draw_panel(axes, marks: list[dict], key: str, ticks: dict[float, str]) -> None:
    reach = key + "_reach"
    axes.set_xscale("log")
    axes.set_xlim(min(mark[key] for mark in marks) / 2, max(mark[reach] for mark in marks) * 2)
    shown = [tick for tick in ticks if axes.get_xlim()[0] <= tick <= axes.get_xlim()[1]]
    axes.xaxis.set_major_locator(FixedLocator(shown))
    axes.set_xticklabels([ticks[tick] for tick in shown])
    axes.xaxis.set_minor_locator(NullLocator())
    axes.set_ylim(-0.06, 1.08 * max(mark["middle"] for mark in marks) + 0.15)
    axes.grid(True, color="#e8e8e8", linewidth=0.6)
    axes.set_axisbelow(True)
    axes.axhline(1, color="#999999", linewidth=0.9, linestyle="--")
    for mark in marks:
        colour = mark["colour"]
        axes.hlines(mark["middle"], mark[key], mark[reach], color=colour, linewidth=1, alpha=0.35)
        axes.vlines(mark[key], mark["worst"], mark["middle"], color=colour, linewidth=1, alpha=0.35)
        size = 120 if mark["method"] == "default" else 60
        axes.scatter([mark[key]], [mark["middle"]], s=size, zorder=4, edgecolors=colour,
                     facecolors=colour if mark["bare"] else "white", linewidths=1.6)
        axes.scatter([mark[key]], [mark["worst"]], marker="v", s=30, facecolors=colour,
                     edgecolors="none", alpha=0.75, zorder=4)


def label_panel(axes, marks: list[dict], key: str) -> None:
    places = LabelPlaces(axes)
    for mark in marks:
        places.block((mark[key], mark["middle"]), 6)
        places.block((mark[key], mark["worst"]), 4)
    for mark in marks:
        default = mark["method"] == "default"
        places.add((mark[key], mark["middle"]), NAMES.get(mark["method"], mark["method"]),
                   mark["colour"], 6, size=12 if default else 9.5 if mark["bare"] else 8.5,
                   weight="bold" if default else "normal")
    places.draw(BACKGROUND)


def main() -> int:
    report, prefix = report_and_prefix(__doc__, "stability", "costs")
    marks = marks_of(report)
    if not marks:
        sys.exit("no borders; give what spm-bench stability --json printed, without --quick")
    figure, (left, right) = plt.subplots(1, 2, figsize=(15, 7.4), sharey=True)
    figure.subplots_adjust(left=0.055, right=0.99, top=0.88, bottom=0.155, wspace=0.05)
    draw_panel(left, marks, "error", ERRORS)
    draw_panel(right, marks, "time", TIMES)
    flat = report["flat_borders"][0]
    left.set_ylabel(f"largest stable stiffness over the flat wall's {flat['border_n_m'] / 1e3:.2g} N/mm, "
                    f"on {flat['device']}", fontsize=10)
    left.set_xlabel("force off the exact penalty's, of its RMS, on a slide over teeth at 1 N/mm",
                    fontsize=10)
    right.set_xlabel("time of a tick on that slide", fontsize=10)
    left.set_title("Stable and accurate: up and left", fontweight="bold", fontsize=12)
    right.set_title("Stable and fast: up and left", fontweight="bold", fontsize=12)
    figure.suptitle("Stable, accurate, fast", x=0.008, ha="left", fontsize=16, fontweight="bold")
    figure.text(0.008, 0.02,
                "Dot: mean of the cases, hollow with a stabilizer; triangle: the worst case, at 0 where the "
                "method fails it at any stiffness.\nLeft: the median of the ticks, its line to the RMS of "
                "all, in which a proxy that is left behind weighs most. Right: the mean, its line to the "
                "99th per cent.", fontsize=9.5, color="#555555", linespacing=1.4)
    figure.canvas.draw()
    label_panel(left, marks, "error")
    label_panel(right, marks, "time")
    save(figure, prefix)
    return 0


if __name__ == "__main__":
    sys.exit(main())
