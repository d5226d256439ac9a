// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/verify/exact_pieces.hpp"

#include <CGAL/Bbox_3.h>
#include <CGAL/Box_intersection_d/Box_with_info_d.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <utility>

#include "baker/base/cube_bins.hpp"
#include "baker/base/meeting_boxes.hpp"

namespace spm::baker {
namespace {

using Vector2 = Eigen::Vector2d;
using Polygon = std::vector<Vector2>;  // convex, anticlockwise
using Corners = std::array<Vector3, 3>;

double cross(const Vector2& a, const Vector2& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Lengths that count as zero: fixed shares of the mesh's diagonal.
struct Scale {
  double touching;  ///< points nearer than this to a plane or line are on it
  double probe;     ///< how far above and below a sheet the winding number is evaluated at least
  double narrow;    ///< gaps between triangles that face each other within this are closed
  double wall;      ///< the same for solids: the least that walls and gaps are thick
  double hair;      ///< pieces of triangles that are lower go: alone they may reach into a solid
};

Corners corners_of(const Mesh& mesh, std::size_t triangle) {
  const Triangle& t = mesh.triangles[triangle];
  return {mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]};
}

Vector3 normal_of(const Corners& t) { return (t[1] - t[0]).cross(t[2] - t[0]).normalized(); }

/// A triangle's plane with coordinates in it.
struct Frame {
  explicit Frame(const Corners& t)
      : origin(t[0]), n(normal_of(t)), u((t[1] - t[0]).normalized()), v(n.cross(u)) {}
  [[nodiscard]] Vector2 flat(const Vector3& p) const {
    return {u.dot(p - origin), v.dot(p - origin)};
  }
  [[nodiscard]] Vector3 lifted(const Vector2& p) const { return origin + p.x() * u + p.y() * v; }
  [[nodiscard]] double height(const Vector3& p) const { return n.dot(p - origin); }
  Vector3 origin, n, u, v;
};

using Segment = std::pair<Vector2, Vector2>;

/// Where a triangle of the mesh lies that has a side in the plane of one that is cut, or over it.
enum class Lies : std::uint8_t { above, below, on, beside_alike, beside_turned };

/// Such a side.
struct SideInPlane {
  std::uint32_t from = 0, to = 0;  ///< vertices
  Lies lies = Lies::on;

  [[nodiscard]] std::pair<std::uint32_t, std::uint32_t> ends() const {
    return std::minmax(from, to);
  }
};

/// What cuts a triangle.
struct Traces {
  std::vector<Segment> segments;
  std::vector<SideInPlane> sides;

  void add_whole(const Triangle& other, Lies lies) {
    for (std::size_t k = 0; k < 3; ++k) sides.push_back({other[k], other[(k + 1) % 3], lies});
  }

  /// The sides, each once, but for those across which nothing changes: as many triangles that lie
  /// alike run along it one way as the other.
  void keep_outlines() {
    std::sort(sides.begin(), sides.end(),
              [](const SideInPlane& a, const SideInPlane& b) { return a.ends() < b.ends(); });
    std::vector<SideInPlane> kept;
    for (auto first = sides.begin(); first != sides.end();) {
      std::array<int, 5> changes{};
      auto side = first;
      for (; side != sides.end() && side->ends() == first->ends(); ++side) {
        changes[static_cast<std::size_t>(side->lies)] += side->from < side->to ? 1 : -1;
      }
      if (changes != std::array<int, 5>{}) kept.push_back(*first);
      first = side;
    }
    sides = std::move(kept);
  }
};

/// Where a triangle meets a plane: a segment, a side of it, or all three where it lies in the
/// plane. Whether it does that.
bool add_meeting(const Frame& frame, const Corners& other, const Triangle& numbers, Lies lies,
                 double touching, Traces& traces) {
  std::array<double, 3> height{};
  std::size_t in_plane = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    height[i] = frame.height(other[i]);
    if (std::abs(height[i]) <= touching) height[i] = 0;
    in_plane += height[i] == 0 ? 1 : 0;
  }
  if (in_plane == 3) {
    traces.add_whole(numbers, lies);
    return true;
  }
  // A plane passes no more than two places of a triangle's border; most that are near it none.
  std::array<Vector2, 2> points;
  std::size_t count = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3;
    if (height[i] == 0 && height[j] == 0) {
      traces.sides.push_back(
          {numbers[i], numbers[j], height[3 - i - j] > 0 ? Lies::above : Lies::below});
      return false;
    }
    if (height[i] == 0) points[count++] = frame.flat(other[i]);
    if (height[i] * height[j] < 0) {
      const double share = height[i] / (height[i] - height[j]);
      points[count++] = frame.flat(other[i] + share * (other[j] - other[i]));
    }
  }
  if (count == 2) traces.segments.emplace_back(points[0], points[1]);
  return false;
}

/// Whether a triangle faces the one of a frame, or lies along it
/// where that one is a sheet's, and one lies within the narrow distance of the other's plane.
/// `along`: the product of their normals.
bool faces(const Frame& frame, const Corners& own, const Corners& other, double along,
           double narrow, bool sheet) {
  constexpr double opposite = -0.98;
  if (!(narrow > 0) || !((sheet ? -std::abs(along) : along) < opposite)) return false;
  const Frame back(other);
  const auto within = [narrow](const Frame& plane, const Corners& corners) {
    return std::all_of(corners.begin(), corners.end(), [&](const Vector3& corner) {
      return std::abs(plane.height(corner)) <= narrow;
    });
  };
  return within(frame, other) || within(back, own);
}

/// True where the segment runs through the polygon's inside by more than a touch.
bool runs_through(const Polygon& polygon, const Segment& segment, double touching) {
  double enter = 0;
  double leave = 1;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vector2& from = polygon[i];
    const Vector2 edge = (polygon[(i + 1) % polygon.size()] - from).normalized();
    const double start = cross(edge, segment.first - from);
    const double end = cross(edge, segment.second - from);
    if (start <= touching && end <= touching) return false;
    if (start < 0) enter = std::max(enter, start / (start - end));
    if (end < 0) leave = std::min(leave, start / (start - end));
  }
  return (leave - enter) * (segment.second - segment.first).norm() > touching;
}

/// Cuts the polygons through which a segment runs, along the segment's line.
void cut(std::vector<Polygon>& polygons, const Segment& segment, double touching) {
  const Vector2 along = segment.second - segment.first;
  if (along.norm() <= touching) return;
  const Vector2 direction = along.normalized();
  const std::size_t count = polygons.size();
  for (std::size_t p = 0; p < count; ++p) {
    if (!runs_through(polygons[p], segment, touching)) continue;
    const Polygon polygon = polygons[p];
    Polygon left;
    Polygon right;
    double highest = 0;
    double lowest = 0;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Vector2& a = polygon[i];
      const Vector2& b = polygon[(i + 1) % polygon.size()];
      double side_a = cross(direction, a - segment.first);
      double side_b = cross(direction, b - segment.first);
      if (std::abs(side_a) <= touching) side_a = 0;
      if (std::abs(side_b) <= touching) side_b = 0;
      highest = std::max(highest, side_a);
      lowest = std::min(lowest, side_a);
      if (side_a >= 0) left.push_back(a);
      if (side_a <= 0) right.push_back(a);
      if (side_a * side_b < 0) {
        left.emplace_back(a + side_a / (side_a - side_b) * (b - a));
        right.push_back(left.back());
      }
    }
    if (highest == 0 || lowest == 0) continue;
    polygons[p] = std::move(left);
    polygons.push_back(std::move(right));
  }
}

/// For each triangle, those of solids whose boxes are no farther from its box than the narrow
/// distance, along each axis, in order.
CubeBins neighbours(const Mesh& mesh, double narrow) {
  using Box = CGAL::Box_intersection_d::Box_with_info_d<double, 3, std::uint32_t>;
  std::vector<Box> boxes;
  boxes.reserve(mesh.triangles.size());
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const Corners t = corners_of(mesh, i);
    const Vector3 low = t[0].cwiseMin(t[1]).cwiseMin(t[2]).array() - narrow / 2;
    const Vector3 high = t[0].cwiseMax(t[1]).cwiseMax(t[2]).array() + narrow / 2;
    boxes.emplace_back(CGAL::Bbox_3(low.x(), low.y(), low.z(), high.x(), high.y(), high.z()), i);
  }
  const std::size_t solids = mesh.solid_triangles();
  auto all =
      of_meeting_boxes<CubeBins::Member>(boxes, [&](const Box& a, const Box& b, auto& found) {
        if (b.info() < solids) found.emplace_back(a.info(), b.info());
        if (a.info() < solids) found.emplace_back(b.info(), a.info());
      });
  tbb::parallel_sort(all);
  return {boxes.size(), all};
}

enum class Side { outer, turned, hidden };

/// How a triangle of the mesh is judged.
struct Kind {
  bool sheet = false;
  bool stacked = false;         ///< one that faces the other way lies in its plane
  std::vector<Corners> facing;  ///< those that face it across a narrow gap

  /// Whether one of these covers a point of its plane, or nearly.
  [[nodiscard]] bool faced_at(const Frame& frame, const Vector3& point, double nearly) const {
    const Vector2 at = frame.flat(point);
    return std::any_of(facing.begin(), facing.end(), [&](const Corners& other) {
      // Seen from this triangle they run clockwise.
      for (std::size_t k = 0; k < 3; ++k) {
        const Vector2 from = frame.flat(other[k]);
        const Vector2 along = frame.flat(other[(k + 1) % 3]) - from;
        if (cross(along, at - from) > nearly * along.norm()) return false;
      }
      return true;
    });
  }
};

/// `across`: of a sliver the unit vector across it in its plane, else 0.
Side side_of(const ExactWinding& winding, const Vector3& point, const Frame& frame,
             const Scale& scale, const Kind& kind, const Vector3& across) {
  const auto inside = [&](double height) { return winding.at(point + height * frame.n) > 0; };
  // A solid lies beyond a gap, or several such gaps behind each other.
  const auto narrows = [&](double height) {
    return inside(height) || inside(height / 4) || inside(height / 16);
  };
  const double probe = kind.sheet ? std::max(scale.probe, scale.narrow) : scale.wall;
  // A sheet is felt where both its sides are outside, also across a narrow gap.
  if (kind.sheet) return inside(probe) || inside(-probe) ? Side::hidden : Side::outer;
  const bool above = inside(probe), below = inside(-probe);
  if (above == below) return Side::hidden;
  const bool sliver = across != Vector3::Zero();
  const double open = below ? scale.narrow : -scale.narrow;
  if ((sliver || kind.faced_at(frame, point, scale.narrow)) && narrows(open)) return Side::hidden;
  // The end of a gap, between its walls.
  const auto beside = [&](double way) {
    return winding.at(point + open * frame.n + way * scale.narrow * across) > 0;
  };
  if (sliver && beside(1) && beside(-1)) return Side::hidden;
  return below ? Side::outer : Side::turned;
}

struct Sorted {
  std::vector<Corners> kept;
  double hidden_area = 0;
};

void keep(Sorted& sorted, const Corners& piece, Side side) {
  if (side == Side::hidden) {
    sorted.hidden_area += (piece[1] - piece[0]).cross(piece[2] - piece[0]).norm() / 2;
  } else if (side == Side::outer) {
    sorted.kept.push_back(piece);
  } else {
    sorted.kept.push_back({piece[0], piece[2], piece[1]});
  }
}

/// The longest way through a polygon.
Segment longest_way(const Polygon& polygon) {
  Segment longest{polygon[0], polygon[0]};
  for (const Vector2& from : polygon) {
    for (const Vector2& to : polygon) {
      if ((to - from).norm() > (longest.second - longest.first).norm()) longest = {from, to};
    }
  }
  return longest;
}

/// Of a polygon that is no wider than so much the unit vector across it, else 0. A convex polygon
/// is as wide as it is across one of its sides.
Vector2 across_sliver(const Polygon& polygon, double width) {
  double least = std::numeric_limits<double>::infinity();
  Vector2 across = Vector2::Zero();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vector2 along = polygon[(i + 1) % polygon.size()] - polygon[i];
    const Vector2 inwards = Vector2(-along.y(), along.x()).normalized();
    double most = 0;
    for (const Vector2& corner : polygon) {
      most = std::max(most, inwards.dot(corner - polygon[i]));
    }
    if (along == Vector2::Zero() || most >= least) continue;
    least = most;
    across = inwards;
  }
  return least > width ? Vector2(Vector2::Zero()) : across;
}

/// Places along a sliver, half a tolerance apart, between its longest way and its centre.
std::vector<Vector2> places_along(const Polygon& polygon, const Vector2& centre, double narrow) {
  constexpr double apart = 25, most = 64;  // in widths of a gap that is closed
  const auto [from, to] = longest_way(polygon);
  const Vector2 along = to - from;
  const double middle = along.dot(centre - from) / along.squaredNorm();
  const auto count = static_cast<int>(std::clamp(along.norm() / (apart * narrow), 1.0, most));
  std::vector<Vector2> places;
  for (int i = 0; i < count; ++i) {
    const double share = (i + 0.5) / count;
    const Vector2 by_centre = share < middle
                                  ? Vector2(from + share / middle * (centre - from))
                                  : Vector2(to + (1 - share) / (1 - middle) * (centre - to));
    places.emplace_back((from + share * along + by_centre) / 2);
  }
  return places;
}

bool is_hair(const Corners& t, double height) {
  const double longest =
      std::max({(t[1] - t[0]).norm(), (t[2] - t[1]).norm(), (t[0] - t[2]).norm()});
  return (t[1] - t[0]).cross(t[2] - t[0]).norm() <= height * longest;
}

/// Classifies the pieces of a cut triangle.
Sorted sort_pieces(const ExactWinding& winding, const Frame& frame,
                   const std::vector<Polygon>& polygons, const Scale& scale, const Kind& kind,
                   bool gaps) {
  Sorted sorted;
  for (const Polygon& polygon : polygons) {
    Vector2 centre = Vector2::Zero();
    for (const Vector2& corner : polygon) centre += corner / static_cast<double>(polygon.size());
    const Vector2 flat = gaps ? across_sliver(polygon, scale.narrow) : Vector2::Zero();
    const Vector3 across = flat.x() * frame.u + flat.y() * frame.v;
    Side side = side_of(winding, frame.lifted(centre), frame, scale, kind, across);
    if (flat != Vector2::Zero() && !kind.sheet && side != Side::hidden) {
      const std::vector<Vector2> places = places_along(polygon, centre, scale.narrow);
      if (std::any_of(places.begin(), places.end(), [&](const Vector2& place) {
            return side_of(winding, frame.lifted(place), frame, scale, kind, across) ==
                   Side::hidden;
          })) {
        side = Side::hidden;
      }
    }
    for (std::size_t i = 2; i < polygon.size(); ++i) {
      const Corners piece{frame.lifted(polygon[0]), frame.lifted(polygon[i - 1]),
                          frame.lifted(polygon[i])};
      if (polygons.size() == 1 || !is_hair(piece, scale.hair)) keep(sorted, piece, side);
    }
  }
  return sorted;
}

}  // namespace

SurfacePieces outer_pieces(const Mesh& mesh, const ExactWinding& winding, double narrow) {
  const Scale scale{1e-9 * mesh.diagonal, 1e-6 * mesh.diagonal, narrow, 1e-10 * mesh.diagonal,
                    1e-7 * mesh.diagonal};
  const CubeBins near = neighbours(mesh, narrow);
  std::vector<std::vector<Polygon>> polygons(mesh.triangles.size());
  std::vector<Kind> kinds(mesh.triangles.size());
  std::vector<Vector3> normals(mesh.solid_triangles());
  for (std::size_t i = 0; i < normals.size(); ++i) normals[i] = normal_of(corners_of(mesh, i));
  tbb::parallel_for(std::size_t{0}, mesh.triangles.size(), [&](std::size_t i) {
    const Corners own = corners_of(mesh, i);
    const Frame frame(own);
    kinds[i].sheet = i >= mesh.solid_triangles();
    polygons[i] = {{frame.flat(own[0]), frame.flat(own[1]), frame.flat(own[2])}};
    Traces traces;
    for (const std::uint32_t other : near.of(i, i)) {
      const Corners there = corners_of(mesh, other);
      const Triangle& numbers = mesh.triangles[other];
      const double along = frame.n.dot(normals[other]);
      // What lies on it is told by winding numbers alone.
      const bool lies_on = std::all_of(there.begin(), there.end(), [&](const Vector3& corner) {
        return std::abs(frame.height(corner)) <= scale.wall / 4;
      });
      const Lies lies = lies_on ? Lies::on : along > 0 ? Lies::beside_alike : Lies::beside_turned;
      const bool in_plane = add_meeting(frame, there, numbers, lies, scale.touching, traces);
      kinds[i].stacked = kinds[i].stacked || (lies_on && along < 0);
      if (lies_on || !faces(frame, own, there, along, narrow, kinds[i].sheet)) continue;
      if (!kinds[i].sheet) kinds[i].facing.push_back(there);
      if (!in_plane) traces.add_whole(numbers, lies);
    }
    const auto flat = [&](const SideInPlane& side) {
      return Segment(frame.flat(mesh.vertices[side.from]), frame.flat(mesh.vertices[side.to]));
    };
    std::erase_if(traces.sides, [&](const SideInPlane& side) {
      return !runs_through(polygons[i][0], flat(side), scale.touching);
    });
    traces.keep_outlines();
    for (const Segment& segment : traces.segments) cut(polygons[i], segment, scale.touching);
    for (const SideInPlane& side : traces.sides) cut(polygons[i], flat(side), scale.touching);
  });
  const bool whole = std::all_of(polygons.begin(), polygons.end(),
                                 [](const auto& pieces) { return pieces.size() == 1; });
  // One closed part that does not cut itself is its own outer surface.
  SurfacePieces pieces;
  pieces.gaps_closed = std::any_of(kinds.begin(), kinds.end(), [](const Kind& kind) {
    return kind.stacked || !kind.facing.empty();
  });
  const bool simple = whole && mesh.closed() && mesh.components == 1 && !pieces.gaps_closed;
  std::vector<Sorted> sorted(mesh.triangles.size());
  tbb::parallel_for(std::size_t{0}, mesh.triangles.size(), [&](std::size_t i) {
    const Corners own = corners_of(mesh, i);
    if (simple) {
      sorted[i].kept.push_back(own);
    } else {
      const auto around = near.of(i, i);
      const bool gaps = !kinds[i].facing.empty() ||
                        std::any_of(around.begin(), around.end(), [&](std::uint32_t other) {
                          return !kinds[other].facing.empty();
                        });
      sorted[i] = sort_pieces(winding, Frame(own), polygons[i], scale, kinds[i], gaps);
    }
  });
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    auto& to = i < mesh.solid_triangles() ? pieces.solids : pieces.sheets;
    to.insert(to.end(), sorted[i].kept.begin(), sorted[i].kept.end());
    pieces.hidden_area += sorted[i].hidden_area;
  }
  return pieces;
}

}  // namespace spm::baker
