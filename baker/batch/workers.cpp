// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/batch/workers.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <iterator>
#include <mutex>
#include <string_view>
#include <utility>

namespace spm::baker {
namespace {

constexpr std::size_t most_error_text = 1U << 16U;
// Lines that a worker sends begin with the kind of their news.
constexpr char progress_mark = 'p';
constexpr char answer_mark = 'a';

void send(int descriptor, std::string_view text) {
  while (!text.empty()) {
    const ssize_t count = ::write(descriptor, text.data(), text.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return;  // nobody listens any more
    text.remove_prefix(static_cast<std::size_t>(count));
  }
}

/// Progress as lines, a few a second.
class ProgressSender {
 public:
  explicit ProgressSender(int descriptor) : descriptor_(descriptor) {}

  void send_progress(const char* stage, double done) {
    constexpr std::chrono::milliseconds pause(200);
    const std::lock_guard lock(mutex_);
    const auto now = std::chrono::steady_clock::now();
    if (stage == last_stage_ && now - last_ < pause) return;
    last_ = now;
    last_stage_ = stage;
    send(descriptor_, progress_mark + std::to_string(done) + " " + stage + "\n");
  }

 private:
  int descriptor_;
  std::mutex mutex_;
  std::string last_stage_;
  std::chrono::steady_clock::time_point last_;
};

[[noreturn]] void work_and_end(const Job& work, pid_t parent, int messages, int errors) {
  // Ends with the process that asked, even where that one is killed.
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(EXIT_FAILURE);
  ::signal(SIGPIPE, SIG_IGN);
  ::dup2(errors, STDERR_FILENO);
  ::dup2(errors, STDOUT_FILENO);  // the lines on standard output are the batch's
  ProgressSender sender(messages);
  const std::string answer =
      work([&sender](const char* stage, double done) { sender.send_progress(stage, done); });
  std::cerr.flush();
  send(messages, answer_mark + answer + "\n");
  ::_exit(EXIT_SUCCESS);
}

void close_both(const std::array<int, 2>& ends) {
  for (const int end : ends) ::close(end);
}

}  // namespace

Workers::~Workers() {
  for (const Worker& worker : workers_) {
    ::kill(worker.process, SIGKILL);
    int status = 0;
    while (::waitpid(worker.process, &status, 0) < 0 && errno == EINTR) {
    }
    if (worker.messages >= 0) ::close(worker.messages);
    if (worker.errors >= 0) ::close(worker.errors);
  }
}

bool Workers::start(std::size_t job, const Job& work) {
  std::array<int, 2> messages{-1, -1}, errors{-1, -1};
  if (::pipe2(messages.data(), O_CLOEXEC) != 0) return false;
  if (::pipe2(errors.data(), O_CLOEXEC) != 0) {
    close_both(messages);
    return false;
  }
  std::cout.flush();
  std::cerr.flush();
  std::fflush(nullptr);
  const pid_t parent = ::getpid();
  const pid_t process = ::fork();
  if (process == 0) work_and_end(work, parent, messages[1], errors[1]);
  ::close(messages[1]);
  ::close(errors[1]);
  if (process < 0) {
    ::close(messages[0]);
    ::close(errors[0]);
    return false;
  }
  Worker& worker = workers_.emplace_back();
  worker.job = job;
  worker.process = process;
  worker.messages = messages[0];
  worker.errors = errors[0];
  return true;
}

/// Takes what has come; true where that was progress to tell.
bool Workers::read_lines(Worker& worker, JobEvent& event) {
  std::array<char, 4096> block{};
  const ssize_t count = ::read(worker.messages, block.data(), block.size());
  if (count < 0 && errno == EINTR) return false;
  if (count <= 0) {
    ::close(std::exchange(worker.messages, -1));
    return false;
  }
  worker.pending.append(block.data(), static_cast<std::size_t>(count));
  bool told = false;
  for (std::size_t end = 0; (end = worker.pending.find('\n')) != std::string::npos;) {
    const std::string line = worker.pending.substr(0, end);
    worker.pending.erase(0, end + 1);
    if (line.front() == answer_mark) worker.answer = line.substr(1);
    if (line.front() != progress_mark) continue;
    const std::size_t blank = line.find(' ');
    event.job = worker.job;
    event.done = std::strtod(line.c_str() + 1, nullptr);
    event.stage = line.substr(blank + 1);
    told = true;
  }
  return told;
}

JobEvent Workers::end_of(std::size_t index) {
  Worker& worker = workers_[index];
  JobEvent event;
  event.job = worker.job;
  event.ended = true;
  event.answer = std::move(worker.answer);
  event.errors = std::move(worker.error_text);
  while (::waitpid(worker.process, &event.wait_status, 0) < 0 && errno == EINTR) {
  }
  workers_.erase(workers_.begin() + static_cast<std::ptrdiff_t>(index));
  return event;
}

JobEvent Workers::wait() {
  for (;;) {
    std::vector<pollfd> files;
    for (std::size_t i = 0; i < workers_.size(); ++i) {
      if (workers_[i].messages < 0 && workers_[i].errors < 0) return end_of(i);
      // poll passes over negative descriptors.
      files.push_back({workers_[i].messages, POLLIN, 0});
      files.push_back({workers_[i].errors, POLLIN, 0});
    }
    if (::poll(files.data(), files.size(), -1) < 0) continue;
    JobEvent event;
    bool told = false;
    for (std::size_t i = 0; i < workers_.size(); ++i) {
      Worker& worker = workers_[i];
      if (files[2 * i + 1].revents != 0) {
        std::array<char, 4096> block{};
        const ssize_t count = ::read(worker.errors, block.data(), block.size());
        if (count == 0 || (count < 0 && errno != EINTR)) {
          ::close(std::exchange(worker.errors, -1));
        } else if (count > 0 && worker.error_text.size() < most_error_text) {
          worker.error_text.append(block.data(), static_cast<std::size_t>(count));
        }
      }
      if (files[2 * i].revents != 0 && !told) told = read_lines(worker, event);
    }
    if (told) return event;
  }
}

}  // namespace spm::baker
