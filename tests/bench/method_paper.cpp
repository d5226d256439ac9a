// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include "common/paper_force.hpp"
#include "formats/mapped_asset.hpp"
#include "tests/bench/methods.hpp"
#include "tests/bench/trilinear.hpp"
#include "tests/bench/unwrap.hpp"

namespace spm::bench {
namespace {

class Paper : public Method {
 public:
  explicit Paper(const BakedFile& file) : asset_(unwrap(MappedAsset::open(file.path))) {
    facts_.name = "paper";
    facts_.settings = file.settings;
    facts_.bytes = paper_bytes(*asset_);
    facts_.build_seconds = file.seconds;
  }

  [[nodiscard]] Answer query(const Vector3& point) const noexcept override {
    const PaperContact found = paper_contact(asset_->view(), point, PaperRule::closest_plane);
    if (!std::isfinite(found.surface_distance)) return far_answer();
    Answer answer;
    answer.distance = found.surface_distance - found.plane_depth;
    answer.normal = found.normal;
    answer.plane = static_cast<std::int32_t>(found.plane);
    answer.source = Source::map;
    answer.status = Status::exact;
    return answer;
  }

 private:
  std::unique_ptr<MappedAsset> asset_;
};

}  // namespace

std::uint64_t paper_bytes(const MappedAsset& asset) {
  // For the search four doubles a plane, then the chosen plane and its map.
  const std::size_t plane = 4 * sizeof(double) + sizeof(SupportPlane) + sizeof(DistanceMap);
  return asset.bytes().samples + plane * asset.view().planes.size();
}

std::unique_ptr<Method> make_paper(const BakedFile& file) { return std::make_unique<Paper>(file); }

}  // namespace spm::bench
