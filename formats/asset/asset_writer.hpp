// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "common/base/error.hpp"
#include "formats/asset/asset.hpp"

namespace spm {

/// Sizes of the parts of a written file, bytes.
struct AssetBytes {
  std::uint64_t total = 0;
  std::uint64_t samples = 0;    ///< payload of the parts `heights...`
  std::uint64_t grid = 0;       ///< payload of the parts `grid...`
  std::uint64_t triangles = 0;  ///< payload of the parts `triangles...`
};

/// Writes an asset as a standard multi-part EXR: to a temporary file beside `path`, which is synced
/// and then renamed. The bytes depend on the asset alone. Errors: file_or_device, with nothing left
/// behind; unsupported (check_host).
[[nodiscard]] Result<AssetBytes> write_asset(const Asset& asset, const std::string& path);

/// Rejects an output path that could not be written later: its folder is missing or not writable,
/// or the path is a directory. Called before a bake begins.
[[nodiscard]] Result<void> check_output_path(const std::string& path);

/// The most that the file of a `sparse` asset takes besides the words of its octree and its exact
/// triangles, bytes.
[[nodiscard]] std::uint64_t bytes_without_octree(const Asset& asset);

}  // namespace spm
