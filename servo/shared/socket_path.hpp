// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace spm::servo {

/// Name of the daemon that applications look for by default.
inline constexpr std::string_view default_daemon_name = "default";

/// The folder of the sockets of this user's daemons: `spm-servo` in $XDG_RUNTIME_DIR, or else in
/// /run/user/UID, or else /tmp/spm-servo-UID. The folder is neither made nor checked.
[[nodiscard]] std::string socket_folder();

/// True for 1 to 32 letters, digits, '-', '_' and '.', the first neither '-' nor '.'.
[[nodiscard]] bool valid_daemon_name(std::string_view name) noexcept;

/// Path of the socket of the daemon of that name. The name must be valid.
[[nodiscard]] std::string socket_path(std::string_view name);

/// Longest path of a Unix socket, in bytes without the closing zero (unix(7)).
inline constexpr std::size_t longest_socket_path = 107;

}  // namespace spm::servo
