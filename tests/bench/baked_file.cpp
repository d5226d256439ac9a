// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/baked_file.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <utility>

#include "baker/bake.hpp"
#include "common/units.hpp"
#include "tests/bench/model.hpp"
#include "tests/bench/unwrap.hpp"

namespace spm::bench {
namespace {

BakedFile bake_to(const baker::Mesh& mesh, const baker::BakeOptions& options, std::string settings,
                  const std::string& folder) {
  const Clock::time_point start = Clock::now();
  const baker::BakeResult baked = baker::bake(mesh, options);
  BakedFile file;
  file.settings = std::move(settings);
  std::string name = file.settings;
  for (char& letter : name) letter = letter == ' ' || letter == ',' ? '-' : letter;
  file.path = (std::filesystem::path(folder) / (name + ".spm.exr")).string();
  file.bytes = unwrap(write_asset(baked.asset, file.path)).total;
  file.seconds = seconds_since(start);
  return file;
}

baker::BakeOptions options_for(const Band& band) {
  baker::BakeOptions options;
  options.max_depth = band.max_depth;
  options.margin = band.margin;
  return options;
}

}  // namespace

BakedFile bake_sparse(const baker::Mesh& mesh, const Band& band, double tolerance,
                      const std::string& folder) {
  baker::BakeOptions options = options_for(band);
  options.tolerance = tolerance;
  BakedFile file =
      bake_to(mesh, options, "tolerance " + format_quantity(tolerance, Quantity::length), folder);
  file.tolerance = tolerance;
  return file;
}

BakedFile bake_full(const baker::Mesh& mesh, const Band& band, std::size_t planes,
                    std::uint32_t resolution, const std::string& folder) {
  baker::BakeOptions options = options_for(band);
  options.form = AssetForm::full;
  options.planes = planes;
  options.resolution = resolution;
  options.layers = baker::Layers::scalar;
  return bake_to(mesh, options, fmt::format("{} planes, {}x{}", planes, resolution, resolution),
                 folder);
}

}  // namespace spm::bench
