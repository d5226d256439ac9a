// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <span>
#include <vector>

namespace spm::test {

/// What goes wrong with a scripted Falcon.
struct FalconFaults {
  bool leading_zero = false;         ///< a zero precedes the boot program's answer
  int unanswered_calls = 0;          ///< that the boot program ignores before it answers; -1: all
  int wrong_echoes = 0;              ///< uploads in which a byte comes back wrong; -1: all
  std::size_t wrong_echo_at = 1000;  ///< byte of the file
  bool dumb_firmware = false;        ///< loads, but never answers
  int short_every = 0;               ///< every Nth answer lacks its last two bytes; 0: none
};

/// A Falcon as its FTDI chip's serial line sees it: boot program, loading, firmware with encoders
/// that follow a slow path and are homed after some packets. Written from the protocol's
/// description; it shares no code with the packets' codec.
class ScriptedFalcon {
 public:
  /// `firmware_size`: how many bytes the boot program takes before it starts what it was given.
  explicit ScriptedFalcon(std::size_t firmware_size, const FalconFaults& faults = {},
                          bool firmware_runs = false);

  /// A vendor request to the chip.
  void control(std::uint8_t request, std::uint16_t value);
  /// Bytes from the host.
  void receive(std::span<const std::uint8_t> bytes);
  /// What waits for the host; it is taken from the front.
  [[nodiscard]] std::deque<std::uint8_t>& outgoing() { return outgoing_; }

  /// Forgets the firmware, the homing and the bytes that were on their way.
  void lose_power();

  /// Sets how many packets with the homing bit it takes until all encoders are homed.
  void home_after(std::uint64_t packets) { home_after_ = packets; }

  [[nodiscard]] bool runs() const { return state_ == State::running; }
  [[nodiscard]] unsigned latency_ms() const { return latency_; }
  [[nodiscard]] int boots() const { return boots_; }
  [[nodiscard]] unsigned boot_latency_ms() const { return boot_latency_; }  ///< at the last boot
  [[nodiscard]] int calls() const { return calls_; }
  [[nodiscard]] const std::vector<std::uint8_t>& loaded() const { return loaded_; }
  [[nodiscard]] std::uint64_t packets() const { return packets_; }
  [[nodiscard]] std::uint64_t homing_packets() const { return homing_packets_; }
  [[nodiscard]] std::uint64_t wrong_packets() const { return wrong_packets_; }
  [[nodiscard]] std::uint64_t pushing_packets() const { return pushing_packets_; }
  /// Packets that pushed before all encoders were homed.
  [[nodiscard]] std::uint64_t early_pushes() const { return early_pushes_; }
  [[nodiscard]] int largest_motor() const { return largest_motor_; }
  [[nodiscard]] const std::array<int, 3>& motors() const { return motors_; }
  [[nodiscard]] unsigned lights() const { return lights_; }  ///< 2 green, 4 blue, 8 red
  [[nodiscard]] unsigned lit() const { return lit_; }        ///< the last that were not all dark

 private:
  enum class State : std::uint8_t { off, booting, loading, running };

  void receive_call(std::uint8_t byte);
  void receive_file(std::uint8_t byte);
  void receive_packet(std::uint8_t byte);
  void answer_packet();
  void send(std::span<const std::uint8_t> bytes);

  std::size_t firmware_size_;
  FalconFaults faults_;
  State state_;
  unsigned baud_ = 0, latency_ = 16, boot_latency_ = 0;
  bool data_ready_ = false;
  std::deque<std::uint8_t> outgoing_;
  std::vector<std::uint8_t> incoming_;
  std::vector<std::uint8_t> loaded_;
  int boots_ = 0, calls_ = 0, loads_ = 0;
  std::uint64_t home_after_ = 20;
  std::uint64_t packets_ = 0, homing_packets_ = 0, wrong_packets_ = 0;
  std::uint64_t pushing_packets_ = 0, early_pushes_ = 0, answers_ = 0;
  int largest_motor_ = 0;
  std::array<int, 3> motors_{};
  unsigned lights_ = 0, lit_ = 0;
};

}  // namespace spm::test
