# SPDX-License-Identifier: Apache-2.0
"""Meshes by seed that are hard to bake, for scripts/prove_served: closed, oriented outwards, about
100 mm from corner to corner, 5,000 to 20,000 triangles. Each part is closed for itself; parts may
overlap. The same number and seed give the same mesh. Lengths in millimetres."""

import math
import random

Mesh = tuple[list[tuple[float, float, float]], list[tuple[int, int, int]]]


def joined(parts):
    vertices, triangles = [], []
    for part_vertices, part_triangles in parts:
        first = len(vertices)
        vertices += part_vertices
        triangles += [(a + first, b + first, c + first) for a, b, c in part_triangles]
    return vertices, triangles


def added(a, b, times=1.0):
    return tuple(x + times * y for x, y in zip(a, b))


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def unit(a):
    return tuple(x / math.sqrt(dot(a, a)) for x in a)


def loops(rings, closed, place=lambda ring, k: ring[k]):
    """The surface through rings of as many points each, which run anticlockwise seen from the last
    ring; closed: the last ring joins the first, else both ends are fanned to their middles."""
    count = len(rings[0])
    vertices = [place(ring, k) for ring in rings for k in range(count)]
    triangles = []
    for i in range(len(rings) if closed else len(rings) - 1):
        low, high = i * count, (i + 1) % len(rings) * count
        for k in range(count):
            after = (k + 1) % count
            triangles += [(low + k, low + after, high + after), (low + k, high + after, high + k)]
    if not closed:
        for ring, turned in ((0, True), (len(rings) - 1, False)):
            points = vertices[ring * count:(ring + 1) * count]
            middle = tuple(sum(axis) / count for axis in zip(*points))
            vertices.append(middle)
            for k in range(count):
                a, b = ring * count + k, ring * count + (k + 1) % count
                triangles.append((b, a, len(vertices) - 1) if turned else (a, b, len(vertices) - 1))
    return vertices, triangles


def tube(path, radius, count, closed):
    """Rings about a path, whose frame is carried along it without turning about it. A closed path's
    frame may be turned where it ends; the rings there are joined all the same."""
    rings = []
    side = None
    for i, point in enumerate(path):
        before = path[i - 1] if closed or i > 0 else point
        after = path[(i + 1) % len(path)] if closed or i + 1 < len(path) else point
        along = unit(added(after, before, -1))
        if side is None:
            side = cross(along, (0.3, 0.5, 0.8))
        side = unit(added(side, along, -dot(side, along)))
        up = cross(along, side)
        r = radius(i / len(path))
        rings.append([added(added(point, side, r * math.cos(a)), up, r * math.sin(a))
                      for a in (2 * math.pi * k / count for k in range(count))])
    if closed:  # joined where the two frames agree best
        last = rings[-1]
        turn = min(range(count), key=lambda k: dot(*[added(last[0], rings[0][k], -1)] * 2))
        parts = [[ring[(k + round(turn * (1 - i / len(rings)))) % count] for k in range(count)]
                 for i, ring in enumerate(rings)]
        return loops(parts, True)
    return loops(rings, False)


def ball(levels):
    """An icosahedron whose sides were halved this often, with all corners on the unit sphere."""
    g = (1 + math.sqrt(5)) / 2
    vertices = [unit(v) for v in ((-1, g, 0), (1, g, 0), (-1, -g, 0), (1, -g, 0), (0, -1, g), (0, 1, g),
                                  (0, -1, -g), (0, 1, -g), (g, 0, -1), (g, 0, 1), (-g, 0, -1), (-g, 0, 1))]
    triangles = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4),
                 (11, 10, 2), (10, 7, 6), (7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8),
                 (3, 8, 9), (4, 9, 5), (2, 4, 11), (6, 2, 10), (8, 6, 7), (9, 8, 1)]
    for _ in range(levels):
        middles: dict = {}

        def middle(a, b, middles=middles):
            key = (min(a, b), max(a, b))
            if key not in middles:
                middles[key] = len(vertices)
                vertices.append(unit(added(vertices[a], vertices[b])))
            return middles[key]
        split = []
        for a, b, c in triangles:
            ab, bc, ca = middle(a, b), middle(b, c), middle(c, a)
            split += [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
        triangles = split
    return vertices, triangles


def chain(rng):
    """Faceted capsules about as thick as the band is deep, end to end."""
    levels = rng.choice((1, 2))
    limbs = rng.randint(16, 24) if levels == 2 else rng.randint(64, 80)
    parts, start = [], (0.0, 0.0, 0.0)
    for _ in range(limbs):
        end = tuple(rng.uniform(-28, 28) for _ in range(3))
        radius = rng.uniform(1.2, 2.0)
        vertices, triangles = ball(levels)
        along = added(end, start, -1)
        vertices = [added(end if dot(v, along) > 0 else start, v, radius) for v in vertices]
        parts.append((vertices, triangles))
        start = end
    return joined(parts)


def torus(rng):
    around, across = rng.randint(100, 140), rng.randint(40, 60)
    thick, bump, waves = rng.uniform(6, 12), rng.uniform(0.3, 1.5), rng.randint(5, 17)

    def radius(share):
        return thick + bump * math.sin(2 * math.pi * waves * share)
    path = [(32 * math.cos(a), 32 * math.sin(a), bump * math.sin(3 * a))
            for a in (2 * math.pi * i / around for i in range(around))]
    return tube(path, radius, across, True)


def twisted_box(rng):
    """A long box, its edges sharp, turned about its length."""
    per_side, levels, turn = rng.randint(12, 18), rng.randint(70, 90), rng.uniform(1.5, 6)
    wide, deep, high = rng.uniform(20, 30), rng.uniform(6, 14), 85
    outline = []
    for a, b in (((-1, -1), (1, -1)), ((1, -1), (1, 1)), ((1, 1), (-1, 1)), ((-1, 1), (-1, -1))):
        outline += [(a[0] + (b[0] - a[0]) * k / per_side, a[1] + (b[1] - a[1]) * k / per_side)
                    for k in range(per_side)]

    def ring(level, shrink=1.0):
        angle = turn * level / levels
        c, s = math.cos(angle) * shrink, math.sin(angle) * shrink
        return [(c * x * wide / 2 - s * y * deep / 2, s * x * wide / 2 + c * y * deep / 2,
                 high * level / levels) for x, y in outline]
    ends = [0.25, 0.5, 0.75]
    return loops([ring(0, e) for e in ends] + [ring(i) for i in range(levels + 1)] +
                 [ring(levels, e) for e in reversed(ends)], False)


def plate(rng):
    """A wavy sheet thinner than the band is deep."""
    columns, rows = rng.randint(70, 90), rng.randint(35, 50)
    thick, high = rng.uniform(0.25, 0.8), rng.uniform(1, 5)
    waves = [(rng.uniform(0.03, 0.15), rng.uniform(0.03, 0.15), rng.uniform(0, 6)) for _ in range(3)]
    vertices, triangles = [], []
    for lift in (thick, 0.0):
        for j in range(rows + 1):
            for i in range(columns + 1):
                x, y = 86.0 * i / columns, 46.0 * j / rows
                z = high * sum(math.sin(a * x + b * y + c) for a, b, c in waves) / 3
                vertices.append((x, y, z + lift))
    wide, below = columns + 1, (columns + 1) * (rows + 1)
    for j in range(rows):
        for i in range(columns):
            a, b = j * wide + i, (j + 1) * wide + i
            triangles += [(a, a + 1, b + 1), (a, b + 1, b)]
            triangles += [(a + below, b + 1 + below, a + 1 + below), (a + below, b + below, b + 1 + below)]
    border = ([i for i in range(columns)] + [j * wide + columns for j in range(rows)] +
              [rows * wide + i for i in range(columns, 0, -1)] + [j * wide for j in range(rows, 0, -1)])
    for a, b in zip(border, border[1:] + border[:1]):
        triangles += [(a, a + below, b + below), (a, b + below, b)]
    return vertices, triangles


def gear(rng):
    """A toothed ring, flat above and below, with sharp edges."""
    teeth, rings, levels = rng.randint(14, 30), 4, rng.randint(4, 8)
    high, hole = rng.uniform(3, 12), rng.uniform(8, 20)
    steps = 10
    outer = []
    for k in range(teeth * steps):
        part = k % steps / steps
        rise = min(max((0.5 - abs(2 * part - 1)) * 5, 0), 1)
        angle = 2 * math.pi * k / (teeth * steps)
        outer.append((30 + 5 * rise, angle))

    def ring(share, z):
        return [((hole + (r - hole) * share) * math.cos(a), (hole + (r - hole) * share) * math.sin(a), z)
                for r, a in outer]
    section = [(1, high * k / levels) for k in range(levels)]
    section += [(1 - k / rings, high) for k in range(rings)]
    section += [(0, high * (1 - k / levels)) for k in range(levels)]
    section += [(k / rings, 0) for k in range(rings)]
    return loops([ring(share, z) for share, z in section], True)


def helix(rng):
    """A wire about as thick as the band is deep, whose turns lie close together."""
    turns, steps, across = rng.uniform(3, 6), rng.randint(260, 360), rng.randint(12, 20)
    thick = rng.uniform(1.3, 2.5)
    rise = rng.uniform(2.1, 4) * thick
    path = [(26 * math.cos(a), 26 * math.sin(a), rise * a / (2 * math.pi))
            for a in (2 * math.pi * turns * i / steps for i in range(steps + 1))]
    return tube(path, lambda share: thick, across, False)


def knot(rng):
    p, q = rng.choice(((2, 3), (3, 2), (2, 5), (3, 4)))
    steps, across, thick = rng.randint(280, 400), rng.randint(14, 22), rng.uniform(1.5, 3)
    path = []
    for i in range(steps):
        a = 2 * math.pi * i / steps
        r = 24 + 9 * math.cos(q * a)
        path.append((r * math.cos(p * a), r * math.sin(p * a), 12 * math.sin(q * a)))
    return tube(path, lambda share: thick * (1 + 0.2 * math.sin(40 * math.pi * share)), across, True)


def spikes(rng):
    """A ball with thorns and rough facets."""
    vertices, triangles = ball(4)
    thorns = [unit(tuple(rng.gauss(0, 1) for _ in range(3))) for _ in range(rng.randint(12, 40))]
    sharp, high, rough = rng.uniform(30, 200), rng.uniform(6, 18), rng.uniform(0, 0.4)
    placed = []
    for v in vertices:
        rise = max(math.exp(sharp * (dot(v, t) - 1)) for t in thorns)
        placed.append(tuple(x * (22 + high * rise + rng.uniform(-rough, rough)) for x in v))
    return placed, triangles


def bars(rng):
    """Square bars that cross and overlap, none flush with another."""
    parts = []
    for _ in range(rng.randint(20, 36)):
        start = tuple(rng.uniform(-26, 26) for _ in range(3))
        end = tuple(rng.uniform(-26, 26) for _ in range(3))
        half, steps = rng.uniform(0.7, 2.2), 16
        path = [added(start, added(end, start, -1), i / steps) for i in range(steps + 1)]
        parts.append(tube(path, lambda share, half=half: half, rng.choice((4, 6, 8)), False))
    return joined(parts)


def bowl(rng):
    """A thin wall turned about an axis: two walls as far apart as the band is deep, and less."""
    around, steps = rng.randint(90, 120), rng.randint(20, 30)
    wall, deep = rng.uniform(0.3, 1.2), rng.uniform(12, 30)

    def profile(share, out):
        angle = 0.25 + 1.25 * share
        return ((33 + out) * math.sin(angle), -(deep + out) * math.cos(angle))
    section = [profile(k / steps, wall) for k in range(steps + 1)]
    section += [profile(1 - k / steps, 0) for k in range(steps + 1)]
    rings = [[(r * math.cos(a), r * math.sin(a), z)
              for a in (2 * math.pi * k / around for k in range(around))] for r, z in section]
    return loops(rings, True)


KINDS = (chain, torus, twisted_box, plate, gear, helix, knot, spikes, bars, bowl)


def outwards(mesh: Mesh) -> Mesh:
    """Turned over where the volume is negative."""
    vertices, triangles = mesh
    volume = sum(dot(vertices[a], cross(vertices[b], vertices[c])) for a, b, c in triangles)
    return mesh if volume > 0 else (vertices, [(a, c, b) for a, b, c in triangles])


def is_closed(mesh: Mesh) -> bool:
    """Whether each side is passed once in each direction."""
    sides = set()
    for a, b, c in mesh[1]:
        for side in ((a, b), (b, c), (c, a)):
            if side in sides:
                return False
            sides.add(side)
    return all((b, a) in sides for a, b in sides)


def name_of(number: int, seed: int) -> str:
    return f"{KINDS[number % len(KINDS)].__name__.replace('_', '-')}-{number}-{seed}"


def made_mesh(number: int, seed: int) -> Mesh:
    mesh = outwards(KINDS[number % len(KINDS)](random.Random(1_000_003 * seed + number)))
    assert is_closed(mesh), name_of(number, seed)
    return mesh


def to_obj(mesh: Mesh) -> str:
    lines = ["v {:.9g} {:.9g} {:.9g}".format(*v) for v in mesh[0]]
    lines += ["f {} {} {}".format(*(k + 1 for k in t)) for t in mesh[1]]
    return "\n".join(lines) + "\n"
