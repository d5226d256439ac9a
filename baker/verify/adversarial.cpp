// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/verify/adversarial.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/base/random.hpp"

namespace spm::baker {

namespace {

constexpr std::uint64_t numbers = 9;  ///< random numbers for each place
/// The shortest offset, and how far the places close to the surface lie, in tolerances.
constexpr double shortest = 0.3;
constexpr double close = 1.5;
/// By how much ways from a corner are turned, rad: as little as rounding does, up to what can be
/// seen.
constexpr double least_turn = 1e-5, most_turn = 1e-2;

/// The numbers of a triangle's corners; false where one is not there.
bool corner_numbers(const IndexedTriangles& mesh, std::size_t triangle,
                    std::array<std::uint32_t, 3>& numbers_of) {
  const std::uint64_t word = long_word(mesh.triangles, triangle);
  for (unsigned k = 0; k < 3; ++k) numbers_of[k] = unpack_third(word, k);
  return std::all_of(numbers_of.begin(), numbers_of.end(),
                     [&](std::uint32_t number) { return number < mesh.corner_count(); });
}

}  // namespace

/// The random numbers of one place.
class AdversarialPlaces::Draw {
 public:
  Draw(std::uint64_t seed, std::uint64_t index) : seed_(seed), first_(numbers * index) {}
  [[nodiscard]] double at(std::uint64_t which) const { return random_unit(seed_, first_ + which); }
  [[nodiscard]] std::size_t below(std::uint64_t which, std::size_t count) const {
    return std::min(static_cast<std::size_t>(at(which) * static_cast<double>(count)), count - 1);
  }

 private:
  std::uint64_t seed_, first_;
};

AdversarialPlaces::AdversarialPlaces(const ExactSurface& surface, const AssetView& view,
                                     double tolerance)
    : surface_(surface), view_(view), tolerance_(tolerance) {
  const IndexedTriangles& mesh = view.exact;
  first_.assign(mesh.corner_count() + 1, 0);
  std::array<std::uint32_t, 3> corners{};
  for (std::size_t t = 0; t < mesh.size(); ++t) {
    if (!corner_numbers(mesh, t, corners)) continue;
    for (const std::uint32_t corner : corners) ++first_[corner + 1];
  }
  for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
  around_.resize(first_.back());
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for (std::size_t t = 0; t < mesh.size(); ++t) {
    if (!corner_numbers(mesh, t, corners)) continue;
    for (const std::uint32_t corner : corners) {
      around_[next[corner]++] = static_cast<std::uint32_t>(t);
    }
  }
}

/// About an edge or a corner of a triangle, at a log-uniform distance.
Vector3 AdversarialPlaces::about_edge(const Draw& draw) const {
  const double kind = draw.at(1);
  const bool corner = kind < 0.25;
  const SurfacePoint start = surface_.at(draw.at(0), corner ? 0 : (kind < 0.5 ? 1 : draw.at(2)),
                                         kind < 0.75 ? draw.at(3) : 0);
  const double longest = std::max(view_.band.max_depth, 2 * shortest * tolerance_);
  const double offset =
      shortest * tolerance_ * std::pow(longest / (shortest * tolerance_), draw.at(4));
  return start.position + offset * direction_of(draw.at(5), draw.at(6));
}

/// Above or below a border of two pieces of a distance map's spline, within the band.
Vector3 AdversarialPlaces::beside_piece(const Draw& draw) const {
  const HeightChart& chart = view_.charts[draw.below(0, view_.charts.size())];
  const double column = 0.5 + static_cast<double>(draw.below(1, chart.columns - 1));
  const double row = 0.5 + draw.at(2) * (chart.rows - 2);
  const Vector3 below = chart_point(chart, view_.planes[chart.plane], column, row);
  const Vector3& n = view_.planes[chart.plane].n;
  MapContact contact;
  const double depth = contact_on(chart, below, contact) ? -contact.penetration : 0;
  const Band& band = view_.band;
  const double height = -band.max_depth + (band.max_depth + band.margin) * draw.at(3);
  return below + (height - static_cast<double>(chart.offset) - depth) * n;
}

/// From a corner of the asset's triangles, just beyond the tolerance, along a normal or an edge of
/// the cone of places that are nearest to the corner: where rounding decides which part is nearest.
Vector3 AdversarialPlaces::at_ends_of_cones(const Draw& draw) const {
  const IndexedTriangles& mesh = view_.exact;
  const std::size_t triangle = draw.below(0, mesh.size());
  const auto corner = static_cast<unsigned>(draw.below(1, 3));
  const std::array<Vector3, 3> corners = corners_of(mesh, triangle);
  const Vector3& start = corners[corner];
  const Vector3 side = corners[(corner + 1) % 3] - start;
  Vector3 other = corners[(corner + 2) % 3] - start;
  const std::uint32_t number = unpack_third(long_word(mesh.triangles, triangle), corner);
  // Of another triangle around the corner, as often as not.
  if (draw.at(2) < 0.5 && number + 1 < first_.size() && first_[number + 1] > first_[number]) {
    const std::size_t which = draw.below(3, first_[number + 1] - first_[number]);
    const std::uint32_t there = around_[first_[number] + which];
    for (const Vector3& end : corners_of(mesh, there)) {
      if (end != start) other = end - start;
    }
  }
  Vector3 way = side.cross(other);
  way = way.norm() > 0 ? Vector3(way.normalized()) : direction_of(draw.at(4), draw.at(5));
  if (draw.at(6) < 0.5) way = -way;
  const double turn = least_turn * std::pow(most_turn / least_turn, draw.at(7));
  way = (way + turn * direction_of(draw.at(4), draw.at(5))).normalized();
  return start + tolerance_ * std::pow(close, draw.at(8)) * way;
}

Vector3 AdversarialPlaces::at(std::uint64_t seed, std::uint64_t index) const {
  const Draw draw(seed, index);
  switch (index % 6) {
    case 0:
    case 1:
      return about_edge(draw);
    case 2:
      if (!view_.charts.empty()) return beside_piece(draw);
      break;
    case 3:
    case 4:
      if (view_.exact.size() > 0) return at_ends_of_cones(draw);
      break;
    default:
      break;
  }
  const SurfacePoint start = surface_.at(draw.at(0), draw.at(1), draw.at(2));
  return start.position + close * tolerance_ * (2 * draw.at(3) - 1) * start.normal;
}

}  // namespace spm::baker
