// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/field/narrow_sides.hpp"

#include <tbb/parallel_for.h>

#include <cmath>
#include <vector>

namespace spm::baker {

namespace {

/// rad: farther apart than this, two sides of a corner are told apart as near to it as is looked
/// (least_from_end_square).
constexpr double narrow = 0.05;
/// A normal tells the side of ways within this of it, 80 degrees, and so of all ways between two.
constexpr double told_cosine = 0.1736;

FeatureSide told_by(FeatureSides sides, std::size_t k) {
  return unpack_side(sides, static_cast<TriangleFeature>(1 + k));
}

/// Whether places that are nearest to another side may be told wrongly by this one. Not where that
/// is flat and this is none: behind this one another face is clearly nearer.
bool contradicts(FeatureSide other, FeatureSide told) {
  return other != told && other != FeatureSide::by_normal;
}

/// The sides around the ends of a side.
class NarrowSides {
 public:
  NarrowSides(const OuterSurface& surface, const TriangleSides& uses,
              std::span<const FeatureSides> sides)
      : surface_(surface), uses_(uses), sides_(sides) {}

  /// Whether a side is told by itself: no other within a narrow angle tells another thing.
  [[nodiscard]] bool stands(std::uint32_t triangle, std::size_t k) const {
    const FeatureSide told = told_by(sides_[triangle], k);
    if (told == FeatureSide::by_crossings) return true;
    const Vector3 normal = normal_of(triangle);
    for (const std::uint32_t number : uses_.uses(triangle, k)) {
      const SideUse use = TriangleSides::use(number);
      if (!stands_at(use, use.k, told, normal)) return false;
      if (!stands_at(use, (use.k + 1) % 3, told, normal)) return false;
    }
    return true;
  }

 private:
  const OuterSurface& surface_;
  const TriangleSides& uses_;
  std::span<const FeatureSides> sides_;

  [[nodiscard]] const Vector3& corner(std::uint32_t triangle, std::size_t k) const {
    return surface_.vertices[surface_.triangles[triangle][k % 3]];
  }
  /// Of length 1, or 0 where all corners are on a line.
  [[nodiscard]] Vector3 normal_of(std::uint32_t t) const {
    return (corner(t, 1) - corner(t, 0)).cross(corner(t, 2) - corner(t, 0)).normalized();
  }
  [[nodiscard]] bool faces(std::uint32_t triangle, const Vector3& normal) const {
    const Vector3 own = normal_of(triangle);
    return own == Vector3::Zero() || own.dot(normal) > told_cosine;
  }
  [[nodiscard]] double angle_at(std::uint32_t t, std::size_t k) const {
    const Vector3 next = corner(t, k + 1) - corner(t, k), last = corner(t, k + 2) - corner(t, k);
    return std::atan2(next.cross(last).norm(), next.dot(last));
  }

  /// The same at one end, by the triangle of a use and those beyond it.
  [[nodiscard]] bool stands_at(SideUse from, std::size_t end, FeatureSide told,
                               const Vector3& normal) const {
    const std::uint32_t first = from.triangle;
    const std::uint32_t vertex = surface_.triangles[first][end];
    double angle = 0;
    do {
      angle += angle_at(from.triangle, end);
      if (angle > narrow) return true;
      // The other side at this corner.
      const std::size_t k = from.k == end ? (end + 2) % 3 : end;
      if (contradicts(told_by(sides_[from.triangle], k), told)) return false;
      const auto both = uses_.uses(from.triangle, k);
      if (both.size() != 2) return true;
      const SideUse a = TriangleSides::use(both[0]), b = TriangleSides::use(both[1]);
      from = a.triangle == from.triangle ? b : a;
      if (told == FeatureSide::by_normal && !faces(from.triangle, normal)) return false;
      end = surface_.triangles[from.triangle][from.k] == vertex ? from.k : (from.k + 1) % 3;
    } while (from.triangle != first);
    return true;
  }
};

}  // namespace

void cross_beside_narrow(const OuterSurface& surface, const TriangleSides& uses,
                         std::span<FeatureSides> sides) {
  const std::vector<FeatureSides> before(sides.begin(), sides.end());
  const NarrowSides around(surface, uses, before);
  tbb::parallel_for(std::size_t{0}, sides.size(), [&](std::size_t number) {
    const auto t = static_cast<std::uint32_t>(number);
    for (std::size_t k = 0; k < 3; ++k) {
      if (around.stands(t, k)) continue;
      sides[t] = static_cast<FeatureSides>(
          sides[t] | pack_side(static_cast<TriangleFeature>(1 + k), FeatureSide::by_crossings));
    }
  });
}

}  // namespace spm::baker
