// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/stat.h>

#include <cstddef>
#include <memory>
#include <span>
#include <string>

#include "common/base/error.hpp"
#include "formats/asset/bus_error_guard.hpp"
#include "formats/asset/mapped_asset.hpp"

namespace spm {

/// A regular file, mapped read-only and guarded against truncation. Its descriptor stays open, so
/// that the file can be checked later. In `sealed` mode the mapping is that of a sealed copy in
/// memory.
class FileMapping {
 public:
  /// Errors: file_or_device.
  [[nodiscard]] static Result<std::unique_ptr<FileMapping>> open(const std::string& path,
                                                                 const MapOptions& options);
  FileMapping(const FileMapping&) = delete;
  FileMapping& operator=(const FileMapping&) = delete;
  ~FileMapping();

  [[nodiscard]] std::span<const std::byte> bytes() const noexcept { return bytes_; }
  [[nodiscard]] bool locked() const noexcept { return locked_; }
  [[nodiscard]] bool lost() const noexcept { return guard_->lost(); }

  /// Reads a byte of every page, so that none faults later.
  void touch() const noexcept;

  /// Stores the position and value of the recorded checksum, for `state`.
  void set_checksum(std::uint64_t digits_at, std::uint64_t checksum) noexcept;

  /// Compares the file with its state when it was opened. Size and modification time decide. The
  /// change time alone proves nothing, because links and permissions change it too. A time stamp
  /// younger than the clock's step hides an edit; then the content is read again and compared by
  /// checksum. The file is checked before its path, because changed bytes matter more than a
  /// changed name.
  [[nodiscard]] AssetState state() noexcept;

 private:
  FileMapping() = default;
  [[nodiscard]] Result<void> map(int descriptor, const MapOptions& options);
  [[nodiscard]] bool content_changed(const struct stat& now) noexcept;

  std::string path_;
  int descriptor_ = -1;
  struct stat opened_ {};
  bool young_ = false;  ///< modified within one clock step of the opening
  std::uint64_t digits_at_ = 0;
  std::uint64_t checksum_ = 0;
  std::span<const std::byte> bytes_;
  bool locked_ = false;
  std::unique_ptr<BusErrorGuard> guard_ = std::make_unique<BusErrorGuard>();
};

}  // namespace spm
