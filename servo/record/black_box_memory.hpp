// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>

#include "common/base/error.hpp"

namespace spm::servo {

/// Memory with the last ticks of a run, which a process that is forked after it was made shares:
/// what the daemon has written is there when the daemon is gone. Two halves take turns, and each is
/// a recording's start and its parts, so that what was written last is whole however the writer
/// ended. One thread writes.
class BlackBoxMemory {
 public:
  /// `half_bytes`: of each half. Errors: file_or_device.
  [[nodiscard]] static Result<std::unique_ptr<BlackBoxMemory>> make(std::size_t half_bytes);
  /// The memory that another process made, by its descriptor there, which it handed on. Errors:
  /// file_or_device.
  [[nodiscard]] static Result<std::unique_ptr<BlackBoxMemory>> attach(int descriptor,
                                                                      std::size_t half_bytes);
  /// Room for `seconds` of rows in a half, for a large scene in its start, and for changes of it.
  [[nodiscard]] static std::size_t bytes_for(std::size_t devices, double rate_hz, double seconds);

  BlackBoxMemory(const BlackBoxMemory&) = delete;
  BlackBoxMemory& operator=(const BlackBoxMemory&) = delete;
  ~BlackBoxMemory();

  /// Goes on in the other half, with this start (recording_start); what was there is gone. False,
  /// with nothing done, if it does not fit.
  [[nodiscard]] bool begin(std::string_view start) noexcept;
  /// Adds a part (append_part). False if the half is full, or none was begun.
  [[nodiscard]] bool append(std::string_view part) noexcept;

  /// What `attach` needs.
  [[nodiscard]] int descriptor() const noexcept { return descriptor_; }
  [[nodiscard]] std::size_t half_bytes() const noexcept { return half_bytes_; }

  /// Whether nothing was begun.
  [[nodiscard]] bool empty() const noexcept;

  /// Any process that shares the memory: writes both halves as one recording, and makes its folder.
  /// Errors: file_or_device.
  [[nodiscard]] Result<void> write(const std::string& path) const;

 private:
  struct Head;

  BlackBoxMemory(Head* head, std::size_t half_bytes, int descriptor) noexcept
      : head_(head), half_bytes_(half_bytes), descriptor_(descriptor) {}
  [[nodiscard]] char* half(std::size_t which) const noexcept;
  [[nodiscard]] std::string_view start_of(std::size_t which) const noexcept;
  [[nodiscard]] std::string_view parts_of(std::size_t which) const noexcept;

  Head* head_;
  std::size_t half_bytes_;
  int descriptor_;
};

}  // namespace spm::servo
