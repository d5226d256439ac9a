// SPDX-License-Identifier: GPL-3.0-or-later
// Meshes made by seed: what a bake says of them is judged by winding numbers, on exact predicates.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <iostream>
#include <numbers>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "baker/base/bake_error.hpp"
#include "baker/build/build.hpp"
#include "baker/verify/verify.hpp"
#include "common/query/query.hpp"
#include "formats/asset/mapped_asset.hpp"
#include "tests/baker/mesh/mesh_support.hpp"
#include "tests/support/random.hpp"
#include "tests/support/shapes.hpp"

namespace spm::baker::seeded_meshes_test {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

constexpr double tolerance = 2e-4;
constexpr int places = 400;

/// A mesh file's triangles, and the closed solids whose union they are, where that is known.
struct SeededMesh {
  test::Shape file;
  test::Shape solids;  ///< facing out
  bool known = true;   ///< false for what is open: lid, sheet or solid is a matter of size
};

std::uint64_t below(test::RandomTwister& random, std::uint64_t count) {
  return random.bits() % count;
}

Eigen::Matrix3d any_turn(test::RandomTwister& random) {
  return Eigen::AngleAxisd(random.between(0, 6), random.direction()).toRotationMatrix();
}

test::Shape any_part(test::RandomTwister& random, double& width, double& height) {
  width = random.between(0.01, 0.04);
  height = random.between(0.005, 0.03);
  switch (below(random, 3)) {
    case 0:
      return test::box({width, width * random.between(0.5, 1), height});
    case 1:
      return test::cylinder(width / 2, height, static_cast<int>(3 + below(random, 46)));
    default:
      height = random.between(5e-5, 2e-3);
      return test::plate({width, width * random.between(0.5, 1), height});
  }
}

/// Parts on one another, that touch, overlap or leave a gap, by nothing up to 10 um.
test::Shape stacked_parts(test::RandomTwister& random) {
  constexpr double gaps[]{0, 0, 2e-8, -2e-8, 1e-6, -1e-6, 3e-6, -5e-6, 1e-5, -1e-5};
  const std::uint64_t count = 1 + below(random, 3);
  test::Shape all;
  double top = 0, wide = 0;
  for (std::uint64_t i = 0; i < count; ++i) {
    double width = 0, height = 0;
    test::Shape part = any_part(random, width, height);
    const std::uint64_t turned = below(random, 3);
    const double angle = turned == 0 ? 0 : turned == 1 ? 1e-5 : random.between(0, 6);
    for (Vector3& vertex : part.vertices)
      vertex = Eigen::AngleAxisd(angle, Vector3::UnitZ()) * vertex;
    const double gap = i == 0 ? 0 : gaps[below(random, 10)];
    // In the middle, flush with a side, or anywhere over what is below.
    const std::uint64_t where = below(random, 3);
    const double off = where == 0   ? 0
                       : where == 1 ? (wide - width) / 2
                                    : random.between(-1, 1) * wide / 2;
    all = test::merged(all, test::moved(part, {off, 0, top + gap + height / 2}));
    top += gap + height;
    wide = width;
  }
  return all;
}

void turn_all(test::RandomTwister& random, test::Shape& shape) {
  if (below(random, 3) > 0) {
    const Eigen::Matrix3d turn = any_turn(random);
    for (Vector3& vertex : shape.vertices) vertex = turn * vertex;
  }
  if (below(random, 2) == 0) return;
  for (Vector3& vertex : shape.vertices) vertex = vertex.cast<float>().cast<double>();
}

/// What files do to a surface without changing the solid: copies, copies in reverse, triangles and
/// parts that face the wrong way, triangles with corners of their own some nanometres apart.
void spoil(test::RandomTwister& random, double diagonal, test::Shape& file) {
  const std::size_t count = file.triangles.size();
  switch (below(random, 6)) {
    case 0:
      for (std::size_t i = 0; i < count; i += 1 + below(random, 5)) {
        file.triangles.push_back(file.triangles[i]);
      }
      break;
    case 1: {
      const auto [a, b, c] = file.triangles[below(random, count)];
      file.triangles.push_back({a, c, b});
      break;
    }
    case 2:
      file = test::turned_inside_out(file);
      break;
    case 3: {
      test::Shape torn;
      for (const auto& triangle : file.triangles) {
        std::array<std::uint32_t, 3> own{};
        for (std::size_t k = 0; k < 3; ++k) {
          own[k] = static_cast<std::uint32_t>(torn.vertices.size());
          torn.vertices.push_back(file.vertices[triangle[k]] +
                                  random.between(0, 2e-7) * diagonal * random.direction());
        }
        torn.triangles.push_back(own);
      }
      file = torn;
      break;
    }
    default:
      break;
  }
}

SeededMesh seeded_mesh(std::uint64_t seed) {
  test::RandomTwister random(seed);
  SeededMesh mesh;
  mesh.solids = stacked_parts(random);
  turn_all(random, mesh.solids);
  mesh.file = mesh.solids;
  Eigen::AlignedBox3d box;
  for (const Vector3& vertex : mesh.solids.vertices) box.extend(vertex);
  spoil(random, box.diagonal().norm(), mesh.file);
  if (below(random, 8) == 0) {
    mesh.known = false;
    const std::size_t gone = 1 + below(random, 3);
    for (std::size_t i = 0; i < gone && mesh.file.triangles.size() > 1; ++i) {
      mesh.file.triangles.erase(
          mesh.file.triangles.begin() +
          static_cast<std::ptrdiff_t>(below(random, mesh.file.triangles.size())));
    }
  }
  return mesh;
}

/// A block of so many sides around, with a hole as wide as twice the radius through it.
test::Shape bored_block(double radius, double height, std::uint32_t around) {
  test::Shape block;
  for (std::uint32_t i = 0; i < around; ++i) {
    const double angle = 2 * std::numbers::pi * i / around;
    const Vector3 out(std::cos(angle), std::sin(angle), 0);
    for (const double reach : {radius, 2.5 * radius}) {
      for (const double z : {-height / 2, height / 2}) {
        block.vertices.emplace_back(reach * out + z * Vector3::UnitZ());
      }
    }
  }
  // Of each corner around: inside low, inside high, outside low, outside high.
  constexpr std::array<std::array<std::uint32_t, 2>, 4> rings{{{0, 1}, {1, 3}, {3, 2}, {2, 0}}};
  for (std::uint32_t i = 0; i < around; ++i) {
    const std::uint32_t here = 4 * i, next = 4 * ((i + 1) % around);
    for (const auto& [a, b] : rings) {
      block.triangles.push_back({here + a, here + b, next + b});
      block.triangles.push_back({here + a, next + b, next + a});
    }
  }
  return block;
}

/// A pin in a hole that it fits by nothing up to 10 um, of other sides, turned and tilted a little.
SeededMesh fitted_mesh(std::uint64_t seed) {
  test::RandomTwister random(seed);
  const double radius = random.between(0.5e-3, 8e-3), height = random.between(1e-3, 6e-3);
  const auto around = static_cast<std::uint32_t>(5 + below(random, 28));
  const auto pin_around = below(random, 2) == 0 ? around : 5 + below(random, 28);
  // The middles of the sides are nearer than the corners.
  const double least = radius * std::cos(std::numbers::pi / around);
  const double pin_radius = (below(random, 2) == 0 ? radius : least) - random.between(0, 1e-5);
  test::Shape pin =
      test::cylinder(pin_radius, height * random.between(0.4, 2.5), static_cast<int>(pin_around));
  const double turn = below(random, 2) == 0 ? 0 : random.between(0, 6);
  const double tilt = below(random, 2) == 0 ? 0 : random.between(0, 2e-3);
  for (Vector3& vertex : pin.vertices) {
    vertex = Eigen::AngleAxisd(tilt, Vector3::UnitX()) *
             (Eigen::AngleAxisd(turn, Vector3::UnitZ()) * vertex);
  }
  const Vector3 off(random.between(-1e-5, 1e-5), 0, random.between(-0.5, 0.5) * height);
  SeededMesh mesh;
  mesh.solids = test::merged(bored_block(radius, height, around), test::moved(pin, off));
  turn_all(random, mesh.solids);
  mesh.file = mesh.solids;
  return mesh;
}

/// The winding number of closed surfaces, by the triangles above the place along z; nothing where
/// the line passes a side.
std::optional<int> exact_winding(const test::Shape& shape, const Vector3& place) {
  const auto flat = [](const Vector3& p) { return Kernel::Point_2(p.x(), p.y()); };
  const auto point = [](const Vector3& p) { return Kernel::Point_3(p.x(), p.y(), p.z()); };
  int winding = 0;
  for (const auto& triangle : shape.triangles) {
    const Vector3 &a = shape.vertices[triangle[0]], &b = shape.vertices[triangle[1]],
                  &c = shape.vertices[triangle[2]];
    const CGAL::Orientation ab = CGAL::orientation(flat(a), flat(b), flat(place)),
                            bc = CGAL::orientation(flat(b), flat(c), flat(place)),
                            ca = CGAL::orientation(flat(c), flat(a), flat(place));
    if (std::min({ab, bc, ca}) == CGAL::NEGATIVE && std::max({ab, bc, ca}) == CGAL::POSITIVE)
      continue;
    if (ab == CGAL::ZERO || bc == CGAL::ZERO || ca == CGAL::ZERO) return std::nullopt;
    const CGAL::Orientation side = CGAL::orientation(point(a), point(b), point(c), point(place));
    if (side == CGAL::ZERO) return std::nullopt;
    // Above where the place is behind a triangle that faces up, or before one that faces down.
    const bool faces_up = ab == CGAL::POSITIVE, behind = side == CGAL::NEGATIVE;
    if (faces_up == behind) winding += faces_up ? 1 : -1;
  }
  return winding;
}

/// A place up to some millimetres beside the surface.
Vector3 place_beside(test::RandomTwister& random, const test::Shape& shape) {
  const auto& [a, b, c] = shape.triangles[below(random, shape.triangles.size())];
  double u = random.unit(), v = random.unit();
  if (u + v > 1) {
    u = 1 - u;
    v = 1 - v;
  }
  const Vector3 on = shape.vertices[a] + u * (shape.vertices[b] - shape.vertices[a]) +
                     v * (shape.vertices[c] - shape.vertices[a]);
  return on + random.between(0, 2e-3) * random.direction();
}

/// The first place at which an asset breaks its promise, in words; empty where there is none.
std::string broken_promise(const SeededMesh& mesh, const AssetView& view, std::uint64_t seed) {
  test::RandomTwister random(seed + 1'000'000);
  for (int k = 0; k < places; ++k) {
    const Vector3 place = place_beside(random, mesh.solids);
    const std::optional<int> winding = exact_winding(mesh.solids, place);
    const double away = test::distance_to(mesh.solids.vertices, mesh.solids.triangles, place);
    if (!winding || away < 1.01 * tolerance) continue;
    const Answer answer = query_point(view, place);
    const auto said = [&](const std::string& right) {
      return "at (" + std::to_string(1e3 * place.x()) + ", " + std::to_string(1e3 * place.y()) +
             ", " + std::to_string(1e3 * place.z()) +
             ") mm: " + std::to_string(1e3 * answer.distance) + " mm, status " +
             std::to_string(static_cast<int>(answer.status)) + ", where " + right + " is right";
    };
    if (*winding > 0) {
      // What is hidden inside may be nearer than the boundary.
      const bool inside = answer.status == Status::deep ||
                          (answer.status == Status::exact && answer.distance <= tolerance - away);
      if (!inside) return said("below -" + std::to_string(1e3 * away));
      continue;
    }
    // Beyond the band an answer is no less than its end.
    const bool beyond = away > view.band.margin && answer.distance >= view.band.margin - tolerance;
    const bool outside = answer.status == Status::exact
                             ? beyond || std::abs(answer.distance - away) <= tolerance
                             : answer.status == Status::far && away > view.band.margin - tolerance;
    if (!outside) return said(std::to_string(1e3 * away));
  }
  return {};
}

/// What is wrong with the bake of a mesh made by seed, in words.
std::string wrong_with(const SeededMesh& mesh, std::uint64_t seed,
                       const test::TemporaryFolder& folder) {
  BuildRequest request;
  request.mesh = folder.path("mesh.obj");
  request.output = folder.path("mesh.spm.exr");
  request.bake.tolerance = tolerance;
  test::write_obj(mesh.file, request.mesh);
  try {
    static_cast<void>(run_build(request, {}));
  } catch (const BakeError& error) {
    return error.what();
  }
  const auto asset = MappedAsset::open(request.output);
  if (!asset) return asset.error().message;
  VerifyOptions options;
  options.samples = 5'000;
  const VerifyReport report =
      verify_asset((*asset)->view(), (*asset)->metadata(), request.mesh, options);
  if (!report.passed()) return "verify does not pass";
  return mesh.known ? broken_promise(mesh, (*asset)->view(), seed) : std::string();
}

void check_seeds(std::uint64_t first, std::uint64_t count, SeededMesh (*make)(std::uint64_t)) {
  const test::TemporaryFolder folder;
  std::uint64_t wrong = 0;
  for (std::uint64_t seed = first; seed < first + count; ++seed) {
    const std::string found = wrong_with(make(seed), seed, folder);
    if (!found.empty()) {
      ++wrong;
      std::cerr << "seed " << seed << ": " << found << std::endl;
    }
    const std::uint64_t done = seed + 1 - first;
    if (done % 500 == 0) std::cerr << done << " seeds, " << wrong << " wrong" << std::endl;
  }
  CHECK(wrong == 0);
}

}  // namespace

TEST_CASE("Meshes made by seed bake, and keep the promise by exact winding numbers") {
  check_seeds(1, 30, seeded_mesh);
}

TEST_CASE("Pins in holes that they nearly fit bake, and keep the promise") {
  check_seeds(1, 20, fitted_mesh);
}

TEST_CASE("Meshes made by seeds that were once wrong keep the promise") {
  // A flat side of a sliver runs 2.5 nm beside an edge where one is asked.
  check_seeds(40429, 1, seeded_mesh);
  // Of a gap that was closed, a wall's end stands some um before the foot of the next wall.
  check_seeds(46183, 1, seeded_mesh);
}

TEST_CASE("Pins made by seeds that were once refused keep the promise") {
  // Beside a gap of about the width that is closed, bake and verdict cut walls in other ways.
  for (const std::uint64_t seed : {13, 109, 188, 100140, 101007}) check_seeds(seed, 1, fitted_mesh);
  // Of a wall a hair alone was felt, which rounding let go.
  check_seeds(101376, 1, fitted_mesh);
  // Rounding moved a flat edge of the pin through the wall of its hole.
  for (const std::uint64_t seed : {117, 237, 171, 288}) check_seeds(seed, 1, fitted_mesh);
  // A gap that ends in a wedge, and a sliver in front of which one was closed.
  for (const std::uint64_t seed : {301395, 301329}) check_seeds(seed, 1, fitted_mesh);
}

/// Seeds of which SPM_SEEDS names others, as first:count.
void check_many(const char* usual, SeededMesh (*make)(std::uint64_t)) {
  const char* named = std::getenv("SPM_SEEDS");
  std::istringstream words(named != nullptr ? named : usual);
  std::uint64_t first = 0, count = 0;
  char colon = 0;
  REQUIRE(words >> first >> colon >> count);
  check_seeds(first, count, make);
}

// Take some hours: baker_mesh_tests "[seeds]".
TEST_CASE("Eight thousand meshes made by seed bake, and keep the promise", "[.][seeds][parts]") {
  check_many("1000:8000", seeded_mesh);
}

TEST_CASE("Two thousand pins made by seed bake, and keep the promise", "[.][seeds][pins]") {
  check_many("1000:2000", fitted_mesh);
}

TEST_CASE("Exact winding numbers count overlapping boxes") {
  const test::Shape two = test::merged(test::box({2, 2, 2}), test::box({1, 1, 4}));
  CHECK(exact_winding(two, {0.1, 0.2, 0.1}) == 2);
  CHECK(exact_winding(two, {0.1, 0.2, 1.5}) == 1);
  CHECK(exact_winding(two, {0.7, 0.2, 0.1}) == 1);
  CHECK(exact_winding(two, {0.7, 0.2, 1.5}) == 0);
  CHECK_FALSE(exact_winding(two, {0.5, 0.2, 0}));
}

}  // namespace spm::baker::seeded_meshes_test
