// SPDX-License-Identifier: Apache-2.0
#include "servo/loop/supervisor_program.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <memory>
#include <string_view>

#include "servo/loop/supervisor_process.hpp"
#include "servo/record/black_box_files.hpp"

namespace spm::servo {

namespace {

constexpr const char* told = "--supervise";
/// The descriptors that it finds.
constexpr int line_end = 3, beat_memory = 4, box_memory = 5;

/// Copies of descriptors whose numbers are none of those that the program finds.
class Copies {
 public:
  explicit Copies(const std::array<int, 3>& originals) {
    for (std::size_t i = 0; i < originals.size(); ++i) {
      numbers_[i] = originals[i] < 0 ? -1 : fcntl(originals[i], F_DUPFD_CLOEXEC, box_memory + 1);
    }
  }
  Copies(const Copies&) = delete;
  Copies& operator=(const Copies&) = delete;
  ~Copies() {
    for (const int number : numbers_) {
      if (number >= 0) close(number);
    }
  }
  [[nodiscard]] int operator[](std::size_t i) const { return numbers_[i]; }

 private:
  std::array<int, 3> numbers_{};
};

}  // namespace

Supervisor::Afterwards keep_black_box(const BlackBoxMemory* memory, const std::string& path) {
  if (memory == nullptr) return {};
  return [memory, path]() -> std::string {
    if (memory->empty()) return {};
    const auto kept = write_black_box(*memory, path);
    if (!kept) return "warning: the last ticks could not be kept: " + kept.error().message;
    return "warning: the last ticks are kept in " + *kept +
           "; look at them with spm-servo view --recording";
  };
}

Supervisor::StartAgain start_as_program(RealtimeMode realtime, const BlackBoxMemory* memory,
                                        const std::string& path) {
  return [realtime, memory, path](int line, int beat) -> pid_t {
    const Copies copies({line, beat, memory != nullptr ? memory->descriptor() : -1});
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, copies[0], line_end);
    posix_spawn_file_actions_adddup2(&actions, copies[1], beat_memory);
    if (memory != nullptr) posix_spawn_file_actions_adddup2(&actions, copies[2], box_memory);
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    sigset_t none;
    sigemptyset(&none);
    posix_spawnattr_setsigmask(&attributes, &none);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK);

    std::string name = "spm-supervisor", word = told;
    std::string mode = std::to_string(static_cast<int>(realtime));
    std::string bytes = std::to_string(memory != nullptr ? memory->half_bytes() : 0);
    std::string file = path;
    std::array<char*, 6> arguments{name.data(),  word.data(), mode.data(),
                                   bytes.data(), file.data(), nullptr};
    pid_t process = -1;
    const int failed =
        posix_spawn(&process, "/proc/self/exe", &actions, &attributes, arguments.data(), environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&actions);
    errno = failed;
    return failed == 0 ? process : -1;
  };
}

std::optional<int> be_supervisor_program(std::span<char* const> arguments) {
  if (arguments.size() != 5 || std::string_view(arguments[1]) != told) return std::nullopt;
  const auto number = [&arguments](std::size_t which) {
    const std::string_view text = arguments[which];
    std::size_t value = 0;
    std::from_chars(text.data(), text.data() + text.size(), value);
    return value;
  };
  const auto* const beat = map_beat(beat_memory);
  if (beat == nullptr) return static_cast<int>(ExitCode::file_or_device);
  std::unique_ptr<BlackBoxMemory> memory;
  if (const std::size_t half_bytes = number(3); half_bytes > 0) {
    // Without it a device's force is ended all the same.
    if (auto attached = BlackBoxMemory::attach(box_memory, half_bytes)) {
      memory = std::move(*attached);
    }
  }
  supervise(line_end, *beat, open_zero_force, static_cast<RealtimeMode>(number(2)),
            keep_black_box(memory.get(), arguments[4]));
  return static_cast<int>(ExitCode::done);
}

}  // namespace spm::servo
