// SPDX-License-Identifier: GPL-3.0-or-later
// Mesh files of any bytes, by each reader that takes them for its own.
#include "baker/base/bake_error.hpp"
#include "baker/mesh/gunzip.hpp"
#include "baker/mesh/mesh_reader.hpp"
#include "tests/fuzz/fuzz_target.hpp"

namespace spm::fuzz {

namespace {

constexpr const char* names[] = {"a.obj", "a.ply", "a.stl", "a.off", "a.gltf", "a.glb", "a.3mf"};

void read(const std::string& bytes) {
  for (const char* name : names) {
    try {
      const baker::PolygonSoup soup = baker::read_soup(name, bytes);
      for (const Vector3& point : soup.points) require(point.allFinite(), "a point is somewhere");
      for (const auto& triangle : soup.triangles) {
        for (const std::uint32_t corner : triangle) {
          require(corner < soup.points.size(), "a corner is one of the points");
        }
      }
    } catch (const baker::BakeError& error) {
      require(error.code() == ExitCode::invalid_input || error.code() == ExitCode::file_or_device,
              "a refusal has its code");
    }
  }
}

}  // namespace

std::vector<std::string> seeds() {
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n"
      "property float y\nproperty float z\nelement face 1\n"
      "property list uchar int vertex_indices\nend_header\n"
      "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  std::string binary = ply.substr(0, ply.find("0 0 0"));
  binary.replace(binary.find("ascii"), 5, "binary_little_endian");
  binary += std::string(36, '\0') + std::string("\3\0\0\0\0\1\0\0\0\2\0\0\0", 13);
  std::string stl(80, 'x');
  stl += std::string("\1\0\0\0", 4) + std::string(50, '\0');
  const std::string gltf = R"({"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],
"nodes":[{"mesh":0,"scale":[1,2,3],"children":[]}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0},"mode":5}]}],
"accessors":[{"bufferView":0,"componentType":5121,"count":4,"type":"VEC3"}],
"bufferViews":[{"buffer":0,"byteLength":12}],
"buffers":[{"byteLength":12,"uri":"data:a;base64,AAAAAQAAAAEAAAAB"}]})";
  return {"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1/1 2/2 3/3\nf -1 -2 -3\n",
          ply,
          binary,
          stl,
          "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
          "endloop\nendfacet\nendsolid\n",
          "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
          gltf};
}

std::vector<std::string> endings() {
  return {".obj", ".ply", ".stl", ".off", ".gltf", ".glb", ".3mf"};
}

}  // namespace spm::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  spm::fuzz::read(bytes);
  if (!spm::baker::is_gzip(bytes)) return 0;
  try {
    spm::fuzz::read(spm::baker::gunzip("a.gz", bytes));
  } catch (const spm::baker::BakeError& error) {
    spm::fuzz::require(error.code() == spm::ExitCode::invalid_input, "a refusal has its code");
  }
  return 0;
}
