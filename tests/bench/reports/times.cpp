// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/reports/times.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "baker/base/bake_error.hpp"
#include "baker/mesh/load.hpp"
#include "tests/bench/base/quantile.hpp"
#include "tests/bench/base/thread_limit.hpp"
#include "tests/bench/geometry/trilinear.hpp"
#include "tests/bench/methods/contestants.hpp"
#include "tests/bench/methods/methods.hpp"
#include "tests/bench/model/bake_folder.hpp"
#include "tests/bench/model/query_sets.hpp"

namespace spm::bench {
namespace {

/// A proxy that remembers, and what its row says of it.
struct NamedProxy {
  MethodFacts facts;
  std::unique_ptr<MeshProxy> proxy;
};

NamedProxy make_named_proxy(const Model& model, const MeshProxyOptions& options) {
  const Clock::time_point start = Clock::now();
  NamedProxy named;
  named.proxy = make_mesh_proxy(FloatMesh(model.surface), options);
  named.facts.name = "mesh-proxy";
  named.facts.settings = to_string(options);
  named.facts.file_bytes = FloatMesh(model.surface).bytes();
  named.facts.resident_bytes = named.proxy->bytes();
  named.facts.open_seconds = seconds_since(start);
  return named;
}

/// A proxy says how far it is held from the tool, and nothing where it is free.
Answer answer_of(const ProxyContact& contact) {
  if (!contact.contact) return far_answer();
  Answer answer;
  answer.distance = -contact.depth;
  answer.normal = contact.normal;
  answer.source = Source::triangles;
  answer.status = Status::exact;
  return answer;
}

std::vector<Answer> follow_path(MeshProxy& proxy, const std::vector<TimedPlace>& path) {
  std::vector<Answer> answers;
  answers.reserve(path.size());
  for (const TimedPlace& step : path) {
    if (step.fresh) proxy.place(step.free);
    answers.push_back(answer_of(proxy.follow(step.point)));
  }
  return answers;
}

/// All that is measured on one model.
class Race {
 public:
  Race(const ModelSource& source, const TimesPlan& plan, TimesReport& report,
       std::function<void(const std::string&, double)> tell)
      : plan_(plan),
        report_(report),
        tell_(std::move(tell)),
        bakes_(plan.bakes),
        model_(source, baker::load_mesh(source.path, {1, bench_diagonal})),
        places_(draw_places(model_, plan.samples, plan.seed)),
        path_(walk_surface(model_, -model_.band.max_depth, model_.band.margin, plan.path_steps,
                           plan.seed)),
        probe_path_(walk_surface(model_, 0, plan.probe_radius, plan.path_steps, plan.seed)),
        sets_{path_.steps, random_places(model_, places_, plan.path_steps)} {
    report.models.push_back({model_.name, model_.tolerance, model_.mesh.triangles.size(),
                             model_.mesh.vertices.size(), places_.places.size(),
                             places_.contested});
  }

  void run() {
    add_spm();
    add("paper", [&] { return make_paper(model_, plan_.paper_planes, plan_.paper_resolution); });
    add_triangle_methods();
    add_fields();
    add_proxies();
    tell_("errors", 0.5);
    for (const auto& method : methods_) {
      report_.rows.push_back(
          {model_.name, method->facts(), {}, score(*method, model_, places_), false});
    }
    for (const NamedProxy& named : proxies_) {
      const std::vector<Answer> answers = follow_path(*named.proxy, path_.steps);
      report_.rows.push_back({model_.name,
                              named.facts,
                              {},
                              score(answers, model_, path_.places, model_.tolerance),
                              true});
    }
    time_all();
    time_probes();
  }

 private:
  [[nodiscard]] bool wanted(const std::string& method) const {
    return plan_.methods.empty() ||
           std::find(plan_.methods.begin(), plan_.methods.end(), method) != plan_.methods.end();
  }

  template <class Make>
  void attempt(const char* name, const Make& make) {
    if (!wanted(name)) return;
    tell_(name, 0);
    try {
      make();
    } catch (const baker::BakeError& error) {
      report_.failures.push_back({model_.name, name, error.what()});
    }
  }

  template <class Make>
  void add(const char* name, const Make& make) {
    attempt(name, [&] { methods_.push_back(make()); });
  }

  /// The curve of tolerances, and at the model's own the library's batch form and the scalar one.
  void add_spm() {
    std::vector<double> tolerances = plan_.tolerances;
    tolerances.push_back(model_.tolerance);
    std::sort(tolerances.begin(), tolerances.end());
    tolerances.erase(std::unique(tolerances.begin(), tolerances.end()), tolerances.end());
    for (const double tolerance : tolerances) {
      attempt("spm", [&] {
        BakedFile file = bakes_.asset(model_, tolerance);
        const QueryAsset asset = open_query_asset(file);
        methods_.push_back(make_spm(file, asset));
        if (tolerance != model_.tolerance) return;
        methods_.push_back(make_spm_batch(file, asset));
        if (plan_.scalar) methods_.push_back(make_spm_scalar(file, asset));
        probes_.push_back(make_spm_probe(file, plan_.probe_radius));
      });
    }
  }

  void add_triangle_methods() {
    for (const double cell : plan_.grid_cells) {
      if (!wanted("triangle-grid")) break;
      tell_("triangle-grid", 0);
      const CellTriangles cells = find_cell_triangles(model_, cell);
      for (const GridLists lists : {GridLists::own, GridLists::shared}) {
        add("triangle-grid", [&] { return make_triangle_grid(model_, cells, lists); });
      }
    }
    for (const EmbreeTree kind :
         {EmbreeTree::compact, EmbreeTree::standard, EmbreeTree::high_quality}) {
      add("embree", [&] { return make_embree(model_, kind); });
    }
    add("cgal-aabb", [&] { return make_cgal_tree(model_); });
    add("fcl", [&] { return make_fcl(model_); });
    add("bullet", [&] { return make_bullet(model_); });
    attempt("fcl", [&] { probes_.push_back(make_fcl_probe(model_, plan_.probe_radius)); });
    attempt("bullet", [&] { probes_.push_back(make_bullet_probe(model_, plan_.probe_radius)); });
  }

  void add_fields() {
    for (const double voxel : plan_.voxels) {
      if (!wanted("openvdb") && !wanted("nanovdb") && !wanted("dense-sdf")) break;
      tell_("distances", 0);
      DistanceLattice lattice = sample_band(model_, voxel);
      add("openvdb", [&] { return make_openvdb(lattice); });
      for (const NanoVoxel bits : plan_.nano_voxels) {
        add("nanovdb", [&] { return make_nanovdb(lattice, bits); });
      }
      add("dense-sdf", [&] { return make_dense_sdf(std::move(lattice)); });
    }
    for (const double tolerance : plan_.adaptive_tolerances) {
      add("adaptive-sdf", [&] { return make_adaptive_sdf(model_, tolerance); });
      add("hp-sdf", [&] { return make_hp_sdf(model_, hp_share * tolerance); });
    }
  }

  void add_proxies() {
    for (const auto& [tree, shading] :
         {std::pair(true, false), std::pair(true, true), std::pair(false, true)}) {
      MeshProxyOptions options;
      options.tree = tree;
      options.shading = shading;
      attempt("mesh-proxy", [&] { proxies_.push_back(make_named_proxy(model_, options)); });
    }
  }

  /// The last rows of the report are this model's: methods, then proxies.
  void time_all() {
    std::vector<std::unique_ptr<Contestant>> contestants;
    for (const auto& method : methods_) contestants.push_back(contestant_of(*method));
    for (const NamedProxy& named : proxies_) contestants.push_back(contestant_of(*named.proxy));
    const std::vector<QueryTimes> times = time_queries(
        contestants, sets_, plan_.timing, [&](double done) { tell_("timing", 0.5 + 0.5 * done); });
    const std::size_t first = report_.rows.size() - times.size();
    for (std::size_t i = 0; i < times.size(); ++i) report_.rows[first + i].ns = times[i];
  }

  void time_probes() {
    std::vector<std::unique_ptr<Contestant>> contestants;
    for (const auto& probe : probes_) contestants.push_back(contestant_of(*probe));
    const std::vector<double> hot = time_hot(contestants, probe_path_.steps, plan_.timing);
    for (std::size_t i = 0; i < probes_.size(); ++i) {
      ProbeRow row = judge(*probes_[i]);
      row.hot = hot[i];
      report_.probe_rows.push_back(row);
    }
  }

  /// How far a ball's depth is from the radius less the distance of its centre.
  [[nodiscard]] ProbeRow judge(ProbeMethod& probe) const {
    ProbeRow row;
    row.model = model_.name;
    row.method = probe.name();
    row.settings = probe.settings();
    std::vector<double> errors;
    std::size_t contacts = 0, missed = 0;
    for (const Place& place : probe_path_.places.places) {
      const double truth = std::max(0.0, plan_.probe_radius - place.distance);
      const double depth = probe.depth(place.point);
      errors.push_back(std::abs(depth - truth));
      // One that is shallower than the tolerance may be missed.
      if (truth <= model_.tolerance) continue;
      ++contacts;
      missed += depth > 0 ? 0 : 1;
    }
    row.p50 = quantile(errors, 0.5);
    row.p99 = quantile(errors, 0.99);
    row.missed = contacts > 0 ? static_cast<double>(missed) / static_cast<double>(contacts) : 0;
    return row;
  }

  const TimesPlan& plan_;
  TimesReport& report_;
  std::function<void(const std::string&, double)> tell_;
  BakeFolder bakes_;
  Model model_;
  Places places_;
  WalkedPath path_;
  WalkedPath probe_path_;  ///< a ball's centre: outside, since meshes lose it once it is within
  QuerySets sets_;
  std::vector<std::unique_ptr<Method>> methods_;
  std::vector<NamedProxy> proxies_;
  std::vector<std::unique_ptr<ProbeMethod>> probes_;
};

}  // namespace

const std::vector<std::string>& timed_method_names() {
  static const std::vector<std::string> names{
      "spm",     "paper",   "triangle-grid", "embree",       "cgal-aabb", "fcl",       "bullet",
      "openvdb", "nanovdb", "dense-sdf",     "adaptive-sdf", "hp-sdf",    "mesh-proxy"};
  return names;
}

TimesReport measure_times(const TimesPlan& plan, const BenchProgress& progress) {
  const tbb::global_control limit = thread_limit(plan.threads);
  TimesReport report;
  double models_done = 0;
  for (const ModelSource& source : plan.models) {
    const auto tell = [&](const std::string& what, double done) {
      if (!progress) return;
      progress(source.name + ": " + what,
               (models_done + done) / static_cast<double>(plan.models.size()));
    };
    tell("places", 0);
    Race(source, plan, report, tell).run();
    models_done += 1;
  }
  return report;
}

const TimesRow* own_row(const TimesReport& report, const ModelRow& model) {
  const auto found = std::find_if(report.rows.begin(), report.rows.end(), [&](const TimesRow& row) {
    return row.model == model.name && row.facts.name == "spm" &&
           row.facts.setting == model.tolerance;
  });
  return found == report.rows.end() ? nullptr : &*found;
}

}  // namespace spm::bench
