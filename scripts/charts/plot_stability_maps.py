#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws the stability maps of `spm-bench stability --json`: a panel a method and device, over added
damping and stiffness, the colour the longest delay that is still held well, and theory's border of each
delay as a broken line. Writes PREFIX.svg and PREFIX.png; equal input gives equal bytes.

Needs matplotlib, Debian package python3-matplotlib: run it with /usr/bin/python3.
"""

import sys

from chart_io import report_and_prefix
from chart_style import COLOURS, NAMES, save

import matplotlib.pyplot as plt
import numpy as np
from matplotlib import patheffects as path_effects
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.ticker import FixedLocator, NullLocator

# From never stable to stable at the longest delay.
SHADES = ["#f4f1ec", "#cfe0ee", "#93bfdd", "#4f93c4", "#1f5f8b", "#0d3a5c"]
LINES = ["#7a1f12", "#b5302a", "#d9622e", "#e89a2a", "#c9a227"]
CASING = [path_effects.withStroke(linewidth=3.2, foreground="white", alpha=0.9)]
STIFFNESS_TICKS = {250: "0.25", 500: "0.5", 1e3: "1", 2e3: "2", 4e3: "4", 8e3: "8", 16e3: "16",
                   32e3: "32"}


def stable_of(one: dict) -> np.ndarray:
    """[delay][damping][stiffness]"""
    shape = (len(one["delay_ticks"]), len(one["damping_n_s_m"]), len(one["stiffness_n_m"]))
    return np.array(one["stable"]).reshape(shape)


def edges(values: list[float], logarithmic: bool) -> np.ndarray:
    """Borders of the cells around values."""
    middles = np.log(values) if logarithmic else np.array(values, float)
    between = (middles[1:] + middles[:-1]) / 2
    first, last = 2 * middles[0] - between[0], 2 * middles[-1] - between[-1]
    found = np.concatenate([[first], between, [last]])
    return np.exp(found) if logarithmic else found


def draw_map(axes, one: dict, shades: ListedColormap) -> None:
    delays = one["delay_ticks"]
    # A delay counts where every shorter one is stable too.
    level = np.cumprod(stable_of(one), axis=0).sum(axis=0)
    axes.pcolormesh(edges(one["damping_n_s_m"], False), edges(one["stiffness_n_m"], True), level.T,
                    cmap=shades, norm=BoundaryNorm(np.arange(-0.5, len(delays) + 1), shades.N),
                    rasterized=True)
    theory = np.array([[np.nan if value is None else value for value in row] for row in
                       np.array(one["theory_border_n_m"], dtype=object).reshape(len(delays), -1)],
                      dtype=float)
    dampings = one["damping_n_s_m"]
    for i, (line, colour, delay) in enumerate(zip(theory, LINES, delays)):
        axes.plot(one["damping_n_s_m"], line, color=colour, linewidth=1.5, linestyle=(0, (5, 1.6)),
                  path_effects=CASING)
        at = dampings[-1] * (0.97 - 0.08 * i)
        height = np.interp(at, dampings, line)
        if np.isfinite(height):
            axes.text(at, height, f"{delay:g}", color=colour, ha="center", va="center", fontsize=9,
                      fontweight="bold", path_effects=CASING)
    axes.set_yscale("log")
    axes.set_ylim(one["stiffness_n_m"][0], one["stiffness_n_m"][-1])
    axes.set_xlim(one["damping_n_s_m"][0], one["damping_n_s_m"][-1])
    ticks = [tick for tick in STIFFNESS_TICKS
             if one["stiffness_n_m"][0] * 0.99 <= tick <= one["stiffness_n_m"][-1] * 1.01]
    axes.yaxis.set_major_locator(FixedLocator(ticks))
    axes.set_yticklabels([STIFFNESS_TICKS[tick] for tick in ticks])
    axes.yaxis.set_minor_locator(NullLocator())


def draw_key(figure, delays: list[float]) -> None:
    patches = [plt.Rectangle((0, 0), 1, 1, facecolor=SHADES[0], edgecolor="#bbbbbb")]
    words = ["measured: never held well"]
    for i, delay in enumerate(delays):
        patches.append(plt.Rectangle((0, 0), 1, 1, facecolor=SHADES[i + 1]))
        words.append(f"measured: held well up to a delay of {delay:g} ticks" if delay
                     else "measured: held well without delay only")
    for delay, colour in zip(delays, LINES):
        patches.append(plt.Line2D([0], [0], color=colour, linewidth=2, linestyle=(0, (5, 1.6))))
        words.append(f"theory: border at a delay of {delay:g} ticks")
    figure.legend(patches, words, loc="lower center", ncol=3 if len(words) > 6 else 2,
                  frameon=False, fontsize=9.5, bbox_to_anchor=(0.5, 0.02 / figure.get_figheight()))


def main() -> int:
    report, prefix = report_and_prefix(__doc__, "stability", "maps")
    maps = report["maps"]
    methods = list(dict.fromkeys(one["method"] for one in maps))
    devices = list(dict.fromkeys(one["device"] for one in maps))
    figure, panels = plt.subplots(
        len(methods), len(devices), figsize=(max(2.7 * len(devices) + 1.1, 9.5), 2.1 * len(methods) + 2.3),
        squeeze=False, sharex=True, sharey=True)
    height = figure.get_figheight()
    figure.subplots_adjust(left=1 / figure.get_figwidth(), right=0.99, top=1 - 1.05 / height,
                           bottom=1.4 / height, wspace=0.08, hspace=0.12)
    delays = maps[0]["delay_ticks"]
    shades = ListedColormap(SHADES[:len(delays) + 1])
    drawn = {(one["method"], one["device"]): one for one in maps}
    for row, method in zip(panels, methods):
        for axes, device in zip(row, devices):
            if (method, device) in drawn:
                draw_map(axes, drawn[method, device], shades)
            else:
                axes.set_axis_off()
        name = NAMES.get(method, method)
        row[0].set_ylabel(f"{name}\nstiffness, N/mm", color=COLOURS.get(method.split("+")[0], "#222222"),
                          fontweight="bold")
    for axes, device in zip(panels[0], devices):
        axes.set_title(device, fontweight="bold")
    for axes in panels[-1]:
        axes.set_xlabel("added damping, N s/m")
    draw_key(figure, delays)
    figure.suptitle("How stiff a flat wall may be", x=0.008, y=1 - 0.08 / height, ha="left",
                    va="top", fontsize=15, fontweight="bold")
    figure.text(0.008, 1 - 0.42 / height, "Theory: spectral radius of the sampled loop = 1, which "
                "knows neither the device's friction nor the damping of our default, and not the "
                "steps of encoders.", fontsize=9.5, color="#555555", va="top")
    save(figure, prefix)
    return 0


if __name__ == "__main__":
    sys.exit(main())
