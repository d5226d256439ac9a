// SPDX-License-Identifier: Apache-2.0
/// A WoodenHaptics board that a real kernel takes for one: its HID reports go through /dev/uhid to
/// the kernel's HID core and hidraw.
///
///     uhid_wooden wooden-v1|wooden-v2|wooden-v3 [unplug=REPORTS:MS] [times=COUNT] report=FILE
///
/// Ends at SIGTERM, and writes what the board saw (JSON); with exit code 70 where it was sent what
/// its protocol does not know.
#include <fcntl.h>
#include <linux/input.h>
#include <linux/uhid.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <deque>
#include <exception>
#include <memory>
#include <thread>
#include <vector>

#include "tests/servo/devices/hid/emulated_hid.hpp"
#include "tests/servo/virtual_machine/emulator_program.hpp"

namespace spm::test {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr int wrong_packet_code = 70;
constexpr milliseconds longest_wait{50};  // between two looks at the signal
constexpr milliseconds frame_time{1};

/// Copies text into a field that ends with a zero.
void put_text(void* field, std::size_t size, const std::string& text) {
  std::memcpy(field, text.data(), std::min(text.size(), size - 1));
}

/// The kernel's side of a HID device.
class Uhid {
 public:
  Uhid() : file_(open("/dev/uhid", O_RDWR | O_CLOEXEC)) {
    if (file_ < 0) give_up("/dev/uhid cannot be opened");
  }
  Uhid(const Uhid&) = delete;
  Uhid& operator=(const Uhid&) = delete;
  ~Uhid() { close(file_); }

  void create(const HidIdentity& identity) {
    uhid_event event{};
    event.type = UHID_CREATE2;
    put_text(&event.u.create2.name, sizeof event.u.create2.name, identity.name);
    put_text(&event.u.create2.uniq, sizeof event.u.create2.uniq, identity.serial);
    event.u.create2.bus = BUS_USB;
    event.u.create2.vendor = identity.vendor;
    event.u.create2.product = identity.product;
    event.u.create2.rd_size = static_cast<__u16>(identity.descriptor.size());
    std::memcpy(event.u.create2.rd_data, identity.descriptor.data(), identity.descriptor.size());
    give(event);
  }

  void destroy() {
    uhid_event event{};
    event.type = UHID_DESTROY;
    give(event);
  }

  void send(const HidBytes& report) {
    uhid_event event{};
    event.type = UHID_INPUT2;
    event.u.input2.size = static_cast<__u16>(report.size());
    std::memcpy(event.u.input2.data, report.data(), report.size());
    give(event);
  }

  /// Waits for an event; false where none came in time.
  bool take(uhid_event& event, steady_clock::duration wait) {
    const auto nanoseconds =
        std::max(std::chrono::duration_cast<std::chrono::nanoseconds>(wait).count(), 0L);
    const timespec time{nanoseconds / 1'000'000'000, nanoseconds % 1'000'000'000};
    pollfd events{file_, POLLIN, 0};
    if (ppoll(&events, 1, &time, nullptr) <= 0) return false;
    if (read(file_, &event, sizeof event) < 0) give_up("/dev/uhid cannot be read");
    return true;
  }

 private:
  void give(const uhid_event& event) {
    if (write(file_, &event, sizeof event) < 0) give_up("/dev/uhid cannot be written to");
  }

  int file_;
};

/// The board at the end of its cable.
class Board {
 public:
  Board(std::unique_ptr<EmulatedHid> device, const EmulatorOptions& options)
      : device_(std::move(device)), options_(options) {}

  void run() {
    kernel_.create(device_->identity());
    while (!told_to_end()) {
      uhid_event event{};
      if (kernel_.take(event, next_wait())) hear(event);
      begin_frame();
      if (options_.unplug_after > 0 && unplugged_ < options_.times &&
          reports_ >= options_.unplug_after) {
        unplug();
      }
    }
    kernel_.destroy();
  }

  [[nodiscard]] nlohmann::ordered_json seen() const {
    nlohmann::ordered_json json = device_->seen();
    json["unplugged"] = unplugged_;
    json["commands_with_current_since_plugged_in"] = with_current() - with_current_before_;
    return json;
  }
  [[nodiscard]] int wrong() const { return device_->wrong(); }

 private:
  [[nodiscard]] int with_current() const { return device_->seen()["commands_with_current"]; }

  [[nodiscard]] bool sends_unasked() const { return powered_ && device_->period_ms() > 0; }

  [[nodiscard]] steady_clock::duration next_wait() const {
    if (ready_.empty() && !sends_unasked()) return longest_wait;
    return std::min<steady_clock::duration>(frame_ - steady_clock::now(), longest_wait);
  }

  void hear(const uhid_event& event) {
    if (event.type == UHID_OPEN && !powered_) {
      // It is asked for reports from its first opening on.
      powered_ = true;
      add(device_->plug_in());
    } else if (event.type == UHID_OUTPUT) {
      const auto& output = event.u.output;
      add(device_->written(HidBytes(output.data, output.data + output.size)));
    }
  }

  void add(const std::vector<HidBytes>& reports) {
    ready_.insert(ready_.end(), reports.begin(), reports.end());
  }

  /// Acts as a full-speed host: asks for a report each millisecond, whether a program reads them
  /// or not. A frame that comes late is late; none is made up for.
  void begin_frame() {
    const auto now = steady_clock::now();
    if (now < frame_) return;
    if (sends_unasked()) add(device_->unasked());
    if (ready_.empty()) return;
    frame_ = std::max(frame_ + frame_time, now);
    kernel_.send(ready_.front());
    ready_.pop_front();
    ++reports_;
    add(device_->taken());
  }

  void unplug() {
    kernel_.destroy();
    powered_ = false;
    ready_.clear();
    reports_ = 0;
    ++unplugged_;
    with_current_before_ = with_current();
    std::this_thread::sleep_for(options_.away);
    uhid_event event{};
    while (kernel_.take(event, milliseconds(0))) {  // drop events for the unplugged device
    }
    kernel_.create(device_->identity());
  }

  Uhid kernel_;
  std::unique_ptr<EmulatedHid> device_;
  EmulatorOptions options_;
  bool powered_ = false;
  std::deque<HidBytes> ready_;        ///< reports that the host has not fetched
  steady_clock::time_point frame_{};  ///< when the next begins
  std::uint64_t reports_ = 0;         ///< fetched since it was plugged in
  int unplugged_ = 0, with_current_before_ = 0;
};

int run(const EmulatorOptions& options) {
  auto device = make_emulated_hid(options.words.front(), {});
  if (device == nullptr) give_up("uhid_wooden: no device is called " + options.words.front());
  enter_emulator();
  Board board(std::move(device), options);
  board.run();
  write_report(options.report, board.seen());
  return board.wrong() > 0 ? wrong_packet_code : 0;
}

}  // namespace
}  // namespace spm::test

int main(int count, char** arguments) try {
  const auto options = spm::test::parse_emulator_options(count, arguments);
  if (!options || options->words.size() != 1 || options->report.empty()) {
    std::fprintf(stderr,
                 "usage: uhid_wooden wooden-v1|wooden-v2|wooden-v3 [unplug=REPORTS:MS] "
                 "[times=COUNT] report=FILE\n");
    return 1;
  }
  return spm::test::run(*options);
} catch (const std::exception& problem) {
  std::fprintf(stderr, "uhid_wooden: %s\n", problem.what());
  return 4;
}
