// SPDX-License-Identifier: Apache-2.0
#include "tests/servo/virtual_machine/usbip_link.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <string>
#include <thread>

#include "tests/servo/virtual_machine/emulator_program.hpp"

namespace spm::test {

namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr const char* attach_file = "/sys/devices/platform/vhci_hcd.0/attach";
constexpr unsigned port = 0;
constexpr unsigned device_id = 0x00010002;  // bus 1, device 2
constexpr unsigned full_speed = 2;          // enum usb_device_speed
/// A port is not free immediately after its device was unplugged.
constexpr milliseconds attach_wait{5000}, attach_step{10};

// Every message begins with 48 bytes: twelve numbers, big-endian, or ten and a setup packet.
constexpr std::size_t header_numbers = 12, header_size = 4 * header_numbers, setup_at = 40;
constexpr std::uint32_t command_submit = 1, command_unlink = 2, reply_submit = 3, reply_unlink = 4;
constexpr std::uint32_t direction_in = 1;

using Header = std::array<std::uint8_t, header_size>;

void put(Header& header, std::size_t index, std::uint32_t value) {
  const std::uint32_t bits = htonl(value);
  std::memcpy(&header[4 * index], &bits, sizeof bits);
}

std::uint32_t get(const Header& header, std::size_t index) {
  std::uint32_t bits = 0;
  std::memcpy(&bits, &header[4 * index], sizeof bits);
  return ntohl(bits);
}

/// All bytes, or false where the other end is closed.
bool receive_all(int socket, std::span<std::uint8_t> bytes) {
  while (!bytes.empty()) {
    const ssize_t count = recv(socket, bytes.data(), bytes.size(), MSG_WAITALL);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    bytes = bytes.subspan(static_cast<std::size_t>(count));
  }
  return true;
}

/// False where the port is still in use.
bool attach(int socket) {
  const int file = open(attach_file, O_WRONLY | O_CLOEXEC);
  if (file < 0) give_up(std::string(attach_file) + " cannot be opened");
  const std::string text = std::to_string(port) + " " + std::to_string(socket) + " " +
                           std::to_string(device_id) + " " + std::to_string(full_speed);
  const bool attached = write(file, text.data(), text.size()) > 0;
  const int error_number = errno;
  close(file);
  errno = error_number;
  if (!attached && errno != EBUSY) give_up("vhci_hcd takes no device");
  return attached;
}

}  // namespace

UsbIpLink::UsbIpLink() {
  std::array<int, 2> ends{};
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) {
    give_up("no pair of sockets can be made");
  }
  const auto due = steady_clock::now() + attach_wait;
  while (!attach(ends[0])) {
    if (steady_clock::now() > due) give_up("the port of vhci_hcd does not become free");
    std::this_thread::sleep_for(attach_step);
  }
  close(ends[0]);  // the kernel holds it now
  socket_ = ends[1];
}

UsbIpLink::~UsbIpLink() {
  shutdown(socket_, SHUT_RDWR);
  close(socket_);
}

std::optional<UsbMessage> UsbIpLink::receive(std::chrono::nanoseconds wait) {
  const auto nanoseconds = std::max(wait.count(), std::int64_t{0});
  const timespec time{nanoseconds / 1'000'000'000, nanoseconds % 1'000'000'000};
  pollfd events{socket_, POLLIN, 0};
  if (ppoll(&events, 1, &time, nullptr) <= 0) return std::nullopt;
  Header header{};
  if (!receive_all(socket_, header)) give_up("vhci_hcd closed the connection");
  if (get(header, 0) == command_unlink) return UsbUnlink{get(header, 1), get(header, 5)};
  if (get(header, 0) != command_submit) give_up("vhci_hcd sent what is no message of USB/IP");
  UsbTransfer transfer;
  transfer.number = get(header, 1);
  transfer.in = get(header, 3) == direction_in;
  transfer.endpoint = get(header, 4);
  transfer.length = get(header, 6);
  std::copy_n(header.begin() + setup_at, transfer.setup.size(), transfer.setup.begin());
  if (!transfer.in) {
    transfer.data.resize(transfer.length);
    if (!receive_all(socket_, transfer.data)) give_up("vhci_hcd closed the connection");
  }
  return transfer;
}

void UsbIpLink::end(const UsbTransfer& transfer, int status) {
  reply(transfer, status, status == 0 && !transfer.in ? transfer.length : 0, {});
}

void UsbIpLink::end(const UsbTransfer& transfer, std::span<const std::uint8_t> data) {
  const auto sent = data.first(std::min(data.size(), transfer.length));
  reply(transfer, 0, sent.size(), sent);
}

void UsbIpLink::end(const UsbUnlink& unlink, bool was_pending) {
  Header header{};
  put(header, 0, reply_unlink);
  put(header, 1, unlink.number);
  put(header, 5, was_pending ? static_cast<std::uint32_t>(-ECONNRESET) : 0);
  send(header);
}

void UsbIpLink::reply(const UsbTransfer& transfer, int status, std::size_t length,
                      std::span<const std::uint8_t> data) {
  Header header{};
  put(header, 0, reply_submit);
  put(header, 1, transfer.number);
  put(header, 5, static_cast<std::uint32_t>(status));
  put(header, 6, static_cast<std::uint32_t>(length));
  // In one piece, so that the kernel's thread wakes up once.
  std::vector<std::uint8_t> message(header.begin(), header.end());
  message.insert(message.end(), data.begin(), data.end());
  send(message);
}

void UsbIpLink::send(std::span<const std::uint8_t> bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) give_up("vhci_hcd closed the connection");
    bytes = bytes.subspan(static_cast<std::size_t>(count));
  }
}

}  // namespace spm::test
