// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/methods/mesh_proxy.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "common/base/random.hpp"
#include "tests/baker/verify/verify_shapes.hpp"
#include "tests/bench/model/bumpy_sphere.hpp"
#include "tests/support/shapes.hpp"

namespace mesh_proxy_test {

namespace {

using namespace spm;
using namespace spm::bench;

const Vector3 box_size(0.02, 0.016, 0.012);
constexpr double skin = 3e-7;  // m: the gap of a proxy to the surface, plus rounding

FloatMesh mesh_of(const test::Shape& shape) {
  baker::OuterSurface surface;
  surface.vertices = shape.vertices;
  surface.triangles = shape.triangles;
  surface.solid_count = shape.triangles.size();
  return FloatMesh(surface);
}

MeshProxyOptions options_of(bool tree, bool shading, double radius) {
  MeshProxyOptions options;
  options.tree = tree;
  options.shading = shading;
  options.radius = radius;
  return options;
}

/// Both searches, without shading, as a point and as a ball.
std::vector<MeshProxyOptions> plain_options() {
  return {options_of(true, false, 0), options_of(false, false, 0), options_of(true, false, 0.5e-3),
          options_of(false, false, 0.5e-3)};
}

}  // namespace

TEST_CASE("A proxy pressed into a box is held on its face, above the tool") {
  for (const MeshProxyOptions& options : plain_options()) {
    INFO(to_string(options));
    const auto proxy = make_mesh_proxy(mesh_of(test::box(box_size)), options);
    proxy->place({0.001, 0.002, 0.008});
    CHECK_FALSE(proxy->follow({0.001, 0.002, 0.0075}).contact);
    const ProxyContact contact = proxy->follow({0.001, 0.002, 0.0045});
    REQUIRE(contact.contact);
    CHECK(contact.depth == Approx(0.0015 + options.radius).margin(skin));
    CHECK((contact.normal - Vector3::UnitZ()).norm() < 1e-6);
    CHECK((contact.force - options.stiffness * contact.depth * Vector3::UnitZ()).norm() < 1e-6);
    CHECK(contact.proxy.z() == Approx(box_size.z() / 2 + options.radius).margin(skin));
  }
}

TEST_CASE("A proxy slides over a face with its tool") {
  for (const MeshProxyOptions& options : plain_options()) {
    INFO(to_string(options));
    const auto proxy = make_mesh_proxy(mesh_of(test::box(box_size)), options);
    proxy->place({-0.007, -0.006, 0.008});
    for (int i = 0; i <= 140; ++i) {
      const Vector3 tool(-0.007 + 1e-4 * i, -0.006 + 0.8e-4 * i, 0.005);
      const ProxyContact contact = proxy->follow(tool);
      REQUIRE(contact.contact);
      CHECK((contact.proxy - tool).head<2>().norm() < skin);
      CHECK(contact.depth == Approx(0.001 + options.radius).margin(skin));
    }
  }
}

TEST_CASE("A proxy stays on the side it came from, however thin the wall") {
  const test::Shape sheet = test::plate({0.02, 0.02, 0.0002});
  for (const MeshProxyOptions& options : plain_options()) {
    INFO(to_string(options));
    const auto proxy = make_mesh_proxy(mesh_of(sheet), options);
    proxy->place({0, 0, 0.002});
    for (int i = 0; i < 60; ++i) {
      const ProxyContact contact = proxy->follow({1e-4 * i, 0, 0.002 - 1e-4 * i});
      CHECK(contact.proxy.z() > 0.0001 + options.radius);
    }
  }
}

TEST_CASE("Three planes hold a proxy in a corner") {
  // From inside: the triangles of the box stop it from both sides.
  for (const MeshProxyOptions& options : plain_options()) {
    INFO(to_string(options));
    const auto proxy = make_mesh_proxy(mesh_of(test::box(box_size)), options);
    proxy->place(Vector3::Zero());
    const Vector3 tool = box_size / 2 + Vector3(0.001, 0.0012, 0.0014);
    ProxyContact contact;
    for (int i = 0; i < 4; ++i) contact = proxy->follow(tool);
    const Vector3 corner = box_size / 2 - Vector3::Constant(options.radius);
    CHECK((contact.proxy - corner).norm() < 2 * skin);
  }
}

TEST_CASE("No path brings a proxy into a solid") {
  const test::Shape ball = test::sphere(0.012, 3);
  double least = 1;
  for (const auto& triangle : ball.triangles) {
    const Vector3 middle =
        (ball.vertices[triangle[0]] + ball.vertices[triangle[1]] + ball.vertices[triangle[2]]) / 3;
    least = std::min(least, middle.norm());
  }
  for (const bool shading : {false, true}) {
    for (const double radius : {0.0, 0.5e-3}) {
      const auto proxy = make_mesh_proxy(mesh_of(ball), options_of(true, shading, radius));
      proxy->place({0, 0, 0.014});
      Vector3 tool(0, 0, 0.014);
      for (std::uint64_t i = 0; i < 3000; ++i) {
        const Vector3 step = direction_of(random_unit(3, 2 * i), random_unit(3, 2 * i + 1));
        tool += 0.4e-3 * step;
        if (tool.norm() > 0.014) tool *= 0.9;
        const ProxyContact contact = proxy->follow(tool);
        CHECK(contact.proxy.norm() > least + 0.99 * radius);
      }
    }
  }
}

TEST_CASE("A tree finds what looking at all triangles finds") {
  const baker::Mesh mesh = bumpy_sphere(3);
  baker::OuterSurface surface;
  surface.vertices = mesh.vertices;
  surface.triangles = mesh.triangles;
  surface.solid_count = mesh.triangles.size();
  const std::vector<Vector3> path = bumpy_slide(400, 1e-3);
  for (const double radius : {0.0, 0.5e-3}) {
    const auto tree = make_mesh_proxy(FloatMesh(surface), options_of(true, true, radius));
    const auto all = make_mesh_proxy(FloatMesh(surface), options_of(false, true, radius));
    tree->place(1.05 * path.front());
    all->place(1.05 * path.front());
    std::size_t contacts = 0;
    for (const Vector3& tool : path) {
      const ProxyContact a = tree->follow(tool), b = all->follow(tool);
      contacts += a.contact ? 1 : 0;
      // If two triangles hold it equally, either may be found first.
      CHECK((a.proxy - b.proxy).norm() < 5e-6);
    }
    CHECK(contacts > 300);
    CHECK(tree->bytes() > all->bytes());
  }
}

TEST_CASE("Shading turns forces from the triangle's normal towards the surface's") {
  const test::Shape ball = test::sphere(0.012, 2);
  const auto plain = make_mesh_proxy(mesh_of(ball), options_of(true, false, 0));
  const auto shaded = make_mesh_proxy(mesh_of(ball), options_of(true, true, 0));
  double plain_sum = 0, shaded_sum = 0;
  for (std::uint64_t i = 0; i < 200; ++i) {
    const Vector3 out = direction_of(random_unit(9, 2 * i), random_unit(9, 2 * i + 1));
    for (auto* proxy : {plain.get(), shaded.get()}) {
      proxy->place(0.013 * out);
      ProxyContact contact;
      for (int tick = 0; tick < 5; ++tick) contact = proxy->follow(0.0105 * out);
      REQUIRE(contact.contact);
      (proxy == plain.get() ? plain_sum : shaded_sum) +=
          std::acos(std::min(1.0, contact.normal.dot(out)));
    }
  }
  CHECK(shaded_sum < 0.5 * plain_sum);
}

TEST_CASE("The force of a triangle that is given is that of the box's face") {
  const auto proxy = make_mesh_proxy(mesh_of(test::box(box_size)), options_of(true, false, 0.5e-3));
  proxy->place({0.001, 0.002, 0.008});
  const Vector3 tool(0.001, 0.002, 0.0045);
  const ProxyContact followed = proxy->follow(tool);
  const ProxyContact given = proxy->force_at(tool, proxy->last_triangle());
  CHECK(given.contact);
  CHECK((given.force - followed.force).norm() < 1e-3);
}

}  // namespace mesh_proxy_test
