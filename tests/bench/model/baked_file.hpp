// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>

#include "baker/mesh/mesh.hpp"
#include "common/asset/asset_view.hpp"

namespace spm::bench {

/// A `sparse` asset that the product baked and wrote, for methods that open it.
struct BakedFile {
  std::string path;
  std::string settings;  ///< for a person, such as "tolerance 100 um"
  double tolerance = 0;  ///< m
  std::uint64_t bytes = 0;
  double seconds = 0;       ///< to bake and write it
  double open_seconds = 0;  ///< to open it; set by the code that opens it
};

/// The settings of a bake; metres.
struct SparseOptions {
  Band band;
  double tolerance = 1e-4;
  double probe_radius = 0;
};

/// What is known of the file before it is baked: path, settings and tolerance.
[[nodiscard]] BakedFile baked_file(const SparseOptions& options, const std::string& folder);

/// Bakes the product's own file format into `folder`. Throws BakeError.
[[nodiscard]] BakedFile bake_sparse(const baker::Mesh& mesh, const SparseOptions& options,
                                    const std::string& folder);

}  // namespace spm::bench
