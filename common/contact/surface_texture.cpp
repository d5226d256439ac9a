// SPDX-License-Identifier: Apache-2.0
#include "common/contact/surface_texture.hpp"

#include <array>
#include <cmath>
#include <cstddef>

#include "common/base/random.hpp"

namespace spm {

namespace {

constexpr double max_cells = 1e12;  ///< from the origin, along an axis

/// The value at a corner of the lattice, -1 to 1.
double corner_value(std::uint64_t seed, std::int64_t x, std::int64_t y, std::int64_t z) noexcept {
  std::uint64_t bits = mixed_bits(seed);
  for (const std::int64_t each : {x, y, z})
    bits = mixed_bits(bits ^ static_cast<std::uint64_t>(each));
  return 2 * unit_of_bits(bits) - 1;
}

/// The blend from one corner to the next, and its slope; t from 0 to 1.
struct Blend {
  double value, slope;
  explicit Blend(double t) noexcept
      : value(t * t * t * (t * (6 * t - 15) + 10)), slope(30 * t * t * (t - 1) * (t - 1)) {}
};

}  // namespace

TextureHeight texture_at(const TextureSettings& settings, const Vector3& place) noexcept {
  const Vector3 cells = place / settings.wavelength;
  // Written so that NaN is rejected as well.
  if (!(cells.cwiseAbs().maxCoeff() < max_cells) || !cells.allFinite()) return {};
  const Vector3 low = cells.array().floor();
  const std::array<Blend, 3> blend{Blend(cells.x() - low.x()), Blend(cells.y() - low.y()),
                                   Blend(cells.z() - low.z())};
  TextureHeight result;
  for (std::size_t corner = 0; corner < 8; ++corner) {
    std::array<double, 3> weight{}, slope{};
    std::array<std::int64_t, 3> at{};
    for (std::size_t k = 0; k < 3; ++k) {
      const bool high = ((corner >> k) & 1U) != 0;
      at[k] = static_cast<std::int64_t>(low[static_cast<Eigen::Index>(k)]) + (high ? 1 : 0);
      weight[k] = high ? blend[k].value : 1 - blend[k].value;
      slope[k] = high ? blend[k].slope : -blend[k].slope;
    }
    const double value = corner_value(settings.seed, at[0], at[1], at[2]);
    result.height += value * weight[0] * weight[1] * weight[2];
    result.gradient +=
        value * Vector3(slope[0] * weight[1] * weight[2], weight[0] * slope[1] * weight[2],
                        weight[0] * weight[1] * slope[2]);
  }
  result.height *= settings.amplitude;
  result.gradient *= settings.amplitude / settings.wavelength;
  return result;
}

Vector3 textured_force(double stiffness, double depth, const Vector3& normal,
                       const TextureHeight& texture) noexcept {
  const double raised = depth + texture.height;
  if (!(raised > 0)) return Vector3::Zero();
  return stiffness * raised * (normal - texture.gradient);
}

}  // namespace spm
