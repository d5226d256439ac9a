// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "common/base/error.hpp"

namespace spm {

/// What a file is until it is committed.
enum class WhileOpen {
  nameless,  ///< nobody sees it, and a process that is killed leaves nothing
  named,     ///< others can watch it grow under a temporary name, which a killed process leaves
};

/// A file that appears under its name completely or not at all. It is written without a name, or
/// under a temporary one where the file system has no such files, in the target's folder, synced,
/// then renamed over the target. Without `commit` the destructor removes it. Move-only. All errors:
/// file_or_device.
class OutputFile {
 public:
  [[nodiscard]] static Result<OutputFile> create(const std::string& path,
                                                 WhileOpen while_open = WhileOpen::nameless);
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
  [[nodiscard]] bool give_name();

  std::string path_;
  std::string temporary_;  ///< empty while the file has no name
  int descriptor_ = -1;
};

/// Writes a whole file in the way of OutputFile.
[[nodiscard]] Result<void> write_file(const std::string& path, std::string_view content);

}  // namespace spm
