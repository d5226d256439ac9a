// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/pid/pid_codec.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <vector>

#include "common/base/random.hpp"
#include "tests/servo/devices/hid/pid_descriptors.hpp"

namespace pid_codec_test {

using namespace spm;
using namespace spm::servo;
using spm::test::PidStick;

namespace {

using Bytes = std::vector<std::uint8_t>;

PidLayout layout_of(PidStick stick, std::optional<PidDirection> direction = {}) {
  const auto descriptor = parse_hid_descriptor(spm::test::pid_descriptor(stick));
  REQUIRE(descriptor);
  const auto layout = find_pid_layout(*descriptor, direction);
  if (!layout) FAIL(layout.error());
  return *layout;
}

std::string missing_in(const Bytes& bytes, std::optional<PidDirection> direction = {}) {
  const auto descriptor = parse_hid_descriptor(bytes);
  REQUIRE(descriptor);
  const auto layout = find_pid_layout(*descriptor, direction);
  return layout ? "" : layout.error();
}

/// A descriptor in which a usage of the force feedback page was changed to one that nobody knows.
Bytes without(Bytes bytes, std::uint8_t usage) {
  for (std::size_t i = 0; i + 1 < bytes.size(); ++i) {
    if (bytes[i] == 0x09 && bytes[i + 1] == usage) bytes[i + 1] = 0xEE;
  }
  return bytes;
}

Bytes bytes_of(const PidMessage& message) { return message.bytes; }

}  // namespace

TEST_CASE("A direction is told as the descriptor has it, or as it is asked for") {
  REQUIRE(layout_of(PidStick::polar).set_effect.direction_form == PidDirection::polar);
  REQUIRE(layout_of(PidStick::axes).set_effect.direction_form == PidDirection::axes);
  REQUIRE(layout_of(PidStick::cartesian).set_effect.direction_form == PidDirection::cartesian);
  REQUIRE(layout_of(PidStick::polar, PidDirection::axes).set_effect.direction_form ==
          PidDirection::axes);
  REQUIRE(layout_of(PidStick::cartesian, PidDirection::polar).set_effect.direction_form ==
          PidDirection::polar);
  for (const PidStick stick : {PidStick::polar, PidStick::axes, PidStick::cartesian}) {
    REQUIRE(layout_of(stick).axes == 2);
  }
}

TEST_CASE("What a descriptor lacks is named, with its usage") {
  const Bytes good = spm::test::pid_descriptor(PidStick::polar);
  REQUIRE(missing_in(good).empty());
  const auto names = [&good](std::uint8_t usage, const std::string& what) {
    CAPTURE(usage, missing_in(without(good, usage)));
    return missing_in(without(good, usage)).find(what) != std::string::npos;
  };
  REQUIRE(names(0x30, "X axis"));
  REQUIRE(names(0x73, "Set Constant Force report (usage 0x73)"));
  REQUIRE(names(0x70, "magnitude (0x70)"));
  REQUIRE(names(0x26, "constant force (usage 0x26)"));
  REQUIRE(names(0x22, "block index (usage 0x22)"));
  REQUIRE(names(0x50, "duration (usage 0x50)"));
  REQUIRE(names(0x79, "start of an effect (0x79)"));
  REQUIRE(names(0x7B, "stop of an effect (usage 0x7B)"));
  REQUIRE(names(0xAB, "Create New Effect report (0xAB)"));
  REQUIRE(names(0x89, "Block Load report (usage 0x89)"));
  // Optional usages may be missing.
  for (const int usage : {0x52, 0x53, 0x56, 0x7C, 0x7D, 0x90, 0x96, 0x97, 0x9A, 0x7F}) {
    REQUIRE(missing_in(without(good, static_cast<std::uint8_t>(usage))).empty());
  }
  const std::string none = missing_in(spm::test::pid_descriptor(PidStick::no_constant));
  REQUIRE(none.find("Set Constant Force report (usage 0x73)") != std::string::npos);
  REQUIRE_FALSE(missing_in(good, PidDirection::cartesian).empty());
  REQUIRE_FALSE(missing_in(spm::test::pid_descriptor(PidStick::axes), PidDirection::polar).empty());
  REQUIRE(missing_in({}).find("X axis") != std::string::npos);
}

TEST_CASE("A magnitude without a sign is refused, as it cannot push both ways") {
  Bytes bytes = spm::test::pid_descriptor(PidStick::polar);
  // -10000 becomes 10000.
  for (std::size_t i = 0; i + 2 < bytes.size(); ++i) {
    if (bytes[i] == 0x16 && bytes[i + 1] == 0xF0 && bytes[i + 2] == 0xD8) {
      bytes[i + 1] = 0x10;
      bytes[i + 2] = 0x27;
    }
  }
  REQUIRE(missing_in(bytes).find("a sign in the magnitude") != std::string::npos);
}

TEST_CASE("A wheel, whose second axis takes no force, has one axis") {
  Bytes bytes = spm::test::pid_descriptor(PidStick::polar);
  // Axes Enable names X, and something else.
  bool seen = false;
  for (std::size_t i = 0; i + 3 < bytes.size(); ++i) {
    seen = seen || (bytes[i] == 0x09 && bytes[i + 1] == 0x55);
    if (seen && bytes[i] == 0x09 && bytes[i + 1] == 0x31) {
      bytes[i + 1] = 0x36;
      break;
    }
  }
  const auto descriptor = parse_hid_descriptor(bytes);
  REQUIRE(descriptor);
  const auto layout = find_pid_layout(*descriptor);
  REQUIRE(layout);
  REQUIRE(layout->axes == 1);
  PidReport report;
  REQUIRE(take_pid_report(*layout, 1, Bytes{0xFF, 0x7F, 0xFF, 0x7F, 0}, report));
  REQUIRE(report.deflection == std::array<double, 2>{1, 0});
}

TEST_CASE("A position is told in the world: to the right, and away from the user") {
  const PidLayout layout = layout_of(PidStick::polar);
  PidReport report;
  REQUIRE(take_pid_report(layout, 1, Bytes{0xFF, 0x7F, 0x00, 0x00, 0x00}, report));
  REQUIRE(report.deflection == std::array<double, 2>{1, 0});
  REQUIRE(take_pid_report(layout, 1, Bytes{0x00, 0x00, 0x01, 0x80, 0x00}, report));
  REQUIRE(report.deflection == std::array<double, 2>{0, 1});
  REQUIRE(take_pid_report(layout, 1, Bytes{0x01, 0x80, 0xFF, 0x7F, 0x85}, report));
  REQUIRE(report.deflection == std::array<double, 2>{-1, -1});
  REQUIRE(report.buttons == 0x85);
  const PidLayout axes = layout_of(PidStick::axes);
  PidReport small;
  REQUIRE(take_pid_report(axes, 3, Bytes{0xF2, 0, 255}, small));
  REQUIRE(small.deflection == std::array<double, 2>{-1, -1});
  REQUIRE(small.buttons == 2);
}

TEST_CASE("Other reports, short ones and axes without a value change nothing") {
  const PidLayout layout = layout_of(PidStick::polar);
  PidReport report{{0.5, -0.5}, 3};
  REQUIRE_FALSE(take_pid_report(layout, 2, Bytes{0x0A}, report));
  REQUIRE_FALSE(take_pid_report(layout, 1, Bytes{0xFF, 0x7F, 0x00, 0x00}, report));
  REQUIRE_FALSE(take_pid_report(layout, 1, Bytes{}, report));
  // A value below the minimum.
  REQUIRE_FALSE(take_pid_report(layout, 1, Bytes{0x00, 0x00, 0x00, 0x80, 0x00}, report));
  for (int id = 0; id < 256; ++id) {
    if (id == 1) continue;
    const auto other = static_cast<std::uint8_t>(id);
    REQUIRE_FALSE(take_pid_report(layout, other, Bytes(64, 0), report));
  }
  REQUIRE(report.deflection == std::array<double, 2>{0.5, -0.5});
  REQUIRE(report.buttons == 3);
}

TEST_CASE("Control, gain and the making of an effect are what the descriptor says") {
  const PidLayout layout = layout_of(PidStick::polar);
  REQUIRE(bytes_of(pid_control(layout, *layout.reset)) == Bytes{0x1C, 4});
  REQUIRE(bytes_of(pid_control(layout, *layout.enable)) == Bytes{0x1C, 1});
  REQUIRE(bytes_of(pid_full_gain(layout, *layout.gain)) == Bytes{0x1D, 255});
  const PidMessage create = pid_create(layout);
  REQUIRE(create.type == HidReportType::feature);
  REQUIRE(create.bytes == Bytes{0x11, 2, 0, 0});
  REQUIRE(bytes_of(pid_load_request(layout)) == Bytes{0x12, 0, 0, 0, 0});
  // A stick whose controls are one bit each.
  const PidLayout axes = layout_of(PidStick::axes);
  REQUIRE(bytes_of(pid_control(axes, *axes.reset)) == Bytes{0x1C, 0x08});
  REQUIRE(bytes_of(pid_control(axes, *axes.enable)) == Bytes{0x1C, 0x01});
  REQUIRE_FALSE(axes.gain);
}

TEST_CASE("What became of an effect is told apart") {
  const PidLayout layout = layout_of(PidStick::polar);
  const auto done = decode_pid_load(layout, Bytes{7, 1, 0x34, 0x12});
  REQUIRE(done);
  REQUIRE(done->load == PidLoad::done);
  REQUIRE(done->block == 7);
  REQUIRE(decode_pid_load(layout, Bytes{0, 2, 0, 0})->load == PidLoad::full);
  REQUIRE(decode_pid_load(layout, Bytes{0, 3, 0, 0})->load == PidLoad::refused);
  REQUIRE(decode_pid_load(layout, Bytes{0, 0, 0, 0})->load == PidLoad::refused);
  REQUIRE_FALSE(decode_pid_load(layout, Bytes{7, 1, 0}));
}

TEST_CASE("An effect of each axis has its direction, its duration, and no trigger") {
  const PidLayout layout = layout_of(PidStick::polar);
  // block, type, 200 ms, no repeat, period or delay, gain, no button, direction enable, 9000 = 90
  // degrees.
  REQUIRE(bytes_of(pid_set_effect(layout, 3, 0, 0.2)) ==
          Bytes{0x11, 3, 2, 200, 0, 0, 0, 0, 0, 0, 0, 255, 0, 4, 0x28, 0x23, 0, 0});
  const Bytes endless = bytes_of(pid_set_effect(layout, 3, 1, std::nullopt));
  REQUIRE(endless == Bytes{0x11, 3, 2, 255, 255, 0, 0, 0, 0, 0, 0, 255, 0, 4, 0x50, 0x46, 0, 0});
  const PidLayout axes = layout_of(PidStick::axes);
  REQUIRE(bytes_of(pid_set_effect(axes, 1, 0, 0.2)) ==
          Bytes{0x11, 1, 2, 200, 0, 0, 0, 0, 0, 0, 0, 255, 0, 1});
  REQUIRE(bytes_of(pid_set_effect(axes, 1, 1, 0.2))[13] == 2);
  const PidLayout cartesian = layout_of(PidStick::cartesian);
  REQUIRE(bytes_of(pid_set_effect(cartesian, 1, 0, 0.2)) ==
          Bytes{0x11, 1, 2, 200, 0, 0, 0, 0, 0, 0, 0, 255, 0, 1, 127, 0});
  REQUIRE(bytes_of(pid_set_effect(cartesian, 1, 1, 0.2)) ==
          Bytes{0x11, 1, 2, 200, 0, 0, 0, 0, 0, 0, 0, 255, 0, 2, 0, 127});
}

TEST_CASE("A force is a magnitude that comes from the other side, held to the full one") {
  const PidLayout layout = layout_of(PidStick::polar);
  const auto magnitude = [&layout](std::size_t axis, double force) {
    const Bytes bytes = bytes_of(pid_constant_force(layout, 9, axis, force));
    REQUIRE(bytes.size() == 4);
    REQUIRE(bytes[0] == 0x15);
    REQUIRE(bytes[1] == 9);
    return static_cast<int>(static_cast<std::int16_t>(bytes[2] | (bytes[3] << 8)));
  };
  REQUIRE(magnitude(0, 0) == 0);
  REQUIRE(magnitude(0, 0.5) == -5000);
  REQUIRE(magnitude(0, -1) == 10000);
  REQUIRE(magnitude(1, 0.5) == 5000);
  REQUIRE(magnitude(1, 7) == 10000);
  REQUIRE(magnitude(1, -7) == -10000);
  REQUIRE(magnitude(0, std::numeric_limits<double>::quiet_NaN()) == 0);
  REQUIRE(magnitude(0, std::numeric_limits<double>::infinity()) == 0);
  REQUIRE(bytes_of(pid_constant_force(layout_of(PidStick::axes), 1, 1, -1)) ==
          Bytes{0x15, 1, 0x01, 0xFF});
}

TEST_CASE("Effects are started once, stopped, and given back") {
  const PidLayout layout = layout_of(PidStick::polar);
  REQUIRE(bytes_of(pid_start(layout, 2)) == Bytes{0x1A, 2, 1, 1});
  REQUIRE(bytes_of(pid_stop(layout, 2)) == Bytes{0x1A, 2, 3, 0});
  REQUIRE(bytes_of(*pid_free(layout, 2)) == Bytes{0x1B, 2});
}

TEST_CASE("A time is counted in the field's unit, in milliseconds without one") {
  HidField field;
  field.bits = 16;
  field.logical_max = 32767;
  REQUIRE(hid_time(field, 0.2) == 200);
  field.unit = 0x1001;
  REQUIRE(hid_time(field, 2) == 2);
  field.unit_exponent = -2;
  REQUIRE(hid_time(field, 0.2) == 20);
  field.physical_max = 65534;
  REQUIRE(hid_time(field, 0.2) == 10);
  field.unit_exponent = -9;
  REQUIRE(hid_time(field, 0.2) == 32767);
  field.unit = 0x11;  // a length
  REQUIRE(hid_time(field, 0.2) == 200);
}

TEST_CASE("Any field that is set is read back, and its neighbours are as they were") {
  for (std::uint64_t seed = 1; seed <= 500; ++seed) {
    CAPTURE(seed);
    Random random(seed);
    HidField field;
    field.bits = static_cast<std::uint8_t>(1 + random.next() % 32);
    field.bit = static_cast<std::uint32_t>(random.next() % 40);
    const std::int64_t half = std::int64_t{1} << (field.bits - 1);
    const bool has_sign = random.next() % 2 == 0;
    field.logical_min = has_sign ? -half : 0;
    field.logical_max = has_sign ? half - 1 : 2 * half - 1;
    const std::int64_t value =
        field.logical_min +
        static_cast<std::int64_t>(random.next() % static_cast<std::uint64_t>(2 * half));
    Bytes bytes(9);
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random.next());
    const Bytes before = bytes;
    set_hid_value(field, bytes, value);
    REQUIRE(hid_value(field, bytes) == value);
    for (std::size_t bit = 0; bit < 72; ++bit) {
      if (bit >= field.bit && bit < field.bit + field.bits) continue;
      REQUIRE((bytes[bit / 8] >> bit % 8 & 1) == (before[bit / 8] >> bit % 8 & 1));
    }
  }
}

TEST_CASE("A force of the world is held to the cap, its direction kept, and its z left out") {
  const PidCommand plain = pid_command({2, -1, 50}, 10, 5, {1, 1});
  REQUIRE(plain.force[0] == Approx(0.2));
  REQUIRE(plain.force[1] == Approx(-0.1));
  const PidCommand turned = pid_command({2, -1, 0}, 10, 5, {-1, 1});
  REQUIRE(turned.force[0] == Approx(-0.2));
  REQUIRE(turned.force[1] == Approx(-0.1));
  const PidCommand held = pid_command({30, 40, 0}, 10, 5, {1, 1});
  REQUIRE(held.force[0] == Approx(0.3));
  REQUIRE(held.force[1] == Approx(0.4));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  REQUIRE(pid_command({1, nan, 0}, 10, 5, {1, 1}).force == std::array<double, 2>{0, 0});
  REQUIRE(pid_command({1, 0, nan}, 10, 5, {1, 1}).force == std::array<double, 2>{0, 0});
}

TEST_CASE("A damaged descriptor never makes a message that is not of its report") {
  const Bytes good = spm::test::pid_descriptor(PidStick::polar);
  int used = 0;
  for (std::uint64_t seed = 1; seed <= 3000; ++seed) {
    CAPTURE(seed);
    Random random(seed);
    Bytes bytes = good;
    for (std::uint64_t change = 0; change < 1 + seed % 3; ++change) {
      bytes[random.next() % bytes.size()] = static_cast<std::uint8_t>(random.next());
    }
    const auto descriptor = parse_hid_descriptor(bytes);
    if (!descriptor) continue;
    const auto layout = find_pid_layout(*descriptor);
    if (!layout) continue;
    ++used;
    const auto fits = [&layout](const PidMessage& message) {
      return message.bytes.size() == 1 + layout->payload_bytes(message.type, message.bytes.front());
    };
    for (std::size_t axis = 0; axis < layout->axes; ++axis) {
      REQUIRE(fits(pid_set_effect(*layout, 1, axis, 0.2)));
      REQUIRE(fits(pid_constant_force(*layout, 1, axis, 0.3)));
    }
    REQUIRE(fits(pid_start(*layout, 1)));
    REQUIRE(fits(pid_stop(*layout, 1)));
    REQUIRE(fits(pid_create(*layout)));
    REQUIRE(fits(pid_load_request(*layout)));
    if (layout->gain) REQUIRE(fits(pid_full_gain(*layout, *layout->gain)));
    PidReport report;
    for (int id = 0; id < 256; ++id) {
      const auto any = static_cast<std::uint8_t>(id);
      static_cast<void>(take_pid_report(*layout, any, Bytes(64, 0x55), report));
    }
    for (const double part : report.deflection) REQUIRE(std::abs(part) <= 1);
  }
  REQUIRE(used > 100);
}

}  // namespace pid_codec_test
