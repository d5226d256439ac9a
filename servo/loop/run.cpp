// SPDX-License-Identifier: Apache-2.0
#include "servo/loop/run.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <thread>
#include <utility>

#include "common/base/instruction_set.hpp"
#include "common/base/units.hpp"
#include "common/contact/stable_stiffness.hpp"
#include "servo/app/app_server.hpp"
#include "servo/devices/finder/device_list.hpp"
#include "servo/loop/outside_supervisor.hpp"
#include "servo/loop/place_watch.hpp"
#include "servo/loop/run_header.hpp"
#include "servo/loop/run_messages.hpp"
#include "servo/loop/supervisor.hpp"
#include "servo/loop/supervisor_program.hpp"
#include "servo/loop/supervisor_watch.hpp"
#include "servo/realtime/core_pinning.hpp"
#include "servo/realtime/service_notice.hpp"
#include "servo/realtime/sleep_notice.hpp"
#include "servo/realtime/stop_signals.hpp"
#include "servo/realtime/wakeup_latency.hpp"
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

/// The devices as far as settings depend on them.
std::vector<ForceDevice> force_devices(const std::vector<std::unique_ptr<Device>>& devices) {
  std::vector<ForceDevice> list;
  list.reserve(devices.size());
  for (const auto& device : devices) {
    list.push_back(force_device(device->capabilities()));
  }
  return list;
}

Result<std::unique_ptr<SceneAssets>> open_assets(const RunOptions& options,
                                                 const ForceChoice& choice, std::size_t hands) {
  KeeperOptions each;
  each.mode = options.map;
  each.lock = options.realtime != RealtimeMode::off;
  each.warn = log_warning;
  const std::size_t spare = options.force.scene.empty() ? 0 : spare_assets;
  const ToolRoom room{hands, objects_to_meet(choice.scene, AppScene::room(choice.scene))};
  return SceneAssets::open(std::move(each), choice, spare, room);
}

LoopSettings loop_settings(const RunOptions& options, const ForceChoice& choice) {
  LoopSettings settings;
  settings.rate_hz = options.rate_hz;
  settings.paced_by_device = options.paced_by_device;
  settings.acknowledge = options.acknowledge;
  settings.enable_button = options.enable_button;
  settings.tick_budget = options.tick_budget;
  settings.scene = choice.scene;
  settings.force_cap = choice.device.force_cap.value_or(settings.force_cap);
  if (options.duration > 0) {
    settings.ticks = std::max<std::uint64_t>(
        1, static_cast<std::uint64_t>(std::llround(options.duration * options.rate_hz)));
  }
  return settings;
}

/// Opens the files that are to be kept, so that a file that cannot be written is reported before
/// the first tick.
Result<Collector::Keeps> open_keeps(const RunOptions& options, RunRecorder::Settings settings,
                                    StepRing& steps) {
  Collector::Keeps keeps;
  if (!options.trace.empty()) {
    Result<TraceCsv> trace = TraceCsv::create(options.trace, settings.scene.tool.has_value());
    if (!trace) return tl::make_unexpected(std::move(trace.error()));
    keeps.trace.emplace(std::move(*trace));
  }
  settings.record = options.record;
  settings.black_box = options.black_box;
  settings.warn = log_warning;
  if (options.record.empty() && settings.memory == nullptr) return keeps;
  auto recorder = RunRecorder::create(std::move(settings), steps);
  if (!recorder) return tl::make_unexpected(std::move(recorder.error()));
  keeps.recorder.emplace(std::move(*recorder));
  return keeps;
}

/// Null if no black box is asked for.
Result<std::unique_ptr<BlackBoxMemory>> make_black_box(const RunOptions& options) {
  if (options.black_box.empty()) return std::unique_ptr<BlackBoxMemory>();
  const std::size_t devices = std::max<std::size_t>(1, options.devices.size());
  return BlackBoxMemory::make(
      BlackBoxMemory::bytes_for(devices, options.rate_hz, BlackBox::kept_seconds));
}

/// Runs the loop in a thread of its own, while this thread takes its records and does `meanwhile`.
Result<RealtimeState> drive(Loop& loop, Collector& collector, const RunOptions& options,
                            StopSignals& signals, const std::function<void()>& meanwhile) {
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
    meanwhile();
  }
  thread.join();
  collector.drain();
  return realtime;
}

AppNames names_of(const ServedScene& scene, const std::vector<Device*>& devices) {
  const ForceChoice& choice = scene.choice;
  AppNames names;
  for (const Device* device : devices) {
    const DeviceProfile* const profile = device->capabilities().profile;
    const double scale = choice.scene.workspace.scale;
    names.devices.push_back(device->capabilities().name);
    names.bare_borders.push_back(
        profile != nullptr ? margin_below_border(*profile) / stiffness_margin / scale : 0);
    names.stabilized_borders.push_back(profile != nullptr ? served_border(*profile) / scale : 0);
  }
  names.assets = choice.assets;
  for (const std::string& asset : choice.assets) {
    std::error_code unknown;
    names.asset_paths.push_back(std::filesystem::absolute(asset, unknown).string());
  }
  for (std::size_t i = 0; i < scene.ids.size(); ++i) {
    const std::string& asset = choice.assets[choice.scene.objects[i].asset];
    names.objects.resize(std::max<std::size_t>(names.objects.size(), scene.ids[i] + 1));
    names.objects[scene.ids[i]] = std::filesystem::path(asset).filename().string();
  }
  return names;
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
    for (const std::string& text : stiffness_warnings(scene.choice, devices)) log_warning(text);
  };
  return std::make_unique<SceneKeeper>(std::move(keeper), assets);
}

/// A device that gives no force needs no switch. Errors: usage, for a device without that button.
Result<void> check_enable_switch(const RunOptions& options, const DeviceCapabilities& device) {
  if (device.force_cap <= 0 || options.enable_button <= device.buttons) return {};
  const std::string has = device.buttons == 0   ? "no buttons"
                          : device.buttons == 1 ? "button 1 alone"
                                                : fmt::format("buttons 1 to {}", device.buttons);
  return fail(ExitCode::usage,
              fmt::format("--enable-switch button:{}: {} has {}, so that it would never give "
                          "force: name another button, or leave the option away",
                          options.enable_button, device.name, has));
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
  for (const auto& device : devices) {
    const DeviceSetup setup{options.rate_hz, options.realtime,
                            scene_of_hand(choice.scene, open.size()), views};
    if (auto opened = device->open(setup); !opened) {
      return tl::make_unexpected(std::move(opened.error()));
    }
    if (auto fit = check_enable_switch(options, device->capabilities()); !fit) {
      return tl::make_unexpected(std::move(fit.error()));
    }
    open.push_back(device.get());
  }
  if (supervisor != nullptr) {
    if (auto watched = name_devices(*supervisor, open); !watched) {
      return tl::make_unexpected(std::move(watched.error()));
    }
  }
  return open;
}

/// Null if no server is asked for. Also null if there is no place for its socket and no place was
/// named, because such a machine can serve forces all the same. Errors: also that another daemon
/// has the name.
Result<std::unique_ptr<AppServer>> start_server(const RunOptions& options, AppState& state) {
  if (!options.serve) return std::unique_ptr<AppServer>();
  AppServerOptions served;
  served.path = options.socket;
  served.name = options.name;
  served.group = options.app_group;
  served.warn = log_warning;
  auto started = AppServer::start(std::move(served), state);
  const bool may_do_without = !started && options.socket.empty() && !options.app_group &&
                              started.error().code == ExitCode::file_or_device;
  if (!may_do_without) return started;
  log_warning("applications cannot connect: " + started.error().message);
  return std::unique_ptr<AppServer>();
}

/// A child of this process, or one elsewhere that is asked for.
Result<std::unique_ptr<Supervisor>> start_supervisor(const RunOptions& options,
                                                     const BlackBoxMemory* box) {
  if (options.supervisor_socket.empty()) {
    return Supervisor::start(open_zero_force, options.realtime,
                             keep_black_box(box, options.black_box),
                             start_as_program(options.realtime, box, options.black_box));
  }
  if (auto there = check_outside_supervisor(options.supervisor_socket); !there) {
    return tl::make_unexpected(std::move(there.error()));
  }
  const Supervisor::StartAgain start = start_outside(options.supervisor_socket, box);
  return Supervisor::start_by(start, start);
}

}  // namespace

Result<RunReport> run(const RunOptions& asked) {
  // Made first, because it forks, and there are no threads yet. Ends last, when the devices are
  // closed.
  RunOptions options = asked;
  if (options.black_box == default_black_box()) options.black_box = default_black_box(options.name);
  const auto black_box = make_black_box(options);
  if (!black_box) return tl::make_unexpected(black_box.error());
  std::unique_ptr<Supervisor> supervisor;
  if (options.supervisor) {
    auto started = start_supervisor(options, black_box->get());
    if (!started) return tl::make_unexpected(std::move(started.error()));
    supervisor = std::move(*started);
  }
  // Before a device is touched, which the other daemon may drive.
  if (options.serve) {
    if (auto is_free = ListeningSocket::check_free(options.socket, options.name); !is_free) {
      return tl::make_unexpected(std::move(is_free.error()));
    }
  }
  // Twice: a scene names devices, and settings that it leaves out suit the device.
  options.force.device = ForceDevice{};
  auto choice = choose_forces(options.force);
  if (!choice) return tl::make_unexpected(choice.error());
  auto devices = make_devices(options, *choice);
  if (!devices) return tl::make_unexpected(std::move(devices.error()));
  options.force.device = least_stiff(force_devices(*devices));
  choice = choose_forces(options.force);
  if (!choice) return tl::make_unexpected(choice.error());
  if (auto fit = check_tool_count(choice->scene, devices->size(),
                                  place_of_tool(*choice, tools_of(choice->scene) - 1));
      !fit) {
    return tl::make_unexpected(std::move(fit.error()));
  }
  auto assets = open_assets(options, *choice, devices->size());
  if (!assets) return tl::make_unexpected(std::move(assets.error()));

  auto opened = open_devices(options, *choice, (*assets)->views(), *devices, supervisor.get());
  if (!opened) return tl::make_unexpected(std::move(opened.error()));
  const std::vector<Device*> open_devices = std::move(*opened);
  PlaceWatch places(supervisor.get(), open_devices);
  const SupervisorWatch guard_of_the_guard(supervisor.get(), log_warning);

  StepRing steps = make_step_ring();
  RunRecorder::Settings kept;
  LoopSettings settings = loop_settings(options, *choice);
  kept.header = recording_header(settings, *choice, **assets, open_devices);
  kept.scene = choice->scene;
  kept.memory = black_box->get();
  kept.assets = [&assets = **assets] { return recorded_assets(assets); };
  // Before there are files, which a signal must not leave half written.
  StopSignals signals;
  auto keeps = open_keeps(options, std::move(kept), steps);
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
  for (const std::string& text : paper_warnings(*choice)) log_warning(text);
  for (const std::string& text : stiffness_warnings(*choice, open_devices)) log_warning(text);
  for (const std::string& text : workspace_warnings(*choice, (*assets)->reports(), open_devices)) {
    log_warning(text);
  }
  for (const std::string& text : tool_warnings(*choice, (*assets)->reports(), open_devices)) {
    log_warning(text);
  }
  for (const std::string& text : tool_notes(*choice, open_devices)) log_message(text);
  log_message(start_message(options, choice->scene, (*assets)->reports(), (*assets)->paths(),
                            open_devices));
  TickRing ring = make_tick_ring(options.rate_hz, open_devices.size());
  std::unique_ptr<SceneKeeper> scene_keeper =
      make_scene_keeper(options, **assets, open_devices, **state);
  std::atomic<std::int64_t> own_beat{0};
  std::atomic<std::int64_t>& beat = supervisor ? supervisor->beat() : own_beat;
  settings.beat = &beat;
  const SleepNotice sleep;
  settings.sleeping = &sleep.sleeping();
  Loop loop(settings, open_devices, (*assets)->slots(), ring, signals.flag(), state->get(),
            scene_keeper ? &scene_keeper->edits() : nullptr);
  ChangeTeller changes(steps, choice->scene.objects.size() + AppScene::room(choice->scene));
  if (keeps->recorder) loop.tell_changes(changes);
  Collector collector(ring, open_devices.size(), options.rate_hz, std::move(*keeps), log_warning);
  (*assets)->watch();
  if (scene_keeper) scene_keeper->watch();
  const WakeupLatency latency = WakeupLatency::hold(options.realtime);
  ServiceNotice notice(beat);
  notice.ready();
  Result<RealtimeState> realtime = drive(loop, collector, options, signals, [&] {
    if (const std::string fault = places.take_fault(); !fault.empty()) log_warning(fault);
  });
  notice.stopping();
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
  report.latency_held = latency.held();
  report.latency_not_held = latency.why();
  report.force = (*assets)->choice();
  report.force.assets = (*assets)->paths();
  report.black_boxes = collector.black_boxes();
  report.assets = (*assets)->reports();
  for (std::size_t i = 0; i < open_devices.size(); ++i) {
    report.devices.push_back({open_devices[i]->capabilities(), open_devices[i]->describe(),
                              loop.device_counters(i), loop.delay(i)});
  }
  return report;
}

}  // namespace spm::servo
