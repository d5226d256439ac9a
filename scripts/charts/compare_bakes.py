#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Bakes the larger meshes of measure_bakes.py with an older spm-bake and with this one in turns, and
prints one JSON object: seconds of each stage, processor time, bytes. The older program is built from a
clone of this project at its commit. SPM_BIN names the folder of the built programs, SPM_SHARED that of
the shared meshes.

Usage: scripts/charts/compare_bakes.py --before CLONE/build/release/bin/spm-bake [--rounds N] [--quick]
"""

import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path

from measure_bakes import BAKE, DIAGONAL, MESHES, ROUGH_TOLERANCE, TOLERANCES, bake, rough_mesh

COMPARED = ("teeth", "stanford-bunny", "galleon")


def commit_of(folder: Path) -> str:
    return subprocess.run(["git", "-C", folder, "describe", "--always", "--abbrev=12", "--dirty",
                           "--exclude=*"], check=True, capture_output=True, text=True).stdout.strip()


def baked(program: Path, mesh: Path, tolerance: int, folder: str, fit: tuple) -> dict:
    report = bake(mesh, f"{folder}/baked.spm.exr", tolerance, *fit, program=program)
    seconds, processor_seconds = report["measured"]
    return {"seconds": seconds, "processor_seconds": processor_seconds, "stages": report["seconds"],
            "bytes": report["bytes"], "peak_rss_bytes": report["peak_rss_bytes"]}


def compare(name: str, mesh: Path, tolerance: int, rounds: int, programs: dict, folder: str, *fit) -> dict:
    """Of each program the bake of median length."""
    runs: dict = {which: [] for which in programs}
    for turn in range(rounds):
        for which, program in programs.items():
            print(f"{name}, {which}, {turn + 1} of {rounds}", file=sys.stderr, flush=True)
            runs[which].append(baked(program, mesh, tolerance, folder, fit))
    middle = {which: sorted(each, key=lambda run: run["seconds"])[len(each) // 2]
              for which, each in runs.items()}
    return {"mesh": name, "tolerance_um": tolerance, **middle,
            "all_seconds": {which: [run["seconds"] for run in each] for which, each in runs.items()}}


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--before", type=Path, required=True, help="the older program, in its clone")
    parser.add_argument("--rounds", type=int, default=3, help="bakes of each program (default 3)")
    parser.add_argument("--quick", action="store_true", help="one bake of each")
    arguments = parser.parse_args()
    arguments.rounds = 1 if arguments.quick else arguments.rounds
    programs = {"before": arguments.before.resolve(), "now": BAKE}
    with tempfile.TemporaryDirectory(prefix="spm-bakes-") as folder:
        rows = [compare(name, MESHES / f"{name}.obj", TOLERANCES[name], arguments.rounds, programs, folder,
                        "--fit-diagonal", DIAGONAL) for name in COMPARED]
        rows.append(compare("rough", rough_mesh(folder), ROUGH_TOLERANCE, arguments.rounds, programs, folder))
    json.dump({"before_commit": commit_of(programs["before"].parent), "rounds": arguments.rounds,
               "rows": rows}, sys.stdout, separators=(",", ":"))
    print()
    return 0


if __name__ == "__main__":
    sys.exit(main())
