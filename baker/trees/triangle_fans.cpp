// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/trees/triangle_fans.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>

namespace spm::baker {

namespace {

constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
/// Longer fans save little more, and their boxes grow.
constexpr std::size_t max_triangles = 8;
/// Fans of at least this many triangles are taken first, then shorter ones of the rest.
constexpr std::array<std::size_t, 4> rounds{6, 4, 2, 1};

/// A side of a triangle, 3 * triangle + corner, from that corner to the next.
using Side = std::uint32_t;

Side next_side(Side side) { return side % 3 == 2 ? side - 2 : side + 1; }
Side last_side(Side side) { return side % 3 == 0 ? side + 2 : side - 1; }

class FanFinder {
 public:
  explicit FanFinder(const std::vector<std::array<Vector3, 3>>& triangles)
      : triangles_(triangles), taken_(triangles.size(), 0), other_(3 * triangles.size(), none) {
    using Ends = std::array<double, 6>;
    std::vector<std::pair<Ends, Side>> sides;
    for (Side side = 0; side < other_.size(); ++side) {
      const Vector3& a = corner(side);
      const Vector3& b = corner(next_side(side));
      sides.push_back({{a.x(), a.y(), a.z(), b.x(), b.y(), b.z()}, side});
    }
    std::sort(sides.begin(), sides.end());
    for (const auto& [ends, side] : sides) {
      const Ends back{ends[3], ends[4], ends[5], ends[0], ends[1], ends[2]};
      const auto at = std::lower_bound(sides.begin(), sides.end(), std::pair(back, Side{0}));
      if (at != sides.end() && at->first == back) other_[side] = at->second;
    }
  }

  std::vector<TriangleFan> run() {
    std::vector<TriangleFan> fans;
    for (const std::size_t least : rounds) {
      for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
        if (taken_[t] != 0) continue;
        std::vector<Side> best;
        for (std::uint32_t k = 0; k < 3; ++k) {
          std::vector<Side> sides = around(3 * t + k);
          if (sides.size() > best.size()) best = std::move(sides);
        }
        if (best.size() >= least) fans.push_back(take(best));
      }
    }
    return fans;
  }

 private:
  const std::vector<std::array<Vector3, 3>>& triangles_;
  std::vector<std::uint8_t> taken_;
  std::vector<Side> other_;  ///< the same side as seen from the triangle beyond it

  [[nodiscard]] const Vector3& corner(Side side) const { return triangles_[side / 3][side % 3]; }
  [[nodiscard]] bool free(Side side) const { return side != none && taken_[side / 3] == 0; }

  /// The sides that leave the same corner as `start`, one after the other, of triangles that are
  /// not taken yet.
  [[nodiscard]] std::vector<Side> around(Side start) const {
    std::vector<Side> sides{start};
    const auto known = [&sides](Side side) {
      return std::any_of(sides.begin(), sides.end(),
                         [side](Side one) { return one / 3 == side / 3; });
    };
    while (sides.size() < max_triangles) {
      const Side next = other_[last_side(sides.back())];
      if (!free(next) || known(next)) break;
      sides.push_back(next);
    }
    while (sides.size() < max_triangles) {
      const Side back = other_[sides.front()];
      if (!free(back) || known(back)) break;
      sides.insert(sides.begin(), next_side(back));
    }
    return sides;
  }

  TriangleFan take(const std::vector<Side>& sides) {
    TriangleFan fan{corner(sides.front()), corner(next_side(sides.front()))};
    for (const Side side : sides) {
      fan.push_back(corner(last_side(side)));
      taken_[side / 3] = 1;
    }
    return fan;
  }
};

}  // namespace

std::vector<TriangleFan> fans_of(const std::vector<std::array<Vector3, 3>>& triangles) {
  return FanFinder(triangles).run();
}

}  // namespace spm::baker
