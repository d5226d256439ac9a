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

/// The paper's own data: support planes and one scalar distance map a plane, as a `full` bake makes
/// them, without the partition of space that the product adds and the paper does not know.
class PaperMaps {
 public:
  /// `caster` casts on the surface of `mesh`; as many planes, or as a bake takes by itself;
  /// resolution x resolution samples a plane. Throws BakeError.
  PaperMaps(const baker::Mesh& mesh, const baker::Caster& caster, std::optional<std::size_t> planes,
            std::uint32_t resolution);

  [[nodiscard]] const AssetView& view() const noexcept { return tables_.view(); }

  /// What the rule may read: for the search four doubles a plane, then the planes and their maps'
  /// samples, a float each.
  [[nodiscard]] std::uint64_t bytes() const noexcept;
  [[nodiscard]] double build_seconds() const noexcept { return seconds_; }
  [[nodiscard]] std::string settings() const;

 private:
  std::unique_ptr<Asset> asset_;
  AssetTables tables_;
  double seconds_ = 0;
};

}  // namespace spm::bench
