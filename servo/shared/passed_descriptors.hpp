// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <array>
#include <cstddef>
#include <span>

#include "servo/shared/descriptor.hpp"

namespace spm::servo {

/// Descriptors that go with a message, at most.
inline constexpr std::size_t most_passed = 4;

/// Sends a message over a Unix socket, and copies of up to most_passed descriptors with it. Never
/// waits. False where it did not go as a whole.
[[nodiscard]] bool send_message(int socket, std::span<const std::byte> message,
                                std::span<const int> descriptors = {}) noexcept;

/// What came with a message.
struct ReceivedMessage {
  ssize_t bytes = -1;   ///< as recvmsg tells it
  bool is_cut = false;  ///< it was longer, or had more descriptors
  std::size_t count = 0;
  std::array<Descriptor, most_passed> descriptors;  ///< the first `count`
};

/// Receives a message into `room`, if one is there. Never waits. The descriptors are closed in
/// programs that this one becomes.
[[nodiscard]] ReceivedMessage receive_message(int socket, std::span<std::byte> room) noexcept;

}  // namespace spm::servo
