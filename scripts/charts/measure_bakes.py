#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Bakes the meshes of the README's table with spm-bake and verifies each asset, and prints one JSON
object. SPM_BIN names the folder of the built programs, SPM_SHARED that of the shared meshes."""

import argparse
import json
import os
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[2]
BAKE = Path(os.environ.get("SPM_BIN", SOURCE / "build/release/bin")) / "spm-bake"
MESHES = Path(os.environ.get("SPM_SHARED", SOURCE / "../shared")) / "meshes"
DIAGONAL, MAX_DEPTH, MARGIN = "100mm", "2mm", "0.5mm"
TOLERANCES = {"duck": 100, "spot": 100, "fandisk": 20, "rocker-arm": 100, "teeth": 50,
              "stanford-bunny": 100, "galleon": 100}  # um
QUICK = {"duck": 400}
# Which of the pictures of `verify --png` are kept.
PICTURED = {"teeth": ("surface",), "galleon": ("structure",),
            "stanford-bunny": ("structure", "direction", "error-worst")}
ROUGH_TRIANGLES, ROUGH_TOLERANCE = 1_000_000, 100


def run(*command, program: Path = BAKE) -> dict:
    done = subprocess.run([program, *map(str, command), "--json"], capture_output=True, text=True,
                          check=False)
    missed = command[0] == "verify" and done.returncode == 10  # its report says so
    if done.returncode != 0 and not missed:
        sys.exit(f"spm-bake {command[0]} {Path(command[1]).name} ended with {done.returncode}: "
                 f"{done.stderr.strip()}")
    return json.loads(done.stdout)


def bake(mesh: Path, asset: str, tolerance: int, *fit: str, program: Path = BAKE) -> dict:
    """What `build` reports, and in `measured` the seconds and processor seconds that it took."""
    before, begun = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
    report = run("build", mesh, "-o", asset, "--tolerance", f"{tolerance}um", "--max-depth", MAX_DEPTH,
                 "--margin", MARGIN, *fit, program=program)
    seconds, after = time.monotonic() - begun, resource.getrusage(resource.RUSAGE_CHILDREN)
    return {**report, "measured": (seconds, after.ru_utime + after.ru_stime - before.ru_utime -
                                   before.ru_stime)}


def rough_mesh(folder: str) -> Path:
    """A ball of many triangles."""
    rough = Path(folder) / "rough.obj"
    subprocess.run([sys.executable, SOURCE / "models/rough.py", rough, "--triangles",
                    str(ROUGH_TRIANGLES)], check=True, stdout=sys.stderr)
    return rough


def measure(name: str, mesh: Path, tolerance: int, samples: int, folder: str, *fit: str) -> dict:
    """One row: what `build` and `verify` report, and the processor time of the bake; `verify` draws
    into a folder named like the mesh."""
    print(f"{name} at {tolerance} um", file=sys.stderr, flush=True)
    asset = os.path.join(folder, name + ".spm.exr")
    report = bake(mesh, asset, tolerance, *fit)
    seconds, processor_seconds = report["measured"]
    row = {"mesh": name, "tolerance_um": tolerance, "triangles": report["mesh"]["triangles"],
           "vertices": report["mesh"]["vertices"], "bytes": report["bytes"], "bake_seconds": seconds,
           "bake_processor_seconds": processor_seconds, "bake_peak_rss_bytes": report["peak_rss_bytes"]}
    if samples:
        pictures = ("--png", os.path.join(folder, name)) if name in PICTURED else ()
        row["verify"] = run("verify", asset, mesh, "--samples", samples, *pictures)
    return row


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="one mesh, coarse, few samples")
    parser.add_argument("--pictures", type=Path, metavar="DIR",
                        help="keeps some pictures of three meshes there, as MESH-PICTURE.png")
    arguments = parser.parse_args()
    samples = 20_000 if arguments.quick else 1_000_000
    with tempfile.TemporaryDirectory(prefix="spm-bakes-") as folder:
        rows = [measure(name, MESHES / (name + ".obj"), tolerance, samples, folder,
                        "--fit-diagonal", DIAGONAL)
                for name, tolerance in (QUICK if arguments.quick else TOLERANCES).items()]
        if not arguments.quick:
            rows.append(measure("rough", rough_mesh(folder), ROUGH_TOLERANCE, 0, folder))
        for name, pictures in PICTURED.items() if arguments.pictures else ():
            for picture in pictures:
                if (drawn := Path(folder) / name / f"{picture}.png").exists():
                    shutil.copy(drawn, arguments.pictures / f"{name}-{picture}.png")
    print(json.dumps({"rows": rows}))
    return 0


if __name__ == "__main__":
    sys.exit(main())
