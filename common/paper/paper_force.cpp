// SPDX-License-Identifier: Apache-2.0
#include "common/paper/paper_force.hpp"

#include <cmath>
#include <limits>

namespace spm {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// One binary for every CPU that uses wide instructions where there are any. Sanitizers cannot start
// through ifuncs.
#if defined(__x86_64__) && !defined(__SANITIZE_THREAD__) && !defined(__SANITIZE_ADDRESS__)
#define SPM_WIDE [[gnu::target_clones("avx2", "default")]]
#else
#define SPM_WIDE
#endif

constexpr std::size_t lanes = 16;

/// The least offset - n . p over all planes, and its index; lane by lane, so that it vectorises.
SPM_WIDE std::size_t argmin_depth(const double* nx, const double* ny, const double* nz,
                                  const double* offset, std::size_t count, double x, double y,
                                  double z) noexcept {
  double best[lanes];
  double where[lanes];
  for (std::size_t lane = 0; lane < lanes; ++lane) {
    best[lane] = infinity;
    where[lane] = 0;
  }
  std::size_t block = 0;
  for (; block + lanes <= count; block += lanes) {
    const double first = static_cast<double>(block);
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      const std::size_t i = block + lane;
      const double depth = offset[i] - (nx[i] * x + ny[i] * y + nz[i] * z);
      const bool less = depth < best[lane];
      best[lane] = less ? depth : best[lane];
      where[lane] = less ? first : where[lane];
    }
  }
  double least = infinity;
  std::size_t index = 0;
  for (std::size_t lane = 0; lane < lanes; ++lane) {
    const std::size_t i = static_cast<std::size_t>(where[lane]) + lane;
    if (best[lane] < least || (best[lane] == least && i < index)) {
      least = best[lane];
      index = i;
    }
  }
  for (std::size_t i = block; i < count; ++i) {
    const double depth = offset[i] - (nx[i] * x + ny[i] * y + nz[i] * z);
    if (depth < least) {
      least = depth;
      index = i;
    }
  }
  return index;
}

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
  return argmin_depth(asset.plane_nx.data(), asset.plane_ny.data(), asset.plane_nz.data(),
                      asset.plane_offset.data(), asset.plane_offset.size(), point.x(), point.y(),
                      point.z());
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

PaperContact paper_contact(const AssetView& asset, const Vector3& point, PaperRule rule) noexcept {
  if (!asset.maps_every_plane()) return {};
  switch (rule) {
    case PaperRule::closest_surface:
      return closest_surface(asset, point);
    case PaperRule::all_planes:
      return all_planes(asset, point);
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
