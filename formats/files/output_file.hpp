// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "common/base/error.hpp"

namespace spm {

/// A file that appears under its name completely or not at all. It is written under a temporary
/// name beside the target, synced, then renamed over it. Without `commit` the destructor removes
/// it. Move-only. All errors: file_or_device.
class OutputFile {
 public:
  [[nodiscard]] static Result<OutputFile> create(const std::string& path);
  OutputFile(OutputFile&& other) noexcept;
  OutputFile& operator=(OutputFile&& other) noexcept;
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;
  ~OutputFile();

  /// Writes all of `bytes` at an offset from the start.
  [[nodiscard]] Result<void> write_at(std::uint64_t offset, std::span<const std::byte> bytes);

  /// Open for reading and writing; owned by this object.
  [[nodiscard]] int descriptor() const noexcept { return descriptor_; }

  /// Syncs, renames over the target and syncs the folder.
  [[nodiscard]] Result<void> commit();

 private:
  OutputFile(std::string path, std::string temporary, int descriptor) noexcept;
  void discard() noexcept;

  std::string path_;
  std::string temporary_;
  int descriptor_ = -1;
};

/// Writes a whole file in the way of OutputFile.
[[nodiscard]] Result<void> write_file(const std::string& path, std::string_view content);

}  // namespace spm
