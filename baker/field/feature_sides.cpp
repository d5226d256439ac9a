// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/field/feature_sides.hpp"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <iterator>
#include <optional>
#include <span>
#include <tuple>
#include <utility>

#include "baker/base/cube_bins.hpp"
#include "baker/mesh/triangle_height.hpp"
#include "baker/surface/self_intersection.hpp"

namespace spm::baker {

namespace {

/// Normals within this of their mean face nearly the same way. Below 45 degrees each normal alone
/// tells the side; see PROOF.md.
constexpr double flat_cosine = 0.7660;  // 40 degrees
/// More directions than this around a corner take too long to be combined pair by pair.
constexpr std::size_t most_paired = 64;
constexpr double rounding = 1e-9;
/// How far beside a part of the surface the solid is asked, of the tolerance: the farthest where
/// the part is still what is nearest, since nearer than the tolerance the side does not matter.
constexpr std::array<double, 5> beside{1, 0.5, 0.25, 0.125, 0.0625};
/// A query in single precision takes a part of the surface for the nearest one up to about this
/// angle (rad) outside the cone in which it is; and there it is farther off by no more than this
/// share.
constexpr double blurred = 0.01;
constexpr double blurred_away = 1e-4;
/// A part that is the nearest of the solid to within this share of its distance is so of the
/// surface too. Where they may differ by more, the surface is asked as well.
constexpr double surely_nearest = 0.01;
/// Nearer than so many displacements the solid is not asked.
constexpr double least_displacements = 4;
/// The ways from a side are turned about it by these, rad.
constexpr std::array<double, 5> turns{0, 0.5, -0.5, 1, -1};

/// A side of a triangle, of which the k-th leads from its k-th corner to the next.
struct SideUse {
  std::uint32_t triangle = 0;
  std::uint32_t k = 0;
};

/// The sides of triangles, each known to all triangles that have it, whichever way they pass it.
class TriangleSides {
 public:
  explicit TriangleSides(std::span<const Triangle> triangles);

  [[nodiscard]] std::size_t count() const { return count_; }
  /// Its uses, in the order of the triangles; 3 t + k stands for the k-th side of triangle t.
  [[nodiscard]] std::span<const std::uint32_t> uses(std::size_t side) const {
    return uses_.of(side, side);
  }
  /// The uses of a triangle's k-th side, its own among them.
  [[nodiscard]] std::span<const std::uint32_t> uses(std::uint32_t triangle, std::size_t k) const {
    return uses(numbers_[3 * std::size_t{triangle} + k]);
  }
  [[nodiscard]] static SideUse use(std::uint32_t number) { return {number / 3, number % 3}; }

 private:
  std::size_t count_ = 0;
  std::vector<std::uint32_t> numbers_;  ///< of the three sides of each triangle
  CubeBins uses_;
};

TriangleSides::TriangleSides(std::span<const Triangle> triangles) : numbers_(3 * triangles.size()) {
  // The two corners, the lesser one first, and which use.
  std::vector<std::pair<std::uint64_t, std::uint32_t>> found;
  found.reserve(numbers_.size());
  for (const Triangle& triangle : triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(triangle[k], triangle[(k + 1) % 3]);
      found.emplace_back(std::uint64_t{low} << 32U | high,
                         static_cast<std::uint32_t>(found.size()));
    }
  }
  tbb::parallel_sort(found);
  std::vector<CubeBins::Member> members;
  members.reserve(found.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (i > 0 && found[i].first != found[i - 1].first) ++count_;
    numbers_[found[i].second] = static_cast<std::uint32_t>(count_);
    members.emplace_back(count_, found[i].second);
  }
  count_ += found.empty() ? 0 : 1;
  uses_ = CubeBins(count_, members);
}

/// A triangle around a side or a corner.
struct Sector {
  Vector3 normal = Vector3::Zero();
  double angle = 0;  ///< that it takes up
  std::uint32_t triangle = 0;
};

/// Whether a way leads away from all directions, or towards them by no more than the slack.
bool leads_away(const Vector3& way, std::span<const Vector3> directions, double slack) {
  return std::all_of(directions.begin(), directions.end(),
                     [&](const Vector3& d) { return d.dot(way) <= slack; });
}

/// The part of a polygon of ways that leads away from a direction, or towards it by no more than
/// the slack, as its angle's cosine.
std::vector<Vector3> clipped(const std::vector<Vector3>& polygon, const Vector3& direction,
                             double slack) {
  std::vector<Vector3> kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vector3 &from = polygon[i], &to = polygon[(i + 1) % polygon.size()];
    const double start = direction.dot(from) - slack * from.norm(),
                 end = direction.dot(to) - slack * to.norm();
    if (start <= 0) kept.push_back(from);
    if ((start <= 0) != (end <= 0)) kept.emplace_back(from + start / (start - end) * (to - from));
  }
  return kept;
}

/// The same by cutting each side of a cube of ways: with the edges come ways in between, where the
/// cone passes from one side to the next.
std::vector<Vector3> clipped_cone(std::span<const Vector3> directions, double slack) {
  std::vector<Vector3> edges;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      std::vector<Vector3> polygon;
      for (const auto& [x, y] : {std::pair(-1, -1), {1, -1}, {1, 1}, {-1, 1}}) {
        Vector3 way;
        way[axis] = side;
        way[(axis + 1) % 3] = x;
        way[(axis + 2) % 3] = y;
        polygon.push_back(way);
      }
      for (const Vector3& direction : directions) polygon = clipped(polygon, direction, slack);
      for (const Vector3& way : polygon) edges.push_back(way.normalized());
    }
  }
  return edges;
}

/// The edges of the cone of ways that lead away from all directions, or nearly: each is
/// perpendicular to two of them.
std::vector<Vector3> cone_edges(std::span<const Vector3> directions, double slack) {
  if (directions.size() > most_paired) return clipped_cone(directions, slack);
  std::vector<Vector3> edges;
  for (std::size_t i = 0; i < directions.size(); ++i) {
    for (std::size_t k = i + 1; k < directions.size(); ++k) {
      const Vector3 across = directions[i].cross(directions[k]);
      if (!(across.norm() > rounding)) continue;
      for (const Vector3& way : {Vector3(across.normalized()), Vector3(-across.normalized())}) {
        if (leads_away(way, directions, slack)) edges.push_back(way);
      }
    }
  }
  return edges;
}

/// A direction in which a place lies whose nearest point of a cone is its tip, well within all of
/// these; empty where there is none or where they are all but one line.
std::optional<Vector3> away_from(std::span<const Vector3> directions) {
  Vector3 sum = Vector3::Zero();
  for (const Vector3& direction : directions) sum -= direction;
  if (sum.norm() > rounding && leads_away(sum.normalized(), directions, rounding)) {
    return sum.normalized();
  }
  Vector3 edges = Vector3::Zero();
  for (const Vector3& edge : cone_edges(directions, rounding)) edges += edge;
  if (!(edges.norm() > rounding)) return std::nullopt;
  return edges.normalized();
}

/// Whether all normals around face nearly the same way.
bool is_flat(std::span<const Sector> around) {
  Vector3 axis = Vector3::Zero();
  for (const Sector& sector : around) axis += sector.angle * sector.normal;
  if (!(axis.norm() > 0)) return false;
  axis.normalize();
  return std::all_of(around.begin(), around.end(), [&](const Sector& sector) {
    return sector.normal == Vector3::Zero() || sector.normal.dot(axis) > flat_cosine;
  });
}

/// The triangles at each side and each corner.
class Neighbours {
 public:
  Neighbours(const OuterSurface& surface, const TriangleSides& sides, const AskedSolid& asked)
      : surface_(surface),
        asked_(asked),
        sides_(sides),
        normals_(surface.triangles.size()),
        faces_(surface.triangles.size()),
        thin_(surface.triangles.size()) {
    std::vector<CubeBins::Member> members;
    members.reserve(3 * surface.triangles.size());
    for (std::uint32_t t = 0; t < surface.triangles.size(); ++t) {
      for (const std::uint32_t corner : surface.triangles[t]) members.emplace_back(corner, t);
    }
    corners_ = CubeBins(surface.vertices.size(), members);
    tbb::parallel_for(std::size_t{0}, surface.triangles.size(), [&](std::size_t t) {
      const Triangle& triangle = surface.triangles[t];
      const Vector3& a = surface.vertices[triangle[0]];
      const Vector3& b = surface.vertices[triangle[1]];
      const Vector3& c = surface.vertices[triangle[2]];
      const Vector3 cross = (b - a).cross(c - a);
      const double length = cross.norm();
      thin_[t] = triangle_height(a, b, c) <= asked_.thin ? 1 : 0;
      normals_[t] = length > 0 ? Vector3(cross / length) : Vector3::Zero();
      const Vector3 middle = (a + b + c) / 3;
      faces_[t] = across(middle, normals_[t], displacement_of(t));
      // Walls that were moved so far may have passed each other anywhere.
      if (asked_.displacement <= asked_.thin || faces_[t] != FeatureSide::by_normal) return;
      for (const Vector3& place : places_of(t)) {
        if (inside_at(place, normals_[t], displacement_of(t)) == true ||
            inside_at(place, -normals_[t], displacement_of(t)) == false) {
          faces_[t] = FeatureSide::by_crossings;
        }
      }
    });
    // In front of a face that crosses others are both sides.
    for (const auto& [one, other] :
         meeting_pairs(surface.vertices, surface.triangles, 0).crossing) {
      faces_[one] = faces_[other] = FeatureSide::by_crossings;
    }
    // Another face may lie on a part of one, as in a gap that ends in a wedge; and in front of one
    // at an open side is what closed it.
    std::vector<std::atomic<bool>> covered(surface.triangles.size());
    tbb::parallel_for(std::size_t{0}, covered.size(), [&](std::size_t t) {
      if (surface.sides && surface.sides->doubtful[t] != 0) covered[t] = true;
      for (const std::uint32_t other : on_places_of(t)) covered[t] = covered[other] = true;
    });
    for (std::size_t t = 0; t < covered.size(); ++t) {
      if (covered[t]) faces_[t] = FeatureSide::by_crossings;
    }
  }

  [[nodiscard]] FeatureSide at_face(std::uint32_t t) const { return faces_[t]; }

  /// Of a triangle's k-th side. Thin triangles that hang on one that is not are in nobody's way
  /// there.
  [[nodiscard]] FeatureSide at_side(std::uint32_t triangle, std::size_t k) const {
    const std::uint32_t a = surface_.triangles[triangle][k],
                        b = surface_.triangles[triangle][(k + 1) % 3];
    const Vector3 along = (surface_.vertices[b] - surface_.vertices[a]).normalized();
    if (!is_closed(triangle, k)) return FeatureSide::by_crossings;
    std::vector<Sector> around;
    std::vector<Vector3> directions;
    bool simple = is_paired(triangle, k);
    for (const std::uint32_t number : sides_.uses(triangle, k)) {
      const std::uint32_t t = TriangleSides::use(number).triangle;
      around.push_back({normals_[t], 1, t});
      // Beside a face that lies near another one, a part of a side may lie in the gap between them.
      if (surface_.sides && faces_[t] != FeatureSide::by_normal) return FeatureSide::by_crossings;
      if (thin_[t] > thin_[triangle]) {
        // Where parts nearly touch, what is beside them may be beyond the thin one.
        if (surface_.sides) return FeatureSide::by_crossings;
        simple = false;
        continue;
      }
      const Vector3 to = surface_.vertices[other(t, a, b)] - surface_.vertices[a];
      const Vector3 across = to - along.dot(to) * along;
      if (across.norm() > 0) directions.push_back(across.normalized());
    }
    directions.push_back(along);
    directions.push_back(-along);
    const Vector3 middle = (surface_.vertices[a] + surface_.vertices[b]) / 2;
    return side_of(around, directions, simple, middle, along);
  }

  [[nodiscard]] FeatureSide at_corner(std::uint32_t vertex) const {
    std::vector<Sector> around;
    std::vector<Vector3> directions;
    bool simple = true;
    const auto triangles = corners_.of(vertex, vertex);
    if (triangles.empty()) return {};
    for (const std::uint32_t t : triangles) {
      const Triangle& triangle = surface_.triangles[t];
      const auto k = static_cast<std::size_t>(std::find(triangle.begin(), triangle.end(), vertex) -
                                              triangle.begin());
      if (!is_closed(t, k) || !is_closed(t, (k + 2) % 3)) return FeatureSide::by_crossings;
      const std::uint32_t next = triangle[(k + 1) % 3], last = triangle[(k + 2) % 3];
      const Vector3 to_next = surface_.vertices[next] - surface_.vertices[vertex];
      const Vector3 to_last = surface_.vertices[last] - surface_.vertices[vertex];
      around.push_back(
          {normals_[t], std::atan2(to_next.cross(to_last).norm(), to_next.dot(to_last)), t});
      if (to_next.norm() > 0) directions.push_back(to_next.normalized());
      simple = simple && is_paired(t, k) && is_paired(t, (k + 2) % 3);
    }
    return side_of(around, directions, simple && is_one_fan(vertex), surface_.vertices[vertex]);
  }

 private:
  const OuterSurface& surface_;
  AskedSolid asked_;
  const TriangleSides& sides_;
  CubeBins corners_;  ///< the triangles of each vertex
  std::vector<Vector3> normals_;
  std::vector<FeatureSide> faces_;
  std::vector<char> thin_;  ///< so that their normals mean nothing

  /// m: between a triangle and the solid.
  [[nodiscard]] double displacement_of(std::size_t triangle) const {
    return asked_.displacement + (asked_.moved.empty() ? 0 : asked_.moved[triangle]);
  }
  [[nodiscard]] double displacement_of(std::span<const Sector> around) const {
    double most = asked_.displacement;
    for (const Sector& sector : around) most = std::max(most, displacement_of(sector.triangle));
    return most;
  }

  /// Places of a face, none of them at its border.
  [[nodiscard]] std::array<Vector3, 7> places_of(std::size_t t) const {
    std::array<Vector3, 7> places;
    const auto corner = [&](std::size_t k) {
      return surface_.vertices[surface_.triangles[t][k % 3]];
    };
    places[6] = (corner(0) + corner(1) + corner(2)) / 3;
    for (std::size_t k = 0; k < 3; ++k) {
      places[k] = 0.9 * corner(k) + 0.1 * places[6];
      places[3 + k] = 0.45 * (corner(k) + corner(k + 1)) + 0.1 * places[6];
    }
    return places;
  }
  /// Faces that pass a place of one and face the other way.
  [[nodiscard]] std::vector<std::uint32_t> on_places_of(std::size_t t) const {
    constexpr double opposite = -0.98;
    std::vector<std::uint32_t> found, near;
    for (const Vector3& place : places_of(t)) {
      asked_.surface.within(place, surface_.sides ? surface_.sides->gap : asked_.thin, near);
      std::copy_if(near.begin(), near.end(), std::back_inserter(found), [&](std::uint32_t other) {
        return other != t && normals_[other].dot(normals_[t]) < opposite;
      });
    }
    return found;
  }

  /// Whether places beside one on the surface, which is so far from the solid, are inside. Empty
  /// where something else is nearer.
  [[nodiscard]] std::optional<bool> inside_at(const Vector3& place, const Vector3& away,
                                              double displacement) const {
    for (const double share : beside) {
      const double way = share * asked_.tolerance;
      if (way < least_displacements * displacement) break;
      const Vector3 there = place + way * away;
      const ClosestPoint closest = asked_.solid.closest(there);
      const double off = std::abs(std::abs(closest.solid) - way);
      if (off > displacement + blurred_away * way) continue;
      // Another sheet of the solid may be nearer by so much.
      if (off > surely_nearest * way &&
          std::abs(asked_.surface.closest(there).solid) < (1 - blurred_away) * way - rounding) {
        continue;
      }
      return closest.solid < 0;
    }
    return std::nullopt;
  }

  /// A normal tells the side, but where its triangle is folded or was turned over by rounding.
  [[nodiscard]] FeatureSide across(const Vector3& place, const Vector3& normal,
                                   double displacement) const {
    const std::optional<bool> above = inside_at(place, normal, displacement),
                              below = inside_at(place, -normal, displacement);
    const bool told = above.has_value() || below.has_value();
    return told && !above.value_or(false) && below.value_or(true) ? FeatureSide::by_normal
                                                                  : FeatureSide::by_crossings;
  }

  /// Ways from a part to places that are nearest to it, also to those that are so by rounding.
  /// `away` leads well away from all directions, where there is such a way; `along` is that of a
  /// side.
  [[nodiscard]] static std::vector<Vector3> ways_from(const std::optional<Vector3>& away,
                                                      const Vector3& along,
                                                      std::span<const Vector3> directions) {
    std::vector<Vector3> ways = cone_edges(directions, blurred);
    for (const double turn : turns) {
      if (!away || (turn != 0 && along == Vector3::Zero())) break;
      const Vector3 way = std::cos(turn) * *away + std::sin(turn) * along.cross(*away);
      if (leads_away(way, directions, rounding)) ways.push_back(way);
    }
    return ways;
  }

  [[nodiscard]] FeatureSide side_of(std::span<const Sector> around,
                                    std::span<const Vector3> directions, bool simple,
                                    const Vector3& place,
                                    const Vector3& along = Vector3::Zero()) const {
    if (simple && is_flat(around)) {
      const bool plain = std::all_of(around.begin(), around.end(), [&](const Sector& sector) {
        return faces_[sector.triangle] == FeatureSide::by_normal;
      });
      return plain ? FeatureSide::by_normal : FeatureSide::by_crossings;
    }
    const double displacement = displacement_of(around);
    bool inside = false, outside = false;
    for (const Vector3& way : ways_from(away_from(directions), along, directions)) {
      if (const auto is_there = inside_at(place, way, displacement)) {
        (*is_there ? inside : outside) = true;
      }
    }
    // On both sides where a sliver was folded by rounding; on none where something else is nearer.
    if (inside == outside) return FeatureSide::by_crossings;
    return inside ? FeatureSide::inside : FeatureSide::outside;
  }

  [[nodiscard]] std::uint32_t other(std::uint32_t t, std::uint32_t a, std::uint32_t b) const {
    for (const std::uint32_t corner : surface_.triangles[t]) {
      if (corner != a && corner != b) return corner;
    }
    return a;
  }

  /// Whether a side is passed as often one way as the other.
  [[nodiscard]] bool is_closed(std::uint32_t triangle, std::size_t k) const {
    const auto uses = sides_.uses(triangle, k);
    const std::uint32_t first = from(uses[0]);
    return 2 * std::count_if(uses.begin(), uses.end(),
                             [&](std::uint32_t use) { return from(use) == first; }) ==
           std::ssize(uses);
  }

  /// Two triangles that pass the side in opposite ways.
  [[nodiscard]] bool is_paired(std::uint32_t triangle, std::size_t k) const {
    const auto both = sides_.uses(triangle, k);
    return both.size() == 2 && from(both[0]) != from(both[1]) &&
           TriangleSides::use(both[0]).triangle != TriangleSides::use(both[1]).triangle;
  }
  /// The corner that a side leads from.
  [[nodiscard]] std::uint32_t from(std::uint32_t number) const {
    const auto [t, k] = TriangleSides::use(number);
    return surface_.triangles[t][k];
  }

  /// Whether going from triangle to triangle around a corner meets all of them.
  [[nodiscard]] bool is_one_fan(std::uint32_t vertex) const {
    const auto all = corners_.of(vertex, vertex);
    std::uint32_t triangle = all.front();
    for (std::size_t met = 1; met <= all.size(); ++met) {
      const Triangle& corners = surface_.triangles[triangle];
      const auto k = static_cast<std::size_t>(std::find(corners.begin(), corners.end(), vertex) -
                                              corners.begin());
      const auto both = sides_.uses(triangle, (k + 2) % 3);
      const std::uint32_t first = TriangleSides::use(both[0]).triangle;
      triangle = first == triangle ? TriangleSides::use(both[1]).triangle : first;
      if (triangle == all.front()) return met == all.size();
    }
    return false;
  }
};

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

/// Leaves to crossings what a side tells, where narrow triangles lead to another that tells another
/// thing: near the corner at which both end, single precision takes one for the other. `sides` are
/// those of each triangle (find_feature_sides).
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

}  // namespace

std::vector<bool> find_folded(const std::vector<Triangle>& triangles) {
  // Their corners in ascending order, and whether they pass these the other way.
  std::vector<std::tuple<Triangle, bool, std::uint32_t>> same(triangles.size());
  tbb::parallel_for(std::size_t{0}, triangles.size(), [&](std::size_t t) {
    Triangle corners = triangles[t];
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    const bool turned = corners[1] > corners[2];
    if (turned) std::swap(corners[1], corners[2]);
    same[t] = {corners, turned, static_cast<std::uint32_t>(t)};
  });
  tbb::parallel_sort(same);
  std::vector<bool> folded(triangles.size(), false);
  for (auto first = same.begin(); first != same.end();) {
    auto last = std::next(first);
    while (last != same.end() && std::get<0>(*last) == std::get<0>(*first)) ++last;
    if (std::get<1>(*first) != std::get<1>(*std::prev(last))) {
      for (; first != last; ++first) folded[std::get<2>(*first)] = true;
    }
    first = last;
  }
  return folded;
}

std::vector<FeatureSides> find_feature_sides(const OuterSurface& surface, const AskedSolid& asked) {
  const TriangleSides uses(surface.triangles);
  const Neighbours neighbours(surface, uses, asked);
  std::vector<FeatureSide> corners(surface.vertices.size());
  tbb::parallel_for(std::size_t{0}, corners.size(), [&](std::size_t vertex) {
    corners[vertex] = neighbours.at_corner(static_cast<std::uint32_t>(vertex));
  });
  std::vector<FeatureSides> sides(surface.triangles.size(), 0);
  tbb::parallel_for(std::size_t{0}, sides.size(), [&](std::size_t number) {
    const auto t = static_cast<std::uint32_t>(number);
    sides[t] = pack_side(TriangleFeature::face, neighbours.at_face(t));
    for (unsigned k = 0; k < 3; ++k) {
      const auto side = static_cast<TriangleFeature>(1 + k);
      const auto corner = static_cast<TriangleFeature>(4 + k);
      sides[t] = static_cast<FeatureSides>(sides[t] | pack_side(side, neighbours.at_side(t, k)) |
                                           pack_side(corner, corners[surface.triangles[t][k]]));
    }
  });
  cross_beside_narrow(surface, uses, sides);
  return sides;
}

}  // namespace spm::baker
