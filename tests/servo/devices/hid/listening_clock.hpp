// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glib.h>

#include <array>
#include <cstdint>
#include <mutex>
#include <vector>

namespace spm::test {

/// Notes when a thread of glib's did not come to its sources. umockdev serves all clients in one
/// thread, exchanges a report in two steps, and waits between them for its client, be it stopped
/// or not; a kernel waits for no program. What is sent to an emulated device just then comes late.
class ListeningClock {
 public:
  ListeningClock() = default;
  ListeningClock(const ListeningClock&) = delete;
  ListeningClock& operator=(const ListeningClock&) = delete;
  ~ListeningClock();

  /// Begins with the thread that calls, from one of its sources; does nothing if it has begun.
  void begin();

  /// From when to when nobody was served for 8 ms or longer, ns of CLOCK_MONOTONIC. Any thread.
  [[nodiscard]] std::vector<std::array<std::int64_t, 2>> deaf_ns();

 private:
  static gboolean on_time(gpointer self);

  std::mutex mutex_;
  GSource* source_ = nullptr;
  std::int64_t listened_ns_ = 0;
  std::vector<std::array<std::int64_t, 2>> deaf_ns_;
};

}  // namespace spm::test
