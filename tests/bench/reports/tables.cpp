// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/reports/tables.hpp"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <memory>
#include <tuple>
#include <utility>

#include "baker/base/bake_error.hpp"
#include "baker/mesh/load.hpp"
#include "common/base/units.hpp"
#include "formats/asset/mapped_asset.hpp"
#include "formats/motion/trajectory.hpp"
#include "tests/bench/base/temporary_folder.hpp"
#include "tests/bench/base/thread_limit.hpp"
#include "tests/bench/base/unwrap.hpp"
#include "tests/bench/methods/tick_methods.hpp"
#include "tests/bench/model/baked_file.hpp"
#include "tests/bench/model/bumpy_sphere.hpp"
#include "tests/bench/model/paper_maps.hpp"

namespace spm::bench {
namespace {

/// The mesh as it is, parts that overlap and all: what the paper's baker and a proxy read.
baker::OuterSurface raw_surface(const baker::Mesh& mesh) {
  baker::OuterSurface surface;
  surface.vertices = mesh.vertices;
  surface.triangles = mesh.triangles;
  surface.solid_count = mesh.triangles.size();
  return surface;
}

/// All methods on one mesh and one path; what they need lives here until they were timed.
class Course {
 public:
  Course(int table, std::string model, const baker::Mesh& mesh, std::vector<Vector3> path,
         const TablesPlan& plan, TablesReport& report)
      : plan_(plan),
        report_(report),
        mesh_(mesh),
        surface_(raw_surface(mesh)),
        path_(std::move(path)) {
    common_.table = table;
    common_.model = std::move(model);
    common_.triangles = mesh.triangles.size();
  }

  void expect(const PaperFigure& mesh_based, const PaperFigure& free_form) {
    paper_mesh_based_ = mesh_based;
    paper_free_form_ = free_form;
  }

  void add_proxy(const MeshProxyOptions& options, bool given) {
    proxies_.push_back(make_mesh_proxy(FloatMesh(surface_), options));
    MeshProxy& proxy = *proxies_.back();
    TableRow row = row_of("mesh-based", "mesh-proxy", to_string(options), proxy.bytes());
    row.paper = paper_mesh_based_;
    add(row, proxy_ticks(proxy));
    if (!given) return;
    row.with_collision_detection = false;
    row.paper.reset();
    add(row, proxy_ticks_given(proxy, path_));
  }

  void add_paper(std::size_t planes) {
    if (!caster_) caster_ = std::make_unique<baker::Caster>(surface_);
    maps_.push_back(std::make_unique<PaperMaps>(mesh_, *caster_, planes, plan_.paper_resolution));
    const PaperMaps& maps = *maps_.back();
    TableRow row = row_of("free-form", "paper", maps.settings(), maps.bytes());
    row.planes = maps.view().planes.size();
    row.paper = paper_free_form_;
    add(row, paper_ticks(maps.view()));
    row.with_collision_detection = false;
    row.paper.reset();
    add(row, paper_ticks_given(maps.view(), path_));
  }

  /// `spm` for each radius, and for balls our proxy on the same file.
  void add_spm(double tolerance, const std::vector<double>& radii) {
    try {
      const SparseOptions options{bench_band, tolerance, plan_.probe_radius};
      const BakedFile file = bake_sparse(mesh_, options, folder_.path());
      assets_.push_back(open_query_asset(file.path));
      for (const double radius : radii) {
        std::string settings = file.settings;
        if (radius > 0) settings += ", " + format_quantity(radius, Quantity::length) + " ball";
        const std::uint64_t bytes = spm_query_memory(assets_.back().get());
        add(row_of("ours", "spm", settings, bytes), spm_ticks(*assets_.back(), radius));
        if (!(radius > 0)) continue;
        mapped_.push_back(unwrap(MappedAsset::open(file.path)));
        add(row_of("ours", "proxy", std::move(settings), bytes),
            own_proxy_ticks(mapped_.back()->view(), radius));
      }
    } catch (const baker::BakeError& error) {
      report_.failures.push_back({common_.model, "spm", error.what()});
    }
  }

  void time() {
    const std::vector<TickTimes> times = time_ticks(methods_, path_, plan_.timing);
    for (std::size_t i = 0; i < times.size(); ++i) {
      rows_[i].us = times[i];
      report_.rows.push_back(rows_[i]);
    }
  }

 private:
  [[nodiscard]] TableRow row_of(const char* process, const char* method, std::string settings,
                                std::uint64_t bytes) const {
    TableRow row = common_;
    row.process = process;
    row.method = method;
    row.settings = std::move(settings);
    row.bytes = bytes;
    return row;
  }

  void add(TableRow row, std::unique_ptr<TickMethod> method) {
    rows_.push_back(std::move(row));
    methods_.push_back(std::move(method));
  }

  const TablesPlan& plan_;
  TablesReport& report_;
  const baker::Mesh& mesh_;
  baker::OuterSurface surface_;
  std::vector<Vector3> path_;
  TableRow common_;
  std::optional<PaperFigure> paper_mesh_based_, paper_free_form_;
  TemporaryFolder folder_;
  std::unique_ptr<baker::Caster> caster_;
  std::vector<std::unique_ptr<MeshProxy>> proxies_;
  std::vector<std::unique_ptr<PaperMaps>> maps_;
  std::vector<QueryAsset> assets_;
  std::vector<std::unique_ptr<MappedAsset>> mapped_;
  std::vector<TableRow> rows_;
  std::vector<std::unique_ptr<TickMethod>> methods_;
};

std::vector<Vector3> read_path(const std::string& file, std::size_t most) {
  const std::vector<TrajectorySample> samples = unwrap(read_trajectory(file));
  std::vector<Vector3> path;
  for (const TrajectorySample& sample : samples) {
    if (most > 0 && path.size() == most) break;
    path.push_back(sample.position);
  }
  if (path.empty()) throw baker::BakeError(ExitCode::invalid_input, file + ": holds no position");
  return path;
}

/// Table 2 or 3: one of the paper's models, at its own size.
void measure_slide(const SlidSource& source, const TablesPlan& plan, TablesReport& report) {
  const baker::Mesh mesh = baker::load_mesh(source.model.path, {});
  Course course(source.table, source.model.name, mesh, read_path(source.trajectory, plan.max_ticks),
                plan, report);
  course.expect(source.mesh_based, source.free_form);
  for (const bool tree : {false, true}) {
    for (const double radius : {0.0, plan.probe_radius}) {
      MeshProxyOptions options;
      options.tree = tree;
      options.radius = radius;
      course.add_proxy(options, tree);
    }
  }
  course.add_paper(source.planes);
  course.add_spm(source.model.tolerance, {0, plan.probe_radius});
  course.time();
}

/// Table 1, over triangles: Force with and without a tree, and what shading adds to it.
void measure_triangles(int subdivisions, const TablesPlan& plan, TablesReport& report) {
  const baker::Mesh mesh = bumpy_sphere(subdivisions);
  Course course(1, "bumpy sphere", mesh, bumpy_slide(plan.slide_steps, 1e-3), plan, report);
  for (const auto& [tree, shading] :
       {std::pair(false, true), std::pair(true, false), std::pair(true, true)}) {
    MeshProxyOptions options;
    options.tree = tree;
    options.shading = shading;
    course.add_proxy(options, tree && shading);
  }
  course.add_paper(plan.paper_planes);
  course.add_spm(plan.scaling_tolerance, {0});
  course.time();
}

/// Table 1, over support planes.
void measure_planes(const TablesPlan& plan, TablesReport& report) {
  const baker::Mesh mesh = bumpy_sphere(plan.subdivisions.front());
  Course course(1, "bumpy sphere", mesh, bumpy_slide(plan.slide_steps, 1e-3), plan, report);
  for (const std::size_t planes : plan.plane_counts) {
    // The row of the other series is this one.
    if (planes != plan.paper_planes) course.add_paper(planes);
  }
  course.time();
}

}  // namespace

TablesReport measure_tables(const TablesPlan& plan, const BenchProgress& progress) {
  const tbb::global_control limit = thread_limit(plan.threads);
  TablesReport report;
  const auto steps = static_cast<double>(plan.subdivisions.size() + plan.slides.size() + 1);
  double done = 0;
  const auto tell = [&](const std::string& what) {
    if (progress) progress(what, done++ / steps);
  };
  for (const int subdivisions : plan.subdivisions) {
    tell(fmt::format("Table 1: {} triangles", 20ULL << (2U * static_cast<unsigned>(subdivisions))));
    measure_triangles(subdivisions, plan, report);
  }
  tell("Table 1: planes");
  if (!plan.subdivisions.empty()) measure_planes(plan, report);
  for (const SlidSource& slide : plan.slides) {
    tell(fmt::format("Table {}: {}", slide.table, slide.model.name));
    measure_slide(slide, plan, report);
  }
  report.growth = growth_of(report.rows);
  return report;
}

std::vector<GrowthRow> growth_of(const std::vector<TableRow>& rows) {
  struct Sums {
    double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  };
  // Over triangles with all else equal; over planes, which settings name, at equal triangles.
  using Key = std::tuple<std::string, std::string, std::string, bool>;
  std::map<Key, Sums> series;
  const auto show = [&](const Key& key, double count, double value) {
    if (!(count > 0 && value > 0)) return;
    Sums& sums = series[key];
    const double x = std::log(count), y = std::log(value);
    sums.n += 1;
    sums.x += x;
    sums.y += y;
    sums.xx += x * x;
    sums.xy += x * y;
  };
  std::uint64_t least = 0;
  for (const TableRow& row : rows) {
    if (row.table == 1 && (least == 0 || row.triangles < least)) least = row.triangles;
  }
  for (const TableRow& row : rows) {
    if (row.table != 1) continue;
    const bool given = row.with_collision_detection;
    show({"triangles", row.method, row.settings, given}, static_cast<double>(row.triangles),
         row.us.mean);
    if (row.planes > 0 && row.triangles == least) {
      show({"planes", row.method, "", given}, static_cast<double>(row.planes), row.us.mean);
    }
  }
  std::vector<GrowthRow> growth;
  for (const auto& [key, sums] : series) {
    const double spread = sums.n * sums.xx - sums.x * sums.x;
    if (sums.n < 2 || !(spread > 1e-9)) continue;
    const auto& [over, method, settings, with] = key;
    growth.push_back({method, settings, with, over, (sums.n * sums.xy - sums.x * sums.y) / spread});
  }
  return growth;
}

}  // namespace spm::bench
