// SPDX-License-Identifier: Apache-2.0
#include "tests/servo/support/command_streams.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <deque>
#include <memory>
#include <numbers>

#include "common/base/random.hpp"
#include "servo/loop/loop.hpp"
#include "tests/servo/support/loop_stand_in.hpp"
#include "tests/servo/support/scripted_device.hpp"
#include "tests/servo/support/shape_asset.hpp"

namespace spm::test {

namespace {

constexpr double tick = 1e-3;            // s
constexpr double half = 0.02;            // m, of the box
constexpr double stiffness = 2000;       // N/m, of what is touched at first
constexpr double free_seconds = 0.2;     // the hand begins outside
constexpr double settled_seconds = 0.8;  // when a hand that keeps still has gone in
constexpr double window = 0.5;           // s
constexpr double deepest = 1.4e-3;       // m
constexpr double device_cap = 8;         // N

/// A box in the middle, which is touched, and one half a metre away.
servo::LoopSettings settings_of(bool stabilized) {
  servo::LoopSettings settings;
  // Every tick has time for all objects.
  settings.clock = []() noexcept { return std::int64_t{0}; };
  PlacedObject here = default_object(stiffness, {});
  here.movable = true;
  PlacedObject far = here;
  far.placement.position = {0.5, 0, 0};
  settings.scene.objects = {here, far};
  settings.scene.added = here;
  if (stabilized) settings.scene.stabilization = default_stabilization;
  return settings;
}

/// The box for all streams; it is never written.
const AssetTables& box_tables() {
  static const Asset asset = shape_asset(box({2 * half, 2 * half, 2 * half}));
  static const AssetTables tables = tables_of(asset);
  return tables;
}

/// Where the hand is at a time: it presses the box's upper face, and slides on it.
class Way {
 public:
  explicit Way(const CommandStream& stream) : still_(stream.still) {
    Random random(stream.seed * 2 + 1);
    presses_ = random.between(0.7, 4);
    depth_ = random.between(0.5e-3, deepest);
    slides_ = random.between(0.1, 1);
    phase_ = random.between(0, 2 * std::numbers::pi);
  }
  [[nodiscard]] double depth_at(double time) const {
    const double since = time - free_seconds;
    if (since <= 0) return -1e-3;
    // The still hand goes in once, and stays.
    const double turn = still_ ? std::min(0.5, since) : presses_ * since;
    return -1e-3 + (1e-3 + depth_) * 0.5 * (1 - std::cos(2 * std::numbers::pi * turn));
  }
  [[nodiscard]] Vector3 at(double time) const {
    const double slide =
        still_ ? 0 : 5e-3 * std::sin(2 * std::numbers::pi * slides_ * time + phase_);
    return {slide, 0, half - depth_at(time)};
  }

 private:
  bool still_;
  double presses_ = 1, depth_ = 1e-3, slides_ = 0.5, phase_ = 0;
};

/// J: the energy of a spring that is pressed by `depth`, m, at that stiffness under a cap, N.
double energy_of(double depth, double stiff, double cap) {
  if (!(depth > 0)) return 0;
  const double most = cap / stiff;
  return depth < most ? 0.5 * stiff * depth * depth : cap * depth - 0.5 * cap * most;
}

/// The commands of one stream, and what they allow.
class Application {
 public:
  explicit Application(const CommandStream& stream, RawRing& ring)
      : stream_(stream), ring_(ring), random_(stream.seed * 2 + 2) {}

  /// Sends what is due next. `deep`: m, the deepest that the hand is in the time that follows.
  void send(double deep) {
    ++count_;
    switch (stream_.kind) {
      case StreamKind::same_far:
        return material(1, stiffness, 0, deep);
      case StreamKind::same_touched:
        return material(0, stiffness, 0, deep);
      case StreamKind::material:
        return material(0, random_.between(300, 2700), random_.between(0, 0.8), deep);
      case StreamKind::texture:
        return texture(deep);
      case StreamKind::added_far:
        return add({0.5, 0.5, 0}, 0);
      case StreamKind::added_here:
        return add(Vector3::Zero(), deep);
      case StreamKind::method:
        return method();
      case StreamKind::stabilizers:
        return write(SPM_COMMAND_STABILIZE, [&](auto& to) { to.on = count_ % 2; });
      case StreamKind::cap:
        return cap(random_.between(0.5, 8), deep);
      case StreamKind::same_cap:
        return cap(count_ % 2 != 0 ? 7.8 : 8.0, deep);
      case StreamKind::spring:
        return spring();
      case StreamKind::detents:
        return detents();
      case StreamKind::push:
        return write(SPM_COMMAND_PUSH, [&](auto& to) {
          to.hold = 0.05;
          to.force[1] = random_.between(-3, 3);
        });
      case StreamKind::placed:
        return place(deep);
      case StreamKind::clutch:
        return write(SPM_COMMAND_CLUTCH, [&](auto& to) { to.on = count_ % 2; });
    }
  }
  [[nodiscard]] double allowed() const { return allowed_; }

 private:
  template <class Fill>
  void write(std::uint32_t kind, const Fill& fill) {
    spm_shared_command command = move_command(0, 0);
    command.kind = kind;
    command.index = 0;
    fill(command);
    ring_.write(command);
  }
  void material(std::uint64_t object, double stiff, double friction, double deep) {
    if (object == 0) {
      allowed_ += std::max(
          0.0, energy_of(deep, stiff, device_cap) - energy_of(deep, stiffness_, device_cap));
      stiffness_ = stiff;
    }
    write(SPM_COMMAND_MATERIAL, [&](auto& to) {
      to.object = object;
      to.fields = SPM_MATERIAL_STIFFNESS | SPM_MATERIAL_FRICTION | SPM_MATERIAL_DAMPING;
      to.stiffness = stiff;
      to.friction_stick = to.friction_slide = friction;
      to.damping = friction;
    });
  }
  /// A height more or less than 50 um, wherever the hand is.
  void texture(double deep) {
    const double most = deep > 0 ? stiffness * 1e-4 * (deep + 1e-4) : 0;
    allowed_ += most;
    write(SPM_COMMAND_MATERIAL, [&](auto& to) {
      to.fields = SPM_MATERIAL_TEXTURE;
      to.texture_amplitude = random_.between(0, 5e-5);
      to.texture_wavelength = 2e-3;
      to.texture_seed = random_.next() % 2;
    });
  }
  void add(const Vector3& place, double deep) {
    const std::uint64_t id = (std::uint64_t{1} << 32U) | 7U;
    if (count_ % 2 == 0) return write(SPM_COMMAND_REMOVE, [&](auto& to) { to.object = id; });
    allowed_ += energy_of(deep, stiffness, device_cap);
    write(SPM_COMMAND_ADD, [&](auto& to) {
      to.object = id;
      to.scale = 1;
      to.fields = SPM_MATERIAL_STIFFNESS;
      to.stiffness = stiffness;
      std::copy_n(place.data(), 3, to.position);
    });
  }
  void place(double deep) {
    const double lowered = count_ % 2 != 0 ? 1e-3 * static_cast<double>(count_ % 5) : 0;
    allowed_ += energy_of(deep, stiffness, device_cap);
    write(SPM_COMMAND_PLACE, [&](auto& to) { to.position[2] = -lowered; });
  }
  void method() {
    write(SPM_COMMAND_METHOD, [&](auto& to) { to.index = count_ % 2 != 0 ? 0 : 2; });
  }
  void cap(double newtons, double deep) {
    allowed_ +=
        std::max(0.0, energy_of(deep, stiffness, newtons) - energy_of(deep, stiffness, cap_));
    cap_ = newtons;
    write(SPM_COMMAND_FORCE_CAP, [&](auto& to) { to.force_cap = newtons; });
  }
  /// Its point moves by up to 2 mm; it pulls with 2 N at most.
  void spring() {
    const Vector3 point(random_.between(-1e-3, 1e-3), random_.between(-1e-3, 1e-3), half);
    allowed_ += 2 * (point_ - point).norm() + (count_ == 1 ? 2 * 0.01 : 0);
    point_ = point;
    write(SPM_COMMAND_EFFECT, [&](auto& to) {
      to.effect = 1;
      to.effect_kind = SPM_EFFECT_SPRING;
      to.stiffness = 400;
      to.most_force = 2;
      std::copy_n(point.data(), 3, to.position);
    });
  }
  void detents() {
    const double stiff = random_.between(0, 400);
    allowed_ += 0.5 * std::max(0.0, stiff - detents_) * 1e-6;
    detents_ = stiff;
    write(SPM_COMMAND_EFFECT, [&](auto& to) {
      to.effect = 1;
      to.effect_kind = SPM_EFFECT_DETENTS;
      to.stiffness = stiff;
      to.most_force = 2;
      to.spacing = 2e-3;
      to.range = 0.05;
      to.axis[0] = 1;
      to.position[2] = half;
    });
  }

  CommandStream stream_;
  RawRing& ring_;
  Random random_;
  std::uint64_t count_ = 0;
  double stiffness_ = stiffness, cap_ = device_cap, detents_ = 0;
  Vector3 point_ = Vector3::Zero();
  double allowed_ = 0;
};

/// For each number of a list the largest of it and the `span` that follow.
std::vector<double> largest_ahead(const std::vector<double>& values, std::size_t span) {
  std::vector<double> largest(values.size());
  std::deque<std::size_t> kept;
  for (std::size_t i = values.size(); i-- > 0;) {
    while (!kept.empty() && values[kept.back()] <= values[i]) kept.pop_back();
    kept.push_back(i);
    if (kept.front() > i + span) kept.pop_front();
    largest[i] = values[kept.front()];
  }
  return largest;
}

}  // namespace

std::string name_of(StreamKind kind) {
  static constexpr std::array<const char*, stream_kinds> names{
      "same_far",   "same_touched", "material",    "texture", "added_far",
      "added_here", "method",       "stabilizers", "cap",     "same_cap",
      "spring",     "detents",      "push",        "clutch",  "placed"};
  return names.at(static_cast<std::size_t>(kind));
}

CommandStream stream_of(std::uint64_t number) {
  Random random(number * 2 + 77);
  CommandStream stream;
  stream.kind = static_cast<StreamKind>(number % stream_kinds);
  stream.rate_hz = 15 * std::pow(1000. / 15, random.between(0, 1));
  stream.seed = number;
  stream.stabilized = random.next() % 2 == 0;
  return stream;
}

StreamOutcome run_stream(const CommandStream& stream) {
  servo::ServedAsset served{&box_tables().view()};
  servo::AssetSlot slot;
  slot.offer(&served);
  const auto state = *servo::AppState::create(1 / tick, {{"hand"}, {"box"}, {"here", "far"}});
  RawRing ring(1);
  servo::AttachedRing attached = *ring.attached();
  attached.supervisor = true;
  state->rings()[0].offer(&attached);
  servo::TickRing records = servo::make_tick_ring(1 / tick, 1);
  const std::atomic<bool> stop{false};
  double now = 0;
  const Way way(stream);
  ScriptedDevice device(
      [&](std::size_t, servo::DeviceState& at, servo::DeviceHealth&) { at.position = way.at(now); },
      device_cap);
  servo::Loop loop(settings_of(stream.stabilized), {&device}, {&slot}, records, stop, state.get());

  const auto ticks = static_cast<std::size_t>(stream.seconds / tick);
  std::vector<double> depths(ticks);
  for (std::size_t i = 0; i < ticks; ++i) depths[i] = way.depth_at(static_cast<double>(i) * tick);
  const std::vector<double> deep = largest_ahead(depths, static_cast<std::size_t>(window / tick));

  StreamOutcome outcome;
  Application application(stream, ring);
  const double begins = stream.still ? settled_seconds : free_seconds;
  double sent = 0;
  Vector3 force = Vector3::Zero(), hand = way.at(0);
  for (std::size_t i = 0; i < ticks; ++i) {
    now = static_cast<double>(i) * tick;
    for (; now > begins && sent < (now - begins) * stream.rate_hz; ++sent) {
      application.send(deep[i]);
    }
    loop.step(i, 1'000'000'000 + static_cast<std::int64_t>(i) * 1'000'000);
    servo::TickRecord record;
    while (records.try_dequeue(record)) {
    }
    const Vector3 next = device.forces().back(), place = way.at(now);
    outcome.energy += 0.5 * (force + next).dot(place - hand);
    if (i > 0) outcome.largest_step = std::max(outcome.largest_step, (next - force).norm());
    outcome.largest_force = std::max(outcome.largest_force, next.norm());
    force = next;
    hand = place;
  }
  // What the hand has put in is there still where it ends inside.
  outcome.allowed = application.allowed();
  return outcome;
}

}  // namespace spm::test
