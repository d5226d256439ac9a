// SPDX-License-Identifier: Apache-2.0

// Runs a program that sees a Novint Falcon plugged in, which exists only as a script: umockdev
// gives it to the real libusb as a USB device, and answers for the kernel.
//
// Usage: mock_usb_falcon [--mode MODE] [--firmware-size BYTES] [--home-after PACKETS]
//                        [--act-after PACKETS] [--replug-ms MS] [--times COUNT] -- PROGRAM
//                        [ARGUMENT...]
// Modes:
//   normal   no firmware runs yet
//   running  the firmware runs already
//   zero     a zero leads the boot program's answer
//   echo     in the first upload one byte comes back wrong
//   short    every 50th answer lacks its last two bytes
//   late     every 20th answer comes 5 ms later
//   busy     another program has it
//   silent   stays plugged in, but answers no more after --act-after packets
//   replug   is unplugged after --act-after packets, and plugged in --replug-ms later, still
//            powered; --times times, with so many packets between
//   move     the same, but plugged in at another place, 1-3
//   power    the same as replug without power: the firmware is lost, and so is homing
//
// Ends with the program's exit code; with 3 where that is 0 but the host broke the device's rules.
// Prints one line of JSON to the standard error at the end.

#include <fmt/format.h>
#include <glib-object.h>
#include <sched.h>
#include <sys/wait.h>
#include <umockdev.h>
#include <unistd.h>

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <thread>
#include <vector>

#include "tests/servo/devices/falcon/mock_usb_chip.hpp"
#include "tests/servo/devices/falcon/scripted_falcon.hpp"

namespace spm::test {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

/// Below a servo's threads, above everything else, so that the device's clock keeps time.
constexpr int mock_priority = 70;

constexpr const char* root_path = "/devices/pci0000:00/0000:00:14.0/usb1";

struct Options {
  std::string mode = "normal";
  std::size_t firmware_size = 8492;
  std::uint64_t home_after = 20;
  std::uint64_t act_after = 500;
  milliseconds replug{300};
  int times = 1;
  std::vector<char*> program;  ///< ends with a null
};

[[noreturn]] void die(const std::string& message) {
  fmt::print(stderr, "mock_usb_falcon: {}\n", message);
  std::exit(2);
}

Options parse(int count, char** arguments) {
  Options options;
  int i = 1;
  for (; i < count && std::string(arguments[i]) != "--"; i += 2) {
    const std::string key = arguments[i];
    if (i + 1 >= count) die(key + " has no value");
    const std::string value = arguments[i + 1];
    if (key == "--mode") {
      options.mode = value;
    } else if (key == "--firmware-size") {
      options.firmware_size = std::stoul(value);
    } else if (key == "--home-after") {
      options.home_after = std::stoul(value);
    } else if (key == "--act-after") {
      options.act_after = std::stoul(value);
    } else if (key == "--replug-ms") {
      options.replug = milliseconds(std::stol(value));
    } else if (key == "--times") {
      options.times = std::stoi(value);
    } else {
      die(key + " is not known");
    }
  }
  for (++i; i < count; ++i) options.program.push_back(arguments[i]);
  if (options.program.empty()) die("no program is named after --");
  options.program.push_back(nullptr);
  return options;
}

FalconFaults faults_of(const Options& options) {
  FalconFaults faults;
  if (options.mode == "zero") faults.leading_zero = true;
  if (options.mode == "echo") faults.wrong_echoes = 1;
  if (options.mode == "short") faults.short_every = 50;
  return faults;
}

/// The records of a USB device, as umockdev reads them.
std::string records(const std::string& path, unsigned number, const std::string& port,
                    const std::string& ids, const std::string& descriptors, unsigned speed) {
  const std::string node = fmt::format("bus/usb/001/{:03}", number);
  return fmt::format(
      "P: {0}\nN: {1}\nE: DEVNAME=/dev/{1}\nE: DEVTYPE=usb_device\nE: SUBSYSTEM=usb\n"
      "E: BUSNUM=001\nE: DEVNUM={2:03}\nA: busnum=1\\n\nA: devnum={2}\\n\nA: devpath={3}\\n\n"
      "A: speed={4}\\n\nA: bConfigurationValue=1\\n\n{5}H: descriptors={6}\n\n",
      path, node, number, port, speed, ids, descriptors);
}

std::string root_hub() {
  return records(root_path, 1, "0", "A: idVendor=1d6b\\n\nA: idProduct=0002\\n\n",
                 "12010002090001406B1D0200150503020101"
                 "0902190001010"
                 "0E0000904000001090000000705810304000C",
                 480);
}

std::string falcon_path(unsigned port) { return fmt::format("{}/1-{}", root_path, port); }

/// As an FT232R without a serial number gives them.
std::string falcon_records(unsigned number, unsigned port) {
  return records(falcon_path(port), number, std::to_string(port),
                 "A: idVendor=0403\\n\nA: idProduct=cb48\\n\n",
                 "1201000200000008030448CB000601020001"
                 "0902200001010"
                 "0802D0904000002FFFFFF0207058102400000"
                 "07050202400000",
                 12);
}

/// The test bed, and the device in it.
class Bus {
 public:
  Bus() : bed_(umockdev_testbed_new()), handler_(umockdev_ioctl_base_new()) {
    add(root_hub());
    g_signal_connect(handler_, "handle-ioctl", G_CALLBACK(&Bus::handle), this);
    g_signal_connect(handler_, "client-vanished", G_CALLBACK(&Bus::vanished), this);
  }
  Bus(const Bus&) = delete;
  Bus& operator=(const Bus&) = delete;
  ~Bus() {
    g_object_unref(bed_);
    g_object_unref(handler_);
  }

  void plug(MockUsbChip& chip) {
    chip_ = &chip;
    ++number_;
    add(falcon_records(number_, port_));
    const std::string node = fmt::format("/dev/bus/usb/001/{:03}", number_);
    gchar* root = umockdev_testbed_get_root_dir(bed_);
    const std::string file = root + node;
    g_free(root);
    // A file would always be ready to be written; a terminal can be told not to be, which is how
    // the kernel says that no transfer has ended.
    if (unlink(file.c_str()) != 0 || symlink(chip.terminal(), file.c_str()) != 0) {
      die("the device's node cannot be replaced: " + std::string(std::strerror(errno)));
    }
    GError* error = nullptr;
    if (!umockdev_testbed_attach_ioctl(bed_, node.c_str(), handler_, &error)) die(error->message);
  }

  void unplug() {
    chip_->unplug();
    umockdev_testbed_remove_device(bed_, ("/sys" + falcon_path(port_)).c_str());
  }

  /// Where it is plugged in from the next time on.
  void move() { port_ = 3; }

 private:
  void add(const std::string& text) {
    GError* error = nullptr;
    if (!umockdev_testbed_add_from_string(bed_, text.c_str(), &error)) die(error->message);
  }
  static gboolean handle(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer self) {
    return static_cast<Bus*>(self)->chip_->handle(client) ? TRUE : FALSE;
  }
  static void vanished(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer self) {
    static_cast<Bus*>(self)->chip_->forget(client);
  }

  UMockdevTestbed* bed_;
  UMockdevIoctlBase* handler_;
  MockUsbChip* chip_ = nullptr;
  unsigned number_ = 4, port_ = 2;
};

void set_priority(int policy, int priority) {
  sched_param parameters{};
  parameters.sched_priority = priority;
  static_cast<void>(sched_setscheduler(0, policy, &parameters));
}

pid_t start(const Options& options) {
  const pid_t child = fork();
  if (child != 0) return child;
  set_priority(SCHED_OTHER, 0);
  setenv("LD_PRELOAD", "libumockdev-preload.so.0", 1);
  execv(options.program[0], options.program.data());
  std::perror(options.program[0]);
  _exit(127);
}

int exit_code(int status) { return WIFEXITED(status) ? WEXITSTATUS(status) : 128; }

int run(const Options& options) {
  set_priority(SCHED_FIFO, mock_priority);
  ScriptedFalcon falcon(options.firmware_size, faults_of(options),
                        options.mode == "running" || options.mode == "move");
  falcon.home_after(options.home_after);
  MockUsbChip chip(falcon, options.mode == "late" ? 20 : 0, milliseconds(5));
  if (options.mode == "silent") chip.mute_after(options.act_after);
  if (options.mode == "busy") chip.refuse_claims();
  Bus bus;
  bus.plug(chip);

  const bool moves = options.mode == "move";
  const bool unplugs = moves || options.mode == "replug" || options.mode == "power";
  const int times = unplugs ? options.times : 0;
  int unplugged = 0;
  std::vector<std::int64_t> unplugged_ns, plugged_in_ns;  // of CLOCK_MONOTONIC
  const auto note = [](std::vector<std::int64_t>& list) {
    list.push_back(std::chrono::nanoseconds(steady_clock::now().time_since_epoch()).count());
  };
  std::uint64_t next = options.act_after;
  int status = 0;
  const pid_t child = start(options);
  while (waitpid(child, &status, WNOHANG) == 0) {
    std::this_thread::sleep_for(milliseconds(5));
    if (unplugged == times || chip.packets() < next) continue;
    note(unplugged_ns);
    bus.unplug();
    ++unplugged;
    if (options.mode == "power") chip.lose_power();
    if (moves) bus.move();
    std::this_thread::sleep_for(options.replug);
    bus.plug(chip);
    note(plugged_in_ns);
    next = chip.packets() + options.act_after;
  }

  const int code = exit_code(status);
  const bool rules_kept = falcon.homing_packets() == falcon.packets() &&
                          falcon.wrong_packets() == 0 && falcon.early_pushes() == 0;
  fmt::print(stderr,
             "{{\"mode\": \"{}\", \"program_exit\": {}, \"boots\": {}, \"calls\": {}, "
             "\"loaded_bytes\": {}, \"packets\": {}, \"packets_with_homing\": {}, "
             "\"wrong_packets\": {}, \"pushing_packets\": {}, \"pushes_before_homing\": {}, "
             "\"largest_motor\": {}, \"last_lights\": {}, \"last_lit\": {}, \"unplugged\": {}, "
             "\"unplugged_ns\": [{}], "
             "\"plugged_in_ns\": [{}], \"rules_kept\": {}}}\n",
             options.mode, code, falcon.boots(), falcon.calls(), falcon.loaded().size(),
             falcon.packets(), falcon.homing_packets(), falcon.wrong_packets(),
             falcon.pushing_packets(), falcon.early_pushes(), falcon.largest_motor(),
             falcon.lights(), falcon.lit(), unplugged, fmt::join(unplugged_ns, ", "),
             fmt::join(plugged_in_ns, ", "), rules_kept);
  return code == 0 && !rules_kept ? 3 : code;
}

}  // namespace
}  // namespace spm::test

int main(int count, char** arguments) { return spm::test::run(spm::test::parse(count, arguments)); }
