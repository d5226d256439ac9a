// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <string>
#include <thread>

namespace spm::baker {

/// Ends the process with exit code 10 and one sentence when a build takes too long, wherever the
/// build is at that time: the libraries underneath cannot be asked to stop. The build disarms it
/// before it writes, so no file is left half written.
class TimeLimit {
 public:
  /// `what` is named in the sentence.
  TimeLimit(std::uint64_t seconds, std::string what);
  ~TimeLimit();
  TimeLimit(const TimeLimit&) = delete;
  TimeLimit& operator=(const TimeLimit&) = delete;

  /// What is being done, named in the sentence with what of a mesh makes it long, and what is known
  /// of the mesh.
  void enter(std::string stage);
  void describe(std::string mesh);
  void disarm();

 private:
  [[nodiscard]] std::string place() const;

  std::mutex mutex_;
  std::condition_variable changed_;
  bool disarmed_ = false;
  std::string stage_, mesh_;
  std::thread watch_;
};

}  // namespace spm::baker
