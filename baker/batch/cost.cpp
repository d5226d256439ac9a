// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/batch/cost.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <system_error>

namespace spm::baker {
namespace {

/// Bytes that a triangle and its share of the vertices take in files of a kind.
double triangle_bytes(const std::string& extension) {
  if (extension == ".stl") return 50;
  if (extension == ".ply") return 20;
  return 35;
}

/// A finer tolerance takes more of everything, but far less than in proportion.
double finer(const BuildRequest& request) {
  constexpr double common_tolerance = 50e-6;  // m
  if (!request.bake.tolerance) return 1;
  return std::clamp(std::pow(common_tolerance / *request.bake.tolerance, 0.25), 0.2, 10.0);
}

}  // namespace

double estimated_triangles(const std::string& path) {
  std::error_code missing;
  const auto bytes = std::filesystem::file_size(path, missing);
  if (missing) return 0;
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  return static_cast<double>(bytes) / triangle_bytes(extension);
}

double estimated_cost(const BuildRequest& request) {
  constexpr double start = 0.05;               // of a process, and of reading
  constexpr double seconds_a_triangle = 1e-3;  // measured at the common tolerance
  const double triangles = estimated_triangles(request.mesh);
  return start + seconds_a_triangle * triangles * finer(request);
}

double estimated_memory(const BuildRequest& request) {
  constexpr double start = 1e8, bytes_a_triangle = 1e4;
  return start + bytes_a_triangle * estimated_triangles(request.mesh) * finer(request);
}

}  // namespace spm::baker
