// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "servo/shared/refusal.hpp"
#include "servo/shared/shared_layout.h"

namespace spm::servo {

/// Which application holds each device's clutch. A clutch belongs to who took it, and leaves with
/// it. Belongs to the loop.
class AppClutches {
 public:
  /// An application (by its connection, from 1) takes a clutch, or lets it go. `device` is below
  /// SPM_MAX_DEVICES. Refused while another one holds it, unless `supervisor` asks.
  [[nodiscard]] Refusal set(std::uint32_t device, bool on, std::uint32_t connection,
                            bool supervisor) noexcept {
    if (!allows(device, connection, supervisor)) return Refusal::clutch_held;
    holders_[device] = on ? connection : 0;
    return Refusal::none;
  }
  /// Whether an application may decide about a device's force: nobody else holds its clutch.
  [[nodiscard]] bool allows(std::uint32_t device, std::uint32_t connection,
                            bool supervisor) const noexcept {
    const std::uint32_t holder = holders_[device];
    return holder == 0 || holder == connection || supervisor;
  }
  /// An application is gone.
  void leave(std::uint32_t connection) noexcept {
    for (std::uint32_t& holder : holders_) holder = holder == connection ? 0 : holder;
  }
  /// Whether any application holds a device's clutch.
  [[nodiscard]] bool held(std::uint32_t device) const noexcept {
    return device < holders_.size() && holders_[device] != 0;
  }

 private:
  std::array<std::uint32_t, SPM_MAX_DEVICES> holders_{};  ///< connections; 0: nobody
};

}  // namespace spm::servo
