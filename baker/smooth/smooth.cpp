// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/smooth/smooth.hpp"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "baker/base/bake_error.hpp"
#include "baker/base/progress_counter.hpp"
#include "baker/cast/cast.hpp"
#include "baker/mesh/triangle_height.hpp"
#include "baker/smooth/mesh_refine.hpp"
#include "baker/smooth/mesh_window.hpp"
#include "baker/smooth/surface_mesh.hpp"
#include "baker/surface/outer_surface.hpp"
#include "common/base/units.hpp"
#include "common/paper/smoothing.hpp"

namespace spm::baker {
namespace {

constexpr double largest_sigma_share = 0.1;  // of the diagonal
constexpr double smallest_sigma_share = 1e-4;
/// Longest edges, in sigmas: for windows to be integrated over, and for a rounded edge to be
/// represented.
constexpr double longest_edge = 1.0;
constexpr double longest_edge_when_sharp = 0.5;
constexpr double sharp_turn = 0.35;  // rad, 20 degrees
/// A vertex moves where a bend is in its window. All of its window needs short edges.
constexpr double window_cutoff = 2 * gaussian_cutoff + longest_edge;  // in sigmas
constexpr double sharp_cutoff = 2;                                    // in sigmas
constexpr std::size_t max_triangles = 2000000;
/// Largest number of visits of vertices, all windows together. These take minutes.
constexpr double max_visits = 4e9;
/// Edges that turn by less than this, rad, count as flat: smoothing moves them by less than 1e-4 of
/// sigma.
constexpr double min_turn = 1e-4;
constexpr std::size_t grain = 64;

[[noreturn]] void refuse(const std::string& message) {
  throw BakeError(ExitCode::usage, "--smooth: " + message);
}

double area_of(const std::vector<Vector3>& points, const Triangle& t) {
  return triangle_area(points[t[0]], points[t[1]], points[t[2]]);
}

/// The outer surface without its sheets, which stay as they are.
SurfaceMesh surface_mesh_of(const OuterSurface& surface) {
  OuterSurface solids = solids_of(surface);
  return {std::move(solids.vertices), std::move(solids.triangles)};
}

bool is_crease(const MeshEdge& edge, const SmoothOptions& options) {
  return options.kind == Smoothing::crease && edge.turn > options.angle;
}

MeshNeighbours neighbours_of(const SurfaceMesh& surface_mesh, const SmoothOptions& options) {
  const MeshEdges edges = edges_of(surface_mesh);
  std::vector<char> fixed(surface_mesh.vertices.size(), 0);
  std::vector<char> bent(surface_mesh.vertices.size(), 0);
  for (const MeshEdge& edge : edges.edges) {
    for (const std::uint32_t end : edge.ends) {
      if (!edge.paired || is_crease(edge, options)) fixed[end] = 1;
      if (edge.turn > min_turn && !is_crease(edge, options)) bent[end] = 1;
    }
  }
  return {surface_mesh, edges, std::move(fixed), std::move(bent)};
}

/// Halves edges near bends that are to be smoothed, and more often near sharp ones.
SurfaceMesh refined_for(SurfaceMesh surface_mesh, const SmoothOptions& options) {
  const auto turns_by = [&](double least) {
    return [&options, least](const MeshEdge& edge) {
      return edge.turn > least && !is_crease(edge, options);
    };
  };
  const double sigma = options.sigma;
  // Halved edges turn as much as the edges that they come from, so the second round finds the sharp
  // ones again.
  surface_mesh = refined(std::move(surface_mesh), turns_by(min_turn), longest_edge * sigma,
                         window_cutoff * sigma, max_triangles);
  return in_order_of_space(refined(std::move(surface_mesh), turns_by(sharp_turn),
                                   longest_edge_when_sharp * sigma, sharp_cutoff * sigma,
                                   max_triangles));
}

/// Refuses what would take hours: a large kernel on a fine mesh.
void check_work(const SurfaceMesh& surface_mesh, double sigma) {
  double area = 0;
  for (const Triangle& triangle : surface_mesh.triangles)
    area += area_of(surface_mesh.vertices, triangle);
  const double cutoff = gaussian_cutoff * sigma;
  const auto count = static_cast<double>(surface_mesh.vertices.size());
  if (count * count * std::min(1.0, 3.14 * cutoff * cutoff / area) > max_visits) {
    refuse("the mesh is too fine for a kernel of sigma " +
           format_quantity(sigma, Quantity::length) + "; ask for a smaller one, or give a mesh " +
           "with fewer triangles");
  }
}

std::vector<Vector3> smoothed_points(const MeshNeighbours& neighbours, double sigma,
                                     const Progress& progress) {
  std::vector<Vector3> points = neighbours.surface_mesh().vertices;
  // A little more than a window's reach, for the rounding on the way.
  const std::vector<char> moves = MeshWindow(neighbours).near_bends(1.01 * gaussian_cutoff * sigma);
  tbb::enumerable_thread_specific<MeshWindow> windows([&] { return MeshWindow(neighbours); });
  ProgressCounter counter(progress, "smooth", points.size() / grain + 1);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, points.size(), grain),
                    [&](const tbb::blocked_range<std::size_t>& range) {
                      MeshWindow& window = windows.local();
                      for (std::size_t i = range.begin(); i != range.end(); ++i) {
                        if (moves[i] == 0) continue;
                        const auto moved = window.smoothed(static_cast<std::uint32_t>(i), sigma);
                        if (moved) points[i] = *moved;
                      }
                      counter.done();
                    });
  return points;
}

/// A distance between the surfaces, and the area to which it applies.
struct Gap {
  double distance = 0;
  double area = 0;
};

/// Distances from corners and middles of the triangles of one surface to the other, where the two
/// differ. `third` is a third of the area of each corner's triangles.
std::vector<Gap> gaps(const std::vector<Vector3>& points, const std::vector<Vector3>& others,
                      const std::vector<Triangle>& triangles, const Caster& other) {
  std::vector<Gap> found(points.size() + triangles.size());
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const double area = area_of(points, triangles[i]);
    found[points.size() + i].area = area;
    for (const std::uint32_t corner : triangles[i]) found[corner].area += area / 3;
  }
  const auto same = [&](std::uint32_t corner) { return points[corner] == others[corner]; };
  tbb::parallel_for(std::size_t{0}, found.size(), [&](std::size_t i) {
    if (i < points.size()) {
      if (!same(static_cast<std::uint32_t>(i))) {
        found[i].distance = std::abs(other.closest(points[i]).distance);
      }
      return;
    }
    const Triangle& t = triangles[i - points.size()];
    if (std::all_of(t.begin(), t.end(), same)) return;
    const Vector3 middle = (points[t[0]] + points[t[1]] + points[t[2]]) / 3;
    found[i].distance = std::abs(other.closest(middle).distance);
  });
  return found;
}

Caster caster_of(const std::vector<Vector3>& points, const std::vector<Triangle>& triangles) {
  OuterSurface surface;
  surface.vertices = points;
  surface.triangles = triangles;
  surface.solid_count = triangles.size();
  return Caster(surface);
}

/// The distances between the two surfaces, measured from both. Where a thorn was smoothed away, the
/// new surface is near the old one, but the thorn's tip is far from the new one.
void measure(const SurfaceMesh& before, const std::vector<Vector3>& after, SmoothReport& report) {
  const Caster old_surface = caster_of(before.vertices, before.triangles);
  const Caster new_surface = caster_of(after, before.triangles);
  std::vector<Gap> all = gaps(after, before.vertices, before.triangles, old_surface);
  const std::vector<Gap> back = gaps(before.vertices, after, before.triangles, new_surface);
  all.insert(all.end(), back.begin(), back.end());
  std::sort(all.begin(), all.end(), [](const Gap& a, const Gap& b) {
    return a.distance != b.distance ? a.distance < b.distance : a.area < b.area;
  });
  double area = 0, squares = 0;
  for (const Gap& gap : all) {
    area += gap.area;
    squares += gap.area * gap.distance * gap.distance;
  }
  report.rms = area > 0 ? std::sqrt(squares / area) : 0;
  report.max = all.back().distance;
  double below = 0;
  for (const Gap& gap : all) {
    report.p99 = gap.distance;
    below += gap.area;
    if (below >= 0.99 * area) break;
  }
}

/// The smoothed surface as a mesh of the same file, without triangles that lost their area, and
/// with the sheets.
Mesh mesh_from(const Mesh& mesh, const OuterSurface& surface, const SurfaceMesh& surface_mesh,
               std::vector<Vector3> points) {
  Mesh smoothed = mesh;
  smoothed.vertices = std::move(points);
  smoothed.triangles = surface_mesh.triangles;
  std::erase_if(smoothed.triangles,
                [&](const Triangle& t) { return !(area_of(smoothed.vertices, t) > 0); });
  smoothed.notes.clear();
  std::map<std::uint32_t, std::uint32_t> numbers;
  for (std::size_t t = surface.solid_count; t < surface.triangles.size(); ++t) {
    Triangle sheet = surface.triangles[t];
    for (std::uint32_t& corner : sheet) {
      const auto [known, fresh] =
          numbers.try_emplace(corner, static_cast<std::uint32_t>(smoothed.vertices.size()));
      if (fresh) smoothed.vertices.push_back(surface.vertices[corner]);
      corner = known->second;
    }
    smoothed.triangles.push_back(sheet);
  }
  smoothed.sheet_triangles = surface.triangles.size() - surface.solid_count;
  return smoothed;
}

}  // namespace

SmoothOptions fitted_to(SmoothOptions options, double diagonal) {
  const auto length = [](double metres) { return format_quantity(metres, Quantity::length); };
  if (options.kind == Smoothing::crease && options.sigma == 0) {
    options.sigma = crease_sigma_share * diagonal;
  }
  if (options.sigma > largest_sigma_share * diagonal) {
    refuse("a SIGMA of " + length(options.sigma) +
           " is more than a tenth of the object's diagonal, " + length(diagonal) +
           ", and would leave little of it; ask for a smaller one");
  }
  if (options.kind != Smoothing::none && options.sigma < smallest_sigma_share * diagonal) {
    refuse("a SIGMA of " + length(options.sigma) +
           " is less than a ten-thousandth of the object's diagonal, " + length(diagonal) +
           "; ask for a larger one, or for none");
  }
  return options;
}

Mesh smoothed_mesh(const Mesh& mesh, const SmoothOptions& options, const Progress& progress,
                   SmoothReport& report) {
  const SmoothOptions fitted = fitted_to(options, mesh.diagonal);
  const OuterSurface surface = outer_surface(mesh);
  report = {};
  report.options = fitted;
  report.hidden = surface.hidden;
  const SurfaceMesh surface_mesh = refined_for(surface_mesh_of(surface), fitted);
  check_work(surface_mesh, fitted.sigma);
  std::vector<Vector3> points =
      smoothed_points(neighbours_of(surface_mesh, fitted), fitted.sigma, progress);
  if (!surface_mesh.triangles.empty()) measure(surface_mesh, points, report);
  return mesh_from(mesh, surface, surface_mesh, std::move(points));
}

}  // namespace spm::baker
