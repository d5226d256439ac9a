// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace spm {

/// Name of the instruction set that queries use on this processor, as Highway spells it ("AVX2").
[[nodiscard]] const char* instruction_set() noexcept;

}  // namespace spm
