// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "servo/shared/app_command.hpp"

namespace spm::servo {

/// Keeps what was wrong with this thread's last call, for spm_client_text. No call allocates.
/// Returns the code.
int failed(int code) noexcept;
int failed(int code, const char* sentence) noexcept;
/// Names the number, where one was refused.
int failed(int code, Refusal refusal, const WrongNumber& number) noexcept;

}  // namespace spm::servo
