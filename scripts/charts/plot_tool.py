#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws a tool with its samples, level by level, and where it touches at the most places, from what
show_tool printed. Writes PREFIX.svg and PREFIX.png; equal input gives equal bytes.

Needs matplotlib, Debian package python3-matplotlib: run it with /usr/bin/python3.
"""

import json
import sys

from chart_io import chart_parser
from chart_style import OURS, save

import matplotlib.pyplot as plt
import numpy as np

SHOWN = 4  # levels
ARROW = 0.1  # length of the largest force, in widths of the tool


def views(places: np.ndarray) -> tuple[int, int]:
    """The axes across and up of the side on which the tool is largest."""
    size = places.max(axis=0) - places.min(axis=0)
    across, up = np.argsort(-size, kind="stable")[:2]
    return int(across), int(up)


def frame(axes, places: np.ndarray) -> None:
    low, high = places.min(axis=0), places.max(axis=0)
    margin = 0.08 * (high - low).max()
    axes.set_xlim(low[0] - margin, high[0] + margin)
    axes.set_ylim(low[1] - margin, high[1] + margin)
    axes.set_aspect("equal")
    axes.set_axis_off()


def draw_level(axes, level: dict, sides: tuple[int, int], outline: np.ndarray) -> None:
    places = np.array(level["places_mm"])[:, sides]
    size = max(0.4, min(40, 9000 / len(places)))
    axes.scatter(*outline.T, s=0.3, color="#dddddd", linewidths=0, rasterized=True)
    axes.scatter(*places.T, s=size, color="#1f5f8b", linewidths=0, rasterized=True)
    apart = level["spacing_mm"]
    axes.set_title(f"{level['samples']:,} samples, {apart:{'.0f' if apart > 10 else '.2g'}} mm apart",
                   fontsize=9.5)
    frame(axes, outline)


def draw_contact(axes, contact: dict, sides: tuple[int, int], outline: np.ndarray,
                 size=0.6) -> np.ndarray:
    """`size`: of the dots. Gives the ends of the arrows."""
    axes.scatter(*outline.T, s=size, color="#aaaaaa", linewidths=0, rasterized=True)
    patches = contact["patches"]
    places = np.array([patch["place_mm"] for patch in patches])[:, sides]
    forces = np.array([patch["force_n"] for patch in patches])
    sizes = np.linalg.norm(forces, axis=1)
    width = (outline.max(axis=0) - outline.min(axis=0)).max()
    arrows = forces[:, sides] * ARROW * width / sizes.max()
    axes.scatter(*places.T, s=18 + 60 * sizes / sizes.max(), facecolors="none", edgecolors=OURS,
                 linewidths=1.4, zorder=3)
    for place, arrow in zip(places, arrows):
        axes.annotate("", place + arrow, place,
                      arrowprops={"arrowstyle": "-|>", "color": OURS, "linewidth": 1.4}, zorder=4)
    many = f"{len(patches)} places" if len(patches) > 1 else "one place"
    axes.set_title(f"touches at {many}: {contact['force_n']:.2g} N and "
                   f"{1e3 * contact['torque_n_m']:.2g} mN m", fontsize=9.5, color=OURS)
    ends = np.concatenate([places, places + arrows])
    frame(axes, np.concatenate([outline, ends]))
    return ends


def main() -> int:
    parser = chart_parser(__doc__)
    parser.add_argument("report", help="JSON that show_tool printed")
    parser.add_argument("--title", default="A tool's samples", help="name of the tool")
    arguments = parser.parse_args()
    with open(arguments.report, encoding="utf-8") as file:
        report = json.load(file)
    if not report.get("levels") or not report.get("contact", {}).get("patches"):
        sys.exit(f"{arguments.report}: no samples or no contact; give what show_tool printed of a recording "
                 "in which the tool touches")
    levels = report["levels"]
    chosen = sorted({round(i) for i in np.linspace(0, len(levels) - 1, SHOWN)})
    finest = np.array(levels[-1]["places_mm"])
    sides = views(finest)
    outline = finest[:, sides]
    # A long and thin tool needs little height.
    size = outline.max(axis=0) - outline.min(axis=0)
    height = min(8.2, 2.6 + 14 * size[1] / size[0])
    figure, panels = plt.subplots(len(chosen) // 2 + 1 + len(chosen) % 2, 2, figsize=(10.5, height),
                                  constrained_layout=True)
    places = panels.flatten()
    for axes, number in zip(places, chosen):
        draw_level(axes, levels[number], sides, outline)
    draw_contact(places[len(chosen)], report["contact"], sides, outline)
    near = places[len(chosen) + 1]
    frame(near, draw_contact(near, report["contact"], sides, outline, 7))
    near.set_title("the same, near", fontsize=9.5, color=OURS)
    for axes in places[len(chosen) + 2:]:
        axes.set_axis_off()
    figure.suptitle(arguments.title, x=0.008, ha="left", fontsize=15, fontweight="bold")
    save(figure, arguments.prefix)
    return 0


if __name__ == "__main__":
    sys.exit(main())
