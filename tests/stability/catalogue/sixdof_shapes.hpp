// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>
#include <vector>

#include "tests/support/shapes.hpp"

namespace spm::stability {

/// A profile turned about the z axis. Its points are distances from the axis (m, 0 or more) and
/// heights (m), from the axis below to the axis above, with the outside to the right of the path;
/// `around` sides.
[[nodiscard]] inline test::Shape turned_profile(
    const std::vector<std::pair<double, double>>& places, int around) {
  test::Shape shape;
  std::vector<std::uint32_t> first;
  for (const auto& [radius, height] : places) {
    first.push_back(static_cast<std::uint32_t>(shape.vertices.size()));
    for (int i = 0; i < (radius > 0 ? around : 1); ++i) {
      const double turn = 2 * std::numbers::pi * i / around;
      shape.vertices.emplace_back(radius * std::cos(turn), radius * std::sin(turn), height);
    }
  }
  const auto vertex = [&](std::size_t ring, int i) {
    return first[ring] +
           (places[ring].first > 0 ? static_cast<std::uint32_t>(i % around) : std::uint32_t{0});
  };
  for (std::size_t ring = 0; ring + 1 < places.size(); ++ring) {
    for (int i = 0; i < around; ++i) {
      const std::uint32_t a = vertex(ring, i), b = vertex(ring, i + 1);
      const std::uint32_t c = vertex(ring + 1, i + 1), d = vertex(ring + 1, i);
      if (a != b) shape.triangles.push_back({a, b, c});
      if (c != d) shape.triangles.push_back({a, c, d});
    }
  }
  return shape;
}

/// A round block with a blind hole along z, whose mouth is at z = 0.
[[nodiscard]] inline test::Shape block_with_hole(double hole_radius, double hole_depth,
                                                 double radius, double height, int around) {
  return turned_profile({{0, -height},
                         {radius, -height},
                         {radius, 0},
                         {hole_radius, 0},
                         {hole_radius, -hole_depth},
                         {0, -hole_depth}},
                        around);
}

/// A square plate `size` wide whose upper side, about z = 0, has bumps: `height` times the sine of
/// x times the sine of y, `bumps` waves each way, made of `cells` squares along each side. Its
/// lower side is flat.
[[nodiscard]] inline test::Shape bumpy_plate(double size, double thickness, double height,
                                             int bumps, int cells) {
  test::Shape shape;
  const auto place = [&](int i) { return size * (static_cast<double>(i) / cells - 0.5); };
  const auto wave = [&](int i) { return std::sin(2 * std::numbers::pi * bumps * i / cells); };
  for (const bool upper : {true, false}) {
    for (int j = 0; j <= cells; ++j) {
      for (int i = 0; i <= cells; ++i) {
        shape.vertices.emplace_back(place(i), place(j),
                                    upper ? height * wave(i) * wave(j) : -thickness);
      }
    }
  }
  const auto at = [cells](int i, int j, bool upper) {
    return static_cast<std::uint32_t>((upper ? 0 : (cells + 1) * (cells + 1)) + j * (cells + 1) +
                                      i);
  };
  const auto quad = [&shape](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    shape.triangles.push_back({a, b, c});
    shape.triangles.push_back({a, c, d});
  };
  for (int j = 0; j < cells; ++j) {
    for (int i = 0; i < cells; ++i) {
      quad(at(i, j, true), at(i + 1, j, true), at(i + 1, j + 1, true), at(i, j + 1, true));
      quad(at(i, j, false), at(i, j + 1, false), at(i + 1, j + 1, false), at(i + 1, j, false));
    }
  }
  for (int i = 0; i < cells; ++i) {
    quad(at(i, 0, false), at(i + 1, 0, false), at(i + 1, 0, true), at(i, 0, true));
    quad(at(i + 1, cells, false), at(i, cells, false), at(i, cells, true), at(i + 1, cells, true));
    quad(at(0, i + 1, false), at(0, i, false), at(0, i, true), at(0, i + 1, true));
    quad(at(cells, i, false), at(cells, i + 1, false), at(cells, i + 1, true), at(cells, i, true));
  }
  return shape;
}

/// A screw thread: a height along the axis and an angle about it give the radius, a sine wave of
/// height `depth` to both sides of `radius`, right-handed.
struct Thread {
  double radius = 0, depth = 0, pitch = 1;  ///< m
  int turns = 1;                            ///< pitches from end to end, about z = 0
  int around = 32;                          ///< sides
  int rings = 8;                            ///< a pitch

  [[nodiscard]] double length() const { return turns * pitch; }
  [[nodiscard]] double radius_at(double angle, double height) const {
    return radius + depth * std::sin(2 * std::numbers::pi * height / pitch - angle);
  }
};

namespace detail {

/// Adds the thread's surface; its vertex (ring, side) is ring * around + side from the result on.
inline std::uint32_t add_thread(const Thread& thread, bool outward, test::Shape& shape) {
  const auto first = static_cast<std::uint32_t>(shape.vertices.size());
  const int rings = thread.turns * thread.rings;
  for (int ring = 0; ring <= rings; ++ring) {
    const double height = thread.length() * (static_cast<double>(ring) / rings - 0.5);
    for (int i = 0; i < thread.around; ++i) {
      const double angle = 2 * std::numbers::pi * i / thread.around;
      const double radius = thread.radius_at(angle, height);
      shape.vertices.emplace_back(radius * std::cos(angle), radius * std::sin(angle), height);
    }
  }
  for (int ring = 0; ring < rings; ++ring) {
    for (int i = 0; i < thread.around; ++i) {
      const auto at = [&](int up, int side) {
        return first +
               static_cast<std::uint32_t>((ring + up) * thread.around + (i + side) % thread.around);
      };
      const std::uint32_t a = at(0, 0), b = at(0, 1), c = at(1, 1), d = at(1, 0);
      if (outward) {
        shape.triangles.push_back({a, b, c});
        shape.triangles.push_back({a, c, d});
      } else {
        shape.triangles.push_back({a, c, b});
        shape.triangles.push_back({a, d, c});
      }
    }
  }
  return first;
}

}  // namespace detail

/// A bolt without a head.
[[nodiscard]] inline test::Shape bolt(const Thread& thread) {
  test::Shape shape;
  const std::uint32_t first = detail::add_thread(thread, true, shape);
  const auto around = static_cast<std::uint32_t>(thread.around);
  const std::uint32_t last =
      first + static_cast<std::uint32_t>(thread.turns * thread.rings) * around;
  const auto bottom = static_cast<std::uint32_t>(shape.vertices.size());
  shape.vertices.emplace_back(0, 0, -thread.length() / 2);
  shape.vertices.emplace_back(0, 0, thread.length() / 2);
  for (std::uint32_t i = 0; i < around; ++i) {
    const std::uint32_t next = (i + 1) % around;
    shape.triangles.push_back({bottom, first + next, first + i});
    shape.triangles.push_back({bottom + 1, last + i, last + next});
  }
  return shape;
}

/// A round nut of radius `outer` with that thread from end to end.
[[nodiscard]] inline test::Shape nut(const Thread& thread, double outer) {
  test::Shape shape;
  const std::uint32_t first = detail::add_thread(thread, false, shape);
  const auto around = static_cast<std::uint32_t>(thread.around);
  const std::uint32_t last =
      first + static_cast<std::uint32_t>(thread.turns * thread.rings) * around;
  const auto low = static_cast<std::uint32_t>(shape.vertices.size());
  for (const double height : {-thread.length() / 2, thread.length() / 2}) {
    for (std::uint32_t i = 0; i < around; ++i) {
      const double angle = 2 * std::numbers::pi * i / thread.around;
      shape.vertices.emplace_back(outer * std::cos(angle), outer * std::sin(angle), height);
    }
  }
  const std::uint32_t high = low + around;
  const auto quad = [&shape](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    shape.triangles.push_back({a, b, c});
    shape.triangles.push_back({a, c, d});
  };
  for (std::uint32_t i = 0; i < around; ++i) {
    const std::uint32_t next = (i + 1) % around;
    quad(low + i, low + next, high + next, high + i);
    quad(last + i, high + i, high + next, last + next);
    quad(low + i, first + i, first + next, low + next);
  }
  return shape;
}

/// Bars of a square cross-section, `count` along x and as many along y just below them, that touch
/// nothing: the tops of the upper ones lie at z = 0.
[[nodiscard]] inline test::Shape lattice(double thickness, double pitch, int count, double gap) {
  test::Shape shape;
  const double length = pitch * count;
  const auto add = [&shape](const test::Shape& bar) {
    const auto first = static_cast<std::uint32_t>(shape.vertices.size());
    shape.vertices.insert(shape.vertices.end(), bar.vertices.begin(), bar.vertices.end());
    for (const auto& t : bar.triangles) {
      shape.triangles.push_back({first + t[0], first + t[1], first + t[2]});
    }
  };
  for (int i = 0; i < count; ++i) {
    const double at = pitch * (i - (count - 1) / 2.0);
    add(test::moved(test::box({length, thickness, thickness}), {0, at, -thickness / 2}));
    add(test::moved(test::box({thickness, length, thickness}), {at, 0, -1.5 * thickness - gap}));
  }
  return shape;
}

}  // namespace spm::stability
