// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace spm {

/// Keeps a read-only mapping readable when its file is truncated. On a bus error inside the
/// mapping, the rest of it from that page on becomes zeros, and `lost` turns true. Bus errors
/// elsewhere go to the handler that was there before. The first guard installs the process-wide
/// handler, which stays. The mapping must be unmapped after its guard ends.
class BusErrorGuard {
 public:
  BusErrorGuard() = default;
  BusErrorGuard(const BusErrorGuard&) = delete;
  BusErrorGuard& operator=(const BusErrorGuard&) = delete;
  ~BusErrorGuard();

  /// Begins to guard [begin, begin + size), page-aligned. Returns false and guards nothing where
  /// the table of mappings is full (1024 at once) or the handler cannot be installed.
  [[nodiscard]] bool watch(const void* begin, std::size_t size) noexcept;

  /// True once a page was lost. Lock-free.
  [[nodiscard]] bool lost() const noexcept;

 private:
  std::ptrdiff_t slot_ = -1;
};

}  // namespace spm
