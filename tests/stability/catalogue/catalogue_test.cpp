// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/stability/catalogue/catalogue.hpp"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numbers>
#include <set>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "baker/mesh/load.hpp"
#include "baker/mesh/mesh.hpp"
#include "servo/devices/sim/sim_plant.hpp"
#include "tests/bench/model/known_meshes.hpp"
#include "tests/stability/catalogue/catalogue_parts.hpp"
#include "tests/stability/objects/hand_script.hpp"
#include "tests/support/skip.hpp"

namespace spm::stability::catalogue_test {
namespace {

using test::Shape;

/// Distance of a point from a triangle, m, by the planes of its edges: no code of the product's or
/// the rivals'.
double distance_to(const Vector3& point, const std::array<Vector3, 3>& corners) {
  const Vector3 normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalized();
  bool is_above = true;
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < 3; ++k) {
    const Vector3& from = corners[k];
    const Vector3 edge = corners[(k + 1) % 3] - from;
    is_above = is_above && normal.cross(edge).dot(point - from) >= 0;
    const double share = std::clamp((point - from).dot(edge) / edge.squaredNorm(), 0.0, 1.0);
    nearest = std::min(nearest, (point - from - share * edge).norm());
  }
  return is_above ? std::abs(normal.dot(point - corners[0])) : nearest;
}

/// Exact distance and side of a mesh, triangle by triangle.
class EveryTriangle {
 public:
  explicit EveryTriangle(const Shape& shape) {
    for (const auto& [a, b, c] : shape.triangles) {
      corners_.push_back({shape.vertices[a], shape.vertices[b], shape.vertices[c]});
    }
  }

  /// m, of the surface, whatever the side.
  [[nodiscard]] double distance(const Vector3& point) const {
    double nearest = std::numeric_limits<double>::infinity();
    for (const auto& corners : corners_) nearest = std::min(nearest, distance_to(point, corners));
    return nearest;
  }

  /// Whether the surface goes more than half round a point: by the sum of the triangles' solid
  /// angles (Van Oosterom and Strackee 1983).
  [[nodiscard]] bool inside(const Vector3& point) const {
    double sum = 0;
    for (const auto& corners : corners_) {
      const Vector3 a = corners[0] - point, b = corners[1] - point, c = corners[2] - point;
      const double la = a.norm(), lb = b.norm(), lc = c.norm();
      sum += 2 * std::atan2(a.dot(b.cross(c)),
                            la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
    }
    return sum > 2 * std::numbers::pi;
  }

  /// How far a ball is from touching, m; negative where it touches or is inside.
  [[nodiscard]] double clearance(const Vector3& centre, double radius) const {
    const double nearest = distance(centre);
    return (inside(centre) ? -nearest : nearest) - radius;
  }

 private:
  std::vector<std::array<Vector3, 3>> corners_;
};

/// The case's mesh as it lies in the world.
Shape shape_of(const StabilityCase& tried) {
  if (tried.mesh.empty()) return tried.shape;
  const baker::Mesh mesh =
      baker::load_mesh(bench::shared_folder() + "/meshes/" + tried.mesh, {tried.mesh_scale, {}});
  return {mesh.vertices, mesh.triangles};
}

const StabilityCase& named(const std::vector<StabilityCase>& cases, std::string_view name) {
  const auto found = std::find_if(cases.begin(), cases.end(),
                                  [&](const StabilityCase& one) { return one.name == name; });
  if (found == cases.end()) throw std::runtime_error("no case " + std::string(name));
  return *found;
}

Vector3 surface_at(const StabilityCase& tried, double time) {
  return tried.surface ? tried.surface(time) : Vector3::Zero();
}

/// Free speed (m/s) against the normal with which the tool of `low` comes to where its case's
/// runway ends.
double arrival_speed(const StabilityCase& tried) {
  servo::PlantSettings settings;
  settings.profile = *servo::find_sim_profile("low");
  servo::SimPlant plant(settings);
  plant.place(tried.start);
  const HandScript script(tried, Vector3::Zero());
  const double way = runway(tried.hand.front().speed);
  for (int tick = 1; tick < 2000; ++tick) {
    static_cast<void>(plant.step(Vector3::Zero(), script.at(tick * settings.period)));
    if ((tried.start - plant.position()).dot(tried.normal) >= way) {
      return -plant.velocity().dot(tried.normal);
    }
  }
  return 0;
}

/// What the hand presses with at the end, N, where a stiff plane holds the tool at its first touch.
double final_press(const StabilityCase& tried, double height) {
  servo::PlantSettings settings;
  settings.profile = *servo::find_sim_profile("low");
  settings.friction_scale = 0;
  servo::SimPlant plant(settings);
  plant.place(tried.start);
  const HandScript script(tried, Vector3::Zero());
  constexpr double stiffness = 1000, damping = 2;
  double pressed = 0;
  const auto ticks = static_cast<int>(std::lround(tried.seconds / settings.period));
  for (int tick = 1; tick <= ticks; ++tick) {
    const double depth = height - plant.position().dot(tried.normal);
    Vector3 force = Vector3::Zero();
    if (depth > 0) {
      force = (stiffness * depth - damping * plant.velocity().dot(tried.normal)) * tried.normal;
    }
    const servo::PlantTick done = plant.step(force, script.at(tick * settings.period));
    pressed = -done.hand_force.dot(tried.normal);
  }
  return pressed;
}

}  // namespace

TEST_CASE("Every case of the catalogue has a name of its own, a theme and a sentence") {
  const std::vector<StabilityCase> cases = whole_catalogue();
  CHECK(cases.size() >= 24);
  std::set<std::string> names, titles;
  for (const StabilityCase& one : cases) {
    INFO(one.name);
    CHECK_FALSE(one.name.empty());
    CHECK(std::all_of(one.name.begin(), one.name.end(), [](char letter) {
      return (letter >= 'a' && letter <= 'z') || (letter >= '0' && letter <= '9') || letter == '-';
    }));
    CHECK(names.insert(one.name).second);
    CHECK(titles.insert(one.title).second);
    CHECK_FALSE(one.theme.empty());
    CHECK(one.title.size() > 40);
    CHECK(one.title.back() == '.');
    CHECK(one.title.find(": ") != std::string::npos);
    CHECK(one.seeds >= 1);
    CHECK(one.mesh.empty() == !one.shape.triangles.empty());
  }
}

TEST_CASE("The catalogue has every failure that it was asked for") {
  const std::vector<StabilityCase> cases = whole_catalogue();
  for (const char* name : {"flat-wall-at-0-6",
                           "flat-wall-at-1-7",
                           "delay-2-ticks",
                           "delay-4-ticks",
                           "encoder-100um",
                           "tap-at-500-mm-s",
                           "press-slide-lift",
                           "loop-about-edge",
                           "plate-200um-at-50-mm-s",
                           "plate-500um-at-200-mm-s",
                           "plate-1000um-at-1000-mm-s",
                           "two-plates",
                           "bar-3mm",
                           "taper",
                           "sphere-in-groove-60",
                           "sphere-in-groove-90",
                           "sphere-in-groove-120",
                           "sphere-on-slot",
                           "sphere-in-corner",
                           "cone-pit",
                           "friction-at-rest",
                           "friction-at-2-mm-s",
                           "texture-at-rest",
                           "reload-by-500um",
                           "reload-by-2mm",
                           "object-into-hand",
                           "noisy-flat-wall",
                           "tile-switched-wall",
                           "coarser-level-switch",
                           "teeth-fissure",
                           "galleon-sail",
                           "fandisk-edge"}) {
    INFO(name);
    CHECK_NOTHROW(named(cases, name));
  }
  CHECK(named(cases, "flat-wall-at-0-6").of_border == 0.6);
  CHECK(named(cases, "flat-wall-at-1-7").of_border == 1.7);
  for (const char* name : {"noisy-flat-wall", "tile-switched-wall"}) {
    CHECK(named(cases, name).seeds == 30);
    CHECK(named(cases, name).friction_scale == 0);
    CHECK(named(cases, name).noise > 0);
  }
  CHECK(surface_at(named(cases, "reload-by-500um"), 3).z() == 0.5e-3);
  CHECK(surface_at(named(cases, "reload-by-2mm"), 3).z() == 2e-3);
}

TEST_CASE("Only a case whose mesh is not here is left out, and said to be") {
  const std::vector<StabilityCase> all = whole_catalogue();
  const std::vector<StabilityCase> here = catalogue();
  const std::vector<std::string> words = left_out_cases();
  CHECK(here.size() + words.size() == all.size());
  for (const std::string& sentence : words) {
    const StabilityCase& one = named(all, std::string_view(sentence).substr(0, sentence.find(':')));
    CHECK_FALSE(one.mesh.empty());
  }
  if (!words.empty()) {
    SPM_SKIP(words.size() << " cases of the catalogue are not tried, the first: " << words.front());
  }
}

TEST_CASE("Every shape of the catalogue is closed and its normals point out") {
  for (const StabilityCase& one : whole_catalogue()) {
    if (!one.mesh.empty()) continue;
    INFO(one.name);
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
    double volume = 0;
    bool in_range = true;
    for (const auto& triangle : one.shape.triangles) {
      for (std::size_t k = 0; k < 3; ++k) {
        in_range = in_range && triangle[k] < one.shape.vertices.size();
        ++edges[{triangle[k], triangle[(k + 1) % 3]}];
      }
      const auto& [a, b, c] = triangle;
      volume += one.shape.vertices[a].dot(one.shape.vertices[b].cross(one.shape.vertices[c])) / 6;
    }
    CHECK(in_range);
    CHECK(volume > 0);
    // Each edge twice, once each way.
    CHECK(std::all_of(edges.begin(), edges.end(), [&](const auto& edge) {
      return edge.second == 1 && edges.contains({edge.first.second, edge.first.first});
    }));
  }
}

TEST_CASE("Every hand starts at least 1 mm free of the object, and comes to touch it") {
  for (const StabilityCase& one : catalogue()) {
    INFO(one.name);
    const EveryTriangle mesh(shape_of(one));
    CHECK(mesh.clearance(one.start - surface_at(one, 0), one.probe_radius) >= 1e-3 * (1 - 1e-9));
    const HandScript script(one, Vector3::Zero());
    double nearest = std::numeric_limits<double>::infinity();
    // Finer than half of the thinnest plate, at the fastest speed.
    for (double time = 0; time < one.seconds && nearest > 0; time += 0.1e-3) {
      const servo::HandTarget target = script.at(time);
      // Nothing changes while all rest.
      if (time > 0 && target.velocity.isZero(0) &&
          (surface_at(one, time) - surface_at(one, time - 0.1e-3)).isZero(0)) {
        continue;
      }
      nearest = std::min(nearest,
                         mesh.clearance(target.position - surface_at(one, time), one.probe_radius));
    }
    CHECK(nearest <= 0);
  }
}

TEST_CASE("Every hand that is judged in hold rests for the last second, or slides at most 2 mm/s") {
  for (const StabilityCase& one : whole_catalogue()) {
    if (!one.judged.ripple) continue;
    INFO(one.name);
    CHECK(one.seconds == Approx(script_seconds(one)));
    const HandScript script(one, Vector3::Zero());
    const Vector3 way =
        script.at(one.seconds - 1e-9).position - script.at(one.seconds - 1).position;
    CHECK(way.norm() <= 2e-3 * (1 + 1e-6));
    if (one.judged.settles) CHECK(way.norm() == 0);
    CHECK((surface_at(one, one.seconds) - surface_at(one, one.seconds - 1)).isZero(0));
  }
}

TEST_CASE("A hand meets the object with about the speed that its case says") {
  for (const StabilityCase& one : whole_catalogue()) {
    if (one.is_carried || one.name == "plate-into-hand") continue;
    INFO(one.name);
    CHECK(arrival_speed(one) == Approx(one.hand.front().speed).epsilon(0.3));
  }
}

TEST_CASE("Every hand presses with a force that every device can hold") {
  for (const StabilityCase& one : whole_catalogue()) {
    if (one.is_carried || one.surface) continue;
    INFO(one.name);
    // Where its probe is about held: the target's end, and the reach of its press above it.
    const double target = one.hand.back().to.dot(one.normal);
    const double expected = one.mesh.empty() ? default_press : 1.0;
    const double pressed = final_press(one, target + press_depth(expected));
    CHECK(pressed == Approx(expected).epsilon(0.15));
    for (const servo::SimProfile& profile : servo::sim_profiles) {
      CHECK(pressed < 0.7 * profile.force_cap);
    }
  }
}

TEST_CASE("The places on real objects are what is said of them") {
  const std::vector<StabilityCase> cases = catalogue();
  const auto is_here = [&](const char* mesh) {
    return std::any_of(cases.begin(), cases.end(),
                       [&](const StabilityCase& one) { return one.mesh == mesh; });
  };
  const auto place_of = [](const StabilityCase& one) {
    return Vector3(one.start - runway(one.hand.front().speed) * one.normal);
  };
  if (is_here("teeth.obj")) {
    const StabilityCase& fissure = named(cases, "teeth-fissure");
    const EveryTriangle mesh(shape_of(fissure));
    const Vector3 place = place_of(fissure);
    CHECK(mesh.distance(place) == Approx(fissure.probe_radius).epsilon(0.2));
    // It is narrower than the ball for millimetres, and free.
    for (const double below : {0.5e-3, 1e-3, 2e-3, 3e-3}) {
      const Vector3 within = place - below * fissure.normal;
      CHECK_FALSE(mesh.inside(within));
      CHECK(mesh.distance(within) < 0.8 * fissure.probe_radius);
    }
  }
  if (is_here("galleon.obj")) {
    for (const auto& [name, thickness] :
         {std::pair{"galleon-sail", 0.5e-3}, std::pair{"galleon-thin-sail", 0.23e-3}}) {
      const StabilityCase& sail = named(cases, name);
      const EveryTriangle mesh(shape_of(sail));
      CHECK(mesh.distance(place_of(sail)) < 2e-6);
      CHECK(mesh.inside(place_of(sail) - thickness / 2 * sail.normal));
      CHECK_FALSE(mesh.inside(place_of(sail) - (thickness + 0.1e-3) * sail.normal));
    }
  }
  if (is_here("fandisk.obj")) {
    const StabilityCase& edge = named(cases, "fandisk-edge");
    const EveryTriangle mesh(shape_of(edge));
    CHECK(mesh.distance(place_of(edge)) < 2e-6);
    // From 0.5 mm on the other face is nearer.
    CHECK(mesh.distance(place_of(edge) - 0.4e-3 * edge.normal) == Approx(0.4e-3).epsilon(0.01));
    CHECK(mesh.distance(place_of(edge) - 1.5e-3 * edge.normal) == Approx(0.5e-3).epsilon(0.1));
    const StabilityCase& inner = named(cases, "fandisk-inner-edge");
    CHECK(mesh.distance(place_of(inner)) == Approx(inner.probe_radius).epsilon(0.01));
  }
}

}  // namespace spm::stability::catalogue_test
