// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/mesh/sliver_removal.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "baker/base/cube_bins.hpp"
#include "baker/mesh/join_vertices.hpp"
#include "baker/mesh/triangle_height.hpp"

namespace spm::baker {

namespace {

/// Of the height, one after the other: a sliver that could be split only along a side that was
/// split before may be split again where less counts as one.
constexpr std::array<double, 4> shares{1, 0.5, 0.25, 0.125};

using Side = std::pair<std::uint32_t, std::uint32_t>;

bool is_flat(const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; }

bool has(const LooseTriangle& triangle, std::uint32_t corner) {
  return std::count(triangle.corners.begin(), triangle.corners.end(), corner) > 0;
}

/// The triangles at each side, in the order of their numbers. Slivers are few, so what lies at a
/// side is looked up when it is first asked for, which must be before any triangle there changes.
class ChangingSides {
 public:
  ChangingSides(std::size_t vertices, const std::vector<LooseTriangle>& triangles)
      : triangles_(triangles) {
    std::vector<CubeBins::Member> members;
    members.reserve(3 * triangles.size());
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
      for (const std::uint32_t corner : triangles[t].corners) members.emplace_back(corner, t);
    }
    corners_ = CubeBins(vertices, members);
  }

  std::vector<std::uint32_t>& at(std::uint32_t a, std::uint32_t b) {
    const auto [side, fresh] = sides_.try_emplace(std::minmax(a, b));
    if (fresh) {
      for (const std::uint32_t t : corners_.of(a, a)) {
        if (has(triangles_[t], a) && has(triangles_[t], b)) side->second.push_back(t);
      }
    }
    return side->second;
  }

 private:
  const std::vector<LooseTriangle>& triangles_;
  CubeBins corners_;  ///< the first triangles of each vertex
  std::map<Side, std::vector<std::uint32_t>> sides_;
};

class SliverRemoval {
 public:
  SliverRemoval(const std::vector<Vector3>& vertices, double height,
                std::vector<LooseTriangle>& triangles)
      : vertices_(vertices),
        height_(height),
        triangles_(triangles),
        displaced_(triangles.size(), 0) {
    std::vector<char> low(triangles_.size());
    tbb::parallel_for(std::size_t{0}, low.size(), [&](std::size_t t) {
      low[t] = height_of(triangles_[t].corners) < height_ ? 1 : 0;
    });
    for (std::uint32_t t = 0; t < low.size(); ++t) {
      if (low[t] != 0) slivers_.insert(as_sliver(triangles_[t].corners, t));
    }
    if (!slivers_.empty()) sides_.emplace(vertices_.size(), triangles_);
  }

  /// m: of any place of the surface at most.
  [[nodiscard]] double displacement() const { return displacement_; }

  /// Those with the longest sides first, so that parts of a side are never joined to it again.
  void remove_all() {
    while (!slivers_.empty()) {
      const std::uint32_t t = slivers_.begin()->second;
      slivers_.erase(slivers_.begin());
      if (!cancel(t)) split_longest_side(t);
    }
  }

 private:
  const std::vector<Vector3>& vertices_;
  double height_;
  std::vector<LooseTriangle>& triangles_;
  std::vector<double> displaced_;  ///< m, by triangle
  double displacement_ = 0;
  std::optional<ChangingSides> sides_;  ///< where there are slivers
  std::set<Side> split_;                ///< sides that were, which must not come back
  using Sliver = std::pair<double, std::uint32_t>;
  std::set<Sliver> slivers_;  ///< by the length of the longest side

  [[nodiscard]] double length(std::uint32_t a, std::uint32_t b) const {
    return (vertices_[a] - vertices_[b]).norm();
  }
  /// The corner opposite the longest side.
  [[nodiscard]] std::size_t apex_of(const Triangle& t) const {
    const std::array lengths{length(t[1], t[2]), length(t[2], t[0]), length(t[0], t[1])};
    return static_cast<std::size_t>(std::max_element(lengths.begin(), lengths.end()) -
                                    lengths.begin());
  }
  [[nodiscard]] double height_of(const Triangle& t) const {
    return triangle_height(vertices_[t[0]], vertices_[t[1]], vertices_[t[2]]);
  }

  [[nodiscard]] Sliver as_sliver(const Triangle& corners, std::uint32_t t) const {
    const std::size_t apex = apex_of(corners);
    return {-length(corners[(apex + 1) % 3], corners[(apex + 2) % 3]), t};
  }

  /// Takes a triangle away; its number stays, without a triangle.
  void forget(std::uint32_t t) {
    Triangle& corners = triangles_[t].corners;
    // All three are looked up before the triangle changes.
    for (std::size_t k = 0; k < 3; ++k) std::erase(sides_->at(corners[k], corners[(k + 1) % 3]), t);
    slivers_.erase(as_sliver(corners, t));
    corners = {};
  }

  void add(const LooseTriangle& triangle, double displaced) {
    const auto t = static_cast<std::uint32_t>(triangles_.size());
    const Triangle& corners = triangle.corners;
    for (std::size_t k = 0; k < 3; ++k) {
      sides_->at(corners[k], corners[(k + 1) % 3]).push_back(t);
    }
    if (height_of(corners) < height_) slivers_.insert(as_sliver(corners, t));
    triangles_.push_back(triangle);
    displaced_.push_back(displaced);
    displacement_ = std::max(displacement_, displaced);
  }

  /// Whether a side would still be there without so many of its triangles.
  [[nodiscard]] bool stays(std::uint32_t a, std::uint32_t b, std::size_t without) {
    return sides_->at(a, b).size() > without;
  }

  /// Takes away two slivers that lie on each other and face opposite ways.
  bool cancel(std::uint32_t t) {
    const auto [a, b, c] = triangles_[t].corners;
    if (!stays(a, b, 2) || !stays(b, c, 2) || !stays(c, a, 2)) return false;
    for (const std::uint32_t other : sides_->at(a, b)) {
      Triangle turned = triangles_[other].corners;
      while (turned[0] != b) std::rotate(turned.begin(), turned.begin() + 1, turned.end());
      if (turned != Triangle{b, a, c}) continue;
      displacement_ = std::max({displacement_, displaced_[t] + height_of(turned),
                                displaced_[other] + height_of(turned)});
      forget(other);
      forget(t);
      return true;
    }
    return false;
  }

  /// Leads the longest side of a sliver through its third corner, in all triangles that have it;
  /// the sliver itself is gone then.
  void split_longest_side(std::uint32_t t) {
    const Triangle corners = triangles_[t].corners;
    const std::size_t apex = apex_of(corners);
    const std::uint32_t c = corners[apex];
    const Side side = std::minmax(corners[(apex + 1) % 3], corners[(apex + 2) % 3]);
    const std::vector<std::uint32_t> around = sides_->at(side.first, side.second);
    const auto slivers = static_cast<std::size_t>(std::count_if(
        around.begin(), around.end(), [&](auto other) { return has(triangles_[other], c); }));
    if (slivers == around.size() &&
        (!stays(side.first, c, slivers) || !stays(c, side.second, slivers))) {
      return;
    }
    for (const std::uint32_t other : around) {
      for (const std::uint32_t o : triangles_[other].corners) {
        if (split_.contains(std::minmax(c, o))) return;
      }
    }
    split_.insert(side);
    double displaced = 0;
    for (const std::uint32_t other : around) {
      displaced = std::max(displaced, displaced_[other] + height_of(corners));
    }
    for (const std::uint32_t other : around) {
      const LooseTriangle whole = triangles_[other];
      forget(other);
      if (has(whole, c)) continue;
      for (const std::uint32_t end : {side.first, side.second}) {
        LooseTriangle part = whole;
        std::replace(part.corners.begin(), part.corners.end(), end, c);
        add(part, displaced);
      }
    }
  }
};

}  // namespace

double remove_slivers(const std::vector<Vector3>& vertices, double height,
                      std::vector<LooseTriangle>& triangles) {
  const std::vector<std::uint32_t> joined = join_vertices(vertices, height);
  double displacement = 0;
  std::vector<LooseTriangle> alone;  // sheets of which nothing else would be left
  std::vector<char> used(vertices.size(), 0);
  for (const LooseTriangle& triangle : triangles) {
    Triangle corners = triangle.corners;
    for (std::uint32_t& corner : corners) corner = joined[corner];
    if (is_flat(corners)) continue;
    for (const std::uint32_t corner : corners) used[corner] = 1;
  }
  for (LooseTriangle& triangle : triangles) {
    const LooseTriangle whole = triangle;
    for (std::uint32_t& corner : triangle.corners) {
      displacement = std::max(displacement, (vertices[corner] - vertices[joined[corner]]).norm());
      corner = joined[corner];
    }
    const bool covered = std::all_of(triangle.corners.begin(), triangle.corners.end(),
                                     [&](std::uint32_t corner) { return used[corner] != 0; });
    if (triangle.sheet && is_flat(triangle.corners) && !covered) alone.push_back(whole);
  }
  std::erase_if(triangles, [](const LooseTriangle& t) { return is_flat(t.corners); });
  for (const double share : shares) {
    SliverRemoval removal(vertices, share * height, triangles);
    removal.remove_all();
    displacement += removal.displacement();
    std::erase_if(triangles, [](const LooseTriangle& t) { return is_flat(t.corners); });
  }
  triangles.insert(triangles.end(), alone.begin(), alone.end());
  std::stable_partition(triangles.begin(), triangles.end(),
                        [](const LooseTriangle& t) { return !t.sheet; });
  return displacement;
}

}  // namespace spm::baker
