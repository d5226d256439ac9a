// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cstdlib>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "tests/stability/catalogue/catalogue.hpp"
#include "tests/stability/laboratory/contestants.hpp"
#include "tests/stability/laboratory/laboratory.hpp"
#include "tests/stability/report/stability_report.hpp"

// The catalogue's fast part, so that a change that loses a case fails. The expected results are
// text files in the folder `golden`; with SPM_STABILITY_GOLDEN=write these tests write them anew.

namespace spm::stability::ci_subset_test {
namespace {

constexpr int seeds = 5;
constexpr std::array fractions{0.6, 1.7};  ///< of the flat border
constexpr double tolerance = 100e-6;       ///< m, of the bakes, which take most of the time
constexpr double force_tolerance = 5e-3;   ///< N, of a golden trace: another compiler's rounding
constexpr std::size_t every = 5;           ///< one in so many ticks is kept

bool is_writing() {
  const char* word = std::getenv("SPM_STABILITY_GOLDEN");
  return word != nullptr && std::string(word) == "write";
}

std::string golden(const std::string& name) {
  return std::string(SPM_STABILITY_GOLDEN_FOLDER) + "/" + name + ".txt";
}

/// `+` all seeds are good, `x` none is, `?` they disagree.
char letter_of(const CaseVerdict& verdict) {
  if (verdict.good()) return '+';
  return verdict.good_seeds == 0 ? 'x' : '?';
}

/// Maps case and method to one letter per fraction.
using Verdicts = std::map<std::pair<std::string, std::string>, std::string>;

Verdicts measured_verdicts() {
  const StabilityCase wall = wall_cases().front();
  const double flat = case_border(wall, {}, {"exact-penalty", {}}, 200, 60e3, 0.02);
  const std::vector<std::string> subset = quick_cases();
  Verdicts verdicts;
  for (StabilityCase tried : whole_catalogue()) {
    if (std::find(subset.begin(), subset.end(), tried.name) == subset.end()) continue;
    tried.seeds = seeds;
    tried.tolerance = tolerance;
    for (const char* method : {"spm", "proxy", "default"}) {
      std::string letters;
      for (const double fraction : fractions) {
        RunSettings settings;
        settings.stiffness = fraction * flat;
        letters += letter_of(case_verdict(tried, settings, {method, {}}));
      }
      verdicts[{tried.name, method}] = letters;
    }
  }
  return verdicts;
}

Verdicts expected_verdicts() {
  Verdicts verdicts;
  std::ifstream file(golden("verdicts"));
  for (std::string line; std::getline(file, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream words(line);
    std::string name, method, letters;
    words >> name >> method >> letters;
    verdicts[{name, method}] = letters;
  }
  return verdicts;
}

void write(const Verdicts& verdicts) {
  std::ofstream file(golden("verdicts"));
  file << "# Case, method, and the verdict at 0.6 and at 1.7 of the flat border on the profile "
          "low:\n"
          "# + all five seeds are good, x none is, ? they disagree, and nothing is asserted.\n";
  for (const auto& [key, letters] : verdicts) {
    file << key.first << ' ' << key.second << ' ' << letters << '\n';
  }
}

TEST_CASE("No case of a shape is lost at 0.6 or at 1.7 of the flat border") {
  const Verdicts measured = measured_verdicts();
  if (is_writing()) write(measured);
  const Verdicts expected = expected_verdicts();
  for (const auto& [key, letters] : measured) {
    INFO(key.first << ", " << key.second << ", at 0.6 and 1.7: expected and measured");
    const auto found = expected.find(key);
    REQUIRE(found != expected.end());
    REQUIRE(found->second.size() == letters.size());
    std::string compared = letters;
    for (std::size_t i = 0; i < letters.size(); ++i) {
      if (found->second[i] == '?') compared[i] = '?';
    }
    CHECK(found->second == compared);
  }
  CHECK(measured.size() == 3 * quick_cases().size());
  CHECK(expected.size() == measured.size());
}

/// A case whose force is traced: how the law is set up, and by which method.
struct GoldenTrace {
  const char* name;
  const char* method;
  const char* stabilization;
  EffectSettings effects;
  bool is_felt = true;  ///< on this block; a stiff coupling and a potential's are to change nothing
};

std::vector<GoldenTrace> golden_traces() {
  EffectSettings friction, damping, texture, smoothing;
  friction.friction = {0.5, 0.4, 1000};
  damping.damping = 2;
  texture.texture = {50e-6, 1e-3, 7};
  smoothing.smoothing.sigma = 2e-4;
  return {{"friction", "proxy", "", friction},
          {"damping", "spm", "", damping},
          {"texture", "proxy", "", texture},
          {"smoothing", "spm", "", smoothing},
          {"stabilization-damping", "proxy", "damping", {}},
          {"stabilization-coupling", "spm", "coupling", {}, false},
          {"stabilization-passivity", "spm", "passivity", {}},
          {"stabilization-velocity", "proxy", "damping+velocity", {}},
          {"stabilization-potential", "spm", "potential", {}, false}};
}

/// A block of 20 x 20 x 10 mm. The tool presses on its upper face and slides over it, past an edge.
std::vector<Vector3> traced_forces(const GoldenTrace& trace) {
  constexpr int press = 100, slide = 300;
  StabilityCase block;
  block.name = "golden-block";
  block.shape = test::box({20e-3, 20e-3, 10e-3});
  block.max_depth = 2e-3;
  block.tolerance = tolerance;
  block.effects = trace.effects;
  const auto contestant =
      make_contestant({trace.method, trace.stabilization}, prepared_object(block), block, {});
  const Vector3 start(0, 1.3e-3, 6e-3), pressed(0, 1.3e-3, 4.4e-3), end(11e-3, 1.3e-3, 4.4e-3);
  contestant->begin(start);
  std::vector<Vector3> forces;
  for (int i = 0; i <= press + slide; ++i) {
    const Vector3 place = i < press ? Vector3(start + (pressed - start) * i / press)
                                    : Vector3(pressed + (end - pressed) * (i - press) / slide);
    const Vector3 force = contestant->next(place, Vector3::Zero()).force;
    if (static_cast<std::size_t>(i) % every == 0) forces.push_back(force);
  }
  return forces;
}

void write(const GoldenTrace& trace, const std::vector<Vector3>& forces) {
  std::ofstream file(golden(trace.name));
  file << "# Force on the hand, N, x y z, every 5 ms; tolerance " << force_tolerance << " N.\n";
  for (const Vector3& force : forces) {
    file << force.x() << ' ' << force.y() << ' ' << force.z() << '\n';
  }
}

std::vector<Vector3> golden_forces(const GoldenTrace& trace) {
  std::vector<Vector3> forces;
  std::ifstream file(golden(trace.name));
  for (std::string line; std::getline(file, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream words(line);
    Vector3 force = Vector3::Zero();
    words >> force.x() >> force.y() >> force.z();
    forces.push_back(force);
  }
  return forces;
}

TEST_CASE("The forces of each effect and each stabilizer are those that were kept") {
  for (const GoldenTrace& trace : golden_traces()) {
    INFO(trace.name);
    const std::vector<Vector3> forces = traced_forces(trace);
    if (is_writing()) write(trace, forces);
    const std::vector<Vector3> kept = golden_forces(trace);
    REQUIRE(kept.size() == forces.size());
    double off = 0, largest = 0;
    for (std::size_t i = 0; i < kept.size(); ++i) {
      off = std::max(off, (forces[i] - kept[i]).norm());
      largest = std::max(largest, kept[i].norm());
    }
    CHECK(off < force_tolerance);
    CHECK(largest > 0.1);
  }
}

TEST_CASE(
    "Each effect and each stabilizer changes the force on a block, but those that are not to") {
  for (const GoldenTrace& trace : golden_traces()) {
    INFO(trace.name);
    const GoldenTrace bare{trace.name, trace.method, "", {}, false};
    const std::vector<Vector3> with = traced_forces(trace), without = traced_forces(bare);
    double off = 0;
    for (std::size_t i = 0; i < with.size(); ++i) {
      off = std::max(off, (with[i] - without[i]).norm());
    }
    CHECK((off > 2 * force_tolerance) == trace.is_felt);
    if (!trace.is_felt) CHECK(off < force_tolerance / 10);
  }
}

}  // namespace
}  // namespace spm::stability::ci_subset_test
