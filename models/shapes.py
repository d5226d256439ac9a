# SPDX-License-Identifier: Apache-2.0
"""The analytic models: shapes whose signed distance has a closed form, metres, centred on the origin.

Each has a bounding box with a diagonal of 0.1 m. The constants below are what tests compare with.
"""

import math

from mesh import Mesh

DIAGONAL = 0.1
SPHERE_RADIUS = DIAGONAL / (2 * math.sqrt(3))
CAVITY_RADIUS = 0.018
BOX_SIDES = (0.048, 0.060, 0.064)
TORUS_TUBE_RADIUS = DIAGONAL / math.sqrt(76)
TORUS_RING_RADIUS = 2 * TORUS_TUBE_RADIUS
CYLINDER_RADIUS = 0.030
CYLINDER_HEIGHT = math.sqrt(DIAGONAL**2 - 8 * CYLINDER_RADIUS**2)
WEDGE_SIDE = 0.050
WEDGE_LENGTH = 0.075
PLATE_SIDES = (0.060, math.sqrt(DIAGONAL**2 - 0.060**2 - 0.0005**2), 0.0005)
PEG_RADIUS = 0.006
PEG_LENGTH = math.sqrt(DIAGONAL**2 - 8 * PEG_RADIUS**2)
HOLE_RADIUS = 0.0063
HOLE_DEPTH = 0.030
HOLE_BLOCK_RADIUS = 0.030
HOLE_BLOCK_HEIGHT = math.sqrt(DIAGONAL**2 - 8 * HOLE_BLOCK_RADIUS**2)
COMB_TEETH = 8
COMB_TOOTH_WIDTH = 0.0045
COMB_GROOVE_WIDTH = 0.004
COMB_BASE_HEIGHT = 0.012
COMB_HEIGHT = 0.048
COMB_LENGTH = 0.060


def sphere(radius: float = SPHERE_RADIUS, frequency: int = 42) -> Mesh:
    """Icosahedron with each edge cut into `frequency`, projected on the sphere: 20 frequency^2
    triangles. At 42 no point of a facet is more than 5 um inside the sphere."""
    golden = (1 + math.sqrt(5)) / 2
    corners = [
        (-1, golden, 0), (1, golden, 0), (-1, -golden, 0), (1, -golden, 0),
        (0, -1, golden), (0, 1, golden), (0, -1, -golden), (0, 1, -golden),
        (golden, 0, -1), (golden, 0, 1), (-golden, 0, -1), (-golden, 0, 1),
    ]
    faces = [
        (0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11),
        (1, 5, 9), (5, 11, 4), (11, 10, 2), (10, 7, 6), (7, 1, 8),
        (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9),
        (4, 9, 5), (2, 4, 11), (6, 2, 10), (8, 6, 7), (9, 8, 1),
    ]
    mesh = Mesh()
    known: dict[tuple, int] = {}

    def vertex(face: tuple[int, int, int], i: int, j: int) -> int:
        # Weights by corner, so that neighbouring faces find the same vertex of their shared edge.
        weights = ((face[0], frequency - i - j), (face[1], i), (face[2], j))
        key = tuple(sorted((corner, weight) for corner, weight in weights if weight))
        if key not in known:
            point = [math.fsum(corners[corner][axis] * weight for corner, weight in key)
                     for axis in range(3)]
            length = math.hypot(*point)
            known[key] = mesh.vertex(*(radius * x / length for x in point))
        return known[key]

    for face in faces:
        for i in range(frequency):
            for j in range(frequency - i):
                a, b, c = vertex(face, i, j), vertex(face, i + 1, j), vertex(face, i, j + 1)
                mesh.triangle(a, b, c)
                if i + j < frequency - 1:
                    mesh.triangle(b, vertex(face, i + 1, j + 1), c)
    return mesh


def nested() -> Mesh:
    """A ball with a concentric spherical cavity: an outward shell and, inside it, an inward one."""
    mesh = sphere(SPHERE_RADIUS, 24)
    mesh.append(sphere(CAVITY_RADIUS, 20), flip=True)
    return mesh


def cuboid(sides: tuple[float, float, float]) -> Mesh:
    """A box of 12 triangles."""
    mesh = Mesh()
    for k in range(8):
        mesh.vertex(*((0.5 if k >> axis & 1 else -0.5) * sides[axis] for axis in range(3)))
    for a, b, c, d in ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2),
                       (1, 3, 7, 5)):
        mesh.quad(a, b, c, d)
    return mesh


def box() -> Mesh:
    return cuboid(BOX_SIDES)


def plate() -> Mesh:
    """A plate of 0.5 mm, thinner than the usual band is deep."""
    return cuboid(PLATE_SIDES)


def torus(around: int = 192, across: int = 108) -> Mesh:
    """A torus about the z axis; facets are at most 10 um inside of it."""
    mesh = Mesh()
    for i in range(around):
        phi = 2 * math.pi * i / around
        for j in range(across):
            theta = 2 * math.pi * j / across
            rho = TORUS_RING_RADIUS + TORUS_TUBE_RADIUS * math.cos(theta)
            mesh.vertex(rho * math.cos(phi), rho * math.sin(phi),
                        TORUS_TUBE_RADIUS * math.sin(theta))
    for i in range(around):
        for j in range(across):
            i2, j2 = (i + 1) % around, (j + 1) % across
            mesh.quad(i * across + j, i2 * across + j, i2 * across + j2, i * across + j2)
    return mesh


def turned(profile: list[tuple[float, float]], around: int) -> Mesh:
    """A profile of (radius, z) turned about the z axis, from the axis below to the axis above with
    the outside on its right; its first and last radius are 0."""
    mesh = Mesh()
    rings = []
    for radius, z in profile:
        angles = [2 * math.pi * i / around for i in range(around)] if radius > 0 else [0.0]
        ring = [mesh.vertex(radius * math.cos(a), radius * math.sin(a), z) for a in angles]
        rings.append(ring * around if radius == 0 else ring)
    for lower, upper in zip(rings, rings[1:]):
        for i in range(around):
            j = (i + 1) % around
            if lower[i] == lower[j]:
                mesh.triangle(lower[i], upper[j], upper[i])
            elif upper[i] == upper[j]:
                mesh.triangle(lower[i], lower[j], upper[i])
            else:
                mesh.quad(lower[i], lower[j], upper[j], upper[i])
    return mesh


def cylinder(around: int = 256) -> Mesh:
    """A cylinder about the z axis; facets are at most 3 um inside of it."""
    mesh = Mesh()
    for z in (-CYLINDER_HEIGHT / 2, CYLINDER_HEIGHT / 2):
        for i in range(around):
            phi = 2 * math.pi * i / around
            mesh.vertex(CYLINDER_RADIUS * math.cos(phi), CYLINDER_RADIUS * math.sin(phi), z)
    bottom = mesh.vertex(0, 0, -CYLINDER_HEIGHT / 2)
    top = mesh.vertex(0, 0, CYLINDER_HEIGHT / 2)
    for i in range(around):
        j = (i + 1) % around
        mesh.quad(i, j, j + around, i + around)
        mesh.triangle(bottom, j, i)
        mesh.triangle(top, i + around, j + around)
    return mesh


def peg(around: int = 96) -> Mesh:
    """A round peg about the z axis; facets are at most 4 um inside of it."""
    low, high = -PEG_LENGTH / 2, PEG_LENGTH / 2
    return turned([(0, low), (PEG_RADIUS, low), (PEG_RADIUS, high), (0, high)], around)


def hole(around: int = 96) -> Mesh:
    """A round block about the z axis with a blind hole from above, which the peg fits into with
    0.3 mm of play; facets are at most 17 um inside of the true shape's circles."""
    low, high = -HOLE_BLOCK_HEIGHT / 2, HOLE_BLOCK_HEIGHT / 2
    floor = high - HOLE_DEPTH
    return turned([(0, low), (HOLE_BLOCK_RADIUS, low), (HOLE_BLOCK_RADIUS, high),
                   (HOLE_RADIUS, high), (HOLE_RADIUS, floor), (0, floor)], around)


def wedge() -> Mesh:
    """Two planes that meet at 60 degrees in an edge along y at the top, closed to a prism."""
    height = WEDGE_SIDE * math.sqrt(3) / 2
    mesh = Mesh()
    for y in (-WEDGE_LENGTH / 2, WEDGE_LENGTH / 2):
        mesh.vertex(-WEDGE_SIDE / 2, y, -height / 2)
        mesh.vertex(WEDGE_SIDE / 2, y, -height / 2)
        mesh.vertex(0, y, height / 2)
    mesh.triangle(0, 1, 2)
    mesh.triangle(3, 5, 4)
    for a, b in ((0, 1), (1, 2), (2, 0)):
        mesh.quad(b, a, a + 3, b + 3)
    return mesh


def comb() -> Mesh:
    """Teeth in a row along x on a base, extruded along y: grooves of 4 mm that are 36 mm deep."""
    xs = [0.0]
    for k in range(2 * COMB_TEETH - 1):
        xs.append(xs[-1] + (COMB_GROOVE_WIDTH if k % 2 else COMB_TOOTH_WIDTH))
    middle = xs[-1] / 2
    mesh = Mesh()
    # Rows of vertices at the bottom, at the grooves' floor and at the teeth's tops, front and back.
    heights = (-COMB_HEIGHT / 2, COMB_BASE_HEIGHT - COMB_HEIGHT / 2, COMB_HEIGHT / 2)
    ids = [[[mesh.vertex(x - middle, y, z) for x in xs] for z in heights]
           for y in (-COMB_LENGTH / 2, COMB_LENGTH / 2)]
    front, back = ids

    def wall(k0: int, row0: int, k1: int, row1: int) -> None:
        """The strip between front and back over one segment of the outline, solid on its left."""
        a, b = front[row0][k0], front[row1][k1]
        mesh.quad(a, back[row0][k0], back[row1][k1], b)

    last = len(xs) - 1
    wall(0, 1, 0, 0)
    wall(last, 0, last, 1)
    for k in range(last):
        wall(k, 0, k + 1, 0)
        mesh.quad(front[0][k], front[0][k + 1], front[1][k + 1], front[1][k])
        mesh.quad(back[0][k + 1], back[0][k], back[1][k], back[1][k + 1])
        if k % 2:
            wall(k + 1, 1, k, 1)
        else:
            wall(k + 1, 2, k, 2)
            wall(k, 2, k, 1)
            wall(k + 1, 1, k + 1, 2)
            mesh.quad(front[1][k], front[1][k + 1], front[2][k + 1], front[2][k])
            mesh.quad(back[1][k + 1], back[1][k], back[2][k], back[2][k + 1])
    return mesh
