// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/mesh/mesh_orient.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <utility>

#include "baker/mesh/mesh_edges.hpp"
#include "baker/mesh/winding_number.hpp"

namespace spm::baker {
namespace {

struct Patch {
  std::vector<std::uint32_t> triangles;
  Eigen::AlignedBox3d box;
  double volume = 0;  ///< signed, of a closed patch
  bool closed = true;
};

void turn(Triangle& triangle) { std::swap(triangle[1], triangle[2]); }

[[nodiscard]] std::uint32_t count_components(const std::vector<HalfEdge>& edges,
                                             std::size_t triangles) {
  Groups parts = parts_over(edges, triangles);
  std::uint32_t components = 0;
  for (std::uint32_t t = 0; t < triangles; ++t) components += parts.of(t) == t ? 1 : 0;
  return components;
}

/// Makes neighbours agree and gathers them into patches.
class Patcher {
 public:
  Patcher(std::vector<Triangle>& triangles, const std::vector<HalfEdge>& edges,
          Orientation& orientation)
      : triangles_(triangles), orientation_(orientation), neighbours_(triangles.size()) {
    for_each_edge(edges, [&](std::span<const HalfEdge> users) {
      if (users.size() > 2) orientation_.nonmanifold_edges.add(1, users[0].low);
      if (users.size() != 2) return;
      const bool agree = users[0].forward != users[1].forward;
      neighbours_[users[0].triangle].push_back({users[1].triangle, agree});
      neighbours_[users[1].triangle].push_back({users[0].triangle, agree});
    });
  }

  [[nodiscard]] std::vector<Patch> patches() {
    std::vector<Patch> found;
    std::vector<char> turned(triangles_.size(), 0);
    std::vector<char> seen(triangles_.size(), 0);
    for (std::uint32_t seed = 0; seed < triangles_.size(); ++seed) {
      if (seen[seed] != 0) continue;
      Patch patch;
      patch.triangles.push_back(seed);
      seen[seed] = 1;
      std::uint64_t turns = 0;
      std::uint64_t conflicts = 0;
      std::uint32_t in_conflict = 0;
      for (std::size_t next = 0; next < patch.triangles.size(); ++next) {
        const std::uint32_t from = patch.triangles[next];
        for (const auto& [to, agree] : neighbours_[from]) {
          const char wanted = static_cast<char>(agree ? turned[from] : 1 - turned[from]);
          if (seen[to] != 0) {
            if (turned[to] == wanted) continue;
            ++conflicts;
            in_conflict = triangles_[to][0];
            continue;
          }
          seen[to] = 1;
          turned[to] = wanted;
          turns += static_cast<std::uint64_t>(wanted);
          patch.triangles.push_back(to);
        }
      }
      const bool minority = 2 * turns <= patch.triangles.size();
      for (const std::uint32_t t : patch.triangles) {
        if ((turned[t] != 0) != minority) continue;
        turn(triangles_[t]);
        orientation_.flipped.add(1, triangles_[t][0]);
      }
      if (conflicts > 1) orientation_.unorientable.add(conflicts / 2, in_conflict);
      std::sort(patch.triangles.begin(), patch.triangles.end());
      found.push_back(std::move(patch));
    }
    return found;
  }

 private:
  struct Neighbour {
    std::uint32_t triangle;
    bool agree;
  };
  std::vector<Triangle>& triangles_;
  Orientation& orientation_;
  std::vector<std::vector<Neighbour>> neighbours_;
};

/// Decides which patches to turn.
class Turner {
 public:
  Turner(std::span<const Vector3> points, std::vector<Triangle>& triangles,
         std::vector<Patch>& patches)
      : points_(points), triangles_(triangles), patches_(patches), numbers_(patches.size()) {
    for (Patch& patch : patches_) measure(patch);
  }

  void run(Counted& turned) {
    // The largest first, so that the surroundings of a patch are settled before the patch.
    std::vector<std::size_t> order(patches_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return std::abs(patches_[a].volume) > std::abs(patches_[b].volume);
    });
    std::vector<std::size_t> settled;
    std::vector<char> inverted(patches_.size(), 0);
    for (const std::size_t i : order) {
      if (!patches_[i].closed) {
        settle_open(i, turned);
        continue;
      }
      inverted[i] = patches_[i].volume < 0 ? 1 : 0;
      std::optional<std::size_t> outermost;
      int around = 0;
      for (const std::size_t other : settled) {
        if (!encloses(other, i)) continue;
        if (!outermost) outermost = other;
        around += patches_[other].volume < 0 ? -1 : 1;
      }
      // The cavities of an inverted solid are inverted with it. They are judged as if the solid had
      // been right.
      const bool inward = outermost ? inverted[i] != inverted[*outermost] : inverted[i] != 0;
      const bool cavity = inward && around > 0;
      if (cavity != (patches_[i].volume < 0)) turn_patch(i, turned);
      settled.push_back(i);
    }
  }

 private:
  void measure(Patch& patch) const {
    const std::vector<Triangle> own = triangles_of(patch);
    for (const Triangle& triangle : own) {
      for (const std::uint32_t corner : triangle) patch.box.extend(points_[corner]);
    }
    for_each_edge(sorted_edges(own), [&](std::span<const HalfEdge> users) {
      patch.closed = patch.closed && is_balanced(users);
    });
    if (!patch.closed) return;
    const Vector3 origin = patch.box.center();
    for (const auto& [a, b, c] : own) {
      patch.volume +=
          (points_[a] - origin).dot((points_[b] - origin).cross(points_[c] - origin)) / 6;
    }
  }

  [[nodiscard]] std::vector<Triangle> triangles_of(const Patch& patch) const {
    std::vector<Triangle> own;
    own.reserve(patch.triangles.size());
    for (const std::uint32_t t : patch.triangles) own.push_back(triangles_[t]);
    return own;
  }

  [[nodiscard]] const WindingNumber& number(std::size_t patch) {
    if (!numbers_[patch]) numbers_[patch].emplace(points_, triangles_of(patches_[patch]));
    return *numbers_[patch];
  }

  /// True where the inner patch lies inside the outer one, whichever way the outer one faces.
  [[nodiscard]] bool encloses(std::size_t outer, std::size_t inner) {
    constexpr std::size_t kProbes = 64;
    if (!patches_[outer].box.contains(patches_[inner].box)) return false;
    const auto& own = patches_[inner].triangles;
    const std::size_t step = std::max<std::size_t>(1, own.size() / kProbes);
    const WindingNumber& winding = number(outer);
    for (std::size_t i = 0; i < own.size(); i += step) {
      if (std::abs(winding.at(points_[triangles_[own[i]][0]])) < 0.5) return false;
    }
    return true;
  }

  /// Whether an open patch faces outward, judged from its own faces: then most of a full turn is
  /// behind it and little in front. On the faces themselves the mean of both is near 1/2, or -1/2
  /// if the patch is inverted.
  void settle_open(std::size_t index, Counted& turned) {
    constexpr std::size_t kProbes = 256;
    const auto& own = patches_[index].triangles;
    const std::size_t step = std::max<std::size_t>(1, own.size() / kProbes);
    const double offset = 1e-6 * patches_[index].box.diagonal().norm();
    const WindingNumber& winding = number(index);
    double sum = 0;
    double weight = 0;
    for (std::size_t i = 0; i < own.size(); i += step) {
      const auto& [a, b, c] = triangles_[own[i]];
      const Vector3 twice = (points_[b] - points_[a]).cross(points_[c] - points_[a]);
      const double size = twice.norm();
      if (!(size > 0)) continue;
      const Vector3 centroid = (points_[a] + points_[b] + points_[c]) / 3;
      const Vector3 step_out = offset / size * twice;
      sum += size * (winding.at(centroid + step_out) + winding.at(centroid - step_out)) / 2;
      weight += size;
    }
    const double mean = weight > 0 ? sum / weight : 0;
    if (mean < 0) turn_patch(index, turned);
  }

  void turn_patch(std::size_t index, Counted& turned) {
    for (const std::uint32_t t : patches_[index].triangles) turn(triangles_[t]);
    patches_[index].volume = -patches_[index].volume;
    turned.add(1, triangles_[patches_[index].triangles.front()][0]);
  }

  std::span<const Vector3> points_;
  std::vector<Triangle>& triangles_;
  std::vector<Patch>& patches_;
  std::vector<std::optional<WindingNumber>> numbers_;
};

/// How many edges there are along which more triangles run in one direction than in the other.
[[nodiscard]] Counted count_border_edges(const std::vector<Triangle>& triangles) {
  Counted border;
  for_each_edge(sorted_edges(triangles), [&](std::span<const HalfEdge> users) {
    if (!is_balanced(users)) border.add(1, users[0].low);
  });
  return border;
}

}  // namespace

Orientation orient(std::span<const Vector3> points, std::vector<Triangle>& triangles) {
  Orientation orientation;
  const std::vector<HalfEdge> edges = sorted_edges(triangles);
  orientation.components = count_components(edges, triangles.size());
  std::vector<Patch> patches = Patcher(triangles, edges, orientation).patches();
  Turner(points, triangles, patches).run(orientation.inverted);
  orientation.border_edges = count_border_edges(triangles);
  return orientation;
}

Counted turn_parts(std::span<const Vector3> points, std::span<const std::uint32_t> parts,
                   std::vector<Triangle>& triangles) {
  std::map<std::uint32_t, Patch> numbered;
  for (std::uint32_t t = 0; t < triangles.size(); ++t) numbered[parts[t]].triangles.push_back(t);
  std::vector<Patch> patches;
  patches.reserve(numbered.size());
  for (auto& [number, patch] : numbered) patches.push_back(std::move(patch));
  Counted turned;
  Turner(points, triangles, patches).run(turned);
  return turned;
}

}  // namespace spm::baker
