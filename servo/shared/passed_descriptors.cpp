// SPDX-License-Identifier: Apache-2.0
#include "servo/shared/passed_descriptors.hpp"

#include <sys/socket.h>

#include <cstring>

namespace spm::servo {

namespace {

/// A message with room for descriptors, as the system takes it.
struct Parts {
  explicit Parts(std::span<const std::byte> bytes) noexcept
      // recvmsg writes there, sendmsg does not.
      : part{const_cast<std::byte*>(bytes.data()), bytes.size()} {
    message.msg_iov = &part;
    message.msg_iovlen = 1;
  }
  Parts(const Parts&) = delete;
  Parts& operator=(const Parts&) = delete;

  iovec part;
  msghdr message{};
  alignas(cmsghdr) std::array<unsigned char, CMSG_SPACE(most_passed * sizeof(int))> control{};
};

}  // namespace

bool send_message(int socket, std::span<const std::byte> message,
                  std::span<const int> descriptors) noexcept {
  Parts parts(message);
  if (descriptors.size() > most_passed) return false;
  if (!descriptors.empty()) {
    parts.message.msg_control = parts.control.data();
    parts.message.msg_controllen = CMSG_SPACE(descriptors.size_bytes());
    cmsghdr* const header = CMSG_FIRSTHDR(&parts.message);
    header->cmsg_level = SOL_SOCKET;
    header->cmsg_type = SCM_RIGHTS;
    header->cmsg_len = CMSG_LEN(descriptors.size_bytes());
    std::memcpy(CMSG_DATA(header), descriptors.data(), descriptors.size_bytes());
  }
  return sendmsg(socket, &parts.message, MSG_DONTWAIT | MSG_NOSIGNAL) ==
         static_cast<ssize_t>(message.size());
}

ReceivedMessage receive_message(int socket, std::span<std::byte> room) noexcept {
  Parts parts(room);
  parts.message.msg_control = parts.control.data();
  parts.message.msg_controllen = parts.control.size();
  ReceivedMessage received;
  received.bytes = recvmsg(socket, &parts.message, MSG_DONTWAIT | MSG_CMSG_CLOEXEC);
  if (received.bytes < 0) return received;
  received.is_cut = (parts.message.msg_flags & (MSG_TRUNC | MSG_CTRUNC)) != 0;
  for (cmsghdr* header = CMSG_FIRSTHDR(&parts.message); header != nullptr;
       header = CMSG_NXTHDR(&parts.message, header)) {
    if (header->cmsg_level != SOL_SOCKET || header->cmsg_type != SCM_RIGHTS) continue;
    const std::size_t bytes = header->cmsg_len - CMSG_LEN(0);
    for (std::size_t at = 0; at + sizeof(int) <= bytes; at += sizeof(int)) {
      int number = -1;
      std::memcpy(&number, CMSG_DATA(header) + at, sizeof number);
      Descriptor taken(number);
      if (received.count < most_passed) received.descriptors[received.count++] = std::move(taken);
    }
  }
  return received;
}

}  // namespace spm::servo
