// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/trials.hpp"

#include <algorithm>

#include "baker/random.hpp"

namespace spm::baker {

Trials::Trials(const Caster& caster, const Band& band, std::uint64_t count, std::uint64_t seed)
    : caster_(caster), band_(band), count_(count), seed_(seed) {
  double sum = 0;
  for (std::uint32_t i = 0; i < caster.surface_count(); ++i) {
    const Vector3& a = caster.corner(i, 0);
    sum += (caster.corner(i, 1) - a).cross(caster.corner(i, 2) - a).norm();
    areas_.push_back(sum);
  }
}

Probe Trials::probe(std::uint64_t index) const {
  const double share = random_unit(seed_, 4 * index) * areas_.back();
  const auto place = std::upper_bound(areas_.begin(), areas_.end(), share) - areas_.begin();
  const auto triangle =
      static_cast<std::uint32_t>(std::min(static_cast<std::size_t>(place), areas_.size() - 1));
  double x = random_unit(seed_, 4 * index + 1);
  double y = random_unit(seed_, 4 * index + 2);
  if (x + y > 1) {
    x = 1 - x;
    y = 1 - y;
  }
  const double height =
      -band_.max_depth + (band_.max_depth + band_.margin) * random_unit(seed_, 4 * index + 3);
  const Vector3& a = caster_.corner(triangle, 0);
  const Vector3 foot =
      a + x * (caster_.corner(triangle, 1) - a) + y * (caster_.corner(triangle, 2) - a);
  const Vector3& normal = caster_.normal(triangle);
  return {foot + height * normal, normal, height};
}

}  // namespace spm::baker
