// SPDX-License-Identifier: Apache-2.0
#include "servo/loop.hpp"

#include <algorithm>
#include <utility>

#include "servo/clock.hpp"
#include "servo/page_faults.hpp"

namespace spm::servo {

namespace {

/// Time from the end of the warm-up to the first tick.
constexpr std::int64_t lead_ns = 2'000'000;

constexpr int warm_up_rounds = 64;

}  // namespace

Loop::Loop(const LoopSettings& settings, std::vector<Device*> devices, AssetSlot& assets,
           TickRing& ring, const std::atomic<bool>& stop)
    : settings_(settings), assets_(assets), ring_(ring), stop_(stop) {
  for (std::size_t i = 0; i < devices.size(); ++i) {
    const double cap = devices[i]->capabilities().force_cap;
    Channel channel{devices[i],
                    SafetyStage(safety_settings(cap, settings.force.stiffness, settings.rate_hz)),
                    ContactModel({settings.force, {}, 1 / settings.rate_hz, 0}),
                    {},
                    {}};
    channel.record.device = static_cast<std::uint32_t>(i);
    channels_.push_back(channel);
  }
}

void Loop::run() noexcept {
  warm_up();
  const std::uint64_t faults_before = page_faults_of_this_thread();
  run_ticks(TickSchedule(now_ns() + lead_ns, settings_.rate_hz));
  counters_.page_faults = page_faults_of_this_thread() - faults_before;
  send_zero();
  assets_.release();
}

void Loop::run_ticks(TickSchedule schedule) noexcept {
  for (bool stopping = false; !stopping;) {
    sleep_until(schedule.due());
    const std::int64_t woke = now_ns();
    const std::int64_t wake_lateness = woke - schedule.due();
    stopping = stop_.load(std::memory_order_relaxed) ||
               (settings_.ticks > 0 && schedule.index() + 1 >= settings_.ticks);

    const ServedAsset* asset = assets_.acquire();
    take_up(asset);
    for (Channel& channel : channels_) serve(channel, asset, stopping);

    const std::int64_t finished = now_ns();
    bool touching = false;
    for (Channel& channel : channels_) {
      touching = touching || channel.record.contact;
      channel.record.tick = schedule.index();
      channel.record.wake_ns = wake_lateness;
      channel.record.busy_ns = finished - woke;
      if (!ring_.try_enqueue(channel.record)) ++counters_.unrecorded;
    }
    ++counters_.ticks;
    counters_.contact_ticks += touching ? 1 : 0;
    const std::uint64_t skipped = schedule.advance(finished);
    counters_.skipped += skipped;
    counters_.missed += skipped > 0 ? skipped + 1 : 0;
  }
}

void Loop::serve(Channel& channel, const ServedAsset* asset, bool stopping) noexcept {
  DeviceState state;
  const DeviceHealth health = channel.device->read(state);

  ForceOff cause = ForceOff::none;
  if (asset == nullptr) {
    cause = had_asset_ ? ForceOff::asset_lost : ForceOff::starting;
  } else if (asset->lost()) {
    cause = ForceOff::asset_lost;
  } else if (health != DeviceHealth::ok || channel.written != DeviceHealth::ok) {
    cause = ForceOff::device_fault;
  } else if (!state.position.allFinite()) {
    cause = ForceOff::not_a_number;
  }

  ContactForce contact;
  if (cause == ForceOff::none) {
    contact = channel.contact.next(*asset->view, state.position);
    // A page may have gone while the force was computed from it.
    if (asset->lost()) cause = ForceOff::asset_lost;
  }
  if (stopping) cause = ForceOff::stopping;
  if (cause != ForceOff::none) {
    contact = ContactForce{};
    channel.contact.reset();
  }

  const SafeForce sent = channel.safety.apply(contact.force, cause);
  channel.written = channel.device->write(Wrench{sent.force, Vector3::Zero()});

  channel.record.position = state.position;
  channel.record.force = sent.force;
  channel.record.depth = contact.depth;
  channel.record.contact = contact.contact;
  channel.record.cause = sent.cause;
  account(channel, sent);
}

void Loop::account(Channel& channel, const SafeForce& sent) noexcept {
  DeviceCounters& counters = channel.counters;
  const Vector3& position = channel.record.position;
  if (position.allFinite()) {
    if (channel.position_known) {
      counters.energy += channel.last_force.dot(position - channel.last_position);
      counters.generated_max = std::max(counters.generated_max, counters.energy);
    }
    channel.last_position = position;
    channel.position_known = true;
  }
  channel.last_force = sent.force;
  counters.contact_ticks += channel.record.contact ? 1 : 0;
  counters.cap_hits += sent.capped ? 1 : 0;
  counters.slew_hits += sent.slewed ? 1 : 0;
  counters.force_max = std::max(counters.force_max, sent.force.norm());
  if (sent.cause != ForceOff::none) ++counters.force_off[static_cast<std::size_t>(sent.cause)];
}

void Loop::take_up(const ServedAsset* asset) noexcept {
  if (asset == current_) return;
  current_ = asset;
  if (asset == nullptr) return;
  had_asset_ = true;
  for (Channel& channel : channels_) {
    channel.safety.restart();
    channel.contact.reset();
  }
}

/// Runs every function of a tick without a device, so that their code, the lazy bindings of the
/// libraries and the asset's tables are in memory before the first tick.
void Loop::warm_up() noexcept {
  for (int round = 0; round < warm_up_rounds; ++round) {
    sleep_until(now_ns());
    const ServedAsset* asset = assets_.acquire();
    for (Channel& channel : channels_) {
      if (asset == nullptr || asset->lost()) continue;
      const Extent extent = extent_of(*asset->view);
      const Vector3 point = extent.low + (round + 0.5) / warm_up_rounds * extent.size;
      const ContactForce contact = channel.contact.next(*asset->view, point);
      static_cast<void>(channel.safety.apply(contact.force, ForceOff::none));
    }
    static_cast<void>(page_faults_of_this_thread());
  }
  for (Channel& channel : channels_) {
    static_cast<void>(channel.safety.apply(Vector3::Zero(), ForceOff::starting));
    channel.contact.reset();
  }
}

void Loop::send_zero() noexcept {
  for (Channel& channel : channels_) channel.written = channel.device->write(Wrench{});
}

}  // namespace spm::servo
