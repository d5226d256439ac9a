# SPDX-License-Identifier: Apache-2.0
"""A triangle mesh in metres: writing it as OBJ, and checking that it is a closed, outward surface."""

import math
import os
import tempfile
from collections import Counter

Point = tuple[float, float, float]


class Mesh:
    """Vertices in metres and triangles as index triples, counter-clockwise seen from outside."""

    def __init__(self) -> None:
        self.vertices: list[Point] = []
        self.triangles: list[tuple[int, int, int]] = []

    def vertex(self, x: float, y: float, z: float) -> int:
        """Adds a vertex and returns its index."""
        self.vertices.append((x, y, z))
        return len(self.vertices) - 1

    def triangle(self, a: int, b: int, c: int) -> None:
        self.triangles.append((a, b, c))

    def quad(self, a: int, b: int, c: int, d: int) -> None:
        """Adds two triangles, split along the shorter diagonal, which follows relief better."""
        v = self.vertices
        if math.dist(v[a], v[c]) <= math.dist(v[b], v[d]):
            self.triangles += [(a, b, c), (a, c, d)]
        else:
            self.triangles += [(a, b, d), (b, c, d)]

    def append(self, other: "Mesh", flip: bool = False) -> None:
        """Adds the triangles of another mesh, turned inside out with `flip`."""
        base = len(self.vertices)
        self.vertices += other.vertices
        for a, b, c in other.triangles:
            a, b, c = a + base, b + base, c + base
            self.triangles.append((a, c, b) if flip else (a, b, c))

    def bounds(self) -> tuple[Point, Point]:
        axes = list(zip(*self.vertices))
        return tuple(map(min, axes)), tuple(map(max, axes))

    def diagonal(self) -> float:
        return math.dist(*self.bounds())

    def fit(self, diagonal: float) -> None:
        """Centres the bounding box on the origin and scales its diagonal to the given length."""
        low, high = self.bounds()
        scale = diagonal / math.dist(low, high)
        centre = [(a + b) / 2 for a, b in zip(low, high)]
        self.vertices = [
            tuple((x - c) * scale for x, c in zip(vertex, centre)) for vertex in self.vertices
        ]

    def volume(self) -> float:
        """Enclosed volume, m3, by the divergence theorem; negative where the mesh is inside out."""
        v = self.vertices
        return math.fsum(
            v[a][0] * (v[b][1] * v[c][2] - v[b][2] * v[c][1])
            + v[a][1] * (v[b][2] * v[c][0] - v[b][0] * v[c][2])
            + v[a][2] * (v[b][0] * v[c][1] - v[b][1] * v[c][0])
            for a, b, c in self.triangles
        ) / 6

    def write(self, path: str, comment: str) -> None:
        """Writes an OBJ with coordinates to the nanometre, through a temporary file and a rename."""
        lines = [f"# {comment}\n"]
        # No zero has a sign: that hangs on the last digit of a sine, which not every libm has alike.
        lines += [f"v {x:z.9f} {y:z.9f} {z:z.9f}\n" for x, y, z in self.vertices]
        lines += [f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in self.triangles]
        handle, temporary = tempfile.mkstemp(dir=os.path.dirname(path), suffix=".tmp")
        try:
            with os.fdopen(handle, "w", encoding="ascii", newline="\n") as file:
                file.writelines(lines)
                file.flush()
                os.fsync(file.fileno())
            os.chmod(temporary, 0o644)
            os.replace(temporary, path)
        except BaseException:
            os.unlink(temporary)
            raise


def read(path: str) -> Mesh:
    """Reads an OBJ that `Mesh.write` wrote."""
    mesh = Mesh()
    with open(path, encoding="ascii") as file:
        for line in file:
            fields = line.split()
            if fields[0] == "v":
                mesh.vertex(*map(float, fields[1:]))
            elif fields[0] == "f":
                mesh.triangle(*(int(field) - 1 for field in fields[1:]))
    return mesh


def components(mesh: Mesh) -> int:
    """Number of connected parts."""
    parent = list(range(len(mesh.vertices)))

    def root(index: int) -> int:
        while parent[index] != index:
            parent[index] = parent[parent[index]]
            index = parent[index]
        return index

    for a, b, c in mesh.triangles:
        parent[root(a)] = root(b)
        parent[root(b)] = root(c)
    return len({root(index) for index in range(len(parent))})


def faults(mesh: Mesh) -> list[str]:
    """What keeps a mesh from being a closed, outward oriented manifold; empty where nothing does."""
    found = []
    edges = Counter()
    for a, b, c in mesh.triangles:
        edges.update(((a, b), (b, c), (c, a)))
    repeated = sum(1 for count in edges.values() if count != 1)
    border = sum(1 for a, b in edges if (b, a) not in edges)
    if repeated:
        found.append(f"{repeated} directed edges belong to more than one triangle")
    if border:
        found.append(f"{border} edges have no triangle on their other side")
    if len(set(mesh.vertices)) != len(mesh.vertices):
        found.append("two vertices share a place")
    if {index for triangle in mesh.triangles for index in triangle} != set(range(len(mesh.vertices))):
        found.append("a vertex belongs to no triangle")
    flat = sum(1 for triangle in mesh.triangles if _area(mesh, triangle) < 1e-15)
    if flat:
        found.append(f"{flat} triangles have no area")
    if not mesh.volume() > 0:
        found.append("the volume is not positive, so the mesh is inside out")
    return found


def _area(mesh: Mesh, triangle: tuple[int, int, int]) -> float:
    a, b, c = (mesh.vertices[index] for index in triangle)
    p = [y - x for x, y in zip(a, b)]
    q = [y - x for x, y in zip(a, c)]
    return math.hypot(
        p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]
    ) / 2
