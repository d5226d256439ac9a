// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "common/base/error.hpp"
#include "formats/motion/recording.hpp"

namespace spm {

/// What can be read of a recording, to be looked at: not to be replayed.
struct SalvagedRecording {
  Recording recording;
  /// What is missing, a sentence for users; empty where the file is whole.
  std::string loss;
};

/// Reads a recording as far as its parts are whole: of one that was cut short or changed since it
/// was written, what comes before the first part that is none. Errors: those of read_recording(),
/// but for a file whose header is whole and of this version, with one row at least.
[[nodiscard]] Result<SalvagedRecording> salvage_recording(const std::string& path);

}  // namespace spm
