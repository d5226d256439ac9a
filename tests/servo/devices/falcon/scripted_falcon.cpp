// SPDX-License-Identifier: Apache-2.0
#include "tests/servo/devices/falcon/scripted_falcon.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "servo/devices/falcon/falcon_kinematics.hpp"
#include "tests/servo/devices/falcon/falcon_counts.hpp"

namespace spm::test {

using namespace spm::servo;

namespace {

constexpr unsigned boot_baud = 0x4138, upload_baud = 0x0015, normal_baud = 0x0002;
constexpr std::size_t packet_size = 16;

/// Counts of the encoders when the device was switched on, which is where they begin.
constexpr std::array<int, 3> power_up_counts{-150, 40, -90};

/// Encoder counts after a number of packets: the grip moves slowly around the centre.
std::array<int, 3> counts_after(std::uint64_t packets) {
  const double t = 1e-3 * static_cast<double>(packets);
  const auto angles =
      falcon_inverse({0.02 * std::sin(3 * t), 0.015 * std::sin(2 * t), 0.01 * std::sin(5 * t)});
  const Vector3 counts = spm::test::falcon_counts(*angles);
  return {static_cast<int>(std::lround(counts[0])), static_cast<int>(std::lround(counts[1])),
          static_cast<int>(std::lround(counts[2]))};
}

int signed_number(std::span<const std::uint8_t> nibbles) {
  unsigned bits = 0;
  for (std::size_t i = 4; i-- > 0;) bits = bits * 16 + (nibbles[i] - unsigned{'A'});
  return bits < 0x8000U ? static_cast<int>(bits) : static_cast<int>(bits) - 0x10000;
}

bool is_packet(std::span<const std::uint8_t> bytes) {
  return bytes.front() == '<' && bytes.back() == '>' &&
         std::all_of(bytes.begin() + 1, bytes.end() - 1,
                     [](std::uint8_t byte) { return byte >= 'A' && byte <= 'P'; });
}

}  // namespace

ScriptedFalcon::ScriptedFalcon(std::size_t firmware_size, const FalconFaults& faults,
                               bool firmware_runs)
    : firmware_size_(firmware_size),
      faults_(faults),
      state_(firmware_runs ? State::running : State::off) {}

void ScriptedFalcon::control(std::uint8_t request, std::uint16_t value) {
  if (request == 0 && value != 2) outgoing_.clear();
  if (request == 1 && (value & 0x0100U) != 0) {
    const bool rises = (value & 1U) != 0 && !data_ready_;
    data_ready_ = (value & 1U) != 0;
    if (rises && baud_ == boot_baud) {
      state_ = State::booting;
      incoming_.clear();
      boot_latency_ = latency_;
      ++boots_;
    }
  }
  if (request == 3) {
    baud_ = value;
    incoming_.clear();
  }
  if (request == 9) latency_ = value;
}

void ScriptedFalcon::lose_power() {
  state_ = State::off;
  home_after_ += homing_packets_;
  incoming_.clear();
  outgoing_.clear();
}

void ScriptedFalcon::receive(std::span<const std::uint8_t> bytes) {
  for (const std::uint8_t byte : bytes) {
    if (state_ == State::booting) {
      receive_call(byte);
    } else if (state_ == State::loading && baud_ == upload_baud) {
      receive_file(byte);
    } else if (state_ == State::running && baud_ == normal_baud) {
      receive_packet(byte);
    }
  }
}

void ScriptedFalcon::receive_call(std::uint8_t byte) {
  if (baud_ == upload_baud && byte == 0x41 && !data_ready_) {
    state_ = State::loading;
    loaded_.clear();
    ++loads_;
    send(std::array<std::uint8_t, 1>{0x41});
    return;
  }
  if (baud_ != boot_baud) return;
  incoming_.push_back(byte);
  constexpr std::array<std::uint8_t, 3> wanted{0x0A, 0x43, 0x0D};
  if (incoming_.size() < wanted.size()) return;
  const bool called = std::equal(wanted.begin(), wanted.end(), incoming_.begin());
  incoming_.clear();
  if (!called) return;
  ++calls_;
  if (faults_.unanswered_calls != 0) {
    if (faults_.unanswered_calls > 0) --faults_.unanswered_calls;
    return;
  }
  if (faults_.leading_zero) send(std::array<std::uint8_t, 1>{0x00});
  send(std::array<std::uint8_t, 4>{0x0A, 0x44, 0x2C, 0x0D});
}

void ScriptedFalcon::receive_file(std::uint8_t byte) {
  const bool wrong = faults_.wrong_echoes != 0 && loaded_.size() == faults_.wrong_echo_at;
  if (wrong && faults_.wrong_echoes > 0) --faults_.wrong_echoes;
  loaded_.push_back(byte);
  send(std::array<std::uint8_t, 1>{wrong ? static_cast<std::uint8_t>(~byte) : byte});
  if (loaded_.size() == firmware_size_) state_ = State::running;
}

void ScriptedFalcon::receive_packet(std::uint8_t byte) {
  incoming_.push_back(byte);
  if (incoming_.size() < packet_size) return;
  const std::span<const std::uint8_t> packet(incoming_);
  if (!is_packet(packet)) {
    ++wrong_packets_;
    incoming_.erase(incoming_.begin());
    return;
  }
  ++packets_;
  const unsigned flags = packet[13] - unsigned{'A'};
  homing_packets_ += flags & 1U;
  lights_ = flags & 14U;
  if (lights_ != 0) lit_ = lights_;
  bool pushes = false;
  for (std::size_t i = 0; i < 3; ++i) {
    motors_[i] = signed_number(packet.subspan(1 + 4 * i, 4));
    largest_motor_ = std::max(largest_motor_, std::abs(motors_[i]));
    pushes = pushes || motors_[i] != 0;
  }
  pushing_packets_ += pushes ? 1 : 0;
  early_pushes_ += pushes && homing_packets_ <= home_after_ ? 1 : 0;
  incoming_.clear();
  if (!faults_.dumb_firmware) answer_packet();
}

void ScriptedFalcon::answer_packet() {
  const bool homed = homing_packets_ > home_after_;
  const std::array<int, 3> counts = counts_after(packets_);
  std::vector<std::uint8_t> answer{'<'};
  for (std::size_t i = 0; i < 3; ++i) {
    const int count = homed ? counts[i] : counts[i] - power_up_counts[i];
    for (const unsigned shift : {0U, 4U, 8U, 12U}) {
      answer.push_back(
          static_cast<std::uint8_t>('A' + ((static_cast<unsigned>(count) >> shift) & 15U)));
    }
  }
  answer.push_back(static_cast<std::uint8_t>('A' + (homed ? 0x70 : 0)));
  answer.push_back('A');
  answer.push_back('>');
  ++answers_;
  if (faults_.short_every > 0 && answers_ % static_cast<std::uint64_t>(faults_.short_every) == 0) {
    answer.resize(answer.size() - 2);
  }
  send(answer);
}

void ScriptedFalcon::send(std::span<const std::uint8_t> bytes) {
  outgoing_.insert(outgoing_.end(), bytes.begin(), bytes.end());
}

}  // namespace spm::test
