// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/sixdof/sixdof_judge.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>
#include <thread>
#include <utility>

#include "tests/bench/sixdof/exact_contact.hpp"
#include "tests/bench/sixdof/sixdof_peers.hpp"

namespace spm::bench {
namespace {

/// Calls for each number below `count`, on all cores.
void for_each_number(std::size_t count, const std::function<void(std::size_t)>& call) {
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    for (std::size_t i = next++; i < count; i = next++) call(i);
  };
  std::vector<std::jthread> threads;
  for (unsigned k = 1; k < std::thread::hardware_concurrency(); ++k) threads.emplace_back(work);
  work();
}

TickQuantiles quantiles(std::vector<double> values) {
  return {quantile_of_ticks(values, 0.5), quantile_of_ticks(values, 0.95),
          quantile_of_ticks(values, 0.99)};
}

}  // namespace

double quantile_of_ticks(std::vector<double>& values, double share) {
  if (values.empty()) return 0;
  const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
}

JudgedPath judged_path(std::string name, std::vector<Eigen::Isometry3d> poses,
                       const SixdofPlan& plan, std::uint64_t judged, const BakedObject& tool,
                       const BakedObject& object, double stiffness) {
  JudgedPath path{std::move(name), std::move(poses), {}, {}};
  // Use only ticks at which the peers are queried as well.
  const std::size_t peers = std::max<std::size_t>(1, path.poses.size() / plan.peer_ticks);
  const std::size_t stride =
      peers *
      std::max<std::size_t>(1, path.poses.size() / peers / std::max<std::uint64_t>(1, judged));
  std::vector<Wrench> all((path.poses.size() + stride - 1) / stride);
  for_each_number(all.size(), [&](std::size_t i) {
    all[i] = exact_wrench(tool, object, path.poses[i * stride], stiffness, plan.reference_radius);
  });
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!(all[i].force.norm() > 0)) continue;
    path.ticks.push_back(i * stride);
    path.exact.push_back(all[i]);
  }
  return path;
}

std::vector<Wrench> finest_level(const JudgedPath& path, const SurfaceSamples& tool,
                                 const AssetView& object, double stiffness) {
  std::vector<Wrench> made(path.ticks.size());
  for_each_number(made.size(), [&](std::size_t i) {
    const PeerAnswer found = press_every_sample(tool, object, path.poses[path.ticks[i]], stiffness);
    made[i] = {found.force, *found.torque};
  });
  return made;
}

WrenchErrors wrench_errors(const std::vector<Wrench>& found, const std::vector<Wrench>& wanted,
                           bool any_size) {
  std::vector<double> forces, torques, angles;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const Wrench& got = found[i];
    Wrench asked = wanted[i];
    // Where the samples miss the contact there is nothing to compare with.
    if (!(asked.force.norm() > 0)) continue;
    if (any_size) {
      const double size = got.force.norm() / asked.force.norm();
      if (!(size > 0)) continue;
      asked = {size * asked.force, size * asked.torque};
    }
    forces.push_back((got.force - asked.force).norm() / asked.force.norm());
    torques.push_back((got.torque - asked.torque).norm() / asked.torque.norm());
    angles.push_back(std::atan2(got.force.cross(asked.force).norm(), got.force.dot(asked.force)));
  }
  return {quantiles(forces), quantiles(torques), quantiles(angles)};
}

}  // namespace spm::bench
