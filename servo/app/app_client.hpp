// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "common/base/error.hpp"
#include "servo/app/client_ring.hpp"
#include "servo/app/shared_memory.hpp"
#include "servo/shared/socket_messages.h"

namespace spm::servo {

/// What `top` says of a client. The counts are from the client's own memory, so they can be false.
struct AppClientReport {
  std::uint32_t connection = 0;
  pid_t process = 0;
  std::string application;  ///< the name it gives itself, printable characters only
  std::uint64_t commands = 0;
  std::uint64_t refused = 0;
  bool supervisor = false, observer = false;  ///< its role
};

/// The result of `hear`.
enum class Heard : std::uint8_t {
  nothing,   ///< no message now
  ready,     ///< it has mapped its memory and its ring may be attached
  gone,      ///< it hung up
  nonsense,  ///< what it sent is no message of ours, or one of another version
};

/// The server's end of one connection: the socket, the ring, and what is known of the client. No
/// call blocks.
class AppClient {
 public:
  /// Takes ownership of the socket, and closes it. Errors: file_or_device.
  /// `trusted`: it may be a supervisor.
  [[nodiscard]] static Result<std::unique_ptr<AppClient>> make(int descriptor,
                                                               std::uint32_t connection,
                                                               pid_t process, bool trusted);
  AppClient(const AppClient&) = delete;
  AppClient& operator=(const AppClient&) = delete;
  ~AppClient();

  /// Sends the greeting with the descriptors of state and ring. False if it could not be sent.
  [[nodiscard]] bool greet(const SharedMemory& state);
  /// Reads at most one message. A message that is not acceptable is answered.
  [[nodiscard]] Heard hear();
  /// Tells a client that was ready that its commands are now taken. False if it is gone.
  [[nodiscard]] bool confirm() noexcept;
  /// Tells the client why it is not served.
  void refuse(std::uint32_t status, const std::string& sentence) const;
  /// Closes the connection; the ring stays.
  void hang_up() noexcept;

  [[nodiscard]] const AttachedRing* ring() const noexcept { return &attached_; }
  [[nodiscard]] int descriptor() const noexcept { return descriptor_; }
  [[nodiscard]] bool ready() const noexcept { return ready_; }
  [[nodiscard]] std::chrono::steady_clock::time_point since() const noexcept { return since_; }
  [[nodiscard]] AppClientReport report() const;

 private:
  AppClient(int descriptor, std::uint32_t connection, pid_t process, bool trusted,
            SharedMemory memory) noexcept;

  int descriptor_;
  pid_t process_;
  bool trusted_;
  SharedMemory memory_;
  AttachedRing attached_;
  std::string application_;
  std::chrono::steady_clock::time_point since_ = std::chrono::steady_clock::now();
  bool ready_ = false;
};

/// Sends an answer over a socket without waiting, with the descriptors if there are any. False if
/// it could not be sent.
[[nodiscard]] bool send_answer(int descriptor, const spm_socket_answer& answer,
                               std::span<const int> sent = {}) noexcept;

/// The answer that refuses a client, with a sentence.
[[nodiscard]] spm_socket_answer refusing_answer(std::uint32_t status,
                                                const std::string& sentence) noexcept;

}  // namespace spm::servo
