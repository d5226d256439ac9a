// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/falcon/falcon_port.hpp"

#include <fmt/format.h>
#include <libusb-1.0/libusb.h>
#include <sys/time.h>

#include <algorithm>
#include <chrono>
#include <span>
#include <utility>

namespace spm::servo {

namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::steady_clock;

/// A packet takes 0.1 ms; a chip that does not accept one for this long is lost.
constexpr milliseconds send_timeout{200};
/// Time for the reads to return after they were cancelled.
constexpr milliseconds cancel_timeout{1000};
constexpr milliseconds cancel_wait{10};

timeval interval(microseconds time) {
  timeval value{};
  value.tv_sec = static_cast<time_t>(time.count() / 1'000'000);
  value.tv_usec = static_cast<suseconds_t>(time.count() % 1'000'000);
  return value;
}

}  // namespace

FalconPort::FalconPort(std::unique_ptr<FalconUsb> usb)
    : usb_(std::move(usb)), reads_(std::make_unique<std::array<Read, 2>>()) {}

Result<std::unique_ptr<FalconPort>> FalconPort::start(std::unique_ptr<FalconUsb> usb) {
  std::unique_ptr<FalconPort> port(new FalconPort(std::move(usb)));
  const int code = port->post_all();
  if (code == LIBUSB_SUCCESS) return port;
  return fail(ExitCode::file_or_device,
              fmt::format("the Novint Falcon at the USB path {} cannot be read ({}); plug its USB "
                          "cable in again",
                          port->usb_->path(), libusb_error_name(code)));
}

int FalconPort::post_all() {
  const std::lock_guard lock(mutex_);
  for (Read& read : *reads_) {
    read.port = this;
    read.transfer = libusb_alloc_transfer(0);
    if (read.transfer == nullptr) return LIBUSB_ERROR_NO_MEM;
    libusb_fill_bulk_transfer(read.transfer, usb_->handle(), falcon_in_endpoint, read.bytes.data(),
                              static_cast<int>(read.bytes.size()), &FalconPort::ended, &read, 0);
    const int code = libusb_submit_transfer(read.transfer);
    if (code != LIBUSB_SUCCESS) return code;
    ++posted_;
  }
  return LIBUSB_SUCCESS;
}

FalconPort::~FalconPort() {
  {
    const std::lock_guard lock(mutex_);
    closing_ = true;
    for (const Read& read : *reads_) {
      // libusb reports that it is not found if the read has already returned.
      if (read.transfer != nullptr) static_cast<void>(libusb_cancel_transfer(read.transfer));
    }
  }
  const auto due = steady_clock::now() + cancel_timeout;
  while (true) {
    {
      const std::lock_guard lock(mutex_);
      if (posted_ == 0 || steady_clock::now() >= due) break;
    }
    timeval wait = interval(cancel_wait);
    libusb_handle_events_timeout_completed(usb_->context(), &wait, nullptr);
  }
  if (posted_ > 0) {
    // The kernel may still write into them, so it is better to leak them than to reuse them.
    static_cast<void>(reads_.release());
    return;
  }
  for (const Read& read : *reads_) libusb_free_transfer(read.transfer);
}

void FalconPort::ended(libusb_transfer* transfer) {
  Read& read = *static_cast<Read*>(transfer->user_data);
  read.port->take(read);
}

void FalconPort::take(Read& read) {
  const std::lock_guard lock(mutex_);
  if (read.transfer->status != LIBUSB_TRANSFER_COMPLETED || closing_) {
    --posted_;
    gone_ = true;
    return;
  }
  const auto carried = static_cast<std::size_t>(
      std::clamp(read.transfer->actual_length, 0, static_cast<int>(read.bytes.size())));
  const std::size_t size = strip_ftdi_status(std::span(read.bytes).first(carried));
  for (const std::uint8_t byte : std::span(read.bytes).first(size)) {
    if (const auto report = parser_.take(byte)) {
      newest_ = *report;
      fresh_ = true;
    }
  }
  if (libusb_submit_transfer(read.transfer) == LIBUSB_SUCCESS) return;
  --posted_;
  gone_ = true;
}

Received FalconPort::receive(FalconReport& report) {
  const auto due = steady_clock::now() + port_wait;
  while (true) {
    {
      const std::lock_guard lock(mutex_);
      if (gone_) return Received::gone;
      if (std::exchange(fresh_, false)) {
        report = newest_;
        return Received::report;
      }
    }
    const auto left = std::chrono::duration_cast<microseconds>(due - steady_clock::now());
    if (left.count() <= 0) return Received::nothing;
    timeval wait = interval(left);
    const int code = libusb_handle_events_timeout_completed(usb_->context(), &wait, nullptr);
    if (code != LIBUSB_SUCCESS && code != LIBUSB_ERROR_INTERRUPTED) return Received::gone;
  }
}

bool FalconPort::send(const FalconCommand& command) {
  const auto packet = encode(command);
  return usb_->write(packet, send_timeout).status == LinkStatus::done;
}

}  // namespace spm::servo
