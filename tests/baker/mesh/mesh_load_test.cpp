// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <charconv>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "baker/mesh/load.hpp"
#include "baker/mesh/mesh.hpp"
#include "baker/mesh/triangle_height.hpp"
#include "tests/baker/mesh/mesh_support.hpp"
#include "tests/support/random.hpp"
#include "tests/support/skip.hpp"

namespace spm::test::mesh_load_test {
namespace {

using baker::Mesh;

[[nodiscard]] std::string number(double value) {
  std::array<char, 32> text{};
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
}

[[nodiscard]] std::string position(const Vector3& p, const char* space = " ") {
  return number(p.x()) + space + number(p.y()) + space + number(p.z());
}

[[nodiscard]] std::string as_off(const Shape& shape) {
  std::string text = "OFF # a comment\n" + std::to_string(shape.vertices.size()) + " " +
                     std::to_string(shape.triangles.size()) + " 0\n";
  for (const Vector3& v : shape.vertices) text += position(v) + "\n";
  for (const auto& [a, b, c] : shape.triangles) {
    text += "3 " + std::to_string(a) + " " + std::to_string(b) + " " + std::to_string(c) + "\n";
  }
  return text;
}

[[nodiscard]] std::string as_stl(const Shape& shape) {
  std::string text = "solid shape\n";
  for (const auto& triangle : shape.triangles) {
    text += "facet normal 0 0 0\nouter loop\n";
    for (const auto corner : triangle) text += "vertex " + position(shape.vertices[corner]) + "\n";
    text += "endloop\nendfacet\n";
  }
  return text + "endsolid shape\n";
}

template <class T>
void append(std::string& bytes, T value, bool big_endian = false) {
  std::string raw(reinterpret_cast<const char*>(&value), sizeof value);
  if (big_endian) std::reverse(raw.begin(), raw.end());
  bytes += raw;
}

[[nodiscard]] std::string as_binary_stl(const Shape& shape) {
  std::string bytes = "solid in name only";
  bytes.resize(80, ' ');
  append(bytes, static_cast<std::uint32_t>(shape.triangles.size()));
  for (const auto& triangle : shape.triangles) {
    for (int i = 0; i < 3; ++i) append(bytes, 0.0F);
    for (const auto corner : triangle) {
      for (int i = 0; i < 3; ++i) append(bytes, static_cast<float>(shape.vertices[corner][i]));
    }
    append(bytes, std::uint16_t{0});
  }
  return bytes;
}

[[nodiscard]] std::string ply_header(const Shape& shape, const std::string& format) {
  return "ply\nformat " + format + " 1.0\ncomment a shape\nelement vertex " +
         std::to_string(shape.vertices.size()) +
         "\nproperty double x\nproperty double y\nproperty double z\nproperty uchar red\n"
         "element face " +
         std::to_string(shape.triangles.size()) +
         "\nproperty uchar flags\nproperty list uchar uint vertex_index\nend_header\n";
}

[[nodiscard]] std::string as_ply(const Shape& shape) {
  std::string text = ply_header(shape, "ascii");
  for (const Vector3& v : shape.vertices) text += position(v) + " 255\n";
  for (const auto& [a, b, c] : shape.triangles) {
    text += "0 3 " + std::to_string(a) + " " + std::to_string(b) + " " + std::to_string(c) + "\n";
  }
  return text;
}

[[nodiscard]] std::string as_binary_ply(const Shape& shape, bool big_endian) {
  std::string bytes = ply_header(shape, big_endian ? "binary_big_endian" : "binary_little_endian");
  for (const Vector3& v : shape.vertices) {
    for (int i = 0; i < 3; ++i) append(bytes, v[i], big_endian);
    append(bytes, std::uint8_t{255});
  }
  for (const auto& triangle : shape.triangles) {
    append(bytes, std::uint8_t{0});
    append(bytes, std::uint8_t{3});
    for (const auto corner : triangle) append(bytes, corner, big_endian);
  }
  return bytes;
}

/// Corner positions of each triangle, in the file's order.
[[nodiscard]] std::vector<Vector3> corners(const Mesh& mesh) {
  std::vector<Vector3> all;
  for (const auto& triangle : mesh.triangles) {
    for (const auto corner : triangle) all.push_back(mesh.vertices[corner]);
  }
  return all;
}

[[nodiscard]] Mesh load_text(const std::string& name, const std::string& bytes,
                             const baker::LoadOptions& options = {}) {
  const TemporaryFolder folder;
  return baker::load_mesh(folder.write(name, bytes), options);
}

[[nodiscard]] bool noted(const Mesh& mesh, const std::string& words) {
  return std::any_of(mesh.notes.begin(), mesh.notes.end(), [&](const std::string& note) {
    return note.find(words) != std::string::npos;
  });
}

/// A box whose coordinates floats hold exactly.
[[nodiscard]] Shape float_box() { return moved(box({1, 2, 0.5}), {0.25, 0, 8}); }

}  // namespace

TEST_CASE("All formats load the same triangles") {
  const Shape shape = float_box();
  const std::vector<Vector3> expected = corners(load_shape(shape));
  REQUIRE(expected.size() == 36);
  CHECK(corners(load_text("a.off", as_off(shape))) == expected);
  CHECK(corners(load_text("a.stl", as_stl(shape))) == expected);
  CHECK(corners(load_text("b.stl", as_binary_stl(shape))) == expected);
  CHECK(corners(load_text("a.ply", as_ply(shape))) == expected);
  CHECK(corners(load_text("b.ply", as_binary_ply(shape, false))) == expected);
  CHECK(corners(load_text("c.PLY", as_binary_ply(shape, true))) == expected);
}

TEST_CASE("A soup of separate triangles is merged into a closed mesh") {
  const Mesh mesh = load_text("a.stl", as_stl(float_box()));
  CHECK(mesh.file_vertices == 36);
  CHECK(mesh.vertices.size() == 8);
  CHECK(mesh.closed());
  CHECK(mesh.components == 1);
  CHECK(noted(mesh, "28 vertices merged"));
}

TEST_CASE("Polygons are fanned from their first vertex") {
  const Mesh mesh =
      load_text("a.obj", "v 0 0 0\nv 1 0 0\nv 1.5 1 0\nv 0.5 2 0\nv -0.5 1 0\nf 2 3 4 5 1\n");
  CHECK(mesh.file_triangles == 3);
  const std::vector<Vector3> found = corners(mesh);
  REQUIRE(found.size() == 9);
  for (std::size_t i = 0; i < 9; i += 3) CHECK(found[i] == Vector3(1, 0, 0));
}

TEST_CASE("OBJ's relative indices, slashes, tabs, line ends and continuations are understood") {
  const std::string vertices = "v 0 0 0\r\nv 1 0 0 1.0\r\nv\t0\t1\t0\r\n";
  const Mesh plain = load_text("a.obj", vertices + "f 1 2 3\r\n");
  for (const char* face : {"f -3 -2 -1", "f 1/1/1\t2//7\t3", "f 1/4 2/5 3/6 # end",
                           "l 1 2\nf 1 2 \\\n 3", "vt 0 0\nvn 0 0 1\no x\nusemtl y\nf 1 2 3"}) {
    CHECK(corners(load_text("a.obj", vertices + face)) == corners(plain));
  }
}

TEST_CASE("OFF with counts on its first line and with colours is understood") {
  const std::string body = "0 0 0 255 0 0\n1 0 0 255 0 0\n\n# between\n0 1 0 9 9 9\n3 0 1 2 0.5\n";
  CHECK(load_text("a.off", "OFF 3 1 0\n" + body).triangles.size() == 1);
  CHECK(load_text("a.off", "COFF\n3 1 0\n" + body).triangles.size() == 1);
}

TEST_CASE("An inverted mesh is turned") {
  const Mesh mesh = load_shape(turned_inside_out(sphere(1, 2)));
  CHECK(mesh.inverted_components == 1);
  CHECK(signed_volume(mesh.vertices, mesh.triangles) > 0);
  CHECK(noted(mesh, "inside out"));
}

TEST_CASE("An inverted open mesh is turned, and one that faces outward is not") {
  Shape bowl = sphere(1, 3);
  std::erase_if(bowl.triangles, [&](const auto& t) { return bowl.vertices[t[0]].z() > 0.6; });
  const Mesh right = load_shape(bowl);
  CHECK(right.inverted_components == 0);
  CHECK(!right.closed());
  const Mesh turned = load_shape(turned_inside_out(bowl));
  CHECK(turned.inverted_components == 1);
  CHECK(signed_volume(turned.vertices, turned.triangles) > 1);
}

TEST_CASE("Triangles that disagree with their neighbours are reversed") {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    RandomTwister random(seed);
    Shape shape = sphere(1, 2);
    for (auto& triangle : shape.triangles) {
      if (random.unit() < 0.4) std::swap(triangle[0], triangle[1]);
    }
    const Mesh mesh = load_shape(shape);
    CHECK(mesh.closed());
    CHECK(signed_volume(mesh.vertices, mesh.triangles) > 3.5);
  }
}

TEST_CASE("A shell that bounds a cavity keeps facing it") {
  const Shape cavity = merged(sphere(1, 2), turned_inside_out(sphere(0.5, 2)));
  const Mesh mesh = load_shape(cavity);
  CHECK(mesh.components == 2);
  CHECK(mesh.inverted_components == 0);
  const double solid = signed_volume(mesh.vertices, mesh.triangles);
  CHECK(solid < signed_volume(sphere(1, 2).vertices, sphere(1, 2).triangles));
  SECTION("also where the whole file is inverted") {
    const Mesh inverted = load_shape(turned_inside_out(cavity));
    CHECK(inverted.inverted_components == 2);
    CHECK(signed_volume(inverted.vertices, inverted.triangles) == Approx(solid));
  }
}

TEST_CASE("Of nested shells that all face inward all are turned") {
  const Shape nested =
      turned_inside_out(merged(sphere(1, 2), merged(sphere(0.5, 2), sphere(0.2, 2))));
  const Mesh mesh = load_shape(nested);
  CHECK(mesh.inverted_components == 3);
}

TEST_CASE("An inverted part beside a right one is turned alone") {
  const Mesh mesh =
      load_shape(merged(sphere(1, 2), turned_inside_out(moved(sphere(1, 2), {3, 0, 0}))));
  CHECK(mesh.inverted_components == 1);
  CHECK(signed_volume(mesh.vertices, mesh.triangles) > 7);
}

TEST_CASE("An inverted solid within a cavity is turned") {
  const Shape shape = merged(merged(sphere(1, 2), turned_inside_out(sphere(0.5, 2))),
                             turned_inside_out(sphere(0.2, 2)));
  const Mesh mesh = load_shape(shape);
  CHECK(mesh.inverted_components == 1);
}

TEST_CASE("A mesh that is open far is a sheet, and its border edges are counted") {
  Shape open = box({1, 1, 1});
  open.triangles.resize(open.triangles.size() - 2);
  const Mesh mesh = load_shape(open);
  CHECK(!mesh.closed());
  CHECK(mesh.border_edges == 4);
  CHECK(mesh.sheet_triangles == 10);
  CHECK(noted(mesh, "taken for a sheet"));
}

TEST_CASE("Polygons with notches are spanned without folds, whatever corner comes first") {
  // A prism over a polygon with two notches. Fans from most of its corners fold.
  const std::vector<Vector3> outline{{0, 0, 0}, {4, 0, 0}, {4, 3, 0}, {3, 3, 0}, {3, 1, 0},
                                     {2, 1, 0}, {2, 2, 0}, {1, 2, 0}, {1, 3, 0}, {0, 3, 0}};
  const std::size_t count = outline.size();
  for (std::size_t first = 0; first < count; ++first) {
    std::string text, low = "f", high = "f";
    for (std::size_t i = 0; i < count; ++i) {
      const Vector3& corner = outline[(first + i) % count];
      // The top is not quite flat.
      const double height = 1 + 1e-3 * static_cast<double>(i % 3);
      text += fmt::format("v {0} {1} 0\nv {0} {1} {2}\n", corner.x(), corner.y(), height);
      high += fmt::format(" {}", 2 * i + 2);
      low += fmt::format(" {}", 2 * (count - i) - 1);
      const std::size_t next = (i + 1) % count;
      text += fmt::format("f {} {} {} {}\n", 2 * i + 1, 2 * next + 1, 2 * next + 2, 2 * i + 2);
    }
    const TemporaryFolder folder;
    const Mesh mesh = baker::load_mesh(
        folder.write("notched.obj", fmt::format("{}{}\n{}\n", text, low, high)), {});
    CHECK(mesh.closed());
    double area = 0;
    for (const auto& [a, b, c] : mesh.triangles) {
      area += baker::triangle_area(mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]);
    }
    CHECK(area == Approx(2 * 9 + 18).epsilon(1e-3));
    CHECK(signed_volume(mesh.vertices, mesh.triangles) == Approx(9).epsilon(2e-3));
  }
}

TEST_CASE("Zero-area and duplicated triangles and unreferenced vertices are dropped") {
  Shape shape = box({1, 1, 1});
  shape.triangles.push_back(shape.triangles[3]);
  shape.triangles.push_back({0, 0, 1});
  shape.vertices.emplace_back(9, 9, 9);
  const Mesh mesh = load_shape(shape);
  CHECK(mesh.dropped_triangles == 2);
  CHECK(mesh.triangles.size() == 12);
  CHECK(mesh.vertices.size() == 8);
  CHECK(mesh.box_max == Vector3(0.5, 0.5, 0.5));
  CHECK(mesh.closed());
}

TEST_CASE("A triangle without area between two others leaves the mesh closed") {
  // The middle of an edge of the box's top is used from one side only; the other side is joined to
  // it by a triangle on a line.
  Shape shape = box({2, 2, 2});
  shape.vertices.emplace_back(0, 1, 1);
  std::erase(shape.triangles, std::array<std::uint32_t, 3>{5, 7, 6});
  shape.triangles.push_back({5, 7, 8});
  shape.triangles.push_back({5, 8, 6});
  shape.triangles.push_back({6, 8, 7});
  const Mesh mesh = load_shape(shape);
  CHECK(mesh.closed());
  CHECK(mesh.dropped_triangles == 1);
  CHECK(mesh.triangles.size() == 13);
}

TEST_CASE("A wall between two parts that share it is dropped") {
  const Mesh mesh = load_shape(merged(box({1, 1, 1}), moved(box({1, 1, 1}), {1, 0, 0})));
  CHECK(mesh.closed());
  CHECK(mesh.components == 1);
  CHECK(signed_volume(mesh.vertices, mesh.triangles) == Approx(2));
  CHECK(area(mesh.vertices, mesh.triangles) == Approx(10));
}

TEST_CASE("A face that two parts share and that faces the same way stays on both") {
  // Flush boxes, the second one twice as deep: dropping a copy would open one of them.
  Shape deep = box({1, 1, 1});
  for (Vector3& vertex : deep.vertices) vertex.x() = vertex.x() > 0 ? 0.5 : -1.5;
  const Mesh mesh = load_shape(merged(box({1, 1, 1}), deep));
  CHECK(mesh.closed());
  CHECK(signed_volume(mesh.vertices, mesh.triangles) == Approx(3));
}

TEST_CASE("Of a volume mesh whose faces are all there once the outer ones stay, and face outward") {
  // A cube of 3 x 3 x 3, each of six tetrahedra along its diagonal; faces turned by their number.
  constexpr std::uint32_t along = 3;
  const auto corner = [](std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    return (x * (along + 1) + y) * (along + 1) + z;
  };
  Shape shape;
  std::set<std::array<std::uint32_t, 3>> faces;
  for (std::uint32_t x = 0; x <= along; ++x) {
    for (std::uint32_t y = 0; y <= along; ++y) {
      for (std::uint32_t z = 0; z <= along; ++z) shape.vertices.emplace_back(x, y, z);
    }
  }
  for (std::uint32_t cube = 0; cube < along * along * along; ++cube) {
    const std::array<std::uint32_t, 3> at{cube % along, cube / along % along, cube / along / along};
    std::array<std::size_t, 3> axes{0, 1, 2};
    do {
      std::array<std::uint32_t, 3> step = at;
      std::vector<std::uint32_t> tetrahedron{corner(step[0], step[1], step[2])};
      for (const std::size_t axis : axes) {
        ++step[axis];
        tetrahedron.push_back(corner(step[0], step[1], step[2]));
      }
      for (std::size_t out = 0; out < 4; ++out) {
        std::vector<std::uint32_t> face = tetrahedron;
        face.erase(face.begin() + static_cast<std::ptrdiff_t>(out));
        faces.insert({face[0], face[1], face[2]});
      }
    } while (std::next_permutation(axes.begin(), axes.end()));
  }
  for (const auto& [a, b, c] : faces) {
    if (shape.triangles.size() % 3 == 0) {
      shape.triangles.push_back({a, c, b});
    } else {
      shape.triangles.push_back({a, b, c});
    }
  }
  const Mesh mesh = load_shape(shape);
  CHECK(mesh.triangles.size() == std::size_t{12} * along * along);
  CHECK(mesh.closed());
  CHECK(mesh.components == 1);
  CHECK(signed_volume(mesh.vertices, mesh.triangles) == Approx(along * along * along));
  CHECK(area(mesh.vertices, mesh.triangles) == Approx(6 * along * along));
}

TEST_CASE("Boxes that touch along an edge both stay") {
  const Mesh mesh = load_shape(merged(box({1, 1, 1}), moved(box({1, 1, 1}), {1, 1, 0})));
  CHECK(mesh.triangles.size() == 24);
  CHECK(signed_volume(mesh.vertices, mesh.triangles) == Approx(2));
}

TEST_CASE("A face that is repeated the other way round leaves the mesh closed") {
  Shape shape = box({1, 2, 3});
  for (const std::size_t repeated : {0U, 1U}) {
    const auto [a, b, c] = shape.triangles[repeated];
    shape.triangles.push_back({a, c, b});
  }
  const Mesh mesh = load_shape(shape);
  CHECK(mesh.triangles.size() == 12);
  CHECK(mesh.dropped_triangles == 2);
  CHECK(mesh.border_edges == 0);
  CHECK(signed_volume(mesh.vertices, mesh.triangles) == Approx(6));
}

TEST_CASE("A mesh drawn from both sides keeps one of them") {
  const Shape shape = sphere(1, 2);
  const Mesh mesh = load_shape(merged(shape, turned_inside_out(shape)));
  CHECK(mesh.triangles.size() == shape.triangles.size());
  CHECK(signed_volume(mesh.vertices, mesh.triangles) > 3.5);
}

TEST_CASE("Unit and fitted diagonal scale about the origin") {
  const Shape shape = moved(box({1, 2, 2}), {5, 0, 0});
  const Mesh millimetres = load_shape(shape, {.unit = 0.001, .fit_diagonal = {}});
  CHECK(millimetres.diagonal == Approx(0.003));
  CHECK(millimetres.box_min.x() == Approx(0.0045));
  CHECK(millimetres.unit == 0.001);
  CHECK(millimetres.scale == 1);
  const Mesh fitted = load_shape(shape, {.unit = 0.001, .fit_diagonal = 0.1});
  CHECK(fitted.diagonal == Approx(0.1).epsilon(1e-12));
  CHECK(fitted.scale == Approx(0.1 / 0.003));
  CHECK(fitted.box_min.x() == Approx(0.0045 * 0.1 / 0.003));
}

TEST_CASE("Very small and very large coordinates load") {
  for (const double size : {1e-6, 1e6}) {
    const Mesh mesh = load_shape(sphere(size, 2));
    CHECK(mesh.triangles.size() == 320);
    CHECK(mesh.closed());
    CHECK(mesh.dropped_triangles == 0);
  }
}

TEST_CASE("The hash is that of the file's bytes") {
  CHECK(load_text("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").sha256 ==
        "697b00ab13410c52a542d2e9c63711fcc04e9cbf6c0d3439a9b43cc812e6e713");
}

TEST_CASE("The shared meshes load with the counts that are known of them") {
  struct Known {
    const char* file;
    std::size_t triangles, borders;
    std::uint32_t components;
  };
  const char* environment = std::getenv("SPM_SHARED");
  const std::filesystem::path folder =
      std::filesystem::path(environment != nullptr ? environment : SPM_SHARED_FOLDER) / "meshes";
  if (!std::filesystem::is_directory(folder)) {
    SPM_SKIP("there are no shared meshes in " << folder.string());
  }
  for (const Known& known : {Known{"galleon.obj", 4698, 330, 12}, Known{"teeth.obj", 23008, 0, 17},
                             Known{"drill.obj", 514, 0, 1}, Known{"duck.obj", 4212, 0, 1},
                             Known{"stanford-bunny.obj", 69451, 223, 1}}) {
    const Mesh mesh = baker::load_mesh((folder / known.file).string(), {});
    CHECK(mesh.file_triangles == known.triangles);
    CHECK(mesh.closed());
    CHECK(mesh.border_edges == known.borders);
    CHECK(mesh.components == known.components);
    CHECK(mesh.inverted_components == 0);
  }
}

}  // namespace spm::test::mesh_load_test
