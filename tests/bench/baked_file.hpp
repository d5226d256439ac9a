// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>

#include "baker/mesh.hpp"
#include "common/asset_view.hpp"
#include "formats/mapped_asset.hpp"

namespace spm::bench {

/// An asset that the product baked and wrote, for methods that open it.
struct BakedFile {
  std::string path;
  std::string settings;  ///< for a person, such as "tolerance 100 um"
  double tolerance = 0;  ///< m; 0 of a `full` asset
  std::uint64_t bytes = 0;
  double seconds = 0;  ///< to bake and write it
};

/// The product's own form. Throws BakeError, as all of them.
[[nodiscard]] BakedFile bake_sparse(const baker::Mesh& mesh, const Band& band, double tolerance,
                                    const std::string& folder);

/// The paper's form: one scalar map of resolution x resolution samples a support plane.
[[nodiscard]] BakedFile bake_full(const baker::Mesh& mesh, const Band& band, std::size_t planes,
                                  std::uint32_t resolution, const std::string& folder);

/// Of a `full` asset, what the paper's rule may read: planes and maps. Defined with that method.
[[nodiscard]] std::uint64_t paper_bytes(const MappedAsset& asset);

}  // namespace spm::bench
