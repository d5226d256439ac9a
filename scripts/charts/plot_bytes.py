#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws what `spm-bench bytes --json` measured: error against bytes of memory, a panel a mesh. Writes
PREFIX.svg and PREFIX.png; equal input gives equal bytes.

Needs matplotlib, Debian package python3-matplotlib: run it with /usr/bin/python3.
"""

import sys

from chart_io import report_and_prefix
from chart_style import (COLOURS, LEAST_ERROR, NAMES, OURS, label, length, line_of_before, log_panel,
                         mesh_panels, rows_before, save)

from matplotlib.ticker import FixedLocator, NullLocator

COLUMNS = 4
# How each rival looks: its mark, and where its name stands: beside the mark of the fewest bytes
# (0) or of the most (-1), so many points away.
RIVALS = {
    "dense-sdf": ("s", -1, (6, 0)),
    "openvdb": ("D", 0, (-3, 6)),
    "nanovdb": ("d", 0, (-6, -3)),
    "adaptive-sdf": ("^", 0, (6, 3)),
    "hp-sdf": ("P", -1, (6, 0)),
}
EXACT = {
    "embree": ("o", 0, (-6, 0)),
    "triangle-grid": ("v", -1, (7, 0)),
}
NEAR = 11  # pixels of the drawing at its own size, within which one figure would hide another
BYTES_TICKS = {1e5: "100 kB", 1e6: "1 MB", 1e7: "10 MB", 1e8: "100 MB"}


def rows_of(report: dict, mesh: str, method: str) -> list[dict]:
    """Of what has several settings of one size the smallest: 8 bits a voxel, packets that are shared."""
    found = [row for row in report["rows"] if row["mesh"] == mesh and row["method"] == method]
    for small in (", 8 bits", ", shared"):
        found = [row for row in found if row["settings"].endswith(small)] or found
    return sorted(found, key=lambda row: row["bytes"])


def points(rows: list[dict]) -> tuple[list[float], list[float]]:
    return [row["bytes"] for row in rows], [row["depth_error_um"]["p99"] for row in rows]


def draw_rivals(axes, report: dict, mesh: str) -> None:
    for method, (mark, end, offset) in RIVALS.items():
        colour, name = COLOURS[method], NAMES[method]
        rows = rows_of(report, mesh, method)
        if not rows:
            continue
        x, y = points(rows)
        axes.plot(x, y, color=colour, linewidth=0.9, alpha=0.7, marker=mark, markersize=5,
                  markeredgecolor="white", markeredgewidth=0.5, zorder=3)
        label(axes, (x[end], y[end]), name, colour, offset, zorder=4)


def draw_exact(axes, report: dict, mesh: str, limits: dict) -> None:
    """Methods that keep the triangles have no error: they stand in a strip of their own."""
    axes.axhspan(limits["y"][0], limits["floor"], color="#f3f3f3", zorder=0, linewidth=0)
    level = (limits["y"][0] * limits["floor"]) ** 0.5
    for method, (mark, end, offset) in EXACT.items():
        colour, name = COLOURS[method], NAMES[method]
        rows = [row for row in rows_of(report, mesh, method)
                if row["depth_error_um"]["p99"] < LEAST_ERROR]
        if not rows:
            continue
        x, _ = points(rows)
        axes.plot(x, [level] * len(x), color=colour, linewidth=0.9, alpha=0.8, marker=mark,
                  markersize=5.5, markeredgecolor="white", markeredgewidth=0.5, zorder=6)
        axes.annotate(name, (x[end], level), xytext=offset, textcoords="offset points",
                      ha="left" if offset[0] > 0 else "right", va="center", color=colour)


def draw_ours(axes, report: dict, mesh: str, tolerance: float) -> None:
    rows = rows_of(report, mesh, "spm")
    if not rows:
        return
    x, y = points(rows)
    axes.plot(*points(rows_before(report, mesh)), color=OURS, linewidth=1.2, alpha=0.6,
              linestyle=(0, (3, 2)), zorder=4)
    axes.plot(x, y, color=OURS, linewidth=2.2, marker="o", markersize=5, markeredgecolor="white",
              markeredgewidth=0.6, zorder=5)
    label(axes, (x[0], y[0]), "spm", OURS, (-3, 7), fontsize=11, fontweight="bold", zorder=7)
    written = []
    # The table's own figure first: others make way for it.
    for row in sorted(rows, key=lambda row: abs(row["setting_um"] - tolerance)):
        table = abs(row["setting_um"] - tolerance) < 1e-6
        place = (row["bytes"], row["depth_error_um"]["p99"])
        if table:
            axes.plot(*place, marker="o", markersize=9.5, color=OURS, fillstyle="none",
                      markeredgewidth=1.2, zorder=6)
        height = axes.transData.transform(place)[1]
        if all(abs(height - other) > NEAR for other in written):
            written.append(height)
            label(axes, place, f"{row['setting_um']:g}", OURS, (-7, -3), fontsize=7, zorder=7,
                  fontweight="bold" if table else "normal")


def draw_mesh(axes, report: dict, model: dict, limits: dict) -> None:
    mesh = model["mesh"]
    log_panel(axes, limits, model)
    axes.xaxis.set_major_locator(FixedLocator(list(BYTES_TICKS)))
    axes.set_xticklabels(BYTES_TICKS.values())
    ticks = [tick for tick in (1, 3, 10, 30, 100, 300, 1000) if
             limits["floor"] <= tick <= limits["y"][1]]
    axes.yaxis.set_major_locator(FixedLocator([(limits["y"][0] * limits["floor"]) ** 0.5, *ticks]))
    axes.set_yticklabels(["none", *(f"{tick}" for tick in ticks)])
    axes.yaxis.set_minor_locator(NullLocator())
    axes.xaxis.set_minor_locator(NullLocator())
    for raw in rows_of(report, mesh, "raw-mesh"):
        axes.axvline(raw["bytes"], color="#999999", linewidth=1.0, linestyle=(0, (4, 3)), zorder=1)
        axes.annotate("raw mesh", (raw["bytes"], limits["floor"]), xytext=(2, 4),
                      textcoords="offset points", rotation=90, va="bottom", ha="left",
                      fontsize=7.5, color="#777777")
    draw_rivals(axes, report, mesh)
    draw_exact(axes, report, mesh, limits)
    draw_ours(axes, report, mesh, model["tolerance_um"])


def limits_of(report: dict) -> dict:
    """One pair of scales for all panels, with a strip below for what has no error."""
    errors = [row["depth_error_um"]["p99"] for row in report["rows"]]
    errors = [error for error in errors if error >= LEAST_ERROR]
    sizes = [row["bytes"] for row in report["rows"]]
    floor = min(errors) / 1.5
    top = max(errors) * 1.5
    return {"x": (min(sizes) / 1.6, max(sizes) * 8), "y": (floor / (top / floor) ** 0.1, top),
            "floor": floor}


def draw_key(axes, report: dict) -> None:
    machine = report["made"]["machine"]
    voxels = sorted({row["setting_um"] for row in report["rows"] if row["method"] == "openvdb"},
                    reverse=True)
    lines = [
        ("How to read it", "#222222", "bold"),
        ("Down is more exact, left is smaller.", "#444444", "normal"),
        ("", "#444444", "normal"),
        ("spm: small figures are the tolerance asked for, um;", OURS, "normal"),
        ("the ring marks the one of the project's table.", OURS, "normal"),
        (line_of_before(report), OURS, "normal"),
        ("dense SDF, OpenVDB, NanoVDB (8 bits): cells of", COLOURS["dense-sdf"], "normal"),
        (", ".join(length(v) for v in voxels) + ".", COLOURS["dense-sdf"], "normal"),
        ("adaptive SDF: the tolerances of spm, from 50 um.", COLOURS["adaptive-sdf"], "normal"),
        ("Embree, triangle grid: all triangles, so no error;", COLOURS["embree"], "normal"),
        ("they stand in the strip below.", COLOURS["embree"], "normal"),
        ("", "#444444", "normal"),
        (f"Band {report['band_m'] * 1e3:g} mm inside, {report['margin_m'] * 1e3:g} mm outside; "
         f"diagonal {report['diagonal_m'] * 1e3:g} mm;", "#666666", "normal"),
        (f"{report['meshes'][0]['samples']:,} places a mesh, uniform by area.", "#666666", "normal"),
        (f"{machine['processor']}, {machine['cores']} cores", "#666666", "normal"),
    ]
    for i, (text, colour, weight) in enumerate(lines):
        axes.text(0.0, 0.98 - 0.068 * i, text, transform=axes.transAxes, va="top", color=colour,
                  fontweight=weight, fontsize=11 if weight == "bold" else 8.5)


def main() -> int:
    report, prefix = report_and_prefix(__doc__, "bytes")
    models = report["meshes"]
    figure, panels, key = mesh_panels(models, COLUMNS, (4.3, 3.9), "Error against bytes", (
        "bytes in memory", "distance error that 99 % of the places keep, um"))
    limits = limits_of(report)
    for axes, model in zip(panels, models):
        draw_mesh(axes, report, model, limits)
    draw_key(key, report)
    save(figure, prefix)
    return 0


if __name__ == "__main__":
    sys.exit(main())
