// SPDX-License-Identifier: GPL-3.0-or-later
#include <sys/stat.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <cstring>
#include <string>
#include <vector>

#include "baker/base/bake_error.hpp"
#include "baker/mesh/load.hpp"
#include "baker/mesh/mesh.hpp"
#include "tests/baker/mesh/mesh_support.hpp"
#include "tests/support/as_nobody.hpp"
#include "tests/support/random.hpp"
#include "tests/support/skip.hpp"

namespace spm::test::mesh_bad_input_test {
namespace {

struct BadMesh {
  std::string what;  ///< names the case
  std::string file;
  std::string content;
  std::string expected;  ///< what the message must say: the place or the cause
};

const std::string kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

[[nodiscard]] std::string binary_stl(std::uint32_t announced, std::size_t bytes) {
  std::string file(80, 'x');
  file.append(reinterpret_cast<const char*>(&announced), sizeof announced);
  file.resize(bytes, '\1');
  return file;
}

[[nodiscard]] std::string binary_stl_with_nan() {
  std::string file = binary_stl(1, 134);
  const std::uint32_t nan = 0x7FC00000U;
  std::memcpy(file.data() + 96, &nan, sizeof nan);
  return file;
}

[[nodiscard]] std::string ply(const std::string& format, const std::string& vertices,
                              const std::string& faces, const std::string& body) {
  return "ply\nformat " + format + " 1.0\nelement vertex " + vertices +
         "\nproperty float x\nproperty float y\nproperty float z\nelement face " + faces +
         "\nproperty list uchar int vertex_indices\nend_header\n" + body;
}

[[nodiscard]] std::vector<BadMesh> text_cases() {
  return {
      {"empty", "a.obj", "", "is empty"},
      {"only comments", "a.obj", "# nothing\n\n", "no face"},
      {"no face", "a.obj", kTriangle, "no face"},
      {"no vertex", "a.obj", "f 1 2 3\n", "line 1: vertex index 1 is out of range"},
      {"index out of range", "a.obj", kTriangle + "f 1 2 3\nf 1 2 90\n",
       "line 5: vertex index 90 is out of range (3 vertices)"},
      {"index zero", "a.obj", kTriangle + "f 0 1 2\n", "line 4: vertex index 0"},
      {"relative index before the first", "a.obj", kTriangle + "f -1 -2 -4\n",
       "line 4: vertex index -4"},
      {"index with letters", "a.obj", kTriangle + "f 1 2 x\n", "line 4: vertex index 'x'"},
      {"huge index", "a.obj", kTriangle + "f 1 2 99999999999999999999999\n", "line 4"},
      {"face of two", "a.obj", kTriangle + "f 1 2\n", "line 4: face with 2 vertices"},
      {"not a number", "a.obj", "v 0 nan 0\n" + kTriangle + "f 2 3 4\n", "line 1"},
      {"infinite", "a.obj", kTriangle + "v 0 inf 0\nf 1 2 3\n", "line 4: coordinate 'inf'"},
      {"overflow", "a.obj", kTriangle + "v 0 1e999 0\nf 1 2 3\n", "line 4: coordinate '1e999'"},
      {"words for numbers", "a.obj", "v a b c\nf 1 2 3\n", "line 1: coordinate 'a' is no number"},
      {"decimal commas", "a.obj", "v 0,5 0 0\n" + kTriangle + "f 1 2 3\n", "'0,5' is no number"},
      {"two coordinates", "a.obj", "v 0 0\nf 1 1 1\n", "line 1: vertex has 2 coordinates"},
      {"all zero area", "a.obj", "v 0 0 0\nv 1 1 1\nv 2 2 2\nf 1 2 3\n", "has an area"},
      {"all in one point", "a.obj", "v 1 1 1\nv 1 1 1\nv 1 1 1\nf 1 2 3\n", "has an area"},
      {"binary garbage", "a.obj",
       std::string("\x7f"
                   "ELF\0\1\2\3garbage\0\0",
                   17),
       "byte 4"},
      {"far too large", "a.obj", "v 0 0 0\nv 1e12 0 0\nv 0 1e12 0\nf 1 2 3\n", "--unit"},
      {"OBJ named STL", "a.stl", kTriangle + "f 1 2 3\n", "looks like OBJ"},
      {"PLY named OBJ", "a.obj", ply("ascii", "0", "0", ""), "looks like PLY"},
      {"OFF named PLY", "a.ply", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", "looks like OFF"},
      {"STL named OFF", "a.off", "solid a\nfacet normal 0 0 1\n", "looks like STL"},
      {"unknown extension", "a.txt", kTriangle + "f 1 2 3\n", "extension '.txt'"},
      {"no extension", "mesh", kTriangle + "f 1 2 3\n", "rename the file to end in .obj"},
      {"nothing like a mesh", "a.dat", "hello\n", "neither its extension nor its content"},
      {"OFF cut in its vertices", "a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n", "before vertex 2"},
      {"OFF cut in its faces", "a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n", "before face 0"},
      {"OFF index out of range", "a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n",
       "line 6: vertex index 3 is out of range"},
      {"OFF count beyond the file", "a.off", "OFF\n3000000000 1 0\n0 0 0\n", "more than the file"},
      {"OFF negative count", "a.off", "OFF\n-3 1 0\n", "negative"},
      {"OFF with another first word", "a.off", "OOF\n3 1 0\n", "first word is not OFF"},
      {"PLY header cut", "a.ply", "ply\nformat ascii 1.0\nelement vertex 3\n", "end_header"},
      {"PLY of unknown format", "a.ply", ply("morse", "0", "0", ""), "line 2"},
      {"PLY without coordinates", "a.ply",
       "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n0\n",
       "no property y"},
      {"PLY without faces", "a.ply",
       "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
       "property float z\nend_header\n0 0 0\n",
       "no face"},
      {"PLY text cut", "a.ply", ply("ascii", "3", "1", "0 0 0\n1 0 0\n0 1 0\n3 0 1"), "cut short"},
      {"PLY index out of range", "a.ply", ply("ascii", "3", "1", "0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n"),
       "line 13: vertex index 7"},
      {"PLY not finite", "a.ply", ply("ascii", "3", "1", "0 0 0\n1 nan 0\n0 1 0\n3 0 1 2\n"),
       "line 11"},
      {"PLY binary cut", "a.ply",
       ply("binary_little_endian", "3", "1", std::string(36, '\0') + "\3\1"), "face 0 of 1"},
      {"PLY binary cut in its vertices", "a.ply",
       ply("binary_little_endian", "3", "1", std::string(20, '\0')), "announces 3 vertex"},
      {"PLY count beyond the file", "a.ply",
       ply("binary_little_endian", "4000000000", "1", std::string(40, '\0')),
       "announces 4000000000 vertex"},
      {"PLY index beyond all integers", "a.ply",
       "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
       "property float z\nelement face 1\nproperty list int float vertex_index\nend_header\n"
       "0 0 0\n3 0 0 1e37\n",
       "line 11: vertex index 1e+37 is out of range (1 vertices)"},
      {"PLY with 2^63 - 1 items without properties", "a.ply",
       "ply\nformat ascii 1.0\nelement a 9223372036854775807\nend_header\n", "no face"},
      {"STL text cut", "a.stl", "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n",
       "before endfacet"},
      {"STL text without end", "a.stl",
       "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
       "endloop\nendfacet\n",
       "before endsolid"},
      {"STL not finite", "a.stl",
       "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex inf 0 0\nvertex 0 1 0\n"
       "endloop\nendfacet\nendsolid\n",
       "line 5"},
      {"STL facet of four", "a.stl",
       "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 1 0\n"
       "vertex 0 1 0\nendloop\nendfacet\nendsolid\n",
       "facet with 4 vertices"},
      {"STL text without facets", "a.stl", "solid a\nendsolid a\n", "no face"},
      {"STL binary cut", "a.stl", binary_stl(10, 300), "announces 10 triangles"},
      {"STL binary header cut", "a.stl", std::string("\0\0\0\0", 4), "header after 4 bytes"},
      {"STL binary not finite", "a.stl", binary_stl_with_nan(), "triangle 0"},
      {"STL binary without triangles", "a.stl", binary_stl(0, 84), "no face"},
  };
}

/// Code and message of the refusal; fails the test where the mesh loads.
[[nodiscard]] std::pair<ExitCode, std::string> refusal(const std::string& path) {
  try {
    (void)baker::load_mesh(path, {});
  } catch (const baker::BakeError& error) {
    return {error.code(), error.what()};
  }
  FAIL(path << " was loaded");
  return {};
}

}  // namespace

TEST_CASE("A bad mesh is refused with code 3 and a sentence that names file, place and cause") {
  const TemporaryFolder folder;
  for (const BadMesh& bad : text_cases()) {
    DYNAMIC_SECTION(bad.what) {
      const std::string path = folder.write(bad.file, bad.content);
      const auto [code, message] = refusal(path);
      CHECK(code == ExitCode::invalid_input);
      CHECK_THAT(message, Catch::StartsWith(path + ":"));
      CHECK_THAT(message, Catch::Contains(bad.expected));
      CHECK_THAT(message, Catch::Contains(";") || Catch::Contains(","));
      CHECK(message.find('\n') == std::string::npos);
    }
  }
}

TEST_CASE("A mesh file that is not there is refused with code 2") {
  const TemporaryFolder folder;
  const auto [code, message] = refusal(folder.path("missing.obj"));
  CHECK(code == ExitCode::file_or_device);
  CHECK_THAT(message, Catch::Contains("missing.obj: cannot open"));
}

TEST_CASE("A folder given as a mesh is refused with code 2") {
  const TemporaryFolder folder;
  const auto [code, message] = refusal(folder.path(""));
  CHECK(code == ExitCode::file_or_device);
  CHECK_THAT(message, Catch::Contains("is a directory"));
}

TEST_CASE("A device or a pipe given as a mesh is refused with code 2, unread") {
  const TemporaryFolder folder;
  REQUIRE(symlink("/dev/zero", folder.path("zero.obj").c_str()) == 0);
  REQUIRE(mkfifo(folder.path("pipe.ply").c_str(), 0600) == 0);
  for (const char* name : {"zero.obj", "pipe.ply"}) {
    const auto [code, message] = refusal(folder.path(name));
    CHECK(code == ExitCode::file_or_device);
    CHECK_THAT(message, Catch::Contains("is a device or a pipe"));
  }
}

TEST_CASE("A mesh without read permission is refused with code 2") {
  const TemporaryFolder folder;
  REQUIRE(chmod(folder.path("").c_str(), 0755) == 0);
  const std::string path = folder.write("a.obj", kTriangle + "f 1 2 3\n");
  REQUIRE(chmod(path.c_str(), 0) == 0);
  const AsNobody user;
  if (!user.works()) SPM_SKIP("root cannot become another user here");
  const auto [code, message] = refusal(path);
  CHECK(code == ExitCode::file_or_device);
  CHECK_THAT(message, Catch::Contains("permission"));
}

TEST_CASE("A mesh file cut anywhere is loaded or refused, never worse") {
  const TemporaryFolder folder;
  const std::string body = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n";
  const std::string whole = ply("ascii", "4", "4", body);
  for (std::size_t size = 1; size < whole.size(); ++size) {
    const std::string path = folder.write("cut.ply", whole.substr(0, size));
    try {
      (void)baker::load_mesh(path, {});
      // Only the last line end may be missing.
      CHECK(size + 1 >= whole.size());
    } catch (const baker::BakeError& error) {
      CHECK(error.code() == ExitCode::invalid_input);
    }
  }
}

TEST_CASE("Random bytes under any mesh name are refused with code 3") {
  const TemporaryFolder folder;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    RandomTwister random(seed);
    std::string bytes;
    for (int i = 0; i < 500; ++i) bytes += static_cast<char>(random.unit() * 256);
    for (const char* name : {"a.obj", "a.ply", "a.stl", "a.off"}) {
      const auto [code, message] = refusal(folder.write(name, bytes));
      CHECK(code == ExitCode::invalid_input);
    }
  }
}

}  // namespace spm::test::mesh_bad_input_test
