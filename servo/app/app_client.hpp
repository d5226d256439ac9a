// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>

#include "common/base/error.hpp"
#include "servo/app/client_ring.hpp"
#include "servo/app/shared_memory.hpp"
#include "servo/shared/socket_messages.h"

namespace spm::servo {

/// What `top` says of a client. The counts are what its own memory says: it can lie about itself.
struct AppClientReport {
  std::uint32_t connection = 0;
  pid_t process = 0;
  std::string application;  ///< as it calls itself, printable characters only
  std::uint64_t commands = 0;
  std::uint64_t refused = 0;
};

/// What came of hearing a client.
enum class Heard : std::uint8_t {
  nothing,   ///< not now
  ready,     ///< it has mapped its memory and its ring may be attached
  gone,      ///< it hung up
  nonsense,  ///< what it sent is no message of ours, or of another version
};

/// The server's end of one connection: socket, ring and what is known of the client. Nothing here
/// blocks.
class AppClient {
 public:
  /// Takes the socket, which it closes. Errors: file_or_device.
  [[nodiscard]] static Result<std::unique_ptr<AppClient>> make(int descriptor,
                                                               std::uint32_t connection,
                                                               pid_t process);
  AppClient(const AppClient&) = delete;
  AppClient& operator=(const AppClient&) = delete;
  ~AppClient();

  /// Sends the greeting with the descriptors of state and ring; false where it could not be.
  [[nodiscard]] bool greet(const SharedMemory& state);
  /// Hears at most one message; answers one that will not do.
  [[nodiscard]] Heard hear();
  /// Tells a client that was ready that its commands are taken; false where it is gone.
  [[nodiscard]] bool confirm() noexcept;
  /// Hangs up; the ring stays.
  void hang_up() noexcept;

  [[nodiscard]] const AttachedRing* ring() const noexcept { return &attached_; }
  [[nodiscard]] int descriptor() const noexcept { return descriptor_; }
  [[nodiscard]] bool ready() const noexcept { return ready_; }
  [[nodiscard]] std::chrono::steady_clock::time_point since() const noexcept { return since_; }
  [[nodiscard]] AppClientReport report() const;

 private:
  AppClient(int descriptor, std::uint32_t connection, pid_t process, SharedMemory memory) noexcept;

  int descriptor_;
  pid_t process_;
  SharedMemory memory_;
  AttachedRing attached_;
  std::string application_;
  std::chrono::steady_clock::time_point since_ = std::chrono::steady_clock::now();
  bool ready_ = false;
};

/// Sends an answer over a socket without waiting, with the descriptors where there are any; false
/// where it could not be.
[[nodiscard]] bool send_answer(int descriptor, const spm_socket_answer& answer, const int* sent,
                               std::size_t sent_count) noexcept;

/// The answer that refuses a client with a sentence.
[[nodiscard]] spm_socket_answer refusing_answer(std::uint32_t status,
                                                const std::string& sentence) noexcept;

}  // namespace spm::servo
