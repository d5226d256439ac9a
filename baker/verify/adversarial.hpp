// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "baker/verify/exact_surface.hpp"
#include "common/asset/asset_view.hpp"

namespace spm::baker {

/// Places where an asset is likeliest to be wrong: about edges and corners of the exact surface,
/// close to it all over, beside the borders of the asset's tiles and cells, and where parts of the
/// asset's triangles are equally near. Immutable; any number of threads may use it.
class AdversarialPlaces {
 public:
  /// Keeps references to the surface and the asset. `tolerance` in metres.
  AdversarialPlaces(const ExactSurface& surface, const AssetView& view, double tolerance);

  /// Seed and index alone determine it. It lies near or in the band, up to a few tolerances or the
  /// band's depth away from these features.
  [[nodiscard]] Vector3 at(std::uint64_t seed, std::uint64_t index) const;

 private:
  class Draw;

  const ExactSurface& surface_;
  const AssetView& view_;
  double tolerance_;
  /// The triangles around each corner of the asset's: those of corner i from around_[first_[i]] on.
  std::vector<std::uint32_t> first_, around_;

  [[nodiscard]] Vector3 about_edge(const Draw& draw) const;
  [[nodiscard]] Vector3 beside_piece(const Draw& draw) const;
  [[nodiscard]] Vector3 at_ends_of_cones(const Draw& draw) const;
};

}  // namespace spm::baker
