#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tells a newcomer what scripts/demo did, from the JSON that the programs printed.

Usage: demo_summary.py FOLDER BIN     (BIN: folder of the programs)
"""

import json
import sys
from pathlib import Path


def kilobytes(count: float) -> str:
    return f"{count / 1e6:.1f} MB" if count >= 1e6 else f"{count / 1e3:.0f} kB"


def baked(report: dict) -> list[str]:
    mesh, spm, error = report["mesh"], report["spm"], report["error_um"]
    closed = "closed" if mesh["closed"] else f"open, {mesh['border_edges']} border edges"
    return [
        f"Baked    models/demo.obj: {mesh['triangles']} triangles, {closed}, 0.1 m across",
        f"         into {spm['tiles']} distance maps on {spm['planes']} support planes, "
        f"{kilobytes(report['bytes'])}, in {report['seconds']['total']:.1f} s",
        f"         its distances are off by {error['p99']:.0f} um or less at 99 of 100 places tried, "
        f"by {error['max']:.0f} um at worst",
        f"         (asked: {report['tolerance_um']:.0f} um; "
        f"{'met' if report['tolerance_met'] else 'not met'}, estimated from "
        f"{error['samples']} samples)",
    ]


def felt(report: dict) -> list[str]:
    realtime = report["realtime"]
    contact = 100 * report["contact_ticks"] / max(report["ticks"], 1)
    lines = [
        f"Felt     {report['ticks']} ticks at {report['rate_hz']:.0f} Hz, {report['missed']} missed; "
        f"the simulated hand touched the model in {contact:.0f} % of them",
        f"         largest force {report['force_n']['max']:.2f} N; a tick computed "
        f"{report['busy_us']['p50']:.1f} us at the median, {report['busy_us']['p99']:.1f} us at p99, "
        f"of {1e6 / report['rate_hz']:.0f} us",
        f"         scheduling {realtime['policy']}, memory "
        f"{'locked' if realtime['memory_locked'] else 'not locked'}, "
        f"{report['page_faults']} page faults in the loop",
    ]
    for off in report["force_off"]:
        if off["cause"] in {"starting", "stopping"}:
            continue
        lines.append(f"         force was zero for {off['count']} ticks: {off['cause']}")
    return lines


def main() -> int:
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    folder, programs = map(Path, sys.argv[1:])
    read = {name: json.loads((folder / f"{name}.json").read_text(encoding="utf-8"))
            for name in ("bake", "bake-full", "run")}
    lines = ["", *baked(read["bake"]), "", *felt(read["run"]), "", f"Look at  (in {folder}/)"]
    planes = read["bake-full"]["spm"]["planes"]
    for name, what in (
        ("maps/overview.png", f"the distance maps of {planes} support planes, of a `full` bake; "
                              "single ones beside it"),
        ("touch.gif", "the model touched: the path of the tool and the force, moving"),
        ("force.png", "the force and the depth along the path; force.svg is the same"),
        ("surface.ply", "the surface as the baked file knows it, for any mesh viewer"),
        ("demo.spm.exr", "the baked file, a standard EXR image; spm-bake info tells what is in it"),
        ("trace.csv", "position, force and depth of every tick"),
    ):
        if (folder / name).exists():
            lines.append(f"         {name:22} {what}")
    lines += ["", f"Programs {programs}/spm-bake, {programs}/spm-servo; for programs of yours the "
                  "libraries libspm_client and libspm_query, also from Python",
              "", f"Serve it, with your device or a simulated one:  {programs}/spm-servo run --asset "
                  f"{folder}/demo.spm.exr",
              "Touch it yourself, in a browser:  scripts/demo --view"]
    print("\n".join(lines))
    return 0


if __name__ == "__main__":
    sys.exit(main())
