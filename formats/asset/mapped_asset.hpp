// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "common/asset/asset_view.hpp"
#include "common/base/error.hpp"
#include "formats/asset/asset.hpp"
#include "formats/asset/asset_writer.hpp"

namespace spm {

enum class MapMode {
  file,    ///< the baked file itself is mapped, read-only
  sealed,  ///< copied into a sealed memfd first, for folders that others may write to
};

struct MapOptions {
  MapMode mode = MapMode::file;
  bool prefault = false;  ///< read every page before open returns
  bool lock = false;      ///< mlock the mapping where permitted; `locked()` says whether it was
};

/// State of the file behind a mapping.
enum class AssetState { intact, truncated, edited, replaced, deleted };

[[nodiscard]] const char* to_string(AssetState state) noexcept;

/// A part of the file, for `info`.
struct PartInfo {
  std::string name;
  std::uint32_t width = 0, height = 0, tile_width = 0, tile_height = 0;
  std::vector<std::string> channels;
  std::uint64_t payload_bytes = 0;
};

/// A baked file, fully validated (layout, metadata, every checksum) and mapped. Opening allocates,
/// reads and may fail; after that `view()` is immutable and reads the mapped bytes in place. A page
/// that vanishes under the map (truncation) reads as zeros and sets `lost()`: the first open
/// installs the process-wide SIGBUS guard.
class MappedAsset {
 public:
  /// Errors: file_or_device (cannot be opened or read, a directory), invalid_input (anything that
  /// is not an intact asset of this version), unsupported (a big-endian or 32-bit machine); the
  /// message names file, place, cause and remedy.
  [[nodiscard]] static Result<std::unique_ptr<MappedAsset>> open(const std::string& path,
                                                                 const MapOptions& options = {});
  ~MappedAsset();
  MappedAsset(const MappedAsset&) = delete;
  MappedAsset& operator=(const MappedAsset&) = delete;

  [[nodiscard]] const AssetView& view() const noexcept;
  [[nodiscard]] const AssetMetadata& metadata() const noexcept;
  [[nodiscard]] const std::string& path() const noexcept;
  [[nodiscard]] const std::vector<PartInfo>& parts() const noexcept;
  /// SHA-256 of the whole file, computed at the first call: not for the servo loop.
  [[nodiscard]] const std::string& content_sha256() const noexcept;
  [[nodiscard]] AssetBytes bytes() const noexcept;
  /// Bytes that answers may come from: the file, and the tables that opening adds to it.
  [[nodiscard]] std::uint64_t resident_bytes() const noexcept;
  [[nodiscard]] bool locked() const noexcept;

  /// True once a page of the mapping was lost. Lock-free, callable from the servo loop.
  [[nodiscard]] bool lost() const noexcept;

  /// Checks the file behind the mapping (size, times, inode of the path). Makes system calls: for
  /// the loading thread only. A `sealed` map of a file that changed still reads its old bytes.
  [[nodiscard]] AssetState check_file() const noexcept;

 private:
  struct Implementation;
  explicit MappedAsset(std::unique_ptr<Implementation> implementation) noexcept;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace spm
