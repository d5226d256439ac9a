// SPDX-License-Identifier: Apache-2.0
#include "servo/app/app_client.hpp"

#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <string_view>
#include <utility>

#include "servo/shared/fixed_text.hpp"
#include "servo/shared/passed_descriptors.hpp"

namespace spm::servo {

namespace {

/// Text from a client in a form that a terminal can show: ASCII, cut at its closing zero.
template <std::size_t Size>
std::string printable(const char (&text)[Size]) {
  std::string shown(text, strnlen(text, Size));
  std::replace_if(
      shown.begin(), shown.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  return shown;
}

spm_socket_answer plain_answer() noexcept {
  spm_socket_answer answer{};
  answer.magic = SPM_SOCKET_MAGIC;
  answer.socket_version = SPM_SOCKET_VERSION;
  answer.layout_version = SPM_LAYOUT_VERSION;
  copy_text(answer.daemon_version, SPM_VERSION);
  return answer;
}

}  // namespace

bool send_answer(int descriptor, const spm_socket_answer& answer,
                 std::span<const int> sent) noexcept {
  return send_message(descriptor, std::as_bytes(std::span(&answer, 1)), sent);
}

spm_socket_answer refusing_answer(std::uint32_t status, const std::string& sentence) noexcept {
  spm_socket_answer answer = plain_answer();
  answer.status = status;
  copy_text(answer.sentence, sentence);
  return answer;
}

Result<std::unique_ptr<AppClient>> AppClient::make(int descriptor, std::uint32_t connection,
                                                   pid_t process, bool trusted) {
  auto memory = SharedMemory::create("spm-servo-commands", sizeof(spm_shared_ring));
  if (!memory) {
    close(descriptor);
    return tl::make_unexpected(std::move(memory.error()));
  }
  auto* const ring = static_cast<spm_shared_ring*>(memory->data());
  ring->magic = SPM_RING_MAGIC;
  ring->layout_version = SPM_LAYOUT_VERSION;
  ring->bytes = sizeof(spm_shared_ring);
  return std::unique_ptr<AppClient>(
      new AppClient(descriptor, connection, process, trusted, std::move(*memory)));
}

AppClient::AppClient(int descriptor, std::uint32_t connection, pid_t process, bool trusted,
                     SharedMemory memory) noexcept
    : descriptor_(descriptor),
      process_(process),
      trusted_(trusted),
      memory_(std::move(memory)),
      attached_{static_cast<spm_shared_ring*>(memory_.data()), connection} {}

AppClient::~AppClient() { hang_up(); }

void AppClient::refuse(std::uint32_t status, const std::string& sentence) const {
  static_cast<void>(send_answer(descriptor_, refusing_answer(status, sentence)));
}

void AppClient::hang_up() noexcept {
  if (descriptor_ >= 0) close(std::exchange(descriptor_, -1));
}

bool AppClient::greet(const SharedMemory& state) {
  const Result<int> read_only = state.read_only_descriptor();
  if (!read_only) return false;
  spm_socket_answer answer = plain_answer();
  answer.status = SPM_SOCKET_WELCOME;
  answer.connection = attached_.connection;
  answer.state_bytes = static_cast<std::uint32_t>(sizeof(spm_shared_state));
  answer.ring_bytes = static_cast<std::uint32_t>(sizeof(spm_shared_ring));
  const std::array sent{*read_only, memory_.descriptor()};
  const bool went = send_answer(descriptor_, answer, sent);
  close(*read_only);
  return went;
}

Heard AppClient::hear() {
  spm_socket_ready message{};
  // Descriptors that a client sends beside the message are dropped by the kernel.
  const ssize_t got = recv(descriptor_, &message, sizeof message, MSG_DONTWAIT | MSG_TRUNC);
  if (got < 0) {
    return errno == EAGAIN || errno == EINTR ? Heard::nothing : Heard::gone;
  }
  if (got == 0) return Heard::gone;
  if (ready_ || got < 16 || message.magic != SPM_SOCKET_MAGIC) return Heard::nonsense;
  if (got != sizeof message || message.socket_version != SPM_SOCKET_VERSION ||
      message.layout_version != SPM_LAYOUT_VERSION) {
    refuse(SPM_SOCKET_OTHER_VERSION,
           "the application's library has layout " + std::to_string(message.layout_version) +
               ", the daemon " + std::to_string(SPM_LAYOUT_VERSION) +
               " (version " SPM_VERSION "): install library and daemon of the same version");
    return Heard::nonsense;
  }
  application_ = printable(message.application);
  if (message.role > SPM_ROLE_OBSERVER || (message.role == SPM_ROLE_SUPERVISOR && !trusted_)) {
    refuse(SPM_SOCKET_REFUSED,
           "the role of a supervisor is for the daemon's own user and root: connect as that user, "
           "or without the role");
    return Heard::nonsense;
  }
  if (!memory_.close_to_others()) {
    refuse(SPM_SOCKET_REFUSED,
           "the memory for commands was sealed by the application: leave its descriptor to the "
           "library");
    return Heard::nonsense;
  }
  attached_.supervisor = message.role == SPM_ROLE_SUPERVISOR;
  attached_.observer = message.role == SPM_ROLE_OBSERVER;
  ready_ = true;
  return Heard::ready;
}

bool AppClient::confirm() noexcept {
  spm_socket_answer answer = plain_answer();
  answer.connection = attached_.connection;
  return send_answer(descriptor_, answer);
}

AppClientReport AppClient::report() const {
  return {attached_.connection,
          process_,
          application_,
          load_relaxed(attached_.ring->tail),
          load_relaxed(attached_.ring->refused),
          attached_.supervisor,
          attached_.observer};
}

}  // namespace spm::servo
