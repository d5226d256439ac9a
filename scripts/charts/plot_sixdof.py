#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws what `spm-bench sixdof --json` measured: the time of a tick against the samples of the tool,
and how many pairs each step of culling leaves. Writes PREFIX.svg and PREFIX.png; equal input gives
equal bytes.

Needs matplotlib, Debian package python3-matplotlib: run it with /usr/bin/python3.
"""

import sys

from chart_io import report_and_prefix
from chart_style import COLOURS, NAMES, OURS, label, save

import matplotlib.pyplot as plt
from matplotlib.ticker import FixedLocator, NullLocator

TIMES = {10: "10 us", 100: "100 us", 1e3: "1 ms", 1e4: "10 ms", 1e5: "100 ms"}
# Colour, line style and words of each curve of ours.
CURVES = {
    "served-proxy": (OURS, "-", "proxy, as served"),
    "served-spm": ("#e08a3c", "-", "spm, as served"),
    "every-sample": ("#444444", "--", "every sample asked"),
}


def samples_of(row: dict) -> int:
    """0 where the mesh itself is asked."""
    return row["samples"] or 0


def draw_curve(axes, rows: list[dict], name: str) -> None:
    """Median as a line, up to p99 as a bar; beside each the median error of force."""
    colour, style, words = CURVES[name]
    rows = sorted(rows, key=samples_of)
    counts = [samples_of(row) for row in rows]
    axes.plot(counts, [row["p50_us"] for row in rows], style, color=colour, linewidth=2)
    axes.vlines(counts, [row["p50_us"] for row in rows], [row["p99_us"] for row in rows],
                color=colour, linewidth=1.2)
    axes.scatter(counts, [row["p99_us"] for row in rows], marker="_", color=colour, s=60)
    label(axes, (counts[-1], rows[-1]["p50_us"]), words, colour, (7, 7),
          fontweight="bold")
    if name != "served-spm":
        return
    for row in rows:
        error = row["force_error_percent"]
        label(axes, (samples_of(row), row["p50_us"]), f"{error['median']:.1f} %", colour, (0, -7))


def draw_times(axes, report: dict) -> None:
    axes.set_xscale("log")
    axes.set_yscale("log")
    for name in CURVES:
        rows = [row for row in report["rows"] if row["method"] == name and row.get("path", "slide") == "slide"
                and (name == "every-sample" or row["settings"].endswith("no limit"))]
        if rows:
            draw_curve(axes, rows, name)
    counts = sorted({samples_of(row) for row in report["rows"] if samples_of(row)})
    meshes = [row for row in report["rows"] if not samples_of(row)]
    slowest = max((row["p50_us"] for row in meshes), default=0)
    for row in meshes:
        colour = COLOURS[row["method"]]
        axes.axhline(row["p50_us"], color=colour, linewidth=1)
        axes.axhspan(row["p50_us"], row["p99_us"], color=colour, alpha=0.12, linewidth=0)
        label(axes, (counts[0], row["p50_us"]), f"{NAMES[row['method']]}, mesh against mesh",
              colour, (2, 3 if row["p50_us"] == slowest else -3))
    axes.set_xlim(counts[0] / 1.3, counts[-1] * 6)
    axes.set_xlabel("samples of the tool")
    axes.set_ylabel("time of a tick: line p50, bar to p99")
    axes.xaxis.set_major_locator(FixedLocator(counts))
    axes.set_xticklabels([f"{count:,}" for count in counts])
    low, high = axes.get_ylim()
    ticks = [time for time in TIMES if low <= time <= high]
    axes.yaxis.set_major_locator(FixedLocator(ticks))
    axes.set_yticklabels([TIMES[tick] for tick in ticks])
    axes.xaxis.set_minor_locator(NullLocator())
    axes.yaxis.set_minor_locator(NullLocator())
    axes.grid(True, which="major", axis="y", color="#e4e4e4", linewidth=0.6)
    axes.set_axisbelow(True)
    axes.set_title(f"{report['tool']['mesh']} sliding over {report['object']['mesh']}",
                   fontweight="bold")
    axes.set_title("percent: median error of force", loc="right", fontsize=8.5, color="#666666")


def draw_culling(axes, report: dict) -> None:
    """Pairs left to the narrow phase, of those that boxes along the axes leave."""
    rows = [row for row in report["culling"] if row["after_aabb"] > 0]
    steps = [("after_obb", "oriented boxes", "#99a4b0"), ("after_spm", "support planes", OURS),
             ("hulls_touch", "hulls that touch", "#dddddd")]
    for i, row in enumerate(rows):
        for k, (key, words, colour) in enumerate(steps):
            share = 100 * row[key] / row["after_aabb"]
            axes.barh(i + 0.27 * (k - 1), share, height=0.24, color=colour,
                      label=words if i == 0 else None)
            axes.text(share + 1, i + 0.27 * (k - 1), f"{row[key]:,}", va="center", fontsize=7,
                      color="#666666")
    axes.set_yticks(range(len(rows)))
    axes.set_yticklabels([f"{row['objects']} objects, {row['scene']}\n{row['after_aabb']:,} pairs"
                          for row in rows])
    axes.invert_yaxis()
    axes.set_xlim(0, 115)
    axes.set_xlabel("pairs left, % of what boxes along the axes leave")
    axes.legend(loc="lower right", frameon=False, fontsize=8)
    axes.set_title("Culling", fontweight="bold")


def main() -> int:
    report, prefix = report_and_prefix(__doc__, "sixdof")

    figure, (times, culling) = plt.subplots(1, 2, figsize=(15, 6.4), constrained_layout=True,
                                            gridspec_kw={"width_ratios": [3, 2]})
    draw_times(times, report)
    draw_culling(culling, report)
    figure.suptitle("Object against object", x=0.008, ha="left", fontsize=15, fontweight="bold")
    save(figure, prefix)
    return 0


if __name__ == "__main__":
    sys.exit(main())
