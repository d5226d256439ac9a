// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/reports/bytes.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include "baker/base/bake_error.hpp"
#include "baker/mesh/load.hpp"
#include "tests/bench/base/thread_limit.hpp"
#include "tests/bench/methods/methods.hpp"
#include "tests/bench/model/bake_folder.hpp"
#include "tests/bench/model/float_mesh.hpp"

namespace spm::bench {
namespace {

/// Below it only single precision errs: a twentieth of a micrometre.
constexpr double exact_error = 5e-8;

/// No adaptive field is built for less, m: at 25 um that of the teeth takes more than six minutes
/// of a processor to build.
constexpr double min_adaptive = 50e-6;

/// Builds and asks one method of a model after another.
class Bench {
 public:
  Bench(const BytesPlan& plan, const BenchProgress& progress, BytesReport& report)
      : plan_(plan), progress_(progress), report_(report), bakes_(plan.bakes) {}

  void measure(const ModelSource& source) {
    tell(source.name, "places");
    const Model model(source, baker::load_mesh(source.path, {1, bench_diagonal}));
    const Places places = draw_places(model, plan_.samples, plan_.seed);
    report_.models.push_back({model.name, model.tolerance, model.mesh.triangles.size(),
                              model.mesh.vertices.size(), places.places.size(), places.contested});
    add_raw_mesh(model);
    std::vector<double> tolerances = plan_.tolerances;
    tolerances.push_back(model.tolerance);
    std::sort(tolerances.begin(), tolerances.end());
    tolerances.erase(std::unique(tolerances.begin(), tolerances.end()), tolerances.end());
    for (const double tolerance : tolerances) {
      add(model, places, "spm", [&] {
        BakedFile file = bakes_.asset(model, tolerance);
        const QueryAsset asset = open_query_asset(file);
        return make_spm(file, asset);
      });
    }
    for (const double cell : plan_.grid_cells) add_grids(model, places, cell);
    for (const EmbreeTree kind : {EmbreeTree::compact, EmbreeTree::standard}) {
      add(model, places, "embree", [&] { return make_embree(model, kind); });
    }
    for (const double voxel : plan_.voxels) add_sdfs(model, places, voxel);
    for (const double tolerance : tolerances) {
      if (tolerance < min_adaptive) continue;
      add(model, places, "adaptive-sdf", [&] { return make_adaptive_sdf(model, tolerance); });
      add(model, places, "hp-sdf", [&] { return make_hp_sdf(model, hp_share * tolerance); });
    }
    ++models_done_;
  }

 private:
  [[nodiscard]] bool wanted(const std::string& method) const {
    return plan_.methods.empty() ||
           std::find(plan_.methods.begin(), plan_.methods.end(), method) != plan_.methods.end();
  }

  void tell(const std::string& model, const std::string& what) const {
    if (!progress_) return;
    progress_(model + ": " + what,
              static_cast<double>(models_done_) / static_cast<double>(plan_.models.size()));
  }

  /// The indexed mesh itself: what it takes to keep the surface, without a way to ask it.
  void add_raw_mesh(const Model& model) {
    if (!wanted("raw-mesh")) return;
    MethodFacts facts;
    facts.name = "raw-mesh";
    facts.settings = "floats";
    facts.file_bytes = facts.resident_bytes =
        FloatMesh::bytes_of(model.mesh.vertices.size(), model.mesh.triangles.size());
    report_.rows.push_back({model.name, facts, {}});
  }

  /// Both grids of one size come from the same lists.
  void add_grids(const Model& model, const Places& places, double cell) {
    if (!wanted("triangle-grid")) return;
    tell(model.name, "triangle-grid");
    const CellTriangles cells = find_cell_triangles(model, cell);
    for (const GridLists lists : {GridLists::own, GridLists::shared}) {
      add(model, places, "triangle-grid", [&] { return make_triangle_grid(model, cells, lists); });
    }
  }

  /// All distance fields of one size come from the same samples.
  void add_sdfs(const Model& model, const Places& places, double voxel) {
    if (!wanted("openvdb") && !wanted("nanovdb") && !wanted("dense-sdf")) return;
    tell(model.name, "distances");
    DistanceLattice lattice = sample_band(model, voxel);
    add(model, places, "openvdb", [&] { return make_openvdb(lattice); });
    for (const NanoVoxel bits : {NanoVoxel::fixed16, NanoVoxel::fixed8, NanoVoxel::variable}) {
      add(model, places, "nanovdb", [&] { return make_nanovdb(lattice, bits); });
    }
    add(model, places, "dense-sdf", [&] { return make_dense_sdf(std::move(lattice)); });
  }

  template <class Make>
  void add(const Model& model, const Places& places, const char* name, const Make& make) {
    if (!wanted(name)) return;
    tell(model.name, name);
    try {
      const std::unique_ptr<Method> method = make();
      report_.rows.push_back({model.name, method->facts(), score(*method, model, places)});
    } catch (const baker::BakeError& error) {
      report_.failures.push_back({model.name, name, error.what()});
    }
  }

  const BytesPlan& plan_;
  const BenchProgress& progress_;
  BytesReport& report_;
  BakeFolder bakes_;
  std::size_t models_done_ = 0;
};

}  // namespace

const std::vector<std::string>& method_names() {
  static const std::vector<std::string> names{"raw-mesh", "spm",          "triangle-grid",
                                              "embree",   "dense-sdf",    "openvdb",
                                              "nanovdb",  "adaptive-sdf", "hp-sdf"};
  return names;
}

BytesReport measure_bytes(const BytesPlan& plan, const BenchProgress& progress) {
  const tbb::global_control limit = thread_limit(plan.threads);
  BytesReport report;
  Bench bench(plan, progress, report);
  for (const ModelSource& source : plan.models) bench.measure(source);
  report.comparisons = compare_bytes(report.models, report.rows);
  return report;
}

std::vector<ComparisonRow> compare_bytes(const std::vector<ModelRow>& models,
                                         const std::vector<MethodRow>& rows) {
  std::vector<ComparisonRow> comparisons;
  for (const ModelRow& model : models) {
    const auto ours = std::find_if(rows.begin(), rows.end(), [&](const MethodRow& row) {
      return row.model == model.name && row.facts.name == "spm" &&
             row.facts.setting == model.tolerance;
    });
    if (ours == rows.end()) continue;
    for (const std::string& method : method_names()) {
      if (method == "spm" || method == "raw-mesh") continue;
      std::vector<SizeAndError> settings;
      for (const MethodRow& row : rows) {
        if (row.model != model.name || row.facts.name != method) continue;
        settings.push_back({static_cast<double>(row.facts.resident_bytes), row.score.p99});
      }
      if (settings.empty()) continue;
      comparisons.push_back({model.name, method, ours->score.p99, ours->facts.resident_bytes,
                             size_at_error(std::move(settings), ours->score.p99, exact_error)});
    }
  }
  return comparisons;
}

}  // namespace spm::bench
