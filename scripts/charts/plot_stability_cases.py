#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws the verdicts of `spm-bench stability --json` as a table, cases against methods, by theme: a
cell has a column a device and a row a stiffness, as a share of the device's own flat border. Writes
PREFIX.svg and PREFIX.png; equal input gives equal bytes.

Needs matplotlib, Debian package python3-matplotlib: run it with /usr/bin/python3.
"""

import sys

from chart_io import report_and_prefix
from chart_style import COLOURS, NAMES, save
from stability_rows import COLOURS as VERDICTS, WORDS, methods_of, names_of, themes_of, verdict_of

import matplotlib.pyplot as plt
from matplotlib.patches import PathPatch, Rectangle
from matplotlib.path import Path

GAP = 0.16         # of a cell
LEAST = 0.62       # of a cell's height that the smallest stiffness takes
FAMILY_GAP = 0.45  # of a column, between methods of different kinds
THEME_GAP = 0.5    # of a row
HEAD = 7.4         # rows above the first


class Cells:
    """Rectangles by colour, drawn as one path each."""

    def __init__(self):
        self.corners: dict[str, list] = {}

    def add(self, x: float, y: float, width: float, height: float, colour: str) -> None:
        self.corners.setdefault(colour, []).extend(
            [(x, y), (x + width, y), (x + width, y + height), (x, y + height), (x, y)])

    def draw(self, axes) -> None:
        for colour, corners in self.corners.items():
            codes = [Path.MOVETO, Path.LINETO, Path.LINETO, Path.LINETO, Path.CLOSEPOLY]
            axes.add_patch(PathPatch(Path(corners, codes * (len(corners) // 5)), color=colour,
                                     linewidth=0))


def add_cell(cells: Cells, x: float, y: float, rows: list[dict], devices: list[str],
             fractions: list[float]) -> None:
    width = (1 - GAP) / len(devices)
    heights = [1 - GAP] if len(fractions) == 1 else [
        LEAST * (1 - GAP), *[(1 - LEAST) * (1 - GAP) / (len(fractions) - 1)] * (len(fractions) - 1)]
    for row in rows:
        across, down = devices.index(row["device"]), fractions.index(row["fraction"])
        cells.add(x + GAP / 2 + across * width, y + GAP / 2 + sum(heights[:down]), 0.93 * width,
                  heights[down] - 0.05, VERDICTS[verdict_of(row)])


def share_good(rows: list[dict], fraction: float) -> str:
    """Of the cells at a fraction those that are good, per cent."""
    tried = [row for row in rows if row["fraction"] == fraction]
    return f"{100 * sum(row['stable'] for row in tried) / len(tried):.0f} %" if tried else ""


def family(method: str) -> str:
    base = method.split("+")[0]
    return base if base in ("spm", "proxy", "default") else "rivals"


def columns_of(methods: list[str]) -> dict[str, float]:
    """Where each method's column begins."""
    places, x, last = {}, 0.0, None
    for method in methods:
        if last is not None and family(method) != last:
            x += FAMILY_GAP
        places[method], last = x, family(method)
        x += 1
    return places


def rows_of(report: dict) -> tuple[dict[str, float], list[tuple[str, float, float]]]:
    """Where each case's row begins, and each theme with its first row's begin and last one's end."""
    places, bands, y = {}, [], 0.0
    for theme, cases in themes_of(report):
        begin = y
        for case in cases:
            places[case] = y
            y += 1
        bands.append((theme, begin, y))
        y += THEME_GAP
    return places, bands


def draw_heads(axes, report: dict, columns: dict[str, float], fractions: list[float]) -> None:
    for method, x in columns.items():
        axes.text(x + 0.4, -1.35, NAMES.get(method, method), rotation=38, ha="left", va="bottom",
                  fontsize=11.5, fontweight="bold" if method == "default" else "normal",
                  color=COLOURS.get(method.split("+")[0], "#222222"))
        rows = [row for row in report["cases"] if row["method"] == method]
        for line, fraction in enumerate(fractions[:2]):
            axes.text(x + 0.5, -0.75 + 0.6 * line, share_good(rows, fraction), ha="center",
                      va="center", fontsize=10 if line == 0 else 8.5,
                      fontweight="bold" if line == 0 else "normal",
                      color="#222222" if line == 0 else "#888888")
    for line, fraction in enumerate(fractions[:2]):
        axes.text(-0.15, -0.75 + 0.6 * line, f"good at {fraction:g}", ha="right", va="center",
                  fontsize=10 if line == 0 else 8.5, color="#222222" if line == 0 else "#888888")


def draw_key(axes, left: float, top: float, devices: list[str], fractions: list[float]) -> None:
    for line, (name, words) in enumerate(WORDS.items()):
        y = top + 0.72 * line
        axes.add_patch(Rectangle((left, y), 0.45, 0.5, color=VERDICTS[name], linewidth=0,
                                 clip_on=False))
        axes.text(left + 0.6, y + 0.27, words, va="center", fontsize=10)
    words = f"In a cell, from left: {', '.join(devices)}."
    if len(fractions) > 1:
        words += (f"\nAbove, large: at {fractions[0]:g} of the device's own flat border;\nbelow: at "
                  f"{', '.join(f'{fraction:g}' for fraction in fractions[1:])}.")
    axes.text(left, top + 0.72 * len(WORDS) + 0.1, words, va="top", fontsize=9, color="#444444",
              linespacing=1.3)


def main() -> int:
    report, prefix = report_and_prefix(__doc__, "stability", "cases")
    cases = report["cases"]
    columns = columns_of(methods_of(cases))
    places, bands = rows_of(report)
    devices = names_of(cases, "device")
    fractions = sorted({row["fraction"] for row in cases})
    across, down = max(columns.values()) + 1, bands[-1][2]
    left_room, right_room = 4.4, 2.0
    width, height = 0.8 * (across + left_room + right_room), 0.33 * (down + HEAD + 0.6)
    figure, axes = plt.subplots(figsize=(width, height))
    figure.subplots_adjust(left=0, right=1, top=1, bottom=0)
    axes.set_axis_off()
    axes.set_xlim(-left_room, across + right_room)
    axes.set_ylim(down + 0.6, -HEAD)
    by_cell: dict[tuple[str, str], list[dict]] = {}
    for row in cases:
        by_cell.setdefault((row["case"], row["method"]), []).append(row)
    cells = Cells()
    for i, (theme, begin, end) in enumerate(bands):
        axes.add_patch(Rectangle((-left_room + 0.1, begin - 0.1), left_room + across, end - begin + 0.2,
                                 color="#f3f1ed" if i % 2 == 0 else "#ffffff", linewidth=0, zorder=0))
        upright = end - begin < 3
        axes.text(-left_room + (0.2 if upright else 0.35), (begin + end) / 2, theme,
                  rotation=0 if upright else 90, ha="left" if upright else "center", va="center",
                  fontsize=10.5, fontweight="bold", color="#555555")
    for name, y in places.items():
        axes.text(-0.15, y + 0.5, name, ha="right", va="center", fontsize=10.5)
        for method, x in columns.items():
            rows = by_cell.get((name, method), [])
            add_cell(cells, x, y, rows, devices, fractions)
            if not rows:
                axes.text(x + 0.5, y + 0.5, "–", ha="center", va="center", color="#aaaaaa")
    cells.draw(axes)
    draw_heads(axes, report, columns, fractions)
    axes.text(-left_room + 0.1, -HEAD + 0.25, "Where methods fail", fontsize=17, fontweight="bold",
              va="top")
    draw_key(axes, -left_room + 0.1, -HEAD + 1.35, devices, fractions)
    save(figure, prefix)
    return 0


if __name__ == "__main__":
    sys.exit(main())
