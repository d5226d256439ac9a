// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/un.h>

#include <memory>
#include <string>

#include "servo/app/app_server.hpp"
#include "servo/client/spm_client.h"
#include "tests/servo/support/eventually.hpp"
#include "tests/servo/support/loop_stand_in.hpp"

namespace spm::test {

/// A struct of spm_client.h with its size.
template <class Record>
[[nodiscard]] Record sized() {
  Record record{};
  record.size = sizeof record;
  return record;
}

/// A pose that may be sent, at x metres.
[[nodiscard]] spm_client_pose pose_at(double x);

/// Starts a server; throws its error.
[[nodiscard]] std::unique_ptr<servo::AppServer> started(servo::AppState& state,
                                                        servo::AppServerOptions options);
[[nodiscard]] std::unique_ptr<servo::AppServer> started(servo::AppState& state,
                                                        const std::string& path);

[[nodiscard]] sockaddr_un address_of(const std::string& path);
/// A socket of the kind that the daemon listens on.
[[nodiscard]] int new_socket();

/// The state of a daemon (`small_state`) and its server, without a loop.
struct Daemon {
  SocketFolder folder;
  std::unique_ptr<servo::AppState> state = small_state();
  std::unique_ptr<servo::AppServer> server = started(*state, folder.path("a.sock"));
};

/// A connection made by the library, or the reason why there is none.
class Connected {
 public:
  explicit Connected(const std::string& path, int timeout_ms = 20000,
                     spm_client_role role = SPM_CLIENT_APPLICATION);
  Connected(const Connected&) = delete;
  Connected& operator=(const Connected&) = delete;
  ~Connected();

  /// Whether the loop takes a command.
  [[nodiscard]] bool commands_work() const;

  spm_client* client = nullptr;
  int code = 0;
  std::string message;
};

}  // namespace spm::test
