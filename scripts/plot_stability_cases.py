#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws the verdicts of `spm-bench stability --json` as a table, cases against methods: a cell has a
column a device and a row a stiffness, as a share of the device's own flat border. Writes PREFIX.svg
and PREFIX.png; equal input gives equal bytes.

Needs matplotlib, Debian package python3-matplotlib: run it with /usr/bin/python3.
"""

import sys

from chart_style import COLOURS, NAMES, report_and_prefix, save

import matplotlib.pyplot as plt
from matplotlib.patches import Rectangle

VERDICTS = {"good": "#3f8f5f", "between": "#e8c15a", "bad": "#c8452f", "popped": "#5b1a4a"}
WORDS = {"good": "good", "between": "between", "bad": "bad: vibrates or never settles",
         "popped": "popped through"}
GAP = 0.14  # of a cell


def verdict_of(row: dict) -> str:
    return "popped" if row["popped"] else row["verdict"]


def draw_cell(axes, x: float, y: float, rows: list[dict], devices: list[str],
              fractions: list[float]) -> None:
    width, height = (1 - GAP) / len(devices), (1 - GAP) / len(fractions)
    for row in rows:
        across, down = devices.index(row["device"]), fractions.index(row["fraction"])
        axes.add_patch(Rectangle((x + GAP / 2 + across * width, y + GAP / 2 + down * height),
                                 0.94 * width, 0.92 * height, linewidth=0,
                                 color=VERDICTS[verdict_of(row)]))


def share_good(rows: list[dict], fraction: float) -> str:
    """Of the cells at a fraction those that are good, per cent."""
    tried = [row for row in rows if row["fraction"] == fraction]
    return f"{100 * sum(row['stable'] for row in tried) / len(tried):.0f} %" if tried else ""


def draw_heads(axes, report: dict, methods: list[str], fractions: list[float]) -> None:
    for x, method in enumerate(methods):
        name = NAMES.get(method, method)
        axes.text(x + 0.5, -0.75, name, rotation=38, ha="left", va="bottom", fontsize=9.5,
                  fontweight="bold" if method == "default" else "normal",
                  color=COLOURS.get(method.split("+")[0], "#222222"))
        rows = [row for row in report["cases"] if row["method"] == method]
        axes.text(x + 0.5, -0.1, " / ".join(share_good(rows, f) for f in fractions), ha="center",
                  va="bottom", fontsize=6.5, color="#666666")


def draw_key(axes, y: float, devices: list[str], fractions: list[float]) -> None:
    x = 0.0
    for name, words in WORDS.items():
        axes.add_patch(Rectangle((x, y), 0.25, 0.5, color=VERDICTS[name], linewidth=0))
        axes.text(x + 0.35, y + 0.25, words, va="center", fontsize=8.5)
        x += 0.9 + 0.11 * len(words)
    rows = " above ".join(f"{fraction:g}" for fraction in fractions)
    axes.text(0, y + 0.95, f"In a cell: columns {', '.join(devices)}; rows {rows} of the device's own "
              "flat border.", va="center", fontsize=8.5, color="#444444")
    axes.text(0, y + 1.45, f"Under a method's name: share that is good, "
              f"{' / '.join(f'{fraction:g}' for fraction in fractions)}.", va="center",
              fontsize=8.5, color="#444444")


def main() -> int:
    report, prefix = report_and_prefix(__doc__, "stability", "cases")
    cases = report["cases"]
    names = [row["case"] for row in report["catalogue"]]
    methods = list(dict.fromkeys(row["method"] for row in cases))
    devices = list(dict.fromkeys(row["device"] for row in cases))
    fractions = sorted({row["fraction"] for row in cases})
    width = len(methods) * 0.82 + 3.4
    figure, axes = plt.subplots(figsize=(width, 0.31 * len(names) + 2.6))
    figure.subplots_adjust(left=2.5 / width, right=1 - 0.9 / width, top=0.99, bottom=0.01)
    axes.set_axis_off()
    axes.set_xlim(0, len(methods))
    axes.set_ylim(len(names) + 2.2, -5.2)
    draw_heads(axes, report, methods, fractions)
    by_cell: dict[tuple[str, str], list[dict]] = {}
    for row in cases:
        by_cell.setdefault((row["case"], row["method"]), []).append(row)
    for y, name in enumerate(names):
        axes.text(-0.08, y + 0.5, name, ha="right", va="center", fontsize=8.5)
        for x, method in enumerate(methods):
            rows = by_cell.get((name, method), [])
            draw_cell(axes, x, y, rows, devices, fractions)
            if not rows:
                axes.text(x + 0.5, y + 0.5, "–", ha="center", va="center", color="#aaaaaa")
    draw_key(axes, len(names) + 0.35, devices, fractions)
    figure.text(0.008, 0.985, "Where methods fail", fontsize=15, fontweight="bold", va="top")
    save(figure, prefix)
    return 0


if __name__ == "__main__":
    sys.exit(main())
