// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/stability/catalogue/catalogue_shapes.hpp"

#include <cmath>
#include <map>

#include "common/base/random.hpp"
#include "tests/stability/catalogue/sixdof_shapes.hpp"

namespace spm::stability {

using test::Shape;

Shape prism(const std::vector<std::array<double, 2>>& profile, double length) {
  Shape shape;
  const auto count = static_cast<std::uint32_t>(profile.size());
  for (const double y : {-length / 2, length / 2}) {
    for (const auto& [x, z] : profile) shape.vertices.emplace_back(x, y, z);
  }
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t next = (i + 1) % count;
    if (i > 0 && next > 0) {
      shape.triangles.push_back({0, i, next});
      shape.triangles.push_back({count, count + next, count + i});
    }
    shape.triangles.push_back({i, count + i, count + next});
    shape.triangles.push_back({i, count + next, next});
  }
  return shape;
}

Shape cells(const std::vector<double>& xs, const std::vector<double>& ys,
            const std::vector<double>& zs, const std::function<bool(int, int, int)>& filled) {
  using Place = std::array<int, 3>;
  const std::array<const std::vector<double>*, 3> planes{&xs, &ys, &zs};
  const auto count = [&](std::size_t axis) { return static_cast<int>(planes[axis]->size()) - 1; };
  const auto is_filled = [&](const Place& cell) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (cell[axis] < 0 || cell[axis] >= count(axis)) return false;
    }
    return filled(cell[0], cell[1], cell[2]);
  };
  Shape shape;
  std::map<Place, std::uint32_t> known;
  const auto corner = [&](const Place& at) {
    const auto [found, is_new] =
        known.try_emplace(at, static_cast<std::uint32_t>(shape.vertices.size()));
    if (is_new) {
      const auto plane = [&](std::size_t axis) {
        return (*planes[axis])[static_cast<std::size_t>(at[axis])];
      };
      shape.vertices.emplace_back(plane(0), plane(1), plane(2));
    }
    return found->second;
  };
  const auto add_face = [&](const Place& cell, std::size_t axis, bool upper) {
    // The two other axes in turn: with this one they are right-handed.
    const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
    std::array<std::uint32_t, 4> face{};
    for (std::size_t k = 0; k < 4; ++k) {
      Place at = cell;
      at[axis] += upper ? 1 : 0;
      at[u] += k == 1 || k == 2 ? 1 : 0;
      at[v] += k >= 2 ? 1 : 0;
      face[upper ? k : 3 - k] = corner(at);
    }
    shape.triangles.push_back({face[0], face[1], face[2]});
    shape.triangles.push_back({face[0], face[2], face[3]});
  };
  for (int z = 0; z < count(2); ++z) {
    for (int y = 0; y < count(1); ++y) {
      for (int x = 0; x < count(0); ++x) {
        if (!is_filled({x, y, z})) continue;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          for (const bool upper : {false, true}) {
            Place beside{x, y, z};
            beside[axis] += upper ? 1 : -1;
            if (!is_filled(beside)) add_face({x, y, z}, axis, upper);
          }
        }
      }
    }
  }
  return shape;
}

Shape flat_block() { return test::moved(test::box({60e-3, 60e-3, 40e-3}), {0, 0, -20e-3}); }

Shape flat_plate(double thickness) {
  return test::moved(test::plate({30e-3, 30e-3, thickness}), {0, 0, -thickness / 2});
}

Shape two_plates(double thickness, double gap) {
  const Shape plate = flat_plate(thickness);
  return test::merged(plate, test::moved(plate, {0, 0, -thickness - gap}));
}

Shape square_bar(double side) {
  return test::moved(test::box({side, 40e-3, side}), {0, 0, -side / 2});
}

Shape taper(double thick, double thin) {
  constexpr double half = 15e-3;
  return prism({{-half, 0}, {-half, -thick}, {half, -thin}, {half, 0}}, 30e-3);
}

Shape groove(double angle, double depth) {
  const double mouth = depth * std::tan(angle / 2);
  const double half = mouth + 4e-3;
  return prism({{0, -2 * depth},
                {half, -2 * depth},
                {half, 0},
                {mouth, 0},
                {0, -depth},
                {-mouth, 0},
                {-half, 0},
                {-half, -2 * depth}},
               15e-3);
}

Shape slot(double width, double depth) {
  return cells({-10e-3, -width / 2, width / 2, 10e-3}, {-7.5e-3, 7.5e-3},
               {-depth - 5e-3, -depth, 0}, [](int x, int, int z) { return x != 1 || z == 0; });
}

Shape inner_corner() {
  const std::vector<double> planes{-8e-3, 0, 8e-3};
  return cells(planes, planes, planes, [](int x, int y, int z) { return x + y + z < 3; });
}

Shape cone_pit(double depth) {
  const double radius = depth + 4e-3;
  return turned_profile(
      {{0, -2 * depth}, {radius, -2 * depth}, {radius, 0}, {depth, 0}, {0, -depth}}, 24);
}

Shape faceted_wall(double height, std::uint64_t seed) {
  constexpr int squares = 12;
  Shape shape = bumpy_plate(12e-3, 6e-3, 0, 0, squares);
  Random random(seed);
  for (std::size_t i = 0; i < std::size_t{squares + 1} * (squares + 1); ++i) {
    shape.vertices[i].z() += random.between(-height, height);
  }
  return shape;
}

}  // namespace spm::stability
