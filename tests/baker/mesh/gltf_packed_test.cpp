// SPDX-License-Identifier: GPL-3.0-or-later
// What a glTF says in other ways than by plain values: sparse, quantized, packed, placed many
// times.
#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <meshoptimizer.h>

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "baker/base/bake_error.hpp"
#include "baker/mesh/load.hpp"
#include "tests/baker/mesh/mesh_support.hpp"

namespace spm::test::gltf_packed_test {
namespace {

using baker::Mesh;
using Json = nlohmann::json;

template <class T>
std::string bytes_of(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

const std::vector<float> points{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
const std::vector<std::uint16_t> corners{0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};

/// A glTF of one tetrahedron, whose buffer grows as views are added to it.
struct Gltf {
  Json json = Json::parse(R"({
    "asset": {"version": "2.0"},
    "scenes": [{"nodes": [0]}],
    "nodes": [{"mesh": 0}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
    "accessors": [{"componentType": 5126, "count": 4, "type": "VEC3"},
                  {"componentType": 5123, "count": 12, "type": "SCALAR"}],
    "bufferViews": [], "buffers": [{"uri": "b.bin"}]})");
  std::string buffer;

  Json& node() { return json["nodes"][0]; }
  Json& primitive() { return json["meshes"][0]["primitives"][0]; }
  Json& accessor(std::size_t index) { return json["accessors"][index]; }

  /// Adds a view of these bytes and returns its number.
  std::size_t add(const std::string& bytes) {
    buffer.resize((buffer.size() + 3) / 4 * 4);
    json["bufferViews"].push_back(
        {{"buffer", 0}, {"byteOffset", buffer.size()}, {"byteLength", bytes.size()}});
    buffer += bytes;
    return json["bufferViews"].size() - 1;
  }

  std::size_t add_accessor(int type, const char* kind, std::size_t count,
                           const std::string& bytes) {
    json["accessors"].push_back(
        {{"bufferView", add(bytes)}, {"componentType", type}, {"count", count}, {"type", kind}});
    return json["accessors"].size() - 1;
  }

  [[nodiscard]] Mesh load() {
    json["buffers"][0]["byteLength"] = buffer.size();
    const TemporaryFolder folder;
    (void)folder.write("b.bin", buffer);
    return baker::load_mesh(folder.write("m.gltf", json.dump()), {});
  }

  [[nodiscard]] std::string refusal() {
    try {
      (void)load();
    } catch (const baker::BakeError& error) {
      CHECK(error.code() == ExitCode::invalid_input);
      return error.what();
    }
    return "it was loaded";
  }
};

Gltf plain() {
  Gltf gltf;
  gltf.accessor(0)["bufferView"] = gltf.add(bytes_of(points));
  gltf.accessor(1)["bufferView"] = gltf.add(bytes_of(corners));
  return gltf;
}

void check_is_tetrahedron(const Mesh& mesh, double volume = 1.0 / 6) {
  CHECK(mesh.triangles.size() == 4);
  CHECK(mesh.closed());
  CHECK(mesh.inverted_components == 0);
  CHECK(signed_volume(mesh.vertices, mesh.triangles) == Approx(volume));
}

bool noted(const Mesh& mesh, const std::string& words) {
  return std::any_of(mesh.notes.begin(), mesh.notes.end(), [&](const std::string& note) {
    return note.find(words) != std::string::npos;
  });
}

/// Says that a view is unpacked from others' bytes.
void pack(Gltf& gltf, std::size_t view, const std::vector<unsigned char>& packed, const char* mode,
          std::size_t count, std::size_t stride) {
  const Json whole = gltf.json["bufferViews"][gltf.add(bytes_of(packed))];
  gltf.json["bufferViews"][view] = {{"buffer", 1},
                                    {"byteLength", count * stride},
                                    {"extensions",
                                     {{"EXT_meshopt_compression",
                                       {{"buffer", 0},
                                        {"byteOffset", whole["byteOffset"]},
                                        {"byteLength", whole["byteLength"]},
                                        {"byteStride", stride},
                                        {"count", count},
                                        {"mode", mode}}}}}};
}

/// The tetrahedron, whose buffer without bytes stands for what meshoptimizer has packed.
Gltf packed_by_meshopt(bool triangles) {
  Gltf gltf = plain();
  std::vector<unsigned char> vertices(meshopt_encodeVertexBufferBound(4, 12)),
      indices(triangles ? meshopt_encodeIndexBufferBound(12, 4)
                        : meshopt_encodeIndexSequenceBound(12, 4));
  vertices.resize(
      meshopt_encodeVertexBuffer(vertices.data(), vertices.size(), points.data(), 4, 12));
  const std::vector<unsigned> wide(corners.begin(), corners.end());
  indices.resize(
      triangles ? meshopt_encodeIndexBuffer(indices.data(), indices.size(), wide.data(), 12)
                : meshopt_encodeIndexSequence(indices.data(), indices.size(), wide.data(), 12));
  gltf.json["extensionsRequired"] = {"EXT_meshopt_compression"};
  gltf.json["buffers"].push_back(
      {{"byteLength", 72}, {"extensions", {{"EXT_meshopt_compression", {{"fallback", true}}}}}});
  pack(gltf, 0, vertices, "ATTRIBUTES", 4, 12);
  pack(gltf, 1, indices, triangles ? "TRIANGLES" : "INDICES", 12, 2);
  return gltf;
}

std::string packed_by_draco(bool edgebreaker) {
  draco::TriangleSoupMeshBuilder builder;
  builder.Start(4);
  const int attribute =
      builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
  for (std::uint32_t face = 0; face < 4; ++face) {
    const auto corner = [&](std::size_t k) {
      return &points[std::size_t{3} * corners[std::size_t{3} * face + k]];
    };
    builder.SetAttributeValuesForFace(attribute, draco::FaceIndex(face), corner(0), corner(1),
                                      corner(2));
  }
  const std::unique_ptr<draco::Mesh> mesh = builder.Finalize();
  draco::Encoder encoder;
  encoder.SetEncodingMethod(edgebreaker ? draco::MESH_EDGEBREAKER_ENCODING
                                        : draco::MESH_SEQUENTIAL_ENCODING);
  draco::EncoderBuffer buffer;
  REQUIRE(encoder.EncodeMeshToBuffer(*mesh, &buffer).ok());
  return {buffer.data(), buffer.size()};
}

/// The tetrahedron as Draco packs it, with nothing beside.
Gltf with_draco(const std::string& packed) {
  Gltf gltf;
  const std::size_t view = gltf.add(packed);
  gltf.json["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  gltf.primitive()["extensions"]["KHR_draco_mesh_compression"] = {
      {"bufferView", view}, {"attributes", {{"POSITION", 0}}}};
  return gltf;
}

}  // namespace

TEST_CASE("Sparse values replace those of their accessor, or zeros") {
  Gltf gltf = plain();
  const std::size_t indices = gltf.add(bytes_of<std::uint8_t>({3})),
                    values = gltf.add(bytes_of<float>({0, 0, 2}));
  gltf.accessor(0)["sparse"] = {{"count", 1},
                                {"indices", {{"bufferView", indices}, {"componentType", 5121}}},
                                {"values", {{"bufferView", values}}}};
  SECTION("of their accessor") { check_is_tetrahedron(gltf.load(), 2.0 / 6); }
  SECTION("zeros") {
    gltf.accessor(0).erase("bufferView");
    gltf.accessor(0)["sparse"]["count"] = 3;
    gltf.accessor(0)["sparse"]["indices"]["bufferView"] =
        gltf.add(bytes_of<std::uint8_t>({1, 2, 3}));
    gltf.accessor(0)["sparse"]["values"]["bufferView"] =
        gltf.add(bytes_of<float>({1, 0, 0, 0, 1, 0, 0, 0, 2}));
    check_is_tetrahedron(gltf.load(), 2.0 / 6);
  }
  SECTION("an index beyond the accessor is refused") {
    gltf.accessor(0)["sparse"]["indices"]["bufferView"] = gltf.add(std::string(1, '\4'));
    CHECK_THAT(gltf.refusal(), Catch::Contains("accessor 0: index 4 of 'sparse'"));
  }
  SECTION("more values than there are bytes are refused") {
    gltf.accessor(0)["sparse"]["count"] = 2;
    CHECK_THAT(gltf.refusal(), Catch::Contains("accessor 0: 2 values are more than buffer 0 has"));
  }
  SECTION("2^63 zeros are refused before any is made") {
    gltf.accessor(0).erase("bufferView");
    gltf.accessor(0)["count"] = std::uint64_t{1} << 63U;
    CHECK_THAT(gltf.refusal(), Catch::Contains("mesh 0, primitive 0"));
  }
}

TEST_CASE("Quantized positions are read, normalized or not") {
  Gltf gltf = plain();
  gltf.json["extensionsRequired"] = {"KHR_mesh_quantization"};
  SECTION("signed bytes, each vertex of four") {
    gltf.accessor(0) = {
        {"bufferView",
         gltf.add(bytes_of<std::int8_t>({0, 0, 0, 9, 127, 0, 0, 9, 0, 127, 0, 9, 0, 0, 127, 9}))},
        {"componentType", 5120},
        {"normalized", true},
        {"count", 4},
        {"type", "VEC3"}};
    gltf.json["bufferViews"].back()["byteStride"] = 4;
    check_is_tetrahedron(gltf.load());
  }
  SECTION("unsigned 16 bits, scaled by the node") {
    gltf.accessor(0) = {
        {"bufferView",
         gltf.add(bytes_of<std::uint16_t>({0, 0, 0, 500, 0, 0, 0, 500, 0, 0, 0, 500}))},
        {"componentType", 5123},
        {"count", 4},
        {"type", "VEC3"}};
    gltf.node()["scale"] = {0.002, 0.002, 0.002};
    check_is_tetrahedron(gltf.load());
  }
}

TEST_CASE("What meshoptimizer has packed is unpacked") {
  check_is_tetrahedron(packed_by_meshopt(true).load());
  check_is_tetrahedron(packed_by_meshopt(false).load());
  Gltf gltf = packed_by_meshopt(true);
  Json& packed = gltf.json["bufferViews"][0]["extensions"]["EXT_meshopt_compression"];
  SECTION("exponents beside mantissas") {
    // 2^E * M in 32 bits: E above, M in the lower 24 bits.
    std::vector<std::int32_t> exponents;
    exponents.reserve(points.size());
    for (const float value : points) exponents.push_back(value == 1 ? 1 << 10 | (-10 << 24) : 0);
    std::vector<unsigned char> bytes(meshopt_encodeVertexBufferBound(4, 12));
    bytes.resize(meshopt_encodeVertexBuffer(bytes.data(), bytes.size(), exponents.data(), 4, 12));
    pack(gltf, 0, bytes, "ATTRIBUTES", 4, 12);
    gltf.json["bufferViews"][0]["extensions"]["EXT_meshopt_compression"]["filter"] = "EXPONENTIAL";
    check_is_tetrahedron(gltf.load());
    return;
  }
  SECTION("broken bytes are refused") { gltf.buffer.assign(gltf.buffer.size(), '\x55'); }
  SECTION("a mode that nobody knows is refused") { packed["mode"] = "OTHERS"; }
  SECTION("a filter that nobody knows is refused") { packed["filter"] = "OTHER"; }
  SECTION("a stride that the decoder does not take is refused") { packed["byteStride"] = 7; }
  SECTION("more than a hundred times what is packed is refused") { packed["count"] = 1U << 30U; }
  SECTION("2^62 of them are refused") { packed["count"] = std::uint64_t{1} << 62U; }
  CHECK_THAT(gltf.refusal(), Catch::Contains("bufferView 0: what EXT_meshopt_compression"));
}

TEST_CASE("What Draco has packed is unpacked") {
  for (const bool edgebreaker : {false, true}) {
    const std::string packed = packed_by_draco(edgebreaker);
    Gltf gltf = with_draco(packed);
    check_is_tetrahedron(gltf.load());
    gltf.node()["scale"] = {1, 1, -2};
    check_is_tetrahedron(gltf.load(), 2.0 / 6);
    for (std::size_t size = 0; size + 1 < packed.size(); size += 5) {
      CHECK_THAT(with_draco(packed.substr(0, size)).refusal(),
                 Catch::Contains("what KHR_draco_mesh_compression has packed is broken"));
    }
    Gltf other = with_draco(packed);
    other.primitive()["extensions"]["KHR_draco_mesh_compression"]["attributes"]["POSITION"] = 7;
    CHECK_THAT(other.refusal(), Catch::Contains("primitive 0: what KHR_draco"));
  }
  // A header that announces four billion faces, of which none is there.
  const std::string announced("DRACO\2\2\1\1\0\0\0\xFF\xFF\xFF\xFF\x0F\xFF\xFF\xFF\xFF\x0F", 22);
  CHECK_THAT(with_draco(announced).refusal(), Catch::Contains("is broken"));
}

TEST_CASE("Plain values beside those that Draco has packed are taken") {
  Gltf gltf = plain();
  gltf.primitive()["extensions"]["KHR_draco_mesh_compression"] = {
      {"bufferView", gltf.add("none")}, {"attributes", {{"POSITION", 0}}}};
  check_is_tetrahedron(gltf.load());
}

TEST_CASE("An extension that a glTF needs and that is not read is refused by its name") {
  Gltf gltf = plain();
  gltf.json["extensionsRequired"] = {"KHR_materials_unlit", "KHR_texture_transform"};
  check_is_tetrahedron(gltf.load());
  gltf.json["extensionsRequired"].push_back("ACME_other_geometry");
  CHECK_THAT(gltf.refusal(), Catch::Contains("it needs the extension ACME_other_geometry"));
}

TEST_CASE("A part that a node scales to nothing is noted, and one that it mirrors is turned") {
  Gltf gltf = plain();
  SECTION("to nothing") {
    gltf.json["nodes"].push_back({{"mesh", 0}, {"scale", {0, 0, 0}}, {"translation", {5, 0, 0}}});
    gltf.json["scenes"][0]["nodes"] = {0, 1};
    const Mesh mesh = gltf.load();
    check_is_tetrahedron(mesh);
    CHECK(noted(mesh, "without area, since a node scales them to nothing: 1."));
  }
  SECTION("all of it to nothing is refused") {
    gltf.node()["scale"] = {0, 0, 0};
    CHECK_THAT(gltf.refusal(), Catch::Contains("has an area"));
  }
  SECTION("flat in one direction") {
    gltf.json["nodes"].push_back({{"mesh", 0}, {"scale", {1, 1, 0}}, {"translation", {5, 0, 0}}});
    gltf.json["scenes"][0]["nodes"] = {0, 1};
    CHECK(noted(gltf.load(), "Flat parts, since a node scales them by 0 in one direction: 1."));
  }
  SECTION("mirrored by its parent, and again by itself") {
    gltf.node()["scale"] = {-1, 1, 1};
    check_is_tetrahedron(gltf.load());
    gltf.json["nodes"].push_back({{"children", {0}}, {"scale", {1, -1, 1}}});
    gltf.json["scenes"][0]["nodes"] = {1};
    check_is_tetrahedron(gltf.load());
  }
}

TEST_CASE("A skin and morph targets are noted: the bind pose is baked") {
  Gltf gltf = plain();
  gltf.node()["skin"] = 0;
  gltf.primitive()["targets"] = Json::array({{{"POSITION", 0}}});
  const Mesh mesh = gltf.load();
  check_is_tetrahedron(mesh);
  CHECK(noted(mesh, "skin is not applied, so that their bind pose is baked: 1."));
  CHECK(noted(mesh, "morph targets are not applied, so that their bind pose is baked: 1."));
}

TEST_CASE("A mesh is placed as often as its instances say") {
  Gltf gltf = plain();
  gltf.json["extensionsRequired"] = {"EXT_mesh_gpu_instancing"};
  const std::size_t moved =
      gltf.add_accessor(5126, "VEC3", 3, bytes_of<float>({0, 0, 0, 5, 0, 0, 0, 0, 9}));
  const std::size_t scaled =
      gltf.add_accessor(5126, "VEC3", 3, bytes_of<float>({1, 1, 1, 2, 2, 2, 1, 1, -1}));
  Json& attributes = gltf.node()["extensions"]["EXT_mesh_gpu_instancing"]["attributes"];
  attributes = {{"TRANSLATION", moved}, {"SCALE", scaled}};
  SECTION("moved and scaled") {
    const Mesh mesh = gltf.load();
    CHECK(mesh.components == 3);
    CHECK(mesh.inverted_components == 0);
    CHECK(signed_volume(mesh.vertices, mesh.triangles) == Approx(10.0 / 6));
    CHECK(mesh.box_max == Vector3(7, 2, 9));
  }
  SECTION("turned, by 16 bits a number") {
    // A quarter turn about z: x goes to y.
    attributes = {{"ROTATION", gltf.add_accessor(5122, "VEC4", 1,
                                                 bytes_of<std::int16_t>({0, 0, 23170, 23170}))}};
    gltf.json["accessors"].back()["normalized"] = true;
    const Mesh mesh = gltf.load();
    check_is_tetrahedron(mesh);
    CHECK((mesh.box_min - Vector3(-1, 0, 0)).norm() < 1e-12);
  }
  SECTION("attributes of other lengths are refused") {
    gltf.accessor(scaled)["count"] = 2;
    CHECK_THAT(gltf.refusal(), Catch::Contains("node 0: the attributes of its instances"));
  }
}

}  // namespace spm::test::gltf_packed_test
