// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "baker/cast/cast.hpp"
#include "common/asset/asset_view.hpp"
#include "formats/asset/asset.hpp"

namespace spm::baker {

/// Chooses, for a cell of the partition, the few maps and layers that answer all of it. The choice
/// must agree with the true closest point at every sample point of the cell. Thread-safe once
/// built.
class CellFitter {
 public:
  CellFitter(const AssetView& asset, const GridData& grid, const Caster& caster, const Band& band,
             double tolerance);

  /// Candidate words (see Grid in asset_view.hpp) for the cube around `middle`, tried at a lattice
  /// of its points. False, with nothing chosen, where no choice of maps is good enough.
  [[nodiscard]] bool fit(const Vector3& middle, double edge,
                         std::vector<std::uint32_t>& chosen) const;

 private:
  struct Sample;
  struct Reply;

  void list_candidates();
  /// The grid cell of a point, or -1 outside the grid.
  [[nodiscard]] std::int64_t bin_of(const Vector3& point) const;
  [[nodiscard]] Reply answer(const std::vector<std::uint32_t>& chosen, const Sample& sample) const;
  void list_layer(std::uint32_t which, std::uint32_t layer,
                  std::vector<std::uint64_t>& places) const;
  [[nodiscard]] Sample sample_at(const Vector3& point) const;
  [[nodiscard]] Reply ask(std::uint32_t candidate, const Sample& sample) const;
  [[nodiscard]] Vector3 normal_of(const Reply& reply) const;
  [[nodiscard]] bool agrees(const Reply& reply, const Sample& sample) const;
  [[nodiscard]] bool covers(std::uint32_t candidate, const Vector3& closest_point) const;
  [[nodiscard]] bool holds(const std::vector<std::uint32_t>& chosen, const Sample& sample) const;
  [[nodiscard]] std::vector<std::uint32_t> candidates_of(const std::vector<Sample>& samples) const;
  [[nodiscard]] std::vector<std::uint32_t> choose(const std::vector<std::uint32_t>& candidates,
                                                  const std::vector<Sample>& samples) const;

  const AssetView& asset_;
  const GridData& grid_;
  const Caster& caster_;
  Band band_;
  double tolerance_;
  std::vector<std::uint64_t> starts_;      ///< per grid cell, first of its candidates
  std::vector<std::uint32_t> candidates_;  ///< that have surface in the cell
};

}  // namespace spm::baker
