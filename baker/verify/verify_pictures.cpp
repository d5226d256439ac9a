// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/verify/verify_pictures.hpp"

#include <algorithm>
#include <array>

#include "baker/pictures/picture_files.hpp"
#include "baker/verify/render.hpp"

namespace spm::baker {

namespace {

constexpr std::uint32_t side = 480;   ///< pixels
constexpr double close_share = 0.08;  ///< of the diagonal, what a close window shows

}  // namespace

std::vector<std::string> write_error_pictures(const AssetView& view, const AssetMetadata& metadata,
                                              const std::string& mesh_path,
                                              const VerifyReport& report,
                                              const std::string& folder) {
  const std::filesystem::path place = make_picture_folder(folder);
  const Mesh mesh = mesh_of_asset(metadata, mesh_path);
  const ExactSurface exact(mesh);
  const Caster surface(outer_surface(mesh));
  const Caster known = caster_of(known_surface(view));

  const bool hard = report.adversarial.distance.max > report.distance.max;
  const Vector3 largest = hard ? report.adversarial.worst_point : report.worst_point;
  // A place without an answer is worse than any error.
  const Vector3 worst = report.worst.empty() ? largest : report.worst.front().point;
  const SurfacePoint closest_point = exact.closest(worst);
  const Window whole = whole_of(mesh.box_min, mesh.box_max, closest_point.normal);
  const Window close{closest_point.position, closest_point.normal, close_share * mesh.diagonal};
  // A cut across the surface, so that the band is visible.
  const Window cut{worst, closest_point.normal.unitOrthogonal(),
                   4 * std::max(view.band.max_depth, view.band.margin)};
  const ErrorScale scale{exact, view, report.band,
                         metadata.tolerance.value_or(metadata.diagonal / 1000)};

  const std::array<Picture, 2> both{render(surface, whole, side), render(known, whole, side)};
  return {save_picture(contact_sheet(both, side), place / "surface.png"),
          save_picture(error_on_surface(surface, scale, whole, side), place / "error.png"),
          save_picture(error_on_surface(surface, scale, close, side), place / "error-worst.png"),
          save_picture(error_in_section(scale, cut, side), place / "error-section.png")};
}

}  // namespace spm::baker
