// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/stability/report/served_default.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "baker/base/bake_error.hpp"
#include "servo/loop/delay_watch.hpp"
#include "tests/stability/catalogue/catalogue.hpp"
#include "tests/stability/catalogue/catalogue_parts.hpp"
#include "tests/stability/laboratory/contestants.hpp"

namespace spm::stability {
namespace {

constexpr double free_way = 12e-3;      // m
constexpr double way_step = 0.25e-3;    // m
constexpr double least_room = 0.4e-3;   // m, that a corner's way must have about it
constexpr double mesh_press = 1;        // N, as in the catalogue
constexpr double tap_speed = 0.5;       // m/s
constexpr double slide_length = 4e-3;   // m
constexpr double slide_speed = 0.1;     // m/s
constexpr double held_radius = 1.5e-3;  // m, about a place
constexpr double held_fall = 0.3e-3;    // m, that the surface may fall away by there
constexpr const char* any_file = "served.spm.exr";

/// Outward normals of a mesh's vertices, weighted by area; unit.
std::vector<Vector3> vertex_normals(const baker::Mesh& mesh) {
  std::vector<Vector3> normals(mesh.vertices.size(), Vector3::Zero());
  for (const baker::Triangle& triangle : mesh.triangles) {
    const Vector3& a = mesh.vertices[triangle[0]];
    const Vector3 twice = (mesh.vertices[triangle[1]] - a).cross(mesh.vertices[triangle[2]] - a);
    for (const std::uint32_t corner : triangle) normals[corner] += twice;
  }
  for (Vector3& normal : normals) {
    if (normal.norm() > 0) normal.normalize();
  }
  return normals;
}

/// Whether a hand can come along a normal without touching anything else.
bool is_free(const baker::ExactSurface& surface, const Vector3& from, const Vector3& normal) {
  if (normal.isZero(0)) return false;
  for (double way = way_step; way <= free_way; way += way_step) {
    const Vector3 point = from + way * normal;
    const double room = (surface.closest(point).position - point).norm();
    if (surface.inside(point) || room < std::min(0.5 * way, least_room)) return false;
  }
  return true;
}

/// Whether the surface about a place does not fall away, so that a point that is pressed there
/// stays: without friction it slips off a cusp, whatever the method.
bool holds(const baker::ExactSurface& surface, const Vector3& at, const Vector3& normal) {
  constexpr int around = 8;
  const Vector3 aside = normal.unitOrthogonal(), across = normal.cross(aside);
  for (const double radius : {0.5 * held_radius, held_radius}) {
    for (int i = 0; i < around; ++i) {
      const double angle = 2 * std::numbers::pi * i / around;
      const Vector3 point = at + radius * (std::cos(angle) * aside + std::sin(angle) * across);
      const double distance = (surface.closest(point).position - point).norm();
      if (distance > held_fall * radius / held_radius && !surface.inside(point)) return false;
    }
  }
  return true;
}

struct Place {
  Vector3 at, normal;
};

/// The next place is the free corner that is farthest from all that were taken.
std::vector<Place> far_places(const baker::Mesh& mesh, const baker::ExactSurface& surface,
                              int count) {
  const std::vector<Vector3> normals = vertex_normals(mesh);
  std::vector<double> apart(mesh.vertices.size(), std::numeric_limits<double>::infinity());
  std::vector<Place> places;
  while (static_cast<int>(places.size()) < count) {
    const auto farthest = std::max_element(apart.begin(), apart.end());
    if (*farthest <= 0) break;
    const auto i = static_cast<std::size_t>(farthest - apart.begin());
    const Vector3& at = mesh.vertices[i];
    *farthest = 0;
    if (!is_free(surface, at, normals[i]) || !holds(surface, at, normals[i])) continue;
    places.push_back({at, normals[i]});
    for (std::size_t j = 0; j < apart.size(); ++j) {
      apart[j] = std::min(apart[j], (mesh.vertices[j] - at).norm());
    }
  }
  return places;
}

/// A case of the catalogue's kind on the mesh of another.
StabilityCase on_mesh(const StabilityCase& of, std::string name, const Place& place, double speed) {
  StabilityCase made =
      press_case("meshes", std::move(name), {}, {},
                 {.place = place.at, .normal = place.normal, .speed = speed, .force = mesh_press});
  made.mesh = of.mesh;
  made.mesh_scale = of.mesh_scale;
  made.tolerance = of.tolerance;
  made.max_depth = of.max_depth;
  return made;
}

/// Presses, slides, lifts and comes back, three times, and then holds.
void slide(StabilityCase& tried) {
  constexpr int rounds = 3;
  const Vector3 above = tried.start, below = tried.hand.front().to;
  const Vector3 way = slide_length * tried.normal.unitOrthogonal();
  std::vector<HandLeg> legs;
  for (int round = 0; round < rounds; ++round) {
    legs.push_back({below, default_speed, 0.3});
    legs.push_back({below + way, slide_speed, 0.1});
    legs.push_back({above + way, slide_speed, 0});
    legs.push_back({above, slide_speed, 0});
  }
  legs.push_back({below, default_speed, default_rest});
  tried.hand = std::move(legs);
  tried.seconds = script_seconds(tried);
}

ToolEnd tool_end(const StabilityCase& tried, const Vector3& at) {
  const Vector3 way = at - tried.hand.back().to;
  const baker::ExactSurface& surface = prepared_object(tried).model().truth;
  const double distance = (surface.closest(at).position - at).norm();
  return {(way - way.dot(tried.normal) * tried.normal).norm(),
          surface.inside(at) ? distance : -distance};
}

/// `sim` has no cap of its stiffness.
ForceDevice sim_device(const servo::SimProfile& profile) {
  return {find_device_profile(profile.name), std::numeric_limits<double>::infinity()};
}

ServedRow try_case(const StabilityCase& tried, const servo::SimProfile& profile) {
  ServedRow row;
  row.name = tried.name;
  row.device = profile.name;
  row.place = tried.start;
  row.probe_radius = tried.probe_radius;
  row.stiffness = served_loop(tried, profile).settings.stiffness;
  row.failure = why_unprepared(tried);
  if (!row.failure.empty()) return row;
  try {
    row.verdict = served_verdict(tried, profile, &row.end);
  } catch (const baker::BakeError& problem) {
    row.failure = problem.what();
  }
  return row;
}

}  // namespace

servo::ForceChoice served_by_default(const servo::SimProfile& profile, double probe_radius) {
  servo::ForceOptions options;
  options.asset = any_file;
  // `sim` has no cap of its stiffness.
  options.device =
      ForceDevice{find_device_profile(profile.name), std::numeric_limits<double>::infinity()};
  if (probe_radius > 0) options.probe = ProbeShape{ProbeKind::ball, probe_radius, 0};
  auto choice = servo::choose_forces(options);
  if (!choice) throw baker::BakeError(choice.error().code, choice.error().message);
  return std::move(*choice);
}

std::string why_not_by_default(const StabilityCase& tried) {
  if (tried.of_border > 0) return "it is about a share of the border, not about a stiffness";
  if (tried.effects.any()) return "its effects are named by a scene";
  return {};
}

ServedLoop served_loop(const StabilityCase& tried, const servo::SimProfile& profile) {
  ServedLoop loop;
  loop.scene = served_by_default(profile, tried.probe_radius).scene;
  loop.settings.profile = &profile;
  loop.limits = felt_limits(sim_device(profile), loop.settings.period);
  const double period = loop.settings.period;
  loop.delay_ticks = servo::DelayWatch(period, tried.delay_ticks * period).counted();
  SceneForce force(loop.scene, period, 0, 0, loop.limits);
  force.set_delay(loop.delay_ticks);
  loop.settings.stiffness = force.stiffest();
  return loop;
}

CaseVerdict served_verdict(const StabilityCase& tried, const servo::SimProfile& profile,
                           ToolEnd* end) {
  ServedLoop loop = served_loop(tried, profile);
  const AssetView& asset = prepared_object(tried).sparse();
  std::vector<Verdict> verdicts;
  std::vector<Vector3> ends;
  for (int seed = 1; seed <= std::max(1, tried.seeds); ++seed) {
    loop.settings.seed = static_cast<std::uint64_t>(seed);
    const auto contestant =
        scene_contestant(asset, loop.scene, tried, loop.settings, loop.limits, loop.delay_ticks);
    const Trace trace = run_case(tried, loop.settings, *contestant);
    verdicts.push_back(judge(tried, judged_loop(tried, loop.settings), trace));
    ends.push_back(trace.ticks.back().position);
  }
  const CaseVerdict all = gathered(verdicts, 1);
  if (end != nullptr && !tried.hand.empty()) {
    *end = tool_end(tried, ends[static_cast<std::size_t>(all.worst_seed - 1)]);
  }
  return all;
}

std::vector<StabilityCase> teeth_cases(int places) {
  const std::vector<StabilityCase> meshes = mesh_cases();
  const auto fissure = std::find_if(meshes.begin(), meshes.end(),
                                    [](const auto& one) { return one.name == "teeth-fissure"; });
  if (fissure == meshes.end()) throw baker::BakeError(ExitCode::usage, "there is no teeth-fissure");
  const PreparedObject& object = prepared_object(*fissure);
  std::vector<StabilityCase> cases{*fissure};
  for (const Place& place : far_places(object.model().mesh, object.model().truth, places)) {
    cases.push_back(on_mesh(*fissure, "teeth-press", place, default_speed));
    cases.push_back(on_mesh(*fissure, "teeth-tap-at-500-mm-s", place, tap_speed));
    cases.push_back(on_mesh(*fissure, "teeth-press-slide-lift", place, default_speed));
    slide(cases.back());
  }
  return cases;
}

std::vector<ServedRow> serve_all(const std::vector<StabilityCase>& cases) {
  const std::size_t devices = servo::sim_profiles.size();
  std::vector<ServedRow> rows(cases.size() * devices);
  // One after the other: each bake uses all threads.
  for (const StabilityCase& tried : cases) {
    if (!why_unprepared(tried).empty()) continue;
    try {
      static_cast<void>(prepared_object(tried).sparse());
    } catch (const baker::BakeError&) {
      continue;  // its rows tell
    }
  }
  tbb::parallel_for(std::size_t{0}, rows.size(), [&](std::size_t i) {
    rows[i] = try_case(cases[i / devices], servo::sim_profiles[i % devices]);
  });
  return rows;
}

}  // namespace spm::stability
