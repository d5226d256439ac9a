// SPDX-License-Identifier: GPL-3.0-or-later
// Files as other programs write them: what bends the rules of its format, and can be read all the
// same.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cstdlib>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "baker/base/bake_error.hpp"
#include "baker/mesh/load.hpp"
#include "tests/baker/mesh/mesh_support.hpp"
#include "tests/support/skip.hpp"

namespace spm::test::mesh_wild_test {
namespace {

using baker::Mesh;

const std::string tetrahedron_obj =
    "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
const std::string ply_points =
    "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n";
const std::string ply_body = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n";

Mesh load(const std::string& name, const std::string& bytes) {
  const TemporaryFolder folder;
  return baker::load_mesh(folder.write(name, bytes), {});
}

std::string refusal(const std::string& name, const std::string& bytes) {
  try {
    (void)load(name, bytes);
  } catch (const baker::BakeError& error) {
    CHECK(error.code() == ExitCode::invalid_input);
    return error.what();
  }
  return "it was loaded";
}

bool noted(const Mesh& mesh, const std::string& words) {
  return std::any_of(mesh.notes.begin(), mesh.notes.end(), [&](const std::string& note) {
    return note.find(words) != std::string::npos;
  });
}

void check_is_tetrahedron(const Mesh& mesh) {
  CHECK(mesh.triangles.size() == 4);
  CHECK(mesh.closed());
  CHECK(signed_volume(mesh.vertices, mesh.triangles) == Approx(1.0 / 6));
}

/// A text STL of the tetrahedron, in which the words are spelt as given.
std::string stl(const std::string& end_loop, const std::string& end_facet,
                const std::string& end_solid) {
  const char* corners[4] = {"0 0 0", "1 0 0", "0 1 0", "0 0 1"};
  const int faces[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  std::string text = "solid corner\n";
  for (const auto& face : faces) {
    text += "facet normal 0 0 0\nouter loop\n";
    for (const int corner : face) text.append("vertex ").append(corners[corner]).append("\n");
    text.append(end_loop).append("\n").append(end_facet).append("\n");
  }
  return text + end_solid + " corner\n";
}

std::string upper(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return text;
}

std::string binary_stl(const std::string& header) {
  std::string bytes = header;
  bytes.resize(80, ' ');
  bytes += std::string("\4\0\0\0", 4);
  const float corners[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const int faces[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  for (const auto& face : faces) {
    bytes += std::string(12, '\0');
    for (const int corner : face) {
      bytes.append(reinterpret_cast<const char*>(corners[corner]), sizeof corners[corner]);
    }
    bytes += std::string(2, '\0');
  }
  return bytes;
}

std::string utf16(const std::string& text, bool big_endian) {
  std::string bytes = big_endian ? "\xFE\xFF" : "\xFF\xFE";
  for (const char c : text) {
    if (big_endian) bytes += '\0';
    bytes += c;
    if (!big_endian) bytes += '\0';
  }
  return bytes;
}

std::string ply(const std::string& format, const std::string& elements, const std::string& body) {
  return "ply\nformat " + format + " 1.0\n" + ply_points + elements + "end_header\n" + body;
}

}  // namespace

TEST_CASE("A text STL is read in capitals and with its ends in two words") {
  check_is_tetrahedron(load("a.stl", upper(stl("endloop", "endfacet", "endsolid"))));
  check_is_tetrahedron(load("a.stl", stl("end loop", "end facet", "end solid")));
  check_is_tetrahedron(load("a.stl", stl("EndLoop", "EndFacet", "EndSolid")));
  CHECK_THAT(refusal("a.obj", upper(stl("endloop", "endfacet", "endsolid"))),
             Catch::Contains("looks like STL"));
}

TEST_CASE("A few bytes behind a binary STL are a note, and those of a triangle are a refusal") {
  const std::string bytes = binary_stl("solid in name only");
  check_is_tetrahedron(load("a.stl", bytes));
  for (const std::size_t count : {1U, 2U, 49U}) {
    const Mesh mesh = load("a.stl", bytes + std::string(count, '\n'));
    check_is_tetrahedron(mesh);
    CHECK(noted(mesh, "Bytes behind the triangles"));
  }
  CHECK_THAT(refusal("a.stl", bytes + std::string(50, '\0')), Catch::Contains("announces 4"));
  CHECK_THAT(refusal("a.stl", bytes.substr(0, bytes.size() - 1)), Catch::Contains("announces 4"));
}

TEST_CASE("The triangle strips of a PLY are read, each cut off by -1") {
  // 0 2 1 3 0 2: each three in a row are a face, every other one reversed.
  const std::string elements = "element tristrips 1\nproperty list int int vertex_indices\n";
  const Mesh mesh = load("a.ply", ply("ascii", elements, ply_body + "6 0 2 1 3 0 2\n"));
  check_is_tetrahedron(mesh);
  CHECK(mesh.inverted_components == 0);
  check_is_tetrahedron(
      load("a.ply", ply("ascii", elements, ply_body + "15 0 2 1 -1 0 1 3 -1 0 3 2 -1 1 2 3\n")));
  CHECK_THAT(refusal("a.ply", ply("ascii", elements, ply_body + "4 0 2 1 4\n")),
             Catch::Contains("vertex index 4 is out of range"));
}

TEST_CASE("The lists of a PLY may have lengths of any whole type") {
  for (const char* type : {"uint uint", "int32 uint32", "ushort short", "uchar uchar"}) {
    const std::string elements =
        std::string("element face 4\nproperty list ") + type + " vertex_indices\n";
    check_is_tetrahedron(
        load("a.ply", ply("ascii", elements, ply_body + "3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n")));
  }
}

TEST_CASE("What is broken behind the faces of a PLY does not matter") {
  const std::string faces = "element face 4\nproperty list uchar int vertex_indices\n";
  const std::string body = ply_body + "3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
  SECTION("an element that is cut short") {
    const std::string extra = "element edge 3\nproperty int a\nproperty int b\n";
    check_is_tetrahedron(load("a.ply", ply("ascii", faces + extra, body + "0 1\n2")));
    check_is_tetrahedron(load("a.ply", ply("ascii", faces + extra, body + "no numbers\n")));
  }
  SECTION("values of a face that are not what the header says") {
    const std::string colours = "property uchar red\nproperty uchar green\n";
    const Mesh mesh = load("a.ply", ply("ascii", faces + colours,
                                        ply_body + "3 0 2 1 3 255 1 1\n3 0 1 3 2 1 1\n"
                                                   "3 0 3 2 nothing\n3 1 2 3\n"));
    check_is_tetrahedron(mesh);
    CHECK(noted(mesh, "behind the vertex indices"));
  }
  SECTION("but vertices and indices are read whole, or not at all") {
    const std::string colours = "property uchar red\n";
    CHECK_THAT(refusal("a.ply", ply("ascii", faces + colours,
                                    ply_body + "3 0 2 1 x\n3 0 1 3 x\n3 0 3 2 x\n3 1 2 4 x\n")),
               Catch::Contains("line 15"));
    CHECK_THAT(refusal("a.ply", ply("ascii", faces + colours, ply_body + "3 0 2 1 x\n3 0 1 3\n")),
               Catch::Contains("line 15"));
  }
}

TEST_CASE("An OBJ in UTF-16 is read by its byte order mark") {
  for (const bool big_endian : {false, true}) {
    check_is_tetrahedron(load("a.obj", utf16("# a corner\r\n" + tetrahedron_obj, big_endian)));
    CHECK_THAT(refusal("a.obj", utf16("v 0 0 x\n", big_endian)), Catch::Contains("line 1"));
  }
  CHECK_THAT(refusal("a.obj", utf16(tetrahedron_obj, false) + "x"), Catch::Contains("UTF-16"));
}

TEST_CASE("Lines, points and faces of one vertex beside an OBJ's faces are left out") {
  const Mesh mesh = load("a.obj", tetrahedron_obj + "l 1 2 3\np 1\nf 2\nf 3/1\n");
  check_is_tetrahedron(mesh);
  CHECK(noted(mesh, "2 faces of a single vertex"));
  CHECK_THAT(refusal("a.obj", "v 0 0 0\nf 1\n"), Catch::Contains("no face"));
}

TEST_CASE("The header of an OFF may be indented, and its counts joined to its first word") {
  const std::string body = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
  for (const char* header :
       {"\t   OFF\n4 4 0\n", "OFF4 4 6 # or not\n", "\n\n  OFF 4\n\t4 6\n", "COFF 4 4 6\v\n"}) {
    check_is_tetrahedron(load("a.off", header + body));
  }
  CHECK_THAT(refusal("a.off", "OFFICE\n4 4 0\n" + body), Catch::Contains("first word is not OFF"));
  CHECK_THAT(refusal("a.off", "4OFF 4 4 6\n" + body), Catch::Contains("3 dimensions"));
}

TEST_CASE("Each file that others wrote is loaded, or refused with one sentence") {
  const char* environment = std::getenv("SPM_SHARED");
  const std::filesystem::path wild =
      std::filesystem::path(environment != nullptr ? environment : SPM_SHARED_FOLDER) /
      "meshes/wild";
  if (!std::filesystem::is_directory(wild)) {
    SPM_SKIP("there are no meshes of others in " << wild.string());
  }
  const std::set<std::string> refused = {"Cray_right.obj", "cube_unknown_required.gltf",
                                         "huge.obj"};
  for (const char* folder : {"public", "made"}) {
    for (const auto& entry : std::filesystem::directory_iterator(wild / folder)) {
      if (entry.path().extension() == ".bin") continue;
      const std::string path = entry.path().string();
      CAPTURE(path);
      try {
        const Mesh mesh = baker::load_mesh(path, {});
        CHECK(refused.count(entry.path().filename().string()) == 0);
        CHECK(!mesh.triangles.empty());
      } catch (const baker::BakeError& error) {
        const std::string message = error.what();
        CAPTURE(message);
        CHECK(refused.count(entry.path().filename().string()) == 1);
        CHECK(error.code() == ExitCode::invalid_input);
        CHECK(message.starts_with(path + ": "));
        CHECK(std::count(message.begin(), message.end(), '\n') == 0);
        CHECK(message.find("; ") != std::string::npos);
      }
    }
  }
}

}  // namespace spm::test::mesh_wild_test
