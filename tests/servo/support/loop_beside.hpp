// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <catch2/catch.hpp>
#include <cmath>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "servo/loop/loop.hpp"
#include "tests/servo/support/connected_client.hpp"
#include "tests/servo/support/loop_stand_in.hpp"
#include "tests/servo/support/scripted_device.hpp"
#include "tests/servo/support/shape_asset.hpp"

namespace spm::test {

/// Half an edge of the box, m.
inline constexpr double box_half = 0.02;
/// How far the hand rests above the box, m.
inline constexpr double above = 1e-3;

/// A loop on a box of 40 mm that an application may move, a hand that rests above it, and an
/// application.
// NOLINTNEXTLINE(clang-analyzer-optin.performance.Padding): made in this order, ended in the other.
class LoopBeside {
 public:
  /// `torque_cap`: N m, of the hand's device; 0: it gives none.
  explicit LoopBeside(bool movable = true, bool acknowledge = false, double torque_cap = 0)
      : asset_(box_asset(2 * box_half)),
        tables_(tables_of(asset_)),
        served_{&tables_.view()},
        state_(*servo::AppState::create(1000, {{"hand"}, {"box"}, {"box"}})),
        server_(started(*state_, folder_.path("a.sock"))),
        device_([this](std::size_t, servo::DeviceState& state, servo::DeviceHealth& told) {
          state.position = {hand_x.load(), 0, box_half + above};
          told = health.load();
        }) {
    slot_.offer(&served_);
    device_.can().turns = torque_cap > 0;
    device_.can().torque_cap = torque_cap;
    servo::LoopSettings settings;
    settings.scene.objects.front().movable = movable;
    settings.acknowledge = acknowledge;
    loop_ = std::make_unique<servo::Loop>(settings, std::vector<servo::Device*>{&device_},
                                          std::vector<servo::AssetSlot*>{&slot_}, ring_, stop_,
                                          state_.get());
    thread_ = std::thread([this] { loop_->run(); });
    here = std::make_unique<Connected>(server_->path());
    REQUIRE(here->message.empty());
  }
  ~LoopBeside() {
    stop_.store(true);
    thread_.join();
  }
  LoopBeside(const LoopBeside&) = delete;
  LoopBeside& operator=(const LoopBeside&) = delete;

  [[nodiscard]] spm_client_device device() const {
    auto read = sized<spm_client_device>();
    static_cast<void>(spm_client_read_device(here->client, 0, &read));
    return read;
  }
  [[nodiscard]] spm_client_object object(std::uint64_t id) const {
    auto read = sized<spm_client_object>();
    static_cast<void>(spm_client_read_object(here->client, id, &read));
    return read;
  }
  /// Waits until the force along z is near a value, N. Returns false if it never is.
  [[nodiscard]] bool comes_to(double force) const {
    return eventually([&] { return std::abs(device().force[2] - force) < 0.02; });
  }
  /// Waits until a command is refused, and returns the reason.
  [[nodiscard]] std::string refusal() const {
    auto counts = sized<spm_client_command_counts>();
    const bool refused = eventually([&] {
      static_cast<void>(spm_client_refusals(here->client, &counts));
      return counts.refused > 0;
    });
    return refused ? spm_client_refusal(counts.last_refusal) : "";
  }

  [[nodiscard]] const std::string& path() const { return server_->path(); }

  /// Lets a ring that a test writes by itself, without a socket, be a client's. It must outlive
  /// this.
  void attach(const RawRing& ring) const { state_->rings().back().offer(ring.attached()); }

  /// Records of the ticks since the last call.
  [[nodiscard]] std::vector<servo::TickRecord> records() {
    std::vector<servo::TickRecord> taken;
    servo::TickRecord record;
    while (ring_.try_dequeue(record)) taken.push_back(record);
    return taken;
  }

  /// Disconnects the application. Returns the path at which another may connect.
  std::string leave() {
    here.reset();
    return server_->path();
  }

  /// Waits until the loop has taken so many commands. Returns false if it never does.
  [[nodiscard]] bool takes(std::uint64_t commands) const {
    auto counts = sized<spm_client_command_counts>();
    return eventually([&] {
      static_cast<void>(spm_client_refusals(here->client, &counts));
      return counts.taken >= commands;
    });
  }

  std::atomic<double> hand_x{0};
  std::atomic<servo::DeviceHealth> health{servo::DeviceHealth::ok};
  std::unique_ptr<Connected> here;

 private:
  SocketFolder folder_;
  Asset asset_;
  AssetTables tables_;
  servo::ServedAsset served_;
  servo::AssetSlot slot_;
  std::unique_ptr<servo::AppState> state_;
  std::unique_ptr<servo::AppServer> server_;
  ScriptedDevice device_;
  servo::TickRing ring_ = servo::make_tick_ring(1000, 1);
  std::atomic<bool> stop_{false};
  std::unique_ptr<servo::Loop> loop_;
  std::thread thread_;
};

/// A pose of the box, z metres above where it began.
[[nodiscard]] inline spm_client_pose raised(double z) {
  spm_client_pose pose = pose_at(0);
  pose.position[2] = z;
  return pose;
}

}  // namespace spm::test
