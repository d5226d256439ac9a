#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws a trace of spm-servo (run --trace or replay --out): force and depth over time, and the path
coloured by force. Writes PREFIX.svg and PREFIX.png; equal input gives equal bytes.

Needs matplotlib, Debian package python3-matplotlib: run it with /usr/bin/python3.
"""

import sys

from chart_io import chart_parser, read_columns
from chart_style import save

import matplotlib

matplotlib.rcParams["font.size"] = 10

import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
from matplotlib.colors import ListedColormap  # noqa: E402
from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection  # noqa: E402

FORCE_COLOUR = "#b5302a"
DEPTH_COLOUR = "#1f5f8b"
NEEDED = ("t", "x", "y", "z", "fx", "fy", "fz", "depth", "contact")


def read_trace(path: str) -> dict[str, np.ndarray]:
    names, rows = read_columns(path)
    missing = [name for name in NEEDED if name not in names]
    if missing:
        sys.exit(f"{path}: line 1: no column {missing[0]}; give a trace that spm-servo wrote")
    if not rows:
        sys.exit(f"{path}: no rows; run spm-servo longer")
    return dict(zip(names, np.array(rows).T))


def read_mesh(path: str) -> np.ndarray:
    """Corners of the triangles of an OBJ without polygons, as models/generate.py writes it."""
    vertices, triangles = [], []
    with open(path, encoding="utf-8") as file:
        for line in file:
            fields = line.split()
            if fields and fields[0] == "v":
                vertices.append([float(x) for x in fields[1:4]])
            elif fields and fields[0] == "f":
                triangles.append([int(x.split("/")[0]) - 1 for x in fields[1:4]])
    return np.array(vertices)[np.array(triangles)]


def shade_contact(axes, time: np.ndarray, contact: np.ndarray) -> None:
    axes.fill_between(time, 0, 1, where=contact > 0, step="post", color="#000000", alpha=0.045,
                      linewidth=0, transform=axes.get_xaxis_transform())


def draw_series(axes, time, values, contact, colour, title, unit) -> None:
    shade_contact(axes, time, contact)
    axes.plot(time, values, color=colour, linewidth=1.0)
    axes.fill_between(time, values, color=colour, alpha=0.15, linewidth=0)
    axes.set_title(title)
    axes.set_ylabel(unit)
    axes.set_xlim(time[0], time[-1])
    top = float(values.max())
    axes.set_ylim(0, top * 1.18 if top > 0 else 1)
    if top > 0:
        where = int(values.argmax())
        right = time[where] < time[0] + 0.7 * (time[-1] - time[0])
        axes.annotate(f"largest {top:.2f} {unit}", (time[where], top), xytext=(6 if right else -6, 4),
                      textcoords="offset points", ha="left" if right else "right", color=colour)


def draw_path(axes, points, forces, mesh, figure) -> None:
    """The path in space, millimetres, over a pale picture of the model."""
    shown = points
    # Seen from where the forces point to, outside, so that the model does not hide the path.
    towards = forces.sum(axis=0) if forces.any() else np.ones(3)
    azimuth = float(np.degrees(np.arctan2(towards[1], towards[0]))) + 20
    elevation = float(np.degrees(np.arctan2(towards[2], np.hypot(towards[0], towards[1]))))
    elevation = float(np.clip(elevation, -55, 55))
    if mesh is not None:
        shown = mesh.reshape(-1, 3)
        normals = np.cross(mesh[:, 1] - mesh[:, 0], mesh[:, 2] - mesh[:, 0])
        normals /= np.linalg.norm(normals, axis=1, keepdims=True)
        a, e = np.radians(azimuth), np.radians(elevation)
        view = np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])
        facing = normals @ view > 0
        # From over the viewer's left shoulder, whichever way the path faces.
        right = np.array([-np.sin(a), np.cos(a), 0.0])
        light = view - 0.7 * right + 0.7 * np.cross(view, right)
        light /= np.linalg.norm(light)
        shade = 0.52 + 0.44 * np.clip(normals[facing] @ light, 0, 1)
        colours = np.stack([shade, shade, shade * 0.98, np.ones_like(shade)], axis=1)
        axes.add_collection3d(Poly3DCollection(mesh[facing], facecolors=colours, edgecolors=colours,
                                               linewidths=0.3, zorder=1, rasterized=True))
    axes.computed_zorder = False
    segments = np.stack([points[:-1], points[1:]], axis=1)
    # The palest end of the colours would drown on the pale model.
    ramp = ListedColormap(plt.get_cmap("inferno")(np.linspace(0, 0.82, 256)))
    path = Line3DCollection(segments, cmap=ramp, linewidths=2.2, zorder=5)
    path.set_array(np.linalg.norm(forces[1:], axis=1))
    axes.add_collection3d(path)
    low, high = shown.min(axis=0), shown.max(axis=0)
    low, high = np.minimum(low, points.min(axis=0)), np.maximum(high, points.max(axis=0))
    half, centre = (high - low).max() / 2 * 0.68, (high + low) / 2
    for set_limits, c in zip((axes.set_xlim, axes.set_ylim, axes.set_zlim), centre):
        set_limits(c - half, c + half)
    axes.set_box_aspect((1, 1, 1))
    axes.view_init(elevation, azimuth)
    axes.set_axis_off()
    axes.set_title("Path of the hand on the model")
    bar = figure.colorbar(path, ax=axes, shrink=0.5, pad=0.0, aspect=24)
    bar.set_label("force, N")
    bar.outline.set_visible(False)


def main() -> int:
    parser = chart_parser(__doc__)
    parser.add_argument("trace", help="CSV that spm-servo wrote")
    parser.add_argument("--mesh", help="OBJ of the model, to draw the path on")
    arguments = parser.parse_args()

    trace = read_trace(arguments.trace)
    mesh = read_mesh(arguments.mesh) * 1e3 if arguments.mesh else None
    forces = np.stack([trace["fx"], trace["fy"], trace["fz"]], axis=1)
    points = np.stack([trace["x"], trace["y"], trace["z"]], axis=1) * 1e3

    figure = plt.figure(figsize=(12.5, 5.6), constrained_layout=True)
    grid = figure.add_gridspec(2, 2, width_ratios=(1.25, 1))
    upper = figure.add_subplot(grid[0, 0])
    lower = figure.add_subplot(grid[1, 0], sharex=upper)
    draw_series(upper, trace["t"], np.linalg.norm(forces, axis=1), trace["contact"], FORCE_COLOUR,
                "Force on the hand (grey: in contact)", "N")
    draw_series(lower, trace["t"], trace["depth"] * 1e3, trace["contact"], DEPTH_COLOUR,
                "Depth below the surface", "mm")
    upper.tick_params(labelbottom=False)
    lower.set_xlabel("time, s")
    draw_path(figure.add_subplot(grid[:, 1], projection="3d"), points, forces, mesh, figure)

    save(figure, arguments.prefix)
    return 0


if __name__ == "__main__":
    sys.exit(main())
