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

}  // namespace spm::stability
