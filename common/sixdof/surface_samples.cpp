// SPDX-License-Identifier: Apache-2.0
#include "common/sixdof/surface_samples.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>
#include <utility>

#include "common/sixdof/sample_vectors.hpp"

namespace spm {

namespace {

/// Patches are no larger than this part of the object, so that areas are right for coarse samples
/// as well.
constexpr double coarsest_patch_share = 1.0 / 128;
constexpr std::uint32_t key_bits = 21;  ///< per axis

/// The one of the six axis directions that is closest to a normal.
std::uint32_t way_of(const Vector3& normal) noexcept {
  Eigen::Index axis = 0;
  normal.cwiseAbs().maxCoeff(&axis);
  return static_cast<std::uint32_t>(2 * axis) + (normal[axis] < 0 ? 1 : 0);
}

/// Interleaves the bits of three numbers, so that the eight cubes of a larger one follow each
/// other.
std::uint64_t interleave(const std::array<std::uint32_t, 3>& cell) noexcept {
  std::uint64_t key = 0;
  for (std::uint32_t bit = 0; bit < key_bits; ++bit) {
    for (std::uint32_t axis = 0; axis < 3; ++axis) {
      key |= std::uint64_t{(cell[axis] >> bit) & 1U} << (3 * bit + axis);
    }
  }
  return key;
}

struct Key {
  std::uint32_t way = 0;
  std::uint64_t cube = 0;
  bool operator==(const Key&) const = default;
};

/// A sample while levels are built from the finest up.
struct Cluster {
  Key key;
  Vector3 position = Vector3::Zero();
  std::uint32_t first = 0, count = 0;  ///< of the level below; for the finest, of the patches
  std::uint32_t kept = 0;              ///< the one of them that has this position
  double area = 0;
  Vector3 moment = Vector3::Zero();  ///< area times position
  double square = 0;                 ///< area times square of position
  Vector3 normal = Vector3::Zero();  ///< area times normal
  double radius = 0;                 ///< to the finest samples
  double patch_radius = 0;           ///< to the patches
  double thickness = 0;              ///< of the finest samples, along the normal
};

void add(Cluster& cluster, const Cluster& part) noexcept {
  cluster.area += part.area;
  cluster.moment += part.moment;
  cluster.square += part.square;
  cluster.normal += part.normal;
  ++cluster.count;
}

Cluster cluster_of(const SurfacePatch& patch, const Key& key, const Vector3& origin) noexcept {
  Cluster made;
  made.key = key;
  made.position = vector_of(patch.position) - origin;
  made.area = static_cast<double>(patch.area);
  made.moment = made.area * made.position;
  made.square = made.area * made.position.squaredNorm();
  made.normal = made.area * vector_of(patch.normal);
  return made;
}

/// Joins neighbours with the same key into one cluster; the one nearest to the middle gives its
/// position. `part(i)` is the i-th of `count`.
template <class Part>
std::vector<Cluster> joined(std::size_t count, const Part& part) {
  std::vector<Cluster> level;
  for (std::uint32_t i = 0; i < count; ++i) {
    const Cluster& one = part(i);
    if (level.empty() || level.back().key != one.key) {
      level.emplace_back();
      level.back().key = one.key;
      level.back().first = i;
    }
    add(level.back(), one);
  }
  for (Cluster& cluster : level) {
    const Vector3 middle = cluster.moment / cluster.area;
    double nearest = std::numeric_limits<double>::infinity();
    for (std::uint32_t i = cluster.first; i < cluster.first + cluster.count; ++i) {
      const double off = (part(i).position - middle).squaredNorm();
      if (!(off < nearest)) continue;
      nearest = off;
      cluster.kept = i;
    }
    cluster.position = part(cluster.kept).position;
  }
  return level;
}

void take_up(Cluster& cluster, const Cluster& leaf) noexcept {
  const Vector3 off = leaf.position - cluster.position;
  cluster.radius = std::max(cluster.radius, off.norm());
  cluster.patch_radius = std::max(cluster.patch_radius, off.norm() + leaf.patch_radius);
  const double length = cluster.normal.norm();
  const double along = length > 0 ? cluster.normal.dot(off) / length : off.z();
  cluster.thickness = std::max(cluster.thickness, std::abs(along));
}

/// Propagates the extent of the finest clusters, level by level, to those above.
void measure(std::vector<std::vector<Cluster>>& levels) {
  for (std::size_t finest = 0; finest < levels[0].size(); ++finest) {
    std::size_t below = finest;
    const Cluster& leaf = levels[0][finest];
    for (std::size_t k = 1; k < levels.size(); ++k) {
      // Clusters of a level are in the order of their parts.
      const auto above = std::upper_bound(
          levels[k].begin(), levels[k].end(), below,
          [](std::size_t part, const Cluster& cluster) { return part < cluster.first; });
      Cluster& cluster = *std::prev(above);
      take_up(cluster, leaf);
      below = static_cast<std::size_t>(std::prev(above) - levels[k].begin());
    }
  }
}

/// Radii are rounded up, so that a sphere stored in floats still contains its samples.
float rounded_up(double value, double size) noexcept {
  return value > 0 ? static_cast<float>(value * (1 + 1e-6) + 1e-6 * size) : 0;
}

std::uint16_t packed_thickness(const Cluster& cluster, double radius) noexcept {
  if (!(radius > 0)) return 0;
  // What the packing of the normal turns it by is allowed for.
  constexpr double packed_sine = 1e-4;
  constexpr double most = std::numeric_limits<std::uint16_t>::max();
  return static_cast<std::uint16_t>(
      std::min(most, std::ceil(most * (cluster.thickness / radius + packed_sine))));
}

void emit(SurfaceSamples& samples, const Cluster& cluster, const Vector3& origin, double size,
          bool is_finest) {
  const Vector3 middle = cluster.moment / cluster.area;
  const double variance = std::max(0.0, cluster.square / cluster.area - middle.squaredNorm());
  const Vector3 mean = cluster.normal / cluster.area;
  const double length = mean.norm();
  samples.places.push_back(
      {floats_of(origin + cluster.position), rounded_up(cluster.radius, size)});
  samples.shares.push_back(
      {pack_octahedral(length > 0 ? Vector3(mean / length) : Vector3(Vector3::UnitZ())),
       static_cast<float>(cluster.area)});
  samples.spreads.push_back(
      {floats_of(middle - cluster.position), static_cast<float>(std::sqrt(1.5 * variance))});
  if (is_finest) return;
  samples.children.emplace_back();
  samples.thicknesses.push_back(
      packed_thickness(cluster, static_cast<double>(samples.places.back().radius)));
}

/// Writes the levels breadth first. The child that shares a sample's position comes first.
void write(SurfaceSamples& samples, const std::vector<std::vector<Cluster>>& levels,
           const Vector3& origin, double size, double spacing) {
  std::vector<std::uint32_t> order(levels.back().size()), next;
  std::iota(order.begin(), order.end(), 0U);
  for (std::size_t k = levels.size(); k-- > 0;) {
    SampleLevel level;
    level.first = static_cast<std::uint32_t>(samples.places.size());
    level.count = static_cast<std::uint32_t>(order.size());
    level.spacing = std::ldexp(spacing, static_cast<int>(k));
    next.clear();
    for (const std::uint32_t which : order) {
      const Cluster& cluster = levels[k][which];
      level.bound = std::max(level.bound, cluster.patch_radius);
      emit(samples, cluster, origin, size, k == 0);
      if (k == 0) continue;
      samples.children.back() = {
          level.first + level.count + static_cast<std::uint32_t>(next.size()), cluster.count};
      next.push_back(cluster.kept);
      for (std::uint32_t i = cluster.first; i < cluster.first + cluster.count; ++i) {
        if (i != cluster.kept) next.push_back(i);
      }
    }
    samples.levels.push_back(level);
    order = next;
  }
}

void surround(SurfaceSamples& samples, const Vector3& low, const Vector3& high) noexcept {
  samples.centre = (low + high) / 2;
  for (const SamplePlace& place : samples.places) {
    samples.radius = std::max(samples.radius, (vector_of(place.position) - samples.centre).norm());
  }
}

/// A patch, and the cube that it lies in.
struct Keyed {
  Key key;
  std::uint32_t patch = 0;
  bool operator<(const Keyed& other) const noexcept {
    return std::tie(key.way, key.cube, patch) <
           std::tie(other.key.way, other.key.cube, other.patch);
  }
};

std::vector<Keyed> in_order_of_cubes(const std::vector<SurfacePatch>& patches, const Vector3& low,
                                     double spacing) {
  std::vector<Keyed> order;
  order.reserve(patches.size());
  for (const SurfacePatch& patch : patches) {
    const Vector3 place = (vector_of(patch.position) - low) / spacing;
    std::array<std::uint32_t, 3> cell{};
    for (int axis = 0; axis < 3; ++axis) {
      // Patches of a broken file may lie anywhere, and be no numbers.
      constexpr double last = (1U << key_bits) - 1;
      cell[static_cast<std::size_t>(axis)] =
          place[axis] > 0 ? static_cast<std::uint32_t>(std::min(place[axis], last)) : 0;
    }
    order.push_back({{way_of(vector_of(patch.normal)), interleave(cell)},
                     static_cast<std::uint32_t>(order.size())});
  }
  std::sort(order.begin(), order.end());
  return order;
}

/// The finest samples.
std::vector<Cluster> finest_level(const std::vector<SurfacePatch>& patches, const Vector3& low,
                                  double spacing) {
  const std::vector<Keyed> order = in_order_of_cubes(patches, low, spacing);
  const auto part = [&](std::uint32_t i) {
    return cluster_of(patches[order[i].patch], order[i].key, low);
  };
  std::vector<Cluster> level = joined(order.size(), part);
  for (Cluster& cluster : level) {
    // In the middle, and on the surface.
    const Vector3 middle = cluster.moment / cluster.area;
    const Vector3 normal = vector_of(patches[order[cluster.kept].patch].normal);
    cluster.position = middle - normal * normal.dot(middle - cluster.position);
    for (std::uint32_t i = cluster.first; i < cluster.first + cluster.count; ++i) {
      cluster.patch_radius =
          std::max(cluster.patch_radius, (part(i).position - cluster.position).norm());
    }
  }
  return level;
}

}  // namespace

Result<SurfaceSamples> sample_surface(const AssetView& asset, double spacing) {
  return SurfaceSampler(asset).sample(spacing);
}

Result<SurfaceSamples> SurfaceSampler::sample(double spacing) {
  const Extent extent = extent_of(asset_);
  const double size = extent.size.maxCoeff();
  if (!(spacing > 0) || !(size / spacing < (1U << key_bits))) {
    return fail(ExitCode::usage,
                "surface samples: the spacing must be above 0 and more than a two-millionth of the "
                "object; give a larger one");
  }
  if (const double step = std::min(spacing, coarsest_patch_share * size); step != step_) {
    auto patches = surface_patches(asset_, step);
    if (!patches) return tl::make_unexpected(patches.error());
    patches_ = std::move(*patches);
    step_ = step;
  }
  Vector3 low = vector_of(patches_.front().position), high = low;
  for (const SurfacePatch& patch : patches_) {
    low = low.cwiseMin(vector_of(patch.position));
    high = high.cwiseMax(vector_of(patch.position));
  }
  std::vector<std::vector<Cluster>> levels{finest_level(patches_, low, spacing)};
  while (std::any_of(levels.back().begin(), levels.back().end(),
                     [](const Cluster& cluster) { return cluster.key.cube != 0; })) {
    std::vector<Cluster> parts = levels.back();
    for (Cluster& part : parts) part.key.cube >>= 3U;
    levels.push_back(
        joined(parts.size(), [&](std::uint32_t i) -> const Cluster& { return parts[i]; }));
  }
  measure(levels);
  SurfaceSamples samples;
  for (const Cluster& cluster : levels[0]) samples.area += cluster.area;
  write(samples, levels, low, high.maxCoeff() - low.minCoeff(), spacing);
  surround(samples, low, high);
  samples.places.shrink_to_fit();
  samples.shares.shrink_to_fit();
  samples.spreads.shrink_to_fit();
  samples.children.shrink_to_fit();
  samples.thicknesses.shrink_to_fit();
  return samples;
}

}  // namespace spm
