# SPDX-License-Identifier: Apache-2.0
"""How the charts of spm-bench look: one style, one colour a method, labels beside marks; and the
command line that the scripts share which draw one report."""

import argparse
import json
import sys

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

OURS = "#b5302a"
COLOURS = {
    "spm": OURS,
    "dense-sdf": "#1f5f8b",
    "openvdb": "#2a7f78",
    "adaptive-sdf": "#8a5a00",
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
    "adaptive-sdf": "adaptive SDF",
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


def save(figure, prefix: str) -> None:
    """PREFIX.svg and PREFIX.png; the same bytes for the same figure."""
    figure.savefig(f"{prefix}.svg", dpi=150, metadata={"Date": None})
    figure.savefig(f"{prefix}.png", dpi=150, metadata={"Software": None})


def report_and_prefix(description: str, mode: str, key: str = "rows") -> tuple[dict, str]:
    """What `spm-bench MODE --json` printed, and where charts go, from a command line; ends the
    program where that is no such report."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("report", help=f"JSON that spm-bench {mode} printed")
    parser.add_argument("-o", dest="prefix", required=True, help="writes PREFIX.svg and PREFIX.png")
    arguments = parser.parse_args()
    with open(arguments.report, encoding="utf-8") as file:
        report = json.load(file)
    if not report.get(key):
        sys.exit(f"{arguments.report}: no {key}; give what spm-bench {mode} --json printed")
    return report, arguments.prefix
