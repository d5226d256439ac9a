// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>

#include "common/base/error.hpp"

namespace spm::servo {

/// Anonymous memory that is passed to other processes by a descriptor. It is zero at first, mapped
/// for writing here, its pages are touched and its size is sealed.
class SharedMemory {
 public:
  /// `name` is shown in /proc. Errors: file_or_device.
  [[nodiscard]] static Result<SharedMemory> create(const std::string& name, std::size_t bytes);

  SharedMemory(SharedMemory&& other) noexcept;
  SharedMemory& operator=(SharedMemory&& other) noexcept;
  SharedMemory(const SharedMemory&) = delete;
  SharedMemory& operator=(const SharedMemory&) = delete;
  ~SharedMemory();

  [[nodiscard]] void* data() const noexcept { return data_; }
  [[nodiscard]] std::size_t size() const noexcept { return bytes_; }
  /// For writing; owned by this object.
  [[nodiscard]] int descriptor() const noexcept { return descriptor_; }

  /// A new descriptor by which nobody can map the memory for writing. The caller closes it. Errors:
  /// file_or_device.
  [[nodiscard]] Result<int> read_only_descriptor() const;

  /// From now on no process that has not yet mapped the memory for writing can do so, take pages
  /// out of it, or seal it in another way. What other processes may have done to its pages before
  /// is repaired. False if another process has sealed it already. On Linux before 5.1, which has no
  /// such seal, it returns true without an effect.
  [[nodiscard]] bool close_to_others() noexcept;

 private:
  SharedMemory(int descriptor, void* data, std::size_t bytes) noexcept
      : descriptor_(descriptor), data_(data), bytes_(bytes) {}
  void touch() const noexcept;

  int descriptor_ = -1;
  void* data_ = nullptr;
  std::size_t bytes_ = 0;
};

}  // namespace spm::servo
