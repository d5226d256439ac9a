// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/field/sliver_removal.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "baker/surface/join_vertices.hpp"

namespace spm::baker {

namespace {

/// Flips may make new slivers, which are turned in the next round.
constexpr int rounds = 8;

using Side = std::pair<std::uint32_t, std::uint32_t>;

bool is_flat(const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; }

class Flipper {
 public:
  Flipper(const std::vector<Vector3>& vertices, double height,
          std::vector<LooseTriangle>& triangles)
      : vertices_(vertices),
        height_(height),
        triangles_(triangles),
        displaced_(triangles.size(), 0) {}

  /// m: of any place of the surface at most.
  [[nodiscard]] double displacement() const {
    return displaced_.empty() ? 0 : *std::max_element(displaced_.begin(), displaced_.end());
  }

  /// One round; false where nothing changed.
  bool turn_all() {
    sides_.clear();
    for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
      const Triangle& corners = triangles_[t].corners;
      for (std::size_t k = 0; k < 3; ++k) {
        sides_[std::minmax(corners[k], corners[(k + 1) % 3])].push_back(t);
      }
    }
    std::vector<bool> touched(triangles_.size(), false);
    bool changed = false;
    for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
      if (touched[t] || height_of(triangles_[t].corners) >= height_) continue;
      const std::size_t apex = apex_of(triangles_[t].corners);
      const double height = height_of(triangles_[t].corners);
      const std::optional<std::uint32_t> other = neighbour(t, apex);
      if (!other || touched[*other] || !turn(t, *other, apex)) continue;
      touched[t] = touched[*other] = changed = true;
      displaced_[t] = displaced_[*other] = std::max(displaced_[t], displaced_[*other]) + height;
    }
    return changed;
  }

 private:
  const std::vector<Vector3>& vertices_;
  double height_;
  std::vector<LooseTriangle>& triangles_;
  std::vector<double> displaced_;  ///< m, by triangle
  std::map<Side, std::vector<std::uint32_t>> sides_;

  [[nodiscard]] double length(std::uint32_t a, std::uint32_t b) const {
    return (vertices_[a] - vertices_[b]).norm();
  }
  /// The corner opposite the longest side.
  [[nodiscard]] std::size_t apex_of(const Triangle& t) const {
    std::size_t apex = 0;
    double longest = -1;
    for (std::size_t k = 0; k < 3; ++k) {
      const double here = length(t[(k + 1) % 3], t[(k + 2) % 3]);
      if (here <= longest) continue;
      longest = here;
      apex = k;
    }
    return apex;
  }
  [[nodiscard]] double height_of(const Triangle& t) const {
    const std::size_t apex = apex_of(t);
    const double longest = length(t[(apex + 1) % 3], t[(apex + 2) % 3]);
    const double area =
        (vertices_[t[1]] - vertices_[t[0]]).cross(vertices_[t[2]] - vertices_[t[0]]).norm();
    return longest > 0 ? area / longest : 0;
  }

  /// The one triangle beyond the longest side, which passes it the other way.
  [[nodiscard]] std::optional<std::uint32_t> neighbour(std::uint32_t t, std::size_t apex) const {
    const Triangle& corners = triangles_[t].corners;
    const std::uint32_t from = corners[(apex + 1) % 3], to = corners[(apex + 2) % 3];
    const std::vector<std::uint32_t>& both = sides_.at(std::minmax(from, to));
    if (both.size() != 2) return std::nullopt;
    const std::uint32_t other = both[0] == t ? both[1] : both[0];
    if (triangles_[other].cap != triangles_[t].cap) return std::nullopt;
    const Triangle& there = triangles_[other].corners;
    for (std::size_t k = 0; k < 3; ++k) {
      if (there[k] == to && there[(k + 1) % 3] == from) return other;
    }
    return std::nullopt;
  }

  /// Turns the side between a sliver and its neighbour; false where that makes it no better.
  bool turn(std::uint32_t t, std::uint32_t other, std::size_t apex) {
    const Triangle& corners = triangles_[t].corners;
    const std::uint32_t c = corners[apex], a = corners[(apex + 1) % 3], b = corners[(apex + 2) % 3];
    const Triangle& there = triangles_[other].corners;
    const std::uint32_t o =
        *std::find_if(there.begin(), there.end(), [&](auto v) { return v != a && v != b; });
    if (o == c || sides_.contains(std::minmax(c, o))) return false;
    const Triangle first{c, a, o}, second{c, o, b};
    if (std::min(height_of(first), height_of(second)) <=
        std::min(height_of(corners), height_of(there))) {
      return false;
    }
    const bool bare = triangles_[t].bare || triangles_[other].bare;
    triangles_[t].corners = first;
    triangles_[other].corners = second;
    triangles_[t].bare = triangles_[other].bare = bare;
    sides_[std::minmax(c, o)] = {t, other};
    return true;
  }
};

}  // namespace

double remove_slivers(const std::vector<Vector3>& vertices, double height,
                      std::vector<LooseTriangle>& triangles) {
  const std::vector<std::uint32_t> joined = join_vertices(vertices, height);
  double displacement = 0;
  for (LooseTriangle& triangle : triangles) {
    for (std::uint32_t& corner : triangle.corners) {
      displacement = std::max(displacement, (vertices[corner] - vertices[joined[corner]]).norm());
      corner = joined[corner];
    }
  }
  std::erase_if(triangles, [](const LooseTriangle& t) { return is_flat(t.corners); });
  Flipper flipper(vertices, height, triangles);
  for (int round = 0; round < rounds; ++round) {
    if (!flipper.turn_all()) break;
  }
  return displacement + flipper.displacement();
}

}  // namespace spm::baker
