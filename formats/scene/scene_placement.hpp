// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/base/placement.hpp"
#include "formats/scene/table_reader.hpp"

namespace spm {

/// Reads `pose`, bare numbers in metres and a unit quaternion, and `scale`, from 1e-6 to 1e6. What
/// is missing is that of the identity.
[[nodiscard]] Placement read_placement(TableReader& reader);

}  // namespace spm
