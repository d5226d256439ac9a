// SPDX-License-Identifier: Apache-2.0
/// Runs a program with an emulated HID device plugged in, by libumockdev: the program's own hidapi,
/// udev and hidraw calls meet it as they would meet a real one.
///
///     mock_hid DEVICE [FAULT...] -- PROGRAM [ARGUMENT...]
///
/// DEVICE is wooden-v1, wooden-v2, wooden-v3, spacemouse, pid, pid-axes, pid-no-constant, pid-full
/// or pid-busy. Faults, counted in reports:
///     short=N        every Nth report lacks its last byte
///     late=N:MS      every Nth report comes so much later
///     silence=N:MS   after N reports none comes for so long, once
///     unplug=N:MS    after each N reports it is unplugged, and plugged in again after so long
///     refuse=N:M     M of the host's reports fail, unheard by the device, from the Nth on
///     press=N        V2 and V3: the calibration button is pressed at this report
///     quiet          V2 and V3: the first report was lost
///     start=A:B:C    counters when it gets power
///     step=N:M       WoodenHaptics: the third counter steps between -N and N instead of swinging,
///                    M to 2 M reports after the last step was answered by a current (N) or none
///     until=N        the program is told to end (SIGTERM) when so many reports were sent
///     report=FILE    where to write what the device saw (JSON); else to the error output
/// The exit code is the program's, or 70 where the device was sent what its protocol does not know.
#include <glib.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <charconv>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <iostream>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "tests/servo/devices/hid/emulated_hid.hpp"
#include "tests/servo/devices/hid/mock_hid_bus.hpp"

namespace {

constexpr int wrong_packet_code = 70;

struct CommandLine {
  std::string device;
  spm::test::HidFaults faults;
  spm::test::EmulatedOptions emulated;
  int until = 0;
  std::string report;
  std::vector<char*> program;  ///< ends with null
};

/// Numbers separated by colons.
std::vector<int> numbers(std::string_view text) {
  std::vector<int> list;
  while (true) {
    const std::size_t colon = text.find(':');
    const std::string_view item = text.substr(0, colon);
    int number = 0;
    const auto parsed = std::from_chars(item.data(), item.data() + item.size(), number);
    if (parsed.ec != std::errc{} || parsed.ptr != item.data() + item.size()) return {};
    list.push_back(number);
    if (colon == std::string_view::npos) return list;
    text.remove_prefix(colon + 1);
  }
}

bool take_fault(CommandLine& line, const std::string& text) {
  const std::size_t equals = text.find('=');
  const std::string key = text.substr(0, equals);
  const std::string value = equals == std::string::npos ? "" : text.substr(equals + 1);
  spm::test::HidFaults& faults = line.faults;
  const std::vector<int> given = numbers(value);
  if (key == "quiet" && equals == std::string::npos) {
    line.emulated.quiet = true;
  } else if (key == "report" && !value.empty()) {
    line.report = value;
  } else if (key == "short" && given.size() == 1) {
    faults.short_every = given[0];
  } else if (key == "until" && given.size() == 1) {
    line.until = given[0];
  } else if (key == "press" && given.size() == 1) {
    line.emulated.press_at = given[0];
  } else if (key == "late" && given.size() == 2) {
    faults.late_every = given[0];
    faults.late_ms = given[1];
  } else if (key == "silence" && given.size() == 2) {
    faults.silent_after = given[0];
    faults.silent_ms = given[1];
  } else if (key == "unplug" && given.size() == 2) {
    faults.unplug_after = given[0];
    faults.unplug_ms = given[1];
  } else if (key == "refuse" && given.size() == 2) {
    faults.refused_write = given[0];
    faults.refused_writes = given[1];
  } else if (key == "step" && given.size() == 2 && given[1] > 0) {
    line.emulated.step = given[0];
    line.emulated.step_every = given[1];
  } else if (key == "start" && given.size() == 3) {
    line.emulated.start = {given[0], given[1], given[2]};
  } else {
    return false;
  }
  return true;
}

bool parse(CommandLine& line, int argc, char** argv) {
  if (argc < 2) return false;
  line.device = argv[1];
  int i = 2;
  for (; i < argc && std::string_view(argv[i]) != "--"; ++i) {
    if (!take_fault(line, argv[i])) return false;
  }
  for (++i; i < argc; ++i) line.program.push_back(argv[i]);
  if (line.program.empty()) return false;
  line.program.push_back(nullptr);
  return true;
}

struct Ended {
  GMainLoop* loop;
  int status = 0;
};

void on_ended(GPid, gint status, gpointer given) {
  auto* ended = static_cast<Ended*>(given);
  ended->status = status;
  g_main_loop_quit(ended->loop);
}

}  // namespace

int main(int argc, char** argv) try {
  CommandLine line;
  if (!parse(line, argc, argv)) {
    std::cerr << "usage: mock_hid DEVICE [FAULT...] -- PROGRAM [ARGUMENT...]\n";
    return 1;
  }
  auto device = spm::test::make_emulated_hid(line.device, line.emulated);
  if (device == nullptr) {
    std::cerr << "mock_hid: device '" << line.device
              << "' is not known; there are wooden-v1, wooden-v2, wooden-v3, spacemouse, pid, "
                 "pid-axes, pid-no-constant, pid-full and pid-busy\n";
    return 1;
  }
  // Where it is allowed, so that a busy machine does not make the device a slow one.
  sched_param priority{};
  priority.sched_priority = 70;
  static_cast<void>(sched_setscheduler(0, SCHED_FIFO, &priority));
  auto bus = std::make_unique<spm::test::MockHidBus>(std::move(device), line.faults);
  bus->plug_in();
  const pid_t child = fork();
  if (child == 0) {
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    priority.sched_priority = 0;
    static_cast<void>(sched_setscheduler(0, SCHED_OTHER, &priority));
    setenv("LD_PRELOAD", "libumockdev-preload.so.0", 1);
    execvp(line.program[0], line.program.data());
    std::perror("mock_hid: the program does not start");
    _exit(127);
  }
  bus->notify_at(line.until, [child] { kill(child, SIGTERM); });
  Ended ended{g_main_loop_new(nullptr, FALSE)};
  g_child_watch_add(child, on_ended, &ended);
  g_main_loop_run(ended.loop);
  g_main_loop_unref(ended.loop);

  const std::string seen = bus->seen().dump();
  const bool wrong = bus->wrong() > 0;
  // What umockdev says of devices that go must not follow what was seen.
  bus.reset();
  if (line.report.empty()) {
    std::cerr << seen << '\n';
  } else {
    std::ofstream(line.report) << seen << '\n';
  }
  const int code = WIFEXITED(ended.status) ? WEXITSTATUS(ended.status) : 128;
  return code == 0 && wrong ? wrong_packet_code : code;
} catch (const std::exception& problem) {
  std::fprintf(stderr, "mock_hid: %s\n", problem.what());
  return 4;
}
