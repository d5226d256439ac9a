// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/sim/surface_walk.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/query/query.hpp"

namespace spm::servo {

namespace {

constexpr int projection_steps = 8;
constexpr double touch_slack = 2e-6;   // m
constexpr double sharpest_turn = 0.7;  // cosine, 45 degrees between neighbours
constexpr int headings_tried = 12;
constexpr int thickness_steps = 24;

bool inside(const AssetView& asset, double probe_radius, const Vector3& point) {
  const Answer answer = query_point(asset, point);
  return answer.status == Status::deep ||
         (answer.status == Status::exact && answer.distance < probe_radius);
}

/// Rotates a tangent about the normal by an angle, and projects it back into the tangent plane.
Vector3 turned(const Vector3& heading, const Vector3& normal, double angle) {
  const Vector3 tangent = heading - heading.dot(normal) * normal;
  const double size = tangent.norm();
  const Vector3 along = size > 1e-9 ? Vector3(tangent / size) : normal.unitOrthogonal();
  return std::cos(angle) * along + std::sin(angle) * normal.cross(along);
}

std::optional<Touch> step_from(const AssetView& asset, const WalkSettings& settings,
                               const Touch& from, const Vector3& heading) {
  auto to = touch_near(asset, settings.probe_radius, from.centre + settings.stride * heading);
  if (!to) return std::nullopt;
  const double gone = (to->centre - from.centre).norm();
  if (gone < 0.3 * settings.stride || gone > 2 * settings.stride) return std::nullopt;
  if (to->normal.dot(from.normal) < sharpest_turn) return std::nullopt;
  if (!firm_below(asset, settings.probe_radius, *to, settings.firm_depth)) return std::nullopt;
  return to;
}

}  // namespace

std::optional<Touch> touch_near(const AssetView& asset, double probe_radius, Vector3 point) {
  for (int step = 0; step < projection_steps; ++step) {
    const Answer answer = query_point(asset, point);
    if (answer.status != Status::exact) return std::nullopt;
    const double excess = answer.distance - probe_radius;
    if (std::abs(excess) < touch_slack) return Touch{point, answer.normal};
    point -= excess * answer.normal;
  }
  return std::nullopt;
}

std::optional<Touch> touch_from_outside(const AssetView& asset, double probe_radius,
                                        Random& random) {
  const auto [low, size] = extent_of(asset);
  Vector3 aim = low + size / 2;
  for (int axis = 0; axis < 3; ++axis) aim[axis] += random.between(-0.4, 0.4) * size[axis];
  return touch_along(asset, probe_radius, aim, random.direction());
}

std::optional<Touch> touch_along(const AssetView& asset, double probe_radius, const Vector3& aim,
                                 const Vector3& direction) {
  const double radius = extent_of(asset).size.norm() / 2;
  const double stride = std::max(0.4 * (asset.band.max_depth + asset.band.margin), radius * 1e-4);
  double gone = -2 * radius;
  while (gone < 2 * radius) {
    const Vector3 point = aim + gone * direction;
    if (query_point(asset, point).status == Status::exact) {
      std::optional<Touch> touch = touch_near(asset, probe_radius, point);
      if (touch) return touch;
    }
    gone += stride;
  }
  return std::nullopt;
}

double thickness_below(const AssetView& asset, double probe_radius, const Touch& touch,
                       double limit) {
  const double stride = limit / thickness_steps;
  for (int step = 1; step <= thickness_steps; ++step) {
    if (!inside(asset, probe_radius, touch.centre - step * stride * touch.normal)) {
      return (step - 1) * stride;
    }
  }
  return limit;
}

bool firm_below(const AssetView& asset, double probe_radius, const Touch& touch, double depth) {
  for (const double share : {0.5, 1.0}) {
    if (depth <= 0) break;
    const Vector3 point = touch.centre - share * depth * touch.normal;
    if (!inside(asset, probe_radius, point)) return false;
    if (query_point(asset, point).normal.dot(touch.normal) < sharpest_turn) return false;
  }
  return true;
}

std::vector<Touch> walk(const AssetView& asset, const WalkSettings& settings, const Touch& start,
                        Random& random) {
  std::vector<Touch> touches{start};
  Vector3 heading = turned(random.direction(), start.normal, 0);
  const auto strides = static_cast<std::size_t>(settings.length / settings.stride);
  while (touches.size() <= strides) {
    const Touch& from = touches.back();
    std::optional<Touch> to;
    for (int attempt = 0; attempt < headings_tried && !to; ++attempt) {
      // Straight on with small random turns; larger ones each time that the way is blocked.
      const double wildest = std::numbers::pi * (attempt + 0.03) / headings_tried;
      const Vector3 next = turned(heading, from.normal, random.between(-wildest, wildest));
      to = step_from(asset, settings, from, next);
      if (to) heading = next;
    }
    if (!to) break;
    touches.push_back(*to);
  }
  return touches;
}

}  // namespace spm::servo
