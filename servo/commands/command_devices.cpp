// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <memory>

#include "servo/commands/commands.hpp"
#include "servo/devices/finder/device_finder.hpp"

namespace spm::servo {

namespace {

struct DevicesCommand {
  cli::GlobalOptions global;
};

nlohmann::ordered_json to_json(const DeviceSearch& search) {
  nlohmann::ordered_json devices = nlohmann::ordered_json::array();
  for (const FoundDevice& device : search.devices) devices.push_back(to_json(device));
  return {{"devices", std::move(devices)},
          {"usb_devices", search.usb_devices},
          {"notes", search.notes}};
}

std::string line_of(const FoundDevice& device) {
  std::string line = fmt::format("{:<14} {} ({:04x}:{:04x}", device.match.driver,
                                 device.product.empty() ? "without a name" : device.product,
                                 device.ids.vendor, device.ids.product);
  if (!device.serial.empty()) line += ", serial " + device.serial;
  if (!device.usb.empty()) line += ", at USB " + device.usb;
  return line + fmt::format("), {}: {}\n", device.node,
                            device.permitted() ? "may be opened" : "MAY NOT BE OPENED");
}

std::string to_text(const DeviceSearch& search) {
  std::string text;
  const auto add_below = [&](const std::string& what) {
    if (!what.empty()) text += fmt::format("{:<14} {}\n", "", what);
  };
  for (const FoundDevice& device : search.devices) {
    text += line_of(device);
    if (device.match.driven) add_below("--device " + specification_of(device));
    add_below(device.match.note);
    add_below(cure_of(device));
  }
  if (search.devices.empty()) {
    text += fmt::format(
        "No haptic device is plugged in, of {} USB devices. '--device sim' needs none.\n",
        search.usb_devices);
  }
  for (const std::string& note : search.notes) text += note + "\n";
  return text;
}

int execute_devices(const DevicesCommand& command) {
  cli::configure_messages(command.global);
  const DeviceSearch search = find_devices();
  if (command.global.json) {
    cli::print_json(to_json(search));
  } else if (!command.global.quiet) {
    fmt::print("{}", to_text(search));
  }
  return static_cast<int>(ExitCode::done);
}

}  // namespace

Command add_devices_command(CLI::App& program) {
  auto command = std::make_shared<DevicesCommand>();
  CLI::App* app = program.add_subcommand(
      "devices",
      "List the haptic devices that are plugged in, and what to do where one may not be "
      "opened");
  cli::add_global_options(*app, command->global);
  return {app, [command] { return execute_devices(*command); }};
}

}  // namespace spm::servo
