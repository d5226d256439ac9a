// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/methods/mesh_proxy.hpp"

#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "common/base/units.hpp"
#include "common/surface/closest_on_triangle.hpp"
#include "tests/bench/geometry/box_tree.hpp"
#include "tests/bench/geometry/swept_triangle.hpp"

namespace spm::bench {
namespace {

constexpr double skin = 1e-7;  // m that the proxy keeps from the surface
constexpr std::uint32_t no_triangle = 0xFFFFFFFFU;

/// Weighted by area, as force shading takes them.
std::vector<std::array<float, 3>> vertex_normals(const FloatMesh& mesh) {
  std::vector<Vector3> sums(mesh.vertices.size(), Vector3::Zero());
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto [a, b, c] = mesh.corners(i);
    const Vector3 across = (b - a).cross(c - a);
    for (const std::uint32_t vertex : mesh.triangles[i]) sums[vertex] += across;
  }
  std::vector<std::array<float, 3>> normals;
  normals.reserve(sums.size());
  for (Vector3& sum : sums) {
    sum.normalize();
    normals.push_back(
        {static_cast<float>(sum.x()), static_cast<float>(sum.y()), static_cast<float>(sum.z())});
  }
  return normals;
}

template <class Search>
class Proxy final : public MeshProxy {
 public:
  Proxy(FloatMesh mesh, const MeshProxyOptions& options)
      : options_(options), mesh_(std::move(mesh)), search_(mesh_) {
    if (options.shading) normals_ = vertex_normals(mesh_);
  }

  void place(const Vector3& where) noexcept override {
    proxy_ = where;
    triangle_ = no_triangle;
  }

  ProxyContact follow(const Vector3& tool) noexcept override {
    const Contact contact = slide(tool);
    triangle_ = contact.triangle;
    if (contact.triangle == no_triangle) return result(tool);
    if (options_.shading) {
      // Second pass: moves over the true surface to where the shaded plane would hold the proxy.
      const Vector3 shaded = shaded_normal(contact.triangle, contact.closest_point, contact.normal);
      Vector3 goal = tool + shaded * std::max(0.0, (proxy_ - tool).dot(shaded));
      goal += contact.normal * std::max(0.0, (proxy_ - goal).dot(contact.normal));
      slide(goal);
    }
    return result(tool);
  }

  [[nodiscard]] ProxyContact force_at(const Vector3& tool,
                                      std::uint32_t triangle) const noexcept override {
    const auto [a, b, c] = mesh_.corners(triangle);
    const Vector3 closest_point = closest_on_triangle(tool, a, b, c);
    Vector3 normal = (b - a).cross(c - a).normalized();
    const double height = normal.dot(tool - closest_point);
    if (options_.shading) normal = shaded_normal(triangle, closest_point, normal);
    ProxyContact found;
    found.depth = std::max(0.0, options_.radius - height);
    found.contact = found.depth > 0;
    found.normal = normal;
    found.proxy = tool + found.depth * normal;
    found.force = options_.stiffness * found.depth * normal;
    return found;
  }

  [[nodiscard]] std::uint32_t last_triangle() const noexcept override { return triangle_; }

  [[nodiscard]] std::uint64_t bytes() const noexcept override {
    return mesh_.bytes() + search_.bytes() + normals_.size() * sizeof(normals_[0]);
  }

 private:
  /// The first surface that held the proxy on its way.
  struct Contact {
    std::uint32_t triangle = no_triangle;
    Vector3 closest_point = Vector3::Zero();
    Vector3 normal = Vector3::Zero();
  };

  /// Moves the proxy towards a goal until a triangle stops it. False if none does.
  bool advance(const Vector3& goal, Contact& contact) noexcept {
    const Vector3 move = goal - proxy_;
    if (!(move.squaredNorm() > 0)) return false;
    contact.triangle = no_triangle;
    double best = std::numeric_limits<double>::infinity();
    SearchBox box;
    box.set(proxy_, goal, options_.radius + skin);
    search_.each(box, [&](std::uint32_t triangle) {
      const std::array<Vector3, 3> corners = mesh_.corners(triangle);
      Touch touch;
      const bool touches = options_.radius > 0
                               ? touch_by_ball(proxy_, move, options_.radius, corners, skin, touch)
                               : touch_by_point(proxy_, move, corners, skin, touch);
      if (!touches || touch.share >= best) return;
      best = touch.share;
      contact = {triangle, touch.closest_point, touch.normal};
      box.set(proxy_, proxy_ + best * move, options_.radius + 2 * skin);
    });
    if (contact.triangle == no_triangle) {
      proxy_ = goal;
      return false;
    }
    proxy_ += best * move;
    // Restore the part of a ball's skin that was lost to rounding.
    const double height = (proxy_ - contact.closest_point).dot(contact.normal);
    if (options_.radius > 0 && height < options_.radius + skin) {
      proxy_ += std::min(options_.radius + skin - height, skin) * contact.normal;
    }
    return true;
  }

  /// Follows a goal: freely, then along the plane that stops the proxy, then along the line where
  /// two planes meet, until three planes stop it.
  Contact slide(const Vector3& goal) noexcept {
    Contact first, second, third;
    if (!advance(goal, first)) return first;
    const Vector3 left = goal - proxy_;
    const Vector3 along_plane = left - first.normal * std::min(0.0, left.dot(first.normal));
    if (!advance(proxy_ + along_plane, second)) return first;
    const Vector3 line = first.normal.cross(second.normal);
    const double size = line.squaredNorm();
    const Vector3 rest = goal - proxy_;
    // If sliding along the second plane alone leads away from the first, or if both are almost the
    // same plane, the first no longer holds the proxy.
    const Vector3 by_second = rest - second.normal * std::min(0.0, rest.dot(second.normal));
    const bool leaves = !(size > 1e-6) || !(by_second.dot(first.normal) < 0);
    const Vector3 along = leaves ? by_second : Vector3(line * (rest.dot(line) / size));
    advance(proxy_ + along, third);
    return first;
  }

  /// The shaded normal, on the same side as `side`.
  [[nodiscard]] Vector3 shaded_normal(std::uint32_t triangle, const Vector3& closest_point,
                                      const Vector3& side) const noexcept {
    const auto [a, b, c] = mesh_.corners(triangle);
    const Vector3 across = (b - a).cross(c - a);
    const double area = across.squaredNorm();
    const double of_a = across.dot((b - closest_point).cross(c - closest_point)) / area;
    const double of_b = across.dot((c - closest_point).cross(a - closest_point)) / area;
    const std::array<double, 3> weights{of_a, of_b, 1 - of_a - of_b};
    Vector3 sum = Vector3::Zero();
    for (std::size_t k = 0; k < 3; ++k) {
      const auto& normal = normals_[mesh_.triangles[triangle][k]];
      sum += weights[k] * Vector3(normal[0], normal[1], normal[2]);
    }
    const double length = sum.norm();
    if (!(length > 1e-3)) return side;
    return sum.dot(side) < 0 ? Vector3(-sum / length) : Vector3(sum / length);
  }

  [[nodiscard]] ProxyContact result(const Vector3& tool) const noexcept {
    ProxyContact found;
    found.proxy = proxy_;
    if (triangle_ == no_triangle) return found;
    const Vector3 away = proxy_ - tool;
    found.depth = away.norm();
    found.contact = found.depth > 0;
    if (found.contact) found.normal = away / found.depth;
    found.force = options_.stiffness * away;
    return found;
  }

  MeshProxyOptions options_;
  FloatMesh mesh_;
  Search search_;
  std::vector<std::array<float, 3>> normals_;
  Vector3 proxy_ = Vector3::Zero();
  std::uint32_t triangle_ = no_triangle;
};

}  // namespace

std::string to_string(const MeshProxyOptions& options) {
  std::string text = options.tree ? "tree" : "brute force";
  if (options.shading) text += ", force shading";
  if (options.radius > 0)
    text += ", " + format_quantity(options.radius, Quantity::length) + " ball";
  return text;
}

std::unique_ptr<MeshProxy> make_mesh_proxy(FloatMesh mesh, const MeshProxyOptions& options) {
  if (options.tree) return std::make_unique<Proxy<BoxTree>>(std::move(mesh), options);
  return std::make_unique<Proxy<AllTriangles>>(std::move(mesh), options);
}

}  // namespace spm::bench
