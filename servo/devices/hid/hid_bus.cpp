// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/hid/hid_bus.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <hidapi/hidapi.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <mutex>

namespace spm::servo {

namespace {

/// hidapi keeps one error text for the whole process, which opening, closing and listing replace.
std::mutex& hidapi_mutex() {
  static std::mutex mutex;
  return mutex;
}

/// UTF-8 of hidapi's wide text, which may be null. An invalid code point becomes a question mark.
std::string narrow(const wchar_t* text) {
  std::string result;
  if (text == nullptr) return result;
  for (; *text != L'\0'; ++text) {
    const auto code = static_cast<char32_t>(*text);
    const auto tail = [&result, code](unsigned shift) {
      result += static_cast<char>(0x80U | ((code >> shift) & 0x3FU));
    };
    if (code < 0x80) {
      result += static_cast<char>(code);
    } else if (code < 0x800) {
      result += static_cast<char>(0xC0U | (code >> 6U));
      tail(0);
    } else if (code < 0x10000 && (code < 0xD800 || code > 0xDFFF)) {
      result += static_cast<char>(0xE0U | (code >> 12U));
      tail(6);
      tail(0);
    } else if (code >= 0x10000 && code < 0x110000) {
      result += static_cast<char>(0xF0U | (code >> 18U));
      tail(12);
      tail(6);
      tail(0);
    } else {
      result += '?';
    }
  }
  return result;
}

/// Why hidapi failed; never empty. Call it under the mutex, right after the call that failed.
std::string hidapi_reason(int error_number) {
  std::string text = narrow(hid_error(nullptr));
  // hidapi says "Success" if it kept no text.
  if (!text.empty() && text != "Success") return text;
  if (error_number != 0) return std::strerror(error_number);
  return "hidapi gives no reason";
}

std::string named(const HidDevice& device, std::string_view what) {
  return fmt::format("the {} at {} ({:04x}:{:04x})", what, device.path, device.vendor,
                     device.product);
}

tl::unexpected<Error> open_error(const HidDevice& device, std::string_view what, int error_number) {
  const std::string name = named(device, what);
  switch (error_number) {
    case EACCES:
    case EPERM:
      return fail(ExitCode::file_or_device,
                  name + " may not be opened by this user (" + std::strerror(error_number) +
                      "): copy scripts/packaging/70-spm-haptics.rules to /etc/udev/rules.d, or do "
                      "what spm-servo devices says, and plug the device in again");
    case EBUSY:
    case EWOULDBLOCK:
      return fail(ExitCode::file_or_device,
                  name + " is in use by another program: end that one, such as another spm-servo");
    case ENOENT:
    case ENODEV:
    case ENXIO:
      return fail(ExitCode::file_or_device,
                  name + " was unplugged (" + std::strerror(error_number) + "): plug it in again");
    default:
      return fail(ExitCode::file_or_device, name + " cannot be opened (" +
                                                std::strerror(error_number) +
                                                "): plug it in again, or try another USB port");
  }
}

}  // namespace

class HidLibrary {
 public:
  /// Call it under the mutex. Null if hidapi does not start.
  static std::shared_ptr<HidLibrary> use() {
    static std::weak_ptr<HidLibrary> used;
    auto library = used.lock();
    if (library != nullptr) return library;
    if (hid_init() != 0) return nullptr;
    library = std::make_shared<HidLibrary>();
    used = library;
    return library;
  }

  HidLibrary() = default;
  HidLibrary(const HidLibrary&) = delete;
  HidLibrary& operator=(const HidLibrary&) = delete;
  ~HidLibrary() { hid_exit(); }
};

Result<std::vector<HidDevice>> list_hid_devices() {
  const std::lock_guard lock(hidapi_mutex());
  const auto library = HidLibrary::use();
  if (library == nullptr) {
    return fail(ExitCode::file_or_device,
                "HID devices cannot be listed (" + hidapi_reason(0) + "): install libhidapi again");
  }
  std::vector<HidDevice> devices;
  hid_device_info* all = hid_enumerate(0, 0);  // null where there is none
  for (const hid_device_info* info = all; info != nullptr; info = info->next) {
    if (info->path == nullptr) continue;
    devices.push_back({info->path, info->vendor_id, info->product_id, info->usage_page, info->usage,
                       info->interface_number, narrow(info->product_string),
                       narrow(info->serial_number)});
  }
  hid_free_enumeration(all);
  std::stable_sort(devices.begin(), devices.end(),
                   [](const HidDevice& a, const HidDevice& b) { return a.path < b.path; });
  return devices;
}

HidHandle::HidHandle(std::shared_ptr<HidLibrary> library, hid_device_* handle, int claim) noexcept
    : library_(std::move(library)), handle_(handle), claim_(claim) {}

HidHandle::~HidHandle() {
  const std::lock_guard lock(hidapi_mutex());
  hid_close(handle_);
  if (claim_ >= 0) close(claim_);
  library_.reset();
}

Result<std::unique_ptr<HidHandle>> HidHandle::open(const HidDevice& device, std::string_view what,
                                                   HidUse use) {
  // The node is opened once more beside hidapi, which reports no error number and locks nothing.
  int claim = ::open(device.path.c_str(), O_RDWR | O_CLOEXEC | O_NOCTTY);
  if (claim < 0) return open_error(device, what, errno);
  if (use == HidUse::alone && flock(claim, LOCK_EX | LOCK_NB) != 0) {
    const int error_number = errno;
    close(claim);
    return open_error(device, what, error_number);
  }
  if (use == HidUse::shared) {
    close(claim);
    claim = -1;
  }
  const std::lock_guard lock(hidapi_mutex());
  auto library = HidLibrary::use();
  errno = 0;
  hid_device* handle = library != nullptr ? hid_open_path(device.path.c_str()) : nullptr;
  if (handle == nullptr) {
    const std::string reason = hidapi_reason(errno);
    if (claim >= 0) close(claim);
    return fail(ExitCode::file_or_device, named(device, what) + " cannot be opened (" + reason +
                                              "): plug it in again, or try another USB port");
  }
  return std::unique_ptr<HidHandle>(new HidHandle(std::move(library), handle, claim));
}

int HidHandle::read(std::span<std::uint8_t> bytes, int milliseconds) noexcept {
  errno = 0;
  const int count = hid_read_timeout(handle_, bytes.data(), bytes.size(), milliseconds);
  // A signal to some thread of the program is no loss of the device.
  return count < 0 && errno == EINTR ? 0 : count;
}

bool HidHandle::write(std::span<const std::uint8_t> bytes) noexcept {
  for (int attempt = 0; attempt < 2; ++attempt) {
    errno = 0;
    if (hid_write(handle_, bytes.data(), bytes.size()) >= 0) return true;
    if (errno != EINTR) return false;
  }
  return true;  // twice interrupted: this report is lost, the next one is due soon
}

bool HidHandle::send_feature(std::span<const std::uint8_t> bytes) noexcept {
  return hid_send_feature_report(handle_, bytes.data(), bytes.size()) >= 0;
}

int HidHandle::get_feature(std::span<std::uint8_t> bytes) noexcept {
  return hid_get_feature_report(handle_, bytes.data(), bytes.size());
}

int HidHandle::get_input(std::span<std::uint8_t> bytes) noexcept {
  return hid_get_input_report(handle_, bytes.data(), bytes.size());
}

Result<OpenHid> open_hid(const HidFilter& filter, HidUse use) {
  const auto devices = list_hid_devices();
  if (!devices) return tl::make_unexpected(devices.error());
  Result<OpenHid> result =
      fail(ExitCode::file_or_device,
           fmt::format("no {}{} is plugged in: plug it in and switch it on, or check the cable",
                       filter.what,
                       filter.serial.empty() ? "" : " with the serial number " + filter.serial));
  for (const HidDevice& device : *devices) {
    if (!filter.fits(device) || (!filter.serial.empty() && device.serial != filter.serial)) {
      continue;
    }
    auto handle = HidHandle::open(device, filter.what, use);
    if (handle) return OpenHid{device, std::move(*handle)};
    result = tl::make_unexpected(handle.error());
  }
  return result;
}

}  // namespace spm::servo
