# SPDX-License-Identifier: Apache-2.0
"""How the charts look: one style, one colour a method, labels beside marks, a panel a mesh."""

import matplotlib

matplotlib.use("Agg")
matplotlib.rcParams.update({
    "svg.hashsalt": "spm-haptics",
    "font.family": "DejaVu Sans",
    "font.size": 9,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.titlelocation": "left",
    "axes.titlesize": 11,
    "axes.edgecolor": "#666666",
    "xtick.color": "#444444",
    "ytick.color": "#444444",
})

import matplotlib.pyplot as plt  # noqa: E402

OURS = "#b5302a"
COLOURS = {
    "spm": OURS,
    "dense-sdf": "#1f5f8b",
    "openvdb": "#2a7f78",
    "nanovdb": "#5c9a3c",
    "adaptive-sdf": "#8a5a00",
    "hp-sdf": "#b8860b",
    "embree": "#5b4a8a",
    "triangle-grid": "#444444",
    "paper": "#a03d7c",
    "proxy": "#b8730a",
    "proxy-ball": "#1f5f8b",
    "mesh-proxy": "#3f6b1f",
    "cgal-aabb": "#7a6a4f",
    "fcl": "#4f7a99",
    "bullet": "#99604f",
    "distance-field": "#1f5f8b",
    "exact-penalty": "#555555",
    "default": "#d4351c",
}
NAMES = {
    "dense-sdf": "dense SDF",
    "openvdb": "OpenVDB",
    "nanovdb": "NanoVDB",
    "adaptive-sdf": "adaptive SDF",
    "hp-sdf": "hp-adaptive SDF",
    "embree": "Embree",
    "triangle-grid": "triangle grid",
    "paper": "the paper's rule",
    "mesh-proxy": "mesh proxy",
    "cgal-aabb": "CGAL",
    "fcl": "FCL",
    "bullet": "Bullet",
    "distance-field": "distance field",
    "exact-penalty": "exact penalty",
    "default": "our default",
}
LEAST_ERROR = 0.05  # um; below it only single precision errs
BACKGROUND = {"facecolor": "white", "edgecolor": "none", "alpha": 0.75, "pad": 0.4}


def length(um: float) -> str:
    return f"{um / 1000:g} mm" if um >= 250 and um % 250 == 0 else f"{um:g}"


def label(axes, place, text, colour, offset, **style) -> None:
    """Text beside a place, on the side that the offset (points) leads to."""
    across = "left" if offset[0] > 0 else "right" if offset[0] < 0 else "center"
    up = "bottom" if offset[1] > 0 else "top" if offset[1] < 0 else "center"
    axes.annotate(text, place, xytext=offset, textcoords="offset points", ha=across, va=up,
                  color=colour, bbox=BACKGROUND, annotation_clip=False, **style)


def rows_before(report: dict, mesh: str | None = None) -> list[dict]:
    """What spm was, by its tolerances: of one mesh, or of all. A report of one's own has none."""
    rows = report["before"]["rows"] if "before" in report else []
    return sorted((row for row in rows if row["method"] == "spm" and mesh in (None, row["mesh"])),
                  key=lambda row: row["setting_um"])


def line_of_before(report: dict) -> str:
    """For a key."""
    return f"Dashed: spm as it was, {report['before']['what']}." if "before" in report else ""


def save(figure, prefix: str) -> None:
    """PREFIX.svg and PREFIX.png; the same bytes for the same figure."""
    figure.savefig(f"{prefix}.svg", dpi=150, metadata={"Date": None})
    figure.savefig(f"{prefix}.png", dpi=150, metadata={"Software": None})


def log_panel(axes, limits: dict, model: dict) -> None:
    """A panel of a mesh over two logarithmic scales."""
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlim(*limits["x"])
    axes.set_ylim(*limits["y"])
    axes.grid(True, which="major", color="#e4e4e4", linewidth=0.6)
    axes.set_axisbelow(True)
    axes.set_title(f"{model['mesh']}  ", fontweight="bold")
    axes.set_title(f"{model['triangles']:,} triangles", loc="right", fontsize=8.5, color="#666666")


def mesh_panels(models: list[dict], max_columns: int, size: tuple[float, float], title: str,
                labels: tuple[str, str]):
    """A figure with a panel a mesh, the panels, and one more for the key; `size` of a panel,
    `labels` across and up."""
    columns = min(max_columns, len(models) + 1)
    rows = -(-(len(models) + 1) // columns)
    figure, panels = plt.subplots(rows, columns,
                                  figsize=(size[0] * columns, size[1] * rows + 0.5),
                                  squeeze=False, constrained_layout=True)
    places = panels.flatten()
    for row in panels:
        row[0].set_ylabel(labels[1])
    for axes in places[max(0, len(models) - columns):len(models)]:
        axes.set_xlabel(labels[0])
    for axes in places[len(models):]:
        axes.set_axis_off()
    figure.suptitle(title, x=0.008, ha="left", fontsize=15, fontweight="bold")
    return figure, places[:len(models)], places[len(models)]
