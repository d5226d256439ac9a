// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <umockdev.h>

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "tests/servo/devices/falcon/scripted_falcon.hpp"

namespace spm::test {

/// The FTDI chip of a scripted Falcon, as the kernel's USB file system shows it: it takes the
/// transfers that libusb submits, and ends them as the chip would, with two bytes of status in
/// every packet, and by its latency timer. One program at a time has the interface; where that is
/// taken from it, its transfers end, and what it submits is refused.
class MockUsbChip {
 public:
  /// Every `late_every`th answer is held back for `late_by`; 0: none.
  MockUsbChip(ScriptedFalcon& falcon, std::uint64_t late_every, std::chrono::milliseconds late_by);
  MockUsbChip(const MockUsbChip&) = delete;
  MockUsbChip& operator=(const MockUsbChip&) = delete;
  ~MockUsbChip();

  /// The terminal that stands for the device's node. It is writable once a transfer has ended.
  [[nodiscard]] const char* terminal() const { return terminal_.c_str(); }

  /// Answers one ioctl; false where it is not known.
  [[nodiscard]] bool handle(UMockdevIoctlClient* client);
  /// The program closed the node.
  void forget(UMockdevIoctlClient* client);

  /// Ends all transfers as for a device that is gone. The programs that have the device open get
  /// nothing else from now on.
  void unplug();
  /// Forgets firmware and homing.
  void lose_power();
  /// After `packets` packets, it still takes packets but answers none.
  void mute_after(std::uint64_t packets);
  /// Says that another program has claimed the interface.
  void refuse_claims();
  [[nodiscard]] std::uint64_t packets() const;

 private:
  using Clock = std::chrono::steady_clock;

  /// A transfer that a program submitted: its urb, and its buffer.
  struct Transfer {
    UMockdevIoctlClient* client;
    UMockdevIoctlData* urb;
    UMockdevIoctlData* buffer;
  };

  void close_by(UMockdevIoctlClient* client);
  [[nodiscard]] bool is_dead(UMockdevIoctlClient* client) const;
  [[nodiscard]] bool claim(UMockdevIoctlClient* client);
  void end_claim();
  void end_reading(int status);
  void submit(UMockdevIoctlClient* client);
  void reap(UMockdevIoctlClient* client);
  void discard(UMockdevIoctlClient* client);
  void end(const Transfer& transfer, int status, int length);
  void write(const Transfer& transfer);
  void send_packet();
  void send_due_packets(Clock::time_point now);
  void take_answers(Clock::time_point now);
  void keep_time();
  static void let_go(const Transfer& transfer);

  ScriptedFalcon& falcon_;
  const std::uint64_t late_every_;
  const std::chrono::milliseconds late_by_;
  std::string terminal_;
  int master_ = -1, slave_ = -1;

  mutable std::mutex mutex_;  ///< guards what follows
  std::condition_variable changed_;
  std::vector<UMockdevIoctlClient*> clients_;       ///< that have the node open
  std::vector<UMockdevIoctlClient*> dead_clients_;  ///< those of which the device was unplugged
  UMockdevIoctlClient* holder_ = nullptr;           ///< that claimed the interface; null: none
  std::deque<Transfer> reading_, ended_;
  std::deque<std::uint8_t> answers_;  ///< in the chip
  std::uint64_t heard_ = 0, mute_after_ = UINT64_MAX;
  Clock::time_point last_packet_{}, held_until_{};
  bool refuses_claims_ = false;
  bool stop_ = false;
  std::thread timer_;
};

}  // namespace spm::test
