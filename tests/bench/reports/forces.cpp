// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/reports/forces.hpp"

#include <fmt/format.h>

#include <memory>
#include <utility>

#include "baker/base/bake_error.hpp"
#include "baker/mesh/load.hpp"
#include "formats/asset/mapped_asset.hpp"
#include "servo/force/contact_model.hpp"
#include "tests/bench/base/temporary_folder.hpp"
#include "tests/bench/base/thread_limit.hpp"
#include "tests/bench/base/unwrap.hpp"
#include "tests/bench/model/baked_file.hpp"
#include "tests/bench/model/paper_maps.hpp"

namespace spm::bench {
namespace {

/// The bench has a `Method` of its own.
using ForceMethod = ::spm::Method;

/// The loop's own forces along a path; what remembers begins anew where the path does.
std::vector<Vector3> forces_along(const SlidePath& path, const AssetView& asset,
                                  const ContactSettings& contact) {
  ContactModel model(contact);
  std::vector<Vector3> forces;
  forces.reserve(path.points.size());
  for (std::size_t i = 0; i < path.points.size(); ++i) {
    if (path.ticks[i].fresh) model.reset();
    forces.push_back(model.next(asset, path.points[i]).force);
  }
  return forces;
}

/// All methods on one model.
class Course {
 public:
  Course(const ForceSource& source, const ForcesPlan& plan, const BenchProgress& progress,
         double done, ForcesReport& report)
      : source_(source), plan_(plan), progress_(progress), done_(done), report_(report) {}

  void measure() {
    tell("loading");
    const Model model(source_.model, baker::load_mesh(source_.model.path, {1, bench_diagonal}));
    tell("paths");
    std::vector<SlidePath> paths;
    if (!source_.trajectory.empty()) {
      paths.push_back(recorded_slide(model, source_.trajectory, plan_.max_ticks));
    }
    paths.push_back(walked_slide(model, plan_.depth, plan_.walked_ticks, plan_.seed));
    first_ = report_.traces.size();
    for (SlidePath& path : paths) {
      add_path(path, 0);
      add_path(path, plan_.probe_radius);
      report_.traces.push_back({source_.model.name, std::move(path), {}});
    }
    add_paper(model);
    add_ours(model);
  }

 private:
  void tell(const char* what) const {
    if (progress_) progress_(source_.model.name + ": " + what, done_);
  }

  void add_path(const SlidePath& path, double radius) {
    PathRow row;
    row.model = source_.model.name;
    row.path = path.name;
    row.radius = radius;
    row.ticks = path.ticks.size();
    row.judged = count_judged(path.ticks, bench_band.max_depth, radius);
    std::vector<Vector3> exact;
    for (const ExactTick& tick : path.ticks) {
      exact.push_back(exact_penalty(tick, plan_.stiffness, radius));
    }
    const ForceErrors errors = force_errors(path.ticks, exact, rules(radius));
    row.exact_step = errors.step;
    row.exact_rough = errors.step.count - errors.excess.count;
    report_.paths.push_back(std::move(row));
  }

  void add_paper(const Model& model) {
    tell("paper");
    const PaperMaps maps(model.mesh, model.caster, source_.planes, plan_.paper_resolution);
    add(maps.view(), ForceMethod::paper, "paper", maps.settings(), 0);
  }

  void add_ours(const Model& model) {
    tell("spm");
    try {
      const SparseOptions options{model.band, model.tolerance, plan_.probe_radius};
      const TemporaryFolder folder;
      const BakedFile file = bake_sparse(model.mesh, options, folder.path());
      const std::unique_ptr<MappedAsset> asset = unwrap(MappedAsset::open(file.path));
      tell("forces");
      add(asset->view(), ForceMethod::spm, "spm", file.settings, 0);
      add(asset->view(), ForceMethod::spm, "spm", file.settings, 0, plan_.turn_rate);
      add(asset->view(), ForceMethod::proxy, "proxy", file.settings, 0);
      add(asset->view(), ForceMethod::proxy, "proxy", file.settings, plan_.probe_radius);
    } catch (const baker::BakeError& error) {
      report_.failures.push_back({source_.model.name, "spm", error.what()});
    }
  }

  /// One method on all paths of the model.
  void add(const AssetView& asset, ForceMethod method, const char* name, std::string settings,
           double radius, double turn_rate = 0) {
    ContactSettings contact;
    contact.force.method = method;
    contact.force.stiffness = plan_.stiffness;
    contact.force.probe_radius = radius;
    contact.effects.turn.rate = turn_rate;
    if (turn_rate > 0) settings += fmt::format(", turns of {:g} rad/s", turn_rate);
    for (std::size_t i = first_; i < report_.traces.size(); ++i) {
      ForceTrace& trace = report_.traces[i];
      std::vector<Vector3> forces = forces_along(trace.path, asset, contact);
      report_.rows.push_back({source_.model.name, trace.path.name, name, settings, radius,
                              turn_rate, force_errors(trace.path.ticks, forces, rules(radius))});
      trace.series.push_back({name, radius, turn_rate, std::move(forces)});
    }
  }

  [[nodiscard]] ForceRules rules(double radius) const {
    return {plan_.stiffness, radius, bench_band.max_depth, source_.model.tolerance};
  }

  const ForceSource& source_;
  const ForcesPlan& plan_;
  const BenchProgress& progress_;
  double done_;
  ForcesReport& report_;
  std::size_t first_ = 0;  ///< of the report's traces those of this model
};

}  // namespace

ForcesReport measure_forces(const ForcesPlan& plan, const BenchProgress& progress) {
  const tbb::global_control limit = thread_limit(plan.threads);
  ForcesReport report;
  for (std::size_t i = 0; i < plan.sources.size(); ++i) {
    const double done = static_cast<double>(i) / static_cast<double>(plan.sources.size());
    Course(plan.sources[i], plan, progress, done, report).measure();
  }
  return report;
}

}  // namespace spm::bench
