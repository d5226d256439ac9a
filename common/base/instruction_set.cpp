// SPDX-License-Identifier: Apache-2.0
#include "common/base/instruction_set.hpp"

#include <hwy/highway.h>
#include <hwy/targets.h>

#include <cstdint>

namespace spm {

const char* instruction_set() noexcept {
  // Better instruction sets have lower bits.
  const std::int64_t usable = hwy::SupportedTargets() & HWY_TARGETS;
  return hwy::TargetName(usable & -usable);
}

}  // namespace spm
