# SPDX-License-Identifier: Apache-2.0
"""Finds room for labels beside marks, one after the other, so that none hides another or a mark."""

from math import cos, radians, sin

# Of the font size: a little more than the font's mean.
LETTER_WIDTH = {"normal": 0.60, "bold": 0.72}
LINE_HEIGHT = 1.25
ANGLES = (0, 180, 90, 270, 35, 145, 215, 325)
DISTANCES = (3, 8, 14, 22, 32, 44)  # points beyond the mark's edge


class LabelPlaces:
    """Labels of one panel, whose limits and position in the figure are final."""

    def __init__(self, axes):
        self.axes = axes
        self.points = axes.figure.dpi / 72  # pixels a point
        self.taken = []
        self.labels = []
        box = axes.get_window_extent()
        self.panel = (box.x0, box.y0, box.x1, box.y1)

    def block(self, place, radius: float) -> None:
        """Keeps labels off a mark of so many points' radius."""
        x, y = self.axes.transData.transform(place)
        reach = radius * self.points
        self.taken.append((x - reach, y - reach, x + reach, y + reach))

    def add(self, place, text: str, colour: str, radius: float, size: float,
            weight: str = "normal") -> None:
        self.labels.append((place, text, colour, radius, size, weight))

    def draw(self, background: dict) -> None:
        # The largest first: others make way for them.
        for place, text, colour, radius, size, weight in sorted(
                self.labels, key=lambda label: (-label[4], label[0])):
            width = len(text) * size * LETTER_WIDTH[weight]
            box, shift = self._room(place, width, radius, size)
            self.taken.append(box)
            arrow = None
            if max(abs(shift[0]), abs(shift[1])) > radius + 15 + width / 2:
                arrow = {"arrowstyle": "-", "color": colour, "linewidth": 0.5, "alpha": 0.6}
            self.axes.annotate(text, place, xytext=shift, textcoords="offset points", ha="center",
                               va="center", color=colour, fontsize=size, fontweight=weight,
                               bbox=background, arrowprops=arrow, annotation_clip=False, zorder=8)

    def _room(self, place, width: float, radius: float, size: float):
        """The box, in pixels, that overlaps least of what is taken, nearest first; and where its
        middle lies from the mark, in points."""
        x, y = self.axes.transData.transform(place)
        height = size * LINE_HEIGHT
        best = None
        for distance in DISTANCES:
            for angle in ANGLES:
                along = (cos(radians(angle)), sin(radians(angle)))
                shift = (along[0] * (radius + distance + width / 2),
                         along[1] * (radius + distance + height / 2))
                middle = (x + shift[0] * self.points, y + shift[1] * self.points)
                half = (width / 2 * self.points, height / 2 * self.points)
                box = (middle[0] - half[0], middle[1] - half[1], middle[0] + half[0],
                       middle[1] + half[1])
                cost = sum(overlap(box, other) for other in self.taken) + self._outside(box)
                if best is None or cost < best[0] - 1e-6:
                    best = (cost, box, shift)
            if best[0] <= 1e-6:
                break
        return best[1], best[2]

    def _outside(self, box) -> float:
        """How much of a box lies beyond the panel, weighing more than any overlap."""
        beyond = (max(0, self.panel[0] - box[0]) + max(0, box[2] - self.panel[2]) +
                  max(0, self.panel[1] - box[1]) + max(0, box[3] - self.panel[3]))
        return 1000 * beyond


def overlap(a, b) -> float:
    """Area that two boxes share, pixels squared."""
    width = min(a[2], b[2]) - max(a[0], b[0])
    height = min(a[3], b[3]) - max(a[1], b[1])
    return width * height if width > 0 and height > 0 else 0.0
