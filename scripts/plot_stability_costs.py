#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws what `spm-bench stability --json` measured of stable, accurate and fast: the largest stable
stiffness of each method against its rendering error and against its time per tick. Writes PREFIX.svg
and PREFIX.png; equal input gives equal bytes.

Needs matplotlib, Debian package python3-matplotlib: run it with /usr/bin/python3.
"""

import sys

from chart_style import BACKGROUND, COLOURS, NAMES, report_and_prefix, save
from label_places import LabelPlaces

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.ticker import FixedLocator, NullLocator

ERRORS = {0.01: "0.01 %", 0.1: "0.1 %", 1: "1 %", 10: "10 %", 100: "100 %"}
TIMES = {0.1: "0.1 us", 0.3: "0.3 us", 1: "1 us", 3: "3 us", 10: "10 us", 30: "30 us",
         100: "100 us", 300: "300 us"}
LEAST_ERROR = 0.01  # %; the exact penalty has none


def borders_of(report: dict, method: str) -> np.ndarray:
    """Of the first device, as shares of its flat border."""
    first = report["flat_borders"][0]["device"]
    return np.array([row["border_n_m"] / row["flat_border_n_m"] for row in report["borders"]
                     if row["method"] == method and row["device"] == first and row["degrees"] == 3])


def draw_panel(axes, marks: list[dict], key: str, ticks: dict[float, str]) -> None:
    axes.set_xscale("log")
    axes.xaxis.set_major_locator(FixedLocator(list(ticks)))
    axes.set_xticklabels(list(ticks.values()))
    axes.xaxis.set_minor_locator(NullLocator())
    places = [mark[key] for mark in marks]
    axes.set_xlim(min(places) / 2, max(places) * 2.5)
    axes.set_ylim(-0.08, 1.1 * max(mark["quartiles"][2] for mark in marks) + 0.1)
    axes.grid(True, axis="y", color="#e4e4e4", linewidth=0.6)
    axes.set_axisbelow(True)
    axes.axhline(1, color="#999999", linewidth=0.9, linestyle="--")
    for mark in marks:
        low, middle, high = mark["quartiles"]
        axes.vlines(mark[key], low, high, color=mark["colour"], linewidth=1.6, alpha=0.5)
        axes.scatter([mark[key]], [middle], s=mark["size"], color=mark["colour"], zorder=4)
        axes.scatter([mark[key]], [mark["worst"]], marker="v", s=26, facecolors="white",
                     edgecolors=mark["colour"], zorder=4)


def label_panel(axes, marks: list[dict], key: str) -> None:
    places = LabelPlaces(axes)
    for mark in marks:
        places.block((mark[key], mark["quartiles"][1]), 5)
        places.block((mark[key], mark["worst"]), 4)
    for mark in marks:
        default = mark["method"] == "default"
        places.add((mark[key], mark["quartiles"][1]), NAMES.get(mark["method"], mark["method"]),
                   mark["colour"], 5, size=10 if default else 8,
                   weight="bold" if default else "normal")
    places.draw(BACKGROUND)


def main() -> int:
    report, prefix = report_and_prefix(__doc__, "stability", "costs")
    marks = []
    for row in report["costs"]:
        borders = borders_of(report, row["method"])
        if not len(borders):
            continue
        marks.append({
            "method": row["method"], "error": max(100 * row["relative_error"], LEAST_ERROR),
            "time": row["mean_us"], "quartiles": np.quantile(borders, (0.25, 0.5, 0.75)),
            "worst": borders.min(), "size": 80 if row["method"] == "default" else 42,
            "colour": COLOURS.get(row["method"].split("+")[0], "#222222")})
    if not marks:
        sys.exit("no borders; give what spm-bench stability --json printed, without --quick")
    figure, (left, right) = plt.subplots(1, 2, figsize=(14.5, 6.4), sharey=True)
    figure.subplots_adjust(left=0.055, right=0.99, top=0.86, bottom=0.14, wspace=0.05)
    draw_panel(left, marks, "error", ERRORS)
    draw_panel(right, marks, "time", TIMES)
    flat = report["flat_borders"][0]
    left.set_ylabel(f"largest stable stiffness over the flat wall's, {flat['device']} "
                    f"({flat['border_n_m'] / 1e3:.2g} N/mm)")
    left.set_xlabel("rendering error: RMS off the exact penalty's force on a slide over teeth")
    right.set_xlabel("time of a tick on that slide")
    left.set_title("Stable and accurate", fontweight="bold")
    right.set_title("Stable and fast", fontweight="bold")
    figure.suptitle("Stable, accurate, fast: up and left is better", x=0.008, ha="left",
                    fontsize=15, fontweight="bold")
    figure.text(0.008, 0.02, "Dot: median of the cases; bar: the middle half; hollow mark: the worst "
                "case. A method whose worst case lies at 0 fails it at any stiffness. Errors and "
                "times are of the same run.", fontsize=8.5, color="#666666")
    figure.canvas.draw()
    label_panel(left, marks, "error")
    label_panel(right, marks, "time")
    save(figure, prefix)
    return 0


if __name__ == "__main__":
    sys.exit(main())
