// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <map>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "common/base/vector.hpp"

namespace spm::test {

/// A triangle mesh whose shape is known in closed form: metres, triangles anticlockwise seen from
/// outside, closed, centred on the origin unless said otherwise.
struct Shape {
  std::vector<Vector3> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// Box with edges of length `size`, 8 vertices and 12 triangles.
[[nodiscard]] inline Shape box(const Vector3& size) {
  Shape shape;
  for (int corner = 0; corner < 8; ++corner) {
    shape.vertices.emplace_back((corner & 1) != 0 ? size.x() / 2 : -size.x() / 2,
                                (corner & 2) != 0 ? size.y() / 2 : -size.y() / 2,
                                (corner & 4) != 0 ? size.z() / 2 : -size.z() / 2);
  }
  shape.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                     {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return shape;
}

/// Thin box, for sheets: `size.z()` is the thickness.
[[nodiscard]] inline Shape plate(const Vector3& size) { return box(size); }

/// Icosahedron split `subdivisions` times, every vertex on the sphere: 20 * 4^subdivisions
/// triangles.
[[nodiscard]] inline Shape sphere(double radius, int subdivisions) {
  const double golden = std::numbers::phi;
  Shape shape;
  shape.vertices = {{-1, golden, 0}, {1, golden, 0}, {-1, -golden, 0}, {1, -golden, 0},
                    {0, -1, golden}, {0, 1, golden}, {0, -1, -golden}, {0, 1, -golden},
                    {golden, 0, -1}, {golden, 0, 1}, {-golden, 0, -1}, {-golden, 0, 1}};
  shape.triangles = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                     {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                     {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                     {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  for (Vector3& vertex : shape.vertices) vertex.normalize();
  for (int round = 0; round < subdivisions; ++round) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [found, added] =
          middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(shape.vertices.size()));
      if (added) {
        const Vector3 sum = shape.vertices[a] + shape.vertices[b];
        shape.vertices.push_back(sum.normalized());
      }
      return found->second;
    };
    std::vector<std::array<std::uint32_t, 3>> split;
    for (const auto& [a, b, c] : shape.triangles) {
      const std::uint32_t ab = middle(a, b);
      const std::uint32_t bc = middle(b, c);
      const std::uint32_t ca = middle(c, a);
      split.insert(split.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    shape.triangles = std::move(split);
  }
  for (Vector3& vertex : shape.vertices) vertex *= radius;
  return shape;
}

/// Torus about the z axis: `major` from the axis to the tube's centre, `minor` the tube's radius.
[[nodiscard]] inline Shape torus(double major, double minor, int around, int tube) {
  Shape shape;
  for (int i = 0; i < around; ++i) {
    const double turn = 2 * std::numbers::pi * i / around;
    for (int j = 0; j < tube; ++j) {
      const double roll = 2 * std::numbers::pi * j / tube;
      const double radius = major + minor * std::cos(roll);
      shape.vertices.emplace_back(radius * std::cos(turn), radius * std::sin(turn),
                                  minor * std::sin(roll));
    }
  }
  const auto index = [&](int i, int j) {
    return static_cast<std::uint32_t>((i % around) * tube + j % tube);
  };
  for (int i = 0; i < around; ++i) {
    for (int j = 0; j < tube; ++j) {
      shape.triangles.push_back({index(i, j), index(i + 1, j), index(i + 1, j + 1)});
      shape.triangles.push_back({index(i, j), index(i + 1, j + 1), index(i, j + 1)});
    }
  }
  return shape;
}

/// Cylinder about the z axis, closed by two fans; `around` sides.
[[nodiscard]] inline Shape cylinder(double radius, double height, int around) {
  Shape shape;
  for (int i = 0; i < around; ++i) {
    const double turn = 2 * std::numbers::pi * i / around;
    shape.vertices.emplace_back(radius * std::cos(turn), radius * std::sin(turn), -height / 2);
    shape.vertices.emplace_back(radius * std::cos(turn), radius * std::sin(turn), height / 2);
  }
  shape.vertices.emplace_back(0, 0, -height / 2);
  shape.vertices.emplace_back(0, 0, height / 2);
  const auto bottom = static_cast<std::uint32_t>(2 * around);
  const std::uint32_t top = bottom + 1;
  for (int i = 0; i < around; ++i) {
    const auto low = static_cast<std::uint32_t>(2 * i);
    const auto next = static_cast<std::uint32_t>(2 * ((i + 1) % around));
    shape.triangles.push_back({low, next, next + 1});
    shape.triangles.push_back({low, next + 1, low + 1});
    shape.triangles.push_back({bottom, next, low});
    shape.triangles.push_back({top, low + 1, next + 1});
  }
  return shape;
}

/// Prism with its ridge on the z axis, from -size/2 to size/2: two planes meet there at the opening
/// `angle` (radians, below pi), symmetric about the -x axis, each `size` long. Not centred.
[[nodiscard]] inline Shape wedge(double angle, double size) {
  const double x = -size * std::cos(angle / 2);
  const double y = size * std::sin(angle / 2);
  Shape shape;
  for (const double z : {-size / 2, size / 2}) {
    shape.vertices.emplace_back(0, 0, z);
    shape.vertices.emplace_back(x, y, z);
    shape.vertices.emplace_back(x, -y, z);
  }
  shape.triangles = {{0, 2, 1}, {3, 4, 5}, {0, 1, 4}, {0, 4, 3},
                     {1, 2, 5}, {1, 5, 4}, {2, 0, 3}, {2, 3, 5}};
  return shape;
}

/// Both shapes side by side in one mesh; nothing is joined.
[[nodiscard]] inline Shape merged(const Shape& first, const Shape& second) {
  Shape shape = first;
  const auto offset = static_cast<std::uint32_t>(first.vertices.size());
  shape.vertices.insert(shape.vertices.end(), second.vertices.begin(), second.vertices.end());
  for (const auto& [a, b, c] : second.triangles) {
    shape.triangles.push_back({a + offset, b + offset, c + offset});
  }
  return shape;
}

[[nodiscard]] inline Shape moved(Shape shape, const Vector3& offset) {
  for (Vector3& vertex : shape.vertices) vertex += offset;
  return shape;
}

/// Every triangle reversed, so that the normals point the other way.
[[nodiscard]] inline Shape turned_inside_out(Shape shape) {
  for (auto& triangle : shape.triangles) std::swap(triangle[1], triangle[2]);
  return shape;
}

/// Writes a Wavefront OBJ whose coordinates round-trip; throws where the file cannot be written.
inline void write_obj(const Shape& shape, const std::string& path) {
  std::ofstream file(path, std::ios::binary);
  for (const Vector3& vertex : shape.vertices) {
    file << 'v';
    for (int axis = 0; axis < 3; ++axis) {
      std::array<char, 32> text{};
      const auto end = std::to_chars(text.data(), text.data() + text.size(), vertex[axis]).ptr;
      file << ' ' << std::string(text.data(), end);
    }
    file << '\n';
  }
  for (const auto& [a, b, c] : shape.triangles) {
    file << "f " << a + 1 << ' ' << b + 1 << ' ' << c + 1 << '\n';
  }
  if (!file.flush()) throw std::runtime_error("cannot write " + path);
}

}  // namespace spm::test
