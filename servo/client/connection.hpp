// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>
#include <tl/expected.hpp>

#include "servo/shared/shared_layout.h"

namespace spm::servo {

/// Why there is no connection: one of the codes of spm_client.h, and a sentence with the cure.
struct NoConnection {
  int code = 0;
  std::string sentence;
};

/// Where a daemon is, and who asks.
struct ConnectionRequest {
  std::string path;         ///< of the socket
  std::string application;  ///< its name for itself
  std::uint32_t role = 0;   ///< SPM_ROLE_*
  uid_t server_user = 0;    ///< trusted beside this user and root; 0: nobody else
  std::chrono::milliseconds timeout{1000};
};

/// The client's end of a connection: the socket, and both mapped regions.
class Connection {
 public:
  /// Connects, and waits for the daemon for at most the request's timeout. A daemon of a user who
  /// is not trusted is not spoken to, nor is a socket that others could have put there.
  [[nodiscard]] static tl::expected<Connection, NoConnection> open(
      const ConnectionRequest& request);

  Connection(Connection&& other) noexcept;
  Connection& operator=(Connection&&) = delete;
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;
  ~Connection();

  [[nodiscard]] const spm_shared_state& state() const noexcept { return *state_; }
  [[nodiscard]] spm_shared_ring& ring() const noexcept { return *ring_; }
  /// Numbered by the daemon, from 1.
  [[nodiscard]] std::uint32_t number() const noexcept { return number_; }
  /// False once the daemon's end of the socket is closed. One system call.
  [[nodiscard]] bool daemon_is_there() const noexcept;

 private:
  Connection() = default;

  int socket_ = -1;
  const spm_shared_state* state_ = nullptr;
  spm_shared_ring* ring_ = nullptr;
  std::uint32_t number_ = 0;

  friend class Handshake;
};

}  // namespace spm::servo
