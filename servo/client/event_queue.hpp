// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "servo/client/spm_client.h"
#include "servo/shared/shared_layout.h"

namespace spm::servo {

/// Events of the devices, found by comparing each look with the one before.
class EventQueue {
 public:
  /// Whether all events were taken. Only then may `look` be called.
  [[nodiscard]] bool empty() const noexcept { return taken_ == count_; }

  /// Looks at the devices. The first look at a device makes no event.
  void look(std::uint64_t tick, const std::array<spm_shared_device, SPM_MAX_DEVICES>& devices,
            std::uint32_t count) noexcept;

  /// The next event; the queue must not be empty.
  [[nodiscard]] spm_client_event take() noexcept { return events_[taken_++]; }

 private:
  void compare(std::uint32_t device, const spm_shared_device& before,
               const spm_shared_device& now) noexcept;
  void tell(std::uint32_t kind, std::uint32_t device, std::uint32_t value) noexcept;

  /// For one device: two of contact, three of cuts, one of being plugged in, and one for each
  /// button.
  static constexpr std::size_t max_of_device = 3 + 3 + 1 + 32;

  std::array<spm_shared_device, SPM_MAX_DEVICES> seen_{};
  std::uint32_t seen_count_ = 0;
  std::uint64_t tick_ = 0;
  std::array<spm_client_event, SPM_MAX_DEVICES * max_of_device> events_{};
  std::size_t count_ = 0, taken_ = 0;
};

}  // namespace spm::servo
