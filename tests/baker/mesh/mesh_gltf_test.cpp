// SPDX-License-Identifier: GPL-3.0-or-later
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <array>
#include <catch2/catch.hpp>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "baker/base/bake_error.hpp"
#include "baker/mesh/load.hpp"
#include "baker/mesh/mesh_files.hpp"
#include "tests/baker/mesh/mesh_support.hpp"

namespace spm::test::mesh_gltf_test {
namespace {

using baker::load_mesh;
using baker::Mesh;
using Json = nlohmann::json;

template <class T>
void append(std::string& bytes, T value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

template <class T>
void append_all(std::string& bytes, const std::vector<T>& values) {
  for (const T value : values) append(bytes, value);
}

/// The corner of a cube: twelve floats, then twelve indices of 16 bits.
std::string tetrahedron_bytes() {
  std::string bytes;
  append_all<float>(bytes, {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1});
  append_all<std::uint16_t>(bytes, {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3});
  return bytes;
}

Json tetrahedron(const std::string& uri = "corner.bin") {
  Json json = Json::parse(R"({
    "asset": {"version": "2.0"},
    "scenes": [{"nodes": [0]}],
    "nodes": [{"mesh": 0}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
    "accessors": [
      {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
      {"bufferView": 1, "componentType": 5123, "count": 12, "type": "SCALAR"}],
    "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 48},
                    {"buffer": 0, "byteOffset": 48, "byteLength": 24}],
    "buffers": [{"byteLength": 72}]})");
  if (!uri.empty()) json["buffers"][0]["uri"] = uri;
  return json;
}

std::string glb(const Json& json, const std::string& binary) {
  std::string text = json.dump();
  text.resize((text.size() + 3) / 4 * 4, ' ');
  std::string bytes = "glTF";
  append(bytes, std::uint32_t{2});
  append(bytes, static_cast<std::uint32_t>(28 + text.size() + binary.size()));
  append(bytes, static_cast<std::uint32_t>(text.size()));
  bytes += "JSON" + text;
  append(bytes, static_cast<std::uint32_t>(binary.size()));
  bytes += std::string("BIN\0", 4) + binary;
  return bytes;
}

std::string base64(const std::string& bytes) {
  static const std::string letters =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t word = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      word = word << 8U | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      text += i + k > bytes.size() ? '=' : letters[word >> (18 - 6 * k) & 63U];
    }
  }
  return text;
}

std::string gzip(const std::string& bytes) {
  std::string packed(compressBound(bytes.size()) + 64, '\0');
  z_stream stream{};
  REQUIRE(deflateInit2(&stream, 9, Z_DEFLATED, MAX_WBITS + 16, 8, Z_DEFAULT_STRATEGY) == Z_OK);
  std::string input = bytes;
  stream.next_in = reinterpret_cast<Bytef*>(input.data());
  stream.avail_in = static_cast<uInt>(input.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  REQUIRE(deflate(&stream, Z_FINISH) == Z_STREAM_END);
  packed.resize(stream.total_out);
  deflateEnd(&stream);
  return packed;
}

/// A glTF with its buffer beside it, loaded.
Mesh loaded(const Json& json) {
  const TemporaryFolder folder;
  (void)folder.write("corner.bin", tetrahedron_bytes());
  return load_mesh(folder.write("corner.gltf", json.dump()), {});
}

void check_is_tetrahedron(const Mesh& mesh, double volume = 1.0 / 6) {
  CHECK(mesh.triangles.size() == 4);
  CHECK(mesh.closed());
  CHECK(signed_volume(mesh.vertices, mesh.triangles) == Approx(volume));
}

std::pair<ExitCode, std::string> refusal(const std::string& path) {
  try {
    (void)load_mesh(path, {});
  } catch (const baker::BakeError& error) {
    return {error.code(), error.what()};
  }
  FAIL(path << " was loaded");
  return {};
}

}  // namespace

TEST_CASE("A glTF is read with its buffer beside it, in its text or in one file with it") {
  const TemporaryFolder folder;
  const std::string bytes = tetrahedron_bytes();
  SECTION("beside it") {
    (void)folder.write("a corner.bin", bytes);
    const std::string text = tetrahedron("a%20corner.bin").dump();
    check_is_tetrahedron(load_mesh(folder.write("m.gltf", text), {}));
  }
  SECTION("in its text") {
    const std::string uri = "data:application/octet-stream;base64," + base64(bytes);
    check_is_tetrahedron(load_mesh(folder.write("m.gltf", tetrahedron(uri).dump()), {}));
  }
  SECTION("in one file") {
    check_is_tetrahedron(load_mesh(folder.write("m.GLB", glb(tetrahedron(""), bytes)), {}));
  }
}

TEST_CASE("Nodes place what hangs below them, however they say it") {
  Json json = tetrahedron();
  SECTION("moved, turned and scaled, one below another") {
    json["nodes"] = Json::parse(R"([
      {"children": [1], "translation": [5, 0, 0], "scale": [2, 2, 2]},
      {"mesh": 0, "translation": [0, 3, 0], "rotation": [0, 0, 0.70710678, 0.70710678]}])");
    const Mesh mesh = loaded(json);
    check_is_tetrahedron(mesh, 8.0 / 6);
    // x goes to y, and y to -x.
    CHECK((mesh.box_min - Vector3(3, 6, 0)).norm() < 1e-6);
    CHECK((mesh.box_max - Vector3(5, 8, 2)).norm() < 1e-6);
  }
  SECTION("by a matrix, column by column") {
    json["nodes"][0]["matrix"] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 3, 0, 7, 8, 9, 1};
    const Mesh mesh = loaded(json);
    check_is_tetrahedron(mesh, 3.0 / 6);
    CHECK((mesh.box_min - Vector3(7, 8, 9)).norm() < 1e-12);
  }
  SECTION("mirrored, which turns no face inside out") {
    json["nodes"][0]["scale"] = {1, 1, -1};
    const Mesh mesh = loaded(json);
    check_is_tetrahedron(mesh);
    CHECK(mesh.inverted_components == 0);
  }
  SECTION("twice") {
    json["nodes"].push_back({{"mesh", 0}, {"translation", {4, 0, 0}}});
    json["scenes"][0]["nodes"] = {0, 1};
    CHECK(loaded(json).components == 2);
  }
  SECTION("only what the scene shows") {
    json["nodes"].push_back({{"mesh", 0}, {"translation", {4, 0, 0}}});
    CHECK(loaded(json).components == 1);
  }
  SECTION("no scene: all of it") {
    json.erase("scenes");
    check_is_tetrahedron(loaded(json));
    json.erase("nodes");
    check_is_tetrahedron(loaded(json));
  }
}

TEST_CASE("Triangles come as lists, strips and fans, and points and lines are left out") {
  Json json = tetrahedron();
  Json& primitives = json["meshes"][0]["primitives"];
  SECTION("a strip about the tetrahedron") {
    // 0 2 1 3 0 2: each three in a row are a face.
    std::string bytes = tetrahedron_bytes().substr(0, 48);
    append_all<std::uint16_t>(bytes, {0, 2, 1, 3, 0, 2});
    bytes.resize(72);
    const TemporaryFolder folder;
    (void)folder.write("corner.bin", bytes);
    primitives[0]["mode"] = 5;
    json["accessors"][1]["count"] = 6;
    const Mesh mesh = load_mesh(folder.write("m.gltf", json.dump()), {});
    check_is_tetrahedron(mesh);
    CHECK(mesh.inverted_components == 0);
  }
  SECTION("points beside triangles") {
    primitives.push_back({{"attributes", {{"POSITION", 0}}}, {"mode", 0}});
    check_is_tetrahedron(loaded(json));
  }
}

TEST_CASE("A bad glTF is refused with a sentence that names the place and the cause") {
  const TemporaryFolder folder;
  (void)folder.write("corner.bin", tetrahedron_bytes());
  Json json = tetrahedron();
  std::string expected;
  ExitCode code = ExitCode::invalid_input;
  SECTION("no buffer") {
    json = tetrahedron("gone.bin");
    code = ExitCode::file_or_device;
    expected = "buffer 0 is missing";
  }
  SECTION("a buffer elsewhere") {
    json = tetrahedron("https://host/corner.bin");
    expected = "nothing is fetched";
  }
  SECTION("a buffer cut short") {
    json["buffers"][0]["byteLength"] = 100;
    expected = "of 100 bytes 72 are there";
  }
  SECTION("4 billion indices") {
    json["accessors"][1]["count"] = 4294967295U;
    expected = "accessor 1: 4294967295 values are more than buffer 0 has";
  }
  SECTION("counts and lengths that overflow") {
    json["accessors"][0]["count"] = std::uint64_t{1} << 63U;
    json["bufferViews"][0]["byteLength"] = ~std::uint64_t{0};
    expected = "accessor 0";
  }
  SECTION("a negative count") {
    json["accessors"][1]["count"] = -3;
    expected = "'count' is no whole number";
  }
  SECTION("a stride of nothing") {
    json["bufferViews"][0]["byteStride"] = 0;
    expected = "accessor 0";
  }
  SECTION("an index out of range") {
    json["accessors"][0]["count"] = 3;
    expected = "vertex index 3 is out of range (3 vertices)";
  }
  SECTION("indices that are no whole numbers") {
    json["accessors"][1]["componentType"] = 5126;
    expected = "component type 5126";
  }
  SECTION("an accessor that is not there") {
    json["meshes"][0]["primitives"][0]["indices"] = 9;
    expected = "no 9 in 'accessors'";
  }
  SECTION("a node below itself") {
    json["nodes"][0]["children"] = {0};
    expected = "node 0 hangs below two nodes";
  }
  SECTION("an accessor without values") {
    json["accessors"][0].erase("bufferView");
    expected = "accessor 0 has no values";
  }
  SECTION("glTF 1.0") {
    json["asset"]["version"] = "1.0";
    expected = "it is glTF 1.0";
  }
  SECTION("a scale without end") {
    json["nodes"][0]["scale"] = {1e308, 1e308, 1e308};
    json["nodes"].push_back({{"children", {0}}, {"scale", {1e308, 1, 1}}});
    json["scenes"][0]["nodes"] = {1};
    expected = "node 0";
  }
  SECTION("a number beyond all numbers") {
    const auto [found, message] =
        refusal(folder.write("m.gltf", R"({"asset":{"version":"2.0"},"x":1e999})"));
    CHECK(found == ExitCode::invalid_input);
    CHECK_THAT(message, Catch::Contains("number that is larger than any"));
    return;
  }
  SECTION("words where numbers belong") {
    json["nodes"][0]["translation"] = {"a", "b", "c"};
    expected = "'translation' are not 3 numbers";
  }
  const std::string path = folder.write("m.gltf", json.dump());
  const auto [found, message] = refusal(path);
  CHECK(found == code);
  CHECK_THAT(message, Catch::StartsWith(path + ":"));
  CHECK_THAT(message, Catch::Contains(expected));
}

TEST_CASE("A glTF or a gzip cut anywhere is refused") {
  const TemporaryFolder folder;
  const std::string whole = glb(tetrahedron(""), tetrahedron_bytes());
  const std::string packed = gzip(whole);
  for (std::size_t size = 1; size < whole.size(); size += 7) {
    CHECK(refusal(folder.write("m.glb", whole.substr(0, size))).first == ExitCode::invalid_input);
  }
  for (std::size_t size = 1; size + 8 < packed.size(); size += 7) {
    CHECK(refusal(folder.write("m.glb.gz", packed.substr(0, size))).first ==
          ExitCode::invalid_input);
  }
  std::string damaged = packed;
  damaged[packed.size() / 2] ^= 1;
  CHECK(refusal(folder.write("m.glb.gz", damaged)).first == ExitCode::invalid_input);
}

TEST_CASE("A buffer outside a glTF's folder is read only where that is allowed") {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder.path("in"));
  (void)folder.write("corner.bin", tetrahedron_bytes());
  for (const std::string& uri : {std::string("../corner.bin"), std::string("x/../../corner.bin"),
                                 std::string("%2e%2e/corner.bin"), folder.path("corner.bin")}) {
    CAPTURE(uri);
    std::filesystem::create_directory(folder.path("in/x"));
    const std::string path = folder.write("in/m.gltf", tetrahedron(uri).dump());
    const auto [code, message] = refusal(path);
    CHECK(code == ExitCode::invalid_input);
    CHECK_THAT(message, Catch::Contains("leads out of the file's folder") &&
                            Catch::Contains("--outside-buffers"));
    CHECK(baker::mesh_companions(path, false).empty());
    const baker::LoadOptions allowed{.outside_buffers = true};
    check_is_tetrahedron(load_mesh(path, allowed));
    CHECK(load_mesh(path, allowed).sha256 == *baker::mesh_sha256(path, true));
  }
}

TEST_CASE("A device or a pipe is never read as a buffer") {
  const TemporaryFolder folder;
  REQUIRE(symlink("/dev/zero", folder.path("zero.bin").c_str()) == 0);
  REQUIRE(mkfifo(folder.path("pipe.bin").c_str(), 0600) == 0);
  for (const std::string& uri :
       {std::string("zero.bin"), std::string("pipe.bin"), std::string("/dev/zero")}) {
    CAPTURE(uri);
    const std::string path = folder.write("m.gltf", tetrahedron(uri).dump());
    try {
      (void)load_mesh(path, {.outside_buffers = true});
      FAIL("it was loaded");
    } catch (const baker::BakeError& error) {
      CHECK(error.code() == ExitCode::file_or_device);
      CHECK_THAT(error.what(), Catch::Contains("is a device or a pipe"));
    }
    CHECK_FALSE(baker::mesh_sha256(path, true));
  }
}

TEST_CASE("Many primitives of the same bytes are refused before any vertex of them is made") {
  Json json = tetrahedron();
  constexpr std::size_t points = 1'000'000;
  json["buffers"][0] = {{"uri", "many.bin"}, {"byteLength", 12 * points}};
  json["bufferViews"][0] = {{"buffer", 0}, {"byteLength", 12 * points}};
  json["accessors"][0]["count"] = points;
  Json primitive = json["meshes"][0]["primitives"][0];
  primitive.erase("indices");
  json["meshes"][0]["primitives"] = Json(60, primitive);
  const TemporaryFolder folder;
  (void)folder.write("many.bin", std::string(12 * points, '\0'));
  const auto [code, message] = refusal(folder.write("m.gltf", json.dump()));
  CHECK(code == ExitCode::invalid_input);
  CHECK_THAT(message, Catch::Contains("mesh 0, primitive 33: with it the file has more "
                                      "than 33554432 vertices or triangles"));
}

TEST_CASE("What a gzip unpacks to is bounded by what it is, long before the memory is full") {
  const TemporaryFolder folder;
  const std::string text =
      "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
  // 32 MiB of it are still unpacked, 80 MiB are not.
  check_is_tetrahedron(
      load_mesh(folder.write("m.obj.gz", gzip(text + std::string(32U << 20U, '\n'))), {}));
  const auto [code, message] =
      refusal(folder.write("bomb.obj.gz", gzip(text + std::string(80U << 20U, '\n'))));
  CHECK(code == ExitCode::invalid_input);
  CHECK_THAT(message, Catch::Contains("more than 100 times as large"));
}

TEST_CASE("JSON as deep as a file can have it ends nothing") {
  const TemporaryFolder folder;
  const std::string deep = R"({"asset":{"version":"2.0"},"extras":)" + std::string(200000, '[') +
                           std::string(200000, ']') + "}";
  CHECK(refusal(folder.write("m.gltf", deep)).first == ExitCode::invalid_input);
}

TEST_CASE("A gzip holds what its name says without .gz") {
  const TemporaryFolder folder;
  const std::string text =
      "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
  check_is_tetrahedron(load_mesh(folder.write("m.obj.gz", gzip(text)), {}));
  // Of several members, as `cat a.gz b.gz` makes them.
  check_is_tetrahedron(
      load_mesh(folder.write("two.obj.gz", gzip(text.substr(0, 20)) + gzip(text.substr(20))), {}));
  CHECK_THAT(refusal(folder.write("m.obj", gzip(text))).second,
             Catch::Contains("rename it to end in .gz"));
  CHECK_THAT(refusal(folder.write("plain.obj.gz", text)).second,
             Catch::Contains("rename it without .gz"));
  CHECK_THAT(refusal(folder.write("m.ply.gz", gzip(text))).second,
             Catch::Contains("looks like OBJ"));
}

TEST_CASE("A mesh of several files is another mesh once one of them changes") {
  const TemporaryFolder folder;
  (void)folder.write("corner.bin", tetrahedron_bytes());
  const std::string path = folder.write("m.gltf", tetrahedron().dump());
  CHECK(baker::mesh_companions(path, false) == std::vector<std::string>{folder.path("corner.bin")});
  const std::string before = *baker::mesh_sha256(path, false);
  CHECK(load_mesh(path, {}).sha256 == before);
  (void)folder.write("corner.bin", tetrahedron_bytes() + " ");
  CHECK(*baker::mesh_sha256(path, false) != before);
  CHECK(load_mesh(path, {}).sha256 == *baker::mesh_sha256(path, false));
}

}  // namespace spm::test::mesh_gltf_test
