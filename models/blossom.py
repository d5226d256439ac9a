# SPDX-License-Identifier: Apache-2.0
"""The demo model: a bowl of eight twisted petals on a foot, scaled like a pine cone inside and
beaded outside. Concave, closed, one part, about 20,000 triangles.

It cannot cut itself: a surface of revolution with little relief is carried along by three maps of
space onto itself (petals swell the radius, a wave lifts the rim, a twist turns by height).
"""

import math

from mesh import Mesh
from shapes import DIAGONAL

PETALS = 8
RIBS = 20
AROUND = 160
RINGS = 86

# The outline from the middle of the foot over the rim to the middle of the bowl: radius and height,
# the rim's radius being about 1; the spline runs through every point.
OUTLINE = (
    (0.00, 0.03), (0.16, 0.03), (0.30, 0.02), (0.37, 0.00), (0.43, 0.02), (0.44, 0.08),
    (0.46, 0.15), (0.59, 0.26), (0.79, 0.41), (0.94, 0.58), (1.02, 0.74), (1.02, 0.81),
    (0.95, 0.84), (0.88, 0.78), (0.80, 0.66), (0.65, 0.51), (0.46, 0.39), (0.24, 0.31),
    (0.00, 0.285),
)
RIM = 11.5 / 18  # share of the outline's knots that lies outside


def spline(t: float) -> tuple[float, float]:
    """Point of the outline, a Catmull-Rom spline, at t from 0 to 1."""
    last = len(OUTLINE) - 1
    k = min(int(t * last), last - 1)
    x = t * last - k
    # Beyond the axis the outline goes on as its mirror image, so that the poles are smooth.
    before = OUTLINE[k - 1] if k > 0 else (-OUTLINE[1][0], OUTLINE[1][1])
    after = OUTLINE[k + 2] if k + 2 <= last else (-OUTLINE[last - 1][0], OUTLINE[last - 1][1])
    weights = (
        (-x + 2 * x**2 - x**3) / 2,
        (2 - 5 * x**2 + 3 * x**3) / 2,
        (x + 4 * x**2 - 3 * x**3) / 2,
        (-(x**2) + x**3) / 2,
    )
    points = (before, OUTLINE[k], OUTLINE[k + 1], after)
    return (
        sum(w * p[0] for w, p in zip(weights, points)),
        sum(w * p[1] for w, p in zip(weights, points)),
    )


def even_parameters(count: int) -> list[float]:
    """Parameters of `count` points at equal arc length along the outline, its ends left out."""
    steps = 4000
    lengths = [0.0]
    previous = spline(0)
    for i in range(1, steps + 1):
        point = spline(i / steps)
        lengths.append(lengths[-1] + math.dist(previous, point))
        previous = point
    found, i = [], 0
    for k in range(1, count + 1):
        wanted = lengths[-1] * k / (count + 1)
        while lengths[i + 1] < wanted:
            i += 1
        found.append((i + (wanted - lengths[i]) / (lengths[i + 1] - lengths[i])) / steps)
    return found


def smooth_step(low: float, high: float, x: float) -> float:
    x = min(max((x - low) / (high - low), 0.0), 1.0)
    return x * x * (3 - 2 * x)


def relief(t: float, radius: float, height: float, angle: float) -> float:
    """Displacement along the normal: scales on two families of spirals inside, beads outside."""
    spiral = 9.0 * math.log(max(radius, 0.05))
    if t > RIM:
        fade = smooth_step(0.14, 0.34, radius) * (1 - smooth_step(0.70, 0.80, height))
        scales = math.cos(RIBS / 2 * angle + spiral) * math.cos(RIBS / 2 * angle - spiral)
        return 0.021 * fade * scales
    fade = smooth_step(0.14, 0.24, height) * (1 - smooth_step(0.70, 0.80, height))
    beads = math.cos(RIBS * angle) * math.cos(2 * math.pi * height / 0.11)
    return 0.014 * fade * beads


def place(radius: float, height: float, angle: float) -> tuple[float, float, float]:
    """The three maps of space: petals, wave, twist."""
    # A petal is a rounded arch, so that two petals meet in a crease of finite slope.
    arch = abs(math.cos(PETALS / 2 * angle))
    petal = 2 * arch * (2 - arch) - 1.4
    open_part = smooth_step(0.10, 0.85, height)
    wide = radius * (1 + 0.11 * open_part * petal)
    lifted = height + 0.07 * smooth_step(0.45, 1.0, radius) * petal
    turned = angle + 0.75 * height
    return wide * math.cos(turned), wide * math.sin(turned), lifted


def ring_size(radius: float) -> int:
    """Vertices of a ring: halved towards the axis, so that triangles keep their shape."""
    size = AROUND
    while size > 20 and 2 * math.pi * radius / size < 0.022:
        size //= 2
    return size


def make() -> Mesh:
    mesh = Mesh()
    step = 1e-4
    rings = []
    for t in even_parameters(RINGS):
        radius, height = spline(t)
        ahead, behind = spline(t + step), spline(t - step)
        along = (ahead[0] - behind[0], ahead[1] - behind[1])
        length = math.hypot(*along)
        size = ring_size(radius)
        ring = []
        for i in range(size):
            angle = 2 * math.pi * i / size
            lift = relief(t, radius, height, angle)
            r = radius + lift * along[1] / length
            z = height - lift * along[0] / length
            ring.append(mesh.vertex(*place(r, z, angle)))
        rings.append(ring)
    foot = mesh.vertex(*place(*spline(0), 0))
    middle = mesh.vertex(*place(*spline(1), 0))
    for i, vertex in enumerate(rings[0]):
        mesh.triangle(foot, rings[0][(i + 1) % len(rings[0])], vertex)
    for i, vertex in enumerate(rings[-1]):
        mesh.triangle(middle, vertex, rings[-1][(i + 1) % len(rings[-1])])
    for lower, upper in zip(rings, rings[1:]):
        join(mesh, lower, upper)
    mesh.fit(DIAGONAL)
    return mesh


def join(mesh: Mesh, lower: list[int], upper: list[int]) -> None:
    """The strip between two rings of which one has as many vertices as the other or twice as many."""
    small = min(len(lower), len(upper))
    for i in range(small):
        if len(lower) == len(upper):
            j = (i + 1) % small
            mesh.quad(lower[i], lower[j], upper[j], upper[i])
            continue
        fine, coarse, turn = (lower, upper, False) if len(lower) > small else (upper, lower, True)
        a, b, c = fine[2 * i], fine[2 * i + 1], fine[(2 * i + 2) % len(fine)]
        p, q = coarse[i], coarse[(i + 1) % small]
        for x, y, z in ((a, b, p), (b, q, p), (b, c, q)):
            mesh.triangle(*((x, z, y) if turn else (x, y, z)))
