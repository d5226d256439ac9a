// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "baker/base/progress.hpp"

namespace spm::baker {

/// Runs in a process of its own. Its answer must not contain a line break.
using Job = std::function<std::string(const Progress&)>;

/// News of a job.
struct JobEvent {
  std::size_t job = 0;
  bool ended = false;
  std::string stage;   ///< while it runs
  double done = 0;     ///< part of the stage, 0 to 1
  std::string answer;  ///< when it has ended; empty where it ended before it had one
  std::string errors;  ///< what it wrote to stderr
  int wait_status = 0;
};

/// Jobs in processes of their own, several at once: the libraries underneath share their threads
/// over a whole process and can end it, and a bake that runs out of memory must not take the others
/// with it. The jobs end with this process, however it ends. The process must have one thread.
class Workers {
 public:
  Workers() = default;
  ~Workers();
  Workers(const Workers&) = delete;
  Workers& operator=(const Workers&) = delete;

  /// Starts a job; false where the system has no room for another process.
  [[nodiscard]] bool start(std::size_t job, const Job& work);

  [[nodiscard]] std::size_t running() const { return workers_.size(); }

  /// Waits until one of the running jobs has something to tell.
  [[nodiscard]] JobEvent wait();

 private:
  struct Worker {
    std::size_t job = 0;
    pid_t process = 0;
    int messages = -1;  ///< -1 once closed
    int errors = -1;
    std::string pending;  ///< part of a line
    std::string answer;
    std::string error_text;
  };

  [[nodiscard]] JobEvent end_of(std::size_t index);
  [[nodiscard]] bool read_lines(Worker& worker, JobEvent& event);

  std::vector<Worker> workers_;
};

}  // namespace spm::baker
