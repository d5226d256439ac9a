// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace spm::servo {

/// Name of the daemon that applications look for by default.
inline constexpr std::string_view default_daemon_name = "default";

/// Names another daemon, where neither a command line nor an application names one.
inline constexpr const char* daemon_name_variable = "SPM_SERVO_NAME";

/// The name of the daemon that is meant where none is named: $SPM_SERVO_NAME, or else the default
/// one. It need not be valid.
[[nodiscard]] std::string usual_daemon_name();

/// The folder of the sockets of this user's daemons: `spm-servo` in $XDG_RUNTIME_DIR, or else in
/// /run/user/UID; empty if there is neither. The folder is neither made nor checked.
[[nodiscard]] std::string socket_folder();

/// True for 1 to 32 letters, digits, '-', '_' and '.', the first neither '-' nor '.'.
[[nodiscard]] bool valid_daemon_name(std::string_view name) noexcept;

/// Path of the socket of the daemon of that name, which must be valid; empty if there is no folder
/// for it.
[[nodiscard]] std::string socket_path(std::string_view name);

/// What to say if there is no folder for sockets: a clause with the cure, without a full stop.
inline constexpr std::string_view no_socket_folder =
    "there is no folder for sockets that is this user's alone (XDG_RUNTIME_DIR is not set, and "
    "there "
    "is no /run/user/UID): set XDG_RUNTIME_DIR to a folder of yours with mode 700";

/// Longest path of a Unix socket, in bytes without the closing zero (unix(7)).
inline constexpr std::size_t longest_socket_path = 107;

}  // namespace spm::servo
