#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws the forces of a slide that `spm-bench forces --traces` wrote, beside the exact penalty's: the
whole slide and a part of it. Writes PREFIX.svg and PREFIX.png; equal input gives equal bytes.

Needs matplotlib, Debian package python3-matplotlib: run it with /usr/bin/python3.
"""

import sys

from chart_io import add_report, chart_parser, read_columns, read_report
from chart_style import BACKGROUND, COLOURS, save

import matplotlib.pyplot as plt
import numpy as np

EXACT = "#8c8c8c"
# Column of the trace, colour, title, method and whether it is a ball in the report.
METHODS = [
    ("paper", COLOURS["paper"], "paper, point", ("paper", False)),
    ("spm", COLOURS["spm"], "spm, point", ("spm", False)),
    ("proxy", COLOURS["proxy"], "proxy, point", ("proxy", False)),
    ("proxy_ball", COLOURS["proxy-ball"], "proxy, ball of 0.5 mm", ("proxy", True)),
]
BINS = 500            # of the whole slide: a band from least to largest in each
WINDOW = 600          # ticks of the part
WINDOW_STEP = 50
SMOOTH = 0.05         # N: an exact step below it
LEAST_DEGREES = 0.3   # the foot of the logarithmic scale


def read_trace(path: str) -> dict[str, np.ndarray]:
    names, rows = read_columns(path)
    if "spm_x" not in names or not rows:
        sys.exit(f"{path}: no forces; give a file that spm-bench forces --traces wrote")
    trace = dict(zip(names, np.array(rows).T))
    for name in ("exact", *(method[0] for method in METHODS)):
        trace[name] = np.stack([trace.pop(f"{name}_{axis}") for axis in "xyz"], axis=1)
    return trace


def magnitude(forces: np.ndarray) -> np.ndarray:
    return np.linalg.norm(forces, axis=1)


def angle(forces: np.ndarray, exact: np.ndarray) -> np.ndarray:
    """Degrees between two forces; NaN where one is 0."""
    sine = magnitude(np.cross(forces, exact))
    cosine = np.sum(forces * exact, axis=1)
    degrees = np.degrees(np.arctan2(sine, cosine))
    degrees[(magnitude(forces) == 0) | (magnitude(exact) == 0)] = np.nan
    return np.maximum(degrees, LEAST_DEGREES)


def interesting_window(trace: dict[str, np.ndarray]) -> slice:
    """Of the stretches that slide in contact all the time, the one over which the exact force turns
    most in smooth steps: no still stretch, and none that only jumps."""
    steps = magnitude(np.diff(trace["exact"], axis=0, prepend=trace["exact"][:1]))
    smooth = np.where(steps < SMOOTH, steps, 0)
    usable = (trace["sliding"] > 0) & (trace["distance"] < 0) & (trace["fresh"] == 0)
    best, first = -1.0, 0
    for start in range(0, len(steps) - WINDOW + 1, WINDOW_STEP):
        part = slice(start, start + WINDOW)
        share = usable[part].mean()
        value = smooth[part].sum() * share ** 8
        if value > best:
            best, first = value, start
    return slice(first, min(first + WINDOW, len(steps)))


def band(time: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Least and largest of as many bins as are drawn."""
    edges = np.linspace(0, len(values), min(BINS, len(values)) + 1).astype(int)
    with np.errstate(all="ignore"):
        low = np.array([np.nanmin(values[a:b]) if np.isfinite(values[a:b]).any() else np.nan
                        for a, b in zip(edges[:-1], edges[1:])])
        high = np.array([np.nanmax(values[a:b]) if np.isfinite(values[a:b]).any() else np.nan
                         for a, b in zip(edges[:-1], edges[1:])])
    return time[edges[:-1]], low, high


def medians(time: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    edges = np.linspace(0, len(values), min(BINS // 2, len(values)) + 1).astype(int)
    parts = [values[a:b][np.isfinite(values[a:b])] for a, b in zip(edges[:-1], edges[1:])]
    return time[edges[:-1]], np.array([np.median(part) if len(part) else np.nan for part in parts])


def draw_band(axes, time, values, colour, **style) -> None:
    where, low, high = band(time, values)
    axes.fill_between(where, low, high, step="post", color=colour, linewidth=0.35, **style)


def caption(report: dict, mesh: str, key: tuple[str, bool]) -> str:
    """The figures of a method on the recorded slide."""
    for row in report["rows"]:
        same = (row["method"], row["probe_radius_m"] > 0) == key
        same = same and row.get("turn_limit_rad_per_s") is None
        if same and row["mesh"] == mesh and row["path"] == "recorded":
            share = row["relative_difference"]
            off = f"{100 * share:.1f} % of" if share < 1 else f"{share:.1f} times"
            return (f"off the exact by {off} its RMS; step beyond it "
                    f"{row['excess_step_n']['p999']:.2f} N (p99.9)")
    return ""


def exact_of(trace: dict, ball: bool, radius: float) -> np.ndarray:
    """Magnitude of the exact penalty of the same probe, at 1 N/mm."""
    return np.maximum((radius if ball else 0) - trace["distance"], 0) * 1e3


def draw_method(left, right, trace, part, method, report, mesh, top) -> None:
    column, colour, title, key = method
    time = trace["t"]
    exact, force = exact_of(trace, key[1], report["ball_radius"]), magnitude(trace[column])
    draw_band(left, time, exact, EXACT, zorder=2)
    draw_band(left, time, force, colour, alpha=0.75, zorder=3)
    right.plot(time[part], exact[part], color=EXACT, linewidth=3.2, alpha=0.75, zorder=2)
    right.plot(time[part], force[part], color=colour, linewidth=1.1, zorder=3)
    left.axvspan(time[part][0], time[part][-1], color="#f0e6c8", zorder=0, linewidth=0)
    for axes in (left, right):
        axes.set_ylim(0, top)
        axes.tick_params(labelbottom=False)
    over = int((force > top).sum())
    if over:
        largest = force.max()
        where = int(force.argmax())
        side = "left" if where < len(force) / 2 else "right"
        left.annotate(f"up to {largest:.1f} N", (time[where], top), textcoords="offset points",
                      xytext=(4 if side == "left" else -4, -1), ha=side, va="top", fontsize=8,
                      color=colour, bbox=BACKGROUND)
    left.set_title(title, color=colour, fontweight="bold")
    left.set_title(caption(report, mesh, key), loc="right", fontsize=8.5, color="#666666")
    left.set_ylabel("force, N")


def draw_directions(left, right, trace, part) -> None:
    time = trace["t"]
    for column, colour, _, _ in METHODS:
        degrees = angle(trace[column], trace["exact"])
        where, middle = medians(time, degrees)
        left.plot(where, middle, color=colour, linewidth=0.9, alpha=0.9)
        right.plot(time[part], degrees[part], color=colour, linewidth=1.0)
    for axes in (left, right):
        axes.set_yscale("log")
        axes.set_ylim(LEAST_DEGREES, 180)
        axes.set_yticks([1, 10, 100], ["1", "10", "100"])
        axes.minorticks_off()
        axes.grid(True, axis="y", color="#e4e4e4", linewidth=0.6)
        axes.set_axisbelow(True)
        axes.set_xlabel("time, s")
    left.axvspan(time[part][0], time[part][-1], color="#f0e6c8", zorder=0, linewidth=0)
    left.set_title("Direction off the exact penalty's", fontweight="bold")
    left.set_title("medians of 80 ms", loc="right", fontsize=8.5,
                   color="#666666")
    left.set_ylabel("degrees")
    for i, (_, colour, title, _) in enumerate(METHODS):
        right.text(0.01 + 0.22 * i, 1.04, title, color=colour, fontsize=8.5, fontweight="bold",
                   transform=right.transAxes)


def main() -> int:
    parser = chart_parser(__doc__)
    add_report(parser, "forces")
    parser.add_argument("trace", help="CSV of a recorded slide that it wrote")
    parser.add_argument("--mesh", required=True, help="name of the mesh in the report")
    arguments = parser.parse_args()
    report = read_report(arguments.report, "forces")
    report["ball_radius"] = max(row["probe_radius_m"] for row in report["rows"])
    trace = read_trace(arguments.trace)
    part = interesting_window(trace)

    figure, panels = plt.subplots(
        len(METHODS) + 1, 2, figsize=(13.5, 11.5), sharex="col", constrained_layout=True,
        gridspec_kw={"width_ratios": (1.35, 1), "height_ratios": [1] * len(METHODS) + [0.9]})
    exact = magnitude(trace["exact"])
    top = 1.35 * max(np.quantile(exact[exact > 0], 0.999) + 1e3 * report["ball_radius"], 0.5)
    for (left, right), method in zip(panels, METHODS):
        draw_method(left, right, trace, part, method, report, arguments.mesh, top)
    draw_directions(*panels[-1], trace, part)
    time = trace["t"]
    panels[0][0].set_xlim(time[0], time[-1])
    panels[0][1].set_xlim(time[part][0], time[part][-1])
    panels[0][1].set_title(f"{time[part][0]:.2f} to {time[part][-1]:.2f} s, every tick", loc="right",
                           fontsize=8.5, color="#666666")
    figure.suptitle(f"Forces along the recorded slide on {arguments.mesh}, 1 N/mm; grey: the exact "
                    "mesh's penalty of the same probe", x=0.008, ha="left", fontsize=13.5,
                    fontweight="bold")
    save(figure, arguments.prefix)
    return 0


if __name__ == "__main__":
    sys.exit(main())
