// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <string>
#include <thread>

namespace spm::baker {

/// Ends the process with exit code 10 and one sentence when a build takes too long, wherever it is:
/// the libraries underneath cannot be asked to stop. Nothing is half written, since it watches no
/// longer once disarmed, which the build does before it writes.
class TimeLimit {
 public:
  /// `what` is named in the sentence.
  TimeLimit(std::uint64_t seconds, std::string what);
  ~TimeLimit();
  TimeLimit(const TimeLimit&) = delete;
  TimeLimit& operator=(const TimeLimit&) = delete;

  void disarm();

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  bool disarmed_ = false;
  std::thread watch_;
};

}  // namespace spm::baker
