// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/reports/times.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>

#include "formats/asset/mapped_asset.hpp"
#include "tests/baker/verify/verify_shapes.hpp"
#include "tests/bench/base/temporary_folder.hpp"
#include "tests/bench/base/unwrap.hpp"
#include "tests/bench/methods/tick_methods.hpp"
#include "tests/bench/methods/tick_timing.hpp"
#include "tests/bench/model/baked_file.hpp"
#include "tests/bench/model/query_sets.hpp"
#include "tests/bench/reports/tables_text.hpp"
#include "tests/bench/reports/times_text.hpp"
#include "tests/support/shapes.hpp"

namespace times_test {

namespace {

using namespace spm;
using namespace spm::bench;

Model ball_model() { return {{"ball", "ball", 100e-6}, test::as_mesh(test::sphere(0.012, 3))}; }

/// Counts what it is asked.
class Counting final : public Contestant {
 public:
  explicit Counting(std::size_t& asked) : asked_(asked) {}
  void begin(std::span<const TimedPlace> block) override { begun_ = block.size(); }
  void ask(std::span<const TimedPlace> block) override {
    CHECK(begun_ == block.size());
    asked_ += block.size();
  }

 private:
  std::size_t& asked_;
  std::size_t begun_ = 0;
};

/// In contact at even ticks; odd ones count.
class EvenTicks final : public TickMethod {
 public:
  bool tick(std::size_t index, const Vector3&) override { return index % 2 == 0 || index == 3; }
  [[nodiscard]] bool counts(std::size_t index) const override { return index % 2 == 1; }
};

/// A ball, and a short straight slide into it from the side, as `tables` reads them.
SlidSource ball_slide(const std::string& folder) {
  SlidSource source;
  source.model = {"ball", folder + "/ball.obj", 400e-6};
  source.trajectory = folder + "/slide.txt";
  source.planes = 20;
  test::write_obj(test::sphere(0.012, 3), source.model.path);
  std::ofstream slide(source.trajectory);
  for (int i = 0; i < 100; ++i) slide << -0.0135 + 2e-5 * i << " 0 0\n";
  return source;
}

TableRow scaling_row(std::uint64_t triangles, std::uint64_t planes, const char* settings,
                     double mean) {
  TableRow row;
  row.table = 1;
  row.triangles = triangles;
  row.planes = planes;
  row.method = planes > 0 ? "paper" : "mesh-proxy";
  row.settings = settings;
  row.us.mean = mean;
  return row;
}

}  // namespace

TEST_CASE("A walk keeps to its heights and takes small steps") {
  const Model model = ball_model();
  const WalkedPath path = walk_surface(model, -0.002, 0.0005, 600, 1);
  REQUIRE(path.steps.size() == 600);
  REQUIRE(path.places.places.size() == 600);
  CHECK(path.steps.front().fresh);
  double deepest = 0, highest = 0;
  for (std::size_t i = 0; i < path.steps.size(); ++i) {
    const TimedPlace& step = path.steps[i];
    const Place& place = path.places.places[i];
    CHECK(step.point == place.point);
    CHECK(place.distance == Approx(step.point.norm() - 0.012).margin(0.1e-3));
    CHECK(place.distance >= -0.002);
    CHECK(place.distance <= 0.0005);
    deepest = std::min(deepest, place.distance);
    highest = std::max(highest, place.distance);
    CHECK(step.free.norm() > step.point.norm() - 0.0005);
    if (!step.fresh) CHECK((step.point - path.steps[i - 1].point).norm() < 0.101e-3);
  }
  CHECK(deepest < -0.0018);
  CHECK(highest > 0.0003);
  const WalkedPath again = walk_surface(model, -0.002, 0.0005, 600, 1);
  const WalkedPath other = walk_surface(model, -0.002, 0.0005, 600, 2);
  CHECK(again.steps.back().point == path.steps.back().point);
  CHECK(other.steps.back().point != path.steps.back().point);
}

TEST_CASE("Every contestant is asked the same questions") {
  std::size_t first = 0, second = 0;
  std::vector<std::unique_ptr<Contestant>> contestants;
  contestants.push_back(std::make_unique<Counting>(first));
  contestants.push_back(std::make_unique<Counting>(second));
  QuerySets sets{std::vector<TimedPlace>(130), std::vector<TimedPlace>(70)};
  TimingPlan plan;
  plan.rounds = 2;
  plan.pass_seconds = 1;
  plan.cold_queries = 5;
  plan.cold_bytes = 1024;
  const std::vector<QueryTimes> times = time_queries(contestants, sets, plan, {});
  REQUIRE(times.size() == 2);
  CHECK(first == second);
  // Each round: a block to begin with, then all places twice.
  CHECK(first >= 2 * 2 * (130 + 70) + 5);
  for (const QueryTimes& time : times) {
    CHECK(std::isfinite(time.hot));
    CHECK(time.hot_p99 >= 0);
    CHECK(time.hot >= 0);
    CHECK(time.cold >= 0);
  }
}

TEST_CASE("Only ticks that count are in a table's figures") {
  std::vector<std::unique_ptr<TickMethod>> methods;
  methods.push_back(std::make_unique<EvenTicks>());
  const std::vector<Vector3> path(10, Vector3::Zero());
  const std::vector<TickTimes> times = time_ticks(methods, path, {});
  REQUIRE(times.size() == 1);
  CHECK(times[0].ticks == 5);
  CHECK(times[0].contacts == 1);
  CHECK(times[0].mean >= 0);
  CHECK(times[0].p99 >= times[0].p50);
}

TEST_CASE("Our proxy is carried from tick to tick, and begins anew in each pass") {
  baker::Mesh mesh = test::as_mesh(test::sphere(0.012, 3));
  mesh.sha256 = std::string(64, '0');
  const TemporaryFolder folder;
  const BakedFile file = bake_sparse(mesh, {bench_band, 200e-6, 500e-6}, folder.path());
  const std::unique_ptr<MappedAsset> asset = unwrap(MappedAsset::open(file.path));
  const std::unique_ptr<TickMethod> proxy = own_proxy_ticks(asset->view(), 500e-6);
  const Vector3 left(-0.013, 0, 0), right(0.013, 0, 0);
  proxy->start(left);
  CHECK(!proxy->tick(0, left));
  CHECK(proxy->tick(1, Vector3(-0.011, 0, 0)));
  // The ball keeps it on the side that it came from.
  CHECK(proxy->tick(2, right));
  proxy->start(right);
  CHECK(!proxy->tick(0, right));
}

TEST_CASE("A recorded slide has our proxy's ball beside the ball of `spm`") {
  const TemporaryFolder folder;
  TablesPlan plan;
  plan.slides = {ball_slide(folder.path())};
  plan.paper_resolution = 9;
  plan.timing = {1, 0.1, 1};
  const TablesReport report = measure_tables(plan, {});
  REQUIRE(report.failures.empty());
  std::vector<TableRow> own;
  for (const TableRow& row : report.rows) {
    if (row.process == "ours") own.push_back(row);
  }
  REQUIRE(own.size() == 3);
  CHECK(own[0].method == "spm");
  CHECK(own[1].method == "spm");
  CHECK(own[2].method == "proxy");
  CHECK(own[2].settings == own[1].settings);
  CHECK(own[2].bytes == own[1].bytes);
  CHECK(own[2].us.ticks == 100);
  CHECK(own[2].us.contacts > 30);
  CHECK(own[2].with_collision_detection);
}

TEST_CASE("Growth is the slope over triangles, and over planes at the fewest triangles") {
  const std::vector<GrowthRow> growth =
      growth_of({scaling_row(1000, 0, "brute", 2), scaling_row(4000, 0, "brute", 8),
                 scaling_row(16000, 0, "brute", 32), scaling_row(1000, 100, "100 planes", 1),
                 scaling_row(1000, 400, "400 planes", 2), scaling_row(4000, 400, "400 planes", 2)});
  REQUIRE(growth.size() == 3);
  for (const GrowthRow& row : growth) {
    INFO(row.method << " " << row.settings << " over " << row.over);
    if (row.method == "mesh-proxy") CHECK(row.exponent == Approx(1));
    if (row.over == "planes") CHECK(row.exponent == Approx(0.5));
    if (row.settings == "400 planes") CHECK(row.exponent == Approx(0).margin(1e-9));
  }
}

TEST_CASE("Ratios compare each rival with the product at the mesh's own tolerance") {
  TimesReport report;
  ModelRow model;
  model.name = "ball";
  model.tolerance = 100e-6;
  report.models.push_back(model);
  const auto add = [&](const char* method, double setting, double hot) {
    TimesRow row;
    row.model = "ball";
    row.facts.name = method;
    row.facts.setting = setting;
    row.facts.resident_bytes = 1000;
    row.ns = {hot, 3 * hot, 2 * hot, 4 * hot};
    report.rows.push_back(row);
  };
  add("spm", 50e-6, 300);
  add("spm", 100e-6, 200);
  add("embree", 0, 500);
  const nlohmann::ordered_json json = to_json(report, {});
  for (const char* key : {"made", "meshes", "rows", "probe_rows", "ratios", "failures"}) {
    CHECK(json.contains(key));
  }
  REQUIRE(json["ratios"].size() == 1);
  CHECK(json["ratios"][0]["method"] == "embree");
  CHECK(json["ratios"][0]["ns_times_spm"]["hot"] == Approx(2.5));
  for (const char* key : {"method", "settings", "bytes", "file_bytes", "resident_bytes",
                          "build_seconds", "open_seconds", "ns", "depth_error_um",
                          "direction_error_deg", "misclassified", "unanswered"}) {
    CHECK(json["rows"][0].contains(key));
  }
  CHECK(json["rows"][2]["ns"]["hot_p99"] == 1500);
  CHECK(json["rows"][2]["ns"]["cold"] == 2000);
}

TEST_CASE("A table's row tells what the paper reports, where it does") {
  TablesReport report;
  report.rows.push_back(scaling_row(1000, 100, "100 planes", 1));
  report.rows.back().paper = PaperFigure{28, 6};
  report.rows.push_back(scaling_row(1000, 0, "tree", 2));
  const nlohmann::ordered_json json = to_json(report);
  CHECK(json["rows"][0]["paper_mean_us"] == 28);
  CHECK(json["rows"][0]["paper_sd_us"] == 6);
  CHECK(json["rows"][1]["paper_mean_us"].is_null());
  for (const char* key : {"table", "model", "process", "method", "settings", "mean_us", "sd_us",
                          "p50_us", "p99_us", "with_collision_detection", "bytes"}) {
    CHECK(json["rows"][0].contains(key));
  }
}

}  // namespace times_test
