// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/verify/render.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "common/query/query.hpp"
#include "common/surface/support_plane_mapping.hpp"

namespace spm::baker {

namespace {

constexpr double background = 0.16;
constexpr Colour nothing{background, background, background};
/// The colour of an error beyond the tolerance.
constexpr Colour beyond{0.85, 0.1, 0.1};
/// Windows on a whole object leave this much room around it.
constexpr double room = 1.05;

/// Fills a square picture, row by row from the top, with one colour a place: eta to the right,
/// omega upward, metres from the window's middle.
template <class Shade>
Picture paint(const Window& window, std::uint32_t side, const Shade& shade) {
  Picture picture{side, side, std::vector<std::uint8_t>(std::size_t{3} * side * side)};
  tbb::parallel_for(std::uint32_t{0}, side, [&](std::uint32_t row) {
    for (std::uint32_t column = 0; column < side; ++column) {
      const double eta = ((column + 0.5) / side - 0.5) * window.edge;
      const double omega = (0.5 - (row + 0.5) / side) * window.edge;
      const Colour parts = shade(eta, omega);
      for (std::size_t k = 0; k < 3; ++k) {
        picture.pixels[std::size_t{3} * (std::size_t{row} * side + column) + k] =
            static_cast<std::uint8_t>(std::lround(255 * std::clamp(parts[k], 0.0, 1.0)));
      }
    }
  });
  return picture;
}

/// Casts rays from beyond a surface to what a window shows of it.
class Eye {
 public:
  Eye(const Caster& surface, const Window& window)
      : surface_(surface),
        plane_(plane_with_normal(window.middle + 2 * surface.diagonal() * window.toward,
                                 window.toward)) {}

  [[nodiscard]] std::optional<Crossing> at(double eta, double omega) const {
    return surface_.first_between(plane_, eta, omega, 0, 4 * surface_.diagonal());
  }
  [[nodiscard]] Vector3 place(double eta, double omega, const Crossing& crossing) const {
    return support_plane_point(plane_, eta, omega) - crossing.depth * plane_.n;
  }
  /// How much light from the upper left falls on a triangle, 0 to 1, whichever of its sides is
  /// visible.
  [[nodiscard]] double light(const Crossing& crossing) const {
    const Vector3& normal = surface_.normal(crossing.triangle);
    const Vector3 seen = normal.dot(plane_.n) < 0 ? Vector3(-normal) : normal;
    const Vector3 lamp = (-plane_.u + plane_.v + 2 * plane_.n).normalized();
    return 0.25 + 0.75 * std::max(0.0, seen.dot(lamp));
  }

 private:
  const Caster& surface_;
  SupportPlane plane_;
};

/// Error of an asset's distance at a place of the band, m. Empty outside the band or without an
/// answer.
std::optional<double> error_at(const ErrorScale& scale, const Vector3& place) {
  const double truth = scale.exact.distance(place, scale.exact.closest(place));
  if (truth < -scale.band.max_depth || truth > scale.band.margin) return std::nullopt;
  const Answer answer = query_point(scale.asset, place);
  if (!std::isfinite(answer.distance)) return std::nullopt;
  return std::abs(answer.distance - truth);
}

}  // namespace

Window whole_of(const Vector3& low, const Vector3& high, const Vector3& toward) {
  const SupportPlane plane = plane_with_normal(Vector3::Zero(), toward);
  const Vector3 size = high - low;
  const double width = size.dot(plane.u.cwiseAbs());
  const double height = size.dot(plane.v.cwiseAbs());
  return {(low + high) / 2, toward, room * std::max(width, height)};
}

Caster caster_of(const ContourMesh& surface) {
  OuterSurface loose;
  for (const auto& [x, y, z] : surface.vertices) loose.vertices.emplace_back(x, y, z);
  for (std::size_t i = 0; i + 2 < surface.triangles.size(); i += 3) {
    loose.triangles.push_back(
        {surface.triangles[i], surface.triangles[i + 1], surface.triangles[i + 2]});
  }
  loose.solid_count = loose.triangles.size();
  return Caster(loose);
}

Picture render(const Caster& surface, const Window& window, std::uint32_t side) {
  const Eye eye(surface, window);
  return paint(window, side, [&](double eta, double omega) -> Colour {
    const std::optional<Crossing> crossing = eye.at(eta, omega);
    const double grey = crossing ? eye.light(*crossing) : background;
    return {grey, grey, grey};
  });
}

Colour colour_of_error(double error, double allowed) {
  return error > allowed ? beyond : ramp_at(error / allowed);
}

Picture coloured_surface(const Caster& surface, const Window& window, std::uint32_t side,
                         const SurfaceColourAt& colour_at) {
  const Eye eye(surface, window);
  return paint(window, side, [&](double eta, double omega) -> Colour {
    const std::optional<Crossing> crossing = eye.at(eta, omega);
    if (!crossing) return nothing;
    std::optional<Colour> colour =
        colour_at(eye.place(eta, omega, *crossing), surface.normal(crossing->triangle));
    if (!colour) return nothing;
    for (double& part : *colour) part *= 0.4 + 0.6 * eye.light(*crossing);
    return *colour;
  });
}

Picture coloured_section(const ExactSurface& exact, const Window& window, std::uint32_t side,
                         const ColourAt& colour_at) {
  const SupportPlane plane = plane_with_normal(window.middle, window.toward);
  const double line = window.edge / side;  // a pixel
  return paint(window, side, [&](double eta, double omega) -> Colour {
    const Vector3 place = support_plane_point(plane, eta, omega);
    if ((exact.closest(place).position - place).norm() < line / 2) return {1, 1, 1};
    return colour_at(place).value_or(nothing);
  });
}

std::optional<double> largest_error_at(const ErrorScale& scale, const Vector3& place,
                                       const Vector3& normal) {
  std::optional<double> largest;
  for (const int k : {-1, 0, 1}) {
    const std::optional<double> error = error_at(scale, place + k * scale.tolerance * normal);
    if (error) largest = std::max(largest.value_or(0), *error);
  }
  return largest;
}

Picture error_on_surface(const Caster& surface, const ErrorScale& scale, const Window& window,
                         std::uint32_t side) {
  const auto colour_at = [&](const Vector3& place, const Vector3& normal) -> std::optional<Colour> {
    const std::optional<double> largest = largest_error_at(scale, place, normal);
    if (!largest) return std::nullopt;
    return colour_of_error(*largest, scale.tolerance);
  };
  return coloured_surface(surface, window, side, colour_at);
}

Picture error_in_section(const ErrorScale& scale, const Window& window, std::uint32_t side) {
  const auto colour_at = [&](const Vector3& place) -> std::optional<Colour> {
    const std::optional<double> error = error_at(scale, place);
    if (!error) return std::nullopt;
    return colour_of_error(*error, scale.tolerance);
  };
  return coloured_section(scale.exact, window, side, colour_at);
}

}  // namespace spm::baker
