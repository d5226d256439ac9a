// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include "common/paper/paper_force.hpp"
#include "tests/bench/geometry/trilinear.hpp"
#include "tests/bench/methods/methods.hpp"
#include "tests/bench/model/paper_maps.hpp"

namespace spm::bench {
namespace {

class Paper : public Method {
 public:
  Paper(const Model& model, std::size_t planes, std::uint32_t resolution)
      : maps_(model.mesh, model.caster, planes, resolution) {
    facts_.name = "paper";
    facts_.settings = maps_.settings();
    facts_.file_bytes = facts_.resident_bytes = maps_.bytes();
    facts_.build_seconds = maps_.build_seconds();
  }

  [[nodiscard]] Answer query(const Vector3& point) const noexcept override {
    if (!point.allFinite()) return far_answer();
    const PaperContact found = paper_contact(maps_.view(), point, PaperRule::closest_plane);
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
  PaperMaps maps_;
};

}  // namespace

std::unique_ptr<Method> make_paper(const Model& model, std::size_t planes,
                                   std::uint32_t resolution) {
  return std::make_unique<Paper>(model, planes, resolution);
}

}  // namespace spm::bench
