// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/verify/verify_pictures.hpp"

#include <algorithm>
#include <array>
#include <numbers>

#include "baker/pictures/picture_files.hpp"
#include "baker/verify/direction_picture.hpp"
#include "baker/verify/outcome.hpp"
#include "baker/verify/structure_picture.hpp"

namespace spm::baker {

namespace {

constexpr std::uint32_t side = 480;   ///< pixels
constexpr double close_share = 0.08;  ///< of the diagonal, what a close window shows
/// The end of the colours of directions, rad: the same for all assets, so that pictures compare.
constexpr double direction_end = 15 * std::numbers::pi / 180;
/// How deep inside directions are compared, of the band. Deeper, several facets of a fine mesh are
/// equally near almost everywhere.
constexpr double direction_depth = 0.125;

/// The axis across a cut that shows the octree's cubes as squares and the surface as a line.
Vector3 axis_of_cut(const Vector3& normal) {
  Eigen::Index flattest = 0;
  normal.cwiseAbs().minCoeff(&flattest);
  return Vector3::Unit(flattest);
}

}  // namespace

std::vector<NamedPicture> error_pictures(const AssetView& view, const AssetMetadata& metadata,
                                         const std::string& mesh_path, const VerifyReport& report) {
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
  const Window cut{worst, axis_of_cut(closest_point.normal),
                   4 * std::max(view.band.max_depth, view.band.margin)};
  const Window wide_cut{cut.middle, cut.toward, 2 * cut.edge};
  const ErrorScale scale{exact, view, report.band,
                         metadata.tolerance.value_or(metadata.diagonal / 1000)};
  const DirectionScale directions{exact, view, scale.tolerance, hole_share * metadata.diagonal,
                                  direction_end};

  const std::array<Picture, 2> both{render(surface, whole, side), render(known, whole, side)};
  const std::array<Picture, 2> structure{structure_on_surface(surface, view, whole, side),
                                         structure_in_section(exact, view, wide_cut, side)};
  const double inside = -direction_depth * view.band.max_depth;
  const std::array<Picture, 2> direction{
      direction_beside_surface(surface, directions, inside, whole, side),
      direction_beside_surface(surface, directions, inside, close, side)};
  return {{"surface.png", contact_sheet(both, side)},
          {"structure.png", contact_sheet(structure, side)},
          {"direction.png", contact_sheet(direction, side)},
          {"error.png", error_on_surface(surface, scale, whole, side)},
          {"error-worst.png", error_on_surface(surface, scale, close, side)},
          {"error-section.png", error_in_section(scale, cut, side)}};
}

std::vector<std::string> write_error_pictures(const AssetView& view, const AssetMetadata& metadata,
                                              const std::string& mesh_path,
                                              const VerifyReport& report,
                                              const std::string& folder) {
  const std::filesystem::path place = make_picture_folder(folder);
  std::vector<std::string> paths;
  for (const NamedPicture& made : error_pictures(view, metadata, mesh_path, report)) {
    paths.push_back(save_picture(made.picture, place / made.name));
  }
  return paths;
}

}  // namespace spm::baker
