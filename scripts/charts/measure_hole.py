#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Forces along a straight path through a place where baked files once had no answer: bakes a chain of
capsules about as thick as the band is deep, as tests/baker/commands/served_answers_test.cpp does, and
replays the path with `spm-servo replay`. Prints the report tests/bench/charts/hole.json with what the
programs of SPM_BIN served as `after`, beside the exact mesh's penalty. What was served before is kept.

With --before COMMIT it is `before` that is written anew: then SPM_BIN names the programs built from
that commit, and the path is the same. It was laid through a hole of the files of the commit before
5df7837. scripts/measure runs this program for `after`.

Needs numpy, Debian package python3-numpy: run it with /usr/bin/python3.
"""

import argparse
import csv
import json
import math
import os
import subprocess
import sys
import tempfile
from pathlib import Path

sys.dont_write_bytecode = True
SOURCE = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(SOURCE / "scripts"))

import made_meshes  # noqa: E402
import numpy as np  # noqa: E402

BIN = Path(os.environ.get("SPM_BIN", SOURCE / "build/release/bin")).resolve()
REPORT = SOURCE / "tests/bench/charts/hole.json"
BUILD = ("--tolerance", "100um", "--fit-diagonal", "100mm")
REPLAY = ("--method", "spm", "--stiffness", "1N/mm")
STIFFNESS = 1.0  # N/mm
# mm, in the asset's frame: along the second limb, 1.17 mm deep, at 10 mm/s
FROM, TO = (18.0962, 8.1088, -3.3485), (15.5868, 9.5482, -2.5545)
TICKS = 301


def capsule_chain() -> made_meshes.Mesh:
    """The test's mesh, m: limbs end to end, each a ball whose half is moved along."""
    parts, start, limbs = [], (-0.03, -0.03, -0.025), 3
    for i in range(limbs):
        end = (0.035 * math.cos(2.1 * i), 0.035 * math.sin(2.1 * i), -0.025 + 0.05 * (i + 1) / limbs)
        radius = 1.2e-3 + 0.8e-3 * i / (limbs - 1)
        vertices, triangles = made_meshes.ball(1)
        along = made_meshes.added(end, start, -1)
        parts.append(([made_meshes.added(end if made_meshes.dot(v, along) > 0 else start, v, radius)
                       for v in vertices], triangles))
        start = end
    return made_meshes.joined(parts)


def corners(mesh: made_meshes.Mesh) -> np.ndarray:
    """Of the triangles, mm, as --fit-diagonal scales them."""
    vertices = np.array(mesh[0])
    diagonal = np.linalg.norm(vertices.max(axis=0) - vertices.min(axis=0))
    return (vertices * 100 / diagonal)[np.array(mesh[1])]


def closest_distance(place: np.ndarray, triangles: np.ndarray) -> float:
    """To the nearest triangle: within its three sides from its plane, else from its sides."""
    a = triangles
    sides = np.roll(a, -1, axis=1) - a
    offsets = place - a
    share = np.einsum("tki,tki->tk", offsets, sides) / np.einsum("tki,tki->tk", sides, sides)
    nearest = a + np.clip(share, 0, 1)[..., None] * sides
    distance = np.linalg.norm(place - nearest, axis=2).min(axis=1)
    normals = np.cross(sides[:, 0], sides[:, 1])
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    within = (np.einsum("tki,ti->tk", np.cross(sides, offsets), normals) >= 0).all(axis=1)
    height = np.abs(np.einsum("ti,ti->t", offsets[:, 0], normals))
    return float(np.where(within, height, distance).min())


def is_inside(place: np.ndarray, triangles: np.ndarray) -> bool:
    """By the sum of the solid angles (van Oosterom and Strackee 1983)."""
    a, b, c = np.moveaxis(triangles - place, 1, 0)
    la, lb, lc = (np.linalg.norm(v, axis=1) for v in (a, b, c))
    volume = np.einsum("ti,ti->t", a, np.cross(b, c))
    below = (la * lb * lc + np.einsum("ti,ti->t", a, b) * lc + np.einsum("ti,ti->t", b, c) * la +
             np.einsum("ti,ti->t", c, a) * lb)
    return bool(np.arctan2(volume, below).sum() > math.pi)


def exact_penalty(path: np.ndarray, mesh: made_meshes.Mesh) -> list[float]:
    """N, away from where limbs meet: there triangles inside of the other limb would count."""
    triangles = corners(mesh)
    return [STIFFNESS * closest_distance(place, triangles) if is_inside(place, triangles) else 0.0
            for place in path]


def run(*command) -> None:
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, check=False)
    # 10: the file is written, and its bake says that it does not keep its promise.
    if done.returncode not in (0, 10):
        sys.exit(f"{command[0]} {command[1]} ended with {done.returncode}: {done.stderr.strip()}")


def served_forces(path: np.ndarray, mesh: made_meshes.Mesh, folder: Path) -> list[float]:
    """N, tick by tick, by the programs of SPM_BIN."""
    (folder / "chain.obj").write_text(made_meshes.to_obj(mesh), encoding="ascii")
    (folder / "path.txt").write_text("".join("{:.9g} {:.9g} {:.9g}\n".format(*place)
                                             for place in path * 1e-3), encoding="ascii")
    asset, trace = folder / "chain.spm.exr", folder / "trace.csv"
    run(BIN / "spm-bake", "build", folder / "chain.obj", "-o", asset, *BUILD)
    run(BIN / "spm-servo", "replay", folder / "path.txt", "--asset", asset, "--out", trace, *REPLAY)
    with open(trace, encoding="ascii", newline="") as file:
        return [math.hypot(*(float(row[key]) for key in ("fx", "fy", "fz")))
                for row in csv.DictReader(file)]


def rounded(values: list[float]) -> list[float]:
    return [round(value, 4) for value in values]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--before", metavar="COMMIT", help="SPM_BIN is of this commit: write `before`")
    parser.add_argument("--quick", action="store_true", help="the same, since it is small")
    arguments = parser.parse_args()
    report = json.loads(REPORT.read_text(encoding="utf-8")) if REPORT.exists() else {}
    mesh = capsule_chain()
    path = np.linspace(FROM, TO, TICKS)
    with tempfile.TemporaryDirectory(prefix="spm-hole-") as folder:
        forces = served_forces(path, mesh, Path(folder))
    commands = [" ".join(["spm-bake build chain.obj -o chain.spm.exr", *BUILD]),
                " ".join(["spm-servo replay path.txt --asset chain.spm.exr --out trace.csv", *REPLAY])]
    served = {"commands": commands, "force_n": rounded(forces)}
    report |= {"triangles": len(mesh[1]), "from_mm": FROM, "to_mm": TO,
               "exact_n": rounded(exact_penalty(path, mesh))}
    if arguments.before:
        report["before"] = {"commit": arguments.before, **served}
    else:
        report.pop("made", None)  # scripts/measure tells it anew
        report["after"] = served
    print(json.dumps(report))
    return 0


if __name__ == "__main__":
    sys.exit(main())
