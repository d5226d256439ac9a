// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/model/baked_file.hpp"

#include <fmt/format.h>

#include <filesystem>

#include "baker/pipeline/bake.hpp"
#include "common/base/units.hpp"
#include "formats/asset/asset_writer.hpp"
#include "tests/bench/base/unwrap.hpp"
#include "tests/bench/model/model.hpp"

namespace spm::bench {

BakedFile baked_file(const SparseOptions& options, const std::string& folder) {
  BakedFile file;
  file.settings = "tolerance " + format_quantity(options.tolerance, Quantity::length);
  file.tolerance = options.tolerance;
  const std::string name = fmt::format("{:.0f}nm.spm.exr", 1e9 * options.tolerance);
  file.path = (std::filesystem::path(folder) / name).string();
  return file;
}

BakedFile bake_sparse(const baker::Mesh& mesh, const SparseOptions& options,
                      const std::string& folder) {
  const Clock::time_point start = Clock::now();
  baker::BakeOptions bake;
  bake.max_depth = options.band.max_depth;
  bake.margin = options.band.margin;
  bake.tolerance = options.tolerance;
  bake.probe_radius = options.probe_radius;
  const baker::BakeResult baked = baker::bake(mesh, bake);
  BakedFile file = baked_file(options, folder);
  file.bytes = unwrap(write_asset(baked.asset, file.path)).total;
  file.seconds = seconds_since(start);
  return file;
}

}  // namespace spm::bench
