// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "baker/cast/cast.hpp"
#include "baker/mesh/mesh.hpp"
#include "formats/asset/asset.hpp"

namespace spm::bench {

/// The paper's own data: support planes and one scalar distance map per plane, as a `full` bake
/// makes them, without the partition of space, which the product adds and the paper does not have.
class PaperMaps {
 public:
  /// `caster` casts on the surface of `mesh`. Takes the given number of planes, or the default of
  /// a bake, with resolution x resolution samples per plane. Throws BakeError.
  PaperMaps(const baker::Mesh& mesh, const baker::Caster& caster, std::optional<std::size_t> planes,
            std::uint32_t resolution);

  [[nodiscard]] const AssetView& view() const noexcept { return tables_.view(); }

  /// The memory that the rule may read: four doubles per plane for the search, then the planes and
  /// the samples of their maps, one float each.
  [[nodiscard]] std::uint64_t bytes() const noexcept;
  [[nodiscard]] double build_seconds() const noexcept { return seconds_; }
  [[nodiscard]] std::string settings() const;

 private:
  std::unique_ptr<Asset> asset_;
  AssetTables tables_;
  double seconds_ = 0;
};

}  // namespace spm::bench
