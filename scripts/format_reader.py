# SPDX-License-Identifier: Apache-2.0
"""Reads a baked file of the form `sparse` by what formats/asset/FORMAT.md says alone, in plain Python:
the leaf around a place, and what its distance maps answer by eq. 1 to 5. Uses nothing of the project."""

import json
import math
import struct

MAP, SPLIT = 5, 8
WORDS = 5  # of a distance map
LARGER, EDGE, NUMBER = 1 << 31, 1 << 15, (1 << 15) - 1
OFFSET = 1 << 31


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def text_at(data, at):
    end = data.index(b"\0", at)
    return data[at:end].decode(), end + 1


class Exr:
    """Parts of an uncompressed EXR, each of one channel and one tile."""

    def __init__(self, path):
        with open(path, "rb") as file:
            self.data = file.read()
        at, self.parts, self.text = 8, {}, None
        headers = []
        while self.data[at]:
            header = {}
            while self.data[at]:
                name, at = text_at(self.data, at)
                _, at = text_at(self.data, at)
                size, = struct.unpack_from("<i", self.data, at)
                header[name] = self.data[at + 4:at + 4 + size]
                at += 4 + size
            headers.append(header)
            at += 1
        at += 1
        self.description = json.loads(headers[0]["spm"])
        for header in headers:
            name, after = text_at(header["channels"], 0)
            pixel_type, = struct.unpack_from("<i", header["channels"], after)
            start, = struct.unpack_from("<Q", self.data, at)
            self.parts[header["name"].decode()] = start, "Ief"[pixel_type]
            at += 8 * struct.unpack("<i", header["chunkCount"])[0]

    def samples(self, part):
        at, letter = self.parts[part]
        size, = struct.unpack_from("<i", self.data, at + 20)
        return struct.unpack_from(f"<{size // struct.calcsize(letter)}{letter}", self.data, at + 24)


class Reader:
    def __init__(self, path):
        exr = Exr(path)
        self.edges = 0
        self.octree, self.atlas = exr.description["octree"], exr.description["atlas"]
        self.planes = exr.description["planes"]
        self.heights, self.maps = exr.samples("heights"), exr.samples("grid_maps")
        self.roots, self.cubes = exr.samples("grid_roots"), exr.samples("grid_cubes")

    def leaf(self, place):
        """Kind and first word of the cube around a place."""
        place_in_roots = [(x - low) / self.octree["edge"]
                          for x, low in zip(place, self.octree["origin"])]
        counts = self.octree["roots"]
        if any(not 0 <= x < count for x, count in zip(place_in_roots, counts)):
            return 0, 0
        root = [int(x) for x in place_in_roots]
        word = self.roots[root[0] + counts[0] * (root[1] + counts[1] * root[2])]
        kind, at, within = word & 15, word >> 4, [x - int(x) for x in place_in_roots]
        while kind == SPLIT:
            first, word = self.cubes[at:at + 2]
            within = [2 * x for x in within]
            octant = sum(int(x) << k for k, x in enumerate(within))
            within = [x - int(x) for x in within]
            kinds = [word >> 4 * k & 15 for k in range(8)]
            kind = kinds[octant]
            # Two top bits of a kind: how many words.
            at = first + sum(k >> 2 for k in kinds[:octant])
        return kind, at

    def on_map(self, number, place, tell=None):
        """Signed distance and unit normal by eq. 1 to 5. `tell` is called with the name of each step and
        its value."""
        tell = tell or (lambda name, value: None)
        words = self.maps[WORDS * number:WORDS * (number + 1)]
        plane = self.planes[words[0] & 0xFFFF]
        spacing = self.atlas["spacing"] / 2 ** (words[0] >> 16 & 0xFF)
        packed = struct.pack("<5I", *words)
        column0, row0 = struct.unpack_from("<2h", packed, 4)
        x0, u, v, n = (plane[key] for key in ("x0", "u", "v", "n"))
        way = [a - b for a, b in zip(place, x0)]
        eta, omega, s_sp = dot(u, way), dot(v, way), -dot(n, way)
        column, row = eta / spacing - column0, omega / spacing - row0
        i, j = int(column + 0.5), int(row + 0.5)
        first = words[3] + (j - 1) * self.atlas["width"] + i - 1
        rows = [first + k * self.atlas["width"] for k in range(3)]
        window = [self.heights[start:start + 3] for start in rows]

        def weights(t):
            return (0.5 - t) ** 2 / 2, 0.75 - t * t, (0.5 + t) ** 2 / 2

        def slopes(t):
            return t - 0.5, -2 * t, t + 0.5

        def spline(across, along):
            return sum(along[k] * dot(window[k], across) for k in range(3))

        base, = struct.unpack_from("<f", packed, 16)
        below_base = spline(weights(column - i), weights(row - j))
        d_sp = base + below_base
        by_eta = spline(slopes(column - i), weights(row - j)) / spacing
        by_omega = spline(weights(column - i), slopes(row - j)) / spacing
        normal = [n[k] + by_eta * u[k] + by_omega * v[k] for k in range(3)]
        length = math.sqrt(dot(normal, normal))
        tell(f"support plane {words[0] & 0xFFFF} (Definition 1): x0", x0)
        tell("  its normal n_SP", n)
        tell("P_M (eq. 1): eta, omega, m", (eta, omega))
        tell("S_SP, m below the plane", (s_sp,))
        tell(f"distance map {number} of {len(self.maps) // WORDS}: its spacing, m, and the column and row of "
             "P_M", (spacing, column, row))
        if base:
            tell("its heights there, m below its base", (below_base,))
        tell("D_SP(P_M) (eq. 2), m below the plane", (d_sp,))
        tell("S_SP - D_SP(P_M) (eq. 3), m", (s_sp - d_sp,))
        tell("D_SP's slopes", (by_eta, by_omega))
        tell("n_S (eq. 5)", normal)
        tell("|n_S|", (length,))
        distance = (d_sp - s_sp) / length
        tell("d = -(eq. 3) / |n_S|, m", (distance,))
        if words[0] & OFFSET:
            offset, = struct.unpack("<f", struct.pack("<f", self.atlas["offset"]))
            distance += offset
            tell("the map is of the offset surface: d and its offset, m", (distance,))
        return distance, [x / length for x in normal]

    def answer(self, place, tell=None):
        """None where no distance map answers."""
        kind, at = self.leaf(place)
        if kind != MAP:
            return None
        word = self.cubes[at]
        first = self.on_map(word & NUMBER, place, tell)
        if not word >> 16 & NUMBER:
            return first
        second = self.on_map((word >> 16 & NUMBER) - 1, place, tell)
        sign = 1 if word & LARGER else -1
        cosine = dot(first[1], second[1])
        a, b = sign * first[0], sign * second[0]
        if not (word & EDGE and max(a, b) > 0 and min(a, b) > cosine * max(a, b)):
            if tell:
                tell(f"the {'larger' if word & LARGER else 'smaller'} of both, m", (sign * max(a, b),))
            return first if a > b else second
        self.edges += 1
        if tell:
            tell("both feet lie past the edge; the cosine of both n_S", (cosine,))
        square = (a * a + b * b - 2 * cosine * a * b) / (1 - cosine * cosine)
        parts = [x / ((1 - cosine * cosine) * math.sqrt(square)) for x in (a - cosine * b, b - cosine * a)]
        return sign * math.sqrt(square), [parts[0] * n + parts[1] * m for n, m in zip(first[1], second[1])]
