// SPDX-License-Identifier: GPL-3.0-or-later
#include <filesystem>
#include <system_error>
#include <utility>

#include "baker/bake.hpp"
#include "baker/bake_error.hpp"
#include "common/units.hpp"
#include "formats/mapped_asset.hpp"
#include "tests/bench/methods.hpp"

namespace spm::bench {
namespace {

template <class T>
T unwrap(Result<T> result) {
  if (!result) throw baker::BakeError(result.error().code, result.error().message);
  return std::move(*result);
}

class Spm : public Method {
 public:
  Spm(const Model& model, double tolerance, const std::string& folder) {
    const Clock::time_point start = Clock::now();
    baker::BakeOptions options;
    options.tolerance = tolerance;
    options.max_depth = model.band.max_depth;
    options.margin = model.band.margin;
    const baker::BakeResult baked = baker::bake(model.mesh, options);
    const std::string path = (std::filesystem::path(folder) / "asset.spm.exr").string();
    const AssetBytes written = unwrap(write_asset(baked.asset, path));
    facts_.name = "spm";
    facts_.settings = "tolerance " + format_quantity(tolerance, Quantity::length);
    facts_.setting = tolerance;
    facts_.bytes = written.total;
    facts_.build_seconds = seconds_since(start);
    asset_ = unwrap(MappedAsset::open(path));
    // The mapping stays; the name is free for the next one.
    std::error_code ignored;
    std::filesystem::remove(path, ignored);
  }

  [[nodiscard]] Answer query(const Vector3& point) const noexcept override {
    return query_point(asset_->view(), point);
  }

 private:
  std::unique_ptr<MappedAsset> asset_;
};

}  // namespace

std::unique_ptr<Method> make_spm(const Model& model, double tolerance, const std::string& folder) {
  return std::make_unique<Spm>(model, tolerance, folder);
}

}  // namespace spm::bench
