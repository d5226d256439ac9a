// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glib.h>
#include <umockdev.h>

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/servo/devices/hid/emulated_hid.hpp"
#include "tests/servo/devices/hid/listening_clock.hpp"

namespace spm::test {

/// What goes wrong, counted in reports, or in what the host writes; 0: never.
struct HidFaults {
  int refused_write = 0, refused_writes = 0;  ///< the first of them, and how many
  int short_every = 0;
  int late_every = 0, late_ms = 0;
  int silent_after = 0, silent_ms = 0;
  int unplug_after = 0, unplug_ms = 0;
};

/// An emulated HID device on an emulated bus (libumockdev). The testbed calls from a thread of its
/// own. Ends the program where umockdev fails.
class MockHidBus {
 public:
  MockHidBus(std::unique_ptr<EmulatedHid> device, const HidFaults& faults);
  MockHidBus(const MockHidBus&) = delete;
  MockHidBus& operator=(const MockHidBus&) = delete;
  ~MockHidBus();

  void plug_in();
  void unplug();

  /// Calls `reached` from one of the testbed's threads once the device has sent `reports` reports.
  void notify_at(int reports, std::function<void()> reached);

  /// What the device saw, and what became of its reports.
  [[nodiscard]] nlohmann::ordered_json seen();
  /// Packets that the device does not know.
  [[nodiscard]] int wrong();

 private:
  struct Held {
    MockHidBus* bus;
    HidBytes report;
    int generation;
  };

  [[nodiscard]] std::string node_name() const;
  [[nodiscard]] std::vector<std::string> sys_paths() const;

  // With the mutex held:
  void queue(const std::vector<HidBytes>& reports);
  void deliver(const HidBytes& report);
  void drop_queued();
  void hold(const HidBytes& report, int milliseconds);
  [[nodiscard]] long fetch(UMockdevIoctlClient* client);
  [[nodiscard]] bool is_present(UMockdevIoctlClient* client) const;
  [[nodiscard]] bool is_silent() const;
  /// Handles an ioctl that sets or gets a report. Returns its result, or -1 and an error number.
  [[nodiscard]] int exchange(UMockdevIoctlClient* client, unsigned number, HidBytes& bytes,
                             int& error_number);

  static void on_connected(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer self);
  static gboolean on_ioctl(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer self);
  static gboolean on_read(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer self);
  static gboolean on_write(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer self);
  static gboolean on_period(gpointer self);
  static gboolean on_held(gpointer given);
  static gboolean on_unplug(gpointer self);
  static gboolean on_plug_in(gpointer self);

  std::mutex mutex_;
  std::unique_ptr<EmulatedHid> device_;
  HidFaults faults_;
  UMockdevTestbed* testbed_;
  UMockdevIoctlBase* handler_ = nullptr;
  std::deque<HidBytes> queue_;
  std::vector<UMockdevIoctlClient*> waiting_;
  std::function<void()> reached_;
  int reached_at_ = 0;
  std::int64_t silent_until_ = 0;  ///< us; 0: has not been yet
  int master_ = -1, tokens_ = -1;
  int written_ = 0;
  std::int64_t refused_ns_ = 0;  ///< when the first write was refused; 0: none was
  int generation_ = 0, count_ = 0, since_plug_in_ = 0, unplugged_ = 0, dropped_ = 0;
  bool plugged_in_ = false, powered_ = false;
  std::vector<std::int64_t> unplugged_ns_, plugged_in_ns_;  ///< when, of CLOCK_MONOTONIC
  ListeningClock listening_;
};

}  // namespace spm::test
