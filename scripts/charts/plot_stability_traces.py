#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws force and energy over time of each method's worst case, from `spm-bench stability --json
--traces FOLDER`. Writes PREFIX.svg and PREFIX.png; equal input gives equal bytes.

Needs matplotlib, Debian package python3-matplotlib: run it with /usr/bin/python3.
"""

import os
import sys
import textwrap

from chart_io import add_report, chart_parser, read_columns, read_report
from chart_style import COLOURS, NAMES, save
from stability_rows import methods_of

import matplotlib.pyplot as plt
import numpy as np

BINS = 700        # a band from least to largest in each: a cycle is shorter than a bin
HAND = "#8c8c8c"
TAKEN = "#7a8fa6"
MADE = "#c8452f"
WORDS_WIDTH = 175  # letters


def read_trace(path: str) -> dict[str, np.ndarray]:
    names, rows = read_columns(path)
    return dict(zip(names, np.array(rows).T))


def draw_band(axes, time: np.ndarray, values: np.ndarray, colour: str, **style) -> None:
    edges = np.linspace(0, len(values), min(BINS, len(values)) + 1).astype(int)
    parts = [values[first:last] for first, last in zip(edges[:-1], edges[1:])]
    axes.fill_between(time[edges[:-1]], [part.min() for part in parts],
                      [part.max() for part in parts], color=colour, linewidth=0.8,
                      rasterized=True, **style)


def words_of(worst: dict) -> str:
    row = worst["row"]
    settings = f"{row['case']}, {row['stiffness_n_m'] / 1e3:.2g} N/mm on {row['device']}"
    return f"{settings}: {row['reason'] or 'good, as are all others'}"


def draw_energy(axes, time: np.ndarray, joules: np.ndarray, colour: str) -> None:
    unit, scale = ("mJ", 1e3) if np.abs(joules).max() > 1e-3 else ("uJ", 1e6)
    places = np.unique(np.linspace(0, len(joules) - 1, BINS).astype(int))
    time, energy = time[places], scale * joules[places]
    axes.fill_between(time, 0, np.maximum(energy, 0), color=MADE, alpha=0.35, linewidth=0)
    axes.fill_between(time, 0, np.minimum(energy, 0), color=TAKEN, alpha=0.25, linewidth=0)
    axes.plot(time, energy, color=colour, linewidth=1.3)
    axes.axhline(0, color="#bbbbbb", linewidth=0.7)
    axes.set_ylabel(f"energy, {unit}")


def draw_worst(left, right, worst: dict, trace: dict[str, np.ndarray]) -> None:
    method = worst["method"]
    colour = COLOURS.get(method.split("+")[0], "#222222")
    time = trace["t"]
    draw_band(left, time, -trace["hand_force"], HAND, alpha=0.55)
    draw_band(left, time, trace["force_magnitude"], colour, alpha=0.3)
    draw_band(left, time, trace["force"], colour)
    largest = max(trace["force_magnitude"].max(), np.abs(trace["hand_force"]).max(), 0.1)
    left.set_ylim(min(-0.1 * largest, 1.08 * trace["force"].min()), 1.12 * largest)
    draw_energy(right, time, trace["energy"], colour)
    left.set_title(NAMES.get(method, method), color=colour, fontweight="bold", fontsize=11.5, pad=19)
    words = textwrap.shorten(words_of(worst), width=WORDS_WIDTH, placeholder=" ...")
    text = left.text(0.0, 1.03, words, transform=left.transAxes, fontsize=8.5, color="#444444",
                     va="bottom")
    text.set_in_layout(False)
    left.set_ylabel("force, N")
    for axes in (left, right):
        axes.set_xlim(time[0], time[-1])


def main() -> int:
    parser = chart_parser(__doc__)
    add_report(parser, "stability")
    parser.add_argument("traces", help="folder that it wrote traces to")
    arguments = parser.parse_args()
    report = read_report(arguments.report, "stability", "worst")
    # A stabilizer alone is a column of the table; here the methods are seen, and the default.
    found = {one["method"]: one for one in report["worst"] if "+" not in one["method"]}
    worst = [found[method] for method in methods_of(list(found.values()))]
    if not worst:
        sys.exit(f"{arguments.report}: no runs; give what spm-bench stability --json printed")
    figure, panels = plt.subplots(len(worst), 2, figsize=(13.5, 2.05 * len(worst) + 0.9),
                                  squeeze=False, constrained_layout=True,
                                  gridspec_kw={"width_ratios": (1.7, 1)})
    for (left, right), one in zip(panels, worst):
        draw_worst(left, right, one, read_trace(os.path.join(arguments.traces, one["trace"])))
    panels[0][1].set_title("energy from the device: red is made of nothing", fontsize=9.5,
                           color="#444444")
    for axes in panels[-1]:
        axes.set_xlabel("time, s")
    row = worst[0]["row"]
    share = row["fraction"]
    figure.suptitle(f"Each method's worst case at {share:g} of the flat border\n\n", x=0.008, ha="left",
                    fontsize=15, fontweight="bold")
    figure.text(0.008, 1 - 0.42 / figure.get_figheight(), "Colour: force along the normal, lighter its "
                "magnitude. Grey: what the hand presses with.", fontsize=9.5, color="#555555", va="top")
    save(figure, arguments.prefix)
    return 0


if __name__ == "__main__":
    sys.exit(main())
