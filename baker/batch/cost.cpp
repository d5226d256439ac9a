// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/batch/cost.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <system_error>

#include "baker/mesh/mesh_files.hpp"

namespace spm::baker {
namespace {

/// Bytes that a triangle and its share of the vertices take in files of a kind.
double triangle_bytes(const std::string& extension) {
  if (extension.ends_with(".gz")) {
    constexpr double packing = 4;  // of text, and hardly less of numbers
    return triangle_bytes(extension.substr(0, extension.size() - 3)) / packing;
  }
  if (extension == ".stl") return 50;
  if (extension == ".ply") return 20;
  if (extension == ".glb") return 24;
  if (extension == ".3mf") return 12;
  return 35;
}

/// The size of the other files that a mesh is made of.
std::uintmax_t companion_bytes(const std::string& path) {
  std::uintmax_t all = 0;
  for (const std::string& companion : mesh_companions(path, true)) {
    std::error_code missing;
    const auto bytes = std::filesystem::file_size(companion, missing);
    if (!missing) all += bytes;
  }
  return all;
}

/// How much longer a finer tolerance takes: measured from 200 to 12.5 um.
double finer(const BuildRequest& request) {
  constexpr double common = 50e-6, usual = 100e-6, growth = 0.6;  // the lengths in m
  const double tolerance = request.bake.tolerance.value_or(usual);
  return std::clamp(std::pow(common / tolerance, growth), 0.05, 50.0);
}

}  // namespace

double estimated_triangles(const std::string& path) {
  std::error_code missing;
  const auto bytes = std::filesystem::file_size(path, missing);
  if (missing) return 0;
  return static_cast<double>(bytes + companion_bytes(path)) / triangle_bytes(mesh_extension(path));
}

double estimated_cost(const BuildRequest& request) {
  // Measured with meshes of 8 to a million triangles: what a bake takes grows far less than they.
  constexpr double start = 0.05, seconds = 0.8, growth = 0.27;
  const double triangles = estimated_triangles(request.mesh);
  if (triangles <= 0) return start;
  return start + seconds * std::pow(triangles, growth) * finer(request);
}

double estimated_memory(const BuildRequest& request) {
  // Measured: 0.15, 0.27, 1.2 and 6.0 GB for 23 thousand, 100 thousand, a million and 5 million
  // triangles, and 0.34 GB for 6 thousand that cross each other. This is somewhat more.
  constexpr double start = 3.5e8, bytes_a_triangle = 1.1e3;
  return start + bytes_a_triangle * estimated_triangles(request.mesh);
}

}  // namespace spm::baker
