# SPDX-License-Identifier: Apache-2.0
"""What the end-to-end tests share: running the programs, and small meshes written by hand."""

import atexit
import functools
import hashlib
import json
import math
import os
import shutil
import struct
import subprocess
import sys
import tempfile
import time
import unittest

BIN = os.environ.get("SPM_BIN", os.path.join(os.getcwd(), "bin"))
BAKE = os.path.join(BIN, "spm-bake")
SERVO = os.path.join(BIN, "spm-servo")
GENERATOR = os.path.join(os.path.dirname(os.path.abspath(__file__)), os.pardir, os.pardir, "models",
                         "generate.py")
NOBODY = 65534
THIN_BAND = ("--max-depth", "0.1mm", "--margin", "0.05mm")  # bakes soon

NUMBER = (int, float)
BUILD_KEYS = {
    "mesh": {"path": str, "triangles": int, "vertices": int, "closed": bool, "components": int,
             "border_edges": int, "diagonal_m": NUMBER, "bbox_m": dict, "sha256": str},
    "spm": {"form": str, "kind": str, "planes": int, "tiles": int, "samples": int,
            "layers_max": int, "cells": int},
    "fallback": {"cells": NUMBER, "answers": NUMBER, "bytes": NUMBER},
    "bytes": int, "content_sha256": str, "tolerance_um": NUMBER, "tolerance_met": bool,
    "error_um": {"rms": NUMBER, "p50": NUMBER, "p99": NUMBER, "p999": NUMBER, "max": NUMBER,
                 "samples": int},
    "direction_error_deg": {"p50": NUMBER, "p99": NUMBER},
    "pruned": list,
    "seconds": {"load": NUMBER, "fit": NUMBER, "cast": NUMBER, "write": NUMBER, "verify": NUMBER,
                "total": NUMBER},
    "threads": int, "peak_rss_bytes": int,
}


def digest(path):
    with open(path, "rb") as file:
        return hashlib.sha256(file.read()).hexdigest()


def generate(folder, *models):
    """Writes models of models/generate.py into a folder, as NAME.obj."""
    subprocess.run([sys.executable, GENERATOR, "--out", folder, *models], check=True,
                   capture_output=True)


def models_of(case, *models):
    """A folder with such models, which goes when a class of tests ends."""
    folder = tempfile.mkdtemp(prefix="spm-e2e-models-")
    case.addClassCleanup(shutil.rmtree, folder, ignore_errors=True)
    generate(folder, *models)
    return folder


def bake_box(case, *options):
    """Bakes the box for a class of tests: its `models` and its `asset`."""
    case.models = models_of(case, "box")
    case.asset = os.path.join(case.models, "box.spm.exr")
    result = run("build", os.path.join(case.models, "box.obj"), "-o", case.asset, *options,
                 "--quiet")
    assert result.returncode == 0, result.stderr


@functools.cache
def public_copy(program):
    """A copy that any user may run: the checkout may lie in a folder that only its owner enters."""
    folder = tempfile.mkdtemp(prefix="spm-e2e-bin-")
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    os.chmod(folder, 0o755)
    copy = shutil.copy(program, folder)
    os.chmod(copy, 0o755)
    return copy


def run(*arguments, program=BAKE, folder=None, user=None):
    """Runs a program in a pipe; gives its exit code, standard output and standard error."""
    environment = {**os.environ, "LC_ALL": "C.UTF-8"}
    if user is not None:
        program = public_copy(program)
        folder = folder or os.sep
    return subprocess.run([program, *map(str, arguments)], capture_output=True, text=True,
                          cwd=folder, user=user, env=environment, timeout=300, check=False)


class Case(unittest.TestCase):
    """A test with a folder of its own that vanishes after it."""

    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="spm-e2e-")
        os.chmod(self.folder, 0o755)
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def path(self, *names):
        return os.path.join(self.folder, *names)

    def write(self, name, content):
        path = self.path(name)
        with open(path, "wb") as file:
            file.write(content if isinstance(content, bytes) else content.encode())
        return path

    def output_folder(self, name="out"):
        path = self.path(name)
        os.makedirs(path, exist_ok=True)
        return path

    def expect_refusal(self, result, code, *names):
        """Exit code, an empty standard output, and one line of complaint that has all of `names`."""
        self.assertEqual(result.returncode, code, result.stderr)
        self.assertEqual(result.stdout, "")
        lines = result.stderr.splitlines()
        self.assertEqual(len(lines), 1, result.stderr)
        self.assertTrue(lines[0].startswith("error: "), lines[0])
        for name in names:
            self.assertIn(str(name), lines[0])

    def wait_for(self, condition, seconds=30):
        end = time.monotonic() + seconds
        while not condition():
            self.assertLess(time.monotonic(), end, "it takes too long")
            time.sleep(0.01)

    def run_json(self, *arguments, program=BAKE):
        """Runs a command that must succeed with one JSON object on its standard output."""
        result = run(*arguments, "--json", program=program)
        self.assertEqual(result.returncode, 0, result.stderr)
        lines = result.stdout.splitlines()
        self.assertEqual(len(lines), 1, result.stdout)
        return json.loads(lines[0])


def sphere(radius, rows=24, columns=48):
    """Vertices and triangles of a sphere about the origin, anticlockwise seen from outside."""
    vertices = [(0.0, 0.0, -radius)]
    for i in range(1, rows):
        polar = math.pi * i / rows
        for j in range(columns):
            turn = 2 * math.pi * j / columns
            vertices.append((radius * math.sin(polar) * math.cos(turn),
                             radius * math.sin(polar) * math.sin(turn),
                             -radius * math.cos(polar)))
    vertices.append((0.0, 0.0, radius))
    top = len(vertices) - 1

    def at(i, j):
        return 1 + (i - 1) * columns + j % columns

    triangles = []
    for j in range(columns):
        triangles.append((0, at(1, j + 1), at(1, j)))
        triangles.append((top, at(rows - 1, j), at(rows - 1, j + 1)))
        for i in range(1, rows - 1):
            triangles.append((at(i, j), at(i, j + 1), at(i + 1, j + 1)))
            triangles.append((at(i, j), at(i + 1, j + 1), at(i + 1, j)))
    return vertices, triangles


def tetrahedron(edge):
    """The corner of a cube; with a deep band nothing bakes sooner."""
    return ([(0.0, 0.0, 0.0), (edge, 0.0, 0.0), (0.0, edge, 0.0), (0.0, 0.0, edge)],
            [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)])


TETRAHEDRON = tetrahedron(0.05)


def merged(*shapes):
    """All of them as one, their vertices kept apart."""
    vertices, triangles = [], []
    for points, faces in shapes:
        triangles += [tuple(corner + len(vertices) for corner in face) for face in faces]
        vertices = vertices + points
    return vertices, triangles


def reversed_faces(shape):
    """Inside out."""
    vertices, triangles = shape
    return vertices, [(a, c, b) for a, b, c in triangles]


def obj(shape):
    vertices, triangles = shape
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in vertices]
    lines += [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in triangles]
    return "\n".join(lines) + "\n"


def off(shape):
    vertices, triangles = shape
    lines = ["OFF", f"{len(vertices)} {len(triangles)} 0"]
    lines += [f"{x!r} {y!r} {z!r}" for x, y, z in vertices]
    lines += [f"3 {a} {b} {c}" for a, b, c in triangles]
    return "\n".join(lines) + "\n"


def ply(shape, binary=False):
    vertices, triangles = shape
    header = "\n".join([
        "ply", f"format {'binary_little_endian' if binary else 'ascii'} 1.0",
        f"element vertex {len(vertices)}", "property float x", "property float y",
        "property float z", f"element face {len(triangles)}",
        "property list uchar int vertex_indices", "end_header", ""]).encode()
    if binary:
        body = b"".join(struct.pack("<3f", *v) for v in vertices)
        return header + body + b"".join(struct.pack("<B3i", 3, *t) for t in triangles)
    lines = [f"{x!r} {y!r} {z!r}" for x, y, z in vertices] + [f"3 {a} {b} {c}" for a, b, c in triangles]
    return header + ("\n".join(lines) + "\n").encode()


def stl(shape):
    vertices, triangles = shape
    body = b"".join(struct.pack("<12fH", 0, 0, 0, *vertices[a], *vertices[b], *vertices[c], 0)
                    for a, b, c in triangles)
    return b"\0" * 80 + struct.pack("<I", len(triangles)) + body


def plain_exr():
    """A valid uncompressed 2 x 2 EXR that no bake wrote."""

    def attribute(name, kind, value):
        return name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<I", len(value)) + value

    box = struct.pack("<4i", 0, 0, 1, 1)
    header = struct.pack("<II", 20000630, 2)
    header += attribute("channels", "chlist",
                        b"Y\0" + struct.pack("<iBBBBii", 2, 0, 0, 0, 0, 1, 1) + b"\0")
    header += attribute("compression", "compression", b"\0")
    header += attribute("dataWindow", "box2i", box) + attribute("displayWindow", "box2i", box)
    header += attribute("lineOrder", "lineOrder", b"\0")
    header += attribute("pixelAspectRatio", "float", struct.pack("<f", 1))
    header += attribute("screenWindowCenter", "v2f", struct.pack("<2f", 0, 0))
    header += attribute("screenWindowWidth", "float", struct.pack("<f", 1)) + b"\0"
    rows = [struct.pack("<ii2f", y, 8, 0.5, 1.0) for y in range(2)]
    start = len(header) + 16
    return header + struct.pack("<QQ", start, start + len(rows[0])) + b"".join(rows)
