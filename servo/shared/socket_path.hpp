// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace spm::servo {

/// Name of the daemon that applications look for unless told otherwise.
inline constexpr std::string_view default_daemon_name = "default";

/// Where sockets of this user's daemons lie: `spm-servo` in $XDG_RUNTIME_DIR, or else in
/// /run/user/UID, or else /tmp/spm-servo-UID. Neither made nor looked into.
[[nodiscard]] std::string socket_folder();

/// True for 1 to 32 letters, digits, '-', '_' and '.', the first neither '-' nor '.'.
[[nodiscard]] bool valid_daemon_name(std::string_view name) noexcept;

/// Socket of the daemon of that name, which must be valid.
[[nodiscard]] std::string socket_path(std::string_view name);

/// Longest path of a Unix socket, bytes without the closing zero (unix(7)).
inline constexpr std::size_t longest_socket_path = 107;

}  // namespace spm::servo
