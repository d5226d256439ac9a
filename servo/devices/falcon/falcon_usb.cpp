// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/falcon/falcon_usb.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <libusb-1.0/libusb.h>
#include <linux/usbdevice_fs.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <span>
#include <utility>

#include "servo/devices/base/usb_place.hpp"

namespace spm::servo {

namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr int data_interface = 0;
constexpr std::uint8_t out_endpoint = 0x02;
constexpr std::uint8_t vendor_request = 0x40;  // to the device itself
constexpr unsigned control_timeout = 1000;     // ms
constexpr std::uint8_t reset_request = 0;
constexpr std::uint16_t purge_sending = 2;

struct DeviceListDeleter {
  void operator()(libusb_device** list) const noexcept { libusb_free_device_list(list, 1); }
};
using DeviceList = std::unique_ptr<libusb_device*, DeviceListDeleter>;

struct FoundFalcon {
  libusb_device* device;
  std::string path;
};

/// Falcons in a list of devices, which must outlive them.
struct Found {
  DeviceList list;
  std::vector<FoundFalcon> falcons;
};

Result<UsbContext> make_context() {
  libusb_context* context = nullptr;
  const int code = libusb_init(&context);
  if (code == LIBUSB_SUCCESS) return UsbContext(context);
  return fail(ExitCode::file_or_device,
              fmt::format("USB cannot be used here ({}); check that /dev/bus/usb exists and may be "
                          "read, or name another --device",
                          libusb_error_name(code)));
}

Result<Found> find_falcons(libusb_context* context, std::uint16_t product) {
  libusb_device** list = nullptr;
  const ssize_t count = libusb_get_device_list(context, &list);
  if (count < 0) {
    return fail(ExitCode::file_or_device,
                fmt::format("the USB devices cannot be listed ({}); check that /dev/bus/usb may be "
                            "read",
                            libusb_error_name(static_cast<int>(count))));
  }
  Found found;
  found.list.reset(list);
  for (libusb_device* device : std::span(list, static_cast<std::size_t>(count))) {
    libusb_device_descriptor descriptor{};
    if (libusb_get_device_descriptor(device, &descriptor) != LIBUSB_SUCCESS) continue;
    if (descriptor.idVendor == falcon_vendor && descriptor.idProduct == product) {
      found.falcons.push_back({device, usb_place(device)});
    }
  }
  return found;
}

tl::unexpected<Error> not_found(const std::string& path, std::uint16_t product,
                                std::span<const FoundFalcon> falcons) {
  if (path.empty() || falcons.empty()) {
    return fail(ExitCode::file_or_device,
                fmt::format("no Novint Falcon (USB {:04x}:{:04x}) is plugged in; plug in its USB "
                            "cable and its power supply",
                            falcon_vendor, product));
  }
  std::string paths;
  for (const FoundFalcon& falcon : falcons) paths.append(" ").append(falcon.path);
  return fail(
      ExitCode::file_or_device,
      fmt::format("no Novint Falcon is plugged in at the USB path {}, but there is one at{}; "
                  "name its path, or leave it away",
                  path, paths));
}

tl::unexpected<Error> not_opened(const std::string& path, int code) {
  const std::string what = fmt::format("the Novint Falcon at the USB path {} ", path);
  switch (code) {
    case LIBUSB_ERROR_ACCESS:
      return fail(ExitCode::file_or_device,
                  what +
                      "may not be opened by you; copy scripts/packaging/70-spm-haptics.rules to "
                      "/etc/udev/rules.d and plug the device in again");
    case LIBUSB_ERROR_BUSY:
      return fail(ExitCode::file_or_device,
                  what + "is used by another program; end that program, then start again");
    case LIBUSB_ERROR_NO_DEVICE:
      return fail(ExitCode::file_or_device,
                  what + "was unplugged while it was opened; plug it in again");
    default:
      return fail(ExitCode::file_or_device,
                  what + fmt::format("cannot be opened ({}); plug its USB cable in again, at "
                                     "another port or without a hub",
                                     libusb_error_name(code)));
  }
}

/// Makes the kernel end another program's claim, which libusb does not offer. If that fails, the
/// claim that follows fails too, with the reason.
void take_from_others(libusb_device* device) noexcept {
  const std::string node = fmt::format("/dev/bus/usb/{:03}/{:03}", libusb_get_bus_number(device),
                                       libusb_get_device_address(device));
  const int file = ::open(node.c_str(), O_RDWR | O_CLOEXEC);
  if (file < 0) return;
  usbdevfs_ioctl request{};
  request.ifno = data_interface;
  request.ioctl_code = USBDEVFS_DISCONNECT;
  static_cast<void>(ioctl(file, USBDEVFS_IOCTL, &request));
  close(file);
}

/// Opens a device and claims its interface. Returns libusb's error code if that fails.
int open_and_claim(libusb_device* device, UsbClaim claim, UsbHandle& handle) {
  libusb_device_handle* opened = nullptr;
  int code = libusb_open(device, &opened);
  if (code != LIBUSB_SUCCESS) return code;
  UsbHandle owned(opened);
  // Debian's kernel has no driver for this device, but a user may have bound one by hand. If
  // detaching is not supported, there is nothing to detach.
  static_cast<void>(libusb_set_auto_detach_kernel_driver(opened, 1));
  code = libusb_claim_interface(opened, data_interface);
  if (code == LIBUSB_ERROR_BUSY && claim == UsbClaim::take_over) {
    take_from_others(device);
    code = libusb_claim_interface(opened, data_interface);
  }
  if (code == LIBUSB_SUCCESS) handle = std::move(owned);
  return code;
}

LinkStatus status_of(int code) {
  switch (code) {
    case LIBUSB_SUCCESS:
      return LinkStatus::done;
    case LIBUSB_ERROR_TIMEOUT:
      return LinkStatus::timed_out;
    case LIBUSB_ERROR_NO_DEVICE:
      return LinkStatus::gone;
    default:
      return LinkStatus::failed;
  }
}

}  // namespace

void UsbContextDeleter::operator()(libusb_context* context) const noexcept { libusb_exit(context); }

void UsbHandleDeleter::operator()(libusb_device_handle* handle) const noexcept {
  libusb_close(handle);
}

Result<std::vector<std::string>> list_falcons() {
  const Result<UsbContext> context = make_context();
  if (!context) return tl::make_unexpected(context.error());
  const Result<Found> found = find_falcons(context->get(), falcon_product);
  if (!found) return tl::make_unexpected(found.error());
  std::vector<std::string> paths;
  for (const FoundFalcon& falcon : found->falcons) paths.push_back(falcon.path);
  return paths;
}

FalconUsb::FalconUsb(UsbContext context, UsbHandle handle, std::string path)
    : context_(std::move(context)), handle_(std::move(handle)), path_(std::move(path)) {}

Result<std::unique_ptr<FalconUsb>> FalconUsb::open(const std::string& path, std::uint16_t product,
                                                   UsbClaim claim) {
  Result<UsbContext> context = make_context();
  if (!context) return tl::make_unexpected(std::move(context.error()));
  const Result<Found> found = find_falcons(context->get(), product);
  if (!found) return tl::make_unexpected(found.error());

  const FoundFalcon* refused = nullptr;
  int refusal = LIBUSB_SUCCESS;
  for (const FoundFalcon& falcon : found->falcons) {
    if (!path.empty() && falcon.path != path) continue;
    UsbHandle handle;
    const int code = open_and_claim(falcon.device, claim, handle);
    if (code == LIBUSB_SUCCESS) {
      return std::unique_ptr<FalconUsb>(
          new FalconUsb(std::move(*context), std::move(handle), falcon.path));
    }
    if (refused == nullptr) {
      refused = &falcon;
      refusal = code;
    }
  }
  if (refused != nullptr) return not_opened(refused->path, refusal);
  return not_found(path, product, found->falcons);
}

FalconUsb::~FalconUsb() {
  // Gives the device back to a driver that was detached.
  libusb_release_interface(handle_.get(), data_interface);
}

LinkStatus FalconUsb::control(std::uint8_t request, std::uint16_t value) {
  if (request == reset_request && value != purge_sending) begin_ = end_ = 0;
  const int code = libusb_control_transfer(handle_.get(), vendor_request, request, value, 0,
                                           nullptr, 0, control_timeout);
  return status_of(std::min(code, 0));
}

LinkResult FalconUsb::write(std::span<const std::uint8_t> bytes, milliseconds timeout) {
  int carried = 0;
  // libusb takes a non-constant pointer, although it only reads.
  const int code = libusb_bulk_transfer(
      handle_.get(), out_endpoint, const_cast<unsigned char*>(bytes.data()),
      static_cast<int>(bytes.size()), &carried, static_cast<unsigned>(timeout.count()));
  LinkResult result{status_of(code), static_cast<std::size_t>(std::max(carried, 0))};
  if (result.status == LinkStatus::done && result.bytes < bytes.size()) {
    result.status = LinkStatus::failed;
  }
  return result;
}

LinkResult FalconUsb::read(std::span<std::uint8_t> bytes, milliseconds timeout) {
  const auto due = steady_clock::now() + timeout;
  LinkStatus status = LinkStatus::done;
  // The chip answers in every latency period, mostly with its status alone.
  while (begin_ == end_ && status == LinkStatus::done) {
    const auto left = std::chrono::ceil<milliseconds>(due - steady_clock::now());
    if (left.count() <= 0) return {LinkStatus::timed_out, 0};
    int carried = 0;
    const int code = libusb_bulk_transfer(handle_.get(), falcon_in_endpoint, received_.data(),
                                          static_cast<int>(received_.size()), &carried,
                                          static_cast<unsigned>(left.count()));
    status = status_of(code);
    begin_ = 0;
    end_ = strip_ftdi_status(std::span(received_).first(
        static_cast<std::size_t>(std::clamp(carried, 0, static_cast<int>(received_.size())))));
  }
  const std::size_t taken = std::min(bytes.size(), end_ - begin_);
  std::copy_n(received_.begin() + static_cast<std::ptrdiff_t>(begin_), taken, bytes.begin());
  begin_ += taken;
  return {taken > 0 ? LinkStatus::done : status, taken};
}

}  // namespace spm::servo
