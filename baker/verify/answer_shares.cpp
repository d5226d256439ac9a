// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/verify/answer_shares.hpp"

#include <cmath>

#include "common/field/octree_leaves.hpp"
#include "common/query/query.hpp"

namespace spm::baker {

namespace {

constexpr int tries = 3;  ///< places in a leaf along each axis

double& share_of(const AssetView& view, const Leaf& leaf, AnswerShares& shares) {
  if (leaf.kind == OctreeKind::list) return shares.triangles;
  const std::uint32_t* words = words_at(view.octree, leaf);
  return words != nullptr && NamedMaps(words[0]).two() ? shares.two_maps : shares.one_map;
}

AnswerShares of_all(const AnswerShares& of) {
  const double all = of.one_map + of.two_maps + of.triangles;
  if (!(all > 0)) return {};
  return {of.one_map / all, of.two_maps / all, of.triangles / all};
}

}  // namespace

SharesOfPlaces shares_of_places(const AssetView& view) {
  SharesOfPlaces found;
  visit_leaves(view.octree, [&](const Leaf& leaf) {
    if (!has_answers(leaf.kind)) return;
    // Each place stands for a cube around it, and near the surface for what that has of it.
    const double half = leaf.half / tries, area = 4 * half * half;
    double &in_band = share_of(view, leaf, found.band),
           &at_surface = share_of(view, leaf, found.surface);
    for (int k = 0; k < tries * tries * tries; ++k) {
      const int x = k % tries, y = k / tries % tries, z = k / (tries * tries);
      const Answer answer = query_point(
          view, leaf.middle + half * (2 * Vector3(x, y, z) - Vector3::Constant(tries - 1)));
      if (answer.status != Status::exact) continue;
      in_band += 2 * half * area;
      if (std::abs(answer.distance) <= half) at_surface += area;
    }
  });
  return {of_all(found.band), of_all(found.surface)};
}

}  // namespace spm::baker
