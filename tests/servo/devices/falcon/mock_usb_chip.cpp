// SPDX-License-Identifier: Apache-2.0
#include "tests/servo/devices/falcon/mock_usb_chip.hpp"

#include <fcntl.h>
#include <linux/usbdevice_fs.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstdlib>
#include <span>

namespace spm::test {

namespace {

using std::chrono::milliseconds;

constexpr std::size_t packet_data = 62;
constexpr unsigned char in_endpoint = 0x81, out_endpoint = 0x02;
constexpr std::size_t setup_size = 8;

usbdevfs_urb& urb_of(UMockdevIoctlData* data) {
  return *reinterpret_cast<usbdevfs_urb*>(data->data);
}

}  // namespace

MockUsbChip::MockUsbChip(ScriptedFalcon& falcon, std::uint64_t late_every, milliseconds late_by)
    : falcon_(falcon), late_every_(late_every), late_by_(late_by) {
  master_ = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
  if (master_ < 0 || grantpt(master_) != 0 || unlockpt(master_) != 0) std::abort();
  terminal_ = ptsname(master_);
  slave_ = open(terminal_.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
  if (slave_ < 0) std::abort();
  termios raw{};
  tcgetattr(slave_, &raw);
  cfmakeraw(&raw);
  tcsetattr(slave_, TCSANOW, &raw);
  tcflow(slave_, TCOOFF);
  timer_ = std::thread([this] { keep_time(); });
}

MockUsbChip::~MockUsbChip() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  changed_.notify_all();
  timer_.join();
  for (const std::deque<Transfer>* const list : {&reading_, &ended_}) {
    for (const Transfer& transfer : *list) let_go(transfer);
  }
  // A program that has the node open yet was killed. Its client is not let go: umockdev would
  // complain of its open stream, behind the report.
  tcflow(slave_, TCOON);
  close(slave_);
  close(master_);
}

bool MockUsbChip::handle(UMockdevIoctlClient* client) {
  const std::lock_guard lock(mutex_);
  if (std::find(clients_.begin(), clients_.end(), client) == clients_.end()) {
    // Kept, so that a new one cannot have its address where this one vanishes without a word.
    clients_.push_back(UMOCKDEV_IOCTL_CLIENT(g_object_ref(client)));
  }
  const auto request = static_cast<unsigned long>(umockdev_ioctl_client_get_request(client));
  if (is_dead(client) && request != USBDEVFS_REAPURBNDELAY && request != USBDEVFS_REAPURB) {
    umockdev_ioctl_client_complete(client, -1, ENODEV);
    return true;
  }
  switch (request) {
    case USBDEVFS_GET_CAPABILITIES: {
      UMockdevIoctlData* const arg = umockdev_ioctl_client_get_arg(client);
      UMockdevIoctlData* const data =
          umockdev_ioctl_data_resolve(arg, 0, sizeof(std::uint32_t), nullptr);
      *reinterpret_cast<std::uint32_t*>(data->data) =
          USBDEVFS_CAP_ZERO_PACKET | USBDEVFS_CAP_BULK_CONTINUATION |
          USBDEVFS_CAP_NO_PACKET_SIZE_LIM | USBDEVFS_CAP_BULK_SCATTER_GATHER |
          USBDEVFS_CAP_REAP_AFTER_DISCONNECT;
      umockdev_ioctl_client_complete(client, 0, 0);
      g_object_unref(data);
      return true;
    }
    case USBDEVFS_SUBMITURB:
      submit(client);
      return true;
    case USBDEVFS_REAPURB:
    case USBDEVFS_REAPURBNDELAY:
      reap(client);
      return true;
    case USBDEVFS_DISCARDURB:
      discard(client);
      return true;
    case USBDEVFS_GETDRIVER:
      umockdev_ioctl_client_complete(client, -1, ENODATA);
      return true;
    case USBDEVFS_IOCTL:
      // Only USBDEVFS_DISCONNECT is ever asked for.
      umockdev_ioctl_client_complete(client, holder_ != nullptr ? 0 : -1,
                                     holder_ != nullptr ? 0 : ENODATA);
      end_claim();
      return true;
    case USBDEVFS_CLAIMINTERFACE:
    case USBDEVFS_DISCONNECT_CLAIM: {
      const bool claimed = claim(client);
      umockdev_ioctl_client_complete(client, claimed ? 0 : -1, claimed ? 0 : EBUSY);
      return true;
    }
    case USBDEVFS_RELEASEINTERFACE:
      if (client == holder_) end_claim();
      umockdev_ioctl_client_complete(client, 0, 0);
      return true;
    case USBDEVFS_SETCONFIGURATION:
    case USBDEVFS_SETINTERFACE:
    case USBDEVFS_CLEAR_HALT:
    case USBDEVFS_RESET:
      umockdev_ioctl_client_complete(client, 0, 0);
      return true;
    default:
      return false;
  }
}

void MockUsbChip::forget(UMockdevIoctlClient* client) {
  const std::lock_guard lock(mutex_);
  if (std::find(clients_.begin(), clients_.end(), client) != clients_.end()) close_by(client);
}

void MockUsbChip::close_by(UMockdevIoctlClient* client) {
  for (std::deque<Transfer>* const list : {&reading_, &ended_}) {
    std::erase_if(*list, [client](const Transfer& transfer) {
      if (transfer.client == client) let_go(transfer);
      return transfer.client == client;
    });
  }
  if (ended_.empty()) tcflow(slave_, TCOOFF);
  if (client == holder_) end_claim();
  std::erase(dead_clients_, client);
  std::erase(clients_, client);
  g_object_unref(client);
}

bool MockUsbChip::is_dead(UMockdevIoctlClient* client) const {
  return std::find(dead_clients_.begin(), dead_clients_.end(), client) != dead_clients_.end();
}

bool MockUsbChip::claim(UMockdevIoctlClient* client) {
  if (refuses_claims_ || (holder_ != nullptr && holder_ != client)) return false;
  holder_ = client;
  return true;
}

void MockUsbChip::end_claim() {
  end_reading(-ENOENT);
  answers_.clear();
  holder_ = nullptr;
}

void MockUsbChip::end_reading(int status) {
  while (!reading_.empty()) {
    const Transfer transfer = reading_.front();
    reading_.pop_front();
    end(transfer, status, 0);
  }
}

void MockUsbChip::unplug() {
  const std::lock_guard lock(mutex_);
  end_reading(-ESHUTDOWN);
  end_claim();
  dead_clients_ = clients_;
}

void MockUsbChip::lose_power() {
  const std::lock_guard lock(mutex_);
  falcon_.lose_power();
}

void MockUsbChip::mute_after(std::uint64_t packets) {
  const std::lock_guard lock(mutex_);
  mute_after_ = packets;
}

void MockUsbChip::refuse_claims() {
  const std::lock_guard lock(mutex_);
  refuses_claims_ = true;
}

std::uint64_t MockUsbChip::packets() const {
  const std::lock_guard lock(mutex_);
  return falcon_.packets();
}

void MockUsbChip::submit(UMockdevIoctlClient* client) {
  UMockdevIoctlData* const arg = umockdev_ioctl_client_get_arg(client);
  UMockdevIoctlData* const urb = umockdev_ioctl_data_resolve(arg, 0, sizeof(usbdevfs_urb), nullptr);
  // The memory of a program that was killed in the meantime cannot be read.
  if (urb == nullptr) {
    umockdev_ioctl_client_complete(client, -1, EFAULT);
    return;
  }
  UMockdevIoctlData* const buffer = umockdev_ioctl_data_resolve(
      urb, offsetof(usbdevfs_urb, buffer), static_cast<gsize>(urb_of(urb).buffer_length), nullptr);
  if (buffer == nullptr) {
    g_object_unref(urb);
    umockdev_ioctl_client_complete(client, -1, EFAULT);
    return;
  }
  const Transfer transfer{client, urb, buffer};
  // The kernel claims the interface for a program that has not.
  if (!claim(client)) {
    let_go(transfer);
    umockdev_ioctl_client_complete(client, -1, EBUSY);
    return;
  }
  umockdev_ioctl_client_complete(client, 0, 0);
  if (urb_of(urb).type == USBDEVFS_URB_TYPE_BULK && urb_of(urb).endpoint == in_endpoint) {
    reading_.push_back(transfer);
    send_due_packets(Clock::now());
    changed_.notify_all();
  } else {
    write(transfer);
  }
}

void MockUsbChip::write(const Transfer& transfer) {
  const usbdevfs_urb& urb = urb_of(transfer.urb);
  const std::span<const std::uint8_t> bytes(transfer.buffer->data,
                                            static_cast<std::size_t>(urb.buffer_length));
  if (urb.type == USBDEVFS_URB_TYPE_BULK && urb.endpoint == out_endpoint) {
    falcon_.receive(bytes);
    end(transfer, 0, urb.buffer_length);
  } else if (urb.type == USBDEVFS_URB_TYPE_CONTROL && bytes.size() >= setup_size &&
             bytes[0] == 0x40) {
    const auto value = static_cast<std::uint16_t>(bytes[2] | bytes[3] << 8U);
    falcon_.control(bytes[1], value);
    if (bytes[1] == 0 && value != 2) answers_.clear();
    end(transfer, 0, 0);
  } else {
    end(transfer, -EPIPE, 0);
  }
  send_due_packets(Clock::now());
  changed_.notify_all();
}

void MockUsbChip::end(const Transfer& transfer, int status, int length) {
  urb_of(transfer.urb).status = status;
  urb_of(transfer.urb).actual_length = length;
  ended_.push_back(transfer);
  tcflow(slave_, TCOON);
}

void MockUsbChip::reap(UMockdevIoctlClient* client) {
  const auto found = std::find_if(ended_.begin(), ended_.end(), [client](const Transfer& transfer) {
    return transfer.client == client;
  });
  if (found == ended_.end()) {
    umockdev_ioctl_client_complete(client, -1, is_dead(client) ? ENODEV : EAGAIN);
    return;
  }
  UMockdevIoctlData* const arg = umockdev_ioctl_client_get_arg(client);
  UMockdevIoctlData* const pointer = umockdev_ioctl_data_resolve(arg, 0, sizeof(void*), nullptr);
  if (pointer == nullptr) {
    umockdev_ioctl_client_complete(client, -1, EFAULT);
    return;
  }
  const Transfer transfer = *found;
  ended_.erase(found);
  if (ended_.empty()) tcflow(slave_, TCOOFF);
  umockdev_ioctl_data_set_ptr(pointer, 0, transfer.urb);
  umockdev_ioctl_client_complete(client, 0, 0);
  g_object_unref(pointer);
  let_go(transfer);
}

void MockUsbChip::discard(UMockdevIoctlClient* client) {
  UMockdevIoctlData* const arg = umockdev_ioctl_client_get_arg(client);
  const auto address = *reinterpret_cast<const gulong*>(arg->data);
  const auto found = std::find_if(reading_.begin(), reading_.end(), [&](const Transfer& transfer) {
    return transfer.client == client && transfer.urb->client_addr == address;
  });
  if (found == reading_.end()) {
    umockdev_ioctl_client_complete(client, -1, EINVAL);
    return;
  }
  const Transfer transfer = *found;
  reading_.erase(found);
  end(transfer, -ENOENT, 0);
  umockdev_ioctl_client_complete(client, 0, 0);
}

void MockUsbChip::take_answers(Clock::time_point now) {
  if (now < held_until_) return;
  auto& outgoing = falcon_.outgoing();
  if (falcon_.packets() > heard_) {
    heard_ = falcon_.packets();
    if (late_every_ > 0 && heard_ % late_every_ == 0) {
      held_until_ = now + late_by_;
      return;
    }
  }
  if (falcon_.packets() > mute_after_) outgoing.clear();
  answers_.insert(answers_.end(), outgoing.begin(), outgoing.end());
  outgoing.clear();
}

void MockUsbChip::send_due_packets(Clock::time_point now) {
  take_answers(now);
  const auto latency = milliseconds(falcon_.latency_ms());
  while (!reading_.empty() && (answers_.size() >= packet_data || now - last_packet_ >= latency)) {
    send_packet();
    last_packet_ = now;
  }
}

void MockUsbChip::send_packet() {
  const Transfer transfer = reading_.front();
  reading_.pop_front();
  const std::size_t size = std::min(answers_.size(), packet_data);
  transfer.buffer->data[0] = 0x01;
  transfer.buffer->data[1] = 0x60;
  std::copy_n(answers_.begin(), size, transfer.buffer->data + 2);
  answers_.erase(answers_.begin(), answers_.begin() + static_cast<std::ptrdiff_t>(size));
  end(transfer, 0, static_cast<int>(size) + 2);
}

void MockUsbChip::keep_time() {
  std::unique_lock lock(mutex_);
  while (!stop_) {
    const Clock::time_point now = Clock::now();
    send_due_packets(now);
    if (reading_.empty()) {
      changed_.wait(lock);
    } else {
      const auto latency = milliseconds(falcon_.latency_ms());
      changed_.wait_until(lock,
                          std::max(last_packet_ + latency, now + std::chrono::microseconds(100)));
    }
  }
}

void MockUsbChip::let_go(const Transfer& transfer) {
  if (transfer.buffer != nullptr) g_object_unref(transfer.buffer);
  g_object_unref(transfer.urb);
}

}  // namespace spm::test
