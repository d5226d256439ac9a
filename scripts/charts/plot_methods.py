#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws what `spm-bench methods --json` measured: error against time, a panel a mesh. Writes PREFIX.svg
and PREFIX.png; equal input gives equal bytes.

Needs matplotlib, Debian package python3-matplotlib: run it with /usr/bin/python3.
"""

import sys

from chart_io import report_and_prefix
from chart_style import (BACKGROUND, COLOURS, LEAST_ERROR, NAMES, OURS, line_of_before, log_panel,
                         mesh_panels, rows_before, save)
from label_places import LabelPlaces

from matplotlib.ticker import FixedLocator, NullLocator

COLUMNS = 2
# Methods that keep all triangles have no error: a lane each, below the chart.
LANES = ["triangle-grid", "embree", "cgal-aabb", "bullet", "fcl"]
LANE = 0.115  # of the height of a panel
TIME_TICKS = {10: "10 ns", 100: "100 ns", 1e3: "1 us", 1e4: "10 us", 1e5: "100 us", 1e6: "1 ms"}
ERROR_TICKS = {1: "1 um", 10: "10 um", 100: "100 um", 1e3: "1 mm", 1e4: "10 mm"}
SHORT = {"force shading": "shaded", "brute force": "all triangles", "btBvhTriangleMeshShape": "",
         "OBBRSS": "", "Simple_cartesian<double>": "", "tolerance ": "", "cell ": "", "voxel ": "",
         " bits": " b"}


def area(size: float) -> float:
    """Points squared: as the root of the bytes, or a field would hide all else."""
    return 22 * (size / 1e5) ** 0.5


def radius(row: dict) -> float:
    return (area(row["bytes"]) / 3.1416) ** 0.5


def short(settings: str) -> str:
    for long, brief in SHORT.items():
        settings = settings.replace(long, brief)
    return settings


def rows_of(report: dict, mesh: str) -> list[dict]:
    """All but the batch form of ours, whose mark would lie on that of the single points, and the
    form without SIMD, which nobody runs; of NanoVDB the 8 bits, since the other marks lie beside."""
    return [row for row in report["rows"] if row["mesh"] == mesh
            and row["method"] != "spm-scalar" and not row["settings"].endswith(", batch")
            and (row["method"] != "nanovdb" or row["settings"].endswith(", 8 bits"))]


def is_exact(row: dict) -> bool:
    return row["method"] in LANES and row["depth_error_um"]["p99"] < LEAST_ERROR


def level(row: dict, limits: dict) -> float:
    if not is_exact(row):
        return row["depth_error_um"]["p99"]
    low, floor = limits["y"][0], limits["floor"]
    lane = (LANES.index(row["method"]) + 0.5) / len(LANES)
    return floor * (low / floor) ** lane


def draw_row(axes, row: dict, limits: dict) -> None:
    """Hot filled, cold hollow, a thin line between: how much a query in a cold cache takes more."""
    colour = COLOURS[row["method"]]
    y = level(row, limits)
    hot, cold = row["ns"]["hot"], row["ns"]["cold"]
    ours = row["method"] == "spm"
    axes.plot([hot, cold], [y, y], color=colour, linewidth=0.7, alpha=0.45, zorder=2)
    axes.scatter([cold], [y], s=area(row["bytes"]), facecolors="none", edgecolors=colour,
                 linewidths=0.9, alpha=0.75, zorder=3)
    axes.scatter([hot], [y], s=area(row["bytes"]), color=colour, alpha=0.95 if ours else 0.8,
                 edgecolors="white", linewidths=0.5, zorder=5 if ours else 4)


def label_rows(axes, rows: list[dict], limits: dict, tolerance: float) -> None:
    places = LabelPlaces(axes)
    for row in rows:
        y = level(row, limits)
        places.block((row["ns"]["hot"], y), radius(row))
        places.block((row["ns"]["cold"], y), min(radius(row), 6))
    named = set()
    for row in rows:
        place = (row["ns"]["hot"], level(row, limits))
        colour = COLOURS[row["method"]]
        if row["method"] == "spm":
            own = abs(row["setting_um"] - tolerance) < 1e-6
            if own:
                axes.scatter([place[0]], [place[1]], s=3.2 * area(row["bytes"]), facecolors="none",
                             edgecolors=OURS, linewidths=1.2, zorder=6)
            text = f"spm {row['setting_um']:g} um" if own else f"{row['setting_um']:g}"
            places.add(place, text, colour, radius(row), size=10 if own else 7.5,
                       weight="bold" if own else "normal")
            continue
        words = [short(row["settings"])]
        if row["method"] not in named:
            words.insert(0, NAMES[row["method"]])
        named.add(row["method"])
        places.add(place, " ".join(word for word in words if word), colour, radius(row), size=7.5)
    places.draw(BACKGROUND)


def draw_mesh(axes, report: dict, model: dict, limits: dict) -> None:
    rows = rows_of(report, model["mesh"])
    log_panel(axes, limits, model)
    axes.axhspan(limits["y"][0], limits["floor"], color="#f3f3f3", zorder=0, linewidth=0)
    times = [tick for tick in TIME_TICKS if limits["x"][0] <= tick <= limits["x"][1]]
    axes.xaxis.set_major_locator(FixedLocator(times))
    axes.set_xticklabels([TIME_TICKS[tick] for tick in times])
    errors = [tick for tick in ERROR_TICKS if limits["floor"] <= tick <= limits["y"][1]]
    axes.yaxis.set_major_locator(FixedLocator([(limits["y"][0] * limits["floor"]) ** 0.5, *errors]))
    axes.set_yticklabels(["no error", *(ERROR_TICKS[tick] for tick in errors)])
    axes.xaxis.set_minor_locator(NullLocator())
    axes.yaxis.set_minor_locator(NullLocator())
    curve = sorted((row for row in rows if row["method"] == "spm"),
                   key=lambda row: row["setting_um"])
    axes.plot([row["ns"]["hot"] for row in curve], [level(row, limits) for row in curve],
              color=OURS, linewidth=2.2, zorder=4)
    earlier = rows_before(report, model["mesh"])
    axes.plot([row["ns"]["hot"] for row in earlier], [level(row, limits) for row in earlier],
              color=OURS, linewidth=1.2, alpha=0.6, linestyle=(0, (3, 2)), zorder=4)
    # Large marks first, so that small ones are seen.
    for row in sorted(rows, key=lambda row: -row["bytes"]):
        draw_row(axes, row, limits)


def limits_of(report: dict) -> dict:
    """One pair of scales for all panels, with a strip of lanes below for what has no error."""
    errors = [row["depth_error_um"]["p99"] for row in report["rows"] + rows_before(report)
              if not is_exact(row)]
    times = [time for row in report["rows"] for time in row["ns"].values()]
    floor, top = min(errors) / 1.6, max(errors) * 1.8
    share = LANE * len(LANES) / 2
    return {"x": (min(times) / 2.2, max(times) * 2.5), "floor": floor,
            "y": (floor / (top / floor) ** (share / (1 - share)), top)}


def draw_key(axes, report: dict) -> None:
    axes.set_xlim(0, 1)
    axes.set_ylim(0, 1)
    machine = report["made"]["machine"]
    model = report["meshes"][0]
    lines = [
        ("How to read it", "#222222", "bold"),
        ("Down is more exact, left is faster.", "#444444", "normal"),
        ("Filled: a path in steps of 0.1 mm, all in the caches (hot).", "#444444", "normal"),
        ("Hollow: the caches emptied before the query (cold).", "#444444", "normal"),
        ("spm: the curve of its tolerances, um; the ring marks the mesh's own.", OURS, "normal"),
        (line_of_before(report), OURS, "normal"),
        ("Grey lanes: methods that keep all triangles have no error.", "#444444", "normal"),
        ("mesh proxy: errors along the path, since it remembers;", COLOURS["mesh-proxy"], "normal"),
        ("all other errors at places uniform by area.", "#444444", "normal"),
        (f"Band {report['band_m'] * 1e3:g} mm inside, {report['margin_m'] * 1e3:g} mm outside; "
         f"diagonal {report['diagonal_m'] * 1e3:g} mm; {model['samples']:,} places a mesh.",
         "#666666", "normal"),
        (f"One pinned core of: {machine['processor']}", "#666666", "normal"),
    ]
    for i, (text, colour, weight) in enumerate(lines):
        axes.text(0.0, 0.99 - 0.06 * i, text, va="top", color=colour, fontweight=weight,
                  fontsize=11 if weight == "bold" else 8.5)
    axes.text(0.0, 0.24, "Area of a mark: as the root of its bytes", va="top", color="#444444",
              fontsize=8.5)
    for i, (size, text) in enumerate([(1e5, "100 kB"), (1e6, "1 MB"), (1e7, "10 MB"),
                                      (1e8, "100 MB")]):
        axes.scatter([0.04 + 0.16 * i], [0.11], s=area(size), color="#777777")
        axes.text(0.04 + 0.16 * i, 0.01, text, ha="center", color="#666666", fontsize=8)


def main() -> int:
    report, prefix = report_and_prefix(__doc__, "methods")
    models = report["meshes"]
    figure, panels, key = mesh_panels(models, COLUMNS, (7.6, 5.4), "Error against time", (
        "time of a query", "distance error that 99 % of the places keep"))
    limits = limits_of(report)
    for axes, model in zip(panels, models):
        draw_mesh(axes, report, model, limits)
    draw_key(key, report)
    # Labels are placed in pixels: only once the panels have their final places.
    figure.canvas.draw()
    for axes, model in zip(panels, models):
        label_rows(axes, rows_of(report, model["mesh"]), limits, model["tolerance_um"])
    save(figure, prefix)
    return 0


if __name__ == "__main__":
    sys.exit(main())
