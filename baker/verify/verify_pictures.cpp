// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/verify/verify_pictures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numbers>
#include <string>

#include "baker/pictures/picture_files.hpp"
#include "baker/pictures/picture_legend.hpp"
#include "baker/pictures/picture_text.hpp"
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

namespace taken_colours {
constexpr Colour solid{0.75, 0.75, 0.75}, lid{0.95, 0.6, 0.2}, sheet{0.3, 0.55, 0.9};
}

/// A caster whose rays meet sheets as well.
Caster caster_to_see(OuterSurface surface) {
  surface.solid_count = surface.triangles.size();
  surface.sides = nullptr;
  return Caster(surface);
}

/// The mesh from two sides, coloured by what its triangles are taken for.
std::array<Picture, 2> taken_pictures(const Mesh& mesh, const Vector3& toward) {
  OuterSurface whole;
  whole.vertices = mesh.vertices;
  whole.triangles = mesh.triangles;
  const Caster surface = caster_to_see(whole);
  const auto colour_at = [&](const Vector3& place, const Vector3&) -> std::optional<Colour> {
    const std::size_t triangle = surface.closest(place).triangle;
    if (triangle >= mesh.solid_triangles()) return taken_colours::sheet;
    return triangle + mesh.lid_triangles >= mesh.solid_triangles() ? taken_colours::lid
                                                                   : taken_colours::solid;
  };
  const auto seen = [&](const Vector3& from) {
    return coloured_surface(surface, whole_of(mesh.box_min, mesh.box_max, from), side, colour_at);
  };
  return {seen(toward), seen(-toward)};
}

/// What colours of errors mean, and where the windows lie.
class Legends {
 public:
  Legends(double tolerance, const Vector3& toward)
      : tolerance_(tolerance),
        from_(fmt::format(" Seen from ({:.2f} {:.2f} {:.2f}).", toward.x(), toward.y(),
                          toward.z())) {}

  [[nodiscard]] Legend surface(const Window& whole) const {
    return {"Left: the mesh. Right: the surface as the asset holds it." + from_,
            {},
            {},
            whole.edge / side};
  }
  [[nodiscard]] Legend taken(const Window& whole) const {
    return {"What the mesh is taken for. Left: seen as the others. Right: from behind." + from_,
            {},
            {{taken_colours::solid, "a solid"},
             {taken_colours::lid, "a lid that closes a hole of it"},
             {taken_colours::sheet, "a sheet, felt from both sides"}},
            whole.edge / side};
  }
  [[nodiscard]] Legend structure(const Window& whole, const Window& cut) const {
    namespace colours = structure_colours;
    return {"What answers where. Left: on the surface. Right: in a cut through the band, " +
                length_text(cut.edge) + " wide. The length is that of the left one." + from_,
            {},
            {{colours::one_map, "one distance map"},
             {colours::two_maps, "two"},
             {colours::list, "up to 8 triangles"},
             {colours::long_list, "more triangles"},
             {colours::deep, "deeper than the band"},
             {colours::pruned, "left out"}},
            whole.edge / side};
  }
  [[nodiscard]] Legend direction(const Window& whole, const Window& close) const {
    const double degrees = direction_end * 180 / std::numbers::pi;
    return {"Errors of directions an eighth of the band inside. Left: whole. Right: close, " +
                length_text(close.edge) + " wide. The length is that of the left one." + from_,
            ColourBar{"0", fmt::format("{:.3g} degrees", degrees / 2),
                      fmt::format("{:.3g} degrees", degrees)},
            {{colour_of_error(2, 1), "more"}, {not_judged, "not judged"}},
            whole.edge / side};
  }
  /// `what` is seen in a window.
  [[nodiscard]] Legend error(const std::string& what, const Window& window) const {
    return {"Errors of distances: " + what,
            ColourBar{"0", length_text(tolerance_ / 2), length_text(tolerance_) + ", tolerance"},
            {{colour_of_error(2, 1), "more"}, {Colour{0.16, 0.16, 0.16}, "nothing to judge"}},
            window.edge / side};
  }
  [[nodiscard]] const std::string& from() const noexcept { return from_; }

 private:
  double tolerance_;
  std::string from_;
};

}  // namespace

std::vector<NamedPicture> error_pictures(const AssetView& view, const AssetMetadata& metadata,
                                         const std::string& mesh_path, const VerifyReport& report) {
  const Mesh mesh = mesh_of_asset(metadata, mesh_path);
  const double tolerance = answer_tolerance(metadata);
  const ExactSurface exact(mesh, metadata.sheet_thickness, tolerance);
  const Caster surface = caster_to_see(outer_surface(mesh));
  const Caster known = caster_of(contour_mesh(view, picture_cells));

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
  const ErrorScale scale{exact, view, report.band, tolerance};
  const DirectionScale directions{exact, view, scale.tolerance, direction_end};

  const std::array<Picture, 2> both{render(surface, whole, side), render(known, whole, side)};
  const std::array<Picture, 2> structure{structure_on_surface(surface, view, whole, side),
                                         structure_in_section(exact, view, wide_cut, side)};
  const double inside = -direction_depth * view.band.max_depth;
  const std::array<Picture, 2> direction{
      direction_beside_surface(surface, directions, inside, whole, side),
      direction_beside_surface(surface, directions, inside, close, side)};
  const std::array<Picture, 2> taken = taken_pictures(mesh, whole.toward);
  const Legends legends(scale.tolerance, whole.toward);
  return {
      {"surface.png", with_legend(contact_sheet(both, side), legends.surface(whole))},
      {"taken.png", with_legend(contact_sheet(taken, side), legends.taken(whole))},
      {"structure.png",
       with_legend(contact_sheet(structure, side), legends.structure(whole, wide_cut))},
      {"direction.png",
       with_legend(contact_sheet(direction, side), legends.direction(whole, close))},
      {"error.png",
       with_legend(
           error_on_surface(surface, scale, whole, side),
           legends.error("the largest of three about each place." + legends.from(), whole))},
      {"error-worst.png",
       with_legend(error_on_surface(surface, scale, close, side),
                   legends.error("the same around the worst place." + legends.from(), close))},
      {"error-section.png",
       with_legend(error_in_section(scale, cut, side),
                   legends.error("a cut through the band at the worst place; the exact surface is "
                                 "white.",
                                 cut))}};
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
