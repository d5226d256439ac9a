// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <span>

#include "common/asset/asset_view.hpp"

namespace spm {

enum class Status : std::uint8_t {
  exact,  ///< in the band
  deep,  ///< inside, beyond the band: distance is -max_depth, a bound; the normal is the best known
  far,   ///< outside, beyond the margin: distance NaN, normal zero
  pruned,  ///< in a region that the bake left out: distance NaN, normal zero
};

/// Whether a distance and a normal are told.
[[nodiscard]] constexpr bool is_known(Status status) noexcept {
  return status == Status::exact || status == Status::deep;
}

enum class Source : std::uint8_t { map, triangles, none };

/// Answer of a query at a point.
struct Answer {
  double distance = 0;               ///< signed, m, negative inside
  Vector3 normal = Vector3::Zero();  ///< unit, outward
  std::int32_t plane = -1;           ///< row of the plane table, -1 for triangles
  std::int32_t layer = -1;           ///< of `full`: crossing along the plane's ray, from 0
  Source source = Source::none;
  Status status = Status::far;
};

/// The answer where nothing is known: distance NaN, and the status.
[[nodiscard]] inline Answer unanswered(Status status) noexcept {
  Answer answer;
  answer.distance = std::numeric_limits<double>::quiet_NaN();
  answer.status = status;
  return answer;
}

/// Signed distance, normal, plane and layer at a point in the asset's frame (metres): the product's
/// `spm` query. Bounded time: one look-up in the octree, then a distance map, or two, or a
/// list of bounded length. A NaN or infinite point answers `far`. Never throws,
/// allocates or reads outside the views.
[[nodiscard]] Answer query_point(const AssetView& asset, const Vector3& point) noexcept;

/// How far the surface is at least, m, 0 or more, where the answer is `far`; 0 where it is not.
/// `sparse` only. In constant time, and so coarse: about the edge of a root of the octree too
/// small.
[[nodiscard]] double clearance(const AssetView& asset, const Vector3& point) noexcept;

/// The same answers for as many points as there are answers, but faster where they are far apart:
/// while some wait for memory, others are computed.
void query_points(const AssetView& asset, std::span<const Vector3> points,
                  std::span<Answer> answers) noexcept;

}  // namespace spm
