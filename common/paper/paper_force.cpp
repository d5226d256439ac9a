// SPDX-License-Identifier: Apache-2.0
#include "common/paper/paper_force.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "common/asset/grid_list.hpp"

// Highway compiles what follows once for each kind of processor, by including this file again.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "common/paper/paper_force.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, as it must be.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace spm::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Doubles = hn::CappedTag<double, 8>;

/// The least depth that each lane has met, and the block that it was in.
struct Least {
  hn::Vec<Doubles> best, block;

  HWY_INLINE void add(hn::Vec<Doubles> depth, hn::Vec<Doubles> now) {
    const auto less = hn::Lt(depth, best);
    best = hn::IfThenElse(less, depth, best);
    block = hn::IfThenElse(less, now, block);
  }
};

/// Number of the plane that a point is least deep below; of several the first.
std::size_t find_min_deep(const AssetView& asset, const Vector3& point) {
  const Doubles lanes;
  const std::size_t width = hn::Lanes(lanes);
  const std::size_t count = asset.plane_offset.size();
  const double *nx = asset.plane_nx.data(), *ny = asset.plane_ny.data();
  const double *nz = asset.plane_nz.data(), *offset = asset.plane_offset.data();
  const auto x = hn::Set(lanes, point.x()), y = hn::Set(lanes, point.y());
  const auto z = hn::Set(lanes, point.z());
  const auto depths = [&](std::size_t i) {
    const auto along =
        hn::Add(hn::Add(hn::Mul(hn::LoadU(lanes, nx + i), x), hn::Mul(hn::LoadU(lanes, ny + i), y)),
                hn::Mul(hn::LoadU(lanes, nz + i), z));
    return hn::Sub(hn::LoadU(lanes, offset + i), along);
  };
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const Least none{hn::Set(lanes, infinity), hn::Zero(lanes)};
  // Four that do not wait for each other.
  Least first = none, second = none, third = none, fourth = none;
  const std::size_t blocks = count / (4 * width);
  for (std::size_t block = 0; block < blocks; ++block) {
    const std::size_t i = 4 * width * block;
    const auto now = hn::Set(lanes, static_cast<double>(block));
    first.add(depths(i), now);
    second.add(depths(i + width), now);
    third.add(depths(i + 2 * width), now);
    fourth.add(depths(i + 3 * width), now);
  }
  std::array<double, 4 * hn::MaxLanes(Doubles())> best{}, where{};
  std::size_t at = 0;
  for (const Least* one : {&first, &second, &third, &fourth}) {
    hn::StoreU(one->best, lanes, best.data() + at);
    hn::StoreU(one->block, lanes, where.data() + at);
    at += width;
  }
  double least = infinity;
  std::size_t index = 0;
  for (std::size_t lane = 0; lane < 4 * width; ++lane) {
    const std::size_t i = static_cast<std::size_t>(where[lane]) * 4 * width + lane;
    if (best[lane] < least || (best[lane] == least && i < index)) {
      least = best[lane];
      index = i;
    }
  }
  for (std::size_t i = 4 * width * blocks; i < count; ++i) {
    const double depth = offset[i] - (nx[i] * point.x() + ny[i] * point.y() + nz[i] * point.z());
    if (depth < least) {
      least = depth;
      index = i;
    }
  }
  return index;
}

}  // namespace spm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace spm {

HWY_EXPORT(find_min_deep);

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

PaperContact closest_surface(const AssetView& asset, const Vector3& point) noexcept {
  PaperContact best;
  double least = infinity;
  for (std::size_t i = 0; i < asset.planes.size(); ++i) {
    const PaperContact here = paper_contact_on_plane(asset, i, point);
    const double gap = std::abs(here.plane_depth - here.surface_distance);
    if (gap < least) {
      least = gap;
      best = here;
    }
  }
  return best;
}

PaperContact all_planes(const AssetView& asset, const Vector3& point) noexcept {
  PaperContact best;
  double least = infinity;
  for (std::size_t i = 0; i < asset.planes.size(); ++i) {
    const PaperContact here = paper_contact_on_plane(asset, i, point);
    // A plane whose map does not extend to P_M is ignored. One that the point lies outside of is
    // not.
    if (here.surface_distance == infinity && here.plane_depth > 0) continue;
    if (!here.contact) return {};
    if (here.depth < least) {
      least = here.depth;
      best = here;
    }
  }
  return best;
}

}  // namespace

std::size_t closest_support_plane(const AssetView& asset, const Vector3& point) noexcept {
  return HWY_DYNAMIC_DISPATCH(find_min_deep)(asset, point);
}

// Where only some of the four samples around P_M met the surface, only the nearest sample is used:
// interpolating with a miss would invent a surface.
PaperContact paper_contact_on_plane(const AssetView& asset, std::size_t index,
                                    const Vector3& point) noexcept {
  PaperContact found;
  found.plane = static_cast<std::uint32_t>(index);
  const DistanceMap& map = asset.maps[index];
  const SupportPlane& plane = asset.planes[index];
  const PlaneCoordinates place = project_on_plane(plane, point);
  found.plane_depth = place.depth;
  found.surface_distance = infinity;
  const MapCell cell = locate(map, place.eta, place.omega);
  if (!cell.inside) return found;
  Height height = height_at(map, 0, cell);
  if (!std::isfinite(height.value)) {
    MapCell nearest = cell;
    nearest.column += cell.fx < 0.5 ? 0U : 1U;
    nearest.row += cell.fy < 0.5 ? 0U : 1U;
    height = {map.at(0, nearest.column, nearest.row), 0, 0};
  }
  found.surface_distance = height.value;
  if (!std::isfinite(height.value)) return found;
  found.normal = surface_normal(plane, height.d_eta, height.d_omega).normalized();
  found.contact = found.plane_depth > found.surface_distance;
  found.depth = found.contact ? found.plane_depth - found.surface_distance : 0;
  return found;
}

std::size_t closest_plane_of_cell(const AssetView& asset, const Vector3& point) noexcept {
  const std::uint32_t word = grid_word_at(asset.grid, point);
  std::size_t closest = asset.planes.size();
  double least = infinity;
  if (static_cast<CellKind>(word >> 30U) == CellKind::record && !is_split(word)) {
    const GridList list(asset.grid, word);
    for (std::uint32_t k = 0; k < list.maps(); ++k) {
      const std::size_t map = unpack_candidate(list.map(k)).map;
      if (map >= asset.planes.size()) continue;
      const double depth = support_plane_depth(asset.planes[map], point);
      if (depth > least || (depth == least && map > closest)) continue;
      least = depth;
      closest = map;
    }
  }
  return closest < asset.planes.size() ? closest : closest_support_plane(asset, point);
}

PaperContact paper_contact(const AssetView& asset, const Vector3& point, PaperRule rule) noexcept {
  if (!asset.maps_every_plane()) return {};
  switch (rule) {
    case PaperRule::closest_surface:
      return closest_surface(asset, point);
    case PaperRule::all_planes:
      return all_planes(asset, point);
    case PaperRule::partition:
      return paper_contact_on_plane(asset, closest_plane_of_cell(asset, point), point);
    case PaperRule::closest_plane:
      break;
  }
  return paper_contact_on_plane(asset, closest_support_plane(asset, point), point);
}

double paper_force_magnitude(double stiffness, double plane_depth,
                             double surface_distance) noexcept {
  return stiffness * std::abs(plane_depth - surface_distance);
}

Vector3 paper_force(const PaperContact& contact, double stiffness) noexcept {
  if (!contact.contact) return Vector3::Zero();
  return paper_force_magnitude(stiffness, contact.plane_depth, contact.surface_distance) *
         contact.normal;
}

}  // namespace spm
#endif
