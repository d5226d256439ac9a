// SPDX-License-Identifier: Apache-2.0
#include "servo/loop/run.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <future>
#include <memory>
#include <optional>
#include <thread>
#include <utility>

#include "common/base/instruction_set.hpp"
#include "common/base/units.hpp"
#include "servo/app/app_server.hpp"
#include "servo/devices/finder/device_list.hpp"
#include "servo/loop/supervisor.hpp"
#include "servo/realtime/core_pinning.hpp"
#include "servo/realtime/stop_signals.hpp"
#include "servo/record/collector.hpp"
#include "servo/scene/scene_keeper.hpp"

namespace spm::servo {

namespace {

constexpr std::chrono::milliseconds drain_interval{4};

void log_warning(const std::string& message) { spdlog::warn("{}", message); }
void log_message(const std::string& message) { spdlog::info("{}", message); }

/// The devices of the command line, or else of the scene: the scene's driver, or `auto`. A
/// simulated device that names no profile gets the scene's.
Result<std::vector<std::unique_ptr<Device>>> make_devices(const RunOptions& options,
                                                          const ForceChoice& choice) {
  std::vector<std::string> wanted = options.devices;
  const bool from_scene = wanted.empty();
  if (from_scene) wanted = {device_of(choice.device)};
  const std::string simulated = from_scene ? simulated_device_of(choice.device) : "sim";
  std::vector<std::unique_ptr<Device>> devices;
  for (const std::string& specification : wanted) {
    auto device = make_device(specification, simulated);
    if (!device && from_scene && !choice.device.driver.empty()) {
      return fail(ExitCode::invalid_input,
                  choice.scene_path + ": line " + std::to_string(choice.device.driver_line) +
                      ": 'driver' will not do as a device: " + device.error().message);
    }
    if (!device) return tl::make_unexpected(std::move(device.error()));
    devices.push_back(std::move(*device));
  }
  return devices;
}

/// What is served, at which rate, on which device, and how to end it.
std::string start_message(const RunOptions& options, const std::vector<KeeperReport>& assets,
                          const std::vector<std::string>& paths,
                          const std::vector<Device*>& devices) {
  std::string text = "serving ";
  if (assets.size() == 1) {
    const std::optional<double>& tolerance = assets.front().metadata.tolerance;
    text += paths.front();
    if (tolerance) text += " (tolerance " + format_quantity(*tolerance, Quantity::length) + ")";
  } else {
    text += fmt::format("a scene of {} assets", assets.size());
  }
  text += fmt::format(" at {:g} Hz on ", options.rate_hz);
  for (std::size_t i = 0; i < devices.size(); ++i) {
    text += (i > 0 ? ", " : "") + devices[i]->capabilities().name;
  }
  text += options.duration > 0 ? fmt::format(" for {:g} s", options.duration) : "";
  return text + "; end it with Ctrl-C";
}

/// Whether the simulated device was taken because no other is plugged in.
bool nothing_plugged_in(const RunOptions& options, const ForceChoice& choice,
                        const std::vector<Device*>& devices) {
  const std::string asked = options.devices.empty() ? device_of(choice.device) : options.devices[0];
  return asked == "auto" && devices.front()->capabilities().name == "sim";
}

Result<std::unique_ptr<SceneAssets>> open_assets(const RunOptions& options,
                                                 const ForceChoice& choice) {
  KeeperOptions each;
  each.mode = options.map;
  each.lock = options.realtime != RealtimeMode::off;
  each.warn = log_warning;
  return SceneAssets::open(std::move(each), choice, options.force.scene.empty() ? 0 : spare_assets);
}

RecordingHeader header_of(const RunOptions& options, const SceneAssets& assets,
                          const std::vector<Device*>& devices) {
  RecordingHeader header;
  header.spm_version = SPM_VERSION;
  header.instruction_set = instruction_set();
  header.rate_hz = options.rate_hz;
  for (const Device* device : devices) {
    const DeviceCapabilities& can = device->capabilities();
    header.devices.push_back({can.name, can.encoder_step, can.stiffness_cap});
  }
  for (std::size_t i = 0; i < force_off_count; ++i) {
    header.causes.emplace_back(to_string(static_cast<ForceOff>(i)));
  }
  for (const KeeperReport& asset : assets.reports()) {
    header.assets.push_back(asset.content_sha256);
  }
  return header;
}

/// Opens the files that are to be kept, so that a file that cannot be written is reported before
/// the first tick.
Result<Collector::Keeps> open_keeps(const RunOptions& options, const RecordingHeader& header) {
  Collector::Keeps keeps;
  if (!options.trace.empty()) {
    Result<TraceCsv> trace = TraceCsv::create(options.trace);
    if (!trace) return tl::make_unexpected(std::move(trace.error()));
    keeps.trace.emplace(std::move(*trace));
  }
  if (!options.record.empty()) {
    Result<RecordingWriter> recording = RecordingWriter::create(options.record, header);
    if (!recording) return tl::make_unexpected(std::move(recording.error()));
    keeps.recording.emplace(std::move(*recording));
  }
  if (!options.black_box.empty()) {
    keeps.black_box.emplace(options.black_box, header, log_warning);
  }
  return keeps;
}

/// Warns if a device cannot be as stiff as the scene asks.
void warn_of_stiffness(const ForceChoice& choice, const std::vector<Device*>& devices) {
  const double wanted = stiffness_at_hand(choice.scene);
  for (const Device* device : devices) {
    const DeviceCapabilities& can = device->capabilities();
    if (wanted <= can.stiffness_cap) continue;
    log_warning(can.name + ": the scene asks for " + format_quantity(wanted, Quantity::stiffness) +
                " at the hand, more than the " +
                format_quantity(can.stiffness_cap, Quantity::stiffness) +
                " that this device renders stably: what is stiffer is held to that "
                "(stiffness_cap= of the device changes it)");
  }
}

/// Runs the loop in a thread of its own, while this thread takes its records.
Result<RealtimeState> drive(Loop& loop, Collector& collector, const RunOptions& options,
                            StopSignals& signals) {
  std::promise<Result<RealtimeState>> entered;
  std::atomic<bool> done{false};
  std::thread thread([&] {
    const auto pinned = CorePinning::hold(options.core);
    Result<RealtimeState> realtime = enter_realtime(options.realtime);
    const bool refused = !realtime;
    entered.set_value(std::move(realtime));
    if (!refused) loop.run();
    done.store(true);
  });
  signals.listen();
  Result<RealtimeState> realtime = entered.get_future().get();
  if (realtime) {
    for (const std::string& warning : realtime->warnings) log_warning(warning);
  }
  while (!done.load()) {
    std::this_thread::sleep_for(drain_interval);
    collector.drain();
  }
  thread.join();
  collector.drain();
  return realtime;
}

AppNames names_of(const ServedScene& scene, const std::vector<Device*>& devices) {
  const ForceChoice& choice = scene.choice;
  AppNames names;
  for (const Device* device : devices) names.devices.push_back(device->capabilities().name);
  names.assets = choice.assets;
  for (std::size_t i = 0; i < scene.ids.size(); ++i) {
    const std::string& asset = choice.assets[choice.scene.objects[i].asset];
    names.objects.resize(std::max<std::size_t>(names.objects.size(), scene.ids[i] + 1));
    names.objects[scene.ids[i]] = std::filesystem::path(asset).filename().string();
  }
  return names;
}

LoopSettings loop_settings(const RunOptions& options, const ForceChoice& choice) {
  LoopSettings settings;
  settings.rate_hz = options.rate_hz;
  settings.paced_by_device = options.paced_by_device;
  settings.scene = choice.scene;
  settings.force_cap = choice.device.force_cap.value_or(settings.force_cap);
  if (options.duration > 0) {
    settings.ticks = std::max<std::uint64_t>(
        1, static_cast<std::uint64_t>(std::llround(options.duration * options.rate_hz)));
  }
  return settings;
}

/// Watches the scene's file; null if an asset alone is served.
std::unique_ptr<SceneKeeper> make_scene_keeper(const RunOptions& options, SceneAssets& assets,
                                               const std::vector<Device*>& devices,
                                               AppState& state) {
  if (options.force.scene.empty()) return nullptr;
  SceneKeeperOptions keeper;
  keeper.force = options.force;
  keeper.tell = log_message;
  keeper.warn = log_warning;
  keeper.taken_up = [&devices, &state](const ServedScene& scene) {
    state.rename(names_of(scene, devices));
    warn_of_stiffness(scene.choice, devices);
  };
  return std::make_unique<SceneKeeper>(std::move(keeper), assets);
}

/// Opens all devices, with their threads on the loop's core, and names them to the supervisor (null
/// for none).
Result<std::vector<Device*>> open_devices(const RunOptions& options, const ForceChoice& choice,
                                          std::span<const AssetView* const> views,
                                          const std::vector<std::unique_ptr<Device>>& devices,
                                          Supervisor* supervisor) {
  const auto pinned = CorePinning::hold(options.core);
  if (!pinned) return tl::make_unexpected(pinned.error());
  std::vector<Device*> open;
  std::vector<std::string> targets;
  for (const auto& device : devices) {
    const DeviceSetup setup{options.rate_hz, options.realtime, choice.scene, views};
    if (auto opened = device->open(setup); !opened) {
      return tl::make_unexpected(std::move(opened.error()));
    }
    open.push_back(device.get());
    targets.push_back(zero_force_target(*device));
  }
  if (supervisor != nullptr) {
    if (auto watched = supervisor->watch(targets); !watched) {
      return tl::make_unexpected(std::move(watched.error()));
    }
  }
  return open;
}

/// Null if no server is asked for. Also null if there is no place for its socket and no place was
/// named, because such a machine can serve forces all the same.
Result<std::unique_ptr<AppServer>> start_server(const RunOptions& options, AppState& state) {
  if (!options.serve) return std::unique_ptr<AppServer>();
  AppServerOptions served;
  served.path = options.socket;
  served.warn = log_warning;
  auto started = AppServer::start(std::move(served), state);
  if (started || !options.socket.empty()) return started;
  log_warning("applications cannot connect: " + started.error().message);
  return std::unique_ptr<AppServer>();
}

}  // namespace

Result<RunReport> run(const RunOptions& options) {
  // Made first, because it forks, and there are no threads yet. Ends last, when the devices are
  // closed.
  std::unique_ptr<Supervisor> supervisor;
  if (options.supervisor) {
    auto started = Supervisor::start();
    if (!started) return tl::make_unexpected(std::move(started.error()));
    supervisor = std::move(*started);
  }
  const auto choice = choose_forces(options.force);
  if (!choice) return tl::make_unexpected(choice.error());
  auto devices = make_devices(options, *choice);
  if (!devices) return tl::make_unexpected(std::move(devices.error()));
  auto assets = open_assets(options, *choice);
  if (!assets) return tl::make_unexpected(std::move(assets.error()));

  auto opened = open_devices(options, *choice, (*assets)->views(), *devices, supervisor.get());
  if (!opened) return tl::make_unexpected(std::move(opened.error()));
  const std::vector<Device*> open_devices = std::move(*opened);

  auto keeps = open_keeps(options, header_of(options, **assets, open_devices));
  if (!keeps) return tl::make_unexpected(std::move(keeps.error()));

  auto state = AppState::create(
      options.rate_hz, names_of({*choice, first_ids(choice->scene.objects.size())}, open_devices));
  if (!state) return tl::make_unexpected(std::move(state.error()));
  const auto server = start_server(options, **state);
  if (!server) return tl::make_unexpected(server.error());

  if (nothing_plugged_in(options, *choice, open_devices)) {
    log_warning(
        "no haptic device is plugged in that may be opened (spm-servo devices tells more): the "
        "simulated one is taken");
  }
  warn_of_stiffness(*choice, open_devices);
  log_message(start_message(options, (*assets)->reports(), (*assets)->paths(), open_devices));
  StopSignals signals;
  TickRing ring = make_tick_ring(options.rate_hz, open_devices.size());
  std::unique_ptr<SceneKeeper> scene_keeper =
      make_scene_keeper(options, **assets, open_devices, **state);
  Loop loop(loop_settings(options, *choice), open_devices, (*assets)->slots(), ring, signals.flag(),
            state->get(), scene_keeper ? &scene_keeper->edits() : nullptr);
  Collector collector(ring, open_devices.size(), options.rate_hz, std::move(*keeps), log_warning);
  (*assets)->watch();
  if (scene_keeper) scene_keeper->watch();
  Result<RealtimeState> realtime = drive(loop, collector, options, signals);
  if (!realtime) return tl::make_unexpected(std::move(realtime.error()));
  scene_keeper.reset();
  if (auto written = collector.finish(); !written) {
    return tl::make_unexpected(std::move(written.error()));
  }

  RunReport report;
  report.options = options;
  report.counters = loop.counters();
  report.wake_us = collector.wake_us();
  report.busy_us = collector.busy_us();
  report.realtime = std::move(*realtime);
  report.force = (*assets)->choice();
  report.force.assets = (*assets)->paths();
  report.black_boxes = collector.black_boxes();
  report.assets = (*assets)->reports();
  for (std::size_t i = 0; i < open_devices.size(); ++i) {
    report.devices.push_back(
        {open_devices[i]->capabilities(), open_devices[i]->describe(), loop.device_counters(i)});
  }
  return report;
}

}  // namespace spm::servo
