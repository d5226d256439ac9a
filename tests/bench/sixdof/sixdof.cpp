// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/sixdof/sixdof.hpp"

#include <fmt/format.h>
#include <time.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include "common/sixdof/object_contact.hpp"
#include "tests/bench/base/one_core.hpp"
#include "tests/bench/model/model.hpp"
#include "tests/bench/sixdof/exact_contact.hpp"
#include "tests/bench/sixdof/served_tool.hpp"
#include "tests/bench/sixdof/sixdof_path.hpp"
#include "tests/bench/sixdof/sixdof_peers.hpp"

namespace spm::bench {
namespace {

using Eigen::Isometry3d;

constexpr double stiffness = 1e9;  // N/m3
constexpr std::uint64_t path_samples = 8000;
constexpr double deep_share = 1.0 / 3;
constexpr double between_strokes = 1e-3;  // m
constexpr double hull_tolerance = 2e-4;   // m
constexpr std::size_t hull_planes = 64;
/// Time limit of a tick, ns, for at most `small_samples` samples and for more.
constexpr std::int64_t small_limit = 250000, large_limit = 800000;
constexpr std::uint64_t small_samples = 100000;
/// Tools with fewer samples are also run with every sample queried, without culling.
constexpr std::uint64_t samples_without_culling = 40000;

/// Number of times that each method follows the path from the start. Other load on the machine in
/// less than half of the passes does not affect the medians.
constexpr std::size_t passes = 3;

/// CPU time of this thread, s.
double busy_seconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

double quantile(std::vector<double>& values, double share) {
  if (values.empty()) return 0;
  const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
}

TickQuantiles quantiles(std::vector<double> values) {
  return {quantile(values, 0.5), quantile(values, 0.95), quantile(values, 0.99)};
}

struct Judged {
  std::size_t tick = 0;
  Wrench wrench;
};

/// Follows the path with one method after another.
class Runner {
 public:
  Runner(std::vector<Isometry3d> path, std::vector<Judged> judged, SixdofReport& report)
      : path_(std::move(path)), judged_(std::move(judged)), report_(report) {}

  /// Runs our method, with a limit in ns if it is above 0.
  void run_spm(const SurfaceSamples& tool, const AssetView& object, std::int64_t limit) {
    ObjectContactSettings settings;
    settings.stiffness = stiffness;
    std::optional<ObjectContact> contact;
    const std::array objects{ContactObject{&object, Isometry3d::Identity()}};
    SixdofRow row;
    row.method = "spm";
    row.samples = tool.levels.back().count;
    row.settings = limit > 0 ? fmt::format("{} samples, {} us", row.samples, limit / 1000)
                             : fmt::format("{} samples, no limit", row.samples);
    const auto finest = static_cast<double>(tool.levels.size() - 1);
    std::vector<Wrench> forces;
    const auto start_afresh = [&] { contact.emplace(tool, settings); };
    follow(1, row, forces, start_afresh, [&](const Isometry3d& pose) {
      const ObjectContactReport found = contact->tick(pose, objects, {limit, nullptr});
      row.tested += static_cast<double>(found.tested);
      row.asked += static_cast<double>(found.asked);
      row.contacts += static_cast<double>(found.sum.contacts);
      row.level += found.level / finest;
      row.degraded += found.degraded ? 1 : 0;
      return found.sum.forces();
    });
    judge(1, row, forces, true);
  }

  /// Runs the servo's own force law, with a limit in s if it is above 0, along a path that is the
  /// judged one or another.
  void run_served(ServedTool& tool, const std::string& method, double limit,
                  const std::vector<Isometry3d>* other = nullptr) {
    SixdofRow row;
    row.path = other != nullptr ? "deep" : "slide";
    row.method = method;
    row.samples = tool.samples();
    row.bytes = tool.bytes();
    row.settings = limit > 0 ? fmt::format("{} samples, {:.0f} us", row.samples, 1e6 * limit)
                             : fmt::format("{} samples, no limit", row.samples);
    const double finest = std::max(1.0, static_cast<double>(tool.levels()) - 1);
    std::vector<Wrench> wrenches;
    Isometry3d before = Isometry3d::Identity();
    follow(
        1, row, wrenches, [&tool] { tool.begin(); },
        [&](const Isometry3d& pose) {
          // No hand goes from the end of a stroke to the next in a tick.
          if ((pose.translation() - before.translation()).norm() > between_strokes) tool.begin();
          before = pose;
          const Wrench found = tool.ask(pose);
          row.contacts += static_cast<double>(tool.patches());
          row.level += 1 - tool.effort().level / finest;
          row.degraded += tool.effort().degraded() ? 1 : 0;
          return found;
        },
        other != nullptr ? *other : path_);
    if (other != nullptr) {
      report_.rows.push_back(row);
    } else {
      judge(1, row, wrenches, method == "served-spm");
    }
  }

  void run_peer(Peer& peer, std::uint64_t ticks) {
    SixdofRow row;
    row.method = peer.name();
    row.settings = peer.settings();
    row.samples = peer.samples();
    const std::size_t stride = std::max<std::size_t>(1, path_.size() / ticks);
    std::vector<Wrench> forces;
    // Peers have no state to reset.
    follow(
        stride, row, forces, [] {},
        [&](const Isometry3d& pose) {
          const PeerAnswer found = peer.ask(pose);
          row.contacts += static_cast<double>(found.contacts);
          return Wrench{found.force, Vector3::Zero()};
        });
    row.level = 1;
    judge(stride, row, forces, peer.same_law());
  }

 private:
  std::vector<Isometry3d> path_;
  std::vector<Judged> judged_;
  SixdofReport& report_;

  template <class Begin, class Ask>
  void follow(std::size_t stride, SixdofRow& row, std::vector<Wrench>& forces, const Begin& begin,
              const Ask& ask) {
    follow(stride, row, forces, begin, ask, path_);
  }

  template <class Begin, class Ask>
  void follow(std::size_t stride, SixdofRow& row, std::vector<Wrench>& forces, const Begin& begin,
              const Ask& ask, const std::vector<Isometry3d>& path) {
    std::vector<double> middles, tails, busy_tails;
    const OneCore pinned;
    for (std::size_t pass = 0; pass < passes; ++pass) {
      std::vector<double> times, busy;
      forces.clear();
      begin();
      for (std::size_t tick = 0; tick < path.size(); tick += stride) {
        const double before = busy_seconds();
        const Clock::time_point start = Clock::now();
        forces.push_back(ask(path[tick]));
        times.push_back(seconds_since(start));
        busy.push_back(busy_seconds() - before);
      }
      for (const double time : times) row.mean += time;
      row.max = std::max(row.max, *std::max_element(times.begin(), times.end()));
      middles.push_back(quantile(times, 0.5));
      tails.push_back(quantile(times, 0.99));
      busy_tails.push_back(quantile(busy, 0.99));
    }
    row.p50 = quantile(middles, 0.5);
    row.p99 = quantile(tails, 0.5);
    row.busy_p99 = quantile(busy_tails, 0.5);
    const auto count = static_cast<double>(forces.size() * passes);
    for (double* sum :
         {&row.mean, &row.tested, &row.asked, &row.contacts, &row.level, &row.degraded})
      *sum /= count;
  }

  void judge(std::size_t stride, SixdofRow& row, const std::vector<Wrench>& wrenches,
             bool same_law) {
    std::vector<double> errors, torque_errors, angles;
    for (const Judged& judged : judged_) {
      const Wrench& found = wrenches[judged.tick / stride];
      const Wrench& wanted = judged.wrench;
      if (judged.tick % stride != 0) continue;
      errors.push_back((found.force - wanted.force).norm() / wanted.force.norm());
      torque_errors.push_back((found.torque - wanted.torque).norm() / wanted.torque.norm());
      angles.push_back(
          std::atan2(found.force.cross(wanted.force).norm(), found.force.dot(wanted.force)));
    }
    if (same_law) row.force_error = quantiles(errors);
    // Peers tell no torque.
    if (same_law && row.method != "every-sample") row.torque_error = quantiles(torque_errors);
    row.direction_error = quantiles(angles);
    report_.rows.push_back(row);
  }
};

std::vector<Judged> references(const SixdofPlan& plan, const std::vector<Isometry3d>& path,
                               const BakedObject& tool, const BakedObject& object,
                               SixdofReport& report) {
  report.reference_radius = plan.reference_radius;
  // Use only ticks at which the peers are queried as well.
  const std::size_t peers = std::max<std::size_t>(1, path.size() / plan.peer_ticks);
  const std::size_t stride =
      peers *
      std::max<std::size_t>(1, path.size() / peers / std::max<std::uint64_t>(1, plan.judged));
  std::vector<Judged> judged;
  for (std::size_t tick = 0; tick < path.size(); tick += stride) {
    const Wrench wrench = exact_wrench(tool, object, path[tick], stiffness, plan.reference_radius);
    if (wrench.force.norm() > 0) judged.push_back({tick, wrench});
  }
  report.judged = judged.size();
  return judged;
}

}  // namespace

SixdofReport measure_sixdof(const SixdofPlan& plan, const BenchProgress& progress) {
  const auto told = [&progress](const std::string& what, double done) {
    if (progress) progress(what, done);
  };
  SixdofReport report;
  told("baking the tool", 0);
  const BakedObject tool(plan.tool, tool_diagonal, plan.tool_tolerance);
  told("baking the object", 0.05);
  const BakedObject object(plan.object, bench_diagonal, plan.tolerance);
  report.tool = tool.name;
  report.object = object.name;
  report.tool_triangles = tool.mesh.triangles.size();
  report.object_triangles = object.mesh.triangles.size();
  told("making the path", 0.25);
  PathPlan path_plan;
  path_plan.ticks = plan.ticks;
  path_plan.seed = plan.seed;
  const std::vector<Isometry3d> path =
      press_and_slide(samples_of_count(tool.view(), path_samples), object.view(),
                      samples_of_count(object.view(), path_samples), path_plan);
  report.ticks = path.size();
  told("exact forces", 0.35);
  const std::vector<Isometry3d> deep =
      pressed_in(path, samples_of_count(tool.view(), path_samples), object.view(), deep_share);
  Runner runner(path, references(plan, path, tool, object, report), report);
  for (const std::uint64_t count : plan.samples) {
    told(fmt::format("{} samples", count), 0.6);
    const SurfaceSamples samples = samples_of_count(tool.view(), count);
    runner.run_spm(samples, object.view(), 0);
    runner.run_spm(samples, object.view(), count <= small_samples ? small_limit : large_limit);
    for (const Method method : {Method::spm, Method::proxy}) {
      const double limit =
          1e-9 * static_cast<double>(count <= small_samples ? small_limit : large_limit);
      const std::string name = method == Method::spm ? "served-spm" : "served-proxy";
      for (const double most : {0.0, limit}) {
        ServedTool served(tool, object, samples.levels.back().spacing, method, stiffness, most);
        runner.run_served(served, name, most);
        // A tool that is held back is never deep.
        if (most == 0 && method == Method::spm) runner.run_served(served, name, most, &deep);
      }
    }
    if (count < samples_without_culling) {
      runner.run_peer(*make_every_sample(samples, object.view(), stiffness), plan.peer_ticks);
    }
  }
  told("FCL", 0.9);
  runner.run_peer(*make_fcl(tool, object), plan.peer_ticks);
  told("Bullet", 0.95);
  runner.run_peer(*make_bullet(tool, object), plan.peer_ticks);
  told("culling", 0.98);
  const SupportHull hull =
      support_hull(samples_of_count(tool.view(), path_samples), hull_tolerance, hull_planes);
  report.hull_points = hull.points.size();
  report.culling = measure_culling(hull, plan.culled_objects, plan.seed);
  return report;
}

}  // namespace spm::bench
