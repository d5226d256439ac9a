// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/geometry/sided_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <unordered_map>
#include <utility>

namespace spm::bench {
namespace {

/// Where on a triangle the closest point lies.
enum class Part : std::uint8_t { face, edge, corner };

struct Nearest {
  Vector3 point = Vector3::Zero();
  Part part = Part::face;
  std::size_t which = 0;  ///< the edge from corner `which` to the next, or that corner
};

/// By the region that the point is in (Ericson 2005).
Nearest nearest_on(const Vector3& point, const std::array<Vector3, 3>& corners) noexcept {
  const auto& [a, b, c] = corners;
  const Vector3 ab = b - a, ac = c - a;
  const auto share = [](double part, double rest) {
    return part + rest > 0 ? part / (part + rest) : 0.0;
  };
  const Vector3 ap = point - a;
  const double ab_a = ab.dot(ap), ac_a = ac.dot(ap);
  if (ab_a <= 0 && ac_a <= 0) return {a, Part::corner, 0};
  const Vector3 bp = point - b;
  const double ab_b = ab.dot(bp), ac_b = ac.dot(bp);
  if (ab_b >= 0 && ac_b <= ab_b) return {b, Part::corner, 1};
  const double of_c = ab_a * ac_b - ab_b * ac_a;
  if (of_c <= 0 && ab_a >= 0 && ab_b <= 0) return {a + share(ab_a, -ab_b) * ab, Part::edge, 0};
  const Vector3 cp = point - c;
  const double ab_c = ab.dot(cp), ac_c = ac.dot(cp);
  if (ac_c >= 0 && ab_c <= ac_c) return {c, Part::corner, 2};
  const double of_b = ab_c * ac_a - ab_a * ac_c;
  if (of_b <= 0 && ac_a >= 0 && ac_c <= 0) return {a + share(ac_a, -ac_c) * ac, Part::edge, 2};
  const double of_a = ab_b * ac_c - ab_c * ac_b;
  const double to_c = ac_b - ab_b, to_b = ab_c - ac_c;
  if (of_a <= 0 && to_c >= 0 && to_b >= 0) return {b + share(to_c, to_b) * (c - b), Part::edge, 1};
  const double whole = of_a + of_b + of_c;
  return {a + of_b / whole * ab + of_c / whole * ac, Part::face, 0};
}

/// The sum of normals, weighted by angles, of what meets at each edge and vertex of a surface.
class NormalSums {
 public:
  explicit NormalSums(const Model& model)
      : surface_(model.surface), caster_(model.caster), thin_(1e-6 * model.mesh.diagonal) {
    number_vertices();
    vertices_.resize(vertex_count_);
    for (std::uint32_t i = 0; i < surface_.triangles.size(); ++i) add(i);
    for (const auto& [ends, sum] : edges_) {
      if (sum.regular == 2 && sum.thin == 0) continue;
      ++vertices_[ends >> 32U].thin;
      ++vertices_[ends & 0xFFFFFFFFU].thin;
    }
  }

  [[nodiscard]] Vector3 edge(std::uint32_t triangle, std::size_t k) const {
    const auto [a, b] = ends(triangle, k);
    const Sum& sum = edges_.at(key(a, b));
    if (sum.regular == 2 && sum.thin == 0) return sum.normal;
    return around((surface_.vertices[a] + surface_.vertices[b]) / 2);
  }

  [[nodiscard]] Vector3 corner(std::uint32_t triangle, std::size_t k) const {
    const std::uint32_t vertex = surface_.triangles[triangle][k];
    const Sum& sum = vertices_[number_[vertex]];
    return sum.thin == 0 ? sum.normal : around(surface_.vertices[vertex]);
  }

 private:
  struct Sum {
    Vector3 normal = Vector3::Zero();
    int regular = 0, thin = 0;  ///< how many triangles with a normal, and without
  };

  /// Vertices at one place are one.
  void number_vertices() {
    std::map<std::array<double, 3>, std::uint32_t> known;
    for (const Vector3& vertex : surface_.vertices) {
      const std::array<double, 3> place{vertex.x(), vertex.y(), vertex.z()};
      const auto next = static_cast<std::uint32_t>(known.size());
      number_.push_back(known.try_emplace(place, next).first->second);
    }
    vertex_count_ = known.size();
  }

  [[nodiscard]] std::pair<std::uint32_t, std::uint32_t> ends(std::uint32_t triangle,
                                                             std::size_t k) const {
    return {surface_.triangles[triangle][k], surface_.triangles[triangle][(k + 1) % 3]};
  }

  [[nodiscard]] std::uint64_t key(std::uint32_t a, std::uint32_t b) const {
    const auto [low, high] = std::minmax({number_[a], number_[b]});
    return std::uint64_t{low} << 32U | high;
  }

  [[nodiscard]] Vector3 side(std::uint32_t triangle, std::size_t k) const {
    const auto [a, b] = ends(triangle, k);
    return surface_.vertices[b] - surface_.vertices[a];
  }

  /// The unit normal, or zero where rounding would decide it.
  [[nodiscard]] Vector3 normal(std::uint32_t triangle) const {
    const Vector3 across = side(triangle, 0).cross(side(triangle, 1));
    double longest = 0;
    for (std::size_t k = 0; k < 3; ++k) longest = std::max(longest, side(triangle, k).norm());
    const double length = across.norm();
    return length > thin_ * longest ? Vector3(across / length) : Vector3(Vector3::Zero());
  }

  [[nodiscard]] double angle(std::uint32_t triangle, std::size_t k) const {
    const Vector3 out = side(triangle, k), back = -side(triangle, (k + 2) % 3);
    return std::atan2(out.cross(back).norm(), out.dot(back));
  }

  void add(std::uint32_t triangle) {
    const Vector3 up = normal(triangle);
    const bool regular = !up.isZero();
    const auto enter = [&](Sum& sum, double weight) {
      sum.normal += weight * up;
      ++(regular ? sum.regular : sum.thin);
    };
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [a, b] = ends(triangle, k);
      enter(edges_[key(a, b)], 1);
      enter(vertices_[number_[a]], regular ? angle(triangle, k) : 0);
    }
  }

  /// The same of whatever touches a place, where edges do not match or triangles are too thin.
  [[nodiscard]] Vector3 around(const Vector3& place) const {
    std::vector<std::uint32_t> touching;
    caster_.within(place, 2 * thin_, touching);
    Vector3 sum = Vector3::Zero();
    for (const std::uint32_t triangle : touching) {
      const Vector3 up = normal(triangle);
      if (!up.isZero()) sum += angle_at(triangle, place) * up;
    }
    return sum;
  }

  [[nodiscard]] double angle_at(std::uint32_t triangle, const Vector3& place) const {
    bool on_edge = false;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vector3 from = place - surface_.vertices[ends(triangle, k).first];
      if (from.norm() <= 2 * thin_) return angle(triangle, k);
      const Vector3 along = side(triangle, k);
      on_edge = on_edge || from.cross(along).norm() <= 2 * thin_ * along.norm();
    }
    return on_edge ? std::numbers::pi : 2 * std::numbers::pi;
  }

  const baker::OuterSurface& surface_;
  const baker::Caster& caster_;
  double thin_;                        ///< m: lower triangles have no normal
  std::vector<std::uint32_t> number_;  ///< of each vertex
  std::size_t vertex_count_ = 0;
  std::unordered_map<std::uint64_t, Sum> edges_;  ///< by their vertices' numbers
  std::vector<Sum> vertices_;
};

std::array<float, 3> floats_of(const Vector3& vector) {
  return {static_cast<float>(vector.x()), static_cast<float>(vector.y()),
          static_cast<float>(vector.z())};
}

}  // namespace

SidedMesh::SidedMesh(const Model& model)
    : mesh_(model.surface),
      tie_(1e-7 * model.mesh.diagonal),
      edges_(mesh_.triangles.size()),
      corners_(mesh_.vertices.size()) {
  const Clock::time_point start = Clock::now();
  const NormalSums sums(model);
  for (std::uint32_t i = 0; i < mesh_.triangles.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      edges_[i][k] = floats_of(sums.edge(i, k));
      corners_[mesh_.triangles[i][k]] = floats_of(sums.corner(i, k));
    }
  }
  seconds_ = seconds_since(start);
}

Answer SidedMesh::answer(const Vector3& point, std::uint32_t triangle) const noexcept {
  const std::array<Vector3, 3> corners = mesh_.corners(triangle);
  const Nearest nearest = nearest_on(point, corners);
  const Vector3 away = point - nearest.point;
  Vector3 up;
  if (nearest.part == Part::face) {
    up = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
  } else {
    const Float3& stored = nearest.part == Part::edge
                               ? edges_[triangle][nearest.which]
                               : corners_[mesh_.triangles[triangle][nearest.which]];
    up = Vector3(stored[0], stored[1], stored[2]);
  }
  Answer answer;
  const double distance = away.norm(), side = up.dot(away) < 0 ? -1 : 1;
  answer.distance = side * distance;
  answer.normal = distance > tie_ ? Vector3(side / distance * away) : up.normalized();
  answer.source = Source::triangles;
  answer.status = Status::exact;
  return answer;
}

double SidedMesh::distance(const Vector3& point, std::uint32_t triangle) const noexcept {
  return (point - nearest_on(point, mesh_.corners(triangle)).point).norm();
}

}  // namespace spm::bench
