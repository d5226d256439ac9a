// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <utility>

#include "common/base/error.hpp"
#include "servo/devices/base/port.hpp"
#include "servo/devices/hid/hid_bus.hpp"
#include "servo/devices/spacemouse/spacemouse_options.hpp"
#include "servo/devices/spacemouse/spacemouse_reports.hpp"

namespace spm::servo {

/// The light of a SpaceMouse, which shows that it is in use.
struct SpaceMouseCommand {
  bool light = false;
};

/// A SpaceMouse over hidraw. It is opened twice, once for each thread (HidHandle says why). Other
/// programs may read it at the same time.
class SpaceMousePort final : public Port<SpaceMouseState, SpaceMouseCommand> {
 public:
  /// Opens the first one that the options allow. Errors: file_or_device, for not found or no
  /// permission.
  [[nodiscard]] static Result<std::unique_ptr<SpaceMousePort>> open(
      const SpaceMouseOptions& options);

  /// Returns everything that the mouse has reported since it was opened, not only the last report.
  [[nodiscard]] Received receive(SpaceMouseState& state) override;
  /// A mouse without a light works as well; a loss is reported by `receive`.
  [[nodiscard]] bool send(const SpaceMouseCommand& command) override;

  [[nodiscard]] const HidDevice& device() const noexcept { return device_; }

 private:
  SpaceMousePort(HidDevice device, std::unique_ptr<HidHandle> reader,
                 std::unique_ptr<HidHandle> writer)
      : device_(std::move(device)), reader_(std::move(reader)), writer_(std::move(writer)) {}

  HidDevice device_;
  std::unique_ptr<HidHandle> reader_, writer_;
  SpaceMouseState latest_;
};

}  // namespace spm::servo
