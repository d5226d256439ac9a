// SPDX-License-Identifier: Apache-2.0
#include "common/paper/map_noise.hpp"

#include "common/base/random.hpp"

namespace spm {

namespace {

double sample_noise(std::uint64_t seed, std::uint64_t sample) noexcept {
  return normal_of(random_unit(seed, 2 * sample), random_unit(seed, 2 * sample + 1));
}

}  // namespace

double map_noise(const AssetView& asset, std::size_t plane, const Vector3& point,
                 std::uint64_t seed) noexcept {
  if (!asset.maps_every_plane() || plane >= asset.planes.size()) return 0;
  const DistanceMap& map = asset.maps[plane];
  const PlaneCoordinates place = project_on_plane(asset.planes[plane], point);
  const MapCell cell = locate(map, place.eta, place.omega);
  if (!cell.inside) return 0;
  const std::uint64_t of_plane = random_bits(seed, plane);
  const auto at = [&](std::uint32_t right, std::uint32_t up) {
    return sample_noise(of_plane, std::uint64_t{cell.row + up} * map.columns + cell.column + right);
  };
  const double near_row = (1 - cell.fx) * at(0, 0) + cell.fx * at(1, 0);
  const double far_row = (1 - cell.fx) * at(0, 1) + cell.fx * at(1, 1);
  return (1 - cell.fy) * near_row + cell.fy * far_row;
}

}  // namespace spm
