// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/smooth/smooth.hpp"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "baker/base/bake_error.hpp"
#include "baker/base/progress_counter.hpp"
#include "baker/cast/cast.hpp"
#include "baker/mesh/triangle_height.hpp"
#include "baker/smooth/mesh_refine.hpp"
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

constexpr double unknown = std::numeric_limits<double>::infinity();

/// Turns the counts of each vertex's entries, which are shifted by one, into the indices where its
/// entries begin.
void accumulate(std::vector<std::uint32_t>& first) {
  for (std::size_t i = 1; i < first.size(); ++i) first[i] += first[i - 1];
}

/// A mesh with its neighbourhoods. Immutable; any number of threads may read it.
class MeshNeighbours {
 public:
  /// A triangle seen from one of its corners, anticlockwise.
  struct Corner {
    std::uint32_t next, last;  ///< the other corners
    double to_next, to_last;   ///< lengths of the sides from here, m
    double across;             ///< of the third one
    double twice_area;         ///< m2
  };
  /// The other end of an edge.
  struct Neighbour {
    std::uint32_t vertex;
    double length2;  ///< m2
    double area;     ///< a third of the edge's triangles, m2
  };

  /// `fixed` vertices stay where they are and end every window. At `bent` vertices the mesh is not
  /// flat. One flag for each vertex. The mesh must outlive this.
  MeshNeighbours(const SurfaceMesh& surface_mesh, const MeshEdges& edges, std::vector<char> fixed,
                 std::vector<char> bent)
      : surface_mesh_(surface_mesh),
        fixed_(std::move(fixed)),
        bent_(std::move(bent)),
        first_corner_(surface_mesh.vertices.size() + 1, 0),
        first_neighbour_(surface_mesh.vertices.size() + 1, 0),
        corners_(3 * surface_mesh.triangles.size()),
        neighbours_(2 * edges.edges.size()) {
    add_corners();
    add_neighbours(edges);
  }

  [[nodiscard]] const SurfaceMesh& surface_mesh() const { return surface_mesh_; }
  [[nodiscard]] bool fixed(std::uint32_t vertex) const { return fixed_[vertex] != 0; }
  [[nodiscard]] bool bent(std::uint32_t vertex) const { return bent_[vertex] != 0; }
  [[nodiscard]] std::span<const Corner> corners(std::uint32_t vertex) const {
    return std::span(corners_).subspan(first_corner_[vertex],
                                       first_corner_[vertex + 1] - first_corner_[vertex]);
  }
  [[nodiscard]] std::span<const Neighbour> neighbours(std::uint32_t vertex) const {
    return std::span(neighbours_)
        .subspan(first_neighbour_[vertex], first_neighbour_[vertex + 1] - first_neighbour_[vertex]);
  }

 private:
  void add_corners() {
    for (const Triangle& triangle : surface_mesh_.triangles) {
      for (const std::uint32_t corner : triangle) ++first_corner_[corner + 1];
    }
    accumulate(first_corner_);
    std::vector<std::uint32_t> free = first_corner_;
    for (const Triangle& t : surface_mesh_.triangles) {
      const std::array<Vector3, 3> sides{
          surface_mesh_.vertices[t[1]] - surface_mesh_.vertices[t[0]],
          surface_mesh_.vertices[t[2]] - surface_mesh_.vertices[t[1]],
          surface_mesh_.vertices[t[0]] - surface_mesh_.vertices[t[2]]};
      const double twice_area = sides[0].cross(sides[1]).norm();
      for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t next = (k + 1) % 3, last = (k + 2) % 3;
        corners_[free[t[k]]++] = {
            t[next], t[last], sides[k].norm(), sides[last].norm(), sides[next].norm(), twice_area};
      }
    }
  }

  void add_neighbours(const MeshEdges& edges) {
    for (const MeshEdge& edge : edges.edges) {
      for (const std::uint32_t end : edge.ends) ++first_neighbour_[end + 1];
    }
    accumulate(first_neighbour_);
    std::vector<std::uint32_t> free = first_neighbour_;
    for (const MeshEdge& edge : edges.edges) {
      const auto& [a, b] = edge.ends;
      const double length2 = (surface_mesh_.vertices[b] - surface_mesh_.vertices[a]).squaredNorm();
      neighbours_[free[a]++] = {b, length2, edge.area};
      neighbours_[free[b]++] = {a, length2, edge.area};
    }
  }

  const SurfaceMesh& surface_mesh_;
  std::vector<char> fixed_, bent_;
  std::vector<std::uint32_t> first_corner_, first_neighbour_;
  std::vector<Corner> corners_;
  std::vector<Neighbour> neighbours_;
};

/// The window of a filter around a vertex. It is unrolled along the mesh from triangle to
/// triangle, so that nothing beyond a silhouette and no other layer of surface can come into it.
/// Each thread needs its own.
class MeshWindow {
 public:
  explicit MeshWindow(const MeshNeighbours& neighbours)
      : neighbours_(neighbours),
        distance_(neighbours.surface_mesh().vertices.size(), unknown),
        settled_(neighbours.surface_mesh().vertices.size(), 0) {}

  /// Where eq. 16 moves a vertex: to the mean of the mesh around it, weighted by the Gaussian of
  /// the distance along the mesh. The window ends at the nearest fixed vertex, and the kernel
  /// narrows with it. Metres. Empty where the vertex is fixed or the mesh is flat all over the
  /// window.
  [[nodiscard]] std::optional<Vector3> smoothed(std::uint32_t vertex, double sigma) {
    if (neighbours_.fixed(vertex)) return std::nullopt;
    offer(vertex, 0);
    const double limit = explore(gaussian_cutoff * sigma, true);
    const bool flat = std::none_of(window_.begin(), window_.end(),
                                   [&](std::uint32_t v) { return neighbours_.bent(v); });
    const std::vector<Vector3>& points = neighbours_.surface_mesh().vertices;
    const Vector3& centre = points[vertex];
    GaussianWindow<Vector3> filter(limit / gaussian_cutoff, Vector3::Zero());
    for (const std::uint32_t from : window_) {
      if (flat) break;
      for (const MeshNeighbours::Neighbour& neighbour : neighbours_.neighbours(from)) {
        const std::uint32_t to = neighbour.vertex;
        if (settled_[to] != 0 && to < from) continue;
        // The middles of the sides integrate a quadratic function exactly. Their distance is the
        // length of a median.
        const double squares = distance_[from] * distance_[from] + distance_[to] * distance_[to];
        const double distance2 = std::max(0.0, (squares - neighbour.length2 / 2) / 2);
        if (distance2 > limit * limit) continue;
        filter.add(std::sqrt(distance2), 0, neighbour.area,
                   (points[from] + points[to]) / 2 - centre);
      }
    }
    forget();
    if (!(filter.weight() > 0)) return std::nullopt;
    return centre + filter.value();
  }

  /// The vertices that are within `distance` metres of a bent one along the mesh, as flags. Around
  /// the other vertices the mesh is flat.
  [[nodiscard]] std::vector<char> near_bends(double distance) {
    const auto count = static_cast<std::uint32_t>(neighbours_.surface_mesh().vertices.size());
    for (std::uint32_t vertex = 0; vertex < count; ++vertex) {
      if (neighbours_.bent(vertex)) offer(vertex, 0);
    }
    (void)explore(distance, false);
    std::vector<char> near = settled_;
    forget();
    return near;
  }

 private:
  using Entry = std::pair<double, std::uint32_t>;

  /// Goes outwards from the vertices whose distances were offered, up to `limit` metres. With
  /// `fixed_end` it stops at the first fixed vertex. Returns how far it came.
  [[nodiscard]] double explore(double limit, bool fixed_end) {
    while (!heap_.empty()) {
      std::pop_heap(heap_.begin(), heap_.end(), std::greater<>());
      const auto [distance, vertex] = heap_.back();
      heap_.pop_back();
      if (settled_[vertex] != 0) continue;
      if (distance > limit) break;
      if (fixed_end && neighbours_.fixed(vertex)) {
        limit = distance;
        break;
      }
      settled_[vertex] = 1;
      window_.push_back(vertex);
      pass_on(vertex);
    }
    return limit;
  }

  void forget() {
    for (const std::uint32_t vertex : known_) {
      distance_[vertex] = unknown;
      settled_[vertex] = 0;
    }
    known_.clear();
    window_.clear();
    heap_.clear();
  }

  /// Passes a vertex's final distance on to its neighbours: along edges, and straight across the
  /// triangles of which a second corner is final too.
  void pass_on(std::uint32_t vertex) {
    const double distance = distance_[vertex];
    for (const MeshNeighbours::Corner& corner : neighbours_.corners(vertex)) {
      const bool next = settled_[corner.next] != 0;
      const bool last = settled_[corner.last] != 0;
      if (!next) offer(corner.next, distance + corner.to_next);
      if (!last) offer(corner.last, distance + corner.to_last);
      if (next && !last) {
        pass_across(distance, distance_[corner.next], corner, corner.to_last, corner.to_next,
                    corner.last);
      } else if (last && !next) {
        pass_across(distance, distance_[corner.last], corner, corner.to_next, corner.to_last,
                    corner.next);
      }
    }
  }

  /// Distance of a triangle's third corner from a start that is unrolled into the triangle's plane.
  /// It applies where the straight line there crosses the side between the two corners with known
  /// distances.
  void pass_across(double near, double far, const MeshNeighbours::Corner& corner, double arm,
                   double side, std::uint32_t to) {
    if (!(side > 0)) return;
    const double x = (arm * arm + side * side - corner.across * corner.across) / (2 * side);
    const double y = corner.twice_area / side;
    const double start_x = (near * near - far * far + side * side) / (2 * side);
    const double start_y = std::sqrt(std::max(0.0, near * near - start_x * start_x));
    const double height = start_y + y;
    if (!(height > 0)) return;
    const double crossing = start_x + (x - start_x) * start_y / height;
    if (crossing < 0 || crossing > side) return;
    offer(to, std::sqrt((x - start_x) * (x - start_x) + height * height));
  }

  void offer(std::uint32_t vertex, double distance) {
    if (distance >= distance_[vertex]) return;
    if (distance_[vertex] == unknown) known_.push_back(vertex);
    distance_[vertex] = distance;
    heap_.emplace_back(distance, vertex);
    std::push_heap(heap_.begin(), heap_.end(), std::greater<>());
  }

  const MeshNeighbours& neighbours_;
  std::vector<double> distance_;      ///< along the mesh from the start, infinite where unknown
  std::vector<char> settled_;         ///< the distance is final
  std::vector<std::uint32_t> known_;  ///< vertices with a distance, to be reset afterwards
  std::vector<std::uint32_t> window_;
  std::vector<Entry> heap_;
};

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
