// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/cast/cast.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <embree/rays.hpp>
#include <limits>
#include <optional>
#include <tuple>

#include "baker/base/bake_error.hpp"
#include "baker/mesh/mesh_edges.hpp"
#include "baker/surface/solid_side.hpp"
#include "common/surface/closest_on_triangle.hpp"

namespace spm::baker {

namespace {

/// Hits that are closer together along a ray than this share of the diagonal are one crossing of a
/// shared edge.
constexpr double same_crossing_share = 2e-8;
/// Triangles that are at most this share of the diagonal farther than the nearest help to decide
/// the side.
constexpr double tie_share = 1e-5;
/// Nearer to the surface than this share of the diagonal, the direction to it is noise.
constexpr double surface_share = 1e-7;
/// A ray that grazes a triangle more flatly than this keeps Embree's own distance.
constexpr double grazing_cosine = 1e-6;

/// Of a square of a distance, so that rounding leaves nothing out.
constexpr double box_slack = 1 + 1e-12;

struct HitCollector {
  RayContext context;
  std::vector<std::uint32_t>* triangles;
  std::vector<float>* distances;
};

struct Candidate {
  double distance;
  Vector3 closest_point;
  std::uint32_t triangle;
};

/// Whether the box of a triangle is farther from a point than so much.
[[nodiscard]] bool is_beyond(const std::array<Vector3, 3>& corners, const Vector3& point,
                             double distance) {
  const auto& [a, b, c] = corners;
  const Vector3 below = a.cwiseMin(b).cwiseMin(c) - point,
                above = point - a.cwiseMax(b).cwiseMax(c);
  const Vector3 away = below.cwiseMax(above).cwiseMax(0);
  return away.squaredNorm() > distance * distance * box_slack;
}

}  // namespace

struct Caster::Implementation {
  RTCDevice device = nullptr;
  RTCScene rays = nullptr;    // of solids only, which rays enter and leave
  RTCScene points = nullptr;  // of solids and sheets
  std::vector<std::array<Vector3, 3>> corners;
  std::vector<Vector3> normals;
  std::size_t solid_count = 0;
  double sheet_thickness = 0;
  Vector3 centre = Vector3::Zero();
  double diagonal = 0;
  /// What tells the side where the solids' triangles do not: OuterSurface::sides, and a caster over
  /// them. Else the triangles themselves.
  std::shared_ptr<const ClosedSurfaces> sides;
  std::unique_ptr<Caster> whole;
  std::optional<SolidSide> boundary;
  /// By triangle, whether its normal is no evidence: those of `sides`, else such as have a corner
  /// at which the solids do not close, as where a gap went whose walls stand some um apart. Empty
  /// where there are none.
  std::vector<char> doubtful;

  ~Implementation() {
    if (rays != nullptr) rtcReleaseScene(rays);
    if (points != nullptr) rtcReleaseScene(points);
    if (device != nullptr) rtcReleaseDevice(device);
  }

  void find_open(std::size_t vertices, const std::vector<Triangle>& solids) {
    const std::vector<char> open = open_vertices(vertices, solids);
    if (std::find(open.begin(), open.end(), 1) == open.end()) return;
    for (const Triangle& triangle : solids) {
      doubtful.push_back(std::any_of(triangle.begin(), triangle.end(),
                                     [&](std::uint32_t corner) { return open[corner] != 0; }));
    }
  }

  RTCScene make_scene(std::size_t count, bool collecting) {
    RTCScene scene = rtcNewScene(device);
    rtcSetSceneFlags(scene,
                     collecting ? RTC_SCENE_FLAG_ROBUST | filtered_rays : RTC_SCENE_FLAG_ROBUST);
    if (count > 0) add_triangles(count, scene);
    rtcCommitScene(scene);
    return scene;
  }

  void add_triangles(std::size_t count, RTCScene scene) const {
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), 3 * count));
    auto* indices = static_cast<unsigned*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned), count));
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
      for (std::size_t k = 0; k < 3; ++k) {
        // Relative to the object's middle, where single precision has the most digits.
        const Vector3 local = corners[i][k] - centre;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          vertices[9 * i + 3 * k + axis] = static_cast<float>(local[static_cast<int>(axis)]);
        }
        indices[3 * i + k] = static_cast<unsigned>(3 * i + k);
      }
    });
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
  }

  [[nodiscard]] RTCRayHit ray_from(const Vector3& origin, const Vector3& direction,
                                   float far) const {
    const Eigen::Vector3f local = (origin - centre).cast<float>(), way = direction.cast<float>();
    RTCRayHit ray{};
    std::tie(ray.ray.org_x, ray.ray.org_y, ray.ray.org_z) = std::tie(local[0], local[1], local[2]);
    std::tie(ray.ray.dir_x, ray.ray.dir_y, ray.ray.dir_z) = std::tie(way[0], way[1], way[2]);
    ray.ray.tfar = far;
    ray.ray.mask = ~0U;
    ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    return ray;
  }

  [[nodiscard]] RTCPointQuery query_around(const Vector3& point, float radius) const {
    const Eigen::Vector3f local = (point - centre).cast<float>();
    return {.x = local[0], .y = local[1], .z = local[2], .time = 0, .radius = radius};
  }

  /// A hit that Embree found, its depth `lift` less than the distance from the ray's origin, in
  /// double precision.
  [[nodiscard]] Crossing crossing(const Vector3& origin, const Vector3& direction, double lift,
                                  std::uint32_t triangle, float found) const {
    const double cosine = normals[triangle].dot(direction);
    const double distance = std::abs(cosine) > grazing_cosine
                                ? normals[triangle].dot(corners[triangle][0] - origin) / cosine
                                : static_cast<double>(found);
    return {distance - lift, triangle, cosine < 0};
  }

  void collect(const Vector3& origin, const Vector3& direction, double lift,
               std::vector<Crossing>& crossings) const {
    thread_local std::vector<std::uint32_t> triangles;
    thread_local std::vector<float> distances;
    triangles.clear();
    distances.clear();
    HitCollector collector{};
    const auto keep_looking = [](const RTCFilterFunctionNArguments* arguments) {
      auto* out = reinterpret_cast<HitCollector*>(arguments->context);
      out->triangles->push_back(RTCHitN_primID(arguments->hit, arguments->N, 0));
      out->distances->push_back(RTCRayN_tfar(arguments->ray, arguments->N, 0));
      arguments->valid[0] = 0;
    };
    collector.triangles = &triangles;
    collector.distances = &distances;
    RTCRayHit ray = ray_from(origin, direction, std::numeric_limits<float>::infinity());
    find_hit(rays, ray, collector.context, keep_looking);
    crossings.clear();
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      crossings.push_back(crossing(origin, direction, lift, triangles[i], distances[i]));
    }
  }
};

namespace {

/// Sorts crossings, and merges the several ones of a ray through a shared edge or corner.
void merge_crossings(std::vector<Crossing>& crossings, double same) {
  std::sort(crossings.begin(), crossings.end(), [](const Crossing& a, const Crossing& b) {
    return a.depth != b.depth ? a.depth < b.depth : a.triangle < b.triangle;
  });
  std::vector<Crossing> merged;
  for (std::size_t i = 0; i < crossings.size();) {
    std::size_t end = i + 1;
    while (end < crossings.size() && crossings[end].depth - crossings[end - 1].depth < same) ++end;
    const auto first_of = [&](bool entry) {
      return std::find_if(crossings.begin() + static_cast<std::ptrdiff_t>(i),
                          crossings.begin() + static_cast<std::ptrdiff_t>(end),
                          [entry](const Crossing& c) { return c.entry == entry; });
    };
    const auto stop = crossings.begin() + static_cast<std::ptrdiff_t>(end);
    const bool has_entry = first_of(true) != stop;
    const bool has_exit = first_of(false) != stop;
    // An entry and an exit at one place: the ray touches a silhouette edge and does not cross.
    if (has_entry != has_exit) merged.push_back(*first_of(has_entry));
    i = end;
  }
  crossings.swap(merged);
}

bool alternates(const std::vector<Crossing>& crossings) {
  if (crossings.size() % 2 != 0) return false;
  for (std::size_t i = 0; i < crossings.size(); ++i) {
    if (crossings[i].entry != (i % 2 == 0)) return false;
  }
  return true;
}

}  // namespace

Caster::Caster(const OuterSurface& surface, double sheet_thickness)
    : implementation_(std::make_unique<Implementation>()) {
  Implementation& self = *implementation_;
  self.solid_count = surface.solid_count;
  self.sheet_thickness = surface.has_sheets() ? sheet_thickness : 0;
  Eigen::AlignedBox3d box;
  self.corners.reserve(surface.triangles.size());
  self.normals.reserve(surface.triangles.size());
  for (const Triangle& triangle : surface.triangles) {
    const std::array<Vector3, 3> corners{surface.vertices[triangle[0]],
                                         surface.vertices[triangle[1]],
                                         surface.vertices[triangle[2]]};
    for (const Vector3& corner : corners) box.extend(corner);
    self.corners.push_back(corners);
    self.normals.push_back((corners[1] - corners[0]).cross(corners[2] - corners[0]).normalized());
  }
  self.centre = box.center();
  self.diagonal = box.diagonal().norm();
  if (surface.sides) {
    OuterSurface whole;
    whole.vertices = surface.sides->vertices;
    whole.triangles = surface.sides->triangles;
    whole.solid_count = whole.triangles.size();
    self.whole = std::make_unique<Caster>(whole);
    self.sides = surface.sides;
    self.doubtful = surface.sides->doubtful;
  } else {
    const auto solids = std::span(surface.triangles).first(self.solid_count);
    self.boundary.emplace(surface.vertices, solids);
    self.find_open(surface.vertices.size(), {solids.begin(), solids.end()});
  }
  self.device = rtcNewDevice(nullptr);
  if (self.device == nullptr) throw BakeError(ExitCode::internal, "Embree could not be started");
  self.rays = self.make_scene(self.solid_count, true);
  if (self.solid_count == self.corners.size()) {
    self.points = self.rays;
    rtcRetainScene(self.points);
  } else {
    self.points = self.make_scene(self.corners.size(), false);
  }
}

Caster::~Caster() = default;

void Caster::cast(const SupportPlane& plane, double eta, double omega, Column& column) const {
  const Implementation& self = *implementation_;
  // The ray starts above its plane, since the plane touches the object and that place must not be
  // missed.
  const double lift = 0.01 * self.diagonal;
  constexpr std::array<std::array<double, 2>, 4> nudges{
      {{0, 0}, {3e-7, 1e-7}, {-1e-7, 4e-7}, {-3e-7, -5e-7}}};
  std::vector<Crossing> first_try;
  for (std::size_t attempt = 0; attempt < nudges.size(); ++attempt) {
    const Vector3 origin = support_plane_point(plane, eta + nudges[attempt][0] * self.diagonal,
                                               omega + nudges[attempt][1] * self.diagonal) +
                           lift * plane.n;
    self.collect(origin, -plane.n, lift, column.crossings);
    merge_crossings(column.crossings, same_crossing_share * self.diagonal);
    column.consistent = alternates(column.crossings);
    if (column.consistent) return;
    if (attempt == 0) first_try = column.crossings;
  }
  column.crossings.swap(first_try);
}

std::optional<Crossing> Caster::first_between(const SupportPlane& plane, double eta, double omega,
                                              double from, double to) const {
  const Implementation& self = *implementation_;
  const Vector3 origin = support_plane_point(plane, eta, omega) - from * plane.n;
  RTCRayHit ray = self.ray_from(origin, -plane.n, static_cast<float>(to - from));
  find_hit(self.rays, ray);
  if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  return self.crossing(origin, -plane.n, -from, ray.hit.primID, ray.ray.tfar);
}

namespace {

/// The nearer of two, and of two that are as near the first of the file.
void keep_nearest(const Candidate& candidate, const Candidate*& nearest) {
  if (!(candidate.distance < std::numeric_limits<double>::infinity())) return;
  if (nearest == nullptr || candidate.distance < nearest->distance ||
      (candidate.distance == nearest->distance && candidate.triangle < nearest->triangle)) {
    nearest = &candidate;
  }
}

}  // namespace

ClosestPoint Caster::closest(const Vector3& point, double within) const {
  const Implementation& self = *implementation_;
  struct Search {
    const Implementation* self;
    Vector3 point;
    double tie;
    double nearest_solid, nearest_sheet;
    std::vector<Candidate>* candidates;

    /// How far to look where something is so near. A solid that is farther than the nearest sheet
    /// by the half-thickness is no nearer to be felt. Single precision: keeps enough slack that no
    /// competing triangle is lost.
    [[nodiscard]] float reach(double least) const {
      return static_cast<float>((least + self->sheet_thickness + tie) * (1 + 1e-5) +
                                1e-6 * self->diagonal);
    }
  };
  thread_local std::vector<Candidate> candidates;
  candidates.clear();
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Search search{&self, point, tie_share * self.diagonal, infinity, infinity, &candidates};
  RTCPointQuery query = self.query_around(point, search.reach(within));
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  const auto visit = [](RTCPointQueryFunctionArguments* arguments) {
    auto& io = *static_cast<Search*>(arguments->userPtr);
    const std::uint32_t triangle = arguments->primID;
    const auto& corners = io.self->corners[triangle];
    double& nearest = triangle < io.self->solid_count ? io.nearest_solid : io.nearest_sheet;
    if (is_beyond(corners, io.point, nearest + io.tie)) return false;
    const Vector3 closest_point = closest_on_triangle(io.point, corners[0], corners[1], corners[2]);
    const double distance = (closest_point - io.point).norm();
    if (distance > nearest + io.tie) return false;
    io.candidates->push_back({distance, closest_point, triangle});
    if (distance >= nearest) return false;
    nearest = distance;
    arguments->query->radius = io.reach(std::min(io.nearest_solid, io.nearest_sheet));
    return true;
  };
  rtcPointQuery(self.points, &query, &context, visit, &search);

  // Of solids beyond the radius some were met, and not the nearest.
  const bool any_solid = search.nearest_solid <= search.nearest_sheet + self.sheet_thickness;
  bool voted_inside = false, voted_outside = false, in_doubt = false;
  const Candidate *solid = nullptr, *sheet = nullptr;
  for (const Candidate& candidate : candidates) {
    if (candidate.triangle >= self.solid_count) {
      keep_nearest(candidate, sheet);
      continue;
    }
    if (!any_solid) continue;
    keep_nearest(candidate, solid);
    if (candidate.distance > search.nearest_solid + search.tie) continue;
    const double height = self.normals[candidate.triangle].dot(point - candidate.closest_point);
    (height < 0 ? voted_inside : voted_outside) = true;
    in_doubt = in_doubt || (!self.doubtful.empty() && self.doubtful[candidate.triangle] != 0);
  }
  if (solid == nullptr && sheet == nullptr) {
    throw BakeError(ExitCode::internal, "the surface has no triangle");
  }
  // At an edge or a corner triangles may disagree. Neither the nearest nor the one that faces the
  // point most is always right.
  const bool agreed = voted_inside != voted_outside && !in_doubt;
  bool inside = agreed || !any_solid ? voted_inside : surrounds(point, search.nearest_solid);
  ClosestPoint result;
  if (solid != nullptr) {
    result.solid = inside ? -solid->distance : solid->distance;
  } else {
    result.solid = self.solid_count > 0 ? search.nearest_sheet + self.sheet_thickness : infinity;
  }
  result.distance = result.solid;
  const Candidate* nearest = solid != nullptr ? solid : sheet;
  if (sheet != nullptr && sheet->distance - self.sheet_thickness < result.solid) {
    nearest = sheet;
    inside = false;
    result.distance = sheet->distance - self.sheet_thickness;
  }
  const double side = inside ? -1 : 1, least = nearest->distance;
  result.closest_point = nearest->closest_point;
  result.triangle = nearest->triangle;
  result.direction = least > surface_share * self.diagonal
                         ? Vector3(side * (point - nearest->closest_point) / least)
                         : self.normals[nearest->triangle];
  return result;
}

bool Caster::is_inside(const Vector3& point) const { return winding(point) > 0; }

bool Caster::surrounds(const Vector3& point, double away) const {
  if (is_inside(point)) return true;
  const Caster* all = whole();
  if (all == nullptr) return false;
  const double gap = implementation_->sides->gap;
  if (away <= 2 * gap) return false;
  std::vector<std::uint32_t> near;
  all->within(point, gap, near);
  return std::any_of(near.begin(), near.end(), [&](std::uint32_t wall) {
    const Vector3 beyond = 2 * gap * all->normal(wall);
    return is_inside(point + beyond) && is_inside(point - beyond);
  });
}

const Caster* Caster::whole() const { return implementation_->whole.get(); }

int Caster::winding(const Vector3& point) const {
  const Caster& all = whole() != nullptr ? *whole() : *this;
  return all.implementation_->boundary->winding(point);
}

void Caster::boxes_within(const Vector3& point, double radius,
                          std::vector<std::uint32_t>& triangles) const {
  const Implementation& self = *implementation_;
  struct Search {
    const Implementation* self;
    Vector3 point;
    double radius;
    std::vector<std::uint32_t>* triangles;
  };
  triangles.clear();
  Search search{&self, point, radius, &triangles};
  RTCPointQuery query =
      self.query_around(point, static_cast<float>(radius * (1 + 1e-5) + 1e-6 * self.diagonal));
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  const auto visit = [](RTCPointQueryFunctionArguments* arguments) {
    const auto& in = *static_cast<Search*>(arguments->userPtr);
    if (!is_beyond(in.self->corners[arguments->primID], in.point, in.radius)) {
      in.triangles->push_back(arguments->primID);
    }
    return false;
  };
  rtcPointQuery(self.points, &query, &context, visit, &search);
  std::sort(triangles.begin(), triangles.end());
}

void Caster::within(const Vector3& point, double radius,
                    std::vector<std::uint32_t>& triangles) const {
  boxes_within(point, radius, triangles);
  std::erase_if(triangles, [&](std::uint32_t triangle) {
    const auto& [a, b, c] = implementation_->corners[triangle];
    return (closest_on_triangle(point, a, b, c) - point).norm() > radius;
  });
}

const Vector3& Caster::corner(std::uint32_t triangle, int which) const {
  return implementation_->corners[triangle][static_cast<std::size_t>(which)];
}
const Vector3& Caster::normal(std::uint32_t triangle) const {
  return implementation_->normals[triangle];
}
double Caster::area(std::uint32_t triangle) const {
  const Vector3& first = corner(triangle, 0);
  return (corner(triangle, 1) - first).cross(corner(triangle, 2) - first).norm() / 2;
}
bool Caster::is_sheet(std::uint32_t triangle) const {
  return triangle >= implementation_->solid_count;
}
std::size_t Caster::solid_count() const { return implementation_->solid_count; }
std::size_t Caster::triangle_count() const { return implementation_->corners.size(); }
double Caster::sheet_thickness() const { return implementation_->sheet_thickness; }
double Caster::diagonal() const { return implementation_->diagonal; }

}  // namespace spm::baker
