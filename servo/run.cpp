// SPDX-License-Identifier: Apache-2.0
#include "servo/run.hpp"

#include <spdlog/spdlog.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <future>
#include <memory>
#include <optional>
#include <thread>
#include <utility>

#include "servo/collector.hpp"
#include "servo/device_list.hpp"
#include "servo/force_choice.hpp"
#include "servo/stop_signals.hpp"

namespace spm::servo {

namespace {

constexpr std::chrono::milliseconds drain_interval{4};

void log_warning(const std::string& message) { spdlog::warn("{}", message); }

Result<std::vector<std::unique_ptr<Device>>> make_devices(const RunOptions& options) {
  std::vector<std::unique_ptr<Device>> devices;
  for (const std::string& specification : options.devices) {
    auto device = make_device(specification);
    if (!device) return tl::make_unexpected(std::move(device.error()));
    devices.push_back(std::move(*device));
  }
  return devices;
}

Result<std::unique_ptr<AssetKeeper>> open_asset(const RunOptions& options, AssetSlot& slot) {
  KeeperOptions keeper;
  keeper.path = options.asset;
  keeper.mode = options.map;
  keeper.lock = options.realtime != RealtimeMode::off;
  keeper.warn = log_warning;
  keeper.accept = [&options](const AssetMetadata& metadata) {
    return check_asset(metadata, options.force, options.asset);
  };
  return AssetKeeper::open(std::move(keeper), slot);
}

Result<std::optional<TraceCsv>> open_trace(const std::string& path) {
  if (path.empty()) return std::optional<TraceCsv>();
  Result<TraceCsv> trace = TraceCsv::create(path);
  if (!trace) return tl::make_unexpected(std::move(trace.error()));
  return std::optional<TraceCsv>(std::move(*trace));
}

/// Runs the loop in a thread of its own while this one takes its records.
Result<RealtimeState> drive(Loop& loop, Collector& collector, RealtimeMode mode,
                            StopSignals& signals) {
  std::promise<Result<RealtimeState>> entered;
  std::atomic<bool> done{false};
  std::thread thread([&] {
    Result<RealtimeState> realtime = enter_realtime(mode);
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

LoopSettings loop_settings(const RunOptions& options) {
  LoopSettings settings;
  settings.rate_hz = options.rate_hz;
  settings.force = options.force;
  if (options.duration > 0) {
    settings.ticks = std::max<std::uint64_t>(
        1, static_cast<std::uint64_t>(std::llround(options.duration * options.rate_hz)));
  }
  return settings;
}

}  // namespace

Result<RunReport> run(const RunOptions& options) {
  if (auto checked = check_settings(options.force); !checked) {
    return tl::make_unexpected(std::move(checked.error()));
  }
  auto devices = make_devices(options);
  if (!devices) return tl::make_unexpected(std::move(devices.error()));
  AssetSlot slot;
  auto keeper = open_asset(options, slot);
  if (!keeper) return tl::make_unexpected(std::move(keeper.error()));
  auto trace = open_trace(options.trace);
  if (!trace) return tl::make_unexpected(std::move(trace.error()));

  std::vector<Device*> open_devices;
  for (const auto& device : *devices) {
    const DeviceSetup setup{options.rate_hz, options.force, &(*keeper)->view()};
    if (auto opened = device->open(setup); !opened) {
      return tl::make_unexpected(std::move(opened.error()));
    }
    open_devices.push_back(device.get());
  }

  StopSignals signals;
  TickRing ring = make_tick_ring(options.rate_hz, open_devices.size());
  Loop loop(loop_settings(options), open_devices, slot, ring, signals.flag());
  Collector collector(ring, open_devices.size(), options.rate_hz, std::move(*trace), log_warning);
  (*keeper)->watch();
  Result<RealtimeState> realtime = drive(loop, collector, options.realtime, signals);
  if (!realtime) return tl::make_unexpected(std::move(realtime.error()));
  if (auto written = collector.finish(); !written) {
    return tl::make_unexpected(std::move(written.error()));
  }

  RunReport report;
  report.options = options;
  report.counters = loop.counters();
  report.wake_us = collector.wake_us();
  report.busy_us = collector.busy_us();
  report.realtime = std::move(*realtime);
  report.asset = (*keeper)->report();
  for (std::size_t i = 0; i < open_devices.size(); ++i) {
    report.devices.push_back(
        {open_devices[i]->capabilities(), open_devices[i]->describe(), loop.device_counters(i)});
  }
  return report;
}

}  // namespace spm::servo
