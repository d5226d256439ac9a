// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/socket.h>
#include <sys/types.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "common/base/error.hpp"
#include "servo/app/app_client.hpp"
#include "servo/app/app_state.hpp"
#include "servo/app/listening_socket.hpp"

namespace spm::servo {

struct AppServerOptions {
  std::string path;              ///< of the socket; empty: the usual one for the name
  std::string name = "default";  ///< of the daemon, which no other one may have
  uid_t user = geteuid();        ///< who may connect, beside root
  std::optional<gid_t> group;    ///< whose members may connect too; needs a path
  /// How long a client may take to map what it was sent.
  std::chrono::milliseconds patience{5000};
  /// Called with a sentence for a person, on the server's thread. May be empty.
  std::function<void(const std::string&)> warn;
};

/// Lets applications find the daemon, by a Unix socket and a thread of ordinary priority. A client
/// that may connect gets the loop's state to read, and a ring for its commands. After that the
/// socket only shows that the client is still there. Nothing that a client does on it blocks the
/// thread, and the loop never waits for the thread.
class AppServer {
 public:
  /// Begins to listen and starts the thread, in which the caller's signals are blocked. `state`
  /// must outlive the server. Errors: those of ListeningSocket::open.
  [[nodiscard]] static Result<std::unique_ptr<AppServer>> start(AppServerOptions options,
                                                                AppState& state);
  AppServer(const AppServer&) = delete;
  AppServer& operator=(const AppServer&) = delete;
  /// Tells all clients that the daemon ends, lets them go, stops the thread and removes the socket.
  /// The loop may still run, or have ended.
  ~AppServer();

  [[nodiscard]] const std::string& path() const noexcept { return socket_.path(); }

  /// Who is connected. Any thread may call it.
  [[nodiscard]] std::vector<AppClientReport> clients() const;

 private:
  AppServer(AppServerOptions options, AppState& state, ListeningSocket socket, int wake) noexcept;
  void run();
  void accept_one();
  void welcome(int connection);
  [[nodiscard]] bool may_connect(int connection, const ucred& peer) const;
  [[nodiscard]] bool has_place(const AppClient& client) const;
  void hear(std::uint32_t place);
  void part(std::uint32_t place, const std::string& why);
  void drop_the_slow();
  void free_released();
  [[nodiscard]] int poll_timeout() const noexcept;
  void warn(const std::string& message);

  AppServerOptions options_;
  AppState& state_;
  ListeningSocket socket_;
  int wake_;  ///< an eventfd that ends the thread
  std::atomic<bool> stop_{false};
  std::uint32_t connections_ = 0;  ///< so far
  std::uint32_t warnings_ = 0;     ///< so far
  bool accepting_ = true;          ///< off for a while when descriptors ran out
  /// their rings may still be in use by the loop
  std::vector<std::unique_ptr<AppClient>> departed_;

  mutable std::mutex mutex_;  ///< guards the members below; the loop never takes it
  std::array<std::unique_ptr<AppClient>, SPM_MAX_CLIENTS> clients_;
  std::thread thread_;
};

}  // namespace spm::servo
