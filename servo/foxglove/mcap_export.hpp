// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "common/base/error.hpp"

namespace spm::servo {

/// What was written.
struct McapExport {
  std::uint64_t ticks = 0;     ///< of all devices
  std::uint64_t messages = 0;  ///< of all channels
  std::vector<std::string> topics;
  std::string loss;  ///< what of the recording is missing, a sentence; or empty
};

/// Writes a recording as MCAP: the channels of channels_of(), every tick. Times count from the
/// beginning of the loop's grid. The arrows of forces come 60 times a second. Of a recording that
/// was cut short it is what is whole. Errors: those of salvage_recording(); invalid_input, where
/// its scene cannot be read; file_or_device, where the file cannot be written.
[[nodiscard]] Result<McapExport> export_mcap(const std::string& recording, const std::string& out);

}  // namespace spm::servo
