// SPDX-License-Identifier: GPL-3.0-or-later
#include "common/contact/force_law.hpp"
#include "formats/asset/mapped_asset.hpp"
#include "tests/bench/base/unwrap.hpp"
#include "tests/bench/methods/probe_method.hpp"

namespace spm::bench {
namespace {

class SpmProbe final : public ProbeMethod {
 public:
  SpmProbe(const BakedFile& file, double radius)
      : ProbeMethod("spm", file.settings), asset_(unwrap(MappedAsset::open(file.path))) {
    settings_.probe_radius = radius;
  }

  [[nodiscard]] double depth(const Vector3& centre) override {
    return contact_force(asset_->view(), settings_, centre).depth;
  }

 private:
  std::unique_ptr<MappedAsset> asset_;
  ForceSettings settings_;
};

}  // namespace

std::unique_ptr<ProbeMethod> make_spm_probe(const BakedFile& file, double radius) {
  return std::make_unique<SpmProbe>(file, radius);
}

}  // namespace spm::bench
