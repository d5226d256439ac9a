// SPDX-License-Identifier: Apache-2.0
#include "tests/servo/devices/hid/emulated_hid.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <random>

#include "servo/base/clock.hpp"
#include "tests/servo/devices/hid/emulated_pid.hpp"

namespace spm::test {

namespace {

void put(HidBytes& bytes, int value) {
  const auto bits = static_cast<std::uint16_t>(static_cast<std::int16_t>(value));
  bytes.push_back(static_cast<std::uint8_t>(bits & 0xFFU));
  bytes.push_back(static_cast<std::uint8_t>(bits >> 8U));
}

int get(const HidBytes& bytes, std::size_t offset) {
  return static_cast<std::int16_t>(bytes[offset] | (bytes[offset + 1] << 8));
}

/// Raw HID: one report of so many bytes each way, no report ids.
HidBytes raw_descriptor(std::size_t size) {
  const auto count = static_cast<std::uint8_t>(size);
  return {0x06, 0xAB, 0xFF,  0x0A, 0x00, 0x02, 0xA1, 0x01, 0x75,  0x08, 0x15, 0x00, 0x26, 0xFF,
          0x00, 0x95, count, 0x09, 0x01, 0x81, 0x02, 0x95, count, 0x09, 0x02, 0x91, 0x02, 0xC0};
}

enum class Wire { v1, v2, v3 };

/// A board of the WoodenHaptics family, whose arm is swung by somebody: its counters follow sines.
class EmulatedWooden final : public EmulatedHid {
 public:
  EmulatedWooden(Wire wire, const EmulatedOptions& options) : wire_(wire), options_(options) {}

  [[nodiscard]] HidIdentity identity() const override {
    if (wire_ == Wire::v3) {
      return {0x16C0, 0x0486, "Teensyduino RawHID", "7654321", raw_descriptor(64)};
    }
    return {0x1234, 0x0006, "HID DEVICE", "0123456789", raw_descriptor(size())};
  }

  [[nodiscard]] int period_ms() const override { return wire_ == Wire::v1 ? 1 : 0; }

  std::vector<HidBytes> plug_in() override {
    offset_ = options_.start;
    gimbal_ = {};
    pressed_ = false;
    waiting_ = false;
    answered_ = false;
    if (wire_ == Wire::v1 || (options_.quiet && !quiet_once_)) {
      quiet_once_ = true;
      return {};
    }
    return send();
  }

  std::vector<HidBytes> unasked() override { return send(); }

  std::vector<HidBytes> written(const HidBytes& bytes) override {
    ++commands_;
    if (bytes.size() != size() + 1 || bytes[0] != 0) {
      ++wrong_;
      return {};
    }
    if (wire_ == Wire::v1) {
      take_currents(bytes);
      return {};
    }
    if (std::any_of(bytes.begin() + 15, bytes.end(), [](auto byte) { return byte != 0; })) {
      ++wrong_;
    }
    const int request = get(bytes, 7);
    if (request == 1) {
      set_counters(bytes);
    } else if (request == 0) {
      take_currents(bytes);
    } else {
      ++wrong_;
    }
    // One answer for one command; while an answer waits to be fetched the newest command counts.
    if (waiting_) {
      answered_ = true;
      return {};
    }
    return send();
  }

  std::vector<HidBytes> taken() override {
    if (wire_ == Wire::v1) return {};
    waiting_ = false;
    if (!answered_) return {};
    answered_ = false;
    return send();
  }

  [[nodiscard]] nlohmann::ordered_json seen() const override {
    return {{"reports", reports_},
            {"commands", commands_},
            {"wrong_commands", wrong_},
            {"set_counters", sets_},
            {"commands_with_current_before_set", before_set_},
            {"commands_with_current", with_current_},
            {"largest_mA", largest_},
            {"last_mA", last_},
            {"current_began_ns", began_ns_},
            {"current_ended_ns", ended_ns_},
            {"last_current_ns", last_current_ns_},
            {"steps", steps_}};
  }
  [[nodiscard]] int wrong() const override { return wrong_; }

 private:
  [[nodiscard]] std::size_t size() const {
    return wire_ == Wire::v1 ? 8 : wire_ == Wire::v2 ? 14 : 64;
  }

  /// Counts of the swung arm, which are 0 at the first report.
  [[nodiscard]] std::array<int, 3> swing() const {
    if (options_.step > 0) return {0, 0, inwards_ ? options_.step : -options_.step};
    const double time = reports_ * 1e-3;
    const auto sine = [time](double size, double hertz) {
      return static_cast<int>(std::lround(size * std::sin(2 * std::numbers::pi * hertz * time)));
    };
    return {sine(300, 0.7), sine(200, 0.5), sine(250, 0.9)};
  }

  /// Steps to the other side when it is time to, and notes when.
  void step_on() {
    if (options_.step == 0 || stepped_ns_ != 0 || --until_step_ > 0) return;
    inwards_ = !inwards_;
    stepped_ns_ = servo::now_ns();
    until_step_ = options_.step_every + static_cast<int>(random_()) % options_.step_every;
  }

  /// Notes the first command that agrees with a step.
  void answer_step(bool any_current) {
    if (stepped_ns_ == 0 || any_current != inwards_) return;
    steps_.push_back(
        {{"reported_ns", stepped_ns_}, {"answered_ns", servo::now_ns()}, {"inwards", inwards_}});
    stepped_ns_ = 0;
  }

  std::vector<HidBytes> send() {
    step_on();
    const std::array<int, 3> arm = swing();
    HidBytes bytes;
    for (std::size_t i = 0; i < 3; ++i) put(bytes, arm[i] + offset_[i]);
    if (wire_ == Wire::v1) {
      put(bytes, reports_);
    } else {
      if (reports_ == options_.press_at) pressed_ = true;
      for (const int count : gimbal_) put(bytes, count);
      put(bytes, pressed_ ? 1 : 0);
      waiting_ = true;
    }
    bytes.resize(size());
    ++reports_;
    return {bytes};
  }

  void take_currents(const HidBytes& bytes) {
    bool any = false;
    for (std::size_t i = 0; i < 3; ++i) {
      last_[i] = get(bytes, 1 + 2 * i);
      largest_ = std::max(largest_, std::abs(last_[i]));
      any = any || last_[i] != 0;
    }
    const std::int64_t now = servo::now_ns();
    if (any != has_current_) (any ? began_ns_ : ended_ns_).push_back(now);
    if (has_current_ && !any) last_current_ns_.push_back(commanded_ns_);
    commanded_ns_ = now;
    has_current_ = any;
    answer_step(any);
    with_current_ += any ? 1 : 0;
    before_set_ += any && sets_ == 0 ? 1 : 0;
  }

  void set_counters(const HidBytes& bytes) {
    ++sets_;
    pressed_ = false;
    last_ = {};
    const std::array<int, 3> arm = swing();
    for (std::size_t i = 0; i < 3; ++i) {
      offset_[i] = get(bytes, 9 + 2 * i) - arm[i];
      gimbal_[i] = get(bytes, 1 + 2 * i);
    }
  }

  Wire wire_;
  EmulatedOptions options_;
  std::array<int, 3> offset_{}, gimbal_{}, last_{};
  bool pressed_ = false, waiting_ = false, answered_ = false, quiet_once_ = false;
  int reports_ = 0, commands_ = 0, wrong_ = 0, sets_ = 0, with_current_ = 0, before_set_ = 0;
  int largest_ = 0;
  bool has_current_ = false;
  std::vector<std::int64_t> began_ns_, ended_ns_;  ///< when motors got current, and had none again
  std::vector<std::int64_t> last_current_ns_;      ///< when the last command before each end came
  std::int64_t commanded_ns_ = 0;
  bool inwards_ = false;
  int until_step_ = options_.step_every;
  std::int64_t stepped_ns_ = 0;  ///< when a step was reported that is not answered yet; or 0
  nlohmann::ordered_json steps_ = nlohmann::ordered_json::array();
  std::minstd_rand random_;
};

/// A SpaceNavigator that is pushed to the right for a while, let go, and pushed again; its left
/// button is held in every second push.
class EmulatedSpaceMouse final : public EmulatedHid {
 public:
  [[nodiscard]] HidIdentity identity() const override {
    // Six axes in two reports, buttons in the third, the light in the fourth.
    return {
        0x046D,
        0xC626,
        "SpaceNavigator",
        "",
        {0x05, 0x01, 0x09, 0x08, 0xA1, 0x01, 0xA1, 0x00, 0x85, 0x01, 0x16, 0xA2, 0xFE, 0x26, 0x5E,
         0x01, 0x09, 0x30, 0x09, 0x31, 0x09, 0x32, 0x75, 0x10, 0x95, 0x03, 0x81, 0x06, 0xC0, 0xA1,
         0x00, 0x85, 0x02, 0x09, 0x33, 0x09, 0x34, 0x09, 0x35, 0x75, 0x10, 0x95, 0x03, 0x81, 0x06,
         0xC0, 0xA1, 0x02, 0x85, 0x03, 0x05, 0x09, 0x19, 0x01, 0x29, 0x10, 0x15, 0x00, 0x25, 0x01,
         0x75, 0x01, 0x95, 0x10, 0x81, 0x02, 0xC0, 0xA1, 0x02, 0x85, 0x04, 0x05, 0x08, 0x09, 0x4B,
         0x15, 0x00, 0x25, 0x01, 0x75, 0x01, 0x95, 0x08, 0x91, 0x02, 0xC0, 0xC0}};
  }
  [[nodiscard]] int period_ms() const override { return 8; }
  std::vector<HidBytes> plug_in() override { return {}; }

  std::vector<HidBytes> unasked() override {
    constexpr int pushed = 40, let_go = 6, cycle = 80;  // in steps of 8 ms
    const int phase = step_ % cycle;
    const bool button = (step_ / cycle) % 2 == 1;
    ++step_;
    std::vector<HidBytes> reports;
    if (phase == 0 || phase == pushed) {
      reports.push_back({3, static_cast<std::uint8_t>(button && phase == 0 ? 1 : 0), 0});
    }
    // After three pairs of zeros it is silent until it is pushed again.
    if (phase < pushed + let_go) {
      HidBytes bytes{static_cast<std::uint8_t>(1 + phase % 2)};
      const bool push = phase < pushed && phase % 2 == 0;
      put(bytes, push ? 350 : 0);
      put(bytes, 0);
      put(bytes, 0);
      reports.push_back(bytes);
    }
    sent_ += static_cast<int>(reports.size());
    return reports;
  }

  std::vector<HidBytes> written(const HidBytes& bytes) override {
    if (bytes.size() == 2 && bytes[0] == 4 && bytes[1] <= 1) {
      lights_.push_back(bytes[1]);
    } else {
      ++wrong_;
    }
    return {};
  }
  std::vector<HidBytes> taken() override { return {}; }

  [[nodiscard]] nlohmann::ordered_json seen() const override {
    return {{"reports", sent_}, {"light", lights_}, {"wrong_commands", wrong_}};
  }
  [[nodiscard]] int wrong() const override { return wrong_; }

 private:
  int step_ = 0, sent_ = 0, wrong_ = 0;
  std::vector<int> lights_;
};

}  // namespace

std::unique_ptr<EmulatedHid> make_emulated_hid(std::string_view name,
                                               const EmulatedOptions& options) {
  if (name == "wooden-v1") return std::make_unique<EmulatedWooden>(Wire::v1, options);
  if (name == "wooden-v2") return std::make_unique<EmulatedWooden>(Wire::v2, options);
  if (name == "wooden-v3") return std::make_unique<EmulatedWooden>(Wire::v3, options);
  if (name == "spacemouse") return std::make_unique<EmulatedSpaceMouse>();
  return make_emulated_pid(name);
}

}  // namespace spm::test
