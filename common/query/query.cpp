// SPDX-License-Identifier: Apache-2.0
#include "common/query/query.hpp"

#include <algorithm>
#include <array>

#include "common/query/full_query.hpp"
#include "common/query/octree_query.hpp"

namespace spm {

Answer query_point(const AssetView& asset, const Vector3& point) noexcept {
  Answer answer = asset.full ? query_full(asset, point) : query_octree(asset, point);
  apply_band(asset, answer);
  return answer;
}

void query_points(const AssetView& asset, std::span<const Vector3> points,
                  std::span<Answer> answers) noexcept {
  const std::size_t count = std::min(points.size(), answers.size());
  if (asset.full) {
    for (std::size_t i = 0; i < count; ++i) answers[i] = query_point(asset, points[i]);
    return;
  }
  // Leaves of the next points are on their way from memory while this one is computed.
  constexpr std::size_t ahead = 8;
  std::array<Leaf, ahead> leaves;
  const auto look_up = [&](std::size_t i) {
    leaves[i % ahead] = leaf_at(asset.octree, points[i]);
    prefetch(asset.octree, leaves[i % ahead]);
  };
  for (std::size_t i = 0; i < std::min(ahead - 1, count); ++i) look_up(i);
  for (std::size_t i = 0; i < count; ++i) {
    if (i + ahead - 1 < count) look_up(i + ahead - 1);
    answers[i] = query_leaf(asset, leaves[i % ahead], points[i]);
    apply_band(asset, answers[i]);
  }
}

}  // namespace spm
