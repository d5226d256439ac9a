// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/sixdof/sixdof.hpp"

#include <fmt/format.h>
#include <time.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <utility>

#include "common/sixdof/object_contact.hpp"
#include "tests/bench/base/one_core.hpp"
#include "tests/bench/model/model.hpp"
#include "tests/bench/sixdof/served_tool.hpp"
#include "tests/bench/sixdof/sixdof_judge.hpp"
#include "tests/bench/sixdof/sixdof_path.hpp"
#include "tests/bench/sixdof/sixdof_peers.hpp"

namespace spm::bench {
namespace {

using Eigen::Isometry3d;

constexpr double stiffness = 1e9;  // N/m3
constexpr std::uint64_t path_samples = 8000;
constexpr double deep_share = 1.0 / 3;
constexpr double between_strokes = 1e-3;  // m
/// Time limit of a tick, ns, for at most `small_samples` samples and for more.
constexpr std::int64_t small_limit = 250000, large_limit = 800000;
constexpr std::uint64_t small_samples = 100000;
/// Tools with fewer samples are also run with every sample queried, without culling.
constexpr std::uint64_t samples_without_culling = 40000;

/// Number of times that each method follows the path from the start. Other load on the machine in
/// less than half of the passes does not affect the medians.
constexpr std::size_t passes = 5;

/// CPU time of this thread, s.
double busy_seconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// A method with one setting that is to follow a path.
struct Contestant {
  SixdofRow row;
  const JudgedPath* path = nullptr;
  std::size_t stride = 1;  ///< of the path's ticks, those that it computes
  bool same_law = false;   ///< its forces, and not only their directions, are judged
  bool tells_torque = true;
  const SurfaceSamples* finest = nullptr;  ///< whose finest level it is compared with as well
  std::function<void()> begin = [] {};
  /// Before a tick, and not part of it.
  std::function<void(const Isometry3d&)> prepare = [](const Isometry3d&) {};
  /// Adds to the row's counts.
  std::function<Wrench(const Isometry3d&, SixdofRow&)> ask;
  std::vector<Wrench> wrenches{};
  std::vector<double> middles{}, tails{}, busy_tails{};  ///< s, of each pass
};

/// Lets methods follow the path in turns, pass by pass, so that a machine that is slower for a
/// while is so for all.
class Runner {
 public:
  Runner(const JudgedPath& path, const JudgedPath& deep, const AssetView& object)
      : path_(path), deep_(deep), object_(object) {}

  /// Adds our method, with a limit in ns if it is above 0.
  void add_spm(const SurfaceSamples& tool, std::int64_t limit) {
    ObjectContactSettings settings;
    settings.stiffness = stiffness;
    const auto contact = std::make_shared<std::optional<ObjectContact>>();
    Contestant made;
    made.row.method = "spm";
    made.row.samples = tool.levels.back().count;
    made.row.settings = limit > 0 ? fmt::format("{} samples, {} us", made.row.samples, limit / 1000)
                                  : fmt::format("{} samples, no limit", made.row.samples);
    made.path = &path_;
    made.same_law = true;
    made.finest = &tool;
    made.begin = [contact, &tool, settings] { contact->emplace(tool, settings); };
    made.ask = [contact, &object = object_, limit,
                finest = static_cast<double>(tool.levels.size() - 1)](const Isometry3d& pose,
                                                                      SixdofRow& row) {
      const std::array objects{ContactObject{&object, Isometry3d::Identity()}};
      const ObjectContactReport found = (*contact)->tick(pose, objects, {limit, nullptr});
      row.tested += static_cast<double>(found.tested);
      row.asked += static_cast<double>(found.asked);
      row.contacts += static_cast<double>(found.sum.contacts);
      row.level += found.level / finest;
      row.degraded += found.degraded ? 1 : 0;
      return found.sum.forces();
    };
    contestants_.push_back(std::move(made));
  }

  /// Adds the servo's own force law, with a limit in s if it is above 0.
  void add_served(const std::shared_ptr<ServedTool>& tool, const SurfaceSamples& samples,
                  const std::string& method, double limit, bool deep = false) {
    Contestant made;
    made.path = deep ? &deep_ : &path_;
    made.row.method = method;
    made.row.samples = tool->samples();
    made.row.bytes = tool->bytes();
    made.row.settings = limit > 0
                            ? fmt::format("{} samples, {:.0f} us", made.row.samples, 1e6 * limit)
                            : fmt::format("{} samples, no limit", made.row.samples);
    made.same_law = method == "served-spm";
    made.finest = &samples;
    made.begin = [tool] { tool->begin(); };
    // No hand goes from the end of a stroke to the next in a tick.
    made.prepare = [tool,
                    before = Isometry3d(Isometry3d::Identity())](const Isometry3d& pose) mutable {
      if ((pose.translation() - before.translation()).norm() > between_strokes) tool->begin();
      before = pose;
    };
    made.ask = [tool, finest = std::max(1.0, static_cast<double>(tool->levels()) - 1)](
                   const Isometry3d& pose, SixdofRow& row) {
      Wrench found = tool->ask(pose);
      row.contacts += static_cast<double>(tool->patches());
      row.level += 1 - tool->effort().level / finest;
      row.degraded += tool->effort().degraded() ? 1 : 0;
      return found;
    };
    contestants_.push_back(std::move(made));
  }

  void add_peer(std::unique_ptr<Peer> of, std::uint64_t ticks) {
    const std::shared_ptr<Peer> peer = std::move(of);
    Contestant made;
    made.row.method = peer->name();
    made.row.settings = peer->settings();
    made.row.samples = peer->samples();
    made.path = &path_;
    made.stride = std::max<std::size_t>(1, path_.poses.size() / ticks);
    made.same_law = made.tells_torque = peer->same_law();
    // Peers have no state to reset, and no levels.
    made.ask = [peer](const Isometry3d& pose, SixdofRow& row) {
      const PeerAnswer found = peer->ask(pose);
      row.contacts += static_cast<double>(found.contacts);
      row.level += 1;
      return Wrench{found.force, found.torque.value_or(Vector3::Zero())};
    };
    contestants_.push_back(std::move(made));
  }

  /// The rows of all, in the order in which they were added.
  [[nodiscard]] std::vector<SixdofRow> run(const std::function<void(double)>& told) {
    for (std::size_t pass = 0; pass < passes; ++pass) {
      told(static_cast<double>(pass) / passes);
      for (Contestant& each : contestants_) follow(each);
    }
    std::vector<SixdofRow> rows;
    for (Contestant& each : contestants_) {
      finish(each);
      judge(each);
      rows.push_back(each.row);
    }
    return rows;
  }

 private:
  const JudgedPath &path_, &deep_;
  const AssetView& object_;
  std::vector<Contestant> contestants_;
  /// The finest levels of tools on paths.
  std::map<std::pair<const SurfaceSamples*, const JudgedPath*>, std::vector<Wrench>> finest_;

  static void follow(Contestant& each) {
    const OneCore pinned;
    std::vector<double> times, busy;
    each.wrenches.clear();
    each.begin();
    for (std::size_t tick = 0; tick < each.path->poses.size(); tick += each.stride) {
      each.prepare(each.path->poses[tick]);
      const double before = busy_seconds();
      const Clock::time_point start = Clock::now();
      each.wrenches.push_back(each.ask(each.path->poses[tick], each.row));
      times.push_back(seconds_since(start));
      busy.push_back(busy_seconds() - before);
    }
    for (const double time : times) each.row.mean += time;
    each.row.max = std::max(each.row.max, *std::max_element(times.begin(), times.end()));
    each.middles.push_back(quantile_of_ticks(times, 0.5));
    each.tails.push_back(quantile_of_ticks(times, 0.99));
    each.busy_tails.push_back(quantile_of_ticks(busy, 0.99));
  }

  static void finish(Contestant& each) {
    SixdofRow& row = each.row;
    row.p50 = quantile_of_ticks(each.middles, 0.5);
    row.p99 = quantile_of_ticks(each.tails, 0.5);
    row.busy_p99 = quantile_of_ticks(each.busy_tails, 0.5);
    const auto count = static_cast<double>(each.wrenches.size() * passes);
    for (double* sum :
         {&row.mean, &row.tested, &row.asked, &row.contacts, &row.level, &row.degraded})
      *sum /= count;
  }

  void judge(Contestant& each) {
    SixdofRow& row = each.row;
    row.path = each.path->name;
    std::vector<Wrench> found;
    for (const std::size_t tick : each.path->ticks) {
      found.push_back(each.wrenches[tick / each.stride]);
    }
    // The servo never exceeds an object's stiffness, however much of the tool presses.
    const bool bounded = each.path == &deep_;
    const WrenchErrors errors = wrench_errors(found, each.path->exact, bounded);
    row.direction_error = errors.direction;
    if (!each.same_law) return;
    row.force_error = errors.force;
    if (each.tells_torque) row.torque_error = errors.torque;
    if (each.finest == nullptr) return;
    std::vector<Wrench>& finest = finest_[{each.finest, each.path}];
    if (finest.empty()) finest = finest_level(*each.path, *each.finest, object_, stiffness);
    const WrenchErrors of_finest = wrench_errors(found, finest, bounded);
    row.finest_force_error = of_finest.force;
    row.finest_torque_error = of_finest.torque;
  }
};

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
  const SurfaceSamples few = samples_of_count(tool.view(), path_samples);
  const std::vector<Isometry3d> poses =
      press_and_slide(few, object.view(), samples_of_count(object.view(), path_samples), path_plan);
  report.ticks = poses.size();
  report.reference_radius = plan.reference_radius;
  told("exact forces", 0.3);
  const JudgedPath path = judged_path("slide", poses, plan, plan.judged, tool, object, stiffness);
  told("exact forces of deep contact", 0.4);
  const JudgedPath deep = judged_path("deep", pressed_in(poses, few, object.view(), deep_share),
                                      plan, plan.judged_deep, tool, object, stiffness);
  report.judged = path.ticks.size();
  report.judged_deep = deep.ticks.size();
  Runner runner(path, deep, object.view());
  std::vector<SurfaceSamples> samples;
  samples.reserve(plan.samples.size());
  for (const std::uint64_t count : plan.samples) {
    const SurfaceSamples& made = samples.emplace_back(samples_of_count(tool.view(), count));
    const std::int64_t limit = count <= small_samples ? small_limit : large_limit;
    runner.add_spm(made, 0);
    runner.add_spm(made, limit);
    for (const Method method : {Method::spm, Method::proxy}) {
      const std::string name = method == Method::spm ? "served-spm" : "served-proxy";
      for (const double most : {0.0, 1e-9 * static_cast<double>(limit)}) {
        const auto served = std::make_shared<ServedTool>(tool, object, made.levels.back().spacing,
                                                         method, stiffness, most);
        runner.add_served(served, made, name, most);
        // A tool that is held back is never deep.
        if (most == 0 && method == Method::spm) runner.add_served(served, made, name, most, true);
      }
    }
    if (count < samples_without_culling) {
      runner.add_peer(make_every_sample(made, object.view(), stiffness), plan.peer_ticks);
    }
  }
  runner.add_peer(make_fcl(tool, object), plan.peer_ticks);
  runner.add_peer(make_bullet(tool, object), plan.peer_ticks);
  report.rows = runner.run([&](double done) { told("all methods in turns", 0.6 + 0.38 * done); });
  told("culling", 0.98);
  report.culling = measure_culling(tool.view(), few, plan.culled_objects, plan.seed);
  return report;
}

}  // namespace spm::bench
