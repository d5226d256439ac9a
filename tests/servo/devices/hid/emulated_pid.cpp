// SPDX-License-Identifier: Apache-2.0
#include "tests/servo/devices/hid/emulated_pid.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "servo/base/clock.hpp"
#include "tests/servo/devices/hid/pid_descriptors.hpp"

namespace spm::test {

namespace {

int word(const HidBytes& bytes, std::size_t offset) {
  return bytes[offset] | (bytes[offset + 1] << 8);
}

int signed_word(const HidBytes& bytes, std::size_t offset) {
  return static_cast<std::int16_t>(word(bytes, offset));
}

std::uint8_t low(int value) { return static_cast<std::uint8_t>(value & 0xFF); }
std::uint8_t high(int value) { return static_cast<std::uint8_t>(value >> 8 & 0xFF); }

/// A stick that somebody swings, and that keeps effects as public firmware does: with a duration,
/// from the last start on.
class EmulatedPid final : public EmulatedHid {
 public:
  EmulatedPid(PidStick stick, std::size_t room, bool busy)
      : stick_(stick), room_(room), busy_(busy) {}

  [[nodiscard]] HidIdentity identity() const override {
    return {0x1209, 0xFFB0, "Emulated stick", "S1", pid_descriptor(stick_)};
  }
  [[nodiscard]] int period_ms() const override { return 1; }

  std::vector<HidBytes> plug_in() override {
    reset();
    return {};
  }

  std::vector<HidBytes> unasked() override {
    ++time_;
    for (auto& [block, effect] : effects_) {
      if (!effect.playing || effect.duration == endless || time_ - effect.started < effect.duration)
        continue;
      effect.playing = false;
      ++expired_;
    }
    std::vector<HidBytes> all;
    if (is_axes()) {
      if (time_ % 40 == 0) all.push_back(position());
    } else {
      // Its state comes between the positions.
      if (time_ % 50 == 0) all.push_back({2, 0x0A});
      all.push_back(position());
    }
    reports_ += static_cast<int>(all.size());
    return all;
  }

  std::vector<HidBytes> written(const HidBytes& bytes) override {
    ++commands_;
    if (!take(bytes)) ++wrong_;
    const std::array<double, 2> force = force_now();
    const bool pushes = force[0] != 0 || force[1] != 0;
    if (std::exchange(pushes_, pushes) && !pushes) ended_ns_.push_back(servo::now_ns());
    for (std::size_t i = 0; i < 2; ++i) {
      if (std::abs(force[i]) > std::abs(largest_[i])) largest_[i] = force[i];
    }
    return {};
  }
  std::vector<HidBytes> taken() override { return {}; }

  bool feature_written(const HidBytes& bytes) override {
    if (bytes.size() != 4 || bytes[0] != 0x11 || bytes[1] != constant_type) {
      ++wrong_;
      return false;
    }
    ++creations_;
    loaded_ = {0x12, 0, 3, 0, 0};
    if (busy_) return true;
    if (effects_.size() >= room_) {
      loaded_[2] = 2;
      return true;
    }
    const int block = static_cast<int>(effects_.size()) + 1;
    effects_[block] = Effect{};
    loaded_[1] = low(block);
    loaded_[2] = 1;
    return true;
  }

  std::optional<HidBytes> feature_asked(std::uint8_t id) override {
    if (id == 0x12) return loaded_;
    if (id == 0x13) return HidBytes{0x13, 0xFF, 0x0F, low(static_cast<int>(room_)), 3};
    ++wrong_;
    return std::nullopt;
  }

  std::optional<HidBytes> input_asked(std::uint8_t id) override {
    const HidBytes report = position();
    if (id != report[0]) {
      ++wrong_;
      return std::nullopt;
    }
    ++asked_;
    return report;
  }

  [[nodiscard]] nlohmann::ordered_json seen() const override {
    int playing = 0;
    for (const auto& [block, effect] : effects_) playing += effect.playing ? 1 : 0;
    return {{"reports", reports_},
            {"commands", commands_},
            {"wrong_commands", wrong_},
            {"resets", resets_},
            {"gain", gain_},
            {"created", creations_},
            {"starts", starts_},
            {"stops", stops_},
            {"freed", freed_},
            {"expired", expired_},
            {"durations", durations_},
            {"magnitudes", magnitudes_},
            {"playing", playing},
            {"asked", asked_},
            {"largest_force", largest_},
            {"last_force", force_now()},
            {"force_ended_ns", ended_ns_}};
  }
  [[nodiscard]] int wrong() const override { return wrong_; }

 private:
  static constexpr int constant_type = 2, endless = 0xFFFF;

  struct Effect {
    int duration = 0, started = 0, magnitude = 0;
    std::array<double, 2> towards{};  ///< of a positive magnitude, in the world
    bool is_set = false, playing = false;
  };

  [[nodiscard]] bool is_axes() const { return stick_ == PidStick::axes; }

  void reset() {
    effects_.clear();
    has_power_ = false;
    gain_ = 0;
  }

  [[nodiscard]] HidBytes position() const {
    const double time = time_ * 1e-3;
    const double x = 0.6 * std::sin(2 * std::numbers::pi * 0.7 * time);
    const double y = 0.4 * std::sin(2 * std::numbers::pi * 0.5 * time);
    const bool pressed = time_ % 200 < 100;
    if (is_axes()) {
      return {3, low(pressed ? 2 : 0), low(static_cast<int>(std::lround(127.5 + 127 * x))),
              low(static_cast<int>(std::lround(127.5 - 127 * y)))};
    }
    const auto x_count = static_cast<int>(std::lround(32767 * x));
    const auto y_count = static_cast<int>(std::lround(-32767 * y));
    return {1, low(x_count), high(x_count), low(y_count), high(y_count), low(pressed ? 2 : 0)};
  }

  /// Force as fractions of its greatest force, in the world: to the right, and away from the user.
  [[nodiscard]] std::array<double, 2> force_now() const {
    std::array<double, 2> force{};
    for (const auto& [block, effect] : effects_) {
      if (!effect.playing) continue;
      for (std::size_t i = 0; i < 2; ++i) {
        const double part = effect.towards[i] * effect.magnitude / (is_axes() ? 255.0 : 10000.0);
        // Sine and cosine leave crumbs.
        force[i] += std::abs(part) < 1e-9 ? 0 : part;
      }
    }
    return force;
  }

  bool take(const HidBytes& bytes) {
    switch (bytes[0]) {
      case 0x11:
        return bytes.size() == (is_axes() ? 14 : 18) && set_effect(bytes);
      case 0x15:
        if (bytes.size() != 4 || !is_known(bytes[1])) return false;
        effects_[bytes[1]].magnitude = signed_word(bytes, 2);
        ++magnitudes_;
        return std::abs(effects_[bytes[1]].magnitude) <= (is_axes() ? 255 : 10000);
      case 0x1A:
        return bytes.size() == 4 && is_known(bytes[1]) && operate(effects_[bytes[1]], bytes);
      case 0x1B:
        if (bytes.size() != 2 || !is_known(bytes[1])) return false;
        ++freed_;
        return effects_.erase(bytes[1]) == 1;
      case 0x1C:
        return bytes.size() == 2 && control(bytes[1]);
      case 0x1D:
        gain_ = bytes.back();
        return bytes.size() == 2 && !is_axes();
      default:
        return false;
    }
  }

  [[nodiscard]] bool is_known(int block) const { return effects_.count(block) == 1; }

  bool control(int value) {
    if (value == (is_axes() ? 1 << 3 : 4)) {
      reset();
      ++resets_;
      is_stopped_ = false;
      return true;
    }
    if (value == (is_axes() ? 1 << 2 : 3)) {
      for (auto& [block, effect] : effects_) effect.playing = false;
      is_stopped_ = true;
      return true;
    }
    // What it plays by itself must have ended before its motors get power.
    has_power_ = value == 1;
    return has_power_ && is_stopped_;
  }

  bool set_effect(const HidBytes& bytes) {
    if (!is_known(bytes[1]) || bytes[2] != constant_type) return false;
    Effect& effect = effects_[bytes[1]];
    effect.duration = word(bytes, 3);
    durations_.push_back(effect.duration);
    const bool no_trigger = bytes[12] == 0;
    const bool no_delay = word(bytes, 5) == 0 && word(bytes, 7) == 0 && word(bytes, 9) == 0;
    effect.is_set = true;
    const int enabled = bytes[13];
    if (is_axes()) {
      // A force comes from the positive side of its axis: from the right, from the user.
      effect.towards = {enabled == 1 ? -1.0 : 0.0, enabled == 2 ? 1.0 : 0.0};
      return no_trigger && no_delay && bytes[11] == 255 && (enabled == 1 || enabled == 2);
    }
    // From the north clockwise; the direction is that from which it comes.
    const double angle = word(bytes, 14) / 36000.0 * 2 * std::numbers::pi;
    effect.towards = {-std::sin(angle), -std::cos(angle)};
    return no_trigger && no_delay && bytes[11] == 255 && enabled == 4;
  }

  bool operate(Effect& effect, const HidBytes& bytes) {
    if (bytes[2] == 1) {
      ++starts_;
      effect.playing = true;
      effect.started = time_;
      return effect.is_set && has_power_ && bytes[3] == 1;
    }
    ++stops_;
    effect.playing = false;
    return bytes[2] == 3;
  }

  PidStick stick_;
  std::size_t room_;
  bool busy_;
  std::map<int, Effect> effects_;
  HidBytes loaded_{0x12, 0, 3, 0, 0};
  bool has_power_ = false, is_stopped_ = false;
  int time_ = 0, reports_ = 0, commands_ = 0, wrong_ = 0, resets_ = 0, gain_ = 0, creations_ = 0;
  int starts_ = 0, stops_ = 0, freed_ = 0, expired_ = 0, magnitudes_ = 0, asked_ = 0;
  std::vector<int> durations_;
  bool pushes_ = false;
  std::vector<std::int64_t> ended_ns_;  ///< when a report ended its force
  std::array<double, 2> largest_{};
};

}  // namespace

std::unique_ptr<EmulatedHid> make_emulated_pid(std::string_view name) {
  constexpr std::size_t roomy = 10;
  if (name == "pid") return std::make_unique<EmulatedPid>(PidStick::polar, roomy, false);
  if (name == "pid-axes") return std::make_unique<EmulatedPid>(PidStick::axes, roomy, false);
  if (name == "pid-no-constant") {
    return std::make_unique<EmulatedPid>(PidStick::no_constant, roomy, false);
  }
  if (name == "pid-full") return std::make_unique<EmulatedPid>(PidStick::polar, 1, false);
  if (name == "pid-busy") return std::make_unique<EmulatedPid>(PidStick::polar, roomy, true);
  return nullptr;
}

}  // namespace spm::test
